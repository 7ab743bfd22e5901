"""The WiFi of an ESP32: who sets it, who drives over it, and other clients that connect."""

from __future__ import annotations

import socket
from typing import Any

import pytest

from tests.machines.esp32 import (
    BROWN_OUT,
    EXTERNAL,
    PANIC,
    POWER_ON,
    TASK_WATCHDOG,
    Esp32Robot,
    Kept,
)
from tests.support.esp32_radio import (
    LowEnergy,
    Network,
    RawClient,
    port_of,
    radios,
    session,
    set_network_in_reach,
    talk,
)
from tests.support.esp32_wifi import (
    HOTSPOT,
    SCHOOL,
    WIFI_KEY,
    far_owner,
    join_network,
    make_owned_robot,
    remote,
    restart_with_school_in_reach,
    school_in_reach,
    state,
    wifi_reply_of,
)
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import AWAY_PROGRAM, Ends, boot, upload_text, wait_for_outcome
from tests.support.robot_on_host import actions_of
from tiniscript.link import wifi
from tiniscript.link.authority import RobotKey
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import AUTHORITY_MS, BY_NAME, MAJOR, MINOR, WIFI_RESTS, encode_payload
from tiniscript.link.session import Session

# -- setting it ---------------------------------------------------------------------------------


@pytest.mark.parametrize("network", [SCHOOL, HOTSPOT])
def test_the_owner_gives_the_robot_a_network(network: wifi.Network) -> None:
    robot, owner = join_network(Keys(), network)
    wifi_reply = wifi_reply_of(robot, [(None, owner)], owner)
    assert (wifi_reply.network, wifi.STATES[wifi_reply.state]) == (network.name, "READY")
    assert wifi.address(wifi_reply) == ("192.168.4.1" if network.is_access_point else "127.0.0.1")
    radio_state = radios(robot)
    assert (
        radio_state.network.encode() == network.name
        and radio_state.password.encode() == network.password
    )
    assert radio_state.is_access_point == network.is_access_point
    assert (radio_state.host, radio_state.instance) == ("tini-5678", "tini-5678")
    assert radio_state.service == "_tiniscript._tcp 8473"


def test_lack_of_memory_delays_the_announcement() -> None:
    robot, _ = join_network(Keys())
    rebooted_robot = Esp32Robot(kept_memory=robot.read_kept())
    rebooted_robot.wait(100)
    rebooted_robot.radio("H", b"\1")
    school_in_reach(rebooted_robot)
    rebooted_robot.wait(400)
    assert port_of(rebooted_robot) and not radios(rebooted_robot).service
    rebooted_robot.radio("H", b"\0")
    rebooted_robot.wait(400)
    assert radios(rebooted_robot).service == "_tiniscript._tcp 8473"


def test_a_network_survives_a_reset_until_it_is_forgotten() -> None:
    robot, owner = join_network(Keys())
    rebooted_robot = restart_with_school_in_reach(robot)
    assert port_of(rebooted_robot)
    clients: Ends = [(None, owner)]
    assert wait_for_outcome(robot, clients, owner.forget_wifi()) == "OK"
    talk(robot, clients, 50)
    assert state(robot, owner) == ("OFF", "OFF")
    assert radios(robot).network == "" and radios(robot).service == ""
    third = Esp32Robot(kept_memory=robot.read_kept())
    third.wait(400)
    assert radios(third).joins == 0


def overhear(
    robot: Esp32Robot, end: LowEnergy | None, client: Session, request: PendingRequest[Any]
) -> tuple[bytes, bytes]:
    """Let a client talk until a request is over; return all bytes in both directions."""
    sent_bytes = replies = b""
    while request.outcome is None:
        data = client.poll(robot.now_ms)
        sent_bytes += data
        if end is None:
            reply = robot.step(data)
        else:
            end.send(data)
            robot.step()
            reply = end.take()
        replies += reply
        client.receive(reply, robot.now_ms)
    return sent_bytes, replies


