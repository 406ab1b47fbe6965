# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenfunctions of the Laplacian, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold._base.validation import (
    check_choice,
    check_index_array,
    check_int,
    check_positive,
)
from remanifold.calculus.solving import factorized, scipy_module
from remanifold.complex.embedding import fixed_signs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold.calculus.operators import Operators

    Floats = NDArray[np.float64]

SpectralDistance: TypeAlias = Literal["diffusion", "commute", "biharmonic"]
_DISTANCES: tuple[str, ...] = get_args(SpectralDistance)
_SMALL = 300  # vertices up to which all eigenvalues are computed


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(ReadOnlyArrays):
    """The smoothest functions on a complex. Arrays are read-only.

    Attributes
    ----------
    eigenvalues : ndarray, shape (C,), float64
        Of minus the Laplacian, ascending, in units of 1 / length^2.
    functions : ndarray, shape (N, C), float64
        Eigenfunctions at the vertices, orthonormal with respect to the mass matrix: the
        integral of the square of each is 1. Each lives on one component and is zero on
        the others; NaN at `Calculus.missing_vertices`. Of equal eigenvalues any basis is
        as good: those here are the same in each run, but move with the samples.
    components : ndarray, shape (C,), int32
        Component that each function lives on.
    """

    eigenvalues: Floats
    functions: Floats
    components: NDArray[np.int32]
    _labels: NDArray[np.int32]

    def __repr__(self) -> str:
        last = rounded(float(self.eigenvalues[-1])) if len(self.eigenvalues) else None
        return one_line(
            self,
            vertices=len(self.functions),
            functions=len(self.eigenvalues),
            largest_eigenvalue=last,
        )

    def embedding(self, dim: int) -> Floats:
        """Coordinates by the smoothest functions that are not constant.

        Parameters
        ----------
        dim : int
            How many.

        Returns
        -------
        ndarray, shape (N, dim), float64
            Laplacian eigenmaps, here of the manifold instead of a graph.

        Raises
        ------
        ValueError
            There are not as many.

        References
        ----------
        M. Belkin, P. Niyogi, Laplacian eigenmaps for dimensionality reduction and data
        representation, Neural Computation 15(6), 2003.
        """
        return np.array(self.functions[:, self._slopes(dim)])

    def diffusion_map(self, time: float, dim: int | None = None) -> Floats:
        """Coordinates in which distances are those of diffusion.

        Parameters
        ----------
        time : float
            How long heat flows, in units of length^2.
        dim : int, optional
            How many coordinates; all by default.

        Returns
        -------
        ndarray, shape (N, dim), float64
            ``exp(-time * eigenvalue)`` times the functions that are not constant.

        References
        ----------
        R. R. Coifman, S. Lafon, Diffusion maps, Applied and Computational Harmonic
        Analysis 21(1), 2006.
        """
        time = check_positive(time, "time")
        columns = self._slopes(dim)
        decay = np.exp(-time * self.eigenvalues[columns])
        return np.asarray(self.functions[:, columns] * decay)

    def heat_kernel_signature(self, times: ArrayLike) -> Floats:
        """How much heat is left at each vertex where it started.

        Parameters
        ----------
        times : array_like, shape (T,)
            In units of length^2, positive. The functions that were computed are enough
            for times above a few times 1 / ``eigenvalues[-1]``.

        Returns
        -------
        ndarray, shape (N, T), float64
            In units of 1 / K-volume.

        References
        ----------
        J. Sun, M. Ovsjanikov, L. Guibas, A concise and provably informative multi-scale
        signature based on heat diffusion, Computer Graphics Forum 28(5), 2009.
        """
        instants = np.array(
            [
                check_positive(float(time), f"times[{i}]")
                for i, time in enumerate(np.atleast_1d(np.asarray(times)))
            ]
        )
        return np.asarray(
            self.functions**2 @ np.exp(-self.eigenvalues[:, None] * instants)
        )

    def distances(
        self,
        sources: ArrayLike,
        kind: SpectralDistance = "biharmonic",
        time: float | None = None,
    ) -> Floats:
        """Distances that see all ways between two places, not the shortest only.

        Parameters
        ----------
        sources : int or array_like of int, shape (S,)
            Vertices to start at.
        kind : {"biharmonic", "commute", "diffusion"}
            Differences of the functions are weighted by 1 / eigenvalue ("biharmonic"),
            its root ("commute"), or ``exp(-time * eigenvalue)`` ("diffusion").
        time : float, optional
            For "diffusion", in units of length^2.

        Returns
        -------
        ndarray, shape (S, N), float64
            By the functions that were computed. Between components infinite, but for
            "diffusion"; NaN at `Calculus.missing_vertices`. For K >= 4 ("biharmonic")
            and K >= 2 ("commute") the sum over all functions does not converge: the
            distances depend on how many there are.

        References
        ----------
        Y. Lipman, R. M. Rustamov, T. A. Funkhouser, Biharmonic distance, ACM
        Transactions on Graphics 29(3), 2010.
        """
        check_choice(kind, "kind", _DISTANCES)
        chosen = check_index_array(
            np.atleast_1d(np.asarray(sources)), "sources", np.int32
        )
        wrong = (chosen < 0) | (chosen >= len(self.functions))
        wrong[~wrong] = self._labels[chosen[~wrong]] < 0
        if wrong.any():
            place = int(wrong.argmax())
            msg = (
                f"sources[{place}] is {chosen[place]}, expected a vertex from 0 to "
                f"{len(self.functions) - 1} in a simplex with volume"
            )
            raise ValueError(msg)
        if (time is None) == (kind == "diffusion"):
            msg = 'time goes with kind="diffusion", and only with it'
            raise TypeError(msg)
        if time is not None:
            weights = np.exp(-check_positive(time, "time") * self.eigenvalues)
        else:
            power = 1.0 if kind == "biharmonic" else 0.5
            slopes = self.eigenvalues > 0
            weights = np.zeros(len(slopes))
            weights[slopes] = self.eigenvalues[slopes] ** -power
        places = self.functions * weights
        rows = []
        for source in chosen:
            row = np.linalg.norm(places - places[source], axis=1)
            if kind != "diffusion":
                row[(self._labels != self._labels[source]) & (self._labels >= 0)] = (
                    np.inf
                )
            rows.append(row)
        return np.array(rows).reshape(len(chosen), len(places))

    def _slopes(self, dim: int | None) -> NDArray[np.intp]:
        """Columns of functions that are not constant."""
        columns = np.flatnonzero(self.eigenvalues > 0)
        if dim is None:
            return columns
        wanted = check_int(dim, "dim", minimum=1)
        if wanted > len(columns):
            msg = (
                f"dim is {wanted}, but only {len(columns)} functions that are not "
                "constant were computed: ask spectrum() for more"
            )
            raise ValueError(msg)
        return columns[:wanted]


