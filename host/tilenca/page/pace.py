"""How much emulated time passes for the time of the wall clock. Owns no clock."""

from tilenca.emulator.history import QUANTUM_S

# A slice should take no longer than this, so that the page stays smooth and commands are obeyed at once.
SLICE_WALL_S = 1 / 60
# The first guess of what an emulation can do, in times of real time.
FIRST_RATE = 2.0
# Of how much a new measurement counts for.
WEIGHT = 0.2


class Pace:
    """Speed, pause, and the moment to pause at.

    Attributes:
        speed: times real time; 0: as fast as it can.
        paused: by a person, or at `until_s`.
        until_s: the time at which it pauses by itself; None: never.
        share: the share (0..1) of the wanted speed that was reached lately.
    """

    def __init__(self, speed: float, paused: bool = False, until_s: float | None = None) -> None:
        self.speed, self.paused, self.until_s = speed, paused, until_s
        self.share = 1.0
        self._rate = FIRST_RATE
        self._owed_s = 0.0
        self._is_late = False

    def set(self, speed: float, paused: bool) -> None:
        """Another speed, or a pause, from now on."""
        self.speed, self.paused = speed, paused
        self._owed_s, self.share = 0.0, 1.0

    def take(self, wall_s: float, now_s: float) -> float:
        """The emulated seconds to run for `wall_s` of the wall clock; `now_s` is the emulated time."""
        if self.paused:
            return 0.0
        affordable_s = self._rate * SLICE_WALL_S
        run_s = affordable_s
        if self.speed:
            self._owed_s += wall_s * self.speed
            run_s = min(self._owed_s, affordable_s)
            self._is_late = self._owed_s > affordable_s
            self._note_share(run_s / self._owed_s if self._owed_s > QUANTUM_S else 1.0)
        if self.until_s is not None:
            run_s = min(run_s, self.until_s - now_s)
        return run_s if run_s >= QUANTUM_S else 0.0  # very slow motion adds it up

    def ran(self, emulated_s: float, wall_s: float, now_s: float) -> None:
        """Tells what a slice took, and the time afterwards; what is too much to catch up with is dropped."""
        self._owed_s = 0.0 if self._is_late or not self.speed else self._owed_s - emulated_s
        if wall_s > 0 and emulated_s > 0:
            self._rate += WEIGHT * (emulated_s / wall_s - self._rate)
        if self.until_s is not None and now_s >= self.until_s - QUANTUM_S / 2:
            self.paused, self.until_s = True, None

    def _note_share(self, share: float) -> None:
        self.share += WEIGHT * (share - self.share)
