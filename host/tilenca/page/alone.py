"""The page as one file that replays a recording, and needs no server: it opens from a disk, a mail, a frame.

Its modules lie in the document as data, under the names that an import map gives them, so that nothing is
built, and nothing is rewritten but the names in their imports.
"""

import base64
import json
import re
from pathlib import Path, PurePosixPath

from tilenca.base.errors import TilencaError

BEHIND = '<meta name="tilenca-source" content="{}">'
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)
# Where the recording goes; the page looks for this, too.
HOLE = "<!-- the recording -->"
ENTRY = "main.js"
_IMPORT = re.compile(r"""^(?P<head>(?:import|export)\b[^"';]*?)"(?P<name>\.[^"]+)";""", re.MULTILINE)
_STYLE = re.compile(r'<link rel="stylesheet" href="([^"]+)">')
_ICON = re.compile(r'href="(icon\.svg)"')
_SCRIPT = f'<script type="module" src="{ENTRY}"></script>'


class AloneError(TilencaError):
    """The page's files are not as they should be."""


def page_alone(bundle: Path) -> str:
    """The document, with a hole for the recording; see `with_recording`.

    Args:
        bundle: folder of the static page.

    Raises:
        AloneError: its files do not go together.
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
    imports = {f"tilenca/{name}": _module(bundle, name) for name in modules(bundle)}
    scripts = [
        f'<script type="importmap">{json.dumps({"imports": imports})}</script>',
        HOLE,
        f'<script type="module">import "tilenca/{ENTRY}";</script>',
    ]
    return text.replace(_SCRIPT, "\n  ".join(scripts))


def with_recording(document: str, recording: str) -> str:
    """The document with a recording of the page in it.

    Args:
        document: of `page_alone`.
        recording: a line of JSON for each event.
    """
    safe = recording.replace("<", "\\u003c")  # in JSON it stands in texts only, and means the same there
    return document.replace(HOLE, f'<script type="application/jsonl" id="recording">\n{safe}</script>')


def modules(bundle: Path) -> list[str]:
    """The paths of the modules that the page runs, within the bundle.

    Raises:
        AloneError: one is not there.
    """
    found: dict[str, None] = {}
    waiting = [ENTRY]
    while waiting:
        name = waiting.pop(0)
        if name in found:
            continue
        found[name] = None
        try:
            text = (bundle / name).read_text(encoding="utf-8")
        except OSError as error:
            raise AloneError(f"{bundle / name}: {error.strerror}") from error
        waiting += [_resolved(name, match["name"]) for match in _IMPORT.finditer(text)]
    return list(found)


def _resolved(module: str, name: str) -> str:
    """The path of what a module imports by a relative name."""
    parts: list[str] = []
    for part in (PurePosixPath(module).parent / name).parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return "/".join(parts)


def _module(bundle: Path, name: str) -> str:
    text = (bundle / name).read_text(encoding="utf-8")
    named = _IMPORT.sub(lambda found: f'{found["head"]}"tilenca/{_resolved(name, found["name"])}";', text)
    return f"data:text/javascript;base64,{base64.b64encode(named.encode()).decode()}"


def _data(path: Path, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"
