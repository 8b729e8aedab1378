"""How quick the page is, from a fresh visit to a click: python -m bench.page [--write FILE].

The page of `tilenca page`, and the same in a folder of files, in the system's browser without a window. Times
are those that a visitor has, so other load on the machine counts; the table says how much there was.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from playwright.sync_api import Browser, Page

from bench import chromium
from bench.figures import exact, note
from bench.publish import publish
from page.visit import browser_at, served_files, served_page
from release.page_bundle import lay_out
from tilenca.base.paths import BUILD

BEGIN, END = "<!-- page: made by `python -m bench.page`, do not edit -->", "<!-- /page -->"
WEB = BUILD / "web" / "bundle"
LOADS, CLICKS = 10, 8
WARM_UP_MS, WATCHED_MS = 4000, 10_000
LONG_MS = 50  # a frame that lasts longer is felt
TWENTY, HUNDRED = "-".join(["1111"] * 5), "-".join(["1" * 10] * 10)

# Notes when the first tile stands, how long each frame lasts, and how long after a click another tile stands.
PROBE = """
  window.probe = { firstTileMs: 0, frames: [], clicks: [] };
  let frameMs = 0, clickMs = 0;
  const count = () => document.getElementsByClassName("tile").length;
  let tiles = 0;
  new MutationObserver(() => {
    const now = performance.now(), found = count();
    if (found && !tiles) probe.firstTileMs = now;
    if (found > tiles && clickMs) { probe.clicks.push(now - clickMs); clickMs = 0; }
    tiles = found;
  }).observe(document, { childList: true, subtree: true });
  addEventListener("pointerdown", () => { clickMs = performance.now(); }, true);
  requestAnimationFrame(function next(now) {
    if (frameMs) probe.frames.push(now - frameMs);
    frameMs = now;
    requestAnimationFrame(next);
  });
"""
PAINT = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? 0"


@dataclass(frozen=True)
class Frames:
    """How smoothly some tiles were drawn.

    Attributes:
        per_s: frames a second.
        long: how many lasted over LONG_MS.
        longest_ms: the longest.
        speed: what the page says of the speed it reaches.
    """

    per_s: float
    long: int
    longest_ms: float
    speed: str

    def __str__(self) -> str:
        """As the table has it."""
        over = f"{self.long} over {LONG_MS} ms" if self.long else f"none over {LONG_MS} ms"
        return f"{self.per_s:.0f} frames a second, {over}, the longest {self.longest_ms:.0f} ms; {self.speed}"


@contextmanager
def _fresh(browser: Browser) -> Iterator[tuple[Page, list[str]]]:
    """A page without a past, and the addresses that it asks for."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    requests: list[str] = []
    try:
        page = context.new_page()
        page.add_init_script(PROBE)
        page.on("request", lambda request: requests.append(request.url))
        yield page, requests
    finally:
        context.close()


@contextmanager
def _running(browser: Browser, url: str, drawing: str, speed: float) -> Iterator[Page]:
    """A fresh page on which tiles have run for a while; see `watch`."""
    with _fresh(browser) as (page, _):
        page.goto(f"{url}?draw={drawing}&speed={speed}&seed=1")
        page.locator(".tile").first.wait_for()
        page.wait_for_timeout(WARM_UP_MS)
        yield page


def load(browser: Browser, url: str) -> tuple[float, float, int]:
    """Opens the page once.

    Returns:
        Milliseconds from the beginning of the load to the first paint, the same to the first tile, and how
        many requests were made until then.
    """
    with _fresh(browser) as (page, requests):
        page.goto(url)
        page.locator(".tile").first.wait_for()
        count = len(requests)
        told: dict[str, Any] = page.evaluate(f"({{ tile: probe.firstTileMs, paint: {PAINT} }})")
    return told["paint"], told["tile"], count


