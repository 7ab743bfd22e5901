"""An ESP32 that is reached over several transports at once: a session each, and one that drives."""

from __future__ import annotations

import copy
import random
from collections.abc import Callable
from functools import lru_cache

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import (
    MIN_MTU,
    Client,
    End,
    LowEnergy,
    RawClient,
    SerialPort,
    radios,
    session,
    talk,
)
from tests.support.esp32_wifi import make_owned_robot
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import (
    AWAY_PROGRAM,
    RADIOS,
    Ends,
    Make,
    boot,
    claim_robot,
    upload_text,
    wait_for_outcome,
)
from tests.support.robot_on_host import actions_of
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import AUTHORITY_MS, BY_NAME, DEAD_MAN_MS, STOP_BYTES
from tiniscript.link.session import Session


@pytest.mark.parametrize("major", [2, 3])
@pytest.mark.parametrize("make", RADIOS)
def test_a_program_runs_over_each_radio(make: Make, major: int) -> None:
    robot = boot(major=major)
    client = session(1, robot)
    clients: Ends = [(make(robot), client)]
    assert upload_text(robot, clients, client, "SI|SHOW(5);F(0.5, 80)") == "OK"
    talk(robot, clients, 700)
    assert actions_of(robot)[:2] == ["MOTORS 80 80", "MOTORS 0 0"]
    assert [event.name for event in client.events()] == ["SHOW", "DONE"]


def test_a_single_core_chip_without_serial_port_profile_runs_programs() -> None:
    """Its idle task gets its turn."""
    robot = boot("tinibotc3")
    assert radios(robot)[:2] == ("tini-5678", "")
    rests_before = robot.rests()
    robot.wait(1000)
    assert 8 <= robot.rests() - rests_before <= 12
    two_cores = boot()
    two_cores.wait(1000)
    assert two_cores.rests() == 0


def test_the_radios_show_the_robots_name() -> None:
    robot = boot()
    assert radios(robot)[:2] == ("tini-5678", "tini-5678")
    client = session(1, robot)
    clients: Ends = [(None, client)]
    assert wait_for_outcome(robot, clients, client.name("Señal".encode())) == "OK"
    restarted_robot = Esp32Robot(kept_memory=robot.read_kept())
    restarted_robot.wait(300)
    assert radios(restarted_robot)[:2] == ("Señal", "Señal")


@pytest.mark.parametrize("make", RADIOS)
def test_one_client_drives_while_others_watch_and_stop(make: Make) -> None:
    robot = boot()
    driver, other_session = session(1, robot), session(2, robot)
    end = make(robot)
    clients: Ends = [(None, driver), (end, other_session)]
    assert upload_text(robot, clients, driver) == "OK"
    for request in (
        other_session.hello(),
        other_session.ping(),
        other_session.status(),
        other_session.identify(),
    ):
        assert wait_for_outcome(robot, clients, request) == "OK"
    refused_requests = (
        other_session.live(image_of("F(1, 10)").code), other_session.start(),
        other_session.name(b"mine"),
        other_session.upload(image_of(AWAY_PROGRAM)), other_session.undo(), other_session.trim(),
    )  # fmt: skip
    for refused_request in refused_requests:
        assert wait_for_outcome(robot, clients, refused_request) == "OTHER_DRIVER"
    assert actions_of(robot) == ["MOTORS 80 80"]
    talk(robot, clients, 1500)
    assert actions_of(robot) == ["MOTORS 80 80"], "the driver's session lives beside the other one"
    end.send(bytes(STOP_BYTES // 2))
    robot.wait(3)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    talk(robot, clients, 200)
    assert [event.name for event in driver.events()] == ["STOPPED"]
    assert wait_for_outcome(robot, clients, other_session.start()) == "OTHER_DRIVER"
    assert upload_text(robot, clients, driver) == "OK", "who drives goes on after it"


PROGRAM_ENDS: dict[str, tuple[str, str]] = {  # the program, and the events for everyone
    "by itself": ("SI|F(0.2, 80)", "DONE"),
    "its fault": ("SI|X = 0;F(0.2, 80);SHOW(1 / X)", "FAULT"),
    "its silent client": (AWAY_PROGRAM, "FAULT"),
    "its client that leaves": (AWAY_PROGRAM, "STOPPED"),
    "its client's zeros": (AWAY_PROGRAM, "STOPPED"),
    "another one's zeros": (AWAY_PROGRAM, "STOPPED"),
    "a message of another one": (AWAY_PROGRAM, "STOPPED"),
    "a line of another one": (AWAY_PROGRAM, "STOPPED"),
    "the button": (AWAY_PROGRAM, "STOPPED"),
}
HARMLESS_BYTES = {
    "its client's zeros": bytes(4),
    "another one's zeros": bytes(4),
    "a message of another one": b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0)),
    "a line of another one": b"\0S\n",
}


