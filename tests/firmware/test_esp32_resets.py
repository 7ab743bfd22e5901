"""Facts that an ESP32 finds out after a reset without its chip's help: a sag, and its identity."""

from __future__ import annotations

from tests.machines.esp32 import EXTERNAL, POWER_ON, Esp32Robot, Kept
from tests.support.esp32_radio import session, talk
from tests.support.images import image_of
from tests.support.robot_on_esp32 import wait_for_outcome
from tiniscript.link.messages import RESETS
from tiniscript.link.payloads import HelloReply


def hello(robot: Esp32Robot, nonce: int = 1) -> HelloReply:
    client = session(nonce, robot)
    request = client.hello()
    assert wait_for_outcome(robot, [(None, client)], request) == "OK" and request.outcome
    return request.outcome.values


def cause(kept_memory: Kept, reset: int = POWER_ON) -> str:
    return RESETS[hello(boot(kept_memory, reset)).reset][0]


def boot(kept_memory: Kept, reset: int = POWER_ON) -> Esp32Robot:
    robot = Esp32Robot(kept_memory=kept_memory, reset=reset)
    robot.wait(300)
    return robot


def running(text: str) -> Esp32Robot:
    robot = boot(Kept(b"", {}, 0))
    client = session(2, robot)
    upload = client.upload(image_of(text), saves=False)
    assert wait_for_outcome(robot, [(None, client)], upload) == "OK"
    talk(robot, [(None, client)], 500)
    return robot


def test_a_deep_sag_while_a_program_runs_is_not_a_power_on() -> None:
    """The supply was gone for a moment: the bytes are still there that a reset leaves alone."""
    robot = running("SI|F(60, 80)")
    kept_memory = robot.read_kept()
    assert cause(kept_memory) == "BROWN_OUT"
    assert cause(kept_memory._replace(noinit=b"")) == "POWER", (
        "the bytes of a chip without power are lost"
    )
    assert cause(kept_memory, EXTERNAL) == "BUTTON"
    restarted_robot = boot(kept_memory)
    assert cause(restarted_robot.read_kept()) == "POWER", "it is told once"


def test_a_power_on_of_an_idle_robot_counts_as_one() -> None:
    running_robot = running("SI|F(0.1, 80)")
    assert cause(running_robot.read_kept()) == "POWER"
    stopped_robot = running("SI|F(60, 80)")
    stopped_robot.wait(50, bytes(8))
    assert cause(stopped_robot.read_kept()) == "POWER"


def test_two_chips_with_the_same_noise_get_different_ids() -> None:
    """Before a radio is on, `esp_random` need not be random."""
    found_ids = set()
    for last_byte in range(8):
        for maker in (b"\x24\x0a\xc4", b"\xa0\xb7\x65"):
            robot = Esp32Robot(mac=maker + bytes((0, 0, last_byte)))
            robot.wait(300)
            hello_reply = hello(robot)
            found_ids.add(hello_reply.id)
            assert hello_reply.nonce == hello_reply.id
            restarted_robot = Esp32Robot(kept_memory=robot.read_kept(), mac=bytes(6), seed=5)
            restarted_robot.wait(300)
            assert hello(restarted_robot).id == hello_reply.id, "it is made once"
    assert len(found_ids) == 16
    assert len({robot_id & 0xFFFF for robot_id in found_ids}) == 8, (
        "what names show is that of one maker"
    )
