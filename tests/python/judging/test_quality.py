# SPDX-License-Identifier: GPL-3.0-or-later
"""The sampling report: its numbers, and what it makes of good and bad samples."""

import json
import math
import pickle
import subprocess
import sys
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold import datasets
from remanifold._base.samples import Distances, Gram, Points
from remanifold.judging import quality as judging
from remanifold.judging import signs

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
PER_SAMPLE = (
    *("spacing", "curvature", "reach", "sampling_ratio", "tangent_confidence"),
    *("disputed", "boundary", "fold", "gap", "doubtful"),
)
# (3 K (K + 3) / 2) neighbors of the narrow fits.
FITTED = {1: 6, 2: 15, 3: 27, 4: 42}


def reconstruct(*args, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        return rm.reconstruct(*args, **options)


@cache
def of_shape(name, num, seed=0):
    shape = datasets.SHAPES[name]
    return reconstruct(shape.generate(num, random_state=seed), shape.dim)


def same(a, b):
    for name in PER_SAMPLE:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    assert a.verdict == b.verdict


# --- The numbers ------------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("radius", [1.0, 1e-3])
def test_curvature_and_reach_of_spheres(dim, radius):
    rec = reconstruct(
        radius * datasets.sphere(2000, dim=dim, random_state=5), dim
    ).quality
    assert np.median(rec.curvature) == pytest.approx(1 / radius, rel=0.1)
    np.testing.assert_allclose(rec.reach, radius, rtol=0.12)
    np.testing.assert_allclose(rec.sampling_ratio, rec.spacing / rec.reach)
    assert rec.ok


def test_curvature_of_a_torus_is_that_of_the_tube():
    q = of_shape("torus", 3000).quality
    assert np.median(q.curvature) == pytest.approx(2.5, rel=0.1)
    assert np.quantile(q.reach, [0.01, 0.9]) == pytest.approx([0.4, 0.4], rel=0.15)


@pytest.mark.parametrize(("name", "dim"), [("trefoil", 1), ("torus", 2)])
def test_spacing_is_the_local_scale(name, dim):
    points = datasets.SHAPES[name].generate(300, random_state=3)
    rank = 10 if dim == 1 else 2 * dim + 2
    distances = cdist(points, points)
    order = np.argsort(distances, axis=1)[:, : rank + 1]  # itself first
    raw = np.sort(distances, axis=1)[:, rank]
    q = reconstruct(points, dim).quality
    np.testing.assert_allclose(q.spacing, np.median(raw[order], axis=1), rtol=1e-12)


def test_reach_by_its_definition():
    """Federer's formula on plain points and fitted frames."""
    points = datasets.torus(500, random_state=1)
    q = reconstruct(points, 2).quality
    near = rm.neighborhoods(points, 2 * FITTED[2]).indices
    bases = rm.tangent_spaces(points, 2, FITTED[2], "jet").bases
    vectors = points[near] - points[:, None]
    lengths = np.linalg.norm(vectors, axis=2)
    tangent = np.einsum("nkd,nmd->nmk", bases, vectors)
    normal = np.linalg.norm(vectors - np.einsum("nmk,nkd->nmd", tangent, bases), axis=2)
    far = lengths >= 0.75 * q.spacing[:, None]
    inverse = np.where(far, 2 * normal / lengths**2, 0).max(axis=1)
    np.testing.assert_allclose(q.reach, 1 / inverse, rtol=1e-6)


def test_a_flat_sheet_has_no_curvature_and_full_confidence():
    points = np.random.default_rng(0).uniform(size=(600, 2))
    for samples in (points, np.pad(points, [(0, 0), (0, 3)])):
        q = reconstruct(samples, 2).quality
        assert np.isinf(q.reach).all()
        assert q.curvature.max() < 1e-6
        np.testing.assert_allclose(q.tangent_confidence, 1.0)
        assert q.ok, str(q)


def test_boundary_samples_are_those_on_open_faces():
    rec = of_shape("spherical_cap", 400)
    assert rec.quality.boundary.any()
    np.testing.assert_array_equal(rec.quality.boundary, rec.boundary)
    assert not of_shape("torus", 400).quality.boundary.any()


def test_folds_of_a_cube_are_right_angles():
    rng = np.random.default_rng(0)
    points, faces = rng.uniform(size=(3000, 3)), rng.integers(0, 6, 3000)
    points[np.arange(3000), faces % 3] = faces // 3
    q = reconstruct(points, 2).quality
    inside = np.sort(np.minimum(points, 1 - points), axis=1)[:, 1] > 0.2
    assert q.fold[inside].max() < 1
    assert 40 < np.median(q.fold[~inside & (q.fold > 1)]) < 100


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.2])
def test_noise_is_what_was_added(noise):
    sphere = datasets.sphere(2000, random_state=0)
    spacing = np.median(reconstruct(sphere, 2).quality.spacing)
    moves = np.random.default_rng(1).normal(0, noise * spacing, 2000)
    q = reconstruct(sphere * (1 + moves)[:, None], 2, smooth=False).quality
    assert q.noise == pytest.approx(noise, rel=0.15, abs=1e-3)


