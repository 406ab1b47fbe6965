# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear under their names only when they are complete."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TypeAlias

StrPath: TypeAlias = str | os.PathLike[str]


def check_target(path: StrPath) -> Path:
    """Check that a file can be written, before any work is done for it."""
    path = Path(path)
    if path.is_dir():
        msg = f"{path}: is a directory, expected the name of a file"
        raise IsADirectoryError(msg)
    if path.exists() and not path.is_file():
        msg = f"{path}: is not a regular file"
        raise ValueError(msg)
    folder = _final(path).parent
    if not folder.is_dir():
        msg = f"{path}: the folder {folder} does not exist"
        raise FileNotFoundError(msg)
    if not os.access(folder, os.W_OK):
        msg = f"{path}: no permission to write to the folder {folder}"
        raise PermissionError(msg)
    return path


@contextmanager
def complete_file(path: StrPath) -> Iterator[IO[bytes]]:
    """Open a file that takes its name, and the place of another, when all is written."""
    # Written beside the target, so that the last step is a rename within one folder.
    final = _final(path)
    partial = final.with_name(f".{final.stem}-{secrets.token_hex(6)}{final.suffix}")
    try:
        with partial.open("wb") as file:
            yield file
        partial.replace(final)
    except OSError as error:
        msg = f"{path}: cannot write the file ({error.strerror or error})"
        raise OSError(error.errno, msg) from error
    finally:
        partial.unlink(missing_ok=True)


def _final(path: StrPath) -> Path:
    """Follow links: a file behind a link is replaced, not the link."""
    return Path(os.path.realpath(path))
