"""The files of a language: errors have small effects, and a translation follows its text."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.copies import link_copy
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.base import catalogue_source, languages
from tiniscript.base.catalogue_source import Catalogue, Entry
from tiniscript.base.languages import (
    ABOUT_FILE,
    FOLDER,
    NAMES_CATALOGUE,
    SEEN_FILE,
    SOURCE_LANGUAGE,
)
from tiniscript.base.translations import (
    NUMBERS_TRIED,
    merge_translations,
    read_language,
    read_seen,
    read_translation_file,
)
from tiniscript.cli.texts import Sentence
from tools import languages as tool
from tools import translation_files, translators
from tools.languages import check_lexicon, check_robot, pseudo
from tools.translation_files import Translation, format_rows, quote

ENGLISH = """
[note]
a = "Read {file}."
b = "Stop."
more = ["{fix}", "Take it out.", "Put it in."]
n = { one = "{n} byte", other = "{n} bytes" }
"""
OWN = 'b = "Alto."\n'


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of languages with English and one more, `xx`."""
    for module in (languages, tool, translation_files):
        monkeypatch.setattr(module, "FOLDER", tmp_path / "languages")
    for code in (SOURCE_LANGUAGE, "xx"):
        (tmp_path / "languages" / code).mkdir(parents=True)
    itself = FOLDER / SOURCE_LANGUAGE / ABOUT_FILE
    shutil.copyfile(itself, tmp_path / "languages" / SOURCE_LANGUAGE / itself.name)
    write(tmp_path / "languages" / "xx" / ABOUT_FILE, 'name = "xx"\n')
    write(tmp_path / "languages" / SOURCE_LANGUAGE / "some.toml", ENGLISH)
    languages.forget_languages()
    yield tmp_path / "languages"
    monkeypatch.undo()
    languages.forget_languages()


def write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="")


def text_of(key: str, language: str = "xx") -> str | dict[str, str]:
    languages.forget_languages()
    return languages.texts("some", language)[key]


def open_translation(
    place: Path, own_text: str | None = None, is_seen: bool = False
) -> Translation:
    """Return the translation `xx` as the tool sees it; `is_seen`: of the current English texts."""
    if own_text is not None:
        write(place / "xx" / "some.toml", own_text)
    english = {"some": catalogue_source.load_catalogue(place / SOURCE_LANGUAGE / "some.toml")}
    translation = Translation("xx", english)
    if is_seen:
        translation.note_seen([])
        translation.write()
    return translation


def problems(translation: Translation) -> list[tuple[str, int, str]]:
    return [
        (path.name, *problem)
        for path, file_problems in translation.problems()
        for problem in file_problems
    ]


# -- mistakes


@pytest.mark.parametrize(("row", "line", "reason"), [
    ('a = "Lee {fila}."', 2, "a: {file} is missing"),
    ('a = "Lee {file} {x}."', 2, "a: {x} is no gap of the English text"),
    ('a = "Lee {file}}."', 2, "a: a brace { or } has no other half"),
    ('a = "Lee {file}."\na = "Mira {file}."', 3, "a: it is there twice"),
    ('b = "Basta."', 2, "b: it is there twice"),
    ('a = "Lee {file}.', 2, "this is no TOML: Illegal character '\\n'"),
    ('a = """Lee {file}.', 2, "this is no TOML: Unterminated string"),
    ('a = ["Lee {file}.",', 2, "this is no TOML: Invalid value"),
    ("a = Lee", 2, "this is no TOML: Invalid value"),
    ("a", 2, "this is no TOML: Expected '=' after a key in a key/value pair"),
    ("[a", 2, "this is no TOML: Expected ']' at the end of a table declaration"),
    ("\n\na = 5", 4, "a: it has no text"),
    ("a = []", 2, "a: it has no text"),
    ("a = [5]", 2, "a: it has no text"),
    ("a.x.y = 'A.'", 2, "a: it has no text"),
    ('z = "Z."', 2, "z: there is no such English text"),
    ('a = ["Lee {file}.", "Mira {file}."]', 2, "a: it has 2 texts, and English 1"),
    ('a.one = "Lee {file}."', 2, "a: it has one, and needs one text"),
    ('n = "{n} bytes"', 2, "n: it has one text, and needs one, other"),
    ('n.one = "{n} byte"', 2, "n: it has one, and needs one, other"),
    ('n.one = "{n} byte"\nn.many = "{n} bytes"', 2, "n: it has many, one, and needs one, other"),
    ('n.one = "{n} byte"\nn.one = "{n} bytes"', 3, "n: it is there twice"),
    ('n.one = "{n} byte"\nn.other = "{m} bytes"', 2, "n: {n} is missing"),
])  # fmt: skip
def test_an_invalid_row_is_dropped_and_reported_with_its_line(
    row: str, line: int, reason: str, place: Path
) -> None:
    rows = problems(open_translation(place, f"{OWN}{row}\nmore = ['', 'Quítalo.']\n"))
    assert rows[0][:2] == ("some.toml", line) and rows[0][2].startswith(reason)
    assert text_of("b") == "Alto." and text_of("more/2") == "Quítalo."
    if not row.startswith(("b", 'a = "Lee {file}."\n', 'a = ["Lee {file}.", "Mi')):
        assert text_of("a") == "Read {file}."
    rows_before = (place / "xx" / "some.toml").read_text().splitlines()
    reopened_translation = open_translation(place)
    assert [*reopened_translation.follow_moved_texts()] == []
    reopened_translation.write()
    rows_after = (place / "xx" / "some.toml").read_text().splitlines()
    assert sorted(rows_after) == sorted(rows_before), "it keeps what somebody must mend"