def test_disputed_shares_count_stars():
    rec = of_shape("torus", 120)
    q, repair = rec.quality, rec.repair
    assert len(repair.disputed_simplices)
    untouched = np.ones(rec.num_samples, dtype=bool)
    untouched[repair.disputed_simplices.ravel()] = False
    assert (q.disputed[untouched] == 0).all()
    assert ((q.disputed[~untouched] > 0) & (q.disputed[~untouched] <= 1)).all()


# --- The same for the same samples --------------------------------------------------


@pytest.mark.parametrize(
    "name", ["trefoil", "moebius_band", "klein_bottle", "sphere_3"]
)
def test_products_tell_as_much_as_points(name):
    shape = datasets.SHAPES[name]
    points = shape.generate(200, random_state=5)
    known = reconstruct(points, shape.dim, smooth=False).quality
    for given in ({"gram": points @ points.T}, {"distances": cdist(points, points)}):
        q = reconstruct(dim=shape.dim, **given).quality
        for field in ("spacing", "curvature", "reach", "tangent_confidence"):
            np.testing.assert_allclose(
                getattr(q, field), getattr(known, field), rtol=1e-4, err_msg=field
            )
        assert q.ok == known.ok


@pytest.mark.slow
def test_many_coordinates_change_nothing():
    points = datasets.torus(300, random_state=0)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(300, 300)))[0]
    known = reconstruct(points, 2).quality
    q = reconstruct(np.pad(points, [(0, 0), (0, 297)]) @ turn, 2).quality
    np.testing.assert_allclose(q.reach, known.reach, rtol=1e-5)
    np.testing.assert_allclose(q.gap, known.gap, rtol=1e-5)


def test_units_do_not_matter():
    points = datasets.torus(90, random_state=0)
    known = reconstruct(points, 2).quality
    q = reconstruct(1e6 * points, 2).quality
    np.testing.assert_allclose(q.sampling_ratio, known.sampling_ratio, rtol=1e-6)
    np.testing.assert_allclose(q.spacing, 1e6 * known.spacing)
    np.testing.assert_allclose(q.curvature, known.curvature / 1e6, rtol=1e-6)
    assert [r.text for r in q.reasons] == [r.text for r in known.reasons]


