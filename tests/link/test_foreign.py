"""Boards that are not ours: each is known by a recording, a robot and noise are never one."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support import foreign_boards as boards
from tests.support.foreign_boards import RECORDINGS, Recording
from tests.support.uart import at_speed
from tiniscript.link import foreign
from tiniscript.link.connection import FOREIGN, MAX_EARLY_BYTES, LinkConnection, reason_of
from tiniscript.link.foreign import identify_board, identify_stranger
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import FIRST_EVENT, MESSAGES
from tiniscript.link.outcomes import LOST
from tiniscript.link.requests import Reply
from tiniscript.studio.page_line import PageKeys, PageRobot
from tiniscript.studio.robot_link import RobotLink

BAUDS = (9600, 19200, 38400, 57600, 115200)
CASES = Path(__file__).parent.parent / "cases"
each_recording = pytest.mark.parametrize("recording", RECORDINGS.values(), ids=RECORDINGS)


def recorded_bytes() -> list[bytes]:
    """Return the robots' bytes in the cases of the link: frames, lines of text, zeros."""
    recordings = []
    for name in ("link.md", "link_text.md"):
        text = (CASES / name).read_text(encoding="utf-8")
        for row in re.findall(r"^ *[0-9]* < ((?:[0-9a-f]{2} )*[0-9a-f]{2})\b", text, re.M):
            recordings.append(bytes.fromhex(row))
    return recordings


ROBOT_RECORDING = recorded_bytes()


def test_recorded_robot_bytes_exist() -> None:
    assert len(ROBOT_RECORDING) > 100
    assert sum(row_of_ours.startswith(b"// ") for row_of_ours in ROBOT_RECORDING) > 20


# -- each board ---------------------------------------------------------------------------------


@each_recording
def test_a_board_is_recognized_by_its_recording(recording: Recording) -> None:
    board = identify_board(recording.data)
    assert board is not None
    assert (board.name, board.text, board.is_sure) == (recording.name, recording.shown_text, True)


def test_each_row_has_a_recording() -> None:
    assert {recording.name for recording in RECORDINGS.values()} == {
        row.name for row in foreign.BOARD_KINDS
    }


@each_recording
def test_a_truncated_recording_is_recognized_correctly_or_not_at_all(recording: Recording) -> None:
    """A piece identifies less, but nothing wrong: an ESP32's boot messages precede the sketch's."""
    possible_names = {recording.name, "esp32", None}
    if recording.data.endswith(b">>> "):
        possible_names |= {"micropython"}
    rng = random.Random(recording.shown_text)
    for _ in range(400):
        start, end = sorted(rng.randrange(len(recording.data) + 1) for _ in range(2))
        board = identify_board(recording.data[start:end])
        assert (board and board.name) in possible_names, recording.data[start:end]


@each_recording
def test_a_recording_is_recognized_in_any_pieces(recording: Recording) -> None:
    line = LinkLine()
    for offset in range(0, len(recording.data), 3):
        line.note_heard(recording.data[offset : offset + 3])
    assert line.early_bytes == recording.data and line.heard_count == len(recording.data)
    assert identify_board(line.early_bytes) == identify_board(recording.data)


@each_recording
@pytest.mark.parametrize("noise", [b"", b"\xf8\x00\x80", b"x\xfe\r\n"])
def test_noise_before_a_recording_changes_nothing(recording: Recording, noise: bytes) -> None:
    board = identify_board(noise + b"\r\n" + recording.data)
    assert board is not None and board.name == recording.name


def test_two_bytes_identify_nothing() -> None:
    """Neither those of an mBot nor the version of Firmata's protocol prove anything: noise contains
    them, too."""
    for short_data in (
        b"\xff\x55",
        b"\xf9\x02\x05",
        b"\xff\x55\r",
        b"\xf0\x79\x02\x05\xf7",
        b"\r\n",
    ):
        assert identify_stranger(short_data) is None


def test_the_two_boards_that_send_high_bytes_are_told_apart() -> None:
    for data, name in ((boards.FIRMATA, "firmata"), (boards.MBOT_VERSION, "mbot")):
        board = identify_board(data)
        assert board is not None and board.name == name
        rows = [row.name for row in foreign.BOARD_KINDS if row.recognise(data)]
        assert rows == [name]


# -- other devices --------------------------------------------------------------------------------


@each_recording
def test_noise_of_a_wrong_baud_rate_is_not_a_board(recording: Recording) -> None:
    for sent_baud in BAUDS:
        for heard_baud in BAUDS:
            noise = at_speed(recording.data, sent_baud, heard_baud)
            assert (noise == recording.data) == (sent_baud == heard_baud)
            if sent_baud != heard_baud:
                assert identify_board(noise) is None, (sent_baud, heard_baud)
                assert identify_stranger(noise) is None, (sent_baud, heard_baud)


@given(st.binary(max_size=300))
def test_random_bytes_are_no_board(data: bytes) -> None:
    assert identify_board(data) is None


def test_much_noise_is_not_a_board() -> None:
    rng = random.Random(5)
    for _ in range(300):
        assert identify_stranger(bytes(rng.choices(range(256), k=500))) is None


@given(st.lists(st.sampled_from(ROBOT_RECORDING), min_size=1, max_size=6), st.binary(max_size=20))
def test_a_robot_is_not_a_board(traffic: list[bytes], noise: bytes) -> None:
    """Frames and lines are recognized first, with any noise around them."""
    for data in (b"".join(traffic), noise + b"\0" + b"".join(traffic) + noise):
        assert identify_stranger(data) is None or not foreign.is_robot(data)
        if any(foreign.is_robot(data) for data in traffic):
            assert identify_stranger(b"\0" + b"".join(traffic)) is None


