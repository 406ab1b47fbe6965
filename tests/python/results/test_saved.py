# SPDX-License-Identifier: GPL-3.0-or-later
"""Results that last: saved and loaded, and where they come from.

    python tests/python/results/test_saved.py 1    # made data/saved_1.rm.npz

The file of a version is made once, by the code of that version, and then kept.
"""

from __future__ import annotations

import dataclasses
import hashlib
import inspect
import io
import json
import sys
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest

import remanifold as rm
from remanifold._base.digest import digest
from remanifold.formats import saved

OLD = Path(__file__).resolve().parents[1] / "data"


def noisy_cap():
    points = rm.datasets.spherical_cap(150, random_state=3)
    points = rm.datasets.add_noise(points, 0.05, random_state=4)
    points = np.round(np.vstack([points, [[9.0, 9.0, 1.0]]]) * 2**20) / 2**20
    points[7] = np.nan
    return points


def small():
    """With something of everything that a result may hold."""
    points = noisy_cap()
    attributes = {
        "label": np.arange(len(points), dtype=np.int16) % 5,
        "of red/green": np.linspace(0, 1, 2 * len(points)).reshape(-1, 2),
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.RemanifoldWarning)
        rec = rm.reconstruct(
            points, 2, smooth=True, attributes=attributes, invalid="drop"
        )
    rec.quality  # noqa: B018  computed, so kept
    return rec


def make(number, path):
    """Without what would tell of the machine."""
    assert number == saved.FORMAT
    rec = small()
    vars(rec)["provenance"] = dataclasses.replace(
        rec.provenance,
        versions={"Python": "3", "NumPy": "2", "platform": "any"},
        source={"name": "cap.csv"},
        command="remanifold reconstruct cap.csv -k 2 -o cap.rm.npz --drop-invalid",
    )
    rec.save(path)


def assert_same(one, other, where="result"):
    """All the way down: types, dtypes, every bit."""
    assert type(one) is type(other), where
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, where
        np.testing.assert_array_equal(one, other, err_msg=where)
        assert one.flags.writeable >= other.flags.writeable, where
    elif isinstance(one, rm.Parameters):
        assert_same({**one}, {**other}, where)
    elif isinstance(one, dict):
        assert list(one) == list(other), where
        for key in one:
            assert_same(one[key], other[key], f"{where}/{key}")
    elif isinstance(one, (tuple, list)):
        assert len(one) == len(other), where
        for i, pair in enumerate(zip(one, other, strict=True)):
            assert_same(*pair, f"{where}/{i}")
    elif dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            pair = (getattr(thing, field.name) for thing in (one, other))
            assert_same(*pair, f"{where}/{field.name}")
    else:
        assert one == other or np.isnan([one, other]).all(), where


def results():
    torus = rm.datasets.torus(300, random_state=0)
    circle = rm.datasets.circle(40, random_state=0)
    gaps = np.linalg.norm(circle[:, None] - circle, axis=2)
    disc = rm.datasets.ball(200, dim=2, random_state=0)
    rng = np.random.default_rng(0)
    return {
        "everything": small,
        "plain": lambda: rm.reconstruct(torus, 2),
        "paper": lambda: rm.reconstruct(torus, 2, method="paper"),
        "gram": lambda: rm.reconstruct(gram=circle @ circle.T, dim=1),
        "distances": lambda: rm.reconstruct(distances=gaps, dim=1),
        "auto": lambda: rm.reconstruct(torus, "auto"),
        "mask": lambda: rm.reconstruct(disc, 2, boundary=np.ones(200, dtype=bool)),
        "many coordinates": lambda: rm.reconstruct(
            torus @ rng.normal(size=(3, 60)), 2, smooth=False
        ),
        "few": lambda: rm.reconstruct(torus[:12], 2),
    }


@pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")
@pytest.mark.parametrize("kind", results())
def test_nothing_is_lost(kind, tmp_path):
    rec = results()[kind]()
    path = tmp_path / "a.rm.npz"
    rec.save(path)
    loaded = rm.load(path)
    assert_same(rec, loaded)
    for name in ("edges", "repair", "tangents", "left_out", "residuals"):
        assert_same(getattr(rec, name), getattr(loaded, name), name)
    assert_same(rec.quality, loaded.quality, "quality")
    assert_same(rec.fields(), loaded.fields(), "fields")
    assert repr(loaded) == repr(rec)
    assert loaded.digest == rec.digest
    # Saved again it is the same file, but for the quality that was computed since.
    first = path.read_bytes()
    rm.load(path).save(path)
    assert path.read_bytes() == first


