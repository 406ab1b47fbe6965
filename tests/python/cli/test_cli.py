# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: results, reports, exit codes, and what is left after a failure."""

from __future__ import annotations

import json
import os
import pty
import re
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import remanifold as rm
from remanifold import cli
from remanifold.cli._common import as_flags
from remanifold.cli._options import _bytes
from remanifold.io import read_points, write_mesh
from remanifold.method.options import CHECKS, METHODS

KEYS = {
    *("input", "output", "method", "estimator", "edges", "search", "num_neighbors"),
    *("num_samples", "ambient_dim", "dim", "num_simplices", "euler_characteristic"),
    *("components", "betti_numbers", "manifold", "closed", "orientable"),
    *("boundary_samples", "merged_samples", "invalid_samples"),
    *("unused_samples", "coface_counts"),
    *("outliers", "smoothing"),
    *("open_faces", "callous_faces", "holes", "boundary_components"),
    *("singular_vertices", "sampling", "seconds", "warnings"),
    *("boundary", "hole_radius", "hole_size", "agreed_simplices", "disputed_simplices"),
    *("filled_simplices", "inserted_samples", "cut_samples"),
    *("significance", "openings"),
    "unstarred_simplices",
}
PAPER_ONLY = {"edges", "unstarred_simplices"}
MANIFOLD_ONLY = {
    *("boundary", "hole_radius", "hole_size", "agreed_simplices", "disputed_simplices"),
    *("filled_simplices", "inserted_samples", "cut_samples"),
    *("significance", "openings"),
}


try:
    RUNNER = CliRunner(mix_stderr=False)
except TypeError:  # newer Typer always keeps standard error apart
    RUNNER = CliRunner()


def run(*arguments):
    return RUNNER.invoke(cli.app, ["reconstruct", *map(str, arguments)])


def run_process(*arguments, **options):
    command = [sys.executable, "-m", "remanifold", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, **options
    )


def run_on_terminal(*arguments, interrupt_at=None):
    """Exit code, what the terminal shows, and standard output."""
    terminal, standard_error = pty.openpty()
    shown = b""
    with subprocess.Popen(
        [sys.executable, "-m", "remanifold", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=standard_error,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "80"},
    ) as process:
        os.close(standard_error)
        while True:
            try:
                part = os.read(terminal, 1024)
            except OSError:  # the other end is closed
                break
            shown += part
            if interrupt_at is not None and interrupt_at in shown:
                process.send_signal(signal.SIGINT)
                interrupt_at = None
        output, _ = process.communicate(timeout=60)
    os.close(terminal)
    return process.returncode, shown, output


@pytest.fixture
def tori(tmp_path):
    path = tmp_path / "tori.npy"
    np.save(path, rm.datasets.figure_samples(8))
    return path


@pytest.fixture
def circle(tmp_path):
    path = tmp_path / "circle.csv"
    points = rm.datasets.spread(rm.datasets.circle(600, random_state=0), 60, 0)
    np.savetxt(path, points, delimiter=",", header="x,y", comments="", fmt="%.17g")
    return path


# --------------------------------------------------------------------- success


@pytest.mark.parametrize("method", METHODS)
def test_mesh_is_what_the_library_gives(tori, tmp_path, method):
    options = [] if method == "manifold" else ["--method", method]
    result = run(tori, "--dim", 2, "-o", tmp_path / "mesh.npz", *options)
    assert result.exit_code == 0
    with np.load(tmp_path / "mesh.npz") as mesh:
        np.testing.assert_array_equal(mesh["points"], np.load(tori))
        rec = rm.reconstruct(np.load(tori), 2, method=method)
        np.testing.assert_array_equal(mesh["simplices"], rec.simplices)
    assert result.stderr == ""


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".vtk", ".vtu"])
def test_every_format(tori, tmp_path, suffix):
    output = tmp_path / f"mesh{suffix}"
    assert run(tori, "--dim", 2, "-o", output).exit_code == 0
    assert len(read_points(output)) == 2160


