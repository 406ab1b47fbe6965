# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear under their names only when they are complete."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import stat
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TypeAlias

from remanifold.warnings import FileWarning

if sys.platform != "win32":
    import fcntl

StrPath: TypeAlias = str | os.PathLike[str]

_SHOWN = 40  # characters of a name that the name of its unfinished file shows
_ENDING = ".partial"
_RIGHTS = 0o666  # of a new file, from which the umask takes


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
    """Open a file that takes its name, and the place of another, when all is written.

    It then is on the disk, and has the rights of the file whose place it takes. What a
    run that was killed has left is named in a FileWarning by the next one.
    """
    # Written beside the target, so that the last step is a rename within one folder.
    final = _final(path)
    start = f".{final.name[:_SHOWN]}-"
    partial = final.with_name(f"{start}{secrets.token_hex(6)}{_ENDING}")
    try:
        _name_leftovers(final.parent, start)
        old = final.stat() if final.exists() else None
        # Nobody may look into it who may not look into the old one.
        rights = _RIGHTS if old is None else stat.S_IMODE(old.st_mode) & _RIGHTS
        place = os.open(partial, os.O_CREAT | os.O_EXCL | os.O_WRONLY, rights)
        with os.fdopen(place, "wb") as file:
            _lock(file.fileno())
            yield file
            file.flush()
            if old is not None:
                _take_rights(partial, old)
            os.fsync(file.fileno())
        partial.replace(final)
        _sync_folder(final.parent)
    except OSError as error:
        msg = f"{path}: cannot write the file ({error.strerror or error})"
        raise OSError(error.errno, msg) from error
    finally:
        partial.unlink(missing_ok=True)


def _take_rights(partial: Path, old: os.stat_result) -> None:
    """Owner, as far as one may give files away, and mode."""
    if hasattr(os, "chown"):
        with contextlib.suppress(OSError):
            os.chown(partial, old.st_uid, old.st_gid)
    partial.chmod(stat.S_IMODE(old.st_mode))


def _lock(file: int) -> bool:
    """Lock a file as long as it is open; whether nobody else has."""
    if sys.platform == "win32":
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        pass
    return True


def _name_leftovers(folder: Path, start: str) -> None:
    """Name unfinished files that nobody is writing any more."""
    pattern = re.compile(re.escape(start) + "[0-9a-f]{12}" + re.escape(_ENDING))
    left = []
    for name in sorted(filter(pattern.fullmatch, os.listdir(folder))):  # noqa: PTH208
        with contextlib.suppress(OSError), (folder / name).open("rb") as file:
            if _lock(file.fileno()):
                left.append(name)
    if left:
        msg = (
            f"{folder}: a run that was killed has left {', '.join(left)}, which is "
            "incomplete: remove it"
        )
        warnings.warn(msg, FileWarning, stacklevel=5)


def _sync_folder(folder: Path) -> None:
    """Have the new name on the disk as well, where a folder can be opened for that."""
    with contextlib.suppress(OSError):
        place = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)


def _final(path: StrPath) -> Path:
    """Follow links: a file behind a link is replaced, not the link."""
    return Path(os.path.realpath(path))
