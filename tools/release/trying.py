"""Installs what was made as its users do, each in a fresh place, and drives the virtual robot.

Knows archives, pip, the stick's script and arduino-builder. A try returns a sentence about what was
seen, and raises TryFailed with what went wrong. What this computer lacks for one is NotTried.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import venv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from tools.release.packing import unpack

ARDUINO = (Path("/usr/share/arduino-builder"), Path("/usr/share/arduino/hardware"))  # Debian's
BOARDS = {"uno": "uno", "mega": "mega:cpu=atmega2560"}
CUT_OFF = ("unshare", "--map-root-user", "--net")  # a process without a network
LINE = "SI|F(2, 80)"
DROVE = re.compile(r"The virtual robot drove (\d+) cm in 2\.0 s and touched nothing\.")
EXAMPLES = 3  # of the library
LIMIT_S = 900
ROBOT_S = 20  # that a virtual robot has to answer


class TryFailed(Exception):
    """What was made does not work; says how that was seen."""


class NotTried(Exception):
    """This computer lacks what the try needs; says what."""


class Made(NamedTuple):
    """The files of a release, and a folder for tries."""

    parts: Path
    scratch: Path
    version: str
    meets: dict[str, str]  # "isa" and "link": versions that robots tell
    firmware: frozenset[str]  # how the names of its files begin: a robot's and its chip's

    def file(self, pattern: str) -> Path:
        found = sorted(self.parts.glob(pattern))
        if not found:
            raise TryFailed(f"there is no {pattern}")
        return found[0]


def try_wheel(made: Made) -> str:
    return _installed_by_pip(made, made.file("*.whl"), "wheel")


def try_sdist(made: Made) -> str:
    return _installed_by_pip(made, made.file("*.tar.gz"), "sdist")


def _installed_by_pip(made: Made, package: Path, name: str) -> str:
    folder = made.scratch / name
    venv.create(folder, with_pip=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    _run([programs / "python", "-m", "pip", "install", "--quiet", f"{package}[virtual]"], folder)
    seen = _drives(programs / "tsc", made, folder)
    return f"{seen}; {_tells(programs / 'tsc', made, folder)}"


def _tells(tsc: Path, made: Made, folder: Path) -> str:
    """Return the versions that the virtual robot tells in HELLO: those of docs/versions.md."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    robot = subprocess.Popen([tsc, "robot", "--listen", port], cwd=folder, env=_variables(folder),
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    ends = time.monotonic() + ROBOT_S
    try:
        while True:
            try:
                told = _run([tsc, "info", "--json", "--port", f"socket://127.0.0.1:{port}"], folder,
                            has_notes=False)  # fmt: skip
                break
            except TryFailed:
                if time.monotonic() > ends:
                    raise
                time.sleep(0.2)
    finally:
        robot.terminate()
        robot.wait()
    found = json.loads(told)
    for name, version in made.meets.items():
        if found[name] != version:
            raise TryFailed(f"HELLO says {name} {found[name]}, docs/versions.md {version}")
    return f"HELLO: bytecode {found['isa']}, link {found['link']}"


def try_stick(made: Made) -> str:
    """With the network off."""
    stick = unpack(made.file("tiniscript-stick-*.zip"), made.scratch)
    home = made.scratch / "home of Ana María"
    if shutil.which(CUT_OFF[0]) is None:
        raise NotTried(f"{CUT_OFF[0]} is not installed: the network cannot be off (Linux has it)")
    if subprocess.run([*CUT_OFF, "true"], capture_output=True).returncode:
        raise NotTried(f"{CUT_OFF[0]} may not switch the network off here")
    _run([*CUT_OFF, "sh", stick / "start.sh", home], made.scratch)
    seen = _drives(home / "tsc" / "bin" / "tsc", made, made.scratch)
    return f"network off; {seen}"


def _drives(tsc: Path, made: Made, folder: Path) -> str:
    """Return how far the virtual robot of an installation drives."""
    said = _run([tsc, "--version"], folder)
    if made.version not in said.split():
        raise TryFailed(f"tsc --version says {said.strip()}, not {made.version}")
    said = _run([tsc, "upload", "-e", LINE, "--virtual", "--for", "4", "--hurry", "20"], folder)
    drove = DROVE.search(said)
    if drove is None:
        raise TryFailed(f"the virtual robot did not drive: {said.strip()[-300:]}")
    return f"drove {drove.group(1)} cm"