def compute_spectrum(
    operators: Operators, count: int, fixed: NDArray[np.int64], *, lumped: bool
) -> Spectrum:
    """Eigenfunctions of smallest eigenvalues; see `Calculus.spectrum`."""
    labels = operators.labels
    inner = operators.used.copy()
    inner[fixed] = False
    if count > inner.sum():
        msg = f"count is {count}, but there are {inner.sum()} vertices to have values"
        raise ValueError(msg)
    natural = np.ones(int(labels.max(initial=-1)) + 1, dtype=np.bool_)
    natural[labels[fixed]] = False
    # Each component that is fixed nowhere has a constant function, which comes first.
    most = count - max(int(natural.sum()) - 1, 0)
    values: list[Floats] = []
    functions: list[Floats] = []
    owners: list[NDArray[np.int32]] = []
    for label in range(len(natural)):
        own = np.flatnonzero(inner & (labels == label))
        wanted = min(max(most, 1 if natural[label] else 0), len(own))
        if wanted == 0:
            continue
        found, vectors = _of_component(operators, own, wanted, lumped=lumped)
        if natural[label]:
            found[0] = 0.0
            vectors[:, 0] = operators.volumes[own].sum() ** -0.5
        wide = np.zeros((len(labels), wanted))
        wide[own] = vectors
        values.append(found)
        functions.append(wide)
        owners.append(np.full(wanted, label, dtype=np.int32))
    order = np.argsort(np.concatenate(values), kind="stable")[:count]
    table = np.concatenate(functions, axis=1)[:, order]
    table[~operators.used] = np.nan
    return Spectrum(
        np.concatenate(values)[order],
        table,
        np.concatenate(owners)[order],
        labels,
    )


def _of_component(
    operators: Operators, own: NDArray[np.intp], count: int, *, lumped: bool
) -> tuple[Floats, Floats]:
    sparse = scipy_module("sparse")
    stiffness = operators.stiffness[own][:, own]
    mass: Any = (
        sparse.csr_array(sparse.diags(operators.volumes[own]))
        if lumped
        else operators.mass[own][:, own]
    )
    if len(own) <= _SMALL or count > len(own) - 2:
        values, vectors = scipy_module("linalg").eigh(
            stiffness.toarray(), mass.toarray(), subset_by_index=(0, count - 1)
        )
    else:
        linalg = scipy_module("sparse.linalg")
        # About minus the first eigenvalue: what is factorized is positive definite.
        shift = -(float(operators.volumes[own].sum()) ** (-2 / operators.dim))
        solve = factorized(stiffness - shift * mass)
        inverse = linalg.LinearOperator(stiffness.shape, matvec=solve, dtype=np.float64)
        values, vectors = linalg.eigsh(
            stiffness,
            k=count,
            M=mass,
            sigma=shift,
            OPinv=inverse,
            v0=np.random.default_rng(0).normal(size=len(own)),
        )
        order = np.argsort(values, kind="stable")
        values, vectors = values[order], vectors[:, order]
    return np.maximum(values, 0.0), np.asarray(vectors * fixed_signs(vectors))
