"""The page without any server but one for files: the emulator runs in the browser itself."""

import gzip
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from release.page_bundle import lay_out
from support.browser import Visit, new_visit
from support.page_server import PageServer
from support.static_server import static_server
from tilenca.base import paths

WEB = paths.BUILD / "web" / "bundle"
MOST_GZIPPED = 1_000_000
START = "?shape=digits/5&seed=42&speed=0&spread=0.2&until=0.8&fault=loss=0.02&fault=cut@2E&fault=off@8"


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not (WEB / "tilenca_emulator.wasm").exists():
        pytest.skip(f"{WEB} is not built; run `make web`")
    folder = tmp_path_factory.mktemp("bundle") / "page"
    lay_out(WEB, folder)
    return folder


@pytest.fixture(scope="module")
def site(bundle: Path, browser: Browser) -> Iterator[str]:
    with static_server(bundle) as url:
        yield url


def test_it_runs_by_itself_and_a_hand_reaches_in(visit: Visit, site: str) -> None:
    visit.page.goto(f"{site}?speed=0.5&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    start = visit.middle("[data-port=tile-11]")
    visit.drag(start, (start[0] - 500, start[1]))
    visit.wait_for_verdict("All 15 tiles show 9")
    visit.page.locator(".spot[data-place='3,0']").click()
    visit.wait_for_verdict("All 16 tiles show 8")
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


def test_it_is_small(bundle: Path) -> None:
    files = [path for path in bundle.rglob("*") if path.is_file()]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < MOST_GZIPPED
