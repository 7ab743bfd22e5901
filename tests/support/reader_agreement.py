"""Texts, and how the readers of Python and C++ are compared."""

from __future__ import annotations

import random
import re
from functools import lru_cache

from tests.machines import Senses
from tests.machines.python import lists_of
from tests.machines.text_reader import LARGEST_ROOM, Answer, TextReader
from tests.oracle import programs
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Unreadable, decode
from tiniscript.base.words import WORDS
from tiniscript.bytecode.verify import verify
from tiniscript.codegen.text.line import plain_code
from tiniscript.codegen.text.memory import Reader as Model
from tiniscript.diagnostics.codes import LEVEL_VALUES
from tiniscript.library.compiling import analyze
from tiniscript.library.text_fitting import find_misfits
from tiniscript.robots.text_levels import CODE_BYTES, LEVELS, LONGEST_WORD, UNREAD_WORDS
from tiniscript.syntax.lexer import scan
from tiniscript.vm.runner import run

BACKSPACE = re.compile(rb"[A-Za-z_][\b\x7f]")
SENSOR_BYTES = LEVELS["mega"].sensor_bytes  # sensor bytes on this computer
TOKENS = (*WORDS, "X", "Y", "Z", "DISTANCE", "LIGHT_R", "LINE", "TOUCH", "LED", "GRIPPER", "GO",
          *"0123456789", "0.5", ".5", "5.", "12.7", "12.8", "-12.8", "-12.9", "32767", "32768",
          "-32768", "-32769", "32.767", "32.768", "-32.768", "255", "256", "2147483.647",
          "-2147483.648", "2147483.648", "100.4", "20001", "31", "0.0005", "0.9999", "9.9996",
          *"()(),;|=<>+-*/%", "<=", ">=", "<>", "\n", "//", " ", "\u00a0", "\u2013", "\ufeff",
          "20cm", ".5deg", "90°", "90º", "20 CM,", "90 DEG,", "5CMX", "5.cm", "5D",
          )  # fmt: skip


@lru_cache(maxsize=8)
def reader_of(kit: Kit, room: int = LARGEST_ROOM) -> TextReader:
    return TextReader(kit, room)


def is_right(data: bytes, kit: Kit) -> bool:
    """Return whether the compiler accepts these bytes."""
    try:
        return analyze(decode(data), kit).is_right  # diagnosing a wrong text takes longest
    except Unreadable:
        return False


# Messages of a robot about a correct text whose DEFs have yes-no values, or values for several
# tasks.
PROBLEMS_WITHOUT_VALUES = ("ONE_TASK", "WANTS_NUMBER", "WANTS_YES_NO", "KIND", "COMPARE", "FULL")
CONTROL_CHARACTER = re.compile(rb"[\x01-\x07\x0b\x0c\x0e-\x1f]")


def check_bytes(data: bytes, kit: Kit, room: int = LARGEST_ROOM) -> Answer | None:
    """Check that the reader agrees with the compiler on a text; None: it is too long for a
    robot.
    """
    answer = reader_of(kit, room).read(data)
    is_accepted = is_right(data, kit)
    if is_accepted and CONTROL_CHARACTER.search(data):  # on a wire such characters are noise
        assert not answer.is_program, f"{answer}\n{data!r}"
        return None
    if is_accepted and UNREAD_WORDS & {token.text for token in scan(decode(data)).tokens}:
        # a word with fixed values is right where `line_of` writes it out
        problems = (
            "FULL",
            "RESERVED",
            *(PROBLEMS_WITHOUT_VALUES if lacks_values(data, kit) else ()),
        )
        assert answer.problem in problems, f"{answer}\n{data!r}"
        return None
    if is_accepted and lacks_values(data, kit):
        assert answer.problem in PROBLEMS_WITHOUT_VALUES, f"{answer}\n{data!r}"
        return None
    if is_accepted:
        check_code(data, kit, answer, room)
    if answer.problem == "FULL":
        return None
    if answer.is_program != is_accepted:
        assert answer.is_program and takes_more(data, kit), f"{answer}\n{data!r}"
    if answer.is_program:
        verify(answer.code, len(kit.readings), len(kit.actuators))
    return answer


def lacks_values(data: bytes, kit: Kit) -> bool:
    """Return whether `--text-level` reports that no robot reads the values of its DEFs."""
    compilation = compile_text(decode(data), kit)
    assert compilation.program is not None
    diagnostics = find_misfits(compilation.source, compilation.program, kit, LEVELS["mega"])
    return any(diagnostic.code is LEVEL_VALUES for diagnostic in diagnostics)


