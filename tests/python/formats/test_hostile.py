# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that promise more than they hold, read by a process that has little memory."""

from __future__ import annotations

import base64
import importlib.util
import io
import json
import os
import struct
import subprocess
import sys
import zipfile
import zlib

import laspy
import numpy as np
import pytest

MANY = 4_000_000_000
POINTS = np.random.default_rng(0).normal(size=(20, 3))
ROOM = 256  # MiB that a reader may take beside what is there already
CHILD = """
import json, resource, sys, warnings
import numpy, laspy, lazrs
import remanifold as rm
from remanifold.formats.reading import WITH_SIMPLICES
rm.io  # loads the rest, which takes memory of its own
for name in ("pye57", "zarr"):
    try:
        __import__(name)
    except ImportError:
        pass
warnings.simplefilter("ignore")
numpy.linalg.pinv(numpy.ones((200, 200)) @ numpy.ones((200, 200)))  # BLAS takes its own
with open("/proc/self/statm") as file:
    size = int(file.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + int(sys.argv[1]) * 2**20,) * 2)
said = {}
for path in sys.argv[2:]:
    ways = [rm.io.read_points, rm.io.read]
    ways += [rm.io.read_complex] if path.endswith(WITH_SIMPLICES) else []
    for way in ways:
        try:
            way(path)
            said.setdefault(path, []).append("read")
        except BaseException as error:
            said.setdefault(path, []).append(f"{type(error).__name__}: {error}")
print(json.dumps(said))
"""


def head_of_npy(shape, kind="<f8"):
    head = io.BytesIO()
    about = {"descr": kind, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(head, about)
    return head.getvalue()


def npz(**members):
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name.replace("__", "."), content)
    return held.getvalue()


def false_size(archive, size):
    """An archive whose directory and members say another size."""
    data = bytearray(archive)
    with zipfile.ZipFile(io.BytesIO(archive)) as held:
        for info in held.infolist():
            struct.pack_into("<I", data, info.header_offset + 22, size)
    place = data.find(b"PK\1\2")
    while place >= 0:
        struct.pack_into("<I", data, place + 24, size)
        place = data.find(b"PK\1\2", place + 1)
    return bytes(data)


def tree(**arrays):
    result = {name: {"array": value} for name, value in arrays.items()}
    about = {"format": 1, "version": "1", "digest": "", "result": result, "cached": {}}
    return json.dumps(about)


AXES = "property double x\nproperty double y\nproperty double z\n"
FACES = "property list uint int vertex_indices\n"


def ply(encoding, elements, body):
    return f"ply\nformat {encoding} 1.0\n{elements}end_header\n".encode() + body


def pcd(count, kind, body, width=1):
    head = f"VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT {width} 1 1\n"
    head += f"WIDTH {count}\nHEIGHT 1\nPOINTS {count}\nDATA {kind}\n"
    return head.encode() + body


def vtk(kind, count, rest, body=b""):
    head = f"# vtk DataFile Version 3.0\nt\n{kind}\nDATASET POLYDATA\nPOINTS {count} double\n"
    return head.encode() + POINTS.astype(">f8").tobytes() + rest.encode() + body


def xml(kind, counts, array, more="", compressed=False):
    how = 'compressor="vtkZLibDataCompressor"' if compressed else ""
    start = (
        f'<VTKFile type="{kind}" header_type="UInt64" {how}><{kind}><Piece {counts}>'
    )
    points = f'<Points><DataArray type="Float64" NumberOfComponents="3" {array}'
    end = f"</DataArray></Points>{more}</Piece></{kind}></VTKFile>"
    return f"{start}{points}{end}".encode()


TEXT = 'format="ascii">' + " ".join(map(repr, POINTS.ravel().tolist()))


def blocks(number, promised, content):
    part = zlib.compress(content)
    head = struct.pack("<QQQ", number, promised, 0)
    head += struct.pack("<Q", len(part)) * number
    words = base64.b64encode(head) + base64.b64encode(part * number)
    return 'format="binary">' + words.decode()


def gltf(count, nodes=1, content=None):
    accessor = {"componentType": 5126, "type": "VEC3", "count": count}
    scene = {
        "asset": {"version": "2.0"},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [accessor],
        "nodes": [{"mesh": 0}] * nodes,
        "scenes": [{"nodes": [*range(nodes)]}],
    }
    if content is not None:
        accessor["bufferView"] = 0
        words = base64.b64encode(content).decode()
        scene |= {"bufferViews": [{"buffer": 0}]}
        scene |= {"buffers": [{"uri": f"data:,{words}"}]}
    return json.dumps(scene).encode()


