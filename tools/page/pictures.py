"""Makes the picture of the page for the documents: python -m page.pictures, with tools on the path.

The run pauses at the moment of the picture, so that the tiles are the same every time.
"""

from bench import chromium
from page.visit import browser_at, served_page
from tilenca.base.paths import ROOT

OUT = ROOT / "docs" / "images" / "page.png"
RUN = "?shape=digits/8&seed=1&speed=0.1&until=0.47"


def main() -> None:
    """Starts the server, lets the tiles run to the moment, and takes the picture."""
    with served_page() as url, browser_at(_browser()) as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
        page.goto(url + RUN)
        page.get_by_role("button", name="Go on").wait_for(timeout=120_000)
        page.wait_for_timeout(500)  # what flies has landed
        page.screenshot(path=OUT)
    print(f"{OUT}: {OUT.stat().st_size / 1000:.0f} kB")


def _browser() -> str:
    found = chromium.program()
    if found is None:
        raise SystemExit("page.pictures: no Chromium here; run: make setup-test")
    return found


if __name__ == "__main__":
    main()
