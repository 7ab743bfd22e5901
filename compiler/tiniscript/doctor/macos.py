"""Facts about a computer on macOS: system_profiler and lsof."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from tiniscript.doctor.computer import NONE, OFF, ON, UNKNOWN, Access, Adapter, Computer, chip_of
from tiniscript.doctor.system import Owner, System


def inspect_macos(system: System) -> Computer:
    ports = system.ports()
    usb_devices = _query(system, "SPUSBDataType")
    has_port = any("usb" in port.port.lower() for port in ports)
    adapters = None if usb_devices is None else tuple(_adapters(usb_devices, has_port))
    bluetooth, paired_names = _bluetooth(_query(system, "SPBluetoothDataType"))
    return Computer(system.platform, tuple(ports), adapters, bluetooth, paired_names)


def _query(system: System, data_type: str) -> list[dict[str, Any]] | None:
    text = system.output("system_profiler", data_type, "-json")
    try:
        report = json.loads(text or "")[data_type]
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return (
        [entry for entry in report if isinstance(entry, dict)] if isinstance(report, list) else None
    )


def _adapters(devices: list[dict[str, Any]], has_port: bool) -> Iterator[Adapter]:
    """Yield the adapters. The system does not report which port is whose: a USB port is assumed for
    all of them."""
    pending_devices = list(devices)
    while pending_devices:
        device = pending_devices.pop()
        inner_devices = device.get("_items")
        if isinstance(inner_devices, list):
            pending_devices += [
                inner_device for inner_device in inner_devices if isinstance(inner_device, dict)
            ]
        vendor, product = (
            str(device.get(key, "")).split(" ")[0].lower().removeprefix("0x")
            for key in ("vendor_id", "product_id")
        )
        chip = chip_of(vendor, product)
        if chip is not None:
            yield Adapter(chip[0], "", "", has_port)


def _bluetooth(reports: list[dict[str, Any]] | None) -> tuple[str, tuple[str, ...] | None]:
    if reports is None:
        return UNKNOWN, None
    if not reports:
        return NONE, ()
    report = reports[0]
    controller = report.get("controller_properties")
    state = controller.get("controller_state") if isinstance(controller, dict) else None
    names: list[str] = []
    for key in ("device_connected", "device_not_connected"):
        rows = report.get(key)
        for row in rows if isinstance(rows, list) else []:
            names += list(row) if isinstance(row, dict) else []
    if state is None:
        return NONE, ()
    return (OFF if str(state).endswith("_off") else ON), tuple(names)


def access(system: System, port: str, owner: Owner) -> Access:
    text = system.output("lsof", "-F", "c", port) or ""
    names = [row[1:] for row in text.splitlines() if row.startswith("c") and row[1:]]
    return Access(owner.may_use, "", False, tuple(dict.fromkeys(names)))
