# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes along with samples, samples that are no points, normals of the result."""

from __future__ import annotations

import pickle
import re

import numpy as np
import pytest

import remanifold as rm
from remanifold import _core
from remanifold.io import read_complex, read_fields
from remanifold.method import dropping

RNG = np.random.default_rng(3)
TORUS = rm.datasets.torus(400, random_state=0)
# Every seventh is no point, the first ones too.
HOLES = np.flatnonzero((np.arange(460) % 7 == 3) | (np.arange(460) < 3))
VALID = np.setdiff1d(np.arange(460), HOLES)


@pytest.fixture(scope="module")
def depth():
    points = np.full((460, 3), np.nan)
    points[VALID] = rm.datasets.torus(len(VALID), random_state=1)
    points[HOLES[::2], 0] = np.inf
    points[HOLES[1::2], 1:] = 0
    return points


# ----------------------------------------------------------------------- attributes


def attributes(count):
    return {
        "colors": RNG.integers(0, 256, (count, 3)).astype(np.uint8),
        "heat": RNG.normal(size=count),
        "id": np.arange(count) * 2**40,
        "inside": np.arange(count) % 2 == 0,
    }


def test_attributes_stay_with_their_samples(tmp_path):
    """Through merging, smoothing and outliers, into files and back."""
    points = np.vstack([TORUS, TORUS[:5], [[5.0, 5, 5]]])
    given = attributes(406)
    rec = rm.reconstruct(points, 2, attributes=given, smooth=True)
    assert rec.outliers.tolist() == [405]
    assert rec.repair.merged_samples == 5
    for name, values in given.items():
        held = rec.vertex_attributes[name]
        np.testing.assert_array_equal(held, values)
        assert held.dtype == values.dtype
    for suffix in (".ply", ".vtu", ".vtp", ".npz", ".vtk"):
        rec.write(tmp_path / f"a{suffix}")
        found = read_fields(tmp_path / f"a{suffix}")
        assert {*found} == {*given, "boundary", "outlier"}
        for name, values in given.items():
            np.testing.assert_array_equal(found[name], values)
    rec.write(tmp_path / "a.obj")
    assert {*read_fields(tmp_path / "a.obj")} == {"colors"}
    rec.write(tmp_path / "a.glb")
    np.testing.assert_array_equal(
        read_fields(tmp_path / "a.glb")["colors"][:, :3], given["colors"]
    )
    part = rec.subset(rec.simplices[:, 0] < 50)
    np.testing.assert_array_equal(
        part.vertex_attributes["heat"], given["heat"][part.vertex_indices]
    )
    again = pickle.loads(pickle.dumps(rec))
    np.testing.assert_array_equal(again.vertex_attributes["heat"], given["heat"])
    assert not again.vertex_attributes["heat"].flags.writeable


def test_attributes_do_not_change_the_result():
    bare = rm.reconstruct(TORUS, 2)
    rec = rm.reconstruct(TORUS, 2, attributes=attributes(400))
    assert rec.simplices.tobytes() == bare.simplices.tobytes()
    assert bare.vertex_attributes == {}


def test_what_an_older_result_said_is_replaced():
    old = {"boundary": np.ones(400, dtype=bool), "heat": np.ones(400)}
    rec = rm.reconstruct(TORUS, 2, attributes=old)
    fields = rec.fields()
    assert {*fields} == {"boundary", "outlier", "heat"}
    assert not fields["boundary"].any()
    assert rec.vertex_attributes["boundary"].all()


def test_what_is_given_stays_the_callers():
    mine = np.zeros(400)
    rec = rm.reconstruct(TORUS, 2, attributes={"heat": mine})
    mine[0] = 7
    assert mine.flags.writeable
    assert rec.vertex_attributes["heat"][0] == 0


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"a": np.ones(399)}, ValueError, r"attributes\['a'\] has shape \(399,\)"),
        ({"a": ["x"] * 400}, ValueError, r"attributes\['a'\] holds <U1"),
        ([1], TypeError, "attributes must map names to arrays, got list"),
    ],
)
def test_attributes_that_do_not_fit(given, error, message):
    with pytest.raises(error, match=message):
        rm.reconstruct(TORUS, 2, attributes=given)


# ------------------------------------------------------------- samples that are none


def test_a_data_frame_gives_its_columns():
    pandas = pytest.importorskip("pandas")
    points = rm.datasets.circle(50, random_state=0)
    frame = pandas.DataFrame({"x": points[:, 0], "y": points[:, 1], "heat": range(50)})
    rec = rm.reconstruct(frame[["x", "y"]], 1, attributes=frame[["heat"]])
    assert rec.vertex_attributes["heat"].tolist() == [*range(50)]
    frame["word"] = "a"
    with pytest.raises(
        TypeError, match=r"points must hold numbers, points\[0, 3\] is 'a'"
    ):
        rm.reconstruct(frame, 1)
    with pytest.raises(TypeError, match=r"got 'a\.csv'; rm\.io\.read\(\) reads a file"):
        rm.reconstruct("a.csv", 1)


