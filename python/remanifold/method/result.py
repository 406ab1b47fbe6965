# SPDX-License-Identifier: GPL-3.0-or-later
"""What a reconstruction is: a complex, how it was made, and what had to be mended."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.digest import digest
from remanifold._base.distinct import distinct
from remanifold._base.html import fragment, shares
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold.complex.data import ComplexData

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.method.cleaning import Smoothing
    from remanifold.method.openings import Opening
    from remanifold.method.options import Options
    from remanifold.method.provenance import Parameters, Provenance
    from remanifold.method.steps import EdgeSets, Stars


# What is left to mend, and the arrays of `Repair` that list it.
_REMAINING = {
    "open face": "hole_faces",
    "callous face": "callous_faces",
    "unstarred simplex": "unstarred_simplices",
    "singular vertex": "singular_vertices",
    "unused vertex": "unused_vertices",
}


@dataclass(frozen=True, eq=False, repr=False)
class Repair(ReadOnlyArrays):
    """What was disputed, what was done about it, and what the result lacks.

    The paper's method repairs nothing: there this says what it leaves.

    Attributes
    ----------
    method : str
        Method of the reconstruction.
    open_faces : ndarray, shape (H, K), int32
        (K-1)-faces in one simplex only.
    num_boundary_components : int
        Connected sets of open faces that count as boundary. Manifold method: all with
        ``boundary="auto"``, those of which most faces are within the mask with a mask,
        none with ``boundary=False``. Paper: those with a vertex that is a boundary sample or has
        one in its edge set.
    num_holes : int
        The other connected sets of open faces.
    hole_faces : ndarray, shape (G, K), int32
        The faces of these.
    callous_faces : ndarray, shape (F, K), int32
        (K-1)-faces in more than two simplices.
    unstarred_simplices : ndarray, shape (U, K+1), int32
        Paper: simplices that are cliques of the graph but in the star of none of their
        vertices.
    singular_vertices : ndarray of int32
        Manifold method: vertices whose link is neither a sphere nor a ball, by the same
        test as `Topology.singular_vertices` up to K = 3.
    unused_vertices : ndarray of int32
        Samples in no simplex but for merged copies, `Reconstruction.outliers` and
        `Reconstruction.attached`. With
        the manifold method they are too far from all simplices around their neighbors.
    merged_samples : int
        Samples that coincide with one of lower index and were merged with it.
    hole_radius : float
        Manifold method: radius of the smallest round hole left open, in local scales.
    num_agreed : int
        Manifold method: star simplices that are in the stars of all their vertices.
    disputed_simplices : ndarray, shape (P, K+1), int32
        Manifold method: star simplices that are not.
    filled_simplices : ndarray, shape (C, K+1), int32
        Manifold method: simplices that the chain of least energy chose.
    inserted_vertices : ndarray of int32
        Manifold method: samples that the chain left out, put back by subdivision.
    cut_vertices : ndarray of int32
        Manifold method, up to K = 4: vertices whose link no move mended, so that all
        simplices there were taken out but those of one fan, whose link is a sphere or a
        ball.
    num_cavities, num_cut_cavities : int
        Manifold method: cavities filled; those of them that were too large for one
        program and were cut into windows.
    num_programs, num_integer_programs, largest_program : int
        Manifold method: linear programs of cavities and windows; integer programs; the
        candidates that the largest of all chose from.
    num_unsolved : int
        Programs without a solution within the solver's limits.
    num_out_of_time : int
        Those of them that `max_seconds` left no time for.
    hole_size : float
        Manifold method: the same in the units of the samples, where the local scale is
        the median of all.
    """

    method: str
    open_faces: NDArray[np.int32]
    num_boundary_components: int
    num_holes: int
    hole_faces: NDArray[np.int32]
    callous_faces: NDArray[np.int32]
    unstarred_simplices: NDArray[np.int32]
    singular_vertices: NDArray[np.int32]
    unused_vertices: NDArray[np.int32]
    merged_samples: int
    hole_radius: float
    num_agreed: int
    disputed_simplices: NDArray[np.int32]
    filled_simplices: NDArray[np.int32]
    inserted_vertices: NDArray[np.int32]
    num_cavities: int
    num_cut_cavities: int
    num_programs: int
    num_integer_programs: int
    largest_program: int
    num_unsolved: int
    # With defaults: files of results that were saved before have none.
    hole_size: float = float("nan")
    cut_vertices: NDArray[np.int32] = field(
        default_factory=lambda: np.empty(0, dtype=np.int32)
    )
    num_out_of_time: int = 0

    def __repr__(self) -> str:
        manifold = self.method == "manifold"
        return one_line(
            self,
            method=self.method,
            agreed=self.num_agreed if manifold else None,
            disputed=len(self.disputed_simplices) if manifold else None,
            filled=len(self.filled_simplices) if manifold else None,
            boundary_components=self.num_boundary_components,
            unwanted_holes=self.num_holes,
            remaining=sum(len(getattr(self, name)) for name in _REMAINING.values()),
        )

    @property
    def num_callouses(self) -> int:
        """Faces in more than two simplices, and cliques in no star."""
        return len(self.callous_faces) + len(self.unstarred_simplices)

    @property
    def lacks(self) -> list[str]:
        """What the result lacks, in words; nothing where all is as it was asked for."""
        return [
            f"{number:,} {one if number == 1 else more}"
            for number, one, more in (
                (
                    self.num_holes,
                    "hole where none was asked for",
                    "holes where none were asked for",
                ),
                (
                    len(self.callous_faces),
                    "face in more than two simplices",
                    "faces in more than two simplices",
                ),
                (
                    len(self.unstarred_simplices),
                    "simplex in no star",
                    "simplices in no star",
                ),
                (
                    len(self.singular_vertices),
                    "vertex without a proper link",
                    "vertices without a proper link",
                ),
                (
                    self.num_unsolved,
                    "cavity without a solution",
                    "cavities without a solution",
                ),
            )
            if number
        ]

    def _repr_html_(self) -> str:
        lacks = self.lacks
        answer = "nothing is left to mend"
        if lacks:
            answer = f"the result lacks something: {', '.join(lacks)}"
        parts = [
            ("agreed", self.num_agreed),
            ("disputed", len(self.disputed_simplices)),
            ("filled", len(self.filled_simplices)),
        ]
        rows: list[tuple[str, object]] = [("method", self.method)]
        rows += [
            (name, f"{number:,}")
            for name, number in (
                *(parts if self.method == "manifold" else ()),
                ("open faces", len(self.open_faces)),
                ("boundary components", self.num_boundary_components),
                ("unwanted holes", self.num_holes),
                ("unused samples", len(self.unused_vertices)),
                ("copies merged", self.merged_samples),
            )
        ]
        picture = shares("Simplices", parts) if self.method == "manifold" else ""
        return fragment(answer, rows, picture)

    def remaining(self) -> list[tuple[str, tuple[int, ...]]]:
        """All that is left to mend: the reason and the vertices of each place."""
        return [
            (reason, tuple(place))
            for reason, name in _REMAINING.items()
            for place in np.atleast_2d(getattr(self, name).T).T.tolist()
        ]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ReconstructionData(ComplexData):
    """The data of a `Reconstruction`, and what follows from it without more work."""

    samples: NDArray[np.float64] | None
    boundary: NDArray[np.bool_]
    representatives: NDArray[np.int32]
    outliers: NDArray[np.int32]
    attached: NDArray[np.int32]
    smoothing: Smoothing | None
    method: str
    estimator: str
    search: str
    num_neighbors: int
    recall: float
    timings: dict[str, float]
    openings: tuple[Opening, ...] = ()
    significance: float = 0.0
    provenance: Provenance
    tangent_simplices: NDArray[np.int32] | None = None
    edge_sets: EdgeSets | None = None
    stars: Stars | None = None
    unbounded: NDArray[np.bool_] | None = None
    edge_rule: str | None = None
    invalid: NDArray[np.int32] = field(
        default_factory=lambda: np.empty(0, dtype=np.int32)
    )
    _report: dict[str, Any] = field(default_factory=dict)
    _frames: tuple[NDArray[np.float64], NDArray[np.int32], float] | None = None
    # What was decided by hand: samples of each place, and whether it is open.
    _decisions: tuple[tuple[NDArray[np.int32], bool], ...] = ()
    _options: Options | None = None

    @property
    def parameters(self) -> Parameters:
        """Those of `reconstruct` as they were used, and why; see ``provenance``."""
        return self.provenance.parameters

    @functools.cached_property
    def digest(self) -> str:
        """SHA-256 of ``vertices`` and ``simplices``, as `Provenance` describes it.

        Of ``simplices`` alone where there are no coordinates.
        """
        arrays = [a for a in (self.vertices, self.simplices) if a is not None]
        return digest(*arrays)

    @property
    def comment(self) -> str:
        """What a file says of where it comes from: version, parameters, digests."""
        return "\n".join(self.provenance.comment(self.digest))

    @property
    def num_samples(self) -> int:
        """N, copies included."""
        return len(self.boundary)

    @property
    def num_vertices(self) -> int:
        """The same: samples in no simplex count."""
        return self.num_samples

    @functools.cached_property
    def left_out(self) -> NDArray[np.int32]:
        """`outliers`, `invalid` and `attached`: what no simplex is meant to have."""
        parts = (self.outliers, self.invalid, self.attached)
        left_out = distinct(np.concatenate(parts)).astype(np.int32)
        left_out.flags.writeable = False
        return left_out

    @property
    def residuals(self) -> NDArray[np.float64] | None:
        """How far each sample is from its place in `vertices`, (N,).

        Zero where nothing was moved; None where only products are known.
        """
        if self.samples is None or self.vertices is None:
            return None
        return np.asarray(np.linalg.norm(self.samples - self.vertices, axis=1))

    @functools.cached_property
    def tangents(self) -> NDArray[np.float64] | None:
        """Orthonormal bases of the tangent spaces, (N, K, D); NaN where there is none.

        None where only products are known. With many coordinates they are written out,
        from `vertices`, when first asked for.
        """
        if self.vertices is None or self._frames is None:
            return None
        bases = _core.tangent_bases(
            self.vertices, *self._frames, num_threads=0, progress=None
        )
        bases.flags.writeable = False
        return bases

    @functools.cached_property
    def repair(self) -> Repair:
        """What was disputed and mended, and what the result lacks; computed once."""
        own = self.representatives == np.arange(self.num_samples)
        merged = int(np.count_nonzero(~own))
        if self.edge_sets is None or self.stars is None:
            return Repair(method=self.method, merged_samples=merged, **self._report)
        report = _core.paper_report(
            self.simplices,
            *self.edge_sets,
            *self.stars,
            self.boundary,
            0,
            None,
        )
        used = np.zeros(self.num_samples, dtype=bool)
        used[self.simplices.ravel()] = True
        used[self.left_out] = True  # reported as such
        none = np.empty(0, dtype=np.int32)
        no_simplices = np.empty((0, self.dim + 1), dtype=np.int32)
        return Repair(
            method=self.method,
            **report,
            singular_vertices=none,
            unused_vertices=np.flatnonzero(own & ~used).astype(np.int32),
            merged_samples=merged,
            hole_radius=float("nan"),
            hole_size=float("nan"),
            num_agreed=0,
            disputed_simplices=no_simplices,
            filled_simplices=no_simplices,
            inserted_vertices=none,
            num_cavities=0,
            num_cut_cavities=0,
            num_programs=0,
            num_integer_programs=0,
            largest_program=0,
            num_unsolved=0,
        )
