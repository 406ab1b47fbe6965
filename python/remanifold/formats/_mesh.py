# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file holds, and how its faces become simplices."""

from __future__ import annotations

import itertools
import textwrap
import warnings
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._source import FloatArray, IntArray, Source
from remanifold.warnings import FileWarning

COMMENT_WIDTH = 200  # of a line; some readers of PLY stop at 256
NAMES = {0: "vertices", 1: "edges", 2: "triangles", 3: "tetrahedra"}


def simplex_name(dim: int) -> str:
    """Name simplices of a dimension, in the plural."""
    return NAMES.get(dim, f"simplices of dimension {dim}")


@dataclass
class Table:
    """Columns of one length as they stand in a file, with their names if they have any.

    Empty names are those of columns that have none beside others that have.
    """

    columns: list[NDArray[Any]]
    names: list[str] | None = None


@dataclass
class FileMesh:
    """Points, simplices by their number of corners, and values at the points.

    `table` has the columns of the file where these are not the coordinates followed by
    the fields; `chosen` says in words which of them became coordinates. `comment` is
    what a file says besides: lines of ASCII of a length that all readers take.
    """

    points: FloatArray
    cells: dict[int, IntArray] = field(default_factory=dict)
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    table: Table | None = None
    chosen: str = ""
    comment: list[str] = field(default_factory=list)


@dataclass
class Faces:
    """Polygons of any number of corners, one after the other."""

    corners: IntArray
    sizes: IntArray

    @classmethod
    def of(cls, polygons: list[list[int]]) -> Faces:
        """Take polygons as lists."""
        flat = list(itertools.chain.from_iterable(polygons))
        sizes = [len(polygon) for polygon in polygons]
        return cls(np.array(flat, dtype=np.int64), np.array(sizes, dtype=np.int64))


def check_corners(source: Source, corners: IntArray, num_points: int) -> None:
    """Refuse indices of vertices that there are not."""
    if corners.size and not 0 <= corners.min() <= corners.max() < num_points:
        low, high = int(corners.min()), int(corners.max())
        wrong = low if low < 0 else high
        what = f"the {num_points:,} vertices" if num_points else "no vertices"
        source.fail(f"has a face with vertex {wrong}, which is none of {what}")


def simplices_of_faces(
    source: Source, points: FloatArray, faces: Faces
) -> dict[int, IntArray]:
    """Edges and triangles: polygons of two corners, and all others triangulated."""
    check_corners(source, faces.corners, len(points))
    starts = np.cumsum(faces.sizes) - faces.sizes
    cells: dict[int, IntArray] = {}
    pairs = faces.sizes == 2
    if pairs.any():
        cells[2] = faces.corners[starts[pairs][:, None] + np.arange(2)]
    # Each polygon of n corners becomes n - 2 triangles, in the place where it stood.
    counts = np.maximum(faces.sizes - 2, 0)
    if counts.sum() == 0:
        return cells
    places = np.cumsum(counts) - counts
    triangles = np.empty((int(counts.sum()), 3), dtype=np.int64)
    for size in np.unique(faces.sizes[faces.sizes > 2]).tolist():
        which = np.flatnonzero(faces.sizes == size)
        corners = faces.corners[starts[which][:, None] + np.arange(size)]
        rows = places[which][:, None] + np.arange(size - 2)
        triangles[rows] = _triangulated(source, points, corners, which)
    cells[3] = triangles
    return cells


def _triangulated(
    source: Source, points: FloatArray, polygons: IntArray, numbers: IntArray
) -> IntArray:
    """Triangles of each polygon, (M, n - 2, 3).

    A convex polygon is cut from its first corner, others from one whose triangles all
    lie to the same side; where there is none ears are cut off.
    """
    size = polygons.shape[1]
    steps = np.arange(1, size - 1)
    best = np.zeros(len(polygons), dtype=np.int64)
    if size > 3:
        if points.shape[1] > 3:
            what = f"face {int(numbers[0])} has {size} corners"
            source.fail(f"{what}; in R^{points.shape[1]} only triangles can be read")
        worst = _least_areas(points, polygons)
        # The first corner, unless another one is better by more than rounding.
        sees = worst >= -1e-9
        best = np.where(sees.any(axis=1), sees.argmax(axis=1), -1)
    first = np.broadcast_to(best[:, None], (len(polygons), size - 2))
    second = (best[:, None] + steps) % size
    third = (best[:, None] + steps + 1) % size
    local = np.stack([first, second, third], axis=2)
    cut = np.asarray(polygons[np.arange(len(polygons))[:, None, None], local])
    for row in np.flatnonzero(best < 0).tolist():
        cut[row] = _clipped_ears(source, points, polygons[row], int(numbers[row]))
    return cut


