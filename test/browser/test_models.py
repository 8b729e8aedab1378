"""Another model on the page: chosen from a list, built where it is not there yet, kept in the address."""

from support.alone import alone
from support.browser import Visit
from support.page_server import page_server


def test_a_model_is_chosen_built_and_named_by_the_address(visit: Visit) -> None:
    page = visit.page
    with alone("platformio"), page_server(None, ["--model", "digits"]) as server:
        page.goto(f"{server.url}?speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 16 tiles show 8")
        page.get_by_label("Model").select_option("pentominoes")
        visit.wait_for_verdict("All 5 tiles show F")
        assert "model=64EB" in page.url
        page.get_by_role("button", name="t, pentominoes", exact=False).first.click()
        visit.wait_for_verdict("All 5 tiles show t")
        page.goto(f"{server.url}?model=64EB&shape=pentominoes/X&speed=0.5&spread=0.1")
        visit.wait_for_verdict("All 5 tiles show X")
        assert page.input_value("#model") == "pentominoes"
