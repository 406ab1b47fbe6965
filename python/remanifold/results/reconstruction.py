# SPDX-License-Identifier: GPL-3.0-or-later
"""A reconstruction, with all that can be asked of it as methods."""

from __future__ import annotations

import math
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from remanifold._base.files import check_target, complete_file
from remanifold._base.html import fragment
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold._base.validation import check_choice, check_int
from remanifold.complex.topology import simplex_names
from remanifold.drawing.draw_openings import plot_openings
from remanifold.drawing.draw_svg import picture
from remanifold.formats._source import Source
from remanifold.formats.saved import SUFFIX, read_saved, write_saved
from remanifold.formats.writing import fitting_fields, write_valid
from remanifold.judging.invariants import Invariants, check_invariants
from remanifold.judging.judged import JudgedReconstruction
from remanifold.method.openings import Opening
from remanifold.page.report_page import write_report
from remanifold.results.simplicial_complex import SimplicialComplex
from remanifold.warnings import ManifoldWarning

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Literal

    from numpy.typing import ArrayLike

    from remanifold._base.files import StrPath
    from remanifold.complex.topology import Topology


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Reconstruction(JudgedReconstruction, SimplicialComplex):
    """A reconstructed manifold and the intermediate results. Arrays are read-only.

    Attributes
    ----------
    vertices : ndarray, shape (N, D), float64, or None
        Where the samples stand in the complex: `samples`, or `smoothing.points`, of
        which those `attached` are at the nearest point of the complex; NaN for those of
        `invalid`.
    samples : ndarray, shape (N, D), float64, or None
        The samples, a view of the given array where that was C-contiguous float64 and no
        sample is `invalid`; None where only `gram` or `distances` were given. They are as good vertices as
        `vertices`, noise included.
    simplices : ndarray, shape (M, K+1), int32
        K-simplices, rows in the order of their sorted vertices. Columns ascend, but with
        the manifold method the last two may have changed places: where a set of simplices
        connected through faces is orientable, the order of the columns orients them
        alike, with positive volume where K = D and where K = D - 1 and the set is closed
        (outward normals).
    boundary : ndarray, shape (N,), bool
        Samples on an open face (paper: samples without a tangent basis, BD).
    representatives : ndarray, shape (N,), int32
        Lowest index of the samples that coincide with each sample.
    outliers : ndarray of int32
        Samples left out, ascending: they do not lie on the manifold of the others.
    invalid : ndarray of int32
        Samples that are no points and were left out by ``invalid="drop"``, ascending.
    vertex_attributes : dict of str to ndarray
        What ``attributes=`` gave, a row for each sample.
    attached : ndarray of int32
        Smoothed samples that are in no simplex, ascending: nearer to others than
        ``smoothing.resolution``, they would show what is left of the noise.
    smoothing : Smoothing or None
        How noisy the samples were and what was done about it; None with
        ``smooth=False``.
    method, estimator, search : str
        How the result was made.
    num_neighbors : int
        Neighbors per sample for the tangent spaces.
    recall : float
        Share of true neighbors found, below 1 only for the approximate search.
    timings : dict of str to float
        Wall seconds of each step. Whatever reads coordinates counts as neighborhoods.
    openings : tuple of Opening
        Places where samples may be missing and what was decided there, the closest
        decisions first. Manifold method, up to K = 3, with neither `hole_radius` nor
        `boundary` given.
    significance : float
        The chance, over the whole data, up to which a gap counts as an opening; 0 with
        the paper's method.
    provenance : Provenance
        Version, parameters as used, digest of the samples, when and from what.
    tangent_simplices : ndarray, shape (N, K+1), int32
        Paper: tangent basis tuples, nearest first; -1 where there is none. This and what
        follows is None with the manifold method.
    edge_sets : EdgeSets
        Paper: edge set of each sample.
    stars : Stars
        Paper: K-simplices dual to the vertices of each local region, its sample first.
    unbounded : ndarray, shape (N,), bool
        Paper: samples whose local region is unbounded.
    edge_rule : str
        Paper: which edges count. `edges` are those of the graph whose cliques the
        simplices are.
    """

    # From `reconstruct`: the same call with other decisions on openings.
    _rebuild: ClassVar[Callable[..., Reconstruction]]

    def __post_init__(self) -> None:
        """The arrays come from the core: nothing to check."""
        ReadOnlyArrays.__post_init__(self)

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=self.num_samples,
            ambient_dim=self.ambient_dim,
            dim=self.dim,
            simplices=len(self.simplices),
            method=self.method,
        )

    def _repr_html_(self) -> str:
        judged = self._is_judged_at_once
        found = self.topology()
        names = simplex_names(self.dim)
        rows: list[tuple[str, object]] = [
            ("samples", f"{self.num_samples:,}{_in_space(self.ambient_dim)}"),
            (names[-1], f"{len(self.simplices):,}"),
            ("Euler characteristic", f"{found.euler_characteristic:,}"),
        ]
        if found.counting_settles_homology:
            rows.append(("Betti numbers", ", ".join(map(str, found.betti_numbers))))
        rows += [
            (what, f"{len(which):,}")
            for what, which in (
                ("outliers left out", self.outliers),
                ("not finite, left out", self.invalid),
                ("attached", self.attached),
            )
            if len(which)
        ]
        if self.smoothing is not None and self.smoothing.moved:
            rows.append(("noise smoothed away", f"{self.smoothing.noise:.3g}"))
        if judged:
            rows.append(("samples in doubt", f"{int(self.quality.doubtful.sum()):,}"))
        seconds = math.fsum(self.timings.values())
        rows.append(("seconds", f"{seconds:.2g}"))
        note = "" if judged else "rec.quality judges it, in about the same time again."
        answer = self._answer(judged=judged).text
        return fragment(answer, rows, picture(self), note)

    def save(self, path: StrPath) -> None:
        """Write all of the result to a file that `remanifold.load` reads.

        Vertices, simplices, attributes, openings, repair, smoothing, the samples
        themselves, what has been computed of `quality`, and the `provenance`. Later
        versions read what earlier ones wrote. The file is an archive of NumPy's arrays
        and of a tree in JSON: reading it runs nothing.

        Parameters
        ----------
        path : path-like
            File to write, ``.rm.npz``; replaced when the new one is complete.

        Raises
        ------
        ValueError
            Another suffix.
        OSError
            The file cannot be written. Nothing is left behind.

        Examples
        --------
        >>> import remanifold as rm
        >>> rec = rm.reconstruct(rm.datasets.circle(50, random_state=0), 1)
        >>> rec.save("circle.rm.npz")  # doctest: +SKIP
        >>> rm.load("circle.rm.npz").parameters["dim"].value  # doctest: +SKIP
        1
        """
        target = check_saved(path)
        with complete_file(target) as file:
            write_saved(file, self)

    def check(self, *, raise_on_failure: bool = False) -> Invariants:
        """Count anew what must hold of the result, whatever the samples.

        Not whether it is the right manifold, which `quality` judges, but whether it is
        what it says it is: simplices, facets and their cofaces, links, orientation, the
        signs of volumes where K = D, exactly; what `topology`, `repair`, `boundary`,
        `edges` and ``openings`` say; that each sample is used, a copy, or left out, once;
        the digests. With the paper's method also the edge sets, stars and cliques.
        Nothing of it calls what the result was made with. It takes less time than the
        reconstruction.

        Parameters
        ----------
        raise_on_failure : bool
            Raise what else is returned.

        Returns
        -------
        Invariants
            All that were looked at, and where they do not hold.

        Raises
        ------
        AssertionError
            With `raise_on_failure`, where one does not hold: a fault of this package.

        Examples
        --------
        >>> import remanifold as rm
        >>> rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
        >>> rec.check().ok
        True
        """
        found = check_invariants(self)
        if raise_on_failure and not found.ok:
            raise AssertionError(found.answer)
        return found

    def plot_openings(self, screenshot: StrPath | None = None) -> Any:
        """Draw the size of each place in ``openings`` over its evidence.

        As in a persistence diagram, what is near the line was a close decision.

        Parameters
        ----------
        screenshot : path-like, optional
            File to write: an image as Matplotlib knows them.

        Returns
        -------
        matplotlib.figure.Figure
        """
        return plot_openings(self.openings, self.significance, screenshot)

    def reopen(self, which: int | Opening) -> Reconstruction:
        """The reconstruction with one closed place of ``openings`` left open.

        Everything else is decided as before, and earlier calls of `reopen` and `close`
        hold. Runs again from the samples: it takes as long as the reconstruction did.

        Parameters
        ----------
        which : int or Opening
            One of ``openings``, or its index.

        Returns
        -------
        Reconstruction
            A new one; its opening counts as given.

        Raises
        ------
        ValueError
            It is open, or a part that was left out, or none of these openings.
        """
        return self._decide(which, True)

    def close(self, which: int | Opening) -> Reconstruction:
        """The reconstruction with one open place of ``openings`` closed; see `reopen`.

        Parameters
        ----------
        which : int or Opening
            One of ``openings``, or its index.

        Returns
        -------
        Reconstruction
            A new one; its opening counts as given.

        Raises
        ------
        ValueError
            It is closed, or a part that was left out, or none of these openings.
        """
        return self._decide(which, False)

    def if_flipped(self, which: int | Opening) -> Topology:
        """What the topology would be if one of ``openings`` were decided otherwise.

        Takes as long as the reconstruction did: see `reopen`.

        Parameters
        ----------
        which : int or Opening
            One of ``openings``, or its index.

        Returns
        -------
        Topology

        Raises
        ------
        ValueError
            It is a part that was left out, or none of these openings.
        """
        opening = self._opening(which)
        return self._decide(opening, opening.decision == "closed").topology()

    def _opening(self, which: int | Opening) -> Opening:
        if isinstance(which, Opening):
            if not any(which is one for one in self.openings):
                msg = "which is none of the openings of this reconstruction"
                raise ValueError(msg)
            return which
        index = check_int(which, "which", minimum=0)
        if index >= len(self.openings):
            msg = f"which is {index}, but there are {len(self.openings)} openings"
            raise ValueError(msg)
        return self.openings[index]

    def _decide(self, which: int | Opening, is_open: bool) -> Reconstruction:
        opening = self._opening(which)
        decided = "open" if is_open else "closed"
        if opening.decision in (decided, "left out"):
            msg = f"which is a {opening.kind} that is {opening.decision} already"
            if opening.kind == "part":
                msg = "which is a part: its samples are too few for a manifold"
            raise ValueError(msg)
        if self._options is None:
            msg = "this result was saved by an earlier version: reconstruct again"
            raise ValueError(msg)
        decisions = (*self._decisions, (opening.samples, is_open))
        again = type(self)._rebuild(self, decisions)
        if is_open and np.array_equal(again.simplices, self.simplices):
            warnings.warn(
                "nothing stays open there: what is taken out is filled again by simplices "
                "that all samples agree on, or lies at an opening",
                ManifoldWarning,
                stacklevel=3,
            )
        return again

    def report(
        self,
        path: StrPath,
        title: str | None = None,
        command: str | None = None,
    ) -> None:
        """Write a page that shows the result and says how far to trust it.

        Parameters
        ----------
        path, title, command
            As in `remanifold.write_report`.
        """
        write_report(self, path, title, command)

    def write(
        self,
        path: StrPath,
        fields: Literal["auto", "all"] | Mapping[str, ArrayLike] | None = "auto",
        *,
        format: str | None = None,
    ) -> None:
        """Write the complex to a file; its suffix names the format.

        Parameters
        ----------
        path : str or path-like
            The file, see `SimplicialComplex.write`. ``.rm.npz`` saves all of the result,
            as `save` does.
        fields : "auto", "all", None or mapping of str to array_like
            Values at the vertices. "auto": those of `fields` that cost nothing, as far
            as the format holds them. "all": those of `quality` too, which takes about as
            long as the reconstruction if it has not been asked for before.
        format : str, optional
            The format by its suffix, such as "ply", whatever the name of the file.

        Raises
        ------
        ValueError
            If the format cannot hold the complex or the fields.
        OSError
            If the file cannot be written. Nothing is left behind.

        Notes
        -----
        Samples of `invalid` have no place in a file: vertices are numbered without them,
        and the field ``sample`` says which sample each is.
        """
        if format is None and os.fspath(path).lower().endswith(SUFFIX):
            if not isinstance(fields, str):
                msg = f"{path}: a saved result holds everything; fields is for meshes"
                raise ValueError(msg)
            check_choice(fields, "fields", ("auto", "all"))
            if fields == "all":
                _ = self.quality  # what has been computed is saved
            self.save(path)
            return
        if isinstance(fields, str):
            check_choice(fields, "fields", ("auto", "all"))
            all_fields = self.fields(quality=True if fields == "all" else None)
            fields = (
                all_fields
                if fields == "all"
                else fitting_fields(path, all_fields, format)
            )
        if len(self.invalid) and self.vertices is not None:
            write_valid(
                path,
                self.vertices,
                self.simplices,
                fields,
                format=format,
                comment=self.comment,
            )
        else:
            super().write(path, fields, format=format)


