"""What the page needs for real tiles is what the package computes: images, lines, places, commands."""

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from support.browser import Visit
from support.heard_fleet import link
from support.intel_hex import END, image, record
from support.page_server import PageServer
from support.vectors import cases
from tilenca.base.errors import UsageError
from tilenca.fleet.image import APPLICATION_BYTES, HexError, check_image, firmware_id, parse_hex
from tilenca.fleet.layout import arrange
from tilenca.fleet.link_health import FAILING, LinkHealth
from tilenca.protocol.commands import ask_command, blink_command, restart_command, set_command
from tilenca.protocol.line_reader import LineReader


@pytest.fixture
def page(visit: Visit, server: PageServer) -> Page:
    visit.page.goto(server.url)
    return visit.page


def told(page: Page, body: str, argument: Any) -> Any:
    """What a program with an argument returns in the page."""
    return page.evaluate(f"async (all) => {{ {body} }}", argument)


def hex_texts() -> list[str]:
    chance = random.Random(4)
    good = image(bytes(chance.randrange(256) for _ in range(100)), 0xFFF0)
    texts = [
        good, good.lower(), good.replace("\n", "\r\n"), good.replace("\n", "\n\n"), good.replace(END, ""),
        record(0, 2, b"\x10\x00") + record(2, 0, b"x") + END, record(0, 0, b"a") * 2 + END, END, "",
        record(0, 3, b"\0\0\0\0") + record(0, 5, b"\0\0\0\0") + record(3, 0, b"ab") + END + "what follows",
        record(0, 7, b"a") + END, record(0, 4, b"a") + END, ":00", ":0", "00000001FF", ": 00000001FF",
    ]  # fmt: skip
    for _ in range(150):
        text = list(good)
        text[chance.randrange(len(text))] = chance.choice("0123456789ABCDEFabcdef:\n\r g")
        texts.append("".join(text))
    return texts


def test_images_are_read_alike(page: Page) -> None:
    texts = hex_texts()
    read = told(
        page,
        """const { parseHex, checkMemory } = await import("/stream/intel_hex.js");
        return all.map((text) => {
          try {
            const memory = parseHex(text);
            const id = memory.size ? checkMemory("it", memory).firmwareId : "";
            return [[...memory].sort((a, b) => a[0] - b[0]), id];
          } catch (error) {
            return error.message;
          }
        });""",
        texts,
    )
    expected = [parsed(text) for text in texts]
    assert read == expected
    assert 50 < sum(isinstance(one, str) for one in expected) < len(texts) - 5


def parsed(text: str) -> Any:
    """The bytes by address and the firmware id, or what is wrong."""
    try:
        memory = parse_hex(text)
    except HexError as error:
        return str(error)
    return [[list(one) for one in sorted(memory.items())], f"{firmware_id(memory):08X}" if memory else ""]


def checked(path: Path) -> Any:
    """Size and firmware id, or why it is refused, in the words of the page."""
    try:
        image = check_image(path)
    except UsageError as error:
        return str(error).removeprefix(f"{path.parent}/").replace("name the", "choose the").replace("`", "")
    return [image.size, f"{image.firmware_id:08X}"]


def test_the_same_images_are_refused(page: Page, tmp_path: Path) -> None:
    path = tmp_path / "it.hex"
    contents = [
        image(b"x" * 14 + b"!!!" + b"y" * 9).encode(), image(b"x" * 40, APPLICATION_BYTES - 39).encode(),
        b"\xff:", END.encode(), b"", b"no image", image(b"abc").replace("61", "62").encode(),
        image(b"!!" + b"x" * 14, APPLICATION_BYTES - 16).encode(), b"\n " + image(b"!!x!").encode(),
    ]  # fmt: skip
    read = told(
        page,
        """const { readImage } = await import("/stream/intel_hex.js");
        return all.map((bytes) => {
          try {
            const { size, firmwareId } = readImage("it.hex", Uint8Array.from(bytes));
            return [size, firmwareId];
          } catch (error) {
            return error.message;
          }
        });""",
        [list(content) for content in contents],
    )
    for content, found in zip(contents, read, strict=True):
        path.write_bytes(content)
        assert found == checked(path)
    assert [isinstance(found, str) for found in read] == [True] * 7 + [False] * 2


def test_lines_are_cut_alike(page: Page) -> None:
    chance = random.Random(5)
    sentences = [f"{case[1]}\r\n".encode() for case in cases("sentences.inc")]
    stream = bytearray(b"tail of one\r\n")
    for _ in range(200):
        stream += chance.choice(sentences)
        if chance.random() < 0.2:
            stream[chance.randrange(len(stream))] = chance.choice(b"$*\r\n \xa0\x80A")
    stream += b"z" * 300 + sentences[0]
    pieces = []
    while stream:
        size = chance.randrange(1, 60)
        pieces.append(bytes(stream[:size]))
        del stream[:size]
    reader = LineReader()
    expected = [[raw.decode("latin-1") for raw, _ in reader.feed(piece)] for piece in pieces]
    assert sum(map(len, expected)) > 200
    assert expected == told(
        page,
        """const { LineReader } = await import("/stream/line_reader.js");
        const reader = new LineReader();
        return all.map((piece) => reader.feed(Uint8Array.from(piece)));""",
        [list(piece) for piece in pieces],
    )