def rows_of(table):
    rows = dict(line.split("  ", 1) for line in table.splitlines() if "  " in line)
    return {name: value.strip() for name, value in rows.items()}


def test_table(tori, tmp_path):
    options = ("--dim", 2, "-o", tmp_path / "mesh.ply")
    result = run(tori, *options)
    rows = rows_of(result.stdout)
    assert rows["method"] == "manifold"
    assert rows["samples"] == "2,160 in R^3"
    assert rows["dimension"] == "2"
    assert rows["simplices"] == "2,160 vertices, 6,480 edges, 4,320 triangles"
    assert rows["Euler characteristic"] == "0"
    assert rows["components"] == "2"
    assert rows["Betti numbers"] == "2, 4, 2"
    assert rows["manifold"] == rows["closed"] == rows["orientable"] == "yes"
    assert (
        rows["boundary samples"]
        == rows["unwanted holes"]
        == rows["callous edges"]
        == "0"
    )
    assert rows["edges by triangles"] == "6,480 in 2"
    for step in ("read", "neighborhoods", "tangent spaces", "local regions", "write"):
        assert step in result.stdout
    assert "mesh.ply" in "".join(result.stdout.split())  # long names are wrapped
    rec = rm.reconstruct(np.load(tori), 2)
    assert rows["agreed triangles"] == f"{rec.repair.num_agreed:,}"
    assert rows["disputed triangles"] == f"{len(rec.repair.disputed_simplices):,}"
    assert rows["filled triangles"] == f"{len(rec.repair.filled_simplices):,}"
    for name in ("inserted samples", "open edges", "singular vertices"):
        assert rows[name] == "0"
    assert "triangles in no star" not in rows
    rows = rows_of(run(tori, *options, "--method", "paper").stdout)
    assert rows["method"] == "paper"
    assert rows["triangles in no star"] == rows["callous edges"] == "0"
    assert not any("agreed" in name or "filled" in name for name in rows)


def test_json(tori, tmp_path):
    output = tmp_path / "mesh.ply"
    options = ("--dim", 2, "-o", output, "--json", "--method", "paper")
    result = run(tori, *options, "--edges", "either")
    assert result.exit_code == 0
    report = json.loads(result.stdout)
    assert set(report) == KEYS
    assert {key for key, value in report.items() if value is None} == {
        *MANIFOLD_ONLY,
        "smoothing",
    }
    assert report["method"] == "paper"
    assert report["input"] == str(tori)
    assert report["output"] == str(output)
    assert report["edges"] == "either"
    assert (report["num_samples"], report["ambient_dim"], report["dim"]) == (2160, 3, 2)
    assert report["num_simplices"] == [2160, 6480, 4320]
    assert report["euler_characteristic"] == 0
    assert report["betti_numbers"] == [2, 4, 2]
    assert report["coface_counts"] == {"2": 6480}
    assert report["manifold"] is report["closed"] is report["orientable"] is True
    assert report["warnings"] == []
    assert [*report["seconds"]][:2] == ["read", "neighborhoods"]
    assert [*report["seconds"]][-2:] == ["report", "write"]
    assert all(seconds >= 0 for seconds in report["seconds"].values())


