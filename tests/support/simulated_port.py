"""Ports in the time of their device: a process that opens one never waits.

The port itself is real: it is opened, locked and pulled out as any other.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING
from unittest import mock

from tiniscript.cli.robot import recorder, run_monitor
from tiniscript.doctor import examination
from tiniscript.link.transports import serial as serial_transport

if TYPE_CHECKING:
    import serial

STRIDE_MS = 5  # longest time between two looks at an idle robot


class PtyPort:
    """A pseudo-terminal with a device; a computer opens `port`.

    While `simulated` is set, its own thread leaves its time alone.
    """

    def __init__(self) -> None:
        import pty
        import tty

        self.our_end, self._device_end = pty.openpty()
        tty.setraw(self._device_end)
        self.port = os.ttyname(self._device_end)
        self.simulated: SimulatedPort | None = None
        self.received = b""  # all data received by the port
        self.damages = 0  # one of this many bytes is damaged; 0 means none
        self._passed_count = 0  # bytes, through the noise
        self._lock = threading.Lock()

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        """Let time pass, with received bytes at its beginning; return the bytes sent meanwhile."""
        raise NotImplementedError

    def _through_noise(self, data: bytes) -> bytes:
        noisy_data = bytearray(data)
        for k in range(len(noisy_data)):
            self._passed_count += 1
            if self.damages and self._passed_count % self.damages == 0:
                noisy_data[k] ^= 0x24
        return bytes(noisy_data)

    def _close(self) -> None:
        for end in (self.our_end, self._device_end):
            os.close(end)


class SimulatedPort:
    """An open port of pyserial: time advances only while it is read."""

    def __init__(self, end: PtyPort, device: serial.SerialBase) -> None:
        self._end, self._device = end, device
        self.timeout: float = device.timeout
        self._now_ms = int(time.monotonic() * 1000)
        self._to_device, self._from_device = b"", b""
        end.simulated = self

    def now_ms(self) -> int:
        return self._now_ms

    def write(self, data: bytes) -> None:
        self._to_device += data

    def read(self, size: int = 1) -> bytes:
        left_ms = int(self.timeout * 1000)
        self._from_device += self._device.read(
            self._device.in_waiting
        )  # another process writes there
        while not self._from_device and left_ms > 0:
            stride = min(left_ms, STRIDE_MS)
            data, self._to_device = self._to_device, b""
            self._from_device += self._end.advance_ms(stride, data)
            self._now_ms += stride
            left_ms -= stride
        taken_bytes, self._from_device = self._from_device[:size], self._from_device[size:]
        return taken_bytes

    @property
    def in_waiting(self) -> int:
        return len(self._from_device)

    @property
    def baudrate(self) -> int:
        return int(self._device.baudrate)

    @baudrate.setter
    def baudrate(self, baud: int) -> None:
        self._device.baudrate = baud

    def reset_input_buffer(self) -> None:
        self._from_device = b""

    def close(self) -> None:
        self._device.close()
        self._end.simulated = None


@contextmanager
def simulate(*pty_ports: PtyPort) -> Iterator[None]:
    """Within it, ports opened by this process use the time of their other end."""
    actual = serial_transport._open
    by_port = {end.port: end for end in pty_ports}

    def open_port(port: str, baud: int) -> serial.SerialBase | SimulatedPort:
        device = actual(port, baud)
        return SimulatedPort(by_port[port], device) if port in by_port else device

    def now_s() -> float:
        port = pty_ports[0].simulated
        return port.now_ms() / 1000 if port else time.monotonic()

    with ExitStack() as stack:
        stack.enter_context(mock.patch.object(serial_transport, "_open", open_port))
        if len(pty_ports) == 1:
            for module in (recorder, run_monitor):
                stack.enter_context(mock.patch.object(module, "monotonic", now_s))
            stack.enter_context(mock.patch.object(examination, "perf_counter", now_s))
        yield