@pytest.mark.parametrize(("data", "line"), [
    (OWN.encode() + 'a = "Lée {file}."\n'.encode("latin-1"), 2),
    (OWN.encode() + b"\xff\n", 2),
])  # fmt: skip
def test_a_row_not_in_utf_8_falls_back_to_english(data: bytes, line: int, place: Path) -> None:
    (place / "xx" / "some.toml").write_bytes(data)
    assert ("some.toml", line, "this is no UTF-8: save the file as UTF-8") in problems(
        open_translation(place)
    )
    assert text_of("b") == "Alto."
    assert text_of("a") == "Read {file}."


def test_a_file_in_another_encoding_has_no_texts(place: Path) -> None:
    (place / "xx" / "some.toml").write_bytes(OWN.encode("utf-16"))
    assert problems(open_translation(place)) == [
        ("some.toml", 1, "this is no UTF-8 text: save the file as UTF-8")
    ]
    assert text_of("b") == "Stop."


def test_changes_that_an_editor_makes_to_a_file_are_allowed(place: Path) -> None:
    changed_text = '\ufeff# by somebody\r\n[x]\r\nb = "Alto."\r\na = """\r\nLee\r\n{file}."""\r\n'
    write(place / "xx" / "some.toml", changed_text)
    assert problems(open_translation(place)) == []
    assert text_of("b") == "Alto." and text_of("a") == "Lee\n{file}."


@pytest.mark.parametrize(("row", "line", "reason"), [
    ("some b", 1, "this is no file, key and hash: some b"),
    ("some b 123", 1, "this is no file, key and hash: some b 123"),
    ("# note\n\nsome b 00000000\nsome b 00000000", 4, "some b is there twice"),
])  # fmt: skip
def test_an_invalid_hash_is_reported_with_its_line_and_kept(
    row: str, line: int, reason: str, place: Path
) -> None:
    write(place / "xx" / SEEN_FILE, row)
    translation = open_translation(place, OWN)
    assert problems(translation) == [(SEEN_FILE, line, reason)]
    translation.note_seen(["*"])
    translation.write()
    assert (place / "xx" / SEEN_FILE).read_text() == row


@pytest.mark.parametrize(("row", "line", "reason"), [
    ('name = 5', 1, "name: it is no text"),
    ('\nforms = "one"', 2, "forms: it is no list"),
    ('forms = ["one", "some"]', 1, "forms: it is no list of some of zero, one, two, few, many, "),
    ('forms = [["one"]]', 1, "forms: it is no list of some of"),
    ('forms = []', 1, "forms: it is no list of some of"),
    ('which_form = "n !"', 1, "which_form: "),
    ('which_form = "n / 0"', 1, "which_form: "),
    ('which_form = "n"', 1, "which_form: it gives 199, and forms has 2"),
    ('which_form = "' + "(" * 9999 + '"', 1, "which_form: "),
    ('colour = "red"', 1, "colour: a language does not say that"),
    ('name = "X"\nname = "Y"', 2, "name: it is there twice"),
    ('name = "X', 1, "this is no TOML: Illegal character"),
])  # fmt: skip
def test_invalid_language_settings_fall_back_to_english(
    row: str, line: int, reason: str, place: Path
) -> None:
    write(place / "xx" / ABOUT_FILE, row + "\n")
    ((name, line_number, problem),) = problems(open_translation(place, OWN))
    assert (name, line_number) == (ABOUT_FILE, line) and problem.startswith(reason)
    languages.forget_languages()
    assert languages.language_info("xx").forms == ("one", "other")
    assert text_of("b") == "Alto."


TOML = st.lists(st.sampled_from(["a", '"b/c"', " = ", '"', "'", '"""', "x", "[", "]", "{", "}",
                                 ".one", ", ", "\n", "\\", "#", "\r", "\ud800"]))  # fmt: skip


