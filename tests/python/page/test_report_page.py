# SPDX-License-Identifier: GPL-3.0-or-later
"""The report page: what stands on it, and how it behaves in a browser."""

import html
import io
import itertools
import json
import os
import re
import time
from html.parser import HTMLParser

import numpy as np
import pytest
from typer.testing import CliRunner

import chromium
import remanifold as rm
from remanifold.cli import app
from remanifold.page import report_page, report_parts

pytestmark = pytest.mark.slow

pytest.importorskip("plotly")

MARKUP = '<script>alert(1)</script> & "co" </title>'
VOID = {"meta", "link", "rect", "line", "br"}


class Page(HTMLParser):
    """Text by the way of elements to it; tags must nest."""

    def __init__(self, content):
        super().__init__()
        self.open = []
        self.links = []
        self.texts = []
        self.feed(content)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.links += [v for k, v in attributes if k in ("src", "href", "srcset")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if data.strip():
            self.texts.append((tuple(self.open), data.strip()))

    def of(self, tag):
        return [data for way, data in self.texts if way[-1] == tag]

    def row(self, name):
        """What stands beside a name in a table."""
        place = next(i for i, t in enumerate(self.texts) if t[1] == name)
        return self.texts[place + 1][1]


def write(rec, folder, **options):
    path = folder / "report.html"
    rec.report(path, **options)
    return path


@pytest.fixture(scope="module")
def torus():
    return rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)


@pytest.fixture(scope="module")
def sparse():
    return rm.reconstruct(rm.datasets.torus(80, random_state=1), 2)


@pytest.fixture(scope="module")
def recs(torus, sparse):
    """Results of all kinds."""
    rotations = rm.reconstruct(rm.datasets.rotations(400, random_state=0), 3)
    flat = rm.datasets.flat_torus(150, random_state=0)
    return {
        "torus": torus,
        "sparse": sparse,
        "knot": rm.reconstruct(rm.datasets.trefoil(100, random_state=0), 1),
        "plane": rm.reconstruct(rm.datasets.planar_curves(120, random_state=0), 1),
        "rotations": rotations,
        "paper": rm.reconstruct(
            rm.datasets.torus(300, random_state=0), 2, method="paper"
        ),
        "gram": rm.reconstruct(gram=flat @ flat.T, dim=2),
    }


KINDS = ("torus", "sparse", "knot", "plane", "rotations", "paper", "gram")


# --- What stands there --------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_pages_are_whole(kind, recs, tmp_path):
    rec = recs[kind]
    page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
    told = " ".join(page.of("p") + page.of("strong") + page.of("li"))
    reasons = [reason.text for reason in rec.quality.reasons]
    for reason in reasons:
        assert told.lower().count(reason.lower()) == 1
    # What the verdict says besides its first reason.
    rest = rec.quality.verdict.split(f": {reasons[0]}") if reasons else []
    for said in rest or [rec.quality.verdict]:
        assert said[1:] in told
    topology = rec.topology()
    betti = ", ".join(map(str, topology.betti_numbers))
    assert page.row("Betti numbers over Z2") == betti
    assert page.row("Euler characteristic") == str(topology.euler_characteristic)
    assert page.row("manifold") == ("yes" if topology.manifold else "no")
    assert page.row("NumPy") == np.__version__
    assert page.row("remanifold") == rm.__version__
    assert page.row("method") == rec.method
    for step in rec.timings:
        assert float(page.row(step.replace("_", " "))) >= 0
    # Nothing but places on the page itself, and an empty icon.
    assert all(link.startswith("#") or link == "data:," for link in page.links)
    levels = [len(way) for way, _ in page.texts if way[-1] == "h1"]
    assert len(levels) == 1


def test_repair_is_told(torus, sparse, recs, tmp_path):
    for rec in (torus, sparse):
        page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
        assert page.row("agreed triangles") == f"{rec.repair.num_agreed:,}"
        disputed = len(rec.repair.disputed_simplices)
        assert page.row("disputed triangles") == f"{disputed:,}"
        assert "Nothing is left to mend." in page.of("p")
    paper = recs["paper"]
    left = paper.repair.remaining()
    page = Page(write(paper, tmp_path).read_text(encoding="utf-8"))
    cells = page.of("td")
    assert cells.count("open face") == sum(w == "open face" for w, _ in left[:50]) > 0
    assert f"The first 50 of {len(left):,}." in page.of("p")


