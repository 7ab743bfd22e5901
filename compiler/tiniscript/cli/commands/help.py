"""`tsc help`: what a command does, and which options it has; or which command does something."""

from __future__ import annotations

from argparse import Namespace
from functools import partial

from tiniscript.base.languages import languages
from tiniscript.cli.errors import CommandError
from tiniscript.cli.help import everything, listed, of, overview, show
from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.verbs import COMMANDS, WAS, said, typed
from tiniscript.cli.verbless import meant, refuse, verbs_for


def run(options: Namespace, language: str) -> int:
    about = " ".join(options.about)
    if not about:
        show(overview, language)
    elif any(about in said("all", language).split() for language in languages()):
        show(everything, language)
    elif command := next((item for item in COMMANDS if typed(item) == about), WAS.get(about)):
        show(partial(of, command), language)
    else:
        result = [] if meant(about) else verbs_for(about)
        if not result and " " in about:
            raise CommandError(2, "none_does", found=shown(about))
        if not result:
            refuse(about, [], language)
        show(partial(listed, result), language)
    return 0