def test_singular_places_are_those_that_a_search_of_their_own_finds():
    points = np.concatenate([datasets.figure_eight(300, random_state=0)] * 2)
    found = rm.find_singularities(points[:300], 1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        q = rm.reconstruct(points, 1).quality
    marked = {int(i) for place in found.places for i in place.samples}
    assert marked
    assert q.reasons[0].text == found.verdict
    count = len(q.reasons[0].samples)
    said = str(q.reasons[0])
    assert max(map(len, said.splitlines())) <= 88
    one = " ".join(said.split())
    assert one.startswith(f"{q.reasons[0].kind}: {' '.join(q.reasons[0].text.split())}")
    assert f"samples={count}, kind=" in repr(q.reasons[0])
    assert set(q.reasons[0].samples.tolist()) == marked
    assert set(np.flatnonzero(q.doubtful[300:])) == set(
        np.flatnonzero(q.doubtful[:300])
    )


def test_threads_do_not_matter():
    points, rec = datasets.torus(1500, random_state=0), of_shape("torus", 1500)
    found = [
        rm._core.quality(
            Points(points),
            rec.simplices,
            None,
            num_neighbors=0,
            num_listed=40,
            search="auto",
            checks=256,
            num_threads=threads,
            progress=None,
        )
        for threads in (1, 2, 7)
    ]
    for other in found[1:]:
        for name, values in found[0].items():
            assert values.tobytes() == other[name].tobytes(), name


@pytest.mark.parametrize(
    ("shape", "num"),
    # Of 29 samples tangent spaces are fitted to 14 neighbors, not to 15.
    [("torus", 29), ("torus", 600), ("circle", 60), ("sphere_3", 400)],
)
def test_known_tangent_spaces_are_those_that_would_be_fitted(shape, num):
    rec = of_shape(shape, num)
    q = rec.quality
    fitted = rm._core.quality(
        Points(rec.vertices),
        rec.simplices,
        None,
        num_neighbors=0,
        num_listed=0,
        search="auto",
        checks=256,
        num_threads=1,
        progress=None,
    )
    np.testing.assert_allclose(q.reach, fitted["reach"], rtol=1e-9)
    np.testing.assert_allclose(q.tangent_confidence, fitted["tangent_share"], rtol=1e-9)


def test_copies_have_the_values_of_their_sample():
    points = datasets.spherical_cap(150, random_state=1)
    copies = np.concatenate([points, points[::3]])
    q, once = reconstruct(copies, 2).quality, reconstruct(points, 2).quality
    for name in PER_SAMPLE:
        values = getattr(q, name)
        np.testing.assert_array_equal(values[150:], values[:150:3], err_msg=name)
        np.testing.assert_array_equal(values[:150], getattr(once, name), err_msg=name)
    assert q.verdict == once.verdict


def test_computed_once_read_only_and_pickled():
    rec = reconstruct(datasets.torus(50, random_state=0), 2)
    q = rec.quality
    assert rec.quality is q
    assert q.reasons
    for array in [getattr(q, name) for name in PER_SAMPLE] + [
        reason.samples for reason in q.reasons
    ]:
        with pytest.raises(ValueError, match="read-only"):
            array[:1] = 0
    same(pickle.loads(pickle.dumps(rec)).quality, q)
    gram = reconstruct(gram=rec.vertices @ rec.vertices.T, dim=2)
    same(pickle.loads(pickle.dumps(gram)).quality, gram.quality)


# --- The verdict --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "num"),
    [
        *(("circle", 50), ("trefoil", 200), ("spiral", 800), ("sphere", 50)),
        *(("torus", 200), ("klein_bottle", 250), ("moebius_band", 500)),
        *(("annulus_in_4", 500), ("spherical_cap", 300), ("uneven_torus", 4000)),
        *(("sphere_3", 150), ("bent_ball", 400), ("rotations", 200), ("sphere_4", 300)),
    ],
)
def test_quiet_where_the_samples_do(name, num):
    q = of_shape(name, num, 11).quality
    assert q.ok, str(q)
    assert q.reasons == ()
    assert not q.doubtful.any()
    assert q.recommended_samples is None
    assert q.verdict.startswith("sampling is dense enough: ")
    said = "nothing bends" if name == "annulus_in_4" else " times the reach"
    assert q.verdict.endswith(f"{said} at 95 % of {num:,} samples")


