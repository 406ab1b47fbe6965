# SPDX-License-Identifier: GPL-3.0-or-later
"""Curvature: angle defects of surfaces, and second fundamental forms by local fits."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold.calculus.solving import scipy_module
from remanifold.complex.parts import open_faces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.operators import Operators
    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]

_ENOUGH = 2  # neighbors of a fit, in coefficients
_MOST_RINGS = 4
_TURNS = 3  # of the tangent space towards the slope of the fit
_DETERMINED = 1e-12  # least over largest eigenvalue of the normal equations of a fit
_NUMBERS = 4_000_000  # at a time


@dataclass(frozen=True, eq=False, repr=False)
class AngleDefects(ReadOnlyArrays):
    """Gaussian curvature of a surface by the angles of its triangles. Read-only.

    Attributes
    ----------
    defects : ndarray, shape (N,), float64
        What the angles around each vertex lack of 2 pi: the integral of the Gaussian
        curvature over its share of the area. At the boundary what they lack of pi, the
        integral of the geodesic curvature of the boundary. NaN at
        `Calculus.missing_vertices` and at `singular`.
    gaussian_curvature : ndarray, shape (N,), float64
        Defects over `Calculus.vertex_volumes`, in units of 1 / length^2; NaN at the
        boundary as well.
    singular : ndarray of int64
        Vertices around which the triangles are neither a disc nor half of one.
    total : float
        Sum of the defects.
    expected : float
        2 pi times the Euler characteristic of the complex: by Gauss and Bonnet the
        total, up to rounding, where nothing is singular.
    """

    defects: Floats
    gaussian_curvature: Floats
    singular: NDArray[np.int64]
    total: float
    expected: float

    def __repr__(self) -> str:
        return one_line(
            self,
            vertices=len(self.defects),
            total=rounded(self.total),
            expected=rounded(self.expected),
        )


@dataclass(frozen=True, eq=False, repr=False)
class Curvature(ReadOnlyArrays):
    """How a manifold bends in its space, at each vertex. Arrays are read-only.

    Attributes
    ----------
    tangents : ndarray, shape (N, K, D), float64
        Orthonormal tangent vectors; those of the fit, not of the reconstruction.
    second_form : ndarray, shape (N, K, K, D), float64
        Second fundamental form in these tangent vectors: symmetric, with values in the
        normal space, in units of 1 / length.
    missing : ndarray of int64
        Vertices where too few others are near for a fit, or none: NaN there.
    """

    tangents: Floats
    second_form: Floats
    missing: NDArray[np.int64]
    _normals: Floats | None

    def __repr__(self) -> str:
        count, dim, _, ambient = self.second_form.shape
        return one_line(
            self,
            vertices=count,
            dim=dim,
            ambient_dim=ambient,
            missing=len(self.missing),
        )

    @property
    def mean_curvature_vectors(self) -> Floats:
        """Mean of the second fundamental form over directions, (N, D)."""
        trace = np.einsum("niid->nd", self.second_form)
        return np.asarray(trace / self.tangents.shape[1])

    @property
    def ricci(self) -> Floats:
        """Ricci curvature in the tangent vectors, (N, K, K), by Gauss's equation."""
        form = self.second_form
        trace = np.einsum("niid->nd", form)
        first = np.einsum("nd,nijd->nij", trace, form)
        return np.asarray(first - np.einsum("nikd,nkjd->nij", form, form))

    @property
    def scalar(self) -> Floats:
        """Scalar curvature, (N,), by Gauss's equation: for K = 2 twice the Gaussian."""
        return np.asarray(np.einsum("nii->n", self.ricci))

    def sectional(self, first: int, second: int) -> Floats:
        """Sectional curvature of the plane of two of the tangent vectors.

        Parameters
        ----------
        first, second : int
            Which of them, from 0 to K - 1, not the same.

        Returns
        -------
        ndarray, shape (N,), float64
            In units of 1 / length^2.
        """
        dim = self.tangents.shape[1]
        if not (0 <= first < dim and 0 <= second < dim and first != second):
            msg = f"first and second are {first} and {second}, expected two of 0 to {dim - 1}"
            raise ValueError(msg)
        form = self.second_form
        squares = (form[:, first, first] * form[:, second, second]).sum(axis=1)
        return np.asarray(squares - (form[:, first, second] ** 2).sum(axis=1))

    @property
    def principal_curvatures(self) -> Floats:
        """Of a hypersurface, (N, K), ascending, positive where it bends to the normal.

        Raises
        ------
        ValueError
            D is not K + 1.
        """
        return self._shape_operators()[0]

    @property
    def principal_directions(self) -> Floats:
        """Unit vectors of `principal_curvatures`, (N, K, D)."""
        return np.asarray(
            np.einsum("nij,nid->njd", self._shape_operators()[1], self.tangents)
        )

    def _shape_operators(self) -> tuple[Floats, Floats]:
        if self._normals is None:
            _, dim, ambient = self.tangents.shape
            msg = (
                f"a manifold of dimension {dim} has principal curvatures in {dim + 1} "
                f"coordinates, not {ambient}: second_form has all there is"
            )
            raise ValueError(msg)
        form = np.einsum("nijd,nd->nij", self.second_form, self._normals)
        known = np.isfinite(form).all(axis=(1, 2))
        form[~known] = 0.0
        values, vectors = np.linalg.eigh(form)
        values[~known], vectors[~known] = np.nan, np.nan
        return values, vectors


