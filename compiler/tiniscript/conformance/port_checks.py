"""The checks of a robot on a port, one after the other: frames, programs, refusals, stops.

No program turns a motor, and nothing is saved, but the content of the robot's RAM is replaced. It
knows what each answer should be. It prints nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from tiniscript.bytecode.image import pack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.bytecode.verify import RULES
from tiniscript.conformance.comparing import Verdict, compare
from tiniscript.conformance.kit import LinkProgram, LinkTestSuite
from tiniscript.conformance.wire_robot import HELLO_TRIES, Answer, Silent, WireRobot
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    MAJOR,
    PAYLOAD_BYTES,
    PLACE_BYTES,
    PLACES,
    RUN,
    SMALL_FRAME,
    STATUSES,
    STOP_BYTES,
    encode_payload,
)
from tiniscript.link.statuses import name_of

SHOW_7 = bytes.fromhex("b739")
WAIT_20 = bytes.fromhex("bb50")  # no motor turns
STATES = ("IDLE", "RUNNING", "STOPPED", "FAULTED")
NO_MESSAGE = 31  # a number that no message has
EVENT_TIMEOUT_S = 3.0  # time for an event after its cause
BUSY_TRIES, BUSY_PAUSE_S = 50, 0.1
HEADER_BYTES = 10  # bytes of an image before its checksum
SILENCE_TIMEOUT_S = 5.0  # an attached program without a frame ends after 1 s
ATTENDED_S = 3.0


class Check(NamedTuple):
    name: str
    wanted_rows: tuple[str, ...]
    find_rows: Callable[[WireRobot], tuple[str, ...]]


def verdicts(robot: WireRobot, checks: list[Check]) -> Iterator[Verdict]:
    """Yield the verdict of each check. It raises OSError if the port is lost.

    A robot that stops answering fails a check as `silent_count`; after three in a row, the rest is
    left out.
    """
    silent_count = 0
    for check in checks:
        try:
            reset_robot(robot)
            yield compare(check.name, check.wanted_rows, check.find_rows(robot))
            silent_count = 0
        except Silent as error:
            yield Verdict(check.name, "silent", detail=error.message)
            silent_count += 1
            if silent_count == 3:
                return


def reset_robot(robot: WireRobot) -> None:
    """Remove the traces of the check before: its run, its latch and its events."""
    state = robot.ask("PING").values.get("state")
    if state == STATES.index("RUNNING"):
        robot.ask("STOP")
        state = STATES.index("STOPPED")
    if state in (STATES.index("STOPPED"), STATES.index("FAULTED")):
        robot.ask("CLEAR")
    robot.events.clear()


def greet(robot: WireRobot) -> Answer:
    """Return the robot's answer to HELLO. Raises Silent."""
    return robot.hello(HELLO_TRIES)


def all_checks(suite: LinkTestSuite) -> list[Check]:
    return [
        *LINK_CHECKS,
        *(
            Check(f"programs: {program.name}", program.answer(), _program_check(program))
            for program in suite.programs
        ),
        *(
            Check(
                f"refused: {refused_code.name}",
                (f"{refused_code.rule} {refused_code.offset}",),
                _refusal_check(refused_code.code),
            )
            for refused_code in suite.refusals
        ),
        *IMAGE_CHECKS,
        *STOP_CHECKS,
    ]


def answer_text(answer: Answer) -> str:
    """Return an answer as a check writes it: a name, and the detail if there is one."""
    if answer.status == -1:
        return "OK with other fields"
    name = name_of(answer.status)
    return f"{name} {answer.detail}" if answer.detail or name in RULES else name


# -- programs -------------------------------------------------------------------------------------


def run_live(robot: WireRobot, code: bytes) -> Answer:
    return ask_while_busy(robot, "LIVE", {"mode": RUN, "code": code})


def ask_while_busy(robot: WireRobot, name: str, values: Mapping[str, int | bytes]) -> Answer:
    """Ask again while the robot is saving something."""
    for _ in range(BUSY_TRIES):
        answer = robot.ask(name, values)
        if answer.status != STATUSES["BUSY"]:
            break
        robot.wait(BUSY_PAUSE_S)
    return answer


