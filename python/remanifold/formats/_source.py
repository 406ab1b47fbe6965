# SPDX-License-Identifier: GPL-3.0-or-later
"""A file to read, or standard input, and messages that say where it is wrong."""

from __future__ import annotations

import codecs
import contextlib
import functools
import io
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, NoReturn, TypeAlias

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import StrPath
from remanifold.formats._packed import is_packed, unpacked

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

_LARGEST = 2**62  # of an index, so that what is computed of it fits as well
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_LONGEST = 300  # characters of a message
_FORTRAN = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[dDqQ]([+-]?\d{1,4})|(?<=\d)([+-]\d{3}))"
)
STANDARD = "-"  # standard input or output


class Source:
    """A file, or standard input read to its end.

    Parameters
    ----------
    path : str or path-like
        The file, or "-".
    suffix : str
        What names its format, in lower case.
    columns : tuple of int and str, optional
        Which columns are the coordinates, where that was said.
    cells : bool
        Whether simplices are wanted.
    """

    def __init__(
        self,
        path: StrPath,
        suffix: str,
        columns: tuple[int | str, ...] | None = None,
        cells: bool = True,
    ) -> None:
        self.suffix = suffix
        self.columns = columns
        self.cells = cells
        self.guesses: list[str] = []  # what was taken for granted and may be wrong
        self.notes: list[str] = []  # what is worth knowing and hardly wrong
        self._path: Path | None = None
        if is_standard(path):
            self.name = "standard input"
            self._held = sys.stdin.buffer.read()
            start = self._held[:8]
        else:
            self._path = Path(path)
            self.name = str(path)
            start = b""
            if self._path.is_file():
                with self._path.open("rb") as file:
                    start = file.read(8)
        if is_packed(start):
            try:
                self._held = unpacked(self.data)
            except ValueError as error:
                self.fail(str(error), error)
            self.__dict__.pop("data", None)
            self._path = None

    def __str__(self) -> str:
        return self.name

    def open(self) -> IO[bytes]:
        """Open it for reading, at its beginning."""
        return io.BytesIO(self._held) if self._path is None else self._path.open("rb")

    @functools.cached_property
    def data(self) -> bytes:
        """All of it."""
        return self._held if self._path is None else self._path.read_bytes()

    @property
    def path(self) -> Path | None:
        """Where it is; None for standard input and what was compressed."""
        return self._path

    def guess(self, what: str) -> None:
        """Say what was taken for granted: once, where the same is found again.

        COLUMNS stands for what decides, in Python or on the command line.
        """
        if what not in self.guesses:
            self.guesses.append(what)

    def note(self, what: str) -> None:
        """Say what is worth knowing."""
        if what not in self.notes:
            self.notes.append(what)

    def decoded(self) -> str:
        """All of it as text: UTF-8, UTF-16 with its mark, or else Latin-1.

        Every byte is a letter of Latin-1; text has no control characters, which tells it
        from what is no text at all.
        """
        data = self.data
        if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            try:
                return data.decode("utf-16")
            except UnicodeDecodeError as error:
                self.fail(f"is no text file, as {self.suffix} files are", error)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            if _CONTROL.search(data):
                self.fail(f"is no text file, as {self.suffix} files are", error)
            self.note("is read as Latin-1, for it is no UTF-8")
            return data.decode("latin-1")
        if "\0" in text and (wide := _utf16(data)) is not None:
            return wide
        if "\0" in text:
            self.fail(f"is no text file, as {self.suffix} files are")
        return text

    @contextmanager
    def text(self) -> Iterator[IO[str]]:
        """Open it as text."""
        try:
            with io.TextIOWrapper(
                self.open(), encoding="utf-8-sig", newline=""
            ) as file:
                yield file
        except UnicodeDecodeError as error:
            self.fail(f"is no text file, as {self.suffix} files are", error)

    @contextmanager
    def on_disk(self) -> Iterator[Path]:
        """Give a path, for readers that take nothing else."""
        if self._path is not None:
            yield self._path
            return
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"input{self.suffix}"
            path.write_bytes(self._held)
            yield path

    def fail(
        self, what: str, cause: BaseException | None = None, line: int | None = None
    ) -> NoReturn:
        """Raise a ValueError that names the file, and the line if it is known."""
        where = self.name if line is None else f"{self.name}, line {line}"
        msg = f"{where}: {_one_line(what)}"
        raise ValueError(msg) from cause

    def floats(self, line: int, fields: list[str], count: int) -> list[float]:
        """Take the first ``count`` fields of a line as numbers."""
        try:
            values = [as_number(field) for field in fields[:count]]
        except ValueError:
            values = []
        if len(values) < count:
            found = " ".join(fields) or "nothing"
            self.fail(f"expected {count} numbers, found {found[:60]!r}", line=line)
        return values

    def count(self, line: int, field: str) -> int:
        """Take a field as a number that is not negative."""
        # No file has a count of more digits, and int() refuses very many.
        if not (field.isascii() and field.isdecimal()) or len(field) > 18:
            self.fail(f"expected a count, found {field[:60]!r}", line=line)
        return int(field)

    def indices(self, line: int, fields: list[str]) -> list[int]:
        """Take fields as integers."""
        try:
            values = [int(field) for field in fields]
        except ValueError:
            values = []
        if len(values) < len(fields) or max(map(abs, values), default=0) > _LARGEST:
            found = " ".join(fields)
            self.fail(f"expected indices, found {found[:60]!r}", line=line)
        return values


def _utf16(data: bytes) -> str | None:
    """Text of UTF-16 without its mark: every other byte of the first ones is zero."""
    start = data[:200]
    for code, zeros in (("utf-16-le", start[1::2]), ("utf-16-be", start[::2])):
        if zeros and len(data) % 2 == 0 and not any(zeros):
            with contextlib.suppress(UnicodeDecodeError):
                text = data.decode(code)
                return None if "\0" in text else text
    return None


def _one_line(what: str) -> str:
    """A message, however other libraries put theirs into it."""
    text = re.sub(r"<[\w.]+ object at 0x[0-9a-f]+>", "something else", what)
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} ..."


def as_number(word: str) -> float:
    """Take a word as a number, also as Fortran writes it: 1.5D+02, 1.5-101.

    Raises
    ------
    ValueError
        It is none.
    """
    try:
        return float(word)
    except ValueError:
        found = _FORTRAN.fullmatch(word.strip())
        if found is None:
            raise
        return float(f"{found[1]}e{found[2] or found[3]}")


def is_standard(path: StrPath) -> bool:
    """Whether a path stands for standard input or output."""
    return os.fspath(path) == STANDARD


def suffix_of(path: StrPath, format: Any, known: tuple[str, ...]) -> str:
    """Suffix that names the format: that of the file, unless a format is given.

    Raises
    ------
    ValueError
        No format by that name, or standard input or output without one.
    """
    if format is not None:
        if not isinstance(format, str):
            msg = f"format must be a word such as 'csv', got {format!r}"
            raise TypeError(msg)
        suffix = "." + format.lower().removeprefix(".")
        if suffix not in known:
            words = ", ".join(word[1:] for word in known)
            msg = f"format is {format!r}, expected one of {words}"
            raise ValueError(msg)
        return suffix
    if is_standard(path):
        msg = "standard input and output have no suffix: name a format, as in 'csv'"
        raise ValueError(msg)
    return Path(path).suffix.lower()


def described(suffix: str) -> str:
    """Name a suffix in a message."""
    return suffix or "a file without a suffix"
