# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF 2.0 and GLB as points, edges and triangles."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import Faces, FileMesh, check_corners, strip_triangles
from remanifold.formats._packed import MOST_PER_BYTE
from remanifold.formats._source import FloatArray, IntArray, Source

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
_WIDTHS = {
    "SCALAR": 1,
    "VEC2": 2,
    "VEC3": 3,
    "VEC4": 4,
    "MAT2": 4,
    "MAT3": 9,
    "MAT4": 16,
}
_COMPRESSED = {"KHR_draco_mesh_compression", "EXT_meshopt_compression"}
_DEEPEST = 100  # nodes within nodes
_MOST = 10_000  # placed primitives


def read_gltf(source: Source, with_fields: bool) -> FileMesh:
    """Read JSON, with buffers in it or in files beside it."""
    try:
        scene = json.loads(source.decoded())
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        source.fail(f"is damaged, truncated or no glTF file ({reason})", error)
    return _read(source, scene, b"", with_fields)


def read_glb(source: Source, with_fields: bool) -> FileMesh:
    """Read the binary form: a chunk of JSON and a chunk of buffers."""
    data = source.data
    if data[:4] != b"glTF" or len(data) < 20:
        source.fail("expected a GLB file, which begins with 'glTF'")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        source.fail(f"is glTF of version {version}, expected 2; export it again")
    if length > len(data):
        source.fail(f"is truncated: expected {length:,} bytes, found {len(data):,}")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, place)
        if place + 8 + size > length:
            source.fail("is damaged or truncated: a chunk is longer than the file")
        chunks.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    try:
        scene = json.loads(chunks.get(b"JSON", b""))
    except (ValueError, RecursionError) as error:
        source.fail(f"is damaged: its JSON cannot be read ({error})", error)
    return _read(source, scene, chunks.get(b"BIN\0", b""), with_fields)


def _read(source: Source, scene: Any, binary: bytes, with_fields: bool) -> FileMesh:
    try:
        return _Scene(source, scene, binary).mesh(with_fields)
    # Any value of damaged JSON may be of any kind.
    except (KeyError, IndexError, TypeError, AttributeError, OverflowError) as error:
        reason = f"{type(error).__name__}: {error}"
        source.fail(f"is damaged: its JSON does not fit together ({reason})", error)


