# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples dense along lines and sparse across them: scan lines, rings of a turned part."""

import numpy as np
import pytest

import remanifold as rm


def scan_lines(apart, *, lines=20, count=200, seed=0):
    """A wavy sheet, a sample for each unit along lines that are so many units apart."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(count), apart * np.arange(lines))
    x = (x + 0.2 * rng.normal(size=x.shape)).ravel()
    y = (y + 0.05 * rng.normal(size=y.shape)).ravel()
    z = 0.08 * count * np.sin(6 * x / count) * np.cos(3 * y / (apart * lines))
    return np.c_[x, y, z]


def rings(around, along, radius=0.4):
    """A torus of so many samples on each ring, so many rings."""
    u, v = np.meshgrid(*(2 * np.pi * np.arange(n) / n for n in (along, around)))
    u, v = u.ravel(), v.ravel()
    out = 1 + radius * np.cos(v)
    return np.c_[out * np.cos(u), out * np.sin(u), radius * np.sin(v)]


def kinds(rec):
    return {reason.kind for reason in rec.quality.reasons}


@pytest.mark.parametrize("apart", [4, 10, 20, 40])
def test_scan_lines_are_one_sheet(apart):
    rec = rm.reconstruct(scan_lines(apart), 2)
    assert rec.topology().betti_numbers == (1, 0, 0)
    assert rec.topology().boundary_components == 1
    assert "singular" not in kinds(rec)


@pytest.mark.parametrize(("around", "along"), [(16, 500), (300, 40)])
def test_rings_are_a_torus(around, along):
    rec = rm.reconstruct(rings(around, along), 2)
    assert rec.topology().name == "a torus"
    assert "singular" not in kinds(rec)


def test_a_rim_along_a_line_is_no_gap_to_fill():
    """Long triangles between the ends of a bent rim hold few samples of its spacing."""
    rec = rm.reconstruct(scan_lines(16, lines=30, count=480), 2)
    assert rec.topology().betti_numbers == (1, 0, 0)


def test_rings_in_more_coordinates():
    points = rm.datasets.embed(rings(16, 300), 7, random_state=0)
    assert rm.reconstruct(points, 2).topology().name == "a torus"


def test_a_hole_between_scan_lines_stays_open():
    points = scan_lines(10)
    far = np.hypot(points[:, 0] - 100, points[:, 1] - 95) > 45
    rec = rm.reconstruct(points[far], 2)
    assert rec.topology().betti_numbers == (1, 1, 0)
    assert rec.openings[-1].decision == "open"


@pytest.mark.parametrize("apart", [10, 20])
def test_straight_lines_in_a_plane(apart):
    x, y = np.meshgrid(np.arange(100.0), apart * np.arange(12))
    points = np.c_[x.ravel(), y.ravel(), np.zeros(x.size)]
    rec = rm.reconstruct(points, 2)
    assert rec.topology().betti_numbers == (1, 0, 0)
    assert rec.quality.ok


def test_rings_that_are_closed_to_a_torus_are_doubted():
    angles = np.arange(64) / 64 * 2 * np.pi
    ring = np.c_[np.cos(angles), np.sin(angles)]
    points = np.vstack([np.c_[ring, np.full(64, z)] for z in (0, 0.5, 1)])
    rec = rm.reconstruct(points, 2)
    assert rec.topology().betti_numbers == (1, 1, 0) or "singular" in kinds(rec)


@pytest.mark.parametrize(("count", "height"), [(100, 0.3), (200, 1.0), (300, 1.0)])
def test_the_apex_of_a_cone_of_rings_is_no_outlier(count, height):
    """It is as far from the last ring as that is from the next."""
    radii = np.arange(1, 21)[:, None] / 20
    angles = np.arange(count) / count * 2 * np.pi
    places = radii * np.cos(angles), radii * np.sin(angles), np.ones(count) * -radii
    points = np.vstack([np.zeros((1, 3)), np.stack(places, axis=-1).reshape(-1, 3)])
    points[:, 2] *= height
    rec = rm.reconstruct(points, 2)
    assert len(rec.outliers) == 0
    assert rec.topology().betti_numbers == (1, 0, 0)
    assert rec.quality.ok


def test_strays_over_rings_are_outliers():
    points = rings(16, 300)
    strays = points[::317] * [1, 1, 0] + [0, 0, 1.0]
    found = rm.find_outliers(np.vstack([points, strays]), 2)
    assert found.tolist() == list(range(len(points), len(points) + len(strays)))


def test_a_hair_on_a_sheet_is_no_sheet():
    rng = np.random.default_rng(0)
    sheet = np.c_[40 * rng.random((1600, 2)), np.zeros(1600)]
    hair = np.c_[np.full(60, 20.0), np.full(60, 20.0), np.arange(1, 61) / 2]
    rec = rm.reconstruct(np.r_[sheet, hair], 2)
    assert "singular" in kinds(rec)


def test_tangent_planes_hold_both_directions():
    points = rings(16, 500)
    rec = rm.reconstruct(points, 2)
    u = np.arctan2(points[:, 1], points[:, 0])
    out = points[:, :2] - np.c_[np.cos(u), np.sin(u)]
    normal = np.c_[out, points[:, 2]] / 0.4
    sines = np.abs(np.einsum("nkd,nd->nk", rec.tangents, normal)).max(axis=1)
    assert np.degrees(np.arcsin(sines.max())) < 12


def test_any_number_of_threads():
    points = scan_lines(20)
    one, two = (rm.reconstruct(points, 2, num_threads=n) for n in (1, 2))
    np.testing.assert_array_equal(one.simplices, two.simplices)
    np.testing.assert_array_equal(one.tangents, two.tangents)
