# SPDX-License-Identifier: GPL-3.0-or-later
"""Outliers and noise: what is found, left out and smoothed away."""

import pickle

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold import datasets

SMALL = ("torus", "sphere", "klein_bottle", "trefoil", "moebius_band", "swiss_roll")


def draw(name, num, seed=0):
    return datasets.SHAPES[name].generate(num, random_state=seed)


def with_outliers(points, share, seed=0):
    """Uniform ones in twice the bounding box, and where they are."""
    rng = np.random.default_rng(seed)
    low, high = points.min(axis=0), points.max(axis=0)
    num = round(share * len(points))
    box = (low + high) / 2 + (rng.random((num, points.shape[1])) - 0.5) * 2 * (
        high - low
    )
    both = np.vstack([points, box])
    order = rng.permutation(len(both))
    return both[order], order >= len(points)


def noisy_torus(num, noise, seed=0):
    """Displaced along the normals; radii are 1 and 0.4. Noise is in length."""
    points = draw("torus", num, seed)
    rng = np.random.default_rng(seed + 1)
    return points + normals_of_torus(points) * rng.normal(0, noise, (num, 1))


def radii():
    points = draw("torus", 4000)
    rho = np.hypot(points[:, 0], points[:, 1])
    tube = points[:, 2].max()
    return rho.max() - tube, tube


def normals_of_torus(points):
    major, _ = radii()
    rho = np.hypot(points[:, 0], points[:, 1])
    center = np.column_stack([points[:, :2] / rho[:, None] * major, np.zeros(len(rho))])
    away = points - center
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def distance_to_torus(points):
    major, minor = radii()
    return np.abs(
        np.hypot(np.hypot(points[:, 0], points[:, 1]) - major, points[:, 2]) - minor
    )


def root_mean_square(values):
    return float(np.sqrt(np.mean(np.square(values))))


def nearest(points):
    return float(np.median(rm.neighborhoods(points, 1).distances))


def right(rec, name):
    topology, shape = rec.topology(), datasets.SHAPES[name]
    return (
        topology.manifold,
        topology.betti_numbers,
        topology.orientable,
        topology.boundary_components,
    ) == (True, shape.betti_numbers, shape.orientable, shape.boundary_components)


# ------------------------------------------------------------------------ outliers


@pytest.mark.parametrize(
    ("name", "share"),
    # Among the sheets of a Swiss roll one sample in six is too many; clutter that stays near
    # a Moebius band makes simplices so large that an opening is seen.
    [
        (n, s)
        for n in SMALL
        for s in (0.01, 0.05, 0.2)
        if (n, s) not in (("swiss_roll", 0.2), ("moebius_band", 0.2))
    ],
)
def test_outliers_are_found_and_left_out(name, share):
    points, outlying = with_outliers(draw(name, 2500), share)
    rec = rm.reconstruct(points, datasets.SHAPES[name].dim)
    found = np.zeros(len(points), dtype=bool)
    found[rec.outliers] = True
    assert not (found & ~outlying).any()
    # What lies within two local scales of the manifold is none.
    assert np.count_nonzero(found & outlying) >= 0.7 * outlying.sum()
    assert not np.isin(rec.simplices, rec.outliers).any()
    assert not np.isin(rec.repair.unused_vertices, rec.outliers).any()
    assert rec.num_samples == len(points)
    assert right(rec, name)


@pytest.mark.parametrize("name", sorted(datasets.SHAPES))
def test_clean_samples_lose_none(name):
    shape = datasets.SHAPES[name]
    num = (
        960 if name.startswith("grid") else {1: 300, 2: 1500, 3: 800, 4: 400}[shape.dim]
    )
    points = shape.generate(num, random_state=1)
    assert len(rm.find_outliers(points, shape.dim)) == 0


