"""The instructions of one sentence, all of them or none, and the block that they are in.

Knows no separators of programs and no row. A sentence with a word that has no place gives no
instruction.
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
    Lexeme,
    Names,
    brackets_end,
    lexicon_meaning,
    make_token,
)
from tiniscript.recovery.slots import FilledCall, fill_call
from tiniscript.recovery.worded import condition_values
from tiniscript.recovery.writing import format_line
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER
from tiniscript.syntax.operators import COMPARISONS

MAX_WORDS = 40  # words of a sentence
_SIDEWAYS_MOVES = ("L", "R", "B")  # DISTANCE looks ahead
_TURNS = _SIDEWAYS_MOVES[:2]


class SpokenInstruction(NamedTuple):
    """An instruction as written; `samples` are the values that no word says: `2 s`.

    `is_side_free`: which way it turns is not said.
    """

    word: str
    text: str
    samples: tuple[str, ...]
    is_side_free: bool = False
    is_repeated: bool = False


def instructions_text(spoken_instructions: Sequence[SpokenInstruction]) -> str:
    return ";".join(instruction.text for instruction in spoken_instructions)


def samples_text(spoken_instructions: Sequence[SpokenInstruction]) -> str:
    """Return default values that no word specifies: `2 s, 80 %`."""
    return ", ".join(
        sorted({sample for instruction in spoken_instructions for sample in instruction.samples})
    )


def spoken_instructions(words: Sequence[Lexeme], names: Names) -> list[SpokenInstruction]:
    """Return the instructions of a sentence, in turn."""
    found_instructions: list[SpokenInstruction] = []
    if len(words) > MAX_WORDS:
        return []
    words = [
        word
        for word, next_word in pairwise([*_join_words(words, names), make_token(";")])
        if not lexicon_meaning(word.text, "the")
        or lexicon_meaning(next_word.text, "the")
        or not lexicon_meaning(next_word.text, "idle")
    ]  # `o robô` is no OR
    words_meant = ["", *(names.find_meaning(word.text) for word in words[1:])]
    question_index = next(
        (k for k, concept in enumerate(words_meant) if concept in ("IF", "WHEN")), 0
    )
    if question_index:
        return _instructions_with_condition(
            spoken_instructions(words[:question_index], names), words[question_index:], names
        )
    joins = "" if any(word.text == "(" for word in words) else ",."  # `gira(2, 80)` is one
    groups = groupby(
        words,
        key=lambda token: token.text in (*joins,) or bool(lexicon_meaning(token.text, "then")),
    )
    for is_joint, group in groups:
        group_words = list(group)
        if is_joint or (
            not found_instructions
            and all(lexicon_meaning(token.text, "filler") for token in group_words)
        ):
            continue  # `Hola robot, …`
        part_instructions = _joined_instructions(group_words, names)
        if not part_instructions or any(
            instruction.is_repeated
            for instruction in part_instructions[bool(not found_instructions) :]
        ):
            return []  # it is unclear which part is repeated
        found_instructions += part_instructions
    return found_instructions


def _join_words(words: Sequence[Lexeme], names: Names) -> Sequence[Lexeme]:
    """Return words in which those that are one are one: `para adelante`, `si no`."""
    while joined_name := rewrites.join_one_name(words, names):
        words = joined_name[0]
    return words


def _instructions_with_condition(
    instructions_before: list[SpokenInstruction], words: Sequence[Lexeme], names: Names
) -> list[SpokenInstruction]:
    """Return instructions and the condition after; a move that it stops is watched meanwhile."""
    question = block(words, names, goes_on=False)
    if not question and [instruction.word for instruction in instructions_before[-1:]] in (
        ["S"],
        ["STOP"],
    ):
        return _instructions_stopped_when(instructions_before[:-1], words, names)
    if not instructions_before or not question:
        return []
    header, first_instruction, *later_instructions = question.split(";")
    has_number = any(word.kind is NUMBER for word in words)
    samples = () if has_number else (f"{NEAR_CM} cm",)
    if (
        first_instruction in ("S", "STOP")
        and instructions_before[-1].word in MOVES
        and "UNTIL" not in instructions_before[-1].text
    ):
        move, move_samples = instructions_before[-1], instructions_before[-1].samples + samples
        bounded_move = move._replace(text=f"{move.text} UNTIL{header[2:]}", samples=move_samples)
        branch_instructions = (
            [SpokenInstruction("IF", ";".join((header, *later_instructions)), ())]
            if len(later_instructions) > 1
            else []
        )
        return [*instructions_before[:-1], bounded_move, *branch_instructions]
    return [*instructions_before, SpokenInstruction("IF", question, samples)]


def _instructions_stopped_when(
    instructions_before: list[SpokenInstruction], words: Sequence[Lexeme], names: Names
) -> list[SpokenInstruction]:
    """Return instructions whose last one ends by a condition: `anda y para cuando …`."""
    condition, condition_samples = _parse_condition(words[1:], names)
    if (
        not instructions_before
        or not condition
        or instructions_before[-1].word not in MOVES
        or "UNTIL" in instructions_before[-1].text
    ):
        return []
    move = instructions_before[-1]
    move_samples = tuple(sample for sample in move.samples if not sample.endswith(" s"))
    text = move.text if move_samples == move.samples else f"{move.word}(FOREVER, {POWER.sample})"
    bounded_move = move._replace(
        text=f"{text} UNTIL({condition})", samples=move_samples + condition_samples
    )
    return [*instructions_before[:-1], bounded_move]


def _joined_instructions(words: list[Lexeme], names: Names) -> list[SpokenInstruction]:
    """Return the instructions between two joining words, each beginning with its own."""
    if instruction := _spoken_instruction(words, names):
        return [instruction]
    for k in range(2, len(words) - 1):
        first_instruction = (
            _spoken_instruction(words[:k], names) if _begins_instruction(words[k], names) else None
        )
        if (
            first_instruction
            and first_instruction.word == "BEEP"
            and lexicon_meaning(words[k].text, "note")
        ):
            return []
        later_instructions = (
            _joined_instructions(words[k:], names)
            if first_instruction and len(first_instruction.samples) < 2
            else []
        )
        if first_instruction and later_instructions:
            return [first_instruction, *later_instructions]
    return []


def _begins_instruction(token: Lexeme, names: Names) -> bool:
    """Return whether a word begins an instruction."""
    is_turn = bool(lexicon_meaning(token.text, "turn"))
    return is_turn or names.find_meaning(token.text) in (*CALL_WORDS, "S", "STOP")


def _spoken_instruction(words: list[Lexeme], names: Names) -> SpokenInstruction | None:
    if bounded_move := _move_until(words, names):
        return bounded_move
    concept = names.find_meaning(words[0].text)
    texts_after = [token.text for token in words[1:]]
    if concept in ("S", "STOP") and texts_after:
        if all(lexicon_meaning(text, "the", "engine", "filler") for text in texts_after):
            return SpokenInstruction("S", "S", ())
        if any(token.kind is NUMBER for token in words):
            wait_call = fill_call([make_token("W"), *words[1:]], names, has_until=False)
            return (
                SpokenInstruction("S", f"{concept};{format_line(wait_call.tokens)}", ())
                if wait_call
                else None
            )
    call = fill_call(words, names, has_until=False, is_instruction=True)
    is_free_turn = call is None and any(lexicon_meaning(token.text, "turn") for token in words)
    if is_free_turn:
        other_words = [token for token in words if not lexicon_meaning(token.text, "turn")]
        call = fill_call(
            [make_token("R"), *other_words], names, has_until=False, is_instruction=True
        )
    if call is None:
        return None
    text, word = format_line(call.tokens), call.tokens[0].text
    if call.times:
        pause_s = f"W({call.tokens[2].text});" if word == "BEEP" else ""
        text = f"LOOP({call.times});{text};{pause_s}{BLOCK_ENDS['LOOP']}"
    return SpokenInstruction(word, text, call.samples, is_free_turn, bool(call.times))


def _move_until(words: Sequence[Lexeme], names: Names) -> SpokenInstruction | None:
    """Return the move that words say up to a condition."""
    until_index = next(
        (
            until_index
            for until_index, token in enumerate(words)
            if names.find_meaning(token.text) == "UNTIL"
        ),
        0,
    )
    call: FilledCall | None = (
        fill_call(words[:until_index], names, has_until=True, is_instruction=True)
        if until_index
        else None
    )
    if call is None or call.times or "DISTANCE" not in names.sensors:
        return None
    word = call.tokens[0].text
    condition, condition_samples = _parse_condition(
        words[until_index + 1 :], names, may_be_distance=word == "F"
    )
    text = f"{format_line(call.tokens)} UNTIL({condition})"
    return SpokenInstruction(word, text, call.samples + condition_samples) if condition else None


def _parse_condition(
    words: Sequence[Lexeme], names: Names, may_be_distance: bool = True
) -> tuple[str, tuple[str, ...]]:
    """Return the condition in words, and its missing parts.

    `may_be_distance`: it may be one for something near, which DISTANCE sees.
    """
    if condition_text := format_line(condition_in(words, names)):
        return condition_text, ()
    values = (condition_values(words, names) if may_be_distance else None) or {}
    condition = values.get("asked") or values.get("question", "")
    has_other_question = any(
        names.find_meaning(word.text) in _SIDEWAYS_MOVES or word.text in COMPARISONS
        for word in words
    )
    if has_other_question or not condition.startswith("DISTANCE"):
        return "", ()
    return condition, () if "asked" in values else (f"{NEAR_CM} cm",)


def block(tokens: Sequence[Lexeme], names: Names, goes_on: bool) -> str:
    """Return the block that one sentence describes: its header, its body, and its end.

    `goes_on`: it continues further down.
    """
    word = names.find_meaning(tokens[0].text)
    if word not in ("IF", "WHEN", "WHILE", "LOOP") or len(tokens) > MAX_WORDS:
        return ""
    is_when = bool(lexicon_meaning(tokens[0].text, "whenever"))
    tokens = [tokens[0], *_join_words(tokens[1:], names)]  # `si no hay` is no ELSE
    while tokens[-1].text in WORD_OF_END or lexicon_meaning(tokens[-1].text, "end"):
        tokens = tokens[:-1]
    texts = [token.text for token in tokens]
    else_index = next(
        (k for k, text in enumerate(texts) if names.find_meaning(text) == "ELSE"), len(texts)
    )
    else_instructions = spoken_instructions(tokens[else_index + 1 :], names)
    comma_index = next((k for k in range(2, else_index) if texts[k] == "," and word != "LOOP"), 0)
    for k in [comma_index] if comma_index else range(2, else_index):
        header = _block_header(word, tokens[1:k], names)
        if is_when and ("(KEY_" in header or "(PAD_" in header):
            word, header = "WHEN", f"WHEN{header[2:]}"
        body_instructions = spoken_instructions(tokens[k:else_index], names) if header else []
        if header and not body_instructions and _begins_instruction(tokens[k], names):
            return ""  # the instruction differs from the one that the words describe
        if not body_instructions or any(
            instruction.is_side_free for instruction in (*body_instructions, *else_instructions)
        ):
            continue
        is_side_word = names.find_meaning(texts[k]) in _TURNS and texts[k + 1 : k + 2] != ["("]
        if word != "LOOP" and tokens[k].source and is_side_word:
            return ""  # the number may be the wall's place, or the target
        word_index = next(
            (j for j in range(k, else_index) if not lexicon_meaning(texts[j], "filler")), k
        )
        if lexicon_meaning(texts[word_index], "front") and word_index + 1 < else_index:
            continue  # `uma parede na frente, para`
        is_mixed = any(
            lexicon_meaning(text, "then") and not lexicon_meaning(text, "and") for text in texts[k:]
        )
        if (word == "LOOP" and is_mixed) or (else_index < len(texts) and not else_instructions):
            return ""
        parts = [
            header,
            instructions_text(body_instructions),
            *(["ELSE", instructions_text(else_instructions)] if else_instructions else []),
        ]
        return ";".join(parts if goes_on else [*parts, BLOCK_ENDS[word]])
    return ""


def _block_header(word: str, words: Sequence[Lexeme], names: Names) -> str:
    """Return the header that words describe: the number of repetitions, or the question."""
    if word == "LOOP":
        number = next((token.text for token in words if token.kind is NUMBER), "")
        return f"LOOP({number})" if number and lexicon_meaning(words[-1].text, "times") else ""
    condition = _parse_condition(words, names)[0]
    return f"{word}({condition})" if condition else ""


def condition_in(words: Sequence[Lexeme], names: Names) -> list[Lexeme]:
    """Return the question that words ask, in words of the language; or an empty text.

    A condition is a comparison, or a yes-no value: `KEY_A`, `NOT KEY_A`.
    """
    words = words[1:-1] if brackets_end(words, 0) == len(words) else words
    readings = lines.read(
        [make_token("IF"), make_token("("), *words, make_token(")")], names, is_quick=True
    )
    tokens = readings[0].tokens if readings else []
    end = next((k for k, token in enumerate(tokens) if token.text == ";"), len(tokens)) - 1
    condition_tokens = tokens[2:end]
    return (
        condition_tokens
        if any(_is_question_word(token.text, names) for token in condition_tokens)
        else []
    )


def _is_question_word(word: str, names: Names) -> bool:
    """Return whether a word makes its neighbours a question. A constant yes or no does not, and may
    be more: `si no avanza`.
    """
    is_constant = word in ("TRUE", "FALSE")
    return word in COMPARISONS or (names.is_yes_no(word) and not is_constant)
