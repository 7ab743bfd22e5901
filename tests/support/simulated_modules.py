"""Bluetooth modules as they are: each kind with its quirks, in simulated time.

Written from the modules' papers and from what their users report, not from the code under test.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

SLOW_MS = 1000  # after so long a silence a module without line ends takes what it has for a command


class SimulatedModule:
    """A module that waits for commands, on a wire; `name`, `pin` and `data_baud` are what it keeps.

    `breaks_after` commands it is switched off, as by a plug that is pulled.
    """

    ends_lines = True

    def __init__(self, baud: int = 9600) -> None:
        self.baud = baud  # at which it listens now
        self.data_baud = baud
        self.name, self.pin = "", "1234"
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
        said = b""
        if self.ends_lines:
            while b"\r\n" in self._line:
                command, _, self._line = self._line.partition(b"\r\n")
                said += self._take(command)
        elif self._line and self._silent_ms >= SLOW_MS:
            command, self._line = self._line, b""
            said += self._take(command)
        return said

    def restart(self) -> None:
        """It has no line that a computer could pull."""

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
        raise NotImplementedError


class Hc05(SimulatedModule):
    """With its button held: 38400, lines, and a PIN that may keep its quotes."""

    version = "2.0-20100601"

    def __init__(self, data_baud: int = 9600) -> None:
        super().__init__(38400)
        self.data_baud = data_baud
        self.name = "HC-05"

    def answer(self, command: str) -> str:
        key, sign, value = command.partition("=")
        if command == "AT":
            return "OK\r\n"
        if command == "AT+VERSION?":
            return f"+VERSION:{self.version}\r\nOK\r\n"
        if command == "AT+ROLE?":
            return "+ROLE:0\r\nOK\r\n"
        if command == "AT+NAME?":
            return f"+NAME:{self.name}\r\nOK\r\n"
        if command == "AT+PSWD?":
            return self.tell_pin()
        if command == "AT+UART?":
            return f"+UART:{self.data_baud},0,0\r\nOK\r\n"
        if command == "AT+RESET":
            return "OK\r\n"
        if sign and key == "AT+NAME" and value:
            self.name = value[:32]
            return "OK\r\n"
        if sign and key == "AT+PSWD" and value:
            return self.take_pin(value)
        if sign and key == "AT+UART" and re.fullmatch(r"\d+,0,0", value):
            self.data_baud = int(value.split(",")[0])
            return "OK\r\n"
        return "ERROR:(0)\r\n"

    def tell_pin(self) -> str:
        return f"+PSWD:{self.pin}\r\nOK\r\n"

    def take_pin(self, value: str) -> str:
        self.pin = value  # whatever it is
        return "OK\r\n"


class Hc05New(Hc05):
    """Firmware 3.0: the PIN wants quotes."""

    version = "3.0-20170601"

    def tell_pin(self) -> str:
        return f'+PIN:"{self.pin}"\r\nOK\r\n'

    def take_pin(self, value: str) -> str:
        if not re.fullmatch(r'"\d{1,16}"', value):
            return "ERROR:(1D)\r\n"
        self.pin = value.strip('"')
        return "OK\r\n"


class Hc06(SimulatedModule):
    """linvor 1.8: no line ends, a second of silence, and it never tells what it keeps."""

    ends_lines = False
    bauds: Mapping[str, int] = {"4": 9600, "5": 19200, "6": 38400, "7": 57600, "8": 115200}

    def __init__(self, baud: int = 9600) -> None:
        super().__init__(baud)
        self.name = "linvor"

    def answer(self, command: str) -> str:
        if command == "AT":
            return "OK"
        if command == "AT+VERSION":
            return "OKlinvorV1.8"
        if command.startswith("AT+NAME"):
            self.name = command[7:27]
            return "OKsetname"
        if re.fullmatch(r"AT\+PIN\d{4}", command):
            self.pin = command[6:]
            return "OKsetPIN"
        if re.fullmatch(r"AT\+BAUD[4-8]", command):
            self.baud = self.data_baud = self.bauds[command[7]]
            return f"OK{self.baud}"
        return ""


class Hc06New(SimulatedModule):
    """Firmware 3.0-20170609: line ends, a colon, and a PIN in quotes; the new speed at once."""

    def __init__(self, baud: int = 9600) -> None:
        super().__init__(baud)
        self.name = "HC-06"

    def answer(self, command: str) -> str:
        if command == "AT":
            return "OK\r\n"
        if command == "AT+VERSION":
            return "VERSION:3.0-20170609\r\nOK\r\n"
        if command.startswith("AT+NAME:"):
            self.name = command[8:]
            return "OK\r\n"
        if re.fullmatch(r'AT\+PSWD:"\d{4}"', command):
            self.pin = command[9:13]
            return "OK\r\n"
        if re.fullmatch(r"AT\+UART=\d+,0,0", command):
            self.baud = self.data_baud = int(command[8:].split(",")[0])
            return "OK\r\n"
        return "ERROR:(0)\r\n"


class Hm10(SimulatedModule):
    """No line ends; a speed counts from the next restart on; 12 letters; PINs of 6 digits."""

    ends_lines = False
    bauds: Mapping[str, int] = {"0": 9600, "1": 19200, "2": 38400, "3": 57600, "4": 115200}

    def __init__(self, baud: int = 9600) -> None:
        super().__init__(baud)
        self.name, self.pin = "HMSoft", "000000"

    def answer(self, command: str) -> str:
        if command == "AT":
            return "OK"
        if command == "AT+VERR?":
            return "HMSoft V540"
        if command == "AT+RESET":
            self.baud = self.data_baud
            return "OK+RESET"
        if command == "AT+NAME?":
            return f"OK+NAME:{self.name}"
        if command == "AT+PASS?":
            return f"OK+Get:{self.pin}"
        if command == "AT+BAUD?":
            return "OK+Get:" + next(k for k, baud in self.bauds.items() if baud == self.data_baud)
        if command.startswith("AT+NAME"):
            self.name = command[7:19]
            return f"OK+Set:{self.name}"
        if re.fullmatch(r"AT\+PASS\d{6}", command):
            self.pin = command[7:]
            return f"OK+Set:{self.pin}"
        if re.fullmatch(r"AT\+BAUD[0-4]", command):
            self.data_baud = self.bauds[command[7]]
            return f"OK+Set:{command[7]}"
        return ""


class Cc41(SimulatedModule):
    """A clone of the HM-10: line ends, other answers, and other numbers for the same speeds."""

    version = "Firmware V3.0.6,Bluetooth V4.0 LE"
    bauds: Mapping[str, int] = Hc06.bauds

    def __init__(self, baud: int = 9600) -> None:
        super().__init__(baud)
        self.name, self.pin = "BT05", "123456"

    def answer(self, command: str) -> str:
        number = next(k for k, baud in self.bauds.items() if baud == self.data_baud)
        if command == "AT":
            return "OK\r\n"
        if command == "AT+VERSION":
            return f"+VERSION={self.version}\r\n"
        if command == "AT+RESET":
            self.baud = self.data_baud
            return "+RESET\r\nOK\r\n"
        for key, value in (("NAME", self.name), ("PIN", self.pin), ("BAUD", number)):
            if command == f"AT+{key}":
                return f"+{key}={value}\r\n"
        if command.startswith("AT+NAME"):
            self.name = command[7:]
            return f"+NAME={self.name}\r\nOK\r\n"
        if re.fullmatch(r"AT\+PIN\d{6}", command):
            self.pin = command[6:]
            return f"+PIN={self.pin}\r\nOK\r\n"
        if command.startswith("AT+BAUD") and command[7:] in self.bauds:
            self.data_baud = self.bauds[command[7:]]
            return f"+BAUD={command[7:]}\r\nOK\r\n"
        return "ERROR=101\r\n"


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