@pytest.mark.parametrize("name", ["torus", "klein_bottle"])
def test_clutter_leaves_no_spikes(name):
    clean = draw(name, 1500)
    rng = np.random.default_rng(3)
    middle = (clean.min(axis=0) + clean.max(axis=0)) / 2
    spread = rng.uniform(-1, 1, (150, clean.shape[1])) * np.ptp(clean, axis=0)
    rec = rm.reconstruct(np.concatenate([clean, middle + spread]), 2)
    found = rm.find_outliers(rec.samples, 2)
    assert {*found} < {*rec.outliers}
    assert rec.outliers.min() >= 1500
    assert (
        rec.topology().betti_numbers
        == rm.reconstruct(clean, 2).topology().betti_numbers
    )
    assert not any("folds" in reason.text for reason in rec.quality.reasons)


def test_the_last_of_many_outliers_are_found():
    """Far from everything they are each other's neighbors, sparser with each that goes."""
    clean = draw("torus", 20_000)
    rng = np.random.default_rng(0)
    strewn = rng.uniform(-1, 1, (2000, 3)) * np.ptp(clean, axis=0)
    rec = rm.reconstruct(np.concatenate([clean, strewn]), 2)
    assert rec.outliers.min() >= 20_000
    assert len(rec.outliers) > 0.95 * 2000
    assert right(rec, "torus")


def test_outliers_of_products_and_distances():
    points, outlying = with_outliers(draw("torus", 400), 0.1)
    found = rm.find_outliers(points, 2)
    assert len(found) > 20
    gram = points @ points.T
    np.testing.assert_array_equal(rm.find_outliers(gram=gram, dim=2), found)
    distances = cdist(points, points)
    np.testing.assert_array_equal(rm.find_outliers(distances=distances, dim=2), found)
    by_gram = rm.reconstruct(gram=gram, dim=2)
    assert {*found} <= {*by_gram.outliers} <= {*np.flatnonzero(outlying)}
    assert not np.isin(by_gram.simplices, by_gram.outliers).any()


def test_farther_outliers_are_fewer():
    points, outlying = with_outliers(draw("sphere", 1000), 0.05)
    found = [set(rm.find_outliers(points, 2, c).tolist()) for c in (1.5, 3.0, 8.0)]
    assert found[0] >= found[1] >= found[2]
    assert len(found[0]) > len(found[2])
    assert found[0] <= set(np.flatnonzero(outlying).tolist())


def test_outliers_may_be_kept():
    points, _ = with_outliers(draw("sphere", 1000), 0.05)
    kept = rm.reconstruct(points, 2, outliers=False)
    assert len(kept.outliers) == 0
    assert len(rm.reconstruct(points, 2, method="paper").outliers) == 0
    left_out = rm.reconstruct(points, 2, method="paper", outliers="auto")
    np.testing.assert_array_equal(left_out.outliers, rm.find_outliers(points, 2))
    assert not np.isin(left_out.simplices, left_out.outliers).any()
    assert not np.isin(left_out.repair.unused_vertices, left_out.outliers).any()


def test_copies_of_an_outlier_are_outliers():
    points = np.vstack([draw("circle", 100), [[3.0, 1.0]], [[3.0, 1.0]]])
    rec = rm.reconstruct(points, 1)
    assert rec.outliers.tolist() == [100, 101]
    assert rec.boundary.sum() == 0
    assert rec.representatives.tolist() == [*range(101), 100]
    assert np.isnan(rec.tangents[100:]).all()
    assert not np.isnan(rec.tangents[:100]).any()
    assert rec.topology().betti_numbers == (1, 1)


def test_a_boundary_mask_counts_all_samples():
    disc = np.random.default_rng(0).uniform(-1, 1, (600, 2))
    flat = np.column_stack([disc, np.zeros(600)])
    points = np.vstack([[[0.1, 0.2, 2.0]], flat])
    mask = np.append(False, np.abs(disc).max(axis=1) > 0.9)
    rec = rm.reconstruct(points, 2, boundary=mask)
    assert rec.outliers.tolist() == [0]
    assert len(rec.repair.open_faces) > 0
    assert set(np.unique(rec.repair.open_faces)) <= set(np.flatnonzero(mask))