def test_the_password_is_not_readable_on_the_line() -> None:
    """The password is not shown: anyone who listens to Bluetooth LE receives all bytes. The replies
    have the name."""
    keys = Keys()
    robot, _ = make_owned_robot(keys)
    talk(robot, [], 2500)
    remote_session = remote(robot, keys)
    request = remote_session.join(SCHOOL)
    sent_bytes, replies = overhear(robot, LowEnergy(robot), remote_session, request)
    assert request.outcome and request.outcome.status == 0
    assert radios(robot).password.encode() == SCHOOL.password
    for text, heard_bytes in ((SCHOOL.name, sent_bytes), (SCHOOL.password, sent_bytes + replies)):
        assert all(text[k : k + 4] not in heard_bytes for k in range(len(text) - 3))


def test_a_robot_without_an_owner_accepts_no_network() -> None:
    robot = boot()
    client = session(1, robot)
    for request in (client.join(SCHOOL), client.forget_wifi(), client.wifi()):
        sent_bytes, _ = overhear(robot, None, client, request)
        assert request.outcome and request.outcome.status != 0
        assert SCHOOL.password[:8] not in sent_bytes
    assert radios(robot).joins == 0
    assert wait_for_outcome(robot, [(None, client)], client.ping()) == "OK"


def test_a_stranger_cannot_remove_the_network() -> None:
    robot, _ = join_network(Keys())
    stranger = remote(robot, Keys(50))
    clients: Ends = [(LowEnergy(robot), stranger)]
    for request in (stranger.join(HOTSPOT), stranger.forget_wifi(), stranger.wifi()):
        assert wait_for_outcome(robot, clients, request) == "NOT_OWNER"
    assert radios(robot).network.encode() == SCHOOL.name


def test_invalid_network_settings_are_refused() -> None:
    robot, owner = make_owned_robot(Keys())
    for name, password in (
        (b"x", b"short"), (b"x", b""), (b"a\0b", b"12345678"), (b"x", b"1234\0" + b"5678"),
    ):  # fmt: skip
        request = owner.join(wifi.Network(name, password))
        assert wait_for_outcome(robot, [(None, owner)], request) == "BAD_VALUE", (name, password)
        assert state(robot, owner) == ("OFF", "OFF")


def test_a_network_is_stored_atomically_while_the_motors_are_off() -> None:
    robot, owner = make_owned_robot(Keys())
    clients: Ends = [(None, owner)]
    assert upload_text(robot, clients, owner, "SI|F(1.5, 40)") == "OK"
    request = owner.join(SCHOOL)
    talk(robot, clients, 800)
    assert request.outcome is None and WIFI_KEY not in robot.read_kept().entries
    assert wait_for_outcome(robot, clients, request) == "OK"
    assert WIFI_KEY in robot.read_kept().entries
    entries_before = robot.read_kept().entries[WIFI_KEY]
    robot.fill_nvs()
    assert wait_for_outcome(robot, clients, owner.join(HOTSPOT)) == "NOT_KEPT"
    assert robot.read_kept().entries[WIFI_KEY] == entries_before
    assert wifi_reply_of(robot, clients, owner).network == SCHOOL.name
    kept_memory = robot.read_kept()
    for entry in (b"", b"\1" * 5, b"\xff" * 98, b"\1" + b"x" * 97):
        rebooted_robot = Esp32Robot(
            kept_memory=Kept(kept_memory.noinit, {**kept_memory.entries, WIFI_KEY: entry}, 0)
        )
        rebooted_robot.wait(400)
        assert radios(rebooted_robot).joins == 0, entry


