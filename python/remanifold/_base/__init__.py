# SPDX-License-Identifier: GPL-3.0-or-later
"""What every part of the package stands on: checks, progress, read-only results."""
