"""States of a robot when its button is pressed: a table."""

from __future__ import annotations

from collections.abc import Callable

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.owners import BUTTON_HELD, BUTTON_PRESSED, BUTTON_RELEASED, KIT, Keys
from tests.support.robot_on_host import computer, send, switched_on, wait_until_saved
from tests.support.text_robot import type_text
from tiniscript.link.messages import KEY_OWNER, OWNED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

SAVED_POWER, OTHER_POWER, MEMORY_POWER, TYPED_POWER, LINE_POWER = (
    80,
    70,
    60,
    40,
    30,
)  # powers: which program it is that drives


class SmallRobot(HostFirmware):
    """A robot that, like an Uno, reads text into the place of its program."""

    has_draft = False


class Table:
    """A robot in a state. `program` is the power of the program that a press starts, `runs` of the
    running one."""

    def __init__(self, has_draft: bool = True) -> None:
        self.robot = switched_on() if has_draft else SmallRobot(KIT)
        self.session = computer()
        self.talks: Session | None = self.session  # the session that continues
        self.keys: Keys | None = None  # keys of the owner
        self.program = 0
        self.is_reset_down = False

    def send(self, text: str, **options: bool) -> None:
        send(self.robot, self.session, text, **options)

    def upload_program(self, power: int, is_saved: bool = True) -> None:
        self.send(f"SB|F(600, {power})", saves=is_saved)
        if is_saved:
            wait_until_saved(self.robot, self.session)
        self.program = power

    def fall_silent(self) -> None:
        """The client goes; a person may type."""
        self.robot.wait(4000)
        self.talks = None

    def talk(self, milliseconds: int, flags: int = 0) -> None:
        self.robot.advance_time(self.talks, milliseconds, flags)


def hold_no_program(table: Table) -> None:
    assert table.robot.until(table.session, table.session.hello()) == OK


def save_program(table: Table) -> None:
    table.upload_program(SAVED_POWER)


def load_into_memory(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    table.upload_program(MEMORY_POWER, is_saved=False)


def typing_of(text: str, power: int = SAVED_POWER) -> Callable[[Table], None]:
    """Return a function that types; `power` is that of the program which the button then starts."""

    def enter(table: Table) -> None:
        table.upload_program(SAVED_POWER)
        table.fall_silent()
        type_text(table.robot, text)
        table.program = power

    return enter


def live_line_of(line: str, milliseconds: int = 0) -> Callable[[Table], None]:
    """Return a function that sends a live line from a computer, and continues."""

    def enter(table: Table) -> None:
        table.upload_program(SAVED_POWER)
        request = table.session.live(image_of(line).code)
        assert table.robot.until(table.session, request) == OK
        table.talk(milliseconds)

    return enter


def run_from_memory(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    table.send(f"SI|F(600, {MEMORY_POWER})", saves=False)
    table.program = MEMORY_POWER


def run_saved(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    assert table.robot.until(table.session, table.session.start()) == OK


def enter_stopped(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    table.session.stop(table.robot.now_ms)
    table.talk(300)


def interrupt_upload(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    request = table.session.upload(image_of(f"SI|{f'F(1, {OTHER_POWER}); ' * 90}"))
    while request.done_bytes < 60:
        table.talk(1)
    table.talks = None  # the rest never arrives, or is late


def save_typed(table: Table) -> None:
    table.send(f"SB|F(600, {SAVED_POWER})")
    table.program = SAVED_POWER


def undo_upload(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    table.upload_program(OTHER_POWER)
    assert table.robot.until(table.session, table.session.undo()) == OK
    table.program = SAVED_POWER


def store_trim(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    table.session.trim(b"\0\0\1")
    table.talk(40)


def begin_claim(table: Table) -> None:
    table.keys = Keys()
    table.session = table.talks = Session(1, 9600, KIT.fingerprint, keys=table.keys)
    table.upload_program(SAVED_POWER)
    table.session.claim(KEY_OWNER)
    table.talk(300)


def enter_owned(table: Table) -> None:
    begin_claim(table)
    table.talk(1, BUTTON_PRESSED)
    table.talk(31)
    table.talk(2100, BUTTON_HELD)
    table.talk(1, BUTTON_RELEASED)
    table.talk(1000)
    assert table.session.robot and table.session.robot.values.features & OWNED
    table.fall_silent()


def reset_down(table: Table) -> None:
    table.upload_program(SAVED_POWER)
    memory = table.robot.memory()
    table.robot = type(table.robot)(KIT, memory)
    table.talks = None
    table.is_reset_down = True


STATES: dict[str, Callable[[Table], None]] = {
    "holds no program": hold_no_program,
    "holds a saved program": save_program,
    "holds a program in memory only": load_into_memory,
    "holds a program that was typed": typing_of(f"SB|F(600, {TYPED_POWER})\n", TYPED_POWER),
    "is running a program in memory": run_from_memory,
    "is running the saved program": run_saved,
    "is running a live line": live_line_of(f"SI|F(600, {LINE_POWER})"),
    "is running text": typing_of(f"SI|F(600, {TYPED_POWER})\n"),
    "has an open block of text": typing_of(f"SI|LOOP(2)\nF(600, {TYPED_POWER})\n"),
    "was stopped": enter_stopped,
    "has a fault": live_line_of("SI|X = 0; SHOW(5 / X)", 300),
    "is receiving an upload": interrupt_upload,
    "is saving its program": save_typed,
    "is bringing back the previous program": undo_upload,
    "is saving a trim": store_trim,
    "is being claimed": begin_claim,
    "has an owner": enter_owned,
    "was reset with the button down": reset_down,
}
