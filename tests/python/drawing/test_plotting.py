# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures: three coordinates for any complex, what is drawn, and how it looks."""

import ctypes
import json
import re
import sys

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist
from typer.testing import CliRunner

import remanifold as rm
from remanifold.cli import app
from remanifold.complex import embedding, measures
from remanifold.drawing import draw_pyvista, scene, thinning

pytest.importorskip("matplotlib")
pytest.importorskip("plotly")
pytest.importorskip("pyvista")

from matplotlib.image import imread

try:
    draw_pyvista.need_renderer()
    RENDERER = ""
except OSError as error:
    RENDERER = str(error)

rendered = pytest.mark.skipif(bool(RENDERER), reason=RENDERER)
PYVISTA = pytest.param("pyvista", marks=rendered)
BACKENDS = (PYVISTA, "plotly", "matplotlib")


def grid(rows, columns):
    """Triangles of a rectangle of unit squares, with its corners in the plane."""
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b = number[:-1, :-1].ravel(), number[:-1, 1:].ravel()
    c, d = number[1:, :-1].ravel(), number[1:, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    y, x = np.divmod(np.arange(rows * columns), columns)
    return np.stack([x, y], 1).astype(float), triangles.astype(np.int32)


def half_circle():
    angles = np.linspace(0, np.pi, 40)
    return np.stack([np.cos(angles), np.sin(angles)], 1)


def lifted(points, dim, seed=0):
    """The same shape, turned in more dimensions."""
    axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(dim, dim)))[0]
    return points @ axes[: points.shape[1]]


@pytest.fixture(scope="module")
def torus():
    return rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)


@pytest.fixture(scope="module")
def sparse():
    """Too few samples: some are in doubt."""
    return rm.reconstruct(rm.datasets.torus(80, random_state=1), 2)


@pytest.fixture(scope="module")
def rotations():
    return rm.reconstruct(rm.datasets.rotations(400, random_state=0), 3)


@pytest.fixture(scope="module")
def ball():
    return rm.reconstruct(rm.datasets.ball(300, random_state=0), 3)


# --- Embeddings -----------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_coordinates_are_kept(dim):
    points = np.random.default_rng(dim).normal(size=(6, dim))
    found = rm.embed(rm.SimplicialComplex(points, [[0, 1], [2, 3]]))
    assert (found.method, found.label, found.kept) == ("coordinates", "", 1.0)
    np.testing.assert_array_equal(found.points[:, :dim], points)
    assert not found.points[:, dim:].any()
    assert not found.points.flags.writeable


@pytest.mark.parametrize("samples", [40, 5])
def test_pca_is_that_of_the_singular_values(samples):
    rng = np.random.default_rng(samples)
    points = rng.normal(size=(samples, 9)) * np.arange(9, 0, -1) + 100
    mesh = rm.SimplicialComplex(points, [[i, i + 1] for i in range(samples - 1)])
    found = rm.embed(mesh, "pca")
    centered = points - points.mean(axis=0)
    _, values, rows = np.linalg.svd(centered, full_matrices=False)
    expected = centered @ rows[:3].T
    for column, other in zip(found.points.T, expected.T, strict=True):
        np.testing.assert_allclose(abs(column), abs(other), atol=1e-8)
    kept = (values[:3] ** 2).sum() / (values**2).sum()
    assert found.kept == pytest.approx(kept)
    assert (
        found.label == f"PCA to 3 of 9 dimensions, {100 * kept:.0f} % of the variance"
    )


def test_pca_of_large_matrices_finds_the_same_axes(monkeypatch):
    rng = np.random.default_rng(0)
    points = rng.normal(size=(120, 80)) * 0.5 ** np.arange(80)
    mesh = rm.SimplicialComplex(points, [[i, i + 1] for i in range(119)])
    exact = rm.embed(mesh, "pca")
    monkeypatch.setattr(embedding, "EXACT_PCA", 50)
    found = rm.embed(mesh, "pca")
    np.testing.assert_allclose(found.points, exact.points, atol=1e-9)
    assert found.kept == pytest.approx(exact.kept)


def test_outliers_do_not_turn_the_axes():
    points, triangles = grid(6, 9)
    far = np.zeros((1, 4))
    far[0, 3] = 1e4
    points = np.vstack([np.pad(points, ((0, 0), (0, 2))), far])
    found = rm.embed(rm.SimplicialComplex(points, triangles), "pca")
    assert found.kept == pytest.approx(1)
    np.testing.assert_allclose(cdist(found.points[:54], found.points[:54]),
                               cdist(points[:54], points[:54]), atol=1e-6)  # fmt: skip


