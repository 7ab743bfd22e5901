"""The remote control as programs read it, and kit words that give way to names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.machines.text_reader import NO_DEFS, TextReader
from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.released_programs import released_programs
from tiniscript import robots
from tiniscript.base import kit as kits
from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import KIT_WORDS_SINCE, NUMBER, REMOTE, YES_NO, Device, Kit
from tiniscript.base.trace import Senses
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.bytecode.image import ImageRefused, unpack
from tiniscript.bytecode.verify import Refused, load_image
from tiniscript.codegen.text.line import plain_code
from tiniscript.diagnostics import codes
from tiniscript.library.compiling import Compilation, compile_text, fit_to_robot
from tiniscript.library.runs import run
from tiniscript.studio import block_reading
from tiniscript.vm.runner import run as run_code
from tiniscript.vm.tasks import machine_of

TINIBOT = robots.load("tinibot").kit
NAMES = [device.name for device in REMOTE]
OWN_NAME = "OWN_NAME"


def kit_of(count: int) -> Kit:
    """Return a kit with so many sensors and one lamp."""
    sensors = tuple(Device(f"S{k}", YES_NO, "", 0, 1) for k in range(count))
    return Kit(sensors, (Device("LAMP", YES_NO, "", 0, 1),))


def codes_of(compilation: Compilation) -> list[str]:
    return [diagnostic.code.number for diagnostic in compilation.diagnostics]


# -- older programs and the remote control ---------------------------------------------------------


def test_the_contract_has_eight_readings_in_this_order() -> None:
    keys = ["KEY_UP", "KEY_DOWN", "KEY_LEFT", "KEY_RIGHT", "KEY_A", "KEY_B"]
    assert [*keys, "PAD_X", "PAD_Y"] == NAMES
    assert [device.is_yes_no for device in REMOTE] == [True] * 6 + [False] * 2
    assert {(device.low, device.high) for device in REMOTE[6:]} == {(-100 * ONE, 100 * ONE)}


def test_a_program_without_remote_readings_has_an_unchanged_image(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Byte for byte that of a robot without a remote control."""
    texts = [
        released
        for released in released_programs()
        if not re.search("(?i)KEY_|PAD_", released.text)
    ]
    assert len(texts) > 300

    def images() -> list[tuple[bytes, bytes]]:
        image_pairs = []
        for released in texts:
            compilation = compile_text(released.text, robots.load(released.robot).kit)
            plain = b"" if compilation.program is None else plain_code(compilation.program).code
            image_pairs.append((compilation.image, plain if compilation.is_right else b""))
        return image_pairs

    now = images()
    assert sum(map(bool, now)) > 300
    monkeypatch.setattr(kits, "MAX_SENSORS_BESIDE_REMOTE", -1)
    assert TINIBOT.readings == TINIBOT.sensors
    assert images() == now


# -- where they are -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", robots.names())
def test_remote_readings_follow_the_sensors_of_each_robot(name: str) -> None:
    kit = robots.load(name).kit
    compilation = compile_text("; ".join(f"SHOW({name})" for name in NAMES), kit)
    assert compilation.is_right and compilation.verdict is not None
    first = len(kit.sensors)
    uses = dict.fromkeys(compilation.verdict.uses)
    assert [*uses] == [("sensor", first + k) for k in range(8)]
    rows = [row.partition(" ; ")[2] for row in disassemble(compilation.code, kit=kit).splitlines()]
    assert [*dict.fromkeys(row for row in rows if row)] == NAMES


@pytest.mark.parametrize("count", [0, 1, 7, 8])
def test_a_kit_with_room_has_remote_readings_on_both_machines(count: int) -> None:
    from tiniscript.vm.wasm import WasmImage

    kit = kit_of(count)
    compilation = compile_text("LAMP(KEY_B);SHOW(PAD_Y)", kit)
    assert compilation.is_right, codes_of(compilation)
    senses = {count + 5: [1], count + 7: [-3 * ONE]}
    expected = [
        "0 READ KEY_B TRUE", "0 SET LAMP TRUE", "0 READ PAD_Y -3", "0 SHOW -3", "0 DONE",
    ]  # fmt: skip
    code = unpack(compilation.image).code
    for machine in (machine_of, WasmImage(compilation.image, kit).machine):
        *events, _ = run_code(code, kit, Senses(kit, senses), machine_of=machine)
        assert [str(event) for event in events] == expected


