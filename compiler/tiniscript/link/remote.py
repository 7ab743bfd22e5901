"""The keys of a remote control: the newest state of each speaker, and when to send it.

No word is sent twice, because a repeated one would press a released key again: a waiting word is
replaced by the newest, and held keys are sent again. A client that falls silent no longer holds any
keys. Times are milliseconds. Knows no frame and no clock.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import HOLD_MS, MAX_PAD, REMOTE, REMOTE_KEYS
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import EmptyReply
from tiniscript.link.requests import OK, DeviceInfo, Reply

REPEAT_MS = 200  # interval at which held keys are repeated
GAP_MS = 30  # between two words while one is unanswered: a frame and its answer at 9600 baud
RESEND_MS = 100  # time after which an unanswered message is sent again
MAX_UNANSWERED = 3  # words that may be unanswered: on a slow line no more of them queue up
_LONG_AGO_MS = -1_000_000


class RemoteState(NamedTuple):
    """A bit for each of REMOTE_KEYS that is held, and the pad, in percent to the right and up."""

    keys: int = 0
    x: int = 0
    y: int = 0

    @property
    def is_sound(self) -> bool:
        is_pad_sound = all(-MAX_PAD <= percent <= MAX_PAD for percent in (self.x, self.y))
        return 0 <= self.keys < 1 << len(REMOTE_KEYS) and is_pad_sound


NOTHING_PRESSED = RemoteState()


def remote_state_of(names: Iterable[str], x: int = 0, y: int = 0) -> RemoteState:
    """Return the state of these held keys. Raises ValueError for unknown or too many keys."""
    keys = 0
    for name in names:
        keys |= 1 << REMOTE_KEYS.index(name)
    state = RemoteState(keys, x, y)
    if not state.is_sound:
        raise ValueError(state)
    return state


class RemoteControl:
    """Each speaker has a number."""

    def __init__(self) -> None:
        self._state_by_speaker: dict[int, RemoteState] = {}  # the newest word last
        self._until_ms_by_speaker: dict[
            int, int | None
        ] = {}  # None: from the next look at the clock on
        self._sent_state, self._sent_ms = NOTHING_PRESSED, _LONG_AGO_MS
        self._unanswered_count = 0
        self._waiting_request_by_speaker: dict[
            int, PendingRequest[EmptyReply]
        ] = {}  # unsent requests of each speaker
        self._sent_requests: list[PendingRequest[EmptyReply]] = []

    def press(self, speaker: int, state: RemoteState) -> PendingRequest[EmptyReply]:
        """Hold exactly these keys, for at most HOLD_MS.

        An earlier state that has not been sent at all is replaced: CANCELLED.
        """
        assert state.is_sound, state
        self._state_by_speaker.pop(speaker, None)
        if state != NOTHING_PRESSED:
            self._state_by_speaker[speaker], self._until_ms_by_speaker[speaker] = state, None
        earlier_request = self._waiting_request_by_speaker.pop(speaker, None)
        if earlier_request is not None:
            earlier_request.outcome = Reply(CANCELLED)
        request: PendingRequest[EmptyReply] = PendingRequest()
        if self.combined_state == self._sent_state == NOTHING_PRESSED:
            request.outcome = Reply(OK, 0, EmptyReply())
        else:
            self._waiting_request_by_speaker[speaker] = request
        return request

    def let_go(self, status: int = CANCELLED) -> None:
        """The robot has released all keys, or hears nothing: no key is held until the next
        press."""
        self._state_by_speaker.clear()
        self._sent_state, self._unanswered_count = NOTHING_PRESSED, 0
        self._note_sent()
        self._finish_sent(Reply(status))

    @property
    def combined_state(self) -> RemoteState:
        """All keys held by any speaker, and the pad that was moved last."""
        combined_state = NOTHING_PRESSED
        for state in self._state_by_speaker.values():
            pad = (state.x, state.y) if state.x or state.y else (combined_state.x, combined_state.y)
            combined_state = RemoteState(combined_state.keys | state.keys, *pad)
        return combined_state

    def due_ms(self) -> int | None:
        """Return the time of the next check, or None."""
        times = [
            until_ms
            for speaker in self._state_by_speaker
            if (until_ms := self._until_ms_by_speaker[speaker]) is not None
        ]
        combined_state = self.combined_state
        if combined_state != self._sent_state:
            gap_ms = (
                REPEAT_MS
                if self._unanswered_count == MAX_UNANSWERED
                else GAP_MS
                if self._unanswered_count
                else 0
            )
            times.append(self._sent_ms + gap_ms)
        elif 0 < self._unanswered_count < MAX_UNANSWERED:
            times.append(self._sent_ms + RESEND_MS)
        elif combined_state != NOTHING_PRESSED or self._unanswered_count == MAX_UNANSWERED:
            times.append(self._sent_ms + REPEAT_MS)
        return min(times, default=None)

    def expire_and_check_due(self, now_ms: int) -> bool:
        """Return whether to send now. A speaker silent for HOLD_MS holds no keys."""
        for speaker in list(self._state_by_speaker):
            until_ms = self._until_ms_by_speaker[speaker]
            if until_ms is None:
                self._until_ms_by_speaker[speaker] = now_ms + HOLD_MS
            elif now_ms >= until_ms:
                del self._state_by_speaker[speaker]
        due_ms = self.due_ms()
        return due_ms is not None and now_ms >= due_ms

    def take_message(self, now_ms: int) -> dict[str, int | bytes]:
        """Return the newest word, which is sent now."""
        self._sent_state, self._sent_ms = self.combined_state, now_ms
        self._unanswered_count += 1
        self._note_sent()
        return self.newest_message()

    def newest_message(self) -> dict[str, int | bytes]:
        """Return the newest word as the message has it."""
        return dict(self.combined_state._asdict())

    def take_answer(self, outcome: Reply[Any]) -> None:
        """Take the robot's answer. A robot that accepts no keys gets no more of them."""
        self._unanswered_count = 0
        if outcome.status == OK:
            self._finish_sent(Reply(OK, 0, EmptyReply()))
            return
        self._state_by_speaker.clear()
        self._sent_state = NOTHING_PRESSED
        self._note_sent()
        self._finish_sent(Reply(outcome.status, outcome.detail))

    def note_answered(self) -> None:
        """An earlier word was answered."""
        self._unanswered_count = max(0, self._unanswered_count - 1)

    def note_unanswered(self) -> None:
        """Call this when no answer came in time."""
        self._finish_sent(Reply(LOST))

    def _note_sent(self) -> None:
        self._sent_requests += self._waiting_request_by_speaker.values()
        self._waiting_request_by_speaker.clear()

    def _finish_sent(self, reply: Reply[EmptyReply]) -> None:
        for pending_request in self._sent_requests:
            pending_request.outcome = reply
        self._sent_requests.clear()


def has_remote(robot: DeviceInfo) -> bool:
    """Return whether a robot's programs can read KEY_UP and the rest of a remote control."""
    return bool(robot.values.features & REMOTE)
