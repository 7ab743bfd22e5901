"""The files of a language, as `tools.languages` changes them: a row stays as somebody has written
it until its text goes to another place.

A file with a mistake in it that costs a row is not written.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from tiniscript.base.catalogue_source import UNKNOWN_HASH, Catalogue, Entry, Forms, Problem, Row
from tiniscript.base.languages import ABOUT_FILE, FOLDER, NAMES_CATALOGUE, SEEN_FILE
from tiniscript.base.translations import (
    TranslationFile,
    assign_translations,
    merge_translations,
    read_language,
    read_seen,
    read_translation_file,
    without_translation,
)

LIST_COLUMNS = 100  # most columns of a list in one row
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_ESCAPES = {
    "\\": "\\\\",
    '"': '\\"',
    "\n": "\\n",
    "\t": "\\t",
    "\r": "\\r",
    "\b": "\\b",
    "\f": "\\f",
}
SEEN_NOTE = "# Of which English text each is a translation: python -m tools.languages --seen {}\n"


class Translation:
    """A language's translations of the English texts, `english` by the names of their files."""

    def __init__(self, code: str, english: dict[str, Catalogue]) -> None:
        self.code = code
        self.folder = FOLDER / code
        self.english = english
        self.groups = {name: catalogue.groups() for name, catalogue in english.items()}
        self.own_files = {name: read_translation_file(self.path(name)) for name in english}
        self.seen_hashes, self.seen_problems = read_seen(self.folder / SEEN_FILE)
        self.language = read_language(self.folder / ABOUT_FILE)
        self._is_seen_new = False

    def path(self, name: str) -> Path:
        return self.folder / f"{name}.toml"

    def merge(self, name: str) -> Catalogue:
        """Return the English texts of a file with those of the language."""
        return merge_translations(
            self.english[name], name, self.own_files[name], self.seen_hashes, self.language
        )

    def follow_moved_texts(self) -> Iterator[str]:
        """Put translations where their English texts are now; yield the keys of those that go."""
        for name, translation_file in self.own_files.items():
            is_left = name == NAMES_CATALOGUE or bool(
                translation_file.problems or self.seen_problems
            )
            for row in translation_file.rows[:] if not is_left else []:
                if row.key not in self.groups[name]:
                    yield from self._follow_key(name, translation_file, row)
                if row.key in self.groups[name]:
                    self._follow_places(name, translation_file, row)

    def _follow_key(self, name: str, translation_file: TranslationFile, row: Row) -> Iterator[str]:
        hashes = self.seen_hashes.get(f"{name} {row.key}", [])
        known_hashes = {*hashes} - {UNKNOWN_HASH}
        new_keys = [
            key
            for key, group in self.groups[name].items()
            if key not in translation_file.texts and known_hashes <= {entry.hash for entry in group}
        ]
        if not known_hashes:
            return  # a mistyped key is an error
        del self.seen_hashes[f"{name} {row.key}"]
        self._is_seen_new = True
        texts = translation_file.texts.pop(row.key)
        if not new_keys:
            translation_file.rows.remove(row)
            yield f"{name}.toml: {row.key}"
            return
        row.key = new_keys[0]
        row.text = format_rows(row.key, texts, len(texts) > 1)
        translation_file.texts[row.key], translation_file.line_of_key[row.key] = texts, row.line
        self.seen_hashes[f"{name} {row.key}"] = hashes

    def _follow_places(self, name: str, translation_file: TranslationFile, row: Row) -> None:
        group, texts = self.pair_texts(name, row.key), translation_file.texts[row.key]
        if group and (len(group) > 1 or len(texts) > 1):
            if (new_texts := _without_end([entry.translation for entry in group])) != texts:
                translation_file.texts[row.key] = new_texts
                row.text = format_rows(row.key, new_texts, len(group) > 1)
                self._note(name, row.key, [entry.seen_hash for entry in group])

    def pair_texts(self, name: str, key: str) -> list[Entry]:
        """Return the texts of a key with their translations, or none if that is impossible."""
        texts = self.own_files[name].texts.get(key, [])
        group = [without_translation(entry) for entry in self.groups[name].get(key, [])]
        unknown_hashes = [UNKNOWN_HASH] * len(texts)
        hashes = [*self.seen_hashes.get(f"{name} {key}", []), *unknown_hashes][: len(texts)]
        return [] if assign_translations(group, texts, hashes) else group

    def _note(self, name: str, key: str, hashes: list[str]) -> None:
        while hashes and hashes[-1] in ("", UNKNOWN_HASH):
            hashes.pop()
        old_hashes = self.seen_hashes.pop(f"{name} {key}", [])
        if hashes:
            self.seen_hashes[f"{name} {key}"] = [hash_ or UNKNOWN_HASH for hash_ in hashes]
        self._is_seen_new |= old_hashes != self.seen_hashes.get(f"{name} {key}", [])

    def note_seen(self, patterns: list[str]) -> list[str]:
        """Record the English texts of new translations, and of stale ones with these keys; return
        the patterns without a key. A file with a mistake is left alone.
        """
        unused_names = {*patterns}
        for name, translation_file in self.own_files.items():
            if name == NAMES_CATALOGUE or translation_file.problems:
                continue
            for key in translation_file.texts:
                fitting_patterns = {pattern for pattern in patterns if fnmatchcase(key, pattern)}
                unused_names -= fitting_patterns
                if group := self.pair_texts(name, key):
                    hashes_to_note = (
                        UNKNOWN_HASH,
                        *[
                            entry.seen_hash
                            for entry in group
                            if fitting_patterns and entry.seen_hash
                        ],
                    )
                    self._note(
                        name,
                        key,
                        [
                            entry.hash if entry.seen_hash in hashes_to_note else entry.seen_hash
                            for entry in group
                        ],
                    )
            current_rows = {f"{name} {key}" for key in translation_file.texts}
            for seen_key in [
                key_in_file
                for key_in_file in self.seen_hashes
                if key_in_file.startswith(f"{name} ") and key_in_file not in current_rows
            ]:
                self._note(name, seen_key.removeprefix(f"{name} "), [])
        return [pattern for pattern in patterns if pattern in unused_names]

    def put_entries(self, name: str, key: str, group: list[Entry]) -> None:
        """Store the translations of these entries as the texts of a key."""
        translation_file, texts = (
            self.own_files[name],
            _without_end([entry.translation for entry in group]),
        )
        row = next((row for row in translation_file.rows if row.key == key), None)
        if translation_file.texts.get(key) != texts and texts:
            if row is None:
                translation_file.rows.append(row := Row(key, None, 0, ""))
            row.text = format_rows(key, texts, len(group) > 1)
            translation_file.texts[key], translation_file.line_of_key[key] = texts, row.line
        if name != NAMES_CATALOGUE:
            self._note(name, key, [entry.seen_hash for entry in group])

    def put_all(self, name: str, texts: Catalogue) -> None:
        """Store the translations of these entries."""
        for key, group in texts.groups().items():
            if len(group) > 1 or not group[0].is_same:
                self.put_entries(name, key, group)

    def write(self) -> None:
        """Write the files that are others now."""
        self.folder.mkdir(exist_ok=True)
        for name, translation_file in self.own_files.items():
            index_of_key = {key: index for index, key in enumerate(self.groups[name])}
            rows = sorted(
                translation_file.rows, key=lambda row: index_of_key.get(row.key, len(index_of_key))
            )
            text = "".join(row.text_above + row.text for row in rows) + translation_file.text_below
            if not translation_file.problems and (rows or self.path(name).is_file()):
                _write(self.path(name), text)
        if self._is_seen_new and not self.seen_problems:
            order = [f"{name} {key}" for name, keys in self.groups.items() for key in keys]
            unknown_keys = sorted(self.seen_hashes.keys() - {*order})
            seen_keys = (
                seen_key for seen_key in [*order, *unknown_keys] if seen_key in self.seen_hashes
            )
            lines = [
                f"{seen_key} {' '.join(self.seen_hashes[seen_key])}\n" for seen_key in seen_keys
            ]
            _write(self.folder / SEEN_FILE, SEEN_NOTE.format(self.code) + "".join(lines))

    def problems(self) -> Iterator[tuple[Path, list[Problem]]]:
        """Yield the problems of each file."""
        yield self.folder / ABOUT_FILE, self.language.problems
        yield self.folder / SEEN_FILE, self.seen_problems
        for name in self.english:
            yield self.path(name), self.merge(name).problems


