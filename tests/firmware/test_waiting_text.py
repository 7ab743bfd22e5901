"""Text that waits before or after a program of frames: only verified code runs.

And it runs as often as it was sent: a frame that is said again was sent once.

`python -m tests.firmware.test_waiting_text 100000` is a campaign.
"""

from __future__ import annotations

import random
from collections import Counter
from itertools import cycle

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.button_states import SmallRobot
from tests.support.campaign import make_options
from tests.support.images import image_of
from tests.support.robot_on_host import KIT, actions_of, computer
from tiniscript import compile_text
from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR, RUN, SAVE
from tiniscript.link.requests import OK

TRIALS = 1000  # trials of the tests; a campaign runs more
TRIALS_PER_ROBOT = 100  # trials of one robot
# probability of a repeated frame, and of a second of silence before one
REPEAT_PROBABILITY, SILENCE_PROBABILITY = 0.3, 0.3
CHECKSUM_OFFSET, BODY_OFFSET = 10, 14  # offsets in an image
# A number whose bytes are instructions: a letter in front of it turns it into a move.
HIDDEN_MOVE_PROGRAM = "SI|SHOW(-1337933.387)"
WHOLE_LINES = ("F(0.01,30)", "SI|R(0.02,40)", "SI|M(20,20);W(0.01)", "SB|F(0.01,30)",
               HIDDEN_MOVE_PROGRAM, "SI|LOOP(2);W(0.01);END_LOOP", "PING|CHECK_CONNECTION",
               "SI|X=9.87;SHOW(X)")  # fmt: skip
OTHER_LINES = ("HELP", "FOO", "F(1,500)", "SI|LOOP(2)", "IF(TRUE)", "ENDWHILE", "SI|F(1,", "+OK",
               "~", "(", "SI|" + "X=1.2345;" * 9, "SB|" + "9" * 70)  # fmt: skip
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"


def new_robot(kind: type[HostFirmware] = SmallRobot) -> HostFirmware:
    robot = kind(KIT)
    robot.wait(1400)
    return robot


def plain_code(line: str) -> bytes:
    """Return the code that the robot's reader makes of a line."""
    robot = new_robot()
    robot.wait(1500, (line + "\n").encode())
    if line.startswith("SB"):
        robot.push()
        robot.wait(100)
    return (robot.codes() or [b""])[0]


