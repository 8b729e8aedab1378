"""Tiles on USB straight from the page, with the stock bootloader behind a stand-in for Web Serial."""

import random
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from support.bootloader_stand_in import ATMEGA_328P, StandIn
from support.browser import Visit
from support.intel_hex import image
from support.page_server import TILENCA
from support.serial_bridge import Bridge, bridged_page, stand_in
from tilenca.base import paths
from tilenca.emulator.serve import STOCK_BOOTLOADER
from tilenca.fleet.image import check_image, parse_hex
from tilenca.page.alone import BEHIND
from tilenca.protocol.sentences import HelloSentence, format_sentence

NAMES = ("tile-01", "tile-02")
PROGRAM_FLASH = 0x13
# A weight of the first layer: the tiles run as ever, and are told apart by it.
CHANGED = 0x3400
PAIR = '[[shape]]\nlabel = "1"\ngrid = "##"\n'


@contextmanager
def served_pair(folder: Path, firmware: Path) -> Iterator[dict[str, Path]]:
    """Two emulated tiles with the stock bootloader; their ports by name."""
    shapes = folder / "pair.toml"
    shapes.write_text(PAIR)
    words = ["--shapes", shapes, "--elf", firmware, "--serve", folder / "tiles", "--boot-spread", "0"]
    command = [str(TILENCA), "emulate", *map(str, words)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        assert "serving 2 tiles" in process.stderr.readline()
        yield {name: folder / "tiles" / name for name in NAMES}
    finally:
        process.terminate()
        process.communicate(timeout=60)


def changed_image(firmware: Path, folder: Path) -> Path:
    """The firmware with another weight."""
    memory = parse_hex(firmware.with_suffix(".hex").read_text())
    memory[CHANGED] ^= 1
    path = folder / "changed.hex"
    path.write_text(image(bytes(memory.get(at, 0xFF) for at in range(max(memory) + 1))))
    return path


def rows(page: Page) -> list[str]:
    """What each tile's entry says."""
    return [" ".join(row.inner_text().split()) for row in page.locator("#usb li").all()]


def flash(page: Page, path: Path) -> None:
    page.locator("#usb-file").set_input_files(path)
    page.get_by_role("button", name="Flash all tiles").click()


def wait_for_status(page: Page, text: str) -> None:
    """Waits for it as long as the tiles get on: a busy machine is slow, and not wrong."""
    status, before = page.locator("#usb [role=status]"), [""]
    while rows(page) != before:
        before = rows(page)
        with suppress(PlaywrightTimeoutError):
            status.filter(has_text=text).wait_for()
            return
    raise AssertionError(f"it came to '{status.inner_text()}', not to '{text}': {before}")


class Cables:
    """What happens on the way to the boards: one page is damaged, and one cable is pulled."""

    def __init__(self, damaged: str, pulled: str, bridge: Bridge) -> None:
        self._pages = {damaged: 0, pulled: 0}
        self._damaged, self._pulled, self._bridge = damaged, pulled, bridge

    def __call__(self, name: str, data: bytes) -> bytes | None:
        if len(data) < 6 or data[5] != PROGRAM_FLASH:
            return data
        self._pages[name] += 1
        if (name, self._pages[name]) == (self._pulled, 20):
            self._bridge.pulled.add(name)
            return None
        if (name, self._pages[name]) == (self._damaged, 3):
            wrong = bytearray(data)
            wrong[20] ^= 4
            wrong[-1] ^= 4  # its checksum is right: only reading it back finds it
            return bytes(wrong)
        return data


@pytest.mark.skipif(
    not STOCK_BOOTLOADER.exists(), reason="the stock bootloader is in Debian's arduino-core-avr"
)
def test_tiles_are_watched_and_flashed_side_by_side(visit: Visit, firmware: Path, tmp_path: Path) -> None:
    page = visit.page
    new = changed_image(firmware, tmp_path)
    old_id, new_id = (f"{check_image(path).firmware_id:08X}" for path in (firmware.with_suffix(".hex"), new))
    with served_pair(tmp_path, firmware) as ports, bridged_page(ports) as bridge:
        page.add_init_script(stand_in([], list(NAMES)))
        page.goto(bridge.url)
        page.get_by_role("button", name="Connect tiles").click()
        page.get_by_role("button", name="Add a tile…").click()
        visit.wait_for_verdict("All 2 tiles show")
        visit.wait_until(f"document.querySelector('#usb ul').textContent.split('{old_id}').length === 3")
        freeze(visit)
        bridge.passing = Cables("tile-01", "tile-02", bridge)
        flash(page, new)
        wait_for_status(page, "failed: see below.")
        if "verification failed" in rows(page)[0]:  # a busy machine missed the bootloader's second
            page.get_by_role("button", name="Flash all tiles").click()
        wait_for_status(page, "1 tile flashed. 1 failed: see below.")
        first, second = rows(page)
        assert f"firmware {new_id} flashed; it runs this firmware" in first
        assert "away the board went away; connect it and flash it again, its bootloader is intact" in second
        tries = bridge.resets["tile-01"]
        assert tries >= 2  # a damaged page
        resets = bridge.resets["tile-02"]
        assert resets >= 1
        page.locator(".log .bad", has_text="not flashed: the board went away").wait_for()
        bridge.pulled.clear()
        page.evaluate("navigator.serial.plug('tile-02')")
        visit.wait_until(f"document.querySelector('#usb ul').textContent.includes('{old_id}')")
        page.get_by_role("button", name="Flash all tiles").click()
        wait_for_status(page, "1 tile flashed. 1 had it already.")
        assert [new_id in row for row in rows(page)] == [True, True], rows(page)
        assert bridge.resets["tile-01"] == tries  # it was left alone
        assert bridge.resets["tile-02"] > resets
        visit.wait_for_verdict("All 2 tiles show")
        assert Axe().run(page).violations_count == 0
        page.get_by_role("button", name="Disconnect all").click()
        visit.wait_for_verdict("No tile yet")  # that is what stood behind the page before
        assert page.locator("#usb").is_hidden()
        page.goto("about:blank")  # else it looks for the server that ends


def freeze(visit: Visit) -> None:
    """A tile takes commands."""
    visit.page.locator(".tile").first.click()
    inspector = visit.page.locator("#inspector")
    inspector.get_by_role("button", name="Freeze").click()
    visit.page.wait_for_selector(".tile[data-state=frozen]")
    inspector.get_by_role("button", name="Thaw").click()
    visit.page.wait_for_selector(".tile[data-state=frozen]", state="detached")
    inspector.get_by_role("button", name="Blink").click()
    visit.page.locator(".log li", has_text="BLINK 5").wait_for()
    inspector.get_by_role("button", name="Close").click()


def test_an_image_that_hangs_bootloaders_is_refused(visit: Visit, tmp_path: Path) -> None:
    page = visit.page
    path = tmp_path / "poison.hex"
    path.write_text(image(b"abc!!!def"))
    board = StandIn()
    with board, bridged_page({"one": Path(board.port)}) as bridge:
        page.add_init_script(stand_in(["one"], []))
        page.goto(bridge.url)
        page.get_by_role("button", name="Connect tiles").click()
        page.locator("#usb-file").set_input_files(path)
        page.locator(
            "#usb .bad", has_text="poison.hex: the bytes '!!!' at 0x3 hang some Mega boot"
        ).wait_for()
        assert page.get_by_role("button", name="Flash all tiles").is_disabled()
        page.get_by_role("button", name="Add a tile…").click()
        page.locator("#notice", has_text="No port was chosen").wait_for()
        page.goto("about:blank")
    assert board.pages == 0


def test_the_folder_of_files_brings_its_own_firmware(visit: Visit, firmware: Path) -> None:
    page = visit.page
    # The emulator itself is not built here, and a document that a test made up may not reach the port.
    visit.forgiven = ("404", "LOCAL_NETWORK_ACCESS")
    document = (
        (paths.PAGE / "index.html").read_text().replace(BEHIND.format("server"), BEHIND.format("emulator"))
    )
    image_id = f"{check_image(firmware.with_suffix('.hex')).firmware_id:08X}"
    board = StandIn()
    with board, bridged_page({"one": Path(board.port)}) as bridge:
        page.add_init_script(stand_in(["one"], []))
        page.route(bridge.url, lambda route: route.fulfill(body=document, content_type="text/html"))
        page.route("**/emulator/firmware.elf", lambda route: route.fulfill(body=firmware.read_bytes()))
        page.goto(bridge.url)
        page.get_by_role("button", name="Connect tiles").click()
        page.get_by_role("button", name="Take the firmware of this page").click()
        page.locator("#usb-about", has_text=f"firmware id {image_id}").wait_for()
        assert page.get_by_role("button", name="Flash all tiles").is_enabled()
        page.goto("about:blank")


def test_an_image_beyond_64_ki_words_goes_in_whole(visit: Visit, tmp_path: Path) -> None:
    data = bytes(random.Random(1).randrange(34, 256) for _ in range(132 * 1024 + 77))
    path = tmp_path / "large.hex"
    path.write_text(image(data))
    board = StandIn(greeting=hello(check_image(path).firmware_id, 1))
    page = visit.page
    with board, bridged_page({"one": Path(board.port)}) as bridge:
        page.add_init_script(stand_in(["one"], []))
        page.goto(bridge.url)
        page.get_by_role("button", name="Connect tiles").click()
        flash(page, path)
        wait_for_status(page, "1 tile flashed.")
        page.goto("about:blank")
    assert board.flash[: len(data)] == data
    assert set(board.flash[len(data) :]) == {0xFF}


def hello(firmware_id: int, tile: int) -> bytes:
    return format_sentence(HelloSentence(3, tile, 0x1234, 21, 11, 20, 0, 2, firmware_id, 255))


def test_a_board_that_fails_says_what_to_do_and_others_go_on(visit: Visit, tmp_path: Path) -> None:
    data = bytes(range(256)) * 16
    path = tmp_path / "small.hex"
    path.write_text(image(data))
    firmware_id = check_image(path).firmware_id
    other = StandIn(greeting=hello(0xBAD, 9))
    boards = {
        "good": StandIn(greeting=hello(firmware_id, 1)),
        "decayed": StandIn(decayed=0x123),
        "wrong": StandIn(signature=ATMEGA_328P),
        "silent": StandIn(silent=True),
        "gone": StandIn(gone_after=5),
        "loose": StandIn(decayed=0x300, recovers=True, greeting=hello(firmware_id, 2)),
        "other": other,
    }
    with ExitStack() as stack:
        ports = {name: Path(stack.enter_context(board).port) for name, board in boards.items()}
        bridge = stack.enter_context(bridged_page(ports))
        page = visit.page
        page.add_init_script(stand_in(list(boards), []))
        page.goto(bridge.url)
        page.get_by_role("button", name="Connect tiles").click()
        flash(page, path)
        wait_for_status(page, "2 tiles flashed. 5 failed: see below.")
        told = dict(zip(boards, rows(page), strict=True))
        assert "runs this firmware" in told["good"]
        assert (
            "verification failed at 0x123; flash it again, and if it repeats change the cable"
            in told["decayed"]
        )
        assert "wrong chip: its signature is 0x1E950F" in told["wrong"]
        assert "no reply from a Mega's bootloader" in told["silent"]
        assert "the board went away; connect it and flash it again" in told["gone"]
        assert "runs this firmware" in told["loose"]
        assert "says it runs firmware 00000BAD" in told["other"]
        for name in ("good", "loose", "other"):
            assert boards[name].flash[: len(data)] == data
        # What is damaged is tried twice; the others once, or again where a busy machine was too slow.
        assert {name: bridge.resets[name] for name in ("decayed", "silent", "loose")} == dict.fromkeys(
            ("decayed", "silent", "loose"), 2
        )
        assert all(bridge.resets[name] >= 1 for name in ("good", "wrong", "gone", "other"))
        page.goto("about:blank")
