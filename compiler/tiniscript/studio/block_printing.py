"""Blocks become text, in the layout of the formatter, and each block gets its place there.

Knows words, signs and which of them needs brackets. Blocks that are not attached to anything are
kept in comments at the end of the text, which `block_reading` takes back.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.base.words import BLOCK_ENDS, FUNCTIONS, WORDS
from tiniscript.studio.block_form import Block, Form, Stack, TextRange, Value
from tiniscript.studio.block_kinds import KINDS
from tiniscript.studio.block_reading import LOOSE_PREFIX, LOOSE_VALUE_PREFIX
from tiniscript.syntax.formatter import COMMENT_GAP, Row, lines_of
from tiniscript.syntax.operators import BINARY, COMPARISON, MINUS, NOT

ATOM = MINUS + 1  # needs no brackets anywhere

_OPERATORS = {name: (precedence, sign) for sign, (precedence, name) in BINARY.items()}
_WORDS_WITH_NOTE = frozenset((*BLOCK_ENDS.values(), "ELSE", "ELSEIF"))
_NO_LINE = re.compile(r"[\r\n\0]+")


class PrintedForm(NamedTuple):
    """`places` are those of the blocks of the body, in the order of the text; `lines` where each of
    their lines is, from 0."""

    text: str
    places: tuple[TextRange, ...]
    lines: tuple[tuple[int, ...], ...]


class _Instruction(NamedTuple):
    """A line of a block: an instruction, a header, an arm, an end, a comment or a grey line."""

    kind: str
    word: str  # the first, as the formatter asks for it
    text: str
    note: str = ""
    is_apart: bool = False

    @property
    def is_code(self) -> bool:
        return self.kind not in ("comment", "grey")

    @property
    def takes_note(self) -> bool:
        """Return whether the line is that of an arm or an end, whose comment is a separate
        block.
        """
        return self.word in _WORDS_WITH_NOTE and self.is_code and not self.note


class _Line(NamedTuple):
    """A line of the text; `columns` are where its instructions begin and end."""

    row: Row
    columns: tuple[tuple[int, int], ...]


def format_blocks(form: Form) -> PrintedForm:
    """Return the text of a program's blocks, and where each of them is."""
    instructions: list[_Instruction] = []
    indexes_of_blocks: list[list[int]] = []  # indexes of each block's instructions
    _add_all(form.body, instructions, indexes_of_blocks)
    lines = _lines(form, instructions)
    loose_rows = [Row("", line, k == 0) for k, line in enumerate(_loose_lines(form.loose))]
    texts = lines_of([line.row for line in lines] + loose_rows)
    instruction_places: list[tuple[int, int, int]] = []  # line, column and end of each instruction
    line_number = 0
    for text, line in zip(texts, lines, strict=False):
        line_number += 1 + text.count("\n")
        column_before = len(text.lstrip("\n")) - len(line.row.text) + 1
        instruction_places += [
            (line_number, column_before + start, column_before + end) for start, end in line.columns
        ]
    return PrintedForm(
        "".join(text + "\n" for text in texts),
        tuple(
            (
                *instruction_places[indexes[0]][:2],
                instruction_places[indexes[-1]][0],
                instruction_places[indexes[-1]][2],
            )
            for indexes in indexes_of_blocks
        ),
        tuple(
            tuple(instruction_places[k][0] - 1 for k in indexes) for indexes in indexes_of_blocks
        ),
    )


# -- instructions --------------------------------------------------------------------------------


def _add_all(
    blocks: tuple[Block, ...], instructions: list[_Instruction], indexes_of_blocks: list[list[int]]
) -> None:
    """Add the lines of blocks, and for each block which are its own."""
    for block in blocks:
        indexes_of_blocks.append([])
        own_indexes = indexes_of_blocks[-1]
        if block.is_behind and instructions and instructions[-1].takes_note:
            instructions[-1] = instructions[-1]._replace(note=block.comment or _note(block.word))
            own_indexes.append(len(instructions) - 1)
            continue
        values = [text_of(value) for value in block.values]
        if block.bodies:
            _add_bodies(block, values, instructions, indexes_of_blocks)
        else:
            own_indexes.append(len(instructions))
            instructions.append(_instruction(block, values))


