"""Reads the text of a TiniScript program and checks all that can be wrong with it.

It shares nothing with the compiler. The result is a tree in which every instruction knows which
readings it takes. Numbers are Python integers that count thousandths; yes/no values are bools.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple, NoReturn


class Device(NamedTuple):
    """A sensor or an actuator; low and high are thousandths (0 and 1 for yes/no)."""

    name: str
    is_yes_no: bool
    low: int
    high: int


class Kit(NamedTuple):
    """What a robot has."""

    sensors: tuple[Device, ...]
    actuators: tuple[Device, ...]


PAPER_KIT = Kit(
    sensors=(
        Device("LIGHT_R", False, 0, 1_023_000),
        Device("LIGHT_L", False, 0, 1_023_000),
        Device("DISTANCE", False, 0, 400_000),
    ),
    actuators=(),
)


class Mistake(Exception):
    """The program is wrong; the text says why."""


LOWEST = -(2**31)
HIGHEST = 2**31 - 1
MAX_VARIABLES = 32
MAX_NESTING = 16
MAX_STACK = 16
MAX_DEFS = 16
MAX_CALLS = 8

SETUPS = ("PING", "SI", "SB")
COMPARATORS = ("=", "<>", "<", ">", "<=", ">=")
FUNCTIONS = {"ROUND": 2, "ABS": 1, "MIN": 2, "MAX": 2, "RANDOM": 2}
MOVES = ("F", "B", "L", "R")

# The other spellings that are accepted for the ends of blocks.
ALIASES = {
    "END_IF": "ENDIF",
    "ENDLOOP": "END_LOOP",
    "ENDWHILE": "END_WHILE",
    "ENDDEF": "END_DEF",
}
BLOCK_WORDS = ("ELSEIF", "ELSE", "ENDIF", "END_LOOP", "END_WHILE", "END_DEF")
LATER_WORDS = ("TASK", "END_TASK", "WHEN", "END_WHEN", "SEND")

# Instructions with arguments in parentheses, and the range of each argument.
_TIME = (0, HIGHEST)
_POWER = (0, 100_000)
_SIDE = (-100_000, 100_000)
RANGES: dict[str, tuple[tuple[int, int], ...]] = {
    "F": (_TIME, _POWER),
    "B": (_TIME, _POWER),
    "L": (_TIME, _POWER),
    "R": (_TIME, _POWER),
    "M": (_SIDE, _SIDE),
    "W": (_TIME,),
    "BEEP": (_TIME, (31_000, 20_000_000)),
}

RESERVED = frozenset(
    (
        *SETUPS, *MOVES, *FUNCTIONS, *ALIASES, *BLOCK_WORDS, *LATER_WORDS,
        "M", "S", "STOP", "W", "UNTIL", "FOREVER", "BEEP", "SHOW", "IF", "LOOP", "WHILE",
        "BREAK", "DEF", "START", "TRUE", "FALSE", "AND", "OR", "NOT", "TIME",
    )
)  # fmt: skip


# --- Text -------------------------------------------------------------------------------------


class Token(NamedTuple):
    """A word (in capitals), number, symbol, newline, or the end of the text."""

    kind: str
    text: str
    line: int


_TOKEN = re.compile(
    r"""(?P<space>[ \t\u00a0\u202f]+|//[^\n]*)
      | (?P<newline>\n)
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?![A-Za-z0-9_.]))
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)
      | (?P<symbol><=|>=|<>|[-+*/%=<>(),;|])""",
    re.VERBOSE,
)


def without_checksum(line: str) -> str:
    """A line without the checksum at its first ~, if there is one; it must fit."""
    before, _, behind = line.partition("~")
    digits = behind.rstrip(" \t\u00a0\u202f")
    if not re.fullmatch(r"[0-9A-Fa-f]{8}", digits):
        return line
    if int(digits, 16) != zlib.crc32(before.encode()):
        raise Mistake(f"{line!r} does not fit its checksum")
    return before


def tokens_of(text: str) -> list[Token]:
    """Cuts a text into tokens; an end of line inside parentheses is white space."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    text = "\n".join(map(without_checksum, text.split("\n")))
    found: list[Token] = []
    line, depth, at = 1, 0, 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise Mistake(f"line {line}: {text[at]!r} is not understood")
        kind, word = str(match.lastgroup), match.group().upper()
        at = match.end()
        if kind == "symbol" and word in "()":
            depth = max(0, depth + (1 if word == "(" else -1))
        if word == ";" and depth > 0:
            raise Mistake(f"line {line}: a ; inside parentheses")
        if kind != "space" and not (kind == "newline" and depth > 0):
            found.append(Token(kind, word, line))
        if kind == "newline":
            line += 1
    found.append(Token("end", "", line))
    return found


