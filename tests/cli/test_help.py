"""Help lists exactly the parsers' options, in both languages, and fits a terminal."""

from __future__ import annotations

import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest

from tests.support.command import PROGRAM, Tsc, run_in_process
from tests.support.rows import each_row
from tests.support.terminal import Terminal
from tests.support.texts import LANGUAGES
from tests.support.texts import catalogue_texts as all_said
from tests.support.verbs import parsers, words_of
from tiniscript import robots
from tiniscript.cli import help, main
from tiniscript.cli.texts.options import OPTIONS, Option, options_of, shown_of
from tiniscript.cli.texts.options import PROGRAM as A_PROGRAM
from tiniscript.cli.texts.verbs import (
    COMMANDS,
    FIRST_COMMANDS,
    NOTES,
    VERBS,
    command_words,
    steps_of,
)
from tiniscript.cli.texts.verbs import verb_sentence as of_verb_text
from tiniscript.cli.texts.verbs import verb_text as said_in
from tiniscript.flash.bootloaders import BOARDS
from tiniscript.robots.ports import AVRS
from tiniscript.virtual import worlds
from tools.generate.command_pages import DOCUMENTED, page
from tools.generate.documents import table

PARSERS = parsers()
FLAG = r"(?<![\w-])--?[a-zA-Z][a-z0-9-]*"

in_both = pytest.mark.parametrize("language", LANGUAGES)
of_each = each_row("verb", COMMANDS)


def rows_of(help_text: str) -> list[str]:
    """Return the left column of a help text: `-o FILE`, `PROGRAM`."""
    return [row.strip() for row in re.findall(r"^  (\S.*?)(?:  |$)", help_text, re.M)]


def flags_in_help(verb: str) -> list[str]:
    """Return the flags of a verb, without the silent ones."""
    used_names = {flag for action in PARSERS[verb]._actions for flag in action.option_strings}
    undocumented = [option for option in options_of(verb) if option not in shown_of(verb)]
    unsaid_texts = {
        flag for option in undocumented if not option.is_argument for flag in option.flags.split()
    }
    assert unsaid_texts <= used_names
    return sorted(used_names - unsaid_texts)


@in_both
@of_each
def test_parser_flags_and_help_agree(tsc: Tsc, verb: str, language: str) -> None:
    """Includes whether the flag has a value."""
    words = command_words(verb).split()
    values = [] if words[-1] in words_of(verb) else ["x"]
    result = tsc(*words, *values, "--help", "--lang", language).gives(0)
    rows = [row for row in rows_of(result.out) if not row.startswith("tsc ")]
    flags = [flag for row in rows for flag in re.findall(FLAG, row)]
    assert sorted(flags) == flags_in_help(verb)
    arguments = [row for row in rows if not row.startswith("-")]
    assert len(arguments) == sum(option.is_argument for option in shown_of(verb))
    for argument in arguments:
        assert re.search(rf"\b{argument}\b", result.out.splitlines()[0])
    known_names = {
        flag
        for parser in PARSERS.values()
        for action in parser._actions
        for flag in action.option_strings
    }
    assert set(re.findall(FLAG, result.out)) <= known_names | {"-N", "-Uz"}  # a number; of zsh
    for action in PARSERS[verb]._actions:
        if set(action.option_strings) & set(flags):
            (row,) = (
                row for row in rows if action.option_strings[0] in row.split(" ")[0].split(",")
            )
            assert (action.nargs == 0) == (re.fullmatch(rf"{FLAG}(, {FLAG})*", row) is not None), (
                row
            )


@in_both
@pytest.mark.parametrize("columns", [80, 60, 40])
def test_help_fits_a_terminal(language: str, columns: int) -> None:
    for help_text in (
        help.overview(language, columns),
        help.full_help(language, columns),
        *(help.help_of(command, language, columns) for command in COMMANDS),
    ):
        too_long = [line for line in help_text.splitlines() if len(line) > columns]
        # a word is not broken: a name of a file, or of many fields
        assert [line for line in too_long if " " in line.strip()] == []
        assert columns < 80 or not too_long


