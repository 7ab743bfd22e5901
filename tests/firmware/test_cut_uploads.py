"""The largest upload is cut, or the robot stopped, at any of its bytes: it holds the old program or
the new one, a stopped robot does not drive, and the next upload is whole.

`python -m tests.firmware.test_cut_uploads` does that at each byte.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import (
    KIT,
    actions_of,
    computer,
    fetch_image,
    robot_with_saved_program,
    send,
    wait_until_saved,
)
from tests.support.small_robot import SmallRobot
from tiniscript.bytecode.image import Image, pack, unpack
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR, RUN, SAVED_NOTHING, SAVED_STATES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

OLD_PROGRAM = "SB|F(0.1, 50)"
ROOM_BYTES = 389
CHECKSUM_OFFSET = 10  # offset of the checksum in an image
STRIDE_BYTES = 29  # step between the bytes that the tests choose
STOP = bytes(8)
SAVED_MEMORY = [name for name, _ in SAVED_STATES].index("MEMORY")
CUT_KIND, STOPPED_KIND, STOPPED_TWICE_KIND = KINDS = ("cut", "stopped", "stopped twice")


def largest() -> Image:
    """An image that fills the robot, and drives at once."""
    begin_code = image_of("SI|F(9, 80)").code
    show = image_of("SI|SHOW(1)").code
    code = begin_code + show * ((ROOM_BYTES - len(begin_code)) // len(show))
    return unpack(pack("SI", 0, code))


NEW_IMAGE = largest()


def bytes_of(image: Image) -> bytes:
    return pack(image.start, image.devices, image.code)


def sent_until(robot: HostFirmware, session: Session, count: int) -> bytes:
    """Begin an upload, until this many of its bytes have reached the robot; return the bytes that
    the computer sent afterwards, or no bytes if the upload is over.
    """
    request = session.upload(NEW_IMAGE, saves=True)
    while request.outcome is None:
        data = session.poll(robot.now_ms)
        if count < len(data):
            session.receive(robot.step(data[:count]), robot.now_ms)
            return data[count:]
        count -= len(data)
        session.receive(robot.step(data), robot.now_ms)
    return b""


def cut_at(memory: bytes, kind: str, count: int) -> bool:
    """Break an upload off after so many bytes; return whether it was over before."""
    robot, session = HostFirmware(KIT, memory), computer()
    robot.wait(200)
    assert robot.until(session, session.hello()) == OK
    is_late = sent_until(robot, session, count)
    if not is_late:
        return True
    if kind != CUT_KIND:
        robot.step(STOP)
        robot.did.clear()
        robot.step(is_late)  # bytes under way
        if kind == STOPPED_TWICE_KIND:
            robot.step(STOP)
        robot.wait(300)
        assert not [line for line in actions_of(robot) if line not in ("MOTORS 0 0",)], count
        assert robot.is_latched
    robot.wait(1100)
    next_session = computer(2)
    assert robot.until(next_session, next_session.hello()) == OK
    assert fetch_image(robot, next_session) in (
        bytes_of(image_of(OLD_PROGRAM)),
        bytes_of(NEW_IMAGE),
    ), count
    if kind == CUT_KIND:
        robot.did.clear()
        robot.push()
        robot.talk(next_session, 300)
        assert "MOTORS 50 50" in actions_of(robot) or "MOTORS 80 80" in actions_of(robot), count
    assert robot.until(next_session, next_session.upload(NEW_IMAGE, runs=False)) == OK
    assert fetch_image(robot, next_session) == bytes_of(NEW_IMAGE), count
    return False


def break_off(kind: str, first: int, stride: int) -> int:
    """Break uploads off at each so many bytes; return how many."""
    memory = robot_with_saved_program(OLD_PROGRAM)[0].memory()
    count = 0
    while not cut_at(memory, kind, first + count * stride):
        count += 1
    return count


@pytest.mark.parametrize("kind", KINDS)
def test_a_broken_off_upload_leaves_the_robot_usable(kind: str) -> None:
    assert break_off(kind, 3, STRIDE_BYTES) > 450 // STRIDE_BYTES


def test_a_program_overwritten_by_an_upload_is_no_longer_reported() -> None:
    """The robot still says its checksum and its length."""
    robot, session = HostFirmware(KIT), computer()
    robot.wait(200)
    assert robot.until(session, session.upload(image_of(OLD_PROGRAM), saves=False)) == OK
    complete_before = robot.complete(session, session.status())
    assert (complete_before.program, complete_before.saved) == (
        image_of(OLD_PROGRAM).checksum,
        SAVED_MEMORY,
    )
    assert complete_before.length == len(image_of(OLD_PROGRAM).code)
    assert sent_until(robot, session, 300)
    next_session = computer(2)
    hello = robot.complete(next_session, next_session.hello())
    status_reply = robot.complete(next_session, next_session.status())
    assert (status_reply.saved, status_reply.program, status_reply.length) == (SAVED_NOTHING, 0, 0)
    assert (hello.saved, hello.program, hello.length) == (SAVED_NOTHING, 0, 0)
    assert next_session.robot and next_session.robot.values.program == 0


# -- interruptions --------------------------------------------------------------------------------

TYPED_LINE = b"SI|LOOP(9);F(0.1,30);B(0.1,30);END_LOOP\n"
PIECE_BYTES = 9
SECOND_IMAGE = image_of("SI|" + "B(0.1, 60); SHOW(7); " * 12)
CUT_AFTER_BEGIN, CUT_BEFORE_LAST_PIECE, CUT_BEFORE_COMMIT = (
    "begun",
    "all but a piece",
    "all but its COMMIT",
)
CUTS = (CUT_AFTER_BEGIN, CUT_BEFORE_LAST_PIECE, CUT_BEFORE_COMMIT)


class Line:
    """A robot that has saved two programs, and a computer that asks frame by frame."""

    def __init__(self, kind: type[HostFirmware], memory: bytes) -> None:
        self.robot = kind(KIT, memory)
        self.robot.wait(200)
        self.epoch = self.seq = 0
        self.heard = b""
        self.say_hello()
        self.ask("CLEAR")

    def ask(self, name: str, payload: bytes = b"") -> int:
        """Send a frame; return the status of its answer."""
        self.seq += 1
        number = BY_NAME[name].number
        frame = encode_frame(Frame(number, self.seq, self.epoch, payload))
        answers = [frame for frame in self.exchange(b"\0" + frame, 20) if frame.seq == self.seq]
        assert [frame.number for frame in answers] == [number], answers
        return answers[0].payload[0]

    def exchange(self, data: bytes, milliseconds: int) -> list[Frame]:
        sent_bytes = self.heard + self.robot.wait(milliseconds, data)
        *packets, self.heard = sent_bytes.split(b"\0")
        frames = [frame for frame in map(decode_frame, packets) if frame is not None]
        if frames:
            self.epoch = frames[-1].epoch
        return [frame for frame in frames if frame.is_reply]

    def say_hello(self, nonce: bytes = b"abcd") -> None:
        kit = KIT.fingerprint.to_bytes(2, "little")
        assert self.ask("HELLO", bytes((MAJOR, MINOR, 2, 0)) + kit + nonce) == OK


def push_button(line: Line) -> None:
    line.robot.push()
    line.exchange(b"", 30)


# Requests that need the memory of a program, or end earlier requests.
REQUESTS_THAT_END_UPLOAD: dict[str, Callable[[Line], object]] = {
    "a line": lambda line: line.exchange(TYPED_LINE, 150),
    "a line for the button": lambda line: line.exchange(TYPED_LINE.replace(b"SI", b"SB"), 150),
    "a live line": lambda line: line.ask("LIVE", bytes([RUN]) + image_of("SI|B(9, 40)").code),
    "a program": lambda line: line.ask("PROGRAM", bytes([RUN]) + image_of("SI|B(9, 50)").code),
    "an upload": lambda line: line.ask(
        "BEGIN", bytes([RUN]) + bytes_of(SECOND_IMAGE)[2:CHECKSUM_OFFSET]
    ),
    "a start": lambda line: line.ask("START", bytes(1)),
    "an undo": lambda line: line.ask("UNDO"),
    "a breakpoint": lambda line: line.ask("BREAK", bytes(2)),
    "an abort": lambda line: line.ask("ABORT"),
    "the button": push_button,
    "another computer": lambda line: line.say_hello(b"efgh"),
    "zeros": lambda line: line.exchange(STOP, 5),
    "a stop": lambda line: line.exchange(
        b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 200, line.epoch)), 5
    ),
    "a typed stop": lambda line: line.exchange(b"S\n", 200),
}
# Requests during which an upload continues.
REQUESTS_DURING_UPLOAD: dict[str, Callable[[Line], object]] = {
    "a ping": lambda line: line.ask("PING"),
    "a status": lambda line: line.ask("STATUS"),
    "an identify": lambda line: line.ask("IDENTIFY"),
    "a wrong line": lambda line: line.exchange(b"F(1,\n", 100),
    "a wrong live line": lambda line: line.ask("LIVE", bytes([RUN, 255])),
}
ROBOT_KINDS = {"a mega": HostFirmware, "an uno": SmallRobot}


def two_programs() -> bytes:
    robot, session = robot_with_saved_program(OLD_PROGRAM)
    send(robot, session, "SB|B(0.1, 40)")
    wait_until_saved(robot, session)
    return robot.memory()


def frames_of(image: Image) -> list[tuple[str, bytes]]:
    data = bytes_of(image)
    body = data[CHECKSUM_OFFSET + 4 :]
    return [
        ("BEGIN", bytes([RUN]) + data[2:CHECKSUM_OFFSET]),
        *(("DATA", offset.to_bytes(2, "little") + body[offset : offset + PIECE_BYTES])
          for offset in range(0, len(body), PIECE_BYTES)),
        ("COMMIT", data[CHECKSUM_OFFSET : CHECKSUM_OFFSET + 4]),
    ]  # fmt: skip


def cut_by(
    kind: str, memory: bytes, cut: str, act_between: Callable[[Line], object]
) -> tuple[Line, list[tuple[str, bytes]]]:
    """Send a part of an upload and then other bytes; return the rest."""
    line, frames = Line(ROBOT_KINDS[kind], memory), frames_of(SECOND_IMAGE)
    count = {
        CUT_AFTER_BEGIN: 1,
        CUT_BEFORE_LAST_PIECE: len(frames) - 2,
        CUT_BEFORE_COMMIT: len(frames) - 1,
    }[cut]
    assert {line.ask(*frame) for frame in frames[:count]} == {OK}
    act_between(line)
    return line, frames[count:]


@pytest.fixture(scope="module")
def memory() -> bytes:
    return two_programs()


@pytest.mark.parametrize("kind", ROBOT_KINDS)
@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("request_name", REQUESTS_THAT_END_UPLOAD)
def test_an_interrupted_upload_is_over(
    memory: bytes, request_name: str, cut: str, kind: str
) -> None:
    """The rest is refused, and the robot acts as without it. The stand-in checks that no byte of
    the running program changes.
    """
    line, rest = cut_by(kind, memory, cut, REQUESTS_THAT_END_UPLOAD[request_name])
    twin, _ = cut_by(kind, memory, cut, REQUESTS_THAT_END_UPLOAD[request_name])
    if request_name == "an upload":
        # a shorter payload
        rest = rest[1:] if cut == CUT_BEFORE_LAST_PIECE else [("COMMIT", bytes(4))]
    statuses = [line.ask(*frame) for frame in rest]
    assert OK not in statuses, (statuses, rest)
    assert {twin.ask("PING") for _ in rest} == {OK}
    for one_line in (line, twin):
        one_line.robot.wait(300)
    assert line.robot.did == twin.robot.did
    assert line.robot.codes() == twin.robot.codes()


@pytest.mark.parametrize("kind", ROBOT_KINDS)
@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("request_name", REQUESTS_DURING_UPLOAD)
def test_an_upload_continues_beside_requests_that_need_no_memory(
    memory: bytes, request_name: str, cut: str, kind: str
) -> None:
    line, rest = cut_by(kind, memory, cut, REQUESTS_DURING_UPLOAD[request_name])
    assert [line.ask(*frame) for frame in rest] == [OK] * len(rest)
    assert line.robot.codes() == [SECOND_IMAGE.code]


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    for kind in KINDS:
        break_off(kind, 0, 1)
