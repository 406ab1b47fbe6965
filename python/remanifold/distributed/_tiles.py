# SPDX-License-Identifier: GPL-3.0-or-later
"""What workers do: each function is a task, of the job and the number of a chunk or tile.

Samples have the numbers of the rows of the source, 64 bits wide. A tile has a box of its
own and reads a *halo* around it. The inner part of the halo is trusted, the outer part may
have been spoilt by where the samples were cut off. A tile answers for the simplices whose
lowest sample is in its own box.
"""

from __future__ import annotations

import functools
import hashlib
import warnings
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold import _core
from remanifold._base.samples import Points
from remanifold.distributed._plan import Plan, make_plan
from remanifold.distributed._sources import Source
from remanifold.distributed._store import Arrays, Part, Store
from remanifold.method.options import Options
from remanifold.method.programs import solve_program

Numbers = NDArray[np.int64]

# Samples that the plan is made from, and of one chunk, at most.
PLAN_SAMPLES = 2_000_000
PLAN_SAMPLES_OF_CHUNK = 20_000
# Bits of a place on the curve that samples are counted by.
COUNTED_BITS = 21
# Of a test of noise, which value is the radius of its neighborhood.
NOISE_RADIUS = 5
# How far from a flat a sample may be, as the core has it.
FLAT = 1e-6
NOISE_VALUES = 11
# More samples than any step looks at around one: neighbors of neighbors that vote.
ENOUGH = 2_000
# Around what is asked, in medians of the local scale.
ASKED_HALO = 9.0
# A circumradius that is known up to rounding.
SLACK = 1 + 1e-6


@dataclass(frozen=True)
class Job:
    """All that a task needs to know, but for its own numbers."""

    root: str
    source: str  # file of the run that says where the samples are
    num_samples: int
    ambient_dim: int
    dim: int
    options: Options
    chunk: int
    outliers: float  # distance from which on a sample is one; 0 where none is
    threads: int = 1
    plan: Part | None = None
    chunks: Part | None = None  # which files have the samples by cells
    # Of all samples, once they are known.
    distinct: int = 0
    evenness: float = 0.0
    affine_dim: int = 0
    orientable: bool = True
    rounds: int = -1
    open_region: Part | None = None
    seam: float = 0.0  # width on both sides of a seam in which tiles have to agree

    @property
    def store(self) -> Store:
        """Where parts are."""
        return Store(self.root)

    def with_(self, **changes: Any) -> Job:
        """The same with more known."""
        return replace(self, **changes)


@functools.lru_cache(maxsize=2)
def _source(root: str, name: str) -> Source:
    return Source.of(Store(root).read_json(name))


@functools.lru_cache(maxsize=2)
def _chunks(root: str, part: str, size: int) -> list[tuple[Part, Part]]:
    arrays = Store(root).get(Part(part, size))
    columns = [
        arrays[name].tolist() for name in ("paths", "sizes", "offsets", "lengths")
    ]
    return [(Part(a, b), Part(c, d)) for a, b, c, d in zip(*columns, strict=True)]


def chunks_of(job: Job) -> list[tuple[Part, Part]]:
    """Samples by cells, and where cells begin; read once in each worker."""
    assert job.chunks is not None
    return _chunks(job.root, job.chunks.path, job.chunks.size)


def list_chunks(job: Job, parts: list[Part]) -> Part:
    """Write which files there are: every task has to know, and none should be told."""
    return job.store.put(
        "chunks",
        {
            "paths": np.array([part.path for part in parts]),
            "sizes": np.array([part.size for part in parts]),
            "offsets": np.array([part.meta["offsets"] for part in parts]),
            "lengths": np.array([part.meta["length"] for part in parts]),
        },
        {},
    )


@functools.lru_cache(maxsize=4)
def _plan(root: str, part: str, size: int) -> Plan:
    return Plan(**Store(root).get(Part(part, size)))


def plan_of(job: Job) -> Plan:
    """The plan, read once in each worker."""
    assert job.plan is not None
    return _plan(job.root, job.plan.path, job.plan.size)


