"""A connection to a robot: programs and lines go there, events come back, and it stops at the end.

Leaving the `with` block stops the robot and waits until it has confirmed that. A process that ends
without it is noticed by the robot, which stops within a second.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.library import way
from tiniscript.library.endings import Follower
from tiniscript.library.errors import ProgramError, RobotError, StopNotConfirmed, UsageError
from tiniscript.library.events import Ending, Reader, RobotEvent, ending_of
from tiniscript.library.programs import Language, Program, program_of
from tiniscript.library.runs import within
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_SAVING, SAVED_STORED
from tiniscript.printable import printable

if TYPE_CHECKING:
    from typing import IO, TypeVar

    from tiniscript.link.connection import Asked, Asks, Way
    from tiniscript.link.line import Line
    from tiniscript.link.outcomes import Event
    from tiniscript.link.requests import Reply
    from tiniscript.robots.profile import Robot
    from tiniscript.sharing.server import Host

    Self = TypeVar("Self", bound="RobotConnection")

VERB = "python"  # what other commands are told of who holds the port
PATIENCE_MS = 6000  # for which a robot that has answered may be silent, or busy with saving
LONGEST_S = 10**9
SAVE_S = 10.0  # for which a robot may save a program when its motors stand
LOW_S = 2.0  # for which its voltage may be too low for that
LOOK_S = 0.1


class RobotInfo(NamedTuple):
    """What a robot has said of itself. `name` is the one that it was given, or empty; `robot` the
    name of its profile, or None for one that is not known here; `room` in bytes of code."""

    name: str
    id: int
    robot: str | None
    port: str
    room: int


class Receipt(NamedTuple):
    """What the robot holds or does now. `checksum` is that of the program's image; `saved` is
    MEMORY, SAVING, STORED, LOW_SUPPLY or NOTHING, as in docs/link.md."""

    checksum: int
    saved: str
    is_running: bool


class RobotConnection:
    """A robot that has answered. One thread at a time uses it.

    As a context manager it is left by `close`; by an exception too, Ctrl-C among them: then the
    robot is stopped in any case.
    """

    def __init__(
        self, port: str, profile: Robot, is_named: bool, baud: int | None, language: Language
    ) -> None:
        """For the functions of this library: `connect` makes connections."""
        self.port = port
        self.language = language
        self._profile = profile
        self._reader = Reader()
        self._follower: Follower | None = None
        self._ending: Ending | None = None
        self._is_detached = False
        self._is_saving = False
        self._is_closed = False
        speed = profile.board.baud if baud is None else baud

        def open_line(lock: IO[bytes] | None) -> Line:
            kit = profile.kit.fingerprint
            return way.opened_line(port, speed, kit, lock=lock, language=language)

        self._line: Way = way.way_to(port, VERB, open_line, baud, language)
        self._host: Host | None = None
        try:
            self._host = _shared(self._line, port, speed)
            self._meet(is_named)
        except BaseException:
            self._part()
            raise

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:  # fmt: skip
        self._leave(is_calm=kind is None)

    @property
    def info(self) -> RobotInfo:
        """Who the robot is."""
        card = self._line.robot
        assert card is not None
        from tiniscript.library.known_kits import of_kit

        profile = of_kit(card.kit)
        name = None if profile is None else profile.name
        return RobotInfo(printable(card.name), card.id, name, self.port, card.room)

    def upload(
        self, program: Program | str | bytes, *, run: bool = True, save: bool = True,
        detached: bool = False,
    ) -> Receipt:  # fmt: skip
        """Bring a program to the robot, and start it there if it begins with SI.

        `run=False` starts nothing, `save=False`: the robot forgets it when it is switched off,
        `detached`: it goes on when this connection is left. Returns when the robot has it, before
        it has ended: `wait` and `events` are for that. Raises ProgramError, RobotError.
        """
        self._check_open()
        ready = self._ready(program)
        if ready.start == "PING":
            raise UsageError("ping_program", self.language)
        image = ready._image
        reply = self._ask(lambda session: session.upload(image, run, save, detached))
        self._is_saving = save
        return self._begun(reply, run and ready.start == "SI", detached)

    def live(self, line: str) -> Receipt:
        """Have a line done once, at most 55 bytes of code; the stored program stays what it is.

        Returns when it has begun: `wait` waits for its end. Each line stands alone: variables do
        not outlive it. Raises ProgramError, RobotError.
        """
        self._check_open()
        ready = self._ready(line)
        if ready.start != "SI":
            raise UsageError(
                "live_button" if ready.start == "SB" else "ping_program", self.language
            )
        image = ready._image
        reply = self._ask(lambda session: session.live(image.code, image.kit))
        return self._begun(reply, True, False)

    def start(self, *, detached: bool = False) -> Receipt:
        """Start the program that the robot holds."""
        self._check_open()
        reply = self._ask(lambda session: session.start(detached))
        return self._begun(reply, True, detached)

    def events(self, timeout: float | None = None) -> Iterator[RobotEvent]:
        """Yield what the robot tells, until the program that was started here has ended (that
        event is the last one) or `timeout` seconds have passed. Where nothing was started here,
        only the time ends it: None is for ever. Raises RobotError where the robot is lost.
        """
        self._check_open()
        if timeout is not None:
            within("timeout", timeout, 0, LONGEST_S, self.language)
        end_s = None if timeout is None else monotonic() + timeout
        anything = Follower(None)
        while self._follower is None or self._ending is None:
            follower = self._follower or anything
            left_s = LOOK_S if end_s is None else min(LOOK_S, end_s - monotonic())
            found = self._event(max(left_s, 0.0))
            told = None
            if found is not None and follower.is_about(
                found[1], way.shown(self.port), self.language
            ):
                told = self._reader.told(*found)
                if told is not None and follower.end(found[1]) is not None and self._follower:
                    self._ending = ending_of(told)
            if told is not None:
                yield told
            # what came in time is told, however late it is
            last_s = monotonic() if found is None else found[0] / 1000
            if end_s is not None and last_s >= end_s:
                return

    def wait(self, timeout: float | None = None) -> Ending:
        """Wait until the program that was started here has ended, and is saved if it was uploaded.

        Raises RobotError where the robot is lost, and with the reason `still_running` after
        `timeout` seconds: the program goes on then.
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

    def stop(self) -> None:
        """Stop the robot now; return when it has confirmed that. Raises StopNotConfirmed."""
        self._check_open()
        self._stop()

    def close(self) -> None:
        """Stop the robot, unless its program is detached, and leave the port. A second time does
        nothing. Raises StopNotConfirmed."""
        self._leave(is_calm=True)

    # -- leaving ----------------------------------------------------------------------------------

    def _leave(self, is_calm: bool) -> None:
        if self._is_closed:
            return
        self._is_closed = True
        try:
            if not (is_calm and self._is_detached):
                self._stop()
            if is_calm:
                self._await_saving()
        finally:
            self._part()

    def _stop(self) -> None:
        if not way.confirmed(self._line):
            raise StopNotConfirmed("not_confirmed", self.language, {"port": way.shown(self.port)})
        self._is_detached = False
        if self._follower is not None and self._ending is None:
            self._ending = Ending("STOPPED", cause="SEQUENCE")

    def _part(self) -> None:
        """Leave the port. A run of another command that came through here has nobody then."""
        try:
            if self._host is not None:
                has_run = self._host.has_run
                self._host.close()
                if has_run:
                    way.confirmed(self._line)
        finally:
            self._line.close()

    def _await_saving(self) -> None:
        """Wait until the uploaded program is saved: whoever opens the port next may reset the
        robot. Raises RobotError where it is not."""
        from tiniscript.link.messages import STATES

        begun_s = monotonic()
        low_s: float | None = None
        while self._is_saving:
            status = self._ask(lambda session: session.status()).values
            saved = status["saved"]
            if STATES[int(status["state"])][0] == "RUNNING":  # detached: when its motors stand
                return
            if saved not in (SAVED_SAVING, SAVED_LOW_SUPPLY):
                self._is_saving = False
                if saved != SAVED_STORED:
                    raise RobotError("not_saved", self.language)
                return
            low_s = (low_s or monotonic()) if saved == SAVED_LOW_SUPPLY else None
            if low_s is not None and monotonic() > low_s + LOW_S:
                self._is_saving = False
                raise RobotError("low_supply", self.language)
            if monotonic() > begun_s + SAVE_S:
                self._is_saving = False
                raise RobotError("saves_later", self.language)
            self._event(LOOK_S)

    # -- asking -----------------------------------------------------------------------------------

    def _meet(self, is_named: bool) -> None:
        from tiniscript.link.outcomes import CANCELLED

        reply = way.met(self._line, self.port, self._profile.board.chip, self._wait)
        while reply.status == CANCELLED:  # a stop came first
            reply = self._wait(way.hello(self._line, way.ANSWER_MS))
        card = self._line.robot
        if reply.status or card is None:
            raise self._error(reply)
        if not is_named and card.kit != self._profile.kit.fingerprint:
            from tiniscript.library.known_kits import of_kit

            self._profile = of_kit(card.kit) or self._profile
        way.remember(self.port, card.name)

    def _check_open(self) -> None:
        if self._is_closed:
            raise UsageError("closed", self.language)

    def _ready(self, program: Program | str | bytes) -> Program:
        is_made = isinstance(program, Program)
        ready = program_of(program, None if is_made else self._profile, self.language)
        if ready._map is not None:
            self._reader.maps[ready.checksum] = ready._map
        return ready

    def _begun(self, reply: Reply, is_running: bool, is_detached: bool) -> Receipt:
        from tiniscript.link.messages import SAVED

        run, program, saved = (reply.values[name] for name in ("run", "program", "saved"))
        assert isinstance(run, int) and isinstance(program, int) and isinstance(saved, int)
        # one that waits for the button has no number yet
        self._follower = Follower(run if is_running else None)
        self._ending = None
        self._is_detached = is_detached and is_running
        name = SAVED[saved][0] if saved < len(SAVED) else "MEMORY"
        return Receipt(program, name, is_running)

    def _ask(self, make: Callable[[Asks], Asked]) -> Reply:
        with_limit = way.limited(make, PATIENCE_MS)
        try:
            task = self._line.do(with_limit)
        except Exception as gone:
            raise self._gone(gone) from None
        reply = self._wait(task)
        if reply.status:
            raise self._error(reply)
        return reply

    def _wait(self, task: Asked) -> Reply:
        from tiniscript.link.outcomes import Gone

        try:
            return self._line.wait(task)
        except Gone as gone:
            raise self._gone(gone) from None

    def _event(self, limit_s: float) -> tuple[int, Event] | None:
        from tiniscript.link.outcomes import Gone

        try:
            return self._line.event(limit_s)
        except Gone as gone:
            raise self._gone(gone) from None

    def _gone(self, gone: Exception) -> BaseException:
        from tiniscript.link.outcomes import Gone

        if not isinstance(gone, Gone):
            return gone
        reason = way.reason_of_end(self._line, gone)
        values = {"port": way.shown(self.port), "verb": self._line.held_by}
        return RobotError(reason, self.language, values)

    def _error(self, reply: Reply) -> RobotError | ProgramError:
        from tiniscript.link.statuses import name_of, sentence

        reason = way.reason_of(self._line, reply)
        if reason != "status":
            return RobotError(reason, self.language, {"port": way.shown(self.port)})
        said = " ".join(sentence(reply.status, reply.detail, self.language)).strip()
        name = name_of(reply.status)
        kind = ProgramError if name == "TOO_LARGE" else RobotError
        return kind(name, self.language, said=said)


def _shared(line: Way, port: str, baud: int) -> Host | None:
    """Let other commands use the port meanwhile: so `tsc stop` gets through."""
    if line.held_by:
        return None
    from tiniscript.link.line import Line
    from tiniscript.sharing.server import Host

    assert isinstance(line, Line)
    with suppress(OSError):
        return Host(line, port, baud, VERB)
    return None
