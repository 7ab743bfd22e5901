"""Examines a robot that answers: its versions, kit, supply and restarts, and how well it hears.

It queries everything, but starts, stops, sets and writes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import NamedTuple

from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.doctor.findings import Finding, probable_finding, sure_finding
from tiniscript.doctor.robot import Robot, hello_values
from tiniscript.link.messages import (
    FEATURES,
    LINK_FAULTS,
    MAJOR,
    MINOR,
    OWNED,
    RESETS,
    SAVED_LOW_SUPPLY,
    SAVED_OTHER_VERSION,
    SAVED_SAVING,
    STATE_RUNNING,
    STATUSES,
    WIFI_RESTS,
    YOURS,
)
from tiniscript.link.names import row_name
from tiniscript.link.outcomes import OTHER_ROBOT, UNPROVEN
from tiniscript.link.payloads import HelloReply, SentReply, StatusReply, TrimReply
from tiniscript.link.requests import OK, Reply
from tiniscript.link.robot_state import line_error_count

PING_COUNT = 20
PING_PAUSE_MS = 50  # between two of them
MAX_LOST = 2  # most messages of 20 that may be repeated or damaged
POLL_COUNT = 6  # whether it is still the same robot, and was not restarted meanwhile
POLL_INTERVAL_MS = 250
_STALL = next(number for number, name, _ in LINK_FAULTS if name == "STALL")
_BROWN_OUT = "BROWN_OUT"
_WATCHDOG = "WATCHDOG"


class RobotAnswers(NamedTuple):
    """The answers of a robot. `trips_ms`: the times of immediate answers to PING."""

    hello: HelloReply
    status: StatusReply
    trim: TrimReply | None
    trips_ms: tuple[float, ...]


class Expectations(NamedTuple):
    """The kit that the robot should have, None for any; `name_of_kit` returns the robot of a kit,
    or an empty text.

    `has_key` says whether this computer has a key of the robot with this id. `doubt_of` returns the
    cause why the robot on `port` may not be the one of a key, or nothing. `on_facts` gets a robot's
    own description, whatever is wrong with it, and `on_answers` the answers. `ping_count`: how many
    times it is asked whether it hears.
    """

    kit: int | None
    name: str
    name_of_kit: Callable[[int], str | None]
    has_key: Callable[[int], bool] = lambda robot: False
    doubt_of: Callable[[str, HelloReply], str] = lambda port, hello: ""
    port: str = ""
    on_facts: Callable[[Mapping[str, str]], None] = lambda facts: None
    on_answers: Callable[[RobotAnswers], None] = lambda answers: None
    ping_count: int = PING_COUNT


class Restart(NamedTuple):
    """A restart that was seen: whether a program ran just before, and its cause."""

    was_running: bool
    cause: str


def examine(
    robot: Robot, hello_reply: Reply[SentReply], expectations: Expectations, watch_ms: int = 0,
    on_step: Callable[[str], None] = lambda step: None,
) -> list[Finding]:  # fmt: skip
    """Return the faults of a robot whose answer to HELLO is `hello_reply`.

    If there are none, the only finding that is not a note is `fine`. `on_step` gets `pings` and
    `watch`.
    """
    hello = hello_values(hello_reply)
    if hello_reply.status == OTHER_ROBOT:  # the tsc that has the port does not believe it
        return [sure_finding("other_robot", id=f"{hello_reply.detail:08x}")]
    if hello_reply.status == UNPROVEN:
        return [sure_finding("unproven", id="ID")]
    if hello is None:
        return [_other_link(hello_reply)]
    if doubt := expectations.doubt_of(expectations.port, hello):
        return [sure_finding(doubt, id=f"{hello.id:08x}")]
    findings = [
        *_version_findings(hello),
        *_kit_findings(hello, expectations),
        *_owner_findings(robot, hello, expectations),
    ]
    if hello.features & WIFI_RESTS:
        findings.append(sure_finding("wifi_rests"))
    expectations.on_facts(_report_fields(hello, expectations))
    status_before = robot.status()
    restarts: list[Restart] = []
    if status_before is not None:
        findings += _status_findings(status_before)
        loss_findings, trips_ms = _link_findings(robot, status_before, expectations, on_step)
        findings += loss_findings
        expectations.on_answers(RobotAnswers(hello, status_before, _trim(robot, hello), trips_ms))
        on_step("watch")
        restarts = _watch_restarts(robot, hello, watch_ms)
    status_after = robot.status() if status_before is not None else None
    if restarts:
        findings += _restart_findings(restarts)
    elif status_after is None:
        findings.append(probable_finding("falls_silent"))
    elif row_name(RESETS, hello.reset) == _BROWN_OUT:
        findings.append(sure_finding("brown_out"))
    elif row_name(RESETS, hello.reset) == _WATCHDOG or status_after.fault == _STALL:
        findings.append(sure_finding("hung"))
    if not any(finding.is_wrong for finding in findings):
        name = hello.name.decode("utf-8", "replace")
        kit_name = expectations.name_of_kit(hello.kit) or f"{hello.kit:04x}"
        values = {
            "name": name or kit_name,
            "kit": kit_name,
            "id": f"{hello.id:08x}",
            "n": str(expectations.ping_count),
        }
        findings.append(sure_finding("fine", **values))
    return findings


def _report_fields(hello: HelloReply, expectations: Expectations) -> dict[str, str]:
    """Return the facts about a robot for a report, except for its owner."""
    features = [name for bit, name, _ in FEATURES if hello.features & bit]
    return {
        "kit": expectations.name_of_kit(hello.kit) or f"{hello.kit:04x}",
        "link": f"{hello.major}.{hello.minor}",
        "machine": f"{hello.isa_major}.{hello.isa_minor}",
        "room": str(hello.room),
        "features": ", ".join(features) or "-",
        "reset": row_name(RESETS, hello.reset),
    }


def _other_link(reply: Reply[SentReply]) -> Finding:
    if reply.status != STATUSES["OTHER_LINK"]:
        return probable_finding(
            "firmware_older", theirs=f"status {reply.status}", ours=f"{MAJOR}.{MINOR}"
        )
    cause = "firmware_older" if reply.detail < MAJOR else "firmware_newer"
    return sure_finding(cause, theirs=str(reply.detail), ours=str(MAJOR))


def _version_findings(hello: HelloReply) -> list[Finding]:
    """Compare versions: additional features of a newer robot do no harm."""
    robot_isa, own_isa = (hello.isa_major, hello.isa_minor), (ISA_MAJOR, ISA_MINOR)
    is_newer = hello.isa_major > ISA_MAJOR or hello.major > MAJOR
    if not is_newer and robot_isa >= own_isa and (hello.major, hello.minor) >= (MAJOR, MINOR):
        return []
    values = {
        "theirs": f"{hello.major}.{hello.minor} / {robot_isa[0]}.{robot_isa[1]}",
        "ours": f"{MAJOR}.{MINOR} / {own_isa[0]}.{own_isa[1]}",
    }
    return [sure_finding("firmware_newer" if is_newer else "firmware_older", **values)]


def _kit_findings(hello: HelloReply, expectations: Expectations) -> list[Finding]:
    known_name = expectations.name_of_kit(hello.kit)
    kit = f"{hello.kit:04x}"
    if expectations.kit is not None and hello.kit != expectations.kit:
        return [
            sure_finding("wrong_kit", kit=kit, robot=known_name or kit, expected=expectations.name)
        ]
    if expectations.kit is None and known_name is None:
        return [sure_finding("unknown_kit", kit=kit)]
    return []


def _owner_findings(robot: Robot, hello: HelloReply, expectations: Expectations) -> list[Finding]:
    """Compare the allowed drivers: a refusal looks like a robot that does nothing."""
    may_be_own = not robot.has_tried_keys and expectations.has_key(hello.id)
    is_others = hello.features & (OWNED | YOURS) == OWNED and not may_be_own
    return [sure_finding("of_another_owner")] if is_others else []


def _status_findings(status: StatusReply) -> list[Finding]:
    """Return the findings about the robot's supply, latch and program."""
    findings = []
    if status.saved == SAVED_LOW_SUPPLY:
        findings.append(sure_finding("low_supply"))
    if status.saved == SAVED_SAVING:
        findings.append(sure_finding("not_saved_yet"))
    if status.saved == SAVED_OTHER_VERSION:
        findings.append(sure_finding("other_program"))
    if status.state > STATE_RUNNING:
        findings.append(sure_finding("stopped"))
    return findings


