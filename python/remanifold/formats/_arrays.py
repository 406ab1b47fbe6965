# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in files: shape and type first, numbers only where wanted and where there are any."""

from __future__ import annotations

import contextlib
import math
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._packed import MOST_PER_BYTE
from remanifold.formats._source import Source

_NPY = ".npy"
_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
    # Differs in how it writes the names of columns, which nothing here looks at.
    (3, 0): np.lib.format.read_array_header_2_0,
}


@dataclass(frozen=True)
class Held:
    """An array of a file: what is known of it, and what reads its numbers."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    read: Callable[[], NDArray[Any]]

    @property
    def ndim(self) -> int:
        """Number of its dimensions."""
        return len(self.shape)

    @property
    def nbytes(self) -> int:
        """Bytes that its numbers take."""
        return math.prod(self.shape) * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0] if self.shape else 0


def read_npy(file: IO[bytes], size: int) -> NDArray[Any]:
    """Read an array from a file of so many bytes, none of them pickled.

    Raises
    ------
    ValueError
        It is none, holds objects, or promises more numbers than there are bytes.
    """
    start = file.tell()
    _header(file, size)
    file.seek(start)
    array: NDArray[Any] = np.load(file, allow_pickle=False)
    return array


def _header(file: IO[bytes], size: int) -> Held:
    """Shape and type, after a look at whether there is room for the numbers."""
    start = file.tell()
    version = np.lib.format.read_magic(file)
    if version not in _HEADERS:
        msg = f"version {version} of the format is not known"
        raise ValueError(msg)
    shape, _, dtype = _HEADERS[version](file)
    held = Held(shape, dtype, lambda: np.empty(0))
    room = size - (file.tell() - start)
    if min(shape, default=0) < 0 or (held.nbytes > room and not dtype.hasobject):
        msg = f"it promises {shape} numbers of {dtype}, and holds {room} bytes"
        raise ValueError(msg)
    return held


def archive_arrays(source: Source, archive: zipfile.ZipFile) -> dict[str, Held]:
    """Arrays of an archive by their names; what is no array is passed over."""
    arrays: dict[str, Held] = {}
    for info in archive.infolist():
        if not info.filename.endswith(_NPY):
            continue
        with damage(source), archive.open(info) as member:
            held = _header(member, member_size(info))
        read = _reader(source, archive, info)
        arrays[info.filename.removesuffix(_NPY)] = Held(held.shape, held.dtype, read)
    return arrays


def _reader(
    source: Source, archive: zipfile.ZipFile, info: zipfile.ZipInfo
) -> Callable[[], NDArray[Any]]:
    def read() -> NDArray[Any]:
        with damage(source):
            return archive_array(archive, info)

    return read


def archive_array(
    archive: zipfile.ZipFile, info: str | zipfile.ZipInfo
) -> NDArray[Any]:
    """Read one array of an archive."""
    if isinstance(info, str):
        info = archive.getinfo(info)
    size = member_size(info)
    with archive.open(info) as member:
        return read_npy(member, size)


def member_size(info: zipfile.ZipInfo) -> int:
    """Bytes of a member of an archive, which its compressed ones can make.

    Raises
    ------
    ValueError
        They cannot, or are compressed in a way that says nothing of it.
    """
    ratio = {zipfile.ZIP_STORED: 1, zipfile.ZIP_DEFLATED: MOST_PER_BYTE}
    if info.compress_type not in ratio:
        msg = f"{info.filename!r} is compressed by other means than Deflate"
        raise ValueError(msg)
    if info.file_size > ratio[info.compress_type] * info.compress_size:
        what = f"{info.file_size} bytes of {info.compress_size} compressed ones"
        msg = f"{info.filename!r} promises {what}"
        raise ValueError(msg)
    return info.file_size


@contextlib.contextmanager
def damage(source: Source) -> Iterator[None]:
    """Refuse a file over which its parser stumbles, wherever it does."""
    try:
        yield
    except MemoryError:
        raise
    # zipfile, zlib, the parser of NumPy's header, ...
    except Exception as error:  # noqa: BLE001
        if "Object arrays" in str(error):
            source.fail(
                "holds Python objects, which are not loaded, for they can run anything: "
                "save numbers, as in array.astype(float)",
                error,
            )
        source.fail(f"is damaged, truncated or no NumPy file ({error})", error)
