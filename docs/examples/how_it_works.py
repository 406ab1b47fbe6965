# SPDX-License-Identifier: GPL-3.0-or-later
"""The manifold method step by step on 400 random samples of a torus.

    python docs/examples/how_it_works.py [FOLDER]

Draws ``how_1.png`` to ``how_7.png`` and prints the tables of docs/how_it_works.md. The
steps are done here once more with public functions and plain NumPy, and compared with
what ``rm.reconstruct`` reports.
"""

import argparse
from itertools import combinations
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

import remanifold as rm
from drawing import GAP_COLOR, SAMPLE_COLOR, draw_simplices, project, save
from remanifold import datasets

FOLDER = Path(__file__).resolve().parents[1] / "figures"
SAMPLES, SEED = 400, 9
NEIGHBORS = 15  # 3 times the unknowns of a quadratic fit: 3 (K + K (K+1) / 2)
RADII = 1.0, 0.4  # of the torus
FIXED, AGREED_SHARE = 2.5, 0.7
VIEW = (5.0, 26.0)  # azimuth and elevation of the pictures of the whole torus
AGREED = "#fcd499"
ONE_VOTE, TWO_VOTES = "#c9302c", "#6a4fb3"
CHOSEN = "#58a65c"
GRAY = "#8a8a8a"
OUTLINES = "#d62728", "#2ca02c", "#ff7f0e", "#9467bd", "#8c564b", "#e377c2", "#111111"
PALE = "#bfd7ea", "#cfe8c9", "#e3d3f0", "#fbe3a9", "#d8d8d8", "#c9ece8", "#f3dcc6"
SIDES = ((0, 1), (0, 2), (1, 2))


# --------------------------------------------------------------- the steps, in NumPy


def true_normals(points):
    around = points * [1.0, 1.0, 0.0]
    center = RADII[0] * around / np.linalg.norm(around, axis=1, keepdims=True)
    return (points - center) / RADII[1]


def local_scales(points):
    """Distance to the sixth neighbor, the median over a sample and these six."""
    near = rm.neighborhoods(points, 6)
    sixth = near.distances[:, -1]
    return np.median(np.column_stack([sixth, sixth[near.indices]]), axis=1)


