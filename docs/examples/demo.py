# SPDX-License-Identifier: GPL-3.0-or-later
"""A raw scan becomes a mesh: the command line on real data, and a picture of it.

    python docs/examples/demo.py [FOLDER] [--points FILE]

The scan is one range image of a face, 85,849 points straight from the scanner with
its noise, holes and stray points. It comes with the tests of PyMeshLab
(``pip install pymeshlab``, GPL-3.0), so nothing is downloaded. The mesh and the
picture go to ``build/demo``.
"""

import argparse
import importlib.util
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import meshio

from drawing import draw_points, draw_simplices, save


def scan_of_a_face():
    """The range image within the installed package, without importing its plugins."""
    package = importlib.util.find_spec("pymeshlab")
    if package is None or package.origin is None:
        sys.exit("demo: PyMeshLab carries the scan; run: pip install pymeshlab")
    folder = Path(package.origin).parent
    path = folder / "tests" / "sample_meshes" / "rangemaps" / "face000.ply"
    if not path.is_file():
        sys.exit(f"demo: {path} is missing; name another file with --points")
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path("build/demo"))
    parser.add_argument("--points", type=Path, help="samples of a surface in space")
    arguments = parser.parse_args()
    scan = arguments.points or scan_of_a_face()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    output = arguments.folder / "mesh.ply"
    command = ["reconstruct", str(scan), "--dim", "2", "-o", str(output)]
    print("$ remanifold", *command, flush=True)
    result = subprocess.run([sys.executable, "-m", "remanifold", *command], check=False)
    if result.returncode:
        sys.exit(result.returncode)

    mesh = meshio.read(output)
    points, triangles = mesh.points, mesh.cells_dict["triangle"]
    picture, (left, right) = plt.subplots(1, 2, figsize=(9, 6), layout="constrained")
    upright = points[:, [0, 2, 1]] * [1.0, -1.0, 1.0]  # the scan's y points up
    view = (-62.0, 8.0)
    draw_points(left, upright, view, size=0.25)
    draw_simplices(right, upright, triangles, view, line_width=0)
    save(picture, arguments.folder / "mesh.png")
    print(f"picture: {arguments.folder / 'mesh.png'}")


if __name__ == "__main__":
    main()
