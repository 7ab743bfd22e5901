"""BlueZ as a program sees it: `org.bluez` on a private D-Bus, with peripherals that tests make.

bleak is used as it ships, and finds this bus by DBUS_SYSTEM_BUS_ADDRESS. `ble_robot` implements the
peripherals. As in BlueZ, a connection outlives the program that made it.
"""

from __future__ import annotations

import asyncio
import shutil
import subprocess
import threading
from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Annotated, Any

import pytest

if find_spec("dbus_fast") is None:
    pytest.skip("no dbus_fast: pip install dbus-fast", allow_module_level=True)

from dbus_fast import BusType, DBusError, PropertyAccess
from dbus_fast.aio import MessageBus
from dbus_fast.annotations import DBusBytes, DBusDict, DBusSignature
from dbus_fast.service import ServiceInterface, dbus_method, dbus_property

from tests.support.needs import need

if TYPE_CHECKING:
    from tests.support.ble_robot import Peripheral

ADAPTER = "/org/bluez/hci0"
ADVERTISING_INTERVAL_S = 0.05
STEP_S = 10.0  # timeout of a step in the bus's thread
_Nothing = Annotated[None, DBusSignature("")]


def read_only(name: str, signature: str, tell: Callable[[Any], object]) -> property:
    """Return a property that can be read, of this name and with the signature of its type."""

    def read(self: Any) -> object:
        return tell(self)

    read.__name__ = name
    read.__annotations__["return"] = signature
    return dbus_property(access=PropertyAccess.READ)(read)


class Adapter(ServiceInterface):
    def __init__(self, bluez: FakeBluez) -> None:
        super().__init__("org.bluez.Adapter1")
        self.bluez = bluez
        self.is_powered = True
        self.rounds = 0
        self.is_scanning = False

    @dbus_method()
    def SetDiscoveryFilter(self, _: DBusDict) -> _Nothing:  # noqa: N802 - BlueZ's names
        pass

    @dbus_method()
    def StartDiscovery(self) -> _Nothing:  # noqa: N802
        if not self.is_powered:
            raise DBusError("org.bluez.Error.NotReady", "Resource Not Ready")
        self.is_scanning = True
        self.rounds = 0  # number of advertisements in this scan
        self.bluez.advertise()

    @dbus_method()
    def StopDiscovery(self) -> _Nothing:  # noqa: N802
        self.is_scanning = False

    Address = read_only("Address", "s", lambda self: "00:11:22:33:44:55")
    Roles = read_only("Roles", "as", lambda self: ["central"])
    Powered = read_only("Powered", "b", lambda self: self.is_powered)
    Discovering = read_only("Discovering", "b", lambda self: self.is_scanning)


