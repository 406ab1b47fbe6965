# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as small pictures in SVG, without any library: for notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.html import text
from remanifold.complex.embedding import embed
from remanifold.drawing.scene import MESH_COLOR, SAMPLE_COLOR, open_faces, scene_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData
    from remanifold.drawing.scene import Scene

MOST = 700  # simplices: some 40 kB
MOST_NUMBERS = 2_000_000  # coordinates up to which principal axes take no time
MOST_PRODUCTS = 1_000  # samples that are known by products, likewise
SIZE = 240.0
_MARGIN = 8.0
# From a corner above, as other pictures are seen.
_VIEW = np.array([[-0.7071, 0.7071, 0.0], [-0.4082, -0.4082, 0.8165]])
_TOWARDS = np.array([0.5774, 0.5774, 0.5774])
_SHADES = 12


def picture(complex: ComplexData) -> str:
    """Draw a complex; nothing where that would take longer than a moment."""
    if complex.vertices is None:
        if complex.num_vertices > MOST_PRODUCTS:
            return ""
    elif complex.vertices.shape[1] > 3 and complex.vertices.size > MOST_NUMBERS:
        return ""
    flat = complex.vertices is not None and complex.vertices.shape[1] <= 3
    placed = embed(complex, "auto" if flat else "pca")
    scene = scene_of(
        complex,
        color=None,
        style=_style(complex),
        placed=placed,
        show_samples=False,
        show_doubtful=False,
        limit=MOST,
    )
    note = [placed.label] if placed.label else []
    return _svg(scene, f"The {complex.dim}-dimensional complex", note)


def _style(complex: ComplexData) -> str:
    """Of a solid its boundary, where there is one."""
    if complex.dim == 3:
        return "surface" if len(open_faces(complex.simplices)) else "edges"
    return "auto"


def _svg(scene: Scene, what: str, note: list[str]) -> str:
    view = np.eye(3)[:2] if scene.flat else _VIEW
    towards = np.array([0.0, 0.0, 1.0]) if scene.flat else _TOWARDS
    points = scene.points
    known = np.isfinite(points).all(axis=1)
    if not known.any():
        return ""
    places = points[known] @ view.T
    low, high = places.min(axis=0), places.max(axis=0)
    scale = (SIZE - 2 * _MARGIN) / (float((high - low).max()) or 1.0)
    size = (high - low) * scale + 2 * _MARGIN

    def on_page(where: NDArray[np.float64]) -> NDArray[np.float64]:
        seen = (where @ view.T - low) * scale + _MARGIN
        seen[..., 1] = size[1] - seen[..., 1]
        return np.asarray(seen)

    parts: list[tuple[float, str]] = []
    for surface in scene.surfaces:
        corners = surface.points[surface.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(normals, axis=1)
        # Both sides are lit alike: not all surfaces have an outside.
        light = np.abs(normals @ towards) / np.where(lengths > 0, lengths, 1.0)
        depth = corners.mean(axis=1) @ towards
        drawn = on_page(corners)
        parts += [
            (far, _triangle(place, shade))
            for far, place, shade in zip(depth, drawn, light, strict=True)
        ]
    for lines in scene.lines:
        ends = lines.points[lines.edges]
        depth = ends.mean(axis=1) @ towards + 1e-6 * np.ptp(points[known])
        style = f'stroke="{lines.color}" stroke-width="{min(lines.width, 2):g}"'
        parts += [
            (far, _line(place, style))
            for far, place in zip(depth, on_page(ends), strict=True)
        ]
    for marks in scene.marks:
        depth = marks.points @ towards
        parts += [
            (
                far,
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.5" fill="{SAMPLE_COLOR}"/>',
            )
            for far, (x, y) in zip(depth, on_page(marks.points), strict=True)
        ]
    parts.sort(key=lambda part: part[0])
    body = "".join(drawn for _, drawn in parts)
    label = ". ".join([what, *note])
    return (
        f'<figure><svg viewBox="0 0 {size[0]:.0f} {size[1]:.0f}" role="img" '
        f'aria-label="{text(label)}" stroke-linejoin="round">{body}</svg></figure>'
    )


def _triangle(corners: NDArray[np.float64], light: float) -> str:
    shade = round(float(light) * _SHADES) / _SHADES
    rgb = [int(MESH_COLOR[i : i + 2], 16) for i in (1, 3, 5)]
    color = "".join(f"{round(c * (0.45 + 0.55 * shade)):02x}" for c in rgb)
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{places}" fill="#{color}" stroke="#{color}"/>'


def _line(ends: NDArray[np.float64], style: str) -> str:
    (x1, y1), (x2, y2) = ends
    places = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f"<line {places} {style}/>"