def try_library(made: Made) -> str:
    """Every example is built as the Arduino IDE builds it, for an Uno and a Mega."""
    if not shutil.which("arduino-builder") or not all(path.is_dir() for path in ARDUINO):
        raise NotTried("arduino-builder is not installed (Debian: apt-get install arduino-builder)")
    libraries = made.scratch / "libraries"
    library = unpack(made.file("TiniScript-*.zip"), libraries)
    sketches = sorted((library / "examples").rglob("*.ino"))
    if len(sketches) < EXAMPLES:
        raise TryFailed(f"the library has {len(sketches)} examples")
    for board, name in BOARDS.items():
        for sketch in sketches:
            build = made.scratch / "sketches" / board / sketch.stem
            build.mkdir(parents=True)
            words = ["arduino-builder", "-compile", "-warnings", "all", "-tools", "/usr/bin"]
            for folder in ARDUINO:
                words += ["-hardware", str(folder)]
            words += ["-libraries", str(libraries), "-build-path", str(build),
                      "-prefs=compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__",
                      "-fqbn", f"arduino:avr:{name}", str(sketch)]  # fmt: skip
            _run(words, made.scratch)
            if not (build / f"{sketch.name}.hex").is_file():
                raise TryFailed(f"{sketch.name} gave no firmware for {board}")
    return f"{len(sketches)} examples built for {' and '.join(BOARDS)}"


def try_firmware(made: Made) -> str:
    """Every shipped robot has its file for every board, in both languages, and each is whole."""
    folder = unpack(made.file("tiniscript-firmware-*.zip"), made.scratch)
    files = sorted(folder.glob("*.hex"))
    for path in files:
        rows = path.read_text(encoding="ascii").splitlines()
        if not rows or rows[-1] != ":00000001FF":
            raise TryFailed(f"{path.name} is no whole HEX file")
    for needed in ("NOTICE.txt", "LGPL-2.1.txt"):
        if not (folder / needed).is_file():
            raise TryFailed(f"{needed} is not beside the firmware")
    for begins in sorted(made.firmware):
        if not any(path.name.startswith(begins) for path in files):
            raise TryFailed(f"there is no firmware {begins}")
    return f"{len(files)} files, whole, with their notices"


def try_site(made: Made) -> str:
    """Unpacked elsewhere every link leads somewhere, and nothing comes from another origin."""
    from tools.site import links

    folder = unpack(made.file("tiniscript-site-*.zip"), made.scratch)
    wrong = links.dead(folder)
    if wrong:
        raise TryFailed("\n".join(wrong[:5]))
    pages = len(list(folder.rglob("*.html")))
    studio = " with the studio" if (folder / "studio" / "index.html").is_file() else ""
    return f"{pages} pages{studio}, every link"


def try_page(made: Made) -> str:
    """Every file that the page's service worker wants is there, and so are the licences."""
    folder = unpack(made.file("tiniscript-studio-*.zip"), made.scratch)
    worker = (folder / "service_worker.js").read_text(encoding="utf-8")
    names = re.findall(r'"([^"]+)"', worker.split("const FILES = ")[1].split("\n")[0])
    lacks = [name for name in names if name != "./" and not (folder / name).is_file()]
    if lacks or len(names) < 10:
        raise TryFailed(f"the page lacks {', '.join(lacks) or 'its files'}")
    licences = (folder / "licences.txt").read_text(encoding="utf-8")
    for needed in ("blockly ", "pyodide ", "@codemirror/view ", "Python"):
        if needed not in licences:
            raise TryFailed(f"licences.txt does not name {needed.strip()}")
    return f"{len(names)} files, with licences"


# What is tried of each part.
TRIES: dict[str, Callable[[Made], str]] = {
    "firmware": try_firmware,
    "wheel": try_wheel,
    "sdist": try_sdist,
    "page": try_page,
    "library": try_library,
    "site": try_site,
    "stick": try_stick,
}


def _run(words: Sequence[str | Path], folder: Path, has_notes: bool = True) -> str:
    """Run a command of the release away from this clone; return all that it printed.

    Without `has_notes` only standard output is returned.
    """
    try:
        done = subprocess.run(
            [str(word) for word in words], cwd=folder, env=_variables(folder),
            capture_output=True, text=True, errors="replace", timeout=LIMIT_S,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as why:
        raise TryFailed(str(why)) from None
    said = done.stdout + done.stderr
    if done.returncode:
        name = " ".join(Path(str(word)).name for word in words[:3])
        raise TryFailed(f"{name}: exit code {done.returncode}: {said.strip()[-800:]}")
    return said if has_notes else done.stdout


def _variables(folder: Path) -> dict[str, str]:
    """Return the variables of a user who has none of ours."""
    variables = {name: value for name, value in os.environ.items()
                 if not name.startswith(("PYTHON", "VIRTUAL_ENV", "XDG_"))}  # fmt: skip
    variables |= {"HOME": str(folder), "LC_ALL": "C.UTF-8", "NO_COLOR": "1"}
    path = os.pathsep.join([str(Path(sys.base_prefix) / "bin"), variables.get("PATH", os.defpath)])
    return {**variables, "PATH": path}
