"""Makes the cases of `tsc doctor --conform` in seconds: git keeps none, a release has them.

    python -m tools.builds.conformance [FOLDER]

writes `machine.json` and `link.json` into the clone's package, or into the folder of another
installation, which `tsc doctor --conform` names if it has none. It has the same requirements as
`tsc`.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from tools import ROOT
from tools.generate.link_kit import link_kit
from tools.generate.machine_kit import machine_kit

FOLDER = ROOT / "compiler" / "tiniscript" / "conformance"
FILES: dict[str, Callable[[str], str]] = {"machine.json": machine_kit, "link.json": link_kit}
COMMAND = "python -m tools.builds.conformance"


def text_of(name: str) -> str:
    """Return the content of a file of cases."""
    return FILES[name](COMMAND)


def write(target: Path, text: str) -> None:
    """Write the file as a whole, so that no reader sees a part. Raises OSError."""
    temporary_path = target.with_name(f"{target.name}.{os.getpid()}")
    temporary_path.write_text(text, encoding="utf-8", newline="\n")
    temporary_path.replace(target)


def main(arguments: Sequence[str] | None = None) -> int:
    description, _, _ = (__doc__ or "").partition("\n\n")
    parser = argparse.ArgumentParser(prog=COMMAND, description=description)
    parser.add_argument("folder", type=Path, nargs="?", default=FOLDER,
                        help="tiniscript/conformance of another installation")  # fmt: skip
    folder: Path = parser.parse_args(arguments).folder
    try:
        for name in FILES:
            write(folder / name, text_of(name))
            print(folder / name)
    except OSError as error:
        print(f"{COMMAND}: {error.strerror or error}: {error.filename or folder}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
