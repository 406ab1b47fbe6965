# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the methods end: noise, boundaries, three dimensions, thin and sharp shapes.

    python docs/examples/limits.py

Prints the tables of docs/limits.md.
"""

import warnings

import numpy as np

import remanifold as rm
from remanifold import datasets

SEEDS = 10


def row(*cells):
    print("|", " | ".join(map(str, cells)), "|", flush=True)


def show(label, points, dim):
    """A line for each method."""
    for method in ("paper", "manifold"):
        rec = rm.reconstruct(points, dim, method=method)
        topology, repair = rec.topology(), rec.repair
        row(
            label if method == "paper" else "",
            method,
            f"{len(rec.simplices):,}",
            ", ".join(f"{b:,}" for b in topology.betti_numbers),
            "yes" if topology.manifold else "no",
            repair.num_holes + repair.num_boundary_components,
            f"{len(repair.callous_faces):,}",
            len(repair.unused_vertices),
        )


def even(name, count, **options):
    dense = datasets.SHAPES[name].generate(20 * count, random_state=0, **options)
    return datasets.spread(dense, count, random_state=0)


def how_often(label, draw, dim, betti_numbers, **options):
    """In how many of the runs both methods are right."""
    cells = []
    for method in ("paper", "manifold"):
        right = 0
        for seed in range(SEEDS):
            rec = rm.reconstruct(draw(seed), dim, method=method, **options)
            topology = rec.topology()
            right += topology.manifold and topology.betti_numbers == betti_numbers
        cells.append(f"{right} of {SEEDS}")
    row(label, *cells)


def two_spheres(spacings, seed):
    """Concentric spheres, so many spacings apart."""
    count = 1000
    inner = 1 - spacings * np.sqrt(4 * np.pi / (count / 2))
    points = datasets.sphere(count, random_state=seed)
    points[: count // 2] *= inner
    return points


def star(tips, depth, count, seed):
    """A polygon with sharp corners outside and blunt ones inside."""
    angles = np.pi * np.arange(2 * tips + 1) / tips
    radii = np.where(np.arange(2 * tips + 1) % 2 == 0, 1.0, depth)
    corners = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    place = 2 * tips * np.random.default_rng(seed).random(count)
    side = place.astype(int)
    share = (place - side)[:, None]
    return (1 - share) * corners[side] + share * corners[side + 1]


def tip_angle(tips, depth):
    inner = depth * np.array([np.cos(np.pi / tips), np.sin(np.pi / tips)])
    return 2 * np.degrees(np.arctan2(inner[1], 1 - inner[0]))


def main():
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    for count in (50, 75, 100, 150, 200):
        how_often(
            f"torus, {count} at random",
            lambda seed, n=count: datasets.torus(n, random_state=seed),
            2,
            (1, 2, 1),
        )
    for spacings in (3.0, 2.5, 2.0, 1.5):
        how_often(
            f"two spheres, {spacings:g} spacings apart",
            lambda seed, d=spacings: two_spheres(d, seed),
            2,
            (2, 0, 2),
        )
    for depth in (0.6, 0.4, 0.2):
        how_often(
            f"star of 200 samples, tips of {tip_angle(5, depth):.0f} degrees",
            lambda seed, d=depth: star(5, d, 200, seed),
            1,
            (1, 1),
        )

    torus = datasets.figure_samples(8)[:1080]
    spacing = np.median(rm.neighborhoods(torus, 1).distances)
    for noise in (0.0, 0.05, 0.1, 0.25, 0.5):
        noisy = datasets.add_noise(torus, noise * spacing, random_state=1)
        show(f"torus, 1,080 in staggered rows, noise {noise}", noisy, 2)
    for name in ("moebius_band", "annulus", "swiss_roll", "spherical_cap"):
        label = name.capitalize().replace("_", " ")
        show(f"{label}, 1,500 evenly", even(name, 1500), 2)
    klein = datasets.klein_bottle(2000, random_state=0)
    show("Klein bottle in R^4, 2,000 at random", klein, 2)
    plane = datasets.projective_plane(2000, random_state=0)
    show("Projective plane in R^5, 2,000 at random", plane, 2)
    show("Flat 3-torus in R^6, 4,000 evenly", even("flat_torus", 4000, dim=3), 3)
    rotations = datasets.rotations(3000, random_state=0)
    show("SO(3) in R^9, 3,000 at random", rotations, 3)


if __name__ == "__main__":
    main()
