"""Another model on the page: chosen from a list, built where it is not there yet, kept in the address."""

import shutil
from pathlib import Path

from support.alone import alone
from support.browser import Visit
from support.page_server import page_server
from tilenca.base import paths


def test_a_model_is_chosen_built_and_named_by_the_address(visit: Visit) -> None:
    page = visit.page
    with alone("platformio"), page_server(None, ["--model", "digits"]) as server:
        page.goto(f"{server.url}?speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        page.get_by_label("Model").select_option("pentominoes")
        visit.wait_for_verdict("All 5 tiles show F")
        assert "model=B791" in page.url
        page.get_by_role("button", name="t, pentominoes", exact=False).first.click()
        visit.wait_for_verdict("All 5 tiles show t")
        page.goto(f"{server.url}?model=B791&shape=pentominoes/X&speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 5 tiles show X")
        assert page.input_value("#model") == "pentominoes"
        page.goto("about:blank")  # else it looks for the server that ends


def test_a_model_that_cannot_be_built_says_why_and_another_one_is_the_way_on(
    visit: Visit, firmware: Path, tmp_path: Path
) -> None:
    page, folder = visit.page, tmp_path / "mine"
    shutil.copytree(paths.MODELS / "hex", folder, ignore=shutil.ignore_patterns("firmware"))
    (folder / "firmware").write_text("in the way")
    with page_server(None, ["--model", str(folder)]) as server:
        page.goto(f"{server.url}?model=mine&speed=0.5&spread=0.1")
        visit.wait_for_verdict("The firmware of mine was not built")
        page.locator("#notice", has_text="Choose another model").wait_for()
        assert f"make {folder} writable" in page.locator("#notice").inner_text()
        assert page.url == f"{server.url}?speed=0.5&spread=0.1", "a reload does not try it again and again"
        page.get_by_label("Model").select_option("digits")
        visit.wait_for_verdict("All 16 tiles show 8")
        assert page.locator("#notice").is_hidden()
        page.goto("about:blank")  # else it looks for the server that ends
