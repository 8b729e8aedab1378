"""Calls of every function of the emulator's C interface: sound ones, and ones with what cannot be."""

import math
from typing import Any

from tilenca.base import native_library

TILES = 2
NO_NUMBERS = (math.nan, math.inf, -math.inf)
FAULT_FIELDS = ("loss", "flip", "delay_s", "baud")


class World:
    """Two joined tiles, and all that calls need."""

    def __init__(self, image: bytes) -> None:
        self.library = native_library.load("emulator")
        self.ffi, self.lib = self.library.ffi, self.library.lib
        self.null = self.ffi.NULL
        self.image = image
        self.array = self.lib.tilenca_array_new(image, self.null, TILES, [0.0] * TILES, [0.0] * TILES)
        assert self.array != self.null
        assert self.lib.tilenca_array_link(self.array, 0, 1, 1, 3) == 0
        self.memory = self.ffi.new("uint8_t[]", 64)
        self.numbers = self.ffi.new("double[]", 8)
        self.words = self.ffi.new("uint32_t[]", 8)
        self.counts = self.ffi.new("uint64_t[]", 8)
        self.fault = self.ffi.new("tilenca_wire_fault*")
        self.no_numbers = [
            self.ffi.new("tilenca_wire_fault*", {field: value})
            for field in FAULT_FIELDS
            for value in (-1.0, 1e10, *NO_NUMBERS)
        ]
        # The array has a cable already, so that even ideal hardware comes too late.
        self.hardware = [
            self.ffi.new("tilenca_hardware*", values)
            for values in (
                {},
                *({"watchdog_error": value} for value in (-0.1, 0.6, *NO_NUMBERS)),
                *({"unpowered": value} for value in (-1, 4)),
            )
        ]


# Calls without the array and the tile that come first, by function; all are right as they stand.
def tile_calls(w: World) -> dict[str, tuple[Any, ...]]:
    """What follows the tile in a sound call of each function that is about a tile."""
    pin = (b"B", 5)
    return {
        "array_remove_tile": (),
        "array_link": (0, 1, 0),
        "array_unlink": (1,),
        "array_connect": (1, 1),
        "array_set_fault": (1, w.fault, 0),
        "array_fault_counts": (1, w.ffi.new("tilenca_wire_counts*")),
        "tile_fault": (),
        "tile_warnings": (),
        "tile_warning": (0,),
        "tile_segments": (),
        "tile_display_changes": (0, w.numbers, w.memory, 8),
        "tile_leds": (),
        "tile_rgb": (w.memory,),
        "tile_press_button": (1,),
        "tile_reset": (2,),
        "tile_set_power": (1,),
        "tile_is_powered": (),
        "tile_set_drift": (0.0,),
        "tile_set_skew": (0.0,),
        "tile_set_fuses": (0xFF, 0xD9, 0xFD, 0xFF),
        "tile_send": (w.memory, 1),
        "tile_receive": (w.memory, w.numbers, 8),
        "tile_pin": pin,
        "tile_duty": pin,
        "tile_hold_pin": (*pin, 1),
        "tile_push_edge": (*pin, 100, 1),
        "tile_set_analog": (0, 0),
        "tile_set_supply": (5.0,),
        "tile_set_adc_noise": (0.0, 0),
        "tile_set_comparator": (0, 0),
        "tile_set_spi_loopback": (0,),
        "tile_read_eeprom": (0, w.memory, 1),
        "tile_write_eeprom": (0, w.memory, 1),
        "tile_read_memory": (0, w.memory, 1),
        "tile_write_memory": (0x200, w.memory, 1),
        "tile_read_flash": (0, w.memory, 1),
        "tile_cycles": (w.ffi.new("tilenca_cycles*"),),
        "tile_stack": (w.ffi.new("tilenca_stack*"),),
        "tile_pc": (),
        "tile_set_pc": (0,),
        "tile_status": (),
        "tile_set_status": (0,),
        "tile_set_breakpoint": (100, 0),
        "tile_is_halted": (),
        "tile_halt": (),
        "tile_step": (),
        "tile_resume": (),
        "tile_set_mark": (100, 0),
        "tile_marks": (w.words, w.counts, 8),
        "probe_new": (*pin, -1.0),
    }


