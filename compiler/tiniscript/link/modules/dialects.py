"""The AT commands of Bluetooth modules: one row for each kind, clones included.

From the modules' papers, and from what their users found. It knows no port: input and output are
text.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

CRLF = b"\r\n"
ANSWER_MS = 500  # time for an answer of a module that detects line ends
SLOW_ANSWER_MS = 1300  # time for an answer of a module that waits for a second of silence
RESTART_MS = 1200  # time for a module to answer again after a restart
WAKE_BYTES = 100  # text other than AT commands; more than 80 bytes wake a sleeping module
BAUDS = (9600, 38400, 115200, 57600, 19200)  # a robot's, and 38400 of an HC-05 that is set up

_FROM_1 = {9600: "4", 19200: "5", 38400: "6", 57600: "7", 115200: "8"}
_FROM_0 = {9600: "0", 19200: "1", 38400: "2", 57600: "3", 115200: "4"}
_BACKWARD = {115200: "0", 57600: "1", 38400: "2", 19200: "3", 9600: "4"}
_PLAIN = {baud: str(baud) for baud in BAUDS}


class Dialect(NamedTuple):
    """The commands of a kind of module; `{}` is the value.

    Several forms of a command are tried in this order. The answer to a query shows the effect of a
    command. `baud_codes` says how a speed is written. `restart_command` is that after which a speed
    counts; without it the speed counts at once. `keeps_baud`: while the module is set up it keeps
    the speed of that, and has the new one when it is switched on again.
    """

    name: str
    line_end: bytes
    name_commands: tuple[str, ...]
    pin_commands: tuple[str, ...]
    baud_commands: tuple[str, ...]
    baud_codes: Mapping[int, str]
    name_question: str
    pin_question: str
    baud_question: str
    restart_command: str
    name_bytes: int
    pin_digits: int
    keeps_baud: bool = False

    @property
    def wait_ms(self) -> int:
        """The longest time that an answer takes."""
        return ANSWER_MS if self.line_end else SLOW_ANSWER_MS


HC05 = Dialect(
    "HC-05", CRLF, ("AT+NAME={}", 'AT+NAME="{}"'), ("AT+PSWD={}", 'AT+PSWD="{}"'),
    ("AT+UART={},0,0",), _PLAIN, "AT+NAME?", "AT+PSWD?", "AT+UART?", "AT+RESET", 20, 4, True,
)  # fmt: skip
HC05_3 = HC05._replace(name="HC-05 3.x", pin_commands=('AT+PSWD="{}"', "AT+PSWD={}"))
HC06 = Dialect(
    "HC-06", b"", ("AT+NAME{}",), ("AT+PIN{}",), ("AT+BAUD{}",), _FROM_1, "", "", "", "", 20, 4,
)  # fmt: skip
HC06_3 = Dialect(
    "HC-06 3.x", CRLF, ("AT+NAME:{}", "AT+NAME={}"), ('AT+PSWD:"{}"', 'AT+PSWD="{}"'),
    ("AT+UART={},0,0", "AT+UART:{},0,0"), _PLAIN, "", "", "", "", 20, 4,
)  # fmt: skip
HM10 = Dialect(
    "HM-10", b"", ("AT+NAME{}",), ("AT+PASS{}",), ("AT+BAUD{}",), _FROM_0, "AT+NAME?", "AT+PASS?",
    "AT+BAUD?", "AT+RESET", 12, 6,
)  # fmt: skip
CC41 = Dialect(
    "CC41-A", CRLF, ("AT+NAME{}",), ("AT+PIN{}",), ("AT+BAUD{}",), _FROM_1, "AT+NAME", "AT+PIN",
    "AT+BAUD", "AT+RESET", 12, 6,
)  # fmt: skip
BT05 = CC41._replace(name="MLT-BT05", baud_codes=_BACKWARD)
DIALECTS = (HC05, HC05_3, HC06, HC06_3, HM10, CC41, BT05)


def is_ok(answer: str) -> bool:
    """Return whether an answer confirms a command: `OK`, `OKsetname`, `OK+Set:4`."""
    return not is_error(answer) and any(word.startswith("OK") for word in answer.split())


def is_error(answer: str) -> bool:
    return any(word.startswith(("ERROR", "FAIL")) for word in answer.split())


def value_of(answer: str) -> str:
    """Return the value in an answer: of `+NAME:ANA`, `OK+Get:4`, `+UART:9600,0,0`, `+PIN:"1234"`.

    The answer to a question about a value that a module does not report is empty.
    """
    for line in answer.splitlines():
        for prefix in ("OK+Get:", "OK+NAME:", "OK+PASS:", "+"):
            if line.startswith(prefix) and not line.startswith("+DISC"):
                value = line.removeprefix(prefix)
                if prefix == "+":
                    _, colon, value = value.replace("=", ":", 1).partition(":")
                    if not colon:
                        continue
                return value.strip()
    return ""
