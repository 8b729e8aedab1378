"""Chromium of the system, driven by Playwright: one for all tests of a process."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, Page

from bench import chromium
from page.visit import browser_at

SIZES = {"phone": (390, 844), "laptop": (1280, 800), "projector": (1920, 1080)}
# A machine that does much else besides is slow, and not wrong.
LIMIT_MS = 120_000


RECORDER = """
  window.stream = { said: {}, sent: [], opened: 0 };
  window.WebSocket = class extends WebSocket {
    constructor(url) {
      super(url);
      stream.opened++;
      this.addEventListener("message", (message) => {
        for (const event of JSON.parse(message.data).events) {
          if (event.run) stream.said = {};
          if (event.raw?.startsWith("$TILE")) stream.said[event.port] = event.raw;
        }
      });
    }
    send(text) {
      stream.sent.push(JSON.parse(text).do);
      super.send(text);
    }
  };
"""


@contextmanager
def running_browser() -> Iterator[Browser]:
    """Starts it without a window; where there is none, tests are skipped, but not by CI."""
    path = chromium.program()
    if path is None:
        reason = f"no Chromium here; install one, or set {chromium.OTHER}"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    with browser_at(path) as browser:
        yield browser


class Visit:
    """A page in the browser, and what it has complained of."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.forgiven: tuple[str, ...] = ()  # complaints with these words are none
        self.requests: list[str] = []
        page.set_default_timeout(LIMIT_MS)
        page.on("console", lambda message: self._heard(message.type, message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def record_stream(self) -> None:
        """From the next document on, notes in the page what goes over the socket; call it before `goto`.

        Playwright's own way hands every message to the test, which costs more than the page itself.
        """
        self.page.add_init_script(RECORDER)

    def last_said(self) -> dict[str, str]:
        """The last `$TILE` of each port in this run."""
        said: dict[str, str] = self.page.evaluate("stream.said")
        return said

    def sent(self) -> set[str]:
        """The kinds of commands that the page has sent."""
        return set(self.page.evaluate("stream.sent"))

    def _heard(self, kind: str, text: str) -> None:
        if kind in ("error", "warning") and not any(words in text for words in self.forgiven):
            self.complaints.append(text)

    @property
    def verdict(self) -> str:
        """The sentence over the tiles."""
        return self.page.inner_text("#verdict")

    def wait_for_verdict(self, text: str) -> None:
        """Waits until it is this one."""
        found = self.page.locator("#verdict", has_text=text)
        try:
            found.wait_for()
        except Exception as error:
            raise AssertionError(f"the tiles did not come to '{text}' but to '{self.verdict}'") from error

    def wait_until(self, condition: str) -> None:
        """Waits until an expression of JavaScript is true; the page's policy forbids Playwright's own way."""
        came = self.page.evaluate(
            f"""() => new Promise((resolve) => {{
              const end = performance.now() + {LIMIT_MS};
              const look = () => {{
                if ({condition}) resolve(true);
                else if (performance.now() > end) resolve(false);
                else setTimeout(look, 20);
              }};
              look();
            }})"""
        )
        assert came, (
            f"it never came to {condition}; the address is {self.page.url}, the verdict {self.verdict}"
        )

    def middle(self, selector: str) -> tuple[float, float]:
        """Where an element is."""
        box = self.page.locator(selector).bounding_box()
        assert box is not None, selector
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Presses at one point, moves to another, and lets go."""
        self.page.mouse.move(*start)
        self.page.mouse.down()
        self.page.mouse.move(*end, steps=8)
        self.page.mouse.up()

    def pull(self, port: str) -> None:
        """Drags a tile off the board."""
        x, y = self.middle(f"[data-port={port}]")
        self.drag((x, y), (2, y))

    def nine_and_back(self) -> None:
        """Makes the 8 a 9, without the left tile of its fourth row, and an 8 again."""
        self.wait_for_verdict("All 16 tiles show 8")
        self.pull("tile-11")
        self.wait_for_verdict("All 15 tiles show 9")
        self.page.locator(".spot[data-place='3,0']").click()
        self.wait_for_verdict("All 16 tiles show 8")


@contextmanager
def new_visit(browser: Browser, size: str = "laptop", scheme: str = "light") -> Iterator[Visit]:
    """A fresh page without a past; it is closed however the block ends, since a server has few places."""
    width, height = SIZES[size]
    context = browser.new_context(
        viewport={"width": width, "height": height},
        color_scheme="dark" if scheme == "dark" else "light",
        has_touch=size == "phone",
    )
    try:
        yield Visit(context.new_page())
    finally:
        context.close()
