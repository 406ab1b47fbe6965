# SPDX-License-Identifier: GPL-3.0-or-later
"""The run from top to bottom: what all samples decide, the tiles, the seams, the result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from remanifold import _core
from remanifold._base.samples import Points
from remanifold._base.validation import check_int, check_outliers, check_positive
from remanifold.distributed import _tiles as tasks
from remanifold.distributed._engine import Engine, client_of
from remanifold.distributed._merge import Whole, merge, ranked_piece
from remanifold.distributed._result import DistributedReconstruction
from remanifold.distributed._sources import source_of
from remanifold.distributed._store import Part, Store
from remanifold.method.options import Options

# Samples that are read at once, without neighbors.
CHUNK = 1_000_000
# Halo, and what of it lies along a seam on either side, in medians of the local scale: the
# distance to the (2K+2)-th neighbor. Curves are mended by the mean of all their edges.
HALO = {2: 20.0, 3: 8.0}
SEAM = 0.5
# Where the coarsest samples of a tile have so many times the median scale, its halo is no
# wider: independent samples do.
EVEN_ENOUGH = 2.0
# Around what is only measured.
MEASURED_HALO = 10.0
# Smaller data are one tile: some steps look at a share of all samples.
LEAST_SAMPLES = 4096
LEAST_TILE = 1000
MOST_COORDINATES = 8
# So many times as far from a flat as a sample has to be.
NO_DOUBT = 1000
# Rounds in which halos double.
MOST_ROUNDS = 12


class BeyondTilesError(ValueError):
    """What was asked for can be made in one piece only."""


class Run:
    """One call, step by step."""

    def __init__(
        self, job: tasks.Job, engine: Engine, outliers: float, smooths: bool
    ) -> None:
        self.job = job
        self.engine = engine
        self.outliers = outliers
        self.smooths = smooths
        self.num_tiles = 0
        self.again = 0  # tiles that were run more than once

    def each(
        self,
        step: str,
        function: Callable[..., Any],
        first: Sequence[Any],
        *more: Sequence[Any],
    ) -> list[Any]:
        """A function of each chunk, tile or part."""
        arguments = [(self.job, *values) for values in zip(first, *more, strict=True)]
        return self.engine.run(step, function, arguments)

    def sort(self, tile_size: int) -> None:
        """Cut space into tiles, and write the samples by cells of these."""
        chunks = range(-(-self.job.num_samples // self.job.chunk))
        scans = self.each("scan", tasks.scan_chunk, chunks)
        plan = tasks.plan_tiles(self.job, scans, tile_size)
        self.job = self.job.with_(plan=plan)
        self.num_tiles = int(plan.meta["tiles"])
        self.job = self.job.with_(affine_dim=self.affine_dim(scans, chunks))
        if self.job.affine_dim < self.job.dim:
            msg = (
                f"the samples span {self.job.affine_dim} dimensions, and dim is "
                f"{self.job.dim}: there is no simplex to be found"
            )
            raise BeyondTilesError(msg)
        sorted_chunks = self.each("sort", tasks.sort_chunk, chunks)
        self.job = self.job.with_(chunks=tasks.list_chunks(self.job, sorted_chunks))

    def affine_dim(self, scans: list[dict[str, Any]], chunks: Sequence[int]) -> int:
        """Dimension of the flat that all samples lie on."""
        job, flat = self.job, tasks.FLAT * tasks.scale_of(self.job)
        # Where some samples leave no doubt that they fill all dimensions, so do all.
        some = np.concatenate([scan["some"][:: len(scans)] for scan in scans])
        rows = tasks.spanning_rows(some, NO_DOUBT * flat)
        if len(rows) <= job.ambient_dim:
            spanning = self.each("span", tasks.spanning_samples, chunks)
            rows = tasks.spanning_rows(np.concatenate(spanning), flat)
        return len(rows) - 1

    def measure(self) -> None:
        """All that is decided by all samples at once."""
        # Not before: a run that keeps outliers goes on with what this one has sorted.
        self.job = self.job.with_(outliers=self.outliers)
        tiles = range(self.num_tiles)
        # A first guess: samples spread evenly over as much as the extents allow.
        halo = MEASURED_HALO * tasks.first_spacing(tasks.plan_of(self.job), self.job)
        parts = self.each("measure", tasks.measure_tile, tiles, [halo] * len(tiles))
        distinct = sum(part.meta["distinct"] for part in parts)
        median = self.value_at(parts, "scales", (distinct - 1) // 2)
        tenth = self.value_at(parts, "ratios", distinct // 10)
        self.scale = median * tasks.scale_of(self.job)
        coarsest = np.array([part.meta["coarsest"] for part in parts]) / median
        self.coarseness = np.maximum(1.0, coarsest / EVEN_ENOUGH)
        self.job = self.job.with_(
            distinct=distinct, evenness=_core.evenness_of(tenth, self.job.dim)
        )
        if self.job.outliers > 0:
            self.look_for_outliers(parts, median)
        if self.smooths:
            self.look_for_noise(parts)

    def value_at(self, parts: list[Part], name: str, rank: int) -> float:
        """The rank-th smallest, from 0, of positive values in all parts."""
        prefix, known = 0, 0
        for bits in (20, 40, 64):
            counts = self.each(
                f"count {name}",
                tasks.count_values,
                parts,
                [name] * len(parts),
                [prefix] * len(parts),
                [known] * len(parts),
                [bits] * len(parts),
            )
            prefix, rank = ranked_piece(counts, rank)
            known = bits
        return float(np.array([prefix], dtype=np.uint64).view(np.float64)[0])

    def at_ranks(
        self, parts: list[Part], ranks: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Tile, number and place of the distinct samples at ranks of the order of all."""
        job, tiles = self.job, range(self.num_tiles)
        counts: dict[int, int] = {}
        for part in parts:
            arrays = job.store.get(part, "pieces", "counts")
            for piece, count in zip(
                arrays["pieces"].tolist(), arrays["counts"].tolist(), strict=True
            ):
                counts[piece] = counts.get(piece, 0) + count
        pieces = np.array(sorted(counts), dtype=np.uint64)
        ends = np.cumsum([counts[int(piece)] for piece in pieces])
        slots = np.searchsorted(ends, ranks, side="right")
        wanted = pieces[np.unique(slots)]
        picked = self.each("pick", tasks.pick_probes, tiles, [wanted] * len(tiles))
        codes, points, numbers = (
            np.concatenate(columns) for columns in zip(*picked, strict=True)
        )
        owner = np.repeat(np.arange(len(tiles)), [len(one[0]) for one in picked])
        order = np.lexsort((numbers, *points.T[::-1], codes))
        piece_of = codes[order] >> np.uint64(63 - tasks.COUNTED_BITS)
        begins = np.searchsorted(piece_of, pieces[slots])
        before = np.where(slots > 0, ends[slots - 1], 0)
        rows = order[begins + ranks - before]
        return owner[rows], numbers[rows], points[rows]

    def look_for_outliers(self, parts: list[Part], median: float) -> None:
        """Refuse what one piece would leave out, or might."""
        job, tiles = self.job, range(self.num_tiles)
        found = self.each("suspect", tasks.find_suspects, parts, [median] * len(tiles))
        if count := sum(len(sparse) for _, sparse in found):
            msg = (
                f"{count:,} samples lie {_core.SPARSE_SCALE:g} times as far from others as "
                "the median and more, and may be outliers, which are told in one piece "
                "only: pass outliers=False to keep all, or call remanifold.reconstruct"
            )
            raise BeyondTilesError(msg)
        if not sum(len(apart) for apart, _ in found):
            return
        stride = _core.outlier_probe_stride(job.distinct)
        owners, probes, _ = self.at_ranks(parts, np.arange(0, job.distinct, stride))
        asked = [t for t in tiles if len(found[t][0]) or (owners == t).any()]
        judged = self.each(
            "judge",
            tasks.judge_tile,
            asked,
            [found[tile][0] for tile in asked],
            [probes[owners == tile] for tile in asked],
            [median] * len(asked),
            [tasks.ASKED_HALO * self.scale] * len(asked),
        )
        away, relative = (np.concatenate(some) for some in zip(*judged, strict=True))
        least = _core.least_outlier_distance(job.outliers, relative.tolist())
        if count := int(np.count_nonzero(away > least)):
            msg = (
                f"{count:,} samples are outliers, which are left out in one piece only: "
                "pass outliers=False to keep all, or call remanifold.reconstruct"
            )
            raise BeyondTilesError(msg)

    def look_for_noise(self, parts: list[Part]) -> None:
        """Refuse what one piece would smooth, or might."""
        job = self.job
        tests = _core.num_noise_probes(job.distinct)
        ranks = [_core.noise_probe(i, job.distinct) for i in range(tests)]
        owners, numbers, points = self.at_ranks(parts, np.array(ranks, dtype=np.int64))
        asked = {
            int(tile): np.flatnonzero(owners == tile) for tile in np.unique(owners)
        }
        found = self.each(
            "noise",
            tasks.probe_tile,
            list(asked),
            [numbers[rows] for rows in asked.values()],
            [tasks.ASKED_HALO * self.scale] * len(asked),
        )
        said = np.empty((len(numbers), found[0].shape[1]))
        for rows, values in zip(asked.values(), found, strict=True):
            said[rows] = values
        samples = Points(np.ascontiguousarray(points[:1]))
        if _core.shows_noise(
            samples, tasks.whole_of(job), job.dim, said.ravel().tolist()
        ):
            msg = (
                "the samples are noisy, or fill more dimensions than dim, and smoothing is "
                "done in one piece only: pass smooth=False to take them as they are, or "
                "call remanifold.reconstruct"
            )
            raise BeyondTilesError(msg)

    def run_tiles(self, halo: float, seam: float) -> list[Part]:
        """All tiles; those again that are not settled, with more around them."""
        parts: list[Part | None] = [None] * self.num_tiles
        # As wide in the local scales of where samples are sparse, next to it as well.
        plan = tasks.plan_of(self.job)
        halos = np.array(
            [
                halo * self.coarseness[[tile, *plan.neighbors_of(tile, halo)]].max()
                for tile in range(self.num_tiles)
            ]
        )
        self.job = self.job.with_(seam=seam)
        left = list(range(self.num_tiles))
        for turn in range(MOST_ROUNDS):
            made = self.each(
                f"tiles{turn}", tasks.run_tile, left, [float(halos[t]) for t in left]
            )
            for tile, part in zip(left, made, strict=True):
                parts[tile] = part
            known = [part for part in parts if part is not None]
            if any(part.meta["narrow"] for part in known):
                return self.run_tiles(2 * halo, 2 * seam)
            left = self.left_by_whole(known, halos)
            if not left:
                left = unsettled(known)
                halos[left] *= 2
            if not left and self.turns_out_twisted(known):
                left = list(range(self.num_tiles))
            if not left:
                return known
            self.again += len(left)
        msg = f"tiles {left} are not settled, however much is around them"
        raise BeyondTilesError(msg)

    def left_by_whole(self, parts: list[Part], halos: NDArray[np.float64]) -> list[int]:
        """Tiles that were run by wrong assumptions about the whole."""
        job, metas = self.job, [part.meta for part in parts]
        opened = max(
            k + 1 if found else 0
            for meta in metas
            for k, found in enumerate(meta["opened"])
        )
        if job.orientable and not all(meta["agreed_orientable"] for meta in metas):
            self.job = job.with_(orientable=False)
            return list(range(self.num_tiles))
        # One round more or less matters where there is something left to mend.
        left = []
        for tile, meta in enumerate(metas):
            first, last = sorted((len(meta["unmended"]) - 1, opened))
            if any(meta["unmended"][first:last]):
                left.append(tile)
        if left:
            self.job = job.with_(rounds=opened)
            return left
        return self.left_by_open_region(parts, halos)

    def turns_out_twisted(self, parts: list[Part]) -> bool:
        """Whether the whole has no orientation, which no tile has seen."""
        job = self.job
        if not job.orientable:
            if any(part.meta["sharp_folds"] for part in parts):
                msg = (
                    "the samples lie on a manifold without orientation that has sharp "
                    "folds, which are judged in one piece only: call "
                    "remanifold.reconstruct"
                )
                raise BeyondTilesError(msg)
            return False
        whole = merge(job.store, parts, tasks.whole_of(job), self.num_axes, job.dim)
        self.job = job.with_(orientable=whole.orientable)
        return not whole.orientable

    def left_by_open_region(
        self, parts: list[Part], halos: NDArray[np.float64]
    ) -> list[int]:
        """Tiles that did not know all samples around what stays open."""
        job = self.job
        if self.num_axes > 3:
            return []
        some = [job.store.get(part, "open_numbers", "open_points") for part in parts]
        numbers = np.concatenate([one["open_numbers"] for one in some])
        points = np.concatenate([one["open_points"] for one in some])
        if not len(numbers):
            return []
        order = np.argsort(numbers)
        found = job.store.put(
            "open", {"numbers": numbers[order], "points": points[order]}, {}
        )
        if found == job.open_region:
            return []
        self.job = job.with_(open_region=found)
        plan = tasks.plan_of(job)
        return [
            tile
            for tile in range(self.num_tiles)
            if tasks.within(points, *plan.box(tile, float(halos[tile]))).any()
        ]

    @property
    def num_axes(self) -> int:
        """Coordinates in which samples differ."""
        plan = tasks.plan_of(self.job)
        return int(np.count_nonzero(plan.low != plan.high))

    def write(self, parts: list[Part]) -> dict[str, Any]:
        """Orient the simplices and write them; what the manifest says."""
        job = self.job
        whole: Whole = merge(
            job.store, parts, tasks.whole_of(job), self.num_axes, job.dim
        )
        if whole.num_unsure:
            msg = (
                f"{whole.num_unsure} closed patches hold no volume to speak of, which "
                "orients them: call remanifold.reconstruct"
            )
            raise BeyondTilesError(msg)
        written = self.each(
            "write", tasks.write_tile, range(self.num_tiles), parts, whole.turns
        )
        metas = [part.meta for part in parts]
        faces = np.sum([meta["faces"] for meta in metas], axis=0).tolist()
        total = {
            name: sum(meta[name] for meta in metas)
            for name in ("open_faces", "branching", "singular", "unused")
        }
        openings = [one for meta in metas for one in meta["openings"]]
        anything = faces[-1] > 0  # nothing is no manifold, as in one piece
        return {
            "dim": job.dim,
            "num_samples": job.num_samples,
            "num_distinct": job.distinct,
            "source": job.store.read_json(job.source),
            "num_simplices": sum(part.meta["rows"] for part in written),
            "simplices": [asdict(part) for part in written],
            "topology": {
                "num_simplices": faces,
                "euler_characteristic": sum(
                    count * (-1) ** k for k, count in enumerate(faces)
                ),
                "components": whole.num_components,
                "orientable": anything and whole.orientable,
                "closed": anything and total["open_faces"] == 0,
                "manifold": anything
                and total["branching"] == 0
                and total["singular"] == 0,
                "num_open_faces": total["open_faces"],
                "num_callous_faces": total["branching"],
                "num_singular_vertices": total["singular"],
            },
            "num_unused": total["unused"],
            "openings": sorted(openings, key=lambda one: one["expected"]),
            "hole_radius": metas[0]["hole_radius"],
            "tiles": self.num_tiles,
            "tiles_again": self.again,
            "samples_of_tiles": [meta["samples"] for meta in metas],
            "stages": {
                name: asdict(stage) | {"seconds": round(stage.seconds, 3)}
                for name, stage in self.engine.stages.items()
            },
        }


