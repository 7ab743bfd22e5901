"""Makes the `.wasm` of the package from the C++: `python -m tools.builds.wasm` after changes.

`tsc run --machine cpp` runs the machine, and `tsc robot` the whole robot: `robot_mega.wasm` and
`robot_esp32.wasm` have the sizes of one with a Mega and with an ESP32, `robot_discs.wasm` has no
reader of text. Needs the compiler `ziglang`
from PyPI, in the version that the extra `test` pins: with it, the same sources give the same bytes
wherever they are. `--check` writes nothing, and reports stale files.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from tools import ROOT

SOURCES = "vm_arduino"
COMMAND = "python -m tools.builds.wasm"

# A traced program is followed instruction by instruction.
COUNTING_FLAG = "-Dtiniscript_counts_instructions"

# No library is linked, so all functions that the machine calls are in its own sources or in wasm
# itself.
FLAGS = (
    "-target", "wasm32-freestanding", "-mcpu=generic+bulk_memory+sign_ext", "-std=c++11", "-Oz",
    "-fno-exceptions", "-fno-rtti", "-fno-sanitize=all", "-fno-stack-protector", "-g0", "-nostdlib",
    "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror",
    COUNTING_FLAG, "-Wl,--no-entry", "-Wl,--strip-all", "-Wl,-z,stack-size=16384",
)  # fmt: skip


class Module(NamedTuple):
    """The module to build, from the root of the repository: `files` and the `.cpp` of `folders`.

    A file of `files` that includes one of these stands for it.
    """

    path: str
    files: tuple[str, ...]
    folders: tuple[str, ...]
    flags: tuple[str, ...] = ()


MACHINE = Module("compiler/tiniscript/vm/machine.wasm", ("extras/wasm/main.cpp",), ("src/vm",))
ROBOT = Module(
    "compiler/tiniscript/virtual/robot.wasm",
    ("extras/wasm/robot.cpp", "extras/wasm/watched.cpp", "extras/wasm/watched_run.cpp"),
    ("src/firmware", "src/link", "src/store", "src/text", "src/vm"),
    ("-Dtiniscript_no_defs",),
)
ROBOT_ESP32 = ROBOT._replace(
    path="compiler/tiniscript/virtual/robot_esp32.wasm", flags=("-Dtiniscript_like_esp32",)
)
ROBOT_MEGA = ROBOT._replace(
    path="compiler/tiniscript/virtual/robot_mega.wasm",
    flags=("-Dtiniscript_like_mega",),
)
ROBOT_DISCS = ROBOT._replace(
    path="compiler/tiniscript/virtual/robot_discs.wasm", flags=("-Dtiniscript_without_text",)
)
MODULES = (MACHINE, ROBOT, ROBOT_MEGA, ROBOT_ESP32, ROBOT_DISCS)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Make the WebAssembly modules from the C++.")
    parser.add_argument("--check", action="store_true", help="only say whether one is stale")
    is_check_only: bool = parser.parse_args(arguments).check
    if unavailable_reason():
        sys.exit(unavailable_reason())
    exit_code = 0
    for module in MODULES:
        path = ROOT / module.path
        module_data = build(ROOT / SOURCES, module)
        if path.exists() and path.read_bytes() == module_data:
            continue
        if is_check_only:
            print(f"{module.path} is stale. Run: {COMMAND}", file=sys.stderr)
            exit_code = 1
        else:
            path.write_bytes(module_data)
            print(f"wrote {module.path}: {len(module_data)} bytes")
    return exit_code


def unavailable_reason() -> str:
    """Return the reason why the modules cannot be built here, or ""."""
    pin = re.search(r'"ziglang==([^"]+)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert pin, "pyproject.toml pins the compiler"
    try:
        installed_version = version("ziglang")
    except PackageNotFoundError:
        installed_version = "none"
    if installed_version == pin[1]:
        return ""
    return (
        f"ziglang {pin[1]} is needed, here is {installed_version}. "
        f"Run: pip install ziglang=={pin[1]}"
    )


def build(sources: Path, module: Module) -> bytes:
    """Return a module made from `sources`, a folder like `vm_arduino`.

    The compiler sees only paths inside that folder, and reuses nothing from other builds.
    """
    files = [sources / name for name in module.files]
    included_files = set(re.findall(r'#include "\.\./\.\./(\S+\.cpp)"', "".join(map(_text, files))))
    for folder in module.folders:
        paths = sorted((sources / folder).glob("*.cpp"))
        files += [
            path for path in paths if path.relative_to(sources).as_posix() not in included_files
        ]
    with tempfile.TemporaryDirectory() as folder:
        output_path = Path(folder) / Path(module.path).name
        cache_folders = {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
        names = [path.relative_to(sources).as_posix() for path in files]
        process = subprocess.run(
            [
                sys.executable,
                "-m",
                "ziglang",
                "c++",
                *FLAGS,
                *module.flags,
                *names,
                "-o",
                output_path,
            ],
            cwd=sources,
            env={**os.environ, **cache_folders},
            capture_output=True,
            text=True,
            check=False,
        )
        if process.returncode != 0:
            sys.exit(f"the compiler refuses {module.files[0]}:\n{process.stderr[:4000]}")
        return output_path.read_bytes()


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
