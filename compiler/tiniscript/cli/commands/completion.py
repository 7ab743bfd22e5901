"""`tsc completion`: the script with which a shell completes commands on Tab."""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.cli.completion import SCRIPTS


def run(options: Namespace, language: str) -> int:
    sys.stdout.write(SCRIPTS[options.shell](language))
    return 0
