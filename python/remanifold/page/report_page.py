# SPDX-License-Identifier: GPL-3.0-or-later
"""A reconstruction on one page of HTML that needs no network."""

from __future__ import annotations

import itertools
import json
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.colors import are_colors
from remanifold._base.files import StrPath, check_target, complete_file
from remanifold._base.html import json_text, text
from remanifold._base.optional import load
from remanifold.complex.embedding import embed
from remanifold.drawing import draw_plotly
from remanifold.drawing.scene import scene_of
from remanifold.judging.judged import JudgedReconstruction
from remanifold.page import report_parts as parts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from remanifold.complex.embedding import Embedding
    from remanifold.drawing.scene import Style

SUFFIXES = (".html", ".htm")
MOST_SHOWN = 40_000  # simplices that a phone still turns
COLORS = (
    *("sampling_ratio", "curvature", "tangent_confidence", "quality", "component"),
    "doubtful",
)
MOST_ATTRIBUTES = 6  # that can be chosen as colors
# Nothing may be fetched, from wherever.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:"
)


def write_report(
    rec: JudgedReconstruction,
    path: StrPath,
    title: str | None = None,
    command: str | None = None,
) -> None:
    """Write a page that shows a reconstruction and says how far to trust it.

    `Reconstruction.answer` in its first line; the complex, which can be turned, with the
    samples in doubt; topology, repair, openings and their evidence, histograms, outliers
    and noise, parameters, versions, digests, timings, and the mesh to download. One file
    that loads nothing else: about 5 MB, nearly all of it the drawing library
    plotly.js, at most 4 MB more for the picture, twice that for solids, which is
    coarsened beyond 40,000 simplices (the page then says so), and the mesh to download,
    where that has at most 8 MB.

    Parameters
    ----------
    rec : Reconstruction
        What to show. Its `Reconstruction.quality` is computed if it is not yet.
    path : path-like
        File to write, ``.html`` or ``.htm``; replaced when the new one is complete.
    title : str, optional
        Heading, any text; by default what was reconstructed.
    command : str, optional
        The command or call that made it, shown as it is. By default that of the
        `provenance`, or the call that makes the same from the same samples.

    Raises
    ------
    ImportError
        Plotly is not installed: ``pip install remanifold[plot]``.
    TypeError
        No Reconstruction, or text that is none.
    ValueError
        Another suffix.
    OSError
        The file cannot be written. Nothing is left behind.

    Examples
    --------
    >>> import remanifold as rm
    >>> rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    >>> rm.write_report(rec, "torus.html", title="A torus")  # doctest: +SKIP
    """
    _check(rec, {"title": title, "command": command})
    target = check_page(path)
    page = _page(rec, title or _default_title(rec), command)
    with complete_file(target) as file:
        file.write(page.encode())


def _check(rec: object, texts: dict[str, Any]) -> None:
    if not isinstance(rec, JudgedReconstruction):
        msg = f"rec must be a Reconstruction, got {type(rec).__name__}"
        raise TypeError(msg)
    for name, value in texts.items():
        if not isinstance(value, str | None):
            msg = f"{name} must be a string, got {type(value).__name__}"
            raise TypeError(msg)


def check_page(path: StrPath) -> Path:
    """Check that a page can be written to a file, before any work is done for it."""
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        msg = f"{target}: a report is a page, use .html or .htm"
        raise ValueError(msg)
    return check_target(target)


def _default_title(rec: JudgedReconstruction) -> str:
    where = "" if rec.ambient_dim is None else f" in R^{rec.ambient_dim}"
    return f"A {rec.dim}-manifold from {rec.num_samples:,} samples{where}"


def _page(rec: JudgedReconstruction, title: str, command: str | None) -> str:
    library = load("plotly.offline", "plot").get_plotlyjs()
    version = load("plotly.offline", "plot").get_plotlyjs_version()
    size = (
        f"This file needs no network. Of its size {len(library.encode()) / 1e6:.1f} MB "
        f"are plotly.js {text(version)} (MIT licence), which draws the picture."
    )
    links = " · ".join(
        f'<a href="#{name}">{text(words)}</a>' for name, words in parts.contents()
    )
    return "\n".join(
        [
            "<!DOCTYPE html>",
            '<html lang="en">',
            "<head>",
            '<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{text(POLICY)}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            '<link rel="icon" href="data:,">',
            f"<title>{text(title)}</title>",
            f"<style>\n{_resource('report_page.css')}</style>",
            "</head>",
            "<body>",
            f"<header><h1>{text(title)}</h1>",
            parts.verdict(rec),
            f'<p class="faint">{text(_default_title(rec))}, by remanifold.</p>'
            if title != _default_title(rec)
            else "",
            f'<nav aria-label="Sections" class="faint">{links}</nav></header>',
            "<main>",
            _picture(rec),
            '<div class="columns"><div>',
            parts.topology(rec),
            "</div><div>",
            parts.repair(rec),
            "</div></div>",
            parts.openings(rec),
            parts.histograms(rec),
            parts.doubt(rec),
            parts.how(rec, command),
            "</main>",
            f"<footer>{size}</footer>",
            f"<script>{library}</script>",
            f"<script>\n{_resource('report_page.js')}</script>",
            "</body>",
            "</html>",
            "",
        ]
    )