def unsettled(parts: list[Part]) -> list[int]:
    """Tiles with a place that reaches too far, or that see a seam otherwise than another."""
    left = {tile for tile, part in enumerate(parts) if not part.meta["settled"]}
    for tile, part in enumerate(parts):
        for other, digest in part.meta["seams"].items():
            if parts[int(other)].meta["seams"][str(tile)] != digest:
                left |= {tile, int(other)}
    return sorted(left)


def reconstruct(
    source: Any,
    dim: int,
    client: Any = None,
    *,
    work: str | Path,
    tile_size: int = 1_000_000,
    num_workers: int | None = None,
    boundary: Literal["auto", False] = "auto",
    hole_radius: float | None = None,
    significance: float | None = None,
    outliers: Literal["auto", False] | float | None = None,
    smooth: Literal["auto", False] | None = None,
    num_neighbors: int | None = None,
    estimator: Literal["jet", "pca"] | None = None,
    halo: float | None = None,
    memory_limit: str | int | None = None,
    resume: bool = False,
    progress: Callable[[str, int, int], None] | None = None,
) -> DistributedReconstruction:
    """Reconstruct in tiles, by the workers of a Dask cluster: the bytes of one piece.

    A tile is an ordinary reconstruction of its samples and of a halo around them, but for
    what is decided by all samples at once. Where neighboring tiles disagree, or a place
    reaches where samples were cut off, they are run again with more around them.

    Parameters
    ----------
    source : str, Path or array_like, shape (N, D)
        A .npy, .las, .laz, .parquet or .zarr that all workers see, or a folder of such
        files, which are taken in the order of their names; none is read as a whole. Or an
        array, which is written into `work` first. D is 8 at most.
    dim : int
        K, 2 or 3.
    client : distributed.Client, optional
        Of a cluster whose workers see `work` under the same path. By default one on this
        machine, open to nobody else, for the time of the call.
    work : str or Path
        Directory of the run: parts, which `resume` goes on with, and the result.
    tile_size : int
        Samples of a tile, at most, about.
    num_workers : int, optional
        Processes of the cluster on this machine; by default one a core. With 0 this process
        takes one tile after the other, without Dask.
    boundary : {"auto", False}
        As of `remanifold.reconstruct`, as what follows.
    hole_radius, significance : float, optional
        What stays open.
    outliers, smooth : {"auto", False}, optional
        Whether to look for samples to be left out, and for noise. Where there are any,
        the call ends with an error, before any tile is reconstructed.
    num_neighbors : int, optional
        For the tangent spaces.
    estimator : {"jet", "pca"}, optional
        Of the tangent spaces.
    halo : float, optional
        Width of what is read around a tile at first, in medians of the local scale.
    memory_limit : str or int, optional
        Of each process of the cluster on this machine, as Dask has it: "3GiB", or bytes.
    resume : bool
        Go on with a run of the same samples and parameters that was ended.
    progress : callable, optional
        Called with the name of a step, how many of its tasks are done, and of how many.

    Returns
    -------
    DistributedReconstruction
        Reads simplices when asked.

    Raises
    ------
    BeyondTilesError
        The samples need what can be done in one piece only.
    remanifold.distributed.LostPartError
        A part of the run is missing or damaged.
    """
    options = Options(
        boundary=boundary,
        hole_radius=hole_radius,
        significance=significance,
        outliers=False,
        smooth=False,
        num_neighbors=num_neighbors,
        estimator=estimator,
        search="kdtree",
    )
    for name, value in (("boundary", boundary), ("smooth", smooth)):
        if value not in (None, "auto", False):
            msg = f'{name} is {value!r}, expected "auto" or False: no more can be done in tiles'
            raise BeyondTilesError(msg)
    distance = float(check_outliers("auto" if outliers is None else outliers))
    check_int(tile_size, "tile_size", minimum=LEAST_TILE)
    wide = (
        check_positive(HALO[dim] if halo is None else halo, "halo")
        if dim in HALO
        else 0
    )
    directory = Path(work).resolve()
    found, identity = source_of(source, directory)
    num_samples, ambient_dim = found.shape()
    check_size(dim, num_samples, ambient_dim)
    store = Store(str(directory))
    said = {
        "version": version("remanifold"),
        "source": identity,
        "parameters": repr((dim, options, distance, smooth, tile_size, wide)),
    }
    claim(store, said, resume)
    # Of thousands of files, not in what every task is told. A worker keeps what it has read
    # by this name, over many runs.
    named = store.put_json("source", found.said())
    chunk = min(CHUNK, max(tile_size, LEAST_SAMPLES))
    job = tasks.Job(
        store.root, named, num_samples, ambient_dim, dim, options, chunk, outliers=0.0
    )
    with client_of(client, num_workers, memory_limit) as own:
        engine = Engine(own, store, progress)
        run = Run(job, engine, distance, smooth is not False)
        try:
            run.sort(tile_size)
            run.measure()
            wide *= run.scale
            manifest = run.write(run.run_tiles(wide, SEAM * wide))
        except BeyondTilesError:
            # The same samples may be tried with other parameters.
            store.write_json("run.json", {**said, "parameters": None})
            raise
    store.write_json("manifest.json", manifest)
    return DistributedReconstruction(store.root)


