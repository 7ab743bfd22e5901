"""`tsc help`: what a verb does, and which options it has; or which verb does something."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.base.languages import languages
from tiniscript.cli.errors import CommandError
from tiniscript.cli.help import show_all, show_first, show_found, show_verb
from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.verbs import VERBS, said
from tiniscript.cli.verbless import meant, refuse, verbs_for


def run(options: Namespace, language: str) -> int:
    about = " ".join(options.about)
    if not about:
        show_first(language)
    elif any(about in said("all", each).split() for each in languages()):
        show_all(language)
    elif about in VERBS:
        show_verb(about, language)
    else:
        found = [] if meant(about) else verbs_for(about)
        if not found and " " in about:
            raise CommandError(2, "none_does", found=shown(about))
        if not found:
            refuse(about)
        show_found(found, language)
    return 0