def _link_findings(
    robot: Robot,
    status_before: StatusReply,
    expectations: Expectations,
    on_step: Callable[[str], None],
) -> tuple[list[Finding], tuple[float, ...]]:
    """Send PING, and count late answers and frames that reached the robot damaged."""
    on_step("pings")
    trips_ms = trips_of(robot, expectations.ping_count, lambda: robot.pause(PING_PAUSE_MS))
    missed_count = expectations.ping_count - len(trips_ms)
    status_after = robot.status()
    damaged_count = 0
    if status_after is not None:
        pairs = zip(_error_counts(status_before), _error_counts(status_after), strict=True)
        damaged_count = sum((count_now - count_before) & 0xFF for count_before, count_now in pairs)
    values = {
        "missed": str(missed_count),
        "n": str(expectations.ping_count),
        "damaged": str(damaged_count),
    }
    expectations.on_facts({"good": str(len(trips_ms)), **values})
    loss_findings = []
    if max(missed_count, damaged_count) * PING_COUNT >= MAX_LOST * expectations.ping_count:
        loss_findings = [sure_finding("lossy", **values)] if status_after is not None else []
    elif status_after is not None and line_error_count(status_before) >= 10 * MAX_LOST:
        loss_findings = [
            probable_finding("lossy", **{**values, "damaged": str(line_error_count(status_before))})
        ]
    return loss_findings, trips_ms


