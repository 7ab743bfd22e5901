"""Finds the condition that kept a robot from moving, and the requirements of a move.

Knows tokens, and how a run ended. It does not know what the robot reads, or what the lesson
requires.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.lessons.running import DONE
from tiniscript.syntax.lexer import NUMBER, WORD, Token

MOVES = frozenset("FBLRM")
FORWARD_MOVES = frozenset("FBM")  # moves that are more than a turn
CONSTANT_WORDS = frozenset({"TRUE", "FALSE", "NOT", "AND", "OR"})  # constant words of a question
STATEMENTS = frozenset({"W", "S", "BEEP", "SHOW"})  # an UNTIL after them is not that of a move


class Question(NamedTuple):
    """A question at a place of the text that kept the robot.

    It gave `truth` from the start; with `is_ever` the robot waited for `truth`. `words` are its
    words.
    """

    start: int
    word: str
    truth: str
    is_ever: bool
    words: list[str]


class _Block:
    """An open block: whether it is inside a repeating one, and its question."""

    def __init__(self, start: int, word: str, words: list[str], is_repeated: bool) -> None:
        self.start, self.word, self.words = start, word, words
        self.is_repeated = is_repeated
        self.is_else = False
        self.needed_truth = ""  # answer that its question needs before a move, once there is one

    def question(self) -> Question | None:
        """Return its question, if it may be what keeps the robot from moving."""
        if self.word == "WHILE" and not self.needed_truth:  # a WHILE without a move waits
            return Question(self.start, self.word, "FALSE", True, self.words)
        if self.word in ("LOOP", "DEF", "TASK") or not self.needed_truth:
            return None
        is_ever = self.word == "WHEN" or (self.is_repeated and self.word == "IF")
        opposite = "FALSE" if self.needed_truth == "TRUE" else "TRUE"
        return Question(
            self.start, self.word, self.needed_truth if is_ever else opposite, is_ever, self.words
        )


def find_moves(tokens: Sequence[Token], moves: Collection[str] = MOVES) -> list[int]:
    """Return the places of moves with a time and a power in the text."""
    return [
        k
        for k, token in enumerate(tokens)
        if token.kind == WORD and token.text in moves and _has_power(tokens, k)
    ]


def _has_power(tokens: Sequence[Token], index: int) -> bool:
    values = _values(tokens, index)
    zeros = [len(value) == 1 and value[0].kind == NUMBER and not float(value[0].text)
             for value in values]  # fmt: skip
    return not all(zeros) if tokens[index].text == "M" else not any(zeros)


def _values(tokens: Sequence[Token], index: int) -> list[list[Token]]:
    """Return the values between the brackets after a word."""
    values: list[list[Token]] = [[]]
    depth = 0
    for token in tokens[index + 1 :]:
        depth += (token.text == "(") - (token.text == ")")
        if depth < 1:
            break
        if token.text == "," and depth == 1:
            values.append([])
        elif depth > 1 or token.text != "(":
            values[-1].append(token)
    return values


def end_of_values(tokens: Sequence[Token], index: int) -> int:
    """Return the index of the bracket that closes after a word, or of the word's end."""
    values = [token for value in _values(tokens, index) for token in value]
    closing_brackets = [token for token in tokens[index + 1 :] if token.text == ")"]
    values_end = values[-1].end if values else tokens[index].end
    return next((token.end for token in closing_brackets if token.start >= values_end), values_end)


def count_ahead(tokens: Sequence[Token]) -> int:
    """Return the number of moves that are no turns on the spot."""
    return sum(
        token.kind == WORD and token.text in FORWARD_MOVES and not _is_turn(tokens, k)
        for k, token in enumerate(tokens)
    )


def _is_turn(tokens: Sequence[Token], index: int) -> bool:
    """Return whether a move is M(-x, x) or M(x, -x)."""
    values = [[token.text for token in value] for value in _values(tokens, index)]
    if tokens[index].text != "M" or len(values) != 2:
        return False
    left, right = values
    return left == ["-", *right] or right == ["-", *left]


def count_unasked(tokens: Sequence[Token]) -> int:
    """Return the number of UNTILs without anything variable in their question."""
    return sum(
        token.text == "UNTIL" and not set(_words(tokens, k)) - CONSTANT_WORDS
        for k, token in enumerate(tokens)
    )


def times_before_until(tokens: Sequence[Token]) -> list[tuple[int, int]]:
    """Return where the times or the ways of moves and waits with an UNTIL begin and end."""
    spans = []
    for k, token in enumerate(tokens):
        closing_end = end_of_values(tokens, k)
        next_token = next((each for each in tokens[k:] if each.start >= closing_end), None)
        time = _values(tokens, k)[0]
        if token.text in "FBLRW" and next_token and next_token.text == "UNTIL" and time:
            spans.append((time[0].start, time[-1].end))
    return spans


def question(tokens: Sequence[Token], is_turned: bool, ending: str) -> Question | None:
    """Return what prevented each move of a robot, or all moves except turns; None if there is no
    question.

    `tokens` are those of a program without uncalled DEFs.
    """
    moves = set(find_moves(tokens, FORWARD_MOVES if is_turned else MOVES))
    questions: list[Question] = []
    blocks: list[_Block] = []
    movers = set[str]()  # words of DEF with a move
    previous_index = (
        last_index
    ) = -1  # the words of the statements that an UNTIL may belong to, or to a wait
    for k, token in enumerate(tokens):
        word = ALIASES.get(token.text, token.text)
        if k in moves or word in movers:
            for block in blocks:
                block.needed_truth = block.needed_truth or ("FALSE" if block.is_else else "TRUE")
                if block.word == "DEF":
                    movers |= set(block.words)
        if word in BLOCK_ENDS:
            is_repeated = any(block.word in ("LOOP", "WHILE", "DEF") for block in blocks)
            words = [tokens[k + 1].text] if word == "DEF" else _words(tokens, k)
            blocks.append(_Block(token.start, word, words, is_repeated))
        elif word == "ELSE" and blocks:
            blocks[-1].is_else = True
        elif word in BLOCK_ENDS.values() and blocks:
            question_of_block = blocks.pop().question()
            questions += [question_of_block] if question_of_block else []
        elif word == "UNTIL" and last_index >= 0:
            is_m = (
                tokens[last_index].text == "W"
                and previous_index in moves
                and tokens[previous_index].text == "M"
            )
            is_wait = (
                tokens[last_index].text == "W"
                and "FOREVER" in _words(tokens, last_index)
                and not is_m
            )
            if last_index in moves or is_wait or is_m:
                questions.append(Question(token.start, word, "TRUE", is_wait, _words(tokens, k)))
        elif word in MOVES or word in STATEMENTS:
            previous_index, last_index = last_index, k
    if not moves:
        return None
    if ending == DONE:
        questions = [
            candidate for candidate in questions if not candidate.is_ever or candidate.word == "IF"
        ]
        questions = [_question_at_start(candidate) for candidate in questions]
    # A WHILE with moves that the robot was in when its time was over has let it in.
    questions.sort(
        key=lambda candidate: (
            ending != DONE and not candidate.is_ever and candidate.word == "WHILE",
            candidate.start,
        )
    )
    return questions[0] if questions else None


def _question_at_start(question: Question) -> Question:
    """Return a question that was to give something, with what it gave."""
    if not question.is_ever:
        return question
    return question._replace(is_ever=False, truth="FALSE" if question.truth == "TRUE" else "TRUE")


def _words(tokens: Sequence[Token], index: int) -> list[str]:
    return [token.text for value in _values(tokens, index) for token in value if token.kind == WORD]
