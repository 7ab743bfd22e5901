"""What an ESP32 knows after a reset that its chip does not tell: a sag, and who it is."""

from __future__ import annotations

from tests.machines.esp32 import EXTERNAL, POWER_ON, Esp32Robot, Kept
from tests.support.esp32_radio import session, talk
from tests.support.images import image_of
from tests.support.robot_on_esp32 import ended
from tiniscript.link.messages import RESETS
from tiniscript.link.payloads import HelloReply


def hello(robot: Esp32Robot, nonce: int = 1) -> HelloReply:
    who = session(nonce, robot)
    request = who.hello()
    assert ended(robot, [(None, who)], request) == "OK" and request.outcome
    return request.outcome.values


def cause(kept: Kept, reset: int = POWER_ON) -> str:
    return RESETS[hello(started(kept, reset)).reset][0]


def started(kept: Kept, reset: int = POWER_ON) -> Esp32Robot:
    robot = Esp32Robot(kept=kept, reset=reset)
    robot.wait(300)
    return robot


def running(text: str) -> Esp32Robot:
    robot = started(Kept(b"", {}, 0))
    who = session(2, robot)
    upload = who.upload(image_of(text), saves=False)
    assert ended(robot, [(None, who)], upload) == "OK"
    talk(robot, [(None, who)], 500)
    return robot


def test_a_deep_sag_while_a_program_runs_is_no_power_on() -> None:
    """The supply was gone for a moment: the bytes are still there that a reset leaves alone."""
    robot = running("SI|F(60, 80)")
    kept = robot.kept()
    assert cause(kept) == "BROWN_OUT"
    assert cause(kept._replace(noinit=b"")) == "POWER", "the bytes of a chip without power are lost"
    assert cause(kept, EXTERNAL) == "BUTTON"
    restarted = started(kept)
    assert cause(restarted.kept()) == "POWER", "it is told once"


def test_a_power_on_of_a_robot_that_stood_is_one() -> None:
    over = running("SI|F(0.1, 80)")
    assert cause(over.kept()) == "POWER"
    stopped = running("SI|F(60, 80)")
    stopped.wait(50, bytes(8))
    assert cause(stopped.kept()) == "POWER"


def test_two_chips_with_the_same_noise_are_two_robots() -> None:
    """Before a radio is on, `esp_random` need not be random."""
    found_ids = set()
    for last in range(8):
        for maker in (b"\x24\x0a\xc4", b"\xa0\xb7\x65"):
            robot = Esp32Robot(mac=maker + bytes((0, 0, last)))
            robot.wait(300)
            hello_reply = hello(robot)
            found_ids.add(hello_reply.id)
            assert hello_reply.nonce == hello_reply.id
            restarted = Esp32Robot(kept=robot.kept(), mac=bytes(6), seed=5)
            restarted.wait(300)
            assert hello(restarted).id == hello_reply.id, "it is made once"
    assert len(found_ids) == 16
    assert len({robot_id & 0xFFFF for robot_id in found_ids}) == 8, (
        "what names show is that of one maker"
    )