def test_samples_in_doubt_are_listed(sparse, tmp_path):
    page = Page(write(sparse, tmp_path).read_text(encoding="utf-8"))
    doubtful = np.flatnonzero(sparse.quality.doubtful)
    cells = page.of("td")
    for sample in doubtful:
        place = next(
            i
            for i, cell in enumerate(cells)
            if cell == str(sample) and re.match(r"^-?\d.*, .*, ", cells[i + 1])
        )
        given = [float(c) for c in cells[place + 1].split(",")]
        np.testing.assert_allclose(given, sparse.samples[sample], rtol=1e-4)
        reasons = [r.text for r in sparse.quality.reasons if sample in r.samples]
        assert cells[place + 2] == "; ".join(reasons)


def test_long_lists_are_cut(sparse, tmp_path, monkeypatch):
    monkeypatch.setattr(report_parts, "MOST_SAMPLES", 3)
    count = int(sparse.quality.doubtful.sum())
    page = Page(write(sparse, tmp_path).read_text(encoding="utf-8"))
    assert f"The first 3 of {count} samples in doubt." in page.of("p")


def test_outliers_and_noise(tmp_path):
    circle = rm.datasets.circle(300, random_state=0)
    noisy = rm.datasets.add_noise(circle, 0.02, random_state=1)
    rec = rm.reconstruct(np.vstack([noisy, [[0.1, 0.2]]]), 1, smooth="auto")
    page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
    assert "Outliers: 1." in page.of("p")
    assert "300" in page.of("td")
    assert page.row("noise, in the unit of the samples") == f"{rec.smoothing.noise:.3g}"
    assert str(rec.smoothing.num_neighbors) in page.row("smoothed by")


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_line_is_the_answer(kind, recs, tmp_path):
    rec = recs[kind]
    content = write(rec, tmp_path).read_text(encoding="utf-8")
    page = Page(content)
    answer = f"{rec.answer[:1].upper()}{rec.answer[1:]}."
    texts = [t for way, t in page.texts if "body" in way]
    assert texts[1] == answer  # after the title
    good = "as far as can be told" in answer
    assert ('class="verdict good"' in content) == good
    assert good == (rec.quality.ok and not rec.repair.lacks)
    # A page without doubt has nothing left to mend.
    assert not good or "Left to mend" not in content
    assert page.row("the complex is") == rec.topology().description
    assert "homeomorphic" not in content


def test_no_manifold_is_said_first(tmp_path):
    rec = rm.reconstruct(rm.datasets.crossing_balls(900, random_state=0), 2)
    page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
    assert any(t.startswith("In doubt: no 2-manifold") for t in page.of("strong"))


def test_parameters_digests_and_the_call_are_there(recs, tmp_path):
    for rec in recs.values():
        page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
        cells = page.of("td")
        for name, value, why in rec.parameters.rows():
            place = next(
                i for i, c in enumerate(cells) if c == name and cells[i + 1] == value
            )
            assert cells[place + 2] == why
        assert page.row("of the samples") == rec.provenance.input
        assert page.row("of the result") == rec.digest
        assert page.of("code") == [rec.parameters.call()]


def test_the_call_makes_the_same(recs):
    points = rm.datasets.torus(300, random_state=0)
    made = eval(recs["paper"].parameters.call(), {"rm": rm, "points": points})
    assert made.digest == recs["paper"].digest


def test_the_mesh_is_on_the_page(recs, tmp_path):
    import base64

    for kind, rec in recs.items():
        content = write(rec, tmp_path).read_text(encoding="utf-8")
        found = re.search(r'id="mesh">([^<]*)<', content)
        if kind == "gram":
            assert found is None
            continue
        name = re.search(r'data-name="([^"]*)"', content)[1]
        path = tmp_path / name
        path.write_bytes(base64.b64decode(found[1]))
        mesh = rm.io.read_complex(path)
        np.testing.assert_array_equal(mesh.simplices, rec.simplices)
        np.testing.assert_array_equal(mesh.vertices[:, : rec.ambient_dim], rec.vertices)
        assert "spacing" in mesh.vertex_attributes


def test_meshes_that_are_too_large_are_not(torus, tmp_path, monkeypatch):
    monkeypatch.setattr(report_parts, "MOST_CARRIED", 10)
    content = write(torus, tmp_path).read_text(encoding="utf-8")
    assert 'id="mesh"' not in content
    assert "too much for this page to carry" in content


def test_attributes_are_colors(tmp_path):
    points = rm.datasets.torus(300, random_state=0)
    known = {
        "<b>heat": points[:, 0],
        "colors": np.ones((300, 3)),
        "normals": points,
    }
    rec = rm.reconstruct(points, 2, attributes=known)
    page = Page(write(rec, tmp_path).read_text(encoding="utf-8"))
    assert "<b>heat" in page.of("option")
    assert "colors" in page.of("option")
    assert "normals" not in page.of("option")


