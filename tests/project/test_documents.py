"""The documents are right: commands print what they show, and links lead somewhere."""

from __future__ import annotations

import re
import shlex
import sys
from contextlib import redirect_stderr
from importlib.util import find_spec
from pathlib import Path
from shutil import copytree
from typing import NamedTuple

import pytest

import tiniscript
from tests.support.casefile import ROOT, Example, examples
from tests.support.rows import each_row
from tiniscript.cli import main
from tools.site.documents import FRONT_PAGE, documents, links, name_in, sources

DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])


class Command(NamedTuple):
    """`$ tsc ...` in a document, and the lines that follow it there."""

    document: Path
    line: int
    words: list[str]
    shown: str


def commands() -> list[Command]:
    """Return every `tsc` command of every console fence, with the output that the document
    shows."""
    command_list: list[Command] = []
    for document in DOCUMENTS:
        fence, is_our_command = "", False
        for number, row in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
            if row.startswith("```"):
                fence, is_our_command = ("" if fence else row[3:].strip() or "text"), False
            elif fence == "console" and row.startswith("$ "):
                words = shlex.split(row[2:])
                is_our_command = words[0] in ("tsc", "tiniscript")
                if is_our_command:
                    command_list.append(Command(document, number, words[1:], ""))
            elif is_our_command:
                command_list[-1] = command_list[-1]._replace(
                    shown=command_list[-1].shown + row + "\n"
                )
    return command_list


@each_row("language, name", sources(ROOT, FRONT_PAGE).items())
def test_every_readme_links_to_the_others(language: str, name: str) -> None:
    row = (ROOT / name).read_text(encoding="utf-8").splitlines()[2]
    assert row == " · ".join(links(language, FRONT_PAGE, sources(ROOT, FRONT_PAGE)))


@each_row(
    "language, name, others",
    [
        (value, name, document.sources)
        for document in documents(ROOT)
        for value, name in document.sources.items()
    ],
)
def test_a_document_links_to_all_its_translations_or_none(
    language: str, name: str, others: dict[str, str]
) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    targets = re.findall(r"\(.*?\)", " ".join(links(language, others["en"], others)))
    absent = [target for target in targets if target not in text]
    assert absent in ([], targets), f"{name} lacks {absent}"


