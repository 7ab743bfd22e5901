"""Output of foreign boards: recordings, and stand-ins that replay them.

A recording is put together from the sources and documents that `link/foreign.py` names.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tests.support.simulated_ends import UnpoweredEnd

ROM = (
    b"ets Jul 29 2019 12:21:46\r\n\r\n"
    b"rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n"
    b"configsip: 0, SPIWP:0xee\r\n"
    b"clk_drv:0x00,q_drv:0x00,d_drv:0x00,cs0_drv:0x00,hd_drv:0x00,wp_drv:0x00\r\n"
    b"mode:DIO, clock div:1\r\n"
    b"load:0x3fff0030,len:1344\r\nload:0x40078000,len:13964\r\nentry 0x400805f0\r\n"
)
BROWNOUT = ROM + b"\r\nBrownout detector was triggered\r\n\r\n"
C3_ROM = (
    b"ESP-ROM:esp32c3-api1-20210207\r\nBuild:Feb  7 2021\r\n"
    b"rst:0x1 (POWERON),boot:0xc (SPI_FAST_FLASH_BOOT)\r\nSPIWP:0xee\r\n"
    b"mode:DIO, clock div:1\r\nload:0x3fcd5820,len:0x1714\r\nentry 0x403cc710\r\n"
)
C3_BROWNOUT = C3_ROM.replace(b"0x1 (POWERON)", b"0xf (BROWNOUT_RST)")
C3_DOWNLOAD = (
    b"ESP-ROM:esp32c3-api1-20210207\r\nBuild:Feb  7 2021\r\n"
    b"rst:0x1 (POWERON),boot:0x4 (DOWNLOAD(USB/UART0/1))\r\nwaiting for download\r\n"
)
EMPTY_FLASH = (
    b"rst:0x10 (RTCWDT_RTC_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n"
    b"invalid header: 0xffffffff\r\ninvalid header: 0xffffffff\r\n"
)
MICROPYTHON = (
    b"MicroPython v1.20.0 on 2023-04-26; ESP32 module with ESP32\r\n"
    b'Type "help()" for more information.\r\n>>> '
)
CIRCUITPYTHON = (
    b"\r\nAdafruit CircuitPython 8.2.6 on 2023-09-12; ESP32 Devkit V1 with ESP32\r\n>>> "
)
SNEK = b"\x11Welcome to Snek 1.10\r\n> "
AT_VERSION = (
    b"AT+GMR\r\nAT version:2.2.0.0-dev(ca41ec4 - ESP32 - Sep 16 2020 11:28:17)\r\n"
    b"SDK version:v4.0.1-193-ge7ac221b4\r\ncompile time(98b95fc):Oct 29 2020 11:23:25\r\n"
    b"Bin version:2.1.0(MINI-1)\r\n\r\nOK\r\n"
)
FIRMATA_VERSION = b"\xf9\x02\x05"
FIRMATA_NAME = (
    b"\xf0\x79\x02\x05" + b"".join(bytes([byte, 0]) for byte in b"StandardFirmata.ino") + b"\xf7"
)
FIRMATA = FIRMATA_VERSION + FIRMATA_NAME
MBOT_START = b"Version: 06.01.009\r\n"
MBOT_VERSION = b"\xff\x55\x01\x04\x0906.01.009\r\n"


class Recording(NamedTuple):
    """The output of a board, with the expected row of `link/foreign.py` and the line."""

    name: str
    data: bytes
    shown_text: str


RECORDINGS: Mapping[str, Recording] = {
    "firmata": Recording("firmata", FIRMATA, "StandardFirmata.ino 2.5"),
    "mbot": Recording("mbot", MBOT_START + MBOT_VERSION, "Version: 06.01.009"),
    "mbot asked": Recording("mbot", MBOT_VERSION, "06.01.009"),
    "mbot done": Recording("mbot", b"\xff\x55\r\n", "FF 55 0D 0A"),
    "mbot distance": Recording(
        "mbot", b"\xff\x55\x00\x02\x00\x00\x0a\x42\r\n", "FF 55 00 02 00 00 0A 42 0D 0A"
    ),
    "snek": Recording("snek", SNEK, "Welcome to Snek 1.10"),
    "snek asked": Recording("snek", b"\r\n> \x14", ">"),
    "micropython": Recording(
        "micropython", MICROPYTHON, "MicroPython v1.20.0 on 2023-04-26; ESP32 module with ESP32"
    ),
    "raw repl": Recording(
        "micropython", b"raw REPL; CTRL-B to exit\r\n>", "raw REPL; CTRL-B to exit"
    ),
    "circuitpython": Recording(
        "micropython", CIRCUITPYTHON, "Adafruit CircuitPython 8.2.6 on 2023-09-12; ESP32 Devkit V1 "
    ),
    "micropython on esp32": Recording(
        "micropython", ROM + MICROPYTHON,
        "MicroPython v1.20.0 on 2023-04-26; ESP32 module with ESP32",
    ),
    "esp32": Recording(
        "esp32", ROM, "rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)"
    ),
    "esp32c3": Recording("esp32", C3_ROM, "rst:0x1 (POWERON),boot:0xc (SPI_FAST_FLASH_BOOT)"),
    "brownout": Recording("esp32_brownout", BROWNOUT, "Brownout detector was triggered"),
    "brownout c3": Recording(
        "esp32_brownout", C3_BROWNOUT, "rst:0xf (BROWNOUT_RST),boot:0xc (SPI_FAST_FLASH_BOOT)"
    ),
    "download": Recording(
        "esp32_download", C3_DOWNLOAD, "rst:0x1 (POWERON),boot:0x4 (DOWNLOAD(USB/UART0/1))"
    ),
    "empty": Recording("esp32_empty", EMPTY_FLASH, "invalid header: 0xffffffff"),
    "at": Recording(
        "at_firmware", AT_VERSION, "AT version:2.2.0.0-dev(ca41ec4 - ESP32 - Sep 16 2020 11:28:1"
    ),
    "at on esp32": Recording(
        "at_firmware", ROM + b"\r\nready\r\n" + AT_VERSION,
        "AT version:2.2.0.0-dev(ca41ec4 - ESP32 - Sep 16 2020 11:28:1",
    ),
}  # fmt: skip


class Board(UnpoweredEnd):
    """A board that starts when its port is opened, and takes `boot_ms` for that.

    `start_bytes` is its output then, repeated every `repeat_ms`.
    """

    start_bytes = b""
    boot_ms = 300
    repeat_ms = 0

    def __init__(self, baud: int) -> None:
        super().__init__(baud)
        self._elapsed_ms = 0
        self._line = b""

    def restart(self) -> None:
        self._elapsed_ms = 0
        self._line = b""

    def answer(self, data: bytes) -> bytes:
        self._elapsed_ms += 1
        if self._elapsed_ms < self.boot_ms:
            return b""
        if self._elapsed_ms == self.boot_ms:
            return self.start_bytes
        if self.repeat_ms and (self._elapsed_ms - self.boot_ms) % self.repeat_ms == 0:
            return self.start_bytes
        return b"".join(self.take(byte) for byte in data)

    def take(self, byte: int) -> bytes:
        """Return the answer to a byte."""
        return b""


class FirmataBoard(Board):
    """Answers 0xF9, and the question for its name, outside of a sysex or as one."""

    start_bytes, boot_ms = FIRMATA, 2200  # its lamp first blinks the version
    _sysex: bytes | None = None

    def take(self, byte: int) -> bytes:
        if self._sysex is not None:
            if byte != 0xF7:
                self._sysex += bytes([byte])
                return b""
            sysex_bytes, self._sysex = self._sysex, None
            return FIRMATA_NAME if sysex_bytes == b"\x79" else b""
        if byte == 0xF0:
            self._sysex = b""
        return FIRMATA_VERSION if byte == 0xF9 else b""


class MbotBoard(Board):
    """Answers 0xFF 0x55, a length, and so many bytes."""

    start_bytes, boot_ms = MBOT_START, 1300

    def take(self, byte: int) -> bytes:
        self._line += bytes([byte])
        offset = self._line.find(b"\xff\x55")
        if offset < 0:
            self._line = self._line[-1:]
            return b""
        frame = self._line[offset:]
        if len(frame) < 3 or len(frame) < 3 + frame[2]:
            return b""
        self._line = b""
        if frame[4:6] == b"\x01\x00":
            return b"\xff\x55" + frame[3:4] + MBOT_VERSION[3:]
        return b"\xff\x55\r\n"


class SnekBoard(Board):
    """Says each printable character again, and prompts; returns Ctrl-T at once."""

    start_bytes, boot_ms = SNEK, 100

    def take(self, byte: int) -> bytes:
        if byte == 0x14:
            return b"\x14"
        if byte == 0x0A:
            return b"\r\n> "
        return bytes([byte]) if 0x20 <= byte < 0x7F or byte >= 0x80 else b""


class PythonBoard(Board):
    """A MicroPython at its prompt: Ctrl-A leads to the raw prompt, Ctrl-B back."""

    start_bytes, boot_ms = ROM + MICROPYTHON, 400
    _is_raw = False

    def take(self, byte: int) -> bytes:
        if byte == 0x01 and not self._line:
            self._is_raw = True
            return b"raw REPL; CTRL-B to exit\r\n>"
        if byte == 0x02 and (self._is_raw or not self._line):
            self._is_raw, self._line = False, b""
            return b"\r\n" + MICROPYTHON
        if self._is_raw:
            return b""
        if byte in b"\r\n":
            line, self._line = self._line, b""
            reply = b"Traceback (most recent call last):\r\nSyntaxError: invalid syntax\r\n"
            return b"\r\n" + reply * bool(line) + b">>> "
        if 0x20 <= byte < 0x7F:
            self._line += bytes([byte])
            return bytes([byte])
        return b""


class SilentPython(PythonBoard):
    """A Python board with a running program: it does not answer."""

    def take(self, byte: int) -> bytes:
        return b""


class AtBoard(Board):
    """Espressif's AT firmware: it says a command again, and then does it."""

    start_bytes = ROM + b"\r\nready\r\n"

    def take(self, byte: int) -> bytes:
        self._line += bytes([byte])
        if not self._line.endswith(b"\r\n"):
            return bytes([byte])
        command, self._line = self._line.strip(), b""
        reply = bytes([byte])
        if command == b"AT":
            return reply + b"\r\nOK\r\n"
        return reply + (AT_VERSION[8:] if command == b"AT+GMR" else b"\r\nERROR\r\n")


class Esp32Board(Board):
    start_bytes, boot_ms = ROM, 20


class BrownoutBoard(Board):
    start_bytes, boot_ms, repeat_ms = BROWNOUT, 20, 700


class DownloadBoard(Board):
    start_bytes, boot_ms = C3_DOWNLOAD, 20


class EmptyBoard(Board):
    """A board without a program, which its watchdog restarts repeatedly."""

    start_bytes, boot_ms, repeat_ms = EMPTY_FLASH, 20, 300


class EchoSketch(Board):
    """Sends back each byte at its own speed."""

    boot_ms = 100

    def take(self, byte: int) -> bytes:
        return bytes([byte])


class LineEchoSketch(Board):
    """Prints the received text after a second of silence: `You said: …`."""

    start_bytes, boot_ms = b"Ready\r\n", 100
    _quiet_ms = 0

    def answer(self, data: bytes) -> bytes:
        self._line += data
        self._quiet_ms = 0 if data else self._quiet_ms + 1
        reply = super().answer(b"")
        if self._line and self._quiet_ms >= 100:
            reply += b"You said: " + self._line + b"\r\n"
            self._line = b""
        return reply
