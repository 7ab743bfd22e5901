"""Connect to the robot on a port: a connection sends programs and lines, and receives events.

Leaving the `with` block stops the robot and waits until the robot has confirmed that. If the
process ends without it, the robot's dead-man timer stops the robot within a second.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import suppress
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from tiniscript import robots
from tiniscript.base import languages
from tiniscript.base.source import printable
from tiniscript.library import opening
from tiniscript.library.client import Client, Saving
from tiniscript.library.endings import Follower
from tiniscript.library.errors import RobotError, StopNotConfirmed, UsageError
from tiniscript.library.events import Ending, EventReader, RobotEvent, ending_of
from tiniscript.library.known_kits import robot_of_kit
from tiniscript.library.programs import Language, Program, profile_of, program_of
from tiniscript.library.refusing import refusal
from tiniscript.library.runs import check_whole_number, checked_number
from tiniscript.link import known_ports, ports
from tiniscript.link.connection import Requester
from tiniscript.link.messages import MAX_PAD, REMOTE_KEYS, STATE_RUNNING
from tiniscript.link.names import saved_name
from tiniscript.link.outcomes import CANCELLED, LOST, Event
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.remote import remote_state_of
from tiniscript.link.requests import OK
from tiniscript.robots.profile import Robot
from tiniscript.virtual import directory

if TYPE_CHECKING:
    Self = TypeVar("Self", bound="RobotConnection")
    T = TypeVar("T")

VERB = "python"  # the name that other commands show for the process that holds the port
MAX_TIMEOUT_S = 10**9
POLL_INTERVAL_S = 0.1


class RobotInfo(NamedTuple):
    """A robot's description. `name` is its given name, or empty; `robot` is its profile, or None if
    unknown here; `room` is in bytes of code.
    """

    name: str
    id: int
    robot: str | None
    port: str
    room: int


class Receipt(NamedTuple):
    """The program in the robot. `checksum` is that of the program's image; `saved` is
    MEMORY, SAVING, STORED, LOW_SUPPLY or NOTHING, as in docs/develop/link.md."""

    checksum: int
    saved: str
    is_running: bool


class RobotConnection:
    """A robot that has answered. Only one thread at a time may use it.

    The end of a `with` block calls `close`. An exception that leaves the block, Ctrl-C included,
    stops the robot even if its program is detached.
    """

    def __init__(
        self, port: str, profile: Robot, is_robot_named: bool, baud: int | None, language: Language
    ) -> None:
        """Internal: use `connect` instead."""
        self.port = port
        self.language = language
        self._profile = profile
        self._reader = EventReader()
        self._follower: Follower | None = None
        self._ending: Ending | None = None
        self._is_detached = self._is_replaced = False
        self._saving: Saving | None = None
        self._is_closed = False
        self._client = Client(port, VERB, profile, baud, language)
        try:
            self._meet(is_robot_named)
        except BaseException:
            self._close_port()
            raise

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, error_type: type[BaseException] | None, *_: object) -> None:
        is_interrupted = error_type is not None and not issubclass(error_type, Exception)
        self._leave(is_clean=error_type is None, is_interrupted=is_interrupted)

    @property
    def info(self) -> RobotInfo:
        """The robot's description of itself."""
        device_info = self._client.device_info
        profile = robot_of_kit(device_info.kit)
        name = None if profile is None else profile.name
        return RobotInfo(
            printable(device_info.name), device_info.id, name, self.port, device_info.room
        )

    def upload(
        self, program: Program | str | bytes, *, run: bool = True, save: bool = True,
        detached: bool = False,
    ) -> Receipt:  # fmt: skip
        """Send a program to the robot, and start it there if it begins with SI.

        With `run=False`, nothing starts. With `save=False`, the robot forgets the program when it
        is switched off. `detached`: the program continues after this connection is closed. Returns
        when the robot has the program; `wait` waits for its end. Raises ProgramError, RobotError.
        """
        self._check_open()
        ready_program = self._prepare(program)
        if ready_program.start == "PING":
            raise UsageError("ping_program", self.language)
        reply = self._client.send_program(
            ready_program._image, run, save, detached, profile=ready_program._profile
        )
        if reply.status:
            raise self._client.error_for_reply(reply)
        self._saving = Saving(reply.values) if save else None
        return self._begin_run(reply.values, run and ready_program.start == "SI", detached)

    def live(self, line: str) -> Receipt:
        """Run a line once, at most 55 bytes of code, or 42 for a robot that seals; the stored
        program does not change.

        Returns when the line has begun; `wait` waits for its end. Variables do not last from one
        line to the next. Raises ProgramError, RobotError.
        """
        self._check_open()
        ready_program = self._prepare(line)
        if ready_program.start != "SI":
            reason = "live_button" if ready_program.start == "SB" else "ping_program"
            raise UsageError(reason, self.language)
        image, kit = ready_program._image, ready_program._profile.kit.fingerprint
        refused_reply = refusal(image, ready_program._profile, self._client.device_info)
        if refused_reply is not None:
            raise self._client.error_for_reply(refused_reply)
        reply = self._client.request(
            lambda session: session.live(image.code, kit if image.devices else 0)
        )
        return self._begin_run(reply.values, True, False)

    def start(self, *, detached: bool = False) -> Receipt:
        """Start the program that the robot holds."""
        self._check_open()
        reply = self._client.request(lambda session: session.start(detached))
        return self._begin_run(reply.values, True, detached)

    def undo(self) -> Receipt:
        """Bring back the program that the robot held before the last saved one; a second call
        brings the later one back.

        The running program ends, and nothing starts. Returns when the robot holds it; `close` waits
        until that is saved. Raises RobotError, with the reason `NO_PREVIOUS` if there is none.
        """
        self._check_open()
        reply = self._client.request(lambda session: session.undo())
        self._saving = Saving(reply.values)
        receipt = self._begin_run(reply.values, False, False)
        self._follower = None
        return receipt

    def events(self, timeout: float | None = None) -> Iterator[RobotEvent]:
        """Yield the robot's events until the program that this connection has started ends (that
        event is the last one) or `timeout` seconds have passed. If it has started none, only the
        timeout ends the events: None means forever. Raises RobotError if the robot is lost.
        """
        self._check_open()
        if timeout is not None:
            checked_number("timeout", timeout, 0, MAX_TIMEOUT_S, self.language)
        end_s = None if timeout is None else monotonic() + timeout
        any_run_follower = Follower(None)
        while self._follower is None or self._ending is None:
            follower = self._follower or any_run_follower
            left_s = POLL_INTERVAL_S if end_s is None else min(POLL_INTERVAL_S, end_s - monotonic())
            timed_event = self._client.event(max(left_s, 0.0))
            robot_event = None
            if timed_event is not None and self._follow(follower, timed_event[1]):
                robot_event = self._reader.to_robot_event(*timed_event)
                if (
                    robot_event is not None
                    and follower.end(timed_event[1]) is not None
                    and self._follower
                ):
                    self._ending = ending_of(robot_event)
            if robot_event is not None:
                yield robot_event
            # an event that arrived before the timeout is still reported
            event_s = monotonic() if timed_event is None else timed_event[0] / 1000
            if end_s is not None and event_s >= end_s:
                return

    def _follow(self, follower: Follower, event: Event) -> bool:
        """Process an event for this connection, and remember its effects."""
        try:
            return follower.follow(event, opening.printable_name(self.port), self.language)
        except RobotError as error:
            self._is_replaced = error.reason == "replaced"
            raise

    def wait(self, timeout: float | None = None) -> Ending:
        """Wait until the program that this connection has started ends; an uploaded one is also
        saved then.

        Raises RobotError if the robot is lost. After `timeout` seconds its reason is
        `still_running`, and the program continues.
        """
        self._check_open()
        if self._follower is None:
            raise UsageError("nothing_started", self.language)
        for _ in self.events(timeout):
            pass
        if self._ending is None:
            raise RobotError("still_running", self.language, {"seconds": f"{timeout:g}"})
        self._await_saving()
        return self._ending

    def press(self, *keys: str, x: int = 0, y: int = 0) -> None:
        """Hold these keys of a remote control ("UP", "DOWN", "LEFT", "RIGHT", "A", "B") and its pad
        in this position, in percent to the right and up, and no other keys.

        It counts for half a second: press anew before. Without keys, all are released. Returns when
        the robot has it, or has not answered in time. Raises RobotError if it takes none.
        """
        self._check_open()
        for axis, percent in (("x", x), ("y", y)):
            check_whole_number(axis, percent, -MAX_PAD, MAX_PAD, self.language)
        for key in keys:
            if key not in REMOTE_KEYS:
                values = {"found": printable(repr(key)), "known": ", ".join(REMOTE_KEYS)}
                raise UsageError("bad_key", self.language, values)
        remote_state = remote_state_of(keys, x, y)
        reply = self._client.wait(
            self._client.begin_request(lambda session: session.press(*remote_state))
        )
        if reply.status not in (OK, CANCELLED, LOST):
            raise self._client.error_for_reply(reply)

    def stop(self) -> None:
        """Stop the robot now; return when it has confirmed the stop. Raises StopNotConfirmed."""
        self._check_open()
        self._stop()

    def close(self) -> None:
        """Stop the robot, unless its program is detached, and close the port. A second call does
        nothing. Raises StopNotConfirmed.

        A run that another command started through this one goes on: a thread holds the port until
        it has ended."""
        self._leave(is_clean=True)

    # -- leaving ----------------------------------------------------------------------------------

    def _leave(self, is_clean: bool, is_interrupted: bool = False) -> None:
        """Leave the connection; Ctrl-C stops the robot, no matter who started the run."""
        if self._is_closed:
            return
        if self._follower is not None and self._ending is None:
            with suppress(RobotError):
                for _ in self.events(0):  # the program may have been replaced since
                    pass
        self._is_closed = True
        is_run_of_others = (self._client.drives_another or self._is_replaced) and not is_interrupted
        try:
            if not (is_clean and self._is_detached) and not is_run_of_others:
                self._stop()
            if is_clean:
                self._await_saving()
        finally:
            self._close_port(holds_port=not is_interrupted)

    def _stop(self) -> None:
        if not self._client.stop():
            raise StopNotConfirmed(
                "not_confirmed", self.language, {"port": opening.printable_name(self.port)}
            )
        self._is_detached = False
        if self._follower is not None and self._ending is None:
            self._ending = Ending("STOPPED", cause="SEQUENCE")

    def _close_port(self, holds_port: bool = False) -> None:
        """Close the port: at once, or where it `holds_port` once no other command drives the robot
        through it, which a thread waits for. The run of a client ends with this server."""
        if not holds_port or not self._client.holds_for_others:
            self._client.close()
            return
        text = languages.text("library", "holds_for_others", self.language)
        warnings.warn(
            text.format(port=opening.printable_name(self.port)), RuntimeWarning, stacklevel=4
        )
        Thread(target=self._hold_port, name="holder").start()

    def _hold_port(self) -> None:
        try:
            with suppress(RobotError):  # the port is lost
                self._client.hold_for_others()
        finally:
            self._client.close()

    def _await_saving(self) -> None:
        """Wait until the uploaded program is saved. Raises RobotError if it is not."""
        saving, self._saving = self._saving, None
        if saving is None:
            return
        status = self._client.request(Requester.status).values
        if status.state == STATE_RUNNING:  # detached: it saves later
            self._saving = saving
            return

        saving.update(status)
        for _ in saving.polls():
            saving.update(self._client.request(Requester.status).values)
            if not saving.is_over:
                self._client.event(POLL_INTERVAL_S)
        if saving.reason:
            raise RobotError(saving.reason, self.language)

    # -- asking -----------------------------------------------------------------------------------

    def _meet(self, is_robot_named: bool) -> None:
        device_info = self._client.meet()
        if not is_robot_named and device_info.kit != self._profile.kit.fingerprint:
            self._profile = robot_of_kit(device_info.kit) or self._profile
        opening.remember(self.port, device_info.name)

    def _check_open(self) -> None:
        if self._is_closed:
            raise UsageError("closed", self.language)

    def _prepare(self, program: Program | str | bytes) -> Program:
        is_program = isinstance(program, Program)
        ready_program = program_of(program, None if is_program else self._profile, self.language)
        if ready_program._map is not None:
            self._reader.map_by_checksum[ready_program.checksum] = ready_program._map
        return ready_program

    def _begin_run(self, receipt: ReceiptReply, is_running: bool, is_detached: bool) -> Receipt:
        # a program that waits for the button has no run number yet
        if is_running:
            self._reader.begin(receipt.run, receipt.program)
        self._follower = Follower(receipt.run if is_running else None)
        self._ending = None
        self._is_replaced = False
        self._is_detached = is_detached and is_running
        return Receipt(receipt.program, saved_name(receipt.saved), is_running)