def test_samples_that_were_not_moved_are_there_once(tmp_path):
    points = rm.datasets.torus(500, random_state=0)
    rec = rm.reconstruct(points, 2)
    rec.save(tmp_path / "a.rm.npz")
    with zipfile.ZipFile(tmp_path / "a.rm.npz") as archive:
        names = [n for n in archive.namelist() if archive.getinfo(n).file_size > 12_000]
    assert [n for n in names if n in ("samples.npy", "vertices.npy")] == [
        "vertices.npy"
    ]


@pytest.mark.parametrize("number", range(1, saved.FORMAT + 1))
def test_files_of_all_versions_are_read(number):
    rec = rm.load(OLD / f"saved_{number}.rm.npz")
    now = small()
    # What the file says, whatever today's code makes of the samples.
    assert rec.num_samples == 151
    assert rec.simplices.shape[1] == 3
    assert rec.invalid.tolist() == [7]
    assert rec.outliers.tolist() == [150]
    assert rec.smoothing.moved
    assert [*rec.vertex_attributes] == ["label", "of red/green"]
    assert_same(rec.samples, now.samples)
    assert_same(rec.vertex_attributes, now.vertex_attributes)
    assert rec.openings[0].decision in ("open", "closed")
    assert rec.provenance.version
    assert rec.provenance.is_of(noisy_cap())
    assert rec.parameters["dim"] == rm.Parameter(2, given=True)
    assert "quality" in vars(rec)
    assert rec.quality.verdict
    assert rec.repair.num_boundary_components >= 1
    assert rec.topology().num_vertices > 80


def tree_of(path):
    with zipfile.ZipFile(path) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    return json.loads(content.pop(saved.TREE)), content


def write(path, tree, content):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(saved.TREE, json.dumps(tree))
        for name, data in content.items():
            archive.writestr(name, data)


@pytest.fixture
def circle(tmp_path):
    path = tmp_path / "circle.rm.npz"
    rm.reconstruct(rm.datasets.circle(50, random_state=0), 1).save(path)
    return path


def test_what_a_later_version_adds_is_passed_over(circle):
    tree, content = tree_of(circle)
    tree["later"] = 1
    tree["result"]["later"] = [1, 2]
    tree["cached"]["later"] = None
    origin = tree["result"]["provenance"]["Provenance"]
    origin["later"] = {"array": "simplices"}
    write(circle, tree, content)
    assert rm.load(circle).dim == 1


def npy(array):
    held = io.BytesIO()
    np.save(held, array)
    return held.getvalue()


def later(parts):
    parts[0]["format"] = saved.FORMAT + 1


def without_a_class(parts):
    parts[0]["result"]["provenance"] = {"os.system": {"command": "true"}}


def without_an_array(parts):
    del parts[1]["simplices.npy"]


def pickled(parts):
    parts[1]["simplices.npy"] = npy(np.array([{}], dtype=object))


def changed(parts):
    rows = np.load(io.BytesIO(parts[1]["simplices.npy"]))
    parts[1]["simplices.npy"] = npy(rows[::-1])


def beyond(parts):
    rows = np.load(io.BytesIO(parts[1]["simplices.npy"]))
    parts[1]["simplices.npy"] = npy(rows + np.int32(1000))


def without_a_part(parts):
    del parts[0]["result"]["representatives"]


BROKEN = [
    (later, "written by remanifold .* in format 2"),
    (without_a_class, "damaged or no saved result"),
    (without_an_array, "damaged or no saved result"),
    (pickled, "damaged or no saved result"),
    (changed, "was changed: its digest is sha256"),
    (beyond, "has simplices from 1000 to"),
    (without_a_part, "it has no representatives"),
]


@pytest.mark.parametrize(
    ("change", "message"), [pytest.param(*case, id=case[0].__name__) for case in BROKEN]
)
def test_what_cannot_be_trusted_is_refused(change, message, circle):
    parts = tree_of(circle)
    change(parts)
    write(circle, *parts)
    with pytest.raises(ValueError, match=message) as caught:
        rm.load(circle)
    assert str(circle) in str(caught.value)


def test_files_cut_short_or_damaged_are_refused(circle):
    data = circle.read_bytes()
    for size in range(0, len(data), 997):
        circle.write_bytes(data[:size])
        with pytest.raises(ValueError, match=r"circle\.rm\.npz"):
            rm.load(circle)
    place = data.index(b"NUMPY") + 200
    circle.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
    with pytest.raises(ValueError, match="damaged"):
        rm.load(circle)


