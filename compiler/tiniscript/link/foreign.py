"""The table of foreign devices at the other end of a line.

A row examines the received bytes, and may have a probe: a query that such a board answers and that
changes nothing. The bytes that boards send are known from their sources and documents, as of
November 2026:

- Firmata: `FirmataMarshaller.cpp` and `FirmataParser.cpp` of github.com/firmata/arduino. After it
  has started, and when it is asked, it reports the version of its protocol, 0xF9 and two bytes, and
  its firmware, 0xF0 0x79, two bytes and a name, two bytes for each letter, 0xF7. 57600 baud. It
  sends no 0xFF 0x55: 0xFF is its reset, and only the computer sends that. So the two are
  distinguished by their whole messages; two bytes alone prove nothing.
- mBot: `mbot_factory_firmware.ino` of github.com/Makeblock-official/Makeblock-Libraries, whose
  other boards do the same. "Version: 06.01.009" after its start, and answers that begin with
  0xFF 0x55 and end with CR LF. 115200 baud.
- Snek: `snek-io.c` and `snek-atmega-serial.c` of github.com/keith-packard/snek. "Welcome to Snek",
  the prompt "> " or "+ ", and it returns a 0x14 at once. 115200 baud.
- MicroPython and CircuitPython: docs.micropython.org, "The MicroPython Interactive Interpreter
  Mode": the prompt ">>> ", and the banner after Ctrl-B. Mostly 115200 baud.
- ESP32: docs.espressif.com, esptool, "Boot Mode Selection", and ESP-IDF, "Fatal Errors". The chip's
  ROM says at 115200 baud why it has started, and ESP-IDF when its supply has dropped.
- ESP-AT: docs.espressif.com, "Basic AT Commands": "ready" after its start, and its answer to
  AT+GMR. 115200 baud.

Knows no port, no speed and no time.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.base import languages
from tiniscript.base.source import printable
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import FIRST_EVENT

CATALOGUE = "foreign"
MAX_TEXT_CHARACTERS = 60  # characters of the message
MIN_BYTES = 4  # fewer bytes are not enough
MIN_PRINTABLE_SHARE = 0.9  # the share of printable characters in text
MIN_DIFFERENT_BYTES = 3  # different bytes in text: the noise of a wrong speed repeats itself
ROBOT_LINE_START = "//"  # a robot's lines begin so
OTHER_SKETCH = "other_sketch"  # the row of any device that prints text and has no row of its own
ECHO_SKETCH = "echo_sketch"


class ForeignBoard(NamedTuple):
    """A board that is not ours: the `name` of its kind, and a line of its `text`."""

    name: str
    text: str
    is_sure: bool

    @property
    def has_row(self) -> bool:
        return self.name in BY_NAME


class BoardKind(NamedTuple):
    """`recognise` returns the message of such a board, and whether it is certain; None if the bytes
    are not its own. `probe` provokes the message, or is empty.
    """

    name: str
    recognise: Callable[[bytes], tuple[str, bool] | None]
    probe: bytes = b""


def _line_recogniser(pattern: str) -> Callable[[bytes], tuple[str, bool] | None]:
    """Return a recogniser of text: its line that has this pattern."""
    line_pattern = re.compile(pattern.encode("ascii"))

    def recognise(data: bytes) -> tuple[str, bool] | None:
        match = line_pattern.search(data)
        if match is None:
            return None
        line_start = max(data.rfind(end, 0, match.start() + 1) for end in (b"\n", b"\r")) + 1
        line = re.split(rb"[\r\n]", data[line_start:], maxsplit=1)[0]
        return _printable(line.decode("utf-8", "replace")), True

    return recognise


_NAME_OF_FIRMATA = re.compile(rb"\xf0\x79([\x00-\x7f])([\x00-\x7f])((?:[\x20-\x7e]\x00){2,})\xf7")


def _recognise_firmata(data: bytes) -> tuple[str, bool] | None:
    match = _NAME_OF_FIRMATA.search(data)
    if match is None:
        return None
    name = match[3][::2].decode("ascii")
    return _printable(f"{name} {match[1][0]}.{match[2][0]}"), True


_VERSION_OF_MBOT = re.compile(rb"(?:^|[\r\n])(Version: [0-9]{2}\.[0-9]{2}\.[0-9]{3})(?:[\r\n]|$)")
_FRAME_OF_MBOT = re.compile(
    rb"\xff\x55(?:|.(?:\x01.|\x02.{4}|\x03..|\x04(.)([\x20-\x7e]*)))\r\n", re.DOTALL
)


def _recognise_mbot(data: bytes) -> tuple[str, bool] | None:
    text = ""
    for match in _FRAME_OF_MBOT.finditer(data):
        if match[1] is not None and match[1][0] != len(match[2]):
            continue
        text = match[2].decode("ascii") if match[2] else text or match[0].hex(" ").upper()
    version = _VERSION_OF_MBOT.search(data)
    if version is not None:
        return version[1].decode("ascii"), bool(text)  # other sketches may print such a line
    return (_printable(text), True) if text else None


_PYTHON = _line_recogniser(
    r"(?:MicroPython|Adafruit CircuitPython) v?[0-9]|raw REPL; CTRL-B to exit"
)


def _recognise_python(data: bytes) -> tuple[str, bool] | None:
    if banner := _PYTHON(data):
        return banner
    return (">>>", False) if re.search(rb"(?:^|\n)>>> *[\r\n\x11\x13]*$", data) else None


_SNEK = _line_recogniser(r"Welcome to [Ss]nek")


def _recognise_snek(data: bytes) -> tuple[str, bool] | None:
    if banner := _SNEK(data):
        return banner
    text = re.sub(rb"[\x11\x13]", b"", data)  # XON and XOFF may appear anywhere
    if re.search(rb"(?:^|\n)[>+] \x14?$", text) is None:
        return None
    return (">", b"\x14" in text)


_AT = _line_recogniser(r"AT version:[0-9]")


def _recognise_at(data: bytes) -> tuple[str, bool] | None:
    if banner := _AT(data):
        return banner
    return ("ready", False) if re.search(rb"[\r\n]ready\r\n", data) else None


BOARD_KINDS = (
    # Its supply first, because everything on such a board depends on it.
    BoardKind(
        "esp32_brownout",
        _line_recogniser(r"[Bb]rownout detector was triggered|\([A-Z_]*BROWN_?OUT"),
    ),
    BoardKind(
        "esp32_download", _line_recogniser(r"waiting for download|\(DOWNLOAD\([A-Z0-9_/]*\)\)")
    ),
    BoardKind(
        "esp32_empty", _line_recogniser(r"flash read err, [0-9]+|invalid header: 0x[0-9a-f]{8}")
    ),
    BoardKind("firmata", _recognise_firmata, b"\xf7\xf9\xf0\x79\xf7"),
    BoardKind("mbot", _recognise_mbot, b"\xff\x55\x03\x66\x01\x00"),
    BoardKind("micropython", _recognise_python, b"\r\n\x02"),
    BoardKind("snek", _recognise_snek, b"\r\n\x14"),
    BoardKind("at_firmware", _recognise_at),
    BoardKind("esp32", _line_recogniser(r"rst:0x[0-9a-f]+ \([A-Z0-9_]+\),boot:0x[0-9a-f]+ \(")),
)
BY_NAME = {row.name: row for row in BOARD_KINDS}
NAMES = (*BY_NAME, ECHO_SKETCH, OTHER_SKETCH)
GENERAL_ROWS = ("esp32", OTHER_SKETCH)  # rows that fit anything; a question may find out more
AT_VERSION_QUESTION = (
    b"\r\nAT+GMR\r\n"  # an AT firmware reports its version, which radio modules refuse
)


def identify_board(data: bytes) -> ForeignBoard | None:
    """Return the row of the sender of these bytes; None for robots, text and noise."""
    if is_robot(data):
        return None
    for kind in BOARD_KINDS:
        match = kind.recognise(data)
        if match is not None:
            return ForeignBoard(kind.name, *match)
    return None


def identify_stranger(data: bytes) -> ForeignBoard | None:
    """Return the row of the sender of these bytes, or that of another sketch for text.

    Sure text has a whole line. None for a robot's bytes, or for noise.
    """
    board = identify_board(data)
    if board is not None or is_robot(data):
        return board
    line = readable_line(data)
    return ForeignBoard(OTHER_SKETCH, line, _has_line(data)) if line else None


def is_robot(data: bytes) -> bool:
    """Return whether a robot has sent some of these bytes: a whole frame, or a line of text."""
    for packet in data.split(b"\0"):
        frame = decode_frame(packet) if packet else None
        if frame is not None and (frame.is_reply or frame.number >= FIRST_EVENT):
            return True
    return last_robot_line(data) != ""


def last_robot_line(data: bytes) -> str:
    """Return the last whole line of a robot's text, such as `// OK`, or an empty text."""
    lines = re.findall(rb"(?:^|[\r\n\x00])(// [\x20-\x7e]+)[\r\n]", data)
    return _printable(lines[-1].decode("ascii")) if lines else ""


