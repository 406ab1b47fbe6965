# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebooks run, and print what stands beside their prints."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


def cells(path, kind):
    content = json.loads(path.read_text(encoding="utf-8"))
    return ["".join(c["source"]) for c in content["cells"] if c["cell_type"] == kind]


def test_there_are_five():
    assert [path.stem for path in NOTEBOOKS] == [
        *("choosing_the_dimension", "lidar_with_attributes", "quickstart"),
        *("raw_scan", "shape_space"),
    ]
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    for path in NOTEBOOKS:
        assert f"(notebooks/{path.name})" in index


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(path, tmp_path, monkeypatch, capsys):
    """Cell by cell; what a cell ends with is shown as a notebook does."""
    monkeypatch.chdir(tmp_path)
    names = {}
    for number, code in enumerate(cells(path, "code")):
        tree = ast.parse(code)
        last = tree.body[-1]
        shown = isinstance(last, ast.Expr) and "print(" not in ast.unparse(last)
        if shown:
            tree.body.pop()
        exec(compile(tree, f"{path.name}[{number}]", "exec"), names)  # noqa: S102
        if shown:
            value = eval(ast.unparse(last), names)
            show = getattr(value, "_repr_html_", value.__repr__)
            assert show()
    printed = iter(capsys.readouterr().out.splitlines())
    for code in cells(path, "code"):
        for expected in re.findall(r"(?m)^print\(.*\)  # ([^\n]*)", code):
            assert expected in printed  # in this order


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_hold_no_results(path):
    """These would be of some day and some machine."""
    content = json.loads(path.read_text(encoding="utf-8"))
    assert content["nbformat"] == 4
    numbers = [cell["id"] for cell in content["cells"]]
    assert len({*numbers}) == len(numbers)
    for cell in content["cells"]:
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None
        assert max(map(len, "".join(cell["source"]).splitlines())) <= 96
    assert content["cells"][0]["source"][0].startswith("# ")
