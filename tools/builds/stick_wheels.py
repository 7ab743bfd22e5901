"""The wheels on a USB stick: the packages for `tsc`, for other systems and Python versions.

pip resolves for each target by itself. It evaluates markers such as `sys_platform == 'win32'` for
the computer that it runs on, so it runs here with the environment of the target.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

from tools import CannotMake

PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14", "3.15")
# Packages of which PyPI has only the source; those with a True have parts in C, and do without.
SOURCES = {"cobs": True, "platformio": False}
PURE_TAG = "py3-none-any"
OLDEST_ZIP_TIME = (1980, 1, 1, 0, 0, 0)  # the earliest time of a ZIP file

_PIP = """\
import json, sys
environment = json.loads(sys.argv.pop(1))
from pip._vendor.packaging import markers
found = markers.default_environment
markers.default_environment = lambda: {**found(), **environment}
from pip._internal.cli.main import main
sys.exit(main())
"""


class System(NamedTuple):
    """A kind of computer: the tags of its wheels, and its values for markers."""

    title: str
    tags: tuple[str, ...]
    os_name: str
    sys_platform: str
    platform_system: str
    platform_machine: str

    def markers(self, python: str) -> dict[str, str]:
        return {
            "os_name": self.os_name, "sys_platform": self.sys_platform,
            "platform_system": self.platform_system, "platform_machine": self.platform_machine,
            "platform_release": "", "platform_version": "", "python_version": python,
            "python_full_version": f"{python}.0", "implementation_version": f"{python}.0",
            "implementation_name": "cpython", "platform_python_implementation": "CPython",
        }  # fmt: skip


# Includes the former names of the last ones: pip accepts them for other systems, and otherwise only
# wheels of pure Python, such as that of wasmtime without its library.
_GLIBC = tuple(f"manylinux_2_{minor}_x86_64" for minor in range(31, 4, -1))
_OLD_GLIBC = tuple(f"manylinux{name}_x86_64" for name in ("2014", "2010", "1"))
SYSTEMS = {
    "windows": System("Windows", ("win_amd64",), "nt", "win32", "Windows", "AMD64"),
    "mac-apple": System("macOS (M1 or newer)", ("macosx_13_0_arm64",),
                        "posix", "darwin", "Darwin", "arm64"),
    "mac-intel": System("macOS (Intel)", ("macosx_13_0_x86_64",),
                        "posix", "darwin", "Darwin", "x86_64"),
    "linux": System("Linux", (*_GLIBC, *_OLD_GLIBC, "linux_x86_64"),
                    "posix", "linux", "Linux", "x86_64"),
}  # fmt: skip


def make_source_wheels(folder: Path) -> None:
    """Put wheels of Python alone into a folder, for packages that PyPI has only as source."""
    for name, has_parts_in_c in SOURCES.items():
        with tempfile.TemporaryDirectory() as wheel_folder:
            _pip(["wheel", "--quiet", "--no-deps", "--wheel-dir", wheel_folder, name], {})
            path = next(Path(wheel_folder).glob("*.whl"))
            if path.name.endswith(f"-{PURE_TAG}.whl"):
                shutil.copy(path, folder)
            elif has_parts_in_c:
                without_parts_in_c(path, folder)
            else:
                raise CannotMake(f"{path.name} is for this kind of computer alone.")


def without_parts_in_c(wheel: Path, folder: Path) -> Path:
    """Write a wheel for every system: the same without the parts compiled for this one.

    Its files have the times that they had, so that the same wheel gives the same bytes.
    """
    name, version = wheel.name.split("-")[:2]
    target = folder / f"{name}-{version}-{PURE_TAG}.whl"
    record_rows = []
    zip_time = OLDEST_ZIP_TIME
    with (
        zipfile.ZipFile(wheel) as old_zip,
        zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new_zip,
    ):
        record_name = next(
            file_name for file_name in old_zip.namelist() if file_name.endswith(".dist-info/RECORD")
        )
        for file_name in old_zip.namelist():
            if file_name == record_name or file_name.endswith((".so", ".pyd", ".dylib", "/")):
                continue
            data = old_zip.read(file_name)
            if file_name.endswith(".dist-info/WHEEL"):
                data = (
                    re.sub(rb"(?m)^Tag:.*\n", b"", data).rstrip() + f"\nTag: {PURE_TAG}\n".encode()
                )
                data = re.sub(rb"(?m)^Root-Is-Purelib:.*$", b"Root-Is-Purelib: true", data)
            zip_time = old_zip.getinfo(file_name).date_time
            new_zip.writestr(zipfile.ZipInfo(file_name, zip_time), data, zipfile.ZIP_DEFLATED)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record_rows.append(f"{file_name},sha256={digest},{len(data)}\n")
        record_text = "".join([*record_rows, f"{record_name},,\n"])
        new_zip.writestr(zipfile.ZipInfo(record_name, zip_time), record_text, zipfile.ZIP_DEFLATED)
    return target


def make_own_wheel(root: Path, folder: Path) -> Path:
    """Put the wheel of TiniScript itself into a folder; return it."""
    with tempfile.TemporaryDirectory() as wheel_folder:
        _pip(["wheel", "--quiet", "--no-deps", "--wheel-dir", wheel_folder, str(root)], {})
        path = next(Path(wheel_folder).glob("tiniscript-*.whl"))
        return Path(shutil.copy(path, folder))


def fetch(wheel: Path, folder: Path, system: System, python: str, extras: str) -> None:
    """Put the requirements of our wheel on a system into a folder. Raises CannotMake."""
    arguments = ["download", "--quiet", "--only-binary=:all:", "--dest", str(folder),
             "--find-links", str(folder), "--implementation", "cp",
             "--python-version", python]  # fmt: skip
    for tag in system.tags:
        arguments += ["--platform", tag]
    _pip([*arguments, f"{wheel}{extras}"], system.markers(python))


def _pip(arguments: list[str], marker_environment: dict[str, str]) -> None:
    command = [sys.executable, "-c", _PIP, json.dumps(marker_environment)]
    command += [arguments[0], "--disable-pip-version-check", *arguments[1:]]
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode:
        error_lines = [row for row in process.stderr.splitlines() if row.startswith("ERROR")]
        raise CannotMake((error_lines or process.stderr.splitlines() or ["pip says nothing."])[-1])