def _in_space(ambient_dim: int | None) -> str:
    return "" if ambient_dim is None else f" in R^{ambient_dim}"


def check_saved(path: StrPath) -> Path:
    """Check that a result can be saved under a name, before any work is done for it."""
    if not os.fspath(path).lower().endswith(SUFFIX):
        msg = f"{path}: a result is saved as {SUFFIX}; rec.write() is for meshes"
        raise ValueError(msg)
    return check_target(path)


def load(path: StrPath) -> Reconstruction:
    """Read a result that `Reconstruction.save` wrote, by this version or an earlier one.

    Parameters
    ----------
    path : path-like
        The file.

    Returns
    -------
    Reconstruction
        Equal to what was saved, array by array. What is computed when asked for is
        computed anew, except a `quality` that was known.

    Raises
    ------
    FileNotFoundError, OSError
        The file cannot be opened.
    ValueError
        It is no saved result, is damaged, does not have the digest that was noted when
        it was saved, or is of a later format.

    Examples
    --------
    >>> import remanifold as rm
    >>> rec = rm.load("scan.rm.npz")  # doctest: +SKIP
    >>> print(rec.parameters)  # doctest: +SKIP
    """
    source = Source(Path(path), SUFFIX)
    with source.open() as file:
        held, cached, said = read_saved(file, source.fail)
    rec = Reconstruction(**held)
    vars(rec).update(cached)
    if rec.digest != said:
        source.fail(
            f"was changed: its digest is {rec.digest}, not the {said} noted in it"
        )
    return rec
