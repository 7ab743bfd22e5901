"""The AT commands of Bluetooth modules: one row for each kind, clones included.

From the modules' papers, and from what their users found. Knows no port: what is sent and what is
heard is text.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

CRLF = b"\r\n"
ANSWER_MS = 500  # for an answer of a module that knows the end of a line
SLOW_ANSWER_MS = 1300  # of one that waits for a second of silence instead
RESTART_MS = 1200  # until a module answers again after it was restarted
WAKE_BYTES = 100  # of any text but AT commands: more than 80 wake a module that sleeps
BAUDS = (9600, 38400, 115200, 57600, 19200)  # a robot's, and 38400 of an HC-05 that is set up

_SINCE_1 = {9600: "4", 19200: "5", 38400: "6", 57600: "7", 115200: "8"}
_SINCE_0 = {9600: "0", 19200: "1", 38400: "2", 57600: "3", 115200: "4"}
_BACKWARD = {115200: "0", 57600: "1", 38400: "2", 19200: "3", 9600: "4"}
_AS_IT_IS = {baud: str(baud) for baud in BAUDS}


class Dialect(NamedTuple):
    """The commands of a kind of module; `{}` is the value.

    Where a command has several forms, they are tried in this order. The answer to an `ask_` shows
    what a command has done. `bauds` says how a speed is written. `restart` is the command after
    which a speed counts; without it the speed counts at once. `is_fixed`: while the module is set
    up it keeps the speed of that, and has the new one when it is switched on again.
    """

    name: str
    ending: bytes
    names: tuple[str, ...]
    pins: tuple[str, ...]
    speeds: tuple[str, ...]
    bauds: Mapping[int, str]
    ask_name: str
    ask_pin: str
    ask_baud: str
    restart: str
    name_bytes: int
    pin_digits: int
    is_fixed: bool = False

    @property
    def wait_ms(self) -> int:
        """How long an answer takes, at most."""
        return ANSWER_MS if self.ending else SLOW_ANSWER_MS


HC05 = Dialect(
    "HC-05", CRLF, ("AT+NAME={}", 'AT+NAME="{}"'), ("AT+PSWD={}", 'AT+PSWD="{}"'),
    ("AT+UART={},0,0",), _AS_IT_IS, "AT+NAME?", "AT+PSWD?", "AT+UART?", "AT+RESET", 20, 4, True,
)  # fmt: skip
HC05_3 = HC05._replace(name="HC-05 3.x", pins=('AT+PSWD="{}"', "AT+PSWD={}"))
HC06 = Dialect(
    "HC-06", b"", ("AT+NAME{}",), ("AT+PIN{}",), ("AT+BAUD{}",), _SINCE_1, "", "", "", "", 20, 4,
)  # fmt: skip
HC06_3 = Dialect(
    "HC-06 3.x", CRLF, ("AT+NAME:{}", "AT+NAME={}"), ('AT+PSWD:"{}"', 'AT+PSWD="{}"'),
    ("AT+UART={},0,0", "AT+UART:{},0,0"), _AS_IT_IS, "", "", "", "", 20, 4,
)  # fmt: skip
HM10 = Dialect(
    "HM-10", b"", ("AT+NAME{}",), ("AT+PASS{}",), ("AT+BAUD{}",), _SINCE_0, "AT+NAME?", "AT+PASS?",
    "AT+BAUD?", "AT+RESET", 12, 6,
)  # fmt: skip
CC41 = Dialect(
    "CC41-A", CRLF, ("AT+NAME{}",), ("AT+PIN{}",), ("AT+BAUD{}",), _SINCE_1, "AT+NAME", "AT+PIN",
    "AT+BAUD", "AT+RESET", 12, 6,
)  # fmt: skip
BT05 = CC41._replace(name="MLT-BT05", bauds=_BACKWARD)
DIALECTS = (HC05, HC05_3, HC06, HC06_3, HM10, CC41, BT05)


def is_ok(said: str) -> bool:
    """Whether an answer says that a command was done: `OK`, `OKsetname`, `OK+Set:4`."""
    return not is_error(said) and any(word.startswith("OK") for word in said.split())


def is_error(said: str) -> bool:
    return any(word.startswith(("ERROR", "FAIL")) for word in said.split())


def value_of(said: str) -> str:
    """Return the value in an answer: of `+NAME:ANA`, `OK+Get:4`, `+UART:9600,0,0`, `+PIN:"1234"`.

    The answer to a question about a value that a module does not tell is empty.
    """
    for line in said.splitlines():
        for sign in ("OK+Get:", "OK+NAME:", "OK+PASS:", "+"):
            if line.startswith(sign) and not line.startswith("+DISC"):
                rest = line.removeprefix(sign)
                if sign == "+":
                    _, found, rest = rest.replace("=", ":", 1).partition(":")
                    if not found:
                        continue
                return rest.strip()
    return ""