def test_invalid_samples_are_an_error_unless_they_may_go(depth):
    with pytest.raises(
        ValueError,
        match=r'points\[0, 0\] is inf; invalid="drop" leaves such samples out',
    ):
        rm.reconstruct(depth, 2)
    with pytest.raises(ValueError, match="invalid is 'keep', expected one of"):
        rm.reconstruct(depth, 2, invalid="keep")
    with pytest.raises(
        ValueError, match="points has 4 rows and none of finite numbers"
    ):
        rm.reconstruct(np.full((4, 3), np.nan), 2, invalid="drop")


@pytest.mark.parametrize("options", [{}, {"smooth": True}, {"method": "paper"}])
def test_numbers_are_those_of_the_input(depth, options):
    rec = rm.reconstruct(depth, 2, invalid="drop", **options)
    bare = rm.reconstruct(depth[VALID], 2, **options)
    assert rec.invalid.tolist() == HOLES.tolist()
    assert rec.num_samples == 460
    np.testing.assert_array_equal(rec.simplices, VALID[bare.simplices])
    np.testing.assert_array_equal(rec.edges, VALID[bare.edges])
    np.testing.assert_array_equal(rec.samples[VALID], depth[VALID])
    np.testing.assert_array_equal(rec.vertices[VALID], bare.vertices)
    assert np.isnan(rec.vertices[HOLES]).all()
    np.testing.assert_array_equal(rec.boundary[VALID], bare.boundary)
    assert not rec.boundary[HOLES].any()
    np.testing.assert_array_equal(rec.representatives, np.arange(460))
    np.testing.assert_array_equal(rec.tangents[VALID], bare.tangents)
    assert np.isnan(rec.tangents[HOLES]).all()
    for name in (
        "open_faces",
        "unused_vertices",
        "disputed_simplices",
        "callous_faces",
    ):
        found, expected = getattr(rec.repair, name), getattr(bare.repair, name)
        np.testing.assert_array_equal(found, VALID[expected], err_msg=name)
    assert rec.repair.merged_samples == 0
    assert rec.topology().betti_numbers == bare.topology().betti_numbers
    np.testing.assert_array_equal(rec.quality.spacing[VALID], bare.quality.spacing)
    assert np.isnan(rec.quality.spacing[HOLES]).all()
    # But for the number of the sample that it names.
    verdicts = [re.sub(r"sample \d+", "", r.quality.verdict) for r in (rec, bare)]
    assert verdicts[0] == verdicts[1]
    if "method" in options:
        sizes = np.diff(rec.edge_sets.offsets)
        np.testing.assert_array_equal(sizes[VALID], np.diff(bare.edge_sets.offsets))
        assert not sizes[HOLES].any()
        np.testing.assert_array_equal(
            rec.edge_sets.indices, VALID[bare.edge_sets.indices]
        )
        np.testing.assert_array_equal(rec.stars.simplices, VALID[bare.stars.simplices])
        assert (rec.tangent_simplices[HOLES] == -1).all()


def test_what_is_asked_of_a_result_with_invalid_samples(depth, tmp_path):
    given = {"row": np.arange(460)}
    rec = rm.reconstruct(depth, 2, invalid="drop", attributes=given)
    bare = rm.reconstruct(depth[VALID], 2)
    assert rec.volume() == pytest.approx(bare.volume())
    queries = RNG.normal(size=(20, 3))
    np.testing.assert_array_equal(
        rec.project(queries).distances, bare.project(queries).distances
    )
    np.testing.assert_array_equal(rec.vertex_normals[VALID], bare.vertex_normals)
    for method in ("graph", "heat"):
        source = VALID[5]
        found = rec.geodesic_distances(source, method)[0, VALID]
        expected = bare.geodesic_distances(5, method)[0]
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    np.testing.assert_array_equal(rec.vertex_attributes["row"], np.arange(460))
    rec.write(tmp_path / "a.ply")
    found = read_complex(tmp_path / "a.ply")
    np.testing.assert_array_equal(found.vertices, bare.vertices)
    np.testing.assert_array_equal(found.simplices, bare.simplices)
    fields = found.vertex_attributes
    np.testing.assert_array_equal(fields["sample"], VALID)
    np.testing.assert_array_equal(fields["row"], VALID)
    rec.write(tmp_path / "a.obj")
    rec.report(tmp_path / "a.html")
    pytest.importorskip("matplotlib")
    rec.plot(backend="matplotlib", screenshot=tmp_path / "a.png", show_samples=True)


def test_a_mask_for_the_boundary_is_of_all_samples(depth):
    mask = np.zeros(460, dtype=bool)
    rec = rm.reconstruct(depth, 2, invalid="drop", boundary=mask)
    assert rec.topology().betti_numbers == (1, 2, 1)
    with pytest.raises(ValueError, match=r"boundary .* shape \(460,\)"):
        rm.reconstruct(depth, 2, invalid="drop", boundary=mask[VALID])


