# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of complexes by PyVista, Plotly or Matplotlib, imported when asked for."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

from remanifold._base.optional import load
from remanifold._base.validation import check_choice, check_int
from remanifold.complex.data import check_complex
from remanifold.complex.embedding import METHODS as EMBEDDINGS
from remanifold.complex.embedding import embed
from remanifold.drawing import draw_matplotlib, draw_plotly
from remanifold.drawing.draw_pyvista import has_display, need_renderer, plotter, quiet
from remanifold.drawing.scene import scene_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from remanifold._base.files import StrPath
    from remanifold.complex.data import ComplexData
    from remanifold.complex.embedding import EmbeddingMethod
    from remanifold.drawing.scene import Scene, Style

Backend: TypeAlias = Literal["auto", "pyvista", "plotly", "matplotlib"]
BACKENDS: tuple[str, ...] = get_args(Backend)
# Simplices beyond which a picture gets slow.
LIMITS = {"pyvista": 500_000, "plotly": 60_000, "matplotlib": 20_000}
PAGES = (".html", ".htm")


def plot(
    complex: ComplexData,
    *,
    color: str | ArrayLike | None = None,
    style: Style = "auto",
    show_samples: bool = False,
    show_doubtful: bool = False,
    embedding: EmbeddingMethod = "auto",
    backend: Backend = "auto",
    title: str = "",
    screenshot: StrPath | None = None,
    show: bool | None = None,
    window_size: Sequence[int] | None = None,
    max_simplices: int | None = None,
) -> Any:
    """Draw a complex.

    Parameters
    ----------
    complex : SimplicialComplex or Reconstruction
        In any number of dimensions, or known by products only; what `remanifold.embed`
        makes of more than three is said in the picture.
    color : str or array_like, shape (N,) or (N, 3), optional
        Values of the vertices, or their colors: red, green and blue from 0 to 1 or 0 to
        255. Or the name of one of `vertex_attributes`, numbers or colors; or "component",
        "boundary", "quality" (shape of the simplices: 1 if regular, 0 if flat, the mean
        at each vertex) or, for a Reconstruction, an array of `Reconstruction.quality`:
        "spacing", "curvature", "reach", "sampling_ratio", "tangent_confidence",
        "disputed", "fold", "gap" or "doubtful". Numbers span the percentiles 1 to 99;
        what is NaN is gray.
    style : {"auto", "surface", "shrunken", "cut", "edges"}
        Triangles or their edges only; for K = 3 tetrahedra drawn apart within the
        boundary, or "surface", the boundary alone, or "cut", the half of the tetrahedra
        behind a plane, so that the inside shows. Beyond K = 3 there are edges.
    show_samples : bool
        Draw the samples, where they were given, or the vertices.
    show_doubtful : bool
        Mark the samples that `Reconstruction.quality` doubts, and outliers.
    embedding : {"auto", "pca", "geodesic"}
        See `remanifold.embed`.
    backend : {"auto", "pyvista", "plotly", "matplotlib"}
        "auto" is Matplotlib for curves and PyVista for everything else.
    title : str
        First line above the picture.
    screenshot : path-like, optional
        File to write: an image as PyVista and Matplotlib know them, or ``.html`` with
        Plotly, which writes images only with its package kaleido.
    show : bool, optional
        Open a window, or with Plotly the browser. By default unless there is a
        `screenshot`; Matplotlib's and Plotly's figures show themselves in notebooks.
    window_size : (int, int), optional
        Width and height in pixels.
    max_simplices : int, optional
        Complexes with more are coarsened for display, or drawn in part, which the
        picture then says: by default 500,000 for PyVista, 60,000 for Plotly and 20,000
        for Matplotlib.

    Returns
    -------
    pyvista.Plotter, plotly.graph_objects.Figure or matplotlib.figure.Figure
        To add to, or to show.

    Raises
    ------
    ImportError
        The library is not installed.
    OSError
        A window is wanted and there is no display; or PyVista has nothing to draw with.
    ValueError, TypeError
        Unknown words; values of another shape; what only a Reconstruction has.

    Examples
    --------
    >>> import remanifold as rm
    >>> rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    >>> picture = rm.plot(rec, color="sampling_ratio", show=False)  # doctest: +SKIP
    """
    check_choice(backend, "backend", BACKENDS)
    check_choice(embedding, "embedding", EMBEDDINGS)
    check_complex(complex)
    if backend == "auto":
        backend = "matplotlib" if complex.dim < 2 else "pyvista"
    limit = LIMITS[backend]
    if max_simplices is not None:
        limit = check_int(max_simplices, "max_simplices", minimum=1)
    size = None
    if window_size is not None:
        width, height = window_size
        size = (
            check_int(width, "window_size[0]", minimum=1),
            check_int(height, "window_size[1]", minimum=1),
        )
    path = None if screenshot is None else Path(screenshot)
    if path is not None and backend != "plotly" and path.suffix.lower() in PAGES:
        msg = f'screenshot is {path.name!r}: pages are written by backend="plotly"'
        raise ValueError(msg)
    load(backend, "plot")
    if show is None:
        show = path is None
    scene = scene_of(
        complex,
        color=color,
        style=style,
        placed=embed(complex, embedding),
        show_samples=show_samples,
        show_doubtful=show_doubtful,
        limit=limit,
    )
    draw = {
        "pyvista": _by_pyvista,
        "plotly": _by_plotly,
        "matplotlib": _by_matplotlib,
    }[backend]
    return draw(scene, title, size, path, show)


