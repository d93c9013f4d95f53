"""The documentation site: `make site` builds it from these pages and from the docstrings."""

import os
import sys

sys.path.insert(0, os.path.abspath(".."))

from driftproof import __version__

project = "driftproof"
author = "the driftproof maintainers"
release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "pydata_sphinx_theme"
html_title = f"driftproof {release}"
html_context = {"default_mode": "auto"}  # or every page complains to the browser's console
html_theme_options = {"show_toc_level": 2, "navigation_with_keys": False}
# The tables of the gallery are wide, and it has two sections.
html_theme_options["secondary_sidebar_items"] = {"**": ["page-toc"], "gallery": [], "gallery_solvers": []}
html_sidebars = {"api": []}  # its sections are all on the page
html_show_sourcelink = False
html_static_path = ["static"]
html_css_files = ["site.css"]
myst_heading_anchors = 3
# Links that lead out of docs/ are to files of the repository; that they are there, tests/outputs/test_docs.py holds.
suppress_warnings = ["myst.xref_missing"]
default_role = "code"
smartquotes = False  # q'' is a second derivative
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_class_signature = "separated"
add_module_names = False
python_use_unqualified_type_names = True
highlight_language = "none"


def setup(app: object) -> None:
    """Docstrings are written for people: bars and stars in them are mathematics."""
    app.connect("autodoc-process-docstring", _mathematics_as_it_stands)  # type: ignore[attr-defined]


def _mathematics_as_it_stands(
    app: object, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    quoted = False
    for i, line in enumerate(lines):
        quoted = line.startswith(("    ", ">>>")) or (quoted and bool(line.strip()))
        if not quoted:
            lines[i] = line.replace("|", r"\|").replace("*", r"\*")
