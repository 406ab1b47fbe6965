# SPDX-License-Identifier: GPL-3.0-or-later
"""From samples to a complex, step by step and in one call."""
