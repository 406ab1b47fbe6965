# SPDX-License-Identifier: GPL-3.0-or-later
"""``python -m remanifold``."""

from remanifold.cli import main

if __name__ == "__main__":
    main()
