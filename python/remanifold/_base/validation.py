# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of what callers pass in. Arrays leave here in the layout of the core."""

from __future__ import annotations

import operator
import os
import sys
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np

from remanifold import _core
from remanifold._base.samples import Distances, Gram, Input, Points

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_LARGEST_INDEX = np.iinfo(np.int32).max
# Share of the largest distance: 64 square roots of the rounding of its square.
_ROUNDED = 64 * np.sqrt(np.finfo(np.float64).eps)


def check_samples(
    points: ArrayLike | None,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    remedy: str = "remove or repair such samples first",
) -> Input:
    """Accept exactly one description of the samples.

    `remedy` says what to do about a number that is none.
    """
    given = {
        name: value
        for name, value in (
            ("points", points),
            ("gram", gram),
            ("distances", distances),
        )
        if value is not None
    }
    if len(given) != 1:
        got = " and ".join(given) if given else "none"
        msg = f"give exactly one of points, gram and distances, got {got}"
        raise TypeError(msg)
    if points is not None:
        return Points(check_points(points, remedy=remedy))
    if gram is not None:
        return Gram(check_gram(gram))
    return Distances(check_distances(distances))


def check_points(
    points: ArrayLike,
    name: str = "points",
    remedy: str = "remove or repair such samples first",
) -> NDArray[np.float64]:
    """(N, D) real, or complex read as (N, 2 D) real."""
    return _real_matrix(points, name, remedy=remedy)


def float_rows(points: ArrayLike, name: str) -> NDArray[Any]:
    """Numbers as they are, masked ones as NaN; what they are is for others to check."""
    if _is_masked(points) and points.dtype.kind in "biufc":
        kind = np.complex128 if points.dtype.kind == "c" else np.float64
        array = np.array(np.ma.getdata(points), dtype=kind)
        array[np.ma.getmaskarray(points)] = np.nan
        return array
    array = _as_array(points, name)
    return array if array.dtype.kind == "c" else _as_float(array, name)


def check_gram(gram: ArrayLike) -> NDArray[np.float64]:
    """Positive semidefinite up to rounding of single precision."""
    matrix = _real_matrix(gram, "gram", square=True)
    diagonal = np.diagonal(matrix)
    if len(diagonal) == 0:
        return matrix
    tolerance = 1e-6 * np.sqrt(len(matrix)) * max(float(diagonal.max()), 0.0)
    shifted = matrix + 0.0
    shifted[np.diag_indices_from(shifted)] += tolerance + np.finfo(float).tiny
    # A Cholesky decomposition exists exactly where all eigenvalues are positive; it
    # reads one triangle, symmetry is the core's to check.
    try:
        np.linalg.cholesky(shifted)
    except np.linalg.LinAlgError:
        worst = int(np.argmin(diagonal))
        detail = (
            f"gram[{worst}, {worst}] is {diagonal[worst]:.6g}"
            if diagonal[worst] < 0
            else f"its smallest eigenvalue is {np.linalg.eigvalsh(matrix)[0]:.6g}"
        )
        msg = (
            f"gram is not positive semidefinite: {detail}. A Gram matrix holds the "
            "inner products of the samples; pass a distance matrix as distances="
        )
        raise ValueError(msg) from None
    return matrix


def check_distances(distances: ArrayLike | None) -> NDArray[np.float64]:
    """Square, of samples from themselves zero up to rounding, which is taken away.

    What computes distances by products or angles leaves square roots of rounding there.
    The rest is the core's to check.
    """
    matrix = _real_matrix(distances, "distances", square=True)
    diagonal = np.abs(np.diagonal(matrix))
    if not diagonal.any():
        return matrix
    worst = int(diagonal.argmax())
    if diagonal[worst] > _ROUNDED * matrix.max():
        msg = (
            f"distances[{worst}, {worst}] is {matrix[worst, worst]:.6g}, not zero; pass "
            "inner products as gram="
        )
        raise ValueError(msg)
    exact = np.array(matrix)
    np.fill_diagonal(exact, 0.0)
    return exact


