"""Every word of the language and of a kit, at every limit: all accept it as a program, or none.

Each stands in the deepest block of each kind and one deeper, in tasks, in a DEF and after an UNTIL,
and its arguments at and beyond their edges. The oracle decides what is correct and how a robot
behaves; the compiler, the machines, the formatter, the blocks, the robot's reader of text and the
sketch must agree. The words come from the table, so a missing one fails automatically.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.machines import Senses
from tests.machines.host import run_host
from tests.machines.python import run_python
from tests.oracle import interpreter
from tests.oracle.programs import WIDE_KIT
from tests.sketch.agreement import with_wide_kit
from tests.support.block_agreement import check_blocks
from tests.support.reader_agreement import check_bytes, check_program
from tests.support.sampling import sample_of
from tests.support.text_lines import check_line
from tests.support.vm_agreement import are_equivalent
from tiniscript import compile_text
from tiniscript.base.fixed_point import as_text
from tiniscript.base.limits import BLOCKS, CALLS, STACK_VALUES
from tiniscript.base.source import Source
from tiniscript.base.words import (
    ALIASES,
    BLOCK_ENDS,
    CONDITION,
    MOVES,
    UNIT_OF,
    VALUE,
    WORDS,
    Argument,
    Word,
)
from tiniscript.codegen.sketch.writing import missing_feature, sketch_of
from tiniscript.syntax.formatter import format_source

ROBOT = with_wide_kit()
KIT = ROBOT.kit
ORACLE_KIT = WIDE_KIT._replace(speed=KIT.speed, turn=KIT.turn)
SENSES = Senses({"DISTANCE": [50_000, 9_000]}, 3_000, 3_000)
UNTIL_CLAUSE = "UNTIL(DISTANCE < 10)"
LONG_NAME = "A" * 31


def check(text: str) -> bool:
    """All agree of a text; return whether it is a program."""
    try:
        want = interpreter.run(text, ORACLE_KIT, SENSES.readings, SENSES.max_ms, SENSES.max_steps)
    except interpreter.Mistake:
        want = None
    compilation = compile_text(text, KIT)
    assert compilation.is_right == (want is not None), (text, compilation.diagnostics)
    if want is None:
        check_bytes(text.encode(), KIT)
        return False
    for image in (compilation.image, compile_text(text, KIT, optimize=False).image):
        for run in (run_python, run_host):
            actual = run(image, KIT, SENSES)
            assert are_equivalent(want, actual), f"{text}\n{actual}not\n{want}"
    assert compile_text(format_source(Source(text)), KIT).image == compilation.image, text
    check_blocks(text, KIT)
    check_line(text, KIT)
    check_program(text.encode(), KIT, SENSES)
    program = compilation.program
    assert program is not None
    if missing_feature(program, KIT) is None:
        assert sketch_of(compilation.source, program, ROBOT, "en")
    return True


# -- where a word may stand ------------------------------------------------------------------------


def nest(head: str, end: str, times: int) -> str:
    return f"{head};" * times + "{}" + f";{end}" * times


def nested_defs(calls: int) -> str:
    """Return a word after so many calls."""
    defs = ["DEF D1;{};END_DEF", *(f"DEF D{k};D{k - 1};END_DEF" for k in range(2, calls + 1))]
    return ";".join([*defs, f"D{calls}"])


BLOCK_HEADS_AND_ENDS = [
    ("IF(TRUE)", "ENDIF"),
    ("IF(FALSE);ELSEIF(TRUE)", "ENDIF"),
    ("IF(FALSE);ELSE", "END_IF"),
    ("WHILE(TRUE)", "BREAK;END_WHILE"),
]


def frames() -> Iterator[str]:
    loops = [nest("LOOP(1)", "END_LOOP", times) for times in (*range(BLOCKS - 2, BLOCKS + 2),)]
    yield from ("{}", "SI|{}", "SB|{}", "PING|{}", "X = 1;{};SHOW(X)")
    for head, end in BLOCK_HEADS_AND_ENDS:
        yield from (nest(head, end, times) for times in (BLOCKS - 1, BLOCKS, BLOCKS + 1))
    yield from loops
    for task in ("TASK;{};END_TASK", "WHEN(DISTANCE < 10);{};END_WHEN"):
        yield from (task.format(frame) for frame in ("{}", *loops[:-1]))
        yield task.format("W(0.1)") + ";W(FOREVER) UNTIL(TIME > 0.05);{}"
    for depth in (1, BLOCKS - 2):  # all tasks together have as many blocks open as one
        busy = nest("LOOP(1)", "END_LOOP", depth).format("S")
        for rest in (BLOCKS - depth, BLOCKS - depth + 1):
            its = nest("LOOP(1)", "END_LOOP", rest)
            yield f"TASK;{its};END_TASK;{busy}"
            yield f"TASK;{busy};END_TASK;{its}"
    for frame in ("{}", *loops):
        yield f"DEF A;{frame};END_DEF;A"
    yield from (f"DEF A;{{}};END_DEF;{loop.format('A')}" for loop in loops)
    yield from map(nested_defs, (CALLS, CALLS + 1))
    yield from ("W(FOREVER) UNTIL(TRUE);{}", "F(2, 80) UNTIL(TIME > 0.1)\n{}")


# -- possible content ------------------------------------------------------------------------------


def uses_of(word: Word) -> list[str]:
    """Return instructions with a word. A KeyError: this test has to learn a role."""
    text = word.text
    if word.role.is_instruction:
        return calls_of(word)
    return {
        "setup": lambda: [text, f"{text}|S", f"PING|{text}", f"{text}|CHECK_CONNECTION"],
        "start": lambda: [text],
        "until": lambda: [
            f"{text} {UNTIL_CLAUSE}" for text in ("W(1)", "F(2, 80)", "S", "BEEP(1, 440)")
        ],
        "forever": lambda: [f"LOOP({text});{body};END_LOOP" for body in ("W(1)", "BREAK")],
        "block": lambda: [f"{header(text)};{BLOCK_ENDS[text]}"],
        "arm": lambda: [f"IF(FALSE);{word.example};SHOW(1);ENDIF"],
        "end": lambda: [f"{begin_of(text)};{text}"],
        "alias": lambda: [f"{begin_of(text)};{text}"],
        "break": lambda: [text, f"LOOP(2);IF(TRUE);{text};ENDIF;END_LOOP"],
        "value": lambda: [f"SHOW({text})", text],
        "operator": lambda: [f"SHOW(TRUE {text} (FALSE))", f"SHOW({text} TRUE)"],
        "function": lambda: [f"SHOW({word.example})", f"X = {word.example}"],
        "unit": lambda: [f"{move}(20 {text}, 60)" for move in MOVES],
        "later": lambda: [text, f"{text}(1)"],
    }[word.role.name]()


def calls_of(word: Word) -> list[str]:
    uses = [word.example, word.text]
    for distance in [f"20 {UNIT_OF[word.text]}"] if word.role.is_move else []:
        uses.append(f"{word.text}({distance}, 80)")
    if word.role.has_duration:
        forever = ", ".join(["FOREVER", *(argument.sample for argument in word.arguments[1:])])
        uses.append(f"{word.text}({forever})")
    return [*uses, *(f"{use} {UNTIL_CLAUSE}" for use in uses)]


def header(word: str) -> str:
    return f"DEF {LONG_NAME}" if word == "DEF" else WORDS[word].example


def begin_of(end: str) -> str:
    """Return the header of the block that ends so, in one of its spellings."""
    end_words = {ALIASES.get(end, end)}
    return header(next(begin_word for begin_word, its in BLOCK_ENDS.items() if its in end_words))


USES = [(name, use) for name, word in WORDS.items() for use in uses_of(word)]
USES += [
    (sensor.name, use) for sensor in KIT.sensors for use in (sensor.name, f"SHOW({sensor.name})")
]
USES += [
    (actuator.name, use)
    for actuator in KIT.actuators
    for use in (actuator.word.example, actuator.name)
]
PARTS = 24  # parts of which a commit tries one in each frame, another in the next


def test_every_word_works_in_every_context(request: pytest.FixtureRequest) -> None:
    first = sample_of(request.config, "words in frames", range(PARTS))
    programs = 0
    for number, frame in enumerate(frames()):
        for part in first:
            for _, use in USES[(part + number) % PARTS :: PARTS]:
                programs += check(frame.format(use))
    assert programs > 100


def test_every_word_is_a_program_somewhere() -> None:
    words = {name for name, use in USES if check(use)}
    later = {name for name, word in WORDS.items() if word.role.name == "later"}
    assert {name for name, _ in USES} - words == later


# -- arguments ------------------------------------------------------------------------------------


def deep(value: str, value_count: int) -> str:
    """Return a sum that keeps so many values on the stack."""
    return f"+({value}".join([value, *[""] * (value_count - 1)]) + ")" * (value_count - 1)


def edges(argument: Argument) -> Iterator[str]:
    """Yield allowed and forbidden values of an argument."""
    for value_count in range(STACK_VALUES - 2, STACK_VALUES + 2):
        for value in ("V", "1"):
            is_question = argument in (
                CONDITION,
                *WORDS["WHILE"].arguments,
                *WORDS["WHEN"].arguments,
            )
            yield f"0 < {deep(value, value_count - 1)}" if is_question else deep(value, value_count)
    for edge in (argument.low, argument.high):
        yield from (as_text(value) for value in (edge - 1, edge, edge + 1))
    yield from ("TRUE", "V", LONG_NAME, "DISTANCE", "TOUCH", "V / 0", "-V", "FOREVER", "", "V, V")


def program_around(word: Word) -> str:
    """Return a program around a call of a word."""
    name, end = word.text, BLOCK_ENDS.get(word.text)
    if word.role.name in ("until", "arm", "function"):
        return {"until": "F(2, 80) {}", "arm": "IF(FALSE);{};SHOW(1);ENDIF",
                "function": "SHOW({})"}[word.role.name]  # fmt: skip
    return f"{{}};BREAK;{end}" if name in ("LOOP", "WHILE") else f"{{}};{end}" if end else "{}"


WORDS_WITH_ARGUMENTS = [
    word for word in (*WORDS.values(), *(it.word for it in KIT.actuators)) if word.arguments
]


@pytest.mark.sampled("word", keep=8)
@pytest.mark.parametrize("word", WORDS_WITH_ARGUMENTS, ids=lambda word: word.text)
def test_every_argument_works_at_its_limits(word: Word) -> None:
    samples = [argument.sample for argument in word.arguments]
    answers = set()
    for place, argument in enumerate(word.arguments):
        for edge in edges(argument):
            value_count = ", ".join([*samples[:place], edge, *samples[place + 1 :]])
            call = program_around(word).format(f"{word.text}({value_count})")
            for text in (call, f"{call} {UNTIL_CLAUSE}") if word.role.is_instruction else (call,):
                answers.add(check(f"V = 1;{LONG_NAME} = 2;{text}"))
    assert answers == {True, False}


def test_variables_work_at_the_limits_of_arguments() -> None:
    answers = [check(f"V = 1;{LONG_NAME} = 2;X = {edge}") for edge in edges(VALUE)]
    assert {*answers} == {True, False}
