# SPDX-License-Identifier: GPL-3.0-or-later
"""Print requirements of pyproject.toml, one a line.

Arguments: "build", "runtime" or the names of extras.
"""

import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:  # pip carries the same parser
    from pip._vendor import tomli as tomllib

pyproject = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))
groups = {
    "build": pyproject["build-system"]["requires"],
    "runtime": pyproject["project"]["dependencies"],
    **pyproject["project"]["optional-dependencies"],
}
for name in sys.argv[1:]:
    print(*groups[name], sep="\n")
