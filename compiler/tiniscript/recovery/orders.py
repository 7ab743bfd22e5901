"""Orders: the instructions that one sentence says, all of them or none, and the block they are in.

Knows no separators of programs and no row. A sentence with a word that has no place says none.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

from tiniscript.base.words import BLOCK_ENDS, MOVES, POWER
from tiniscript.recovery import lines, rewrites
from tiniscript.recovery.meanings import (
    CALL_WORDS,
    NEAR_CM,
    WORD_OF_END,
    Lexeme,
    Names,
    closed,
    lexicon_meaning,
    made,
)
from tiniscript.recovery.slots import Filled, filled
from tiniscript.recovery.worded import worded
from tiniscript.recovery.writing import laid_out
from tiniscript.syntax.lexer import NUMBER
from tiniscript.syntax.operators import COMPARISONS

MOST_WORDS = 40  # words of a sentence
_SIDEWAYS_MOVES = ("L", "R", "B")  # DISTANCE looks ahead
_TURNS = _SIDEWAYS_MOVES[:2]


class Order(NamedTuple):
    """An instruction as it is written; `samples` are the values that no word says: `2 s`.

    `is_side_free`: which way it turns is not said.
    """

    word: str
    text: str
    samples: tuple[str, ...]
    is_side_free: bool = False
    is_repeated: bool = False


def written(orders: Sequence[Order]) -> str:
    return ";".join(order.text for order in orders)


def made_up(orders: Sequence[Order]) -> str:
    """Return what no word says: `2 s, 80 %`."""
    return ", ".join(sorted({sample for order in orders for sample in order.samples}))


def orders(words: Sequence[Lexeme], names: Names) -> list[Order]:
    """Return the orders of a sentence, in turn."""
    result: list[Order] = []
    if len(words) > MOST_WORDS:
        return []
    words = [
        one
        for one, after in pairwise([*_join_words(words, names), made(";")])
        if not lexicon_meaning(one.text, "the")
        or lexicon_meaning(after.text, "the")
        or not lexicon_meaning(after.text, "idle")
    ]  # `o robô` is no OR
    words_meant = ["", *(names.meant(word.text) for word in words[1:])]
    question_at = next((k for k, each in enumerate(words_meant) if each in ("IF", "WHEN")), 0)
    if question_at:
        return _orders_with_condition(
            orders(words[:question_at], names), words[question_at:], names
        )
    joins = "" if any(word.text == "(" for word in words) else ",."  # `gira(2, 80)` is one
    groups = groupby(
        words, key=lambda it: it.text in (*joins,) or bool(lexicon_meaning(it.text, "then"))
    )
    for is_joint, group in groups:
        part = list(group)
        if is_joint or (
            not result and all(lexicon_meaning(lexeme.text, "filler") for lexeme in part)
        ):
            continue  # `Hola robot, …`
        part_orders = _orders(part, names)
        if not part_orders or any(order.is_repeated for order in part_orders[bool(not result) :]):
            return []  # nobody knows how much of it is done so often
        result += part_orders
    return result


def _join_words(words: Sequence[Lexeme], names: Names) -> Sequence[Lexeme]:
    """Return words in which those that are one are one: `para adelante`, `si no`."""
    while joined := rewrites.one_word(words, names):
        words = joined[0]
    return words


def _orders_with_condition(
    first: list[Order], words: Sequence[Lexeme], names: Names
) -> list[Order]:
    """Return orders and the condition after them; a move that it stops is watched meanwhile."""
    question = block(words, names, goes_on=False)
    if not question and [order.word for order in first[-1:]] in (["S"], ["STOP"]):
        return _stopped_when(first[:-1], words, names)
    if not first or not question:
        return []
    header, stop, *rest = question.split(";")
    number = any(word.kind is NUMBER for word in words)
    samples = () if number else (f"{NEAR_CM} cm",)
    if stop in ("S", "STOP") and first[-1].word in MOVES and "UNTIL" not in first[-1].text:
        move, made_of = first[-1], first[-1].samples + samples
        stopped = move._replace(text=f"{move.text} UNTIL{header[2:]}", samples=made_of)
        branch_orders = [Order("IF", ";".join((header, *rest)), ())] if len(rest) > 1 else []
        return [*first[:-1], stopped, *branch_orders]
    return [*first, Order("IF", question, samples)]


def _stopped_when(first: list[Order], words: Sequence[Lexeme], names: Names) -> list[Order]:
    """Return orders of which a condition ends the last one: `anda y para cuando …`."""
    condition, sample = _parse_condition(words[1:], names)
    if not first or not condition or first[-1].word not in MOVES or "UNTIL" in first[-1].text:
        return []
    move = first[-1]
    made_of = tuple(sample for sample in move.samples if not sample.endswith(" s"))
    text = move.text if made_of == move.samples else f"{move.word}(FOREVER, {POWER.sample})"
    stopped = move._replace(text=f"{text} UNTIL({condition})", samples=made_of + sample)
    return [*first[:-1], stopped]


def _orders(words: list[Lexeme], names: Names) -> list[Order]:
    """Return the orders between two words that join, of which each begins with its own."""
    if order := _order(words, names):
        return [order]
    for k in range(2, len(words) - 1):
        first = _order(words[:k], names) if _begins_order(words[k], names) else None
        if first and first.word == "BEEP" and lexicon_meaning(words[k].text, "note"):
            return []
        rest = _orders(words[k:], names) if first and len(first.samples) < 2 else []
        if first and rest:
            return [first, *rest]
    return []


def _begins_order(token: Lexeme, names: Names) -> bool:
    """Whether a word begins an order."""
    is_turn = bool(lexicon_meaning(token.text, "turn"))
    return is_turn or names.meant(token.text) in (*CALL_WORDS, "S", "STOP")


def _order(words: list[Lexeme], names: Names) -> Order | None:
    if to_wall := _until(words, names):
        return to_wall
    first = names.meant(words[0].text)
    rest = [lexeme.text for lexeme in words[1:]]
    if first in ("S", "STOP") and rest:
        if all(lexicon_meaning(item, "the", "engine", "filler") for item in rest):
            return Order("S", "S", ())
        if any(lexeme.kind is NUMBER for lexeme in words):
            pause = filled([made("W"), *words[1:]], names, has_until=False)
            return Order("S", f"{first};{laid_out(pause.tokens)}", ()) if pause else None
    call = filled(words, names, has_until=False, is_order=True)
    is_free_turn = call is None and any(lexicon_meaning(lexeme.text, "turn") for lexeme in words)
    if is_free_turn:
        other_words = [lexeme for lexeme in words if not lexicon_meaning(lexeme.text, "turn")]
        call = filled([made("R"), *other_words], names, has_until=False, is_order=True)
    if call is None:
        return None
    text, word = laid_out(call.tokens), call.tokens[0].text
    if call.times:
        pause_s = f"W({call.tokens[2].text});" if word == "BEEP" else ""
        text = f"LOOP({call.times});{text};{pause_s}{BLOCK_ENDS['LOOP']}"
    return Order(word, text, call.samples, is_free_turn, bool(call.times))


def _until(words: Sequence[Lexeme], names: Names) -> Order | None:
    """Return the move that words say up to a condition."""
    k = next((k for k, lexeme in enumerate(words) if names.meant(lexeme.text) == "UNTIL"), 0)
    call: Filled | None = filled(words[:k], names, has_until=True, is_order=True) if k else None
    if call is None or call.times or "DISTANCE" not in names.sensors:
        return None
    word = call.tokens[0].text
    condition, sample = _parse_condition(words[k + 1 :], names, may_be_distance=word == "F")
    text = f"{laid_out(call.tokens)} UNTIL({condition})"
    return Order(word, text, call.samples + sample) if condition else None


def _parse_condition(
    words: Sequence[Lexeme], names: Names, may_be_distance: bool = True
) -> tuple[str, tuple[str, ...]]:
    """Return the condition that words ask, and what they do not say of it.

    `may_be_distance`: it may be one for something near, which DISTANCE sees.
    """
    if exact := laid_out(condition_in(words, names)):
        return exact, ()
    text = (worded(words, names) if may_be_distance else None) or {}
    condition = text.get("asked") or text.get("question", "")
    has_other_question = any(
        names.meant(it.text) in _SIDEWAYS_MOVES or it.text in COMPARISONS for it in words
    )
    if has_other_question or not condition.startswith("DISTANCE"):
        return "", ()
    return condition, () if "asked" in text else (f"{NEAR_CM} cm",)


def block(tokens: Sequence[Lexeme], names: Names, goes_on: bool) -> str:
    """Return the block that one sentence says: its header, what is done, and its end.

    `goes_on`: it goes on further down.
    """
    word = names.meant(tokens[0].text)
    if word not in ("IF", "WHEN", "WHILE", "LOOP") or len(tokens) > MOST_WORDS:
        return ""
    is_when = bool(lexicon_meaning(tokens[0].text, "whenever"))
    tokens = [tokens[0], *_join_words(tokens[1:], names)]  # `si no hay` is no ELSE
    while tokens[-1].text in WORD_OF_END or lexicon_meaning(tokens[-1].text, "end"):
        tokens = tokens[:-1]
    texts = [token.text for token in tokens]
    arm = next((k for k, each in enumerate(texts) if names.meant(each) == "ELSE"), len(texts))
    other = orders(tokens[arm + 1 :], names)
    comma = next((k for k in range(2, arm) if texts[k] == "," and word != "LOOP"), 0)
    for k in [comma] if comma else range(2, arm):
        header = _head(word, tokens[1:k], names)
        if is_when and ("(KEY_" in header or "(PAD_" in header):
            word, header = "WHEN", f"WHEN{header[2:]}"
        body = orders(tokens[k:arm], names) if header else []
        if header and not body and _begins_order(tokens[k], names):
            return ""  # another order than the words after it say
        if not body or any(order.is_side_free for order in (*body, *other)):
            continue
        is_side_word = names.meant(texts[k]) in _TURNS and texts[k + 1 : k + 2] != ["("]
        if word != "LOOP" and tokens[k].source and is_side_word:
            return ""  # where the wall is, or where to go
        place = next((j for j in range(k, arm) if not lexicon_meaning(texts[j], "filler")), k)
        if lexicon_meaning(texts[place], "front") and place + 1 < arm:
            continue  # `uma parede na frente, para`
        is_mixed = any(
            lexicon_meaning(text, "then") and not lexicon_meaning(text, "and") for text in texts[k:]
        )
        if (word == "LOOP" and is_mixed) or (arm < len(texts) and not other):
            return ""
        parts = [header, written(body), *(["ELSE", written(other)] if other else [])]
        return ";".join(parts if goes_on else [*parts, BLOCK_ENDS[word]])
    return ""


def _head(word: str, words: Sequence[Lexeme], names: Names) -> str:
    """Return the header that words say: how often, or what is asked."""
    if word == "LOOP":
        number = next((lexeme.text for lexeme in words if lexeme.kind is NUMBER), "")
        return f"LOOP({number})" if number and lexicon_meaning(words[-1].text, "times") else ""
    asked = _parse_condition(words, names)[0]
    return f"{word}({asked})" if asked else ""


def condition_in(words: Sequence[Lexeme], names: Names) -> list[Lexeme]:
    """Return the question that words ask, in words of the language; nothing for none.

    A comparison is one, and what says yes or no by itself: `KEY_A`, `NOT KEY_A`.
    """
    words = words[1:-1] if closed(words, 0) == len(words) else words
    readings = lines.read([made("IF"), made("("), *words, made(")")], names, is_quick=True)
    tokens = readings[0].tokens if readings else []
    end = next((k for k, lexeme in enumerate(tokens) if lexeme.text == ";"), len(tokens)) - 1
    lexemes = tokens[2:end]
    return lexemes if any(_asks(lexeme.text, names) for lexeme in lexemes) else []


def _asks(word: str, names: Names) -> bool:
    """Whether a word makes a question of those beside it: a yes or no that never changes does not,
    and may be said for more: `si no avanza`.
    """
    is_known = word in ("TRUE", "FALSE")
    return word in COMPARISONS or (names.is_yes_no(word) and not is_known)
