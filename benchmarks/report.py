# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of results of side_by_side.py.

    python benchmarks/report.py RESULTS.json [MORE.json..]
    python benchmarks/report.py RESULTS.json --cpu
    python benchmarks/report.py RESULTS.json --into docs/benchmarks.md

The last puts them into a text, between the lines `<!-- side by side -->` and
`<!-- end of side by side -->`.
"""

from __future__ import annotations

import copy
import itertools
import json
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from command import make_app
from peers import PEERS, UNIT

HEADS = ("", "samples", "seconds", "min to max", "× FLANN", "bytes a sample", "result")
CPU_HELP = (
    "CPU time instead of wall time: on one thread the same on an idle machine, and hardly "
    "changed by others on a busy one."
)
REASONS = 2  # that a table has room for
WIDTH = 160  # where there is no terminal
BEGIN, END = "<!-- side by side -->", "<!-- end of side by side -->"

app = make_app()


def load(file: Path, cpu: bool = False) -> dict[str, Any]:
    report = json.loads(file.read_text(encoding="utf-8"))
    return by_cpu(report) if cpu else report


def by_cpu(report: dict[str, Any]) -> dict[str, Any]:
    """The report as if CPU time had been measured instead of wall time."""
    report = copy.deepcopy(report)
    report["clock"] = "CPU"
    for case in report["cases"]:
        unit = case["peers"].get(UNIT, {}).get("cpu_seconds", [])
        for record in case["peers"].values():
            record["seconds"] = record["cpu_seconds"]
            pairs = itertools.zip_longest(record["seconds"], unit)  # round by round
            record["ratios"] = [a / b if b else None for a, b in pairs if a is not None]
    return report


def median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return statistics.median(known) if known else None


def cells(name: str, count: int, record: dict[str, Any], limit: float) -> list[str]:
    seconds = record["seconds"]
    ratio, size = median(record["ratios"]), median(record["bytes_per_sample"])
    if record["ending"] == "timeout":
        time, spread = f"> {limit:g}", ""
    elif seconds:
        time = _short(statistics.median(seconds))
        spread = f"{_short(min(seconds))} to {_short(max(seconds))}"
    else:
        time = spread = ""
    done = record["ending"] == "done"
    return [
        PEERS[name].label,
        f"{count:,}",
        time,
        spread,
        "" if ratio is None or not done else f"{ratio:.1f}",
        "" if size is None or not done else f"{size:,.0f}",
        result_of(record),
    ]


def result_of(record: dict[str, Any]) -> str:
    if record["right"]:
        return "right"
    reasons = record["reasons"]
    text = "; ".join(reasons[:REASONS]) + ("; .." if len(reasons) > REASONS else "")
    return f"wrong: {text}" if record["right"] is False else text


def _short(seconds: float) -> str:
    digits = 0 if seconds >= 100 else 1 if seconds >= 10 else 2 if seconds >= 1 else 3
    return f"{seconds:.{digits}f}"


def title_of(case: dict[str, Any]) -> str:
    where = f"K = {case['dim']} in R^{case['ambient_dim']}"
    noise = f", noise {case['noise']:g}" if case["noise"] else ""
    return f"{case['shape']}, {where}, {case['order']} order{noise}"


def tables(reports: Sequence[dict[str, Any]]) -> dict[str, list[list[str]]]:
    """Lines by title."""
    result: dict[str, list[list[str]]] = {}
    for report in reports:
        for case in report["cases"]:
            lines = result.setdefault(title_of(case), [])
            lines += [
                cells(name, case["num_samples"], record, report["time_limit"])
                for name, record in case["peers"].items()
            ]
    return result


def notes(reports: Sequence[dict[str, Any]]) -> list[str]:
    report = reports[0]
    packages = ", ".join(f"{name} {v}" for name, v in report["versions"].items())
    computer, count = report["machine"], report["threads"]
    threads = f"{count} thread{'s' * (count > 1)}, median of {report['repeat']}"
    if "clock" in report:
        threads += f", {report['clock']} time"
    where = f"{computer['cpu']}, {computer['cores']} cores, {report['date'][:10]}"
    lines = [f"{where}; {threads}, limit {report['time_limit']:g} s; {packages}."]
    left_out = {k: v for report in reports for k, v in report["left_out"].items()}
    for name, reason in left_out.items():
        lines.append(f"left out: {PEERS[name].label} ({name}): {reason}")
    return lines


def print_report(reports: Sequence[dict[str, Any]], markdown: bool) -> None:
    if markdown:
        typer.echo(markdown_of(reports))
        return
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = WIDTH
    for title, lines in tables(reports).items():
        console.print(title, markup=False)
        table = Table(box=None, pad_edge=False)
        for i, head in enumerate(HEADS):
            table.add_column(
                head,
                justify="left" if i in (0, len(HEADS) - 1) else "right",
                no_wrap=i + 1 < len(HEADS),
            )
        for line in lines:
            table.add_row(*line)
        console.print(table)
        console.print()
    for line in notes(reports):
        console.print(line, markup=False, soft_wrap=True)


def markdown_of(reports: Sequence[dict[str, Any]]) -> str:
    parts = []
    for title, lines in tables(reports).items():
        rows = [list(HEADS), ["---", *["---:"] * (len(HEADS) - 2), "---"], *lines]
        text = "\n".join(f"| {' | '.join(row)} |" for row in rows)
        parts.append(f"**{title}**\n\n{text}")
    return "\n\n".join([*parts, *notes(reports)])


@app.command()
def main(
    results: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False)],
    into: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Text to put the tables into."),
    ] = None,
    cpu: Annotated[bool, typer.Option("--cpu", help=CPU_HELP)] = False,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the tables in Markdown.")
    ] = False,
) -> None:
    """Print the tables of results again."""
    reports = [load(file, cpu) for file in results]
    if into is None:
        print_report(reports, markdown)
        return
    text = into.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        msg = f"{into} does not have the lines {BEGIN} and {END} once each."
        raise typer.BadParameter(msg, param_hint="'--into'")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    middle = f"{BEGIN}\n\n{markdown_of(reports)}\n\n{END}"
    into.write_text(before + middle + after, encoding="utf-8")


if __name__ == "__main__":
    app()
