"""The text of `tsc --help` and `tsc help`, made from the tables of verbs and options.

Lays the text out; `terminal/pager.py` shows it.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Iterator
from shutil import get_terminal_size
from textwrap import wrap

from tiniscript.cli.terminal import pager
from tiniscript.cli.texts.options import PROGRAM, Option, shown_of
from tiniscript.cli.texts.verbs import (
    FIRST_COMMANDS,
    NOTES,
    STEPS,
    VERBS,
    command_words,
    steps_of,
    verb_sentence,
    verb_text,
)

WIDTH = 80  # columns, where the terminal has as many
MIN_WIDTH = 40
SET_COMMAND = "set"

Row = tuple[str, str]  # the command, and its description


def show(make_page: Callable[[str, int], str], language: str) -> None:
    pager.show(make_page(language, _width()), language)


def list_commands(commands: Iterable[str], language: str, width: int = WIDTH) -> str:
    """Return a list of commands with their descriptions."""
    rows = [_row(command, language) for command in commands]
    return "\n".join(_two_columns(rows, _left_width(rows, width * 4 // 10), width)) + "\n"


def help_of(command: str, language: str, width: int = WIDTH) -> str:
    """Return the help of a command; that of a verb names its steps, which have their own."""
    options = shown_of(command)
    steps = steps_of(command)
    parts = [
        _paragraphs("\n".join(usage(command, language)), width),
        _paragraphs(verb_sentence(command, "says", language), width),
        "\n".join(_option_lines(options, language, width)),
        "\n".join(_step_lines(steps, language, width)) if steps else "",
        _paragraphs(verb_sentence(command, "ends", language), width),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _step_lines(steps: list[str], language: str, width: int) -> Iterator[str]:
    yield _paragraphs(verb_text("steps", language), width)
    yield list_commands(steps, language, width).rstrip("\n")


def overview(language: str, width: int = WIDTH) -> str:
    """Return the help of `tsc`: the verbs that most people need, with an example each."""
    parts = [
        _paragraphs(verb_text("title", language), width),
        list_commands(FIRST_COMMANDS, language, width).rstrip("\n"),
        "\n".join(_option_lines(shown_of("tsc"), language, width)),
        _paragraphs(verb_text("more", language), width),
    ]
    return "\n\n".join(parts) + "\n"


def full_help(language: str, width: int = WIDTH) -> str:
    """Return the text of `tsc help all`: every verb, in groups."""
    parts = [_paragraphs(verb_text("title", language), width)]
    grouped_rows = command_groups(language)
    left_width = _left_width([row for _, rows in grouped_rows for row in rows], width * 4 // 10)
    for heading, rows in grouped_rows:
        parts.append(_paragraphs(heading, width))
        parts.append("\n".join(_two_columns(rows, left_width, width)))
    parts.append("\n".join(_option_lines(shown_of("tsc"), language, width)))
    parts.append("\n".join(_paragraphs(verb_text(note, language), width) for note in NOTES))
    return "\n\n".join(parts) + "\n"


def command_groups(language: str) -> list[tuple[str, list[Row]]]:
    """Return the headings of all verbs with the commands below each, and their descriptions."""
    rows_by_heading: dict[str, list[Row]] = {}
    for verb, group in VERBS.items():
        commands_alone = (
            [] if verb == SET_COMMAND else [verb]
        )  # the option does nothing without a value
        rows = [_row(command, language) for command in (*commands_alone, *steps_of(verb))]
        rows_by_heading.setdefault(verb_text(f"group/{group}", language), []).extend(rows)
    return list(rows_by_heading.items())


def _row(command: str, language: str) -> Row:
    summary = verb_sentence(command, "summary", language).replace("`", "")
    return f"tsc {verb_sentence(command, 'example', language)}", summary


def usage(command: str, language: str) -> list[str]:
    """Return the usage lines of a command."""
    if usages := verb_sentence(command, "usage", language):
        head = STEPS[command].head if command in STEPS else command
        return [f"tsc {head} {usage_text}" for usage_text in usages.split("\n")]
    words = [f"tsc {command_start(command, language)}"]
    for option in shown_of(command):
        if option.is_argument:
            label = option.shown_value(language) + (" ..." if option.repeats else "")
            is_required = option.kind == PROGRAM  # -e may replace the program
            words.append(label if is_required else f"[{label}]")
    return [" ".join([*words, verb_text("usage", language)])]


def command_start(command: str, language: str) -> str:
    """Return the beginning of a command: `doctor --ports`; `firmware --board NAME|FILE`."""
    words = command_words(command)
    last_word = words.split()[-1]
    options = [option for option in shown_of(command) if option.flags == last_word]
    return " ".join([words, *(_value_label(option, language) for option in options)]).rstrip()


def signature(option: Option, language: str) -> str:
    """Return an option as help shows it: `-o FILE`."""
    value = _value_label(option, language)
    if option.is_argument:
        return value
    return f"{', '.join(option.flags.split())} {value}".rstrip()


def _value_label(option: Option, language: str) -> str:
    value = option.shown_value(language)
    return f"[{value}]" if option.may_be_alone else value


def _option_lines(options: Iterable[Option], language: str, width: int) -> Iterator[str]:
    """Yield the rows of options; those for a virtual robot only have a heading of their own."""
    rows_by_virtual: dict[bool, list[Row]] = {False: [], True: []}
    common_rows: list[Row] = []
    has_virtual_section = any(option.name == "virtual" for option in options)
    for option in options:
        row = signature(option, language), option.help(language)
        if option.verbs in ("*", "tsc"):
            common_rows.append(row)
        else:
            rows_by_virtual[option.is_virtual and has_virtual_section].append(row)
    all_rows = [*rows_by_virtual[False], *rows_by_virtual[True], *common_rows]
    left_width = _left_width(all_rows, width * 3 // 10)
    yield from _two_columns(rows_by_virtual[False], left_width, width)
    if rows_by_virtual[True]:
        yield ""
        yield verb_text("virtual", language)
        yield from _two_columns(rows_by_virtual[True], left_width, width)
        yield ""
    yield from _two_columns(common_rows, left_width, width)


def _left_width(rows: Iterable[Row], most_width: int) -> int:
    """Return the width of the left column, at most `most_width`."""
    return max((len(row[0]) for row in rows if len(row[0]) <= most_width), default=most_width)


def _two_columns(rows: Iterable[Row], left_width: int, width: int) -> Iterator[str]:
    """Yield two columns; texts too long for the first one have a line of their own."""
    indent = " " * (left_width + 4)
    for command, summary in rows:
        lines = _wrap(summary, width - len(indent))
        if len(command) > left_width:
            yield f"  {command}"
        else:
            yield f"  {command:{left_width}}  {lines.pop(0)}"
        for line in lines:
            yield indent + line


def _paragraphs(text: str, width: int) -> str:
    return "\n".join(line for paragraph in text.split("\n") for line in _wrap(paragraph, width))


def _wrap(text: str, width: int) -> list[str]:
    """Return the lines of a text. Text between backticks is not broken if it fits on a line."""

    def keep_spaces(match: re.Match[str]) -> str:
        return match[1].replace(" ", "\0") if len(match[1]) <= width else match[1]

    unbroken_text = re.sub("`([^`]*)`", keep_spaces, text)
    lines = wrap(unbroken_text, width, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\0", " ") for line in lines]


def _width() -> int:
    """Return the width of help texts, which is smaller on a narrow terminal."""
    if not sys.stdout.isatty():
        return WIDTH
    return max(MIN_WIDTH, min(WIDTH, get_terminal_size().columns))
