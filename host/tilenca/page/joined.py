"""Modules of JavaScript as one file, since a browser spends more on sixty small ones than on what is in them.

Each module becomes a function that is called at once, after those that it imports. The entry stands at the
end as it is, and exports what it did. Files are joined when they are asked for: nothing is built, and each
can still be loaded by itself.
"""

import re
from pathlib import Path, PurePosixPath

from tilenca.base.errors import TilencaError

# What `joined` understands: names in braces, from a file beside it. A node module is left to node.
_LINK = re.compile(r"""^(import|export)\s*\{([^}]*)\}\s*from\s*"(\.[^"]+)";""", re.MULTILINE)
_BARE = re.compile(r"""^import\s*"(\.[^"]+)";""", re.MULTILINE)
_EXPORT = re.compile(r"^export ((?:async )?(?:function|class|const) ([\w$]+))", re.MULTILINE)
_OTHER = re.compile(r"^(?:import|export)\b(?! *\().*", re.MULTILINE)
_OWN_ADDRESS = "import.meta.url"


class JoinError(TilencaError):
    """Modules do not go together."""


def modules(folder: Path, entry: str) -> list[str]:
    """The paths of the modules that one needs: each after those that it imports, the entry last.

    Args:
        folder: of all of them.
        entry: path of the first one, within the folder.

    Raises:
        JoinError: one is not there, or two import each other.
    """
    order: list[str] = []
    open_ones: list[str] = []

    def visit(name: str) -> None:
        if name in order:
            return
        if name in open_ones:
            raise JoinError(f"{folder / name}: it imports itself, by way of {open_ones[-1]}")
        open_ones.append(name)
        for other in _imports(_text(folder, name)):
            visit(resolved(name, other))
        open_ones.pop()
        order.append(name)

    visit(entry)
    return order


def joined(folder: Path, entry: str) -> str:
    """A module with all that it imports in it; it exports what the entry does.

    Args:
        folder: of all modules.
        entry: path of the first one, within the folder.

    Raises:
        JoinError: they do not go together, or use another form of import or export than that of names.
    """
    numbers = {name: number for number, name in enumerate(modules(folder, entry))}
    parts = [f"// {len(numbers)} modules in one file, made from those beside it.\n"]
    for name, number in numbers.items():
        body, exported = _linked(folder, name, numbers)
        names = f"{{ {', '.join(exported)} }}"
        if name == entry:
            parts.append(f"// {name}\n{body}" + (f"\nexport {names};\n" if exported else ""))
            continue
        body = body.replace(_OWN_ADDRESS, f'new URL("{_relative(entry, name)}", {_OWN_ADDRESS}).href')
        parts.append(f"// {name}\nconst {_variable(number)} = (() => {{\n{body}\nreturn {names};\n}})();\n")
    return "\n".join(parts)


def _linked(folder: Path, name: str, numbers: dict[str, int]) -> tuple[str, list[str]]:
    """A module's text, with what it imports from variables and nothing exported; the names to export."""
    text = _text(folder, name)
    exported = [found[2] for found in _EXPORT.finditer(text)]

    def link(found: re.Match[str]) -> str:
        kind, names, other = found.groups()
        pairs = [one.split(" as ") for one in map(str.strip, names.split(",")) if one]
        if kind == "export":
            exported.extend(pair[-1].strip() for pair in pairs)
        taken = ", ".join(": ".join(part.strip() for part in pair) for pair in pairs)
        lines = "\n" * found[0].count("\n")
        return f"const {{ {taken} }} = {_variable(numbers[resolved(name, other)])};{lines}"

    text = _BARE.sub("", _LINK.sub(link, text))
    if strange := next((one[0] for one in _OTHER.finditer(text) if not _EXPORT.match(one[0])), None):
        raise JoinError(f"{folder / name}: it has '{strange}'; name what it imports or exports")
    return _EXPORT.sub(r"\1", text), exported


def _variable(number: int) -> str:
    """What a module's exports are called in the joined file; a blank name would be none of theirs."""
    return f"$module{number}"


def _imports(text: str) -> list[str]:
    return [found[3] for found in _LINK.finditer(text)] + _BARE.findall(text)


def _text(folder: Path, name: str) -> str:
    try:
        return (folder / name).read_text(encoding="utf-8")
    except OSError as error:
        raise JoinError(f"{folder / name}: {error.strerror}") from error


def resolved(module: str, name: str) -> str:
    """The path of what a module imports by a relative name."""
    parts: list[str] = []
    for part in (PurePosixPath(module).parent / name).parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return "/".join(parts)


def _relative(entry: str, name: str) -> str:
    """How the entry would name another module."""
    return f"./{'../' * (len(PurePosixPath(entry).parts) - 1)}{name}"
