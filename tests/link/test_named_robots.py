"""`tcp://name`: robots that announce themselves, over real sockets of this computer."""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from ipaddress import ip_address
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

from tests.support.command import LONG_PROGRAM, Command, Tsc, run_in_process, run_subprocess
from tests.support.network import BadNetwork
from tests.support.virtual_command import FOREVER, Robot, robot
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.base import files
from tiniscript.link import known_ports, ports

if TYPE_CHECKING:  # without zeroconf there are no names
    from zeroconf import ServiceInfo, Zeroconf

    from tiniscript.link.transports.network import AnnouncedRobot


@pytest.fixture
def network() -> ModuleType:
    from tiniscript.link.transports import network

    return network


# Every announcement is heard by all tests of this computer: names are unique to a test process, and
# tests that list the announcements, or fill the list, run one at a time.
PROCESS_ID = os.getpid()
FAR_HOST = f"far-{PROCESS_ID}.local."
LATE_S = 0.04  # each way
LOSS_PROBABILITY = 0.05  # of the pieces


@pytest.fixture
def listing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """No other test lists or announces names meanwhile."""
    shared_file = tmp_path_factory.getbasetemp().parent / "listing"  # by the workers of a run
    end_s = time.monotonic() + HANG_LIMIT_S
    with ExitStack() as stack:
        while True:
            with suppress(TimeoutError):
                stack.enter_context(files.lock_file(shared_file))
                break
            assert time.monotonic() < end_s, "another test does not end"
        yield


@contextmanager
def announce(name: str, address: str, number: int) -> Iterator[None]:
    """Something that says it is a robot."""
    from zeroconf import ServiceInfo, Zeroconf

    from tiniscript.link.transports.network import SERVICE

    with closing(Zeroconf(interfaces=["127.0.0.1"])) as network:
        network.register_service(ServiceInfo(
            SERVICE, f"{name}.{SERVICE}", number, addresses=[ip_address(address).packed],
            server=f"stranger-{PROCESS_ID}.local.",
        ))  # fmt: skip
        yield


@contextmanager
def packets(*names: str, number: int, lonely: int = 0) -> Iterator[None]:
    """Yield multicast packets that announce names one after the other, and so many names without an
    address.
    """
    from zeroconf._dns import DNSAddress, DNSPointer, DNSService, DNSText
    from zeroconf._protocol.outgoing import DNSOutgoing
    from zeroconf.const import (
        _CLASS_IN,
        _FLAGS_QR_RESPONSE,
        _TYPE_A,
        _TYPE_PTR,
        _TYPE_SRV,
        _TYPE_TXT,
    )

    from tiniscript.link.transports.network import SERVICE

    packet = DNSOutgoing(_FLAGS_QR_RESPONSE)
    for service_name in (f"{name}.{SERVICE}" for name in names):
        packet.add_answer_at_time(DNSPointer(SERVICE, _TYPE_PTR, _CLASS_IN, 120, service_name), 0)
        service = DNSService(service_name, _TYPE_SRV, _CLASS_IN, 120, 0, 0, number, FAR_HOST)
        packet.add_answer_at_time(service, 0)
        packet.add_answer_at_time(DNSText(service_name, _TYPE_TXT, _CLASS_IN, 120, b"\0"), 0)
    address = DNSAddress(FAR_HOST, _TYPE_A, _CLASS_IN, 120, bytes((127, 0, 0, 1)))
    packet.add_answer_at_time(address, 0)
    for k in range(lonely):
        pointer = DNSPointer(SERVICE, _TYPE_PTR, _CLASS_IN, 120, f"a{k}.{SERVICE}")
        packet.add_answer_at_time(pointer, 0)
    is_over = threading.Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as multicast_socket:
            multicast_socket.setsockopt(
                socket.IPPROTO_IP, socket.IP_MULTICAST_IF, bytes((127, 0, 0, 1))
            )
            multicast_socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            multicast_socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            multicast_socket.bind(("127.0.0.1", 5353))  # names from elsewhere are ignored
            while not is_over.wait(0.1):
                for data in packet.packets():
                    multicast_socket.sendto(data, ("224.0.0.251", 5353))

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    try:
        yield
    finally:
        is_over.set()
        sender.join()


