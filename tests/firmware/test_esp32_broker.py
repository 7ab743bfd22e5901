"""An ESP32 at an MQTT broker, Debian's Mosquitto unchanged: its drivers and its stops."""

from __future__ import annotations

import random
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import NamedTuple

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_broker import (
    DEAD_MAN_MS,
    ID,
    broker_settings_of,
    connect_to_broker,
    list_present_robots,
    motor_state,
    wait_until,
)
from tests.support.esp32_radio import RawClient, set_network_in_reach, talk
from tests.support.esp32_wifi import (
    join_network,
    remote,
    restart_with_school_in_reach,
    school_in_reach,
)
from tests.support.images import image_of
from tests.support.mosquitto import LOCAL_ADDRESS, AtBroker, Mosquitto
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import AWAY_PROGRAM, Ends, upload_text, wait_for_outcome
from tests.support.waiting import HANG_LIMIT_S
from tests.support.waiting import until as in_time
from tiniscript.link import errors, wifi
from tiniscript.link.errors import PortError
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import AUTHORITY_MS, BY_NAME, STOP_BYTES
from tiniscript.link.session import Session
from tiniscript.link.transports.broker import ROOT, Access, Broker, RobotPresence

LONGEST_RETRY_MS = 5000  # until a robot tries again to reach its broker
LONGEST_TALK_MS = 200
RECONNECT_MS = 300  # longest delay after a connection has ended
BROKER_KEY = b"broker"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Mosquitto]:
    mosquitto = Mosquitto(tmp_path_factory.mktemp("broker"))
    yield mosquitto
    mosquitto.kill()


@pytest.fixture
def broker(server: Mosquitto) -> Iterator[Mosquitto]:
    yield server
    server.part()


class Drive(NamedTuple):
    """A robot that the owner drives over a broker."""

    robot: Esp32Robot
    teacher: Broker
    owner: Session
    ends: Ends


def start_drive(broker: Mosquitto, text: str = AWAY_PROGRAM, keys: Keys | None = None) -> Drive:
    keys = keys or Keys()
    robot, _ = connect_to_broker(broker, keys)
    teacher, owner = broker.connect_client(), remote(robot, keys)
    clients: Ends = [(AtBroker(robot, teacher), owner)]
    assert upload_text(robot, clients, owner, text) == "OK"
    return Drive(robot, teacher, owner, clients)


def talk_until_still(robot: Esp32Robot, clients: Ends, limit_ms: int) -> None:
    end_ms = robot.now_ms + limit_ms
    while motor_state(robot) != "MOTORS 0 0":
        talk(robot, clients, 5)
        assert robot.now_ms < end_ms


def test_lack_of_memory_for_a_broker_is_reported_and_the_connection_retried(
    broker: Mosquitto,
) -> None:
    robot, owner = join_network(Keys())
    robot.radio("H", b"\1")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(broker.settings())) == "OK"
    talk(robot, [(None, owner)], 1500)
    assert broker_settings_of(robot, owner)[1] == "NO_TLS"
    robot.radio("H", b"\0")
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")


# -- the road -----------------------------------------------------------------------------------


def test_the_owner_drives_over_a_broker_and_one_message_stops_the_class(
    broker: Mosquitto,
) -> None:
    robot, teacher, owner, clients = start_drive(broker)
    assert list_present_robots(robot, teacher) == [RobotPresence(ID, "tini-5678", True)]
    other_client = broker.connect_client()
    other_client.stop("another")
    talk(robot, clients, 1500)
    assert motor_state(robot) == "MOTORS 80 80"
    other_client.stop("aula")
    talk_until_still(robot, clients, DEAD_MAN_MS)
    owner.events()
    assert upload_text(robot, clients, owner) == "OK"
    assert motor_state(robot) == "MOTORS 80 80"
    owner.stop(robot.now_ms)
    talk(robot, clients, 60)
    assert motor_state(robot) == "MOTORS 0 0"
    assert any(event.name == "STOPPED" for event in owner.events())


def test_a_long_program_and_its_values_pass_the_broker(broker: Mosquitto) -> None:
    lines = "".join(f"X = {k}; " for k in range(400))
    robot, _, owner, clients = start_drive(broker, f"SI|{lines}SHOW(X); SHOW(X > 1)")
    talk(robot, clients, 300)
    names = [event.name for event in owner.events()]
    assert names.count("SHOW") == 2 and "DONE" in names


