"""What one can take along: a picture, a recording that the page replays, a link."""

import io
import json
import random
import re
import struct
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from PIL import Image, ImageSequence

from support.browser import Visit
from support.page_server import PageServer
from tilenca.fleet.recording import parse_event
from tilenca.protocol.stream import KINDS


def saved(visit: Visit, button: str, folder: Path) -> Path:
    """The file that a button of the dialog hands over."""
    with visit.page.expect_download() as download:
        visit.page.get_by_role("button", name=button).click()
    path = folder / download.value.suggested_filename
    download.value.save_as(path)
    return path


@pytest.fixture
def shared(visit: Visit, server: PageServer) -> Visit:
    """A run whose 8 has become a 9, standing, with the dialog open."""
    visit.page.goto(f"{server.url}?speed=0.3&spread=0.1&until=0.7")
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.wait_for_verdict("All 16 tiles show 8")
    visit.page.locator("[data-port=tile-11]").focus()
    visit.page.keyboard.press("Delete")
    visit.page.get_by_role("button", name="Go on").click()
    visit.wait_for_verdict("All 15 tiles show 9")
    visit.page.get_by_role("button", name="Pause").click()
    visit.page.get_by_role("button", name="Go on").wait_for()
    visit.page.get_by_role("button", name="Share").click()
    visit.page.locator("#share").wait_for()
    return visit


