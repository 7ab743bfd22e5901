"""The reader's own rules: lines, checksums, its messages about wrong lines, its limits."""

from __future__ import annotations

from zlib import crc32

import pytest

from tests.machines.text_reader import NO_DEFS, Answer, TextReader, read_lines
from tests.support.casefile import all_cases
from tests.support.number_codes import NUMBER_CODES
from tests.support.rows import each_row
from tests.support.texts import LANGUAGES
from tests.support.texts import catalogue_texts as all_said
from tiniscript import robots
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.codegen.text.problems import MAX_CHARACTERS, PROBLEMS
from tiniscript.robots.text_levels import LEVELS, TASK_AND_EXTENT_WORDS, UNREAD_WORDS
from tiniscript.syntax.lexer import scan

KIT = robots.load("tinibot").kit
MORE_NEEDED = Answer()
BLOCK_BYTES = 3 + 3 * 4  # including a bit for each of 32 sensors


def answer_to(text: str | bytes) -> Answer:
    """Return a robot's answer to one line."""
    data = text if isinstance(text, bytes) else text.encode()
    (answer,) = read_lines(KIT, data + b"\n")
    return answer


def code_of(text: str) -> list[str]:
    answer = answer_to(text)
    assert answer.is_program, answer
    return [row[25:] for row in disassemble(answer.code).splitlines()]


def add_checksum(line: bytes) -> bytes:
    return b"%s~%08x" % (line, crc32(line))


# -- lines --------------------------------------------------------------------------------------


@pytest.mark.parametrize("closing", [b"\n", b"\r", b"\r\n"])
def test_all_line_ends_are_accepted(closing: bytes) -> None:
    answers = read_lines(KIT, closing.join([b"F(2, 80)", b"SB|S", b""]))
    assert [answer.start for answer in answers] == ["SI", "SB"]


def test_a_program_continues_until_its_blocks_are_closed() -> None:
    answers = read_lines(KIT, b"LOOP(2)\nF(1,\n80)\nEND_LOOP\nS\n")
    assert answers[:3] == [MORE_NEEDED] * 3
    assert answers[3] == answer_to("LOOP(2);F(1,80);END_LOOP")
    assert answers[4] == answer_to("S")


@pytest.mark.parametrize("cut", range(1, len("F(FOREVER,80)UNTIL(NOT(1<DISTANCE))")))
def test_a_line_may_end_in_brackets_alone(cut: int) -> None:
    whole = "F(FOREVER,80)UNTIL(NOT(1<DISTANCE))"
    if whole[cut - 1].isalnum() and whole[cut].isalnum():
        return
    answers = read_lines(KIT, f"{whole[:cut]} // )\n{whole[cut:]}\n".encode())
    if whole[:cut].count("(") > whole[:cut].count(")"):
        assert answers == [MORE_NEEDED, answer_to(whole)]
    else:
        assert answers[0].problem


def test_a_problem_ends_a_program() -> None:
    answers = read_lines(KIT, b"LOOP(2)\nF(1, 800)\nS\n")
    assert answers[1].problem == "RANGE" and answers[2] == answer_to("S")


def test_an_empty_line_starts_a_new_program_on_this_computer() -> None:
    assert read_lines(KIT, b"LOOP(2)\n\nS\n") == [MORE_NEEDED, answer_to("S")]


@pytest.mark.parametrize("line", ["", "  ", "// only a note", "SI|", ";;"])
def test_empty_programs_are_accepted(line: str) -> None:
    reader = TextReader(KIT)
    assert reader.read(line.encode()) == Answer(start="SI")
    reader.close()


# -- checksums ----------------------------------------------------------------------------------


def test_a_line_with_its_checksum_runs() -> None:
    assert answer_to(add_checksum(b"F(2, 80)")) == answer_to("F(2, 80)")
    assert answer_to(add_checksum(b"F(2, 80)").upper() + b" \t") == answer_to("F(2, 80)")
    assert answer_to(add_checksum(b"F(2, 80) // and a note")) == answer_to("F(2, 80)")
    assert answer_to("\ufeff".encode() + add_checksum(b"S")) == answer_to("S")


def test_each_line_of_a_program_may_have_a_checksum() -> None:
    lines = (
        b"\r\n".join(map(add_checksum, (b"LOOP(2)", b"F(1,", b"80)", b"", b"END_LOOP"))) + b"\r\n"
    )
    assert read_lines(KIT, lines)[-1] == answer_to("LOOP(2);F(1,80);END_LOOP")


