# SPDX-License-Identifier: GPL-3.0-or-later
"""Right and wrong reconstructions.

Right is a manifold by its links with the Betti numbers over Z2 and Z3 of the true one,
closed and orientable where that is, with as many boundary components, and with at most
1 % of the samples unused.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import remanifold as rm
from remanifold import datasets

MAX_UNUSED = 0.01  # of the samples
MAX_SIMPLICES = 50_000  # whose homology is computed although the complex is wrong


def judge(
    simplices: Any, topology: rm.Topology, num_samples: int, shape: datasets.Shape
) -> Iterator[str]:
    """Say what is wrong with a reconstruction."""
    if len(simplices) == 0:
        yield "no simplices"
        return
    wrong = False
    if not topology.manifold:
        wrong = True
        yield f"wrong links: {len(topology.singular_vertices)}"
    if topology.orientable != shape.orientable:
        wrong = True
        yield "orientable" if topology.orientable else "not orientable"
    boundary = topology.boundary_components
    if boundary != shape.boundary_components:
        wrong = True
        yield f"boundary components: {boundary}, not {shape.boundary_components}"
    elif topology.closed != shape.closed:
        wrong = True
        yield "closed" if topology.closed else "not closed"
    if topology.components != shape.components:
        wrong = True
        yield f"components: {topology.components}, not {shape.components}"
    unused = num_samples - topology.num_vertices
    if unused > MAX_UNUSED * num_samples:
        wrong = True
        yield f"unused samples: {unused}"
    cheap = topology.counting_settles_homology or len(simplices) <= MAX_SIMPLICES
    if wrong and not cheap:
        return
    for field, found, true in (
        ("Z2", topology.betti_numbers, shape.betti_numbers),
        ("Z3", topology.betti_numbers_mod3, shape.betti_numbers_mod3),
    ):
        if found != true:
            yield f"Betti numbers {_list(found)} over {field}, not {_list(true)}"


def _list(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))