def whole_of(job: Job) -> _core.GlobalStatistics:
    """What a part takes from the whole."""
    plan = plan_of(job)
    return _core.GlobalStatistics(
        low=plan.low.tolist(),
        high=plan.high.tolist(),
        size=job.distinct or job.num_samples,
        evenness=job.evenness,
        affine_dim=job.affine_dim,
        orientable=job.orientable,
        opening_rounds=job.rounds,
    )


# ------------------------------------------------------------------------ samples


def read_chunk(job: Job, chunk: int) -> tuple[int, NDArray[np.float64]]:
    """Number of the first sample of a chunk, and all of them."""
    begin = chunk * job.chunk
    source = _source(job.root, job.source)
    return begin, source.read(begin, min(job.num_samples, begin + job.chunk))


def scan_chunk(job: Job, chunk: int) -> dict[str, Any]:
    """Extents, and some samples for the plan."""
    begin, points = read_chunk(job, chunk)
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        row = begin + int(np.flatnonzero(~finite)[0])
        msg = f"source[{row}] is not finite"
        raise ValueError(msg)
    num_chunks = -(-job.num_samples // job.chunk)
    most = min(PLAN_SAMPLES_OF_CHUNK, max(1, PLAN_SAMPLES // num_chunks))
    stride = -(-len(points) // most)
    return {
        "low": points.min(axis=0),
        "high": points.max(axis=0),
        "some": points[::stride],
    }


def spanning_samples(job: Job, chunk: int) -> NDArray[np.float64]:
    """Samples that span the flat of a chunk."""
    _, points = read_chunk(job, chunk)
    return points[spanning_rows(points, FLAT * scale_of(job))]


def spanning_rows(points: NDArray[np.float64], flat: float) -> list[int]:
    """The first, and each that is farther from the flat of the earlier ones."""
    rest = points - points[0]
    rows = [0]
    while len(rows) <= points.shape[1]:
        away = np.flatnonzero(np.linalg.norm(rest, axis=1) > flat)
        if not len(away):
            break
        rows.append(int(away[0]))
        direction = rest[away[0]] / np.linalg.norm(rest[away[0]])
        for _ in range(2):
            rest -= np.outer(rest @ direction, direction)
    return rows


def plan_tiles(job: Job, scans: list[dict[str, Any]], tile_size: int) -> Part:
    """Write the plan."""
    low = np.min([scan["low"] for scan in scans], axis=0)
    high = np.max([scan["high"] for scan in scans], axis=0)
    some = np.concatenate([scan["some"] for scan in scans])
    plan = make_plan(some, low, high, job.num_samples, tile_size)
    return job.store.put("plan", dict(vars(plan)), {"tiles": plan.num_tiles})


def sort_chunk(job: Job, chunk: int) -> Part:
    """Write the samples of a chunk by cells."""
    begin, points = read_chunk(job, chunk)
    plan = plan_of(job)
    cells = plan.cells_of(points)
    order = np.argsort(cells, kind="stable")
    table = np.empty(
        len(points), dtype=[("number", "<i8"), ("point", "<f8", (job.ambient_dim,))]
    )
    table["number"] = begin + order
    table["point"] = points[order]
    offsets = np.searchsorted(cells[order], np.arange(len(plan.cell_low) + 1))
    begins = job.store.put_table(f"offsets-{chunk}", offsets, {})
    return job.store.put_table(
        f"chunk-{chunk}", table, {"offsets": begins.path, "length": begins.size}
    )


@dataclass
class Box:
    """All samples within a box, in the order of their numbers."""

    low: NDArray[np.float64]  # infinite where no sample is beyond
    high: NDArray[np.float64]
    numbers: Numbers
    points: NDArray[np.float64]
    own: NDArray[np.bool_]
    halo: float

    @property
    def is_all(self) -> bool:
        """Whether there is nothing beyond."""
        return bool(np.isinf(self.low).all() and np.isinf(self.high).all())

    def margins(self) -> NDArray[np.float64]:
        """How far each sample is from what was not read."""
        margins: NDArray[np.float64] = np.minimum(
            self.points - self.low, self.high - self.points
        ).min(axis=1)
        return margins


def load_box(job: Job, tile: int, halo: float) -> Box:
    """Read a tile and so much around it."""
    plan = plan_of(job)
    low, high = plan.box(tile, halo)
    cells = plan.cells_within(low, high)
    whole = plan.cells_inside(cells, low, high)
    numbers, points = [], []
    runs = (_runs(cells[whole]), False), (_runs(cells[~whole]), True)
    for part, begins in chunks_of(job):
        table, offsets = job.store.table(part), job.store.table(begins)
        for some, has_others in runs:
            pieces = [table[offsets[a] : offsets[b]] for a, b in some]
            piece = np.concatenate([table[:0], *pieces])
            if has_others:
                piece = piece[within(piece["point"], low, high)]
            numbers.append(piece["number"])
            points.append(piece["point"])
    all_numbers = np.concatenate(numbers)
    order = np.argsort(all_numbers)
    all_points = np.ascontiguousarray(np.concatenate(points)[order])
    own_low, own_high = plan.box(tile, 0.0)
    owned = (all_points >= own_low) & (all_points < own_high)
    own: NDArray[np.bool_] = np.all(owned, axis=1)
    return Box(low, high, all_numbers[order], all_points, own, halo)


def _runs(cells: Numbers) -> list[tuple[int, int]]:
    """Ascending numbers as ranges."""
    if not len(cells):
        return []
    breaks = np.flatnonzero(np.diff(cells) > 1)
    first = np.concatenate([cells[:1], cells[breaks + 1]])
    last = np.concatenate([cells[breaks], cells[-1:]])
    return list(zip(first.tolist(), (last + 1).tolist(), strict=True))


# ------------------------------------------------------------- what all samples decide


def curve_codes(job: Job, points: NDArray[np.float64]) -> NDArray[np.uint64]:
    """Where samples lie on the curve that the core sorts them along, as it computes that."""
    plan = plan_of(job)
    half = plan.high / 2 - plan.low / 2
    largest = half.max()
    axes = np.argsort(-half, kind="stable")[:3]
    codes = np.zeros(len(points), dtype=np.uint64)
    for place, axis in enumerate(axes):
        at = np.zeros(len(points))
        if largest > 0:
            at = (points[:, axis] / 2 - plan.low[axis] / 2) / largest
        cells = np.minimum(
            (at * 0x1FFFFE + 0.382).astype(np.uint64), np.uint64(0x1FFFFF)
        )
        codes |= _spread(cells) << np.uint64(place)
    return codes


def _spread(x: NDArray[np.uint64]) -> NDArray[np.uint64]:
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        x = (x | x << np.uint64(shift)) & np.uint64(mask)
    return x


def measure_tile(job: Job, tile: int, halo: float) -> Part:
    """Spacings at the distinct samples of a tile, and where on the curve they are."""
    while True:
        box = load_box(job, tile, halo)
        found = _core.part_spacings(
            Points(box.points), whole_of(job), job.dim, job.outliers, job.threads
        )
        order = found["order"]
        own = box.own[order]
        scale = scale_of(job)
        lacks = found["reach"] * scale * SLACK > box.margins()[order]
        if box.is_all or not lacks[own].any():
            break
        halo *= 2
    codes = curve_codes(job, box.points[order[own]])
    pieces, counts = np.unique(
        codes >> np.uint64(63 - COUNTED_BITS), return_counts=True
    )
    return job.store.put(
        f"spacings-{tile}",
        {
            "ratios": found["ratios"][own],
            "apart": found["apart"][own],
            "scales": found["scales"][own],
            "around": found["around"][own],
            "numbers": box.numbers[order[own]],
            "pieces": pieces,
            "counts": counts,
        },
        {
            "distinct": int(own.sum()),
            "halo": halo,
            "coarsest": float(found["scales"][own].max(initial=0.0)),
        },
    )


def count_values(
    job: Job, part: Part, name: str, prefix: int, known: int, bits: int
) -> tuple[NDArray[np.uint64], NDArray[np.int64]]:
    """Of positive values with some leading bits, how many have which more of these."""
    values = job.store.get(part, name)[name].view(np.uint64)
    if known:
        values = values[values >> np.uint64(64 - known) == np.uint64(prefix)]
    return np.unique(values >> np.uint64(64 - bits), return_counts=True)


def first_spacing(plan: Plan, job: Job) -> float:
    """Of samples that fill as many of the longest axes as the manifold has."""
    extents = np.sort(plan.high - plan.low)[::-1][: job.dim]
    volume = float(np.prod(np.maximum(extents, extents[0] / 16)))
    return float((volume / job.num_samples) ** (1 / job.dim))


def scale_of(job: Job) -> float:
    """Canonical lengths times this are those of the source."""
    plan = plan_of(job)
    largest = float((plan.high / 2 - plan.low / 2).max())
    return 1.0 if largest == 0 else float(np.ldexp(1.0, np.frexp(largest)[1]))


def find_suspects(job: Job, part: Part, median: float) -> tuple[Numbers, Numbers]:
    """Samples of a tile that lie apart, and those that lie where samples are sparse."""
    arrays = job.store.get(part, "apart", "scales", "around", "numbers")
    scales, around = arrays["scales"], arrays["around"]
    looked_at = arrays["apart"] > job.outliers * np.minimum(scales / 2, median)
    # What was not compared with others may lie apart where it is sparse.
    units = np.where(np.isnan(around), 0.0, np.minimum(around, 2 * median))
    apart = looked_at & (arrays["apart"] > job.outliers * units)
    sparse = scales > _core.SPARSE_SCALE * median
    return arrays["numbers"][apart], arrays["numbers"][sparse]


def pick_probes(
    job: Job, tile: int, pieces: NDArray[np.uint64]
) -> tuple[NDArray[np.uint64], NDArray[np.float64], Numbers]:
    """The distinct samples of a tile in some pieces of the curve."""
    box = load_box(job, tile, 0.0)
    own = np.flatnonzero(box.own)
    codes = curve_codes(job, box.points[own])
    some = own[np.isin(codes >> np.uint64(63 - COUNTED_BITS), pieces)]
    if not len(some):
        return codes[:0], box.points[:0], box.numbers[:0]
    order, _ = _core.part_order(Points(box.points[some]), whole_of(job), job.threads)
    some = some[order]
    return curve_codes(job, box.points[some]), box.points[some], box.numbers[some]


def judge_tile(
    job: Job, tile: int, apart: Numbers, probes: Numbers, median: float, halo: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How far samples that lie apart are away, and what is usual at others."""
    asked = np.concatenate([apart, probes])
    while True:
        near = around(job, tile, asked, halo)
        if not near.is_enough:
            halo *= 2
            continue
        places = near.place(asked)
        away, relative, reach = _core.outliers_at(
            near.samples,
            whole_of(job),
            job.dim,
            job.outliers,
            median,
            places[: len(apart)],
            places[len(apart) :],
            job.threads,
        )
        if near.is_all or reach * scale_of(job) * SLACK < halo:
            return away, relative
        halo *= 2


def probe_tile(
    job: Job, tile: int, probes: Numbers, halo: float
) -> NDArray[np.float64]:
    """What some samples of a tile say about noise."""
    while True:
        near = around(job, tile, probes, halo)
        if not near.is_enough:
            halo *= 2
            continue
        places = near.place(probes)
        found = _core.noise_at(
            near.samples, whole_of(job), job.dim, places, job.threads
        )
        radii = found[:, NOISE_RADIUS - NOISE_VALUES] * scale_of(job)
        # Where no quadric could be fitted nothing says how far the neighbors are.
        if near.is_all or (radii * SLACK < halo).all():
            return found
        halo *= 2


@dataclass
class Near:
    """All samples that are near to some, as the core numbers them."""

    samples: Points
    numbers: Numbers  # ascending
    places: Numbers  # in the core; -1 for copies
    is_all: bool  # whether there are no others

    @property
    def is_enough(self) -> bool:
        """Whether there are as many as are asked about one: a stray has none near."""
        return self.is_all or len(self.numbers) >= ENOUGH

    def place(self, asked: Numbers) -> list[int]:
        """The core's numbers of some."""
        places = self.places[np.searchsorted(self.numbers, asked)]
        return [place for place in places.tolist() if place >= 0]


def around(job: Job, tile: int, asked: Numbers, radius: float) -> Near:
    """All that is so near to some samples of a tile, and maybe more."""
    box = load_box(job, tile, radius)
    rows = np.searchsorted(box.numbers, asked)
    axes = np.argsort(-np.ptp(box.points, axis=0), kind="stable")[:3]
    cells = box.points[:, axes] - box.points[:, axes].min(axis=0)
    cells = np.floor(cells / (radius / 2)).astype(np.int64) + 2
    sizes = cells.max(axis=0) + 3
    steps = np.stack(np.meshgrid(*[range(-2, 3)] * len(axes)), axis=-1)
    near = cells[rows][:, None] + steps.reshape(-1, len(axes))
    wanted = np.unique(np.ravel_multi_index(tuple(np.moveaxis(near, -1, 0)), sizes))
    kept = np.isin(np.ravel_multi_index(tuple(cells.T), sizes), wanted)
    samples = Points(np.ascontiguousarray(box.points[kept]))
    order, _ = _core.part_order(samples, whole_of(job), job.threads)
    places = np.full(len(samples), -1, dtype=np.int64)
    places[order] = np.arange(len(order))
    return Near(samples, box.numbers[kept], places, box.is_all and bool(kept.all()))


# ------------------------------------------------------------------ the reconstruction


def run_tile(job: Job, tile: int, halo: float) -> Part:
    """Reconstruct a tile and what is around it; what it says of its own and of seams."""
    box = load_box(job, tile, halo)
    samples = Points(box.points)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = _core.reconstruct(
            samples,
            job.options.for_core(samples, job.dim),
            solve=solve_program,
            on_other_dim=None,
            whole=whole_of(job),
            open_region=open_region_of(job, box),
            num_threads=job.threads,
            progress=None,
        )
    return job.store.put(f"tile-{tile}", *answers_of(job, tile, box, result))


def open_region_of(job: Job, box: Box) -> tuple[list[int], NDArray[np.float64]] | None:
    """Samples around what stays open in the whole: those here, and where the others are."""
    if job.open_region is None:
        return None
    arrays = job.store.get(job.open_region)
    rows = np.searchsorted(box.numbers, arrays["numbers"])
    rows[rows == len(box.numbers)] = 0
    here = box.numbers[rows] == arrays["numbers"]
    return rows[here].tolist(), np.ascontiguousarray(arrays["points"][~here])


def answers_of(
    job: Job, tile: int, box: Box, result: dict[str, Any]
) -> tuple[Arrays, dict[str, Any]]:
    """What a tile answers for, and what the others have to agree with."""
    plan = plan_of(job)
    part, repair, openings = result["part"], result["repair"], result["openings"]
    trusted = box.margins() >= box.halo / 2
    rows = np.sort(result["simplices"], axis=1)
    rows = rows[trusted[rows].all(axis=1)]
    own = box.own[rows[:, 0]]
    patch, sign, orientable = _core.oriented_patches(rows, len(trusted), job.threads)
    arrays: Arrays = {
        "simplices": box.numbers[rows[own]],
        "patch": patch[own],
        "sign": sign[own],
        "orientable": orientable,
        "component": components_of_patches(rows, patch, len(orientable), len(trusted)),
        "open": np.bincount(
            patch[rows_of_faces(rows, repair["open_faces"], box.own)],
            minlength=len(orientable),
        ),
    }
    near_open = part["open_region"][box.own[part["open_region"]]]
    arrays |= {
        "open_numbers": box.numbers[near_open],
        "open_points": box.points[near_open],
    }
    arrays |= orientations_of(job, box, rows[own], patch[own], sign[own], part["order"])
    # Tiles see the same simplices along their seam, or one of them is not settled.
    near = within(box.points, *plan.box(tile, job.seam))
    inner = within(box.points, *plan.box(tile, -1.01 * job.seam))
    # What is farther inside is in the box of no other.
    at_seams = np.flatnonzero((near & ~inner)[rows].all(axis=1))
    seams: dict[str, Any] = {}
    joins = []  # tiles with simplices in common
    for other in plan.neighbors_of(tile, 2 * job.seam):
        low, high = plan.box(other, job.seam)
        both = near & within(box.points, low, high)
        shared = at_seams[both[rows[at_seams]].all(axis=1)]
        digest = hashlib.blake2b(np.ascontiguousarray(box.numbers[rows[shared]]).data)
        seams[str(other)] = digest.hexdigest()
        if len(shared):
            joins.append(other)
            arrays[f"seam_patch_{other}"] = patch[shared]
            arrays[f"seam_sign_{other}"] = sign[shared]
    meta = {
        "rows": int(own.sum()),
        "samples": len(box.points),
        "halo": box.halo,
        "settled": box.is_all or is_settled(job, box, trusted, result),
        "narrow": not near[rows[own]].all(),
        "seams": seams,
        "joins": joins,
        "agreed_orientable": part["agreed_orientable"],
        "sharp_folds": int(trusted[part["sharp_folds"]].sum()),
        "opened": [bool(box.own[some].any()) for some in part["opened"]],
        "unmended": [bool(trusted[some].any()) for some in part["unmended"]],
        "faces": count_faces(rows, box.own),
        "open_faces": count_own(repair["open_faces"], box.own),
        "branching": count_own(repair["callous_faces"], box.own),
        "singular": int(box.own[repair["singular_vertices"]].sum()),
        "unused": int(box.own[repair["unused_vertices"]].sum()),
        "hole_radius": repair["hole_radius"],
        "openings": own_openings(box, openings),
    }
    return arrays, meta


def within(
    points: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Which points are in a box."""
    inside: NDArray[np.bool_] = np.all((points >= low) & (points <= high), axis=1)
    return inside


def is_settled(
    job: Job, box: Box, trusted: NDArray[np.bool_], result: dict[str, Any]
) -> bool:
    """Whether no place at the tile's samples reaches where samples were cut off.

    One place to the steps are simplices that were not agreed on, and openings, as far as
    they share samples.
    """
    repair = result["repair"]
    disputed = repair["disputed_simplices"]
    # What is as large as that is of no use, and at the rim of all there is a lot of it.
    small = np.ptp(box.points[disputed], axis=1).max(axis=1) < job.seam
    doubtful = [disputed[small], repair["filled_simplices"]]
    doubtful += [opening["simplices"] for opening in result["openings"]]
    if sets_with_both(np.concatenate(doubtful), box.own, ~trusted):
        return False
    stretched = result["part"]["stretched"]
    return not (trusted[stretched].any() and (~trusted[stretched]).any())


def count_own(faces: NDArray[np.int32], own: NDArray[np.bool_]) -> int:
    """Faces whose lowest sample is in the box."""
    return int(own[faces.min(axis=1)].sum()) if len(faces) else 0


def count_faces(rows: NDArray[np.int32], own: NDArray[np.bool_]) -> list[int]:
    """Faces of each dimension whose lowest sample is in the box."""
    arity = rows.shape[1]
    rows = rows[own[rows].any(axis=1)]
    counts = []
    for size in range(1, arity + 1):
        faces = np.concatenate(
            [rows[:, list(columns)] for columns in combinations(range(arity), size)]
        )
        counts.append(num_distinct(faces[own[faces[:, 0]]], len(own)))
    return counts


def num_distinct(rows: NDArray[np.int32], bound: int) -> int:
    """Distinct rows of numbers below a bound."""
    if rows.shape[1] * np.log2(max(bound, 2)) >= 63:
        return len(np.unique(rows, axis=0))
    keys = np.zeros(len(rows), dtype=np.int64)
    for column in rows.T:
        keys = keys * bound + column
    keys.sort()
    return int(np.count_nonzero(keys[1:] != keys[:-1])) + (len(keys) > 0)


def sets_with_both(
    rows: NDArray[np.int32], a: NDArray[np.bool_], b: NDArray[np.bool_]
) -> bool:
    """Whether some rows that share samples have samples of both kinds."""
    if not len(rows):
        return False
    label = _core.component_labels(np.ascontiguousarray(rows), len(a))
    members = np.unique(rows)
    of_a, of_b = label[members[a[members]]], label[members[b[members]]]
    return bool(len(np.intersect1d(of_a, of_b)))


def rows_of_faces(
    rows: NDArray[np.int32], faces: NDArray[np.int32], own: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Of each open face whose lowest sample is in the box, the simplex that it is on."""
    faces = np.sort(faces, axis=1)
    faces = faces[own[faces[:, 0]]]
    if not len(faces):
        return np.empty(0, dtype=np.int64)
    marked = np.zeros(len(own), dtype=bool)
    marked[faces] = True
    near = np.flatnonzero(marked[rows].sum(axis=1) >= faces.shape[1])
    known = {tuple(face) for face in faces.tolist()}
    found = []
    for row, vertices in zip(near.tolist(), rows[near].tolist(), strict=True):
        facets = combinations(vertices, len(vertices) - 1)
        found += [row for facet in facets if facet in known]
    return np.array(found, dtype=np.int64)


def orientations_of(
    job: Job,
    box: Box,
    rows: NDArray[np.int32],
    patch: NDArray[np.int32],
    sign: NDArray[np.int8],
    order: NDArray[np.int32],
) -> Arrays:
    """What turns patches: of each the first simplex in the order of the core, and volume.

    The volume is that of cones from the origin for K = D - 1.
    """
    plan = plan_of(job)
    place = np.zeros(len(box.points), dtype=np.int64)
    place[order] = np.arange(len(order))
    lowest = place[rows].min(axis=1)
    least = np.full(int(patch.max(initial=-1)) + 1, len(place))
    np.minimum.at(least, patch, lowest)
    some = np.flatnonzero(lowest == least[patch])
    ranked = some[
        np.lexsort((*np.sort(place[rows[some]], axis=1).T[::-1], patch[some]))
    ]
    patches, at = np.unique(patch[ranked], return_index=True)
    first = ranked[at]
    volumes, sizes = np.zeros(len(least)), np.zeros(len(least))
    axes = np.flatnonzero(plan.low != plan.high)
    if len(rows) and len(axes) - job.dim in (0, 1):
        corners = [box.points[:, axes][column] for column in rows.T]
        if len(axes) == job.dim:
            corners = [corner - corners[0] for corner in corners[1:]]
        signed = determinants(corners) * sign
        np.add.at(volumes, patch, signed)
        np.add.at(sizes, patch, np.abs(signed))
    return {
        "patches": patches,
        "first": box.numbers[rows[first]],
        "first_points": box.points[rows[first]],
        "first_sign": sign[first],
        "volumes": volumes[patches],
        "sizes": sizes[patches],
    }


def determinants(columns: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Of many matrices at once."""
    found: NDArray[np.float64]
    if len(columns) == 3:
        (a, b, c), (d, e, f), (g, h, i) = (column.T for column in columns)
        found = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    else:
        found = np.linalg.det(np.stack(columns, axis=1))
    return found


def components_of_patches(
    rows: NDArray[np.int32],
    patch: NDArray[np.int32],
    num_patches: int,
    num_samples: int,
) -> NDArray[np.int32]:
    """Of each patch the component that it is in: patches may share samples only."""
    labels = np.zeros(num_patches, dtype=np.int32)
    if len(rows):
        labels[patch] = _core.component_labels(rows, num_samples)[rows[:, 0]]
    return labels


def own_openings(box: Box, openings: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Places whose lowest sample is in the box; parts are told by the median of all."""
    kept = ("kind", "open", "volume", "spacing", "missing", "dispersion", "expected")
    return [
        {name: one[name] for name in kept}
        | {"samples": box.numbers[one["samples"]].tolist()}
        for one in openings
        if one["kind"] != "part" and box.own[one["samples"].min()]
    ]


def write_tile(job: Job, tile: int, part: Part, turns: NDArray[np.int8]) -> Part:
    """The simplices that a tile answers for, with the orientation of the whole."""
    arrays = job.store.get(part, "simplices", "patch", "sign")
    simplices = arrays["simplices"]
    swapped = turns[arrays["patch"]] * arrays["sign"] < 0
    order = np.lexsort(simplices.T[::-1])  # columns ascend
    simplices[swapped, -2:] = simplices[swapped][:, [-1, -2]]
    simplices = np.ascontiguousarray(simplices[order])
    return job.store.put_table(f"simplices-{tile}", simplices, {"rows": len(simplices)})
