"""Ports of the browser come, go and come anew, and several want to write at once."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from support.bootloader_stand_in import StandIn
from support.browser import Visit
from support.intel_hex import image
from support.serial_bridge import Bridge, bridged_page, stand_in
from tilenca.protocol.sentences import HelloSentence, format_sentence

BOARDS = ("one", "two", "three")


def hello(tile: int) -> str:
    """What a tile says at its start."""
    sentence = format_sentence(HelloSentence(3, tile, 0x1234, 21, 11, 20, 0, 2, 0xBAD, 255))
    return sentence.decode()


@pytest.fixture
def boards() -> Iterator[Bridge]:
    """The page, and boards that say nothing."""
    with ExitStack() as stack:
        ports = {name: Path(stack.enter_context(StandIn()).port) for name in BOARDS}
        yield stack.enter_context(bridged_page(ports))


@pytest.fixture
def connected(visit: Visit, boards: Bridge) -> Iterator[Visit]:
    """The page with two of them connected."""
    visit.page.add_init_script(stand_in(list(BOARDS[:2]), [BOARDS[2]]))
    visit.page.goto(boards.url)
    visit.page.get_by_role("button", name="Connect tiles").click()
    wait_for_rows(visit, [False, False])
    yield visit
    visit.page.goto("about:blank")  # else it looks for the server that ends


def wait_for_rows(visit: Visit, away: list[bool]) -> None:
    """Waits until the panel has a row for each tile, and says which of them are away."""
    texts = "[...document.querySelectorAll('#usb li')].map((row) => row.textContent.includes('away'))"
    visit.wait_until(f"{texts}.join() === '{','.join(str(one).lower() for one in away)}'")


def test_a_tile_that_was_unplugged_comes_back_behind_another_port(connected: Visit) -> None:
    page = connected.page
    page.evaluate("['one', 'two'].forEach(navigator.serial.unplug)")
    wait_for_rows(connected, [True, True])
    page.evaluate("navigator.serial.plug('two')")
    wait_for_rows(connected, [False, True])
    page.evaluate("navigator.serial.plug('one')")
    wait_for_rows(connected, [False, False])
    page.evaluate("navigator.serial.plug('three')")  # the browser lends it from an earlier visit
    wait_for_rows(connected, [False, False, False])


def test_a_board_of_another_kind_is_another_tile(connected: Visit) -> None:
    page = connected.page
    page.evaluate("navigator.serial.unplug('one')")
    wait_for_rows(connected, [True, False])
    page.evaluate("navigator.serial.kinds.three = 0x0010")
    page.get_by_role("button", name="Add a tile…").click()
    wait_for_rows(connected, [True, False, False])


def test_a_recording_takes_the_place_of_tiles_and_they_come_again(connected: Visit, tmp_path: Path) -> None:
    """What is recorded is what is shown by then."""
    page = connected.page
    file = tmp_path / "said.jsonl"
    file.write_text(
        '{"time": 0, "stream": 1, "source": "emulated"}\n'
        '{"time": 0, "run": {"seed": 77, "shape": "-", "tiles": 0}}\n{"time": 3, "port": "a", "open": true}\n'
    )
    path = tmp_path / "small.hex"
    path.write_text(image(b"small"))
    page.locator("#usb-file").set_input_files(path)
    page.get_by_role("button", name="Flash all tiles").click()
    page.set_input_files("#share-file", file)
    page.locator("#notice", has_text="Tiles are being flashed; wait").wait_for()
    page.locator("#usb [role=status]", has_text="2 failed").wait_for()  # they never say what they run
    assert page.inner_text("#clock") != "3.00 s"
    page.set_input_files("#share-file", file)
    page.locator("#usb").wait_for(state="hidden")
    page.get_by_role("button", name="Connect tiles").click()
    wait_for_rows(connected, [False, False])
    page.get_by_role("button", name="Share").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Record").click()
    events = [json.loads(line) for line in Path(download.value.path()).read_text().splitlines()]
    assert events[0]["source"] == "watched"
    assert events[1]["run"]["seed"] == 0
    assert {event["port"] for event in events if "open" in event} == {"usb-1", "usb-2"}


# A port that takes its time: `said` is what the board says when it is opened, `written` what it was told.
SLOW = """
  const written = [];
  const port = (said = "") => ({
    opened: 0, written,
    getInfo: () => ({}),
    async open() {
      this.opened++;
      await new Promise((resolve) => setTimeout(resolve, 50));
      this.readable = new ReadableStream({
        start: (controller) => { if (said) controller.enqueue(new TextEncoder().encode(said)); },
      });
      this.writable = new WritableStream({
        write: (bytes) => new Promise((resolve) => setTimeout(() => resolve(written.push([...bytes])), 50)),
      });
    },
    close: async () => {},
    setSignals: async () => {},
  });
"""


def told(visit: Visit, boards: Bridge, body: str, argument: str = "") -> Any:
    """What a program returns in the page; `port` makes a port."""
    visit.page.goto(boards.url)
    found = visit.page.evaluate(f"async (argument) => {{ {SLOW} {body} }}", argument)
    visit.page.goto("about:blank")
    return found


def test_who_writes_at_once_writes_one_after_the_other(visit: Visit, boards: Bridge) -> None:
    found = told(
        visit,
        boards,
        """const { BytePort, GoneError } = await import("/stream/serial.js");
        const one = new BytePort(port());
        await one.open();
        await Promise.all([[1], [2, 3], [4]].map((bytes) => one.write(Uint8Array.from(bytes))));
        one.port.writable.getWriter();  // somebody else has it
        const ends = await Promise.allSettled([one.write(Uint8Array.of(5)), one.write(Uint8Array.of(6))]);
        return [written, ends.map(({ reason }) => reason instanceof GoneError)];""",
    )
    assert found == [[[1], [2, 3], [4]], [True, True]]


def test_a_tile_is_opened_once_and_an_error_that_nobody_thought_of_is_told(
    visit: Visit, boards: Bridge
) -> None:
    opened, results = told(
        visit,
        boards,
        """const { UsbTile } = await import("/stream/usb_tile.js");
        const one = new UsbTile("usb-1", port(argument), () => {});
        await Promise.all([one.open(), one.open()]);
        await one.flash({ firmwareId: "0", flash: null });
        const { result, error } = one.flashing;
        await one.close();
        return [one.webPort.opened, [result, error, one.isBusy]];""",
        hello(7),
    )
    assert opened == 1
    assert results[0] == "failed"
    assert results[1].startswith("it did not work (TypeError")
    assert results[2] is False
