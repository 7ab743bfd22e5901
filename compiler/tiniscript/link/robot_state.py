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


class Unnamed(NamedTuple):
    """A value that has arrived, in an epoch; its program is not looked up yet."""

    show: ShowEvent
    epoch: int

    @property
    def _run(self) -> _Run | None:
        """The run, or None of an older robot, which does not tell it."""
        if len(self.show.place) != SHOW_PLACE_BYTES:
            return None
        return _Run(self.epoch, self.show.place[0])


def line_error_count(status: StatusReply) -> int:
    """Return how many errors of its line a robot has counted since its reset."""
    return status.damaged + status.dropped + status.framing + status.overrun


class RobotState:
    def __init__(self) -> None:
        self.state = STATE_IDLE
        self.run: int | None = None  # the run that we have started
        self._ended: int | None = None  # the last run whose end we know
        self._is_going = False  # our run has begun, and nothing says that it has ended
        self._is_asked = False  # how it has ended is
        self.is_cut = False  # a reset has ended it
        self._event_seq: int | None = None
        self._place: PlaceEvent | None = None  # the last one that was told
        self.halted: HaltedEvent | None = None  # where a program is halted
        self._known: tuple[_Run, int] | None = None  # the newest run whose program is known
        self._asked: _Run | None = None  # the newest one that was asked about

    @property
    def is_running(self) -> bool:
        return self.state == STATE_RUNNING

    @property
    def is_latched(self) -> bool:
        return self.state > STATE_RUNNING

    def reset(self) -> None:
        """Note that the robot was reset: its counters start again."""
        self.is_cut = self._is_going or self._is_asked
        self._is_going = self._is_asked = False
        self._event_seq = self.run = self._ended = self._place = None
        self._known = self._asked = self.halted = None

    def count_missed(self, seq: int) -> int:
        """Take the number of an event; return how many events before it are missing."""
        before, self._event_seq = self._event_seq, seq
        return 0 if before is None else (seq - before - 1) & 0xFF

    def may_be_reset(self, values: SentReply) -> bool:
        """Take a reply in another epoch; return whether neither stop nor fault explains that."""
        if not isinstance(values, (PingReply, StatusReply)):
            return False
        return values.state <= STATE_RUNNING or self.run not in (None, values.run)

    def learn(self, values: SentReply, epoch: int) -> bool:
        """Take a reply of an epoch; return whether it tells of the end of our run, of which no
        event has."""
        self._learn_program(values, epoch)
        if isinstance(values, (ReceiptReply, ResumeReply)):
            self.halted = None
        if isinstance(values, ReceiptReply):
            self.run = values.run
        if not isinstance(values, (HelloReply, PingReply, StatusReply)):
            return False
        self.state = values.state
        if self.is_running and values.run == self.run:
            return False
        if not self._is_going or isinstance(values, HelloReply):
            return False
        self._is_going, self._is_asked = False, True
        return True

    # Which program's SHOW a value is of. Replies and events come in their order: no value of an
    # earlier run comes after a reply that names a later one.

    def _learn_program(self, values: SentReply, epoch: int) -> None:
        if isinstance(values, ReceiptReply):
            self._known = _Run(epoch, values.run), values.program
        elif isinstance(values, PingReply) and len(values.place) == PLACE_BYTES:
            self._known = _Run(epoch, values.run), _PLACE.unpack(values.place)[1]
        elif isinstance(values, (HelloReply, PingReply, StatusReply)):
            # `program` of STATUS is the one that the robot holds, which need not be what runs
            if self._known is not None and self._known[0] != (epoch, values.run):
                self._known = None

    def claim_query(self, value: Unnamed) -> bool:
        """Whether only the robot knows the program of a value, and was not asked. It is now."""
        run = value._run
        if run is None or run == self._asked or (self._known and self._known[0] == run):
            return False
        self._asked = run
        return True

    def to_shown_event(self, value: Unnamed) -> ShownEvent:
        """Return a value as the event that it is: with its program and its SHOW, if both are
        known."""
        number, is_yes_no, place, _ = value.show
        if self._known is None or value._run != self._known[0]:
            return ShownEvent(number, is_yes_no)
        run, at = _SHOW_PLACE.unpack(place)
        return ShownEvent(number, is_yes_no, run, self._known[1], at)

    def has_ended(self, run: int | None) -> bool:
        """Return whether it is known how a run has ended: it was told then, and is told once."""
        return run is not None and self._ended == run

    def end(self) -> None:
        """Note that it is known how our run has ended, of which no event has told."""
        self._ended, self._is_asked = self.run, False

    def note_replaced(self) -> list[Event]:
        """Note that a program which waits to be started has ended our run; return what tells so."""
        is_going, run = self._is_going, self.run
        self.clear()
        if not is_going or run is None:
            return []
        self.end()
        return [DoneEvent(run)]

    def update_place(self, values: SentReply) -> list[PlaceEvent]:
        """Take a reply; return where the program is now, if that is another place than before."""
        if not isinstance(values, PingReply):
            return []
        before, self._place = self._place, None
        if values.state == STATE_RUNNING and len(values.place) == PLACE_BYTES:
            at, program = _PLACE.unpack(values.place)
            self._place = PlaceEvent(values.run, program, at)
        elif before is not None:
            return [before._replace(at=-1)]
        return [self._place] if self._place and self._place != before else []

    def take(self, event: Event) -> None:
        if isinstance(event, (StoppedEvent, FaultEvent, DoneEvent)):
            self._place = self.halted = None  # who is told of the end needs no more
        if isinstance(event, HaltedEvent):
            self.halted = event
        if isinstance(event, (StoppedEvent, FaultEvent)):
            self.state = STATE_STOPPED
            self._is_going = self._is_asked = False
        if isinstance(event, (DoneEvent, FaultEvent)):
            self._ended = event.run
            if isinstance(event, DoneEvent) and event.run == self.run:
                self.state = STATE_IDLE
                self._is_going = self._is_asked = False

    def begin(self, run: int) -> None:
        """Note that a run has begun, unless its end arrived before its receipt."""
        if run != self._ended:
            self.state = STATE_RUNNING
            self._is_going = True

    def clear(self) -> None:
        """Note that the latch is released or the robot is lost."""
        self.state = STATE_IDLE
        self._place = self.halted = None
        self._is_going = self._is_asked = False
