# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths along the triangles of a surface, made straight, from the lengths of its edges."""

from __future__ import annotations

import functools
import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]
    Point = tuple[float, float]

# Of an angle or a length, that counts as rounding.
_ROUNDING = 1e-12


class _Portal(NamedTuple):
    """An edge that a strip of triangles crosses, laid flat, seen on the way ahead."""

    left: int
    right: int
    left_at: Point
    right_at: Point


class _Corner(NamedTuple):
    """Where a path bends: at which end of which edge."""

    portal: int
    on_left: bool


class Surface:
    """A manifold of triangles, of any orientation or none."""

    def __init__(self, complex_: ComplexData) -> None:
        rows = complex_.simplices
        self._rows = rows
        squares = complex_._source.squared_distances(
            rows[:, [1, 2, 0]], rows[:, [2, 0, 1]]
        )
        self._sides = np.sqrt(squares)  # opposite to the corners
        self._count = complex_.num_vertices

    @functools.cached_property
    def _across(self) -> NDArray[np.int64]:
        """The triangle across each side, -1 at the boundary, (M, 3)."""
        sides = np.sort(
            np.stack([self._rows[:, [1, 2, 0]], self._rows[:, [2, 0, 1]]], axis=2),
            axis=2,
        ).reshape(-1, 2)
        keys = sides[:, 0].astype(np.int64) * self._count + sides[:, 1]
        order = np.argsort(keys, kind="stable")
        same = np.flatnonzero(keys[order[1:]] == keys[order[:-1]])
        found = np.full(len(keys), -1, dtype=np.int64)
        first, second = order[same], order[same + 1]
        found[first], found[second] = second // 3, first // 3
        return found.reshape(-1, 3)

    @functools.cached_property
    def _stars(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Triangles of all vertices, one after the other, and where each begins."""
        corners = self._rows.ravel()
        order = np.argsort(corners, kind="stable") // 3
        starts = np.searchsorted(np.sort(corners), np.arange(self._count + 1))
        return order, starts

    def _star(self, vertex: int) -> list[int]:
        order, starts = self._stars
        return [int(t) for t in order[starts[vertex] : starts[vertex + 1]]]

    def _corners(self, triangle: int) -> list[int]:
        return [int(v) for v in self._rows[triangle]]

    def _length(self, triangle: int, i: int, j: int) -> float:
        """Between two of its vertices."""
        corners = self._corners(triangle)
        opposite = 3 - corners.index(i) - corners.index(j)
        return float(self._sides[triangle, opposite])

    def _angle(self, triangle: int, vertex: int) -> float:
        place = self._corners(triangle).index(vertex)
        a, b, c = (float(self._sides[triangle, (place + k) % 3]) for k in range(3))
        if not (b > 0 and c > 0):
            return 0.0
        # As Kahan has it, which thin triangles do not spoil.
        b, c = max(b, c), min(b, c)
        rest = a - (b - c) if c >= a else c - (b - a)
        under = (b + (c + a)) * ((b - a) + c)
        over = ((b - c) + a) * rest
        return 2 * math.atan2(math.sqrt(max(over, 0.0)), math.sqrt(max(under, 0.0)))

    def straightened(
        self, edges: NDArray[np.int32], shares: Floats
    ) -> tuple[NDArray[np.int32], Floats]:
        """The shortest path that a path can be shortened to.

        Both as points on edges from start to end, at vertices that vertex twice. The
        strip of triangles that the path passes is laid flat, where a funnel has the
        shortest way through it. Where this bends at a vertex around which, on the other
        side, there is less than half a turn, the strip goes around there instead: each
        time the path becomes shorter.
        """
        start, end = int(edges[0, 0]), int(edges[-1, 0])
        strip = self._trimmed(self._strip(edges, shares), start, end)
        best = math.inf
        while True:
            portals, goal = self._laid_flat(strip, start, end)
            corners = _funnel(portals, goal)
            length = _length_of(portals, goal, corners)
            if not length < best * (1 - _ROUNDING):
                break  # as short as before, by rounding
            kept, best = (portals, goal, corners), length
            turns = [
                (own, k)
                for k in range(len(corners))
                if (own := self._other_side(strip, portals, goal, corners, k))
                < math.pi * (1 - _ROUNDING)
            ]
            if not turns:
                break
            strip = self._trimmed(
                self._around(strip, portals, corners, min(turns)[1]), start, end
            )
        return _points(*kept, start, end)

    def _strip(self, edges: NDArray[np.int32], shares: Floats) -> list[int]:
        """Triangles that a path passes, each beside the one before."""
        places = [
            {int(i)} if s == 0 or i == j else {int(j)} if s == 1 else {int(i), int(j)}
            for (i, j), s in zip(edges, shares, strict=True)
        ]
        strip: list[int] = []
        for one, other in itertools.pairwise(places):
            both = one | other
            own = [t for t in self._star(min(one)) if both <= set(self._corners(t))]
            if not strip:
                strip.append(own[0])
                continue
            if strip[-1] in own:
                continue
            if len(one) == 2:
                strip.append(own[0])  # across the edge that the point lies on
            else:
                strip += self._fan(min(one), strip[-1], own[0])
        return strip

    def _fan(self, vertex: int, first: int, last: int) -> list[int]:
        """Triangles around a vertex after one up to another, by the shorter way."""
        ways = []
        for side in self._corners(first):
            if side == vertex:
                continue
            way = [first, *self._turn(vertex, first, side)]
            if last in way:
                ways.append(way[1 : way.index(last) + 1])
        return min(ways, key=len)

    def _turn(self, vertex: int, first: int, toward: int) -> Iterator[int]:
        """Triangles around a vertex after one, by its edge to another; until all are."""
        triangle, edge = first, toward
        while True:
            corners = self._corners(triangle)
            third = next(v for v in corners if v not in (vertex, edge))
            following = int(self._across[triangle, corners.index(third)])
            if following < 0 or following == first:
                return
            triangle = following
            edge = next(v for v in self._corners(triangle) if v not in (vertex, edge))
            yield triangle

    def _trimmed(self, strip: list[int], start: int, end: int) -> list[int]:
        """Without ways back, and without triangles that turn around its ends."""
        found: list[int] = []
        for triangle in strip:
            if len(found) > 1 and found[-2] == triangle:
                found.pop()
            elif not found or found[-1] != triangle:
                found.append(triangle)
        first = max(k for k, t in enumerate(found) if start in self._corners(t))
        last = next(
            k for k, t in enumerate(found) if k >= first and end in self._corners(t)
        )
        return found[first : last + 1]

    def _laid_flat(
        self, strip: list[int], start: int, end: int
    ) -> tuple[list[_Portal], Point]:
        """The edges that a strip crosses, in the plane; its start is the origin."""
        first = strip[0]
        a, b = (v for v in self._corners(first) if v != start)
        along = self._length(first, start, a)
        at = {
            start: (0.0, 0.0),
            a: (along, 0.0),
            b: _third(
                (0.0, 0.0),
                (along, 0.0),
                self._length(first, start, b),
                self._length(first, a, b),
            ),
        }
        if len(strip) == 1:
            return [], at[end]
        right, left = a, b
        portals: list[_Portal] = []
        for before, after in itertools.pairwise(strip):
            if portals:
                gone = (set(self._corners(before)) & {left, right}) - set(
                    self._corners(after)
                )
                new = next(v for v in self._corners(before) if v not in (left, right))
                if gone == {left}:
                    left = new
                else:
                    right = new
            portals.append(_Portal(left, right, at[left], at[right]))
            third = next(v for v in self._corners(after) if v not in (left, right))
            at[third] = _third(
                at[left],
                at[right],
                self._length(after, left, third),
                self._length(after, right, third),
            )
        return portals, at[end]

    def _other_side(
        self,
        strip: list[int],
        portals: list[_Portal],
        goal: Point,
        corners: list[_Corner],
        k: int,
    ) -> float:
        """Angle at a corner of the path on the side where the strip is not."""
        vertex, first, last = _turned(portals, corners, k)
        star = self._star(vertex)
        if any(
            self._across[t, place] < 0
            for t in star
            for place, v in enumerate(self._corners(t))
            if v != vertex
        ):
            return math.inf  # at the boundary there is none
        here = _at(portals, corners[k])
        before = _at(portals, corners[k - 1]) if k else (0.0, 0.0)
        after = _at(portals, corners[k + 1]) if k + 1 < len(corners) else goal
        on_left = corners[k].on_left
        ahead = [
            own.right_at if on_left else own.left_at
            for own in (portals[first], portals[last])
        ]
        inside = _between(here, before, ahead[0]) + _between(here, ahead[1], after)
        inside += sum(self._angle(t, vertex) for t in strip[first + 1 : last + 1])
        return sum(self._angle(t, vertex) for t in star) - inside

    def _around(
        self,
        strip: list[int],
        portals: list[_Portal],
        corners: list[_Corner],
        k: int,
    ) -> list[int]:
        """The strip on the other side of a vertex where the path bends."""
        vertex, first, last = _turned(portals, corners, k)
        own = portals[first]
        inward = own.right if corners[k].on_left else own.left
        outward = next(
            v for v in self._corners(strip[first]) if v not in (vertex, inward)
        )
        way = [strip[first]]
        if strip[first] != strip[last + 1]:
            for triangle in self._turn(vertex, strip[first], outward):
                way.append(triangle)
                if triangle == strip[last + 1]:
                    break
        return [*strip[:first], *way, *strip[last + 2 :]]


def _third(one: Point, other: Point, from_one: float, from_other: float) -> Point:
    """Left of the way from one to the other, by how far it is from both."""
    x, y = other[0] - one[0], other[1] - one[1]
    base = math.hypot(x, y)
    if base == 0:
        return (one[0] + from_one, one[1])
    along = (base * base + (from_one - from_other) * (from_one + from_other)) / (
        2 * base
    )
    high = math.sqrt(max((from_one - along) * (from_one + along), 0.0))
    x, y = x / base, y / base
    return (one[0] + along * x - high * y, one[1] + along * y + high * x)


def _cross(origin: Point, one: Point, other: Point) -> float:
    return (one[0] - origin[0]) * (other[1] - origin[1]) - (one[1] - origin[1]) * (
        other[0] - origin[0]
    )


def _between(at: Point, one: Point, other: Point) -> float:
    """Angle at a point, from 0 to pi."""
    dot = (one[0] - at[0]) * (other[0] - at[0]) + (one[1] - at[1]) * (other[1] - at[1])
    return math.atan2(abs(_cross(at, one, other)), dot)


def _at(portals: list[_Portal], corner: _Corner) -> Point:
    own = portals[corner.portal]
    return own.left_at if corner.on_left else own.right_at


def _run(portals: list[_Portal], corner: _Corner) -> tuple[int, int, int]:
    """The vertex of a corner, and the first and last edge with it, one after the other."""

    def end(k: int) -> int:
        return portals[k].left if corner.on_left else portals[k].right

    vertex = end(corner.portal)
    first = last = corner.portal
    while first > 0 and end(first - 1) == vertex:
        first -= 1
    while last + 1 < len(portals) and end(last + 1) == vertex:
        last += 1
    return vertex, first, last


def _turned(
    portals: list[_Portal], corners: list[_Corner], k: int
) -> tuple[int, int, int]:
    """The vertex of a corner, and between which edges the strip lies beside the path.

    Those that the path does not go along, from the corner before or to the next one.
    """

    def vertex_of(corner: _Corner) -> int:
        own = portals[corner.portal]
        return own.left if corner.on_left else own.right

    vertex, first, last = _run(portals, corners[k])
    other = [
        own.right if corners[k].on_left else own.left
        for own in portals[first : last + 1]
    ]
    begin, end = first, last
    if k and vertex_of(corners[k - 1]) in other:
        before = vertex_of(corners[k - 1])
        begin = first + max(i for i, v in enumerate(other) if v == before)
    if k + 1 < len(corners) and vertex_of(corners[k + 1]) in other:
        end = first + other.index(vertex_of(corners[k + 1]))
    return vertex, begin, max(begin, end)


def _funnel(portals: list[_Portal], goal: Point) -> list[_Corner]:
    """Where the shortest path from the origin through all edges bends.

    Lee and Preparata, Euclidean shortest paths in the presence of rectilinear barriers,
    Networks 14, 1984; the next corner is looked for from the last one on.
    """
    corners: list[_Corner] = []
    apex: Point = (0.0, 0.0)
    begin = 0
    while True:
        left = right = -1
        k = begin
        turned = False
        while k <= len(portals):
            own_left = portals[k].left_at if k < len(portals) else goal
            own_right = portals[k].right_at if k < len(portals) else goal
            if left < 0 or _cross(apex, portals[left].left_at, own_left) <= 0:
                if right >= 0 and _cross(apex, portals[right].right_at, own_left) < 0:
                    corner = _Corner(right, on_left=False)
                    turned = True
                    break
                if k < len(portals):
                    left = k
            if right < 0 or _cross(apex, portals[right].right_at, own_right) >= 0:
                if left >= 0 and _cross(apex, portals[left].left_at, own_right) > 0:
                    corner = _Corner(left, on_left=True)
                    turned = True
                    break
                if k < len(portals):
                    right = k
            k += 1
        if not turned:
            return corners
        corners.append(corner)
        apex = _at(portals, corner)
        begin = _run(portals, corner)[2] + 1


def _length_of(portals: list[_Portal], goal: Point, corners: list[_Corner]) -> float:
    points = [(0.0, 0.0), *(_at(portals, corner) for corner in corners), goal]
    return sum(math.dist(a, b) for a, b in itertools.pairwise(points))


def _points(
    portals: list[_Portal],
    goal: Point,
    corners: list[_Corner],
    start: int,
    end: int,
) -> tuple[NDArray[np.int32], Floats]:
    """Where a path meets the edges."""
    edges, shares = [(start, start)], [0.0]
    apex: Point = (0.0, 0.0)
    begin = 0
    for corner in [*corners, None]:
        following = goal if corner is None else _at(portals, corner)
        stop = len(portals) if corner is None else _run(portals, corner)[1]
        for own in portals[begin:stop]:
            one = _cross(apex, following, own.left_at)
            other = _cross(apex, following, own.right_at)
            share = one / (one - other) if one != other else 0.0
            share = min(max(share, 0.0), 1.0)
            i, j = own.left, own.right
            if i > j:
                i, j, share = j, i, 1 - share
            edges.append((i, j))
            shares.append(share)
        if corner is not None:
            vertex, _, last = _run(portals, corner)
            edges.append((vertex, vertex))
            shares.append(0.0)
            apex, begin = following, last + 1
    edges.append((end, end))
    shares.append(0.0)
    return np.array(edges, dtype=np.int32), np.array(shares)
