# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture of a complex shows, whichever library draws it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from remanifold import _core
from remanifold._base.colors import are_colors, byte_colors
from remanifold._base.validation import check_choice, check_vertex_values
from remanifold.complex import parts
from remanifold.complex.measures import at_vertices, shapes
from remanifold.drawing.thinning import thinned
from remanifold.judging.judged import QUALITY_FIELDS, JudgedReconstruction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold.complex.data import ComplexData
    from remanifold.complex.embedding import Embedding

    Points: TypeAlias = NDArray[np.float64]

Style: TypeAlias = Literal["auto", "surface", "shrunken", "cut", "edges"]
STYLES: tuple[str, ...] = get_args(Style)
# Of each vertex: what any complex has, and those of `Quality`.
_OF_ALL = ("boundary", "component", "quality")
FIELDS = (*_OF_ALL, *QUALITY_FIELDS)

MESH_COLOR = "#f2c98f"
WIRE_COLOR = "#5b4a33"
LINE_COLOR = "#2f7ac6"
RIM_COLOR = "#1f5fd0"
SAMPLE_COLOR = "#20466e"
DOUBTFUL_COLOR = "#d81b2c"
OUTLIER_COLOR = "#7b2fb5"
UNKNOWN_COLOR = "#9a9a9a"
SCALE_COLORS = (
    *("#440154", "#482878", "#3e4989", "#31688e", "#26828e"),
    *("#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"),
)
CATEGORY_COLORS = (
    *("#f2c98f", "#6aa5d9", "#7fc27f", "#d98080", "#a98bc9"),
    *("#b89070", "#e3a4cf", "#a5a5a5", "#c9c95f", "#6cc7c9"),
)
TOWARDS = np.array([1.25, 1.1, 0.0])  # whoever looks, as all who draw place the camera
SHRUNKEN = 0.6  # size of tetrahedra that are drawn apart
WITH_WIRE = 20_000  # triangles up to which their edges are drawn as well
PLAIN = 1_000  # tetrahedra drawn apart before they hide each other


class Scale(NamedTuple):
    """How values become colors: a range, or one color for each of `categories`."""

    label: str
    low: float
    high: float
    categories: tuple[str, ...] = ()
    colors: tuple[str, ...] = ()


class Surface(NamedTuple):
    """Triangles; `values` are those of the points.

    One number each, which the scene's scale makes a color of, or a color: red, green and
    blue from 0 to 1, (n, 3).
    """

    name: str
    points: Points
    triangles: NDArray[np.intp]
    values: NDArray[np.float64] | None
    opacity: float = 1.0
    wire: bool = False


class Lines(NamedTuple):
    """Edges between points; `values` as in `Surface`."""

    name: str
    points: Points
    edges: NDArray[np.intp]
    values: NDArray[np.float64] | None
    color: str
    width: float
    opacity: float = 1.0


class Marks(NamedTuple):
    """Points that stand out, with the numbers of their vertices."""

    name: str
    points: Points
    numbers: NDArray[np.intp]
    color: str
    size: float
    symbol: str = "circle"


@dataclass
class Scene:
    """All that is drawn."""

    flat: bool
    caption: list[str]  # how it was embedded, and what was left out
    scale: Scale | None = None
    surfaces: list[Surface] = field(default_factory=list)
    lines: list[Lines] = field(default_factory=list)
    marks: list[Marks] = field(default_factory=list)

    @property
    def points(self) -> Points:
        """All points that are drawn."""
        parts = [s.points for s in self.surfaces]
        parts += [s.points for s in self.lines]
        parts += [s.points for s in self.marks]
        return np.concatenate(parts or [np.zeros((1, 3))])


def scene_of(
    complex: ComplexData,
    *,
    color: str | ArrayLike | None,
    style: str,
    placed: Embedding,
    show_samples: bool,
    show_doubtful: bool,
    limit: int,
) -> Scene:
    """Decide what to draw; at most `limit` simplices."""
    check_choice(style, "style", STYLES)
    values, scale = _values(complex, color)
    if show_doubtful:
        _reconstruction(complex, "show_doubtful=True")
    scene = Scene(
        flat=complex.ambient_dim == 2 and placed.method == "coordinates",
        caption=[placed.label] if placed.label else [],
        scale=scale,
    )
    builder = _Builder(complex, placed.points, values, limit, scene)
    builder.draw(style)
    if show_samples or len(complex.simplices) == 0:
        builder.mark_samples(exact=placed.method == "coordinates")
    if show_doubtful:
        builder.mark_doubtful()
    return scene