def test_few_samples_have_no_outliers():
    for num in range(2, 9):
        points = np.vstack([draw("circle", 100)[:num], [[50.0, 50.0]]])
        assert len(rm.find_outliers(points, 1)) == 0


# ----------------------------------------------------------------------- smoothing


@pytest.mark.parametrize("level", [0.25, 0.5, 1.0])
def test_noise_is_measured_and_smoothed_away(level):
    unit = nearest(draw("torus", 3000))
    points = noisy_torus(3000, level * unit)
    rec = rm.reconstruct(points, 2, smooth="auto")
    before = root_mean_square(distance_to_torus(points))
    after = root_mean_square(distance_to_torus(rec.vertices))
    assert after < 0.45 * before
    assert rec.smoothing.noise == pytest.approx(level * unit, rel=0.15)
    assert right(rec, "torus")
    np.testing.assert_array_equal(rec.samples, points)
    np.testing.assert_array_equal(rec.vertices, rec.smoothing.points)


@pytest.mark.parametrize("name", sorted(datasets.SHAPES))
def test_clean_samples_stay_where_they_are(name):
    shape = datasets.SHAPES[name]
    num = (
        960 if name.startswith("grid") else {1: 300, 2: 1500, 3: 800, 4: 400}[shape.dim]
    )
    points = shape.generate(num, random_state=1)
    smoothed = rm.smooth(points, shape.dim, only_noise=True)
    assert not smoothed.moved
    np.testing.assert_array_equal(smoothed.points, points)
    assert smoothed.noise < 0.35 * nearest(points)


def test_smoothing_in_many_coordinates():
    points = draw("flat_torus", 1200)
    basis = np.linalg.qr(np.random.default_rng(0).normal(size=(40, 4)))[0]
    unit = nearest(points)
    rng = np.random.default_rng(1)
    noisy = points @ basis.T + rng.normal(0, 0.15 * unit, (len(points), 40))
    smoothed = rm.smooth(noisy, 2)

    def away(positions):
        inside = positions @ basis
        circles = np.hypot(inside[:, ::2], inside[:, 1::2]) - np.hypot(*points[0, :2])
        off = np.linalg.norm(positions - inside @ basis.T, axis=1)
        return root_mean_square(np.hypot(off, np.linalg.norm(circles, axis=1)))

    assert away(smoothed.points) < 0.4 * away(noisy)
    assert smoothed.noise == pytest.approx(0.15 * unit * np.sqrt(38), rel=0.15)


def test_flat_samples_are_smoothed_flat():
    """A quadric through a noisy line is not far from straight, and exact without noise."""
    line = np.random.default_rng(0).uniform(size=(200, 1)) * [[1.0, 2.0, -1.0]]
    smoothed = rm.smooth(line, 1, 20)
    np.testing.assert_allclose(smoothed.points, line, atol=1e-12)
    assert smoothed.noise < 1e-12


def test_quadrics_are_kept():
    """A graph of degree two is its own projection, whatever the neighborhoods."""
    flat = np.random.default_rng(0).uniform(-0.1, 0.1, (300, 2))
    points = np.column_stack([flat, 0.01 * (flat[:, 0] ** 2 - flat[:, 1] ** 2)])
    smoothed = rm.smooth(points, 2, 60)
    assert np.abs(smoothed.points - points).max() < 1e-6


def test_number_of_neighbors_may_be_given():
    points = noisy_torus(800, 0.02)
    few, many = (rm.smooth(points, 2, m) for m in (12, 60))
    assert (few.num_neighbors, many.num_neighbors) == (12, 60)
    away = [root_mean_square(distance_to_torus(s.points)) for s in (few, many)]
    assert away[1] < 0.8 * away[0] < root_mean_square(distance_to_torus(points))
    rec = rm.reconstruct(points, 2, smooth=60)
    np.testing.assert_array_equal(rec.vertices, many.points)


