# SPDX-License-Identifier: GPL-3.0-or-later
"""How often what is no manifold is found, and how often a manifold raises an alarm.

    python docs/examples/not_a_manifold.py

Prints the tables of docs/not_a_manifold.md and draws its picture.
"""

import sys
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import remanifold as rm
from drawing import ALARM_COLOR, draw_points, project, save
from remanifold import datasets

SEEDS = 10
FIGURES = Path(__file__).resolve().parents[1] / "figures"
T_SHAPE = (0.0, np.pi / 2, np.pi)
EIGHT, BALLS, PAGES = datasets.figure_eight, datasets.crossing_balls, datasets.branching
T_OF_LINES = partial(PAGES, angles=T_SHAPE)


def row(*cells):
    print("|", " | ".join(map(str, cells)), "|", flush=True)


def even(draw, count, random_state):
    """Samples spread evenly."""
    dense = draw(20 * count, random_state=random_state)
    return datasets.spread(dense, count, random_state=random_state)


def turned(degrees):
    return partial(BALLS, angle=np.radians(degrees))


def eight(degrees):
    return partial(EIGHT, angle=np.radians(degrees))


def noisy(draw, count, random_state):
    points = draw(count, random_state=random_state)
    spacing = np.median(rm.neighborhoods(points, 1).distances)
    return datasets.add_noise(points, 0.5 * spacing, random_state=random_state)


FOUND = (
    ("figure eight, 90 degrees", eight(90), 1, (150, 600)),
    ("figure eight, 60 degrees", eight(60), 1, (150, 600)),
    ("figure eight, 30 degrees", eight(30), 1, (150, 600)),
    ("figure eight, spread evenly", partial(even, EIGHT), 1, (150, 600)),
    ("Y of lines", PAGES, 1, (150, 600)),
    ("T of lines", T_OF_LINES, 1, (150, 600)),
    ("T of lines, spread evenly", partial(even, T_OF_LINES), 1, (150, 600)),
    ("two discs, 90 degrees", turned(90), 2, (1000, 4000)),
    ("two discs, 60 degrees", turned(60), 2, (1000, 4000)),
    ("two discs, 45 degrees", turned(45), 2, (1000, 4000)),
    ("two discs, 30 degrees", turned(30), 2, (1000, 4000)),
    ("two discs with noise 0.5", partial(noisy, BALLS), 2, (1000, 4000)),
    ("three discs", partial(turned(60), num_sheets=3), 2, (1000, 4000)),
    ("three half discs", partial(PAGES, dim=2), 2, (1000, 4000)),
    ("T of discs", partial(PAGES, dim=2, angles=T_SHAPE), 2, (1000, 4000)),
    ("immersed Klein bottle", datasets.immersed_klein_bottle, 2, (4000, 16_000)),
    ("two discs in R^4", partial(BALLS, ambient_dim=4), 2, (1000, 4000)),
    ("double cone", datasets.double_cone, 2, (1000, 4000)),
    ("spindle torus", datasets.spindle_torus, 2, (4000, 16_000)),
    ("two balls in R^4", partial(BALLS, dim=3), 3, (4000,)),
    ("two balls in R^5", partial(BALLS, dim=3, ambient_dim=5), 3, (4000,)),
    ("two balls in R^6", partial(BALLS, dim=3, ambient_dim=6), 3, (4000,)),
    ("sphere with an antenna", datasets.sphere_with_antenna, 2, (1000, 4000)),
    ("solid ball on a disc", datasets.ball_on_disc, 2, (1000, 4000)),
    ("solid disc on a line", partial(datasets.ball_on_disc, dim=1), 1, (1000, 4000)),
)
# Numbers of samples from coarse to usual, by dimension.
LADDER = {1: (60, 120, 240, 480), 2: (300, 600, 1200, 2400), 3: (300, 800, 2000)}


def rates():
    row("samples of", "N", "found")
    row("---", "---:", "---:")
    for label, draw, dim, counts in FOUND:
        for count in counts:
            hits = sum(
                bool(rm.find_singularities(draw(count, random_state=s), dim).places)
                for s in range(SEEDS)
            )
            row(label, f"{count:,}", f"{hits} of {SEEDS}")


def alarms():
    row("manifolds of dimension", "sets", "alarms")
    row("---", "---:", "---:")
    for dim, counts in LADDER.items():
        shapes = [
            shape.generate
            for name, shape in datasets.SHAPES.items()
            if shape.dim == dim and not name.startswith("grid")
        ]
        for label, change in (("", None), (", noise 0.5", noisy)):
            fired = sets = 0
            for generate in shapes:
                draw = generate if change is None else partial(change, generate)
                for count in counts:
                    for seed in range(SEEDS):
                        points = draw(count, random_state=seed)
                        sets += 1
                        fired += bool(rm.find_singularities(points, dim).places)
            row(f"{dim}{label}", sets, fired)


def picture(path):
    """Samples of four sets; red where they are no manifold."""
    sets = (
        (EIGHT(200, random_state=3), 1, 14.0),
        (datasets.immersed_klein_bottle(8000, random_state=0), 2, 3.0),
        (datasets.sphere_with_antenna(2500, random_state=0), 2, 4.0),
        (datasets.ball_on_disc(2500, random_state=0), 2, 4.0),
    )
    view = (30, 35)
    figure, axes = plt.subplots(1, len(sets), figsize=(12, 3.2))
    for ax, (points, dim, size) in zip(axes, sets, strict=True):
        marked = rm.find_singularities(points, dim).kind > 0
        draw_points(ax, points, view, size=size)
        x, y, _ = project(points, view)[marked].T
        ax.scatter(x, y, s=2 * size, color=ALARM_COLOR, linewidths=0)
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    save(figure, path)


if __name__ == "__main__":
    picture(Path(sys.argv[1]) if len(sys.argv) > 1 else FIGURES / "not_a_manifold.png")
    if len(sys.argv) == 1:
        rates()
        print()
        alarms()
