"""`tsc firmware`: a robot's firmware gets onto a board, or a sentence says why it does not."""

from __future__ import annotations

import os
import random
import shutil
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar, cast

import pytest
import serial

from tests.machines.bootloaders import FOLDER, Bootloader, bootloader, optiboot
from tests.machines.uno import build_uno, skip_unless_available
from tests.support.command import Tsc
from tests.support.flashed_boards import CPU_LIMIT_COMMAND, copy_package, new_board, to_hex, tsc
from tests.support.needs import need
from tests.support.platformio import firmware, prepare, shared_folder
from tests.support.terminal import Terminal
from tiniscript import robots
from tiniscript.cli.commands import firmware as firmware_command
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import has_text, text
from tiniscript.flash import avrdude, ready
from tiniscript.flash import bootloaders as flash_bootloaders
from tiniscript.flash.avrdude import StepProgress
from tiniscript.flash.bootloaders import BOARDS, UNO
from tiniscript.flash.ready import ReadyFile
from tiniscript.link import ports
from tiniscript.robots.profile import answer_languages
from tools import CannotMake
from tools.bench import firmware_size
from tools.builds import firmware_files
from tools.uno import Uno

FILES = {"tinibot-uno": "uno", "tinibot-nano": "nano", "grabber-mega": "mega_grabber"}


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with firmware."""
    skip_unless_available()
    if not shutil.which("avrdude"):
        need("no avrdude on this computer")
    copy = copy_package(tmp_path_factory.mktemp("package"))
    folder = copy / "tiniscript" / "flash" / "ready"
    folder.mkdir()
    for name, environment in FILES.items():
        elf = firmware(
            environment, tmp_path_factory.mktemp("sketch"), shared_folder(tmp_path_factory)
        )
        to_hex(elf, folder / f"{name}-digest.hex")
    return copy


@pytest.fixture
def with_platformio(monkeypatch: pytest.MonkeyPatch) -> None:
    """PlatformIO works here, with the offline stand-ins where it needs them."""
    variables, reason = prepare()
    need(reason)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)


# -- onto a board


@pytest.mark.sampled("board", "robot", "option")
@pytest.mark.parametrize(
    ("board", "robot", "option", "bytes_least"),
    [("uno", "tinibot", "uno", 10_000), ("nano", "tinibot", "nano-old", 10_000),
     ("mega", "grabber", "mega", 10_000)],
)  # fmt: skip
def test_a_new_board_becomes_a_robot(
    board: str, robot: str, option: str, bytes_least: int, package: Path
) -> None:
    with new_board(bootloader(board)) as uno:
        result = tsc(package, "--port", uno.pty, "--robot", robot, "--chip", option).gives(0)
        first_line, second_line = result.out.splitlines()[:2]
        message = f"The firmware for {robot} was written to the {board} and verified: "
        assert first_line.startswith(message)
        assert int(first_line.removeprefix(message).split()[0].replace(",", "")) > bytes_least
        assert second_line.startswith(f"{robot} on {uno.pty}, id ")


def test_a_board_without_a_bootloader_is_not_changed(
    package: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """The robot's own firmware does not answer avrdude."""
    with Uno(firmware("uno", tmp_path, shared_folder(tmp_path_factory)), tells_sleep=False) as uno:
        uno.go()
        tsc(package, "--port", uno.pty).gives(3, f"no bootloader responds on {uno.pty}", "HC-05")
        uno.pause()
        assert not [event for event in uno.events if event.kind == "crash"]


def changed_optiboot(folder: Path, old_text: str, new_text: str) -> Bootloader:
    source = (FOLDER / "optiboot" / "optiboot.c").read_text(encoding="utf-8", errors="replace")
    assert old_text in source
    return bootloader("uno")._replace(file=optiboot(folder, source.replace(old_text, new_text)))


def test_another_chip_is_refused(package: Path, tmp_path: Path) -> None:
    loader = changed_optiboot(tmp_path, "putch(SIGNATURE_1)", "putch(0x94)")  # an ATmega168P's
    with new_board(loader) as uno:
        result = tsc(package, "--port", uno.pty, "--lang", "es")
        assert result.code == 3
        assert f"la placa en {uno.pty} no es un uno" in result.err


def test_a_faulty_flash_memory_is_noticed(package: Path, tmp_path: Path) -> None:
    loader = changed_optiboot(tmp_path, "__boot_page_write_short(", "(void)(")
    with new_board(loader) as uno:
        tsc(package, "--port", uno.pty).gives(
            3, "the firmware on the board does not match what was written. Unplug"
        )


