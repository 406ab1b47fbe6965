# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of the gallery, drawn from what the code on its pages computes.

    python docs/examples/gallery.py [FOLDER] [--pages NAME...]

Each page of docs/gallery is run as it stands, and its variables are drawn into
FOLDER/gallery_NAME.png, by default ``build/gallery``. The table of the coastlines is
printed.
"""

import argparse
import os
import re
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from drawing import ALARM_COLOR, MESH_COLOR, SAMPLE_COLOR, draw_simplices, project, save

PAGES = Path(__file__).resolve().parents[1] / "gallery"
GRAY = "#b8b8b8"


def run_page(name):
    """The variables that the code on a page leaves."""
    path = PAGES / f"{name}.md"
    blocks = re.findall(r"(?s)```python\n(.*?)```", path.read_text(encoding="utf-8"))
    variables = {}
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:  # some pages write files
        os.chdir(folder)
        try:
            exec(compile("\n".join(blocks), str(path), "exec"), variables)  # noqa: S102
        finally:
            os.chdir(here)
    return variables


def plain(axes, title=""):
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)


def lines(axes, segments, color, width=1.0, **options):
    axes.add_collection(
        LineCollection(segments, colors=[color], linewidths=width, **options)
    )
    axes.autoscale_view()


def closed(curve):
    return np.append(curve, curve[:1], axis=0)


def coastline_rows(page):
    """The table of the coastlines: how they come out by smoothing and step, in km."""
    for width, step in ((15, 6), (15, 12), (8, 4), (8, 8), (4, 4), (2, 2), (0, 4)):
        coasts = [page["flat"](coast) for coast in page["islands"]]
        rings = [
            page["sampled"](coast, width, step) if width else page["along"](coast, step)
            for coast in coasts
        ]
        order = np.random.default_rng(0).permutation(sum(map(len, rings)))
        rec = page["rm"].reconstruct(np.concatenate(rings)[order], 1)
        found = {frozenset(edge) for edge in order[rec.edges].tolist()}
        right = found & neighbors_along(rings)
        yield (
            f"| {f'{width} km' if width else 'nothing'} | {step} km | {len(order):,} "
            f"| {rec.topology().components} | {100 * len(right) / len(order):.2f} % "
            f"| {rec.quality.ok} |"
        )


def neighbors_along(rings):
    """The edges of closed polygons with vertices numbered one after the other."""
    start, edges = 0, set()
    for ring in rings:
        at = start + np.arange(len(ring))
        pairs = np.stack([at, np.roll(at, -1)], axis=1)
        edges |= {frozenset(pair) for pair in pairs.tolist()}
        start += len(ring)
    return edges


# -------------------------------------------------------------------- the pages


def raw_scan(page):
    picture, axes = plt.subplots(figsize=(4.4, 5.4), layout="constrained")
    rec = page["rec"]
    upright = rec.vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
    draw_simplices(
        axes,
        upright,
        rec.simplices,
        (-78.0, -8.0),
        gaps=rec.repair.open_faces,
        line_width=0,
    )
    return picture


def coastlines(page):
    picture, axes = plt.subplot_mosaic(
        [["all", "sphere"], ["one", "sphere"]],
        figsize=(9, 4.2),
        width_ratios=(1.5, 1),
        height_ratios=(1.1, 1),
        layout="constrained",
    )
    rec = page["rec"]
    coasts = [closed(page["flat"](coast)) for coast in page["islands"]]
    for name in ("all", "one"):
        for coast in coasts:
            axes[name].plot(*coast.T, color="#909090", linewidth=0.6)
        lines(axes[name], rec.vertices[rec.edges], SAMPLE_COLOR, 1.1)
    cyprus = min(coasts, key=lambda coast: coast[:, 1].min())
    near = np.linalg.norm(rec.vertices - cyprus.mean(axis=0), axis=1) < 200
    axes["one"].plot(*rec.vertices[near].T, ".", color=SAMPLE_COLOR, markersize=3)
    axes["one"].set_xlim(cyprus[:, 0].min() - 5, cyprus[:, 0].max() + 5)
    axes["one"].set_ylim(cyprus[:, 1].min() - 5, cyprus[:, 1].max() + 5)
    plain(axes["all"], "eight islands")
    plain(axes["one"], "Cyprus: coast (gray), samples and edges")

    sphere = page["sphere"]
    seen = project(sphere.vertices, (75.0, -5.0))[sphere.edges]
    front = (seen[:, :, 2] > 0).all(axis=1)
    turn = np.linspace(0, 2 * np.pi, 200)
    axes["sphere"].plot(6371 * np.cos(turn), 6371 * np.sin(turn), color=GRAY, lw=0.8)
    lines(axes["sphere"], seen[~front][:, :, :2], GRAY, 0.6)
    lines(axes["sphere"], seen[front][:, :, :2], SAMPLE_COLOR, 1.3)
    plain(axes["sphere"], "thirteen lands on the sphere")
    return picture


def rotations(page):
    matrices = page["rotations"].reshape(-1, 3, 3)
    vectors = page["Rotation"].from_matrix(matrices).as_rotvec()
    seen = project(vectors, VIEW)
    edges, loop = page["rec"].edges, np.array(page["loop"]) % len(vectors)
    slab = (abs(seen[edges][:, :, 2]) < 1.0).all(axis=1)
    picture, (left, right) = plt.subplots(
        1, 2, figsize=(8.5, 4.3), layout="constrained"
    )
    draw_rotations(left, vectors, edges[slab], 0.5)
    draw_rotations(right, vectors, np.stack([loop[1:], loop[:-1]], axis=1), 2.0)
    right.plot(*seen[0, :2], "o", color=SAMPLE_COLOR, markersize=6)
    plain(left, "edges near the middle; red: through the surface")
    plain(right, "a loop that cannot be contracted")
    return picture


VIEW = (110.0, 25.0)


def draw_rotations(axes, vectors, edges, width):
    """Edges between vectors in the ball of radius pi, cut where they leave it."""
    turn = np.linspace(0, 2 * np.pi, 200)
    axes.plot(np.pi * np.cos(turn), np.pi * np.sin(turn), color=GRAY)
    ends = vectors[edges]
    far = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > np.pi
    inner = project(ends[~far].reshape(-1, 3), VIEW).reshape(-1, 2, 3)
    lines(axes, inner[:, :, :2], SAMPLE_COLOR, width)
    stubs = np.array([stub for pair in ends[far] for stub in halves(*pair)])
    stubs = project(stubs.reshape(-1, 3), VIEW).reshape(-1, 2, 3)[:, :, :2]
    lines(axes, stubs, ALARM_COLOR, width)
    axes.plot(*stubs[:, 1].T, "o", color=ALARM_COLOR, markersize=2.5 * width)


def halves(first, second):
    """An edge through the surface of the ball in two parts, each ending there."""
    other = second - 2 * np.pi * second / np.linalg.norm(second)  # the same rotation
    middle = (first + other) / 2
    exit_ = np.pi * middle / np.linalg.norm(middle)
    return [(first, exit_), (second, -exit_)]


def rotated_images(page):
    pictures, loop = page["pictures"], page["around"](page["rec"].edges)
    picture, axes = plt.subplots(figsize=(5.5, 5.5), layout="constrained")
    size = page["image"].shape[0]
    count = 18
    for k in range(count):
        at = 2 * np.pi * k / count
        x, y = np.cos(at), np.sin(at)
        image = pictures[loop[k * len(loop) // count]].reshape(size, size)
        inset = axes.inset_axes(
            (0.5 + 0.43 * x - 0.06, 0.5 + 0.43 * y - 0.06, 0.12, 0.12)
        )
        inset.imshow(image[10:-10, 10:-10], cmap="gray_r")
        inset.set_xticks([])
        inset.set_yticks([])
    centered = pictures - pictures.mean(axis=0)
    squares, main = np.linalg.eigh(centered @ centered.T)
    flat = main[:, -3:] * np.sqrt(squares[-3:])
    middle = axes.inset_axes((0.24, 0.24, 0.52, 0.52), projection="3d")
    middle.plot(*closed(flat[loop]).T, color=SAMPLE_COLOR, linewidth=1)
    middle.scatter(*flat.T, s=5, color=SAMPLE_COLOR)
    middle.set_axis_off()
    middle.set_title("the samples, three of 4096 coordinates", fontsize=8)
    axes.set_axis_off()
    return picture


def linkage(page):
    rec, directions = page["rec"], page["directions"]
    path = far_path(rec)
    picture, axes = plt.subplots(2, 4, figsize=(8, 3.8), layout="constrained")
    chosen = np.linspace(0, len(path) - 1, axes.size).round().astype(int)
    for number, (one, at) in enumerate(zip(axes.flat, chosen, strict=True), start=1):
        bars = directions[path[at]] - directions[path[at], 0]
        joints = np.concatenate([[0], np.cumsum(np.exp(1j * bars))])
        one.plot(joints.real, joints.imag, "-o", color=SAMPLE_COLOR, markersize=4)
        one.plot(
            joints.real[:2], joints.imag[:2], "-o", color=ALARM_COLOR, markersize=4
        )
        one.set_xlim(-1.7, 2.7)
        one.set_ylim(-1.7, 1.7)
        plain(one, number)
    return picture


def far_path(rec):
    """Samples on the shortest path between two that are far apart."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    i, j = rec.edges.T
    weights = np.linalg.norm(rec.vertices[i] - rec.vertices[j], axis=1)
    count = len(rec.vertices)
    graph = coo_array((weights, (i, j)), shape=(count, count)).tocsr()
    far, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    path = [int(np.argmax(far))]
    while path[-1] != 0:
        path.append(int(before[path[-1]]))
    return path