@settings(deadline=None)
@given(st.one_of(st.binary(), TOML.map(lambda parts: "".join(parts).encode(errors="replace"))))
def test_no_bytes_in_a_file_stop_a_command(data: bytes) -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        for file_name in ("some.toml", SEEN_FILE, ABOUT_FILE):
            (folder / file_name).write_bytes(data)
        language = read_language(folder / ABOUT_FILE)
        assert len(language.form_digits) == NUMBERS_TRIED
        read_seen(folder / SEEN_FILE)
        english = catalogue_source.load_catalogue(folder / "some.toml")
        merge_translations(
            english, "some", read_translation_file(folder / "some.toml"), {}, language
        )


def test_an_unreadable_file_is_reported_and_dropped(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own_path = place / "xx" / "some.toml"
    write(own_path, OWN)

    def refuse_access(path: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", refuse_access)
    assert read_translation_file(own_path).problems == [
        (1, "this cannot be read: Permission denied")
    ]


# -- contents of a language


def test_plurals_follow_the_rule_of_the_language(place: Path) -> None:
    polish = "n==1 ? 0 : n%10>=2 && n%10<=4 && (n%100<10 || n%100>=20) ? 1 : 2"
    rules = (
        ("one few many", polish, {1: "one", 2: "few", 5: "many", 12: "many", 22: "few"}),
        ("zero one two few many other",
         "n==0 ? 0 : n==1 ? 1 : n==2 ? 2 : n%100>=3 && n%100<=10 ? 3 : n%100>=11 ? 4 : 5",
         {0: "zero", 1: "one", 2: "two", 7: "few", 11: "many", 100: "other", 1103: "few"}),
        ("other", "0", {0: "other", 1: "other", 5: "other"}),
    )  # fmt: skip
    for names, rule, form_by_number in rules:
        forms = names.split()
        write(place / "xx" / ABOUT_FILE, f"forms = {forms}\nwhich_form = '{rule}'\n")
        rows = "".join(f"n.{form} = '{{n}} {form}'\n" for form in forms)
        assert problems(open_translation(place, rows)) == []
        languages.forget_languages()
        for number, form in form_by_number.items():
            assert languages.plural_text("some", "n", number, "xx") == f"{{n}} {form}"
    write(place / "xx" / "some.toml", OWN)
    languages.forget_languages()
    assert [languages.plural_text("some", "n", n, "xx") for n in (1, 5)] == ["{n} bytes"] * 2


def test_a_form_that_no_number_has_may_be_missing(place: Path) -> None:
    """CLDR has a form for fractions in Polish: a translator may supply it."""
    write(place / "xx" / ABOUT_FILE, 'forms = ["one", "many"]\nwhich_form = "n != 1"\n')
    row = "n.one = '{n} a'\nn.many = '{n} b'\n"
    assert (
        problems(open_translation(place, row))
        == problems(open_translation(place, f"{row}n.other = '{{n}}'\n"))
        == []
    )


@pytest.mark.parametrize(("language", "plural_text", "singular_text"), [
    ("en", "{n} checks", "1 check"), ("es", "{n} pruebas", "1 prueba"),
])  # fmt: skip
def test_a_sentence_has_the_form_of_its_number(
    language: str, plural_text: str, singular_text: str
) -> None:
    sentence = Sentence(plural_text)
    sentence.language = language
    assert sentence.format(n="1") == singular_text
    assert sentence.format(n=0) != f"0 {singular_text[2:]}"


def test_a_stale_text_is_shown_in_english_until_reviewed(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    open_translation(place, OWN + 'a = "Lee {file}."\n')
    assert text_of("b") == "Alto.", "a new one is said at once"
    open_translation(place, is_seen=True)
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH.replace("Stop.", "Stop now."))
    assert text_of("b") == "Stop now." and text_of("a") == "Lee {file}."
    translation = open_translation(place)
    assert tool.report(translation) == 0
    out = capsys.readouterr().out
    assert "some.toml:2: b: its English text has changed, and so it is said in English: St" in out
    assert "xx: 1 texts are stale." in out and "xx: 1 of 5 texts are translated" in out
    write(place / "xx" / ABOUT_FILE, "is_complete = true\n")
    assert tool.report(open_translation(place)) == 4, "a whole language says all, and as it is now"
    open_translation(place, is_seen=True)
    assert text_of("b") == "Stop now.", "somebody has run the tool for others"
    assert translation.note_seen(["x*", "b"]) == ["x*"]
    translation.write()
    assert text_of("b") == "Alto."
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH)
    assert text_of("b") == "Stop.", "of the text before it is none now"


@pytest.mark.parametrize("has_run", [False, True])
def test_a_text_inserted_in_front_loses_no_translation(place: Path, has_run: bool) -> None:
    open_translation(place, 'more = ["", "Quítalo.", "Ponlo."]\n', is_seen=True)
    moved_text = ENGLISH.replace('["{fix}", "Take it out.", "Put it in."]',
                            '["New.", "Put it in.", "{fix}", "Take it out."]')  # fmt: skip
    write(place / SOURCE_LANGUAGE / "some.toml", moved_text)
    if has_run:
        translation = open_translation(place)
        assert [*translation.follow_moved_texts()] == []
        translation.write()
        assert (place / "xx" / "some.toml").read_text(encoding="utf-8") == (
            'more = ["", "Ponlo.", "", "Quítalo."]\n'
        )
        write(place / "xx" / "some.toml", 'more = ["Nuevo.", "Ponlo.", "", "Quítalo."]\n')
    assert problems(open_translation(place)) == []
    assert [text_of("more/2"), text_of("more/3"), text_of("more/4")] == [
        "Ponlo.",
        "{fix}",
        "Quítalo.",
    ]
    assert text_of("more") == ("Nuevo." if has_run else "New.")


def test_a_new_list_item_does_not_take_a_moved_translation(place: Path) -> None:
    open_translation(place, 'more = ["", "Quítalo."]\n', is_seen=True)
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH.replace('"{fix}", ', '"{fix}", "New.", '))
    ((_, line, reason),) = problems(open_translation(place, 'more = ["", "Nuevo.", "Quítalo."]\n'))
    assert line == 1 and reason.startswith("more: its English texts have other places now")
    assert text_of("more/2") == "New."


