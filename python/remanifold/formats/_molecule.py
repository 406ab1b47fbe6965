# SPDX-License-Identifier: GPL-3.0-or-later
"""XYZ files of chemistry: a count, a comment, and an atom a line."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._columns import numbered
from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import Source
from remanifold.formats._text import split_lines

_ELEMENTS = [
    "H",
    "He",
    "Li",
    "Be",
    "B",
    "C",
    "N",
    "O",
    "F",
    "Ne",
    "Na",
    "Mg",
    "Al",
    "Si",
    "P",
    "S",
    "Cl",
    "Ar",
    "K",
    "Ca",
    "Sc",
    "Ti",
    "V",
    "Cr",
    "Mn",
    "Fe",
    "Co",
    "Ni",
    "Cu",
    "Zn",
    "Ga",
    "Ge",
    "As",
    "Se",
    "Br",
    "Kr",
    "Rb",
    "Sr",
    "Y",
    "Zr",
    "Nb",
    "Mo",
    "Tc",
    "Ru",
    "Rh",
    "Pd",
    "Ag",
    "Cd",
    "In",
    "Sn",
    "Sb",
    "Te",
    "I",
    "Xe",
    "Cs",
    "Ba",
    "La",
    "Ce",
    "Pr",
    "Nd",
    "Pm",
    "Sm",
    "Eu",
    "Gd",
    "Tb",
    "Dy",
    "Ho",
    "Er",
    "Tm",
    "Yb",
    "Lu",
    "Hf",
    "Ta",
    "W",
    "Re",
    "Os",
    "Ir",
    "Pt",
    "Au",
    "Hg",
    "Tl",
    "Pb",
    "Bi",
    "Po",
    "At",
    "Rn",
    "Fr",
    "Ra",
    "Ac",
    "Th",
    "Pa",
    "U",
    "Np",
    "Pu",
    "Am",
    "Cm",
    "Bk",
    "Cf",
    "Es",
    "Fm",
    "Md",
    "No",
    "Lr",
    "Rf",
    "Db",
    "Sg",
    "Bh",
    "Hs",
    "Mt",
    "Ds",
    "Rg",
    "Cn",
    "Nh",
    "Fl",
    "Mc",
    "Lv",
    "Ts",
    "Og",
]
_NUMBERS = {symbol.lower(): number for number, symbol in enumerate(_ELEMENTS, 1)}
_ATOM = re.compile(
    r"\s*([A-Za-z]{1,2})[A-Za-z0-9_+-]*\s+([^\s]+)\s+([^\s]+)\s+([^\s]+)"
)


# What columns hold, as extended XYZ says it: names, kinds and numbers of columns.
_PROPERTIES = re.compile(r"\bProperties=\"?((?:\w+:[SRIL]:\d{1,3}:?)+)", re.IGNORECASE)
_SPECIES = ("species", "element", "elements", "symbols", "z", "atomic_numbers")


class _Column(NamedTuple):
    name: str
    kind: str  # S, R, I or L: words, reals, integers, T or F
    start: int
    width: int


def read_molecule(source: Source) -> FileMesh | None:
    """Atoms as points, with their atomic numbers; None for a file of something else."""
    lines = split_lines(source.decoded())
    if len(lines) < 3 or not re.fullmatch(r"\s*\d{1,15}\s*", lines[0]):
        return None
    said = _said(lines[1])
    if said is None and _ATOM.match(lines[2]) is None:
        return None
    count = int(lines[0])
    species, place = (0, 1) if said is None else _places(said)
    points = np.empty((min(count, len(lines)), 3))
    numbers = np.zeros(len(points), dtype=np.int32)
    rows: list[list[str]] = []
    for i in range(count):
        line = i + 2
        if line >= len(lines) or not lines[line].strip():
            source.fail(f"is truncated: expected {count:,} atoms, found {i:,}")
        words = lines[line].split()
        if said is None and _ATOM.match(lines[line]) is None:
            shown = lines[line].strip()[:60]
            source.fail(f"expected 'symbol x y z', found {shown!r}", line=line + 1)
        if said is not None and len(words) < sum(column.width for column in said):
            width = sum(column.width for column in said)
            what = f"expected {width} columns as 'Properties' says, found {len(words)}"
            source.fail(what, line=line + 1)
        points[i] = source.floats(line + 1, words[place : place + 3], 3)
        if species is not None:
            numbers[i] = _atomic_number(words[species])
        rows.append(words)
    rest = sum(bool(line.strip()) for line in lines[count + 2 :])
    if rest:
        source.guess(
            f"holds more than one molecule: the first, of {count:,} atoms, is read"
        )
    fields = {} if species is None else {"atomic_number": numbers}
    mesh = FileMesh(points, fields=fields | _others(source, rows, said))
    mesh.chosen = "coordinates are those of the atoms of a molecule"
    return mesh


def _said(comment: str) -> list[_Column] | None:
    """Columns of extended XYZ, if there are coordinates among them."""
    found = _PROPERTIES.search(comment)
    if found is None:
        return None
    parts = found[1].strip(":").split(":")
    columns, start = [], 0
    for name, kind, width in zip(*[iter(parts)] * 3, strict=True):
        columns.append(_Column(name.lower(), kind.upper(), start, int(width)))
        start += int(width)
    if not any(c.name in ("pos", "positions") and c.width == 3 for c in columns):
        return None
    return columns


def _places(said: list[_Column]) -> tuple[int | None, int]:
    """Columns of the element and of x."""
    species = [c.start for c in said if c.name in _SPECIES and c.width == 1]
    place = [c.start for c in said if c.name in ("pos", "positions")]
    return next(iter(species), None), place[0]


def _atomic_number(word: str) -> int:
    """Of a symbol, also with a number or charge behind it; 0 for what is none."""
    if word.isdecimal():
        return int(word) if int(word) <= len(_ELEMENTS) else 0
    found = re.match(r"[A-Za-z]{1,2}", word)
    symbol = found[0].lower() if found else " "
    return _NUMBERS.get(symbol) or _NUMBERS.get(symbol[0], 0)


def _others(
    source: Source, rows: list[list[str]], said: list[_Column] | None
) -> dict[str, NDArray[Any]]:
    """What stands beside symbols and coordinates: charges, labels, forces."""
    if said is None:
        width = min(map(len, rows), default=4)
        if any(len(words) != width for words in rows):
            source.note(
                "what follows the coordinates of the atoms differs in length and is "
                "not read"
            )
            width = 4
        said = [_Column(f"column_{i}", "", i, 1) for i in range(4, width)]
    else:
        own = (*_SPECIES, "pos", "positions")
        said = [column for column in said if column.name not in own]
    fields: dict[str, NDArray[Any]] = {}
    for name, kind, start, width in said:
        cells = np.array([words[start : start + width] for words in rows])
        values: NDArray[Any] = cells
        if kind == "L":
            values = np.isin(cells, ("T", "t", "True", "true", "1"))
        elif kind != "S":
            try:
                values = cells.astype(np.float64)
            except ValueError:
                kind = "S"
            else:
                if kind == "I" and (values == np.rint(values)).all():
                    values = values.astype(np.int64)
        if values.dtype.kind == "U" and width > 1:
            source.note(f"the words of {name!r} are not read")
            continue
        if width == 1:
            values = numbered(source, name, values[:, 0])
        fields[name] = values
    return fields
