"""`tilenca emulate --check-states`: the tiles and the simulator, side by side."""

import pytest

from support.avr import Compile
from support.emulate import emulate, report
from tilenca.base.errors import UsageError
from tilenca.base.paths import DEFAULT_MODEL, DEFAULT_SHAPES, FIRMWARE_ELF
from tilenca.commands.emulate_states import StateCheck
from tilenca.emulator.experiment import Emulation, EmulationSettings
from tilenca.emulator.greeting import firmware_settings
from tilenca.model.file import load_model
from tilenca.shapes.file import load_task

pytestmark = pytest.mark.usefixtures("firmware")


@pytest.mark.parametrize("faults", [(), ("--fault", "loss=0.2@1-2", "--fault", "off@3:0.4-0.7")])
def test_no_state_differs_with_faults_and_without(
    faults: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--check-states", "--bootloader", "none", "--seconds", "1.2", "--boot-spread", "0.1", *faults)
    told = report(capsys, *words)["states"]
    assert told["first_difference"] is None
    assert told["states"] > 150
    assert told["bytes"] == told["states"] * 2 * load_model(DEFAULT_MODEL).dimensions.channels
    assert told["messages"] > told["read_again"]
    assert (told["read_again"] > 10) == bool(faults), "lost messages are read again"


def test_the_line_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--check-states", "--bootloader", "none", "--updates", "10", "--boot-spread", "0.1")
    _, out, _ = emulate(capsys, *words)
    assert "bytes: the same as the simulator's" in out


def test_a_difference_is_said_in_the_line_and_by_the_status(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # One bit of one channel is read wrongly off the chip, in the third update of tile 2.
    from tilenca.emulator import states

    class Wrong(states.StateWatch):
        count = 0

        def collect(self) -> list[states.TileState]:
            found = super().collect()
            self.count += sum(state.tile == 1 for state in found)
            if self.count != 4:
                return found
            return [
                states.TileState(**{**vars(state), "state": bytes([state.state[0] ^ 1]) + state.state[1:]})
                for state in found
            ]

    monkeypatch.setattr("tilenca.commands.emulate_states.StateWatch", Wrong)
    words = ("--check-states", "--bootloader", "none", "--updates", "30", "--boot-spread", "0.1")
    status, out, _ = emulate(capsys, *words)
    assert status == 1
    assert "then the first DIFFERENCE: tile 2, update 3, state, channel 0:" in " ".join(out.split())


@pytest.mark.parametrize("option", [("--watch",), ("--serve", "tiles"), ("--gdb", "1")])
def test_what_does_not_go_with_it_is_refused(
    option: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    status, _, error = emulate(capsys, "--check-states", *option)
    assert status == 2
    assert option[0] in error


def test_a_firmware_whose_model_is_not_at_hand_or_that_is_no_tile_is_refused(avr: Compile) -> None:
    task = load_task(DEFAULT_SHAPES)
    settings, defaults = EmulationSettings(), firmware_settings(FIRMWARE_ELF)
    tiles = Emulation(task.find("1"), task.labels, FIRMWARE_ELF, settings, defaults)
    with pytest.raises(UsageError, match="give --model DIR"):
        StateCheck(tiles, None)
