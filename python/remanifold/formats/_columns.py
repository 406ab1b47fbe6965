# SPDX-License-Identifier: GPL-3.0-or-later
"""Which columns of a table are coordinates: as asked for, by name, or by what they hold."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import are_whole
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._source import Source

# How programs call the columns of a field: the first of these is what is written.
GROUPS: dict[str, tuple[tuple[str, ...], ...]] = {
    "normals": (
        ("nx", "ny", "nz"),
        ("normal_x", "normal_y", "normal_z"),
        ("normalx", "normaly", "normalz"),
        ("normals_x", "normals_y", "normals_z"),
        ("normals_0", "normals_1", "normals_2"),
        ("normals:0", "normals:1", "normals:2"),
    ),
    "colors": (
        ("red", "green", "blue", "alpha"),
        ("r", "g", "b", "a"),
        ("diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"),
        ("colors_0", "colors_1", "colors_2", "colors_3"),
        ("color_r", "color_g", "color_b", "color_a"),
    ),
}
# Names of what is measured at a point or counts it, and is no coordinate.
_ATTRIBUTES = frozenset(
    [
        "id",
        "index",
        "idx",
        "i",
        "no",
        "nr",
        "num",
        "number",
        "point",
        "pointid",
        "point_id",
        "row",
        "rownum",
        "fid",
        "objectid",
        "gid",
        "rgb",
        "rgba",
        "intensity",
        "reflectance",
        "reflectivity",
        "amplitude",
        "label",
        "labels",
        "class",
        "classes",
        "classification",
        "category",
        "cluster",
        "segment",
        "target",
        "time",
        "timestamp",
        "times",
        "timestamps",
        "t",
        "gps_time",
        "gpstime",
        "date",
        "weight",
        "weights",
        "confidence",
        "scalar",
        "curvature",
        "radius",
        "ring",
        "return_number",
        "number_of_returns",
        "density",
        "scan",
    ]
)
_STEM = r"(?:positions?|pos|coord(?:inate)?s?|points?|pt|loc(?:ation)?|vertex|p)"
_AXIS = (
    re.compile(rf"^({_STEM}?[ _.:-]*)([xyz])$"),
    re.compile(rf"^([xyz])([ _.:-]*{_STEM})$"),
)
_NUMBERED = re.compile(r"^(.*?)[ _.:\[(-]*(\d+)[\])]?$")
# Numbered names that are those of coordinates, and those that programs make up.
_COORDINATE_STEMS = re.compile(rf"^(?:x|{_STEM}|dim(?:ension)?|axis)$")
_MADE_UP = re.compile(r"^(?:v|col|column|field|var|c|unnamed)?$")
_PLACES = (
    (
        ("easting", "east", "utm_e", "x_utm", "rechtswert", "ostwert"),
        ("northing", "north", "utm_n", "y_utm", "hochwert", "nordwert"),
    ),
    (("lon", "long", "longitude", "lng"), ("lat", "latitude")),
    (("e",), ("n",)),  # beside a height only: they may be anything else
)
_HEIGHTS = (
    *(
        "height",
        "elevation",
        "elev",
        "ele",
        "altitude",
        "alt",
        "z",
        "h",
        "hgt",
        "depth",
        "höhe",
        "hoehe",
    ),
)
# Formats of points in space, whatever their columns are called.
IN_SPACE = frozenset((".xyz", ".asc", ".pts", ".pcd", ".ptx"))
_LEAST = 10  # rows, below which what columns hold says nothing


class Choice(NamedTuple):
    """Which columns are coordinates, and how that is known."""

    axes: list[int]
    words: str
    guessed: bool


def check_columns(columns: Any) -> tuple[int | str, ...] | None:
    """Take "x,y,z", "0,1,2", or a sequence of names and numbers.

    Raises
    ------
    TypeError, ValueError
        Something else, nothing, or a column twice.
    """
    if columns is None:
        return None
    if isinstance(columns, str):
        columns = [part.strip() for part in columns.split(",")]
        if all(re.fullmatch(r"\d+", part) for part in columns):
            columns = [int(part) for part in columns]
    elif isinstance(columns, int | np.integer) and not isinstance(columns, bool):
        columns = [columns]
    try:
        given = [*columns]
    except TypeError:
        given = [None]
    checked: list[int | str] = []
    for column in given:
        if isinstance(column, np.integer):
            column = int(column)
        if not isinstance(column, int | str) or isinstance(column, bool):
            msg = (
                "columns must be names or numbers from 0, as in ['x', 'y', 'z'] or "
                f"[0, 1, 2], got {columns!r}"
            )
            raise TypeError(msg)
        if column in checked:
            msg = f"columns has {column!r} twice"
            raise ValueError(msg)
        checked.append(column)
    if not checked or "" in checked:
        msg = f"columns is {columns!r}, expected names or numbers of columns"
        raise ValueError(msg)
    return tuple(checked)


def table_of(mesh: FileMesh) -> Table:
    """Columns of a mesh: as they stood in the file, or its coordinates and fields."""
    if mesh.table is not None:
        return mesh.table
    return named_columns(
        mesh, lambda name, width: any(len(g) >= width for g in GROUPS.get(name, ()))
    )


def named_columns(mesh: FileMesh, is_group: Callable[[str, int], bool]) -> Table:
    """Coordinates and fields, one column each, and names that tell which they are.

    ``is_group`` says whether a field of so many columns has the names of its kind, such
    as nx, ny, nz, or numbers.
    """
    dim = mesh.points.shape[1]
    names = [*"xyz"[:dim]] if dim <= 3 else [f"x{i}" for i in range(1, dim + 1)]
    columns: list[NDArray[Any]] = [*mesh.points.T]
    for name, values in mesh.fields.items():
        if values.ndim == 1:
            names.append(name)
            columns.append(values)
            continue
        width = values.shape[1]
        if is_group(name, width):
            names += next(g for g in GROUPS[name] if len(g) >= width)[:width]
        else:
            names += [f"{name}_{i}" for i in range(width)]
        columns += [*values.T]
    return Table(columns, names)


def take_columns(source: Source, mesh: FileMesh) -> None:
    """Make coordinates of the columns that were asked for, and fields of the others."""
    assert source.columns is not None
    table = table_of(mesh)
    axes: list[int] = []
    for asked in source.columns:
        for found in _find(source, table, asked):
            if found in axes:
                source.fail(f"columns: {asked!r} is there twice")
            axes.append(found)
    _make(source, mesh, table, Choice(axes, "", False))
    mesh.chosen = f"columns {_shown(table, axes)}, as asked for"


def _find(source: Source, table: Table, asked: int | str) -> list[int]:
    count = len(table.columns)
    if isinstance(asked, int):
        if not -count <= asked < count:
            what = f"columns: there is no column {asked}"
            source.fail(f"{what}, only 0 to {count - 1}{_listing(table)}")
        return [asked % count]
    if table.names is None:
        source.fail(
            f"columns: there is no {asked!r}, for the columns have no names; say "
            f"numbers, 0 to {count - 1}"
        )
    for key in (str, _folded):
        matching = [i for i, name in enumerate(table.names) if key(name) == key(asked)]
        if len(matching) > 1:
            where = " and ".join(map(str, matching))
            source.fail(f"columns: {asked!r} is the name of {where}; say a number")
        if matching:
            return matching
    stem = re.compile(rf"{re.escape(asked)}[_:]\d+")
    family = [i for i, name in enumerate(table.names) if stem.fullmatch(name)]
    if asked in GROUPS and not family:
        folded = [_folded(name) for name in table.names]
        for group in GROUPS[asked]:
            if {*group[:3]} <= {*folded}:
                return [folded.index(part) for part in group[:3]]
    if not family:
        source.fail(f"columns: there is no {asked!r}{_listing(table)}")
    return family


def _listing(table: Table) -> str:
    if table.names is None:
        return ""
    shown = [name or f"(column {i})" for i, name in enumerate(table.names)]
    more = f" and {len(shown) - 20} more" if len(shown) > 20 else ""
    return f"; there are {', '.join(shown[:20])}{more}"


def mesh_of_table(source: Source, table: Table) -> FileMesh:
    """Points and fields of a table, and a word on which columns they are."""
    mesh = FileMesh(np.empty((0, 0)), table=table)
    count = len(table.columns[0]) if table.columns else 0
    if source.columns is not None or count == 0:
        # Chosen by whoever calls.
        mesh.points = np.empty((count, max(len(table.columns), 1)))
        return mesh
    choice = by_name(source, table) if table.names else None
    if choice is None:
        choice = by_content(source, table)
    _make(source, mesh, table, choice)
    if choice.guessed:
        source.guess(f"{choice.words}; COLUMNS decides")
    mesh.chosen = choice.words
    return mesh


def _make(source: Source, mesh: FileMesh, table: Table, choice: Choice) -> None:
    for i in choice.axes:
        if table.columns[i].dtype.kind not in "biuf":
            source.fail(f"columns: {_shown(table, [i])} holds text, expected numbers")
    with np.errstate(over="ignore"):
        axes = [table.columns[i].astype(np.float64) for i in choice.axes]
    mesh.points = np.column_stack(axes)
    rest: dict[str, NDArray[Any]] = {}
    for i, column in enumerate(table.columns):
        if i in choice.axes:
            continue
        name = (table.names[i].strip() if table.names else "") or _nameless(table, i)
        while name in rest:
            name += "_"
        rest[name] = column
    if table.names is None:
        rest = _named_by_content(rest)
    mesh.fields = gathered({n: numbered(source, n, c) for n, c in rest.items()})


def _nameless(table: Table, i: int) -> str:
    return "index" if i == 0 and _counts(table.columns[0]) else f"column_{i}"


def numbered(source: Source, name: str, column: NDArray[Any]) -> NDArray[Any]:
    """Numbers for what is text: the place of each word among the sorted ones."""
    if column.dtype.kind in "biuf":
        return column
    words, codes = np.unique(column.astype(str), return_inverse=True)
    shown = ", ".join(f"{i} {word[:30]}" for i, word in enumerate(words[:6].tolist()))
    more = ", ..." if len(words) > 6 else ""
    source.note(f"the words of {name!r} became numbers: {shown}{more}")
    return codes.ravel().astype(np.int32)


def gathered(scalars: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Put columns that belong together into one field: a_0, a_1; nx, ny, nz; colors."""
    fields = dict(scalars)
    places = {name: i for i, name in enumerate(scalars)}  # where each field begins
    for name, groups in GROUPS.items():
        folded = {_folded(key): key for key in fields}
        for group, number in itertools.product(groups, (4, 3)):
            parts = group[:number]
            if len(parts) == number and all(part in folded for part in parts):
                columns = [fields.pop(folded[part]) for part in parts]
                places[name] = min(places[folded[part]] for part in parts)
                if name not in fields:
                    values = np.column_stack(columns)
                    fields[name] = _bytes(values) if name == "colors" else values
                break
    for name in [name for name in fields if name.endswith("_0")]:
        stem = name[:-2]
        counted = itertools.takewhile(
            lambda part: part in fields, (f"{stem}_{i}" for i in itertools.count())
        )
        if stem and stem not in fields:
            places[stem] = places[name]
            fields[stem] = np.column_stack([fields.pop(part) for part in [*counted]])
    return {name: fields[name] for name in sorted(fields, key=places.__getitem__)}