def _resource(name: str) -> str:
    return resources.files("remanifold.page").joinpath(name).read_text(encoding="utf-8")


def _picture(rec: JudgedReconstruction) -> str:
    """The complex as it can be turned, the ways to color it, and what is not shown."""
    placed = embed(rec)
    # Tetrahedra hide each other: one way shows how they lie, the other where they end.
    styles: dict[Style, str] = {"auto": "all"}
    if rec.dim == 3:
        styles = {"cut": "cut open", "auto": "tetrahedra apart"}
    views = [_view(rec, placed, style, name) for style, name in styles.items()]
    layout, caption = views[0].pop("layout"), views[0]["caption"]
    for view in views[1:]:
        del view["layout"]
    chooser = _chooser("color", "Color", [look["name"] for look in views[0]["looks"]])
    if len(views) > 1:
        chooser += _chooser("view", "View", [view["name"] for view in views])
    content = json.dumps({"views": views, "layout": layout})
    what = f"Interactive picture of the complex. {caption}"
    return (
        '<section aria-labelledby="picture-of-it">\n'
        '<h2 id="picture-of-it">The complex</h2>\n'
        f'<div class="controls">{chooser}</div>\n'
        '<figure class="picture">\n'
        f'<div id="picture" role="img" aria-label="{text(what)}"></div>\n'
        f'<figcaption id="caption">{text(caption)}</figcaption>\n'
        "<noscript><p>The picture needs JavaScript.</p></noscript>\n"
        "</figure>\n"
        f"{parts.mesh(rec)}\n"
        f'<script type="application/json" id="figure">{json_text(content)}</script>\n'
        "</section>"
    )


def _chooser(name: str, label: str, words: list[str]) -> str:
    options = "".join(f"<option>{text(word)}</option>" for word in words)
    return (
        f'<span class="chooser"><label for="{name}">{label}</label>\n'
        f'<select id="{name}">{options}</select></span>\n'
    )


def _view(
    rec: JudgedReconstruction, placed: Embedding, style: Style, name: str
) -> dict[str, Any]:
    """What is drawn, in its colors, and what to say of it."""
    figure, said = _figure(rec, placed, None, style)
    looks: list[dict[str, Any]] = [{"name": "plain", "traces": {}}]
    for color in COLORS:
        if (color == "quality" and rec.dim < 2) or len(rec.simplices) == 0:
            continue
        if color == "component" and rec.topology().components < 2:
            continue
        if color == "doubtful" and rec.quality.ok:
            continue
        changes = _changes(rec, placed, color, style, figure)
        looks.append({"name": _words(color), "traces": changes})
    for attribute, values in _attributes(rec):
        changes = _changes(rec, placed, values, style, figure)
        looks.append({"name": attribute, "traces": changes})
    caption = ". ".join([*said, "Drag to turn, scroll or pinch to come closer."])
    return {"name": name, "caption": caption, "looks": looks, **figure}


def _attributes(
    rec: JudgedReconstruction,
) -> Iterator[tuple[str, NDArray[Any]]]:
    """What is known of the vertices, one number each or a color."""
    shown = (
        (name, array)
        for name, array in rec.vertex_attributes.items()
        if array.ndim == 1 or are_colors(array)
    )
    for name, array in itertools.islice(shown, MOST_ATTRIBUTES):
        yield name, array if array.ndim == 2 else array.astype(np.float64)


def _words(color: str) -> str:
    return {"quality": "shape quality", "doubtful": "in doubt"}.get(
        color, color.replace("_", " ")
    )


def _figure(
    rec: JudgedReconstruction,
    placed: Embedding,
    color: str | NDArray[Any] | None,
    style: Style,
) -> tuple[dict[str, Any], list[str]]:
    """What plotly.js draws, and how it was embedded and coarsened."""
    scene = scene_of(
        rec,
        color=color,
        style=style,
        placed=placed,
        show_samples=False,
        show_doubtful=True,
        limit=MOST_SHOWN,
    )
    caption, scene.caption = scene.caption, []
    drawn: dict[str, Any] = json.loads(draw_plotly.figure(scene, "", None).to_json())
    return {"data": drawn["data"], "layout": drawn["layout"]}, caption


def _changes(
    rec: JudgedReconstruction,
    placed: Embedding,
    color: str | NDArray[Any],
    style: Style,
    plain: dict[str, Any],
) -> dict[str, dict[str, Any]]:
    """What a coloring has other than the plain picture, by trace."""
    colored, _ = _figure(rec, placed, color, style)
    changes = {}
    for i, (new, old) in enumerate(zip(colored["data"], plain["data"], strict=True)):
        different = {key: new[key] for key in new if new[key] != old.get(key)}
        if different:
            changes[str(i)] = different
    return changes
