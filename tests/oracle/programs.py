"""Writes random TiniScript programs, random readings for them, and broken texts.

Every program is valid and nearly always ends or reaches its time limit soon. The names that it
uses and the kinds and ranges that it respects are those of the kit that it is given.
"""

from __future__ import annotations

import itertools
import random
import re
import zlib
from collections.abc import Callable

from tests.oracle.interpreter import PAPER_KIT, Device, Kit

WIDE_KIT = Kit(
    sensors=(
        *PAPER_KIT.sensors,
        Device("TEMPERATURE", False, -40_000, 125_000),
        Device("TOUCH", True, 0, 1),
        Device("LINE", True, 0, 1),
    ),
    actuators=(
        Device("GRIPPER", False, 0, 180_000),
        Device("LIFT", False, -90_000, 90_000),
        Device("LED", True, 0, 1),
    ),
)

Tokens = list[str]

VARIABLES = ("X", "Y", "Z", "COUNT", "SPEED", "D", "A1", "T_2", "NEAR", "FOUND", "I", "OLD__D_")
PROCEDURES = ("TURN", "LOOK", "DANCE", "SQUARE", "P1", "GO_ON", "BACK_OFF", "TELL", "Q")
MAX_VARIABLES = 32
MAX_DEFS = 16
MAX_NESTING = 16
MAX_CALLS = 8
MAX_STACK = 16

TIMES = ("0", "0.02", "0.05", ".1", "0.25", "0.033", "0.5", "1", "1.5", "0.001", "2.0")
SMALL = ("0", "1", "2", "3", "4", "5", "7", "10", "0.5", ".25", "1.5", "2.75", "0.1", "0.2", "0.3")
WIDE = ("9", "20", "50", "100", "128.5", "400", "500", "1000", "1023", "12.345", "0.001", "007")
LONG = ("0.0005", "1.2345", "2.71828", "3.00049", "99.9995", "0.33333333333333")
BIG = ("2147483.647", "2147483", "2000000", "1073741.824", "46340.95", "999999.999")
LEAST = "-2147483.648"

_PLAIN = re.compile(r"-?[0-9.]+")


def plain(tokens: Tokens) -> bool:
    """Whether an argument is just one number, with or without a minus."""
    return _PLAIN.fullmatch("".join(tokens)) is not None


