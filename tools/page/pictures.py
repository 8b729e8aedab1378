"""Makes the picture of the page for the documents: python -m page.pictures, with tools on the path.

The run pauses at the moment of the picture, so that the tiles are the same every time.
"""

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from bench import chromium

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "docs" / "images" / "page.png"
RUN = "?shape=digits/8&seed=1&speed=0.1&until=0.47"


def main() -> None:
    """Starts the server, lets the tiles run to the moment, and takes the picture."""
    command = [sys.executable, "-P", "-m", "tilenca.cli", "page", "--no-open", "--listen", "127.0.0.1:0"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    try:
        assert server.stdout is not None
        url = server.stdout.readline().strip()
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=_browser(), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
            page.goto(url + RUN)
            page.get_by_role("button", name="Go on").wait_for(timeout=120_000)
            page.wait_for_timeout(500)  # what flies has landed
            page.screenshot(path=OUT)
            browser.close()
    finally:
        server.terminate()
        server.wait(60)
    print(f"{OUT}: {OUT.stat().st_size / 1000:.0f} kB")


def _browser() -> str:
    found = chromium.program()
    if found is None:
        raise SystemExit("page.pictures: no Chromium here; run: make setup-test")
    return found


if __name__ == "__main__":
    main()
