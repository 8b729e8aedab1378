"""The chart and the slider below it: one scale, colours that are seen, and what is in view on a phone."""

import pytest
from playwright.sync_api import Browser

from support.browser import Visit, new_visit
from support.page_server import PageServer

STANDING = "?shape=digits/0&seed=1&speed=0.5&spread=0.1&until=1.2"
# Contrasts of the colours of all classes, also of those that are dimmed once and twice, on both grounds.
CONTRASTS = """async () => {
  const { PAPER_COLOURS, seenColour } = await import("./stream/led.js");
  const style = getComputedStyle(document.documentElement);
  const light = (colour) => colour.map((part) => part / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
    .reduce((sum, part, index) => sum + part * [0.2126, 0.7152, 0.0722][index], 0.05);
  const all = [];
  for (const name of ["--ground", "--housing"]) {
    const text = style.getPropertyValue(name).trim();
    const ground = [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
    for (const colour of PAPER_COLOURS) for (const times of [1, 3, 9]) {
      const seen = seenColour(colour.map((part) => Math.ceil(part / times)), ground).match(/[0-9]+/g);
      all.push(light(seen.map(Number)) / light(ground));
    }
  }
  return all;
}"""
# The colours of the chart a little below its top, left and in the middle.
PIXELS = """() => {
  const canvas = document.getElementById("agreement");
  const pen = canvas.getContext("2d");
  const at = (share) => [...pen.getImageData(Math.round(share * canvas.width), 9, 1, 1).data].slice(0, 3);
  return [at(0.002), at(0.95)];
}"""


def opened(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url + STANDING)
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_for_verdict("All 14 tiles show 0")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_each_class_is_seen_on_the_ground(browser: Browser, server: PageServer, scheme: str) -> None:
    with new_visit(browser, scheme=scheme) as visit:
        opened(visit, server)
        assert min(visit.page.evaluate(CONTRASTS)) >= 3
        visit.wait_until(f"({PIXELS})()[1][0] > 200")  # all show 0
        assert max(visit.page.evaluate(PIXELS)[0]) < 60


def test_a_click_on_the_chart_goes_to_that_time(visit: Visit, server: PageServer) -> None:
    opened(visit, server)
    page = visit.page
    box = page.locator("canvas#agreement").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 8 + (box["width"] - 16) / 4, box["y"] + 20)
    visit.wait_until("document.getElementById('clock').textContent === '0.30 s'")
    slider = page.locator("#moment").bounding_box()
    assert slider is not None
    assert (slider["x"], slider["width"]) == (box["x"], box["width"])
    low, high, value = (
        float(page.locator("#moment").evaluate(f"(one) => one.{name}")) for name in ("min", "max", "value")
    )
    assert (low, high) == (0, 1200)
    assert abs(value - 300) <= 5  # which the clock rounds to 0.30 s


def test_a_long_run_has_its_end_in_view_and_all_of_it_below(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?draw=1&speed=0&spread=0&until=12")
    page.get_by_role("button", name="Go on").wait_for()
    visit.wait_until("parseFloat(document.getElementById('clock').textContent) > 11.9")
    view = page.get_by_label("Time in view")
    assert view.input_value() == "10"
    box = page.locator("canvas#agreement").bounding_box()
    assert box is not None

    def click(share: float, below_top: float) -> None:
        page.mouse.click(box["x"] + 8 + (box["width"] - 16) * share, box["y"] + below_top)

    def wait_for_clock(seconds: float) -> None:
        visit.wait_until(
            f"Math.abs(parseFloat(document.getElementById('clock').textContent) - {seconds}) < 0.03"
        )

    click(0.25, 20)
    wait_for_clock(2 + 0.25 * 10)
    click(0.25, box["height"] - 3)
    wait_for_clock(0.25 * 12)
    view.select_option("Whole run")
    click(0.5, 20)
    wait_for_clock(0.5 * 12)


def test_changes_of_mind_are_those_until_now(visit: Visit, server: PageServer) -> None:
    opened(visit, server)
    told = "document.getElementById('agreement-text').textContent"
    count = """async () => {
      const { tiles } = await import("./main.js");
      const minds = tiles.history.changes.filter(({ from, to }) => from !== "" && to !== "");
      return [0.3, 9].map((end) => minds.filter(({ time }) => time <= end).length);
    }"""
    early, late = visit.page.evaluate(count)
    assert 0 < early < late
    visit.wait_until(f"{told}.includes(', {late} change')")
    visit.page.locator("#moment").fill("300")
    visit.wait_until(f"{told}.includes(', {early} change')")


@pytest.mark.parametrize("motion", ["reduce", "no-preference"])
def test_on_a_phone_what_was_asked_for_is_in_view(browser: Browser, server: PageServer, motion: str) -> None:
    seen = """(one) => {
      const { top, bottom } = one.getBoundingClientRect();
      return top >= -1 && bottom <= innerHeight + 1;
    }"""
    with new_visit(browser, "phone") as visit:
        page = visit.page
        page.emulate_media(reduced_motion="reduce" if motion == "reduce" else "no-preference")
        opened(visit, server)
        for name in ("Draw your own", "1, digits/1"):
            page.get_by_role("button", name=name, exact=True).tap()
            visit.wait_until(f"({seen})(document.getElementById('board'))")
        page.get_by_role("button", name="Hand").tap()
        page.evaluate("scrollTo(0, 0)")
        page.locator(".tile").first.tap()
        visit.wait_until(f"({seen})(document.querySelector('#inspector h2'))")
