"""Searches by Bluetooth LE, at once and one after another, on a simulated clock: each finds what a
plain model finds among what was in reach in its scan, at the same time, and one scan runs at most.
"""

from __future__ import annotations

import asyncio
import random
import selectors
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest

pytest.importorskip("bleak", reason="no bleak: pip install tiniscript[radio]")

from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.transports import bluetooth_search as search

LAMP = "0000180f-0000-1000-8000-00805f9b34fb"
ADDRESSES = [f"AA:BB:CC:DD:EE:{k:02}" for k in range(6)]
NAMES = "tini 1", "tini 2", "lamp", ADDRESSES[0]  # a device may claim to be another one
HISTORY_S = 60.0


class SimulatedSelector(selectors.DefaultSelector):
    """Waits in no time."""

    now_s = 0.0
    count = 0

    def select(self, timeout_s: float | None = None) -> list[Any]:
        self.count += 1
        assert self.count < 100_000 and timeout_s is not None, "it never ends"
        self.now_s += max(0.0, timeout_s)
        return super().select(0)


class Sighting(NamedTuple):
    """What a scan has heard from a device: it may leave out its name, or what it offers."""

    time_s: float
    scan: int
    address: str
    name: str
    is_robot: bool


class Radio:
    """The adapter of this computer, and the devices around it."""

    def __init__(self, rng: random.Random, now_s: Callable[[], float]) -> None:
        self.rng, self.now_s = rng, now_s
        self.name_by_address = {address: rng.choice(NAMES) for address in ADDRESSES}
        self.heard: list[Sighting] = []
        self.failing: set[Any] = set()
        self.scan = 0
        self.scanner: Scanner | None = None  # which scans now

    async def connected_devices(self) -> list[Any]:
        if self.rng.random() < 0.1:
            self.failing.add(asyncio.current_task())
            raise OSError("the adapter is gone")
        return [
            SimpleNamespace(address=sighting.address, name=sighting.name or None)
            for sighting in self.heard
            if sighting.scan == self.scan
        ]

    async def advertise(self) -> None:
        """Let devices send what they are, now and then."""
        while self.now_s() < HISTORY_S:
            await asyncio.sleep(self.rng.expovariate(0.8))
            if self.scanner is None or not self.scanner.is_started:
                continue
            address = self.rng.choice(ADDRESSES)
            name = self.rng.choice((self.name_by_address[address], ""))
            service = self.rng.choice((search.NORDIC_UART.upper(), search.HM10, LAMP, LAMP))
            self.heard.append(Sighting(self.now_s(), self.scan, address, name, service != LAMP))
            is_local = self.rng.random() < 0.5
            self.scanner.notice(
                SimpleNamespace(address=address, name="" if is_local else name),
                SimpleNamespace(
                    local_name=name or None if is_local else None, service_uuids=[service]
                ),
            )


class Scanner:
    """A BleakScanner; BlueZ allows one scan at a time."""

    def __init__(self, radio: Radio, notice: Callable[[Any, Any], None]) -> None:
        self.radio, self.notice, self.is_started = radio, notice, False

    async def start(self) -> None:
        assert self.radio.scanner is None, "a second scan"
        self.radio.scanner = self
        self.radio.scan += 1
        await asyncio.sleep(self.radio.rng.choice((0.0, 0.1)))
        for address, name in self.radio.name_by_address.items():
            if self.radio.rng.random() < 0.05:  # this computer is connected to it
                name = self.radio.rng.choice((name, ""))
                sighting = Sighting(self.radio.now_s(), self.radio.scan, address, name, True)
                self.radio.heard.append(sighting)
        self.is_started = True

    async def stop(self) -> None:
        assert self.radio.scanner is self and self.is_started
        kind = self.radio.rng.random()
        await asyncio.sleep(0.1)
        self.radio.scanner = None
        if kind < 0.1:
            raise OSError("the adapter is gone")
        if kind < 0.2:
            await asyncio.Event().wait()


class Scan(search._Scan):
    """The scan of a process; it notes which searches are in it, and since when."""

    def __init__(self, radio: Radio) -> None:
        super().__init__()
        self.radio = radio
        self.entered: dict[Any, tuple[float, int]] = {}
        self.cancelled: set[Any] = set()
        self.left_s: dict[Any, float] = {}

    def cancel_later(self, task: Any, delay_s: float) -> None:
        """Cancel a search once, and not while it ends because its scan has failed."""

        def cancel() -> None:
            if task not in self.radio.failing:
                task.cancel()

        if task not in self.cancelled:
            self.cancelled.add(task)
            asyncio.get_running_loop().call_later(delay_s, cancel)

    def cancel_soon(self) -> None:
        if self.radio.rng.random() < 0.2:
            self.cancel_later(asyncio.current_task(), self.radio.rng.uniform(0, 0.2))

    async def __aenter__(self) -> search._Scan:
        self.cancel_soon()
        scan = await super().__aenter__()
        self.entered[asyncio.current_task()] = self.radio.now_s(), self.radio.scan
        return scan

    async def __aexit__(self, *words: object) -> None:
        assert self.radio.scanner is not None, "it scans as long as somebody searches"
        self.left_s[asyncio.current_task()] = self.radio.now_s()
        self.cancel_soon()
        await super().__aexit__(*words)