@pytest.mark.parametrize(
    ("name", "num"),
    [
        *(("torus", 70), ("flat_torus", 30), ("interlocking_tori", 280)),
        *(("klein_bottle", 60), ("spherical_cap", 30), ("annulus_in_4", 40)),
        *(("moebius_band", 30), ("swiss_roll", 180), ("flat_torus_3", 40)),
        *(("rotations", 35), ("spiral", 35), ("uneven_double_torus", 300)),
    ],
)
def test_doubts_where_the_result_is_wrong(name, num):
    shape = datasets.SHAPES[name]
    rec = of_shape(name, num, 11)
    assert rec.topology().betti_numbers != shape.betti_numbers
    q = rec.quality
    assert not q.ok
    assert q.reasons
    lines = str(q).splitlines()
    assert lines[0] == q.verdict
    assert [f"- {reason.text}" for reason in q.reasons] == lines[1:]


def test_an_edge_across_a_turn_of_a_spiral_is_seen():
    points = datasets.spiral(100, random_state=202)
    rec = reconstruct(points, 1)
    assert rec.topology().closed  # the ends are joined, through what lies between
    (reason,) = (r for r in rec.quality.reasons if "right by other samples" in r.text)
    ends = points[reason.samples]
    assert cdist(ends, ends).max() > 1.9  # twice the distance of the turns


def test_distances_to_the_middle_of_an_edge():
    points = np.random.default_rng(0).normal(size=(9, 4))
    expected = ((points - (points[2] + points[5]) / 2) ** 2).sum(axis=1)
    for samples in (
        Points(points),
        Gram(points @ points.T),
        Distances(cdist(points, points)),
    ):
        np.testing.assert_allclose(samples.squares_to_middle(2, 5), expected)


def test_verdict_counts_places_and_recommends():
    rec = of_shape("torus", 70, 11)
    q = rec.quality
    named = np.unique(np.concatenate([reason.samples for reason in q.reasons]))
    np.testing.assert_array_equal(np.flatnonzero(q.doubtful), named)
    head = f"sampling is too sparse at {len(named)} of 70 samples, "
    assert q.verdict.startswith(head)
    place = int(q.verdict.split("near sample ")[1].split(" ")[0])
    assert q.doubtful[place]
    where = ", ".join(f"{c:.4g}" for c in rec.vertices[place])
    assert f"near sample {place} at ({where})" in q.verdict
    assert q.verdict.endswith(f"about {q.recommended_samples:,} would do")
    # With as many as that it is right and says so.
    more = of_shape("torus", q.recommended_samples, 11)
    assert more.topology().betti_numbers == (1, 2, 1)
    assert more.quality.ok


@pytest.mark.parametrize(("distance", "ok"), [(0.6, False), (5.0, True)])
def test_two_sheets(distance, ok):
    points = np.random.default_rng(0).uniform(size=(600, 3))
    spacing = np.median(reconstruct(points[:300, :2], 2).quality.spacing)
    points[:, 2] = np.repeat([0, distance * spacing], 300)
    q = reconstruct(points, 2, smooth=False).quality
    assert q.ok == ok, str(q)
    assert any("far along the result" in r.text for r in q.reasons) == (not ok)


def test_a_hole_that_was_closed_is_named():
    points = np.random.default_rng(0).uniform(-1, 1, size=(3000, 2))
    spacing = np.median(reconstruct(points, 2).quality.spacing)

    def with_hole(radius):
        kept = points[np.linalg.norm(points, axis=1) > radius * spacing]
        return reconstruct(np.pad(kept, [(0, 0), (0, 1)]), 2)

    rec = with_hole(1.5)
    assert rec.topology().boundary_components == 1  # it was closed
    q = rec.quality
    said = "was closed, but chance leaves one as large in 0.02"
    (reason,) = (r for r in q.reasons if said in r.text)
    assert np.linalg.norm(rec.vertices[reason.samples], axis=1).max() < 4 * spacing
    assert np.linalg.norm(rec.vertices[np.argmax(q.gap)]) < 4 * spacing
    # As that says, more is asked of evidence, or less.
    flips = rec.openings[0].significance
    for share, holes in ((0.9, 1), (1.1, 2)):
        again = reconstruct(rec.vertices, 2, significance=share * flips)
        assert again.topology().boundary_components == holes


