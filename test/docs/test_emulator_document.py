"""docs/EMULATOR.md: its Python examples run."""

import re
from pathlib import Path

import pytest

from support.avr import ROOT, Compile
from tilenca.base.paths import FIRMWARE_ELF

EXAMPLES = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "EMULATOR.md").read_text(), re.DOTALL)

SKETCH = """
volatile uint16_t counter;
__attribute__((noinline)) void begin(void) { counter++; PINB = 0x20; }
__attribute__((noinline)) void finish(void) { asm volatile(""); }
int main(void) { DDRB = 0x20; for (;;) { begin(); _delay_us(100); finish(); } }
"""


@pytest.mark.parametrize("example", EXAMPLES)
def test_its_examples_run(
    avr: Compile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, example: str
) -> None:
    assert FIRMWARE_ELF.exists(), f"{FIRMWARE_ELF} is missing: run `pio run` before these tests"
    avr(SKETCH).rename(tmp_path / "sketch.elf")
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "docs/EMULATOR.md", "exec"), {})


def test_there_are_examples() -> None:
    assert len(EXAMPLES) == 2