def test_json_of_the_manifold_method(tmp_path):
    points = rm.datasets.torus(400, random_state=0)
    np.save(tmp_path / "torus.npy", np.vstack([points, points[:2], [[9, 9, 9]]]))
    result = run(tmp_path / "torus.npy", "-k", 2, "-o", tmp_path / "a.ply", "--json")
    assert result.exit_code == 0
    report = json.loads(result.stdout)
    assert set(report) == KEYS
    assert {key for key, value in report.items() if value is None} == {*PAPER_ONLY}
    assert report["smoothing"]["num_neighbors"] == 0  # nothing was moved
    assert (report["method"], report["estimator"]) == ("manifold", "jet")
    assert report["boundary"] == "auto"
    assert 1 < report["hole_radius"] < 5
    assert report["num_neighbors"] == 15
    assert report["betti_numbers"] == [1, 2, 1]
    rec = rm.reconstruct(np.load(tmp_path / "torus.npy"), 2)
    repair = rec.repair
    assert report["agreed_simplices"] == repair.num_agreed > 600
    assert report["disputed_simplices"] == len(repair.disputed_simplices) > 0
    assert report["filled_simplices"] == len(repair.filled_simplices) > 0
    assert report["inserted_samples"] == len(repair.inserted_vertices)
    assert report["cut_samples"] == len(repair.cut_vertices)
    assert report["outliers"] == len(rec.outliers) == 1
    assert report["merged_samples"] == 2
    for key in ("open_faces", "holes", "boundary_components", "singular_vertices"):
        assert report[key] == 0, key
    assert report["warnings"] == [
        "1 sample is an outlier and was left out; --outliers no keeps all"
    ]


def test_boundary_and_hole_radius(tmp_path):
    source, output = tmp_path / "cap.npy", tmp_path / "cap.ply"
    np.save(source, rm.datasets.spherical_cap(400, random_state=0))

    def report(*options):
        result = run(source, "-k", 2, "-o", output, "--json", *options)
        assert result.exit_code == 0
        return json.loads(result.stdout)

    found = report()
    assert (found["boundary_components"], found["holes"]) == (1, 0)
    assert found["open_faces"] > 10
    assert found["warnings"] == []
    found = report("--hole-radius", 100)
    assert (found["boundary_components"], found["open_faces"]) == (0, 0)
    assert found["hole_radius"] == 100
    found = report("--boundary", "no")
    assert (found["boundary"], found["boundary_components"]) == ("no", 0)
    assert found["open_faces"] == found["holes"] == 0
    assert found["betti_numbers"] == [1, 0, 1]


def test_json_of_a_process_is_all_of_standard_output(circle, tmp_path):
    done = run_process(
        *("reconstruct", circle, "--dim", 1, "-o", tmp_path / "curve.obj", "--json")
    )
    assert done.returncode == 0
    assert done.stderr == ""
    report = json.loads(done.stdout)
    assert report["betti_numbers"] == [1, 1]
    assert report["num_simplices"] == [60, 60]
    assert len(read_points(tmp_path / "curve.obj")) == 60


def test_what_the_result_lacks(tmp_path):
    np.save(tmp_path / "grid.npy", rm.datasets.figure_samples(9))
    output = tmp_path / "mesh.ply"
    options = ("-k", 2, "-o", output, "--json", "--method", "paper")
    result = run(tmp_path / "grid.npy", *options)
    report = json.loads(result.stdout)
    holes = report["holes"]
    assert holes > 0
    said = f"{holes} holes where none were asked for"
    assert report["warnings"] == [said]
    assert result.stderr == f"remanifold: warning: {said}\n"

    result = run(tmp_path / "grid.npy", *options, "--edges", "either")
    report = json.loads(result.stdout)
    assert report["callous_faces"] > 0
    assert report["coface_counts"]["3"] == report["callous_faces"]
    assert (
        f"{report['callous_faces']} edges are in more than two triangles"
        in (report["warnings"])
    )
    assert any("no manifold" in text for text in report["warnings"])


def test_samples_left_out_are_mentioned(tmp_path):
    np.save(tmp_path / "spiral.npy", rm.datasets.figure_samples(5))
    options = ("-k", 1, "-o", tmp_path / "a.vtk", "--json", "--method", "paper")
    result = run(tmp_path / "spiral.npy", *options)
    report = json.loads(result.stdout)
    assert report["boundary_samples"] == report["unused_samples"] == 2
    assert "2 samples are in no simplex (2 have no tangent space)" in report["warnings"]