class Model:
    """What a scan knows at some time."""

    def __init__(self, heard: list[Sighting], max_devices: int) -> None:
        self.heard, self.max_devices = heard, max_devices

    def at(self, time_s: float, scan: int) -> dict[str, Sighting]:
        known: dict[str, Sighting] = {}
        for sighting in self.heard:
            earlier = known.get(sighting.address)
            if (
                sighting.scan != scan
                or sighting.time_s > time_s
                or (not earlier and len(known) == self.max_devices)
            ):
                continue
            known[sighting.address] = sighting._replace(
                name=sighting.name or (earlier.name if earlier else ""),
                is_robot=sighting.is_robot or bool(earlier and earlier.is_robot),
            )
        return known

    def find(
        self, expected: str, called_s: float, entered_s: float, scan: int
    ) -> tuple[float, Any]:
        """Return when a search ends, and with what."""
        is_address = expected in ADDRESSES

        def matches(time_s: float) -> list[str]:
            return sorted(
                address
                for address, sighting in self.at(time_s, scan).items()
                if (address if is_address else sighting.name) == expected
            )

        end_s = called_s + search.SEARCH_S
        moments_s = [
            entered_s,
            *(sighting.time_s for sighting in self.heard if entered_s < sighting.time_s < end_s),
        ]
        first_s = next((time_s for time_s in moments_s if matches(time_s)), None)
        if first_s is not None:
            end_s = first_s if is_address else min(end_s, first_s + search.LINGER_S)
        found = matches(end_s)
        if len(found) == 1:
            return end_s, found[0]
        if found:
            return end_s, (errors.SEVERAL, ", ".join(f"ble://{address}" for address in found))
        robots = sorted({
            sighting.name or sighting.address
            for sighting in self.at(end_s, scan).values() if sighting.is_robot
        })  # fmt: skip
        return end_s, (errors.NOT_FOUND, ", ".join(robots))


@pytest.mark.parametrize("seed", range(12))
def test_each_search_finds_what_was_in_reach_in_its_scan(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng, selector = random.Random(seed), SimulatedSelector()
    radio = Radio(rng, lambda: selector.now_s)
    max_devices = rng.choice((1000, 3))
    monkeypatch.setattr(search, "MAX_DEVICES", max_devices)
    monkeypatch.setattr(search, "BleakScanner", lambda notice: Scanner(radio, notice))
    monkeypatch.setattr(search, "_connected_devices", radio.connected_devices)
    loop = asyncio.SelectorEventLoop(selector)
    monkeypatch.setattr(loop, "time", lambda: selector.now_s)
    outcomes: list[tuple[Any, str, float, Any]] = []

    async def search_once(scan: Scan) -> None:
        await asyncio.sleep(rng.uniform(0, HISTORY_S - 15))
        expected = rng.choice((*NAMES, *ADDRESSES[:2], ""))
        called_s = radio.now_s()
        outcome: Any
        try:
            if expected:
                outcome = (await search.find_device(expected.lower())).address
            else:
                outcome = [device.address for device in await search.find_robots()]
        except PortError as error:
            outcome = error.reason, error.detail
        except OSError:
            return
        outcomes.append((asyncio.current_task(), expected, called_s, outcome))

    async def live(scan: Scan) -> None:
        searches = [asyncio.create_task(search_once(scan)) for _ in range(10)]
        advertising = asyncio.create_task(radio.advertise())
        for cancelled in searches[:2]:
            scan.cancel_later(cancelled, rng.uniform(0, HISTORY_S))
        await asyncio.gather(advertising, *searches, return_exceptions=True)
        assert radio.scanner is None, "it still scans"
        for task in searches:
            assert task.cancelled() or task.exception() is None

    scan = Scan(radio)
    monkeypatch.setattr(search, "_scan", lambda: scan)
    try:
        loop.run_until_complete(live(scan))
    finally:
        loop.close()
    model = Model(radio.heard, max_devices)
    assert outcomes
    for task, expected, called_s, outcome in outcomes:
        entered_s, scan_number = scan.entered[task]
        if expected:
            end_s, expected_outcome = model.find(expected, called_s, entered_s, scan_number)
        else:
            end_s = entered_s + search.LIST_S
            known = model.at(end_s, scan_number).values()
            robots = sorted(
                (sighting.name, sighting.address) for sighting in known if sighting.is_robot
            )
            expected_outcome = [address for _, address in robots]
        assert outcome == expected_outcome, expected
        assert scan.left_s[task] == pytest.approx(end_s), expected
