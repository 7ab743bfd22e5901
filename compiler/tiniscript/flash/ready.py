"""Firmware that is ready to be written: files, named after a title, the board and a digest.

The digest is of all that a firmware is made from, so that an old file is never taken for a new
one. A package may bring files (`tools/builds/firmware_files.py` makes them); others are built when
they are first wanted, and kept in the user's cache.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from tiniscript.base.files import cache_folder, replace
from tiniscript.robots.profile import Robot, language_number

FOLDER = Path(__file__).resolve().parent / "ready"
NOTICE_FILE = "NOTICE.txt"
MAX_FILES = 30  # files in the cache; the oldest go first
BREAKPOINTS = "breakpoints"  # part of a title
MAX_NAME_CHARACTERS = 24  # most characters of a title in a file's name
IMAGE_OFFSETS = {"esp32dev": 0x1000, "esp32c3": 0}  # offset of the image in each board's flash
IMAGE_MAGIC = b"\xe9"  # the first byte of an image
DATA_RECORD, END_RECORD = "00", "01"  # record types in a HEX file


class ReadyFile(NamedTuple):
    """A firmware: an Intel HEX file, or the content of an ESP32's flash."""

    title: str
    board: str
    digest: str
    path: Path

    @property
    def flash_bytes(self) -> int:
        """Return the number of bytes of flash that it uses."""
        rows = self.path.read_text(encoding="ascii").splitlines()
        return sum(int(row[1:3], 16) for row in rows if row[7:9] == DATA_RECORD)


def firmware_cache() -> Path:
    """Return the user's folder for built firmware."""
    return cache_folder() / "firmware"


def title_of(robot: Robot, has_breakpoints: bool = False) -> str:
    """Return a robot's name, and the language of its answers if that is not English.

    A firmware without answers in a language is the English one; one with breakpoints, which has no
    answers, has a title of its own.
    """
    if has_breakpoints:
        return f"{robot.name}_{BREAKPOINTS}"
    language = robot.board.language
    return f"{robot.name}_{language}" if language_number(language) else robot.name


def file_name_of(title: str, board: str, digest: str) -> str:
    safe_title = "".join(letter if letter.isalnum() else "_" for letter in title)
    return f"{safe_title[:MAX_NAME_CHARACTERS]}-{board}-{digest}.hex"


def files(folder: Path = FOLDER) -> list[ReadyFile]:
    """Return the files of a folder, by title and board. An incomplete file is left out."""
    ready_files = []
    for path in sorted(folder.glob("*-*-*.hex")):
        if is_complete_hex(path):
            title, board, digest = path.stem.rsplit("-", 2)
            ready_files.append(ReadyFile(title, board, digest, path))
    return ready_files


def images(folder: Path = FOLDER) -> list[ReadyFile]:
    """Return the complete firmware of ESP32s from address 0, as `esptool merge_bin` makes it."""
    ready_files = []
    for path in sorted(folder.glob("*-*-*.bin")):
        title, board, digest = path.stem.rsplit("-", 2)
        image_offset = IMAGE_OFFSETS.get(board, 0)
        if (
            board in IMAGE_OFFSETS
            and path.read_bytes()[image_offset : image_offset + 1] == IMAGE_MAGIC
        ):
            ready_files.append(ReadyFile(title, board, digest, path))
    return ready_files


def find(title: str, board: str, digest: str) -> ReadyFile | None:
    """Return the file with this digest, from the package or the cache."""
    name = file_name_of(title, board, digest)
    for folder in (FOLDER, firmware_cache()):
        if is_complete_hex(folder / name):
            return ReadyFile(title, board, digest, folder / name)
    return None


def is_complete_hex(path: Path) -> bool:
    """Return whether all rows of a HEX file have valid checksums and the last is an end record."""
    try:
        rows = path.read_text(encoding="ascii").split()
        checksums = [sum(bytes.fromhex(row[1:])) % 256 for row in rows if row[0] == ":"]
    except (OSError, ValueError):
        return False
    return bool(rows) and rows[-1][7:9] == END_RECORD and checksums == [0] * len(rows)


def store(title: str, board: str, digest: str, data: bytes) -> ReadyFile:
    """Put a firmware into the cache atomically. Raises OSError."""
    folder = firmware_cache()
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / file_name_of(title, board, digest)
    replace(path, data)
    cached_files = sorted(folder.glob("*.hex"), key=lambda path: path.stat().st_mtime_ns)
    for old_file in cached_files[:-MAX_FILES]:
        if old_file != path:
            old_file.unlink(missing_ok=True)
    return ReadyFile(title, board, digest, path)