def test_shortest_paths_are_those_of_dijkstra():
    rec = rm.reconstruct(rm.datasets.flat_torus(300, random_state=3), 2)
    i, j = rec.edges.T
    lengths = np.linalg.norm(rec.vertices[i] - rec.vertices[j], axis=1)
    graph = embedding._graph(rec.edges, lengths, rec.num_vertices)
    weights = coo_matrix((lengths, (i, j)), shape=(300, 300))
    for source in (0, 7, 299):
        np.testing.assert_allclose(
            embedding._distances_from(graph, source),
            dijkstra(weights, directed=False, indices=source),
            rtol=1e-12,
        )


def test_geodesics_unroll_a_roll():
    flat, triangles = grid(8, 60)
    angle = 0.12 * flat[:, 0]
    radius = 1 / 0.12  # so that lengths stay
    rolled = np.stack([radius * np.cos(angle), radius * np.sin(angle), flat[:, 1]], 1)
    mesh = rm.SimplicialComplex(lifted(rolled, 7), triangles)
    found = rm.embed(mesh, "geodesic")
    # Paths along edges are longer than straight ones, by 4 to 5 % here.
    away = cdist(found.points, found.points)[:60, :60]
    true = abs(np.subtract.outer(np.arange(60.0), np.arange(60.0)))
    assert abs(away - true).max() < 0.06 * 60
    assert np.linalg.norm(rolled[0] - rolled[59]) < 0.3 * 60
    # What bends the paths has no place in the plane: 4 to 6 % of the variance.
    assert 0.94 < found.kept < 0.96
    assert found.label.startswith("Geodesic distances from 100 landmarks")


def test_rounding_does_not_choose_the_landmarks():
    """On a grid many vertices are equally far; last bits differ between releases."""
    flat, triangles = grid(6, 30)
    kept = {
        rm.embed(
            rm.SimplicialComplex(lifted(flat, 7, seed), triangles), "geodesic"
        ).kept
        for seed in range(4)
    }
    assert max(kept) - min(kept) < 1e-9


def test_auto_takes_what_keeps_the_edges_better(rotations):
    found = rm.embed(rotations)
    by_method = {name: rm.embed(rotations, name) for name in ("pca", "geodesic")}

    def likeness(placed):
        i, j = rotations.edges.T
        true = np.linalg.norm(rotations.vertices[i] - rotations.vertices[j], axis=1)
        drawn = np.linalg.norm(placed.points[i] - placed.points[j], axis=1)
        return np.corrcoef(true, drawn)[0, 1], (true @ drawn) / (
            np.linalg.norm(true) * np.linalg.norm(drawn)
        )

    best = max(by_method, key=lambda name: likeness(by_method[name])[1])
    assert found.method == best == "geodesic"
    # Where PCA keeps nearly all there is no contest.
    flat, triangles = grid(5, 9)
    assert rm.embed(rm.SimplicialComplex(lifted(flat, 6), triangles)).method == "pca"


def test_embed_refuses_what_it_cannot_do(rotations):
    with pytest.raises(ValueError, match=r"method .*'best'.*geodesic"):
        rm.embed(rotations, "best")
    with pytest.raises(
        TypeError, match="complex must be a SimplicialComplex, got list"
    ):
        rm.embed([[0, 1]])


def test_embeddings_are_reproducible(rotations):
    for method in ("pca", "geodesic"):
        first, second = (rm.embed(rotations, method) for _ in range(2))
        np.testing.assert_array_equal(first.points, second.points)
    # The signs do not depend on the solver: mirrored samples give the mirrored axes.
    mirrored = rm.SimplicialComplex(-rotations.vertices, rotations.simplices)
    np.testing.assert_allclose(
        rm.embed(mirrored, "geodesic").points, first.points, atol=1e-9
    )


@pytest.mark.parametrize("seed", range(6))
def test_signs_are_fixed(seed):
    """Solvers may return either: the largest part of each axis is positive."""
    points = np.random.default_rng(seed).normal(size=(40, 5))
    mesh = rm.SimplicialComplex(points, [[i, i + 1] for i in range(39)])
    centered = points - points.mean(axis=0)
    axes = np.linalg.lstsq(centered, rm.embed(mesh, "pca").points, rcond=None)[0]
    largest = abs(axes).argmax(axis=0)
    assert (axes[largest, range(3)] > 0).all()
    tied = np.array([[0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]])
    assert embedding.fixed_signs(tied).tolist() == [1, -1]


