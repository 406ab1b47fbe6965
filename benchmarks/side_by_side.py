# SPDX-License-Identifier: GPL-3.0-or-later
"""remanifold and its peers on the same points, in one run: time, memory, correctness.

    python benchmarks/side_by_side.py
    python benchmarks/side_by_side.py --shape torus --samples 10000,100000 --json FILE
    python benchmarks/side_by_side.py --peer manifold --peer gudhi --shape rotations

Every run has a process of its own. Repeats go round all peers, so that whatever else the
machine does hits all alike; ratios are to FLANN's search of the same round.
"""

from __future__ import annotations

import datetime as dt
import functools
import hashlib
import importlib.metadata
import json
import math
import os
import platform
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

import remanifold as rm
from command import JsonOption, make_app
from judge import judge
from peers import PEERS, UNIT, UNIT_MAX_AMBIENT_DIM, Options
from processes import Failure, run_all, run_command
from remanifold import datasets
from report import CPU_HELP, by_cpu, print_report
from samples import add_normal_noise, morton_ordered

ROOT = Path(__file__).resolve().parents[1]
DRIVERS = tuple(
    ROOT / "build" / name / "benchmarks" / "remanifold_peers"
    for name in ("bench", "python")
)
JUDGE_LIMIT = 600.0  # seconds; not part of the time limit of a run
LONG = 20.0  # seconds in all, after which a peer is not measured once more
SHARE = 0.9  # of a core; a run that got less was disturbed and is done again,
TRIES = 3  # as often, if it is not longer than
SHORT = 10.0  # seconds
PATIENCE = 5  # times the time limit, on the wall, if it is for CPU time
ORDERS = ("random", "morton")
DISTRIBUTIONS = ("numpy", "scipy", "gudhi", "open3d", "pymeshlab")

SHAPES = {
    **datasets.SHAPES,
    "flat_torus_in_300": datasets.Shape(
        partial(datasets.flat_torus, ambient_dim=300), 2, 300, (1, 2, 1)
    ),
}
# What is measured unless the command line says otherwise.
SAMPLES = {
    "torus": (10_000, 100_000),
    "sphere": (10_000,),
    "circle": (100_000,),
    "flat_torus_in_300": (5_000,),
    "sphere_times_circle": (800,),
    "flat_torus_3": (2_500,),
    "rotations": (10_000,),
    "sphere_4": (800,),
}
ELSE_SAMPLES = (10_000,)

app = make_app()


# ------------------------------------------------------------------------- cases


@dataclass(frozen=True)
class Case:
    shape: str
    num_samples: int
    order: str
    noise: float
    seed: int

    def draw(self) -> Any:
        shape = SHAPES[self.shape]

        def generate(num_samples: int, seed: int) -> Any:
            return shape.generate(num_samples, random_state=seed)

        points = generate(self.num_samples, self.seed)
        if self.noise > 0:
            points = add_normal_noise(
                points, shape.dim, self.noise, self.seed, generate
            )
        points = morton_ordered(points) if self.order == "morton" else points
        return np.ascontiguousarray(points, dtype=np.float64)

    def described(self) -> dict[str, Any]:
        shape = SHAPES[self.shape]
        return {
            **asdict(self),
            "dim": shape.dim,
            "ambient_dim": shape.ambient_dim,
        }


@dataclass(frozen=True)
class Verdict:
    reasons: tuple[str, ...]
    num_simplices: int
    digest: str  # of the simplices, by the input's numbers, sorted


@dataclass(frozen=True)
class JudgeTask:
    file: Path
    shape: str
    num_samples: int
    own_vertices: bool


def judged(task: JudgeTask) -> Verdict:
    """The verdict on a file of simplices. Runs in a process of its own."""
    shape = SHAPES[task.shape]
    found = np.fromfile(task.file, dtype=np.int32).reshape(-1, shape.dim + 1)
    found = np.sort(found, axis=1)
    found = found[np.lexsort(found.T[::-1])]
    whole = (np.diff(found, axis=1) > 0).all(axis=1)
    # CGAL's scale space says every triangle from both sides.
    fresh = np.append(True, (found[1:] != found[:-1]).any(axis=1))[: len(found)]
    simplices = np.ascontiguousarray(found[whole & fresh])
    count = int(simplices.max(initial=-1)) + 1 if task.own_vertices else 0
    topology = rm.compute_topology(simplices, max(count, task.num_samples))
    expected = topology.num_vertices if task.own_vertices else task.num_samples
    reasons = list(judge(simplices, topology, expected, shape))
    if not whole.all():
        reasons.insert(0, f"degenerate simplices: {np.count_nonzero(~whole)}")
    text = simplices.astype("<i4").tobytes()
    return Verdict(tuple(reasons), len(simplices), _hash(text))


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:12]


