"""A lab on real parts: twenty emulated tiles with the stock bootloader, real avrdude, real firmware."""

import json
import os
import pty
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from support.intel_hex import image
from support.lab import Lab
from support.terminal import read_until
from tilenca.fleet.image import check_image
from tilenca.fleet.tiles_file import read_tiles

# Only a hang takes so long; a busy machine may take minutes for what takes an idle one seconds.
LIMIT_S = 1200
# Twenty programmers on a busy machine wait for it, which only lengthens what is measured.
TRIES = 3
ROWS = ["####"] * 5


@pytest.fixture(scope="module")
def lab(firmware: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """Twenty tiles; commands run in its folder, where the `tiles.toml` is that they have written."""
    with Lab(firmware, tmp_path_factory.mktemp("lab"), ROWS) as lab:
        tilenca(lab, "devices", "--learn", "--port", lab.pattern)
        yield lab


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "tilenca.cli", *arguments]


def tilenca(lab: Lab, *arguments: str, status: int = 0, typed: str = "") -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        command(*arguments),
        cwd=lab.folder,
        env=lab.environment,
        input=typed,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == status, done.stderr
    assert "Traceback" not in done.stderr
    return done


def results(done: subprocess.CompletedProcess[str]) -> list[str]:
    return [tile["result"] for tile in json.loads(done.stdout)["tiles"]]


def test_the_tiles_say_who_they_are_and_where_they_lie(lab: Lab) -> None:
    document = json.loads(tilenca(lab, "devices", "--learn", "--port", lab.pattern, "--json").stdout)
    assert [device["tile"] for device in document["devices"]] == list(range(1, 21))
    places = {place.tile: (place.row, place.col) for place in read_tiles(lab.folder / "tiles.toml")}
    assert places == {4 * row + col + 1: (row, col) for row in range(5) for col in range(4)}


def test_twenty_take_no_longer_than_one_and_who_has_the_image_is_skipped(
    lab: Lab, lone_tile: Lab, firmware: Path
) -> None:
    ours = check_image(firmware.with_suffix(".hex"))
    flash = ["flash", "--json", "--hex", str(ours.path)]
    ratios = []
    for _ in range(TRIES):
        lone_tile.talks_s.clear()
        tilenca(lone_tile, *flash, "--force", "--port", lone_tile.port(1))
        one_s = lone_tile.talks_s[-1] - lone_tile.talks_s[0]
        lab.talks_s.clear()
        done = tilenca(lab, *flash, "--force")
        ratios.append((lab.talks_s[-1] - lab.talks_s[0]) / one_s)
        if ratios[-1] <= 1.3:
            break
    assert results(done) == ["flashed"] * 20
    tiles = json.loads(done.stdout)["tiles"]
    assert {tile["firmware_id"] for tile in tiles} == {f"{ours.firmware_id:08X}"}
    assert [tile["tile"] for tile in tiles] == list(range(1, 21))
    assert one_s > 2 * ours.size / 11_520, "written and read at 115200 baud"
    assert min(ratios) <= 1.3, ratios
    assert results(tilenca(lab, *flash)) == ["skipped"] * 20