def readable_line(data: bytes) -> str:
    """Return a line of bytes if they are text, otherwise an empty text.

    If no line ends all of them have to be.
    """
    if len(data) < MIN_BYTES or len(set(data)) < MIN_DIFFERENT_BYTES:
        return ""
    least_share = MIN_PRINTABLE_SHARE if _has_line(data) else 1.0
    text = re.sub(r"\x1b\[[0-9;]*m", "", data.decode("utf-8", "replace"))  # colours
    readable_count = sum(
        (letter.isprintable() and letter != "�") or letter in "\r\n\t" for letter in text
    )
    if not text or readable_count < least_share * len(text):
        return ""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return _printable(lines[len(lines) // 2]) if lines else ""


def _has_line(data: bytes) -> bool:
    return b"\n" in data or b"\r" in data


def _printable(line: str) -> str:
    text = re.sub(r"\x1b\[[0-9;]*m", "", line).strip()
    return "".join(letter for letter in text if letter.isprintable())[:MAX_TEXT_CHARACTERS]


class Explanation(NamedTuple):
    """The description of a foreign board, perhaps with its message, and the next step."""

    meaning: str
    advice: str


def explanation_of(name: str, language: str) -> Explanation:
    """Return the sentences of a row, or of ECHO_SKETCH or OTHER_SKETCH."""
    meaning = languages.text(CATALOGUE, f"{name}/said", language)
    return Explanation(meaning, languages.text(CATALOGUE, f"{name}/try", language))


def explain(board: ForeignBoard, language: str) -> Explanation:
    """Return the sentences about a board, with its message in the first one."""
    meaning, advice = explanation_of(board.name, language)
    says_form = languages.text(CATALOGUE, "says", language)
    return Explanation(
        says_form.format(what=meaning, said=printable(board.text, MAX_TEXT_CHARACTERS)), advice
    )
