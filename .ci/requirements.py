# SPDX-License-Identifier: GPL-3.0-or-later
"""Print requirements of pyproject.toml, one a line.

    python .ci/requirements.py [--lowest] GROUPS...

Groups are "build", "runtime" and the names of extras. With --lowest each requirement is
the lowest version that it allows, in its newest patch: ">=1.6" becomes "==1.6.*".
"""

import re
import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:  # pip carries the same parser
    from pip._vendor import tomli as tomllib


def groups():
    """Requirements by the name of their group."""
    pyproject = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))
    return {
        "build": pyproject["build-system"]["requires"],
        "runtime": pyproject["project"]["dependencies"],
        **pyproject["project"]["optional-dependencies"],
    }


def lowest(requirement):
    """The requirement's lower bound as the only version that it allows."""
    return re.sub(r">=\s*([0-9][0-9.]*)", r"==\1.*", requirement)


if __name__ == "__main__":
    names = [name for name in sys.argv[1:] if name != "--lowest"]
    for requirement in sorted({each for name in names for each in groups()[name]}):
        print(lowest(requirement) if "--lowest" in sys.argv else requirement)