@in_both
def test_no_backticks_are_printed_and_no_texts_are_lost(language: str) -> None:
    def words(text: str) -> str:
        return " ".join(text.replace("`", "").split())

    everything = help.full_help(language)
    for command in COMMANDS:
        help_text = help.help_of(command, language)
        assert "`" not in help_text
        assert all(
            words(of_verb_text(command, part, language)) in words(help_text)
            for part in ("says", "ends")
        )
        for option in shown_of(command):
            assert words(option.help(language)) in words(help_text), option
        for step in steps_of(command):
            assert words(of_verb_text(step, "summary", language)) in words(help_text)
        if command != "set":
            assert words(of_verb_text(command, "summary", language)) in words(everything)
    for note in NOTES:
        assert words(said_in(note, language)) in words(help.full_help(language))


@in_both
def test_the_first_help_lists_the_ten_most_needed_commands(language: str) -> None:
    help_text = help.overview(language)
    assert len(help_text.splitlines()) <= 30
    assert [row.split()[1] for row in rows_of(help_text) if row.startswith("tsc ")] == list(
        FIRST_COMMANDS
    )


@each_row("question, verb", [
    ("put firmware on", "firmware"), ("rename robot", "set name"),
    ("list serial ports", "doctor --ports"), ("make it drive straight", "set trim"),
    ("read my program back", "show --port"), ("bluetooth pin", "doctor --module"),
    ("dibujar conexiones", "firmware --wiring"), ("conectar a la red wifi", "set wifi"),
    ("ir en línea recta", "set trim"), ("poner firmware", "firmware"),
    ("which port", "doctor --ports"), ("give it a name", "set name"),
    ("print a worksheet", "lesson"), ("lock the robot", "set owner"), ("use blocks", "studio"),
    ("robot does not answer", "doctor"), ("no responde", "doctor"),
    ("ver los sensores", "live"), ("programar con bloques", "studio"),
])  # fmt: skip
def test_a_command_is_found_by_what_it_does(tsc: Tsc, question: str, verb: str) -> None:
    result = tsc("help", question).gives(0)
    assert re.match(rf"tsc {verb}\b", rows_of(result.out)[0])
    assert tsc("help", *question.split()).out == result.out


def test_an_unanswerable_question_is_reported(tsc: Tsc) -> None:
    tsc("help", "bake", "a", "cake").gives(2, "no command matches “bake a cake”")
    assert tsc("help", "todo", "--lang", "es").out == help.full_help("es")


def test_an_option_that_help_does_not_show_works(tsc: Tsc) -> None:
    assert "--baud" not in help.help_of("name", "en")
    result = tsc(
        "set", "name", "ANA", "--port", "no_port_here", "--baud", "9600", "--robot", "tinibot"
    )
    assert "no_port_here" in result.err and result.code == 3
    for option in OPTIONS:
        assert set(option.silent_verbs.split()) <= set(option.verbs.split()), option


def test_every_command_is_a_module_and_every_module_a_command() -> None:
    folder = Path(help.__file__ or "").parent / "commands"
    assert {path.stem for path in folder.glob("*.py")} - {"__init__"} == set(COMMANDS)
    assert len(VERBS) == 18 and len({command_words(command) for command in COMMANDS}) == len(
        COMMANDS
    )


@each_row("option", OPTIONS)
def test_every_row_of_the_table_has_a_verb_and_text_in_both_languages(option: Option) -> None:
    assert option.verbs in ("*", "tsc") or set(option.verbs.split()) <= set(COMMANDS)
    english, spanish = (option.help(language) for language in ("en", "es"))
    assert english and spanish and english != spanish
    assert (option.kind is None) == (option.value == "")
    if option.kind is not None and option.kind.choices and not option.is_argument:
        assert option.value == "|".join(option.kind.choices)
    for language in LANGUAGES:
        assert option.help(language).count("`") % 2 == 0


