"""A clock for views that tell how long something takes."""


class StandingClock:
    """Stands still but for what is added to it."""

    def __init__(self) -> None:
        self.seconds = 100.0

    def monotonic(self) -> float:
        return self.seconds
