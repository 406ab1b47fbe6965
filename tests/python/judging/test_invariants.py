# SPDX-License-Identifier: GPL-3.0-or-later
"""What must hold of a result holds, and a fault in any of its tables is noticed."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import warnings

import numpy as np
import pytest

import digests
import remanifold as rm
from remanifold import datasets
from remanifold.judging import invariants

CASES = (
    *("circle_200", "circle_sparse_12", "interlocking_circles_300", "torus_1000_0"),
    *("klein_bottle_1500", "moebius_band_800", "ball_1500", "bent_ball_1500"),
    *("rotations_1000", "sphere_4_400", "grid_plane_20x20", "grid_line_50"),
    *("grid_cube_7", "grid_plane_in_space", "copies", "outliers_auto", "noise_0.5"),
    *("noise_0.5_smooth", "noise_trefoil_smooth", "boundary_none", "boundary_given"),
    *("gram_torus", "gram_rotations", "gram_smooth", "distances_torus"),
    *("distances_circle", "paper_torus", "paper_circle", "paper_rotations"),
    *("paper_sphere_4", "paper_moebius", "paper_grid", "paper_either", "paper_jet"),
    *("paper_gram", "paper_distances", "paper_outliers", "in_600_coordinates"),
)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_recorded_results(name, monkeypatch):
    def checked(rec, quality):
        if quality:
            assert rec.quality is not None
        return rec.check()

    monkeypatch.setattr(digests, "arrays_of", checked)
    found = digests.CASES[name](1)
    assert found.ok, found.answer
    assert len(found.checked) > 30


def test_copies_on_the_boundary():
    points = digests.rounded(datasets.moebius_band(400, random_state=0))
    rim = rm.reconstruct(points, 2).boundary
    rec = rm.reconstruct(np.concatenate([points, points[rim][::2], points[:9]]), 2)
    np.testing.assert_array_equal(rec.quality.boundary, rec.boundary)
    assert rec.boundary[400:].sum() >= rim[::2].sum()
    assert rec.check(raise_on_failure=True).ok


def test_samples_that_are_no_points():
    points = datasets.torus(600, random_state=0)
    points[5], points[77, 1] = np.nan, np.inf
    assert rm.reconstruct(points, 2, invalid="drop").check(raise_on_failure=True)


def test_few_samples_of_any_shape():
    rng = np.random.default_rng(0)
    for number in (4, 5, 8, 20):
        for dim, ambient in ((1, 2), (2, 2), (2, 3), (3, 3), (3, 4)):
            for method in ("manifold", "paper"):
                if number <= dim + 1:
                    continue
                rec = reconstruct(rng.random((number, ambient)), dim, method=method)
                assert rec.check().ok, (number, dim, ambient, method)


def reconstruct(*arguments, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        return rm.reconstruct(*arguments, **options)


def copies(rng):
    points = datasets.torus(300, random_state=0)
    return np.concatenate([points, points[:20], 9 + rng.random((5, 3))])


MAKERS = {
    "circle": lambda: reconstruct(datasets.circle(60, random_state=0), 1),
    "torus": lambda: reconstruct(copies(np.random.default_rng(0)), 2),
    "disc": lambda: reconstruct(datasets.spherical_cap(300, random_state=0), 2),
    "square": lambda: reconstruct(np.random.default_rng(0).random((200, 2)), 2),
    "ball": lambda: reconstruct(datasets.ball(300, random_state=0), 3),
    "sphere_3": lambda: reconstruct(datasets.sphere(200, dim=3, random_state=0), 3),
    "sphere_4": lambda: reconstruct(datasets.sphere(80, dim=4, random_state=0), 4),
    "noisy": lambda: reconstruct(
        datasets.add_noise(datasets.torus(900, random_state=0), 0.05, random_state=0),
        2,
        smooth=40,
    ),
    "paper": lambda: reconstruct(
        datasets.torus(200, random_state=0), 2, method="paper"
    ),
}


@functools.cache
def made(name):
    rec = MAKERS[name]()
    assert rec.check().ok, rec.check().answer
    return rec


def without_one(rec):
    return dataclasses.replace(rec, simplices=np.delete(rec.simplices, 7, axis=0))


def simplices(change):
    """A fault in the simplices, which `change` puts into a copy of them."""

    def fault(rec):
        rows = rec.simplices.copy()
        changed = change(rows)
        rows = np.ascontiguousarray(rows if changed is None else changed, np.int32)
        return dataclasses.replace(rec, simplices=rows)

    return fault


def put(place, value):
    def change(rows):
        rows[place] = value

    return simplices(change)


def flipped(which):
    def change(rows):
        rows[which] = rows[which][..., [*range(rows.shape[1] - 2), -1, -2]]

    return simplices(change)


def table(**changes):
    """A fault in arrays of the result; a function makes them from what is there."""

    def fault(rec):
        return dataclasses.replace(rec, **computed(rec, changes))

    return fault


def computed(whole, changes):
    return {
        name: change(getattr(whole, name).copy()) if callable(change) else change
        for name, change in changes.items()
    }


def cached(name, **changes):
    """A fault in what the result has computed."""

    def fault(rec):
        known = dataclasses.replace(rec)
        held = rec.topology() if name == "_topology" else getattr(rec, name)
        if changes:
            held = dataclasses.replace(held, **computed(held, changes))
        vars(known)[name] = held
        return known

    return fault


def betti(rec):
    known = dataclasses.replace(rec)
    said = dataclasses.replace(rec.topology())
    vars(said)["_homology"] = ((1, 2, 3), (1, 2, 1))
    vars(known)["_topology"] = said
    return known


def tangents(rec):
    known = dataclasses.replace(rec)
    bases = rec.tangents.copy()
    bases[3] *= 1.001
    vars(known)["tangents"] = bases
    return known


def edges(rec):
    known = dataclasses.replace(rec)
    vars(known)["edges"] = rec.edges[1:]
    return known


def said_digest(rec):
    known = dataclasses.replace(rec)
    vars(known)["digest"] = "sha256:0"
    return known


def provenance(rec):
    other = dataclasses.replace(rec.provenance, input="sha256:0")
    return dataclasses.replace(rec, provenance=other)


def opened(rec):
    place = dataclasses.replace(
        rec.openings[0] if rec.openings else OPENING,
        decision="open",
        simplices=rec.simplices[:1],
    )
    return dataclasses.replace(rec, openings=(place,))


OPENING = rm.Opening(
    "gap", "closed", np.array([0, 1], np.int32), 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0
)


def foreign_opening(rec):
    place = dataclasses.replace(
        OPENING, samples=np.array([0, rec.num_samples], np.int32)
    )
    return dataclasses.replace(rec, openings=(place,))


def moved(which, by):
    def fault(rec):
        places = rec.vertices.copy()
        place = which(rec) if callable(which) else which
        places[place] += by
        return dataclasses.replace(rec, vertices=places)

    return fault


def flattened(rec):
    """A corner of one simplex in the plane, or on the line, of the others, exactly."""
    places = np.round(rec.vertices * 2**20) / 2**20
    a, b, *_, c = rec.simplices[5]
    places[c] = (places[a] + places[b]) / 2
    return dataclasses.replace(rec, vertices=places, samples=places)


def pinched(rec):
    """Two vertices far from each other become one: its link is in two pieces."""
    first = int(rec.simplices[0, 0])
    near = np.unique(rec.simplices[(rec.simplices == first).any(axis=1)])
    far = np.setdiff1d(np.unique(rec.simplices), near)
    rings = np.unique(rec.simplices[np.isin(rec.simplices, near).any(axis=1)])
    other = int(np.setdiff1d(far, rings)[-1])
    rows = rec.simplices.copy()
    rows[rows == other] = first
    order = np.lexsort(np.sort(rows, axis=1).T[::-1])
    return dataclasses.replace(rec, simplices=rows[order])


def no_singular(rec):
    known = pinched(rec)
    vars(known)["_topology"] = dataclasses.replace(
        known.topology(), singular_vertices=np.empty(0, np.int32)
    )
    return known


def stars(change):
    def fault(rec):
        rows = rec.stars.simplices.copy()
        change(rows)
        return dataclasses.replace(rec, stars=rm.Stars(rec.stars.offsets, rows))

    return fault


def edge_sets(change):
    def fault(rec):
        rows = rec.edge_sets.indices.copy()
        change(rows)
        return dataclasses.replace(
            rec, edge_sets=rm.EdgeSets(rec.edge_sets.offsets, rows)
        )

    return fault


def swap(rows):
    rows[[0, 1]] = rows[[1, 0]]


def foreign_star(rows):
    rows[0, 0] = rows[-1, 0]


def far_star(rows):
    rows[0, 1] = rows[-1, 0]


def first_seen(array):
    array[0] = not array[0]
    return array


def one_more(array):
    return np.append(array, np.array([array[-1]], array.dtype), axis=0)


def all_disputed(rec):
    return cached("repair", disputed_simplices=np.sort(rec.simplices, axis=1))(rec)


FACES = np.array([[0, 1]], np.int32)
FIRST = np.array([[0, 1, 2]], np.int32)
REPAIR = functools.partial(cached, "repair")
TOPOLOGY = functools.partial(cached, "_topology")
FAULTS = [
    ("torus", put((0, 0), -1), "vertices of simplices are samples"),
    ("torus", put((0, 0), 10**6), "vertices of simplices are samples"),
    (
        "torus",
        simplices(lambda r: r.__setitem__((9, 0), r[9, 1])),
        "simplices have K + 1",
    ),
    ("torus", simplices(lambda r: r.__setitem__(3, r[2])), "no simplex is there twice"),
    ("torus", simplices(swap), "simplices are sorted"),
    ("ball", simplices(lambda r: r[:, [1, 0, 2, 3]]), "columns ascend"),
    ("torus", without_one, "facets of one simplex are reported"),
    ("circle", without_one, "facets of one simplex are reported"),
    ("ball", without_one, "facets of one simplex are reported"),
    ("sphere_4", without_one, "facets of one simplex are reported"),
    ("torus", simplices(lambda r: np.vstack([r, FIRST])), "facets of"),
    ("disc", REPAIR(open_faces=lambda a: a[1:]), "facets of one simplex are reported"),
    ("disc", REPAIR(hole_faces=FACES), "faces of holes are open"),
    ("torus", REPAIR(callous_faces=FACES), "facets of more than two simplices"),
    ("disc", REPAIR(num_holes=1), "boundary components and holes are the sets"),
    ("disc", table(boundary=first_seen), "boundary flags are those of open facets"),
    ("torus", table(boundary=first_seen), "boundary flags are those of open facets"),
    *(
        (name, pinched, "links are spheres and balls but for those that repair names")
        for name in ("circle", "torus", "ball", "sphere_3")
    ),
    *(
        (name, no_singular, "links are spheres and balls but for those that topology")
        for name in ("circle", "torus", "ball", "sphere_3")
    ),
    ("sphere_4", no_singular, "links have the homology of spheres and balls"),
    *(
        (name, flipped(3), "simplices that share a facet are oriented alike")
        for name in ("circle", "torus", "disc", "ball", "sphere_3", "sphere_4")
    ),
    ("sphere_3", flipped(slice(None)), "closed parts are oriented outward"),
    ("torus", flipped(slice(None)), "closed parts are oriented outward"),
    ("square", flipped(slice(None)), "no simplex has negative volume"),
    ("ball", flipped(slice(None)), "no simplex has negative volume"),
    ("square", flattened, "no simplex is flat"),
    ("ball", flattened, "no simplex is flat"),
    ("torus", TOPOLOGY(num_simplices=(1, 2, 3)), "topology counts the faces"),
    ("torus", TOPOLOGY(euler_characteristic=2), "topology knows the Euler"),
    ("torus", TOPOLOGY(components=2), "topology counts the components"),
    ("torus", TOPOLOGY(coface_counts={2: 1}), "topology counts cofaces"),
    ("torus", TOPOLOGY(boundary_components=1), "topology counts boundary components"),
    ("torus", TOPOLOGY(closed=False), "topology knows whether it is closed"),
    ("torus", TOPOLOGY(orientable=False), "topology knows whether it can be oriented"),
    ("torus", betti, "topology knows the Betti numbers"),
    ("torus", edges, "edges are those of the simplices"),
    (
        "torus",
        table(representatives=lambda a: np.where(a == 0, 1, a)),
        "copies are those of samples before them",
    ),
    (
        "torus",
        table(representatives=lambda a: np.where(np.arange(len(a)) == 310, 305, a)),
        "copies",
    ),
    (
        "torus",
        table(representatives=lambda a: np.where(np.arange(len(a)) == 310, 9, a)),
        "copies coincide with their sample",
    ),
    (
        "torus",
        table(representatives=lambda a: np.arange(len(a), dtype=a.dtype)),
        "samples that are equal have one representative",
    ),
    ("torus", REPAIR(merged_samples=1), "copies are counted"),
    ("torus", table(outliers=lambda a: a[1:]), "each sample is used, left out"),
    ("torus", table(outliers=lambda a: np.r_[0, a]), "each sample is used, left out"),
    ("torus", table(outliers=lambda a: a[::-1].copy()), "outliers ascend"),
    ("torus", table(invalid=np.array([320])), "samples that are no points are invalid"),
    ("torus", put((0, 0), 300), "copies are in no simplex"),
    ("noisy", table(attached=one_more), "attached ascend"),
    (
        "noisy",
        moved(lambda r: r.attached[0], 0.1),
        "attached samples are on the complex",
    ),
    (
        "noisy",
        moved(lambda r: r.simplices[0, 0], 0.1),
        "vertices are the smoothed samples",
    ),
    ("torus", moved(5, 1e-12), "vertices are the samples"),
    ("torus", said_digest, "the digest of the result is its own"),
    ("torus", provenance, "the digest of the samples is theirs"),
    ("torus", tangents, "tangent bases are orthonormal"),
    ("torus", opened, "what is called open was not left as it was"),
    ("torus", foreign_opening, "samples of openings are samples"),
    ("disc", cached("quality", boundary=first_seen), "the boundary of quality is that"),
    (
        "torus",
        REPAIR(disputed_simplices=np.array([[0, 0, 1]], np.int32)),
        "disputed simplices are simplices, each once",
    ),
    (
        "torus",
        REPAIR(filled_simplices=np.array([[0, 1, 2], [0, 1, 2]], np.int32)),
        "filled simplices are simplices, each once",
    ),
    (
        "torus",
        REPAIR(inserted_vertices=np.array([310], np.int32)),
        "samples that were put back are used",
    ),
    ("torus", REPAIR(filled_simplices=FIRST), "filled simplices are in the result"),
    ("torus", REPAIR(num_agreed=0), "what was not filled was agreed on"),
    ("torus", all_disputed, "what was not filled was not disputed"),
    ("paper", edge_sets(swap), "edge sets are sorted samples"),
    ("paper", edge_sets(lambda r: r.__setitem__(0, 0)), "edge sets are sorted samples"),
    ("paper", stars(foreign_star), "stars are those of their sample"),
    ("paper", stars(far_star), "vertices of stars are in edge sets"),
    (
        "paper",
        table(stars=rm.Stars(np.zeros(201, np.int64), FIRST[:0])),
        "bounded regions are polytopes",
    ),
    ("paper", edges, "edges are those that the edge sets have"),
    ("paper", without_one, "simplices are the cliques of the edges"),
    (
        "paper",
        REPAIR(unstarred_simplices=np.array([[0, 1, 2]], np.int32)),
        "simplices in no star are reported",
    ),
    (
        "paper",
        table(boundary=first_seen),
        "boundary flags are those of samples without",
    ),
]


@pytest.mark.parametrize(
    ("name", "fault", "said"),
    FAULTS,
    ids=[f"{i}-{name}-{said[:40]}" for i, (name, _, said) in enumerate(FAULTS)],
)
def test_faults_are_noticed(name, fault, said):
    found = fault(made(name)).check()
    assert not found.ok
    broken = [one.name for one in found.broken]
    assert any(one.startswith(said) for one in broken), broken


def test_every_invariant_has_a_fault():
    """A new one needs a fault that it alone notices, or it may notice none."""
    source = inspect.getsource(invariants)
    body = source[source.index("def _of_simplices") :]
    names = set(re.findall(r'(?:yield|name =)\s*\(?\s*\n?\s*f?"([^"]+)"', body))
    assert len(names) > 40
    told = [said for *_, said in FAULTS]
    patterns = {
        n: re.compile(re.sub(r"\\\{\w+\\\}", ".+", re.escape(n))) for n in names
    }
    lacking = {
        name
        for name, pattern in patterns.items()
        if not any(pattern.match(said) or name.startswith(said) for said in told)
    }
    lacking -= {
        # Where a copy that is left out would be one without its sample.
        "copies are left out with their sample",
        "copies have one sample",
    }
    assert not lacking


def test_what_is_shown():
    found = made("torus").check()
    assert bool(found)
    assert repr(found) == f"Invariants(ok=True, checked={len(found.checked)})"
    assert found.answer == f"all {len(found.checked)} invariants hold"
    assert "Invariant" in repr(found["simplices are sorted"])
    assert "all right" in found._repr_html_()
    with pytest.raises(KeyError):
        found["nothing"]
    bad = without_one(made("torus"))
    found = bad.check()
    assert "wrong" in found._repr_html_()
    assert "do not" in found.answer
    with pytest.raises(AssertionError, match="facets of one simplex are reported"):
        bad.check(raise_on_failure=True)


def test_large_ones_leave_out_what_takes_long(monkeypatch):
    monkeypatch.setattr(invariants, "_MANY_FOR_ALGEBRA", 10)
    for name in ("torus", "sphere_4", "paper"):
        found = made(name).check()
        assert found.ok
        assert all("more than 10" in one for one in found.left_out)
        assert found.left_out


def test_signs_of_volumes_are_exact():
    """Signs that rounding would lose: a corner beside a plane by its last bit."""
    corner = np.array([[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]])
    assert invariants._exact_sign(corner) == 0
    corner[2, 1] = np.nextafter(3.0, 4.0)
    assert invariants._exact_sign(corner) == 1
    assert invariants._exact_sign(corner[[0, 2, 1]]) == -1
    far = np.array([[1e9, 1e9], [1e9 + 1, 1e9 + 1], [1e9 + 2**-20, 1e9 + 2**-20]])
    assert invariants._exact_sign(far) == 0
