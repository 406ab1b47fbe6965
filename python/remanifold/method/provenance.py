# SPDX-License-Identifier: GPL-3.0-or-later
"""How a result was made: parameters as they were used, versions, digests."""

from __future__ import annotations

import platform
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.digest import digest
from remanifold._base.html import fragment
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Points
from remanifold._base.text import rounded
from remanifold._base.validation import check_boundary, check_outliers, check_samples
from remanifold.method.dropping import finite_rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from remanifold._base.samples import Input
    from remanifold.method.cleaning import Smoothing
    from remanifold.method.dimension import DimensionEstimate
    from remanifold.method.options import Options

_WIDTH = 88  # of the lines of a repr


class Parameter(NamedTuple):
    """A parameter as it was used.

    Attributes
    ----------
    value : object
        A number, a word, a bool, None, or an array.
    given : bool
        Whether the caller gave it.
    why : str
        How the value came about where it was not given as it is.
    """

    value: Any
    given: bool
    why: str = ""


class Parameters(Mapping[str, Parameter]):
    """Parameters of `reconstruct` as they were used, by their names.

    ``parameters["dim"].value`` is the value; `str` has a line for each with the reason
    for what was chosen automatically.
    """

    def __init__(self, known: Mapping[str, Parameter]) -> None:
        self._known = {**known}

    def __getitem__(self, name: str) -> Parameter:
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def __repr__(self) -> str:
        lines = [type(self).__name__ + "("]
        parts = [f"{name}={said(one.value)}" for name, one in self.items()]
        for i, part in enumerate(parts):
            text = part + (")" if i == len(parts) - 1 else ", ")
            if len(lines[-1] + text.rstrip()) > _WIDTH:
                lines[-1] = lines[-1].rstrip()
                lines.append("    ")
            lines[-1] += text
        return "\n".join(lines)

    def __str__(self) -> str:
        width = max(map(len, self._known), default=0)
        return "\n".join(
            f"{name:<{width}}  {value}  {how}".rstrip()
            for name, value, how in self.rows()
        )

    def call(self) -> str:
        """The call in Python that makes the same result from the same samples."""
        kind = self["samples"].value if "samples" in self else "points"
        parts = [f"{'' if kind == 'points' else f'{kind}='}{kind}"]
        for name, one in self.items():
            if not one.given or name in ("samples", "num_threads"):
                continue
            word = one.value
            if name == "attributes":
                word = "attributes"
            elif isinstance(word, np.ndarray):
                word = name
            else:
                word = repr(word)
            parts.append(f"{name}={word}")
        return f"rm.reconstruct({', '.join(parts)})"

    def _repr_html_(self) -> str:
        rows = ((name, f"{value} {how}") for name, value, how in self.rows())
        return fragment("parameters as they were used", rows)

    def rows(self) -> Iterator[tuple[str, str, str]]:
        """Name, value and origin of each, as text."""
        for name, one in self._known.items():
            how = "given" if one.given else "by default"
            yield name, said(one.value), f"({one.why or how})"


def said(value: Any) -> str:
    """A value of a parameter as text."""
    if isinstance(value, np.ndarray):
        if value.dtype == np.bool_:
            return f"<{int(value.sum()):,} of {len(value):,} samples>"
        return f"<array {value.shape}>"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Provenance(ReadOnlyArrays):
    """Where a result comes from.

    Attributes
    ----------
    parameters : Parameters
        Those of `reconstruct`, as they were used.
    input : str
        SHA-256 of the samples as they were given, see `is_of`.
    version : str
        Of remanifold.
    versions : dict of str to str
        Of what it ran on: Python, NumPy, the platform.
    created : str
        When, in UTC, as ISO 8601 writes it.
    source : dict of str to str
        What the command line knows of the file: its name, SHA-256, and which columns
        were the coordinates.
    command : str or None
        The command that made it.

    Notes
    -----
    A digest is the SHA-256 of, for each array, a line with its dtype and shape such as
    ``<f8 400,3`` and its bytes in C order, little endian.
    """

    parameters: Parameters
    input: str
    version: str = _core.__version__
    versions: dict[str, str] = field(default_factory=dict)
    created: str = ""
    source: dict[str, str] = field(default_factory=dict)
    command: str | None = None

    def __repr__(self) -> str:
        return (
            f"Provenance(version={self.version!r}, created={self.created!r}, "
            f"input={self.input[:19]!r}...)"
        )

    def is_of(
        self,
        points: ArrayLike | None = None,
        *,
        gram: ArrayLike | None = None,
        distances: ArrayLike | None = None,
    ) -> bool:
        """Whether the result was made of these samples, to the last bit.

        Parameters
        ----------
        points, gram, distances : array_like
            As in `reconstruct`.

        Returns
        -------
        bool
        """
        if points is None:
            return digest(check_samples(None, gram, distances).matrix) == self.input
        array, rows = finite_rows(points, "drop")
        if rows is None:
            return digest(check_samples(array).matrix) == self.input
        finite = check_samples(array[rows]).matrix
        whole = np.full((len(array), finite.shape[1]), np.nan)
        whole[rows] = finite
        return digest(whole) == self.input

    def comment(self, output: str) -> list[str]:
        """Lines for the comment of a file: version, parameters, digests."""
        values = ", ".join(
            f"{name}={said(p.value)}" for name, p in self.parameters.items()
        )
        lines = [
            f"remanifold {self.version}",
            *textwrap.wrap(f"parameters {values}", _WIDTH, subsequent_indent="  "),
            f"input {self.input}",
            f"output {output}",
        ]
        if "sha256" in self.source:
            lines.insert(-2, f"source {self.source['sha256']}")
        return lines


