"""What makes the compiler's assembly shorter: what it changes, and what it leaves alone."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.machines.uno import needed
from tests.support.casefile import ROOT
from tests.support.platformio import firmware, shared

NEAR = ROOT / "vm_arduino" / "extras" / "near"

# Runs in a process of its own: the folder of a sketch is no package.
SHORTER = (
    "import sys; sys.dont_write_bytecode = True; sys.path.insert(0, sys.argv[1]);"
    "import shorter; text = sys.stdin.read();"
    "names = shorter.re.findall(r'@function\\n(\\w+):', text);"
    "addresses = {name: 2000 + int(sys.argv[2]) * at for at, name in enumerate(names)};"
    "print(shorter.shorter(text, addresses, sys.argv[3] == 'True'), end='')"
)


def shorter(assembly: str, apart: int = 40, wants_room: bool = False) -> str:
    """Return shorter assembly. Its functions lie so many bytes apart."""
    command = [sys.executable, "-c", SHORTER, str(NEAR), str(apart), str(wants_room)]
    done = subprocess.run(command, input=assembly, capture_output=True, text=True, check=True)
    return done.stdout


def function(name: str, body: str, kept: tuple[int, ...] = (), kind: str = "function") -> str:
    """Return a function as GCC writes it. Instructions of its body are between semicolons."""
    lines = [f"{name}:", *(f"\tpush r{each}" for each in kept), f"/* prologue: {kind} */"]
    lines += ["/* frame size = 0 */"]
    lines += [each if each.endswith(":") else f"\t{each}" for each in body.split("; ") if each]
    lines += ["/* epilogue start */", *(f"\tpop r{each}" for each in reversed(kept)), "\tret"]
    head = [f'\t.section\t.text.{name},"ax",@progbits', f"\t.type\t{name}, @function"]
    return "".join(f"{line}\n" for line in (*head, *lines, f"\t.size\t{name}, .-{name}"))


def lines_of(assembly: str, name: str) -> list[str]:
    """Return what is between the label of a function and its end, without comments."""
    text = assembly[assembly.index(f"\n{name}:\n") + len(name) + 3 :]
    text = text[: text.index("\t.size")]
    return [line.strip() for line in text.splitlines() if line and not line.startswith("/*")]


def test_functions_that_keep_the_same_registers_share_it() -> None:
    names = [f"f{number}" for number in range(6)]
    found = shorter("".join(function(name, f"call {name}_", (28, 29)) for name in names))
    for name in names:
        last = lines_of(found, name)[:3]
        assert last[0] == "call tiniscript_keep_0_r28", name
        assert last[1:] == [f"call {name}_", "jmp tiniscript_restore_0_r28"], name
    assert found.count("push r28") == found.count("pop r29") == 1
    keep = found[found.index("tiniscript_keep_0_r28:") :].split()[1:9]
    assert keep == ["pop", "r31", "pop", "r30", "push", "r29", "push", "r28"]


def test_registers_are_restored_in_the_opposite_order() -> None:
    kept = (15, 16, 17, 28, 29)
    found = shorter("".join(function(f"f{each}", f"call g{each}", kept) for each in range(4)))
    pushed = re.findall(r"push r(\d+)", found)
    popped = [each for each in re.findall(r"pop r(\d+)", found) if each not in ("30", "31")]
    assert len(pushed) == 5
    assert popped == pushed[::-1]


RESTORED = (
    "in r28,__SP_L__; in r29,__SP_H__; ldi r30, lo8({0}); "
    "jmp __epilogue_restores__ + ((18 - {0}) * 2)"
)


def restored(name: str, body: str, kept: tuple[int, ...]) -> str:
    """Return a function that pushes registers and restores them by libgcc."""
    text = function(name, body, kept)
    end = text.index("/* epilogue start */\n") + len("/* epilogue start */\n")
    rows = RESTORED.format(len(kept)).split("; ")
    return text[:end] + "".join(f"\t{row}\n" for row in rows) + text[text.index("\t.size") :]


def test_a_function_may_begin_and_end_differently() -> None:
    kept = (14, 15, 16, 17, 28, 29)
    found = shorter("".join(restored(f"f{each}", f"call g{each}", kept) for each in range(3)))
    for at in range(3):
        last = [f"call g{at}", "jmp tiniscript_restore_0_r14"]
        assert lines_of(found, f"f{at}")[:3] == ["call tiniscript_keep_0_r14", *last]
    assert "__epilogue_restores__" not in found


def test_a_function_whose_begin_keeps_other_registers_than_its_end_stays() -> None:
    text = "".join(restored(f"f{each}", f"call g{each}", (16, 17, 28, 29)) for each in range(4))
    text = text.replace("\tpush r16\n", "")
    assert shorter(text) == text


def test_a_function_keeps_more_registers_where_others_need_them() -> None:
    most, fewer = (14, 15, 16, 17, 28, 29), (15, 16, 17, 28, 29)
    text = "".join(function(f"f{each}", f"call g{each}", most) for each in range(3))
    found = shorter(text + function("h", "call i", fewer) + function("j", "call k", (14, 28, 29)))
    for name in ("h", "j"):
        assert lines_of(found, name)[0] == "call tiniscript_keep_0_r14", name
        assert "jmp tiniscript_restore_0_r14" in lines_of(found, name), name


def test_a_function_that_needs_far_fewer_registers_keeps_those() -> None:
    most = (*range(8, 18), 28, 29)
    text = "".join(function(f"f{each}", f"call g{each}", most) for each in range(3))
    found = shorter(text + function("h", "call i", (16, 17, 28, 29)))
    assert lines_of(found, "h")[:2] == ["push r16", "push r17"]
    assert "call tiniscript_keep_0_r8" in found


def test_what_an_interrupt_reaches_stays_as_it_is() -> None:
    names = [f"f{number}" for number in range(6)]
    body = "lds r24,a; lds r25,b; lds r22,c"
    text = "".join(function(name, body, (28, 29)) for name in names)
    text += function("__vector_18", "; ".join(f"call {name}" for name in names), (0,), "Signal")
    assert shorter(text) == text


def test_what_a_line_of_a_computer_waits_for_stays_as_it_is() -> None:
    name = "_ZN10tiniscript7Machine3actEhPKhPl"
    text = function(name, "lds r24,a; lds r25,b; lds r22,c; lds r24,a; lds r25,b; lds r22,c")
    assert shorter(text) == text
    assert shorter(text.replace("3act", "3set")) != text.replace("3act", "3set")


def test_the_main_loop_calls_parts_where_room_is_wanted() -> None:
    body = "lds r24,a; lds r25,b; lds r22,c; inc r24"
    text = function("main", body) + function("f", body)
    assert shorter(text) == text
    assert lines_of(shorter(text, wants_room=True), "main")[0] == "call tiniscript_part_0"


def test_a_condition_uses_a_jump_that_is_there() -> None:
    far = "; ".join(f"ldi r18,{number}" for number in range(200))
    body = f"tst r24; brne .+2; rjmp .L1; inc r24; rjmp .L1; .L2:; dec r24; {far}; .L1:"
    found = lines_of(shorter(function("f", body)), "f")
    label = found[3].rstrip(":")
    assert found[:3] == ["tst r24", f"breq {label}", "inc r24"]
    assert found[4] == "rjmp .L1"


def test_an_interrupt_leads_to_what_is_near_and_uses_no_second_jump() -> None:
    far = "; ".join(f"ldi r18,{number}" for number in range(200))
    body = "tst r24; brne .+2; rjmp .L1; inc r24; rjmp .L1"
    text = function("__vector_3", f"{body}; {far}; .L1:", (0,), "Signal")
    assert shorter(text) == text
    text = function("__vector_3", f"{body}; .L1:", (0,), "Signal")
    assert "breq .L1" in lines_of(shorter(text), "__vector_3")


def test_a_jump_that_another_condition_uses_stays() -> None:
    far = "; ".join(f"ldi r18,{number}" for number in range(200))
    body = "tst r24; brne .+2; rjmp .L1; inc r24; brlo .+2; rjmp .L1"
    body = f"{body}; dec r24; brne .+2; rjmp .L1; {far}; .L1:"
    found = lines_of(shorter(function("f", body)), "f")
    assert found[3] == "brlo .+2"
    assert found[4].rstrip(":") == found[1].removeprefix("breq ")
    assert found[5] == "rjmp .L1"


@pytest.mark.parametrize(
    ("condition", "opposite"), [("eq", "ne"), ("lo", "sh"), ("ge", "lt"), ("pl", "mi")]
)
def test_a_condition_leads_to_what_is_near(condition: str, opposite: str) -> None:
    for name, other in ((condition, opposite), (opposite, condition)):
        body = f"tst r24; br{name} .+2; rjmp .L1; inc r24; .L1:"
        found = lines_of(shorter(function("f", body)), "f")
        assert found[:3] == ["tst r24", f"br{other} .L1", "inc r24"]


@pytest.mark.parametrize("before", ["cpse r24,r25", "sbrc r24,1", "breq .+2"])
def test_a_jump_that_may_be_skipped_stays(before: str) -> None:
    text = function("f", f"{before}; brne .+2; rjmp .L1; inc r24; .L1:")
    assert shorter(text) == text


def test_a_jump_that_is_too_far_stays() -> None:
    far = "; ".join(f"ldi r18,{number}" for number in range(70))
    text = function("f", f"tst r24; brne .+2; rjmp .L1; {far}; .L1:")
    assert shorter(text) == text


def test_equal_ends_are_there_once() -> None:
    end = "st Y,r24; std Y+1,r25; std Y+2,r22"
    found = shorter(function("f", f"inc r24; {end}") + function("g", f"dec r24; {end}"))
    assert found.count("std Y+2,r22") == 1
    assert lines_of(found, "g") == ["dec r24", "jmp .Lend4_f"]
    assert lines_of(found, "f")[:2] == ["inc r24", ".Lend4_f:"]


def test_an_end_that_may_be_skipped_in_part_stays() -> None:
    end = "st Y,r24; std Y+1,r25"
    text = function("f", f"sbrc r24,1; {end}") + function("g", f"sbrs r24,2; {end}")
    found = shorter(text)
    assert "jmp" not in lines_of(found, "g")[1]  # what is skipped there is `st`


def test_equal_parts_are_there_once() -> None:
    part = "lds r24,a; lds r25,b; add r24,r25"
    found = shorter("".join(function(f"f{at}", f"{part}; sts c{at},r24") for at in range(3)))
    assert found.count("lds r25,b") == 1
    for at in range(3):
        assert lines_of(found, f"f{at}")[:2] == ["call tiniscript_part_0", f"sts c{at},r24"]
    part_lines = found[found.index("tiniscript_part_0:") :].split("\n")[1:5]
    assert part_lines == ["\tlds r24,a", "\tlds r25,b", "\tadd r24,r25", "\tret"]


def test_parts_that_are_far_from_each_other_are_there_again() -> None:
    part = "lds r24,a; lds r25,b; add r24,r25"
    far = "; ".join(f"ldi r18,{number}" for number in range(200))
    text = "".join(function(f"f{at}", f"{part}; sts c{at},r24") for at in range(2))
    text += "".join(function(f"far{at}", far.replace("r18", f"r{at % 8 + 16}")) for at in range(4))
    text += "".join(function(f"g{at}", f"{part}; sts d{at},r24") for at in range(2))
    found = shorter(text, 4000)
    assert found.count("lds r25,b") == 2
    assert lines_of(found, "f0")[0] == lines_of(found, "f1")[0]
    assert lines_of(found, "g0")[0] == lines_of(found, "g1")[0] != lines_of(found, "f0")[0]


def test_a_part_that_ends_with_a_call_jumps_there() -> None:
    part = "movw r24,r28; ldi r22,1; ldi r23,2; call g"
    found = shorter("".join(function(f"f{at}", f"{part}; sts c{at},r24") for at in range(4)))
    assert found.count("jmp g") == 1
    assert "call g" not in found


def test_a_part_that_ends_with_a_call_that_may_be_skipped_goes_on_behind_it() -> None:
    part = "lds r24,a; lds r25,b; sbrc r24,1; call g"
    found = shorter("".join(function(f"f{at}", f"{part}; sts c{at},r24") for at in range(5)))
    assert "jmp g" not in found
    assert "call tiniscript_part_0" in found


@pytest.mark.parametrize(
    "part",
    [
        "lds r24,a; .L{at}:; lds r25,b",  # something leads into it
        "sbrc r24,{at}; lds r24,a; mov r24,r25",  # the first one may be skipped
        "push r24; pop r24; push r25; pop r25",
        "cli; lds r24,a; lds r25,a; lds r22,a; out __SREG__,r18",  # interrupts are off
        "/* #APP; lds r24,a; lds r25,a; lds r22,a; /* #NOAPP",
    ],
)
def test_parts_that_may_not_move_stay(part: str) -> None:
    part = part.replace("/* #", "\n/* #")
    text = "".join(
        function(f"f{at}", f"{part.replace('{at}', str(at))}; sts c{at},r24") for at in range(5)
    ).replace("\t\n", "")
    assert shorter(text) == text


def test_the_sketch_is_made_shorter(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    needed()
    elf = firmware("uno", tmp_path, shared(tmp_path_factory))
    said = subprocess.run(["avr-nm", elf], capture_output=True, text=True, check=True).stdout
    for name in (r"tiniscript_keep_\d_r\d+", r"tiniscript_part_0"):
        assert re.search(rf" t {name}$", said, re.MULTILINE), name