@pytest.mark.parametrize("driver", range(3))
@pytest.mark.parametrize("ending", PROGRAM_ENDS)
def test_all_listeners_get_the_same_end_of_a_run(ending: str, driver: int) -> None:
    """Each is told once, and their later requests belong to the time after it."""
    text, name = PROGRAM_ENDS[ending]
    if (ending, driver) == ("its client that leaves", 0):
        driver = 1  # a cable does not leave
    robot = boot()
    sessions = [session(number, robot) for number in (1, 2, 3)]
    ways: tuple[End | None, ...] = (None, LowEnergy(robot), SerialPort(robot))
    clients: Ends = list(zip(ways, sessions, strict=True))
    for client in sessions:
        assert wait_for_outcome(robot, clients, client.hello()) == "OK"
    assert upload_text(robot, clients, sessions[driver], text) == "OK"
    talk(robot, clients, 100)
    for client in sessions:
        client.events()
    other_number = 1 if driver == 2 else 2
    listening = [0, 1, 2]
    if ending in ("its silent client", "its client that leaves"):
        listening.remove(driver)
        if ending == "its client that leaves" and (way := ways[driver]) is not None:
            way.leave()
    elif ending in HARMLESS_BYTES:
        send_data(
            robot,
            clients[driver if ending.startswith("its") else other_number],
            HARMLESS_BYTES[ending],
        )
    listening_ends = [clients[place] for place in listening]
    talk(robot, listening_ends, 1, flags=ending == "the button")
    talk(robot, listening_ends, DEAD_MAN_MS + 300)
    events_by_client = [sessions[place].events() for place in listening]
    assert [event.name for event in events_by_client[0]] == [name], events_by_client
    assert all(events == events_by_client[0] for events in events_by_client), events_by_client
    for place in listening:
        assert wait_for_outcome(robot, listening_ends, sessions[place].identify()) == "OK"
        assert not sessions[place].events()


def send_data(robot: Esp32Robot, end: tuple[End | None, Client], data: bytes) -> None:
    """Send data of a client outside its session."""
    if end[0] is None:
        end[1].receive(robot.step(data), robot.now_ms)
    else:
        end[0].send(data)


@pytest.mark.parametrize("is_detached", [False, True])
def test_the_next_client_drives_once_the_first_is_silent(is_detached: bool) -> None:
    """Also while a detached program of the first runs on."""
    robot = boot()
    first, second = session(1, robot), session(2, robot)
    clients: Ends = [(None, first), (LowEnergy(robot), second)]
    image = image_of("SI|F(20, 30)" if is_detached else "SI|F(0.1, 30)")
    assert wait_for_outcome(robot, clients, first.upload(image, is_detached=is_detached)) == "OK"
    talk(robot, clients, 300)
    assert upload_text(robot, clients, second) == "OTHER_DRIVER"
    only: Ends = clients[1:]
    talk(robot, only, AUTHORITY_MS + 50)
    assert upload_text(robot, only, second) == "OK"
    talk(robot, only, 1500)
    assert actions_of(robot)[-1] == "MOTORS 80 80", (
        "the dead-man timer of the first ends nothing of his"
    )
    assert upload_text(robot, clients, first) == "OTHER_DRIVER"


