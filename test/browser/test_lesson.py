"""The lesson: eight steps, each done by a hand and told by the tiles; by keyboard and read aloud, too."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from support.browser import SIZES, Visit, new_visit
from support.page_server import PageServer


def done(visit: Visit, step: int, words: str) -> None:
    """Waits until a step is done, and goes to the next."""
    lesson = visit.page.locator("#lesson")
    lesson.locator(".done", has_text=words).wait_for()
    assert lesson.locator("header .summary").inner_text() == f"{step} of 8"
    assert f"lesson={step}" in visit.page.url
    lesson.get_by_role("button", name="Next" if step < 8 else "End", exact=True).click()


def test_the_eight_steps_are_done_by_hand(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?speed=0.3&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    page.get_by_role("button", name="Draw", exact=True).click()
    page.get_by_role("button", name="Lesson").click()
    lesson = page.locator("#lesson")
    lesson.get_by_text("The tool is Hand now").wait_for()
    assert lesson.locator(".done").inner_text() == ""
    page.locator("[data-port=tile-06]").click()
    done(visit, 1, "These bars are all it has")
    page.get_by_role("button", name="Start over").click()
    done(visit, 2, "Nobody was in charge")
    page.get_by_label("Speed").fill("1")
    done(visit, 3, "A message says nothing of shapes")
    visit.wait_for_verdict("All 16 tiles show 8")
    visit.pull("tile-11")
    done(visit, 4, "An 8 without that tile is a 9")
    page.locator(".spot[data-place='3,0']").click()
    done(visit, 5, "The newcomer and all others show an 8")
    page.locator("[data-port=tile-06]").click()
    page.locator("#inspector").get_by_role("button", name="Power off").click()
    done(visit, 6, "The rest agree on what is left")
    visit.wait_for_verdict("All 16 tiles show 8")  # each step begins with a board that is whole
    (left, upper), (right, _) = visit.middle("[data-port=tile-07]"), visit.middle("[data-port=tile-10]")
    cable = (upper + visit.middle("[data-port=tile-11]")[1]) / 2
    visit.drag((left - 60, cable), (right + 60, cable))
    done(visit, 7, "Each group agrees with itself")
    visit.wait_for_verdict("All 16 tiles show 8")
    for first, last in (("05", "13"), ("06", "16"), ("08", "09"), ("14", "15")):  # a T is left, and drawn
        visit.drag(visit.middle(f"[data-port=tile-{first}]"), visit.middle(f"[data-port=tile-{last}]"))
    visit.drag(visit.middle(".spot[data-place='1,1']"), visit.middle(".spot[data-place='2,1']"))
    done(visit, 8, "That is all")
    lesson.wait_for(state="hidden")
    assert "lesson" not in page.url


def test_it_goes_by_keyboard_and_is_read_aloud(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?lesson=4")
    page.locator("#lesson h3", has_text="Agreement travels").wait_for()
    assert page.evaluate("document.activeElement.textContent") == "Agreement travels"
    assert page.locator("#lesson .done").get_attribute("role") == "status"
    visit.wait_for_verdict("All 16 tiles show 8")
    page.locator("[data-port=tile-11]").focus()
    page.keyboard.press("Delete")
    page.locator("#lesson .done", has_text="An 8 without that tile").wait_for()
    page.get_by_role("button", name="Next").focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.textContent") == "And back again"
    page.locator(".spot[data-place='3,0']").focus()
    page.keyboard.press("Enter")
    page.locator("#lesson .done", has_text="The newcomer").wait_for()
    page.reload()
    page.locator("#lesson h3", has_text="And back again").wait_for()
    page.get_by_role("button", name="End the lesson").click()
    page.locator("#lesson").wait_for(state="hidden")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", list(SIZES))
def test_it_stands_beside_the_tiles_and_hides_none(
    browser: Browser, server: PageServer, size: str, scheme: str
) -> None:
    with new_visit(browser, size, scheme) as visit:
        visit.page.goto(f"{server.url}?lesson=7")
        visit.page.locator("#lesson h3", has_text="Two groups").wait_for()
        visit.page.locator("[data-port=tile-01]").wait_for()
        boxes = [visit.page.locator(name).bounding_box() for name in ("#lesson", "#board")]
        (one, two) = (box for box in boxes if box is not None)
        beside = one["x"] >= two["x"] + two["width"] or one["y"] + one["height"] <= two["y"]
        assert beside, boxes
        width = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        wide = visit.page.evaluate(width)
        assert wide == 0
        found = Axe().run(visit.page)
        assert found.violations_count == 0, found.generate_report()


def test_what_was_so_before_a_step_is_no_deed(visit: Visit, server: PageServer) -> None:
    """Skipped on, while all 16 show an 8 and a tile is looked into."""
    page = visit.page
    page.goto(f"{server.url}?lesson=4&speed=1&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    page.locator("[data-port=tile-06]").click()
    page.get_by_role("button", name="Skip").click()
    page.locator("#lesson h3", has_text="And back again").wait_for()
    visit.wait_for_verdict("All 15 tiles show 9")
    assert page.locator("#lesson .done").inner_text() == ""
    page.get_by_role("button", name="Skip").click()  # a dead tile: all are switched on one after the other
    visit.wait_for_verdict("All 16 tiles show 8")
    assert page.locator("#lesson .done").inner_text() == ""
    for _ in range(5):
        page.locator("#lesson").get_by_role("button", name="Back").click()
    visit.wait_for_verdict("All 16 tiles show 8")
    assert page.locator("#lesson header .summary").inner_text() == "1 of 8"
    assert page.locator("#lesson .done").inner_text() == ""


def test_a_step_that_is_not_done_stays_undone(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?lesson=4")
    visit.wait_for_verdict("All 16 tiles show 8")
    visit.page.locator("[data-port=tile-11]").focus()
    visit.page.keyboard.press("Shift+ArrowUp")
    visit.wait_until("location.search.includes('fault=cut')")
    visit.page.wait_for_timeout(1500)
    assert visit.page.locator("#lesson .done").inner_text() == ""
    assert visit.page.get_by_role("button", name="Skip").is_visible()


# A lesson of its own beside that of the page, whose tiles know letters only, and then digits.
LETTERS = """async () => {
  const { Lesson } = await import("./components/lesson.js");
  const { Tiles } = await import("./stream/tiles.js");
  const { STREAM_VERSION } = await import("./stream/source.js");
  const [root, top] = ["section", "div"].map((one) => document.createElement(one));
  const [tiles, done] = [new Tiles(), []];
  const names = [["letters", "A"], ["digits", "8"]];
  const models = names.map(([name, label]) => ({ name, labels: [label], id: name }));
  const stream = { time: 0, stream: STREAM_VERSION, source: "emulated", models };
  const tell = (drawings) => tiles.take([{ ...stream, drawings }]);
  const lesson = new Lesson(root, top, tiles, {
    send: ({ do: name }) => done.push(name), open: () => done.push("open"), selected: () => null,
    close: () => {}, quiet: () => {}, tool: () => "",
    choose: ({ name }) => done.push(`choose ${name}`),
  });
  tell([]);
  lesson.go(3);
  const use = root.querySelector(".primary");
  const offered = use.textContent;
  use.click();
  tell([{ name: "digits/8", label: "8", rows: ["1111", "1001", "1111", "1001", "1111"] }]);
  lesson.begin();
  return [offered, ...done, root.hidden, root.querySelector("h3").textContent, use.hidden];
}"""


def test_with_letters_it_offers_the_digits_and_goes_on_with_them(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url)
    visit.page.locator(".tile").first.wait_for()
    assert visit.page.evaluate(LETTERS) == [
        "Use digits", "choose digits", "open", False, "Agreement travels", True,
    ]  # fmt: skip
