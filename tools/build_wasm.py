"""Makes `machine.wasm` from the C++ machine: run `python tools/build_wasm.py` after changing that.

`tsc run --machine cpp` runs it. Needs the compiler `ziglang` from PyPI, in the version that the
extra `test` pins: with it, the same sources give the same bytes wherever they are. `--check`
writes nothing, and says if the file is stale.
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

ROOT = Path(__file__).resolve().parent.parent
MODULE = ROOT / "compiler" / "tiniscript" / "machine.wasm"
SOURCES = "vm_arduino"
COMMAND = "python tools/build_wasm.py"

# No library is linked, so what the machine calls is in its own sources or in wasm itself.
FLAGS = (
    "-target", "wasm32-freestanding", "-mcpu=generic+bulk_memory+sign_ext", "-std=c++11", "-Oz",
    "-fno-exceptions", "-fno-rtti", "-fno-sanitize=all", "-fno-stack-protector", "-g0", "-nostdlib",
    "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror",
    "-Wl,--no-entry", "-Wl,--strip-all", "-Wl,-z,stack-size=16384",
)  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Make the C++ machine as a WebAssembly module.")
    parser.add_argument("--check", action="store_true", help="only say whether it is stale")
    only_check: bool = parser.parse_args(arguments).check
    if missing():
        sys.exit(missing())
    name = MODULE.relative_to(ROOT).as_posix()
    made = built(ROOT / SOURCES)
    if MODULE.exists() and MODULE.read_bytes() == made:
        return 0
    if only_check:
        print(f"{name} is stale. Run: {COMMAND}", file=sys.stderr)
        return 1
    MODULE.write_bytes(made)
    print(f"wrote {name}: {len(made)} bytes")
    return 0


def missing() -> str:
    """Return why the module cannot be made here, or nothing."""
    pin = re.search(r'"ziglang==([^"]+)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert pin, "pyproject.toml pins the compiler"
    try:
        found = version("ziglang")
    except PackageNotFoundError:
        found = "none"
    if found == pin[1]:
        return ""
    return f"ziglang {pin[1]} is needed, here is {found}. Run: pip install ziglang=={pin[1]}"


def built(sources: Path) -> bytes:
    """Return the module made from `sources`, a folder like `vm_arduino`.

    The compiler sees paths inside that folder alone, and keeps nothing from other builds.
    """
    files = [sources / "wasm" / "main.cpp", *sorted((sources / "src" / "vm").glob("*.cpp"))]
    with tempfile.TemporaryDirectory() as folder:
        module = Path(folder) / "machine.wasm"
        places = {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
        names = [path.relative_to(sources).as_posix() for path in files]
        done = subprocess.run(
            [sys.executable, "-m", "ziglang", "c++", *FLAGS, *names, "-o", str(module)],
            cwd=sources,
            env={**os.environ, **places},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            sys.exit(f"the compiler refuses the machine:\n{done.stderr[:4000]}")
        return module.read_bytes()


if __name__ == "__main__":
    sys.exit(main())
