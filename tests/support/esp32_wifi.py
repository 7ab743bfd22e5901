"""An ESP32 robot that joins networks."""

from __future__ import annotations

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import Network, set_network_in_reach, talk
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, boot, claim_robot, wait_for_outcome
from tiniscript.link import wifi
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.payloads import WifiReply
from tiniscript.link.session import Session

SCHOOL = wifi.Network("Aula 3 ñ".encode(), b"correct horse battery staple, and forty more")
HOTSPOT = wifi.Network(b"Tini", b"12345678", True)
WIFI_KEY = b"wifi"


def make_owned_robot(keys: Keys, robot: Esp32Robot | None = None) -> tuple[Esp32Robot, Session]:
    """Return a robot with an owner, and the owner's session over the cable."""
    robot = robot or boot()
    owner = Session(7, 115200, robot.robot.kit.fingerprint, keys=keys)
    claim_robot(robot, [(None, owner)], owner)
    return robot, owner


def far_owner(keys: Keys) -> tuple[Esp32Robot, Network, Session]:
    """Return a robot in a network, and its owner's session over TCP."""
    robot, _ = join_network(keys)
    talk(robot, [], AUTHORITY_MS + 100)
    return robot, Network(robot), remote(robot, keys)


def school_in_reach(robot: Esp32Robot) -> None:
    set_network_in_reach(robot, SCHOOL.name.decode(), SCHOOL.password.decode())


def restart_with_school_in_reach(robot: Esp32Robot) -> Esp32Robot:
    """Return a robot that has started with what `robot` has kept, and has had time to join."""
    restarted_robot = Esp32Robot(kept_memory=robot.read_kept())
    school_in_reach(restarted_robot)
    restarted_robot.wait(400)
    return restarted_robot


def join_network(keys: Keys, network: wifi.Network = SCHOOL) -> tuple[Esp32Robot, Session]:
    """Return a robot with a network in reach, and its session."""
    robot, owner = make_owned_robot(keys)
    school_in_reach(robot)
    assert wait_for_outcome(robot, [(None, owner)], owner.join(network)) == "OK"
    talk(robot, [(None, owner)], 50)
    return robot, owner


def wifi_reply_of(robot: Esp32Robot, clients: Ends, client: Session) -> WifiReply:
    request = client.wifi()
    assert wait_for_outcome(robot, clients, request) == "OK"
    assert request.outcome
    return request.outcome.values


def state(robot: Esp32Robot, owner: Session) -> tuple[str, str]:
    wifi_reply = wifi_reply_of(robot, [(None, owner)], owner)
    return wifi.MODES[wifi_reply.mode], wifi.STATES[wifi_reply.state]


def remote(robot: Esp32Robot, keys: Keys | None, nonce: int = 9) -> Session:
    return Session(nonce, 115200, robot.robot.kit.fingerprint, keys=keys)


def remote_with_wrong_key(robot: Esp32Robot, keys: Keys, nonce: int) -> Session:
    wrong_keys = Keys()
    wrong_keys.stored_keys = [
        robot_key._replace(key=bytes([nonce + 99] * 16)) for robot_key in keys.stored_keys
    ]
    return remote(robot, wrong_keys, nonce)
