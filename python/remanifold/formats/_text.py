# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables in text, whatever separates their numbers and whatever comes before them."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import are_whole
from remanifold.formats._mesh import Table
from remanifold.formats._seems import START, seems
from remanifold.formats._source import Source, as_number

_LINES = re.compile(r"\r\n|\n|\r")
_COMMENT = re.compile(r"\s*(#|//|%)")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eEdD][+-]?\d+)?")
# What stands for no number: also Excel's errors, SAS's point, and what C and Fortran print.
_MISSING = frozenset(
    (
        *("", "na", "n/a", "null", "<null>", "none", "nil", "-", "--", "?", "."),
        *("#n/a", "#na", "#value!", "#div/0!", "#num!", "#null!", "#ref!"),
        *("nan()", "nan(ind)", "-nan(ind)", "nan(snan)", "-nan(snan)"),
    )
)
_NO_NUMBER = re.compile(r"[+-]?1\.#(?:ind|qnan|snan)\d*|\*+", re.IGNORECASE)
_SEPARATOR_LINE = re.compile(r"sep=(.)\s*", re.IGNORECASE)  # Excel's own first line
_BRACKETS = re.compile(r"\s*[\[({].*[\])}]\s*[,;]?\s*")
_NO_BRACKETS = str.maketrans("[](){}", "      ")
_SEPARATORS = {
    ",": "commas",
    ";": "semicolons",
    "\t": "tabs",
    "|": "bars",
    None: "blanks",
}
_MOST_SHOWN = 60
_SAMPLE = 20  # rows that show how a table is written
_MOST_BEFORE = 60  # lines before a table

Rows = Iterator[tuple[int, list[str]]]


@dataclass
class Layout:
    """How a table is written: where it begins, and what separates its cells."""

    start: int  # line, from 0
    separator: str | None  # None for blanks
    comma: bool  # decimal commas
    names: list[str] | None
    expected: int | None = None  # rows, where the file begins with their number
    quoted: bool = False  # decimal commas in quotes, between commas
    said: str = ""  # what was taken for granted


def is_number(cell: str) -> bool:
    """Whether a cell is one."""
    try:
        as_number(cell)
    except ValueError:
        return False
    # float() takes 1_000 too, which no table means.
    return "_" not in cell


def _is_missing(cell: str) -> bool:
    return cell.lower() in _MISSING or _NO_NUMBER.fullmatch(cell) is not None


def split_lines(text: str) -> list[str]:
    """Lines as files end them; others ends are part of a cell."""
    lines = _LINES.split(text)
    if lines and not lines[-1]:
        lines.pop()
    return lines


def read_columns(source: Source, usual: str | None, counted: bool = False) -> Table:
    """Read a table: `usual` separates cells unless the file shows otherwise.

    With `counted` a first line of one whole number is that of the rows.
    """
    # A file of another format may look like a table of words and numbers.
    suffix = seems(source.data[:START])[1]
    if suffix is not None and suffix not in (".csv", ".txt"):
        source.fail("is no table")
    lines = _without_brackets(split_lines(source.decoded()))
    layout = find_layout(lines, usual, counted)
    if layout.said:
        source.guess(layout.said)
    if layout.separator != usual and layout.separator is not None:
        source.note(f"cells are separated by {_SEPARATORS[layout.separator]}")
    if layout.comma:
        source.note("decimals are written with commas")
    columns = _fast(lines, layout)
    if columns is None:
        columns = _careful(source, lines, layout, counted)
    if layout.names is None and _begins_with_sizes(columns):
        source.guess("its first row tells how many rows follow and is left out")
        columns = [column[1:] for column in columns]
    found = len(columns[0]) if columns else 0
    if layout.expected is not None and found < layout.expected:
        source.fail(
            f"is truncated: expected {layout.expected:,} points, found {found:,}"
        )
    if layout.expected is not None and found > layout.expected:
        source.guess(
            f"its first line says {layout.expected:,} points, but there are {found:,}: all "
            "are read"
        )
    return Table(columns, _fitting_names(layout.names, len(columns)))


