"""What `pyproject.toml` cannot say: a wheel brings the firmware's sources, and nothing stale."""

from __future__ import annotations

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
PROJECT = ROOT / "vm_arduino"
INSIDE = Path("tiniscript") / "flash" / "vm_arduino"  # where tsc firmware looks for them


def sources() -> list[Path]:
    """Return what a build of the firmware needs; `own.h` is the robot of whoever has made it."""
    folders = (PROJECT / "src", PROJECT / "extras" / "near")
    files = (path for folder in folders for path in sorted(folder.rglob("*")))
    found = [PROJECT / "platformio.ini", PROJECT / "partitions.csv", *files]
    return [
        path for path in found if path.is_file() and path.suffix != ".pyc" and path.name != "own.h"
    ]


class Build(build_py):
    """Fills a folder that is empty: files that are no longer in the repository stay out."""

    def run(self) -> None:
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()
        if not self.editable_mode:
            for path, target in self._copies().items():
                target.parent.mkdir(parents=True, exist_ok=True)
                self.copy_file(str(path), str(target))

    def _copies(self) -> dict[Path, Path]:
        inside = Path(self.build_lib) / INSIDE
        return {path: inside / path.relative_to(PROJECT) for path in sources()}

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        outputs: list[str] = super().get_outputs(include_bytecode)
        if self.editable_mode:
            return outputs
        return [*outputs, *map(str, self._copies().values())]


setup(cmdclass={"build_py": Build})