def test_quiet(tmp_path):
    source, output = tmp_path / "grid.npy", tmp_path / "mesh.ply"
    np.save(source, rm.datasets.figure_samples(9))
    options = ("--dim", 2, "-o", output, "--method", "paper")
    result = run(source, *options, "--quiet")
    assert result.exit_code == 0
    assert result.stdout == result.stderr == ""
    assert output.exists()
    result = run(source, *options, "-q", "--json")
    assert json.loads(result.stdout)["warnings"] != []
    assert result.stderr == ""
    code, shown, _ = run_on_terminal("reconstruct", source, "-k", 2, "-o", output, "-q")
    assert (code, shown) == (0, b"")


def test_noise_and_outliers(tmp_path):
    rng = np.random.default_rng(0)
    points = rm.datasets.sphere(800, random_state=0) * rng.normal(1, 0.03, (800, 1))
    np.save(tmp_path / "noisy.npy", np.vstack([points, [[2.0, 2.0, 0.0]]]))
    output = tmp_path / "mesh.ply"
    arguments = (tmp_path / "noisy.npy", "--dim", 2, "-o", output)
    result = run(*arguments, "--smooth", "auto", "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["outliers"] == 1
    assert report["smoothing"]["num_neighbors"] > 30
    assert report["smoothing"]["noise"] == pytest.approx(0.03, rel=0.2)
    away = np.abs(np.linalg.norm(read_points(output)[:800], axis=1) - 1)
    assert away.max() < 0.05
    kept = run(*arguments, "--smooth", "auto", "--keep-positions")
    assert "outliers" in kept.stdout
    assert "noise 0.0" in kept.stdout
    np.testing.assert_allclose(read_points(output)[:800], points, atol=1e-6)
    for option, text in (("--smooth", "2"), ("--smooth", "much"), ("--outliers", "0")):
        refused = run(*arguments, option, text)
        assert refused.exit_code == 2
        assert option in refused.stderr


def test_options_reach_the_library(tori, tmp_path, monkeypatch):
    calls = []

    def reconstruct(*arguments, **options):
        calls.append((arguments, options))
        return rec

    rec = rm.reconstruct(np.load(tori), 2)
    monkeypatch.setattr(rm, "reconstruct", reconstruct)
    output = tmp_path / "mesh.ply"
    assert run(tori, "--dim", 2, "-o", output).exit_code == 0
    assert (
        run(
            *(
                tori,
                "--dim",
                2,
                "-o",
                output,
                "--method",
                "paper",
                "--num-neighbors",
                12,
            ),
            *("--estimator", "jet", "--edges", "either", "--search", "kdtree"),
            *("--num-threads", 1, "--outliers", 3.5, "--smooth", 20),
        ).exit_code
        == 0
    )
    options = ("--boundary", "no", "--hole-radius", 2.5, "--significance", 0.01)
    options += ("--outliers", "no", "--smooth", "yes")
    assert run(tori, "--dim", 2, "-o", output, *options).exit_code == 0
    defaults = {
        "method": "manifold",
        "boundary": "auto",
        "hole_radius": None,
        "significance": None,
        "outliers": None,
        "smooth": None,
        "num_neighbors": None,
        "estimator": None,
        "edges": None,
        "search": "auto",
        "checks": 256,
        "attributes": {},
        "invalid": "raise",
        "num_threads": None,
        "max_seconds": None,
        "max_memory": None,
        "progress": False,
    }
    chosen = {
        "method": "paper",
        "boundary": "auto",
        "hole_radius": None,
        "significance": None,
        "outliers": 3.5,
        "smooth": 20,
        "num_neighbors": 12,
        "estimator": "jet",
        "edges": "either",
        "search": "kdtree",
        "checks": 256,
        "attributes": {},
        "invalid": "raise",
        "num_threads": 1,
        "max_seconds": None,
        "max_memory": None,
        "progress": False,
    }
    closed = defaults | {"boundary": False, "hole_radius": 2.5, "significance": 0.01}
    closed |= {"outliers": False, "smooth": True}
    assert [options for _, options in calls] == [defaults, chosen, closed]
    for (points, dim), _ in calls:
        np.testing.assert_array_equal(points, np.load(tori))
        assert dim == 2


def test_warnings_of_the_library_are_shown(tori, tmp_path, monkeypatch):
    reconstruct = rm.reconstruct

    def reconstruct_with_warning(*arguments, **options):
        warnings.warn("only some", rm.RecallWarning, stacklevel=1)
        return reconstruct(*arguments, **options)

    monkeypatch.setattr(rm, "reconstruct", reconstruct_with_warning)
    result = run(tori, "--dim", 2, "-o", tmp_path / "mesh.ply", "--json")
    assert json.loads(result.stdout)["warnings"] == ["only some"]
    assert result.stderr == "remanifold: warning: only some\n"


def test_what_the_library_warned_of_is_said_once(tmp_path):
    """What fills its space has a rim."""
    points = np.random.default_rng(0).uniform(size=(60, 2))
    np.save(tmp_path / "square.npy", points)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rm.reconstruct(points, 2, boundary=False)
    assert [w.category for w in caught] == [rm.ManifoldWarning]
    result = run(
        *(tmp_path / "square.npy", "-k", 2, "-o", tmp_path / "a.ply", "--json"),
        *("--boundary", "no"),
    )
    assert result.exit_code == 0
    (said,) = json.loads(result.stdout)["warnings"]
    assert re.fullmatch(
        r"the result lacks something: .*\d holes? where --boundary asks for none.*; "
        "remanifold report shows where",
        said,
    )
    assert as_flags(str(caught[0].message)) == said
    assert result.stderr == f"remanifold: warning: {said}\n"


def test_version_and_help():
    done = run_process("--version")
    assert done.returncode == 0
    assert done.stdout == f"remanifold {rm.__version__}\n"
    result = run("--help")
    assert result.exit_code == 0
    for option in (
        "--dim",
        "--output",
        "--method",
        "--json",
        "--quiet",
        "--num-threads",
    ):
        assert option in result.stdout
    shown = " ".join(result.stdout.split())
    assert "[manifold|paper]" in shown
    assert "[auto|no]" in shown
    assert re.findall(r"\[default: \(?(.*?)\)?[;\]]", shown) == [
        *("manifold", "auto", "by how evenly the samples lie", "0.001"),
        *("auto, or no for paper", "auto, or no for paper"),
        *(
            "3 K (K + 3) / 2, or 10 K for paper",
            "jet, or enclosure for paper",
            "mutual",
            "auto",
            str(CHECKS),
            "auto",
            "by their names, else guessed, which is said",
            "points",
            "by the suffix",
            "by the suffix",
            "all cores",
        ),
        *("no limit", "no limit"),
        *("a cluster on this machine", "all cores", "a share of all", "1000000"),
        "OUTPUT.tiles",
    ]


def test_commands_are_listed_by_the_first_line_of_their_help():
    group = typer.main.get_command(cli.app)
    context = group.make_context("remanifold", ["info", "x"])
    for name, line in cli.COMMANDS.items():
        command = group.get_command(context, name)
        assert command.name == name
        assert command.get_short_help_str(limit=200).removesuffix(".") == line[:-1]


def test_help_loads_neither_numpy_nor_a_command():
    code = (
        "import sys\ntry: from remanifold.cli import app; app(['--help'])\n"
        "except SystemExit: pass\n"
        "print([name for name in ('numpy', 'remanifold.cli.info') if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert "reconstruct" in done.stdout
    assert done.stdout.endswith("[]\n"), done.stderr


def test_import_of_the_package_is_light():
    code = (
        "import sys, remanifold; heavy = {'typer', 'rich', 'meshio', 'gudhi', 'scipy'};"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert done.stdout == "[]\n", done.stderr


# --------------------------------------------------------------------- failure


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "Missing argument 'INPUT'"),
        (["{tori}", "-o", "{out}/a.ply"], "Missing option '--dim'"),
        (["{tori}", "-k", "2"], "Missing option '--output'"),
        (["{tori}", "-k", "0", "-o", "{out}/a.ply"], "'--dim'"),
        (["{tori}", "-k", "two", "-o", "{out}/a.ply"], "'--dim'"),
        (["{tori}", "-k", "2", "-o", "{out}/a.txt"], "cannot write a mesh to .txt"),
        (["{tori}", "-k", "2", "-o", "{out}/a"], "without a suffix"),
        (["{tori}", "-k", "1", "-o", "{out}/a.stl"], "cannot hold edges"),
        (["{tori}", "-k", "3", "-o", "{out}/a.ply"], "cannot hold tetrahedra"),
        (["{tori}", "-k", "2", "-o", "{tori}"], "cannot write a mesh to .npy"),
        (["{tori}", "-k", "2", "-o", "{out}/a.ply", "--method", "x"], "'x' is not one"),
        (["{tori}", "-k", "2", "-o", "{out}/a.ply", "--edges", "and"], "'and' is not"),
        (
            ["{tori}", "-k", "2", "-o", "{out}/a.ply", "--edges", "mutual"],
            "'--edges': is for --method paper only",
        ),
        (
            ["{tori}", "-k", "2", "-o", "{out}/a.ply", "--boundary", "open"],
            "'open' is not one of 'auto', 'no'",
        ),
        (
            [
                *("{tori}", "-k", "2", "-o", "{out}/a.ply", "--method", "paper"),
                *("--boundary", "no"),
            ],
            "'--boundary': is for --method manifold only",
        ),
        (
            [
                *("{tori}", "-k", "2", "-o", "{out}/a.ply", "--method", "paper"),
                *("--hole-radius", "2"),
            ],
            "'--hole-radius': is for --method manifold only",
        ),
        *(
            (
                ["{tori}", "-k", "2", "-o", "{out}/a.ply", "--hole-radius", radius],
                "'--hole-radius'",
            )
            for radius in ("0", "-1", "nan", "inf", "wide")
        ),
        (
            ["{tori}", "-k", "2", "-o", "{out}/a.ply", "--num-threads", "0"],
            "'--num-threads'",
        ),
        (
            ["{tori}", "-k", "2", "-o", "{out}/a.ply", "--num-neighbors", "2"],
            "num_neighbors is 2, expected at least 3",
        ),
        (["{tori}", "-k", "2", "-o", "{out}/a.ply", "--nope"], "No such option"),
    ],
)
def test_wrong_usage(tori, tmp_path, arguments, message):
    before = sorted(tmp_path.iterdir())
    result = run(*(text.format(tori=tori, out=tmp_path) for text in arguments))
    assert result.exit_code == 2
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


