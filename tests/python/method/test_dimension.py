# SPDX-License-Identifier: GPL-3.0-or-later
"""The intrinsic dimension: right where it is known, and honest where it is not."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from typer.testing import CliRunner

import remanifold as rm
from remanifold import cli, datasets

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))

import dimensions
from other_manifolds import OTHERS
from samples import add_normal_noise

ROWS = {row.name: row for row in dimensions.rows()}
try:
    RUNNER = CliRunner(mix_stderr=False)
except TypeError:  # newer Typer always keeps standard error apart
    RUNNER = CliRunner()


def estimate(points=None, **options):
    return rm.estimate_dimension(points, num_threads=1, **options)


def share(found, dim, part=slice(None)):
    return np.mean(found.per_sample[part] == dim)


# --------------------------------------------------------------- known dimensions


@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS)
def test_every_shape(name):
    row = ROWS[name]
    dim = datasets.SHAPES[row.shape].dim
    found = estimate(row.draw(row.num_samples, 7))
    assert found.dim == dim, found.verdict
    assert found.confidence > 0.6
    assert share(found, dim) > 0.97
    assert np.abs(found.estimates["local_pca"] - dim) < 0.1


def test_every_shape_is_tested():
    assert {row.shape for row in ROWS.values()} == set(datasets.SHAPES)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "confidence"),
    [
        *(("circle", 0.8), ("closed_curve_in_100", 0.6), ("torus", 0.6)),
        *(("swiss_roll", 0.8), ("bent_ball", 0.8), ("rotations", 0.2)),
        *(("flat_torus_3", 0.4), ("sphere_4", 0.7), ("flat_torus_in_100", 0.05)),
    ],
)
def test_noise_of_half_the_spacing(name, confidence):
    row = ROWS[name]
    dim = datasets.SHAPES[row.shape].dim
    clean = row.draw(row.num_samples, 3)
    found = estimate(add_normal_noise(clean, dim, 0.5, 3, row.draw))
    assert found.dim == dim, found.verdict
    assert share(found, dim) > 0.95
    assert confidence < found.confidence < estimate(clean).confidence + 0.05


def test_noise_that_hides_small_scales_is_said():
    row = ROWS["rotations"]
    noisy = add_normal_noise(row.draw(800, 0), 3, 0.5, 0, row.draw)
    found = estimate(noisy)
    assert found.dims[0] == 0
    assert "nothing is clear, as with noise" in found.verdict


@pytest.mark.slow
@pytest.mark.parametrize("manifold", OTHERS, ids=lambda manifold: manifold.label)
def test_other_manifolds(manifold):
    found = estimate(manifold.draw(manifold.num_samples, 11))
    assert found.dim == manifold.dim, found.verdict
    # The Lissajous curve turns within a few of its samples.
    least = 0.6 if "Lissajous" in manifold.label else 0.95
    assert share(found, manifold.dim) > least


@pytest.mark.parametrize("dim", [1, 2, 3, 4, 5])
def test_samples_that_fill_their_space(dim):
    rng = np.random.default_rng(dim)
    blob = rng.normal(size=(1000, dim))
    found = estimate(blob)
    assert (found.dim, share(found, dim)) == (dim, 1)
    # In which space does not matter, nor where.
    turn = np.linalg.qr(rng.normal(size=(30, 30)))[0][:dim]
    again = estimate(1e3 * blob @ turn + 1e4)
    np.testing.assert_array_equal(again.per_sample, found.per_sample)
    assert again.confidence == pytest.approx(found.confidence, abs=1e-3)


def test_few_and_many_samples():
    for count in (60, 100_000):
        points = datasets.sphere(count, random_state=1)
        found = estimate(points)
        assert (found.dim, found.confidence > 0.6) == (2, True)
        assert found.per_sample.shape == found.per_sample_confidence.shape == (count,)


@pytest.mark.parametrize("dim", [2, 3])
def test_grids_are_full_of_ties(dim):
    side = {2: 30, 3: 12}[dim]
    grid = np.stack(np.meshgrid(*[np.arange(side)] * dim), axis=-1).reshape(-1, dim)
    assert estimate(grid).dim == dim
    # Rows closer than columns look like curves at first; the larger scales know better.
    rows = np.stack(np.meshgrid(np.arange(200), 4 * np.arange(40)), axis=-1)
    found = estimate(rows.reshape(-1, 2))
    assert (found.dim, found.dims[0]) == (2, 1)
    assert "at 6 neighbors it looks 1-dimensional" in found.verdict


def test_mixed_dimensions_are_told_apart():
    rng = np.random.default_rng(0)
    ball = datasets.ball(2000, random_state=0)
    x, y = rng.uniform([1, -2], [5, 2], (1500, 2)).T
    sheet = np.column_stack([x, y, 0.2 * np.sin(x)])
    t = np.linspace(1, 4, 300)
    curve = np.column_stack([0 * t, 0.2 * np.sin(2 * t), -t])
    found = estimate(np.vstack([ball, sheet, curve]))
    parts = slice(0, 2000), slice(2000, 3500), slice(3500, None)
    for dim, part in zip((3, 2, 1), parts, strict=True):
        assert share(found, dim, part) > 0.9
        assert found.per_sample_confidence[part].mean() > 0.6
    assert found.confidence < 0.6
    assert "of the samples" in found.verdict

    sphere = datasets.sphere(2000, random_state=0)
    found = estimate(np.vstack([sphere, curve]))
    assert found.dim == 2
    assert share(found, 2, slice(0, 2000)) > 0.99
    assert share(found, 1, slice(2000, None)) > 0.98


def test_without_any_clear_dimension():
    """Variances that fade out evenly: what comes is nearest to the distances."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(1500, 30)) * 0.75 ** np.arange(30)
    found = estimate(points)
    assert not found.dims.any()
    assert found.confidence == 0
    assert found.dim == pytest.approx(found.estimates["maximum_likelihood"], abs=1)
    assert "no scale shows a clear one" in found.verdict
    assert 2 < found.dim < 10
    assert (found.per_sample > 0).all()