def thousandths(text: str) -> int:
    """The value of a literal, rounded half away from zero; it may be out of range."""
    whole, _, places = text.partition(".")
    whole = whole.lstrip("0")
    if len(whole) > 10:
        return 10**13  # out of range anyhow
    value = int(whole or "0") * 1000 + int((places + "000")[:3])
    return value + (1 if len(places) > 3 and places[3] >= "5" else 0)


# --- Programs ---------------------------------------------------------------------------------

Value = int | bool


@dataclass(frozen=True)
class Expression:
    """An operator, a function or a leaf.

    `operator` is NUMBER, TRUTH, VARIABLE, SENSOR, TIME, MINUS, NOT, or the word or sign of the
    language. `plain` marks a number that stands alone: with or without one minus, and without
    parentheses.
    """

    operator: str
    is_yes_no: bool
    parts: tuple[Expression, ...] = ()
    value: Value = 0
    name: str = ""
    plain: bool = False


@dataclass
class Do:
    """An instruction without a body; the FOREVER of a move or wait is a None argument.

    `reads` are the readings that are taken before anything of the instruction is evaluated,
    `until_reads` those before each check of UNTIL.
    """

    word: str
    name: str = ""
    arguments: tuple[Expression | None, ...] = ()
    until: Expression | None = None
    reads: tuple[str, ...] = ()
    until_reads: tuple[str, ...] = ()


@dataclass
class Arm:
    """One arm of an IF: its condition (None for ELSE) and what it does."""

    condition: Expression | None
    body: list[Statement]
    reads: tuple[str, ...] = ()


@dataclass
class If:
    """An IF with its ELSEIFs and its ELSE."""

    arms: list[Arm]


@dataclass
class Loop:
    """A LOOP; the count None is FOREVER."""

    count: Expression | None
    body: list[Statement]
    reads: tuple[str, ...] = ()


@dataclass
class While:
    """A WHILE."""

    condition: Expression
    body: list[Statement]
    reads: tuple[str, ...] = ()


Statement = Do | If | Loop | While


@dataclass
class Program:
    """A program that has passed every check."""

    main: list[Statement]
    defs: dict[str, list[Statement]]
    variables: dict[str, bool]  # name: is it a yes/no value


class Facts(NamedTuple):
    """What a call of a DEF brings along."""

    nesting: int  # blocks open in it at once
    calling: int  # DEFs that it has open at once, itself not counted
    surely_read: frozenset[str]


def stack_need(expression: Expression) -> int:
    """How many values the text of an expression keeps at once."""
    return max([1, *(i + stack_need(part) for i, part in enumerate(expression.parts))])


def sensors_in(expressions: Iterable[Expression | None]) -> tuple[str, ...]:
    """The sensors that are named, each once, in order of appearance."""
    found: dict[str, None] = {}

    def look(expression: Expression) -> None:
        if expression.operator == "SENSOR":
            found[expression.name] = None
        for part in expression.parts:
            look(part)

    for expression in expressions:
        if expression is not None:
            look(expression)
    return tuple(found)


