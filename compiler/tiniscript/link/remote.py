"""What the keys of a remote control say: the newest word of each who speaks, and when it is sent.

No word is sent twice, as a repeated one would press a key again that was let go: what waits is
replaced by the newest, and what is held is said anew. Who falls silent holds nothing any more.
Times are milliseconds. Knows no frame and no clock.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import HOLD_MS, MOST_PAD, REMOTE, REMOTE_KEYS
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import EmptyReply
from tiniscript.link.requests import OK, DeviceInfo, Reply

REPEAT_MS = 200  # what is held is said so often
GAP_MS = 30  # between two words while one is unanswered: a frame and its answer at 9600 baud
RESEND_MS = 100  # after which a word is said anew that was not answered
MOST_UNANSWERED = 3  # words that may be unanswered: on a slow line no more of them queue up
_LONG_AGO_MS = -1_000_000


class Pressed(NamedTuple):
    """A bit for each of REMOTE_KEYS that is held, and the pad, in percent to the right and up."""

    keys: int = 0
    x: int = 0
    y: int = 0

    @property
    def is_sound(self) -> bool:
        is_pad = all(-MOST_PAD <= way <= MOST_PAD for way in (self.x, self.y))
        return 0 <= self.keys < 1 << len(REMOTE_KEYS) and is_pad


NOTHING_PRESSED = Pressed()


def pressed_of(names: Iterable[str], x: int = 0, y: int = 0) -> Pressed:
    """Return what is held, by the names of the keys. Raises ValueError for others, or too much."""
    keys = 0
    for name in names:
        keys |= 1 << REMOTE_KEYS.index(name)
    result = Pressed(keys, x, y)
    if not result.is_sound:
        raise ValueError(result)
    return result


class RemoteControl:
    """Each who speaks has a number."""

    def __init__(self) -> None:
        self._held: dict[int, Pressed] = {}  # the newest word last
        self._until_ms: dict[int, int | None] = {}  # None: from the next look at the clock on
        self._said, self._said_ms = NOTHING_PRESSED, _LONG_AGO_MS
        self._unanswered = 0
        self._asked: dict[int, PendingRequest[EmptyReply]] = {}  # of each, not sent yet
        self._sent: list[PendingRequest[EmptyReply]] = []

    def press(self, speaker: int, held: Pressed) -> PendingRequest[EmptyReply]:
        """Hold what somebody holds now, and nothing else; it is over after HOLD_MS.

        What he has said before, and nothing of which was sent, is replaced: CANCELLED.
        """
        assert held.is_sound, held
        self._held.pop(speaker, None)
        if held != NOTHING_PRESSED:
            self._held[speaker], self._until_ms[speaker] = held, None
        before = self._asked.pop(speaker, None)
        if before is not None:
            before.outcome = Reply(CANCELLED)
        request: PendingRequest[EmptyReply] = PendingRequest()
        if self.newest == self._said == NOTHING_PRESSED:
            request.outcome = Reply(OK, 0, EmptyReply())
        else:
            self._asked[speaker] = request
        return request

    def let_go(self, status: int = CANCELLED) -> None:
        """The robot has let all go, or hears nothing: nothing is held before somebody says so."""
        self._held.clear()
        self._said, self._unanswered = NOTHING_PRESSED, 0
        self._take_asked()
        self._take_reply(Reply(status))

    @property
    def newest(self) -> Pressed:
        """All keys that somebody holds, and the pad of who has moved his last."""
        result = NOTHING_PRESSED
        for item in self._held.values():
            pad = (item.x, item.y) if item.x or item.y else (result.x, result.y)
            result = Pressed(result.keys | item.keys, *pad)
        return result

    def due_ms(self) -> int | None:
        """Return when to look again, or None."""
        times = [until for item in self._held if (until := self._until_ms[item]) is not None]
        newest = self.newest
        if newest != self._said:
            gap_ms = (
                REPEAT_MS
                if self._unanswered == MOST_UNANSWERED
                else GAP_MS
                if self._unanswered
                else 0
            )
            times.append(self._said_ms + gap_ms)
        elif 0 < self._unanswered < MOST_UNANSWERED:
            times.append(self._said_ms + RESEND_MS)
        elif newest != NOTHING_PRESSED or self._unanswered == MOST_UNANSWERED:
            times.append(self._said_ms + REPEAT_MS)
        return min(times, default=None)

    def expire_and_check_due(self, now_ms: int) -> bool:
        """Whether to say something now. Who has said nothing for HOLD_MS holds nothing."""
        for speaker in list(self._held):
            until_ms = self._until_ms[speaker]
            if until_ms is None:
                self._until_ms[speaker] = now_ms + HOLD_MS
            elif now_ms >= until_ms:
                del self._held[speaker]
        due_ms = self.due_ms()
        return due_ms is not None and now_ms >= due_ms

    def say(self, now_ms: int) -> dict[str, int | bytes]:
        """Return the newest word, which is sent now."""
        self._said, self._said_ms = self.newest, now_ms
        self._unanswered += 1
        self._take_asked()
        return self.word()

    def word(self) -> dict[str, int | bytes]:
        """Return the newest word as the message has it."""
        return dict(self.newest._asdict())

    def answer(self, outcome: Reply[Any]) -> None:
        """Take the robot's answer. One that takes no keys is not told of them again."""
        self._unanswered = 0
        if outcome.status == OK:
            self._take_reply(Reply(OK, 0, EmptyReply()))
            return
        self._held.clear()
        self._said = NOTHING_PRESSED
        self._take_asked()
        self._take_reply(Reply(outcome.status, outcome.detail))

    def hear(self) -> None:
        """An earlier word was answered."""
        self._unanswered = max(0, self._unanswered - 1)

    def miss(self) -> None:
        """No answer has come in time."""
        self._take_reply(Reply(LOST))

    def _take_asked(self) -> None:
        self._sent += self._asked.values()
        self._asked.clear()

    def _take_reply(self, reply: Reply[EmptyReply]) -> None:
        for pending_request in self._sent:
            pending_request.outcome = reply
        self._sent.clear()


def has_remote(robot: DeviceInfo) -> bool:
    """Whether a robot's programs read KEY_UP and what else a remote control says."""
    return bool(robot.values.features & REMOTE)