def test_a_picture_is_a_png_of_the_board(shared: Visit, tmp_path: Path) -> None:
    path = saved(shared, "Picture", tmp_path)
    data = path.read_bytes()
    assert (path.suffix, data[:8]) == (".png", b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", data[16:24])
    assert (width, height) == (4 * 120 + 96, 5 * 120 + 96 + 44)
    assert len(data) > 20_000


def test_a_recording_is_replayed_forwards_and_backwards(shared: Visit, tmp_path: Path) -> None:
    path = saved(shared, "Record", tmp_path)
    shared.page.locator("#notice", has_text=f"It is saved as {path.name}").wait_for()
    events = [json.loads(line) for line in path.read_text().splitlines()]
    assert [next(key for key in event if key in KINDS) for event in events[:2]] == ["stream", "run"]
    times = [event["time"] for event in events]
    assert times == sorted(times)
    assert all(parse_event(json.dumps(event)) for event in events if "raw" in event)
    end = events[-1]["pace"]["end"]
    page = shared.page
    page.set_input_files("#share-file", path)
    shared.wait_until("document.getElementById('notice').textContent.startsWith('A recording')")
    shared.wait_for_verdict("All 15 tiles show 9")
    page.locator("#moment").fill("650")
    shared.wait_for_verdict("All 16 tiles show 8")
    assert f"0.65 of {end:.2f} s" in page.inner_text("#timeline")
    page.locator("[data-port=tile-09]").focus()
    page.keyboard.press("Delete")
    page.locator("#notice", has_text="nothing can be changed").wait_for()
    page.get_by_role("button", name="Go on").click()
    shared.wait_for_verdict("All 15 tiles show 9")
    page.wait_for_selector("[data-port=tile-11]", state="detached")
    page.locator("#moment").fill("650")
    shared.wait_for_verdict("All 16 tiles show 8")
    page.get_by_role("button", name="Back to running tiles").click()
    page.locator("#notice", has_text=f"Back to the run, which stands at {end:.2f} s").wait_for()
    shared.wait_for_verdict("All 15 tiles show 9")
    assert f"{end:.2f} of {end:.2f} s" in page.inner_text("#timeline")
    assert page.get_by_role("button", name="Surprise me").is_visible()


def test_a_recording_that_was_cut_off_is_replayed_as_far_as_it_is_whole(
    shared: Visit, tmp_path: Path
) -> None:
    path = saved(shared, "Record", tmp_path)
    lines = path.read_text().splitlines()
    broken = tmp_path / "broken.jsonl"
    broken.write_text("\n".join([*lines[:-2], lines[-2][:-9]]))
    shared.page.set_input_files("#share-file", broken)
    shared.page.locator("#notice", has_text="Its last line was cut off; it ends before that").wait_for()
    shared.wait_for_verdict("All 15 tiles show 9")
    broken.write_text("\n".join([*lines[:9], lines[9][:-9], *lines[10:]]))  # not its last one
    shared.page.get_by_role("button", name="Share").click()
    shared.page.set_input_files("#share-file", broken)
    shared.page.locator("#notice", has_text="line 10 is no event").wait_for()


def test_a_gif_shows_the_last_seconds(shared: Visit, tmp_path: Path) -> None:
    """From the agreement on 8 to that on 9, in the colours of the page, with its last frame for a while."""
    path = saved(shared, "GIF", tmp_path)
    shared.page.locator("#notice", has_text=f"s is saved as {path.name}").wait_for()
    film = Image.open(path)
    assert film.format == "GIF"
    assert film.size == (round((4 * 120 + 96) * 64 / 120), round((5 * 120 + 96 + 44) * 64 / 120))
    assert film.info["loop"] == 0
    durations, places = [], []
    middle = (film.size[0] // 2 - 3 * 32, 48 * 64 // 120 + 3 * 64 + 32)  # of the place that becomes empty
    for frame in ImageSequence.Iterator(film):
        durations.append(frame.info["duration"])
        places.append(sum(frame.convert("RGB").crop((*middle, middle[0] + 1, middle[1] + 1)).tobytes()))
    end = float(shared.page.inner_text("#clock").removesuffix(" s"))
    assert sum(durations) == pytest.approx(1000 * min(end / 0.3, 5) + 1500, abs=150)
    assert durations[-1] >= 1500
    assert len(durations) > 20
    assert places[0] < 600 < 740 < places[-1]  # a dark tile, and the white board
    corner = film.convert("RGB").getpixel((2, 2))
    assert corner == (255, 255, 255)
    assert path.stat().st_size < 1_000_000


def test_a_gif_has_room_for_tiles_that_have_gone(visit: Visit, server: PageServer) -> None:
    """Twelve columns and then eleven: the film is as wide as at its beginning."""
    visit.page.goto(server.url)
    bright = visit.page.evaluate(
        """async () => {
          const { boardFilm } = await import("./components/film.js");
          const put = (col, time) => ({ time, port: `t${col}`, place: [0, col], tile: col });
          const events = [
            { time: 0, stream: 1, source: "emulated" }, { time: 0, run: { seed: 0, tiles: 12 } },
            ...Array.from({ length: 12 }, (_, col) => put(col, 0)), { time: 0.5, port: "t11", place: null },
          ];
          const film = await boardFilm(events, { from: 0, to: 1, seconds: 1 }, null);
          return [...new Uint8Array(await film.arrayBuffer())];
        }"""
    )
    assert Image.open(io.BytesIO(bytes(bright))).size[0] == round((12 * 120 + 96) * 64 / 120)


def test_of_a_recording_that_is_too_long_no_gif_is_made(visit: Visit, server: PageServer) -> None:
    visit.page.goto(server.url)
    said = visit.page.evaluate(
        """async () => {
          const [{ Recorder }, { Share }, { Tiles }] = await Promise.all(
            ["./stream/recorder.js", "./components/share.js", "./stream/tiles.js"].map((one) => import(one)));
          const recorder = new Recorder();
          recorder.take([{ time: 0, stream: 1 }, { time: 0, run: { seed: 0 } }]);
          recorder.take(Array.from({ length: 250_001 }, (_, time) => ({ time, port: "t", note: "" })));
          const said = [];
          const deeds = { say: (text) => said.push(text) };
          const share = new Share(document.createElement("div"), new Tiles(), recorder, deeds);
          await share.gif();
          return said;
        }"""
    )
    assert len(said) == 1
    assert said[0].startswith("The recording is too long; it has the beginning only, and no GIF")


def test_what_the_gif_encoder_writes_is_what_a_decoder_reads(visit: Visit, server: PageServer) -> None:
    """Noise of all colours fills the table of codes again and again; runs and single pixels are the rest."""
    chance = random.Random(5)
    palette = [[chance.randrange(256) for _ in range(3)] for _ in range(255)]
    width, height = 97, 83
    noise = [chance.randrange(255) for _ in range(width * height)]
    half = [*noise[: width * height // 2], *[7] * (width * height - width * height // 2)]
    dot = [*half]
    dot[5 * width + 9] = 200
    frames = [[3] * (width * height), noise, half, half, dot]
    visit.page.goto(server.url)
    data = visit.page.evaluate(
        """async ([width, height, palette, frames]) => {
          const { Gif } = await import("./components/gif.js");
          const gif = new Gif(width, height, palette);
          frames.forEach((frame, index) => gif.add(Uint8Array.from(frame), 10 * (index + 1)));
          return [...new Uint8Array(await gif.blob().arrayBuffer())];
        }""",
        [width, height, palette, frames],
    )
    film = Image.open(io.BytesIO(bytes(data)))
    read = [
        (frame.info["duration"], list(frame.convert("RGB").getdata()))
        for frame in ImageSequence.Iterator(film)
    ]
    assert [duration for duration, _ in read] == [100, 200, 700, 500]  # two that are alike are one
    for (_, pixels), wanted in zip(read, [frames[0], noise, half, dot], strict=True):
        assert pixels == [tuple(palette[one]) for one in wanted]


def test_a_future_that_was_left_is_not_in_the_recording(shared: Visit, tmp_path: Path) -> None:
    page = shared.page
    page.keyboard.press("Escape")
    page.locator("#moment").fill("650")
    shared.wait_until("document.getElementById('clock').textContent === '0.65 s'")
    page.locator("[data-port=tile-01]").focus()
    page.keyboard.press("Delete")
    page.get_by_role("button", name="One update").click()
    shared.wait_until("document.getElementById('clock').textContent === '0.67 s'")
    page.get_by_role("button", name="Share").click()
    events = [json.loads(line) for line in saved(shared, "Record", tmp_path).read_text().splitlines()]
    assert events[-1]["pace"]["end"] == pytest.approx(0.67, abs=1e-3)
    assert [event["port"] for event in events if event.get("place", 0) is None] == ["tile-01"]


def test_what_is_no_recording_is_refused(shared: Visit, tmp_path: Path) -> None:
    for text, words in (
        ("{}", "line 1 is no event"),
        (
            '{"time": 0, "stream": 1, "source": ""}\n{"time": 0, "run": {"seed": -1}}',
            "line 2 tells of a run",
        ),
        ('{"time": 1, "port": "a", "raw": "$ASK*43"}', "tilenca page --replay shows it"),
        ('{"time": 0, "stream": 99}\n{"time": 0, "run": {"seed": 1}}', "version 99"),
    ):
        file = tmp_path / "some.jsonl"
        file.write_text(text)
        shared.page.set_input_files("#share-file", file)
        shared.page.locator("#notice", has_text=words).wait_for()
    assert shared.verdict == "All 15 tiles show 9"


def test_the_link_is_the_run_with_all_that_hands_did(shared: Visit, tmp_path: Path) -> None:
    """Whoever opens it sees the same at the same moment, to the byte of each state."""
    page = shared.page
    page.keyboard.press("Escape")
    page.locator("[data-port=tile-02]").click()
    page.get_by_role("button", name="Freeze").click()
    for _ in range(5):
        page.get_by_role("button", name="One update").click()
    told = """async () => {
      const { tiles } = await import("./main.js");
      const names = ["port", "place", "label", "margin", "frozen", "segments", "rgb", "leds"];
      return tiles.laid().map((tile) => Object.fromEntries(names.map((name) => [name, tile[name]])));
    }"""
    page.wait_for_selector("[data-port=tile-02][data-state=frozen]")
    page.wait_for_timeout(500)
    before = page.evaluate(told)
    clock = page.inner_text("#clock")
    page.get_by_role("button", name="Share").click()
    page.get_by_label("How it came about").check()
    link = page.input_value("#share-link")
    assert "shape=digits/8" in link
    assert re.findall(r"deed=[\d.]+,(\w+),([^&]+)", link) == [("pull", "11"), ("freeze", "2,1")]
    page.goto(link)
    shared.wait_until(f"document.getElementById('clock').textContent === '{clock}'")
    page.get_by_role("button", name="Go on").wait_for()
    page.wait_for_timeout(300)
    after = page.evaluate(told)
    assert sum(tile["frozen"] for tile in after) == 1
    assert after == before


def test_the_dialog_goes_by_keyboard_and_says_what_it_is(shared: Visit) -> None:
    assert Axe().run(shared.page).violations_count == 0
    shared.page.keyboard.press("Space")  # does not let the run go on
    shared.page.keyboard.press("Escape")
    shared.page.locator("#share").wait_for(state="hidden")
    assert shared.page.get_by_role("button", name="Go on").is_visible()
