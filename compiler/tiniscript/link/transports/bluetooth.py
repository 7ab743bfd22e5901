"""A robot's port over Bluetooth LE: the Nordic UART service, or that of an HM-10.

`BluetoothPort` has the methods of a serial port that a `PortConnection` uses. Knows bleak;
importing this fails without it. `bluetooth_search` handles scan results. Knows no robot and no
sentences.
"""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple, TypeVar

from bleak import BleakClient
from bleak.backends.characteristic import BleakGATTCharacteristic
from bleak.backends.device import BLEDevice
from bleak.exc import BleakDeviceNotFoundError, BleakError

from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import BLE, canonical_name, name_in
from tiniscript.link.transports import WRITE_S
from tiniscript.link.transports import bluetooth_search as search
from tiniscript.link.transports.event_loop import EventLoop, shared_loop
from tiniscript.link.transports.pushed import END_REASON, PushedTransport

CONNECT_S = 15.0
QUEUE_S = 60.0  # timeout of a queued operation, including its wait for other connections
CLOSE_S = 5.0  # BlueZ takes 2 s
UART_BITS = 10  # bits of a byte, including start and stop
MIN_WRITE_BYTES = 20  # bytes of a write before more is negotiated

T = TypeVar("T")


class UartService(NamedTuple):
    """A way of sending bytes over Bluetooth LE.

    `is_paced`: the module loses bytes that arrive faster than its UART passes them on, and accepts
    at most MIN_WRITE_BYTES in one write, whatever was negotiated.
    """

    service_uuid: str
    write_uuid: str
    notify_uuid: str
    is_paced: bool


UART_SERVICES = (
    UartService(
        search.NORDIC_UART,
        "6e400002-b5a3-f393-e0a9-e50e24dcca9e",
        "6e400003-b5a3-f393-e0a9-e50e24dcca9e",
        is_paced=False,
    ),
    UartService(
        search.HM10,
        "0000ffe1-0000-1000-8000-00805f9b34fb",
        "0000ffe1-0000-1000-8000-00805f9b34fb",
        is_paced=True,
    ),
)
_found_devices: dict[str, BLEDevice] = {}  # devices found by a search, by address


def resolve(port: str) -> str:
    """Return the port of the device that a name means: `ble://` and its address.

    Raises PortError, at the latest after search.SEARCH_S.
    """
    loop = shared_loop()
    device = _run(loop, search.find_device(name_in(port)), search.SEARCH_S + search.LEAVE_S * 2)
    address = canonical_name(device.address)
    _found_devices[address] = device
    return BLE + address


def list_robots() -> list[search.SeenDevice]:
    """Return the robots in reach. Raises PortError."""
    timeout_s = search.LIST_S + search.LEAVE_S * 2
    seen_devices = _run(shared_loop(), search.find_robots(), timeout_s)
    _found_devices.update(
        {canonical_name(seen_device.address): seen_device.device for seen_device in seen_devices}
    )
    return seen_devices


def open_port(port: str, baud: int, timeout_s: float) -> BluetoothPort:
    """Connect to a device. Raises PortError, at the latest after a search and QUEUE_S.

    `baud` is the speed of the UART behind an HM-10. Radios take longer than `timeout_s`.
    """
    address = name_in(port)
    if address not in _found_devices:
        address = name_in(resolve(port))
    bluetooth_port = BluetoothPort(shared_loop(), baud)
    bluetooth_port.connect(_found_devices.pop(address))
    return bluetooth_port


class BluetoothPort(PushedTransport):
    """A connection to a device. `read`, `write`, `in_waiting`, `cancel_read` and `close` are as in
    pyserial; where the connection has ended they raise OSError."""

    def __init__(self, loop: EventLoop, baud: int) -> None:
        super().__init__()
        self._loop = loop
        self._byte_s = UART_BITS / baud
        self._client: BleakClient | None = None
        self._write_characteristic: BleakGATTCharacteristic | None = None
        self._is_paced = False
        self._ready_s = 0.0  # when the module has room again, in the loop's time

    def connect(self, device: BLEDevice) -> None:
        """Raises PortError."""
        self._client = BleakClient(device, lambda _: self.end(END_REASON), timeout=CONNECT_S)
        try:
            _run(self._loop, self._connect(self._client), QUEUE_S)
        except BaseException:
            self.close()
            raise

    def write(self, data: bytes) -> None:
        """Send bytes in pieces. Pieces that do not get through in time are lost."""
        if self._end_reason:
            raise OSError(self._end_reason)
        timeout_s = WRITE_S + len(data) * self._byte_s
        with suppress(TimeoutError, asyncio.TimeoutError, BleakError, OSError, EOFError):
            self._loop.run(self._send(data), timeout_s)
        if self._end_reason:
            raise OSError(self._end_reason)

    def close(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            with suppress(Exception):  # the connection may already have ended
                self._loop.run(client.disconnect(), CLOSE_S)

    # -- in the loop ------------------------------------------------------------------------------

    async def _connect(self, client: BleakClient) -> None:
        async with _connect_lock():  # BlueZ fails where two connections are made at once
            await asyncio.wait_for(client.connect(), CONNECT_S)
        for uart_service in UART_SERVICES:
            service = next(
                (
                    candidate
                    for candidate in client.services
                    if candidate.uuid == uart_service.service_uuid
                ),
                None,
            )
            if service is None:
                continue
            write_characteristic = service.get_characteristic(uart_service.write_uuid)
            notify_characteristic = service.get_characteristic(uart_service.notify_uuid)
            if write_characteristic is None or notify_characteristic is None:
                continue
            if not any(
                property.startswith("write") for property in write_characteristic.properties
            ):
                continue
            self._write_characteristic, self._is_paced = write_characteristic, uart_service.is_paced
            await client.start_notify(
                notify_characteristic, lambda _, data: self.add_received(data)
            )
            return
        raise PortError(errors.NO_ROBOT)

    async def _send(self, data: bytes) -> None:
        assert self._client is not None and self._write_characteristic is not None
        time = asyncio.get_running_loop().time
        needs_response = "write-without-response" not in self._write_characteristic.properties
        while data:
            size = MIN_WRITE_BYTES
            if not self._is_paced:
                size = max(
                    MIN_WRITE_BYTES, self._write_characteristic.max_write_without_response_size
                )
            piece, data = data[:size], data[size:]
            await asyncio.sleep(self._ready_s - time())
            try:
                await self._client.write_gatt_char(
                    self._write_characteristic, piece, response=needs_response
                )
            except Exception as error:
                if not self._client.is_connected:
                    self.end(str(error))
                raise
            if self._is_paced:
                self._ready_s = time() + len(piece) * self._byte_s


def _run(loop: EventLoop, work: Coroutine[Any, Any, T], timeout_s: float) -> T:
    """Run a coroutine of bleak. Raises PortError for all that can go wrong there."""
    try:
        return loop.run(work, timeout_s)
    except PortError:
        raise
    except (TimeoutError, asyncio.TimeoutError):  # two of them, in Python 3.10
        raise PortError(errors.SLOW) from None
    except BleakDeviceNotFoundError as failure:
        raise PortError(errors.UNREACHABLE, str(failure)) from None
    except Exception as failure:  # bleak, D-Bus and the system each raise their own exceptions
        raise PortError(search.reason_of(failure), str(failure)) from None


@cache
def _connect_lock() -> asyncio.Lock:
    """Return the lock of all that connect; call it in the loop."""
    return asyncio.Lock()
