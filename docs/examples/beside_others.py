# SPDX-License-Identifier: GPL-3.0-or-later
"""The README's picture: noisy samples of a torus, and what becomes of them.

    python docs/examples/beside_others.py [DIRECTORY]

Writes beside_others.png into the directory, docs/figures by default. PyMeshLab's ball
pivoting and screened Poisson, with normals that it estimates and orients, by default.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
import pymeshlab
import pyvista
from PIL import Image

import remanifold as rm

FIGURES = Path(__file__).resolve().parents[1] / "figures"
SAMPLES = 20_000
NOISE = 2.0  # in median distances to the nearest neighbor
SAMPLE_COLOR = "#5b6b7b"
MESH_COLOR = "#e0a458"


def noisy_torus():
    points = rm.datasets.torus(SAMPLES, random_state=0)
    spacing = np.median(rm.neighborhoods(points, 1).distances)
    return rm.datasets.add_noise(points, NOISE * spacing, random_state=1)


def by_pymeshlab(points, build):
    """The mesh that a filter makes, as a complex."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(points))
    meshes.compute_normal_for_point_clouds()
    build(meshes)
    mesh = meshes.current_mesh()
    return rm.SimplicialComplex(mesh.vertex_matrix(), mesh.face_matrix())


def said(complex_):
    topology = complex_.topology()
    if topology.manifold:
        return topology.name or "Betti numbers " + ", ".join(
            str(number) for number in topology.betti_numbers
        )
    return f"no manifold, {topology.components:,} pieces"


def main():
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    where = Path(sys.argv[1]) if len(sys.argv) > 1 else FIGURES
    points = noisy_torus()
    results = {
        "ball pivoting": by_pymeshlab(
            points, lambda m: m.generate_surface_reconstruction_ball_pivoting()
        ),
        "screened Poisson": by_pymeshlab(
            points, lambda m: m.generate_surface_reconstruction_screened_poisson()
        ),
        "remanifold": rm.reconstruct(points, 2),
    }
    plotter = pyvista.Plotter(
        off_screen=True, shape=(1, 4), window_size=(1600, 400), border=False
    )
    plotter.subplot(0, 0)
    plotter.add_points(points, color=SAMPLE_COLOR, point_size=2)
    titles = [f"{SAMPLES:,} samples\nnoise of two spacings"]
    for i, (name, result) in enumerate(results.items(), start=1):
        plotter.subplot(0, i)
        plotter.add_mesh(result.to_pyvista(), color=MESH_COLOR)
        titles.append(f"{name}\n{said(result)}")
        print(titles[-1].replace("\n", ": "))
    for i, title in enumerate(titles):
        plotter.subplot(0, i)
        plotter.add_text(title, position="upper_edge", font_size=9, color="#303030")
        plotter.set_background("white")
        plotter.view_vector((0.3, -1.0, 0.8), viewup=(0, 0, 1))
        plotter.camera.zoom(1.25)
    image = Image.fromarray(plotter.screenshot(return_img=True))
    plotter.close()
    image.quantize(128).save(where / "beside_others.png", optimize=True)


if __name__ == "__main__":
    main()
