# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of docs/remeshing.md and docs/charts.md, of tori of random samples.

python docs/examples/remeshing.py FOLDER
"""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import remanifold as rm
from drawing import draw_simplices, save

VIEW = (-60, 45)


def remeshing(folder, rec):
    """What there was, and the same with fewer, more and more even triangles."""
    shown = (
        (rec, "2,000 samples"),
        (rec.simplify(200), "simplify(200)"),
        (rec.simplify(max_error=0.05), "simplify(max_error=0.05)"),
        (rec.resample(1000), "resample(1000)"),
    )
    figure, axes = plt.subplots(1, 4, figsize=(9, 2.4))
    for place, (complex_, title) in zip(axes, shown, strict=True):
        draw_simplices(place, complex_.vertices, complex_.simplices, VIEW)
        place.set_title(f"{title}\n{len(complex_.simplices):,} triangles", fontsize=8)
    figure.subplots_adjust(0, 0, 1, 0.84, 0.02, 0)
    save(figure, folder / "remeshing.png", colors=128)


def charts(folder, rec):
    """Charts on the torus and in the plane, in the same colors."""
    atlas = rec.calculus.charts()
    flat = atlas.texture()
    palette = mpl.colormaps["Set2"](np.arange(8))[:, :3]
    stripes = (rec.vertices[rec.simplices].mean(axis=1)[:, 2] * 10 % 1 < 0.5) * 0.12
    colors = palette[atlas.labels % 8] - stripes[:, None]
    figure, axes = plt.subplots(1, 2, figsize=(7, 3.2))
    draw_simplices(axes[0], rec.vertices, rec.simplices, VIEW, colors=colors)
    axes[0].set_title(f"{len(atlas)} charts of a torus", fontsize=9)
    place = flat.vertex_attributes["uv"]
    corners = flat.vertex_attributes["vertex"][flat.simplices]
    order = {tuple(sorted(row)): i for i, row in enumerate(rec.simplices.tolist())}
    rows = [order[tuple(sorted(row))] for row in corners.tolist()]
    axes[1].add_collection(
        PolyCollection(
            place[flat.simplices],
            facecolors=np.clip(colors[rows], 0, 1),
            edgecolors="#555555",
            linewidths=0.15,
        )
    )
    axes[1].set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    axes[1].set_axis_off()
    axes[1].set_title("texture()", fontsize=9)
    figure.subplots_adjust(0, 0, 1, 0.92, 0.02, 0)
    save(figure, folder / "charts.png", colors=128)


def main(folder):
    rec = rm.reconstruct(rm.datasets.torus(2000, random_state=0), 2)
    remeshing(folder, rec)
    charts(folder, rec)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/figures"))
