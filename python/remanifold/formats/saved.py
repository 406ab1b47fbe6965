# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstructions in a file, whole: an archive of NumPy's arrays and a tree in JSON.

Nothing in it is run when it is read: the tree names arrays of the archive, and fields of
the classes that are listed here, by which a later version knows what an earlier one wrote.
"""

from __future__ import annotations

import dataclasses
import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from remanifold._base.samples import INPUTS
from remanifold.formats._arrays import archive_array
from remanifold.formats._mesh import FileMesh, comment_lines, finite_part
from remanifold.judging.judged import JudgedReconstruction
from remanifold.judging.quality import Quality, Reason
from remanifold.method.cleaning import Smoothing
from remanifold.method.openings import Opening
from remanifold.method.options import Options
from remanifold.method.provenance import Parameter, Parameters, Provenance
from remanifold.method.result import ReconstructionData
from remanifold.method.steps import EdgeSets, Stars

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from remanifold.formats._source import Source

SUFFIX = ".rm.npz"
TREE = "remanifold.json"  # what tells such an archive from others
FORMAT = 1  # of the tree; one more whenever what was read before would not be any more
_EPOCH = (1980, 1, 1, 0, 0, 0)  # for the same bytes from the same result
# What may be named in a tree; a test says when a class that results hold is missing.
_CLASSES: dict[str, type] = {
    kind.__name__: kind
    for kind in (
        *(EdgeSets, Opening, Options, Parameter, Parameters, Provenance),
        *(Quality, Reason, Smoothing, Stars, *INPUTS),
    )
}
# Computed when asked for, and kept with the result if they have been.
_CACHED = ("edges", "quality", "tangents")


def write_saved(file: IO[bytes], rec: JudgedReconstruction) -> None:
    """Write all of a result."""
    arrays = _Arrays()
    held = {one.name: getattr(rec, one.name) for one in dataclasses.fields(rec)}
    cached = {name: vars(rec)[name] for name in _CACHED if name in vars(rec)}
    if rec.method != "paper":
        cached.pop("edges", None)  # those of the simplices
    tree = {
        "format": FORMAT,
        "version": rec.provenance.version,
        "digest": rec.digest,
        "result": {name: arrays.packed(name, value) for name, value in held.items()},
        "cached": {name: arrays.packed(name, value) for name, value in cached.items()},
    }
    with zipfile.ZipFile(file, "w") as archive:
        text = json.dumps(tree, indent=1, allow_nan=False)
        _add(archive, TREE, text.encode(), compressed=True)
        for name, array in arrays.named.items():
            held_in = io.BytesIO()
            np.save(held_in, array, allow_pickle=False)
            # The digits of coordinates do not compress.
            whole = array.dtype.kind != "f"
            _add(archive, f"{name}.npy", held_in.getbuffer(), compressed=whole)


def _add(
    archive: zipfile.ZipFile, name: str, data: bytes | memoryview, *, compressed: bool
) -> None:
    info = zipfile.ZipInfo(name, _EPOCH)
    info.compress_type = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    archive.writestr(info, data)


class _Arrays:
    """Arrays under their names, each once, and values that refer to them."""

    def __init__(self) -> None:
        self.named: dict[str, NDArray[Any]] = {}
        self._places: dict[tuple[Any, ...], str] = {}

    def packed(self, name: str, value: Any) -> Any:
        """As JSON: what it has no word for is an object with one key."""
        if value is None or isinstance(value, (bool, str)):
            return value
        if isinstance(value, np.ndarray):
            return {"array": self._kept(name, value)}
        if isinstance(value, (int, np.integer)):
            return int(value)
        if isinstance(value, (float, np.floating)):
            number = float(value)
            return number if math.isfinite(number) else {"float": str(number)}
        if isinstance(value, np.bool_):
            return bool(value)
        kind = type(value).__name__
        if _CLASSES.get(kind) is type(value):
            fields = {
                field: self.packed(f"{name}/{field}", one)
                for field, one in _fields(value).items()
            }
            return {kind: fields}
        if isinstance(value, (tuple, list)):
            return [self.packed(f"{name}/{i}", one) for i, one in enumerate(value)]
        if isinstance(value, dict):
            # Names of attributes are any words: numbers are safer as names of files.
            return {
                "dict": [
                    [key, self.packed(f"{name}/{i}", one)]
                    for i, (key, one) in enumerate(value.items())
                ]
            }
        msg = f"{name} is a {kind}, which no file can hold"
        raise TypeError(msg)

    def _kept(self, name: str, array: NDArray[Any]) -> str:
        about = array.__array_interface__
        place = (about["data"][0], array.shape, array.strides, array.dtype.str)
        if array.size == 0 or place not in self._places:
            self.named[name] = array
            self._places[place] = name
            return name
        return self._places[place]


def _fields(value: Any) -> dict[str, Any]:
    if isinstance(value, Parameters):
        return {**value}
    if isinstance(value, tuple):
        named: dict[str, Any] = value._asdict()  # type: ignore[attr-defined]
        return named
    return {one.name: getattr(value, one.name) for one in dataclasses.fields(value)}


def is_saved(file: IO[bytes]) -> bool:
    """Whether this is a saved result; the file is at its beginning again."""
    try:
        with zipfile.ZipFile(file) as archive:
            return TREE in archive.namelist()
    except (OSError, ValueError, NotImplementedError, zipfile.BadZipFile):
        return False
    finally:
        file.seek(0)


def read_saved(
    file: IO[bytes], fail: Callable[..., Any]
) -> tuple[dict[str, Any], dict[str, Any], str]:
    """Fields of a result, those that had been computed, and its digest.

    `fail` raises an error of the words that it is given.
    """
    no_result = (
        "is no saved result, which rec.save() writes; meshes are read by io.read_complex, "
        "samples by io.read_points"
    )
    try:
        if file.read(2) != b"PK":  # a result that was cut short has its beginning
            fail(no_result)
        with zipfile.ZipFile(file) as archive:
            if TREE not in archive.namelist():
                fail(no_result)
            tree = json.loads(archive.read(TREE))
            found = tree["format"]
            if not isinstance(found, int) or found > FORMAT:
                fail(
                    f"was written by remanifold {tree.get('version')} in format {found}; "
                    f"this is remanifold {Provenance.version}, which reads up to {FORMAT}"
                )
            unpack = _Unpacked(archive)
            held = {name: unpack(value) for name, value in tree["result"].items()}
            cached = {name: unpack(value) for name, value in tree["cached"].items()}
            said = str(tree["digest"])
    except OSError:
        raise
    except _REFUSED as error:
        fail(f"is damaged or no saved result ({error})", error)
    known = {one.name for one in dataclasses.fields(ReconstructionData)}
    # What a later version of this format adds is of no use here.
    held = {name: value for name, value in held.items() if name in known}
    cached = {name: value for name, value in cached.items() if name in _CACHED}
    held["openings"] = tuple(held.get("openings", ()))
    held["_decisions"] = tuple(
        (place, is_open) for place, is_open in held.get("_decisions", ())
    )
    if held.get("_frames") is not None:
        held["_frames"] = tuple(held["_frames"])
    _check_numbers(held, fail)
    return held, cached, said


def _check_numbers(held: dict[str, Any], fail: Callable[..., Any]) -> None:
    """Refuse numbers of samples that there are not: compiled code trusts them."""
    required = ("vertices", "simplices", "boundary", "representatives", "provenance")
    for name in required:
        if name not in held:
            fail(f"is no saved result: it has no {name}")
    count = len(held["boundary"])
    if held["vertices"] is not None and len(held["vertices"]) != count:
        fail(f"has {len(held['vertices']):,} vertices and {count:,} samples")
    for name in ("simplices", "representatives", "outliers", "attached", "invalid"):
        numbers = held.get(name)
        if numbers is None:
            continue
        if numbers.dtype != np.int32 or numbers.ndim != (
            2 if name == "simplices" else 1
        ):
            fail(f"has {name} of {numbers.dtype} {numbers.shape}")
        if numbers.size and not 0 <= numbers.min() <= numbers.max() < count:
            fail(
                f"has {name} from {numbers.min()} to {numbers.max()}, of {count:,} samples"
            )


# Whatever stumbles over a damaged file first.
_REFUSED = (
    *(KeyError, IndexError, TypeError, AttributeError, NotImplementedError),
    *(RuntimeError, EOFError, zipfile.BadZipFile, zlib.error, UnicodeDecodeError),
    *(json.JSONDecodeError, RecursionError),
)


class _Unpacked:
    """Turns what stands in a tree into values."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        self._known: dict[str, NDArray[Any]] = {}

    def __call__(self, value: Any) -> Any:
        if isinstance(value, list):
            return [self(one) for one in value]
        if not isinstance(value, dict):
            return value
        (kind, content), *others = value.items()
        if others:
            msg = f"{kind} and {others[0][0]} at once"
            raise TypeError(msg)
        if kind == "array":
            return self._array(content)
        if kind == "float":
            return float(content)
        if kind == "dict":
            return {name: self(one) for name, one in content}
        fields = {name: self(one) for name, one in content.items()}
        made = _CLASSES[kind]
        if made is Parameters:
            return Parameters(fields)
        return made(**_known_fields(made, fields))

    def _array(self, name: str) -> NDArray[Any]:
        if name not in self._known:
            try:
                array = archive_array(self._archive, f"{name}.npy")
            except ValueError as error:
                raise TypeError(*error.args) from error
            array.flags.writeable = False
            self._known[name] = array
        return self._known[name]


def _known_fields(kind: type, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Those that this version knows, with tuples where JSON has lists."""
    known = getattr(kind, "_fields", None) or {
        one.name for one in dataclasses.fields(kind)
    }
    return {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in fields.items()
        if name in known
    }


def mesh_of_saved(source: Source, file: IO[bytes]) -> FileMesh:
    """The complex of a saved result where simplices are wanted, else its samples."""
    held, cached, _ = read_saved(file, source.fail)
    rec = JudgedReconstruction(**held)
    vars(rec).update(cached)
    if rec.vertices is None:
        source.fail("has no coordinates, only inner products or distances")
    assert rec.vertices is not None
    if not source.cells:
        assert rec.samples is not None
        return FileMesh(rec.samples, fields={**rec.vertex_attributes})
    said = comment_lines(rec.comment)
    fields = rec.fields()
    vertices, simplices = rec.vertices, rec.simplices.astype(np.int64)
    if len(rec.invalid):
        rows, simplices = finite_part(vertices, simplices)
        vertices = vertices[rows]
        fields = {**{name: a[rows] for name, a in fields.items()}, "sample": rows}
    return FileMesh(vertices, {rec.dim + 1: simplices}, fields, comment=said)
