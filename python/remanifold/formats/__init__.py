# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of points and meshes, and the objects of other libraries."""
