# SPDX-License-Identifier: GPL-3.0-or-later
"""How often a reconstruction from random samples is right, shape by shape.

    python benchmarks/success_rates.py                       # the table, 20 seeds each
    python benchmarks/success_rates.py --shape torus --verbose
    python benchmarks/success_rates.py --smallest --peers    # samples needed

Right is a manifold by its links with the Betti numbers over Z2 and Z3 of the true one,
closed and orientable where that is, with as many boundary components, and with at most
1 % of the samples unused. Every run has a process of its own, so that a crash or a run
without end counts as a failure and nothing more.
"""

from __future__ import annotations

import contextlib
import functools
import math
import os
import statistics
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
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
    gather,
    make_app,
    one_of,
    print_lines,
)
from judge import judge
from peers import PERTURBATION, tangential_complex, top_simplices
from processes import Failure, run_all
from remanifold import datasets
from remanifold.method.options import METHODS
from samples import add_normal_noise, spacing

ENOUGH = 0.9  # of the seeds, for --smallest
STEP = 1.25  # between the numbers of samples that --smallest tries
MAX_GROWTH = 8  # of the number of samples of the table
MIN_SAMPLES = 8
PEERS = ("gudhi", "gudhi perturbed")  # its tangential complex


@dataclass(frozen=True)
class Row:
    """A row of the table: samples of a shape, by its name in `datasets.SHAPES`."""

    label: str
    shape: str
    num_samples: int
    figure: int | None = None
    random: bool = True

    @property
    def name(self) -> str:
        return self.shape if self.figure is None else f"figure_{self.figure}"

    def draw(self, num_samples: int, seed: int) -> Any:
        if self.figure is not None:
            return datasets.figure_samples(self.figure)
        generate = datasets.SHAPES[self.shape].generate
        return generate(num_samples, random_state=seed)


TABLE = (
    Row("circle in R^2", "circle", 200),
    Row("trefoil in R^3", "trefoil", 400),
    Row("closed curve in R^100", "closed_curve_in_100", 400),
    Row("sphere in R^3", "sphere", 100),
    Row("torus in R^3", "torus", 400),
    Row("flat torus in R^4", "flat_torus", 400),
    Row("flat torus in R^100", "flat_torus_in_100", 400),
    Row("Klein bottle in R^4", "klein_bottle", 800),
    Row("projective plane in R^5", "projective_plane", 200),
    Row("two linked tori in R^3", "interlocking_tori", 1600),
    Row("spherical cap in R^3", "spherical_cap", 200),
    Row("Moebius band in R^3", "moebius_band", 400),
    Row("annulus in R^4", "annulus_in_4", 800),
    Row("Swiss roll in R^3", "swiss_roll", 2000),
    Row("spiral in R^2", "spiral", 1600),
    Row("3-sphere in R^4", "sphere_3", 400),
    Row("S^2 x S^1 in R^5", "sphere_times_circle", 800),
    Row("3-torus in R^6", "flat_torus_3", 2500),
    Row("SO(3) in R^9", "rotations", 800),
    Row("bent 3-ball in R^4", "bent_ball", 1500),
    Row("4-sphere in R^5", "sphere_4", 800),
    Row("S^2 x S^2 in R^6", "sphere_times_sphere", 6000),
    Row("genus 2, spacings 10:1", "uneven_double_torus", 6400),
    Row("torus, densities 100:1", "uneven_torus", 10_000),
    Row("spheres three spacings apart", "concentric_spheres", 10_000),
)
GRIDS = (
    Row("grid on a torus", "grid_torus", 960, random=False),
    Row("grid on a cylinder", "grid_cylinder", 960, random=False),
    Row("figure 9 of the paper", "grid_torus", 960, figure=9, random=False),
)
NOISY = Row("torus in R^3", "torus", 3000)

app = make_app()


# -------------------------------------------------------------- one reconstruction


@dataclass(frozen=True)
class Task:
    row: Row
    num_samples: int
    seed: int
    method: str
    boundary: Any = "auto"
    noise: float = 0.0
    time_limit: float = math.inf


@dataclass(frozen=True)
class Outcome:
    """Reasons of failure, none for a success, and how the run ended."""

    reasons: tuple[str, ...]
    seconds: float = math.nan
    ending: str = "done"  # or "error", "crash", "timeout"

    @property
    def right(self) -> bool:
        return not self.reasons


