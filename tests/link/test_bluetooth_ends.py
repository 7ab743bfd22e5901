"""Reasons why a connection over Bluetooth LE ends, at every stage, or fails to begin."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.support.ble_robot import (
    ADDRESS_PORT,
    DRIVE_ACTIONS,
    DRIVE_PROGRAM,
    HM10,
    NAME,
    NORDIC,
    BleRobot,
    Peripheral,
    start_endless_upload,
)
from tests.support.command import LONG_PROGRAM, Tsc, run_in_process
from tests.support.fake_bluez import FakeBluez
from tiniscript.link import errors, ports


def wait_for_dead_man_stop(ble: BleRobot) -> None:
    """No client is there to stop it."""
    ble.robot.until(lambda: not ble.robot.moves, "the dead-man timer stops it")


# -- in the middle ------------------------------------------------------------------------------


@pytest.mark.parametrize("stage", ["connect", "services", "notify"])
def test_a_connection_that_is_never_made_is_reported(ble: BleRobot, stage: str) -> None:
    ble.failing_stage = stage
    for language in ("en", "es"):
        result = run_in_process(
            "upload", "-e", DRIVE_PROGRAM, "--port", ADDRESS_PORT, "--lang", language
        ).gives(3, out="")
        assert result.err.startswith("tsc: ")
        assert ADDRESS_PORT.upper() in result.err.upper()
    assert ble.robot.actions == []
    ble.failing_stage = ""
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", ADDRESS_PORT).code == 0
    assert ble.robot.actions == DRIVE_ACTIONS


@pytest.mark.sampled("heard_count", keep=3)
@pytest.mark.parametrize("heard_count", [1, 20, 40, 60, 100, 160, 220, 280])
def test_a_truncated_upload_leaves_the_previous_program(
    ble: BleRobot, tmp_path: Path, heard_count: int
) -> None:
    """The connection ends within HELLO, or a frame of the program, or before the last answer."""
    old_path, new_path = tmp_path / "before.bin", tmp_path / "after.bin"
    assert run_in_process("upload", "-e", "SB|F(1, 10)", "--port", ADDRESS_PORT).code == 0
    assert run_in_process("show", "-o", old_path, "--port", ADDRESS_PORT).code == 0
    ble.parts_after = len(ble.received_data) + heard_count
    result = run_in_process("upload", "-e", LONG_PROGRAM, "--port", ADDRESS_PORT)
    assert result.code == 3
    assert f"lost the Bluetooth connection to {ADDRESS_PORT}" in result.err
    ble.parts_after = None
    wait_for_dead_man_stop(ble)
    compiled_file = tmp_path / "ours.bin"
    run_in_process("compile", "-e", LONG_PROGRAM, "-o", compiled_file)
    assert run_in_process("show", "-o", new_path, "--port", ADDRESS_PORT).code == 0
    assert new_path.read_bytes() in (old_path.read_bytes(), compiled_file.read_bytes())
    assert (
        run_in_process("upload", "-e", LONG_PROGRAM, "--no-run", "--port", ADDRESS_PORT).code == 0
    )


def test_a_pure_reader_notices_the_end_of_a_connection(ble: BleRobot, bluez: FakeBluez) -> None:
    command = start_endless_upload(ble)
    bluez.part(ble)
    command.wait_for_result().gives(3, f"lost the Bluetooth connection to {ADDRESS_PORT}")
    wait_for_dead_man_stop(ble)
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", NAME).code == 0
    port = ports.open_port(ADDRESS_PORT, 9600)
    assert port.read(1) == b""
    bluez.part(ble)
    with pytest.raises(OSError, match="has ended"):
        ble.robot.until(lambda: bool(port.read(1)), "it ends")
    with pytest.raises(OSError, match="has ended"):
        port.write(b"1")
    port.close()


def test_a_line_after_a_lost_connection_ends_live(ble: BleRobot, bluez: FakeBluez) -> None:
    run_in_process("live", "-", "--port", ADDRESS_PORT, data=b"F(0.1, 50)\n").gives(0)
    ble.parts_after = len(ble.received_data) + 60
    run_in_process("live", "-", "--port", ADDRESS_PORT, data=b"F(0.1, 50)\n" * 9).gives(
        3, "Bluetooth connection"
    )


@pytest.mark.parametrize("failure", ["power", "unplug", "vanish"])
def test_a_removed_adapter_ends_the_command(ble: BleRobot, bluez: FakeBluez, failure: str) -> None:
    command = start_endless_upload(ble)
    if failure == "power":
        bluez.power(False)
    elif failure == "unplug":
        bluez.unplug()
    else:
        bluez.vanish()
    result = command.wait_for_result().gives(3, "the Bluetooth connection")
    assert result.err.count("\n") == 1  # no part of bleak
    wait_for_dead_man_stop(ble)
    result = run_in_process("stop", "--port", ADDRESS_PORT, "--lang", "es")
    message = (
        "el servicio de Bluetooth" if failure == "vanish" else "el Bluetooth de esta computadora"
    )
    assert (result.code, message in result.err) == (3, True)


def test_a_flood_of_bytes_is_not_a_robot(bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tiniscript.library.opening.ANSWER_TIMEOUT_MS", 1500)

    class Flood(Peripheral):
        def begin(self) -> None:
            self.flood(2000)

        def flood(self, frame_count: int) -> None:
            self.tell(bytes(range(1, 21)))
            if frame_count:
                self.loop.call_soon(self.flood, frame_count - 1)

    bluez.add(Flood("flood"))
    run_in_process("doctor", "--identify", "--port", ADDRESS_PORT).gives(3, "not TiniScript")


# -- before it begins ---------------------------------------------------------------------------


@pytest.mark.parametrize(("has_bluez", "has_adapter", "messages"), [
    (False, False, ("this computer's Bluetooth service is not running.",
                    "el servicio de Bluetooth de esta computadora no está en marcha")),
    (True, False, ("Bluetooth is off on this computer",
                   "el Bluetooth de esta computadora está apagado")),
])  # fmt: skip
def test_a_computer_without_bluetooth_is_reported(
    has_bluez: bool, has_adapter: bool, messages: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeBluez(has_bluez, has_adapter) as bluez:
        monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", bluez.address)
        monkeypatch.setattr(ports, "list_ports", list)
        monkeypatch.setattr(ports, "find_announced_robots", list)
        for language, words in zip(("en", "es"), messages, strict=True):
            run_in_process("doctor", "--identify", "--port", NAME, "--lang", language).gives(
                3, words
            )
        run_in_process("doctor", "--ports", "--ask").gives(0, messages[0])


def test_a_bus_without_access_is_reported(
    bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch
) -> None:
    from bleak.exc import BleakBluetoothNotAvailableError as NotAvailable
    from bleak.exc import BleakBluetoothNotAvailableReason as Reason
    from bleak.exc import BleakDBusError

    from tiniscript.link.transports import bluetooth_search as search

    for reason, name in (
        (Reason.DENIED_BY_USER, errors.RADIO_FORBIDDEN),
        (Reason.DENIED_BY_SYSTEM, errors.RADIO_FORBIDDEN),
        (Reason.POWERED_OFF, errors.RADIO_OFF),
        (Reason.NO_BLE_CENTRAL_ROLE, errors.RADIO_OFF),
    ):
        assert search.reason_of(NotAvailable("", reason)) == name
    denied = BleakDBusError("org.freedesktop.DBus.Error.AccessDenied", ["Sender is not allowed"])
    assert search.reason_of(denied) == errors.RADIO_FORBIDDEN
    assert search.reason_of(RuntimeError("new")) == errors.RADIO_BROKEN


@pytest.mark.parametrize("package", ["bleak", "zeroconf"])
def test_a_missing_bluetooth_package_is_reported_with_the_next_step(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    for name in [module for module in sys.modules if module.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, name, None)
    transports = "tiniscript.link.transports"
    for folder, name in (
        (transports, "bluetooth"), (transports, "bluetooth_search"), (transports, "network"),
        ("tiniscript.virtual", "announcement"),
    ):  # fmt: skip
        monkeypatch.delitem(sys.modules, f"{folder}.{name}", raising=False)
        monkeypatch.delattr(f"{folder}.{name}", raising=False)
    monkeypatch.setitem(sys.modules, package, None)
    port = {"bleak": "ble://Tini", "zeroconf": "tcp://tini"}[package]
    for language in ("en", "es"):
        tsc("doctor", "--identify", "--port", port, "--lang", language).gives(3, package, "[radio]")
        if package == "zeroconf":
            tsc("robot", "--announce", "--for", "0.1", "--lang", language).gives(2, "[radio]")


# -- the pace -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("service", "sizes", "expected_pauses_s"), [
    (HM10, [20, 20, 20, 5], [0.0208, 0.0208, 0.0208]),
    (NORDIC, [65], []),
])  # fmt: skip
def test_an_hm10_gets_no_more_than_its_uart_passes_on(
    service: str, sizes: list[int], expected_pauses_s: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It drops earlier bytes; 20 bytes take 20.8 ms at 9600 baud."""
    from tiniscript.link.transports import bluetooth

    now_s, slept, write_sizes = [0.0], [], []

    async def sleep(seconds: float) -> None:
        if seconds > 0:
            slept.append(round(seconds, 4))
            now_s[0] += seconds

    async def write(_: object, data: bytes, response: bool) -> None:
        write_sizes.append(len(data))

    loop: Any = SimpleNamespace(run=lambda work, _: asyncio.run(work))
    port = bluetooth.BluetoothPort(loop, 9600)
    module = next(module for module in bluetooth.UART_SERVICES if module.service_uuid == service)
    client: Any = SimpleNamespace(write_gatt_char=write, is_connected=True)
    characteristic: Any = SimpleNamespace(
        properties=["write-without-response"], max_write_without_response_size=182
    )
    port._client, port._write_characteristic, port._is_paced = (
        client,
        characteristic,
        module.is_paced,
    )
    monkeypatch.setattr(bluetooth, "asyncio", SimpleNamespace(
        sleep=sleep, TimeoutError=asyncio.TimeoutError,
        get_running_loop=lambda: SimpleNamespace(time=lambda: now_s[0]),
    ))  # fmt: skip
    port.write(bytes(65))
    assert (write_sizes, slept) == (sizes, expected_pauses_s)


def test_a_scan_that_fails_or_is_cancelled_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    from tiniscript.link.transports import bluetooth_search

    calls: list[str] = []

    async def search() -> None:
        answer = asyncio.Event()

        async def start() -> None:
            calls.append("start")
            await answer.wait()
            calls.append("started")

        async def stop() -> None:
            calls.append("stop")

        async def fail() -> None:
            raise OSError("the adapter is gone")

        scanner = SimpleNamespace(start=start, stop=stop)
        monkeypatch.setattr(bluetooth_search, "BleakScanner", lambda _: scanner)
        task = asyncio.create_task(bluetooth_search._Scan().__aenter__())
        while not calls:
            await asyncio.sleep(0)
        task.cancel()
        await asyncio.sleep(0)
        answer.set()
        with pytest.raises(asyncio.CancelledError):
            await task
        monkeypatch.setattr(bluetooth_search, "_connected_devices", fail)
        for _ in range(2):  # the second one begins anew
            with pytest.raises(OSError, match="gone"):
                async with bluetooth_search._Scan():
                    pass

    asyncio.run(search())
    assert calls == ["start", "started", "stop"] * 3
