"""Former verbs are now parts of other commands, which are named and unique."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.rows import each_row
from tests.support.texts import LANGUAGES
from tests.support.texts import catalogue_texts as all_said
from tiniscript.base.languages import FOLDER
from tiniscript.cli.options import Options
from tiniscript.cli.texts.options import command_of, options_of, selecting_options_of
from tiniscript.cli.texts.verbs import (
    COMMANDS,
    FORMER_COMMANDS,
    STEPS,
    VERBS,
    command_words,
    steps_of,
)
from tiniscript.cli.verbless import is_help

OLD_VERBS = "|".join(FORMER_COMMANDS)
# `tsc name`, as a command or in a list of words; the changelog may mention former names.
OLD_VERB_PATTERN = re.compile(
    rf"(?:\btsc|-m tiniscript)(?:['\", ]+--lang['\", ]+\w\w)?['\", ]+(?:{OLD_VERBS})\b(?!=)"
)
FILES_WITH_OLD_VERBS = ("CHANGELOG.md", "tests/cli/test_old_verbs.py")
MISSPELLED = "complie "  # the misspelling that a document shows
FILE_SUFFIXES = ("c", "cpp", "h", "html", "ini", "ino", "js", "json", "md", "mjs", "ps1", "py",
                 "sh", "svg", "toml", "txt", "yml", "yaml")  # fmt: skip
FOREIGN_FOLDERS = {".git", ".venv", ".pio", "node_modules", "__pycache__", "build", "dist"}


def files() -> Iterator[Path]:
    """Yield the texts of the repository, and of its generated files."""
    for path in ROOT.rglob("*"):
        name = path.relative_to(ROOT)
        if (
            not FOREIGN_FOLDERS & {*name.parts}
            and path.suffix[1:] in FILE_SUFFIXES
            and path.is_file()
        ):
            if name.as_posix() not in FILES_WITH_OLD_VERBS and ".mypy_cache" not in name.parts:
                yield path


def test_no_file_names_an_old_verb() -> None:
    count = 0
    old_uses: list[str] = []
    for path in files():
        count += 1
        text = path.read_text(encoding="utf-8", errors="replace")
        old_uses += [
            f"{path.relative_to(ROOT)}: {match[0]}" for match in OLD_VERB_PATTERN.finditer(text)
        ]
    assert count > 1000 and not old_uses, "\n".join(old_uses)


def test_the_pattern_finds_former_commands() -> None:
    for name in FORMER_COMMANDS:
        for words in ("Try:  tsc {}", "`tsc {} x`", '["tsc", "{}"]', "python -m tiniscript {}",
                      '"-m tiniscript", "--lang", "es", "{}"'):  # fmt: skip
            assert OLD_VERB_PATTERN.search(words.format(name)), words
    for command in COMMANDS:
        assert not OLD_VERB_PATTERN.search(f"tsc {command_words(command)}"), command


# -- commands in texts ----------------------------------------------------------------------------


def commands_in(text: str, is_document: bool, is_robots: bool = False) -> Iterator[str]:
    """Yield the commands of a text: between backticks, and in messages after two blanks, too.

    A robot has neither: in its messages and sources, a command ends at a sign.
    """
    yield from re.findall(r"`tsc ([^`\n]+)`", text)
    yield from re.findall(r"^\$ tsc (.+)$", text, re.M)
    if is_robots:
        yield from re.findall(r"\btsc ([a-z][-a-z ]*)", text)
    elif not is_document:
        yield from re.findall(r"  tsc ((?:[^ `]+ ?)+)", text)


def find_unknown_word(command: str) -> str | None:
    """Return the word of a command that no table has, or None."""
    if command.startswith(MISSPELLED):
        return None
    words = re.sub(r"[\"'“”|]|\{\w+\}|…|\.\.\.", "", command).split()
    if not words or words[0].startswith("-") or not re.fullmatch("[a-z]+", words[0]):
        return None  # `tsc --help`, `tsc COMMAND`
    if words[0] not in VERBS and not is_help(words[0]):
        return words[0]
    name, _ = command_of(words[0] if words[0] in VERBS else "help", words[1:])
    heads = {STEPS[step].head for step in steps_of(words[0])} - {words[0]}
    if heads and name == words[0] and re.fullmatch("[a-z]+", "".join(words[1:2])):
        return words[1]  # `tsc set` has its steps by a word
    known_names = {
        flag
        for option in [*options_of(name), *selecting_options_of(name)]
        for flag in option.flags.split()
    }
    flags = [re.match("-[-a-z0-9]+", word) for word in words[1:]]
    flag_names = [flag[0] for flag in flags if flag is not None and flag[0].startswith("--")]
    return next((flag for flag in flag_names if flag not in known_names), None)


@pytest.mark.parametrize("language", LANGUAGES)
def test_messages_suggest_only_existing_commands(language: str) -> None:
    count = 0
    for path in (FOLDER / language).glob("*.toml"):
        if path.stem == "language" or not all_said(language, path.stem):
            continue
        for key, text in all_said(language, path.stem).items():
            is_robots = path.stem == "robot"
            for command in commands_in(text, is_document=False, is_robots=is_robots):
                count += 1
                assert find_unknown_word(command) is None, (path.stem, key, command)
    assert count > 100
    owned_text = all_said(language, "robot")["remark/NOT_OWNER"]
    assert [*commands_in(owned_text, is_document=False, is_robots=True)]


def test_robot_sources_suggest_only_existing_commands() -> None:
    """The compiler shows it to the person who builds a firmware."""
    count = 0
    for path in files():
        if path.suffix in (".cpp", ".h") and "src" in path.parts:
            strings = re.findall(r'"((?:\\.|[^"\\\n])*)"', path.read_text(encoding="utf-8"))
            for command in commands_in(" ".join(strings), is_document=False, is_robots=True):
                count += 1
                assert find_unknown_word(command) is None, (path.relative_to(ROOT), command)
    assert count


def test_a_wrong_command_in_a_robots_message_is_found() -> None:
    for wrong_command in (
        "Owned: tsc set txet on, or button 2 s.",
        "Take other pins with tsc firmwear -b.",
    ):
        (command,) = commands_in(wrong_command, is_document=False, is_robots=True)
        assert find_unknown_word(command) in ("txet", "firmwear")


def test_documents_suggest_only_existing_commands() -> None:
    """Descriptions of the past do not count."""
    count = 0
    for path in files():
        if path.suffix != ".md":
            continue
        for command in commands_in(path.read_text(encoding="utf-8"), is_document=True):
            count += 1
            assert find_unknown_word(command) is None, (path.relative_to(ROOT), command)
    assert count > 500


# -- the old names --------------------------------------------------------------------------------


@each_row("name", FORMER_COMMANDS)
def test_an_old_name_suggests_the_new_one(tsc: Tsc, name: str) -> None:
    assert name not in VERBS
    for language in LANGUAGES:
        for options in ([], ["--nonsense"], ["--lang", language]):
            result = tsc("--lang", language, name, *options).gives(2, out="")
            assert result.err.count("\n") == 1 and name in result.err
            new_command = result.err.rstrip("\n").rpartition("  tsc ")[2]
            verb, *words = shlex.split(new_command)
            assert command_of(verb, words)[0] == FORMER_COMMANDS[name], new_command
            assert "nonsense" not in new_command and find_unknown_word(new_command) is None


@each_row("old, now", [
    ("explain TS012", "check --explain TS012"), ("explain", "check --explain"),
    ("ports --ask --json", "doctor --ports --ask --json"), ("info --all", "doctor --all"),
    ("ping --port COM5 --count 3", "doctor --port COM5 --count 3"),
    ("fetch", "show --port P"), ("fetch -o a.bin --port P", "show -o a.bin --port P"),
    ("fetch --virtual", "show --virtual"), ("undo --all", "start --previous --all"),
    ("keys", "set owner --list"), ("keys --accept 12347f3a", "set owner --accept 12347f3a"),
    ("keys --json", "set owner --list --json"),
    ("disown --teacher", "set owner --give-up --teacher"),
    ("board my.toml -o own.h", "firmware --board my.toml -o own.h"),
    ("wiring -o 'a page.html'", "firmware --wiring -o 'a page.html'"),
    ("name 'ANA\x1b[31m'", "set name 'ANA?[31m'"), ("trim --balance -5", "set trim --balance -5"),
    ("wifi --help", "set wifi --help"), ("completion bash", "help --completion bash"),
    ("text on", "set text on"), ("link", "monitor --hold"),
])  # fmt: skip
def test_arguments_of_an_old_command_follow_the_new_one(tsc: Tsc, old: str, now: str) -> None:
    result = tsc(*shlex.split(old), "--lang", "en").gives(2, out="")
    assert result.err.rstrip("\n").rpartition("  tsc ")[2].removesuffix(" --lang en") == now


def test_help_on_an_old_name_is_that_of_the_new_command(tsc: Tsc) -> None:
    for name, command in FORMER_COMMANDS.items():
        help_on_name = tsc("help", name, "--lang", "en").gives(0)
        assert help_on_name.out == tsc("help", command, "--lang", "en").out or command in STEPS


@each_row("words, first, second", [
    ("doctor --ports --identify", "doctor --ports", "doctor --identify"),
    ("set owner --give-up --list", "set owner --give-up", "set owner --list"),
    ("firmware --wiring --board x", "firmware --wiring", "firmware --board"),
])  # fmt: skip
def test_two_steps_at_once_are_refused(tsc: Tsc, words: str, first: str, second: str) -> None:
    tsc(*words.split(), "--lang", "en").gives(2, f"tsc {first} or tsc {second}", out="")


@each_row("words, other", [
    ("doctor --pin 1234", "doctor --module"), ("doctor --ports --watch 3", "doctor"),
    ("set owner --balance 3", "set trim"), ("show --port P --arduino", "show"),
    ("check --explain TS012 --fix", "check"), ("set --give-up", "set owner --give-up"),
])  # fmt: skip
def test_an_option_of_another_step_is_named_with_it(tsc: Tsc, words: str, other: str) -> None:
    option = words.split()[-2] if words.split()[-1][0] != "-" else words.split()[-1]
    message = f"{option} is an option of tsc {other}, not of tsc "
    tsc(*words.split(), "--lang", "en").gives(2, message, f"Try:  tsc {other} --help", out="")


def test_the_word_after_set_may_come_after_options(tsc: Tsc) -> None:
    for words in (["--port", "trim", "name"], ["--lang", "en", "name"], ["name", "--port", "x"]):
        tsc("set", *words).gives(2, "which name?", out="")
    tsc("set", "--lang", "en").gives(2, "owner, name, trim, text or wifi")
    for options in ([], ["3", "--balance"]):  # the first mistake is reported first
        tsc("set", "trmi", *options, "--lang", "en").gives(2, "Did you mean trim?")


def test_each_command_is_chosen_by_its_typed_name() -> None:
    for command in COMMANDS:
        verb, *words = command_words(command).split()
        assert command_of(verb, words)[0] == command
        for flag in STEPS[command].selecting_flags if command in STEPS else ():
            head = STEPS[command].head.split()[1:]
            assert command_of(verb, [*head, f"{flag}=x"])[0] == command
            assert command_of(verb, [*head, "--", flag])[0] != command
        assert Options(command, "en").verb == command_words(command)
