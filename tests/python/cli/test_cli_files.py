# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's ``info`` and ``convert``, streams, completion, and help."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import laspy
import numpy as np
import pytest
from typer.testing import CliRunner

import remanifold as rm
from remanifold import cli
from remanifold.io import (
    read_complex,
    read_fields,
    read_points,
    write_mesh,
    write_points,
)

try:
    RUNNER = CliRunner(mix_stderr=False)
except TypeError:  # newer Typer always keeps standard error apart
    RUNNER = CliRunner()

TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0.1], [9, 9, 9]])
HEIGHT = {"height": np.arange(5) / 3}


def run(*arguments):
    return RUNNER.invoke(cli.app, [str(argument) for argument in arguments])


def run_process(*arguments, data=b"", **environment):
    """Exit code, standard output and standard error, as bytes."""
    done = subprocess.run(
        [sys.executable, "-m", "remanifold", *map(str, arguments)],
        input=data,
        capture_output=True,
        check=False,
        env=os.environ | environment,
    )
    return done.returncode, done.stdout, done.stderr


def rows_of(table):
    rows = dict(line.split("  ", 1) for line in table.splitlines() if "  " in line)
    return {name: value.strip() for name, value in rows.items()}


@pytest.fixture
def square(tmp_path):
    path = tmp_path / "square.ply"
    write_mesh(path, SQUARE, TRIANGLES, fields=HEIGHT)
    return path


# ------------------------------------------------------------------------- info


def test_info_of_a_mesh(square):
    result = run("info", square)
    assert result.exit_code == 0, result.stderr
    rows = rows_of(result.stdout)
    assert rows["points"] == "5 in R^3"
    assert rows["from"] == "0, 0, 0"
    assert rows["to"] == "9, 9, 9"
    assert rows["diagonal"] == "15.5885"
    assert rows["nearest neighbor"].startswith("1.005 away in the median, 1 to ")
    assert rows["fields"] == "height, float64, 0 to 1.333"
    assert rows["simplices"] == "2 triangles"
    assert rows["unused vertices"] == "1"
    assert rows["complex"] == "4 vertices, 5 edges, 2 triangles"
    assert rows["Euler characteristic"] == "1"
    assert rows["Betti numbers"] == "1, 0, 0"
    assert (rows["manifold"], rows["closed"], rows["orientable"]) == (
        "yes",
        "no",
        "yes",
    )


def test_info_as_json(square):
    result = run("info", square, "--json")
    report = json.loads(result.stdout)
    assert report["input"] == str(square)
    assert report["format"] == "ply"
    assert report["bounding_box"] == [[0, 0, 0], [9, 9, 9]]
    assert report["simplices"] == {"2": 2}
    assert report["topology"]["num_simplices"] == [4, 5, 2]
    assert report["topology"]["singular_vertices"] == 0
    assert report["fields"]["height"]["components"] == 1
    assert report["spacing"]["least"] == 1
    assert report["warnings"] == []


def test_info_of_points(tmp_path):
    points = np.vstack([np.eye(9), np.eye(9)[:2], np.full((1, 9), np.nan)])
    np.save(tmp_path / "a.npy", points)
    result = run("info", tmp_path / "a.npy")
    rows = rows_of(result.stdout)
    assert rows["points"] == "12 in R^9"
    assert rows["not finite"] == "1"
    assert rows["coincident points"] == "2"
    assert rows["from"] == "0, 0, 0, 0, 0, 0, ..."
    assert "simplices" not in rows
    assert "complex" not in rows
    report = json.loads(run("info", tmp_path / "a.npy", "--json").stdout)
    assert report["topology"] is None
    assert report["spacing"]["median"] == pytest.approx(2**0.5)