def measure(points, scales, triangles):
    """Circumradius over h, and energy, of each triangle."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    edges = [np.linalg.norm(u - v, axis=1) for u, v in ((a, b), (b, c), (c, a))]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    scale = scales[triangles].mean(axis=1)
    energy = area * sum(edge**2 for edge in edges) / scale**4
    return edges[0] * edges[1] * edges[2] / (4 * area) / scale, energy


class Steps:
    """All that the figures show."""

    def __init__(self):
        self.points = datasets.torus(SAMPLES, random_state=SEED)
        self.rec = rm.reconstruct(self.points, 2)
        self.scales = local_scales(self.points)
        self.tangents = rm.tangent_spaces(self.points, 2, NEIGHBORS, "jet").bases
        self.regions = rm.local_regions(self.points, self.tangents)
        self.triangles, self.votes = np.unique(
            np.sort(self.regions.stars.simplices, axis=1), axis=0, return_counts=True
        )
        radii, energies = measure(self.points, self.scales, self.triangles)
        largest = min(FIXED, AGREED_SHARE * self.rec.repair.hole_radius)
        fixed = (self.votes == 3) & (radii <= largest)
        self.fixed = self.triangles[fixed]
        self.candidates = self.triangles[~fixed]
        self.energies = energies[~fixed]
        self.cavity = connected(self.candidates)
        self.rims = open_edges(self.fixed)
        filled = set(map(tuple, self.rec.repair.filled_simplices.tolist()))
        self.chosen = np.array([tuple(t) in filled for t in self.candidates.tolist()])
        assert self.chosen.sum() == len(filled)
        assert (
            self.rec.repair.disputed_simplices == self.triangles[self.votes < 3]
        ).all()

        sizes = np.bincount(self.cavity)
        # The cavities of the close-ups: the largest, and one of four samples, in front.
        front = self.in_front(self.candidates)
        self.largest = self.of_cavity(
            max(set(self.cavity[front]), key=lambda c: (sizes[c], -c))
        )
        squares = {c for c in self.cavity[front] if sizes[c] == 4}
        self.square = self.of_cavity(max(squares, key=self.squareness))
        # A sample in front with neighbors on all sides.
        outer = self.in_front(np.repeat(np.arange(SAMPLES)[:, None], 3, axis=1), 0.6)
        spread = np.where(outer, self.regions.radii / self.scales, np.inf)
        self.sample = int(np.argmin(spread))

    def squareness(self, cavity):
        """Shortest over longest edge of a cavity's candidates."""
        triangles = self.candidates[self.of_cavity(cavity)]
        lengths = [
            np.linalg.norm(self.points[a] - self.points[b], axis=1)
            for a, b in (triangles[:, side].T for side in SIDES)
        ]
        return np.min(lengths) / np.max(lengths)

    def of_cavity(self, number):
        return np.flatnonzero(self.cavity == number)

    def in_front(self, triangles, slope=0.3):
        """Triangles on the outer side of the torus, well visible in the pictures."""
        middle = self.points[triangles].mean(axis=1)
        toward = project(true_normals(middle), VIEW)[:, 2]
        outer = np.hypot(middle[:, 0], middle[:, 1]) > RADII[0]
        return (toward > slope) & outer

    def votes_for(self, x, triangle):
        """Whether a triangle is in the star of a sample."""
        offsets, simplices = self.regions.stars
        star = np.sort(simplices[offsets[x] : offsets[x + 1]], axis=1)
        return bool((star == triangle).all(axis=1).any())

    def cell(self, x):
        """Corners of the local region of a sample, in space, in order around it."""
        offsets, simplices = self.regions.stars
        star = simplices[offsets[x] : offsets[x + 1], 1:]
        basis = self.tangents[x]
        corners = []
        for pair in star:
            away = self.points[pair] - self.points[x]
            corners.append(np.linalg.solve(away @ basis.T, (away**2).sum(axis=1) / 2))
        corners = np.array(corners)
        order = np.argsort(np.arctan2(corners[:, 1], corners[:, 0]))
        return self.points[x] + corners[order] @ basis, star


def connected(triangles):
    """Number of the set of triangles, connected through edges, that each is in."""
    label = np.arange(len(triangles))
    edges = [set(combinations(t, 2)) for t in triangles.tolist()]
    for i, j in combinations(range(len(triangles)), 2):
        if edges[i] & edges[j]:
            label[label == label[j]] = label[i]
    return np.unique(label, return_inverse=True)[1]


def open_edges(triangles):
    edges = np.vstack([triangles[:, side] for side in SIDES])
    edges, cofaces = np.unique(edges, axis=0, return_counts=True)
    return edges[cofaces == 1]


def fillings(triangles, rim):
    """All sets of triangles that close a rim: no edge is left with one triangle."""
    rim = {tuple(edge) for edge in rim.tolist()}
    edges = [set(combinations(t, 2)) for t in triangles.tolist()]
    found = set()

    def close(open_edges, done, chosen):
        if not open_edges:
            found.add(frozenset(chosen))
            return
        edge = min(open_edges)
        for i, sides in enumerate(edges):
            if edge in sides and i not in chosen and not sides & done:
                closed = sides & open_edges
                close(open_edges ^ sides, done | closed, [*chosen, i])

    close(frozenset(rim), frozenset(), [])
    return [sorted(filling) for filling in found]


# ------------------------------------------------------------------- close-up pictures


def view_along(normal):
    """Azimuth and elevation from which a normal points at the reader."""
    return np.degrees([np.arctan2(normal[1], normal[0]), np.arcsin(normal[2])])


