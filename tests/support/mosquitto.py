"""An MQTT broker, Debian's Mosquitto as it is, on 127.0.0.1, and a robot's client at it."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import time
from contextlib import suppress
from pathlib import Path

from tests.machines.esp32 import Esp32Robot
from tests.support.needs import need
from tests.support.waiting import until
from tiniscript.link import wifi
from tiniscript.link.transports.broker import Access, Broker, BrokerPort

PROGRAM = shutil.which("mosquitto") or next(iter(Path("/usr/sbin").glob("mosquitto")), None)
LOCAL_ADDRESS = bytes((127, 0, 0, 1))
STEP_S = 0.0005  # one millisecond of the chip; the broker runs in real time


class Mosquitto:
    """A broker. With `password`, it admits only `user`."""

    def __init__(
        self, folder: Path, user: str = "", password: str = "", extra_lines: str = ""
    ) -> None:
        need("" if PROGRAM else "needs the broker mosquitto")
        assert PROGRAM
        self.clients: list[Broker] = []
        lines = ["persistence false", f"user {_user_name()}", extra_lines]
        if user:
            passwords = folder / "passwords"
            passwords.touch(mode=0o600)
            command = ["mosquitto_passwd", "-b", str(passwords), user, password]
            subprocess.run(command, check=True, capture_output=True)
            lines += ["allow_anonymous false", f"password_file {passwords}"]
        else:
            lines.append("allow_anonymous true")
        for _ in range(5):  # another process may take the port in between
            self.port = free_port()
            self._rules = folder / f"mosquitto-{self.port}.conf"
            rows = [f"listener {self.port} 127.0.0.1", *lines, ""]
            self._rules.write_text("\n".join(rows), encoding="utf-8")
            with suppress(OSError):
                self.start()
                return
        raise AssertionError("the broker does not begin")

    def start(self) -> None:
        """Start the broker. Raises OSError if it ends, for example because the port is in use."""
        self.process = subprocess.Popen(
            [str(PROGRAM), "-c", str(self._rules)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        until(self._answers, "the broker has begun")

    def _answers(self) -> bool:
        if self.process.poll() is not None:
            raise OSError(f"mosquitto ends: {self.process.returncode}")
        with suppress(OSError):
            socket.create_connection(("127.0.0.1", self.port), 1).close()
            return self.process.poll() is None  # otherwise the port belongs to another process
        return False

    def stall(self, is_stalled: bool = True) -> None:
        self.process.send_signal(signal.SIGSTOP if is_stalled else signal.SIGCONT)

    def kill(self) -> None:
        self.stall(False)
        self.process.kill()
        self.process.wait()

    def settings(
        self, group: str = "aula", user: str = "", password: str = ""
    ) -> wifi.BrokerSettings:
        return wifi.BrokerSettings(
            LOCAL_ADDRESS, self.port, group, user.encode(), password.encode()
        )

    def connect_client(self, access: Access | None = None) -> Broker:
        """Return a connection of its own, until `part`."""
        self.clients.append(Broker("127.0.0.1", self.port, access or Access()))
        return self.clients[-1]

    def part(self) -> None:
        """Close the connections that tests have made."""
        while self.clients:
            self.clients.pop().close()


class AtBroker:
    """A robot's client at a broker, as an `End` of `esp32_radio`."""

    def __init__(self, robot: Esp32Robot, broker: Broker, group: str = "aula") -> None:
        self.port: BrokerPort = broker.port_of(group, f"{ID:08x}")
        self.has_ended = False

    def send(self, data: bytes) -> None:
        try:
            self.port.write(data)
        except OSError:
            self.has_ended = True

    def take(self) -> bytes:
        time.sleep(STEP_S)
        self.port.cancel_read()  # this does not wait
        try:
            return self.port.read(65_536)
        except OSError:
            self.has_ended = True
            return b""

    def leave(self) -> None:
        self.port.close()


ID = 0x12345678  # id of a simulated chip: its first random number


def free_port() -> int:
    with socket.socket() as connection:
        connection.bind(("127.0.0.1", 0))
        return int(connection.getsockname()[1])


def _user_name() -> str:
    import pwd

    return pwd.getpwuid(os.getuid()).pw_name
