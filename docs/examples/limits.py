# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the paper's method ends: noise, boundaries, three dimensions.

    python docs/examples/limits.py

Prints the numbers of docs/limits.md.
"""

import numpy as np

import remanifold as rm
from remanifold import datasets

COLUMNS = "{:31} {:>7} {:>9} {:>18} {:>9} {:>8} {:>9} {:>6}"


def show(label, points, dim):
    rec = rm.reconstruct(points, dim, method="paper")
    topology, repair = rec.topology(), rec.repair
    row = (
        label,
        len(points),
        len(rec.simplices),
        " ".join(map(str, topology.betti_numbers)),
        "yes" if topology.manifold else "no",
        int(rec.boundary.sum()),
        len(repair.callous_faces),
        len(repair.unused_vertices),
    )
    print(COLUMNS.format(*row), flush=True)


def even(name, count, **options):
    dense = datasets.SHAPES[name].generate(20 * count, random_state=0, **options)
    return datasets.spread(dense, count, random_state=0)


def main():
    heads = ["simplices", "Betti numbers", "manifold", "boundary", "callouses"]
    print(COLUMNS.format("", "samples", *heads, "unused"))

    torus = datasets.figure_samples(8)[:1080]
    spacing = np.median(rm.neighborhoods(torus, 1).distances)
    for noise in (0.0, 0.05, 0.1, 0.25, 0.5):
        noisy = datasets.add_noise(torus, noise * spacing, random_state=1)
        show(f"torus, noise {noise} of the spacing", noisy, 2)
    for name in ("moebius_band", "annulus", "swiss_roll", "spherical_cap"):
        show(f"{name}, evenly", even(name, 1500), 2)
    for name in ("klein_bottle", "projective_plane"):
        points = datasets.SHAPES[name].generate(2000, random_state=0)
        show(f"{name}, at random", points, 2)
    show("flat 3-torus in R^6, evenly", even("flat_torus", 4000, dim=3), 3)
    rotations = datasets.rotations(3000, random_state=0)
    show("SO(3) in R^9, at random", rotations, 3)


if __name__ == "__main__":
    main()