def _begins_with_sizes(columns: list[NDArray[Any]]) -> bool:
    """Whether a first row is "rows columns 0 ...", as TetGen and Triangle write it."""
    if len(columns) < 3 or any(column.dtype.kind != "f" for column in columns):
        return False
    first = [column[0] for column in columns]
    if first[0] != len(columns[0]) - 1 or first[1] not in (2, 3) or first[0] < 3:
        return False
    rest = np.column_stack(columns)[1:]
    # The others are numbered, from 0 or 1.
    return bool(
        are_whole(np.array(first))
        and rest[0, 0] in (0, 1)
        and (np.diff(rest[:, 0]) == 1).all()
    )


def _fitting_names(names: list[str] | None, count: int) -> list[str] | None:
    if names is None or count == 0:
        return None
    if len(names) == count - 1:  # as R writes them: the first column numbers the rows
        return ["", *names]
    return names[:count] + [""] * (count - len(names))


def find_layout(lines: list[str], usual: str | None, counted: bool) -> Layout:
    """Find separator, decimals, names and the line of the first row."""
    said: list[str] = []  # comments before the table, which may be its names
    expected = None
    start = 0
    if lines and (found := _SEPARATOR_LINE.fullmatch(lines[0])) is not None:
        start, usual = 1, found[1]
    while start < len(lines):
        line = lines[start]
        mark = _COMMENT.match(line)
        if mark is not None:
            said.append(line[mark.end() :])
        elif line.strip():
            if counted and expected is None and (size := _size(lines, start)):
                expected = size
                start += 1
                continue
            if not (counted and expected is None and line.strip().isdecimal()):
                break
            following = next((x for x in lines[start + 1 :] if x.strip()), "")
            if len(line.strip()) > 15 or len(following.split()) == 1:
                break
            expected = int(line)
            if following.strip() and not _has_numbers(following):
                start = lines.index(following, start + 1)  # a comment
        start += 1
    sample = _sample(lines, start)
    separator, comma, quoted = _separator(sample, usual)
    layout = Layout(start, separator, comma, None, expected, quoted)
    if sample:
        _skip_words_before(lines, layout)
        layout.names = _take_names(lines, layout, said)
    return layout


def _without_brackets(lines: list[str]) -> list[str]:
    """Lines of a table whose rows are in brackets, as Python and MATLAB print them."""
    filled = [line for line in lines if line.strip()]
    if not filled or not all(map(_BRACKETS.fullmatch, filled[1 : _SAMPLE + 1])):
        return lines
    inside = [line.translate(_NO_BRACKETS).strip() for line in lines]
    # Of one row too, or units in brackets below names.
    rows = [re.split(r"[\s,;]+", line.rstrip(",; ")) for line in inside if line]
    if not all(map(is_number, [c for row in rows[1 : _SAMPLE + 1] for c in row])):
        return lines
    return [line.rstrip(",; ") for line in inside]


def _sample(lines: list[str], start: int) -> list[str]:
    return [
        x for x in lines[start : start + _SAMPLE] if x.strip() and not _COMMENT.match(x)
    ]


def _numbers(line: str, layout: Layout) -> list[bool]:
    cells = _cells(line, layout.separator)
    return [is_number(_decimal(cell, layout.comma)) for cell in cells]


def _skip_words_before(lines: list[str], layout: Layout) -> None:
    """Begin behind titles and remarks: lines with words, of another width than the rows."""
    places = [
        i
        for i in range(layout.start, min(layout.start + _MOST_BEFORE, len(lines)))
        if lines[i].strip() and not _COMMENT.match(lines[i])
    ]
    # The first of two lines that have as many cells, and numbers in the same ones.
    rows = [_numbers(lines[i], layout) for i in places]
    first = next(
        (k for k in range(len(rows) - 1) if any(rows[k]) and rows[k] == rows[k + 1]), 0
    )
    width = len(rows[first])
    before = [
        k for k in range(first) if abs(len(rows[k]) - width) > 1 and not all(rows[k])
    ]
    if not before or width < 2:
        return
    skipped = before[-1] + 1
    layout.start = places[skipped]
    count = layout.start - places[0]
    layout.said = (
        f"the first {count} lines above the table are left out"
        if count > 1
        else "the first line above the table is left out"
    )
    # They may have had other separators.
    found = _separator(_sample(lines, layout.start), layout.separator)
    layout.separator, layout.comma, layout.quoted = found