# -------------------------------------------------------------------------- runs


@dataclass
class Bench:
    driver: Path | None
    folder: Path
    repeat: int
    num_threads: int
    time_limit: float
    say: Any
    cpu: bool = False  # the limit is for CPU time, and nothing disturbs

    def run(self, name: str, file: Path, case: Case) -> Any:
        """The run, of a few if need be, that had most of a core to itself."""
        best: Any = None
        share = -1.0
        for _ in range(1 if self.cpu else TRIES):
            run = self.run_once(name, file, case)
            if isinstance(run, Failure):
                return run
            if run["cpu_seconds"] / run["seconds"] > share:
                best, share = run, run["cpu_seconds"] / run["seconds"]
            if share >= SHARE or run["seconds"] > SHORT:
                break
        return best

    def run_once(self, name: str, file: Path, case: Case) -> Any:
        """Seconds and bytes of one run, or a failure; the simplices are in a file."""
        options = Options(
            SHAPES[case.shape].dim,
            self.num_threads if name in ("manifold", "paper") else 1,
            self.time_limit,
        )
        command = [name, str(file), str(case.num_samples), str(self.result(name))]
        self.result(name).unlink(missing_ok=True)
        if PEERS[name].module is None:
            command = [str(self.driver), *command]
        else:
            script = Path(__file__).with_name("peers.py")
            text = json.dumps(asdict(options))
            command = [sys.executable, str(script), *command, text]
        # Open3D takes all cores otherwise.
        environment = {} if options.num_threads > 1 else {"OMP_NUM_THREADS": "1"}
        if self.cpu:
            patience = PATIENCE * self.time_limit
            return run_command(command, patience, environment, self.time_limit)
        return run_command(command, self.time_limit, environment)

    def result(self, name: str) -> Path:
        return self.folder / f"{name}.simplices"

    def judge(self, name: str, case: Case) -> Any:
        task = JudgeTask(
            self.result(name), case.shape, case.num_samples, PEERS[name].own_vertices
        )
        ((_, verdict),) = run_all(judged, [task], 1, JUDGE_LIMIT)
        return verdict

    def measure(
        self, case: Case, names: Sequence[str], too_long: dict[str, int]
    ) -> dict[str, dict[str, Any]]:
        """Records by peer; who runs out of time is entered into ``too_long``."""
        file = self.folder / "points"
        case.draw().tofile(file)
        records: dict[str, dict[str, Any]] = {}
        verdicts: dict[tuple[str, str], Any] = {}
        for name in names:
            records[name] = _empty_record()
            if name in too_long:
                count = too_long[name]
                reason = f"too long with {count:,} samples already"
                records[name] |= {"ending": "skipped", "reasons": [reason]}
        for turn in range(self.repeat):
            unit = math.nan
            for name in names:
                record = records[name]
                spent = sum(record["cpu_seconds" if self.cpu else "seconds"])
                long = name != UNIT and spent > LONG
                if record["ending"] != "done" or long:
                    continue
                self.say(f"{_title(case)}, {name}, {turn + 1} of {self.repeat}")
                run = self.run(name, file, case)
                if isinstance(run, Failure):
                    record |= {
                        "ending": run.ending,
                        "reasons": [run.reason],
                        "right": None if run.ending == "timeout" else False,
                    }
                    if run.ending == "timeout":
                        too_long[name] = case.num_samples
                    continue
                if name == UNIT:
                    unit = run["seconds"]
                ratio = run["seconds"] / unit
                record["seconds"].append(run["seconds"])
                record["cpu_seconds"].append(run["cpu_seconds"])
                record["ratios"].append(None if math.isnan(ratio) else ratio)
                if run["peak_bytes"] is not None:
                    record["bytes_per_sample"].append(
                        run["peak_bytes"] / case.num_samples
                    )
                if name == UNIT:
                    continue
                key = name, _hash(self.result(name).read_bytes())
                if key not in verdicts:
                    verdicts[key] = self.judge(name, case)
                    _enter(verdicts[key], record)
        return records


