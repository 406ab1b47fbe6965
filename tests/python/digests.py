# SPDX-License-Identifier: GPL-3.0-or-later
"""What reconstructions are to the byte, so that a change that means none makes none.

    python tests/python/digests.py            # compare with the recorded digests
    python tests/python/digests.py --record   # record them anew, which is a change of
                                              # results and a commit of its own
    python tests/python/digests.py --exact    # floating-point numbers to the byte too

Digests of integers hold on any machine. Floating-point results carry the last bits of
the machine's libm, so they are recorded as a checksum that is compared to nine digits;
--exact compares their bytes, for work on one machine.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import json
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import remanifold as rm

RECORDED = Path(__file__).with_name("data") / "digests.json"
# Largest relative change of a checksum that machines may differ by.
TOLERANCE = 1e-9

Case = Callable[[int], dict[str, Any]]
CASES: dict[str, Case] = {}


class Absent(Exception):
    """Data that this machine does not have."""


def rounded(points: np.ndarray) -> np.ndarray:
    """On a grid of 2^-24: the same samples whatever the last bits of sin and cos."""
    return np.round(np.asarray(points, dtype=float) * 2.0**24) / 2.0**24


def products_of(points: np.ndarray) -> dict[str, np.ndarray]:
    points = rounded(points)
    return {"gram": np.einsum("ik,jk->ij", points, points)}


def distances_of(points: np.ndarray) -> dict[str, np.ndarray]:
    points = rounded(points)
    difference = points[:, None] - points[None]
    return {"distances": np.sqrt(np.einsum("ijk,ijk->ij", difference, difference))}


def arrays_of(rec: rm.Reconstruction, quality: bool) -> dict[str, Any]:
    repair = rec.repair
    out: dict[str, Any] = {
        "simplices": rec.simplices,
        "boundary": rec.boundary,
        "representatives": rec.representatives,
        "outliers": rec.outliers,
        "open_faces": repair.open_faces,
        "hole_faces": repair.hole_faces,
        "callous_faces": repair.callous_faces,
        "unstarred_simplices": repair.unstarred_simplices,
        "singular_vertices": repair.singular_vertices,
        "unused_vertices": repair.unused_vertices,
        "disputed_simplices": repair.disputed_simplices,
        "filled_simplices": repair.filled_simplices,
        "inserted_vertices": repair.inserted_vertices,
        "counts": np.array(
            [
                repair.num_agreed,
                repair.num_boundary_components,
                repair.num_holes,
                repair.merged_samples,
                repair.num_unsolved,
            ]
        ),
        "hole_radius": np.array([repair.hole_radius]),
    }
    for name in ("vertices", "tangents", "edges", "tangent_simplices", "unbounded"):
        out[name] = getattr(rec, name)
    for name in ("edge_sets", "stars"):
        value = getattr(rec, name)
        for part, array in zip(("offsets", "rows"), value or (None, None), strict=True):
            out[f"{name}_{part}"] = array
    if rec.smoothing is not None and rec.smoothing.moved:
        out["noise"] = np.array([rec.smoothing.noise])
    if quality:
        for name in (
            *("spacing", "curvature", "reach", "sampling_ratio"),
            *("tangent_confidence", "disputed", "fold", "gap", "doubtful"),
        ):
            out[f"quality_{name}"] = getattr(rec.quality, name)
        out["quality_ok"] = np.array([rec.quality.ok])
    return {name: array for name, array in out.items() if array is not None}


def add(
    name: str,
    dim: int,
    make: Callable[[], Any],
    *,
    quality: bool = False,
    **options: Any,
) -> None:
    def run(num_threads: int) -> dict[str, Any]:
        data = make()
        given = data if isinstance(data, dict) else {"points": rounded(data)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rm.RemanifoldWarning)
            more = {k: v() if callable(v) else v for k, v in options.items()}
            rec = rm.reconstruct(**given, dim=dim, num_threads=num_threads, **more)
            return arrays_of(rec, quality)

    assert name not in CASES
    CASES[name] = run


def shape(name: str, num_samples: int, seed: int = 0, **options: Any):
    return lambda: getattr(rm.datasets, name)(num_samples, random_state=seed, **options)


def noisy(make: Callable[[], Any], noise: float, seed: int = 7):
    """Noise in units of the median distance to the nearest neighbor."""

    def run() -> np.ndarray:
        points = make()
        spacing = float(np.median(rm.neighborhoods(rounded(points), 1)[1]))
        return rm.datasets.add_noise(points, noise * spacing, random_state=seed)

    return run


def grid(*counts: int) -> np.ndarray:
    axes = np.meshgrid(*[np.arange(c, dtype=float) for c in counts], indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, len(counts))


def lattice_sphere() -> np.ndarray:
    steps = np.arange(-12, 13)
    points = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    radius = np.linalg.norm(points, axis=1)
    return points[np.abs(radius - 11) < 0.5].astype(float)


def with_copies() -> np.ndarray:
    points = rounded(rm.datasets.torus(600, random_state=3))
    return np.concatenate([points, points[::5], points[:7]])


def with_outliers() -> np.ndarray:
    rng = np.random.default_rng(5)
    points = rm.datasets.torus(1500, random_state=4)
    clutter = rng.uniform(-1.5, 1.5, (60, 3)) * np.abs(points).max()
    return np.concatenate([points, clutter])


def rim_mask() -> np.ndarray:
    points = rounded(rm.datasets.annulus(800, random_state=2))
    radius = np.linalg.norm(points[:, :2], axis=1)
    return (radius < np.quantile(radius, 0.12)) | (radius > np.quantile(radius, 0.88))


def raw_scan() -> np.ndarray:
    """Every eighth sample of the demo's scan, in units of its extent."""
    package = importlib.util.find_spec("pymeshlab")
    if package is None or package.origin is None:
        raise Absent("pymeshlab")
    folder = Path(package.origin).parent / "tests" / "sample_meshes" / "rangemaps"
    points = rm.io.read_points(folder / "face000.ply")[::8]
    points = points - points.mean(axis=0)
    return points / np.abs(points).max()


