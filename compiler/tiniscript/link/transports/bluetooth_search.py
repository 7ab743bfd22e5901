"""The robots in reach of Bluetooth LE: finds one by its name or its address, or lists them.

All searches of a process share a scan, because BlueZ lets a program scan once at a time. A device's
own claims are unproven, so a name that two devices have is refused. Knows bleak. Its coroutines run
in the loop of `event_loop`.
"""

from __future__ import annotations

import asyncio
import sys
from contextlib import suppress
from functools import cache
from typing import NamedTuple

from bleak import BleakAdapter, BleakScanner
from bleak.backends.device import BLEDevice
from bleak.backends.scanner import AdvertisementData
from bleak.exc import BleakBluetoothNotAvailableError, BleakBluetoothNotAvailableReason

from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import canonical_name, is_device_address

NORDIC_UART = "6e400001-b5a3-f393-e0a9-e50e24dcca9e"
HM10 = "0000ffe0-0000-1000-8000-00805f9b34fb"
SERVICES = (NORDIC_UART, HM10)

SEARCH_S = 10.0  # time to search for one robot
# Wait after the first match: an HM-10 sends its name every 1.3 s, and two robots may share one.
LINGER_S = 1.5
LIST_S = 4.0  # time to list all robots
LEAVE_S = 3.0  # timeout of the end of a scan
MAX_NAMES_SHOWN = 8  # names in a sentence
MAX_DEVICES = 1000  # most devices that a scan keeps

_Unavailable = BleakBluetoothNotAvailableReason
_FORBIDDEN = (
    _Unavailable.DENIED_BY_USER,
    _Unavailable.DENIED_BY_SYSTEM,
    _Unavailable.DENIED_BY_UNKNOWN,
)


class SeenDevice(NamedTuple):
    """A device. `is_robot`: it offers a service by which robots are reached."""

    device: BLEDevice
    name: str
    is_robot: bool

    @property
    def address(self) -> str:
        return self.device.address


class _Scan:
    """The scan of this process, as long as somebody searches."""

    def __init__(self) -> None:
        self.seen_devices: dict[str, SeenDevice] = {}
        self.change_event = asyncio.Event()
        self._search_count = 0
        self._scanner: BleakScanner | None = None
        self._lock = asyncio.Lock()

    async def __aenter__(self) -> _Scan:
        async with self._lock:
            if self._search_count == 0:
                self.seen_devices = {}
                self._scanner = BleakScanner(self._notice_device)
                start = asyncio.ensure_future(self._scanner.start())
                try:
                    await asyncio.shield(start)  # a start under way cannot be cancelled
                    for device in await _connected_devices():
                        self._keep_device(SeenDevice(device, device.name or "", True))
                except BaseException:
                    await asyncio.wait([start])
                    await self._end()
                    raise
            self._search_count += 1
        return self

    async def __aexit__(self, *_: object) -> None:
        # A cancelled search leaves the scan, too; otherwise it would go on as long as the process.
        await asyncio.shield(self._leave())

    async def _leave(self) -> None:
        async with self._lock:
            self._search_count -= 1
            if self._search_count == 0:
                await self._end()

    async def _end(self) -> None:
        scanner, self._scanner = self._scanner, None
        if scanner is not None:
            with suppress(Exception):  # the adapter is lost: the scan is over
                await asyncio.wait_for(scanner.stop(), LEAVE_S)

    def _notice_device(self, device: BLEDevice, advertisement: AdvertisementData) -> None:
        services = {service_uuid.lower() for service_uuid in advertisement.service_uuids}
        earlier = self.seen_devices.get(device.address)
        name = advertisement.local_name or device.name or (earlier.name if earlier else "")
        is_robot = bool(services & set(SERVICES)) or (earlier is not None and earlier.is_robot)
        self._keep_device(SeenDevice(device, name, is_robot))

    def _keep_device(self, seen_device: SeenDevice) -> None:
        if seen_device.address in self.seen_devices or len(self.seen_devices) < MAX_DEVICES:
            self.seen_devices[seen_device.address] = seen_device
            self.change_event.set()
            self.change_event = asyncio.Event()


async def _connected_devices() -> list[BLEDevice]:
    """Return the robots that this computer is connected to: they are not seen in a scan.

    BlueZ keeps a connection when the program that made it is killed.
    """
    if sys.platform != "linux":
        return []
    adapter = await BleakAdapter.get()
    return list(await adapter.get_connected_devices(list(SERVICES)))


@cache
def _scan() -> _Scan:
    return _Scan()


async def find_device(name: str) -> BLEDevice:
    """Return the device with a name or an address. Raises PortError: none, or several."""
    is_address = is_device_address(name)
    loop = asyncio.get_running_loop()
    end_s = loop.time() + SEARCH_S
    matching_devices: dict[str, SeenDevice] = {}
    async with _scan() as scan:
        while loop.time() < end_s:
            change = scan.change_event
            is_first = not matching_devices
            matching_devices = {
                address: device
                for address, device in scan.seen_devices.items()
                if canonical_name(address if is_address else device.name) == name
            }
            if matching_devices and is_address:
                break
            if matching_devices and is_first:
                end_s = min(end_s, loop.time() + LINGER_S)
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(change.wait(), max(0.0, end_s - loop.time()))
        robots = sorted(
            {
                device.name or device.address
                for device in scan.seen_devices.values()
                if device.is_robot
            }
        )
    if not matching_devices:
        raise PortError(errors.NOT_FOUND, ", ".join(robots[:MAX_NAMES_SHOWN]))
    if len(matching_devices) > 1:
        raise PortError(
            errors.SEVERAL, ", ".join(f"ble://{match}" for match in sorted(matching_devices))
        )
    return next(iter(matching_devices.values())).device


async def find_robots() -> list[SeenDevice]:
    """Return all robots in reach, by name."""
    async with _scan() as scan:
        await asyncio.sleep(LIST_S)
        found_robots = [device for device in scan.seen_devices.values() if device.is_robot]
    return sorted(found_robots, key=lambda device: (device.name, device.address))


def reason_of(failure: Exception) -> str:
    """Return the reason why Bluetooth cannot be used, as a name in `errors`."""
    if isinstance(failure, BleakBluetoothNotAvailableError):
        if failure.reason in _FORBIDDEN:
            return errors.RADIO_FORBIDDEN
        return errors.RADIO_OFF
    text = str(failure)
    if isinstance(failure, PermissionError) or "AccessDenied" in text or "AuthFailed" in text:
        return errors.RADIO_FORBIDDEN
    if "NotReady" in text or "Resource Not Ready" in text:
        return errors.RADIO_OFF
    if isinstance(failure, (FileNotFoundError, ConnectionError)):
        return errors.RADIO_SERVICE
    if "ServiceUnknown" in text or "NoReply" in text or "NameHasNoOwner" in text:
        return errors.RADIO_SERVICE
    return errors.RADIO_BROKEN
