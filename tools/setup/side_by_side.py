"""Lanes of the set-up that run side by side: a download and a compilation need different things."""

import time
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from setup.command import StoppedError, say, stop

STILL_S = 20.0  # from one sign of life to the next


def side_by_side(lanes: Mapping[str, Callable[[], None]], still_s: float = STILL_S) -> None:
    """Runs all lanes at the same time, and says now and then which of them still run.

    Args:
        lanes: the work of each in a few words, and the function that does it.
        still_s: seconds from one such line to the next.

    Raises:
        BaseException: the failure of a lane; it has stopped what the other lanes ran.
    """
    started = time.monotonic()
    failures: list[BaseException] = []
    with ThreadPoolExecutor(len(lanes)) as threads:
        running = {threads.submit(lane): name for name, lane in lanes.items()}
        try:
            while running:
                ended, _ = wait(running, still_s, FIRST_COMPLETED)
                for lane in ended:
                    running.pop(lane)
                    if failure := lane.exception():
                        failures.append(failure)
                        stop()
                if not ended:
                    names = " and ".join(running.values())
                    done = f"{len(lanes) - len(running)} of {len(lanes)} parts done"
                    say(f"still busy with {names} ({time.monotonic() - started:.0f} s; {done})")
        except KeyboardInterrupt:
            stop()
            raise
    if failures:
        raise min(
            failures, key=lambda failure: isinstance(failure, StoppedError)
        )  # the cause, not its effects


class Awaited:
    """Work that other lanes wait for: `with awaited: work()`. If it fails, they fail with it."""

    def __init__(self) -> None:
        self._done: Future[None] = Future()

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, *_error: object) -> None:
        if kind is None:
            self._done.set_result(None)
        else:
            self._done.set_exception(StoppedError("a step before this one failed"))

    def wait(self) -> None:
        """Waits until the work is done.

        Raises:
            StoppedError: it failed.
        """
        self._done.result()
