# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads, progress and interruption: what a run does besides its result."""

import dataclasses
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold.method.options import METHODS

pytestmark = pytest.mark.slow

STEPS = [
    *("prepare", "neighborhoods", "outliers", "smoothing", "tangent_spaces"),
    *("local_regions", "complex"),
]
PROMPTLY = 5.0  # seconds, though a tenth is usual: the machine may be busy


def sphere(num, dim, ambient, seed=0):
    points = np.random.default_rng(seed).normal(size=(num, dim + 1))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return np.pad(points, [(0, 0), (0, ambient - dim - 1)])


# --- The number of threads ------------------------------------------------------

KINDS = {
    "curve": (1, sphere(1500, 1, 3)),
    "surface": (2, sphere(1500, 2, 3)),
    "solid": (3, np.random.default_rng(0).uniform(size=(700, 3))),
    "dim4": (4, sphere(200, 4, 5)),
    "in_R60": (2, sphere(1500, 2, 60)),
}


def steps_of_points(dim, points):
    rec = rm.reconstruct(points, dim, method="paper")
    frames, sets = (points, rec.tangents), rec.edge_sets
    return {
        "neighborhoods": lambda **o: rm.neighborhoods(points, 15, **o),
        "approximate": lambda **o: rm.neighborhoods(
            points, 5, search="approximate", checks=10**6, **o
        ),
        "enclosure": lambda **o: rm.tangent_spaces(points, dim, **o),
        "pca": lambda **o: rm.tangent_spaces(points, dim, estimator="pca", **o),
        "jet": lambda **o: rm.tangent_spaces(points, dim, estimator="jet", **o),
        "regions": lambda **o: rm.local_regions(*frames, rec.boundary, **o),
        "edge_sets": lambda **o: rm.edge_sets(*frames, **o),
        "mutual": lambda **o: rm.clique_complex(*sets, dim, **o),
        "either": lambda **o: rm.clique_complex(*sets, dim, "either", **o),
        "topology": lambda **o: rm.compute_topology(rec.simplices, len(points), **o),
        "manifold": lambda **o: rm.reconstruct(points, dim, **o),
        "paper": lambda **o: rm.reconstruct(points, dim, method="paper", **o),
    }


def steps_of_products(dim, points):
    points = points[: 600 // dim]
    gram = {"gram": points @ points.T}
    distances = {"distances": cdist(points, points)}
    return {
        "neighborhoods": lambda **o: rm.neighborhoods(**gram, num_neighbors=9, **o),
        "enclosure": lambda **o: rm.tangent_spaces(**gram, dim=dim, **o),
        "gram": lambda **o: rm.reconstruct(**gram, dim=dim, **o),
        "distances": lambda **o: rm.reconstruct(**distances, dim=dim, **o),
        "paper": lambda **o: rm.reconstruct(**gram, dim=dim, method="paper", **o),
    }


def as_bytes(result):
    """All that the result holds but when, how and in how many seconds it was found."""
    if isinstance(result, np.ndarray):
        return f"{result.dtype}{result.shape}".encode() + result.tobytes()
    if dataclasses.is_dataclass(result):
        left_out = ("timings", "provenance")
        result = [value for name, value in vars(result).items() if name not in left_out]
    if isinstance(result, dict):
        result = [*result.keys(), *result.values()]
    if isinstance(result, list | tuple):
        return b"".join(map(as_bytes, result))
    return repr(result).encode()


@pytest.mark.parametrize(
    ("steps", "kind"),
    [
        *((steps_of_points, kind) for kind in KINDS),
        *((steps_of_products, kind) for kind in ("surface", "solid")),
    ],
)
def test_threads_change_no_byte(steps, kind):
    for name, step in steps(*KINDS[kind]).items():
        expected = as_bytes(step(num_threads=1))
        assert len(expected) > 1000, name
        for num_threads in (2, 5, None):
            assert as_bytes(step(num_threads=num_threads)) == expected, name


def test_concurrent_calls_do_not_meet():
    calls = [
        *steps_of_products(*KINDS["surface"]).values(),
        *(
            step
            for kind in ("surface", "in_R60")
            for step in steps_of_points(*KINDS[kind]).values()
        ),
    ]
    options = [{"num_threads": 1 + i % 3} for i in range(len(calls))]
    expected = [as_bytes(call()) for call in calls]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda call, o: as_bytes(call(**o)), calls, options))
    assert found == expected


