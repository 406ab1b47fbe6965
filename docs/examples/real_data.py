# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured data: laser scans of a bunny, airborne LiDAR, patches of range images.

    python docs/examples/real_data.py DATA [FOLDER]

DATA holds the sets, which are no part of this repository. Draws the pictures of
docs/real_data.md to FOLDER and prints its tables. Beside it PyMeshLab's screened Poisson
and MeshLib, both as they come; `pip install pymeshlab meshlib pyvista`.
"""

import sys
import time
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pymeshlab
import pyvista
from meshlib import mrmeshnumpy, mrmeshpy
from PIL import Image
from scipy.spatial import cKDTree

import drawing
import remanifold as rm
from remanifold import datasets

ONE_VIEW = "rawscan_bunny_one_view_bun000"
TEN_VIEWS = "rawscan_bunny_ten_views_registered_60k"
MESH = "surface_stanford_bunny_vertices"
LIDAR = "lidar_autzen_thinned"
PATCHES = "highdim_range_image_patches_circle_in_R25"
CARTON = "rawscan_milk_carton"
MILLIMETERS = 1000.0  # the scans are in meters


def load(folder, name):
    with np.load(Path(folder) / f"{name}.npz") as data:
        return dict(data)


def row(*cells):
    print("|", " | ".join(map(str, cells)), "|", flush=True)


def reconstruct(label, points, dim, unit=1.0, **options):
    """A reconstruction, and a line about it."""
    start = time.perf_counter()
    rec = rm.reconstruct(points, dim, **options)
    seconds = time.perf_counter() - start
    topology, repair, smoothing = rec.topology(), rec.repair, rec.smoothing
    noise = moved = ""
    if smoothing is not None:
        noise = f"{unit * smoothing.noise:.3g}"
        moved = smoothing.num_neighbors or "none"
    row(
        label,
        f"`{options['smooth']!r}`".replace("'", '"'),
        f"{len(rec.simplices):,}",
        topology.components,
        repair.num_boundary_components,
        ", ".join(map(str, topology.betti_numbers)),
        "yes" if topology.manifold else "no",
        f"{len(repair.disputed_simplices):,}",
        noise,
        moved,
        len(rec.outliers),
        len(repair.unused_vertices),
        f"{seconds:.1f}",
    )
    return rec


def distances_from_mesh(points, vertices, triangles, candidates=16):
    """Distance of each point from the nearest triangles, by their centers."""
    corners = vertices[triangles]
    near = cKDTree(corners.mean(axis=1)).query(points, candidates)[1]
    best = np.full(len(points), np.inf)
    for column in near.T:
        best = np.minimum(best, _distances_from_triangles(points, corners[column]))
    return best


def _distances_from_triangles(points, corners):
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    height = ((points - corners[:, 0]) * normals).sum(axis=1)
    foot = points - height[:, None] * normals
    within = np.ones(len(points), dtype=bool)
    best = np.full(len(points), np.inf)
    for k in range(3):
        start, side = corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]
        within &= (np.cross(side, foot - start) * normals).sum(axis=1) >= 0
        share = ((points - start) * side).sum(axis=1) / (side**2).sum(axis=1)
        nearest = start + np.clip(share, 0, 1)[:, None] * side
        best = np.minimum(best, np.linalg.norm(points - nearest, axis=1))
    return np.where(within, np.abs(height), best)


def bends(vertices, triangles):
    """Angles in degrees between neighboring triangles, which are oriented alike."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    edges = np.sort(triangles[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2), axis=1)
    own = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    first, second = own[order[1:]][same], own[order[:-1]][same]
    cosines = (normals[first] * normals[second]).sum(axis=1)
    return np.degrees(np.arccos(np.clip(cosines, -1, 1)))


def draw(path, panels, view, turn=None, size=(4.2, 4.2)):
    """Reconstructions side by side, open faces in blue."""
    figure, axes = plt.subplots(
        1,
        len(panels),
        figsize=(size[0] * len(panels), size[1]),
        squeeze=False,
        layout="constrained",
    )
    for ax, (title, rec) in zip(axes[0], panels, strict=True):
        points = rec.vertices if turn is None else rec.vertices[:, turn]
        drawing.draw_simplices(
            ax, points, rec.simplices, view, gaps=rec.repair.open_faces, line_width=0
        )
        ax.set_title(title, fontsize=9)
    drawing.save(figure, path, colors=64)


