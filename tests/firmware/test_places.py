"""Places of programs: the firmware reports the same place as the machine in Python."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.owners import Keys, OwnedRobot, owner_of
from tests.support.robot_on_host import KIT, computer, switched_on
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.image import Image
from tiniscript.link.authority import OWNED_BY_YOU
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, PLACES, STATE_RUNNING, decode_payload
from tiniscript.link.outcomes import Event, PlaceEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.vm.machine import Machine

PROGRAMS = [
    "SI|F(1, 80);R(0.6, 60);F(1, 80)",
    "SI|DEF TURN;L(0.1, 50);END_DEF;LOOP(3);F(0.2, 80);TURN;END_LOOP;B(0.3, 40)",
    "SI|N = 1;WHILE(N < 4);F(0.1, 30);W(0.05);N = N + 1;END_WHILE;R(0.2, 20)",
    "SI|F(1, 50) UNTIL(DISTANCE < 20);IF(DISTANCE > 20);R(0.4, 70);ELSE;L(0.4, 70);ENDIF;B(1, 8)",
]
DRIVE = PROGRAMS[0]


def ask_for_place(robot: HostFirmware, seq: int, epoch: int) -> tuple[int, int, bytes]:
    """Ask for the place in one frame; return state, run and place of the reply."""
    data = b"\0" + encode_frame(Frame(BY_NAME["PING"].number, seq & 0xFF, epoch, b"\1"))
    frames = [decode_frame(part) for part in robot.step(data).split(b"\0") if part]
    frame = next(frame for frame in frames if frame and frame.number == BY_NAME["PING"].number)
    assert frame.payload[0] == OK
    values = decode_payload(BY_NAME["PING"].reply, frame.payload[1:])
    state, run, place = values["state"], values["run"], values["place"]
    assert isinstance(state, int) and isinstance(run, int) and isinstance(place, bytes)
    return state, run, place


def places(image: Image, began_ms: int, sensed: int) -> Iterator[int]:
    """Yield where the machine in Python is, each millisecond from its begin on."""
    robot = TracedRobot(KIT, lambda sensor: sensed)
    machine = Machine(image.code, robot, len(KIT.readings), now_ms=began_ms)
    now_ms = began_ms
    while machine.tick(now_ms, 1000) == "waiting":
        yield machine.offset
        now_ms += 1


@pytest.mark.parametrize("text", PROGRAMS)
def test_reported_places_match_the_python_machine(text: str) -> None:
    robot, session = switched_on(), computer()
    robot.set_readings(*[30_000] * len(KIT.sensors))
    assert robot.until(session, session.hello()) == OK
    assert session.robot and session.robot.values.features & PLACES
    image = image_of(text)
    assert robot.until(session, session.upload(image, saves=False)) == OK
    began_ms = int(robot.did[0].split()[0])
    machine = places(image, began_ms, 30_000)
    place_events_of = []
    for _ in range(robot.now_ms - began_ms + 1):
        next(machine)
    for seq, at in enumerate(machine, 50):
        state, _, place = ask_for_place(robot, seq, session._epoch)
        assert state == STATE_RUNNING
        assert place == at.to_bytes(2, "little") + image.checksum.to_bytes(4, "little")
        place_events_of.append(at)
    assert len(set(place_events_of)) >= 3
    robot.wait(20)
    assert ask_for_place(robot, 40, session._epoch)[2] == b""


def listener(nonce: int = 1) -> Session:
    session = computer(nonce)
    session.tells_places = True
    return session


def events_after(robot: HostFirmware, session: Session, milliseconds: int) -> list[Event]:
    robot.talk(session, milliseconds)
    return session.events()


def place_events_of(events: list[Event]) -> list[PlaceEvent]:
    return [event for event in events if isinstance(event, PlaceEvent)]


def test_a_subscribed_session_gets_each_place_of_each_run_once() -> None:
    robot, session = switched_on(), computer()
    image = image_of(DRIVE)
    assert robot.until(session, session.upload(image, saves=False)) == OK
    assert place_events_of(events_after(robot, session, 3000)) == [], "it has not asked"
    session.tells_places = True
    assert robot.until(session, session.start()) == OK
    events = events_after(robot, session, 3000)
    place_events = place_events_of(events)
    assert [place_event.offset for place_event in place_events] == sorted(
        {event.offset for event in place_events}
    )
    assert len(place_events) == 3 and all(
        place_event[:2] == (2, image.checksum) for place_event in place_events
    )
    assert [event.name for event in events].count("DONE") == 1
    for run in (3, 4):
        assert robot.until(session, session.start()) == OK
        assert place_events_of(events_after(robot, session, 500))[0].run == run
        session.stop(robot.now_ms)
        assert place_events_of(events_after(robot, session, 1500)) == [], (
            "after a stop there is none"
        )


def test_runs_started_by_the_button_and_lines_also_report_places() -> None:
    robot, session = switched_on(), listener()
    waits = image_of("SB" + DRIVE[2:])
    assert robot.until(session, session.upload(waits, saves=False)) == OK
    assert place_events_of(events_after(robot, session, 1500)) == []
    robot.push()
    assert place_events_of(events_after(robot, session, 1500))[0].program == waits.checksum
    line = image_of("SI|L(3, 20)")
    assert robot.until(session, session.live(line.code)) == OK
    assert place_events_of(events_after(robot, session, 500))[0].program == line.checksum


def test_a_sealed_session_gets_sealed_places() -> None:
    table, keys = OwnedRobot(), Keys()
    table.claim_session(keys)
    session = table.session(keys, nonce=4)
    assert owner_of(table, session) == OWNED_BY_YOU
    session.tells_places = True
    image = image_of(DRIVE)
    assert table.robot.until(session, session.upload(image, saves=False)) == OK
    received_bytes = b""
    events: list[Event] = []
    for _ in range(900):
        data = session.poll(table.robot.now_ms)
        received_bytes += data
        session.receive(table.robot.step(data), table.robot.now_ms)
        events += session.events()
    frames = [decode_frame(part) for part in received_bytes.split(b"\0") if part]
    assert frames and all(frame and frame.is_sealed for frame in frames)
    assert {place_event.program for place_event in place_events_of(events)} == {image.checksum}
