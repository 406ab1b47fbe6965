# SPDX-License-Identifier: GPL-3.0-or-later
"""All that is asked of Dask: `submit` and `as_completed`."""

from __future__ import annotations

import hashlib
import pickle
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any

from remanifold._base.optional import load
from remanifold.distributed._store import Part, Store


@dataclass
class Stage:
    """What a step came to."""

    tasks: int = 0
    known: int = 0  # parts that an earlier run had made
    bytes: int = 0  # of its parts
    seconds: float = 0.0


class Engine:
    """Steps, each a task a tile, done by a client, or here without one.

    What an earlier run has done is known from the store.
    """

    def __init__(
        self,
        client: Any,
        store: Store,
        told: Callable[[str, int, int], None] | None = None,
    ) -> None:
        self._client = client
        self._store = store
        self._told = told
        self.stages: dict[str, Stage] = {}

    def run(
        self,
        step: str,
        function: Callable[..., Any],
        tasks: Sequence[tuple[Any, ...]],
    ) -> list[Any]:
        """The results of a function of each task, in order; parts are remembered."""
        start = time.monotonic()
        stage = self.stages.setdefault(step, Stage())
        results: list[Any] = [None] * len(tasks)
        names = []
        for task in tasks:
            inputs = pickle.dumps((function.__name__, *task))
            names.append(
                f"steps/{step}-{hashlib.blake2b(inputs, digest_size=16).hexdigest()}.json"
            )
        left = []
        for i, name in enumerate(names):
            said = self._store.read_json(name)
            if said is not None and self._store.has(part := Part(**said)):
                results[i] = part
                stage.known += 1
            else:
                left.append(i)
        done = len(tasks) - len(left)
        self._tell(step, done, len(tasks))
        for i, result in self._each(function, {i: tasks[i] for i in left}):
            results[i] = result
            if isinstance(result, Part):
                self._store.write_json(names[i], asdict(result))
            done += 1
            self._tell(step, done, len(tasks))
        stage.tasks += len(tasks)
        stage.bytes += sum(one.size for one in results if isinstance(one, Part))
        stage.seconds += time.monotonic() - start
        return results

    def _each(
        self, function: Callable[..., Any], tasks: dict[int, tuple[Any, ...]]
    ) -> Iterator[tuple[int, Any]]:
        if self._client is None:
            for i, task in tasks.items():
                yield i, function(*task)
            return
        from distributed import as_completed

        futures = {
            self._client.submit(function, *task, pure=False): i
            for i, task in tasks.items()
        }
        try:
            for future in as_completed(list(futures)):  # type: ignore[no-untyped-call]
                result = future.result()
                i = futures[future]
                future.release()
                yield i, result
        finally:
            for future in futures:
                future.cancel()

    def _tell(self, step: str, done: int, total: int) -> None:
        if self._told is not None:
            self._told(step, done, total)


@contextmanager
def client_of(
    client: Any, num_workers: int | None, memory_limit: str | int | None = None
) -> Iterator[Any]:
    """The given client, or one with a cluster on this machine alone; None for 0 workers."""
    if client is not None or num_workers == 0:
        yield client
        return
    distributed = load("distributed", "distributed")
    with (
        distributed.LocalCluster(
            n_workers=num_workers,
            threads_per_worker=1,
            memory_limit="auto" if memory_limit is None else memory_limit,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        distributed.Client(cluster) as own,
    ):
        yield own
