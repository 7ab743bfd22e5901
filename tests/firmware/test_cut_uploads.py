"""The largest upload is cut, or the robot stopped, at any of its bytes: it holds the old program or
the new one, nothing drives that was stopped, and the next upload is whole.

`python -m tests.firmware.test_cut_uploads` does that at each byte.
"""

from __future__ import annotations

from argparse import ArgumentParser

import pytest

from tests.firmware.test_host_firmware import KIT, computer, happened, held, holding
from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.link.messages import SAVED, SAVED_NOTHING
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

OLD = "SB|F(0.1, 50)"
ROOM = 389
STRIDE = 29  # of the bytes in the tests
STOP = bytes(8)
SAVED_MEMORY = [name for name, _ in SAVED].index("MEMORY")
CUT, STOPPED, STOPPED_TWICE = KINDS = ("cut", "stopped", "stopped twice")


def largest() -> Image:
    """An image that fills the robot, and drives at once."""
    begin = image_of("SI|F(9, 80)").code
    show = image_of("SI|SHOW(1)").code
    code = begin + show * ((ROOM - len(begin)) // len(show))
    return unpack(pack("SI", 0, code))


NEW = largest()


def bytes_of(image: Image) -> bytes:
    return pack(image.start, image.devices, image.code)


def sent_until(robot: HostFirmware, session: Session, count: int) -> bytes:
    """Let an upload begin, until so many of its bytes have reached the robot; return what the
    computer has sent after them. Nothing: the upload is over."""
    request = session.upload(NEW, saves=True)
    while request.outcome is None:
        data = session.poll(robot.now_ms)
        if count < len(data):
            session.receive(robot.step(data[:count]), robot.now_ms)
            return data[count:]
        count -= len(data)
        session.receive(robot.step(data), robot.now_ms)
    return b""


def is_over_at(memory: bytes, kind: str, count: int) -> bool:
    """Break an upload off after so many bytes; return whether it was over before."""
    robot, session = HostFirmware(KIT, memory), computer()
    robot.wait(200)
    assert robot.until(session, session.hello()) == OK
    late = sent_until(robot, session, count)
    if not late:
        return True
    if kind != CUT:
        robot.step(STOP)
        robot.did.clear()
        robot.step(late)  # what was under way
        if kind == STOPPED_TWICE:
            robot.step(STOP)
        robot.wait(300)
        assert not [line for line in happened(robot) if line not in ("MOTORS 0 0",)], count
        assert robot.is_latched
    robot.wait(1100)
    again = computer(2)
    assert robot.until(again, again.hello()) == OK
    assert held(robot, again) in (bytes_of(image_of(OLD)), bytes_of(NEW)), count
    if kind == CUT:
        robot.did.clear()
        robot.push()
        robot.talk(again, 300)
        assert "MOTORS 50 50" in happened(robot) or "MOTORS 80 80" in happened(robot), count
    assert robot.until(again, again.upload(NEW, runs=False)) == OK
    assert held(robot, again) == bytes_of(NEW), count
    return False


def break_off(kind: str, first: int, stride: int) -> int:
    """Break uploads off at each so many bytes; return how many."""
    memory = holding(OLD)[0].memory()
    count = 0
    while not is_over_at(memory, kind, first + count * stride):
        count += 1
    return count


@pytest.mark.parametrize("kind", KINDS)
def test_an_upload_that_is_broken_off(kind: str) -> None:
    assert break_off(kind, 3, STRIDE) > 450 // STRIDE


def test_a_program_that_an_upload_has_cost_is_told_no_more() -> None:
    """The robot still says its checksum and its length."""
    robot, session = HostFirmware(KIT), computer()
    robot.wait(200)
    assert robot.until(session, session.upload(image_of(OLD), saves=False)) == OK
    before = robot.done(session, session.status())
    assert (before.program, before.saved) == (image_of(OLD).checksum, SAVED_MEMORY)
    assert before.length == len(image_of(OLD).code)
    assert sent_until(robot, session, 300)
    again = computer(2)
    hello, status_reply = robot.done(again, again.hello()), robot.done(again, again.status())
    assert (status_reply.saved, status_reply.program, status_reply.length) == (SAVED_NOTHING, 0, 0)
    assert (hello.saved, hello.program, hello.length) == (SAVED_NOTHING, 0, 0)
    assert again.robot and again.robot.values.program == 0


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    for each in KINDS:
        break_off(each, 0, 1)
