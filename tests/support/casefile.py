"""Reads case files: a Markdown chapter whose fences run.

Each heading `## sentence` that has fences is a case; each fence states one thing about it. The
language of the fence says which: `tiniscript` (the program), `senses` (readings and limits),
`robot` (the trace), `bytecode` (the disassembly), `plain` (that of its plain code), `line` (what a
robot that reads text gets), `mistake` and `warning` (what is said; without a program above, the
line that it shows is the program). A fence `mistake` or `warning` may have many cases, each below a
row that says what it is about. A fence `refused` has it, too, with the rule that a disassembly
breaks in that row; rows that begin with `//` are for people, and so are fences of other languages.
A row of a disassembly that ends in `, 17 times` stands for so many.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from tiniscript.base.languages import languages
from tiniscript.library.named_robot import shipped_name_in
from tools.site.documents import language_of

ROOT = Path(__file__).resolve().parent.parent.parent
PARTS = ("tiniscript", "senses", "robot", "bytecode", "plain", "line", "mistake", "warning",
         "formatted")  # fmt: skip
LISTING_ROW = re.compile("[0-9a-f]{4}  ")
TIMES = re.compile(r"([0-9a-f]{4})  (((?:[0-9a-f]{2} )+) .*), (\d+) times")
MIN_FOLDED_ROWS = 4  # rows alike, and more, are one
FIRST_LINE = re.compile(r"(?:line|línea) 1:  (.*\n)")
TITLE_LINE = re.compile(r"(?m)^(\S.*)\n(?=(?:line|línea) \d+:  )")


class Case(NamedTuple):
    """`parts` maps a fence's language to its text, and `refused` to the rule of a disassembly."""

    path: Path
    line: int
    title: str
    parts: dict[str, str]

    @property
    def id(self) -> str:
        folder = self.path.parent.name
        language_prefix = f"{folder}/" if folder in languages() else ""
        return f"{language_prefix}{self.path.stem}: {self.title}"

    @property
    def language(self) -> str:
        return language_of(self.path.relative_to(ROOT).as_posix())


def documents() -> list[Path]:
    """Return every file that holds cases. They are found, never listed."""
    paths = [*ROOT.glob("tests/cases/**/*.md"), *ROOT.glob("docs/**/*.md")]
    return sorted([*paths, ROOT / "bytecode_spec.md", *ROOT.glob("README*.md")])


def read(path: Path) -> list[Case]:
    """Return the cases of one file. A case whose fences repeat continues as a separate case."""
    cases: list[Case] = []
    title, fence, count = "", "", 0
    lines: list[str] = []
    for number, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if row.startswith("```"):
            language = row[3:].strip()
            if fence:
                text = "".join(line + "\n" for line in lines)
                if fence in ("mistake", "warning"):
                    cases[-1:] = _split_by_message(cases[-1], fence, text, number)
                elif fence in PARTS:
                    cases[-1].parts[fence] = text
                fence = ""
            else:
                fence, lines = language or "text", []
                if fence in PARTS:
                    # a new program, or a disassembly that is not the program's, begins a new case
                    starts_case = fence in ("tiniscript",) or not cases or fence in cases[-1].parts
                    if starts_case or cases[-1].title.split(" #")[0] != title:
                        count += 1
                        name = title if count == 1 else f"{title} #{count}"
                        cases.append(Case(path, number, name, {}))
        elif fence == "refused":
            if LISTING_ROW.match(row):
                cases[-1].parts["bytecode"] += "".join(f"{line}\n" for line in _unfold(row))
            elif not row.startswith("//"):
                rule, name = row.split(": ", 1)
                cases.append(Case(path, number, name, {"refused": f"{rule}\n", "bytecode": ""}))
        elif fence:
            lines += _unfold(row)
        elif row.startswith("#"):
            title, count = row.lstrip("#").strip(), 0
    assert not fence, f"{path.name}: a fence is not closed"
    return cases


def _unfold(row: str) -> list[str]:
    """Return the rows that a row stands for."""
    if match := TIMES.fullmatch(row):
        offset, size = int(match[1], 16), len(bytes.fromhex(match[3]))
        return [f"{offset + k * size:04x}  {match[2]}" for k in range(int(match[4]))]
    return [row]


