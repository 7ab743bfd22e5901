"""Logo: lines as `REPEAT 4 [FD 30 RT 90]`, and words that it is taught, `TO SQUARE` up to `END`.

Each word has one number, and no separator follows. A turtle goes steps and turns degrees, and has
no power: the result gets centimetres, DEG and a power, which is the program's own if it has one,
and an example otherwise. It is only shown.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, POWER, UNIT_OF, WORDS, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import LONG_TIME_S, Names, lexemes, plain
from tiniscript.recovery.writing import split_note

_TOKEN = re.compile(
    r"(?P<word>[^\W\d]\w*)|(?P<number>\d+(?:\.\d+)?)|(?P<sign>[\[\]])"
    r"|(?P<apart>[ \t]*[;|][ \t;]*)|[ \t,]+"
)
_TAUGHT_WORD = re.compile(r"\s*(?P<to>[^\W\d]\w*)[ \t]+(?P<name>[^\W\d]\w*)[ \t]*")
_LONE_WORD = re.compile(r"\s*([^\W\d]\w*)[ \t]*")
_MIN_STEPS = 5  # fewer are rather seconds
_MAX_LOOP_DEPTH = 4  # loops
_MAX_INSTRUCTIONS = 12  # instructions that are read as one


class _Token(NamedTuple):
    text: str
    kind: str
    span: Span


def logo_diagnostics(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the diagnostics for each line of Logo."""
    names = Names([lexemes(line) for line in source.text.split("\n")], kit)
    diagnostics = _definition_diagnostics(source)
    line_start = 0
    for line in source.text.split("\n"):
        pieces = _pieces(split_note(line)[0], line_start)
        while pieces:
            ends = range(min(len(pieces), _MAX_INSTRUCTIONS), 0, -1)
            attempts = ((end, [token for piece in pieces[:end] for token in piece]) for end in ends)
            ends_and_diagnostics = (
                (end, _diagnostic(tokens, source, names)) for end, tokens in attempts
            )
            end, diagnostic = next(
                (attempt for attempt in ends_and_diagnostics if attempt[1]), (1, None)
            )
            diagnostics += [diagnostic] if diagnostic else []
            pieces = pieces[end:]
        line_start += len(line) + 1
    return diagnostics


