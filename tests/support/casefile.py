"""Reads case files: a Markdown chapter whose fences run.

Each heading `## sentence` that has fences is a case; each fence states one thing about it. The
language of the fence says which: `tiniscript` (the program), `senses` (readings and limits),
`robot` (the trace), `bytecode` (the listing), `plain` (that of its plain code), `line` (what a
robot that reads text gets), `mistake` and `warning` (what is said; without a program above, the
line that it shows is the program). A fence `refused` has many cases: the rule that a listing breaks
and what the case is about, above the listing; rows that begin with `//` are for people, and so are
fences of other languages.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
PARTS = ("tiniscript", "senses", "robot", "bytecode", "plain", "line", "mistake", "warning",
         "formatted")  # fmt: skip
LISTED = re.compile("[0-9a-f]{4}  ")
SHOWN = re.compile(r"(?:line|línea) 1:  (.*\n)")


class Case(NamedTuple):
    """`parts` maps a fence's language to its text, and `refused` to the rule of a listing."""

    path: Path
    line: int
    title: str
    parts: dict[str, str]

    @property
    def id(self) -> str:
        return f"{self.path.stem}: {self.title}"


def documents() -> list[Path]:
    """Return every file that holds cases. They are found, never listed."""
    found = [*ROOT.glob("tests/cases/**/*.md"), *ROOT.glob("docs/**/*.md")]
    return sorted([*found, ROOT / "bytecode_spec.md", *ROOT.glob("README*.md")])


def read(path: Path) -> list[Case]:
    """Return the cases of one file. A case whose fences repeat continues in a case of its own."""
    cases: list[Case] = []
    title, fence, count = "", "", 0
    lines: list[str] = []
    for number, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if row.startswith("```"):
            language = row[3:].strip()
            if fence:
                if fence in PARTS:
                    found = cases[-1].parts
                    found[fence] = "".join(line + "\n" for line in lines)
                    if fence in ("mistake", "warning") and (shown := SHOWN.match(found[fence])):
                        found.setdefault("tiniscript", shown[1])
                fence = ""
            else:
                fence, lines = language or "text", []
                if fence in PARTS:
                    # a new program, or a listing that is not the program's, begins a new case
                    starts = fence in ("tiniscript",) or not cases or fence in cases[-1].parts
                    if starts or cases[-1].title.split(" #")[0] != title:
                        count += 1
                        name = title if count == 1 else f"{title} #{count}"
                        cases.append(Case(path, number, name, {}))
        elif fence == "refused":
            if LISTED.match(row):
                cases[-1].parts["bytecode"] += f"{row}\n"
            elif not row.startswith("//"):
                rule, name = row.split(": ", 1)
                cases.append(Case(path, number, name, {"refused": f"{rule}\n", "bytecode": ""}))
        elif fence:
            lines.append(row)
        elif row.startswith("#"):
            title, count = row.lstrip("#").strip(), 0
    assert not fence, f"{path.name}: a fence is not closed"
    return cases


class Example(NamedTuple):
    """A fence `python`: code that runs in a namespace of its own, and the fence `output` right
    behind it. `has_robot`: it is `python robot`, and connects to the robot on /dev/ttyUSB0."""

    path: Path
    line: int
    code: str
    output: str
    has_robot: bool


def examples(path: Path) -> list[Example]:
    """Return the Python of one document."""
    found: list[Example] = []
    fence, start, lines = "", 0, list[str]()
    is_right_behind = False  # an example, with nothing but empty lines between
    for number, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not row.startswith("```"):
            lines.append(row)
            is_right_behind = is_right_behind and (bool(fence) or not row.strip())
        elif not fence:
            fence, start, lines = row[3:].strip() or "text", number, []
        else:
            text = "".join(f"{line}\n" for line in lines)
            is_python = fence in ("python", "python robot")
            if is_python:
                found.append(Example(path, start, text, "", fence == "python robot"))
            elif fence == "output":
                assert is_right_behind, f"{path.name}:{start}: the output of no example"
                found[-1] = found[-1]._replace(output=text)
            is_right_behind, fence = is_python, ""
    return found


def all_cases() -> list[Case]:
    return [case for path in documents() for case in read(path)]


def example_robot(path: Path) -> str:
    """Return the robot that a program of `examples/` is for."""
    named = re.search(r"--robot (\w+)", path.read_text(encoding="utf-8"))
    return named[1] if named else "tinibot"


def has_tasks(text: str) -> bool:
    return "END_WHEN" in text or "END_TASK" in text


def sketch_examples() -> list[Path]:
    """Return the programs of `examples/` that a sketch can do: it has no tasks."""
    paths = sorted((ROOT / "examples").glob("*.ts"))
    return [path for path in paths if not has_tasks(path.read_text(encoding="utf-8"))]


def accept(case: Case, part: str, actual: str) -> None:
    """Write `actual` where the case says something else; git shows what changed."""
    rows = case.path.read_text(encoding="utf-8").splitlines(keepends=True)
    # where the case stands now: what was accepted before may have moved it
    line = next(each.line for each in read(case.path) if each.title == case.title)
    if "refused" in case.parts:
        listed = [k for k in range(line, len(rows)) if LISTED.match(rows[k])]
        end = next(k for k in range(listed[0], len(rows)) if k not in listed)
        if part == "bytecode":
            rows[listed[0] : end] = [actual]
        else:
            rows[line - 1] = f"{actual.rstrip()}: {case.title}\n"
    else:
        start = next(
            k for k, row in enumerate(rows) if k >= line - 1 and row.rstrip() == f"```{part}"
        )
        end = next(k for k in range(start + 1, len(rows)) if rows[k].startswith("```"))
        rows[start + 1 : end] = [actual]
    case.path.write_text("".join(rows), encoding="utf-8")
