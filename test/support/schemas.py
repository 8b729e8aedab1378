"""What commands print as JSON, checked against docs/schemas."""

import json
from functools import cache
from typing import Any

from jsonschema import Draft202012Validator
from referencing import Registry, Resource

from tilenca.base import paths

FOLDER = paths.ROOT / "docs" / "schemas"


@cache
def schemas() -> dict[str, Any]:
    """All schemas, by their names."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in FOLDER.glob("*.json")}


@cache
def _validator(name: str) -> Draft202012Validator:
    resources = [(f"{other}.json", Resource.from_contents(schema)) for other, schema in schemas().items()]
    return Draft202012Validator(schemas()[name], registry=Registry().with_resources(resources))


def fits(name: str, document: Any) -> bool:
    """Whether a document is what the schema of this name says; fails with the places where it is not."""
    wrong = [f"{error.json_path}: {error.message}" for error in _validator(name).iter_errors(document)]
    assert not wrong, f"{name}: {'; '.join(wrong)[:2000]}"
    return True