class Device(ServiceInterface):
    """A peripheral as BlueZ shows it."""

    def __init__(self, bluez: FakeBluez, peripheral: Peripheral) -> None:
        super().__init__("org.bluez.Device1")
        self.bluez = bluez
        self.peripheral = peripheral
        self.path = f"{ADAPTER}/dev_{peripheral.address.replace(':', '_')}"
        self.is_connected = self.is_resolved = False
        self.signal = -50
        self.notifies: Characteristic | None = None
        self._gatt_paths: list[str] = []  # the paths of its service and characteristics

    def advertise(self) -> None:
        self.signal = -50 if self.signal != -50 else -51
        self.emit_properties_changed({"RSSI": self.signal})

    def tell(self, data: bytes) -> None:
        """Send a notification, if somebody has asked for them."""
        if self.notifies is not None and self.notifies.is_notifying:
            self.notifies.value = data
            self.notifies.emit_properties_changed({"Value": data})

    def part(self) -> None:
        """End the connection."""
        if not self.is_connected:
            return
        self.is_connected = self.is_resolved = False
        self.emit_properties_changed({"Connected": False, "ServicesResolved": False})
        for path in reversed(self._gatt_paths):
            self.bluez.bus.unexport(path)
        self._gatt_paths = []
        self.notifies = None
        self.peripheral.part()

    @dbus_method()
    async def Connect(self) -> _Nothing:  # noqa: N802
        if self.peripheral.failing_stage == "connect":
            raise DBusError("org.bluez.Error.Failed", "le-connection-abort-by-remote")
        self.is_connected = True
        self.emit_properties_changed({"Connected": True})
        self.peripheral.connections += 1
        if self.peripheral.failing_stage == "services":
            self.part()
            return
        self._gatt_paths = [f"{self.path}/service0010"]
        self.bluez.bus.export(self._gatt_paths[0], Service(self))
        for k, (uuid, flags) in enumerate(self.peripheral.characteristics):
            path = f"{self._gatt_paths[0]}/char{k:04x}"
            characteristic = Characteristic(self, uuid, flags)
            if "notify" in flags:
                self.notifies = characteristic
            self.bluez.bus.export(path, characteristic)
            self._gatt_paths.append(path)
        self.is_resolved = True
        self.emit_properties_changed({"ServicesResolved": True})

    @dbus_method()
    def Disconnect(self) -> _Nothing:  # noqa: N802
        self.part()

    Address = read_only("Address", "s", lambda self: self.peripheral.address)
    AddressType = read_only("AddressType", "s", lambda self: "public")
    Name = read_only("Name", "s", lambda self: self.peripheral.name)
    Alias = read_only("Alias", "s", lambda self: self.peripheral.name)
    Adapter = read_only("Adapter", "o", lambda self: ADAPTER)
    UUIDs = read_only("UUIDs", "as", lambda self: [self.peripheral.service])
    RSSI = read_only("RSSI", "n", lambda self: self.signal)
    Connected = read_only("Connected", "b", lambda self: self.is_connected)
    Paired = read_only("Paired", "b", lambda self: False)
    ServicesResolved = read_only("ServicesResolved", "b", lambda self: self.is_resolved)


class Service(ServiceInterface):
    def __init__(self, device: Device) -> None:
        super().__init__("org.bluez.GattService1")
        self.device = device

    UUID = read_only("UUID", "s", lambda self: self.device.peripheral.service)
    Device = read_only("Device", "o", lambda self: self.device.path)
    Primary = read_only("Primary", "b", lambda self: True)


class Characteristic(ServiceInterface):
    def __init__(self, device: Device, uuid: str, flags: list[str]) -> None:
        super().__init__("org.bluez.GattCharacteristic1")
        self.device = device
        self.uuid = uuid
        self.flags = flags
        self.value = b""
        self.is_notifying = False

    @dbus_method()
    async def WriteValue(self, value: DBusBytes, options: DBusDict) -> _Nothing:  # noqa: N802
        peripheral = self.device.peripheral
        kind = options["type"].value
        flag = "write" if kind == "request" else "write-without-response"
        if flag not in self.flags:
            raise DBusError("org.bluez.Error.NotSupported", "Operation is not supported")
        if len(value) > peripheral.mtu - 3:
            raise DBusError("org.bluez.Error.InvalidValueLength", "Invalid value length")
        peripheral.take(bytes(value), kind)
        if peripheral.is_over:
            self.device.part()

    @dbus_method()
    def StartNotify(self) -> _Nothing:  # noqa: N802
        if self.device.peripheral.failing_stage == "notify":
            self.device.part()
            return
        self.is_notifying = True
        self.emit_properties_changed({"Notifying": True})
        self.device.peripheral.begin()

    @dbus_method()
    def StopNotify(self) -> _Nothing:  # noqa: N802
        self.is_notifying = False

    UUID = read_only("UUID", "s", lambda self: self.uuid)
    Service = read_only("Service", "o", lambda self: f"{self.device.path}/service0010")
    Flags = read_only("Flags", "as", lambda self: self.flags)
    Value = read_only("Value", "ay", lambda self: self.value)
    Notifying = read_only("Notifying", "b", lambda self: self.is_notifying)
    MTU = read_only("MTU", "q", lambda self: self.device.peripheral.mtu)


