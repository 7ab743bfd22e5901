"""Slips: how an instruction differs from what it becomes, its code, and what a message says of it.

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
    SOME_END,
    WORD_OF_END,
    Lexeme,
    lexemes,
    lexicon_meaning,
    meant_by,
    setup_of,
    texts,
)
from tiniscript.recovery.writing import laid_out
from tiniscript.syntax.lexer import NUMBER, WORD

BLOCK_WORDS = frozenset((*BLOCK_ENDS, *WORD_OF_END, "ELSE", "ELSEIF", *BRACES))
# What messages name, and what they offer: of two codes `dedupe` asks for `found`, too.
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
    ("right", "fix"): (codes.QUOTE, codes.SEVERAL_ORDERS),
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


class Change(NamedTuple):
    """An instruction, or a line: `place` becomes `after` by these rewrites."""

    place: Span
    edit: Edit
    steps: Sequence[Step]
    before: Sequence[Lexeme]
    after: Sequence[Lexeme]


class Slip(NamedTuple):
    """Where a rewrite changes `old` into `new` first: from `start` on, `found` becomes `right`.

    With all rewrites `was`, of one instruction or several, becomes `now`. `parts` are the
    instructions to show of the `line` that it becomes, and where there are more than before, the
    first one ends at `until` in `now`.
    """

    code: Code
    old: Sequence[Lexeme]
    new: Sequence[Lexeme]
    start: int
    found: Sequence[Lexeme]
    right: Sequence[Lexeme]
    was: Sequence[Lexeme]
    now: Sequence[Lexeme]
    line: Sequence[Lexeme]
    parts: Sequence[Sequence[Lexeme]]
    until: int | None


def values_of(slip: Slip, code: Code) -> dict[str, str]:
    """Return what a message with this code says of a slip."""
    return {name: _VALUE_GAPS[name](slip) for name in NAMES_OF_CODE.get(code, ())}


def slip_of(change: Change, code: Code, step: Step | None) -> Slip:
    """Return what is wrong with an instruction that is told with a code, of a rewrite if of one."""
    is_of_step = step is not None and code is not codes.OTHER_NOTE
    old_texts, new = (
        (step.before, step.after) if step and is_of_step else (change.before, change.after)
    )
    if "WHEN" in texts(change.after):  # what the steps took for an IF
        old_texts, new = (
            [it._replace(text="WHEN") if it.text == "IF" else it for it in line]
            for line in (old_texts, new)
        )
    old_lexemes, new_lexemes = without_setup(change.before), without_setup(change.after)
    is_begun = setup_of(change.after) and not setup_of(change.before)
    if is_begun and code in (codes.OTHER_SIGN, codes.QUOTE):
        new_lexemes = instructions(change.after)  # the bar was a word, or in quotation marks, too
    head, tail = alike([*map(texts, old_lexemes)], [*map(texts, new_lexemes)])
    old_part, new_part = (
        [lexeme for part in parts[head : len(parts) - tail] for lexeme in part]
        for parts in (old_lexemes, new_lexemes)
    )
    start, found, right = first_difference(old_texts, new)
    has_end = bool(head) and any(lexeme.text in WORD_OF_END for lexeme in new_part)
    parts = new_lexemes[0 if has_end else head : len(new_lexemes) - tail]
    until = len(new_lexemes[head]) if len(old_lexemes) < len(new_lexemes) else None
    slip = Slip(
        code, old_texts, new, start, found, right, old_part, new_part, change.after, parts, until
    )
    return _EXACT_SLIPS[code](slip) if code in _EXACT_SLIPS else slip


# -- which code ---------------------------------------------------------------------------------


def code_of(change: Change) -> tuple[Code, Step | None]:
    """Return with which code a change is told, and the rewrite that it is told of."""
    _, _, steps, before, after = change
    fewer = Counter(texts(before)) - Counter(texts(after))
    added_words = {*texts(after)} - {*texts(before)}
    if "SI" in fewer and "IF" in added_words:
        return codes.SPANISH_IF, None
    dropped = {item for item in fewer if {item, meant_by(item)} & {*WORD_OF_END}}
    if dropped and not added_words and fewer.keys() <= dropped | {";"}:
        return codes.EXTRA_WORD, None
    code, step = _code_of_steps(change) if steps else (_code_of_words(before, after), None)
    if (
        code is codes.EXTRA_WORD
        and added_words & {*WORD_OF_END}
        and any(lexicon_meaning(it, "end") for it in fewer)
    ):
        return codes.END_ALONE, None  # it is no word too many: it ends a block
    if code is codes.MISSING_OPEN and step and _translated(step):
        return codes.OTHER_LANGUAGE, step
    return code, step


def _translated(step: Step) -> str:
    """Return the word of a block that a rewrite has put for one of another language."""
    words = {*texts(step.before)}
    new = next((it for it in texts(step.after) if it in BLOCK_ENDS), "")
    is_said = new in map(meant_by, words) or any(lexicon_meaning(word, "count") for word in words)
    return new if new not in words and is_said else ""


def _code_of_steps(change: Change) -> tuple[Code, Step]:
    """Return the code of the rewrite that says most: rather another word than a sign."""
    _, _, steps, before, after = change
    words, new = {*texts(before)}, {*texts(after)}
    own_steps = [step for step in steps if step.code is not codes.OTHER_LANGUAGE]
    own_steps.sort(key=lambda it: (it.code is not codes.ASKED_AFTER, it.code is codes.OTHER_SIGN))
    if own_steps and own_steps[0].code in (codes.ASKED_AFTER, codes.UNTIL_NOT_HERE):
        return own_steps[0].code, own_steps[0]
    lost_words = (
        lexeme.text for lexeme in before if lexeme.kind is WORD and lexeme.text not in new
    )
    foreign = next((item for item in lost_words if meant_by(item) in new - words), "")
    translated = next((it for it in steps if it.code is codes.OTHER_LANGUAGE), None)
    if translated and (foreign or not own_steps):
        is_foreign_call = foreign or "(" in words or "(" not in new or before[0].text not in new
        return codes.OTHER_LANGUAGE if is_foreign_call else codes.MISSING_OPEN, translated
    if foreign:
        changed_texts = (
            it for it in own_steps if foreign in {*texts(it.before)} - {*texts(it.after)}
        )
        return codes.OTHER_LANGUAGE, next(changed_texts, own_steps[0])
    right = first_difference(own_steps[0].before, own_steps[0].after)[2]
    is_comma = own_steps[0].code is codes.OTHER_CALL and texts(right) == (",",)
    return codes.MISSING_COMMA if is_comma else own_steps[0].code, own_steps[0]


def _code_of_words(before: Sequence[Lexeme], after: Sequence[Lexeme]) -> Code:
    """Return the code of what no rewrite made: a brace, an end, a letter with an accent."""
    if {*texts(before)} & {*BRACES}:
        return codes.BRACES
    source = "".join(lexeme.source or "" for lexeme in before)
    if not source.isascii():
        has_word = any(
            lexeme.kind is WORD and not (lexeme.source or "").isascii() for lexeme in before
        )
        return codes.BAD_NAME if has_word else codes.OTHER_SIGN
    _, found, right = first_difference(before, after)
    if len(found) == len(right) == 1 and {*texts(found), *texts(right)} <= {*WORD_OF_END}:
        return codes.WRONG_END
    ends = [lexeme.text for lexeme in before if lexicon_meaning(lexeme.text, "end")]
    if ends and ends[-1] not in texts(after):
        is_end = bool({*texts(after)} & {*BLOCK_ENDS.values()})
        return codes.END_ALONE if is_end else codes.EXTRA_WORD
    return codes.NEVER_ENDS


# -- what was found, where a code knows better than the first difference ------------------------


def _foreign_words(slip: Slip) -> Slip:
    """A word of another language, with what belongs to it: `bot.forward`, FOR of `FOR I = 1 TO`."""
    old_texts, start, result, right = slip.old, slip.start, slip.found, slip.right
    with_next = old_texts[start : start + len(result) + 1]
    has_dot = texts(result[-1:]) == (".",)
    if has_dot and not right:
        result, right = with_next, slip.new[start : start + 1]
    elif not right and start and old_texts[start - 1].text != "|":
        result, right = [old_texts[start - 1], *result], [old_texts[start - 1]]
    elif has_dot:
        result = with_next
    end = next((k for k, it in enumerate(result) if it.text in ("=", "(")), len(result))
    is_assignment = end < len(result) and result[end].text == "="
    result = result[: end - is_assignment] or result
    if any(lexeme.kind is NUMBER for lexeme in result):  # PARA of `PARA I DE 1 A 4`
        result = [*takewhile(_is_counting, result)] or result
    if right and result and all(lexicon_meaning(lexeme.text, "filler") for lexeme in result):
        meant_lexemes = [lexeme for lexeme in old_texts if meant_by(lexeme.text) == right[0].text]
        result = meant_lexemes[:1] or result  # `oi robô, anda`
    return slip._replace(found=result, right=right)


def _is_counting(token: Lexeme) -> bool:
    """Whether a word says that something is done several times: FOR, and EACH after it."""
    return meant_by(token.text) == "LOOP" or bool(lexicon_meaning(token.text, "count", "each"))


def _split_number(slip: Slip) -> Slip:
    """A number in two pieces: the sign that goes, and the piece after it."""
    end = slip.start + len(slip.found)
    return slip if slip.right else slip._replace(found=slip.old[end - 1 : end + 1])


def _measured(slip: Slip) -> Slip:
    """The first number that has a unit, and is changed."""
    pairs = pairwise(slip.old[max(0, slip.start - 1) :])
    units = (
        [number, unit] for number, unit in pairs
        if number.kind is NUMBER and (lexicon_meaning(unit.text, "unit") or unit.text == "%")
    )  # fmt: skip
    return slip._replace(found=next(units, slip.found))


def _header(slip: Slip) -> Slip:
    headers = [lexeme for lexeme in (*slip.old, *slip.new) if lexeme.text in BLOCK_ENDS]
    return slip._replace(found=headers[:1] or slip.found)


def _sign_alone(slip: Slip) -> Slip:
    """The sign of `DISTÂNCIA := 5`, without its name."""
    signs = [lexeme for lexeme in slip.found if lexeme.kind is not WORD]
    return slip._replace(found=signs or slip.found)


def _whole_sign(slip: Slip) -> Slip:
    """All of a sign whose first part stays: `**` of `X ** 2`."""
    k, found, right = slip.start, slip.found, slip.right
    is_part = 0 < k < len(slip.old) and slip.old[k].space == "" and found[:1] == slip.old[k : k + 1]
    before = slip.old[k - 1] if is_part else None
    if before is None or {before.kind, found[0].kind} & {WORD, NUMBER} or before.text in "()":
        return slip
    return slip._replace(found=[before, *found], right=[slip.new[k - 1], *right], start=k - 1)


_EXACT_SLIPS: dict[Code, Callable[[Slip], Slip]] = {
    codes.OTHER_LANGUAGE: _foreign_words, codes.BAD_NUMBER: _split_number, codes.UNIT: _measured,
    codes.QUESTION_AFTER: _header, codes.OTHER_ASSIGNMENT: _sign_alone,
    codes.OTHER_SIGN: _whole_sign,
}  # fmt: skip


# -- what a message says ------------------------------------------------------------------------


def found_in(slip: Slip) -> str:
    """Return what is wrong, as it was written: all of the instruction where a sign is missing."""
    code, found = slip.code, slip.found
    if _has_gap(slip):
        return text_of(slip.old[slip.start : slip.start + 1])
    is_missing_sign = code is codes.OTHER_ASSIGNMENT  # `X 5`: else it is missing
    is_whole_instruction = code is codes.REPEATED or (code is codes.OTHER_SIGN and not slip.right)
    old_text = text_of(
        slip.was if is_whole_instruction or not (found or is_missing_sign) else found
    )
    if code is codes.LINE_NUMBER and old_text[:1] == "_":
        return "_"
    if code in (codes.OTHER_LANGUAGE, codes.EXTRA_WORD):
        return old_text.strip("; ")
    if code is codes.OTHER_NOTE:
        return re.match(r"\w+|\W+", old_text).group().strip()  # type: ignore[union-attr]
    return old_text


def _has_gap(slip: Slip) -> bool:
    """Whether something is missing between two words, which are named."""
    is_between = slip.code in (codes.MISSING_VALUE, codes.MISSING_SIGN)
    return is_between and not slip.found and slip.start > 0


def right_of(slip: Slip) -> str:
    """Return how that is written in TiniScript."""
    changed_text = _changed_text(slip)
    right_text = laid_out(slip.right) or changed_text
    right_text = (
        changed_text if right_text == SOME_END and changed_text in WORD_OF_END else right_text
    )  # of a block, whose end is known
    if slip.code is codes.OTHER_LANGUAGE:
        right_text = _word_in(right_text)
    if slip.code is codes.OTHER_SIGN and right_text.split()[-1:] in (["AND"], ["OR"]):
        right_text = right_text.split()[
            -1
        ]  # `A O B > 5`: what A lacks before it is no part of the sign
    return f"{right_text} )" if right_text.endswith("(") else right_text


def _word_in(text: str) -> str:
    """Return the one word that a text is about: LOOP of `I = 0;LOOP(5)`, F of `va F`."""
    heads = (part for part in text.split(";") if re.split(r"\W", part)[0] in BLOCK_WORDS)
    text = re.split("[()]", next(heads, text), maxsplit=1)[0]
    text = next((word for word in text.split() if word in WORDS), text)
    return text if text in WORDS else meant_by(text) or text  # of `bot.forward`


def before_it(slip: Slip) -> str:
    """Return what is right of the instruction before the slip."""
    if _has_gap(slip):
        return text_of(slip.old[slip.start - 1 : slip.start])
    result = text_of(slip.was[: alike(texts(slip.was), texts(slip.now[: slip.until]))[0]])
    if slip.code is codes.HEADER_SEPARATOR and (
        not result or result[-1] == "(" or lexemes(result)[0].text not in BLOCK_WORDS
    ):
        block_parts = (part for part in without_setup(slip.line) if part[0].text in BLOCK_WORDS)
        return laid_out(next(block_parts)) if result else slip.now[0].text  # `CADA VEZ QUE … S`
    return result


def _changed_text(slip: Slip) -> str:
    """Return the instructions that a change makes."""
    return ";".join(laid_out(part) for part in slip.parts) or laid_out(slip.line)


def fix_of(slip: Slip) -> str:
    """Return what is offered: those instructions, or `SI|` alone where its sign was another."""
    right = right_of(slip) if slip.code is codes.OTHER_SIGN else ""
    return f"{right}|" if right in ("SI", "SB") else _changed_text(slip)


def _word(slip: Slip) -> str:
    """Return the word that is told of: the one before its brackets, else the first one."""
    word = _WORD_GAPS.get(slip.code, _first_word)(slip)
    is_def = slip.code is codes.EMPTY_BRACKETS and "DEF" in texts(slip.line)
    return f"DEF {word}" if is_def else word


def _first_word(slip: Slip) -> str:
    return _known_word(slip.now)


def _known_word(tokens: Sequence[Lexeme]) -> str:
    words = [token.text for token in tokens if token.kind is WORD]
    return next((word for word in words if word in WORDS), "".join(words[:1]))


def _called_word(slip: Slip) -> str:
    """The word before the empty brackets."""
    after = texts(slip.old[slip.start :])
    if "(" not in after[slip.start == 0 :]:
        return _first_word(slip)
    return slip.old[slip.start + after.index("(") - 1].text


def _grouping(slip: Slip) -> str:
    """The header whose brackets have instructions in them, nothing for brackets of no header."""
    if slip.start and slip.old[slip.start - 1].text == ";":
        return ""
    return next((lexeme.text for lexeme in slip.new if lexeme.text in ("LOOP", "WHILE", "IF")), "")


def _accented_word(slip: Slip) -> str:
    """The word of the language that has an accent, nothing for a name."""
    return next((lexeme.text for lexeme in slip.old[slip.start :][:1] if lexeme.text in WORDS), "")


def _opened(slip: Slip) -> str:
    """The word that gets its bracket."""
    for word, sign in pairwise(slip.new):
        if sign.text == "(" and sign.source is None and word.kind is WORD:
            return word.text
    return _first_word(slip)


def _rest_of_line(slip: Slip) -> str:
    message = slip.old[slip.start :]
    return _known_word(message[2:] if texts(message[1:2]) == ("=",) else message)  # `Y = SIDE(3)`


_WORD_GAPS: dict[Code, Callable[[Slip], str]] = {
    codes.EMPTY_BRACKETS: _called_word, codes.GROUPED: _grouping, codes.BAD_NAME: _accented_word,
    codes.MISSING_OPEN: _opened, codes.NO_VALUE: _rest_of_line,
    codes.NO_BRACKETS_HERE: _rest_of_line,
}  # fmt: skip


def _usage(slip: Slip) -> str:
    """Return how the word is written, nothing for one of the program or a DEF: names of its own."""
    word = _word(slip)
    return WORDS[word].usage if word in WORDS and word != "DEF" else ""


def _letter(slip: Slip) -> str:
    """Return the letter that stands in a number in the place of a digit."""
    was, now = found_in(slip), right_of(slip)
    letters = {item for item in was if item.isalpha()} - {*now} if len(was) == len(now) else set()
    return letters.pop() if len(letters) == 1 else ""


def _usage_if_longer(slip: Slip) -> str:
    """Return the usage, where what is offered has more numbers than were written."""
    number_count, needed_count = (
        sum(lexeme.kind is NUMBER for lexeme in it) for it in (slip.was, slip.now)
    )
    word = WORDS.get(right_of(slip))  # `avanza 2 s 3 veces`: F
    usage = word.usage if word and word.arguments else _usage(slip)
    return usage if needed_count > number_count else ""


_VALUE_GAPS: dict[str, Callable[[Slip], str]] = {
    "found": found_in, "right": right_of, "before": before_it, "word": _word, "usage": _usage,
    "fix": fix_of, "example": fix_of, "letter": _letter, "takes": _usage_if_longer,
}  # fmt: skip


# -- tokens -------------------------------------------------------------------------------------


def alike(old_texts: Sequence[object], new: Sequence[object]) -> tuple[int, int]:
    """Return how much two texts, or two lines, have alike at their beginning and at their end."""
    most_lexemes = min(len(old_texts), len(new))
    head = next((k for k in range(most_lexemes) if old_texts[k] != new[k]), most_lexemes)
    most_lexemes -= head
    return head, next(
        (k for k in range(most_lexemes) if old_texts[-1 - k] != new[-1 - k]), most_lexemes
    )


def first_difference(
    before: Sequence[Lexeme], after: Sequence[Lexeme]
) -> tuple[int, Sequence[Lexeme], Sequence[Lexeme]]:
    """Return where two lines differ first, and what stands there in each of them."""
    old_texts = [
        lexeme.text if (lexeme.source or "").isascii() else lexeme.source for lexeme in before
    ]
    matched = SequenceMatcher(None, old_texts, texts(after), autojunk=False)
    for kind, start, end, begin, stop in matched.get_opcodes():
        if kind != "equal":
            return start, before[start:end], after[begin:stop]
    return 0, before, after


def instructions(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line; what is between two separators is one.

    A separator in brackets parts nothing, where all brackets of the line are closed.
    """
    lexemeses: list[list[Lexeme]] = [[]]
    depth, is_closed = 0, texts(tokens).count("(") == texts(tokens).count(")")
    for token in tokens:
        depth += (token.text == "(") - (token.text == ")")
        if token.text == ";" and not (is_closed and depth > 0):
            lexemeses.append([])
        else:
            lexemeses[-1].append(token)
    return lexemeses


def without_setup(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line, without `SI|`."""
    return [
        instruction for instruction in instructions(tokens[len(setup_of(tokens)) :]) if instruction
    ]


def text_of(tokens: Sequence[Lexeme]) -> str:
    return "".join((token.space or "") + (token.source or token.text) for token in tokens).strip()
