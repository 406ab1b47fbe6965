# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles on clusters that are not at hand: simulated, with costs that were measured here.

    python benchmarks/simulate_cluster.py --samples 1e9 --tile-size 1e6 --workers 10,100,1000

The plan is the real one, made from samples of a torus; so are the steps, their order and
what each task is told. A task takes no time but the CPU time that its step takes a sample
here, and shares a disk; submitting it, sending it to a worker and taking back its result
takes the one process that runs client and scheduler the CPU time that a real Dask takes
here for a task that does nothing but is told as much.
"""

import argparse
import heapq
import json
import pickle
import tempfile
import time
from collections import deque
from pathlib import Path

import numpy as np

import remanifold.distributed as rd
from remanifold.distributed import _plan, _run
from tiles import samples_of

# What each step goes over, and how many times the tiles' halo is read. Steps that look at a
# fixed number of samples of all take what they take, shared by as many tiles.
BY_CHUNK = ("scan", "sort")
# Medians of the local scale a unit of length has none of: the halo is in these.
HALO = 20.0


def measured(count, tile_size):
    """Of each step the CPU-seconds and bytes a sample, by a run in this process."""
    seconds, last = {}, [time.process_time(), "scan"]

    def told(step, _done, _total):
        now = time.process_time()
        seconds[last[1]] = seconds.get(last[1], 0.0) + now - last[0]
        last[:] = now, step

    with tempfile.TemporaryDirectory() as work:
        path = Path(work) / "samples.npy"
        np.save(path, samples_of("torus", count))
        last[0] = time.process_time()
        rec = rd.reconstruct(
            path, 2, work=work, num_workers=0, tile_size=tile_size, progress=told
        )
        told("end", 0, 0)
        read = sum(rec.manifest["samples_of_tiles"])
        stages = rec.manifest["stages"]
    steps = {}
    for step, stage in stages.items():
        over = read if step.startswith(("tiles", "measure")) else count
        steps[step] = {
            "seconds": seconds.get(step, 0.0) / over,
            "bytes": stage["bytes"] / over,
            "each": stage["tasks"] // rec.manifest["tiles"] or 1,
        }
    return steps


def nothing(_told):
    return 0


def seconds_per_task(num_tasks=400):
    """CPU time of client and scheduler for a task, told what a task of a run is told."""
    from distributed import Client, LocalCluster, as_completed

    told = pickle.dumps({"job": "x" * 1_500})
    with (
        LocalCluster(
            n_workers=1,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Client(cluster) as client,
    ):
        client.submit(nothing, told, pure=False).result()
        before = time.process_time()
        futures = [client.submit(nothing, told, pure=False) for _ in range(num_tasks)]
        for future in as_completed(futures):
            future.result()
            future.release()
        return (time.process_time() - before) / num_tasks


def tiles_of_plan(num_samples, tile_size):
    """Samples of each tile of the real plan, own and with halo."""
    some = samples_of("torus", min(2_000_000, int(40 * 64 * num_samples / tile_size)))
    low, high = some.min(axis=0), some.max(axis=0)
    plan = _plan.make_plan(some, low, high, num_samples, tile_size)
    share = num_samples / len(some)
    # A torus of area 2 * 0.7 * (2 pi)^2: to the sixth neighbor.
    area = 2 * 0.7 * (2 * np.pi) ** 2
    halo = HALO * (6 * area / np.pi / num_samples) ** 0.5
    cells = plan.cells_of(some)
    own = np.bincount(plan.tile_of_cell[cells], minlength=plan.num_tiles) * share
    order = np.argsort(cells, kind="stable")
    begins = np.searchsorted(cells[order], np.arange(len(plan.cell_low) + 1))
    read = np.empty(plan.num_tiles)
    for tile in range(plan.num_tiles):
        box = plan.box(tile, halo)
        near = np.concatenate(
            [order[begins[c] : begins[c + 1]] for c in plan.cells_within(*box)]
        )
        inside = (some[near] >= box[0]) & (some[near] <= box[1])
        read[tile] = np.count_nonzero(inside.all(axis=1)) * share
    # No tile has less around it than by its outline, which few samples do not show.
    read = np.maximum(read, own * (1 + halo / (area * own / num_samples) ** 0.5) ** 2)
    return own, read


class Cluster:
    """Workers, one process for client and scheduler, one disk; each does one thing."""

    def __init__(self, workers, per_task, disk):
        self.workers, self.per_task, self.disk = workers, per_task, disk
        self.now = 0.0
        self.busy = dict.fromkeys(("workers", "scheduler", "disk"), 0.0)

    def run(self, tasks):
        """One step: (seconds, bytes) of each task; all are done before the next begins."""
        free = {"scheduler": self.now, "disk": self.now}
        idle, waiting = self.workers, deque()
        events = [(self.now, i, "submit") for i in range(len(tasks))]
        heapq.heapify(events)

        def serve(server, at, seconds):
            free[server] = max(free[server], at) + seconds
            self.busy[server] += seconds
            return free[server]

        end = self.now
        while events:
            at, i, what = heapq.heappop(events)
            seconds, volume = tasks[i]
            if what == "submit":
                done = serve("scheduler", at, self.per_task / 2)
                heapq.heappush(events, (done, i, "ready"))
            elif what == "ready":
                if idle:
                    idle -= 1
                    heapq.heappush(events, (at, i, "begin"))
                else:
                    waiting.append(i)
            elif what == "begin":
                self.busy["workers"] += seconds
                heapq.heappush(events, (at + seconds, i, "write"))
            elif what == "write":
                done = serve("disk", at, volume / self.disk)
                heapq.heappush(events, (done, i, "end"))
            elif what == "end":
                idle += 1
                if waiting:
                    idle -= 1
                    heapq.heappush(events, (at, waiting.popleft(), "begin"))
                end = max(end, serve("scheduler", at, self.per_task / 2))
        self.now = end


def simulate(steps, own, read, workers, per_task, disk):
    cluster = Cluster(workers, per_task, disk)
    num_chunks = -(-int(own.sum()) // _run.CHUNK)
    for step, cost in steps.items():
        if step in BY_CHUNK:
            samples = np.full(num_chunks, own.sum() / num_chunks)
        else:
            samples = read if step.startswith(("tiles", "measure")) else own
        for _ in range(cost["each"]):
            share = 1 / cost["each"]
            cluster.run(
                [
                    (n * cost["seconds"] * share, n * cost["bytes"] * share)
                    for n in samples
                ]
            )
    used = {name: busy / cluster.now for name, busy in cluster.busy.items()}
    used["workers"] /= workers
    return cluster.now, used


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--samples", type=float, default=1e9)
    parser.add_argument("--tile-size", default="1e6", help="several with commas")
    parser.add_argument("--workers", default="10,100,1000,10000")
    parser.add_argument(
        "--disk", type=float, default=2e9, help="bytes a second, of all"
    )
    parser.add_argument("--measured", type=int, default=200_000, help="samples")
    parser.add_argument(
        "--costs", help="file of costs: read, or written where there is none"
    )
    args = parser.parse_args()
    if args.costs and Path(args.costs).exists():
        steps, per_task = json.loads(Path(args.costs).read_text())
    else:
        steps = measured(args.measured, args.measured // 4)
        per_task = seconds_per_task()
        if args.costs:
            Path(args.costs).write_text(json.dumps([steps, per_task]))
    total = sum(step["seconds"] for step in steps.values())
    volume = sum(step["bytes"] for step in steps.values())
    print(f"measured: {1e6 * total:.1f} us and {volume:.0f} bytes a sample, ", end="")
    print(f"{1e3 * per_task:.2f} ms a task", flush=True)
    for size in args.tile_size.split(","):
        own, read = tiles_of_plan(int(args.samples), int(float(size)))
        for workers in map(int, args.workers.split(",")):
            seconds, used = simulate(steps, own, read, workers, per_task, args.disk)
            shares = ", ".join(f"{name} {100 * u:.0f} %" for name, u in used.items())
            halo = (
                f"{len(own):,} tiles, halo {100 * (read.sum() / own.sum() - 1):.0f} %"
            )
            print(
                f"simulated: {args.samples:.0e} samples, {halo}, {workers:,} workers: "
                f"{seconds:,.0f} s; busy: {shares}",
                flush=True,
            )


if __name__ == "__main__":
    main()
