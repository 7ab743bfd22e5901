"""The texts of all catalogues."""

from __future__ import annotations

import re
from functools import cache

from tiniscript.base.languages import languages, texts
from tiniscript.diagnostics import rendering

LANGUAGES = languages()


@cache
def catalogue_texts(language: str, name: str = "command") -> dict[str, str]:
    """Return all texts of a catalogue by key; of one with a plural, its last form."""
    texts_by_key = texts(name, language)
    return {
        key: value if isinstance(value, str) else value["other"]
        for key, value in texts_by_key.items()
    }


def texts_in_all_languages(key: str) -> list[str]:
    """Return a text of the command in each language, English first."""
    return [catalogue_texts(language)[key] for language in languages()]


def gap_names(code: str) -> set[str]:
    """Return the names of the gaps in a code's message and thing to try, which all need a value.

    Of several texts, only the last one must be fillable: it is used if no other can be.
    """
    template = "".join(list(rendering._templates(f"{code}/{part}", lang))[-1]
                   for part in ("message", "try") for lang in LANGUAGES)  # fmt: skip
    return set(re.findall(r"\{@?(\w+)\}", template))
