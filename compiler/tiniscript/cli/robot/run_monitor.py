"""Staying with a program until it ends; Ctrl-C stops the robot."""

from __future__ import annotations

import sys
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text
from tiniscript.library.endings import Follower, end_of
from tiniscript.library.errors import RobotError
from tiniscript.library.way import CONFIRM_S, confirmed
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_SAVING, SAVED_STORED

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from tiniscript.cli.robot.connect import Connection
    from tiniscript.cli.robot.event_printer import Teller
    from tiniscript.link.connection import Asked
    from tiniscript.link.outcomes import Event
    from tiniscript.link.requests import Reply

STOP_S = 1.5  # the same for a command that leaves, and that nobody may look at
SAVE_S = 10.0  # for which a robot may save a program
LOW_S = 2.0  # for which its voltage may be too low for that: it looks every half second
ASK_S = 1.0  # between two questions whether it has, while the program runs
DONE, FAULTY, INTERRUPTED, LOST = 0, 1, 2, 3  # exit codes

__all__ = ("CONFIRM_S", "STOP_S", "Attendant", "Saving", "confirmed", "ended", "stop_and_say")


class Attendant:
    """Tells what a run tells, until it ends. `hold` may keep an event back: it returns whether.

    `look` is called now and then.
    """

    def __init__(
        self,
        connection: Connection,
        teller: Teller,
        hold: Callable[[Event], bool] | None = None,
        look: Callable[[], None] | None = None,
    ) -> None:
        self.connection = connection
        self.teller = teller
        self.hold = hold
        self.look = look

    def attend(self, run: int) -> int:
        """Wait for the end of a run; return the exit code. Raises Trouble where the link ends."""
        follower = Follower(run)
        while True:
            found = self.connection.event()
            if self.look is not None:
                self.look()
            if self.connection.is_time_over:
                return self.stop_in_time()
            if found is None:
                continue
            time_ms, event = found
            try:
                if not follower.is_about(event, shown(self.connection.port)):
                    continue
            except RobotError as error:
                raise Trouble(3, error.reason, **error.values) from None
            if self.hold is None or not self.hold(event):
                self.teller.tell(time_ms, event)
            code = ended(event, run)
            if code is not None:
                return code

    def stop_in_time(self) -> int:
        """Stop a virtual robot whose time is over: it stands already, its firmware goes on."""
        if not confirmed(self.connection.line):
            raise Trouble(3, "not_confirmed", port=shown(self.connection.port))
        language = self.connection.language
        self.teller.say(0, "TIME_OVER", "", text("time_over", language))
        return DONE

    def attend_or_stop(self, run: int) -> int:
        """The same; Ctrl-C stops the robot first."""
        try:
            return self.attend(run)
        except KeyboardInterrupt:
            return stop_and_say(self.connection)


def ended(event: Event, run: int | None) -> int | None:
    """Return the exit code where an event ends a run, else None. A `run` of None is any."""
    end = end_of(event, run)
    if end is None:
        return None
    if end.name == "DONE":
        return DONE
    return FAULTY if end.is_the_programs else LOST


def stop_and_say(connection: Connection) -> int:
    """Stop the robot after Ctrl-C, and say whether it has confirmed; return the exit code."""
    is_confirmed = confirmed(connection.line)
    if connection.company is not None:
        connection.company.unwatch()  # now that the robot stands in the picture, too
    print(file=sys.stderr)  # the terminal has written ^C
    if is_confirmed:
        print(text("robot_stopped", connection.language), file=sys.stderr)
        return INTERRUPTED
    raise Trouble(3, "not_confirmed", port=shown(connection.port))


class Saving:
    """Follows how the robot saves the program that it was given, and says once that it has.

    Whoever opens the port next may reset the robot, and would end the saving.
    """

    def __init__(self, connection: Connection, teller: Teller, values: Mapping[str, int]) -> None:
        """`values` are those of the program's receipt."""
        self.connection = connection
        self.teller = teller
        self.run, self.program, self.saved = (values[key] for key in ("run", "program", "saved"))
        self.is_unseen = False
        self._asked: Asked | None = None
        self._asked_s = monotonic()

    @property
    def is_over(self) -> bool:
        return self.saved not in (SAVED_SAVING, SAVED_LOW_SUPPLY)

    def look(self) -> None:
        """Ask every second, and wait for nothing."""
        if self._asked is not None and self._asked.outcome is not None:
            self._learn(self._asked.outcome, is_running=True)
            self._asked = None
        elif self._asked is None and not self.is_over and monotonic() - self._asked_s > ASK_S:
            self._asked_s = monotonic()
            self._asked = self.connection.do(lambda session: session.status())

    def wait(self) -> None:
        """Wait until it is saved. Raises Trouble where it is not."""
        if self.is_over:
            return
        begun_s = monotonic()
        low_s: float | None = None
        while not self.is_over and monotonic() < begun_s + SAVE_S:
            self._learn(self.connection.ask(lambda session: session.status()), is_running=False)
            if self.saved == SAVED_LOW_SUPPLY:
                low_s = low_s or monotonic()
                if monotonic() > low_s + LOW_S:
                    break
            else:
                low_s = None
            if not self.is_over:
                self.connection.event()
        if self.saved != SAVED_STORED:
            keys = {SAVED_SAVING: "saves_later", SAVED_LOW_SUPPLY: "low_supply"}
            key = keys.get(self.saved, "not_saved")
            raise Trouble(3, "plain", said=text(key, self.connection.language))

    def wait_unseen(self) -> None:
        """The same where nobody reads what tsc prints: only what went wrong is still said."""
        self.is_unseen = True
        try:
            self.wait()
        except Trouble as trouble:
            with suppress(OSError):
                print(trouble.sentence(self.connection.language), file=sys.stderr, flush=True)

    def _learn(self, status: Reply, is_running: bool) -> None:
        values = {key: each for key, each in status.values.items() if isinstance(each, int)}
        if status.status or self.is_over:
            return
        if values["program"] != self.program:  # somebody has sent another one
            self.saved = SAVED_STORED
            return
        was_low, self.saved = self.saved == SAVED_LOW_SUPPLY, values["saved"]
        language = self.connection.language
        if self.is_unseen:
            return
        if self.saved == SAVED_STORED:
            slot = values["slot"]
            said = text("now_saved", language).format(slot=slot)
            self.teller.say(0, "SAVED", str(slot), said, slot=slot)
        elif self.saved == SAVED_LOW_SUPPLY and not was_low and is_running:
            self.teller.say(0, "LOW_SUPPLY", "", text("low_supply", language), is_bad=True)
