# SPDX-License-Identifier: GPL-3.0-or-later
"""Nonsense is said at once, one class of warnings for each reason."""

from __future__ import annotations

import warnings

import laspy
import numpy as np
import pytest

import remanifold as rm


def said(*arguments, **options):
    """Warnings of a reconstruction by their classes, and the result."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rec = rm.reconstruct(*arguments, **options)
    assert all(issubclass(w.category, rm.RemanifoldWarning) for w in caught)
    return {w.category: str(w.message) for w in caught}, rec


def test_nothing_is_said_of_what_is_right():
    for name, dim in (("torus", 2), ("sphere", 2), ("ball", 3), ("spherical_cap", 2)):
        points = getattr(rm.datasets, name)(800, random_state=0)
        found, rec = said(points, dim)
        assert not found, name
        assert rec.quality.ok


def test_warnings_point_at_the_caller():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rm.reconstruct(rm.datasets.circle(5, random_state=0), 1)
    assert {w.filename for w in caught} == {__file__}


def test_arrays_that_look_transposed():
    points = rm.datasets.sphere(300, random_state=0)
    found, _ = said(points.T, 2)
    assert "3 samples of 300 coordinates" in found[rm.TransposedWarning]
    assert "if it holds 300 samples, transpose it" in found[rm.TransposedWarning]
    # Few samples in the plane, many samples of many coordinates.
    assert rm.TransposedWarning not in said(points[:8], 2)[0]
    flat = rm.datasets.flat_torus(60, random_state=0)
    wide = np.pad(flat, ((0, 0), (0, 500)))
    assert rm.TransposedWarning not in said(wide, 2)[0]
    assert rm.TransposedWarning not in said(gram=flat[:8] @ flat[:8].T, dim=2)[0]


def test_matrices_that_are_no_points():
    points = rm.datasets.sphere(60, random_state=0) + 1
    away = np.linalg.norm(points[:, None] - points, axis=2)
    found, _ = said(away, 2)
    assert found[rm.MatrixWarning].endswith("diagonal: distances= takes distances")
    found, _ = said(points @ points.T, 2)
    assert (
        "60 rows, as that of inner products is: gram= takes" in found[rm.MatrixWarning]
    )
    with pytest.warns(rm.MatrixWarning, match="distances="):
        rm.estimate_dimension(away)
    # Corners of a simplex, as many samples as coordinates, rounding, a block.
    for other in (np.eye(60), away + 0.1 * np.eye(60)[3], away[:50], -away):
        found, _ = said(other, 2)
        assert rm.MatrixWarning not in found
    found, _ = said(away.astype(np.float32), 2)
    assert rm.MatrixWarning in found
    assert rm.MatrixWarning not in said(distances=away, dim=2)[0]


def depth_image(marks=200, at=(0.0, 0.0, 0.0)):
    """A cap before the camera, among pixels that saw nothing."""
    cap = rm.datasets.spherical_cap(600, random_state=0) + np.array([0, 0, 3])
    points = np.vstack([cap, np.tile(at, (marks, 1))])
    return np.random.default_rng(0).permutation(points)


def test_copies_that_mark_missing_samples():
    points = depth_image()
    first = int(np.argmin(np.abs(points).sum(axis=1)))
    found, rec = said(points, 2)
    assert found[rm.MissingWarning] == (
        f"200 of 800 samples coincide at (0, 0, 0), sample {first} and copies of it, and "
        "count as one: if they mark missing ones, leave them out"
    )
    assert rec.topology().betti_numbers == (1, 0, 0)
    # As another position shows where nothing is, and without positions.
    assert "(1, 2, 9)" in said(depth_image(50, (1.0, 2, 9)), 2)[0][rm.MissingWarning]
    assert rm.MissingWarning in said(gram=points @ points.T, dim=2)[0]
    away = np.linalg.norm(points[:, None] - points, axis=2)
    assert rm.MissingWarning in said(distances=away, dim=2)[0]
    beside = np.vstack([points, np.full((5, 3), np.nan)])
    assert rm.MissingWarning in said(beside, 2, invalid="drop")[0]


def test_copies_that_mark_nothing():
    cap = depth_image(0)
    drawn = np.random.default_rng(1).integers(0, len(cap), 1500)
    turns, heights = np.meshgrid(np.linspace(0, 2 * np.pi, 20), np.linspace(0, 1, 20))
    cone = np.stack([heights * np.cos(turns), heights * np.sin(turns), 1 + heights], -1)
    # A circle and two places that come again and again, as rigid shapes of a molecule do.
    circle = np.pad(rm.datasets.circle(300, random_state=0), ((0, 0), (0, 2)))
    ends = np.repeat([[0.0, 0, 1, 9], [0, 0, -1, 8]], [40, 35], axis=0)
    for points in (
        *(cap, cap[drawn], np.repeat(cap, 5, axis=0), cone.reshape(-1, 3)),
        *(np.vstack([circle, ends]), np.ones((50, 3))),
        *(depth_image(1), np.vstack([cap, cap[:1]])),
    ):
        assert rm.MissingWarning not in said(points, 2)[0]


@pytest.mark.parametrize(
    "suffix",
    [
        ".csv",
        ".npy",
        ".npz",
        ".ply",
        ".pcd",
        ".xyz",
        ".txt",
        ".las",
        ".vtp",
        ".parquet",
    ],
)
def test_marks_in_files(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    if suffix == ".pcd":
        rows = "\n".join(" ".join(map(str, row)) for row in depth_image().tolist())
        path.write_text(
            "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 800\n"
            f"HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 800\nDATA ascii\n{rows}\n"
        )
    elif suffix == ".las":
        cloud = laspy.LasData(laspy.LasHeader(point_format=2, version="1.2"))
        cloud.header.scales = [1e-6] * 3
        cloud.x, cloud.y, cloud.z = depth_image().T
        cloud.write(path)
    else:
        if suffix == ".parquet":
            pytest.importorskip("pyarrow")
        rm.io.write_points(path, depth_image())
    points = rm.io.read_points(path)
    assert len(points) == 800
    assert "200 of 800" in said(points, 2)[0][rm.MissingWarning]


def with_outliers():
    circle = rm.datasets.circle(300, random_state=0)
    return np.vstack([circle, [[0.1, 0.2], [3.0, 1.0]]])


def test_samples_that_were_dropped():
    found, rec = said(with_outliers(), 1)
    assert rec.outliers.tolist() == [300, 301]
    assert found[rm.DroppedWarning] == (
        "2 samples are outliers and were left out; outliers=False keeps all"
    )
    for asked in ("auto", 2.0, False):
        assert rm.DroppedWarning not in said(with_outliers(), 1, outliers=asked)[0]


def test_too_few_samples():
    found, rec = said(rm.datasets.torus(12, random_state=0), 2)
    assert "12 samples are fewer than the 16" in found[rm.DoubtWarning]
    assert "see rec.quality" in found[rm.DoubtWarning]
    assert not rec.quality.ok


def test_close_decisions():
    """A gap in a circle that is as wide as chance leaves it now and then."""
    angles = np.sort(np.random.default_rng(0).uniform(0, 2 * np.pi, 400))
    kept = angles[angles < 2 * np.pi - 0.16]
    found, rec = said(np.stack([np.cos(kept), np.sin(kept)], axis=1), 1)
    assert not rec.quality.ok
    assert "spacings with" in found[rm.DoubtWarning]


def test_a_surface_taken_for_a_solid():
    """Of even samples, of which nothing else tells."""
    points = rm.datasets.sphere(300, random_state=0)
    found, rec = said(points, 3, smooth=False, outliers=False)
    if len(rec.simplices):
        assert "dim=2" in found[rm.DimensionWarning]


@pytest.mark.parametrize(("dim", "other"), [(1, 2), (3, 2)])
def test_other_dimensions(dim, other):
    found, _ = said(rm.datasets.torus(1500, random_state=0), dim)
    assert f"dim={other} may" in found[rm.DimensionWarning]


def shapes():
    for name, shape in rm.datasets.SHAPES.items():
        for count in (40, 90):
            yield pytest.param(name, shape.dim, count, id=f"{name}-{count}")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "dim", "count"), [*shapes()])
def test_what_is_doubted_at_once_is_doubted_in_the_end(name, dim, count):
    try:
        points = rm.datasets.SHAPES[name].generate(count, random_state=1)
    except ValueError:
        pytest.skip("needs more samples")
    found, rec = said(points, dim)
    if rm.DoubtWarning in found:
        assert not rec.quality.ok
        texts = [reason.text for reason in rec.quality.reasons]
        assert any(text in found[rm.DoubtWarning] for text in texts)


def test_each_can_be_silenced_alone():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", rm.DroppedWarning)
        rm.reconstruct(with_outliers(), 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error", rm.DroppedWarning)
        with pytest.raises(rm.DroppedWarning):
            rm.reconstruct(with_outliers(), 1)