def test_a_driver_keeps_the_robot_while_its_requests_are_in_time() -> None:
    """This holds between short runs, too, and for longer than the longest allowed silence."""
    robot = boot()
    first, second = session(1, robot), session(2, robot)
    clients: Ends = [(None, first), (LowEnergy(robot), second)]
    for _ in range(4):
        assert upload_text(robot, clients, first, "SI|F(0.1, 30)") == "OK"
        talk(robot, clients, AUTHORITY_MS - 500)
        assert upload_text(robot, clients, second) == "OTHER_DRIVER"


@pytest.mark.parametrize("make", RADIOS)
def test_a_leaving_client_ends_its_run_and_its_turn(make: Make) -> None:
    robot = boot()
    driver, other_session = session(1, robot), session(2, robot)
    end = make(robot)
    clients: Ends = [(end, driver), (None, other_session)]
    assert upload_text(robot, clients, driver) == "OK"
    end.leave()
    talk(robot, clients[1:], 5)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    assert upload_text(robot, clients[1:], other_session) == "OK"
    looking_session, end = session(3, robot), make(robot)
    assert (
        wait_for_outcome(robot, [(end, looking_session), *clients[1:]], looking_session.ping())
        == "OK"
    )
    end.leave()
    talk(robot, clients[1:], 300)
    assert actions_of(robot)[-1] == "MOTORS 80 80", "nothing of others"


def test_a_client_that_connects_right_after_another_is_not_confused_with_it() -> None:
    """The task of a radio may wait in a write meanwhile."""
    robot = boot()
    driver, other_session = session(1, robot), session(2, robot)
    end = SerialPort(robot)
    assert upload_text(robot, [(end, driver)], driver) == "OK"
    end.leave()
    clients: Ends = [(SerialPort(robot), other_session)]
    talk(robot, clients, 5)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    assert upload_text(robot, clients, other_session) == "OK"


def test_an_overtaken_upload_is_not_started() -> None:
    """Its memory is another program's by then."""
    robot = boot()
    clients: Ends = [
        (None, (first := session(1, robot))),
        (LowEnergy(robot), (second := session(2, robot))),
    ]
    long_image = image_of("SB|" + ";".join("F(1, 80)" for _ in range(800)))
    request = first.upload(long_image)
    while not request.done_bytes:
        assert request.outcome is None  # the request is too long for one frame
        talk(robot, clients, 1)
    talk(robot, clients[1:], AUTHORITY_MS + 50)  # the first one is out of reach
    assert upload_text(robot, clients[1:], second, "SB|F(1, 10)") == "OK"
    talk(robot, clients[1:], 20)
    talk(robot, [(clients[1][0], RawClient())], AUTHORITY_MS + 50)
    assert wait_for_outcome(robot, clients[:1], request, 20_000) in ("OK", "NOT_BEGUN")
    fetch = first.fetch()
    assert wait_for_outcome(robot, clients[:1], fetch) == "OK"


def test_notifications_fit_the_negotiated_mtu() -> None:
    robot = boot()
    for mtu, longest in (
        (23, 20),
        (40, 37),
        (100, 49),
        (512, 49),
        (5, 20),
    ):  # HELLO's answer: a 0x00, and 48
        client = session(mtu, robot)
        end = LowEnergy(robot, mtu)
        end.mtu = max(mtu, MIN_MTU)
        clients: Ends = [(end, client)]
        assert wait_for_outcome(robot, clients, client.hello()) == "OK"
        assert max(end.lengths) == longest
        end.leave()
        robot.wait(5)


def test_slow_notifications_delay_nobody_else() -> None:
    robot = boot()
    driver, slow_session = session(1, robot), session(2, robot)
    clients: Ends = [(None, driver), (LowEnergy(robot, look_interval=100), slow_session)]
    request = slow_session.status()
    assert upload_text(robot, clients, driver) == "OK"
    began_ms = robot.now_ms
    assert wait_for_outcome(robot, clients, driver.ping()) == "OK"
    assert robot.now_ms - began_ms < 30
    assert wait_for_outcome(robot, clients, request, 20_000) == "OK"
    slow_session.stop(robot.now_ms)
    talk(robot, clients, 20)
    assert actions_of(robot)[-1] == "MOTORS 0 0", "a stop needs no notification"