def las(change, compressed=False):
    cloud = laspy.LasData(laspy.LasHeader(point_format=6, version="1.4"))
    cloud.header.scales = [0.001] * 3
    cloud.x, cloud.y, cloud.z = POINTS.T
    held = io.BytesIO()
    cloud.write(held, do_compress=compressed)
    data = bytearray(held.getvalue())
    change(data)
    return bytes(data)


def set_count(data):
    struct.pack_into("<Q", data, 247, MANY)


def set_chunks(data):
    (start,) = struct.unpack_from("<I", data, 96)
    (table,) = struct.unpack_from("<q", data, start)
    struct.pack_into("<I", data, table + 4, MANY)


def lines(row, count=20):
    return (row + "\n").encode() * count


BOMB = '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b0 "bbbbbbbbbbbbbbbb">' + "".join(
    f'<!ENTITY b{i} "{f"&b{i - 1};" * 10}">' for i in range(1, 12)
)
BAD = {
    "shape.npy": head_of_npy((MANY, 3)) + POINTS.tobytes(),
    "overflow.npy": head_of_npy((2**62, 4)) + POINTS.tobytes(),
    "negative.npy": head_of_npy((-1, 3)) + POINTS.tobytes(),
    "shape.npz": npz(points__npy=head_of_npy((MANY, 3)) + POINTS.tobytes()),
    "size.npz": false_size(
        npz(points__npy=head_of_npy((2**27, 3)) + POINTS.tobytes()), 2**32 - 2
    ),
    "shape.rm.npz": npz(
        remanifold__json=tree(vertices="v"),
        v__npy=head_of_npy((MANY, 3)) + POINTS.tobytes(),
    ),
    "vertices.ply": ply(
        "binary_little_endian", f"element vertex {MANY}\n{AXES}", POINTS.tobytes()
    ),
    "text.ply": ply("ascii", f"element vertex {MANY}\n{AXES}", lines("1 2 3")),
    "before.ply": ply(
        "ascii", f"element a {MANY}\nelement vertex 20\n{AXES}", lines("1 2 3")
    ),
    "list.ply": ply(
        "binary_little_endian",
        f"element face 2\n{FACES}element vertex 20\n{AXES}",
        struct.pack("<I", 2**31) + POINTS.tobytes(),
    ),
    "text.pcd": pcd(MANY, "ascii", lines("1 2 3")),
    "binary.pcd": pcd(MANY, "binary", POINTS.tobytes()),
    "record.pcd": pcd(20, "binary", POINTS.tobytes(), width=1_000_000),
    "packed.pcd": pcd(
        178_956_970,
        "binary_compressed",
        struct.pack("<II", 100, 4_294_967_280) + bytes(100),
    ),
    "binary.vtk": vtk("BINARY", MANY, ""),
    "text.vtk": vtk("ASCII", MANY, ""),
    "points.vtu": xml("UnstructuredGrid", f'NumberOfPoints="{MANY}"', TEXT),
    "block.vtu": xml(
        "UnstructuredGrid",
        f'NumberOfPoints="{MANY}"',
        blocks(1, 10**12, bytes(480)),
        compressed=True,
    ),
    "blocks.vtu": xml(
        "UnstructuredGrid",
        'NumberOfPoints="20"',
        blocks(64, 2**24, bytes(2**24)),
        compressed=True,
    ),
    "entities.vtu": (
        BOMB + ']><VTKFile type="UnstructuredGrid">&b11;</VTKFile>'
    ).encode(),
    "points.vtp": xml("PolyData", f'NumberOfPoints="{MANY}"', TEXT),
    "facets.stl": bytes(80) + struct.pack("<I", MANY) + bytes(100),
    "vertices.off": f"OFF\n{MANY} {MANY} 0\n".encode() + lines("1 2 3"),
    "dimension.off": f"nOFF\n{MANY} {MANY} {MANY} 0\n".encode() + lines("1 2 3"),
    "zeros.gltf": gltf(2**31),
    "nodes.gltf": gltf(50_000, 5000, bytes(12 * 50_000)),
    "atoms.xyz": f"{MANY}\n\n".encode() + lines("C 1 2 3"),
    "points.pts": f"{MANY}\n".encode() + lines("1 2 3"),
    "cells.asc": f"ncols {MANY}\nnrows {MANY}\ncellsize 1\n1 2\n".encode(),
    "endless.asc": b"ncols inf\nnrows 2\ncellsize 1\n1 2\n",
    "pixels.ptx": f"{MANY}\n{MANY}\n".encode()
    + b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n",
    "points.las": las(set_count),
    "points.laz": las(set_count, compressed=True),
    "records.las": las(lambda data: struct.pack_into("<I", data, 100, MANY)),
    "chunks.laz": las(set_chunks, compressed=True),
}
# Simplices that there are not: the points are read, the complex is not.
BAD_CELLS = {
    "faces.ply": ply(
        "binary_little_endian",
        f"element vertex 20\n{AXES}element face {MANY}\n{FACES}",
        POINTS.tobytes() + struct.pack("<I", MANY),
    ),
    "polygons.vtk": vtk("BINARY", 20, f"\nPOLYGONS {MANY} {4 * MANY}\n", bytes(100)),
    "few.vtk": vtk("BINARY", 20, f"\nPOLYGONS {MANY} 20\n", bytes(100)),
    "values.vtk": vtk("BINARY", 20, f"\nPOINT_DATA {MANY}\nSCALARS a double {MANY}\n"),
    "cells.vtu": xml(
        "UnstructuredGrid",
        f'NumberOfPoints="20" NumberOfCells="{MANY}"',
        TEXT,
        "<Cells/>",
    ),
    "faces.off": f"OFF\n20 {MANY} 0\n".encode() + lines("1 2 3") + b"3 0 1 2\n",
    "corner.off": b"OFF\n20 1 0\n" + lines("1 2 3") + f"{MANY} 0 1 2\n".encode(),
    "corner.obj": lines("v 1 2 3") + f"f 1 2 {MANY}\n".encode(),
}


