"""Modules of the page, run by node: for what needs no browser."""

import json
import shutil
import subprocess
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

from tilenca.base import paths

# Reads one argument a line and answers with a line: what `answer` makes of it.
LOOP = """
import { createInterface } from "node:readline";
for await (const line of createInterface({ input: process.stdin })) {
  console.log(JSON.stringify(answer(JSON.parse(line)) ?? null));
}
"""


class PageNode:
    """Runs a function of the page for one argument after the other; use it as a context manager."""

    def __init__(self, folder: Path, script: str) -> None:
        """Will run `script`, which may import modules of the page and defines `answer(argument)`.

        Args:
            folder: an empty one; it gets the modules.
            script: of JavaScript; a module of the page is `./stream/NAME.js` or
                `./components/NAME.js`; there is no document.
        """
        if shutil.which("node") is None:
            pytest.skip("node is not installed; run `make test-web`")
        for part in ("stream", "components"):
            shutil.copytree(paths.PAGE / part, folder / part)
        (folder / "package.json").write_text('{"type": "module"}')
        (folder / "main.js").write_text(script + LOOP)
        self._process = subprocess.Popen(
            ["node", folder / "main.js"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, argument: object) -> Any:
        """What the function returns."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{json.dumps(argument)}\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate(timeout=60)
        assert kind or self._process.returncode == 0