def shared(name: str, every: int = 1):
    def make() -> np.ndarray:
        default = Path(__file__).resolve().parents[3] / "shared" / "data"
        path = Path(os.environ.get("REMANIFOLD_DATA", default)) / f"{name}.npz"
        if not path.is_file():
            raise Absent(name)
        with np.load(path) as data:
            points = data["points"][::every]
        points = points - points.mean(axis=0)
        return points / np.abs(points).max()

    return make


for seed in range(3):
    add(f"torus_1000_{seed}", 2, shape("torus", 1000, seed), quality=seed == 0)
add("circle_200", 1, shape("circle", 200), quality=True)
add("trefoil_300", 1, shape("trefoil", 300))
add("spiral_200", 1, shape("spiral", 200))
add("planar_curves_500", 1, shape("planar_curves", 500))
add("interlocking_circles_300", 1, shape("interlocking_circles", 300))
add("circle_sparse_12", 1, shape("circle", 12))
add("sphere_2000", 2, shape("sphere", 2000))
add("sphere_60", 2, shape("sphere", 60), quality=True)
add("torus_10000", 2, shape("torus", 10_000), quality=True)
add("torus_40000", 2, shape("torus", 40_000))
add("double_torus_3000", 2, shape("double_torus", 3000))
add("klein_bottle_1500", 2, shape("klein_bottle", 1500), quality=True)
add("projective_plane_1000", 2, shape("projective_plane", 1000))
add("interlocking_tori_2000", 2, shape("interlocking_tori", 2000))
add("concentric_spheres_2000", 2, shape("concentric_spheres", 2000))
add("flat_torus_1000", 2, shape("flat_torus", 1000))
add("moebius_band_800", 2, shape("moebius_band", 800), quality=True)
add("annulus_800", 2, shape("annulus", 800))
add("swiss_roll_2000", 2, shape("swiss_roll", 2000))
add("spherical_cap_800", 2, shape("spherical_cap", 800))
add("ball_1500", 3, shape("ball", 1500))
add("bent_ball_1500", 3, shape("bent_ball", 1500), quality=True)
add("rotations_1000", 3, shape("rotations", 1000), quality=True)
add("flat_torus_3_1200", 3, shape("flat_torus", 1200, dim=3))
add("sphere_3_1000", 3, shape("sphere", 1000, dim=3))
add("sphere_times_circle_1200", 3, shape("sphere_times_circle", 1200))
add("sphere_4_400", 4, shape("sphere", 400, dim=4))
add("flat_torus_4_500", 4, shape("flat_torus", 500, dim=4))
add("sphere_times_sphere_500", 4, shape("sphere_times_sphere", 500))
add("grid_torus", 2, lambda: rm.datasets.grid_torus(288, num_around=24))
add("grid_plane_20x20", 2, lambda: grid(20, 20))
add("grid_line_50", 1, lambda: grid(50))
add("grid_cube_7", 3, lambda: grid(7, 7, 7))
add("grid_plane_in_space", 2, lambda: np.c_[grid(15, 15), np.zeros(225)])
add("lattice_sphere", 2, lattice_sphere)
add("copies", 2, with_copies, quality=True)
add("outliers_auto", 2, with_outliers, quality=True)
add("outliers_kept", 2, with_outliers, outliers=False)
add("outliers_far", 2, with_outliers, outliers=4.0)
torus = shape("torus", 2000, 9)
for level in (0.1, 0.3, 0.5):
    add(f"noise_{level}", 2, noisy(torus, level))
    add(f"noise_{level}_smooth", 2, noisy(torus, level), smooth="auto")
