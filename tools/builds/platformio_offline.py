"""Lets `pio` work without PlatformIO's registry, with packages of PyPI and Debian.

    python -m tools.builds.platformio_offline pio test -e native     runs a command in vm_arduino
    eval "$(python -m tools.builds.platformio_offline)"              for all commands of this shell

With a network, it is not needed: if the registry answers, or PlatformIO has its own platforms, it
changes nothing. Otherwise it makes stand-ins for two platforms in its own folder (below .venv),
from `tools/builds/platformio_stand_ins`, SCons from PyPI, and Debian's packages. Every build says
that it uses them. A version that does not match is refused.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from http.client import HTTPException
from pathlib import Path
from typing import Any

from tools import ROOT, CannotMake

PROJECT = ROOT / "vm_arduino"
STAND_INS = ROOT / "tools" / "builds" / "platformio_stand_ins"
STAND_IN_HOME = ROOT / ".venv" / "platformio_offline"
REGISTRY_SECONDS = 5.0

GXX = Path("/usr/bin/g++")
AVR_GCC = Path("/usr/bin/avr-gcc")
AVR_OBJCOPY = Path("/usr/bin/avr-objcopy")
AVR_LIBC = Path("/usr/lib/avr/include/avr/io.h")
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
DOCTEST = Path("/usr/include/doctest/doctest.h")
DEBIAN_PACKAGES = {
    GXX: "g++",
    AVR_GCC: "gcc-avr",
    AVR_OBJCOPY: "binutils-avr",
    AVR_LIBC: "avr-libc",
    ARDUINO: "arduino-core-avr",
    DOCTEST: "doctest-dev",
}
# Parameters of the platform atmelavr: name, chip, variant and macro, bytes of flash and RAM.
BOARDS = {
    "uno": ("Arduino Uno", "atmega328p", "standard", "UNO", 32_256, 2048),
    "nanoatmega328": ("Arduino Nano", "atmega328p", "eightanaloginputs", "NANO", 30_720, 2048),
    "nanoatmega328new": (
        "Arduino Nano (new bootloader)", "atmega328p", "eightanaloginputs", "NANO", 30_720, 2048,
    ),
    "megaatmega2560": ("Arduino Mega 2560", "atmega2560", "mega", "MEGA2560", 253_952, 8192),
}  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description="Let pio work where PlatformIO's registry cannot be reached."
    )
    parser.add_argument("--offline", action="store_true", help="do not ask the registry")
    parser.add_argument("--project", type=Path, default=PROJECT, help="where platformio.ini is")
    parser.add_argument("command", nargs=argparse.REMAINDER, help="what to run there")
    options = parser.parse_args(arguments)
    project: Path = options.project.resolve()
    try:
        settings = settings_for(project, options.offline)
    except CannotMake as error:
        print(f"platformio_offline: {error}", file=sys.stderr)
        return 2
    if options.command:
        path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
        environment = {**os.environ, **settings, "PATH": path}
        program = shutil.which(options.command[0], path=path) or options.command[0]
        return subprocess.call([program, *options.command[1:]], cwd=project, env=environment)
    for name, value in settings.items():
        print(f"export {name}={shlex.quote(value)}")
    return 0


def settings_for(project: Path, is_offline: bool) -> dict[str, str]:
    """Return the environment in which `pio` works, with everything made that it needs."""
    if importlib.util.find_spec("platformio") is None:
        raise CannotMake("PlatformIO is not installed. Try:  pip install platformio")
    if reason := needless_reason(project, is_offline):
        say(f"nothing to do: {reason}")
        return {}
    check_packages()
    check_versions(project)
    path = stand_ins()
    libraries = STAND_IN_HOME / "libraries"
    add_doctest(libraries / "native" / "doctest", project)
    say(f"the offline stand-ins in {path.relative_to(ROOT)} are used")
    return {
        "PLATFORMIO_CORE_DIR": str(path),
        "PLATFORMIO_LIBDEPS_DIR": str(libraries),
        "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no",
        "PLATFORMIO_DISABLE_UPGRADE_CHECK": "true",
    }


def say(text: str) -> None:
    print(f"platformio_offline: {text}", file=sys.stderr)


# -- whether there is anything to do ------------------------------------------------------------


def needless_reason(project: Path, is_offline: bool) -> str:
    """Return the reason why PlatformIO needs no stand-ins here, or ""."""
    platforms = Path(config_of(project).get("platformio", "platforms_dir")).resolve()
    if STAND_IN_HOME in platforms.parents:
        return ""  # the variables are set already
    own_platforms = sorted(path.parent.name for path in platforms.glob("*/platform.json"))
    if own_platforms:
        return f"PlatformIO has platforms of its own ({', '.join(own_platforms)})"
    if not is_offline and registry_answers():
        return "PlatformIO's registry answers"
    return ""


def config_of(project: Path) -> Any:
    from platformio.project.config import ProjectConfig

    path = project / "platformio.ini"
    if not path.is_file():
        raise CannotMake(f"there is no platformio.ini in {project}")
    return ProjectConfig.get_instance(str(path))


def registry_answers() -> bool:
    """Return whether a host of the registry describes one of its packages in time."""
    from platformio import __registry_mirror_hosts__ as hosts

    answers: list[str] = []

    def ask(host: str) -> None:
        url = f"https://api.{host}/v3/packages/platformio/platform/native"
        with (
            suppress(OSError, HTTPException, ValueError, KeyError, TypeError),
            urllib.request.urlopen(url, timeout=REGISTRY_SECONDS) as answer,
        ):
            if json.load(answer)["name"] == "native":
                answers.append(host)

    asking_threads = [threading.Thread(target=ask, args=(host,), daemon=True) for host in hosts]
    for thread in asking_threads:
        thread.start()
    end_s = time.monotonic() + REGISTRY_SECONDS  # looking up a host's address has no timeout
    while (
        not answers
        and any(thread.is_alive() for thread in asking_threads)
        and time.monotonic() < end_s
    ):
        time.sleep(0.02)
    return bool(answers)


# -- Debian's packages -----------------------------------------------------------------------------


def check_packages() -> None:
    """Say which packages of Debian are missing. Raises CannotMake."""
    names = " ".join(name for path, name in DEBIAN_PACKAGES.items() if not path.exists())
    if names:
        install = "sudo apt-get install --no-install-recommends"
        raise CannotMake(f"{names} missing. Try:  {install} {names}")


# -- mismatches ------------------------------------------------------------------------------------


def version_of(stand_in: Path) -> str:
    """Return the version of a platform that a stand-in stands for."""
    return str(json.loads((stand_in / "platform.json").read_text("utf-8"))["version"])


def check_versions(project: Path) -> None:
    """A stand-in stands for one version of its platform; a platform without one is not built."""
    from platformio.package.meta import PackageSpec
    from semantic_version import Version

    config = config_of(project)
    for environment in config.envs():
        platform = config.get(f"env:{environment}", "platform")
        required_package = PackageSpec(platform)
        stand_in = STAND_INS / str(required_package.name)
        if not stand_in.is_dir() or not required_package.requirements:
            continue
        version = version_of(stand_in)
        if Version(version) not in required_package.requirements:
            raise CannotMake(
                f"[env:{environment}] wants {platform}, the stand-in is one for {version}"
            )


def wanted_scons() -> tuple[str, str]:
    """Return the version of the package tool-scons that PlatformIO wants, and that of SCons."""
    from platformio.dependencies import get_core_dependencies

    requirement = get_core_dependencies()["tool-scons"]
    match = re.fullmatch(r"~(4\.(\d)(\d\d)(\d\d)\.\d+)", requirement)
    if not match:
        raise CannotMake(
            f"PlatformIO wants tool-scons {requirement}: which SCons that is, I cannot say"
        )
    return match[1], ".".join(str(int(part)) for part in match.groups()[1:])


def add_doctest(folder: Path, project: Path) -> None:
    """Put Debian's doctest where PlatformIO looks for the library that the tests want."""
    from platformio.package.meta import PackageSpec
    from semantic_version import Version

    text = DOCTEST.read_text(encoding="utf-8")
    parts = [re.search(rf"DOCTEST_VERSION_{part}\s+(\d+)", text) for part in VERSION_PARTS]
    version = ".".join(match[1] for match in parts if match)
    runner = (project / "test" / "test_custom_runner.py").read_text(encoding="utf-8")
    requirement = re.search(r"doctest/doctest@[^\"']+", runner)
    if requirement is None:
        raise CannotMake("vm_arduino/test/test_custom_runner.py names no doctest/doctest@")
    required_spec = PackageSpec(requirement[0])
    if Version(version) not in required_spec.requirements:
        raise CannotMake(
            f"doctest-dev is doctest {version}, the tests want {required_spec.requirements}"
        )
    if folder.exists():
        return

    def fill(new_folder: Path) -> None:
        (new_folder / "include").mkdir()
        shutil.copy(DOCTEST, new_folder / "include" / "doctest.h")
        describe(new_folder, "library.json", "library", "doctest", version, required_spec.owner)

    make(folder, fill)


