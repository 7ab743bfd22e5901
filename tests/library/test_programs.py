"""`import tiniscript`: programs, diagnostics and traces as data, without a robot."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import pytest

import tiniscript
from tests.support.command import OBSTACLE, Tsc
from tests.support.texts import catalogue_texts as all_said
from tiniscript.bytecode.image import REFUSALS, pack
from tiniscript.bytecode.verify import RULES
from tiniscript.library import install_advice

# -- compile, check, show --------------------------------------------------------------------------


def test_a_program_has_the_image_that_tsc_compile_writes(tsc: Tsc, tmp_path: Path) -> None:
    program = tiniscript.compile(OBSTACLE)
    target = tmp_path / "x.bin"
    tsc("compile", "-e", OBSTACLE, "-o", target)
    assert program.image == target.read_bytes()
    assert (program.text, program.robot, program.start) == (OBSTACLE, "tinibot", "SI")
    assert len(program.code) == 14
    assert program.image.endswith(program.code)
    assert program.checksum == int.from_bytes(program.image[10:14], "little")
    assert [diagnostic.code for diagnostic in program.diagnostics] == ["TS805"]


@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize("text", ["SI|F(2, ", "SI|F(0,5, 80);X = 1;Q(3)", "SI|F(2, 80)", "SI|PEN"])
def test_check_agrees_with_tsc_check(tsc: Tsc, text: str, language: str) -> None:
    answer = json.loads(tsc("check", "-e", text, "--json", "--lang", language).out)
    assert [message._asdict() for message in tiniscript.check(text, language=language)] == answer


def test_a_diagnostic_is_data() -> None:
    [message] = tiniscript.check("SI|W(1)\nF(2 80)")
    assert (message.code, message.severity) == ("TS017", "mistake")
    assert (message.line, message.column, message.end_line, message.end_column) == (2, 4, 2, 5)
    assert "," in message.fix


def test_a_program_with_mistakes_is_an_error_that_shows_them() -> None:
    with pytest.raises(tiniscript.ProgramError) as error_info:
        tiniscript.compile("SI|F(2 80);Q", language="es")
    error = error_info.value
    assert error.diagnostics == tuple(tiniscript.check("SI|F(2 80);Q", language="es"))
    assert "línea 1:" in str(error) and "^" in str(error)
    assert error.reason == "mistakes"


def test_devices_of_a_custom_robot_can_be_used(tmp_path: Path) -> None:
    shipped = Path(tiniscript.__file__).parent / "robots" / "tinibot.toml"
    profile = tmp_path / "mine.toml"
    profile.write_text(shipped.read_text("utf-8").replace("DISTANCE", "EYES"), encoding="utf-8")
    program = tiniscript.compile("SHOW(EYES)", robot=profile)
    assert program.robot == "mine"
    trace = tiniscript.run(program, sensors={"eyes": 7.5})
    assert trace.events[0].values == {"sensor": "EYES", "value": 7.5}
    assert tiniscript.check("SHOW(EYES)")[0].severity == "mistake"


def test_a_listing_is_that_of_tsc_show(tsc: Tsc) -> None:
    _, listing = tsc("show", "-e", OBSTACLE).out.split("\n", 1)
    assert tiniscript.show(OBSTACLE) == tiniscript.compile(OBSTACLE).listing() == listing
    # an image that was never compiled here has no lines of a text
    assert "DISTANCE" in tiniscript.show(tiniscript.compile("SHOW(DISTANCE+1)").image)


def test_a_lone_surrogate_is_a_mistake() -> None:
    assert tiniscript.check("F(1, \ud800)")[0].severity == "mistake"
    assert tiniscript.check("F(1, 2)\0")[0].code == "TS002"


# -- run -------------------------------------------------------------------------------------------

PROGRAM = "SI|F(1, 80);SHOW(DISTANCE);SHOW(DISTANCE > 10);BEEP(0.1, 440);SHOW(1.5)"


@pytest.mark.parametrize("machine", ["python", "cpp"])
def test_a_trace_is_that_of_tsc_run(tsc: Tsc, machine: Any) -> None:
    trace = tiniscript.run(PROGRAM, sensors={"DISTANCE": [50, 9]}, machine=machine)
    assert str(trace) == tsc("run", "-e", PROGRAM, "--sensor", "DISTANCE=50,9").out
    assert (trace.ending, trace.fault, trace.ms) == ("DONE", None, 1100)
    assert [(event.ms, event.name, event.values) for event in trace.events] == [
        (0, "MOTORS", {"left": 80, "right": 80}),
        (1000, "MOTORS", {"left": 0, "right": 0}),
        (1000, "READ", {"sensor": "DISTANCE", "value": 50}),
        (1000, "SHOW", {"value": 50}),
        (1000, "READ", {"sensor": "DISTANCE", "value": 9}),
        (1000, "SHOW", {"value": False}),
        (1000, "BEEP", {"hertz": 440, "ms": 100}),
        (1100, "SHOW", {"value": 1.5}),
        (1100, "DONE", {}),
    ]


def test_values_are_numbers_or_yes_and_no() -> None:
    trace = tiniscript.run("SHOW(1 > 0);SHOW(1);SHOW(-0.5);GRIPPER(30)", "grabber")
    values = [event.values["value"] for event in trace.events if "value" in event.values]
    assert [(type(value), value) for value in values] == [
        (bool, True), (int, 1), (float, -0.5), (int, 30)]  # fmt: skip


def test_a_fault_has_its_place_and_a_limited_run_its_end() -> None:
    trace = tiniscript.run("SI|X = 0\nSHOW(1 / X)")
    assert (trace.ending, trace.events[-1].name) == ("FAULT", "FAULT")
    assert trace.fault is not None
    assert (trace.fault.name, trace.fault.line, trace.fault.column) == ("DIVIDE_BY_ZERO", 2, 1)
    forever = "LOOP(FOREVER);W(1);END_LOOP"
    trace = tiniscript.run(forever, max_time=2.5)
    assert (trace.ending, trace.ms) == ("LIMIT", 2500)
    assert tiniscript.run("LOOP(FOREVER);X = 1;END_LOOP", max_steps=500).steps == 500


def test_a_run_is_limited_like_in_tsc_run(tsc: Tsc) -> None:
    """A long calculation ends in both, and a loop that takes no time is cut."""
    for count, ending in (("900000", "DONE"), ("FOREVER", "LIMIT")):
        text = f"N = 0;LOOP({count});N = 1;END_LOOP;SHOW(1)"
        trace = tiniscript.run(text, machine="cpp")
        assert str(trace) == tsc("run", "-e", text, "--machine", "cpp").gives(0).out
        assert trace.ending == ending


def test_a_seed_makes_a_run_repeat() -> None:
    def run_random_program(seed: int) -> str:
        return str(tiniscript.run("LOOP(5);SHOW(RANDOM(1, 1000));END_LOOP", seed=seed))

    assert run_random_program(5) == run_random_program(5) != run_random_program(6)


@pytest.mark.parametrize("make", [lambda image: image, tiniscript.compile], ids=["text", "program"])
def test_texts_programs_and_images_can_be_run(make: Callable[[str], Any]) -> None:
    expected = tiniscript.run(PROGRAM, sensors={"DISTANCE": 3})
    assert tiniscript.run(make(PROGRAM), sensors={"DISTANCE": 3}) == expected
    image = tiniscript.compile(PROGRAM).image
    assert str(tiniscript.run(image, sensors={"DISTANCE": 3})) == str(expected)


def test_an_image_runs_on_the_robot_whose_kit_it_has() -> None:
    image = tiniscript.compile("GRIPPER(30)", "grabber").image
    assert tiniscript.run(image).events[0].values == {"actuator": "GRIPPER", "value": 30}
    with pytest.raises(tiniscript.ProgramError, match="OTHER_KIT"):
        tiniscript.run(image, "tinibot")
    with pytest.raises(tiniscript.ProgramError, match="OTHER_KIT"):
        tiniscript.run(tiniscript.compile("GRIPPER(30)", "grabber"), "tinibot")


def test_a_damaged_image_is_refused() -> None:
    image = bytearray(tiniscript.compile(PROGRAM).image)
    image[-1] ^= 1
    with pytest.raises(tiniscript.ProgramError) as error_info:
        tiniscript.run(bytes(image))
    assert (error_info.value.reason, error_info.value.diagnostics) == ("DAMAGED", ())
    with pytest.raises(tiniscript.ProgramError) as error_info:
        tiniscript.run(pack("SI", 0, b"\xff"))  # whole, and no code
    assert error_info.value.reason in RULES


@pytest.mark.parametrize("language", ["en", "es"])
def test_messages_about_bytes_name_no_absent_robot(
    language: Literal["en", "es"],
) -> None:
    whole_image = tiniscript.compile(PROGRAM).image
    for image, reason in {
        b"xx": "NOT_AN_IMAGE", b"": "NOT_AN_IMAGE",
        whole_image[:-1]: "TRUNCATED", whole_image + b"?": "TRAILING",
        b"TS\xff" + whole_image[3:]: "OTHER_VERSION", pack("SI", 0, b"\xff"): "",
    }.items():  # fmt: skip
        with pytest.raises(tiniscript.ProgramError) as error_info:
            tiniscript.show(image, language=language)
        message = str(error_info.value)
        assert error_info.value.reason == reason or not reason
        assert error_info.value.reason in message
        assert "robot" not in message.lower()
        assert ("ompila" if language == "es" else "ompile") in message
    assert set(REFUSALS) <= set(all_said("en", "library"))


# The library's sentences about a robot are those of the command's catalogue.
SHARED = (
    "link_echo", "not_confirmed", "not_saved", "port_broken", "port_forbidden",
    "port_forbidden_linux", "port_missing", "port_no_multicast", "port_not_announced",
    "port_not_found", "port_not_found_but", "port_not_installed", "port_radio_broken",
    "port_radio_forbidden", "port_radio_off", "port_radio_service", "port_several", "port_slow",
    "port_unreachable",
)  # fmt: skip


@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_messages_in_the_library_do_not_mention_command_options(
    language: str,
) -> None:
    values = {"port": "COM5", "why": "broken", "how": "pip"}
    for reason in SHARED:
        message = str(tiniscript.RobotError(reason, language, values))
        assert "tsc" not in message, message
        assert "--" not in message, message
        assert message[0].isupper() or message.startswith("COM5"), message
    assert not set(SHARED) & set(all_said("en", "library"))


# -- wrong use -------------------------------------------------------------------------------------

MISUSES: dict[str, Callable[[], object]] = {
    "bad_program": lambda: tiniscript.run(5),  # type: ignore[arg-type]
    "bad_robot": lambda: tiniscript.compile("F(1,2)", robot=3),  # type: ignore[arg-type]
    "profile_refused": lambda: tiniscript.compile("F(1,2)", robot="tinbot"),
    "no_sensor": lambda: tiniscript.run("F(1,2)", sensors={"EYES": 1}),
    "bad_readings": lambda: tiniscript.run("F(1,2)", sensors={"DISTANCE": []}),
    "bad_reading": lambda: tiniscript.run("F(1,2)", sensors={"DISTANCE": [1e300]}),
    "bad_number": lambda: tiniscript.run("F(1,2)", max_time=float("nan")),
    "bad_choice": lambda: tiniscript.run("F(1,2)", machine="perl"),  # type: ignore[arg-type]
    "bad_language": lambda: tiniscript.check("F(1,2)", language="fr"),
    "bad_port": lambda: tiniscript.connect(" "),
}


@pytest.mark.parametrize("reason", MISUSES)
def test_wrong_use_raises_an_error_with_a_message(reason: str) -> None:
    with pytest.raises(tiniscript.UsageError) as error_info:
        MISUSES[reason]()
    assert error_info.value.reason == reason
    assert isinstance(error_info.value, ValueError)
    assert str(error_info.value).endswith((".", "]"))
    assert "{" not in str(error_info.value)
    if reason == "bad_choice":
        assert str(error_info.value) == "machine must be python or cpp, not 'perl'."


@pytest.mark.parametrize(
    "arguments",
    [{"seed": 0}, {"seed": 1.5}, {"seed": True}, {"max_time": -1}, {"max_steps": "9"},
     {"sensors": {"DISTANCE": "50"}}, {"sensors": {"DISTANCE": True}},
     {"sensors": {"DISTANCE": [None]}}],
    ids=str,
)  # fmt: skip
def test_arguments_out_of_their_range_are_refused(arguments: Any) -> None:
    with pytest.raises(tiniscript.UsageError):
        tiniscript.run("F(1, 2)", **arguments)


# -- the package -----------------------------------------------------------------------------------


def test_every_public_name_exists_and_is_documented() -> None:
    for name in tiniscript.__all__:
        value = getattr(tiniscript, name)
        assert value.__doc__, name
        assert name in dir(tiniscript)
    with pytest.raises(AttributeError):
        _ = tiniscript.conect  # type: ignore[attr-defined]


def test_the_library_prints_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    tiniscript.run(PROGRAM)
    tiniscript.check("SI|F(2")
    with pytest.raises(tiniscript.ProgramError):
        tiniscript.show("SI|F(2")
    assert capfd.readouterr() == ("", "")


def test_the_package_is_typed(tmp_path: Path) -> None:
    """mypy --strict checks a user's program: a typo is an error."""
    pytest.importorskip("mypy")
    program = tmp_path / "use.py"
    program.write_text(
        "import tiniscript\n"
        "def main() -> None:\n"
        "    program: tiniscript.Program = tiniscript.compile('SI|F(1, 2)')\n"
        "    trace = tiniscript.run(program, sensors={'DISTANCE': [50, 9]})\n"
        "    reveal_type(trace.ending)\n"
        "    with tiniscript.virtual_robot() as robot:\n"
        "        reveal_type(robot)\n"
        "        reveal_type(robot.wait(5).fault)\n"
        "    tiniscript.conect()\n",
        encoding="utf-8",
    )
    completed = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--follow-imports=silent",
         "--config-file=", str(program)],
        capture_output=True, text=True, cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(Path(tiniscript.__file__).parent.parent)},
    )  # fmt: skip
    types = [line.split(": ", 1)[1] for line in completed.stdout.splitlines() if "use.py" in line]
    assert types == [
        "note: Revealed type is \"Literal['DONE'] | Literal['FAULT'] | Literal['LIMIT']\"",
        'note: Revealed type is "tiniscript.library.simulated.VirtualRobotConnection"',
        'note: Revealed type is "tuple[str, int, int | None, int | None,'
        ' fallback=tiniscript.library.runs.Fault] | None"',
        'error: Module has no attribute "conect"; maybe "connect"?  [attr-defined]',
    ]