def test_the_broker_is_stored_reported_and_forgotten(broker: Mosquitto) -> None:
    robot, owner = connect_to_broker(broker, Keys())
    assert broker_settings_of(robot, owner) == ("STATION", "READY", "aula")
    restarted_robot = restart_with_school_in_reach(robot)
    teacher = broker.connect_client()
    wait_until(
        restarted_robot,
        lambda: (
            list_present_robots(restarted_robot, teacher) == [RobotPresence(ID, "tini-5678", True)]
        ),
    )
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(None)) == "OK"
    assert broker_settings_of(robot, owner) == ("OFF", "OFF", "")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(broker.settings())) == "OK"
    assert wait_for_outcome(robot, [(None, owner)], owner.forget_wifi()) == "OK"
    assert broker_settings_of(robot, owner)[0] == "OFF", "who gives a robot away forgets both"
    assert b"hunter" not in b"".join(robot.read_kept().entries.values())


def test_invalid_broker_settings_are_refused(broker: Mosquitto) -> None:
    robot, owner = connect_to_broker(broker, Keys())
    names = ("", "a/b", "a+", "#", "Aula", "aula 3", "ñ", "x" * 17)
    for settings in (
        wifi.BrokerSettings(bytes(4), 0, "aula"),
        *(wifi.BrokerSettings(bytes(4), 1883, name) for name in names),
        wifi.BrokerSettings(bytes(4), 1883, "aula", b"a\0b"),
        wifi.BrokerSettings(bytes(4), 1883, "aula", b"a", b"a\0b"),
    ):
        assert not settings.is_sound
        assert (
            wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "BAD_VALUE"
        ), settings
        assert broker_settings_of(robot, owner) == ("STATION", "READY", "aula")


def test_a_broker_may_require_name_and_password(
    brokers: Callable[..., Mosquitto],
) -> None:
    user, password = "robots", "a long password: 40 letters and some more"
    own_broker = brokers(user, password)
    robot, owner = connect_to_broker(
        own_broker, Keys(), own_broker.settings("aula", user, password)
    )
    assert b"40 letters" in robot.read_kept().entries[BROKER_KEY], "it has come whole"
    wrong_settings = own_broker.settings("aula", user, "another one")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(wrong_settings)) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "REFUSED")
    for access in (Access(), Access(user, "another one"), Access("who", "x")):
        with pytest.raises(PortError) as failure:
            own_broker.connect_client(access)
        assert failure.value.reason == errors.REFUSED
    own_broker.connect_client(Access(user, password)).close()


def test_a_driver_keeps_the_robot_while_it_sends_messages(broker: Mosquitto) -> None:
    """Its silence counts from its last message, not from its first."""
    robot, _ = connect_to_broker(broker, Keys())
    teacher, stranger = broker.connect_client(), broker.connect_client()
    topic = f"{ROOT}/aula/{ID}/in/"
    for k in range(4000):  # milliseconds: longer than a client may be silent
        if k % 250 == 0:
            teacher.publish(topic + teacher.peer, b"\0")
        if k % 250 == 125:
            stranger.publish(topic + stranger.peer, b"\0")
        robot.step()
        time.sleep(0.0005)
    end, other_session = AtBroker(robot, stranger), remote(robot, None, 12)
    end.port._patient_until_s = 0.0
    other_session.ping()
    talk(robot, [(end, other_session)], 300)
    assert end.has_ended, "it is told that another one has the robot"
    teacher.publish(topic + teacher.peer, b"")  # this client leaves
    talk(robot, [(end, RawClient())], 100)
    end, other_session = AtBroker(robot, stranger), remote(robot, None, 13)
    end.port._patient_until_s = 0.0
    assert wait_for_outcome(robot, [(end, other_session)], other_session.ping()) == "OK"
    talk(robot, [(end, other_session)], 500)
    assert not end.has_ended, "it has the robot now, and is not told that again"


def test_setting_the_same_broker_repeatedly_keeps_one_connection(broker: Mosquitto) -> None:
    """Otherwise it would use up all sockets of an ESP32."""
    robot, owner = connect_to_broker(broker, Keys())
    for _ in range(20):
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(broker.settings())) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY", 10_000)


