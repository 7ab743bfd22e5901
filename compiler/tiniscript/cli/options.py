"""The options of a command: reads them with argparse, and reports mistakes."""

from __future__ import annotations

import re
import sys
from argparse import ArgumentParser, HelpFormatter, Namespace
from collections.abc import Sequence
from functools import partial
from typing import NoReturn

from tiniscript import robots
from tiniscript.base.fixed_point import as_text, read_literal
from tiniscript.base.kit import Device
from tiniscript.cli import paths
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.texts import text
from tiniscript.cli.texts.options import Option, options_of, selecting_options_of
from tiniscript.cli.texts.verbs import STEPS, command_words, steps_of, verb_text
from tiniscript.robots.profile import Robot

# The messages of argparse, and their replacements.
_MESSAGES = {
    "missing": r"the following arguments are required: (.*)",
    "unknown": r"unrecognized arguments: (.*)",
    "value": r"argument (\S+): expected one argument",
    "no_value": r"argument (\S+): ignored explicit argument (.*)",
}


# Former options, and the commands that replace them.
FORMER_OPTIONS = {("run", "--replay"): "run run.tsr"}
OTHER_RUN_VERB = {"run": "upload", "upload": "run"}  # a program without a robot, and with one


class Options(ArgumentParser):
    """The options of a command, as the table of options has them."""

    def __init__(self, command: str, language: str) -> None:
        # argparse always needs a formatter, and with a width it starts faster
        formatter = partial(HelpFormatter, width=80)
        self.command, self.verb = command, command_words(command)
        super().__init__(
            f"tsc {self.verb}", add_help=False, allow_abbrev=False, formatter_class=formatter
        )
        self.language = language
        self.table = options_of(command)
        for option in self.table:
            self._add_option(option)

    def _add_option(self, option: Option) -> None:
        if option.is_argument:
            self.add_argument(option.name, nargs="*" if option.repeats else "?")
        elif option.kind is None:
            self.add_argument(*option.flags.split(), dest=option.name, action="store_true")
        elif option.repeats:
            self.add_argument(option.flags, dest=option.name, action="append", default=[])
        elif option.may_be_alone:
            self.add_argument(option.flags, dest=option.name, nargs="?", const="")
        else:
            self.add_argument(option.flags, dest=option.name)

    def read(self, arguments: list[str]) -> Namespace | None:
        """Return the options, or None after printing the help that the user has asked for."""
        own_words = arguments[: arguments.index("--")] if "--" in arguments else arguments
        if "-h" in own_words or "--help" in own_words:
            from tiniscript.cli.help import help_of, show

            show(partial(help_of, self.command), self.language)
            return None
        defaults = Namespace(verb=self.verb, language=self.language)
        options, unknown_words = self.parse_known_args(arguments, defaults)
        for option in self.table:
            self._check_choice(option, getattr(options, option.name))
        if unknown_words:  # follows a wrong value: `tsc set nme TINI`
            self.error(f"unrecognized arguments: {' '.join(unknown_words)}")
        if sys.platform == "win32" and getattr(options, "programs", None):
            from tiniscript.cli.windows_names import matching_files

            options.programs = [
                file_name
                for name in options.programs
                for file_name in matching_files(name) or [name]
            ]
        paths.check(options, self.language)
        return options

    def accepts(self, words: list[str]) -> bool:
        """Return whether the table of options allows these words after the command."""
        try:
            self.parse_args(words)
        except CommandError:
            return False
        return True

    def _check_choice(self, option: Option, typed_value: str | None) -> None:
        """Refuse a value that is not among the option's choices, or that goes with another one.

        Other options do not matter: in `--board nano --port P`, the mistake is the chip, not an
        extra board.
        """
        if option.flags == "--board" and typed_value is not None:
            from tiniscript.flash.bootloaders import BOARDS

            if typed_value.lower() in BOARDS:
                raise CommandError(2, "board_is_chip", chip=typed_value.lower())
        choices = option.kind.choices if option.kind is not None else ()
        if choices and typed_value is not None and typed_value not in choices:
            label = option.shown_value(self.language) if option.is_argument else option.flags
            raise bad_choice(label, choices, typed_value, self.language)

    def error(self, message: str) -> NoReturn:
        unknown_option = message.partition("unrecognized arguments: ")[2].partition(" ")[0]
        present_option = FORMER_OPTIONS.get((self.verb, unknown_option.partition("=")[0]))
        if present_option:
            raise CommandError(
                2, "was_option", was=unknown_option.partition("=")[0], now=present_option
            )
        other_verb = OTHER_RUN_VERB.get(self.verb)
        if other_verb and _has_flag(other_verb, unknown_option):
            raise CommandError(
                2, "option_of_other", option=unknown_option, verb=self.verb, other=other_verb
            )
        self._check_option_of_step(unknown_option.partition("=")[0])
        suggestion = self._suggest_flag(unknown_option)
        for key, pattern in _MESSAGES.items():
            if match := re.fullmatch(pattern, message):
                message = verb_text(f"wrong/{key}", self.language).format(*match.groups())
        raise CommandError(2, "bad_option", detail=message, verb=self.verb, near=suggestion)

    def _check_option_of_step(self, unknown_option: str) -> None:
        """Print the step of the verb that has an unknown option."""
        verb = self.verb.split()[0]
        steps = [name for name in (verb, *steps_of(verb)) if _has_flag(name, unknown_option)]
        if not steps or not unknown_option.startswith("-"):
            return
        other_command = command_words(steps[0])
        flags_by_step = {name: step.selecting_flags for name, step in STEPS.items()}
        if flags_by_step.get(self.command) and all(
            unknown_option in flags_by_step.get(step_name, ()) for step_name in steps
        ):
            raise CommandError(2, "one_step", first=self.verb, second=other_command)
        raise CommandError(
            2, "option_of_step", option=unknown_option, verb=self.verb, other=other_command
        )

    def _suggest_flag(self, typed_word: str) -> str:
        """Return a suggestion for an unknown word, or ""."""
        table = [*self.table, *selecting_options_of(self.command)]
        flags = [flag for option in table if not option.is_argument
                 for flag in option.flags.split()]  # fmt: skip
        if "--robot" in flags and typed_word.lower() in robots.names():
            return f"--robot {typed_word.lower()}"
        return _suggest(typed_word, flags) if typed_word.startswith("--") else ""