class _Builder:
    """Fills a scene."""

    def __init__(
        self,
        complex: ComplexData,
        points: Points,
        values: NDArray[np.float64] | None,
        limit: int,
        scene: Scene,
    ) -> None:
        self.complex = complex
        self.points = points
        self.values = values
        self.limit = limit
        self.scene = scene

    def draw(self, style: str) -> None:
        dim = self.complex.dim
        rows = self.complex.simplices
        if len(rows) == 0:
            return
        if dim == 0:
            self.mark("vertices", rows[:, 0], SAMPLE_COLOR, 5)
        elif dim == 1:
            self.add_lines("edges", rows, LINE_COLOR, 4, "edges")
            self.mark("ends", open_faces(rows)[:, 0], RIM_COLOR, 7)
        elif dim > 3 or style == "edges":
            self.add_edges()
        elif dim == 2:
            self.add_surface("triangles", rows)
            self.add_lines("boundary", open_faces(rows), RIM_COLOR, 4, "open edges")
        else:
            self.add_solid(style)

    def add_edges(self) -> None:
        edges = _core.edges(self.complex.simplices, self.complex.num_vertices)
        self.add_lines("edges", edges, LINE_COLOR, 1, "edges")

    def add_solid(self, style: str) -> None:
        rows = self.complex.simplices
        rim = open_faces(rows)
        if style == "cut":
            self.add_cut(rows)
            return
        shrunken = style in ("auto", "shrunken")
        if shrunken or len(rim) == 0:
            self.add_shrunken(rows)
        if len(rim):
            self.add_surface("boundary", rim, 0.22 if shrunken else 1.0)

    def add_cut(self, rows: NDArray[np.int32]) -> None:
        """The half of the tetrahedra that is farther away, and so what is inside."""
        heights = self.points[rows].mean(axis=1) @ TOWARDS
        kept = heights <= np.median(heights)
        self.scene.caption.append(
            f"Cut: shown are {int(kept.sum()):,} of {len(rows):,} tetrahedra, those behind "
            "a plane"
        )
        self.add_surface("cut", open_faces(rows[kept]))
        rest = open_faces(rows[~kept])
        if len(rest):
            self.add_surface("part in front", rest, 0.1)

    def add_surface(
        self, name: str, triangles: NDArray[np.int32], opacity: float = 1.0
    ) -> None:
        what = "triangles" if name == "triangles" else f"triangles of the {name}"
        points, kept, cells = self.thin(triangles, what)
        values = None if self.values is None else self.values[kept]
        self.scene.surfaces.append(
            Surface(name, points, cells, values, opacity, len(cells) <= WITH_WIRE)
        )

    def add_lines(
        self,
        name: str,
        edges: NDArray[np.int32],
        color: str,
        width: float,
        what: str,
    ) -> None:
        if len(edges) == 0:
            return
        points, kept, cells = self.thin(edges, what)
        values = None
        if self.values is not None and name == "edges":
            values = self.values[kept]
        # Many lines hide each other.
        opacity = 1.0 if self.complex.dim < 3 else max(0.15, min(1, 1500 / len(cells)))
        self.scene.lines.append(
            Lines(name, points, cells, values, color, width, opacity)
        )

    def add_shrunken(self, rows: NDArray[np.int32]) -> None:
        """Tetrahedra by themselves, drawn towards their middles."""
        shown = rows
        most = min(self.limit, PLAIN)
        if len(rows) > most:
            shown = rows[np.arange(most) * len(rows) // most]
            self.scene.caption.append(
                f"Shown: {most:,} of {len(rows):,} tetrahedra, evenly chosen"
            )
        corners = self.points[shown]
        middle = corners.mean(axis=1, keepdims=True)
        points = (middle + SHRUNKEN * (corners - middle)).reshape(-1, 3)
        sides = np.array(list(itertools.combinations(range(4), 3)))
        triangles = (np.arange(len(shown))[:, None, None] * 4 + sides).reshape(-1, 3)
        values = None
        if self.values is not None:
            values = self.values[shown].reshape(-1, *self.values.shape[1:])
        self.scene.surfaces.append(
            Surface("tetrahedra", points, triangles, values, wire=True)
        )

    def thin(
        self, cells: NDArray[np.int32], what: str
    ) -> tuple[Points, NDArray[np.intp], NDArray[np.intp]]:
        """Coarsen what is too much to draw, and say so."""
        kept, shown = thinned(self.points, cells, self.limit)
        if len(cells) > self.limit:
            self.scene.caption.append(
                f"Coarsened for display: {len(shown):,} for {len(cells):,} {what}"
            )
        return self.points[kept], kept, shown

    def mark(
        self,
        name: str,
        vertices: NDArray[np.integer],
        color: str,
        size: float,
        symbol: str = "circle",
        points: Points | None = None,
    ) -> None:
        where = (self.points if points is None else points)[vertices]
        known = np.isfinite(where).all(axis=1)
        where, numbers = where[known], np.asarray(vertices, dtype=np.intp)[known]
        if len(numbers) == 0:
            return
        total = len(numbers)
        if total > self.limit:
            every = np.arange(self.limit) * total // self.limit
            where, numbers = where[every], numbers[every]
            self.scene.caption.append(f"Marked: {self.limit:,} of {total:,} {name}")
        self.scene.marks.append(Marks(name, where, numbers, color, size, symbol))

    def mark_samples(self, *, exact: bool) -> None:
        """Where they were given; as embedded where they have no place in space."""
        samples = getattr(self.complex, "samples", None)
        points = None
        if exact and samples is not None:
            points = np.zeros((len(samples), 3))
            points[:, : samples.shape[1]] = samples
        everything = np.arange(self.complex.num_vertices)
        self.mark("samples", everything, SAMPLE_COLOR, 3, points=points)

    def mark_doubtful(self) -> None:
        rec = _reconstruction(self.complex, "show_doubtful=True")
        outliers = np.zeros(rec.num_samples, dtype=bool)
        outliers[rec.outliers] = True
        doubtful = np.flatnonzero(rec.quality.doubtful & ~outliers)
        self.mark("samples in doubt", doubtful, DOUBTFUL_COLOR, 8)
        self.mark("outliers", rec.outliers, OUTLIER_COLOR, 7, "x")


def open_faces(simplices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Faces in one simplex only, (H, K), rows sorted."""
    return np.sort(parts.open_faces(simplices), axis=1)


def _reconstruction(complex: ComplexData, what: str) -> JudgedReconstruction:
    if isinstance(complex, JudgedReconstruction):
        return complex
    msg = f"{what} needs a Reconstruction, got a {type(complex).__name__}"
    raise ValueError(msg)


def _values(
    complex: ComplexData, color: str | ArrayLike | None
) -> tuple[NDArray[np.float64] | None, Scale | None]:
    """Values of the vertices, and how they are colored; colors themselves have no scale."""
    if color is None:
        return None, None
    if not isinstance(color, str):
        return _given(color, "", "color", complex.num_vertices)
    known = complex.vertex_attributes
    if color not in FIELDS and color not in known:
        words = ", ".join(map(repr, (*FIELDS, *known)))
        own = "" if known else "; the complex has no vertex_attributes"
        msg = f"color is {color!r}, expected one of {words}, or an array{own}"
        raise ValueError(msg)
    # What is known now comes before what a file knew of an older result, as in `fields`.
    judged = isinstance(complex, JudgedReconstruction)
    if color in known and (color not in FIELDS or not (judged or color in _OF_ALL)):
        what = f"color is {color!r}, of which vertex_attributes"
        return _given(known[color], color, what, complex.num_vertices)
    if color == "component":
        labels = complex.component_labels()
        count = int(labels.max(initial=-1)) + 1
        names = tuple(map(str, range(min(count, len(CATEGORY_COLORS)))))
        numbers = (labels % len(CATEGORY_COLORS)).astype(np.float64)
        return numbers, Scale(
            "component", 0, len(names), names, CATEGORY_COLORS[: len(names)]
        )
    if color == "boundary":
        mask = np.zeros(complex.num_vertices, dtype=bool)
        if complex.dim > 0:
            mask[open_faces(complex.simplices)] = True
        return mask.astype(np.float64), Scale(
            "boundary", 0, 2, ("no", "yes"), (MESH_COLOR, RIM_COLOR)
        )
    if color == "quality":
        if complex.dim < 2:
            msg = (
                "color is 'quality', the shape of simplices, which edges do not have; "
                "try 'sampling_ratio'"
            )
            raise ValueError(msg)
        values = at_vertices(complex, shapes(complex))
        return values, Scale("shape quality", 0, 1)
    field_values = getattr(_reconstruction(complex, f"color={color!r}").quality, color)
    values = np.asarray(field_values, dtype=np.float64)
    if color == "doubtful":
        return values, Scale(
            "in doubt", 0, 2, ("no", "yes"), (MESH_COLOR, DOUBTFUL_COLOR)
        )
    return values, _range(color.replace("_", " "), values)


def _given(
    values: ArrayLike, label: str, what: str, count: int
) -> tuple[NDArray[np.float64], Scale | None]:
    """Numbers, flags or colors that somebody gave for each vertex."""
    array = np.asarray(values)
    if array.ndim == 2 and array.shape[0] == count and array.dtype.kind in "biuf":
        if are_colors(array):
            # What is transparent is drawn as what is not.
            return byte_colors(array)[:, :3] / 255.0, None
        if array.shape[1] > 1:
            msg = (
                f"{what} has shape {array.shape} and holds no colors, which are red, "
                "green and blue from 0 to 1 or 0 to 255; give one of its columns"
            )
            raise ValueError(msg)
        array = array[:, 0]
    numbers = check_vertex_values(array, what, count)
    if array.dtype.kind == "b":
        return numbers, Scale(label, 0, 2, ("no", "yes"), (MESH_COLOR, RIM_COLOR))
    return numbers, _range(label, numbers)


def _range(label: str, values: NDArray[np.float64]) -> Scale:
    """Between the percentiles 1 and 99, so that no single value decides."""
    finite = values[np.isfinite(values)]
    if len(finite) == 0:
        return Scale(label, 0, 1)
    low, high = (float(v) for v in np.percentile(finite, (1, 99)))
    return Scale(label, low, high if high > low else low + 1)