def write_e57(path):
    import pye57

    with pye57.E57(str(path), mode="w") as file:
        axes = {f"cartesian{axis}": POINTS[:, i] for i, axis in enumerate("XYZ")}
        file.write_scan_raw(axes)
    # Pages of 1020 bytes and a checksum each.
    data = path.read_bytes()
    text = b"".join(data[i : i + 1020] for i in range(0, len(data), 1024))
    place, length = struct.unpack_from("<QQ", data, 24)
    start = place // 1024 * 1020 + place % 1024
    xml = text[start : start + length]
    # As long as before: for each letter more one blank less at the beginnings of lines.
    old, new = b'recordCount="20"', f'recordCount="{MANY}"'.encode()
    changed = xml.replace(old, new).replace(b"\n  ", b"\n ", len(new) - len(old))
    assert len(changed) == length
    text = text[:start] + changed + text[start + length :]
    parts = [text[i : i + 1020] for i in range(0, len(text), 1020)]
    path.write_bytes(b"".join(part + crc32c(part).to_bytes(4, "big") for part in parts))


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def write_zarr(path):
    import zarr

    array = zarr.open(str(path), mode="w", shape=(20, 3), chunks=(20, 3), dtype="f8")
    array[:] = POINTS
    # Format 3, or 2 where zarr is older than that.
    file = next(
        name for name in (path / "zarr.json", path / ".zarray") if name.exists()
    )
    about = json.loads(file.read_text())
    if path.stem == "shape":
        about["shape"] = [MANY, 3]
    elif "chunks" in about:
        about["chunks"] = [MANY, 3]
    else:
        about["chunk_grid"]["configuration"]["chunk_shape"] = [MANY, 3]
    file.write_text(json.dumps(about))


def read_with_little_memory(*paths):
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(ROOM), *map(str, paths)],
        capture_output=True,
        text=True,
        check=False,
        # Threads of a reader would each take 128 MiB of addresses, which is no memory.
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What is said of all files, by one process."""
    folder = tmp_path_factory.mktemp("hostile")
    for name, content in {**BAD, **BAD_CELLS}.items():
        (folder / name).write_bytes(content)
    if importlib.util.find_spec("pye57") is not None:
        write_e57(folder / "count.e57")
    if importlib.util.find_spec("zarr") is not None:
        write_zarr(folder / "shape.zarr")
        write_zarr(folder / "chunk.zarr")
    found = read_with_little_memory(*sorted(folder.iterdir()))
    return {path.rpartition("/")[2]: answers for path, answers in found.items()}


@pytest.mark.parametrize("name", [*BAD, "count.e57", "shape.zarr", "chunk.zarr"])
def test_no_memory_for_what_is_only_promised(said, name):
    if name not in said:
        pytest.skip("a package is not installed")
    for answer in said[name]:
        assert answer.startswith("ValueError"), answer
        assert "allocate" not in answer
        assert "\n" not in answer


@pytest.mark.parametrize("name", BAD_CELLS)
def test_no_memory_for_simplices_that_are_only_promised(said, name):
    if not name.startswith("values"):
        assert said[name][0] == "read"
    assert said[name][-1].startswith("ValueError"), said[name]


def test_only_arrays_that_are_needed_are_read(tmp_path):
    """As much as twice the memory that there is lies beside the points, as zeros."""
    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("points.npy", head_of_npy((20, 3)) + POINTS.tobytes())
        archive.writestr("README.txt", "no array")
        with archive.open("junk.npy", "w", force_zip64=True) as member:
            member.write(head_of_npy((2**26,)))
            for _ in range(2**4):
                member.write(bytes(2**25))
    assert read_with_little_memory(path)[str(path)][:2] == ["read", "read"]
