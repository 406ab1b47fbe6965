# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages name everything there is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import remanifold as rm

ROOT = Path(__file__).resolve().parents[3]
DOCS = ROOT / "docs"


def text(path):
    return path.read_text(encoding="utf-8")


def test_api_has_every_public_name():
    public = set(rm.__all__) - {"__version__", "datasets", "interoperability", "io"}
    api = [text(path) for path in (DOCS / "api").glob("*.md")]
    described = re.findall(r"(?m)^\.\. auto(?:class|function):: (\w+)$", "\n".join(api))
    assert sorted(described) == sorted(public)
    listed = re.findall(r"(?m)^   ([A-Za-z_]+)$", text(DOCS / "api" / "index.md"))
    assert sorted(listed) == sorted(public)


def test_api_has_every_module():
    pages = {path.stem for path in (DOCS / "api").glob("*.md")}
    assert {"datasets", "interoperability", "io"} <= pages
    for name in pages:
        assert f"({name}.md)" in text(DOCS / "api" / "index.md") or name == "index"


def test_cpp_api_has_every_public_header():
    headers = {path.name for path in (ROOT / "cpp/include/remanifold").glob("*.hpp")}
    page = text(DOCS / "cpp_api.md")
    shown = re.findall(r"literalinclude\} \.\./cpp/include/remanifold/(\S+)", page)
    assert sorted(shown) == sorted(headers - {"remanifold.hpp"})


def test_every_parameter_has_its_place():
    page = text(DOCS / "choosing_parameters.md")
    headings = " ".join(re.findall(r"(?m)^## (.*)$", page))
    code = rm.reconstruct.__code__
    for name in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]:
        assert f"`{name}`" in headings, name


def test_every_page_is_in_a_table_of_contents():
    """The site says so too, as a warning; this is sooner and needs no Sphinx."""
    trees = {}
    for path in DOCS.rglob("index.md"):
        entries = re.findall(r"(?s)```\{toctree\}\n(.*?)```", text(path))
        rows = "\n".join(entries).splitlines()
        trees[path] = {path.parent / f"{row}.md" for row in rows if row[:1].isalpha()}
    listed = set().union(*trees.values())
    assert listed | {DOCS / "index.md"} == set(DOCS.rglob("*.md"))


# A page, what was measured there, and what the page of parameters says of it.
QUOTED = (
    ("how_it_works.md", "| 1.0 | 17 |", "both stay open, and 15 ordinary gaps"),
    ("how_it_works.md", "| 1.5 | 2 |", "| 1.5 | both stay open |"),
    ("how_it_works.md", "| 4.0 | 1 |", "| 2.0 to 4.0 | the gap is closed"),
    ("how_it_works.md", "| 5.0 | 0 |", "| 5.0 and more | both are closed |"),
    ("how_it_works.md", "in h of its rim | 4.5 |", "an opening of 4.5 scales"),
    ("how_it_works.md", "radius of the gap in median h | 2.0 |", "a gap of 2.0"),
    ("how_it_works.md", "11.62° | 6.65° | 1.80°", 'that of `"pca"` 6.65'),
    ("how_it_works.md", "1.80° | 1.08° | 0.04°", "0.04, 1.08 and 1.80"),
    ("noise_and_outliers.md", "1,692 of 1,800", "1,692 of 1,800 were found"),
    ("noise_and_outliers.md", "564 of 600 instead of 562", "564 of 600 instead of 562"),
    (
        "noise_and_outliers.md",
        "| torus in R^3 | 20,000 | 0.07 | 0.11 | 0.21 | 0.37 |",
        "0.07, 0.11, 0.21 and 0.37",
    ),
    ("real_data.md", "two components are left of four", "four components to two"),
    ("benchmarks.md", "Two threads, at rest: 1.7 to 1.8", "are 1.7 to 1.8 times"),
    ("limits.md", "nearer to each other than 6e-8", "nearer than 6e-8"),
)


@pytest.mark.parametrize(("name", "measured", "said"), QUOTED)
def test_what_the_page_of_parameters_says_was_measured(name, measured, said):
    assert measured in " ".join(text(DOCS / name).split())
    assert said in " ".join(text(DOCS / "choosing_parameters.md").split())


def plain(title):
    return re.sub(r"\W+", " ", title).strip().lower()


PAGES = sorted(set(DOCS.rglob("*.md")) - {DOCS / "references.md"})


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_sources_of_the_pages_are_among_the_references(path):
    known = plain(text(DOCS / "references.md"))
    sources = re.split(r"(?m)^## (?:References|Sources?)$", text(path))[1:]
    for title in re.findall(r"(?s)(?<!\*)\*([^*]{15,}?)\*(?!\*)", "\n".join(sources)):
        assert plain(title) in known, title


def test_numbers_of_the_readme_are_those_of_the_tables():
    readme = " ".join(text(DOCS.parent / "README.md").split())
    table = text(DOCS / "sampling_report.md").partition("## How often it is right")[2]
    rows = re.findall(
        r"(?m)^\| .* to .* \| \d+ \| (\d+) \| (\d*).*\| (\d+) \| (\d+) \(", table
    )
    wrong, warned, right, alarms = (
        sum(int(row[i] or 0) for row in rows) for i in range(4)
    )
    assert len(rows) > 10
    assert f"{warned} of {wrong} wrong results" in readme
    assert f"{alarms} of {right} right ones" in readme
    assert f"of {wrong} wrong results" in " ".join(text(DOCS / "faq.md").split())

    peers = text(DOCS / "benchmarks.md").partition("<!-- side by side -->")[2]
    noisy = peers.partition("random order, noise 0.5**")[2]
    judged = re.findall(r"(?m)^\| (\w[^|]*) \| 30,000 \|.*\| (\w+)[^|]* \|$", noisy)
    assert len(judged) > 7
    assert {name for name, verdict in judged if verdict == "right"} == {"remanifold"}

    def seconds(name):
        return float(re.search(rf"\| {name} \| 1,000,000 \| ([\d.]+) \|", peers)[1])

    assert f"{seconds('remanifold'):.1f} s on one core" in readme
    assert f"takes {seconds('FLANN 20-NN'):.1f} s" in readme
    assert f"advancing front {seconds('CGAL advancing front'):.0f} s" in readme
