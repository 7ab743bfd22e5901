"""The sentences about a refused profile: a cause and a remedy, in the reader's language.

Does not know when a code applies. The sentence of a code with `/near` is used if `near` holds a
similar name.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base import languages
from tiniscript.base.source import printable
from tiniscript.robots.profile import ProfileRefused, Reason

CATALOGUE = "refusals"
SHOWN_CHARACTERS = 40
DEVICE_PATH = re.compile(r"board\.(?:sensors|actuators)\.[^.]*")  # the path of its table


def describe(refusal: ProfileRefused, language: str) -> list[str]:
    """Return a sentence for each reason."""
    sentences = []
    for code, values in _causes(refusal.reasons):
        gap_values = {key: printable(value) for key, value in values.items()}
        group = {"wrong_type": "type", "pin_cannot": "need"}.get(code)
        if group:
            gap_values = {
                key: languages.find_text(CATALOGUE, f"{group}/{word}", language) or word
                for key, word in gap_values.items()
            }
        key = f"{code}/near" if gap_values.get("near") else code
        sentence_texts = (
            languages.find_text(CATALOGUE, f"{kind}/{key}", language)
            for kind in (*refusal.kinds, "profile")
        )
        sentences.append(next(filter(None, sentence_texts)).format_map(gap_values))
    return sentences


def _causes(reasons: Sequence[Reason]) -> list[Reason]:
    """Return the reasons without those that go when another one is mended.

    A misspelt key is not also reported as missing under its right name, nor are the tables of a
    device whose name is refused.
    """
    meant_paths, is_name_refused = set(), False
    for code, values in reasons:
        parent, _, _ = values.get("path", "").rpartition(".")
        is_name_refused |= code.startswith("name_") and parent.startswith("kit.")
        if code in ("unknown_key", "not_in_kit") and values.get("near"):
            meant_paths.add(f"{parent}.{values['near']}".lstrip("."))
    causes = []
    for code, values in reasons:
        path = values.get("path", "")
        is_meant = any(
            path == meant_path or path.startswith(f"{meant_path}.") for meant_path in meant_paths
        )
        is_device = code == "missing" and DEVICE_PATH.fullmatch(path) is not None
        if code == "missing" and is_meant:
            continue
        if is_name_refused and (is_device or code == "not_in_kit"):
            continue
        causes.append((code, values))
    return causes


def printable_value(value: object) -> str:
    """Return a value from a file or a person in a form for a sentence: short and printable."""
    if isinstance(value, int) and value.bit_length() > 100:
        return "…"  # Python refuses to print very long integers
    return printable(str(value), SHOWN_CHARACTERS)
