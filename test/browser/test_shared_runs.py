"""A link to what lies on the board, and one to how it came about, which says that it is a replay."""

import re

from axe_playwright_python.sync_playwright import Axe

from support.browser import Visit
from support.page_server import PageServer

START = "?shape=digits/1&speed=1&spread=0"
SPEED = "import('./main.js').then(({ tiles }) => tiles.pace.speed)"


def drawn(visit: Visit, server: PageServer) -> None:
    """Two tiles that a hand has put on an empty board, standing, with the dialog open."""
    page = visit.page
    page.goto(server.url + START)
    visit.wait_for_verdict("All 5 tiles show 1")
    page.get_by_role("button", name="Draw your own").click()
    visit.wait_for_verdict("The board is empty")
    visit.wait_until("location.search.includes('draw=0&')")
    for place in ("1,1", "2,1"):
        page.locator(f".spot[data-place='{place}']").click()
    visit.wait_until("document.querySelectorAll('.tile').length === 2")
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Go on").wait_for()
    page.get_by_role("button", name="Share").click()


def test_the_link_is_that_of_the_board_unless_one_wants_how_it_came_about(
    visit: Visit, server: PageServer
) -> None:
    drawn(visit, server)
    page = visit.page
    now = page.input_value("#share-link")
    assert "draw=1-1&" in now
    assert not re.search("deed|until", now)
    assert page.locator("#share", has_text="Opens on this computer only").is_visible()
    assert Axe().run(page).violations_count == 0
    page.get_by_label("How it came about").check()
    history = page.input_value("#share-link")
    assert re.findall(r"deed=[\d.]+,(\w+)", history) == ["arrange", "pull", "put", "put"]
    assert "shape=digits/1" in history
    assert "until=" in history
    page.get_by_label("The board as it is now").check()
    assert page.input_value("#share-link") == now
    page.goto(now)
    visit.wait_until("document.querySelectorAll('.tile').length === 2")
    page.get_by_role("button", name="Pause").wait_for()
    assert page.locator("#shared").is_hidden()


def test_a_shared_run_says_what_it_is_and_goes_to_its_end_at_once(visit: Visit, server: PageServer) -> None:
    drawn(visit, server)
    page = visit.page
    page.get_by_label("How it came about").check()
    history = page.input_value("#share-link").replace("speed=1&", "speed=0.03&")
    page.goto(history)
    shared = page.locator("#shared")
    shared.get_by_text(re.compile(r"A shared run: 0\.\d of \d+\.\d s")).wait_for()
    assert page.locator("#hint").is_hidden()
    page.wait_for_timeout(700)
    assert page.url == history, "a reload shows it from its beginning"
    page.get_by_role("button", name="Go to its end").click()
    shared.get_by_text("End of the shared run; Play goes on").wait_for()
    visit.wait_until("location.search.includes('draw=1-1&')")
    assert not re.search("deed|until", page.url)
    assert page.locator(".tile").count() == 2
    visit.wait_until("document.getElementById('speed').getAttribute('aria-valuetext') === '33 times slower'")
    assert Axe().run(page).violations_count == 0
    page.get_by_role("button", name="Go on").click()
    shared.wait_for(state="hidden")


def test_an_empty_board_is_a_beginning_of_its_own(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}?draw=0&speed=1")
    visit.wait_for_verdict("The board is empty")
    page.get_by_role("button", name="Draw", exact=True).click()
    page.locator(".spot[data-place='1,1']").click()
    visit.wait_until("document.querySelectorAll('.tile').length === 1")
    page.get_by_role("button", name="Share").click()
    page.get_by_label("How it came about").check()
    link = page.input_value("#share-link")
    assert re.findall(r"deed=[\d.]+,(\w+)", link) == ["put"]
    page.goto(link)
    page.get_by_text("End of the shared run").wait_for()
    assert page.locator(".tile").count() == 1


def test_what_is_left_is_told_with_the_way_back(visit: Visit, server: PageServer) -> None:
    page = visit.page
    page.goto(f"{server.url}{START}&until=0.5")
    page.get_by_role("button", name="Go on").wait_for()
    page.get_by_role("button", name="Draw your own").click()
    visit.wait_for_verdict("The board is empty")
    page.locator("#notice").get_by_role("button", name="Go back to 0.48 s").click()
    visit.wait_until("document.querySelectorAll('.tile').length === 5")
    page.locator("[data-port=tile-03]").focus()
    page.keyboard.press("Delete")
    notice = page.locator("#notice", has_text="Another future begins at 0.48 s; the one until 0.50 s is left")
    notice.get_by_role("button", name="Back to that").click()
    page.get_by_text("End of the shared run").wait_for()
    visit.wait_for_verdict("The board is empty")
    page.get_by_role("button", name="Lesson").click()
    page.locator("#notice", has_text="The run until 0.50 s is left").wait_for()


def test_one_run_after_compare_is_the_left_one(visit: Visit, server: PageServer) -> None:
    page = visit.page
    query = "?shape=digits/1&seed=5&speed=1&spread=0"
    page.goto(f"{server.url}{query}")
    visit.wait_until("location.search.includes('model=')")
    page.get_by_role("button", name="Share").click()
    page.get_by_role("button", name="Compare").click()
    page.locator("#leave").click()
    page.locator("#board").wait_for()
    visit.wait_until("location.search.includes('shape=digits/1&seed=5')")
