# SPDX-License-Identifier: GPL-3.0-or-later
"""What the README, the page on limits and SECURITY.md promise, each with a test of it.

A test here names the sentence it is about, which must stand on the page. What other tests
are about is listed with them, and what no test can be about with the reason: a sentence of
the page on limits that is in neither place fails.
"""

from __future__ import annotations

import functools
import math
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import remanifold as rm
from remanifold import datasets
from remanifold.formats.reading import READERS

ROOT = Path(__file__).resolve().parents[3]
README, LIMITS, SECURITY = "README.md", "docs/limits.md", "SECURITY.md"


@functools.cache
def page(name):
    return " ".join((ROOT / name).read_text(encoding="utf-8").split())


CLAIMED: dict[tuple[str, str], str] = {}


def claims(name, *sentences):
    """Say which sentences of a page a test is about."""

    def mark(test):
        for sentence in sentences:
            CLAIMED[name, sentence] = test.__name__
        return test

    return mark


def reconstruct(*arguments, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        return rm.reconstruct(*arguments, **options)


# --- README ---------------------------------------------------------------------------


@claims(README, "in any of [24 formats]", "[Sixteen tasks](docs/tasks.md)")
@claims("docs/quickstart.md", "`.csv`, `.npz` and [19 other formats](files.md#formats)")
def test_numbers_of_formats_and_tasks():
    assert len(READERS) == 24 == 5 + 19
    tasks = (ROOT / "docs/tasks.md").read_text(encoding="utf-8")
    assert len(re.findall("(?m)^## ", tasks)) == 16


@claims(
    README,
    "`rec.openings` lists it. `False`: everything is closed.",
    "decides instead of the evidence: radius of the smallest hole that stays open, in "
    "units of the local spacing",
)
def test_hole_radius_and_boundary():
    cap = datasets.spherical_cap(400, random_state=0)
    assert not reconstruct(cap, 2).topology().closed
    assert reconstruct(cap, 2, boundary=False).topology().closed
    assert reconstruct(cap, 2, hole_radius=100.0).topology().closed


@claims(
    README,
    "chance, over all data, up to which a gap between samples counts as an opening: 1e-3",
)
def test_significance():
    rec = reconstruct(datasets.circle(100, random_state=0), 1)
    assert rec.significance == 1e-3


@claims(
    README,
    "samples more than two local scales away from what the others show are left out",
    "A number is that distance, `False` keeps all.",
)
def test_outliers():
    points = np.vstack([datasets.torus(800, random_state=0), [[5.0, 5.0, 5.0]]])
    assert reconstruct(points, 2).outliers.tolist() == [800]
    assert len(reconstruct(points, 2, outliers=False).outliers) == 0
    assert len(reconstruct(points, 2, outliers=1e6).outliers) == 0


@claims(
    README,
    "`rec.vertices` are the moved samples, `rec.samples` the given ones, "
    "`rec.smoothing.noise` how far these were off.",
    "`False` leaves them",
)
def test_smoothing():
    true = datasets.sphere(1500, random_state=0)
    points = datasets.add_noise(true, 0.04, random_state=1)
    rec = reconstruct(points, 2)
    np.testing.assert_array_equal(rec.samples, points)

    def off(x):
        return float(np.sqrt(np.mean((np.linalg.norm(x, axis=1) - 1) ** 2)))

    assert off(rec.vertices) < off(points) / 2
    assert rec.smoothing.noise == pytest.approx(off(points), rel=0.2)
    kept = reconstruct(points, 2, smooth=False)
    np.testing.assert_array_equal(kept.vertices, points)


@claims(README, "as indices of the points, outward where the surface is closed")
def test_triangles_are_oriented_outward():
    points = datasets.sphere(300, random_state=0) + 5.0
    a, b, c = points[reconstruct(points, 2).simplices].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    assert (np.einsum("nd,nd->n", normals, a - 5.0) > 0).all()


@claims(
    README,
    "`rm.reconstruct(gram=G, dim=K)` and `rm.reconstruct(distances=Q, dim=K)` need no points.",
    "known only by inner products or distances",
)
def test_no_points_are_needed():
    points = datasets.torus(300, random_state=0)
    gram = points @ points.T
    away = np.linalg.norm(points[:, None] - points, axis=2)
    expected = {tuple(sorted(row)) for row in reconstruct(points, 2).simplices.tolist()}
    for given in ({"gram": (gram + gram.T) / 2}, {"distances": (away + away.T) / 2}):
        rec = reconstruct(dim=2, **given)
        found = {tuple(sorted(row)) for row in rec.simplices.tolist()}
        assert found == expected
        assert rec.vertices is None


@claims(README, "Same input, same bytes, for any number of threads.")
def test_threads():
    points = datasets.klein_bottle(600, random_state=0)
    one, four = (reconstruct(points, 2, num_threads=n) for n in (1, 4))
    assert one.digest == four.digest


@claims(
    README,
    "Every step (`neighborhoods`, `tangent_spaces`, `local_regions`, `edge_sets`, `clique_complex`) is a function of arrays.",
)
def test_steps_are_functions_of_arrays():
    points = datasets.sphere(200, random_state=0)
    assert rm.neighborhoods(points, 5).indices.shape == (200, 5)
    tangents = rm.tangent_spaces(points, 2)
    regions = rm.local_regions(points, tangents.bases, tangents.boundary)
    sets = rm.edge_sets(points, tangents.bases, tangents.boundary)
    np.testing.assert_array_equal(sets.indices, regions.edge_sets.indices)
    assert rm.clique_complex(sets.offsets, sets.indices, 2).shape[1] == 3


PEAK = """
import sys
import remanifold as rm
rm.reconstruct(rm.datasets.torus(500, random_state=0), 2, num_threads=1)
points = rm.datasets.torus(int(sys.argv[1]), random_state=0)
def now(key):
    with open("/proc/self/status") as file:
        return next(int(l.split()[1]) * 1024 for l in file if l.startswith(key))
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")
before = now("VmRSS")
rm.reconstruct(points, 2, num_threads=1)
print(now("VmHWM") - before)
"""


@pytest.mark.slow
@claims(
    README, "Memory grows linearly with N: about 320 bytes a sample beyond the input"
)
def test_memory_grows_linearly():
    def peak(number):
        command = [sys.executable, "-c", PEAK, str(number)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode and "clear_refs" in done.stderr:
            pytest.skip("peaks cannot be set back here")
        assert done.returncode == 0, done.stderr
        return int(done.stdout)

    small, large = peak(50_000), peak(150_000)
    assert 0.6 * 320 < (large - small) / 100_000 < 1.5 * 320


# --- Limits ----------------------------------------------------------------------------


@claims(LIMITS, "There is no size below which the result is refused")
def test_few_samples_are_not_refused():
    for dim in (1, 2, 3):
        points = np.random.default_rng(0).random((dim + 1, dim + 1))
        assert reconstruct(points, dim).num_samples == dim + 1


@claims(LIMITS, "The corner itself is cut off if no sample lies on it.")
def test_corners_are_cut():
    side = (np.arange(25) + 0.5) / 25
    lines = [np.c_[side, 0 * side], np.c_[1 + 0 * side, side]]
    lines += [np.c_[1 - side, 1 + 0 * side], np.c_[0 * side, 1 - side]]
    rec = reconstruct(np.concatenate(lines), 1, smooth=False)
    assert rec.topology().betti_numbers == (1, 1)
    assert rec.project([[1.0, 0.0]]).distances[0] > 0.01


@claims(
    LIMITS,
    "True holes with room for fewer than chance leaves out are closed.",
    "If the manifold is known to be closed, say `boundary=False`.",
)
def test_holes():
    plane = np.stack(np.meshgrid(*[np.arange(30.0)] * 2), -1).reshape(-1, 2)
    points = plane[np.linalg.norm(plane - 15, axis=1) > 4]
    rims = {r: reconstruct(points, 2, hole_radius=r).topology() for r in (2.0, 8.0)}
    assert rims[2.0].boundary_components == 2
    assert rims[8.0].boundary_components == 1


@claims(
    LIMITS,
    "Where it drowns the shape, a third of the radius of curvature and more, the result says so",
)
def test_drowned_shapes_are_told():
    rng = np.random.default_rng(0)
    for seed in range(3):
        points = datasets.circle(400, random_state=seed) + 0.4 * rng.normal(
            size=(400, 2)
        )
        rec = reconstruct(points, 1)
        assert not rec.quality.ok
        assert rec.smoothing.drowned or rec.smoothing.fitting_dim is not None


@claims(
    LIMITS,
    "From a Gram or distance matrix of points in space the result can differ a little at an open rim",
)
def test_products_differ_at_rims_only():
    points = datasets.spherical_cap(400, random_state=0)
    gram = points @ points.T
    from_points = reconstruct(points, 2, smooth=False, outliers=False)
    found = reconstruct(gram=(gram + gram.T) / 2, dim=2, outliers=False)
    sets = [
        {tuple(sorted(r)) for r in x.simplices.tolist()} for x in (from_points, found)
    ]
    rim = from_points.boundary | found.boundary
    differ = sets[0] ^ sets[1]
    assert len(differ) < len(sets[0]) / 50
    assert all(rim[list(row)].any() for row in differ)


@claims(
    LIMITS,
    "With K = 5 and 6 thirty samples are too few for the quadratic fits; most simplices are then disputed.",
)
def test_small_samples_of_many_dimensions_are_disputed():
    for dim in (5, 6):
        points = datasets.sphere(30, dim=dim, random_state=0)
        repair = reconstruct(points, dim).repair
        assert len(repair.disputed_simplices) > repair.num_agreed


@claims(LIMITS, "**K = 8 and more** is for some tens of samples")
def test_many_dimensions_have_few_samples():
    points = np.random.default_rng(0).normal(size=(60, 10))
    with pytest.raises(
        ValueError, match=r"dim is 8, .* 60 samples have more than 97656"
    ):
        reconstruct(points, 8)
    assert len(reconstruct(points[:20], 8).simplices) > 0


@claims(LIMITS, "**Programs have limits**: 4,000 candidates")
def test_programs_have_at_most_so_many_candidates():
    points = datasets.add_noise(
        datasets.torus(1500, random_state=0), 0.2, random_state=0
    )
    repair = reconstruct(points, 2, smooth=False, outliers=False).repair
    assert 500 < repair.largest_program <= 4000


@claims(LIMITS, "**So has the mending of links**: once a thousand simplices of links")
def test_links_that_there_is_no_work_for_are_cut():
    """That the work ends is held by the C++ tests of links."""
    points = datasets.flat_torus(600, dim=4, random_state=0)
    repair = reconstruct(points, 4).repair
    assert len(repair.cut_vertices) > 0
    assert len(repair.singular_vertices) == 0


@claims(
    LIMITS,
    "`.stl` has no vertices, only corners of triangles; corners with equal coordinates become one vertex when read, and samples in no triangle are not in the file.",
)
def test_stl_has_corners_only(tmp_path):
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [5, 5, 5]])
    rm.io.write_mesh(tmp_path / "a.stl", corners, [[0, 1, 2], [1, 3, 2]])
    assert len(rm.io.read_points(tmp_path / "a.stl")) == 4