def test_an_opening_that_chance_could_have_left_is_named():
    points = np.random.default_rng(0).uniform(-1, 1, size=(3000, 2))
    spacing = np.median(reconstruct(points, 2).quality.spacing)
    kept = points[np.linalg.norm(points, axis=1) > 1.8 * spacing]
    rec = reconstruct(np.pad(kept, [(0, 0), (0, 1)]), 2)
    assert rec.topology().boundary_components == 2
    (hole,) = (one for one in rec.openings if one.decision == "open")
    assert 1e-4 < hole.significance <= 1e-3
    said = f"left open, but below significance={hole.significance:.2g} it is closed"
    assert any(said in reason.text for reason in rec.quality.reasons)
    wide = points[np.linalg.norm(points, axis=1) > 2.4 * spacing]
    sure = reconstruct(np.pad(wide, [(0, 0), (0, 1)]), 2)
    assert sure.topology().boundary_components == 2
    assert sure.quality.ok, str(sure.quality)


@pytest.mark.parametrize(("seed", "joined"), [(12, True), (3, False), (4, False)])
def test_strips_between_two_sheets_are_told(seed, joined):
    flat = np.random.default_rng(seed).random((1000, 2))
    height = np.where(np.arange(1000) % 2, 3.2 / math.sqrt(500), 0)
    rec = reconstruct(np.c_[flat, height], 2)
    assert (rec.topology().betti_numbers != (2, 0, 0)) == joined
    assert ("strip" in str(rec.quality)) == joined
    assert rec.quality.ok != joined


def test_noise_is_no_reason():
    points = datasets.sphere(1500, random_state=0)
    moves = np.random.default_rng(1).normal(0, 0.15 * 0.1, 1500)  # 0.15 spacings
    points *= (1 + moves)[:, None]
    rec = reconstruct(points, 2, smooth=False)
    assert rec.topology().betti_numbers == (1, 0, 1)
    assert rec.quality.noise > 0.1
    assert rec.quality.ok, str(rec.quality)
    smoothed = reconstruct(points, 2)
    assert smoothed.smoothing.noise == pytest.approx(0.015, rel=0.1)
    assert smoothed.quality.noise < 0.02
    assert smoothed.quality.ok, str(smoothed.quality)


def two_segments(rng, spacings, noise=0.0):
    points = np.c_[rng.random(400), np.zeros(400)]
    points[::2, 1] = spacings / 200
    return points + noise / 200 * rng.normal(size=points.shape)


@pytest.mark.parametrize("seed", range(3))
def test_layers_are_no_noise(seed):
    points = two_segments(np.random.default_rng(seed), 3.0)
    rec = reconstruct(points, 1)
    assert rec.smoothing.layers
    assert not rec.smoothing.moved
    assert "layers" in repr(rec.smoothing)
    apart = reconstruct(points, 1, smooth=False)
    np.testing.assert_array_equal(rec.simplices, apart.simplices)
    joined = reconstruct(points, 1, smooth=True)
    assert joined.smoothing.moved
    assert joined.topology().components == 1
    assert "joined two layers" in str(joined.quality)
    assert not joined.quality.ok


@pytest.mark.parametrize("seed", range(3))
def test_layers_with_noise_are_told(seed):
    points = two_segments(np.random.default_rng(seed), 3.0, 0.5)
    joined = reconstruct(points, 1, smooth=True)
    assert joined.topology().components == 1
    assert "joined two layers" in str(joined.quality)


