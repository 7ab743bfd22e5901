"""No language is a special case in code: none is chosen by its code."""

from __future__ import annotations

import re

from tests.support.casefile import ROOT

SPECIAL = re.compile(r"""(?:==|===|!=) ?["'](?:es|en|pt)["']|["'](?:es|en|pt)["'] (?:==|===)""")


def test_no_code_asks_for_one_language() -> None:
    folders = ("compiler/tiniscript", "tools", "vm_arduino")
    found = {}
    for path in sorted(path for folder in folders for path in (ROOT / folder).rglob("*")):
        parts = path.relative_to(ROOT).parts
        if path.suffix not in (".py", ".js", ".cpp", ".h") or not path.is_file():
            continue
        if {"node_modules", "made", "page", "__pycache__", ".pio"} & set(parts):
            continue
        count = len(SPECIAL.findall(path.read_text(encoding="utf-8")))
        if count:
            found["/".join(parts)] = count
    assert found == {}
