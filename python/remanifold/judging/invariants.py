# SPDX-License-Identifier: GPL-3.0-or-later
"""What must hold of a result, whatever the samples: counted anew from its arrays.

Nothing here calls the core or what the result was made with: a mistake there would be
made twice. Homology is GUDHI's, signs of volumes are exact.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.html import fragment
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.judging.judged import JudgedReconstruction

    Array = NDArray[Any]
    # How many were looked at, and those that are wrong; or why none were.
    Found = tuple[int, Array]
    Named = Iterator[tuple[str, Found | str]]

_MANY_FOR_ALGEBRA = 20_000  # simplices whose homology takes seconds
# Of a determinant of differences in double precision, relative to the product of the
# lengths of its rows; 2^-40 is far above what rounding does to one of 20 rows.
_SURE = 2.0**-40
_COINCIDE = 2.0**-47  # of the largest coordinate: twice what samples are merged within
_ORTHONORMAL = 1e-10
_ON_COMPLEX = 1e-6  # of the size of the samples, that an attached sample may be off
_MANY_PAIRS = 3_000_000  # of samples and simplices


@dataclass(frozen=True, eq=False, repr=False)
class Invariant(ReadOnlyArrays):
    """One thing that must hold of a result, and whether it does.

    Attributes
    ----------
    name : str
        What must hold.
    counted : int
        How many things were looked at.
    where : ndarray
        Those that are wrong: indices of samples or simplices, or rows of vertices.
    """

    name: str
    counted: int
    where: NDArray[Any]

    @property
    def ok(self) -> bool:
        """Whether it holds."""
        return len(self.where) == 0

    def __repr__(self) -> str:
        wrong = len(self.where) or None
        return one_line(self, name=self.name, counted=self.counted, wrong=wrong)


@dataclass(frozen=True, eq=False, repr=False)
class Invariants:
    """What `Reconstruction.check` looked at, one invariant each.

    Attributes
    ----------
    checked : tuple of Invariant
        All that apply to this result.
    left_out : tuple of str
        Those that would have taken too long, each with the reason.
    """

    checked: tuple[Invariant, ...]
    left_out: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether all of them hold."""
        return not self.broken

    @property
    def broken(self) -> tuple[Invariant, ...]:
        """Those that do not hold."""
        return tuple(one for one in self.checked if not one.ok)

    @property
    def answer(self) -> str:
        """The same in one sentence."""
        if self.ok:
            return f"all {len(self.checked)} invariants hold"
        said = "; ".join(
            f"{one.name}: {len(one.where):,} of {one.counted:,} do not, the first "
            f"{one.where[0].tolist()}"
            for one in self.broken
        )
        return (
            f"{len(self.broken)} of {len(self.checked)} invariants are broken: {said}"
        )

    def __bool__(self) -> bool:
        """Whether all of them hold."""
        return self.ok

    def __getitem__(self, name: str) -> Invariant:
        """One by its name."""
        for one in self.checked:
            if one.name == name:
                return one
        raise KeyError(name)

    def __repr__(self) -> str:
        return one_line(
            self,
            ok=self.ok,
            checked=len(self.checked),
            broken=len(self.broken) or None,
            left_out=len(self.left_out) or None,
        )

    def _repr_html_(self) -> str:
        rows: list[tuple[str, object]] = [
            (
                one.name,
                f"{one.counted:,} looked at, "
                + ("all right" if one.ok else f"{len(one.where):,} wrong"),
            )
            for one in self.checked
        ]
        return fragment(self.answer, rows, note="; ".join(self.left_out))


def check_invariants(rec: JudgedReconstruction) -> Invariants:
    """Count anew what a result says of itself, as `Reconstruction.check` describes it."""
    checked: list[Invariant] = []
    left_out: list[str] = []
    whole = _Complex(rec.simplices, rec.num_samples)

    def take(*parts: Named) -> None:
        for name, found in itertools.chain(*parts):
            if isinstance(found, str):
                left_out.append(f"{name}: {found}")
            else:
                checked.append(Invariant(name, found[0], np.asarray(found[1])))

    take(_of_simplices(rec), _of_digests(rec))
    # All that follows reads the simplices.
    if checked[0].ok and checked[1].ok:
        of_both = (_of_facets, _of_links, _of_orientation, _of_topology, _of_samples)
        take(*(part(rec, whole) for part in (*of_both, _of_report, _of_paper_steps)))
        of_result = (_of_volumes, _of_positions, _of_tangents, _of_quality)
        take(*(part(rec) for part in of_result), _of_openings(rec, whole))
    else:
        left_out.append("all else: the simplices are not of samples")
    return Invariants(tuple(checked), tuple(left_out))


