# SPDX-License-Identifier: GPL-3.0-or-later
"""The patches of a bowl and its fruits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    _geodesic_sphere,
    _moved,
    _unit_circle,
)


class _Patch:
    """A surface of revolution, its area measured on a grid of 256 x 256 cells.

    Samples lie exactly on the surface; within a cell the density is that of its
    center. ``u`` is the angle around the axis, ``v`` goes from one pole to the other.
    """

    def __init__(
        self,
        surface: Callable[[FloatArray, FloatArray], FloatArray],
        v_end: float,
        cells: int = 256,
    ) -> None:
        self._surface = surface
        self._step = np.array([2 * np.pi, v_end]) / cells
        self._corners = np.indices((cells, cells)).reshape(2, -1).T * self._step
        u, v = (self._corners + self._step / 2).T
        du, dv = self._step / 2
        along_u = surface(u + du, v) - surface(u - du, v)
        along_v = surface(u, v + dv) - surface(u, v - dv)
        self._areas = np.linalg.norm(np.cross(along_u, along_v), axis=1)
        self.area = float(self._areas.sum())

    def sample(self, count: int, rng: np.random.Generator) -> FloatArray:
        cells = rng.choice(len(self._areas), count, p=self._areas / self.area)
        parameters = self._corners[cells] + rng.uniform(size=(count, 2)) * self._step
        return self._surface(*parameters.T)

    def geodesic(self, frequency: int) -> FloatArray:
        """Points of a geodesic sphere, stretched so that areas keep their proportion."""
        x, y, z = _geodesic_sphere(frequency).T
        rows = round(np.sqrt(len(self._areas)))
        below = self._areas.reshape(rows, rows).sum(axis=0).cumsum() / self.area
        edges = np.arange(rows + 1) * self._step[1]
        share = np.clip((1 - z) / 2, 0.0, 1.0)
        v = np.interp(share, np.concatenate([[0.0], below]), edges)
        return self._surface(np.arctan2(y, x), v)


def _bowl_and_fruits() -> list[_Patch]:
    fruits = [_Patch(surface, np.pi) for surface in (_orange, _pear, _lemon)]
    return [_Patch(_bowl, 3.0), *fruits]


def _bowl(u: FloatArray, v: FloatArray) -> FloatArray:
    # A thick cap of a sphere. Its outline: up the outside, over the rim, down again.
    outside, rim, inside = (np.clip(v - start, 0.0, 1.0) for start in range(3))
    depth = 1.15 * (outside - inside)
    radius = 2.0 + 0.2 * np.cos(np.pi * rim)
    height = 0.2 * np.sin(np.pi * rim)
    outline = np.column_stack(
        [
            radius * np.sin(depth) + height * np.cos(depth),
            -radius * np.cos(depth) + height * np.sin(depth),
        ]
    )
    return np.column_stack([outline[:, :1] * _unit_circle(u), outline[:, 1]])


def _orange(u: FloatArray, v: FloatArray) -> FloatArray:
    around = 0.6 * np.sin(v)[:, None] * _unit_circle(u)
    points = np.column_stack([around, 0.56 * np.cos(v)])
    return _moved(points, -0.64, 0.4, -0.4)


def _pear(u: FloatArray, v: FloatArray) -> FloatArray:
    around = (0.46 * np.sin(v) * (1 - 0.35 * np.cos(v)))[:, None] * _unit_circle(u)
    points = np.column_stack([around, 0.72 * np.cos(v)])
    return _moved(points, 0.8, 0.4, -0.2)


def _lemon(u: FloatArray, v: FloatArray) -> FloatArray:
    around = 0.38 * np.sin(v)[:, None] * _unit_circle(u)
    points = np.column_stack([0.52 * np.cos(v), around])
    return _moved(points, 0.1, -0.76, -0.72)
