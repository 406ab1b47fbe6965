# SPDX-License-Identifier: GPL-3.0-or-later
"""In tiles: the bytes of one piece, whatever the tiles, and whatever happens to workers."""

import errno
import os
import shutil
import signal
import subprocess
import sys
import warnings
from concurrent.futures import CancelledError

import numpy as np
import pytest

import remanifold as rm
import remanifold.distributed as rd
from remanifold.distributed import _engine, _run, _store, _tiles


def torus(count, seed=1):
    u, v = np.random.default_rng(seed).random((2, count)) * 2 * np.pi
    around = 2 + 0.7 * np.cos(v)
    return np.stack([around * np.cos(u), around * np.sin(u), 0.7 * np.sin(v)], axis=1)


def wave(count, seed=1):
    x = np.random.default_rng(seed).random((count, 2))
    return np.column_stack([x, 0.1 * np.sin(6 * x[:, 0]) * np.cos(5 * x[:, 1])])


def sheet_with_holes(count, seed=1):
    points = wave(count, seed)
    for x, y, radius in ((0.3, 0.3, 0.05), (0.7, 0.6, 0.04), (0.5, 0.5, 0.03)):
        points = points[np.linalg.norm(points[:, :2] - (x, y), axis=1) > radius]
    return points


def annulus(count, seed=1):
    rng = np.random.default_rng(seed)
    r, turn = np.sqrt(0.25 + 0.75 * rng.random(count)), 2 * np.pi * rng.random(count)
    return np.stack(
        [r * np.cos(turn), r * np.sin(turn), 0.2 * r * r * np.sin(2 * turn)], axis=1
    )


def klein_bottle(count, seed=1):
    u, v = np.random.default_rng(seed).random((2, count)) * 2 * np.pi
    around, up = 2 + np.cos(v), np.sin(v)
    return np.stack(
        [
            around * np.cos(u),
            around * np.sin(u),
            up * np.cos(u / 2),
            up * np.sin(u / 2),
        ],
        axis=1,
    )


def lattice(side):
    u, v = (turn.ravel() for turn in np.mgrid[:side, :side] * 2 * np.pi / side)
    return np.stack([np.cos(u), np.sin(u), np.cos(v), np.sin(v)], axis=1)


def three_torus(count, seed=1):
    turns = np.random.default_rng(seed).random((3, count)) * 2 * np.pi
    return np.concatenate([np.cos(turns), np.sin(turns)]).T.copy()