def _definition_diagnostics(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for Logo procedures, each of which becomes a DEF."""
    diagnostics: list[Diagnostic] = []
    head: Diagnostic | None = None
    is_empty = True
    line_start = 0
    for line in source.text.split("\n"):
        body = split_note(line)[0]
        definition, lone_word = _TAUGHT_WORD.fullmatch(body), _LONE_WORD.fullmatch(body)
        if definition and lexicon_meaning(plain(definition["to"]), "teach"):
            span = Span(line_start + definition.start("to"), line_start + definition.end("name"))
            name = plain(definition["name"])
            fix = f"DEF {name}" if name.isidentifier() and name not in WORDS else ""
            head = _definition_diagnostic(source, span, definition["to"], fix) if fix else None
            is_empty = True
        elif head and lone_word and lexicon_meaning(plain(lone_word[1]), "end"):
            span = Span(line_start + lone_word.start(1), line_start + lone_word.end(1))
            end = _definition_diagnostic(source, span, lone_word[1], BLOCK_ENDS["DEF"])
            diagnostics += [] if is_empty else [head, end]  # `para todo` stops
            head = None
        else:
            is_empty = is_empty and not body.strip()
        line_start += len(line) + 1
    return diagnostics


def _definition_diagnostic(source: Source, span: Span, found_text: str, fix: str) -> Diagnostic:
    values = {"found": found_text, "right": fix.split()[0], "fix": fix}
    repair = Repair((Edit(span, fix),), False)
    return Diagnostic(codes.OTHER_LANGUAGE, span, values, span, repair)


def _pieces(body: str, start: int) -> list[list[_Token]]:
    """Return the instructions of a line, each empty if it has other signs."""
    pieces: list[list[_Token]] = [[]]
    depth = end = 0
    is_readable = True
    for match in _TOKEN.finditer(body):
        is_readable = is_readable and match.start() == end
        end = match.end()
        depth += (match[0] == "[") - (match[0] == "]")
        if match["apart"] and (not depth or "|" in match[0]):
            pieces[-1] = pieces[-1] if is_readable else []
            pieces.append([])
            is_readable = True
        elif match.lastgroup and match.lastgroup != "apart":
            span = Span(start + match.start(), start + match.end())
            pieces[-1].append(_Token(plain(match[0]), match.lastgroup, span))
    is_readable = is_readable and end == len(body.rstrip())
    return pieces if is_readable else [*pieces[:-1], []]


def _diagnostic(tokens: Sequence[_Token], source: Source, names: Names) -> Diagnostic | None:
    if not tokens:
        return None
    reader = _Reader(tokens, names)
    instructions, end = reader.instructions(0, 0)
    is_turtle = reader.is_bracketed or (reader.move_count > 1 and reader.is_turned)
    if not instructions or end != len(tokens) or not is_turtle:
        return None
    whole_span = Span(tokens[0].span.start, tokens[-1].span.end)
    first_word = source[tokens[0].span]
    fix = ";".join(instructions)
    right_word = re.split(r"\W", fix)[0]
    values = {"found": first_word, "right": right_word, "fix": fix}
    return Diagnostic(
        codes.OTHER_LANGUAGE,
        whole_span,
        values,
        whole_span,
        Repair((Edit(whole_span, fix),), False),
    )


class _Reader:
    """Reads instructions, each a word with its number; `is_turned`: by degrees, not by seconds."""

    def __init__(self, tokens: Sequence[_Token], names: Names) -> None:
        self.tokens = tokens
        self.names = names
        self.power = names.usual_values.get(POWER.unit) or POWER.sample
        self.is_bracketed = self.is_turned = False
        self.move_count = 0

    def instructions(self, k: int, depth: int) -> tuple[list[str], int]:
        """Return the instructions from a token on and where they end; or nothing if one is not an
        instruction."""
        instructions: list[str] = []
        while k < len(self.tokens) and self.tokens[k].text != "]":
            token, number_tokens = self.tokens[k], self.tokens[k + 1 : k + 2]
            if token.kind != "word" or not number_tokens or number_tokens[0].kind != "number":
                return [], k
            word = self._meaning_of(token.text)
            if word == "LOOP" and depth < _MAX_LOOP_DEPTH and self._text_at(k + 2) == "[":
                self.is_bracketed = True
                inner_instructions, end = self.instructions(k + 3, depth + 1)
                if not inner_instructions or self._text_at(end) != "]":
                    return [], k
                instructions += [
                    f"LOOP({number_tokens[0].text})",
                    *inner_instructions,
                    BLOCK_ENDS["LOOP"],
                ]
                k = end + 1
                continue
            move = self._move_text(word, number_tokens[0].text)
            if not move:
                return [], k
            instructions.append(move)
            k += 2
        return instructions, k

    def _text_at(self, k: int) -> str:
        return self.tokens[k].text if k < len(self.tokens) else ""

    def _meaning_of(self, word: str) -> str:
        if word in WORDS:
            return word
        meanings = lexicon_meaning(word, "turtle")
        return (
            meanings[0]
            if meanings and not self.names.is_name(word)
            else self.names.find_meaning(word)
        )

    def _move_text(self, word: str, number_text: str) -> str:
        unit = UNIT_OF.get(word, "")
        if not unit or float(number_text) < (_MIN_STEPS if unit == "CM" else LONG_TIME_S):
            return ""
        self.move_count += 1
        self.is_turned |= unit == "DEG"
        return f"{word}({number_text} {unit}, {self.power})"
