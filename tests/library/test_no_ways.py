"""Moves by centimetres and degrees sent to a robot: which robots support them, and who refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

import tiniscript
from tests.support.command import run_in_process
from tiniscript import robots
from tiniscript.bytecode.image import GO, TASKS
from tiniscript.library.known_kits import missing_need_key
from tiniscript.robots.profile import ProfileRefused
from tiniscript.robots.reader import read
from tiniscript.studio import checking

TEXT = "SHOW(1)\nF(20 CM, 60)\n"
PROFILE = Path(robots.__path__[0]) / "tinibot.toml"


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "way.ts"
    path.write_text(TEXT, encoding="utf-8")
    return path


def profile_without(key: str, text: str) -> str:
    """The profile without a speed; that of its simulated body is needed then."""
    line = f"{key} = {45 if key == 'speed' else 360}\n"
    assert line in text
    text = text.replace(line, "")
    return text.replace("[body]\n", "[body]\nspeed_cm_s = 45\n") if key == "speed" else text


@pytest.fixture
def slow_profile(tmp_path: Path) -> Path:
    """The profile of a robot with unmeasured speeds."""
    path = tmp_path / "slow.toml"
    text = profile_without("turn", profile_without("speed", PROFILE.read_text(encoding="utf-8")))
    path.write_text(text, encoding="utf-8")
    return path


def test_a_robot_without_speeds_refuses_an_image(
    program: Path, slow_profile: Path, tmp_path: Path
) -> None:
    image_file = tmp_path / "way.bin"
    assert "0.741 s" in run_in_process("compile", program, "-o", image_file).out, (
        "the receipt says how long"
    )
    assert image_file.read_bytes()[3] == 1 and image_file.read_bytes()[14] == GO
    result = run_in_process("upload", image_file, "--robot", slow_profile, "--lang", "es")
    assert result.code == 1 and "no puede avanzar por centímetros" in result.err
    assert "tsc run" in result.err
    assert run_in_process("run", image_file).out.endswith("741 DONE\n")


def test_each_missing_feature_has_its_own_text() -> None:
    liner = robots.load("liner")
    assert [missing_need_key(needs, liner) for needs in (0, TASKS, GO, TASKS | GO)] == [
        "", "no_tasks", "", "no_tasks"]  # fmt: skip
    assert [name for name in robots.names() if missing_need_key(TASKS, robots.load(name))] == [
        "liner"
    ]


@pytest.mark.parametrize("robot", robots.names())
def test_all_shipped_robots_have_ways(program: Path, robot: str) -> None:
    profile = robots.load(robot)
    assert not missing_need_key(GO, profile)
    assert (
        missing_need_key(GO, profile._replace(kit=profile.kit._replace(speed=0, turn=0)))
        == "no_ways"
    )
    assert checking.check(TEXT.encode(), robot, "en").image


def test_the_machine_in_cpp_has_ways(program: Path) -> None:
    result = run_in_process("run", "--machine", "cpp", program)
    assert result.code == 0 and result.out == run_in_process("run", program).out
    assert tiniscript.run(TEXT, machine="cpp").events == tiniscript.run(TEXT).events


def test_a_move_without_power_is_explained() -> None:
    for text in ("F(5 CM, 0)", "X = 0; F(5 CM, X + TIME)"):
        result = run_in_process("run", "-e", text, "--lang", "es")
        assert result.code == 1 and result.out == "0 FAULT NO_POWER\n"
        assert "nunca terminaría" in result.err


@pytest.mark.parametrize(("way", "ms"), [("20 CM", "0.741"), ("X CM", "")])
def test_a_sketch_contains_the_time_if_it_is_known(tmp_path: Path, way: str, ms: str) -> None:
    path = tmp_path / "way.ts"
    path.write_text(f"X = 5; F({way}, 60); SHOW(X)", encoding="utf-8")
    result = run_in_process("show", "--arduino", path).gives(0 if ms else 2)
    assert f"forward({ms}, 60);" in result.out if ms else "a move in CM or DEG" in result.err


@pytest.mark.parametrize("key", ["speed", "turn"])
def test_a_profile_may_leave_a_speed_out(key: str) -> None:
    text = PROFILE.read_text(encoding="utf-8")
    line = f"{key} = {45 if key == 'speed' else 360}\n"
    kit = read(profile_without(key, text), "mine").kit
    assert getattr(kit, key) == 0
    assert kit.fingerprint == robots.load("tinibot").kit.fingerprint
    half = read(text.replace(line, f"{key} = 0.5\n"), "mine").kit
    assert getattr(half, key) == 500
    for wrong_speed in ("0", "-1", "20000", '"fast"', "0.0001"):
        with pytest.raises(ProfileRefused):
            read(text.replace(line, f"{key} = {wrong_speed}\n"), "mine")
