"""Text becomes blocks: the compiler's own AST, with the comments and the lines that do not parse.

It knows the AST and the places of comments. A line with a mistake of syntax becomes a grey block,
and it counts as a comment while the others are read. A statement that the checker refuses is a
normal block.
"""

from __future__ import annotations

from tiniscript.base.fixed_point import as_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import LINE_END, Source, Span
from tiniscript.base.words import WORDS
from tiniscript.studio.block_form import NOWHERE, Block, Form, Stack, TextRange, Value
from tiniscript.studio.block_kinds import KINDS, kind_of
from tiniscript.syntax.ast import (
    Argument,
    Assign,
    Break,
    Command,
    Def,
    If,
    Instruction,
    Loop,
    Part,
    Task,
    While,
)
from tiniscript.syntax.formatter import Piece, instruction_text, is_one_line, pieces_of
from tiniscript.syntax.later_words import kit_for_text
from tiniscript.syntax.parser import ParsedText, parse

LOOSE_PREFIX = "///"  # begins the lines of blocks that hang on nothing
LOOSE_VALUE_PREFIX = "= "
MAX_ROUNDS = 12  # most rounds of reading, after which every line is grey

_LEFT_OUT = frozenset(("AND_LEFT", "OR_LEFT"))  # part kinds that mark the end of the left side


def read_blocks(text: str, kit: Kit) -> Form:
    """Return the blocks of any text. `kit` says which names are sensors."""
    lines = LINE_END.split(text)
    grey_lines: set[int] = set()
    for _ in range(MAX_ROUNDS):
        source, parsed_text = _read_without(lines, grey_lines)
        mistake_spans = [
            diagnostic.span for diagnostic in parsed_text.diagnostics if diagnostic.is_mistake
        ]
        if not mistake_spans:
            break
        _mark_grey(source, mistake_spans, grey_lines)
    else:
        grey_lines = {k for k, line in enumerate(lines) if line.strip()}
        source, parsed_text = _read_without(lines, grey_lines)
    return _Reader(source, parsed_text, kit, {k: lines[k].strip() for k in grey_lines}).read_form()


def split_loose(lines: list[str]) -> tuple[list[str], list[str]]:
    """Return the lines of a program, and those at its end of what hangs on nothing."""
    k = end = len(lines)
    while end and not lines[end - 1]:
        end -= 1
    while end and lines[end - 1].startswith(LOOSE_PREFIX):
        end -= 1
        k = end
    return lines[: k - (0 < k < len(lines) and not lines[k - 1])], lines[k:]


def _read_without(lines: list[str], grey_lines: set[int]) -> tuple[Source, ParsedText]:
    kept_lines = ("//" if k in grey_lines else line for k, line in enumerate(lines))
    source = Source("\n".join(kept_lines))
    return source, parse(source)


def _mark_grey(source: Source, mistake_spans: list[Span], grey_lines: set[int]) -> None:
    """Mark the first line of each mistake, and the others where those are marked already."""
    old_count = len(grey_lines)
    grey_lines.update(source.position(span.start)[0] - 1 for span in mistake_spans)
    if len(grey_lines) == old_count:
        for span in mistake_spans:
            first_line, last_line = source.position(span.start)[0], source.position(span.end)[0]
            grey_lines.update(range(first_line - 1, last_line))


