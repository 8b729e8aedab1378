"""`tilenca emulate` in this process."""

import json
from typing import Any

import pytest

from tilenca import cli


def emulate(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit status, stdout, stderr."""
    try:
        status = cli.main(["emulate", "--shape", "1", *map(str, arguments)])
    except SystemExit as ended:
        status = int(ended.code or 0)
    said = capsys.readouterr()
    return status, said.out, said.err


def report(capsys: pytest.CaptureFixture[str], *arguments: object) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(emulate(capsys, "--json", *arguments)[1])
    del document["wall_s"]
    return document