@pytest.mark.parametrize("points", [[[1, 2, 3]], [[1, 2, 3]] * 2, [[np.inf, 0, 0]]])
def test_info_of_very_few_points(tmp_path, points):
    write_points(tmp_path / "a.xyz", points)
    result = run("info", tmp_path / "a.xyz", "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["spacing"] is None
    assert run("info", tmp_path / "a.xyz").exit_code == 0


def test_info_says_what_a_reconstruction_needs_to_know(tmp_path):
    points = rm.datasets.torus(800, random_state=0)
    table = np.column_stack([np.arange(800), points, np.arange(800) % 5])
    np.savetxt(
        tmp_path / "a.csv", table, delimiter=";", header="id;x;y;z;class", comments=""
    )
    result = run("info", tmp_path / "a.csv")
    assert result.exit_code == 0, result.stderr
    rows = rows_of(result.stdout)
    assert rows["coordinates"] == "the columns x, y, z"
    assert rows["dimension"].startswith("2, sure (confidence 0.")
    assert rows["spread"].startswith("distances to the sixth neighbor vary 1.")
    assert rows["it would take"] == "a second or less by one thread, 1 MB of memory"
    assert "structure" not in rows
    assert "units" not in rows
    assert "cells are separated by semicolons" in result.stderr
    report = json.loads(run("info", tmp_path / "a.csv", "--json").stdout)
    assert report["dimension"]["dim"] == 2
    assert 800 * 290 < report["expected"]["bytes"] < 800 * 1000
    assert 0 < report["expected"]["seconds"] < 60
    assert report["warnings"] == []
    assert report["notes"] == ["cells are separated by semicolons"]
    assert {*report["fields"]} == {"id", "class"}
    brief = json.loads(run("info", tmp_path / "a.csv", "--json", "--brief").stdout)
    assert brief["dimension"] is None
    assert brief["spacing"] == report["spacing"]


def test_info_says_what_was_guessed_and_what_looks_wrong(tmp_path):
    grid = np.stack(np.meshgrid(range(20), range(15)), -1).reshape(-1, 2) / 1000
    table = np.column_stack(
        [np.arange(300), grid + np.array([13, 52]), 40 + 90 * grid[:, 0] ** 2]
    )
    table[:, 3] *= np.arange(1, 301)
    np.savetxt(tmp_path / "a.txt", table, fmt="%.9f")
    result = run("info", tmp_path / "a.txt")
    rows = rows_of(result.stdout)
    assert rows["structure"].startswith("a lattice over the coordinates 0, 1")
    assert rows["units"].startswith("the first two coordinates look like degrees")
    assert "column 0 counts the rows; --columns decides" in result.stderr
    result = run("info", tmp_path / "a.txt", "--columns", "0,1")
    assert rows_of(result.stdout)["points"] == "300 in R^2"
    assert "guess" not in result.stderr
    assert "decides" not in result.stderr


# ---------------------------------------------------- columns, attributes, dropping


@pytest.fixture
def scan(tmp_path):
    """A table with colors, in which every fifth row has no point."""
    points = rm.datasets.torus(500, random_state=0)
    lines = ["id,x,y,z,red,green,blue"]
    for i, (x, y, z) in enumerate(points.tolist()):
        place = ",," if i % 5 == 0 else f"{x!r},{y!r},{z!r}"
        lines.append(f"{i},{place},{i % 256},{i // 2},7")
    (tmp_path / "scan.csv").write_text("\n".join(lines))
    return tmp_path / "scan.csv"


def test_from_a_colored_scan_with_gaps_to_a_colored_mesh(scan, tmp_path):
    failed = run("reconstruct", scan, "-k", 2, "-o", tmp_path / "a.ply")
    assert failed.exit_code == 1
    assert "100 of 500 points are not finite, the first is point 0" in failed.stderr
    assert "--drop-invalid leaves them out" in failed.stderr
    options = ("-k", 2, "--drop-invalid")
    result = run("reconstruct", scan, *options, "-o", tmp_path / "a.ply", "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["betti_numbers"] == [1, 2, 1]
    assert report["invalid_samples"] == 100
    fields = read_fields(tmp_path / "a.ply")
    kept = np.flatnonzero(np.arange(500) % 5)
    np.testing.assert_array_equal(fields["sample"], kept)
    np.testing.assert_array_equal(fields["id"], kept)
    np.testing.assert_array_equal(fields["colors"][:, 0], kept % 256)
    result = run("reconstruct", scan, *options, "-o", tmp_path / "a.obj")
    assert "note: .obj has no room for id" in result.stderr
    np.testing.assert_array_equal(
        read_fields(tmp_path / "a.obj")["colors"], fields["colors"]
    )
    assert rows_of(result.stdout)["not finite"] == "100, left out"
    result = run(
        "reconstruct", scan, *options, "-o", tmp_path / "b.ply", "--fields", "none"
    )
    assert read_fields(tmp_path / "b.ply") == {}
    result = run("dimension", scan, "--drop-invalid", "--json")
    assert json.loads(result.stdout)["dim"] == 2
    assert run("dimension", scan).exit_code == 1
    page = run("report", scan, *options, "-o", tmp_path / "a.html")
    assert page.exit_code == 0, page.stderr


@pytest.mark.parametrize(
    ("columns", "code", "message"),
    [
        ("red,green", 0, "500 in R^2"),
        ("4,5,6", 0, "500 in R^3"),
        (
            "red,purple",
            1,
            "there is no 'purple'; there are id, x, y, z, red, green, blue",
        ),
        ("0,9", 1, "there is no column 9, only 0 to 6"),
        ("red,red", 2, "columns has 'red' twice"),
    ],
)
def test_columns_on_the_command_line(scan, columns, code, message):
    result = run("info", scan, "--columns", columns, "--brief")
    assert result.exit_code == code
    shown = " ".join((result.stdout + result.stderr).replace("│", " ").split())
    assert message in shown


def test_what_a_file_seems_to_be(tmp_path):
    for name, content, message in (
        ("a.dat", b"1 2 3\n4 5 6\n7 8 9\n", "a table with blanks: say --format txt"),
        ("a.ply", b"\x89PNG\r\n\x1a\n", "it seems to be a PNG picture"),
        ("a.las", b"<!DOCTYPE html>", "it seems to be a web page, not the file itself"),
        ("a.laz", b"version https://git-lfs.github.com/spec/v1", "run git lfs pull"),
        ("a.xyz", b"\x1f\x8b\x08\0\0\0\0", "is compressed, and damaged or truncated"),
        ("a.csv", b"PK\3\4" + b"\0" * 26 + b"xl/workbook.xml", "save it as .csv"),
        ("a.off", b"ply\nformat ascii 1.0\n", "a PLY file: say --format ply"),
        ("a.npy", b"\x80\x04\x95", "a pickle of Python; save its array by numpy.save"),
        ("a.txt", b"", "the file is empty"),
        ("a", b"OFF\n0 0 0\n", "an OFF file: say --format off, or name it .off"),
    ):
        (tmp_path / name).write_bytes(content)
        result = run("info", tmp_path / name)
        assert result.exit_code == 1
        assert message in result.stderr, result.stderr
        assert result.stderr.startswith(f"remanifold: error: {tmp_path / name}")
        assert result.stderr.count("\n") == 1


def test_info_of_several_dimensions(tmp_path):
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in SQUARE)
    (tmp_path / "a.obj").write_text(text + "f 1 2 3\nf 1 3 4\nf 1 3 4\nl 1 2 5\n")
    failed = run("info", tmp_path / "a.obj")
    assert failed.exit_code == 1
    assert "1 edges that are in none of its 3 triangles" in failed.stderr
    result = run("info", tmp_path / "a.obj", "-k", 2)
    assert result.exit_code == 0
    assert "1 triangles left out, 0 with a vertex twice and 1 repeated" in result.stderr
    assert rows_of(result.stdout)["simplices"] == "2 edges, 3 triangles"
    result = run("info", tmp_path / "a.obj", "-k", 1)
    assert rows_of(result.stdout)["complex"] == "3 vertices, 2 edges"


# ---------------------------------------------------------------------- convert


@pytest.mark.parametrize("suffix", [".npz", ".vtk", ".vtu"])
def test_convert_keeps_all(square, tmp_path, suffix):
    output = tmp_path / f"a{suffix}"
    result = run("convert", square, output)
    assert result.exit_code == 0, result.stderr
    assert result.stdout == f"{output}: 5 points in R^3, 2 triangles, fields height\n"
    found = read_complex(output)
    assert found.vertices.tobytes() == SQUARE.astype(float).tobytes()
    np.testing.assert_array_equal(found.simplices, TRIANGLES)
    np.testing.assert_array_equal(read_fields(output)["height"], HEIGHT["height"])
    back = tmp_path / "back.ply"
    assert run("convert", output, back, "-q").stdout == ""
    assert back.read_bytes() == square.read_bytes()


@pytest.mark.parametrize(
    ("name", "loss"),
    [
        ("a.obj", "the fields height"),
        ("a.off", "the fields height"),
        ("a.stl", "the fields height; 1 vertices in no triangle"),
        ("a.csv", "2 triangles"),
        ("a.npy", "the fields height; 2 triangles"),
        ("a.glb", "the digits of the coordinates beyond single precision"),
    ],
)
def test_convert_refuses_losses_unless_told(square, tmp_path, name, loss):
    output = tmp_path / name
    result = run("convert", square, output)
    assert result.exit_code == 2
    shown = " ".join(result.stderr.replace("│", " ").split())
    assert f"would lose {loss}. Say --lossy" in shown
    assert not output.exists()
    result = run("convert", square, output, "--lossy")
    assert result.exit_code == 0
    assert result.stderr == f"remanifold: warning: lost: {loss}\n"
    assert output.exists()
    if name != "a.glb":
        found = read_points(output)
        np.testing.assert_array_equal(found, SQUARE[: len(found)])


def test_convert_points(square, tmp_path):
    result = run("convert", square, tmp_path / "a.csv", "--points")
    assert result.exit_code == 0
    assert result.stdout.endswith("a.csv: 5 points in R^3\n")
    np.testing.assert_array_equal(read_points(tmp_path / "a.csv"), SQUARE)
    result = run("convert", tmp_path / "a.csv", tmp_path / "b.vtk")
    assert result.exit_code == 0
    np.testing.assert_array_equal(read_points(tmp_path / "b.vtk"), SQUARE)
    failed = run("convert", tmp_path / "a.csv", tmp_path / "c.stl")
    assert failed.exit_code == 1
    assert "cannot write points to .stl" in failed.stderr


def test_convert_a_scan_with_what_goes_along(tmp_path):
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales = [0.001] * 3
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = SQUARE.T
    cloud.intensity = np.arange(5, dtype=np.uint16)
    cloud.write(tmp_path / "a.laz")
    assert run("convert", tmp_path / "a.laz", tmp_path / "a.ply").exit_code == 0
    np.testing.assert_array_equal(read_points(tmp_path / "a.ply"), SQUARE)
    assert read_fields(tmp_path / "a.ply")["intensity"].tolist() == [0, 1, 2, 3, 4]
    assert run("convert", tmp_path / "a.laz", tmp_path / "a.csv").exit_code == 0
    assert read_fields(tmp_path / "a.csv")["intensity"].tolist() == [0, 1, 2, 3, 4]
    failed = run("convert", tmp_path / "a.laz", tmp_path / "a.npy")
    assert failed.exit_code == 2
    assert "intensity" in failed.stderr


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["{square}", "{out}/a.docx"], 2, "cannot write to .docx; use one of .ply"),
        (["{square}", "{square}"], 2, "is the input"),
        (["{square}"], 2, "Missing argument 'OUTPUT'"),
        (["{square}", "-"], 2, "standard output needs a format, as in --format ply"),
        (["-", "{out}/a.ply"], 2, "standard input needs a format, as in --format csv"),
        (["-", "-", "--format", "csv"], 2, "as in --output-format ply"),
        (["{square}", "{out}/a.ply", "--format", "doc"], 2, "'doc' is not one of"),
        (["{out}/no.ply", "{out}/a.vtk"], 1, "no.ply: no such file"),
        (["{square}", "{out}/a.vtk", "-k", "3"], 1, "holds no tetrahedra, but 2 tri"),
        (["{square}", "{out}/no/a.vtk"], 1, "no does not exist"),
    ],
)
def test_convert_fails(square, tmp_path, arguments, code, message):
    before = sorted(tmp_path.iterdir())
    places = {"square": square, "out": tmp_path}
    result = run("convert", *(text.format(**places) for text in arguments))
    assert result.exit_code == code
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert "Traceback" not in result.stderr
    assert sorted(tmp_path.iterdir()) == before


