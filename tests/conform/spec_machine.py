"""A machine for `tsc doctor --conform --machine`: that of `tests/oracle`.

`python -m tests.conform.spec_machine` takes runs on standard input and prints their traces, as
`docs/develop/conformance.md` says. It runs no tasks: it lacks all that an image says to need.
"""

from __future__ import annotations

import sys
import zlib
from collections.abc import Iterable, Iterator
from typing import Any

from tests.oracle import image, machine, verifier
from tests.oracle.spec_tables import instruction_at, rule_numbers
from tests.oracle.words import Device, Kit


class Spec:
    """The parts; a test puts a broken one in the place of one."""

    image: Any = image
    machine: Any = machine
    verifier: str = ""
    refuses_only = False  # a verifier accepts images that it cannot run

    def answer(self, rows: Iterable[str]) -> list[str]:
        """Return the lines of a run."""
        rows_by_word: dict[str, list[list[str]]] = {}
        for word, *rest in (row.split(" ") for row in rows):
            rows_by_word.setdefault(word, []).append(rest)
        sensors, actuators = rows_by_word.get("sensor", []), rows_by_word.get("actuator", [])
        kit = Kit(tuple(map(_device, sensors)), tuple(map(_device, actuators)))
        (data,) = (bytes.fromhex("".join(rest)) for rest in rows_by_word["image"])
        refusal = self.image.refusal(data)
        needs = data[14] if not refusal else 0
        if needs and not self.refuses_only:
            refusal = "UNKNOWN_NEEDS"
        code = data[data[5] :] if not refusal else b""
        rule, offset = verifier.verdict(code, len(sensors), len(actuators), needs, self.verifier)
        if rule:
            names = {number: name for name, number in rule_numbers().items()}
            refusal = f"{names[rule]} {offset}"
        hashes = {"sensor": list(map(_hash, sensors, ["sensor"] * 32)),
                  "actuator": list(map(_hash, actuators, ["actuator"] * 32))}  # fmt: skip
        if not refusal and _devices(code, hashes) != int.from_bytes(data[6:8], "little"):
            refusal = "OTHER_KIT"
        if refusal:
            return [f"REFUSED {refusal}"]
        lists = {
            kit.sensors[int(k)].name: [*map(int, row)]
            for k, *row in rows_by_word.get("readings", [])
        }
        numbers = {name: int(rows_by_word[name][0][0]) for name in ("seed", "begin", "until")}
        intervals_ms = [int(number) for number in rows_by_word["every"][0]]

        def late(waited_ms: int, reached: int) -> int:
            return -reached % intervals_ms[min(waited_ms, len(intervals_ms)) - 1]

        delays_by_sensor = {
            int(k): tuple(map(int, times)) for k, *times in rows_by_word.get("slow", [])
        }

        def is_slow(sensor: int, passed_ms: int) -> bool:
            period_ms, from_ms, to_ms = delays_by_sensor.get(sensor, (1, 0, 0))
            return from_ms <= passed_ms % period_ms < to_ms

        limits = numbers["until"], numbers["seed"], 10**6
        answer: str = self.machine.trace(code, kit, lists, *limits, late, numbers["begin"], is_slow)
        return answer.splitlines()


def _device(row: list[str]) -> Device:
    name, kind, _, low, high = row
    return Device(name, kind == "yes/no", int(low), int(high))


def _hash(row: list[str], word: str) -> int:
    return zlib.crc32(f"{' '.join([word, *row])}\n".encode()) & 0xFFFF or 0xFFFF


def _devices(code: bytes, hashes: dict[str, list[int]]) -> int:
    """Return the hash of those that the code uses."""
    total = position = 0
    while position < len(code):
        row = instruction_at(code, position)
        used_devices = [(operand.kind, value) for operand, value in row.read(code, position)]
        for kind, value in (*used_devices, *row.implied):
            if kind in hashes:
                total = total << 1 & 0xFFFF ^ 0x2D * (total >> 15) ^ hashes[kind][value]
        position += row.size
    return total


def runs(lines: Iterable[str]) -> Iterator[list[str]]:
    """Yield the lines of each run."""
    rows: list[str] = []
    for line in lines:
        if line == "run\n":
            yield rows
            rows = []
        else:
            rows.append(line.rstrip("\n"))


if __name__ == "__main__":
    for run in runs(sys.stdin):
        print(*Spec().answer(run), sep="\n", flush=True)
