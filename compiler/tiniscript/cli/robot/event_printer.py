"""What a robot tells while it runs: SHOW values, faults with their lines, how it ended.

As sentences, as lines of JSON, and as rows of a CSV file.
"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, TextIO

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from tiniscript.codegen.source_map import Map
    from tiniscript.link.outcomes import Event
    from tiniscript.vm.trace import Event as Traced


def fault_name(number: int) -> str:
    """Return the name of a fault: of the machine's, or of the link's."""
    from tiniscript.bytecode.opcodes import FAULTS
    from tiniscript.link.messages import LINK_FAULTS

    names = {each: name for each, name, _ in (*FAULTS, *LINK_FAULTS)}
    return names.get(number, str(number))


def fault_sentence(number: int, at: int, program: int, places: Map | None, language: str) -> str:
    """Return what a fault is, and the line of the program where it was, if its text is known."""
    from tiniscript.cli.commands.run import fault_text
    from tiniscript.cli.texts.common import has_text
    from tiniscript.codegen import source_map

    is_other = places is None
    places = source_map.recall(program) if places is None else places
    name = fault_name(number)
    if not has_text(f"fault_{name}"):
        return text("fault_unknown", language).format(number=number)
    return fault_text(name, at, places, is_other, language)


def value_text(value: int, is_yes_no: bool) -> str:
    from tiniscript.fixed_point import as_text

    if is_yes_no:
        return "TRUE" if value else "FALSE"
    return as_text(value)


def cause_name(number: int) -> str:
    """Return the name of a cause; of one that a newer robot knows, NONE."""
    from tiniscript.link.messages import CAUSES

    return CAUSES[number][0] if number < len(CAUSES) else CAUSES[0][0]


def _out(line: str) -> None:
    print(line, flush=True)


def _err(line: str) -> None:
    sys.stdout.flush()
    print(line, file=sys.stderr, flush=True)


class Teller:
    """Prints events. `has_times`: each with the milliseconds since the first.

    `out` and `err` print, where something else than this is on the terminal. JSON gets what
    `about` says, too.
    """

    def __init__(
        self,
        language: str,
        is_json: bool = False,
        has_times: bool = False,
        places: Map | None = None,
        rows: TextIO | None = None,
        out: Callable[[str], None] | None = None,
        err: Callable[[str], None] | None = None,
        about: Mapping[str, object] | None = None,
    ) -> None:
        self.language = language
        self.is_json = is_json
        self.has_times = has_times
        self.places = places
        self.rows = rows
        self.out = out or _out
        self.err = err or _err
        self.about = about or {}
        self.began_ms: int | None = None

    def tell(self, time_ms: int, event: Event) -> None:
        if self.began_ms is None:
            self.began_ms = time_ms
        since_ms = time_ms - self.began_ms
        name, values = event
        numbers = {key: value for key, value in values.items() if isinstance(value, int)}
        if name == "SHOW":
            value = value_text(numbers["value"], bool(numbers["is_yes_no"]))
            self.say(since_ms, "SHOW", value, value=json_value(numbers))
        elif name == "DONE":
            self.say(since_ms, "DONE", "", text("robot_done", self.language))
        elif name in ("FAULT", "ENDED"):
            self._tell_end(since_ms, name, numbers)
        elif name == "STOPPED":
            cause = cause_name(numbers["cause"])
            said = text(f"stopped_{cause}", self.language)
            self.say(since_ms, "STOPPED", cause, said, cause=cause)
        elif name == "MISSED":
            said = text("missed", self.language).format(n=numbers["count"])
            self.say(since_ms, "MISSED", str(numbers["count"]), said, count=numbers["count"])
        elif name == "TEXT":
            line = values["text"]
            assert isinstance(line, bytes)
            words = shown(line.decode("utf-8", "replace"))
            said = text("robot_text", self.language).format(said=words)
            self.say(since_ms, "TEXT", words, said, text=words)

    def _tell_end(self, since_ms: int, name: str, numbers: dict[str, int]) -> None:
        """A fault, or the end of a run of which only the robot's state is known."""
        from tiniscript.link.messages import STATE_FAULTED, STATE_IDLE

        if name == "ENDED" and numbers["state"] != STATE_FAULTED:
            ended = "DONE" if numbers["state"] == STATE_IDLE else "STOPPED"
            key = "robot_done" if ended == "DONE" else "stopped_NONE"
            self.say(since_ms, ended, "", text(key, self.language))
            return
        from tiniscript.codegen import source_map

        fault = fault_name(numbers["fault"])
        at = numbers["at" if name == "FAULT" else "fault_at"]
        program = numbers["program" if name == "FAULT" else "fault_program"]
        said = fault_sentence(numbers["fault"], at, program, self.places, self.language)
        places = self.places or source_map.recall(program)
        place = places.at(at) if places is not None else None
        more = {} if place is None else {"line": place.line}
        self.say(since_ms, "FAULT", fault, said, is_bad=True, fault=fault, at=at,
                 program=f"{program:08x}", **more)  # fmt: skip

    def say(
        self, since_ms: int, name: str, what: str, said: str = "", /, is_bad: bool = False,
        **fields: object,
    ) -> None:  # fmt: skip
        """Print an event: `said`, or its name and what there is to it. JSON gets the fields."""
        if self.rows is not None:
            self._add_row(since_ms, name, what)
        if self.is_json:
            times = {"ms": since_ms} if self.has_times else {}
            self.out(json.dumps({**times, "event": name, **self.about, **fields}))
        elif is_bad or name in ("MISSED", "TEXT"):
            self.err(said)
        else:
            time = f"{since_ms} " if self.has_times else ""
            self.out(time + (said or f"{name} {what}"))

    def _add_row(self, since_ms: int, name: str, what: str) -> None:
        assert self.rows is not None
        quoted = '"' + what.replace('"', '""') + '"' if any(c in what for c in ',"\n') else what
        try:
            self.rows.write(f"{since_ms},{name},{quoted}\n")
            self.rows.flush()
        except (OSError, ValueError) as why:
            reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
            file = shown(str(self.rows.name))
            raise Trouble(2, "unwritable_rows", file=file, why=reason) from None


class Bookkeeping:
    """Knows which values of a run are for `tsc live` alone, that keeps its variables so."""

    def __init__(self) -> None:
        self.is_on = False

    def hides(self, event: Event) -> bool:
        from tiniscript.cli.robot.live_mark import MARK

        if event.name in ("STARTED", "DONE", "FAULT", "STOPPED", "ENDED"):
            self.is_on = False
        elif event.name != "SHOW":
            return False
        elif event.values["value"] == MARK and not event.values["is_yes_no"]:
            self.is_on = True
        return self.is_on

    def hides_trace(self, event: Traced) -> bool:
        """The same for what a virtual robot says that it does."""
        from tiniscript.cli.robot.live_mark import MARK

        if event.what in ("START", "DONE", "FAULT", "STOP", "OFF"):
            self.is_on = False
        elif event.what == "SHOW" and event.values == (MARK,):
            self.is_on = True
        return self.is_on and event.what == "SHOW"


def json_value(numbers: dict[str, int]) -> object:
    """Return a value as JSON has it: a number with its decimals, or true and false."""
    if numbers["is_yes_no"]:
        return bool(numbers["value"])
    value = numbers["value"]
    return value // 1000 if value % 1000 == 0 else value / 1000
