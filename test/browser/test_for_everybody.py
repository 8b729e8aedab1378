"""The page by keyboard, by screen reader, without motion, at three sizes, in light and dark."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from support.browser import SIZES, Visit, new_visit
from support.page_server import PageServer

# What of a page can be seen, and how much of it is cut off or lies over its neighbours.
LOOK = """() => {
  const seen = (one) => one.offsetParent !== null && !one.closest(".visually-hidden, .skip");
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const cut = [...document.querySelectorAll("button, h1, h2, h3, p, output, dd, th, td")].filter(seen)
    .filter((one) => !one.closest(".board") && one.clientWidth > 0 && one.scrollWidth > one.clientWidth + 1)
    .map((one) => one.textContent);
  const boxes = [...document.querySelectorAll(".top > *, .stage, .group > *, .agreement > *, .side")]
    .filter(seen)
    .map((one) => [one, one.getBoundingClientRect()]);
  const over = [];
  boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
    const right = Math.min(p.right, q.right) - Math.max(p.left, q.left);
    const down = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    if (right > 1 && down > 1 && !a.contains(b)) over.push(`${a.outerHTML} and ${b.outerHTML}`);
  }));
  const board = document.querySelector(".board").getBoundingClientRect();
  const outside = [...document.querySelectorAll(".tile")].filter((one) => {
    const box = one.getBoundingClientRect();
    return box.left < board.left || box.right > board.right || box.top < board.top
      || box.bottom > board.bottom;
  }).length;
  const tall = document.querySelector(".verdict").offsetHeight > 50;
  const scores = document.querySelector(".scores:not([hidden] *)")?.getBoundingClientRect();
  const unseen = scores !== undefined && !(scores.top >= 0 && scores.bottom <= innerHeight);
  return { unseen, wide, cut, over, outside, tall, size: document.querySelector(".tile").offsetWidth };
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", list(SIZES))
def test_nothing_is_cut_off_or_lies_over_something_else(
    browser: Browser, server: PageServer, size: str, scheme: str
) -> None:
    with new_visit(browser, size, scheme) as visit:
        visit.page.goto(f"{server.url}?speed=1&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        for selected in (False, True):
            if selected:
                tile = visit.page.locator(
                    "[data-port=tile-14]"
                )  # on a phone its details come up under the finger
                tile.tap() if size == "phone" else tile.click()
                visit.page.locator("#inspector h2", has_text="Tile 14").wait_for()
            seen = visit.page.evaluate(LOOK)
            assert {key: seen[key] for key in ("unseen", "wide", "cut", "over", "outside", "tall")} == {
                "unseen": False, "wide": 0, "cut": [], "over": [], "outside": 0, "tall": False,
            }  # fmt: skip
            assert seen["size"] >= 48  # a finger can meet it
            found = Axe().run(visit.page)
            assert found.violations_count == 0, found.generate_report()
        assert visit.complaints == []


def focused(visit: Visit) -> str:
    return str(visit.page.evaluate("document.activeElement.getAttribute('aria-label')"))


def test_all_goes_by_keyboard(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?speed=0.5&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    press = visit.page.keyboard.press
    press("Tab")
    assert visit.page.evaluate("document.activeElement.textContent") == "Skip to the tiles"
    press("Enter")
    press("Tab")
    assert focused(visit).startswith("Tile 1,")
    for key in ("ArrowDown", "ArrowDown", "ArrowDown"):
        press(key)
    assert focused(visit).startswith("Tile 11,")
    press("Delete")
    visit.wait_for_verdict("All 15 tiles show 9")
    assert focused(visit) == "Empty place, row 4, column 1: put a tile"
    press("Enter")
    visit.wait_for_verdict("All 16 tiles show 8")
    assert focused(visit).startswith("Tile 11,")
    press("Shift+ArrowUp")
    visit.wait_until("location.search.includes('fault=cut@7S')")
    press("Shift+ArrowUp")
    visit.wait_until("!location.search.includes('fault')")
    press("Enter")
    visit.page.locator("#inspector h2", has_text="Tile 11").wait_for()
    press("Escape")
    visit.page.locator("#inspector").wait_for(state="hidden")
    press("k")
    assert visit.page.get_by_role("button", name="Knife").get_attribute("aria-pressed") == "true"


def test_tab_comes_to_the_board_once_and_to_each_control(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?speed=1&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    names: list[str] = []
    name = ""
    while name not in names[:1]:  # once around
        names += [name] if name else []
        visit.page.keyboard.press("Tab")
        name = visit.page.evaluate(
            "document.activeElement.getAttribute('aria-label') || document.activeElement.textContent"
        )
    assert [name for name in names if name.startswith(("Tile ", "Empty place"))] == [
        "Tile 1, row 1, column 1, shows 8, linked east, south"
    ]
    assert {"Start over", "Surprise me", "Hand", "Draw", "Knife", "Pause", "Speed", "Lost bytes"} <= set(
        names
    )
    assert "0, digits/0" in names


def test_what_they_agree_on_is_said_aloud_once(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?speed=1&spread=0.1")
    visit.page.locator("#announce", has_text="All 16 tiles show 8").wait_for(state="attached")
    assert visit.page.locator("#announce").get_attribute("aria-live") == "polite"


def test_who_wants_no_motion_has_none(browser: Browser, server: PageServer) -> None:
    with new_visit(browser) as visit:
        visit.page.emulate_media(reduced_motion="reduce")
        visit.page.goto(f"{server.url}?speed=0.2&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        transition = visit.page.locator(".tile").first.evaluate(
            "(one) => getComputedStyle(one).transitionDuration"
        )
        assert transition == "0s"