def test_a_translation_and_its_note_follow_the_english_text(place: Path) -> None:
    """Deleted texts are removed; a mistyped key stays, and is reported."""
    notes = '# who\n[x]\nb = "Alto."  # short\n# why\na = "Lee {file}."\ngoes = "Se va."\n# end\n'
    open_translation(place, notes)
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH + 'goes = "It goes."\n')
    open_translation(place, is_seen=True)
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH.replace("b =", "moved ="))
    translation = open_translation(
        place, (place / "xx" / "some.toml").read_text("utf-8") + 'mistyped = "Ay."\n'
    )
    assert [*translation.follow_moved_texts()] == ["some.toml: goes"]
    translation.write()
    assert (place / "xx" / "some.toml").read_text(encoding="utf-8") == (
        '# why\na = "Lee {file}."\n# who\n[x]\nmoved = "Alto."\n# end\nmistyped = "Ay."\n'
    )
    assert text_of("moved") == "Alto."
    seen_file = (place / "xx" / SEEN_FILE).read_text(encoding="utf-8")
    assert [row.rpartition(" ")[0] for row in seen_file.splitlines()[1:]] == [
        "some a",
        "some moved",
    ]
    assert problems(open_translation(place)) == [
        ("some.toml", 7, "mistyped: there is no such English text")
    ]
    reopened_translation = open_translation(place)
    assert [*reopened_translation.follow_moved_texts()] == []
    reopened_translation.write()
    assert (place / "xx" / SEEN_FILE).read_text(encoding="utf-8") == seen_file


def test_a_mistake_in_a_file_loses_no_recorded_review(place: Path) -> None:
    open_translation(place, OWN + 'more = ["", "Quítalo."]\n', is_seen=True)
    seen_file = (place / "xx" / SEEN_FILE).read_text(encoding="utf-8")
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH.replace("Stop.", "Stop now."))
    for spoilt in ('b = "Alto.\n', 'more = ["", "a", "b", "c"]\n' + OWN, OWN + "b = 'x'\n"):
        translation = open_translation(place, spoilt, is_seen=True)
        assert [*translation.follow_moved_texts()] == []
        translation.write()
        assert (place / "xx" / SEEN_FILE).read_text(encoding="utf-8").startswith(seen_file[:60])
        file_text = (place / "xx" / "some.toml").read_text(encoding="utf-8")
        assert sorted(file_text.splitlines()) == sorted(spoilt.splitlines())
    (place / "xx" / "some.toml").write_bytes(OWN.encode("utf-16"))
    translation = open_translation(place, is_seen=True)
    assert "some b" in (place / "xx" / SEEN_FILE).read_text(encoding="utf-8")
    open_translation(place, OWN)
    assert text_of("b") == "Stop now.", "it is stale still"


def test_a_text_under_several_keys_is_translated_once_unless_it_means_something_else(
    place: Path,
) -> None:
    """A note with which the key begins is not repeated next to it; a list shows its own texts."""
    write(
        place / SOURCE_LANGUAGE / "some.toml",
        '[verb]\na = "Open"\nb = ["Shut", "Open"]\n[door]\ndoor.own = "Open"\n[menu]\nd = "Open"\n',
    )
    translation = open_translation(place, 'a = "Abrir"\nb = ["Cierra"]\ndoor = "Abierta"\n')
    entries = [entry for entry in translation.merge("some").entries.values() if not entry.is_same]
    assert [(it.key, it.english, it.notes, it.translation[""]) for it in entries] == [
        ("a", "Open", ["verb", "menu"], "Abrir"), ("b", "Shut", ["verb"], "Cierra"),
        ("door", "Open", [], "Abierta"),
    ]  # fmt: skip
    languages.forget_languages()
    assert languages.texts("some", "xx") == {
        "a": "Abrir", "b": "Cierra", "b/2": "Abrir", "door": "Abierta", "d": "Abrir",
    }  # fmt: skip
    open_translation(place, 'a = "Abrir"\nb = ["Cierra", "Abre"]\n')
    assert text_of("b/2") == "Abre"