@pytest.mark.parametrize("count", [9, 16, 32])
def test_a_kit_without_room_has_no_remote_readings(count: int) -> None:
    kit = kit_of(count)
    assert kit.readings == kit.sensors and kit.hashes == kit_of(count).hashes
    for name in NAMES:
        assert codes_of(compile_text(f"SHOW({name})", kit)) == [codes.UNKNOWN_NAME.number]
        compilation = compile_text(f"{name} = 1;SHOW({name})", kit)
        assert compilation.is_right and not compilation.diagnostics


@pytest.mark.parametrize(("more", "is_told"), [(5, False), (6, True)])
def test_the_check_of_a_profile_reports_missing_room(
    tsc: Tsc, tmp_path: Path, more: int, is_told: bool
) -> None:
    text = (Path(robots.__file__).parent / "grabber.toml").read_text(encoding="utf-8")
    more_sensors = "".join(
        f'[[kit.sensors]]\nname = "S{k}"\nkind = "yes/no"\n\n' for k in range(more)
    )
    wired = (f'[board.sensors.S{k}]\ndriver = "digital"\npin = {36 + k}\n' for k in range(more))
    path = tmp_path / "my.toml"
    profile = text.replace("[[kit.sensors]]", f"{more_sensors}[[kit.sensors]]", 1)
    path.write_text("\n".join([profile, *wired]), encoding="utf-8")
    result = tsc("firmware", "--board", path, "-o", tmp_path / "own.h")
    assert result.code == 0 and ("more than 8 sensors" in result.err) == is_told, result
    header = (tmp_path / "own.h").read_text(encoding="utf-8")
    (hashes,) = re.findall(r"(?s)kDeviceHashes\[\].*?\};", header)
    count = hashes.count("0x")
    assert count == 3 + more + 2 + (0 if is_told else 8)


@pytest.mark.parametrize("is_actuator", [False, True])
def test_a_word_of_the_profile_keeps_its_meaning(is_actuator: bool) -> None:
    """A robot of before may have a sensor or a lamp that is called so."""
    device = Device("KEY_A", YES_NO, "", 0, 1)
    kit = Kit((), (device,)) if is_actuator else Kit((device,))
    compilation = compile_text("KEY_A(TRUE)" if is_actuator else "SHOW(KEY_A)", kit)
    assert compilation.is_right and compilation.verdict is not None
    assert compilation.verdict.uses == (("actuator" if is_actuator else "sensor", 0),)
    expected_code = codes.ACTUATOR_SET if is_actuator else codes.SENSOR_SET
    assert codes_of(compile_text("KEY_A = TRUE", kit)) == [expected_code.number]
    other_compilation = compile_text("SHOW(KEY_B)", kit)
    assert other_compilation.verdict is not None
    assert other_compilation.verdict.uses == (("sensor", 5 if is_actuator else 6),)


def test_an_image_whose_numbers_have_other_meanings_is_refused() -> None:
    image = compile_text("SHOW(KEY_UP)", TINIBOT).image
    assert load_image(image, TINIBOT).devices == TINIBOT.hashes[3]
    with pytest.raises(ImageRefused, match="OTHER_KIT"):
        load_image(image, robots.load("liner").kit)  # on liner this number is BATTERY
    with pytest.raises(Refused, match="NO_SUCH_DEVICE"):
        load_image(compile_text("SHOW(PAD_Y)", TINIBOT).image, kit_of(9))


# -- names of before ----------------------------------------------------------------------------

SHADOWING_PROGRAMS = {
    "a variable": "{n} = 3;LOOP({n});S;END_LOOP",
    "set in a DEF": "DEF DO_IT;{n} = 3;SHOW({n});END_DEF;DO_IT;SHOW({n})",
    "set where nothing comes": "IF(FALSE);{n} = 3;ENDIF;SHOW({n})",
    "set in a task": "TASK;{n} = TRUE;LED_IS = {n};SHOW(LED_IS);END_TASK",
    "over two lines": "SI|{n} = (1 +\n 2)\nSHOW({n})",
    "after a note that names it": "// {n} is mine\n{n} = 3;SHOW({n})",
    "a DEF": "DEF {n};S;END_DEF;{n}",
    "a DEF with a value": "DEF {n}(A);SHOW(A);END_DEF;{n}(2)",
    "a value of a DEF": "DEF DO_IT({n});{n} = {n} + 1;SHOW({n});END_DEF;DO_IT(3)",
    "the last value of a DEF": "DEF DO_IT(A,\n {n});SHOW(A - {n});END_DEF;DO_IT(3, 4)",
    "a value of two DEFs": "DEF ONE({n});SHOW({n});END_DEF;DEF TWO({n});ONE({n});END_DEF;TWO(3)",
}
REFUSED_PROGRAMS = {
    "asked before": ("IF({q});S;ENDIF;{n} = 0", [codes.SENSOR_SET]),
    "a reading before": ("{n};{n} = 0", [codes.SENSOR_SET]),
    "watched before": ("F(1, 50) UNTIL({q});{n} = 0", [codes.SENSOR_SET]),
    "set with itself": ("{n} = {n}", [codes.SENSOR_SET]),
    "set with itself on the next line": ("{n} = (\n{n})", [codes.SENSOR_SET]),
    "asked, then a DEF": ("SHOW({n});DEF {n};S;END_DEF", [codes.NAME_TAKEN]),
    "asked, then a value": (
        "SHOW({n});DEF DO_IT({n});SHOW({n});END_DEF;DO_IT(1)", [codes.PARAMETER_TAKEN],
    ),
}  # fmt: skip