# -- stops --------------------------------------------------------------------------------------


def test_a_stranger_can_only_stop(broker: Mosquitto) -> None:
    robot, teacher, owner, clients = start_drive(broker)
    stranger, other_session = broker.connect_client(), remote(robot, Keys(50), 11)
    end = AtBroker(robot, stranger)
    end.port._patient_until_s = 0.0
    request = other_session.live(image_of("F(1, 9)").code)
    talk(robot, [*clients, (end, other_session)], 300)
    assert request.outcome is None and end.has_ended, "it is told that another one has the robot"
    assert motor_state(robot) == "MOTORS 80 80"
    for _ in range(20):  # an unfinished frame would spoil the owner's next one
        stranger.publish(f"{ROOT}/aula/{ID}/in/{stranger.peer}", b"\3\2\1")
        talk(robot, clients, 10)
    pending_request = owner.status()
    assert wait_for_outcome(robot, clients, pending_request) == "OK" and pending_request.outcome
    assert pending_request.outcome.values.damaged == 0
    topic = f"{ROOT}/aula/{ID}/in/{teacher.peer}"
    for junk in (b"SI|B(9, 90)\n", b"\3\2\1\0" * 50, bytes(range(1, 255)), b"GET / HTTP/1.1\r\n"):
        stranger.publish(topic, junk)
        talk(robot, clients, 100)
    assert motor_state(robot) == "MOTORS 80 80"
    for name in ("in/x", "in/" + "g" * 8, "in/" + "0" * 9, "in", "stop", f"in/{ID}/more"):
        stranger.publish(f"{ROOT}/aula/{ID}/{name}", bytes(STOP_BYTES))
    stranger.publish(f"{ROOT}/aula/stop", b"stop")
    stranger.publish(f"{ROOT}/aula/stop", bytes(3))
    talk(robot, clients, 200)
    assert motor_state(robot) == "MOTORS 80 80", "none of these is a stop"
    for length in (513, 20_000):
        stranger.publish(f"{ROOT}/aula/{ID}/in/{stranger.peer}", bytes(length))
    talk(robot, clients, 500)
    assert motor_state(robot) == "MOTORS 80 80", "nor is what is too long, which is skipped"
    assert wait_for_outcome(robot, clients, owner.ping()) == "OK"
    stranger.publish(f"{ROOT}/aula/{ID}/in/{stranger.peer}", bytes(STOP_BYTES))
    talk(robot, clients, 100)
    assert motor_state(robot) == "MOTORS 0 0"


def test_a_strangers_typed_stop_works(broker: Mosquitto) -> None:
    """It is a whole line in one message; a frame's code may contain such bytes."""
    robot, _, owner, clients = start_drive(broker)
    stranger = broker.connect_client()
    topic = f"{ROOT}/aula/{ID}/in/{stranger.peer}"
    for none in (
        b"ST\n",
        b"SI",
        b"// S\n",
        b"\0\3S.\n",
        encode_frame(Frame(BY_NAME["LIVE"].number, 9, 0, b"\1Z\nS\n")),
    ):
        stranger.publish(topic, none)
        talk(robot, clients, 100)
    for stop in (b"S\n", b"F(1,80)\r\n ; stop ;\r", b"Stop", b"SS\n", b"PARA", b"\0S.\n", b"S\0",
                 b"\3", b"FFSSS", b"stop STOP now"):  # fmt: skip
        assert motor_state(robot) == "MOTORS 80 80"
        stranger.publish(topic, stop)
        talk(robot, clients, 100)
        assert motor_state(robot) == "MOTORS 0 0", stop
        assert upload_text(robot, clients, owner) == "OK"


def test_retained_messages_count_as_old(broker: Mosquitto) -> None:
    """A retained stop does not prevent driving, and a retained request has no effect."""
    keys = Keys()
    stranger = broker.connect_client()
    topics = [f"{ROOT}/aula/stop", f"{ROOT}/aula/{ID}/in/{stranger.peer}"]
    for topic in topics:
        stranger._client.publish(topic, bytes(STOP_BYTES), retain=True)
    try:
        robot, owner = connect_to_broker(broker, keys)
        cable: Ends = [(None, owner)]
        set_network_in_reach(robot, "", "")
        talk(robot, cable, 50)
        assert upload_text(robot, cable, owner) == "OK"
        school_in_reach(robot)
        for _ in range(600):  # a broker repeats retained messages when the robot returns
            talk(robot, cable, 10)
            time.sleep(0.005)
            if broker_settings_of(robot, owner)[1] == "READY":
                break
        talk(robot, cable, 300)
        assert (
            broker_settings_of(robot, owner)[1] == "READY" and motor_state(robot) == "MOTORS 80 80"
        )
    finally:
        for topic in topics:
            stranger._client.publish(topic, b"", retain=True)
        stranger.close()


