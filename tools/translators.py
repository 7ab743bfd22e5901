"""Exchanges a language with translators' tools, as a catalogue of gettext: `pt.po`.

Its contexts are `command/no_verb`: a file's name and a key. A returned translation belongs to the
English text next to it: it is left out if it is marked as fuzzy or empty, or if its English text
has changed since.
"""

from __future__ import annotations

from collections.abc import Callable
from gettext import c2py
from pathlib import Path

from babel import Locale, UnknownLocaleError
from babel.messages.catalog import Catalog, Message
from babel.messages.plurals import get_plural
from babel.messages.pofile import PoFileError, read_po, write_po

from tiniscript.base.catalogue_source import Catalogue, Entry, Forms
from tiniscript.base.languages import NAMES_CATALOGUE, languages
from tiniscript.base.translations import NUMBERS_TRIED, Language, find_problems
from tiniscript.base.version import __version__
from tools.translation_files import Translation, print_problems

FILE_ENDING = ".po"
# Names of forms, and gettext's rule for them, in most languages.
SIMPLE_FORMS = ((["one", "other"], "n != 1"), (["one", "other"], "n > 1"), (["other"], "0"))
BRACES_FLAG = "python-brace-format"  # gettext's flag for a text with gaps like {file}


def exchange(language_or_file: str, english: dict[str, Catalogue]) -> int:
    """Write a language into a file, or read one; return 1 where something is wrong."""
    path = Path(
        language_or_file
        if language_or_file.endswith(FILE_ENDING)
        else language_or_file + FILE_ENDING
    )
    if path.stem not in languages()[1:]:
        print(f"{path.stem}: no such language. Try:  python -m tools.languages {path.stem}")
        return 1
    translation = Translation(path.stem, english)
    problem_count = sum(print_problems(file, problems) for file, problems in translation.problems())
    if problem_count or language_or_file.endswith(FILE_ENDING):
        return 1 if problem_count else read_file(path, translation)
    count = write_file(path, translation)
    print(f"{path}: {count} texts. Read it with:  python -m tools.languages --po {path}")
    return 0


def write_file(path: Path, translation: Translation) -> int:
    """Write the texts of a language; return their number."""
    language = translation.language
    catalog = Catalog(
        locale=translation.code,
        project="TiniScript",
        version=__version__,
        fuzzy=False,
        charset="utf-8",
        header_comment=f"# {language.english_name} texts of TiniScript,"
        f" in {FILE_ENDING} for translators",
        language_team=language.english_name,
    )
    plurals = f"nplurals={len(language.forms)}; plural=({language.plural_rule});"
    catalog.mime_headers = [("Plural-Forms", plurals)]
    for name in translation.english:
        for entry in translation.merge(name).entries.values():
            if not entry.is_same:
                _add(catalog, name, entry, language.forms)
    with path.open("wb") as file:
        write_po(file, catalog, width=0)
    return len(catalog)


def _add(catalog: Catalog, name: str, entry: Entry, forms: tuple[str, ...]) -> None:
    english: str | tuple[str, str] = entry.english
    translated_text: str | tuple[str, ...] = entry.translation.get("", "")
    if entry.plural:
        english = (entry.english, entry.plural)
        translated_text = tuple(entry.translation.get(form, "") for form in forms)
    flags = {BRACES_FLAG} if "{" in entry.english else set()
    message = catalog.add(
        english, translated_text, context=_context(name, entry.key), auto_comments=entry.notes,
        flags=flags | ({"fuzzy"} if entry.is_stale else set()),
    )  # fmt: skip
    message.flags.discard("python-format")  # `5 % of` looks like one


def _context(name: str, key: str) -> str:
    return name if name == NAMES_CATALOGUE else f"{name}/{key}"


def read_file(path: Path, translation: Translation) -> int:
    """Read texts of a language; print a text's problem, and return 1 then."""
    try:
        with path.open("rb") as file:
            catalog = read_po(file, abort_invalid=True)
    except PoFileError as error:
        print(f"{path}:{error.lineno + 1}: this is no row of a catalogue: {error.line[:40]}")
        return 1
    except (OSError, ValueError, LookupError) as error:  # UnicodeDecodeError is a ValueError
        print(f"{path}: this cannot be read: {error}")
        return 1
    taken_count = problem_count = 0
    for message in catalog:
        forms = _forms(message, translation.language)
        if message.id and not message.fuzzy and all(forms.values()):
            if reason := _take_text(message, forms, translation):
                print(f"{path}:{message.lineno}: {reason}")
                problem_count += 1
            taken_count += not reason
    translation.write()
    print(f"{path}: {taken_count} texts are taken")
    return 1 if problem_count else 0


def _forms(message: Message, language: Language) -> Forms:
    if isinstance(message.string, str):
        return {"": message.string}
    return dict(zip(language.forms, message.string or ("",), strict=False))


def _take_text(message: Message, forms: Forms, translation: Translation) -> str:
    """Accept one text; return the reason why that is impossible, or an empty text."""
    english, *plural = [message.id] if isinstance(message.id, str) else message.id
    name, _, key = (message.context or "").partition("/")
    key = key if name != NAMES_CATALOGUE else english
    if key not in translation.groups.get(name, {}):
        return f"there is no English text with the context {message.context or 'of nothing'}"
    group = translation.pair_texts(name, key)
    expected_texts = (english, "".join(plural))
    entry = next(
        (entry for entry in group if (entry.english, entry.plural) == expected_texts), None
    )
    if entry is None:
        return f"{message.context}: its English text is not this one now: {english[:40]}"
    old_translation, old_seen = entry.translation, entry.seen_hash
    entry.translation, entry.seen_hash = forms, entry.hash
    if reason := find_problems(entry, translation.language):
        entry.translation, entry.seen_hash = old_translation, old_seen
        return f"{message.context}: {reason[0]}"
    translation.put_entries(name, key, group)
    return ""


def language_facts(code: str) -> tuple[str, str, list[str], str]:
    """Return the description of a language, as far as Unicode's CLDR has it."""
    try:
        locale = Locale.parse(code)
    except (UnknownLocaleError, ValueError):
        return code, code, *SIMPLE_FORMS[0]
    name, english_name = (locale.get_display_name(language) or code for language in (code, "en"))
    count, rule = get_plural(code)
    known_rules = (*SIMPLE_FORMS, (_cldr_categories(count, rule, locale.plural_form), rule))
    expected_forms = [locale.plural_form(number) for number in range(NUMBERS_TRIED)]
    fitting_forms = (
        language
        for language in known_rules
        if language[0] and _forms_by(*language) == expected_forms
    )
    return name, english_name, *next(fitting_forms, SIMPLE_FORMS[0])


def _forms_by(names: list[str], rule: str) -> list[str]:
    """Return the names of the forms that numbers have."""
    form_index = c2py(rule)
    return [names[form_index(number)] for number in range(NUMBERS_TRIED)]


def _cldr_categories(count: int, rule: str, category_of_number: Callable[[int], str]) -> list[str]:
    """Return the CLDR names of a gettext rule's forms, or none if a form has no number."""
    form_index = c2py(rule)
    category_of = {
        form_index(number): category_of_number(number) for number in range(NUMBERS_TRIED)
    }
    return [category_of[k] for k in range(count)] if category_of.keys() == {*range(count)} else []