def test_output_refused_by_a_congested_stack_is_sent_later() -> None:
    robot = boot()
    once = RawClient(b"\0" + encode_frame(Frame(BY_NAME["STATUS"].number, 1, 0, b"")))
    end = LowEnergy(robot)
    clients: Ends = [(end, once)]
    robot.radio("k", b"\1")
    talk(robot, clients, 100)
    assert not once.received
    for is_congested in (b"\0", b"\1") * 20:
        robot.radio("k", is_congested)
        talk(robot, clients, 3)
    frame = decode_frame(once.received.strip(b"\0"))
    assert frame and len(end.lengths) == 2, "whole, and never asked for again"
    robot.radio("k", b"\1")
    talk(robot, [(end, session(1, robot))], 40)
    end.leave()
    second = LowEnergy(robot)
    robot.radio("k", b"\0")
    talk(robot, [(second, RawClient())], 100)
    assert not second.lengths, "what waits for one client is not told to the next one"


def test_a_client_that_reads_nothing_blocks_nobody() -> None:
    """The ring to it is full: its own replies wait, and the robot continues."""
    robot = boot()
    driver, deaf = session(1, robot), session(2, robot)
    end = LowEnergy(robot)
    clients: Ends = [(None, driver), (end, deaf)]
    assert upload_text(robot, clients, driver) == "OK"
    end.subscribe(False)
    talk(
        robot,
        [(None, driver), (end, RawClient(b"\0" + encode_frame(Frame(3, 1, 0, b"")) * 40))],
        3000,
    )
    assert actions_of(robot) == ["MOTORS 80 80"]
    end.send(bytes(STOP_BYTES))
    talk(robot, clients[:1], 20)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


def test_a_returning_client_starts_afresh() -> None:
    robot = boot()
    for k in range(5):
        client = session(k + 1, robot)
        end = LowEnergy(robot)
        clients: Ends = [(end, client)]
        assert upload_text(robot, clients, client, AWAY_PROGRAM) == "OK"
        end.send(b"\5\7\7")  # the client disconnects in the middle of a frame
        end.leave()
        talk(robot, [], 5)
        assert actions_of(robot)[-1] == "MOTORS 0 0"


def test_text_is_accepted_over_a_radio_unless_another_client_drives() -> None:
    robot = boot()
    driver, typed_bytes = session(1, robot), RawClient(b"SI|F(0.2, 50)\n")
    end = SerialPort(robot)
    talk(robot, [(end, typed_bytes)], 400)
    assert actions_of(robot)[:2] == ["MOTORS 50 50", "MOTORS 0 0"]
    assert b"// OK" in typed_bytes.received
    talk(robot, [], AUTHORITY_MS)
    clients: Ends = [(None, driver), (end, typed_bytes)]
    assert upload_text(robot, clients, driver) == "OK"
    typed_bytes.to_send, typed_bytes.received = b"F(0.2, 20)\n", b""
    talk(robot, clients, 300)
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    assert b"Not possible here" in typed_bytes.received
    typed_bytes.to_send = b"S\n"
    talk(robot, clients, 50)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


@pytest.mark.parametrize("make", RADIOS)
def test_line_endings_are_tracked_per_client(make: Make) -> None:
    """An app that ends no lines may follow one that does: its line runs after three seconds all the
    same."""
    robot = boot()
    end, typed_bytes = make(robot), RawClient(b"SHOW(1)\n")
    talk(robot, [(end, typed_bytes)], 100)
    assert b"// OK" in typed_bytes.received
    end.leave()
    talk(robot, [], AUTHORITY_MS)
    clients: Ends = [(make(robot), RawClient(b"SI|F(60, 50)"))]
    talk(robot, clients, 2900)
    assert "MOTORS 50 50" not in actions_of(robot)
    talk(robot, clients, 300)
    assert actions_of(robot)[-1] == "MOTORS 50 50"