add("noise_klein_smooth", 2, noisy(shape("klein_bottle", 1500), 0.3), smooth=True)
add("noise_trefoil_smooth", 1, noisy(shape("trefoil", 500), 0.5), smooth="auto")
add("noise_rotations_smooth", 3, noisy(shape("rotations", 800), 0.3), smooth=40)
add("clean_smooth_auto", 2, torus, smooth="auto")
add("boundary_none", 2, shape("spherical_cap", 600), boundary=False)
add("boundary_given", 2, shape("annulus", 800, 2), boundary=rim_mask)
add("hole_radius_2", 2, shape("moebius_band", 400), hole_radius=2.0)
add("hole_radius_curve", 1, shape("spiral", 150), hole_radius=1.5)
add("num_neighbors_25", 2, torus, num_neighbors=25)
for estimator in ("pca", "enclosure"):
    add(f"estimator_{estimator}", 2, torus, estimator=estimator)
for search in ("kdtree", "brute_force"):
    add(f"search_{search}", 2, torus, search=search)
add(
    "in_100_coordinates",
    2,
    lambda: rm.datasets.embed(
        rm.datasets.torus(800, random_state=1), 100, random_state=2
    ),
)
add(
    "in_600_coordinates",
    2,
    lambda: rm.datasets.embed(
        rm.datasets.flat_torus(300, random_state=1), 600, random_state=2
    ),
)
add("gram_torus", 2, lambda: products_of(rm.datasets.torus(500, random_state=6)))
add(
    "gram_rotations",
    3,
    lambda: products_of(rm.datasets.rotations(400, random_state=6)),
    quality=True,
)
add(
    "gram_smooth",
    2,
    lambda: products_of(
        rm.datasets.add_noise(
            rm.datasets.torus(500, random_state=6), 0.3, random_state=1
        )
    ),
    smooth="auto",
)
add(
    "distances_torus",
    2,
    lambda: distances_of(rm.datasets.torus(500, random_state=6)),
    quality=True,
)
add(
    "distances_circle", 1, lambda: distances_of(rm.datasets.circle(100, random_state=6))
)
for name, dim, make in (
    ("torus", 2, shape("torus", 800)),
    ("circle", 1, shape("circle", 100)),
    ("rotations", 3, shape("rotations", 500)),
    ("sphere_4", 4, shape("sphere", 200, dim=4)),
    ("moebius", 2, shape("moebius_band", 500)),
    ("grid", 2, lambda: grid(12, 12)),
):
    add(f"paper_{name}", dim, make, method="paper")
