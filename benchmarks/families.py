# SPDX-License-Identifier: GPL-3.0-or-later
"""Families of random manifolds whose topology is known, for soaks.

Each is a function of a generator of random numbers and of how samples lie, random, even or
graded; sizes, shapes and gaps are drawn.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

import remanifold as rm
from remanifold import datasets

# As in cpp/src/chain/openings.cpp: simplices a sample.
SIMPLICES = {1: 1.0, 2: 2.0, 3: 6.7677}
EVEN_OF = 5  # samples of which one is kept where they are to lie evenly
DENSITIES = 10.0  # ratio of the largest to the smallest where they are graded


def truth(
    dim: int,
    betti_numbers: tuple[int, ...],
    rims: int = 0,
    orientable: bool = True,
    mod3: tuple[int, ...] = (),
) -> datasets.Shape:
    """The topology of a manifold with so many boundary components."""
    return datasets.Shape(
        np.empty, dim, 0, betti_numbers, rims == 0, orientable, rims, mod3
    )


def together(*parts: datasets.Shape) -> datasets.Shape:
    """The topology of several manifolds."""
    return truth(
        parts[0].dim,
        tuple(sum(b) for b in zip(*(p.betti_numbers for p in parts), strict=True)),
        sum(p.boundary_components for p in parts),
        all(p.orientable for p in parts),
        tuple(sum(b) for b in zip(*(p.betti_numbers_mod3 for p in parts), strict=True)),
    )


LOOP, ARC = truth(1, (1, 1)), truth(1, (1, 0), rims=2)
SPHERE, TORUS, DISC = truth(2, (1, 0, 1)), truth(2, (1, 2, 1)), truth(2, (1, 0, 0), 1)
BALL, BALL_4 = truth(3, (1, 0, 0, 0), 1), truth(4, (1, 0, 0, 0, 0), 1)


@dataclass(frozen=True)
class Family:
    """Samples and the topology of what they are samples of."""

    name: str
    points: Any
    truth: datasets.Shape
    missing: float = math.inf  # samples in its gap

    @property
    def dim(self) -> int:
        return self.truth.dim

    @property
    def shows_it(self) -> bool:
        """Whether chance leaves such a gap in fewer than 5 % of data.

        Simplices with as large an empty ball are expected among independent samples as
        Miles (1974) has it: what it holds is distributed as Gamma(K).
        """
        if math.isinf(self.missing):
            return True
        terms = [self.missing**i / math.factorial(i) for i in range(self.dim)]
        expected = len(self.points) * SIMPLICES[self.dim] * sum(terms)
        return expected * math.exp(-self.missing) < 0.05


# --- With gaps --------------------------------------------------------------------------


def _line(rng: Any, num: int, kind: str) -> Any:
    if kind == "even":
        return (np.arange(num) + rng.uniform(-0.3, 0.3, num)) / num % 1.0
    return rng.random(num)


def _plane(rng: Any, num: int, kind: str, height: float = 1.0) -> Any:
    """About so many samples of [0, 1) x [0, height)."""
    if kind == "even":
        step = math.sqrt(height / num)
        x, y = np.meshgrid(np.arange(0, 1, step), np.arange(0, height, step))
        points = np.stack([x.ravel(), y.ravel()], axis=1)
        return points + rng.uniform(-0.25 * step, 0.25 * step, size=points.shape)
    return rng.random((num, 2)) * [1, height]


def _arc(rng: Any, gap: float, kind: str) -> Family:
    num = int(rng.integers(80, 1000))
    open_angle = 2 * np.pi * gap / (num + gap)
    angle = open_angle + _line(rng, num, kind) * (2 * np.pi - open_angle)
    return Family("arc", np.c_[np.cos(angle), np.sin(angle)], ARC, gap)


def _segments(rng: Any, gap: float, kind: str) -> Family:
    num = int(rng.integers(60, 500))
    apart = max(gap, 3.0) / num
    points = np.concatenate(
        [np.c_[_line(rng, num, kind), np.full(num, y)] for y in (0, apart)]
    )
    return Family("segments", points, together(ARC, ARC))


def _loops(rng: Any, gap: float, kind: str) -> Family:
    num, few = int(rng.integers(100, 600)), int(rng.integers(8, 40))
    step = 2 * np.pi / num
    radius = step * few / (2 * np.pi)
    angle, small = (2 * np.pi * _line(rng, n, kind) for n in (num, few))
    apart = 1 + radius + max(gap, 3.0) * step
    loop = radius * np.c_[np.cos(small), np.sin(small)] + [apart, 0]
    return Family(
        "loops",
        np.concatenate([np.c_[np.cos(angle), np.sin(angle)], loop]),
        together(LOOP, LOOP),
    )


def _gap_circle(rng: Any, gap: float, kind: str) -> Family:  # noqa: ARG001
    angle = 2 * np.pi * _line(rng, int(rng.integers(60, 1500)), kind)
    return Family("circle", np.c_[np.cos(angle), np.sin(angle)], LOOP)


def _sheet(rng: Any, gap: float, kind: str) -> Family:
    """A square with a disc taken out."""
    num = int(rng.integers(400, 3000))
    points = _plane(rng, num, kind)
    away = np.linalg.norm(points - 0.5, axis=1) > gap / 2 / math.sqrt(num)
    missing = math.pi * gap**2 / 4
    return Family(
        "sheet with a hole",
        np.pad(points[away], [(0, 0), (0, 1)]),
        truth(2, (1, 1, 0), rims=2),
        missing,
    )


def _squares(rng: Any, gap: float, kind: str) -> Family:
    num = int(rng.integers(300, 1500))
    apart = max(gap, 3.0) / math.sqrt(num)
    points = np.concatenate(
        [
            np.pad(_plane(rng, num, kind), [(0, 0), (0, 1)], constant_values=z)
            for z in (0, apart)
        ]
    )
    return Family("squares", points, together(DISC, DISC))


def _rolled(rng: Any, gap: float, kind: str) -> Family:
    """A cylinder with a slit of the gap."""
    num = int(rng.integers(600, 2500))
    spacing = math.sqrt(2 * np.pi * 2 / num)
    slit = min(gap * spacing, np.pi)
    flat = _plane(rng, num, kind, 2 / (2 * np.pi - slit))
    angle, height = flat[:, 0] * (2 * np.pi - slit), flat[:, 1] * (2 * np.pi - slit)
    # Edges of three spacings are common: nothing shows a narrower slit, however long.
    missing = slit * 2 / spacing**2 if gap >= 3 else 0.0
    return Family(
        "rolled sheet",
        np.c_[np.cos(angle), np.sin(angle), height],
        DISC,
        missing,
    )


def _gap_torus(rng: Any, gap: float, kind: str) -> Family:  # noqa: ARG001
    num = int(rng.integers(400, 3000))
    points = rm.datasets.torus(num, random_state=int(rng.integers(1 << 30)))
    return Family("torus", points, TORUS)


def _spheres(rng: Any, gap: float, kind: str) -> Family:  # noqa: ARG001
    num, few = int(rng.integers(300, 1500)), int(rng.integers(12, 80))
    radius = math.sqrt(few / num)
    spacing = math.sqrt(4 * np.pi / num)
    apart = 1 + radius + max(gap, 3.0) * spacing
    seeds = rng.integers(1 << 30, size=2)
    large = rm.datasets.sphere(num, random_state=int(seeds[0]))
    small = rm.datasets.sphere(few, random_state=int(seeds[1]))
    return Family(
        "spheres",
        np.concatenate([large, radius * small + [apart, 0, 0]]),
        together(SPHERE, SPHERE),
    )


def _gap_ball(rng: Any, gap: float, kind: str) -> Family:  # noqa: ARG001
    """A ball in space with a ball taken out."""
    num = int(rng.integers(1000, 2500))
    points = rng.normal(size=(num, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    points *= rng.random((num, 1)) ** (1 / 3)
    spacing = (4 / 3 * np.pi / num) ** (1 / 3)
    radius = min(gap * spacing / 2, 0.6)
    points = points[np.linalg.norm(points, axis=1) > radius]
    missing = num * radius**3
    return Family("ball with a cavity", points, truth(3, (1, 0, 1, 0), rims=2), missing)


OPENINGS = {
    "arc": _arc,
    "segments": _segments,
    "loops": _loops,
    "circle": _gap_circle,
    "sheet with a hole": _sheet,
    "squares": _squares,
    "rolled sheet": _rolled,
    "torus": _gap_torus,
    "spheres": _spheres,
    "ball with a cavity": _gap_ball,
}


# --- Of all kinds -----------------------------------------------------------------------

Draw = Callable[[int, Any], Any]  # samples, independent and uniform


def placed(draw: Draw, num: int, kind: str, rng: Any) -> Any:
    """So many samples, as they are drawn, evenly or with a density that changes."""
    seed = int(rng.integers(1 << 30))
    if kind == "even":
        return datasets.spread(draw(EVEN_OF * num, seed), num, random_state=seed)
    if kind == "graded":
        many = draw(EVEN_OF * num, seed)
        along = many @ rng.normal(size=many.shape[1])
        along = (along - along.min()) / max(np.ptp(along), 1e-300)
        chances = DENSITIES**-along
        chosen = rng.choice(len(many), num, replace=False, p=chances / chances.sum())
        return many[chosen]
    return draw(num, seed)


def _size(rng: Any, low: int, high: int) -> int:
    """Small sizes as often as large ones."""
    return round(float(np.exp(rng.uniform(math.log(low), math.log(high)))))


def _of_shape(name: str, low: int, high: int, rng: Any, kind: str) -> Family:
    """A shape of `datasets`, of so many samples."""
    shape = datasets.SHAPES[name]

    def draw(num: int, seed: int) -> Any:
        return shape.generate(num, random_state=seed)

    num = _size(rng, low, high)
    return Family(name, placed(draw, num, kind, rng), shape)


def _on_lattice(name: str, around: int, rng: Any, kind: str) -> Family:  # noqa: ARG001
    """A shape whose samples lie in rows."""
    width = int(rng.integers(around, 3 * around))
    num = width * int(rng.integers(around // 2, around))
    jitter = float(rng.choice([0.0, 0.02]))
    generate = datasets.SHAPES[name].generate
    points = generate(
        num, num_around=width, jitter=jitter, random_state=int(rng.integers(1 << 30))
    )
    return Family(name, points, datasets.SHAPES[name])


def _rotated(rng: Any, points: Any) -> Any:
    return points @ np.linalg.qr(rng.normal(size=(points.shape[1],) * 2))[0]


def _made(
    low: int,
    high: int,
    true: datasets.Shape,
    draw: Callable[[Any, int], Any],
    rng: Any,
    kind: str,
) -> Family:
    """Of a function of a generator and a number of samples."""
    num = _size(rng, low, high)
    points = placed(
        lambda n, seed: draw(np.random.default_rng(seed), n), num, kind, rng
    )
    return Family("", _rotated(rng, points), true)


def _polygon(rng: Any, num: int, corners: Any) -> Any:
    """Along the sides of a closed polygon, by their lengths."""
    ends = np.vstack([corners, corners[:1]])
    lengths = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    total = np.concatenate([[0], np.cumsum(lengths)])
    places = rng.random(num) * total[-1]
    return np.column_stack([np.interp(places, total, axis) for axis in ends.T])


def _star(points: int) -> Any:
    angles = np.arange(2 * points) * np.pi / points
    radii = np.where(np.arange(2 * points) % 2, 0.5, 1.0)
    return radii[:, None] * np.c_[np.cos(angles), np.sin(angles)]


def _knot(rng: Any, num: int) -> Any:
    """The (2, 5) torus knot, denser where it is slow."""
    t = rng.random(num) * 2 * np.pi
    around = 2 + 0.8 * np.cos(5 * t)
    return np.c_[around * np.cos(2 * t), around * np.sin(2 * t), 0.8 * np.sin(5 * t)]


def _helix(rng: Any, num: int) -> Any:
    t = rng.random(num) * 6 * np.pi
    return np.c_[np.cos(t), np.sin(t), t / 6]


def _circles(rng: Any, num: int) -> Any:
    """Five of different sizes and densities."""
    angle, which = rng.random(num) * 2 * np.pi, rng.integers(0, 5, num)
    radius = np.array([1.0, 0.5, 1.5, 0.8, 0.6])[which]
    middle = np.c_[4.0 * which, np.zeros(num)]
    return middle + radius[:, None] * np.c_[np.cos(angle), np.sin(angle)]


def _parabolas(rng: Any, num: int) -> Any:
    """Two arcs that nearly touch."""
    x = rng.uniform(-1, 1, num)
    up = rng.random(num) < 0.5
    return np.c_[x, np.where(up, 0.15 + x**2, -0.15 - x**2)]


def _box(sides: tuple[float, float, float], rng: Any, num: int) -> Any:
    """The surface of a box: creases and corners."""
    a, b, c = sides
    areas = np.repeat([b * c, a * c, a * b], 2)
    face = rng.choice(6, num, p=areas / areas.sum())
    points = rng.random((num, 3))
    points[np.arange(num), face // 2] = face % 2
    return points * sides


def _can(rng: Any, num: int) -> Any:
    """A cylinder with its lids."""
    lid = rng.random(num) < 1 / 5  # radius 1, height 4: areas 2 pi and 8 pi
    angle, radius = rng.random(num) * 2 * np.pi, np.sqrt(rng.random(num))
    radius = np.where(lid, radius, 1.0)
    height = np.where(lid, 4.0 * (rng.random(num) < 0.5), 4.0 * rng.random(num))
    return np.c_[radius * np.cos(angle), radius * np.sin(angle), height]


def _cone(rng: Any, num: int) -> Any:
    """A cone with its tip, open below: a disc."""
    angle, radius = rng.random(num) * 2 * np.pi, np.sqrt(rng.random(num))
    return np.c_[radius * np.cos(angle), radius * np.sin(angle), 1 - radius]


def _ellipsoid(rng: Any, num: int) -> Any:
    """Axes 3 : 1 : 1, denser at the tips."""
    return datasets.sphere(num, random_state=rng) * [3.0, 1.0, 1.0]


def _terrain(rng: Any, num: int) -> Any:
    x = rng.random((num, 2))
    return np.c_[x, 0.1 * np.sin(7 * x[:, 0]) * np.cos(5 * x[:, 1])]


def _scan_lines(ratio: float, rng: Any, kind: str) -> Family:
    """A terrain in rows that are some times as far apart as the samples in them."""
    rows = int(rng.integers(15, 40))
    each = round(rows * ratio)
    y, x = np.meshgrid(np.arange(rows) / rows, np.arange(each) / each, indexing="ij")
    x = x + rng.uniform(-0.2, 0.2, x.shape) / each * (kind != "even")
    height = 0.1 * np.sin(7 * x) * np.cos(5 * y)
    return Family("", np.stack([x, y, height], axis=-1).reshape(-1, 3), DISC)


def _rings(rng: Any, kind: str) -> Family:  # noqa: ARG001
    """A sphere in circles of latitude, as a turning scanner sees it."""
    number = int(rng.integers(12, 30))
    angles = (np.arange(number) + 0.5) / number * np.pi
    each = [max(3, round(2 * number * np.sin(a) * 1.5)) for a in angles]
    points = [
        np.c_[
            np.sin(a) * np.cos(t := np.arange(n) / n * 2 * np.pi + rng.random()),
            np.sin(a) * np.sin(t),
            np.full(n, np.cos(a)),
        ]
        for a, n in zip(angles, each, strict=True)
    ]
    return Family("", np.concatenate(points), SPHERE)


def _cad(rng: Any, kind: str) -> Family:  # noqa: ARG001
    """A closed tube as a program of CAD cuts it: long and narrow triangles."""
    around, along = int(rng.integers(24, 60)), int(rng.integers(8, 20))
    u, v = np.meshgrid(np.arange(along) / along, np.arange(around) / around)
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    ring = 1 + 0.3 * np.cos(v)
    return Family("", np.c_[ring * np.cos(u), ring * np.sin(u), 0.3 * np.sin(v)], TORUS)


def _lattice(dim: int, rng: Any, kind: str) -> Family:
    """A block of a lattice of K = D dimensions."""
    width = {1: (30, 200), 2: (8, 40), 3: (5, 10), 4: (3, 5)}[dim]
    axes = [np.arange(rng.integers(*width)) for _ in range(dim)]
    points = (
        np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, dim).astype(float)
    )
    if kind == "even":
        points += rng.uniform(-1e-14, 1e-14, points.shape)
    return Family("", points, {1: ARC, 2: DISC, 3: BALL, 4: BALL_4}[dim])


def _lattice_with_hole(rng: Any, kind: str) -> Family:  # noqa: ARG001
    width = int(rng.integers(20, 45))
    points = np.stack(np.meshgrid(*[np.arange(width)] * 2), -1).reshape(-1, 2)
    far = np.linalg.norm(points - width / 2, axis=1) > width / 5
    return Family("", points[far].astype(float), truth(2, (1, 1, 0), rims=2))


def _cube(dim: int, rng: Any, num: int) -> Any:
    return rng.random((num, dim))


def _sieve(rng: Any, num: int) -> Any:
    """A square with three round holes."""
    middles = np.array([[0.25, 0.25], [0.75, 0.3], [0.5, 0.75]])
    points = rng.random((4 * num, 2))
    far = np.linalg.norm(points[:, None] - middles, axis=2).min(axis=1) > 0.13
    return points[far][:num]


def _shell(dim: int, rng: Any, num: int) -> Any:
    """A ball without its middle half."""
    directions = rng.normal(size=(num, dim))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * rng.uniform(0.5**dim, 1, (num, 1)) ** (1 / dim)


def _ball(dim: int, rng: Any, num: int) -> Any:
    directions = rng.normal(size=(num, dim))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * rng.random((num, 1)) ** (1 / dim)


def _solid_torus(rng: Any, num: int) -> Any:
    points = rng.uniform(-1, 1, (12 * num, 3)) * [1.5, 1.5, 0.5]
    inside = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 1, points[:, 2]) < 0.5
    return points[inside][:num]


def _graph_over(dim: int, rng: Any, num: int) -> Any:
    """A bent cube, in one dimension more."""
    x = rng.random((num, dim))
    return np.c_[x, 0.2 * (x**2).sum(axis=1)]


def _two(draw: Callable[[Any, int], Any], offset: float, share: float) -> Any:
    """Two of a kind, of which one has a share of the samples and lies apart."""

    def both(rng: Any, num: int) -> Any:
        few = max(1, round(share * num))
        first, second = draw(rng, num - few), draw(rng, few)
        move = np.zeros(first.shape[1])
        move[0] = offset
        return np.concatenate([first, second + move])

    return both


def _sphere(dim: int, rng: Any, num: int) -> Any:
    return datasets.sphere(num, dim=dim, random_state=rng)


def _torus_of(rng: Any, num: int) -> Any:
    return datasets.torus(num, random_state=rng)


def _half_torus(rng: Any, num: int) -> Any:
    """A torus cut in two: a cylinder that is bent."""
    points = datasets.torus(6 * num, random_state=rng)
    return points[points[:, 0] > 0][:num]


def _opened(name: str, rng: Any, kind: str) -> Family:
    gap = float(np.exp(rng.uniform(0, math.log(30))))  # spacings
    return OPENINGS[name](rng, gap, "even" if kind == "even" else "random")


Build = Callable[[Any, str], Family]


def _families() -> dict[str, Build]:
    found: dict[str, Build] = {}
    sizes = {
        **dict.fromkeys(("circle", "ellipse"), (30, 600)),
        **dict.fromkeys(("planar_curve", "trefoil", "interlocking_circles"), (80, 900)),
        **dict.fromkeys(("planar_curves", "spiral", "closed_curve"), (150, 1200)),
        "closed_curve_in_100": (150, 800),
        **dict.fromkeys(("sphere", "spherical_cap", "moebius_band"), (120, 2000)),
        **dict.fromkeys(("annulus", "annulus_in_4", "projective_plane"), (200, 2000)),
        **dict.fromkeys(("torus", "uneven_torus", "flat_torus"), (300, 2500)),
        **dict.fromkeys(("flat_torus_in_100", "klein_bottle"), (400, 1500)),
        **dict.fromkeys(("concentric_spheres", "interlocking_tori"), (600, 3000)),
        **dict.fromkeys(("double_torus", "swiss_roll", "fruit_bowl"), (900, 3000)),
        "uneven_double_torus": (1500, 3000),
        **dict.fromkeys(("sphere_3", "ball", "bent_ball"), (150, 1200)),
        **dict.fromkeys(("rotations", "sphere_times_circle"), (500, 1500)),
        "flat_torus_3": (800, 1800),
        "sphere_4": (100, 400),
        "sphere_times_sphere": (300, 500),
    }
    for name, (low, high) in sizes.items():
        found[name.replace("_", " ")] = partial(_of_shape, name, low, high)
    found["grid torus"] = partial(_on_lattice, "grid_torus", 20)
    found["grid cylinder"] = partial(_on_lattice, "grid_cylinder", 20)
    for name in OPENINGS:
        found[f"gap: {name}"] = partial(_opened, name)

    def add(name: str, sizes: tuple[int, int], true: Any, draw: Any) -> None:
        found[name] = partial(_made, *sizes, true, draw)

    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    add("square outline", (60, 600), LOOP, partial(_polygon, corners=square))
    add(
        "narrow rectangle",
        (150, 900),
        LOOP,
        partial(_polygon, corners=square * [5, 0.3]),
    )
    add("star", (150, 900), LOOP, partial(_polygon, corners=_star(5)))
    add("torus knot", (200, 1000), LOOP, _knot)
    add("helix", (100, 800), ARC, _helix)
    add("five circles", (150, 900), together(*[LOOP] * 5), _circles)
    add("nearly touching arcs", (100, 800), together(ARC, ARC), _parabolas)
    add("line", (20, 400), ARC, partial(_cube, 1))
    add("cube surface", (300, 2500), SPHERE, partial(_box, (1, 1, 1)))
    add("plate", (600, 3000), SPHERE, partial(_box, (1, 1, 0.15)))
    add("can", (400, 2500), SPHERE, _can)
    add("cone", (200, 2000), DISC, _cone)
    add("ellipsoid", (200, 2000), SPHERE, _ellipsoid)
    add("terrain", (200, 2000), DISC, _terrain)
    add("square", (60, 1500), DISC, partial(_cube, 2))
    add("square with three holes", (600, 2500), truth(2, (1, 3, 0), rims=4), _sieve)
    add("half a torus", (250, 1500), truth(2, (1, 1, 0), rims=2), _half_torus)
    add(
        "spheres of two densities",
        (600, 2500),
        together(SPHERE, SPHERE),
        _two(partial(_sphere, 2), 2.6, 0.15),
    )
    add(
        "spheres nearly touching",
        (800, 2500),
        together(SPHERE, SPHERE),
        _two(partial(_sphere, 2), 2.25, 0.5),
    )
    add("two tori", (900, 2500), together(TORUS, TORUS), _two(_torus_of, 4.0, 0.3))
    found["scan lines"] = partial(_scan_lines, 2.0)
    found["scan lines, sparse"] = partial(_scan_lines, 5.0)
    found["rings of a sphere"] = _rings
    found["tube of CAD"] = _cad
    for dim in (1, 2, 3, 4):
        found[f"lattice of dimension {dim}"] = partial(_lattice, dim)
    found["lattice with a hole"] = _lattice_with_hole
    add("cube", (150, 1000), BALL, partial(_cube, 3))
    add("bent cube", (200, 1000), BALL, partial(_graph_over, 3))
    add("shell", (400, 1200), truth(3, (1, 0, 1, 0), rims=2), partial(_shell, 3))
    add("solid torus", (400, 1200), truth(3, (1, 1, 0, 0), rims=1), _solid_torus)
    add(
        "two balls",
        (300, 1200),
        together(BALL, BALL),
        _two(partial(_ball, 3), 3.0, 0.4),
    )
    three_sphere = truth(3, (1, 0, 0, 1))
    add(
        "two 3-spheres",
        (400, 1200),
        together(three_sphere, three_sphere),
        _two(partial(_sphere, 3), 3.5, 0.4),
    )
    add("ball of dimension 4", (100, 300), BALL_4, partial(_ball, 4))
    add("bent cube of dimension 4", (120, 300), BALL_4, partial(_graph_over, 4))
    return found


FAMILIES = _families()
