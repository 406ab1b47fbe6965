# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold reconstruct --distributed``: in tiles, by the workers of a cluster."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from remanifold._base.optional import load
from remanifold.cli._common import print_report, rows_table, say
from remanifold.complex.topology import simplex_names
from remanifold.method.options import Options


def folder_report(path: Path) -> dict[str, Any]:
    """What the files of a folder hold together: what `--distributed` takes.

    All coordinates are gone through, some at a time.
    """
    from remanifold.distributed._run import CHUNK  # for this only, and takes its time
    from remanifold.distributed._sources import source_of_files

    source = source_of_files(path)
    count, ambient_dim = source.shape()
    low, high = np.full(ambient_dim, np.inf), np.full(ambient_dim, -np.inf)
    num_finite = 0
    for begin in range(0, count, CHUNK):
        points = source.read(begin, min(begin + CHUNK, count))
        points = points[np.isfinite(points).all(axis=1)]
        num_finite += len(points)
        if len(points):
            low = np.minimum(low, points.min(axis=0))
            high = np.maximum(high, points.max(axis=0))
    return {
        "input": str(path),
        "files": {Path(p.path).name: p.layout.rows for p in source.pieces},
        "num_points": count,
        "ambient_dim": ambient_dim,
        "coordinates": [name for name in source.pieces[0].layout.axes if name],
        "not_finite": count - num_finite,
        "bounding_box": [low.tolist(), high.tolist()] if num_finite else None,
        "diagonal": float(np.linalg.norm(high - low)) if num_finite else None,
        "fields": source.attribute_names(),
    }


@dataclass(frozen=True)
class Tiling:
    """What the command line says of tiles and of the cluster."""

    scheduler: str | None
    workers: int | None
    memory_limit: str | None
    tile_size: int | None
    work: Path | None
    resume: bool

    def check_unused(self) -> None:
        """Refuse what is for --distributed only."""
        for name, value in vars(self).items():
            if value not in (None, False):
                flag = f"--{name.replace('_', '-')}"
                msg = f"{flag} is for --distributed."
                raise typer.BadParameter(msg, param_hint=f"'{flag}'")

    def check(self) -> None:
        """Refuse a cluster of our own and another one at once."""
        if self.workers == 0 and self.memory_limit is not None:
            msg = "is for other processes, and --workers is 0."
            raise typer.BadParameter(msg, param_hint="'--memory-limit'")
        for flag, value in (
            ("--workers", self.workers),
            ("--memory-limit", self.memory_limit),
        ):
            if self.scheduler is not None and value is not None:
                msg = "the scheduler has workers already."
                raise typer.BadParameter(msg, param_hint=f"'{flag}'")


class Line:
    """One line that says how far a step is, how fast, and when it ends."""

    def __init__(self, num_samples: int) -> None:
        self.num_samples = num_samples
        self.step = ""
        self.start = 0.0
        self.first = 0

    def __call__(self, step: str, done: int, total: int) -> None:
        """What `remanifold.distributed.reconstruct` calls."""
        now = time.monotonic()
        if step != self.step or done < self.first:
            self.step, self.start, self.first = step, now, done
        sys.stderr.write(f"\r\x1b[K{self.text(done, total, now - self.start)}")
        sys.stderr.flush()

    def text(self, done: int, total: int, seconds: float) -> str:
        """As in: tiles0 3/8, 41,000 samples/s, 12 s left."""
        said = f"{self.step} {done}/{total}"
        made = done - self.first
        if made > 0 and seconds > 0 and done < total:
            left = seconds / made * (total - done)
            rate = self.num_samples * made / total / seconds
            said += f", {rate:,.0f} samples/s, {left:.0f} s left"
        return said

    def end(self) -> None:
        """Leave nothing behind."""
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()


