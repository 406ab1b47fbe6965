# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures of samples and simplices, drawn with Matplotlib and no display.

Points of space are turned by an azimuth and an elevation, seen from far away, and
drawn from back to front; triangles are shaded by their slope to the light.
"""

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from PIL import Image

SAMPLE_COLOR = "#20466e"
MESH_COLOR = np.array([0.99, 0.83, 0.60])
ALARM_COLOR = np.array([0.85, 0.10, 0.15])
GAP_COLOR = "#1f5fd0"
LIGHT = np.array([-0.42, 0.56, 0.71])  # from the left, above and in front


def project(points, view):
    """Turn points so that the last coordinate is the depth, larger in front."""
    if points.shape[1] == 2:
        return np.column_stack([points, np.zeros(len(points))])
    azimuth, elevation = np.radians(view)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    toward = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    return points @ np.array([right, np.cross(toward, right), toward]).T


def draw_points(axes, points, view, size=4.0):
    """Draw samples, paler the farther they are."""
    x, y, depth = project(points, view).T
    order = np.argsort(depth, kind="stable")
    colors = np.tile(mpl.colors.to_rgba(SAMPLE_COLOR), (len(points), 1))
    colors[:, 3] = 0.25 + 0.75 * _between(depth)
    axes.scatter(x[order], y[order], s=size, c=colors[order], linewidths=0)
    _frame(axes)


def draw_simplices(
    axes, points, simplices, view, alarm=None, gaps=None, line_width=0.25, colors=None
):
    """Draw edges or triangles, those marked by ``alarm`` in red, ``gaps`` in blue.

    Triangles may have other ``colors``, a row of red, green and blue each.
    """
    projected = project(points, view)
    alarm = np.zeros(len(simplices), dtype=bool) if alarm is None else alarm
    if simplices.shape[1] == 2:
        _draw_edges(axes, projected[simplices], alarm)
    else:
        gaps = np.empty((0, 2), dtype=int) if gaps is None else gaps
        if colors is None:
            colors = np.where(alarm[:, None], ALARM_COLOR, MESH_COLOR)
        _draw_triangles(axes, projected[simplices], colors, projected[gaps], line_width)
    _frame(axes)


def _draw_edges(axes, corners, alarm):
    depth = corners[:, :, 2].mean(axis=1)
    order = np.argsort(depth, kind="stable")
    colors = np.tile(mpl.colors.to_rgba(SAMPLE_COLOR), (len(corners), 1))
    colors[:, :3][alarm] = ALARM_COLOR
    colors[:, 3] = 0.3 + 0.7 * _between(depth)
    axes.add_collection(
        LineCollection(corners[order, :, :2], colors=colors[order], linewidths=1.6)
    )


def _draw_triangles(axes, corners, colors, gaps, line_width):
    sides = corners[:, 1:] - corners[:, :1]
    normals = np.cross(sides[:, 0], sides[:, 1])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0, length, 1.0)
    normals *= np.where(normals[:, 2:] < 0, -1.0, 1.0)  # both sides are lit
    shade = 0.36 + 0.64 * np.clip(normals @ LIGHT, 0.0, 1.0)
    faces = colors * shade[:, None]
    edges = 0.55 * faces if line_width else faces
    widths = np.full(len(corners), line_width or 0.1)

    # A gap is a triangle without area: what lies in front of it hides it.
    depth = np.concatenate([corners[:, :, 2].mean(axis=1), gaps[:, :, 2].max(axis=1)])
    corners = np.concatenate([corners, gaps[:, [0, 1, 1]]])
    blue = np.tile(mpl.colors.to_rgb(GAP_COLOR), (len(gaps), 1))
    order = np.argsort(depth, kind="stable")
    axes.add_collection(
        PolyCollection(
            corners[order, :, :2],
            facecolors=np.concatenate([faces, blue])[order],
            edgecolors=np.concatenate([edges, blue])[order],
            linewidths=np.concatenate([widths, np.full(len(gaps), 1.4)])[order],
        )
    )


def save(figure, path, colors=96):
    """Save a picture as a small PNG."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    with Image.open(path) as image:
        image.convert("RGB").quantize(colors).save(path, optimize=True)


def _between(depth):
    spread = np.ptp(depth)
    return (depth - depth.min()) / spread if spread > 0 else np.ones_like(depth)


def _frame(axes):
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