def test_a_tile_unplugged_in_the_middle_is_told_and_flashed_by_the_next_call(
    lab: Lab, firmware: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other.hex"
    other.write_text(image(b"\xff\xcf" * 20_000))
    with subprocess.Popen(
        command("flash", "--json", "--hex", str(other), "--force", "--only", "7"),
        cwd=lab.folder,
        env=lab.environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as flashing:
        assert flashing.stderr is not None
        assert any(line.endswith("writing\n") for line in flashing.stderr), "it never wrote"
        lab.pass_time(1.0)
        lab.unplug(7)
        output, _ = flashing.communicate(timeout=LIMIT_S)
    assert flashing.returncode == 1
    [tile] = json.loads(output)["tiles"]
    assert tile["error"] == "the board went away; connect it and flash it again, its bootloader is intact"
    flash = ["flash", "--json", "--hex", str(firmware.with_suffix(".hex"))]
    assert results(tilenca(lab, *flash, status=1)) == ["skipped"] * 19 + ["missing"]
    lab.plug(7)
    [tile] = json.loads(tilenca(lab, *flash, "--failed").stdout)["tiles"]
    assert (tile["tile"], tile["result"], tile["error"]) == (7, "flashed", None)


def test_a_setting_reaches_the_tiles_that_are_meant_and_is_read_back(lab: Lab) -> None:
    done = tilenca(lab, "set", "brightness", "77", "--tile", "3,5-6", "--json")
    tiles = json.loads(done.stdout)["tiles"]
    assert [(tile["tile"], tile["result"]) for tile in tiles] == [(3, "set"), (5, "set"), (6, "set")]
    everybody = json.loads(tilenca(lab, "set", "period", "120", "--json").stdout)["tiles"]
    assert {tile["settings"]["period"] for tile in everybody} == {120}
    assert [t["tile"] for t in everybody if t["settings"]["brightness"] == 77] == [3, 5, 6]
    assert "different periods" not in tilenca(lab, "set", "preset", "default").stderr
    some = tilenca(lab, "set", "period", "40", "--tile", "3")
    assert "tiles may have different periods now (40 ms, others not known)" in some.stderr
    tilenca(lab, "set", "preset", "default", "--tile", "3")


@pytest.mark.parametrize(
    "arguments",
    [
        ["period", "5"],
        ["period", "x"],
        ["colour", "3"],
        ["preset", "fast"],
        ["brightness", "\N{ARABIC-INDIC DIGIT THREE}"],
        ["id", "3"],
        ["id", "3", "--tile", "x"],
        ["id", "3", "--tile", "1"],
    ],
)
def test_a_setting_that_cannot_be_is_refused_before_any_tile_has_it(lab: Lab, arguments: list[str]) -> None:
    assert tilenca(lab, "set", *arguments, status=2).stdout == ""


def test_a_tile_that_is_not_there_is_told_and_stops_no_other(lab: Lab) -> None:
    lab.unplug(20)
    try:
        done = tilenca(lab, "set", "brightness", "255", "--json", status=1)
        assert results(done) == ["set"] * 19 + ["missing"]
        last = json.loads(done.stdout)["tiles"][-1]
        assert (last["port"], last["tile"], last["settings"]) == (None, 20, None)
        document = json.loads(tilenca(lab, "devices", "--json").stdout)
        assert [tile["tile"] for tile in document["missing"]] == [20]
    finally:
        lab.plug(20)


def test_a_person_says_where_blinking_tiles_lie(lab: Lab, tmp_path: Path) -> None:
    ports = ["--port", lab.port(1), "--port", lab.port(2)]
    file = tmp_path / "two.toml"
    arguments = ["devices", "--learn", "--blink", "--tiles", str(file), *ports]
    done = tilenca(lab, *arguments, typed="0 0\n0 0\nx\n4 99999\n4 -1\n")
    assert done.stderr.count("blinks") == 5
    assert [(place.tile, place.row, place.col) for place in read_tiles(file)] == [(1, 0, 0), (2, 4, -1)]
    before = file.read_bytes()
    nothing = tilenca(lab, *arguments, status=1)
    assert f"no tile was given a place: {file} is left as it was" in nothing.stderr
    assert file.read_bytes() == before
    one = tilenca(lab, "devices", "--learn", "--tiles", str(file), *ports[:2])
    assert "kept as they were, since they were not learnt now: tile 2" in one.stderr
    assert file.read_bytes() == before


def test_tiles_without_an_id_of_their_own_get_one_if_asked(lab: Lab, tmp_path: Path) -> None:
    tilenca(lab, "set", "id", "1", "--port", lab.port(2))
    ports = ["--port", lab.port(1), "--port", lab.port(2)]
    file = tmp_path / "two.toml"
    arguments = ["devices", "--learn", "--tiles", str(file), *ports]
    done = tilenca(lab, *arguments, status=1)
    assert f"without an id of their own: {lab.port(2)} (1, as another); add --assign" in done.stderr
    assert not file.exists()
    tilenca(lab, *arguments, "--assign")
    assert [place.tile for place in read_tiles(file)] == [1, 2]


def test_the_monitor_draws_the_lab_and_survives_unplug_and_replug(lab: Lab) -> None:
    screen, inside = pty.openpty()
    termios.tcsetwinsize(inside, (45, 120))
    environment = {**lab.environment, "TERM": "xterm-256color"}
    with subprocess.Popen(
        command("monitor"), cwd=lab.folder, env=environment, stdout=inside, stderr=subprocess.PIPE
    ) as monitor:
        try:
            read_until(screen, "opening it has reset the tile")
            read_until(screen, "20 tiles  20 show")
            lab.unplug(6)
            read_until(screen, "1 away")
            lab.plug(6)
            read_until(screen, "20 tiles  20 show")
            monitor.send_signal(signal.SIGINT)
            _, chatter = monitor.communicate(timeout=LIMIT_S)
        finally:
            monitor.kill()  # a terminal that nobody reads would hold it for ever
    os.close(inside)
    os.close(screen)
    assert monitor.returncode == 130
    assert b"Traceback" not in chatter