class Root(ServiceInterface):
    """The root object, through which `/` lists all objects."""

    def __init__(self) -> None:
        super().__init__("org.tiniscript.Root")


class FakeBluez:
    """The bus with its objects, in a thread of its own; `address` is the bus's."""

    bus: MessageBus
    has_ended = False

    def __init__(self, has_bluez: bool = True, has_adapter: bool = True) -> None:
        need("" if shutil.which("dbus-daemon") else "no dbus-daemon: apt-get install dbus-daemon")
        self._daemon = subprocess.Popen(
            ["dbus-daemon", "--session", "--nofork", "--nosyslog", "--print-address"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self._daemon.stdout
        self.address = self._daemon.stdout.readline().strip()
        self.adapter = Adapter(self)
        self.devices: dict[str, Device] = {}
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self._thread.start()
        self.has_adapter = has_adapter
        if has_bluez:
            asyncio.run_coroutine_threadsafe(self._begin(), self.loop).result(STEP_S)

    def __enter__(self) -> FakeBluez:
        return self

    def __exit__(self, *_: object) -> None:
        self.vanish()
        assert self._daemon.stdout
        self._daemon.stdout.close()
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join(STEP_S)
        for device in self.devices.values():
            device.peripheral.clear_away()
        self.loop.close()

    def _leave(self) -> None:
        self.adapter.is_scanning = False
        for device in self.devices.values():
            if device.is_connected:
                device.is_connected = False
                device.peripheral.part()
        self.bus.disconnect()

    async def _begin(self) -> None:
        self.bus = await MessageBus(self.address, bus_type=BusType.SYSTEM).connect()
        self.bus.export("/", Root())
        if self.has_adapter:
            self.bus.export(ADAPTER, self.adapter)
        await self.bus.request_name("org.bluez")

    def do(self, function: Callable[[], Any]) -> None:
        """Do something in the bus's thread."""

        async def work() -> None:
            function()

        asyncio.run_coroutine_threadsafe(work(), self.loop).result(STEP_S)

    def add(self, peripheral: Peripheral) -> None:
        device = Device(self, peripheral)
        self.devices[peripheral.address] = device
        peripheral.tell = device.tell
        peripheral.loop = self.loop
        self.do(lambda: self.bus.export(device.path, device))

    def advertise(self) -> None:
        """Advertise peripherals while a program scans."""
        if not self.adapter.is_scanning:
            return
        self.adapter.rounds += 1
        for device in self.devices.values():
            is_late = device.peripheral.late_rounds > self.adapter.rounds
            if device.peripheral.is_on and not is_late and not device.is_connected:
                device.advertise()
        self.loop.call_later(ADVERTISING_INTERVAL_S, self.advertise)

    def part(self, peripheral: Peripheral) -> None:
        """End a peripheral's connection, as if it had moved out of range."""
        self.do(self.devices[peripheral.address].part)

    def power(self, is_on: bool) -> None:
        """Switch the adapter."""

        def switch() -> None:
            self.adapter.is_powered = is_on
            self.adapter.emit_properties_changed({"Powered": is_on})
            if not is_on:
                for device in self.devices.values():
                    device.part()

        self.do(switch)

    def unplug(self) -> None:
        """Pull the adapter out: its objects are gone."""

        def pull() -> None:
            for device in self.devices.values():
                device.part()
                self.bus.unexport(device.path)
            self.bus.unexport(ADAPTER)

        self.do(pull)

    def vanish(self) -> None:
        """End the D-Bus, and BlueZ with it."""
        if hasattr(self, "bus") and not self.has_ended:
            self.do(self._leave)
        self.has_ended = True
        self._daemon.terminate()
        self._daemon.wait()
