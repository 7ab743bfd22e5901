"""Bluetooth modules as they are: each kind with its quirks, in simulated time.

Written from the modules' papers and from what their users report, not from the code under test.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

SLOW_MS = 1000  # silence after which a module without line ends executes its command


class SimulatedModule:
    """A module that waits for commands, on a wire; `name`, `pin` and `data_baud` are its settings.

    `answers` are patterns of commands, and the reply to the first one that matches. Groups of a
    pattern are what the command sets: `name`, `pin`, or `speed`, in `bauds` a key; `reset` makes
    the speed count. `breaks_after` commands it is switched off, as by a plug that is pulled.
    """

    name, pin = "", "1234"
    ends_lines = True
    answers: Sequence[tuple[str, str]] = ()
    default_answer = ""  # answer to any other command
    bauds: Mapping[str, int] = {}  # none, because a speed is its own name
    is_quick = False  # a new speed counts at once

    def __init__(self, baud: int = 9600) -> None:
        self.baud = baud  # speed at which it listens now
        self.data_baud = baud
        self.is_on, self.is_asleep = True, False
        self.commands: list[str] = []
        self.breaks_after: int | None = None
        self._line = b""
        self._silent_ms = 0

    def step(self, data: bytes) -> bytes:
        if not self.is_on:
            return b""
        if self.is_asleep:
            self.is_asleep = len(data) <= 80
            return b"" if self.is_asleep else b"OK+WAKE"
        self._line += data
        self._silent_ms = 0 if data else self._silent_ms + 1
        replies = b""
        if self.ends_lines:
            while b"\r\n" in self._line:
                command, _, self._line = self._line.partition(b"\r\n")
                replies += self._take(command)
        elif self._line and self._silent_ms >= SLOW_MS:
            command, self._line = self._line, b""
            replies += self._take(command)
        return replies

    def restart(self) -> None:
        """Do nothing, because it has no reset line."""

    def power_on(self) -> None:
        self.is_on, self.baud, self._line = True, self.data_baud, b""

    def _take(self, command: bytes) -> bytes:
        text = command.decode("ascii", "replace")
        self.commands.append(text)
        if self.breaks_after is not None and len(self.commands) > self.breaks_after:
            self.is_on = False
            return b""
        return self.answer(text).encode()

    def answer(self, command: str) -> str:
        for pattern, answer in self.answers:
            match = re.fullmatch(pattern, command, re.DOTALL)
            if match and self._apply_settings(**match.groupdict()):
                return answer.format(end=self)
        return self.default_answer

    def _apply_settings(
        self, name: str | None = None, pin: str = "", speed: str = "", reset: str = ""
    ) -> bool:
        """Apply the settings of a command; return False if there is no such speed."""
        if speed and self.bauds and speed not in self.bauds:
            return False
        self.name = self.name if name is None else name
        self.pin = pin or self.pin
        if speed:
            self.data_baud = self.bauds[speed] if self.bauds else int(speed)
        if reset or (speed and self.is_quick):
            self.baud = self.data_baud
        return True

    @property
    def number(self) -> str:
        """The name of its speed."""
        return next(key for key, baud in self.bauds.items() if baud == self.data_baud)


class Hc05(SimulatedModule):
    """An HC-05 with its button held: 38400 baud, lines, and a PIN that may keep its quotes."""

    name = "HC-05"
    version = "2.0-20100601"
    answers: Sequence[tuple[str, str]] = (
        (r"AT|AT\+RESET", "OK\r\n"),
        (r"AT\+VERSION\?", "+VERSION:{end.version}\r\nOK\r\n"),
        (r"AT\+ROLE\?", "+ROLE:0\r\nOK\r\n"),
        (r"AT\+NAME\?", "+NAME:{end.name}\r\nOK\r\n"),
        (r"AT\+PSWD\?", "+PSWD:{end.pin}\r\nOK\r\n"),
        (r"AT\+UART\?", "+UART:{end.data_baud},0,0\r\nOK\r\n"),
        (r"AT\+NAME=(?P<name>.{1,32}).*", "OK\r\n"),
        (r"AT\+PSWD=(?P<pin>.+)", "OK\r\n"),  # whatever it is
        (r"AT\+UART=(?P<speed>\d+),0,0", "OK\r\n"),
    )
    default_answer = "ERROR:(0)\r\n"

    def __init__(self, data_baud: int = 9600) -> None:
        super().__init__(38400)
        self.data_baud = data_baud


class Hc05New(Hc05):
    """Firmware 3.0: the PIN wants quotes."""

    version = "3.0-20170601"
    answers = (
        (r"AT\+PSWD\?", '+PIN:"{end.pin}"\r\nOK\r\n'),
        (r'AT\+PSWD="(?P<pin>\d{1,16})"', "OK\r\n"),
        (r"AT\+PSWD=.+", "ERROR:(1D)\r\n"),
        *Hc05.answers,
    )


class Hc06(SimulatedModule):
    """linvor 1.8: no line ends, a second of silence, and it never reports its settings."""

    name = "linvor"
    ends_lines = False
    is_quick = True
    bauds: Mapping[str, int] = {"4": 9600, "5": 19200, "6": 38400, "7": 57600, "8": 115200}
    answers = (
        ("AT", "OK"),
        (r"AT\+VERSION", "OKlinvorV1.8"),
        (r"AT\+NAME(?P<name>.{,20}).*", "OKsetname"),
        (r"AT\+PIN(?P<pin>\d{4})", "OKsetPIN"),
        (r"AT\+BAUD(?P<speed>\d)", "OK{end.baud}"),
    )


class Hc06New(SimulatedModule):
    """Firmware 3.0-20170609: line ends, a colon, and a PIN in quotes; the new speed at once."""

    name = "HC-06"
    is_quick = True
    answers = (
        ("AT", "OK\r\n"),
        (r"AT\+VERSION", "VERSION:3.0-20170609\r\nOK\r\n"),
        (r"AT\+NAME:(?P<name>.*)", "OK\r\n"),
        (r'AT\+PSWD:"(?P<pin>\d{4})"', "OK\r\n"),
        (r"AT\+UART=(?P<speed>\d+),0,0", "OK\r\n"),
    )
    default_answer = "ERROR:(0)\r\n"


class Hm10(SimulatedModule):
    """No line ends; a speed counts from the next restart on; 12 letters; PINs of 6 digits."""

    name, pin = "HMSoft", "000000"
    ends_lines = False
    bauds: Mapping[str, int] = {"0": 9600, "1": 19200, "2": 38400, "3": 57600, "4": 115200}
    answers = (
        ("AT", "OK"),
        (r"AT\+VERR\?", "HMSoft V540"),
        (r"AT\+(?P<reset>RESET)", "OK+RESET"),
        (r"AT\+NAME\?", "OK+NAME:{end.name}"),
        (r"AT\+PASS\?", "OK+Get:{end.pin}"),
        (r"AT\+BAUD\?", "OK+Get:{end.number}"),
        (r"AT\+NAME(?P<name>.{,12}).*", "OK+Set:{end.name}"),
        (r"AT\+PASS(?P<pin>\d{6})", "OK+Set:{end.pin}"),
        (r"AT\+BAUD(?P<speed>\d)", "OK+Set:{end.number}"),
    )


class Cc41(SimulatedModule):
    """A clone of the HM-10: line ends, other answers, and other numbers for the same speeds."""

    name, pin = "BT05", "123456"
    version = "Firmware V3.0.6,Bluetooth V4.0 LE"
    bauds: Mapping[str, int] = Hc06.bauds
    answers = (
        ("AT", "OK\r\n"),
        (r"AT\+VERSION", "+VERSION={end.version}\r\n"),
        (r"AT\+(?P<reset>RESET)", "+RESET\r\nOK\r\n"),
        (r"AT\+NAME", "+NAME={end.name}\r\n"),
        (r"AT\+PIN", "+PIN={end.pin}\r\n"),
        (r"AT\+BAUD", "+BAUD={end.number}\r\n"),
        (r"AT\+NAME(?P<name>.+)", "+NAME={end.name}\r\nOK\r\n"),
        (r"AT\+PIN(?P<pin>\d{6})", "+PIN={end.pin}\r\nOK\r\n"),
        (r"AT\+BAUD(?P<speed>\d)", "+BAUD={end.number}\r\nOK\r\n"),
    )
    default_answer = "ERROR=101\r\n"


class Bt05(Cc41):
    """A clone of the clone: its numbers count backward."""

    version = "MLT-BT05-V4.1"
    bauds: Mapping[str, int] = {"0": 115200, "1": 57600, "2": 38400, "3": 19200, "4": 9600}


KINDS = {
    "HC-05": Hc05,
    "HC-05 3.x": Hc05New,
    "HC-06": Hc06,
    "HC-06 3.x": Hc06New,
    "HM-10": Hm10,
    "CC41-A": Cc41,
    "MLT-BT05": Bt05,
}
