# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of samples before anything is reconstructed."""

from __future__ import annotations

import numpy as np
import pytest

import remanifold as rm
from remanifold.method.survey import (
    structure,
    survey,
    suspicious_units,
)

RNG = np.random.default_rng(5)
TORUS = rm.datasets.torus(2000, random_state=0)
GRID = (
    np.stack(np.meshgrid(range(40), range(30), indexing="ij"), -1).reshape(-1, 2) * 0.7
)
CUBE = np.stack(np.meshgrid(*[range(9)] * 3), -1).reshape(-1, 3).astype(float)
# A turn that leaves no coordinate of a lattice with few values.
TURN = np.linalg.qr(RNG.normal(size=(3, 3)))[0]


def scan(across):
    """Lines of 150 samples, each farther from the next than its samples are apart."""
    i = np.arange(6000)
    points = np.column_stack(
        [i % 150 * 0.1, i // 150 * 0.1 * across, np.sin(i % 150 / 20)]
    )
    return points + RNG.normal(size=points.shape) * 0.004


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_dimension_and_spread_of_random_samples(dim):
    points = RNG.normal(size=(3000, dim + 1))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    found = survey(points)
    assert found.estimate.dim == dim
    assert found.estimate.confidence > 0.5
    assert 1.4 < found.spread < 5.5
    assert found.structure == ""
    assert found.units == ()


def test_uneven_samples_have_a_larger_spread():
    dense = TORUS[TORUS[:, 0] > 0]
    sparse = TORUS[TORUS[:, 0] <= 0][::16]
    assert survey(np.vstack([dense, sparse])).spread > 1.4 * survey(TORUS).spread


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        (GRID, "a lattice over the coordinates 0, 1, each next to the one before"),
        (RNG.permutation(GRID), "a lattice over the coordinates 0, 1"),
        (
            RNG.permutation(np.column_stack([GRID, np.sin(GRID[:, 0] / 5)])),
            "a lattice over the coordinates 0, 1",
        ),
        (RNG.permutation(CUBE), "a lattice over the coordinates 0, 1, 2"),
        (RNG.permutation(CUBE @ TURN), "a lattice"),
        (RNG.permutation(scan(5)), "lines of a scan, "),
        (scan(5), "lines of a scan, "),
        (RNG.permutation(TORUS), ""),
        (GRID[RNG.permutation(1200)] + RNG.normal(size=(1200, 2)) * 0.2, ""),
        (RNG.normal(size=(2000, 12)), ""),
        (rm.datasets.circle(900, random_state=0), ""),
    ],
)
def test_structure(points, expected):
    found = structure(points)
    assert found.startswith(expected)
    assert bool(found) == bool(expected)


def test_how_far_apart_the_lines_of_a_scan_are():
    for across in (3, 5, 8):
        words = structure(RNG.permutation(scan(across)))
        assert float(words.split()[4]) == pytest.approx(across, rel=0.25)


def test_units():
    places = np.column_stack(
        [RNG.uniform(13.3, 13.6, 900), RNG.uniform(52.4, 52.6, 900)]
    )
    heights = RNG.uniform(30, 80, 900)
    (said,) = suspicious_units(np.column_stack([places, heights]))
    assert "look like degrees and the third like metres" in said
    assert suspicious_units(np.column_stack([places, heights / 1e5])) == ()
    (said,) = suspicious_units(TORUS * [1, 1, 1e-6])
    assert said.startswith("coordinate 1 spans 3e+06 times as much as coordinate 2")
    for points in (TORUS, GRID, TORUS * [1, 1, 0], TORUS * [1, 20, 300], CUBE):
        assert suspicious_units(points) == ()


def test_few_samples():
    for count in (1, 2, 5, 9):
        assert survey(TORUS[:count]).estimate is None
    assert survey(TORUS[:30]).estimate.dim in (1, 2, 3)
