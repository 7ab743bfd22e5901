"""`tsc help`: what a verb does, and which options it has."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.help import show_all, show_verb
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.cli.verbless import refuse


def run(options: Namespace, language: str) -> int:
    if options.about is None:
        show_all(language)
        return 0
    if options.about not in VERBS:
        refuse(options.about)
    show_verb(options.about, language)
    return 0
