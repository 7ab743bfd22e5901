"""The command: typed input, visible output, and the exit code."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.command import OBSTACLE, PROGRAM, Tsc, run_in_process
from tests.support.rows import each_row
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.cli import main
from tiniscript.cli.texts import has_text

VERB_OPTIONS = (
    "check", "compile", "compile -o a.bin", "compile --text", "compile --text -o a.txt", "fmt",
    "fmt --check", "show", "show --json", "show --arduino", "show --arduino -o a.ino", "run",
    "run --machine cpp", "run --record a.tsr", "run --record a.tsr --world line", "upload --port a",
    "upload --all", "upload --port virtual",
)  # fmt: skip


@pytest.mark.parametrize("verb_options", VERB_OPTIONS)
def test_a_mistake_gives_exit_code_1_in_every_command(
    tsc: Tsc, working_folder: Path, verb_options: str
) -> None:
    """Nothing is written, run or sent."""
    program = working_folder / "drive.ts"
    program.write_text("SI|S = 5")
    verb, *options = verb_options.split()
    tsc(verb, program, *options).gives(1)
    assert [path.name for path in working_folder.glob("*.*")] == ["drive.ts"]
    assert program.read_text() == "SI|S = 5"


# -- compile ------------------------------------------------------------------------------------


def test_compile_writes_the_image_and_nothing_else(tsc: Tsc, program: Path) -> None:
    target = program.with_name("out.bin")
    tsc("compile", program, "-o", target).gives(
        0, "", out="18 bytes (3 of code)   stack 0 of 16   runs 5 s"
    )
    assert unpack(target.read_bytes()).code.hex() == "448c50"
    assert sorted(path.name for path in program.parent.glob("*.*")) == ["drive.ts", "out.bin"]
    assert tsc("compile", program).code == 0
    assert program.with_suffix(".bin").read_bytes() == target.read_bytes()
    assert tsc("compile", program, "--map", "-").code == 2
    assert tsc("compile", "-e", PROGRAM).code == 2, "it needs a name for the image"


@each_row("text, runs", [
    ("W(1.5);BEEP(0.25, 440)", "runs 1.75 s"),
    ("IF(DISTANCE < 5);W(2);ELSE;W(8);ENDIF", "runs 2 to 8 s"),
    ("F(5,80) UNTIL(DISTANCE < 5)", "runs 0 to 5 s"),
    ("W(1);W(DISTANCE)", "runs at least 1 s"),
    ("LOOP(FOREVER);W(1);END_LOOP", "runs until it is stopped"),
    ("LOOP(FOREVER);W(1);IF(DISTANCE < 5);BREAK;ENDIF;END_LOOP", "stack 1 of 16\n"),
    ("W(5);SHOW(1 / 0);W(5)", "stack 2 of 16\n"),
    ("LOOP(FOREVER);IF(DISTANCE < 5);BREAK;ENDIF;LOOP(FOREVER);W(1);END_LOOP;END_LOOP",
     "stack 1 of 16\n"),
])  # fmt: skip
def test_compile_reports_the_duration(tsc: Tsc, tmp_path: Path, text: str, runs: str) -> None:
    assert runs in tsc("compile", "-e", text, "-o", tmp_path / "a.bin").out


def test_a_failed_compile_leaves_the_old_image(tsc: Tsc, tmp_path: Path) -> None:
    target = tmp_path / "old.bin"
    target.write_bytes(b"TS\2 an old image")
    tsc("compile", "-e", "S = 5", "-o", target).gives(1, "TS")
    assert target.read_bytes() == b"TS\2 an old image"
    assert [path.name for path in tmp_path.glob("*.*")] == ["old.bin"]


def test_compile_to_standard_output(
    program: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    assert main(["compile", str(program), "-o", "-"]) == 0
    capture_result = capsysbinary.readouterr()
    assert unpack(capture_result.out).code.hex() == "448c50"
    assert b"18 bytes" in capture_result.err


def test_map_names_the_lines(tsc: Tsc, tmp_path: Path) -> None:
    source, places = tmp_path / "a.ts", tmp_path / "a.map"
    source.write_text("// hello\nW(1)\nX = 0; SHOW(1 / X)\n", encoding="utf-8")
    assert tsc("compile", source, "--map", places).code == 0
    known_fields = json.loads(places.read_text(encoding="utf-8"))
    assert known_fields["lines"][1] == "W(1)"
    assert [place[:3] for place in known_fields["places"]] == [[0, 2, 1], [2, 3, 1], [4, 3, 8]]
    result = tsc("run", tmp_path / "a.bin")
    assert (result.code, result.out) == (1, "1000 FAULT DIVIDE_BY_ZERO\n")
    assert "line 3:  X = 0; SHOW(1 / X)" in result.err


def test_each_fault_of_a_program_is_explained(tsc: Tsc) -> None:
    for instruction, fault, message in (
        ("SHOW(2000000 * 2000000)", "OVERFLOW", "Use smaller numbers."),
        ("SHOW(1 / 0)", "DIVIDE_BY_ZERO", "check with IF"),
        ("F(20 CM, 0)", "NO_POWER", "Use more power."),
    ):
        result = tsc("run", "-e", f"SI|{instruction}")
        assert (result.code, result.out) == (1, f"0 FAULT {fault}\n"), instruction
        assert f"fault {fault}: " in result.err, instruction
        assert message in result.err, instruction
    assert all(has_text(f"fault_{name}") for _, name, _ in FAULTS)


def test_the_board_has_less_memory_than_the_language(tsc: Tsc, tmp_path: Path) -> None:
    text = "SHOW(TIME * 1.234);" * 90
    result = tsc("compile", "-e", text, "-o", tmp_path / "a.bin").gives(1, "389")
    assert "151" in result.err  # by how many bytes
    for verb in ("check", "run"):
        tsc(verb, "-e", text).gives(0, "151")
    assert tsc("compile", "-e", text, "-o", tmp_path / "a.bin", "--robot", "grabber").code == 0


def test_code_has_a_limit_on_every_robot(tsc: Tsc, tmp_path: Path) -> None:
    for instructions, code in ((CODE_BYTES // 3, 0), (CODE_BYTES // 3 + 1, 1)):
        tsc("run", "-e", "M(1,1);" * instructions, "--max-steps", "1").gives(code)


# -- check --------------------------------------------------------------------------------------


def test_check_reports_all_mistakes_in_both_languages(tsc: Tsc) -> None:
    text = "F(2 80);S = 5\nIF(DISTANCE < 10) STOP ENDIF"
    english, spanish = tsc("check", "-e", text), tsc("check", "--lang", "es", "-e", text)
    assert english.code == spanish.code == 1
    assert english.out == spanish.out == ""
    assert "line 2:" in english.err
    assert "3 mistakes." in english.err
    assert "línea 2:" in spanish.err
    assert "3 errores." in spanish.err


def test_check_prints_json(tsc: Tsc) -> None:
    result = tsc("check", "--json", "-e", "W(1)\n  ñ = 5; F(1,5, 80)").gives(1)
    first_diagnostic, second_diagnostic = json.loads(result.out)
    assert set(first_diagnostic) == {"code", "severity", "line", "column", "end_line", "end_column",
                          "message", "fix"}  # fmt: skip
    place = {key: first_diagnostic[key] for key in ("line", "column", "end_line", "end_column")}
    assert place == {"line": 2, "column": 3, "end_line": 2, "end_column": 4}
    assert (
        second_diagnostic["line"],
        second_diagnostic["column"],
        second_diagnostic["severity"],
    ) == (2, 13, "mistake")
    assert "1.5, 80" in second_diagnostic["fix"]
    assert json.loads(tsc("check", "--json", "-e", PROGRAM).out) == []


def test_many_mistakes_are_cut_short(tsc: Tsc) -> None:
    result = tsc("check", "-e", "".join(f"Q{k}(1);" for k in range(90)))
    assert result.err.count("TS") == 20
    assert "70" in result.err


# -- run ----------------------------------------------------------------------------------------


def test_run_prints_the_trace_and_nothing_else(tsc: Tsc) -> None:
    result = tsc("run", "-e", OBSTACLE, "--sensor", "distance=50,9", "--max-time", "2.5").gives(0)
    assert result.out.splitlines() == [
        "0 MOTORS 80 80", "1000 MOTORS 0 0", "1000 READ DISTANCE 50", "1000 MOTORS 80 80",
        "2000 MOTORS 0 0", "2000 READ DISTANCE 9", "2000 MOTORS 0 0", "2000 MOTORS 60 -60",
        "2500 LIMIT",
    ]  # fmt: skip


def test_run_accepts_an_image_and_standard_input(tsc: Tsc, program: Path) -> None:
    tsc("compile", program)
    result = tsc("run", program.with_suffix(".bin"))
    assert result.out == "0 MOTORS 80 80\n5000 MOTORS 0 0\n5000 DONE\n"
    assert run_in_process("run", "-", data=PROGRAM.encode()).out == result.out
    assert run_in_process("check", "-", data=b"S = 5").code == 1


def test_max_steps_limits_only_steps_that_take_no_time(tsc: Tsc) -> None:
    for text, steps, last_line in (
        ("W(2);LOOP(FOREVER);X = 1;SHOW(X);END_LOOP", "50", "2000 LIMIT"),
        ("X = 0;LOOP(FOREVER);LOOP(20);X = X + 1;END_LOOP;W(0.1);END_LOOP", "100", "60000 LIMIT"),
        ("LOOP(FOREVER);W(0);END_LOOP", "100", "0 LIMIT"),
    ):
        result = tsc("run", "-e", text, "--max-steps", steps)
        assert (result.code, result.out.splitlines()[-1]) == (0, last_line), text


def test_run_is_repeatable_and_seeded(tsc: Tsc) -> None:
    text = "LOOP(5);SHOW(RANDOM(1,1000));END_LOOP"
    unseeded_output = tsc("run", "-e", text).out
    assert unseeded_output == tsc("run", "-e", text, "--seed", "1").out
    assert unseeded_output != tsc("run", "-e", text, "--seed", "2").out


@each_row("arguments", [
    ["--sensor", "DISTANC=5"], ["--sensor", "DISTANCE"], ["--sensor", "DISTANCE="],
    ["--sensor", "=5"], ["--sensor", "DISTANCE=5,,6"], ["--sensor", "DISTANCE=400.001"],
    ["--sensor", "DISTANCE=-1"], ["--sensor", "DISTANCE=TRUE"], ["--sensor", "DISTANCE=1e2"],
    ["--sensor", "DISTANCE=5", "--sensor", "distance=6"], ["--sensor"],
    ["--seed", "0"], ["--seed", "4294967296"], ["--seed", "x"], ["--seed", "9" * 5000],
    ["--max-time", "-1"], ["--max-time", "soon"], ["--max-time", "9" * 5000],
    ["--max-steps", "1.5"], ["--machine", "steam"],
    ["--robot", "nobody"], ["--robot", ""], ["--robot", "/"], ["--robot", "no/such.toml"],
    ["-e", "W(1)"], ["--lang", "fr"], ["--nonsense"], ["another.ts"],
])  # fmt: skip
def test_run_refuses_wrong_use(tsc: Tsc, arguments: list[str]) -> None:
    for language in ([], ["--lang", "es"]):
        tsc("run", "-e", "DISTANCE", *language, *arguments).gives(2, out="")


def test_a_sensor_of_another_robot_is_explained(tsc: Tsc) -> None:
    result = tsc("run", "-e", "SHOW(LINE_L)", "--robot", "LINER", "--sensor", "LINE_L=TRUE")
    assert result.out == "0 READ LINE_L TRUE\n0 SHOW TRUE\n0 DONE\n"
    tsc("run", "-e", "SHOW(LINE_L)", "--robot", "liner", "--sensor", "LINE_L=2").gives(2)


# -- images -------------------------------------------------------------------------------------


@pytest.mark.parametrize("verb", ["run", "show", "upload"])
def test_damaged_images_are_refused_by_name(tsc: Tsc, tmp_path: Path, verb: str) -> None:
    """For an image of 0.1.0, the message gives the next step; code that breaks a rule is refused
    with its number."""
    target = tmp_path / "a.bin"
    tsc("compile", "-e", OBSTACLE, "-o", target)
    image = target.read_bytes()
    for data, word in (
        (image[:-1], "missing"),
        (image + b"x", "longer"),
        (image[:-1] + b"\xff", "damaged"),
        (b"", "not a compiled"),
        (b"SI|F(2,80)", "not a compiled"),
        (bytes.fromhex("54530100000000000300101604fa443250"),
         f"refused: {target} is for version 1.0 of the machine; this is version 2.1. "
         "Compile the program again.\n"),
        (pack("SI", 0, b"\xff"), "21"),
        (pack("SI", 0, b"\x38\x0b"), "24"),  # READ s11
        (pack("SI", 0, b"\x39"), "25"),
    ):  # fmt: skip
        target.write_bytes(data)
        result = tsc(verb, target)
        assert (result.code, result.out) == (1, ""), word
        assert word in result.err


def test_an_image_of_another_robot_names_that_robot(tsc: Tsc, tmp_path: Path) -> None:
    target = tmp_path / "a.bin"
    for text, robot in (("SHOW(LINE_L)", "liner"), ("GRIPPER(30)", "grabber")):
        assert tsc("compile", "-e", text, "-o", target, "--robot", robot).code == 0
        result = tsc("run", target)
        assert result.code == 1
        assert (
            f"is for another robot, not for tinibot. Name the right one:  --robot {robot}"
            in result.err
        )
        assert tsc("run", target, "--robot", robot).code == 0
        assert f"for {robot}" in tsc("show", target).out


# -- show ---------------------------------------------------------------------------------------


def test_show_lists_with_lines(tsc: Tsc, tmp_path: Path) -> None:
    target, text = tmp_path / "a.bin", "SI|\nF(5, 80)\nDISTANCE"
    tsc("compile", "-e", text, "-o", target)
    result = tsc("show", target)
    assert "0000  44 8c 50           MOVE8_F 140 80" in result.out
    assert "line 2: F(5, 80)" in result.out
    assert "READ_2" in result.out
    assert "DISTANCE  line 3: DISTANCE" in result.out
    assert tsc("show", "-e", text).out.split("\n", 1)[1] == result.out.split("\n", 1)[1]


def test_show_prints_json(tsc: Tsc, program: Path) -> None:
    tsc("compile", program)
    known_fields = json.loads(tsc("show", program.with_suffix(".bin"), "--json").out)
    assert (known_fields["code_bytes"], known_fields["image_bytes"], known_fields["start"]) == (
        3,
        18,
        "SI",
    )
    assert known_fields["robot"] is None
    assert [instruction["name"] for instruction in known_fields["instructions"]] == ["MOVE8_F"]
    known_fields = json.loads(tsc("show", "-e", "SB|DISTANCE", "--json").out)
    assert (known_fields["robot"], known_fields["start"]) == ("tinibot", "SB")


# -- fmt and explain ----------------------------------------------------------------------------


def test_fmt_lays_out_in_place(tsc: Tsc, program: Path) -> None:
    program.write_text("si|loop( 3 )\nf(2,50) // go\nendloop", encoding="utf-8")
    assert tsc("fmt", "--check", program).code == 1
    assert tsc("fmt", program).code == 0
    formatted_text = "SI|LOOP(3);\n  F(2, 50);  // go\nEND_LOOP;\n"
    assert program.read_text(encoding="utf-8") == formatted_text
    assert tsc("fmt", "--check", program).code == 0
    assert tsc("fmt", program).out == ""
    assert tsc("fmt", "-e", formatted_text).out == formatted_text


def test_fmt_leaves_wrong_programs_and_those_that_would_become_too_large(
    tsc: Tsc, program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tiniscript.cli.commands.fmt.LARGEST_SOURCE_BYTES", 1000)
    for text, code in (("f(2 80)", 1), ("S\n" * 499, 2)):
        program.write_text(text, encoding="utf-8")
        assert tsc("fmt", program).code == code
        assert program.read_text(encoding="utf-8") == text
    assert tsc("compile", "-e", PROGRAM, "-o", program.with_suffix(".bin")).code == 0
    assert tsc("fmt", program.with_suffix(".bin")).code == 2


def test_explain_prints_the_explanation_of_a_code(tsc: Tsc) -> None:
    result = tsc("check", "--explain", "TS012").gives(0, out="TS012")
    assert tsc("check", "--explain", "ts012", "--lang", "es").out != result.out
    assert tsc("check", "--explain").out.count("\nTS") > 50
    for language, vague in (("en", "another way"), ("es", "otra forma"), ("pt", "outro jeito")):
        # A title names the mistake, not the alternative.
        assert vague not in tsc("check", "--explain", "--lang", language).gives(0, out="TS076").out
    assert tsc("check", "--explain", "TS999").code == 2


def test_a_run_says_which_reading_nobody_has_given_and_how_it_ended(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This holds each time, on either machine."""
    from tiniscript.cli.commands import run

    for count in (1, 2):
        result = tsc("run", "-e", "SI|SHOW(DISTANCE + LIGHT_L)", "--sensor", "DISTANCE=5").gives(0)
        assert "LIGHT_L" in result.err and "DISTANCE" not in result.err, count
        assert tsc("run", "-e", "SI|SHOW(DISTANCE)", "--sensor", "DISTANCE=5").gives(0).err == ""
        tsc("run", "-e", "SI|X = 0;SHOW(1 / X)").gives(1)
    tsc("run", "-e", "SI|S", "--world", "line").gives(2)
    machines: list[object] = []
    monkeypatch.setattr(run, "_cpp_machine", lambda *words: machines.append(words))
    for machine in ("python", "cpp"):
        tsc("run", "-e", "SI|S", "--machine", machine).gives(0)
        assert len(machines) == (machine == "cpp")