def connect(
    port: str | None = None, *, robot: str | os.PathLike[str] | None = None,
    baud: int | None = None, language: Language = "en",
) -> RobotConnection:  # fmt: skip
    """Connect to the robot on a port: /dev/ttyUSB0, COM5, ble://name, socket://host:port, ...

    By default, the last port used, or else the port of the only running virtual robot.
    `robot` is the name or the path of the profile that texts are compiled for; its default is the
    profile of the robot that answers, if this computer knows it. `baud` is 300 to 2000000; its
    default is in the profile. Raises RobotError if the port does not open or no robot answers.
    """
    profile = profile_of(robots.DEFAULT if robot is None else robot, language)
    if baud is not None:
        check_whole_number("baud", baud, opening.SLOWEST_BAUD, opening.FASTEST_BAUD, language)
    if port is None:
        port = _default_port(language)
    elif not isinstance(port, str) or not port.strip() or not port.isprintable():
        raise UsageError(
            "bad_port", language, {"port": printable(repr(port), opening.MAX_NAME_CHARACTERS)}
        )
    return RobotConnection(port, profile, robot is not None, baud, language)


def _default_port(language: Language) -> str:
    """Return the last port used, or else the port of the only running virtual robot.

    Raises RobotError if there is neither.
    """
    if (usable_port := opening.usable_last_port()) is not None:
        return usable_port
    last_port = known_ports.remembered_ports().last_port
    running_robots = directory.unclaimed_robots()
    if len(running_robots) == 1:
        return running_robots[0].address
    port_names = [port_info.port for port_info in ports.list_ports()]
    values = {"known": opening.printable_name(", ".join(port_names)) or "-",
              "example": port_names[0] if port_names else "/dev/ttyUSB0"}  # fmt: skip
    if last_port is not None:
        raise RobotError(
            "last_port_missing", language, {**values, "port": opening.printable_name(last_port)}
        )
    raise RobotError("which_port", language, values)