def test_of_two_simultaneous_typists_the_first_line_is_read() -> None:
    """Both would be read in the same memory: no program is of two."""
    robot = boot()
    first, second = RawClient(b"SI|LOOP(2);"), RawClient()
    clients: Ends = [(None, first), (SerialPort(robot), second)]
    talk(robot, clients, 50)
    second.to_send = b"SI|F(0.1, "
    talk(robot, clients, 50)
    first.to_send = b"F(0.1, 44);END_LOOP\n"
    talk(robot, clients, 20)
    second.to_send = b"33)\n"
    talk(robot, clients, 400)
    assert [line for line in actions_of(robot) if "MOTORS" in line] == [
        "MOTORS 44 44",
        "MOTORS 0 0",
    ]
    assert b"// OK" in first.received and b"Send it again" in second.received


@pytest.mark.parametrize(
    "stop", [bytes(STOP_BYTES), b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))]
)
def test_a_stop_of_an_idle_robot_discards_text_typed_elsewhere(stop: bytes) -> None:
    robot = boot()
    first, second = RawClient(bytes(4)), RawClient()
    clients: Ends = [(None, first), (SerialPort(robot), second)]
    talk(robot, clients, 1500)
    first.to_send = b"SI|LOOP(2)\n"
    talk(robot, clients, 1500)
    assert b"END_LOOP" in first.received
    second.to_send = stop
    talk(robot, clients, 1500)
    first.to_send = b"F(0.1, 44)\nEND_LOOP\n"
    talk(robot, clients, 500)
    assert actions_of(robot) == []


def test_the_button_confirms_neither_of_two_claims() -> None:
    robot = boot()
    first, second = (Session(k, 115200, robot.robot.kit.fingerprint, keys=Keys(k)) for k in (1, 2))
    clients: Ends = [(None, first), (LowEnergy(robot), second)]
    claims = [first.claim(0), second.claim(0)]
    talk(robot, clients, 500)
    talk(robot, clients, 2300, flags=1)
    talk(robot, clients, 500, flags=2)
    assert [claim.outcome for claim in claims] == [None, None]
    talk(robot, clients[:1], AUTHORITY_MS + 100)  # the second one has left
    talk(robot, clients[:1], 2300, flags=1)
    talk(robot, clients[:1], 500, flags=2)
    assert claims[0].outcome and claims[0].outcome.status == 0


@pytest.mark.parametrize("make", RADIOS)
def test_a_changed_key_ends_the_authority_of_all_others(make: Make) -> None:
    """Whoever has the key of before does nothing more, also in a session that it has opened."""
    robot, owner = make_owned_robot(keys := Keys())
    talk(robot, [], AUTHORITY_MS + 100)
    copied_keys = copy.deepcopy(keys)
    other = Session(8, 115200, robot.robot.kit.fingerprint, keys=copied_keys)
    clients: Ends = [(None, owner), (make(robot), other)]
    assert wait_for_outcome(robot, clients, other.clear()) == "OK"
    claim_robot(robot, clients, owner)
    talk(robot, clients, AUTHORITY_MS + 100)
    assert wait_for_outcome(robot, clients, other.clear()) == "WRONG_KEY"
    assert wait_for_outcome(robot, clients, owner.clear()) == "OK"


def test_a_teachers_stop_holds_on_every_transport() -> None:
    robot = boot()
    keys = Keys()
    teacher = Session(1, 115200, robot.robot.kit.fingerprint, keys=keys)
    pupil = session(2, robot)
    clients: Ends = [(LowEnergy(robot), teacher), (None, pupil)]
    claim_robot(robot, clients, teacher, kind=1)
    assert wait_for_outcome(robot, clients, teacher.hold_back()) == "OK"
    talk(robot, clients[1:], AUTHORITY_MS + 100)
    assert wait_for_outcome(robot, clients[1:], pupil.clear()) == "HELD_BACK"
    assert upload_text(robot, clients[1:], pupil) == "HELD_BACK"
    assert wait_for_outcome(robot, clients, teacher.clear()) == "OK"


def overrun(robot: Esp32Robot) -> int:
    client = session(99, robot)
    status = client.status()
    assert wait_for_outcome(robot, [(None, client)], status) == "OK" and status.outcome
    overrun_count: int = status.outcome.values.overrun
    return overrun_count


