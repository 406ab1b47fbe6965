# SPDX-License-Identifier: GPL-3.0-or-later
"""Options have one list, which the library, the command line and the core share."""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import get_args

import numpy as np
import pytest
from typer.testing import CliRunner

import remanifold as rm
from remanifold import _core
from remanifold._base.samples import INPUTS
from remanifold.cli import app
from remanifold.method import options as module
from remanifold.method.options import Options

FIELDS = {field.name: field.default for field in dataclasses.fields(Options)}
# What reconstruct takes besides options.
SAMPLES = {
    *("points", "dim", "gram", "distances", "attributes", "invalid"),
    *("num_threads", "progress"),
}


def test_reconstruct_takes_each_option_with_its_default():
    parameters = inspect.signature(rm.reconstruct).parameters
    given = {name: p.default for name, p in parameters.items() if name not in SAMPLES}
    assert given == FIELDS


def test_the_command_line_has_each_option():
    said = CliRunner().invoke(app, ["reconstruct", "--help"], env={"COLUMNS": "200"})
    shown = set(re.findall(r"--([a-z-]+)", said.output))
    expected = {name.replace("_", "-") for name in FIELDS} - {"checks"}
    assert expected <= shown


def test_scikit_learn_has_each_option():
    estimator = pytest.importorskip("remanifold.sklearn").ManifoldReconstruction
    names = set(inspect.signature(estimator).parameters)
    renamed = {"estimator": "tangent_estimator"}
    # What is there for the paper's method only, and how to search.
    left_out = {"edges", "search", "checks"}
    assert {renamed.get(n, n) for n in FIELDS if n not in left_out} <= names


@pytest.mark.parametrize(
    ("words", "type_"),
    [
        (_core.ESTIMATORS, module.Estimator),
        (_core.EDGE_RULES, module.EdgeRule),
        (_core.SEARCHES, module.Search),
        (_core.KINDS, None),
    ],
)
def test_words_are_those_of_the_core(words, type_):
    expected = [kind.kind for kind in INPUTS] if type_ is None else get_args(type_)
    assert set(words) == set(expected)


def test_exact_searches_are_searches():
    assert set(module.EXACT_SEARCHES) == set(module.SEARCHES) - {"approximate"}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"method": "other"}, "method is 'other', expected one of"),
        ({"estimator": "best"}, "estimator is 'best', expected one of"),
        ({"method": "paper", "edges": "all"}, "edges is 'all', expected one of"),
        ({"edges": "mutual"}, 'edges is for method="paper" only'),
        ({"method": "paper", "hole_radius": 2.0}, 'hole_radius is for method="man'),
        ({"method": "paper", "boundary": False}, 'boundary is for method="manifold"'),
        ({"method": "paper", "boundary": np.ones(3, bool)}, "boundary is for method="),
        ({"search": "fast"}, "search is 'fast', expected one of"),
        ({"checks": 0}, "checks is 0, expected at least 1"),
        ({"hole_radius": -1.0}, "hole_radius is -1.0, expected a positive"),
        ({"outliers": -1.0}, "outliers is -1.0, expected a positive"),
        ({"smooth": "much"}, "smooth is 'much', expected"),
    ],
)
def test_refused_without_samples(given, said):
    """In words that begin with the parameter: the command line goes by that."""
    with pytest.raises(ValueError, match=r".") as caught:
        Options(**given)
    assert str(caught.value).startswith(said)


def test_neighbors_come_from_the_core():
    for dim in range(1, 6):
        assert Options().neighbors(dim) == 3 * (dim + dim * (dim + 1) // 2)
        assert Options(method="paper").neighbors(dim) == 10 * dim


def test_what_depends_on_the_dimension_is_refused_later():
    with pytest.raises(ValueError, match="num_neighbors is 2, expected at least 3"):
        Options(num_neighbors=2).check_dim(2)
    with pytest.raises(ValueError, match="smooth is 2, expected at least 3"):
        Options(smooth=2).check_dim(2)