def _take_names(lines: list[str], layout: Layout, said: list[str]) -> list[str] | None:
    """Names of the columns; what is below them, such as units, is passed over."""
    sample = _sample(lines, layout.start)
    cells = _cells(sample[0], layout.separator)
    counting = _are_numbers_of_columns(cells, sample[1:])
    if not counting and (any(_numbers(sample[0], layout)) or not any(cells)):
        return (
            _names_in_comment(said[-1], layout.separator, len(cells)) if said else None
        )
    if counting:
        shown = ", ".join(filter(None, cells))
        layout.said = (
            f"its first line, {shown}, is taken for the numbers of the columns"
        )
    while not lines[layout.start].strip() or _COMMENT.match(lines[layout.start]):
        layout.start += 1
    layout.start += 1
    while layout.start < len(lines) and _is_units(lines, layout):
        layout.start += 1
    return cells


def _are_numbers_of_columns(cells: list[str], rows: list[str]) -> bool:
    """Whether a first line is 0, 1, 2, as pandas writes arrays: no point, but names."""
    own = cells[1:] if cells[:1] == [""] else cells
    if len(own) < 2 or own != [str(i) for i in range(len(own))] or not rows:
        return False
    # Whole numbers among whole numbers are numbers.
    return cells[0] == "" or all("." in row for row in rows)


def _size(lines: list[str], start: int) -> int | None:
    """Rows that a line "rows columns" tells of, if it stands above as many columns."""
    found = re.fullmatch(r"\s*(\d{1,15})[\s,;]+(\d{1,6})\s*", lines[start])
    following = next((x for x in lines[start + 1 :] if x.strip()), "").split()
    if found is None or len(following) == 2 or len(following) != int(found[2]):
        return None
    return int(found[1]) if all(map(is_number, following)) else None


def _has_numbers(line: str) -> bool:
    return sum(is_number(word) for word in re.split(r"[\s,;]+", line.strip())) > 1


def _is_units(lines: list[str], layout: Layout) -> bool:
    """Whether a line below the names is one of units, such as [m], or an empty one.

    One of words is, where numbers follow.
    """
    cells = _cells(lines[layout.start], layout.separator)
    if all(re.fullmatch(r"[\[(].*[\])]|", cell) for cell in cells):
        return True
    if (
        len(cells) < 2
        or all(map(_is_missing, cells))
        or lines[layout.start + 1 :] == []
    ):
        return False
    if any(map(_is_missing, filter(None, cells))):
        return False
    above, below = (_numbers(lines[layout.start + i], layout) for i in range(2))
    return not any(above) and any(below) and len(above) == len(below)


def _names_in_comment(text: str, separator: str | None, count: int) -> list[str] | None:
    """Names in a comment above the table, where they are those of coordinates."""
    for names in (_cells(text, separator), text.replace(",", " ").split()):
        folded = [name.lower() for name in names]
        if len(names) == count and (
            {"x", "y"} <= {*folded} or {"x1", "x2"} <= {*folded} or folded[:1] == ["x1"]
        ):
            return names
    return None


def _separator(sample: list[str], usual: str | None) -> tuple[str | None, bool, bool]:
    """What separates cells, and whether decimals are written with commas, in quotes."""
    rows = [line for line in sample if re.search(r"\d", line)] or sample
    if not rows:
        return usual, False, False
    row = rows[-1]
    for mark in (";", "\t", "|"):
        if mark in row and all(mark in line for line in rows):
            cells = [cell.strip() for cell in row.split(mark)]
            comma = any(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)
            if mark == "\t" and usual is None and not comma and "" not in cells:
                return None, False, False  # tabs are blanks
            return mark, comma, False
    words = row.split()
    if len(words) > 1 and all(
        _DECIMAL_COMMA.fullmatch(word) or is_number(word) for word in words
    ):
        comma = any(_DECIMAL_COMMA.fullmatch(word) for word in words)
        return None, comma, False
    if "," in row and (usual == "," or all("," in line for line in rows)):
        quoted = '"' in row and any(map(_DECIMAL_COMMA.fullmatch, _cells(row, ",")))
        return ",", quoted, quoted
    if usual == "," and len(words) > 1 and not any("," in line for line in rows):
        return None, False, False
    return usual, False, False


def _cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    return [cell.strip() for cell in cells]


def _decimal(cell: str, comma: bool) -> str:
    return cell.replace(",", ".") if comma else cell