def _bytes(colors: NDArray[Any]) -> NDArray[Any]:
    """Whole numbers up to 255 as what they are, where a table has them as doubles."""
    if colors.dtype.kind == "u" or not are_whole(colors):
        return colors
    if colors.size and 1 < colors.max() <= 255 and colors.min() >= 0:
        return colors.astype(np.uint8)
    return colors


def _folded(name: str) -> str:
    """A name without case, units in brackets, quotes, comments and their marks."""
    name = re.sub(r"\s+[#%].*$", "", name)
    name = re.sub(r"[\[(][^\])]*[\])]\s*$", "", name.strip().strip("\"'").lower())
    return name.lstrip("#/% ").strip()


def by_name(source: Source, table: Table) -> Choice | None:
    """Coordinates by their names; None where the names say nothing at all."""
    assert table.names is not None
    names = [_folded(name) for name in table.names]
    numeric = [column.dtype.kind in "biuf" for column in table.columns]
    for find in (_axes, _numbered, _places):
        found = find(names)
        if found is not None and all(numeric[i] for i in found):
            words = f"coordinates are the columns {_shown(table, found)}"
            if find is _places and names[found[0]] in _PLACES[1][0]:
                source.guess(
                    f"{words}: these are angles, not lengths, and distances between "
                    "them are not those on the ground; project them to metres first "
                    "for anything but a first look"
                )
            return Choice(found, words, False)
    if all(_MADE_UP.match((_NUMBERED.match(n) or [n, n])[1]) for n in names):
        return None
    taken = _names_of_attributes(names)
    axes = [i for i, ok in enumerate(numeric) if ok and i not in taken]
    if not axes:
        shown = ", ".join(table.names[:12])
        source.fail(f"holds no column that could be a coordinate, only {shown}")
    words = (
        f"no columns are called x, y, z: coordinates are {_shown(table, axes)} of "
        f"{len(names)}"
    )
    return Choice(axes, words, True)