class _Reader:
    """Walks over the AST, and over the pieces of the text that it comes from."""

    def __init__(
        self, source: Source, parsed_text: ParsedText, kit: Kit, grey_texts: dict[int, str]
    ) -> None:
        self._source = source
        self._program = parsed_text.program
        self._pieces = pieces_of(parsed_text.scan)
        self._next_index = 0
        self._kit = kit
        self._sensors = frozenset(device.name for device in kit_for_text(source.text, kit).readings)
        self._defined_names = {
            instruction.name
            for instruction in parsed_text.program.body
            if isinstance(instruction, Def)
        }
        self._grey_texts = grey_texts

    def read_form(self) -> Form:
        start = note = ""
        first_comments = self._comments()
        if self._next_index < len(self._pieces) and self._pieces[self._next_index].is_setup:
            piece = self._next_piece()
            start, note = piece.tokens[0].text, _note(piece)
            if start == "PING":
                note = " // ".join(filter(None, (note, _note(self._next_piece()))))
        body = [*first_comments, *self._body(self._program.body)]
        stacks = self._loose(body)
        instruction_count = sum(piece.is_instruction for piece in self._pieces)
        is_on_one_line = instruction_count > 1 and is_one_line(self._pieces)
        return Form(start, note, is_on_one_line, tuple(body), tuple(stacks))

    def _next_piece(self) -> Piece:
        self._next_index += 1
        return self._pieces[self._next_index - 1]

    def _comments(self) -> list[Block]:
        """Return the comments, and grey lines, before the next instruction."""
        comments = []
        while self._next_index < len(self._pieces) and not self._pieces[self._next_index].tokens:
            piece = self._next_piece()
            place = (piece.first_line + 1, 1, piece.first_line + 2, 1)
            grey_text = self._grey_texts.get(piece.first_line)
            kind, word = ("comment", _note(piece)) if grey_text is None else ("grey", grey_text)
            comment = _comment(piece) if grey_text is None else ""
            comments.append(Block(kind, word, (), (), "", piece.follows_blank, place, (), comment))
        return comments

    def _body(self, instructions: tuple[Instruction, ...]) -> list[Block]:
        blocks: list[Block] = []
        for instruction in instructions:
            blocks += self._comments()
            blocks += self._blocks(instruction)
        return [*blocks, *self._comments()]

    def _blocks(self, node: Instruction) -> list[Block]:
        """Return the block of an instruction, and the comment after its end."""
        first_piece = self._next_piece()
        printed_lines = [instruction_text(first_piece.tokens)]
        if isinstance(node, Command):
            block = self._command(node, first_piece)
        elif isinstance(node, Assign):
            block = Block("assign", node.name, (self._value(node.value),))
        elif isinstance(node, Break):
            block = Block("break")
        else:
            bodies, values = self._arms(node, printed_lines)
            kind = "forever" if isinstance(node, Loop) and not values else type(node).__name__
            if isinstance(node, Task) and node.is_when:
                kind = "when"
            word = ""
            if isinstance(node, Def):
                word = node.name
                values = tuple((("NAME", parameter.name),) for parameter in node.parameters)
            block = Block(kind.lower(), word, values, bodies)
        last_piece = self._pieces[self._next_index - 1]
        place = self._place(first_piece, last_piece)
        block = block._replace(
            note=_note(first_piece),
            is_apart=first_piece.follows_blank,
            place=place,
            said=tuple(printed_lines),
            comment=_comment(first_piece),
        )
        comments_after = _comment_behind(last_piece, place) if last_piece is not first_piece else ()
        return [block, *comments_after]

    def _arms(
        self, node: If | Loop | While | Def | Task, printed_lines: list[str]
    ) -> tuple[tuple[tuple[Block, ...], ...], tuple[Value, ...]]:
        """Read bodies and their ends: ELSEIF, ELSE or the end of the block."""
        conditions: list[Argument | None] = []
        inner_bodies: list[tuple[Instruction, ...]] = []
        if isinstance(node, If):
            conditions = [arm.condition for arm in node.arms]
            inner_bodies = [arm.body for arm in node.arms] + [node.else_body] * node.has_else
        else:
            inner_bodies = [node.body]
            if isinstance(node, While) or (isinstance(node, Task) and node.is_when):
                conditions = [node.condition]
            elif isinstance(node, Loop) and node.times is not None:
                conditions = [node.times]
        bodies = []
        comments_after: tuple[Block, ...] = ()  # ELSEIF or ELSE
        for body in inner_bodies:
            bodies.append((*comments_after, *self._body(body)))
            end = self._next_piece()
            comments_after = _comment_behind(end)
            if len(bodies) < len(inner_bodies):
                printed_lines.append(instruction_text(end.tokens))
        return tuple(bodies), tuple(self._value(condition) for condition in conditions)

    def _command(self, node: Command, piece: Piece) -> Block:
        known_word = WORDS.get(node.word)
        arguments = node.arguments or ()
        if known_word is not None:
            kind = kind_of(known_word)
        elif node.arguments is not None:
            kind = "call" if node.word in self._defined_names else "set"
        else:
            kind = "read" if node.word in self._sensors else "call"
        word = node.word
        unit = arguments[0].unit if arguments else None
        if unit is not None:
            word = f"{word} {unit.op}"
        if node.until is not None:
            kind += "_until"
            arguments = (*arguments, node.until)
        is_known = kind == "call" or (kind in KINDS and len(KINDS[kind].values) == len(arguments))
        if not is_known or (unit is not None and KINDS[kind].units.get(node.word) != unit.op):
            return Block("grey", instruction_text(piece.tokens))
        return Block(kind, word, tuple(self._value(argument) for argument in arguments))

    def _value(self, argument: Argument | None) -> Value:
        assert argument is not None, "the line of an unread value is grey"
        parts = [self._part(part) for part in argument.expression if part.op not in _LEFT_OUT]
        if len(parts) == 1 and parts[0][0] == "NUMBER" and not argument.is_plain:
            parts.append(("BRACKETS", ""))
        return tuple(parts)

    def _part(self, part: Part) -> tuple[str, str]:
        if part.op == "NUMBER":
            return part.op, as_text(int(part.value))
        if part.op == "NAME":
            return "SENSOR" if part.value in self._sensors else "NAME", str(part.value)
        return part.op, ""

    def _place(self, first_piece: Piece, last_piece: Piece) -> TextRange:
        start, end = first_piece.tokens[0].start, last_piece.tokens[-1].end
        return (*self._source.position(start), *self._source.position(end))

    def _loose(self, body: list[Block]) -> list[Stack]:
        """Take the stacks that are kept as comments at the end, if all of them can be read."""
        first_loose = len(body)
        while (
            first_loose
            and body[first_loose - 1].kind == "comment"
            and _is_loose(body[first_loose - 1].word)
        ):
            first_loose -= 1
        if first_loose == len(body):
            return []
        texts = "\n".join(block.word[1:].strip() for block in body[first_loose:]).split("\n\n")
        parsed_stacks = [_parse_stack(text, self._kit) for text in texts if text.strip()]
        stacks = [stack for stack in parsed_stacks if stack is not None]
        if len(stacks) != len(parsed_stacks):
            return []
        del body[first_loose:]
        return stacks