def watch(browser: Browser, url: str, drawing: str, speed: float) -> Frames:
    """Lets tiles run for a while, and looks at the page's frames.

    Args:
        browser: a running one.
        url: of the page.
        drawing: as the page's address has it.
        speed: of the tiles' time against a clock on the wall.
    """
    with _running(browser, url, drawing, speed) as page:
        page.evaluate("probe.frames.length = 0")
        page.wait_for_timeout(WATCHED_MS)
        lasted: list[float] = page.evaluate("probe.frames")
        words = page.locator("output[for=speed]").inner_text()
    long = sum(ms > LONG_MS for ms in lasted)
    return Frames(1000 * len(lasted) / sum(lasted), long, max(lasted), words)


def click(browser: Browser, url: str) -> list[float]:
    """Milliseconds from a press on an empty place to its tile, while twenty tiles run in real time."""
    with _running(browser, url, TWENTY, 1) as page:
        page.get_by_role("button", name="Draw", exact=True).click()
        for done in range(CLICKS):
            page.locator(".spot").first.click()
            for _ in range(200):
                if len(page.evaluate("probe.clicks")) > done:
                    break
                page.wait_for_timeout(10)
        seen: list[float] = page.evaluate("probe.clicks")
    return seen


def measure(browser: Browser, url: str, where: str) -> list[str]:
    """The figures of one place, in the order of NAMES."""
    loads = [load(browser, url) for _ in range(LOADS)]
    paint, tile, requests = ([one[k] for one in loads] for k in range(3))
    note(exact(f"page: {where}, requests before the first tile", max(requests), "requests"))
    seen = click(browser, url)
    return [
        _times(paint),
        _times(tile),
        f"{max(requests)}",
        _times(seen) if len(seen) == CLICKS else f"{len(seen)} of {CLICKS} were seen",
        str(watch(browser, url, TWENTY, 0.1)),
        str(watch(browser, url, TWENTY, 1)),
        str(watch(browser, url, HUNDRED, 1)),
    ]


NAMES = (
    f"first paint after the load began, {LOADS} fresh visits",
    "first tile",
    "requests before it",
    f"from a press on an empty place to its tile, {CLICKS} times",
    "twenty tiles, ten times slower than real time",
    "twenty tiles in real time",
    "a hundred tiles in real time",
)


def _times(milliseconds: list[float]) -> str:
    return f"{median(milliseconds):.0f} ms, at most {max(milliseconds):.0f}"


def main() -> int:
    """Prints the table, and writes it if asked to."""
    parser = argparse.ArgumentParser(description="How quick the page is.")
    parser.add_argument("--write", type=Path, metavar="F", help="put the table into this document")
    args = parser.parse_args()
    program = chromium.program()
    if program is None:
        print("bench: no Chromium here, so the page is not measured; run `make setup-test`", file=sys.stderr)
        return 0
    load_before = os.getloadavg()[0]
    columns: dict[str, list[str]] = {}
    try:
        with browser_at(program) as browser, ExitStack() as places:
            url = places.enter_context(served_page())
            columns["`tilenca page`"] = measure(browser, url, "tilenca page")
            if (WEB / "tilenca_emulator.wasm").exists():
                folder = Path(places.enter_context(tempfile.TemporaryDirectory())) / "page"
                lay_out(WEB, folder)
                url = places.enter_context(served_files(folder))
                columns["a folder of files"] = measure(browser, url, "folder of files")
    except RuntimeError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    head = [f"| the page | {' | '.join(columns)} |", "|---" * (len(columns) + 1) + "|"]
    rows = [f"| {' | '.join(cells)} |" for cells in zip(NAMES, *columns.values(), strict=True)]
    busy = f"load {load_before:.1f} on {os.cpu_count()} cores before"
    below = f"Chromium without a graphics card; frames of {WATCHED_MS // 1000} s; {busy}."
    publish("\n".join([*head, *rows, "", below]), args.write, BEGIN, END)
    return 0


if __name__ == "__main__":
    sys.exit(main())
