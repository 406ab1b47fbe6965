# SPDX-License-Identifier: GPL-3.0-or-later
"""What a reconstruction is expected to take, and what does not fit is not begun."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import pytest

import remanifold as rm
from remanifold import _core
from remanifold.method import deadline
from remanifold.method.forecast import expected_bytes, expected_seconds

TORUS = rm.datasets.torus(2000, random_state=0)


def test_expected_memory_grows_with_samples_and_coordinates():
    low, high = expected_bytes(10**6, 3, 2)
    assert low == 10**6 * (200 + 20 * 3)
    assert high > low
    assert expected_bytes(1000, 9, 3) > expected_bytes(1000, 9, 2)
    assert expected_bytes(1000, 9, 5) is None
    assert expected_bytes(1000, 0, 2, products=True)[0] > 8 * 1000**2
    assert expected_bytes(10**6, 9, 2)[1] < expected_bytes(10**6, 8, 2)[1] + 3e8 + 60e6


def test_expected_time_is_linear_in_the_samples_and_asks_for_a_patch_only():
    sizes = []

    def reconstruct(points, dim):
        sizes.append((len(points), dim))

    points = rm.datasets.torus(50_000, random_state=0)
    assert expected_seconds(points, 2, reconstruct) >= 0
    assert sizes == [(1000, 2), (4000, 2)]
    assert expected_seconds(points, 9, reconstruct) is None
    one = expected_seconds(points, 2, lambda *_: burn(), 4000)
    ten = expected_seconds(points, 2, lambda *_: burn(), 40_000)
    assert ten == pytest.approx(10 * one, rel=0.5)


def burn():
    end = time.process_time() + 0.3
    while time.process_time() < end:
        pass


def test_a_patch_that_cannot_be_reconstructed():
    def reconstruct(*_):
        msg = "too few"
        raise ValueError(msg)

    assert expected_seconds(TORUS, 2, reconstruct) is None


@pytest.mark.parametrize(
    ("dim", "make"),
    [
        (1, lambda: rm.datasets.circle(20_000, random_state=0)),
        (2, lambda: rm.datasets.torus(10_000, random_state=0)),
        (3, lambda: rm.datasets.sphere(2000, dim=3, random_state=0)),
        (3, lambda: np.random.default_rng(0).random((1500, 3))),
        (4, lambda: rm.datasets.sphere(500, dim=4, random_state=0)),
    ],
)
def test_it_takes_what_was_said(dim, make):
    points = make()
    of_samples = rm.forecast(points, dim=dim)
    of_number = rm.forecast(*points.shape, dim)
    start = time.process_time()
    rm.reconstruct(points, dim, num_threads=1)
    seconds = time.process_time() - start
    for found in (of_samples, of_number):
        assert (found.num_samples, found.dim) == (len(points), dim)
        low, high = found.seconds_between
        assert low < found.seconds < high
        # A test has half of a processor at times.
        assert low / 2 < seconds < 2 * high
        assert found.bytes_between[0] < found.bytes < found.bytes_between[1]


def test_products_and_distances():
    points = TORUS[:300]
    gram = points @ points.T
    found = rm.forecast(gram=(gram + gram.T) / 2, dim=2)
    assert found.ambient_dim == 0
    assert found.bytes > 8 * 300**2
    assert found.seconds > 0


def test_many_dimensions_have_no_figures():
    found = rm.forecast(100, 9, 9)
    assert np.isnan(found.seconds)
    assert np.isnan(found.bytes)
    assert repr(found) == "Forecast(samples=100, dim=9)"
    assert "samples" in found._repr_html_()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((100, None, 2), "ambient_dim is needed"),
        ((100, 2, 3), "dim is 3, more than ambient_dim, 2"),
        ((0, 2, 1), "points is 0, expected at least 1"),
        ((TORUS, None, 4), "dim is 4, more than the 3 coordinates"),
    ],
)
def test_what_cannot_be_forecast(arguments, message):
    with pytest.raises(ValueError, match=message):
        rm.forecast(*arguments)


def test_what_does_not_fit_is_not_begun(monkeypatch):
    begun = []
    real = _core.reconstruct
    monkeypatch.setattr(
        _core, "reconstruct", lambda *a, **k: begun.append(1) or real(*a, **k)
    )
    with pytest.raises(MemoryError, match=r"max_memory is 0\.1 MB, and 2,000 samples"):
        rm.reconstruct(TORUS, 2, max_memory=1e5)
    assert not begun
    rec = rm.reconstruct(TORUS, 2, max_memory=1e8)
    assert begun
    np.testing.assert_array_equal(rec.simplices, rm.reconstruct(TORUS, 2).simplices)
    gram = TORUS @ TORUS.T
    with pytest.raises(MemoryError, match="dim=2 take about"):
        rm.reconstruct(gram=(gram + gram.T) / 2, dim=2, max_memory=1e7)
    with pytest.raises(ValueError, match="max_memory"):
        rm.reconstruct(TORUS, 2, max_memory=-1)


def scattered(count=1500):
    """Noise of a spacing, which takes many programs when it is not smoothed."""
    points = rm.datasets.torus(count, random_state=0)
    near = np.median(rm.neighborhoods(points, 1).distances)
    return rm.datasets.add_noise(points, near, random_state=1)


def test_what_is_out_of_time_is_open_and_said(monkeypatch):
    """Time is over with the third program."""
    asked = []
    monkeypatch.setattr(
        deadline.Deadline, "is_over", lambda _: asked.append(1) or len(asked) > 30
    )
    with pytest.warns(rm.ManifoldWarning, match="for which there was no time"):
        rec = rm.reconstruct(scattered(), 2, smooth=False, max_seconds=100)
    assert rec.repair.num_out_of_time > 0
    assert rec.topology().manifold
    assert len(rec.repair.open_faces) > 0
    assert "max_seconds were over" in str(rec.quality)
    assert rec.check().ok
    whole = rm.reconstruct(scattered(), 2, smooth=False)
    assert len(rec.simplices) < len(whole.simplices)


def test_time_that_does_changes_nothing():
    rec = rm.reconstruct(TORUS, 2, max_seconds=100)
    assert rec.repair.num_out_of_time == 0
    np.testing.assert_array_equal(rec.simplices, rm.reconstruct(TORUS, 2).simplices)


def test_time_that_cannot_do_is_an_error(monkeypatch):
    with pytest.raises(TimeoutError, match="max_seconds is 1e-09, which was over in"):
        rm.reconstruct(rm.datasets.torus(60_000, random_state=0), 2, max_seconds=1e-9)
    with pytest.raises(ValueError, match="max_seconds"):
        rm.reconstruct(TORUS, 2, max_seconds=0)
    many = rm.datasets.torus(100_000, random_state=0)
    begun = []
    real = _core.reconstruct
    monkeypatch.setattr(
        _core,
        "reconstruct",
        lambda s, *a, **k: begun.append(len(s)) or real(s, *a, **k),
    )
    with pytest.raises(TimeoutError, match="100,000 samples with dim=2 take"):
        rm.reconstruct(many, 2, max_seconds=1e-3)
    assert max(begun) < 10_000  # a patch


LIMITED = """
import resource, sys
import remanifold as rm
rm.reconstruct(rm.datasets.torus(500, random_state=0), 2, num_threads=1).topology()
with open("/proc/self/statm") as file:
    size = int(file.read().split()[0]) * resource.getpagesize()
room = int(sys.argv[1])
points = rm.datasets.torus(int(sys.argv[2]), random_state=0)
resource.setrlimit(resource.RLIMIT_AS, (size + points.nbytes + room,) * 2)
try:
    rec = rm.reconstruct(points, 2, num_threads=1, max_memory=room)
except MemoryError as error:
    print("refused:", error)
else:
    print(len(rec.simplices))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("room", "number"), [(2 * 10**7, 400_000), (10**8, 50_000)])
def test_under_a_limit_of_the_system(room, number):
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(room), str(number)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    if number > 10**5:
        assert done.stdout.startswith(
            "refused: max_memory is 20 MB, and 400,000 samples"
        )
    else:
        assert int(done.stdout) > 90_000
