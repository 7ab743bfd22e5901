"""Reserved names of Windows: data written to such a file is lost.

`con.bin` is the console there and `aux.html` a serial port, in each folder; `sheet:1.html` is a
hidden part of the file `sheet`. Knows names, and can be asked on every system.
"""

from __future__ import annotations

import glob
import ntpath

DEVICE_NAMES = {"con", "prn", "aux", "nul", "conin$", "conout$"} | {
    f"{name}{number}" for name in ("com", "lpt") for number in "0123456789¹²³"
}
FORBIDDEN_CHARACTERS = set('<>"|?*') | {chr(code) for code in range(32)}


def has_no_file(path: str) -> bool:
    """Return whether Windows would make no file of this name, or one of another name."""
    path_without_drive = ntpath.splitdrive(path)[1].replace("/", "\\")
    parts = [part for part in path_without_drive.split("\\") if part not in ("", ".", "..")]
    return any(_is_impossible(part) for part in parts)


def is_device(path: str) -> bool:
    """Return whether Windows opens a device by this name: reading it would wait for a key, say."""
    parts = ntpath.splitdrive(path)[1].replace("/", "\\").split("\\")
    return _stem(parts[-1]) in DEVICE_NAMES


def matching_files(pattern: str) -> list[str]:
    """Return the names of the files that a pattern such as `*.ts` means, in order.

    No shell of Windows does this for the commands it starts.
    """
    if not set(pattern) & set("*?"):
        return []
    escaped_pattern = pattern.replace("[", "[[]")  # brackets are part of a name there
    return sorted(glob.glob(escaped_pattern))  # noqa: PTH207 - names stay as they were typed


def _stem(name: str) -> str:
    return name.split(".")[0].rstrip(" ").lower()


def _is_impossible(name: str) -> bool:
    return (
        _stem(name) in DEVICE_NAMES
        or ":" in name
        or name[-1] in " ."
        or bool(FORBIDDEN_CHARACTERS & set(name))
    )