def test_replayed_messages_have_no_effect(
    broker: Mosquitto, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All that the owner has said, later, in its order: a whole drive and more."""
    heard_bytes: list[bytes] = []
    send = AtBroker.send

    def record_and_send(end: AtBroker, data: bytes) -> None:
        heard_bytes.append(data)
        send(end, data)

    monkeypatch.setattr(AtBroker, "send", record_and_send)
    robot, _, _, clients = start_drive(broker, "SI|F(0.2, 80)")
    thief = broker.connect_client()
    talk(robot, clients, 400)
    end = clients[0][0]
    assert isinstance(end, AtBroker)
    end.leave()
    talk(robot, [], AUTHORITY_MS + 3500)
    count_before = len(robot.did)
    for data in heard_bytes * 2:
        thief.publish(f"{ROOT}/aula/{ID}/in/{thief.peer}", data)
        thief.publish(end.port.topic, data)
        for _ in range(10):
            robot.step()
            time.sleep(0.0005)
    assert heard_bytes and not [line for line in robot.did[count_before:] if "MOTORS" in line]


def test_a_robot_without_an_owner_does_nothing_at_a_broker(broker: Mosquitto) -> None:
    robot, cable = connect_to_broker(broker, Keys())
    assert wait_for_outcome(robot, [(None, cable)], cable.disown(0)) == "OK"
    talk(robot, [], AUTHORITY_MS + 100)
    count_before = len(robot.did)
    teacher = broker.connect_client()
    client = remote(robot, None)
    clients: Ends = [(AtBroker(robot, teacher), client)]
    assert wait_for_outcome(robot, clients, client.ping()) == "OK"
    for acting in (client.live(image_of("F(1, 9)").code), client.upload(image_of(AWAY_PROGRAM)),
                   client.name(b"x")):  # fmt: skip
        assert wait_for_outcome(robot, clients, acting) == "UNOWNED"
    assert not [line for line in robot.did[count_before:] if "MOTORS" in line]


# -- ends ---------------------------------------------------------------------------------------


@pytest.mark.sampled("failure")
@pytest.mark.parametrize("failure", ["dies", "stalls", "is out of reach"])
def test_losing_the_broker_ends_the_run(brokers: Callable[..., Mosquitto], failure: str) -> None:
    own_broker, keys = brokers(), Keys()
    robot, _, _, clients = start_drive(own_broker, keys=keys)
    talk(robot, clients, 500)
    assert motor_state(robot) == "MOTORS 80 80"
    if failure == "dies":
        own_broker.kill()
    elif failure == "stalls":
        own_broker.stall()
    else:
        set_network_in_reach(robot, "", "")
    talk_until_still(robot, clients, DEAD_MAN_MS if failure == "stalls" else RECONNECT_MS)
    own_broker.stall(False)
    if failure == "dies":
        own_broker.start()
    school_in_reach(robot)
    cable = remote(robot, keys, 20)
    assert wait_for_outcome(robot, [(None, cable)], cable.ping()) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, cable)[1] == "READY", 15_000)
    next_client, end = remote(robot, keys, 13), own_broker.connect_client()
    talk(robot, [], AUTHORITY_MS + 3000)
    assert upload_text(robot, [(AtBroker(robot, end), next_client)], next_client) == "OK"
    end.close()


# What a broker says to a robot: the answers to CONNECT and SUBSCRIBE, and a message of a client.
BROKER_ANSWERS = {
    0x10: b"\x20\2\0\0",
    0x82: b"\x90\4\0\1\0\0\x30\x2c\0\4tini" + bytes(range(1, 39)),
}


class CuttingBroker:
    """A broker in the chip's time that closes each connection after so many bytes of its own."""

    def __init__(self) -> None:
        self.server = socket.create_server(("127.0.0.1", 0))
        self.server.setblocking(False)
        self.connection: socket.socket | None = None

    def connect(self, robot: Esp32Robot, byte_count: int) -> bytes:
        """Await the robot, and talk until the end of the connection; return what was heard."""
        heard, end_ms = b"", robot.now_ms + LONGEST_RETRY_MS
        while robot.now_ms < end_ms:
            robot.wait(5 if self.connection else 50)
            if self.connection is None:
                with suppress(BlockingIOError):
                    self.connection = self.server.accept()[0]
                    self.connection.setblocking(False)
                    end_ms = robot.now_ms + LONGEST_TALK_MS
                continue
            data = b""
            with suppress(BlockingIOError):
                data = self.connection.recv(4096)
            heard += data
            answer = BROKER_ANSWERS.get(data[0], b"")[:byte_count] if data else b""
            self.connection.sendall(answer)
            byte_count -= len(answer)
            if byte_count == 0:
                break
        assert self.connection, "the robot comes back"
        self.connection.close()
        self.connection = None
        return heard


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(12))
def test_a_robot_returns_to_a_broker_that_was_lost_after_any_byte(seed: int) -> None:
    rng = random.Random(seed)
    cutting_broker = CuttingBroker()
    port = cutting_broker.server.getsockname()[1]
    robot, owner = join_network(Keys())
    settings = wifi.BrokerSettings(LOCAL_ADDRESS, port, "aula", b"", b"")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
    answer_size = sum(map(len, BROKER_ANSWERS.values()))
    for _ in range(3):
        cutting_broker.connect(robot, rng.randrange(1, answer_size))
        assert b"+tini-5678" in cutting_broker.connect(robot, answer_size + 1)
    cutting_broker.server.close()