def _axes(names: list[str]) -> list[int] | None:
    """x, y and z, all with the same before or after."""
    groups: dict[str, dict[str, int]] = {}
    for i, name in enumerate(names):
        for pattern, axis, rest in ((_AXIS[0], 2, 1), (_AXIS[1], 1, 2)):
            found = pattern.match(name)
            if found is not None:
                groups.setdefault(found[rest], {}).setdefault(found[axis], i)
                break
    for stem in sorted(groups, key=len):
        axes = groups[stem]
        if "x" in axes and "y" in axes:
            found_axes = [axes[axis] for axis in "xyz" if axis in axes]
            # With u and v it is the third of a vector.
            alone = names.count("w") == 1 and not {"u", "v"} & {*names}
            if stem == "" and len(found_axes) == 3 and alone:
                found_axes.append(names.index("w"))
            return found_axes
    return [0] if names == ["x"] else None


def _numbered(names: list[str]) -> list[int] | None:
    """x1, x2, ...: numbers one after the other, from 0 or 1, with a stem that fits."""
    groups: dict[str, dict[int, int]] = {}
    for i, name in enumerate(names):
        found = _NUMBERED.match(name)
        if found is not None:
            groups.setdefault(found[1], {}).setdefault(int(found[2][:9]), i)
    for stem, numbers in groups.items():
        first = min(numbers)
        complete = sorted(numbers) == [*range(first, first + len(numbers))]
        if not (complete and first <= 1 and len(numbers) > 1):
            continue
        # With another name all others must be known to be none.
        others = {*range(len(names))} - {*numbers.values()}
        fits = _COORDINATE_STEMS.match(stem)
        if fits or (not _MADE_UP.match(stem) and others <= _names_of_attributes(names)):
            return [numbers[number] for number in sorted(numbers)]
    return None


