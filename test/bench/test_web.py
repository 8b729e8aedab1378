"""The bench of the web measures the same block everywhere, and sums what its processes have used."""

import gzip
import os
import subprocess
import sys
from pathlib import Path

from bench import web
from bench.chromium import processor_s


def test_sizes_are_those_of_the_files_and_of_each_gzipped(tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    one.write_bytes(bytes(30_000))
    two.write_bytes(os.urandom(20_000))
    gzipped = len(gzip.compress(bytes(30_000), 9)) + len(gzip.compress(two.read_bytes(), 9))
    assert web.size([one, two]) == f"50 KB, gzipped {gzipped / 1000:.0f} KB"


def test_the_processor_time_of_descendants_counts() -> None:
    before_s = processor_s(os.getpid())
    busy = "import time\nwhile time.process_time() < 0.3: pass\ninput()"
    with subprocess.Popen(
        [sys.executable, "-c", f"print(flush=True)\n{busy}"], stdin=subprocess.PIPE
    ) as child:
        own_s = processor_s(child.pid)
        for _ in range(20_000):
            own_s = processor_s(child.pid)
            if own_s >= 0.25:  # the system counts in hundredths
                break
        assert processor_s(os.getpid()) - before_s >= 0.24
        child.communicate(b"\n")
