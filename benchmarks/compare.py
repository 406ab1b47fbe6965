# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether results of side_by_side.py are worse than older ones.

    python benchmarks/compare.py OLD.json NEW.json --threshold 1.15

Compared are ratios to FLANN's search of the same round, which hold across machines far
better than seconds, memory, correctness and the digests of the simplices. The exit code
is 1 if anything got worse, 2 if there is nothing to compare.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from command import make_app
from peers import OWN, PEERS
from report import CPU_HELP, load, median

KEY = ("shape", "num_samples", "order", "noise", "seed")

app = make_app()


@dataclass(frozen=True)
class Rules:
    threshold: float
    seconds: bool = False
    digests: bool = True


@dataclass(frozen=True)
class Line:
    what: str
    old: str
    new: str
    verdict: str
    worse: bool


def records(report: dict[str, Any], names: tuple[str, ...]) -> dict[Any, Any]:
    """Records by case and peer, those without a measurement left out."""
    return {
        (*(case[field] for field in KEY), report["threads"], name): record
        for case in report["cases"]
        for name, record in case["peers"].items()
        if name in names and record["ending"] != "skipped"
    }


def compared(old: dict[str, Any], new: dict[str, Any], rules: Rules) -> Iterator[Line]:
    """What there is to say about two records of the same case and peer."""
    worse = old["right"] is True and new["right"] is not True
    if worse or old["right"] != new["right"]:
        verdict = "lost" if worse else "gained" if new["right"] else "changed"
        yield Line("result", _result(old), _result(new), verdict, worse)
    elif old["ending"] == "done" != new["ending"]:
        yield Line("result", old["ending"], new["ending"], "lost", True)
    if old["ending"] != "done" or new["ending"] != "done":
        return
    measures = [("× FLANN", "ratios"), ("bytes a sample", "bytes_per_sample")]
    if rules.seconds and median(old["ratios"]) is None:
        measures[0] = ("seconds", "seconds")
    for what, field in measures:
        before, after = median(old[field]), median(new[field])
        if before is None or after is None:
            continue
        growth = after / before if before > 0 else float(after > 0) + 1
        worse = growth > rules.threshold
        better = growth < 1 / rules.threshold
        verdict = "grew" if worse else "shrank" if better else "same"
        yield Line(
            what, f"{before:,.4g}", f"{after:,.4g}", f"{verdict}, × {growth:.2f}", worse
        )
    if rules.digests and old["digests"] != new["digests"]:
        digests = (" ".join(record["digests"]) for record in (old, new))
        yield Line("digest", *digests, "changed", True)


def _result(record: dict[str, Any]) -> str:
    words = {True: "right", False: "wrong", None: "unknown"}
    return "; ".join([words[record["right"]], *record["reasons"][:1]])


@app.command()
def main(
    old: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    new: Annotated[Path, typer.Argument(exists=True, dir_okay=False)],
    threshold: Annotated[
        float, typer.Option(min=1, help="Growth that is not yet worse.")
    ] = 1.15,
    seconds: Annotated[
        bool,
        typer.Option(
            "--seconds", help="Compare seconds where FLANN was not measured (high D)."
        ),
    ] = False,
    ignore_digests: Annotated[
        bool, typer.Option("--ignore-digests", help="Other simplices are no matter.")
    ] = False,
    cpu: Annotated[bool, typer.Option("--cpu", help=CPU_HELP)] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="All peers, not only remanifold.")
    ] = False,
) -> None:
    """Compare two files of results; the exit code is 1 if anything got worse."""
    names = tuple(PEERS) if peers else OWN
    before, after = (records(load(file, cpu), names) for file in (old, new))
    rules = Rules(threshold, seconds, not ignore_digests)
    common = [key for key in before if key in after]
    if not common:
        typer.echo("no case in common", err=True)
        raise typer.Exit(2)
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = 140
    table = Table(box=None, pad_edge=False)
    for head in ("case", "", "", "old", "new", "verdict"):
        table.add_column(head, no_wrap=True)
    worse = 0
    for key in common:
        shape, count, order, noise, _, _, name = key
        case = f"{shape} {count:,} {order}{f' noise {noise:g}' if noise else ''}"
        for line in compared(before[key], after[key], rules):
            worse += line.worse
            style = "red" if line.worse else None
            cells = (case, name, line.what, line.old, line.new, line.verdict)
            table.add_row(*cells, style=style)
    console.print(table)
    for text, left in (("new", before.keys() - after), ("old", after.keys() - before)):
        if left:
            cases = ", ".join(sorted(f"{k[0]} {k[1]:,} {k[2]} {k[-1]}" for k in left))
            console.print(f"not in the {text} results: {cases}", markup=False)
    console.print(f"{worse} worse" if worse else "nothing worse")
    raise typer.Exit(1 if worse else 0)


if __name__ == "__main__":
    app()
