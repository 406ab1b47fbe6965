# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of the method on the pages are those of the core."""

from __future__ import annotations

from pathlib import Path

import pytest

import remanifold as rm
from remanifold import _core

ROOT = Path(__file__).resolve().parents[3]


def words(path):
    """The text of a page or docstring in one line."""
    text = path if isinstance(path, str) else (ROOT / path).read_text(encoding="utf-8")
    return " ".join(text.split())


@pytest.mark.parametrize(
    "text",
    [
        "docs/choosing_parameters.md",
        "docs/how_it_works.md",
        "docs/sampling_report.md",
        pytest.param(rm.reconstruct.__doc__, id="reconstruct"),
        pytest.param(rm.Quality.__doc__, id="Quality"),
    ],
)
def test_local_scale(text):
    place = ROOT / text if text.endswith(".md") else text
    assert _core.SCALE_WORDS.removeprefix("the ") in words(place)


def test_local_scale_is_what_the_words_say():
    assert [_core.scale_neighbors(k) for k in (1, 2, 3, 4)] == [10, 6, 8, 10]
    assert "(2K+2)-th" in _core.SCALE_WORDS
    assert "on curves to the tenth" in _core.SCALE_WORDS


def test_hole_radius():
    text = words(ROOT / "docs" / "choosing_parameters.md")
    random, even = _core.RANDOM_HOLE_RADIUS, _core.EVEN_HOLE_RADIUS
    share = _core.hole_radius_share(1)
    assert (
        f"between {random:g}, for samples at random, and {even:g}, for even ones, on "
        f"curves at {share:g} times that"
    ) in text
    doc = words(rm.reconstruct.__doc__)
    assert (
        f"from {random:g} for samples that lie at random to {even:g} for even ones, on "
        f"curves {share:g} times that"
    ) in doc


def test_outlier_distance():
    for doc in (rm.reconstruct.__doc__, rm.find_outliers.__doc__):
        assert f"is {_core.OUTLIER_DISTANCE:g}" in words(doc)


def test_formulas_are_the_functions():
    for dim in range(1, 8):
        assert 3 * dim * (dim + 3) / 2 == _core.jet_neighbors(dim)
        assert 10 * dim == _core.paper_neighbors(dim)
    assert _core.JET_NEIGHBORS == "3 K (K + 3) / 2"
    assert _core.PAPER_NEIGHBORS == "10 K"