# ------------------------------------------------------------ the estimators


def test_estimators_from_distances():
    """By the formulas, over all pairs."""
    points = datasets.torus(500, random_state=0)
    found = estimate(points, num_neighbors=20)
    assert found.num_neighbors == 20
    assert found.scales.tolist() == [20]
    sorted_ = np.sort(cdist(points, points), axis=1)[:, 1:21]
    inverse = np.log(sorted_[:, -1:] / sorted_[:, :-1]).mean(axis=1)
    likelihood = found.estimates["maximum_likelihood"]
    assert likelihood == pytest.approx(1 / inverse.mean(), rel=1e-12)
    # Twice the rank: the exponent of r_20 / r_10 is a Beta variable.
    mean = np.mean(np.log(sorted_[:, 19] / sorted_[:, 9]))
    expected = sum(1 / j for j in range(10, 20)) / mean
    assert found.estimates["two_nn"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
def test_products_are_as_good_as_points():
    points = np.vstack(
        [
            datasets.sphere(400, random_state=0),
            [[0, 0, z] for z in np.linspace(1, 3, 80)],
        ]
    )
    points = np.vstack([points, points[:30]])
    found = estimate(points)
    assert set(found.per_sample[:400]) == {2}
    for other in (
        estimate(gram=points @ points.T),
        estimate(distances=cdist(points, points)),
        estimate(
            points[:, :2] + 1j * np.column_stack([points[:, 2], 0 * points[:, 2]])
        ),
    ):
        assert other.dim == found.dim
        np.testing.assert_array_equal(other.per_sample, found.per_sample)
        np.testing.assert_array_equal(other.dims, found.dims)
        assert other.confidence == pytest.approx(found.confidence, rel=1e-6)
        assert other.estimates == pytest.approx(found.estimates, rel=1e-6)


def test_copies_count_once():
    points = datasets.moebius_band(500, random_state=0)
    found = estimate(points)
    copies = np.concatenate([np.arange(500), np.arange(200), np.zeros(60, dtype=int)])
    again = estimate(points[copies])
    np.testing.assert_array_equal(again.per_sample, found.per_sample[copies])
    assert again.estimates == found.estimates
    assert again.confidence == pytest.approx(found.confidence, rel=0.01)


def test_same_input_same_result():
    points = datasets.klein_bottle(1500, random_state=0)
    first = estimate(points)
    for factor, threads in ((1.0, 3), (2.0**-300, 1), (2.0**300, 2)):
        again = rm.estimate_dimension(points * factor, num_threads=threads)
        for name in ("per_sample", "per_sample_confidence", "scales", "dims"):
            np.testing.assert_array_equal(getattr(again, name), getattr(first, name))
        assert again.confidence == first.confidence
        assert again.estimates == first.estimates


def test_progress():
    seen = []
    estimate(datasets.sphere(200, random_state=0), progress=lambda *s: seen.append(s))
    assert {"scales", "spectra", "dimensions"} <= {s[0] for s in seen}
    assert seen[-1] == ("dimensions", 200, 200)

    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        estimate(datasets.sphere(200, random_state=0), progress=stop)


# ------------------------------------------------------------------ the result


def test_result():
    found = estimate(datasets.torus(400, random_state=0))
    assert str(found) == found.verdict
    assert found.verdict.startswith(f"dimension 2, confidence {found.confidence:.2f} (")
    assert repr(found) == (
        f"DimensionEstimate(dim=2, confidence={found.confidence:.2f}, samples=400)"
    )
    for array in (found.per_sample, found.per_sample_confidence, found.dims):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(AttributeError):
        found.dim = 3
    again = pickle.loads(pickle.dumps(found))
    assert again.verdict == found.verdict
    assert not again.per_sample.flags.writeable
    assert (
        (found.per_sample_confidence >= 0) & (found.per_sample_confidence <= 1)
    ).all()


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((100, 3)), "has 1 different sample; an estimate .* at least 10$"),
        (np.eye(9), "has 9 different samples"),
        (np.zeros((0, 3)), "points is empty"),
        (np.full((20, 2), np.nan), r"points\[0, 0\] is nan"),
        (np.zeros(20), "two-dimensional array"),
    ],
)
def test_refused_samples(points, message):
    with pytest.raises(ValueError, match=message):
        estimate(points)