class CloseUp:
    """A piece of the surface, seen along its normal."""

    def __init__(self, steps, center, radius):
        self.points = steps.points
        self.view = view_along(true_normals(center[None])[0])
        self.center = project(center[None], self.view)[0]
        self.radius = radius
        self.flat = self.flatten(steps.points)
        shown = np.linalg.norm(steps.points - center, axis=1) < 3 * radius
        facing = true_normals(steps.points) @ true_normals(center[None])[0] > 0.2
        self.shown = shown & facing

    def flatten(self, points):
        return (project(points, self.view) - self.center)[:, :2]

    def frame(self, axes, title=""):
        axes.set_xlim(-self.radius, self.radius)
        axes.set_ylim(-self.radius, self.radius)
        axes.set_aspect("equal")
        axes.set_xticks([])
        axes.set_yticks([])
        for spine in axes.spines.values():
            spine.set_color(GRAY)
        axes.set_title(title, fontsize=10)

    def dots(self, axes, size=16):
        x, y = self.flat[self.shown].T
        axes.scatter(x, y, s=size, c=SAMPLE_COLOR, linewidths=0, zorder=5)

    def fill(
        self, axes, triangles, color, alpha=1.0, line="#4a4030", width=0.9, order=1
    ):
        seen = self.shown[triangles].all(axis=1)
        rgb = to_rgba(color, alpha)
        axes.add_collection(
            PolyCollection(
                self.flat[triangles[seen]],
                facecolors=[rgb],
                edgecolors=line,
                linewidths=width,
                zorder=order,
            )
        )

    def lines(self, axes, edges, color, width=1.0, style="-", order=3):
        seen = self.shown[edges].all(axis=1)
        axes.add_collection(
            LineCollection(
                self.flat[edges[seen]],
                colors=color,
                linewidths=width,
                linestyles=style,
                zorder=order,
            )
        )

    def label(self, axes, samples, names, away=0.11):
        center = self.flat[samples].mean(axis=0)
        for sample, name in zip(samples, names, strict=True):
            direction = self.flat[sample] - center
            direction /= np.linalg.norm(direction)
            x, y = self.flat[sample] + away * self.radius * direction
            axes.text(x, y, name, ha="center", va="center", fontsize=12, zorder=7)


def legend(figure, entries, columns):
    """A legend below all panels; colors are patches, (color, style) are lines."""
    handles = []
    for text, mark in entries:
        if isinstance(mark, str):
            handles.append(Patch(facecolor=mark, edgecolor="#6b5a41", label=text))
        elif mark[1] in "os":
            handles.append(
                Line2D([], [], color=mark[0], marker=mark[1], linestyle="", label=text)
            )
        else:
            handles.append(
                Line2D([], [], color=mark[0], linestyle=mark[1], lw=2, label=text)
            )
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        fontsize=9.5,
    )


def row(*cells):
    print("|", " | ".join(map(str, cells)), "|", flush=True)


# ------------------------------------------------------------------------- the figures


