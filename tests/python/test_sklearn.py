# SPDX-License-Identifier: GPL-3.0-or-later
"""The scikit-learn estimator."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import remanifold as rm

pytest.importorskip("sklearn")

from sklearn.base import clone
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from remanifold.sklearn import ManifoldReconstruction


@parametrize_with_checks(
    [ManifoldReconstruction(), ManifoldReconstruction(n_components=1)]
)
# The checks fit Gaussian clouds: no manifolds, and uncertain dimensions.
@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
@pytest.mark.filterwarnings("ignore::remanifold.DimensionWarning")
@pytest.mark.filterwarnings("ignore::sklearn.exceptions.SkipTestWarning")
def test_contract_of_scikit_learn(estimator, check):
    check(estimator)
