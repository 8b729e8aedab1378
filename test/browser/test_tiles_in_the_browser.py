"""The page in a real browser: opened, it runs; a hand pulls and cuts, and the tiles change their minds."""

import json
import re
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser

from support.browser import Visit, new_visit
from support.page_server import PageServer, page_server
from support.web_socket import WebSocketClient
from tilenca import cli
from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.page.server import MOST_CLIENTS

QUICK = "?speed=0.5&spread=0.1"


def test_opened_it_runs_and_the_tiles_agree(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url)
    visit.wait_for_verdict("All 16 tiles show 8")
    assert visit.page.locator(".tile").count() == 16
    label = visit.page.locator("[data-port=tile-01]").get_attribute("aria-label")
    assert label == "Tile 1, row 1, column 1, shows 8, linked east, south"
    agreement = re.compile(r"100 % agree, \d+ changes of mind")
    visit.page.locator("#agreement-text", has_text=agreement).wait_for()
    assert visit.page.url.startswith(f"{server.url}?shape=digits/8&seed=0&speed=0.1&model=")


def test_a_pulled_tile_makes_the_others_change_their_minds(visit: Visit, server: PageServer) -> None:
    """An 8 without the left tile of its fourth row is a 9; put in again, an 8."""
    visit.page.goto(server.url + QUICK)
    visit.nine_and_back()


def test_a_tile_moves_where_it_is_dropped(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}{QUICK}&draw=11")
    visit.wait_for_verdict("All 2 tiles show")
    place = visit.middle(".spot[data-place='1,0']")
    visit.drag(visit.middle("[data-port=tile-02]"), place)
    visit.wait_until("location.search.includes('draw=1-1')")
    label = visit.page.locator("[data-port=tile-02]").get_attribute("aria-label") or ""
    assert "row 2, column 1" in label