def test_every_damage_of_one_byte_is_noticed() -> None:
    line = add_checksum(b"F(2, 80);S // note")
    for index in range(len(line)):
        for byte in b"~/0aF(\x00\xc2":
            damaged_bytes = line[:index] + bytes((byte,)) + line[index + 1 :]
            if damaged_bytes.lower() != line.lower():
                assert not answer_to(damaged_bytes).is_program or index > line.index(b"/"), (
                    damaged_bytes
                )


@pytest.mark.parametrize("bytes_before", [b"LOOP(2)", b"LOOP(2) // ~0", b"LOOP(2) // ~0 and more"])
def test_a_checksum_is_that_of_its_own_line(bytes_before: bytes) -> None:
    lines = read_lines(KIT, bytes_before + b"\n" + add_checksum(b"S;END_LOOP") + b"\n")
    assert lines == [MORE_NEEDED, answer_to("LOOP(2);S;END_LOOP")]


@pytest.mark.parametrize("line", [b"F(2, 80)~", b"S~1234567", b"S~1234567G", b"~S", b"S~ 12345678"])
def test_an_invalid_checksum_is_refused(line: bytes) -> None:
    assert answer_to(line).problem == "CHECKSUM"


def test_a_damaged_line_is_reported_as_damaged_whatever_else_is_wrong() -> None:
    assert answer_to(add_checksum(b"F(2, 80)").replace(b"F", b"G")).problem == "CHECKSUM"
    assert answer_to(add_checksum(b"G(2, 80)")).problem == "UNKNOWN_WORD"


# -- characters ---------------------------------------------------------------------------------


@pytest.mark.parametrize("space", "\t\u00a0\u2000\u200b\u202f\u3000\ufeff")
def test_spaces_are_ignored_between_tokens(space: str) -> None:
    assert answer_to(f"F{space}(2,{space}80){space}") == answer_to("F(2,80)")


@pytest.mark.parametrize("control", [chr(k) for k in range(1, 0x20) if chr(k) not in "\t\n\r\b"])
@pytest.mark.parametrize("line", ["F(2,{}80)", "F(2,80){}", "F(2,80) // {}", "F{}(2,80)"])
def test_no_control_byte_is_overlooked(line: str, control: str) -> None:
    """A flipped bit makes one of a point or a digit: `F(0.5,80)` must not drive for 5 s."""
    answer = answer_to(line.format(control))
    assert answer.problem == "CHARACTER" and answer.column == line.index("{") + 1


@pytest.mark.parametrize("dash", "\u2010\u2013\u2014\u2015\u2212")
def test_dashes_are_read_as_minus(dash: str) -> None:
    assert answer_to(f"M({dash}5,80)") == answer_to("M(-5,80)")


@pytest.mark.parametrize(
    "odd_character", ["é", "#", "\u2009\u2016", "\U0001f600", "\u00b0", "{", "=="]
)
def test_other_characters_are_refused(odd_character: str) -> None:
    assert answer_to(f"S{odd_character}").problem


# -- its messages and their places ---------------------------------------------------------------

