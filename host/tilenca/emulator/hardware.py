"""How far emulated boards differ from ideal ones: what a program may not rely on, since no board gives it."""

from dataclasses import dataclass
from typing import Any

from tilenca.base.errors import UsageError
from tilenca.emulator.library import call, new

# What a tile without power does to the inputs of its neighbours, in the order of the C interface.
UNPOWERED = ("low", "middle", "high", "open")
MOST_WATCHDOG_ERROR = 0.5


@dataclass(frozen=True)
class Hardware:
    """The traits of an array's boards; each tile draws its own.

    Attributes:
        seed: decides all that is left to chance.
        floating_inputs: an input reads noise if neither its pull-up nor anybody outside drives it; otherwise
            it reads high.
        sram_noise: SRAM and registers hold noise when a tile is switched on; otherwise zeros.
        watchdog_error: the watchdog's clock is off by a share of up to so much, 0 to 0.5.
        unpowered: what a tile without power does to its neighbours' inputs. "low": its pins pull them down,
            as diodes do; "middle": where a pull-up is too weak, and they read noise; "high"; "open": nothing.
        start_up: programs begin after the start-up time that the fuses say, 66 ms on a Mega; None: if the
            array has a bootloader.
    """

    seed: int = 0
    floating_inputs: bool = True
    sram_noise: bool = True
    watchdog_error: float = 0.1
    unpowered: str = "low"
    start_up: bool | None = None

    def apply(self, handle: Any, has_bootloader: bool) -> None:
        """Gives it to an array that has no cables yet.

        Raises:
            UsageError: a value is out of range.
        """
        if self.unpowered not in UNPOWERED or not 0 <= self.watchdog_error <= MOST_WATCHDOG_ERROR:
            choice = ", ".join(UNPOWERED)
            raise UsageError(
                f"{self}: unpowered is one of {choice}; watchdog_error is 0 to {MOST_WATCHDOG_ERROR}"
            )
        start_up = has_bootloader if self.start_up is None else self.start_up
        given = new("tilenca_hardware*")
        given.seed = self.seed % 2**64
        given.watchdog_error = self.watchdog_error
        given.floating_inputs, given.sram_noise = self.floating_inputs, self.sram_noise
        given.start_up = start_up
        given.unpowered = UNPOWERED.index(self.unpowered)
        call("array_set_hardware", handle, given)


# What a program has to live with.
USUAL = Hardware()
# Boards as programs wish for them, for measurements that nothing shall disturb.
IDEAL = Hardware(
    0, floating_inputs=False, sram_noise=False, watchdog_error=0.0, unpowered="high", start_up=False
)
