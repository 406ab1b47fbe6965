# SPDX-License-Identifier: GPL-3.0-or-later
"""In tiles beside one piece: the same bytes, CPU and wall time, memory of a worker.

    python benchmarks/tiles.py --samples 2000000 --workers 1,2 --tile-size 1000000

Everything runs in processes of its own; memory is the largest resident size of any.
"""

import argparse
import hashlib
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

SHAPES = {
    "torus": 2,
    "klein_bottle": 2,
    "lattice": 2,
    "terrain": 2,
    "holes": 2,
    "flat_torus_3": 3,
}


def samples_of(shape, count):
    rng = np.random.default_rng(1)
    if shape in ("terrain", "holes"):
        x = rng.random((count, 2))
        if shape == "holes":
            for *center, radius in (
                (0.3, 0.3, 0.05),
                (0.7, 0.6, 0.02),
                (0.5, 0.9, 0.01),
            ):
                x = x[np.linalg.norm(x - center, axis=1) > radius]
        height = sum(
            np.sin(2**k * (x @ rng.normal(size=2)) * 6 + 6 * rng.random()) / 2**k
            for k in range(5)
        )
        return np.column_stack([x, 0.05 * height])
    if shape == "lattice":
        side = int(count**0.5)
        u, v = (a.ravel() for a in np.mgrid[:side, :side] * 2 * np.pi / side)
        return np.stack([np.cos(u), np.sin(u), np.cos(v), np.sin(v)], axis=1)
    if shape == "flat_torus_3":
        turns = rng.random((3, count)) * 2 * np.pi
        return np.concatenate([np.cos(turns), np.sin(turns)]).T.copy()
    u, v = rng.random((2, count)) * 2 * np.pi
    around = 2 + 0.7 * np.cos(v)
    level = [around * np.cos(u), around * np.sin(u)]
    up = 0.7 * np.sin(v)
    if shape == "torus":
        return np.stack([*level, up], axis=1)
    return np.stack([*level, up * np.cos(u / 2), up * np.sin(u / 2)], axis=1)


def digest_of(simplices):
    return hashlib.blake2b(np.ascontiguousarray(simplices), digest_size=8).hexdigest()


def usage():
    own = resource.getrusage(resource.RUSAGE_SELF)
    return own.ru_utime + own.ru_stime, own.ru_maxrss // 1024


def one_piece(path, shape):
    import remanifold as rm

    points = np.load(path)
    start, before = time.monotonic(), usage()[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rec = rm.reconstruct(points, SHAPES[shape], num_threads=1)
    seconds = time.monotonic() - start
    return {
        "seconds": seconds,
        "cpu": usage()[0] - before,
        "memory": usage()[1],
        "digest": digest_of(rec.simplices),
    }


def in_tiles(path, shape, workers, tile_size):
    import remanifold.distributed as rd
    from remanifold.distributed._engine import client_of

    with tempfile.TemporaryDirectory() as work, client_of(None, workers) as client:
        before = sum(cpu for cpu, _ in client.run(usage).values()) + usage()[0]
        start = time.monotonic()
        rec = rd.reconstruct(
            path,
            SHAPES[shape],
            client=client,
            tile_size=tile_size,
            work=work,
        )
        seconds = time.monotonic() - start
        used = client.run(usage).values()
        own = usage()
        written = sum(file.stat().st_size for file in Path(work).rglob("*.np*"))
        return {
            "seconds": seconds,
            "cpu": sum(cpu for cpu, _ in used) + own[0] - before,
            "memory": max(memory for _, memory in used),
            "client": own[1],
            "written": written // 2**20,
            "tiles": rec.manifest["tiles"],
            "again": rec.manifest["tiles_again"],
            "stages": rec.manifest["stages"],
            "digest": digest_of(rec.simplices),
        }


def apart(*arguments):
    """The same in a process of its own."""
    done = subprocess.run(
        [sys.executable, __file__, "--only", json.dumps(arguments)],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--shape", action="append", choices=list(SHAPES))
    parser.add_argument("--samples", type=int, default=2_000_000)
    parser.add_argument("--workers", default="1,2")
    parser.add_argument("--tile-size", default="1000000")
    parser.add_argument("--only", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.only:
        what, *rest = json.loads(args.only)
        print(json.dumps({"one": one_piece, "tiles": in_tiles}[what](*rest)))
        return
    folder, same = tempfile.mkdtemp(), True
    for shape in args.shape or SHAPES:
        path = str(Path(folder) / f"{shape}.npy")
        np.save(path, samples_of(shape, args.samples))
        expected = apart("one", path, shape)
        print({"shape": shape, "how": "one piece", **expected}, flush=True)
        for size in map(int, args.tile_size.split(",")):
            for workers in map(int, args.workers.split(",")):
                found = apart("tiles", path, shape, workers, size)
                found["same"] = found["digest"] == expected["digest"]
                same = same and found["same"]
                how = f"{workers} workers, tiles of {size:,}"
                print({"shape": shape, "how": how, **found}, flush=True)
    shutil.rmtree(folder)
    if not same:
        sys.exit("not the bytes of one piece")


if __name__ == "__main__":
    main()