# ---------------------------------------------------------------------- streams


@pytest.mark.slow
def test_a_pipe_from_points_to_a_mesh(tmp_path):
    points = rm.datasets.torus(400, random_state=0)
    write_points(tmp_path / "a.csv", points)
    data = (tmp_path / "a.csv").read_bytes()
    code, mesh, report = run_process(
        *("reconstruct", "-", "--format", "csv", "-k", 2, "-o", "-"),
        *("--output-format", "ply", "--json"),
        data=data,
    )
    assert code == 0, report
    assert json.loads(report)["betti_numbers"] == [1, 2, 1]
    rec = rm.reconstruct(points, 2)
    (tmp_path / "a.ply").write_bytes(mesh)
    np.testing.assert_array_equal(
        read_complex(tmp_path / "a.ply").simplices, rec.simplices
    )
    np.testing.assert_array_equal(
        read_fields(tmp_path / "a.ply")["spacing"], rec.quality.spacing
    )
    code, text, error = run_process(
        "convert",
        "-",
        "-",
        "--format",
        "ply",
        "--output-format",
        "off",
        "--lossy",
        data=mesh,
    )
    assert (code, text[:14]) == (0, b"OFF\n400 800 0\n")
    assert error.startswith(b"remanifold: warning: lost: the fields boundary, ")
    code, text, _ = run_process("info", "-", "--format", "ply", "--json", data=mesh)
    assert json.loads(text)["topology"]["betti_numbers"] == [1, 2, 1]
    code, text, _ = run_process(
        "dimension", "-", "--format", "csv", "--json", data=data
    )
    assert json.loads(text)["dim"] == 2


