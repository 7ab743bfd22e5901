"""The session with one robot: a state machine without I/O and without a clock.

`receive` takes what has arrived, `poll` gives what to send, `wakes_at` says when to poll next,
`events` what there is to tell. One request is on its way at a time; it is sent again until it is
answered or its errand's time is over. Times are milliseconds. Knows how requests become
frames, retries, the heartbeat and the stop; not which request follows which: `requests` does.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping

from tiniscript.bytecode.image import Image
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link import requests
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    FIRST_EVENT,
    LARGEST,
    MAJOR,
    MINOR,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
    STOP_BYTES,
    Malformed,
    read,
    written,
)
from tiniscript.link.outcomes import CANCELLED, LOST, Event
from tiniscript.link.receiver import Receiver
from tiniscript.link.requests import OK, Errand, Reply, Request, Robot, reply_of

ROUND_MS = 120  # of two radios and a robot, without the bytes
RETRY_MS = 80  # more for each try,
RETRY_STEPS = 6  # up to so many
TRIES = 30
DEADLINE_MS = 20_000  # of an errand
BEAT_MS = 200  # between two frames while something runs
IDLE_BEAT_MS = 1000  # while nothing does
DEAF_MS = 3000  # a heartbeat without an answer for so long: the link is lost
STOP_MS = 100  # between two stop sequences
CONFIRM_MS = 6000  # for which they are sent: then others have their turn again
_STALE, _BUSY = STATUSES["STALE"], STATUSES["BUSY"]


class Task:
    """An errand and its time, from its first request on; `outcome` is there when it is over."""

    def __init__(
        self,
        errand: Errand,
        limit_ms: int = DEADLINE_MS,
        starts: bool = False,
        is_own: bool = False,
    ) -> None:
        self.errand = errand
        self.limit_ms = limit_ms
        self.deadline_ms = 0
        self.starts = starts  # a program runs when it is done
        self.is_own = is_own  # nobody has asked for it
        self.done_bytes = 0  # of a program, that have arrived
        self.is_busy = False  # the robot's last answer was that it is
        self.outcome: Reply | None = None


class Session:
    def __init__(
        self,
        nonce: int,
        baud: int = 9600,
        kit: int = 0,
        isa: tuple[int, int] = (ISA_MAJOR, ISA_MINOR),
    ) -> None:
        """`nonce` is a random number of 32 bits; `kit` and `isa` are those of our programs."""
        self.robot: Robot | None = None
        self.is_attached = True  # events are wanted, so there is a heartbeat while nothing runs
        self.tells_starts = False  # STARTED is wanted
        self.damaged = 0  # frames
        self._nonce, self._baud, self._kit, self._isa = nonce, baud, kit, isa
        self._receiver = Receiver()
        self._events: list[Event] = []
        self._tasks: deque[Task] = deque()
        self._task: Task | None = None
        self._is_open = False
        self._seq = nonce & 0xFF
        self._epoch = 0
        self._event_seq: int | None = None
        # the request on its way
        self._frame: Frame | None = None
        self._tries = 0
        self._due_ms: int | None = None  # when it is sent, or sent again
        self._sent_ms = 0  # when something was sent last
        # what the robot does
        self._state = STATE_IDLE
        self._run: int | None = None  # the run that we have started
        self._ended: int | None = None  # the last run whose end we know
        self._stop_ms: int | None = None  # when the stop sequence is sent next
        self._stop_until = 0

    # -- errands ----------------------------------------------------------------------------------

    def hello(self) -> Task:
        return self._add(Task(self._hello()))

    def ping(self) -> Task:
        return self._add(Task(requests.single("PING")))

    def status(self) -> Task:
        return self._add(Task(requests.single("STATUS")))

    def clear(self) -> Task:
        return self._add(Task(self._open_then(lambda: requests.single("CLEAR"))))

    def start(self, is_detached: bool = False) -> Task:
        errand = self._open_then(lambda: requests.start(is_detached, self.is_latched))
        return self._add(Task(errand, starts=True))

    def live(self, code: bytes, kit: int = 0) -> Task:
        """`kit` is the one whose words the code uses, or 0 for none."""
        errand = self._open_then(lambda: self._live(code, kit))
        return self._add(Task(errand, starts=True))

    def upload(
        self,
        image: Image,
        runs: bool = True,
        saves: bool = True,
        is_detached: bool = False,
    ) -> Task:
        mode = requests.mode_of(image, runs, saves, is_detached)
        errand = self._open_then(lambda: self._upload(image, mode))
        return self._add(Task(errand, starts=runs and image.start == "SI"))

    def name(self, name: bytes) -> Task:
        return self._add(Task(self._open_then(lambda: self._name(name))))

    def trim(self, trim: bytes = b"") -> Task:
        """Set the trim of the motors, or only ask for it."""
        request = Request("TRIM", {"trim": trim})
        return self._add(Task(self._open_then(lambda: requests.kept(request))))

    def fetch(self) -> Task:
        return self._add(Task(requests.fetch()))

    def stop(self, now_ms: int) -> None:
        """Stop the robot now, whatever else is going on; all errands are off.

        STOPPED is told when it has confirmed that, LOST where it has not in CONFIRM_MS.
        """
        self._cancel(CANCELLED)
        self._stop_ms = now_ms
        self._stop_until = now_ms + CONFIRM_MS

    @property
    def is_latched(self) -> bool:
        return self._state > STATE_RUNNING

    @property
    def is_running(self) -> bool:
        return self._state == STATE_RUNNING

    @property
    def is_open(self) -> bool:
        """Whether the robot has answered HELLO, and was not lost since."""
        return self._is_open

    @property
    def run(self) -> int | None:
        """The last run that this session has started."""
        return self._run

    # -- bytes in, bytes out ----------------------------------------------------------------------

    def receive(self, data: bytes, now_ms: int) -> None:
        """Take the bytes that have arrived."""
        for byte in data:
            self._receiver.put(byte, now_ms)
            item = self._receiver.take()
            if item is None:
                continue
            if item.is_text:
                self._tell("TEXT", text=item.data)
                continue
            frame = decoded(item.data)
            if frame is None:
                self.damaged += 1
            elif not frame.is_reply:
                self._tell("ECHO")
            elif frame.number >= FIRST_EVENT:
                self._take_event(frame)
            else:
                self._take_reply(frame, now_ms)

    def poll(self, now_ms: int) -> bytes:
        """Return what is to be sent now."""
        if self._stop_ms is not None:
            return self._send_stop(now_ms)
        if self._frame is None:
            self._next_task(now_ms)
        if self._frame is None or self._due_ms is None or now_ms < self._due_ms:
            return b""
        assert self._task
        if self._tries >= TRIES or now_ms >= self._task.deadline_ms:
            self._lose()
            return b""
        wire = encoded(self._frame)
        wait_ms = ROUND_MS + RETRY_MS * min(self._tries, RETRY_STEPS)
        wait_ms += -(-(len(wire) + LARGEST + 2) * 10_000 // self._baud)
        # a 0x00 before a second try, and before HELLO: whatever stands there is no item
        is_first = self._tries == 0 and self._frame.number != BY_NAME["HELLO"].number
        self._tries += 1
        self._due_ms = now_ms + wait_ms
        self._sent_ms = now_ms
        return wire if is_first else b"\0" + wire

    def wakes_at(self) -> int | None:
        """Return when `poll` has something to do if nothing arrives, or None."""
        if self._stop_ms is not None:
            return self._stop_ms
        if self._frame is not None:
            return self._due_ms
        if self._tasks:
            return 0
        beat_ms = self._beat_ms()
        return None if beat_ms is None else self._sent_ms + beat_ms

    def events(self) -> list[Event]:
        """Return what there is to tell since the last time."""
        found, self._events = self._events, []
        return found

    # -- what is sent -----------------------------------------------------------------------------

    def _add(self, task: Task) -> Task:
        self._tasks.append(task)
        return task

    def _hello(self) -> Errand:
        values = {
            "major": MAJOR,
            "minor": MINOR,
            "isa_major": self._isa[0],
            "isa_minor": self._isa[1],
            "kit": self._kit,
            "nonce": self._nonce,
        }
        reply = yield Request("HELLO", values)
        if reply.status == OK:
            self._is_open = True
            if self.robot is None or self.robot.values["nonce"] != reply.values["nonce"]:
                self._event_seq = self._run = self._ended = None  # it was reset: it counts anew
            self.robot = requests.described(reply.values)
            state = reply.values["state"]
            assert isinstance(state, int)
            self._state = state
        return reply

    def _open_then(self, make: Callable[[], Errand]) -> Errand:
        """An errand that needs a session, and is made when there is one."""
        if not self._is_open:
            reply = yield from self._hello()
            if reply.status != OK:
                return reply
        return (yield from make())

    def _live(self, code: bytes, kit: int) -> Errand:
        assert self.robot
        yield from self._speak_for(kit)
        return (yield from requests.live(code, self.is_latched, kit, self.robot))

    def _upload(self, image: Image, mode: int) -> Errand:
        assert self.robot
        yield from self._speak_for(image.kit)
        return (yield from requests.upload(image, mode, self.robot, self._isa, self.is_latched))

    def _name(self, name: bytes) -> Errand:
        reply = yield from requests.kept(Request("NAME", {"name": name}))
        if reply.status in (OK, *requests.TAKEN) and self.robot:
            self.robot = requests.described({**self.robot.values, "name": name})
        return reply

    def _speak_for(self, kit: int) -> Errand:
        """Say that our programs are for the robot's kit, if HELLO has said another one.

        Those who share a session may have chosen different robots.
        """
        assert self.robot
        if kit == self._kit or kit != self.robot.kit:
            return Reply(OK)
        self._kit = kit
        return (yield from self._hello())

    def _next_task(self, now_ms: int) -> None:
        if self._tasks:
            self._task = self._tasks.popleft()
        else:
            beat_ms = self._beat_ms()
            if beat_ms is None or now_ms < self._sent_ms + beat_ms:
                return
            self._task = Task(requests.single("PING"), DEAF_MS, is_own=True)
        self._task.deadline_ms = now_ms + self._task.limit_ms
        self._advance(None, now_ms)

    def _beat_ms(self) -> int | None:
        if not self._is_open:
            return None
        if self.is_running:
            return BEAT_MS
        return IDLE_BEAT_MS if self.is_attached else None

    def _advance(self, reply: Reply | None, now_ms: int) -> None:
        """Go on with the errand: give it the reply, and send its next request."""
        task = self._task
        assert task
        task.is_busy = reply is not None and reply.status == _BUSY
        try:
            request = next(task.errand) if reply is None else task.errand.send(reply)
        except StopIteration as over:
            self._frame = self._task = None
            self._finish(task, over.value)
            return
        message = BY_NAME[request.name]
        self._seq = (self._seq + 1) & 0xFF
        payload = written(message.request, request.values)
        self._frame = Frame(message.number, self._seq, self._epoch, payload)
        self._tries = 0
        self._due_ms = now_ms + request.pause_ms

    def _send_stop(self, now_ms: int) -> bytes:
        assert self._stop_ms is not None
        if now_ms < self._stop_ms:
            return b""
        if now_ms >= self._stop_until:
            self._stop_ms = None
            self._close()
            return b""
        self._stop_ms = self._sent_ms = now_ms
        self._stop_ms += STOP_MS
        return bytes(STOP_BYTES)

    # -- what arrives -----------------------------------------------------------------------------

    def _take_reply(self, frame: Frame, now_ms: int) -> None:
        ours = self._frame
        if ours is None or (frame.number, frame.seq) != (ours.number, ours.seq):
            return  # a second answer
        message = BY_NUMBER[frame.number]
        reply = reply_of(message.name, frame.payload)
        if reply is None:
            self.damaged += 1
            return
        is_hello = message.name == "HELLO"
        if frame.epoch != self._epoch:
            self._epoch = frame.epoch
            if not is_hello:  # there was a stop between: what was wanted before is not any more
                self._cancel_waiting(_STALE)
        if reply.status == _STALE:
            self._is_open = False  # HELLO tells what has become of the robot
        if message.name == "CLEAR" and reply.status == OK:
            self._state = STATE_IDLE
        self._learn(message.name, reply.values)
        done = reply.values.get("next")
        if self._task and isinstance(done, int):
            self._task.done_bytes = done
        self._advance(reply, now_ms)

    def _learn(self, name: str, values: Mapping[str, int | bytes]) -> None:
        """Remember what a reply says of the robot's state."""
        run = values.get("run")
        if "state" in values and "run" in values:
            state = values["state"]
            assert isinstance(state, int) and isinstance(run, int)
            was_running, self._state = self.is_running, state
            if was_running and not self.is_running and self._run is not None:
                self._ended = self._run
                if name == "PING":  # how it has ended, STATUS tells
                    self._tasks.appendleft(Task(self._end(), DEAF_MS, is_own=True))
        elif isinstance(run, int) and name in ("START", "LIVE", "PROGRAM", "COMMIT"):
            self._run = run

    def _end(self) -> Errand:
        reply = yield Request("STATUS")
        if reply.status == OK:
            self._events.append(Event("ENDED", reply.values))
        return reply

    def _take_event(self, frame: Frame) -> None:
        message = BY_NUMBER.get(frame.number)
        if message is None:
            return  # of a newer robot
        try:
            values = read(message.reply, frame.payload)
        except Malformed:
            self.damaged += 1
            return
        if self._event_seq is not None:
            missed = (frame.seq - self._event_seq - 1) & 0xFF
            if missed:
                self._tell("MISSED", count=missed)
        self._event_seq = frame.seq
        if message.name == "STOPPED":
            # what came before a stop was sent does not confirm it
            if self._stop_ms is not None and self._stop_ms > self._stop_until - CONFIRM_MS:
                self._stop_ms = None
            elif self._is_open and self.is_latched and frame.epoch == self._epoch:
                return  # a second answer to one stop
        if message.name in ("STOPPED", "FAULT"):
            self._epoch = frame.epoch
            self._state = STATE_STOPPED
            self._cancel_waiting(_STALE)
        if message.name in ("DONE", "FAULT"):
            run = values["run"]
            assert isinstance(run, int)
            self._ended = run
            if message.name == "DONE" and run == self._run:
                self._state = STATE_IDLE
        self._events.append(Event(message.name, values))

    def _finish(self, task: Task, outcome: Reply) -> None:
        task.outcome = outcome
        if not task.starts or outcome.status != OK:
            return
        if self.tells_starts:
            started = {name: outcome.values[name] for name in ("run", "program")}
            self._events.append(Event("STARTED", started))
        if outcome.values["run"] != self._ended:
            self._state = STATE_RUNNING

    # -- endings ----------------------------------------------------------------------------------

    def _lose(self) -> None:
        """Give up: the robot does not answer, or is busy."""
        task, self._task, self._frame = self._task, None, None
        assert task
        # one that answers, and is busy for too long, is not lost
        is_busy = task.is_busy and self._tries <= 1
        task.outcome = Reply(_BUSY if is_busy else LOST)
        if task.is_own:
            self._close()

    def _close(self) -> None:
        self._cancel(LOST)
        self._is_open = False
        self._state = STATE_IDLE
        self._tell("LOST")

    def _cancel(self, status: int) -> None:
        if self._task:
            self._task.outcome = Reply(status)
        self._task = self._frame = None
        self._cancel_waiting(status)

    def _cancel_waiting(self, status: int) -> None:
        for task in self._tasks:
            task.outcome = Reply(status)
        self._tasks.clear()

    def _tell(self, name: str, **values: int | bytes) -> None:
        self._events.append(Event(name, values))