@pytest.mark.parametrize("normals", [1, 2, 5])
def test_directions_of_noise(normals):
    squares = (np.random.default_rng(0).normal(size=(4000, normals)) ** 2).sum(axis=1)
    squares[:200] *= 100  # what is no noise
    found = signs._normal_directions(squares, 10)
    assert found == pytest.approx(normals, rel=0.15)
    assert signs._normal_directions(squares, 1) == 1


@pytest.mark.parametrize("normals", [1, 2, 5])
def test_one_peak_is_no_layers(normals):
    rng = np.random.default_rng(normals)
    vectors = rng.normal(size=(4000, normals))
    one = (vectors**2).sum(axis=1)
    assert not signs._has_layers(one, normals)
    flat = rng.random(4000) ** (2 / normals)  # evenly in a ball
    assert not signs._has_layers(flat, normals)
    vectors[:, 0] += 2 * normals * rng.choice([-1, 1], 4000)
    assert signs._has_layers((vectors**2).sum(axis=1), normals)


def test_noise_in_fewer_directions_than_coordinates():
    points = datasets.trefoil(700, random_state=1)
    spacing = np.median(rm.neighborhoods(points, 1).distances)
    points += spacing * np.random.default_rng(0).normal(size=points.shape)
    rec = reconstruct(datasets.embed(points, 35, random_state=0), 1)
    assert rec.smoothing.moved
    assert "moved" not in str(rec.quality)


@pytest.mark.parametrize("seed", range(3))
def test_noise_of_one_layer_is_none_of_two(seed):
    moves = np.random.default_rng(seed).normal(0, 0.01, size=1000)
    rec = reconstruct(datasets.circle(1000, random_state=0) * (1 + moves)[:, None], 1)
    assert rec.smoothing.moved
    assert "smoothing" not in str(rec.quality)


@pytest.mark.parametrize(("spacings", "noise"), [(12.5, 0.5), (18.0, 0.2), (25.0, 0.1)])
def test_smoothing_keeps_to_one_sheet(spacings, noise):
    """At their ends the two are within each other's neighborhoods."""
    rec = reconstruct(two_segments(np.random.default_rng(1), spacings, noise), 1)
    assert rec.smoothing.moved
    assert rec.topology().components == 2
    assert not any("moved" in reason.text for reason in rec.quality.reasons)
    heights = rec.vertices[:, 1] * 200
    away = np.minimum(np.abs(heights), np.abs(heights - spacings))
    assert away.max() < 4 * noise


def test_samples_moved_beyond_noise_are_told():
    rec = reconstruct(two_segments(np.random.default_rng(1), 18.0, 0.2), 1, smooth=36)
    assert rec.smoothing.moved
    (reason,) = (r for r in rec.quality.reasons if "moved" in r.text)
    assert not rec.quality.ok
    ends = np.abs(rec.samples[reason.samples, 0] - 0.5)
    assert ends.min() > 0.35


def test_the_chance_of_gaps_is_that_of_a_poisson_process():
    special = pytest.importorskip("scipy.special")
    gaps = np.array([0.0, 0.5, 1.0, 2.0])
    for dim in (1, 2, 3, 4):
        inside = (10 if dim == 1 else 2 * dim + 2) * gaps**dim
        np.testing.assert_allclose(
            10 ** signs._log_chance(gaps, dim), special.gammaincc(dim, inside)
        )


def test_too_few_samples():
    for dim, least in FITTED.items():
        rec = reconstruct(datasets.sphere(least, dim=dim, random_state=0), dim)
        q = rec.quality
        assert not q.ok
        assert f"{least} samples are fewer than the {least + 1}" in q.verdict
        assert not q.doubtful.any()


