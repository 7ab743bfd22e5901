"""Usage: how the instruction is written that nobody can read, where no row says more.

Takes what the grammar expected at a place, and adds what its words are about: the command that one
of them means, a sentence, a condition in words. A function for each code. Knows no row.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import dropwhile, pairwise, takewhile

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.spelling import nearest
from tiniscript.base.words import (
    ALIASES,
    BLOCK_ENDS,
    MOVES,
    QUESTION,
    SINCE,
    UNIT_OF,
    WAYS,
    WORDS,
    said_instead,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery import lines
from tiniscript.recovery.amounts import with_number
from tiniscript.recovery.meanings import (
    ASKING,
    DONE,
    LONG_S,
    MOST_POWER,
    Lexeme,
    Names,
    closed,
    concept_of,
    lexemes,
    plain,
    said_of,
    words_of,
)
from tiniscript.recovery.orders import block, condition_in, made_up, orders, written
from tiniscript.recovery.worded import worded
from tiniscript.recovery.writing import (
    instruction_at,
    laid_out,
    shortened,
    tokens_of,
    without_note,
)
from tiniscript.syntax.free_names import in_place_of
from tiniscript.syntax.lexer import NUMBER, QUOTES, WORD, Token, scan
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.outline import Failure

_DOTS = re.compile(
    r"(?i)\b(?P<head>(?P<word>IF|LOOP|WHILE)[ \t]*\([^()\n]*\)"
    r"|DEF[ \t]+(?P<name>\w+)(?:[ \t]*\([^()\n]*\))?)[\s;]*"
    r"(?P<here>(?:\.[ \t]*){2,}|\u2026)[ \t]*\n?[ \t]*(?P<end>END_?\w+|ELSE\w*)?"
)
_MANY_BELOW = 6  # instructions that an example takes into a block
_ENDS = re.compile(rf"\b{words_of('end')}")
_BREAK = re.compile(r"(?i)\b(IF[ \t]*\([^\n;]*\))[\s;]*(?P<here>BREAK)[\s;]*END_?IF\b")
_IS_BLOCK = re.compile(rf"(?i)(?:{'|'.join((*BLOCK_ENDS, 'END', 'ELSE'))})\b|END_")
_TOP = re.compile(r"(?i)\s*(?:TASK|DEF|WHEN)\b")
_WORD = re.compile(r"\w")
_MEMBER = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+(?=[ \t]*\()")
_CALL = re.compile(r"(\w{3,})\s*\([^()]*\w[^()]*\)")
_LONG_HEAD = 100  # characters of a DEF before the name of a value
_TAUGHT = re.compile(r"(?i)\bDEF\s+(\w+[ \t]*\([^()\n]*)?$")
_OWN = re.compile(r"(\w{3,})\s*(\(\s*(\d{0,3})\s*\))?")
_ANGLE = re.compile(r"\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)$")
_FOREVER_AFTER = re.compile(r"(?i)([FBLR])\s*\(([^(),]+),\s*FOREVER\s*\)(\s*UNTIL.*)?")
_TURNED = re.compile(r"(?im)\b[FBLR]\s*\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)(?!\s*UNTIL)")
_LONGEST = 120  # characters of a sentence that a message shows
_MANY = 30  # diagnostics of which more is said
_OF_NAMES = (codes.UNKNOWN_NAME, codes.USED_BEFORE_SET)
_DEF_END = re.compile(r"(?i)\bEND_?DEF\b")
_BEGINS = (";", "newline", "|")  # what an instruction begins after
_DEF_ENDS = ("END_DEF", "ENDDEF")
_WANTED = {"s": "seconds", "%": "percent", "Hz": "hertz"}  # by the unit of a value
_MOST_OF_END = 4  # words: `fin del bucle`
_NO_NAMES = ("leaves", "again", "filler", "same", "etc", "end")


def with_usage(diagnostics: Sequence[Diagnostic], source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is wrong with a text, in words that say how it is written."""
    text = _Text(source, kit)
    text.lacks_loop = [it.values["right"] for it in diagnostics if it.code is codes.NOT_OPEN] == [
        "LOOP"
    ]
    diagnostics = text.with_name(diagnostics)
    told: list[Diagnostic] = []
    for diagnostic in diagnostics[:_MANY]:
        say = _SAYS.get(diagnostic.code) if diagnostic.repair is None else None
        told.append((say(_Usage(text, diagnostic)) if say else None) or diagnostic)
    parts = [it for it in told if it.values.get("part")]
    if parts and any(diagnostic.code is codes.TASK_NOT_TOP for diagnostic in told):  # rather an IF
        part = {"part": parts[0].values["part"]}
        told = [it._replace(values={**it.values, **part}) for it in told if it not in parts]
    if any(
        "usage" in diagnostic.values for diagnostic in told if diagnostic.code is codes.OUT_OF_RANGE
    ):
        told += text.turned()
    return [
        diagnostic
        for diagnostic in (*told, *diagnostics[_MANY:])
        if not (diagnostic.code in _OF_NAMES and text.is_in_wrong_def(diagnostic, told))
    ]


