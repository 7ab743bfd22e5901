"""A client of a robot: its port, shared with other commands, and the requests on it.

The command, the connections of the library and the studio all use it. Failures are `RobotError`s:
the command puts their reason and values into sentences of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from time import monotonic, sleep
from typing import TYPE_CHECKING, TypeVar

from tiniscript.bytecode.image import Image
from tiniscript.library import opening
from tiniscript.library.errors import ProgramError, RobotError
from tiniscript.library.refusing import refusal
from tiniscript.link import errors
from tiniscript.link.connection import (
    EXCHANGE_TIMEOUT_MS,
    FOREIGN,
    PendingRequest,
    Requester,
    find_stranger,
    reason_of,
)
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_SAVING, SAVED_STORED
from tiniscript.link.outcomes import CANCELLED, LOST, POLL_INTERVAL_S, ConnectionLost, Event
from tiniscript.link.payloads import HelloReply, ReceiptReply, StatusReply
from tiniscript.link.port_names import is_at_broker, is_bluetooth_le
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.link.statuses import name_of, status_text
from tiniscript.robots.profile import Robot

if TYPE_CHECKING:
    from tiniscript.link.sharing.server import Server

    T = TypeVar("T")

REQUEST_TIMEOUT_MS = (
    EXCHANGE_TIMEOUT_MS  # time without progress after which a robot counts as silent or busy
)
SAVE_TIMEOUT_S = 10.0  # timeout for saving a program while the motors are off
# Timeout while the voltage is too low for saving: the robot checks every 0.5 s.
LOW_VOLTAGE_TIMEOUT_S = 2.0


class Client:
    """The connection to a port, from the constructor until `close`; one thread uses it.

    `connection` is the connection itself; `server` shares it, or is None.
    """

    def __init__(
        self, port: str, verb: str, profile: Robot, baud: int | None = None, language: str = "en",
        timeout_s: float = opening.OPEN_TIMEOUT_S, is_shared: bool = True,
        is_latched: Callable[[], bool] = lambda: False, poll: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        """Connect to a port through its server, or open it. Raises RobotError.

        `verb` is the name that other commands show for this one. `baud` is the speed that the user
        asked for, otherwise that of the profile. While `is_latched` no other command starts a run.
        `poll` is called before every request, and repeatedly in every wait.
        """
        self._poll = poll
        self.port = port
        self.profile = profile
        self.language = language
        speed = profile.board.baud if baud is None else baud
        kit = profile.kit.fingerprint
        self.connection = opening.connection_to(port, verb, speed, kit, timeout_s, baud, language)
        self.server: Server | None = None
        try:
            if is_shared and not self.connection.holder_verb:
                self.server = self._share(speed, verb, is_latched)
        except BaseException:
            self.connection.close()
            raise

    def _share(self, baud: int, verb: str, is_latched: Callable[[], bool]) -> Server | None:
        """Share the port with other commands, so that `tsc stop` works meanwhile."""
        from tiniscript.link.port_connection import PortConnection
        from tiniscript.link.sharing.server import Server

        assert isinstance(self.connection, PortConnection)
        with suppress(OSError):
            return Server(self.connection, self.port, baud, verb, is_latched)
        return None

    @property
    def holds_for_others(self) -> bool:
        """Return whether another command drives the robot through this one, or is about to, so that
        the end of this command must not stop its program.
        """
        server = self.server
        return server is not None and not self.connection.has_ended and server.is_needed

    @property
    def drives_another(self) -> bool:
        """Return whether the robot runs a program that another command started through this one."""
        return self.server is not None and self.server.has_owned_run

    def hold_for_others(self, goes_on: Callable[[], bool] = lambda: True) -> None:
        """Hold the port until they have ended. Raises RobotError if it is lost."""
        while self.holds_for_others and goes_on():
            self.event()

    def close(self, stop_s: float | None = None, must_stop_run: bool = False) -> None:
        """Close the port. First stop the runs of the server's clients, or possible ones if
        `must_stop_run`: wait `stop_s` for that, by default as long as a stop may take.
        """
        try:
            if self.server is not None:
                self.server.close()  # until then a client may start a run
                # Its client can no longer stop the run.
                must_stop_run = must_stop_run or self.server.may_have_owned_run
            if must_stop_run and not self.connection.has_ended:
                self.stop(stop_s)
        finally:
            self.connection.close()

    @property
    def device_info(self) -> DeviceInfo:
        """The robot's answer to HELLO; call `meet` first."""
        assert self.connection.robot is not None
        return self.connection.robot

    # -- requests: all raise RobotError where the connection has ended ----------------------------

    def meet(self, board: str = "", should_retry: Callable[[], bool] = lambda: True) -> DeviceInfo:
        """Send HELLO until the robot answers. Raises RobotError if none does.

        `board` replaces the board of the profile. If `should_retry()`, a stop that comes first does
        not end the search.
        """
        reply = self.hello(board)
        while reply.status == CANCELLED and should_retry():
            reply = self.wait(self.search())
        if reply.status or self.connection.robot is None:
            raise self.error_for_reply(reply)
        return self.connection.robot

    def hello(self, board: str = "") -> Reply[HelloReply]:
        """Send HELLO, but not so early that a board stays in its bootloader."""
        if self.connection.holder_verb:  # the port is open already
            return self.wait(self.search())
        from tiniscript.link import ports

        if ports.is_radio(self.port):  # opening a cable's port resets the board
            return self.wait(self.search())
        sleep(opening.QUIET_S_BY_BOARD.get(board or self.profile.board.chip, 0.0))
        reply = self.wait(self.search(opening.CABLE_ANSWER_TIMEOUT_MS))
        if not self.connection.heard_count:
            sleep(opening.LONG_QUIET_S)
            reply = self.wait(self.search(opening.CABLE_ANSWER_TIMEOUT_MS))
        if reply.status == LOST and self.connection.heard_count and not self.connection.is_echoed:
            return self.wait(self.search())  # the data may come from a robot that answers late
        return reply

    def search(self, limit_ms: int | None = None) -> PendingRequest[HelloReply]:
        """Begin a session. HELLO is repeated until the robot answers, as a reset takes a while."""
        return self.begin_request(
            lambda session: session.hello(), limit_ms or opening.ANSWER_TIMEOUT_MS
        )

    def begin_request(
        self, make_request: Callable[[Requester], PendingRequest[T]], limit_ms: int | None = None
    ) -> PendingRequest[T]:
        """Begin a request with a timeout."""

        def with_limit(session: Requester) -> PendingRequest[T]:
            request = make_request(session)
            request.limit_ms = limit_ms or REQUEST_TIMEOUT_MS
            return request

        self._poll()  # a robot that answers at once causes no wait
        with self._convert_loss():
            return self.connection.begin(with_limit)

    def wait(
        self, request: PendingRequest[T], on_wait: Callable[[], None] | None = None
    ) -> Reply[T]:
        def poll() -> None:
            self._poll()
            if on_wait is not None:
                on_wait()

        with self._convert_loss():
            return self.connection.wait(request, poll)

    def request(
        self,
        begin_request: Callable[[Requester], PendingRequest[T]],
        accepted_statuses: Collection[int] = (),
    ) -> Reply[T]:
        """Return the reply to a request: OK, or one of `accepted_statuses`. Raises RobotError."""
        reply = self.wait(self.begin_request(begin_request))
        if reply.status and reply.status not in accepted_statuses:
            raise self.error_for_reply(reply)
        return reply

    def event(self, timeout_s: float = POLL_INTERVAL_S) -> tuple[int, Event] | None:
        """Return the time (ms) and the next event, or None if none arrives in time."""
        self._poll()
        with self._convert_loss():
            return self.connection.event(timeout_s)

    def send_program(
        self, image: Image, runs: bool, saves: bool, is_detached: bool,
        on_progress: Callable[[int], None] = lambda done_bytes: None, profile: Robot | None = None,
    ) -> Reply[ReceiptReply]:  # fmt: skip
        """Send a program to the robot that was verified for `profile`, by default that of the
        client; return the reply.

        It is refused before any byte is sent where the robot has another kit. `on_progress` gets
        the number of code bytes that have arrived.
        """
        profile = profile or self.profile
        refused_reply = refusal(image, profile, self.device_info)
        if refused_reply is not None:
            return refused_reply
        kit = profile.kit.fingerprint
        request = self.begin_request(
            lambda session: session.upload(image, runs, saves, is_detached, kit)
        )
        return self.wait(request, lambda: on_progress(request.done_bytes))

    def stop(self, timeout_s: float | None = None) -> bool:
        """Stop the robot; return whether it has confirmed. A second Ctrl-C ends the wait.

        The default of `timeout_s` is CONFIRM_TIMEOUT_S. Events from before the call do not count.
        """
        end_s = monotonic() + (opening.CONFIRM_TIMEOUT_S if timeout_s is None else timeout_s)
        stop_ms = self.connection.stop()
        try:
            while monotonic() < end_s:
                timed_event = self.connection.event()
                if timed_event is None or timed_event[0] < stop_ms:
                    continue
                if timed_event[1].name in ("STOPPED", "LOST"):
                    return timed_event[1].name == "STOPPED"
        except (ConnectionLost, KeyboardInterrupt):
            pass
        return False

    @contextmanager
    def _convert_loss(self) -> Iterator[None]:
        try:
            yield
        except ConnectionLost as loss:
            raise self.error_for_loss(loss) from None

    # -- failures ---------------------------------------------------------------------------------

    def error_for_loss(self, loss: ConnectionLost) -> Exception:
        """Return the error for a connection that has ended."""
        return self.robot_error_for_loss(loss)

    def robot_error_for_loss(self, loss: ConnectionLost) -> RobotError:
        reason = self._reason_of_end(loss)
        values = {"port": opening.printable_name(self.port), "verb": self.connection.holder_verb}
        return RobotError(reason, self.language, values)

    def _reason_of_end(self, loss: ConnectionLost) -> str:
        if loss.is_server:
            return "holder_ended"
        if is_bluetooth_le(self.port):
            return "radio_gone"
        if is_at_broker(self.port):
            return "port_taken" if str(loss) == errors.TAKEN else "broker_gone"
        if (
            self.connection.heard_count and self.connection.robot is None
        ):  # the port was busy, and is closed
            return "port_busy"
        return "port_gone"

    def foreign_board_sentences(self) -> tuple[str, str]:
        """Return the sentences on the board that answers instead of a robot."""
        from tiniscript.link.foreign import explain

        board = find_stranger(self.connection)
        assert board is not None
        return explain(board, self.language)

    def error_for_reply(self, reply: Reply[object]) -> Exception:
        """Return the error for a reply that is not OK."""
        reason = reason_of(self.connection, reply)
        if reason != "status":
            values = {"port": opening.printable_name(self.port), "id": f"{reply.detail:08x}"}
            if reason == FOREIGN:
                values["what"], values["then"] = self.foreign_board_sentences()
            return RobotError(reason, self.language, values)
        text = " ".join(status_text(reply.status, reply.detail, self.language)).strip()
        name = name_of(reply.status)
        error_type = ProgramError if name == "TOO_LARGE" else RobotError
        return error_type(name, self.language, sentence_text=text)


