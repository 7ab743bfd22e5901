"""`tsc help`: describes a command and its options, or finds the command for a purpose."""

from __future__ import annotations

from argparse import Namespace
from functools import partial

from tiniscript.base.languages import languages
from tiniscript.cli.errors import CommandError
from tiniscript.cli.help import full_help, help_of, list_commands, overview, show
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.texts.verbs import COMMANDS, FORMER_COMMANDS, command_words, verb_text
from tiniscript.cli.verbless import guess_verb, refuse, verbs_for


def run(options: Namespace, language: str) -> int:
    topic = " ".join(options.about)
    if not topic:
        show(overview, language)
    elif any(topic in verb_text("all", language).split() for language in languages()):
        show(full_help, language)
    elif command := next(
        (candidate for candidate in COMMANDS if command_words(candidate) == topic),
        FORMER_COMMANDS.get(topic),
    ):
        show(partial(help_of, command), language)
    else:
        matching_commands = [] if guess_verb(topic) else verbs_for(topic)
        if not matching_commands and " " in topic:
            raise CommandError(2, "none_does", found=printable_name(topic))
        if not matching_commands:
            refuse(topic, [], language)
        show(partial(list_commands, matching_commands), language)
    return 0