def test_format_is_of_the_output_where_that_alone_is_a_stream(tmp_path):
    write_points(tmp_path / "a.npy", rm.datasets.circle(60, random_state=0))
    code, mesh, report = run_process(
        *("reconstruct", tmp_path / "a.npy", "-k", 1, "-o", "-", "--format", "obj")
    )
    assert code == 0
    assert mesh.count(b"\nl ") == 60
    assert b"components" in report
    assert list(tmp_path.iterdir()) == [tmp_path / "a.npy"]


def test_format_whatever_the_name_says(tmp_path):
    (tmp_path / "points.dat").write_text("0 0\n1 0\n1 1\n")
    result = run("info", tmp_path / "points.dat", "--format", "txt")
    assert rows_of(result.stdout)["points"] == "3 in R^2"
    failed = run("info", tmp_path / "points.dat")
    assert failed.exit_code == 1
    assert "cannot read points from .dat" in failed.stderr


def test_bad_input_on_a_stream():
    code, out, error = run_process("info", "-", "--format", "csv", data=b"1,2\n3,x\n")
    assert (code, out) == (1, b"")
    assert error.startswith(b"remanifold: error: standard input, line 2: expected numb")


def test_fields_can_be_left_out(tmp_path):
    write_points(tmp_path / "a.npy", rm.datasets.circle(60, random_state=0))
    options = ("reconstruct", tmp_path / "a.npy", "-k", 1, "-o", tmp_path / "a.ply")
    assert run(*options).exit_code == 0
    assert {"boundary", "outlier", "spacing"} <= {*read_fields(tmp_path / "a.ply")}
    assert run(*options, "--fields", "none").exit_code == 0
    assert read_fields(tmp_path / "a.ply") == {}