class _Scene:
    """The parsed file and its arrays."""

    def __init__(self, source: Source, scene: Any, binary: bytes) -> None:
        self.source = source
        if not isinstance(scene, dict) or "asset" not in scene:
            source.fail("is no glTF file: its JSON has no 'asset'")
        version = str(scene["asset"].get("version", ""))
        if not version.startswith("2"):
            source.fail(
                f"is glTF of version {version[:20]}, expected 2; export it again"
            )
        needed = {*scene.get("extensionsRequired", ())}
        if needed & _COMPRESSED:
            name = min(needed & _COMPRESSED)
            source.fail(
                f"is compressed by {name}, which is not read; export it without"
            )
        self.scene = scene
        self.binary = binary
        self.buffers: dict[int, bytes] = {}

    def mesh(self, with_fields: bool) -> FileMesh:
        """All primitives where the nodes put them, one after the other."""
        points: list[FloatArray] = []
        held: dict[int, list[IntArray]] = {}
        fields: list[dict[str, NDArray[Any]]] = []
        start = 0
        placed = self._placed()
        self._check_repeats([number for number, _ in placed])
        known: dict[int, int] = {}  # accessors of positions shared by primitives
        for number, matrix in placed:
            known.clear()
            for primitive in self.scene["meshes"][number]["primitives"]:
                where = primitive["attributes"]["POSITION"]
                if where not in known:
                    part = self._vectors(where)
                    points.append(part @ matrix[:3, :3].T + matrix[:3, 3])
                    fields.append(
                        self._fields(primitive["attributes"], matrix)
                        if with_fields
                        else {}
                    )
                    known[where] = start
                    start += len(part)
                if self.source.cells:
                    count = self.scene["accessors"][where]["count"]
                    for found in self._cells(primitive, count):
                        held.setdefault(found.shape[1], []).append(found + known[where])
        if not points:
            self.source.fail("holds no meshes")
        mesh = FileMesh(np.concatenate(points))
        mesh.cells = {size: np.concatenate(parts) for size, parts in held.items()}
        for size, found in mesh.cells.items():
            check_corners(self.source, found.reshape(-1, size), len(mesh.points))
        for name, first in fields[0].items():
            values = [part.get(name) for part in fields]
            if all(v is not None and v.shape[1:] == first.shape[1:] for v in values):
                mesh.fields[name] = np.concatenate(values)  # type: ignore[arg-type]
        return mesh

    def _placed(self) -> list[tuple[int, FloatArray]]:
        """Meshes and their matrices, of the scene that is shown or else all meshes."""
        scenes = self.scene.get("scenes") or []
        if not scenes:
            return [(i, np.eye(4)) for i in range(len(self.scene.get("meshes", ())))]
        roots = scenes[self.scene.get("scene", 0)].get("nodes", [])
        found: list[tuple[int, FloatArray]] = []
        todo = [(node, np.eye(4), 0) for node in reversed(roots)]
        while todo:
            number, outer, depth = todo.pop()
            if depth > _DEEPEST or len(found) > _MOST:
                self.source.fail("is damaged: its nodes contain each other")
            node = self.scene["nodes"][number]
            matrix = outer @ _matrix(node)
            if "mesh" in node:
                found.append((node["mesh"], matrix))
            children = reversed(node.get("children", []))
            todo += [(child, matrix, depth + 1) for child in children]
        return found

    def _check_repeats(self, placed: list[int]) -> None:
        """Refuse few points that are placed so often that no memory holds them."""
        accessors, rows = self.scene["accessors"], 0
        for number in placed:
            primitives = self.scene["meshes"][number]["primitives"]
            positions = {one["attributes"]["POSITION"] for one in primitives}
            rows += sum(accessors[where]["count"] for where in positions)
        size = len(self.source.data)
        if 24 * rows > MOST_PER_BYTE * size:  # buffers beside it may hold more
            number = len(self.scene.get("buffers", ()))
            size += sum(len(self._buffer(i)) for i in range(number))
        if 24 * rows > MOST_PER_BYTE * size:
            what = f"{len(placed):,} meshes of {rows:,} points in {size:,} bytes"
            self.source.fail(f"is damaged, or repeats its meshes too often: {what}")

    def _fields(self, attributes: Any, matrix: FloatArray) -> dict[str, NDArray[Any]]:
        fields: dict[str, NDArray[Any]] = {}
        for key, number in attributes.items():
            if key == "NORMAL":
                # Normals go by the transposed inverse.
                turned = self._vectors(number) @ np.linalg.pinv(matrix[:3, :3])
                length = np.linalg.norm(turned, axis=1, keepdims=True)
                fields["normals"] = turned / np.where(length > 0, length, 1)
            elif key == "COLOR_0":
                fields["colors"] = self._array(number, raw=True)
            elif key == "TEXCOORD_0":  # from the upper left
                fields["uv"] = self._array(number) * [1.0, -1.0] + [0.0, 1.0]
            elif key.startswith("_"):
                values = self._array(number)
                name = key[1:].lower()
                fields[name] = values.ravel() if values.shape[1] == 1 else values
        return fields

    def _cells(self, primitive: Any, count: int) -> list[IntArray]:
        """Edges or triangles of a primitive; none of points."""
        mode = primitive.get("mode", 4)
        if "indices" in primitive:
            array = self._array(primitive["indices"]).ravel()
            if array.dtype.kind not in "iu":
                self.source.fail(
                    "is damaged: the indices of a primitive are no integers"
                )
            corners = array.astype(np.int64)
        else:
            corners = np.arange(count)
        if mode in (1, 4):
            size = 2 if mode == 1 else 3
            return [corners[: len(corners) // size * size].reshape(-1, size)]
        if mode in (2, 3):
            ends = np.column_stack([corners, np.roll(corners, -1)])
            return [ends if mode == 2 else ends[:-1]]
        if mode == 5:
            return [strip_triangles(Faces(corners, np.array([len(corners)])))]
        if mode == 6:
            first = np.full(max(len(corners) - 2, 0), corners[0])
            return [np.column_stack([first, corners[1:-1], corners[2:]])]
        if mode != 0:
            self.source.fail(f"holds a primitive of mode {mode}, which there is none")
        return []

    def _vectors(self, number: int) -> FloatArray:
        """Rows of three numbers, as positions and normals are."""
        array = self._array(number).astype(np.float64)
        if array.shape[1] != 3:
            what = f"{array.shape[1]} numbers"
            self.source.fail(f"is damaged: a position or normal has {what}, expected 3")
        return array

    def _array(self, number: int, raw: bool = False) -> NDArray[Any]:
        """Rows of an accessor; whole numbers that stand for shares are divided."""
        accessor = self.scene["accessors"][number]
        kind = np.dtype("<" + _COMPONENTS[accessor["componentType"]])
        width, count = _WIDTHS[accessor["type"]], accessor["count"]
        if not isinstance(count, int) or not 0 <= count < 1 << 40:
            self.source.fail(f"is damaged: an accessor has {str(count)[:20]} rows")
        if "bufferView" in accessor:
            start = accessor.get("byteOffset", 0)
            array = self._view(accessor["bufferView"], kind, width, count, start)
        else:
            if count > len(self.source.data):  # zeros that nothing in it stands for
                self.source.fail(
                    f"is damaged: an accessor has {count:,} rows of nothing"
                )
            array = np.zeros((count, width), dtype=kind)
        if "sparse" in accessor:
            array = self._sparse(array, accessor["sparse"], kind, width)
        if accessor.get("normalized") and not raw and kind.kind in "iu":
            array = np.maximum(array / np.iinfo(kind).max, -1)
        return np.asarray(array.astype(array.dtype.newbyteorder("=")))

    def _sparse(
        self, array: NDArray[Any], sparse: Any, kind: np.dtype[Any], width: int
    ) -> NDArray[Any]:
        count, where, what = sparse["count"], sparse["indices"], sparse["values"]
        places = self._view(
            where["bufferView"],
            np.dtype("<" + _COMPONENTS[where["componentType"]]),
            1,
            count,
            where.get("byteOffset", 0),
        ).ravel()
        if places.size and int(places.max()) >= len(array):
            self.source.fail("is damaged: a sparse accessor names rows there are not")
        array = array.copy()
        start = what.get("byteOffset", 0)
        array[places] = self._view(what["bufferView"], kind, width, count, start)
        return array

    def _view(
        self, number: int, kind: np.dtype[Any], width: int, count: int, start: int
    ) -> NDArray[Any]:
        view = self.scene["bufferViews"][number]
        data = self._buffer(view["buffer"])
        begin = view.get("byteOffset", 0) + start
        step = view.get("byteStride") or kind.itemsize * width
        last = begin + (count - 1) * step + kind.itemsize * width
        if count and (begin < 0 or step < kind.itemsize or last > len(data)):
            what = f"expected {count:,} rows of an array, which end beyond its data"
            self.source.fail(f"is damaged or truncated: {what}")
        strides = (step, kind.itemsize)
        rows = np.ndarray((count, width), kind, data, begin if count else 0, strides)
        return np.asarray(rows.copy())

    def _buffer(self, number: int) -> bytes:
        if number not in self.buffers:
            self.buffers[number] = self._loaded(self.scene["buffers"][number])
        return self.buffers[number]

    def _loaded(self, buffer: Any) -> bytes:
        uri = buffer.get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except (ValueError, binascii.Error) as error:
                self.source.fail(f"is damaged: a buffer is no base64 ({error})", error)
        folder = self.source.path
        beside = None if folder is None else folder.parent / unquote(uri)
        # Only what lies beside the file: a scene may come from anywhere.
        if beside is None or "/" in uri or "\\" in uri or not beside.is_file():
            self.source.fail(f"needs the file {uri[:80]!r} beside it; save it as .glb")
        return beside.read_bytes()


def _matrix(node: Any) -> FloatArray:
    """Where a node puts what is in it."""
    if "matrix" in node:
        return np.asarray(np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T)
    matrix = np.eye(4)
    if "rotation" in node:
        x, y, z, w = np.array(node["rotation"], dtype=np.float64)
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    if "scale" in node:
        matrix[:3, :3] *= np.array(node["scale"], dtype=np.float64)
    if "translation" in node:
        matrix[:3, 3] = node["translation"]
    return matrix