def test_output_is_checked_before_the_input_is_read(tmp_path):
    result = run(tmp_path / "absent.ply", "--dim", 2, "-o", tmp_path / "a.docx")
    assert result.exit_code == 2
    assert "absent" not in result.stderr


def test_output_that_cannot_hold_the_dimension_of_the_samples(tmp_path):
    np.save(tmp_path / "a.npy", rm.datasets.flat_torus(100, random_state=0))
    result = run(tmp_path / "a.npy", "--dim", 2, "-o", tmp_path / "a.ply")
    assert result.exit_code == 2
    assert "cannot hold points with 4 coordinates; use .off, .npz" in result.stderr
    assert not (tmp_path / "a.ply").exists()


def test_input_is_not_overwritten(tmp_path):
    write_mesh(tmp_path / "a.ply", rm.datasets.figure_samples(8), [[0, 1, 2]])
    content = (tmp_path / "a.ply").read_bytes()
    (tmp_path / "link.ply").symlink_to(tmp_path / "a.ply")
    for output in ("a.ply", "link.ply"):
        result = run(tmp_path / "a.ply", "--dim", 2, "-o", tmp_path / output)
        assert result.exit_code == 2
        assert "is the input" in result.stderr
    assert (tmp_path / "a.ply").read_bytes() == content


