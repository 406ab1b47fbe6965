# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of Sphinx: `make docs` builds this folder into build/docs."""

import re

import remanifold

project = "remanifold"
author = "The remanifold developers"
copyright = author
version = release = remanifold.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
]
exclude_patterns = ["examples"]
nitpicky = True
nitpick_ignore = [("py:mod", "sklearn.datasets")]  # links would need the network

# Pages are written for a forge as well: links between them are relative paths, and
# headings have the anchors that forges make.
myst_heading_anchors = 3
highlight_language = "none"  # of blocks that name none
smartquotes = False

# The docstrings say types and shapes. Single backticks link what can be imported and set
# the rest, names of parameters mostly, in italics.
default_role = "autolink"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = False
numpydoc_attributes_as_param_list = True
numpydoc_show_class_members = False

html_theme = "furo"
html_title = f"remanifold {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}


def skip_member(_app, _what, _name, member, skip, _options):
    """Leave out the fields of named tuples, which the docstring of the class lists."""
    return skip or type(member).__name__ == "_tuplegetter"


def only_public_bases(_app, _name, _object, _options, bases):
    """Leave out the bases that hold the data: their members are shown as the class's."""
    bases[:] = [base for base in bases if base.__name__ in remanifold.__all__]


def link_outside(_app, _name, source):
    """What lies outside the site: the first page takes the place of the README."""
    text = re.sub(r"\]\((\.\./)+README\.md", "](/index.md", source[0])
    source[0] = re.sub(r"\]\((\.\./)+CONTRIBUTING\.md", "](/contributing.md", text)


def resolve_in_package(app, env, node, contnode):
    """In all modules the docstrings name what the package exports by its bare name."""
    if node["refdomain"] != "py":
        return None
    name = "remanifold." + node["reftarget"].removeprefix("remanifold.")
    return env.get_domain("py").resolve_xref(
        env, node["refdoc"], app.builder, "obj", name, node, contnode
    )


def setup(app):
    """Connect them."""
    app.connect("autodoc-skip-member", skip_member)
    app.connect("autodoc-process-bases", only_public_bases)
    app.connect("missing-reference", resolve_in_package)
    app.connect("source-read", link_outside)
