# SPDX-License-Identifier: GPL-3.0-or-later
"""What comes after a reconstruction: topology, report, nearest points, files.

    python benchmarks/after.py                           # a million samples of a torus
    python benchmarks/after.py --samples 10000000 --skip-report
    python benchmarks/after.py --directory /mnt/disk     # where files are written

All cores are used. Each line has seconds on the wall and seconds of processors. Beside files stand as many
bytes written as they are and brought to the disk, in the same directory and run.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import remanifold as rm
from command import make_app

CHUNK = 1 << 24
app = make_app()


def measure(name: str, do: Callable[[], Any]) -> Any:
    begin, used = time.perf_counter(), time.process_time()
    result = do()
    wall, cpu = time.perf_counter() - begin, time.process_time() - used
    print(f"| {name} | {wall:.2f} | {cpu:.2f} |", flush=True)
    return result


def write_raw(path: Path, size: int) -> None:
    """Write as many bytes that nothing can compress, up to the disk."""
    chunk = np.random.default_rng(0).bytes(CHUNK)
    with path.open("wb", buffering=0) as file:
        for begin in range(0, size, CHUNK):
            file.write(chunk[: min(CHUNK, size - begin)])
        os.fsync(file.fileno())


@app.command()
def main(
    samples: Annotated[int, typer.Option(min=100)] = 1_000_000,
    queries: Annotated[int, typer.Option(min=1, help="Points to project.")] = 1_000_000,
    skip_report: Annotated[bool, typer.Option(help="No `quality`.")] = False,
    directory: Annotated[
        Path | None, typer.Option(file_okay=False, help="For the files.")
    ] = None,
) -> None:
    """Print the table."""
    points = rm.datasets.torus(samples, random_state=0)
    rm.reconstruct(points[:2000], 2)  # loads what is loaded once
    print("| step | wall, s | CPU, s |\n|---|---:|---:|")
    rec = measure("reconstruct", lambda: rm.reconstruct(points, 2))
    topology = measure("topology", lambda: rec.topology())
    if topology.betti_numbers != (1, 2, 1) or not topology.manifold:
        raise SystemExit(f"not a torus: {topology}")
    if not skip_report:
        measure("quality, with the topology known", lambda: rec.quality)
    random = np.random.default_rng(1)
    asked = points[random.integers(0, samples, queries)]
    asked = asked + 0.01 * random.normal(size=asked.shape)
    rec.project(asked[:1])  # builds the tree
    measure(f"project {queries:,} points", lambda: rec.project(asked))
    with tempfile.TemporaryDirectory(dir=directory) as folder:
        for suffix in (".ply", ".npz"):
            path = Path(folder, f"mesh{suffix}")
            measure(f"write {suffix}", partial(rec.write, path))
            size = path.stat().st_size
            path.unlink()
            raw = partial(write_raw, path, size)
            measure(f"as many bytes, {size / 1e6:,.0f} MB", raw)
            path.unlink()


if __name__ == "__main__":
    app()
