# SPDX-License-Identifier: GPL-3.0-or-later
"""The scikit-learn estimator."""

import pickle
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

import remanifold as rm
from remanifold.sklearn import ManifoldReconstruction

CHECKS = parametrize_with_checks(
    [ManifoldReconstruction(), ManifoldReconstruction(n_components=1)]
).mark


# Some versions of scikit-learn give a generator, which pytest is about to refuse.
@pytest.mark.slow
@pytest.mark.parametrize(CHECKS.args[0], [*CHECKS.args[1]], **CHECKS.kwargs)
# The checks fit Gaussian clouds: no manifolds, and uncertain dimensions.
@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
@pytest.mark.filterwarnings("ignore::remanifold.DimensionWarning")
@pytest.mark.filterwarnings("ignore::sklearn.exceptions.SkipTestWarning")
def test_contract_of_scikit_learn(estimator, check):
    check(estimator)


def torus(count=600, seed=0):
    return rm.datasets.torus(count, random_state=seed)


def test_transform_projects():
    samples = torus()
    model = ManifoldReconstruction(n_components=2).fit(samples)
    assert model.n_components_ == model.reconstruction_.dim == 2
    rec = rm.reconstruct(samples, 2)
    np.testing.assert_array_equal(model.reconstruction_.simplices, rec.simplices)
    points = samples + 0.1 * np.random.default_rng(0).normal(size=samples.shape)
    found = rec.project(points)
    moved = model.transform(points)
    np.testing.assert_array_equal(moved, found.points)
    assert moved.flags.writeable
    np.testing.assert_array_equal(model.score_samples(points), -(found.distances**2))
    assert model.score(points) == np.mean(-(found.distances**2))
    np.testing.assert_array_equal(model.transform(samples), samples)
    assert (model.score_samples(moved) > -1e-30).all()


def test_a_row_does_not_depend_on_the_others():
    model = ManifoldReconstruction(n_components=2, n_jobs=2).fit(torus())
    points = np.random.default_rng(1).normal(size=(60, 3))
    whole = model.transform(points)
    for start, size in ((0, 1), (7, 1), (11, 13), (59, 1)):
        rows = slice(start, start + size)
        np.testing.assert_array_equal(model.transform(points[rows]), whole[rows])
    np.testing.assert_array_equal(model.transform(points[::-1]), whole[::-1])


def test_auto_finds_the_dimension():
    model = ManifoldReconstruction().fit(torus())
    assert model.n_components_ == 2


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::remanifold.DimensionWarning")
def test_auto_goes_down_where_nothing_is_spanned():
    samples = np.random.default_rng(0).normal(size=(20, 10))
    # The first estimate has no simplices: nobody needs to hear of them.
    model = ManifoldReconstruction().fit(samples)
    assert rm.estimate_dimension(samples).dim > model.n_components_ > 0
    assert len(model.reconstruction_.simplices)


def test_smoothing_moves_the_samples():
    noisy = torus(1500) + 0.03 * np.random.default_rng(0).normal(size=(1500, 3))

    def error(points):
        around = np.hypot(points[:, 0], points[:, 1])
        return np.hypot(around - 1, points[:, 2]).std()

    plain = ManifoldReconstruction(n_components=2, outliers=False, smooth=False)
    plain.fit(noisy)
    smooth = clone(plain).set_params(smooth=True).fit(noisy)
    assert error(smooth.transform(noisy)) < 0.8 * error(plain.transform(noisy))


def test_pipelines_clones_and_pickles():
    samples = torus() * [1, 10, 100]
    pipeline = make_pipeline(StandardScaler(), ManifoldReconstruction(n_components=2))
    moved = pipeline.fit(samples).transform(samples)
    assert moved.shape == samples.shape
    fresh = clone(pipeline).set_params(manifoldreconstruction__n_components=2)
    np.testing.assert_array_equal(fresh.fit_transform(samples), moved)
    restored = pickle.loads(pickle.dumps(pipeline))
    np.testing.assert_array_equal(restored.transform(samples), moved)
    assert pipeline.score(samples) == restored.score(samples)


def test_names_of_the_features():
    frame = pd.DataFrame(torus(), columns=["x", "y", "z"])
    model = ManifoldReconstruction(n_components=2).set_output(transform="pandas")
    moved = model.fit(frame).transform(frame)
    assert list(moved.columns) == ["x", "y", "z"]
    assert model.feature_names_in_.tolist() == ["x", "y", "z"]


def test_names_of_features_without_names():
    model = ManifoldReconstruction(n_components=2).fit(torus())
    assert model.get_feature_names_out().tolist() == ["x0", "x1", "x2"]


@pytest.mark.parametrize(
    ("settings", "samples", "error", "message"),
    [
        ({"n_components": 4}, torus(50), ValueError, "dim is 4"),
        ({"n_components": 0}, torus(50), ValueError, "n_components is 0"),
        ({"n_components": "two"}, torus(50), TypeError, "n_components must be"),
        ({"n_components": 2}, torus(2), ValueError, "minimum of 3 is required"),
        ({}, torus(9), ValueError, "minimum of 10 is required"),
        (
            {"n_components": 2, "method": "best"},
            torus(50),
            ValueError,
            "method is 'best'",
        ),
    ],
)
def test_bad_settings_are_refused(settings, samples, error, message):
    with pytest.raises(error, match=message):
        ManifoldReconstruction(**settings).fit(samples)


@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
def test_samples_that_span_nothing_are_refused():
    with pytest.raises(ValueError, match="span no simplices"):
        ManifoldReconstruction(n_components=1).fit(np.ones((20, 3)))


def test_a_missing_package_is_named():
    script = (
        "import sys; sys.modules['sklearn'] = None\n"
        "try:\n    import remanifold.sklearn\n"
        "except ImportError as error:\n    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert "pip install remanifold[sklearn]" in done.stdout
