"""A computer of files in a folder, whose programs give the answers of the test."""

from __future__ import annotations

from pathlib import Path

from tiniscript.doctor.system import Owner, System
from tiniscript.link.ports import ListedPort


class FakeComputer(System):
    """`owners` are the group of a file and whether it may be used; `outputs` those of programs."""

    def __init__(self, root: Path, platform: str) -> None:
        super().__init__(root)
        self.platform = platform
        self.listed_ports: list[ListedPort] = []
        self.outputs: dict[tuple[str, ...], str] = {}
        self.owners: dict[str, tuple[int, bool]] = {}
        self.group_numbers: set[int] = set()
        self.user_name = "somebody"
        self.commands: list[tuple[str, ...]] = []

    def add_port(self, port: str, description: str = "") -> None:
        self.listed_ports.append(ListedPort(port, description))
        self.owners.setdefault(port, (20, True))

    def write(self, path: str, text: str) -> None:
        file = self.root / path.lstrip("/")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def usb(self, name: str, vendor: str, product: str, driver: str = "", tty: str = "") -> None:
        """Plug a USB device in; `driver` uses its only interface."""
        folder = f"/sys/bus/usb/devices/{name}"
        self.write(f"{folder}/idVendor", vendor + "\n")
        self.write(f"{folder}/idProduct", product + "\n")
        part = f"{folder}:1.0"
        self.write(f"{part}/bInterfaceClass", "ff\n")
        if driver:
            link = self.root / f"{part}/driver".lstrip("/")
            link.symlink_to(f"../../../bus/usb/drivers/{driver}")
        if tty:
            self.write(f"{part}/{tty}/dev", "188:0\n")

    def program(self, number: int, name: str, opened_port: str = "") -> None:
        self.write(f"/proc/{number}/comm", name + "\n")
        if opened_port:
            folder = self.root / f"proc/{number}/fd"
            folder.mkdir()
            (folder / "3").symlink_to(opened_port)

    def ports(self) -> list[ListedPort]:
        return self.listed_ports

    def owner(self, path: str) -> Owner | None:
        return Owner(*self.owners[path]) if path in self.owners else None

    def groups(self) -> set[int]:
        return self.group_numbers

    def user(self) -> str:
        return self.user_name

    def output(self, *words: str) -> str | None:
        self.commands.append(words)
        return self.outputs.get(words)