def provenance_of(samples: Input, parameters: Mapping[str, Parameter]) -> Provenance:
    """Of a result that has just been made."""
    system = platform.uname()
    return Provenance(
        parameters=Parameters(parameters),
        input=digest(samples.matrix),
        versions={
            "Python": platform.python_version(),
            "NumPy": np.__version__,
            # platform.platform() starts a process to name the processor.
            "platform": f"{system.system}-{system.release}-{system.machine}",
        },
        created=datetime.now(timezone.utc).isoformat(timespec="seconds"),
    )


class Used(NamedTuple):
    """What a run has settled about its parameters."""

    dim: int
    found: DimensionEstimate | None  # where the dimension was "auto"
    num_distinct: int
    search: str
    hole_radius: float
    smoothing: Smoothing | None
    num_threads: int


def parameters_of(
    options: Options, samples: Input, used: Used, more: Mapping[str, Parameter]
) -> dict[str, Parameter]:
    """All parameters of a run, those that were not given with the reason."""
    known: dict[str, Parameter] = {"dim": Parameter(used.dim, True)}
    if used.found is not None:
        why = f"estimated, confidence {used.found.confidence:.2f}"
        known["dim"] = Parameter(used.dim, False, why)
    known["method"] = Parameter(options.method, options.method != "manifold")
    known["samples"] = Parameter(samples.kind, True)
    if not options.is_paper:
        known |= _of_openings(options, used)
    known["outliers"] = _outliers(options)
    known["smooth"] = _smooth(options, samples, used)
    known["num_neighbors"] = _neighbors(options, used)
    method = f"that of the {options.method} method"
    estimator = options.estimator
    known["estimator"] = Parameter(
        options.tangent_estimator, estimator is not None, "" if estimator else method
    )
    if options.is_paper:
        known["edges"] = Parameter(options.edge_rule, options.edges is not None)
    automatic = options.search == "auto"
    why = "the faster one for so many samples and coordinates" if automatic else ""
    known["search"] = Parameter(used.search, not automatic, why)
    if used.search == "approximate":
        default = options.checks == _core.CHECKS
        known["checks"] = Parameter(int(options.checks), not default)
    known |= more
    threads = used.num_threads
    known["num_threads"] = Parameter(
        threads or None, threads > 0, "" if threads else "all cores"
    )
    return known


def _of_openings(options: Options, used: Used) -> dict[str, Parameter]:
    automatic = isinstance(options.boundary, str)
    boundary: Any = options.boundary
    if not automatic:
        rule, mask = check_boundary(boundary, np.size(boundary))
        boundary = mask.copy() if rule == "given" else False
        if rule == "given":
            boundary.flags.writeable = False
    radius = options.hole_radius
    why = ""
    if radius is None:
        why = "no boundary asked for" if not automatic else "by how evenly they lie"
    chance = options.significance
    value: float | None = options.chance
    reason = ""
    if radius is not None or not automatic or used.dim > 3:
        value, reason = None, "hole_radius or boundary decides"
        if used.dim > 3:
            reason = "for K up to 3"
    return {
        "boundary": Parameter(boundary, not automatic),
        "hole_radius": Parameter(used.hole_radius, radius is not None, why),
        "significance": Parameter(
            value, chance is not None and value is not None, reason
        ),
    }


def _outliers(options: Options) -> Parameter:
    given = options.outliers
    asked = options.outliers_or_default
    value: Any = check_outliers(asked) or False
    if given is None or isinstance(given, str):
        word = "none looked for by the paper's method" if value is False else "auto"
        return Parameter(value, given is not None, word)
    return Parameter(value, True)


def _smooth(options: Options, samples: Input, used: Used) -> Parameter:
    asked = options.smoothing_of(samples)
    given = options.smooth is not None
    smoothing = used.smoothing
    if smoothing is None:
        why = ""
        if not given:
            points = isinstance(samples, Points)
            why = "not by the paper's method" if points else "no coordinates are known"
        return Parameter(False, given, why)
    noise = rounded(smoothing.noise)
    if not smoothing.moved:
        why = f"auto: what there is of noise, {noise:g}, is not told from shape"
        return Parameter(False, given, why)
    chosen = isinstance(asked, (str, bool, np.bool_))
    word = "auto: " if isinstance(asked, str) else ""
    why = f"{word}neighbors at which noise, {noise:g}, and bias balance"
    return Parameter(smoothing.num_neighbors, given, why if chosen else "")


def _neighbors(options: Options, used: Used) -> Parameter:
    value = options.neighbors(used.dim)
    if options.num_neighbors is not None:
        return Parameter(value, True)
    if options.is_paper:
        return Parameter(value, False, "10 K")
    # As the core does where there are few.
    most = max(used.dim + 1, (used.num_distinct - 1) // 2)
    if most < value:
        return Parameter(most, False, "half of the samples")
    return Parameter(value, False, "3 times the unknowns of a quadratic fit")
