# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as figures of Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.optional import load
from remanifold.drawing.scene import (
    MESH_COLOR,
    UNKNOWN_COLOR,
    WIRE_COLOR,
    Lines,
    Scale,
    Scene,
    Surface,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

LIGHT = np.array([0.45, -0.35, 0.82])
DOTS_PER_INCH = 100


def figure(
    scene: Scene, title: str, size: tuple[int, int] | None, *, interactive: bool
) -> Any:
    """Make a matplotlib.figure.Figure, in the plane where the scene is flat."""
    inches = [pixels / DOTS_PER_INCH for pixels in size or (800, 680)]
    options: dict[str, Any] = {"figsize": inches, "dpi": DOTS_PER_INCH}
    if interactive:
        drawn = load("matplotlib.pyplot", "plot").figure(**options)
    else:
        drawn = load("matplotlib.figure", "plot").Figure(**options)
    axes: Any = drawn.add_subplot(projection=None if scene.flat else "3d")
    colored = None
    for surface in scene.surfaces:
        colored = _surface(axes, surface, scene) or colored
    for lines in scene.lines:
        colored = _lines(axes, lines, scene) or colored
    for marks in scene.marks:
        axes.scatter(
            *_columns(marks.points, scene.flat),
            color=marks.color,
            s=marks.size**2,
            marker={"circle": "o", "x": "x"}[marks.symbol],
            label=marks.name,
            zorder=3,
        )
    _frame(axes, scene)
    if scene.scale is not None and colored is not None:
        _bar(drawn, axes, colored, scene.scale)
    if scene.marks:
        axes.legend(loc="lower left", frameon=False)
    heading = "\n".join(line for line in [title, *scene.caption] if line)
    if heading:
        # A dollar sign would begin a formula.
        axes.set_title(heading.replace("$", r"\$"), fontsize=10, loc="left")
    return drawn


def _columns(points: NDArray[np.float64], flat: bool) -> NDArray[np.float64]:
    return np.asarray(points.T[:2] if flat else points.T)


def _mapped(
    values: NDArray[np.float64], scale: Scale
) -> tuple[NDArray[np.float64], Any]:
    """Colors, and what a color bar is made from."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    if scale.categories:
        table: Any = ListedColormap(scale.colors)
        values = values + 0.5
    else:
        table = colormaps["viridis"]
    table = table.with_extremes(bad=UNKNOWN_COLOR)
    mappable = ScalarMappable(Normalize(scale.low, scale.high), table)
    masked = np.ma.masked_invalid(np.clip(values, scale.low, scale.high))
    return np.asarray(mappable.to_rgba(masked)), mappable


def _surface(axes: Any, surface: Surface, scene: Scene) -> Any:
    corners = surface.points[surface.triangles]
    colors = np.tile(
        load("matplotlib.colors", "plot").to_rgba(MESH_COLOR), (len(corners), 1)
    )
    mappable = None
    if surface.values is not None and scene.scale is None:
        colors[:, :3] = surface.values[surface.triangles].mean(axis=1)
    elif surface.values is not None and scene.scale is not None:
        of_points, mappable = _mapped(surface.values, scene.scale)
        colors = of_points[surface.triangles].mean(axis=1)
    if not scene.flat:
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(normals, axis=1)
        slope = np.abs(normals @ LIGHT) / np.where(size > 0, size, 1)
        colors[:, :3] *= (0.6 + 0.4 * slope)[:, None]
    colors[:, 3] = surface.opacity
    kind = _collection("Poly", scene.flat)
    axes.add_collection(
        kind(
            corners[:, :, :2] if scene.flat else corners,
            facecolors=colors,
            edgecolors=WIRE_COLOR if surface.wire else colors,
            linewidths=0.2,
        )
    )
    return mappable


def _lines(axes: Any, lines: Lines, scene: Scene) -> Any:
    ends = lines.points[lines.edges]
    colors: Any = lines.color
    mappable = None
    if lines.values is not None and scene.scale is None:
        colors = lines.values[lines.edges].mean(axis=1)
    elif lines.values is not None and scene.scale is not None:
        middle = lines.values[lines.edges]
        if scene.scale.categories:
            middle = middle[:, :1]
        colors, mappable = _mapped(middle.mean(axis=1), scene.scale)
    kind = _collection("Line", scene.flat)
    axes.add_collection(
        kind(
            ends[:, :, :2] if scene.flat else ends,
            colors=colors,
            linewidths=lines.width / 2,
            alpha=None if lines.opacity == 1 else lines.opacity,
        )
    )
    return mappable


def _collection(kind: str, flat: bool) -> Any:
    if flat:
        return getattr(load("matplotlib.collections", "plot"), f"{kind}Collection")
    in_space = load("mpl_toolkits.mplot3d.art3d", "plot")
    return getattr(in_space, f"{kind}3DCollection")


def _frame(axes: Any, scene: Scene) -> None:
    """Equal units, no ticks, no frame."""
    points = scene.points
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_axis_off()
    if scene.flat:
        margin = 0.03 * float((high - low).max())
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)
        axes.set_aspect("equal")
        return
    middle, half = (low + high) / 2, float((high - low).max()) / 2 or 1.0
    for set_limits, center in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True
    ):
        set_limits(center - half, center + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.3)
    axes.view_init(elev=28, azim=42)


def _bar(drawn: Any, axes: Any, mappable: Any, scale: Scale) -> None:
    bar = drawn.colorbar(mappable, ax=axes, shrink=0.6, label=scale.label)
    if scale.categories:
        bar.set_ticks(
            [i + 0.5 for i in range(len(scale.categories))], labels=scale.categories
        )
