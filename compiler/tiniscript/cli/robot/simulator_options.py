"""The options of the virtual robot: its world, its noise and seed, its speed and its picture."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tiniscript.cli import outputs
from tiniscript.cli.errors import CommandError, missing_package_error
from tiniscript.cli.inputs import printable_name, refusal
from tiniscript.cli.options import decimal, sensor_lists, thousandths, whole_number
from tiniscript.cli.texts import text
from tiniscript.cli.texts.options import virtual_names
from tiniscript.robots.profile import Robot
from tiniscript.virtual import worlds
from tiniscript.virtual.module import NoWebAssembly
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.world import World, WorldRefused

ONE = 1000  # thousandths
MAX_NOISE = 50 * ONE  # percent
MAX_FAULTS = 200 * ONE  # most faults in 1000 bytes
MAX_HURRY = 10_000 * ONE
LONGEST_S = 1_000_000 * ONE
MOTOR_LOW, MOTOR_HIGH = 10 * ONE, 200 * ONE  # percent


def needs_own_robot(options: Namespace) -> bool:
    """Return whether an option needs a virtual robot of this command."""
    return any(getattr(options, name, None) not in (None, []) for name in virtual_names())


def make_robot(
    options: Namespace,
    profile: Robot,
    language: str,
    memory: bytes | None = None,
    baud: int | None = None,
) -> VirtualRobot:
    """Return the robot in its world. Raises CommandError."""
    check_picture(options)
    world = world_of(options, language)
    seed = whole_number("--seed", options.seed, 1, 1, 2**32 - 1, language)
    noise = number("--noise", options.noise, 0, 0, MAX_NOISE, language) / 100
    motors = _motors(options.motors, language)
    reading_lists = sensor_lists(options.sensor, profile, language)
    settings = Settings(
        seed=seed, noise=noise, motors=motors, given_readings=reading_lists, baud=baud
    )
    with convert_refusal(world.name, language):
        return VirtualRobot(profile.with_language(language), world, settings, memory)


@contextmanager
def convert_refusal(world: str, language: str) -> Iterator[None]:
    """Raise CommandError if a world is refused, or something that a virtual robot needs is
    missing."""
    try:
        yield
    except NoWebAssembly as error:
        raise missing_package_error("virtual_needs_wasmtime", error) from None
    except WorldRefused as error:
        raise refusal(error, language, "world_refused", file=printable_name(world)) from None


def world_of(options: Namespace, language: str) -> World:
    """Return the world that `--world` names, or the default one."""
    name = worlds.DEFAULT if options.world is None else options.world
    with convert_refusal(name, language):
        return worlds.load(name)


def hurry_of(options: Namespace, language: str) -> float:
    """Return the speed as a multiple of real time; 0 is as fast as possible."""
    if options.hurry == "max":
        return 0.0
    if options.hurry is not None and decimal(options.hurry) is None:
        raise CommandError(2, "bad_hurry", found=printable_name(options.hurry) or "''")
    return number("--hurry", options.hurry, ONE, ONE // 10, MAX_HURRY, language)


def faults_of(options: Namespace, language: str) -> float:
    return number("--faults", options.faults, 0, 0, MAX_FAULTS, language)


def end_ms(options: Namespace, language: str) -> int | None:
    """Return the end in milliseconds of the robot's time, or None."""
    typed_value = getattr(options, "for")
    if typed_value is None:
        return None
    return round(number("--for", typed_value, 0, ONE // 10, LONGEST_S, language) * 1000)


def check_picture(options: Namespace) -> None:
    """Refuse `--plot` early if no picture can be drawn; `paths` has checked the file."""
    if options.plot is None:
        return
    try:
        import PIL.Image  # noqa: F401
    except ImportError as error:
        raise missing_package_error("plot_needs_pillow", error) from None


def draw_picture(options: Namespace, robot: VirtualRobot, language: str) -> None:
    """Write the world and the way into the file of `--plot`."""
    from tiniscript.virtual.picture import png

    driving = robot.driving
    label = robot.profile.labels[language]["robot"]
    title = f"{label} - {robot.world.labels[language]}"
    image = png(robot.world, driving.hull, driving.corners, robot.pose, title, driving.rivals)
    outputs.write(Path(options.plot), image, "unwritable_at --plot")


def summary(
    options: Namespace, robot: VirtualRobot, language: str, passed_ms: int | None = None
) -> str:
    """Return the summary of the run, of the robot's whole time or of `passed_ms`."""
    driving = robot.driving
    passed_ms = robot.now_ms if passed_ms is None else passed_ms
    key = {0: "drove", 1: "drove_touching_once"}.get(driving.bumps, "drove_touching")
    summary_text = text(key, language).format(
        cm=round(driving.driven_cm), seconds=f"{passed_ms / 1000:.1f}", n=driving.bumps
    )
    if options.plot is not None:
        summary_text += " " + text("picture", language).format(file=printable_name(options.plot))
    return summary_text


def number(
    option: str, typed_value: str | None, default: int, low: int, high: int, language: str
) -> float:
    """Return an option's decimal number; `default`, `low` and `high` are thousandths."""
    return thousandths(option, typed_value, default, low, high, language) / ONE


def _motors(typed_value: str | None, language: str) -> tuple[float, float]:
    if typed_value is None:
        return 100.0, 100.0
    parts = typed_value.split(",")
    if len(parts) != 2:
        raise CommandError(2, "bad_motors", found=printable_name(typed_value) or "''")
    left, right = (
        number("--motors", part.strip(), 0, MOTOR_LOW, MOTOR_HIGH, language) for part in parts
    )
    return left, right
