"""The board under a hand: what was done is seen, also while time stands, and places stay."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from support.browser import Visit, new_visit
from support.page_server import PageServer

PAUSED = "?speed=1&spread=0.1&seed=0&until=0.9"
# How many pixels of the layer on which strokes are drawn are not clear.
STROKE = """() => {
  const { width, height } = document.querySelector(".flying");
  const { data } = document.querySelector(".flying").getContext("2d").getImageData(0, 0, width, height);
  return data.filter((part, at) => at % 4 === 3 && part > 0).length;
}"""


def pressed(visit: Visit) -> list[str]:
    """The ports of the tiles with the ring of the one that is looked into."""
    ports: list[str] = visit.page.evaluate(
        "[...document.querySelectorAll('.tile[aria-pressed=true]')].map((one) => one.dataset.port)"
    )
    return ports


@pytest.fixture
def paused(visit: Visit, server: PageServer) -> Visit:
    """Sixteen tiles that show an 8; time stands."""
    visit.page.goto(server.url + PAUSED)
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    return visit


def rest(visit: Visit) -> None:
    """Lets all come that is on its way."""
    visit.page.wait_for_timeout(400)


def test_the_ring_goes_to_the_tile_that_was_clicked_while_time_stands(paused: Visit) -> None:
    for port in ("tile-06", "tile-11"):
        paused.page.locator(f"[data-port={port}]").click()
        paused.wait_until(f"document.querySelector('[data-port={port}]').ariaPressed === 'true'")
        assert pressed(paused) == [port]


def test_a_stroke_is_drawn_in_full_while_time_stands_and_its_tiles_are_dark(paused: Visit) -> None:
    page = paused.page
    page.get_by_role("button", name="Draw your own").click()
    paused.wait_for_verdict("The board is empty")
    rest(paused)
    paused.drag(paused.middle(".spot[data-place='0,0']"), paused.middle(".spot[data-place='0,3']"))
    paused.wait_until("document.querySelectorAll('.tile').length === 4")
    assert page.locator(".tile.dark").count() == 4
    assert page.locator(".tile .lit path:not([d=''])").count() == 0
    assert page.locator("#clock").inner_text() == "0.90 s"


def test_the_stroke_of_a_knife_goes_with_it_while_time_stands(paused: Visit) -> None:
    paused.forgiven = ("willReadFrequently",)  # only the test reads the canvas
    paused.page.get_by_role("button", name="Knife").click()
    (x, y), (right, _) = paused.middle("[data-port=tile-01]"), paused.middle("[data-port=tile-02]")
    at = (x + right) / 2
    paused.page.mouse.move(at, y - 30)
    paused.page.mouse.down()
    paused.page.mouse.move(at, y + 30, steps=8)
    paused.wait_until(f"({STROKE})() > 0")
    paused.page.mouse.up()
    paused.wait_until(f"({STROKE})() === 0")


def test_a_page_at_rest_draws_nothing(paused: Visit) -> None:
    paused.page.locator("[data-port=tile-06]").click()
    rest(paused)
    frames = paused.page.evaluate("""async () => {
      const soon = requestAnimationFrame;
      let asked = 0;
      window.requestAnimationFrame = (act) => { asked++; return soon(act); };
      await new Promise((resolve) => setTimeout(resolve, 500));
      return asked;
    }""")
    assert frames == 0


def test_space_presses_what_the_keyboard_is_on_and_else_pauses(paused: Visit) -> None:
    page, press = paused.page, paused.page.keyboard.press
    page.locator("[data-port=tile-06]").click()
    page.locator("#inspector h2", has_text="Tile 6").wait_for()
    press("Space")
    page.get_by_role("button", name="Pause").wait_for()
    assert pressed(paused) == ["tile-06"]
    press("p")
    page.get_by_role("button", name="Go on").wait_for()
    press("ArrowUp")
    press("Space")
    page.locator("#inspector h2", has_text="Tile 4").wait_for()
    assert page.get_by_role("button", name="Go on").is_visible()
    assert "Space unless the keyboard is on a button" in (
        page.get_by_role("button", name="Go on").get_attribute("title") or ""
    )


@pytest.mark.parametrize(("size", "scheme"), [("laptop", "light"), ("phone", "dark")])
def test_the_keys_are_listed(browser: Browser, server: PageServer, size: str, scheme: str) -> None:
    with new_visit(browser, size, scheme) as visit:
        page = visit.page
        page.goto(server.url + PAUSED)
        page.get_by_role("button", name="Go on").wait_for()
        page.keyboard.press("?")
        page.locator("#keys kbd", has_text={"laptop": "Ctrl Z", "phone": "Tap a tile"}[size]).wait_for()
        assert Axe().run(page).violations_count == 0
        page.keyboard.press("Escape")
        page.locator("#keys").wait_for(state="hidden")
        page.get_by_role("button", name="Help").click()
        page.locator("#keys").wait_for()
        assert visit.complaints == []


def test_the_last_deed_is_taken_back_or_there_is_none(paused: Visit) -> None:
    page = paused.page
    page.keyboard.press("Control+z")
    page.locator("#notice", has_text="nothing to take back").wait_for()
    paused.pull("tile-11")
    assert page.locator("#notice").is_hidden()  # somebody has gone on
    paused.wait_for_verdict("All 15 tiles show 8")
    page.keyboard.press("Control+z")
    page.locator("#notice", has_text="Taken back: tile 11 pulled out.").wait_for()
    paused.wait_for_verdict("All 16 tiles show 8")
    page.get_by_role("button", name="One update").click()
    paused.wait_until("document.getElementById('clock').textContent === '0.92 s'")
    assert page.locator(".tile").count() == 16
    paused.forgiven = ("willReadFrequently",)  # only the test reads the canvas
    page.set_viewport_size({"width": 1280, "height": 700})  # cables are drawn anew, though time stands
    paused.wait_until(
        "[document.querySelector('.cables')].some((one) => "
        "one.getContext('2d').getImageData(0, 0, one.width, one.height).data.some(Boolean))"
    )


def test_what_draw_does_is_said_until_both_were_done(paused: Visit) -> None:
    page = paused.page
    hint = page.locator(
        "#hint", has_text="Drag over empty places to put tiles in, over tiles to rub them out"
    )
    page.get_by_role("button", name="Draw", exact=True).click()
    hint.wait_for()
    place = paused.middle(".spot[data-place='1,1']")
    page.mouse.click(*place)
    paused.wait_until("document.querySelectorAll('.tile').length === 17")
    assert hint.is_visible()
    page.mouse.click(*place)
    hint.wait_for(state="hidden")


@pytest.mark.parametrize("size", ["laptop", "phone"])
def test_a_tile_in_the_hand_is_seen_wherever_that_is(browser: Browser, server: PageServer, size: str) -> None:
    with new_visit(browser, size) as visit:
        page = visit.page
        page.goto(server.url + PAUSED)
        page.get_by_role("button", name="Go on").wait_for()
        x, y = visit.middle("[data-port=tile-11]")
        board = page.locator("#board").bounding_box()
        assert board is not None
        below = board["y"] + board["height"] + 60
        page.mouse.move(x, y)
        page.mouse.down()
        for at in ((x, below), (2, below)):
            page.mouse.move(*at, steps=4)
            page.locator("#box", has_text="Let go to take it out").wait_for()
            port = page.evaluate(
                "(at) => document.elementFromPoint(...at).closest('.tile')?.dataset.port", at
            )
            assert port == "tile-11"
        page.mouse.up()
        visit.wait_until("document.querySelectorAll('.tile').length === 15")
        assert page.locator("#board").evaluate("(one) => getComputedStyle(one).overflow") == "hidden"
        assert visit.complaints == []


@pytest.mark.parametrize("tool", ["Hand", "Draw"])
def test_no_place_is_cut_off(paused: Visit, tool: str) -> None:
    paused.page.get_by_role("button", name=tool, exact=True).click()
    rest(paused)
    assert (
        paused.page.evaluate("""() => {
      const board = document.getElementById("board").getBoundingClientRect();
      return [...document.querySelectorAll(".spot")].filter((one) => {
        const { top, bottom, left, right, height } = one.getBoundingClientRect();
        const hair = 0.11 * height;
        return top < board.top - hair || bottom > board.bottom + hair
          || left < board.left - hair || right > board.right + hair;
      }).length;
    }""")
        == 0
    )


def test_places_stay_where_they_are_while_one_draws_at_the_edge(paused: Visit) -> None:
    page = paused.page
    page.get_by_role("button", name="Draw", exact=True).click()
    rest(paused)
    before = paused.middle("[data-port=tile-01]"), paused.middle(".spot[data-place='2,6']")
    paused.drag(paused.middle(".spot[data-place='-1,0']"), paused.middle(".spot[data-place='-1,3']"))
    paused.wait_until("document.querySelectorAll('.tile').length === 20")
    rest(paused)
    assert (paused.middle("[data-port=tile-01]"), paused.middle(".spot[data-place='2,6']")) == before
    page.get_by_role("button", name="Draw", exact=True).click()
    page.locator(".spot[data-place='-2,0']").wait_for()


def test_a_group_that_is_all_there_is_says_that_it_has_moved(paused: Visit) -> None:
    paused.page.get_by_role("button", name="Group").click()
    x, y = paused.middle("[data-port=tile-01]")
    paused.drag((x, y), (x - 75, y))
    paused.page.locator("#notice", has_text="All tiles have moved together").wait_for()


def test_one_update_is_run_from_a_run_that_goes_on_and_stands_then(paused: Visit) -> None:
    page = paused.page
    page.get_by_role("button", name="Go on").click()
    page.get_by_role("button", name="Pause").wait_for()
    step = page.get_by_role("button", name="One update")
    assert step.is_enabled()
    step.click()
    page.get_by_role("button", name="Go on").wait_for()
    stands = page.locator("#clock").inner_text()
    assert step.is_enabled()
    step.click()
    paused.wait_until(f"document.getElementById('clock').textContent !== '{stands}'")


def test_the_ring_of_a_drawing_in_the_first_column_is_whole(paused: Visit) -> None:
    ring = paused.page.evaluate("""() => {
      const first = document.querySelector(".gallery button");
      const side = document.querySelector(".side").getBoundingClientRect();
      return first.getBoundingClientRect().left - side.left;
    }""")
    assert ring >= 5
