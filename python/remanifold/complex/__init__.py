# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes in space and what can be asked of them."""