def test_smoothing_does_not_depend_on_where_samples_are():
    points = noisy_torus(600, 0.02)
    smoothed = rm.smooth(points, 2, 40).points
    far = rm.smooth(1000 * points + 5000, 2, 40).points
    np.testing.assert_allclose((far - 5000) / 1000, smoothed, atol=1e-9)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_the_same_on_any_number_of_threads(threads):
    points, _ = with_outliers(noisy_torus(800, 0.03), 0.1)
    expected = rm.reconstruct(points, 2, smooth="auto", num_threads=3)
    found = rm.reconstruct(points, 2, smooth="auto", num_threads=threads)
    for name in ("vertices", "simplices", "outliers"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert found.smoothing.noise == expected.smoothing.noise


@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_smoothing_of_products_and_distances(kind):
    points = noisy_torus(500, 0.03)
    matrix = points @ points.T if kind == "gram" else cdist(points, points)
    rec = rm.reconstruct(**{kind: matrix}, dim=2, smooth=True)
    expected = rm.reconstruct(points, 2, smooth=True)
    assert rec.vertices is None
    assert rec.smoothing.points is None
    assert rec.tangents is None
    # Positions that fit the products are turned, and so are sorted otherwise: quadrics
    # are fitted around other samples.
    assert rec.smoothing.noise == pytest.approx(expected.smoothing.noise, rel=0.1)
    assert rec.smoothing.num_neighbors == expected.smoothing.num_neighbors
    assert right(rec, "torus")
    assert right(expected, "torus")
    edges, others = ({tuple(e) for e in r.edges.tolist()} for r in (rec, expected))
    assert len(edges & others) > 0.8 * len(others)


def test_copies_move_together():
    points = noisy_torus(500, 0.03)
    points = np.vstack([points, points[:7]])
    rec = rm.reconstruct(points, 2, smooth=30)
    np.testing.assert_array_equal(rec.vertices[500:], rec.vertices[:7])
    assert rec.representatives[500:].tolist() == list(range(7))
    assert rec.simplices.max() < 500


def test_layers_are_smoothed_into_one():
    """Two scans of a surface, a third of the spacing apart."""
    flat = np.random.default_rng(0).uniform(0, 12, (288, 2))
    height = np.where(np.arange(288) % 2, 0.3, 0.0)
    points = np.column_stack([flat, height])
    rec = rm.reconstruct(points, 2, smooth=60)
    assert np.abs(rec.vertices[:, 2] - 0.15).std() < 0.06
    assert rec.smoothing.noise == pytest.approx(0.15, rel=0.2)
    topology = rec.topology()
    assert topology.manifold
    assert topology.betti_numbers == (1, 0, 0)


def test_noise_of_many_spacings():
    """More samples than the noise lets show: some are vertices, others have a place."""
    true = draw("torus", 5000)
    unit = nearest(true)
    rng = np.random.default_rng(1)
    points = true + rng.normal(0, 3 * unit, true.shape)
    rec = rm.reconstruct(points, 2)
    assert right_without_attached(rec, "torus")
    smoothing = rec.smoothing
    assert smoothing.noise == pytest.approx(3 * unit, rel=0.1)
    assert not smoothing.drowned
    assert smoothing.fitting_dim is None
    off = root_mean_square(distance_to_torus(rec.vertices))
    assert off < 0.25 * root_mean_square(distance_to_torus(points))
    assert 0.5 * smoothing.remaining_error < off < 1.5 * smoothing.remaining_error
    others = {num: rm.smooth(points, 2, num).points for num in (50, 100, 200, 400, 800)}
    best = min(root_mean_square(distance_to_torus(p)) for p in others.values())
    assert off < 1.5 * best
    # Attached samples are on the result, and no vertices of it.
    assert 0.1 * len(points) < len(rec.attached) < 0.9 * len(points)
    assert not np.isin(rec.simplices, rec.attached).any()
    found = rec.project(rec.vertices[rec.attached]).distances
    assert found.max() < 1e-6
    np.testing.assert_allclose(
        rec.residuals, np.linalg.norm(points - rec.vertices, axis=1)
    )
    # Each sample is in the complex or named.
    named = (rec.attached, rec.outliers, rec.repair.unused_vertices)
    np.testing.assert_array_equal(
        np.setdiff1d(np.arange(len(points)), rec.simplices),
        np.sort(np.concatenate(named)),
    )
    assert len(rec.outliers) + len(rec.repair.unused_vertices) < 10


def right_without_attached(rec, name):
    topology = rec.subset(np.arange(len(rec.simplices))).topology()
    return topology.manifold and (
        topology.betti_numbers == datasets.SHAPES[name].betti_numbers
    )


def test_noise_that_drowns_the_shape_is_said():
    sphere = datasets.sphere(1500, random_state=0)
    points = datasets.add_noise(sphere, 0.28, random_state=1)
    with pytest.warns((rm.ManifoldWarning, rm.DimensionWarning)) as caught:
        rec = rm.reconstruct(points, 2)
    assert any("noise drowns the shape" in str(one.message) for one in caught)
    assert not rec.quality.ok
    assert rec.smoothing.drowned or rec.smoothing.fitting_dim == 3
    if rec.smoothing.drowned:
        assert rec.smoothing.enough_samples > 1500
        assert "noise drowns the shape" in rec.quality.verdict


def test_layers_are_one_surface_by_default():
    """Of two a spacing apart nobody can say what is noise; farther apart they are two."""
    flat = np.random.default_rng(0).uniform(0, 40, (1600, 2))
    layer = np.arange(1600) % 2
    near, far = (np.column_stack([flat, d * layer]) for d in (0.5, 8.0))
    assert rm.reconstruct(near, 2).topology().components == 1
    assert not rm.smooth(far, 2, only_noise=True).moved
    assert rm.reconstruct(far, 2).topology().components == 2


@pytest.mark.parametrize(
    ("make", "dim", "fitting"),
    [
        (lambda: datasets.ball(2000, random_state=0), 2, 3),
        (lambda: datasets.torus(2000, random_state=0), 1, 2),
        (lambda: datasets.torus(2000, random_state=0), 3, 2),
        (lambda: datasets.trefoil(2000, random_state=0), 2, 1),
        (lambda: datasets.sphere(2000, dim=3, random_state=0), 2, 3),
    ],
)
def test_another_dimension_is_named_before_the_work(make, dim, fitting):
    points = make()
    # Warnings are errors here, and an error stops the reconstruction.
    with pytest.raises(rm.DimensionWarning, match=f"dim={fitting} may"):
        rm.reconstruct(points, dim)
    assert rm.smooth(points, dim, only_noise=True).fitting_dim == fitting
    right_dim = rm.smooth(points, fitting, only_noise=True)
    assert right_dim.fitting_dim is None
    assert not right_dim.moved


def test_a_solid_of_boundary_samples_is_doubted():
    points = datasets.sphere(60, random_state=0)
    with pytest.warns(rm.DimensionWarning, match="every sample is on the boundary"):
        rec = rm.reconstruct(points, 3)
    assert "every sample is on the boundary" in str(rec.quality.reasons)
    assert rm.reconstruct(datasets.ball(500, random_state=0), 3).quality.ok


def test_outliers_stay_where_they_are():
    points, _ = with_outliers(noisy_torus(1500, 0.02), 0.05)
    rec = rm.reconstruct(points, 2, smooth="auto")
    assert len(rec.outliers) > 40
    assert rec.smoothing.moved
    np.testing.assert_array_equal(rec.vertices[rec.outliers], points[rec.outliers])


def test_results_can_be_pickled_and_are_read_only():
    smoothed = rm.smooth(noisy_torus(300, 0.02), 2)
    again = pickle.loads(pickle.dumps(smoothed))
    np.testing.assert_array_equal(again.points, smoothed.points)
    for one in (smoothed, again):
        with pytest.raises(ValueError, match="read-only"):
            one.points[0, 0] = 0


def test_progress_names_the_steps():
    steps = set()
    rm.reconstruct(
        noisy_torus(40000, 0.01),
        2,
        smooth=True,
        num_threads=1,
        progress=lambda step, *_: steps.add(step),
    )
    assert "smoothing" in steps
