"""An ESP32 at a broker that it knows by its name, and one that speaks TLS: mbedTLS as it is."""

from __future__ import annotations

import socket
import ssl
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from datetime import date
from pathlib import Path
from threading import Thread
from typing import NamedTuple

import pytest

from tests.machines.esp32 import HAS_TLS
from tests.support.certificates import Authority, der
from tests.support.esp32_broker import (
    DEAD_MAN_MS,
    ID,
    broker_settings_of,
    connect_to_broker,
    list_present_robots,
    motor_state,
    wait_until,
)
from tests.support.esp32_radio import announce_computer, talk
from tests.support.esp32_wifi import join_network, remote, restart_with_school_in_reach
from tests.support.mosquitto import LOCAL_ADDRESS, AtBroker, Mosquitto
from tests.support.network import CuttingNetwork
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, upload_text, wait_for_outcome
from tiniscript.link import wifi
from tiniscript.link.messages import BROKER_NAME_BYTES, TRUST_BYTES
from tiniscript.link.transports.broker import Access, Broker, RobotPresence

drawn = pytest.mark.sampled(of="an ESP32 and TLS", keep=2)

pytestmark = pytest.mark.skipif(not HAS_TLS, reason="needs libmbedtls-dev")

NAME = "broker.aula"
NOBODY = bytes((127, 0, 0, 9))
TODAY = int(date.today().strftime("%Y%m%d"))
LATER = 20991231


class Room(NamedTuple):
    broker: Mosquitto
    authority: Authority

    def settings(
        self, name: str = NAME, today: int = TODAY, trust: bytes | None = None
    ) -> wifi.BrokerSettings:
        tls = wifi.Tls(self.authority.der if trust is None else trust, today)
        return self.broker.settings()._replace(name=name.encode(), tls=tls)

    def connect(self) -> Broker:
        return self.broker.connect_client(
            Access(is_tls=True, trusted_file=str(self.authority.file))
        )


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Room]:
    folder = tmp_path_factory.mktemp("tls")
    authority = Authority(folder)
    made_room = Room(Mosquitto(folder, extra_lines=authority.rules(NAME)), authority)
    yield made_room
    made_room.broker.kill()


@pytest.fixture
def room(school: Room) -> Iterator[Room]:
    yield school
    school.broker.part()


def test_the_owner_drives_over_tls(room: Room) -> None:
    keys = Keys()
    robot, _ = connect_to_broker(room.broker, keys, room.settings())
    teacher = room.connect()
    assert list_present_robots(robot, teacher) == [RobotPresence(ID, "tini-5678", True)]
    owner = remote(robot, keys)
    clients: Ends = [(AtBroker(robot, teacher), owner)]
    lines = "".join(f"X = {k}; " for k in range(200))
    assert upload_text(robot, clients, owner, f"SI|{lines}F(9, 80)") == "OK"
    talk(robot, clients, 300)
    assert motor_state(robot) == "MOTORS 80 80"
    teacher.stop("aula")
    talk(robot, clients, 100)
    assert motor_state(robot) == "MOTORS 0 0"


@pytest.mark.sampled("fault", "state", keep=3)
@pytest.mark.parametrize(("fault", "state"), [
    ("another authority", "UNTRUSTED"), ("no certificate", "UNTRUSTED"),
    ("another name", "OTHER_NAME"), ("the start of the name", "OTHER_NAME"),
    ("it has ended", "EXPIRED"), ("a broker without TLS", "NO_TLS"),
])  # fmt: skip
def test_an_untrusted_broker_gets_no_data(
    room: Room, tmp_path: Path, brokers: Callable[..., Mosquitto], fault: str, state: str
) -> None:
    settings = room.settings()
    if fault == "another authority":
        settings = room.settings(trust=Authority(tmp_path).der)
    elif fault == "no certificate":
        settings = room.settings(trust=b"\x30\x82\x01\x00" + bytes(256))
    elif fault == "another name":
        settings = room.settings("localhost")
    elif fault == "the start of the name":
        settings = room.settings(NAME[:-1])
    elif fault == "it has ended":
        settings = room.settings(today=LATER)
    else:
        settings = settings._replace(port=brokers().port)
    robot, owner = join_network(Keys())
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == state)
    talk(robot, [(None, owner)], 1000)
    assert broker_settings_of(robot, owner)[1] == state, "it stays while the robot tries again"
    if state != "NO_TLS":
        teacher = room.connect()
        assert not [
            presence for presence in list_present_robots(robot, teacher) if presence.is_here
        ]
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(room.settings())) == "OK"
        wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")


