"""Catalogues of languages: those that are shipped are whole, and a wrong one costs little."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.pupils.corpus import check
from tests.support.command import Tsc
from tests.support.copies import link_copy
from tests.support.waiting import HANG_LIMIT_S
from tiniscript import robots
from tiniscript.base import languages
from tiniscript.base.catalogue_source import UNKNOWN_HASH
from tiniscript.base.languages import ABOUT_FILE, FOLDER, SOURCE_LANGUAGE
from tiniscript.base.translations import read_language
from tiniscript.base.words import WORDS
from tiniscript.cli import main
from tiniscript.cli.streams import wrap
from tiniscript.cli.texts import language_of
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.diagnostics import rendering
from tiniscript.diagnostics.codes import CODES
from tiniscript.lessons import catalogue
from tools.languages import PSEUDO, check_lexicon, check_robot, make_pseudo, sources
from tools.translation_files import Translation

SOURCES = sources()


@pytest.mark.parametrize("name", SOURCES)
@pytest.mark.parametrize("language", languages.languages()[1:])
def test_a_catalogue_has_the_gaps_and_the_keys_of_the_english_one(language: str, name: str) -> None:
    """Each translation is of the current English text."""
    catalogue = languages.merged_catalogue(name, language)
    assert catalogue.problems == []
    assert [
        key for key, entry in catalogue.entries.items() if entry.translation and entry.is_stale
    ] == []
    assert [
        key for key, entry in catalogue.entries.items() if entry.seen_hash == UNKNOWN_HASH
    ] == [], f"python -m tools.languages --seen {language}"
    if read_language(FOLDER / language / ABOUT_FILE).is_complete:
        expected_keys = {key for key, entry in SOURCES[name].entries.items() if not entry.is_same}
        translated = {key for key, entry in catalogue.entries.items() if entry.is_translated}
        assert expected_keys <= translated


@pytest.mark.parametrize("language", languages.languages()[1:])
def test_a_language_is_up_to_date(language: str, tmp_path: Path) -> None:
    """The tool would write the same files."""
    translation = Translation(language, sources())
    bytes_before = {
        path.name: path.read_bytes() for path in translation.folder.iterdir() if path.is_file()
    }
    assert [path for path, problems in translation.problems() if problems] == []
    assert [*translation.follow_moved_texts()] == []
    translation.folder = tmp_path
    translation.write()
    for path in tmp_path.iterdir():
        assert path.read_bytes() == bytes_before[path.name], "python -m tools.languages"


@pytest.mark.parametrize("language", ["es", "pt"])
def test_a_complete_language_is_declared_complete(language: str) -> None:
    assert read_language(FOLDER / language / ABOUT_FILE).is_complete


def test_names_of_word_values_in_messages_are_terms() -> None:
    """Otherwise a message in another language would contain an English name; a letter is the same
    in each language."""
    values = [argument for word in WORDS.values() for argument in word.arguments]
    value_words = {value.name for value in values} | {
        value.unit for value in values if value.unit.islower()
    }
    terms = {key for key, _ in SOURCES["messages"].entries}
    assert {f"term/{name}" for name in value_words if len(name) > 1} <= terms


def test_the_names_in_toml_files_are_translated() -> None:
    lesson = catalogue.load(catalogue.folders()[0])
    assert [lesson.title(code) for code in ("en", "es", "tlh")] == [
        "The first line", "La primera línea", "The first line",
    ]  # fmt: skip
    labels = robots.load("liner").labels
    assert [labels[code]["BUTTON"] for code in ("en", "es", "tlh")] == [
        "bumper", "parachoques", "bumper",
    ]  # fmt: skip


@pytest.mark.parametrize("language", languages.languages()[1:])
def test_no_language_depends_on_another(language: str, tmp_path: Path) -> None:
    """No file outside its folder names it, so no row becomes unknown."""
    package = tmp_path / "tiniscript"
    link_copy(FOLDER.parent, package, "*.texts", "__pycache__", "page", "ready")
    shutil.rmtree(package / "languages" / language)
    other_languages = [code for code in languages.languages() if code != language]
    commands = [
        [*words, "--lang", other_language]
        for other_language in other_languages
        for words in (
            ("check", "-e", "F(2 80)"), ("check", "--explain", "TS017"), ("lesson",), ("complie",),
            ("lesson", "show", "1", "--teacher"), ("firmware", "--wiring", "--robot", "liner"),
            ("show", "-e", "SI|F(2, 80)", "--arduino"), ("run", "-e", "SI|F(2, 80)"),
        )
    ]  # fmt: skip
    commands.append(["check", "-e", "W(1)", "--lang", language])
    *outputs, (code, refused_text) = _outputs_of_package(tmp_path, commands)
    assert outputs == _outputs_of_package(FOLDER.parent.parent, commands)[:-1]
    assert code == 2 and all(other_language in refused_text for other_language in other_languages)


def _outputs_of_package(place: Path, commands: list[list[str]]) -> list[tuple[int, str]]:
    """Return the output of a package's command for each call, in one process."""
    script = (
        "import contextlib, io, json, sys\n"
        "from tiniscript.cli import main\n"
        "done = []\n"
        "for words in json.load(sys.stdin):\n"
        "    said = io.StringIO()\n"
        "    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):\n"
        "        code = main(words)\n"
        "    done.append((code, said.getvalue()))\n"
        "json.dump(done, sys.stdout)"
    )
    completed = subprocess.run(
        [sys.executable, "-c", script], input=json.dumps(commands), cwd=place, check=True,
        env={**os.environ, "PYTHONPATH": str(place)}, text=True, capture_output=True,
        timeout=HANG_LIMIT_S,
    )  # fmt: skip
    return [(code, text) for code, text in json.loads(completed.stdout)]


