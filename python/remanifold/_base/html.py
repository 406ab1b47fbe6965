# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of a page: escaped text, tables, histograms."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Not allowed in HTML, or not visible: shown as what they are not.
_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff￾￿]")
BINS = 30


def text(value: object) -> str:
    """Escape anything for the text or an attribute of a page."""
    return html.escape(_CONTROL.sub("�", str(value)), quote=True)


def json_text(value: str) -> str:
    """JSON that can stand inside a script element: no tag begins or ends there."""
    for character in "<>&\u2028\u2029":
        value = value.replace(character, f"\\u{ord(character):04x}")
    return value


def json_of(value: Any) -> str:
    """Encode for a script element."""
    return json_text(json.dumps(value))


def section(name: str, heading: str, *parts: str) -> str:
    """Make a section under a heading, nothing if it would be empty."""
    body = "\n".join(part for part in parts if part)
    if not body:
        return ""
    return (
        f'<section aria-labelledby="{name}">\n<h2 id="{name}">{text(heading)}</h2>\n'
        f"{body}\n</section>"
    )


def paragraph(words: str, kind: str = "") -> str:
    """Make a paragraph of plain text."""
    return f'<p class="{kind}">{text(words)}</p>' if kind else f"<p>{text(words)}</p>"


def bullets(lines: Iterable[str]) -> str:
    """Make a list of plain text."""
    items = "\n".join(f"<li>{text(line)}</li>" for line in lines)
    return f"<ul>\n{items}\n</ul>" if items else ""


def rows_table(label: str, rows: Iterable[tuple[str, object]]) -> str:
    """Make a table of names and values, which wrap."""
    body = "\n".join(
        f'<tr><th scope="row">{text(name)}</th><td>{text(value)}</td></tr>'
        for name, value in rows
    )
    return f'<table class="rows" aria-label="{text(label)}">\n{body}\n</table>'


def grid_table(
    label: str, head: Sequence[str], rows: Iterable[Sequence[object]]
) -> str:
    """Make a table with columns, which scrolls by itself where it is too wide."""
    top = "".join(f'<th scope="col">{text(name)}</th>' for name in head)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll" role="region" tabindex="0" aria-label="{text(label)}">\n'
        f"<table><thead><tr>{top}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def number(value: float) -> str:
    """Three digits, or a word for what is no number."""
    return f"{value:.3g}" if np.isfinite(value) else "unknown"


def histogram(title: str, values: NDArray[np.float64], unit: str = "") -> str:
    """Draw a histogram with the median and what lies between the percentiles 5 and 95."""
    finite = values[np.isfinite(values)]
    missing = len(values) - len(finite)
    if len(finite) == 0:
        return ""
    low, high = float(finite.min()), float(finite.max())
    most = float(np.percentile(finite, 99.5))
    # A long tail would press the rest into one bar.
    beyond = 0
    if high > low + 1.5 * (most - low) and most > low:
        beyond = int(np.count_nonzero(finite > most))
        high = most
    span = high - low
    if span <= 1e-12 * max(abs(low), abs(high)):
        low, high = low - 0.5, high + 0.5
    counts, _ = np.histogram(finite, bins=BINS, range=(low, high))
    five, median, ninety_five = np.percentile(finite, (5, 50, 95))
    suffix = f" {unit}" if unit else ""
    said = (
        f"median {number(median)}{suffix}, 5 to 95 %: {number(five)} to "
        f"{number(ninety_five)}"
    )
    notes = [said]
    if beyond:
        notes.append(f"{beyond:,} beyond {number(high)} not drawn")
    if missing:
        notes.append(f"{missing:,} unknown or infinite")
    width, height, foot = 300.0, 110.0, 18.0
    step = width / BINS
    tallest = max(1, int(counts.max()))
    bars = "".join(
        f'<rect x="{i * step + 0.5:.1f}" y="{height * (1 - n / tallest):.1f}" '
        f'width="{step - 1:.1f}" height="{height * n / tallest:.1f}"/>'
        for i, n in enumerate(counts.tolist())
        if n
    )
    place = min(max((float(median) - low) / (high - low), 0.0), 1.0) * width
    return (
        f"<figure><figcaption><b>{text(title)}</b><br>{text('; '.join(notes))}"
        "</figcaption>\n"
        f'<svg viewBox="0 0 {width:g} {height + foot:g}" role="img" '
        f'aria-label="{text(f"Histogram of {title}: {said}")}">'
        f'<g class="bars">{bars}</g>'
        f'<line class="axis" x1="0" x2="{width:g}" y1="{height:g}" y2="{height:g}"/>'
        f'<line class="median" x1="{place:.1f}" x2="{place:.1f}" y1="0" '
        f'y2="{height:g}"/>'
        f'<text x="0" y="{height + 14:g}">{text(number(low))}</text>'
        f'<text x="{width:g}" y="{height + 14:g}" text-anchor="end">'
        f"{text(number(high))}</text></svg></figure>"
    )


# Of what stands in a notebook, whose page has a style of its own.
_STYLE = (
    ".remanifold{font-size:.95em;max-width:46em}"
    ".remanifold p{margin:.2em 0}"
    ".remanifold .answer{font-weight:600}"
    ".remanifold .parts{display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start}"
    ".remanifold svg{width:15em;max-width:100%;height:auto}"
    ".remanifold figure{margin:0}"
    ".remanifold table{border-collapse:collapse;margin:0}"
    ".remanifold th,.remanifold td{text-align:left;padding:.1em .6em;font-weight:400}"
    ".remanifold th{opacity:.7}"
    ".remanifold .bars{fill:#6f93b8}"
    ".remanifold .axis,.remanifold .median{stroke:currentColor}"
    ".remanifold .median{stroke-dasharray:4 3}"
    ".remanifold text{fill:currentColor;font-size:11px}"
)


def fragment(
    answer: str, rows: Iterable[tuple[str, object]], picture: str = "", note: str = ""
) -> str:
    """Make what a notebook shows of a result: the answer, a picture, figures."""
    first = answer[:1].upper() + answer[1:]
    table = rows_table("Figures", rows)
    return (
        f'<div class="remanifold"><style>{_STYLE}</style>\n'
        f'<p class="answer">{text(first)}</p>\n'
        f'<div class="parts">{picture}\n{table}</div>\n'
        f"{paragraph(note) if note else ''}</div>"
    )


def shares(title: str, parts: Iterable[tuple[str, int]]) -> str:
    """Draw numbers as bars of one length scale, each with its name."""
    known = [*parts]
    most = max([1, *(number for _, number in known)])
    width, height = 300.0, 24.0
    bars = "".join(
        f'<g class="bars"><rect x="0" y="{i * height + 13:g}" '
        f'width="{width * number / most:.1f}" height="8"/></g>'
        f'<text x="0" y="{i * height + 10:g}">{text(f"{name}: {number:,}")}</text>'
        for i, (name, number) in enumerate(known)
    )
    said = ", ".join(f"{name} {number:,}" for name, number in known)
    return (
        f'<figure><svg viewBox="0 0 {width:g} {max(1, len(known)) * height:g}" '
        f'role="img" aria-label="{text(f"{title}: {said}")}">{bars}</svg></figure>'
    )