def _add_bodies(
    block: Block,
    values: list[str],
    instructions: list[_Instruction],
    indexes_of_blocks: list[list[int]],
) -> None:
    own_indexes = indexes_of_blocks[-1]
    word = "LOOP" if block.kind == "forever" else block.kind.upper()
    heads = [(word, f"{word}({value})") for value in values[:1]]
    heads += [("ELSEIF", f"ELSEIF({value})") for value in values[1:]]
    if word == "DEF":
        names = f"({', '.join(values)})" if values else ""
        heads = [(word, f"DEF {_one_line(block.word)}{names}")]
    elif word == "TASK":
        heads = [(word, word)]
    elif block.kind == "forever":
        heads = [(word, "LOOP(FOREVER)")]
    elif len(block.bodies) > len(values):
        heads.append(("ELSE", "ELSE"))
    note, is_apart = block.comment or _note(block.note), block.is_apart
    for k, ((first_word, head), body) in enumerate(zip(heads, block.bodies, strict=True)):
        text = block.line(k) or head
        own_indexes.append(len(instructions))
        instructions.append(_Instruction(block.kind, first_word, text, note, is_apart))
        _add_all(body, instructions, indexes_of_blocks)
        note, is_apart = "", False
    own_indexes.append(len(instructions))
    instructions.append(_Instruction(block.kind, BLOCK_ENDS[word], BLOCK_ENDS[word]))


def _instruction(block: Block, values: list[str]) -> _Instruction:
    kind, word = block.kind, _one_line(block.word)
    if kind == "comment" or (kind == "grey" and not word.strip()):
        comment_text = block.comment or _comment(word)
        return _Instruction("comment", "", comment_text, is_apart=block.is_apart)
    if kind == "grey":
        text = word.strip()
    elif block.line(0):
        text = block.line(0)
    elif kind == "assign":
        text = f"{word} = {values[0]}"
    else:
        until = f" UNTIL({values.pop()})" if kind.endswith("_until") else ""
        if KINDS[kind].units:
            word, *unit = word.split()
            values[0] = " ".join((values[0], *unit))
        arguments = f"({', '.join(values)})" if values else ""
        text = (word or kind.upper()) + arguments + until
    note = block.comment or _note(block.note)
    return _Instruction(kind, word or kind.upper(), text, note, block.is_apart)


# -- lines ---------------------------------------------------------------------------------------


def _lines(form: Form, instructions: list[_Instruction]) -> list[_Line]:
    """Return the lines of a program: leading comments come before its start."""
    lines: list[_Line] = []
    if form.start:
        while len(lines) < len(instructions) and instructions[len(lines)].kind == "comment":
            lines.append(_line([instructions[len(lines)]]))
    instructions_left = instructions[len(lines) :]
    setup = form.start + "|" * bool(form.start)
    code_indexes = [k for k, instruction in enumerate(instructions_left) if instruction.is_code]
    if form.start == "PING":
        setup += "CHECK_CONNECTION"
    elif not form.note and _is_one_line(form, instructions_left, code_indexes):
        line_instructions = instructions_left[code_indexes[0] : code_indexes[-1] + 1]
        return [
            *lines,
            *(_line([instruction]) for instruction in instructions_left[: code_indexes[0]]),
            _line(line_instructions, setup),
            *(_line([instruction]) for instruction in instructions_left[code_indexes[-1] + 1 :]),
        ]
    elif (
        not form.note
        and code_indexes[:1] == [0]
        and not instructions_left[0].is_apart
        and form.start
    ):
        lines.append(_line(instructions_left[:1], setup, end=";"))
        setup, instructions_left = "", instructions_left[1:]
    if setup:
        lines.append(_Line(Row("", _with_note(setup, _note(form.note)), False), ()))
    return lines + [
        _line([instruction], end=";" * instruction.is_code) for instruction in instructions_left
    ]


