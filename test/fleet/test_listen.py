"""A listener finds its ports, and those that come later."""

from pathlib import Path

import pytest

from support.tile_port import Tile
from tilenca.base.errors import NoDeviceError
from tilenca.fleet import listen
from tilenca.fleet.listen import Listener
from tilenca.fleet.state import PortNews


def opened(listener: Listener) -> list[str]:
    return [event.port for event in listener.poll(0.0) if isinstance(event, PortNews) and event.is_open]


def test_a_tile_that_comes_later_is_read_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listen, "LOOK_AROUND_S", 0.0)
    with Tile(1) as first, Tile(2) as second:
        (tmp_path / "a").symlink_to(first.port)
        with Listener([f"{tmp_path}/*"], None) as listener:
            assert opened(listener) == [f"{tmp_path}/a"]
            (tmp_path / "b").symlink_to(second.port)
            listener.reader._retry_s = 0.0  # the next look is due
            assert opened(listener) == [f"{tmp_path}/b"]


def test_patterns_that_match_nothing_get_their_while_and_then_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(listen, "PATIENCE_S", 0.3)
    monkeypatch.setattr(listen, "TICK_S", 0.1)
    with pytest.raises(NoDeviceError):
        Listener([f"{tmp_path}/none*"], None)
    assert capsys.readouterr().err.count("waiting up to") == 1


def test_its_ports_are_given_back(tmp_path: Path) -> None:
    with Tile(1) as tile:
        for _ in range(2):
            with Listener([tile.port], None) as listener:
                assert opened(listener) == [tile.port]