def _empty_record() -> dict[str, Any]:
    return {
        "seconds": [],
        "cpu_seconds": [],
        "ratios": [],
        "bytes_per_sample": [],
        "ending": "done",
        "right": None,  # unknown
        "reasons": [],
        "num_simplices": None,
        "digests": [],  # several if runs differ
    }


def _enter(verdict: Any, record: dict[str, Any]) -> None:
    """A verdict on one more result; what is wrong once is wrong."""
    if isinstance(verdict, Failure):
        if record["right"] is not False:
            record |= {"right": None, "reasons": [f"not judged: {verdict.reason}"]}
        return
    if verdict.digest not in record["digests"]:
        record["digests"].append(verdict.digest)
    if not record["reasons"] or verdict.reasons:
        record["num_simplices"] = verdict.num_simplices
        record["reasons"] = list(verdict.reasons)
        record["right"] = not verdict.reasons


def _title(case: Case) -> str:
    return f"{case.shape}, {case.num_samples:,} samples, {case.order}"


# ------------------------------------------------------------------ what there is


def missing_peers(names: Sequence[str], driver: Path | None) -> dict[str, str]:
    """Why peers cannot be measured here."""
    reasons: dict[str | None, str] = {}
    for module in {PEERS[name].module for name in names}:
        if module is None:
            if driver is None or not driver.is_file():
                reasons[None] = (
                    "no remanifold_peers: build with REMANIFOLD_BUILD_PEERS=ON "
                    "and say --driver FILE"
                )
            continue
        done = subprocess.run(
            [sys.executable, "-c", f"import {module}"],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            said = done.stderr.strip().splitlines() or ["crashed"]
            reasons[module] = f"import {module} failed: {said[-1]}"
    return {
        name: reasons[PEERS[name].module]
        for name in names
        if PEERS[name].module in reasons
    }


def versions(driver: Path | None) -> dict[str, str]:
    found = {"remanifold": rm.__version__, "python": platform.python_version()}
    for name in DISTRIBUTIONS:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    if driver is not None and driver.is_file():
        run = run_command([str(driver), "--version"], 60, {})
        found |= {} if isinstance(run, Failure) else run
    return found


def machine() -> dict[str, Any]:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.split(":")[1].strip() for line in lines if "model name" in line]
    return {
        "cpu": models[0] if models else platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
    }


# --------------------------------------------------------------- the command line


def _known(words: Sequence[str], names: list[str] | None) -> list[str]:
    for name in names or []:
        if name not in words:
            msg = f"{name!r} is not one of {', '.join(map(repr, words))}."
            raise typer.BadParameter(msg)
    return names or []