def _fast(lines: list[str], layout: Layout) -> list[NDArray[Any]] | None:
    """Read numbers and nothing else by NumPy; None where anything is unusual."""
    rows = lines[layout.start :]
    if layout.quoted:
        return None
    if layout.comma:
        rows = [row.replace(",", ".") for row in rows]
    if not rows or any("_" in row for row in rows[:20]):
        return None
    try:
        array = np.loadtxt(
            rows,
            dtype=np.float64,
            comments="#",
            delimiter=layout.separator,
            ndmin=2,
        )
    except (ValueError, OverflowError):
        return None
    return [*array.T] if array.size else None


def _careful(
    source: Source, lines: list[str], layout: Layout, counted: bool
) -> list[NDArray[Any]]:
    """Read row by row, with cells that are missing or words, and say where it breaks."""
    words = _SEPARATORS[layout.separator]
    rows: list[list[str]] = []
    at: list[int] = []
    width = 0
    block = layout.expected
    for number, cells in _rows(source, lines, layout):
        if counted and width > 2 and len(cells) == 1 and cells[0].isdecimal():
            # Another scan begins with the number of its points.
            block = None if block is None else block + int(cells[0][:18])
            layout.expected = block
            continue
        if rows and len(cells) != width:
            if len(cells) == width + 1 and not cells[-1]:
                cells = cells[:-1]
            else:
                culprit = next((c for c in cells if not is_number(c) and c), None)
                what = f"expected {width} numbers as before, found {len(cells)}"
                if culprit is not None and layout.separator is None:
                    culprit = culprit[:_MOST_SHOWN]
                    what = f"expected numbers separated by {words}, found {culprit!r}"
                source.fail(what, line=number)
        width = len(cells)
        rows.append(cells)
        at.append(number)
    if not rows:
        return []
    # With names there may be one column more, which counts the rows.
    named = None if layout.names is None else len(layout.names)
    most = 1 if named is None else named + 1
    if named == width > 1 and not (layout.names or [""])[-1]:
        most = named - 1  # the names end by a separator too
    if width > most and not any(row[-1] for row in rows):
        width -= 1  # a separator at the end of each line
    if named is not None and width > max(most, named):
        what = f"expected {named} numbers, as many as names, found {width}"
        source.fail(what, line=at[0])
    columns = [_column(source, rows, at, i, layout) for i in range(width)]
    if not any(column.dtype.kind == "f" for column in columns):
        shown = rows[0][0][:_MOST_SHOWN]
        what = f"expected numbers separated by {words}, found {shown!r}"
        source.fail(what, line=at[0])
    return columns


def _rows(source: Source, lines: list[str], layout: Layout) -> Rows:
    rest = lines[layout.start :]
    if layout.separator is None:
        for number, line in enumerate(rest, layout.start + 1):
            if not _COMMENT.match(line) and (cells := line.partition("#")[0].split()):
                yield number, cells
        return
    reader = csv.reader(rest, delimiter=layout.separator, skipinitialspace=True)
    try:
        for cells in reader:
            if any(cells) and not _COMMENT.match(cells[0]):
                yield reader.line_num + layout.start, [cell.strip() for cell in cells]
    except csv.Error as error:
        what = f"no text in columns ({error})"
        source.fail(what, error, reader.line_num + layout.start)


def _column(
    source: Source, rows: list[list[str]], at: list[int], i: int, layout: Layout
) -> NDArray[Any]:
    """Numbers, NaN where there are none, or words if no cell is a number."""
    cells = [_decimal(row[i], layout.comma) for row in rows]
    try:
        if not any("_" in cell for cell in cells):
            return np.array([as_number(cell) for cell in cells])
    except ValueError:
        pass
    numbers = [is_number(cell) for cell in cells]
    missing = [_is_missing(cell) for cell in cells]
    # Several rows of words are words; a single one stands where a number should.
    wrong = [
        k for k, (a, b) in enumerate(zip(numbers, missing, strict=True)) if not (a or b)
    ]
    if wrong and (any(numbers) or len(cells) < 2):
        k = wrong[0]
        shown = rows[k][i][:_MOST_SHOWN]
        what = f"expected numbers separated by {_SEPARATORS[layout.separator]}"
        source.fail(f"{what}, found {shown!r}", line=at[k])
    if wrong:
        return np.array(cells)
    return np.array(
        [as_number(c) if a else np.nan for c, a in zip(cells, numbers, strict=True)]
    )
