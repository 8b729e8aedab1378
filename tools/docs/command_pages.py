"""The reference of the command line, made from the parsers themselves: the directive `tilenca-commands`.

`rendered` is the page's text, in reStructuredText; Sphinx is needed for the directive only.
"""

import argparse
import functools
import re
from typing import TYPE_CHECKING, Any

from tilenca.cli import COMMANDS, build_parser

if TYPE_CHECKING:
    from sphinx.application import Sphinx

WIDTH = 88


def rendered() -> str:
    """A section for each command: what it does, its usage and its options."""
    return "\n\n".join(_section(name) for name in COMMANDS)


def command_parser(name: str) -> argparse.ArgumentParser:
    """The parser of one command."""
    parser = build_parser(name)
    (commands,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    found = commands.choices[name]
    assert isinstance(found, argparse.ArgumentParser)
    return found


def _section(name: str) -> str:
    parser = command_parser(name)
    parser.formatter_class = functools.partial(argparse.HelpFormatter, width=WIDTH)
    title = f"tilenca {name}"
    usage = parser.format_usage().removeprefix("usage: ").rstrip()
    parts = [title, "-" * len(title), "", _prose(parser.description or ""), "", ".. code-block:: text", ""]
    parts += [f"   {line}" for line in usage.splitlines()]
    parts += ["", f".. program:: {title}", ""]
    for group in parser._action_groups:
        actions = [action for action in group._group_actions if action.help != argparse.SUPPRESS]
        if not actions:
            continue
        if group.description:
            parts += [f".. rubric:: {group.title}", "", _prose(group.description), ""]
        for action in actions:
            parts += [*_option(parser, action), ""]
    return "\n".join(parts)


def _option(parser: argparse.ArgumentParser, action: argparse.Action) -> list[str]:
    value = _value(action)
    names = action.option_strings or [action.dest]
    signature = ", ".join(f"{name} {value}".rstrip() for name in names) if action.option_strings else value
    words = (action.help or "") % {**vars(action), "prog": parser.prog}
    return [f".. option:: {signature}", "", f"   {_prose(words)}"]


def _value(action: argparse.Action) -> str:
    """What stands for the argument's value in the help; empty for a switch."""
    if action.nargs == 0:
        return ""
    shown: Any = action.metavar
    if shown is None:
        shown = "{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.dest.upper()
    one = " ".join(shown) if isinstance(shown, tuple) else str(shown)
    return {"?": f"[{one}]", "*": f"[{one} ...]", "+": f"{one} [{one} ...]"}.get(str(action.nargs), one)


def _prose(text: str) -> str:
    """Help text as reStructuredText: its code in double backquotes, nothing else marked up."""
    parts = re.split(r"(`[^`]+`)", " ".join(text.split()))
    return "".join(
        f"`{part}`" if part.startswith("`") else re.sub(r"([\\*_|`])", r"\\\1", part) for part in parts
    )


def setup(app: "Sphinx") -> dict[str, bool]:
    """Adds the directive."""
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    class Commands(SphinxDirective):
        """`.. tilenca-commands::` in a page of reStructuredText."""

        def run(self) -> list[nodes.Node]:
            return self.parse_text_to_nodes(rendered(), allow_section_headings=True)

    app.add_directive("tilenca-commands", Commands)
    return {"parallel_read_safe": True}