def fill_in_name(text: str, name: str) -> str:
    question = name if name.startswith("KEY") else f"{name} > 0"
    return text.format(n=name, q=question)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("role", SHADOWING_PROGRAMS)
def test_programs_that_compiled_before_still_compile(role: str, name: str) -> None:
    """There is a warning where the name first appears, and the code is that of any other name."""
    text = fill_in_name(SHADOWING_PROGRAMS[role], name)
    compilation = compile_text(text, TINIBOT)
    assert compilation.is_right, codes_of(compilation)
    warned_diagnostics = [
        diagnostic for diagnostic in compilation.diagnostics if diagnostic.code is codes.GIVES_WAY
    ]
    place = re.search(rf"{name}", re.sub("//.*", lambda it: " " * len(it[0]), text))
    assert place is not None
    assert [diagnostic.span for diagnostic in warned_diagnostics] == [place.span()]
    assert warned_diagnostics[0].values["since"] == KIT_WORDS_SINCE[name] == "0.3"
    assert compilation.image == compile_text(text.replace(name, OWN_NAME), TINIBOT).image
    assert compile_text(text.lower(), TINIBOT).image == compilation.image


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("role", REFUSED_PROGRAMS)
def test_previously_invalid_names_are_remote_readings(role: str, name: str) -> None:
    text, expected_codes = REFUSED_PROGRAMS[role]
    compilation = compile_text(fill_in_name(text, name), TINIBOT)
    assert codes_of(compilation) == [code.number for code in expected_codes]


@pytest.mark.parametrize("name", ["DISTANCE", "LIGHT_L"])
def test_a_word_of_0_2_0_never_gives_way(name: str) -> None:
    mistakes = {"a variable": codes.SENSOR_SET, "a DEF": codes.NAME_TAKEN,
                "a value of a DEF": codes.PARAMETER_TAKEN}  # fmt: skip
    for role, code in mistakes.items():
        assert code.number in codes_of(
            compile_text(SHADOWING_PROGRAMS[role].format(n=name), TINIBOT)
        )


def test_a_shadowed_name_belongs_to_the_whole_program() -> None:
    compilation = compile_text(
        "DEF DO_IT(KEY_A);SHOW(KEY_A);END_DEF;DO_IT(1);IF(KEY_A);S;ENDIF", TINIBOT
    )
    assert codes_of(compilation) == [codes.UNKNOWN_NAME.number]
    compilation = compile_text("KEY_A = 1;IF(KEY_B);SHOW(KEY_A);ENDIF", TINIBOT)
    assert (
        compilation.is_right
        and compilation.verdict is not None
        and compilation.verdict.uses == (("sensor", 8),)
    )


@pytest.mark.parametrize("flags", [(), NO_DEFS])
def test_a_robot_reads_the_names_like_tsc(flags: tuple[str, ...]) -> None:
    """Each role, each name: the reader makes the code that the model has, or refuses it, too."""
    reader = TextReader(TINIBOT, flags=flags)
    texts = [*SHADOWING_PROGRAMS.values(), *(text for text, _ in REFUSED_PROGRAMS.values()),
             "SHOW({n})", "{n}", "W(1) UNTIL({q})", "{n} = 0;SHOW({n} + 1);{n} = 3"]  # fmt: skip
    read_count = 0
    for text in (fill_in_name(text, name) for text in texts for name in NAMES):
        if flags and ("DEF" in text or "TASK" in text):
            continue
        compilation = compile_text(text, TINIBOT)
        answer = reader.read(text.encode())
        assert answer.is_program == compilation.is_right, (text, answer)
        if compilation.is_right:
            assert compilation.program is not None
            assert answer.code == plain_code(compilation.program).code, text
            read_count += 1
    assert read_count > (20 if flags else 50)