def check_dim(dim: Any, samples: Input) -> int:
    """1 <= K <= D, and enough samples for one simplex."""
    if dim is None:
        msg = (
            "dim must be an integer, got None: the dimension of the manifold, 1 for "
            'curves, 2 for surfaces; reconstruct takes "auto" as well'
        )
        raise TypeError(msg)
    value = check_int(dim, "dim", minimum=1)
    num_samples, num_columns = samples.matrix.shape
    if isinstance(samples, Points) and value > num_columns:
        msg = (
            f"dim is {value}, more than the {num_columns} coordinates of the points: "
            "a manifold has at most the dimension of the space it lies in"
        )
        raise ValueError(msg)
    if num_samples < value + 1:
        msg = (
            f"{samples.kind} has {num_samples} sample"
            f"{'' if num_samples == 1 else 's'}; a {value}-dimensional complex needs "
            f"at least dim + 1 = {value + 1}"
        )
        raise ValueError(msg)
    return value


def check_num_neighbors(num_neighbors: Any, dim: int) -> int:
    """At least K + 1; by default as for the paper's method."""
    if num_neighbors is None:
        return _core.paper_neighbors(dim)
    return check_int(
        num_neighbors, "num_neighbors", minimum=dim + 1, hint=f" (dim + 1 = {dim + 1})"
    )


def check_int(value: Any, name: str, minimum: int, hint: str = "") -> int:
    """An integer, and nothing that merely looks like one."""
    if isinstance(value, (bool, np.bool_)):
        msg = f"{name} must be an integer, got {value!r}"
        raise TypeError(msg)
    try:
        number = operator.index(value)
    except TypeError:
        msg = f"{name} must be an integer, got {value!r} of type {type(value).__name__}"
        raise TypeError(msg) from None
    if number < minimum:
        msg = f"{name} is {number}, expected at least {minimum}{hint}"
        raise ValueError(msg)
    if number > np.iinfo(np.int32).max:
        msg = f"{name} is {number}, expected at most {np.iinfo(np.int32).max}"
        raise ValueError(msg)
    return number


def check_num_threads(num_threads: Any) -> int:
    """0 stands for all cores; -1 does for callers, -2 for all but one, and so on."""
    if num_threads is None:
        return 0
    count = check_int(num_threads, "num_threads", minimum=-_LARGEST_INDEX)
    if count == 0:
        msg = "num_threads is 0, expected at least 1, or -1 for all cores"
        raise ValueError(msg)
    if count >= -1:
        return max(count, 0)
    return max(1, (os.cpu_count() or 1) + 1 + count)


def check_choice(value: Any, name: str, choices: tuple[str, ...]) -> str:
    """One of the words."""
    if not isinstance(value, str) or value not in choices:
        msg = f"{name} is {value!r}, expected one of {', '.join(map(repr, choices))}"
        raise ValueError(msg)
    return value


def check_positive(value: Any, name: str) -> float:
    """Accept a number above zero, and nothing that merely looks like one."""
    if isinstance(value, bool) or not isinstance(value, Real):
        msg = f"{name} must be a number, got {value!r}"
        raise TypeError(msg)
    number = float(value)
    if not (number > 0 and np.isfinite(number)):
        msg = f"{name} is {value!r}, expected a positive finite number"
        raise ValueError(msg)
    return number


def check_significance(significance: Any) -> float:
    """Accept a chance: from 0, at which nothing is significant, to below 1."""
    if isinstance(significance, bool) or not isinstance(significance, Real):
        msg = f"significance must be a number, got {significance!r}"
        raise TypeError(msg)
    chance = float(significance)
    if not 0 <= chance < 1:
        msg = f"significance is {significance!r}, expected a chance from 0 to below 1"
        raise ValueError(msg)
    return chance


def check_smooth(smooth: Any, dim: int | None = None) -> tuple[bool, int, bool]:
    """Whether to move samples, neighbors of a fit (0 for a choice), whether only noise.

    Whether the neighbors are enough is for later where the dimension is not known.
    """
    if smooth is None or (isinstance(smooth, (bool, np.bool_)) and not smooth):
        return False, 0, False
    if isinstance(smooth, str) and smooth == "auto":
        return True, 0, True
    if isinstance(smooth, (bool, np.bool_)):
        return True, 0, False
    if isinstance(smooth, str):
        msg = f'smooth is {smooth!r}, expected "auto", True, False or a number'
        raise ValueError(msg)  # noqa: TRY004
    least = -_LARGEST_INDEX if dim is None else dim + 1
    return True, check_int(smooth, "smooth", least, hint=" neighbors"), False


