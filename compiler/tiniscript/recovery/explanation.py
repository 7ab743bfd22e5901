"""Explanations: what was wrong with each line of a text, from the rewrites of its candidate.

Typed values and edits. Knows no sentence of any language.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from itertools import accumulate, pairwise
from typing import NamedTuple

from tiniscript.base.source import Edit, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code
from tiniscript.recovery.lines import BRACES, Step
from tiniscript.recovery.meanings import ENDED, SOME_END, Lexeme, lexemes, meant_by, said_of, texts
from tiniscript.recovery.search import Candidate, Change
from tiniscript.recovery.writing import in_one_line, laid_out, tokens_of, without_note
from tiniscript.syntax.lexer import NUMBER, WORD

_DEDUPED = (codes.BAD_NAME, codes.EMPTY_BRACKETS, codes.NAME_WITH_SPACE)
# Codes of what belongs to the beginning of its block, where something is wrong with that, too.
_OF_BLOCK = (codes.NEVER_ENDS, codes.END_ALONE, codes.END_SPLIT, codes.BRACES,
             codes.ASKED_BEHIND, codes.OTHER_LANGUAGE)  # fmt: skip
_SHOW_WHOLE = frozenset((
    codes.MISSING_SEPARATOR, codes.HEADER_SEPARATOR, codes.MISSING_OPEN, codes.MISSING_CLOSE,
    codes.END_SPLIT, codes.END_ALONE, codes.FOREVER_NOT_HERE, codes.SPANISH_IF,
    codes.BRACES, codes.OTHER_ASSIGNMENT, codes.ASKED_BEHIND, codes.GROUPED, codes.OTHER_LANGUAGE,
))  # fmt: skip
_OF_ARM = (codes.BRACES, codes.OTHER_LANGUAGE, codes.HEADER_SEPARATOR)
_OF_BLOCKS = frozenset((*BLOCK_ENDS, *ENDED, "ELSE", "ELSEIF", *BRACES))
_WORD, _WORD_BEFORE = re.compile(r"\w+"), re.compile(r"\w+\Z")
_BEHIND = re.compile(r"\W*\w+[\s;]+(\w+)")
_ARMS = ("ELSE", "ELSEIF")
_SIGNS = ("BEEP", "SHOW", "S", "STOP")


@dataclass
class Explanation:
    """What is told of a line: code and values. `is_sure`: nothing that it changes is a guess.

    `found` is written `right`; all of the instruction, where a sign is missing or too much.
    `word`, written as in `usage`, begins the instruction, and `before` stands before the slip;
    `fix` is what the instruction becomes. Where more of its block changes, that becomes `whole`,
    which ends with `ends`. The same is wrong in `line`, or in `lines`, too, or `times` in its own.
    `letter` stands in a number in the place of a digit; `takes` is the usage where `fix` has more
    numbers than were written.

    A block that begins with `word` and lacks its end, `right`, has `behind` on its own line, and
    line `line`, `last`, is its last one. With its end it is `whole`, nothing where that is long. Of
    `several` instructions the last one may as well be behind it: there `last` is empty.

    `place` is what `fix` stands for; `edits` are all that belong to it: ends, braces. It begins in
    change `first`, from 0; `last` is a change, and how many of its lines belong to it; `opened` are
    the changes in which blocks begin that it ends.
    """

    code: Code
    place: Span
    span: Span
    values: dict[str, str]
    edits: list[Edit]
    first: int
    last: tuple[int, int]
    opened: set[int] = field(default_factory=set)
    is_sure: bool = True


def explained(program: str, found: Candidate) -> list[Explanation]:
    """Return what is wrong with each line that a candidate changes, in the order of the text."""
    explainer = _Explainer(program, found)
    for k, change in enumerate(found.changes):
        explainer.tell(k, change)
    for each in explainer.out:
        explainer.complete(each)
    return explainer.out


@dataclass
class _Block:
    """A block that is open: what is told of its beginning, which is in change `first`.

    `inside` is the first word of each line of its last arm.
    """

    word: str
    first: int
    told: Explanation | None = None
    inside: list[str] = field(default_factory=list)


def _parts(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line; what is between two separators is one."""
    found: list[list[Lexeme]] = [[]]
    for token in tokens:
        if token.text == ";":
            found.append([])
        else:
            found[-1].append(token)
    return found