def announce(robot: WireRobot, image: bytes, mode: int) -> Answer:
    return ask_while_busy(robot, "BEGIN", {
        "mode": mode, "isa_major": image[2], "isa_minor": image[3], "start": image[4],
        "header_length": image[5], "devices": int.from_bytes(image[6:8], "little"),
        "code_length": int.from_bytes(image[8:10], "little"),
    })  # fmt: skip


def send_image(robot: WireRobot, image: bytes, mode: int) -> Answer:
    """Bring an image in pieces, as it is; return the first answer that is not OK, or the last."""
    code_bytes = image[HEADER_BYTES + 4 :]
    answer = announce(robot, image, mode)
    most_bytes = PAYLOAD_BYTES - 2
    for offset in range(0, len(code_bytes), most_bytes):
        if answer.status:
            return answer
        piece = code_bytes[offset : offset + most_bytes]
        answer = robot.ask("DATA", {"offset": offset, "bytes": piece})
    if answer.status:
        return answer
    return robot.ask(
        "COMMIT", {"checksum": int.from_bytes(image[HEADER_BYTES : HEADER_BYTES + 4], "little")}
    )


def _program_check(program: LinkProgram) -> Callable[[WireRobot], tuple[str, ...]]:
    def observe(robot: WireRobot) -> tuple[str, ...]:
        if len(program.code) < PAYLOAD_BYTES:
            answer = run_live(robot, program.code)
        else:
            answer = send_image(robot, pack("SI", 0, program.code), RUN)
        if answer.status:
            return (answer_text(answer),)
        return _run_events(robot, program.duration_s + EVENT_TIMEOUT_S)

    return observe


def _run_events(robot: WireRobot, seconds: float) -> tuple[str, ...]:
    """Return the events of a run, up to its end."""
    end_events = ("DONE", "FAULT", "STOPPED")
    for _ in range(int(seconds / 0.05)):
        if any(event.name in end_events for event in robot.events):
            break
        robot.wait(0.05)
    rows = []
    for event in robot.events:
        if event.name == "SHOW":
            rows.append(f"SHOW {event.number('value')} {event.number('is_yes_no')}")
        elif event.name == "FAULT":
            rows.append(f"FAULT {event.number('fault')} {event.number('offset')}")
        else:
            rows.append(event.name)
    return tuple(rows)


def _refusal_check(code: bytes) -> Callable[[WireRobot], tuple[str, ...]]:
    def observe(robot: WireRobot) -> tuple[str, ...]:
        if len(code) < PAYLOAD_BYTES:
            return (answer_text(ask_while_busy(robot, "PROGRAM", {"mode": 0, "code": code})),)
        return (answer_text(send_image(robot, pack("SI", 0, code), 0)),)

    return observe


# -- frames ---------------------------------------------------------------------------------------


def _check_hello(robot: WireRobot) -> tuple[str, ...]:
    answer = robot.hello()
    if answer.status:
        return (answer_text(answer),)
    field_of = answer.number
    takes_small_frames = field_of("largest") >= SMALL_FRAME and field_of("window") >= 1
    isa = f"isa {field_of('isa_major')}.{field_of('isa_minor')}"
    epoch = robot.epoch
    robot.hello()
    session_text = "the same session" if robot.epoch == epoch else "another session"
    frames = "frames of 63 bytes" if takes_small_frames else "smaller frames"
    return (f"link {field_of('major')}", isa, frames, f"the same nonce again: {session_text}")


def _check_damaged_frame(robot: WireRobot) -> tuple[str, ...]:
    damaged_before = robot.ask("STATUS").number("damaged")
    frame = bytearray(encode_frame(Frame(BY_NAME["PING"].number, 200, robot.epoch)))
    frame[-2] ^= 0x55  # damages the checksum
    robot.send(b"\0" + bytes(frame).replace(b"\0", b"\x55", len(frame) - 1)[:-1] + b"\0")
    replies = robot.receive(0.3)
    damaged_count = (robot.ask("STATUS").number("damaged") - damaged_before) % 256
    return ("no answer" if not replies else "an answer", f"damaged: {damaged_count} more")


