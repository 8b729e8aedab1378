"""The tiles coloured by what they think: how sure they are, and each number of their states."""

import re

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from support.browser import Visit
from support.page_server import PageServer

STANDING = "?shape=digits/8&seed=1&speed=0.5&spread=0.1&until=0.43"
# Of each tile its number, its colour, the number on it, and what a screen reader says of it.
SHADES = """() => [...document.querySelectorAll(".tile")].map((one) => [
  one.dataset.port, getComputedStyle(one.querySelector("svg")).backgroundColor,
  one.querySelector(".counter").textContent, one.getAttribute("aria-label"),
])"""
KNOWN = """async () => {
  const { tiles } = await import("./main.js");
  const known = ({ port, margin, state }) => [port, [margin, state.map((one) => one - 128)]];
  return Object.fromEntries(tiles.laid().map(known));
}"""


def opened(visit: Visit, server: PageServer, query: str = "") -> Page:
    visit.page.emulate_media(reduced_motion="reduce")  # colours come at once
    visit.page.goto(server.url + STANDING + query)
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_until("location.search.includes('model=')")
    return visit.page


def test_a_heat_map_shows_how_sure_each_tile_is(visit: Visit, server: PageServer) -> None:
    page = opened(visit, server)
    assert page.locator("#scale").is_hidden()
    page.get_by_label("Colours").select_option(label="How sure")
    assert page.inner_text("#scale").split("\n") == ["How sure", "torn 0", "sure 64 or more"]
    known = page.evaluate(KNOWN)
    seen = page.evaluate(SHADES)
    assert {port: text for port, _, text, _ in seen} == {
        port: "" if margin is None else str(margin) for port, (margin, _) in known.items()
    }
    margins = {margin for margin, _ in known.values()}
    assert len(margins) > 3
    assert len({colour for _, colour, _, _ in seen}) > 3
    for port, _, _, words in seen:
        margin = known[port][0]
        assert f", {'no margin' if margin is None else f'margin {margin}'}" in words
    assert "look=sure" in page.url
    assert Axe().run(page).violations_count == 0


def test_each_number_of_the_states_is_seen_on_the_whole_board(visit: Visit, server: PageServer) -> None:
    page = opened(visit, server, "&look=score-8")
    known = page.evaluate(KNOWN)
    options = page.locator("#look option").all_inner_texts()
    assert len(options) == 2 + len(known["tile-01"][1])
    assert page.locator("#look").input_value() == "score-8"
    at = options.index("Score of 8") - 2
    assert [text for _, _, text, _ in page.evaluate(SHADES)] == [
        str(known[port][1][at]) for port, *_ in page.evaluate(SHADES)
    ]
    page.get_by_label("Colours").select_option(label="Channel 3")
    seen = page.evaluate(SHADES)
    assert [int(text) for _, _, text, _ in seen] == [known[port][1][2] for port, *_ in seen]
    reds = {int(text): int(re.findall(r"\d+", colour)[0]) for _, colour, text, _ in seen}
    blues = {int(text): int(re.findall(r"\d+", colour)[2]) for _, colour, text, _ in seen}
    for value in reds:
        assert (reds[value] > blues[value]) == (value > 2) or abs(value) < 12
    page.wait_for_timeout(600)  # the address is written anew meanwhile, and keeps it
    assert "look=channel-3" in page.url
    page.reload()
    page.get_by_role("button", name="Go on").wait_for()
    visit.wait_until("document.getElementById('look').value === 'channel-3'")


def test_looks_go_by_keyboard_and_without_motion(visit: Visit, server: PageServer) -> None:
    page = opened(visit, server)
    page.keyboard.press("l")
    assert page.locator("#look").input_value() == "sure"
    assert (
        page.locator(".tile svg").first.evaluate("(one) => getComputedStyle(one).transitionDuration") == "0s"
    )
    page.keyboard.press("l")
    assert page.locator("#look").input_value() == "channel-1"
    page.keyboard.press("Shift+L")
    page.keyboard.press("Shift+L")
    assert page.locator("#look").input_value() == ""
    assert "look=" not in page.url
    assert page.locator(".tile.shaded").count() == 0


def test_a_tile_without_power_tells_nothing(visit: Visit, server: PageServer) -> None:
    page = opened(visit, server, "&look=sure&fault=off@3")
    seen = {port: (text, words) for port, _, text, words in page.evaluate(SHADES)}
    assert seen["tile-03"][0] == ""
    assert page.locator("[data-port=tile-03].shaded").count() == 0
    assert page.locator(".tile.shaded").count() > 10


def test_marks_and_numbers_can_be_read_on_bright_tiles(visit: Visit, server: PageServer) -> None:
    page = opened(visit, server, "&look=sure")
    for port, button in (("tile-03", "Freeze"), ("tile-05", "Turn by 90°")):
        page.locator(f"[data-port={port}]").click()
        page.get_by_role("button", name=button).click()
    for _ in range(12):  # it tells that it is frozen now and then
        page.get_by_role("button", name="One update").click()
    page.locator("[data-port=tile-05][data-state=turned]").wait_for()
    page.locator("[data-port=tile-03][data-state=frozen]").wait_for()
    for number in (3, 5):
        tile = page.locator(f"[data-port=tile-0{number}].shaded")
        read = tile.evaluate(
            """(one) => {
              const colourOf = (part) => getComputedStyle(one.querySelector(part));
              return [colourOf(".state-mark").color, colourOf(".counter").fill, colourOf(".counter").display];
            }"""
        )
        assert read[0] == read[1]
        assert read[2] != "none"
    assert Axe().run(page).violations_count == 0