class _Complex:
    """Faces of the simplices, each computed when first asked for."""

    def __init__(self, simplices: Array, count: int) -> None:
        self.rows = np.sort(simplices.astype(np.int64), axis=1)
        self.count = count  # of samples
        self.dim = simplices.shape[1] - 1

    @functools.cached_property
    def facets(self) -> tuple[Array, Array, Array]:
        """Facets, the number of each facet of each simplex, and how many have it.

        That of the facet opposite to corner i of simplex m is in place (m, i).
        """
        columns = self.dim + 1
        all_rows = np.stack(
            [np.delete(self.rows, i, axis=1) for i in range(columns)], axis=1
        )
        unique, numbers = _unique(all_rows.reshape(-1, self.dim))
        return unique, numbers.reshape(-1, columns), np.bincount(numbers)

    @functools.cached_property
    def open_facets(self) -> Array:
        """Facets of one simplex."""
        unique, _, cofaces = self.facets
        return np.asarray(unique[cofaces == 1])

    def faces(self, dim: int) -> Array:
        """All faces of a dimension."""
        chosen = [*itertools.combinations(range(self.dim + 1), dim + 1)]
        return _unique(np.concatenate([self.rows[:, list(c)] for c in chosen]))[0]

    @functools.cached_property
    def used(self) -> Array:
        """Whether each sample is in a simplex."""
        used = np.zeros(self.count, dtype=bool)
        used[self.rows.ravel()] = True
        return used


def _unique(rows: Array) -> tuple[Array, Array]:
    """Rows once each, in order, and which of them each is."""
    if len(rows) == 0:
        return rows, np.empty(0, dtype=np.int64)
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    first = np.ones(len(rows), dtype=bool)
    first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.cumsum(first) - 1
    return ordered[first], numbers


def _difference(one: Array, other: Array) -> Array:
    """Rows that are in one of two lists only, or in one more often."""
    columns = max(one.shape[1] if one.ndim == 2 else 1, 1)
    lists = [
        np.sort(a.reshape(-1, columns).astype(np.int64), axis=1) for a in (one, other)
    ]
    unique, numbers = _unique(np.concatenate(lists))
    signs = np.repeat([1.0, -1.0], [len(a) for a in lists])
    return np.asarray(unique[np.bincount(numbers, signs, len(unique)) != 0])


def _groups(count: int, pairs: Array) -> tuple[int, Array]:
    """Connected components of a graph: their number, and that of each vertex."""
    labels = np.arange(count)
    while True:
        ends = labels[pairs]
        low, high = ends.min(axis=1, initial=count), ends.max(axis=1, initial=-1)
        if (low == high).all():
            break
        np.minimum.at(labels, high, low)
        # Each vertex gets the label of its root, which has its own.
        while (labels[labels] != labels).any():
            labels = labels[labels]
    roots, numbers = np.unique(labels, return_inverse=True)
    return len(roots), numbers.reshape(-1)


def _flagged(rec: JudgedReconstruction, numbers: Array) -> Array:
    """Flags of samples."""
    flags = np.zeros(rec.num_samples, dtype=bool)
    flags[numbers] = True
    return flags


def _same(said: object, counted: object) -> Found:
    """One value that must be another one; where it is not, both."""
    return 1, np.array([[str(said), str(counted)]] if said != counted else [])


def _of_simplices(rec: JudgedReconstruction) -> Named:
    rows = rec.simplices.astype(np.int64)
    number = len(rows)
    outside = ((rows < 0) | (rows >= rec.num_samples)).any(axis=1)
    yield "vertices of simplices are samples", (number, np.flatnonzero(outside))
    ordered = np.sort(rows, axis=1)
    twice = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    yield "simplices have K + 1 different vertices", (number, np.flatnonzero(twice))
    order = np.lexsort(ordered.T[::-1])
    again = (ordered[order][1:] == ordered[order][:-1]).all(axis=1)
    yield "no simplex is there twice", (number, np.sort(order[1:][again]))
    yield "simplices are sorted", (number, np.flatnonzero(order != np.arange(number)))
    free = 2 if rec.method == "manifold" else 0  # columns that orientation may exchange
    fixed = rows.shape[1] - free
    wrong = (rows[:, :fixed] != ordered[:, :fixed]).any(axis=1)
    yield "columns ascend", (number, np.flatnonzero(wrong))