def angle_defects(operators: Operators) -> AngleDefects:
    """What angles lack; see `Calculus.angle_defects`."""
    simplices, count = operators.simplices, operators.count
    frames, flat = operators.elements.frames, operators.elements.flat
    corners = np.concatenate([np.zeros((len(frames), 1, 2)), frames], axis=1)
    sums = np.zeros(count)
    for i in range(3):
        a = corners[:, (i + 1) % 3] - corners[:, i]
        b = corners[:, (i + 2) % 3] - corners[:, i]
        cross = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        angle = np.where(flat, 0.0, np.arctan2(cross, (a * b).sum(axis=1)))
        sums += np.bincount(simplices[:, i], angle, count)
    rim = np.zeros(count, dtype=np.bool_)
    rim[open_faces(simplices)] = True
    defects = np.where(rim, np.pi, 2 * np.pi) - sums
    topology = operators.complex.topology()
    singular = np.zeros(count, dtype=np.bool_)
    singular[topology.singular_vertices] = True
    # An angle of a flat triangle is not known.
    singular[simplices[flat]] = True
    defects[~operators.used | singular] = np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        density = np.where(rim, np.nan, defects / operators.volumes)
    return AngleDefects(
        defects,
        density,
        np.flatnonzero(singular & operators.used),
        float(np.nansum(defects)),
        2 * np.pi * topology.euler_characteristic,
    )