class Saving:
    """The progress of saving a program. The next command that opens the port may reset the robot,
    which would interrupt the save.
    """

    def __init__(self, receipt: ReceiptReply) -> None:
        self.program, self.saved = receipt.program, receipt.saved

    @property
    def is_over(self) -> bool:
        return self.saved not in (SAVED_SAVING, SAVED_LOW_SUPPLY)

    def update(self, status: StatusReply) -> None:
        """Update from a robot's status; another program has been sent meanwhile."""
        self.saved = status.saved if status.program == self.program else SAVED_STORED

    def polls(self) -> Iterator[None]:
        """Yield while it is worth waiting, because the motors are off: learn the status each
        time."""
        begun_s = monotonic()
        low_since_s: float | None = None
        while not self.is_over and monotonic() < begun_s + SAVE_TIMEOUT_S:
            yield
            low_since_s = (low_since_s or monotonic()) if self.saved == SAVED_LOW_SUPPLY else None
            if low_since_s is not None and monotonic() > low_since_s + LOW_VOLTAGE_TIMEOUT_S:
                return

    @property
    def reason(self) -> str:
        """The key of the reason why it is not saved, or an empty text."""
        reasons = {SAVED_STORED: "", SAVED_SAVING: "saves_later", SAVED_LOW_SUPPLY: "low_supply"}
        return reasons.get(self.saved, "not_saved")  # its memory is worn out