VERSION_PARTS = ("MAJOR", "MINOR", "PATCH")


# -- results ---------------------------------------------------------------------------------------


def stand_ins() -> Path:
    """Return the folder with the stand-ins; its name changes with all that they are made of."""
    tool_version, scons_version = wanted_scons()
    scons = STAND_IN_HOME / f"scons-{scons_version}"
    if not scons.exists():
        say(f"installing SCons {scons_version} from PyPI")
        make(scons, lambda new_folder: install_scons(scons_version, new_folder))
    gcc_version = query(AVR_GCC, "-dumpversion")
    arduino = re.search(r"^version=(\S+)", (ARDUINO / "platform.txt").read_text("utf-8"), re.M)
    arduino_version = arduino[1] if arduino else "0.0.0"
    key = hashlib.sha256(repr((tool_version, gcc_version, arduino_version)).encode())
    for path in sorted([Path(__file__), *STAND_INS.rglob("*.*")]):
        key.update(path.name.encode() + path.read_bytes())
    folder = STAND_IN_HOME / f"core-{key.hexdigest()[:12]}"

    def fill(new_folder: Path) -> None:
        for source in sorted(STAND_INS.iterdir()):
            platform = shutil.copytree(source, new_folder / "platforms" / source.name)
            describe(platform, "", "platform", source.name, version_of(source))
        add_boards(new_folder / "platforms" / "atmelavr" / "boards")
        package = new_folder / "packages" / "tool-scons"
        package.mkdir(parents=True)
        (package / "scons.py").write_text(
            "import sys\nfrom pathlib import Path\n\n"  # finds the folder even after it is moved
            f"sys.path.insert(0, str(Path(__file__).resolve().parents[3] / {scons.name!r}))\n"
            "from SCons.Script.Main import main\n\nmain()\n",
            encoding="utf-8",
        )
        describe(package, "package.json", "tool", package.name, tool_version)
        major, minor, patch = (int(part) for part in (gcc_version + ".0.0").split(".")[:3])
        package = new_folder / "packages" / "toolchain-atmelavr"
        (package / "bin").mkdir(parents=True)
        for program in AVR_GCC.parent.glob("avr-*"):
            (package / "bin" / program.name).symlink_to(program)
        version = f"1.{major}{minor:02}{patch:02}.0"
        describe(package, "package.json", "tool", package.name, version)
        package = new_folder / "packages" / "framework-arduino-avr"
        package.mkdir()
        for part in ("cores", "variants", "libraries"):
            (package / part).symlink_to(ARDUINO / part)
        describe(package, "package.json", "tool", package.name, arduino_version)

    if not folder.exists():
        make(folder, fill)
    return folder


