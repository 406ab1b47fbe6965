# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files of every format, for hours: a result, or one clear line that names the file.

    python tests/fuzz/fuzz_readers.py --seconds 600 --seed 1 [--only .ply .vtu] [--go-on]

With Atheris, which is installed by hand (`pip install atheris`), it sees which lines of the
readers an input reaches and goes on from there; without, changes are drawn at random. What
is found is kept in ``build/fuzz``; it belongs into ``tests/fuzz/corpus/readers`` with the
mend, where `test_fuzz.py` reads it.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOUND = ROOT / "build" / "fuzz"
sys.path.insert(0, str(ROOT / "tests" / "python" / "formats"))

try:
    import atheris
except ImportError:
    atheris = None

if atheris is not None:
    with atheris.instrument_imports(include=["remanifold.formats"]):
        import test_fuzz
else:
    import test_fuzz

# Each is read by a library of its own, whose faults are not looked for here.
OTHERS = (".parquet", ".zarr", ".e57", ".las", ".laz")
LONGEST = 1 << 14  # bytes of an input
WORDS = (
    *(b"inf nan -1 0 1e999 99999999999999999999 \n \r\n \0 \xef\xbb\xbf".split(b" ")),
    *(b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\xff" * 8),
    *(b"element vertex ", b"property list uchar int ", b"POINTS ", b"<AppendedData>"),
)


def seeds(suffixes: list[str], folder: Path) -> list[bytes]:
    """One byte for the format, then a whole file of it."""
    inputs = []
    for number, suffix in enumerate(suffixes):
        for path in test_fuzz.examples(suffix, folder):
            inputs.append(bytes([number]) + path.read_bytes()[:LONGEST])
    return inputs


def changed(data: bytes, other: bytes, chance: random.Random) -> bytes:
    """Bits turned over, parts gone, twice, of another file, words that readers know."""
    spoiled = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        place = chance.randrange(1, max(2, len(spoiled)))
        if chance.random() < 0.5:  # the beginning says how to read the rest
            place = min(place, chance.randrange(1, 400))
        kind = chance.randrange(6)
        if kind == 0:
            spoiled[place : place + 1] = bytes([chance.randrange(256)])
        elif kind == 1:
            del spoiled[place : place + chance.randint(1, 60)]
        elif kind == 2:
            spoiled[place:place] = chance.choice(WORDS)
        elif kind == 3:
            spoiled[place : place + 8] = chance.choice(WORDS)
        elif kind == 4:
            start = chance.randrange(len(other))
            spoiled[place:place] = other[start : start + chance.randint(1, 60)]
        else:
            del spoiled[place:]
    return bytes(spoiled)


class Target:
    """Reads an input as a file of the format that its first byte names."""

    def __init__(self, suffixes: list[str], folder: Path, go_on: bool) -> None:
        self.suffixes = suffixes
        self.go_on = go_on
        self.places: set[tuple[str, int]] = set()  # of the code that raised
        self.folder = folder
        self.count = 0
        self.complaints = 0

    def __call__(self, data: bytes) -> None:
        if len(data) < 2:
            return
        self.count += 1
        path = self.folder / f"input{self.suffixes[data[0] % len(self.suffixes)]}"
        path.write_bytes(data[1:])
        try:
            self.complaints += test_fuzz.try_all(path)
        except Exception as error:
            self.keep(data[1:], path.suffix, error)
            if not self.go_on:
                raise

    def keep(self, data: bytes, suffix: str, error: Exception) -> None:
        """Keep what was found, once for each place."""
        cause: BaseException = error
        while cause.__context__ is not None:
            cause = cause.__context__
        frame = traceback.extract_tb(cause.__traceback__)[-1]
        place = (frame.filename, frame.lineno or 0)
        if place not in self.places:
            self.places.add(place)
            FOUND.mkdir(parents=True, exist_ok=True)
            path = FOUND / f"{hashlib.sha256(data).hexdigest()[:12]}{suffix}"
            path.write_bytes(data)
            print(f"found: {path}: {error!r} of {cause!r} at {place}", file=sys.stderr)


def main() -> None:
    """Fuzz as long as asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    known = [suffix for suffix in test_fuzz.READERS if suffix not in OTHERS]
    parser.add_argument("--only", nargs="*", choices=known, default=known)
    parser.add_argument("--go-on", action="store_true", help="after a finding")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "whole").mkdir()
        inputs = seeds(arguments.only, folder / "whole")
        target = Target(arguments.only, folder, arguments.go_on)
        if atheris is None:
            chance = random.Random(arguments.seed)
            end = time.monotonic() + arguments.seconds
            while time.monotonic() < end:
                target(changed(chance.choice(inputs), chance.choice(inputs), chance))
            print(f"{target.count} files, {target.complaints} complaints")
            sys.exit(1 if target.places else 0)
        corpus = folder / "corpus"
        corpus.mkdir()
        for number, data in enumerate(inputs):
            (corpus / str(number)).write_bytes(data)
        options = [
            f"-max_total_time={arguments.seconds}",
            f"-seed={arguments.seed}",
            f"-max_len={LONGEST}",
            *("-timeout=60", "-rss_limit_mb=3000", "-print_final_stats=1"),
        ]
        atheris.Setup([sys.argv[0], *options, str(corpus)], target)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
