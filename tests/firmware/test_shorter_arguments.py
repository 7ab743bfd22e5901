"""What functions hand over to each other in shorter assembly: objects in Y, and loads in front."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.firmware.test_shorter import NEAR, function, lines_of, shorter

OWN = "movw r28,r24; std Y+1,r22"  # a method that has its object in Y


def method(name: str, body: str, callers: int, call: str = "movw r24,r28; call {}") -> str:
    """Return a function and others that call it; what they do besides is not equal."""
    text = function(name, body, (28, 29))
    for at in range(callers):
        text += function(f"f{at}", f"ldd r22,Y+{at}; {call.format(name)}; std Y+{at},r24")
    return text


def test_a_method_finds_its_object_where_its_callers_have_it() -> None:
    found = shorter(method("m", f"{OWN}; ldi r24,1; ldi r25,0", 2))
    assert lines_of(found, "m") == ["std Y+1,r22", "ldi r24,1", "ldi r25,0", "ret"]
    for at in range(2):
        assert lines_of(found, f"f{at}")[:2] == [f"ldd r22,Y+{at}", "call m"]


@pytest.mark.parametrize(
    "body",
    [
        f"{OWN}; movw r28,r22; ldi r24,1; ldi r25,0",  # Y is something else later
        f"{OWN}; adiw r28,4; ldi r24,1; ldi r25,0",
        f"{OWN}; ld r22,Y+; ldi r24,1; ldi r25,0",
        f"{OWN}; ldi r24,1; ldi r25,0; call x; in r28,__SP_L__",
    ],
)
def test_a_method_that_uses_y_for_more_keeps_it(body: str) -> None:
    found = shorter(method("m", body, 2))
    assert lines_of(found, "m")[:3] == ["push r28", "push r29", "std Y+1,r22"]
    assert lines_of(found, "m")[-3:] == ["pop r29", "pop r28", "ret"]


@pytest.mark.parametrize(
    "rest", ["add r22,r24", "call g", "brne .L1; ldi r24,1; .L1:", "", "icall"]
)
def test_a_method_that_needs_its_object_elsewhere_moves_it_there(rest: str) -> None:
    found = shorter(method("m", f"{OWN}; {rest}", 2))
    assert "movw r24,r28" in lines_of(found, "m")
    assert "movw r24,r28" not in lines_of(found, "f0")


@pytest.mark.parametrize(
    "other",
    [
        function("h", "ldi r24,lo8(o); ldi r25,hi8(o); call m"),
        function("h", "movw r24,r28; inc r28; call m"),
        function("h", "movw r24,r28; adiw r24,2; call m"),
        function("h", "ldi r30,lo8(gs(m)); ldi r31,hi8(gs(m)); icall"),
        function("h", "movw r24,r28; .L7:; call m"),
        function("h", "movw r24,r28; sbrc r22,1; call m"),
        function("h", "sbrs r22,1; movw r24,r28; call m"),
        function("h", "movw r24,r28; jmp m"),
        "\t.global\tm\n",
    ],
)
def test_a_method_that_others_call_gets_its_object_from_all(other: str) -> None:
    found = shorter(method("m", f"{OWN}; ldi r24,1; ldi r25,0", 2) + other)
    assert "movw r28,r24" in lines_of(found, "m")
    assert found.count("movw r24,r28") >= 2 or "tiniscript_to0_m" in found


@pytest.mark.parametrize(
    "body",
    [
        "ldd r22,Y+2; movw r28,r24; ldi r24,1; ldi r25,0",  # of the caller's object
        "ldi r24,3; movw r28,r24; ldi r24,1; ldi r25,0",
        "ldi r22,0; .L1:; movw r28,r24; ldi r24,1; brne .L1",
        "ldi r24,1; ldi r25,0",
    ],
)
def test_a_function_that_is_no_such_method_stays(body: str) -> None:
    text = method("m", body, 1)
    assert shorter(text) == text


def test_a_method_whose_begin_changes_y_stays() -> None:
    saves = "ldi r26,0; ldi r27,0; ldi r30,lo8(gs(1f)); ldi r31,hi8(gs(1f))"
    rows = [*saves.split("; "), "jmp __prologue_saves__+((18 - 8) * 2)"]
    begin = "".join(f"\t{row}\n" for row in rows) + "1:\n"
    text = function("m", f"{OWN}; ldi r24,1; ldi r25,0") + function(
        "f", "movw r24,r28; call m; inc r24"
    )
    text = text.replace("m:\n", f"m:\n{begin}", 1)
    assert shorter(text) == text


def test_what_many_load_before_a_call_is_in_front_of_the_function() -> None:
    load = "ldi r24,lo8(s); ldi r25,hi8(s)"
    text = function("g", "inc r24")
    for at in range(3):
        text += function(f"f{at}", f"{load}; ldi r22,{at}; call g; sts c{at},r24")
    text += function("h", "movw r24,r22; call g; sts c,r24")
    found = shorter(text)
    assert lines_of(found, "f1") == ["ldi r22,1", "call tiniscript_to0_g", "sts c1,r24", "ret"]
    assert lines_of(found, "h")[:2] == ["movw r24,r22", "call g"]
    entry = found[found.index("tiniscript_to0_g:") :].split("\n")[:4]
    assert entry == ["tiniscript_to0_g:", "\tldi r24,lo8(s)", "\tldi r25,hi8(s)", "g:"]


def test_what_fewer_of_them_load_besides_is_in_front_of_that() -> None:
    text = function("g", "inc r24")
    for at in range(4):
        more = f"ldi r20,{at // 2}" if at < 2 else f"ldi r20,{at}"
        more = more.replace("r20,1", "r20,0")
        text += function(f"f{at}", f"ldi r24,5; {more}; ldi r22,{at}; call g; sts c{at},r24")
    found = shorter(text)
    entry = found[found.index("tiniscript_to1_g:") :].split("\n")[:5]
    assert entry == ["tiniscript_to1_g:", "\tldi r20,0", "tiniscript_to0_g:", "\tldi r24,5", "g:"]
    assert "call tiniscript_to1_g" in lines_of(found, "f0")
    assert "call tiniscript_to0_g" in lines_of(found, "f3")


@pytest.mark.parametrize(
    "before",
    [
        "ldi r24,5; add r22,r24; call g",  # is read in between
        "ldi r24,5; call x; call g",
        "ldi r24,5; .L{at}:; call g",
        "sbrc r22,1; ldi r24,5; call g",
        "ldi r24,5; sbrc r22,1; call g",
        "ldi r24,5; brne .L{at}; call g; .L{at}:",
        "mov r24,r20; ldi r20,{at}; call g",
        "movw r24,r30; ld r20,Z+; call g",
        "cli; ldi r24,5; out __SREG__,r18; call g",
    ],
)
def test_loads_that_may_not_move_stay(before: str) -> None:
    text = function("g", "inc r24")
    for at in range(3):
        text += function(
            f"f{at}", f"lds r22,a{at}; {before.replace('{at}', str(at))}; sts c{at},r24"
        )
    assert "tiniscript_to" not in shorter(text)


EFFECTS = (
    "import sys; sys.dont_write_bytecode = True; sys.path.insert(0, sys.argv[1]);"
    "import assembly, effects; name, _, operands = sys.argv[2].partition(' ');"
    "found = effects.effects(assembly.Instruction(0, name, operands));"
    "print(found and (sorted(found.written), sorted(found.read)))"
)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("add r2,r3", ([2], [2, 3])),
        ("eor r4,r4", ([4], [])),
        ("adc r24,__zero_reg__", ([24], [1, 24])),
        ("subi r24,lo8(-(x))", ([24], [24])),
        ("adiw r24,5", ([24, 25], [24, 25])),
        ("movw r24,r28", ([24, 25], [28, 29])),
        ("ld r24,X+", ([24, 26, 27], [26, 27])),
        ("ld r24,-Y", ([24, 28, 29], [28, 29])),
        ("ldd r24,Y+5", ([24], [28, 29])),
        ("st Z+,r3", ([30, 31], [3, 30, 31])),
        ("std Y+1,r5", ([], [5, 28, 29])),
        ("lds r7,x+1", ([7], [])),
        ("sts x,r7", ([], [7])),
        ("push r7", ([], [7])),
        ("cpse r7,r8", ([], [7, 8])),
        ("breq .L1", ([], [])),
        ("lpm", None),
        ("mul r2,r3", None),
        ("call x", None),
    ],
)
def test_effects_are_those_of_the_chip(
    instruction: str, expected: tuple[list[int], ...] | None
) -> None:
    done = subprocess.run(
        [sys.executable, "-c", EFFECTS, str(NEAR), instruction],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == str(expected)