def test_refused_arguments():
    points = datasets.circle(50, random_state=0)
    with pytest.raises(ValueError, match="num_neighbors is 5, expected at least 6"):
        estimate(points, num_neighbors=5)
    with pytest.raises(TypeError, match="num_neighbors must be an integer"):
        estimate(points, num_neighbors=8.0)
    with pytest.raises(TypeError, match="exactly one of"):
        estimate(points, gram=points @ points.T)
    lengths = cdist(points, points)
    lengths[0, 1] *= 2
    with pytest.raises(ValueError, match="distances is not symmetric"):
        estimate(distances=lengths)
    assert estimate(points, num_neighbors=10**6).num_neighbors == 49


# -------------------------------------------------------------- where it is used


def test_reconstruct_with_the_dimension_found():
    points = datasets.torus(400, random_state=0)
    rec = rm.reconstruct(points, "auto")
    assert rec.dim == 2
    np.testing.assert_array_equal(rec.simplices, rm.reconstruct(points, 2).simplices)
    assert rm.reconstruct(gram=points @ points.T, dim="auto").dim == 2
    with pytest.raises(TypeError, match="dim must be an integer, got 'two'"):
        rm.reconstruct(points, "two")


UNCLEAR = np.random.default_rng(0).normal(size=(30, 3)) * [1, 0.6, 0.3]


@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
def test_reconstruct_warns_of_a_dimension_in_doubt():
    with pytest.warns(rm.DimensionWarning, match="is uncertain") as caught:
        rec = rm.reconstruct(UNCLEAR, "auto")
    assert caught[0].filename == __file__
    assert rec.dim == estimate(UNCLEAR).dim


@pytest.fixture
def torus(tmp_path):
    path = tmp_path / "torus.npy"
    np.save(path, datasets.torus(400, random_state=0))
    return path


@pytest.fixture
def unclear(tmp_path):
    path = tmp_path / "unclear.npy"
    np.save(path, UNCLEAR)
    return path


def run(*arguments):
    return RUNNER.invoke(cli.app, [str(argument) for argument in arguments])


def test_command(torus):
    result = run("dimension", torus)
    assert (result.exit_code, result.stderr) == (0, "")
    rows = dict(
        line.split("  ", 1) for line in result.stdout.splitlines() if line[0] != " "
    )
    rows = {name: value.strip() for name, value in rows.items()}
    found = estimate(np.load(torus))
    assert rows["samples"] == "400 in R^3"
    assert rows["dimension"] == "2"
    assert rows["confidence"] == f"{found.confidence:.2f}"
    assert rows["by samples"] == "2 at 400"
    assert rows["by neighbors"].startswith("unclear at 6, 2 at 8 to ")
    assert rows["TwoNN"] == f"{found.estimates['two_nn']:.2f}"

    report = json.loads(run("dimension", torus, "--json").stdout)
    assert (report["dim"], report["num_samples"], report["ambient_dim"]) == (2, 400, 3)
    assert report["confidence"] == found.confidence
    assert report["samples_by_dim"] == {"2": 400}
    assert report["verdict"] == found.verdict
    assert report["dims"] == found.dims.tolist()
    assert set(report["seconds"]) == {"read", "dimension"}

    options = ("--num-neighbors", 30, "--num-threads", 1, "--json", "--quiet")
    assert json.loads(run("dimension", torus, *options).stdout)["num_neighbors"] == 30


