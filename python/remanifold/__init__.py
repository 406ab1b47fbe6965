# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplicial reconstruction of manifolds from their samples.

>>> import remanifold as rm
>>> points = rm.datasets.torus(2000, random_state=0)
>>> rec = rm.reconstruct(points, 2)
>>> rec.simplices.shape[1]
3
"""

import importlib
import typing

try:
    from remanifold import _core
except ImportError as error:
    _HINT = (
        f"{error}. The compiled part of remanifold is missing; install the package "
        "with pip rather than importing it from its source tree"
    )
    raise ImportError(_HINT) from error

if typing.TYPE_CHECKING:
    from remanifold._public import *

__version__: str = _core.__version__


def _load() -> None:
    """Make all public names known. With NumPy they are most of what an import takes."""
    public = importlib.import_module("remanifold._public")
    # None yet where one of them asks for another while they are loaded.
    names = getattr(public, "__all__", [])
    globals().update({name: getattr(public, name) for name in names})
    if names:
        globals()["__all__"] = names


if not typing.TYPE_CHECKING:  # which would take any name for known

    def __getattr__(name: str) -> object:
        if name in {"distributed", "sklearn"}:  # which take long, or need an extra
            return importlib.import_module(f"{__name__}.{name}")
        if name == "__all__" or not name.startswith("_"):
            _load()
            if name in globals():  # rooms of the package as well
                return globals()[name]
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)


def __dir__() -> list[str]:
    """Public names: the rooms of the package are none."""
    _load()
    own = {name for name in globals() if name.startswith("__")}
    return sorted({*globals()["__all__"], *own} - {"__dir__", "__getattr__"})