class _Change(NamedTuple):
    """What is told of an instruction, or of a line: `place` becomes `after` by these rewrites."""

    place: Span
    edit: Edit
    steps: Sequence[Step]
    before: Sequence[Lexeme]
    after: Sequence[Lexeme]


class _Explainer:
    def __init__(self, program: str, found: Candidate) -> None:
        self.program = program
        self.found = found
        self.changes = found.changes
        self.lines = program.split("\n")
        self.starts = [0, *accumulate(len(line) + 1 for line in self.lines)]
        self.out: list[Explanation] = []
        self.open: list[_Block] = []

    def complete(self, told: Explanation) -> None:
        if told.code is not codes.NEVER_ENDS:
            is_shown = self.found.is_whole and told.last > (told.first, 1)
            told.values["whole"] = self.whole(told.first, told.last) if is_shown else ""
        start, end = self.words(told.edits[0].span)
        while start < end and self.program[start] in "\r\n":
            start += 1
        told.span = Span(start, end)
        told.is_sure = self.is_sure(told)

    def is_sure(self, told: Explanation) -> bool:
        """Whether nothing that an explanation changes is a guess."""
        places = (place for each in told.edits for place in each.span)
        lines = {self.program.count("\n", 0, place) for place in places}
        touched = [each for each in self.changes if lines & {*range(each.first, each.last + 1)}]
        touched += [self.changes[k] for k in (told.first, *told.opened)]
        text = " ".join(f"{each.text} {self.lines[each.first]}" for each in touched)
        has_blocks = bool({*re.findall(r"\w+|[{}]", text.upper())} & _OF_BLOCKS)
        is_block_sure = self.found.has_sure_blocks or not has_blocks
        return is_block_sure and all(each.is_sure for each in touched)

    def words(self, span: Span) -> Span:
        """Return a span with all of the words that it begins and ends in."""
        start, end = span
        if start < end:
            line = self.program.rfind("\n", 0, start) + 1
            before = _WORD_BEFORE.search(self.program, line, start + 1)
            behind = _WORD.match(self.program, end - 1)
            start -= len(before[0]) - 1 if before else 0
            end += len(behind[0]) - 1 if behind else 0
        return Span(start, end)

    def whole(self, first: int, last: tuple[int, int]) -> str:
        """Return what changes become, as one line, nothing where that is long."""
        *others, text = (each.text for each in self.changes[first : last[0] + 1])
        return in_one_line("\n".join((*others, *text.split("\n")[: last[1]])))

    def tell(self, k: int, change: Change) -> None:
        old = "\n".join(self.lines[change.first : change.last + 1]).rstrip("\r")
        own, *ends = change.text.split("\n")
        around = self.open[-1] if self.open else None
        before, after = tokens_of(old), tokens_of(own)
        closed = self.walk(k, after)
        parts = [] if closed or "\n" in old else self.parts(k, old, own, before, after)
        for part in parts:
            self.new(k, part, *_code(part))
        if own != old and not parts:
            place = Span(self.starts[change.first], self.starts[change.first] + len(old))
            edit = trimmed(place.start, old, own)
            if ends and edit.span.start == place.end:
                edit = Edit(place, own)  # the ends that are missing behind it come behind all of it
            part = _Change(place, edit, self.changes[k].steps, before, after)
            code, step = _code(part)
            is_brace = code is codes.BRACES and before[0].text in BRACES
            is_arm = bool(after) and after[0].text in _ARMS
            is_more = code in (_OF_ARM if is_arm else _OF_BLOCK) and (closed or is_brace or is_arm)
            told = self.added(closed or around, edit, (k, 1), after) if is_more else None
            told = told or self.new(k, part, code, step)
            told.opened |= {closed.first} if closed else set()
            if code is codes.WRONG_END:
                right = told.values["right"]
                line = str(self.changes[closed.first if closed else k].first + 1)
                told.values |= {"word": ENDED.get(right, ""), "line": line, "fix": right}
            for block in self.open:
                if block.first == k or is_brace:
                    block.told = block.told or told
        line_end = "\r\n" if "\r" in self.program else "\n"
        for count, end in enumerate(ends, 2):
            self.end((k, count), change, end.strip(), line_end + end)

    def parts(
        self, k: int, old: str, own: str, before: Sequence[Lexeme], after: Sequence[Lexeme]
    ) -> list[_Change]:
        """Return the instructions of a line that change; nothing for one, or for others."""
        steps: dict[int, list[Step]] = {}
        for step in self.changes[k].steps:
            one, other = (_parts(each) for each in step[1:])
            if len(one) != len(other) or step.code is codes.ASKED_BEHIND:
                return []
            pairs = enumerate(zip(one, other, strict=True))
            n = next((n for n, (a, b) in pairs if texts(a) != texts(b)), len(one) - 1)
            steps.setdefault(n, []).append(Step(step.code, one[n], other[n]))
        was, now = _parts(before), _parts(after)
        notes = (without_note(each)[1] for each in (old, own))
        if len(was) != len(now) or len({*notes}) > 1 or {*texts(before)} & {*BRACES}:
            return []
        if _is_closed(before) and not all(map(_is_closed, was)):
            return []  # a separator is in brackets
        found = []
        first, end = self.starts[self.changes[k].first], 0
        for n, (part, meant) in enumerate(zip(was, now, strict=True)):
            text, new = _written(part), _written(meant)
            start = old.index(text, end)
            end = start + len(text)
            if text != new:
                place = Span(first + start, first + end)
                edit = trimmed(place.start, text, new)
                if edit.span.start == place.end:
                    edit = Edit(place, new)  # an end that is missing comes behind all of it
                found.append(_Change(place, edit, steps.get(n, []), part, meant))
                if not steps.get(n) and text.isascii():
                    return []
        return found if len(found) > 1 else []

    def walk(self, k: int, tokens: Sequence[Lexeme]) -> _Block | None:
        """Open and close blocks; return the first one that began in an earlier change."""
        closed = None
        if self.open and tokens:
            inside, head = self.open[-1].inside, tokens[0].text
            inside[:] = [] if head in _ARMS else [*inside, head]
        for token in tokens:
            if token.text in BLOCK_ENDS:
                self.open.append(_Block(token.text, k))
            elif token.text in ENDED and self.open:
                block = self.open.pop()
                closed = closed or (block if block.first < k else None)
                if block.told and block.told.last > (block.first, 1):
                    block.told.last = max(block.told.last, (k, 1))
        return closed

    def added(
        self, block: _Block | None, edit: Edit, last: tuple[int, int], after: Sequence[Lexeme]
    ) -> Explanation | None:
        """Make an edit part of what is told of the beginning of its block, None where too long."""
        told = block.told if block else None
        if block is None or told is None or told.code not in _SHOW_WHOLE:
            return None
        first = min(told.first, block.first)
        if not self.whole(first, last):
            return None
        told.edits.append(edit)
        told.first, told.last = first, max(told.last, last)
        ends = next((each.text for each in after if each.text in ENDED), "")
        told.values["ends"] = told.values["ends"] or ends
        return told

    def new(self, k: int, part: _Change, code: Code, step: Step | None) -> Explanation:
        place, edit, _, before, after = part
        values = _slip(code, step, before, after)
        if code is codes.OTHER_SIGN and values["right"] in ("SI", "SB"):
            values["fix"] = f"{values['right']}|"
        if code is codes.BRACES and before and not after:
            values["needless"] = values["found"]
        if code is codes.UNTIL_NOT_HERE:
            values["example"] = values["fix"]
        if code is codes.OTHER_NOTE:
            values["right"] = self.changes[k].text.strip()
        if code is codes.EXTRA_WORD and not step:
            behind = _BEHIND.match(self.program, self.words(edit.span).start)
            arm = behind[1].upper() if behind else ""
            if {arm, meant_by(arm)} & {*_ARMS}:
                values["early"] = values["found"]
        if code is codes.NEVER_ENDS:
            word = next((each for each in texts(after) if each in BLOCK_ENDS), "")
            end = BLOCK_ENDS.get(word) or next((it for it in texts(after) if it in ENDED), "")
            last = laid_out(_parted(before)[-1]) if word and _parted(before) else ""
            values = {"word": word or ENDED.get(end, ""), "right": end, "behind": last}
            above = next((it for it in self.changes[k - 1 :: -1] if it.text.strip()), None)
            if not word and k and above:  # its indentation says where it ends
                last = laid_out(tokens_of(above.text.split("\n")[0]))
                values |= {"line": str(above.last + 1), "last": last}
        if code in _DEDUPED:  # LIGHT_L and LIGHT_R
            same = (it for it in self.changes[k].steps if it.code is code)
            pairs = ((texts(it.before), texts(it.after)) for it in same)
            names = [each for was, now in pairs for each in now if each not in was]
            if values["right"] in names:
                values["right"] = ", ".join(dict.fromkeys(names))
        self.out.append(Explanation(code, place, place, values, [edit], k, (k, 1)))
        return self.out[-1]

    def end(self, last: tuple[int, int], change: Change, end: str, text: str) -> None:
        """Tell of an end that is missing behind a line."""
        block = self.open.pop() if self.open else None
        behind = self.starts[change.last] + len(self.lines[change.last].rstrip("\r"))
        edit = Edit(Span(behind, behind), text)
        if self.added(block, edit, last, lexemes(end)):
            return
        first, word = (block.first, block.word) if block else (last[0], "")
        behind_this = laid_out(tokens_of(change.text.split("\n")[0]))
        place = Span(self.starts[self.changes[first].first], behind)
        values = {"word": word, "right": end, "line": str(change.last + 1), "last": behind_this,
                  "whole": self.whole(first, last)}  # fmt: skip
        if block and self.may_end_earlier(block, last[0]):
            values |= {"several": behind_this, "last": "", "whole": ""} | self.early(block, last[0])
        if first < last[0]:
            values["begun"] = str(self.changes[first].first + 1)
        told = Explanation(codes.NEVER_ENDS, place, place, values, [edit], first, (first, 1))
        self.out.append(told)

    def early(self, block: _Block, last: int) -> dict[str, str]:
        """Return the line before the first header in a block: it may end there as well."""
        for k in range(block.first + 2, last + 1):
            words = texts(lexemes(self.changes[k].text))
            if words and words[0] in BLOCK_ENDS and self.changes[k - 1].text.strip():
                before = self.changes[k - 1]
                begins = laid_out(tokens_of(before.text.split("\n")[0]))
                return {"early": str(before.last + 1), "begins": begins}
        return {}

    def may_end_earlier(self, block: _Block, last: int) -> bool:
        """Whether nothing says that the last instruction of a block is in it.

        A sign or a stop behind others may as well come when a LOOP or a DEF is over.
        """
        inside = block.inside
        header, end = (self.changes[k].text.split("\n")[0] for k in (block.first, last))
        is_deeper = end[:1].isspace() > header[:1].isspace()
        is_endless = {*texts(lexemes(header))} & {"FOREVER", "TRUE"}
        if len(inside) < 2 or self.found.has_sure_blocks or is_deeper or is_endless:
            return False
        is_sign = inside[-1] in _SIGNS and inside[-1] not in inside[:-1]
        return is_sign or block.word not in ("LOOP", "DEF")


