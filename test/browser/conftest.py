"""A browser, a server, and a visit of the one to the other."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from release.page_bundle import lay_out
from support.browser import Visit, new_visit
from support.page_server import PageServer, page_server
from support.static_server import static_server
from tilenca.base import paths

WEB = paths.BUILD / "web" / "bundle"


@pytest.fixture(scope="module")
def server(browser: Browser, firmware: Path) -> Iterator[PageServer]:
    with page_server(firmware) as running:
        yield running


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page that needs no server of its own, with the digits only."""
    if not (WEB / "tilenca_emulator.wasm").exists():
        pytest.skip(f"{WEB} is not built; run `make web`")
    folder = tmp_path_factory.mktemp("bundle") / "page"
    lay_out(WEB, folder)
    return folder


@pytest.fixture(scope="module")
def site(bundle: Path, browser: Browser) -> Iterator[str]:
    """Its address, behind a server of files."""
    with static_server(bundle) as url:
        yield url


@pytest.fixture
def visit(browser: Browser) -> Iterator[Visit]:
    """On a laptop. Nothing may go wrong behind the scenes, and nothing may be asked of anybody else."""
    with new_visit(browser) as visit:
        yield visit
    addresses = {url.split("/")[2].split(":")[0] for url in visit.requests if url.startswith("http")}
    assert visit.complaints == []
    assert addresses <= {"127.0.0.1"}