class Trials:
    """Robots that get text and frames in one burst, cut anywhere."""

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.lines = {line: plain_code(line) for line in WHOLE_LINES}
        self.kinds = cycle((SmallRobot, HostFirmware))
        self.lives = 0
        self.ran = 0

    def begin(self) -> None:
        """Take a new robot now and then."""
        if self.lives == 0:
            self.lives = TRIALS_PER_ROBOT
            self.robot = new_robot(next(self.kinds))
            self.seq, self.epoch, self.heard = 0, 0, b""
        self.lives -= 1
        kit = KIT.fingerprint.to_bytes(2, "little")
        payload = bytes((MAJOR, MINOR, 2, 0)) + kit + self.rng.randbytes(4)
        self.put(b"\0" + self.frame("HELLO", payload), 12)

    def frame(self, name: str, payload: bytes = b"") -> bytes:
        self.seq = (self.seq + 1) % 256
        return encode_frame(Frame(BY_NAME[name].number, self.seq, self.epoch, payload))

    def put(self, data: bytes, milliseconds: int) -> None:
        """Deliver bytes in one burst, as after a long turn, and note the answers."""
        sent_bytes = self.robot.step(data, flags=16, ticks=self.rng.choice((0, 1, 1, 2, 20)))
        if milliseconds:
            sent_bytes += self.robot.wait(milliseconds)
        *packets, self.heard = (self.heard + sent_bytes).split(b"\0")
        for frame in map(decode_frame, packets):
            self.epoch = frame.epoch if frame else self.epoch

    def text(self, is_whole: bool = False) -> tuple[bytes, list[bytes]]:
        """Return text that waits, ended before a frame, and the codes that it may run."""
        rng = self.rng
        data, codes = b"", []
        for _ in range(1 if is_whole else rng.choice((0, 1, 1, 1, 2, 3))):
            kind = 0 if is_whole else rng.randrange(4)
            if kind == 0:
                line = rng.choice(WHOLE_LINES)
                codes.append(self.lines[line])
                data += line.encode() + rng.choice((b"\n", b"\r", b"\r\n"))
            else:
                line = rng.choice(LETTERS) if kind < 3 else rng.choice(OTHER_LINES)
                data += line.encode() + rng.choice((b"\n", b"\0", b"\0", b"\r\n"))
        return data + b"\0", codes

    def program(self) -> bytes:
        """Return the image of a program with bytes as varied as possible."""
        rng = self.rng
        parts = [
            f"SHOW({rng.randrange(-(2**31), 2**31) / 1000:.3f})",
            f"X = {rng.randrange(-(2**31), 2**31) / 1000:.3f}",
            f"M({rng.randrange(-100, 101)}, {rng.randrange(-100, 101)})",
            f"W(0.0{rng.randrange(1, 6)})",
        ]
        text = "SI|" + "; ".join(rng.choices(parts, k=rng.choice((1, 1, 2, 4))))
        image = compile_text(rng.choice((text, text, text, HIDDEN_MOVE_PROGRAM)), KIT).image
        assert image
        return image

    def frames(self, image: bytes) -> list[bytes]:
        """Return a program as a line of live, in one frame, or in pieces."""
        kind, mode = self.rng.randrange(4), RUN | self.rng.choice((0, 0, SAVE))
        code, body = image[HEADER_BYTES:], image[BODY_OFFSET:]
        if kind < 2:
            return [self.frame("LIVE", bytes([RUN]) + code)]
        if kind == 2:
            return [self.frame("PROGRAM", bytes([mode]) + code)]
        pieces = [
            self.frame("DATA", offset.to_bytes(2, "little") + body[offset : offset + 9])
            for offset in range(0, len(body), 9)
        ]
        begin_frame = self.frame("BEGIN", bytes([mode]) + image[2:CHECKSUM_OFFSET])
        return [begin_frame, *pieces, self.frame("COMMIT", image[CHECKSUM_OFFSET:BODY_OFFSET])]

    def run_trial(self) -> None:
        rng = self.rng
        self.begin()
        self.put(self.frame("CLEAR"), 5)
        self.robot.codes()
        self.robot.did.clear()
        image = self.program()
        may_run = Counter([image[HEADER_BYTES:]])
        for frame in self.frames(image):
            is_quiet = rng.random() < SILENCE_PROBABILITY
            bytes_before, codes = self.text(is_quiet)
            later_text, more_text = self.text()
            may_run.update(codes + more_text)
            data = bytes_before + frame
            max_bytes = rng.choice((3, min(12, len(frame))))  # a LIVE is made before its last ones
            if is_quiet:
                self.put(b"", 1100)  # from here on the robot reads text again
            cut = len(data) - rng.choice((rng.randrange(1, max_bytes), rng.randrange(len(frame))))
            self.put(data[:cut], rng.choice((0, 0, 1, 20 * is_quiet)))
            self.put(data[cut:] + rng.choice((b"", later_text)), rng.choice((1, 4, 20)))
            if rng.random() < REPEAT_PROBABILITY:
                self.put(b"", rng.choice((0, 20, 300)))
                self.put(b"\0" + frame, 20)
        self.put(b"", rng.choice((5, 30, 1100)))
        for line in self.robot.did:
            assert "UNVERIFIED" not in line and "CHANGED" not in line, self.robot.did
        ran_counter = Counter(self.robot.codes())
        assert not ran_counter - may_run, (ran_counter, may_run)
        self.ran += image[HEADER_BYTES:] in ran_counter


def test_the_verified_code_is_what_runs() -> None:
    trials = Trials(7)
    for _ in range(TRIALS):
        trials.run_trial()
    assert trials.ran > TRIALS // 3


@pytest.mark.parametrize("text", [b"X\0", b"t\0", b"D\0", b"a\n\0"])
def test_a_typed_letter_does_not_turn_a_number_into_a_move(text: bytes) -> None:
    robot, session = new_robot(), computer()
    assert robot.until(session, session.hello()) == OK
    request = session.live(image_of(HIDDEN_MOVE_PROGRAM).code)
    frame = session.poll(robot.now_ms)
    robot.step(text + frame[:-1], flags=16, ticks=1)
    session.receive(robot.step(frame[-1:]), robot.now_ms)
    assert robot.until(session, request) == OK
    robot.talk(session, 50)
    assert [event.value for event in session.events() if event.name == "SHOW"] == [-1337933387]
    assert actions_of(robot) == ["FINISHED"]


if __name__ == "__main__":
    options = make_options(1000, 1_000_000)
    all_trials = Trials(options.seed)
    for _ in range(options.count):
        all_trials.run_trial()
    print(f"{options.count} trials: {all_trials.ran} programs have run, each as it was verified")
