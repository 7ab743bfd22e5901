"""Facts about a computer on Linux: `/sys`, `/proc`, `/etc/group`, and bluetoothctl."""

from __future__ import annotations

from tiniscript.doctor.computer import NONE, OFF, ON, Access, Adapter, Computer, chip_of
from tiniscript.doctor.system import Owner, System

USB, BLUETOOTH, RFKILL = "/sys/bus/usb/devices", "/sys/class/bluetooth", "/sys/class/rfkill"
LOCKS = "/run/lock", "/var/lock"
PROGRAMS_OF_INTEREST = {"brltty", "ModemManager"}


def inspect_linux(system: System) -> Computer:
    bluetooth = _bluetooth(system)
    return Computer(
        system.platform,
        tuple(system.ports()),
        tuple(_adapters(system)) if system.names(USB) else None,
        bluetooth,
        _paired_devices(system) if bluetooth == ON else (),
        frozenset(PROGRAMS_OF_INTEREST & set(_programs(system).values())),
    )


def _adapters(system: System) -> list[Adapter]:
    adapters = []
    for name in system.names(USB):
        vendor, product = (
            system.text(f"{USB}/{name}/{entry}") or "" for entry in ("idVendor", "idProduct")
        )
        chip = chip_of(vendor.lower(), product.lower())
        if chip is None:
            continue
        interfaces = [entry for entry in system.names(USB) if entry.startswith(f"{name}:")]
        drivers = [system.target(f"{USB}/{interface}/driver") for interface in interfaces]
        driver = next((driver.rpartition("/")[2] for driver in drivers if driver), "")
        has_port = any(
            child.startswith("tty")
            for interface in interfaces
            for child in system.names(f"{USB}/{interface}")
        )
        adapters.append(Adapter(chip[0], chip[1], driver, has_port))
    return adapters


def _bluetooth(system: System) -> str:
    if not any(name.startswith("hci") for name in system.names(BLUETOOTH)):
        return NONE
    for name in system.names(RFKILL):
        folder = f"{RFKILL}/{name}"
        block_flags = (system.text(f"{folder}/{flag_name}") for flag_name in ("soft", "hard"))
        if system.text(f"{folder}/type") == "bluetooth" and "1" in block_flags:
            return OFF
    return ON


def _paired_devices(system: System) -> tuple[str, ...] | None:
    """Return the names of paired devices; newer and older bluetoothctl are asked differently."""
    for words in (("devices", "Paired"), ("paired-devices",)):
        text = system.output("bluetoothctl", *words)
        if text is not None:
            rows = [row.split(None, 2) for row in text.splitlines()]
            return tuple(row[2] for row in rows if len(row) == 3 and row[0] == "Device")
    return None


def _programs(system: System) -> dict[str, str]:
    """Return the names of all programs that run, by their numbers."""
    process_ids = [name for name in system.names("/proc") if name.isdigit()]
    return {process_id: system.text(f"/proc/{process_id}/comm") or "" for process_id in process_ids}


def access(system: System, port: str, owner: Owner) -> Access:
    group, members = _group(system, owner.group)
    is_joined = system.user() in members and owner.group not in system.groups()
    return Access(owner.may_use, group, is_joined, tuple(_using_programs(system, port)))


def _group(system: System, group_id: int) -> tuple[str, list[str]]:
    for row in (system.text("/etc/group") or "").splitlines():
        fields = row.split(":")
        if len(fields) == 4 and fields[2] == str(group_id):
            return fields[0], fields[3].split(",")
    return "", []


def _using_programs(system: System, port: str) -> list[str]:
    """Return the programs that use a port.

    Those of other users are known by their lock files alone.
    """
    using_programs = []
    programs = _programs(system)
    for process_id, name in programs.items():
        folder = f"/proc/{process_id}/fd"
        if any(system.target(f"{folder}/{name}") == port for name in system.names(folder)):
            using_programs.append(name)
    for folder in LOCKS:
        process_id = (system.text(f"{folder}/LCK..{port.rpartition('/')[2]}") or "").strip()
        if process_id in programs:
            using_programs.append(programs[process_id])
    return list(dict.fromkeys(name for name in using_programs if name))
