"""The state of the robot, as known from its replies and events.

Knows which run is ours, which has ended, which program runs and where it was last. Knows no frame
and no time, and sends no request.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from tiniscript.link.messages import (
    PLACE_BYTES,
    SHOW_PLACE_BYTES,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
)
from tiniscript.link.outcomes import Event, PlaceEvent, ShownEvent
from tiniscript.link.payloads import (
    DoneEvent,
    FaultEvent,
    HaltedEvent,
    HelloReply,
    PingReply,
    ReceiptReply,
    ResumeReply,
    SentReply,
    ShowEvent,
    StatusReply,
    StoppedEvent,
)

_PLACE = struct.Struct("<HI")
_SHOW_PLACE = struct.Struct("<BH")
assert (_PLACE.size, _SHOW_PLACE.size) == (PLACE_BYTES, SHOW_PLACE_BYTES)


class _Run(NamedTuple):
    """A run is one of its epoch: a robot that was reset counts its runs anew."""

    epoch: int
    number: int


class UnresolvedShow(NamedTuple):
    """A value that has arrived, in an epoch; its program is not looked up yet."""

    event: ShowEvent
    epoch: int

    @property
    def _run(self) -> _Run | None:
        """The run, or None for an older robot, which does not report it."""
        if len(self.event.place) != SHOW_PLACE_BYTES:
            return None
        return _Run(self.epoch, self.event.place[0])


def line_error_count(status: StatusReply) -> int:
    """Return the number of line errors that a robot has counted since its reset."""
    return status.damaged + status.dropped + status.framing + status.overrun


class RobotState:
    def __init__(self) -> None:
        self.state = STATE_IDLE
        self.run: int | None = None  # the run that we have started
        self._ended_run: int | None = None  # the last run whose end is known
        self._is_going = False  # our run has begun, and its end is unknown
        self._is_end_asked = False  # whether the reason of the end has been requested
        self.has_reset_ended_run = False  # a reset has ended it
        self._event_seq: int | None = None
        self._last_place: PlaceEvent | None = None  # the last one reported
        self.halt_event: HaltedEvent | None = None  # the halt of the current program
        self._known_program: tuple[_Run, int] | None = None  # the newest run whose program is known
        self._asked_run: _Run | None = None  # the newest one that was asked about

    @property
    def is_running(self) -> bool:
        return self.state == STATE_RUNNING

    @property
    def is_latched(self) -> bool:
        return self.state > STATE_RUNNING

    def note_reset(self) -> None:
        """Note that the robot was reset: its counters start again."""
        self.has_reset_ended_run = self._is_going or self._is_end_asked
        self._is_going = self._is_end_asked = False
        self._event_seq = self.run = self._ended_run = self._last_place = None
        self._known_program = self._asked_run = self.halt_event = None

    def count_missed(self, seq: int) -> int:
        """Take the number of an event; return how many events before it are missing."""
        earlier_seq, self._event_seq = self._event_seq, seq
        return 0 if earlier_seq is None else (seq - earlier_seq - 1) & 0xFF

    def may_be_reset(self, values: SentReply) -> bool:
        """Process a reply in another epoch; return whether neither a stop nor a fault explains
        it."""
        if not isinstance(values, (PingReply, StatusReply)):
            return False
        return values.state <= STATE_RUNNING or self.run not in (None, values.run)

    def take_reply(self, values: SentReply, epoch: int) -> bool:
        """Process a reply of an epoch; return whether it reports the end of our run before an event
        does.
        """
        self._learn_program(values, epoch)
        if isinstance(values, (ReceiptReply, ResumeReply)):
            self.halt_event = None
        if isinstance(values, ReceiptReply):
            self.run = values.run
        if not isinstance(values, (HelloReply, PingReply, StatusReply)):
            return False
        self.state = values.state
        if self.is_running and values.run == self.run:
            return False
        if not self._is_going or isinstance(values, HelloReply):
            return False
        self._is_going, self._is_end_asked = False, True
        return True

    # Finds the program of a SHOW. Replies and events arrive in order, so no value of an earlier run
    # follows a reply that names a later one.

    def _learn_program(self, values: SentReply, epoch: int) -> None:
        if isinstance(values, ReceiptReply):
            self._known_program = _Run(epoch, values.run), values.program
        elif isinstance(values, PingReply) and len(values.place) == PLACE_BYTES:
            self._known_program = _Run(epoch, values.run), _PLACE.unpack(values.place)[1]
        elif isinstance(values, (HelloReply, PingReply, StatusReply)):
            # `program` in STATUS is the stored program, which need not be the running one.
            if self._known_program is not None and self._known_program[0] != (epoch, values.run):
                self._known_program = None

    def claim_query(self, show: UnresolvedShow) -> bool:
        """Return whether only the robot knows a value's program and was not asked; marks it as
        asked.
        """
        run = show._run
        if (
            run is None
            or run == self._asked_run
            or (self._known_program and self._known_program[0] == run)
        ):
            return False
        self._asked_run = run
        return True

    def to_shown_event(self, show: UnresolvedShow) -> ShownEvent:
        """Return a value as the event that it is: with its program and its SHOW, if both are
        known."""
        value, is_yes_no, place, _ = show.event
        if self._known_program is None or show._run != self._known_program[0]:
            return ShownEvent(value, is_yes_no)
        run, offset = _SHOW_PLACE.unpack(place)
        return ShownEvent(value, is_yes_no, run, self._known_program[1], offset)

    def has_ended(self, run: int | None) -> bool:
        """Return whether the end of a run is known: it is reported then, and only once."""
        return run is not None and self._ended_run == run

    def end(self) -> None:
        """Note that the end of our run is known, without an event."""
        self._ended_run, self._is_end_asked = self.run, False

    def note_replaced(self) -> list[Event]:
        """Record that a program waiting for its start has ended our run; return the event that
        reports this."""
        is_going, run = self._is_going, self.run
        self.forget_run()
        if not is_going or run is None:
            return []
        self.end()
        return [DoneEvent(run)]

    def update_place(self, values: SentReply) -> list[PlaceEvent]:
        """Take a reply; return where the program is now, if that is another place than before."""
        if not isinstance(values, PingReply):
            return []
        earlier_place, self._last_place = self._last_place, None
        if values.state == STATE_RUNNING and len(values.place) == PLACE_BYTES:
            offset, program = _PLACE.unpack(values.place)
            self._last_place = PlaceEvent(values.run, program, offset)
        elif earlier_place is not None:
            return [earlier_place._replace(offset=-1)]
        return [self._last_place] if self._last_place and self._last_place != earlier_place else []

    def take_event(self, event: Event) -> None:
        if isinstance(event, (StoppedEvent, FaultEvent, DoneEvent)):
            self._last_place = self.halt_event = None  # after the end, neither is needed
        if isinstance(event, HaltedEvent):
            self.halt_event = event
        if isinstance(event, (StoppedEvent, FaultEvent)):
            self.state = STATE_STOPPED
            self._is_going = self._is_end_asked = False
        if isinstance(event, (DoneEvent, FaultEvent)):
            self._ended_run = event.run
            if isinstance(event, DoneEvent) and event.run == self.run:
                self.state = STATE_IDLE
                self._is_going = self._is_end_asked = False

    def note_begun(self, run: int) -> None:
        """Note that a run has begun, unless its end arrived before its receipt."""
        if run != self._ended_run:
            self.state = STATE_RUNNING
            self._is_going = True

    def forget_run(self) -> None:
        """Note that the latch is released or the robot is lost."""
        self.state = STATE_IDLE
        self._last_place = self.halt_event = None
        self._is_going = self._is_end_asked = False