def whole(axes, steps, title):
    """The samples that are to be seen, on the torus itself."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 97), np.linspace(0, 2 * np.pi, 49))
    around = RADII[0] + RADII[1] * np.cos(v)
    torus = np.stack([around * np.cos(u), around * np.sin(u), RADII[1] * np.sin(v)], -1)
    number = np.arange(u.size).reshape(u.shape)
    a, b, c, d = (
        number[i : i + 48, j : j + 96].ravel() for i in (0, 1) for j in (0, 1)
    )
    triangles = np.vstack([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    pale = np.tile(to_rgb("#f4efe6"), (len(triangles), 1))
    flat = torus.reshape(-1, 3)
    draw_simplices(axes, flat, triangles, VIEW, line_width=0, colors=pale)
    seen = steps.points[visible(steps.points)]
    x, y, _ = project(seen, VIEW).T
    axes.scatter(x, y, s=7, c=SAMPLE_COLOR, linewidths=0, zorder=5)
    axes.set_title(title, fontsize=10)


def ring(axes, center, radius):
    """Mark on the whole what a close-up shows."""
    x, y = project(center[None], VIEW)[0, :2]
    axes.add_patch(Circle((x, y), radius, fill=False, ec=ONE_VOTE, lw=1.6, zorder=9))


def samples_and_neighbors(steps, folder):
    x = steps.sample
    near = rm.neighborhoods(steps.points, NEIGHBORS)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    whole(left, steps, f"{SAMPLES} samples of a torus, at random")
    ring(left, steps.points[x], 0.33)

    close = CloseUp(steps, steps.points[x], 0.41)
    close.shown[near.indices[x]] = True
    close.lines(right, np.column_stack([np.full(NEIGHBORS, x), near.indices[x]]), GRAY)
    close.dots(right, 22)
    right.scatter(*close.flat[near.indices[x]].T, s=34, c="#d9822b", zorder=6)
    right.scatter(*close.flat[x], s=60, c=ONE_VOTE, zorder=7)
    right.add_patch(
        Circle(close.flat[x], steps.scales[x], fill=False, ec=CHOSEN, lw=2, zorder=4)
    )
    close.frame(right, "close-up, seen along the normal")
    marks = [
        ("a sample", (ONE_VOTE, "o")),
        (f"its {NEIGHBORS} nearest neighbors", ("#d9822b", "o")),
        ("radius h, the local scale", (CHOSEN, "-")),
    ]
    legend(figure, marks, 3)
    save(figure, folder / "how_1.png", colors=255)


def angles_to_normals(points, bases):
    """Angles in degrees between tangent planes and the true ones; NaN without one."""
    normals = np.cross(bases[:, 0], bases[:, 1])
    cosines = np.abs((normals * true_normals(points)).sum(axis=1))
    return np.degrees(np.arccos(np.clip(cosines, 0.0, 1.0)))


def tangent_planes(steps, folder):
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.4, 4.0), layout="constrained", width_ratios=(1.35, 1)
    )
    section(left, steps)
    row("samples", "enclosure", "PCA", "jet")
    row("---:", "---:", "---:", "---:")
    sizes = (400, 800, 1600, 3200, 6400, 12800)
    marks = {
        "enclosure": (ONE_VOTE, "s"),
        "pca": ("#d9822b", "o"),
        "jet": (CHOSEN, "^"),
    }
    errors = {name: [] for name in marks}
    for size in sizes:
        points = datasets.torus(size, random_state=SEED)
        for name in marks:
            count = 20 if name == "enclosure" else NEIGHBORS
            bases = rm.tangent_spaces(points, 2, count, name).bases
            errors[name].append(np.nanmedian(angles_to_normals(points, bases)))
        row(f"{size:,}", *(f"{errors[name][-1]:.2f}°" for name in marks))
    for name, (color, marker) in marks.items():
        right.loglog(
            sizes,
            errors[name],
            color=color,
            marker=marker,
            label=name.replace("pca", "PCA"),
        )
    right.set_xticks(sizes, [f"{size:,}" for size in sizes], fontsize=8)
    right.minorticks_off()
    ticks = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)
    right.set_yticks(ticks, [f"{tick:g}°" for tick in ticks])
    right.set_xlabel("samples")
    right.set_title("median angle to the true tangent plane", fontsize=10)
    right.grid(alpha=0.3)
    right.legend(frameon=False, fontsize=9, loc="lower left")
    save(figure, folder / "how_2.png", colors=255)


def section(axes, steps):
    """The plane through a normal in which PCA is farthest off."""
    points, normals = steps.points, true_normals(steps.points)
    bases = {
        "pca": rm.tangent_spaces(points, 2, NEIGHBORS, "pca").bases,
        "jet": steps.tangents,
    }
    angles = {name: angles_to_normals(points, b) for name, b in bases.items()}
    typical = np.abs(angles["jet"] - np.median(angles["jet"])) < 0.3
    x = int(np.argmax(np.where(typical, angles["pca"], 0.0)))
    n = normals[x]
    tilted = np.cross(*bases["pca"][x])
    along = tilted - (tilted @ n) * n
    along /= np.linalg.norm(along)
    size = 0.55

    s, t = np.meshgrid(np.linspace(-size, size, 400), np.linspace(-size, size, 400))
    plane = points[x] + s[..., None] * along + t[..., None] * n
    around = np.hypot(plane[..., 0], plane[..., 1]) - RADII[0]
    level = np.hypot(around, plane[..., 2]) - RADII[1]
    axes.contour(s, t, level, [0.0], colors="black", linewidths=1.6)
    near = rm.neighborhoods(points, NEIGHBORS).indices[x]
    away = points[near] - points[x]
    axes.scatter(away @ along, away @ n, s=20, c=SAMPLE_COLOR, zorder=4)
    axes.scatter(0, 0, s=60, c=ONE_VOTE, zorder=5)
    for name, color, style in (("pca", "#d9822b", "--"), ("jet", CHOSEN, "-.")):
        normal = np.cross(*bases[name][x])
        slope = -(normal @ along) / (normal @ n)
        reach = np.array([-size, size])
        axes.plot(reach, slope * reach, color=color, ls=style, lw=2.2, zorder=3)
    axes.set_xlim(-size, size)
    axes.set_ylim(-0.42, 0.22)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title("section through a sample and its normal", fontsize=10)
    handles = [
        Line2D([], [], color="black", lw=1.6, label="the torus"),
        Line2D([], [], color=ONE_VOTE, marker="o", ls="", label="the sample"),
        Line2D([], [], color=SAMPLE_COLOR, marker="o", ls="", label="its neighbors"),
        Line2D(
            [],
            [],
            color="#d9822b",
            ls="--",
            lw=2,
            label=f"PCA, {angles['pca'][x]:.0f}° off",
        ),
        Line2D(
            [],
            [],
            color=CHOSEN,
            ls="-.",
            lw=2,
            label=f"jet, {angles['jet'][x]:.0f}° off",
        ),
    ]
    axes.legend(handles=handles, frameon=False, fontsize=9, ncols=2, loc="lower center")


def cells_and_star(steps, folder):
    x = steps.sample
    region, star = steps.cell(x)
    around = np.unique(star)
    reach = np.linalg.norm(steps.points[around] - steps.points[x], axis=1).max()
    close = CloseUp(steps, steps.points[x], 1.15 * reach)
    flat = close.flat[around] - close.flat[x]
    around = around[np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))]

    figure, panels = plt.subplots(1, 2, figsize=(8.6, 4.9), layout="constrained")
    for i, y in enumerate([x, *around]):
        color = "#f5b8b5" if y == x else PALE[i % len(PALE)]
        outline = close.flatten(steps.cell(y)[0])
        for axes in panels[: 2 if y == x else 1]:
            axes.add_collection(
                PolyCollection([outline], facecolors=color, edgecolors="black", lw=1.0)
            )
    sides = np.vstack([star, [(x, y) for y in around]])
    close.lines(panels[1], sides, "black", 1.3)
    panels[1].scatter(*close.flatten(region).T, s=30, c=ONE_VOTE, marker="s", zorder=6)
    titles = "its local region, and those of the samples around it", "its star"
    for axes, title in zip(panels, titles, strict=True):
        close.dots(axes, 24)
        axes.scatter(*close.flat[x], s=70, c=ONE_VOTE, zorder=6)
        close.frame(axes, title)
    marks = [
        ("a sample", (ONE_VOTE, "o")),
        ("corners of its region, one for each triangle", (ONE_VOTE, "s")),
    ]
    legend(figure, marks, 2)
    save(figure, folder / "how_3.png", colors=255)


def colors_of(*counted):
    """Rows of red, green and blue: pairs of a color and a number of triangles."""
    return np.vstack([np.tile(to_rgb(color), (n, 1)) for color, n in counted])


def votes(steps, folder):
    figure, panels = plt.subplots(1, 3, figsize=(11.4, 4.4), layout="constrained")
    by_votes = {n: steps.triangles[steps.votes == n] for n in (3, 2, 1)}
    for n, triangles in by_votes.items():
        row(f"triangles with {n} of 3 votes", len(triangles))
    colors = {3: AGREED, 2: TWO_VOTES, 1: ONE_VOTE}
    draw_simplices(
        panels[0],
        steps.points,
        np.vstack([*by_votes.values()]),
        VIEW,
        colors=colors_of(*((colors[n], len(t)) for n, t in by_votes.items())),
    )
    panels[0].set_title("all triangles of all stars", fontsize=10)

    triangles = steps.candidates[steps.square]
    quad = np.unique(triangles)
    center = steps.points[quad].mean(axis=0)
    ring(panels[0], center, 0.2)
    reach = np.linalg.norm(steps.points[quad] - center, axis=1).max()
    close = CloseUp(steps, center, 1.5 * reach)
    flat = close.flat[quad] - close.flat[quad].mean(axis=0)
    quad = quad[np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))]
    names = dict(zip(quad.tolist(), "abcd", strict=True))
    for axes, diagonal in zip(panels[1:], ("ac", "bd"), strict=True):
        close.fill(axes, steps.fixed, AGREED)
        for triangle in triangles:
            text = "".join(names[v] for v in triangle.tolist())
            if not set(diagonal) <= set(text):
                continue
            voters = [
                names[v] for v in triangle.tolist() if steps.votes_for(v, triangle)
            ]
            close.fill(axes, triangle[None], colors[len(voters)])
            x, y = close.flat[triangle].mean(axis=0)
            text = " and ".join(sorted(voters))
            axes.text(x, y, text, ha="center", va="center", fontsize=11, color="white")
        close.dots(axes)
        close.label(axes, quad, names.values())
        close.frame(axes, f"who has the triangles with the diagonal {diagonal}")
    marks = [
        ("agreed: in the stars of all three corners", AGREED),
        ("of two", TWO_VOTES),
        ("of one", ONE_VOTE),
    ]
    legend(figure, marks, 3)
    save(figure, folder / "how_4.png", colors=255)


def cavities(steps, folder):
    row("fixed triangles", len(steps.fixed))
    row("candidates", len(steps.candidates))
    row("cavities", steps.cavity.max() + 1)
    triangles = steps.candidates[steps.largest]
    energies = steps.energies[steps.largest]
    edges = {tuple(e) for side in SIDES for e in triangles[:, side].tolist()}
    rim = np.array([edge for edge in steps.rims.tolist() if tuple(edge) in edges])
    ways = sorted(fillings(triangles, rim), key=lambda way: energies[way].sum())
    assert ways[0] == np.flatnonzero(steps.chosen[steps.largest]).tolist()

    figure, panels = plt.subplots(2, 2, figsize=(8.6, 8.9), layout="constrained")
    panels = panels.ravel()
    draw_simplices(panels[0], steps.points, steps.fixed, VIEW, gaps=steps.rims)
    panels[0].set_title("fixed triangles and the rims of cavities", fontsize=10)
    center = steps.points[np.unique(triangles)].mean(axis=0)
    ring(panels[0], center, 0.3)
    reach = np.linalg.norm(steps.points[np.unique(triangles)] - center, axis=1).max()
    close = CloseUp(steps, center, 1.2 * reach)
    for axes in panels[1:]:
        close.fill(axes, steps.fixed, AGREED, line="#c9a976")
        close.lines(axes, rim, GAP_COLOR, 2.6)
        close.dots(axes)
    for i, triangle in enumerate(triangles):  # smaller, so that all sides are seen
        corners = close.flat[triangle]
        corners = corners.mean(axis=0) + 0.87 * (corners - corners.mean(axis=0))
        outline = PolyCollection(
            [corners], facecolors="none", edgecolors=OUTLINES[i], lw=2.2
        )
        panels[1].add_collection(outline)
    close.frame(panels[1], f"one cavity and its {len(triangles)} candidates")
    for axes, way, name in zip(panels[2:], ways, ("least", "other"), strict=False):
        close.fill(axes, triangles[way], CHOSEN if name == "least" else "#c8c8c8")
        for i in way:
            x, y = close.flat[triangles[i]].mean(axis=0)
            axes.text(x, y, f"{energies[i]:.1f}", ha="center", va="center", fontsize=11)
        total = energies[way].sum()
        close.frame(
            axes,
            f"{'the filling of least energy' if name == 'least' else 'the other one'}, {total:.1f}",
        )
        row(f"energy of the {name} filling", f"{total:.1f}")
    row("fillings of that cavity", len(ways))
    save(figure, folder / "how_5.png", colors=255)


def opened_sphere():
    """A sphere with an opening, and a gap in its samples that is none."""
    points = datasets.sphere(1500, random_state=SEED)
    opening, gap = np.array([0.0, -0.5, 0.866]), np.array([0.0, -0.9, -0.436])
    far = np.linalg.norm(points - opening, axis=1) > 0.62
    return points[far & (np.linalg.norm(points - gap, axis=1) > 0.24)]


def holes(folder):
    points = opened_sphere()
    scales = local_scales(points)
    rim = np.unique(rm.reconstruct(points, 2).repair.open_faces)
    scale = np.median(scales)
    row("radius of the opening in median h", f"{0.62 / scale:.1f}")
    row("the same in h of its rim", f"{0.62 / scales[rim].mean():.1f}")
    row("radius of the gap in median h", f"{0.24 / scale:.1f}")
    figure, panels = plt.subplots(1, 3, figsize=(10.4, 3.9), layout="constrained")
    shown = iter(panels)
    row("`hole_radius`", "rims", "Betti numbers", "manifold")
    row("---:", "---:", "---", "---")
    for radius in (1.0, 1.5, 2.0, 2.5, None, 4.0, 5.0, 6.0):
        rec = rm.reconstruct(points, 2, hole_radius=radius)
        topology, repair = rec.topology(), rec.repair
        name = f"{repair.hole_radius:.1f}" + (" (default)" if radius is None else "")
        betti = ", ".join(map(str, topology.betti_numbers))
        manifold = "yes" if topology.manifold else "no"
        row(name, repair.num_boundary_components, betti, manifold)
        if radius in (1.5, None, 6.0):
            axes = next(shown)
            draw_simplices(
                axes, points, rec.simplices, (-90.0, 20.0), gaps=repair.open_faces
            )
            axes.set_title(f"hole_radius {name}", fontsize=10)
    save(figure, folder / "how_6.png", colors=255)


def result(steps, folder):
    rec, points = steps.rec, steps.points
    topology = rec.topology()
    corners = points[rec.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    middles = corners.mean(axis=1)
    outward = (normals * true_normals(middles)).sum(axis=1) > 0
    row("triangles", len(rec.simplices))
    row("Betti numbers", ", ".join(map(str, topology.betti_numbers)))
    row("normals that point outward", int(outward.sum()))

    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.9), layout="constrained")
    filled = set(map(tuple, rec.repair.filled_simplices.tolist()))
    chosen = np.array([tuple(t) in filled for t in np.sort(rec.simplices).tolist()])
    colors = np.where(chosen[:, None], to_rgb(CHOSEN), to_rgb(AGREED))
    draw_simplices(left, points, rec.simplices, VIEW, colors=colors)
    left.set_title("fixed triangles and, green, those chosen", fontsize=10)
    draw_simplices(right, points, rec.simplices, VIEW)
    toward = project(normals, VIEW)[:, 2] > 0.05
    tips = project(middles + 0.17 * normals, VIEW)
    ends = np.stack([project(middles, VIEW), tips], axis=1)
    # Hidden ones are left out: those of the far side of the hole face the reader as well.
    order = np.flatnonzero(toward & visible(middles))[::3]
    right.add_collection(
        LineCollection(ends[order, :, :2], colors=SAMPLE_COLOR, linewidths=1.2)
    )
    right.scatter(*tips[order, :2].T, s=9, c=SAMPLE_COLOR, linewidths=0, zorder=3)
    right.set_title("outward normals, from the order of the corners", fontsize=10)
    save(figure, folder / "how_7.png", colors=255)


def visible(places):
    """Places of the torus that nothing of it lies in front of."""
    toward = project(np.eye(3), VIEW)[:, 2]
    along = np.linspace(0.05, 3.0, 200)
    rays = places[:, None] + along[None, :, None] * toward
    around = np.hypot(rays[..., 0], rays[..., 1]) - RADII[0]
    return (np.hypot(around, rays[..., 2]) > 0.99 * RADII[1]).all(axis=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    folder = parser.parse_args().folder
    steps = Steps()
    samples_and_neighbors(steps, folder)
    tangent_planes(steps, folder)
    cells_and_star(steps, folder)
    votes(steps, folder)
    cavities(steps, folder)
    holes(folder)
    result(steps, folder)


if __name__ == "__main__":
    main()