def other_bad_calls(w: World) -> dict[str, list[tuple[Any, ...]]]:
    """Whole calls that are wrong in another way than by the tile."""
    a, null, zeros = w.array, w.null, [0.0, 0.0]
    pins = [
        (b"I", 0),
        (b"M", 0),
        (b"@", 0),
        (b"\0", 0),
        (b"\xff", 0),
        (b"B", 8),
        (b"G", 6),
        (b"B", 2**32 - 1),
    ]
    sides = [4, 5, 2**32 - 1]
    odd_or_far = [1, 0x3FFFF, 0x40000, 2**32 - 2]

    def memory(bytes_in_all: int) -> list[tuple[Any, ...]]:
        places = [(bytes_in_all, 1), (bytes_in_all - 1, 2), (2**32 - 1, 1), (1, 2**32 - 1), (2**31, 2**31)]
        return [(a, 0, address, w.memory, count) for address, count in places] + [(a, 0, 0, null, 1)]

    by_pin = {name: [(a, 0, *pin) for pin in pins] for name in ("tile_pin", "tile_duty")}
    return by_pin | {
        "array_new": [
            (null, null, 2, zeros, zeros),
            (b"/nowhere/image.hex", null, 2, zeros, zeros),
            (w.image, b"/nowhere/boot.hex", 2, zeros, zeros),
            (w.image, null, 0, zeros, zeros),
            (w.image, null, 4097, [0.0] * 4097, [0.0] * 4097),
            (w.image, null, 2**32 - 1, zeros, zeros),
            (w.image, null, 2, null, zeros),
            (w.image, null, 2, zeros, null),
            *[(w.image, null, 2, [0.0, ppm], zeros) for ppm in (-1e6, 1e6, *NO_NUMBERS)],
            *[(w.image, null, 2, zeros, [0.0, time]) for time in (-1e9, -1e-9, 1.1e9, *NO_NUMBERS)],
        ],
        "array_size": [(null,)],
        "array_add_tile": [
            (null, 0.0, 0.0),
            *[(a, x, 0.0) for x in NO_NUMBERS],
            *[(a, 0.0, x) for x in (-1e9, -1e-9, 1.1e9, *NO_NUMBERS)],
        ],
        "array_set_hardware": [(null, w.hardware[0]), (a, null), *[(a, one) for one in w.hardware]],
        "array_set_cable_delay": [(null, 68e-6), *[(a, x) for x in (0, 19e-6, 261e-6, *NO_NUMBERS)]],
        "array_count_instructions": [(null,)],
        "array_translated": [(null,), (a,)],
        "array_use_translation": [(null, b"blocks.so"), (a, null), (a, b""), (a, b"no such file.so")],
        "array_set_threads": [(null, 1), (a, 0), (a, 1025), (a, 2**32 - 1)],
        "array_run": [(null, 0.1), (a, -0.1), (a, 1e10), *[(a, seconds) for seconds in NO_NUMBERS]],
        "array_time": [(null,)],
        "array_save": [(null, w.ffi.new("uint8_t*[1]")), (a, null)],
        "array_load": [(null, w.memory, 64), (a, null, 0), (a, w.memory, 0), (a, w.memory, 64)],
        "array_symbol": [
            (null, b"main", w.words, w.words),
            (a, null, w.words, w.words),
            (a, b"main", w.words, w.words),
        ],
        "array_function_at": [(null, 0)],
        "array_link": [
            *[(a, 0, side, 1, 0) for side in sides],
            *[(a, 0, 0, 1, side) for side in sides],
            (a, 0, 0, TILES, 0),
            (a, 0, 0, 2**32 - 1, 0),
            (a, 0, 1, 1, 0),
            (a, 0, 0, 0, 2),
        ],
        "array_unlink": [(a, 0, side) for side in (0, *sides)],
        "array_connect": [(a, 0, side, 1) for side in (0, *sides)],
        "array_set_fault": [
            *[(a, 0, side, w.fault, 0) for side in (0, *sides)],
            (a, 0, 1, null, 0),
            *[(a, 0, 1, fault, 0) for fault in w.no_numbers],
        ],
        "array_fault_counts": [
            *[(a, 0, side, w.ffi.new("tilenca_wire_counts*")) for side in (0, *sides)],
            (a, 0, 1, null),
        ],
        "tile_warning": [(a, 0, 0), (a, 0, 2**32 - 1)],
        "tile_rgb": [(a, 0, null)],
        "tile_reset": [(a, 0, cause) for cause in (0, 1, 3, 8, 2**32 - 1)],
        "tile_set_drift": [(a, 0, drift) for drift in NO_NUMBERS],
        "tile_set_skew": [(a, 0, ppm) for ppm in (-100_001.0, 100_001.0, *NO_NUMBERS)],
        "tile_set_fuses": [(a, 0, *(256 if i == wrong else 0 for i in range(4))) for wrong in range(4)],
        "tile_send": [(a, 0, null, 1)],
        "tile_hold_pin": [(a, 0, *pin, 1) for pin in pins],
        "tile_push_edge": [*((a, 0, *pin, 100, 1) for pin in pins), (a, 0, b"B", 5, 2**62 + 1, 1)],
        "tile_set_analog": [(a, 0, 16, 0), (a, 0, 2**32 - 1, 0), (a, 0, 0, 1024)],
        "tile_set_supply": [(a, 0, volts) for volts in (1.7, 5.6, *NO_NUMBERS)],
        "tile_set_adc_noise": [(a, 0, deviation, 0) for deviation in (-1.0, *NO_NUMBERS)],
        "tile_set_comparator": [(a, 0, 1025, 0), (a, 0, 0, 1025)],
        "side_pin": [
            *[
                (side, receives, w.ffi.new("char*"), w.ffi.new("unsigned*"))
                for side in sides
                for receives in (0, 1)
            ],
            (0, 0, null, w.ffi.new("unsigned*")),
            (0, 0, w.ffi.new("char*"), null),
        ],
        "tile_read_eeprom": memory(4096),
        "tile_write_eeprom": memory(4096),
        "tile_read_memory": memory(0x2200),
        "tile_write_memory": memory(0x2200),
        "tile_read_flash": memory(0x40000),
        "tile_cycles": [(a, 0, null)],
        "tile_stack": [(a, 0, null)],
        "tile_set_pc": [(a, 0, address) for address in odd_or_far],
        "tile_set_status": [(a, 0, 256)],
        "tile_set_breakpoint": [(a, 0, address, 1) for address in odd_or_far],
        "tile_set_mark": [(a, 0, address, 1) for address in odd_or_far],
        "probe_new": [*[(a, 0, *pin, -1.0) for pin in pins], *[(a, 0, b"B", 5, baud) for baud in NO_NUMBERS]],
        "probe_free": [(null, 0), (a, 1000), (a, 2**32 - 1)],
        "probe_level": [(null, 0), (a, 1000), (a, 2**32 - 1)],
        "probe_edges": [(null, 0, w.numbers, w.memory, 8), (a, 1000, w.numbers, w.memory, 8)],
        "probe_bytes": [
            (null, 0, w.numbers, w.memory, w.memory, 8),
            (a, 1000, w.numbers, w.memory, w.memory, 8),
        ],
    }
