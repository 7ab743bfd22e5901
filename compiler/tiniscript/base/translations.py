"""The translations of a language: reads its files, and finds errors in them.

`es/language.toml` has the language's own name, and its plural forms. Each other `es/NAME.toml` has
texts by the keys of `en/NAME.toml`. `es/seen.txt` has of which English text each is a translation:
rows of a file's name, a key and a hash, which `tools/languages.py` writes; of a list one for each
of its texts, `-` if that is not known. So inserting a text before others does not shift their
translations. A translation of an earlier version of the English text is stale and is not used.
Knows no language.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tiniscript.base.catalogue_source import (
    HASH_DIGITS,
    PLURALS,
    UNKNOWN_HASH,
    Catalogue,
    Entry,
    Forms,
    Problem,
    Row,
    decode_file,
    gap_names,
    parse_rows,
)

NUMBERS_TRIED = 200  # after the first hundred numbers, a plural rule repeats itself every hundred
_SEEN_ROW = re.compile(rf"(\w+ .+?)((?: (?:{UNKNOWN_HASH}|[0-9a-f]{{{HASH_DIGITS}}}))+) *")
_ENGLISH_RULE = "n != 1"
_ENGLISH_FORMS = ("one", "other")


@dataclass
class Language:
    """A `languages.Language` with its gettext `plural_rule`, and `read_by`: whether a native
    speaker has proofread it. A complete language translates every text.
    """

    name: str
    english_name: str
    forms: tuple[str, ...] = _ENGLISH_FORMS
    plural_rule: str = _ENGLISH_RULE
    form_digits: str = ""
    read_by: str = ""
    is_complete: bool = False
    problems: list[Problem] = field(default_factory=list)


def read_language(path: Path) -> Language:
    """Read the description of a language; omitted parts are as in English."""
    language = Language(path.parent.name, path.parent.name)
    text, language.problems = decode_file(path)
    language_rows, _, problems = parse_rows(text)
    language.problems += problems
    type_of_key: dict[str, Any] = {
        "name": str,
        "english_name": str,
        "read_by": str,
        "is_complete": bool,
        "forms": list,
        "which_form": str,
    }
    values: dict[str, Any] = {}
    for row in language_rows:
        if row.key not in type_of_key:
            language.problems.append((row.line, f"{row.key}: a language does not say that"))
        elif row.key in values:
            language.problems.append((row.line, f"{row.key}: it is there twice"))
        elif isinstance(row.value, type_of_key[row.key]):
            values[row.key] = row.value
        elif row.value is not None:
            language.problems.append(
                (row.line, f"{row.key}: it is no {_TYPE_NAMES[type_of_key[row.key]]}")
            )
    language.name = values.get("name", language.name)
    language.english_name = values.get("english_name", language.english_name)
    language.read_by, language.is_complete = (
        values.get("read_by", ""),
        values.get("is_complete", False),
    )
    forms, rule = (
        tuple(values.get("forms", _ENGLISH_FORMS)),
        values.get("which_form", _ENGLISH_RULE),
    )
    form_digits, problem = _form_digits(rule, forms)
    if problem:
        line = next((row.line for row in language_rows if row.key in ("which_form", "forms")), 1)
        language.problems.append((line, problem))
        forms, rule, (form_digits, _) = (
            _ENGLISH_FORMS,
            _ENGLISH_RULE,
            _form_digits(_ENGLISH_RULE, _ENGLISH_FORMS),
        )
    language.forms, language.plural_rule, language.form_digits = forms, rule, form_digits
    return language


_TYPE_NAMES = {str: "text", bool: "true or false", list: "list"}


def _form_digits(rule: str, forms: tuple[object, ...]) -> tuple[str, str]:
    """Return the digit of a form for each number, or the reason why there is none."""
    from gettext import c2py

    if not forms or any(name not in PLURALS or forms.count(name) > 1 for name in forms):
        return "", f"forms: it is no list of some of {', '.join(PLURALS)}"
    try:
        form_index = c2py(rule)
        digits = [int(form_index(number)) for number in range(NUMBERS_TRIED)]
    except (ValueError, ArithmeticError, RecursionError) as error:
        return "", f"which_form: {error}"
    if {*digits} <= {*range(len(forms))}:
        return "".join(map(str, digits)), ""
    return "", f"which_form: it gives {max(digits)}, and forms has {len(forms)}"


def read_seen(path: Path) -> tuple[dict[str, list[str]], list[Problem]]:
    """Return the hashes of a language by file and key, and the problems of their file."""
    hashes_by_key: dict[str, list[str]] = {}
    text, problems = decode_file(path) if path.is_file() else ("", [])
    for line_number, line in enumerate(text.split("\n"), 1):
        match = _SEEN_ROW.fullmatch(line)
        if not line.strip() or line[0] == "#":
            continue
        if match is None:
            problems.append((line_number, f"this is no file, key and hash: {line[:60]}"))
        elif match[1] in hashes_by_key:
            problems.append((line_number, f"{match[1]} is there twice"))
        else:
            hashes_by_key[match[1]] = match[2].split()
    return hashes_by_key, problems


@dataclass
class TranslationFile:
    """A file of a language: its rows, the forms of each text of a key, and its problems."""

    rows: list[Row] = field(default_factory=list)
    texts: dict[str, list[Forms]] = field(default_factory=dict)
    line_of_key: dict[str, int] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    text_below: str = ""


def read_translation_file(path: Path) -> TranslationFile:
    """Read the texts of a language; a missing file has none."""
    translation_file = TranslationFile()
    if not path.is_file():
        return translation_file
    text, translation_file.problems = decode_file(path)
    translation_file.rows, translation_file.text_below, problems = parse_rows(text)
    translation_file.problems += problems
    for row in translation_file.rows:
        if row.key in translation_file.texts:
            translation_file.problems.append((row.line, f"{row.key}: it is there twice"))
            continue
        values = row.value if isinstance(row.value, list) else [row.value]
        texts = [_forms(value) for value in values]
        if row.value is None or "\ufffd" in row.text:
            texts = []
        elif None in texts or not texts:
            translation_file.problems.append((row.line, f"{row.key}: it has no text"))
            texts = []
        translation_file.texts[row.key] = [text for text in texts if text is not None]
        translation_file.line_of_key[row.key] = row.line
    return translation_file


def _forms(value: object) -> Forms | None:
    """Return the forms of a text, an empty list if it is empty; None if it is not a text."""
    if isinstance(value, str):
        return {"": value} if value else {}
    if isinstance(value, dict) and value and all(isinstance(item, str) for item in value.values()):
        return dict(value)
    return None


def catalogue_of_names(translation_file: TranslationFile) -> Catalogue:
    """Return the texts of a file whose keys are the English texts."""
    return Catalogue({(key, key): Entry(key, key) for key in translation_file.texts})


def merge_translations(
    english: Catalogue,
    catalogue_name: str,
    translation_file: TranslationFile,
    seen_hashes: dict[str, list[str]],
    language: Language,
) -> Catalogue:
    """Return English texts with the translations of a language, and the problems of these."""
    catalogue = Catalogue(
        {identity: without_translation(entry) for identity, entry in english.entries.items()},
        translation_file.problems[:],
    )
    groups = catalogue.groups()
    for key, texts in translation_file.texts.items():
        line, group = translation_file.line_of_key[key], groups.get(key, [])
        unknown_hashes = [entry.hash if entry.english == key else UNKNOWN_HASH for entry in group]
        hashes = seen_hashes.get(f"{catalogue_name} {key}", unknown_hashes)
        hashes = [*hashes, *[UNKNOWN_HASH] * len(texts)][: len(texts)]
        if not group:
            catalogue.problems.append((line, f"{key}: there is no such English text"))
        elif problem := assign_translations(group, texts, hashes):
            catalogue.problems.append((line, f"{key}: {problem}"))
        for entry in group:
            entry.line = line
            for problem in find_problems(entry, language):
                catalogue.problems.append((line, f"{key}: {problem}"))
                entry.translation, entry.seen_hash = {}, ""
    for entry in catalogue.entries.values():
        if entry.same_text_key and not entry.translation:
            earlier_entry = catalogue.entries[entry.same_text_key, entry.english]
            entry.translation = earlier_entry.translation if earlier_entry.is_translated else {}
    return catalogue


def without_translation(entry: Entry) -> Entry:
    fields = (entry.key, entry.english, entry.plural)
    return Entry(
        *fields,
        notes=entry.notes,
        is_same=entry.is_same,
        same_text_key=entry.same_text_key,
        line=entry.line,
    )


def assign_translations(entries: list[Entry], texts: list[Forms], hashes: list[str]) -> str:
    """Assign the translations of a key to its English texts; return the reason if one has none, or
    "".
    """
    english_hashes = {index: entry.hash for index, entry in enumerate(entries)}
    indexes_left = {index for index, forms in enumerate(texts) if forms}
    has_moved = False
    for index in sorted(indexes_left):
        if matches := [
            target for target, value in english_hashes.items() if value == hashes[index]
        ]:
            target = index if index in matches else matches[0]
            has_moved |= target != index
            entries[target].translation, entries[target].seen_hash = texts[index], hashes[index]
            del english_hashes[target]
            indexes_left.remove(index)
    for index in sorted(indexes_left):
        if hashes[index] == UNKNOWN_HASH and has_moved:
            return "its English texts have other places now: first run  python -m tools.languages"
        if index not in english_hashes:
            return f"it has {len(texts)} texts, and English {len(entries)}"
        entries[index].translation, entries[index].seen_hash = texts[index], hashes[index]
    return ""


def find_problems(entry: Entry, language: Language) -> list[str]:
    """Return the errors in the translation of an unchanged text."""
    if not entry.is_translated:
        return []
    used_forms = {language.forms[int(digit)] for digit in language.form_digits}
    wanted_forms, known_forms = (
        (used_forms, {*language.forms, "other"}) if entry.plural else ({""}, {""})
    )
    if not wanted_forms <= entry.translation.keys() <= known_forms:
        form_list, wanted_list = (
            ", ".join(sorted(forms)) or "one text" for forms in (entry.translation, wanted_forms)
        )
        return [f"it has {form_list}, and needs {wanted_list}"]
    english_gaps = gap_names(entry.english) | gap_names(entry.plural)
    problems = []
    for form in entry.translation.values():
        try:
            translated_gaps = gap_names(form)
        except ValueError:
            return ["a brace { or } has no other half"]
        problems += [
            f"{{{gap}}} is missing" for gap in sorted(gap_names(entry.english) - translated_gaps)
        ]
        problems += [
            f"{{{gap}}} is no gap of the English text"
            for gap in sorted(translated_gaps - english_gaps)
        ]
    return list(dict.fromkeys(problems))


def texts_of(catalogue: Catalogue) -> dict[str, str | Forms]:
    """Return the texts by key: a text, or its plural forms. The second text of a key is under
    `key/2`. English replaces missing or misfitting translations.
    """
    texts: dict[str, str | Forms] = {}
    for key, group in catalogue.groups().items():
        for number, entry in enumerate(group, 1):
            forms = entry.translation if entry.is_translated else entry.forms
            texts[f"{key}/{number}" if number > 1 else key] = forms.get("", forms)
    return texts
