# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of complexes, whichever library draws them."""