@pytest.mark.parametrize(
    ("points", "dim"),
    [
        (np.random.default_rng(0).uniform(size=(3, 2)), 2),
        (np.random.default_rng(0).uniform(size=(60, 1)), 1),
        (np.random.default_rng(0).uniform(size=(60, 3)), 3),
        (np.random.default_rng(0).uniform(size=(40, 5)), 5),
        (np.zeros((8, 3)), 2),
        (np.linspace(0, 1, 40)[:, None] * [1.0, 2.0, 3.0], 2),
        (np.stack(np.meshgrid(range(12), range(12)), axis=-1).reshape(-1, 2), 2),
    ],
    ids=["triangle", "line", "solid", "dim5", "one point", "collinear", "grid"],
)
def test_degenerate_samples(points, dim):
    q = reconstruct(np.asarray(points, dtype=float), dim).quality
    for name in PER_SAMPLE:
        assert len(getattr(q, name)) == len(points)
    assert math.isnan(q.noise) or q.noise >= 0
    assert "\n" not in q.verdict


def test_the_paper_method_has_a_report_too():
    rec = reconstruct(datasets.torus(400, random_state=0), 2, method="paper")
    assert not rec.quality.ok
    assert "no manifold" in rec.quality.verdict
    assert (rec.quality.disputed == 0).all()


# --- Command lines --------------------------------------------------------------------