@contextlib.contextmanager
def _client(tiling: Tiling, messages: Console, quiet: bool) -> Iterator[Any]:
    from remanifold.distributed._engine import client_of

    if tiling.scheduler is None:
        given = contextlib.nullcontext()
    else:
        given = load("distributed", "distributed").Client(tiling.scheduler)
    with (
        given as named,
        client_of(named, tiling.workers, tiling.memory_limit) as client,
    ):
        if client is not None and not quiet:
            say(messages, f"dashboard: {client.dashboard_link}", "none")
        yield client


def reconstruct_in_tiles(
    source: Path,
    dim: int | str,
    output: Path,
    options: Options,
    tiling: Tiling,
    messages: Console,
    *,
    fields: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Reconstruct, and write a mesh where the output names one."""
    import remanifold.distributed as rd
    from remanifold.distributed._sources import source_of
    from remanifold.distributed._writing import check_mesh

    if isinstance(dim, str):
        msg = "with --distributed it is a number: remanifold dimension estimates it."
        raise typer.BadParameter(msg, param_hint="'--dim'")
    # Without a suffix the output is the directory of the run, and nothing is written more.
    is_mesh = output.suffix != ""
    work = tiling.work or (
        output.with_name(f"{output.name}.tiles") if is_mesh else output
    )
    num_samples, ambient_dim = source_of(str(source), work)[0].shape()
    if is_mesh:
        check_mesh(output, dim, ambient_dim, num_samples)
    line = Line(num_samples)
    shows = messages.is_terminal and not quiet
    size = {} if tiling.tile_size is None else {"tile_size": tiling.tile_size}
    start = time.monotonic()
    with _client(tiling, messages, quiet) as client:
        try:
            rec = rd.reconstruct(
                str(source),
                dim,
                client=client,
                num_workers=0 if client is None else None,
                work=work,
                boundary=options.boundary,  # type: ignore[arg-type]
                hole_radius=options.hole_radius,
                significance=options.significance,
                outliers=options.outliers,
                smooth=options.smooth,  # type: ignore[arg-type]
                num_neighbors=options.num_neighbors,
                estimator=options.estimator,  # type: ignore[arg-type]
                resume=tiling.resume,
                progress=line if shows else None,
                **size,
            )
        finally:
            if shows:
                line.end()
    if is_mesh:
        rec.write(output, attributes=fields)
    said = rec.manifest
    report = {
        "input": str(source),
        "output": str(output),
        "work": str(work),
        **{name: said[name] for name in ("dim", "num_samples", "num_distinct")},
        **said["topology"],
        "hole_radius": said["hole_radius"],
        "unused_samples": said["num_unused"],
        "openings": len(said["openings"]),
        "tiles": said["tiles"],
        "tiles_again": said["tiles_again"],
        "seconds": time.monotonic() - start,
        "stages": said["stages"],
    }
    if as_json or not quiet:
        print_report(report, _table, as_json=as_json)


def _table(report: dict[str, Any]) -> Table:
    yes_no = {True: "yes", False: "no"}
    names = simplex_names(report["dim"])
    counts = zip(report["num_simplices"], names, strict=True)
    rows = {
        "samples": f"{report['num_samples']:,}",
        "simplices": ", ".join(f"{count:,} {name}" for count, name in counts),
        "Euler characteristic": f"{report['euler_characteristic']:,}",
        "components": f"{report['components']:,}",
        **{name: yes_no[report[name]] for name in ("manifold", "closed", "orientable")},
        f"open {names[-2]}": f"{report['num_open_faces']:,}",
        "tiles": f"{report['tiles']:,}, {report['tiles_again']:,} run again",
        "work": report["work"],
        "seconds": f"{report['seconds']:.1f}",
    }
    for name, stage in report["stages"].items():
        known = f", {stage['known']:,} known before" if stage["known"] else ""
        rows[f"  {name}"] = (
            f"{stage['seconds']:.1f} s, {stage['tasks']:,} tasks{known}, "
            f"{stage['bytes'] / 2**20:,.1f} MiB"
        )
    return rows_table(rows)
