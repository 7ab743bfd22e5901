"""The documents keep their word: commands print what they show, and links lead somewhere."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import NamedTuple

import pytest

import tiniscript
from tests.machines import host
from tests.machines.wasm import missing
from tests.support.casefile import ROOT, Example, examples
from tiniscript.cli import main

DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])


class Command(NamedTuple):
    """`$ tsc ...` in a document, and the lines that follow it there."""

    document: Path
    line: int
    words: list[str]
    shown: str


def commands() -> list[Command]:
    """Return every `tsc` command of every console fence, with what the document shows."""
    found: list[Command] = []
    for document in DOCUMENTS:
        fence, collecting = "", False
        for number, row in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
            if row.startswith("```"):
                fence, collecting = ("" if fence else row[3:].strip() or "text"), False
            elif fence == "console" and row.startswith("$ "):
                words = shlex.split(row[2:])
                collecting = words[0] in ("tsc", "tiniscript")
                if collecting:
                    found.append(Command(document, number, words[1:], ""))
            elif collecting:
                found[-1] = found[-1]._replace(shown=found[-1].shown + row + "\n")
    return found


@pytest.mark.parametrize("command", commands(), ids=lambda c: f"{c.document.name}:{c.line}")
def test_console(
    command: Command, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """A command of a document prints what the document shows; files it needs are the examples."""
    from shutil import copytree

    copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    for example in (tmp_path / "examples").iterdir():
        (tmp_path / example.name).write_bytes(example.read_bytes())
    # the documents' robot of one's own: a copy of tinibot whose DISTANCE is called EYES
    profile = (ROOT / "compiler" / "tiniscript" / "robots" / "tinibot.toml").read_text("utf-8")
    (tmp_path / "mine.toml").write_text(profile.replace("DISTANCE", "EYES"), encoding="utf-8")
    main(command.words)
    said = capsys.readouterr()
    printed = "\n".join(row.rstrip() for row in (said.out + said.err).splitlines() if row.strip())
    shown = "\n".join(row.rstrip() for row in command.shown.splitlines() if row.strip())
    if shown:
        assert printed == shown, f"{command.document.name}:{command.line}"


EXAMPLES = [each for path in DOCUMENTS if path.name != "CONTRIBUTING.md" for each in examples(path)]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda each: f"{each.path.name}:{each.line}")
def test_python(
    example: Example, request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str],
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The Python of a document runs, and prints what the document shows."""
    if "virtual_robot" in example.code and missing():
        pytest.skip(missing())
    if example.has_robot and host.missing():
        pytest.skip(host.missing())
    code = example.code
    if example.has_robot:
        code = code.replace("/dev/ttyUSB0", request.getfixturevalue("pty_robot").port)
        assert code != example.code
    monkeypatch.chdir(tmp_path)
    exec(compile(code, f"{example.path}:{example.line}", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out == example.output


def test_both_pages_of_the_library_name_all_of_it() -> None:
    for name in ("api.en.md", "api.es.md"):
        page = (ROOT / "docs" / name).read_text(encoding="utf-8")
        absent = [each for each in tiniscript.__all__ if f"`{each}" not in page]
        assert not absent, f"{name} says nothing of {absent}"
    pages = [examples(ROOT / "docs" / name) for name in ("api.en.md", "api.es.md")]
    assert len(pages[0]) == len(pages[1]) >= 8


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        if "://" not in target:
            assert (document.parent / target).exists(), f"{document.name}: {target}"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_files_that_are_named_exist(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    pattern = r"`((?:compiler|tests|tools|docs|examples|vm_arduino)/[\w./-]+)`"
    for target in re.findall(pattern, text):
        assert (ROOT / target).exists(), f"{document.name}: {target}"


def test_examples_have_no_mistakes(capsys: pytest.CaptureFixture[str]) -> None:
    examples = sorted((ROOT / "examples").glob("*.ts"))
    assert len(examples) >= 5
    for example in examples:
        robot = "liner" if "--robot liner" in example.read_text(encoding="utf-8") else "tinibot"
        assert main(["check", str(example), "--robot", robot]) == 0
        assert main(["fmt", "--check", str(example)]) == 0
        assert main(["run", str(example), "--robot", robot, "--max-time", "5"]) == 0
        capsys.readouterr()
