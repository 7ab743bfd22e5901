"""Mutants that no test noticed once, and the test that notices each now.

`test_mutation.py` tries every one at each run: such a gap does not open again in silence. A row
whose code is gone goes with it.
"""

from __future__ import annotations

from typing import NamedTuple


class Known(NamedTuple):
    """In a file the only place with `was` becomes something else; `test` then fails."""

    missing: str
    file: str
    was: str
    becomes: str
    test: str


# fmt: off
KNOWN: tuple[Known, ...] = (
    Known("a refused program", "vm_arduino/src/firmware/program.cpp",
          "or to none\n    store.refuse();", "or to none\n",
          "tests/firmware/test_undo.py::test_a_robot_begins_with_the_newest_program_that_it_can_run"),
    Known("a stored trim", "vm_arduino/src/firmware/identity.cpp",
          "if (is_sound(found)) change_trim(found);", "change_trim(found);",
          "tests/firmware/test_other_versions.py::test_a_trim_that_other_firmware_has_kept_is_none"),
)
# fmt: on