def robots_of_this_test(robots: list[AnnouncedRobot], number: int) -> list[AnnouncedRobot]:
    """Those at a TCP port of this computer: a robot of the room may announce itself, too."""
    return [robot for robot in robots if robot.port == f"socket://127.0.0.1:{number}"]


def number_of(port: str) -> int:
    return int(port.rpartition(":")[2])


@pytest.fixture(scope="module")
def tini() -> Iterator[Robot]:
    """A robot that has announced itself: that takes 4 s."""
    with robot("--announce", "--name", f"Ñ tini {PROCESS_ID}") as running_robot:
        assert running_robot.line() == f"tcp://Ñ tini {PROCESS_ID}"
        yield running_robot


def test_a_robot_is_reached_by_its_name(tini: Robot) -> None:
    for run, address in ((run_subprocess, "tcp://Ñ tini {}"),
                         (run_in_process, "tcp://ñ tini {}.local"),
                         (run_in_process, "TCP://ñ TINI {}")):  # fmt: skip
        port = address.format(PROCESS_ID)
        result = run("upload", "-e", "SI|F(0.2, 50)", "--port", port)
        assert (result.code, result.err) == (0, ""), port
        assert known_ports.remembered_ports().last_port == port
    assert run_in_process("doctor", "--identify").code == 0  # it is remembered


def test_a_name_and_an_address_share_a_connection(tini: Robot) -> None:
    command = Command("upload", "-e", FOREVER, "--port", f"tcp://Ñ tini {PROCESS_ID}")
    command.until("running")
    assert run_in_process("stop", "--port", tini.port).code == 0
    assert command.wait_for_result().code == 3


def test_a_robot_announces_itself_only_when_asked(
    listing: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ports, "list_ports", list)
    with robot("--name", "quiet") as running_robot, robot("--announce") as other_robot:
        name = other_robot.line()
        assert name == f"tcp://tinibot-{number_of(other_robot.port)}"
        rows = run_in_process("doctor", "--ports", "--ask").out.splitlines()
        assert any(row.startswith(f"{name} ") for row in rows)
        assert [row.split("   ")[0] for row in rows if "quiet" in row] == [running_robot.port]


