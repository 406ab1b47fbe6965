# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as figures of Plotly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.optional import load
from remanifold.drawing.scene import (
    MESH_COLOR,
    SCALE_COLORS,
    UNKNOWN_COLOR,
    WIRE_COLOR,
    Lines,
    Marks,
    Scale,
    Scene,
    Surface,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

SYMBOLS = {"circle": "circle", "x": "x"}
WITH_WIRE = 8_000  # triangles: each edge takes 80 bytes of a page
LIFT = 0.0025  # of the extent
# A share of the range below it that stands for what is unknown.
BELOW = 0.02


def figure(scene: Scene, title: str, size: tuple[int, int] | None) -> Any:
    """Make a plotly.graph_objects.Figure that can be turned."""
    go = load("plotly.graph_objects", "plot")

    # The drawing works in single precision: far from the origin shapes would tremble.
    points = scene.points
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    traces = []
    for surface in scene.surfaces:
        traces += _surface(go, surface, middle, scene.scale)
    traces += [_lines(go, lines, middle, scene.scale) for lines in scene.lines]
    traces += [_marks(go, marks, middle) for marks in scene.marks]
    heading = "<br>".join(_plain(line) for line in [title, *scene.caption] if line)
    up = {"x": 0, "y": 1, "z": 0} if scene.flat else {"x": 0, "y": 0, "z": 1}
    eye = (0, 0, 1.7) if scene.flat else (1.25, 1.1, 0.8)
    hidden = {"visible": False, "showspikes": False}
    figure = go.Figure(traces)
    figure.update_layout(
        template="none",
        title={"text": heading, "font": {"size": 14}} if heading else None,
        margin={"l": 0, "r": 0, "b": 0, "t": 24 + 20 * heading.count("<br>")}
        if heading
        else {"l": 0, "r": 0, "b": 0, "t": 0},
        showlegend=sum(trace.showlegend is not False for trace in traces) > 1,
        legend={"orientation": "h", "x": 0, "y": 0, "itemsizing": "constant"},
        scene={
            "xaxis": hidden,
            "yaxis": hidden,
            "zaxis": hidden,
            "aspectmode": "data",
            "camera": {
                "eye": dict(zip("xyz", eye, strict=True)),
                "up": up,
            },
            "dragmode": "orbit",
        },
    )
    if size is not None:
        figure.update_layout(width=size[0], height=size[1])
    return figure


def _plain(text: str) -> str:
    """Plotly reads a few tags; text of the user is text."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _single(points: NDArray[np.float64]) -> dict[str, NDArray[np.float32]]:
    columns = points.astype(np.float32)
    return {axis: columns[:, i].copy() for i, axis in enumerate("xyz")}


def _coloring(
    values: NDArray[np.float64], scale: Scale
) -> tuple[NDArray[np.float32], list[list[Any]], tuple[float, float]]:
    """Values, color scale and range; what is unknown comes below the range."""
    low, high = scale.low, scale.high
    if scale.categories:
        colors = scale.colors
        stops = [
            [(i + side) / len(colors), color]
            for i, color in enumerate(colors)
            for side in (0, 1)
        ]
        return (values + 0.5).astype(np.float32), stops, (low, high)
    shares = np.linspace(0, 1, len(SCALE_COLORS))
    shown = np.clip(values, low, high)
    if np.isnan(values).any():
        start = BELOW / (1 + BELOW)
        stops = [[0.0, UNKNOWN_COLOR], [start, UNKNOWN_COLOR]]
        stops += [
            [start + (1 - start) * s, color]
            for s, color in zip(shares.tolist(), SCALE_COLORS, strict=True)
        ]
        low -= BELOW * (high - low)
        shown = np.where(np.isnan(values), low, shown)
    else:
        stops = [[s, c] for s, c in zip(shares.tolist(), SCALE_COLORS, strict=True)]
    return shown.astype(np.float32), stops, (low, high)


def _bar(scale: Scale) -> dict[str, Any]:
    bar: dict[str, Any] = {
        "title": {"text": _plain(scale.label)},
        "thickness": 12,
        "len": 0.6,
    }
    if scale.categories:
        bar |= {
            "tickvals": [i + 0.5 for i in range(len(scale.categories))],
            "ticktext": list(scale.categories),
        }
    return bar


def _surface(
    go: Any, surface: Surface, middle: NDArray[np.float64], scale: Scale | None
) -> list[Any]:
    points = surface.points - middle
    i, j, k = surface.triangles.astype(np.int32).T
    look: dict[str, Any] = {"color": MESH_COLOR}
    if surface.values is not None and scale is None:
        look = {"vertexcolor": np.rint(surface.values * 255).astype(np.uint8)}
    elif surface.values is not None and scale is not None:
        intensity, stops, (low, high) = _coloring(surface.values, scale)
        look = {
            "intensity": intensity,
            "colorscale": stops,
            "cmin": low,
            "cmax": high,
            "colorbar": _bar(scale),
            "showscale": surface.opacity == 1,
        }
    mesh = go.Mesh3d(
        **_single(points),
        i=i.copy(),
        j=j.copy(),
        k=k.copy(),
        name=surface.name,
        opacity=surface.opacity,
        flatshading=surface.wire,
        hoverinfo="skip",
        showlegend=True,
        lighting={
            "ambient": 0.5,
            "diffuse": 0.55,
            "specular": 0.05,
            "roughness": 0.6,
            "facenormalsepsilon": 0,
            "vertexnormalsepsilon": 0,
        },
        lightposition={"x": 4000, "y": 2000, "z": 8000},
        **look,
    )
    if not surface.wire or len(surface.triangles) > WITH_WIRE:
        return [mesh]
    wire = go.Scatter3d(
        **_single(_wire(points, surface.triangles)),
        mode="lines",
        line={"color": WIRE_COLOR, "width": 1},
        opacity=0.5 if surface.opacity == 1 else 0.25,
        hoverinfo="skip",
        name=f"edges of the {surface.name}",
        showlegend=False,
    )
    return [mesh, wire]


def _wire(
    points: NDArray[np.float64], triangles: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Edges a little off both sides of the triangles, which would hide them."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    at_points = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(at_points, corner, normals)
    size = np.linalg.norm(at_points, axis=1, keepdims=True)
    off = at_points / np.where(size > 0, size, 1)
    off *= LIFT * float(np.ptp(points, axis=0).max())
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(sides, axis=0)
    return np.concatenate([_with_gaps(points + side * off, edges) for side in (1, -1)])


def _with_gaps(
    points: NDArray[np.float64], edges: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Both ends of each edge and nothing after it."""
    track = np.full((len(edges), 3, points.shape[1]), np.nan)
    track[:, :2] = points[edges]
    return track.reshape(-1, points.shape[1])


def _lines(
    go: Any, lines: Lines, middle: NDArray[np.float64], scale: Scale | None
) -> Any:
    look: dict[str, Any] = {"color": lines.color, "width": lines.width}
    if lines.values is not None and scale is None:
        ends = np.zeros((len(lines.edges), 3, 3), dtype=np.int64)
        ends[:, :2] = np.rint(lines.values[lines.edges] * 255)
        look = {
            "color": [f"rgb({r},{g},{b})" for r, g, b in ends.reshape(-1, 3).tolist()],
            "width": max(lines.width, 3),
        }
    elif lines.values is not None and scale is not None:
        values, stops, (low, high) = _coloring(lines.values, scale)
        ends = np.zeros((len(lines.edges), 3), dtype=np.float32)
        ends[:, :2] = values[lines.edges]
        ends[:, 2] = ends[:, 1]
        look = {
            "color": ends.ravel(),
            "width": max(lines.width, 3),
            "colorscale": stops,
            "cmin": low,
            "cmax": high,
            "colorbar": _bar(scale),
            "showscale": True,
        }
    return go.Scatter3d(
        **_single(_with_gaps(lines.points - middle, lines.edges)),
        mode="lines",
        line=look,
        opacity=lines.opacity,
        hoverinfo="skip",
        name=lines.name,
    )


def _marks(go: Any, marks: Marks, middle: NDArray[np.float64]) -> Any:
    return go.Scatter3d(
        **_single(marks.points - middle),
        mode="markers",
        marker={
            "color": marks.color,
            "size": marks.size,
            "symbol": SYMBOLS[marks.symbol],
        },
        customdata=marks.numbers.astype(np.int32),
        hovertemplate="%{customdata}",
        name=marks.name,
    )