def test_text_of_the_user_is_text(torus, tmp_path):
    path = write(torus, tmp_path, title=MARKUP, command=f"cat '{MARKUP}' \x00\udcff")
    content = path.read_text(encoding="utf-8")
    page = Page(content)
    assert page.of("h1") == page.of("title") == [MARKUP]
    assert page.of("code") == [f"cat '{MARKUP}' \ufffd\ufffd"]
    assert "<script>alert" not in content
    assert html.escape(MARKUP) in content


def test_json_cannot_end_its_script():
    from remanifold._base.html import json_of

    value = {"</script>": "<!--\u2028 & </SCRIPT>"}
    coded = json_of(value)
    assert not re.search("[<>&\u2028]", coded)
    assert json.loads(coded) == value


def test_large_complexes_are_coarsened(torus, tmp_path, monkeypatch):
    monkeypatch.setattr(report_page, "MOST_SHOWN", 300)
    page = Page(write(torus, tmp_path).read_text(encoding="utf-8"))
    caption = next(t for t in page.of("figcaption") if "Drag" in t)
    shown = int(re.match(r"Coarsened for display: (\d+) for 800 triangles", caption)[1])
    assert shown <= 300


def test_projections_are_named(recs, tmp_path):
    page = Page(write(recs["rotations"], tmp_path).read_text(encoding="utf-8"))
    caption = next(t for t in page.of("figcaption") if "Drag" in t)
    assert caption.startswith(rm.embed(recs["rotations"]).label)


def test_size_is_that_of_the_library(torus, tmp_path):
    from plotly.offline import get_plotlyjs

    path = write(torus, tmp_path)
    library = len(get_plotlyjs().encode())
    assert library < path.stat().st_size < library + 1_000_000
    assert f"{library / 1e6:.1f} MB" in path.read_text(encoding="utf-8")


def test_what_is_refused(torus, tmp_path):
    with pytest.raises(ValueError, match=r"use \.html"):
        torus.report(tmp_path / "torus.ply")
    with pytest.raises(TypeError, match="rec must be a Reconstruction"):
        rm.write_report(
            rm.SimplicialComplex(torus.vertices, torus.simplices), tmp_path / "a.html"
        )
    with pytest.raises(TypeError, match="title must be a string"):
        torus.report(tmp_path / "a.html", title=5)
    with pytest.raises(FileNotFoundError, match="does not exist"):
        torus.report(tmp_path / "none" / "a.html")
    (tmp_path / "b.html").mkdir()
    with pytest.raises(IsADirectoryError):
        torus.report(tmp_path / "b.html")
    os.mkfifo(tmp_path / "c.html")
    with pytest.raises(ValueError, match="is not a regular file"):
        torus.report(tmp_path / "c.html")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.html", "c.html"]


def test_nothing_is_left_behind(torus, tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("before", encoding="utf-8")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(OSError, match="No space left"):
        torus.report(path)
    monkeypatch.undo()
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]
    assert path.read_text(encoding="utf-8") == "before"


# --- remanifold report --------------------------------------------------------------


def run(*arguments):
    return CliRunner().invoke(app, ["report", *map(str, arguments)])


def test_report_of_a_file(tmp_path, monkeypatch):
    source = tmp_path / "<b>torus<∕b>.csv"
    np.savetxt(source, rm.datasets.torus(300, random_state=0), delimiter=",")
    output = tmp_path / "page.html"
    arguments = [str(source), "--dim", "2", "-o", str(output), "--hole-radius", "4"]
    monkeypatch.setattr("sys.argv", ["/usr/bin/remanifold", "report", *arguments])
    done = run(*arguments)
    assert done.exit_code == 0, done.output
    assert "sampling is dense enough" in done.output
    page = Page(output.read_text(encoding="utf-8"))
    assert page.of("h1") == [source.name]
    command = f"remanifold report '{source}' --dim 2 -o {output} --hole-radius 4"
    assert page.of("code") == [command]
    assert page.row("hole radius, in local scales") == "4"


