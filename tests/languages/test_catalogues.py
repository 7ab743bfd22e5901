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
from gettext import GNUTranslations
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

from tests.pupils.corpus import check
from tests.support.command import Tsc
from tests.support.copies import linked
from tests.support.waiting import HANGS_S
from tiniscript import robots
from tiniscript.base import catalogue_compiler as compiling
from tiniscript.base import catalogue_source, languages
from tiniscript.base.catalogue_file import Catalogue, Entry, load, read, written
from tiniscript.base.languages import FOLDER, SOURCE
from tiniscript.cli import main
from tiniscript.cli.streams import wrapped
from tiniscript.cli.texts import Said, language_of, text
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.diagnostics import rendering
from tiniscript.diagnostics.codes import CODES
from tiniscript.lessons import catalogue
from tools.languages import PSEUDO, check_lexicon, check_robot, in_step, pseudo, sources
from tools.languages import main as bring_in_step

SOURCES = sources()
FILES = sorted(FOLDER.glob("*/*.po"))
HEAD = (
    'msgid ""\nmsgstr "Content-Type: text/plain; charset=UTF-8\\n'
    'Plural-Forms: nplurals=2; plural=(n != 1);\\n"\n\n'
)
ROW = 'msgctxt "a"\nmsgid "Read {file}."\nmsgstr "Lee {file}."\n'
COUNT = 'msgctxt "n"\nmsgid "{n} byte"\nmsgid_plural "{n} bytes"\n'


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_catalogue_has_the_gaps_and_the_keys_of_the_english_one(path: Path) -> None:
    """Every text has its gaps. Spanish lacks none: a head that says X-Complete promises that."""
    own, source = load(path), SOURCES[path.stem]
    assert own.problems == []
    if "X-Complete: yes" in own.head:
        wanted = [at for at, each in source.entries.items() if not each.is_same]
        assert list(own.entries) == wanted, "python -m tools.languages"
        for at, entry in own.entries.items():
            assert entry.is_translated, at
            assert entry.plural == source.entries[at].plural, at
    text = written(in_step(source, own, path.parent.name))
    assert text == path.read_text(encoding="utf-8"), "python -m tools.languages"


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_babel_reads_what_we_read(path: Path) -> None:
    """A catalogue is one that translators' tools know, and they find no fault in it."""
    with path.open("rb") as file:
        found = read_po(file, abort_invalid=True)
    # `5 % of` looks like a gap of the other kind to it: ours are in braces.
    assert [(at.id, said) for at, said in found.check() if "%" not in str(at.id)] == []
    theirs = {}
    for each in found:
        english, *plural = [each.id] if isinstance(each.id, str) else each.id
        said = [each.string] if isinstance(each.string, str) else list(each.string or ())
        if english:
            theirs[each.context or english, english] = (*plural, said, each.fuzzy)
    own = load(path).entries
    assert theirs.keys() == own.keys()
    for at, entry in own.items():
        plural = [entry.plural] if entry.plural else []
        assert theirs[at] == (*plural, entry.said, entry.is_fuzzy), at


@pytest.mark.parametrize("language", ["es", "pt"])
def test_a_whole_language_promises_to_be_complete(language: str) -> None:
    heads = [load(FOLDER / language / f"{name}.po").head for name in SOURCES]
    assert all("X-Complete: yes" in head for head in heads)


def test_the_names_in_toml_files_are_translated() -> None:
    titles = catalogue.load(catalogue.folders()[0]).titles
    assert [titles[each] for each in ("en", "es", "tlh")] == [
        "The first line", "La primera línea", "The first line",
    ]  # fmt: skip
    labels = robots.load("liner").labels
    assert [labels[each]["BUTTON"] for each in ("en", "es", "tlh")] == [
        "bumper", "parachoques", "bumper",
    ]  # fmt: skip


