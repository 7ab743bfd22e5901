"""The journal of a shared program: a file with a snapshot, and below it all that was decided since.

A row is in the file, for power cuts too, before anybody hears of it. If the disk is full, the
lesson continues, and the journal starts again as soon as there is room. A row cut off by a crash
was never announced, so it is removed.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from functools import partial
from pathlib import Path

from tiniscript.base.files import read_limited, replace
from tiniscript.together.form import Refused
from tiniscript.together.ordering import SharedProgram, program_of
from tiniscript.together.tree import Json, Tree

MAX_BYTES = 4_000_000  # most bytes before a new file begins; the previous one is kept
OLD_ENDING = ".before"
_FLAGS = os.O_WRONLY | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


class Journal:
    """`path` of None: nothing is kept. `is_incomplete`: the file lacks something."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.is_incomplete = False
        self._is_damaged = False  # the file, while the previous one can be read
        self._file: int | None = None
        self._size = 0

    def begin(self, tree: Tree, epoch: str) -> SharedProgram:
        """Return the program that begins with a tree, and is kept from now on."""
        program = SharedProgram(tree, epoch)
        program.keep = partial(self._add, program)
        self._begin(program)
        return program

    def resume(self, epoch: str) -> SharedProgram | None:
        """Return the program that the file has, and go on with it; None if it has none. If a crash
        or a full disk prevented a new file, the previous one has it."""
        for path in (self.path, self._old_path) if self.path is not None else ():
            try:
                data = read_limited(path, 2 * MAX_BYTES)
                complete_rows = data[: data.rfind(b"\n") + 1]
                rows = [json.loads(row) for row in complete_rows.splitlines()]
                program = program_of(rows[0])
            except (OSError, ValueError, IndexError, RecursionError, Refused, AttributeError):
                continue
            program.replay([row for row in rows[1:] if isinstance(row, dict)])
            program.epoch = epoch
            program.keep = partial(self._add, program)
            if path == self.path:
                self._open()
                if self._file is not None and len(complete_rows) < len(data):
                    with suppress(OSError):
                        os.truncate(path, len(complete_rows))
                        self._size = len(complete_rows)
            else:
                self.is_incomplete = self._is_damaged = True
            return program
        return None

    def close(self) -> None:
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def forget(self) -> None:
        """Delete the file, and the previous one."""
        self.close()
        for path in (self.path, self._old_path) if self.path is not None else ():
            with suppress(OSError):
                path.unlink()

    @property
    def _old_path(self) -> Path:
        assert self.path is not None
        return self.path.with_name(self.path.name + OLD_ENDING)

    def _begin(self, program: SharedProgram) -> None:
        """Write the current program to a new file; the old one is kept next to it."""
        if self.path is None:
            return
        self.close()
        if not self._is_damaged:
            with suppress(OSError):
                self.path.replace(self._old_path)
        data = _line(program.snapshot())
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            replace(self.path, data, mode=0o600, is_lasting=True)
        except (OSError, ValueError):
            self.is_incomplete = True
            return
        self._is_damaged = False
        self._open()

    def _open(self) -> None:
        assert self.path is not None
        try:
            self._file = os.open(self.path, _FLAGS)
            self._size = os.fstat(self._file).st_size
            self.is_incomplete = False
        except OSError:
            self.is_incomplete = True

    def _add(self, program: SharedProgram, row: Json) -> None:
        if self.path is None:
            return
        if self.is_incomplete or self._size > MAX_BYTES:
            self._begin(program)
        if self._file is None:
            return
        data = _line(row)
        try:
            if os.write(self._file, data) < len(data):
                raise OSError
            os.fsync(self._file)
            self._size += len(data)
        except OSError:
            self.is_incomplete = True


def _line(row: Json) -> bytes:
    return json.dumps(row, separators=(",", ":")).encode() + b"\n"
