# SPDX-License-Identifier: GPL-3.0-or-later
"""Write .ci/constraints.txt: what a fresh machine installs, to the last version.

    python .ci/constraints.py

Asks pip for the newest versions that go together, once for each Python at hand, of all
that the Makefile installs but for the peers of the benchmarks.
"""

import json
import re
import subprocess
import tempfile
from pathlib import Path

from requirements import groups

PYTHONS = (10, 11, 12, 13, 14)  # 3.x
OUTPUT = Path(".ci/constraints.txt")
HEADER = """\
# What a fresh machine installs, for each Python. Made by `make constraints`.
"""


def runs(python):
    """Whether there is such a Python; a shim without one behind it is none."""
    try:
        done = subprocess.run([python, "--version"], capture_output=True, check=False)
    except OSError:
        return False
    return done.returncode == 0


def resolve(minor, wanted, folder):
    """Versions by name that pip would install into an empty environment."""
    environment = Path(folder) / f"3.{minor}"
    subprocess.run([f"python3.{minor}", "-m", "venv", environment], check=True)
    pip = [environment / "bin" / "python", "-m", "pip"]
    subprocess.run([*pip, "install", "-q", "--upgrade", "pip"], check=True)
    report = Path(folder) / f"3.{minor}.json"
    ask = [*pip, "install", "-q", "--dry-run", "--ignore-installed"]
    subprocess.run([*ask, "--report", report, *wanted], check=True)
    found = json.loads(report.read_text(encoding="utf-8"))["install"]
    return {
        re.sub(r"[-_.]+", "-", item["metadata"]["name"]).lower(): item["metadata"][
            "version"
        ]
        for item in found
    }


def marker(minors, known):
    """For which Pythons a line holds; what is newer than all is taken for the newest."""
    if minors == known:
        return ""
    newest = [f'python_version >= "3.{known[-1]}"'] if known[-1] in minors else []
    others = [f'python_version == "3.{m}"' for m in minors if m != known[-1]]
    return "; " + " or ".join(others + newest)


def main():
    """Resolve for each Python and write what differs with a marker."""
    known = [minor for minor in PYTHONS if runs(f"python3.{minor}")]
    print("constraints: for Python", ", ".join(f"3.{minor}" for minor in known))
    wanted = {
        each for name, some in groups().items() if name != "bench" for each in some
    }
    with tempfile.TemporaryDirectory() as folder:
        versions = {minor: resolve(minor, sorted(wanted), folder) for minor in known}
    lines = []
    for name in sorted(set().union(*versions.values())):
        by_version = {}
        for minor, found in versions.items():
            by_version.setdefault(found.get(name), []).append(minor)
        by_version.pop(None, None)  # the Pythons that do without it
        for version, minors in by_version.items():
            lines.append(f"{name}=={version}{marker(minors, known)}")
    OUTPUT.write_text(HEADER + "\n".join(lines) + "\n", encoding="utf-8")
    print(f"constraints: {len(lines)} lines in {OUTPUT}")


if __name__ == "__main__":
    main()
