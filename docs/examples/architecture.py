# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture and the tables of docs/architecture.md, read from the tree.

    python docs/examples/architecture.py

Rooms are folders; what a file is for is the first sentence of its own header. So the
page says what the files say, and a test fails when it no longer does.
"""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "architecture.md"
FIGURE = ROOT / "docs" / "figures" / "architecture.svg"

# What passes from room to room. Each room of the tree has its place here: the core's in
# the order of the data, the package's from the bottom to the top.
CORE = "cpp/src"
PACKAGE = "python/remanifold"
CORE_ROOMS = {
    "base": "what every room stands on",
    "samples": "merged, scaled, sorted samples",
    "neighbors": "nearest others, exactly",
    "cleaning": "outliers, noise",
    "local": "tangent spaces, regions",
    "complex": "stars, votes, facets",
    "chain": "cavities closed at least energy",
    "query": "topology, projection, quality",
}
PACKAGE_ROOMS = {
    "_base": "checks, options, inputs",
    "complex": "complexes and what to ask",
    "calculus": "functions, paths, curvature",
    "remeshing": "fewer or more simplices",
    "method": "the steps, one by one",
    "judging": "how far to trust a result",
    "formats": "files, others' objects",
    "drawing": "pictures",
    "page": "the report page",
    "results": "the classes, and reconstruct",
    "datasets": "sampled manifolds",
    "distributed": "in tiles, by workers",
    "cli": "the command line",
}
# From, to, what. "input" and "result" are no rooms.
FLOW = (
    ("input", "samples", "points or products"),
    ("samples", "neighbors", "canonical samples"),
    ("neighbors", "cleaning", "neighborhoods"),
    ("cleaning", "local", "neighborhoods"),
    ("local", "complex", "stars"),
    ("complex", "chain", "agreed, disputed"),
    ("chain", "result", "simplices, repair"),
    ("result", "query", "a complex"),
)


def first_sentence(path):
    """What a file says it is."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        match = re.search(r'"""(.*?)"""', text, re.DOTALL)
        header = match[1] if match else ""
    else:
        lines = text.splitlines()[1:]
        comment = []
        for line in lines:
            if not line.startswith("//"):
                break
            comment.append(line[2:].strip())
        header = " ".join(comment)
    paragraph = " ".join(header.strip().split("\n\n")[0].split())
    sentence = re.split(r"(?<=[A-Za-z0-9)`])\.(?: |$)", paragraph)[0]
    return sentence.replace("|", "\\|")


def header_of(path):
    """A source without words of its own says what the header of its name says."""
    places = (path.with_suffix(".hpp"), ROOT / "cpp/include/remanifold" / path.name)
    for header in (path, places[0], places[1].with_suffix(".hpp")):
        if header.is_file() and (said := first_sentence(header)):
            return said
    return ""


def rooms(folder):
    """Folders with sources, by name."""
    found = [p.name for p in (ROOT / folder).iterdir() if p.is_dir()]
    return sorted(name for name in found if name != "__pycache__")


def files(folder):
    """Sources of a folder, one a name: a header and its source are one piece."""
    found = {}
    for path in sorted((ROOT / folder).iterdir()):
        if path.suffix in {".cpp", ".py"} or (
            path.suffix == ".hpp" and not path.with_suffix(".cpp").is_file()
        ):
            found[path.name] = path
    return list(found.values())


def table(folder):
    rows = ["| file | what it is |", "|---|---|"]
    for path in files(folder):
        if path.name == "__init__.py" and folder != PACKAGE:
            continue
        rows.append(f"| `{path.name}` | {header_of(path)} |")
    return "\n".join(rows)


def tables():
    """The generated part of the page."""
    out = []
    for top, known in ((CORE, CORE_ROOMS), (PACKAGE, PACKAGE_ROOMS)):
        out.append(f"### `{top}/`\n\n{table(top)}")
        for room, what in known.items():
            out.append(f"### `{top}/{room}/`: {what}\n\n{table(f'{top}/{room}')}")
    return "\n\n".join(out)


def with_tables(text):
    """The page with its generated part made anew."""
    begin, end = "<!-- files: made by docs/examples/architecture.py -->", "<!-- end -->"
    before, rest = text.split(begin)
    after = rest.split(end)[1]
    return f"{before}{begin}\n\n{tables()}\n\n{end}{after}"


def box(x, y, width, height, title, words, kind):
    middle = x + width / 2
    return [
        (
            f'<rect class="{kind}" x="{x}" y="{y}" width="{width}" height="{height}" '
            'rx="6"/>'
        ),
        f'<text class="title" x="{middle}" y="{y + 21}">{title}</text>',
        f'<text class="words" x="{middle}" y="{y + 38}">{words}</text>',
    ]


def arrow(x1, y1, x2, y2, words, anchor="middle"):
    return [
        f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" marker-end="url(#tip)"/>',
        (
            f'<text class="flow" x="{(x1 + x2) / 2}" y="{(y1 + y2) / 2 - 6}" '
            f'text-anchor="{anchor}">{words}</text>'
        ),
    ]


def picture():
    """The data's way through the core, and the package on top of it."""
    width, box_width, box_height, step = 1180, 190, 48, 320
    lines = []
    # Upper half: the package, from the command line down to the bindings.
    layers = (
        ("cli", "sklearn.py", "io.py"),
        ("results",),
        ("page", "drawing", "formats"),
        ("judging", "method"),
        ("remeshing", "calculus", "complex"),
        ("_base", "datasets"),
    )
    words = {**PACKAGE_ROOMS, "sklearn.py": "an estimator", "io.py": "reading, writing"}
    y = 40
    lines.append(
        '<text class="head" x="20" y="24">python/remanifold: '
        "each layer knows those below it</text>"
    )
    for layer in layers:
        span = (len(layer) - 1) * step / 1.4 + box_width
        x = (width - span) / 2
        for room in layer:
            lines += box(x, y, box_width, box_height, room, words[room], "package")
            x += step / 1.4
        y += box_height + 14
    y += 6
    lines += box(
        (width - 460) / 2,
        y,
        460,
        box_height,
        "python/bindings",
        "arrays in, arrays out; no algorithm",
        "border",
    )
    y += box_height + 40
    # Lower half: the core, the data from left to right in two rows.
    lines.append(
        f'<text class="head" x="20" y="{y - 10}">cpp/src: the way of the data</text>'
    )
    places = {}
    order = ["input", *(r for r in CORE_ROOMS if r != "base"), "result"]
    order.remove("query")
    order.append("query")
    columns = 4
    for i, room in enumerate(order):
        row, column = divmod(i, columns)
        column = column if row % 2 == 0 else columns - 1 - column
        places[room] = (20 + column * (box_width + 126), y + 14 + row * 96)
    for room, (x, top) in places.items():
        kind = "core" if room in CORE_ROOMS else "data"
        said = CORE_ROOMS.get(room, {"input": "an array", "result": "arrays"}.get(room))
        lines += box(x, top, box_width, box_height, room, said, kind)
    for start, stop, said in FLOW:
        (x1, y1), (x2, y2) = places[start], places[stop]
        if y1 == y2 and x1 < x2:
            lines += arrow(x1 + box_width, y1 + 24, x2 - 4, y2 + 24, said)
        elif y1 == y2:
            lines += arrow(x1, y1 + 24, x2 + box_width + 4, y2 + 24, said)
        else:
            middle = x1 + box_width / 2
            lines += arrow(middle, y1 + box_height, middle, y2 - 4, "")
            lines.append(
                f'<text class="flow" x="{middle + 8}" y="{(y1 + box_height + y2) / 2}"'
                f' text-anchor="start">{said}</text>'
            )
    bottom = max(top for _, top in places.values()) + box_height + 20
    lines += box(20, bottom, width - 40, box_height, "base", CORE_ROOMS["base"], "core")
    height = bottom + box_height + 16
    style = (
        "rect{stroke:#20466e;stroke-width:1.2}.package{fill:#fdebd0}.core{fill:#dbe7f5}"
        ".border{fill:#eeeeee}.data{fill:#ffffff;stroke-dasharray:5 4}"
        "text{font-family:sans-serif;fill:#1a2a3a}.title{font-size:15px;"
        "font-weight:bold;text-anchor:middle}.words,.flow{font-size:11.5px}"
        ".words{text-anchor:middle}.flow{fill:#555}.head{font-size:14px;fill:#555}"
        "line{stroke:#20466e;stroke-width:1.4}"
    )
    return "\n".join(
        [
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" '
                f'height="{height}" viewBox="0 0 {width} {height}">'
            ),
            f"<style>{style}</style>",
            (
                '<defs><marker id="tip" markerWidth="9" markerHeight="8" refX="7" refY="4" '
                'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#20466e"/></marker></defs>'
            ),
            f'<rect width="{width}" height="{height}" style="fill:#fff;stroke:none"/>',
            *lines,
            "</svg>",
            "",
        ]
    )


if __name__ == "__main__":
    FIGURE.write_text(picture(), encoding="utf-8")
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(with_tables(page), encoding="utf-8")
    print(f"architecture: {FIGURE.name} and the tables of {PAGE.name}")