def _least_areas(points: FloatArray, polygons: IntArray) -> FloatArray:
    """Least signed area of the triangles from each corner, over that of the polygon."""
    corners = np.zeros((*polygons.shape, 3))
    corners[:, :, : points.shape[1]] = points[polygons]
    corners -= corners[:, :1]
    scale = np.abs(corners).max(axis=(1, 2), keepdims=True)
    corners /= np.where(scale > 0, scale, 1.0)
    size = polygons.shape[1]
    total = np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1)
    area = np.linalg.norm(total, axis=1, keepdims=True)
    normal = total / np.where(area > 0, area, 1.0)
    worst = np.empty(polygons.shape)
    for apex in range(size):
        turned = np.roll(corners, -apex, axis=1)
        turned = turned - turned[:, :1]
        areas = np.einsum(
            "mij,mj->mi", np.cross(turned[:, 1:-1], turned[:, 2:]), normal
        )
        worst[:, apex] = areas.min(axis=1)
    return worst


def _clipped_ears(
    source: Source, points: FloatArray, polygon: IntArray, number: int
) -> IntArray:
    """Triangles of a polygon that no corner sees all of, (n - 2, 3).

    One corner after the other is cut off whose triangle holds no other corner: every
    simple polygon has two of them (Meisters, 1975).
    """
    corners = np.zeros((len(polygon), 3))
    corners[:, : points.shape[1]] = points[polygon]
    corners -= corners.mean(axis=0)
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    drop = int(np.abs(normal).argmax())
    flat = np.delete(corners, drop, axis=1)
    if (normal[drop] < 0) != (drop == 1):
        flat[:, 0] *= -1  # counterclockwise
    left = list(range(len(polygon)))
    triangles = []
    if _crosses_itself(flat):
        _refuse_crossing(source, number, len(polygon))
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            others = np.array([k for k in left if k not in (a, b, c)])
            if _is_ear(flat[a], flat[b], flat[c], flat[others]):
                triangles.append([a, b, c])
                del left[i]
                break
        else:
            _refuse_crossing(source, number, len(polygon))
    triangles.append(left)
    return np.asarray(polygon[np.array(triangles)])


def _refuse_crossing(source: Source, number: int, size: int) -> NoReturn:
    source.fail(
        f"face {number} has {size} corners and crosses itself; triangulate the mesh first"
    )


def _side(p: FloatArray, q: FloatArray, r: FloatArray) -> Any:
    """Twice the signed area of a triangle: on which side of pq the third corner is."""
    u, v = q - p, r - p
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def _crosses_itself(flat: FloatArray) -> bool:
    """Whether two sides of a polygon cross in their interiors."""
    begin, end = flat, np.roll(flat, -1, axis=0)
    a, b, c, d = begin[:, None], end[:, None], begin[None], end[None]
    apart = _side(a, b, c) * _side(a, b, d) < 0
    return bool((apart & (_side(c, d, a) * _side(c, d, b) < 0)).any())


def _is_ear(a: FloatArray, b: FloatArray, c: FloatArray, others: FloatArray) -> bool:
    if _side(a, b, c) <= 0:
        return False
    inside = (_side(a, b, others) >= 0) & (_side(b, c, others) >= 0)
    return not (inside & (_side(c, a, others) >= 0)).any()


def strip_triangles(strips: Faces) -> IntArray:
    """Triangles of strips: each corner with the two before, every second one turned.

    An index of -1 begins another strip.
    """
    starts = np.cumsum(strips.sizes)
    first = np.zeros(len(strips.corners) + 1, dtype=np.bool_)
    first[starts - strips.sizes] = True
    first = first[:-1]
    first[1:] |= strips.corners[:-1] < 0
    # Place of each corner in its strip.
    places = np.arange(len(first))
    places = places - np.maximum.accumulate(np.where(first, places, 0))
    third = np.flatnonzero((places > 1) & (strips.corners >= 0))
    odd = places[third] % 2
    second, before = third - 1 - odd, third - 2 + odd
    return np.asarray(strips.corners[np.column_stack([before, second, third])])


