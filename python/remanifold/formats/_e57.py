# SPDX-License-Identifier: GPL-3.0-or-later
"""E57, the exchange format of scanners, by pye57."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.optional import load
from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import FloatArray, Source


def read_e57(source: Source, with_fields: bool) -> FileMesh:
    """Read all scans in common coordinates; points that were not seen are NaN."""
    pye57 = load("pye57", "e57")
    _check_header(source)
    points: list[FloatArray] = []
    scans: list[dict[str, NDArray[Any]]] = []
    try:
        with source.on_disk() as path:
            file = pye57.E57(str(path))
            try:
                bits = 8 * path.stat().st_size
                for i in range(file.scan_count):
                    count = file.get_header(i).point_count
                    if count > bits:  # not one for each, and memory for all
                        msg = f"it promises {count:,} points, and holds {bits // 8:,} bytes"
                        raise ValueError(msg)
                    found, fields = _scan(file, i)
                    points.append(found)
                    scans.append(fields)
            finally:
                file.close()
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # noqa: BLE001  whatever stumbles over damage first
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        source.fail(f"is damaged, truncated or no E57 file ({reason})", error)
    if not points:
        source.fail("holds no scans")
    mesh = FileMesh(np.concatenate(points))
    mesh.chosen = f"coordinates are those of {len(scans)} scans, put together"
    if with_fields:
        names = [n for n in scans[0] if all(n in scan for scan in scans)]
        lost = {name for scan in scans for name in scan} - {*names}
        if lost:
            source.note(f"fields that not all scans have are left out: {sorted(lost)}")
        mesh.fields = {n: np.concatenate([scan[n] for scan in scans]) for n in names}
        if len(scans) > 1:
            numbers = np.arange(len(scans), dtype=np.int32)
            mesh.fields["scan"] = np.repeat(numbers, [len(part) for part in points])
    return mesh


def _scan(file: Any, i: int) -> tuple[FloatArray, dict[str, NDArray[Any]]]:
    """Points of one scan where its pose puts them, and what goes with them."""
    header = file.get_header(i)
    known = {*header.point_fields}
    raw = file.read_scan_raw(i)
    if {"cartesianX", "cartesianY", "cartesianZ"} <= known:
        axes = np.column_stack([np.asarray(raw[f"cartesian{a}"], float) for a in "XYZ"])
        state = raw.get("cartesianInvalidState")
    else:
        keys = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
        reach, azimuth, elevation = (np.asarray(raw[key], dtype=float) for key in keys)
        flat = reach * np.cos(elevation)
        parts = (
            flat * np.cos(azimuth),
            flat * np.sin(azimuth),
            reach * np.sin(elevation),
        )
        axes = np.column_stack(parts)
        state = raw.get("sphericalInvalidState")
    if header.has_pose():
        axes = axes @ np.asarray(header.rotation_matrix).T + np.asarray(
            header.translation
        )
    if state is not None:
        axes[np.asarray(state) != 0] = np.nan
    fields: dict[str, NDArray[Any]] = {}
    if {"colorRed", "colorGreen", "colorBlue"} <= known:
        colors = np.column_stack([raw[f"color{c}"] for c in ("Red", "Green", "Blue")])
        fields["colors"] = colors.astype(
            np.uint8 if colors.max(initial=0) < 256 else np.uint16
        )
    for key in ("intensity", "rowIndex", "columnIndex", "timeStamp", "returnIndex"):
        if key in known:
            fields[key] = np.asarray(raw[key])
    return axes, fields


def _check_header(source: Source) -> None:
    """Refuse what is cut short: the library would say so in many lines."""
    with source.open() as file:
        head = file.read(48)
        size = file.seek(0, 2)
    if head[:8] != b"ASTM-E57":
        source.fail("expected an E57 file, which begins with 'ASTM-E57'")
    if len(head) < 48:
        source.fail(f"is truncated: expected an E57 header, found {len(head):,} bytes")
    expected = int.from_bytes(head[16:24], "little")
    if expected > size:
        source.fail(f"is truncated: expected {expected} bytes, found {size}")