@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_products_give_the_same_picture(kind):
    points = rm.datasets.flat_torus(150, random_state=0)
    points = points - points.mean(axis=0)
    rec = rm.reconstruct(points, 2)
    matrix = points @ points.T if kind == "gram" else cdist(points, points)
    same = rm.reconstruct(**{kind: matrix}, dim=2)
    known, found = rm.embed(rec, "pca"), rm.embed(same, "pca")
    np.testing.assert_allclose(abs(found.points), abs(known.points), atol=1e-6)
    words = "inner products" if kind == "gram" else "distances"
    assert found.label.startswith(f"Classical scaling of the {words} to 3 of 4")


def test_components_stand_side_by_side():
    flat, triangles = grid(4, 6)
    two = np.vstack([lifted(flat, 5, 1), lifted(flat, 5, 2), np.full((1, 5), 9.0)])
    mesh = rm.SimplicialComplex(two, np.vstack([triangles, triangles + len(flat)]))
    found = rm.embed(mesh, "geodesic")
    first, second = found.points[:24], found.points[24:48]
    assert first[:, 0].max() < second[:, 0].min()
    assert "side by side" in found.label
    assert np.isnan(found.points[48]).all()  # in no simplex


def test_embed_refuses():
    mesh = rm.SimplicialComplex(np.eye(4), [[0, 1]])
    with pytest.raises(ValueError, match="method is 'tsne'"):
        rm.embed(mesh, "tsne")
    with pytest.raises(TypeError, match="complex must be a SimplicialComplex"):
        rm.embed(np.eye(4))


# --- Measures ---------------------------------------------------------------------


@pytest.mark.parametrize("dim", [2, 3, 4])
def test_regular_simplices(dim):
    mesh = rm.SimplicialComplex(np.eye(dim + 1), [range(dim + 1)])
    np.testing.assert_allclose(measures.shapes(mesh), 1)
    expected = np.degrees(np.arccos(1 / dim))
    np.testing.assert_allclose(measures.angles(mesh), expected)


def test_shapes_and_angles_of_triangles():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(60, 3))
    mesh = rm.SimplicialComplex(points, np.arange(60).reshape(20, 3))
    a, b, c = points.reshape(20, 3, 3).transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    squares = sum(((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a)))
    np.testing.assert_allclose(measures.shapes(mesh), 4 * 3**0.5 * area / squares)
    angles = measures.angles(mesh).reshape(3, 20)
    np.testing.assert_allclose(angles.sum(axis=0), 180)
    u, v = b - a, c - a
    cosine = (u * v).sum(1) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1)
    # The angle at a lies between the facets opposite to b and c: the last pair.
    np.testing.assert_allclose(angles[2], np.degrees(np.arccos(cosine)))
    flat = rm.SimplicialComplex([[0, 0], [1, 0], [2, 0]], [[0, 1, 2]])
    assert measures.shapes(flat)[0] == pytest.approx(0, abs=1e-7)
    assert len(measures.angles(flat)) == 0


def test_edge_ratios_and_means_at_vertices():
    path = rm.SimplicialComplex([[0], [1], [3], [7.0], [9]], [[0, 1], [1, 2], [2, 3]])
    np.testing.assert_allclose(measures.edge_ratios(path), [0.5, 0.5])
    means = measures.at_vertices(path, np.array([1.0, 3, 5]))
    np.testing.assert_allclose(means, [1, 2, 4, 5, np.nan])


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_open_faces_are_those_of_the_report(dim, ball):
    rec = {
        1: lambda: rm.reconstruct(half_circle(), 1),
        2: lambda: rm.reconstruct(rm.datasets.moebius_band(300, random_state=0), 2),
        3: lambda: ball,
    }[dim]()
    found = scene.open_faces(rec.simplices)
    assert len(found) > 0
    assert found.tolist() == np.sort(rec.repair.open_faces, axis=1).tolist()


# --- Thinning -----------------------------------------------------------------------


