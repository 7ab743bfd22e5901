"""The history of a robot affects only its stored data.

Computers and people do anything with a robot: they ask for everything, give up in the middle of it,
type lines and parts of lines, push the button, pull the cable. Then it is stopped, and its twin is
switched on: a robot with the same memory. From here on, both behave identically, whatever the
requests and whatever their clocks show.

`python -m tests.firmware.test_history 2000` tries more.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from copy import deepcopy
from functools import lru_cache
from typing import Any, NamedTuple

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.bytes_around import PIECES
from tests.support.campaign import each_seed, make_options
from tests.support.compared_answers import answer_without_counts, first_difference, without_counts
from tests.support.images import image_of
from tests.support.owners import Keys, OwnedRobot
from tests.support.robot_on_host import KIT
from tests.support.small_robot import READINGS, SmallRobot, draw_program, without_readings
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import AUTHORITY_MS, BY_NAME, KEY_OWNER, KEY_TEACHER
from tiniscript.link.outcomes import TextEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

Asks = Callable[[Session, random.Random], PendingRequest[Any]]
BUTTON_PRESSED, BUTTON_RELEASED, LINE_STALLED, CABLE_UNPLUGGED, BUTTON_HELD = 1, 2, 4, 8, 32
LONG_PROGRAM = "SI|" + "F(0.1, 80); B(0.1, 60); SHOW(1); " * 20
SHORT_PROGRAM = "SI|F(0.1, 80);SHOW(2);B(0.1, 30)"
TONE_PROGRAM = "BEEP(0.9, 440);W(0.1)"
TRIMS = ((0, 0, 0), (1, 0, 0), (0, 30, 0), (6, -20, 25), (9, 0, 0))
NO_ZERO_LINE = b"// Lines end with Enter, not with 0\r\n"
LOST_PROGRAM_LINE = b"// The old program is lost.\r\n"
SILENCE_MS = 4200  # time after which no client is heard
RETRY_MS = 105  # time between two requests to a robot that is not ready, and the time of writing
RUN_MS = 700
START_UPTIME_MS = 60_000  # uptime of the computer
IDENTIFY_MS = 3300
LINE_END_MEMORY_MS = 65_000  # time after which line ends are no longer assumed


def immediate_program(rng: random.Random) -> str:
    """Return a program that begins at once."""
    return "SI|" + rng.choice((SHORT_PROGRAM[3:], LONG_PROGRAM[3:], draw_program(rng)))


def program_without_readings(rng: random.Random) -> str:
    """Return a program of the size of a line, with no readings."""
    return "SI|" + without_readings(
        rng.choice((SHORT_PROGRAM[3:], "BEEP(0.001, 31);M(20, 30);W(0.2)", TONE_PROGRAM))
    )


# -- requests and typed text --------------------------------------------------------------------

# Steps that leave the robot's memory unchanged.
HARMLESS_REQUESTS: dict[str, Asks] = {
    "hello": lambda session, rng: session.hello(),
    "ping": lambda session, rng: session.ping(),
    "status": lambda session, rng: session.status(),
    "clear": lambda session, rng: session.clear(),
    "trim?": lambda session, rng: session.trim(),
    "a live line": lambda session, rng: session.live(image_of(program_without_readings(rng)).code),
    "a program": lambda session, rng: session.upload(
        image_of(program_without_readings(rng), KIT), saves=False
    ),
    "a long program": lambda session, rng: session.upload(image_of(LONG_PROGRAM, KIT), saves=False),
    "a program for the button": lambda session, rng: session.upload(
        image_of("SB|" + SHORT_PROGRAM[3:], KIT), runs=False, saves=False
    ),
    "a program that goes on alone": lambda session, rng: session.upload(
        image_of(program_without_readings(rng), KIT), saves=False, is_detached=True
    ),
}
CHANGING_REQUESTS: dict[str, Asks] = {
    "identify": lambda session, rng: session.identify(),
    "any program": lambda session, rng: session.upload(
        image_of(immediate_program(rng), KIT), saves=False
    ),
    "a saved program": lambda session, rng: session.upload(image_of(immediate_program(rng), KIT)),
    "a waiting program": lambda session, rng: session.upload(
        image_of("SB|" + draw_program(rng), KIT), runs=False
    ),
    "undo": lambda session, rng: session.undo(),
    "name": lambda session, rng: session.name(rng.choice((b"Pia", b"x", b"sixteen letters!"))),
    "trim": lambda session, rng: session.trim(bytes(k % 256 for k in rng.choice(TRIMS))),
}
# Results for the program that a robot holds, which may differ from the saved one.
PROGRAM_REQUESTS: dict[str, Asks] = {
    "start": lambda session, rng: session.start(),
    "fetch": lambda session, rng: session.fetch(),
}
CLIENT_KINDS = ("owner", "owner", "teacher", "stranger", "thief")
OWNER_REQUESTS: dict[str, Asks] = {
    "a teacher's stop": lambda session, rng: session.hold_back(),
    "text": lambda session, rng: session.allow_text(rng.random() < 0.5),
    "a claim": lambda session, rng: session.claim(rng.choice((KEY_OWNER, KEY_TEACHER))),
}
LINES = (
    "SI|F(0.1, 80);SHOW(3)", "SI|X = 2;SHOW(X)", "SB|B(0.2, 40)", "F(0.1, 30)", "FOO(1)", "F(1,",
    "HELP", "PING|CHECK_CONNECTION", "SI|LOOP(2)", "W(0.05)", "END_LOOP", "LOOP(2)", "S", "stop",
    "SI|F(1,500)", "AT", "+OK", "SI|W(9)", "// note", "", "IF(TRUE)", "S // all",
    "SI|X = 1.234567", "SI|IF(TRUE)", "SI|LOOP(2);W(0.01)", "SI|DEF A", "END_DEF", "FOO(1)",
    "FOO(2)", "SI|" + "BEEP(0.001, 97);" * 9,
)  # fmt: skip
LINE_ENDS = ("\n", "\n", "\r\n", "")
TEXT = tuple(piece for piece in PIECES if b"\0" not in piece)
# After these, another line with its SETUP word is read at once, as usual.
HARMLESS_BYTES = (b" ", b"\t", b";", b"\xef\xbb\xbf", b"AT", b"AT+NAMEx", b"OK+CONN", b"+CONNECTED",
                  b"F", b"x", b"1", b"// note", b"~1234ABCD", b"\x1b[A", b"\x1b", b"\x7f", b"\xff",
                  b"\xc3", b"x" * 300, b"FOO(1)", b"SI|FOO()", b"SI|F(1,500)", b"SB|9",
                  b"END_LOOP", b"HELP", b"SI|X = 3", b"SI|X = 1;SHOW(1.5)",
                  b"PING|CHECK_CONNECTION", b"SI|X = TRUE", b"SI|CM = 1",
                  b"SB|BEEP(0.001, 97)", b"SI|F(1 80)")  # fmt: skip
LINES_WITH_SETUP = tuple(line for line in LINES if "|" in line)
STOPS = (bytes(4), b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0)), b"\0S\n", b"S\n")
TYPED_STOP = b"\nSI|W(9)\nS\n"  # ends an open block, inside which S would be an instruction


KeyRings = dict[str, Keys]  # key rings by owner; a stranger's is empty


class Scene:
    """A robot with its clients."""

    def __init__(
        self,
        kind: type[HostFirmware],
        memory: bytes,
        write_ms: float,
        clock_ms: int,
        rings: KeyRings,
    ) -> None:
        self.robot = kind(KIT, memory, write_ms=write_ms, clock_ms=clock_ms - START_UPTIME_MS)
        self.robot.now_ms = START_UPTIME_MS
        self.robot.set_readings(*READINGS)
        self.robot.wait(300)
        self.nonce = 0
        self.rings = rings
        self.session = self.next_session()
        self.is_down = False  # the button
        self.has_faulted = False
        self.is_saved = True  # the program that it holds
        self.observed: list[object] = []  # all that can be seen

    def next_session(self, role: str = "owner") -> Session:
        """Start the session of another computer: with the owner's key, a wrong one, or none."""
        self.nonce += 1
        ring = self.rings.get(role, Keys())
        self.session = Session(self.nonce, 9600, KIT.fingerprint, keys=ring)
        return self.session

    def note(self, action: str, began_ms: int, data: bytes = b"") -> None:
        """Record the results of a step; times count from its beginning."""
        self.has_faulted |= any(line.endswith("FAULTED") for line in self.robot.did)
        rows = (line.split(" ", 1) for line in self.robot.did)
        self.observed.append((action, [(int(ms) - began_ms, event) for ms, event in rows]))
        lines = re.findall(rb"// [^\r\n]*\r\n", data)
        lines = [line for line in lines if line != NO_ZERO_LINE]  # this line may be late
        self.observed += [line for line in lines if self.is_saved or line != LOST_PROGRAM_LINE]
        heard_events = (
            event for event in self.session.events() if not isinstance(event, TextEvent)
        )
        self.observed += [without_counts(event) for event in heard_events]
        if self.is_saved:
            self.observed.append(self.robot.is_lit)
        self.robot.did.clear()

    def ask(self, name: str, make: Asks, rng: random.Random, limit_ms: int = 20_000) -> None:
        """Ask for something, and give up after a while."""
        began_ms = self.robot.now_ms
        request = make(self.session, rng)
        while request.outcome is None and self.robot.now_ms < began_ms + limit_ms:
            self.robot.talk(self.session, 1)
        but = () if self.is_saved else ("slot", "saved")
        self.observed.append((name, answer_without_counts(request, *but)))
        self.note(name, began_ms)

    def talk(self, milliseconds: int) -> None:
        began_ms = self.robot.now_ms
        self.robot.talk(self.session, milliseconds)
        self.note("talks", began_ms)

    def say(self, data: bytes, wait_ms: int) -> None:
        began_ms = self.robot.now_ms
        reply = self.robot.latched_while(max(1, len(data)), data, is_spread=True)[0]
        reply += self.robot.wait(wait_ms)
        self.note(f"says {data!r}", began_ms, reply)

    def press(self, milliseconds: int) -> None:
        began_ms = self.robot.now_ms
        self.robot.talk(self.session, 1, BUTTON_PRESSED)
        self.robot.talk(self.session, milliseconds)
        self.robot.talk(self.session, 1, BUTTON_RELEASED)
        self.robot.talk(self.session, RUN_MS)
        self.note("a press", began_ms)