def check_outliers(outliers: Any) -> float:
    """Distance of an outlier, 0 to keep all."""
    if outliers is False or (isinstance(outliers, np.bool_) and not outliers):
        return 0.0
    if isinstance(outliers, str) and outliers == "auto":
        return _core.OUTLIER_DISTANCE
    if isinstance(outliers, (str, bool, np.bool_)):
        msg = f'outliers is {outliers!r}, expected "auto", False or a distance'
        raise ValueError(msg)  # noqa: TRY004
    return check_positive(outliers, "outliers")


def check_boundary(boundary: Any, num_samples: int) -> tuple[str, NDArray[np.bool_]]:
    """Turn "auto", False or a mask into the core's rule and a mask."""
    none = np.zeros(0, dtype=np.bool_)
    if isinstance(boundary, str) and boundary == "auto":
        return "auto", none
    if boundary is False or (isinstance(boundary, np.bool_) and not boundary):
        return "none", none
    if isinstance(boundary, (str, bool, np.bool_)) or boundary is None:
        msg = f'boundary is {boundary!r}, expected "auto", False or a mask'
        raise ValueError(msg)
    return "given", _check_mask(boundary, "boundary", num_samples)


def check_index_array(
    values: ArrayLike, name: str, dtype: type[np.signedinteger[Any]]
) -> NDArray[Any]:
    """One-dimensional integers that fit the dtype."""
    array = _as_array(values, name)
    if array.size == 0:
        array = array.astype(dtype)
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer):
        msg = (
            f"{name} must be a one-dimensional integer array, got shape "
            f"{array.shape} and dtype {array.dtype}"
        )
        raise ValueError(msg)
    if array.size and (
        int(array.max()) > np.iinfo(dtype).max or int(array.min()) < np.iinfo(dtype).min
    ):
        msg = f"{name} has values that do not fit {np.dtype(dtype)}"
        raise OverflowError(msg)
    return np.ascontiguousarray(array, dtype=dtype)


def check_values(
    values: ArrayLike, name: str, size: int, ndim: int | None = None
) -> NDArray[np.float64]:
    """Finite numbers, one row each for so many things."""
    array = np.ascontiguousarray(_as_float(_real(values, name), name))
    most = 2 if ndim is None else ndim
    if not 1 <= array.ndim <= most or len(array) != size:
        shapes = f"({size},)" if most == 1 else f"({size},) or ({size}, C)"
        msg = f"{name} has shape {array.shape}, expected {shapes}"
        raise ValueError(msg)
    _check_rows_finite(array, name)
    return array


def check_values_where(
    values: ArrayLike, name: str, used: NDArray[np.bool_], ndim: int | None = None
) -> NDArray[np.float64]:
    """Finite numbers where they count, one row each; zero where they do not."""
    if not used.all() and not isinstance(values, np.ma.MaskedArray):
        table = np.asarray(values)
        if table.shape[:1] == used.shape:
            values = np.where(used.reshape(-1, *(1,) * (table.ndim - 1)), table, 0)
    return check_values(values, name, len(used), ndim=ndim)


def check_matrix(values: ArrayLike, name: str, columns: int) -> NDArray[np.float64]:
    """Finite numbers, so many a row."""
    array = np.ascontiguousarray(_as_float(_real(values, name), name))
    if array.ndim != 2 or array.shape[1] != columns:
        msg = f"{name} has shape {array.shape}, expected (Q, {columns})"
        raise ValueError(msg)
    _check_rows_finite(array, name)
    return array