def test_thinned_surfaces_look_alike():
    rec = rm.reconstruct(rm.datasets.torus(6000, random_state=0), 2)
    kept, cells = thinning.thinned(rec.vertices, rec.simplices, 3000)
    assert 1500 < len(cells) <= 3000
    assert cells.max() == len(kept) - 1
    assert len({tuple(sorted(row)) for row in cells.tolist()}) == len(cells)
    assert (np.diff(np.sort(cells, axis=1), axis=1) > 0).all()

    def area(corners):
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return np.linalg.norm(normals, axis=1).sum() / 2

    before = area(rec.vertices[rec.simplices])
    assert area(rec.vertices[kept][cells]) == pytest.approx(before, rel=0.05)


def test_thinning_leaves_small_meshes_alone(torus):
    kept, cells = thinning.thinned(torus.vertices, torus.simplices, 10_000)
    np.testing.assert_array_equal(kept[cells], torus.simplices)


@pytest.mark.parametrize("limit", [1, 7, 100])
def test_thinning_obeys_its_limit(limit):
    points, triangles = grid(40, 40)
    points = np.pad(points, ((0, 0), (0, 1)))
    assert len(thinning.thinned(points, triangles, limit)[1]) <= limit
    at_one_place = np.zeros_like(points)
    assert len(thinning.thinned(at_one_place, triangles, limit)[1]) <= limit


# --- What is drawn ------------------------------------------------------------------


def make_scene(complex, limit=100_000, **options):
    given = {"color": None, "style": "auto", "show_samples": False}
    given |= {"show_doubtful": False, "placed": rm.embed(complex), "limit": limit}
    return scene.scene_of(complex, **{**given, **options})


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
def test_what_is_drawn_by_dimension(torus, ball, rotations):
    curve = make_scene(rm.reconstruct(rm.datasets.trefoil(80, random_state=0), 1))
    assert [len(lines.edges) for lines in curve.lines] == [80]
    assert (curve.surfaces, curve.marks, curve.flat) == ([], [], False)
    arc = rm.reconstruct(half_circle(), 1)
    assert [mark.name for mark in make_scene(arc).marks] == ["ends"]
    assert make_scene(arc).flat

    surface = make_scene(torus)
    assert [len(s.triangles) for s in surface.surfaces] == [len(torus.simplices)]
    assert surface.lines == []  # closed
    assert len(make_scene(torus, style="edges").lines[0].edges) == len(torus.edges)

    solid = make_scene(ball)
    assert [s.name for s in solid.surfaces] == ["tetrahedra", "boundary"]
    assert len(solid.surfaces[0].triangles) == 4 * min(len(ball.simplices), 1000)
    assert solid.surfaces[1].opacity < 1
    assert [s.name for s in make_scene(ball, style="surface").surfaces] == ["boundary"]

    closed = make_scene(rotations)
    assert [s.name for s in closed.surfaces] == ["tetrahedra"]
    assert any("Geodesic" in line for line in closed.caption)

    points = rm.datasets.sphere_times_sphere(600, random_state=0)
    four = make_scene(rm.reconstruct(points, 4))
    assert four.surfaces == []
    assert len(four.lines) == 1


def test_shrunken_tetrahedra_are_smaller_and_apart(ball):
    solid = make_scene(ball).surfaces[0]
    corners = solid.points.reshape(-1, 4, 3)
    shown = ball.simplices[
        np.arange(len(corners)) * len(ball.simplices) // len(corners)
    ]
    true = ball.vertices[shown]
    np.testing.assert_allclose(corners.mean(axis=1), true.mean(axis=1), atol=1e-12)

    def volume(c):
        return abs(np.linalg.det(c[:, 1:] - c[:, :1]))

    np.testing.assert_allclose(volume(corners), 0.6**3 * volume(true), atol=1e-15)


def test_what_is_left_out_is_said(torus, rotations):
    thin = make_scene(torus, limit=200)
    shown = len(thin.surfaces[0].triangles)
    assert shown <= 200
    assert thin.caption == [
        f"Coarsened for display: {shown} for {len(torus.simplices)} triangles"
    ]
    few = make_scene(rotations, limit=50)
    total = len(rotations.simplices)
    assert f"Shown: 50 of {total:,} tetrahedra, evenly chosen" in few.caption
    marked = make_scene(torus, limit=100, show_samples=True)
    assert "Marked: 100 of 400 samples" in marked.caption


