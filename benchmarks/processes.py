# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in processes of its own: a crash or a run without end is an answer like others."""

from __future__ import annotations

import contextlib
import json
import math
import multiprocessing
import os
import resource
import signal
import subprocess
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing import connection
from typing import Any


@dataclass(frozen=True)
class Failure:
    """Why there is no result."""

    reason: str
    ending: str  # "error", "crash" or "timeout"


def run_all(
    work: Callable[[Any], Any], tasks: Sequence[Any], jobs: int, time_limit: float
) -> Iterator[tuple[Any, Any]]:
    """Results or failures in the order they come; what is left at the end is killed."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["numpy", "remanifold", "rich.table", "typer"])
    waiting = deque(tasks)
    running: dict[Any, tuple[Any, Any, float]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                receiver, sender = context.Pipe(duplex=False)
                task = waiting.popleft()
                process = context.Process(target=_report_to, args=(sender, work, task))
                process.start()
                sender.close()
                running[receiver] = process, task, time.monotonic() + time_limit
            first = min(deadline for *_, deadline in running.values())
            left = max(0.0, first - time.monotonic())
            connection.wait(list(running), None if math.isinf(left) else left)
            for receiver in list(running):
                process, task, deadline = running[receiver]
                if receiver.poll():
                    try:
                        result = receiver.recv()
                    except EOFError:
                        process.join()
                        result = Failure(_end(process.exitcode), "crash")
                elif time.monotonic() >= deadline:
                    process.kill()
                    result = _timeout(time_limit)
                else:
                    continue
                process.join()
                receiver.close()
                del running[receiver]
                yield task, result
    finally:
        for process, *_ in running.values():
            process.kill()
            process.join()


def over_all_seeds(
    work: Callable[[Any], Any],
    task: Any,
    seeds: int,
    jobs: int,
    failed: Callable[[Failure], Any],
) -> dict[int, Any]:
    """Results of a task with each seed; of those that failed what stands for it."""
    outcomes: dict[int, Any] = {}
    tasks = [replace(task, seed=seed) for seed in range(seeds)]
    with contextlib.closing(run_all(work, tasks, jobs, task.time_limit)) as runs:
        for done, result in runs:
            lost = isinstance(result, Failure)
            outcomes[done.seed] = failed(result) if lost else result
    return outcomes


def run_command(
    command: Sequence[str],
    time_limit: float,
    environment: Mapping[str, str],
    cpu_limit: float = math.inf,
) -> Any:
    """The JSON that a command prints, or a failure."""

    def limit_cpu() -> None:
        soft = math.ceil(cpu_limit)
        resource.setrlimit(resource.RLIMIT_CPU, (soft, soft + 5))

    try:
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=None if math.isinf(time_limit) else time_limit,
            env={**os.environ, **environment},
            preexec_fn=None if math.isinf(cpu_limit) else limit_cpu,
        )
    except subprocess.TimeoutExpired:
        return _timeout(time_limit)
    if done.returncode == 0:
        try:
            return json.loads(done.stdout)
        except ValueError:
            return Failure("did not print JSON", "error")
    if done.returncode == -signal.SIGXCPU:
        return _timeout(cpu_limit)
    if done.returncode < 0:
        return Failure(_end(done.returncode), "crash")
    lines = done.stderr.split("\n")
    said = [line for line in lines if line.strip()] or [_end(done.returncode)]
    return Failure(said[-1].strip(), "error")


def _report_to(sender: Any, work: Callable[[Any], Any], task: Any) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent kills
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)  # GUDHI prints
    os.dup2(null, 2)
    try:
        result = work(task)
    except Exception as error:  # noqa: BLE001  whatever it is, it is a failure
        result = Failure(f"{type(error).__name__}: {error}", "error")
    sender.send(result)
    sender.close()


def _timeout(time_limit: float) -> Failure:
    return Failure(f"not done after {time_limit:g} s", "timeout")


def _end(exit_code: int) -> str:
    if exit_code < 0:
        return f"crashed: {signal.Signals(-exit_code).name}"
    return f"ended with exit code {exit_code}"