def test_tiles_are_laid_out_alike(page: Page) -> None:
    chance = random.Random(6)
    worlds = []
    for _ in range(80):
        places = {(chance.randrange(5), chance.randrange(5)) for _ in range(chance.randrange(1, 12))}
        ids = dict(zip(sorted(places), chance.sample(range(1, 60), len(places)), strict=True))
        world: dict[int, dict[str, tuple[int, str]]] = {}
        for (row, col), tile in ids.items():
            beside = {"N": (row - 1, col), "E": (row, col + 1), "S": (row + 1, col), "W": (row, col - 1)}
            heard = {
                side: (ids[place], "SWNE"["NESW".index(side)])
                for side, place in beside.items()
                if place in ids
            }
            world[tile] = {side: heard[side] for side in heard if chance.random() < 0.8}
        if chance.random() < 0.3:  # they contradict each other
            world[chance.choice(list(ids.values()))]["N"] = (
                chance.choice(list(ids.values())),
                chance.choice("NESW"),
            )
        worlds.append(world)
    read = told(
        page,
        """const { arrange } = await import("/stream/layout.js");
        return all.map((world) => {
          const neighbours = new Map(world.map(([tile, sides]) => [tile, new Map(sides)]));
          const { cells, conflicts } = arrange(neighbours);
          return [[...cells].sort((a, b) => a[0] - b[0]), conflicts];
        });""",
        [[[tile, list(sides.items())] for tile, sides in world.items()] for world in worlds],
    )
    for world, (cells, conflicts) in zip(worlds, read, strict=True):
        found = arrange(world)
        assert cells == [[tile, list(found.cells[tile])] for tile in sorted(found.cells)]
        assert conflicts == len(found.conflicts)


def test_links_are_judged_alike(page: Page) -> None:
    chance = random.Random(7)
    worlds: list[list[dict[str, int]]] = []
    for _ in range(60):
        counts = dict.fromkeys(("received", "lost", "corrupt", "foreign"), 0)
        loss, uptime_ms, world = chance.choice([0.0, 0.05, 0.4]), 0, []
        silent = chance.random() < 0.3
        for _ in range(chance.randrange(0, 12)):
            uptime_ms += chance.randrange(100, 4000)
            if chance.random() < 0.05:
                counts, uptime_ms = dict.fromkeys(counts, 0), 0
            sent = 0 if silent else chance.randrange(30)
            counts["lost"] += (lost := sum(chance.random() < loss for _ in range(sent)))
            counts["received"] += sent - lost
            counts["corrupt"] += chance.choice([0, 3, 9])
            counts["foreign"] += chance.random() < 0.02
            world.append({**counts, "uptimeMs": uptime_ms})
        worlds.append(world)
    read = told(
        page,
        """const { LinkHealth } = await import("/stream/link_health.js");
        return all.map((world) => {
          const health = new LinkHealth();
          for (const report of world) health.take(report);
          return [health.good, health.mark(true), health.mark(false)];
        });""",
        worlds,
    )
    for world, (good, linked, alone) in zip(worlds, read, strict=True):
        health = LinkHealth()
        for one in world:
            report = link(1, "N", 2, one["uptimeMs"], one["received"], one["lost"])
            health.take(replace(report, corrupt=one["corrupt"], foreign=one["foreign"]))
        assert good == health.good
        assert linked == ("failing" if health.good is not None and health.good < FAILING else "well")
        assert alone == ("foreign" if health.foreign else "dead" if health.garbled else "")
    assert {mark for _, linked, alone in read for mark in (linked, alone)} == {
        "well", "failing", "foreign", "dead", "",
    }  # fmt: skip


def test_commands_are_framed_alike(page: Page) -> None:
    commands = [ask_command(), blink_command(5), restart_command(), set_command("period", 20)]
    assert commands == [
        text.encode()
        for text in told(
            page,
            """const { framed } = await import("/stream/sentences.js");
            return all.map(framed);""",
            ["ASK", "BLINK,5", "RESTART", "SET,period,20"],
        )
    ]


def test_an_elf_file_has_the_flash_of_its_hex_file(page: Page, firmware: Path) -> None:
    read = told(
        page,
        """const { parseElf } = await import("/stream/elf.js");
        const { checkMemory } = await import("/stream/intel_hex.js");
        return all.map((bytes) => {
          try {
            const { size, firmwareId } = checkMemory("it", parseElf("it", Uint8Array.from(bytes)));
            return [size, firmwareId];
          } catch (error) {
            return error.message;
          }
        });""",
        [list(firmware.read_bytes()), list(b"\x7fELF no more")],
    )
    assert read == [checked(firmware.with_suffix(".hex")), "it: not an ELF file of a firmware"]
