"""avrdude's output, read as it comes, and where avrdude is."""

from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.fleet.avrdude import Output, Progress, find_avrdude


def test_avrdude_is_found_where_platformio_put_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    monkeypatch.delenv("PLATFORMIO_CORE_DIR", raising=False)
    with pytest.raises(TilencaError, match="avrdude is not installed"):
        find_avrdude()
    package = tmp_path / ".platformio" / "packages" / "tool-avrdude"
    package.mkdir(parents=True)
    for name in ("avrdude", "avrdude.conf"):
        (package / name).touch(mode=0o755)
    found = find_avrdude()
    assert found.command("/dev/ttyACM0", Path("f.hex"))[:3] == [
        str(package / "avrdude"),
        "-C",
        f"{package}/avrdude.conf",
    ]


# As avrdude prints it; byte by byte, for a pipe may cut anywhere.
BARS = [
    (b"\nReading | ", Progress("connecting", 0.0)),
    (b"#" * 50 + b" | 100% 0.00s\n\navrdude: device signature = 0x1e9801\n", Progress("connecting", 0.0)),
    (b"\nWriting | ", Progress("writing", 0.0)),
    (b"#" * 25, Progress("writing", 0.5)),
    (b"#" * 25 + b" | 100% 1.00s\n", Progress("writing", 1.0)),
    (b"\nReading | ##########", Progress("verifying", 0.2)),
]


def test_progress_is_read_from_bars_however_they_are_cut() -> None:
    output = Output()
    for text, expected in BARS:
        for byte in text:
            output.feed(bytes([byte]))
        assert output.progress == expected


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('avrdude: ser_open(): can\'t open device "/dev/null": Permission denied\n', "permission denied"),
        ("avrdude OS error: cannot open port /dev/null: No such file or directory\n", "no such port"),
        (
            "avrdude OS error: cannot open port /dev/null: Device or resource busy\n",
            "busy: ",
        ),
        ("avrdude OS error: cannot open port /dev/null: Odd\nmore: words\n", "cannot be opened: Odd; is it"),
        ("avrdude OS error: cannot open port \n", "cannot be opened: "),
        ("avrdude: verification error, first mismatch at byte 0x0021\n", "verification failed at 0x0021"),
        ("avrdude: stk500v2_ReceiveMessage(): timeout\n", "no reply"),
        ("avrdude error: something new\nbye\n", "avrdude failed: error: something new"),
        ("", "avrdude failed: no message"),
    ],
)
def test_avrdudes_words_become_a_reason(text: str, reason: str) -> None:
    output = Output()
    output.feed(text.encode())
    assert output.reason("/dev/null").startswith(reason)