def _check_repeated_request(robot: WireRobot) -> tuple[str, ...]:
    payload = encode_payload(BY_NAME["LIVE"].request, {"mode": RUN, "code": SHOW_7})
    number = BY_NAME["LIVE"].number
    epoch = robot.epoch
    first_answer = robot.ask_frame(number, payload)
    robot.wait(EVENT_TIMEOUT_S, "DONE")
    second_answer = robot.repeat(number, payload, epoch=epoch)
    robot.wait(0.4)
    second_text = (
        "the same answer"
        if first_answer.payload == second_answer.payload
        else answer_text(second_answer)
    )
    return (
        answer_text(first_answer),
        second_text,
        f"{sum(e.name == 'SHOW' for e in robot.events)} SHOW",
    )


def _check_noise(robot: WireRobot) -> tuple[str, ...]:
    robot.send(bytes.fromhex("80feff80818283") * 20)
    return (answer_text(robot.ask("PING")),)


def _check_stale(robot: WireRobot) -> tuple[str, ...]:
    number = BY_NAME["CLEAR"].number
    return (answer_text(robot.ask_frame(number, b"", epoch=(robot.epoch + 100) & 0xFF)),)


_PLACE_ROWS = ("no place before", "1 of what runs", "no place unasked")


def _check_place(robot: WireRobot) -> tuple[str, ...]:
    if not greet(robot).number("features") & PLACES:
        return _PLACE_ROWS  # the robot does not report places, so none is requested
    earlier_answer = robot.ask("PING", {"asks": b"?"})
    program = run_live(robot, WAIT_20).number("program")
    place_field = _bytes_field(robot.ask("PING", {"asks": b"?"}), "place")
    place_text = f"{int.from_bytes(place_field[:2], 'little')} of "
    place_text += (
        "what runs" if place_field[2:] == program.to_bytes(4, "little") else "something else"
    )
    return (
        "a place before" if _bytes_field(earlier_answer, "place") else "no place before",
        place_text if len(place_field) == PLACE_BYTES else f"{len(place_field)} bytes of a place",
        "a place unasked" if _bytes_field(robot.ask("PING"), "place") else "no place unasked",
    )


def _bytes_field(answer: Answer, name: str) -> bytes:
    value = answer.values.get(name)
    return value if isinstance(value, bytes) else b""


LINK_CHECKS = (
    Check("link: HELLO", (f"link {MAJOR}", f"isa {ISA_MAJOR}.{ISA_MINOR}",
                          "frames of 63 bytes", "the same nonce again: the same session"),
          _check_hello),
    Check("link: PING", ("OK",), lambda robot: (answer_text(robot.ask("PING")),)),
    Check("link: where a program is", _PLACE_ROWS, _check_place),
    Check("link: a message that nobody knows", ("UNKNOWN_MESSAGE",),
          lambda robot: (answer_text(robot.ask_frame(NO_MESSAGE, b"")),)),
    Check("link: a payload that is too long", ("BAD_LENGTH",),
          lambda robot: (answer_text(robot.ask_frame(BY_NAME["PING"].number, b"??")),)),
    Check("link: a payload that is too short", ("BAD_LENGTH",),
          lambda robot: (answer_text(robot.ask_frame(BY_NAME["COMMIT"].number, b"abc")),)),
    Check("link: a request of another epoch", ("STALE",), _check_stale),
    Check("link: a damaged frame", ("no answer", "damaged: 1 more"), _check_damaged_frame),
    Check("link: a request after noise", ("OK",), _check_noise),
    Check("link: a request that comes twice", ("OK", "the same answer", "1 SHOW"),
        _check_repeated_request),
)  # fmt: skip


# -- images ---------------------------------------------------------------------------------------

LONG_IMAGE = pack("SI", 0, bytes.fromhex("310001") * 40)


def _change_byte(offset: int, value: int) -> bytes:
    """Return the image with another byte and its old checksum."""
    return LONG_IMAGE[:offset] + bytes([value]) + LONG_IMAGE[offset + 1 :]