# -- before -------------------------------------------------------------------------------------


def send_request(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """Ask for something; mostly wait for its end."""
    name = rng.choice([*requests])
    if rng.random() < 0.3:
        scene.next_session()
    scene.ask(name, requests[name], rng, rng.choice((1, 4, 15, 50, 5000, 5000)))
    scene.robot.talk(scene.session, rng.choice((0, 1, 30, 300)))


def send_half_request(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """The line breaks within a frame, usually near its end; another client continues."""
    name = rng.choice([*requests])
    robot, session = scene.robot, scene.session
    requests[name](session, rng)
    for _ in range(rng.choice((1, 2, 3, 4, 9))):
        data = session.poll(robot.now_ms)
        if data:
            session.receive(robot.step(data[: -rng.choice((1, 1, 2, 4, 6, len(data)))]), 0)
    if rng.random() < 0.7:
        scene.next_session()
    robot.wait(rng.choice((1, 30, 1100)))
    scene.observed.append(f"half of {name}")


def send_lines(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    for _ in range(rng.choice((1, 1, 3))):
        text = rng.choice(LINES)
        if rng.random() < 0.2:
            text = text[: rng.randrange(len(text) + 1)]
        scene.say((text + rng.choice(LINE_ENDS)).encode(), rng.choice((0, 20, 300, 1100, 2500)))


def send_harmless_line(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    data = b"".join(rng.choices(HARMLESS_BYTES, k=rng.choice((1, 1, 2, 3))))
    scene.say(data + rng.choice((b"\n", b"\r", b"\r\n")), 20)
    scene.say(rng.choice((b"", b"\0")) + b"//\n", 300)  # no frame has begun


def send_pieces(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    scene.say(b"".join(rng.choices(TEXT, k=rng.randint(1, 4))), rng.choice((0, 5, 300, 1100)))


def send_noise(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    data = b"".join(rng.choices(PIECES, k=rng.randint(1, 4)))
    if rng.random() < 0.3:
        frame = encode_frame(Frame(rng.randrange(1, 25), rng.randrange(256), 0, rng.randbytes(9)))
        data = b"\0" + frame[: rng.randrange(len(frame) + 1)]
    scene.say(data, rng.choice((0, 5, 300, 1100)))


def toggle_button(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """Press or release the button."""
    scene.is_down = not scene.is_down
    scene.robot.talk(scene.session, 1, BUTTON_PRESSED if scene.is_down else BUTTON_RELEASED)
    if scene.is_down and rng.random() < 0.5:
        scene.robot.talk(scene.session, 35)
        scene.robot.talk(scene.session, 1, BUTTON_HELD)
    scene.robot.talk(scene.session, rng.choice((0, 40, 300, 1200)))


def lower_supply(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """Lower the supply for a while, in which something may be saved."""
    scene.robot.set_supply(True)
    for _ in range(rng.choice((1, 2))):
        send_request(scene, rng, CHANGING_REQUESTS)
        scene.robot.talk(scene.session, rng.choice((0, 700)))
    if rng.random() < 0.5:
        scene.robot.set_supply(False)


def disturb(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """A stall, a cable, a stop, silence."""
    kind = rng.randrange(4)
    if kind < 2:
        scene.robot.step(flags=(LINE_STALLED, CABLE_UNPLUGGED)[kind])
    elif kind == 2:
        scene.session.stop(scene.robot.now_ms)
        scene.robot.talk(scene.session, rng.choice((1, 5, 100)))
    else:
        scene.robot.wait(rng.choice((30, 1100, SILENCE_MS)))


def send_owner_requests(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """A client connects with a key, a wrong one, or none."""
    scene.next_session(rng.choice(CLIENT_KINDS))
    for _ in range(rng.choice((1, 1, 2, 4))):
        name = rng.choice([*requests])
        scene.ask(name, requests[name], rng, rng.choice((1, 4, 15, 50, 2000)))
        scene.robot.talk(scene.session, rng.choice((0, 1, 30, 300)))


def press_long(scene: Scene, rng: random.Random, requests: dict[str, Asks]) -> None:
    """Two seconds of the button let text drive, or confirm a claim that was asked for."""
    robot, session = scene.robot, scene.session
    if rng.random() < 0.5:
        session.claim(rng.choice((KEY_OWNER, KEY_TEACHER)))
        robot.talk(session, rng.choice((1, 20, 400)))
    down_ms = rng.choice((700, 1500, 2100))
    for milliseconds, flags in (
        (30, BUTTON_PRESSED),
        (down_ms, BUTTON_HELD),
        (40, BUTTON_RELEASED),
    ):
        robot.talk(session, 1, flags)
        robot.talk(session, milliseconds)


class Before(NamedTuple):
    """Steps, their requests, and whether they change stored data."""

    steps: tuple[Callable[[Scene, random.Random, dict[str, Asks]], None], ...]
    asks: dict[str, Asks]
    saves: bool


PREVIOUS_HISTORIES = {
    "anything": Before(
        (send_request, send_request, send_half_request, send_lines, send_noise, toggle_button,
         lower_supply, disturb),
        {**HARMLESS_REQUESTS, **CHANGING_REQUESTS, **PROGRAM_REQUESTS}, True),
    "requests": Before((send_request, send_half_request, send_noise, toggle_button, disturb),
                       HARMLESS_REQUESTS, False),
    "whole lines": Before((send_harmless_line,), {}, False),
    "lines": Before((send_lines, send_lines, send_lines, send_pieces, toggle_button), {}, False),
    "owners": Before(
        (send_owner_requests, send_owner_requests, send_lines, press_long, toggle_button, disturb),
        {**HARMLESS_REQUESTS, **CHANGING_REQUESTS, **OWNER_REQUESTS,
         "fetch": PROGRAM_REQUESTS["fetch"]}, True),
}  # fmt: skip


def settle(scene: Scene, is_saved: bool, rng: random.Random) -> bytes:
    """Release everything, and wait until all data is stored; return the memory."""
    robot = scene.robot
    if scene.rings:  # releasing the button ends the teacher's rights, and text drives no more
        robot.wait(AUTHORITY_MS)
        robot.push()
        sessions = map(scene.next_session, CLIENT_KINDS)  # any of them may have claimed it
        assert any(robot.until(each, each.allow_text(False), 60_000) == OK for each in sessions)
    robot.set_supply(False)
    if scene.is_down:
        robot.step(flags=BUTTON_RELEASED)
        scene.is_down = False
    if is_saved:
        robot.wait(2, bytes(4))
        robot.wait(IDENTIFY_MS)
    memory = robot.memory()
    while is_saved and robot.now_ms < START_UPTIME_MS + 200_000:
        robot.wait(800)
        if robot.memory() == memory:
            break
        memory = robot.memory()
    if robot.is_latched:  # its effects end before the next program
        robot.step(flags=rng.choice((0, LINE_STALLED, CABLE_UNPLUGGED)))
    return memory


# -- after --------------------------------------------------------------------------------------


class Behind(NamedTuple):
    stop: bytes
    wait_ms: int
    is_cut: bool  # after an earlier upload, the robot holds the saved program
    steps: int
    is_typed: bool
    is_going_on: bool = False  # whether the program still runs


def drawn_stop(rng: random.Random, text_before: str) -> Behind:
    """Return a way to stop the robot. A person types only when no client is heard any more."""
    stop = drawn_behind(rng, text_before)
    # Only the owner gets the program of a claimed robot.
    return stop._replace(is_cut=False) if text_before == "owners" else stop


def drawn_behind(rng: random.Random, text_before: str) -> Behind:
    is_typed = "lines" in text_before or (text_before == "anything" and rng.random() < 0.5)
    if text_before == "whole lines":
        return Behind(b"", 0, False, rng.choice((1, 2, 4)), True, True)
    waits: tuple[int, ...] = (30, 60, 300, 1100, SILENCE_MS)
    if text_before == "lines" and rng.random() < 0.6:
        return Behind(TYPED_STOP, rng.choice((1, 100, 200, 700, 1300)), False, 3, True)
    if text_before == "lines":
        waits = (1100, 1100, 1300, 2500)
    elif is_typed:
        waits = (SILENCE_MS, 6000, LINE_END_MEMORY_MS)
    # In an open block S is an instruction of it. After frames it waits, as it may be one of them.
    stops = STOPS if text_before == "anything" else STOPS[:2]
    is_cut = text_before != "lines" and rng.random() < 0.6
    return Behind(rng.choice(stops), rng.choice(waits), is_cut, rng.choice((1, 2, 3, 5)), is_typed)


def stop_both(scene: Scene, stop: Behind) -> None:
    """Stop the robot and its twin in the same way."""
    robot = scene.robot
    scene.is_saved = stop.is_cut
    if stop.is_cut:
        scene.nonce = 500
        session = scene.next_session()
        session.upload(image_of(LONG_PROGRAM, KIT))
        robot.talk(session, 12)
    if not stop.is_going_on:
        robot.wait(2, stop.stop)
        robot.wait(stop.wait_ms)
    elif not scene.observed:
        robot.wait(300, b"//\n")
    if stop.is_typed and stop.stop not in (b"", TYPED_STOP) and stop.wait_ms < LINE_END_MEMORY_MS:
        robot.wait(1200, b"\n")  # shows the robot that lines end with \n
    robot.did.clear()
    scene.observed.clear()
    scene.nonce = 1000
    scene.next_session()


def observe(scene: Scene, stop: Behind, rng: random.Random) -> list[object]:
    """Ask for things; return all that can be seen."""
    requests = {
        **HARMLESS_REQUESTS,
        **CHANGING_REQUESTS,
        **(PROGRAM_REQUESTS if stop.is_cut else {}),
        **(OWNER_REQUESTS if scene.rings else {}),
    }
    if not stop.is_cut:
        for name in ("undo", "status", "hello"):
            del requests[name]
    for count in range(stop.steps):
        if stop.is_typed:
            text = rng.choice(LINES_WITH_SETUP if stop.is_going_on and count == 0 else LINES)
            scene.say(
                (text + rng.choice(LINE_ENDS)).encode(), rng.choice((0, 30, RUN_MS, 2600, 5200))
            )
        elif stop.is_cut and rng.random() < 0.2:
            scene.press(rng.choice((40, 300)))
        else:
            name = rng.choice([*requests])
            if scene.rings and rng.random() < 0.5:
                scene.next_session(rng.choice(CLIENT_KINDS))
                scene.robot.until(scene.session, scene.session.hello())
            scene.ask(name, requests[name], rng)
            scene.talk(RUN_MS)
    return [*scene.observed, *stored_data_at_end(scene, stop)]


def stored_data_at_end(scene: Scene, stop: Behind) -> list[object]:
    """Stop the robot; return its identity, and its stored data."""
    robot, session = scene.robot, scene.next_session()
    robot.set_supply(False)
    robot.wait(SILENCE_MS, bytes(4))
    robot.until(session, session.hello())
    assert session.robot
    values = session.robot.values
    trim = session.trim()  # a claim that was confirmed may have given it another key
    robot.until(session, trim)
    robot.talk(session, 1500)
    kept_bytes = robot.memory() if stop.is_cut else b""
    return [(values.id, values.name, values.features, answer_without_counts(trim)), kept_bytes]


@lru_cache(maxsize=1)
def new_memory() -> bytes:
    """Return the memory of an unused robot."""
    robot = HostFirmware(KIT)
    robot.wait(1000)
    return robot.memory()


@lru_cache(maxsize=1)
def claimed_memory_and_keys() -> tuple[bytes, KeyRings]:
    """Return the memory of a robot with an owner and a teacher, and everybody's keys."""
    table, keys = OwnedRobot(new_memory()), Keys()
    for key_kind in (KEY_OWNER, KEY_TEACHER):
        table.claim_session(keys, key_kind)
    table.robot.wait(1000)
    owner_key, teacher_key = keys.stored_keys
    wrong_key = owner_key._replace(key=bytes(range(16)))
    key_by_name = {"owner": owner_key, "teacher": teacher_key, "thief": wrong_key}
    rings = {
        role: Keys(first_number=10 * k) for k, role in enumerate(("stranger", *key_by_name), 1)
    }
    for role, key in key_by_name.items():
        rings[role].stored_keys = [key]
    return table.robot.memory(), rings


def clock(rng: random.Random) -> int:
    """Return the initial value of a clock; usually a part of it wraps around soon, or in the
    story.
    """
    return rng.choice((0, 2**16, 2**31, 2**32)) - rng.choice((0, 500, 3000, 12_000, 30_000))


def check(seed: int, kind: str, text_before: str) -> int:
    """Compare a robot with its twin; return how much there was to be seen."""
    rng = random.Random(f"{seed} {kind} {text_before}")
    write_ms = rng.choice((3.4, 3.4, 12))
    first, rings = (
        deepcopy(claimed_memory_and_keys()) if text_before == "owners" else (new_memory(), {})
    )
    scene = Scene(KINDS[kind], first, write_ms, clock(rng), rings)
    for _ in range(rng.choice((1, 2, 4, 8))):
        rng.choice(PREVIOUS_HISTORIES[text_before].steps)(
            scene, rng, PREVIOUS_HISTORIES[text_before].asks
        )
    scene.talk(0)
    is_saved = PREVIOUS_HISTORIES[text_before].saves or scene.has_faulted
    memory = settle(scene, is_saved, rng)
    assert is_saved or memory == new_memory()
    history = scene.observed[:]
    stop = drawn_stop(rng, text_before)
    twin = Scene(KINDS[kind], memory, write_ms, clock(rng), deepcopy(scene.rings))
    drawn_alike = rng.random()
    states_of_both = []
    for one_scene in (scene, twin):
        stop_both(one_scene, stop)
        states_of_both.append(observe(one_scene, stop, random.Random(drawn_alike)))
    # If a cut program is still being saved, a request is repeated until that is over.
    assert are_alike(states_of_both[0], states_of_both[1], RETRY_MS if stop.is_cut else 0), (
        f"{history}\n{stop}\n{first_difference(*states_of_both)}"
    )
    return len(states_of_both[0])


def are_alike(first: object, second: object, apart_ms: int) -> bool:
    """Return whether both observations are the same, at times that differ by at most this much."""
    if isinstance(first, (list, tuple)) and isinstance(second, (list, tuple)):
        if (
            len(first) == len(second) == 2
            and isinstance(first[0], int)
            and isinstance(first[1], str)
        ):
            is_near = isinstance(second[0], int) and abs(first[0] - second[0]) <= apart_ms
            return is_near and first[1] == second[1]
        pairs = zip(first, second, strict=False)
        return len(first) == len(second) and all(are_alike(a, b, apart_ms) for a, b in pairs)
    return first == second


KINDS: dict[str, type[HostFirmware]] = {"a mega": HostFirmware, "an uno": SmallRobot}


@pytest.mark.sampled("kind", "part")
@pytest.mark.parametrize("part", range(10))
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("text_before", PREVIOUS_HISTORIES)
def test_a_robot_behaves_like_its_twin_with_another_history(
    text_before: str, kind: str, part: int
) -> None:
    counts = [check(seed, kind, text_before) for seed in range(part * 10, part * 10 + 10)]
    assert sum(counts) > 20 and min(counts) > 0, counts


def check_all(seed: int) -> None:
    for kind in KINDS:
        for text_before in PREVIOUS_HISTORIES:
            check(seed, kind, text_before)


if __name__ == "__main__":
    each_seed(check_all, make_options(2000, 10_000))
