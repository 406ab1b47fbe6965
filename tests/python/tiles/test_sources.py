# SPDX-License-Identifier: GPL-3.0-or-later
"""Where tiles take samples from, and the one file that they are written to."""

import os

import numpy as np
import pytest

import remanifold as rm
import remanifold.distributed as rd
from remanifold.distributed import _writing
from remanifold.distributed._sources import Source, source_of

COUNTS = (700, 1_100, 200)


def points_of(count, seed):
    return np.round(np.random.default_rng(seed).random((count, 3)) * 100, 2)


def write_las(path, points, seed):
    laspy = pytest.importorskip("laspy")
    pytest.importorskip("lazrs")
    header = laspy.LasHeader(point_format=2, version="1.2")
    header.scales, header.offsets = [0.01] * 3, [0.0] * 3
    las = laspy.LasData(header)
    las.x, las.y, las.z = points.T
    rng = np.random.default_rng(seed)
    las.intensity = rng.integers(0, 1000, len(points))
    las.red, las.green, las.blue = rng.integers(0, 65536, (3, len(points)))
    las.write(path)
    return {"intensity": np.array(las.intensity)}


def write_parquet(path, points, seed):
    arrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    weight = np.random.default_rng(seed).random(len(points))
    columns = {"name": ["a"] * len(points), **dict(zip("xyz", points.T, strict=True))}
    table = arrow.table({**columns, "weight": weight})
    parquet.write_table(table, path, row_group_size=300)
    return {"weight": weight}


def write_zarr(path, points, seed):
    zarr = pytest.importorskip("zarr")
    weight = np.random.default_rng(seed).random(len(points))
    group = zarr.open(str(path), mode="w")
    for name, array in (("points", points), ("weight", weight)):
        made = group.create_dataset if zarr.__version__ < "3" else group.create_array
        made(name, shape=array.shape, dtype=array.dtype, chunks=(128, 3)[: array.ndim])
        group[name][:] = array
    return {"weight": weight}


def write_npy(path, points, _seed):
    np.save(path, points)
    return {}


WRITERS = {
    ".npy": write_npy,
    ".las": write_las,
    ".laz": write_las,
    ".parquet": write_parquet,
    ".zarr": write_zarr,
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("suffix", WRITERS)
def test_rows_of_a_folder(tmp_path, suffix):
    pieces = [points_of(count, seed) for seed, count in enumerate(COUNTS)]
    said = [
        WRITERS[suffix](tmp_path / f"tile-{i}{suffix}", points, i)
        for i, points in enumerate(pieces)
    ]
    (tmp_path / "readme.txt").write_text("no samples")
    source, identity = source_of(tmp_path, tmp_path)
    points = np.concatenate(pieces)
    assert source.shape() == points.shape
    assert len(identity["files"]) == len(COUNTS)
    assert Source.of(source.said()) == source
    for begin, end in ((0, 2_000), (690, 710), (1_799, 1_801), (650, 1_900), (5, 5)):
        np.testing.assert_allclose(
            source.read(begin, end), points[begin:end], atol=1e-9
        )
        if end > begin:
            found = source.attributes(begin, end)
            for name in said[0]:
                expected = np.concatenate([one[name] for one in said])[begin:end]
                np.testing.assert_array_equal(found[name], expected)
    if suffix in (".las", ".laz"):
        assert source.attributes(0, 3)["colors"].shape == (3, 3)


def test_only_what_all_files_have_is_carried(tmp_path):
    write_parquet(tmp_path / "a.parquet", points_of(30, 0), 0)
    write_npy(tmp_path / "b.npy", points_of(30, 1), 1)
    source, _ = source_of(tmp_path, tmp_path)
    assert source.shape() == (60, 3)
    assert source.attribute_names() == []


def test_files_that_do_not_go_together(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((5, 3)))
    np.save(tmp_path / "b.npy", np.zeros((5, 2)))
    with pytest.raises(ValueError, match=r"b\.npy has 2 coordinates, and .*a\.npy 3"):
        source_of(tmp_path, tmp_path)


def test_a_folder_without_samples(tmp_path):
    with pytest.raises(FileNotFoundError, match="a folder without a file of"):
        source_of(tmp_path, tmp_path)


def test_columns_without_names_of_coordinates(tmp_path):
    arrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(arrow.table({"u": [1.0], "w": [2.0]}), tmp_path / "a.parquet")
    with pytest.raises(ValueError, match="call these x, y, z"):
        source_of(tmp_path / "a.parquet", tmp_path)


def test_damaged_files(tmp_path):
    path = tmp_path / "a.laz"
    write_las(path, points_of(500, 0), 0)
    path.write_bytes(path.read_bytes()[:-2_000])
    with pytest.raises(ValueError, match=r"a\.laz.* is damaged"):
        source_of(path, tmp_path)


def test_a_file_that_changes_during_the_run(tmp_path):
    path = tmp_path / "a.npy"
    np.save(path, np.zeros((5, 3)))
    source, _ = source_of(path, tmp_path)
    source.read(0, 5)
    at = path.stat()
    os.utime(path, ns=(at.st_atime_ns, at.st_mtime_ns + 1))
    with pytest.raises(rd.ChangedSourceError, match=r"a\.npy has changed"):
        source.read(0, 5)


def test_piecewise_is_as_at_once(tmp_path, monkeypatch):
    said = write_las(tmp_path / "a.las", points_of(900, 0), 0)
    source, _ = source_of(tmp_path / "a.las", tmp_path)
    rows = np.sort(np.random.default_rng(1).integers(0, 900, (50, 3)), axis=1)
    fields = source.attributes(0, 900)
    assert {"intensity", "colors"} <= set(fields)
    np.testing.assert_array_equal(fields["intensity"], said["intensity"])
    rm.io.write_mesh(tmp_path / "once.ply", source.read(0, 900), rows, fields=fields)
    monkeypatch.setattr(_writing, "VERTICES", 200)
    blocks = iter([rows[:20], rows[20:]])
    _writing.write_ply(
        tmp_path / "pieces.ply", source, 900, 2, 50, blocks, with_attributes=True
    )
    once, pieces = (tmp_path / f"{n}.ply" for n in ("once", "pieces"))
    assert once.read_bytes() == pieces.read_bytes()


@pytest.mark.parametrize(
    ("name", "dim", "ambient_dim", "count", "words"),
    [
        ("a.vtu", 2, 3, 9, "written as .ply"),
        ("a.ply", 3, 3, 9, "dimension 3 in R\\^3"),
        ("a.ply", 2, 4, 9, "dimension 2 in R\\^4"),
        ("a.ply", 2, 3, 2**31, "no room for numbers of 2,147,483,648 vertices"),
    ],
)
def test_what_a_mesh_does_not_hold(tmp_path, name, dim, ambient_dim, count, words):
    with pytest.raises(ValueError, match=words):
        _writing.check_mesh(tmp_path / name, dim, ambient_dim, count)