class Parser:
    """Reads a program and checks everything that can be wrong with its text."""

    def __init__(self, text: str, kit: Kit) -> None:
        """Cuts the text."""
        self.tokens = tokens_of(text)
        self.at = 0
        self.sensors = {device.name: device for device in kit.sensors}
        self.actuators = {device.name: device for device in kit.actuators}
        self.variables: dict[str, bool] = {}
        self.defs: dict[str, list[Statement]] = {}
        self.open_def = ""  # the DEF that is being read
        self.loops = 0  # loops open here, in this DEF or in the program
        self.blocks = 0

    # Tokens

    @property
    def token(self) -> Token:
        """The next token."""
        return self.tokens[self.at]

    def fail(self, why: str) -> NoReturn:
        """Refuses the program."""
        raise Mistake(f"line {self.token.line}: {why}")

    def next_is(self, *texts: str) -> bool:
        """Whether the next token is one of these words or signs."""
        return self.token.kind in ("word", "symbol") and self.token.text in texts

    def accept(self, *texts: str) -> str:
        """Takes the next token if it is one of these; else returns an empty string."""
        if not self.next_is(*texts):
            return ""
        self.at += 1
        return self.tokens[self.at - 1].text

    def expect(self, text: str) -> None:
        """Takes the next token, which must be this one."""
        if not self.accept(text):
            self.fail(f"{text} expected, not {self.token.text!r}")

    def accept_separator(self) -> bool:
        """Takes a ; or an end of line if one is next."""
        if self.token.kind != "newline" and not self.next_is(";"):
            return False
        self.at += 1
        return True

    # The program and its blocks

    def program(self) -> Program:
        """SETUP|INSTRUCTIONS."""
        while self.token.kind == "newline":
            self.at += 1
        if self.next_is(*SETUPS) and self.tokens[self.at + 1].text == "|":
            setup = self.accept(*SETUPS)
            self.expect("|")
            if setup == "PING":
                self.ping()
                return Program([], {}, {})
        main = self.block()
        if self.token.kind != "end":
            self.fail(f"{self.token.text} without its beginning")
        facts: dict[str, Facts] = {}
        for name, body in self.defs.items():  # in the order of the text: calls only look back
            facts[name] = self.settle(body, facts)
        self.settle(main, facts)
        return Program(main, self.defs, self.variables)

    def settle(self, body: list[Statement], defs: Mapping[str, Facts]) -> Facts:
        """Settles the readings of the program or of a DEF and checks its depths."""
        nested, called = nesting(body, defs), calling(body, defs)
        if nested > MAX_NESTING:
            self.fail("blocks nested too deep")
        if called > MAX_CALLS:
            self.fail("DEFs called too deep")
        return Facts(nested, called, settle_readings(body, frozenset(), defs))

    def ping(self) -> None:
        """PING|check_connection has nothing else but empty instructions."""
        while self.accept_separator():
            pass
        self.expect("CHECK_CONNECTION")
        while self.accept_separator():
            pass
        if self.token.kind != "end":
            self.fail("something after PING|check_connection")

    def block(self) -> list[Statement]:
        """Instructions up to the word that ends or divides a block, or the end of the text."""
        body: list[Statement] = []
        while self.token.kind != "end" and not self.next_is(*BLOCK_WORDS, *ALIASES):
            if self.accept_separator():
                continue
            statement = self.instruction()
            if statement is not None:
                body.append(statement)
            self.end_of_instruction()
        return body

    def end_of_instruction(self) -> None:
        """Every instruction, block header and block end needs a ; or an end of line after it."""
        if self.token.kind != "end" and not self.accept_separator():
            self.fail(f"the instruction should end before {self.token.text!r}")

    def inner_block(self, *ends: str) -> list[Statement]:
        """A header's end, a body, and the check that the right word ends it (not taken)."""
        self.end_of_instruction()
        body = self.block()
        if ALIASES.get(self.token.text, self.token.text) not in ends:
            self.fail(f"{' or '.join(ends)} expected, not {self.token.text!r}")
        return body

    def instruction(self) -> Statement | None:
        """One instruction, with its block if it has one; None for START and DEF."""
        if self.token.kind != "word":
            self.fail(f"an instruction cannot begin with {self.token.text!r}")
        word = self.token.text
        self.at += 1
        if word == "START":
            return None
        if word == "DEF":
            self.definition()
            return None
        if word == "IF":
            return self.choice()
        if word in ("LOOP", "WHILE"):
            return self.repetition(word)
        if word in RANGES:
            return self.action(word)
        if word in ("S", "STOP"):
            return Do("S")
        if word == "SHOW":
            (value,) = self.arguments(1)
            return self.checked(Do("SHOW", arguments=(value,)))
        if word == "BREAK":
            if self.loops == 0:
                self.fail("BREAK outside a loop")
            return Do("BREAK")
        if word in RESERVED:
            self.fail(f"{word} cannot begin an instruction")
        return self.named(word)

    def definition(self) -> None:
        """DEF NAME … END_DEF: at the top level only; its name is callable after END_DEF."""
        if self.blocks > 0 or self.open_def:
            self.fail("a DEF inside a block")
        name = self.token.text
        if self.token.kind != "word" or name in RESERVED:
            self.fail("a DEF needs a name")
        if name in (*self.variables, *self.defs, *self.sensors, *self.actuators):
            self.fail(f"the name {name} is taken")
        if len(self.defs) == MAX_DEFS:
            self.fail("too many DEFs")
        self.at += 1
        self.open_def = name
        body = self.inner_block("END_DEF")
        self.at += 1
        self.open_def = ""
        self.defs[name] = body

    def choice(self) -> If:
        """IF … ELSEIF … ELSE … ENDIF."""
        arms: list[Arm] = []
        self.blocks += 1
        word = "IF"
        while word != "ENDIF":
            condition = None if word == "ELSE" else self.condition()
            ends = ("ENDIF",) if word == "ELSE" else ("ELSEIF", "ELSE", "ENDIF")
            arms.append(Arm(condition, self.inner_block(*ends)))
            word = ALIASES.get(self.token.text, self.token.text)
            self.at += 1
        self.blocks -= 1
        return If(arms)

    def repetition(self, word: str) -> Loop | While:
        """LOOP(n) … END_LOOP and WHILE(c) … END_WHILE."""
        count: Expression | None = None
        condition: Expression | None = None
        if word == "WHILE":
            condition = self.condition()
        else:
            (count,) = self.arguments(1, forever=True)
            self.want_number(count)
            self.want_stack((count,))
        self.blocks += 1
        self.loops += 1
        body = self.inner_block(f"END_{word}")
        self.at += 1
        self.blocks -= 1
        self.loops -= 1
        return Loop(count, body) if condition is None else While(condition, body)

    def action(self, word: str) -> Do:
        """F B L R M W BEEP, with the UNTIL that all but M and BEEP may have."""
        ranges = RANGES[word]
        may_until = word in (*MOVES, "W")
        arguments = self.arguments(len(ranges), forever=may_until)
        for argument, (low, high) in zip(arguments, ranges, strict=True):
            self.want_number(argument)
            self.want_range(argument, low, high)
        until: Expression | None = None
        if may_until and self.accept("UNTIL"):
            until = self.condition()
        if arguments[0] is None and until is None:
            self.fail("FOREVER needs UNTIL")
        return self.checked(Do(word, arguments=arguments, until=until))

    def named(self, name: str) -> Do:
        """An instruction that begins with a name: assignment, reading, call or actuator."""
        if self.accept("="):
            if name in (*self.sensors, *self.actuators, *self.defs, self.open_def):
                self.fail(f"{name} is not a variable")
            # The expression comes first: it may not use the variable that begins here.
            value = self.expression()
            if self.variables.setdefault(name, value.is_yes_no) != value.is_yes_no:
                self.fail(f"{name} has the other kind")
            if len(self.variables) > MAX_VARIABLES:
                self.fail("too many variables")
            return self.checked(Do("=", name, (value,)))
        if name in self.actuators:
            device = self.actuators[name]
            (argument,) = self.arguments(1)
            if device.is_yes_no:
                self.want_yes_no(argument)
            else:
                self.want_number(argument)
                self.want_range(argument, device.low, device.high)
            return self.checked(Do("SET", name, (argument,)))
        if name in self.sensors:
            return Do("READ", name)
        if name in self.defs:
            return Do("CALL", name)
        self.fail(f"{name} is not an instruction here")

    def checked(self, statement: Do) -> Do:
        """The same instruction, if the stack holds its values."""
        self.want_stack(statement.arguments)
        return statement

    # Arguments

    def arguments(self, count: int, forever: bool = False) -> tuple[Expression | None, ...]:
        """Exactly so many in parentheses; the first may be FOREVER (None) where that fits."""
        self.expect("(")
        found: list[Expression | None] = []
        for number in range(count):
            if number > 0:
                self.expect(",")
            if number == 0 and forever and self.accept("FOREVER"):
                found.append(None)
            else:
                found.append(self.expression())
        self.expect(")")
        return tuple(found)

    def condition(self) -> Expression:
        """A yes/no value in parentheses."""
        (condition,) = self.arguments(1)
        assert condition is not None
        self.want_yes_no(condition)
        self.want_stack((condition,))
        return condition

    def want_number(self, expression: Expression | None) -> None:
        """Refuses a yes/no value."""
        if expression is not None and expression.is_yes_no:
            self.fail("a number is needed, not a yes/no value")

    def want_yes_no(self, expression: Expression | None) -> None:
        """Refuses a number."""
        if expression is not None and not expression.is_yes_no:
            self.fail("a yes/no value is needed, not a number")

    def want_range(self, expression: Expression | None, low: int, high: int) -> None:
        """Refuses a lone number out of range; any other expression is limited when it runs."""
        if expression is not None and expression.plain and not low <= expression.value <= high:
            self.fail("the number is out of range")

    def want_stack(self, arguments: tuple[Expression | None, ...]) -> None:
        """Refuses what needs more values at once than there is room for."""
        for place, argument in enumerate(arguments):
            if place + (1 if argument is None else stack_need(argument)) > MAX_STACK:
                self.fail("the expression is too long")

    # Expressions, from loosest to tightest

    def expression(self) -> Expression:
        """An expression of any kind."""
        return self.logic("OR", lambda: self.logic("AND", self.negation))

    def logic(self, operator: str, tighter: Callable[[], Expression]) -> Expression:
        """A chain of ANDs or of ORs."""
        left = tighter()
        while self.accept(operator):
            self.want_yes_no(left)
            right = tighter()
            self.want_yes_no(right)
            left = Expression(operator, True, (left, right))
        return left

    def negation(self) -> Expression:
        """NOT is looser than the comparators: NOT X = 5 is NOT (X = 5)."""
        if self.accept("NOT"):
            value = self.negation()
            self.want_yes_no(value)
            return Expression("NOT", True, (value,))
        return self.comparison()

    def comparison(self) -> Expression:
        """Two numbers, or two yes/no values for = and <>; comparators do not chain."""
        left = self.sum()
        operator = self.accept(*COMPARATORS)
        if not operator:
            return left
        right = self.sum()
        if left.is_yes_no != right.is_yes_no:
            self.fail("a number is compared with a yes/no value")
        if left.is_yes_no and operator not in ("=", "<>"):
            self.fail("yes/no values have no order")
        if self.next_is(*COMPARATORS):
            self.fail("comparators do not chain")
        return Expression(operator, True, (left, right))

    def sum(self) -> Expression:
        """Terms with + and -."""
        return self.arithmetic(("+", "-"), self.product)

    def product(self) -> Expression:
        """Factors with *, / and %."""
        return self.arithmetic(("*", "/", "%"), self.factor)

    def arithmetic(
        self, operators: tuple[str, ...], tighter: Callable[[], Expression]
    ) -> Expression:
        """A chain of operators of the same strength, from left to right."""
        left = tighter()
        while operator := self.accept(*operators):
            self.want_number(left)
            right = tighter()
            self.want_number(right)
            left = Expression(operator, False, (left, right))
        return left

    def factor(self) -> Expression:
        """A leaf, perhaps after minuses; a minus right before a number belongs to the number."""
        if self.accept("-"):
            if self.token.kind == "number":
                return self.number(-1)
            value = self.factor()
            self.want_number(value)
            return Expression("MINUS", False, (value,))
        if self.token.kind == "number":
            return self.number(1)
        return self.leaf()

    def number(self, sign: int) -> Expression:
        """A literal."""
        value = sign * thousandths(self.token.text)
        if not LOWEST <= value <= HIGHEST:
            self.fail("the number is out of range")
        self.at += 1
        return Expression("NUMBER", False, value=value, plain=True)

    def leaf(self) -> Expression:
        """Parentheses, a function, TRUE, FALSE, TIME, a sensor or a variable."""
        if self.accept("("):
            inner = self.expression()
            self.expect(")")
            return replace(inner, plain=False)
        if self.token.kind != "word":
            self.fail(f"a value is expected, not {self.token.text!r}")
        word = self.token.text
        self.at += 1
        if word in FUNCTIONS:
            arguments = self.arguments(FUNCTIONS[word])
            for argument in arguments:
                self.want_number(argument)
            return Expression(word, False, tuple(a for a in arguments if a is not None))
        if word in ("TRUE", "FALSE"):
            return Expression("TRUTH", True, value=word == "TRUE")
        if word == "TIME":
            return Expression("TIME", False)
        if word in self.sensors:
            return Expression("SENSOR", self.sensors[word].is_yes_no, name=word)
        if word in self.variables:
            return Expression("VARIABLE", self.variables[word], name=word)
        self.fail(f"{word} has no value here")