def _numbers(text: str | None) -> list[int]:
    try:
        numbers = (
            [int(word.replace("_", "")) for word in text.split(",")] if text else []
        )
    except ValueError:
        numbers = [0]
    if any(number < 1 for number in numbers):
        msg = f"{text!r} is not a list like 10000,100000."
        raise typer.BadParameter(msg)
    return numbers


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Name in datasets.SHAPES, or flat_torus_in_300; may be repeated.",
            show_default=", ".join(SAMPLES),
            callback=lambda names: _known(tuple(SHAPES), names),
        ),
    ] = None,
    samples: Annotated[
        str | None,
        typer.Option(
            metavar="N[,N..]", help="Numbers of samples.", show_default="by shape"
        ),
    ] = None,
    peer: Annotated[
        list[str] | None,
        typer.Option(
            metavar=f"[{'|'.join(PEERS)}]",
            help="What is measured; may be repeated. FLANN, the unit, always is.",
            show_default="all",
            callback=lambda names: _known(tuple(PEERS), names),
        ),
    ] = None,
    order: Annotated[
        str,
        typer.Option(metavar="[random|morton|both]", help="Order of the points."),
    ] = "random",
    noise: Annotated[
        float,
        typer.Option(
            min=0,
            metavar="TIMES",
            help="Noise along the normals, its standard deviation in median distances "
            "to the nearest neighbor.",
        ),
    ] = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the samples.")] = 0,
    threads: Annotated[
        int, typer.Option(min=1, help="Threads of remanifold; its peers have one.")
    ] = 1,
    repeat: Annotated[
        int,
        typer.Option(min=1, help="Rounds; what has taken 20 s in all is left out."),
    ] = 3,
    time_limit: Annotated[
        float,
        typer.Option(
            min=0, help="Seconds until a run is killed, and larger ones left out."
        ),
    ] = 60.0,
    driver: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            help="The executable remanifold_peers.",
            show_default="that of make",
        ),
    ] = None,
    json_file: JsonOption = None,
    cpu: Annotated[
        bool,
        typer.Option("--cpu", help=f"{CPU_HELP} Also for the limit. For one thread."),
    ] = False,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the tables in Markdown.")
    ] = False,
) -> None:
    """Measure remanifold and its peers side by side on the same points."""
    if order not in (*ORDERS, "both"):
        msg = f"{order!r} is not one of random, morton, both."
        raise typer.BadParameter(msg, param_hint="'--order'")
    if cpu and threads > 1:
        msg = "is for one thread."
        raise typer.BadParameter(msg, param_hint="'--cpu'")
    if driver is None:
        driver = next((file for file in DRIVERS if file.is_file()), None)
    wanted = [name for name in PEERS if not peer or name in peer or name == UNIT]
    numbers = _numbers(samples)
    cases = [
        Case(name, count, kind, noise, seed)
        for name in shape or SAMPLES
        for kind in (ORDERS if order == "both" else [order])
        for count in sorted(numbers or SAMPLES.get(name, ELSE_SAMPLES))
    ]
    messages = Console(stderr=True, soft_wrap=True, highlight=False)
    say = functools.partial(messages.print, markup=False)
    missing = missing_peers(wanted, driver)
    for name, reason in missing.items():
        say(f"left out: {PEERS[name].label} ({name}): {reason}")
    for name in peer or []:
        if not any(_takes(name, case) for case in cases):
            missing[name] = "for none of these shapes"
            say(f"left out: {PEERS[name].label} ({name}): {missing[name]}")

    # Leaves neither processes nor files behind, as Ctrl-C does not.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    report: dict[str, Any] = {
        "command": shlex.join(["benchmarks/side_by_side.py", *sys.argv[1:]]),
        "date": dt.datetime.now(dt.timezone.utc).isoformat("T", "seconds"),
        "machine": machine(),
        "versions": versions(driver),
        "threads": threads,
        "repeat": repeat,
        "time_limit": time_limit,
        "cpu_limit": cpu,
        "left_out": missing,
        "cases": [],
    }
    with (
        tempfile.TemporaryDirectory(prefix="side_by_side_") as folder,
        messages.status("") as status,
    ):
        tell = say if not messages.is_terminal else status.update
        bench = Bench(driver, Path(folder), repeat, threads, time_limit, tell, cpu)
        for record in _measured(bench, cases, wanted, missing):
            report["cases"].append(record)
            if json_file is not None:  # after each: a long run may be broken off
                text = json.dumps(report, indent=2)
                json_file.write_text(text + "\n", encoding="utf-8")
    print_report([by_cpu(report) if cpu else report], markdown)


def _measured(
    bench: Bench, cases: Sequence[Case], wanted: Sequence[str], missing: dict[str, str]
) -> Iterator[dict[str, Any]]:
    too_long: dict[tuple[str, str], dict[str, int]] = {}
    for case in cases:
        names = [n for n in wanted if n not in missing and _takes(n, case)]
        known = too_long.setdefault((case.shape, case.order), {})
        yield {**case.described(), "peers": bench.measure(case, names, known)}


def _takes(name: str, case: Case) -> bool:
    shape = SHAPES[case.shape]
    if name == UNIT:
        return shape.ambient_dim <= UNIT_MAX_AMBIENT_DIM
    return PEERS[name].takes(shape.dim, shape.ambient_dim)


if __name__ == "__main__":
    app()