def _is_one_line(
    form: Form, instructions_left: list[_Instruction], code_indexes: list[int]
) -> bool:
    """Return whether all instructions belong on one line, as in the formatter."""
    if not code_indexes or (form.start and code_indexes[0] > 0):
        return False
    if not form.is_one_line and len(code_indexes) > 1:
        return False
    line_instructions = instructions_left[code_indexes[0] : code_indexes[-1] + 1]
    has_grey = any(instruction.kind == "grey" for instruction in instructions_left)
    return not has_grey and all(
        instruction.is_code and not instruction.note for instruction in line_instructions[:-1]
    )


def _line(instructions: list[_Instruction], setup: str = "", end: str = "") -> _Line:
    text, columns = setup, []
    for k, instruction in enumerate(instructions):
        text += ";" * (k > 0)
        columns.append((len(text), len(text) + len(instruction.text)))
        text += instruction.text
    first_block, last_block = instructions[0], instructions[-1]
    word = last_block.word if len(instructions) == 1 else ""
    is_apart = first_block.is_apart and not setup
    return _Line(Row(word, _with_note(text + end, last_block.note), is_apart), tuple(columns))


def _with_note(text: str, note: str) -> str:
    return f"{text}{COMMENT_GAP}{note}" if note else text


def _note(text: str) -> str:
    return _comment(_one_line(text)) if text else ""


def _comment(text: str) -> str:
    text = text.rstrip()
    is_apart = not text or text[0] == "/" or text[:2] == " /"
    return f"//{text}" if is_apart else f"// {text}"


def _one_line(text: str) -> str:
    return _NO_LINE.sub(" ", text)


def _loose_lines(stacks: tuple[Stack, ...]) -> list[str]:
    lines: list[str] = []
    for stack in stacks:
        if stack.body:
            text = format_blocks(Form("", "", False, stack.body, ())).text
        else:
            text = LOOSE_VALUE_PREFIX + text_of(stack.value)
        lines += [LOOSE_PREFIX] * bool(lines)
        lines += [f"{LOOSE_PREFIX} {line}" for line in text.splitlines() if line]
    return lines


# -- values --------------------------------------------------------------------------------------


def text_of(value: Value) -> str:
    """Return an expression with the brackets that it needs."""
    stack: list[tuple[str, int]] = []
    for op, name in value:
        if op in _OPERATORS:
            precedence, sign = _OPERATORS[op]
            right, left = stack.pop(), stack.pop()
            left_text = _bracket(left, precedence + (precedence == COMPARISON))
            stack.append((f"{left_text} {sign} {_bracket(right, precedence + 1)}", precedence))
        elif op == "NOT":
            stack.append((f"NOT {_bracket(stack.pop(), NOT)}", NOT))
        elif op == "NEG":
            text, precedence = stack.pop()
            # The minus would become the number's sign.
            is_number = text[:1].isdigit() or text[:1] == "-"
            inner_text = f"({text})" if is_number else _bracket((text, precedence), ATOM)
            stack.append((f"-{inner_text}", MINUS))
        elif op == "BRACKETS":
            stack.append((f"({stack.pop()[0]})", ATOM))
        elif op in FUNCTIONS:
            count = len(WORDS[op].arguments)
            arguments = ", ".join(text for text, _ in stack[-count:])
            stack[-count:] = [(f"{op}({arguments})", ATOM)]
        else:
            stack.append(("" if op == "NOTHING" else _one_line(name) or op, ATOM))
    (operand,) = stack
    return operand[0]


def _bracket(operand: tuple[str, int], least_precedence: int) -> str:
    text, precedence = operand
    return text if precedence >= least_precedence else f"({text})"