def _is_closed(tokens: Sequence[Lexeme]) -> bool:
    return texts(tokens).count("(") == texts(tokens).count(")")


def trimmed(start: int, old: str, new: str) -> Edit:
    """Return the edit of what differs."""
    head, tail = _alike(old, new)
    return Edit(Span(start + head, start + len(old) - tail), new[head : len(new) - tail])


def _alike(old: Sequence[object], new: Sequence[object]) -> tuple[int, int]:
    """Return how much two texts, or two lines, have alike at their beginning and at their end."""
    most = min(len(old), len(new))
    head = next((k for k in range(most) if old[k] != new[k]), most)
    most -= head
    return head, next((k for k in range(most) if old[-1 - k] != new[-1 - k]), most)


def _code(part: _Change) -> tuple[Code, Step | None]:
    """Return with which code a change is told, and the rewrite that it is told of."""
    _, _, steps, before, after = part
    words, new = set(texts(before)), set(texts(after))
    fewer, more = Counter(texts(before)) - Counter(texts(after)), new - words
    if "SI" in fewer and "IF" in more:
        return codes.SPANISH_IF, None
    dropped = {each for each in fewer if {each, meant_by(each)} & {*ENDED}}
    if dropped and not more and fewer.keys() <= dropped | {";"}:
        return codes.EXTRA_WORD, None
    if steps:
        own = [step for step in steps if step.code is not codes.OTHER_LANGUAGE]
        own.sort(key=lambda it: (it.code is not codes.ASKED_BEHIND, it.code is codes.OTHER_SIGN))
        if own and own[0].code in (codes.ASKED_BEHIND, codes.UNTIL_NOT_HERE):
            return own[0].code, own[0]
        lost = (each.text for each in before if each.kind is WORD and each.text not in new)
        foreign = next((each for each in lost if meant_by(each) in more), "")
        translated = next((it for it in steps if it.code is codes.OTHER_LANGUAGE), None)
        if translated and (foreign or not own):
            is_said = foreign or "(" in words or "(" not in new or before[0].text not in new
            return codes.OTHER_LANGUAGE if is_said else codes.MISSING_OPEN, translated
        if foreign:
            changed = (it for it in own if foreign in {*texts(it.before)} - {*texts(it.after)})
            return codes.OTHER_LANGUAGE, next(changed, own[0])
        right = _first_difference(own[0].before, own[0].after)[2]
        is_comma = own[0].code is codes.OTHER_CALL and texts(right) == (",",)
        return codes.MISSING_COMMA if is_comma else own[0].code, own[0]
    if words & {*BRACES}:
        return codes.BRACES, None
    source = "".join(each.source or "" for each in before)
    if not source.isascii():
        has_word = any(each.kind is WORD and not (each.source or "").isascii() for each in before)
        return codes.BAD_NAME if has_word else codes.OTHER_SIGN, None
    _, found, right = _first_difference(before, after)
    if len(found) == len(right) == 1 and {*texts(found), *texts(right)} <= {*ENDED}:
        return codes.WRONG_END, None
    ends = [each.text for each in before if said_of(each.text, "end")]
    if ends and ends[-1] not in new:
        is_end = bool(new & {*BLOCK_ENDS.values()})
        return codes.END_ALONE if is_end else codes.EXTRA_WORD, None
    return codes.NEVER_ENDS, None


