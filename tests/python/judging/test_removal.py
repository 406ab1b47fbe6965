# SPDX-License-Identifier: GPL-3.0-or-later
"""Removal of simplices, told from their surroundings, against topologies counted whole."""

from __future__ import annotations

import numpy as np
import pytest

import remanifold
from remanifold.complex.parts import open_faces
from remanifold.complex.topology import topology_of
from remanifold.judging.removal import (
    closing_changes,
    mark_rows,
    removal_changes,
)


def kind(rows, count):
    topology = topology_of(rows, count)
    return (
        topology.components,
        topology.euler_characteristic,
        topology.boundary_components,
    )


def complexes():
    rng = np.random.default_rng(5)
    torus = remanifold.datasets.torus(300, random_state=1)
    whole = remanifold.reconstruct(torus, 2).simplices
    yield whole[(whole != 7).all(axis=1)]
    annulus = rng.uniform(-1, 1, size=(500, 2))
    radii = np.hypot(*annulus.T)
    yield remanifold.reconstruct(annulus[(radii > 0.4) & (radii < 0.9)], 2).simplices
    yield remanifold.reconstruct(rng.uniform(size=(150, 3)), 3).simplices
    angles = np.sort(rng.uniform(0, 3, size=60))
    yield remanifold.reconstruct(np.c_[np.cos(angles), np.sin(angles)], 1).simplices


@pytest.mark.parametrize("number", range(4))
def test_agrees_with_the_whole_count(number):
    rows = np.sort(list(complexes())[number], axis=1)
    count = int(rows.max()) + 1
    rng = np.random.default_rng(number)
    seen = set()
    for trial in range(120):
        removed = np.zeros(len(rows), dtype=bool)
        if trial % 3 == 0:  # scattered
            removed[rng.integers(len(rows), size=rng.integers(1, 5))] = True
        else:  # around a vertex, at a rim in every other trial
            rim = open_faces(rows).ravel()
            at_rim = trial % 3 == 1 and len(rim) > 0
            center = rng.choice(rim) if at_rim else rng.integers(count)
            star = np.flatnonzero((rows == center).any(axis=1))
            removed[rng.permutation(star)[: rng.integers(1, 4)]] = True
        if not removed.any():
            continue
        rim = np.sort(open_faces(rows), axis=1)
        found = removal_changes(rows, removed, rim, count)
        assert found == (kind(rows, count) != kind(rows[~removed], count))
        seen.add(found)
    assert seen == {True, False}


@pytest.mark.parametrize("number", range(4))
def test_closing_agrees_with_the_whole_count(number):
    whole = np.sort(list(complexes())[number], axis=1)
    count = int(whole.max()) + 1
    rng = np.random.default_rng(number)
    seen = set()
    for _ in range(120):
        star = np.flatnonzero((whole == rng.integers(count)).any(axis=1))
        taken = np.zeros(len(whole), dtype=bool)
        taken[rng.permutation(star)[: rng.integers(1, 4)]] = True
        if not taken.any():
            continue
        rows, added = whole[~taken], whole[taken]
        rim = np.sort(open_faces(rows), axis=1)
        # Some of them may be there already.
        found = closing_changes(rows, np.concatenate([added, rows[:1]]), rim, count)
        unknown = not np.isin(added, rows).all()
        assert found == (unknown or kind(rows, count) != kind(whole, count))
        seen.add(found)
    # An edge at the end of a curve has a vertex that nothing else has.
    assert seen == ({True} if whole.shape[1] == 2 else {True, False})


def test_what_does_not_fit_is_not_known_to_change_nothing():
    rows = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]], dtype=np.int32)
    rim = np.sort(open_faces(rows), axis=1)
    assert not closing_changes(rows, np.array([[1, 3, 4]], np.int32), rim, 6)
    assert closing_changes(rows, np.array([[2, 3, 0]], np.int32), rim, 6)
    assert closing_changes(rows, np.array([[1, 3, 5]], np.int32), rim, 6)
    assert closing_changes(rows, rows[:1], rim, 6)


def test_rows_are_marked_by_their_vertices():
    rows = np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3]], dtype=np.int32)
    wanted = np.array([[0, 1, 3], [0, 2, 3]], dtype=np.int32)
    assert mark_rows(rows, wanted, 5).tolist() == [False, True, False]
    assert not mark_rows(rows, wanted[:0], 5).any()


def test_rims_count_where_all_else_is_even():
    # A torus of squares less one of them: cut through from rim to rim it becomes an
    # annulus, and a hole elsewhere makes up for the Euler characteristic.
    n = 8
    i, j = (grid.ravel() for grid in np.mgrid[:n, :n])

    def number(a, b):
        return a % n * n + b % n

    lower = np.c_[number(i, j), number(i + 1, j), number(i + 1, j + 1)]
    upper = np.c_[number(i, j), number(i, j + 1), number(i + 1, j + 1)]
    rows = np.sort(np.concatenate([lower, upper]), axis=1).astype(np.int32)
    row, column = np.r_[i, i], np.r_[j, j]
    whole = (row != 0) | (column != 0)
    rows, removed = rows[whole], (column == 0)[whole]
    removed[np.flatnonzero((rows == number(4, 4)).any(axis=1))[0]] = True
    before, after = kind(rows, n * n), kind(rows[~removed], n * n)
    assert before[:2] == after[:2] == (1, -1)
    assert removal_changes(rows, removed, np.sort(open_faces(rows), axis=1), n * n)
