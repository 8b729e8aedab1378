"""Real tiles on the page, here those of `tilenca emulate --serve`: watched, set, lost and found again."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

from support.browser import Visit
from support.heard_fleet import link
from support.page_server import TILENCA, page_server
from support.tile_port import STATE, Tile
from tilenca.protocol.sentences import TileSentence, format_sentence


@contextmanager
def served(folder: Path, firmware: Path, *words: str) -> Iterator[None]:
    """Emulated tiles in the shape of a 1, each behind a port in `folder`."""
    command = [
        str(TILENCA),
        "emulate",
        "--serve",
        str(folder),
        "--shape",
        "1",
        "--elf",
        str(firmware),
        *words,
    ]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait(60)


def test_served_tiles_are_watched_found_and_set(visit: Visit, firmware: Path, tmp_path: Path) -> None:
    page, record = visit.page, tmp_path / "record.jsonl"
    ports = ["--port", f"{tmp_path}/tiles/*", "--record", str(record)]
    with served(tmp_path / "tiles", firmware), page_server(None, ports) as server:
        page.goto(server.url)
        visit.wait_for_verdict("All 5 tiles show 1")
        labels = [one.get_attribute("aria-label") or "" for one in page.locator(".tile").all()]
        assert sorted(labels)[1].startswith("Tile 2, row 2, column 1, shows 1, linked north, south")
        for name in ("Start over", "Surprise me", "Hand", "Draw", "Pause", "Lost bytes"):
            assert page.get_by_role("button", name=name).count() == 0, f"{name} is nothing for real tiles"
        assert page.locator(".spot").count() == 0
        assert page.locator("#timeline").is_hidden()
        page.locator(".fleet-table tbody tr", has_text="tile-05").locator("td", has_text="well").wait_for()
        page.get_by_role("button", name="Tile 3", exact=True).click()
        inspector = page.locator("#inspector")
        inspector.locator(".guess", has_text="It shows 1").wait_for()
        assert inspector.get_by_role("button", name="Pull out").count() == 0
        inspector.get_by_role("button", name="Freeze").click()
        page.wait_for_selector(".tile[data-state=frozen]")
        inspector.get_by_role("button", name="Thaw").click()
        page.wait_for_selector(".tile[data-state=frozen]", state="detached")
        inspector.get_by_role("button", name="Blink").click()
        page.locator(".log li", has_text="BLINK").wait_for()
        assert Axe().run(page).violations_count == 0
        inspector.get_by_role("button", name="Close").click()
        page.locator("#fleet").get_by_label("Period (ms)").fill("50")
        page.get_by_role("button", name="Set the period of all tiles").click()
        visit.wait_until("location.search === '' && document.querySelectorAll('.tile').length === 5")
        page.get_by_role("button", name="Tile 5", exact=True).click()
        inspector.locator("dd", has_text="50 ms").wait_for()
        page.keyboard.press("s")  # no surprise
        page.locator("#notice", has_text="These are real tiles").wait_for()
        page.goto("about:blank")  # else it looks for the server that ends
    assert record.read_text().count('"raw": "$TILE') > 5


@pytest.fixture
def tiles() -> Iterator[tuple[Tile, Tile]]:
    with Tile(1) as first, Tile(2) as second:
        yield first, second


def test_a_bad_link_and_a_port_that_is_pulled_are_told(
    visit: Visit, tiles: tuple[Tile, Tile], tmp_path: Path
) -> None:
    first, second = tiles
    cable = tmp_path / "tile-02"
    cable.symlink_to(second.port)
    with page_server(None, ["--port", first.port, "--port", str(cable)]) as server:
        visit.page.goto(server.url)
        visit.page.locator(".tile").nth(1).wait_for()
        first.write(format_sentence(TileSentence(1, 100, 7, "4", 4, 30, "-E--", STATE)))
        second.write(format_sentence(TileSentence(2, 100, 7, "4", 4, 30, "---W", STATE)))
        for second_of in (1, 2):
            first.write(format_sentence(link(1, "E", 2, 1000 * second_of, 10 * second_of, 10 * second_of)))
            second.write(format_sentence(link(2, "W", 1, 1000 * second_of, 10 * second_of, 0)))
        visit.wait_for_verdict("All 2 tiles show 4")
        row = visit.page.locator(".fleet-table tbody tr").first
        row.locator("td", has_text="50 %").wait_for()
        row.locator("td", has_text="E failing").wait_for()
        visit.page.locator(".log .bad", has_text="link E is failing: 50% of the frames get lost").wait_for()
        second.unplug()
        cable.unlink()
        visit.wait_for_verdict("not heard")
        visit.page.locator(".tile[data-state=away]").wait_for()
        visit.page.locator("td", has_text="waiting for it").wait_for()
        with Tile(2) as again:
            cable.symlink_to(again.port)
            visit.page.locator(".tile[data-state=away]").wait_for(state="detached")
            again.write(format_sentence(TileSentence(2, 100, 7, "4", 4, 30, "---W", STATE)))
            visit.wait_for_verdict("All 2 tiles show 4")
            visit.page.goto("about:blank")  # else it looks for the server that ends
