# SPDX-License-Identifier: GPL-3.0-or-later
"""What notebooks and terminals show of results."""

from __future__ import annotations

from html.parser import HTMLParser

import numpy as np
import pytest

import remanifold as rm
from remanifold.drawing import draw_svg

VOID = {"rect", "line", "polygon", "circle", "br"}


class Fragment(HTMLParser):
    """Tags nest, and text is by the way of elements to it."""

    def __init__(self, content):
        super().__init__()
        self.open, self.texts, self.tags = [], [], []
        self.feed(content)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if data.strip() and "style" not in self.open:
            self.texts.append(data.strip())


def results():
    torus = rm.datasets.torus(400, random_state=0)
    rec = rm.reconstruct(torus, 2)
    tangents = rm.tangent_spaces(torus, 2)
    regions = rm.local_regions(torus, tangents.bases)
    flat = rm.datasets.flat_torus(200, random_state=0)
    arc = rm.reconstruct(rm.datasets.spiral(150, random_state=0), 1)
    return {
        "result": rec,
        "curve": arc,
        "ends": arc.boundary_complex(),
        "solid": rm.reconstruct(rm.datasets.ball(300, random_state=0), 3),
        "rotations": rm.reconstruct(rm.datasets.rotations(400, random_state=0), 3),
        "gram": rm.reconstruct(gram=flat @ flat.T, dim=2),
        "complex": rm.SimplicialComplex(rec.vertices, rec.simplices),
        "topology": rec.topology(),
        "quality": rec.quality,
        "repair": rec.repair,
        "parameters": rec.parameters,
        "neighborhoods": rm.neighborhoods(torus, 5),
        "tangents": tangents,
        "regions": regions,
        "stars": regions.stars,
        "edge sets": regions.edge_sets,
    }


@pytest.fixture(scope="module")
def shown():
    return results()


KINDS = (
    *("result", "curve", "ends", "solid", "rotations", "gram", "complex", "topology"),
    *("quality", "repair", "parameters", "neighborhoods", "tangents", "regions"),
    *("stars", "edge sets"),
)
PICTURES = {*KINDS} - {"parameters"}


@pytest.mark.parametrize("kind", KINDS)
def test_fragments_are_whole_and_small(kind, shown):
    content = shown[kind]._repr_html_()
    fragment = Fragment(content)
    assert len(content) < 100_000
    names = [tag for tag, _ in fragment.tags]
    assert ("svg" in names) == (kind in PICTURES)
    assert "script" not in names
    for tag, attributes in fragment.tags:
        assert "src" not in attributes
        assert "href" not in attributes
        if tag == "svg":
            assert attributes["aria-label"]
    assert fragment.texts[0][0].isupper() or fragment.texts[0][0].isdigit()


@pytest.mark.parametrize("kind", KINDS)
def test_plain_reprs_are_short(kind, shown):
    assert len(repr(shown[kind]).splitlines()) <= 10
    assert len(repr(shown[kind])) < 1000


def test_the_answer_is_first(shown):
    rec = shown["result"]
    assert Fragment(rec._repr_html_()).texts[0].lower() == rec.answer.lower()
    first = Fragment(shown["complex"]._repr_html_()).texts[0]
    assert first == "A closed surface of genus 1 (a torus)"
    assert Fragment(shown["quality"]._repr_html_()).texts[0] == "No reason for doubt"


def test_large_results_are_not_judged_to_be_shown(monkeypatch):
    rec = rm.reconstruct(rm.datasets.torus(300, random_state=0), 2)
    monkeypatch.setattr("remanifold.judging.judged._JUDGED_AT_ONCE", 10)
    texts = Fragment(rec._repr_html_()).texts
    assert texts[0].endswith("(a torus), not judged yet")
    assert "rec.quality judges it" in texts[-1]
    assert "quality" not in vars(rec)
    rec.quality  # noqa: B018
    assert Fragment(rec._repr_html_()).texts[0].endswith("can be told")


def test_pictures_show_the_shape():
    """Triangles of a square in the plane, where they are."""
    square = rm.SimplicialComplex(
        [[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]]
    )
    tags = Fragment(draw_svg.picture(square)).tags
    shapes = [t["points"].split() for name, t in tags if name == "polygon"]
    corners = {tuple(map(float, p.split(","))) for shape in shapes for p in shape}
    x, y = (sorted({c[i] for c in corners}) for i in (0, 1))
    assert len(shapes) == 2
    assert len(x) == len(y) == 2
    assert x[1] - x[0] == pytest.approx(2 * (y[1] - y[0]), abs=0.1)


def test_nearer_triangles_are_drawn_later():
    towards = np.array([1.0, 1.0, 1.0])
    flat = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [-1.0, 0.0, 1.0]])
    sizes = [1.0, 0.5]
    points = np.concatenate([s * flat + s * 5 * towards for s in sizes])
    two = rm.SimplicialComplex(points, [[0, 1, 2], [3, 4, 5]])
    tags = Fragment(draw_svg.picture(two)).tags

    def width(tag):
        return np.ptp([float(p.split(",")[0]) for p in tag["points"].split()])

    # The larger one is nearer.
    widths = [width(tag) for name, tag in tags if name == "polygon"]
    assert widths[0] < widths[1]


def test_what_takes_long_is_not_drawn(monkeypatch, shown):
    monkeypatch.setattr(draw_svg, "MOST_PRODUCTS", 10)
    monkeypatch.setattr(draw_svg, "MOST_NUMBERS", 10)
    assert "<svg" not in shown["gram"]._repr_html_()
    assert "<svg" not in shown["rotations"]._repr_html_()
    assert "<svg" in shown["result"]._repr_html_()


def test_nothing_to_draw():
    none = rm.SimplicialComplex([[0.0, 0.0], [1.0, 1.0]], np.empty((0, 3), dtype=int))
    assert Fragment(none._repr_html_()).texts[0] == "Nothing: no triangles"
