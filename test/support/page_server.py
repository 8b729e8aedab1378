"""`tilenca page` as a process of its own, on a port that is free."""

import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

TILENCA = Path(sys.executable).with_name("tilenca")


@dataclass(frozen=True)
class PageServer:
    """A running server.

    Attributes:
        url: as it printed it.
        process: to end.
    """

    url: str
    process: "subprocess.Popen[str]"

    @property
    def address(self) -> tuple[str, int]:
        """Host and port."""
        parts = urlsplit(self.url)
        assert parts.hostname is not None
        assert parts.port is not None
        return parts.hostname, parts.port

    def stop(self) -> int:
        """Ends it as Ctrl-C does; returns its exit status."""
        self.process.terminate()
        return self.process.wait(60)


@contextmanager
def page_server(
    elf: Path | None, words: Sequence[str] = (), listen: str = "127.0.0.1:0"
) -> Iterator[PageServer]:
    """Starts `tilenca page`, without an image where it is to watch; it ends after the block at the latest."""
    image = [] if elf is None else ["--elf", str(elf)]
    command = [str(TILENCA), "page", "--listen", listen, "--no-open", *image, *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        url = process.stdout.readline().strip()
        assert url.startswith("http://"), url
        yield PageServer(url, process)
    finally:
        process.terminate()
        process.wait(60)
