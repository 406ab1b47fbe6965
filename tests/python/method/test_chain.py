# SPDX-License-Identifier: GPL-3.0-or-later
"""The chain against the integer program that it stands for, by another formulation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, eye_array, hstack

import remanifold as rm
from remanifold import _core
from remanifold.datasets.shapes import SHAPES
from remanifold.method.programs import solve_program

HOLE_RADIUS = 3.0


def disputes(shape, num_samples, noise, seed):
    """Noisy samples, what all their stars agree on, and what they do not."""
    points = SHAPES[shape].generate(num_samples, random_state=seed)
    spacing = np.sqrt(np.median(rm.reconstruct(points, 2).quality.spacing ** 2))
    rng = np.random.default_rng(seed)
    points = points + rng.normal(scale=noise * spacing / 3, size=points.shape)
    rec = rm.reconstruct(points, 2, smooth=False, outliers=False)
    filled = {tuple(sorted(row)) for row in rec.repair.filled_simplices.tolist()}
    agreed = [row for row in np.sort(rec.simplices).tolist() if tuple(row) not in filled]
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
    matrix = hstack([incidence, -2 * eye_array(size), -eye_array(size)]).tocsr()
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


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("shape", ["torus", "klein_bottle", "annulus", "sphere"])
def test_windows_find_nearly_the_least_energy(shape, seed):
    given = disputes(shape, 400, 1.0, seed)
    whole = fill(*given, search_candidates=0)
    cut = fill(*given, search_candidates=0, largest_program=60, window=60)
    assert whole["num_cut"] == 0
    assert cut["largest_program"] <= 60 <= whole["largest_program"]
    assert cut["num_cut"] > 0
    least = least_energy(whole)
    for found in (whole, cut):
        rims, chosen = cofaces_of(found)
        assert (rims + chosen <= 2).all()
        print(shape, seed, len(found["energies"]), energy_of(found) / least)
