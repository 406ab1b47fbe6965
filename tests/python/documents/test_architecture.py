# SPDX-License-Identifier: GPL-3.0-or-later
"""The page on architecture says what the tree is."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "docs" / "examples" / "architecture.py"


@pytest.fixture(scope="module")
def architecture():
    spec = importlib.util.spec_from_file_location("architecture", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not (ROOT / module.CORE).is_dir():
        pytest.skip("the sources are not here")
    return module


def test_every_room_has_its_place(architecture):
    assert architecture.rooms(architecture.CORE) == sorted(architecture.CORE_ROOMS)
    assert architecture.rooms(architecture.PACKAGE) == sorted(
        architecture.PACKAGE_ROOMS
    )


def test_every_file_says_what_it_is(architecture):
    silent = [
        path
        for top, known in (
            (architecture.CORE, architecture.CORE_ROOMS),
            (architecture.PACKAGE, architecture.PACKAGE_ROOMS),
        )
        for folder in (top, *(f"{top}/{room}" for room in known))
        for path in architecture.files(folder)
        if not architecture.header_of(path)
    ]
    assert silent == []


def test_page_and_picture_are_made_from_the_tree(architecture):
    """Else: python docs/examples/architecture.py."""
    page = architecture.PAGE.read_text(encoding="utf-8")
    assert page == architecture.with_tables(page)
    assert architecture.FIGURE.read_text(encoding="utf-8") == architecture.picture()


def test_files_that_the_page_speaks_of_exist(architecture):
    """What stands before the tables is written by hand."""
    page = architecture.PAGE.read_text(encoding="utf-8")
    said = page[: page.index("<!-- files")]
    names = set(re.findall(r"`((?:[\w.]+/)*[\w]+\.(?:py|cpp|hpp|sh|json))`", said))
    assert names
    tree = [
        p for top in ("cpp", "python", "tests", ".ci") for p in (ROOT / top).rglob("*")
    ]
    known = {p.relative_to(ROOT).as_posix() for p in tree}
    missing = [
        n for n in names if not any(k.endswith("/" + n) or k == n for k in known)
    ]
    assert missing == []


@pytest.mark.parametrize("page", ["CONTRIBUTING.md"])
def test_files_of_the_recipes_exist(page):
    if not (ROOT / "cpp" / "src").is_dir():
        pytest.skip("the sources are not here")
    text = (ROOT / page).read_text(encoding="utf-8")
    names = re.findall(r"`((?:cpp|python|tests|docs|benchmarks)/[\w./]+)`", text)
    assert len(names) > 20
    missing = [n for n in names if "NAME" not in n and not (ROOT / n).exists()]
    assert missing == []