def _places(names: list[str]) -> list[int] | None:
    for pair in _PLACES:
        found = [next((names.index(n) for n in c if n in names), None) for c in pair]
        if found[0] is not None and found[1] is not None:
            height = [names.index(n) for n in _HEIGHTS if n in names][:1]
            if height or pair is not _PLACES[-1]:
                return [found[0], found[1], *height]
    return None


def _names_of_attributes(names: list[str]) -> set[int]:
    """Columns whose names are those of something else than coordinates."""
    taken = {i for i, name in enumerate(names) if name in _ATTRIBUTES or not name}
    taken |= {i for i, name in enumerate(names) if name.startswith("unnamed")}
    for groups in GROUPS.values():
        for group in groups:
            if {*group[:3]} <= {*names}:
                taken |= {i for i, name in enumerate(names) if name in group}
    return taken


def by_content(source: Source, table: Table) -> Choice:
    """Coordinates of a table without names, by what its columns hold."""
    columns = table.columns
    numeric = [i for i, c in enumerate(columns) if c.dtype.kind in "biuf"]
    if not numeric:
        source.fail("holds no numbers")
    axes, why = list(numeric), []
    if len(axes) > 2 and axes[0] == 0 and _counts(columns[0]):
        axes, why = axes[1:], ["column 0 counts the rows"]
    if len(numeric) < len(columns):
        why.append("columns of words are none")
    if source.suffix in IN_SPACE and len(axes) > 3:
        names = ", ".join(_named_by_content({str(i): columns[i] for i in axes[3:]}))
        why.append(f"{source.suffix} has three of them, and the others are {names}")
        axes = axes[:3]
    elif len(axes) >= 6:
        axes = _without_groups(columns, axes, why)
    if len(axes) > 2 and _labels(columns, axes):
        why.append(f"column {axes[-1]} holds a few whole numbers, as labels are")
        axes = axes[:-1]
    shown = _shown(table, axes)
    if why:
        return Choice(axes, f"coordinates are columns {shown}: {', '.join(why)}", True)
    if len(axes) <= 3:
        return Choice(axes, f"coordinates are all {len(axes)} columns", False)
    words = f"coordinates are all {len(axes)} columns, which have no names"
    if len(columns[0]) >= _LEAST and (np.diff(columns[0]) > 0).all():
        words += "; the first only ever increases, as time does"
        return Choice(axes, words, True)
    return Choice(axes, words, False)