@pytest.mark.parametrize(
    ("name", "content", "dim", "output", "message"),
    [
        ("absent.ply", None, 2, "a.ply", "absent.ply: no such file"),
        ("a.docx", b"", 2, "a.ply", "a.docx: cannot read points from .docx"),
        ("a.csv", b"x,y\n1,2\n3,z\n", 1, "a.ply", "a.csv, line 3: expected numbers"),
        ("a.npz", b"PK", 2, "a.ply", "a.npz: is damaged, truncated"),
        ("a.csv", b"1,2\n3,4\n5,6\n", 3, "a.vtk", "dim is 3, more than the 2 coord"),
        (
            "a.csv",
            b"1,2\nnan,4\n5,6\n",
            1,
            "a.ply",
            "1 of 3 points are not finite, the first is point 1; --drop-invalid leaves",
        ),
        ("a.csv", b"1,2\n", 1, "a.ply", "has 1 sample; a 1-dimensional complex needs"),
        ("a.csv", b"1,2\n3,4\n5,6\n", 1, "no/a.ply", "no does not exist"),
        ("a.csv", b"1,2\n3,4\n5,6\n", 1, "folder.ply", "folder.ply: is a directory"),
    ],
)
def test_failed_run(tmp_path, name, content, dim, output, message):
    (tmp_path / "folder.ply").mkdir()
    if content is not None:
        (tmp_path / name).write_bytes(content)
    before = sorted(tmp_path.rglob("*"))
    result = run(tmp_path / name, "--dim", dim, "-o", tmp_path / output)
    assert result.exit_code == 1
    assert result.stderr.startswith("remanifold: error: ")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert result.stdout == ""
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (MemoryError(), "out of memory"),
        (MemoryError("8 GiB"), "out of memory: 8 GiB"),
        (RuntimeError("lost"), "RuntimeError: lost"),
        (OSError(28, "No space left on device", "a.ply"), "a.ply: No space left on"),
    ],
)
def test_unexpected_failures_are_one_line(tori, tmp_path, monkeypatch, error, message):
    def fail(*_arguments, **_options):
        raise error

    monkeypatch.setattr(rm, "reconstruct", fail)
    result = run(tori, "--dim", 2, "-o", tmp_path / "a.ply")
    assert result.exit_code == 1
    assert result.stderr.startswith(f"remanifold: error: {message}")
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "a.ply").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
@pytest.mark.parametrize(
    "words",
    [
        ["info", "tori"],
        ["info", "tori", "--json"],
        ["convert", "tori", "-", "--format", "csv"],
        ["--version"],
        ["--help"],
    ],
)
def test_full_standard_output_is_one_line(tori, words):
    words = [str(tori) if word == "tori" else word for word in words]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "remanifold", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr.startswith("remanifold: error: ")
    assert done.stderr.endswith("No space left on device\n")
    assert done.stderr.count("\n") == 1