def reconstruct(task: Task) -> Outcome:
    """Draw the samples, reconstruct and judge. Runs in a process of its own."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    shape = datasets.SHAPES[task.row.shape]
    points = task.row.draw(task.num_samples, task.seed)
    if task.noise > 0:
        points = add_normal_noise(
            points, shape.dim, task.noise, task.seed, task.row.draw
        )
    start = time.perf_counter()
    if task.method in PEERS:
        perturbation = 0.0
        if task.method == PEERS[1]:
            perturbation = PERTURBATION * spacing(points)
        # Half of the time is for perturbing.
        tree = tangential_complex(
            points.tolist(), shape.dim, perturbation, task.time_limit / 2
        )
        simplices = top_simplices(tree, shape.dim)
        seconds = time.perf_counter() - start
        topology = rm.compute_topology(simplices, len(points), num_threads=1)
    else:
        options = {} if task.method == "paper" else {"boundary": task.boundary}
        rec = rm.reconstruct(
            points, shape.dim, method=task.method, num_threads=1, **options
        )
        seconds = time.perf_counter() - start
        simplices, topology = np.sort(rec.simplices, axis=1), rec.topology()
    return Outcome(tuple(judge(simplices, topology, len(points), shape)), seconds)


# ------------------------------------------------------------------ the questions


@dataclass(frozen=True)
class Settings:
    seeds: int
    jobs: int
    boundary: str
    noise: float
    time_limit: float
    verbose: Callable[[str], None]

    def described(self) -> dict[str, Any]:
        return {
            "remanifold": rm.__version__,
            "seeds": self.seeds,
            "boundary": self.boundary,
            "noise": self.noise,
            "time_limit": self.time_limit,
        }

    def tasks(self, row: Row, num_samples: int, method: str) -> list[Task]:
        closed = datasets.SHAPES[row.shape].closed
        boundary = False if self.boundary == "known" and closed else "auto"
        varied = row.random or self.noise > 0
        return [
            Task(row, num_samples, seed, method, boundary, self.noise, self.time_limit)
            for seed in range(self.seeds if varied else 1)
        ]

    def run(
        self, row: Row, num_samples: int, method: str, stop_early: bool = False
    ) -> dict[int, Outcome]:
        """Outcomes by seed; with ``stop_early`` until it is known if they are enough."""
        tasks = self.tasks(row, num_samples, method)
        needed = _needed(len(tasks))
        outcomes: dict[int, Outcome] = {}
        runs = run_all(reconstruct, tasks, self.jobs, self.time_limit)
        with contextlib.closing(runs):
            for task, result in runs:
                outcome = result
                if isinstance(result, Failure):
                    outcome = Outcome((result.reason,), ending=result.ending)
                outcomes[task.seed] = outcome
                if outcome.reasons:
                    head = f"{row.name}, {method}, {num_samples}, seed {task.seed}"
                    self.verbose(f"{head}: {'; '.join(outcome.reasons)}")
                right = sum(o.right for o in outcomes.values())
                wrong = len(outcomes) - right
                if stop_early and (right >= needed or wrong > len(tasks) - needed):
                    break
        return dict(sorted(outcomes.items()))

    def enough(self, row: Row, num_samples: int, method: str) -> tuple[bool, bool]:
        """Whether 90 % are right, and whether all others took too long."""
        outcomes = self.run(row, num_samples, method, stop_early=True).values()
        wrong = [outcome for outcome in outcomes if not outcome.right]
        total = len(self.tasks(row, num_samples, method))
        enough = len(wrong) <= total - _needed(total)
        verdict = "enough" if enough else "not enough"
        self.verbose(f"{row.name}, {method}, {num_samples}: {verdict}")
        return enough, all(outcome.ending == "timeout" for outcome in wrong)

    def smallest(self, row: Row, start: int, method: str) -> dict[str, int | None]:
        """The smallest number of the ladder, down from the start or else up.

        None where the largest number tried is not enough.
        """
        found, number = None, start
        while number >= MIN_SAMPLES and self.enough(row, number, method)[0]:
            found = number
            number = round(number / STEP)
        if found is not None:
            return {"found": found, "tried": start}
        number = start
        while (larger := round(number * STEP)) <= MAX_GROWTH * start:
            number = larger
            enough, too_long = self.enough(row, number, method)
            if enough:
                return {"found": number, "tried": number}
            if too_long:
                break
        return {"found": None, "tried": number}


def _needed(runs: int) -> int:
    return math.ceil(ENOUGH * runs - 1e-9)


def success_rates(
    rows: Sequence[Row], methods: Sequence[str], num_samples: int | None, run: Settings
) -> Iterator[dict[str, Any]]:
    for row in rows:
        shape = datasets.SHAPES[row.shape]
        count = num_samples if num_samples and row.figure is None else row.num_samples
        results = {}
        for method in methods:
            outcomes = run.run(row, count, method)
            done = [o.seconds for o in outcomes.values() if math.isfinite(o.seconds)]
            results[method] = {
                "successes": sum(o.right for o in outcomes.values()),
                "runs": len(outcomes),
                "median_seconds": statistics.median(done) if done else None,
                "endings": dict(Counter(o.ending for o in outcomes.values())),
                "failures": {
                    str(seed): list(o.reasons)
                    for seed, o in outcomes.items()
                    if not o.right
                },
            }
        yield _record(row, shape, num_samples=count, methods=results)


def smallest_numbers(
    rows: Sequence[Row], methods: Sequence[str], num_samples: int | None, run: Settings
) -> Iterator[dict[str, Any]]:
    for row in rows:
        start = num_samples or row.num_samples
        numbers = {method: run.smallest(row, start, method) for method in methods}
        yield _record(row, datasets.SHAPES[row.shape], start=start, smallest=numbers)


def _record(row: Row, shape: datasets.Shape, **rest: Any) -> dict[str, Any]:
    return {
        "name": row.name,
        "label": row.label,
        "dim": shape.dim,
        "ambient_dim": shape.ambient_dim,
        **rest,
    }


def cells_of_rates(record: dict[str, Any]) -> list[tuple[str, str]]:
    """Heads and cells of a line of the table."""
    cells = [("", record["label"]), ("samples", f"{record['num_samples']:,}")]
    for method, result in record["methods"].items():
        endings = [
            f"{count} {ending}"
            for ending, count in result["endings"].items()
            if ending != "done"
        ]
        text = f"{result['successes']} of {result['runs']}"
        cells.append((method, ", ".join([text, *endings])))
        seconds = result["median_seconds"]
        cells.append(("seconds", "" if seconds is None else f"{seconds:.2f}"))
    return cells


def cells_of_smallest(record: dict[str, Any]) -> list[tuple[str, str]]:
    cells = [("", record["label"])]
    for method, result in record["smallest"].items():
        found, tried = result["found"], result["tried"]
        cells.append((method, f"> {tried:,}" if found is None else f"{found:,}"))
    return cells


# --------------------------------------------------------------- the command line


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Row of the table by the name of its shape; may be repeated.",
            show_default="all",
            callback=lambda names: one_of([row.name for row in (*TABLE, *GRIDS)])(
                names or []
            ),
        ),
    ] = None,
    grids: Annotated[
        bool, typer.Option("--grids", help="Regular grids instead of the table.")
    ] = False,
    noise: Annotated[
        float,
        typer.Option(
            min=0,
            metavar="TIMES",
            help="Normal noise along the normals, its standard deviation in median "
            "distances to the nearest neighbor. Without --shape on a torus of 3,000 "
            "samples.",
        ),
    ] = 0.0,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each shape.")] = 20,
    num_samples: Annotated[
        int | None, typer.Option(min=1, show_default="those of the table")
    ] = None,
    method: Annotated[
        str,
        typer.Option(
            metavar=f"[{'|'.join(METHODS)}]", help="Method.", callback=one_of(METHODS)
        ),
    ] = "manifold",
    boundary: Annotated[
        str,
        typer.Option(
            metavar="[auto|known]",
            help="Let the method find out where the boundary is, or tell it which "
            "shapes have none. The paper's method does not ask.",
            callback=one_of(["auto", "known"]),
        ),
    ] = "auto",
    peers: Annotated[
        bool,
        typer.Option(
            "--peers", help="Also GUDHI's tangential complex, raw and perturbed."
        ),
    ] = False,
    smallest: Annotated[
        bool,
        typer.Option(
            "--smallest",
            help="Search the smallest number of samples with 90 % of successes, in "
            "steps of a factor of 1.25.",
        ),
    ] = False,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 300.0,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose", "-v", help="Say on standard error what failed, seed by seed."
        ),
    ] = False,
) -> None:
    """Count how often a reconstruction from random samples is right."""
    if shape:
        rows = [row for row in (*TABLE, *GRIDS) if row.name in shape]
    elif grids:
        rows = list(GRIDS)
    else:
        rows = [NOISY] if noise > 0 else list(TABLE)
    if smallest and any(not row.random for row in rows):
        msg = "is for random samples, not for grids."
        raise typer.BadParameter(msg, param_hint="'--smallest'")
    messages = Console(stderr=True, soft_wrap=True, highlight=False)
    say = functools.partial(messages.print, markup=False)
    settings = Settings(
        seeds=seeds,
        jobs=jobs or os.cpu_count() or 1,
        boundary=boundary,
        noise=noise,
        time_limit=time_limit,
        verbose=say if verbose else lambda _: None,
    )
    methods = [method, *(PEERS if peers else ())]
    ask = smallest_numbers if smallest else success_rates
    cells_of = cells_of_smallest if smallest else cells_of_rates
    records = gather(
        ask(rows, methods, num_samples, settings),
        len(rows),
        "shapes",
        json_file,
        settings.described(),
    )
    lines = [cells_of(record) for record in records]
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
