"""The reference of JSON output, made from docs/schemas: the directive `tilenca-json`.

`rendered` is the page's text, in reStructuredText; Sphinx is needed for the directive only.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

SCHEMAS = Path(__file__).resolve().parents[2] / "docs" / "schemas"
LONGEST = 400  # characters of an example in one line


def rendered() -> str:
    """A section for each schema: an example, and what each key means."""
    return "\n\n".join("\n".join(_section(path)) for path in sorted(SCHEMAS.glob("*.json")))


def _section(path: Path) -> Iterator[str]:
    schema = json.loads(path.read_text(encoding="utf-8"))
    title = schema["title"].replace("`", "")
    yield from (path.stem, "-" * len(path.stem), "", f"{title}.", "")
    yield from (".. code-block:: json", "")
    yield from (f"   {line}" for line in _example(schema["examples"][0]).splitlines())
    yield ""
    for key, part in _keys(schema):
        about = part.get("description", "")
        yield f"- ``{key}``: {_kind(part)}{f'; {about}' if about else ''}"


def _example(document: Any) -> str:
    text = json.dumps(document, ensure_ascii=False)
    return text if len(text) < LONGEST else json.dumps(document, ensure_ascii=False, indent=1)


def _keys(schema: dict[str, Any], before: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """The keys of a schema and of all that is in it, as paths; what another file has is not repeated."""
    for part in (*schema.get("anyOf", ()), *schema.get("$defs", {}).values()):
        yield from _keys(part, before)
    if not before and schema.get("type") == "array":
        yield from _keys(schema["items"], "[].")
    for key, part in schema.get("properties", {}).items():
        yield f"{before}{key}", part
        items = part.get("items", {})
        yield from _keys(part, f"{before}{key}.")
        yield from _keys(items, f"{before}{key}[].")


def _kind(part: dict[str, Any]) -> str:
    if "$ref" in part:
        return f"see ``{part['$ref'].removesuffix('.json')}``"
    kinds = part.get("type", "any")
    text = " or ".join(kinds) if isinstance(kinds, list) else str(kinds)
    if "items" in part and (inner := _kind(part["items"])) != "object":
        text += f" of {inner}"
    if "enum" in part:
        text += f" ({', '.join(f'``{value}``' for value in part['enum'])})"
    return text


def setup(app: "Sphinx") -> dict[str, bool]:
    """Adds the directive."""
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    class Documents(SphinxDirective):
        """`.. tilenca-json::` in a page of reStructuredText."""

        def run(self) -> list[nodes.Node]:
            return self.parse_text_to_nodes(rendered(), allow_section_headings=True)

    app.add_directive("tilenca-json", Documents)
    return {"parallel_read_safe": True}