def test_a_program_is_not_translated_and_may_contain_a_lone_brace(place: Path) -> None:
    write(place / SOURCE_LANGUAGE / "some.toml", 'a = "A."\n"b/wrong".same = "LOOP(3) {"\n')
    translation = open_translation(place)
    assert problems(translation) == []
    translation.put_all("some", pseudo(translation.english["some"]))
    translation.write()
    assert (place / "xx" / "some.toml").read_text(encoding="utf-8") == 'a = "À. ñandú"\n'
    assert text_of("b/wrong") == "LOOP(3) {"


TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0"))


@settings(deadline=None)
@given(TEXTS, st.lists(TEXTS, min_size=2))
def test_written_rows_are_read_back_unchanged(key: str, texts: list[str]) -> None:
    forms = [{"": text} if text else {} for text in texts]
    rows = format_rows(key, forms, True) + format_rows(f"{key}.", [{"": texts[0] or "x"}], False)
    plural = format_rows(f"{key}..", [{"one": texts[0], "few": texts[1]}], False)
    parsed_rows, _, parse_errors = catalogue_source.parse_rows(rows + plural)
    assert parse_errors == []
    assert {row.key: row.value for row in parsed_rows} == {
        key: texts, f"{key}.": texts[0] or "x", f"{key}..": {"one": texts[0], "few": texts[1]},
    }  # fmt: skip


@pytest.mark.parametrize(("text", "row"), [
    ("A.", '"A."'), ('-e "S"', "'-e \"S\"'"), ("it's \"S\"", '"it\'s \\"S\\""'),
    ("a\nb\\", '"""\na\nb\\\\"""'), ('a\n"b"', '"""\na\n"b\\""""'), ("\t\x07", '"\\t\\u0007"'),
])  # fmt: skip
def test_a_text_is_written_as_a_person_would(text: str, row: str) -> None:
    assert quote(text) == row


def test_texts_too_long_for_a_robot_and_unknown_lexicon_rows_are_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    entries = [Entry("a", "Stop.", "", {"": text}) for text in ("x" * 41, "Arrêt", "Halte")]
    catalogue = Catalogue({(str(k), entry.key): entry for k, entry in enumerate(entries)})
    assert [reason for _, reason in check_robot(catalogue)] == [
        f"a robot says at most 40 signs, in ASCII: {entry.translation['']}" for entry in entries[:2]
    ]
    rows = ["F | AVANCE", "F AVANCE", "QQ | RECULE", "B | recule", "B | RECULÉ", "number 2 | DEUX"]
    english = languages.read_language_file(SOURCE_LANGUAGE, "lexicon.txt")
    tables = {SOURCE_LANGUAGE: english, "fr": "\n".join(rows)}
    monkeypatch.setattr("tools.languages.read_language_file", lambda language, _: tables[language])
    assert [*check_lexicon("fr")] == rows[1:5]


# -- the tool