def test_what_a_killed_run_has_left_is_one_line(tori, tmp_path):
    (tmp_path / ".a.csv-0123456789ab.partial").write_text("half of it")
    done = run_process("convert", tori, tmp_path / "a.csv")
    assert done.returncode == 0
    assert "warning: " in done.stderr
    assert "has left .a.csv-0123456789ab.partial" in done.stderr
    assert done.stderr.count("\n") == 1


def test_failure_of_the_writer_leaves_nothing(tori, tmp_path, monkeypatch):
    def fail(*_arguments, **_options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", fail)
    result = run(tori, "--dim", 2, "-o", tmp_path / "a.ply")
    assert result.exit_code == 1
    assert "a.ply: cannot write the file (No space left on device)" in result.stderr
    assert list(tmp_path.iterdir()) == [tori]


def test_interrupt_within_the_library(tori, tmp_path, monkeypatch):
    def interrupt(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(rm, "reconstruct", interrupt)
    result = run(tori, "--dim", 2, "-o", tmp_path / "a.ply")
    assert result.exit_code == 130
    assert result.stderr == "remanifold: interrupted\n"
    assert list(tmp_path.iterdir()) == [tori]


def test_progress_and_interrupt_on_a_terminal(tmp_path):
    """A long run shows its bar; Ctrl-C ends it within moments and leaves no file."""
    source = tmp_path / "sphere.npy"
    np.save(source, rm.datasets.sphere(150_000, random_state=0))
    code, shown, report = run_on_terminal(
        *("reconstruct", source, "--dim", 2, "-o", tmp_path / "mesh.ply"),
        *("--search", "brute_force"),
        interrupt_at=b"neighborhoods",
    )
    assert code == 130
    assert report == b""
    assert b"interrupted" in shown
    assert b"Traceback" not in shown
    assert list(tmp_path.iterdir()) == [source]


def test_no_progress_where_there_is_no_terminal(tori, tmp_path):
    done = run_process("reconstruct", tori, "--dim", 2, "-o", tmp_path / "mesh.ply")
    assert done.returncode == 0
    assert done.stderr == ""
    assert "\x1b" not in done.stdout


def test_old_words_are_taken_and_said(tmp_path):
    source = tmp_path / "circle.csv"
    rm.io.write_points(source, rm.datasets.circle(80, random_state=0))
    arguments = ["reconstruct", str(source), "-k", "1", "-o", str(tmp_path / "a.npz")]
    for old, new in (
        (["--threads", "1"], "--num-threads"),
        (["--threads=1"], "--num-threads"),
        (["--boundary", "closed"], "--boundary no"),
        (["--outliers", "keep"], "--outliers no"),
    ):
        done = RUNNER.invoke(cli.app, [*arguments, *old])
        assert done.exit_code == 0, done.output
        assert f"is called {new} now" in done.stderr
    done = RUNNER.invoke(cli.app, [*arguments, "--num-threads", "-1"])
    assert done.exit_code == 0
    assert "is called" not in done.stderr


@pytest.mark.parametrize(
    ("given", "code", "words"),
    [
        (("--max-memory", "1kB"), 1, "--max-memory is 0.001 MB"),
        (("--max-memory", "1.5 GiB"), 0, ""),
        (("--max-memory", "many"), 2, "'many' is no size, expected bytes or 500MB"),
        (("--max-memory", "1.2.3MB"), 2, "is no size"),
        (("--max-memory", "0"), 2, "is no size"),
        (("--max-seconds", "0"), 1, "--max-seconds is 0.0, expected a positive"),
        (("--max-seconds", "600"), 0, ""),
    ],
)
def test_limits(tmp_path, given, code, words):
    np.savetxt(
        tmp_path / "a.csv", rm.datasets.torus(300, random_state=0), delimiter=","
    )
    command = ["reconstruct", str(tmp_path / "a.csv"), "-k", "2"]
    done = RUNNER.invoke(cli.app, [*command, "-o", str(tmp_path / "a.ply"), *given])
    assert done.exit_code == code, done.output
    assert words in " ".join(done.output.split())
    assert (tmp_path / "a.ply").exists() == (code == 0)


@pytest.mark.parametrize(
    ("text", "number"),
    [("700", 700), ("2k", 2e3), ("3 MB", 3e6), ("1GiB", 2**30), ("0.5TiB", 2**39)],
)
def test_sizes(text, number):
    assert _bytes(text) == number
