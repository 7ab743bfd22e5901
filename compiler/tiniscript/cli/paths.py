"""The one check of a command's output files; the table of options says which options name files.

No output may be a file that the same command reads, or another of its outputs, or a file that tsc
has not made: the check comes before anything is read, sent or written. It compares files, not
names: a link, another hard link, `./`, other capitals and `/dev/stdin` may be the same file. A
terminal or `/dev/null` may be read and written at once; the port of a robot may not. Files that tsc
has made are recognized by their content: the beginnings of images, lines, headers, pages, maps,
pictures, reports, rows and recordings.
"""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
from argparse import Namespace
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.source import PROGRAM_SUFFIXES
from tiniscript.bytecode.image import MAGIC
from tiniscript.cli.errors import CommandError, unwritable_error
from tiniscript.cli.texts import text
from tiniscript.cli.texts.options import OPTIONS

# Inputs by their name in `Namespace`: the sentence that describes the input.
READ_OPTIONS = {
    option.name: option.kind.reads for option in OPTIONS if option.kind and option.kind.reads
}
# Outputs: the name of the option, and the sentence for a file that cannot be written.
WRITE_OPTIONS = {
    option.name: (option.flags, option.kind.writes)
    for option in OPTIONS
    if option.kind and option.kind.writes
}


class NamedPath(NamedTuple):
    """A file that a command reads or writes; `dest` is the name of its option."""

    dest: str
    path: str
    label: str  # the option's name, or a description of the file


def check(options: Namespace, language: str) -> None:
    """Refuse impossible outputs before anything is done. Raises CommandError."""
    outputs = list(_output_paths(options))
    if not outputs:
        return
    identities = [_identity(output) for output in outputs]
    for number, (output, identity) in enumerate(zip(outputs, identities, strict=True)):
        for other_output, output_identity in zip(outputs[:number], identities, strict=False):
            if identity is not None and identity == output_identity:
                raise CommandError(
                    2,
                    "same_outputs",
                    option=other_output.label,
                    file=other_output.path,
                    second=output.label,
                    other=output.path,
                )
    for input_path in _input_paths(options, language):
        identity = _identity(input_path, includes_devices=input_path.dest in ("port", "ports"))
        for output, output_identity in zip(outputs, identities, strict=True):
            if output.dest == input_path.dest:
                continue  # it is written in place
            if input_path.dest in ("port", "ports"):
                output_identity = _identity(output, includes_devices=True)
            if identity is not None and identity == output_identity:
                raise CommandError(2, "over_input", option=output.label, file=output.path,
                                   what=input_path.label, other=input_path.path)  # fmt: skip
    for output in outputs:
        if getattr(options, output.dest) is not None and output.dest in WRITE_OPTIONS:
            _check_writable(output.path, WRITE_OPTIONS[output.dest][1], language)
        if (
            output.dest not in READ_OPTIONS and output.dest != "export"
        ):  # otherwise it is changed in place
            _check_not_foreign(output)  # and an existing file stays


def default_output(program: str) -> str:
    """Return the default path for the image of a program."""
    is_text = program.lower().endswith((".ts.txt", ".tini.txt"))
    name = program[: -len(".txt")] if is_text else program
    stem, _ = os.path.splitext(name)  # noqa: PTH122 - a Path would change the name
    return f"{stem}.bin"


def real_name(program: str) -> str:
    """Return the probable name of a program's file, if no file has this name.

    Editors of Windows add `.txt` to a name, and its folders do not show the end of one.
    """
    if os.path.exists(program):  # noqa: PTH110 - a name that no file can have gets no Path
        return program
    for candidate in (f"{program}.txt", *(program + end for end in PROGRAM_SUFFIXES)):
        if os.path.isfile(candidate):  # noqa: PTH113
            return candidate
    return program


def _output_paths(options: Namespace) -> Iterator[NamedPath]:
    values = vars(options)
    for dest, (label, _) in WRITE_OPTIONS.items():
        path = values.get(dest)
        if isinstance(path, str) and not (dest == "output" and path == "-"):
            yield NamedPath(dest, path, label)
    for program_name in sorted(set(values.get("programs") or ())):
        if values["fix"] and not values["diff"] and program_name != "-":
            yield NamedPath("programs", real_name(program_name), "tsc check --fix")
    program = values.get("program")
    if program is not None and program != "-":
        program = real_name(program)
        if options.verb == "compile" and options.output is None and not options.text:
            yield NamedPath("output", default_output(program), "-o")
        if options.verb == "fmt" and not options.check:
            yield NamedPath("program", program, "tsc fmt")


def _input_paths(options: Namespace, language: str) -> Iterator[NamedPath]:
    values = vars(options)
    for dest, key in READ_OPTIONS.items():
        value = values.get(dest)
        for path in value if isinstance(value, list) else [value]:
            if isinstance(path, str) and path != "-" and not _is_shipped(dest, path):
                name = real_name(path) if dest in ("program", "programs") else path
                yield NamedPath(dest, name, text(key, language))
    if "port" in values and values["port"] is None and not values.get("virtual"):
        from tiniscript.link import known_ports

        last_port = known_ports.remembered_ports().last_port
        if last_port is not None:
            yield NamedPath("port", last_port, text("path_port", language))
    with suppress(OSError, ValueError):  # the stream may be closed
        if stat.S_ISREG(os.fstat(0).st_mode):
            yield NamedPath("stdin", "/dev/stdin", text("path_stdin", language))


def _is_shipped(dest: str, name: str) -> bool:
    """Return whether a robot or a world of this name is shipped with tsc."""
    if dest == "robot":
        return name.lower() in robots.names()
    if dest == "world":
        from tiniscript.virtual import worlds

        return name.lower() in worlds.names()
    return False