def _slip(
    code: Code, step: Step | None, before: Sequence[Lexeme], after: Sequence[Lexeme]
) -> dict[str, str]:
    is_note = code is codes.OTHER_NOTE
    old, new = (step.before, step.after) if step and not is_note else (before, after)
    if "WHEN" in texts(after):  # what the steps took for an IF
        old, new = (
            [it._replace(text="WHEN") if it.text == "IF" else it for it in line]
            for line in (old, new)
        )
    start, found, right = _first_difference(old, new)
    if code is codes.OTHER_LANGUAGE and texts(found[-1:]) == (".",) and not right:
        found, right = old[start : start + len(found) + 1], new[start : start + 1]
    elif not right and code is codes.OTHER_LANGUAGE and start and old[start - 1].text != "|":
        found, right = [old[start - 1], *found], [old[start - 1]]
    elif code is codes.OTHER_LANGUAGE and texts(found[-1:]) == (".",):  # `bot.forward`
        found = old[start : start + len(found) + 1]
    elif not right and code is codes.BAD_NUMBER:
        found = old[start + len(found) - 1 : start + len(found) + 1]
    elif code is codes.UNIT:  # the first number that has one, and is changed
        pairs = ([*pair] for pair in pairwise(old[max(0, start - 1) :]) if pair[0].kind is NUMBER)
        units = (it for it in pairs if said_of(it[1].text, "unit") or it[1].text == "%")
        found = next(units, found)
    told, fix = _parted(before), _parted(after)
    head, tail = _alike([*map(texts, told)], [*map(texts, fix)])
    one = [each for part in told[head : len(told) - tail] for each in part]
    other = [each for part in fix[head : len(fix) - tail] for each in part]
    has_end = bool(head) and any(each.text in ENDED for each in other)
    shown = ";".join(laid_out(part) for part in fix[0 if has_end else head : len(fix) - tail])
    shown = shown or laid_out(after)
    if code is codes.OTHER_LANGUAGE:  # `FOR I = 1 TO`: FOR alone
        cut = next((k for k, it in enumerate(found) if it.text in ("=", "(")), len(found))
        is_set = cut < len(found) and found[cut].text == "="
        found = found[: cut - is_set] or found
        if right and found and all(said_of(each.text, "filler") for each in found):
            named = [each for each in old if meant_by(each.text) == right[0].text]
            found = named[:1] or found  # `oi robô, anda`
    if code is codes.QUESTION_BEHIND:
        found = [each for each in (*old, *new) if each.text in BLOCK_ENDS][:1] or found
    is_all = code is codes.REPEATED or (code is codes.OTHER_SIGN and not right)
    is_found = bool(found) or code is codes.OTHER_ASSIGNMENT  # else a sign is missing
    if code is codes.OTHER_ASSIGNMENT:  # `DISTÂNCIA := 5`: the sign alone
        found = [each for each in found if each.kind is not WORD] or found
    was = _written(one if is_all or not is_found else found)
    was = "_" if code is codes.LINE_NUMBER and was[:1] == "_" else was
    was = was.strip("; ") if code in (codes.OTHER_LANGUAGE, codes.EXTRA_WORD) else was
    if is_note:
        was = re.match(r"\w+|\W+", was).group().strip()  # type: ignore[union-attr]
    now = laid_out(right) or shown
    now = shown if now == SOME_END and shown in ENDED else now  # of a block, whose end is known
    if code is codes.OTHER_LANGUAGE:  # `I = 0;LOOP(5)`: LOOP alone
        heads = (part for part in now.split(";") if re.split(r"\W", part)[0] in _OF_BLOCKS)
        now = re.split("[()]", next(heads, now), maxsplit=1)[0]
        now = next((each for each in now.split() if each in WORDS), now)  # `va F`
        now = now if now in WORDS else meant_by(now) or now  # of `bot.forward`
    now = f"{now} )" if now.endswith("(") else now
    word = _word(code, old, new, start, other)
    word = f"DEF {word}" if code is codes.EMPTY_BRACKETS and "DEF" in texts(after) else word
    usage = WORDS[word].usage if word in WORDS else ""
    until = len(fix[head]) if len(told) < len(fix) else None  # one instruction became two
    kept = _written(one[: _alike(texts(one), texts(other[:until]))[0]])
    if code in (codes.MISSING_VALUE, codes.MISSING_SIGN) and not found and start:
        was, kept = _written(old[start : start + 1]), _written(old[start - 1 : start])
    if code is codes.HEADER_SEPARATOR and (not kept or lexemes(kept)[0].text not in _OF_BLOCKS):
        begun = (part for part in fix if part[0].text in _OF_BLOCKS)  # `F(2, 80) Y IF(…) S`
        kept = laid_out(next(begun)) if kept else other[0].text  # `CADA VEZ QUE DISTANCE < 15 S`
    letters = {each for each in was if each.isalpha()} - {*now} if len(was) == len(now) else set()
    letter = letters.pop() if len(letters) == 1 and code is codes.BAD_NUMBER else ""
    given, needed = (sum(each.kind is NUMBER for each in it) for it in (one, other))
    said = WORDS.get(now) if code is codes.OTHER_LANGUAGE else None  # `avanza 2 s 3 veces`: F
    takes = (said.usage if said and said.arguments else usage) if needed > given else ""
    return {"found": was, "right": now, "before": kept, "word": word, "usage": usage, "fix": shown,
            "ends": "", "letter": letter, "takes": takes}  # fmt: skip