class _Text:
    def __init__(self, source: Source, kit: Kit) -> None:
        self.source = source
        self.names = Names([*map(tokens_of, source.text.split("\n"))], kit)
        self.begun = "".join(re.findall(r"\A\s*(S[IB])\s*\|", source.text.upper()))
        self.lacks_loop = False  # an END_LOOP is left for a header

    def is_in_wrong_def(self, found: Diagnostic, told: Sequence[Diagnostic]) -> bool:
        """Whether a name is in the body of a DEF that names no values in its brackets."""
        starts = (it.span.end for it in told if it.code is codes.PARAMETER_NEEDS_NAME)
        start = max((it for it in starts if it <= found.span.start), default=-1)
        return start >= 0 and not _DEF_END.search(self.source.text, start, found.span.start)

    def turned(self) -> list[Diagnostic]:
        """Return moves with the power before the time, as another call of the text has them."""
        diagnostics: list[Diagnostic] = []
        for match in _TURNED.finditer(self.source.text):
            if LONG_S <= float(match[1]) <= MOST_POWER and 0 < float(match[2]) < LONG_S:
                fix = f"{match[0][0].upper()}({match[2]}, {match[1]})"
                values = {"time": match[1], "power": match[2], "fix": fix}
                diagnostics.append(Diagnostic(codes.SWAPPED, Span(*match.span()), values))
        return diagnostics

    def end_at(self, place: int) -> str:
        """Return the end of the innermost block that is open at a place, "" for none."""
        ends: list[str] = []
        for line in self.source.text[:place].split("\n"):
            for part in without_note(line)[0].split(";"):
                first = next((it.text for it in lexemes(part.rpartition("|")[2])), "")
                meant = {"FOREVER": "LOOP"}.get(self.names.meant(first), self.names.meant(first))
                if meant in BLOCK_ENDS:
                    ends.append(BLOCK_ENDS[meant])
                elif ends and (meant in BLOCK_ENDS.values() or said_of(first, "end")):
                    ends.pop()
        return "".join(ends[-1:])

    def with_name(self, found: Sequence[Diagnostic]) -> Sequence[Diagnostic]:
        """Return diagnostics in which the one DEF without a name has that of an unknown call."""
        nameless = [diagnostic for diagnostic in found if diagnostic.code is codes.DEF_NEEDS_NAME]
        unknown = (diagnostic for diagnostic in found if diagnostic.code is codes.UNKNOWN_WORD)
        wholes = ((it, self.source[instruction_at(it.span, self.source)]) for it in unknown)
        called = (it.values["found"] for it, whole in wholes if len(lexemes(whole)) == 1)
        name = next(called, "") if len(nameless) == 1 else ""
        if not name:
            return found
        own, end = nameless[0], nameless[0].span.end
        repair = Repair((Edit(Span(end, end), f" {name}"),), False)
        diagnostic = own._replace(values={"name": name}, repair=repair)
        return [
            diagnostic if each is own else each
            for each in found
            if each.values.get("found") != name
        ]


