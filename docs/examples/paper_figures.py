# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 3 to 9 of Freedman (2002): samples beside their reconstruction.

    python docs/examples/paper_figures.py [FOLDER] [--figures 3 9]

Draws ``figure_3.png`` to ``figure_9.png`` and prints what each reconstruction is.
Except for the regular grid of figure 9 the samples are spread evenly: the paper asks
for dense samples without noise, and random ones leave gaps.
"""

import argparse
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from drawing import draw_points, draw_simplices, save

import remanifold as rm
from remanifold import datasets

FIGURES = Path(__file__).resolve().parents[1] / "figures"


@dataclass(frozen=True)
class Figure:
    title: str
    num_samples: int
    view: tuple[float, float] = (0.0, 0.0)  # azimuth and elevation in degrees
    point_size: float = 4.0


TABLE = {
    3: Figure("a simple curve in the plane", 90, point_size=14.0),
    4: Figure("a disconnected curve in the plane", 130, point_size=14.0),
    5: Figure("a spiral", 220, point_size=14.0),
    6: Figure("interlocking circles", 120, (-65.0, 25.0), point_size=14.0),
    7: Figure("the fruit bowl", 4000, (-80.0, 38.0)),
    8: Figure("interlocking tori", 2400, (-60.0, 35.0)),
    9: Figure("failure of the algorithm", 960, (-60.0, 40.0), point_size=6.0),
}


def sample(number):
    """Samples of a figure, the same in every run."""
    shape = datasets.SHAPES[datasets.FIGURES[number]]
    figure = TABLE[number]
    if number == 9:
        return shape, shape.generate(figure.num_samples, jitter=0.02, random_state=0)
    dense = shape.generate(20 * figure.num_samples, random_state=0)
    return shape, datasets.spread(dense, figure.num_samples, random_state=0)


def draw(number, folder):
    """Reconstruct one figure, draw it and return its line of the table."""
    shape, points = sample(number)
    rec = rm.reconstruct(points, shape.dim, method="paper")
    topology, repair = rec.topology(), rec.repair

    figure = TABLE[number]
    size = (8, 4) if points.shape[1] == 2 else (9, 4)
    picture, (left, right) = plt.subplots(1, 2, figsize=size, layout="constrained")
    draw_points(left, points, figure.view, figure.point_size)
    draw_simplices(
        right, points, rec.simplices, figure.view, alarm=_alarm(rec.simplices, repair)
    )
    save(picture, folder / f"figure_{number}.png")
    return (
        number,
        figure.title,
        len(points),
        len(rec.simplices),
        f"{topology.components} ({shape.components})",
        f"{topology.euler_characteristic} ({shape.euler_characteristic})",
        int(rec.boundary.sum()),
        len(repair.callous_faces),
        repair.num_holes,
    )


def _alarm(simplices, repair):
    """Which simplices have a callous face."""
    callous = {tuple(face) for face in repair.callous_faces}
    faces = partial(np.delete, axis=0)
    return np.array(
        [
            any(tuple(faces(simplex, i)) in callous for i in range(len(simplex)))
            for simplex in simplices
        ],
        dtype=bool,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=FIGURES)
    parser.add_argument(
        "--figures", nargs="+", type=int, choices=TABLE, default=[*TABLE]
    )
    arguments = parser.parse_args()
    heads = ["figure", "", "samples", "simplices", "components (true)"]
    heads += ["Euler characteristic (true)", "boundary", "callouses", "holes"]
    print("|".join(heads))
    for number in arguments.figures:
        print("|".join(map(str, draw(number, arguments.folder))), flush=True)


if __name__ == "__main__":
    main()
