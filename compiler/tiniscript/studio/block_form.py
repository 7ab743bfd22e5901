"""The blocks of a program, and their form as JSON data.

A block of the page is a Block here, and an expression is flat, as in the AST: `values` are its
parts in the order in which a stack machine meets them. Knows no text and no page.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tiniscript.studio.block_kinds import KIND_OF, KINDS, piece_of

# A part: `NUMBER` and its decimal, `NAME` or `SENSOR` and the name; otherwise an operation on the
# parts before, with an empty text. `BRACKETS` surround a lone number; `NOTHING` is an empty place.
Value = tuple[tuple[str, str], ...]
TextRange = tuple[int, int, int, int]  # line and column, from 1, and those of the end
NOWHERE: TextRange = (0, 0, 0, 0)


class Block(NamedTuple):
    """`word` is the word or name that it has, or the text of a comment and of a grey block;
    where a unit is after the first value, that one too: `F CM`.

    `if` has a value and a body for each arm, and another body for ELSE; `def` has the names in its
    brackets as values. `note` is the comment after it; `is_apart`: an empty line is before it.
    `said` is what its lines were when it was read, the end left out, and `comment` the comment of
    it, or what it is; what is missing or empty is printed anew. `is_behind`: a comment after the
    line before it.
    """

    kind: str
    word: str = ""
    values: tuple[Value, ...] = ()
    bodies: tuple[tuple[Block, ...], ...] = ()
    note: str = ""
    is_apart: bool = False
    place: TextRange = NOWHERE
    said: tuple[str, ...] = ()
    comment: str = ""
    is_behind: bool = False

    def line(self, k: int) -> str:
        """Return the original line, or "" if it is to be printed again."""
        return self.said[k] if k < len(self.said) else ""


LEFT_OUT = Block("comment", "…")


class Stack(NamedTuple):
    """Blocks that hang on nothing: instructions, or one value."""

    body: tuple[Block, ...] = ()
    value: Value = ()


class Form(NamedTuple):
    """`start` is SI, SB or PING, or empty where the text does not say it."""

    start: str
    note: str
    is_one_line: bool
    body: tuple[Block, ...]
    loose: tuple[Stack, ...]


def data_of(form: Form) -> dict[str, Any]:
    """Return a program's blocks as data for JSON."""
    return {
        **form._asdict(),
        "body": _data_of_all(form.body),
        "loose": [{"body": _data_of_all(stack.body), "value": stack.value} for stack in form.loose],
    }


def from_data(data: dict[str, Any]) -> Form:
    """Return the blocks that the page has sent. Raises KeyError and the like where it has a bug."""
    loose_stacks = tuple(
        Stack(_blocks_from(fields["body"]), _value_from(fields["value"]))
        for fields in data["loose"]
    )
    note, is_one_line = data["note"], data["is_one_line"]
    return Form(data["start"], note, is_one_line, _blocks_from(data["body"]), loose_stacks)


def size_of(form: Form) -> int:
    """Return the number of blocks that a program needs, including those of values."""
    return sum(
        _own_size(block)
        for body in (form.body, *(stack.body for stack in form.loose))
        for block in in_order(body)
    )


def kinds_in(form: Form) -> set[str]:
    """Return the kinds of a program's blocks; a number alone is in its place already."""
    kinds: set[str] = set()
    for block in in_order(form.body):
        kinds.add(block.kind)
        kinds.update(KIND_OF[op] for value in block.values for op, _ in value if op != "NUMBER")
    return kinds


def pieces_in(form: Form) -> set[tuple[str, str]]:
    """Return the searchable pieces of a program's blocks, and their use: with a unit, or as a
    defined word with values.
    """
    pieces: set[tuple[str, str]] = set()
    for block in in_order(form.body):
        use = block.word.partition(" ")[2] if KINDS[block.kind].units else ""
        if block.kind in ("def", "call") and block.values:
            use = "values"
        pieces.add((piece_of(block.kind, block.word), use))
        pieces.update(
            (piece_of(KIND_OF[op], text or op), "")
            for value in block.values for op, text in value if op != "NUMBER"
        )  # fmt: skip
    return pieces


def lone_block(form: Form) -> Block | None:
    """Return the one instruction of a program, whatever is in it; None of another program."""
    is_alone = len(form.body) == 1 and not form.loose
    is_understood = all(block.kind != "grey" for block in in_order(form.body))
    return form.body[0] if is_alone and is_understood else None


def first_blocks(form: Form, most_blocks: int) -> Form:
    """Return a form with at most so many blocks, and a last one about the omitted rest."""
    if size_of(form) <= most_blocks:
        return form
    body, _ = _first_blocks(form.body, most_blocks - 1)
    return form._replace(body=body, loose=())


def _first_blocks(blocks: tuple[Block, ...], blocks_left: int) -> tuple[tuple[Block, ...], int]:
    """Return the first blocks and how many more may follow; -1 if some are left out."""
    kept_blocks: list[Block] = []
    for block in blocks:
        blocks_left -= _own_size(block)
        if blocks_left < 0:
            return (*kept_blocks, LEFT_OUT), -1
        bodies = []
        for old_body in block.bodies:
            body, blocks_left = (
                _first_blocks(old_body, blocks_left) if blocks_left >= 0 else ((), blocks_left)
            )
            bodies.append(body)
        kept_blocks.append(block._replace(bodies=tuple(bodies)))
        if blocks_left < 0:
            break
    return tuple(kept_blocks), blocks_left


def _own_size(block: Block) -> int:
    return 1 + sum(len(value) for value in block.values)


def in_order(blocks: tuple[Block, ...]) -> list[Block]:
    """Return blocks with all that are in them, in the order of the text."""
    blocks_in_order: list[Block] = []
    for block in blocks:
        blocks_in_order.append(block)
        for body in block.bodies:
            blocks_in_order += in_order(body)
    return blocks_in_order


def _data_of_all(blocks: tuple[Block, ...]) -> list[dict[str, Any]]:
    return [
        {**block._asdict(), "bodies": [_data_of_all(body) for body in block.bodies]}
        for block in blocks
    ]


def _blocks_from(data: list[dict[str, Any]]) -> tuple[Block, ...]:
    return tuple(
        Block(
            fields["kind"],
            fields["word"],
            tuple(_value_from(value) for value in fields["values"]),
            tuple(_blocks_from(body) for body in fields["bodies"]),
            fields["note"],
            fields["is_apart"],
            said=tuple(fields.get("said", ())),
            comment=fields.get("comment", ""),
            is_behind=bool(fields.get("is_behind")),
        )
        for fields in data
    )


def _value_from(data: list[list[str]]) -> Value:
    return tuple((op, text) for op, text in data)
