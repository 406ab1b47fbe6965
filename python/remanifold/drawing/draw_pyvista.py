# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes drawn by PyVista."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.optional import load
from remanifold.drawing.scene import (
    MESH_COLOR,
    UNKNOWN_COLOR,
    WIRE_COLOR,
    Scale,
    Scene,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


def plotter(
    scene: Scene, title: str, size: tuple[int, int] | None, *, off_screen: bool
) -> Any:
    """Make a pyvista.Plotter with everything in place."""
    pv = load("pyvista", "plot")

    plotter = pv.Plotter(off_screen=off_screen, window_size=list(size or (900, 720)))
    plotter.set_background("white")
    for surface in scene.surfaces:
        mesh = pv.PolyData(surface.points, _cells(surface.triangles))
        plotter.add_mesh(
            mesh,
            **_coloring(surface.values, scene.scale, MESH_COLOR),
            opacity=surface.opacity,
            show_edges=surface.wire,
            edge_color=WIRE_COLOR,
            line_width=0.5,
            smooth_shading=False,
        )
    for lines in scene.lines:
        mesh = pv.PolyData(lines.points, lines=_cells(lines.edges))
        look = _coloring(lines.values, scene.scale, lines.color)
        plotter.add_mesh(
            mesh, **look, line_width=lines.width, opacity=lines.opacity, lighting=False
        )
    for marks in scene.marks:
        plotter.add_points(
            marks.points,
            color=marks.color,
            point_size=1.5 * marks.size,
            render_points_as_spheres=True,
        )
    heading = "\n".join(line for line in [title, *scene.caption] if line)
    if heading:
        plotter.add_text(heading, position="upper_left", font_size=9, color="black")
    named = [(marks.name, marks.color) for marks in scene.marks]
    if named:
        plotter.add_legend(
            labels=[list(pair) for pair in named],
            bcolor=None,
            face="circle",
            size=(0.22, 0.05 * len(named)),
            loc="lower left",
        )
    _place_camera(plotter, scene)
    return plotter


def need_renderer() -> None:
    """Refuse what VTK would end the process for: no display, and nothing instead."""
    if has_display():
        return
    for library in ("libEGL.so.1", "libOSMesa.so.8", "libOSMesa.so"):
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        return
    msg = (
        "without a display PyVista draws by EGL or OSMesa, and neither is installed "
        '(Debian: libegl1 or libosmesa6); or use backend="matplotlib" or "plotly"'
    )
    raise OSError(msg)


def has_display() -> bool:
    """Whether a window could open, as far as the environment tells."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """VTK tries a display before it does without, and warns of each attempt."""
    logger = load("vtkmodules.vtkCommonCore", "plot").vtkLogger
    before = logger.GetCurrentVerbosityCutoff()
    logger.SetStderrVerbosity(logger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        logger.SetStderrVerbosity(before)


def _cells(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Each row after its length, as VTK wants it."""
    counted = np.empty((len(rows), rows.shape[1] + 1), dtype=np.intp)
    counted[:, 0] = rows.shape[1]
    counted[:, 1:] = rows
    return counted.ravel()


def _coloring(
    values: NDArray[np.float64] | None, scale: Scale | None, color: str
) -> dict[str, Any]:
    if values is None:
        return {"color": color}
    if scale is None:
        return {"scalars": np.rint(values * 255).astype(np.uint8), "rgb": True}
    bar: dict[str, Any] = {
        "title": scale.label or "value",
        "color": "black",
        "vertical": True,
        "position_x": 0.85,
        "position_y": 0.25,
        "height": 0.5,
        "width": 0.07,
        "title_font_size": 16,
        "label_font_size": 14,
        "fmt": "%.3g",
    }
    look: dict[str, Any] = {
        "scalars": values,
        "clim": [scale.low, scale.high],
        "cmap": "viridis",
        "nan_color": UNKNOWN_COLOR,
        "scalar_bar_args": bar,
    }
    if scale.categories:
        look["scalars"] = values + 0.5
        look["cmap"] = list(scale.colors)
        look["annotations"] = {i + 0.5: name for i, name in enumerate(scale.categories)}
        bar["n_labels"] = 0
    return look


def _place_camera(plotter: Any, scene: Scene) -> None:
    if scene.flat:
        plotter.view_xy()
        plotter.enable_parallel_projection()
        return
    plotter.view_vector((1.25, 1.1, 0.8), viewup=(0, 0, 1))
    plotter.camera.zoom(1.15)
