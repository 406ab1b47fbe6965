# SPDX-License-Identifier: GPL-3.0-or-later
"""Random manifolds of many families, one after the other: how often right, and how silent.

    python benchmarks/soak.py --seconds 3600 --seed 1      # the table, family by family
    python benchmarks/soak.py --only "can" --seed 17       # one case again, in full
    python benchmarks/soak.py --again FILE                 # those of a corpus

A case is a family and a seed, which draws everything else: size, how samples lie, noise,
clutter, copies, more coordinates, the kind of input and the options. Right is what judge.py
says. Warned is what users see without asking for more than the verdict: a result that is
no manifold, a quality that is not ok. Late is more than 60 seconds of one processor. Each
result is held against rec.check() as well.
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import json
import math
import os
import resource
import time
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

import remanifold as rm
from command import JobsOption, MarkdownOption, make_app, one_of, print_table
from families import FAMILIES, Family
from judge import judge
from processes import Failure, run_all
from samples import spacing

CPU_LIMIT = 60.0  # seconds of a run
WALL_LIMIT = 600.0  # where many share a processor
MOST_OF_PRODUCTS = 700  # samples whose distances or products are given instead
OUTCOMES = ("right", "right and warned", "wrong and warned", "wrong and silent", "late")
WORST = ("wrong and silent", "late", "crash")

app = make_app()


@dataclasses.dataclass(frozen=True)
class Case:
    """What stands for a run: it can be drawn again."""

    family: str
    seed: int


@dataclasses.dataclass(frozen=True)
class Drawn:
    """A case as it was drawn."""

    made: Family
    samples: dict[str, Any]  # as reconstruct takes them
    options: dict[str, Any]
    strewn: Any  # which samples are clutter
    conditions: str


@dataclasses.dataclass(frozen=True)
class Run:
    """What became of a case."""

    outcome: str
    conditions: str
    said: tuple[str, ...]
    verdict: str
    decidable: bool  # whether chance would not have left such a gap
    broken: tuple[str, ...]  # invariants
    seconds: float


def draw(case: Case) -> Drawn:
    """All of a case from its family and seed."""
    rng = np.random.default_rng([zlib.crc32(case.family.encode()), case.seed])
    kind = str(rng.choice(["random", "random", "even", "graded"]))
    made = FAMILIES[case.family](rng, kind)
    points, count = made.points, len(made.points)
    said = [f"N {count}", kind]
    noise = float(rng.choice([0, 0, 0, 0, 0, 0, 0.1, 0.25, 0.5, 1, 2, 4]))
    if noise:
        points = points + noise * spacing(points) * rng.normal(size=points.shape)
        said.append(f"noise {noise:g}")
    strewn = np.zeros(count, dtype=bool)
    clutter = float(rng.choice([0, 0, 0, 0, 0, 0, 0, 0, 0.02, 0.1]))
    if clutter:
        number = math.ceil(clutter * count)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        far = (rng.random((number, points.shape[1])) - 0.5) * 2 * np.ptp(points, axis=0)
        points = np.concatenate([points, middle + far])
        strewn = np.concatenate([strewn, np.ones(number, dtype=bool)])
        said.append(f"clutter {number}")
    if rng.random() < 0.1:
        copies = rng.integers(0, len(points), math.ceil(count / 20))
        points = np.concatenate([points, points[copies]])
        strewn = np.concatenate([strewn, strewn[copies]])
        said.append(f"copies {len(copies)}")
    solid = points.shape[1] == made.dim
    if rng.random() < 0.15 and points.shape[1] < 100:
        dim = int(rng.integers(points.shape[1] + 1, 101))
        points = rm.datasets.embed(points, dim, random_state=rng)
        said.append(f"in R^{dim}")
    order = rng.permutation(len(points))
    points, strewn = points[order], strewn[order]
    options = _options(rng, made.dim, solid)
    said += [f"{name}={value}" for name, value in options.items()]
    form = str(rng.choice(["points"] * 6 + ["single", "gram", "distances"]))
    samples: dict[str, Any] = {"points": points}
    if form == "single":
        samples = {"points": points.astype(np.float32)}
    elif form != "points" and len(points) <= MOST_OF_PRODUCTS:
        centered = points - points.mean(axis=0)
        gram = centered @ centered.T
        samples = {"gram": (gram + gram.T) / 2}
        if form == "distances":
            away = np.linalg.norm(points[:, None] - points, axis=2)
            samples = {"distances": (away + away.T) / 2}
    if form == "single" or "points" not in samples:
        said.append(next(iter(samples)) if form != "single" else "float32")
    return Drawn(made, samples, options, strewn, ", ".join(said))


def _options(rng: Any, dim: int, solid: bool) -> dict[str, Any]:
    """The defaults, or one option that is another one."""
    if rng.random() < 0.7:
        return {}
    neighbors = 10 * dim + int(rng.integers(0, 20))
    return dict(
        [
            [
                ("estimator", "pca"),
                ("search", "brute_force"),
                ("smooth", False),
                ("outliers", False),
                ("significance", 1e-2),
                ("num_neighbors", neighbors),
                ("num_threads", 2),
                ("outliers", 4.0),
            ][int(rng.integers(7 if solid else 8))]
        ]
    )


def attempt(case: Case) -> Run:
    """Draw, reconstruct, judge."""
    drawn = draw(case)
    start = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        options = {"num_threads": 1, **drawn.options}
        rec = rm.reconstruct(**drawn.samples, dim=drawn.made.dim, **options)
        quality = rec.quality
    seconds = time.process_time() - start
    topology = rec.topology()
    used = np.zeros(rec.num_samples, dtype=bool)
    used[rec.simplices.ravel()] = True
    used[rec.attached] = True
    lost = int((~used[rec.representatives] & ~drawn.strewn).sum())
    simplices = np.sort(rec.simplices, axis=1)
    said = tuple(
        judge(simplices, topology, topology.num_vertices + lost, drawn.made.truth)
    )
    warned = not quality.ok or not topology.manifold
    outcome = "wrong" if said else "right"
    if said or warned:
        outcome += " and warned" if warned else " and silent"
    return Run(
        outcome,
        drawn.conditions,
        said,
        quality.verdict,
        drawn.made.shows_it,
        tuple(one.name for one in rec.check().broken),
        seconds,
    )


def attempt_within_limit(case: Case) -> Run:
    """The same in a process of its own, which the limit ends."""
    soft = math.ceil(CPU_LIMIT + time.process_time())
    resource.setrlimit(resource.RLIMIT_CPU, (soft, soft + 5))
    return attempt(case)


def failed(failure: Failure) -> Run:
    """What stands for a run without a result."""
    late = failure.ending == "timeout" or "SIGXCPU" in failure.reason
    outcome = "late" if late else "crash"
    return Run(outcome, "", (failure.reason,), "", True, (), math.nan)


def runs_of(
    cases: list[Case], jobs: int | None, seconds: float = math.inf
) -> Iterator[tuple[Case, Run]]:
    """One after the other until the time is over."""
    end = time.monotonic() + seconds
    number = jobs or os.cpu_count() or 1
    runs = run_all(attempt_within_limit, cases, number, WALL_LIMIT)
    with contextlib.closing(runs) as results:
        for case, result in results:
            yield case, failed(result) if isinstance(result, Failure) else result
            if time.monotonic() > end:
                return


def table_of(runs: list[tuple[Case, Run]]) -> list[list[str]]:
    """A line for each family, and one for all."""
    rows = []
    for name in [*FAMILIES, "all"]:
        own = [run for case, run in runs if name in (case.family, "all")]
        if not own:
            continue
        counts = [sum(run.outcome == outcome for run in own) for outcome in OUTCOMES]
        silent = [r for r in own if r.outcome == "wrong and silent" and r.decidable]
        broken = sum(bool(run.broken) for run in own)
        crashed = sum(run.outcome == "crash" for run in own)
        cells = [len(own), *counts[:4], len(silent), counts[4], crashed, broken]
        rows.append([name, *map(str, cells)])
    return rows


HEADS = ["family", "runs", *OUTCOMES[:4], "though it shows", *OUTCOMES[4:]]
HEADS += ["crash", "check broken"]


def write_corpus(file: Path, runs: list[tuple[Case, Run]]) -> int:
    """Add the worst to those that a file has; the number of all."""
    held = read_corpus(file) if file.is_file() else []
    known = {(one["family"], one["seed"]): one for one in held}
    for case, run in runs:
        if run.outcome in WORST or run.broken:
            record = dataclasses.asdict(run)
            del record["seconds"]
            known[case.family, case.seed] = {**dataclasses.asdict(case), **record}
    lines = [json.dumps(known[key]) for key in sorted(known)]
    file.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return len(known)


def read_corpus(file: Path) -> list[dict[str, Any]]:
    lines = file.read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def tell(say: Console, case: Case, run: Run) -> None:
    """One line of a case that went wrong."""
    said = "; ".join([*run.said, *(f"broken: {one}" for one in run.broken)])
    text = (
        f"--only {case.family!r} --seed {case.seed}: {run.outcome} ({run.conditions})"
    )
    say.print(f"{text}: {said or run.verdict}", markup=False)


@app.command()
def soak(
    seconds: Annotated[
        float, typer.Option(min=0, help="Until no more is begun.")
    ] = 600,
    seed: Annotated[int, typer.Option(min=0, help="Of the first run of a family.")] = 1,
    only: Annotated[
        str | None,
        typer.Option(
            help="One case of this family.", callback=one_of([*FAMILIES, None])
        ),
    ] = None,
    again: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="The cases of this corpus."),
    ] = None,
    corpus: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="Add the worst to this file, a line each."),
    ] = None,
    jobs: JobsOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Reconstruct random manifolds of all families in turn, and count what comes out."""
    say = Console(stderr=True, soft_wrap=True, highlight=False)
    if only is not None:
        ((case, run),) = runs_of([Case(only, seed)], 1)
        tell(say, case, run)
        typer.echo(json.dumps(dataclasses.asdict(run), indent=2))
        return
    if again is not None:
        cases = [Case(one["family"], one["seed"]) for one in read_corpus(again)]
        seconds = math.inf
    else:
        rounds = range(seed, seed + 100_000)
        turns = itertools.islice(itertools.product(rounds, FAMILIES), 1_000_000)
        cases = [Case(name, number) for number, name in turns]
    runs = []
    for case, run in runs_of(cases, jobs, seconds):
        runs.append((case, run))
        if run.outcome in WORST or run.broken:
            tell(say, case, run)
    runs.sort(key=lambda pair: (pair[0].family, pair[0].seed))
    print_table(HEADS, table_of(runs), markdown=markdown)
    if corpus is not None:
        typer.echo(f"{write_corpus(corpus, runs)} cases in {corpus}", err=True)


if __name__ == "__main__":
    app()
