"""Single instructions of a tile on the page, with a server and without one."""

from itertools import pairwise

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from support.browser import Visit
from support.page_server import PageServer

STANDING = "?shape=digits/4&seed=2&speed=0.5&spread=0.05&until=0.3"

CYCLES = 320_000  # of one update period


def clocked(page: Page) -> int:
    """The cycles that the chip has counted."""
    text = page.locator(".program dd").nth(1).inner_text()
    return int(text.split(",")[0])


@pytest.fixture(params=["server", "bundle"])
def address(request: pytest.FixtureRequest, server: PageServer) -> str:
    if request.param == "server":
        return server.url
    url: str = request.getfixturevalue("site")
    return url


def test_one_instruction_after_the_other(visit: Visit, address: str) -> None:
    page = visit.page
    page.goto(address + STANDING)
    page.get_by_role("button", name="Go on").wait_for()
    page.locator("[data-port=tile-05]").click()
    page.locator(".program summary").click()
    page.locator(".program [role=status]", has_text="Next: 0x").wait_for()
    before = [clocked(page)]
    page.get_by_role("button", name="One instruction").click()
    visit.wait_until("document.querySelector('.program .facts').textContent.includes(' more')")
    before.append(clocked(page))
    page.locator("h1").click()
    for _ in range(5):
        page.keyboard.press("i")
        visit.wait_until(f"!document.querySelector('.program .facts').textContent.includes('{before[-1]}')")
        before.append(clocked(page))
    took = [after - one for one, after in pairwise(before)]
    assert min(took) > 0
    # It may have slept when it was looked at, and sleep again; an instruction has 5 cycles at most, and an
    # interrupt 5 more.
    assert sum(one <= 10 for one in took) >= 4, took
    second = before[-1]
    page.get_by_role("button", name="100 instructions").click()
    visit.wait_until(f"!document.querySelector('.program .facts').textContent.includes('{second}')")
    assert clocked(page) >= second + 100
    assert page.locator(".registers li").count() == 32
    assert page.locator(".registers .changed").count() > 0
    assert Axe().run(page).violations_count == 0  # with the list of variables, which scrolls
    page.get_by_label("Look for a variable").focus()
    page.keyboard.type("sending")
    names = page.locator(".variables dt").all_inner_texts()
    assert "tilenca_sending" in names
    assert all("sending" in name for name in names)
    assert page.get_by_label("Look for a variable").input_value() == "sending"
    assert page.locator(".tile").count() == 10  # no letter of it has worked the page
    assert Axe().run(page).violations_count == 0
    page.get_by_role("button", name="Go on").click()
    page.locator(".program", has_text="Pause the run to look into the program").wait_for()
    visit.wait_for_verdict("All 10 tiles show 4")


def test_a_tile_that_was_looked_into_before_is_told_anew(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(server.url + STANDING)
    page.get_by_role("button", name="Go on").wait_for()
    page.locator("[data-port=tile-05]").click()
    page.locator(".program summary").press("Enter")
    page.locator(".program [role=status]", has_text="Next: 0x").wait_for()
    before = clocked(page)
    page.locator("[data-port=tile-06]").click()
    page.locator("h1").click()
    page.keyboard.press(".")
    visit.wait_until("document.getElementById('clock').textContent === '0.32 s'")
    page.locator("[data-port=tile-05]").click()
    cycles = "parseInt(document.querySelectorAll('.program dd')[1].textContent)"
    visit.wait_until(f"{cycles} > {before + CYCLES - 1000}")
    assert clocked(page) < before + CYCLES + 1000


def test_names_of_the_compiler_are_read_as_they_were_written(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url)
    symbols = {
        "loop": "loop",
        "tilenca_blocks": "tilenca_blocks",
        "_ZN7tilenca4Tile4tickEmh": "tilenca::Tile::tick",
        "_ZN12_GLOBAL__N_14tileE.lto_priv.64": "tile",
        "_ZN7tilenca5boardL10kSideUsartE.lto_priv.72": "tilenca::board::kSideUsart",
        "_ZZN12_GLOBAL__N_14showEmE5shown": "show()::shown",
        "_ZL4idle": "idle",
        "__vector_20": "__vector_20",
    }
    read = visit.page.evaluate(
        """async (symbols) => {
          const { plainName } = await import("./stream/chip.js");
          return symbols.map(plainName);
        }""",
        list(symbols),
    )
    assert read == list(symbols.values())


def test_a_tile_is_turned_and_its_clock_is_skewed_by_hand(visit: Visit, address: str) -> None:
    page = visit.page
    page.goto(f"{address}?shape=digits/1&speed=0.5&spread=0.05")
    visit.wait_for_verdict("All 5 tiles show 1")
    page.locator("[data-port=tile-03]").click()
    page.get_by_role("button", name="Turn by 90°").click()
    page.locator("[data-port=tile-03][data-state=turned][aria-label*='turned by 90 degrees']").wait_for()
    visit.wait_until("location.search.includes('fault=turn@3')")
    lamp = "[data-port=tile-02] .lamp:nth-of-type(3)"
    page.wait_for_selector(f"{lamp}:not(.on)", state="attached")  # it hears tile 3 no more
    page.get_by_role("button", name="Turn back").click()
    page.wait_for_selector(f"{lamp}.on", state="attached")
    page.get_by_label("Clock too fast").fill("-80000")
    page.get_by_role("button", name="Set the clock too fast").click()
    page.locator("[data-port=tile-03][aria-label*='clock 80000 ppm slow']").wait_for()
    page.wait_for_selector(f"{lamp}:not(.on)", state="attached")
    visit.wait_until("location.search.includes('fault=skew=-80000@3')")
    assert Axe().run(page).violations_count == 0
    page.reload()  # the address says so
    page.locator("[data-port=tile-03][aria-label*='clock 80000 ppm slow']").wait_for()