@pytest.mark.parametrize("command", commands(), ids=lambda c: f"{c.document.name}:{c.line}")
def test_console_examples_are_right(
    command: Command, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """A command of a document prints what the document shows; the files that it needs are the
    examples."""
    for folder in (tmp_path / "examples", tmp_path):
        copytree(ROOT / "examples", folder, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    with redirect_stderr(sys.stdout):  # a terminal shows both in the order of their writing
        main(command.words)
    output = capsys.readouterr().out
    printed_text = "\n".join(row.rstrip() for row in output.splitlines() if row.strip())
    shown_text = "\n".join(row.rstrip() for row in command.shown.splitlines() if row.strip())
    if shown_text:
        assert printed_text == shown_text, f"{command.document.name}:{command.line}"


EXAMPLES = [
    example for path in DOCUMENTS if path.name != "CONTRIBUTING.md" for example in examples(path)
]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda value: f"{value.path.name}:{value.line}")
def test_python_examples_are_right(
    example: Example, request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str],
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The Python of a document runs, and prints what the document shows."""
    code = example.code
    if example.has_robot:
        code = code.replace("/dev/ttyUSB0", request.getfixturevalue("pty_robot").port)
        assert code != example.code
    monkeypatch.chdir(tmp_path)
    exec(compile(code, f"{example.path}:{example.line}", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out == example.output


@each_row("name", sources(ROOT, "docs/en/api.md").values())
def test_each_page_of_the_library_documents_all_names(name: str) -> None:
    page = (ROOT / name).read_text(encoding="utf-8")
    absent = [name for name in tiniscript.__all__ if f"`{name}" not in page]
    assert not absent, f"{name} says nothing of {absent}"
    assert len(examples(ROOT / name)) == len(examples(ROOT / "docs" / "en" / "api.md")) >= 8


@each_row("document", DOCUMENTS)
def test_links_have_existing_targets(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        if "://" not in target:
            assert (document.parent / target).exists(), f"{document.name}: {target}"


TRANSLATED_DOCUMENTS = [
    (language, name, document.sources["en"])
    for document in documents(ROOT)
    for language, name in document.sources.items()
    if language != "en"
]


@each_row("language, name, english", TRANSLATED_DOCUMENTS)
def test_a_translation_links_to_documents_of_its_language(
    language: str, name: str, english: str
) -> None:
    page = ROOT / name
    errors = []
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
        led = (page.parent / target).resolve().relative_to(ROOT).as_posix()
        own_name = name_in(language, led)
        if led not in (english, own_name) and (ROOT / own_name).is_file():
            errors.append(f"{target}: there is {own_name}")
    assert not errors, "\n".join(errors)


# -- names of files, folders and modules ----------------------------------------------------------

SOURCES = sorted(
    path
    for folder in ("compiler", "tests", "tools", "vm_arduino")
    for end in ("py", "md", "cpp", "h", "c", "S", "ini", "toml")
    for path in (ROOT / folder).rglob(f"*.{end}")
    if not {".pio", "node_modules"} & set(path.parts)
)
FOLDERS = ("compiler", "tests", "tools", "docs", "examples", "vm_arduino")
# The beginning of a path in a document, a docstring or a comment.
BASES = (ROOT, ROOT / "compiler" / "tiniscript", ROOT / "vm_arduino", ROOT / "vm_arduino" / "src")
# Names of files that a person has, and of those that a build makes.
FOREIGN_FILES = {"prog.ts", "own.h", "myrobot.toml", "my.toml", "firmware.elf"}
PATH = r"[\w.-]+(?:/[\w.-]+)+/?"
FILE_NAME = r"[\w-]+\.(?:py|md|cpp|h|c|S|ini|toml|ts|sh|wasm|ino)"


def spans_of(path: Path) -> list[str]:
    """Return the texts between backquotes, outside of fences."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.findall(r"`([^`\n]+)`", text)


def modules_in(path: Path) -> list[str]:
    return re.findall(r"python -m ((?:tools|tests|tiniscript)[\w.]*\w)", path.read_text("utf-8"))


# Files that commands create in a clone, which `.gitignore` lists.
BUILT_FOLDERS = {"compiler/tiniscript/studio/page/", "tools/studio/node_modules"}


def exists(path: str) -> bool:
    return path in BUILT_FOLDERS or any((base / path).exists() for base in BASES)


@each_row("document", [*DOCUMENTS, ROOT / "tools" / "uno" / "README.md"])
def test_mentioned_files_exist(document: Path) -> None:
    """A span with a folder of the repository in front is a path; a file's name alone is one's name.

    `NAME.toml` and `tests/*.py` are no names.
    """
    known_names = {path.name for path in (*SOURCES, *ROOT.glob("examples/*.ts"), *ROOT.iterdir())}
    known_names |= FOREIGN_FILES | {
        "machine.wasm",
        "robot.wasm",
        "robot_mega.wasm",
        "robot_esp32.wasm",
    }
    errors = []
    for span in spans_of(document):
        is_path = bool(re.fullmatch(PATH, span)) and span.split("/")[0] in FOLDERS
        is_path = is_path or bool(re.fullmatch(r"(?:\w+/)+(?:" + FILE_NAME + ")?", span))
        if is_path and "NAME" not in span and not exists(span):
            errors.append(span)
        if document.parent == ROOT and re.fullmatch(FILE_NAME, span) and "NAME" not in span:
            errors += [] if span in known_names else [span]
    if document.name != "CHANGELOG.md":  # the changelog also describes the past
        assert not errors, "\n".join(errors)


def test_paths_in_sources_exist() -> None:
    """A path that a docstring or a comment names, as in a document."""
    names = {path.name for path in SOURCES} | {"serial.py"}  # a test writes this file
    errors = []
    for source in SOURCES:
        for span in spans_of(source):
            is_path = bool(re.fullmatch(PATH, span)) and span.split("/")[0] in FOLDERS
            is_wrong = is_path and "NAME" not in span and not exists(span)
            if is_wrong or (re.fullmatch(r"\w+\.py", span) and span not in names):
                errors.append(f"{source.relative_to(ROOT)}: {span}")
    assert not errors, "\n".join(errors)


# `stop_run` and `end_run` (`firmware/run.cpp`), `Link::turn` in `link/link.cpp`
SPAN = r"`[^`]+`"
NAMES_IN_FILE = re.compile(
    rf"({SPAN}(?:(?:, | and |, and ){SPAN})*),?\s+(?:in|of|\()\s*`([\w/]+\.(?:cpp|h|py))`"
)


def test_the_files_described_in_architecture_have_their_contents() -> None:
    text = (ROOT / "docs/develop/architecture.md").read_text(encoding="utf-8")
    paths = text[text.index("### The path of a program") : text.index("### Ten files to read")]
    count = 0
    for names, file in NAMES_IN_FILE.findall(paths):
        matches = [path for path in SOURCES if path.as_posix().endswith(f"/{file}")]
        matches += (ROOT / "vm_arduino" / "src").rglob(file)
        assert matches, file
        code = "\n".join(path.read_text(encoding="utf-8") for path in matches)
        for span in re.findall(r"`([\w:]+)`", names):
            count += 1
            name = span.rpartition("::")[2]
            assert re.search(rf"\b{name}\b", code), f"{file} has no {span}"
    assert count >= 15


@each_row("document", DOCUMENTS)
def test_a_row_of_a_table_has_the_cells_of_its_heading(document: Path) -> None:
    cells = 0
    for line in re.sub(r"(?ms)^```.*?^```", "", document.read_text(encoding="utf-8")).split("\n"):
        bars = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else 0
        assert not cells or bars in (0, cells), line
        cells = bars


def test_a_version_of_the_changelog_has_each_heading_once() -> None:
    """A merge of two branches with the same heading leaves one of them over."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    order = ["Breaking", "Added", "Changed", "Fixed"]
    _, *versions = re.split(r"(?m)^## ", text)
    assert len(versions) > 2
    for version in versions:
        headings = re.findall(r"(?m)^### (.*)$", version)
        assert headings == [heading for heading in order if heading in headings], version.split(
            "\n"
        )[0]
        assert not re.search(r"(?m)[^\n]\n#", version), "a heading follows an empty line"


def test_mentioned_modules_exist() -> None:
    """Modules of `python -m` in documents, sources and scripts exist."""
    paths = [*DOCUMENTS, *SOURCES, *ROOT.glob("tools/*.sh"), *ROOT.glob(".ci/*")]
    named_modules = {(path.name, module) for path in paths for module in modules_in(path)}
    assert ("CONTRIBUTING.md", "tools.generate") in named_modules
    for name, module in sorted(named_modules):
        module_spec = find_spec(module)
        assert module_spec is not None, f"{name}: {module}"
        if module_spec.submodule_search_locations is not None:
            assert find_spec(module + ".__main__") is not None, f"{name}: {module}"


def test_examples_have_no_mistakes(capsys: pytest.CaptureFixture[str]) -> None:
    examples = sorted((ROOT / "examples").glob("*.ts"))
    assert len(examples) >= 5
    for example in examples:
        assert main(["check", str(example)]) == 0
        assert main(["fmt", "--check", str(example)]) == 0
        assert main(["run", str(example), "--max-time", "5"]) == 0
        capsys.readouterr()
