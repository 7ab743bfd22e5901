"""The memory that a robot's reader needs while it reads a program, token by token.

Knows what a reader stores apart from the code, and in which order: `docs/develop/text.md`. The code
grows from one end of the memory; names, blocks that are open and operators that wait grow from the
other one, and a word lies after the code until it has been looked up. Made for right programs: it
looks for no mistake.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import read_literal
from tiniscript.base.kit import Kit
from tiniscript.base.source import Span
from tiniscript.base.words import EXTENTS, FUNCTIONS, TASKS, WORDS, Word
from tiniscript.bytecode.opcodes import SHORTS
from tiniscript.codegen.lower_expression import push_bytes
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.cursor import INSTRUCTION_ENDS
from tiniscript.syntax.later_words import kit_for_tokens
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.operators import AND, BINARY, MINUS, NOT, OPEN

MAX_BRACKETS = 254  # open at once
_BLOCK_BYTES = 3  # bytes of a block, without its three sets of sensors
_DEF_BYTES = 6  # bytes before a DEF's name and its set of sensors
_JUMP_BYTES = 2  # bytes of an instruction with a short jump
_TASK_BYTES = 3  # bytes of an entry that begins a task


class Need(NamedTuple):
    """The bytes needed from the token at `span` on; fewer are enough before it."""

    byte_count: int
    span: Span


class _Def(NamedTuple):
    """The sensors certainly read after it, and the variables of its values."""

    read_mask: int
    values: tuple[int, ...]


class _Block:
    """A block that is open; sets of sensors have a bit for each."""

    __slots__ = (
        "has_else",
        "known_mask_before",
        "name",
        "read_mask_after",
        "read_mask_before",
        "word",
    )

    def __init__(
        self, word: str, read_mask_before: int, known_mask_before: int, name: str = ""
    ) -> None:
        self.word = word
        self.name = name  # name of the DEF
        self.read_mask_before = read_mask_before
        self.known_mask_before = known_mask_before
        self.read_mask_after = -1
        self.has_else = False


class Reader:
    """Reads a right program as a robot does, one of whose sets of sensors has `sensor_bytes`.

    `needs` says where it needs more than before: the last is the most.
    """

    def __init__(self, tokens: list[Token], kit: Kit, sensor_bytes: int) -> None:
        self.tokens = tokens
        self.i = 0
        self.needs: list[Need] = []
        self.most_bytes = 0  # bytes that have been wanted at once
        self.block_bytes = _BLOCK_BYTES + 3 * sensor_bytes
        self.def_bytes = _DEF_BYTES + sensor_bytes
        self.code_bytes = 0  # bytes of code
        self.used_bytes = 0  # bytes used from the other end
        self.open_brackets = 0
        self.has_extent_unit = False  # whether the last brackets had a unit of length or angle
        self.extra_bracket_span: Span | None = None  # the first bracket after MAX_BRACKETS
        self.sensors = {
            device.name: k for k, device in enumerate(kit_for_tokens(tokens, kit).readings)
        }
        self.actuators = {device.name: k for k, device in enumerate(kit.actuators)}
        self.variables: dict[str, int] = {}
        self.own_variables: dict[str, int] = {}  # the values of the DEF that is open
        self.variable_count = 0  # variables so far, including the values of DEFs
        self.defs: dict[str, _Def] = {}
        self.blocks: list[_Block] = []
        self.read_mask = 0  # sensors certainly read
        # Variables known so far, including those that this instruction has read.
        self.known_mask = 0
        self.pending_operators: list[
            tuple[int, str]
        ] = []  # operators: how tightly each binds, its name

    # -- memory -------------------------------------------------------------------------------

    def require_room(self, byte_count: int) -> None:
        """Note that a byte is wanted after the code and `byte_count` bytes."""
        bytes_needed = self.code_bytes + byte_count + 1 + self.used_bytes
        if bytes_needed > self.most_bytes:
            self.most_bytes = bytes_needed
            self.needs.append(Need(bytes_needed, self.tokens[max(self.i - 1, 0)].span))

    def emit(self, byte_count: int) -> None:
        for _ in range(byte_count):
            self.require_room(0)
            self.code_bytes += 1

    def emit_numbered(self, number: int) -> None:
        self.emit(1 if number < SHORTS else 2)

    def push(self) -> None:
        self.require_room(0)
        self.used_bytes += 1

    def pop(self) -> None:
        self.used_bytes -= 1

    def add_name(self, name: str, other_bytes: int) -> None:
        byte_count = 1 + other_bytes + len(name)
        self.require_room(len(name) + byte_count - 1)
        self.used_bytes += byte_count

    # -- tokens -------------------------------------------------------------------------------

    @property
    def token(self) -> Token:
        return self.tokens[self.i]

    def take(self) -> Token:
        """Go past the next token; a word comes letter by letter."""
        token = self.tokens[self.i]
        if token.kind is WORD and token.end - token.start == len(token.text):  # no degree sign
            self.i += 1
            self.require_room(len(token.text) - 1)
        else:
            self.i += 1
        return token

    def skip_newlines(self) -> None:
        while self.open_brackets and self.token.kind is NEWLINE:
            self.i += 1

    def open_bracket(self) -> None:
        self.i += 1
        self.open_brackets += 1
        if self.open_brackets > MAX_BRACKETS and self.extra_bracket_span is None:
            self.extra_bracket_span = self.tokens[self.i - 1].span

    # -- instructions -------------------------------------------------------------------------

    def program(self) -> None:
        while self.token.kind is not END:
            if self.token.kind in INSTRUCTION_ENDS or self.token.kind == "|":
                self.i += 1
            else:
                self.instruction()

    def instruction(self) -> None:
        self.known_mask = self.read_mask
        token = self.take()
        word = WORDS.get(token.text)
        if word is None:
            self.read_name(token.text)
        elif token.text in WORD_OF_END:
            self.close(WORD_OF_END[token.text])
        elif token.text == "DEF":
            name = self.take().text
            self.add_name(name, self.def_bytes)
            self.emit(_JUMP_BYTES)
            self.open("DEF", name)
            self.read_def_values()
        elif token.text in TASKS:
            self.emit(_TASK_BYTES)
            self.open(token.text)
            if token.text == "WHEN":
                self.arguments()
                self.emit(1)
        elif token.text == "ELSE":
            self.next_arm()
            self.blocks[-1].has_else = True
        elif token.text == "BREAK":
            self.emit(_JUMP_BYTES)
        elif word.role.name == "stop":
            self.emit(1)
        elif word.arguments:
            self.command(word)

    def read_name(self, name: str) -> None:
        if self.token.kind == "=":
            self.assignment(name)
        elif name in self.sensors:
            self.emit_numbered(self.sensors[name])
            self.read_mask |= 1 << self.sensors[name]
        elif name in self.defs:
            self.read_call_values(self.defs[name].values)
            self.read_mask |= self.defs[name].read_mask
            self.emit(_JUMP_BYTES)
        else:
            self.arguments()
            self.emit_numbered(self.actuators[name])

    def assignment(self, name: str) -> None:
        number = self.number_of(name, self.variable_count)
        if number == self.variable_count:
            self.add_name(name, 0)
        self.i += 1
        self.push()
        self.value()
        if number == self.variable_count:
            self.variables[name] = number
            self.variable_count += 1
        self.emit_numbered(number)

    def number_of(self, name: str, default: int) -> int:
        """Return the number of a variable, or `default` if there is none."""
        return self.own_variables.get(name, self.variables.get(name, default))

    def read_def_values(self) -> None:
        """Read the names in the brackets of a DEF, where it has any."""
        if self.token.kind != "(":
            return
        self.open_bracket()
        kind = ""
        while kind != ")":
            name = self.take_inner()
            kind = name.kind
            if kind is WORD:
                self.add_name(name.text, 0)
                self.own_variables[name.text] = self.variable_count
                self.variable_count += 1

    def read_call_values(self, values: Sequence[int]) -> None:
        """Read the brackets of a call, where it has any: each value is set after its code."""
        if self.token.kind != "(":
            return
        self.open_bracket()
        for number in values:
            self.push()
            self.value()
            self.emit_numbered(number)
            self.take_inner()
        if not values:
            self.take_inner()

    def take_inner(self) -> Token:
        """Go past the next token in brackets, which it may close."""
        self.skip_newlines()
        token = self.take()
        self.open_brackets -= token.kind == ")"
        return token

    def command(self, word_row: Word) -> None:
        word = word_row.text
        if word == "ELSEIF":
            self.next_arm()
        elif word == "WHILE":
            self.emit(_JUMP_BYTES)
            self.open(word)
        is_forever = self.arguments()
        if word_row.role.has_duration:
            code_bytes = 2 if self.has_extent_unit else 1
            if self.token.kind is WORD:
                self.take()
                self.emit(code_bytes)
                self.known_mask = 0
                self.arguments()
                code_bytes = 1
            elif is_forever:
                code_bytes += 2
            self.emit(code_bytes)
        elif word == "LOOP":
            self.emit(1 if is_forever else _JUMP_BYTES)
            self.open(word)
        elif word in ("IF", "ELSEIF", "WHILE"):
            self.emit(_JUMP_BYTES)
            if word == "IF":
                self.open(word)
            self.blocks[-1].known_mask_before = self.known_mask
        else:
            self.emit(1)

    # -- blocks -------------------------------------------------------------------------------

    def open(self, word: str, name: str = "") -> None:
        self.require_room(self.block_bytes - 1)
        self.used_bytes += self.block_bytes
        self.blocks.append(_Block(word, self.read_mask, self.known_mask, name))
        if word != "IF":
            self.known_mask = self.read_mask = 0

    def next_arm(self) -> None:
        block = self.blocks[-1]
        self.emit(_JUMP_BYTES)
        block.read_mask_after &= self.read_mask
        self.read_mask, self.known_mask = block.read_mask_before, block.known_mask_before

    def close(self, word: str) -> None:
        block = self.blocks.pop()
        if word == "IF":
            self.read_mask &= block.read_mask_after & (
                -1 if block.has_else else block.read_mask_before
            )
        else:
            self.emit(1 if word in ("DEF", *TASKS) else _JUMP_BYTES)
            if word == "DEF":
                self.defs[block.name] = _Def(self.read_mask, tuple(self.own_variables.values()))
                self.own_variables = {}
            self.read_mask = block.read_mask_before
        self.used_bytes -= self.block_bytes

    # -- values -------------------------------------------------------------------------------

    def arguments(self) -> bool:
        """Read the content of the brackets of an instruction; return whether it is FOREVER."""
        self.open_bracket()
        is_forever = self.has_extent_unit = False
        while True:
            self.push()
            self.skip_newlines()
            if self.token.kind is WORD and self.token.text == "FOREVER":
                is_forever = True
                self.take()
                self.skip_newlines()
                self.pop()
            else:
                self.value()
            if self.take_inner().kind == ")":
                return is_forever

    def value(self) -> None:
        """Read an expression to the sign after it; below it lies a byte that is popped then."""
        while True:
            while not self.operand():
                pass
            if not self.operator():
                break
        self.pop()

    def operand(self) -> bool:
        """Read an operand or a prefix of one; return whether the operand is complete."""
        self.skip_newlines()
        token = self.token
        if token.kind == "(":
            self.wait(OPEN, "(")
            self.open_bracket()
            return False
        self.take()
        if token.kind is NUMBER:
            self.number(token)
            return True
        if token.kind == "-":
            self.wait(MINUS, "NEG")
            return False
        if token.text == "NOT":
            self.wait(NOT, "NOT")
            return False
        if token.text in FUNCTIONS:
            self.wait(OPEN, token.text)
            self.skip_newlines()
            self.open_bracket()
            return False
        if token.text in self.sensors:
            number = self.sensors[token.text]
            if not self.known_mask >> number & 1:
                self.known_mask |= 1 << number
                self.emit_numbered(number)
            self.emit_numbered(number)
        else:
            self.emit_numbered(self.number_of(token.text, 0))  # TRUE and its kin are one byte, too
        return True

    def number(self, token: Token) -> None:
        value, _ = read_literal(token.text)
        if self.pending_operators and self.pending_operators[-1] == (MINUS, "NEG"):
            index_before = self.i - 2
            while self.tokens[index_before].kind is NEWLINE:
                index_before -= 1
            if self.tokens[index_before].kind == "-":
                self.pending_operators.pop()
                self.pop()
                value = -value
        self.emit(push_bytes(value))

    def wait(self, binding: int, name: str) -> None:
        self.push()
        self.pending_operators.append((binding, name))

    def operator(self) -> bool:
        """Read the token after an operand; return whether another operand is expected."""
        while True:
            self.skip_newlines()
            token = self.token
            if token.text in BINARY:
                self.take()
                self.binary(*BINARY[token.text])
                return True
            if token.kind is WORD and token.text in EXTENTS:
                self.take()
                self.has_extent_unit = True
            self.reduce(OPEN + 1)
            if not self.pending_operators or token.kind not in (")", ","):
                return False
            if token.kind == ",":
                self.take()
                return True
            self.take()
            self.open_brackets -= 1
            _, name = self.pending_operators.pop()
            self.pop()
            if name != "(":
                self.emit(1)

    def binary(self, binding: int, name: str) -> None:
        self.reduce(binding)
        if binding <= AND:
            self.emit(1)
            self.push()  # place of the jump
            self.emit(1)
        self.wait(binding, name)

    def reduce(self, binding: int) -> None:
        """Apply the waiting operators of at least this precedence, back to an open bracket."""
        while self.pending_operators and self.pending_operators[-1][0] >= binding:
            precedence, _ = self.pending_operators.pop()
            self.pop()
            if precedence <= AND:
                self.pop()
            else:
                self.emit(1)