def test_every_text_of_help_is_shown() -> None:
    """The catalogue has no text without a verb or an option."""
    known_names = {f"option/{option.flags}/{option.verbs.split()[0]}" for option in OPTIONS}
    known_names |= {f"value/{option.value}" for option in OPTIONS} | {
        f"group/{verb}" for verb in VERBS.values()
    }
    known_names |= {f"verb/{verb}/{part}" for verb in (*COMMANDS, "--version")
              for part in ("example", "summary", "says", "usage", "ends", "words")}  # fmt: skip
    unused_names = set(all_said("en", "help")) - known_names - set(NOTES)
    assert {key.partition("/")[0] for key in unused_names} == {
        "title", "more", "usage", "virtual", "steps", "all", "idle", "wrong",
    }  # fmt: skip


# Robots whose board `tsc firmware` writes to.
AVR_ROBOTS = [name for name in robots.names() if robots.load(name).board.chip in AVRS]


@in_both
@pytest.mark.parametrize(
    ("verb", "flag", "names"),
    [
        ("robot", "--world", worlds.names()),
        ("firmware", "--chip", BOARDS),
        ("firmware", "--robot", AVR_ROBOTS),
    ],
)
def test_help_lists_exactly_the_existing_names(
    verb: str, flag: str, names: list[str], language: str
) -> None:
    (option,) = (option for option in options_of(verb) if option.flags == flag)
    listed_names = re.split(r"[^a-z0-9-]+", option.help(language))
    assert set(names) <= set(listed_names)


def test_every_verb_with_a_program_accepts_it_on_the_command_line(tsc: Tsc, tmp_path: Path) -> None:
    """`upload`, which takes one too, needs a robot, `class` some, `lesson` a task: see theirs."""
    program_verbs = [
        verb for verb in VERBS if any(option.kind is A_PROGRAM for option in options_of(verb))
    ]
    assert program_verbs == ["lesson", "check", "run", "compile", "show", "fmt", "upload", "class"]
    for verb in program_verbs:
        assert "-e" in {flag for action in PARSERS[verb]._actions for flag in action.option_strings}
        if verb not in ("upload", "class", "lesson"):
            options = ["-o", str(tmp_path / "a.bin")] if verb == "compile" else []
            assert tsc(verb, "-e", PROGRAM, *options).code == 0
    assert "-e" in {flag for action in PARSERS["live"]._actions for flag in action.option_strings}


@pytest.mark.parametrize("language", DOCUMENTED)
@of_each
def test_the_documents_contain_the_full_help(verb: str, language: str) -> None:
    common_text, *sections = page(language, "a test", table).split("\n## ")
    sections = [section for part in sections for section in part.split("\n### ")]
    (section,) = (
        section for section in sections if section.startswith(f"`tsc {command_words(verb)}`\n")
    )
    rows = re.findall(r"^\| `(-.*?)` \|", common_text + "\n" + section, re.M)
    flags = [flag for row in rows for flag in re.findall(FLAG, row)]
    assert sorted(flags) == flags_in_help(verb)


# -- a page at a time -----------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def no_pager(monkeypatch: pytest.MonkeyPatch) -> None:
    """Remove the pager setting of the person who runs the tests."""
    for name in ("PAGER", "LESS"):
        monkeypatch.delenv(name, raising=False)


def on_terminal(words: str, **environ: str) -> Terminal:
    return Terminal(*words.split(), size=(80, 12), env=environ)


@pytest.mark.skipif(not shutil.which("less"), reason="there is no less")
@pytest.mark.parametrize(
    ("language", "keys"), [("en", "Space: more   q: end"), ("es", "Espacio: sigue   q: salir")]
)
def test_long_help_is_shown_a_page_at_a_time(language: str, keys: str) -> None:
    assert keys.isascii()  # less spoils other letters there
    terminal = on_terminal(f"help upload --lang {language}")
    terminal.until(f"{keys}$")
    assert b"tsc upload" in terminal.output_bytes and b"--seed" not in terminal.output_bytes
    terminal.type("G")
    terminal.until("-h, --help")
    assert b"--seed N" in terminal.output_bytes
    terminal.type("q")
    assert terminal.end() == 0


