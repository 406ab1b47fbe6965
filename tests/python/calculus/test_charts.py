# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts: how far from isometric, there and back, and from one to another."""

import pickle

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import cube, known_by
from remanifold.calculus import unrolling
from remanifold.calculus.operators import Operators


def bent(per_side):
    """A square rolled to three quarters of a prism, and where it was in the plane."""
    flat = cube(per_side, 2)
    s, height = flat.vertices.T * [[1.5 * np.pi], [2.0]]
    places = np.stack([np.cos(s), np.sin(s), height], axis=1)
    chord = 2 * np.sin(0.75 * np.pi / per_side) * per_side / (1.5 * np.pi)
    return (
        rm.SimplicialComplex(places, flat.simplices),
        np.stack([s * chord, height], axis=1),
    )


def apart(places):
    return np.linalg.norm(places[:, None] - places, axis=2)


MANIFOLDS = {
    "torus": (lambda: rm.datasets.torus(400, random_state=0), 2),
    "Klein bottle": (lambda: rm.datasets.klein_bottle(700, random_state=0), 2),
    "3-sphere": (lambda: rm.datasets.sphere(80, dim=3, random_state=0), 3),
    "circle": (lambda: rm.datasets.circle(50, random_state=0), 1),
    "components": (
        lambda: np.concatenate(
            [
                np.add(rm.datasets.sphere(150, random_state=i), [9 * i, 0, 0])
                for i in (0, 1)
            ]
        ),
        2,
    ),
}


@pytest.fixture(scope="module", params=MANIFOLDS)
def manifold(request):
    draw, dim = MANIFOLDS[request.param]
    return rm.reconstruct(draw(), dim)


def limit_of(manifold):
    """Few samples of a 3-sphere lie far apart."""
    return 4.0 if manifold.dim == 3 else 2.0


@pytest.fixture(scope="module")
def atlas(manifold):
    return manifold.calculus.charts(max_distortion=limit_of(manifold))


def test_progress_and_an_end_in_between(manifold):
    """Each step from nothing to all of it; what a callback raises ends the work."""
    told = []
    options = {"max_distortion": limit_of(manifold)}
    manifold.calculus.charts(progress=lambda *now: told.append(now), **options)
    for step in ("charts", "joining charts"):
        rows = [(done, total) for name, done, total in told if name == step]
        assert rows[0][0] == 0
        assert rows == sorted(rows)
        assert rows[-1][0] == rows[-1][1] > 0
    assert told[0][2] == len(manifold.simplices)

    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        manifold.calculus.charts(progress=stop, **options)


@pytest.mark.parametrize("method", ["auto", "conformal", "tangent"])
def test_charts_cover_and_distort_no_more_than_allowed(manifold, atlas, method):
    if method == "conformal" and manifold.dim != 2:
        pytest.skip("for surfaces")
    if method != "auto":
        atlas = manifold.calculus.charts(method, max_distortion=limit_of(manifold))
    assert atlas.distortion <= limit_of(manifold)
    assert sorted(set(atlas.labels.tolist())) == list(range(len(atlas)))
    for number, chart in enumerate(atlas.charts):
        assert np.isin(np.flatnonzero(atlas.labels == number), chart.simplices).all()
        assert (chart.stretches > 0).all()
        # What the stretches say holds of the edges.
        corners = manifold.simplices[chart.simplices]
        places = chart.coordinates[np.searchsorted(chart.vertices, corners)]
        points = manifold.vertices[corners]
        for i in range(manifold.dim):
            found = np.linalg.norm(places[:, i] - places[:, i + 1], axis=1)
            own = np.linalg.norm(points[:, i] - points[:, i + 1], axis=1)
            assert (found / own <= chart.stretches[:, -1] + 1e-9).all()
            assert (found / own >= chart.stretches[:, 0] - 1e-9).all()


def test_there_and_back(manifold, atlas):
    points = manifold.sample(200, random_state=0)
    there = atlas.transform(points)
    back = atlas.inverse_transform(there.charts, there.coordinates)
    np.testing.assert_allclose(back, points.points, atol=1e-9)
    assert atlas.locate(there.charts, there.coordinates).distances.max() < 1e-9
    # New points by their nearest ones.
    new = points.points * 1.01
    found = atlas.transform(new)
    near = manifold.project(new)
    np.testing.assert_array_equal(found.distances, near.distances)
    back = atlas.inverse_transform(found.charts, found.coordinates)
    np.testing.assert_allclose(back, near.points, atol=1e-9)


def test_transitions(manifold, atlas):
    points = manifold.sample(300, random_state=1)
    there = atlas.transform(points)
    met = 0
    for i in range(len(atlas)):
        own = there.charts == i
        for j in range(len(atlas)):
            other = atlas.transition(i, j, there.coordinates[own])
            both = np.isfinite(other).all(axis=1)
            inside = np.isin(points.simplices[own], atlas.charts[j].simplices)
            assert (both == inside).mean() > 0.99  # but at the edge, by rounding
            back = atlas.inverse_transform(j, other[both])
            np.testing.assert_allclose(back, points.points[own][both], atol=1e-9)
            met += both.sum() if i != j else 0
    assert met > 0
    np.testing.assert_allclose(
        atlas.transition(0, 0, there.coordinates[there.charts == 0]),
        there.coordinates[there.charts == 0],
        atol=1e-9,
    )


