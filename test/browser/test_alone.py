"""One file that replays a recording, from the page or a command, opened from the disk; the page embedded."""

import json
import random
from pathlib import Path
from typing import Any

from axe_playwright_python.sync_playwright import Axe

from support.browser import Visit
from support.page_server import PageServer, page_server
from tilenca import cli


def exported(visit: Visit, server: PageServer, folder: Path, button: str = "Web page") -> Path:
    """A run of half a second in which an 8 comes to be, as the dialog hands it over."""
    visit.page.goto(f"{server.url}?speed=0.5&spread=0.1&until=0.7")
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    visit.page.get_by_role("button", name="Share").click()
    with visit.page.expect_download() as download:
        visit.page.get_by_role("button", name=button).click()
    path = folder / download.value.suggested_filename
    download.value.save_as(path)
    return path


def check_replay(visit: Visit) -> None:
    """It is the run of `exported`, forwards and backwards, and nothing more."""
    page = visit.page
    visit.wait_for_verdict("All 16 tiles show 8")
    page.get_by_role("button", name="Pause").click()
    page.locator("#moment").fill("50")
    visit.wait_until("document.getElementById('clock').textContent === '0.05 s'")
    assert "All" not in visit.verdict
    page.locator("#moment").fill("690")
    visit.wait_for_verdict("All 16 tiles show 8")
    for name in ("Surprise me", "Draw", "Lost bytes"):
        assert page.get_by_role("button", name=name).count() == 0
    assert Axe().run(page).violations_count == 0


def test_the_page_exports_itself_as_one_file_that_opens_from_the_disk(
    visit: Visit, server: PageServer, tmp_path: Path
) -> None:
    path = exported(visit, server, tmp_path)
    assert path.suffix == ".html"
    assert path.stat().st_size < 1_000_000
    visit.requests.clear()
    visit.page.goto(path.as_uri())
    check_replay(visit)
    visit.page.get_by_role("button", name="Share").click()
    assert visit.page.get_by_role("button", name="Web page").count() == 0
    assert [url for url in visit.requests if not url.startswith(("file:", "data:"))] == []


def test_a_command_makes_the_same_of_a_recording_or_serves_it(
    visit: Visit, server: PageServer, tmp_path: Path
) -> None:
    record, out = exported(visit, server, tmp_path, "Record"), tmp_path / "run.html"
    assert cli.main(["page", "--replay", str(record), "--html", str(out)]) == 0
    visit.page.goto(out.as_uri())
    check_replay(visit)
    with page_server(None, ["--replay", str(record)]) as replaying:
        visit.page.goto(replaying.url)
        check_replay(visit)


def test_what_emulated_tiles_said_becomes_a_page(visit: Visit, firmware: Path, tmp_path: Path) -> None:
    record, out = tmp_path / "said.jsonl", tmp_path / "said.html"
    words = "emulate --shape 4 --seconds 1.5 --bootloader none --boot-spread 0.2 --seed 3"
    assert cli.main([*words.split(), "--elf", str(firmware), "--record", str(record)]) == 0
    assert cli.main(["page", "--replay", str(record), "--html", str(out)]) == 0
    visit.page.goto(out.as_uri())
    visit.wait_for_verdict("All 10 tiles show 4")
    visit.page.locator("#fleet .log li").first.wait_for()
    visit.page.locator("[data-port=tile-06]").click()
    visit.page.locator("#inspector .guess", has_text="It shows 4").wait_for()


def test_embedded_there_is_the_board_and_time(visit: Visit, server: PageServer) -> None:
    visit.page.set_viewport_size({"width": 520, "height": 480})
    visit.page.goto(f"{server.url}?embed&speed=0.5&spread=0.1")
    visit.wait_for_verdict("All 16 tiles show 8")
    for gone in ("#drawings", "#top-deeds", "#agreement", ".tools"):
        assert visit.page.locator(gone).is_hidden()
    for stays in (".board", "#timeline", "#speed"):
        assert visit.page.locator(stays).is_visible()
    size = "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    assert visit.page.evaluate(size) == [520, 480]
    visit.pull("tile-11")
    visit.wait_for_verdict("All 15 tiles show 9")
    found = Axe().run(visit.page)
    assert found.violations_count == 0, found.generate_report()
    visit.wait_until("location.search.includes('shape=digits/9')")
    assert "embed" in visit.page.url


