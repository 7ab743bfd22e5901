"""The verbs of `tsc` and their options, as the code has them: so that no test forgets one."""

from __future__ import annotations

from tiniscript.cli import options
from tiniscript.cli.texts.verbs import VERBS


def parsers() -> dict[str, options.Options]:
    """Return the options of every verb."""
    return {verb: options.Options(verb, "en") for verb in VERBS}


def values_of(parser: options.Options) -> dict[str, str]:
    """Return the options of a verb that take a value: how each is called, by its name there."""
    return {
        each.dest: (each.option_strings or [""])[0]
        for each in parser._actions
        if each.nargs in (None, "?")
    }
