"""The page as a program meets it: a server of its own, and the system's browser without a window."""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from tilenca.base.paths import ROOT


@contextmanager
def browser_at(program: str) -> Iterator[Browser]:
    """Starts a Chromium; it ends after the block.

    Args:
        program: its path, as `bench.chromium.program` finds it.
    """
    with sync_playwright() as playwright:
        # The sandbox needs rights that root in a container has not; only our own page is opened.
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def served_page(words: Sequence[str] = ()) -> Iterator[str]:
    """Starts `tilenca page` on a port that is free, and yields its address; it ends after the block.

    Args:
        words: further arguments.

    Raises:
        RuntimeError: it did not say its address.
    """
    command = [sys.executable, "-P", "-m", "tilenca.cli", "page", "--no-open", "--listen", "127.0.0.1:0"]
    with _speaking([*command, *words]) as line:
        if not line.startswith("http://"):
            raise RuntimeError(f"tilenca page: {line or 'ended without a word'}")
        yield line


@contextmanager
def served_files(folder: Path) -> Iterator[str]:
    """Serves a folder as users do, by `python -m http.server`, and yields its address.

    Raises:
        RuntimeError: it did not say its address.
    """
    command = [sys.executable, "-u", "-m", "http.server", "--bind", "127.0.0.1", "--directory", str(folder)]
    with _speaking([*command, "0"]) as line:
        _, found, address = line.partition("(http://")
        if not found:
            raise RuntimeError(f"http.server: {line or 'ended without a word'}")
        yield f"http://{address.partition(')')[0]}"


@contextmanager
def _speaking(command: Sequence[str]) -> Iterator[str]:
    """Starts a process, and yields the first line that it prints."""
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT
    )
    try:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
    finally:
        process.terminate()
        process.wait(60)