def check_selection(values: ArrayLike, name: str, size: int) -> NDArray[np.int64]:
    """Turn a mask, or indices that are no two alike, into indices."""
    array = _as_array(values, name)
    if array.dtype == np.bool_:
        return np.flatnonzero(_check_mask(values, name, size))
    indices: NDArray[np.int64] = check_index_array(values, name, np.int64)
    outside = (indices < 0) | (indices >= size)
    if outside.any():
        place = int(outside.argmax())
        msg = f"{name}[{place}] is {indices[place]}, expected 0 to {size - 1}"
        raise ValueError(msg)
    if len(np.unique(indices)) < len(indices):
        order = np.argsort(indices, kind="stable")
        same = indices[order][1:] == indices[order][:-1]
        place = int(order[1:][same].min())
        msg = f"{name}[{place}] is {indices[place]}, for the second time"
        raise ValueError(msg)
    return indices


def _real(values: ArrayLike, name: str) -> NDArray[Any]:
    array = _as_array(values, name)
    if array.dtype.kind == "c":
        msg = f"{name} must be real, got dtype {array.dtype}"
        raise TypeError(msg)
    return array


def _check_rows_finite(array: NDArray[np.float64], name: str) -> None:
    finite = np.isfinite(array)
    if not finite.all():
        place = np.argwhere(~finite)[0].tolist()
        msg = f"{name}{place} is {array[tuple(place)]}, expected a finite number"
        raise ValueError(msg)


def check_simplices(simplices: ArrayLike) -> NDArray[np.int32]:
    """(M, K+1) with K >= 1, no row twice; columns in any order, sorted here."""
    return np.sort(check_cells(simplices, None, least_dim=1), axis=1)


def check_cells(
    simplices: ArrayLike, num_vertices: int | None, least_dim: int = 0
) -> NDArray[np.int32]:
    """(M, K+1), no row twice, the order of the columns kept."""
    array = _as_array(simplices, "simplices")
    if (
        array.ndim != 2
        or array.shape[1] < least_dim + 1
        or not np.issubdtype(array.dtype, np.integer)
    ):
        msg = (
            "simplices must be an integer array of shape (M, K + 1) with K >= "
            f"{least_dim}, got shape {array.shape} and dtype {array.dtype}"
        )
        raise ValueError(msg)
    if num_vertices is None:
        if array.size and not -1 <= array.min() <= array.max() <= _LARGEST_INDEX:
            msg = "simplices has values that are no vertices"
            raise ValueError(msg)
    elif array.size and not 0 <= array.min() <= array.max() < num_vertices:
        wrong = ((array < 0) | (array >= num_vertices)).any(axis=1)
        row = int(wrong.argmax())
        msg = (
            f"simplices[{row}] is {array[row].tolist()}, expected indices from 0 to "
            f"{num_vertices - 1}"
        )
        raise ValueError(msg)
    # A copy, row by row: results keep it, read-only.
    result = array.astype(np.int32, order="C")
    rows = np.sort(result, axis=1)
    twice = (rows[:, 1:] == rows[:, :-1]).any(axis=1)
    if twice.any():
        msg = f"simplices[{int(twice.argmax())}] has a vertex twice"
        raise ValueError(msg)
    # What was made here is in order already, which takes a hundredth of sorting to see.
    order = np.arange(len(rows)) if _ascend(rows) else np.lexsort(rows.T)
    same = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    if same.any():
        first, second = sorted(
            int(i) for i in order[[same.argmax(), same.argmax() + 1]]
        )
        msg = f"simplices[{second}] repeats simplices[{first}]"
        raise ValueError(msg)
    return result


def _ascend(rows: NDArray[np.int32]) -> bool:
    """Whether rows are in lexicographic order, each once."""
    before = np.zeros(max(len(rows) - 1, 0), dtype=bool)
    for column in reversed(range(rows.shape[1])):
        above, below = rows[:-1, column], rows[1:, column]
        before = (above < below) | ((above == below) & before)
    return bool(before.all())


