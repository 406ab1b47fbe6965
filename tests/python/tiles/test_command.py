# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold reconstruct --distributed``."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import remanifold as rm
from remanifold.cli import app
from remanifold.cli._distributed import Line


def run(*arguments):
    return CliRunner().invoke(app, ["reconstruct", *map(str, arguments)])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("samples")
    points = rm.datasets.torus(6_000, random_state=0)
    np.save(folder / "a.npy", points[:2_500])
    np.save(folder / "b.npy", points[2_500:])
    return folder


def test_a_folder_becomes_a_mesh(folder, tmp_path):
    out = tmp_path / "mesh.ply"
    options = ("-k", 2, "-o", out, "--distributed", "--workers", 0)
    done = run(folder, *options, "--tile-size", 2_000, "--json")
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout)
    assert said["tiles"] > 1
    assert said["euler_characteristic"] == 0
    assert said["work"] == f"{out}.tiles"
    assert set(said["stages"]["tiles0"]) == {"tasks", "known", "bytes", "seconds"}
    points = np.concatenate([np.load(folder / f"{name}.npy") for name in "ab"])
    rec = rm.reconstruct(points, 2)
    rm.io.write_mesh(tmp_path / "once.ply", points, rec.simplices)
    assert out.read_bytes() == (tmp_path / "once.ply").read_bytes()

    done = run(folder, *options, "--tile-size", 2_000)
    assert done.exit_code == 1
    assert "work holds a run already" in done.output
    done = run(folder, *options, "--tile-size", 2_000, "--resume")
    assert done.exit_code == 0, done.output
    assert "known before" in done.output


def test_what_a_folder_holds(folder, tmp_path):
    done = CliRunner().invoke(app, ["info", str(folder), "--json"])
    assert done.exit_code == 0, done.output
    points = np.concatenate([np.load(folder / f"{name}.npy") for name in "ab"])
    said = json.loads(done.stdout)
    assert said["files"] == {"a.npy": 2_500, "b.npy": 3_500}
    assert (said["num_points"], said["ambient_dim"]) == points.shape
    assert said["bounding_box"] == [
        points.min(axis=0).tolist(),
        points.max(axis=0).tolist(),
    ]
    shown = CliRunner().invoke(app, ["info", str(folder)]).stdout
    assert "6,000 in R^3" in shown
    done = CliRunner().invoke(app, ["info", str(folder), "--dim", "2"])
    assert (done.exit_code, "is for one file" in done.output) == (2, True)
    done = CliRunner().invoke(app, ["info", str(tmp_path)])
    assert (done.exit_code, "without a file of .npy" in done.output) == (1, True)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--workers", 2), "--workers is for --distributed"),
        (("--resume",), "--resume is for --distributed"),
        (("--distributed", "--method", "paper"), "is for one piece"),
        (
            ("--distributed", "--scheduler", "tcp://a:1", "--memory-limit", "1GiB"),
            "the scheduler has workers already",
        ),
    ],
)
def test_options_that_do_not_go_together(folder, tmp_path, options, words):
    done = run(folder, "-k", 2, "-o", tmp_path / "mesh.ply", *options)
    assert done.exit_code == 2
    plain = " ".join(done.output.replace("│", " ").split())
    assert words in plain


def test_what_ply_does_not_hold_is_said_first(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((5_000, 4)))
    done = run(
        tmp_path / "a.npy", "-k", 2, "-o", tmp_path / "mesh.ply", "--distributed"
    )
    assert done.exit_code == 1
    assert "dimension 2 in R^4" in done.output
    assert not (tmp_path / "mesh.ply.tiles").exists()


def test_one_line_of_progress():
    line = Line(8_000)
    line.step = "tiles0"
    assert line.text(0, 8, 0.0) == "tiles0 0/8"
    assert line.text(2, 8, 4.0) == "tiles0 2/8, 500 samples/s, 12 s left"
    assert line.text(8, 8, 16.0) == "tiles0 8/8"


def test_messages_name_flags(tmp_path):
    points = np.concatenate(
        [rm.datasets.torus(5_000, random_state=0), [[0.0, 0.0, 3.0]]]
    )
    (tmp_path / "scan").mkdir()
    np.save(tmp_path / "scan" / "a.npy", points)
    arguments = (tmp_path / "scan", "-k", 2, "-o", tmp_path / "out.ply")
    done = run(*arguments)
    assert done.exit_code == 1
    assert "a folder of them is for reconstruct --distributed" in done.output
    tiled = ("--distributed", "--workers", 0)
    done = run(*arguments, *tiled)
    assert done.exit_code == 1
    assert "pass --outliers no to keep all, or leave out --distributed" in done.output
    done = run(*arguments, *tiled, "--outliers", "no")
    assert done.exit_code == 0, done.output
    done = run(*arguments, *tiled, "--outliers", "no")
    assert "--work holds a run already" in done.output
    assert "pass --resume to go on" in done.output