# --- Progress -------------------------------------------------------------------


@cache
def large():
    points = rm.datasets.torus(100_000, random_state=0)
    return points, {m: rm.reconstruct(points, 2, method=m) for m in METHODS}


@cache
def frames():
    return large()[0], large()[1]["paper"].tangents


@cache
def dense_graph():
    linked = np.triu(np.random.default_rng(0).uniform(size=(2500, 2500)) < 0.08, 1)
    linked |= linked.T
    return np.cumsum([0, *linked.sum(axis=1)]), np.nonzero(linked)[1]


# Runs of some tenths of a second.
RUNS = {
    "neighborhoods": lambda **o: rm.neighborhoods(large()[0], 20, **o),
    "tangent_spaces": lambda **o: rm.tangent_spaces(large()[0], 2, **o),
    "local_regions": lambda **o: rm.local_regions(*frames(), **o),
    "edge_sets": lambda **o: rm.edge_sets(*frames(), **o),
    "clique_complex": lambda **o: rm.clique_complex(*dense_graph(), 3, **o),
    "compute_topology": lambda **o: rm.compute_topology(
        large()[1]["paper"].simplices, 100_000, **o
    ),
    "manifold": lambda **o: rm.reconstruct(large()[0], 2, **o),
    "paper": lambda **o: rm.reconstruct(large()[0], 2, method="paper", **o),
}
ALSO_CALLED = {
    "edge_sets": "local_regions",
    "clique_complex": "complex",
    "compute_topology": "topology",
    "manifold": "complex",
    "paper": "local_regions",
}


@pytest.mark.parametrize("name", RUNS)
def test_progress_counts_steps_in_order(name):
    calls, threads = [], set()

    def progress(*call):
        calls.append(call)
        threads.add(threading.get_ident())

    RUNS[name](progress=progress, num_threads=1)
    assert threads == {threading.get_ident()}
    assert {tuple(map(type, call)) for call in calls} == {(str, int, int)}
    for step, done, total in calls:
        assert 0 <= done <= total, step
    # No step comes back, though a short one may pass unseen.
    seen = list(dict.fromkeys(step for step, *_ in calls))
    assert ALSO_CALLED.get(name, name) in seen
    assert [step for step in [*STEPS, "topology"] if step in seen] == seen
    order = [(seen.index(step), done) for step, done, _ in calls]
    assert order == sorted(order)
    assert name in ("clique_complex", *METHODS) or "complex" not in seen


@pytest.mark.parametrize("method", METHODS)
def test_progress_changes_nothing(method):
    found = RUNS[method](progress=lambda *_: None)
    assert as_bytes(found) == as_bytes(large()[1][method])


@pytest.mark.parametrize("progress", [None, False, True])
def test_a_bar_goes_to_standard_error(progress, capfd):
    RUNS["neighborhoods"](progress=progress)
    assert capfd.readouterr().out == ""


class Stop(Exception):
    """Raised by a callback."""


@pytest.mark.parametrize(
    ("name", "error"),
    [
        *((name, Stop("enough")) for name in RUNS),
        ("neighborhoods", KeyboardInterrupt()),
        ("manifold", SystemExit(3)),
        ("paper", SystemExit(3)),
    ],
)
def test_errors_of_the_callback_come_out(name, error):
    def progress(*_):
        raise error

    with pytest.raises(type(error)) as caught:
        RUNS[name](progress=progress, num_threads=1)
    assert caught.value is error


# --- Interruption ---------------------------------------------------------------


@cache
def many_neighbors():
    points = np.random.default_rng(0).normal(size=(3000, 2))
    return lambda **o: rm.tangent_spaces(points, 2, 2900, **o)


@cache
def many_coordinates():
    points = np.random.default_rng(0).normal(size=(20_000, 1000))
    return lambda **o: rm.neighborhoods(points, 20, **o)


@cache
def many_products():
    points = sphere(600, 5, 6)
    gram = points @ points.T
    arguments = {"gram": gram, "dim": 5, "method": "paper", "num_neighbors": 300}
    return lambda **o: rm.reconstruct(**arguments, **o)


@cache
def dim_6():
    points = sphere(1000, 6, 7)
    return lambda **o: rm.reconstruct(points, 6, method="paper", **o)