@pytest.mark.parametrize("language", languages.languages()[1:])
def test_a_language_that_is_deleted_is_missed_by_no_other(language: str, tmp_path: Path) -> None:
    """Nothing outside of its folder names it, so nothing becomes an unknown row."""
    package = tmp_path / "tiniscript"
    linked(FOLDER.parent, package, "*.mo", "__pycache__", "page", "ready")
    shutil.rmtree(package / "languages" / language)
    others = [each for each in languages.languages() if each != language]
    commands = [
        [*words, "--lang", other]
        for other in others
        for words in (
            ("check", "-e", "F(2 80)"), ("explain", "TS017"), ("lesson",), ("complie",),
            ("lesson", "show", "1", "--teacher"), ("wiring", "--robot", "liner"),
            ("show", "-e", "SI|F(2, 80)", "--arduino"), ("run", "-e", "SI|F(2, 80)"),
        )
    ]  # fmt: skip
    commands.append(["check", "-e", "W(1)", "--lang", language])
    *done, (code, refused) = _of_package(tmp_path, commands)
    assert done == _of_package(FOLDER.parent.parent, commands)[:-1]
    assert code == 2 and all(each in refused for each in others)


def _of_package(place: Path, commands: list[list[str]]) -> list[tuple[int, str]]:
    """Return what the command of a package says each time, in one process."""
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
    done = subprocess.run(
        [sys.executable, "-c", script], input=json.dumps(commands), cwd=place, check=True,
        env={**os.environ, "PYTHONPATH": str(place)}, text=True, capture_output=True,
        timeout=HANGS_S,
    )  # fmt: skip
    return [(code, said) for code, said in json.loads(done.stdout)]


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        (ROW.replace("Lee {file}", "Lee {fila}"), 4, "a: {file} is missing"),
        (ROW.replace("Lee {file}", "Lee {file}{x}"), 4, "a: {x} is no gap of the English text"),
        (ROW.replace("Lee {file}", "Lee {file}}"), 4, "a: a brace { or } has no other half"),
        (ROW + "\n" + ROW.replace("Lee", "Mira"), 8, "a is there twice"),
        (
            ROW.replace("msgctxt", "#") + "\n" + ROW.replace("msgctxt", "#"),
            9,
            "Read {file}. is there twice",
        ),
        (
            ROW.replace('msgid "', "msgid '"),
            5,
            "this is no row of a catalogue: msgid 'Read {file}.\"",
        ),
        (ROW + 'msgstr "Mira {file}."\n', 7, "msgstr is there twice"),
        (COUNT + 'msgstr "{n} bytes"\n', 4, "n: it has 1 forms, and needs 2"),
        (COUNT + 'msgstr[0] "{n} byte"\n', 4, "n: it has 1 forms, and needs 2"),
        (COUNT + 'msgstr[0] "{n} byte"\nmsgstr[1] ""\n', 4, "n: it has 1 forms, and needs 2"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(text: str, line: int, said: str) -> None:
    assert (line, said) in read(HEAD + text).problems


@pytest.mark.parametrize("spoil", [
    lambda text: "\ufeff" + text,
    lambda text: text.replace("\n", "\r\n"),
    lambda text: text + '\n#~ msgctxt "old"\n#~ msgid "Old."\n#~ msgstr "Viejo."\n',
    lambda text: "# by somebody\n" + text.replace("msgctxt", "#: a.py:1\n#| msgid \"x\"\nmsgctxt"),
])  # fmt: skip
def test_what_other_programs_write_is_read(spoil, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    file = tmp_path / "command.po"
    file.write_text(spoil(HEAD + ROW), encoding="utf-8", newline="")
    found = load(file)
    assert found.problems == []
    assert [(entry.key, entry.said) for entry in found.entries.values()] == [("a", ["Lee {file}."])]


@pytest.mark.parametrize(
    ("own", "said"),
    [
        (ROW, "Lee {file}."),
        (ROW.replace("Lee {file}", "Lee {fila}"), "Read {file}."),
        (ROW.replace("Lee {file}.", ""), "Read {file}."),
        (ROW.replace("Read", "Open"), "Read {file}."),
        ("#, fuzzy\n" + ROW, "Read {file}."),
        ("", "Read {file}."),
    ],
)
def test_what_is_not_translated_is_english_text_by_text(
    own: str, said: str, tmp_path: Path
) -> None:
    """A wrong or fuzzy text, and one whose English has changed, are not translated."""
    other = 'msgctxt "b"\nmsgid "Stop."\nmsgstr "Alto."\n'
    source, translated = tmp_path / "en.toml", tmp_path / "xx.po"
    source.write_text('[note]\na = "Read {file}."\nb = "Stop."\n', encoding="utf-8")
    translated.write_text(f"{HEAD}{own}\n{other}", encoding="utf-8")
    found = GNUTranslations(io.BytesIO(compiling.compiled(source, translated)))
    assert found.gettext("a") == said
    assert found.gettext("b") == "Alto."


def test_plurals_follow_the_rule_of_the_language() -> None:
    polish = (
        "nplurals=3; plural=(n==1 ? 0 : n%10>=2 && n%10<=4 && (n%100<10 || n%100>=20) ? 1 : 2);"
    )
    head = f"Content-Type: text/plain; charset=UTF-8\nPlural-Forms: {polish}\n"
    data = compiling.machine_object(head, {"n": ["bajt", "bajty", "bajtów"], "a": ["b\nc"]})
    found = GNUTranslations(io.BytesIO(data))
    assert [found.ngettext("n", "n", n) for n in (1, 2, 5, 22)] == [
        "bajt", "bajty", "bajtów", "bajty",
    ]  # fmt: skip
    assert found.gettext("a") == "b\nc"
    for language, one in (("en", "1 check"), ("es", "1 prueba")):
        said = Said("{n} checks" if language == "en" else "{n} pruebas")
        said.language = language
        assert said.format(n="1") == one
        assert said.format(n=0) != f"0 {one[2:]}"


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ('a = "A."\nb = "B.\n', 2, "this is no TOML: Illegal character"),
        ('a = "A."\na = "B."\n', 2, "this is no TOML: Cannot overwrite a value"),
        ('[x]\na = "A."\n[y]\na = "B."\n', 4, "a: it is there twice"),
        ('[x]\n"a/b" = ["A.", "A."]\n', 2, "a/b: it has a text twice"),
        ('[x]\na = "Read {file."\n', 2, "a: a brace { or } has no other half"),
        ('[x]\na = { one = "{n}", other = "{n" }\n', 2, "a: a brace { or } has no other half"),
        ("[x]\na = 5\n", 2, "a: it has no text"),
        ('a = { one = "{n}", others = "{n}" }\n', 1, "a: it has no text"),
        ('[x]\na = ""\n', 2, "a: it has no text"),
        ('[x]\na = { one = "{n} byte" }\n', 2, "a: it has no text"),
        ('"a/b".same = ""\n', 1, "a/b: it has no text"),
        ('[x]\nb = "B."\n"a/b".same = "S"\n"a/b".other = "S"\n', 3, "a/b: it has no text"),
    ],
)
def test_what_is_wrong_in_an_english_text_is_said_with_its_line(
    text: str, line: int, said: str, tmp_path: Path
) -> None:
    source = tmp_path / "en.toml"
    source.write_text(text, encoding="utf-8")
    ((at, why),) = catalogue_source.load(source).problems
    assert at == line and why.startswith(said)