def add_boards(folder: Path) -> None:
    """Write PlatformIO's description of each board."""
    folder.mkdir()
    for value, (name, chip, variant, macro, flash, ram) in BOARDS.items():
        build = {"mcu": chip, "f_cpu": "16000000L", "core": "arduino", "variant": variant,
                 "extra_flags": f"-DARDUINO_AVR_{macro}"}  # fmt: skip
        description = {"name": name, "vendor": "Arduino", "url": "https://docs.arduino.cc/hardware",
                       "frameworks": ["arduino"], "build": build,
                       "upload": {"maximum_size": flash, "maximum_ram_size": ram}}  # fmt: skip
        (folder / f"{value}.json").write_text(json.dumps(description), encoding="utf-8")


def install_scons(version: str, folder: Path) -> None:
    pip_command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    result = subprocess.run(
        [*pip_command, "--no-deps", "--target", str(folder), f"SCons=={version}"],
        stdout=sys.stderr,
        check=False,
    )
    if result.returncode != 0:
        raise CannotMake(f"pip could not install SCons {version}, the one that PlatformIO wants")


def query(program: Path, option: str) -> str:
    return subprocess.run(
        [program, option], capture_output=True, text=True, check=True
    ).stdout.strip()


def describe(
    folder: Path, manifest: str, kind: str, name: str, version: str, owner: str = "platformio"
) -> None:
    """Write the files that mark an installed package for PlatformIO: its manifest and `.piopm`."""
    if manifest:
        description = {"name": name, "version": version, "description": "An offline stand-in."}
        (folder / manifest).write_text(json.dumps(description), encoding="utf-8")
    spec = {"owner": owner, "id": None, "name": name, "requirements": None, "uri": None}
    piopm = {"type": kind, "name": name, "version": version, "spec": spec}
    (folder / ".piopm").write_text(json.dumps(piopm), encoding="utf-8")


def make(folder: Path, fill: Callable[[Path], None]) -> None:
    """Create a folder atomically."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
        new_folder = Path(scratch) / folder.name
        new_folder.mkdir()
        fill(new_folder)
        try:
            new_folder.rename(folder)
        except OSError:
            if not folder.exists():  # otherwise another process was faster
                raise


if __name__ == "__main__":
    sys.exit(main())
