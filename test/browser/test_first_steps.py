"""What somebody does who was told nothing: pull a tile out, draw a shape, share it, replay a file."""

import json

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from support.browser import Visit, new_visit
from support.page_server import PageServer

MOST_REQUESTS = 8  # document, four style sheets, program, icon, stream
DROP = """([name, text]) => {
  const files = new DataTransfer();
  files.items.add(new File([text], name));
  const drop = new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true });
  document.getElementById("board").dispatchEvent(drop);
  return drop.defaultPrevented;
}"""


def test_few_requests_come_before_the_first_tile(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?spread=0")
    visit.page.locator(".tile").first.wait_for()
    assert len(visit.requests) <= MOST_REQUESTS, visit.requests


def test_each_tool_says_what_it_does_until_it_was_used(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?speed=1&spread=0.1")
    hint = visit.page.locator("#hint")
    hint.get_by_text("Drag tile 11 out of this frame").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    assert Axe().run(visit.page).violations_count == 0
    visit.pull("tile-11")
    hint.wait_for(state="hidden")
    visit.wait_for_verdict("All 15 tiles show 9")
    visit.page.get_by_role("button", name="Knife").click()
    hint.get_by_text("Drag across cables; click one to mend").wait_for()
    visit.page.locator("[data-port=tile-12]").focus()
    visit.page.keyboard.press("Shift+ArrowUp")
    hint.wait_for(state="hidden")
    visit.page.get_by_role("button", name="Hand").click()
    hint.wait_for(state="hidden")


@pytest.mark.parametrize("size", ["phone", "laptop"])
def test_a_shape_of_ones_own_is_drawn_on_an_empty_board(
    browser: Browser, server: PageServer, size: str
) -> None:
    with new_visit(browser, size) as visit:
        page = visit.page
        page.goto(f"{server.url}?speed=1&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        page.get_by_role("button", name="Draw your own").click()
        visit.wait_for_verdict("The board is empty")
        assert page.get_by_role("button", name="Draw", exact=True).get_attribute("aria-pressed") == "true"
        page.locator("#board").scroll_into_view_if_needed()
        corners = [visit.middle(f".spot[data-place='{row},{col}']") for row, col in ((0, 0), (0, 3), (4, 3))]
        visit.drag(corners[0], corners[1])
        visit.wait_until("document.querySelectorAll('.tile').length === 4")
        assert visit.middle(".spot[data-place='4,3']") == corners[2]  # what was in reach has stayed there
        visit.drag(visit.middle(".spot[data-place='1,3']"), corners[2])
        visit.wait_for_verdict("All 8 tiles show 7")
        visit.wait_until("location.search.includes('draw=1111-0001-0001-0001-0001')")
        assert visit.complaints == []


@pytest.mark.parametrize(
    ("query", "said", "verdict"),
    [
        ("deed=0.1,move,1,NaN,3&shape=digits/4", "row must be a whole number", "All 10 tiles show 4"),
        ("fault=loss=2&shape=digits/4", "loss is 0 to 1", "All 10 tiles show 4"),
        (f"draw={'-'.join(['1' * 60] * 60)}", "a command has at most", "All 16 tiles show 8"),
        (f"draw={'-'.join(['1' * 20] * 20)}", "at most", "All 16 tiles show 8"),
    ],
)
def test_an_address_that_cannot_be_says_so_and_something_runs(
    visit: Visit, server: PageServer, query: str, said: str, verdict: str
) -> None:
    visit.page.goto(f"{server.url}?{query}&speed=1&spread=0.1")
    visit.page.locator("#notice", has_text=said).wait_for()
    visit.wait_until("location.search.includes('speed=0.1') || location.search.includes('digits/4')")
    visit.page.get_by_label("Speed").fill("5")
    visit.wait_for_verdict(verdict)


def test_a_speed_that_cannot_be_is_the_usual_one(visit: Visit, server: PageServer) -> None:
    for speed in ("1e-9", "-1", "Infinity", "x", ""):
        visit.page.goto(f"{server.url}?shape=digits/1&spread=0&speed={speed}")
        visit.page.locator(".tile").first.wait_for()
        visit.wait_until("location.search.includes('speed=0.1&')")


def test_a_recording_is_replayed_where_it_is_dropped(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?speed=1&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    assert page.evaluate(DROP, ["holiday.txt", "Dear diary"])
    page.locator("#notice", has_text="holiday.txt: line 1 is no event").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    lines = [
        {"time": 0, "stream": 1, "source": "emulated", "looks": [], "drawings": []},
        {"time": 0, "run": {"seed": 1, "shape": "-", "tiles": 1}},
        {"time": 0, "port": "tile-01", "place": [0, 0], "tile": 1},
        {"time": 0.5, "port": "tile-01", "open": True},
    ]
    assert page.evaluate(DROP, ["run.jsonl", "\n".join(map(json.dumps, lines)) + "\n"])
    page.locator("#notice", has_text="A recording: go to any time of it").wait_for()
    visit.wait_until("document.querySelectorAll('.tile').length === 1")


NARROW = """() => {
  const box = (one) => one.getBoundingClientRect();
  const tiles = [...document.querySelectorAll(".tile svg")].map(box);
  const { scrollWidth, clientWidth } = document.documentElement;
  return {
    wide: scrollWidth - clientWidth,
    covered: box(document.getElementById("hint")).bottom > Math.min(...tiles.map(({ top }) => top)),
  };
}"""


@pytest.mark.parametrize(("width", "height"), [(320, 568), (844, 390), (1280, 500)])
def test_a_small_window_scrolls_one_way_and_no_hint_lies_on_a_tile(
    visit: Visit, server: PageServer, width: int, height: int
) -> None:
    visit.page.set_viewport_size({"width": width, "height": height})
    visit.page.goto(f"{server.url}?speed=1&spread=0.1")
    visit.page.locator("#hint").wait_for()
    visit.page.locator(".tile").first.wait_for()
    assert visit.page.evaluate(NARROW) == {"wide": 0, "covered": False}