@cache
def regions_of_dim_6():
    points = sphere(1000, 6, 7)
    tangents = rm.tangent_spaces(points, 6, estimator="pca")
    return lambda **o: rm.local_regions(points, tangents.bases, **o)


@cache
def long_regions_of_dim_6():
    rng = np.random.default_rng(0)
    frames = np.linalg.qr(rng.normal(size=(300, 20, 6)))[0].transpose(0, 2, 1)
    points = rng.normal(size=(300, 20))
    return lambda **o: rm.local_regions(points, frames, **o)


@cache
def search_without_cliques():
    parts, size = 8, 20
    part = np.arange(parts * size) // size
    linked = part[:, None] != part
    offsets = np.cumsum([0, *linked.sum(axis=1)])
    return lambda **o: rm.clique_complex(offsets, np.nonzero(linked)[1], parts, **o)


# Each takes far longer than PROMPTLY on one thread.
LONG_RUNS = [
    many_neighbors,
    many_coordinates,
    many_products,
    dim_6,
    regions_of_dim_6,
    long_regions_of_dim_6,
    search_without_cliques,
]


def seconds_of_work(pause):
    """Of the least of some pauses: what is about to end takes a moment."""
    seconds = []
    for _ in range(4):
        before = time.process_time()
        time.sleep(pause)
        seconds.append(time.process_time() - before)
        if seconds[-1] < pause / 2:
            break
    return min(seconds)


@pytest.mark.parametrize("make", LONG_RUNS)
def test_an_error_of_the_callback_stops_the_run(make):
    run = make()
    raised = []

    def progress(*_):
        if time.perf_counter() - start > 0.3:
            raised.append(time.perf_counter())
            raise Stop

    start = time.perf_counter()
    with pytest.raises(Stop):
        run(progress=progress, num_threads=1)
    assert time.perf_counter() - raised[0] < PROMPTLY
    assert seconds_of_work(0.2) < 0.1  # nothing goes on behind


@pytest.fixture(params=["raise_signal", "kill"])
def interrupt(request):
    """A timer that sends Ctrl-C from another thread, and when it did."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        if request.param == "kill":
            os.kill(os.getpid(), signal.SIGINT)
        else:
            signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.3, send)
    yield timer, sent
    timer.cancel()
    timer.join()


@pytest.mark.parametrize("make", LONG_RUNS)
def test_an_interrupt_stops_the_run(make, interrupt):
    run = make()
    timer, sent = interrupt
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        run(num_threads=1)
    assert time.perf_counter() - sent[0] < PROMPTLY
    assert seconds_of_work(0.2) < 0.1


def test_an_interrupt_ends_a_script():
    script = """
import numpy as np
import remanifold as rm
points = np.random.default_rng(0).normal(size=(3000, 2))
print("ready", flush=True)
rm.reconstruct(points, 2, method="paper", num_neighbors=2900, num_threads=1)
"""
    with subprocess.Popen(
        [sys.executable, "-c", script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        start = time.perf_counter()
        try:
            _, errors = process.communicate(timeout=60)
        finally:
            process.kill()
    assert time.perf_counter() - start < PROMPTLY
    assert process.returncode == -signal.SIGINT
    assert errors.rstrip().endswith("KeyboardInterrupt")


# --- Other threads --------------------------------------------------------------


@pytest.mark.parametrize("name", RUNS)
def test_other_threads_run_meanwhile(name):
    large()
    dense_graph()
    ended = threading.Event()
    ticks = []

    def tick():
        while not ended.wait(0.001):
            ticks.append(time.perf_counter())

    with ThreadPoolExecutor(1) as pool:
        pool.submit(tick)
        time.sleep(0.05)
        start = time.perf_counter()
        RUNS[name](num_threads=1)
        end = time.perf_counter()
        ended.set()
    within = [t for t in ticks if start < t < end]
    assert within
    # Nowhere is there a gap like the run.
    assert np.diff([start, *within, end]).max() < (end - start) / 2


def test_an_interrupt_is_for_the_main_thread():
    """A run of another thread goes on; the main thread gets the exception."""
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(RUNS["manifold"], num_threads=1)
        with pytest.raises(KeyboardInterrupt):  # noqa: PT012
            signal.raise_signal(signal.SIGINT)
            time.sleep(5)
        found = running.result(timeout=60)
    assert as_bytes(found) == as_bytes(large()[1]["manifold"])
