# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstructions are what they were, at one thread and at two."""

from __future__ import annotations

import pytest

import digests

RECORDED = digests.recorded()


def test_every_case_is_recorded():
    assert set(RECORDED) == set(digests.CASES)
    assert len(RECORDED) >= 60


@pytest.mark.parametrize("name", digests.CASES)
def test_results_keep_their_bytes(name):
    try:
        now = [digests.summary(digests.CASES[name](threads)) for threads in (1, 2)]
    except digests.Absent as absent:
        pytest.skip(f"{absent} is absent")
    assert digests.difference(name, now[1], RECORDED[name]) == []
    assert now[0] == now[1]
