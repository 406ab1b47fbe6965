# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 3 to 9 of Freedman (2002): samples beside their reconstruction.

    python docs/examples/paper_figures.py [FOLDER] [--figures 3 9]

Draws ``figure_3.png`` to ``figure_9.png`` and prints what each reconstruction is.
Triangles with two callous edges, as in a square with both diagonals, are red; the rims
of holes are blue.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import remanifold as rm
from drawing import draw_points, draw_simplices, save
from remanifold import datasets

FOLDER = Path(__file__).resolve().parents[1] / "figures"
COLUMNS = "{:>6} {:34} {:>7} {:>7} {:>9} {:>10} {:>9} {:>8} {:>9} {:>5}"


@dataclass(frozen=True)
class Figure:
    title: str
    view: tuple[float, float] = (0.0, 0.0)  # azimuth and elevation in degrees
    point_size: float = 4.0
    edges: tuple[str, ...] = ("mutual",)
    size: tuple[float, float] = (8.0, 4.0)


TABLE = {
    3: Figure("a simple curve in the plane", point_size=9.0),
    4: Figure("a disconnected curve in the plane", point_size=6.0, size=(10.0, 3.6)),
    5: Figure("a spiral", point_size=6.0),
    6: Figure("interlocking circles", (-65.0, 25.0), point_size=9.0),
    7: Figure("the fruit bowl", (-80.0, 42.0), size=(10.0, 4.0)),
    8: Figure("interlocking tori", (-60.0, 35.0), size=(10.0, 4.0)),
    9: Figure(
        "failure of the algorithm",
        (-60.0, 40.0),
        edges=("mutual", "either"),
        size=(12.0, 3.2),
    ),
}


def draw(number, folder):
    """Reconstruct and draw one figure; print a line for each edge rule."""
    figure = TABLE[number]
    shape = datasets.SHAPES[datasets.FIGURES[number]]
    points = datasets.figure_samples(number)
    picture, panels = plt.subplots(
        1, 1 + len(figure.edges), figsize=figure.size, layout="constrained"
    )
    draw_points(panels[0], points, figure.view, figure.point_size)
    for axes, edges in zip(panels[1:], figure.edges, strict=True):
        rec = rm.reconstruct(points, shape.dim, method="paper", edges=edges)
        topology, repair = rec.topology(), rec.repair
        draw_simplices(
            axes,
            points,
            rec.simplices,
            figure.view,
            alarm=count_faces(repair.callous_faces, rec.simplices) > 1,
            gaps=repair.open_faces if shape.dim == 2 else None,
        )
        print(
            COLUMNS.format(
                number,
                figure.title,
                edges,
                len(points),
                len(rec.simplices),
                f"{topology.components} ({shape.components})",
                f"{topology.euler_characteristic} ({shape.euler_characteristic})",
                int(rec.boundary.sum()),
                len(repair.callous_faces),
                repair.num_holes,
            ),
            flush=True,
        )
    save(picture, folder / f"figure_{number}.png")


def count_faces(faces, simplices):
    """Count how many of the faces each simplex has."""
    known = set(map(tuple, faces.tolist()))
    counts = np.zeros(len(simplices), dtype=int)
    for left_out in range(simplices.shape[1]):
        of_simplices = np.delete(simplices, left_out, axis=1).tolist()
        counts += [tuple(face) in known for face in of_simplices]
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument(
        "--figures", nargs="+", type=int, choices=TABLE, default=[*TABLE]
    )
    arguments = parser.parse_args()
    heads = ["figure", "", "edges", "samples", "simplices", "components", "Euler"]
    print(COLUMNS.format(*heads, "boundary", "callouses", "holes"))
    for number in arguments.figures:
        draw(number, arguments.folder)


if __name__ == "__main__":
    main()