class _Usage:
    """A diagnostic, and the instruction around its place."""

    def __init__(self, text: _Text, found: Diagnostic) -> None:
        self.text = text
        self.source = text.source
        self.names = text.names
        self.found = found
        self.piece = instruction_at(found.span, text.source)
        self.is_first = found.span.start == self.piece.start
        self.after_it = text.source.text[found.span.end :]
        self.tokens = lexemes(self.source[self.piece])
        self.words = [token.text for token in self.tokens if token.kind is WORD]
        self.signs = [token.text for token in self.tokens]
        self.number = next((it.text for it in self.tokens[1:] if it.kind is NUMBER), "1")

    def around(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Return the match of a pattern whose part `here` begins at the place."""
        matches = pattern.finditer(self.source.text)
        return next((it for it in matches if it.start("here") == self.found.span.start), None)

    def adds(self, **values: str) -> Diagnostic:
        """Return the diagnostic with values beside its own."""
        return self.found._replace(values={**self.found.values, **values})

    def says(self, code: Code, **values: str) -> Diagnostic:
        """Return another diagnostic of the same place."""
        return Diagnostic(code, self.found.span, values)

    def offers(self, code: Code, fix: str, **values: str) -> Diagnostic:
        """Return one with what the instruction becomes, which is never made without asking."""
        repair = Repair((Edit(self.piece, fix),), False)
        return Diagnostic(code, self.piece, {"fix": fix, **values}, self.piece, repair)

    def translated(self, found: str, fix: str, is_longer: bool = False) -> Diagnostic:
        right = re.split("[(;]", fix)[0]
        found = next((it for it in self.signs if self.names.meant(it) == right != it), found)
        values = {"right": right, "usage": _usage(right), "takes": _usage(right) * is_longer}
        diagnostic = self.offers(codes.OTHER_LANGUAGE, fix, found=found, **values)
        return diagnostic._replace(span=self.found.span)

    def usage(self, word: str) -> str:
        """Return how an instruction is written: a block with its end, where the text has none."""
        if word in ASKING and (asked := self.question(word)):
            return asked
        if word in ("L", "R") and (angle := _ANGLE.search(self.source[self.piece])):
            if float(angle[1]) >= LONG_S:  # `turnLeft(90, 70)`: no seconds
                return f"{word}({angle[1]} DEG, {angle[2]})"
        is_ended = _ENDS.search(plain(self.source.text)) is not None
        if word not in BLOCK_ENDS or (is_ended and word != "LOOP"):
            return _usage(word)
        readings = lines.read(self.tokens, self.names) if word == "LOOP" else []  # else a guess
        is_head = bool(readings) and [item.kind for item in readings[0].items or ()] == ["open"]
        head = laid_out(readings[0].tokens).strip("; ") if is_head else _usage(word)
        return head if is_ended else f"{head}; ...; {BLOCK_ENDS[word]}"

    def question(self, word: str) -> str:
        """Return a header with the question that was written, without numbers that were not.

        Nothing where no number is asked for.
        """
        asked = self.asked(word)
        if not any(lexeme.kind is NUMBER for lexeme in asked):
            return ""
        said = laid_out(condition_in(asked, self.names))
        return f"{word}({said})" if said else WORDS[word].usage

    def asked(self, word: str) -> list[Lexeme]:
        """Return what stands after a header, up to what is done."""
        after = [*dropwhile(lambda it: self.names.meant(it.text) != word, self.tokens)][1:]
        begun = DONE - {"L", "R"}  # `pared a la derecha`
        meant = [_is_over(lexeme) or self.names.meant(lexeme.text) in begun for lexeme in after]
        return after[: [*meant, True].index(True)]

    def block(self) -> str:
        below = self.source.text[self.piece.end :].lstrip("; \t\r\n").upper()
        is_open = bool(re.match(r"SI ?NO\b|ELSE", below))
        return block(self.tokens, self.names, is_open)

    # -- words that are none of the language ----------------------------------------------------

    def unknown(self) -> Diagnostic | None:
        """A word that nobody knows, or that an instruction is said with."""
        if not self.is_first or self.found.values.get("near") or not self.tokens:
            return None
        first, sign = self.signs[0], "".join(self.signs[1:2])
        if said_of(first, "end") and len(self.words) == len(self.tokens) < _MOST_OF_END:
            named = next(
                (BLOCK_ENDS.get(self.names.meant(word), "") for word in self.words[1:]), ""
            )
            end = named or self.text.end_at(self.piece.start)
            said = self.source[self.piece]
            return self.offers(codes.END_ALONE, end, found=said, right=end) if end else None
        parted = re.findall("[A-Z]?[a-z]+", self.source[self.piece].split("(")[0])
        if len(parted) > 1 and any(self.is_button(plain(each)) for each in parted):
            return self.no_button()  # `onButtonPressed(…)`
        if parts := _MEMBER.match(self.source.text, self.found.span.start):  # `Serial.begin`
            thing, _, done = plain(parts[0]).rpartition(".")
            right = "" if said_of(thing, "device") else self.names.meant(done)  # `servo.write`
            usage = self.usage(right)
            values = {"right": right, "usage": usage} if self.names.takes(right) else {}
            code = codes.OTHER_LANGUAGE if values else codes.UNKNOWN_WORD
            return Diagnostic(code, Span(*parts.span()), {"found": parts[0], **values})
        if self.names.meant(first) == "SHOW" and {*self.signs} & {*QUOTES}:
            return self.says(codes.WORDS_SHOWN)
        if instead := said_instead(first):
            return self.adds(**instead)
        if not (self.names.meant(first) or said_of(first, "turn", "end", "short")):
            if self.signs == [first, self.number]:
                return self.offers(codes.OTHER_ASSIGNMENT, f"{first} = {sign}")
            if sign in ("++", "--", "+", "-"):
                fix = f"{first} = {first} {sign[0]} {self.number}"
                return self.offers(codes.OTHER_ASSIGNMENT, fix, found=sign)
        return self.sentence() or self.own_word()

    def sentence(self) -> Diagnostic | None:
        """Words that say an instruction, or several, or none."""
        words = self.words
        ordered = self.ordered()
        meant = next(iter(ordered), "")
        if told := self.orders(meant):
            return told
        said = (*words, "_".join(words[:2]))  # `turn on the led`, `u turn`
        if any(said_of(each, "on", "off") for each in said):
            return self.says(codes.SWITCH_WHAT)
        if any(map(self.is_button, words)) and self.signs[1:2] != ["("]:
            return self.no_button()
        endless = next((word for word in words if self.names.meant(word) == "FOREVER"), "")
        if endless and not meant:
            return self.translated(endless, "LOOP(FOREVER)")
        if any(said_of(word, "turn", "lap") for word in words):
            return self.turn(said, ordered)
        word = next(filter(self.names.meant, (*words[:1], meant)), "")
        concept = self.names.meant(word)
        is_order = concept in WORDS and WORDS[concept].role.begins and concept != "FOREVER"
        is_among = concept == "S" and {*ordered.values()} != {"S"}  # `ve para adelante`
        if is_order and concept != word and not is_among:
            if concept in ASKING and (diagnostic := self.asked_in_words(concept)):
                return diagnostic
            if len(self.tokens) == 1 and not WORDS[concept].arguments:
                return self.translated(word, concept)
            if not WORDS[concept].arguments and any(it.kind is NUMBER for it in self.tokens):
                return Diagnostic(codes.SEVERAL_ORDERS, self.piece)  # it alone would lose it
            return self.says(
                codes.OTHER_LANGUAGE, found=word, right=concept, usage=self.usage(concept)
            )
        text = self.source[self.piece]
        if len(words) < 2 or {*self.signs} & {*COMPARISONS, "(", "="} or len(text) > _LONGEST:
            return None
        if name := next((word for word in words if word in self.names.variables), ""):
            example = f"{name} = {name} + {self.number}"
            values = {"name": name, "example": example, "fix": ""}
            return Diagnostic(codes.PROSE, self.piece, values)
        return self.offers(codes.PROSE, f"// {text}")

    def turn(self, said: Sequence[str], ordered: dict[str, str]) -> Diagnostic:
        """A turn that says no way, or no number."""
        others = {its for word, its in ordered.items() if not said_of(word, "right")}
        if others - {"L", "R", "B", "S"}:
            return Diagnostic(codes.SEVERAL_ORDERS, self.piece)  # a turn alone would lose them
        way = next((it for it in map(self.names.meant, self.words) if it in ("L", "R")), "")
        degrees = {"half": "180", "whole": "360"}
        halves = (it for it in degrees if any(said_of(each, it) for each in said))
        angle = degrees.get(next(halves, ""), "")
        is_timed = any(said_of(word, "unit")[:1] not in ((), ("turns",)) for word in self.words)
        numbers = [token.text for token in self.tokens if token.kind is NUMBER]
        if len(numbers) == 1 and float(numbers[0]) >= LONG_S and not is_timed:
            angle = numbers[0]  # `SPIN 360`: no time, and no power
        turns = orders(self.tokens, self.names)
        values = laid_out(self.tokens[1:])
        is_call = all(float(number) <= MOST_POWER for number in numbers)
        side = {"L": "left", "R": "right"}.get(way, "")
        if angle and way and not is_timed:
            right = f"{way}({angle} DEG, 60)"
            return self.says(codes.WHICH_WAY, word=way, way=side, right=right)
        if angle and not is_timed:
            turned = f"({angle} DEG, 60)"
        elif len(turns) == 1 and turns[0].is_side_free and len(turns[0].samples) < 2:
            turned = turns[0].text[1:]
        elif not way and is_call and lines.is_right(lexemes(f"L{values}"), self.names):
            turned = values  # `VOLTA(2, 80)`
        else:
            return self.says(codes.WHICH_WAY, word=way, way=side, usage=_usage(way))
        return self.says(codes.WHICH_WAY, to_left=f"L{turned}", to_right=f"R{turned}")

    def orders(self, meant: str) -> Diagnostic | None:
        """Words that say a block, or orders, of which `meant` is a word; offered, never made."""
        if text := self.block():
            return self.translated(self.signs[0], text)
        said = orders(self.tokens, self.names) if meant else []
        if len(said) == 1 and not said[0].is_side_free:
            return self.translated(meant, said[0].text, bool(said[0].samples))
        if len(said) < 2:
            return None
        fix, example = written(said), made_up(said)
        if any(order.is_side_free for order in said):
            values = {"right": fix, "example": example, "fix": ""}  # right is no change
            return Diagnostic(codes.SEVERAL_ORDERS, self.piece, values)
        return self.offers(codes.SEVERAL_ORDERS, fix, example=example)

    def own_word(self) -> Diagnostic | None:
        """A word of the program's own that nothing teaches."""
        piece = plain(self.source[self.piece])
        match = _OWN.fullmatch(piece)
        if match is None:
            return self.with_values(piece)
        name, is_call, number = match.groups()
        if number and self.text.lacks_loop:
            return self.adds(near="LOOP")
        given = re.findall(rf"(?i)\b{name}\s*\(\s*(\d+)\s*\)", self.source.text)
        if number or len({*given}) > 1:
            return self.with_values(piece)  # seconds, or how often: who writes it knows
        if self.names.meant(name):
            return None  # a function of another language
        lone = re.findall(rf"(?im)(?:^|[;|])[ \t]*{name}[ \t]*(?=;|\r?$)", self.source.text)
        times = len(lone)
        if is_call or len(lone) > 1 or self.names.defs or said_of(name, "taught"):
            often = f"LOOP({times});{name};END_LOOP" if times > 1 else ""
            return self.says(codes.UNTAUGHT, name=name, often=often)
        return self.adds(own="" if said_of(name, *_NO_NAMES) else name)

    def with_values(self, piece: str) -> Diagnostic | None:
        """`SIDE(30, 60)`, where no DEF has this name."""
        match = _CALL.fullmatch(piece)
        if match is None or self.names.meant(match[1]) or said_of(match[1], *_NO_NAMES):
            return None
        return self.adds(taught=match[1])

    def forever(self) -> Diagnostic | None:
        """`F(50, FOREVER)`: FOREVER is a time, and goes first."""
        match = _FOREVER_AFTER.fullmatch(self.source[self.piece])
        if match is None:
            return None
        until = match[3] or f" UNTIL({WORDS['UNTIL'].arguments[0].sample})"
        return self.adds(fix=f"{match[1].upper()}(FOREVER, {match[2].strip()}){until}")

    def until(self) -> Diagnostic:
        match = re.match(r"\s*(\([^()\n]+\))", self.source.text[self.found.span.start + 5 :])
        return self.adds(example=f"F(2, 80) UNTIL{match[1]}" if match else "")

    def no_button(self) -> Diagnostic:
        """A button that nobody can ask for; a program may begin with the one that starts it."""
        asked = next((it.source for it in self.tokens if self.is_button(it.text)), "")
        begun = "SB|" if self.text.begun == "SB" else ""
        when = self.source[self.piece] if self.signs[:1] == ["WHEN"] and not begun else ""
        return self.says(codes.NO_BUTTON, begun=begun, asked=asked or "BUTTON", when=when)

    def is_button(self, word: str) -> bool:
        return "BUTTON" not in self.names.sensors and concept_of(word) == "BUTTON"

    def ordered(self) -> dict[str, str]:
        """Return the words of no program that mean an order, and which."""
        meant = {word: self.names.meant(word) for word in self.words if word not in WORDS}
        return {
            it: its for it, its in meant.items() if its in WORDS and WORDS[its].role.is_instruction
        }

    def brackets(self) -> Diagnostic:
        """A word without its values; alone it gets an example of them."""
        word = self.found.values["word"]
        if any(map(self.is_button, self.signs)):
            return self.no_button()
        if self.is_first and (said := self.orders(word)):
            if said.code is codes.SEVERAL_ORDERS:
                return said
            return self.adds(fix=said.values["fix"])._replace(place=self.piece, repair=said.repair)
        if word in ASKING and (diagnostic := self.asked_in_words(word)):
            return diagnostic
        is_alone = len(self.tokens) == 1 and word in WORDS and WORDS[word].arguments
        example = WORDS[word].example if is_alone else ""
        return self.adds(example=example, usage=self.usage(word))

    def condition(self) -> Diagnostic | None:
        """A condition in words, in the brackets of a header; or nothing in brackets."""
        if self.found.code is codes.MISSING_COMMA and (
            diagnostic := self.unit() or self.no_value()
        ):
            return diagnostic
        if self.signs[1:] == ["("] and self.signs[0] in WORDS:
            return self.adds(usage=self.usage(self.signs[0]))
        if (diagnostic := self.foreign() or self.amount()) is not None:
            return diagnostic
        if self.words[1:] and self.names.meant(self.signs[0]) == "SHOW":
            return self.says(codes.WORDS_SHOWN)
        before = lexemes(self.source[Span(self.piece.start, self.found.span.start)])
        heads = [self.names.meant(it.text) for it, sign in pairwise(before) if sign.text == "("]
        own = {*WORDS, *self.names.known.values} - {"SI"}
        if not heads or heads[-1] not in ASKING or {*self.words} <= own:
            return None
        return self.in_words(heads[-1])

    def asked_in_words(self, word: str) -> Diagnostic | None:
        """A question in words without brackets: `IF BRIGHT THEN STOP`."""
        said = worded(self.asked(word), self.names) or {}
        is_told = said.get("asked") or said.get("question")
        return self.says(codes.IN_WORDS, word=word, **said) if is_told else None

    def in_words(self, word: str) -> Diagnostic:
        """A question in words: what its words ask, else an example."""
        start = next(
            k for k, lexeme in enumerate(self.tokens) if self.names.meant(lexeme.text) == word
        )
        asked = self.tokens[start + 2 : closed(self.tokens, start + 1) - 1]
        sample = {"example": WORDS[word].arguments[0].sample, "question": ""}
        return self.says(codes.IN_WORDS, word=word, **(worded(asked, self.names) or sample))

    def name_in_words(self) -> Diagnostic | None:
        """A name that nobody knows, which asks something in words: DARK of `X > 5 OR DARK`."""
        before = lexemes(self.source[Span(self.piece.start, self.found.span.start)])
        heads = [one.text for one, after in pairwise(before) if after.text == "("]
        name = plain(self.source[self.found.span])
        if self.names.meant(name) == "FOREVER" and self.signs[:1] and self.signs[0] in MOVES:
            start, end = (place - self.piece.start for place in self.found.span)
            said = self.source[self.piece]
            endless = (
                f"{said[:start]}FOREVER{said[end:]} UNTIL({WORDS['UNTIL'].arguments[0].sample})"
            )
            return self.adds(near="", meant="FOREVER", endless=endless)
        is_asked = bool(said_of(name, "light", "ahead"))
        if not heads or heads[-1] not in ASKING or not is_asked or before[-1].text in COMPARISONS:
            return None
        diagnostic = self.in_words(heads[-1])
        return diagnostic if diagnostic.values.get("question") else None

    def unit(self) -> Diagnostic | None:
        """A unit after a calculation: `F(RANDOM(1, 3) sec, 50)`."""
        span = self.found.span
        unit = said_of(plain(self.source[span]), "unit")
        end = len(self.source.text[: span.start].rstrip())  # of the value
        if not unit or self.source.text[end - 1] != ")":
            return None
        fix = self.source[Span(self.piece.start, end)] + self.source[Span(span.end, self.piece.end)]
        diagnostic = self.offers(
            codes.UNIT, fix if unit == ("s", "1000") else "", found=self.source[span]
        )
        return diagnostic._replace(
            span=span, repair=diagnostic.repair if unit == ("s", "1000") else None
        )

    def no_value(self) -> Diagnostic | None:
        """A word after a number, which is no value: a unit of something else, or nothing."""
        span = self.found.span
        before = lexemes(self.source[Span(self.piece.start, span.start)])
        calls = [one.text for one, after in pairwise(before) if after.text == "("]
        word, found = WORDS.get("".join(calls[-1:])), plain(self.source[span])
        is_word = found.isidentifier() and found not in WORDS and not self.names.is_name(found)
        if word is None or not word.arguments or before[-1].kind is not NUMBER or not is_word:
            return None
        values = {"word": word.text, "usage": word.usage}
        at = min(sum(lexeme.text == "," for lexeme in before), len(word.arguments) - 1)
        if not (wanted := _WANTED.get(word.arguments[at].unit)):
            return None
        if unit := said_of(found, "unit"):
            number, way = before[-1].text, UNIT_OF.get(word.text, "")
            said = f"{number} {self.source[span]}"
            if unit[0] == word.arguments[at].unit:
                return self.says(codes.UNIT, found=said, fix="")
            if way and unit == (WAYS[way].unit, "1000"):
                return self.says(codes.UNIT, found=said, fix="", right=f"{number} {way}")
            name = word.arguments[at].name
            return self.says(codes.OTHER_UNIT, name=name, wanted=wanted, unit=found, **values)
        return self.says(codes.OTHER_CALL, fix="", extra=found, **values)

    def foreign(self) -> Diagnostic | None:
        """The values of a word that this robot does not have: whoever writes it wants the word."""
        word, start = "".join(self.words[:1]), self.piece.start
        is_call = self.signs[:2] == [word, "("]
        if not is_call or self.names.meant(word) or self.names.is_name(word):
            return None
        diagnostic = Diagnostic(codes.UNKNOWN_WORD, Span(start, start + len(word)), {"found": word})
        return _Usage(self.text, diagnostic).unknown() or diagnostic

    def setup(self) -> Diagnostic | None:
        """Another word before the bar: one that says the button, or looks like it."""
        word = self.found.values["found"]
        return self.adds(right="SB|") if word == "S8" or concept_of(word) == "BUTTON" else None

    def begins(self) -> Diagnostic:
        """`SI` in the midst of a program begins a condition, or the program once more."""
        word = self.source[self.found.span].upper()
        arm = self.names.meant("_".join(self.words[:2]))
        if arm == "ELSE" and len(self.tokens) == 2:  # `si no`
            found = self.source[self.piece]
            return self.offers(codes.OTHER_LANGUAGE, arm, found=found, right=arm, usage=arm)
        if word == "CHECK_CONNECTION":
            return self.says(codes.PING_ALONE)
        if word == "PING":
            return self.says(codes.SETUP_NEEDS_BAR, found=word, fix="PING|")
        is_bar = self.after_it.lstrip()[:1] == "|"
        if text := self.block():
            return self.offers(codes.SPANISH_IF, text)._replace(span=self.found.span)
        if word == "SI" and not is_bar:
            return self.asked_in_words("IF") or self.says(codes.SPANISH_IF)
        here = word + "|" * is_bar
        button = "SB" if word == "SB" else ""
        twice = here if word == self.text.begun == "SB" else ""
        return self.adds(found=here, button=button, pause="W(2)", here=here, twice=twice,
                         instead=self.text.begun)  # fmt: skip

    # -- blocks, signs and names ------------------------------------------------------------------

    def unended(self) -> Diagnostic:
        """A block without its end: where its indentation, or its line, says that it ends."""
        rows = self.source.text.splitlines()
        k = self.source.position(self.found.span.start)[0] - 1
        after = without_note(self.after_it[: len(rows[k])])[0]
        rest = [part.strip() for part in after.split("\n")[0].split(";") if _WORD.search(part)]
        below = [n for n in range(k + 1, len(rows)) if rows[n].strip()]
        if rest and k + 1 == len(rows):
            return self.adds(behind=rest[-1])
        if not below:
            return self.adds(head=self.source[self.found.span])
        depth = [len(row) - len(row.lstrip()) for row in rows]
        top = min((n for n in below if _TOP.match(rows[n])), default=0)  # which no block is around
        inside = [*takewhile(lambda n: n < top if top else depth[n] > depth[k], below)]
        if not inside:
            return self.found
        last = without_note(rows[inside[-1]])[0].strip(" \t;")
        return self.adds(line=str(inside[-1] + 1), last=last)

    def break_outside(self) -> Diagnostic | None:
        """A BREAK in an IF that no loop is around: what follows may be what is left out."""
        match = self.around(_BREAK)
        rest = _row(self.source.text[match.end() :]) if match else []
        if match is None or not rest:
            return None
        return self.adds(skipped=";".join((match[1], "S", "ELSE", *rest, BLOCK_ENDS["IF"])))

    def unopened_part(self) -> Diagnostic | None:
        """An ELSE in a WHEN."""
        before = self.source.text[: self.found.span.start]
        is_open = re.search(r"(?is)\bWHEN\b(?!.*\bEND_?WHEN\b)", before)
        return self.adds(part=self.found.values["found"]) if is_open else None

    def sign(self) -> Diagnostic | None:
        text, (start, end) = self.source.text, self.found.span
        sign = text[start:end]
        if sign in "\u00a1\u00bf" and len(self.words) > 1:
            return self.offers(codes.PROSE, f"// {self.source[self.piece]}")
        if right := concept_of(sign):
            return self.says(codes.OTHER_LANGUAGE, found=sign, right=right, usage=_usage(right))
        if sign in ".\u2026" and (diagnostic := self.dots()) is not None:
            return diagnostic
        if sign == "!" and text[end : end + 1] not in ("", "\n", " "):
            return self.says(codes.OTHER_SIGN, found="!", right="NOT")
        if re.fullmatch("[0-9]:[0-9]", around := text[start - 1 : end + 1]):
            return self.says(codes.BAD_NUMBER, found=around)
        if sign in ("{", "}"):
            return self.says(codes.BRACES, found=sign)
        if sign not in QUOTES:
            return None
        closed = re.compile(rf"[^\n]*?{sign}").match(text, end)
        span = Span(start, closed.end() if closed else end)
        if self.names.meant(self.signs[0]) == "SHOW":
            return Diagnostic(codes.WORDS_SHOWN, span)
        return Diagnostic(codes.QUOTE, span, {"found": sign})

    def dots(self) -> Diagnostic | None:
        """Dots for what goes inside a block, as the poster has them."""
        match = self.around(_DOTS)
        if match is None:
            return None
        head, end = match["head"], (match["end"] or "").upper()
        right = BLOCK_ENDS[(match["word"] or "DEF").upper()]
        values = {"head": head, "right": right, "out": "" if end else match["here"].strip()}
        called = (match["name"] or "").upper()
        rest = self.source.text[match.end() :] if end == right else ""
        below = _row(rest) or (_before_blocks(rest, called) if called else [])
        calls = [each for each in below if _calls(each, called)]
        if inside := [each for each in below if each not in calls]:
            values["example"] = "; ".join((head, *inside, right, *calls))
        return Diagnostic(codes.DOTS, Span(*match.span("here")), values)

    def name(self) -> Diagnostic:
        """A word of the language as a name: another one for it."""
        word, text, start = self.found.values["word"], self.source.text, self.found.span.start
        is_set = re.match(r"\s*=\s*([1-9]?)", self.after_it)
        is_taught = _TAUGHT.search(text[max(0, start - _LONG_HEAD) : start])
        right = in_place_of(text, word) if is_set or is_taught else ""
        near = nearest(word, self.names.variables - {word}) if is_set else None
        if right and (word in SINCE or not (near or (is_set and word == "TIME" and not is_set[1]))):
            return self.renamed(word, right, is_taught is not None)
        if is_set is None or word != "TIME":
            return self.adds(right=near or right)  # `ROUND = ROUNDS + 1`
        places = [match.start() for match in re.finditer(r"(?i)\bTIME\b", text)][1:]
        used = [str(self.source.position(place)[0]) for place in places]
        values = {"line" if len(used) == 1 else "lines": ", ".join(used)}
        return self.adds(**{"right" if is_set[1] else "clock": right}, **values)

    def renamed(self, word: str, right: str, is_def: bool) -> Diagnostic:
        """Another name in each place where a word is meant as one: S of `F(S, 80)`, not S alone."""
        tokens = scan(self.source.text).tokens
        places = range(len(tokens)) if word in SINCE else _meant_as_name(tokens, word, is_def)
        spans = [
            tokens[k].span for k in places
            if tokens[k].text == word and (k == 0 or tokens[k - 1].kind not in (NUMBER, ")"))
        ]  # fmt: skip
        rows = [str(self.source.position(span.start)[0]) for span in spans]
        others = list(dict.fromkeys(rows))[1:]
        repair = Repair(tuple(Edit(span, right) for span in spans), False)
        values = {
            "word": word, "since": SINCE.get(word, ""), "right": right, "line": "".join(others[:1]),
            "lines": ", ".join(others) if len(others) > 1 else "",
            "times": str(len(rows)) if len(rows) > 1 and not others else "",
        }  # fmt: skip
        return Diagnostic(codes.RESERVED, self.found.span, values, None, repair)

    def no_order(self) -> Diagnostic | None:
        is_note = self.source.text.startswith("/*", self.found.span.start)
        return self.says(codes.OTHER_NOTE, found="/*") if is_note else None

    def function(self) -> Diagnostic | None:
        name = self.found.values["found"]
        if name in self.names.sensors:
            return self.says(codes.NO_BRACKETS_HERE, word=name, right=name)
        return self.says(codes.NO_INPUT) if said_of(name, "input") else None

    def amount(self) -> Diagnostic | None:
        """Words that say how much, in the place of a number."""
        values = with_number(self.source.text, self.found.span)
        if not values or not self.source[self.found.span][:1].isalnum():
            return None
        start = self.source.text.index(values["amount"], self.piece.start)
        value = Span(start, start + len(values["amount"]))
        return Diagnostic(codes.UNKNOWN_NAME, value, {"found": values["amount"], **values})

    def behind(self) -> Diagnostic | None:
        """What begins no instruction comes after one: with a `;` between them it is as wrong."""
        span = Span(self.found.span.start, self.piece.end)
        right = lines.right(lexemes(self.source[span]), self.names)
        words = shortened(self.source[span])
        values = {"before": self.found.values["before"], "words": words, "order": words}
        is_none = isinstance(right, Failure) and right.at == 0
        return Diagnostic(codes.WORDS_AFTER, span, values) if is_none else None

    def letters(self) -> Diagnostic | None:
        """A name with letters that a name has not."""
        if (diagnostic := self.amount()) is not None:
            return diagnostic
        word = self.source[self.found.span]
        right = re.sub(r"^[^A-Za-z]+|\W", "", plain(word))
        concept = self.names.meant(right)
        if concept in WORDS or self.names.has(concept):
            usage = self.usage(concept)
            return self.says(codes.OTHER_LANGUAGE, found=right, right=concept, usage=usage)
        if self.after_it.lstrip(" ").startswith("("):
            return self.says(codes.UNKNOWN_WORD, found=word.upper(), near="")
        if self.is_first and (said_of(right, "filler") or self.is_button(right)):
            return _Usage(self.text, self.says(codes.UNKNOWN_WORD, found=right)).unknown()
        return self.adds(right=right if word.isupper() else right.capitalize()) if right else None


def _meant_as_name(tokens: Sequence[Token], word: str, is_def: bool) -> Iterator[int]:
    """Give the places where a word of the language is meant as the name of a DEF, or a variable.

    A DEF is called where its name stands alone, but not in its own body.
    """
    depth = 0
    is_inside = is_value = False
    for k, (before, token, after) in enumerate(
        zip([None, *tokens], tokens, tokens[1:], strict=False)
    ):
        depth += (token.kind == "(") - (token.kind == ")")
        is_begun = before is None or (not depth and before.kind in _BEGINS)
        is_value = not is_begun and (is_value or (token.kind == "=" and not depth))
        is_inside = (is_inside or token.text == "DEF") and token.text not in _DEF_ENDS
        if token.text != word:
            continue
        if not is_def:
            is_set = is_begun and after.kind == "="
            if is_set or ((depth or is_value) and after.kind != "("):
                yield k
        elif before is not None and before.text == "DEF":
            yield k
        elif is_begun and not is_inside:
            has_values = after.kind == "(" and not WORDS[word].arguments
            if has_values or after.kind in (*_BEGINS, "end"):
                yield k


def _is_over(token: Lexeme) -> bool:
    """Whether a question ends before a token."""
    return token.text in (":", "{", ",") or bool(said_of(token.text, "do"))


def _row(text: str) -> list[str]:
    """Return the instructions of a text, nothing where they are many, or a block is among them."""
    rows = (without_note(line)[0].split(";") for line in text.split("\n"))
    found = [each.strip() for row in rows for each in row if each.strip()]
    is_long = len(found) > _MANY_BELOW or any(map(_IS_BLOCK.match, found))
    return [] if is_long else found


def _before_blocks(text: str, name: str) -> list[str]:
    """Return the instructions before the first block of a text, and before a call of a name."""
    rows = (without_note(line)[0].split(";") for line in text.split("\n"))
    found = (each.strip() for row in rows for each in row if each.strip())
    inside = [*takewhile(lambda it: not _IS_BLOCK.match(it) and not _calls(it, name), found)]
    return inside if len(inside) <= _MANY_BELOW else []


def _calls(instruction: str, name: str) -> bool:
    return instruction.upper().partition("(")[0].strip() == name


def _usage(word: str) -> str:
    known = WORDS.get(ALIASES.get(word, word))
    is_asking = known is not None and [argument.name for argument in known.arguments] == [
        QUESTION.name
    ]
    return (known.example if is_asking else known.usage) if known else word


_SAYS: dict[Code, Callable[[_Usage], Diagnostic | None]] = {
    codes.UNKNOWN_WORD: _Usage.unknown,
    codes.MISSING_OPEN: _Usage.brackets,
    codes.MISSING_SEPARATOR: _Usage.behind,
    **dict.fromkeys(
        (codes.MISSING_COMMA, codes.MISSING_CLOSE, codes.MISSING_VALUE), _Usage.condition
    ),
    codes.SETUP_UNKNOWN: _Usage.setup,
    codes.SETUP_TWICE: _Usage.begins,
    codes.NEVER_ENDS: _Usage.unended,
    codes.BREAK_OUTSIDE: _Usage.break_outside,
    codes.NOT_OPEN: _Usage.unopened_part,
    codes.ODD_CHARACTER: _Usage.sign,
    codes.RESERVED: _Usage.name,
    codes.NOT_AN_INSTRUCTION: _Usage.no_order,
    codes.NO_FUNCTION: _Usage.function,
    codes.NO_BUTTON: _Usage.no_button,
    codes.UNTIL_ALONE: _Usage.until,
    codes.FOREVER_NOT_HERE: _Usage.forever,
    codes.BAD_NAME: _Usage.letters,
    codes.UNKNOWN_NAME: _Usage.name_in_words,
}