@pytest.mark.parametrize("make", RADIOS)
def test_overflowing_input_is_counted_and_no_stop_is_lost(make: Make) -> None:
    """A packet of a serial port has up to 990 bytes: the core keeps 512 of them, unless asked."""
    for stop in (bytes(STOP_BYTES), b"\r\nS\r\n"):
        robot = boot()
        end = make(robot)
        talk(robot, [(end, RawClient(b"F(60, 80)\r\n"))], 50)
        assert actions_of(robot) == ["MOTORS 80 80"]
        end.send(b"// " + b"x" * 600 + stop)
        robot.wait(3)
        assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
        robot.wait(2000)
        assert robot.is_latched and overrun(robot) == 0
        end.send(b"// " + b"x" * 2000)
        assert overrun(robot) == (2003 - 1022) % 256


def test_a_serial_port_whose_client_reads_nothing_accepts_a_stop() -> None:
    """The core's `write` waits for a second meanwhile."""
    robot = boot()
    end = SerialPort(robot)
    talk(robot, [(end, RawClient(b"F(60, 80)\r\n"))], 50)
    robot.radio("Z", b"\1")
    end.send(b"?\r\n")  # the client has data to send
    robot.wait(100)
    end.send(b"S\r\n")
    robot.wait(3)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]


def test_an_upload_in_long_packets_of_a_serial_port_loses_nothing() -> None:
    robot = boot()
    client = session(3, robot)
    clients: Ends = [(SerialPort(robot), client)]
    text = "SI|" + ";".join(f"SHOW({1000 + k})" for k in range(900))
    assert (
        wait_for_outcome(robot, clients, client.upload(image_of(text), saves=False), 60_000) == "OK"
    )
    status = client.status()
    assert wait_for_outcome(robot, clients, status) == "OK" and status.outcome
    assert (status.outcome.values.damaged, status.outcome.values.overrun) == (0, 0)


def paste(
    size: int, burst: int, gap_ms: int
) -> Callable[[Esp32Robot, End, bytes, RawClient], None]:
    """Return a function that sends a text at a radio's pace: writes of a size, so many at once."""

    def send(robot: Esp32Robot, end: End, text: bytes, client: RawClient) -> None:
        for offset in range(0, len(text), size * burst):
            for k in range(offset, min(offset + size * burst, len(text)), size):
                end.send(text[k : k + size])
            talk(robot, [(end, client)], gap_ms)

    return send


PACES: dict[str, tuple[Make, Callable[..., None]]] = {
    "BLE, MTU 23": (LowEnergy, paste(20, 4, 30)),
    "BLE, MTU 247": (lambda robot: LowEnergy(robot, 247), paste(244, 4, 30)),
    "SPP, packets of 330": (SerialPort, paste(330, 1, 5)),
    "SPP, packets of 990": (SerialPort, paste(990, 1, 15)),
}


@pytest.mark.parametrize("comment", [b"", b" // one of forty"])
@pytest.mark.parametrize("pace", PACES)
def test_a_pasted_program_waits_until_the_robot_has_room(pace: str, comment: bytes) -> None:
    """At the pace of real radios, the robot acts as over its cable."""
    lines = b"".join(b"F(0.01, %d)%b\r\n" % (20 + k, comment) for k in range(40))
    text = b"LOOP(1)\r\n" + lines + b"END_LOOP\r\n"
    by_cable = boot()
    for offset in range(0, len(text), 11):
        by_cable.step(text[offset : offset + 11])
    by_cable.wait(2500)
    robot = boot()
    make, send = PACES[pace]
    end, client = make(robot), RawClient()
    send(robot, end, text, client)
    talk(robot, [(end, client)], 2500)
    assert client.received == b"// OK\r\n// DONE\r\n"
    assert actions_of(robot) == actions_of(by_cable) and len(actions_of(robot)) > 30
    assert overrun(robot) == 0


