"""`tsc set`: names the settings of a robot; each is a step of its own."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import text
from tiniscript.cli.texts.verbs import settings


def run(options: Namespace, language: str) -> int:
    *known_names, last_name = settings()
    settings_text = f"{', '.join(known_names)} {text('or', language)} {last_name}"
    raise CommandError(2, "set_what", known=settings_text)
