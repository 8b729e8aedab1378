"""Sphinx's configuration. `make docs` builds the site; nothing here may need the network.

The source folder is the root of the project, so that a link between documents works in a plain file viewer
and on the site alike, also where it leads out of docs/.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "host"), str(ROOT / "tools")]

from tilenca import __version__  # noqa: E402  # found by the line above

project = "tilenca"
author = "the tilenca authors"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "docs.docstrings",
    "docs.command_pages",
    "docs.json_pages",
    "docs.module_pages",
]
root_doc = "docs/index"
# The cards that the reference lists: a model that a user trains beside them has no page.
cards = re.findall(
    r"models/[^/]+/README", (ROOT / "docs" / "reference" / "models.md").read_text(encoding="utf-8")
)
include_patterns = [
    "docs/**",
    *(f"{card}.md" for card in cards),
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
]
exclude_patterns = [".*", "build", "firmware", "host", "test", "tools", "tiles"]

myst_heading_anchors = 4
# Rows of tables have anchors of their own, which MyST does not know of; links.py checks all links of the
# built site, those to anchors included.
suppress_warnings = ["myst.xref_missing"]

html_theme = "furo"
html_title = f"tilenca {version}"
html_extra_path = ["root"]  # index.html, which leads to the root document
html_copy_source = False
html_show_copyright = False

# A button on code that a reader types or keeps, not on what a program prints.
TYPED = ("bash", "dockerfile", "html", "js", "python", "sh", "toml", "yaml")
copybutton_selector = f":is({', '.join(f'.highlight-{language}' for language in TYPED)}) pre"

highlight_language = "text"  # of a block that names no language

# Docstrings set code in single backquotes, as the rest of the project does.
default_role = "literal"
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_attr_annotations = False  # the signature of a dataclass has them
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "show-inheritance": True}
autosummary_generate = False  # the tables only; the modules' texts are on the same page

# References to other projects would need their inventories from the network.
nitpick_ignore_regex = [
    ("py:.*", rf"({'|'.join(names)})(\..*)?")
    for names in [
        ["argparse", "collections", "concurrent", "contextlib", "ctypes", "enum", "json", "os", "pathlib"],
        ["queue", "random", "re", "socket", "subprocess", "threading", "types", "typing", "_io", "io"],
        ["jinja2", "matplotlib", "np", "numpy", "PIL", "npt", "rich", "serial", "starlette", "torch"],
    ]
]