def test_a_wrong_password_and_an_unreachable_network_are_reported() -> None:
    """The core says "disconnected" of a wrong password; its event has the reason."""
    robot, owner = join_network(Keys())
    clients: Ends = [(None, owner)]
    for reason, expected in (
        (8, "SEARCHING"), (15, "REFUSED"), (202, "REFUSED"), (203, "REFUSED"), (204, "REFUSED"),
    ):  # fmt: skip
        robot.radio("x", bytes([reason]))  # 8: it was only left
        set_network_in_reach(robot, SCHOOL.name.decode(), "another one")
        talk(robot, clients, 20)
        assert state(robot, owner) == ("STATION", expected), reason
        set_network_in_reach(robot, "", "")
        talk(robot, clients, 20)
        assert state(robot, owner) == ("STATION", "SEARCHING")
    joins = radios(robot).joins
    talk(robot, clients, 16_000)
    assert radios(robot).joins == joins + 1
    school_in_reach(robot)
    talk(robot, clients, 20)
    assert state(robot, owner) == ("STATION", "READY")


def test_a_revoked_key_ends_its_other_sessions() -> None:
    keys = Keys()
    robot, owner = make_owned_robot(keys)
    remote_session = remote(robot, keys)
    clients: Ends = [(None, owner), (LowEnergy(robot), remote_session)]
    assert wait_for_outcome(robot, clients, remote_session.wifi()) == "OK"
    assert wait_for_outcome(robot, clients, owner.disown(0)) == "OK"
    keys.stored_keys.append(RobotKey(0x12345678, 0, bytes([1] * 16)))  # a key from another computer
    assert wait_for_outcome(robot, clients, remote_session.name(b"mine")) == "WRONG_KEY"


def test_no_two_transports_have_the_same_challenge() -> None:
    """A recorded answer would be valid on another transport."""
    robot, _ = make_owned_robot(Keys())
    rebooted_robot = Esp32Robot(kept_memory=robot.read_kept())  # no challenge before
    rebooted_robot.wait(300)
    hello = encode_payload(BY_NAME["HELLO"].request, {
        "major": MAJOR, "minor": MINOR, "isa_major": 2, "isa_minor": 0, "kit": 0, "nonce": 5,
    })  # fmt: skip
    request_bytes = b"\0" + encode_frame(Frame(1, 1, 0, hello))
    first, second = RawClient(request_bytes), RawClient(request_bytes)
    clients: Ends = [(None, first), (LowEnergy(rebooted_robot), second)]
    talk(rebooted_robot, clients, 60)
    frames = [decode_frame(client.received.strip(b"\0")) for client in (first, second)]
    [epoch] = {frame.epoch for frame in frames if frame}
    first.to_send = second.to_send = encode_frame(Frame(17, 2, epoch, b"\0"))
    first.received = second.received = b""
    talk(rebooted_robot, clients, 60)
    assert len(first.received) == 20 and first.received != second.received


# -- over TCP -----------------------------------------------------------------------------------


def test_over_wifi_the_owner_drives_and_a_stranger_watches_and_stops() -> None:
    robot, end, owner = far_owner(Keys())
    stranger = remote(robot, Keys(50), 11)
    clients: Ends = [(end, owner), (Network(robot), stranger)]
    assert upload_text(robot, clients, owner) == "OK"
    for request in (stranger.hello(), stranger.ping(), stranger.status(), stranger.identify()):
        assert wait_for_outcome(robot, clients, request) == "OK"
    for acting in (stranger.start(), stranger.fetch(), stranger.live(image_of("F(1, 9)").code)):
        assert wait_for_outcome(robot, clients, acting) == "NOT_OWNER"
    talk(robot, clients, 1500)
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    stranger.stop(robot.now_ms)
    talk(robot, clients, 50)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