def damaged(chance: random.Random, lines: list[str]) -> str:
    """A recording in which one value of one event is another one."""
    events: list[Any] = [json.loads(line) for line in lines]
    event = chance.choice(events)
    place: Any = event
    while True:
        key = chance.choice(list(place) if isinstance(place, dict) else list(range(len(place))))
        deeper = place[key]
        if not isinstance(deeper, dict | list) or not deeper or chance.random() < 0.3:
            break
        place = deeper
    strange: list[Any] = [None, -1, 1e99, "x", "", [], {}, True, [[]], {"time": 0}, "<script>", 2.5]
    if chance.random() < 0.2 and isinstance(place, dict):
        del place[key]
    else:
        place[key] = chance.choice(strange)
    return "".join(f"{json.dumps(one)}\n" for one in events)


def test_no_damaged_recording_breaks_the_page(visit: Visit, server: PageServer, tmp_path: Path) -> None:
    """It is refused with a reason, or it is shown to its end; three hundred of them."""
    lines = exported(visit, server, tmp_path, "Record").read_text().splitlines()
    kinds: dict[str, list[str]] = {}
    for line in lines:  # a few of each kind
        kinds.setdefault(" ".join(json.loads(line)), []).append(line)
    some = [line for line in lines if line in kinds[" ".join(json.loads(line))][:3]]
    chance = random.Random(16)
    texts = [damaged(chance, some) for _ in range(300)]
    outcomes = visit.page.evaluate(
        """async (texts) => {
          const { parseRecording } = await import("./stream/recording_file.js");
          const { openRecording } = await import("./stream/recording.js");
          const { Tiles } = await import("./stream/tiles.js");
          const told = { refused: [], shown: 0, broken: [] };
          for (const text of texts) {
            let events;
            try {
              ({ events } = parseRecording(text));
            } catch (error) {
              told.refused.push(error.message);
              continue;
            }
            try {
              const tiles = new Tiles();
              tiles.take(events);
              tiles.laid().forEach((tile) => [0, 1, 2, 3].map((side) => tiles.cableAt(tile, side)));
              told.shown++;
            } catch (error) {
              told.broken.push(`${error.stack} ${text}`);
            }
          }
          return told;
        }""",
        texts,
    )
    assert outcomes["broken"] == []
    assert len(outcomes["refused"]) > 100
    assert outcomes["shown"] > 10
    assert all(len(words) < 200 for words in outcomes["refused"])
    assert sum(words.startswith("line ") for words in outcomes["refused"]) > 90


def test_a_recording_is_no_way_to_change_what_the_page_knows(visit: Visit, server: PageServer) -> None:
    """What a first event offers is checked, and a display is its pins only."""
    visit.page.goto(server.url)
    told = visit.page.evaluate(
        """async () => {
          const { parseRecording } = await import("./stream/recording_file.js");
          const { openRecording } = await import("./stream/recording.js");
          const { Tiles } = await import("./stream/tiles.js");
          const text = (about, ...more) => [{ time: 0, stream: 1, source: "watched", ...about },
            { time: 0, run: { seed: 1 } }, ...more].map((one) => JSON.stringify(one)).join("\\n");
          const strange = [{ models: {} }, { models: [{ name: "x", id: "1" }] }, { model: 3 },
            { period_ms: "a" }, { period_ms: 0 }, { most_tiles: -1 }, { most_place: 1e9 }, { of: [] }];
          const refused = strange.filter((about) => {
            try {
              parseRecording(text(about));
              return false;
            } catch {
              return true;
            }
          });
          const display = { segments: 1, rgb: [0, 0, 0], leds: "----", port: "other", link: null };
          const models = [{ name: "x", id: "1", labels: ["1"] }];
          const { events } = parseRecording(text({ of: "emulated", period_ms: 20, models },
            { time: 1, port: "tile-01", display }));
          const tiles = new Tiles();
          tiles.take(events);
          const tile = tiles.byPort.get("tile-01");
          const of = await new Promise((resolve) => {
            openRecording(events, { onEvents: ([first]) => resolve(first.of) });
          });
          const { port, link, segments } = tile;
          return { refused: refused.length, all: strange.length, port, link, segments, of };
        }"""
    )
    assert told == {"refused": 8, "all": 8, "port": "tile-01", "link": {}, "segments": 1, "of": "emulated"}