PROBLEM_BY_LINE = {
    "F(2, 80)é": ("CHARACTER", 9), "W(5.)": ("NUMBER", 3), "X = 2147483.648": ("TOO_BIG", 5),
    "SI(X)": ("SETUP", 3), "F(1,80);SB|S": ("RESERVED", 9), "PING|S": ("PING", 6),
    "5": ("INSTRUCTION", 1), "GO": ("UNKNOWN_WORD", 1), "X = X + 1": ("UNKNOWN_VALUE", 5),
    "S = 5": ("SEPARATOR", 3), "F 2": ("OPEN", 3), "S)": ("CLOSE", 1), "F(1;80)": ("CLOSE", 3),
    "W()": ("VALUE", 2), "F(1)": ("COUNT", 3), "F(1,2,3)": ("COUNT", 5), "W(-1)": ("RANGE", 4),
    "W(TRUE)": ("WANTS_NUMBER", 3), "IF(5);S": ("WANTS_YES_NO", 4),
    "X=1<2<3": ("COMPARE", 6), "X=1=TRUE": ("COMPARE", 5), "X=1+NOT TRUE": ("NOT", 5),
    "X=TRUE<FALSE": ("COMPARE", 8), "X=TRUE<=FALSE": ("COMPARE", 9),
    "X=1;X=TRUE": ("KIND", 7), "F(FOREVER,80)": ("FOREVER_HERE", 3),
    "M(FOREVER,1)": ("FOREVER_HERE", 3),
    "UNTIL(TRUE)": ("UNTIL", 1), "ENDIF": ("BLOCK", 1), "LOOP(2);ELSE": ("BLOCK", 9),
    "BREAK": ("BREAK", 1), "LOOP(2);DEF X": ("DEF", 13), "DISTANCE=5": ("TAKEN", 1),
    "SI|FOO(1)": ("UNKNOWN_WORD", 4), "FOO // note": ("UNKNOWN_WORD", 1),
    "X=1;X + 1": ("INSTRUCTION", 5), "X=1;X=TRUE // note": ("KIND", 7),
    "X=TRUE+1+2": ("WANTS_NUMBER", 8), "X=1 AND TRUE OR FALSE": ("WANTS_YES_NO", 9),
    "F(2 80)": ("COMMA", 5), "F(2-1 (80))": ("COMMA", 7), "X=MIN(1 DISTANCE)": ("COMMA", 9),
    "F(2,80 5)": ("CLOSE", 8), "X=(1 2)": ("CLOSE", 6), "X=ABS(1 2)": ("CLOSE", 9),
    "F(1,80;L(1,50)": ("CLOSE", 5), "W(1 2)": ("CLOSE", 5),
    "DEF F": ("RESERVED", 5), "LOOP(2);TASK": ("DEF", 9), "TASK;BREAK": ("BREAK", 6),
    "END_TASK": ("BLOCK", 1), "TASK;END_WHEN": ("BLOCK", 6), "TASK A": ("SEPARATOR", 6),
    "WHEN(5)": ("WANTS_YES_NO", 6), "WHEN;S": ("OPEN", 1),
    "TASK;END_TASK;M(FOREVER,1)": ("FOREVER_HERE", 17),
    "S;F(FOREVER,80);S": ("FOREVER_HERE", 5), "L(1 CM,60)": ("RESERVED", 5),
    "F(1°,60)": ("RESERVED", 4), "F(-1 CM,60)": ("RANGE", 4), "X=1cm": ("RESERVED", 4),
    "F(1,60 CM)": ("RESERVED", 8), "F(1 CM)": ("COUNT", 5), "F(1 CM+1,60)": ("CLOSE", 7),
    "F((1 CM),60)": ("CLOSE", 6), "F(TRUE CM,60)": ("WANTS_NUMBER", 3), "W(1 CM)": ("RESERVED", 5),
    "F(5X,60)": ("NUMBER", 3), "DEF A(X);END_DEF;A": ("OPEN", 19), "DEF A(5)": ("RESERVED", 7),
    "DEF A(X;END_DEF": ("CLOSE", 7), "DEF A(X P)": ("COMMA", 9), "DEF A(X,)": ("VALUE", 7),
    "DEF A(X,X)": ("TAKEN", 9), "DEF A(A)": ("TAKEN", 7), "X=1;DEF A(X)": ("TAKEN", 11),
    "DEF A(X);END_DEF;X=1": ("TAKEN", 18), "DEF A(X);END_DEF;DEF X": ("TAKEN", 22),
    "DEF A(X);END_DEF;SHOW(X)": ("UNKNOWN_VALUE", 23), "DEF A(X);END_DEF;X": ("UNKNOWN_WORD", 18),
    "DEF A(X);END_DEF;A(TRUE)": ("WANTS_NUMBER", 20), "DEF A(X);A(1)": ("UNKNOWN_WORD", 10),
    "DEF A(X);END_DEF;A(1 CM)": ("RESERVED", 22), "DEF A(X);END_DEF;A(1,2)": ("COUNT", 20),
    "DEF A(X,P);END_DEF;A(1)": ("COUNT", 22), "DEF A;END_DEF;A(1)": ("COUNT", 17),
    "DEF A(X);END_DEF;A()": ("VALUE", 19), "DEF A(P,Q,T,U,V)": ("LIMIT", 15),
    "DEF A(X);X=TRUE": ("KIND", 12), "DEF A(X,S)": ("RESERVED", 9),
    "DEF A(X,DISTANCE)": ("TAKEN", 9),
    "DEF A(X);END_DEF;TASK;A(1);END_TASK;A(2)": ("ONE_TASK", 37),
    "DEF A(X);END_DEF;A(1);WHEN(TRUE);A(2)": ("ONE_TASK", 34),
    "DEF A(X);END_DEF;DEF C;A(1);END_DEF;TASK;C;END_TASK;TASK;A(2)": ("ONE_TASK", 58),
    "ROUND(1)": ("RESERVED", 1), "SI|F": ("OPEN", 5), "SI|F // note": ("OPEN", 6),
    "X = 1 <=": ("VALUE", 9), "SB": ("SETUP", 3), "FO\b": ("OPEN", 2),
}  # fmt: skip


