"""Writes random programs with TASK and WHEN, in which much comes together in one millisecond."""

from __future__ import annotations

import random

from tests.oracle.words import ACTS, RANGES, TIME

TIMES = ("0", "0.001", "0.005", "0.01", "0.02", "0.03", "0.04", "0.05", "0.1", "0.12", "0.3")
WAYS = ("0", "0.001", "0.3", "0.45", "1", "2", "3.6", "-1 + N")
POWERS = ("0", "10", "20", "50", "60", "100")
SIDES = ("-50", "0", "20", "40")
SENSORS = ("DISTANCE", "LIGHT_L", "PAD_X")
VARIABLES = ("A", "N")
YES_NO = "Q"  # a value of a DEF
MAX_TASKS = 4
DEPTH = 3  # blocks of one task


class TaskAuthor:
    def __init__(self, rng: random.Random, ways: bool = False) -> None:
        self.rng = rng
        self.ways = ways  # some moves go by centimetres or degrees
        self.lines: list[str] = ["A = 0;N = 0"]
        self.defs: dict[str, list[str]] = {}  # the names of the values of each
        self.own: list[str] = []  # names of the DEF being written
        self.loops = 0

    def program(self) -> str:
        """The main task, with DEFs and 1 to 4 tasks among its instructions."""
        rng = self.rng
        for number in range(rng.choice((0, 0, 1, 2, 2))):
            name, self.own = f"D{number}", rng.sample(("V", "U", YES_NO), rng.choice((0, 1, 1, 2)))
            brackets = f"({', '.join(self.own)})" if self.own else ""
            self.lines.append(f"DEF {name}{brackets}")
            self.body(rng.randint(1, 2), DEPTH - 1)
            self.lines.append("END_DEF")
            self.defs[name], self.own = self.own, []
            if YES_NO in self.defs[name]:  # the first call determines its kind
                self.lines += ["IF(FALSE)", self.call(name), "ENDIF"]
        tasks = rng.randint(1, MAX_TASKS)
        when_counts = sorted(rng.randint(0, 3) for _ in range(tasks))
        for place in range(4):
            for _ in range(when_counts.count(place)):
                self.task()
            if place < 3:
                self.body(rng.randint(0, 2), 0)
        return ";".join(self.lines)

    def task(self) -> None:
        if self.rng.random() < 0.5:
            self.lines.append("TASK")
            self.body(self.rng.randint(0, 4), 0)
            self.lines.append(self.rng.choice(("END_TASK", "ENDTASK")))
        else:
            self.lines.append(f"WHEN({self.condition()})")
            self.body(self.rng.randint(0, 3), 0)
            self.lines.append(self.rng.choice(("END_WHEN", "ENDWHEN")))

    def body(self, count: int, depth: int) -> None:
        for _ in range(count):
            self.instruction(depth)

    def instruction(self, depth: int) -> None:
        rng = self.rng
        kind = rng.random()
        if kind < 0.34:
            self.move()
        elif kind < 0.44:
            self.lines.append(f"W({rng.choice(TIMES)})" + self.until(0.2))
        elif kind < 0.52:
            self.lines.append("S")
        elif kind < 0.62:
            self.lines.append(f"M({rng.choice(SIDES)}, {rng.choice(SIDES)})")
        elif kind < 0.66:
            word = list(ACTS)[int((kind - 0.62) / 0.04 * len(ACTS))]
            values = [
                rng.choice(TIMES)
                if limits == TIME
                else rng.randint(limits[0] // 1000, min(limits[1] // 1000, 900))
                for limits in RANGES[word]
            ]
            self.lines.append(f"{word}({', '.join(map(str, values))})")
        elif kind < 0.74:
            self.lines.append(f"SHOW({self.number()})")
        elif kind < 0.80:
            name = rng.choice((*VARIABLES, *self.own))
            self.lines.append(f"{name} = {self.value(name)}")
        elif kind < 0.83:
            self.lines.append(rng.choice(SENSORS))
        elif kind < 0.88 and self.defs:
            self.lines.append(self.call(rng.choice(list(self.defs))))
        elif kind < 0.90 and self.loops:
            self.lines.append("BREAK")
        elif depth < DEPTH:
            self.block(depth)

    def move(self) -> None:
        rng = self.rng
        time = rng.choice(TIMES)
        until = self.until(0.3)
        if rng.random() < 0.12:
            time = "FOREVER"
        word, power = rng.choice("FBLR"), rng.choice(POWERS)
        if self.ways and time != "FOREVER" and rng.random() < 0.7:
            time = f"{rng.choice(WAYS)} {'CM' if word in 'FB' else 'DEG'}"
            power = power if rng.random() < 0.05 else power.replace("0", "5", power == "0")
        self.lines.append(f"{word}({time}, {power}){until}")

    def until(self, probability: float) -> str:
        return f" UNTIL({self.condition()})" if self.rng.random() < probability else ""

    def block(self, depth: int) -> None:
        rng = self.rng
        word = rng.choice(("IF", "LOOP", "LOOP", "WHILE"))
        if word == "IF":
            self.lines.append(f"IF({self.condition()})")
            self.body(rng.randint(0, 2), depth + 1)
            if rng.random() < 0.3:
                self.lines.append("ELSE")
                self.body(rng.randint(0, 2), depth + 1)
            self.lines.append("ENDIF")
            return
        head = f"WHILE({self.condition()})"
        if word == "LOOP":
            head = f"LOOP({rng.choice(('0', '1', '2', '3', 'N', 'FOREVER'))})"
        self.lines.append(head)
        self.loops += 1
        self.body(rng.randint(0, 3), depth + 1)
        self.loops -= 1
        self.lines.append(f"END_{word}")

    def call(self, name: str) -> str:
        values = ", ".join(map(self.value, self.defs[name]))
        return f"{name}({values})" if values else name

    def value(self, name: str) -> str:
        return self.condition() if name == YES_NO else self.number()

    def number(self) -> str:
        rng = self.rng
        numbers = [name for name in self.own if name != YES_NO]
        if numbers and rng.random() < 0.5:
            return rng.choice(numbers)
        return rng.choice(
            (
                "TIME",
                "A",
                "N",
                "A + 1",
                "N - 1",
                "DISTANCE",
                "PAD_X",
                "RANDOM(0, 3)",
                str(rng.randint(0, 9)),
            )
        )

    def condition(self) -> str:
        rng = self.rng
        if YES_NO in self.own and rng.random() < 0.5:
            return rng.choice((YES_NO, f"NOT {YES_NO}"))
        begin_s = rng.choice((0, 0.02, 0.05, 0.1, 0.2))
        return rng.choice(
            (
                "TRUE",
                "FALSE",
                f"TIME >= {begin_s}",
                f"TIME >= {begin_s} AND TIME < {begin_s + 0.06:.2f}",
                f"TIME >= {begin_s} AND TIME < {begin_s + 0.06:.2f}",
                "DISTANCE < 15",
                "DISTANCE < 15 OR LIGHT_L > 500",
                "KEY_A",
                "N > 1",
                "A = N",
            )
        )


def task_program(rng: random.Random, ways: bool = False) -> tuple[str, dict[str, list[int]]]:
    """A program, and the readings of its sensors in thousandths."""
    text = TaskAuthor(rng, ways).program()
    distances = [1000 * rng.choice((5, 9, 50)) for _ in range(rng.randint(0, 6))]
    lights = [1000 * rng.choice((0, 600)) for _ in range(rng.randint(0, 4))]
    keys = [rng.randint(0, 1) for _ in range(rng.randint(0, 6))]
    pad = [1000 * rng.choice((-100, 0, 3)) for _ in range(rng.randint(0, 4))]
    return text, {"DISTANCE": distances, "LIGHT_L": lights, "KEY_A": keys, "PAD_X": pad}


class RivalAuthor(TaskAuthor):
    """Writes programs in which WHENs and TASKs take the motors from each other's moves, and these
    have an UNTIL that reads."""

    def task(self) -> None:
        if self.rng.random() < 0.3:
            super().task()
            return
        time = self.rng.choice(("0", "0.01", "0.03", "0.05"))
        self.lines.append(f"WHEN({self.condition()});B({time}, 50)")
        self.body(self.rng.randint(0, 1), 0)
        self.lines.append("END_WHEN")

    def until(self, probability: float) -> str:
        question = self.rng.choice(
            ("DISTANCE < 15", "LIGHT_L > 500", "DISTANCE < 8 AND LIGHT_L < 5")
        )
        return f" UNTIL({question})" if self.rng.random() < 2 * probability else ""


def rival_program(rng: random.Random) -> tuple[str, dict[str, list[int]]]:
    text = RivalAuthor(rng).program()
    distances = [1000 * rng.choice((5, 9, 50, 50, 50)) for _ in range(40)]
    lights = [1000 * rng.choice((0, 0, 600)) for _ in range(40)]
    return text, {"DISTANCE": distances, "LIGHT_L": lights}


class SharedAuthor(TaskAuthor):
    """Writes programs whose tasks share DEFs with values, which call each other."""

    def program(self) -> str:
        """1 to 4 DEFs, each with names of the same few, and 1 to 4 tasks that reach them."""
        rng = self.rng
        for number in range(rng.randint(1, 4)):
            name = f"D{number}"
            self.own = rng.sample(("V", "U", "T", YES_NO), rng.choice((0, 1, 1, 2, 2, 3, 4)))
            brackets = f"({', '.join(self.own)})" if self.own else rng.choice(("", "()"))
            self.lines.append(f"DEF {name}{brackets}")
            for _ in range(rng.randint(1, 3)):
                self.instruction(DEPTH - 1)
            if self.defs and rng.random() < 0.6:
                self.lines.append(self.call(rng.choice(list(self.defs))))
            if self.own and rng.random() < 0.7:
                self.lines.append(f"SHOW({rng.choice(self.own)})")
            self.lines.append("END_DEF")
            self.defs[name], self.own = self.own, []
            if YES_NO in self.defs[name]:  # the first call determines its kind
                self.lines += ["IF(FALSE)", self.call(name), "ENDIF"]
        for _ in range(rng.choice((1, 1, 2, 2, 3, 4))):
            self.task()
        self.body(rng.randint(0, 1), 0)
        self.lines.append(self.call(rng.choice(list(self.defs))))
        return ";".join(self.lines)

    def body(self, count: int, depth: int) -> None:
        super().body(count, depth)
        if depth == 0 and self.rng.random() < 0.8:
            self.lines.append(self.call(self.rng.choice(list(self.defs))))


def shared_program(rng: random.Random) -> tuple[str, dict[str, list[int]]]:
    """A program whose DEFs have values, and the readings of its sensors in thousandths."""
    text = SharedAuthor(rng).program()
    readings = {
        "DISTANCE": [1000 * rng.choice((5, 9, 50)) for _ in range(rng.randint(0, 12))],
        "LIGHT_L": [1000 * rng.choice((0, 600)) for _ in range(rng.randint(0, 4))],
        "KEY_A": [rng.randint(0, 1) for _ in range(rng.randint(0, 6))],
        "PAD_X": [1000 * rng.choice((-100, 0, 3)) for _ in range(rng.randint(0, 4))],
    }
    return text, readings