def two_tori(count, seed=1):
    other = torus(count // 2, seed + 1)[:, [0, 2, 1]] + (1.9, 0, 0)
    return np.concatenate([torus(count - count // 2, seed), other])


def in_one_piece(points, dim, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.warnings.RemanifoldWarning)
        return rm.reconstruct(points, dim, **options)


def in_tiles(points, dim, work, **options):
    options = {"num_workers": 0, "tile_size": 4_000, "halo": 10.0} | options
    return rd.reconstruct(points, dim, work=work, **options)


def assert_same(rec, expected):
    assert rec.manifest["tiles"] > 1
    assert rec.simplices.dtype == expected.simplices.dtype
    np.testing.assert_array_equal(rec.simplices, expected.simplices)
    said, known = rec.topology, expected.topology()
    assert said.num_simplices == known.num_simplices
    assert said.euler_characteristic == known.euler_characteristic
    assert said.components == known.components
    assert said.orientable == known.orientable
    assert said.closed == known.closed
    assert said.manifold == known.manifold


SHAPES = {
    "torus": (torus(16_000), 2),
    "two_tori": (two_tori(16_000), 2),
    "klein_bottle": (klein_bottle(16_000), 2),
    "lattice": (lattice(120), 2),
    "annulus": (annulus(16_000), 2),
    "holes": (sheet_with_holes(16_000), 2),
    "three_torus": (three_torus(5_000), 3),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name == "three_torus"))
        for name in SHAPES
    ],
)
def test_bytes_are_those_of_one_piece(tmp_path, name):
    points, dim = SHAPES[name]
    rec = in_tiles(points, dim, tmp_path, tile_size=len(points) // 4)
    assert_same(rec, in_one_piece(points, dim))


@pytest.mark.parametrize("tile_size", [2_500, 9_000])
def test_any_tiles(tmp_path, tile_size):
    points, dim = SHAPES["torus"]
    rec = in_tiles(points, dim, tmp_path, tile_size=tile_size)
    assert_same(rec, in_one_piece(points, dim))


def test_narrow_halo_is_widened(tmp_path):
    points, dim = SHAPES["torus"]
    rec = in_tiles(points, dim, tmp_path, halo=2.0)
    assert rec.manifest["tiles_again"] > 0
    assert_same(rec, in_one_piece(points, dim))


def test_copies_are_merged(tmp_path):
    points = np.concatenate([torus(12_000), torus(12_000)[1_000:3_000]])
    rec = in_tiles(points, 2, tmp_path)
    assert rec.manifest["num_distinct"] == 12_000
    np.testing.assert_array_equal(rec.simplices, in_one_piece(points, 2).simplices)


@pytest.fixture(scope="module")
def samples():
    return torus(12_000, seed=3)


@pytest.fixture(scope="module")
def expected(samples):
    return in_one_piece(samples, 2)


def test_memory_map(samples, expected, tmp_path):
    np.save(tmp_path / "samples.npy", samples)
    rec = in_tiles(tmp_path / "samples.npy", 2, tmp_path / "work")
    assert_same(rec, expected)
    np.testing.assert_array_equal(rec.vertices, samples)


class Stopped(BaseException):
    pass


def interrupted(samples, work, step):
    def stop(name, done, _total):
        if name == step and done == 1:
            raise Stopped

    with pytest.raises(Stopped):
        in_tiles(samples, 2, work, progress=stop)


@pytest.mark.parametrize("step", ["measure", "tiles0", "write"])
def test_resumed(samples, expected, tmp_path, step):
    interrupted(samples, tmp_path, step)
    with pytest.raises(FileNotFoundError, match="no finished run"):
        rd.DistributedReconstruction(str(tmp_path))
    with pytest.raises(FileExistsError, match="work holds a run already"):
        in_tiles(samples, 2, tmp_path)
    rec = in_tiles(samples, 2, tmp_path, resume=True)
    assert sum(s["known"] for s in rec.manifest["stages"].values()) > 0
    assert_same(rec, expected)


def test_lost_and_truncated_parts(samples, expected, tmp_path):
    rec = in_tiles(samples, 2, tmp_path)
    lost = tmp_path / rec.manifest["simplices"][0]["path"]
    whole = lost.read_bytes()
    lost.write_bytes(whole[:-100])
    with pytest.raises(rd.LostPartError, match=f"{lost.name} has .* bytes instead of"):
        _ = rec.simplices
    lost.write_bytes(whole[:-200] + bytes(100) + whole[-100:])
    with pytest.raises(rd.LostPartError, match=f"{lost.name} is damaged"):
        _ = rec.simplices
    lost.unlink()
    with pytest.raises(rd.LostPartError, match=f"{lost.name} is missing"):
        _ = rec.simplices
    assert_same(in_tiles(samples, 2, tmp_path, resume=True), expected)
    assert not list(tmp_path.rglob("*.writing"))


@pytest.mark.parametrize("step", ["sort", "measure", "tiles0", "write"])
def test_full_disk(samples, expected, tmp_path, monkeypatch, step):
    written = {"sort": "put_table", "write": "put_table"}.get(step, "put")
    name = {"sort": "chunk", "measure": "spacings", "tiles0": "tile"}.get(
        step, "simplices"
    )
    original = getattr(_store.Store, written)
    left = [1]

    def full(self, what, *arguments):
        if what.startswith(f"{name}-"):
            if not left[0]:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            left[0] -= 1
        return original(self, what, *arguments)

    monkeypatch.setattr(_store.Store, written, full)
    with pytest.raises(OSError, match="No space left"):
        in_tiles(samples, 2, tmp_path)
    assert not list(tmp_path.rglob("*.writing"))
    monkeypatch.undo()
    assert_same(in_tiles(samples, 2, tmp_path, resume=True), expected)


def test_other_samples_are_no_resumption(samples, tmp_path):
    np.save(tmp_path / "samples.npy", samples)
    interrupted(tmp_path / "samples.npy", tmp_path / "work", "tiles0")
    np.save(tmp_path / "samples.npy", samples[::-1])
    with pytest.raises(ValueError, match="a run of another source"):
        in_tiles(tmp_path / "samples.npy", 2, tmp_path / "work", resume=True)


def test_refused_run_is_tried_with_other_parameters(samples, tmp_path):
    away = np.array([[0.0, 0.0, 3.0]])
    np.save(tmp_path / "samples.npy", np.concatenate([samples, away]))
    source, work = tmp_path / "samples.npy", tmp_path / "work"
    with pytest.raises(rd.BeyondTilesError, match="outliers=False"):
        in_tiles(source, 2, work)
    # As the message says, and what was sorted is not sorted again.
    rec = in_tiles(source, 2, work, outliers=False)
    stages = rec.manifest["stages"]
    assert stages["sort"]["known"] == stages["sort"]["tasks"] > 0
    fresh = in_tiles(source, 2, tmp_path / "fresh", outliers=False)
    assert rec.manifest["simplices"] == fresh.manifest["simplices"]
    with pytest.raises(FileExistsError, match="holds a run already"):
        in_tiles(source, 2, work, outliers=False)
    with pytest.raises(ValueError, match="a run of other parameters"):
        in_tiles(source, 2, work, resume=True)


def test_refused_run_is_not_one_of_other_samples(samples, tmp_path):
    away = np.array([[0.0, 0.0, 3.0]])
    np.save(tmp_path / "samples.npy", np.concatenate([samples, away]))
    with pytest.raises(rd.BeyondTilesError, match="outliers=False"):
        in_tiles(tmp_path / "samples.npy", 2, tmp_path / "work")
    np.save(tmp_path / "samples.npy", samples)
    with pytest.raises(ValueError, match="a run of another source"):
        in_tiles(tmp_path / "samples.npy", 2, tmp_path / "work")


def test_noise_is_refused(samples, tmp_path):
    rng = np.random.default_rng(2)
    noisy = samples + rng.normal(scale=0.03, size=samples.shape)
    with pytest.raises(rd.BeyondTilesError, match="smooth=False"):
        in_tiles(noisy, 2, tmp_path, outliers=False)


def test_halos_are_wider_where_samples_are_sparse(tmp_path):
    points = torus(14_000, seed=6)
    thin = (points[:, 0] < -1.5) & (np.random.default_rng(0).random(14_000) < 0.93)
    points = points[~thin]
    rec = in_tiles(points, 2, tmp_path, outliers=False)
    assert_same(rec, in_one_piece(points, 2, outliers=False))


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.5), (0.0, 40.0, 0.0)])
def test_outliers_are_refused(samples, tmp_path, place):
    with pytest.raises(rd.BeyondTilesError, match="outliers=False"):
        in_tiles(np.vstack([samples, place]), 2, tmp_path)


