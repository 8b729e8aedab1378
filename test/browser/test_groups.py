"""Whole clusters in the hand: they move together and run on, and a stroke breaks them apart."""

import pytest
from playwright.sync_api import Page

from support.browser import Visit
from support.page_server import PageServer

PLACES = """async () => {
  const { tiles } = await import("./main.js");
  return Object.fromEntries(tiles.laid().map(({ port, place }) => [port, place.join()]));
}"""


def places(page: Page) -> dict[str, str]:
    found: dict[str, str] = page.evaluate(PLACES)
    return found


@pytest.fixture
def two_bars(visit: Visit, server: PageServer) -> Visit:
    """Two rows of three tiles, one empty row between them, which have done some updates."""
    visit.page.add_init_script("""
      window.hellos = [];
      window.WebSocket = class extends WebSocket {
        constructor(url) {
          super(url);
          this.addEventListener("message", ({ data }) => {
            const started = JSON.parse(data).events.filter(({ raw }) => raw?.startsWith("$HELLO"));
            hellos.push(...started.map(({ port }) => port));
          });
        }
      };""")
    visit.page.goto(f"{server.url}?draw=111-000-111&speed=0.5&spread=0.05&seed=3")
    visit.wait_for_verdict("All 6 tiles show")
    return visit


def wait_for_place(visit: Visit, port: str, row: int, col: int) -> None:
    words = f"row {row + 1}, column {col + 1},"
    visit.page.locator(f"[data-port={port}][aria-label*='{words}']").wait_for()


def test_a_cluster_moves_together_and_runs_on(two_bars: Visit) -> None:
    page = two_bars.page
    page.keyboard.press("g")
    page.evaluate("hellos.length = 0")
    start = two_bars.middle("[data-port=tile-02]")
    end = two_bars.middle(".spot[data-place='1,1']")
    two_bars.drag(start, end)
    wait_for_place(two_bars, "tile-02", 1, 1)
    assert places(page) == {
        "tile-01": "1,0", "tile-02": "1,1", "tile-03": "1,2",
        "tile-04": "2,0", "tile-05": "2,1", "tile-06": "2,2",
    }  # fmt: skip
    two_bars.wait_for_verdict("All 6 tiles show")
    page.wait_for_selector("[data-port=tile-02] .lamp:nth-of-type(3).on", state="attached")
    assert page.evaluate("hellos") == []  # nobody has started anew
    two_bars.wait_until("location.search.includes('draw=111-111')")


def test_a_hand_with_shift_takes_the_cluster_and_off_the_board_it_goes(two_bars: Visit) -> None:
    page = two_bars.page
    page.keyboard.down("Shift")
    x, y = two_bars.middle("[data-port=tile-05]")
    two_bars.drag((x, y), (2, y))
    page.keyboard.up("Shift")
    two_bars.wait_for_verdict("All 3 tiles show")
    assert set(places(page)) == {"tile-01", "tile-02", "tile-03"}


def test_where_others_lie_a_cluster_does_not_go(two_bars: Visit) -> None:
    page = two_bars.page
    before = places(page)
    page.keyboard.press("g")
    page.mouse.move(*two_bars.middle("[data-port=tile-01]"))
    page.mouse.down()
    page.mouse.move(*two_bars.middle(".spot[data-place='1,0']"), steps=4)
    page.locator("#box", has_text="Drop them here to take them out").wait_for()
    assert page.locator(".spot.aim").count() == 3
    page.mouse.move(*two_bars.middle("[data-port=tile-05]"), steps=4)
    page.locator("#box", has_text="No room there").wait_for()
    page.mouse.up()
    page.locator("#box").wait_for(state="hidden")
    assert places(page) == before
    assert page.locator("#notice").is_hidden()


def test_a_cluster_without_room_stays_and_the_page_says_so(two_bars: Visit) -> None:
    page = two_bars.page
    before = places(page)
    page.locator("[data-port=tile-04]").focus()
    page.keyboard.press("Shift+ArrowRight")
    two_bars.wait_until("location.search.includes('fault=cut@4E')")
    page.keyboard.press("Control+ArrowRight")
    page.locator("#notice", has_text="There is no room there").wait_for()
    assert places(page) == before


def test_a_stroke_across_empty_space_breaks_a_cluster_apart(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?draw=1111-1111&speed=0.5&spread=0.05&seed=3")
    visit.wait_for_verdict("All 8 tiles show")
    page.keyboard.press("g")
    (left, top), (right, _) = visit.middle("[data-port=tile-03]"), visit.middle("[data-port=tile-04]")
    x, (_, bottom) = (left + right) / 2, visit.middle("[data-port=tile-07]")
    visit.drag((x, top - 90), (x, bottom + 90))
    wait_for_place(visit, "tile-04", 0, 4)
    wait_for_place(visit, "tile-08", 1, 4)
    assert places(page)["tile-03"] == "0,2"
    visit.drag((x, top - 90), (x, top - 10))  # crosses nothing
    page.wait_for_timeout(300)
    assert places(page)["tile-04"] == "0,4"


def test_clusters_go_by_keyboard_and_into_the_link(two_bars: Visit) -> None:
    page = two_bars.page
    page.locator("[data-port=tile-04]").focus()
    page.keyboard.press("Control+ArrowDown")
    wait_for_place(two_bars, "tile-06", 3, 2)
    page.keyboard.press("Control+ArrowUp")
    wait_for_place(two_bars, "tile-06", 2, 2)
    assert page.evaluate("document.activeElement.dataset.port") == "tile-04"
    page.keyboard.press("Shift+ArrowRight")  # the cable to the next one is cut: they part
    two_bars.wait_until("location.search.includes('fault=cut@4E')")
    page.keyboard.press("Control+ArrowLeft")
    wait_for_place(two_bars, "tile-04", 2, -1)
    assert places(page)["tile-05"] == "2,1"
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Go on").wait_for()
    page.get_by_role("button", name="Share").click()
    page.get_by_label("How it came about").check()
    link = page.input_value("#share-link")
    assert ",shift,4-5-6,1,0&" in link
    assert ",shift,4,0,-1" in link
    before = places(page)
    page.goto(link)
    page.get_by_role("button", name="Go on").wait_for()
    two_bars.wait_until("location.search.includes('model=')")
    assert places(page) == before
