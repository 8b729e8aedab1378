"""Checks a built site: every link inside it leads somewhere, and no page loads anything from elsewhere.

    python tools/docs/links.py build/docs

Nothing is fetched: links to other sites are let be. Exits with 1 and one line for each fault.
"""

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Elements that load what they name, as opposed to links that a reader may follow.
LOADING = {"img", "script", "link", "source", "iframe"}
# Of <link>, only these are loaded; the others (canonical, search) are facts about the page.
LOADED_LINKS = {"stylesheet", "icon", "shortcut icon", "preload"}


class Page(HTMLParser):
    """The anchors of a page, and what it points at: (element, target)."""

    def __init__(self, text: str) -> None:
        """Reads the whole text."""
        super().__init__()
        self.anchors: set[str] = set()
        self.targets: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Notes an element's name and targets."""
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        if tag == "link" and values.get("rel") not in LOADED_LINKS:
            return
        self.targets += [(tag, values[name]) for name in ("href", "src") if values.get(name)]


def faults(site: Path) -> Iterator[str]:
    """One line for each link that leads nowhere and each thing that is loaded from elsewhere."""
    pages = {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        where = path.relative_to(site.resolve())
        for element, target in page.targets:
            url = urlsplit(target)
            if url.scheme == "data":
                continue
            if url.scheme or url.netloc:
                if element in LOADING:
                    yield f"{where}: loads {target} from another site; the pages must work offline"
                continue
            leads_to = (path.parent / unquote(url.path)).resolve() if url.path else path
            if not leads_to.is_file():
                yield f"{where}: links to {target}, and there is no such file"
            elif leads_to in pages and url.fragment and unquote(url.fragment) not in pages[leads_to].anchors:
                yield f"{where}: links to {target}, and that page has no such anchor"


def main(arguments: list[str]) -> int:
    """Checks the site that the one argument names."""
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print("usage: links.py SITE, a folder that `make docs` has built", file=sys.stderr)
        return 2
    found = list(faults(Path(arguments[0])))
    for fault in found:
        print(fault, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
