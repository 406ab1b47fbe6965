# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF 2.0, which web pages and Blender show: written in single precision."""

from __future__ import annotations

import base64
import json
import struct
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import byte_colors
from remanifold.formats._mesh import FileMesh

_FLOAT, _UBYTE, _UINT = 5126, 5121, 5125
_VERTICES, _INDICES = 34962, 34963  # what a part of the buffer is for
_MODES = {2: 1, 3: 4}  # lines, triangles
_WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class _Buffer:
    """Arrays one after the other, and their descriptions."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], component: int, target: int) -> int:
        """Append an array; the number of its accessor."""
        data = array.tobytes()
        self.views.append(
            {
                "buffer": 0,
                "byteOffset": len(self.data),
                "byteLength": len(data),
                "target": target,
            }
        )
        self.data += data + b"\0" * (-len(data) % 4)
        width = 1 if array.ndim == 1 else array.shape[1]
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": component,
                "count": len(array),
                "type": _WIDTHS[width],
            }
        )
        return len(self.accessors) - 1


def _scene(mesh: FileMesh) -> tuple[dict[str, Any], bytes]:
    buffer = _Buffer()
    with np.errstate(over="ignore"):
        points = mesh.points.astype("<f4")
    if not np.isfinite(points).all():
        msg = "vertices are too large for glTF, which has single precision"
        raise ValueError(msg)
    position = buffer.add(points, _FLOAT, _VERTICES)
    if len(points):
        buffer.accessors[position]["min"] = points.min(axis=0).tolist()
        buffer.accessors[position]["max"] = points.max(axis=0).tolist()
    attributes = {"POSITION": position}
    for name, array in mesh.fields.items():
        width = 1 if array.ndim == 1 else array.shape[1]
        if name == "normals" and width == 3:
            attributes["NORMAL"] = buffer.add(array.astype("<f4"), _FLOAT, _VERTICES)
        elif name == "uv" and width == 2:  # from the upper left
            places = array.astype("<f4") * [1, -1] + [0, 1]
            attributes["TEXCOORD_0"] = buffer.add(
                places.astype("<f4"), _FLOAT, _VERTICES
            )
        elif (
            name == "colors"
            and byte_colors(array).dtype == np.uint8
            and width in (3, 4)
        ):
            # Four bytes each: vertices begin at multiples of four.
            colors = np.full((len(array), 4), 255, dtype=np.uint8)
            colors[:, :width] = byte_colors(array)
            attributes["COLOR_0"] = buffer.add(colors, _UBYTE, _VERTICES)
            buffer.accessors[-1]["normalized"] = True
        elif width in _WIDTHS:
            # Names that glTF does not define begin with an underscore.
            key = "_" + "".join(c if c.isalnum() else "_" for c in name.upper())
            with np.errstate(over="ignore"):
                values = array.astype("<f4")
            attributes[key] = buffer.add(values, _FLOAT, _VERTICES)
        else:
            msg = f"fields: {name!r} has {width} columns; glTF holds at most 4"
            raise ValueError(msg)
    primitives = [
        {
            "attributes": attributes,
            "indices": buffer.add(cells.astype("<u4").ravel(), _UINT, _INDICES),
            "mode": _MODES[size],
        }
        for size, cells in mesh.cells.items()
    ]
    asset: dict[str, Any] = {"version": "2.0", "generator": "remanifold"}
    if mesh.comment:
        asset["extras"] = {"comment": mesh.comment}
    scene = {
        "asset": asset,
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    }
    return scene, bytes(buffer.data)


def write_gltf(file: IO[bytes], mesh: FileMesh) -> None:
    """Write JSON, with the arrays in it as base64."""
    scene, data = _scene(mesh)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    scene["buffers"] = [{"byteLength": len(data), "uri": uri}]
    file.write(json.dumps(scene).encode())


def write_glb(file: IO[bytes], mesh: FileMesh) -> None:
    """Write the binary form: a chunk of JSON and a chunk of arrays."""
    scene, data = _scene(mesh)
    scene["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    file.write(struct.pack("<4sII", b"glTF", 2, length))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text)
    file.write(struct.pack("<I4s", len(data), b"BIN\0") + data)
