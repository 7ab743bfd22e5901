"""The firmware that `tsc firmware` writes: a ready file, or one that is built now."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from tiniscript import robots
from tiniscript.base import files
from tiniscript.base.languages import SOURCE_LANGUAGE
from tiniscript.cli import fetching
from tiniscript.cli.errors import CommandError
from tiniscript.cli.fetching import Part
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.terminal.progress import Progress
from tiniscript.cli.texts import say_aside, text
from tiniscript.flash import building, ready
from tiniscript.flash.building import (
    WITHOUT_REMOTE,
    WITHOUT_TASKS,
    CannotBuild,
    Sources,
    StepProgress,
)
from tiniscript.flash.ready import ReadyFile
from tiniscript.library import install_advice
from tiniscript.robots.ports import AVRS, ESP32S
from tiniscript.robots.profile import ProfileRefused, Robot

LOG_FILE = "build.log"  # the output of the last failed build, in the folder of the ready files
# Minutes to download and build, at 10 Mbit/s or more.
BUILD_MINUTES, ESP32_BUILD_MINUTES = 3, 10
AVR_BOARDS = tuple(AVRS)  # boards that avrdude writes to


def robots_on_boards(
    name: str | None, language: str, boards: Sequence[str] = AVR_BOARDS
) -> list[Robot]:
    """Return a robot once for each of the boards that its profile fits.

    It answers text in `language`, if its profile names none.
    """
    fitting_robots = []
    for board in boards:
        try:
            robot = robots.load(robots.DEFAULT if name is None else name, board)
            fitting_robots.append(robot.with_language(language))
        except ProfileRefused:
            continue  # the board has no such pins
    return fitting_robots


def firmware(
    robot: Robot, options: Namespace, language: str, has_breakpoints: bool = False
) -> ReadyFile:
    """Return the firmware of a robot on its board. Raises CommandError if it cannot be built."""
    if has_breakpoints:
        robot = robot._replace(
            board=robot.board._replace(language=SOURCE_LANGUAGE)
        )  # the robot ignores text
    sources = building.sources()
    ready_file = _find_ready(robot, sources, has_breakpoints)
    if ready_file is not None:
        return ready_file
    if sources is None:
        raise CommandError(2, "flash_no_sources")
    with _show_build(robot, options, language) as on_progress:
        data = building.build(sources, robot, on_progress, has_breakpoints)
        title = ready.title_of(robot, has_breakpoints)
        return ready.store(title, robot.board.chip, sources.digest(robot, has_breakpoints), data)


def require_breakpoints(robot: Robot) -> None:
    """Raise CommandError if no feature can be left out for breakpoints, or that is not enough."""
    if not building.can_have_breakpoints(robot):
        has_room = robot.board.chip not in building.ENVIRONMENT_WITH_BREAKPOINTS
        key = "flash_has_breakpoints" if has_room else "flash_no_breakpoints"
        raise CommandError(2, key, robot=robot.name, board=robot.board.chip)


def _find_ready(
    robot: Robot, sources: Sources | None, has_breakpoints: bool = False
) -> ReadyFile | None:
    """Return the file for a robot.

    Without sources, the shipped file cannot be out of date; a firmware that answers in another
    language is better than none.
    """
    if sources is not None:
        digest = sources.digest(robot, has_breakpoints)
        return ready.find(ready.title_of(robot, has_breakpoints), robot.board.chip, digest)
    if robot.name not in robots.names():
        return None
    file_by_key = {(file.title, file.board): file for file in ready.files()}
    own_title = ready.title_of(robot, has_breakpoints)
    for title in (own_title,) if has_breakpoints else (own_title, robot.name):
        if (title, robot.board.chip) in file_by_key:
            return file_by_key[title, robot.board.chip]
    return None


def upload(robot: Robot, port: str | None, options: Namespace, language: str) -> None:
    """Build and write the firmware of a robot with an ESP32. Raises CommandError."""
    sources = building.sources()
    if sources is None:
        raise CommandError(2, "flash_no_sources")
    with _show_build(robot, options, language, port=printable_name(port or "")) as on_progress:
        building.upload(sources, robot, port, on_progress)


@contextmanager
def _show_build(
    robot: Robot, options: Namespace, language: str, **other_values: str
) -> Iterator[Callable[[StepProgress], None]]:
    """Fetch the tools that build firmware, and show the progress. Raises CommandError for all that
    can fail then."""
    values = {"robot": robot.name, "board": robot.board.chip, **other_values}
    _fetch(robot, values, options, language)
    say_aside("flash_builds", language, **values)
    progress = Progress(language, 100)
    fetched_file = ""

    def show_progress(build_progress: StepProgress) -> None:
        nonlocal fetched_file
        if build_progress.phase in (WITHOUT_TASKS, WITHOUT_REMOTE):
            progress.end()
            say_aside(f"flash_{build_progress.phase}", language, **values)
            return
        progress.label = text(f"flash_{build_progress.phase}", language)
        if build_progress.file_name and build_progress.file_name != fetched_file:
            progress.end()
            file_name = printable_name(build_progress.file_name)
            say_aside("flash_fetches", language, what=file_name)
            fetched_file = build_progress.file_name
        progress.draw(build_progress.percent)

    try:
        yield show_progress
    except building.CannotBuild as error:
        raise _failure(error, values) from None
    except OSError as error:
        folder = printable_name(str(ready.firmware_cache()))
        raise CommandError(2, "flash_no_room", why=error, folder=folder) from None
    finally:
        progress.end()


def _fetch(robot: Robot, values: dict[str, str], options: Namespace, language: str) -> None:
    """Download the build tools of a robot's firmware if the person agrees. Raises CommandError.

    PlatformIO fetches the compiler itself, when it builds.
    """
    has_platformio = building.platformio() is not None
    if not has_platformio and install_advice.install_command(install_advice.FIRMWARE) is None:
        raise _failure(building.CannotBuild(building.CannotBuild.NO_PLATFORMIO), values)
    platformio = Part("fetch_platformio", building.PLATFORMIO_MB)
    compiler = Part("fetch_compiler", building.missing_mb(robot))
    parts = [*([] if has_platformio else [platformio]), *([compiler] if compiler.mb else [])]
    if not parts:
        return
    minutes = ESP32_BUILD_MINUTES if robot.board.chip in ESP32S else BUILD_MINUTES
    missing_text = text("flash_missing", language).format(**values)
    fetching.ask_to_fetch(missing_text, parts, minutes, options, language)
    if not has_platformio:
        fetching.install(install_advice.FIRMWARE, platformio, language)


def _failure(error: CannotBuild, values: dict[str, str]) -> CommandError:
    """Return the sentence for a failed build, and save the build's output."""
    log_path = ready.firmware_cache() / LOG_FILE
    if error.log:
        # If the file cannot be written, the message has no path.
        files.keep(log_path, error.log.encode("utf-8", "replace"))
    install_command = install_advice.command(install_advice.FIRMWARE)
    texts = {
        "why": printable_name(error.last_output),
        "log": printable_name(str(log_path)),
        "how": install_command,
    }
    return CommandError(2, f"flash_{error.reason}", **texts, **values)


def print_list(language: str) -> None:
    """Print each shipped robot on each board that it fits, and whether its firmware is ready."""
    sources = building.sources()
    for name in robots.names():
        for robot in robots_on_boards(name, language):
            print(firmware_row(robot, _find_ready(robot, sources), language))


def firmware_row(robot: Robot, firmware: ReadyFile | None, language: str) -> str:
    values = {"robot": robot.name, "board": robot.board.chip}
    if firmware is None:
        return text("flash_row_none", language).format(**values)
    return text("flash_row", language).format(bytes=f"{firmware.flash_bytes:,}", **values)