def hold_radio(robot: Esp32Robot, end: End, is_held: bool) -> None:
    """Let the radio take no more bytes for its client, or let it go on."""
    robot.radio("k" if isinstance(end, LowEnergy) else "Z", bytes([is_held]))


@pytest.mark.parametrize("make", RADIOS)
def test_lines_wait_while_their_answers_are_not_read(make: Make) -> None:
    """Each has an answer, which a client reads late; earlier lines are not lost either."""
    robot = boot()
    end, client = make(robot), RawClient()
    hold_radio(robot, end, True)
    end.send(b"".join(b"SHOW(%d)\r\n" % (100 + k) for k in range(90)))
    robot.wait(3000)
    hold_radio(robot, end, False)
    talk(robot, [(end, client)], 9000)
    assert b"lost" not in client.received and client.received.rstrip().endswith(b"// DONE")
    assert overrun(robot) == 0


WHOLE_LINES = (b"HELP\n", b"PING|CHECK_CONNECTION\n", b"SI|SHOW(7)\n", b"FOO(1)\n",
               b"HELP\nFOO(1)\n")  # fmt: skip
LONGEST_WRITE_MS = 1200  # the core's `write` gives up after a second


@lru_cache
def answer_by_cable(line: bytes) -> bytes:
    client = RawClient(line)
    talk(boot(), [(None, client)], 400)
    return client.received


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("make", RADIOS)
@pytest.mark.parametrize("seed", range(10))
def test_a_client_gets_all_of_its_answers_and_nothing_else(seed: int, make: Make) -> None:
    """However many bytes it has got, wherever the client before it left, and whenever the radio
    takes them.
    """
    rng = random.Random(seed)
    robot = boot()
    for _ in range(rng.randrange(3)):
        end = make(robot)
        hold_radio(robot, end, rng.random() < 0.5)
        talk(robot, [(end, RawClient(rng.choice(WHOLE_LINES)))], rng.randrange(1, 60))
        end.leave()
        talk(robot, [], LONGEST_WRITE_MS)
        hold_radio(robot, end, False)
    end, client = make(robot), RawClient()
    for _ in range(12):
        client.to_send, client.received = (line := rng.choice(WHOLE_LINES)), b""
        hold_radio(robot, end, rng.random() < 0.5)
        talk(robot, [(end, client)], rng.choice((5, 30, 60, LONGEST_WRITE_MS)))
        hold_radio(robot, end, False)
        talk(robot, [(end, client)], 300)
        assert client.received == answer_by_cable(line)


def press_keys(robot: Esp32Robot, clients: Ends, session: Session, keys: int = 1) -> str:
    return wait_for_outcome(robot, clients, session.press(keys))


def test_keys_come_from_the_driver_or_from_anybody_without_one() -> None:
    """Keys do not make their sender the driver."""
    robot = boot()
    first, second = session(1, robot), session(2, robot)
    clients: Ends = [(None, first), (LowEnergy(robot), second)]
    assert press_keys(robot, clients, first) == "OK"
    assert press_keys(robot, clients, second, 2) == "OK"
    assert upload_text(robot, clients, first) == "OK", "nobody was the driver"
    assert press_keys(robot, clients, second) == "OTHER_DRIVER"
    assert press_keys(robot, clients, first, 4) == "OK"
    first.stop(robot.now_ms)
    talk(robot, clients, AUTHORITY_MS + 500)
    assert press_keys(robot, clients, second) == "OK"
    assert upload_text(robot, clients, first) == "OK", "nor is he who has pressed last"


def test_keys_do_not_end_another_clients_upload() -> None:
    robot = boot()
    first, second = session(1, robot), session(2, robot)
    clients: Ends = [(None, first), (LowEnergy(robot), second)]
    assert wait_for_outcome(robot, clients, second.hello()) == "OK"
    long_image_upload = first.upload(image_of("SI|" + "F(0.01, 80);" * 2500), saves=False)
    press_count = 0
    while long_image_upload.outcome is None:
        press_count += wait_for_outcome(robot, clients, second.press(1 + press_count % 2)) in (
            "OK",
            "OTHER_DRIVER",
        )
    assert long_image_upload.outcome.status == 0 and press_count > 0