# -------------------------------------------------------------- help, completion


@pytest.mark.parametrize("command", ["reconstruct", "dimension", "info", "convert"])
def test_help_has_examples_that_parse(command):
    result = run(command, "--help")
    assert result.exit_code == 0
    lines = result.stdout.partition("Examples:\n")[2].splitlines()
    lines = [line.strip() for line in lines if f"remanifold {command}" in line]
    assert len(lines) >= 3
    for line in lines:
        words = line.partition(f"remanifold {command}")[2].partition(">")[0]
        words = words.partition(" | ")[0].split()
        # What is wrong is that the files are not there, not the options.
        failed = run(command, *words)
        assert failed.exit_code == 1, failed.stderr
        assert "no such file" in failed.stderr or "standard input" in failed.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "position", "expected"),
    [
        ("remanifold ", 1, {"reconstruct", "dimension", "info", "convert"}),
        ("remanifold rec", 1, {"reconstruct"}),
        ("remanifold reconstruct a.ply --method ", 4, {"manifold", "paper"}),
        ("remanifold convert a.ply - --format vt", 5, {"vtk", "vtp", "vtu"}),
    ],
)
def test_completion(words, position, expected):
    code, out, _ = run_process(
        _REMANIFOLD_COMPLETE="complete_bash",
        COMP_WORDS=words,
        COMP_CWORD=str(position),
    )
    assert code == 0
    found = {*out.decode().split()}
    assert expected <= found
    assert len(expected) > 3 or found == expected