def test_other_files_are_no_results(tmp_path):
    square = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    square.write(tmp_path / "a.npz")
    with pytest.raises(ValueError, match=r"meshes are read by io\.read_complex"):
        rm.load(tmp_path / "a.npz")
    with pytest.raises(FileNotFoundError):
        rm.load(tmp_path / "b.rm.npz")


def test_names_say_what_a_file_is(tmp_path):
    rec = rm.reconstruct(rm.datasets.circle(50, random_state=0), 1)
    with pytest.raises(ValueError, match=r"saved as \.rm\.npz"):
        rec.save(tmp_path / "a.npz")
    with pytest.raises(ValueError, match=r"rec\.save\(\)"):
        rm.io.write_mesh(tmp_path / "a.rm.npz", rec.vertices, rec.simplices)
    assert not [*tmp_path.iterdir()]


def test_writing_a_result_by_the_name_of_one_saves_it(tmp_path):
    rec = rm.reconstruct(rm.datasets.circle(50, random_state=0), 1)
    rec.write(tmp_path / "a.rm.npz")
    rec.save(tmp_path / "b.rm.npz")
    data = (tmp_path / "a.rm.npz").read_bytes()
    assert data == (tmp_path / "b.rm.npz").read_bytes()
    assert "quality" not in vars(rm.load(tmp_path / "a.rm.npz"))
    rec.write(tmp_path / "c.rm.npz", "all")
    assert "quality" in vars(rm.load(tmp_path / "c.rm.npz"))
    with pytest.raises(ValueError, match="holds everything; fields is for meshes"):
        rec.write(tmp_path / "d.rm.npz", {"heat": np.ones(50)})
    for name, words in (("d.html", r"rec\.report\(\)"), ("d.png", "screenshot")):
        with pytest.raises(ValueError, match=f"{words}.*a mesh is one of .ply"):
            rec.write(tmp_path / name)
    assert len([*tmp_path.iterdir()]) == 3


def test_saved_results_are_meshes_and_samples_to_others(tmp_path):
    rec = small()
    path = tmp_path / "a.rm.npz"
    rec.save(path)
    mesh = rm.io.read_complex(path)
    rows = np.flatnonzero(np.isfinite(rec.vertices).all(axis=1))
    np.testing.assert_array_equal(mesh.vertices, rec.vertices[rows])
    np.testing.assert_array_equal(
        mesh.vertex_attributes["sample"][mesh.simplices], rec.simplices
    )
    assert "spacing" in mesh.vertex_attributes
    cloud = rm.io.read(path)
    np.testing.assert_array_equal(cloud.points, rec.samples)
    assert [*cloud.attributes] == ["label", "of red/green"]


# --- Provenance ---------------------------------------------------------------------


def test_digests_are_what_the_documentation_says():
    points = rm.datasets.circle(30, random_state=0)
    rec = rm.reconstruct(points, 1)
    head = f"<f8 {30},{2}\n".encode()
    assert rec.provenance.input == (
        "sha256:" + hashlib.sha256(head + points.astype("<f8").tobytes()).hexdigest()
    )
    second = f"<i4 {len(rec.simplices)},2\n".encode() + rec.simplices.tobytes()
    parts = head + rec.vertices.tobytes() + second
    assert rec.digest == f"sha256:{hashlib.sha256(parts).hexdigest()}"
    assert digest(points.astype(">f8")) == digest(points) == digest(points[:, ::1])
    assert digest(points) != digest(points.T) != digest(points.reshape(-1))


def test_digests_tell_other_samples():
    points = noisy_cap()
    rec = small()
    assert rec.provenance.is_of(points)
    assert rec.provenance.is_of(points.tolist())
    points[3, 1] = np.nextafter(points[3, 1], 9)
    assert not rec.provenance.is_of(points)
    assert not rec.provenance.is_of(points[:-1])
    circle = rm.datasets.circle(30, random_state=0)
    rec = rm.reconstruct(gram=circle @ circle.T, dim=1)
    assert rec.provenance.is_of(gram=circle @ circle.T)
    assert not rec.provenance.is_of(circle)


def test_changing_the_samples_afterwards_shows():
    points = rm.datasets.circle(30, random_state=0)
    rec = rm.reconstruct(points, 1, smooth=False)
    points *= 2  # the result has a view of them
    assert not rec.provenance.is_of(rec.samples)


def values(rec):
    return {name: one.value for name, one in rec.parameters.items()}


@pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")
def test_parameters_are_those_that_were_used():
    points = rm.datasets.torus(400, random_state=0)
    rec = rm.reconstruct(points, 2)
    used = values(rec)
    assert used["hole_radius"] == rec.repair.hole_radius
    assert used["smooth"] is False
    assert "not told from shape" in rec.parameters["smooth"].why
    assert used["num_neighbors"] == 15
    # All of it given, the result is the same, and says that it was given.
    again = rm.reconstruct(points, **{**ASKED, **chosen(used)})
    assert_same(again.simplices, rec.simplices)
    assert all(one.given for n, one in again.parameters.items() if n in chosen(used))

    more = rm.datasets.torus(800, random_state=0)
    rec = rm.reconstruct(rm.datasets.add_noise(more, 0.05, random_state=0), "auto")
    used = values(rec)
    assert used["smooth"] == rec.smoothing.num_neighbors > 0
    assert rec.parameters["dim"].value == 2
    assert not rec.parameters["dim"].given
    assert "confidence" in rec.parameters["dim"].why

    few = rm.reconstruct(points[:20], 2)
    assert values(few)["num_neighbors"] == 9

    paper = rm.reconstruct(points, 2, method="paper", edges="either")
    used = values(paper)
    assert used["edges"] == "either"
    assert paper.parameters["edges"].given
    assert used["num_neighbors"] == paper.num_neighbors == 20
    assert "hole_radius" not in used

    mask = np.arange(400) < 100
    rec = rm.reconstruct(points, 2, boundary=mask)
    np.testing.assert_array_equal(values(rec)["boundary"], mask)
    mask[:] = True
    assert "boundary=<100 of 400 samples>" in repr(rec.parameters)


ASKED = {"dim": 2, "boundary": "auto"}


def chosen(used):
    names = (
        "method",
        "hole_radius",
        "outliers",
        "smooth",
        "num_neighbors",
        "estimator",
    )
    return {name: used[name] for name in names if name != "method"}


def test_every_parameter_of_reconstruct_is_listed():
    rec = rm.reconstruct(
        rm.datasets.circle(60, random_state=0), 1, search="approximate"
    )
    paper = rm.reconstruct(rm.datasets.circle(60, random_state=0), 1, method="paper")
    names = {*inspect.signature(rm.reconstruct).parameters}
    names -= {"points", "gram", "distances"}  # "samples" says which
    # The result does not depend on these, or says so where it does.
    names -= {"progress", "max_memory", "max_seconds"}
    assert names | {"samples"} == {*rec.parameters, *paper.parameters}


def test_parameters_are_shown():
    rec = rm.reconstruct(rm.datasets.circle(60, random_state=0), 1)
    assert repr(rec.parameters).startswith("Parameters(dim=1, method=manifold")
    assert len(repr(rec.parameters).splitlines()) <= 10
    lines = str(rec.parameters).splitlines()
    assert len(lines) == len(rec.parameters)
    assert "(that of the manifold method)" in str(rec.parameters)


# --- Comments of files --------------------------------------------------------------

MESHES = ("ply", "obj", "off", "vtu", "vtp", "gltf", "npz", "glb", "stl", "vtk")
BRIEF = ("stl", "vtk")  # one line


@pytest.mark.parametrize("suffix", MESHES)
def test_files_say_where_they_come_from(suffix, tmp_path):
    rec = rm.reconstruct(rm.datasets.torus(200, random_state=0), 2)
    path = tmp_path / f"mesh.{suffix}"
    rec.write(path)
    data = path.read_bytes().decode("latin-1")
    assert f"remanifold {rm.__version__}" in data
    assert rec.digest in data
    if suffix != "stl":
        assert rec.provenance.input in data
    if suffix not in BRIEF:
        assert "hole_radius=3" in data
    mesh = rm.io.read_complex(path)
    if suffix == "stl":  # the corners, in their order
        assert len(mesh.simplices) == len(rec.simplices)
    else:
        np.testing.assert_array_equal(mesh.simplices, rec.simplices)
    # The same mesh without a comment is the same to the last number.
    rm.io.write_complex(path, rec, comment="")
    plain = rm.io.read_complex(path)
    np.testing.assert_array_equal(plain.vertices, mesh.vertices)
    np.testing.assert_array_equal(plain.simplices, mesh.simplices)


@pytest.mark.parametrize("suffix", MESHES)
def test_any_comment_is_safe(suffix, tmp_path):
    nasty = "a--> <b> facet\nvertex 1\n\x00end_header\r\nélé\u2028" + "x" * 900
    mesh = rm.SimplicialComplex([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    path = tmp_path / f"mesh.{suffix}"
    rm.io.write_complex(path, mesh, comment=nasty)
    assert rm.io.read_complex(path).simplices.tolist() == [[0, 1, 2]]


if __name__ == "__main__":
    make(int(sys.argv[1]), OLD / f"saved_{sys.argv[1]}.rm.npz")