def curvature(complex_: ComplexData, normals: Floats | None) -> Curvature:
    """Second fundamental forms; see `Calculus.curvature`.

    Normals say which way a hypersurface is positive.
    """
    coordinates, dim = complex_.coordinates, complex_.dim
    ambient = coordinates.shape[1]
    count = len(coordinates)
    monomials = _monomials(dim)
    wanted = _ENOUGH * len(monomials)
    tangents = np.full((count, dim, ambient), np.nan)
    form = np.full((count, dim, dim, ambient), np.nan)
    for vertices, near in _rings(complex_, wanted):
        size = max(1, _NUMBERS // (near.shape[1] * (ambient + len(monomials))))
        for start in range(0, len(vertices), size):
            own = vertices[start : start + size]
            place = near[start : start + size]
            tangents[own], form[own] = _fit(coordinates, own, place, dim, monomials)
    missing = np.flatnonzero(np.isnan(tangents).any(axis=(1, 2)))
    directions = None
    if ambient == dim + 1:
        directions = _normal_directions(tangents)
        if normals is not None:
            along = np.einsum("nd,nd->n", directions, normals)
            directions *= np.where(along < 0, -1.0, 1.0)[:, None]
    return Curvature(tangents, form, missing, directions)


def fit_at(
    complex_: ComplexData, vertex: int
) -> tuple[NDArray[np.int32], Floats, Floats]:
    """The others around a vertex, its tangent vectors, and where the others lie there.

    As far from the origin as they are from the vertex in space.
    """
    coordinates, dim = complex_.coordinates, complex_.dim
    monomials = _monomials(dim)
    wanted = _ENOUGH * len(monomials)
    i, j = complex_.edges.T
    near = np.zeros(len(coordinates), dtype=np.bool_)
    near[vertex] = True
    for _ in range(_MOST_RINGS):
        ring = np.concatenate([j[near[i]], i[near[j]]])
        near[ring] = True
        if near.sum() > wanted:
            break
    near[vertex] = False
    others = np.flatnonzero(near).astype(np.int32)
    own = np.array([vertex])
    tangents, _ = _fit(coordinates, own, others[None, :], dim, monomials)
    if len(others) < wanted or np.isnan(tangents).any():
        msg = (
            f"vertex {vertex} has {len(others)} others within {_MOST_RINGS} edges, too "
            f"few for a tangent space: {wanted} are needed, and not all on one curve"
        )
        raise ValueError(msg)
    steps = coordinates[others] - coordinates[vertex]
    places = steps @ tangents[0].T
    shadow = np.linalg.norm(places, axis=1)
    chord = np.linalg.norm(steps, axis=1)
    places *= (chord / np.where(shadow > 0, shadow, 1.0))[:, None]
    return others, tangents[0], places


def _monomials(dim: int) -> list[tuple[int, ...]]:
    """Of degree 1 to 3, as the coordinates that are multiplied."""
    return [
        own
        for degree in (1, 2, 3)
        for own in itertools.combinations_with_replacement(range(dim), degree)
    ]


def _rings(
    complex_: ComplexData, wanted: int
) -> list[tuple[NDArray[np.intp], NDArray[np.int32]]]:
    """Vertices by how many rings have enough others, and these; padded by themselves."""
    sparse = scipy_module("sparse")
    count = complex_.num_vertices
    i, j = complex_.edges.T
    ones = np.ones(2 * len(i))
    step = sparse.csr_array(
        (ones, (np.concatenate([i, j]), np.concatenate([j, i]))), shape=(count, count)
    )
    reach = step
    left = np.ones(count, dtype=np.bool_)
    found = []
    for ring in range(1, _MOST_RINGS + 1):
        if ring > 1:
            reach = reach @ step + reach
            reach.data[:] = 1
        near = reach - sparse.csr_array(sparse.diags(reach.diagonal()))
        near.eliminate_zeros()
        sizes = np.diff(near.indptr)
        own = np.flatnonzero(left & (sizes >= wanted))
        left[own] = False
        if len(own) == 0:
            continue
        near.sort_indices()
        table = np.repeat(own[:, None], sizes[own].max(), axis=1).astype(np.int32)
        inside = np.arange(table.shape[1]) < sizes[own][:, None]
        table[inside] = near[own].indices
        found.append((own, table))
    return found


def _fit(
    coordinates: Floats,
    own: NDArray[np.intp],
    near: NDArray[np.int32],
    dim: int,
    monomials: list[tuple[int, ...]],
) -> tuple[Floats, Floats]:
    """Polynomials of degree 3 over tangent spaces that their slopes turn."""
    steps = coordinates[near] - coordinates[own][:, None]
    squares = (steps**2).sum(axis=2)
    size = np.sqrt(squares.max(axis=1))
    size[size == 0] = 1.0
    steps /= size[:, None, None]
    weights = (near != own[:, None]).astype(np.float64)
    tangents = _principal(steps * weights[:, :, None], dim)
    known = np.ones(len(own), dtype=np.bool_)
    for turn in range(_TURNS):
        along = steps @ tangents.transpose(0, 2, 1)
        across = steps - along @ tangents
        # As far along as they are away: over chords a sphere is a paraboloid, and of
        # other shapes only how the curvature changes is left to the higher degrees.
        shadow = np.sqrt((along**2).sum(axis=2))
        chord = np.sqrt((steps**2).sum(axis=2))
        along *= (chord / np.where(shadow > 0, shadow, 1.0))[:, :, None]
        terms = np.empty((*weights.shape, len(monomials)))
        for place, factors in enumerate(monomials):
            terms[:, :, place] = weights
            for axis in factors:
                terms[:, :, place] *= along[:, :, axis]
        normal = terms.transpose(0, 2, 1) @ terms
        scale = np.linalg.eigvalsh(normal)
        known = scale[:, 0] > _DETERMINED * scale[:, -1]
        normal[~known] = np.eye(len(monomials))
        found = np.linalg.solve(normal, terms.transpose(0, 2, 1) @ across)
        if turn < _TURNS - 1:
            turned = tangents + found[:, :dim]
            tangents = np.linalg.qr(turned.transpose(0, 2, 1))[0].transpose(0, 2, 1)
    form = np.zeros((len(own), dim, dim, coordinates.shape[1]))
    for place, term in enumerate(monomials):
        if len(term) == 2:
            i, j = term
            value = found[:, place] * (2.0 if i == j else 1.0) / size[:, None]
            form[:, i, j] = form[:, j, i] = value
    tangents[~known], form[~known] = np.nan, np.nan
    return tangents, form


def _principal(steps: Floats, dim: int) -> Floats:
    """Axes of the widest directions, by whichever square matrix is smaller."""
    _, rows, columns = steps.shape
    if columns <= rows:
        _, vectors = np.linalg.eigh(steps.transpose(0, 2, 1) @ steps)
        return np.ascontiguousarray(vectors[:, :, ::-1][:, :, :dim].transpose(0, 2, 1))
    _, vectors = np.linalg.eigh(steps @ steps.transpose(0, 2, 1))
    wide = steps.transpose(0, 2, 1) @ vectors[:, :, ::-1][:, :, :dim]
    return np.asarray(np.linalg.qr(wide)[0].transpose(0, 2, 1))


def _normal_directions(tangents: Floats) -> Floats:
    """What is orthogonal to all tangent vectors, its largest entry positive."""
    known = np.asarray(np.isfinite(tangents).all(axis=(1, 2)))
    filled = np.where(known[:, None, None], tangents, 0.0)
    _, _, rows = np.linalg.svd(filled, full_matrices=True)
    normals = rows[:, -1]
    largest = np.abs(normals).argmax(axis=1)
    normals = normals * np.sign(normals[np.arange(len(normals)), largest])[:, None]
    normals[~known] = np.nan
    return np.asarray(normals)