@pytest.mark.parametrize("line", PROBLEM_BY_LINE)
def test_problems_have_their_column(line: str) -> None:
    answer = answer_to(line)
    assert (answer.problem, answer.column) == PROBLEM_BY_LINE[line]


# An unknown beginning of an instruction is reported at its place, and so is a FOREVER.
PROBLEMS_AT_A_WORD = ("UNKNOWN_WORD", "INSTRUCTION", "FOREVER_HERE")
RIGHT_LINES = (
    "SI|F(2, 80)", "sb | L(FOREVER, 50) UNTIL(DISTANCE < 9 OR NOT LIGHT_L >= 5)",
    "PING|CHECK_CONNECTION", "SPEED = -(2 + 3) * MIN(4, ABS(5)) <> 7 / 2",
    "X = TRUE; Y = NOT X <> FALSE",
    "DEF TURN; R(90 DEG, 60); END_DEF; LOOP(2); TURN; END_LOOP",
    "TASK; F(20cm, 60); END_TASK; WHEN(DISTANCE < 9); S; END_WHEN",
    "DEF GO(X, Y); F(X CM, Y); X = X + Y; END_DEF; GO(DISTANCE, 2); GO(-(1 + 2), 5)",
    "DEF NO(); END_DEF; NO(); NO",
    "DISTANCE; SHOW(ROUND(DISTANCE, 0))",
    "IF(LIGHT_R > 5); S; ELSEIF(TRUE); M(1, 2); ELSE; BEEP(1, 440); ENDIF",
    "WHILE(RANDOM(1, 6) <= 3); BREAK; END_WHILE; W(FOREVER) UNTIL(TIME % 2 = 1 AND FALSE)",
)  # fmt: skip


@pytest.mark.sampled("tail")
@pytest.mark.parametrize("tail", ["", "  ", "// note", " // note"])
@pytest.mark.parametrize("line", RIGHT_LINES)
def test_a_missing_end_is_reported_after_the_last_character(line: str, tail: str) -> None:
    """A correct line cut after any of its tokens lacks only its rest.

    It belongs before a comment.
    """
    refused_count, gap = 0, tail.find("/") > 0
    for token in scan(line).tokens[:-1]:
        answer = answer_to(line[: token.end] + tail)
        if answer.problem and answer.problem not in PROBLEMS_AT_A_WORD:
            assert answer.column == token.end + 1 + gap, line[: token.end]
            refused_count += 1
    assert refused_count > 0


def test_columns_saturate_at_255() -> None:
    assert answer_to(" " * 253 + "5").column == 254
    assert answer_to(" " * 300 + "5").column == 255
    assert answer_to("ñ" * 3).column == 1
    assert answer_to("// ñandú\u00a0").is_program is True


def test_every_problem_has_its_test() -> None:
    problems = {problem for problem, _ in PROBLEM_BY_LINE.values()} | {
        "CHECKSUM",
        "LIMIT",
        "FULL",
        "LACKS",
    }
    assert problems == set(PROBLEMS)


def test_a_reader_without_defs_reads_everything_else() -> None:
    """It recognizes the words, so that they are no names, and reports the missing feature."""
    small, large = TextReader(KIT, flags=NO_DEFS), TextReader(KIT)
    lacks = LEVELS["uno"].missing_words
    texts = [
        text % word
        for word in sorted(TASK_AND_EXTENT_WORDS)
        for text in ("%s", "X=1;%s=2", "F(5 %s,60)")
    ]
    for text in ("DEF A; F(1, 50); END_DEF; A", "def", "DEF=1", "X=1; DEF A", *texts):
        word = next(token for token in scan(text).tokens if token.text in lacks)
        assert small.read(text.encode()) == Answer(problem="LACKS", column=word.start + 1), text
    texts = ["END_DEF", "LOOP(2); END_DEF", "X=DEF", "ENDDEF=1"]
    cases = [case.parts.get("tiniscript", "S") for case in all_cases()]
    for text in (*texts, *PROBLEM_BY_LINE, *cases):
        answer, words = small.read(text.encode()), {token.text for token in scan(text).tokens}
        if text in texts or not (lacks | UNREAD_WORDS) & words:
            other_answer = large.read(text.encode())  # on this robot, FOREVER waits for tasks
            assert answer == other_answer or (
                answer.problem == "FOREVER_HERE" and other_answer.problem
            ), text
        else:
            assert answer.problem, text
    small.close()
    large.close()