def _image_check(image: bytes) -> Callable[[WireRobot], tuple[str, ...]]:
    return lambda robot: (answer_text(send_image(robot, image, 0)),)


def _check_fetch(robot: WireRobot) -> tuple[str, ...]:
    answer = send_image(robot, LONG_IMAGE, 0)
    if answer.status:
        return (answer_text(answer),)
    image = b""
    while len(image) < len(LONG_IMAGE):
        answer = robot.ask("FETCH", {"offset": len(image)})
        piece = answer.values.get("bytes")
        if answer.status or not isinstance(piece, bytes) or not piece:
            return (answer_text(answer),)
        image += piece
    return ("the same image" if image == LONG_IMAGE else "another image",)


def _check_incomplete(robot: WireRobot) -> tuple[str, ...]:
    announce(robot, LONG_IMAGE, 0)
    robot.ask("DATA", {"offset": 0, "bytes": LONG_IMAGE[HEADER_BYTES + 4 : HEADER_BYTES + 24]})
    gap_answer = robot.ask("DATA", {"offset": 30, "bytes": b"?"})
    return (f"next {gap_answer.number('next')}", answer_text(robot.ask("COMMIT", {"checksum": 0})))


IMAGE_CHECKS = (
    Check("images: FETCH brings back what was sent", ("the same image",), _check_fetch),
    Check("images: another major version", (f"OTHER_MACHINE {ISA_MAJOR << 8 | ISA_MINOR}",),
          _image_check(_change_byte(2, ISA_MAJOR + 1))),
    Check("images: a later minor version", (f"OTHER_MACHINE {ISA_MAJOR << 8 | ISA_MINOR}",),
          _image_check(_change_byte(3, ISA_MINOR + 1))),
    Check("images: another checksum", ("DAMAGED",), _image_check(_change_byte(HEADER_BYTES,
        LONG_IMAGE[HEADER_BYTES] ^ 1))),
    Check("images: a piece is missing", ("next 20", "INCOMPLETE 20"), _check_incomplete),
)  # fmt: skip


# -- stops ----------------------------------------------------------------------------------------


def _state(answer: Answer) -> str:
    number = answer.number("state")
    return STATES[number] if 0 <= number < len(STATES) else f"state {number}"


def _stop_check(stop: Callable[[WireRobot], object]) -> Callable[[WireRobot], tuple[str, ...]]:
    def observe(robot: WireRobot) -> tuple[str, ...]:
        run_live(robot, WAIT_20)
        robot.events.clear()
        stop(robot)
        event = robot.wait(EVENT_TIMEOUT_S, "STOPPED")
        cause = "no STOPPED" if event is None else f"STOPPED {event.number('cause')}"
        state = _state(robot.ask("PING"))
        latched_text = answer_text(run_live(robot, SHOW_7))
        return (
            cause,
            state,
            latched_text,
            answer_text(robot.ask("CLEAR")),
            answer_text(run_live(robot, SHOW_7)),
        )

    return observe


def _check_silence(robot: WireRobot) -> tuple[str, ...]:
    run_live(robot, WAIT_20)
    robot.wait(SILENCE_TIMEOUT_S, "FAULT", sends_heartbeats=False)
    status = robot.ask("STATUS")
    return (_state(status), f"fault {status.number('fault')}")


def _check_attended(robot: WireRobot) -> tuple[str, ...]:
    run_live(robot, WAIT_20)
    robot.wait(ATTENDED_S)
    return (_state(robot.ask("PING")),)


STOP_CHECKS = (
    Check("stops: the stop sequence", ("STOPPED 1", "STOPPED", "LATCHED", "OK", "OK"),
          _stop_check(lambda robot: robot.send(bytes(STOP_BYTES)))),
    Check("stops: STOP", ("STOPPED 2", "STOPPED", "LATCHED", "OK", "OK"),
          _stop_check(lambda robot: robot.ask("STOP"))),
    Check("stops: a second of silence", ("FAULTED", "fault 64"), _check_silence),
    Check("stops: a run that is attended goes on", ("RUNNING",), _check_attended),
)  # fmt: skip