def test_a_client_that_leaves_or_hangs_ends_its_run_and_makes_room(broker: Mosquitto) -> None:
    keys = Keys()
    robot, _, _, [(end, _)] = start_drive(broker, keys=keys)
    assert end
    end.leave()
    wait_until(robot, lambda: motor_state(robot) == "MOTORS 0 0", 200)
    second, next_client = broker.connect_client(), remote(robot, keys, 13)
    clients: Ends = [(AtBroker(robot, second), next_client)]
    second.attend()
    assert upload_text(robot, clients, next_client) == "OK"
    assert motor_state(robot) == "MOTORS 80 80"
    time.sleep(0.6)
    talk(robot, clients, 400)
    assert motor_state(robot) == "MOTORS 0 0"


@pytest.mark.parametrize("is_silent", [False, True])
def test_the_last_will_reports_absent_robots(broker: Mosquitto, is_silent: bool) -> None:
    """A connection that ends, and one that falls silent."""
    robot, _ = connect_to_broker(broker, Keys())
    teacher = broker.connect_client()
    if not is_silent:
        robot.close()
    gone_robot_presences = [RobotPresence(ID, "tini-5678", False)]
    in_time(lambda: teacher.list_robots("aula") == gone_robot_presences, "its last will")


def test_announcements_by_strangers_are_bounded(broker: Mosquitto) -> None:
    stranger, teacher = broker.connect_client(), broker.connect_client()
    announcements = {
        "12345678": b"+a/b+#\x1b[2J", "xyz": b"+no id", "1234567": b"+short", "1234567g": b"+no",
        "aaaaaaaa": b"?", "bbbbbbbb": b"", "cccccccc": b"+" + b"x" * 17, "dddddddd": b"+\xff\xfe",
    }  # fmt: skip
    topics = {f"{ROOT}/odd/{name}": data for name, data in announcements.items()}
    topics |= {f"{ROOT}/many/{k:08x}": b"+x" for k in range(300)}
    for topic, data in topics.items():
        stranger._client.publish(topic, data, retain=True)
    # now it has them all
    stranger._client.publish("last", b"", qos=1).wait_for_publish(HANG_LIMIT_S)
    assert {entry.id for entry in teacher.list_robots("odd")} == {"12345678", "dddddddd"}
    assert len(teacher.list_robots("many")) == 250
    for topic in topics:
        stranger._client.publish(topic, b"", retain=True)
    in_time(lambda: teacher.list_robots("many") == [], "they are forgotten")
