# SPDX-License-Identifier: GPL-3.0-or-later
"""XYZ files of chemistry: a count, a comment, and an atom a line."""

from __future__ import annotations

import re

import numpy as np

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


def read_molecule(source: Source) -> FileMesh | None:
    """Atoms as points, with their atomic numbers; None for a file of something else."""
    lines = split_lines(source.decoded())
    if len(lines) < 3 or not re.fullmatch(r"\s*\d{1,15}\s*", lines[0]):
        return None
    if _ATOM.match(lines[2]) is None:
        return None
    count = int(lines[0])
    points = np.empty((min(count, len(lines)), 3))
    numbers = np.zeros(len(points), dtype=np.int32)
    for i in range(count):
        line = i + 2
        atom = _ATOM.match(lines[line]) if line < len(lines) else None
        if atom is None:
            if line >= len(lines) or not lines[line].strip():
                source.fail(f"is truncated: expected {count} atoms, found {i}")
            shown = lines[line].strip()[:60]
            source.fail(f"expected 'symbol x y z', found {shown!r}", line=line + 1)
        points[i] = source.floats(line + 1, [*atom.groups()[1:]], 3)
        symbol = atom[1].lower()
        number = _NUMBERS.get(symbol) or _NUMBERS.get(symbol[0], 0)
        numbers[i] = number
    rest = sum(bool(line.strip()) for line in lines[count + 2 :])
    if rest:
        source.guess(
            f"holds more than one molecule: the first, of {count} atoms, is read"
        )
    mesh = FileMesh(points, fields={"atomic_number": numbers})
    mesh.chosen = "coordinates are those of the atoms of a molecule"
    return mesh