def test_colors(torus, sparse):
    two = rm.reconstruct(rm.datasets.interlocking_circles(80, random_state=0), 1)
    labels = make_scene(two, color="component")
    np.testing.assert_array_equal(labels.lines[0].values, two.component_labels())
    assert labels.scale.categories == ("0", "1")
    band = rm.reconstruct(rm.datasets.moebius_band(300, random_state=0), 2)
    np.testing.assert_array_equal(
        make_scene(band, color="boundary").surfaces[0].values, band.boundary
    )
    found = make_scene(torus, color="spacing")
    np.testing.assert_array_equal(found.surfaces[0].values, torus.quality.spacing)
    assert found.scale.low < np.median(torus.quality.spacing) < found.scale.high
    own = make_scene(torus, color=np.arange(400)).surfaces[0].values
    np.testing.assert_array_equal(own, np.arange(400))
    shape = make_scene(torus, color="quality").surfaces[0].values
    mine = measures.shapes(torus)[(torus.simplices == 5).any(axis=1)].mean()
    assert shape[5] == pytest.approx(mine)
    doubted = make_scene(sparse, color="doubtful").surfaces[0].values
    assert doubted.sum() == sparse.quality.doubtful.sum() > 0


RGB = np.random.default_rng(5).integers(0, 256, (400, 3)).astype(np.uint8)


@pytest.fixture(scope="module")
def colored():
    """With attributes of all kinds, some called as what is known of any result."""
    return rm.reconstruct(
        rm.datasets.torus(400, random_state=0),
        2,
        attributes={
            "colors": RGB,
            "rgba16": np.hstack([RGB, RGB[:, :1]]).astype(np.uint16) * 257,
            "shares": RGB / 255,
            "heat": np.arange(400),
            "seen": np.arange(400) % 3 == 0,
            "normals": np.random.default_rng(0).normal(size=(400, 3)),
            "column": np.arange(400.0)[:, None],
            "spacing": np.full(400, 7.0),
        },
    )


def test_attributes_are_colors(colored):
    for color in ("colors", "rgba16", "shares", RGB, RGB.tolist(), RGB / 255):
        found = make_scene(colored, color=color)
        assert found.scale is None
        np.testing.assert_array_equal(found.surfaces[0].values, RGB / 255)
    heat = make_scene(colored, color="heat")
    np.testing.assert_array_equal(heat.surfaces[0].values, np.arange(400))
    assert heat.scale.label == "heat"
    assert make_scene(colored, color="column").scale.label == "column"
    seen = make_scene(colored, color="seen")
    assert seen.scale.categories == ("no", "yes")
    assert seen.surfaces[0].values.sum() == 134
    # As `fields` has it: what is known of the result, not what a file knew of an old one.
    own = make_scene(colored, color="spacing").surfaces[0].values
    np.testing.assert_array_equal(own, colored.quality.spacing)
    plain = rm.SimplicialComplex(
        colored.vertices, colored.simplices, vertex_attributes={"spacing": RGB}
    )
    values = make_scene(plain, color="spacing").surfaces[0].values
    np.testing.assert_array_equal(values, RGB / 255)


def test_a_solid_cut_open():
    ball = rm.datasets.sphere(300, random_state=0)
    ball *= np.random.default_rng(0).random(300)[:, None] ** (1 / 3)
    solid = rm.reconstruct(ball, 3)
    found = make_scene(solid, style="cut", color=ball[:, 0])
    cut, rest = found.surfaces
    half = (len(solid.simplices) + 1) // 2
    assert found.caption == [
        f"Cut: shown are {half:,} of {len(solid.simplices):,} tetrahedra, those behind a plane"
    ]
    # Both halves together are bounded by the boundary and, on either side, by the cut.
    rim = len(scene.open_faces(solid.simplices))
    shared = (len(cut.triangles) + len(rest.triangles) - rim) / 2
    assert shared == int(shared) > 20
    assert cut.opacity == 1 > rest.opacity
    assert {*cut.values.tolist()} <= {*ball[:, 0].tolist()}
    # What is left lies behind.
    behind, before = (
        s.points[s.triangles].mean(axis=1) @ scene.TOWARDS for s in (cut, rest)
    )
    assert behind.mean() + 0.5 < before.mean()


@pytest.mark.parametrize(
    ("color", "message"),
    [
        ("normals", r"color is 'normals', .* shape \(400, 3\) and holds no colors"),
        (np.zeros((400, 2)), r"color has shape \(400, 2\) and holds no colors"),
        (RGB[:9], r"color has shape \(9, 3\)"),
        ("hue", "color is 'hue', expected one of .*'doubtful', 'colors', 'rgba16'"),
    ],
)
def test_what_is_no_color(colored, color, message):
    with pytest.raises(ValueError, match=message):
        make_scene(colored, color=color)