@drawn
def test_a_newly_set_broker_does_not_inherit_the_previous_error(room: Room, tmp_path: Path) -> None:
    """Its task is looking a name up, for seconds, when the new one comes."""
    robot, owner = join_network(Keys())
    announce_computer(robot, NAME, "127.0.0.1", wait_ms=3000)
    wrong_settings = room.settings(trust=Authority(tmp_path).der)
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(wrong_settings)) == "OK"
    wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "UNTRUSTED")
    talk(robot, [(None, owner)], 4500)
    assert broker_settings_of(robot, owner)[1] == "UNTRUSTED"
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(room.settings())) == "OK"
    while (state := broker_settings_of(robot, owner)[1]) != "READY":
        assert state == "SEARCHING"
        talk(robot, [(None, owner)], 20)
        assert robot.now_ms < 30_000


@pytest.mark.parametrize(("version", "state"), [
    (ssl.TLSVersion.TLSv1_1, "NO_TLS"), (ssl.TLSVersion.TLSv1_2, "SEARCHING"),
])  # fmt: skip
def test_an_old_tls_is_refused(tmp_path: Path, version: ssl.TLSVersion, state: str) -> None:
    """The other end has the right certificate but is no broker."""
    authority = Authority(tmp_path)
    authority.rules(NAME)
    rules = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    rules.set_ciphers("ALL:@SECLEVEL=0")  # otherwise this computer offers no old version
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        rules.minimum_version = rules.maximum_version = version
    rules.load_cert_chain(authority.sign(NAME), tmp_path / f"{NAME}.key")
    robot, owner = join_network(Keys())
    spoken_texts: list[str | None] = []
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(120)

        def serve() -> None:
            client_socket, _ = server.accept()
            with client_socket, suppress(OSError):
                spoken_texts.append(rules.wrap_socket(client_socket, server_side=True).version())

        thread = Thread(target=serve)
        thread.start()
        tls = wifi.Tls(authority.der, TODAY)
        settings = PLAIN._replace(port=server.getsockname()[1], name=NAME.encode(), tls=tls)
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
        wait_until(robot, lambda: not thread.is_alive())
        wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == state)
        thread.join()
    assert spoken_texts == ([] if state == "NO_TLS" else ["TLSv1.2"])


@pytest.mark.parametrize("is_chain", [False, True])
def test_only_the_brokers_own_certificate_is_accepted_without_its_authority(
    tmp_path: Path, brokers: Callable[..., Mosquitto], is_chain: bool
) -> None:
    """The certificate is signed by an unknown authority. Its name and date still count."""
    authority = Authority(tmp_path)
    own_room = Room(brokers(extra_rules=authority.rules(NAME, is_chain)), authority)
    authority.rules("other.aula")
    trust, other_trust = (der(authority.sign(name)) for name in (NAME, "other.aula"))
    robot, owner = join_network(Keys())
    for settings, state in (
        (own_room.settings(trust=other_trust), "UNTRUSTED"),
        (own_room.settings(trust=trust), "READY"),
        (own_room.settings("localhost", trust=trust), "OTHER_NAME"),
        (own_room.settings(today=LATER, trust=trust), "EXPIRED"),
    ):  # fmt: skip
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
        talk(robot, [(None, owner)], 50)
        wait_until(robot, lambda state=state: broker_settings_of(robot, owner)[1] == state)  # type: ignore[misc]


def test_a_broker_that_dies_ends_the_run_over_tls(
    tmp_path: Path, brokers: Callable[..., Mosquitto]
) -> None:
    authority, keys = Authority(tmp_path), Keys()
    own_room = Room(brokers(extra_rules=authority.rules(NAME)), authority)
    robot, _ = connect_to_broker(own_room.broker, keys, own_room.settings())
    owner = remote(robot, keys)
    clients: Ends = [(AtBroker(robot, own_room.connect()), owner)]
    assert upload_text(robot, clients, owner) == "OK"
    talk(robot, clients, 500)
    assert motor_state(robot) == "MOTORS 80 80"
    own_room.broker.kill()
    began_ms = robot.now_ms
    while motor_state(robot) != "MOTORS 0 0":
        talk(robot, clients, 5)
        assert robot.now_ms < began_ms + DEAD_MAN_MS