def test_completion_is_offered():
    code, out, _ = run_process(
        "--show-completion", "bash", _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1"
    )
    assert code == 0
    assert b"_REMANIFOLD_COMPLETE=complete_bash" in out


def said(done):
    """Both streams, of any Typer."""
    return done.stdout + done.stderr


def test_matrices_of_distances_and_products(tmp_path):
    points = rm.datasets.sphere(80, random_state=0)
    away = np.linalg.norm(points[:, None] - points, axis=2)
    np.save(tmp_path / "away.npy", away)
    pd_like = ["," + ",".join(map(str, range(80)))]
    pd_like += [
        f"{i}," + ",".join(map(repr, row)) for i, row in enumerate(away.tolist())
    ]
    (tmp_path / "away.csv").write_text("\n".join(pd_like))
    np.save(tmp_path / "gram.npy", points @ points.T)
    expected = np.sort(rm.reconstruct(distances=away, dim=2).simplices, axis=1)
    for name, kind in (("away.npy", "distances"), ("away.csv", "distances")):
        arguments = (tmp_path / name, "-k", 2, "--matrix", kind)
        done = run("reconstruct", *arguments, "-o", tmp_path / "a.rm.npz")
        assert done.exit_code == 0, said(done)
        assert "80 known by products or distances" in said(done)
        found = rm.load(tmp_path / "a.rm.npz").simplices
        np.testing.assert_array_equal(np.sort(found, axis=1), expected)
    done = run(
        *("reconstruct", tmp_path / "gram.npy", "-k", "auto", "--matrix", "gram"),
        *("-o", tmp_path / "a.rm.npz"),
    )
    assert done.exit_code == 0, said(done)
    assert rm.load(tmp_path / "a.rm.npz").topology().betti_numbers == (1, 0, 1)
    done = run("reconstruct", tmp_path / "away.npy", "-k", 2, "-o", tmp_path / "a.npz")
    assert "--matrix distances takes distances" in said(done)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["-o", "a.ply"], "have no coordinates, which meshes need"),
        (["-o", "a.rm.npz", "--columns", "0,1"], "are for points"),
        (["-o", "a.rm.npz"], "4 rows of 3 numbers, and --matrix expects"),
    ],
)
def test_matrices_that_cannot_be(tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.arange(12.0).reshape(4, 3))
    done = run("reconstruct", "a.npy", "-k", 1, "--matrix", "distances", *arguments)
    assert done.exit_code != 0
    assert says in " ".join(said(done).replace("│", "").split())
