"""The page without any server but one for files: the emulator runs in the browser itself."""

import gzip
import shutil
from pathlib import Path
from urllib.parse import unquote

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from browser.conftest import WEB
from release.page_bundle import lay_out
from support.alone import alone
from support.browser import Visit, new_visit
from support.page_server import PageServer
from support.static_server import static_server

MOST_GZIPPED = 1_000_000
START = "?shape=digits/5&seed=42&speed=0&spread=0.2&until=0.8&fault=loss=0.02&fault=cut@2E&fault=off@8"


def test_it_runs_by_itself_and_a_hand_reaches_in(visit: Visit, site: str) -> None:
    visit.page.goto(f"{site}?speed=0.5&spread=0.1")
    visit.nine_and_back()
    assert [url for url in visit.requests if not url.startswith(site)] == []
    assert Axe().run(visit.page).violations_count == 0


def test_an_address_is_the_same_run_here_and_with_a_server(
    visit: Visit, browser: Browser, site: str, server: PageServer
) -> None:
    """What each tile shows, has said and sends at the same moment of the same seed."""
    told = """async () => {
      const { tiles } = await import("./main.js");
      const names = ["port", "place", "label", "margin", "state", "updates", "segments", "rgb", "leds"];
      return tiles.laid().map((tile) => Object.fromEntries(names.map((name) => [name, tile[name]])));
    }"""
    said = []
    for url in (site, server.url):
        visit.page.goto(url + START)
        visit.page.get_by_role("button", name="Go on").wait_for()
        visit.wait_until("location.search.includes('model=')")
        said.append(visit.page.evaluate(told))
    assert len(said[0]) == 14
    assert sum(tile["updates"] > 10 for tile in said[0]) == 13
    assert said[0] == said[1]


@pytest.mark.parametrize("is_static", [True, False])
def test_time_goes_back_and_a_hand_begins_another_future(
    visit: Visit, site: str, server: PageServer, is_static: bool
) -> None:
    visit.page.goto(f"{site if is_static else server.url}?speed=0.5&spread=0.1&until=0.9")
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    line = visit.page.locator("#timeline")
    assert "0.90 of 0.90 s" in line.inner_text()
    told = "document.getElementById('agreement-text').textContent"
    changes = visit.page.evaluate(f"{told}.split(', ')[1]")
    visit.page.locator("#moment").fill("200")
    visit.wait_until("document.getElementById('clock').textContent === '0.20 s'")
    assert "All" not in visit.verdict
    visit.page.locator("h1").click()
    visit.page.keyboard.press(",")
    visit.page.keyboard.press(",")
    visit.wait_until("document.getElementById('clock').textContent === '0.16 s'")
    visit.page.locator("#moment").focus()
    visit.page.keyboard.press("ArrowRight")
    visit.wait_until("document.getElementById('clock').textContent === '0.18 s'")
    visit.page.get_by_label("Speed").fill("3")
    visit.page.get_by_role("button", name="Go on").click()
    visit.wait_for_verdict("All 16 tiles show 8")  # the same future, of which nothing is counted twice
    visit.page.get_by_role("button", name="Pause").click()
    visit.page.get_by_role("button", name="Go on").wait_for()
    assert visit.page.evaluate(f"{told}.split(', ')[1]") == changes
    visit.page.locator("#moment").fill("300")
    visit.wait_until("document.getElementById('clock').textContent === '0.30 s'")
    visit.page.locator("[data-port=tile-11]").focus()
    visit.page.keyboard.press("Delete")
    visit.wait_until("document.getElementById('timeline').textContent.includes('of 0.30 s')")
    visit.page.get_by_role("button", name="Go on").click()
    visit.wait_for_verdict("All 15 tiles show 9")


def test_what_cannot_be_is_said(visit: Visit, site: str) -> None:
    visit.page.goto(f"{site}?draw=11&spread=0&fault=off@77")
    visit.page.locator("#notice", has_text="no tile '77'").wait_for()
    visit.wait_for_verdict("All 2 tiles show")


def test_missing_files_are_said(browser: Browser, bundle: Path, tmp_path: Path) -> None:
    broken = tmp_path / "page"
    shutil.copytree(bundle, broken)
    (broken / "emulator" / "firmware.elf").unlink()
    with static_server(broken) as url, new_visit(browser) as visit:
        visit.page.goto(url)
        visit.page.locator("#notice", has_text="firmware.elf: 404").wait_for()


def test_another_model_is_fetched_by_whoever_chooses_it(
    visit: Visit, browser: Browser, bundle: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "page"
    with alone("platformio"):
        lay_out(WEB, folder, ["pentominoes"])
    beside = {str(path.relative_to(folder)) for path in folder.rglob("pentominoes.*")}
    assert beside == {"emulator/models/pentominoes.elf", "emulator/models/pentominoes.json"}
    page = visit.page
    with static_server(folder) as url:
        page.goto(f"{url}?speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        assert not any("pentominoes" in address for address in visit.requests)
        page.get_by_label("Model").select_option("pentominoes")
        visit.wait_for_verdict("All 5 tiles show F")
        assert "model=B791" in page.url
        page.goto(f"{url}?model=B791&shape=pentominoes/X&speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 5 tiles show X")
        assert page.input_value("#model") == "pentominoes"
        page.goto(f"{url}?draw=1-1&speed=0.5&spread=0.1&fault=cut@1S&look=sure")
        visit.wait_until("document.querySelectorAll('.tile').length === 2")
        page.get_by_label("Model").select_option("pentominoes")
        visit.wait_until("location.search.includes('model=B791')")
        kept = ("draw=1-1&", "speed=0.5&", "fault=cut@1S", "spread=0.1", "look=sure")
        assert [part for part in kept if part not in unquote(page.url)] == []
        visit.wait_until("document.getElementById('verdict').textContent !== 'The tiles boot'")


def test_it_is_small(bundle: Path) -> None:
    files = [path for path in bundle.rglob("*") if path.is_file()]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < MOST_GZIPPED
