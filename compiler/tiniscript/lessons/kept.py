"""Finds the question that kept a robot where it is, and what a move needs to be one.

Knows tokens, and how a run ended. Does not know what the robot reads, or what the lesson asks for.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.lessons.running import DONE
from tiniscript.syntax.lexer import NUMBER, WORD, Token

MOVES = frozenset("FBLRM")
FORWARD_MOVES = frozenset("FBM")  # what is more than a turn
CONSTANT_WORDS = frozenset({"TRUE", "FALSE", "NOT", "AND", "OR"})  # of a question
STATEMENTS = frozenset({"W", "S", "BEEP", "SHOW"})  # an UNTIL after them is not that of a move


class Question(NamedTuple):
    """A question at a place of the text that kept the robot.

    It gave `truth` from the start; with `is_ever` the robot waited for `truth`. `inside` are its
    words.
    """

    start: int
    word: str
    truth: str
    is_ever: bool
    inside: list[str]


class _Block:
    """An open block: whether it stands in one that repeats, and what it asks."""

    def __init__(self, start: int, word: str, inside: list[str], is_repeated: bool) -> None:
        self.start, self.word, self.inside = start, word, inside
        self.is_repeated = is_repeated
        self.is_else = False
        self.needed = ""  # what its question must give for a move in it, once there is one

    def question(self) -> Question | None:
        """Return its question, if a robot that does not move may be kept by it."""
        if self.word == "WHILE" and not self.needed:  # it waits
            return Question(self.start, self.word, "FALSE", True, self.inside)
        if self.word in ("LOOP", "DEF", "TASK") or not self.needed:
            return None
        is_ever = self.word == "WHEN" or (self.is_repeated and self.word == "IF")
        other = "FALSE" if self.needed == "TRUE" else "TRUE"
        return Question(
            self.start, self.word, self.needed if is_ever else other, is_ever, self.inside
        )


def find_moves(tokens: Sequence[Token], moves: Collection[str] = MOVES) -> list[int]:
    """Return where there are moves that have time and power, as far as the text says it."""
    return [
        k
        for k, token in enumerate(tokens)
        if token.kind == WORD and token.text in moves and _has_power(tokens, k)
    ]


def _has_power(tokens: Sequence[Token], at: int) -> bool:
    values = _values(tokens, at)
    zeros = [len(value) == 1 and value[0].kind == NUMBER and not float(value[0].text)
             for value in values]  # fmt: skip
    return not all(zeros) if tokens[at].text == "M" else not any(zeros)


def _values(tokens: Sequence[Token], at: int) -> list[list[Token]]:
    """Return the values between the brackets after a word."""
    values: list[list[Token]] = [[]]
    depth = 0
    for token in tokens[at + 1 :]:
        depth += (token.text == "(") - (token.text == ")")
        if depth < 1:
            break
        if token.text == "," and depth == 1:
            values.append([])
        elif depth > 1 or token.text != "(":
            values[-1].append(token)
    return values


def end_of_values(tokens: Sequence[Token], at: int) -> int:
    """Return where in the text the bracket after a word closes, or where the word ends."""
    values = [token for value in _values(tokens, at) for token in value]
    closing_brackets = [token for token in tokens[at + 1 :] if token.text == ")"]
    last = values[-1].end if values else tokens[at].end
    return next((token.end for token in closing_brackets if token.start >= last), last)


def count_ahead(tokens: Sequence[Token]) -> int:
    """Return how many moves a text has that are no turns on the spot."""
    return sum(
        token.kind == WORD and token.text in FORWARD_MOVES and not _is_turn(tokens, k)
        for k, token in enumerate(tokens)
    )


def _is_turn(tokens: Sequence[Token], at: int) -> bool:
    """Whether a move is M(-x, x) or M(x, -x)."""
    values = [[token.text for token in value] for value in _values(tokens, at)]
    if tokens[at].text != "M" or len(values) != 2:
        return False
    left, right = values
    return left == ["-", *right] or right == ["-", *left]


def count_unasked(tokens: Sequence[Token]) -> int:
    """Return how many UNTIL have nothing in their question that may change."""
    return sum(
        token.text == "UNTIL" and not set(_words(tokens, k)) - CONSTANT_WORDS
        for k, token in enumerate(tokens)
    )


def question(tokens: Sequence[Token], is_turned: bool, ending: str) -> Question | None:
    """Return what kept a robot from each of its moves, or from all but turns; None: no question.

    `tokens` are those of a program without what nothing calls.
    """
    moves = set(find_moves(tokens, FORWARD_MOVES if is_turned else MOVES))
    questions: list[Question] = []
    blocks: list[_Block] = []
    movers = set[str]()  # words of DEF with a move
    before = head = -1  # the words of the statements that an UNTIL may belong to, or to a wait
    for k, token in enumerate(tokens):
        word = ALIASES.get(token.text, token.text)
        if k in moves or word in movers:
            for block in blocks:
                block.needed = block.needed or ("FALSE" if block.is_else else "TRUE")
                if block.word == "DEF":
                    movers |= set(block.inside)
        if word in BLOCK_ENDS:
            is_repeated = any(block.word in ("LOOP", "WHILE", "DEF") for block in blocks)
            inside = [tokens[k + 1].text] if word == "DEF" else _words(tokens, k)
            blocks.append(_Block(token.start, word, inside, is_repeated))
        elif word == "ELSE" and blocks:
            blocks[-1].is_else = True
        elif word in BLOCK_ENDS.values() and blocks:
            asked = blocks.pop().question()
            questions += [asked] if asked else []
        elif word == "UNTIL" and head >= 0:
            is_m = tokens[head].text == "W" and before in moves and tokens[before].text == "M"
            is_wait = tokens[head].text == "W" and "FOREVER" in _words(tokens, head) and not is_m
            if head in moves or is_wait or is_m:
                questions.append(Question(token.start, word, "TRUE", is_wait, _words(tokens, k)))
        elif word in MOVES or word in STATEMENTS:
            before, head = head, k
    if not moves:
        return None
    if ending == DONE:
        questions = [each for each in questions if not each.is_ever or each.word == "IF"]
        questions = [_question_at_start(each) for each in questions]
    # A WHILE with moves that the robot was in when its time was over has let it in.
    questions.sort(key=lambda each: (ending != DONE and not each.is_ever and each.word == "WHILE",
                                 each.start))  # fmt: skip
    return questions[0] if questions else None


def _question_at_start(question: Question) -> Question:
    """Return a question that was to give something, with what it gave."""
    if not question.is_ever:
        return question
    return question._replace(is_ever=False, truth="FALSE" if question.truth == "TRUE" else "TRUE")


def _words(tokens: Sequence[Token], at: int) -> list[str]:
    return [token.text for value in _values(tokens, at) for token in value if token.kind == WORD]
