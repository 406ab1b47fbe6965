# SPDX-License-Identifier: GPL-3.0-or-later
"""A reconstruction on one page of HTML."""