def test_colors_of_solids_and_curves():
    """Where simplices are drawn apart each corner keeps its color."""
    ball = rm.datasets.sphere(60, random_state=0) * np.linspace(0.2, 1, 60)[:, None]
    solid = rm.reconstruct(ball, 3)
    apart, rim = make_scene(solid, color=RGB[:60]).surfaces
    np.testing.assert_array_equal(
        apart.values, (RGB[:60] / 255)[solid.simplices].reshape(-1, 3)
    )
    assert rim.values.shape == (len(rim.points), 3)
    knot = rm.reconstruct(rm.datasets.trefoil(80, random_state=0), 1)
    (lines,) = make_scene(knot, color=RGB[:80]).lines
    np.testing.assert_array_equal(lines.values, RGB[:80] / 255)
    drawn = knot.plot(color=RGB[:80], show=False).axes[0].collections[0]
    middle = (RGB[:80] / 255)[knot.simplices].mean(axis=1)
    np.testing.assert_allclose(drawn.get_colors()[:, :3], middle)
    track = knot.plot(color=RGB[:80], backend="plotly", show=False).data[0]
    one = "rgb({},{},{})".format(*RGB[knot.simplices[0, 0]])
    assert track.line.color[0] == one


def test_doubtful_samples_and_outliers_are_marked(sparse):
    marks = make_scene(sparse, show_doubtful=True).marks
    (doubtful,) = marks
    np.testing.assert_array_equal(
        doubtful.numbers, np.flatnonzero(sparse.quality.doubtful)
    )
    np.testing.assert_array_equal(doubtful.points, sparse.vertices[doubtful.numbers])
    circle = rm.datasets.circle(100, random_state=0)
    rec = rm.reconstruct(np.vstack([circle, [[0.1, 0.2]]]), 1)
    names = {mark.name: mark for mark in make_scene(rec, show_doubtful=True).marks}
    assert names["outliers"].numbers.tolist() == [100]


def test_samples_stand_where_they_were_given():
    noisy = rm.datasets.add_noise(
        rm.datasets.circle(300, random_state=0), 0.03, random_state=1
    )
    rec = rm.reconstruct(noisy, 1, smooth=True)
    (samples,) = make_scene(rec, show_samples=True).marks
    np.testing.assert_array_equal(samples.points[:, :2], noisy)
    assert abs(rec.vertices - noisy).max() > 0.01


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"color": "red"}, ValueError, "color is 'red'"),
        ({"color": [1, 2]}, ValueError, r"color has shape \(2,\)"),
        ({"color": "spacing"}, ValueError, "needs a Reconstruction"),
        ({"color": "quality"}, ValueError, "sampling_ratio"),
        ({"show_doubtful": True}, ValueError, "needs a Reconstruction"),
        ({"style": "points"}, ValueError, "style is 'points'"),
        ({"backend": "vispy"}, ValueError, "backend is 'vispy'"),
        ({"embedding": "umap"}, ValueError, "embedding is 'umap'"),
        ({"max_simplices": 0}, ValueError, "max_simplices is 0"),
        ({"window_size": (0, 5)}, ValueError, r"window_size\[0\] is 0"),
        ({"screenshot": "a.html"}, ValueError, 'backend="plotly"'),
    ],
)
def test_plot_refuses(options, error, words):
    curve = rm.SimplicialComplex([[0, 0], [1, 0], [1, 1]], [[0, 1], [1, 2]])
    with pytest.raises(error, match=words):
        curve.plot(**{"show": False, **options})
    with pytest.raises(TypeError, match="complex must be"):
        rm.plot([[0, 1]], show=False)


# --- Pictures -----------------------------------------------------------------------


def share_of(path, red, green, blue, tolerance=0.14):
    """Share of the pixels of about this color."""
    image = imread(path)[:, :, :3]
    return (abs(image - [red, green, blue]).max(axis=2) < tolerance).mean()


def drawn(path):
    """Share of the pixels that are not white."""
    return (imread(path)[:, :, :3].min(axis=2) < 0.98).mean()


