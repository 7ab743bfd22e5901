"""Pupils' programs, damaged."""

from __future__ import annotations

from functools import cache

from tests.pupils.corpus import check, mistake_count
from tests.support.casefile import ROOT, read


@cache
def programs() -> list[str]:
    """Return programs of the examples, and those of cases and documents."""
    texts = [path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("examples/**/*.ts"))]
    for page in sorted((*ROOT.glob("tests/cases/*.md"), *ROOT.glob("docs/*/lang*.md"))):
        texts += [case.parts["tiniscript"] for case in read(page) if "tiniscript" in case.parts]
    return [text for text in texts if len(text) < 600 and not mistake_count(check(text))]
