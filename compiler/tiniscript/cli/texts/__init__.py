"""The sentences of `tsc` itself, in the user's language; those about programs are in `diagnostics`.

Knows how values are put into a sentence, and which language a person has.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence

from tiniscript.base import languages
from tiniscript.base.source import printable

CATALOGUE = "command"
MAX_VALUE_CHARACTERS = 2000  # characters of a value in a sentence
# The words that follow a number, in singular and plural; catalogues have both forms. Other words
# have a sentence of their own for one.
COUNTED_NOUNS = ("counted_bytes", "counted_checks")
SEVERAL_COUNT = 5  # a typical plural number in sentences


class Sentence(str):
    """A sentence, or several: `format` makes all values printable.

    A value may come from a file or a robot: it must not move the cursor or begin a line. A value
    that is a `Sentence` itself stays unchanged. Printed, it is still one: a terminal wraps it.
    `language` is the one that it is in.
    """

    language = languages.SOURCE_LANGUAGE

    def __str__(self) -> str:
        return self

    def format(self, *values: object, **named_values: object) -> Sentence:
        printable_values = {key: _printable(value) for key, value in named_values.items()}
        template = "".join(self)
        for key, value in printable_values.items():
            if isinstance(value, int | str) and str(value).isdecimal():
                for noun_key in COUNTED_NOUNS:
                    placeholder, form = (
                        f"{{{key}}} {languages.plural_text(CATALOGUE, noun_key, n, self.language)}"
                        for n in (SEVERAL_COUNT, int(value))
                    )
                    template = template.replace(placeholder, form)
        return Sentence(template.format(*map(_printable, values), **printable_values))


def _printable(value: object) -> object:
    if isinstance(value, str) and not isinstance(value, Sentence):
        return printable(value, MAX_VALUE_CHARACTERS)
    return value


def text(key: str, language: str) -> str:
    """Return the sentence with this key."""
    sentence = Sentence(languages.text(CATALOGUE, key, language))
    sentence.language = language
    return sentence


def say(key: str, language: str, /, **values: object) -> None:
    """Print a sentence, with these values in its gaps."""
    print(text(key, language).format(**values))


def say_aside(key: str, language: str, /, **values: object) -> None:
    """Print a sentence on standard error, if no results are."""
    print(text(key, language).format(**values), file=sys.stderr, flush=True)


def has_text(key: str) -> bool:
    return languages.find_text(CATALOGUE, key, languages.SOURCE_LANGUAGE) is not None


def language_of(arguments: Sequence[str], environ: Mapping[str, str] = os.environ) -> str:
    """Return the code of a language: from `--lang`, else from the locale, else English."""
    for k, word in enumerate(arguments):
        value = word[7:] if word.startswith("--lang=") else None
        if word == "--lang" and k + 1 < len(arguments):
            value = arguments[k + 1]
        if value in languages.languages():
            return value
    locale_names = (environ.get(name) for name in ("LC_ALL", "LC_MESSAGES", "LANG"))
    return languages.find_language(next(filter(None, locale_names), None) or _system_language())


def _system_language() -> str:
    """Return the language of Windows' own settings, which no variable names."""
    if sys.platform != "win32":
        return ""
    import locale

    return locale.getlocale()[0] or ""
