"""The page's diagnostics of a program are those of the command."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.pupils import corpus
from tests.studio.programs import MISSING_PART_CODES, messages_of
from tests.support.texts import LANGUAGES
from tiniscript import check, compile, compile_text, robots
from tiniscript.diagnostics.fixing import MAX_OFFERS, repair_program
from tiniscript.diagnostics.rendering import Message
from tiniscript.library.compiling import Compilation, compile_source
from tiniscript.studio import checking, worker
from tiniscript.studio.description import description
from tools.builds.page_texts import page_texts


def test_a_right_program_has_the_image_of_the_command() -> None:
    result = checking.check(b"SI|F(2, 80)", "tinibot", "en")
    assert result.image == compile("SI|F(2, 80)").image
    assert (result.code_bytes, result.findings) == (3, ())
    assert result.places[0] == (0, 1, 4, 1, 12)


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_new_word_of_the_toolbox_is_a_valid_name(language: str) -> None:
    word = page_texts(language)["new_word"]
    program = f"SI|DEF {word};F(1, 50);END_DEF;{word}"
    assert not checking.check(program.encode(), "tinibot", language).findings


@pytest.mark.parametrize("robot", robots.names())
def test_the_sensors_that_a_program_reads_are_named_by_their_numbers(robot: str) -> None:
    names = [sensor.name for sensor in robots.load(robot).kit.sensors]
    programs = [f"SHOW({name})" for name in names]
    for number, program in enumerate(programs):
        assert checking.check(program.encode(), robot, "en").read_sensors == (number,)
    all_read = checking.check("\n".join(reversed(programs)).encode(), robot, "en").read_sensors
    assert all_read == tuple(range(len(names)))


@pytest.mark.sampled("first_index", "part")
@pytest.mark.parametrize("first_index", range(2))
@pytest.mark.parametrize("part", range(12))
def test_messages_match_the_command_and_repairs_help(first_index: int, part: int) -> None:
    """Languages alternate; no offered repair makes a program worse."""
    offered = 0
    for k, entry in enumerate(corpus.entries()[part::12]):
        language = LANGUAGES[(first_index + k) % len(LANGUAGES)]
        result = checking.check(entry.program.encode(), "tinibot", language)
        messages = [
            finding.message
            for finding in result.findings
            if finding.message.code not in MISSING_PART_CODES
        ]
        assert messages == messages_of(entry.program, language)
        for repair in buttons(entry.program):
            if repair:
                offered += 1
                changed_text = changed_by(entry.program, repair)
                assert mistakes(check(changed_text)) <= mistakes(
                    [f.message for f in result.findings]
                )
                assert changed_text != entry.program
    assert offered > 100


@pytest.mark.parametrize(
    ("text", "loose_count"),
    [("SI|S\n/// W(1)\n", 1), ("SI|S\n/// LOOP(2)\n///   W(1)\n/// END_LOOP\n///\n/// = 5 < 6", 3),
     ("SI|S // /// W(1)\n/// not a program", 0), ("F(-2, 80)\n/// W(1)", 1)],
)  # fmt: skip
def test_loose_blocks_are_counted(text: str, loose_count: int) -> None:
    request_text = '{"do": "check", "robot": "tinibot", "language": "en"}'
    assert json.loads(worker.answer(request_text, text.encode()))["loose"] == loose_count


def test_a_program_too_large_for_the_robot_is_a_mistake() -> None:
    result = checking.check(b"SI|" + b"F(1, 80);" * 500, "tinibot", "en")
    assert not result.image and result.findings[-1].message.severity == "mistake"


def test_the_first_value_of_a_variable_is_offered_in_place_of_its_declaration() -> None:
    program = "var vel\nF(2, 80)"
    (repair,) = buttons(program)
    assert changed_by(program, repair) == "vel = 0\nF(2, 80)"


@pytest.mark.parametrize(
    ("program", "expected_text"),
    [
        ("R(90, 60)", "R(90 DEG, 60)"),
        ("SI|F(30, 60)  // 30 cm", "SI|F(30 CM, 60)  // 30 cm"),
        ("R(MIN(90, 80), POWER)", ""),  # its power is unknown, so the mistake is different
        ("R(MIN(90, 80), DISTANCE)", "R(MIN(90, 80) DEG, DISTANCE)"),
        ("R(90, 60) UNTIL(DISTANCE < 5)", "R(90 DEG, 60) UNTIL(DISTANCE < 5)"),
        ("R(90 // degrees\n, 60)", ""),
        ("F(1, 800)", "F(1, 100)"),
        ("F(1, 800) UNTIL(DISTANCE < 5)", "F(1, 100) UNTIL(DISTANCE < 5)"),
        ("F(-2, 80) UNTIL(DISTANCE < 5)", "B(2, 80) UNTIL(DISTANCE < 5)"),
        ("contador = contador + 1", "CONTADOR = 0; contador = contador + 1"),
        ("// mine\nSI|LOOP(3)\nN = N + 1\nEND_LOOP",
         "// mine\nSI|N = 0\nLOOP(3)\nN = N + 1\nEND_LOOP"),
        ("SI|Q = NOT Q", "SI|Q = FALSE; Q = NOT Q"),
        ("SI|Q = Q OR DISTANCE < 5", "SI|Q = FALSE; Q = Q OR DISTANCE < 5"),
        ("SI|F(2, V)\nV = 50", "SI|V = 50\nF(2, V)"),
        ("LOOP(3)\nF(2, V)\nEND_LOOP\n  V = 50\nS", "V = 50\nLOOP(3)\nF(2, V)\nEND_LOOP\nS"),
        ("F(2,\r\nV)\r\nV = 50\r\n", "V = 50\nF(2,\r\nV)\r\n"),
        ("F(2, V); V = 50; V = 60", "V = 50; F(2, V); V = 50; V = 60"),
        ("SI|F(80, 2)", "SI|F(2, 80)"),
        ("SI|DISTANCE", "SI|SHOW(DISTANCE)"),
        ("SI|R(90, 60)~1A2B", ""),
    ],
)  # fmt: skip
def test_a_repair_button_does_what_the_message_says(program: str, expected_text: str) -> None:
    """It changes nothing else; the command repairs none of it, as it is uncertain."""
    finding = checking.check(program.encode(), "tinibot", "en").findings[0]
    repair = buttons(program)[0]
    assert (changed_by(program, repair) if repair else "") == expected_text
    if expected_text:
        assert finding.message not in check(expected_text)
        assert not [message for message in check(expected_text) if message.severity == "mistake"]
    kit = robots.load("tinibot").kit
    repaired = repair_program(program, lambda text: compile_text(text, kit).diagnostics)
    assert (
        expected_text.startswith("B(") or repaired.text == program
    )  # -2 seconds forward are 2 back


def test_each_of_many_mistakes_has_its_own_button() -> None:
    """They are pressed one after the other, each once."""
    program = "F(1, 800)\nN = N + 1\nM(50, 50)\nR(90, 60)\nR(90, 60)\n"
    for _ in range(9):
        repair = next(filter(None, buttons(program)), ())
        if not repair:
            break
        program = changed_by(program, repair)
    assert program == ("N = 0\nF(1, 100)\nN = N + 1\nM(50, 50)\nR(90 DEG, 60)\nR(90 DEG, 60)\n")


def test_some_mistakes_are_not_repaired() -> None:
    """A line with a checksum gets no repair, and of many mistakes only the first do."""
    repairs = buttons("SI|F(2, 80~1A2B")
    assert repairs and not any(repairs)
    repairs = buttons("SI|" + "F(2, 80\n" * 90)
    assert 0 < sum(map(bool, repairs)) <= MAX_OFFERS < len(repairs)


def test_a_file_is_read_like_in_the_command_or_refused_with_a_message() -> None:
    for data in (b"\xff\xfe", b"F(2\0, 80)", b"x" * 1_000_001):
        message = checking.open_text(data, "tinibot", "es")
        assert isinstance(message, Message) and message.message, data[:9]
    assert checking.open_text("\ufeffSI|F(2, 80)\r\n".encode(), "liner", "en") == "SI|F(2, 80)\r\n"


def test_only_shipped_robots_are_accepted() -> None:
    """No name that a page sends becomes a file."""
    with pytest.raises(AssertionError):
        checking.check(b"", "../../etc/passwd.toml", "en")


def test_answers_are_json() -> None:
    request = {"do": "check", "robot": "tinibot", "language": "es"}
    answer = json.loads(worker.answer(json.dumps(request), "SI|F(-1, 80) // ñ 🤖".encode()))
    (finding,) = answer["findings"]
    assert finding["severity"] == "mistake" and finding["code"] == "TS206"
    assert finding["may_repair"]
    request_text = json.dumps({"do": "repair", "robot": "tinibot", "which": 0})
    changes = json.loads(worker.answer(request_text, "SI|F(-1, 80) // ñ 🤖".encode()))["changes"]
    assert changes[0]["text"] == "B(1, 80)"
    opened_program = json.loads(worker.answer(json.dumps({**request, "do": "open"}), b"\xff"))
    assert opened_program["message"]


LINER_PROGRAM = "// robot: liner\nSI|SHOW(LINE_L)\n"
CHECK_REQUEST = {"do": "check", "robot": "tinibot", "language": "en"}


def test_a_program_also_names_its_robot_in_the_page() -> None:
    check_answer = json.loads(worker.answer(json.dumps(CHECK_REQUEST), LINER_PROGRAM.encode()))
    assert (check_answer["robot"], check_answer["names_robot"], check_answer["findings"]) == (
        "liner",
        True,
        [],
    )
    assert bytes.fromhex(check_answer["image"]) == compile(LINER_PROGRAM).image
    check_answer = json.loads(worker.answer(json.dumps(CHECK_REQUEST), b"// robot: linar\nS"))
    assert (check_answer["robot"], check_answer["names_robot"], check_answer["image"]) == (
        "tinibot",
        False,
        "",
    )
    check_answer = json.loads(
        worker.answer(json.dumps({**CHECK_REQUEST, "robot": "grabber"}), b"S")
    )
    assert (check_answer["robot"], check_answer["names_robot"]) == ("grabber", False)
    answer = worker.answer(
        json.dumps({**CHECK_REQUEST, "do": "rename", "robot": "grabber"}), LINER_PROGRAM.encode()
    )
    assert json.loads(answer)["text"] == LINER_PROGRAM.replace("liner", "grabber")
    line = json.loads(
        worker.answer(json.dumps({**CHECK_REQUEST, "do": "line"}), LINER_PROGRAM.encode())
    )
    assert line["text"].startswith("SI|SHOW(LINE_L)")


@pytest.mark.parametrize(
    "text",
    [
        "SI|SHOW(LINE_L)\n",
        LINER_PROGRAM.replace("liner", "tinibot"),
        LINER_PROGRAM.replace("liner", "linar"),
    ],
)
def test_a_suggested_robot_has_a_button(text: str) -> None:
    (repair,) = buttons(text)
    assert changed_by(text, repair) == LINER_PROGRAM


def test_blocks_keep_the_named_robot() -> None:
    form = worker.answer(json.dumps({**CHECK_REQUEST, "do": "blocks"}), LINER_PROGRAM.encode())
    request = {"do": "text", "form": json.loads(form)}
    assert json.loads(worker.answer(json.dumps(request)))["text"] == LINER_PROGRAM


def test_the_page_knows_every_robot_and_its_words() -> None:
    page_description = description()
    assert [robot["name"] for robot in page_description["robots"]] == robots.names()
    for robot_row in page_description["robots"]:
        kit = robots.load(robot_row["name"]).kit
        names = [device["text"] for device in robot_row["devices"]]
        assert names == list(kit.names)
        assert set(robot_row["labels"]) == set(LANGUAGES)
    words = {word["text"] for word in page_description["words"]}
    assert {"F", "IF", "END_LOOP", "UNTIL"} <= words and not words & {"SEND", "ENDLOOP"}
    assert page_description["worlds"][0]["name"] == "obstacles"


def mistakes(messages: list[Message]) -> int:
    return sum(message.severity == "mistake" for message in messages)


def changed_by(text: str, changes: tuple[checking.Change, ...]) -> str:
    """Return a text after changes, whose places are lines and columns."""
    line_starts = [0]
    for k, character in enumerate(text):
        if character == "\n":
            line_starts.append(k + 1)

    def offset(line: int, column: int) -> int:
        return line_starts[line - 1] + column - 1 if line <= len(line_starts) else len(text)

    for change in sorted(changes, reverse=True):
        start, end = offset(change.line, change.column), offset(change.end_line, change.end_column)
        text = text[:start] + change.text + text[end:]
    return text


@pytest.mark.parametrize(
    ("program", "yes_no"),
    [
        ("Q = TRUE; DEF LOOK; SEEN = Q; END_DEF; LOOK", ["Q", "SEEN"]),
        (
            "Q = DISTANCE < 9; N = 1; DEF A; C = Q; K = N; END_DEF; A; D = C;"
            " DEF G; E = D; K = N; END_DEF; G",
            ["Q", "C", "D", "E"],
        ),
    ],
)
def test_a_yes_no_variable_is_recognized_from_any_assignment(
    program: str, yes_no: list[str]
) -> None:
    variables = checking.check(program.encode(), "tinibot", "en").variables
    assert {variable.name for variable in variables if variable.is_yes_no} == set(yes_no)


@pytest.mark.parametrize("wrong_end", ["", "F(1, 800)"])
def test_a_typed_letter_costs_one_compilation_and_a_button_at_most_two(
    monkeypatch: pytest.MonkeyPatch, wrong_end: str
) -> None:
    """For a program with a hundred warnings; the buttons' effects are tried during a pause."""
    texts: list[bytes] = []

    def count_compilation(data: bytes, *arguments: Any, **keyword_arguments: Any) -> Compilation:
        texts.append(data)
        return compile_source(data, *arguments, **keyword_arguments)

    monkeypatch.setattr(checking, "compile_source", count_compilation)
    text = (
        ";\n".join(f"IF(DISTANCE < {k});R(90, 60);END_IF" for k in range(1, 101))
        + f";\n{wrong_end}"
    )
    findings = checking.check(text.encode(), "tinibot", "en").findings
    assert len(texts) == 1 and sum(finding.may_repair for finding in findings) == (
        1 if wrong_end else MAX_OFFERS
    )
    finding_index = next(k for k, finding in enumerate(findings) if finding.may_repair)
    assert checking.repair(text.encode(), "tinibot", finding_index)
    assert len(texts) == 2, "the text that is known is not compiled again"
    checking.check(b"S", "tinibot", "en")
    assert checking.repair(text.encode(), "tinibot", finding_index)
    assert len(texts) == 5


def buttons(program: str) -> list[tuple[checking.Change, ...]]:
    """Return the effect of each finding's button, as the page requests it."""
    findings = checking.check(program.encode(), "tinibot", "en").findings
    return [
        checking.repair(program.encode(), "tinibot", k) if finding.may_repair else ()
        for k, finding in enumerate(findings)
    ]