def test_a_port_in_use_is_reported(package: Path) -> None:
    with new_board(bootloader("uno")) as uno, serial.Serial(uno.pty, exclusive=True):
        tsc(package, "--port", uno.pty).gives(3, "another program is using the port")


# -- with an avrdude whose output is scripted


FAKE_AVRDUDE = """\
#!{python}
import sys, time
baud = sys.argv[sys.argv.index("-b") + 1]
{body}
"""
PROGRESS_CODE = 'print("Writing | #########", end="", flush=True)'


@pytest.fixture
def board() -> Iterator[Uno]:
    skip_unless_available()
    with Uno(build_uno("nothing"), bootloader=bootloader("uno").file, tells_sleep=False) as uno:
        uno.go()
        yield uno


def fake(folder: Path, body: str) -> dict[str, str]:
    """Return the variables with which this avrdude is found."""
    program = folder / "avrdude"
    program.write_text(FAKE_AVRDUDE.format(python=sys.executable, body=body), encoding="utf-8")
    program.chmod(0o755)
    return {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def test_a_nano_is_tried_with_both_of_its_bootloaders(
    package: Path, board: Uno, tmp_path: Path
) -> None:
    silent_body = 'print("avrdude: stk500_getsync() attempt 1 of 10: not in sync: resp=0x00")'
    body = f'{silent_body}\nopen({str(tmp_path / "bauds")!r}, "a").write(baud + " ")\nsys.exit(1)'
    result = tsc(package, "--port", board.pty, "--chip", "nano", **fake(tmp_path, body))
    assert result.code == 3
    assert "the speed of an older Nano" in result.err and "Is nano the right" in result.err
    assert (tmp_path / "bauds").read_text() == "115200 57600 "


def test_a_partial_firmware_is_reported(package: Path, board: Uno, tmp_path: Path) -> None:
    body = f'{PROGRESS_CODE}\nprint("avrdude: programmer is not responding")\nsys.exit(1)'
    tsc(package, "--port", board.pty, **fake(tmp_path, body)).gives(3, "its firmware is incomplete")


def test_ctrl_c_during_a_write_reports_the_state_of_the_board(
    package: Path, board: Uno, tmp_path: Path
) -> None:
    marker = tmp_path / "told"
    note = f'import os\nopen({str(marker)!r}, "w").write(str(os.getpid()))'
    body = f"{note}\n{PROGRESS_CODE}\ntime.sleep(60)"
    variables = {"PYTHONPATH": str(package), **fake(tmp_path, body)}
    tsc = [*CPU_LIMIT_COMMAND, sys.executable, "-m", "tiniscript"]
    terminal = Terminal("firmware", "--yes", "--port", board.pty, command=tsc, env=variables)
    terminal.until(r"\[#+\.+\]")  # waits until avrdude's progress is shown
    terminal.interrupt()
    assert terminal.end() == 2
    assert "board's firmware" in " ".join(" ".join(terminal.whole()).split())
    assert not Path(f"/proc/{marker.read_text()}").exists()


@pytest.mark.parametrize("count", range(4))
def test_ctrl_c_reports_a_partial_firmware_from_the_first_byte_on(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the first byte there is no such warning, because the board is unchanged."""

    def write(*words: object) -> None:
        on_progress = cast("Callable[[StepProgress | None], None]", words[-1])
        steps = (StepProgress(avrdude.WRITING, 9 * k) for k in range(count))
        for progress in [None, None, *steps, None]:
            on_progress(progress)
        raise KeyboardInterrupt

    monkeypatch.setattr(avrdude, "write", write)
    firmware = ReadyFile("tinibot", "uno", "0", Path("x.hex"))
    with pytest.raises((CommandError, KeyboardInterrupt)) as exception_info:
        firmware_command._write_firmware(["x"], UNO, "x", firmware, "en")
    assert getattr(exception_info.value, "key", None) == ("flash_stopped" if count else None)


@pytest.mark.parametrize("seed", range(20))
def test_bootloaders_are_tried_until_one_answers(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], seed: int
) -> None:
    """What that one says is the outcome: another one writes nothing over it."""
    rng, firmware = random.Random(seed), ReadyFile("tinibot", "nano", "0", Path("x.hex"))
    older_text = text("flash_older", "en")
    for _ in range(4):  # the next board is like the first
        bootloaders = rng.choice((BOARDS["nano"][1], BOARDS["uno"][1], BOARDS["nano"][1][::-1]))
        outcomes = [rng.choice((avrdude.NOBODY, *avrdude.OUTCOMES)) for _ in bootloaders]
        tried: list[flash_bootloaders.Bootloader] = []

        def write(
            command: list[str], bootloader: flash_bootloaders.Bootloader, *_: object,
            tried: list[flash_bootloaders.Bootloader] = tried, outcomes: list[str] = outcomes,
        ) -> avrdude.WriteResult:  # fmt: skip
            tried.append(bootloader)
            return avrdude.WriteResult(outcomes[len(tried) - 1])

        monkeypatch.setattr(avrdude, "write", write)
        answers = [k for k, outcome in enumerate(outcomes) if outcome != avrdude.NOBODY]
        last = answers[0] if answers else len(outcomes) - 1
        is_done = outcomes[last] == avrdude.DONE
        with nullcontext() if is_done else pytest.raises(CommandError) as exception_info:
            firmware_command._write(["x"], bootloaders, "x", firmware, "en")
        assert tried == list(bootloaders[: last + 1])
        if exception_info is not None:
            error = exception_info.value
            assert (error.exit_code, error.key) == (3, f"flash_{outcomes[last]}")
        assert capsys.readouterr().err.count(older_text) == last


class Line:
    """A robot's line: it is met, or that fails."""

    failure: BaseException | None = None
    open_count = 0
    met_chips: ClassVar[list[str]] = []

    def __init__(self, options: Namespace, *_: object) -> None:
        assert options.port == "COM5"

    def __enter__(self) -> Line:
        Line.open_count += 1
        return self

    def __exit__(self, *_: object) -> None:
        Line.open_count -= 1

    def meet(self, chip: str) -> None:
        self.met_chips.append(chip)
        if self.failure is not None:
            raise self.failure


@pytest.mark.parametrize(("failure", "code", "key"), [
    (None, 0, ""),
    (CommandError(3, "link_silent"), 3, "flash_silent"),
    (CommandError(2, "other_version"), 2, "other_version"),
])  # fmt: skip
def test_the_robot_that_was_written_is_shown_or_its_silence_is_an_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    failure: CommandError | None, code: int, key: str,
) -> None:  # fmt: skip
    monkeypatch.setattr(firmware_command, "Connection", Line)
    monkeypatch.setattr(Line, "failure", failure)
    monkeypatch.setattr(
        firmware_command, "describe_robot", lambda _: SimpleNamespace(text=lambda: "a robot")
    )
    robot = robots.load("tinibot")
    for _ in range(2):
        Line.met_chips.clear()
        with pytest.raises(CommandError) if failure else nullcontext() as exception_info:
            firmware_command._introduce("COM5", robot, "uno", "en")
        if exception_info is not None:
            assert (exception_info.value.exit_code, exception_info.value.key) == (code, key)
        assert capsys.readouterr().out == ("" if failure else "a robot\n")
        assert (Line.met_chips, Line.open_count) == (["uno"], 0)


def test_the_port_is_free_again_before_the_firmware_is_written(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    closed: list[str] = []

    def open_port(port: str, *_: object) -> SimpleNamespace:
        return SimpleNamespace(close=lambda: closed.append(port))

    monkeypatch.setattr(ports, "open_port", open_port)
    for count in (1, 2):
        assert firmware_command._port(Namespace(port="COM5")) == "COM5"
        assert closed == ["COM5"] * count


def test_a_missing_avrdude_is_reported_with_its_source(package: Path, tmp_path: Path) -> None:
    result = tsc(package, "--port", "x", PATH=str(tmp_path), HOME=str(tmp_path))
    assert result.code == 2
    assert "avrdude" in result.err and firmware_command.INSTALLS[sys.platform] in result.err


# -- avrdude


@pytest.mark.parametrize("place", [
    ".arduino15/packages/arduino/tools/avrdude/6.3.0-arduino17/bin/avrdude",
    "Library/Arduino15/packages/arduino/tools/avrdude/6.3.0-arduino17/bin/avrdude",
    ".platformio/packages/tool-avrdude/avrdude",
])  # fmt: skip
def test_the_avrdude_of_another_program_is_found(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    assert avrdude.find_avrdude() is None
    program = tmp_path / place
    program.parent.mkdir(parents=True)
    program.touch(mode=0o755)
    assert avrdude.find_avrdude() is None  # avrdude does not work without its configuration
    config_folder = (
        program.parent.parent / "etc" if program.parent.name == "bin" else program.parent
    )
    config_folder.mkdir(exist_ok=True)
    (config_folder / "avrdude.conf").touch()
    assert avrdude.find_avrdude() == [str(program), "-C", str(config_folder / "avrdude.conf")]


def test_the_newest_avrdude_of_the_arduino_ide_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its versions are numbers: 10 is newer than 9."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    tools = tmp_path / ".arduino15" / "packages" / "arduino" / "tools" / "avrdude"
    versions = ["6.3.0-arduino9", "6.3.0-arduino17", "8.0.0-arduino1", "10.0-arduino1"]
    for count in range(1, len(versions) + 1):
        folder = tools / versions[count - 1]
        for name in ("bin/avrdude", "etc/avrdude.conf"):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).touch(mode=0o755)
        assert (avrdude.find_avrdude() or [""])[0] == str(folder / "bin" / "avrdude")


@pytest.mark.parametrize(("outcome", "name"), [
    (avrdude.NOBODY, "avrdude: stk500_getsync() attempt 10 of 10: not in sync: resp=0xc9"),
    (avrdude.NOBODY, "avrdude: stk500v2_ReceiveMessage(): timeout"),
    (avrdude.NOBODY, "avrdude error: unable to open programmer arduino on port /dev/ttyUSB0"),
    (avrdude.OTHER_CHIP, "avrdude: Expected signature for ATmega328P is 1E 95 0F"),
    (avrdude.OTHER_CHIP, "avrdude: Yikes!  Invalid device signature."),
    (
        avrdude.PORT_FAILED,
        'avrdude: ser_open(): can\'t open device "/dev/ttyUSB0": Permission denied',
    ),
    (
        avrdude.PORT_FAILED,
        "avrdude error: cannot open port /dev/ttyUSB0: No such file or directory",
    ),
    (avrdude.BROKEN_OFF, "Writing | ####avrdude: stk500_recv(): programmer is not responding"),
    (avrdude.DIFFERS, "Writing | #### | 100% 1.68s\navrdude: verification error, first mismatch"),
    (avrdude.FAILED, "avrdude: cannot find its settings"),
    (avrdude.FAILED, ""),
])  # fmt: skip
def test_messages_of_avrdude_map_to_outcomes(outcome: str, name: str) -> None:
    for code in (1, 255, -9, -15):  # including exits by a signal from outside
        assert avrdude.result_of(code, name).outcome == outcome


@pytest.mark.parametrize("seed", range(20))
def test_an_unfinished_write_is_never_a_success_or_an_unchanged_board(seed: int) -> None:
    """Only its exit code says that it has succeeded, and only its bar that it has begun."""
    rng, bar = random.Random(seed), "Reading | ## | 100%\n"
    words = {
        avrdude.NOBODY: "programmer is NOT responding",
        avrdude.OTHER_CHIP: "Expected signature for ATmega328P is 1E 95 0F",
        avrdude.PORT_FAILED: "can't open device",
        avrdude.FAILED: "something new",
    }
    for _ in range(20):
        cause, has_begun = rng.choice([*words, avrdude.DIFFERS]), rng.random() < 0.5
        output = rng.choice(("", bar)) + ("Writing | ##" if has_begun else "")
        output += (
            f"\navrdude: {words.get(cause, 'verification error')}\navrdude done.  Thank you.\n"
        )
        code = rng.choice((0, 1, 255, -9, -15))
        expected = cause if cause == avrdude.DIFFERS or not has_begun else avrdude.BROKEN_OFF
        result = avrdude.result_of(code, output)
        assert result.outcome == (avrdude.DONE if code == 0 else expected)
        assert result.output == ("something new" if result.outcome == avrdude.FAILED else "")


@pytest.mark.parametrize("chip", BOARDS)
def test_avrdude_gets_all_of_a_bootloader(chip: str, tmp_path: Path) -> None:
    """It erases no flash: a bootloader does that, page by page, or not at all."""
    script, arguments_path = tmp_path / "avrdude.py", tmp_path / "told"
    script.write_text(
        f"import sys\nopen({str(arguments_path)!r}, 'w').write(' '.join(sys.argv[1:]))"
    )
    for loader in BOARDS[chip][1]:
        result = avrdude.write(
            [sys.executable, str(script)], loader, "/dev/x", tmp_path / "f.hex", lambda _: None
        )
        words = f"-c {loader.programmer} -p {loader.part} -P /dev/x -b {loader.baud} -D"
        assert result == avrdude.WriteResult(avrdude.DONE)
        assert arguments_path.read_text() == f"{words} -U flash:w:{tmp_path / 'f.hex'}:i"


def test_every_outcome_has_its_message() -> None:
    for outcome in avrdude.OUTCOMES:
        assert has_text(f"flash_{outcome}")


@pytest.mark.parametrize(("expected", "progress"), [
    ("", None),
    ("Reading | ##################### | 100% 0.00s\n", None),  # the signature
    ("Reading | ##### | 100% 0.00s\nWriting | ", ("writing", 0)),
    ("Writing | #########################", ("writing", 50)),
    ("Writing | ################################################## | 100%\nReading | #",
     ("reading", 2)),
    ("Writing 15630 bytes flash | #####", ("writing", 10)),
])  # fmt: skip
def test_progress_is_parsed_from_the_output(expected: str, progress: object) -> None:
    assert avrdude.parse_progress(expected) == progress


def test_a_program_that_cannot_be_run_is_reported(tmp_path: Path) -> None:
    ended_write_result = avrdude.write(
        [str(tmp_path / "none")], UNO, "x", tmp_path, lambda progress: None
    )
    assert (
        ended_write_result.outcome == avrdude.FAILED and "No such file" in ended_write_result.output
    )


# -- the files


@pytest.mark.sampled(of="builds of PlatformIO")
def test_a_firmware_is_the_same_however_it_is_built(
    package: Path, tmp_path: Path, with_platformio: None
) -> None:
    """`pio run` builds shipped robots, and `tsc firmware` any robot, in another folder."""
    path = firmware_files.build(robots.load("tinibot"), tmp_path)
    assert path.name.startswith("tinibot-uno-")
    halting_firmware = firmware_files.build(robots.load("tinibot"), tmp_path, has_breakpoints=True)
    assert halting_firmware.name.startswith("tinibot_breakpoints-uno-")
    words, other_words = (file.read_text().split() for file in (
        path, package / "tiniscript" / "flash" / "ready" / "tinibot-uno-digest.hex"))  # fmt: skip
    assert words == other_words


def test_every_board_of_the_option_is_built() -> None:
    built = {name.partition("_")[0] for name in firmware_size.environments()}
    assert {board for board, _ in BOARDS.values()} == built
    brought = {
        (robot.name, robot.board.chip, robot.board.language)
        for robot in firmware_files.shipped_robots()
    }
    assert brought == {
        (robot or robots.DEFAULT, board, language)
        for language in answer_languages()
        for board, _, robot in (name.partition("_") for name in firmware_size.environments())
    }


def test_breakpoints_are_built_only_if_they_replace_the_text_reader() -> None:
    """For each robot on each board that lacks one of the two."""
    for robot in firmware_files.shipped_robots():
        halting_boards = [
            halting_robot for halting_robot in firmware_files.halting_robots()
            if (halting_robot.name, halting_robot.board.chip) == (robot.name, robot.board.chip)
        ]  # fmt: skip
        is_small = robot.board.chip in ("uno", "nano")
        assert len(halting_boards) == (is_small and not robot.board.discs), robot


def test_the_licence_of_the_core_goes_with_it(tmp_path: Path) -> None:
    with pytest.raises(CannotMake, match="--licence"):
        firmware_files.build_all(tmp_path / "ready", tmp_path / "none")
    assert not (tmp_path / "ready").exists()
    assert firmware_files.LICENCE_NAME in firmware_files.NOTICE_TEXT
    assert "https://github.com/arduino/ArduinoCore-avr" in firmware_files.NOTICE_TEXT


def test_packaged_firmware_is_listed(package: Path) -> None:
    result = tsc(package, "--list").gives(0)
    files = ready.files(package / "tiniscript" / "flash" / "ready")
    assert [(file.title, file.board) for file in files] == [
        ("grabber", "mega"), ("tinibot", "nano"), ("tinibot", "uno")
    ]  # fmt: skip
    for file in files:
        assert f"{file.title} on {file.board}: ready, {file.flash_bytes:,} bytes" in result.out
    assert "liner on nano: not built yet" in result.out


@pytest.mark.parametrize(("words", "message"), [
    ([], "which port is the board"),
    (["--port", ""], "--port takes a port's name"),
    (["--port", "socket://localhost:1"], "is a wireless or network port."),
    (["--port", "/dev/none"], "there is no port /dev/none"),
    (["--port", "x", "--chip", "teensy"], "uno, nano, nano-old or mega, not teensy"),
    (["--port", "x", "--robot", "grabber", "--chip", "uno"], "cannot use the board uno"),
    (["--port", "x", "--robot", "mine.toml"], "There is no file mine.toml"),
    (["--build", "--robot", "nobody"], "nobody"),
])  # fmt: skip
def test_wrong_use_is_reported(words: list[str], message: str, tsc: Tsc) -> None:
    is_told_without = "--chip" in words or "--robot" in words
    need("" if is_told_without or shutil.which("avrdude") else "no avrdude on this computer")
    result = tsc("firmware", "--yes", *words)
    assert result.code in (2, 3) and message in result.err
