"""Prints a table of measurements, and writes it between two marks of a document."""

from pathlib import Path


def publish(section: str, document: Path | None, begin: str, end: str) -> None:
    """Prints the section and, if there is a document, writes it there."""
    print(section)
    if document is not None:
        text = document.read_text(encoding="utf-8") if document.exists() else ""
        document.write_text(written(text, begin, end, section), encoding="utf-8")


def stands(section: str, document: Path, begin: str, end: str) -> bool:
    """Whether the document has exactly this section; says so if not."""
    text = document.read_text(encoding="utf-8")
    same = written(text, begin, end, section) == text
    print(f"{document}: {'current' if same else 'differs from what was measured now'}")
    return same


def written(text: str, begin: str, end: str, section: str) -> str:
    """The document with the section between `begin` and `end`, or at its end."""
    ours = f"{begin}\n\n{section}\n\n{end}"
    before, found, rest = text.partition(begin)
    if not found:
        return f"{text.rstrip()}\n\n{ours}\n" if text else f"# Benchmarks\n\n{ours}\n"
    return before + ours + rest.partition(end)[2]