add("paper_either", 2, shape("torus", 800), method="paper", edges="either")
add("paper_jet", 2, shape("torus", 800), method="paper", estimator="jet")
add(
    "paper_gram",
    2,
    lambda: products_of(rm.datasets.torus(300, random_state=6)),
    method="paper",
)
add(
    "paper_distances",
    2,
    lambda: distances_of(rm.datasets.torus(300, random_state=6)),
    method="paper",
)
add("paper_outliers", 2, with_outliers, method="paper", outliers="auto")
add("raw_scan", 2, raw_scan)
for name, dim, every in (
    ("surface_spot_cow_vertices", 2, 1),
    ("surface_rocker_arm_genus1_uniform10k", 2, 1),
    ("surface_wingnut_creases_vertices", 2, 1),
    ("surface_skull_genus2_vertices", 2, 1),
    ("rawscan_bunny_one_view_bun000", 2, 1),
    ("rawscan_bunny_ten_views_registered_60k", 2, 6),
    ("rawscan_cactus_3337", 2, 1),
    ("curve_coastline_british_isles_in_R2", 1, 1),
    ("threemanifold_SO3_in_R9", 3, 10),
    ("highdim_range_image_patches_circle_in_R25", 1, 10),
    ("solid_bunny_tetrahedra_K3_in_R3", 3, 1),
    ("terrain_dem_grid", 2, 4),
):
    add(f"measured_{name}", dim, shared(name, every), quality="cow" in name)


def checksum(array: np.ndarray) -> float:
    """A number that changes with any entry and with their order."""
    values = np.nan_to_num(np.asarray(array, float).ravel(), posinf=1e3, neginf=-1e3)
    weights = np.sin(np.arange(1, len(values) + 1, dtype=float) * 0.7) + 2
    return float(np.dot(np.abs(values), weights)) + float(np.isnan(array).sum())


def summary(arrays: dict[str, Any]) -> dict[str, Any]:
    exact, integers = hashlib.sha256(), hashlib.sha256()
    sums = {}
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        data = f"{name} {array.shape} ".encode() + array.tobytes()
        exact.update(data)
        if array.dtype.kind == "f":
            sums[name] = checksum(array)
        else:
            integers.update(data)
    return {
        "integers": integers.hexdigest()[:16],
        "exact": exact.hexdigest()[:16],
        "numbers": sums,
    }


def difference(case: str, now: dict[str, Any], recorded: dict[str, Any]) -> list[str]:
    """What is not as recorded, one line each."""
    out = []
    if now["integers"] != recorded["integers"]:
        out.append(f"{case}: integers {now['integers']}, not {recorded['integers']}")
    for name, value in recorded["numbers"].items():
        got = now["numbers"].get(name)
        if got is None or not abs(got - value) <= TOLERANCE * max(abs(value), 1e-9):
            out.append(f"{case}: {name} sums to {got}, not {value}")
    return out


def recorded() -> dict[str, Any]:
    result: dict[str, Any] = json.loads(RECORDED.read_text(encoding="utf-8"))
    return result


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="cases whose name has one of these")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--exact", action="store_true")
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()
    known = recorded() if RECORDED.is_file() else {}
    bad = count = 0
    for name, run in CASES.items():
        if args.names and not any(part in name for part in args.names):
            continue
        try:
            now = summary(run(args.threads))
        except (Absent, ImportError) as error:
            print(f"{name}: skipped, {error} is absent", file=sys.stderr)
            continue
        count += 1
        if args.record:
            known[name] = now
            continue
        if name not in known:
            lines = [f"{name}: not recorded"]
        else:
            lines = difference(name, now, known[name])
            if args.exact and not lines and now["exact"] != known[name]["exact"]:
                lines = [f"{name}: differs in the last bits"]
        bad += bool(lines)
        for line in lines:
            print(line)
    if args.record:
        RECORDED.parent.mkdir(exist_ok=True)
        RECORDED.write_text(
            json.dumps(known, indent=1, sort_keys=True) + "\n", encoding="utf-8"
        )
        print(f"digests: {count} recorded")
        return 0
    print(f"digests: {count - bad} of {count} as recorded")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