def test_the_knife_cuts_what_it_crosses_and_mends_by_a_click(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?shape=digits/1&speed=0.5&spread=0.1")
    visit.wait_for_verdict("All 5 tiles show 1")
    visit.page.get_by_role("button", name="Knife").click()
    (x, upper), (_, lower) = visit.middle("[data-port=tile-02]"), visit.middle("[data-port=tile-03]")
    cable = (upper + lower) / 2
    visit.drag((x - 60, cable), (x + 60, cable))
    visit.wait_until("location.search.includes('fault=cut@2S')")
    lamp = "[data-port=tile-02] .lamp:nth-of-type(3)"
    visit.page.wait_for_selector(f"{lamp}:not(.on)", state="attached")
    visit.page.mouse.click(x, cable)
    visit.wait_until("!location.search.includes('fault')")
    visit.page.wait_for_selector(f"{lamp}.on", state="attached")


def test_one_draws_while_they_run(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}{QUICK}&draw=1111-0000-0000".replace("-0000-0000", ""))
    visit.wait_for_verdict("All 4 tiles show")
    visit.page.keyboard.press("d")
    visit.drag(visit.middle(".spot[data-place='1,3']"), visit.middle(".spot[data-place='1,0']"))
    visit.wait_until("location.search.includes('draw=1111-1111')")
    visit.drag(visit.middle("[data-port=tile-02]"), visit.middle("[data-port=tile-03]"))
    visit.wait_until("location.search.includes('draw=1001-1111')")
    assert visit.page.locator("#notice").is_hidden()


def test_another_drawing_slides_under_the_living_tiles(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url + QUICK)
    visit.wait_for_verdict("All 16 tiles show 8")
    clock = float(visit.page.inner_text("#clock").removesuffix(" s"))
    visit.page.get_by_role("button", name="4, digits/4", exact=True).click()
    visit.wait_for_verdict("All 10 tiles show 4")
    assert float(visit.page.inner_text("#clock").removesuffix(" s")) > clock  # the same run
    visit.page.wait_for_selector("[aria-label='4, digits/4'][aria-pressed=true]")


def test_a_tile_is_looked_into_killed_frozen_and_reset(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url + "?shape=digits/4&speed=0.5&spread=0.1")
    visit.wait_for_verdict("All 10 tiles show 4")
    visit.page.locator("[data-port=tile-06]").click()
    inspector = visit.page.locator("#inspector")
    assert inspector.locator("h2").inner_text() == "Tile 6"
    assert re.match(r"It shows 4, (fairly )?sure \(margin \d+\)", inspector.locator(".guess").inner_text())
    assert inspector.locator(".scores li").count() == 11
    model = load_model(paths.DEFAULT_MODEL)
    hidden = model.dimensions.channels - len(model.labels)
    assert inspector.locator(".meters").nth(1).locator("li").count() == hidden
    score = int(inspector.locator(".scores li").nth(4).locator(".value").inner_text())
    assert score > 30
    inspector.get_by_role("button", name="Freeze").click()
    visit.page.wait_for_selector("[data-port=tile-06][data-state=frozen]")
    inspector.get_by_role("button", name="Thaw").click()
    visit.page.wait_for_selector("[data-port=tile-06][data-state='']")
    inspector.get_by_role("button", name="Cut the cable, west").click()
    inspector.get_by_role("button", name="Mend the cable, west").wait_for()
    inspector.get_by_role("button", name="Power off").click()
    visit.page.wait_for_selector("[data-port=tile-06][data-state=off]")
    visit.wait_until("/fault=off@6/.test(location.search)")
    inspector.get_by_role("button", name="Power on").click()
    visit.page.wait_for_selector("[data-port=tile-06][data-state='']")
    inspector.get_by_role("button", name="Reset").click()
    inspector.get_by_role("button", name="Pull out").click()
    visit.page.wait_for_selector("[data-port=tile-06]", state="detached")
    assert inspector.is_hidden()


def test_time_stops_steps_and_goes_on(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url + "?shape=digits/4&speed=0.5&spread=0&until=0.5")
    visit.page.get_by_role("button", name="Go on").wait_for()

    def clock() -> float:
        return float(visit.page.inner_text("#clock").removesuffix(" s"))

    assert clock() == 0.5
    visit.page.get_by_role("button", name="One update").click()
    visit.wait_until("document.getElementById('clock').textContent === '0.52 s'")
    visit.page.locator("h1").click()  # Space on a button presses that
    visit.page.keyboard.press("Space")
    visit.page.get_by_role("button", name="Pause").wait_for()
    visit.page.get_by_label("Speed").fill("6")
    visit.wait_until("document.getElementById('speed').value === '6' && location.search.includes('speed=0&')")
    visit.wait_until("parseFloat(document.getElementById('clock').textContent) > 3")
    visit.page.keyboard.press("r")
    visit.wait_until("parseFloat(document.getElementById('clock').textContent) < 3")


def test_an_address_gives_the_same_run_again_to_the_byte(
    visit: Visit, server: PageServer, tmp_path: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = "?shape=digits/5&seed=42&speed=0.7&spread=0.2&until=0.8&fault=loss=0.02&fault=cut@2E&fault=off@8"
    runs = []
    visit.record_stream()
    visit.page.goto(server.url + start)
    for _ in range(2):
        visit.page.get_by_role("button", name="Go on").wait_for()
        visit.wait_until("location.search.includes('model=')")
        runs.append(visit.last_said())
        visit.page.goto(visit.page.url)  # what the address has become by then
    record = tmp_path / "said.jsonl"
    start = "--shape 5 --seed 42 --boot-spread 0.2 --seconds 0.8 --bootloader none"
    words = f"{start} --fault loss=0.02 --fault cut@2E --fault off@8"
    cli.main(["emulate", *words.split(), "--elf", str(firmware), "--record", str(record)])
    capsys.readouterr()
    recorded = {}
    for line in record.read_text().splitlines():
        event = json.loads(line)
        if event.get("raw", "").startswith("$TILE"):
            recorded[event["port"]] = event["raw"]
    assert len(recorded) > 8
    assert runs == [recorded, recorded]


def test_an_address_with_a_fault_that_cannot_be_says_so_and_runs_without(
    visit: Visit, server: PageServer
) -> None:
    visit.page.goto(f"{server.url}?draw=11&spread=0&fault=off@77")
    visit.page.locator("#notice", has_text="no tile '77'").wait_for()
    visit.wait_for_verdict("All 2 tiles show")


def test_faults_that_no_hand_has_changed_stay_in_the_address(visit: Visit, server: PageServer) -> None:
    given = ["flip=0.0001@3S", "drift=20", "loss=0.001@1S", "reset@2:0.4", "cut@3-4", "loss=0.005"]
    query = "&".join(f"fault={fault}" for fault in given)

    def faults() -> list[str]:
        return parse_qs(urlsplit(visit.page.url).query).get("fault", [])

    visit.page.goto(f"{server.url}?shape=digits/1&speed=1&spread=0&until=0.6&{query}")
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_until("location.search.includes('model=')")
    visit.page.wait_for_timeout(600)  # it looks at the board every half second
    assert faults() == given
    assert visit.page.locator("#noise").input_value() == "0.5"
    visit.page.locator("#noise").fill("2")
    visit.wait_until("location.search.includes('loss=0.02')")
    assert faults() == ["flip=0.0001@3S", "drift=20", "reset@2:0.4", "cut@3-4", "loss=0.02"]
    visit.page.locator("[data-port=tile-01]").click()
    visit.page.get_by_role("button", name="Pull out").click()
    visit.wait_until("location.search.includes('flip=0.0001@2S')")
    assert faults() == ["flip=0.0001@2S", "drift=20", "reset@1:0.4", "loss=0.02", "cut@2S"]


def test_the_slider_shows_the_losses_of_a_link(visit: Visit, server: PageServer) -> None:
    visit.page.goto(f"{server.url}?shape=digits/1&spread=0&fault=loss=0.4")
    visit.page.locator("[data-port=tile-05]").wait_for()
    assert visit.page.locator("#noise").input_value() == "40"


def test_one_page_too_many_is_told_for_as_long_as_it_waits(browser: Browser, firmware: Path) -> None:
    with page_server(firmware) as server, new_visit(browser) as visit:
        others = [WebSocketClient(server.address) for _ in range(MOST_CLIENTS)]
        for other in others:
            other.watch("stream")
        visit.page.goto(server.url)
        notice = visit.page.locator("#notice", has_text="close one of them; trying again in 2 s")
        notice.wait_for()  # the waits grow
        for other in others:
            other.close()
        visit.page.locator("[data-port=tile-01]").wait_for()
        visit.wait_until("document.getElementById('notice').hidden")


def test_a_wrong_token_is_told_and_not_tried_again(browser: Browser, firmware: Path) -> None:
    with page_server(firmware, listen="0.0.0.0:0") as server, new_visit(browser) as visit:
        visit.record_stream()
        port = urlsplit(server.url).port
        visit.page.goto(f"http://127.0.0.1:{port}/#token=guess")
        visit.page.locator("#notice", has_text="not the right token").wait_for()
        visit.page.wait_for_timeout(1500)
        assert visit.page.evaluate("stream.opened") == 1


def test_surprises_happen(visit: Visit, server: PageServer) -> None:
    visit.record_stream()
    visit.page.goto(server.url + QUICK)
    visit.wait_for_verdict("All 16 tiles show 8")
    for _ in range(6):
        visit.page.get_by_role("button", name="Surprise me").click()
    done = visit.sent() - {"seen", "open", "rest"}
    assert done
    assert done <= {"arrange", "pull", "power", "cut"}


def test_it_comes_back_when_the_server_does(visit: Visit, firmware: Path) -> None:
    # While there is no server; a page that is still loading misses a file, too.
    visit.forgiven = ("WebSocket connection", "net::ERR_CONNECTION_REFUSED")
    with page_server(firmware) as first:
        host, port = first.address
        visit.page.goto(f"{first.url}?shape=digits/7&speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 9 tiles show 7")
        first.stop()
        visit.page.locator("#notice", has_text="out of reach").wait_for()
    with page_server(firmware, listen=f"{host}:{port}"):
        visit.page.locator("#notice").wait_for(state="hidden")
        visit.wait_for_verdict("All 9 tiles show 7")


def test_another_site_gets_no_connection(browser: Browser, server: PageServer) -> None:
    with new_visit(browser) as visit:
        visit.page.goto("about:blank")
        outcome = visit.page.evaluate(
            """(url) => new Promise((resolve) => {
              const socket = new WebSocket(url);
              socket.onopen = () => resolve("open");
              socket.onclose = () => resolve("closed");
            })""",
            server.url.replace("http", "ws") + "stream",
        )
    assert outcome == "closed"


def test_a_browser_that_paints_seldom_counts_the_same_changes_of_mind(
    browser: Browser, server: PageServer
) -> None:
    """Of what it was not told in time it gets the latest; of changes it has to get all."""
    texts = []
    for wait_ms in (0, 700):
        with new_visit(browser) as visit:
            visit.page.add_init_script(
                f"""{{ const soon = requestAnimationFrame;
                window.requestAnimationFrame = (act) => setTimeout(() => soon(act), {wait_ms}); }}"""
            )
            visit.page.goto(f"{server.url}?shape=digits/8&seed=0&speed=1&spread=0.1&until=1.5")
            visit.page.get_by_role("button", name="Go on").wait_for()
            texts.append(
                visit.page.evaluate(
                    """async () => {
                      for (let n = 0; n < 12; n++) await new Promise(requestAnimationFrame);
                      return document.getElementById("agreement-text").textContent;
                    }"""
                )
            )
            assert visit.complaints == []
    assert texts[0] == texts[1]
    assert int(texts[0].split(", ")[1].split()[0]) > 10