def _word(
    code: Code, old: Sequence[Lexeme], new: Sequence[Lexeme], start: int, part: Sequence[Lexeme]
) -> str:
    """Return the word that is told of: the one before its brackets, else the first one."""
    if code is codes.EMPTY_BRACKETS and "(" in (behind := texts(old[start:]))[start == 0 :]:
        return old[start + behind.index("(") - 1].text
    if code is codes.GROUPED:
        if start and old[start - 1].text == ";":
            return ""
        return next((each.text for each in new if each.text in ("LOOP", "WHILE", "IF")), "")
    if code is codes.BAD_NAME:
        return old[start].text if start < len(old) and old[start].text in WORDS else ""
    if code in (codes.NO_VALUE, codes.NO_BRACKETS_HERE):
        part = old[start:]
    elif code is codes.MISSING_OPEN:
        for word, sign in pairwise(new):
            if sign.text == "(" and sign.source is None and word.kind is WORD:
                return word.text
    words = [each.text for each in part if each.kind is WORD]
    return next((each for each in words if each in WORDS), "".join(words[:1]))


def _first_difference(
    before: Sequence[Lexeme], after: Sequence[Lexeme]
) -> tuple[int, Sequence[Lexeme], Sequence[Lexeme]]:
    """Return where two lines differ first, and what stands there in each of them."""
    old = [each.text if (each.source or "").isascii() else each.source for each in before]
    matched = SequenceMatcher(None, old, texts(after), autojunk=False)
    for kind, start, end, begin, stop in matched.get_opcodes():
        if kind != "equal":
            return start, before[start:end], after[begin:stop]
    return 0, before, after


def _written(tokens: Sequence[Lexeme]) -> str:
    return "".join((each.space or "") + (each.source or each.text) for each in tokens).strip()


def _parted(tokens: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """Return the instructions of a line, without `SI|`."""
    has_setup = len(tokens) > 1 and tokens[1].text == "|" and tokens[0].text in ("SI", "SB")
    return [each for each in _parts(tokens[2:] if has_setup else tokens) if each]