@pytest.mark.parametrize(
    ("points", "dim", "options", "error", "words"),
    [
        (np.zeros((9, 9)), 2, {}, rd.BeyondTilesError, "9 coordinates"),
        (np.zeros((9, 3)), 2, {}, rd.BeyondTilesError, "9 samples"),
        (np.zeros((0, 3)), 2, {}, ValueError, "no samples"),
        (np.zeros(9), 2, {}, ValueError, "source has 1 axes"),
        (np.full((9_999, 3), np.nan), 2, {}, ValueError, r"source\[0\] is not finite"),
        ("nothing.npy", 2, {}, FileNotFoundError, "nothing.npy: no such file"),
        ("nothing.las", 2, {}, FileNotFoundError, "nothing.las: no such file"),
        ("nothing", 2, {}, FileNotFoundError, "nothing: no such file or folder"),
        (np.zeros((9_999, 3)), 4, {}, ValueError, "dim is 4"),
        (np.zeros((9_999, 3)), 1, {}, rd.BeyondTilesError, "dim is 1"),
        (np.ones((9_999, 3)), 2, {}, rd.BeyondTilesError, "span 0 dimensions"),
        (
            np.arange(9_999)[:, None] * [1, 2, 3],
            2,
            {},
            rd.BeyondTilesError,
            "span 1 dim",
        ),
    ],
)
def test_refusals(tmp_path, points, dim, options, error, words):
    with pytest.raises(error, match=words):
        in_tiles(points, dim, tmp_path, **options)


