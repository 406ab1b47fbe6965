# SPDX-License-Identifier: GPL-3.0-or-later
"""The soak: cases that can be drawn again, outcomes that are told apart, a corpus."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))  # the processes of the runs import it as well

import families
import openings
import soak
from processes import Failure

pytestmark = pytest.mark.slow


def run(*arguments):
    done = subprocess.run(
        [sys.executable, BENCHMARKS / "soak.py", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_there_are_families_of_all_dimensions():
    dims = [
        families.FAMILIES[name](np.random.default_rng(0), "random").dim
        for name in families.FAMILIES
    ]
    assert len(dims) >= 60
    assert all(dims.count(dim) >= 5 for dim in (1, 2, 3, 4))


def test_a_case_is_drawn_again_from_its_family_and_seed():
    conditions = set()
    for name in ("circle", "gap: arc", "square", "lattice of dimension 2"):
        for seed in range(12):
            one, other = (soak.draw(soak.Case(name, seed)) for _ in range(2))
            assert one.conditions == other.conditions
            for key, array in one.samples.items():
                np.testing.assert_array_equal(array, other.samples[key])
            conditions |= {word.split()[0] for word in one.conditions.split(", ")}
    expected = {"random", "even", "graded", "noise", "clutter", "copies", "in"}
    assert expected <= conditions
    assert {"float32", "gram", "distances"} & conditions


def test_right_and_wrong_are_told_apart(monkeypatch):
    case = soak.Case("circle", 3)
    limit = resource.getrlimit(resource.RLIMIT_CPU)
    right = soak.attempt(case)
    # Only a process of its own may be ended: here it would be the one of the tests.
    assert resource.getrlimit(resource.RLIMIT_CPU) == limit
    assert right.outcome.startswith("right")
    assert right.said == right.broken == ()
    circle = families.FAMILIES["circle"]

    def taken_for_two(rng, kind):
        made = circle(rng, kind)
        both = families.together(families.LOOP, families.LOOP)
        return families.Family(made.name, made.points, both)

    monkeypatch.setitem(families.FAMILIES, "circle", taken_for_two)
    wrong = soak.attempt(case)
    assert wrong.outcome.startswith("wrong and")
    assert "components: 1, not 2" in wrong.said


@pytest.mark.parametrize(
    ("reason", "ending", "outcome"),
    [
        ("crashed: SIGXCPU", "crash", "late"),
        ("not done after 600 s", "timeout", "late"),
        ("crashed: SIGSEGV", "crash", "crash"),
        ("ValueError: no", "error", "crash"),
    ],
)
def test_what_gives_no_result(reason, ending, outcome):
    assert soak.failed(Failure(reason, ending)).outcome == outcome


def test_the_worst_are_kept_and_run_again(tmp_path):
    corpus = tmp_path / "worst.jsonl"
    bad = soak.failed(Failure("crashed: SIGXCPU", "crash"))
    kept = [(soak.Case("circle", 5), bad)]
    assert soak.write_corpus(corpus, kept) == 1
    good = soak.attempt(soak.Case("circle", 3))
    assert soak.write_corpus(corpus, [(soak.Case("circle", 3), good)]) == 1
    assert soak.read_corpus(corpus)[0]["seed"] == 5
    (row, last) = soak.table_of([*kept, (soak.Case("circle", 3), good)])
    assert row[:2] == ["circle", "2"]
    assert last[0] == "all"
    assert len(row) == len(soak.HEADS)
    again = run("--again", corpus, "--jobs", 1, "--markdown")
    assert "| circle | 1 |" in again.stdout


def test_command():
    done = run("--only", "circle", "--seed", 3)
    assert json.loads(done.stdout)["outcome"].startswith("right")
    assert "--only 'circle' --seed 3" in done.stderr


def test_the_corpus_of_the_project_can_be_drawn():
    held = soak.read_corpus(BENCHMARKS / "soak_corpus.jsonl")
    assert len(held) > 5
    for one in held:
        if one["conditions"]:
            drawn = soak.draw(soak.Case(one["family"], one["seed"]))
            assert drawn.conditions == one["conditions"]


def test_openings_draw_from_the_same_families():
    made = openings.family(3)
    assert made.name.partition(",")[0] in families.OPENINGS
    assert made.dim in (1, 2, 3)
