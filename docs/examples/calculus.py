# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of docs/calculus.md: functions on a torus of 3,000 random samples.

python docs/examples/calculus.py FOLDER
"""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import hsv_to_rgb
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import remanifold as rm
from drawing import save

LIGHT = np.array([0.3, -0.5, 0.81])


def shaded(rec, colors):
    """Colors of the triangles, darker where they turn away from the light."""
    corners = rec.vertices[rec.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lit = 0.55 + 0.45 * np.clip(normals @ LIGHT, 0, 1)
    return np.clip(colors * lit[:, None], 0, 1)


def draw(axes, rec, colors, title):
    axes.add_collection3d(
        Poly3DCollection(
            rec.vertices[rec.simplices],
            facecolors=shaded(rec, colors),
            edgecolors=shaded(rec, colors),
            linewidths=0.2,
        )
    )
    axes.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), zlim=(-1.1, 1.1))
    axes.set_box_aspect((1, 1, 1), zoom=1.2)
    axes.view_init(52, -60)
    axes.set_axis_off()
    axes.set_title(title, fontsize=9, y=0.98)


def scaled(values, name):
    """Values as colors, from the second to the last but one percent."""
    low, high = np.percentile(values, [2, 98])
    return mpl.colormaps[name](np.clip((values - low) / (high - low), 0, 1))[:, :3]


def main(folder):
    rec = rm.reconstruct(rm.datasets.torus(3000, random_state=0), 2)
    calculus = rec.calculus
    rows = rec.simplices
    figure = plt.figure(figsize=(8, 4.6))
    axes = [figure.add_subplot(2, 3, i, projection="3d") for i in range(1, 7)]

    function = calculus.spectrum(12).functions[:, 11]
    draw(axes[0], rec, scaled(function[rows].mean(1), "RdBu"), "an eigenfunction")

    angles = calculus.circular_coordinates().angles
    for place, column in ((1, 0), (2, 1)):
        around = np.exp(1j * angles[rows, column]).sum(axis=1)
        hue = np.angle(around) / (2 * np.pi) % 1
        colors = hsv_to_rgb(np.stack([hue, 0.75 + 0 * hue, 0.95 + 0 * hue], axis=1))
        draw(axes[place], rec, colors, ("the angle along", "the angle across")[column])

    random = np.random.default_rng(0)
    true = np.sin(3 * np.arctan2(rec.vertices[:, 1], rec.vertices[:, 0]))
    found = calculus.fit(true + random.normal(size=3000))
    draw(axes[3], rec, scaled(found.values[rows].mean(1), "viridis"), "noise taken off")

    sites = calculus.farthest_points(16)
    cells = calculus.voronoi_cells(sites)
    palette = mpl.colormaps["tab20"](np.arange(16))[:, :3]
    draw(axes[4], rec, palette[cells.labels[rows]].mean(axis=1), "cells of 16 sites")

    gauss = calculus.curvature().scalar / 2
    draw(axes[5], rec, scaled(gauss[rows].mean(1), "coolwarm"), "Gaussian curvature")
    figure.subplots_adjust(0, 0, 1, 0.98, 0, 0)
    save(figure, folder / "calculus.png", colors=256)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/figures"))
