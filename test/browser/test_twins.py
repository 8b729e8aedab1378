"""What the page computes itself is what the package computes: sentences, frames, colours, addresses."""

from typing import Any

import pytest
from playwright.sync_api import Page

from support.browser import Visit
from support.page_server import PageServer
from support.vectors import cases
from tilenca.protocol.constants import SETTING_RANGES
from tilenca.protocol.frames import cobs_decode, decode_payload
from tilenca.protocol.sentences import parse_sentence, type_of
from tilenca.protocol.stream_hands import MAX_SKEW_PPM
from tilenca.shapes.glyphs import looks_of, screen_colour


@pytest.fixture
def page(visit: Visit, server: PageServer) -> Page:
    visit.page.goto(server.url)
    return visit.page


def called(page: Page, module: str, function: str, arguments: list[Any]) -> list[Any]:
    """What a function of a module returns for each argument."""
    results: list[Any] = page.evaluate(
        "async ([module, name, all]) => {"
        "  const it = await import(module);"
        "  return all.map((one) => it[name](one));"
        "}",
        [f"/stream/{module}.js", function, arguments],
    )
    return results


def test_sentences_are_read_alike(page: Page) -> None:
    lines = [case[1] for case in cases("sentences.inc")]
    damaged = [line.replace("*", "x*") for line in lines] + [
        "",
        "$",
        "$*00",
        "noise",
        "$FLY*59",
        "$TILE,1*00",
    ]
    read = called(page, "sentences", "parseSentence", [*lines, *damaged])
    for line, found in zip(lines, read, strict=False):
        sentence = parse_sentence(line)
        assert sentence is not None
        assert (found["name"], found["tile"]) == (type_of(sentence), sentence.tile)
        theirs = [
            value for value in vars(sentence).values() if isinstance(value, int) and value != sentence.tile
        ]
        ours = [value for value in found.values() if isinstance(value, int)]
        if found["name"] in ("TILE", "LINK", "TIME", "BOARD"):
            assert [value for value in ours if value != sentence.tile] == theirs, line
    assert read[len(lines) :] == [None] * len(damaged)


def test_frames_are_read_alike(page: Page) -> None:
    wires = [
        (piece, int(case[1]))
        for case in cases("frames.inc")
        for piece in bytes.fromhex(case[2]).split(b"\0")
        if piece
    ]
    read = called(page, "frames", "parseFrame", [wire.hex() for wire, _ in wires])
    good = 0
    for (wire, channels), found in zip(wires, read, strict=True):
        payload = cobs_decode(wire)
        frame = decode_payload(payload, channels) if payload else None
        if frame is not None:
            good += 1
            assert (found["side"], found["tile"], found["sequence"], found["modelId"]) == (
                frame.side, frame.tile, frame.sequence, frame.model_id,
            )  # fmt: skip
            assert [byte - 128 for byte in found["state"]] == list(frame.messages)
        elif found is not None:
            assert len(found["state"]) != channels  # of another model: the page knows no length
    assert good >= 8


def test_lights_have_the_colours_that_terminals_and_films_give_them(page: Page) -> None:
    looks = looks_of(["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", *"AbCdEFHJLPUy-oqtnr"[:12]])
    duties = [list(look.colour) for look in looks] + [[0, 0, 0], [255, 255, 255], [1, 2, 3]]
    for duty, found in zip(duties, called(page, "led", "screenColour", duties), strict=True):
        red, green, blue = duty
        expected = screen_colour((red, green, blue))
        assert found == pytest.approx([255 * part for part in expected], abs=0.51), duty


def test_fields_take_what_commands_take(page: Page) -> None:
    fields = page.evaluate('async () => (await import("/components/settings.js")).FIELDS')
    assert {field["name"]: (field["low"], field["high"]) for field in fields} == {
        name: tuple(SETTING_RANGES[name]) for name in ("period", "brightness")
    }
    page.locator("[data-port=tile-01]").click()
    field = page.get_by_label("Clock too fast")
    assert (field.get_attribute("min"), field.get_attribute("max")) == (f"{-MAX_SKEW_PPM}", f"{MAX_SKEW_PPM}")


def test_an_address_keeps_what_it_says_and_survives_nonsense(page: Page) -> None:
    wanted = page.evaluate(
        """async () => {
          const { readAddress, writeAddress } = await import("/stream/address.js");
          const drawings = [{ name: "digits/1", label: "1", rows: ["#", "#"] }];
          const read = (query) => readAddress(query, drawings);
          const start = read("?draw=101-111&seed=7&speed=0.3&fault=cut@1E&fault=loss=0.1&spread=2&until=1.5"
            + "&model=D968&deed=0.65,pull,4&deed=1,arrange,101-111,-2,3&deed=2,cut,13W,0&deed=3,noise,0.05"
            + "&deed=4,fly,1&deed=x,pull,1&deed=5");
          const again = read(writeAddress(start, drawings));
          const odd = read("?shape=none&draw=xyz&seed=-1&speed=fast&until=&spread=1e99&fault=");
          const moved = { ...start, cells: [[4, 4], [5, 4]] };
          return { start, again, odd, known: writeAddress(moved, drawings) };
        }"""
    )
    assert wanted["again"] == wanted["start"]
    assert [(one["time"], one["deed"]) for one in wanted["start"]["deeds"]] == [
        (0.65, {"do": "pull", "port": "tile-04"}),
        (1, {"do": "arrange", "cells": [[-2, 3], [-2, 5], [-1, 3], [-1, 4], [-1, 5]]}),
        (2, {"do": "cut", "port": "tile-13", "side": "W", "on": False}),
        (3, {"do": "noise", "loss": 0.05}),
    ]
    assert wanted["start"]["faults"] == ["cut@1E", "loss=0.1"]
    assert wanted["odd"] == {
        "cells": [[0, 0], [1, 0]], "seed": 0, "speed": 0.1, "faults": [""], "spread": 0.25,
        "until": None, "model": "", "deeds": [],
    }  # fmt: skip
    assert wanted["known"].startswith("?shape=digits/1&seed=7")