def test_a_robot_without_its_former_owner_does_not_move_over_wifi() -> None:
    keys = Keys()
    robot, owner = join_network(keys)
    assert wait_for_outcome(robot, [(None, owner)], owner.disown(0)) == "OK"
    talk(robot, [], AUTHORITY_MS + 100)
    count_before = len(robot.did)
    client, typed_bytes = remote(robot, None), RawClient(b"SI|F(1, 80)\n")
    clients: Ends = [(Network(robot), client), (Network(robot), typed_bytes)]
    for request in (client.hello(), client.ping(), client.status(), client.identify()):
        assert wait_for_outcome(robot, clients, request) == "OK"
    for acting in (
        client.live(image_of("F(1, 9)").code), client.upload(image_of(AWAY_PROGRAM)),
        client.fetch(),
        client.name(b"x"), client.undo(), client.clear(),
    ):  # fmt: skip
        assert wait_for_outcome(robot, clients, acting) == "UNOWNED"
    assert "Not possible here" in typed_bytes.received.decode()
    assert not [line for line in robot.did[count_before:] if "MOTORS" in line]
    cable = session(3, robot)
    assert upload_text(robot, [(None, cable)], cable) == "OK"
    typed_bytes.to_send = b"S\n"
    talk(robot, [(None, cable), *clients], 100)
    assert [line for line in actions_of(robot) if "MOTORS" in line][-2:] == [
        "MOTORS 80 80", "MOTORS 0 0"]  # fmt: skip


def test_a_lost_network_ends_the_run_and_the_cable_keeps_working() -> None:
    keys = Keys()
    robot, end, owner = far_owner(keys)
    cable = session(12, robot)
    clients: Ends = [(end, owner), (None, cable)]
    assert upload_text(robot, clients, owner) == "OK"
    set_network_in_reach(robot, "", "")
    talk(robot, clients, 10)
    assert actions_of(robot)[-1] == "MOTORS 0 0"
    assert end.has_ended
    assert wait_for_outcome(robot, clients[1:], cable.ping()) == "OK"
    school_in_reach(robot)
    talk(robot, [], 20)
    next_client, end = remote(robot, keys, 13), Network(robot)
    assert upload_text(robot, [(end, next_client)], next_client) == "OK"
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    end.leave()
    robot.wait(5)
    assert actions_of(robot)[-1] == "MOTORS 0 0", "a client that leaves ends its run at once"


def test_strangers_who_trickle_bytes_block_no_stop() -> None:
    """Two have both places, and say a letter of a line now and then; an owner's keeps his."""
    robot, end, owner = far_owner(Keys())
    clients: Ends = [(end, owner)]
    assert upload_text(robot, clients, owner) == "OK"
    for _ in range(3):  # the place of one makes room for the next
        stranger = Network(robot)
        for _ in range(20):
            stranger.send(b"X")
            talk(robot, clients, 50)
        assert not end.has_ended and not stranger.has_ended
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    stopper = Network(robot)
    stopper.send(bytes(4))
    talk(robot, clients, 10)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


def test_two_strangers_give_way_to_a_later_client() -> None:
    robot, owner = join_network(Keys())
    waiting, looking = Network(robot), remote(robot, None)
    looking_ends: Ends = [(Network(robot), looking)]
    assert wait_for_outcome(robot, looking_ends, looking.ping()) == "OK"
    third = remote(robot, None, 14)
    comes: Ends = [(Network(robot), third), *looking_ends]
    assert wait_for_outcome(robot, comes, third.ping()) == "OK"
    waiting.take()
    assert waiting.has_ended, "who has said nothing goes first"
    fourth = remote(robot, None, 15)
    end = Network(robot)
    assert wait_for_outcome(robot, [(end, fourth)], fourth.ping()) == "OK"
    assert wait_for_outcome(robot, [(None, owner)], owner.ping()) == "OK"


def test_a_client_whose_first_bytes_stay_unclear_is_disconnected() -> None:
    robot, _ = join_network(Keys())
    slow_end = Network(robot)
    for _ in range(99):
        slow_end.send(b"X")
        robot.wait(100)
    slow_end.take()
    assert not slow_end.has_ended
    slow_end.send(b"X")
    robot.wait(200)
    slow_end.take()
    assert slow_end.has_ended, "ten seconds after it came, whatever it says"


def test_a_client_that_reads_nothing_blocks_nobody() -> None:
    robot, owner = join_network(Keys())
    deaf = Network(robot)
    deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
    clients: Ends = [(None, owner)]
    assert upload_text(robot, clients, owner) == "OK"
    for _ in range(300):
        deaf.send(b"\0\2\3\3\0")  # damaged, and then a stop of two zeros less
        deaf.send(b"PING|check_connection\n" * 3)
        talk(robot, clients, 5)
    assert actions_of(robot)[-1] == "MOTORS 80 80"


