# SPDX-License-Identifier: GPL-3.0-or-later
"""The chain against the integer program that it stands for, by another formulation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, eye, hstack

import remanifold as rm
from remanifold import _core
from remanifold.datasets.shapes import SHAPES
from remanifold.method.programs import solve_program

HOLE_RADIUS = 3.0
# Some of what is reconstructed here has holes.
pytestmark = pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")


def disputes(shape, num_samples, noise, seed):
    """Noisy samples, what all their stars agree on, and what they do not."""
    points = SHAPES[shape].generate(num_samples, random_state=seed)
    spacing = np.sqrt(np.median(rm.reconstruct(points, 2).quality.spacing ** 2))
    rng = np.random.default_rng(seed)
    points = points + rng.normal(scale=noise * spacing / 3, size=points.shape)
    rec = rm.reconstruct(points, 2, smooth=False, outliers=False)
    filled = {tuple(sorted(row)) for row in rec.repair.filled_simplices.tolist()}
    agreed = [
        row for row in np.sort(rec.simplices).tolist() if tuple(row) not in filled
    ]
    candidates = np.concatenate(
        [rec.repair.disputed_simplices, rec.repair.filled_simplices]
    )
    return points, np.array(agreed, dtype=np.int32), candidates.astype(np.int32)


def fill(points, fixed, candidates, **sizes):
    return _core.fill_cavities(
        points,
        fixed,
        candidates,
        hole_radius=HOLE_RADIUS,
        solve=solve_program,
        num_threads=1,
        progress=None,
        **sizes,
    )


def cofaces_of(found):
    """Of each facet: fixed simplices, and chosen ones."""
    chosen = found["facets"][found["chosen"]].ravel()
    size = len(found["prices"])
    return (found["rims"] >= 0).astype(int), np.bincount(chosen, minlength=size)


def energy_of(found):
    rims, chosen = cofaces_of(found)
    return (
        found["energies"][found["chosen"]].sum()
        + found["prices"][rims + chosen == 1].sum()
    )


def least_energy(found):
    """Of all sets that leave each facet with none, one or two cofaces, oriented or not.

    Candidates x, facets with two cofaces z, open facets y: A x + rims = 2 z + y.
    """
    num, facets = len(found["energies"]), found["facets"]
    size = len(found["prices"])
    rows = facets.ravel()
    columns = np.repeat(np.arange(num), facets.shape[1])
    incidence = csr_array((np.ones(len(rows)), (rows, columns)), shape=(size, num))
    rims = (found["rims"] >= 0).astype(float)
    matrix = hstack([incidence, -2 * eye(size), -eye(size)]).tocsr()
    costs = np.concatenate([found["energies"], np.zeros(size), found["prices"]])
    solved = milp(
        costs,
        constraints=LinearConstraint(matrix, -rims, -rims),
        integrality=np.ones(len(costs)),
        bounds=Bounds(0, 1),
        options={"mip_rel_gap": 1e-9},
    )
    assert solved.status == 0
    return solved.fun


def ratio_of(found):
    """Energy over the least; no facet has more than two cofaces."""
    rims, chosen = cofaces_of(found)
    assert (rims + chosen <= 2).all()
    least = least_energy(found)
    assert energy_of(found) >= least * (1 - 1e-6)
    return energy_of(found) / least


@pytest.mark.parametrize("noise", [0.5, 1.0, 1.5])
# Not the Klein bottle: one program has one orientation, all around the cavity.
@pytest.mark.parametrize("shape", ["torus", "double_torus", "annulus", "sphere"])
def test_small_cavities_have_the_least_energy(shape, noise):
    num_cavities = 0
    for seed in range(3):
        given = disputes(shape, 150, noise, seed)
        searched = fill(*given)
        solved = fill(*given, search_candidates=0)
        assert solved["num_searched"] == 0 < solved["num_programs"]
        assert ratio_of(searched) < 1.01
        assert ratio_of(solved) < 1.01
        num_cavities += solved["num_cavities"]
    assert num_cavities > 2


@pytest.mark.parametrize("noise", [0.5, 1.5])
@pytest.mark.parametrize("shape", ["torus", "moebius_band", "sphere"])
def test_a_search_that_minds_orientation_spares_programs(shape, noise):
    spared = 0
    for seed in range(4):
        given = disputes(shape, 300, noise, seed)
        solved = fill(*given, search_candidates=0, refill=0)
        searched = fill(*given, search_oriented=True, refill=0)
        assert energy_of(searched) <= energy_of(solved) * (1 + 1e-6)
        assert searched["num_programs"] <= solved["num_programs"]
        spared += searched["num_searched"]
    # Much noise leaves few cavities, and large ones.
    assert spared > (10 if noise < 1 else 0)


def test_what_signs_leave_open_is_filled_without_them():
    guesses = []
    for seed in range(3):
        given = disputes("torus", 400, 1.0, seed)
        guessed = fill(*given, search_candidates=0, refill=0)
        filled = fill(*given, search_candidates=0, refill=400)
        assert guessed["num_refills"] == 0
        guesses.append(ratio_of(guessed))
        assert filled["num_refilled"] > 0 or guesses[-1] < 1.01
        assert ratio_of(filled) < 1.01
    assert max(guesses) > 1.5


@pytest.mark.parametrize("window", [60, 250])
@pytest.mark.parametrize("shape", ["torus", "klein_bottle"])
def test_windows_are_as_large_as_they_may_be(shape, window):
    given = disputes(shape, 400, 1.0, 0)
    cut = fill(*given, search_candidates=0, largest_program=window, window=window)
    assert cut["num_cut"] > 0
    assert cut["largest_program"] == window
    rims, chosen = cofaces_of(cut)
    assert (rims + chosen <= 2).all()
    assert (rims + chosen == 2).sum() > 5 * (rims + chosen == 1).sum()


def test_windows_of_half_a_cavity_cost_little_energy():
    ratios = []
    for shape in ("klein_bottle", "sphere", "double_torus"):
        for seed in range(3):
            given = disputes(shape, 400, 0.7, seed)
            whole = fill(*given, search_candidates=0)
            half = whole["largest_program"] // 2
            cut = fill(*given, search_candidates=0, largest_program=half, window=half)
            assert cut["num_cut"] > 0
            ratios.append(energy_of(cut) / energy_of(whole))
    assert np.median(ratios) < 1.01


def test_a_cavity_is_filled_as_if_it_were_alone():
    """Where it is one program: windows follow the numbers of the samples."""
    parts = [disputes(shape, 300, 1.0, 0) for shape in ("torus", "sphere")]
    alone = [fill(*part, search_candidates=0) for part in parts]
    first = len(parts[0][0])
    points = np.concatenate([parts[0][0], parts[1][0] + [100.0, 0.0, 0.0]])
    both = [
        np.concatenate([parts[0][i], parts[1][i] + np.int32(first)]) for i in (1, 2)
    ]
    together = fill(points, *both, search_candidates=0)
    shifts = (0, first)
    expected = {
        tuple(sorted(row))
        for found, shift in zip(alone, shifts, strict=True)
        for row in (found["candidates"][found["chosen"]] + shift).tolist()
    }
    found = together["candidates"][together["chosen"]].tolist()
    assert {tuple(sorted(row)) for row in found} == expected


def test_programs_are_bounded_and_counted():
    points = SHAPES["torus"].generate(1500, random_state=0)
    rng = np.random.default_rng(0)
    points += rng.normal(scale=0.08, size=points.shape)
    repair = rm.reconstruct(points, 2, smooth=False, outliers=False).repair
    assert repair.num_cut_cavities > 0
    assert 0 < repair.largest_program <= 4000
    assert repair.num_programs > repair.num_cut_cavities
