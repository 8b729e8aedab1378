"""The benchmark of the page measures what a visitor has: paint, first tile, clicks, frames."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from bench import page as bench
from support.page_server import page_server


@pytest.fixture(scope="module")
def url(firmware: Path) -> Iterator[str]:
    with page_server(firmware) as server:
        yield server.url


def test_a_visit_has_its_first_paint_then_its_first_tile(browser: Browser, url: str) -> None:
    paint_ms, tile_ms, requests = bench.load(browser, url)
    assert paint_ms > 0
    assert tile_ms > 0
    assert 3 <= requests <= 8


def test_each_click_is_seen_once(browser: Browser, url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "CLICKS", 3)
    monkeypatch.setattr(bench, "WARM_UP_MS", 200)
    seen = bench.click(browser, url)
    assert len(seen) == 3
    assert min(seen) > 0


def test_frames_are_counted_with_the_long_ones(
    browser: Browser, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "WARM_UP_MS", 200)
    monkeypatch.setattr(bench, "WATCHED_MS", 1000)
    frames = bench.watch(browser, url, bench.TWENTY, 0.1)
    assert frames.per_s > 1
    assert frames.long == 0 or frames.longest_ms > bench.LONG_MS
    assert frames.speed.startswith("10")