@given(
    st.sampled_from([message.number for message in MESSAGES if message.number >= FIRST_EVENT]),
    st.sampled_from([recording.data for recording in RECORDINGS.values()]), st.booleans(),
)  # fmt: skip
def test_a_frame_that_contains_the_bytes_of_a_board_is_a_robots(
    number: int, data: bytes, is_reply: bool
) -> None:
    frame = encode_frame(Frame(number, 3, 7, data[:50], is_reply))
    assert foreign.is_robot(frame)
    assert identify_stranger(b"\0" + frame) is None


@pytest.mark.sampled("piece", keep=40)
@pytest.mark.parametrize("piece", range(200))
def test_a_piece_of_a_robots_bytes_is_not_a_board(piece: int) -> None:
    rng = random.Random(piece)
    data = b"".join(rng.choices(ROBOT_RECORDING, k=5))
    start, end = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    assert identify_board(data[start:end]) is None


def test_bytes_of_a_computer_are_not_mistaken_for_a_robots() -> None:
    """A device that echoes returns it."""
    assert not foreign.is_robot(b"\0" + encode_frame(Frame(1, 3, 7, b"123456789")))


# -- text ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (b"Distance: 34 cm\r\n" * 3, "Distance: 34 cm"),
        (b"0\r\n0\r\n", "0"),
        ("Distancia: 4 \N{DEGREE SIGN}C\n".encode(), "Distancia: 4 \N{DEGREE SIGN}C"),
        (b"\x1b[0;32mI (71) boot: chip\x1b[0m\r\n", "I (71) boot: chip"),
        (b"\xfe Distance: 34 cm\r\n", "\N{REPLACEMENT CHARACTER} Distance: 34 cm"),
        (b"abc,", "abc,"),
        (b"x" * 300 + b"\r\n", "x" * 60),
        (b"ab", ""),
        (b"UUUUUUUU", ""),
        (b"\x07\x07\x07\x07\x08\x09", ""),
        (b"", ""),
    ],
)
def test_readable_lines_are_text(data: bytes, name: str) -> None:
    assert foreign.readable_line(data) == name
    stranger = identify_stranger(data)
    assert (stranger.text if stranger else "") == name
    assert stranger is None or stranger.is_sure == (b"\n" in data)


@given(st.text(st.characters(min_codepoint=0x20, max_codepoint=0x2FF, categories=("L", "N", "P")),
               min_size=4, max_size=50))  # fmt: skip
def test_any_line_of_text_is_text(line: str) -> None:
    """Bytes that are text at this speed are never those of a wrong speed."""
    data = f"{line}\r\n".encode()
    stranger = identify_stranger(data)
    assert stranger is not None or foreign.is_robot(data)


# -- who else says it ---------------------------------------------------------------------------


class LinkLine(LinkConnection):
    """A connection on which no robot has answered."""

    robot = None

    def enable_place_events(self) -> None:
        pass


@each_recording
def test_a_connection_names_the_device_that_answers_instead_of_a_robot(
    recording: Recording,
) -> None:
    line = LinkLine()
    line.note_heard(recording.data)
    assert reason_of(line, Reply(LOST)) == FOREIGN
    line.is_echoed = True
    assert reason_of(line, Reply(LOST)) == FOREIGN
    for language, word in (("en", "It sends: "), ("es", "Envía: "), ("pt", "Envia: ")):
        answer = RobotLink(line, language)._failure_data(Reply(LOST))
        assert answer["failure"] == FOREIGN
        assert word + recording.shown_text[:20] in answer["said"] and answer["advice"]


@pytest.mark.parametrize("name", ["snek", "brownout", "mbot"])
def test_the_page_names_the_foreign_device_at_its_port(name: str) -> None:
    recording = RECORDINGS[name]
    page = PageRobot("tinibot", "es", PageKeys(b""))
    page.advance(recording.data, 5, [{"do": "hello", "id": 1, "limit_ms": 300}])
    news = [item for now_ms in range(5, 900, 20) for item in page.advance(b"", now_ms, [])["news"]]
    (answer,) = news
    assert answer["failure"] == FOREIGN
    assert answer["said"].startswith(foreign.explanation_of(recording.name, "es").meaning)
    assert recording.shown_text in answer["said"]


@pytest.mark.parametrize(
    ("heard_bytes", "is_echoed", "reason"),
    [
        (b"", False, "link_silent"), (b"\xff\xfe\x80\x00", False, "link_other"),
        (b"Distance: 34 cm\r\n", False, FOREIGN), (b"Distance: 34 cm\r\n", True, "link_echo"),
        (b"abc,d", False, "link_other"), (b"// OK\r\n", False, "link_other"),
    ],
)  # fmt: skip
def test_the_message_without_a_robot_fits_the_received_bytes(
    heard_bytes: bytes, is_echoed: bool, reason: str
) -> None:
    line = LinkLine()
    line.note_heard(heard_bytes)
    line.is_echoed = is_echoed
    assert reason_of(line, Reply(LOST)) == reason


def test_the_last_received_bytes_are_kept() -> None:
    line = LinkLine()
    for _ in range(100):
        line.note_heard(b"x" * 99)
    line.note_heard(boards.MBOT_START)
    assert len(line.early_bytes) == MAX_EARLY_BYTES and line.early_bytes.endswith(boards.MBOT_START)
    line.robot = object()  # type: ignore[assignment]
    line.note_heard(b"y")
    assert (
        line.early_bytes.endswith(boards.MBOT_START)
        and line.heard_count == 9900 + len(boards.MBOT_START) + 1
    )