def _by_pyvista(
    scene: Scene,
    title: str,
    size: tuple[int, int] | None,
    path: Path | None,
    show: bool,
) -> Any:
    inside = in_notebook()
    if show and not inside:
        _need_display()
    need_renderer()
    # A plotter that is neither shown nor saved here may be shown later.
    off_screen = inside or not has_display() or (not show and path is not None)
    with quiet():
        drawn = plotter(scene, title, size, off_screen=off_screen)
        if path is not None:
            drawn.screenshot(str(path))
    if show:
        # Pictures that turn inside a notebook need trame, plain ones nothing.
        turning = inside and _importable("trame") and _importable("trame_vtk")
        drawn.show(jupyter_backend=None if turning or not inside else "static")
    return drawn


def _by_plotly(
    scene: Scene,
    title: str,
    size: tuple[int, int] | None,
    path: Path | None,
    show: bool,
) -> Any:
    drawn = draw_plotly.figure(scene, title, size)
    if path is not None and path.suffix.lower() in PAGES:
        drawn.write_html(path, include_plotlyjs=True)
    elif path is not None:
        if not _importable("kaleido"):
            msg = (
                f"screenshot is {path.name!r}: Plotly writes .html, and images only with "
                '`pip install kaleido`; backend="pyvista" needs nothing more'
            )
            raise ImportError(msg)
        drawn.write_image(path)
    if show and not in_notebook():
        drawn.show()
    return drawn


def _by_matplotlib(
    scene: Scene,
    title: str,
    size: tuple[int, int] | None,
    path: Path | None,
    show: bool,
) -> Any:
    if show and not in_notebook():
        _need_display()
    drawn = draw_matplotlib.figure(scene, title, size, interactive=show)
    if path is not None:
        drawn.savefig(path, bbox_inches="tight")
    if show and not in_notebook():
        from matplotlib import pyplot as plt

        plt.show()
    return drawn


def in_notebook() -> bool:
    """Tell a Jupyter kernel from a terminal."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return type(shell).__name__ == "ZMQInteractiveShell"


def _importable(package: str) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            importlib.import_module(package)
        except ImportError:
            return False
    return True


def _need_display() -> None:
    """On X11 and Wayland a window without a display ends the process or hangs."""
    if not has_display():
        msg = "there is no display to show a window on; give screenshot= or show=False"
        raise OSError(msg)