@claims(
    LIMITS,
    "what is taken for colors, normals or a count is said in a `FileWarning`; `columns=` decides.",
)
def test_guessed_columns_are_said(tmp_path):
    rng = np.random.default_rng(0)
    colors = rng.integers(0, 256, (30, 3))
    np.savetxt(tmp_path / "a.xyz", np.c_[rng.random((30, 3)), colors])
    with pytest.warns(rm.FileWarning, match="red, green, blue"):
        assert rm.io.read_points(tmp_path / "a.xyz").shape == (30, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = rm.io.read_points(tmp_path / "a.xyz", columns=range(6))
    assert found.shape == (30, 6)


@claims(LIMITS, "Binary OFF and OFF with homogeneous coordinates are refused.")
def test_unusual_off_is_refused(tmp_path):
    for head in ("OFF BINARY", "4OFF"):
        (tmp_path / "a.off").write_text(f"{head}\n1 0 0\n0 0 0 1\n")
        with pytest.raises(ValueError, match="expected 'OFF' or 'nOFF'"):
            rm.io.read_points(tmp_path / "a.off")


@claims(LIMITS, "samples nearer to each other than 6e-8 of their norms coincide.")
def test_gram_matrices_hold_squares():
    points = np.array([[1.0, 0], [1, 1e-8], [0, 1], [-1, 0], [0, -1], [0.7, 0.7]])
    rec = reconstruct(gram=points @ points.T, dim=1)
    assert rec.representatives[1] == 0
    assert reconstruct(points, 1).representatives[1] == 1


@claims(LIMITS, "**Distances that are not Euclidean** are accepted")
def test_distances_of_no_space():
    angles = np.arange(60) / 60 * 2 * np.pi
    along = np.abs(angles[:, None] - angles)
    rec = reconstruct(distances=np.minimum(along, 2 * np.pi - along), dim=1)
    assert rec.topology().betti_numbers == (1, 1)


@claims(
    LIMITS,
    "What differs by no more than 2^-48 of the largest coordinate is merged.",
    "Samples that are closer than a millionth of the spacing, and farther apart than that, count as two.",
)
def test_nearly_coinciding_samples():
    points = datasets.circle(50, random_state=0)
    scale = np.abs(points).max()
    for apart, merged in ((2.0**-49, 1), (2.0**-46, 0), (1e-9, 0)):
        twin = points[:1] + np.array([0, apart * scale])
        both = np.vstack([points, twin])
        rec = reconstruct(both, 1, smooth=False, outliers=False)
        assert rec.repair.merged_samples == merged


@claims(
    LIMITS,
    "27,405 for K = 3, 16 million for K = 5 (a quarter of a second), 386 million for K = 6.",
)
def test_tuples_of_a_neighborhood():
    assert math.comb(30, 4) == 27_405
    assert round(math.comb(50, 6) / 1e6) == 16
    assert round(math.comb(60, 7) / 1e6) == 386


@claims(LIMITS, "**Gram matrices** are tested for being positive semidefinite")
def test_indefinite_matrices_are_refused():
    gram = np.eye(20)
    gram[0, 1] = gram[1, 0] = 3.0
    with pytest.raises(ValueError, match="positive semidefinite"):
        rm.reconstruct(gram=gram, dim=1)


# --- Files of strangers -------------------------------------------------------------------

ALONE = """
import builtins, os, pickle, socket, subprocess, sys
import numpy as np
import remanifold as rm
def refuse(*arguments, **options):
    raise SystemExit(f"not alone: {arguments}")
rec = rm.reconstruct(rm.datasets.torus(200, random_state=0), 2)
socket.socket.connect = socket.create_connection = refuse
subprocess.Popen.__init__ = os.system = os.popen = refuse
pickle.load = pickle.loads = pickle.Unpickler = refuse
for suffix in sys.argv[2:]:
    path = f"{sys.argv[1]}/mesh{suffix}"
    rec.write(path)
    rm.io.read(path)
rec.save(f"{sys.argv[1]}/a.rm.npz")
rm.load(f"{sys.argv[1]}/a.rm.npz")
rec.report(f"{sys.argv[1]}/a.html")
print("done")
"""


@claims(
    SECURITY,
    "**Reading a file runs nothing of it.** No reader unpickles",
    "No reader or writer uses the network or a shell.",
)
def test_files_need_nothing_but_themselves(tmp_path):
    suffixes = [".ply", ".obj", ".off", ".stl", ".vtk", ".vtu", ".vtp", ".npz", ".glb"]
    done = subprocess.run(
        [sys.executable, "-c", ALONE, str(tmp_path), *suffixes],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "done\n", done.stderr


@claims(SECURITY, "A `.gltf` loads buffers from its own folder only")
def test_scenes_do_not_look_around(tmp_path):
    (tmp_path / "inside").mkdir()
    rm.io.write_points(tmp_path / "secret.csv", np.eye(3))
    scene = (
        '{"asset": {"version": "2.0"}, "buffers": [{"uri": "../secret.csv"}], '
        '"bufferViews": [{"buffer": 0}], "accessors": [{"bufferView": 0, '
        '"componentType": 5126, "type": "VEC3", "count": 1}], '
        '"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}'
    )
    (tmp_path / "inside" / "a.gltf").write_text(scene)
    with pytest.raises(ValueError, match="beside it"):
        rm.io.read_points(tmp_path / "inside" / "a.gltf")


@claims(SECURITY, "no input of `reconstruct` is written to")
def test_samples_are_left_alone():
    points = datasets.torus(300, random_state=0)
    points.flags.writeable = False
    before = points.copy()
    for method in ("manifold", "paper"):
        reconstruct(points, 2, method=method)
    np.testing.assert_array_equal(points, before)


# --- All of them ----------------------------------------------------------------------------

# Sentences that tests of other files are about: the file, and the test.
ELSEWHERE = {
    (README, "285 of 296 wrong results were doubted"): (
        *(
            "documents/test_docs.py",
            "test_numbers_of_the_readme_are_those_of_the_tables",
        ),
    ),
    (README, "which needs no network"): (
        *("page/test_report_page.py", "test_pages_load_alone_and_fit"),
    ),
    (
        README,
        "Data that is no manifold, because sheets cross or its parts differ in dimension",
    ): (*("judging/test_singularities.py", "test_crossings_are_found_where_they_are"),),
    (LIMITS, "In how many of ten runs the result is a manifold"): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "**Thin sheets.**"): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "**Lines.**"): (
        *("method/test_along_lines.py", "test_scan_lines_are_one_sheet"),
    ),
    (LIMITS, "**Corners of curves.**"): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "**Noise** of a tenth of the spacing already opens holes."): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "**At a boundary** samples without a tangent space are left out"): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "**Three-manifolds** come out far from manifolds"): (
        *("documents/test_examples.py", "test_limits_are_as_on_the_page"),
    ),
    (LIMITS, "the cone over a lens space of order 5 passes"): (
        *(
            "complex/test_topology.py",
            "test_some_singular_vertices_pass_in_dimension_4",
        ),
    ),
    (LIMITS, "**Ctrl-C** is answered within a second"): (
        *("test_running.py", "test_an_interrupt_stops_the_run"),
    ),
    (LIMITS, "**Surfaces need samples in triangles, not squares.**"): (
        *("documents/test_examples.py", "test_sampling_compares_random_with_even"),
    ),
    (SECURITY, "A file takes memory for what it holds, not for what it promises."): (
        *("formats/test_hostile.py", "test_no_memory_for_what_is_only_promised"),
    ),
    (SECURITY, "A damaged file is one clear error"): (
        *("formats/test_fuzz.py", "test_damaged_files_give_one_clear_line"),
    ),
    (SECURITY, "A file is written whole or not at all"): (
        *("formats/test_io.py", "test_failed_write_leaves_the_old_file_alone"),
    ),
    (SECURITY, "**Where memory runs out** there is a `MemoryError`"): (
        *("test_faults.py", "test_memory_that_runs_out_is_an_error"),
    ),
    (SECURITY, "Where the system starts no more threads there is a `RuntimeError`"): (
        *("test_faults.py", "test_threads_that_do_not_start_are_an_error"),
    ),
}
# Sentences that no test is about, and why.
UNTESTED = {
    "**No proof.**": "says what is not known",
    "**Thin simplices.**": "a tolerance of the core, which its own tests are about",
    "**Regions without an end**": "constants of the core, which its own tests are about",
    "**Random samples of surfaces have callouses": "explains a figure",
    "**A neighborhood must be one nearly flat piece.**": "explains a figure",
}


@pytest.mark.parametrize(
    "claim", [*CLAIMED, *ELSEWHERE], ids=lambda claim: claim[1][:50]
)
def test_what_is_claimed_stands_on_the_page(claim):
    name, sentence = claim
    assert sentence in page(name)


@pytest.mark.parametrize("claim", ELSEWHERE, ids=lambda claim: claim[1][:50])
def test_tests_elsewhere_are_there(claim):
    file, test = ELSEWHERE[claim]
    assert f"\ndef {test}(" in (ROOT / "tests/python" / file).read_text(
        encoding="utf-8"
    )


@pytest.mark.parametrize(("name", "most"), [(LIMITS, 25), (SECURITY, 6)])
def test_each_limit_has_its_test(name, most):
    text = (ROOT / name).read_text(encoding="utf-8").split("## What is not\n")[0]
    points = re.findall(r"(?ms)^- (.*?)(?=^- |^\n|\Z)", text)
    assert len(points) > most
    known = [s for page, s in (*CLAIMED, *ELSEWHERE) if page == name] + [*UNTESTED]
    for point in (" ".join(one.split()) for one in points):
        assert any(sentence in point for sentence in known), point