def inner_blocks(statement: Statement) -> list[list[Statement]]:
    """The bodies of a statement."""
    if isinstance(statement, If):
        return [arm.body for arm in statement.arms]
    return [] if isinstance(statement, Do) else [statement.body]


def nesting(body: list[Statement], defs: Mapping[str, Facts]) -> int:
    """How deep blocks are open in a body; those of a DEF count on top of those at its call."""
    deepest = 0
    for statement in body:
        for inner in inner_blocks(statement):
            deepest = max(deepest, 1 + nesting(inner, defs))
        if isinstance(statement, Do) and statement.word == "CALL":
            deepest = max(deepest, defs[statement.name].nesting)
    return deepest


def calling(body: list[Statement], defs: Mapping[str, Facts]) -> int:
    """How many DEFs a body has open at once."""
    deepest = 0
    for statement in body:
        for inner in inner_blocks(statement):
            deepest = max(deepest, calling(inner, defs))
        if isinstance(statement, Do) and statement.word == "CALL":
            deepest = max(deepest, 1 + defs[statement.name].calling)
    return deepest


def settle_readings(
    body: list[Statement], sure: frozenset[str], defs: Mapping[str, Facts]
) -> frozenset[str]:
    """Writes down which readings each instruction takes.

    `sure` are the sensors that have surely been read by name before the body; what has surely
    been read after it is returned. Only `X;` makes X surely read.
    """

    def missing(expressions: Iterable[Expression | None], known: frozenset[str]) -> tuple[str, ...]:
        return tuple(name for name in sensors_in(expressions) if name not in known)

    nothing: frozenset[str] = frozenset()
    for statement in body:
        if isinstance(statement, Do):
            statement.reads = missing(statement.arguments, sure)
            # UNTIL is there to watch: it takes every sensor of its condition at every check.
            statement.until_reads = sensors_in((statement.until,))
            if statement.word == "READ":
                sure |= {statement.name}
            elif statement.word == "CALL":
                # A DEF's body begins with nothing surely read, and a call adds what it leaves.
                sure |= defs[statement.name].surely_read
        elif isinstance(statement, If):
            taken = sure  # what this chain need not take (again)
            ends: list[frozenset[str]] = []
            for arm in statement.arms:
                arm.reads = missing((arm.condition,), taken)
                taken |= set(arm.reads)
                # The readings for conditions are the compiler's: they make nothing surely read.
                ends.append(settle_readings(arm.body, sure, defs))
            if statement.arms[-1].condition is not None:
                ends.append(sure)  # a missing ELSE is an empty arm
            sure = frozenset.intersection(*ends)
        elif isinstance(statement, Loop):
            statement.reads = missing((statement.count,), sure)
            settle_readings(statement.body, nothing, defs)
        else:
            statement.reads = missing((statement.condition,), nothing)
            settle_readings(statement.body, nothing, defs)
    return sure
