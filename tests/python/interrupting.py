# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs stopped at random moments, by Ctrl-C and by progress callbacks that raise.

    python tests/python/interrupting.py --count 1000 --seed 1
    python tests/python/interrupting.py --count 50 --only solver large_solver

Says how long after the signal each came back, whether memory grew, and whether runs that
are not stopped still find the same bytes.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import gc
import os
import random
import signal
import statistics
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import remanifold as rm
from remanifold import datasets

Run = Callable[..., Any]


def noisy_torus(count: int, noise: float) -> np.ndarray:
    points = datasets.torus(count, random_state=0)
    return datasets.add_noise(points, noise, random_state=1)


def reconstructing(points: np.ndarray, dim: int, **options: Any) -> Run:
    return lambda **more: rm.reconstruct(points, dim, **options, **more).simplices


def of_products(points: np.ndarray, dim: int) -> Run:
    gram = points @ points.T
    return lambda **more: rm.reconstruct(gram=gram, dim=dim, **more).simplices


def topology(count: int) -> Run:
    """Betti numbers of a complex of dimension 3, which GUDHI computes."""
    rec = rm.reconstruct(datasets.flat_torus(count, dim=3, random_state=0), 3)
    cells = np.array(rec.simplices)

    def run(**more: Any) -> np.ndarray:
        found = rm.compute_topology(cells, count, **more)
        return np.array(found.betti_numbers)

    return run


# Small ones of some hundredths of a second, and those of a second or so.
SMALL: dict[str, Callable[[], Run]] = {
    "curve": lambda: reconstructing(datasets.circle(200, random_state=0), 1),
    "surface": lambda: reconstructing(datasets.torus(1000, random_state=0), 2),
    "products": lambda: of_products(datasets.sphere(300, random_state=0), 2),
    "solver": lambda: reconstructing(noisy_torus(600, 0.06), 2, smooth=False),
    "smoothing": lambda: reconstructing(noisy_torus(1500, 0.05), 2, smooth=True),
    "three-torus": lambda: reconstructing(
        datasets.flat_torus(400, dim=3, random_state=0), 3
    ),
    "four-sphere": lambda: reconstructing(
        datasets.sphere(80, dim=4, random_state=0), 4
    ),
    "paper": lambda: reconstructing(
        datasets.torus(1000, random_state=0), 2, method="paper"
    ),
    "many coordinates": lambda: reconstructing(
        datasets.embed(datasets.torus(800, random_state=0), 300, random_state=0), 2
    ),
    "approximate": lambda: reconstructing(
        datasets.torus(2000, random_state=0), 2, search="approximate"
    ),
    "topology": lambda: topology(300),
}
LARGE: dict[str, Callable[[], Run]] = {
    "large surface": lambda: reconstructing(datasets.torus(60_000, random_state=0), 2),
    "large solver": lambda: reconstructing(noisy_torus(3000, 0.12), 2, smooth=False),
    "large smoothing": lambda: reconstructing(
        noisy_torus(20_000, 0.05), 2, smooth=True
    ),
    "large three-torus": lambda: reconstructing(
        datasets.flat_torus(2500, dim=3, random_state=0), 3
    ),
    "large four-sphere": lambda: reconstructing(
        datasets.sphere(300, dim=4, random_state=0), 4
    ),
    "large approximate": lambda: reconstructing(
        datasets.torus(60_000, random_state=0), 2, search="approximate"
    ),
    "large topology": lambda: topology(2500),
}


class Stopped(Exception):
    """Raised by a callback."""


@dataclasses.dataclass
class Tally:
    """What became of the runs."""

    stopped: int = 0
    ended: int = 0  # before the moment came
    seconds: list[float] = dataclasses.field(default_factory=list)
    slowest: dict[str, float] = dataclasses.field(default_factory=dict)
    other_bytes: list[str] = dataclasses.field(default_factory=list)

    def stop(self, name: str, seconds: float) -> None:
        self.stopped += 1
        self.seconds.append(seconds)
        self.slowest[name] = max(seconds, self.slowest.get(name, 0.0))


def resident() -> int:
    """Bytes of this process that are in memory."""
    fields = Path("/proc/self/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGE_SIZE")


def interrupted(run: Run, after: float, **options: Any) -> float | None:
    """Ctrl-C after so many seconds: how long the run took from there; None if it ended."""
    sent: list[float] = []

    def send() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    came = None
    try:
        timer.start()
        run(**options)
        ended = True
        timer.cancel()
        timer.join()
        # Sent, and not looked at yet.
        for _ in range(100 if sent else 0):
            time.sleep(0.001)
    except KeyboardInterrupt:
        came = time.perf_counter()
        ended = False
    timer.join()
    return None if ended or came is None else came - sent[0]


def raised(run: Run, after: float, **options: Any) -> float | None:
    """The same by a callback."""
    start = time.perf_counter()
    when: list[float] = []

    def progress(*_: object) -> None:
        if time.perf_counter() - start > after:
            when.append(time.perf_counter())
            raise Stopped

    try:
        run(progress=progress, **options)
    except Stopped:
        return time.perf_counter() - when[0]
    return None


def stop_many(names: list[str], count: int, seed: int) -> tuple[Tally, int]:
    """Stop runs at random moments; the tally, and by how many bytes memory grew."""
    chance = random.Random(seed)
    cases = {**SMALL, **LARGE}
    tally = Tally()
    runs, expected, lasting = {}, {}, {}
    for name in names:
        runs[name] = cases[name]()
        expected[name] = runs[name]().tobytes()
        start = time.perf_counter()
        runs[name]()
        lasting[name] = time.perf_counter() - start
    before = 0
    warm = count // 3
    for i in range(count):
        if i == warm:
            gc.collect()
            before = resident()
        name = names[i % len(names)]
        stop = chance.choice([interrupted, raised])
        options = {"num_threads": chance.choice([1, 2, None])}
        seconds = stop(runs[name], chance.uniform(0, 1.1) * lasting[name], **options)
        if seconds is None:
            tally.ended += 1
        else:
            tally.stop(name, seconds)
        if chance.random() < 0.1 and runs[name]().tobytes() != expected[name]:
            tally.other_bytes.append(name)
    gc.collect()
    return tally, resident() - before


def main() -> None:
    """Stop as many as asked for, and say what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", choices=[*SMALL, *LARGE])
    arguments = parser.parse_args()
    with contextlib.ExitStack() as stack:
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        names = arguments.only or [*SMALL, *LARGE]
        tally, growth = stop_many(names, arguments.count, arguments.seed)
    ordered = sorted(tally.seconds)
    print(f"{tally.stopped} stopped, {tally.ended} had ended before")
    if ordered:
        print(
            f"seconds until they came back: median {statistics.median(ordered):.3f}, "
            f"99 in 100 within {ordered[int(0.99 * (len(ordered) - 1))]:.3f}, "
            f"slowest {ordered[-1]:.3f}"
        )
    for name, seconds in sorted(tally.slowest.items(), key=lambda item: -item[1]):
        print(f"  {seconds:6.3f}  {name}")
    print(f"memory grew by {growth / 2**20:.1f} MiB after the first third")
    print(f"other bytes afterwards: {tally.other_bytes or 'never'}")


if __name__ == "__main__":
    main()