@pytest.mark.parametrize("language", languages.languages())
def test_robot_texts_fit_and_lexicon_rows_are_known(language: str) -> None:
    assert [*check_robot(languages.merged_catalogue("robot", language))] == []
    assert [*check_lexicon(language)] == []


@pytest.mark.parametrize(("name", "language"), [
    ("es_PE.UTF-8", "es"), ("es", "es"), ("ES-pe", "es"), ("es_ES@euro", "es"), ("C", "en"),
    ("Spanish_Peru.1252", "es"), ("POSIX", "en"), ("C.UTF-8", "en"), ("tlh_XX.UTF-8", "en"),
    ("", "en"), ("_", "en"), ("../es", "en"), ("__pycache__", "en"), ("eso", "en"),
])  # fmt: skip
def test_a_locale_has_a_language_or_english(name: str, language: str) -> None:
    assert languages.find_language(name) == language


def test_locale_variables_have_the_usual_precedence() -> None:
    assert language_of([], {"LC_ALL": "C", "LANG": "es_PE.UTF-8"}) == "en"
    assert language_of([], {"LC_ALL": "", "LANG": "es_PE.UTF-8"}) == "es"
    assert language_of(["--lang", "xx"], {"LANG": "es_PE.UTF-8"}) == "es"
    assert language_of(["--lang=en"], {"LANG": "es_PE.UTF-8"}) == "en"


def test_an_unknown_language_is_refused_with_the_known_ones(tsc: Tsc) -> None:
    result = tsc("check", "-e", "W(1)", "--lang", "xx")
    assert result.code == 2
    assert all(code in result.err for code in languages.languages())


