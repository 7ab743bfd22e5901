"""`tsc check --explain`: a mistake's longer explanation."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.base.spelling import nearest
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import Sentence
from tiniscript.diagnostics.codes import CODES
from tiniscript.diagnostics.rendering import explain, titles


def run(options: Namespace, language: str) -> int:
    if not options.code:
        for code, title in titles(language):
            print(Sentence(f"{code}  {title}"))
        return 0
    text = explain(options.code, language)
    if text is None:
        suggestion = nearest(options.code.upper(), list(CODES)) or ""
        raise CommandError(2, "no_code", found=options.code, near=suggestion)
    print(Sentence(text), end="" if text.endswith("\n") else "\n")
    return 0