@pytest.mark.slow
@pytest.mark.parametrize("backend", [PYVISTA, "matplotlib"])
def test_pictures(backend, tmp_path, torus, sparse, rotations, ball):
    path = tmp_path / "picture.png"
    options = {"backend": backend, "screenshot": path, "window_size": (500, 400)}
    torus.plot(**options)
    assert 0.1 < drawn(path) < 0.7
    plain = imread(path)
    torus.plot(color="sampling_ratio", **options)
    assert plain.shape != imread(path).shape or (plain != imread(path)).mean() > 0.05
    sparse.plot(**options)
    without = share_of(path, 0.85, 0.1, 0.17, 0.2)
    sparse.plot(show_doubtful=True, **options)
    assert share_of(path, 0.85, 0.1, 0.17, 0.2) > without + 2e-4
    for rec in (rotations, ball):
        rec.plot(title="in R^9 <b> $x$", **options)
        assert drawn(path) > 0.05
    rotations.plot(style="edges", color="component", **options)
    assert drawn(path) > 0.02


def test_curves_are_drawn_by_matplotlib(tmp_path):
    from matplotlib.figure import Figure

    plane = rm.reconstruct(rm.datasets.circle(60, random_state=0), 1)
    figure = plane.plot(color="sampling_ratio", screenshot=tmp_path / "circle.svg")
    assert isinstance(figure, Figure)
    assert not hasattr(figure.axes[0], "get_zlim")
    assert (tmp_path / "circle.svg").stat().st_size > 1000
    knot = rm.reconstruct(rm.datasets.trefoil(80, random_state=0), 1)
    axes = knot.plot(show=False).axes[0]
    assert hasattr(axes, "get_zlim")
    # What is drawn are the edges.
    (lines,) = axes.collections
    assert len(lines._segments3d) == 80


def test_plotly_figures(torus, rotations):
    figure = torus.plot(backend="plotly", show=False, color="spacing", title="<b>1</b>")
    mesh = figure.data[0]
    assert len(mesh.i) == len(torus.simplices)
    found = np.stack([mesh.x, mesh.y, mesh.z], 1)
    middle = (torus.vertices.max(axis=0) + torus.vertices.min(axis=0)) / 2
    np.testing.assert_allclose(found, torus.vertices - middle, atol=1e-6)
    assert np.stack([mesh.i, mesh.j, mesh.k], 1).tolist() == torus.simplices.tolist()
    assert figure.layout.title.text == "&lt;b&gt;1&lt;/b&gt;"
    own = torus.plot(backend="plotly", show=False, color=RGB).data[0]
    np.testing.assert_array_equal(own.vertexcolor, RGB)
    label = rotations.plot(backend="plotly", show=False).layout.title.text
    assert label.startswith("Geodesic distances from 100 landmarks")


def test_unknown_values_are_gray(torus):
    values = np.arange(400.0)
    values[:7] = np.nan
    mesh = torus.plot(backend="plotly", show=False, color=values).data[0]
    assert mesh.colorscale[0] == (0.0, scene.UNKNOWN_COLOR)
    below = np.asarray(mesh.intensity) < np.nanpercentile(values, 1) - 1
    np.testing.assert_array_equal(below, np.isnan(values))
    assert np.isfinite(mesh.intensity).all()


