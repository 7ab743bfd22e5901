"""The commands of `tsc` and their options, as the code has them: so that no test forgets one."""

from __future__ import annotations

from tiniscript.cli import options
from tiniscript.cli.texts.options import options_of
from tiniscript.cli.texts.verbs import COMMANDS, command_words


def parsers() -> dict[str, options.Options]:
    """Return the options of every command."""
    return {command: options.Options(command, "en") for command in COMMANDS}


def words_of(command: str) -> list[str]:
    """Return the words of a command, without a value that selects it."""
    flags = {flag for option in options_of(command) if option.kind for flag in option.flags.split()}
    return [word for word in command_words(command).split() if word not in flags]


def values_of(parser: options.Options) -> dict[str, str]:
    """Return the options of a command that take a value: how each is called, by its name there."""
    return {
        action.dest: (action.option_strings or [""])[0]
        for action in parser._actions
        if action.nargs in (None, "?")
    }