@pytest.mark.parametrize(
    ("text", "kind"), [("SHOW(KEY_A)", "SENSOR"), ("KEY_A = 1;SHOW(KEY_A)", "NAME")]
)
def test_a_shadowed_name_has_a_variable_block(text: str, kind: str) -> None:
    show = block_reading.read_blocks(text, TINIBOT).body[-1]
    assert show.values == (((kind, "KEY_A"),),)


# -- the command --------------------------------------------------------------------------------


def test_a_run_uses_remote_readings(tsc: Tsc) -> None:
    text = "WHILE(NOT KEY_UP);SHOW(PAD_X);W(0.1);END_WHILE"
    result = tsc("run", "-e", text, "--sensor", "KEY_UP=FALSE,TRUE", "--sensor", "pad_x=-12.5")
    expected = ["READ KEY_UP FALSE", "READ PAD_X -12.5", "SHOW -12.5"]
    assert result.out.split("\n")[:-1] == [
        *(f"0 {row}" for row in expected), "100 READ KEY_UP TRUE", "100 DONE",
    ]  # fmt: skip
    tsc("run", "-e", text, "--sensor", "PAD_X=101").gives(2, "-100 to 100")
    tsc("run", "-e", text, "--sensor", "KEY_UPP=TRUE").gives(2, "KEY_UP")


def test_a_sketch_has_no_remote_control(tsc: Tsc) -> None:
    tsc("show", "--arduino", "-e", "SHOW(KEY_A)").gives(2, "no remote control")
    assert tsc("show", "--arduino", "-e", "KEY_A = 1;SHOW(KEY_A)").code == 0


@pytest.mark.parametrize(("robot", "has_room"), [
    ("tinibot", True), ("grabber", True), ("liner", True), ("tinibot2", False), ("tinibot32", True),
])  # fmt: skip
def test_a_robot_without_room_is_reported_before_anything_is_sent(
    tsc: Tsc, robot: str, has_room: bool
) -> None:
    """This is an Uno with discs; commands that send nothing accept the program."""
    text = "SHOW(1)\nF(1, 50) UNTIL(KEY_A)\n"
    arguments = ("-e", text, "--robot", robot)
    for sends in (["compile", "--text"], ["upload", "--virtual"]) if not has_room else []:
        result = tsc(*sends, *arguments)
        assert result.code == 1 and "TS319" in result.err + result.out
        assert "line 2:" in result.err + result.out
    for verb in (["check"], ["show"], ["run", "--max-time", "0.1"]):
        assert tsc(*verb, *arguments).code == 0
    profile = robots.load(robot)
    compilation = fit_to_robot(compile_text(text, profile.kit), profile)
    assert compilation.is_right == has_room and bool(compilation.image) == has_room
    mine = fit_to_robot(compile_text("KEY_A = 1;SHOW(KEY_A)", profile.kit), profile)
    assert mine.is_right and mine.image


def test_the_example_runs_and_matches_the_documents() -> None:
    text = (ROOT / "examples" / "remote.ts").read_text(encoding="utf-8")
    shown_trace = run(text, sensors={"PAD_Y": 60, "PAD_X": [0, 20], "KEY_A": [False, True, False]},
                max_time=0.06)  # fmt: skip
    assert str(shown_trace).split("\n")[:-1] == [
        "0 READ PAD_Y 60", "0 READ PAD_X 0", "0 MOTORS 60 60", "0 READ KEY_A FALSE",
        "20 READ KEY_A TRUE", "20 BEEP 440 200", "50 READ PAD_Y 60", "50 READ PAD_X 20",
        "50 MOTORS 80 40", "60 LIMIT",
    ]  # fmt: skip
    image = compile_text(text, TINIBOT).image
    pages = [*(ROOT / "docs").glob("*/language.md")]
    assert len(pages) == 3
    for path in pages:
        (shown_there,) = re.findall(r"```tiniscript\n(.*PAD_Y(?s:.*?))```", path.read_text("utf-8"))
        assert compile_text(shown_there, TINIBOT).image == image


def test_a_stick_at_rest_may_be_compared() -> None:
    """At rest it reads exactly 0, and hardly ever any other number."""
    template = "LOOP(FOREVER);IF(PAD_X = {});SHOW(1);ENDIF;W(1);END_LOOP"
    assert not compile_text(template.format(0), TINIBOT).diagnostics
    assert codes_of(compile_text(template.format(50), TINIBOT)) == [codes.EXACT.number]
    assert REMOTE[-1].kind == NUMBER
