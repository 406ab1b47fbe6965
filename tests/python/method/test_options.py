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
    *("num_threads", "max_memory", "max_seconds", "progress"),
}


def test_reconstruct_takes_each_option_with_its_default():
    parameters = inspect.signature(rm.reconstruct).parameters
    given = {name: p.default for name, p in parameters.items() if name not in SAMPLES}
    assert given == FIELDS


def test_the_command_line_has_each_option():
    said = CliRunner().invoke(app, ["reconstruct", "--help"], env={"COLUMNS": "200"})
    shown = set(re.findall(r"--([a-z-]+)", said.output))
    expected = {name.replace("_", "-") for name in FIELDS}
    assert expected <= shown


def test_scikit_learn_has_each_option():
    estimator = pytest.importorskip("remanifold.sklearn").ManifoldReconstruction
    names = set(inspect.signature(estimator).parameters)
    parameters = inspect.signature(estimator).parameters
    given = {n: p.default for n, p in parameters.items() if n in FIELDS}
    assert given == FIELDS
    assert {"dim", "num_threads"} <= names


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


def test_choices_are_literals():
    """Of everything public: a word among few is typed as one of these words."""
    plain = {
        *("path", "title", "command", "format", "comment", "columns", "label", "name"),
        *("color", "fields", "dim", "screenshot"),
    }
    public = [getattr(rm, name) for name in rm.__all__]
    methods = [
        method
        for kind in (rm.SimplicialComplex, rm.Reconstruction)
        for _, method in inspect.getmembers(kind, inspect.isfunction)
    ]
    for function in (*filter(inspect.isfunction, public), *methods):
        if function.__name__.startswith("_"):
            continue
        for name, parameter in inspect.signature(function).parameters.items():
            if isinstance(parameter.default, str) and parameter.default:
                words = str(parameter.annotation).replace("typing.", "")
                wide = re.search(r"\bstr\b", words)
                assert not wide or name in plain, (function, name)


@pytest.mark.parametrize(
    ("count", "cores", "meant"),
    [(None, 8, 0), (1, 8, 1), (5, 8, 5), (-1, 8, 0), (-2, 8, 7), (-9, 8, 1)],
)
def test_threads_are_counted_as_in_scikit_learn(count, cores, meant, monkeypatch):
    from remanifold._base.validation import check_num_threads

    monkeypatch.setattr("os.cpu_count", lambda: cores)
    assert check_num_threads(count) == meant


def test_all_cores_give_the_same():
    points = rm.datasets.torus(200, random_state=0)
    one = rm.reconstruct(points, 2, num_threads=1)
    for count in (-1, -2, None):
        found = rm.reconstruct(points, 2, num_threads=count)
        assert found.digest == one.digest
    with pytest.raises(ValueError, match="num_threads is 0, expected at least 1"):
        rm.reconstruct(points, 2, num_threads=0)


@pytest.mark.parametrize("name", ["io", "interoperability", "datasets", "warnings"])
def test_modules_show_their_interface_only(name):
    import importlib

    module = importlib.import_module(f"remanifold.{name}")
    shown = {word for word in dir(module) if not word.startswith("_")}
    assert shown == {*module.__all__}
    assert {word for word in dir(rm) if not word.startswith("_")} == {*rm.__all__} - {
        "__version__"
    }


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