# -- a chip that restarts whenever WiFi begins --------------------------------------------------


def restart(robot: Esp32Robot, reset: int, lived_ms: int) -> Esp32Robot:
    """Return the robot after a reset that comes so long after the one before."""
    robot.wait(lived_ms)
    kept_memory = robot.read_kept()
    robot.close()
    rebooted_robot = Esp32Robot(kept_memory=kept_memory, reset=reset)
    school_in_reach(rebooted_robot)
    rebooted_robot.wait(400)
    return rebooted_robot


def is_wifi_off(robot: Esp32Robot) -> bool:
    """Return whether its WiFi is off, as HELLO says as well."""
    client = session(40, robot)
    clients: Ends = [(None, client)]
    assert wait_for_outcome(robot, clients, client.hello()) == "OK"
    assert client.robot
    says_so = bool(client.robot.values.features & WIFI_RESTS)
    assert says_so == (radios(robot).joins == 0)
    return says_so


@pytest.mark.sampled("reset")
@pytest.mark.parametrize("reset", [PANIC, TASK_WATCHDOG, BROWN_OUT])
def test_after_three_restarts_wifi_is_off_until_the_cable_enables_it(reset: int) -> None:
    keys = Keys()
    robot, _ = join_network(keys)
    for is_third in (False, False, True):
        robot = restart(robot, reset, 1000)
        assert is_wifi_off(robot) == is_third
    owner = remote(robot, keys, 41)
    assert state(robot, owner) == ("STATION", "RESTS")
    assert wifi_reply_of(robot, [(None, owner)], owner).network == SCHOOL.name
    robot = restart(robot, POWER_ON, 1000)
    assert is_wifi_off(robot), "until somebody sets it again"
    owner = remote(robot, keys, 42)
    assert wait_for_outcome(robot, [(None, owner)], owner.join(SCHOOL)) == "OK"
    talk(robot, [(None, owner)], 50)
    assert state(robot, owner) == ("STATION", "READY") and not is_wifi_off(robot)
    for _ in range(2):
        robot = restart(robot, reset, 1000)
        assert not is_wifi_off(robot), "it counts anew"


ROW = (PANIC, 1000)  # a reset, and how long after the one before


@pytest.mark.sampled("row")
@pytest.mark.parametrize("row", [
    [(POWER_ON, 1000)] * 4 + [ROW, (POWER_ON, 1000), ROW, (POWER_ON, 1000)],
    [(EXTERNAL, 1000)] * 4 + [ROW, (EXTERNAL, 1000), ROW, (EXTERNAL, 1000)],
    [ROW, ROW, (PANIC, 20_000), ROW, ROW, (PANIC, 20_000)],
], ids=["power-on", "external", "20 seconds"])  # fmt: skip
def test_an_invalid_restart_counter_is_ignored(row: list[tuple[int, int]]) -> None:
    robot, _ = join_network(Keys())
    for reset, lived_ms in row:
        robot = restart(robot, reset, lived_ms)
        assert not is_wifi_off(robot)
    if row[-1][0] != PANIC:  # these are not counted, and do not end a row
        assert is_wifi_off(restart(robot, PANIC, 1000))


def test_wifi_is_off_if_nvs_is_full_and_restarts_without_wifi_do_not_count() -> None:
    keys = Keys()
    robot, owner = join_network(keys)
    for _ in range(2):
        robot = restart(robot, PANIC, 1000)
    kept_memory = robot.read_kept()
    full = Esp32Robot(kept_memory=kept_memory, reset=PANIC)
    full.fill_nvs()
    full.wait(400)
    assert is_wifi_off(full)
    owner = remote(robot, keys, 43)
    assert wait_for_outcome(robot, [(None, owner)], owner.forget_wifi()) == "OK"
    for _ in range(4):
        robot = restart(robot, PANIC, 1000)
        assert state(robot, remote(robot, keys, 44)) == ("OFF", "OFF")
