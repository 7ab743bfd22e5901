"""The verbs of `tsc` and their options, as the code has them: so that no test forgets one."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module

import pytest

from tiniscript.cli import VERBS, options


def parsers() -> dict[str, options.Options]:
    """Return the options of every verb."""
    found: dict[str, options.Options] = {}

    def read(self: options.Options, arguments: list[str]) -> Namespace | None:
        found[self.verb] = self
        return None  # as if the person had asked for help

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(options.Options, "read", read)
        for verb in VERBS:
            assert import_module(f"tiniscript.cli.commands.{verb}").run([], "en") == 0
    assert set(found) == set(VERBS)
    return found


def values_of(parser: options.Options) -> dict[str, str]:
    """Return the options of a verb that take a value: how each is called, by its name there."""
    return {
        each.dest: (each.option_strings or [""])[0]
        for each in parser._actions
        if each.nargs in (None, "?")
    }