@pytest.fixture
def longer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Add a language whose texts are a third longer than English."""
    for code in languages.languages():
        (tmp_path / code).mkdir()
    for path in FOLDER.glob(f"{SOURCE_LANGUAGE}/*.toml"):
        (tmp_path / SOURCE_LANGUAGE / path.name).write_bytes(path.read_bytes())
    with monkeypatch.context() as patch:
        for module in ("tools.languages", "tools.translation_files"):
            patch.setattr(f"{module}.FOLDER", tmp_path)
        make_pseudo(sources())
    check("avansar(2, 80)")  # meanings are loaded once, so later tests would get this folder's
    monkeypatch.setattr(languages, "FOLDER", tmp_path)
    _forget()
    yield PSEUDO
    _forget()


def _forget() -> None:
    languages.forget_languages()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


SAID = (
    ("check", "-e", "F(2 80)\nAVANZA 20\n\nF(60, 80) UNTIL(DISTANCE < 10) AND LATER THAN EVER"),
    ("check", "no_such_file.ts"), ("complie",), ("robot", "--world", "no_such_world"),
    ("check", "--explain", "TS017"), ("upload", "-e", "S", "--port", "/dev/no_such_port"),
)  # fmt: skip


@pytest.mark.parametrize("words", SAID, ids=" ".join)
def test_sentences_are_wrapped_for_a_terminal_but_not_for_a_pipe(
    longer: str, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LC_ALL", longer)
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    sentences = []
    for kind in (Terminal, io.StringIO):
        streams = kind(), kind()
        for name, stream in zip(("stdout", "stderr"), streams, strict=True):
            monkeypatch.setattr(sys, name, stream)
        main([*words])
        sentences.append("".join(string_io.getvalue() for string_io in streams))
    narrow, wide = sentences
    assert max(map(len, narrow.split("\n"))) <= 80 < max(map(len, wide.split("\n")))
    assert narrow.split() == wide.split(), "nothing is lost, nor hidden"
    frames = [row for row in wide.split("\n") if re.search(r"^\S+ \d+:  |^ +\^+$", row)]
    assert [row for row in frames if row not in narrow.split("\n")] == []


@pytest.mark.parametrize(("text", "rows"), [
    ("Nothing is too long.", ["Nothing is too long."]),
    ("Once upon a time, behind it", ["Once upon a time,", "behind it"]),
    ("Lift it. Try:  tsc run -e S", ["Lift it. Try:", "tsc run -e S"]),
    ("Try:  tsc run --sensor A=1,2,3", ["Try:  tsc run", "--sensor A=1,2,3"]),
    ("Try:  /a/long/path/python -m x", ["Try:", "/a/long/path/python -m x"]),
    ("  seen: a port that is", ["  seen: a port that", "  is"]),
    ("one\n\nhttp://long.example/a/page", ["one", "", "http://long.example/a/page"]),
])  # fmt: skip
def test_a_command_stays_in_one_row_if_it_fits(text: str, rows: list[str]) -> None:
    assert wrap(text, 20) == "\n".join(rows)


# Aligned texts, on a terminal and elsewhere.
LAID_OUT = (("help",), ("help", "all"), *(("help", verb) for verb in VERBS))


def test_texts_that_are_longer_keep_to_80_columns(
    longer: str, tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each text is replaced, which shows that all are in the catalogues."""
    for words in LAID_OUT:
        rows = {}
        for language in (SOURCE_LANGUAGE, longer):
            monkeypatch.setenv("LC_ALL", language)
            rows[language] = tsc(*words).out.splitlines()
        assert [row for row in rows[longer] if len(row) > 80] == [], words
        equal_texts = {
            row for row in {*rows[SOURCE_LANGUAGE]} & {*rows[longer]} if "$(" not in row
        }  # no code
        assert [row for row in equal_texts if re.search(r"^ *\w.*[a-z]{3} [a-z]{3}", row)] == [], (
            words
        )


# Phrases that no native speaker uses: brackets that keep, a DEF or a part that is "made", a task
# that "moves itself", a removed thing without a name.
UNSAID = {
    "es": r"\bva desde \{|se mueve el TASK|el TASK [^.]* se mueve\b|Quita esto\b|no entra: aquí",
    "pt": r"parênteses de \{word\} guardam|nunca é feit[oa]|a TASK [^.]* anda\b|Tire isto\b",
    "en": r"Take this out\b",
}


@pytest.mark.parametrize("language", UNSAID)
def test_no_message_is_unused(language: str) -> None:
    texts = [
        text
        for key, texts in messages_of(language).items()
        for text in texts
        if "/more" not in key and re.search(UNSAID[language], text)
    ]
    assert not texts


def messages_of(language: str) -> dict[str, list[str]]:
    """Return the texts of messages by key."""
    messages: dict[str, list[str]] = {}
    for number in CODES:
        for part in ("message", "try", "more"):
            key = f"{number}/{part}"
            messages[key] = [*rendering._templates(key, language)]
    assert sum(map(len, messages.values())) > 400
    return messages
