"""The options of a verb: reads them with argparse, and says what is wrong in two languages."""

from __future__ import annotations

import re
from argparse import ArgumentParser, HelpFormatter, Namespace
from typing import NoReturn

from tiniscript.cli.errors import Trouble

# What argparse says, and how Spanish says it.
_SPANISH = (
    (r"the following arguments are required: (.*)", r"falta \1"),
    (r"unrecognized arguments: (.*)", r"no conozco \1"),
    (r"argument (\S+): expected one argument", r"a \1 le falta su valor"),
    (r"argument (\S+): not allowed with argument (\S+)", r"\1 no va junto con \2"),
    (r"argument (\S+): ignored explicit argument (.*)", r"\1 no lleva valor: \2"),
)


def _plain_formatter(prog: str) -> HelpFormatter:
    """argparse asks for one even where no help is printed; with a width it starts faster."""
    return HelpFormatter(prog, width=80)


class Options(ArgumentParser):
    """A verb's options. Every verb has `--lang` and `--help`."""

    def __init__(self, verb: str, language: str, help_text: tuple[str, str]) -> None:
        super().__init__(
            prog=f"tsc {verb}", add_help=False, allow_abbrev=False, formatter_class=_plain_formatter
        )
        self.verb = verb
        self.language = language
        self.help_text = help_text[language == "es"]
        self.add_argument("--lang")
        self.add_argument("-h", "--help", action="store_true")

    def takes_program(self) -> None:
        """Add what every verb that takes a program has."""
        self.add_argument("program", nargs="?")
        self.add_argument("-e", dest="texts", action="append", default=[])
        self.add_argument("--robot")

    def read(self, arguments: list[str]) -> Namespace | None:
        """Return the options, or None where the person asked for help and has it now."""
        if "-h" in arguments or "--help" in arguments:
            print(self.help_text, end="")
            return None
        options = self.parse_args(arguments, Namespace(verb=self.verb, language=self.language))
        if options.lang is not None and options.lang not in ("en", "es"):
            raise Trouble(2, "bad_language", found=options.lang)
        from tiniscript.cli import paths

        paths.check(options, self.language)
        return options

    def error(self, message: str) -> NoReturn:
        if self.language == "es":
            for pattern, spanish in _SPANISH:
                message = re.sub(pattern, spanish, message)
        raise Trouble(2, "bad_option", detail=message, verb=self.verb)


def whole_number(option: str, found: str | None, default: int, low: int, high: int,
                 language: str) -> int:  # fmt: skip
    """Return what an option says: a whole number from `low` to `high`."""
    if found is None:
        return default
    digits = found[1:] if found[:1] == "-" else found
    if not (digits.isascii() and digits.isdigit() and len(digits) < 20):
        value = low - 1
    else:
        value = int(found)
    if not low <= value <= high:
        from tiniscript.cli.texts.common import text

        allowed = text("range_whole", language).format(low=low, high=high)
        raise Trouble(2, "bad_number", option=option, range=allowed, found=found)
    return value


def decimal(found: str) -> int | None:
    """Return the thousandths of a decimal, rounded; None where it is none or far too large."""
    from tiniscript.fixed_point import read_literal

    digits = found[1:] if found[:1] == "-" else found
    if not re.fullmatch(r"[0-9]+(\.[0-9]+)?|\.[0-9]+", digits, re.ASCII):
        return None
    value, _ = read_literal(digits)
    return -value if found[:1] == "-" else value