class Author:
    """Writes one program as a list of instructions, each a list of words and signs."""

    def __init__(self, rng: random.Random, kit: Kit) -> None:
        """Starts with an empty page."""
        self.rng = rng
        self.kit = kit
        self.page: list[Tokens] = []
        self.left = 0  # instructions still to write
        taken = {device.name for device in (*kit.sensors, *kit.actuators)}
        self.names = [name for name in VARIABLES if name not in taken]
        self.free_defs = [name for name in PROCEDURES if name not in taken]
        self.taken = taken | set(VARIABLES) | set(PROCEDURES)
        self.variables: dict[str, bool] = {}
        self.counters: set[str] = set()
        self.defs: dict[str, tuple[int, int]] = {}  # blocks and DEFs open in it at once
        self.depth = 0  # blocks open here
        self.deepest = 0
        self.called = 0
        self.loops = 0
        self.in_def = False
        self.constant = False  # expressions have only literals for leaves

    def chance(self, probability: float) -> bool:
        """Happens that often."""
        return self.rng.random() < probability

    def say(self, *tokens: str) -> None:
        """Writes an instruction."""
        self.page.append(list(tokens))
        self.left -= 1

    # Expressions

    def literal(self) -> Tokens:
        """A number."""
        roll = self.rng.random()
        if roll < 0.55:
            return [self.rng.choice(SMALL)]
        if roll < 0.85:
            return [self.rng.choice(WIDE)]
        if roll < 0.92:
            return [f"{self.rng.uniform(0, 200):.{self.rng.randint(1, 3)}f}"]
        if roll < 0.97:
            return [self.rng.choice(LONG)]
        return [self.rng.choice(BIG)] if self.chance(0.7) else [LEAST]

    def named(self, is_yes_no: bool) -> Tokens | None:
        """A variable or a sensor of the kind, if there is one."""
        variables = [name for name, kind in self.variables.items() if kind == is_yes_no]
        sensors = [sensor.name for sensor in self.kit.sensors if sensor.is_yes_no == is_yes_no]
        names = variables if variables and (self.chance(0.5) or not sensors) else sensors
        return [self.rng.choice(names)] if names else None

    def leaf(self) -> Tokens:
        """A number without operators."""
        if not self.constant and self.chance(0.55):
            if self.chance(0.12):
                return ["TIME"]
            return self.named(False) or self.literal()
        return self.literal()

    def number(self, size: int = 2) -> Tokens:
        """An expression of the kind number; size bounds how deep it branches."""
        roll = self.rng.random()
        if size <= 0 or roll < 0.3:
            return self.leaf()
        if roll < 0.36:
            return ["-", *self.number(size - 1)]
        if roll < 0.46:
            return ["(", *self.number(size - 1), ")"]
        if roll < 0.78:
            sign = self.rng.choice("++---**/%")
            right = self.number(size - 1)
            if sign in "/%" and self.chance(0.7):
                right = [self.rng.choice(("2", "3", "0.5", "7", "1.001", "10"))]
                right = ["-", *right] if self.chance(0.2) else right
            return [*self.number(size - 1), sign, *right]
        name = self.rng.choice(("ROUND", "ABS", "MIN", "MAX", "RANDOM"))
        first, second = self.number(size - 1), self.number(size - 1)
        if name == "ABS":
            return [name, "(", *first, ")"]
        if name == "ROUND" and self.chance(0.7):
            second = self.rng.choice((["0"], ["1"], ["2"], ["-", "1"], ["-", "2"], ["1.5"], ["3"]))
        if name == "RANDOM" and self.chance(0.6):
            first, second = ["1"], [self.rng.choice(("2", "6", "10", "0", "100.5"))]
        return [name, "(", *first, ",", *second, ")"]

    def yes_no(self, size: int = 2) -> Tokens:
        """An expression of the kind yes/no."""
        roll = self.rng.random()
        if size <= 0 or roll < 0.12:
            found = None if self.constant or self.chance(0.3) else self.named(True)
            return found or [self.rng.choice(("TRUE", "FALSE"))]
        if roll < 0.2:
            return ["NOT", *self.yes_no(size - 1)]
        if roll < 0.27:
            return ["(", *self.yes_no(size - 1), ")"]
        if roll < 0.45:
            word = self.rng.choice(("AND", "OR"))
            return [*self.yes_no(size - 1), word, *self.yes_no(size - 1)]
        if roll < 0.5:
            sides = [self.yes_no(size - 1) for _ in range(2)]
            left, right = (side if len(side) == 1 else ["(", *side, ")"] for side in sides)
            return [*left, self.rng.choice(("=", "<>")), *right]
        comparator = self.rng.choice(("=", "<", ">", "<=", ">=", "<>", "<", ">"))
        return [*self.number(size - 1), comparator, *self.number(size - 1)]

    def condition(self) -> Tokens:
        """A yes/no value in parentheses."""
        self.constant = self.chance(0.06)
        tokens = self.yes_no(self.rng.choice((1, 1, 2, 2, 3)))
        self.constant = False
        return ["(", *tokens, ")"]

    def computed(self) -> Tokens:
        """A number that is not checked against a range before the program runs."""
        self.constant = self.chance(0.15)
        tokens = self.number(self.rng.choice((1, 2, 2, 3)))
        self.constant = False
        return ["(", *tokens, ")"] if plain(tokens) else tokens

    def within(self, low: int, high: int) -> Tokens:
        """A lone number from low to high, or something computed."""
        if self.chance(0.3):
            return self.computed()
        value = self.rng.choice((low, high, *(self.rng.randint(low, high) for _ in range(6))))
        if self.chance(0.1) and low < value < high:
            return [*(["-"] if value < 0 else []), f"{abs(value)}.{self.rng.randint(1, 999):03}"]
        return [*(["-"] if value < 0 else []), str(abs(value))]

    def seconds(self) -> Tokens:
        """A time, mostly short."""
        roll = self.rng.random()
        if roll < 0.8:
            return [self.rng.choice(TIMES)]
        if roll < 0.88:
            return ["MIN", "(", *self.number(1), ",", self.rng.choice(TIMES), ")"]
        if roll < 0.96:
            return ["(", *self.number(1), ")", "/", "100"]
        return self.computed()

    # Instructions

    def move(self) -> None:
        """F B L R or W, perhaps with UNTIL."""
        word = self.rng.choice("FBLRFW")
        time, until = self.seconds(), []
        if self.chance(0.25):
            if self.chance(0.5):
                time = ["FOREVER"]
            until = ["UNTIL", *self.condition()]
            if self.chance(0.4):
                end = f"{self.rng.uniform(0, 6):.2f}"
                until = ["UNTIL", "(", "TIME", self.rng.choice((">", ">=")), end, ")"]
        power = [] if word == "W" else [",", *self.within(0, 100)]
        self.say(word, "(", *time, *power, ")", *until)

    def simple(self) -> None:
        """M, S, W, BEEP or START."""
        word = self.rng.choice(("M", "M", "S", "STOP", "W", "BEEP", "BEEP", "START"))
        if word == "M":
            self.say("M", "(", *self.within(-100, 100), ",", *self.within(-100, 100), ")")
        elif word == "W":
            self.say("W", "(", *self.seconds(), ")")
        elif word == "BEEP":
            self.say("BEEP", "(", *self.seconds(), ",", *self.within(31, 20_000), ")")
        else:
            self.say(word)

    def show(self) -> None:
        """SHOW of either kind."""
        value = self.yes_no() if self.chance(0.25) else self.number(3)
        self.say("SHOW", "(", *value, ")")

    def assign(self) -> None:
        """An assignment, to a new variable or to an old one."""
        targets = [name for name in self.variables if name not in self.counters]
        if self.names and len(self.variables) < MAX_VARIABLES and self.chance(0.5):
            name = self.names.pop(self.rng.randrange(len(self.names)))
            kind = self.chance(0.3)
        elif targets:
            name = self.rng.choice(targets)
            kind = self.variables[name]
        else:
            return
        self.constant = self.chance(0.15)
        size = self.rng.choice((0, 1, 2, 3))
        value = self.yes_no(size) if kind else self.number(size)
        if not kind and self.chance(0.01):
            value = self.crowded()
        self.constant = False
        self.variables[name] = kind
        self.say(name, "=", *value)

    def crowded(self) -> Tokens:
        """A number that needs nearly all or all of the stack."""
        leaves = self.rng.randint(MAX_STACK - 3, MAX_STACK)
        tokens = self.leaf()
        for _ in range(leaves - 1):
            tokens = [*self.leaf(), self.rng.choice("+-"), "(", *tokens, ")"]
        return tokens

    def read(self) -> None:
        """A sensor's name."""
        if self.kit.sensors:
            self.say(self.rng.choice(self.kit.sensors).name)

    def set(self) -> None:
        """An actuator."""
        if self.kit.actuators:
            device = self.rng.choice(self.kit.actuators)
            if device.is_yes_no:
                self.say(device.name, "(", *self.yes_no(), ")")
            else:
                value = self.within(-(-device.low // 1000), device.high // 1000)
                self.say(device.name, "(", *value, ")")

    def call(self) -> None:
        """A call, where the depths allow one."""
        fits = [
            name
            for name, (blocks, calls) in self.defs.items()
            if self.depth + blocks <= MAX_NESTING and 1 + calls <= MAX_CALLS - self.in_def
        ]
        if fits:
            name = self.rng.choice(fits)
            blocks, calls = self.defs[name]
            self.deepest = max(self.deepest, self.depth + blocks)
            self.called = max(self.called, 1 + calls)
            self.say(name)

    def leave(self) -> None:
        """BREAK, mostly inside an IF."""
        if self.loops == 0:
            return
        if self.chance(0.2) or self.depth >= MAX_NESTING:
            self.say("BREAK")
            return
        self.open_block("IF", *self.condition())
        self.say("BREAK")
        self.close_block("IF")

    # Blocks

    def open_block(self, *header: str) -> None:
        """Writes a header."""
        self.say(*header)
        self.depth += 1
        self.deepest = max(self.deepest, self.depth)

    def close_block(self, word: str) -> None:
        """Writes the end that belongs to a header, in one of its spellings."""
        ends = {
            "IF": ("ENDIF", "ENDIF", "END_IF"),
            "LOOP": ("END_LOOP", "END_LOOP", "ENDLOOP"),
            "WHILE": ("END_WHILE", "END_WHILE", "ENDWHILE"),
        }
        self.say(self.rng.choice(ends[word]))
        self.depth -= 1

    def choose(self) -> None:
        """IF with ELSEIF and ELSE."""
        self.open_block("IF", *self.condition())
        self.body()
        while self.chance(0.25):
            self.say("ELSEIF", *self.condition())
            self.body()
        if self.chance(0.45):
            self.say("ELSE")
            self.body()
        self.close_block("IF")

    def loop(self) -> None:
        """LOOP a few times, or FOREVER with a wait in it."""
        roll = self.rng.random()
        forever = roll < 0.15
        count: Tokens
        if forever:
            count = ["FOREVER"]
        elif roll < 0.75:
            count = [self.rng.choice(("0", "1", "2", "2", "3", "4", "1.5", "2.4999"))]
        elif roll < 0.92:
            count = ["MIN", "(", *self.number(), ",", self.rng.choice(("2", "3", "5")), ")"]
        elif roll < 0.99:
            count = ["(", *self.number(), ")", "%", self.rng.choice(("3", "4"))]
        else:
            count = self.number()
        self.open_block("LOOP", "(", *count, ")")
        self.loops += 1
        if forever and self.chance(0.97):
            self.pause()
        self.body()
        if forever and self.chance(0.4):
            self.leave()
        self.loops -= 1
        self.close_block("LOOP")

    def pause(self) -> None:
        """Lets time pass for sure."""
        time = self.rng.choice(("0.1", "0.25", "0.5", "1", "2"))
        if self.chance(0.5):
            self.say("W", "(", time, ")")
        else:
            self.say(self.rng.choice("FBLR"), "(", time, ",", *self.within(0, 100), ")")

    def repeat(self) -> None:
        """WHILE: with a counter, with a wait, or with a BREAK at its end."""
        counted = self.chance(0.5) and len(self.variables) < MAX_VARIABLES
        counter = f"N{len(self.variables)}"
        if counted and counter not in self.taken:
            self.say(counter, "=", "0")
            self.variables[counter] = False
            self.counters.add(counter)
            limit = self.rng.choice(("1", "2", "3", "4.5"))
            more = ["AND", *self.yes_no(1)] if self.chance(0.3) else []
            more = ["OR", "FALSE"] if self.chance(0.05) else more
            self.open_block("WHILE", "(", counter, "<", limit, *more, ")")
        else:
            counted = False
            self.open_block("WHILE", *self.condition())
        self.loops += 1
        self.body()
        if counted:
            self.say(counter, "=", counter, "+", "1")
        elif self.chance(0.6):
            self.pause()
        elif self.chance(0.95):
            self.say("BREAK")
        self.loops -= 1
        self.close_block("WHILE")

    def tower(self) -> None:
        """Blocks in blocks, as deep as they may be."""
        height = self.rng.randint(1, MAX_NESTING - self.depth)
        words = [self.rng.choice(("IF", "LOOP", "WHILE")) for _ in range(height)]
        for word in words:
            self.open_block(word, "(", "1" if word == "LOOP" else "TRUE", ")")
            self.loops += word != "IF"
        self.show()
        for word in reversed(words):
            if word == "WHILE":
                self.say("BREAK")
            self.loops -= word != "IF"
            self.close_block(word)

    def body(self) -> None:
        """A few instructions, perhaps none."""
        for _ in range(self.rng.choice((0, 1, 1, 1, 2, 2, 3, 4))):
            self.statement()

    def statement(self) -> None:
        """Any instruction."""
        blocks: list[tuple[int, Callable[[], None]]] = []
        if self.left > 0 and self.depth < MAX_NESTING:
            blocks = [(9, self.choose), (7, self.loop), (5, self.repeat)]
            if self.chance(0.05):
                blocks.append((5, self.tower))
        others: list[tuple[int, Callable[[], None]]] = [
            (14, self.move),
            (9, self.simple),
            (13, self.show),
            (18, self.assign),
            (9, self.read),
            (6, self.set),
            (8, self.call),
            (3, self.leave),
        ]
        weights, writers = zip(*blocks, *others, strict=True)
        self.rng.choices(writers, weights)[0]()

    def define(self) -> None:
        """A DEF."""
        free = self.free_defs
        if not free or len(self.defs) == MAX_DEFS:
            return
        name = free.pop(self.rng.randrange(len(free)))
        self.say("DEF", name)
        deepest, called = self.deepest, self.called
        self.deepest, self.called, self.in_def = 0, 0, True
        for _ in range(self.rng.randint(0, 4)):
            self.statement()
        self.defs[name] = (self.deepest, self.called)
        self.deepest, self.called, self.in_def = deepest, called, False
        self.say(self.rng.choice(("END_DEF", "ENDDEF")))

    def chain(self) -> None:
        """DEFs that call each other, as deep as they may."""
        before = ""
        for number in range(self.rng.randint(2, MAX_CALLS)):
            name = f"CHAIN{number}"
            self.say("DEF", name)
            self.say(before) if before else self.show()
            self.say("END_DEF")
            self.defs[name] = (0, number)
            before = name
        self.say(before)

    def crowd(self) -> None:
        """As many variables as there may be."""
        for number in range(MAX_VARIABLES - len(self.variables)):
            name = f"MANY{number}"
            self.say(name, "=", str(number))
            self.variables[name] = False

    def program(self) -> list[Tokens]:
        """A whole program."""
        roll = self.rng.random()
        size = self.rng.randint(1, 8)
        if roll < 0.4:
            size = self.rng.randint(6, 25)
        if roll < 0.1:
            size = self.rng.randint(20, 60)
        self.left = size
        if self.chance(0.01):
            self.chain()
        if self.chance(0.005):
            self.crowd()
        while self.left > 0:
            if self.chance(0.1 if self.defs else 0.06):
                self.define()
            else:
                self.statement()
        return self.page


# --- Layout -----------------------------------------------------------------------------------

COMMENTS = ("", " go", " F(1, 50); S", " ¿qué? (ñandú)", " )", " // again", " SI|", "\ttab | ; (")


class Layout:
    """Turns instructions into text, with one style for the whole of it."""

    def __init__(self, rng: random.Random) -> None:
        """Chooses the style."""
        self.rng = rng
        self.case = rng.choice(("upper", "upper", "lower", "any"))
        self.gaps = rng.choice(("tight", "normal", "normal", "wild"))
        self.ends = rng.choice(("one line", "lines", "both", "mixed"))
        self.indent = rng.choice(("", "  ", "\t"))
        self.newline = rng.choice(("\n", "\n", "\r\n"))

    def comment(self) -> str:
        """A comment and the end of its line."""
        return f"//{self.rng.choice(COMMENTS)}{self.newline}"

    def word(self, token: str) -> str:
        """A token in the case of the style."""
        if self.case == "upper":
            return token
        if self.case == "lower":
            return token.lower()
        return "".join(self.rng.choice((c.upper(), c.lower())) for c in token)

    def gap(self, left: str, right: str, in_parentheses: bool) -> str:
        """What stands between two tokens of an instruction."""
        rng = self.rng
        wordy = left[-1] not in "(),=<>+-*/%" and right[0] not in "(),=<>+-*/%"
        if self.ends != "one line" and in_parentheses and rng.random() < 0.02:
            return f" {self.newline}  " if rng.random() < 0.7 else f" {self.comment()}"
        if self.gaps == "wild":
            space = rng.choice(("", " ", "  ", "\t", "\u00a0", ""))
        elif self.gaps == "normal":
            bare = left in "()" or right in "(),"
            space = "" if bare and right != "UNTIL" else " "
        else:
            space = ""
        return " " if wordy and not space else space

    def instruction(self, tokens: Tokens) -> str:
        """One instruction, without its end."""
        text, depth = self.word(tokens[0]), 0
        for left, right in itertools.pairwise(tokens):
            depth += {"(": 1, ")": -1}.get(left, 0)
            text += self.gap(left, right, depth > 0) + self.word(right)
        return text

    def end(self) -> str:
        """What ends an instruction: at least one ; or end of line, and perhaps empty ones."""
        rng = self.rng
        if self.ends == "one line":
            return rng.choice((";", ";", ";", "; ", ";;" if rng.random() < 0.1 else ";"))
        line = f" {self.comment()}" if rng.random() < 0.06 else self.newline
        line += self.newline if rng.random() < 0.05 else ""
        line += self.comment() if rng.random() < 0.04 else ""
        line += self.indent
        if self.ends == "lines":
            return line
        if self.ends == "both":
            return f";{line}"
        return rng.choice((";", "; ", f";{line}", line, line))

    def program(self, page: list[Tokens]) -> str:
        """The whole text."""
        rng = self.rng
        setup = rng.choice(("", "", "SI|", "SB|"))
        if setup:
            setup = self.word(setup)
            setup += rng.choice(("", "", " ", "" if self.ends == "one line" else self.newline))
        text = setup
        for tokens in page:
            text += self.instruction(tokens) + self.end()
        if rng.random() < 0.5:
            text = text.rstrip(" ;\t\r\n\u00a0")
        if rng.random() < 0.1:
            text = self.newline.join(map(self.checked, text.split(self.newline)))
        return ("\ufeff" if rng.random() < 0.03 else "") + text

    def checked(self, line: str) -> str:
        """A line with its checksum, or without one."""
        if self.rng.random() < 0.5:
            return line
        digits = f"{zlib.crc32(line.encode()):08x}"
        return f"{line}~{self.rng.choice((digits, digits.upper()))}{self.rng.choice(('', ' '))}"


def program(rng: random.Random, kit: Kit) -> str:
    """A valid program."""
    if rng.random() < 0.002:
        return rng.choice(("PING|check_connection", "ping|CHECK_CONNECTION\n", "", "SI|", "// -"))
    return Layout(rng).program(Author(rng, kit).program())


def senses(rng: random.Random, kit: Kit) -> dict[str, list[int]]:
    """Readings in thousandths for some of the sensors, each within its range."""
    found: dict[str, list[int]] = {}
    for device in kit.sensors:
        if rng.random() < 0.25:
            continue
        readings: list[int] = []
        for _ in range(rng.randint(1, 8)):
            value = rng.randint(device.low, device.high)
            if not device.is_yes_no:
                value = rng.choice((value, value % 20_000, value // 1000 * 1000, device.low, 9_000))
                value = max(device.low, min(device.high, value))
            readings.append(value)
        found[device.name] = readings
    return found


_PIECES = re.compile(r"[A-Za-z0-9_.]+|\s+|.", re.DOTALL)
_NOISE = "~();,|=<>+-*/%._ \n\t'\"#@!?&[]{}0123456789abcEFLWXYZñé¿½"
_WORDS = (
    "IF", "ELSE", "ELSEIF", "ENDIF", "LOOP", "END_LOOP", "WHILE", "END_WHILE", "BREAK", "DEF",
    "END_DEF", "UNTIL", "FOREVER", "SI", "SB", "|", "PING", "TRUE", "AND", "NOT", "X", "DISTANCE",
    "TIME", "5", "100.4", "2147483.648", "-", "RANDOM", "(", ")", ",", ";", "\n", "TASK",
)  # fmt: skip


def broken(rng: random.Random, text: str) -> str:
    """The text with a few pieces lost, doubled, swapped or replaced, or with stray characters."""
    pieces = _PIECES.findall(text)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        at = rng.randrange(len(pieces) + 1)
        what = rng.randrange(7)
        if what == 0 or at == len(pieces):
            pieces.insert(at, rng.choice(_NOISE))
        elif what == 1:
            del pieces[at]
        elif what == 2:
            pieces.insert(at, pieces[at])
        elif what == 3:
            other = rng.randrange(len(pieces))
            pieces[at], pieces[other] = pieces[other], pieces[at]
        elif what == 4:
            pieces[at] = rng.choice(_WORDS)
        elif what == 5:
            pieces.insert(at, rng.choice(_WORDS))
        else:
            cut = rng.randrange(len(pieces[at]) + 1)
            pieces[at] = pieces[at][:cut] + rng.choice(_NOISE) + pieces[at][cut + 1 :]
    return "".join(pieces)