def polyline_edges(lines: list[list[int]]) -> IntArray:
    """Edges of polylines: each corner and the next."""
    pairs = [pair for line in lines for pair in itertools.pairwise(line)]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def choose_simplices(source: Source, mesh: FileMesh, dim: int | None) -> IntArray:
    """Simplices of the dimension asked for, or of the highest there is.

    Those of a lower dimension may only be faces of these: a file may hold the edges of
    its triangles as well.
    """
    held: dict[int, IntArray] = {}
    held |= {size - 1: cells for size, cells in mesh.cells.items() if len(cells)}
    if dim is not None:
        if dim not in held:
            source.fail(f"holds no {simplex_name(dim)}, {_found(held)}")
        return held[dim]
    if not held:
        # An empty mesh is one if it is said of which dimension.
        if len(mesh.cells) == 1:
            return next(iter(mesh.cells.values()))
        source.fail("holds points and no simplices; read_points reads the points")
    top = max(held)
    for lower in sorted(held):
        if lower == top:
            break
        alone = int((~_are_faces(held[lower], held[top])).sum())
        if alone:
            source.fail(
                f"holds {alone:,} {simplex_name(lower)} that are in none of its "
                f"{len(held[top]):,} {simplex_name(top)}; say dim={lower} or dim={top} "
                "to read one kind"
            )
    return held[top]


def _found(held: dict[int, IntArray]) -> str:
    if not held:
        return "only points"
    kinds = [f"{len(cells):,} {simplex_name(dim)}" for dim, cells in held.items()]
    return f"but {' and '.join(kinds)}"


def _are_faces(cells: IntArray, simplices: IntArray) -> NDArray[np.bool_]:
    width = cells.shape[1]
    columns = itertools.combinations(range(simplices.shape[1]), width)
    rows = np.sort(simplices, axis=1)
    faces = np.vstack([rows[:, list(chosen)] for chosen in columns])
    _, number = first_of_equal_rows(np.vstack([np.sort(cells, axis=1), faces]))
    return np.isin(number[: len(cells)], number[len(cells) :])


def first_of_equal_rows(rows: NDArray[Any]) -> tuple[IntArray, IntArray]:
    """First of each set of equal rows, ascending, and for each row its place there.

    Several times as fast as numpy.unique with an axis.
    """
    order = np.lexsort(rows.T)
    ordered = rows[order]
    new = np.ones(len(rows), dtype=np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    first = order[new]  # the sort is stable
    ascending = np.argsort(first)
    rank = np.empty(len(first), dtype=np.int64)
    rank[ascending] = np.arange(len(first))
    places = np.empty(len(rows), dtype=np.int64)
    places[order] = rank[np.cumsum(new) - 1]
    return first[ascending], places


def without_degenerate(source: Source, simplices: IntArray) -> IntArray:
    """Leave out simplices with a vertex twice, and all but the first of equal ones."""
    rows = np.sort(simplices, axis=1)
    degenerate = (rows[:, 1:] == rows[:, :-1]).any(axis=1)
    kept = np.flatnonzero(~degenerate)
    if len(kept):
        kept = kept[first_of_equal_rows(rows[kept])[0]]
    lost = len(simplices) - len(kept)
    if lost:
        name = simplex_name(simplices.shape[1] - 1)
        twice = int(degenerate.sum())
        warnings.warn(
            f"{source}: {lost:,} {name} left out, {twice:,} with a vertex twice and "
            f"{lost - twice:,} repeated",
            FileWarning,
            stacklevel=4,
        )
    return simplices[kept]


def finite_part(
    vertices: FloatArray, simplices: NDArray[np.integer]
) -> tuple[IntArray, IntArray]:
    """Vertices that are somewhere, and the simplices by their numbers among these."""
    rows = np.flatnonzero(np.isfinite(vertices).all(axis=1))
    number = np.full(len(vertices), -1, dtype=np.int64)
    number[rows] = np.arange(len(rows))
    return rows, number[simplices]


def comment_lines(text: str | None) -> list[str]:
    """A comment as lines that go into any format."""
    plain = (text or "").encode("ascii", "backslashreplace").decode()
    words = "".join(c if c.isprintable() or c == "\n" else " " for c in plain)
    lines = [textwrap.wrap(line, COMMENT_WIDTH) for line in words.splitlines()]
    return [*itertools.chain.from_iterable(lines)]
