"""A report to send: its facts, and the parts removed from them.

No name of a person, a computer, a network or a telephone leaves this computer, and no serial
number: many systems make the name of a port from one.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable

from tiniscript.base.version import __version__
from tiniscript.doctor.computer import Computer, is_module
from tiniscript.doctor.findings import Finding
from tiniscript.link.port_names import is_address

REPORT_MARK = "TiniScript doctor report 1"  # the first line: the file is one of ours
SELFTEST_MARK = "TiniScript selftest report 1"  # first line of a report by `tsc doctor --selftest`
HIDDEN = "…"
# Values of findings that come from others or identify the robot: its name and number, output of a
# sketch, system messages.
PRIVATE_VALUES = ("name", "id", "said", "why", "by")
PROGRAMS = ("ModemManager", "brltty", "avrdude", "arduino", "Arduino IDE", "screen", "minicom",
            "picocom", "putty", "tsc", "python", "python3", "java", "thonny", "code")  # fmt: skip


def is_ours(data: bytes) -> bool:
    """Return whether a file is a report, which a new one may replace."""
    return data.split(b"\n", 1)[0].strip() in (REPORT_MARK.encode(), SELFTEST_MARK.encode())


def head(mark: str, title: str, facts: Iterable[tuple[str, str]], port: str | None) -> list[str]:
    """Return the first lines of a report: its kind, and tsc's version, computer and port."""
    rows = [mark, title, "", f"tsc: {__version__}, Python {platform.python_version()}"]
    rows += [f"{name}: {value}" for name, value in facts]
    return [*rows, "", f"port: {redacted_port(port) if port else '-'}"]


def redacted_port(name: str) -> str:
    """Return a port's name without parts that identify its owner: `socket://…`,
    `/dev/tty.usbmodem…`."""
    if is_address(name):
        return name.partition("://")[0] + "://" + HIDDEN
    if re.fullmatch(r"/dev/(?:tty(?:USB|ACM|S|AMA)|rfcomm|pts/)\d{1,3}|COM\d{1,3}", name, re.I):
        return name
    match = re.match(r"/dev/(?:tty|cu)\.(?:usbserial|usbmodem|wchusbserial|SLAB_USBtoUART)", name)
    if match:
        return match[0] + HIDDEN
    return "Bluetooth " + HIDDEN if is_module(name) else HIDDEN


def values_of(finding: Finding) -> dict[str, str]:
    """Return the values of a finding as a report may have them."""
    values = {}
    for key, value in finding.values.items():
        if key == "ports":
            values[key] = ", ".join(redacted_port(part) for part in value.split(", "))
        elif key == "by":
            names = [part if part in PROGRAMS else HIDDEN for part in value.split(", ") if part]
            values[key] = ", ".join(names)
        else:
            values[key] = HIDDEN if key in PRIVATE_VALUES and value else value
    return values


def facts(computer: Computer) -> list[tuple[str, str]]:
    """Return the facts about the computer: names of devices, and numbers."""
    adapters = "?"
    if computer.adapters is not None:
        adapters = ", ".join(
            f"{adapter.chip} ({adapter.driver or ('port' if adapter.has_port else '-')})"
            for adapter in computer.adapters
        )
    modules = (
        "?" if computer.paired_names is None else str(sum(map(is_module, computer.paired_names)))
    )
    return [
        ("system", computer.platform),
        ("ports", ", ".join(redacted_port(port.port) for port in computer.ports) or "-"),
        ("usb", adapters or "-"),
        ("bluetooth", computer.bluetooth),
        ("modules", modules),
        ("programs", ", ".join(sorted(computer.programs)) or "-"),
    ]