def check_bases(
    bases: ArrayLike, boundary: ArrayLike | None, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """(N, K, D) orthonormal rows; rows of NaN, or marked as boundary, have no basis."""
    array = np.ascontiguousarray(_as_float(bases, "bases"))
    num_samples, ambient_dim = points.shape
    if (
        array.ndim != 3
        or array.shape[0] != num_samples
        or array.shape[2] != ambient_dim
        or not 1 <= array.shape[1] <= ambient_dim
    ):
        msg = (
            f"bases has shape {array.shape}, expected ({num_samples}, K, "
            f"{ambient_dim}) with 1 <= K <= {ambient_dim}"
        )
        raise ValueError(msg)
    missing = np.isnan(array).any(axis=(1, 2))
    if boundary is not None:
        missing = missing | _check_mask(boundary, "boundary", num_samples)
    kept = array[~missing]
    # Far too long rows must not overflow before they are refused.
    clipped = np.clip(kept, -2, 2)
    defect = clipped @ clipped.transpose(0, 2, 1) - np.eye(array.shape[1])
    size = np.abs(defect).max(axis=(1, 2), initial=0.0)
    bad = ~(size < 1e-6)
    if bad.any():
        index = int(np.flatnonzero(~missing)[np.argmax(bad)])
        msg = f"bases[{index}] does not have orthonormal rows"
        raise ValueError(msg)
    if (size > 1e-14).any():
        # Single precision passes; one step towards the nearest orthonormal rows.
        array = array.copy()
        array[~missing] = kept - defect @ kept / 2
    return array, np.ascontiguousarray(missing)


def _is_masked(values: Any) -> TypeGuard[np.ma.MaskedArray[Any, Any]]:
    # Who has a masked array has imported the module, which is slow to import.
    return "numpy.ma" in sys.modules and isinstance(values, np.ma.MaskedArray)


def _as_array(values: Any, name: str) -> NDArray[Any]:
    try:
        array = np.asarray(values)
    except ValueError:
        msg = f"{name} is not rectangular: its rows differ in length"
        raise ValueError(msg) from None
    if _is_masked(values) and array.dtype.names is None:
        masked = np.argwhere(np.ma.getmaskarray(values))
        if len(masked):
            entry = f"{name}{masked[0].tolist() or ''}"
            msg = f"{entry} is masked; fill or remove masked entries first"
            raise ValueError(msg)
    return array


def _check_mask(values: Any, name: str, size: int) -> NDArray[np.bool_]:
    array = _as_array(values, name)
    if array.shape != (size,) or array.dtype != np.bool_:
        msg = (
            f"{name} must be a bool array of shape ({size},), got shape {array.shape} "
            f"and dtype {array.dtype}"
        )
        raise ValueError(msg)
    return np.ascontiguousarray(array)


def _kind_of(value: object, name: str) -> str:
    """What an object is, and where it has its numbers."""
    kind = type(value)
    said = f"{kind.__module__.partition('.')[0]}'s {kind.__name__}"
    if kind.__module__ == "builtins":
        said = repr(value)[:60]
    for held in ("toarray()", "points", "vertices"):
        if held == "toarray()" and name == "distances":
            continue  # what a sparse matrix leaves out is not zero here
        if hasattr(value, held.removesuffix("()")):
            return f"{said}: pass its .{held}"
    return said


def _first_other(array: NDArray[Any]) -> tuple[list[int], object]:
    """Where an array of objects holds something that is no number, and what."""
    for place in np.ndindex(array.shape):
        try:
            float(array[place])
        except (TypeError, ValueError):
            return [*place], array[place]
    return [0] * array.ndim, array.flat[0]


def _as_float(values: Any, name: str) -> NDArray[np.float64]:
    """Wider floats beyond float64 become infinite, which is for the caller to refuse."""
    array = _as_array(values, name)
    with np.errstate(over="ignore"):
        if array.dtype == object:
            try:
                array = array.astype(np.float64)
            except (TypeError, ValueError):
                place, entry = _first_other(array)
                if not place:
                    msg = f"{name} must hold numbers, got {_kind_of(entry, name)}"
                    raise TypeError(msg) from None
                msg = f"{name} must hold numbers, {name}{place} is {entry!r}"
                raise TypeError(msg) from None
            except OverflowError:
                msg = f"{name} has an integer that no float64 can hold"
                raise OverflowError(msg) from None
        if array.dtype.kind == "c":
            return np.ascontiguousarray(array, dtype=np.complex128).view(np.float64)
        if array.dtype.kind not in "biuf":
            msg = f"{name} must hold numbers, got dtype {array.dtype}"
            if array.ndim == 0 and array.dtype.kind == "U":
                msg = (
                    f"{name} must hold numbers, got {str(array)[:60]!r}; rm.io.read() "
                    "reads a file"
                )
            raise TypeError(msg)
        return array.astype(np.float64, copy=False)


def _to_matrix(array: NDArray[Any], name: str, square: bool) -> str:
    """How to make two dimensions of others."""
    if square:
        if array.ndim == 1 and name == "distances":
            return "; scipy.spatial.distance.squareform makes a matrix of pairs"
        return ""
    if array.ndim < 3:
        return ""
    rows = f"{name}.reshape({array.shape[0]}, -1) makes each {name}[i] a sample"
    if array.shape[-1] > 4:
        return f"; {rows}"
    last = array.shape[-1]
    return f"; {rows}, {name}.reshape(-1, {last}) each {last} numbers"


def _real_matrix(
    values: ArrayLike | None,
    name: str,
    *,
    square: bool = False,
    remedy: str = "remove or repair such samples first",
) -> NDArray[np.float64]:
    raw = _as_array(values, name)
    is_complex = raw.dtype.kind == "c"
    if is_complex and name == "distances":
        msg = "distances must be real"
        raise TypeError(msg)
    # The real part of the Hermitian product is the product of R^(2 D).
    array = _as_float(raw.real if is_complex and square else raw, name)
    if array.ndim != 2:
        msg = (
            f"{name} must be a two-dimensional array, one sample a row; got shape "
            f"{array.shape}{_to_matrix(array, name, square)}"
        )
        raise ValueError(msg)
    if square and array.shape[0] != array.shape[1]:
        msg = f"{name} must be square, got shape {array.shape}"
        raise ValueError(msg)
    if array.shape[0] == 0:
        msg = f"{name} is empty: no samples"
        raise ValueError(msg)
    if array.shape[1] == 0:
        msg = f"{name} has no coordinates: its shape is {array.shape}"
        raise ValueError(msg)
    _check_finite(raw, array, name, remedy)
    if is_complex and square:
        _check_hermitian(raw, name)
    return np.ascontiguousarray(array)


def _check_finite(
    raw: NDArray[Any], array: NDArray[np.float64], name: str, remedy: str
) -> None:
    """Refuse what is not finite as given or in double precision."""
    if raw.dtype == array.dtype:
        # Nothing that is not finite leaves a sum finite, and a sum takes no memory.
        with np.errstate(over="ignore", invalid="ignore"):
            if np.isfinite(array.sum()):
                return
    finite = np.isfinite(array)
    if raw.dtype.kind == "c":  # two columns a number, or the real parts only
        finite = finite.reshape(*raw.shape, -1).all(axis=2) & np.isfinite(raw)
    if finite.all():
        return
    row, column = (int(i) for i in np.argwhere(~finite)[0])
    if raw.dtype.kind in "fc":
        value = str(raw[row, column])
        if np.isfinite(raw[row, column]):
            value += ", infinite in double precision"
    else:
        value = str(array[row, column])
    msg = f"{name}[{row}, {column}] is {value}; {remedy}"
    raise ValueError(msg)


def _check_hermitian(matrix: NDArray[Any], name: str) -> None:
    """Imaginary parts opposite up to rounding of single precision.

    The real parts are the core's to check.
    """
    with np.errstate(over="ignore"):
        defect = np.abs(matrix.imag + matrix.imag.T)
    bad = defect > 1e-6 * np.abs(np.diagonal(matrix.real)).max()
    if bad.any():
        i, j = (int(k) for k in np.argwhere(bad)[0])
        expected = (
            "real" if i == j else f"the conjugate of {name}[{j}, {i}], {matrix[j, i]}"
        )
        msg = (
            f"{name} is not Hermitian: {name}[{i}, {j}] is {matrix[i, j]}, not "
            f"{expected}"
        )
        raise ValueError(msg)


def check_vertex_values(
    values: ArrayLike, name: str, num_vertices: int
) -> NDArray[np.float64]:
    """One number a vertex; NaN and infinity are allowed."""
    array = _as_float(values, name)
    if array.shape != (num_vertices,):
        msg = (
            f"{name} has shape {array.shape}, expected a number for each of the "
            f"{num_vertices} vertices, ({num_vertices},)"
        )
        raise ValueError(msg)
    return array
