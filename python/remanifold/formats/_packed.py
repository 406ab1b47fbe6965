# SPDX-License-Identifier: GPL-3.0-or-later
"""Files compressed as a whole, by gzip, bzip2 or xz: unpacked into memory, with a limit."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import zlib
from pathlib import Path

from remanifold._base.files import StrPath

# Bytes that Deflate makes of one at most: 258 of two bits. No reader makes more of a byte,
# whatever the file says.
MOST_PER_BYTE = 1032
PACKED = (".gz", ".bz2", ".xz")
_MARKS = (b"\x1f\x8b", b"BZh", b"\xfd7zXZ\0")
# Bytes that xz may ask for: `xz -9` takes 65 MiB, and a header may claim 1.5 GiB.
_XZ_MEMORY = 2**27


def is_packed(start: bytes) -> bool:
    """Whether these first bytes are those of a compressed file."""
    return start.startswith(_MARKS)


def inner_name(path: StrPath) -> StrPath:
    """A name without the suffix that says how the file is compressed."""
    whole = Path(path)
    return whole.with_suffix("") if whole.suffix.lower() in PACKED else path


def unpacked(data: bytes) -> bytes:
    """All bytes of a compressed file.

    Raises
    ------
    ValueError
        It is damaged, cut short, or makes more bytes of each than Deflate could.
    """
    most = MOST_PER_BYTE * len(data)
    try:
        if data.startswith(_MARKS[0]):
            with gzip.open(io.BytesIO(data)) as file:
                content = file.read(most + 1)
        elif data.startswith(_MARKS[1]):
            with bz2.open(io.BytesIO(data)) as packed:
                content = packed.read(most + 1)
        else:
            content = _of_xz(data, most + 1)
    except (OSError, EOFError, zlib.error, lzma.LZMAError) as error:
        msg = f"is compressed, and damaged or truncated ({error})"
        raise ValueError(msg) from error
    if len(content) > most:
        msg = f"is compressed, and makes more than {most:,} bytes of {len(data):,}"
        raise ValueError(msg)
    return content


def _of_xz(data: bytes, most: int) -> bytes:
    content = b""
    while data.startswith(_MARKS[2]) and len(content) < most:
        one = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=_XZ_MEMORY)
        content += one.decompress(data, most - len(content))
        if not one.eof:
            if len(content) < most:
                msg = "it ends before its end mark"
                raise EOFError(msg)
            break
        data = one.unused_data.lstrip(b"\0")  # what pads one stream from the next
    return content