def _identity(named_path: NamedPath, includes_devices: bool = False) -> tuple[object, ...] | None:
    """Return a key that is the same for all names of a file, or None for a device such as a tty.

    The key of a missing file is its folder and its name without regard to capitals, because its
    file system may ignore them.
    """
    try:
        stat_result = os.fstat(0) if named_path.dest == "stdin" else os.stat(named_path.path)  # noqa: PTH116
        is_device = stat.S_ISCHR(stat_result.st_mode)
        return (
            None if is_device and not includes_devices else (stat_result.st_dev, stat_result.st_ino)
        )
    except (FileNotFoundError, NotADirectoryError):
        folder, name = os.path.split(os.path.realpath(named_path.path))
        with suppress(OSError):
            stat_result = os.stat(folder)  # noqa: PTH116 - a name that no file can have gets no Path
            return stat_result.st_dev, stat_result.st_ino, _path_key(name)
    except (OSError, ValueError):  # opening it reports the reason
        pass
    return None


def _path_key(name: str) -> str:
    """Return a key that is the same for all names that a file system may treat as one."""
    if name.isascii():
        return name.lower()
    from unicodedata import normalize

    return normalize("NFC", normalize("NFC", name).casefold())


def _check_not_foreign(output: NamedPath) -> None:
    """Refuse to write over a file that tsc has not made. Raises CommandError."""
    # The file may not exist; if writing fails, that reports the reason.
    with suppress(OSError, ValueError):
        if is_foreign(Path(output.path)):
            raise CommandError(2, "over_foreign", option=output.label, file=output.path)


def _check_writable(path: str, error_key: str, language: str) -> None:
    """Report early that a file cannot be written. Raises CommandError."""
    error_number = 0
    if sys.platform == "win32":
        from tiniscript.cli.windows_names import has_no_file

        if path and has_no_file(path):
            raise unwritable_error(error_key, path, text("no_windows_name", language))
    try:
        try:
            stat_result = os.stat(path)  # noqa: PTH116 - a name that no file can have gets no Path
            if stat.S_ISDIR(stat_result.st_mode):
                error_number = errno.EISDIR
            elif not os.access(path, os.W_OK):
                error_number = errno.EACCES
            is_replaced = stat.S_ISREG(stat_result.st_mode) and not error_key.endswith("--csv")
        except FileNotFoundError:
            is_replaced = True
        folder = os.path.dirname(os.path.realpath(path))  # noqa: PTH120
        if is_replaced and not error_number:
            os.stat(folder)  # noqa: PTH116
            if sys.platform != "win32" and not os.access(folder, os.W_OK | os.X_OK):
                error_number = errno.EACCES
    except (OSError, ValueError) as error:
        raise unwritable_error(error_key, path, error) from None
    if error_number or not path:
        raise unwritable_error(error_key, path or "''", os.strerror(error_number or errno.ENOENT))


HEAD_BYTES = 4096  # bytes at the start of a file that identify it
HEADER = b"// Generated by "
ROWS_HEADER = b"ms,event,value,name\n"
CLASS_ROWS_HEADER = b"robot,id,ms,event,value,name\n"
_OLDER_ROWS_HEADERS = (b"ms,event,value\n", b"robot,id,ms,event,value\n")
RECORDING = b'{"tiniscript_run":'
OLDER_RECORDING = b'{"tiniscript_recording":'
GENERATOR = "TiniScript"  # the generator's name in a page or a picture
_PAGE_MARK = f'<meta name="generator" content="{GENERATOR}">'.encode()
_PICTURE_MARK = re.compile(rb"\x89PNG\r\n.*tEXtSoftware\0" + GENERATOR.encode(), re.DOTALL)
_CHECKED_LINE = re.compile(rb"[ -}]*~[0-9A-F]{8}\r?\n?")
_MAP_START = re.compile(rb'\{"version": \d+, "name": "')


def is_recording(data: bytes) -> bool:
    """Return whether a file is a recorded run, even if another program has saved it."""
    is_utf16 = data.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    first_text = data[:200].decode("utf-16" if is_utf16 else "utf-8-sig", "replace").lstrip()
    return first_text.startswith((RECORDING.decode(), OLDER_RECORDING.decode()))


def is_foreign(path: Path) -> bool:
    """Return whether a regular file has a content that tsc does not write. Raises OSError,
    ValueError.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        return False
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    return bool(head) and not _is_ours(head)


def _is_ours(head: bytes) -> bool:
    is_image = head.startswith(MAGIC) and len(head) > len(MAGIC) and head[len(MAGIC)] < 0x20
    has_known_start = (
        head.startswith(
            (
                HEADER,
                ROWS_HEADER,
                CLASS_ROWS_HEADER,
                *_OLDER_ROWS_HEADERS,
                RECORDING,
                OLDER_RECORDING,
            )
        )
        or _PAGE_MARK in head
    )
    return is_image or has_known_start or _is_report(head) or _is_table(head) or any(
        pattern.match(head) is not None for pattern in (_PICTURE_MARK, _MAP_START)
    ) or _CHECKED_LINE.fullmatch(head) is not None  # fmt: skip


def _is_table(head: bytes) -> bool:
    if not head.startswith(BOM_UTF8):
        return False
    from tiniscript.cli import spreadsheet

    return head.startswith(spreadsheet.file_starts())


def _is_report(head: bytes) -> bool:
    if not head.startswith(GENERATOR.encode()):
        return False
    from tiniscript.doctor import report

    return report.is_ours(head)
