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


_EXECUTE = "_ZN10tiniscript7Machine7executeEh"

# Breaks that no test can notice, and why.
_NEEDLESS = {
    "no carry, where the tests' program has the machine in RAM": (
        f"{_EXECUTE}: sbci r25, hi8(-tini_variables_at) is left out",
        f"{_EXECUTE}: adc r29, r1 is sbc r29, r1",
        "let_y_be_empty: sbci r29, hi8(tini_variables_at - tini_stack_at) is left out",
        "let_z_be_counter: ldi r31, 0 is ldi r31, (0) + 1",  # 256 bytes further on nothing is
        "let_z_be_counter: sbci r31, hi8(tini_variables_at - tini_counters_at + 4) is left out",
        "let_z_be_reading: adc r31, r1 is sbc r31, r1",
        "let_z_be_call: adc r31, r1 is sbc r31, r1",
    ),
    "it looks whether memory has changed": (
        f"{_EXECUTE}: clr looped is left out",
        f"{_EXECUTE}: cpi r18, tini_stack_values + 1 is cpi r18, (tini_stack_values + 1) + 1",
        f"{_EXECUTE}: brsh 2f is left out",
        f"{_EXECUTE}: cpi r19, tini_counters + 1 is cpi r19, (tini_counters + 1) + 1",
        f"{_EXECUTE}: cpi r19, tini_counters + 1 is left out",
        f"{_EXECUTE}: brsh 2f is left out (no. 2)",
        f"{_EXECUTE}: 2: adiw r26, 1 is 2: adiw r26, (1) + 1",
        f"{_EXECUTE}: 2: adiw r26, 1 is 2:",
        f"{_EXECUTE}: rjmp bad_1 is left out",
    ),
    "where BAD_CODE is found is the machine's own affair": (
        "bad_jump: adiw r26, 1 is adiw r26, (1) + 1",
        "bad_jump: adiw r26, 1 is left out",
        "bad_jump: rjmp bad_1 is left out",
        "bad_2: sbiw r26, 1 is sbiw r26, (1) + 1",
        "bad_2: sbiw r26, 1 is nop",
        "bad_variable: rjmp bad_2 is left out",
        "bad_compare2: sbiw r26, 1 is sbiw r26, (1) + 1",
        "bad_compare2: sbiw r26, 1 is nop",
        "bad_set: rjmp bad_2 is left out",
        "bad_add: movw r26, at is left out",
    ),
    "a program does not go on after a fault": (
        "faulted: sbiw r26, 1 is sbiw r26, (1) + 1",
        "faulted: sbiw r26, 1 is nop",
    ),
    "who leaves with values has stored them": (
        "leave: std Y+0, a0 is left out",
        "leave: std Y+1, a1 is left out",
        "leave: std Y+2, a2 is left out",
        "leave: std Y+3, a3 is left out",
    ),
    "a counter has 24 bits": ("store_counter: std Z+3, r1 is left out",),
    "all but 0 is TRUE there": (
        "op_push_true: ldi r18, 1 is ldi r18, (1) + 1",
        "op_not: ldi a0, 1 is ldi a0, (1) + 1",
    ),
    "these bits are shifted out": (
        "op_push_var_short: andi r30, tini_shorts - 1 is left out",
        "op_set_var_short: andi r30, tini_shorts - 1 is left out",
    ),
    "of two equal values either is the smaller and the larger one": (
        "op_min: ldi r30, LESS is ldi r30, (LESS) + 1",
        "op_max: ldi r30, MORE is ldi r30, (MORE) + 1",
    ),
    "all but 0 goes on": ("op_until8: inc r18 is dec r18",),
    "it is quicker so: what is loaded is not used, who leaves comes back": (
        f"{_EXECUTE}: cpse looped, r1 is left out",
        "statement_end: brne 4f is left out",
    ),
    "TIME faults after 24 days, and where a tick ends is no part of the meaning": (
        "op_time: tst r18 is left out",
        "op_time: breq 1f is brne 1f",
        "op_time: breq 1f is left out",
    ),
    "where an instruction began says a fault alone": (
        "leave_behind_jump: movw r24, r26 is left out",
        "leave_behind_jump: sbiw r24, 1 is sbiw r24, (1) + 1 (no. 2)",
    ),
    "a value that was not sent is found on an empty stack too": (
        "op_show_yes_no: tst r18 is left out",
    ),
    "the chip of the tests has a program counter of two bytes": (
        "bad_caller: pop r0 is left out (no. 3)",
    ),
}
# What no test notices yet: how a call of `execute` ends early (the tests' program has no
# interrupts, and runs code in one piece), and checks of jumps that only code that changed would
# fail (what lies before and behind the code of the tests' program ends in BAD_CODE, too).
OPEN = frozenset(
    (
        "land: cp code_end, r26 is left out",
        "op_loop: tst a3 is left out (no. 2)",
        "op_again: sbic GPIOR0, tini_attention_bit is sbis GPIOR0, tini_attention_bit",
        "op_again: 1: clt is 1: set",
        "op_again: breq bad_back is left out",
        "jump_back: breq leave_behind_jump is brne leave_behind_jump",
        "jump_back: breq leave_behind_jump is left out",
        "jump_back: sbic GPIOR0, tini_attention_bit is sbis GPIOR0, tini_attention_bit",
        "jump_back: ldd r19, Z+tini_code_at+1 is left out",
        "jump_back: cp r26, r18 is left out",
        "jump_back: brlo bad_back is left out",
        "leave_behind_jump: sbiw r24, 1 is sbiw r24, (1) + 1",
        "leave_behind_jump: sbiw r24, 1 is nop",
        "leave_behind_jump: brtc 4f is brts 4f",
        "leave_behind_jump: brtc 4f is left out",
        "leave_behind_jump: sbiw r24, 1 is nop (no. 2)",
        "leave_behind_jump: 4: movw at, r24 is 4:",
        "op_return: brcs bad_back is left out",
        "let_z_be_call: add r30, r20 is sub r30, r20",
    )
)

NEEDLESS = {name: reason for reason, names in _NEEDLESS.items() for name in names}


def noticeable_on_avr(found: list[Break]) -> list[Break]:
    """Return the breaks without those that change nothing a test could see."""
    return [each for each in found if each.name not in NEEDLESS]


def gone_from_avr(found: list[Break]) -> list[str]:
    """Return the names that are listed as needless, and are no longer there."""
    return sorted({*NEEDLESS} - {each.name for each in found})


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
