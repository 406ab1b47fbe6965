# SPDX-License-Identifier: GPL-3.0-or-later
"""What came out and how sure it is, in one sentence that all pages begin with."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from remanifold.complex.topology import Topology
    from remanifold.judging.quality import Quality
    from remanifold.method.result import Repair


class Answer(NamedTuple):
    """A sentence without its full stop, and whether there is no doubt."""

    text: str
    good: bool


def answer_of(topology: Topology, repair: Repair, quality: Quality | None) -> Answer:
    """Say what a result is and whether to trust it; not the latter without `quality`."""
    what = topology.description
    if quality is None:
        return Answer(f"{what}, not judged yet", good=False)
    if not quality.ok:
        reason = quality.reasons[0]
        if reason.kind == "singular":
            # The complex may be a manifold all the same, and means nothing.
            return Answer(f"in doubt: {reason.text}; what was made is {what}", False)
        return Answer(f"{what}, in doubt: {reason.text}", good=False)
    lacks = repair.lacks
    if lacks:
        return Answer(f"{what}, but it lacks something: {', '.join(lacks)}", False)
    unused = len(repair.unused_vertices)
    but = f", but for {_count(unused, 'sample')} in no simplex" if unused else ""
    return Answer(f"{what}, right as far as can be told{but}", good=True)


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
