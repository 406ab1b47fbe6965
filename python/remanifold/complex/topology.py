# SPDX-License-Identifier: GPL-3.0-or-later
"""What a simplicial complex is: counts, links, homology."""

from __future__ import annotations

import functools
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.html import fragment, shares
from remanifold._base.progress import progress_callback
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold._base.validation import check_int, check_num_threads, check_simplices

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback

_MANY_FOR_ALGEBRA = 200_000  # simplices
_MANY_PARTS = 12  # components that are described one by one


def simplex_names(dim: int) -> list[str]:
    """Name the simplices of dimension 0 to ``dim``."""
    names = ["vertices", "edges", "triangles", "tetrahedra"]
    return (names + [f"{k}-simplices" for k in range(4, dim + 1)])[: dim + 1]


@dataclass(frozen=True, eq=False, repr=False)
class Topology(ReadOnlyArrays):
    """Topology of a pure K-dimensional complex.

    Attributes
    ----------
    dim : int
        K.
    num_simplices : tuple of int
        Simplices of dimension 0 to K; samples in no simplex do not count.
    components : int
        Connected components.
    euler_characteristic : int
        Alternating sum of `num_simplices`.
    manifold : bool
        Every vertex link is a sphere or a ball; for K >= 4 as far as the conditions of
        `compute_topology` tell.
    closed : bool
        Every (K-1)-face has exactly two cofaces.
    orientable : bool
        The simplices can be oriented alike across all (K-1)-faces; False where some
        such face has more than two cofaces.
    boundary_components : int
        Connected sets of (K-1)-faces in one simplex only (sharing a (K-2)-face; for
        K = 1 each on its own).
    coface_counts : dict of int to int
        Number of (K-1)-faces by the number of K-simplices they lie in.
    singular_vertices : ndarray of int32
        Vertices whose link is neither a sphere nor a ball; for K >= 4 those that the
        conditions of `compute_topology` find.
    """

    dim: int
    num_simplices: tuple[int, ...]
    components: int
    euler_characteristic: int
    manifold: bool
    closed: bool
    orientable: bool
    boundary_components: int
    coface_counts: dict[int, int]
    singular_vertices: NDArray[np.int32]
    _simplices: NDArray[np.int32]
    _closed_patches: tuple[int, int] | None

    def __repr__(self) -> str:
        known = self.counting_settles_homology or "_homology" in vars(self)
        return one_line(
            self,
            dim=self.dim,
            num_simplices=self.num_simplices,
            betti_numbers=self.betti_numbers if known else None,
            components=None if known else self.components,
            manifold=self.manifold,
            closed=self.closed,
            orientable=self.orientable,
        )

    @functools.cached_property
    def name(self) -> str:
        """Name of a connected curve or surface that is a manifold, such as "a torus".

        Empty for all else. With boundary it is the closed surface less discs, but for
        a disc, an annulus and a Möbius band.
        """
        if not self.manifold or self.components != 1 or not 1 <= self.dim <= 2:
            return ""
        if self.dim == 1:
            return "a closed curve" if self.closed else "an arc"
        holes = self.boundary_components
        euler = self.euler_characteristic + holes  # with discs sewn in
        if self.orientable:
            genus = (2 - euler) // 2
            shape = {0: "a sphere", 1: "a torus"}.get(
                genus, f"a surface of genus {genus}"
            )
        else:
            caps = 2 - euler
            shape = {1: "a projective plane", 2: "a Klein bottle"}.get(
                caps, f"a sphere with {caps} cross-caps"
            )
        named = {(True, 2, 1): "a disc", (True, 2, 2): "an annulus"}
        named |= {(False, 1, 1): "a Möbius band"}
        if holes == 0:
            return shape
        less = f"{shape} less {'a disc' if holes == 1 else f'{holes:,} discs'}"
        return named.get((self.orientable, euler, holes), less)

    @functools.cached_property
    def description(self) -> str:
        """What the complex is, such as "a closed surface of genus 1 (a torus)"."""
        noun = {0: "set of points", 1: "curve", 2: "surface"}.get(
            self.dim, f"{self.dim}-manifold"
        )
        if self.num_simplices[-1] == 0:
            return f"nothing: no {simplex_names(self.dim)[-1]}"
        if not self.manifold:
            count = len(self.singular_vertices)
            around = f"around {count:,} {'vertex' if count == 1 else 'vertices'}"
            return f"no {noun}: {around} it is neither a ball nor half of one"
        if self.components == 1 or self.dim == 0:
            return self._describe_one(noun)
        if self.components > _MANY_PARTS:
            return f"{self.components:,} separate {noun}s"
        parts = Counter(part.description for part in self._parts())
        if len(parts) == 1:
            return f"{self.components} separate parts, each {next(iter(parts))}"
        told = (
            f"{count} times {what}" if count > 1 else what
            for what, count in parts.items()
        )
        return f"{self.components} separate parts: {', '.join(told)}"

    def _describe_one(self, noun: str) -> str:
        if self.dim == 0:
            return f"{self.components:,} points"
        if self.dim == 1:
            return self.name
        edge = ""
        if self.boundary_components:
            count = self.boundary_components
            kind = "curve" if self.dim == 2 else "component"
            edge = f" with {count:,} boundary {kind}{'' if count == 1 else 's'}"
        closed = "closed " if self.closed else ""
        if self.dim == 2 and self.orientable:
            euler = self.euler_characteristic + self.boundary_components
            genus = (2 - euler) // 2
            known = f" ({self.name})" if "genus" not in self.name else ""
            return f"a {closed}surface of genus {genus}{edge}{known}"
        side = "orientable" if self.orientable else "non-orientable"
        if self.dim == 2:
            return f"a {closed}{side} surface{edge} ({self.name})"
        betti = ""
        if self.counting_settles_homology or "_homology" in vars(self):
            numbers = ", ".join(map(str, self.betti_numbers))
            betti = f", Betti numbers {numbers}"
        return f"{'a' if closed or side[0] == 'n' else 'an'} {closed}{side} {noun}{edge}{betti}"

    def _parts(self) -> Iterator[Topology]:
        """Topology of each component."""
        count = int(self._simplices.max()) + 1
        own = _core.component_labels(self._simplices, count)[self._simplices[:, 0]]
        for label in range(self.components):
            yield topology_of(self._simplices[own == label], count)

    def _repr_html_(self) -> str:
        rows: list[tuple[str, object]] = [
            (name, f"{count:,}")
            for name, count in zip(
                simplex_names(self.dim), self.num_simplices, strict=True
            )
        ]
        rows.append(("Euler characteristic", f"{self.euler_characteristic:,}"))
        rows.append(("components", f"{self.components:,}"))
        known = self.counting_settles_homology or "_homology" in vars(self)
        if known:
            rows.append(("Betti numbers", ", ".join(map(str, self.betti_numbers))))
        rows += [
            (word, "yes" if value else "no")
            for word, value in (
                ("manifold", self.manifold),
                ("closed", self.closed),
                ("orientable", self.orientable),
            )
        ]
        rows.append(("boundary components", f"{self.boundary_components:,}"))
        if len(self.singular_vertices):
            rows.append(("singular vertices", f"{len(self.singular_vertices):,}"))
        bars = [(f"b{k}", b) for k, b in enumerate(self.betti_numbers)] if known else []
        picture = shares("Betti numbers", bars) if bars else ""
        return fragment(self.description, rows, picture)

    @property
    def num_vertices(self) -> int:
        """Vertices that some simplex uses."""
        return self.num_simplices[0]

    @property
    def betti_numbers(self) -> tuple[int, ...]:
        """Betti numbers of dimension 0 to K over Z2; computed when first asked for."""
        return self._homology[0]

    @property
    def betti_numbers_mod3(self) -> tuple[int, ...]:
        """The same over Z3; where they differ there is 2-torsion."""
        return self._homology[1]

    @property
    def counting_settles_homology(self) -> bool:
        """Whether the Betti numbers follow from counts, without linear algebra."""
        return (
            self.num_simplices[-1] == 0
            or self.dim <= 1
            or (self.dim == 2 and self._closed_patches is not None)
        )

    @property
    def homology_is_cheap(self) -> bool:
        """Whether the Betti numbers take no longer than a reconstruction."""
        return (
            self.counting_settles_homology
            or self.num_simplices[-1] <= _MANY_FOR_ALGEBRA
        )

    @functools.cached_property
    def _homology(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Over Z2 and Z3; by counting where that settles it, else by GUDHI."""
        if len(self._simplices) == 0:
            return (0,) * (self.dim + 1), (0,) * (self.dim + 1)
        components, euler = self.components, self.euler_characteristic
        if self.dim == 0:
            return (components,), (components,)
        if self.dim == 1:
            graph = (components, components - euler)
            return graph, graph
        if self.dim == 2 and self._closed_patches is not None:
            # Closed patches carry the second homology, orientable ones outside Z2.
            over_2, over_3 = (
                (components, components + b - euler, b) for b in self._closed_patches
            )
            return over_2, over_3
        tree = _simplex_tree(self._simplices)
        return _homology(tree, self.dim, 2), _homology(tree, self.dim, 3)


def compute_topology(
    simplices: ArrayLike,
    num_vertices: int,
    *,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Topology:
    """Topology of the complex whose top simplices are the rows.

    Exact for K <= 3. For K >= 4 links are proved to be spheres or balls by collapsing
    them. Where that does not succeed a link counts as one by conditions that are
    necessary, not sufficient: it is a connected pseudomanifold with the Euler
    characteristic of a sphere or a ball, its homology over Z2 and Z3 is that of one,
    and the same holds for the links of its own vertices. `manifold` and
    `singular_vertices` may then miss a singular vertex, but report none that is not.

    Parameters
    ----------
    simplices : array_like of int, shape (M, K+1)
        Simplices, each once; columns in any order.
    num_vertices : int
        N, more than any vertex.
    num_threads, progress
        As in `remanifold.neighborhoods`.

    Returns
    -------
    Topology
    """
    return topology_of(
        check_simplices(simplices),
        check_int(num_vertices, "num_vertices", minimum=0),
        num_threads,
        progress,
    )


def topology_of(
    simplices: NDArray[np.int32],
    count: int,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Topology:
    """`compute_topology` of simplices that are known to be in order."""
    if simplices.shape[1] == 1:
        return _topology_of_points(simplices)
    with progress_callback(progress) as callback:
        counts = _core.topology(
            simplices, count, check_num_threads(num_threads), callback
        )
    dim = simplices.shape[1] - 1
    singular = counts["singular_vertices"]
    if len(counts["undecided_vertices"]):
        singular = _singular_by_homology(
            simplices, singular, counts["undecided_vertices"]
        )
    return Topology(
        dim=dim,
        num_simplices=tuple(int(n) for n in counts["face_counts"]),
        components=counts["components"],
        euler_characteristic=counts["euler_characteristic"],
        manifold=len(simplices) > 0 and len(singular) == 0,
        closed=counts["closed"],
        orientable=len(simplices) > 0 and counts["orientable"],
        boundary_components=counts["boundary_components"],
        coface_counts={
            cofaces: int(number)
            for cofaces, number in enumerate(counts["coface_counts"])
            if number > 0
        },
        singular_vertices=singular,
        _simplices=simplices,
        _closed_patches=(
            (counts["closed_patches"], counts["closed_orientable_patches"])
            if counts["pseudomanifold"]
            else None
        ),
    )


def _topology_of_points(simplices: NDArray[np.int32]) -> Topology:
    """Of a boundary of curves: isolated points are a closed manifold of dimension 0."""
    count = len(simplices)
    return Topology(
        dim=0,
        num_simplices=(count,),
        components=count,
        euler_characteristic=count,
        manifold=count > 0,
        closed=True,
        orientable=count > 0,
        boundary_components=0,
        coface_counts={},
        singular_vertices=np.empty(0, dtype=np.int32),
        _simplices=simplices,
        _closed_patches=None,
    )


def _simplex_tree(simplices: NDArray[np.int32]) -> Any:
    import gudhi

    tree = gudhi.SimplexTree()
    # A copy: older releases refuse what cannot be written to.
    tree.insert_batch(np.array(simplices.T, order="C"), np.zeros(len(simplices)))
    return tree


def _homology(tree: Any, dim: int, modulus: int) -> tuple[int, ...]:
    tree.compute_persistence(
        homology_coeff_field=modulus, min_persistence=-1.0, persistence_dim_max=True
    )
    betti = [int(b) for b in tree.betti_numbers()]
    return tuple((betti + [0] * (dim + 1))[: dim + 1])


def _singular_by_homology(
    simplices: NDArray[np.int32],
    known: NDArray[np.int32],
    undecided: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Add those undecided whose link lacks the homology of a sphere or a ball."""
    arity = simplices.shape[1]
    bad = set(known.tolist())
    order = np.argsort(simplices, axis=None, kind="stable")
    sorted_vertices = simplices.ravel()[order]
    starts = np.searchsorted(sorted_vertices, undecided, side="left")
    ends = np.searchsorted(sorted_vertices, undecided, side="right")
    for vertex, start, end in zip(undecided, starts, ends, strict=True):
        star = simplices[order[start:end] // arity]
        link = star[star != vertex].reshape(len(star), arity - 1)
        tree = _simplex_tree(link)
        for modulus in (2, 3):
            betti = _homology(tree, arity - 2, modulus)
            if betti[0] != 1 or any(betti[1:-1]) or betti[-1] > 1:
                bad.add(int(vertex))
        if arity >= 6 and len(_singular_by_homology(link, known[:0], np.unique(link))):
            bad.add(int(vertex))
    return np.array(sorted(bad), dtype=np.int32)