def test_report_refuses_before_the_work(tmp_path):
    source = tmp_path / "points.csv"
    np.savetxt(source, rm.datasets.torus(100, random_state=0), delimiter=",")
    done = run(source, "--dim", "2", "-o", tmp_path / "page.pdf")
    assert done.exit_code == 2
    assert "use .html" in " ".join(done.output.split())
    done = run(source, "--dim", "2", "-o", tmp_path / "none" / "page.html")
    assert done.exit_code == 1
    assert "does not exist" in done.output
    done = run(source, "--dim", "2", "-o", tmp_path / "a.html", "--edges", "either")
    assert done.exit_code == 2
    assert not list(tmp_path.glob("*.html"))


# --- In a browser -------------------------------------------------------------------


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    if chromium.find() is None:
        pytest.skip("Chromium is not installed (Debian: chromium)")
    browser = chromium.Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


def show(browser, path, width=640, height=520, *, mobile=False):
    browser.console.clear()
    browser.requests.clear()
    browser.resize(width, height, mobile=mobile)
    browser.open(path)
    browser.wait_for("document.getElementById('picture').dataset.drawn === 'yes'")


def box(browser):
    rectangle = browser.evaluate(
        "(() => { const e = document.getElementById('picture'); e.scrollIntoView();"
        "const r = e.getBoundingClientRect();"
        "return [r.x, r.y, r.width, r.height] })()"
    )
    return dict(zip(("x", "y", "width", "height"), rectangle, strict=True))


def pixels(browser):
    from PIL import Image

    clip = box(browser)
    top = browser.evaluate("window.scrollY")
    image = browser.screenshot(clip={**clip, "y": clip["y"] + top})
    return np.asarray(Image.open(io.BytesIO(image)).convert("RGB")).astype(int)


WIDE = "document.documentElement.scrollWidth"
# Right ends of what does not scroll by itself.
ENDS = (
    "Math.max(...[...document.querySelectorAll('h1, p, td, th, pre, svg, #picture')]"
    ".filter(e => !e.closest('.scroll') && !e.closest('#picture *'))"
    ".map(e => e.getBoundingClientRect().right))"
)


# What is drawn: a surface, a curve, a boundary, coordinates from products. The rest is
# opened by the tests below.
@pytest.mark.parametrize("kind", ["torus", "knot", "rotations", "gram"])
def test_pages_load_alone_and_fit(kind, browser, recs, tmp_path):
    command = "remanifold report " + "very-long-name" * 20 + ".csv --dim 2"
    path = write(recs[kind], tmp_path, title=MARKUP, command=command)
    show(browser, path)
    # Chromium's advice on speed is no complaint.
    assert [s for s in browser.console if not s.startswith("warning: Canvas2D")] == []
    outside = [u for u in browser.requests if not u.startswith(("data:", "blob:"))]
    assert outside == [path.resolve().as_uri()]
    assert browser.evaluate("document.querySelector('h1').textContent") == MARKUP
    assert browser.evaluate("document.title") == MARKUP
    image = pixels(browser)
    background = image[5, 5]
    assert (abs(image - background).max(axis=2) > 30).mean() > 0.004
    browser.resize(375, 740, mobile=True)
    browser.wait_for("window.innerWidth === 375")
    assert browser.evaluate(WIDE) <= 375
    assert browser.evaluate(ENDS) <= 375


@pytest.mark.parametrize("kind", ["sparse", "plane"])
def test_pages_open_on_a_phone(kind, browser, recs, tmp_path):
    path = write(recs[kind], tmp_path, title="x" * 120)
    show(browser, path, 375, 740, mobile=True)
    assert browser.evaluate(WIDE) <= 375
    assert browser.evaluate(ENDS) <= 375
    # The table of samples scrolls by itself.
    inner = "(document.querySelector('.scroll') || {scrollWidth: 0}).scrollWidth"
    # Tables that are too wide are scrolled, and the page is not.
    assert browser.evaluate(inner) > 375
    # The whole picture is seen: nothing is drawn at its sides.
    image = pixels(browser)[120:-40]
    sides = np.concatenate([image[:, 3:6], image[:, -6:-3]], axis=1)
    assert abs(sides - image[0, 5]).max() < 30