def test_a_missing_wasmtime_is_reported_with_the_next_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "wasmtime", None)
    for module in ("vm.wasm_store", "vm.wasm"):
        monkeypatch.delitem(sys.modules, f"tiniscript.{module}", raising=False)
    with pytest.raises(tiniscript.UsageError) as exception_info:
        tiniscript.run("W(1)", machine="cpp", language="es")
    assert install_advice.command("virtual") in str(exception_info.value)


def test_a_program_may_be_a_file(tmp_path: Path) -> None:
    path = tmp_path / "drive.ts"
    path.write_text("\ufeffSI|SHOW(7)\r\n", encoding="utf-8")
    image_file = tmp_path / "drive.bin"
    image_file.write_bytes(tiniscript.compile("SI|SHOW(7)").image)
    assert str(tiniscript.run(path)) == str(tiniscript.run(image_file)) == str(
        tiniscript.run("SI|SHOW(7)")
    )  # fmt: skip
    for name in (str(path), str(image_file)):
        for use in (tiniscript.run, tiniscript.compile):
            with pytest.raises(tiniscript.UsageError) as error_info:
                use(name)
            assert error_info.value.reason == "file_name" and "drive" in str(error_info.value)
    with pytest.raises(tiniscript.UsageError) as error_info:
        tiniscript.run(tmp_path / "none.ts")
    assert error_info.value.reason == "unreadable"


VALUES = """SI|
DEF SIDE(SIZE, SPEED); F(SIZE CM, SPEED); END_DEF
DEF PAUSE(LONG); W(LONG); END_DEF
TASK; LOOP(FOREVER); PAUSE(1); END_LOOP; END_TASK
N = 2
LOOP(N); SIDE(30, 60); N = N + 1; END_LOOP
PAUSE(N)
IF(N > 3); SHOW(N); END_IF
"""


def test_a_listing_names_each_variable_as_the_text_does() -> None:
    words_by_number: dict[str, set[str]] = {}
    for line in tiniscript.compile(VALUES).listing().splitlines():
        instruction, _, remark = line[25:].partition(" ; ")
        if "VAR" in instruction:
            number = re.findall(r"[0-9]+", instruction.replace("VAR8", "").replace("VAR16", ""))[0]
            words_by_number.setdefault(number, set()).add(remark.split()[0])
    # SIDE's values, those of PAUSE for the program and for the task, and N
    assert sorted(words_by_number.values(), key=min) == [
        {"LONG"},
        {"LONG"},
        {"N"},
        {"SIZE"},
        {"SPEED"},
    ]
