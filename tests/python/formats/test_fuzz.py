# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of every format, cut short and with bits turned over: one clear line, always."""

from __future__ import annotations

import bz2
import gzip
import importlib.util
import lzma
import re
import warnings
from pathlib import Path

import laspy
import numpy as np
import pytest

import remanifold as rm
from remanifold.formats.reading import READERS, WITH_SIMPLICES
from remanifold.formats.writing import MESH_WRITERS, POINT_WRITERS, WRITERS
from remanifold.io import read, read_complex, read_points, write_mesh, write_points

RNG = np.random.default_rng(4)
POINTS = RNG.normal(size=(20, 3))
TRIANGLES = np.sort(RNG.permuted(np.tile(np.arange(20), (12, 1)), axis=1)[:, :3])
FIELDS = {
    "colors": RNG.integers(0, 256, (20, 3)).astype(np.uint8),
    "normals": POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True),
    "id": np.arange(20) + 2**60,
}
NEEDS = {".e57": "pye57", ".parquet": "pyarrow"}


def whole(suffix, path):
    """Write a file of this format, with fields where it has them."""
    if suffix in MESH_WRITERS:
        held = {n: a for n, a in FIELDS.items() if WRITERS[suffix].fields is True}
        write_mesh(path, POINTS, TRIANGLES, fields=held)
    elif suffix in POINT_WRITERS:
        held = FIELDS if WRITERS[suffix].fields is True else {}
        write_points(path, POINTS, fields=held)
    elif suffix in (".las", ".laz"):
        cloud = laspy.LasData(laspy.LasHeader(point_format=2, version="1.2"))
        cloud.header.scales = [0.001] * 3
        cloud.x, cloud.y, cloud.z = POINTS.T
        cloud.write(path)
    elif suffix == ".e57":
        import pye57

        with pye57.E57(str(path), mode="w") as file:
            axes = {f"cartesian{axis}": POINTS[:, i] for i, axis in enumerate("XYZ")}
            file.write_scan_raw(axes)
    else:
        path.write_bytes(TEXTS[suffix])


def rows(separator=" "):
    return [separator.join(map(repr, row)) for row in POINTS.tolist()]


def pcd(kind, body):
    head = "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 20\n"
    head += f"HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 20\nDATA {kind}\n"
    return head.encode() + body


HEAD_OF_PTX = "4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1"
TEXTS = {
    ".tsv": "\n".join(["x\ty\tz", *rows("\t")]).encode(),
    ".asc": b"ncols 4\nnrows 5\nxllcorner 1\nyllcorner 2\ncellsize 3\n"
    + b"1.5 2.5 3.5 4.5\n" * 5,
    ".pts": "\n".join(["20", *rows()]).encode(),
    ".ptx": "\n".join([HEAD_OF_PTX, *(f"{row} 0.5" for row in rows())]).encode(),
    ".pcd": pcd("ascii", "\n".join(rows()).encode()),
    ".zarr": b"",
}
MORE = {
    "binary.pcd": pcd("binary", POINTS.tobytes()),
    "molecule.xyz": "\n".join(["20", "", *(f"C {row}" for row in rows())]).encode(),
    "packed.csv.gz": gzip.compress("\n".join(rows(",")).encode(), mtime=0),
    "packed.txt.bz2": bz2.compress("\n".join(rows()).encode()),
    "packed.xyz.xz": lzma.compress("\n".join(rows()).encode()),
    "semicolons.csv": "\n".join(["x;y;z", *rows(";")]).replace(".", ",").encode(),
}


def examples(suffix, folder):
    path = folder / f"whole{suffix}"
    whole(suffix, path)
    yield path
    for name, content in MORE.items():
        if name.endswith(suffix):
            (folder / name).write_bytes(content)
            yield folder / name


def try_all(path):
    """Read a file in all ways; complaints are one line each, and name the file."""
    ways = [read_points, read]
    ways += [read_complex] if path.suffix in WITH_SIMPLICES else []
    complaints = 0
    for way in ways:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", rm.FileWarning)
            try:
                way(path)
            except ValueError as error:
                complaints += 1
                said = str(error)
                assert str(path) in said
                assert "\n" not in said
                assert len(said) < len(str(path)) + 500
                assert not re.search(r"Traceback|<class|object at 0x", said), said
    return complaints


@pytest.mark.parametrize("suffix", [s for s in READERS if s != ".zarr"])
def test_damaged_files_give_one_clear_line(tmp_path, suffix, capfd):
    if suffix in NEEDS and importlib.util.find_spec(NEEDS[suffix]) is None:
        pytest.skip(f"{NEEDS[suffix]} is not installed")
    rng = np.random.default_rng(int.from_bytes(suffix.encode(), "little") % 2**32)
    for path in examples(suffix, tmp_path):
        assert try_all(path) == 0
        data = path.read_bytes()
        bad = tmp_path / f"bad{suffix}"
        complaints = 0
        for size in np.unique(np.linspace(0, len(data) - 1, 60).astype(int)).tolist():
            bad.write_bytes(data[:size])
            complaints += try_all(bad)
        assert complaints
        for _ in range(100):
            spoiled = bytearray(data)
            for place in rng.integers(0, len(data), rng.integers(1, 4)):
                spoiled[place] ^= 1 << rng.integers(8)
            bad.write_bytes(bytes(spoiled))
            try_all(bad)
            # The beginning says how to read the rest.
            spoiled = bytearray(data)
            place = rng.integers(0, min(len(data), 400))
            spoiled[place] = rng.integers(256)
            bad.write_bytes(bytes(spoiled))
            try_all(bad)
    # Nothing is said but by exceptions.
    assert capfd.readouterr() == ("", "")


FOUND = sorted((Path(__file__).parents[2] / "fuzz" / "corpus" / "readers").iterdir())


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.name)
def test_what_fuzzing_found(path):
    """Each was once another error or warning than one clear line; the names say which."""
    assert try_all(path)
