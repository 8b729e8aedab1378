"""The bundle works in a real browser: on a page, and in a worker."""

from pathlib import Path

import pytest

from bench import chromium


@pytest.mark.parametrize("worker", [False, True])
def test_tiles_run_in_chromium(bundle: Path, worker: bool) -> None:
    program = chromium.program()
    if program is None:
        pytest.skip("there is no Chromium; install one, such as Debian's chromium")
    case = {"rows": 2, "columns": 2, "translated": True, "warmUpS": 0.4, "measuredS": 0.2, "worker": worker}
    assert chromium.measure(program, bundle, case)["wallS"] > 0
