# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions on a complex and its geometry, for any K and D, from edge lengths alone."""
