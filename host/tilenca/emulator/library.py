"""The compiled emulator, as ctypes sees it: tools/emulator/src/capi.h in Python."""

import ctypes
import os
from ctypes import (
    POINTER,
    c_char,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
)
from functools import cache

from tilenca.base.errors import BuildError, UsageError
from tilenca.base.paths import BUILD

LIBRARY = BUILD / "emulator" / "libtilenca_emulator.so"

_TILE: list[type] = [c_void_p, c_uint]
_PIN: list[type] = [c_void_p, c_uint, c_char, c_uint]
_SIGNATURES: dict[str, tuple[type | None, list[type]]] = {
    "last_error": (c_char_p, []),
    "array_new": (c_void_p, [c_char_p, c_char_p, c_uint, POINTER(c_double), POINTER(c_double)]),
    "array_free": (None, [c_void_p]),
    "array_size": (c_uint, [c_void_p]),
    "array_add_tile": (c_uint, [c_void_p, c_double, c_double]),
    "array_remove_tile": (None, _TILE),
    "array_link": (c_int, [c_void_p, c_uint, c_uint, c_uint, c_uint]),
    "array_unlink": (c_int, [c_void_p, c_uint, c_uint]),
    "array_connect": (c_int, [c_void_p, c_uint, c_uint, c_int]),
    "array_set_fault": (
        c_int,
        [c_void_p, c_uint, c_uint, c_double, c_double, c_double, c_double, c_uint64],
    ),
    "array_fault_counts": (c_int, [c_void_p, c_uint, c_uint, POINTER(c_uint64)]),
    "array_set_threads": (None, [c_void_p, c_uint]),
    "array_run": (c_int, [c_void_p, c_double]),
    "array_time": (c_double, [c_void_p]),
    "array_halted": (c_int, _TILE),
    "array_save": (c_size_t, [c_void_p, POINTER(POINTER(c_uint8))]),
    "array_load": (c_int, [c_void_p, c_char_p, c_size_t]),
    "array_symbol": (c_int, [c_void_p, c_char_p, POINTER(c_uint32), POINTER(c_uint32)]),
    "array_function_at": (c_char_p, [c_void_p, c_uint32]),
    "tile_fault": (c_char_p, _TILE),
    "tile_warning": (c_char_p, [*_TILE, c_uint]),
    "tile_segments": (c_int, _TILE),
    "tile_leds": (c_int, _TILE),
    "tile_rgb": (None, [*_TILE, POINTER(c_uint8)]),
    "tile_press_button": (None, [*_TILE, c_int]),
    "tile_reset": (None, [*_TILE, c_uint]),
    "tile_set_power": (None, [*_TILE, c_int]),
    "tile_is_powered": (c_int, _TILE),
    "tile_set_drift": (None, [*_TILE, c_double]),
    "tile_set_fuses": (None, [*_TILE, c_uint, c_uint, c_uint, c_uint]),
    "tile_pin": (c_int, _PIN),
    "tile_duty": (c_double, _PIN),
    "tile_hold_pin": (c_int, [*_PIN, c_int]),
    "tile_set_analog": (None, [*_TILE, c_uint, c_uint]),
    "tile_set_adc_noise": (None, [*_TILE, c_double, c_uint64]),
    "tile_set_comparator": (None, [*_TILE, c_uint, c_uint]),
    "tile_set_spi_loopback": (None, [*_TILE, c_int]),
    "tile_push_edge": (c_int, [*_PIN, c_uint64, c_int]),
    "tile_send": (None, [*_TILE, c_char_p, c_size_t]),
    "tile_receive": (c_size_t, [*_TILE, POINTER(c_uint8), POINTER(c_double), c_size_t]),
    "tile_display_changes": (
        c_size_t,
        [*_TILE, c_size_t, POINTER(c_double), POINTER(c_uint8), c_size_t],
    ),
    "tile_read_eeprom": (c_int, [*_TILE, c_uint, POINTER(c_uint8), c_uint]),
    "tile_write_eeprom": (c_int, [*_TILE, c_uint, c_char_p, c_uint]),
    "tile_read_memory": (c_int, [*_TILE, c_uint, POINTER(c_uint8), c_uint]),
    "tile_write_memory": (c_int, [*_TILE, c_uint, c_char_p, c_uint]),
    "tile_read_flash": (c_int, [*_TILE, c_uint, POINTER(c_uint8), c_uint]),
    "tile_cycles": (None, [*_TILE, POINTER(c_uint64)]),
    "tile_stack": (None, [*_TILE, POINTER(c_uint)]),
    "tile_pc": (c_uint32, _TILE),
    "tile_set_pc": (None, [*_TILE, c_uint32]),
    "tile_status": (c_uint, _TILE),
    "tile_set_status": (None, [*_TILE, c_uint]),
    "tile_set_breakpoint": (c_int, [*_TILE, c_uint32, c_int]),
    "tile_halt": (None, _TILE),
    "tile_step": (c_int, _TILE),
    "tile_resume": (None, _TILE),
    "tile_set_mark": (c_int, [*_TILE, c_uint32, c_int]),
    "tile_marks": (c_size_t, [*_TILE, POINTER(c_uint32), POINTER(c_uint64), c_size_t]),
    "side_pin": (None, [c_uint, c_int, POINTER(c_char), POINTER(c_uint)]),
    "probe_new": (c_int, [*_PIN, c_double]),
    "probe_free": (None, _TILE),
    "probe_level": (c_int, _TILE),
    "probe_edges": (c_size_t, [*_TILE, POINTER(c_double), POINTER(c_uint8), c_size_t]),
    "probe_bytes": (
        c_size_t,
        [*_TILE, POINTER(c_double), POINTER(c_uint8), POINTER(c_uint8), c_size_t],
    ),
}


@cache
def library() -> ctypes.CDLL:
    """The compiled emulator; ctypes lets other Python threads run while it works.

    Raises:
        BuildError: it has not been built.
    """
    try:
        loaded = ctypes.CDLL(os.fspath(LIBRARY))
    except OSError as error:
        raise BuildError(f"{LIBRARY}: the emulator is not built ({error}); run `make setup`") from error
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(loaded, f"tilenca_{name}")
        function.restype, function.argtypes = result, arguments
    return loaded


def last_error() -> str:
    """Why the last function that failed did."""
    return str(library().tilenca_last_error().decode())


def check(succeeded: bool) -> None:
    """Raises UsageError with the library's own words if a function failed."""
    if not succeeded:
        raise UsageError(last_error())
