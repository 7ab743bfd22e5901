"""Finds the command meant without a verb: `tsc uplod`, `tsc prog.ts`, `tsc help "put on"`.

It also knows commands by the names of former verbs. A question may have words of several languages:
the tables of verbs and options have all of them.
"""

from __future__ import annotations

import re
import shlex
import unicodedata
from functools import cache
from math import log
from pathlib import Path
from typing import NoReturn

from tiniscript.base.languages import languages
from tiniscript.base.source import PROGRAM_SUFFIXES
from tiniscript.base.spelling import nearest
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import Options
from tiniscript.cli.texts.options import command_of, options_of
from tiniscript.cli.texts.verbs import (
    COMMANDS,
    FORMER_COMMANDS,
    STEPS,
    VERBS,
    command_words,
    verb_sentence,
    verb_text,
)


def refuse(name: str, words: list[str], language: str) -> NoReturn:
    """Raise CommandError if a word is in the place of a verb, with `words` after it."""
    if name in FORMER_COMMANDS:
        raise CommandError(
            2, "was_verb", was=name, now=_present_command(FORMER_COMMANDS[name], words, language)
        )
    refuse_program(name)
    raise CommandError(2, "no_verb", found=name, near=guess_verb(name))


def _present_command(command: str, words: list[str], language: str) -> str:
    """Return the current form of a former verb, followed by the words after it if they fit."""
    head = STEPS[command].head if command in STEPS else command
    for command_text in (head, command_words(command)):
        verb, *all_words = [*command_text.split(), *words]
        parsed_command, words_left = command_of(verb, all_words)
        if parsed_command == command and Options(command, language).accepts(words_left):
            return shlex.join([verb, *all_words])
    from tiniscript.cli.help import command_start

    return command_start(command, language)


def guess_verb(name: str) -> str:
    """Return the command that a word other than a verb means, or ""."""
    matching_commands = (
        command
        for command in (*COMMANDS, "--version")
        if _without_accents(name) in _names_in_languages(command).split()
    )
    suggestion = next(matching_commands, None) or nearest(name, (*VERBS, *FORMER_COMMANDS)) or ""
    return command_words(FORMER_COMMANDS.get(suggestion, suggestion))


def is_help(name: str) -> bool:
    """Return whether a word means help in a language: `tsc ayuda`."""
    return _without_accents(name) in _names_in_languages("help").split()


def _names_in_languages(verb: str) -> str:
    """Return the verb's name in each language."""
    return " ".join(
        _without_accents(verb_sentence(verb, "words", language)) for language in languages()
    )


def refuse_program(name: str) -> None:
    """Raise CommandError that names verbs if a program is in the place of one.

    tsc does not choose a verb: a robot moves only when the user has asked for it.
    """
    if name.lower().endswith((*PROGRAM_SUFFIXES, ".bin")) or _is_file(name):
        raise CommandError(2, "file_without_verb", found=_quote(name))
    if "(" in name or "|" in name:
        raise CommandError(2, "text_without_verb", found=_quote(name, is_always_quoted=True))


def _is_file(name: str) -> bool:
    try:
        return Path(name).is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _quote(name: str, is_always_quoted: bool = False) -> str:
    """Return a name as it can be copied into a command."""
    shown_name = printable_name(name)
    return f'"{shown_name}"' if is_always_quoted or " " in shown_name else shown_name


MAX_VERBS = 5  # verbs in an answer
MIN_LETTERS = 3  # shortest word with a meaning
STEM_LETTERS = 5  # letters in which forms of a word agree: connect, connected; conecta, conectar


def verbs_for(question: str) -> list[str]:
    """Return the commands whose texts have the words of a question, best first; most have none.

    A word counts more if fewer commands have it, and more in a command's name (including its old
    verb) and summary than in the rest of its description.
    """
    weights_by_command = {command: _weights(command) for command in COMMANDS}
    scores = dict.fromkeys(COMMANDS, 0.0)
    for stem in _stems(question):
        commands_with_stem = [
            command for command in COMMANDS if stem in weights_by_command[command]
        ]
        for command in commands_with_stem:
            scores[command] += weights_by_command[command][stem] * log(
                1 + len(COMMANDS) / len(commands_with_stem)
            )
    best_score = max(scores.values())
    commands = [
        command for command in COMMANDS if scores[command] and scores[command] >= best_score / 2
    ]
    return sorted(commands, key=lambda verb: -scores[verb])[:MAX_VERBS]


def _weights(verb: str) -> dict[str, int]:
    """Return the weight of each stem in a command's texts."""
    options = [option for option in options_of(verb) if option.verbs not in ("*", "tsc")]

    def stems_of(part: str) -> set[str]:
        return {
            stem for language in languages() for stem in _stems(verb_sentence(verb, part, language))
        }

    help_texts = (option.help(language) for option in options for language in languages())
    flags = (option.flags for option in options)
    weights = dict.fromkeys(_stems(" ".join((*flags, *help_texts))) | stems_of("ends"), 1)
    weights |= dict.fromkeys(stems_of("says"), 2)
    weights |= dict.fromkeys(stems_of("summary"), 4)
    weights |= dict.fromkeys(_stems(_names_in_languages(verb)), 6)
    names = [verb if verb in VERBS else ""]
    names += [name for name, command in FORMER_COMMANDS.items() if command == verb]
    return weights | dict.fromkeys(_stems(" ".join(names)), 12)


def _stems(text: str) -> set[str]:
    words = re.findall("[a-z]+", _without_accents(text))
    telling_words = (
        word for word in words if len(word) >= MIN_LETTERS and word not in _idle_words()
    )
    return {
        word.removesuffix("s")[:STEM_LETTERS] for word in telling_words
    }  # port and ports are one


@cache
def _idle_words() -> frozenset[str]:
    """Return words that do not help to identify a command."""
    return frozenset(
        word for language in languages() for word in verb_text("idle", language).split()
    )


def _without_accents(text: str) -> str:
    """Return a text in small letters without accents."""
    return re.sub("[\u0300-\u036f]", "", unicodedata.normalize("NFD", text.casefold()))
