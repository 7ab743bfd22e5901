"""The texts that visitors read first are true: versions, the citation, marks of generated files."""

from __future__ import annotations

from fnmatch import fnmatch

import tiniscript
from tests.support.casefile import ROOT
from tests.support.rows import each_row
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link.messages import MAJOR, MINOR
from tools.generate.__main__ import OUTPUTS

GENERATED_MARKS = ("// Generated", "# Generated", "; Generated")


def test_the_page_of_versions_matches_the_code() -> None:
    page = (ROOT / "docs" / "en" / "versions.md").read_text(encoding="utf-8")
    assert f"| TiniScript, the package | `{tiniscript.__version__}` |" in page
    assert f"| the bytecode | {ISA_MAJOR}.{ISA_MINOR} |" in page
    assert f"| the link | {MAJOR}.{MINOR} |" in page


def test_the_citation_has_the_version() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {tiniscript.__version__}\n" in text


def marks() -> list[str]:
    rows = (ROOT / ".gitattributes").read_text(encoding="utf-8").splitlines()
    return [row.split()[0] for row in rows if row.endswith("linguist-generated")]


@each_row("pattern", marks())
def test_marked_files_are_generated(pattern: str) -> None:
    names = [path.relative_to(ROOT).as_posix() for path, _ in OUTPUTS]
    assert any(fnmatch(name, pattern) for name in names), "nothing is generated there"


def test_files_that_are_generated_as_a_whole_are_marked() -> None:
    """They are marked in their first lines."""
    for path, _ in OUTPUTS:
        name = path.relative_to(ROOT).as_posix()
        head = path.read_text(encoding="utf-8", errors="replace")[:600].splitlines()[:2]
        if any(line.startswith(GENERATED_MARKS) for line in head):
            assert any(fnmatch(name, pattern) for pattern in marks()), name
