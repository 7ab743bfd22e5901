"""Machines with one fault each: modules of the machine in Python with something changed.

Each fault of `faults.txt` breaks a sentence of `bytecode_spec.md`, as a hasty reader might. A row
`#` names the fault, `=` the case that must notice it, and `@` the file of the package; then come
changes as `diff` writes them, with an `@` between two.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from tests.support.casefile import ROOT
from tiniscript.bytecode import verify
from tiniscript.vm.handlers import HANDLERS

TABLE = Path(__file__).with_name("faults.txt")
PACKAGE = ROOT / "compiler" / "tiniscript"
FAULT = re.compile(r"# (.*)\n= (.*)\n@ (.*)\n((?:[ +@-].*\n|\n(?=[ +@-]))+)")


class Fault(NamedTuple):
    says: str
    noticed_by: str  # the name of a case
    file: str
    changes: str


def faults() -> list[Fault]:
    text = TABLE.read_text(encoding="utf-8")
    faults = [Fault(*match.groups()) for match in FAULT.finditer(text)]
    assert len(faults) == text.count("\n# ") + 1, "a fault of another form"
    return faults


@contextmanager
def machine_with(fault: Fault) -> Iterator[dict[str, Any]]:
    """Yield the names of the module with its fault, with its handlers in force."""
    handlers = dict(HANDLERS)
    try:
        yield vars(_module_with(fault))
    finally:
        HANDLERS.update(handlers)


def _module_with(fault: Fault) -> ModuleType:
    """Return the module with its fault. Each change fits in one place."""
    source = (PACKAGE / fault.file).read_text(encoding="utf-8")
    for change in fault.changes.split("@\n"):
        rows = change.splitlines(keepends=True)
        old_text = "".join(row[1:] for row in rows if row[0] in " -")
        becomes = "".join(row[1:] for row in rows if row[0] in " +")
        assert f"\n{source}".count(f"\n{old_text}") == 1, (fault.says, old_text)
        source = f"\n{source}".replace(f"\n{old_text}", f"\n{becomes}")[1:]
    name = fault.file.removesuffix(".py").replace("/", ".")
    module = ModuleType(f"tiniscript.{name}")
    exec(compile(source, fault.says, "exec"), vars(module))
    if hasattr(module, "Refused"):
        # Otherwise no code would catch the module's own Refused.
        vars(module)["Refused"] = verify.Refused
    return module
