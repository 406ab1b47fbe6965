# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file seems to be by its first bytes, and what to do with one of another kind."""

from __future__ import annotations

import re

from remanifold.formats._source import Source

START = 2048
# First bytes, what they are the mark of, and the suffix of what can be read.
_MARKS: tuple[tuple[bytes, str, str | None], ...] = (
    (rb"ply\s", "a PLY file", ".ply"),
    (rb"LASF", "a LAS file", ".las"),
    (rb"ASTM-E57", "an E57 file", ".e57"),
    (rb"\x93NUMPY", "a NumPy array", ".npy"),
    (rb"glTF", "a GLB file", ".glb"),
    (rb"PAR1", "a Parquet file", ".parquet"),
    (rb"(?:# ?\.PCD|VERSION [.\d]+\s+FIELDS)", "a PCD file", ".pcd"),
    (rb"# vtk DataFile", "a legacy VTK file", ".vtk"),
    (rb"(?s).{0,300}<VTKFile[^>]*type=.PolyData", "a VTK file of polygons", ".vtp"),
    (rb"(?s).{0,300}<VTKFile[^>]*type=.UnstructuredGrid", "a VTK grid", ".vtu"),
    (rb"(?s).{0,300}<VTKFile", "a VTK file of a kind that is not read here", None),
    (rb"(?:ST)?C?N?n?OFF\s", "an OFF file", ".off"),
    (rb"(?s)solid\b.{0,1000}facet", "an STL file", ".stl"),
    (rb"(?s)\s*\{.{0,1500}\"asset\"", "a glTF file", ".gltf"),
    (
        rb"version https://git-lfs",
        "a pointer to a file in Git LFS: run git lfs pull",
        None,
    ),
    (rb"(?is)\s*(?:<!doctype html|<html)", "a web page, not the file itself", None),
    (rb"\x89PNG", "a PNG picture", None),
    (rb"\xff\xd8\xff", "a JPEG picture", None),
    (rb"(?:II\*\0|MM\0\*)", "a TIFF picture; save its pixels as .npy", None),
    (rb"%PDF", "a PDF document", None),
    (rb"\x28\xb5\x2f\xfd", "compressed by zstd: unzstd it first", None),
    (rb"7z\xbc\xaf", "a 7z archive: unpack it first", None),
    (rb"\x89HDF", "an HDF5 file; save its array by h5py as .npy", None),
    (rb"CDF[\x01\x02]", "a NetCDF file; save its array as .npy", None),
    (rb"MATLAB 5.0", "a file of MATLAB; save its array by scipy.io as .npy", None),
    (rb"SQLite format", "a database of SQLite", None),
    (rb"\x80[\x02-\x05]", "a pickle of Python; save its array by numpy.save", None),
    (rb"Kaydara FBX", "an FBX file; export it as .ply or .glb", None),
    (rb"\xd0\xcf\x11\xe0", "a document of an old Office; save it as .csv", None),
)
_ZIP = (
    (b"xl/", "a spreadsheet; save it as .csv", None),
    (b"word/", "a document of Word", None),
    (b"3D/", "a 3MF file; export it as .ply or .stl", None),
    (b".npy", "an archive of NumPy", ".npz"),
)


def seems(start: bytes) -> tuple[str, str | None]:
    """What the first bytes are those of, and its suffix if it can be read; or nothing."""
    if not start.strip():
        return ("empty" if not start else "blank"), None
    for pattern, what, suffix in _MARKS:
        if re.match(pattern, start):
            return what, suffix
    if start[:4] == b"PK\3\4":
        for inside, what, suffix in _ZIP:
            if inside in start:
                return what, suffix
        return "a ZIP archive: unpack it first", None
    lines = start.splitlines()[:40]
    if sum(bool(re.match(rb"v\s+[-\d.]", line)) for line in lines) > 1:
        return "an OBJ file", ".obj"
    rows = [
        line for line in lines[:-1] if re.match(rb"\s*[-+.\d][-+.,;\d\seE]*$", line)
    ]
    if len(rows) > 1 and len(rows) * 2 > len(lines):
        if any(
            (b"," in row and b" " not in row.strip()) or b";" in row for row in rows
        ):
            return "a table with commas or semicolons", ".csv"
        return "a table with blanks", ".txt"
    return "", None


def advice(source: Source) -> str:
    """What to do with a file that cannot be read; empty where its bytes say nothing."""
    try:
        with source.open() as file:
            what, suffix = seems(file.read(START))
    except OSError:
        return ""
    related = ({".npy", ".npz"}, {".las", ".laz"}, {".csv", ".txt", ".tsv"})
    if not what or suffix == source.suffix:
        return ""
    if any({suffix, source.suffix} <= group for group in related):
        return ""
    if suffix in (".csv", ".txt") and source.suffix in (".xyz", ".asc", ".pts", ".ptx"):
        return ""
    if what in ("empty", "blank"):
        return f"the file is {what}"
    if suffix is None:
        return f"it seems to be {what}"
    return f"it seems to be {what}: say format {suffix[1:]!r}, or name it {suffix}"
