"""Breaks of the machine's assembly for the AVR: a small mistake in each line, one at a time.

Knows instructions of the AVR and the macros of `execute_avr.S`, and nothing of what the machine
does: a condition is the opposite one, a check is dropped, a register or a constant is another one,
an instruction is left out.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tools.mutation.mutants import MACHINE, Break

FILES = ("execute_avr.S", "execute_values_avr.S", "execute_statements_avr.S",
         "execute_control_avr.S")  # fmt: skip
OPPOSITES = [("breq", "brne"), ("brsh", "brlo"), ("brcs", "brcc"), ("brmi", "brpl"),
             ("brlt", "brge"), ("brtc", "brts"), ("brvs", "brvc"), ("sbrc", "sbrs"),
             ("sbic", "sbis"), ("add", "sub"), ("adc", "sbc"), ("dec", "inc"), ("set", "clt"),
             ("and", "or")]  # fmt: skip
OPPOSITE = dict(OPPOSITES) | {b: a for a, b in OPPOSITES}
# The macros that check something, and what they do beside that.
UNCHECKED = {
    "drop": "sbiw r28, 4",
    "pop_b": "ld b3, -Y $ ld b2, -Y $ ld b1, -Y $ ld b0, -Y",
    "push_a": "st Y+, a0 $ st Y+, a1 $ st Y+, a2 $ st Y+, a3",
    "let_z_be_variable": "lsl {0} $ lsl {0} $ movw r30, vars $ add r30, {0} $ adc r31, r1",
}
WITH_CONSTANT = {"ldi", "subi", "sbci", "cpi", "andi", "adiw", "sbiw", "ldd", "std"}
VALUE = re.compile(r"\b(a|b|count)([0-3])\b")
LINE = re.compile(r"^(?:\d+: +| +)(?P<what>[a-z_]\w*)(?: +(?P<with>[^;\n]*?))?[ ]*(?:;.*)?$")
# They only say where something is, or leave the machine's meaning to others.
NOTHING = {"push_value", "next"}


def assembly_breaks(sources: Path) -> list[Break]:
    """Return the breaks of a folder like `vm_arduino`."""
    found: list[Break] = []
    names: Counter[str] = Counter()
    for file in FILES:
        text = (sources / MACHINE / file).read_text(encoding="utf-8")
        label, start = "", 0
        for line in text.splitlines(keepends=True):
            end = start + len(line)
            if named := re.match(r"(?:\.macro )?([a-z_]\w+)(?=:| |$)", line):
                label = named[1]
            for kind, instead in _changes(line.rstrip("\n")):
                was = " ".join(line.partition(";")[0].split())
                becomes = " ".join(instead.split())
                name = f"{label}: {was} is {becomes or 'left out'}"
                names[name] += 1
                if names[name] > 1:
                    name += f" (no. {names[name]})"
                whole = text[:start] + instead + "\n" + text[end:]
                found.append(Break(kind, name, file, whole, was, becomes))
            start = end
    return found


def _changes(line: str) -> Iterator[tuple[str, str]]:
    """Yield what kind of break a line may have, and the line that is broken."""
    found = LINE.match(line)
    if not found or found["what"] in NOTHING or found["what"].startswith("tini"):
        return
    what, operands = found["what"], (found["with"] or "")
    before, after = line[: found.start("what")], operands
    mark = re.match(r"\d+:", before)
    gone = (
        f"{mark[0] if mark else ''}    nop"
        if what.startswith(("sbr", "sbi"))
        else (mark[0] if mark else "")
    )
    if what in UNCHECKED:
        yield "check", f"{before}{UNCHECKED[what].format(operands.split(',')[0])}"
        return
    if what in OPPOSITE:
        kind = "condition" if what.startswith(("br", "sbr", "sbi")) else "operation"
        yield kind, f"{before}{OPPOSITE[what]} {after}"
    if what.startswith("br"):
        yield "check", gone
        return
    if what in WITH_CONSTANT and (constant := re.search(r"(?<=, )(?!r?\d*$)[^,]+$|\d+$", operands)):
        more = f"{operands[: constant.start()]}({constant[0]}) + 1"
        if what in ("ldd", "std"):
            more = ""
        if more:
            yield "constant", f"{before}{what} {more}"
    if value := VALUE.search(operands):
        digits = 3 if value[1] == "count" else 4
        other = f"{value[1]}{(int(value[2]) + 1) % digits}"
        if what in (
            "ld",
            "ldd",
            "st",
            "std",
            "add",
            "adc",
            "sub",
            "sbc",
            "cp",
            "cpc",
            "subi",
            "sbci",
        ):
            yield (
                "register",
                f"{before}{what} {operands[: value.start()]}{other}{operands[value.end() :]}",
            )
    if what not in OPPOSITE and what not in ("ldi", "ret"):
        yield "omission", gone