def _of_facets(rec: JudgedReconstruction, whole: _Complex) -> Named:
    unique, _, cofaces = whole.facets
    repair = rec.repair
    many = _difference(unique[cofaces > 2], repair.callous_faces)
    yield "facets of more than two simplices are reported", (len(unique), many)
    wrong = _difference(whole.open_facets, repair.open_faces)
    yield "facets of one simplex are reported", (len(unique), wrong)
    held = _difference(
        np.concatenate([repair.hole_faces, repair.open_faces]), repair.open_faces
    )
    extra = (
        _rows_beyond(repair.hole_faces, repair.open_faces) if len(held) else held[:0]
    )
    yield "faces of holes are open", (len(repair.hole_faces), extra)
    sets = repair.num_boundary_components + repair.num_holes
    number = _num_sets(whole.open_facets)
    yield (
        "boundary components and holes are the sets of open facets",
        _same(sets, number),
    )
    if rec.method == "manifold":
        rim = np.zeros(rec.num_samples, dtype=bool)
        rim[whole.open_facets.ravel()] = True
        rim = rim[rec.representatives]
        wrong = np.flatnonzero(rim != rec.boundary)
        yield "boundary flags are those of open facets", (rec.num_samples, wrong)


def _rows_beyond(some: Array, whole: Array) -> Array:
    """Rows of a list that are not in another."""
    known = {tuple(row) for row in np.sort(whole, axis=1).tolist()}
    rows = np.sort(some, axis=1)
    keep = [tuple(row) not in known for row in rows.tolist()]
    return rows[np.array(keep, dtype=bool)] if len(rows) else rows


def _num_sets(facets: Array) -> int:
    """Sets of facets connected through faces of one dimension less."""
    number, size = facets.shape
    if size == 1 or number == 0:
        return int(number)
    parts = np.concatenate([np.delete(facets, i, axis=1) for i in range(size)])
    ridges, numbers = _unique(parts)
    owners = np.tile(np.arange(number), size)
    pairs = np.column_stack([owners, number + numbers])
    return int(_groups(number + len(ridges), pairs)[0])


def _singular(found: _Complex) -> Array:
    """Vertices whose link is neither a sphere nor a ball, for K up to 3."""
    dim, rows, count = found.dim, found.rows, found.count
    unique, _, cofaces = found.facets
    bad = np.zeros(count, dtype=bool)
    bad[unique[cofaces > 2].ravel()] = True
    if dim == 1:
        return bad
    # The link of v has a vertex for each edge (v, w).
    corners = range(dim + 1)
    ends = [(i, j) for i in corners for j in corners if i != j]
    edges = np.concatenate([rows[:, [i, j]] for i, j in ends])
    edges, numbers = _unique(edges)
    number_of = dict(zip(ends, numbers.reshape(len(ends), -1), strict=True))
    joined = [
        np.column_stack([number_of[i, j], number_of[i, k]])
        for i in corners
        for j, k in itertools.combinations([c for c in corners if c != i], 2)
    ]
    _, labels = _groups(len(edges), np.concatenate(joined))
    parts = _unique(np.column_stack([edges[:, 0], labels]))[0]
    bad |= (np.bincount(parts[:, 0], minlength=count) != 1) & found.used
    if dim == 2:
        return bad
    # The links of edges are paths or circles: one piece, for two cofaces are known.
    pairs = [*itertools.combinations(corners, 2)]
    spokes = []
    for a, b in pairs:
        c, d = (corner for corner in corners if corner not in (a, b))
        spokes += [rows[:, [a, b, c]], rows[:, [a, b, d]]]
    spoke_rows, spoke_numbers = _unique(np.concatenate(spokes))
    spoke_numbers = spoke_numbers.reshape(len(pairs), 2, -1)
    joins = [np.column_stack([*one]) for one in spoke_numbers]
    _, labels = _groups(len(spoke_rows), np.concatenate(joins))
    rings = _unique(np.column_stack([spoke_rows[:, :2], labels]))[0]
    hubs, hub_numbers = _unique(rings[:, :2])
    bad[hubs[np.bincount(hub_numbers) > 1].ravel()] = True
    # Such a connected surface is a sphere or a disc by its Euler characteristic.
    euler = np.bincount(edges[:, 0], minlength=count)
    euler = euler - np.bincount(found.faces(2).ravel(), minlength=count)
    euler = euler + np.bincount(rows.ravel(), minlength=count)
    rim = np.zeros(count, dtype=bool)
    rim[found.open_facets.ravel()] = True
    bad |= (euler != np.where(rim, 1, 2)) & found.used
    return bad