def check_code(data: bytes, kit: Kit, answer: Answer, room: int) -> None:
    """The code of a correct text is the plain one, unless `text/memory.py` counts too much
    memory."""
    compilation = compile_text(decode(data), kit)
    assert compilation.program is not None
    plain_program = plain_code(compilation.program)
    model = Model(scan(compilation.source.text).tokens, kit, SENSOR_BYTES)
    model.program()
    is_accepted = (
        plain_program.short_length <= CODE_BYTES
        and model.most_bytes <= room
        and model.extra_bracket_span is None
    )
    if is_accepted and all(
        len(word) <= LONGEST_WORD for word in re.findall(r"\w+", compilation.source.text)
    ):
        assert answer.code == plain_program.code, f"{answer} {model.most_bytes}\n{data!r}"
    else:
        assert answer.problem == "FULL", f"{answer} {model.most_bytes}\n{data!r}"


def takes_more(data: bytes, kit: Kit) -> bool:
    """Return whether the reader accepts a text that the compiler refuses.

    It only passes over the bytes of a comment, and a backspace after a letter takes that back.
    """
    text = data.decode("utf-8", "replace")
    return ("\ufffd" in text and "//" in text) or (
        bool(BACKSPACE.search(data)) and is_right(apply_backspaces(data), kit)
    )


def apply_backspaces(data: bytes) -> bytes:
    """Return a text as it is when each backspace has taken back the letter of a word before it."""
    while BACKSPACE.search(data):
        data = BACKSPACE.sub(b"", data, count=1)
    return data


def check_program(data: bytes, kit: Kit, senses: Senses) -> None:
    """Check that a correct program behaves like the compiler's."""
    answer = check_bytes(data, kit)
    if answer is None:
        return
    assert answer.is_program, f"{answer}\n{data.decode()}"
    compilation = compile_text(decode(data), kit)
    assert compilation.program is not None and compilation.program.start == answer.start
    actual, expected_trace = (trace(code, kit, senses) for code in (answer.code, compilation.code))
    if any(lines[-1].endswith("LIMIT") for lines in (actual, expected_trace)):
        common_length = (
            min(len(actual), len(expected_trace)) - 1
        )  # the meaning does not include where a run was cut
        actual, expected_trace = actual[:common_length], expected_trace[:common_length]
    assert actual == expected_trace, data.decode()


def trace(code: bytes, kit: Kit, senses: Senses) -> list[str]:
    lists = lists_of(kit, senses)
    events = run(code, kit, lists, senses.max_ms, senses.max_steps, senses.seed)
    *lines, _ = map(str, events)  # the last one reports the place in its own code where a run ended
    return lines


def damage_text(rng: random.Random, data: bytes) -> bytes:
    """Return a text with one byte changed, lost or added, now and then."""
    if not data or rng.random() < 0.6:
        return data
    offset = rng.randrange(len(data))
    byte = bytes((rng.choice((rng.randrange(256), *b"\x00\xc2\xa0\xe2\x80\x93~09AZ_.<>/=-\r\n")),))
    return (
        data[:offset]
        + rng.choice((byte, b"", byte + data[offset : offset + 1]))
        + data[offset + 1 :]
    )


def soup(seed: int) -> tuple[Kit, bytes]:
    """Return a few tokens in any order: a short line, as people type it wrong."""
    rng = random.Random(seed)
    tokens = rng.choices(TOKENS, k=rng.randint(1, 9))
    frame = rng.choice(("{}", "X=1;{}", "IF({});ENDIF", "F({})", "X={}", "SHOW({})",
                        "LOOP(2);{};END_LOOP", "DEF GO;{};END_DEF;GO", "LED({})", "GRIPPER({})",
                        "F(1,{})UNTIL(TOUCH)", "BEEP({})", "M({},{})", "F({} CM,60)", "R({}°,60)",
                        "DEF GO(X);{};END_DEF;GO({})", "DEF GO({});END_DEF",
                        "DEF GO(X,Y);F(X,Y);END_DEF;GO({},{})",
                        "DEF A(X);END_DEF;DEF GO(Y,X);{};END_DEF",
                        "TASK;{};END_TASK", "WHEN({});S;ENDWHEN", "TASK;ENDTASK;{}"))  # fmt: skip
    text = frame.format(*(["".join(t + " " * rng.randint(0, 1) for t in tokens)] * 2))
    return KITS[1][1], text.encode()


def some_texts(soups: int, count: int) -> list[bytes]:
    """Return so many lines of random tokens, and random programs with a slip of each."""
    texts = [soup(seed)[1] for seed in range(soups)]
    for seed in range(count):
        rng = random.Random(seed)
        text = programs.program(rng, KITS[1][0])
        slip = programs.break_text(rng, text).encode("utf-8", "surrogatepass")
        texts += [text.encode(), damage_text(rng, slip)]
    return texts
