"""Facts of a computer: file trees of Linux, and program outputs of macOS and Windows.

Those of macOS and Windows were written after their papers, not recorded on such a system.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.fake_computer import FakeComputer
from tiniscript.doctor import computer, diagnosis
from tiniscript.doctor.computer import NONE, OFF, ON, UNKNOWN, Adapter, is_module, looks_wireless
from tiniscript.doctor.system import System


@pytest.fixture
def linux(tmp_path: Path) -> FakeComputer:
    return FakeComputer(tmp_path, "linux")


# -- Linux --------------------------------------------------------------------------------------


def test_a_bare_computer_is_inspected(linux: FakeComputer) -> None:
    assert diagnosis.inspect_computer(linux).adapters is None  # no sysfs: USB is unknown
    linux.usb("usb1", "1d6b", "0002")  # the computer's own hub
    computer = diagnosis.inspect_computer(linux)
    assert (computer.adapters, computer.bluetooth, computer.paired_names) == ((), NONE, ())
    assert computer.has_module is False


@pytest.mark.parametrize(
    ("vendor", "product", "chip"),
    [("1a86", "7523", "CH340"), ("0403", "6001", "FT232"), ("10C4", "EA60", "CP2102"),
     ("2341", "0043", "Arduino")],
)  # fmt: skip
def test_an_adapter_is_found_with_and_without_its_driver(
    linux: FakeComputer, vendor: str, product: str, chip: str
) -> None:
    linux.usb("1-1", vendor, product)
    (adapter,) = diagnosis.inspect_computer(linux).adapters or ()
    assert (adapter.chip, adapter.driver, adapter.has_port) == (chip, "", False)
    linux.usb("1-1", vendor, product, driver="some", tty="ttyUSB0")
    (adapter,) = diagnosis.inspect_computer(linux).adapters or ()
    assert adapter == Adapter(chip, adapter.wanted_driver, "some", True)


def test_an_adapter_taken_by_brltty_is_found(linux: FakeComputer) -> None:
    linux.usb("1-1", "1a86", "7523", driver="usbfs")
    linux.program(77, "brltty")
    computer = diagnosis.inspect_computer(linux)
    assert computer.adapters == (Adapter("CH340", "ch341", "usbfs", False),)
    assert computer.programs == {"brltty"}


def test_the_state_of_bluetooth_on_linux_is_found(linux: FakeComputer) -> None:
    linux.write("/sys/class/bluetooth/hci0/address", "00:11:22:33:44:55")
    linux.write("/sys/class/rfkill/rfkill1/type", "wlan")
    linux.write("/sys/class/rfkill/rfkill1/soft", "1")
    computer = diagnosis.inspect_computer(linux)
    assert (computer.bluetooth, computer.paired_names, computer.has_module) == (ON, None, None)
    linux.outputs["bluetoothctl", "paired-devices"] = "Device 98:D3:31:F5:00:01 HC-05\n"
    assert diagnosis.inspect_computer(linux).has_module is True
    linux.outputs["bluetoothctl", "devices", "Paired"] = (
        "Device 98:D3:31:F5:00:01 Telephone of Ana\nnonsense\n"
    )
    computer = diagnosis.inspect_computer(linux)
    assert (computer.paired_names, computer.has_module) == (("Telephone of Ana",), False)
    linux.write("/sys/class/rfkill/rfkill0/type", "bluetooth")
    linux.write("/sys/class/rfkill/rfkill0/hard", "1")
    assert diagnosis.inspect_computer(linux).bluetooth == OFF


def test_the_users_and_the_holder_of_a_port_are_named(linux: FakeComputer) -> None:
    port = "/dev/ttyUSB0"
    linux.write(port, "")
    linux.write("/etc/group", "root:x:0:\ndialout:x:20:ana\nbroken\n")
    linux.owners[port] = (20, False)
    assert diagnosis.port_access(linux, port) == computer.Access(False, "dialout", False, ())
    linux.user_name = "ana"
    assert diagnosis.port_access(linux, port).is_joined
    linux.owners[port] = (20, True)
    linux.group_numbers = {20}
    linux.program(5, "minicom", opened_port="/dev/ttyUSB1")
    assert diagnosis.port_access(linux, port) == computer.Access(True, "dialout", False, ())
    linux.program(6, "ModemManager", opened_port=port)
    assert diagnosis.port_access(linux, port).using_programs == ("ModemManager",)


def test_a_program_of_another_user_is_known_by_its_lock(linux: FakeComputer) -> None:
    port = "/dev/ttyUSB0"
    linux.write(port, "")
    linux.owners[port] = (20, True)
    linux.program(812, "screen")
    linux.write("/run/lock/LCK..ttyUSB0", "       812\n")
    assert diagnosis.port_access(linux, port).using_programs == ("screen",)
    linux.write("/run/lock/LCK..ttyUSB0", "999")  # process 999 has ended
    assert diagnosis.port_access(linux, port).using_programs == ()
    for other_port in ("socket://robot:7000", "/dev/ttyUSB9"):
        assert diagnosis.port_access(linux, other_port) == computer.FREE_ACCESS


# -- macOS and Windows --------------------------------------------------------------------------


def test_adapters_on_macos_are_found(tmp_path: Path) -> None:
    system = FakeComputer(tmp_path, "darwin")
    hub = {"_name": "Hub", "_items": [
        {"_name": "USB Serial", "vendor_id": "0x1a86", "product_id": "0x7523"},
        {"_name": "Mouse", "vendor_id": "apple_vendor_id", "product_id": "0x0304"}]}  # fmt: skip
    system.outputs["system_profiler", "SPUSBDataType", "-json"] = json.dumps(
        {"SPUSBDataType": [{"_name": "USB31Bus", "_items": [hub]}]}
    )
    system.outputs["system_profiler", "SPBluetoothDataType", "-json"] = json.dumps(
        {"SPBluetoothDataType": [{
            "controller_properties": {"controller_state": "attrib_on"},
            "device_not_connected": [{"HC-06": {}}, {"Telephone": {}}]}]}
    )  # fmt: skip
    computer = diagnosis.inspect_computer(system)
    assert computer.adapters == (Adapter("CH340", "", "", False),)
    assert (computer.bluetooth, computer.has_module) == (ON, True)
    system.add_port("/dev/cu.usbserial-1420")
    (adapter,) = diagnosis.inspect_computer(system).adapters or ()
    assert adapter.has_port


def test_the_state_of_bluetooth_on_macos_is_found(tmp_path: Path) -> None:
    off = [{"controller_properties": {"controller_state": "attrib_off"}}]
    system = FakeComputer(tmp_path, "darwin")
    assert diagnosis.inspect_computer(system).bluetooth == UNKNOWN
    for output, state in (
        ("no JSON", UNKNOWN),
        ('{"SPBluetoothDataType": 5}', UNKNOWN),
        ('{"SPBluetoothDataType": []}', NONE),
        ('{"SPBluetoothDataType": [{}]}', NONE),
        (json.dumps({"SPBluetoothDataType": off}), OFF),
    ):
        system.outputs["system_profiler", "SPBluetoothDataType", "-json"] = output
        computer = diagnosis.inspect_computer(system)
        assert (computer.bluetooth, computer.adapters) == (state, None), output


def test_the_user_of_a_port_on_macos_is_named(tmp_path: Path) -> None:
    system = FakeComputer(tmp_path, "darwin")
    port = "/dev/cu.usbserial-1420"
    system.write(port, "")
    system.owners[port] = (0, True)
    system.outputs["lsof", "-F", "c", port] = "p812\ncArduino IDE\nf7\n"
    assert diagnosis.port_access(system, port) == computer.Access(True, "", False, ("Arduino IDE",))


PNPUTIL = ("pnputil", "/enum-devices", "/connected")
CH340_OUTPUT = r"""
Id. de instancia:           USB\VID_1A86&PID_7523\5&2C8F&0&1
Descripción del dispositivo: USB2.0-Serial
Estado:                     Iniciado
"""


def test_adapters_on_windows_are_found_in_any_language(tmp_path: Path) -> None:
    system = FakeComputer(tmp_path, "win32")
    computer = diagnosis.inspect_computer(system)
    assert (computer.adapters, computer.bluetooth, computer.has_module) == (None, UNKNOWN, None)
    system.outputs[PNPUTIL] = CH340_OUTPUT
    system.outputs[(*PNPUTIL, "/class", "Bluetooth")] = (
        "Instance ID: USB\\VID_8087&PID_0A2B\\5\n"
        "Instance ID: BTHENUM\\DEV_98D331F50001\\7&1\nDevice Description: HC-05\n"
    )
    computer = diagnosis.inspect_computer(system)
    assert computer.adapters == (Adapter("CH340", "", "", True),)
    assert (computer.bluetooth, computer.paired_names, computer.has_module) == (
        ON,
        ("HC-05",),
        True,
    )
    system.outputs[(*PNPUTIL, "/problem")] = CH340_OUTPUT
    system.outputs[(*PNPUTIL, "/class", "Bluetooth")] = "No devices were found.\n"
    computer = diagnosis.inspect_computer(system)
    assert computer.adapters == (Adapter("CH340", "", "", False),)
    assert computer.bluetooth == NONE


# -- names, and the real door -------------------------------------------------------------------


def test_bluetooth_modules_are_known_by_name() -> None:
    for name in ("HC-05", "hc-06", "Tini-7F3A", "HMSoft", "MLT-BT05", "linvor"):
        assert is_module(name)
    assert not is_module("Telephone of Ana")
    assert looks_wireless("/dev/tty.HC-05") and looks_wireless("COM5", "Bluetooth link (COM5)")
    assert not looks_wireless("/dev/ttyUSB0", "USB Serial")


def test_this_computer_can_be_inspected() -> None:
    """No computer raises an exception, and a missing program gives None."""
    system = System()
    computer = diagnosis.inspect_computer(system)
    assert computer.platform == system.platform
    assert system.output("no-such-program-here") is None
    assert system.output("false") is None
    assert system.output("echo", "here") == "here\n"
    assert system.text("/no/such/file") is None and system.names("/no/such") == []
    assert system.text("/dev/zero") is None and system.target("a\0b") is None
    assert system.owner("/no/such") is None


def test_system_access_is_read_only() -> None:
    public = {name for name in dir(System) if not name.startswith("_")}
    assert public == {"ports", "names", "text", "target", "owner", "groups", "user", "output"}