def _without_groups(
    columns: list[NDArray[Any]], axes: list[int], why: list[str]
) -> list[int]:
    """Three coordinates where colors or normals come after them."""
    tests: dict[str, Callable[[list[NDArray[Any]]], bool]] = {
        "colors": _are_colors,
        "normals": _are_normals,
    }
    for start in range(3, min(len(axes), 12) - 2):
        for name, test in tests.items():
            parts = axes[start : start + 3]
            if test([columns[i] for i in parts]) and not test(
                [columns[i] for i in axes[:3]]
            ):
                why.append(f"columns {parts[0]} to {parts[-1]} hold {name}")
                return axes[:3]
    return axes


def _named_by_content(rest: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Names for columns that have none: colors, normals, intensity."""
    old = [*rest]
    new = list(old)
    i = 0
    while i < len(old):
        group = [rest[name] for name in old[i : i + 3]]
        if len(group) == 3 and _are_colors(group):
            new[i : i + 3] = GROUPS["colors"][0][:3]
        elif len(group) == 3 and _are_normals(group):
            new[i : i + 3] = GROUPS["normals"][0]
        else:
            i += 1
            continue
        i += 3
    unnamed = [k for k, name in enumerate(new) if name == old[k] and name != "index"]
    if len(unnamed) == 1 and rest[old[unnamed[0]]].dtype.kind in "biuf":
        new[unnamed[0]] = "intensity" if len(old) in (1, 4) else new[unnamed[0]]
    return dict(zip(new, rest.values(), strict=True))


def _counts(column: NDArray[Any]) -> bool:
    """Whether a column counts the rows, from 0 or 1."""
    count = len(column)
    if count < _LEAST or column.dtype.kind not in "iuf" or column[0] not in (0, 1):
        return False
    return bool((column == np.arange(count) + column[0]).all())


def _are_colors(columns: list[NDArray[Any]]) -> bool:
    if len(columns[0]) < _LEAST or any(c.dtype.kind not in "iuf" for c in columns):
        return False
    low = min(column.min() for column in columns)
    high = max(column.max() for column in columns)
    return bool(low >= 0 and 1 < high <= 255 and all(map(are_whole, columns)))


def _are_normals(columns: list[NDArray[Any]]) -> bool:
    """Unit vectors, as exactly as a few digits are."""
    if len(columns[0]) < _LEAST or any(c.dtype.kind != "f" for c in columns):
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        squares = sum(np.square(column, dtype=np.float64) for column in columns)
        return bool((np.abs(squares - 1) < 0.01).all()) and not all(
            map(are_whole, columns)
        )


def _labels(columns: list[NDArray[Any]], axes: list[int]) -> bool:
    """Whether the last column has few whole numbers, and no other one is whole."""
    last = columns[axes[-1]]
    if len(last) < _LEAST or not are_whole(last):
        return False
    distinct = len(np.unique(last))
    if not 1 < distinct <= min(64, len(last) // 5):
        return False
    return not any(are_whole(columns[i]) for i in axes[:-1])


def _shown(table: Table, axes: Sequence[int]) -> str:
    """Names of columns, or their numbers, in a sentence."""
    words = [
        (table.names[i].strip() if table.names else "") or str(i) for i in axes[:12]
    ]
    return ", ".join(words) + (", ..." if len(axes) > 12 else "")
