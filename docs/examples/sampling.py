# SPDX-License-Identifier: GPL-3.0-or-later
"""How the paper's method depends on where the samples lie.

    python docs/examples/sampling.py [--seeds 10] [--estimator jet]

The same numbers of samples of the same manifolds, once drawn at random and once spread
evenly (farthest points of twenty times as many). Prints in how many runs the result is
a manifold with the right Betti numbers, and what is wrong on average.
"""

import argparse

import numpy as np

import remanifold as rm
from remanifold import datasets

SIZES = {
    "planar_curve": 120,
    "planar_curves": 320,
    "spiral": 320,
    "interlocking_circles": 120,
    "sphere": 800,
    "torus": 3000,
    "interlocking_tori": 2160,
    "fruit_bowl": 3338,
}
COLUMNS = "{:21} {:>7} {:7} {:>8} {:>9} {:>8} {:>10}"


def run(name, placed, seed, estimator):
    """Whether one run is right, its boundary samples, holes and callous faces."""
    shape, count = datasets.SHAPES[name], SIZES[name]
    if placed == "even":
        dense = shape.generate(20 * count, random_state=seed)
        points = datasets.spread(dense, count, random_state=seed)
    else:
        points = shape.generate(count, random_state=seed)
    rec = rm.reconstruct(points, shape.dim, method="paper", estimator=estimator)
    topology = rec.topology()
    right = topology.manifold and topology.betti_numbers == shape.betti_numbers
    repair = rec.repair
    return right, rec.boundary.sum(), repair.num_holes, len(repair.callous_faces)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--shapes", nargs="+", choices=SIZES, default=[*SIZES])
    parser.add_argument("--estimator", default="enclosure")
    arguments = parser.parse_args()
    heads = ["right", "boundary", "holes", "callouses"]
    print(COLUMNS.format("shape", "samples", "placed", *heads))
    for name in arguments.shapes:
        for placed in ("random", "even"):
            runs = [
                run(name, placed, seed, arguments.estimator)
                for seed in range(arguments.seeds)
            ]
            right, *means = np.array(runs, dtype=float).T
            print(
                COLUMNS.format(
                    name,
                    SIZES[name],
                    placed,
                    f"{right.sum():.0f}/{len(runs)}",
                    *(f"{mean.mean():.1f}" for mean in means),
                ),
                flush=True,
            )


if __name__ == "__main__":
    main()
