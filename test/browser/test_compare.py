"""Two runs side by side: what differs is in the address, and both obey at once."""

import re

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, FrameLocator

from support.browser import SIZES, Visit, new_visit
from support.page_server import PageServer

SAME_CLOCKS = """() => {
  const clock = (frame) => frame.document.getElementById("clock").textContent;
  return clock(frames[0]) === clock(frames[1]);
}"""


def runs(visit: Visit) -> tuple[FrameLocator, FrameLocator]:
    left, right = (visit.page.frame_locator(f"iframe[title='The {name} run']") for name in ("left", "right"))
    return left, right


def agreed(frame: FrameLocator, verdict: str) -> None:
    frame.locator("#verdict", has_text=verdict).wait_for()


def test_one_seed_with_and_without_losses(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?shape=digits/4&speed=0.5&spread=0.1&seed=7")
    visit.wait_for_verdict("All 10 tiles show 4")
    page.get_by_role("button", name="Share").click()
    page.get_by_role("button", name="Compare").click()
    left, right = runs(visit)
    for frame in (left, right):
        agreed(frame, "All 10 tiles show 4")
    page.locator("#difference", has_text="Both runs are alike").wait_for()
    side = page.get_by_role("region", name="The right run")
    assert side.get_by_label("Seed").input_value() == "7"
    side.get_by_label("Drawing").select_option("digits/7")
    agreed(right, "All 9 tiles show 7")
    side.get_by_label("Lost bytes (%)").fill("2")
    side.get_by_label("Seed").fill("8")
    page.keyboard.press("Tab")
    visit.wait_until("decodeURIComponent(location.search).includes('seed=8')")
    assert "fault" in page.url
    agreed(right, "All 9 tiles show 7")
    assert right.locator("#noise").input_value() == "2"
    page.locator("#difference", has_text="drawing (digits/4, digits/7), lost bytes (none, 2").wait_for()
    page.locator("#result", has_text=re.compile(r"Left agreed on 4 at .*, right agreed on 7 at")).wait_for()
    page.get_by_role("button", name="Pause").click()
    page.get_by_label("Time of the run").fill("300")
    for frame in (left, right):
        frame.locator("#clock", has_text="0.30 s").wait_for()
    page.get_by_role("button", name="One update").click()
    for frame in (left, right):
        frame.locator("#clock", has_text="0.32 s").wait_for()
    left.locator("[data-port=tile-01]").focus()
    page.keyboard.press("p")  # in one of them is in both
    page.get_by_role("button", name="Pause").wait_for()
    page.get_by_label("Speed of both").fill("5")
    visit.wait_until("decodeURIComponent(location.search).split('speed=1&').length === 3")
    page.get_by_role("button", name="Start both over").click()
    page.reload()
    agreed(right, "All 9 tiles show 7")
    agreed(left, "All 10 tiles show 4")
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Go on").wait_for()
    visit.wait_until(f"({SAME_CLOCKS})()")
    left.locator("[data-port=tile-01]").focus()
    page.keyboard.press("Delete")
    page.locator("#difference", has_text="drawing (your own, digits/7)").wait_for()


@pytest.mark.parametrize("size", list(SIZES))
def test_it_fits_and_can_be_read(browser: Browser, server: PageServer, size: str) -> None:
    with new_visit(browser, size) as visit:
        visit.page.goto(f"{server.url}compare.html")
        left, right = runs(visit)
        for frame in (left, right):
            frame.locator("[data-port=tile-01]").wait_for()
            assert frame.locator("#drawings").is_hidden()
        width = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        assert visit.page.evaluate(width) == 0
        found = Axe().run(visit.page)
        assert found.violations_count == 0, found.generate_report()
        assert visit.complaints == []
