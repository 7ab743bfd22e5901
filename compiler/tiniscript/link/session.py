"""The session with one robot: a state machine without I/O and without a clock.

`receive` takes the bytes that have arrived, `poll` returns the bytes to send, `next_wake_ms` the
time of the next poll, `events` the new events. One request is in flight at a time; it is repeated
until it is answered or its exchange times out. Times are milliseconds. It knows which exchange is
next, and when one ends. `transmission` times retries and stops, `requests` and `handshake` know the
order of requests, and `robot_state` the state of the robot.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from itertools import takewhile
from typing import Any, NamedTuple, TypeVar

from tiniscript.bytecode.image import MIN_ISA
from tiniscript.link.authority import NOT_OWNER, KeyRing
from tiniscript.link.connection import EXCHANGE_TIMEOUT_MS, PendingRequest, Requester
from tiniscript.link.frames import Frame, decode_frame
from tiniscript.link.handshake import (
    REQUESTS_WITHOUT_HELLO,
    Handshake,
    exchange_by_name,
    ping,
    status,
)
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    DEAD_MAN_MS,
    FIRST_ACTING,
    FIRST_EVENT,
    MESSAGES,
    PLACES,
    STATE_FAULTED,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
    Malformed,
    decode_payload,
    encode_payload,
)
from tiniscript.link.outcomes import (
    CANCELLED,
    DETAIL_MIDWAY,
    EVENTS,
    LOST,
    UNPROVEN,
    EchoEvent,
    Event,
    LostEvent,
    MissedEvent,
    RestartedEvent,
    StartedEvent,
    TextEvent,
)
from tiniscript.link.payloads import (
    DoneEvent,
    EmptyReply,
    FaultEvent,
    HaltedEvent,
    HelloReply,
    NextReply,
    PingReply,
    ReadingEvent,
    ReceiptReply,
    SentReply,
    ShowEvent,
    StatusReply,
    StoppedEvent,
)
from tiniscript.link.receiver import Receiver
from tiniscript.link.remote import RemoteControl, RemoteState, has_remote
from tiniscript.link.requests import (
    ACCEPTING_STATUSES,
    OK,
    DeviceInfo,
    Exchange,
    Reply,
    Request,
    as_refusal,
    reply_of,
    send_single,
)
from tiniscript.link.robot_state import RobotState, UnresolvedShow
from tiniscript.link.round_trips import RoundTrips
from tiniscript.link.sealing import SEALED_ONLY_MESSAGES, UNSEALED_MESSAGES, Sealing
from tiniscript.link.sender import Sender
from tiniscript.link.transmission import TRIES, StopSender, Transmission, Window

HEARTBEAT_MS = 200  # between two frames while a program runs
IDLE_HEARTBEAT_MS = 1000  # between two frames otherwise
SILENT_MS = DEAD_MAN_MS + 200  # time after a lost link in which only stops are sent
DEAF_MS = 3000  # a heartbeat without an answer for this time means that the link is lost
PLACE_QUESTION = b"\1"  # question of a PING for the program's place
MAX_REAUTHENTICATIONS = 5  # for one request
_STALE_STATUS = STATUSES["STALE"]
_WAITING_STATUSES = (
    STATUSES["BUSY"],
    STATUSES["HOLD_BUTTON"],
)  # asked again: the robot is not ready
_BY_SEQUENCE, _BY_MESSAGE = 1, 2  # causes of a stopped robot: the stop sequence, STOP
_PREPARING_MESSAGES = ("STOP", "CLEAR", "AUTHENTICATE", "BEGIN", "DATA", "ABORT", "KEYS",
              "READ_VARIABLES", "READ_TASKS", "TELL_READINGS")  # fmt: skip
_ACTING_MESSAGES = [message.name for message in MESSAGES
          if FIRST_ACTING <= message.number < FIRST_EVENT
          and message.name not in _PREPARING_MESSAGES]  # fmt: skip
_HEARTBEAT_MESSAGES = ("PING", "KEYS")
_STARTING_MESSAGES = ("PROGRAM", "COMMIT", "LIVE", "START")  # a run may begin with each
_RUN_ENDING_REQUESTS = (
    "upload",
    "live",
    "start",
    "undo",
)  # a robot ends its run when it gets one of these
T = TypeVar("T")


class PendingExchange(PendingRequest[T]):
    """An exchange and its timeout, from its first request on."""

    def __init__(
        self,
        exchange: Exchange[T],
        limit_ms: int = EXCHANGE_TIMEOUT_MS,
        starts_program: bool = False,
        is_own: bool = False,
        ends_runs: bool = False,
        ends_orphan: bool = False,
        presses_keys: bool = False,
    ) -> None:
        self.limit_ms, self.starts_program, self.ends_runs = limit_ms, starts_program, ends_runs
        self.exchange = exchange
        self.deadline_ms = 0
        self.epoch: int | None = None  # epoch of the request
        self.is_own = is_own  # made by the session itself
        self.ends_orphan = ends_orphan  # the run of a client that has left
        self.presses_keys = presses_keys  # keys of a remote control
        self.is_void = False  # requested before a stop, so it is not continued
        self.answered_ms = 0  # time of the robot's last answer
        self.waiting_status = 0  # the robot's last one, if of _WAITING_STATUSES, or 0
        self.may_be_done = False  # the robot has not reported whether it is
        self.is_midway = False  # a frame of the exchange is under way or has arrived
        self.reauthentication_count = 0
        self.interrupted_exchange: InterruptedExchange | None = None

    @property
    def target(self) -> PendingExchange[Any]:
        """The exchange itself, or the one that has to wait for another one."""
        return (
            self
            if self.interrupted_exchange is None
            else self.interrupted_exchange.pending_exchange
        )


class InterruptedExchange(NamedTuple):
    """An exchange whose request continues after the session has authenticated again, a run is
    ended, or keys are pressed."""

    pending_exchange: PendingExchange[Any]
    transmission: Transmission


class Session(Requester):
    def __init__(
        self,
        nonce: int,
        baud: int = 9600,
        kit: int = 0,
        isa: tuple[int, int] = MIN_ISA,
        keys: KeyRing | None = None,
        place: str = "",
    ) -> None:
        """`nonce` is a random number of 32 bits; `kit` and `isa` are those of our programs; `keys`
        has the keys of robots; `place` is where the robot is reached, by a name that stays.
        """
        self.tells_places = False  # PLACE events are wanted
        self.tells_starts = False  # STARTED events are wanted
        self.is_attached = True  # events are wanted, so the heartbeat continues without a program
        # Whether a client attends to the robot.
        self.sends_heartbeat: Callable[[], bool] = lambda: True
        self.damaged = 0  # count of damaged frames
        self._receiver = Receiver()
        self._sender = Sender()
        self._seq = nonce & 0xFF
        self._epoch = 0
        self._baud = baud
        self._stop = StopSender()
        self._is_lost = False  # the link is; no frame was sent since
        # The time of the last transmission, or of the last answer while no program runs.
        self._talked_ms = 0
        self._unanswered_since_ms: int | None = None  # time of the first unanswered heartbeat
        self._remote = RemoteControl()
        self._has_pressed = False  # last, so that waiting requests get their turn
        self._sealing = Sealing()
        self._state = RobotState()
        self._handshake = Handshake(nonce, kit, isa, self._state, keys, lambda: self._epoch, place)
        self._events: list[Event | UnresolvedShow] = []
        self._queue: deque[PendingExchange[Any]] = deque()
        self._pending_exchange: PendingExchange[Any] | None = None
        self._round_trips = RoundTrips(baud)
        self._transmission = Transmission(self._round_trips)
        self._orphan_run: int | None = None  # the run of a client that has left
        # Request for the program of values that wait.
        self._program_query: PendingExchange[PingReply] | None = None
        self._told_stop_epoch: int | None = None  # epoch begun by the last reported stop
        self._reading_count = 0  # number of READING events

    @property
    def robot(self) -> DeviceInfo | None:
        """The robot's description of itself, once it has answered HELLO."""
        return self._handshake.robot

    @property
    def is_latched(self) -> bool:
        return self._state.is_latched

    @property
    def is_running(self) -> bool:
        return self._state.is_running

    @property
    def is_open(self) -> bool:
        """Return whether the robot has answered HELLO, and has not been lost since."""
        return self._handshake.is_open

    @property
    def run(self) -> int | None:
        """The last run that this session has started."""
        return self._state.run

    def stop(self, now_ms: int) -> None:
        """Stop the robot now, and cancel all exchanges.

        The event STOPPED follows when the robot confirms, LOST if it does not within CONFIRM_MS.
        """
        self._cancel_requests(CANCELLED)
        self._stop.begin(now_ms)

    def end_run(self, run: int, now_ms: int) -> None:
        """End a run whose client has left. Requests of other clients continue."""
        self._orphan_run = run
        self._end_orphan(now_ms)

    def withdraw(self, request: PendingRequest[Any]) -> None:
        """Abandon a request whose client has left.

        A frame that may have started a run is under way until it is answered.
        """
        if request in self._queue:
            self._queue = deque(
                pending_exchange
                for pending_exchange in self._queue
                if pending_exchange is not request
            )
        elif self._pending_exchange is None or self._pending_exchange.target is not request:
            return
        elif self._may_start():
            self._pending_exchange.target.is_void = True
            return
        else:
            self._pending_exchange = None
            self._transmission.end()
        request.outcome = Reply(CANCELLED)

    # -- bytes in, bytes out ----------------------------------------------------------------------

    def receive(self, data: bytes, now_ms: int) -> None:
        """Take the bytes that have arrived."""
        for byte in data:
            self._receiver.put(byte, now_ms)
            packet = self._receiver.take()
            if packet is None:
                continue
            if packet.is_text:
                self._events.append(TextEvent(packet.data))
                continue
            frame = decode_frame(packet.data)
            if frame is not None:
                frame = self._sealing.open_frame(frame, self._transmission, now_ms)
            if frame is None:
                self.damaged += 1
            elif not frame.is_reply:
                self._events.append(EchoEvent())
            elif frame.number >= FIRST_EVENT:
                self._take_event(frame)
            else:
                self._take_reply(frame, now_ms)

    def poll(self, now_ms: int) -> bytes:
        """Return the bytes to send now."""
        if self._stop.due_ms is not None:
            return self._send_stop(now_ms)
        if self._is_lost and now_ms < self._talked_ms + SILENT_MS:
            return b""
        self._is_lost = False
        self._press_next(now_ms)
        if not self._transmission.is_under_way:
            self._next_pending(now_ms)
        if not self._transmission.is_under_way:
            return b""
        assert self._pending_exchange
        if now_ms >= self._pending_exchange.deadline_ms:
            self._give_up_request(now_ms)
            return b""
        if not self._transmission.is_due(now_ms):
            return b""
        if self._transmission.is_of("KEYS"):
            keys = BY_NAME["KEYS"].request
            self._transmission.set_payload(encode_payload(keys, self._remote.take_message(now_ms)))
        seal = self._transmission.seal
        if seal is not None and seal.is_spent:
            self._authenticate_again(now_ms)
            return b""
        if self._transmission.tries >= TRIES:
            self._give_up_request(now_ms)
            return b""
        self._talked_ms = now_ms
        if self._unanswered_since_ms is None and any(
            map(self._transmission.is_of, _HEARTBEAT_MESSAGES)
        ):
            self._unanswered_since_ms = now_ms
        if any(map(self._transmission.is_of, _ACTING_MESSAGES)):
            self._pending_exchange.is_midway = True
        if seal is not None:
            self._sealing.sealed_ms = now_ms
        return self._transmission.bytes_to_send(now_ms, self._sender)

    def next_wake_ms(self) -> int | None:
        """Return when to call `poll` next if nothing arrives, or None."""
        if self._stop.due_ms is not None:
            return self._stop.due_ms
        if self._is_lost and (self._queue or self._remote.due_ms() is not None):
            return self._talked_ms + SILENT_MS
        times = [self._remote.due_ms() if self._may_press() else None]
        if self._transmission.is_under_way:
            assert self._pending_exchange
            times += [self._transmission.due_ms, self._pending_exchange.deadline_ms]
        elif self._queue:
            return 0
        elif (heartbeat_ms := self._heartbeat_ms()) is not None:
            times.append(self._talked_ms + heartbeat_ms)
        return min((time for time in times if time is not None), default=None)

    def events(self) -> list[Event]:
        """Return the events since the last call. Values wait until the robot has named the running
        program, if it is asked; no other events wait after them.
        """
        count = len(self._events)
        if self._program_query is not None and self._program_query.outcome is None:
            count -= sum(
                1
                for _ in takewhile(
                    lambda event: isinstance(event, UnresolvedShow), reversed(self._events)
                )
            )
        events, self._events = self._events[:count], self._events[count:]
        return [
            self._state.to_shown_event(event) if isinstance(event, UnresolvedShow) else event
            for event in events
        ]

    # -- sending ----------------------------------------------------------------------------------

    def _may_press(self) -> bool:
        """Return whether keys may be sent before the next frame, or instead of a heartbeat. They
        never overtake a frame under way, which would be out of order when repeated.
        """
        pending_exchange = self._pending_exchange
        if pending_exchange is None or self._is_heartbeat():
            return not (self._queue and self._has_pressed)
        if pending_exchange.interrupted_exchange is not None or pending_exchange.presses_keys:
            return False
        return not self._transmission.is_sent and not self._transmission.is_of("AUTHENTICATE")

    def _is_heartbeat(self) -> bool:
        """Return whether a heartbeat, or keys without a following request, are under way."""
        pending_exchange = self._pending_exchange
        is_alone = (
            pending_exchange is not None
            and pending_exchange.is_own
            and pending_exchange.interrupted_exchange is None
        )
        return is_alone and any(map(self._transmission.is_of, _HEARTBEAT_MESSAGES))

    def _press_next(self, now_ms: int) -> None:
        """Send the held keys, if due; an unanswered message is not repeated."""
        if self._transmission.is_of("KEYS") and self._transmission.is_late(now_ms):
            self._round_trips.back_off()
            self._remote.note_unanswered()
            self._end_press()
        if not self._may_press() or not self._remote.expire_and_check_due(now_ms):
            return
        exchange = self._handshake.open_then(self._send_keys)
        press = PendingExchange(exchange, DEAF_MS, is_own=True, presses_keys=True)
        if self._pending_exchange is not None and not self._is_heartbeat():
            press.interrupted_exchange = InterruptedExchange(
                self._pending_exchange, self._transmission
            )
        self._pending_exchange, self._has_pressed = press, True
        press.deadline_ms = self._loss_due_ms(now_ms)
        self._advance(None, now_ms)

    def _send_keys(self) -> Exchange[PingReply]:
        """Send the held keys: `poll` determines them."""
        assert self.robot
        if not has_remote(self.robot):
            return Reply(STATUSES["NO_REMOTE"])
        return (yield from send_single(Request("KEYS", self._remote.newest_message()), PingReply))

    def _end_press(self) -> None:
        """Resume the exchange that a key press has interrupted."""
        assert self._pending_exchange
        interrupted_exchange, self._pending_exchange = (
            self._pending_exchange.interrupted_exchange,
            None,
        )
        self._transmission.end()
        if interrupted_exchange is not None:
            self._go_on(interrupted_exchange)

    def _loss_due_ms(self, now_ms: int) -> int:
        """Return the time at which the link is lost without an answer to a heartbeat."""
        if now_ms - self._talked_ms > 2 * HEARTBEAT_MS:
            self._unanswered_since_ms = None  # no frame was sent for a while
        return (
            now_ms if self._unanswered_since_ms is None else self._unanswered_since_ms
        ) + DEAF_MS

    def _next_pending(self, now_ms: int) -> None:
        if self._queue:
            self._pending_exchange, self._has_pressed = self._queue.popleft(), False
        else:
            heartbeat_ms = self._heartbeat_ms()
            if heartbeat_ms is None or now_ms < self._talked_ms + heartbeat_ms:
                return
            limit_ms = self._loss_due_ms(now_ms) - now_ms
            self._pending_exchange = PendingExchange(self._heartbeat(), limit_ms, is_own=True)
        self._pending_exchange.deadline_ms = now_ms + self._pending_exchange.limit_ms
        self._advance(None, now_ms)

    def _heartbeat_ms(self) -> int | None:
        if not self._handshake.is_open or not self.sends_heartbeat():
            return None
        if self.is_running:
            return HEARTBEAT_MS
        return IDLE_HEARTBEAT_MS if self.is_attached else None

    def _advance(self, reply: Reply[SentReply] | None, now_ms: int) -> None:
        """Continue the exchange: give it the reply, and send its next request."""
        pending_exchange = self._pending_exchange
        assert pending_exchange
        is_waiting = reply is not None and reply.status in _WAITING_STATUSES
        pending_exchange.waiting_status = reply.status if reply is not None and is_waiting else 0
        pending_exchange.answered_ms = now_ms
        try:
            request = (
                next(pending_exchange.exchange)
                if reply is None
                else pending_exchange.exchange.send(reply)
            )
        except StopIteration as finished_stop_iteration:
            self._end_exchange(pending_exchange, finished_stop_iteration.value, now_ms)
            return
        message = BY_NAME[request.name]
        is_action = message.number >= FIRST_ACTING and request.name not in UNSEALED_MESSAGES
        if pending_exchange.is_void and is_action:
            pending_exchange.exchange.close()
            self._end_exchange(pending_exchange, Reply(_STALE_STATUS), now_ms)
            return
        self._begin_request(request, now_ms)
        self._end_orphan(now_ms)

    def _end_exchange(
        self, pending_exchange: PendingExchange[Any], outcome: Reply[Any], now_ms: int
    ) -> None:
        self._pending_exchange = None
        self._transmission.end()
        if pending_exchange.presses_keys:
            self._remote.take_answer(outcome)
        if pending_exchange.interrupted_exchange is None:
            self._finish_request(pending_exchange, outcome)
            self._end_orphan(now_ms)
        elif pending_exchange.ends_orphan or pending_exchange.presses_keys:
            self._go_on(pending_exchange.interrupted_exchange)
        else:
            self._resume(pending_exchange.interrupted_exchange, outcome, now_ms)

    def _begin_request(self, request: Request, now_ms: int) -> None:
        """Send a request, and repeat it until it is answered."""
        message = BY_NAME[request.name]
        seal = self._sealing.seal_for(request)
        next_number = partial(self._next_number, seal is not None)
        if request.pieces is not None:
            self._transmission = Window(
                self._baud, self._round_trips, request.pieces, self._epoch, next_number
            )
            self._transmission.begin_again(now_ms, seal)
            return
        payload = encode_payload(message.request, request.values)
        frame = Frame(message.number, next_number(), self._epoch, payload)
        largest_frame = self.robot.values.largest if self.robot else 0
        self._transmission = Transmission(self._round_trips, largest_frame, self.is_running)
        self._transmission.begin(frame, now_ms + request.pause_ms, seal)
        if seal is None and request.name in SEALED_ONLY_MESSAGES:
            self._authenticate_again(now_ms)  # authenticates before any of its bytes is sent

    def _next_number(self, is_sealed: bool) -> int:
        """Return the number of the next frame."""
        self._seq = (self._seq + 1) & 0xFF
        if is_sealed:
            self._seq = self._sealing.next_number(self._seq)
        return self._seq

    def _authenticate_again(self, now_ms: int) -> None:
        """The robot no longer knows our seal: authenticate, then continue with the same request.

        It has the same number, so the robot does not repeat it.
        """
        pending_exchange, transmission = self._pending_exchange, self._transmission
        assert pending_exchange
        self._sealing.seal = None
        if transmission.is_of("KEYS"):
            self._end_press()  # the press is not repeated: a key comes before the next word
            return
        pending_exchange.reauthentication_count += 1
        self._transmission = Transmission(self._round_trips)
        if (
            pending_exchange.reauthentication_count > MAX_REAUTHENTICATIONS
        ):  # its exchange is notified, and may repeat it
            pending_exchange.exchange.close()
            pending_exchange.outcome = Reply(NOT_OWNER)
            self._pending_exchange = None
            return
        self._pending_exchange = PendingExchange(
            self._handshake.authenticate(), is_own=pending_exchange.is_own
        )
        self._pending_exchange.interrupted_exchange = InterruptedExchange(
            pending_exchange, transmission
        )
        self._pending_exchange.deadline_ms = pending_exchange.deadline_ms
        self._advance(None, now_ms)

    def _resume(
        self, interrupted_exchange: InterruptedExchange, key_reply: Reply[Any], now_ms: int
    ) -> None:
        self._pending_exchange, transmission = interrupted_exchange
        seal = self._sealing.seal
        if self._pending_exchange.is_void:
            self._advance(Reply(_STALE_STATUS), now_ms)
        elif key_reply.status == NOT_OWNER or (key_reply.status == OK and seal is None):
            self._transmission = transmission
            self._authenticate_again(now_ms)
        elif key_reply.status == OK and transmission.epoch == self._epoch:
            self._transmission = transmission
            self._transmission.begin_again(now_ms, seal)
        else:
            self._advance(Reply(key_reply.status or _STALE_STATUS, key_reply.detail), now_ms)

    def _end_orphan(self, now_ms: int) -> None:
        """End the run of a client that has left, between two frames of other clients' requests."""
        if self._orphan_run is None:
            return
        if not self.is_running or self.run != self._orphan_run:
            self._orphan_run = None  # the run has ended
            return
        pending_exchange, transmission = self._pending_exchange, self._transmission
        if pending_exchange is not None and (
            pending_exchange.interrupted_exchange is not None
            or pending_exchange.ends_runs  # such a request ends runs itself
            or transmission.is_sent
            or transmission.is_of("AUTHENTICATE")  # its tag is only valid in this epoch
        ):
            return
        self._orphan_run = None
        stop = send_single(Request("STOP"), EmptyReply)
        stop_exchange = PendingExchange(stop, DEAF_MS, is_own=True, ends_orphan=True)
        if pending_exchange is None:
            self._queue.appendleft(stop_exchange)
            return
        stop_exchange.interrupted_exchange = InterruptedExchange(pending_exchange, transmission)
        stop_exchange.deadline_ms = now_ms + stop_exchange.limit_ms
        self._pending_exchange = stop_exchange
        self._advance(None, now_ms)

    def _go_on(self, interrupted_exchange: InterruptedExchange) -> None:
        """Resume an exchange whose request has not been sent yet, not even in part."""
        self._pending_exchange, self._transmission = interrupted_exchange
        seal = None if self._transmission.is_of("HELLO") else self._sealing.seal
        self._transmission.renew(self._epoch, self._next_number(seal is not None))
        self._transmission.begin_again(self._transmission.due_ms, seal)

    def _may_start(self) -> bool:
        """Return whether a frame that may start a run is under way."""
        return self._transmission.is_sent and any(map(self._transmission.is_of, _STARTING_MESSAGES))

    def _send_stop(self, now_ms: int) -> bytes:
        if not self._stop.is_due(now_ms):
            return b""
        if self._stop.is_over(now_ms):
            self._stop.end()
            self._end_connection()
            self._is_lost = False  # zeros alone keep no run alive
            return b""
        self._talked_ms = now_ms
        return self._stop.bytes_to_send(now_ms, self._sender)

    # -- receiving --------------------------------------------------------------------------------

    def _lose_seal(self, frame: Frame, now_ms: int) -> None:
        """The robot does not know our seal. Such an answer may be forged: it causes no
        repetition."""
        if self._pending_exchange and not self._pending_exchange.presses_keys:
            self._pending_exchange.target.may_be_done = True
        if frame.epoch == self._epoch:
            self._authenticate_again(now_ms)
            return
        self._doubt_epoch(frame)
        self._sealing.seal = None
        self._handshake.is_open = False
        self._advance(Reply(_STALE_STATUS if frame.number >= FIRST_ACTING else NOT_OWNER), now_ms)

    def _take_reply(self, frame: Frame, now_ms: int) -> None:
        if not self._transmission.is_answered_by(frame):
            if frame.is_sealed or self._sealing.seal is None:
                self._note_late(frame)
            return  # a second answer
        if self._transmission.seal is not None and not frame.is_sealed:
            self._lose_seal(frame, now_ms)
            return
        message = BY_NUMBER[frame.number]
        reply = reply_of(message.name, frame.payload)
        if reply is None:
            self.damaged += 1
            return
        if self._pending_exchange and reply.status not in (OK, *ACCEPTING_STATUSES):
            self._pending_exchange.is_midway = False  # the robot refused it
        self._transmission.learn_round_trip(frame, now_ms)
        self._unanswered_since_ms = None
        if not self.is_running:
            self._talked_ms = now_ms  # a request after an answer finds the line free
        if (
            reply.status == OK
            and not frame.is_sealed
            and not self._handshake.may_have_done(message.name)
        ):
            reply = Reply(UNPROVEN)
        self._note_progress(reply, now_ms)
        if isinstance(self._transmission, Window) and self._take_data_reply(reply, frame, now_ms):
            return
        values = reply.values if reply.status == OK else None
        if isinstance(values, HelloReply):
            self._settle_epoch(values, frame)
        else:
            self._doubt_epoch(frame)
        if reply.status == _STALE_STATUS:
            self._handshake.is_open = False  # a new HELLO reports the robot's state
        if message.name in UNSEALED_MESSAGES and reply.status != OK:
            self._sealing.seal = None
        if values is not None:
            is_other_epoch = self._handshake.is_in_doubt and not self._try_to_settle_epoch(values)
            if message.name == "CLEAR" and self._state.is_latched:  # a run goes on
                self._state.forget_run()
            if (
                message.name == "STOP"
                and self._pending_exchange
                and self._pending_exchange.ends_orphan
            ):
                self._tell_stop(StoppedEvent(_BY_MESSAGE))
            has_ended = self._state.take_reply(values, frame.epoch)
            if self.tells_places:
                self._events += self._state.update_place(values)
            is_end_known = has_ended and not is_other_epoch and not self._reading_count
            if is_end_known and isinstance(values, StatusReply):
                self._tell_end(values)
            elif has_ended or (is_other_epoch and self._handshake.is_open):
                self._queue_requery(has_ended, is_other_epoch)
        self._advance(reply, now_ms)
        if self._state.has_reset_ended_run:
            self._state.has_reset_ended_run = False
            self._events.append(RestartedEvent())

    def _note_late(self, frame: Frame) -> None:
        """An answer to an earlier word of a remote control: the robot is there."""
        if frame.number == BY_NAME["KEYS"].number:
            self._unanswered_since_ms = None
            self._remote.note_answered()

    # An epoch ends with a stop, a fault or a reset, or when another session begins. Only a stop
    # cancels earlier requests.

    def _doubt_epoch(self, frame: Frame) -> None:
        """The robot may have another epoch, which no event has announced."""
        if frame.epoch != self._epoch and self._handshake.doubted_epoch is None:
            self._handshake.doubted_epoch = self._epoch
        self._epoch = frame.epoch

    def _is_next_epoch(self, epoch: int) -> bool:
        """Return whether exactly one stop or fault has ended the previous epoch."""
        doubted_epoch = self._handshake.doubted_epoch
        return doubted_epoch is not None and epoch == (doubted_epoch + 1) & 0xFF

    def _is_one_fault(self, state: int, epoch: int) -> bool:
        return state == STATE_FAULTED and self._is_next_epoch(epoch)

    def _try_to_settle_epoch(self, values: SentReply) -> bool:
        """Return whether a reply contains everything needed about the previous epoch for now."""
        if isinstance(values, (PingReply, StatusReply)):
            has_gap = self._handshake.is_open and not self._is_next_epoch(self._epoch)
            if has_gap or self._state.may_be_reset(values):
                return False
            is_stop = not self._is_one_fault(values.state, self._epoch)
        elif self._transmission.is_of("STOP"):
            is_stop = not (self._pending_exchange and self._pending_exchange.ends_orphan)
        else:
            return True  # a client that needs more sends HELLO
        self._handshake.doubted_epoch = None
        if is_stop:
            self._void_requests()
        return True

    def _settle_epoch(self, robot: HelloReply, frame: Frame) -> None:
        """Find out from HELLO what ended the doubtful epoch."""
        is_same = self.robot is not None and self.robot.values.nonce == robot.nonce
        if is_same and self._handshake.is_open:
            self._doubt_epoch(frame)  # a client has sent HELLO, which notices it first
        self._epoch = frame.epoch
        if not is_same:
            self._told_stop_epoch = None  # epochs begin again
        if is_same and self._pending_exchange and self._pending_exchange.target.may_be_done:
            self._pending_exchange.target.is_void = True
        if self._handshake.is_in_doubt:
            is_fault = self._is_one_fault(robot.state, frame.epoch)
            # HELLO is not sealed, so its contents may be forged where that matters.
            if robot.state == STATE_STOPPED or (
                is_same and (not is_fault or self._handshake.is_unproven)
            ):
                self._void_requests(frame.epoch if is_same else None)
        self._handshake.doubted_epoch = None

    def _void_requests(self, began_epoch: int | None = None) -> None:
        """The robot was stopped: discard all earlier requests. Questions are answered.

        `began_epoch` is the new epoch, if requests in it are known to be later.
        """
        self._remote.let_go()
        for pending_exchange in (
            *self._queue,
            *([self._pending_exchange] if self._pending_exchange else []),
        ):
            if began_epoch is None or pending_exchange.target.epoch != began_epoch:
                pending_exchange.target.is_void = True

    def _tell_stop(self, event: StoppedEvent) -> None:
        """Tell that STOP has stopped the robot, if its event has not."""
        if not self.is_latched:
            self._state.take_event(event)
            self._events.append(event)

    def _note_progress(self, reply: Reply[SentReply], now_ms: int) -> None:
        """Extend an exchange's time when it makes progress, so that only a stalled one is given up.
        An answer to DATA without anything new is no progress.
        """
        pending_exchange = self._pending_exchange
        if pending_exchange is None or pending_exchange.target.is_limit_total or reply.status != OK:
            return
        if isinstance(reply.values, NextReply):
            is_data = isinstance(self._transmission, Window)
            if is_data and reply.values.next <= pending_exchange.done_bytes:
                return
            pending_exchange.done_bytes = reply.values.next
        pending_exchange.deadline_ms = now_ms + pending_exchange.limit_ms

    def _take_data_reply(self, reply: Reply[SentReply], frame: Frame, now_ms: int) -> bool:
        """Take a reply to one of many DATA; return whether that was not the last one."""
        assert isinstance(self._transmission, Window)
        if frame.epoch != self._transmission.epoch or reply.status not in (OK, _STALE_STATUS):
            return False
        next_offset = None  # STALE in this epoch: a frame with a later number arrived earlier
        if reply.status == OK:
            assert isinstance(reply.values, NextReply) and self._pending_exchange
            next_offset = reply.values.next
        return not self._transmission.take_reply(frame, next_offset, now_ms)

    def _queue_requery(self, has_ended: bool, is_other_epoch: bool) -> None:
        if is_other_epoch:
            self._handshake.is_open = False  # if this frame is lost, the next request detects it
        exchange = self._query_again(has_ended, is_other_epoch, self._state.run)
        self._queue.appendleft(PendingExchange(exchange, DEAF_MS, is_own=True))

    def _query_again(
        self, has_ended: bool, is_other_epoch: bool, run: int | None
    ) -> Exchange[StatusReply]:
        """Ask for the robot's identity, because a new epoch has begun, and for the end of a run."""
        if is_other_epoch:
            hello = yield from self._handshake.hello()
            if hello.status != OK:
                return as_refusal(hello)
        reading_count = self._reading_count
        reply = yield from self._handshake.with_key(status)
        is_at_rest = reply.status == OK and reply.values.state != STATE_RUNNING
        if has_ended and is_at_rest and self._reading_count != reading_count:
            # Readings of a run come before its end, but after each reply, because other requests
            # come first.
            repeated_query = self._query_again(has_ended, False, run)
            self._queue.append(PendingExchange(repeated_query, DEAF_MS, is_own=True))
            return reply
        is_told = self._state.has_ended(run)  # an event may have arrived meanwhile
        if reply.status == OK and has_ended and self._state.run == run and not is_told:
            self._tell_end(reply.values)
        return reply

    def _tell_end(self, status: StatusReply) -> None:
        """Report the end of our run: by another one, or by the robot's state."""
        self._state.end()
        if status.state == STATE_RUNNING:
            self._events.append(StartedEvent(status.run, status.program))
            return
        run = self._state.run
        assert run is not None
        if status.state == STATE_FAULTED:
            fault = FaultEvent(run, status.fault, status.fault_at, status.fault_program)
            self._events.append(fault)
        else:
            is_done = status.state == STATE_IDLE
            self._events.append(DoneEvent(run) if is_done else StoppedEvent(0))

    def _take_event(self, frame: Frame) -> None:
        message = BY_NUMBER.get(frame.number)
        if message is None:
            return  # a message of a newer robot
        try:
            values: dict[str, Any] = decode_payload(message.reply, frame.payload)
        except Malformed:
            self.damaged += 1
            return
        missed_count = self._state.count_missed(frame.seq)
        if missed_count:
            self._events.append(MissedEvent(missed_count))
        if message.name == ShowEvent._field_defaults["name"]:
            self._take_show(UnresolvedShow(ShowEvent(**values), frame.epoch))
            return
        event = EVENTS[message.name](**values)
        self._reading_count += isinstance(event, ReadingEvent)
        if isinstance(event, StoppedEvent):
            if not frame.is_sealed and self._handshake.is_unproven:
                self._ask_for_proof(event)
                return
            if self._stop.due_ms is not None:
                if not self._confirms_stop(event, frame):
                    self._take_end(event, frame)
                    self._state.take_event(event)
                    return
                self._stop.end()
            elif frame.epoch == self._told_stop_epoch or (
                self._handshake.is_open and self.is_latched and frame.epoch == self._epoch
            ):
                return  # a repeated answer to the same stop
            self._told_stop_epoch = frame.epoch
        if isinstance(event, HaltedEvent) and event == self._state.halt_event:
            return  # the robot is still lost
        if isinstance(event, (StoppedEvent, FaultEvent)):
            self._take_end(event, frame)
        # Whether a reply to STATUS has already reported it.
        is_told = isinstance(event, (DoneEvent, FaultEvent)) and self._state.has_ended(event.run)
        self._state.take_event(event)
        if not is_told:
            self._events.append(event)

    def _take_show(self, show: UnresolvedShow) -> None:
        """Report a value. If no client here started its run, the robot is asked for the program,
        unless that would have to wait.
        """
        event = self._state.to_shown_event(show)
        self._events.append(show if event.offset < 0 else event)
        is_free = not self._queue and (
            self._pending_exchange is None or self._pending_exchange.is_own
        )
        if not (is_free and self._handshake.is_open and self._has_places):
            return
        if self._state.claim_query(show):
            exchange = self._handshake.with_key(lambda: ping(PLACE_QUESTION))
            self._program_query = PendingExchange(exchange, DEAF_MS, is_own=True)
            self._queue.append(self._program_query)

    @property
    def _has_places(self) -> bool:
        return self.robot is not None and bool(self.robot.values.features & PLACES)

    def _confirms_stop(self, event: StoppedEvent, frame: Frame) -> bool:
        """Return whether the stop under way has stopped the robot, or found it stopped.

        Another stop's STOPPED may have been under way, and the robot may have started again since:
        then the next one decides, because the stop is sent again.
        """
        is_known = self.is_latched and frame.epoch == self._epoch
        return self._stop.is_sent and (event.cause == _BY_SEQUENCE or is_known)

    def _take_end(self, event: StoppedEvent | FaultEvent, frame: Frame) -> None:
        """Take the event that announces another epoch."""
        self._doubt_epoch(frame)
        is_orphan_end = (
            event == StoppedEvent(_BY_MESSAGE)
            and self._pending_exchange
            and self._pending_exchange.ends_orphan
        )
        if isinstance(event, StoppedEvent):
            is_other_epoch = self._handshake.is_in_doubt and not self._is_next_epoch(frame.epoch)
            self._handshake.doubted_epoch = None
            if not is_orphan_end:
                self._void_requests()
            if is_other_epoch and self._handshake.is_open:  # a reset may have preceded this stop
                self._queue_requery(has_ended=False, is_other_epoch=True)
        elif self._is_one_fault(STATE_FAULTED, frame.epoch):
            self._handshake.doubted_epoch = None
            self._transmission.renew(self._epoch)
            if self._pending_exchange and self._pending_exchange.interrupted_exchange:
                self._pending_exchange.interrupted_exchange.transmission.renew(self._epoch)

    def _ask_for_proof(self, event: StoppedEvent) -> None:
        """Ask the robot for a sealed confirmation of a stop that we sent."""
        if self._stop.is_sent:
            self._stop.end()
            self._queue.append(PendingExchange(self._prove_stop(event), DEAF_MS, is_own=True))

    def _prove_stop(self, event: StoppedEvent) -> Exchange[StatusReply]:
        reply = yield from self._handshake.prove_stopped(lambda: self._sealing.seal is not None)
        if reply.status == OK:
            self._state.take_event(event)
            self._events.append(event)
        else:
            self._lose_robot()
        return reply

    # -- exchanges --------------------------------------------------------------------------------

    def press(
        self, keys: int = 0, x: int = 0, y: int = 0, speaker: int = 0
    ) -> PendingRequest[EmptyReply]:
        return self._remote.press(speaker, RemoteState(keys, x, y))

    def _ask(
        self, name: str, reply_type: type[T], starts_program: bool = False, /, **arguments: object
    ) -> PendingExchange[T]:
        make_exchange: Callable[[], Exchange[T]] = partial(
            exchange_by_name(name), self._handshake, **arguments
        )
        if name == "hello":
            exchange = make_exchange()
        elif name in REQUESTS_WITHOUT_HELLO:
            exchange = self._handshake.with_key(make_exchange)
        else:
            exchange = self._handshake.open_then(make_exchange)
        return self._queue_exchange(exchange, starts_program, name in _RUN_ENDING_REQUESTS)

    def _queue_exchange(
        self, exchange: Exchange[T], starts_program: bool = False, ends_runs: bool = False
    ) -> PendingExchange[T]:
        pending_exchange = PendingExchange(
            exchange, starts_program=starts_program, ends_runs=ends_runs
        )
        pending_exchange.epoch = self._epoch
        self._queue.append(pending_exchange)
        return pending_exchange

    def _heartbeat(self) -> Exchange[PingReply]:
        """Ping, and ask for the program's place, if that is wanted and the robot reports it."""
        question = PLACE_QUESTION if self.tells_places and self._has_places else b""
        return self._handshake.with_key(lambda: ping(question))

    def _finish_request(self, pending_exchange: PendingExchange[Any], outcome: Reply[Any]) -> None:
        pending_exchange.outcome = outcome
        if outcome.status == OK and pending_exchange.ends_runs:
            self._orphan_run = None
            if not pending_exchange.starts_program:
                self._events += self._state.note_replaced()
        if not pending_exchange.starts_program or outcome.status != OK:
            return
        receipt: ReceiptReply = outcome.values
        if self.tells_starts:
            self._events.append(StartedEvent(receipt.run, receipt.program))
        self._state.note_begun(receipt.run)

    def _give_up_request(self, now_ms: int) -> None:
        """Give up the request: the robot does not answer, or is not ready."""
        assert self._pending_exchange
        pending_exchange, self._pending_exchange = self._pending_exchange.target, None
        # a robot that answers, but waits for too long, is not lost
        is_there = (
            pending_exchange.waiting_status and now_ms - pending_exchange.answered_ms <= DEAF_MS
        )
        if pending_exchange.waiting_status and not self._transmission.is_sent:
            with suppress(StopIteration):  # no exchange is under way, so it just ends
                pending_exchange.exchange.send(Reply(CANCELLED))
        self._transmission.end()
        self._unanswered_since_ms = None
        pending_exchange.outcome = Reply(pending_exchange.waiting_status if is_there else LOST)
        if pending_exchange.is_own:
            self._end_connection()

    def _end_connection(self) -> None:
        self._cancel_requests(LOST)
        self._lose_robot()

    def _lose_robot(self) -> None:
        """A robot that hears us and is not heard drives while it hears anything: first its dead
        man's time goes by, from the last frame on.
        """
        self._is_lost = True
        self._remote.let_go(LOST)
        self._handshake.is_open = False
        self._state.forget_run()
        self._events.append(LostEvent())

    def _cancel_requests(self, status: int) -> None:
        if self._pending_exchange:
            target = self._pending_exchange.target
            is_midway = status == CANCELLED and target.is_midway
            target.outcome = Reply(status, DETAIL_MIDWAY if is_midway else 0)
        self._pending_exchange = self._orphan_run = self._handshake.doubted_epoch = None
        self._transmission.end()
        self._unanswered_since_ms = None
        self._remote.let_go(status)
        self._cancel_waiting(status)

    def _cancel_waiting(self, status: int) -> None:
        for pending_exchange in self._queue:
            pending_exchange.outcome = Reply(status)
        self._queue.clear()
