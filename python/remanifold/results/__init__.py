# SPDX-License-Identifier: GPL-3.0-or-later
"""The classes that users hold, on top of the functions that are their methods."""
