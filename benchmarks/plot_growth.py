# SPDX-License-Identifier: GPL-3.0-or-later
"""Time a sample over the number of samples, drawn from results of side_by_side.py.

python benchmarks/plot_growth.py RESULTS.json -o docs/figures/side_by_side.svg
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import matplotlib as mpl
import typer

from command import make_app
from peers import PEERS
from report import CPU_HELP, load, median, title_of

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib import ticker

# Colors of Okabe and Ito, which the colour-blind can tell apart, and markers besides.
STYLES = {
    "manifold": ("#000000", "o", "-"),
    "paper": ("#000000", "o", ":"),
    "flann": ("#777777", "", "--"),
    "gudhi": ("#009E73", "s", "-"),
    "gudhi_perturbed": ("#009E73", "s", ":"),
    "advancing_front": ("#D55E00", "^", "-"),
    "scale_space": ("#D55E00", "v", ":"),
    "delaunay": ("#E69F00", "<", "-"),
    "open3d_ball_pivoting": ("#0072B2", "D", "-"),
    "open3d_poisson": ("#56B4E9", "P", "-"),
    "pymeshlab_ball_pivoting": ("#CC79A7", "X", "-"),
}

app = make_app()


def curves(cases: list[dict[str, Any]], field: str) -> dict[str, list[Any]]:
    """(samples, value, right) of what is done, by peer."""
    found: dict[str, list[Any]] = {}
    for case in sorted(cases, key=lambda case: case["num_samples"]):
        count = case["num_samples"]
        for name, record in case["peers"].items():
            value = median(record[field])
            if record["ending"] != "done" or value is None:
                continue
            value *= 1e6 / count if field == "seconds" else 1
            right = record["right"] is not False
            found.setdefault(name, []).append((count, value, right))
    return found


def draw(axes: Any, cases: list[dict[str, Any]], field: str) -> None:
    for name, points in curves(cases, field).items():
        color, marker, line = STYLES[name]
        counts, values, _ = zip(*points, strict=True)
        axes.plot(
            *(counts, values),
            color=color,
            linestyle=line,
            linewidth=2.2 if name == "manifold" else 1.4,
            label=PEERS[name].label,
        )
        for count, value, right in points:
            axes.plot(
                *(count, value),
                color=color,
                marker=marker,
                markersize=6,
                markerfacecolor=color if right else "white",
            )
    axes.set(xscale="log", yscale="log", xlabel="samples")
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda y, _: f"{y:g}"))
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:,.0f}"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


@app.command()
def main(
    results: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False)],
    output: Annotated[Path, typer.Option("--output", "-o", dir_okay=False)],
    shape: Annotated[str, typer.Option(help="Which shape.")] = "torus",
    order: Annotated[str, typer.Option(metavar="[random|morton]")] = "random",
    cpu: Annotated[bool, typer.Option("--cpu", help=CPU_HELP)] = False,
) -> None:
    """Draw how time grows with the number of samples, peer by peer."""
    reports = [load(file, cpu) for file in results]
    cases = [
        case
        for report in reports
        for case in report["cases"]
        if (case["shape"], case["order"], case["noise"]) == (shape, order, 0.0)
    ]
    if not cases:
        msg = f"no results for {shape} in {order} order without noise."
        raise typer.BadParameter(msg)
    # The same bytes from the same results, and no trace of when they were drawn.
    mpl.rcParams.update({"svg.hashsalt": "remanifold", "font.size": 10})
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    draw(left, cases, "seconds")
    left.set_ylabel(f"microseconds{' of CPU time' if cpu else ''} a sample")
    draw(right, cases, "ratios")
    right.set_ylabel("multiples of FLANN's search for 20 neighbors")
    figure.suptitle(f"{title_of(cases[0])}; hollow: wrong result", fontsize=11)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False)
    output.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"Date": None} if output.suffix == ".svg" else None
    figure.savefig(output, dpi=120, metadata=metadata)


if __name__ == "__main__":
    app()