def test_the_mesh_can_be_downloaded(browser, torus, tmp_path):
    show(browser, write(torus, tmp_path))
    folder = tmp_path / "downloads"
    folder.mkdir()
    browser.send("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
    browser.evaluate("document.getElementById('download').click()")
    browser.wait_for("Number(document.getElementById('download').dataset.bytes) > 0")
    end = time.monotonic() + 20
    while not (folder / "mesh.ply").exists() and time.monotonic() < end:
        time.sleep(0.1)
    mesh = rm.io.read_complex(folder / "mesh.ply")
    np.testing.assert_array_equal(mesh.simplices, torus.simplices)


def test_the_picture_turns(browser, torus, tmp_path):
    show(browser, write(torus, tmp_path))
    before = pixels(browser)
    place = box(browser)
    middle = (place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    eye = "document.getElementById('picture')._fullLayout.scene.camera.eye"
    seen_from = browser.evaluate(eye)
    browser.drag(middle, (middle[0] + 180, middle[1] + 60))
    browser.wait_for(f"Math.abs({eye}.x - {seen_from['x']}) > 0.1", 10)
    time.sleep(0.5)
    assert (abs(pixels(browser) - before).max(axis=2) > 30).mean() > 0.02


def test_colors_can_be_chosen_and_the_camera_stays(browser, sparse, tmp_path):
    show(browser, write(sparse, tmp_path))
    names = browser.evaluate(
        "[...document.getElementById('color').options].map(o => o.textContent)"
    )
    assert names == [
        *("plain", "sampling ratio", "curvature", "tangent confidence"),
        *("shape quality", "in doubt"),
    ]

    def choose_and_wait(index):
        browser.evaluate(
            "(() => { const c = document.getElementById('color');"
            f"c.selectedIndex = {index}; c.dispatchEvent(new Event('change')); }})()"
        )
        browser.wait_for("document.getElementById('picture').dataset.drawn === 'yes'")
        time.sleep(0.5)

    place = box(browser)
    middle = (place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    browser.drag(middle, (middle[0] + 180, middle[1]))
    time.sleep(1)
    plain = pixels(browser)
    choose_and_wait(1)
    colored = pixels(browser)
    assert (abs(colored - plain).max(axis=2) > 40).mean() > 0.05
    choose_and_wait(0)
    again = pixels(browser)
    assert (abs(again - plain).max(axis=2) > 40).mean() < 0.02


def test_solids_are_seen_from_inside(browser, recs, tmp_path):
    """Cut open and apart, in the color and with the caption of each."""
    ball = rm.datasets.sphere(300, random_state=0)
    ball *= np.random.default_rng(0).random(300)[:, None] ** (1 / 3)
    heights = np.arange(300.0)
    solid = rm.reconstruct(ball, 3, attributes={"height": heights})
    show(browser, write(solid, tmp_path))
    seen = {}
    for view in ("cut open", "tetrahedra apart"):
        for color in ("plain", "height"):
            for name, word in (("view", view), ("color", color)):
                browser.evaluate(
                    f"(() => {{ const e = document.getElementById('{name}');"
                    f"e.value = '{word}'; e.dispatchEvent(new Event('change')) }})()"
                )
                browser.wait_for(
                    "document.getElementById('picture').dataset.drawn === 'yes'"
                )
            seen[view, color] = pixels(browser)
        caption = browser.evaluate("document.getElementById('caption').textContent")
        half = f"{(len(solid.simplices) + 1) // 2:,} of {len(solid.simplices):,}"
        assert caption.startswith("Cut: shown are " + half) == (view == "cut open")
    for one, other in itertools.combinations(seen.values(), 2):
        assert (abs(one - other).max(axis=2) > 30).mean() > 0.01
    browser.resize(375, 740, mobile=True)
    browser.wait_for("window.innerWidth === 375")
    assert browser.evaluate(WIDE) <= 375
    # A label stands beside what it is the label of.
    for name in ("color", "view"):
        apart = browser.evaluate(
            f"document.querySelector('label[for={name}]').getBoundingClientRect().top"
            f" - document.getElementById('{name}').getBoundingClientRect().top"
        )
        assert abs(apart) < 12
    # Whatever has no inside has no other view.
    write(recs["torus"], tmp_path)
    assert 'id="view"' not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_dark_pages_are_dark(browser, torus, tmp_path):
    path = write(torus, tmp_path)
    color = "getComputedStyle(document.body).backgroundColor"
    feature = {"name": "prefers-color-scheme"}
    for value, dark in (("dark", True), ("light", False)):
        browser.send(
            "Emulation.setEmulatedMedia", features=[{**feature, "value": value}]
        )
        show(browser, path)
        numbers = [int(n) for n in re.findall(r"\d+", browser.evaluate(color))[:3]]
        assert (max(numbers) < 80) == dark
    assert browser.evaluate("document.documentElement.lang") == "en"
    unnamed = (
        "[...document.querySelectorAll('table, svg, [role]')].filter(e =>"
        "!e.getAttribute('aria-label') && !e.closest('[aria-label]') &&"
        "!e.closest('#picture, #js-plotly-tester')).length"
    )
    assert browser.evaluate(unnamed) == 0
