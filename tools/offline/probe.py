"""Exits with 0 if PlatformIO's package registry answers soon: python tools/offline/probe.py [SECONDS].

It asks as PlatformIO itself would, so PlatformIO's proxies, mirrors and certificates apply here too. Without
a limit PlatformIO would try for a minute.
"""

import os
import sys
import tempfile
import threading

LIMIT_S = 4.0


def registry_answers(limit_s: float) -> bool:
    """Whether the registry has the AVR platform and says so in time.

    Args:
        limit_s: seconds to wait for the network. If it never answers, a thread is left behind: leave the
            process by `os._exit` then.
    """
    from platformio.exception import PlatformioException
    from platformio.registry.client import RegistryClient

    answers: list[object] = []

    def ask() -> None:
        try:
            answers.append(RegistryClient().get_package("platform", "platformio", "atmelavr"))
        except (PlatformioException, OSError, ValueError):
            answers.append(None)

    # A thread, because no timeout of Python's reaches into a name look-up. It starts after the imports above:
    # a slow disk is no sign of a slow network.
    asking = threading.Thread(target=ask, daemon=True)
    asking.start()
    asking.join(limit_s)
    return bool(answers and answers[0])


def main() -> None:
    """Ends the process with the answer as its exit status."""
    limit_s = float(sys.argv[1]) if len(sys.argv) > 1 else LIMIT_S
    with tempfile.TemporaryDirectory() as core_dir:
        # Neither the user's core directory nor a cached answer: does it answer now?
        os.environ["PLATFORMIO_CORE_DIR"] = core_dir
        answers = registry_answers(limit_s)
    os._exit(0 if answers else 1)


if __name__ == "__main__":
    main()
