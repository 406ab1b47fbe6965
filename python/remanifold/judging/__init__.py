# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a result can be trusted, and where the samples are no manifold."""