def test_what_is_flat_is_unrolled():
    """A prism is flat along its edges: chart and square agree."""
    rolled, flat = bent(20)
    atlas = rolled.calculus.charts()
    assert len(atlas) == 1
    chart = atlas.charts[0]
    assert chart.method == "rigid"
    assert chart.distortion < 1 + 1e-6
    np.testing.assert_allclose(apart(chart.coordinates), apart(flat), atol=1e-6)
    known = known_by("distances", rolled).calculus.charts()
    np.testing.assert_allclose(
        apart(known.charts[0].coordinates), apart(chart.coordinates), atol=1e-6
    )
    with pytest.raises(ValueError, match="has no coordinates"):
        known.inverse_transform(0, [[0.0, 0.0]])
    plane = cube(6, 2, jitter=0.4)
    for method in ("rigid", "conformal", "tangent"):
        assert plane.calculus.charts(method).distortion < 1 + 1e-9
    solid = cube(3, 3, jitter=0.3).calculus.charts()
    assert len(solid) == 1
    assert solid.distortion < 1 + 1e-9


def test_conformal_maps_keep_angles():
    """Of a cap: much nearer to one factor for all directions than the rigid ones."""
    cap = rm.reconstruct(rm.datasets.spherical_cap(1000, random_state=0), 2)
    ratios = {}
    for method in ("rigid", "conformal"):
        atlas = cap.calculus.charts(method, max_distortion=3)
        stretches = np.concatenate([chart.stretches for chart in atlas.charts])
        ratios[method] = np.median(stretches[:, 1] / stretches[:, 0])
    assert ratios["conformal"] < 1.02
    assert ratios["rigid"] > 1.05


def test_nothing_is_turned_over_on_a_circle():
    """Tutte's map: on any disc, whatever the distortion."""
    cap = rm.reconstruct(rm.datasets.spherical_cap(500, random_state=0), 2)
    rim = unrolling.rim_of_disc(cap.simplices)
    operators = Operators(cap)
    stretches = unrolling.stretches_of(operators, unrolling.circular(operators, rim))
    assert (stretches > 0).all()


def test_surfaces_that_are_no_discs_have_no_rim():
    torus = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    assert unrolling.rim_of_disc(torus.simplices) is None
    assert unrolling.rim_of_disc(torus.simplices[1:]) is None
    ring = rm.reconstruct(rm.datasets.annulus(300, random_state=0), 2)
    assert unrolling.rim_of_disc(ring.simplices) is None


def test_where_it_is_no_manifold_charts_end():
    pages = rm.SimplicialComplex(
        [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    )
    atlas = pages.calculus.charts()
    assert len(atlas) == 3
    assert atlas.distortion == pytest.approx(1)


def test_flat_triangles_are_in_charts_too():
    """One between two others: its place follows from theirs."""
    joint = rm.SimplicialComplex(
        [[0, 0], [2, 0], [1, 0], [1, 1], [1, -1]],
        [[0, 1, 2], [0, 2, 3], [2, 1, 3], [0, 1, 4]],
    )
    atlas = joint.calculus.charts()
    assert atlas.distortion < 1.01
    covered = np.unique(np.concatenate([chart.simplices for chart in atlas.charts]))
    assert covered.tolist() == [0, 1, 2, 3]
    points = np.array([[0.5, 0.2], [1.2, -0.3], [1.5, 0.1]])
    there = atlas.transform(points)
    back = atlas.inverse_transform(there.charts, there.coordinates)
    np.testing.assert_allclose(back, points, atol=1e-9)


def test_textures(tmp_path):
    rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    atlas = rec.calculus.charts()
    flat = atlas.texture()
    texture = flat.vertex_attributes["uv"]
    assert 0 <= texture.min() < texture.max() <= 1
    np.testing.assert_array_equal(
        flat.vertices, rec.vertices[flat.vertex_attributes["vertex"]]
    )
    rows = flat.vertex_attributes["vertex"][flat.simplices]
    np.testing.assert_array_equal(
        np.unique(np.sort(rows, axis=1), axis=0),
        np.unique(np.sort(rec.simplices, axis=1), axis=0),
    )
    # No triangle lies on another one, whatever their charts.
    plane = rm.SimplicialComplex(texture, flat.simplices)
    centers = texture[flat.simplices].mean(axis=1)
    assert (plane.project(centers).simplices == np.arange(len(centers))).all()
    for suffix, error in ((".obj", 0), (".glb", 1e-6)):
        path = tmp_path / f"torus{suffix}"
        flat.write(path)
        found = rm.io.read_complex(path).vertex_attributes["uv"]
        np.testing.assert_allclose(found, texture, atol=error)
    with pytest.raises(ValueError, match="textures are for surfaces"):
        cube(2, 3).calculus.charts().texture()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda c: c.charts("flat"), "method is 'flat', expected one of"),
        (
            lambda c: c.charts(max_distortion=1.0),
            "max_distortion is 1.0, expected more",
        ),
        (lambda c: c.charts().inverse_transform(5, [[0, 0]]), r"charts\[0\] is 5"),
        (lambda c: c.charts().inverse_transform([0, 0], [[0, 0]]), "charts has 2"),
        (
            lambda c: c.charts().inverse_transform(0, [0.5]),
            r"coordinates has shape \(1,\)",
        ),
        (lambda c: c.charts().transition(0, 3, [[0, 0]]), r"charts\[1\] is 3"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call(cube(2, 2).calculus)


def test_conformal_maps_are_for_surfaces():
    with pytest.raises(
        ValueError, match='method is "conformal", which is for surfaces'
    ):
        cube(2, 3).calculus.charts("conformal")


def test_an_atlas_can_be_kept():
    atlas = cube(3, 2).calculus.charts()
    again = pickle.loads(pickle.dumps(atlas))
    np.testing.assert_array_equal(
        again.inverse_transform(0, [[0.1, 0.1]]),
        atlas.inverse_transform(0, [[0.1, 0.1]]),
    )
    assert repr(again) == "Atlas(charts=1, dim=2, distortion=1.0)"