def _of_links(rec: JudgedReconstruction, whole: _Complex) -> Named:
    dim = rec.dim
    said = _flagged(rec, rec.topology().singular_vertices)
    if 1 <= dim <= 3:
        bad = _singular(whole)
        name = "links are spheres and balls but for those that topology names"
        yield name, (int(whole.used.sum()), np.flatnonzero(bad != said))
        if rec.method == "manifold":
            told = _flagged(rec, rec.repair.singular_vertices)
            name = "links are spheres and balls but for those that repair names"
            yield name, (int(whole.used.sum()), np.flatnonzero(bad != told))
        return
    name = "links have the homology of spheres and balls but for those named"
    if len(rec.simplices) > _MANY_FOR_ALGEBRA:
        yield name, f"more than {_MANY_FOR_ALGEBRA:,} simplices"
        return
    wrong = [
        v
        for v in np.flatnonzero(whole.used & ~said)
        if not _link_is_plain(whole, int(v))
    ]
    yield name, (int(whole.used.sum()), np.array(wrong, dtype=np.int64))


def _link_is_plain(found: _Complex, vertex: int) -> bool:
    """Whether the link of a vertex has the homology of a sphere or a ball."""
    star = found.rows[(found.rows == vertex).any(axis=1)]
    link = star[star != vertex].reshape(len(star), found.dim)
    betti = _betti(link)
    return betti[0] == 1 and not any(betti[1:-1]) and betti[-1] in (0, 1)


def _betti(simplices: Array) -> tuple[int, ...]:
    """Betti numbers over Z2, by GUDHI."""
    import gudhi

    tree = gudhi.SimplexTree()
    for row in simplices.tolist():
        tree.insert(row)
    tree.compute_persistence(
        homology_coeff_field=2, min_persistence=-1.0, persistence_dim_max=True
    )
    betti = [int(b) for b in tree.betti_numbers()]
    return tuple((betti + [0] * simplices.shape[1])[: simplices.shape[1]])


def _induced_signs(rec: JudgedReconstruction, found: _Complex) -> Array:
    """Sign with which each simplex, as its columns orient it, has each of its facets."""
    odd = np.zeros(len(rec.simplices), dtype=bool)
    for i, j in itertools.combinations(range(found.dim + 1), 2):
        odd ^= rec.simplices[:, i] > rec.simplices[:, j]
    own = np.where(odd, -1, 1)
    signs: Array = own[:, None] * (-1) ** np.arange(found.dim + 1)[None]
    return signs