def test_texts_are_short_and_plain() -> None:
    for language in LANGUAGES:
        for text in all_said(language, "robot").values():
            assert text.isascii() and 0 < len(text) <= MAX_CHARACTERS


# -- limits -------------------------------------------------------------------------------------


def blocks(depth: int) -> str:
    return "LOOP(1);" * depth + "END_LOOP;" * depth


def tasks(*depths: int) -> str:
    return "".join(f"WHEN(TRUE);{blocks(depth)}ENDWHEN;" for depth in depths)


def deep(values: int) -> str:
    return "X=" + "1+(" * (values - 1) + "1" + ")" * (values - 1)


def chain(calls: int) -> str:
    return "DEF A0;END_DEF;" + "".join(
        f"DEF A{k};A{k - 1};END_DEF;" for k in range(1, calls)
    ) + f"A{calls - 1}"  # fmt: skip


@pytest.mark.parametrize(
    ("right_text", "wrong_text"),
    [
        (";".join(f"V{k}=1" for k in range(32)), ";".join(f"V{k}=1" for k in range(33))),
        (blocks(16), blocks(17)),
        (deep(16), deep(17)),
        ("DEF A;" + blocks(8) + "END_DEF;" + "IF(TRUE);" * 8 + "A;" + "ENDIF;" * 8,
         "DEF A;" + blocks(8) + "END_DEF;" + "IF(TRUE);" * 9 + "A;" + "ENDIF;" * 9),
        ("DEF A;" + blocks(8) + "END_DEF;DEF C;" + "IF(TRUE);" * 4 + "A;" + "ENDIF;" * 4
         + "END_DEF;" + "IF(TRUE);" * 4 + "C;" + "ENDIF;" * 4,
         "DEF A;" + blocks(8) + "END_DEF;DEF C;" + "IF(TRUE);" * 4 + "A;" + "ENDIF;" * 4
         + "END_DEF;" + "IF(TRUE);" * 5 + "C;" + "ENDIF;" * 5),
        (chain(8), chain(9)),
        # Tasks, and the blocks open in all of them together.
        ("TASK;ENDTASK;" * 4, "TASK;ENDTASK;" * 5),
        (blocks(4) + tasks(6, 5) + blocks(5), blocks(4) + tasks(6, 5) + blocks(6)),
        (blocks(10) + tasks(2, 4), blocks(10) + tasks(2, 5)),
        ("DEF A;" + blocks(9) + "END_DEF;TASK;A;END_TASK;" + blocks(7),
         "DEF A;" + blocks(9) + "END_DEF;TASK;A;END_TASK;" + blocks(8)),
        (blocks(16) + "DEF A;" + blocks(16) + "END_DEF;TASK;S;END_TASK;A",
         blocks(16) + "DEF A;" + blocks(16) + "END_DEF;TASK;IF(TRUE);ENDIF;END_TASK;A"),
        (chain(5) + ";TASK;A2;END_TASK", chain(5) + ";TASK;A3;END_TASK"),
        ("".join(f"DEF A{k};END_DEF;" for k in range(16)),
         "".join(f"DEF A{k};END_DEF;" for k in range(17))),
        ("".join(f"DEF A{k}(X,P);END_DEF;" for k in range(15)) + "X1=1;X2=2",
         "".join(f"DEF A{k}(X,P);END_DEF;" for k in range(15)) + "X1=1;X2=2;X3=3"),
        ("DEF A(P,Q,T,U);END_DEF;A(1,2,3," + "(1+" * 11 + "1" + ")" * 11 + ")",
         "DEF A(P,Q,T,U);END_DEF;A(1,2,3," + "(1+" * 13 + "1" + ")" * 13 + ")"),
    ],
)  # fmt: skip
def test_limits_of_the_language_are_kept(right_text: str, wrong_text: str) -> None:
    assert answer_to(right_text).is_program
    assert answer_to(wrong_text).problem == "LIMIT"


