# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the sampling report is right about a reconstruction.

    python benchmarks/critical_sampling.py                        # the table
    python benchmarks/critical_sampling.py --shape torus --verbose
    python benchmarks/critical_sampling.py --noise 0.3 --seeds 2

For each manifold of success_rates.py a ladder of numbers of samples, from twice that of
the table down to where no reconstruction can succeed. Each run is right or wrong as
there; the verdict, which knows the samples and the result only, should doubt those that
are wrong and no others.
"""

from __future__ import annotations

import os
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

import remanifold as rm
from command import (
    JobsOption,
    JsonOption,
    MarkdownOption,
    TimeLimitOption,
    make_app,
    print_table,
    write_report,
)
from judge import judge
from processes import Failure, run_all
from remanifold import datasets
from samples import add_normal_noise
from success_rates import TABLE, Row

STEP = 2**0.5  # between the numbers of a ladder
HIGHEST = 2.0  # times the number of the table
LOWEST = 32  # the number of the table over this
FIRST_SEED = 200  # those below were looked at when the limits were chosen
SLOW = {"sphere_times_sphere": 0.25}  # times the number of the table, one seed only
HEADS = ("", "samples", "runs", "wrong", "warned", "right", "false alarms")

app = make_app()


@dataclass(frozen=True)
class Task:
    row: Row
    num_samples: int
    seed: int
    noise: float


@dataclass(frozen=True)
class Outcome:
    wrong: tuple[str, ...]
    doubts: tuple[str, ...]


def ladder(row: Row) -> list[int]:
    """Numbers of samples, falling, down to those that no quadric can be fitted to."""
    dim = datasets.SHAPES[row.shape].dim
    least = 3 * dim * (dim + 3) // 2 + 1
    number = row.num_samples * SLOW.get(row.shape, HIGHEST)
    numbers = []
    while number >= max(least, row.num_samples / LOWEST * 0.99):
        numbers.append(round(number))
        number /= STEP
    return numbers


def tasks_of(row: Row, seeds: int, first_seed: int, noise: float) -> list[Task]:
    if row.shape in SLOW:
        seeds = 1
    return [
        Task(row, number, first_seed + i, noise)
        for number in ladder(row)
        for i in range(seeds)
    ]


def assess(task: Task) -> Outcome:
    """Reconstruct, judge, and ask the report. Runs in a process of its own."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    shape = datasets.SHAPES[task.row.shape]
    points = task.row.draw(task.num_samples, task.seed)
    if task.noise > 0:
        points = add_normal_noise(
            points, shape.dim, task.noise, task.seed, task.row.draw
        )
    rec = rm.reconstruct(points, shape.dim, num_threads=1)
    simplices = np.sort(rec.simplices, axis=1)
    wrong = tuple(judge(simplices, rec.topology(), len(points), shape))
    return Outcome(wrong, tuple(reason.text for reason in rec.quality.reasons))


def counts_of(outcomes: Sequence[Outcome]) -> Counter[str]:
    counts: Counter[str] = Counter()
    for outcome in outcomes:
        doubted = bool(outcome.doubts)
        counts["runs"] += 1
        counts["wrong"] += bool(outcome.wrong)
        counts["warned"] += bool(outcome.wrong) and doubted
        counts["right"] += not outcome.wrong
        counts["false alarms"] += not outcome.wrong and doubted
    return counts


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Row by the name of its shape; may be repeated.", show_default="all"
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each size.")] = 4,
    first_seed: Annotated[int, typer.Option(min=0)] = FIRST_SEED,
    noise: Annotated[
        float,
        typer.Option(
            min=0,
            metavar="TIMES",
            help="Normal noise, its standard deviation in median distances to the "
            "nearest neighbor.",
        ),
    ] = 0.0,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 300.0,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose", "-v", help="Name each miss and false alarm on standard error."
        ),
    ] = False,
) -> None:
    """Count the failures that the sampling report warns of, and its false alarms."""
    rows = [row for row in TABLE if not shape or row.shape in shape]
    if shape and len(rows) < len(set(shape)):
        msg = f"known are {', '.join(row.shape for row in TABLE)}."
        raise typer.BadParameter(msg, param_hint="'--shape'")
    say = Console(stderr=True, soft_wrap=True, highlight=False)
    records = []
    for row in rows:
        tasks = tasks_of(row, seeds, first_seed, noise)
        outcomes = []
        runs = run_all(assess, tasks, jobs or os.cpu_count() or 1, time_limit)
        for task, result in runs:
            head = f"{row.shape}, {task.num_samples}, seed {task.seed}"
            if isinstance(result, Failure):
                say.print(f"{head}: {result.reason}", markup=False)
                continue
            outcomes.append(result)
            if verbose and bool(result.wrong) != bool(result.doubts):
                what = "; ".join(result.wrong or result.doubts)
                kind = "missed" if result.wrong else "false alarm"
                say.print(f"{head}: {kind}: {what}", markup=False)
        numbers = ladder(row)
        records.append(
            {
                "name": row.shape,
                "label": row.label,
                "from": numbers[-1],
                "to": numbers[0],
                **{head: counts_of(outcomes)[head] for head in HEADS[2:]},
            }
        )
        write_report(
            json_file,
            {"remanifold": rm.__version__, "noise": noise, "results": records},
        )
    lines = [cells_of(record) for record in records]
    total: Counter[str] = Counter()
    for record in records:
        total.update({head: record[head] for head in HEADS[2:]})
    lines.append(["all", "", *_cells(total)])
    print_table(HEADS, lines, markdown=markdown)


def cells_of(record: dict[str, Any]) -> list[str]:
    span = f"{record['from']:,} to {record['to']:,}"
    return [record["label"], span, *_cells(record)]


def _cells(counts: Any) -> list[str]:
    def share(part: str, whole: str) -> str:
        if not counts[whole]:
            return ""
        return f"{counts[part]} ({counts[part] / counts[whole]:.0%})"

    return [
        str(counts["runs"]),
        str(counts["wrong"]),
        share("warned", "wrong"),
        str(counts["right"]),
        share("false alarms", "right"),
    ]


if __name__ == "__main__":
    app()