def test_command_line(tmp_path):
    np.save(tmp_path / "torus.npy", datasets.torus(70, random_state=0))
    command = [sys.executable, "-m", "remanifold", "reconstruct", "-k", "2"]
    command += [str(tmp_path / "torus.npy"), "-o", str(tmp_path / "torus.ply")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "sampling is too sparse at" in done.stdout
    done = subprocess.run(
        [*command, "--json"], capture_output=True, text=True, check=True
    )
    found = json.loads(done.stdout)["sampling"]
    q = reconstruct(np.load(tmp_path / "torus.npy"), 2).quality
    assert found == {
        "ok": False,
        "verdict": q.verdict,
        "reasons": [reason.text for reason in q.reasons],
        "doubtful_samples": int(q.doubtful.sum()),
        "recommended_samples": q.recommended_samples,
        "noise": q.noise,
    }


@pytest.mark.slow
def test_benchmark(tmp_path):
    file = tmp_path / "critical.json"
    done = subprocess.run(
        [
            *(sys.executable, str(BENCHMARKS / "critical_sampling.py"), "--markdown"),
            *("--shape", "projective_plane", "--seeds", "1", "--json", str(file)),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    (result,) = json.loads(file.read_text(encoding="utf-8"))["results"]
    assert result["runs"] == result["wrong"] + result["right"] == 10
    assert 0 < result["warned"] <= result["wrong"]
    assert result["false alarms"] <= 2
    head, _, row, total = done.stdout.splitlines()
    assert head == "|  | samples | runs | wrong | warned | right | false alarms |"
    assert row.startswith("| projective plane in R^5 | ")
    assert total.startswith("| all |")


@pytest.mark.parametrize(
    ("draw", "says"),
    [
        (lambda: datasets.sphere_with_antenna(1500, random_state=0), "dimension 1"),
        (lambda: datasets.crossing_balls(1500, random_state=0), "cross"),
    ],
)
def test_data_that_is_no_manifold_is_said(draw, says):
    points = draw()
    q = reconstruct(points, 2).quality
    assert not q.ok
    assert q.verdict.startswith("no 2-manifold")
    assert says in q.verdict
    assert 0 < np.count_nonzero(q.doubtful) < len(points)


def test_outliers_have_no_values():
    rng = np.random.default_rng(0)
    points = np.vstack(
        [datasets.sphere(900, random_state=0), rng.uniform(-2, 2, (20, 3))]
    )
    rec = reconstruct(points, 2)
    q = rec.quality
    assert len(rec.outliers) > 10
    assert np.isnan(q.spacing[rec.outliers]).all()
    kept = np.setdiff1d(np.arange(920), rec.outliers)
    alone = reconstruct(points[kept], 2).quality
    np.testing.assert_allclose(q.spacing[kept], alone.spacing)
    np.testing.assert_allclose(q.fold[kept], alone.fold)


def test_clutter_is_no_reason_but_what_may_be_a_part_is():
    sphere = datasets.sphere(900, random_state=0)
    clutter = np.random.default_rng(0).uniform(-2, 2, (90, 3))
    rec = reconstruct(np.vstack([sphere, clutter]), 2)
    assert len(rec.outliers) > 0.05 * 990
    assert rec.quality.ok, str(rec.quality)
    # As many on a second sphere are a part of a surface.
    part = 3 * datasets.sphere(60, random_state=2)
    rec = reconstruct(np.vstack([sphere, part]), 2)
    assert len(rec.outliers) == 60
    assert "60 samples were left out as outliers" in str(rec.quality)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_dimension_that_samples_fill(dim):
    cube = np.pad(np.random.default_rng(dim).random((128, dim)), [(0, 0), (0, 5 - dim)])
    cube[0] = cube[1]
    samples = Points(cube)
    found, count = signs._dimension_of(samples, np.arange(128))
    assert count == 126 * 3
    assert abs(found - dim) < 2.5 * dim / math.sqrt(126)


def test_folds_around_single_samples_are_no_reason_among_stray_ones():
    clutter = np.random.default_rng(0).uniform(-1.4, 1.4, (70, 3))
    points = np.vstack([datasets.torus(700, random_state=0), clutter])
    rec = reconstruct(points, 2)
    assert rec.topology().betti_numbers == (1, 2, 1)
    assert np.count_nonzero(rec.quality.fold > 130) >= 4
    assert rec.quality.ok, str(rec.quality)


def test_samples_in_rows_are_not_far_along_the_result():
    rng = np.random.default_rng(0)
    y, x = np.meshgrid(np.arange(15) / 15, np.arange(75) / 75, indexing="ij")
    x = x + rng.uniform(-0.2, 0.2, x.shape) / 75
    height = 0.1 * np.sin(7 * x) * np.cos(5 * y)
    rec = reconstruct(np.stack([x, y, height], axis=-1).reshape(-1, 3), 2)
    assert rec.topology().betti_numbers == (1, 0, 0)
    assert "far along" not in str(rec.quality)


def test_what_was_smoothed_from_products_is_judged():
    points = datasets.sphere(200, random_state=0)
    rec = reconstruct(gram=points @ points.T, dim=2, smooth=True)
    assert rec.topology().name == "a sphere"
    assert np.isfinite(rec.quality.spacing).all()


def test_gaps_that_were_closed_as_asked_are_no_reason():
    angles = np.random.default_rng(0).random(300) * 5.5
    arc = np.c_[np.cos(angles), np.sin(angles)]
    assert "was closed" not in str(reconstruct(arc, 1, boundary=False).quality)
    asked = str(reconstruct(arc, 1, hole_radius=50.0).quality)
    assert "closed because hole_radius is 50" in asked


def test_neighbors_that_are_found_later_show_the_same(monkeypatch):
    # A stray sample, two spheres that meet in a circle, copies.
    sphere = datasets.sphere(2000, random_state=0)
    other = datasets.sphere(2000, random_state=1) + np.array([0.8, 0, 0])
    points = np.concatenate([[[9.0, 9, 9]], sphere, other, sphere[:50]])
    rec = reconstruct(points, 2)
    assert len(rec.left_out) == 1
    at_once = judging.assess(rec)
    monkeypatch.setattr(judging, "FEW", 0)
    later = judging.assess(rec)
    assert "singular" in [reason.kind for reason in at_once.reasons]
    assert str(later) == str(at_once)
    assert later.doubtful.tobytes() == at_once.doubtful.tobytes()