@pytest.fixture
def prepare_language(place: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """The tool, with all English texts and no language."""
    shutil.rmtree(place)
    shutil.copytree(FOLDER / SOURCE_LANGUAGE, place / SOURCE_LANGUAGE)
    languages.forget_languages()

    def run(*words: str) -> int:
        languages.forget_languages()
        monkeypatch.setattr(sys, "argv", ["tools.languages", *words])
        return tool.main()

    return run


@pytest.mark.parametrize(("code", "name", "english_name", "forms", "of_1_0_2_5_11"), [
    ("fr", "français", "French", "one other", "00111"),
    ("it", "italiano", "Italian", "one other", "01111"),
    ("pl", "polski", "Polish", "one few many", "02122"),
    ("ar", "العربية", "Arabic", "zero one two few many other", "10234"),
    ("ja", "日本語", "Japanese", "other", "00000"),
    ("tlh", "tlh", "tlh", "one other", "01111"),
])  # fmt: skip
def test_a_new_language_starts_with_unicode_data(
    code: str, name: str, english_name: str, forms: str, of_1_0_2_5_11: str, place: Path,
    prepare_language: Callable[..., int], capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    assert prepare_language(code) == 0
    language = read_language(place / code / ABOUT_FILE)
    assert language.problems == []
    assert (language.name, language.english_name, " ".join(language.forms)) == (
        name,
        english_name,
        forms,
    )
    assert "".join(language.form_digits[number] for number in (1, 0, 2, 5, 11)) == of_1_0_2_5_11
    assert f"{code}: 0 of " in capsys.readouterr().out
    files_before = {path: path.read_bytes() for path in (place / code).iterdir()}
    assert prepare_language() == 0
    assert {path: path.read_bytes() for path in (place / code).iterdir()} == files_before


def test_a_stranger_adds_a_language_text_by_text(
    place: Path, prepare_language: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    prepare_language("fr")
    own_path = place / "fr" / "command.toml"
    write(own_path, 'no_verb = "tsc : la commande {found} n\'existe pas. Essaie :  tsc --help"\n')
    languages.forget_languages()
    assert (
        languages.find_language("fr_CA.UTF-8")
        == languages.find_language("French_France.1252")
        == "fr"
    )
    assert languages.text("command", "no_verb", "fr").startswith("tsc : la commande")
    capsys.readouterr()
    assert prepare_language("--check") == 0
    out = capsys.readouterr().out
    assert "fr: 1 texts are new. Note of which English texts they are:" in out
    assert prepare_language("--seen", "fr") == 0
    assert "fr: 1 of " in (out := capsys.readouterr().out) and "new" not in out
    (row,) = (place / "fr" / SEEN_FILE).read_text(encoding="utf-8").splitlines()[1:]
    assert row.startswith("command no_verb ")
    write(own_path, 'no_verb = "tsc : la commande {fond} n\'existe pas."\nno_verbe = "x"\n')
    assert prepare_language("--check") == prepare_language() == 1
    out = capsys.readouterr().out
    assert "languages/fr/command.toml:1: no_verb: {found} is missing\n" in out
    assert "languages/fr/command.toml:2: no_verbe: there is no such English text\n" in out


def test_missing_texts_are_named_with_the_line_to_insert_after() -> None:
    """The line is that of the previous English text, whatever the order of the file."""
    translation = {"": "x"}
    rows = [Entry("a", "A"), Entry("b", "B", translation=translation, line=7),
            Entry("c", "C", line=99), Entry("d", "D", translation=translation, line=3),
            Entry("e", "E")]  # fmt: skip
    missing = [(line, row_text.partition(" ")[0]) for line, row_text in tool.missing_rows(rows)]
    assert missing == [(1, "a"), (7, "c"), (3, "e")]


@pytest.mark.parametrize("name", ["messages", "robot", "command"])
def test_a_file_that_is_missing_is_named(
    name: str, place: Path, prepare_language: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    prepare_language("fr")
    write(place / "fr" / f"{name}.toml", "")
    (place / SOURCE_LANGUAGE / f"{name}.toml").unlink()
    (place / "fr" / ABOUT_FILE).unlink()
    capsys.readouterr()
    assert prepare_language("--check") == 1
    out = capsys.readouterr().out
    assert f"languages/fr/{name}.toml:1: there is no en/{name}.toml\n" in out
    assert "languages/fr/language.toml:1: this cannot be read: No such file" in out


def test_an_unknown_language_is_not_created(
    place: Path, prepare_language: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    for words in (["../x"], ["X"], ["--check", "fr"], ["--seen", "fr"], ["--po", "fr"]):
        assert prepare_language(*words) == 1
    assert [path.name for path in place.iterdir()] == [SOURCE_LANGUAGE]
    out = capsys.readouterr().out
    assert out.count("no such language. Try:  python -m tools.languages fr") == 3


@pytest.mark.parametrize("spoilt", ["x = ", 'x = "{"', f'x = "{"y" * 41}"'])
def test_a_wrong_english_text_goes_into_no_language(
    spoilt: str,
    place: Path,
    prepare_language: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
) -> None:
    prepare_language("fr")
    write(place / "fr" / "robot.toml", 'gone = "Ô"\n')
    write(place / "fr" / SEEN_FILE, "robot gone 00000000\n")
    source = place / SOURCE_LANGUAGE / "robot.toml"
    write(source, f"{spoilt}\n{source.read_text(encoding='utf-8')}")
    capsys.readouterr()
    assert prepare_language() == 1
    assert capsys.readouterr().out.startswith("languages/en/robot.toml:1: ")
    assert (place / "fr" / "robot.toml").is_file()


# -- results


def test_a_clone_regenerates_stale_files_even_if_read_only(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own_path, path = place / "xx" / "some.toml", place / "xx" / f"some{languages.CACHE_ENDING}"

    def stop() -> str:
        languages.forget_languages()
        return languages.text("some", "b", "xx")

    write(own_path, OWN)
    assert stop() == "Alto."
    path.write_bytes(path.read_bytes().replace(b"Alto.", b"Paro."))
    assert stop() == "Paro.", "it is read as it is while nothing is newer"
    for source in (own_path, place / "xx" / SEEN_FILE, place / "xx" / ABOUT_FILE,
                   place / SOURCE_LANGUAGE / "some.toml"):  # fmt: skip
        path.write_bytes(path.read_bytes().replace(b"Alto.", b"Paro."))
        source.touch()
        os.utime(source, (path.stat().st_mtime + 2,) * 2)
        assert stop() == "Alto.", source
        os.utime(source, (0, 0))
    for half in (b"", path.read_bytes()[:20], b"\xff", b"[]"):
        path.write_bytes(half)
        assert stop() == "Alto.", half
    own_path.unlink()
    assert stop() == "Stop.", "what was made of it is no translation"
    write(own_path, OWN)
    path.unlink()
    path.mkdir()  # makes the file impossible to write
    assert stop() == "Alto."


def test_a_package_without_sources_and_a_page_have_their_texts(place: Path) -> None:
    write(place / "xx" / "some.toml", OWN)
    write(place / "xx" / "names.toml", '"First" = "Primero"\n')
    files = languages.cache_files()
    assert sorted(files) == [
        f"{code}/{name}{languages.CACHE_ENDING}"
        for code in ("en", "xx")
        for name in ("language", NAMES_CATALOGUE, "some")
    ]
    for path in place.glob("*/*"):
        path.unlink()
    for name, data in files.items():
        (place / name).write_bytes(data)
    languages.forget_languages()
    assert languages.text("some", "b", "xx") == "Alto."
    assert languages.find_text(NAMES_CATALOGUE, "First", "xx") == "Primero"
    assert languages.find_text(NAMES_CATALOGUE, "First", SOURCE_LANGUAGE) is None
    assert (
        languages.language_info("xx").name == "xx"
        and languages.language_info("zz").name == "English"
    )
    for path in (place / "xx").iterdir():
        path.unlink()
    languages.forget_languages()
    assert languages.text("some", "b", "xx") == "Stop."


WITHOUT = (
    "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); "
    "from tiniscript.cli import main; sys.exit(main())"
)


def command(package: Path, *words: str, code: str = WITHOUT) -> tuple[int, str]:
    """Return the output of a package's command that cannot read any file."""
    run = subprocess.run(
        [sys.executable, "-c", code, *words],
        env={**os.environ, "PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True, text=True, timeout=HANG_LIMIT_S,
    )  # fmt: skip
    return run.returncode, run.stderr


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A package as in a clone, without generated files."""
    target = tmp_path_factory.mktemp("clone") / "tiniscript"
    return link_copy(
        FOLDER.parent, target, f"*{languages.CACHE_ENDING}", "__pycache__", "page", "ready"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="Windows limits no files of a process")
def test_a_clone_on_a_full_disk_has_its_texts(package: Path) -> None:
    code, output = command(package, "complie", "--lang", "es")
    assert code == 2 and "¿Quisiste decir compile?" in output and output.count("\n") == 1
    assert list(package.glob(f"languages/*/*{languages.CACHE_ENDING}*")) == []


@pytest.mark.sampled("spoil", "reason")
@pytest.mark.parametrize(("spoil", "reason"), [
    (lambda path: path.unlink(missing_ok=True), "1: this cannot be read: No such file"),
    (lambda path: path.write_text('[tsc]\nstopped = "S\n'), "2: this is no TOML: Illegal"),
    (lambda path: path.write_text('[tsc]\na = "S"\na = "S"\n'), "3: a: it is there twice"),
    (lambda path: path.write_bytes(b"[tsc]\n\na = '\xff'\n"), "3: this is no UTF-8"),
])  # fmt: skip
def test_invalid_english_texts_are_reported_without_catalogue_texts(
    spoil: Callable[[Path], object], reason: str, package: Path, tmp_path: Path
) -> None:
    package_folder = tmp_path / "tiniscript"
    shutil.copytree(package, package_folder)
    for name, words in (
        ("messages", ["check", "-e", "SI|F(2 80)"]),
        ("command", ["check", "no_such.ts", "--lang", "es"]),
        ("command", ["complie"]),
    ):
        path = package_folder / "languages" / SOURCE_LANGUAGE / f"{name}.toml"
        if path.is_file():
            path.chmod(0o644)
        spoil(path)
        code, output = command(package_folder, *words)
        assert code == 2 and output == output.splitlines()[0] + "\n"
        assert output.startswith(f"tsc: {path}:{reason}")


# -- translators' tools


@pytest.fixture
def own(place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Translation:
    """A language with a translation, a stale one, and a form missing."""
    monkeypatch.chdir(tmp_path)
    replace_before = ENGLISH.replace("Stop.", "Halt.")
    write(place / SOURCE_LANGUAGE / "some.toml", replace_before)
    open_translation(place, OWN + 'a = "Lee {file}."\nmore = ["", "", "Ponlo."]\n', is_seen=True)
    write(place / SOURCE_LANGUAGE / "some.toml", ENGLISH)
    return open_translation(place)


def read_catalog(translation: Translation) -> Catalog:
    with Path("xx.po").open("rb") as file:
        return read_po(file, abort_invalid=True)


def test_a_po_file_has_texts_with_context_notes_and_flags(own: Translation) -> None:
    assert translators.exchange("xx", own.english) == 0
    assert [
        (message.context, message.id, message.string, message.fuzzy, message.auto_comments,
         {*message.flags})
        for message in read_catalog(own) if message.id
    ] == [
        ("some/a", "Read {file}.", "Lee {file}.", False, ["note"], {"python-brace-format"}),
        ("some/b", "Stop.", "Alto.", True, ["note"], {"fuzzy"}),
        ("some/more", "Take it out.", "", False, ["note"], set()),
        ("some/more", "Put it in.", "Ponlo.", False, ["note"], set()),
        ("some/n", ("{n} byte", "{n} bytes"), ("", ""), False, ["note"], {"python-brace-format"}),
    ]  # fmt: skip


def test_a_returned_translation_belongs_to_its_english_text(
    own: Translation, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fuzzy one and an empty one are left out; a text that has changed meanwhile is said."""
    translators.exchange("xx", own.english)
    english, text = ENGLISH.replace("{n} b", "{n} B"), Path("xx.po").read_text(encoding="utf-8")
    write(
        place / SOURCE_LANGUAGE / "some.toml", english.replace('["{fix}", ', '["New.", "{fix}", ')
    )
    text = text.replace('"Take it out."\nmsgstr ""', '"Take it out."\nmsgstr "¡Fuera \\"x\\"!"')
    text = text.replace('msgstr[0] ""', 'msgstr[0] "{n} b"').replace('[1] ""', '[1] "{n} bb"')
    write(Path("xx.po"), text.replace("Lee {file}", "Mira {file}"))
    assert translators.exchange("xx.po", open_translation(place).english) == 1
    out = capsys.readouterr().out
    assert "some/n: its English text is not this one now: {n} byte" in out
    assert "xx.po: 3 texts are taken" in out
    assert (place / "xx" / "some.toml").read_text(encoding="utf-8") == (
        'a = "Mira {file}."\nb = "Alto."\n'
        """more = ["", "", '¡Fuera "x"!', "Ponlo."]\n"""
    )
    translation = open_translation(place)
    assert problems(translation) == [] and translation.merge("some").entries["b", "Stop."].is_stale
    write(Path("xx.po"), text.replace("#, fuzzy", "#"))
    translators.exchange("xx.po", open_translation(place).english)
    languages.forget_languages()
    assert languages.text("some", "b", "xx") == "Alto."


@pytest.mark.parametrize("language", languages.languages()[1:])
def test_a_language_is_exported_and_imported_completely(
    language: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    english = tool.sources()
    translation_before = Translation(language, english)
    translators.write_file(Path("out.po"), translation_before)
    shutil.copytree(FOLDER / SOURCE_LANGUAGE, tmp_path / "languages" / SOURCE_LANGUAGE)
    (tmp_path / "languages" / language).mkdir()
    for itself in (FOLDER / language).glob(ABOUT_FILE):
        shutil.copy(itself, tmp_path / "languages" / language)
    monkeypatch.setattr(translation_files, "FOLDER", tmp_path / "languages")
    assert translators.read_file(Path("out.po"), Translation(language, english)) == 0
    translation_after = Translation(language, english)
    for name in english:
        old_catalogue, new_catalogue = (
            translation.merge(name) for translation in (translation_before, translation_after)
        )
        assert new_catalogue.problems == []
        for key, entry in old_catalogue.entries.items():
            is_asked = not entry.is_same
            assert new_catalogue.entries[key].translation == entry.translation or not is_asked, key
            assert new_catalogue.entries[key].seen_hash == entry.seen_hash or not is_asked, key


HEAD = 'msgid ""\nmsgstr "Content-Type: text/plain; charset=UTF-8\\n"\n\n'


@pytest.mark.parametrize(("data", "reason"), [
    (b"msgid 'x'\n", "xx.po:1: this is no row of a catalogue: "),
    (HEAD.encode() + b'msgid "a"\nmsgstr "\xff"\n', "xx.po: this cannot be read: "),
    (None, "xx.po: this cannot be read: "),
    (HEAD.encode() + b'msgctxt "some/a"\nmsgid "Read {file}."\nmsgstr "Lee {fila}."\n',
     "xx.po:5: some/a: {file} is missing"),
    (HEAD.encode() + b'msgid "a"\nmsgstr "b"\n',
     "xx.po:4: there is no English text with the context of nothing"),
])  # fmt: skip
def test_an_invalid_po_file_is_reported_with_its_line_and_changes_nothing(
    data: bytes | None,
    reason: str,
    own: Translation,
    place: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if data is not None:
        Path("xx.po").write_bytes(data)
    files_before = {path: path.read_bytes() for path in place.glob("*/*.t*")}
    assert translators.exchange("xx.po", own.english) == 1
    assert capsys.readouterr().out.startswith(reason)
    assert {path: path.read_bytes() for path in place.glob("*/*.t*")} == files_before
    assert translators.exchange("zz", own.english) == 1
    assert "zz: no such language. Try:  python -m tools.languages zz" in capsys.readouterr().out
