# SPDX-License-Identifier: GPL-3.0-or-later
"""What the generators share: drawing at random, checks."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]


# Lengths whose squares are numbers.
_SHORTEST, _LONGEST = 1e-100, 1e100
# Rejection gives up when so many were tried and fewer than one of so many was kept.
_TRIES, _RAREST = 50_000, 10_000
RandomState: TypeAlias = int | np.random.Generator | np.random.RandomState | None


def _generator(random_state: RandomState) -> np.random.Generator:
    if isinstance(random_state, np.random.RandomState):
        return np.random.Generator(random_state._bit_generator)
    return np.random.default_rng(random_state)


def _angles(count: int, rng: np.random.Generator) -> FloatArray:
    return rng.uniform(0.0, 2 * np.pi, count)


def _unit_circle(angles: FloatArray) -> FloatArray:
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _directions(count: int, dim: int, rng: np.random.Generator) -> FloatArray:
    vectors = rng.standard_normal((count, dim))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _reject(
    draw: Callable[[int], tuple[FloatArray, FloatArray]],
    count: int,
    rng: np.random.Generator,
    bound: float,
) -> FloatArray:
    """Keep parameters with a chance of density / bound, until there are enough.

    Where hardly any are kept the parameters of the shape are too extreme: that ends.
    """
    kept: list[FloatArray] = []
    tried = 0
    while (missing := count - sum(map(len, kept))) > 0:
        if tried >= _TRIES and (count - missing) * _RAREST < tried:
            msg = (
                f"of {tried:,} samples that were tried {count - missing:,} lie on the "
                "shape: its parameters are too extreme to draw any"
            )
            raise ValueError(msg)
        wanted = 2 * missing + 8
        parameters, density = draw(wanted)
        kept.append(parameters[rng.uniform(0.0, bound, len(density)) < density])
        tried += wanted
    return np.concatenate(kept)[:count]


def _curve(
    curve: Callable[[FloatArray], FloatArray],
    interval: tuple[float, float],
    num_samples: int,
    random_state: RandomState,
) -> FloatArray:
    """Sample a curve uniformly in arc length, measured on a fine polygon."""
    rng, count = _generator(random_state), _count(num_samples)
    t = np.linspace(*interval, 20_001)
    length = np.linalg.norm(np.diff(curve(t), axis=0), axis=1).cumsum()
    length = np.concatenate([[0.0], length])
    return curve(np.interp(rng.uniform(0.0, length[-1], count), length, t))


def _torus_points(
    u: FloatArray, v: FloatArray, major_radius: float, minor_radius: float
) -> FloatArray:
    around = major_radius + minor_radius * np.cos(v)
    return np.column_stack(
        [around[:, None] * _unit_circle(u), minor_radius * np.sin(v)]
    )


def _moved(points: FloatArray, *offset: float) -> FloatArray:
    return np.asarray(points + np.array(offset))


def _interlock(first: FloatArray, second: FloatArray, offset: float) -> FloatArray:
    return np.vstack([first, _moved(second[:, [0, 2, 1]], offset, 0.0, 0.0)])


def _geodesic_sphere(frequency: int) -> FloatArray:
    """Vertices of an icosahedron whose edges are split into ``frequency`` parts.

    There are 10 frequency^2 + 2, turned at random so that no axis is special.
    """
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array(
        [
            np.roll([0.0, one, phi], turn)
            for turn in range(3)
            for one in (-1.0, 1.0)
            for phi in (-golden, golden)
        ]
    )
    touching = np.linalg.norm(corners[:, None] - corners, axis=2) < 2.1
    weights = np.array(
        [
            (i, j, frequency - i - j)
            for i in range(frequency + 1)
            for j in range(frequency + 1 - i)
        ]
    )
    points = np.vstack(
        [
            weights @ corners[list(face)]
            for face in combinations(range(12), 3)
            if touching[np.ix_(face, face)].all()
        ]
    )
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    _, first = np.unique(points.round(9), axis=0, return_index=True)
    turn = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    return np.asarray(points[first] @ turn)


def _count(num_samples: int) -> int:
    return _at_least(num_samples, 1, "num_samples")


def _at_least(value: int, minimum: int, name: str) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        msg = f"{name} must be an integer, got {value!r}"
        raise TypeError(msg) from None
    if number < minimum:
        msg = f"{name} must be at least {minimum}, got {number}"
        raise ValueError(msg)
    return number


def _positive(value: float, name: str) -> float:
    if not _SHORTEST <= value <= _LONGEST:
        limits = f"from {_SHORTEST:g} to {_LONGEST:g}"
        msg = f"{name} must be positive, {limits}, got {value}"
        raise ValueError(msg)
    return value


def _share(value: float, name: str) -> float:
    if not 0 < value < 1:
        msg = f"{name} must be between 0 and 1, got {value}"
        raise ValueError(msg)
    return value


def _jitter(value: float) -> float:
    if not 0 <= value <= _LONGEST:
        msg = f"jitter must be at least 0 and at most {_LONGEST:g}, got {value}"
        raise ValueError(msg)
    return value


def _below_pi(angle: float, name: str) -> float:
    if not 0 < angle < np.pi:
        msg = f"{name} must be between 0 and pi, got {angle}"
        raise ValueError(msg)
    return angle


def _check_radii(
    outer: float,
    inner: float,
    names: tuple[str, str] = ("major_radius", "minor_radius"),
) -> None:
    if not 0 < inner < outer:
        msg = f"0 < {names[1]} < {names[0]} must hold, got {inner} and {outer}"
        raise ValueError(msg)
    _positive(inner, names[1])
    _positive(outer, names[0])


def _check_multiple(count: int, num_around: int) -> None:
    if count % num_around:
        msg = (
            f"num_samples must be a multiple of num_around = {num_around}, got {count}"
        )
        raise ValueError(msg)


def _check_spacing_ratio(spacing_ratio: float) -> None:
    if not 1 <= spacing_ratio <= _LONGEST:
        limits = f"at least 1 and at most {_LONGEST:g}"
        msg = f"spacing_ratio must be {limits}, got {spacing_ratio}"
        raise ValueError(msg)


def _shares(num_samples: int, weights: Sequence[float]) -> list[int]:
    """Split the samples in proportion to the weights; the last takes the rest."""
    count = _count(num_samples)
    edges = np.rint(np.cumsum(weights) / np.sum(weights) * count).astype(int)
    return [int(n) for n in np.diff(edges, prepend=0)]