def test_a_program_is_for_no_translator_and_may_have_a_lone_brace(tmp_path: Path) -> None:
    source, own = tmp_path / "en.toml", tmp_path / "own.po"
    source.write_text('a = "A."\n"b/wrong".same = "LOOP(3) {"\n', encoding="utf-8")
    found = catalogue_source.load(source)
    assert found.problems == []
    assert [each.key for each in in_step(found, Catalogue(), "es").entries.values()] == ["a"]
    assert [each.key for each in pseudo(found).entries.values()] == ["a"]
    assert compiling.merged(source, own)[1]["b/wrong"] == ["LOOP(3) {"]


def test_a_text_under_several_keys_is_translated_once_unless_it_means_something_else(
    tmp_path: Path,
) -> None:
    """A note that the key begins with is not said beside it."""
    source, own = tmp_path / "en.toml", tmp_path / "own.po"
    source.write_text(
        '[verb]\na = "Open"\nb = ["Shut", "Open"]\n[door]\ndoor.own = "Open"\n[menu]\nd = "Open"\n'
    )
    found = catalogue_source.load(source)
    rows = (("a", "Open", "Abrir"), ("b", "Shut", "Cierra"), ("door", "Open", "Abierta"))
    said = (f'msgctxt "{key}"\nmsgid "{was}"\nmsgstr "{now}"\n' for key, was, now in rows)
    own.write_text("\n".join(said), encoding="utf-8")
    made = in_step(found, load(own), "es")
    assert [(each.key, each.english, each.notes, each.said) for each in made.entries.values()] == [
        ("a", "Open", ["verb", "menu"], ["Abrir"]), ("b", "Shut", ["verb"], ["Cierra"]),
        ("door", "Open", [], ["Abierta"]),
    ]  # fmt: skip
    assert compiling.merged(source, own)[1] == {
        "a": ["Abrir"], "b": ["Cierra"], "b/2": ["Abrir"], "door": ["Abierta"], "d": ["Abrir"],
    }  # fmt: skip