def ring_molecule(page):
    rec, atoms = page["rec"], page["atoms"]
    puckering = np.stack(
        [page["boats"].real, page["boats"].imag, page["chair"]], axis=1
    )
    picture, (left, right) = plt.subplots(
        1, 2, figsize=(9, 4.3), width_ratios=(1, 1.15), layout="constrained"
    )
    view = (30.0, 28.0)
    seen = project(puckering, view)[:, :2]
    lines(left, seen[rec.edges], SAMPLE_COLOR, 1.5)
    on_curve = np.unique(rec.edges)
    left.plot(*seen[on_curve].T, ".", color=SAMPLE_COLOR, markersize=3)
    left.plot(*seen[rec.outliers].T, "o", color=ALARM_COLOR)
    for sign, name in ((1, "chair"), (-1, "chair, reversed")):
        at = project(np.array([[0, 0, 0.62 * sign]]), view)[0]
        left.text(at[0] + 0.08, at[1], name, va="center", fontsize=9)
    plain(left, "puckering: the curve and the two chairs")

    phase = np.angle(page["boats"][on_curve])
    stations = [(k * np.pi / 6, 0) for k in range(6)]
    for k, (target, _) in enumerate(stations):
        nearest = on_curve[np.argmin(abs(np.angle(np.exp(1j * (phase - target)))))]
        ring(right, atoms[nearest], (4.2 * (k % 3), -3.6 * (k // 3)), SAMPLE_COLOR)
    for k, sign in enumerate((1, -1)):
        chair = rec.outliers[np.argmax(sign * page["chair"][rec.outliers])]
        ring(right, atoms[chair], (2.1 + 4.2 * k, -7.2), ALARM_COLOR)
    plain(right, "six rings along half of the curve, and the chairs")
    return picture


def ring(axes, atoms, offset, color):
    seen = project(atoms, (20.0, 18.0))
    points = closed(seen[:, :2]) + offset
    axes.plot(*points.T, "-", color=color, linewidth=2)
    axes.scatter(
        *points[:-1].T, s=20 + 14 * (seen[:, 2] - seen[:, 2].min()), color=color
    )


def shape_space(page):
    fish, rec = page["fish"], page["rec"]
    picture, axes = plt.subplots(
        1, 3, figsize=(9, 4.6), width_ratios=(1.3, 1, 1), layout="constrained"
    )
    centered = fish - fish.mean(axis=0)
    main = np.linalg.svd(np.hstack([centered.real, centered.imag]), full_matrices=False)
    flat = main[0][:, :3] * main[1][:3]
    flat[:, 2] *= 2.0
    draw_simplices(axes[0], flat, rec.simplices, (25.0, 35.0), line_width=0.3)
    seen = project(flat, (25.0, 35.0))[page["path"], :2]
    axes[0].plot(*seen.T, "-o", color=SAMPLE_COLOR, markersize=3)
    axes[0].plot(*seen[[0, -1]].T, "--", color=ALARM_COLOR)
    axes[0].set_title("400 outlines, three main coordinates", fontsize=9)

    path = page["path"]
    chosen = np.linspace(0, len(path) - 1, 7).round().astype(int)
    first, last = fish[path[0]], fish[path[-1]]
    for k, at in enumerate(chosen):
        outline(axes[1], fish[path[at]] - 0.42j * k, SAMPLE_COLOR)
        mixed = first + (last - first) * k / 6
        outline(axes[2], mixed - 0.42j * k, ALARM_COLOR)
    plain(axes[1], "along the manifold")
    plain(axes[2], "along a straight line")
    return picture


def outline(axes, curve, color):
    curve = closed(curve)
    axes.fill(curve.real, curve.imag, facecolor=color, alpha=0.25)
    axes.plot(curve.real, curve.imag, color=color, linewidth=1)


def map_of_shapes(page):
    chart, places, curves = page["chart"], page["places"], page["drawn"]
    rows = np.searchsorted(chart.vertices, page["rec"].simplices[chart.simplices])
    picture, axes = plt.subplots(figsize=(9, 3.2), layout="constrained")
    axes.triplot(*page["lengthwise"].T, rows, color=GRAY, linewidth=0.3)
    size = 0.4 * 0.03 / abs(curves).max()
    for place, curve in zip(places, curves, strict=True):
        outline(axes, curve * size + complex(*place), SAMPLE_COLOR)
    here = (page["there"].coordinates[0] - page["middle"]) @ page["axes"].T
    outline(axes, page["new"][0] * size + complex(*here), ALARM_COLOR)
    axes.autoscale_view()
    plain(axes, "one of two maps; red: an outline that was no sample, at its place")
    return picture


def scan_for_the_web(page):
    nose, coarse, flat = page["nose"], page["coarse"], page["flat"]
    labels = page["atlas"].labels
    # The largest chart has the color of all meshes.
    rank = np.argsort(np.argsort(-np.bincount(labels), kind="stable"))
    palette = np.vstack([MESH_COLOR, plt.colormaps["Set2"](np.arange(8))[:, :3]])[rank]
    picture, axes = plt.subplots(
        1, 3, figsize=(9, 4.2), width_ratios=(1, 1, 1.35), layout="constrained"
    )
    upright = (-78.0, -8.0)
    for place, complex_, colors in (
        (axes[0], nose, None),
        (axes[1], coarse, palette[labels]),
    ):
        seen = complex_.vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
        draw_simplices(
            place, seen, complex_.simplices, upright, line_width=0.15, colors=colors
        )
        place.set_title(f"{len(complex_.simplices):,} triangles", fontsize=9)
    uv = flat.vertex_attributes["uv"]
    own = flat.vertex_attributes["chart"][flat.simplices[:, 0]]
    axes[2].add_collection(
        PolyCollection(
            uv[flat.simplices],
            facecolors=palette[own],
            edgecolors="#555555",
            linewidths=0.15,
        )
    )
    axes[2].set(xlim=(0, 1), ylim=(0, 1))
    plain(axes[2], f"{len(page['atlas'])} charts, side by side")
    return picture


DRAWN = {
    draw.__name__: draw
    for draw in (
        raw_scan,
        coastlines,
        rotations,
        rotated_images,
        shape_space,
        map_of_shapes,
        scan_for_the_web,
        ring_molecule,
        linkage,
    )
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path("build/gallery"))
    parser.add_argument("--pages", nargs="+", choices=DRAWN, default=list(DRAWN))
    arguments = parser.parse_args()
    for name in arguments.pages:
        page = run_page(name)
        save(DRAWN[name](page), arguments.folder / f"gallery_{name}.png")
        if name == "coastlines":
            print(*coastline_rows(page), sep="\n")


if __name__ == "__main__":
    main()
