# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners in gaps of curves, and the narrowest tubes of surfaces."""

from __future__ import annotations

import math

import numpy as np
import pytest

import remanifold as rm
from remanifold import datasets
from remanifold._base.samples import Gram, Points
from remanifold.judging import quality as judging
from remanifold.judging import signs
from remanifold.judging.corners import length_through_corner
from remanifold.judging.waists import tubes
from remanifold.method.openings import Opening


def found_in(rows, least):
    return tubes(rows, np.ones(int(rows.max()) + 1, dtype=bool), least)


def joined_spheres():
    """Two spheres with a tube of three edges between them."""
    sphere = np.sort(
        rm.reconstruct(datasets.sphere(80, random_state=0), 2).simplices, axis=1
    )
    a, b, c = sphere[0].tolist()
    d, e, f = (sphere[0] + 80).tolist()
    tube = [[a, b, d], [b, d, e], [b, c, e], [c, e, f], [a, c, f], [a, d, f]]
    rows = np.concatenate([sphere[1:], sphere[1:] + 80, np.array(tube, np.int32)])
    return np.sort(rows, axis=1), [[a, b, c], [d, e, f]]


def test_a_tube_of_three_edges_is_found():
    rows, ends = joined_spheres()
    found = found_in(rows, 16).tolist()
    assert all(end in found for end in ends)
    # Other loops around the tube have an edge across it, and none is elsewhere.
    assert np.isin(found, ends).all()
    assert len(found_in(rows[: len(rows) // 2 - 3], 16)) == 0


def test_a_handle_of_three_edges_is_found():
    around, along = np.mgrid[:3, :12]

    def number(i, j):
        return (i % 3 * 12 + j % 12).ravel()

    first, corner = number(around, along), number(around + 1, along + 1)
    lower = np.c_[first, number(around + 1, along), corner]
    upper = np.c_[first, number(around, along + 1), corner]
    rows = np.sort(np.concatenate([lower, upper]), axis=1)
    found = found_in(rows.astype(np.int32), 16).tolist()
    assert all([j, 12 + j, 24 + j] in found for j in range(12))


def test_a_sample_with_three_triangles_is_no_tube():
    rows = np.sort(
        rm.reconstruct(datasets.sphere(80, random_state=0), 2).simplices, axis=1
    )
    a, b, c = rows[0].tolist()
    new = [[a, b, 90], [b, c, 90], [a, c, 90]]
    rows = np.concatenate([rows[1:], np.array(new, np.int32)])
    assert len(found_in(rows, 16)) == 0
    assert [a, b, c] in found_in(rows, 2).tolist()


def test_what_narrow_tubes_join_is_doubted():
    sphere = rm.reconstruct(datasets.sphere(80, random_state=0), 2)
    found = judging._seen(sphere)
    found.simplices = joined_spheres()[0]
    found.fold = np.full(160, 60.0)
    (sign,) = signs._waists(found)
    assert sign.strong
    assert sign.text.startswith("2 loops of three edges around a tube")
    # So little do a few triangles around a tube not bend.
    found.fold = np.full(160, 19.0)
    assert list(signs._waists(found)) == []


def tip(angle, short, dim=2):
    """Two straight sides that meet in the origin, as far as some samples before it."""
    steps = np.arange(10)[:, None] + short
    first = steps * [math.cos(angle), math.sin(angle)]
    second = steps * [1.0, 0.0]
    points = np.concatenate([first[::-1], second])
    return np.pad(points, [(0, 0), (0, dim - 2)])


@pytest.mark.parametrize("kind", [Points, lambda x: Gram(x @ x.T)])
def test_length_of_the_way_around_a_corner(kind):
    rows = np.c_[np.arange(19), np.arange(1, 20)].astype(np.int32)
    ends = np.array([9, 10], dtype=np.int32)

    def length(points):
        return length_through_corner(kind(points), rows, ends, 1.0, 6)

    assert length(tip(0.9, 2.0)) == pytest.approx(4.0)
    assert length(tip(0.3, 1.5, 3)) == pytest.approx(3.0)
    # A little behind it, parallel sides, sides that pass each other.
    assert length(tip(0.9, -0.5)) == pytest.approx(1.0)
    parallel = np.c_[np.r_[9:-1:-1, 0:10], np.repeat([0.0, 3.0], 10)]
    assert length(parallel) == math.inf
    passing = tip(0.9, 2.0, 3)
    passing[:10, 2] = 0.6
    assert length(passing) == math.inf
    passing[:10, 2] = 0.4
    assert length(passing) == pytest.approx(4.4)
    # Too short to tell.
    short = length_through_corner(kind(tip(0.9, 2.0)), rows[4:], ends, 1.0, 6)
    assert short == math.inf


def star(num, seed):
    angles = np.arange(11) * np.pi / 5
    radii = np.where(np.arange(11) % 2, 0.5, 1.0)
    ends = radii[:, None] * np.c_[np.cos(angles), np.sin(angles)]
    lengths = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    along = np.concatenate([[0], np.cumsum(lengths)])
    places = np.random.default_rng(seed).random(num) * along[-1]
    return np.column_stack([np.interp(places, along, axis) for axis in ends.T])


def joints_of(rec):
    return [one for one in rec.openings if one.kind == "joint"]


def test_tips_of_stars_are_no_reason():
    rec = rm.reconstruct(star(400, 2), 1)
    joints = joints_of(rec)
    assert max(one.missing for one in joints) > 3
    assert {one.decision for one in joints} == {"closed"}
    assert rec.topology().betti_numbers == (1, 1)
    assert rec.quality.ok, str(rec.quality)


@pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")
@pytest.mark.parametrize("seed", range(4))
def test_strands_that_were_joined_are_doubted(seed):
    rng = np.random.default_rng(seed)
    strands = np.concatenate([np.c_[rng.random(150) * 150, [y] * 150] for y in (0, 4)])
    rec = rm.reconstruct(strands, 1)
    assert rec.topology().betti_numbers != (2, 0)
    assert "joint" in str(rec.quality)


@pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")
def test_a_tip_that_was_left_open_is_doubted():
    points = star(400, 1)
    tip = np.linalg.norm(points - [1, 0], axis=1)
    rec = rm.reconstruct(points[tip > 3.5 * 5.9 / 400 * 1.25], 1)
    joints = joints_of(rec)
    assert "open" in {one.decision for one in joints}
    assert "a corner of the curve may be there" in str(rec.quality)


def test_what_closing_changes_nothing_is_no_reason():
    rec = rm.reconstruct(np.random.default_rng(0).random((120, 2)), 2)
    found = judging._seen(rec)
    rim = rec.repair.open_faces

    def said(triangle):
        place = Opening(
            "hole",
            "open",
            np.unique(triangle),
            *(0.1, 0.05, 9.0, 1.0, 5e-4, 5e-4, 2.0),
            simplices=np.array([triangle], np.int32),
        )
        found.openings = (place,)
        return [sign.text for sign in signs.close_decisions(found)]

    # Between two edges of the rim that share a vertex: the rim moves.
    a, b = rim[0].tolist()
    c = next(v for row in rim[1:].tolist() if b in row for v in row if v != b)
    assert said([a, b, c]) == []
    # From one side to the other: a handle.
    far = max(
        np.unique(rim),
        key=lambda v: np.linalg.norm(rec.vertices[[v]] - rec.vertices[a]),
    )
    (text,) = said([a, b, far])
    assert "was left open, but below significance=0.0005 it is closed" in text