@drawn
def test_a_silent_peer_is_given_up_while_the_cable_keeps_working(room: Room) -> None:
    """First a computer accepts the connection and stays silent, then the broker does."""
    keys = Keys()
    robot, owner = join_network(keys)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        settings = room.settings()._replace(port=silent.getsockname()[1])
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
        assert upload_text(robot, [(None, owner)], owner) == "OK"
        talk(robot, [(None, owner)], 300)
        assert motor_state(robot) == "MOTORS 80 80"
        talk(robot, [(None, owner)], 16_500)
        silent.settimeout(120)
        for _ in range(2):  # until the second attempt
            silent.accept()[0].close()
        assert broker_settings_of(robot, owner)[1] == "SEARCHING"


@drawn
def test_a_network_that_breaks_off_in_the_middle_of_tls_is_tried_again(room: Room) -> None:
    """In the first hello, in the certificate, after the handshake; and in pieces of 7 bytes."""
    cuts = CuttingNetwork(room.broker.port, (3, 200, 1500))
    keys = Keys()
    robot, owner = join_network(keys)
    try:
        settings = room.settings()._replace(port=cuts.port)
        assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
        wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
        assert cuts.bytes_left[:2] == [0, 0] and cuts.bytes_left[2] < 1500
        teacher = room.connect()
        remote_session = remote(robot, keys)
        assert (
            upload_text(robot, [(AtBroker(robot, teacher), remote_session)], remote_session) == "OK"
        )
    finally:
        cuts.close()


@pytest.mark.parametrize(("name", "address", "is_found"), [
    (NAME, NOBODY, True), ("nobody.aula", LOCAL_ADDRESS, True), ("nobody.aula", NOBODY, False),
])  # fmt: skip
def test_a_broker_is_found_by_name_or_at_its_last_address(
    brokers: Callable[..., Mosquitto], name: str, address: bytes, is_found: bool
) -> None:
    robot, owner = join_network(Keys())
    announce_computer(robot, NAME, "127.0.0.1")
    settings = brokers().settings()._replace(name=name.encode(), address=address)
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
    if is_found:
        wait_until(robot, lambda: broker_settings_of(robot, owner)[1] == "READY")
    talk(robot, [(None, owner)], 500)
    assert broker_settings_of(robot, owner)[1] == ("READY" if is_found else "SEARCHING")


TRUST = bytes(range(1, 201))
PLAIN = wifi.BrokerSettings(LOCAL_ADDRESS, 8883, "aula", name=b"x")


def test_invalid_tls_settings_are_refused() -> None:
    robot, owner = join_network(Keys())
    for settings in (
        PLAIN._replace(name=b"", tls=wifi.Tls(TRUST, TODAY)),
        PLAIN._replace(tls=wifi.Tls(b"", TODAY)), PLAIN._replace(tls=wifi.Tls(TRUST, 0)),
        PLAIN._replace(tls=wifi.Tls(bytes(TRUST_BYTES + 1), TODAY)),
        PLAIN._replace(name=b"x" * (BROKER_NAME_BYTES + 1)), PLAIN._replace(name=b"a\0b"),
    ):  # fmt: skip
        assert not settings.is_sound
        assert (
            wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "BAD_VALUE"
        ), settings
        assert broker_settings_of(robot, owner) == ("OFF", "OFF", "")
    longest_settings = PLAIN._replace(
        name=b"x" * BROKER_NAME_BYTES, tls=wifi.Tls(bytes(TRUST_BYTES), TODAY)
    )
    assert longest_settings.is_sound
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(longest_settings)) == "OK"


def test_the_broker_survives_a_reset_and_a_failed_replacement(room: Room) -> None:
    robot, owner = connect_to_broker(room.broker, Keys(), room.settings())
    robot.fill_nvs()
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(PLAIN)) == "NOT_KEPT"
    talk(robot, [(None, owner)], 100)
    assert broker_settings_of(robot, owner) == ("STATION", "READY", "aula")
    restarted_robot = restart_with_school_in_reach(robot)
    teacher = room.connect()
    wait_until(
        restarted_robot,
        lambda: (
            list_present_robots(restarted_robot, teacher) == [RobotPresence(ID, "tini-5678", True)]
        ),
    )
