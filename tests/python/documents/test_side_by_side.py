# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark beside the peers tells right from wrong, and worse from better."""

from __future__ import annotations

import copy
import importlib.util
import json
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import remanifold as rm

ROOT = Path(__file__).resolve().parents[3]
BENCHMARKS = ROOT / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))  # the processes of the judge import it as well

import processes
import report
import samples
import side_by_side
from peers import PEERS
from side_by_side import SHAPES, Bench, Case, JudgeTask

pytestmark = pytest.mark.slow

DRIVER = next((file for file in side_by_side.DRIVERS if file.is_file()), None)
CIRCLE = Case("circle", 100, "random", 0.0, 0)


def run(script, *arguments, code=0):
    done = subprocess.run(
        [sys.executable, BENCHMARKS / script, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Results of remanifold and GUDHI, without the drivers, and what was printed."""
    folder = tmp_path_factory.mktemp("results")
    file = folder / "results.json"
    done = run(
        *("side_by_side.py", "--shape", "torus", "--samples", "1500", "--repeat", 2),
        *("--peer", "manifold", "--peer", "paper", "--peer", "gudhi", "--markdown"),
        *("--driver", folder / "absent", "--json", file),
    )
    return json.loads(file.read_text(encoding="utf-8")), file, done


def test_command(results):
    found, _, done = results
    assert found["versions"]["remanifold"] == rm.__version__
    assert {"cpu", "cores"} < set(found["machine"])
    assert "--samples 1500" in found["command"]
    (case,) = found["cases"]
    assert (case["shape"], case["dim"], case["num_samples"]) == ("torus", 2, 1500)
    assert list(case["peers"]) == ["manifold", "paper", "gudhi"]
    for record in case["peers"].values():
        assert record["ending"] == "done"
        assert len(record["seconds"]) == 2
        assert min(record["seconds"]) > 0
        assert record["ratios"] == [None, None]
        assert 0 < min(record["bytes_per_sample"]) < 1e6
    assert "| remanifold | 1,500 |" in done.stdout


def test_verdicts_and_digests(results):
    peers = results[0]["cases"][0]["peers"]
    assert peers["manifold"]["right"] is True
    assert peers["manifold"]["reasons"] == []
    assert peers["gudhi"]["right"] is False
    assert peers["gudhi"]["reasons"][0].startswith("wrong links: ")
    rec = rm.reconstruct(SHAPES["torus"].generate(1500, random_state=0), 2)
    rows = np.array(sorted(np.sort(rec.simplices, axis=1).tolist()), dtype="<i4")
    assert peers["manifold"]["num_simplices"] == len(rows)
    assert peers["manifold"]["digests"] == [side_by_side._hash(rows.tobytes())]


def test_missing_peers_are_named(results):
    found, _, done = results
    assert list(found["left_out"]) == ["flann"]
    line = "left out: FLANN 20-NN (flann): no remanifold_peers: build with"
    assert line in done.stderr
    assert line in done.stdout


@pytest.mark.skipif(
    importlib.util.find_spec("open3d") is not None, reason="Open3D is there"
)
def test_missing_modules_are_named(tmp_path):
    done = run(
        *("side_by_side.py", "--shape", "sphere", "--samples", 100, "--repeat", 1),
        *("--peer", "manifold", "--peer", "open3d_poisson"),
        *("--driver", tmp_path / "absent"),
    )
    line = (
        "left out: Open3D Poisson (open3d_poisson): import open3d failed: "
        "ModuleNotFoundError: No module named 'open3d'"
    )
    assert line in done.stderr
    assert line in done.stdout


def test_peers_that_take_no_such_shape_are_named(tmp_path):
    done = run(
        *("side_by_side.py", "--shape", "circle", "--samples", 50, "--repeat", 1),
        *("--peer", "manifold", "--peer", "pymeshlab_ball_pivoting"),
        *("--driver", tmp_path / "absent"),
    )
    assert "(pymeshlab_ball_pivoting): for none of these shapes" in done.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["--shape", "cube"],
        ["--peer", "magic"],
        ["--order", "hilbert"],
        ["--samples", "many"],
        ["--samples", "10,0"],
        ["--threads=2", "--cpu"],
    ],
)
def test_wrong_usage(arguments):
    little = "--shape=circle", "--samples=50", "--peer=paper"
    done = run("side_by_side.py", *little, *arguments, code=2)
    assert arguments[1] in done.stderr


@pytest.mark.skipif(DRIVER is None, reason="remanifold_peers is not built")
def test_drivers(tmp_path):
    bench = Bench(DRIVER, tmp_path, 2, 1, 60, lambda _: None)
    case = Case("sphere", 500, "random", 0.0, 0)
    names = ["flann", "advancing_front", "scale_space", "manifold"]
    records = bench.measure(case, names, {})
    assert records["flann"]["ratios"] == [1, 1]
    assert records["advancing_front"]["right"] is True
    assert records["scale_space"]["num_simplices"] > 900
    for record in records.values():
        assert record["ending"] == "done"
        flann = records["flann"]["seconds"]
        assert record["ratios"] == [
            a / b for a, b in zip(record["seconds"], flann, strict=True)
        ]
    assert list(side_by_side.versions(DRIVER))[-2:] == ["CGAL", "FLANN"]


# --------------------------------------------------------------------- endings


def test_runs_over_the_limit_are_killed_and_larger_ones_left_out(tmp_path):
    bench = Bench(None, tmp_path, 2, 1, 0.01, lambda _: None)
    too_long = {}
    start = time.monotonic()
    record = bench.measure(CIRCLE, ["manifold"], too_long)["manifold"]
    assert time.monotonic() - start < 30
    assert (record["ending"], record["right"]) == ("timeout", None)
    assert too_long == {"manifold": 100}
    cells = report.cells("manifold", 100, record, 0.01)
    assert cells[2:] == ["> 0.01", "", "", "", "not done after 0.01 s"]
    bench.time_limit = 60
    record = bench.measure(CIRCLE, ["manifold"], too_long)["manifold"]
    assert record["ending"] == "skipped"
    assert record["reasons"] == ["too long with 100 samples already"]


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("raise ValueError('no')", processes.Failure("ValueError: no", "error")),
        (
            "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)",
            processes.Failure("crashed: SIGSEGV", "crash"),
        ),
        ("print('{\"a\": 1}')", {"a": 1}),
        ("print('{')", processes.Failure("did not print JSON", "error")),
    ],
)
def test_endings_of_commands(code, expected):
    command = [sys.executable, "-c", code]
    assert processes.run_command(command, math.inf, {}) == expected


def test_limit_of_cpu_time():
    spin = [sys.executable, "-c", "while True: pass"]
    failure = processes.Failure("not done after 1 s", "timeout")
    assert processes.run_command(spin, 60, {}, 1) == failure
    sleep = [sys.executable, "-c", "import time; time.sleep(2); print(1)"]
    assert processes.run_command(sleep, 60, {}, 1) == 1


def test_disturbed_runs_are_done_again(tmp_path, monkeypatch):
    shares = iter([0.5, 0.3, 0.7, 0.2, 0.95, 0.1, 0.5])

    def run_once(*_):
        return {"seconds": 1.0, "cpu_seconds": next(shares)}

    monkeypatch.setattr(Bench, "run_once", run_once)
    bench = Bench(None, tmp_path, 1, 1, 60, lambda _: None)
    found = [bench.run("paper", tmp_path, CIRCLE)["cpu_seconds"] for _ in range(2)]
    assert found == [0.7, 0.95]
    assert next(shares) == 0.1


@pytest.mark.parametrize(("cpu", "rounds"), [(False, 2), (True, 3)])
def test_long_runs_are_not_repeated_but_for_the_unit(
    tmp_path, monkeypatch, cpu, rounds
):
    def run_once(bench, name, *_):
        bench.result(name).touch()
        return {"seconds": 15.0, "cpu_seconds": 6.0, "peak_bytes": None}

    monkeypatch.setattr(Bench, "run_once", run_once)
    bench = Bench(None, tmp_path, 3, 1, 60, lambda _: None, cpu)
    records = bench.measure(CIRCLE, ["flann", "paper"], {})
    assert [len(record["seconds"]) for record in records.values()] == [3, rounds]


def test_crashes_are_wrong(tmp_path):
    bench = Bench(Path(shutil.which("false")), tmp_path, 2, 1, 60, lambda _: None)
    record = bench.measure(CIRCLE, ["flann"], {})["flann"]
    assert (record["ending"], record["right"]) == ("error", False)
    assert report.result_of(record) == "wrong: ended with exit code 1"


# -------------------------------------------------------------------- judgement

OCTAHEDRON = [[x, y, z] for x in (0, 1) for y in (2, 3) for z in (4, 5)]


def judged(tmp_path, simplices, num_samples=6, shape="sphere", own_vertices=False):
    file = tmp_path / "simplices"
    np.array(simplices, dtype=np.int32).tofile(file)
    return side_by_side.judged(JudgeTask(file, shape, num_samples, own_vertices))


def test_judgement_of_files(tmp_path):
    right = judged(tmp_path, OCTAHEDRON)
    assert (right.reasons, right.num_simplices) == ((), 8)
    turned = [row[::-1] for row in OCTAHEDRON[::-1]]
    assert judged(tmp_path, turned) == right
    assert judged(tmp_path, turned + OCTAHEDRON) == right  # from both sides
    hole = judged(tmp_path, OCTAHEDRON[1:])
    assert hole.reasons[0] == "boundary components: 1, not 0"
    assert hole.digest != right.digest
    torus = judged(tmp_path, OCTAHEDRON, shape="torus")
    assert torus.reasons[0] == "Betti numbers 1, 0, 1 over Z2, not 1, 2, 1"
    degenerate = judged(tmp_path, [*OCTAHEDRON, [0, 0, 2]])
    assert degenerate.reasons == ("degenerate simplices: 1",)
    assert judged(tmp_path, np.empty((0, 3))).reasons == ("no simplices",)


def test_meshes_of_their_own_vertices(tmp_path):
    assert judged(tmp_path, OCTAHEDRON, 9).reasons == ("unused samples: 3",)
    assert judged(tmp_path, OCTAHEDRON, 9, own_vertices=True).reasons == ()
    assert judged(tmp_path, OCTAHEDRON, 3, own_vertices=True).reasons == ()


def test_wrong_once_is_wrong():
    record = side_by_side._empty_record()
    for reasons, digest in (((), "a"), (("wrong links: 1",), "b"), ((), "c")):
        side_by_side._enter(side_by_side.Verdict(reasons, 1, digest), record)
    assert record["right"] is False
    assert record["reasons"] == ["wrong links: 1"]
    assert record["digests"] == ["a", "b", "c"]


def test_not_judged_is_not_right():
    record = side_by_side._empty_record()
    side_by_side._enter(processes.Failure("not done after 9 s", "timeout"), record)
    assert record["right"] is None
    side_by_side._enter(side_by_side.Verdict((), 1, "a"), record)
    assert record["right"] is None


# ---------------------------------------------------------------------- samples


def test_morton_order_keeps_the_points_and_brings_neighbors_together():
    points = SHAPES["torus"].generate(5000, random_state=1)
    ordered = samples.morton_ordered(points)
    assert sorted(map(tuple, ordered)) == sorted(map(tuple, points))

    def step(rows):
        return np.median(np.linalg.norm(np.diff(rows, axis=0), axis=1))

    assert step(ordered) < step(points) / 20
    square = np.array([[x, y] for x in range(4) for y in range(4)], dtype=float)
    quarters = samples.morton_ordered(square).reshape(4, 4, 2)
    assert (np.ptp(quarters, axis=1) == 1).all()
    wide = np.random.default_rng(0).normal(size=(20, 100))
    assert samples.morton_ordered(wide).shape == wide.shape


def test_cases():
    for name in side_by_side.SAMPLES:
        shape = SHAPES[name]
        points = Case(name, 30, "morton", 0.0, 0).draw()
        assert points.shape == (30, shape.ambient_dim)
        assert points.flags.c_contiguous
    assert set(side_by_side.SAMPLES) <= set(SHAPES)
    noisy = Case("sphere", 500, "random", 0.5, 0).draw()
    assert np.linalg.norm(noisy, axis=1).std() > 0.005


# ------------------------------------------------------------------- comparison


@pytest.fixture
def compare(results, tmp_path):
    """Compare made-up results with others; the output if the exit code is right."""
    old = copy.deepcopy(results[0])
    for record in old["cases"][0]["peers"].values():
        record |= {"ratios": [4.0, 5.0, 6.0], "bytes_per_sample": [500.0]}

    def call(change=lambda _: None, *options, code, before=lambda _: None):
        base = copy.deepcopy(old)
        before(base["cases"][0]["peers"]["manifold"])
        new = copy.deepcopy(base)
        change(new["cases"][0]["peers"]["manifold"])
        files = tmp_path / "old.json", tmp_path / "new.json"
        for file, content in zip(files, (base, new), strict=True):
            file.write_text(json.dumps(content), encoding="utf-8")
        return run("compare.py", *files, *options, code=code).stdout

    return call


def test_the_same_is_not_worse(compare):
    assert "nothing worse" in compare(code=0)
    assert "gudhi" not in compare(code=0)
    assert "gudhi" in compare(lambda _: None, "--peers", code=0)


@pytest.mark.parametrize(
    ("field", "factor", "code"),
    [
        ("ratios", 1.1, 0),
        ("ratios", 1.2, 1),
        ("ratios", 0.5, 0),
        ("bytes_per_sample", 1.2, 1),
        ("bytes_per_sample", 1.1, 0),
        ("seconds", 9.0, 0),  # another machine
    ],
)
def test_growth(compare, field, factor, code):
    def change(record):
        record[field] = [factor * value for value in record[field]]

    found = compare(change, code=code)
    assert ("grew" in found) == (code == 1)
    if code:
        assert "nothing worse" in compare(change, "--threshold", 1.3, code=0)


def test_digests(compare):
    def change(record):
        record["digests"] = ["0123456789ab"]

    assert "changed" in compare(change, code=1)
    assert "digest" not in compare(change, "--ignore-digests", code=0)


@pytest.mark.parametrize(
    "change",
    [
        {"right": False, "reasons": ["wrong links: 3"]},
        {"right": None, "ending": "timeout", "reasons": ["not done after 9 s"]},
        {"right": False, "ending": "crash", "reasons": ["crashed: SIGSEGV"]},
        {"right": None, "reasons": ["not judged: not done after 9 s"]},
    ],
)
def test_lost_correctness(compare, change):
    found = compare(lambda record: record.update(change), code=1)
    assert "lost" in found
    assert change["reasons"][0] in found


def test_gained_correctness(compare):
    def wrong(record):
        record |= {"right": False, "reasons": ["wrong links: 3"]}

    def right(record):
        record |= {"right": True, "reasons": []}

    assert "gained" in compare(right, code=0, before=wrong)
    crash = {"ending": "crash", "reasons": ["crashed: SIGSEGV"]}
    assert "lost" in compare(lambda record: record.update(crash), code=1, before=wrong)


def test_seconds_where_there_is_no_flann(compare):
    def without_flann(record):
        record["ratios"] = [None, None]

    def slower(record):
        record["seconds"] = [2 * value for value in record["seconds"]]

    assert "seconds" not in compare(slower, code=0, before=without_flann)
    found = compare(slower, "--seconds", code=1, before=without_flann)
    assert "× 2.00" in found
    compare(slower, "--seconds", code=0)  # ratios are there


def test_nothing_in_common(results, tmp_path):
    other = copy.deepcopy(results[0])
    other["cases"][0]["num_samples"] = 7
    file = tmp_path / "other.json"
    file.write_text(json.dumps(other), encoding="utf-8")
    assert "no case in common" in run("compare.py", results[1], file, code=2).stderr
    run("compare.py", results[1], results[1])


# ------------------------------------------------------------ tables and curves


def test_tables_go_into_a_text(results, tmp_path):
    text = tmp_path / "text.md"
    text.write_text(
        f"a\n\n{report.BEGIN}\nbefore\n{report.END}\n\nb\n", encoding="utf-8"
    )
    run("report.py", results[1], "--into", text)
    first = text.read_text(encoding="utf-8")
    assert "| remanifold | 1,500 |" in first
    assert "before" not in first
    assert first.startswith("a\n")
    assert first.endswith("b\n")
    run("report.py", results[1], "--into", text)
    assert text.read_text(encoding="utf-8") == first
    text.write_text("no place", encoding="utf-8")
    run("report.py", results[1], "--into", text, code=2)


def test_cpu_time_instead():
    record = {"seconds": [9.0, 9.0], "cpu_seconds": [2.0, 3.0], "ratios": [1.0, 1.0]}
    unit = {"seconds": [9.0] * 3, "cpu_seconds": [0.5, 1.0, 1.0], "ratios": [1.0] * 3}
    found = report.by_cpu({"cases": [{"peers": {"paper": record, "flann": unit}}]})
    peers = found["cases"][0]["peers"]
    assert peers["paper"]["seconds"] == [2, 3]
    assert peers["paper"]["ratios"] == [4, 3]
    assert peers["flann"]["ratios"] == [1, 1, 1]
    alone = report.by_cpu({"cases": [{"peers": {"paper": record}}]})
    assert alone["cases"][0]["peers"]["paper"]["ratios"] == [None, None]


def test_curves(results, tmp_path):
    images = []
    for name in ("a.svg", "b.svg"):
        run("plot_growth.py", results[1], "-o", tmp_path / name)
        images.append((tmp_path / name).read_bytes())
    assert images[0] == images[1]
    assert b"<svg" in images[0]
    run("plot_growth.py", results[1], "-o", tmp_path / "c.svg", "--shape=cube", code=2)


def test_every_peer_has_a_style():
    import plot_growth

    assert set(plot_growth.STYLES) == set(PEERS)
    assert len(set(plot_growth.STYLES.values())) == len(PEERS)