def test_ranks_are_those_of_the_core(tmp_path):
    points = torus(6_000)
    rec = in_tiles(points, 2, tmp_path)
    store = _store.Store(str(tmp_path))
    assert rec.manifest["num_distinct"] == len(points)
    values = np.random.default_rng(1).random(1_000)
    parts = [store.put(f"v{i}", {"x": values[i::3]}, {}) for i in range(3)]
    for rank in (0, 17, 999):
        run = _run.Run(
            _tiles.Job(str(tmp_path), "", 0, 3, 2, None, 1, 0.0),
            _engine.Engine(None, store),
            outliers=0.0,
            smooths=False,
        )
        assert run.value_at(parts, "x", rank) == np.sort(values)[rank]


def test_spanning_rows_are_those_of_the_flat():
    rng = np.random.default_rng(3)
    flat = rng.random((500, 3)) @ rng.random((3, 6)) + 5.0
    assert len(_tiles.spanning_rows(flat, 1e-6)) == 4
    flat[77] += 1e-3
    rows = _tiles.spanning_rows(flat, 1e-6)
    assert len(rows) == 5
    assert 77 in rows


def test_sets_with_both():
    rows = np.array([[0, 1, 2], [2, 3, 4], [5, 6, 7]], dtype=np.int32)
    a, b = np.zeros(8, dtype=bool), np.zeros(8, dtype=bool)
    a[0] = b[7] = True
    assert not _tiles.sets_with_both(rows, a, b)
    b[4] = True
    assert _tiles.sets_with_both(rows, a, b)


def cluster_of(**options):
    distributed = pytest.importorskip("distributed")
    return distributed.LocalCluster(
        threads_per_worker=1, dashboard_address="127.0.0.1:0", **options
    )


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_workers_that_are_threads(samples, expected, tmp_path):
    with (
        cluster_of(n_workers=2, processes=False) as cluster,
        cluster.get_client() as own,
    ):
        assert_same(in_tiles(samples, 2, tmp_path, client=own), expected)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("step", ["sort", "measure", "tiles0", "write"])
def test_worker_killed(samples, expected, tmp_path, step):
    with (
        cluster_of(n_workers=2, host="127.0.0.1") as cluster,
        cluster.get_client() as own,
    ):
        killed = []

        def kill(name, done, _total):
            if name == step and not killed:
                killed.append(done)
                os.kill(next(iter(own.run(os.getpid).values())), signal.SIGKILL)

        rec = in_tiles(samples, 2, tmp_path, client=own, progress=kill)
    assert killed
    assert_same(rec, expected)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_scheduler_killed(samples, expected, tmp_path):
    distributed = pytest.importorskip("distributed")
    dask = pytest.importorskip("dask")
    said = tmp_path / "scheduler.json"
    common = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(said)]

    def start(module, *options):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *common, *options]
        return subprocess.Popen(command, stderr=subprocess.DEVNULL)

    scheduler = start("dask_scheduler", "--port", "0")
    worker = start("dask_worker", "--nthreads", "1", "--death-timeout", "60")
    try:
        with dask.config.set({"distributed.comm.timeouts.connect": "2s"}):
            client = distributed.Client(scheduler_file=str(said), timeout=60)
            client.wait_for_workers(1, timeout=60)

            def kill(name, done, _total):
                if name == "tiles0" and done == 1:
                    scheduler.kill()

            with pytest.raises((OSError, RuntimeError, CancelledError)):
                in_tiles(samples, 2, tmp_path / "work", client=client, progress=kill)
            client.close(timeout=1)
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
    rec = in_tiles(samples, 2, tmp_path / "work", resume=True)
    assert rec.manifest["stages"]["tiles0"]["known"] >= 1
    assert_same(rec, expected)


def test_another_source_in_the_same_directory(tmp_path):
    """A process that had read the first source took it for the second, too."""
    for seed in (3, 4):
        points = torus(8_000, seed)
        np.save(tmp_path / f"{seed}.npy", points)
        rec = in_tiles(tmp_path / f"{seed}.npy", 2, tmp_path / "work")
        assert_same(rec, in_one_piece(points, 2))
        shutil.rmtree(tmp_path / "work")


def test_nothing_is_no_manifold(tmp_path):
    """Without simplices there was an error of NumPy's."""
    points = torus(8_000)
    rec = in_tiles(points, 2, tmp_path, hole_radius=1e-3)
    assert len(rec.simplices) == 0
    assert_same(rec, in_one_piece(points, 2, hole_radius=1e-3))
