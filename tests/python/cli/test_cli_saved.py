# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved results on the command line."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import remanifold as rm
from remanifold.cli import app

RUNNER = CliRunner()


def invoke(*arguments, code=0):
    done = RUNNER.invoke(app, [*map(str, arguments)])
    assert done.exit_code == code, done.output
    return done


@pytest.fixture
def saved(tmp_path):
    source = tmp_path / "curve.csv"
    points = rm.datasets.trefoil(120, random_state=0)
    rm.io.write_points(source, points, fields={"heat": points[:, 0]})
    path = tmp_path / "curve.rm.npz"
    invoke("reconstruct", source, "-k", 1, "-o", path, "--quiet")
    return path


def test_what_is_saved_is_the_whole_result(saved):
    rec = rm.load(saved)
    assert [*rec.vertex_attributes] == ["heat"]
    source = saved.with_name("curve.csv")
    assert rec.provenance.source == {
        "name": "curve.csv",
        "sha256": f"sha256:{hashlib.sha256(source.read_bytes()).hexdigest()}",
        "columns": "coordinates are the columns x, y, z",
    }
    assert rec.provenance.is_of(rm.io.read_points(source))
    assert rec.provenance.command.split()
    assert "quality" in vars(rec)


def test_info_shows_the_parameters(saved):
    rec = rm.load(saved)
    said = " ".join(invoke("info", saved).stdout.split())
    for name, value, _ in rec.parameters.rows():
        assert f"{name} {value}" in said
    assert "curve.csv" in said
    report = json.loads(invoke("info", saved, "--json").stdout)["result"]
    assert report["output_digest"] == rec.digest
    assert report["input_digest"] == rec.provenance.input
    assert report["version"] == rm.__version__
    assert report["parameters"]["dim"] == {"value": 1, "given": True, "why": ""}
    assert report["seconds"] == rec.timings


def test_other_files_have_no_parameters(saved):
    report = json.loads(invoke("info", saved.with_name("curve.csv"), "--json").stdout)
    assert report["result"] is None


def test_meshes_are_made_of_it(saved, tmp_path):
    mesh = tmp_path / "curve.ply"
    invoke("convert", saved, mesh)
    rec = rm.load(saved)
    np.testing.assert_array_equal(rm.io.read_complex(mesh).simplices, rec.simplices)
    header = mesh.read_bytes().partition(b"end_header")[0].decode()
    assert f"comment output {rec.digest}" in header
    assert f"comment source {rec.provenance.source['sha256']}" in header
    found = tmp_path / "found.csv"
    invoke("project", saved, saved.with_name("curve.csv"), "-o", found)
    assert found.exists()


def test_samples_are_taken_from_it(saved, tmp_path):
    again = tmp_path / "again.rm.npz"
    invoke("reconstruct", saved, "-k", 1, "-o", again)
    assert rm.load(again).digest == rm.load(saved).digest


def test_pages_are_made_of_it(saved, tmp_path):
    pytest.importorskip("plotly")
    page = tmp_path / "page.html"
    invoke("report", saved, "-o", page)
    assert rm.load(saved).provenance.command.split()[0] in page.read_text(
        encoding="utf-8"
    )


def test_what_a_saved_result_settles_cannot_be_asked_for(saved, tmp_path):
    page = tmp_path / "page.html"
    for more in (("-k", 1), ("--hole-radius", 2.0), ("--method", "paper")):
        said = invoke("report", saved, "-o", page, *more, code=2).output
        assert "has its parameters" in " ".join(said.split())
    said = invoke("report", saved.with_name("curve.csv"), "-o", page, code=2).output
    assert "--dim" in said
    source = saved.with_name("curve.csv")
    for flag in (("--keep-positions",), ("--fields", "none")):
        invoke("reconstruct", source, "-k", 1, "-o", saved, *flag, code=2)
    invoke("convert", source, tmp_path / "b.rm.npz", code=1)
