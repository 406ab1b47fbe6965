# SPDX-License-Identifier: GPL-3.0-or-later
"""What an installed package does where there is nothing but what it asks for.

    python -I smoke.py REMANIFOLD

REMANIFOLD is the command as installed.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import remanifold as rm

command = Path(sys.argv[1]).resolve()
points = rm.datasets.torus(2000, random_state=0)

rec = rm.reconstruct(points, 2)
assert rec.topology().manifold
assert rec.topology().betti_numbers == (1, 2, 1)
assert rec.quality.ok, rec.quality.verdict
paper = rm.reconstruct(points, 2, method="paper")
assert len(paper.simplices) > 0
circle = rm.datasets.circle(50, random_state=0)
assert rm.reconstruct(gram=circle @ circle.T, dim=1).topology().betti_numbers == (1, 1)

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    rm.io.write_points(folder / "torus.ply", points)
    given = [command, "reconstruct", "torus.ply", "--dim", "2", "-o", "mesh.ply"]
    done = subprocess.run(
        given, cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    back = rm.io.read_complex(folder / "mesh.ply")
    assert len(back.simplices) == len(rec.simplices)

# What needs a package that is not here says which.
for missing, call in (
    ("scikit-learn", lambda: __import__("remanifold.sklearn")),
    ("trimesh", rec.to_trimesh),
    ("matplotlib", lambda: rec.plot(backend="matplotlib")),
):
    said = "nothing"
    try:
        call()
    except ImportError as error:
        said = str(error)
    assert missing in said, f"without {missing}: {said}"

print(f"smoke: {rm.__version__} works on its own, Python {sys.version.split()[0]}")
