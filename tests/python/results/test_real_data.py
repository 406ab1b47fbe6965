# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured data become clean surfaces, as far as docs/real_data.md says."""

from __future__ import annotations

import numpy as np
import pytest

import remanifold as rm

pytestmark = pytest.mark.slow


def load(data_dir, name):
    path = data_dir / f"{name}.npz"
    if not path.is_file():
        pytest.skip(f"no development data: {path} is absent")
    with np.load(path) as data:
        return dict(data)


def test_scan_from_one_side(data_dir):
    points = load(data_dir, "rawscan_bunny_one_view_bun000")["points"]
    rec = rm.reconstruct(points, 2, smooth="auto")
    # Body, the far ear, and strips seen behind edges: which of these hang together is a
    # matter of one gap, and said.
    topology = rec.topology()
    assert topology.manifold
    assert topology.betti_numbers[0] in (4, 5)
    assert topology.betti_numbers[2] == 0
    assert not rec.quality.ok
    assert "was closed" in str(rec.quality)
    sizes = np.bincount(rec.component_labels()[rec.component_labels() >= 0])
    assert sizes.max() > 0.95 * len(points)
    assert rec.smoothing is not None
    assert rec.smoothing.moved
    assert 0.03e-3 < rec.smoothing.noise < 0.07e-3
    assert len(rec.outliers) + len(rec.repair.unused_vertices) < 10


def test_scans_from_all_sides_in_layers(data_dir):
    points = load(data_dir, "rawscan_bunny_ten_views_registered_60k")["points"]
    rough = rm.reconstruct(points, 2, smooth=False)
    rec = rm.reconstruct(points, 2, smooth="auto")
    # One sphere with the holes underneath, and places that no view shows well.
    topology = rec.topology()
    assert topology.manifold
    assert topology.betti_numbers[::2] == (1, 0)
    assert 2 <= rec.repair.num_boundary_components <= 5
    assert len(rec.outliers) == len(rec.repair.unused_vertices) == 0
    assert rec.smoothing is not None
    assert 0.12e-3 < rec.smoothing.noise < 0.2e-3
    # Hardly anything is disputed any more.
    disputed = len(rec.repair.disputed_simplices)
    assert 10 * disputed < len(rough.repair.disputed_simplices)


def test_smoothed_scans_come_closer_to_the_mesh(data_dir):
    spatial = pytest.importorskip("scipy.spatial")
    points = load(data_dir, "rawscan_bunny_ten_views_registered_60k")["points"]
    mesh = load(data_dir, "surface_stanford_bunny_vertices")
    corners = mesh["points"][mesh["faces"]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    centers = corners.mean(axis=1)
    tree = spatial.cKDTree(centers)

    def away(places):  # from the planes of the nearest triangles
        near = tree.query(places)[1]
        heights = ((places - centers[near]) * normals[near]).sum(axis=1)
        return np.sqrt((heights**2).mean())

    assert away(rm.smooth(points, 2).points) < 0.6 * away(points)


@pytest.mark.parametrize("smooth", ["auto", True])
def test_ground_seen_from_the_air(data_dir, smooth):
    laser = load(data_dir, "lidar_autzen_thinned")
    ground = laser["points"][laser["classification"] == 2]
    rec = rm.reconstruct(ground, 2, smooth=smooth)
    topology = rec.topology()
    assert topology.manifold
    # The rim, and a place where 2,719 samples leave room for a building.
    assert topology.betti_numbers == (1, 1, 0)
    assert rec.repair.num_boundary_components == 2
    assert len(rec.simplices) > 5000
    assert len(rec.outliers) == len(rec.repair.unused_vertices) == 0


def test_circle_in_a_thick_neighborhood(data_dir):
    """Patches of range images: neither thin nor dense, until smoothed and thinned."""
    name = "highdim_range_image_patches_circle_in_R25"
    points = load(data_dir, name)["points"]
    few = points[np.random.default_rng(0).permutation(len(points))[:1000]]
    for _ in range(4):
        few = rm.smooth(few, 1, 400).points
    thin = rm.datasets.spread(few, 40, random_state=0)
    rec = rm.reconstruct(thin, 1, smooth=False)
    assert rec.topology().betti_numbers == (1, 1)
    assert len(rec.simplices) >= 38  # without a stray one or two
    # All around in the plane where the patches vary most.
    plane = np.linalg.svd(points, full_matrices=False)[2][:2]
    angles = np.sort(np.angle(thin @ plane.T @ (1, 1j)))
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < 0.6
