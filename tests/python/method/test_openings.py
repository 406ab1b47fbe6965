# SPDX-License-Identifier: GPL-3.0-or-later
"""Openings by evidence: what is left open, and on what evidence."""

import pickle
import warnings

import numpy as np
import pytest

import remanifold as rm
from remanifold import datasets


def reconstruct(*args, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        return rm.reconstruct(*args, **options)


def betti(rec):
    return rec.topology().betti_numbers


def count_right(build, dim, betti_numbers, seeds):
    """How many samplings come out right, and how many are wrong without a doubt."""
    right = silent = 0
    for seed in range(seeds):
        rec = reconstruct(build(np.random.default_rng(seed)), dim)
        good = betti(rec)[: len(betti_numbers)] == betti_numbers
        right += good
        silent += not good and rec.quality.ok
    return right, silent


def square_with_hole(rng, num, missing):
    """Samples of a square in space, a disc of so many removed from its middle."""
    points = rng.uniform(-1, 1, size=(num, 2))
    radius = np.sqrt(4 * missing / num / np.pi)
    points = points[np.linalg.norm(points, axis=1) > radius]
    return np.pad(points, [(0, 0), (0, 1)])


# --- The kinds of openings ----------------------------------------------------------


def cap(rng):
    points = rng.normal(size=(600, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points[points[:, 2] > -0.3][:100]


def moebius_band(rng, num=150):
    u, v = rng.random(num) * 2 * np.pi, rng.random(num) * 0.8 - 0.4
    radius = 1 + v * np.cos(u / 2)
    return np.c_[radius * np.cos(u), radius * np.sin(u), v * np.sin(u / 2)]


def band(rng):
    """Of a cylinder; some of 150 samples leave a thin place all across it."""
    u = rng.random(150) * 2 * np.pi
    return np.c_[np.cos(u), np.sin(u), 0.8 * rng.random(150)]


def two_discs_with_a_neck(rng):
    """400 samples; the neck is four spacings wide."""
    points = rng.uniform([-2.2, -1], [2.2, 1], size=(1000, 2))
    x, y = points.T
    inside = (np.abs(x) - 1.2) ** 2 + y**2 < 1
    inside |= (np.abs(x) < 1.2) & (np.abs(y) < 0.25)
    return np.pad(points[inside][:400], [(0, 0), (0, 1)])


def squares(rng, spacings=4.5):
    points = rng.random((1000, 2))
    height = np.where(np.arange(1000) % 2, spacings / np.sqrt(500), 0.0)
    return np.c_[points, height]


def rolled_sheet(rng):
    angle = rng.random(1300) * (2 * np.pi - 0.45)
    return np.c_[np.cos(angle), np.sin(angle), 3 * rng.random(1300)]


def segments(rng, spacings=10):
    x = rng.random(200)
    return np.c_[x, np.where(np.arange(200) % 2, spacings / 100, 0)]


def circle_with_a_gap(rng):
    angle = 0.5 + rng.random(180) * (2 * np.pi - 0.5)
    return np.c_[np.cos(angle), np.sin(angle)]


def ball_with_a_cavity(rng):
    points = rng.normal(size=(2500, 3))
    points *= rng.random((2500, 1)) ** (1 / 3) / np.linalg.norm(points, axis=1)[:, None]
    return points[np.linalg.norm(points, axis=1) > 0.45]


KINDS = (
    ("cap", cap, 2, (1, 0, 0)),
    ("Moebius band", moebius_band, 2, (1, 1, 0)),
    ("band", band, 2, (1, 1, 0)),
    ("neck", two_discs_with_a_neck, 2, (1, 0, 0)),
    ("squares", squares, 2, (2, 0)),
    ("rolled sheet", rolled_sheet, 2, (1, 0, 0)),
    ("segments", segments, 1, (2, 0)),
    ("circle with a gap", circle_with_a_gap, 1, (1, 0)),
    ("ball with a cavity", ball_with_a_cavity, 3, (1, 0, 1)),
)


@pytest.mark.parametrize(
    ("build", "dim", "betti_numbers"),
    [pytest.param(*kind[1:], id=kind[0]) for kind in KINDS],
)
def test_openings_stay_open(build, dim, betti_numbers):
    right, silent = count_right(build, dim, betti_numbers, 3)
    assert right == 3
    assert silent == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("build", "dim", "betti_numbers"),
    [pytest.param(*kind[1:], id=kind[0]) for kind in KINDS],
)
def test_openings_stay_open_in_nearly_all_samplings(build, dim, betti_numbers):
    right, silent = count_right(build, dim, betti_numbers, 20)
    assert right >= 19
    assert silent <= 1


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize(
    ("large", "num", "far"),
    [(400, num, far) for num in (6, 7, 9) for far in (5, 20, 100)]
    + [(200, 6, 4), (300, 6, 5)],
)
def test_small_loops_are_kept_or_named(large, num, far, turn):
    """Loops of few samples, so many spacings from a large circle."""
    step = 2 * np.pi / large
    angles = [np.arange(n) / n * 2 * np.pi for n in (large, num)]
    circle, loop = (np.c_[np.cos(a), np.sin(a)] for a in angles)
    radius = step * num / (2 * np.pi)
    loop = radius * loop + [1 + far * step + radius, 0]
    cos, sin = np.cos(turn), np.sin(turn)  # which decides ties
    points = np.concatenate([circle, loop]) @ [[cos, -sin], [sin, cos]]
    rec = reconstruct(points, 1)
    parts = [one for one in rec.openings if one.kind == "part"]
    assert betti(rec) == (2, 2) or (parts and not rec.quality.ok)
    if parts:
        assert {*parts[0].samples.tolist()} <= {*range(large, large + num)}
        assert parts[0].decision == "left out"


@pytest.mark.parametrize("num", [6, 8, 12, 16])
def test_small_spheres_are_kept_or_named(num):
    large = datasets.sphere(1000, random_state=0)
    small = 0.06 * datasets.sphere(num, random_state=1) + [5, 0, 0]
    rec = reconstruct(np.concatenate([large, small]), 2)
    assert betti(rec)[0] == 2 or rec.openings[-1].kind == "part"
    assert betti(rec) == (2, 0, 2) or not rec.quality.ok


# --- What is closed stays closed ----------------------------------------------------


@pytest.mark.parametrize(
    ("name", "num"),
    [
        *(("sphere", 50), ("torus", 200), ("torus", 3000), ("klein_bottle", 400)),
        *(("projective_plane", 150), ("uneven_double_torus", 2500), ("circle", 300)),
        *(("uneven_torus", 4000), ("flat_torus_3", 1200), ("sphere_3", 400)),
    ],
)
def test_nothing_is_opened_that_is_closed(name, num):
    shape = datasets.SHAPES[name]
    rec = reconstruct(shape.generate(num, random_state=20), shape.dim)
    assert betti(rec) == shape.betti_numbers
    assert not [one for one in rec.openings if one.decision != "closed"]


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_lattices_have_no_openings_within(dim, jitter):
    width = {1: 200, 2: 25, 3: 10}[dim]
    axes = np.meshgrid(*[np.arange(width)] * dim, indexing="ij")
    points = np.stack(axes, axis=-1).reshape(-1, dim).astype(float)
    points += jitter * np.random.default_rng(0).uniform(-1, 1, size=points.shape)
    rec = reconstruct(np.pad(points, [(0, 0), (0, 1)]), dim)
    assert betti(rec) == (1,) + (0,) * dim
    assert not [one for one in rec.openings if one.decision == "open"]


@pytest.mark.parametrize("seed", range(3))
def test_even_samples_show_smaller_openings(seed):
    """A hole of 9 samples in a lattice is none that chance leaves; of 1,600 at random
    it is nothing."""
    width = np.arange(40.0)
    lattice = np.stack(np.meshgrid(width, width), axis=-1).reshape(-1, 2)
    lattice += np.random.default_rng(seed).uniform(-0.2, 0.2, size=lattice.shape)
    away = np.linalg.norm(lattice - 19.6, axis=1) > 2.2
    rec = reconstruct(np.pad(lattice[away], [(0, 0), (0, 1)]), 2, hole_radius=None)
    assert rec.topology().boundary_components == 2
    points = square_with_hole(np.random.default_rng(seed), 1600, 9)
    assert reconstruct(points, 2).topology().boundary_components == 1


def test_round_holes_show_with_twenty_samples_missing():
    """By the empty ball in them: by the volume of their simplices 3 of 6 would."""
    right, silent = count_right(
        lambda rng: square_with_hole(rng, 800, 20), 2, (1, 1, 0), 6
    )
    assert right >= 5
    assert silent == 0


def rings(num_rings, around, apart):
    """A tube of few rings, so many times as far apart as the samples in them."""
    angles = 2 * np.pi * np.arange(around) / around
    ring = np.c_[np.cos(angles), np.sin(angles), 0 * angles]
    step = [0, 0, apart * 2 * np.pi / around]
    return np.concatenate([ring + np.multiply(k, step) for k in range(num_rings)])


@pytest.mark.parametrize("num_rings", [2, 3])
def test_ends_of_a_tube_of_few_rings_are_not_closed_in_silence(num_rings):
    """A lid falls into as many triangles as the ring has samples, all in one ball."""
    rec = reconstruct(rings(num_rings, 20, 2.0), 2)
    assert betti(rec) == (1, 1, 0) or not rec.quality.ok


# --- What is said of it -------------------------------------------------------------


@pytest.mark.parametrize("missing", [30, 40])
def test_missing_samples_and_size_are_those_of_the_hole(missing):
    points = square_with_hole(np.random.default_rng(1), 4000, missing)
    rec = reconstruct(points, 2)
    (hole,) = (one for one in rec.openings if one.decision == "open")
    assert hole.kind == "hole"
    assert hole.missing == pytest.approx(missing, rel=0.35)
    assert hole.spacing == pytest.approx(np.sqrt(4 / 4000), rel=0.15)
    assert hole.radius == pytest.approx(np.sqrt(4 * missing / 4000 / np.pi), rel=0.25)
    distances = np.linalg.norm(rec.vertices[hole.samples], axis=1)
    assert distances.max() < hole.radius + 4 * hole.spacing
    # That is the radius up to which a hole is open.
    for factor, is_open in ((0.8, True), (1.6, False)):
        again = reconstruct(points, 2, hole_radius=factor * hole.hole_radius)
        assert (again.topology().boundary_components > 1) == is_open


def test_the_closest_decision_comes_first():
    rec = reconstruct(square_with_hole(np.random.default_rng(0), 3000, 30), 2)
    margins = [
        abs(np.log(max(one.significance, 1e-300) / rec.significance))
        for one in rec.openings
    ]
    assert len(margins) > 1
    assert margins == sorted(margins)


@pytest.mark.parametrize("dim", [1, 2])
def test_a_decision_flips_at_its_significance(dim):
    if dim == 1:
        points = datasets.circle(300, random_state=5)
    else:
        points = square_with_hole(np.random.default_rng(0), 3000, 14)
    rec = reconstruct(points, dim)
    found = [one for one in rec.openings if one.kind in ("gap", "hole")]
    least = min(found, key=lambda one: one.significance)
    assert least.decision == "closed"
    rims = rec.repair.num_boundary_components
    for factor, more in ((0.95, False), (1.05, True)):
        again = reconstruct(points, dim, significance=factor * least.significance)
        assert (again.repair.num_boundary_components > rims) == more


def graded_circle(rng):
    """Of 100 samples whose density changes tenfold along the circle, and back."""
    grid = np.linspace(0, 1, 2001)
    density = 10 ** (0.5 - 0.5 * np.cos(2 * np.pi * grid))
    total = np.concatenate([[0], np.cumsum(density[:-1] + density[1:])])
    angles = 2 * np.pi * np.interp(rng.random(100), total / total[-1], grid)
    return np.c_[np.cos(angles), np.sin(angles)]


def test_few_gaps_are_opened_where_the_density_changes():
    right, _ = count_right(graded_circle, 1, (1, 1), 100)
    # Weighed against all 150 samples around, those far denser as well, 84 are right.
    assert right >= 89


def test_none_by_significance_zero_or_a_given_rule():
    points = cap(np.random.default_rng(0))
    assert betti(reconstruct(points, 2)) == (1, 0, 0)
    for options in ({"significance": 0.0}, {"boundary": False}, {"hole_radius": 3.0}):
        rec = reconstruct(points, 2, **options)
        assert betti(rec) == (1, 0, 1)
        # Closed all the same, and said.
        least = min(rec.openings, key=lambda one: one.significance)
        assert least.decision == "closed"
        assert least.significance < 1e-3
    assert reconstruct(points, 2, method="paper").openings == ()


def test_the_same_in_other_units_and_for_products_and_threads():
    points = square_with_hole(np.random.default_rng(2), 600, 40)
    rec = reconstruct(points, 2, smooth=False)
    large = reconstruct(1024 * points, 2, smooth=False)
    for one, other in zip(rec.openings, large.openings, strict=True):
        assert other.radius == pytest.approx(1024 * one.radius)
        assert other.spacing == pytest.approx(1024 * one.spacing)
        assert other.significance == pytest.approx(one.significance)
    gram = reconstruct(gram=points @ points.T, dim=2)
    assert [one.decision for one in gram.openings].count("open") == 1
    several = reconstruct(points, 2, smooth=False, num_threads=3)
    assert repr(several.openings) == repr(rec.openings)


def test_invalid_samples_and_copies_keep_their_numbers():
    points = cap(np.random.default_rng(0))
    bare = reconstruct(points, 2, smooth=False)
    holes = np.full((2, 3), np.nan)
    rec = reconstruct(np.concatenate([holes, points]), 2, invalid="drop", smooth=False)
    copied = reconstruct(np.concatenate([points, points[:7]]), 2, smooth=False)
    assert bare.openings
    for one, other, again in zip(
        bare.openings, rec.openings, copied.openings, strict=True
    ):
        np.testing.assert_array_equal(other.samples, one.samples + 2)
        np.testing.assert_array_equal(again.samples, one.samples)


def test_openings_are_read_only_and_pickled():
    rec = reconstruct(cap(np.random.default_rng(0)), 2)
    one = rec.openings[0]
    with pytest.raises(ValueError, match="read-only"):
        one.samples[0] = 1
    with pytest.raises(AttributeError):
        one.decision = "closed"
    assert repr(pickle.loads(pickle.dumps(rec)).openings) == repr(rec.openings)


@pytest.mark.parametrize("seed", [6, 8, 9])
def test_a_bridge_between_rims_is_doubted(seed):
    rec = reconstruct(moebius_band(np.random.default_rng(seed), 100), 2)
    assert betti(rec) == (1, 1, 0) or "neck" in str(rec.quality)


@pytest.mark.parametrize(("rows", "told"), [(2, True), (5, False)])
def test_a_bridge_one_edge_wide_is_told(rows, told):
    """Two sheets joined by a strip of so many rows of samples."""
    x, y = (c.ravel().astype(float) for c in np.meshgrid(np.arange(40), np.arange(20)))
    away = np.abs(x - 19.5) > 5
    points = np.c_[x, y, 0 * x][away | (np.abs(y - 9.5) <= rows / 2)]
    points[:, :2] += np.random.default_rng(0).uniform(-0.2, 0.2, (len(points), 2))
    rec = rm.reconstruct(points, 2)
    assert betti(rec) == (1, 0, 0)
    assert ("one edge wide" in str(rec.quality)) == told


@pytest.mark.parametrize("spacings", [4.0, 5.0, 9.0])
def test_even_ends_side_by_side_stay_apart(spacings):
    """Where samples lie evenly less of a gap is evidence."""
    rng = np.random.default_rng(3)
    line = (np.arange(150) + rng.uniform(-0.3, 0.3, 150)) / 150
    points = np.r_[np.c_[line, 0 * line], np.c_[line, 0 * line + spacings / 150]]
    rec = rm.reconstruct(points, 1)
    assert betti(rec) == (2, 0)
    assert rec.quality.ok
    joints = [one for one in rec.openings if one.kind == "joint"]
    assert len(joints) == 2
    assert all(one.decision == "open" and one.dispersion < 0.7 for one in joints)


def test_products_tell_as_much_of_gaps_as_points():
    """However many neighbors the search has found."""
    points = datasets.trefoil(200, random_state=5)
    known = rm.reconstruct(points, 1, smooth=False).openings
    given = rm.reconstruct(gram=points @ points.T, dim=1).openings
    assert len(known) == len(given) > 0
    for one, other in zip(known, given, strict=True):
        assert one.expected == pytest.approx(other.expected, rel=1e-6)


@pytest.mark.parametrize("build", [band, moebius_band, rolled_sheet])
def test_a_band_of_some_spacings_is_no_neck(build):
    rec = reconstruct(build(np.random.default_rng(0)), 2)
    assert "neck" not in str(rec.quality)


# --- Rims that are known ------------------------------------------------------------


def with_rims(inside, *rims):
    """Samples in space, and flags of those on the rims."""
    points = np.concatenate([inside, *rims])
    marked = np.arange(len(points)) >= len(inside)
    return np.pad(points, [(0, 0), (0, 1)]), marked


def star_shaped_disc(rng):
    angle = np.arange(200) / 200 * 2 * np.pi
    edge = 1 + 0.3 * np.cos(5 * angle)
    points = rng.uniform(-1.3, 1.3, size=(3000, 2))
    own = 1 + 0.3 * np.cos(5 * np.arctan2(points[:, 1], points[:, 0]))
    points = points[np.linalg.norm(points, axis=1) < own - 0.05]
    return *with_rims(points, np.c_[edge * np.cos(angle), edge * np.sin(angle)]), 1


def annulus(rng):
    points = rng.uniform(-1, 1, size=(1700, 2))
    radius = np.linalg.norm(points, axis=1)
    circles = []
    for size, num in ((1.0, 160), (0.4, 70)):
        angle = np.arange(num) / num * 2 * np.pi
        circles.append(size * np.c_[np.cos(angle), np.sin(angle)])
    inside = points[(radius < 0.995) & (radius > 0.4)]
    return *with_rims(inside, *circles), 2


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("build", [star_shaped_disc, annulus])
def test_marked_rims_are_the_only_ones(build, seed):
    points, marked, rims = build(np.random.default_rng(seed))
    rec = rm.reconstruct(points, 2, boundary=marked)
    assert betti(rec) == (1, rims - 1, 0)
    assert rec.topology().boundary_components == rims
    assert not (rec.boundary & ~marked).any()
    assert rec.repair.num_boundary_components == rims
    assert rec.repair.num_holes == 0


@pytest.mark.parametrize("radius", [0.25, 0.5])
def test_a_hole_that_is_not_marked_is_closed_and_listed(radius):
    points = np.random.default_rng(0).uniform(-1, 1, size=(3000, 2))
    points = points[np.linalg.norm(points, axis=1) > radius]
    marked = np.abs(points).max(axis=1) > 0.92
    rec = reconstruct(np.pad(points, [(0, 0), (0, 1)]), 2, boundary=marked)
    assert betti(rec) == (1, 0, 0)
    assert not (rec.boundary & ~marked).any()
    least = min(rec.openings, key=lambda one: one.significance)
    assert least.decision == "closed"
    assert least.significance < 1e-9
    assert least.radius == pytest.approx(radius, rel=0.25)


def test_samples_beyond_the_marked_ones_are_told():
    points, marked, _ = star_shaped_disc(np.random.default_rng(0))
    beyond = np.array([[1.31, 0.02, 0.0]])
    with pytest.warns(rm.ManifoldWarning, match="1 sample on rims"):
        rec = rm.reconstruct(
            np.concatenate([points, beyond]), 2, boundary=np.append(marked, False)
        )
    assert rec.repair.num_boundary_components == 1
    assert rec.repair.num_holes == 0


# --- Decisions changed by hand -----------------------------------------------------


def test_an_opening_is_closed_and_reopened():
    points = square_with_hole(np.random.default_rng(0), 1500, 40)
    rec = reconstruct(points, 2)
    (hole,) = (one for one in rec.openings if one.decision == "open")
    whole = rec.close(hole)
    assert betti(rec) == (1, 1, 0)
    assert betti(whole) == (1, 0, 0)
    assert rec.if_flipped(hole).betti_numbers == (1, 0, 0)
    (closed,) = (one for one in whole.openings if one.given)
    assert closed.decision == "closed"
    assert closed.missing == pytest.approx(hole.missing, rel=0.3)
    again = whole.reopen(closed)
    np.testing.assert_array_equal(again.simplices, rec.simplices)
    # All simplices of a place are in the complex, or none is.
    for one in (rec, whole, again):
        rows = {*map(tuple, np.sort(one.simplices, axis=1).tolist())}
        for place in one.openings:
            through = [tuple(simplex) in rows for simplex in place.simplices.tolist()]
            assert place.decision == ("closed" if all(through) else "open")


def test_a_gap_that_was_closed_is_opened():
    rec = reconstruct(datasets.circle(300, random_state=5), 1)
    index = next(i for i, one in enumerate(rec.openings) if one.kind == "gap")
    assert rec.openings[index].decision == "closed"
    cut = rec.reopen(index)
    assert betti(rec) == (1, 1)
    assert betti(cut) == (1, 0)
    assert rec.if_flipped(index).betti_numbers == (1, 0)
    assert len(cut.simplices) == len(rec.simplices) - 1


def test_what_is_closed_by_another_rule_is_opened_by_hand():
    points = cap(np.random.default_rng(0))
    for options in ({"boundary": False}, {"hole_radius": 4.0}, {"significance": 0.0}):
        rec = reconstruct(points, 2, smooth=False, **options)
        assert betti(rec) == (1, 0, 1)
        least = min(rec.openings, key=lambda one: one.significance)
        assert betti(rec.reopen(least)) == (1, 0, 0)


def test_two_decisions_hold_together():
    points = square_with_hole(np.random.default_rng(0), 3000, 40)
    points = points[np.linalg.norm(points[:, :2] - 0.6, axis=1) > 0.13]
    rec = reconstruct(points, 2)
    assert betti(rec) == (1, 2, 0)
    once = rec.close(next(o for o in rec.openings if o.decision == "open"))
    assert betti(once) == (1, 1, 0)
    twice = once.close(next(o for o in once.openings if o.decision == "open"))
    assert betti(twice) == (1, 0, 0)
    assert sum(one.given for one in twice.openings) == 2


def test_decisions_by_hand_keep_numbers_and_attributes(tmp_path):
    points = square_with_hole(np.random.default_rng(0), 1500, 40)
    gaps = np.concatenate([np.full((3, 3), np.nan), points])
    rec = reconstruct(gaps, 2, invalid="drop", attributes={"n": np.arange(len(gaps))})
    rec = pickle.loads(pickle.dumps(rec))
    closed = rec.close(next(o for o in rec.openings if o.decision == "open"))
    assert betti(closed) == (1, 0, 0)
    np.testing.assert_array_equal(closed.invalid, [0, 1, 2])
    np.testing.assert_array_equal(closed.vertex_attributes["n"], np.arange(len(gaps)))
    closed.save(tmp_path / "closed.rm.npz")
    again = rm.load(tmp_path / "closed.rm.npz")
    (place,) = (one for one in again.openings if one.given)
    assert betti(again.reopen(place)) == (1, 1, 0)
    product = reconstruct(gram=points @ points.T, dim=2)
    hole = next(o for o in product.openings if o.decision == "open")
    assert betti(product.close(hole)) == (1, 0, 0)


def test_what_cannot_be_decided_by_hand_is_refused():
    rec = reconstruct(square_with_hole(np.random.default_rng(0), 1500, 40), 2)
    hole = next(one for one in rec.openings if one.decision == "open")
    with pytest.raises(ValueError, match="which is a hole that is open already"):
        rec.reopen(hole)
    with pytest.raises(ValueError, match="which is 99, but there are"):
        rec.close(99)
    with pytest.raises(TypeError, match="which"):
        rec.close("hole")
    other = reconstruct(cap(np.random.default_rng(0)), 2)
    with pytest.raises(ValueError, match="none of the openings"):
        rec.close(other.openings[0])
    step = 2 * np.pi / 400
    angles = np.arange(400) * step
    clump = 0.3 * step * np.random.default_rng(0).normal(size=(5, 2)) + [3, 0]
    parts = reconstruct(
        np.concatenate([np.c_[np.cos(angles), np.sin(angles)], clump]), 1, smooth=False
    )
    for part in (one for one in parts.openings if one.kind == "part"):
        with pytest.raises(ValueError, match="which is a part"):
            parts.reopen(part)
        assert np.isnan(part.flips_at)


def test_the_flip_is_at_the_significance_of_what_was_weighed():
    rec = reconstruct(square_with_hole(np.random.default_rng(0), 3000, 25), 2)
    for one in rec.openings:
        assert one.flips_at == one.significance
        assert (one.decision == "open") == (one.flips_at <= rec.significance)


# --- Where it is shown --------------------------------------------------------------


def test_the_diagram_has_a_point_for_each(tmp_path):
    pytest.importorskip("matplotlib")
    rec = reconstruct(square_with_hole(np.random.default_rng(0), 1500, 40), 2)
    path = tmp_path / "openings.png"
    figure = rec.plot_openings(path)
    (axes,) = figure.axes
    assert len(axes.collections) == len(rec.openings)
    evidence = [c.get_offsets()[0, 0] for c in axes.collections]
    line = -np.log10(rec.significance)
    opened = [one.decision == "open" for one in rec.openings]
    assert [e > line for e in evidence] == opened
    assert path.stat().st_size > 1000
    empty = reconstruct(datasets.torus(400, random_state=0), 2, method="paper")
    assert not empty.plot_openings().axes[0].collections


def test_the_page_lists_them(tmp_path):
    pytest.importorskip("plotly")
    path = tmp_path / "page.html"
    rec = reconstruct(square_with_hole(np.random.default_rng(0), 1500, 40), 2)
    rec.report(path)
    page = path.read_text(encoding="utf-8")
    section = page.partition('id="openings"')[2].partition("</section>")[0]
    assert section.count("<tr><td>") == len(rec.openings)
    assert "<td>hole</td><td>open</td>" in section