def _note(piece: Piece) -> str:
    """Return the comments of a piece without the signs before them: of `// a`, `a`."""
    texts = [comment[2:].rstrip() for comment in piece.comments]
    return " // ".join(
        text[1:] if text[:1].isspace() and text[1:2] != "/" else text for text in texts
    )


def _comment(piece: Piece) -> str:
    return " ".join(piece.comments)


def _comment_behind(piece: Piece, place: TextRange = NOWHERE) -> tuple[Block, ...]:
    """Return the comment after an arm or an end."""
    comment = _comment(piece)
    block = Block("comment", _note(piece), place=place, comment=comment, is_behind=True)
    return (block,) if comment else ()


def _is_loose(comment: str) -> bool:
    return comment[:1] == "/" and comment[1:2] in ("", " ")


def _parse_stack(text: str, kit: Kit) -> Stack | None:
    is_value = text.startswith(LOOSE_VALUE_PREFIX)
    source = Source(f"X {text}" if is_value else text)
    parsed_text = parse(source)
    if any(diagnostic.is_mistake for diagnostic in parsed_text.diagnostics):
        return None
    reader = _Reader(source, parsed_text, kit, {})
    if reader._pieces[:1] and reader._pieces[0].is_setup:
        return None
    body = reader._body(parsed_text.program.body)
    return Stack((), body[0].values[0]) if is_value else Stack(tuple(body))
