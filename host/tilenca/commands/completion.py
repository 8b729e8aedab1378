"""Completion of commands, options and names in the shell, by argcomplete where it is installed."""

import argparse
import os
import shlex
from collections.abc import Callable
from typing import Any

from tilenca.base.shipped import model_names, shapes_names

ASKED = "_ARGCOMPLETE"  # argcomplete's own: the shell sets it when it asks
LINE = "COMP_LINE"


def is_asked() -> bool:
    """Whether the shell asks for completions, instead of a person for a command."""
    return ASKED in os.environ


def command_asked() -> str | None:
    """The command of the line to be completed; None: it is the command that is to be completed."""
    line = os.environ.get(LINE, "")
    try:
        words = shlex.split(line)
    except ValueError:  # a quotation mark that is not closed yet
        words = line.split()
    begun = [word for word in words[1:] if not word.startswith("-")]
    return begun[0] if begun and (len(words) > 2 or line.endswith(" ")) else None


def complete(parser: argparse.ArgumentParser) -> None:
    """Answers the shell and ends the process; does nothing where argcomplete is not installed.

    Args:
        parser: with the arguments of the command that is asked about.
    """
    try:
        import argcomplete
    except ImportError:
        return
    for action in _actions(parser):
        names = NAMES.get(action.dest)
        if names is not None and action.choices is None:
            files = argcomplete.completers.FilesCompleter()
            action.completer = _with(names, files)  # type: ignore[attr-defined]
    argcomplete.autocomplete(parser)


def _recipes() -> list[str]:
    from tilenca.training.recipes import RECIPES

    return list(RECIPES)


# What an argument of this name takes beside files.
NAMES: dict[str, Callable[[], list[str]]] = {
    "shapes": shapes_names,
    "model": model_names,
    "folder": model_names,
    "recipe": _recipes,
}


def _with(names: Callable[[], list[str]], files: Callable[..., Any]) -> Callable[..., list[str]]:
    def completions(prefix: str, **more: Any) -> list[str]:
        return [name for name in names() if name.startswith(prefix)] + list(files(prefix, **more))

    return completions


def _actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    actions = list(parser._actions)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            actions += [inner for one in action.choices.values() for inner in one._actions]
    return actions