def trips_of(
    robot: Robot, count: int, pause: Callable[[], None] = lambda: None
) -> tuple[float, ...]:
    """Send this many PINGs; return the time in milliseconds of each immediate answer."""
    trips_ms: list[float] = []
    for _ in range(count):
        missed_before, began_s = robot.missed_count, perf_counter()
        robot.ask("PING")
        if robot.missed_count == missed_before:
            trips_ms.append((perf_counter() - began_s) * 1000)
        pause()
    return tuple(trips_ms)


def _trim(robot: Robot, hello: HelloReply) -> TrimReply | None:
    """Return the robot's trim, if this user may read it; otherwise None."""
    if hello.features & (OWNED | YOURS) == OWNED:
        return None
    reply = robot.ask("TRIM", try_count=1)
    values = reply.values if reply is not None and reply.status == OK else None
    return values if isinstance(values, TrimReply) else None


def _error_counts(status: StatusReply) -> tuple[int, int, int, int]:
    return status.damaged, status.dropped, status.framing, status.overrun


def _watch_restarts(robot: Robot, hello: HelloReply, watch_ms: int) -> list[Restart]:
    """Look for a while whether the robot restarts: then its nonce is another one."""
    restarts = []
    nonce, is_running = hello.nonce, hello.state == STATE_RUNNING
    for _ in range(max(POLL_COUNT, watch_ms // POLL_INTERVAL_MS)):
        robot.pause(POLL_INTERVAL_MS)
        hello_now = hello_values(robot.hello())
        if hello_now is None:
            continue
        if hello_now.nonce != nonce:
            restarts.append(Restart(is_running, row_name(RESETS, hello_now.reset)))
            nonce = hello_now.nonce
        is_running = hello_now.state == STATE_RUNNING
    return restarts


def _restart_findings(restarts: list[Restart]) -> list[Finding]:
    """Return the cause of restarts: it was certainly the voltage only if the chip reports that."""
    count = str(len(restarts))
    restarts_while_driving = [restart for restart in restarts if restart.was_running]
    if restarts_while_driving:
        is_cause_known = any(restart.cause == _BROWN_OUT for restart in restarts_while_driving)
        return [
            Finding(
                "motors_restart",
                is_cause_known,
                {"count": count, "reset": restarts_while_driving[-1].cause},
            )
        ]
    if restarts[-1].cause == _WATCHDOG:
        return [sure_finding("hung")]
    return [sure_finding("restarts", count=count, reset=restarts[-1].cause)]
