"""The reference of a package, made from its docstrings: the directive `tilenca-modules`.

It lists the package's modules as they are, so that a page cannot miss a new one. Sphinx is needed for the
directive only.
"""

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx


def modules(package: str) -> list[str]:
    """The full names of a package's modules, those of its sub-packages not among them."""
    spec = importlib.util.find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise ValueError(f"{package} is no package")
    (folder,) = spec.submodule_search_locations
    return [f"{package}.{path.stem}" for path in sorted(Path(folder).glob("[!_]*.py"))]


def rendered(package: str) -> str:
    """A table of the modules, and a section for each: reStructuredText."""
    names = modules(package)
    parts = [f".. automodule:: {package}", "   :no-members:", ""]
    parts += [".. py:currentmodule:: None", "", ".. autosummary::", ""]
    parts += [f"   {name}" for name in names]
    for name in names:
        parts += ["", name, "-" * len(name), "", f".. automodule:: {name}"]
    return "\n".join(parts)


def setup(app: "Sphinx") -> dict[str, bool]:
    """Adds the directive."""
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    class Modules(SphinxDirective):
        """`.. tilenca-modules:: tilenca.base` in a page of reStructuredText."""

        required_arguments = 1

        def run(self) -> list[nodes.Node]:
            return self.parse_text_to_nodes(rendered(self.arguments[0]), allow_section_headings=True)

    app.add_directive("tilenca-modules", Modules)
    return {"parallel_read_safe": True}
