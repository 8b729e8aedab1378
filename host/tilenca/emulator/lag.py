"""The lag of emulated tiles behind the wall clock that they should keep up with."""

# An emulation that cannot keep up drops the lost time, so that it goes on listening to its ports.
MAX_LAG_S = 0.1
# A lag this small is not reported.
TOLD_S = 0.5


class Lag:
    """Adds up the dropped time. Owns no clock."""

    def __init__(self) -> None:
        self.wall_s = self.behind_s = 0.0

    def take(self, wall_s: float) -> float:
        """The emulated time to run for `wall_s` of the wall clock."""
        run_s = min(wall_s, MAX_LAG_S)
        self.wall_s += wall_s
        self.behind_s += wall_s - run_s
        return run_s

    def words(self) -> str:
        """The lag in words; "" for less than half a second."""
        if self.behind_s < TOLD_S:
            return ""
        return (
            f"the tiles are {self.behind_s:.1f} s behind real time: they ran "
            f"{self.wall_s - self.behind_s:.1f} s of {self.wall_s:.1f} s"
        )