def test_a_name_may_begin_in_the_deepest_block() -> None:
    """All that waits makes room for it: 16 blocks that count, and a DEF."""
    opening, closing = "DEF A;" + "LOOP(2);" * 16, "END_LOOP;" * 16 + "END_DEF;A"
    early, late = (
        [row.split()[0] for row in code_of(text + closing)]
        for text in (f"V=1;{opening}S;", f"{opening}V=1;S;")
    )
    opening_end = 2 + 1 + 2 * 16
    assert late == early[2:opening_end] + early[:2] + early[opening_end:]


def test_at_most_255_bytes_of_code() -> None:
    assert len(answer_to("S;" * 255).code) == 255
    assert answer_to("S;" * 256).problem == "FULL"


def test_at_most_254_brackets_that_are_open() -> None:
    assert answer_to("X=" + "(" * 254 + "1" + ")" * 254).is_program
    assert answer_to("X=" + "(" * 255 + "1" + ")" * 255).problem == "FULL"
    assert answer_to("X=" + "(" * 600 + "1" + ")" * 600).problem == "FULL"


def test_names_are_distinguished_to_their_last_letter() -> None:
    name = "A" * 200
    assert code_of(f"{name}1 = 1; {name}2 = 2; {name} = {name}2")[-2:] == [
        "PUSH_VAR_1",
        "SET_VAR_2",
    ]


def test_code_and_waiting_data_share_the_buffer() -> None:
    """Code and waiting data meet: one byte less is too little."""
    text = b"SPEED = 5; IF(SPEED > 1); F(1, SPEED); ENDIF"
    # ten bytes of code, the word that is read, the block that it ends, and the name SPEED
    min_room = 10 + len("ENDIF") + BLOCK_BYTES + len(" SPEED")
    for room in range(min_room):
        assert read_lines(KIT, text + b"\n", room)[0].problem == "FULL"
    assert read_lines(KIT, text + b"\n", min_room)[0].is_program


# -- tasks --------------------------------------------------------------------------------------


def test_forever_is_allowed_only_beside_tasks() -> None:
    """They may follow it, as long as the program continues."""
    move = "SI|F(FOREVER, 60)"
    assert answer_to(f"{move}; TASK; END_TASK").is_program
    assert answer_to(f"TASK; END_TASK; {move[3:]}").is_program
    assert answer_to(move) == Answer(problem="FOREVER_HERE", column=6)
    assert answer_to(f"{move}; W(FOREVER)") == Answer(problem="FOREVER_HERE", column=6)
    loop = "LOOP(1);F(FOREVER, 60)\nEND_LOOP"
    assert read_lines(KIT, f"{loop};WHEN(TRUE)\nS\nEND_WHEN\n".encode())[-1].is_program
    assert read_lines(KIT, f"{loop}\nS\n".encode())[1:] == [
        Answer(problem="FOREVER_HERE", column=1),  # the word is in an earlier line
        answer_to("S"),
    ]


def test_a_way_keeps_its_bracket_open() -> None:
    assert read_lines(KIT, b"F(20 CM\n// cm\n,60)\n") == [
        MORE_NEEDED,
        MORE_NEEDED,
        answer_to("F(20cm,60)"),
    ]
    assert read_lines(KIT, b"R(90\xc2\xb0\n,60)\n") == [MORE_NEEDED, answer_to("R(90 DEG,60)")]


# -- code ---------------------------------------------------------------------------------------


@each_row("number, code", NUMBER_CODES)
def test_the_shortest_push_is_used(number: str, code: str) -> None:
    assert answer_to(f"SHOW({number})").code.hex(" ") == f"{code} 39"


@pytest.mark.parametrize("number", ["2147483.6475", "-2147483.6485", "9999999999999999999999"])
def test_too_large_numbers_are_refused(number: str) -> None:
    assert answer_to(f"X = {number}").problem == "TOO_BIG"


def test_readings_precede_their_instruction() -> None:
    assert code_of("X = TIME > 5 AND DISTANCE < 10 OR LIGHT_R > 5") == [
        "READ_2", "READ_0", "TIME", "PUSH_NUM_5", "GT", "AND_THEN -> 000a", "PUSH_SENSOR_2",
        "PUSH_NUM_10", "LT", "OR_ELSE -> 000f", "PUSH_SENSOR_0", "PUSH_NUM_5", "GT", "SET_VAR_0",
    ]  # fmt: skip