@pytest.mark.parametrize(
    ("rows", "environ"),
    [
        (12, {"PAGER": ""}),
        (12, {"PAGER": "cat"}),
        (12, {"PAGER": "no-such-pager-here --flag"}),
        (12, {"PATH": "/nowhere"}),  # no less either
        (12, {"TERM": "dumb", "PAGER": "false"}),
        (100, {"PAGER": "false"}),  # the text fits on the screen
    ],
)
def test_help_is_printed_without_a_pager(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch,
    rows: int, environ: dict[str, str],
) -> None:  # fmt: skip
    for name, value in {"TERM": "xterm", "COLUMNS": "80", "LINES": str(rows), **environ}.items():
        monkeypatch.setenv(name, value)
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True)
    assert main(["help", "upload", "--lang", "en"]) == 0
    assert capfd.readouterr().out == help.help_of("upload", "en", 80)


def test_redirected_help_is_never_paged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    marker = tmp_path / "begun"
    monkeypatch.setenv("PAGER", f"touch {marker}")
    result = run_in_process("help", "upload", "--lang", "en")
    assert (result.code, result.out, marker.exists()) == (0, help.help_of("upload", "en"), False)


def test_help_is_narrow_on_a_narrow_terminal(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert tsc("stop", "--help", "--lang", "en").out == help.help_of("stop", "en", 60)


PAGER = """
import os, signal, sys, time
def leave(*_):
    os.write(1, b"caught\\n")
    time.sleep(0.3)
    os.write(1, b"left\\n")
    os._exit(0)
signal.signal(signal.SIGINT, leave if sys.argv[1] == "waits" else signal.SIG_DFL)
sys.stdin.read()
os.write(1, b"begun\\n")
time.sleep(1000)
"""


@pytest.mark.parametrize(
    ("pager_mode", "output"), [("dies", ""), ("waits", "caught\r\nleft\r\n")], ids=["dies", "waits"]
)
def test_ctrl_c_belongs_to_the_pager_and_tsc_waits_silently(
    tmp_path: Path, pager_mode: str, output: str
) -> None:
    """`less` continues after Ctrl-C, `more` ends. A shell between would miss a signal sometimes."""
    (tmp_path / "pager.py").write_text(PAGER)
    words = shlex.join([sys.executable, str(tmp_path / "pager.py"), pager_mode])
    terminal = on_terminal("help upload --lang en", PAGER=f"exec {words}")
    terminal.until("begun")
    terminal.type("\x03")
    assert terminal.end() == 0
    partition_after = terminal.output_bytes.decode().partition("begun\r\n")[2]
    assert partition_after.replace("^C", "") == output


@each_row("words, english, spanish", [
    (["doctor", "--port"], "--port needs a value", "a --port le falta su valor"),
    (["doctor", "--json=3"], "--json takes no value: '3'", "--json no lleva valor: '3'"),
    (["doctor", "x"], "x is not an option or argument of this command",
     "x no es una opción ni un argumento de este comando"),
])  # fmt: skip
def test_argparse_errors_are_reported_in_plain_words(
    tsc: Tsc, words: list[str], english: str, spanish: str
) -> None:
    for language, expected in (("en", english), ("es", spanish)):
        result = tsc(words[0], "--lang", language, *words[1:]).gives(2)
        assert result.err.startswith(f"tsc: {expected}. ")


@each_row("words, meant_text", [
    (["firmware", "--wiring", "Grabber"], "--robot grabber"),
    (["upload", "x.ts", "--prot", "C"], "--port"), (["doctor", "--al"], "--all"),
    (["nmae", "ANA"], "set name"), (["idetify"], "doctor --identify"),
    (["doctor", "--selftset"], "--selftest"), (["doctor", "--ports", "--aks"], "--ask"),
    (["flash"], "firmware"), (["serial"], "monitor"), (["simulate", "x"], "robot"),
    (["repl"], "live"), (["version"], "--version"),
])  # fmt: skip
def test_the_suggestion_precedes_the_command_to_try(
    tsc: Tsc, words: list[str], meant_text: str
) -> None:
    assert f". Did you mean {meant_text}? Try:  tsc " in tsc(*words, "--lang", "en").err
    assert f". ¿Quisiste decir {meant_text}? Prueba:  tsc " in tsc(*words, "--lang", "es").err


def test_ctrl_c_before_the_language_is_known_ends_tsc_cleanly(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("tiniscript.cli._repair_streams", interrupt)
    assert main(["check", "-e", "S"]) == 2