def _sheets(rec: JudgedReconstruction, found: _Complex) -> tuple[Array, Array, Array]:
    """Sets of simplices connected through facets of two, and which can be oriented.

    Third the facets across which the columns do not orient such a set alike.
    """
    _, numbers, cofaces = found.facets
    count = len(found.rows)
    order = np.argsort(numbers, axis=None, kind="stable")
    starts = np.cumsum(cofaces) - cofaces
    inner = np.flatnonzero(cofaces == 2)
    first, second = order[starts[inner]], order[starts[inner] + 1]
    one, other = (place // (found.dim + 1) for place in (first, second))
    signs = _induced_signs(rec, found).ravel()
    alike = signs[first] == -signs[second]
    number, labels = _groups(count, np.column_stack([one, other]))
    # Each simplex twice, once for each orientation: the two are joined where a walk
    # comes back the other way round.
    flip = np.where(alike, 0, count)
    pairs = np.column_stack([one, other + flip])
    pairs = np.concatenate(
        [pairs, np.column_stack([one + count, other + count - flip])]
    )
    _, double = _groups(2 * count, pairs)
    orientable = np.ones(number, dtype=bool)
    orientable[labels[double[:count] == double[count:]]] = False
    orientable[labels[(cofaces[numbers] > 2).any(axis=1)]] = False
    wrong = inner[~alike & orientable[labels[one]]]
    return labels, orientable, wrong


def _of_orientation(rec: JudgedReconstruction, whole: _Complex) -> Named:
    if len(rec.simplices) == 0:
        return
    labels, orientable, wrong = _sheets(rec, whole)
    unique = whole.facets[0]
    said = rec.topology().orientable
    yield (
        "topology knows whether it can be oriented",
        _same(said, bool(orientable.all())),
    )
    if rec.method != "manifold":
        return
    name = "simplices that share a facet are oriented alike"
    yield name, (len(unique), unique[wrong])
    if rec.vertices is None or rec.vertices.shape[1] != rec.dim + 1:
        return
    rim = np.zeros(len(orientable), dtype=bool)
    cofaces = whole.facets[2][whole.facets[1]]
    rim[labels[(cofaces != 2).any(axis=1)]] = True
    closed = np.flatnonzero(orientable & ~rim)
    inward = [s for s in closed if _volume(rec, np.flatnonzero(labels == s)) < 0]
    yield "closed parts are oriented outward", (len(closed), np.array(inward))


def _volume(rec: JudgedReconstruction, chosen: Array) -> float:
    """Enclosed by some simplices of a hypersurface, times K!."""
    assert rec.vertices is not None
    rows = rec.vertices[rec.simplices[chosen]]
    return float(np.linalg.det(rows - rows.mean(axis=(0, 1))).sum())


def _exact_sign(corners: Array) -> int:
    """Sign of a determinant of differences, in fractions."""
    rows = [[Fraction(float(x)) for x in row] for row in corners]
    matrix = [[a - b for a, b in zip(row, rows[0], strict=True)] for row in rows[1:]]
    sign = 1
    for i in range(len(matrix)):
        pivot = next((r for r in range(i, len(matrix)) if matrix[r][i] != 0), None)
        if pivot is None:
            return 0
        if pivot != i:
            matrix[i], matrix[pivot], sign = matrix[pivot], matrix[i], -sign
        sign = sign if matrix[i][i] > 0 else -sign
        for r in range(i + 1, len(matrix)):
            share = matrix[r][i] / matrix[i][i]
            matrix[r] = [
                a - share * b for a, b in zip(matrix[r], matrix[i], strict=True)
            ]
    return sign


def _of_volumes(rec: JudgedReconstruction) -> Named:
    if rec.vertices is None or rec.vertices.shape[1] != rec.dim:
        return
    if rec.method != "manifold":
        return
    corners = rec.vertices[rec.simplices]
    sides = corners[:, 1:] - corners[:, :1]
    # Scaled row by row: neither very long nor very short edges lose the sign.
    lengths = np.abs(sides).max(axis=2, keepdims=True)
    scaled = sides / np.where(lengths > 0, lengths, 1)
    determinant = np.linalg.det(scaled)
    signs = np.sign(determinant)
    unsure = np.abs(determinant) <= _SURE * np.prod(
        np.linalg.norm(scaled, axis=2), axis=1
    )
    for i in np.flatnonzero(unsure):
        signs[i] = _exact_sign(corners[i])
    yield "no simplex is flat", (len(signs), np.flatnonzero(signs == 0))
    yield "no simplex has negative volume", (len(signs), np.flatnonzero(signs < 0))


def _of_topology(rec: JudgedReconstruction, whole: _Complex) -> Named:
    said = rec.topology()
    if len(rec.simplices) == 0:
        return
    counts = tuple(len(whole.faces(k)) for k in range(rec.dim + 1))
    yield "topology counts the faces", _same(said.num_simplices, counts)
    euler = sum((-1) ** k * n for k, n in enumerate(counts))
    yield (
        "topology knows the Euler characteristic",
        _same(said.euler_characteristic, euler),
    )
    pairs = np.concatenate([whole.rows[:, [0, i]] for i in range(1, rec.dim + 1)])
    number, _ = _groups(rec.num_samples, pairs)
    number -= int(np.count_nonzero(~whole.used))
    yield "topology counts the components", _same(said.components, number)
    sizes = np.bincount(whole.facets[2])
    cofaces = {k: int(n) for k, n in enumerate(sizes) if n}
    yield "topology counts cofaces", _same(said.coface_counts, cofaces)
    sets = _num_sets(whole.open_facets)
    yield "topology counts boundary components", _same(said.boundary_components, sets)
    closed = set(cofaces) == {2}
    yield "topology knows whether it is closed", _same(said.closed, closed)
    name = "topology knows the Betti numbers"
    if len(rec.simplices) > _MANY_FOR_ALGEBRA:
        yield name, f"more than {_MANY_FOR_ALGEBRA:,} simplices"
    else:
        yield name, _same(said.betti_numbers, _betti(whole.rows))
    if rec.method == "manifold":
        wrong = _difference(whole.faces(1), rec.edges)
        yield "edges are those of the simplices", (counts[1], wrong)


def _of_samples(rec: JudgedReconstruction, whole: _Complex) -> Named:
    count = rec.num_samples
    lowest = rec.representatives.astype(np.int64)
    own = np.arange(count)
    wrong = (lowest < 0) | (lowest > own)
    yield "copies are those of samples before them", (count, np.flatnonzero(wrong))
    if wrong.any():
        return
    yield "copies have one sample", (count, np.flatnonzero(lowest[lowest] != lowest))
    copy = lowest != own
    report = rec.repair
    merged = int(np.count_nonzero(copy))
    yield "copies are counted", _same(report.merged_samples, merged)
    flags = {
        name: _flagged(rec, numbers)
        for name, numbers in (
            ("outliers", rec.outliers),
            ("invalid", rec.invalid),
            ("attached", rec.attached),
            ("unused", report.unused_vertices),
        )
    }
    used = whole.used
    # A copy is where its sample is, whichever of them is listed.
    times = used.astype(int) + sum(f.astype(int) for f in flags.values())
    not_once = np.flatnonzero((times != 1) & ~copy)
    yield "each sample is used, left out or reported unused, once", (count, not_once)
    alike = np.flatnonzero(copy & (used | flags["unused"] | flags["invalid"]))
    yield "copies are in no simplex", (count, alike)
    elsewhere = copy & (times > 0) & (flags["outliers"] != flags["outliers"][lowest])
    yield "copies are left out with their sample", (count, np.flatnonzero(elsewhere))
    for name in ("outliers", "invalid", "attached"):
        numbers = getattr(rec, name)
        down = np.flatnonzero(np.diff(numbers) <= 0)
        yield f"{name} ascend", (len(numbers), down)


def _of_positions(rec: JudgedReconstruction) -> Named:
    if rec.vertices is None or rec.samples is None:
        return
    count, samples, vertices = rec.num_samples, rec.samples, rec.vertices
    lowest = rec.representatives
    finite = np.isfinite(samples).all(axis=1)
    invalid = _flagged(rec, rec.invalid)
    yield (
        "samples that are no points are invalid",
        (
            count,
            np.flatnonzero(finite == invalid),
        ),
    )
    near = _COINCIDE * np.abs(samples[finite]).max(initial=0.0)
    off = np.abs(samples - samples[lowest]).max(axis=1)
    yield (
        "copies coincide with their sample",
        (count, np.flatnonzero(finite & (off > near))),
    )
    unique, numbers = _unique(samples[finite] + 0.0)
    heads = np.full(len(unique), count)
    np.minimum.at(heads, numbers, lowest[finite])
    apart = np.flatnonzero(finite)[heads[numbers] != lowest[finite]]
    yield "samples that are equal have one representative", (count, apart)
    moved = rec.smoothing is not None and rec.smoothing.moved
    expected = samples if rec.smoothing is None else rec.smoothing.points
    assert expected is not None
    kept = finite & ~_flagged(rec, rec.attached)
    differ = (vertices != expected).any(axis=1) & kept
    what = "smoothed samples" if moved else "samples"
    yield f"vertices are the {what}", (count, np.flatnonzero(differ))
    name = "attached samples are on the complex"
    if len(rec.attached) * len(rec.simplices) > _MANY_PAIRS:
        yield name, f"more than {_MANY_PAIRS:,} pairs of sample and simplex"
    elif len(rec.attached) and len(rec.simplices):
        near = _ON_COMPLEX * np.abs(vertices[finite] - vertices[finite][0]).max()
        off = ~_are_on(vertices, rec.simplices, rec.attached, near)
        yield name, (len(rec.attached), rec.attached[off])


def _are_on(vertices: Array, simplices: Array, samples: Array, near: float) -> Array:
    """Whether samples are in a simplex, by the share of each corner in them."""
    corners = vertices[simplices]
    sides = corners[:, 1:] - corners[:, :1]
    inverse = np.linalg.pinv(sides)
    size = np.abs(sides).max(axis=(1, 2))
    slack = near / np.where(size > 0, size, 1)
    found = np.zeros(len(samples), dtype=bool)
    for i, sample in enumerate(samples):
        step = vertices[sample] - corners[:, 0]
        shares = np.einsum("mdk,md->mk", inverse, step)
        rest = np.linalg.norm(step - np.einsum("mk,mkd->md", shares, sides), axis=1)
        least = np.minimum(shares.min(axis=1), 1 - shares.sum(axis=1))
        found[i] = ((least >= -slack) & (rest <= near)).any()
    return found


def _of_report(rec: JudgedReconstruction, whole: _Complex) -> Named:
    report = rec.repair
    for name in ("disputed_simplices", "filled_simplices", "unstarred_simplices"):
        rows = np.sort(getattr(report, name).astype(np.int64), axis=1)
        if rows.size == 0:
            continue
        outside = ((rows < 0) | (rows >= rec.num_samples)).any(axis=1)
        outside |= (rows[:, 1:] == rows[:, :-1]).any(axis=1)
        counts = np.bincount(_unique(rows)[1])
        outside |= (counts > 1)[_unique(rows)[1]]
        said = name.replace("_", " ")
        yield f"{said} are simplices, each once", (len(rows), np.flatnonzero(outside))
    used = whole.used
    if rec.method == "manifold":
        put = report.inserted_vertices
        lost = put[~used[put] & ~np.isin(put, report.unused_vertices)]
        yield (
            "samples that were put back are used, or reported unused",
            (len(put), lost),
        )
        filled = report.filled_simplices
        strange = _rows_beyond(filled, rec.simplices)
        yield "filled simplices are in the result", (len(filled), strange)
        # All else is what the stars agree on, of which mending may have taken some.
        agreed = _rows_beyond(rec.simplices, filled)
        clear = _rows_beyond(agreed, report.disputed_simplices)
        disputed = _rows_beyond(agreed, clear)
        name = "what was not filled was not disputed"
        yield name, (len(agreed), disputed)
        name = "what was not filled was agreed on"
        yield name, (len(agreed), agreed[report.num_agreed :])


def _of_paper_steps(rec: JudgedReconstruction, whole: _Complex) -> Named:
    if rec.edge_sets is None or rec.stars is None:
        return
    count, dim = rec.num_samples, rec.dim
    offsets, indices = rec.edge_sets
    sizes = np.diff(offsets)
    owner = np.repeat(np.arange(count), sizes)
    wrong = (indices < 0) | (indices >= count) | (indices == owner)
    wrong[1:] |= (np.diff(indices) <= 0) & (owner[1:] == owner[:-1])
    yield (
        "edge sets are sorted samples, each once",
        (len(indices), np.flatnonzero(wrong)),
    )
    stars, rows = rec.stars
    star_owner = np.repeat(np.arange(count), np.diff(stars))
    foreign = np.flatnonzero(rows[:, 0] != star_owner)
    yield "stars are those of their sample", (len(rows), foreign)
    if wrong.any() or len(foreign):
        return
    beside = np.column_stack([np.repeat(star_owner, dim), rows[:, 1:].ravel()])
    unseen = ~np.isin(beside @ [count, 1], owner * count + indices)
    name = "vertices of stars are in edge sets"
    yield name, (len(beside), beside[unseen])
    # The region of a sample is a simple polytope: corners and sides go by its dimension.
    bounded = ~np.asarray(rec.unbounded) & (sizes > 0)
    corners = np.diff(stars)
    if dim <= 3:
        expected = {1: np.full(count, 2), 2: sizes, 3: 2 * sizes - 4}[dim]
        off = np.flatnonzero(bounded & (corners != expected))
        yield "bounded regions are polytopes", (int(bounded.sum()), off)
    pairs, numbers = _unique(np.sort(np.column_stack([owner, indices]), axis=1))
    pairs = pairs[
        np.bincount(numbers, minlength=len(pairs)) >= 2 - (rec.edge_rule == "either")
    ]
    name = "edges are those that the edge sets have"
    yield name, (len(pairs), _difference(pairs, rec.edges))
    name = "simplices are the cliques of the edges"
    if len(pairs) > _MANY_FOR_ALGEBRA:
        yield name, f"more than {_MANY_FOR_ALGEBRA:,} edges"
    else:
        cliques = _cliques(pairs, count, dim)
        yield name, (len(cliques), _difference(cliques, rec.simplices))
    own, numbers = _unique(
        np.concatenate([whole.rows, np.sort(rows.astype(np.int64), axis=1)])
    )
    starred = np.zeros(len(own), dtype=bool)
    starred[numbers[len(rec.simplices) :]] = True
    bare = own[np.unique(numbers[: len(rec.simplices)])]
    bare = bare[~starred[np.unique(numbers[: len(rec.simplices)])]]
    name = "simplices in no star are reported"
    wrong_rows = _difference(bare, rec.repair.unstarred_simplices)
    yield name, (len(rec.simplices), wrong_rows)
    if rec.estimator == "enclosure":
        lacking = rec.tangent_simplices[:, 0] < 0  # type: ignore[index]
        lowest = rec.representatives
        differ = np.flatnonzero(lacking[lowest] != rec.boundary)
        name = "boundary flags are those of samples without tangent basis"
        yield name, (count, differ)


def _cliques(edges: Array, count: int, dim: int) -> Array:
    """All sets of K + 1 samples that are joined to each other."""
    later: list[set[int]] = [set() for _ in range(count)]
    for a, b in edges.tolist():
        later[a].add(b)
    found: list[tuple[tuple[int, ...], set[int]]]
    found = [((a, b), later[a] & later[b]) for a, b in edges.tolist()]
    for _ in range(dim - 1):
        found = [
            ((*clique, c), common & later[c])
            for clique, common in found
            for c in common
        ]
    return np.array([clique for clique, _ in found], dtype=np.int64).reshape(
        -1, dim + 1
    )


def _of_tangents(rec: JudgedReconstruction) -> Named:
    bases = vars(rec).get("tangents")
    if bases is None:
        return
    known = np.isfinite(bases).all(axis=(1, 2))
    some = np.nan_to_num(bases)
    products = np.einsum("nkd,njd->nkj", some, some)
    off = np.abs(products - np.eye(rec.dim)).max(axis=(1, 2))
    wrong = np.flatnonzero(known & (off > _ORTHONORMAL))
    yield "tangent bases are orthonormal", (int(known.sum()), wrong)


def _of_openings(rec: JudgedReconstruction, whole: _Complex) -> Named:
    wrong = [
        i
        for i, one in enumerate(rec.openings)
        if (
            one.samples.size
            and not 0 <= one.samples.min() <= one.samples.max() < rec.num_samples
        )
        or (np.diff(one.samples) <= 0).any()
    ]
    yield "samples of openings are samples", (len(rec.openings), np.array(wrong))
    # Some simplices at the rim of what was opened may have been put back.
    there = {tuple(row) for row in whole.rows.tolist()}
    filled = [
        i
        for i, one in enumerate(rec.openings)
        if one.decision == "open"
        and len(one.simplices)
        and all(tuple(sorted(row)) in there for row in one.simplices.tolist())
    ]
    name = "what is called open was not left as it was"
    yield name, (len(rec.openings), np.array(filled))


def _of_digests(rec: JudgedReconstruction) -> Named:
    given = rec.samples if rec.samples is not None else rec._source.matrix
    counted = _digest(given)
    yield "the digest of the samples is theirs", _same(rec.provenance.input, counted)
    arrays = [a for a in (rec.vertices, rec.simplices) if a is not None]
    yield "the digest of the result is its own", _same(rec.digest, _digest(*arrays))


def _digest(*arrays: Array) -> str:
    """As the page on saved results describes it."""
    total = hashlib.sha256()
    for array in arrays:
        kind = array.dtype.newbyteorder("<").str.replace("|", "<")
        total.update(f"{kind} {','.join(map(str, array.shape))}\n".encode())
        total.update(array.astype(kind).tobytes())
    return f"sha256:{total.hexdigest()}"


def _of_quality(rec: JudgedReconstruction) -> Named:
    quality = vars(rec).get("quality")
    # The paper's method calls boundary what has no tangent basis.
    if quality is None or rec.method != "manifold":
        return
    count = rec.num_samples
    differ = np.flatnonzero(quality.boundary != rec.boundary)
    yield "the boundary of quality is that of the result", (count, differ)