def scans(data, folder):
    one = load(data, ONE_VIEW)["points"]
    views = {
        s: reconstruct("one view", one, 2, MILLIMETERS, smooth=s)
        for s in (False, "auto", True)
    }
    panels = [("as measured", views[False]), ("smooth=True", views[True])]
    draw(folder / "real_scan_one_view.png", panels, (0, 5), [2, 0, 1])

    ten = load(data, TEN_VIEWS)["points"]
    views = {
        s: reconstruct("ten views", ten, 2, MILLIMETERS, smooth=s)
        for s in (False, "auto")
    }
    panels = [("as measured", views[False]), ('smooth="auto"', views["auto"])]
    draw(folder / "real_scan_ten_views.png", panels, (0, 5), [2, 0, 1])
    draw(folder / "real_scan_underneath.png", panels, (0, -80), [2, 0, 1], (4.2, 3.2))

    mesh = load(data, MESH)
    sizes = (30, 60, 90, 120, 200)
    places = {"as measured": ten}
    places |= {f"smooth={n}": rm.smooth(ten, 2, n).points for n in sizes}
    for label, points in places.items():
        away = distances_from_mesh(points, mesh["points"], mesh["faces"])
        away *= MILLIMETERS
        root = np.sqrt((away**2).mean())
        quantiles = (np.quantile(away, q) for q in (0.5, 0.95, 1))
        row(label, *(f"{v:.2f}" for v in (root, *quantiles)))
    for rec in views.values():
        angles = bends(rec.vertices, rec.simplices)
        row(f"{np.median(angles):.1f}", f"{np.count_nonzero(angles > 90):,}")


def lidar(data, folder):
    laser = load(data, LIDAR)
    points = laser["points"]
    ground = points[laser["classification"] == 2]
    for smooth in (False, "auto", True):
        bare = reconstruct("ground", ground, 2, smooth=smooth)
        if smooth is False:
            rough = bare
    everything = [
        reconstruct("all echoes", points, 2, smooth=smooth) for smooth in ("auto", True)
    ]
    panels = [
        ("ground as measured", rough),
        ("ground, smooth=True", bare),
        ("all echoes as measured", everything[0]),
    ]
    draw(folder / "real_lidar.png", panels, (-90, 50), size=(4.0, 4.2))


def once_around(rec, plane):
    """Whether it is one closed curve that winds once around zero in the plane."""
    if rec.topology().betti_numbers != (1, 1) or len(rec.repair.unused_vertices):
        return False
    place = rec.vertices @ plane.T @ (1, 1j)
    turns = np.angle(place[rec.simplices[:, 1]] / place[rec.simplices[:, 0]])
    neighbors = {}
    for (a, b), turn in zip(rec.simplices.tolist(), turns, strict=True):
        neighbors.setdefault(a, []).append((b, turn))
        neighbors.setdefault(b, []).append((a, -turn))
    if any(len(pair) != 2 for pair in neighbors.values()):
        return False
    start = here = int(rec.simplices[0, 0])
    before, total = -1, 0.0
    while before < 0 or here != start:
        there, turn = next(pair for pair in neighbors[here] if pair[0] != before)
        before, here, total = here, there, total + turn
    return bool(round(abs(total) / (2 * np.pi)) == 1)


