# SPDX-License-Identifier: GPL-3.0-or-later
"""Real models beside the meshes that their samples were taken from.

    REMANIFOLD_DATA=folder python benchmarks/real_models.py
    REMANIFOLD_DATA=folder python benchmarks/real_models.py bunny skull --markdown

The folder holds archives of NumPy's with ``points`` and, of those that are vertices of a
mesh, ``faces``, by which the truth is counted. Default settings unless said.
"""

from __future__ import annotations

import os
import time
import warnings
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

import remanifold as rm
from command import MarkdownOption, make_app

app = make_app()


class Model(NamedTuple):
    """Samples, their dimension, and whose mesh they are from where not their own."""

    name: str
    file: str
    dim: int = 2
    mesh: str | None = None
    options: dict[str, Any] = {}  # noqa: RUF012  never changed


BUNNY = "surface_stanford_bunny_vertices"
SPOT = "surface_spot_cow_vertices"
ROCKER_ARM = "surface_rocker_arm_genus1_vertices"
MODELS = (
    Model("Spot, vertices", SPOT),
    Model("Spot, evenly resampled", "surface_spot_cow_poisson6k", mesh=SPOT),
    Model("rocker arm, vertices", ROCKER_ARM),
    Model("rocker arm, even", "surface_rocker_arm_genus1_poisson10k", mesh=ROCKER_ARM),
    Model(
        "rocker arm, at random",
        "surface_rocker_arm_genus1_uniform10k",
        mesh=ROCKER_ARM,
    ),
    Model("Blub, vertices", "surface_fish_blub_vertices"),
    Model("wing nut with sharp creases, vertices", "surface_wingnut_creases_vertices"),
    Model("human, vertices", "surface_human_vertices"),
    Model("terrain, vertices", "terrain_mountain_disc_vertices"),
    Model("Stanford bunny, vertices", BUNNY),
    Model("Stanford bunny, at random", "surface_stanford_bunny_uniform12k", mesh=BUNNY),
    Model("surface with seven holes, vertices", "boundary_seven_holes_vertices"),
    Model("solid bunny, vertices", "solid_bunny_tetrahedra_K3_in_R3", 3),
    Model(
        "coastlines, vertices, closed",
        "curve_coastline_british_isles_in_R2",
        1,
        options={"boundary": False},
    ),
    Model("contour lines, vertices", "curve_contours_350m_in_R2", 1),
    Model("skull with thin sheets, vertices", "surface_skull_genus2_vertices"),
)


def described(topology: rm.Topology) -> str:
    """What a complex is, and the number that tells it from others of its kind."""
    return (
        f"{topology.description}; Euler characteristic {topology.euler_characteristic}"
    )


@app.command()
def main(
    names: Annotated[
        list[str] | None, typer.Argument(help="Parts of the names of some models.")
    ] = None,
    markdown: MarkdownOption = False,
) -> None:
    """Reconstruct and compare."""
    where = os.environ.get("REMANIFOLD_DATA")
    if not where:
        typer.echo("REMANIFOLD_DATA names no folder with the models", err=True)
        raise typer.Exit(2)
    rows = []
    for model in MODELS:
        if names and not any(part in model.name for part in names):
            continue
        with np.load(Path(where) / f"{model.file}.npz") as data:
            points = data["points"]
        with np.load(Path(where) / f"{model.mesh or model.file}.npz") as data:
            truth = rm.compute_topology(data["faces"], len(data["points"]))
        start = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rm.RemanifoldWarning)
            rec = rm.reconstruct(points, model.dim, **model.options)
        seconds = time.perf_counter() - start
        found = rec.topology()
        right = described(found) == described(truth)
        rows.append(
            (
                model.name,
                f"{len(points):,}",
                described(found),
                "the same" if right else described(truth),
                "quiet" if rec.quality.ok else "doubts",
                f"{seconds:.2g}",
            )
        )
    if markdown:
        head = ("samples", "N", "result", "true", "verdict", "seconds")
        typer.echo(f"| {' | '.join(head)} |\n|---|---:|---|---|---|---:|")
        for row in rows:
            typer.echo(f"| {' | '.join(row)} |")
        return
    table = Table(*("samples", "N", "result", "true", "verdict", "seconds"))
    for row in rows:
        table.add_row(*row)
    Console().print(table)


if __name__ == "__main__":
    app()
