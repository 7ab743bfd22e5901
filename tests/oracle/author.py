"""Writes random programs as lists of instructions, each a list of words and signs."""

from __future__ import annotations

from collections.abc import Callable

from tests.oracle.author_values import (
    LONG_DECIMALS,
    SMALL_NUMBERS,
    WIDE_RANGE_NUMBERS,
    Tokens,
    ValueAuthor,
    is_single_number,
)
from tests.oracle.words import (
    ACTS,
    MAX_CALLS,
    MAX_DEFS,
    MAX_NESTING,
    MAX_STACK,
    MAX_VARIABLES,
    RANGES,
    TIME,
)


class Author(ValueAuthor):
    # Instructions

    def move(self) -> None:
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
        if self.ways and word != "W" and time != ["FOREVER"] and self.chance(0.5):
            time = self.way(word)
        self.say(word, "(", *time, *power, ")", *until)

    def way(self, word: str) -> Tokens:
        """Return the distance of a move, with its unit."""
        words = ("CM", "cm") if word in "FB" else ("DEG", "deg", "°", "º")
        roll = self.rng.random()
        if roll < 0.6:
            way = [self.rng.choice((*SMALL_NUMBERS, *WIDE_RANGE_NUMBERS, *LONG_DECIMALS))]
        else:
            way = self.seconds() if roll < 0.8 else self.number(2)
        if is_single_number(way) and way[0].startswith("-"):
            way = ["0"]
        return [*way, self.rng.choice(words)]

    def simple(self) -> None:
        word = self.rng.choice(("M", "M", "S", "STOP", "W", *ACTS, *ACTS, "START"))
        values: Tokens = []
        for limits in RANGES.get(word, ()):
            value = self.seconds() if limits == TIME else self.within(*(n // 1000 for n in limits))
            values += [",", *value] if values else value
        self.say(word, *(["(", *values, ")"] if values else []))

    def show(self) -> None:
        value = self.yes_no() if self.chance(0.25) else self.number(3)
        self.say("SHOW", "(", *value, ")")

    def assign(self) -> None:
        targets = [name for name in self.variables if name not in self.counters]
        if self.names and self.has_room and self.chance(0.5):
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
            value = self.write_deep_number()
        self.constant = False
        self.variables[name] = kind
        self.say(name, "=", *value)

    def write_deep_number(self) -> Tokens:
        """A number that needs nearly all or all of the stack."""
        leaves = self.rng.randint(MAX_STACK - 3, MAX_STACK)
        tokens = self.leaf()
        for _ in range(leaves - 1):
            tokens = [*self.leaf(), self.rng.choice("+-"), "(", *tokens, ")"]
        return tokens

    def read(self) -> None:
        if self.sensors:
            self.say(self.rng.choice(self.sensors).name)

    def set(self) -> None:
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
            self.say_call(self.rng.choice(fits))

    def say_call(self, name: str) -> None:
        blocks, calls = self.defs[name]
        self.deepest = max(self.deepest, self.depth + blocks)
        self.called = max(self.called, 1 + calls)
        values: Tokens = []
        for kind in self.kinds[name]:
            size = self.rng.choice((0, 1, 2))
            values += [",", *(self.yes_no(size) if kind else self.number(size))]
        empty = ["(", ")"] if self.chance(0.1) else []
        self.say(name, *(["(", *values[1:], ")"] if values else empty))

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
        self.say(*header)
        self.depth += 1
        self.deepest = max(self.deepest, self.depth)

    def close_block(self, word: str) -> None:
        """Writes the end that belongs to a header, in one of its spellings."""
        ends_by_word = {
            "IF": ("ENDIF", "ENDIF", "END_IF"),
            "LOOP": ("END_LOOP", "END_LOOP", "ENDLOOP"),
            "WHILE": ("END_WHILE", "END_WHILE", "ENDWHILE"),
        }
        self.say(self.rng.choice(ends_by_word[word]))
        self.depth -= 1

    def choose(self) -> None:
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
        is_forever = roll < 0.15
        count: Tokens
        if is_forever:
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
        if is_forever and self.chance(0.97):
            self.pause()
        self.body()
        if is_forever and self.chance(0.4):
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
        is_counted = self.chance(0.5) and self.has_room
        counter = f"N{len(self.variables)}"
        if is_counted and counter not in self.taken:
            self.say(counter, "=", "0")
            self.variables[counter] = False
            self.counters.add(counter)
            limit = self.rng.choice(("1", "2", "3", "4.5"))
            extra_tokens = ["AND", *self.yes_no(1)] if self.chance(0.3) else []
            extra_tokens = ["OR", "FALSE"] if self.chance(0.05) else extra_tokens
            self.open_block("WHILE", "(", counter, "<", limit, *extra_tokens, ")")
        else:
            is_counted = False
            self.open_block("WHILE", *self.condition())
        self.loops += 1
        self.body()
        if is_counted:
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
        for _ in range(self.rng.choice((0, 1, 1, 1, 2, 2, 3, 4))):
            self.statement()

    def statement(self) -> None:
        blocks: list[tuple[int, Callable[[], None]]] = []
        if self.instructions_left > 0 and self.depth < MAX_NESTING:
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
        free = self.free_defs
        if not free or len(self.defs) == MAX_DEFS:
            return
        name = free.pop(self.rng.randrange(len(free)))
        values = self.own_values()
        brackets = ["(", *values[1:], ")"] if values or self.chance(0.1) else []
        self.say("DEF", name, *brackets)
        names = values[1::2]
        kinds = {name: self.chance(0.3) for name in names}
        self.kinds[name] = tuple(kinds.values())
        self.given += len(names)
        deepest, call_depth = self.deepest, self.called
        self.deepest, self.called, self.in_def = 0, 0, True
        self.variables |= kinds
        for _ in range(self.rng.randint(0, 4)):
            self.statement()
        for value_name in names:
            del self.variables[value_name]
        self.defs[name] = (self.deepest, self.called)
        self.deepest, self.called, self.in_def = deepest, call_depth, False
        self.say(self.rng.choice(("END_DEF", "ENDDEF")))
        if any(kinds.values()):  # the first call decides; its values do not use the DEF's own
            self.constant = True
            self.say_call(name)
            self.constant = False

    def own_values(self) -> Tokens:
        """The names in the brackets of a DEF, with a comma before each."""
        count = self.rng.choice((0, 0, 0, 1, 1, 2, 3, 4))
        if len(self.variables) + self.given + count > MAX_VARIABLES:
            return []
        return [token for name in self.rng.sample(self.values, count) for token in (",", name)]

    @property
    def has_room(self) -> bool:
        """Return whether there is room for another variable."""
        return len(self.variables) + self.given < MAX_VARIABLES

    def chain(self) -> None:
        """DEFs that call each other, as deep as they may."""
        text_before = ""
        for number in range(self.rng.randint(2, MAX_CALLS)):
            name = f"CHAIN{number}"
            self.say("DEF", name)
            self.say(text_before) if text_before else self.show()
            self.say("END_DEF")
            self.defs[name], self.kinds[name] = (0, number), ()
            text_before = name
        self.say(text_before)

    def crowd(self) -> None:
        """Add the largest number of variables."""
        for number in range(MAX_VARIABLES - len(self.variables) - self.given):
            name = f"MANY{number}"
            self.say(name, "=", str(number))
            self.variables[name] = False

    def program(self) -> list[Tokens]:
        roll = self.rng.random()
        size = self.rng.randint(1, 8)
        if roll < 0.4:
            size = self.rng.randint(6, 25)
        if roll < 0.1:
            size = self.rng.randint(20, 60)
        self.instructions_left = size
        if self.chance(0.01):
            self.chain()
        if self.chance(0.005):
            self.crowd()
        while self.instructions_left > 0:
            if self.chance(0.1 if self.defs else 0.06):
                self.define()
            else:
                self.statement()
        return self.page