def test_command_says_what_is_uncertain(unclear, tmp_path):
    result = run("dimension", unclear)
    assert result.exit_code == 0
    assert (
        "warning: the dimension is uncertain, give it if it is known" in result.stderr
    )
    assert run("dimension", unclear, "--quiet").stderr == ""
    result = run("dimension", tmp_path / "absent.npy")
    assert result.exit_code == 1
    assert "error: " in result.stderr
    assert run("dimension", unclear, "--num-neighbors", 3).exit_code == 2


def test_dim_auto(torus, unclear, tmp_path):
    output = tmp_path / "mesh.ply"
    result = run("reconstruct", torus, "--dim", "auto", "-o", output)
    assert result.exit_code == 0
    found = estimate(np.load(torus))
    assert result.stderr == f"remanifold: {found.verdict}\n"
    assert f"2 (estimated, confidence {found.confidence:.2f})" in result.stdout
    options = ("reconstruct", torus, "-k", "auto", "-o", output, "--json", "-q")
    result = run(*options)
    assert result.stderr == ""
    report = json.loads(result.stdout)
    assert report["dim"] == 2
    assert report["dim_estimate"]["confidence"] == found.confidence
    assert report["warnings"] == []
    assert [*report["seconds"]][:2] == ["read", "dimension"]

    given = json.loads(run(*options[:3], "2", *options[4:]).stdout)
    assert "dim_estimate" not in given

    output = tmp_path / "mesh.npz"
    result = run("reconstruct", unclear, "-k", "auto", "-o", output, "--json")
    assert result.exit_code == 0
    (first, *_) = json.loads(result.stdout)["warnings"]
    assert first.startswith("the dimension is uncertain")
    assert result.stderr.count("the dimension is uncertain") == 1


def test_dim_auto_and_a_format_that_cannot_hold_it(tmp_path):
    source = tmp_path / "ball.npy"
    np.save(source, datasets.ball(300, random_state=0))
    result = run("reconstruct", source, "-k", "auto", "-o", tmp_path / "a.ply")
    assert result.exit_code == 2
    assert "cannot hold tetrahedra" in result.stderr
    result = run("reconstruct", source, "-k", "many", "-o", tmp_path / "a.ply")
    assert result.exit_code == 2
    assert "'many' is neither a positive integer nor 'auto'" in result.stderr


# ------------------------------------------------------------------ real samples


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "dim", "confidence"),
    [
        ("surface_stanford_bunny_uniform12k", 2, 0.8),
        ("surface_spot_cow_vertices", 2, 0.8),
        ("surface_skull_genus2_vertices", 2, 0.5),
        ("threemanifold_SO3_in_R9", 3, 0.8),
        ("solid_bunny_tetrahedra_K3_in_R3", 3, 0.5),
        ("rawscan_bunny_one_view_bun000", 2, 0.8),
        ("lidar_autzen_thinned", 2, 0.7),
    ],
)
def test_real_samples(data_dir, name, dim, confidence):
    with np.load(data_dir / f"{name}.npz") as data:
        found = estimate(data["points"])
    assert found.dim == dim, found.verdict
    assert found.confidence > confidence


def test_real_samples_in_doubt(data_dir):
    """A coast is more than a curve; a circle with thick noise shows no dimension."""
    with np.load(data_dir / "curve_coastline_british_isles_in_R2.npz") as data:
        found = estimate(data["points"])
    assert found.dim == 1
    assert found.confidence < 0.5
    name = "highdim_range_image_patches_circle_in_R25.npz"
    with np.load(data_dir / name) as data:
        found = estimate(data["points"][::5])
    assert found.confidence < 0.1


@pytest.mark.slow
def test_benchmark(tmp_path):
    np.save(tmp_path / "surface_a.npy", datasets.sphere(200, random_state=0))
    np.save(tmp_path / "other.npy", datasets.circle(200, random_state=0))

    def lines(*options):
        done = subprocess.run(
            [sys.executable, BENCHMARKS / "dimensions.py", "--markdown", *options],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return [
            [cell.strip() for cell in line.strip("|").split("|")]
            for line in done.stdout.splitlines()[2:]
        ]

    file = tmp_path / "results.json"
    (row,) = lines(
        *("--shape", "circle", "--noise", "0", "--noise", "0.5", "--seeds", "2"),
        *("--json", str(file)),
    )
    assert row[:3] == ["circle in R^2", "200", "1"]
    assert [cell.split(",")[0] for cell in row[3:]] == ["2 of 2", "2 of 2"]
    (result,) = json.loads(file.read_text(encoding="utf-8"))["results"]
    assert result["noise"]["0.5"]["dims"] == [1, 1]
    real = lines("--data", str(tmp_path))
    assert [row[:5] for row in real] == [
        ["other", "200", "2", "?", "1"],
        ["surface a", "200", "3", "2", "2"],
    ]
