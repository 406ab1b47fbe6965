# SPDX-License-Identifier: GPL-3.0-or-later
"""The same manifold by fewer, more, or more even simplices."""