@pytest.mark.parametrize("spoilt", ["x = ", 'x = "{"', f'x = "{"y" * 41}"'])
def test_a_wrong_english_text_goes_into_no_language(
    spoilt: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "languages"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.mo"))
    monkeypatch.setattr(languages, "FOLDER", folder)
    monkeypatch.setattr("tools.languages.FOLDER", folder)
    source, own = folder / SOURCE / "robot.toml", folder / "es" / "robot.po"
    source.write_text(f"{spoilt}\n{source.read_text(encoding='utf-8')}", encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["tools.languages"])
    assert bring_in_step() == 1
    assert capsys.readouterr().out.startswith("languages/en/robot.toml:1: ")
    assert own.read_bytes() == (FOLDER / "es" / "robot.po").read_bytes()


def test_a_catalogue_that_is_written_is_the_one_that_was_read() -> None:
    hard = 'a "b" \\ c\n\n d\t{x}\n'
    entry = Entry("k", hard, "", [hard], ["a note"])
    many = Entry("n", "{n} byte", "{n} bytes", ["{n} b", "{n} bb"], [], is_fuzzy=True)
    made = Catalogue(read(HEAD).head, {entry.at: entry, many.at: many})
    found = read(written(made))
    assert found.problems == []
    assert written(found) == written(made)
    assert found.entries[entry.at].said == [hard]
    assert found.entries[many.at].is_fuzzy


@pytest.mark.parametrize("language", languages.languages()[1:])
def test_a_text_in_front_of_others_moves_and_loses_no_translation(
    language: str, tmp_path: Path
) -> None:
    """The number of a text is its place in English alone, of which no translation knows."""
    source, own = SOURCES["messages"], load(FOLDER / language / "messages.po")
    new = [(key, f"New: {english}") for key, english in source.entries if "/title" not in key]
    texts: dict[str, list[str]] = {}
    for at in (*new, *source.entries):
        texts.setdefault(at[0], []).append(at[1])
    files = tmp_path / "en.toml", tmp_path / "own.po"
    rows = (f"{json.dumps(key)} = {json.dumps(each)}\n" for key, each in texts.items())
    files[0].write_text("".join(rows), encoding="utf-8")
    many = catalogue_source.load(files[0])
    english = compiling.merged(*files)[1]
    said = {at: entry.said for at, entry in own.entries.items() if entry.is_translated}
    for each in (own, in_step(many, own, language)):  # before somebody runs the tool, and after it
        files[1].write_text(written(each), encoding="utf-8")
        found = compiling.merged(*files)[1]
        pairs = {(key.partition("/")[0], english[key][0]): found[key] for key in found}
        assert len(said) > (500 if languages.about("x-complete", language) else 0)
        for (key, was), forms in said.items():
            assert pairs[key.partition("/")[0], was] == forms


def test_what_a_robot_cannot_say_and_a_lexicon_does_not_know_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said = [Entry("a", "Stop.", "", [each]) for each in ("x" * 41, "Arrêt", "Halte")]
    own = Catalogue("", {(str(k), each.key): each for k, each in enumerate(said)})
    assert [why for _, why in check_robot(own)] == [
        f"a robot says at most 40 signs, in ASCII: {each.said[0]}" for each in said[:2]
    ]
    rows = ["F | AVANCE", "F AVANCE", "QQ | RECULE", "B | recule", "B | RECULÉ", "number 2 | DEUX"]
    english = languages.table(SOURCE, "lexicon.txt")
    tables = {SOURCE: english, "fr": "\n".join(rows)}
    monkeypatch.setattr("tools.languages.table", lambda language, _: tables[language])
    assert [*check_lexicon("fr")] == rows[1:5]


@pytest.mark.parametrize("language", languages.languages())
def test_each_robot_can_say_its_texts_and_each_row_of_a_lexicon_is_known(language: str) -> None:
    own = SOURCES["robot"] if language == SOURCE else load(FOLDER / language / "robot.po")
    assert [*check_robot(own)] == []
    assert [*check_lexicon(language)] == []


def test_a_text_that_changed_keeps_its_translation_as_fuzzy() -> None:
    """Not one that is new beside it, nor one whose key has another text of the same words."""
    old = [Entry("try", "Read {file}.", "", ["Lee {file}."]), Entry("gone", "Stop.", "", ["Alto."])]
    new = [Entry("try", "Take it out."), Entry("try", "Read {file} again."), Entry("end", "Stop."),
           Entry("gone/more", "Stop.")]  # fmt: skip
    own, source = (Catalogue("", {each.at: each for each in some}) for some in (old, new))
    made = in_step(source, own, "es").entries.values()
    assert [(each.said, each.is_fuzzy) for each in made] == [
        ([], False), (["Lee {file}."], True), (["Alto."], True), (["Alto."], True),
    ]  # fmt: skip


@pytest.mark.parametrize(("name", "language"), [
    ("es_PE.UTF-8", "es"), ("es", "es"), ("ES-pe", "es"), ("es_ES@euro", "es"), ("C", "en"),
    ("Spanish_Peru.1252", "es"), ("POSIX", "en"), ("C.UTF-8", "en"), ("tlh_XX.UTF-8", "en"),
    ("", "en"), ("_", "en"), ("../es", "en"), ("__pycache__", "en"), ("eso", "en"),
])  # fmt: skip
def test_a_locale_has_a_language_or_english(name: str, language: str) -> None:
    assert languages.find(name) == language


def test_the_variables_of_a_locale_count_as_everywhere() -> None:
    assert language_of([], {"LC_ALL": "C", "LANG": "es_PE.UTF-8"}) == "en"
    assert language_of([], {"LC_ALL": "", "LANG": "es_PE.UTF-8"}) == "es"
    assert language_of(["--lang", "xx"], {"LANG": "es_PE.UTF-8"}) == "es"
    assert language_of(["--lang=en"], {"LANG": "es_PE.UTF-8"}) == "en"


def test_an_unknown_language_is_refused_with_the_known_ones(tsc: Tsc) -> None:
    done = tsc("check", "-e", "W(1)", "--lang", "xx")
    assert done.code == 2
    assert all(code in done.err for code in languages.languages())


def test_a_clone_makes_what_is_stale_and_needs_no_folder_to_write_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for path in languages.files("command", "es"):
        (tmp_path / path.parent.name).mkdir()
        (tmp_path / path.parent.name / path.name).write_bytes(path.read_bytes())
    monkeypatch.setattr(languages, "FOLDER", tmp_path)
    made, source = tmp_path / "es" / "command.mo", tmp_path / "es" / "command.po"

    def stopped() -> str:
        languages.catalogue.cache_clear()
        return text("stopped", "es")

    try:
        assert stopped() == "Detenido."
        made.write_bytes(made.read_bytes().replace(b"Detenido.", b"Parado!!!"))
        assert stopped() == "Parado!!!", "it is read as it is while nothing is newer"
        os.utime(source, (made.stat().st_mtime + 2,) * 2)
        assert stopped() == "Detenido."
        made.unlink()
        made.mkdir()  # nobody can write this file
        assert stopped() == "Detenido."
    finally:
        languages.catalogue.cache_clear()


@pytest.fixture
def longer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A language whose texts are a third longer, beside English."""
    for code in (*languages.languages(), PSEUDO):
        (tmp_path / code).mkdir()
    for name, source in SOURCES.items():
        made = tmp_path / PSEUDO / f"{name}.po"
        made.write_text(written(pseudo(source)), encoding="utf-8")
        assert load(made).problems == []
    for path in FOLDER.glob(f"{SOURCE}/*.toml"):
        (tmp_path / SOURCE / path.name).write_bytes(path.read_bytes())
    check("avansar(2, 80)")  # what words mean is read once: of this folder all later tests had none
    monkeypatch.setattr(languages, "FOLDER", tmp_path)
    _forget()
    yield PSEUDO
    _forget()


def _forget() -> None:
    languages.languages.cache_clear()
    languages.catalogue.cache_clear()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


SAID = (
    ("check", "-e", "F(2 80)\nAVANZA 20\n\nF(60, 80) UNTIL(DISTANCE < 10) AND LATER THAN EVER"),
    ("check", "no_such_file.ts"), ("complie",), ("robot", "--world", "no_such_world"),
    ("explain", "TS017"), ("upload", "-e", "S", "--port", "/dev/no_such_port"),
)  # fmt: skip


@pytest.mark.parametrize("words", SAID, ids=" ".join)
def test_a_terminal_has_sentences_in_its_width_and_a_pipe_each_in_one_row(
    longer: str, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LC_ALL", longer)
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    said = []
    for kind in (Terminal, io.StringIO):
        streams = kind(), kind()
        for name, stream in zip(("stdout", "stderr"), streams, strict=True):
            monkeypatch.setattr(sys, name, stream)
        main([*words])
        said.append("".join(each.getvalue() for each in streams))
    narrow, wide = said
    assert max(map(len, narrow.split("\n"))) <= 80 < max(map(len, wide.split("\n")))
    assert narrow.split() == wide.split(), "nothing is lost, nor hidden"
    frames = [row for row in wide.split("\n") if re.search(r"^\S+ \d+:  |^ +\^+$", row)]
    assert [row for row in frames if row not in narrow.split("\n")] == []


@pytest.mark.parametrize(("said", "rows"), [
    ("Nothing is too long.", ["Nothing is too long."]),
    ("Once upon a time, behind it", ["Once upon a time,", "behind it"]),
    ("Lift it. Try:  tsc run -e S", ["Lift it. Try:", "tsc run -e S"]),
    ("Try:  tsc run --sensor A=1,2,3", ["Try:  tsc run", "--sensor A=1,2,3"]),
    ("Try:  /a/long/path/python -m x", ["Try:", "/a/long/path/python -m x"]),
    ("  seen: a port that is", ["  seen: a port that", "  is"]),
    ("one\n\nhttp://long.example/a/page", ["one", "", "http://long.example/a/page"]),
])  # fmt: skip
def test_a_command_stays_in_one_row_where_there_is_room(said: str, rows: list[str]) -> None:
    assert wrapped(said, 20) == "\n".join(rows)


# What is laid out, on a terminal and elsewhere.
LAID_OUT = (("help",), ("help", "all"), *(("help", verb) for verb in VERBS))


def test_texts_that_are_longer_keep_to_80_columns(
    longer: str, tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And each of their texts is another one there: none is outside of the catalogues."""
    for words in LAID_OUT:
        rows = {}
        for language in (SOURCE, longer):
            monkeypatch.setenv("LC_ALL", language)
            rows[language] = tsc(*words).out.splitlines()
        assert [row for row in rows[longer] if len(row) > 80] == [], words
        same = {row for row in {*rows[SOURCE]} & {*rows[longer]} if "$(" not in row}  # no code
        assert [row for row in same if re.search(r"^ *\w.*[a-z]{3} [a-z]{3}", row)] == [], words


# What nobody who speaks the language says, whatever the message: brackets that keep, a DEF or a
# part that is "made", a task that "moves itself", a thing to take out that has no name.
UNSAID = {
    "es": r"\bva desde \{|se mueve el TASK|el TASK [^.]* se mueve\b|Quita esto\b|no entra: aquí",
    "pt": r"parênteses de \{word\} guardam|nunca é feit[oa]|a TASK [^.]* anda\b|Tire isto\b",
    "en": r"Take this out\b",
}


@pytest.mark.parametrize("language", UNSAID)
def test_a_message_says_nothing_that_nobody_says(language: str) -> None:
    said = [
        text
        for key, texts in messages_of(language).items()
        for text in texts
        if "/more" not in key and re.search(UNSAID[language], text)
    ]
    assert not said


def messages_of(language: str) -> dict[str, list[str]]:
    """Return the texts of messages by key."""
    found: dict[str, list[str]] = {}
    for number in CODES:
        for part in ("message", "try", "more"):
            key = f"{number}/{part}"
            found[key] = [*rendering._texts(key, language)]
    assert sum(map(len, found.values())) > 400
    return found
