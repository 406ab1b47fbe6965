# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of manifolds beside what they are in closed form."""

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import known_by

CLOSED = {
    "circle": (lambda: rm.datasets.circle(60, random_state=0), 1, 2 * np.pi),
    "sphere": (lambda: rm.datasets.sphere(300, random_state=0), 2, 4 * np.pi),
    "torus": (lambda: rm.datasets.torus(800, random_state=0), 2, 1.6 * np.pi**2),
    "flat torus": (
        lambda: rm.datasets.flat_torus(400, random_state=1),
        2,
        4 * np.pi**2,
    ),
    "3-sphere": (
        lambda: rm.datasets.sphere(300, dim=3, random_state=0),
        3,
        2 * np.pi**2,
    ),
}


@pytest.mark.parametrize("name", CLOSED)
def test_volumes_of_closed_manifolds(name):
    draw, dim, true = CLOSED[name]
    rec = rm.reconstruct(draw(), dim)
    found = rec.estimate_volume()
    assert abs(found.value - true) < min(found.error, 0.2 * (true - rec.volume()))
    assert found.error < true - rec.volume()


@pytest.mark.parametrize(
    ("points", "dim", "true"),
    [
        (rm.datasets.ball(500, random_state=0), 3, 4 / 3 * np.pi),
        (np.random.default_rng(0).random((300, 2)), 2, 1.0),
        (np.random.default_rng(3).random((40, 1)), 1, 1.0),
    ],
)
def test_what_samples_miss_at_a_boundary_is_in_the_error(points, dim, true):
    found = rm.reconstruct(points, dim).estimate_volume()
    assert 0 < true - found.value < found.error < 0.6 * true


def test_lengths_are_enough_and_components_add_up():
    points = rm.datasets.sphere(200, random_state=0)
    rec = rm.reconstruct(points, 2)
    one = rec.estimate_volume()
    known = known_by("distances", rec).estimate_volume()
    assert known.value == pytest.approx(one.value, rel=1e-6)
    both = rm.SimplicialComplex(
        np.vstack([points, points + 5, [[9, 9, 99]]]),
        np.vstack([rec.simplices, rec.simplices + 200]),
    )
    assert both.estimate_volume().value == pytest.approx(2 * one.value)
    dots = rm.SimplicialComplex([[0.0], [1.0]], [[0], [1]])
    assert dots.estimate_volume() == (2.0, 0.0)