def test_the_announcement_ends_with_the_robot(
    network: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = f"short-{PROCESS_ID}"
    with robot("--announce", "--name", name):
        assert run_in_process("doctor", "--identify", "--port", f"tcp://{name}").code == 0
    monkeypatch.setattr(network, "SEARCH_S", 1.0)
    result = run_in_process("doctor", "--identify", "--port", f"tcp://{name}", "--lang", "es")
    assert result.code == 3
    assert f"ningún robot de esta red se anuncia como tcp://{name}" in result.err


def test_unused_names_are_reported(
    tsc: Tsc, network: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(network, "SEARCH_S", 0.2)
    for name in ("x" * 64, "Ñ" * 40, "_tcp", ".", "..", "a.b", "a..b", " "):
        result = tsc("doctor", "--identify", "--port", f"tcp://{name}")
        assert (result.code, "announces itself" in result.err) == (3, True), name


def test_two_robots_of_one_name_are_not_announced(tini: Robot) -> None:
    name = f"Ñ tini {PROCESS_ID}"
    result = run_in_process("robot", "--announce", "--name", name, "--for", "0.1")
    assert (result.code, f"the name {name} cannot be announced" in result.err) == (3, True)


@pytest.mark.parametrize("address", ["8.8.8.8", "0.0.0.0"])
def test_an_address_outside_the_network_is_not_contacted(address: str) -> None:
    with announce(f"bait-{PROCESS_ID}", address, 7007):
        result = run_in_process("doctor", "--identify", "--port", f"tcp://bait-{PROCESS_ID}")
        message = f"an address outside this network ({address})"
        assert (result.code, message in result.err) == (3, True)


def test_any_announcement_packet_is_handled(
    listing: None, network: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Written by hand: zeroconf refuses to announce some of these, and to believe others."""
    monkeypatch.setattr(network, "LIST_S", 0.5)
    announced_names = ["_tcp", "a.b", "plain", "x" * 63, "\u202ex"]
    robots: list[AnnouncedRobot] = []

    def all_are_heard() -> bool:
        robots[:] = robots_of_this_test(network.list_robots(), 7007)
        return len(robots) >= len(announced_names)

    with packets("\x1b[31mx", "a\r\nb", *announced_names, number=7007):
        until(all_are_heard, "all are heard")
    assert robots == [(name, "socket://127.0.0.1:7007") for name in announced_names]


def test_names_without_an_address_do_not_delay_the_list(
    listing: None, network: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    query, limits_ms = network.query_service, []

    def look(zeroconf: Zeroconf, name: str, timeout_ms: int) -> ServiceInfo | None:
        limits_ms.append(timeout_ms)
        service_info: ServiceInfo | None = query(zeroconf, name, timeout_ms)
        return service_info

    monkeypatch.setattr(network, "ADDRESSES_S", 0.5)
    monkeypatch.setattr(network, "query_service", look)
    with packets("robot", number=7007, lonely=40):
        names = [robot.name for robot in robots_of_this_test(network.list_robots(), 7007)]
    assert names == ["robot"]
    assert limits_ms[0] <= 500 and limits_ms.count(1) > 30  # the first one has all the time


def test_a_hostile_name_is_shown_without_control_characters(
    listing: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ports, "list_ports", list)
    with (
        robot("--listen", "0") as running_robot,
        announce("\u202ex", "127.0.0.1", number_of(running_robot.port)),
    ):
        result = run_in_process("doctor", "--ports", "--ask").gives(0, out=running_robot.port)
        assert "\u202e" not in result.out


def test_whatever_answers_a_name_has_to_be_a_robot() -> None:
    with socket.create_server(("127.0.0.1", 0)) as web:
        number = web.getsockname()[1]

        def serve() -> None:
            peer, _ = web.accept()
            peer.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
            peer.close()

        threading.Thread(target=serve, daemon=True).start()
        with announce(f"web-{PROCESS_ID}", "127.0.0.1", number):
            assert (
                run_in_process("doctor", "--identify", "--port", f"tcp://web-{PROCESS_ID}").code
                == 3
            )


def test_without_multicast_the_address_is_the_next_step(
    tsc: Tsc, network: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(**_: object) -> None:
        raise OSError(101, "Network is unreachable")

    monkeypatch.setattr(network, "Zeroconf", fail)
    for language, expected in (("en", "is not on a network with multicast"),
                           ("es", "no llega a ninguna red con multicast")):  # fmt: skip
        tsc("doctor", "--identify", "--port", "tcp://tini", "--lang", language).gives(
            3, expected, "socket://HOST"
        )


def test_a_bad_network_costs_time_and_nothing_else() -> None:
    """40 ms each way, and one piece in twenty is lost: frames are sent again."""
    port = f"tcp://far-{PROCESS_ID}"
    with (
        robot() as running_robot,
        closing(
            BadNetwork(
                number_of(running_robot.port),
                LATE_S,
                resend_interval=2000,
                loss_rate=LOSS_PROBABILITY,
            )
        ) as network,
        announce(f"far-{PROCESS_ID}", "127.0.0.1", network.port),
    ):
        result = run_in_process("upload", "-e", f"SB|{LONG_PROGRAM}", "--port", port).gives(0, "")
        checksum = result.out.partition("checksum ")[2][:8]
        assert f"program {checksum}" in run_in_process("doctor", "--port", port).out
        command = Command("upload", "-e", FOREVER, "--port", port)
        command.until("running")
        assert run_in_process("stop", "--port", port).code == 0
        command.wait_for_result()
