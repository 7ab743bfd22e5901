"""Slips: the differences of an instruction from its repair, their codes, and message values.

A message names few things of a slip: `NAMES_OF_CODE` says which, `_VALUE_GAPS` how each is written.
Knows no block and no sentence of any language.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from difflib import SequenceMatcher
from itertools import pairwise, takewhile
from typing import NamedTuple

from tiniscript.base.source import Edit, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code
from tiniscript.recovery.lines import BRACES, Step
from tiniscript.recovery.meanings import (
    UNNAMED_END,
    Lexeme,
    certain_concept,
    lexemes,
    lexicon_meaning,
    setup_of,
    texts,
)
from tiniscript.recovery.writing import format_line
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER, WORD

BLOCK_WORDS = frozenset((*BLOCK_ENDS, *WORD_OF_END, "ELSE", "ELSEIF", *BRACES))
# Values of messages, and their offers: `dedupe` also asks for `found` of two codes.
_CODES_BY_NAMES: dict[tuple[str, ...], tuple[Code, ...]] = {
    ("fix",): (
        codes.DECIMAL_COMMA, codes.SEMICOLON_INSIDE, codes.ARGUMENT_COUNT, codes.UNTIL_ALONE,
        codes.FOREVER_NOT_HERE, codes.CHAINED, codes.EXTRA_CLOSE, codes.SPANISH_IF,
        codes.LOOP_COUNTS, codes.ASKED_AFTER, codes.CHOICE_IN_VALUE, codes.SET_TOGETHER,
    ),
    ("found",): (
        codes.SETUP_TWICE, codes.LINE_NUMBER, codes.NEEDLESS_FRAME, codes.PASTED,
    ),
    ("word",): (codes.EMPTY_BRACKETS,),
    ("found", "fix"): (
        codes.ODD_CHARACTER, codes.NOT_AN_INSTRUCTION, codes.EXTRA_WORD, codes.OTHER_ASSIGNMENT,
        codes.SIGN_BETWEEN, codes.REPEATED, codes.QUESTION_AFTER,
    ),
    ("found", "right"): (
        codes.OTHER_NOTE, codes.END_ALONE, codes.WRONG_END, codes.NAME_WITH_SPACE,
    ),
    ("right", "fix"): (codes.QUOTE, codes.SEVERAL_INSTRUCTIONS),
    ("before", "fix"): (codes.MISSING_SEPARATOR, codes.HEADER_SEPARATOR, codes.MISSING_CLOSE),
    ("usage", "fix"): (codes.MISSING_COMMA,),
    ("word", "fix"): (codes.NO_VALUE, codes.NAMED_ARGUMENT, codes.GROUPED),
    ("word", "example"): (codes.UNTIL_NOT_HERE,),
    ("found", "right", "fix"): (codes.OTHER_SIGN, codes.END_SPLIT, codes.BRACES, codes.UNIT),
    ("found", "word", "right"): (codes.BAD_NAME,),
    ("word", "usage", "fix"): (codes.MISSING_OPEN, codes.OTHER_CALL),
    ("word", "right", "fix"): (codes.NO_BRACKETS_HERE,),
    ("before", "found", "fix"): (codes.MISSING_SIGN,),
    ("before", "found", "usage", "fix"): (codes.MISSING_VALUE,),
    ("found", "right", "letter", "fix"): (codes.BAD_NUMBER,),
    ("found", "right", "usage", "takes", "fix"): (codes.OTHER_LANGUAGE,),
}  # fmt: skip
NAMES_OF_CODE = {code: names for names, its in _CODES_BY_NAMES.items() for code in its}


class InstructionChange(NamedTuple):
    """An instruction, or a line: `span` becomes `new_tokens` by these rewrites."""

    span: Span
    edit: Edit
    steps: Sequence[Step]
    old_tokens: Sequence[Lexeme]
    new_tokens: Sequence[Lexeme]


class Slip(NamedTuple):
    """The first change of a rewrite from `step_tokens` to `step_result`: from `start` on,
    `found_tokens` becomes `right_tokens`.

    All rewrites together turn `old_instructions`, one or several, into `new_instructions`.
    `shown_instructions` are the instructions to show of the `line_tokens` that it becomes, and if
    there are more than before, the first one ends at `first_length` in `new_instructions`.
    """

    code: Code
    step_tokens: Sequence[Lexeme]
    step_result: Sequence[Lexeme]
    start: int
    found_tokens: Sequence[Lexeme]
    right_tokens: Sequence[Lexeme]
    old_instructions: Sequence[Lexeme]
    new_instructions: Sequence[Lexeme]
    line_tokens: Sequence[Lexeme]
    shown_instructions: Sequence[Sequence[Lexeme]]
    first_length: int | None


def message_values(slip: Slip, code: Code) -> dict[str, str]:
    """Return the values of a message with this code about a slip."""
    return {name: _VALUE_GAPS[name](slip) for name in NAMES_OF_CODE.get(code, ())}


def slip_of(change: InstructionChange, code: Code, step: Step | None) -> Slip:
    """Return the slip of an instruction with a code, and of a rewrite if there is one."""
    has_own_step = step is not None and code is not codes.OTHER_NOTE
    old_tokens, new_tokens = (
        (step.old_tokens, step.new_tokens)
        if step and has_own_step
        else (change.old_tokens, change.new_tokens)
    )
    if "WHEN" in texts(change.new_tokens):  # the steps replaced the WHEN by an IF
        old_tokens, new_tokens = (
            [token._replace(text="WHEN") if token.text == "IF" else token for token in line]
            for line in (old_tokens, new_tokens)
        )
    old_lexemes, new_lexemes = without_setup(change.old_tokens), without_setup(change.new_tokens)
    is_begun = setup_of(change.new_tokens) and not setup_of(change.old_tokens)
    if is_begun and code in (codes.OTHER_SIGN, codes.QUOTE):
        new_lexemes = instructions(
            change.new_tokens
        )  # the bar was a word, or in quotation marks, too
    head, tail = common_lengths([*map(texts, old_lexemes)], [*map(texts, new_lexemes)])
    old_part, new_part = (
        [
            token
            for instruction in instructions_of_line[head : len(instructions_of_line) - tail]
            for token in instruction
        ]
        for instructions_of_line in (old_lexemes, new_lexemes)
    )
    start, found_tokens, right_tokens = first_difference(old_tokens, new_tokens)
    has_end = bool(head) and any(token.text in WORD_OF_END for token in new_part)
    shown_instructions = new_lexemes[0 if has_end else head : len(new_lexemes) - tail]
    first_length = len(new_lexemes[head]) if len(old_lexemes) < len(new_lexemes) else None
    slip = Slip(
        code,
        old_tokens,
        new_tokens,
        start,
        found_tokens,
        right_tokens,
        old_part,
        new_part,
        change.new_tokens,
        shown_instructions,
        first_length,
    )
    return _EXACT_SLIPS[code](slip) if code in _EXACT_SLIPS else slip


# -- which code ---------------------------------------------------------------------------------


def code_of(change: InstructionChange) -> tuple[Code, Step | None]:
    """Return the code of a change, and the rewrite that it concerns."""
    _, _, steps, old_tokens, new_tokens = change
    lost_texts = Counter(texts(old_tokens)) - Counter(texts(new_tokens))
    added_words = {*texts(new_tokens)} - {*texts(old_tokens)}
    if "SI" in lost_texts and "IF" in added_words:
        return codes.SPANISH_IF, None
    dropped_ends = {text for text in lost_texts if {text, certain_concept(text)} & {*WORD_OF_END}}
    if dropped_ends and not added_words and lost_texts.keys() <= dropped_ends | {";"}:
        return codes.EXTRA_WORD, None
    code, step = _code_of_steps(change) if steps else (_code_of_words(old_tokens, new_tokens), None)
    if (
        code is codes.EXTRA_WORD
        and added_words & {*WORD_OF_END}
        and any(lexicon_meaning(text, "end") for text in lost_texts)
    ):
        return codes.END_ALONE, None  # the word is not superfluous: it ends a block
    if code is codes.MISSING_OPEN and step and _translated_word(step):
        return codes.OTHER_LANGUAGE, step
    return code, step


def _translated_word(step: Step) -> str:
    """Return the word of a block that a rewrite has put for one of another language."""
    words = {*texts(step.old_tokens)}
    new_word = next((text for text in texts(step.new_tokens) if text in BLOCK_ENDS), "")
    is_said = new_word in map(certain_concept, words) or any(
        lexicon_meaning(word, "count") for word in words
    )
    return new_word if new_word not in words and is_said else ""


def _code_of_steps(change: InstructionChange) -> tuple[Code, Step]:
    """Return the code of the rewrite that says most: rather another word than a sign."""
    _, _, steps, old_tokens, new_tokens = change
    old_texts, new_texts = {*texts(old_tokens)}, {*texts(new_tokens)}
    other_steps = [step for step in steps if step.code is not codes.OTHER_LANGUAGE]
    other_steps.sort(
        key=lambda step: (step.code is not codes.ASKED_AFTER, step.code is codes.OTHER_SIGN)
    )
    if other_steps and other_steps[0].code in (codes.ASKED_AFTER, codes.UNTIL_NOT_HERE):
        return other_steps[0].code, other_steps[0]
    lost_words = (
        token.text for token in old_tokens if token.kind is WORD and token.text not in new_texts
    )
    foreign_word = next(
        (word for word in lost_words if certain_concept(word) in new_texts - old_texts), ""
    )
    translating_step = next((step for step in steps if step.code is codes.OTHER_LANGUAGE), None)
    if translating_step and (foreign_word or not other_steps):
        is_foreign_call = (
            foreign_word
            or "(" in old_texts
            or "(" not in new_texts
            or old_tokens[0].text not in new_texts
        )
        return codes.OTHER_LANGUAGE if is_foreign_call else codes.MISSING_OPEN, translating_step
    if foreign_word:
        changing_steps = (
            step
            for step in other_steps
            if foreign_word in {*texts(step.old_tokens)} - {*texts(step.new_tokens)}
        )
        return codes.OTHER_LANGUAGE, next(changing_steps, other_steps[0])
    right_tokens = first_difference(other_steps[0].old_tokens, other_steps[0].new_tokens)[2]
    is_comma = other_steps[0].code is codes.OTHER_CALL and texts(right_tokens) == (",",)
    return codes.MISSING_COMMA if is_comma else other_steps[0].code, other_steps[0]


def _code_of_words(old_tokens: Sequence[Lexeme], new_tokens: Sequence[Lexeme]) -> Code:
    """Return the code of a change that no rewrite made: a brace, an end, a letter with an
    accent."""
    if {*texts(old_tokens)} & {*BRACES}:
        return codes.BRACES
    source = "".join(token.source or "" for token in old_tokens)
    if not source.isascii():
        has_word = any(
            token.kind is WORD and not (token.source or "").isascii() for token in old_tokens
        )
        return codes.BAD_NAME if has_word else codes.OTHER_SIGN
    _, found_tokens, right_tokens = first_difference(old_tokens, new_tokens)
    if len(found_tokens) == len(right_tokens) == 1 and {
        *texts(found_tokens),
        *texts(right_tokens),
    } <= {*WORD_OF_END}:
        return codes.WRONG_END
    ends = [token.text for token in old_tokens if lexicon_meaning(token.text, "end")]
    if ends and ends[-1] not in texts(new_tokens):
        is_end = bool({*texts(new_tokens)} & {*BLOCK_ENDS.values()})
        return codes.END_ALONE if is_end else codes.EXTRA_WORD
    return codes.NEVER_ENDS


# -- findings of codes that know better than the first difference -------------------------------


def _foreign_words(slip: Slip) -> Slip:
    """A word of another language, with the rest of its construct: `bot.forward`, FOR of `FOR I = 1
    TO`."""
    old_tokens, start, found_tokens, right_tokens = (
        slip.step_tokens,
        slip.start,
        slip.found_tokens,
        slip.right_tokens,
    )
    tokens_with_next = old_tokens[start : start + len(found_tokens) + 1]
    has_dot = texts(found_tokens[-1:]) == (".",)
    if has_dot and not right_tokens:
        found_tokens, right_tokens = tokens_with_next, slip.step_result[start : start + 1]
    elif not right_tokens and start and old_tokens[start - 1].text != "|":
        found_tokens, right_tokens = [old_tokens[start - 1], *found_tokens], [old_tokens[start - 1]]
    elif has_dot:
        found_tokens = tokens_with_next
    end = next(
        (k for k, token in enumerate(found_tokens) if token.text in ("=", "(")), len(found_tokens)
    )
    is_assignment = end < len(found_tokens) and found_tokens[end].text == "="
    found_tokens = found_tokens[: end - is_assignment] or found_tokens
    if any(token.kind is NUMBER for token in found_tokens):  # PARA of `PARA I DE 1 A 4`
        found_tokens = [*takewhile(_is_counting, found_tokens)] or found_tokens
    if (
        right_tokens
        and found_tokens
        and all(lexicon_meaning(token.text, "filler") for token in found_tokens)
    ):
        meant_lexemes = [
            token for token in old_tokens if certain_concept(token.text) == right_tokens[0].text
        ]
        found_tokens = meant_lexemes[:1] or found_tokens  # `oi robô, anda`
    return slip._replace(found_tokens=found_tokens, right_tokens=right_tokens)


def _is_counting(token: Lexeme) -> bool:
    """Return whether a word means repetition: FOR, and EACH after it."""
    return certain_concept(token.text) == "LOOP" or bool(
        lexicon_meaning(token.text, "count", "each")
    )


def _split_number(slip: Slip) -> Slip:
    """A number in two pieces: the sign that goes, and the piece after it."""
    end_index = slip.start + len(slip.found_tokens)
    return (
        slip
        if slip.right_tokens
        else slip._replace(found_tokens=slip.step_tokens[end_index - 1 : end_index + 1])
    )


def _number_with_unit(slip: Slip) -> Slip:
    """The first number that has a unit, and is changed."""
    pairs = pairwise(slip.step_tokens[max(0, slip.start - 1) :])
    units = (
        [number, unit] for number, unit in pairs
        if number.kind is NUMBER and (lexicon_meaning(unit.text, "unit") or unit.text == "%")
    )  # fmt: skip
    return slip._replace(found_tokens=next(units, slip.found_tokens))


def _block_header(slip: Slip) -> Slip:
    headers = [
        token for token in (*slip.step_tokens, *slip.step_result) if token.text in BLOCK_ENDS
    ]
    return slip._replace(found_tokens=headers[:1] or slip.found_tokens)


def _sign_alone(slip: Slip) -> Slip:
    """The sign of `DISTÂNCIA := 5`, without its name."""
    signs = [token for token in slip.found_tokens if token.kind is not WORD]
    return slip._replace(found_tokens=signs or slip.found_tokens)


def _whole_sign(slip: Slip) -> Slip:
    """The whole sign if its first part stays: `**` of `X ** 2`."""
    k, found_tokens, right_tokens = slip.start, slip.found_tokens, slip.right_tokens
    is_part = (
        0 < k < len(slip.step_tokens)
        and slip.step_tokens[k].space == ""
        and found_tokens[:1] == slip.step_tokens[k : k + 1]
    )
    previous_token = slip.step_tokens[k - 1] if is_part else None
    if (
        previous_token is None
        or {previous_token.kind, found_tokens[0].kind} & {WORD, NUMBER}
        or previous_token.text in "()"
    ):
        return slip
    return slip._replace(
        found_tokens=[previous_token, *found_tokens],
        right_tokens=[slip.step_result[k - 1], *right_tokens],
        start=k - 1,
    )


_EXACT_SLIPS: dict[Code, Callable[[Slip], Slip]] = {
    codes.OTHER_LANGUAGE: _foreign_words, codes.BAD_NUMBER: _split_number,
    codes.UNIT: _number_with_unit,
    codes.QUESTION_AFTER: _block_header, codes.OTHER_ASSIGNMENT: _sign_alone,
    codes.OTHER_SIGN: _whole_sign,
}  # fmt: skip


# -- the content of a message -------------------------------------------------------------------


def wrong_text_of(slip: Slip) -> str:
    """Return the wrong text as written: the whole instruction if a sign is missing."""
    code, found_tokens = slip.code, slip.found_tokens
    if _is_between_words(slip):
        return text_of(slip.step_tokens[slip.start : slip.start + 1])
    is_missing_sign = code is codes.OTHER_ASSIGNMENT  # `X 5`; otherwise it is missing
    is_whole_instruction = code is codes.REPEATED or (
        code is codes.OTHER_SIGN and not slip.right_tokens
    )
    old_text = text_of(
        slip.old_instructions
        if is_whole_instruction or not (found_tokens or is_missing_sign)
        else found_tokens
    )
    if code is codes.LINE_NUMBER and old_text[:1] == "_":
        return "_"
    if code in (codes.OTHER_LANGUAGE, codes.EXTRA_WORD):
        return old_text.strip("; ")
    if code is codes.OTHER_NOTE:
        return re.match(r"\w+|\W+", old_text).group().strip()  # type: ignore[union-attr]
    return old_text


def _is_between_words(slip: Slip) -> bool:
    """Return whether something is missing between two words, which are named."""
    is_between = slip.code in (codes.MISSING_VALUE, codes.MISSING_SIGN)
    return is_between and not slip.found_tokens and slip.start > 0


def right_text_of(slip: Slip) -> str:
    """Return the correct form in TiniScript."""
    changed_text = _changed_text(slip)
    right_text = format_line(slip.right_tokens) or changed_text
    right_text = (
        changed_text if right_text == UNNAMED_END and changed_text in WORD_OF_END else right_text
    )  # the end of this block is known
    if slip.code is codes.OTHER_LANGUAGE:
        right_text = _word_in(right_text)
    if slip.code is codes.OTHER_SIGN and right_text.split()[-1:] in (["AND"], ["OR"]):
        right_text = right_text.split()[
            -1
        ]  # `A O B > 5`: text missing after A is not a part of the sign
    return f"{right_text} )" if right_text.endswith("(") else right_text


def _word_in(text: str) -> str:
    """Return the one word that a text is about: LOOP of `I = 0;LOOP(5)`, F of `va F`."""
    heads = (part for part in text.split(";") if re.split(r"\W", part)[0] in BLOCK_WORDS)
    text = re.split("[()]", next(heads, text), maxsplit=1)[0]
    text = next((word for word in text.split() if word in WORDS), text)
    return (
        text if text in WORDS else certain_concept(text) or text
    )  # the last part of `bot.forward`


def text_before(slip: Slip) -> str:
    """Return the correct part of the instruction before the slip."""
    if _is_between_words(slip):
        return text_of(slip.step_tokens[slip.start - 1 : slip.start])
    common_text = text_of(
        slip.old_instructions[
            : common_lengths(
                texts(slip.old_instructions), texts(slip.new_instructions[: slip.first_length])
            )[0]
        ]
    )
    if slip.code is codes.HEADER_SEPARATOR and (
        not common_text or common_text[-1] == "(" or lexemes(common_text)[0].text not in BLOCK_WORDS
    ):
        block_parts = (
            part for part in without_setup(slip.line_tokens) if part[0].text in BLOCK_WORDS
        )
        return (
            format_line(next(block_parts)) if common_text else slip.new_instructions[0].text
        )  # `CADA VEZ QUE … S`
    return common_text


def _changed_text(slip: Slip) -> str:
    """Return the instructions that a change makes."""
    return ";".join(format_line(part) for part in slip.shown_instructions) or format_line(
        slip.line_tokens
    )


def fix_of(slip: Slip) -> str:
    """Return the offer: those instructions, or only `SI|` if its sign was wrong."""
    right = right_text_of(slip) if slip.code is codes.OTHER_SIGN else ""
    return f"{right}|" if right in ("SI", "SB") else _changed_text(slip)


def _word(slip: Slip) -> str:
    """Return the word in question: the one before its brackets, or the first one."""
    word = _WORD_GAPS.get(slip.code, _first_word)(slip)
    is_def = slip.code is codes.EMPTY_BRACKETS and "DEF" in texts(slip.line_tokens)
    return f"DEF {word}" if is_def else word


def _first_word(slip: Slip) -> str:
    return _known_word(slip.new_instructions)


def _known_word(tokens: Sequence[Lexeme]) -> str:
    words = [token.text for token in tokens if token.kind is WORD]
    return next((word for word in words if word in WORDS), "".join(words[:1]))


def _called_word(slip: Slip) -> str:
    """The word before the empty brackets."""
    texts_after = texts(slip.step_tokens[slip.start :])
    if "(" not in texts_after[slip.start == 0 :]:
        return _first_word(slip)
    return slip.step_tokens[slip.start + texts_after.index("(") - 1].text


def _grouping_header(slip: Slip) -> str:
    """The header whose brackets have instructions in them, or an empty text if they have no
    header."""
    if slip.start and slip.step_tokens[slip.start - 1].text == ";":
        return ""
    return next(
        (token.text for token in slip.step_result if token.text in ("LOOP", "WHILE", "IF")), ""
    )


def _accented_word(slip: Slip) -> str:
    """The word of the language that has an accent, or an empty text for a name."""
    return next(
        (token.text for token in slip.step_tokens[slip.start :][:1] if token.text in WORDS), ""
    )


def _bracketed_word(slip: Slip) -> str:
    """The word that gets its bracket."""
    for word, sign in pairwise(slip.step_result):
        if sign.text == "(" and sign.source is None and word.kind is WORD:
            return word.text
    return _first_word(slip)


def _rest_of_line(slip: Slip) -> str:
    tokens_after = slip.step_tokens[slip.start :]
    return _known_word(
        tokens_after[2:] if texts(tokens_after[1:2]) == ("=",) else tokens_after
    )  # `Y = SIDE(3)`


_WORD_GAPS: dict[Code, Callable[[Slip], str]] = {
    codes.EMPTY_BRACKETS: _called_word, codes.GROUPED: _grouping_header,
    codes.BAD_NAME: _accented_word,
    codes.MISSING_OPEN: _bracketed_word, codes.NO_VALUE: _rest_of_line,
    codes.NO_BRACKETS_HERE: _rest_of_line,
}  # fmt: skip


def _usage(slip: Slip) -> str:
    """Return the usage of the word; "" for names of the program."""
    word = _word(slip)
    return WORDS[word].usage if word in WORDS and word != "DEF" else ""


def _letter(slip: Slip) -> str:
    """Return the letter that is in a number in the place of a digit."""
    found_text, right_text = wrong_text_of(slip), right_text_of(slip)
    letters = (
        {letter for letter in found_text if letter.isalpha()} - {*right_text}
        if len(found_text) == len(right_text)
        else set()
    )
    return letters.pop() if len(letters) == 1 else ""


def _usage_if_longer(slip: Slip) -> str:
    """Return the usage if the offer has more numbers than were written."""
    number_count, needed_count = (
        sum(token.kind is NUMBER for token in instructions_tokens)
        for instructions_tokens in (slip.old_instructions, slip.new_instructions)
    )
    word = WORDS.get(right_text_of(slip))  # `avanza 2 s 3 veces`: F
    usage = word.usage if word and word.arguments else _usage(slip)
    return usage if needed_count > number_count else ""


_VALUE_GAPS: dict[str, Callable[[Slip], str]] = {
    "found": wrong_text_of, "right": right_text_of, "before": text_before, "word": _word,
    "usage": _usage, "fix": fix_of, "example": fix_of, "letter": _letter, "takes": _usage_if_longer,
}  # fmt: skip


# -- tokens -------------------------------------------------------------------------------------


def common_lengths(old_items: Sequence[object], new_items: Sequence[object]) -> tuple[int, int]:
    """Return the lengths of the common start and end of two sequences."""
    most_items = min(len(old_items), len(new_items))
    head = next((k for k in range(most_items) if old_items[k] != new_items[k]), most_items)
    most_items -= head
    return head, next(
        (k for k in range(most_items) if old_items[-1 - k] != new_items[-1 - k]), most_items
    )


def first_difference(
    old_tokens: Sequence[Lexeme], new_tokens: Sequence[Lexeme]
) -> tuple[int, Sequence[Lexeme], Sequence[Lexeme]]:
    """Return the first place where two lines differ, and both contents."""
    old_texts = [
        token.text if (token.source or "").isascii() else token.source for token in old_tokens
    ]
    matcher = SequenceMatcher(None, old_texts, texts(new_tokens), autojunk=False)
    for kind, old_start, old_end, new_start, new_end in matcher.get_opcodes():
        if kind != "equal":
            return old_start, old_tokens[old_start:old_end], new_tokens[new_start:new_end]
    return 0, old_tokens, new_tokens


def instructions(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line, split at separators.

    A separator in brackets separates nothing if all brackets of the line are closed.
    """
    found_instructions: list[list[Lexeme]] = [[]]
    depth, is_closed = 0, texts(tokens).count("(") == texts(tokens).count(")")
    for token in tokens:
        depth += (token.text == "(") - (token.text == ")")
        if token.text == ";" and not (is_closed and depth > 0):
            found_instructions.append([])
        else:
            found_instructions[-1].append(token)
    return found_instructions


def without_setup(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line, without `SI|`."""
    return [
        instruction for instruction in instructions(tokens[len(setup_of(tokens)) :]) if instruction
    ]


def text_of(tokens: Sequence[Lexeme]) -> str:
    return "".join((token.space or "") + (token.source or token.text) for token in tokens).strip()