def test_masked_samples_are_invalid(depth):
    masked = np.ma.masked_invalid(depth)
    rec = rm.reconstruct(masked, 2, invalid="drop")
    assert rec.invalid.tolist() == HOLES.tolist()
    masked = np.ma.array(TORUS, mask=np.zeros(TORUS.shape, dtype=bool))
    masked[7, 1] = np.ma.masked
    assert rm.reconstruct(masked, 2, invalid="drop").invalid.tolist() == [7]


def test_many_coordinates_and_none_invalid(depth):
    wide = np.hstack([depth, np.zeros((460, 30))])
    rec = rm.reconstruct(wide, 2, invalid="drop")
    assert rec.tangents.shape == (460, 2, 33)
    assert np.isnan(rec.tangents[HOLES]).all()
    assert np.isfinite(rec.tangents[VALID]).all()
    same = rm.reconstruct(TORUS, 2, invalid="drop")
    assert len(same.invalid) == 0
    assert same.simplices.tobytes() == rm.reconstruct(TORUS, 2).simplices.tobytes()


def test_every_array_of_the_core_is_renumbered(monkeypatch):
    """A new array has to be named in `dropping`, or it would keep the core's numbers."""
    seen = set()

    def look(name):
        core = getattr(_core, name)

        def call(*arguments, **options):
            result = core(*arguments, **options)
            for part in (result, result.get("repair", {}), result["cleaning"]):
                seen.update(k for k, v in part.items() if isinstance(v, np.ndarray))
            return result

        monkeypatch.setattr(_core, name, call)

    look("reconstruct")
    look("reconstruct_paper")
    rm.reconstruct(TORUS, 2, smooth=True)
    rm.reconstruct(TORUS, 2, method="paper")
    assert seen <= dropping.NUMBERS | {*dropping.ROWS} | dropping.OFFSETS


# -------------------------------------------------------------------------- normals


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_normals_on_spheres_are_exact(dim):
    points = RNG.normal(size=(600, dim + 1))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    rec = rm.reconstruct(points, dim)
    np.testing.assert_allclose(rec.vertex_normals, points, rtol=0, atol=1e-6)


def test_normals_converge_on_a_torus():
    errors = []
    for count in (1000, 4000):
        points = rm.datasets.torus(count, random_state=0)
        normals = rm.reconstruct(points, 2).vertex_normals
        ring = points * [1, 1, 0]
        radius = np.linalg.norm(ring, axis=1, keepdims=True)
        true = points - ring / radius
        true /= np.linalg.norm(true, axis=1, keepdims=True)
        errors.append(
            np.degrees(np.arccos(np.clip((normals * true).sum(1), -1, 1))).mean()
        )
    assert errors[1] < 0.6 * errors[0] < 4


def test_normals_where_there_are_none():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [5, 5, 5]])
    normals = rm.SimplicialComplex(points, [[0, 1, 2], [1, 3, 2]]).vertex_normals
    np.testing.assert_array_equal(normals[:4], np.tile([0, 0, 1], (4, 1)))
    assert np.isnan(normals[4]).all()
    # The second triangle goes round the other way: so do its shared corners.
    normals = rm.SimplicialComplex(points, [[0, 1, 2], [1, 2, 3]]).vertex_normals
    np.testing.assert_array_equal(normals[[0, 3]], [[0, 0, 1], [0, 0, -1]])
    assert np.isnan(normals[[1, 2]]).all()
    with pytest.raises(
        ValueError, match="dimension 1 has normals in 2 coordinates, not 3"
    ):
        _ = rm.SimplicialComplex(points, [[0, 1]]).vertex_normals


def test_results_with_samples_that_are_nowhere_can_be_used(tmp_path):
    """Pixels that saw nothing are NaN among the vertices, and in no simplex."""
    points = rm.datasets.torus(400, random_state=9)
    points[::40] = np.nan
    rec = rm.reconstruct(points, 2, invalid="drop")
    name = rec.topology().name
    fine = rec.subdivide()
    assert fine.topology().name == name
    assert np.flatnonzero(np.isnan(fine.vertices).any(axis=1)).tolist() == [
        *range(0, 400, 40)
    ]
    fine.write(tmp_path / "fine.ply")
    assert rm.io.read_complex(tmp_path / "fine.ply").topology().name == name
    for method in ("pca", "geodesic"):
        assert np.isfinite(rm.embed(rec, method).points[rec.simplices]).all()
    assert np.isfinite(rec.resample(150).volume())
    heights = rec.vertices[:, 2]
    there = rec.interpolate(heights, rec.vertices[1:40])
    np.testing.assert_allclose(there, heights[1:40], atol=1e-12)
    assert rec.calculus.level_set(heights, 0.1).topology().closed
    with pytest.raises(ValueError, match=r"vertices\[40, 0\] is nan"):
        rm.SimplicialComplex(points, [[40, 41, 42]])
