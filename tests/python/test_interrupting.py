# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are stopped anywhere leave nothing behind; `interrupting.py` stops thousands."""

from __future__ import annotations

import sys

import pytest

from interrupting import SMALL, stop_many
from test_running import PROMPTLY

pytestmark = pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")

NAMES = ["curve", "surface", "products", "solver", "smoothing", "four-sphere"]


@pytest.mark.skipif(sys.platform != "linux", reason="memory as Linux counts it")
def test_stopped_at_random_moments():
    tally, growth = stop_many(NAMES, 30, seed=1)
    assert tally.stopped >= 5
    assert tally.stopped + tally.ended == 30
    assert max(tally.seconds) < PROMPTLY
    assert tally.other_bytes == []
    assert growth < 64 * 2**20
    assert set(NAMES) <= set(SMALL)
