"""The page as one file that replays a recording: it opens from a disk, a mail, a frame, without a server."""

import base64
import re
from pathlib import Path

from tilenca.base.errors import TilencaError
from tilenca.page.joined import joined

BEHIND = '<meta name="tilenca-source" content="{}">'
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)
# Where the recording goes; the page looks for this, too.
HOLE = "<!-- the recording -->"
ENTRY = "main.js"
_STYLE = re.compile(r'<link rel="stylesheet" href="([^"]+)">')
_ICON = re.compile(r'href="(icon\.svg)"')
_SCRIPT = f'<script type="module" src="{ENTRY}"></script>'
# What would end a script, or begin a comment, where it stands in a text of JavaScript.
_MARKUP = re.compile(r"<(?=/?script|!--)", re.IGNORECASE)


class AloneError(TilencaError):
    """The page's document is not as it should be."""


def page_alone(bundle: Path) -> str:
    """The document, with a hole for the recording; see `with_recording`.

    Args:
        bundle: folder of the static page.

    Raises:
        AloneError: its document is not as it should be.
        JoinError: its modules do not go together.
    """
    text = (bundle / "index.html").read_text(encoding="utf-8")
    behind = BEHIND.format("server")
    if text.count(behind) != 1 or text.count(_SCRIPT) != 1:
        raise AloneError(
            f"{bundle / 'index.html'}: it does not say once what stands behind it, and what runs"
        )
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    text = text.replace(behind, f"{policy}\n  {BEHIND.format('recording')}")
    text = _STYLE.sub(lambda link: f"<style>\n{(bundle / link[1]).read_text(encoding='utf-8')}</style>", text)
    text = _ICON.sub(lambda link: f'href="{_data(bundle / link[1], "image/svg+xml")}"', text)
    program = _MARKUP.sub(r"\\x3C", joined(bundle, ENTRY))
    script = f'<script type="module">\n{program}</script>'
    return text.replace(_SCRIPT, f"{HOLE}\n  {script}")


def with_recording(document: str, recording: str) -> str:
    """The document with a recording of the page in it.

    Args:
        document: of `page_alone`.
        recording: a line of JSON for each event.
    """
    safe = recording.replace("<", "\\u003c")  # in JSON it stands in texts only, and means the same there
    return document.replace(HOLE, f'<script type="application/jsonl" id="recording">\n{safe}</script>')


def _data(path: Path, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"
