"""Follows a program until it ends; Ctrl-C stops the robot."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import ClassVar

from tiniscript.cli import streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.texts import say_aside, text
from tiniscript.library import client
from tiniscript.library.endings import Follower, end_of
from tiniscript.library.errors import RobotError
from tiniscript.link.connection import PendingRequest, Requester
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_STORED
from tiniscript.link.outcomes import POLL_INTERVAL_S, Event
from tiniscript.link.payloads import ReceiptReply, StatusReply
from tiniscript.link.requests import Reply

STATUS_INTERVAL_S = 1.0  # between two status requests about saving, while the program runs
DONE, FAULTY, INTERRUPTED, LOST = 0, 1, 2, 3  # exit codes


class RunMonitor:
    """Prints the events of a run until it ends. `hold` returns True for an event to keep back.

    `on_wait` is called repeatedly meanwhile, every `wait_s` at least.
    """

    def __init__(
        self,
        connection: Connection,
        printer: EventPrinter,
        hold: Callable[[Event], bool] | None = None,
        on_wait: Callable[[], None] | None = None,
        wait_s: float = POLL_INTERVAL_S,
    ) -> None:
        self.connection = connection
        self.printer = printer
        self.hold = hold
        self.on_wait = on_wait
        self.wait_s = wait_s

    def follow(self, run: int) -> int:
        """Wait for the end of a run; return the exit code.

        Raises CommandError if the link ends.
        """
        follower = Follower(run)
        while True:
            timed_event = self.connection.event(self.wait_s)
            if self.on_wait is not None:
                self.on_wait()
            if self.connection.is_time_over:
                return self.stop_in_time()
            if timed_event is None:
                continue
            time_ms, event = timed_event
            try:
                if not follower.follow(event, printable_name(self.connection.port)):
                    continue
            except RobotError as error:
                raise CommandError(3, error.reason, **error.values) from None
            if self.hold is None or not self.hold(event):
                self.printer.print_event(time_ms, event)
                if event.name not in ("STARTED", "READING"):
                    self.connection.wait_notice.note_other_output()
            exit_code = exit_code_of(event, run)
            if exit_code is not None:
                return exit_code

    def stop_in_time(self) -> int:
        """Stop a virtual robot at its time limit: it no longer moves, but its firmware still
        runs."""
        if not self.connection.stop():
            raise CommandError(3, "not_confirmed", port=printable_name(self.connection.port))
        language = self.connection.language
        self.printer.print_values(0, "TIME_OVER", "", text("time_over", language))
        return DONE


def exit_code_of(event: Event, run: int | None) -> int | None:
    """Return the exit code if an event ends a run, else None. A `run` of None matches any run."""
    end = end_of(event, run)
    if end is None:
        return None
    if end.name == "DONE":
        return DONE
    return FAULTY if end.was_caused_by_program else LOST


def stop_and_say(connection: Connection) -> int:
    """Stop the robot after Ctrl-C, and say whether it has confirmed; return the exit code."""
    is_confirmed = connection.stop()
    streams.drop_unread_output()
    if connection.simulator is not None:
        connection.simulator.stop_drawing()  # the robot has stopped in the picture, too
    print(file=sys.stderr)  # the terminal has written ^C
    if is_confirmed:
        say_aside("robot_stopped", connection.language)
        return INTERRUPTED
    raise CommandError(3, "not_confirmed", port=printable_name(connection.port))


class Saving:
    """Waits until the robot has saved the uploaded program, and prints that once."""

    # Message keys that replace the usual ones, by reason.
    KEY_BY_REASON: ClassVar[dict[str, str]] = {}

    def __init__(
        self, connection: Connection, printer: EventPrinter, receipt: ReceiptReply
    ) -> None:
        self.connection = connection
        self.printer = printer
        self.run, self.program = receipt.run, receipt.program
        self.is_unread = False
        self._progress = client.Saving(receipt)
        self._status_request: PendingRequest[StatusReply] | None = None
        self._requested_s = monotonic()

    def poll(self) -> None:
        """Request the status every second, without waiting."""
        if self._status_request is not None and self._status_request.outcome is not None:
            self._update(self._status_request.outcome, is_running=True)
            self._status_request = None
        elif (
            self._status_request is None
            and not self._progress.is_over
            and monotonic() - self._requested_s > STATUS_INTERVAL_S
        ):
            self._requested_s = monotonic()
            self._status_request = self.connection.begin_request(Requester.status)

    def wait(self) -> None:
        """Wait until it is saved. Raises CommandError if it is not."""
        if self._progress.is_over:
            return
        for _ in self._progress.polls():
            self._update(self.connection.request(Requester.status), is_running=False)
            if not self._progress.is_over:
                self.connection.event()
        reason = self._progress.reason
        if reason:
            sentence = text(self.KEY_BY_REASON.get(reason, reason), self.connection.language)
            raise CommandError(3, "plain", said=sentence)

    def wait_unread(self) -> None:
        """Wait for the end when tsc's output has no reader: only failures are printed."""
        self.is_unread = True
        try:
            self.wait()
        except CommandError as error:
            with suppress(OSError):
                print(error.sentence(self.connection.language), file=sys.stderr, flush=True)

    def _update(self, reply: Reply[StatusReply], is_running: bool) -> None:
        if reply.status or self._progress.is_over:
            return
        was_low = self._progress.saved == SAVED_LOW_SUPPLY
        self._progress.update(reply.values)
        language = self.connection.language
        if self.is_unread or reply.values.program != self.program:
            return
        if self._progress.saved == SAVED_STORED:
            slot = reply.values.slot
            is_verbose = getattr(self.connection.options, "verbose", False)
            key = "now_saved_slot" if is_verbose else "now_saved"
            sentence = text(key, language).format(slot=slot)
            self.printer.print_values(0, "SAVED", str(slot), sentence, slot=slot)
        elif self._progress.saved == SAVED_LOW_SUPPLY and not was_low and is_running:
            self.printer.print_values(
                0, "LOW_SUPPLY", "", text("low_supply", language), is_bad=True
            )