def check_size(dim: int, num_samples: int, ambient_dim: int) -> None:
    """Refuse what tiles are not for."""
    if num_samples < 1:
        msg = "source has no samples"
        raise ValueError(msg)
    if check_int(dim, "dim", minimum=1) > ambient_dim:
        msg = f"dim is {dim}, expected 1 to {ambient_dim}, the number of coordinates"
        raise ValueError(msg)
    if dim not in HALO:
        msg = f"dim is {dim}, tiles are for 2 and 3: call remanifold.reconstruct"
        raise BeyondTilesError(msg)
    if ambient_dim > MOST_COORDINATES:
        msg = (
            f"the samples have {ambient_dim} coordinates, tiles are for no more than "
            f"{MOST_COORDINATES}: call remanifold.reconstruct"
        )
        raise BeyondTilesError(msg)
    if num_samples < LEAST_SAMPLES:
        msg = (
            f"{num_samples:,} samples are too few for tiles, which are for {LEAST_SAMPLES:,} "
            "and more: call remanifold.reconstruct"
        )
        raise BeyondTilesError(msg)


def claim(store: Store, said: dict[str, Any], resume: bool) -> None:
    """Take a directory for a run, or go on with the same run."""
    before = store.read_json("run.json")
    refused = before is not None and before["parameters"] is None
    if before is not None and not refused and not resume:
        msg = (
            f"work holds a run already, {store.root}: pass resume=True to go on with it, "
            "or take another directory"
        )
        raise FileExistsError(msg)
    for what, named in (
        ("source", "another source"),
        ("parameters", "other parameters"),
        ("version", "another version"),
    ):
        if before is None or (what == "parameters" and refused):
            continue
        if before[what] != said[what]:
            msg = f"work holds a run of {named}, {store.root}: take another directory"
            raise ValueError(msg)
    store.write_json("run.json", said)