def readings_of(text: str) -> list[str]:
    return [name for name in code_of(text) if name.startswith("READ")]


def test_a_chain_of_branches_takes_a_reading_once() -> None:
    assert readings_of("IF(FALSE);ELSEIF(DISTANCE>1);ELSEIF(DISTANCE>2);ENDIF") == ["READ_2"]
    assert readings_of("IF(DISTANCE>0);ELSEIF(DISTANCE>1);S;ENDIF;X=DISTANCE") == ["READ_2"] * 2


def test_an_until_reads_at_each_check() -> None:
    """LIGHT_R is the first sensor, DISTANCE the last one."""
    for sensor, reading in (("LIGHT_R", "READ_0"), ("DISTANCE", "READ_2")):
        assert readings_of(f"F({sensor},80)UNTIL({sensor}>1)") == [reading] * 2


def test_readings_of_a_called_body_count_as_read() -> None:
    assert readings_of("DEF LOOK;DISTANCE;END_DEF;LOOK;X=DISTANCE") == ["READ_2"]
    assert readings_of("DEF LOOK;X=DISTANCE;END_DEF;LOOK;X=DISTANCE") == ["READ_2"] * 2
    assert readings_of("DISTANCE;DEF LOOK;X=DISTANCE;END_DEF;X=DISTANCE") == ["READ_2"] * 2


def test_the_values_of_a_call_are_set_one_after_the_other() -> None:
    code = code_of("DEF A(X,P);X=P;SHOW(X);END_DEF;DEF C(X);A(X,LIGHT_L);END_DEF;"
                   "C(DISTANCE)")  # fmt: skip
    assert [" ".join(row.split()) for row in code] == [
        "DEF -> 0007", "PUSH_VAR_1", "SET_VAR_0", "PUSH_VAR_0", "SHOW", "RETURN",
        "DEF -> 0011", "READ_1", "PUSH_VAR_2", "SET_VAR_0", "PUSH_SENSOR_1", "SET_VAR_1",
        "CALL -> 0002", "RETURN", "READ_2", "PUSH_SENSOR_2", "SET_VAR_2", "CALL -> 0009",
    ]  # fmt: skip


def test_tasks_may_have_different_defs_with_values() -> None:
    opening = "DEF A(X);END_DEF;DEF C(X);A(X);END_DEF;DEF G(X);END_DEF;"
    assert answer_to(opening + "A(1);C(2);TASK;G(1);END_TASK;A(3)").is_program
    assert answer_to(opening + "TASK;G(1);G(2);END_TASK;WHEN(TRUE);C(1);END_WHEN").is_program
    assert (
        answer_to(opening + "TASK;C(1);END_TASK;WHEN(TRUE);G(1);END_WHEN;G(3)").problem
        == "ONE_TASK"
    )


def test_a_call_may_continue_in_the_next_line() -> None:
    answers = read_lines(KIT, b"DEF A(X,\nP)\nF(X,P)\nEND_DEF;A(1\n+1,\n50)\n")
    assert answers[-1] == answer_to("DEF A(X,P);F(X,P);END_DEF;A(1+1,50)")


# -- backspace ----------------------------------------------------------------------------------


@pytest.mark.parametrize("key", ["\b", "\x7f"])
@pytest.mark.parametrize(
    ("typed_text", "meant_text"),
    [
        ("G<F(2,80)", "F(2,80)"), ("FOO<<(2,80)", "F(2,80)"), ("X=1;XY<=2", "X=1;X=2"),
        ("LOPP<<OP(2);END_LOOP", "LOOP(2);END_LOOP"), ("SX<;S", "S;S"),
        ("F(2,89<0)", None), ("S;<", None), ("S <", None), ("<S", None),
        ("S // note<", "S"), (" " * 260 + "SS<", None),
    ],
)  # fmt: skip
def test_backspace_removes_input_that_has_not_run(
    key: str, typed_text: str, meant_text: str | None
) -> None:
    """`<` is the key, and only letters of the word that is typed are not done."""
    answer = answer_to(typed_text.replace("<", key))
    if meant_text is None:
        assert answer.problem == "CHARACTER"
    else:
        assert answer == answer_to(meant_text) and answer.is_program


def test_columns_after_a_backspace_match_the_visible_text() -> None:
    assert answer_to("FO\b(2, 80); GO").column == answer_to("F(2, 80); GO").column == 11
