"""A timer that stands keeps a program's variables: its registers are memory then, and come back in time."""

from pathlib import Path

import pytest

from support.avr import Compile
from support.avr import IdealArray as Array
from tilenca.emulator.translation import SETTING
from tilenca.emulator.translator import make

# Wrong values; writes that power reduction should have kept out; flags and ticks of a short run; rounds.
PROGRAM = """int main(void) {
    for (unsigned char i = 0;; i++) {
        OCR0A = i; OCR0B = i ^ 0x55; TCNT0 = i + 3;
        OCR2A = ~i; OCR2B = i + 1; TCNT2 = i + 2;
        result[0] += OCR0A != i || OCR0B != (i ^ 0x55) || TCNT0 != (unsigned char)(i + 3);
        result[0] += OCR2A != (unsigned char)~i || OCR2B != (unsigned char)(i + 1);
        result[0] += TCNT2 != (unsigned char)(i + 2);
        PRR0 |= 1 << PRTIM0;
        OCR0A = 77; TCNT0 = 78;
        PRR0 &= (unsigned char)~(1 << PRTIM0);
        result[1] += OCR0A != i || TCNT0 != (unsigned char)(i + 3);
        if (i % 16 == 0) { /* the write hides the match of the count itself, and not the next one */
            OCR0A = i; OCR0B = i + 1; TIFR0 = 7; TCNT0 = i;
            TCCR0B = 1; asm volatile("nop\\n nop\\n nop\\n nop\\n"); TCCR0B = 0;
            result[2] = TIFR0; result[3] = TCNT0 - i;
        }
        result[4]++;
        TCNT0 = i;
        for (unsigned char j = 0; j < 250; j++) { result[0] += TCNT0 != i; }
    }
}"""
MOMENTS_S = tuple(i / 1024 for i in range(2, 12))
SOON_S = 1 / 32768  # in the same loop, mostly


@pytest.fixture(params=[False, True], ids=["interpreted", "translated"])
def elf(
    avr: Compile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> Path:
    monkeypatch.setenv(SETTING, str(tmp_path / "translations"))
    image = Path(avr(PROGRAM))
    if request.param:
        make(image)
    return image


def test_variables_are_kept_and_the_timer_runs_from_them(elf: Path) -> None:
    array = Array(elf)
    array.run(0.01)
    wrong, passed, flags, ran, rounds = array[0].read_memory(0x1000, 5)
    assert (wrong, passed) == (0, 0)
    assert flags == 4  # OCF0B
    assert ran == 5
    assert rounds > 20


def test_who_looks_meanwhile_changes_nothing(elf: Path) -> None:
    for moment_s in MOMENTS_S:
        alone, looked_at, restored, plain = (Array(elf), Array(elf), Array(elf), Array(elf, translated=False))
        for array in (alone, looked_at, plain):
            array.run(moment_s)
        restored.restore(looked_at.save())
        for array in (alone, looked_at, plain, restored):
            array.run(SOON_S)
        assert looked_at.save() == restored.save() == alone.save() == plain.save()
