"""Random programs that write random bytes to every peripheral: whatever happens, it happens again."""

import random
from contextlib import suppress
from pathlib import Path

import pytest

from support.avr import hex_record
from tilenca.base.errors import TilencaError
from tilenca.emulator import Array, LinkFault

WORDS = 1500
REGISTERS = [
    *range(0x20, 0x37), 0x3B, 0x3C, 0x3D, 0x3F, *range(0x43, 0x49), 0x4C, 0x4D, 0x4E, 0x50, 0x53, 0x57,
    0x5D, 0x5E, 0x5F, 0x60, 0x61, 0x64, 0x65, *range(0x68, 0x74), 0x7A, 0x7B, 0x7C, *range(0x80, 0x8E),
    *range(0x90, 0x9E), *range(0xA0, 0xAE), *range(0xB0, 0xB5), *range(0xB8, 0xBE), *range(0xC0, 0xD7),
    *range(0x100, 0x10C), *range(0x120, 0x12E), *range(0x130, 0x137),
]  # fmt: skip
SLEEP, SEI, CLI, WDR, SPM, RET, RETI = 0x9588, 0x9478, 0x94F8, 0x95A8, 0x95E8, 0x9508, 0x9518
LINKS = [(0, 1, 1, 3), (0, 2, 1, 0), (1, 2, 2, 0), (3, 1, 2, 3)]


def noise(draw: random.Random) -> str:
    """A program in Intel HEX: constants to registers, registers to I/O, sleep, and a little else."""
    words: list[int] = []
    while len(words) < WORDS:
        choice, register = draw.random(), draw.randrange(16)
        if choice < 0.55:
            words.append(0xE000 | draw.randrange(16) << 8 | register << 4 | draw.randrange(16))  # LDI
            words += [0x9300 | register << 4, draw.choice(REGISTERS)]  # STS
        elif choice < 0.7:
            words += [0x9100 | register << 4, draw.choice(REGISTERS)]  # LDS
        elif choice < 0.75:
            words.append(draw.choice([SLEEP, SEI, SEI, CLI, WDR, SPM, RET, RETI]))
        elif choice < 0.82:
            words.append(draw.choice([0x9A00, 0x9800, 0x9B00, 0x9900]) | draw.randrange(256))  # bits of I/O
        else:
            words.append(draw.choice([0x0C00, 0x1800, 0x2000, 0x8000, 0x8200]) | draw.randrange(256))
    words.append(0xC000 | (-len(words) - 1) & 0xFFF)
    code = b"".join(word.to_bytes(2, "little") for word in words)
    records = [hex_record(0, start, code[start : start + 16]) for start in range(0, len(code), 16)]
    return "".join(records) + ":00000001FF\n"


def life(image: Path, seed: int, threads: int, slices: int, detours: bool = False) -> bytes:
    """The same calls on the same array, with time cut differently; what is left in the end."""
    draw = random.Random(seed)
    ppm = [draw.uniform(-5000, 5000) for _ in range(4)]
    with Array(image, 4, LINKS, ppm, [draw.uniform(0, 0.002) for _ in range(4)], threads=threads) as array:
        array.set_fault(0, 1, LinkFault(loss=0.1, flip=0.1, delay_s=0.0001), seed=1)
        array.set_fault(2, 0, LinkFault(flip=0.05), seed=2)
        array[1].set_drift(draw.uniform(-1000, 1000))
        for _ in range(4):
            part_s = draw.choice([0.0016, 0.004, 0.008]) / slices
            for _ in range(slices):
                if detours:
                    before = array.save()
                    with suppress(TilencaError):
                        array.run(0.0013)
                    array.restore(before)
                with suppress(TilencaError):  # programs of noise often go astray
                    array.run(part_s)
            deed = draw.randrange(6)
            if deed == 0:
                array[draw.randrange(4)].reset()
            elif deed == 1:
                array[0].powered = not array[0].powered
            elif deed == 2:
                array.cut(0, 1)
            elif deed == 3:
                array.mend(0, 1)
            elif deed == 4:
                array[0].write_serial(draw.randbytes(5))
        return array.save()


@pytest.mark.parametrize("seed", range(40))
def test_noise_leaves_the_same_however_it_is_run(tmp_path: Path, seed: int) -> None:
    image = tmp_path / "noise.hex"
    image.write_text(noise(random.Random(seed)))
    plain = life(image, seed, threads=1, slices=1)
    assert life(image, seed, threads=2, slices=1) == plain
    assert life(image, seed, threads=1, slices=5) == plain
    assert life(image, seed, threads=1, slices=1, detours=True) == plain
    assert life(image, seed + 1000, threads=1, slices=1) != plain