def _has_flag(command: str, flag: str) -> bool:
    return any(flag in option.flags.split() for option in options_of(command))


def _suggest(typed_word: str, known_words: Sequence[str]) -> str:
    from tiniscript.base.spelling import nearest

    return nearest(typed_word, known_words) or ""


def bad_choice(
    option: str, choices: Sequence[str], typed_value: str, language: str
) -> CommandError:
    """Return the error for a value that is not among an option's choices."""
    choices_text = f"{', '.join(choices[:-1])} {text('or', language)} {choices[-1]}"
    shown_value = printable_name(typed_value) or "''"
    suggestion = _suggest(typed_value, choices)
    return CommandError(
        2, "bad_choice", option=option, known=choices_text, found=shown_value, near=suggestion
    )


def whole_number(option: str, typed_value: str | None, default: int, low: int, high: int,
                 language: str) -> int:  # fmt: skip
    """Return an option's whole number, from `low` to `high`."""
    if typed_value is None:
        return default
    digits = typed_value[1:] if typed_value[:1] == "-" else typed_value
    if not (digits.isascii() and digits.isdigit() and len(digits) < 20):
        value = low - 1
    else:
        value = int(typed_value)
    if not low <= value <= high:
        range_text = text("range_whole", language).format(low=low, high=high)
        raise CommandError(2, "bad_number", option=option, range=range_text, found=typed_value)
    return value


def decimal(typed_value: str) -> int | None:
    """Return the thousandths of a decimal, rounded; None if it is none or far too large."""
    digits = typed_value[1:] if typed_value[:1] == "-" else typed_value
    if not re.fullmatch(r"[0-9]+(\.[0-9]+)?|\.[0-9]+", digits, re.ASCII):
        return None
    value, _ = read_literal(digits)
    return -value if typed_value[:1] == "-" else value


def thousandths(
    option: str, typed_value: str | None, default: int, low: int, high: int, language: str
) -> int:
    """Return an option's decimal number in thousandths, from `low` to `high`."""
    if typed_value is None:
        return default
    value = decimal(typed_value)
    if value is None or not low <= value <= high:
        range_text = text("range_number", language).format(low=as_text(low), high=as_text(high))
        raise CommandError(
            2,
            "bad_number",
            option=option,
            range=range_text,
            found=printable_name(typed_value) or "''",
        )
    return value


def sensor_lists(option_values: list[str], robot: Robot, language: str) -> dict[int, list[int]]:
    """Return the readings that `--sensor NAME=1,2,3` say, by the sensor's number."""
    sensors = robot.kit.readings
    names = [device.name for device in sensors]
    lists_by_sensor: dict[int, list[int]] = {}
    for option_value in option_values:
        name, separator, values = option_value.partition("=")
        name = name.strip().upper()
        if not name or name not in names:
            sensors_text = ", ".join(sensor.name for sensor in robot.kit.sensors) or text(
                "no_sensors", language
            )
            raise CommandError(2, "no_sensor", robot=robot.name, found=name or option_value,
                               known=sensors_text,
                          near=_suggest(name, [*filter(None, names)]))  # fmt: skip
        sensor_number = names.index(name)
        device = sensors[sensor_number]
        if not separator or not values.strip():
            example = f"{name}={device.text(device.low)},{device.text(device.high)}"
            raise CommandError(2, "sensor_form", example=example)
        if sensor_number in lists_by_sensor:
            raise CommandError(2, "sensor_twice", name=name)
        lists_by_sensor[sensor_number] = [
            _parse_reading(device, value.strip(), language) for value in values.split(",")
        ]
    return lists_by_sensor


def _parse_reading(device: Device, typed_value: str, language: str) -> int:
    if device.is_yes_no:
        value = {"TRUE": 1, "FALSE": 0, "1": 1, "0": 0}.get(typed_value.upper())
        range_text = text("range_yes_no", language)
    else:
        value = decimal(typed_value)
        low, high = device.text(device.low), device.text(device.high)
        range_text = text("range_number", language).format(low=low, high=high)
    if value is None or not device.low <= value <= device.high:
        raise CommandError(
            2, "sensor_value", found=typed_value or "''", name=device.name, range=range_text
        )
    return value


def name_bytes(name: str) -> bytes:
    """Return a name as bytes for the robot. Raises CommandError if it is too long."""
    from tiniscript.link.messages import NAME_BYTES  # few verbs need the link

    data = name.encode("utf-8", "surrogateescape")
    if not 1 <= len(data) <= NAME_BYTES or not name.isprintable() or not name.strip():
        raise CommandError(2, "bad_name", bytes=str(len(data)))
    return data