def _fold(text: str) -> str:
    """Return a disassembly with one row for several that are alike."""
    lines = []
    for _, group in groupby(
        text.splitlines(), lambda row: row[4:] if LISTING_ROW.match(row) else row
    ):
        rows = list(group)
        is_many = len(rows) >= MIN_FOLDED_ROWS and LISTING_ROW.match(rows[0])
        lines += [f"{rows[0]}, {len(rows)} times"] if is_many else rows
    return "".join(f"{row}\n" for row in lines)


def _split_by_message(case: Case, fence: str, text: str, end: int) -> Iterator[Case]:
    """Yield a case with its messages, and one for each row that names its subject."""
    preamble, *titled = TITLE_LINE.split(text)
    parts = [(case, preamble)] if preamble or not titled else []
    if case.parts and titled and not preamble:
        yield case  # the case of the heading above, whose text is complete
    line = end - sum(block.count("\n") for block in titled) - len(titled) // 2
    for title, part_text in zip(titled[::2], titled[1::2], strict=True):
        parts.append((Case(case.path, line, title, {}), part_text))
        line += 1 + part_text.count("\n")
    for example, part_text in parts:
        example.parts[fence] = part_text and part_text.rstrip("\n") + "\n"
        if shown_match := FIRST_LINE.match(part_text):
            example.parts.setdefault("tiniscript", shown_match[1])
        yield example


class Example(NamedTuple):
    """A fence `python`: code that runs in a namespace of its own, and the fence `output` right
    after it. `has_robot`: it is `python robot`, and connects to the robot on /dev/ttyUSB0."""

    path: Path
    line: int
    code: str
    output: str
    has_robot: bool


def examples(path: Path) -> list[Example]:
    """Return the Python of one document."""
    example_list: list[Example] = []
    fence, start, lines = "", 0, list[str]()
    is_right_after = False  # an example, with nothing but empty lines between
    for number, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not row.startswith("```"):
            lines.append(row)
            is_right_after = is_right_after and (bool(fence) or not row.strip())
        elif not fence:
            fence, start, lines = row[3:].strip() or "text", number, []
        else:
            text = "".join(f"{line}\n" for line in lines)
            is_python = fence in ("python", "python robot")
            if is_python:
                example_list.append(Example(path, start, text, "", fence == "python robot"))
            elif fence == "output":
                assert is_right_after, f"{path.name}:{start}: the output of no example"
                example_list[-1] = example_list[-1]._replace(output=text)
            is_right_after, fence = is_python, ""
    return example_list


def all_cases() -> list[Case]:
    return [case for path in documents() for case in read(path)]


def example_robot(path: Path) -> str:
    """Return the robot that a program of `examples/` is for."""
    return shipped_name_in(path.read_bytes()) or "tinibot"


def has_tasks(text: str) -> bool:
    return "END_WHEN" in text or "END_TASK" in text


def sketch_examples() -> list[Path]:
    """Return the programs of `examples/` that a sketch can do: it has no tasks."""
    paths = sorted((ROOT / "examples").glob("*.ts"))
    return [path for path in paths if not has_tasks(path.read_text(encoding="utf-8"))]


def accept(case: Case, part: str, actual: str) -> None:
    """Write `actual` where the case differs; git shows the changes."""
    rows = case.path.read_text(encoding="utf-8").splitlines(keepends=True)
    # The current place of the case, which earlier accepts may have moved.
    written_case = next(
        written_case for written_case in read(case.path) if written_case.title == case.title
    )
    if part == "refused":
        rows[written_case.line - 1] = f"{actual.rstrip()}: {written_case.title}\n"
    else:
        start = written_case.line
        if rows[start - 1].startswith("```"):
            start = rows.index(f"```{part}\n", start - 1) + 1
        while rows[start].startswith("//") and "refused" in written_case.parts:
            start += 1
        rows[start : start + _fold(written_case.parts[part]).count("\n")] = [_fold(actual)]
    case.path.write_text("".join(rows), encoding="utf-8")
