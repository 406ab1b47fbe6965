# SPDX-License-Identifier: GPL-3.0-or-later
"""Versions in the report header, Ctrl-C, and the optional development data."""

import os
import platform
import signal
from importlib import metadata
from pathlib import Path

import pytest
from hypothesis import settings

PACKAGES = ("remanifold", "numpy", "scipy", "gudhi", "hypothesis")
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

settings.register_profile("thorough", max_examples=3 * settings.default.max_examples)

# A background job of a script starts with Ctrl-C ignored, and so would its children.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure(config: pytest.Config) -> None:
    """Few samples are in doubt, outliers left out, few in many coordinates: it is meant so.

    Those of the warnings themselves catch them all the same.
    """
    for kind in ("DoubtWarning", "DroppedWarning", "TransposedWarning"):
        config.addinivalue_line("filterwarnings", f"ignore::remanifold.{kind}")


def version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "absent"


def pytest_report_header() -> list[str]:
    return [
        "versions: " + ", ".join(f"{name} {version(name)}" for name in PACKAGES),
        f"machine: {platform.machine()}, {os.cpu_count()} cores",
    ]


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of the development data, which is no part of this repository."""
    folder = Path(os.environ.get("REMANIFOLD_DATA", DATA))
    if not folder.is_dir():
        pytest.skip(f"no development data: {folder} is absent (REMANIFOLD_DATA)")
    return folder