def patches(data, folder, draws=4, few=1000, num_neighbors=400):
    points = load(data, PATCHES)["points"]
    plane = np.linalg.svd(points, full_matrices=False)[2][:2]
    counts, shown = (20, 40, 80), (0, 1, 2, 4, 8)
    right = np.zeros((len(shown), len(counts)), dtype=int)
    off, noise = np.zeros(len(shown)), np.zeros(len(shown))
    for seed in range(draws):
        places = points[np.random.default_rng(seed).permutation(len(points))[:few]]
        for rounds in range(shown[-1] + 1):
            smoothing = rm.smooth(places, 1, num_neighbors)
            if rounds in shown:
                i = shown.index(rounds)
                out = places - places @ plane.T @ plane
                off[i] += np.sqrt((out**2).sum() / few) / draws
                noise[i] += smoothing.noise / draws
                for j, count in enumerate(counts):
                    thin = datasets.spread(places, count, random_state=seed)
                    rec = rm.reconstruct(thin, 1, smooth=False)
                    right[i, j] += once_around(rec, plane)
                    if seed == 0 and count == 40:
                        last = places, rec
            places = smoothing.points
    for i, rounds in enumerate(shown):
        counted = (f"{r} of {draws}" for r in right[i])
        row(rounds, f"{noise[i]:.4f}", f"{off[i]:.2f}", *counted)
    places, rec = last
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.2), layout="constrained")
    drawing.draw_points(axes[0], points @ plane.T, None, size=0.5)
    drawing.draw_points(axes[1], places @ plane.T, None, size=2)
    flat = rec.vertices @ plane.T
    drawing.draw_simplices(axes[2], flat, rec.simplices, None)
    drawing.draw_points(axes[2], flat, None, size=12)
    titles = "15,000 patches", "1,000 of them, smoothed 8 times", "40 of these"
    for ax, title in zip(axes, titles, strict=True):
        ax.set_title(title, fontsize=9)
    drawing.save(figure, folder / "real_patches.png", colors=48)


def by_poisson(points):
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points))
    meshes.compute_normal_for_point_clouds()
    meshes.generate_surface_reconstruction_screened_poisson()
    mesh = meshes.current_mesh()
    return rm.SimplicialComplex(mesh.vertex_matrix(), mesh.face_matrix())


def by_meshlib(points):
    cloud = mrmeshnumpy.pointCloudFromPoints(np.ascontiguousarray(points))
    faces = mrmeshnumpy.getNumpyFaces(mrmeshpy.triangulatePointCloud(cloud).topology)
    # Triangles that it has taken out are rows of one vertex, and some come twice.
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])]
    first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)[1]
    return rm.SimplicialComplex(points, faces[first])


def beside_others(data, folder):
    """Scans as they come, by three programs; a row of pictures each."""
    ways = {
        "screened Poisson": by_poisson,
        "MeshLib": by_meshlib,
        "remanifold": lambda points: rm.reconstruct(points, 2),
    }
    # Looked at along, with this way up.
    scans_of = {
        "bunny, ten views": (TEN_VIEWS, (0.3, -0.9, 1.0), (0, 1, 0)),
        "milk carton": (CARTON, (0.6, -0.4, -1.0), (0, -1, 0)),
        "LiDAR": (LIDAR, (0.0, -1.0, 0.9), (0, 0, 1)),
    }
    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(len(scans_of), len(ways)),
        window_size=(1200, 360 * len(scans_of)),
        border=False,
    )
    for i, (label, (name, along, up)) in enumerate(scans_of.items()):
        points = load(data, name)["points"]
        for j, (program, build) in enumerate(ways.items()):
            start = time.perf_counter()
            found = build(points)
            seconds = time.perf_counter() - start
            topology = found.topology()
            row(
                label,
                program,
                f"{len(found.simplices):,}",
                topology.components,
                topology.boundary_components,
                "yes" if topology.manifold else "no",
                f"{seconds:.1f}",
            )
            plotter.subplot(i, j)
            shape = pyvista.PolyData.from_regular_faces(found.vertices, found.simplices)
            plotter.add_mesh(shape, color="#e0a458")
            rims = shape.extract_feature_edges(
                feature_edges=False, manifold_edges=False, non_manifold_edges=False
            )
            if rims.n_cells:
                plotter.add_mesh(rims, color="#1f4e8c", line_width=2)
            plotter.add_text(f"{label}\n{program}", font_size=9, color="#303030")
            plotter.set_background("white")
            # The same place for all: Poisson goes on where nothing was measured.
            plotter.camera_position = _camera(points, along, up)
    image = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    path = folder / "real_beside_others.png"
    image.quantize(128).save(path, optimize=True)


def _camera(points, along, up):
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    size = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    along = np.array(along) / np.linalg.norm(along)
    return [tuple(middle + 1.5 * size * along), tuple(middle), up]


def main():
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    data = Path(sys.argv[1])
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else "figures")
    scans(data, folder)
    patches(data, folder)
    lidar(data, folder)
    beside_others(data, folder)


if __name__ == "__main__":
    main()