def test_far_from_the_origin_nothing_trembles():
    points = rm.datasets.torus(300, random_state=0) * 1e-3
    rec = rm.reconstruct(points, 2)
    far = rm.SimplicialComplex(points + 1e5, rec.simplices)
    mesh = far.plot(backend="plotly", show=False).data[0]
    found = np.stack([mesh.x, mesh.y, mesh.z], 1).astype(float)
    true = points - (points.max(axis=0) + points.min(axis=0)) / 2
    np.testing.assert_allclose(found, true, atol=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("what", ["empty", "points", "one triangle"])
def test_the_smallest_complexes(backend, what):
    points = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
    cells = {
        "empty": np.empty((0, 3), int),
        "points": [[0], [2]],
        "one triangle": [[0, 1, 2]],
    }[what]
    assert rm.SimplicialComplex(points, cells).plot(backend=backend, show=False)


def test_a_hundred_thousand_triangles(tmp_path):
    points, triangles = grid(230, 230)
    height = np.sin(points[:, :1] / 20) * 9
    mesh = rm.SimplicialComplex(np.hstack([points, height]), triangles)
    figure = mesh.plot(backend="plotly", screenshot=tmp_path / "page.html")
    assert len(figure.data[0].i) <= 60_000
    text = figure.layout.title.text
    assert re.fullmatch(r"Coarsened for display: [\d,]+ for 104,882 triangles.*", text)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Coarsened for display" in page


# --- What is missing ----------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
def test_missing_packages_are_named(backend, torus, monkeypatch):
    monkeypatch.setitem(sys.modules, backend, None)
    with pytest.raises(ImportError, match=r"pip install remanifold\[plot\]"):
        torus.plot(backend=backend, show=False)


@pytest.fixture
def headless(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.usefixtures("headless")
@pytest.mark.parametrize("backend", ["pyvista", "matplotlib"])
def test_without_a_display_no_window(backend, torus):
    with pytest.raises(OSError, match="no display"):
        torus.plot(backend=backend)


@pytest.mark.usefixtures("headless")
def test_without_anything_to_draw_with(torus, monkeypatch):
    """VTK would end the process."""

    def nothing(name):
        raise OSError(name)

    monkeypatch.setattr(ctypes, "CDLL", nothing)
    with pytest.raises(OSError, match="libegl1"):
        torus.plot(show=False)
    monkeypatch.undo()
    if not RENDERER:
        draw_pyvista.need_renderer()


@rendered
@pytest.mark.usefixtures("headless")
def test_vtk_does_not_warn_of_the_missing_display(torus, tmp_path, capfd):
    torus.plot(screenshot=tmp_path / "torus.png")
    assert capfd.readouterr().err == ""


# --- remanifold view ----------------------------------------------------------------


@pytest.fixture
def mesh_file(tmp_path, torus):
    path = tmp_path / "torus.ply"
    rm.io.write_mesh(path, torus.vertices, torus.simplices)
    return path


def view(*arguments):
    return CliRunner().invoke(app, ["view", *map(str, arguments)])


@rendered
@pytest.mark.parametrize("suffix", [".ply", ".npz", ".vtu", ".obj", ".off", ".stl"])
def test_view_draws_meshes(suffix, tmp_path, torus):
    source, picture = tmp_path / f"mesh{suffix}", tmp_path / "mesh.png"
    rm.io.write_mesh(source, torus.vertices, torus.simplices)
    done = view(source, "--screenshot", picture, "--color", "component")
    assert done.exit_code == 0, done.output
    assert drawn(picture) > 0.1


def test_view_writes_pages_and_projections(tmp_path, mesh_file, rotations):
    page = tmp_path / "mesh.html"
    assert view(mesh_file, "--screenshot", page).exit_code == 0
    assert "plotly" in page.read_text(encoding="utf-8")[:2_000_000].lower()
    archive = tmp_path / "rotations.npz"
    rm.io.write_mesh(archive, rotations.vertices, rotations.simplices)
    page = tmp_path / "rotations.html"
    assert view(archive, "--screenshot", page).exit_code == 0
    text = page.read_text(encoding="utf-8")
    assert "Geodesic distances from 100 landmarks" in text


@pytest.mark.usefixtures("headless")
def test_view_says_what_is_wrong(tmp_path, mesh_file):
    (tmp_path / "bad.ply").write_text("ply\n", encoding="utf-8")
    np.savez(tmp_path / "points.npz", points=np.eye(3))
    for arguments, words in (
        ([tmp_path / "none.ply"], "no such file"),
        ([tmp_path / "bad.ply"], "bad.ply"),
        ([tmp_path / "points.npz"], "no simplices"),
        ([mesh_file], "no display"),
    ):
        done = view(*arguments)
        assert done.exit_code == 1, done.output
        assert words in done.output
        assert "Traceback" not in done.output
    assert view(mesh_file, "--color", "red").exit_code == 2
    colored = tmp_path / "colored.ply"
    mesh = rm.io.read_complex(mesh_file)
    heat = {"heat": mesh.vertices[:, 0]}
    rm.SimplicialComplex(mesh.vertices, mesh.simplices, vertex_attributes=heat).write(
        colored
    )
    done = view(colored, "--color", "heat", "--screenshot", tmp_path / "heat.html")
    assert done.exit_code == 0
    assert "'heat'" in view(colored, "--color", "red").output


def test_captions_hold_no_numbers_but_those_of_the_scene(rotations):
    """The label of a picture and that of the embedding are one."""
    figure = rotations.plot(backend="plotly", show=False, style="edges")
    assert figure.layout.title.text == rm.embed(rotations).label
    assert json.loads(figure.to_json())["layout"]["scene"]["aspectmode"] == "data"
