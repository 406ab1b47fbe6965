# SPDX-License-Identifier: GPL-3.0-or-later
"""The sentence that says what came out and how sure it is, and names of surfaces."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import remanifold as rm

ONE = "right as far as can be told"


@pytest.mark.parametrize(
    ("shape", "dim", "name", "description"),
    [
        ("circle", 1, "a closed curve", "a closed curve"),
        ("spiral", 1, "an arc", "an arc"),
        ("sphere", 2, "a sphere", "a closed surface of genus 0 (a sphere)"),
        ("torus", 2, "a torus", "a closed surface of genus 1 (a torus)"),
        (
            *("double_torus", 2, "a surface of genus 2"),
            "a closed surface of genus 2",
        ),
        (
            *("klein_bottle", 2, "a Klein bottle"),
            "a closed non-orientable surface (a Klein bottle)",
        ),
        (
            *("projective_plane", 2, "a projective plane"),
            "a closed non-orientable surface (a projective plane)",
        ),
        (
            *("moebius_band", 2, "a Möbius band"),
            "a non-orientable surface with 1 boundary curve (a Möbius band)",
        ),
        (
            *("annulus", 2, "an annulus"),
            "a surface of genus 0 with 2 boundary curves (an annulus)",
        ),
        (
            *("spherical_cap", 2, "a disc"),
            "a surface of genus 0 with 1 boundary curve (a disc)",
        ),
        (
            *("interlocking_circles", 1, ""),
            "2 separate parts, each a closed curve",
        ),
        ("rotations", 3, "", "a closed orientable 3-manifold"),
        ("ball", 3, "", "an orientable 3-manifold with 1 boundary component"),
    ],
)
def test_complexes_are_named(shape, dim, name, description):
    points = getattr(rm.datasets, shape)(900, random_state=0)
    found = rm.reconstruct(points, dim).topology()
    assert found.name == name
    assert found.description == description


def test_less_discs():
    torus = rm.reconstruct(rm.datasets.torus(500, random_state=0), 2)
    kept = np.ones(len(torus.simplices), dtype=bool)
    kept[5] = False
    assert torus.subset(kept).topology().name == "a torus less a disc"
    far = np.argmax(np.linalg.norm(torus.vertices - torus.vertices[0], axis=1))
    kept[np.argmax((torus.simplices == far).any(axis=1))] = False
    found = torus.subset(kept).topology()
    assert found.name == "a torus less 2 discs"
    assert found.description == (
        "a surface of genus 1 with 2 boundary curves (a torus less 2 discs)"
    )


def test_parts_are_counted():
    def ring(first, count):
        here = np.arange(first, first + count)
        return np.stack([here, np.roll(here, -1)], axis=1)

    rings = [ring(10 * i, 5) for i in range(20)]
    few = rm.compute_topology(np.concatenate([*rings[:2], [[95, 96]]]), 200)
    assert few.description == "3 separate parts: 2 times a closed curve, an arc"
    assert rm.compute_topology(np.concatenate(rings), 200).description == (
        "20 separate curves"
    )


def test_what_is_no_manifold():
    fan = rm.compute_topology([[0, 1, 2], [0, 1, 3], [0, 1, 4]], 5)
    assert fan.name == ""
    assert fan.description == (
        "no surface: around 2 vertices it is neither a ball nor half of one"
    )
    nothing = rm.compute_topology(np.empty((0, 3), dtype=int), 5)
    assert nothing.description == "nothing: no triangles"


def test_betti_numbers_are_told_where_they_are_known():
    rec = rm.reconstruct(rm.datasets.rotations(600, random_state=0), 3)
    assert "Betti" not in rec.topology().description
    rec.topology().betti_numbers  # noqa: B018
    again = rm.compute_topology(rec.simplices, rec.num_vertices)
    again.betti_numbers  # noqa: B018
    assert again.description.endswith("3-manifold, Betti numbers 1, 1, 1, 1")


def test_answers():
    rec = rm.reconstruct(rm.datasets.torus(900, random_state=0), 2)
    assert rec.answer == f"a closed surface of genus 1 (a torus), {ONE}"
    doubtful = rm.reconstruct(rm.datasets.torus(80, random_state=1), 2)
    assert not doubtful.quality.ok
    reason = doubtful.quality.reasons[0].text
    assert doubtful.answer == f"{doubtful.topology().description}, in doubt: {reason}"


def test_data_that_is_no_manifold_is_not_called_one():
    rec = rm.reconstruct(rm.datasets.crossing_balls(900, random_state=0), 2)
    assert rec.topology().manifold
    assert rec.answer.startswith("in doubt: no 2-manifold: two sheets cross")
    assert rec.answer.endswith(f"; what was made is {rec.topology().description}")


@pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")
def test_what_is_left_to_mend_is_no_good_answer():
    from remanifold.judging.answer import answer_of

    rec = rm.reconstruct(rm.datasets.torus(900, random_state=0), 2)
    torn = dataclasses.replace(rec.repair, num_holes=2)
    said = answer_of(rec.topology(), torn, rec.quality)
    assert not said.good
    assert said.text.endswith(
        "but it lacks something: 2 holes where none were asked for"
    )
    left = dataclasses.replace(rec.repair, unused_vertices=np.array([3], np.int32))
    said = answer_of(rec.topology(), left, rec.quality)
    assert said.good
    assert said.text.endswith(f"{ONE}, but for 1 sample in no simplex")
    said = answer_of(rec.topology(), rec.repair, None)
    assert not said.good
    assert said.text.endswith("(a torus), not judged yet")