def print_problems(path: Path, problems: list[Problem]) -> int:
    """Print the problems of a file, and return their number."""
    shown_path = path.relative_to(FOLDER.parent) if path.is_relative_to(FOLDER.parent) else path
    for line, problem in problems:
        print(f"{shown_path}:{line}: {problem}")
    return len(problems)


def _write(path: Path, text: str) -> None:
    if not path.is_file() or path.read_text(encoding="utf-8-sig") != text:
        path.write_text(text, encoding="utf-8", newline="\n")


def _without_end(texts: list[Forms]) -> list[Forms]:
    """Return texts without the empty ones after all others."""
    return texts[: max((k for k, text in enumerate(texts, 1) if text), default=0)]


def format_rows(key: str, texts: list[Forms], is_list: bool) -> str:
    """Return the rows of a key."""
    quoted_key = key if _BARE_KEY.fullmatch(key) else _basic_string(key)
    if is_list:
        parts = [quote(text.get("", "")) for text in texts]
        row = f"{quoted_key} = [{', '.join(parts)}]\n"
        if len(row) <= LIST_COLUMNS and row.count("\n") == 1:
            return row
        return f"{quoted_key} = [\n" + "".join(f"  {part},\n" for part in parts) + "]\n"
    return "".join(f"{quoted_key}{'.' * bool(name)}{name} = {quote(form)}\n"
                   for text in texts for name, form in text.items())  # fmt: skip


def quote(text: str) -> str:
    """Return a text as TOML has it, with as few signs as it can."""
    if "\n" in text:
        rows = ["".join(_ESCAPES.get(sign, sign) if sign != '"' else sign for sign in row)
                for row in text.replace('"""', '""\0').split("\n")]  # fmt: skip
        content = _escape_control_signs("\n".join(rows)).replace("\0", '\\"')
        return '"""\n' + (content[:-1] + '\\"' if content[-1] == '"' else content) + '"""'
    if ('"' in text or "\\" in text) and "'" not in text and text.isprintable():
        return f"'{text}'"
    return _basic_string(text)


def _basic_string(text: str) -> str:
    return '"' + _escape_control_signs("".join(_ESCAPES.get(sign, sign) for sign in text)) + '"'


def _escape_control_signs(text: str) -> str:
    """Return a text with signs that TOML does not take as numbers."""
    return re.sub(r"[\x01-\x08\x0b-\x1f\x7f]", lambda match: f"\\u{ord(match[0]):04x}", text)


def about_text(name: str, english_name: str, forms: Iterable[str], rule: str) -> str:
    """Return the header of a new language."""
    return (
        f"name = {quote(name)}  # what it calls itself\n"
        f"english_name = {quote(english_name)}  # the name that Windows may use\n"
        f"forms = [{', '.join(map(quote, forms))}]  # the forms of a text with a number\n"
        f"which_form = {quote(rule)}  # the form for the number n: its place in forms, from 0\n"
    )
