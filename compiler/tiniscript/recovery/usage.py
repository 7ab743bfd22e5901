"""Usage: how the instruction is written that nobody can read, where no row says more.

Takes what the grammar expected at a place, and adds what its words are about: the command that one
of them means, a sentence, a question in words. A function for each code. Knows no row.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, QUESTION, WORDS, nearest, said_instead
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery import lines
from tiniscript.recovery.amounts import with_number
from tiniscript.recovery.concepts import (
    CALLED,
    ENDED,
    Lexeme,
    Names,
    concept_of,
    lexemes,
    plain,
    said_of,
    words_of,
)
from tiniscript.recovery.orders import block, made_up, orders, written
from tiniscript.recovery.writing import laid_out, shortened, without_note
from tiniscript.syntax.free_names import in_place_of
from tiniscript.syntax.lexer import NUMBER, QUOTES, WORD
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.outline import Failure

_LAST_HEAD = re.compile(r"(?is)\b(IF|ELSEIF|WHILE|UNTIL)[ \t]*\((?!.*\b(?:IF|WHILE|UNTIL)\()")
_DOTS = re.compile(r"(?:\.[ \t]*){2,}|\u2026")
_BEFORE_DOTS = re.compile(r"(?i)\b((IF|LOOP|WHILE)[ \t]*\([^()\n]*\)|(DEF)[ \t]+(\w+))[\s;]*$")
_BEHIND_DOTS = re.compile(r"(?i)[ \t]*\n?[ \t]*(END_?\w+|ELSE\w*)?")
_MANY_BELOW = 6  # instructions that an example takes into a block
_ENDS = re.compile(rf"\b{words_of('end')}")
_IF_BEFORE = re.compile(r"(?i)\b(IF[ \t]*\([^\n;]*\))[\s;]*$")
_ENDIF_BEHIND = re.compile(r"(?i)[\s;]*END_?IF\b")
_IS_BLOCK = re.compile(rf"(?i)(?:{'|'.join((*BLOCK_ENDS, 'END', 'ELSE'))})\b|END_")
_WORD = re.compile(r"\w")
_MEMBER = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+(?=[ \t]*\()")
_SEPARATOR = re.compile(r"[;|{}]")
_MOST_TIMES = 20  # that a DEF is done
_LONGEST = 120  # characters of a sentence that a message shows
_MANY = 30  # diagnostics of which more is said
_PAUSE = "W(2)"
_OF_ENDS = (codes.NEVER_ENDS, codes.NOT_OPEN, codes.CALLS_ITSELF)
_NOT_TOP = (codes.TASK_NOT_TOP, codes.DEF_NOT_TOP)
_OF_ITS_WORD = (codes.UNKNOWN_WORD, codes.WHICH_WAY)  # whose units say nothing more
_NO_NAMES = ("leaves", "again", "filler", "same", "etc", "end")
_NO_VARIABLE = ("turn", "end", "short")
_NO_ORDER = ("value", "operator", "function", "setup", "forever")
_SIDES = (("left", "L"), ("right", "R"))


def with_usage(found: Sequence[Diagnostic], source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is wrong with a text, in words that say how it is written."""
    ends = [each.values["right"] for each in found if each.code is codes.NOT_OPEN]
    teller = _Usage(source, kit, ends[0] if len(ends) == 1 and ends[0] == "LOOP" else "")
    if any(each.code is codes.NEVER_ENDS for each in found):
        top = [each for each in found if each.code in _NOT_TOP]
        teller.at_top = [source.position(each.span.start)[0] - 1 for each in top]
        found = [each for each in found if each not in top]
    found = teller.with_name(found)
    told = [teller.told(each) for each in found[:_MANY]]
    near = {it.values.get("near", "").partition("(")[0] for it in told}
    is_near = bool(teller.unopened) and teller.unopened in near
    has_no_ends = is_near or any(it.code in (codes.BRACES, codes.DOTS) for it in told)
    reserved = {each.values["word"] for each in told if each.code is codes.RESERVED}
    unknown = {teller.piece(it.span) for it in told if it.code in _OF_ITS_WORD}
    part = next((it.values["part"] for it in told if it.values.get("part")), "")
    if part and any(each.code is codes.TASK_NOT_TOP for each in told):  # rather an IF
        told = [it._replace(values={**it.values, "part": part}) for it in told
                if not it.values.get("part")]  # fmt: skip
    kept = [
        each
        for each in (*told, *found[_MANY:])
        if (each.code is not codes.NO_VALUE or each.values.get("word") not in reserved)
        and (each.code is not codes.UNIT_PLACE or teller.piece(each.span) not in unknown)
    ]
    return [each for each in kept if not (has_no_ends and each.code in _OF_ENDS)]


class _Usage:
    def __init__(self, source: Source, kit: Kit, unopened: str) -> None:
        self.source = source
        self.kit = kit
        self.unopened = unopened  # a header that an end is left for
        self.at_top: list[int] = []  # lines of headers behind a block that lacks its end

    @cached_property
    def lines(self) -> list[str]:
        return self.source.text.splitlines() or [""]

    @cached_property
    def names(self) -> Names:
        bodies = (without_note(line)[0] for line in self.source.text.split("\n"))
        return Names([lexemes(body) for body in bodies], self.kit)

    def told(self, found: Diagnostic) -> Diagnostic:
        say = _SAYS.get(found.code)
        said = say(self, found) if say and found.repair is None else None
        return said or found

    def piece(self, span: Span) -> Span:
        """Return the instruction around a place: between the separators of its line."""
        text = self.source.text
        start = max(text.rfind("\n", 0, span.start), text.rfind("\r", 0, span.start)) + 1
        ends = [k for k in (text.find("\n", span.start), text.find("\r", span.start)) if k >= 0]
        line = text[start : min(ends, default=len(text))]
        body = without_note(line)[0]
        signs = [match.start() + start for match in _SEPARATOR.finditer(body)]
        begin = max((k + 1 for k in signs if k < span.start), default=start)
        end = min((k for k in signs if k >= span.start), default=start + len(body))
        begin += len(text[begin:end]) - len(text[begin:end].lstrip())
        return Span(begin, begin + len(text[begin:end].rstrip()))

    def tokens(self, span: Span) -> list[Lexeme]:
        return lexemes(self.source[span])

    def command(self, word: str) -> str:
        return self.names.meant(word)

    def with_name(self, found: Sequence[Diagnostic]) -> Sequence[Diagnostic]:
        """Return diagnostics in which the one DEF without a name has that of an unknown call."""
        nameless = [each for each in found if each.code is codes.DEF_NEEDS_NAME]
        if len(nameless) != 1:
            return found
        unknown = [each for each in found if each.code is codes.UNKNOWN_WORD
                   and len(self.tokens(self.piece(each.span))) == 1]  # fmt: skip
        if not unknown:
            return found
        name = unknown[0].values["found"]
        end = nameless[0].span.end
        repair = Repair((Edit(Span(end, end), f" {name}"),), False)
        said = nameless[0]._replace(values={"name": name}, repair=repair)
        left = (it for it in found if it not in unknown or it.values["found"] != name)
        return [said if each is nameless[0] else each for each in left]

    def usage(self, tokens: Sequence[Lexeme], word: str) -> str:
        """Return how an instruction is written: a block with its end, where the text has none."""
        if word not in BLOCK_ENDS or _ENDS.search(plain(self.source.text)):
            return _usage(word)
        found = lines.read(tokens, self.names) if word == "LOOP" else []  # else a guess
        items = (found[0].items or ()) if found else ()
        is_head = [each.kind for each in items] == ["open"]
        head = laid_out(found[0].tokens).strip("; ") if is_head else _usage(word)
        return f"{head}; ...; {BLOCK_ENDS[word]}"

    def block(self, piece: Span) -> str:
        below = self.source.text[piece.end :].lstrip("; \t\r\n").upper()
        is_open = bool(re.match(r"SI ?NO\b|ELSE", below))
        return block(self.tokens(piece), self.names, is_open)

    # -- words that are none of the language ----------------------------------------------------

    def unknown(self, found: Diagnostic) -> Diagnostic | None:
        """A word that nobody knows, or that an instruction is said with."""
        piece = self.piece(found.span)
        tokens = self.tokens(piece)
        if found.span.start != piece.start or found.values.get("near") or not tokens:
            return None
        words = [each.text for each in tokens if each.kind is WORD]
        first = tokens[0].text
        if parts := _MEMBER.match(self.source.text, found.span.start):  # `Serial.begin`
            right = self.command(plain(parts[0].rpartition(".")[2]))
            told = found._replace(span=Span(*parts.span()), values={"found": parts[0]})
            values = {**told.values, "right": right, "usage": _usage(right)}
            is_said = right in CALLED
            return told._replace(code=codes.OTHER_LANGUAGE, values=values) if is_said else told
        if instead := said_instead(first):
            return found._replace(values={**found.values, **instead})
        is_name = not (self.command(first) or any(said_of(first, it) for it in _NO_VARIABLE))
        if len(tokens) == 2 and tokens[1].kind is NUMBER and is_name:
            fix = f"{first} = {tokens[1].text}"
            said = self.offered(codes.OTHER_ASSIGNMENT, piece, fix)
            return said._replace(values={"fix": fix})
        if tokens[1:] and tokens[1].text in ("++", "--", "+", "-") and is_name:
            by = next((each.text for each in tokens[2:] if each.kind is NUMBER), "1")
            fix = f"{first} = {first} {tokens[1].text[0]} {by}"
            return self.offered(codes.OTHER_ASSIGNMENT, piece, fix)
        return self.sentence(found, piece, tokens, words) or self.own_word(found, tokens)

    def sentence(
        self, found: Diagnostic, piece: Span, tokens: list[Lexeme], words: list[str]
    ) -> Diagnostic | None:
        """Words that say an instruction, or several, or none."""
        meant = next((each for each in words if self._is_order(each)), "")
        if told := self.orders(found, piece, meant):
            return told
        said = (*words, "_".join(words[:2]))  # `turn on the led`, `u turn`
        if any(said_of(each, "on") or said_of(each, "off") for each in said):
            return Diagnostic(codes.SWITCH_WHAT, found.span)
        if any(map(self.is_button, words)) and [each.text for each in tokens[1:2]] != ["("]:
            return self.no_button(found)
        if any(said_of(each, "turn") or said_of(each, "lap") for each in words):
            others = {self.command(it) for it in words
                      if self._is_order(it) and not said_of(it, "right")}  # fmt: skip
            if others - {"L", "R", "B", "S"}:
                return Diagnostic(codes.SEVERAL_ORDERS, piece)  # a turn alone would lose them
            way = next(
                (self.command(each) for each in words if self.command(each) in ("L", "R")), ""
            )
            values = {"word": way, "way": "left" if way == "L" else "right", "usage": _usage(way)}
            angle = next((its for its in map(_angle, said) if its), "")
            is_timed = any(said_of(each, "unit") for each in words)
            turns = orders(tokens, self.names)
            if angle and not way and not is_timed:
                values = {f"to_{side}": f"{word}({angle} DEG, 60)" for side, word in _SIDES}
            elif len(turns) == 1 and turns[0].is_side_free and len(turns[0].samples) < 2:
                values = {f"to_{side}": word + turns[0].text[1:] for side, word in _SIDES}
            return Diagnostic(codes.WHICH_WAY, found.span, values)
        concept = self.command(words[0] if words else "") or (self.command(meant) if meant else "")
        is_order = concept in WORDS and WORDS[concept].role not in _NO_ORDER
        others = {self.command(each) for each in words if self._is_order(each)} - {concept}
        is_order = is_order and not (concept == "S" and others)  # `vaya para adelante`
        if is_order and concept not in words[:1]:
            named = words[0] if self.command(words[0]) else meant or words[0]
            if len(tokens) == 1 and not WORDS[concept].arguments:
                return self.translated(found.span, piece, named, concept)
            values = {"found": named, "right": concept, "usage": self.usage(tokens, concept)}
            return Diagnostic(codes.OTHER_LANGUAGE, found.span, values)
        signs = {each.text for each in tokens}
        if (
            len(words) < 2
            or signs & {*COMPARISONS, "(", "="}
            or len(piece_ := self.source[piece]) > _LONGEST
        ):
            return None
        if words[0] == "TSC":
            return Diagnostic(codes.PROSE, piece, {"command": piece_})
        if name := next((each for each in words if each in self.names.variables), ""):
            by = next((each.text for each in tokens if each.kind is NUMBER), "1")
            values = {"name": name, "example": f"{name} = {name} + {by}", "fix": ""}
            return Diagnostic(codes.PROSE, piece, values)
        return self.offered(codes.PROSE, piece, f"// {piece_}")

    def orders(self, found: Diagnostic, piece: Span, meant: str) -> Diagnostic | None:
        """Words that say a block, or orders, of which `meant` is a word; offered, never made."""
        tokens = self.tokens(piece)
        if text := self.block(piece):
            return self.translated(found.span, piece, tokens[0].text, text)
        said = orders(tokens, self.names) if meant else []
        if len(said) == 1 and not said[0].is_side_free:
            told = self.translated(found.span, piece, meant, said[0].text)
            takes = told.values["usage"] if said[0].samples else ""
            return told._replace(values={**told.values, "takes": takes})
        if len(said) < 2:
            return None
        told = self.offered(codes.SEVERAL_ORDERS, piece, written(said))
        values = {**told.values, "example": made_up(said)}
        if any(each.is_side_free for each in said):
            values |= {"right": values["fix"], "fix": ""}
            return told._replace(values=values, place=None, repair=None)
        return told._replace(values=values)

    def translated(self, span: Span, piece: Span, found: str, fix: str) -> Diagnostic:
        right = fix.partition("(")[0].partition(";")[0]
        words = [each.text for each in self.tokens(piece)]
        found = next((each for each in words if self.command(each) == right), found)
        values = {"found": found, "right": right, "fix": fix, "usage": _usage(right)}
        repair = Repair((Edit(piece, fix),), False)
        return Diagnostic(codes.OTHER_LANGUAGE, span, values, piece, repair)

    def offered(self, code: Code, piece: Span, fix: str) -> Diagnostic:
        repair = Repair((Edit(piece, fix),), False)
        found = (self.tokens(piece)[1:2] or self.tokens(piece))[0].text
        return Diagnostic(code, piece, {"found": found, "fix": fix}, piece, repair)

    def own_word(self, found: Diagnostic, tokens: list[Lexeme]) -> Diagnostic | None:
        """A word of the program's own that nothing teaches."""
        name, signs = tokens[0].text, [each.text for each in tokens[1:]]
        if [each.kind is NUMBER for each in tokens[1:]] == [False, True, False] and self.unopened:
            return found._replace(values={**found.values, "near": self.unopened})
        if len(name) < 3 or self.command(name) or (signs and signs[0] != "("):
            return None
        lone = re.findall(rf"(?im)(?:^|[;|])[ \t]*{name}[ \t]*(?=;|\r?$)", self.source.text)
        is_counted = len(signs) == 3 and signs[1].isdecimal() and len(signs[1]) < 4
        times = signs[1] if is_counted else str(len(lone))
        if signs not in ([], ["(", ")"]) and not (is_counted and 1 < int(times) <= _MOST_TIMES):
            return None  # a function of another language
        if signs or len(lone) > 1 or self.names.defs or said_of(name, "taught"):
            often = f"LOOP({times});{name};END_LOOP" if int(times) > 1 else ""
            return Diagnostic(codes.UNTAUGHT, found.span, {"name": name, "often": often})
        is_name = not any(said_of(name, kind) for kind in _NO_NAMES)
        return found._replace(values={**found.values, "own": name if is_name else ""})

    def until(self, found: Diagnostic) -> Diagnostic:
        asked = re.compile(r"(?i)UNTIL\s*(\([^()\n]+\))").match(self.source.text, found.span.start)
        example = f"F(2, 80) UNTIL{asked[1]}" if asked else ""
        return found._replace(values={**found.values, "example": example})

    def no_button(self, found: Diagnostic) -> Diagnostic:
        """A button that nobody can ask for; a program may begin with the one that starts it."""
        begun = re.match(r"(?i)\s*SB\s*\|", self.source.text)
        return Diagnostic(codes.NO_BUTTON, found.span, {"begun": "SB|"} if begun else {})

    def is_button(self, word: str) -> bool:
        is_missing = "BUTTON" not in self.names.sensors
        return is_missing and concept_of(word) == "BUTTON"

    def _is_order(self, word: str) -> bool:
        known = WORDS.get(self.command(word))
        return known is not None and known.is_instruction and word not in WORDS

    def brackets(self, found: Diagnostic) -> Diagnostic:
        """A word without its values; alone it gets an example of them."""
        piece, word = self.piece(found.span), found.values["word"]
        if any(self.is_button(each.text) for each in self.tokens(piece)):
            return self.no_button(found)
        said = self.orders(found, piece, word) if found.span.start == piece.start else None
        if said and said.code is codes.SEVERAL_ORDERS:
            return said
        if said:
            values = {**found.values, "fix": said.values["fix"], "example": ""}
            return found._replace(values=values, place=piece, repair=said.repair)
        known = WORDS.get(word)
        is_alone = len(self.tokens(piece)) == 1 and known is not None and bool(known.arguments)
        values = {**found.values, "example": known.example if known and is_alone else ""}
        if known:
            values["usage"] = self.usage(self.tokens(piece), word)
        return found._replace(values=values)

    def question(self, found: Diagnostic) -> Diagnostic | None:
        """A question in words, in the brackets of a header; or nothing in brackets."""
        text = self.source.text
        tokens = self.tokens(self.piece(found.span))
        if [each.text for each in tokens[1:]] == ["("] and tokens[0].text in WORDS:
            usage = self.usage(tokens[:1], tokens[0].text)
            return found._replace(values={**found.values, "usage": usage})
        if (said := self.foreign(found, tokens) or self.amount(found)) is not None:
            return said
        before = self.source[Span(self.piece(found.span).start, found.span.end)]
        head = _LAST_HEAD.search(before)
        end = text.find(")", found.span.start)
        is_in_words = any(each.kind is WORD for each in tokens[1:])
        if tokens and self.command(tokens[0].text) == "SHOW" and is_in_words:
            return Diagnostic(codes.WORDS_SHOWN, found.span)
        if head is None:
            return None
        start = self.piece(found.span).start + head.end()
        inner = self.tokens(Span(start, max(start, end)))
        if [each.kind for each in inner] == [WORD, NUMBER]:
            values = {"before": inner[0].text, "found": inner[1].text}
            return Diagnostic(codes.MISSING_SIGN, found.span, values)
        own = {*WORDS, *self.names.known.values}
        if all(each.kind is not WORD or each.text in own for each in inner):
            return None
        word = head[1].upper()
        values = {"word": word, "question": WORDS[word].arguments[0].sample}
        return Diagnostic(codes.IN_WORDS, found.span, values)

    def foreign(self, found: Diagnostic, tokens: list[Lexeme]) -> Diagnostic | None:
        """The values of a word that this robot does not have: whoever writes it wants the word."""
        called = [each.text for each in tokens[1:2]] == ["("] and tokens[0].kind is WORD
        word = tokens[0].text if called else ""
        known = self.names.known
        if not word or self.command(word) or word in known.instructions | known.actuators:
            return None
        start = self.piece(found.span).start
        told = Diagnostic(codes.UNKNOWN_WORD, Span(start, start + len(word)), {"found": word})
        return self.unknown(told) or told

    def setup(self, found: Diagnostic) -> Diagnostic | None:
        """Another word before the bar: one that says the button, or looks like it."""
        word = found.values["found"]
        is_button = word == "S8" or concept_of(word) == "BUTTON"
        return found._replace(values={**found.values, "right": "SB|"}) if is_button else None

    def begins(self, found: Diagnostic) -> Diagnostic:
        """`SI` in the midst of a program begins a question, or the program once more."""
        text, (_, end) = self.source.text, found.span
        word = self.source[found.span].upper()
        if word == "CHECK_CONNECTION":
            return Diagnostic(codes.PING_ALONE, found.span)
        if word == "PING":
            return Diagnostic(codes.SETUP_NEEDS_BAR, found.span, {"found": word, "fix": "PING|"})
        is_bar = text[end : end + 9].lstrip()[:1] == "|"
        piece = self.piece(found.span)
        if text_ := self.block(piece):
            return self.offered(codes.SPANISH_IF, piece, text_)._replace(span=found.span)
        if word == "SI" and not is_bar:
            return Diagnostic(codes.SPANISH_IF, found.span)
        first = re.match(r"\s*(S[IB])\s*\|", text, re.IGNORECASE)
        here = word + "|" * is_bar
        values = {"found": here}
        if word == "SB":
            values |= {"button": "SB", "pause": _PAUSE}
            is_twice = first is not None and first[1].upper() == "SB"
            values |= {"twice": here} if is_twice else {"here": here}
            values |= {"instead": "SI"} if first and not is_twice else {}
        return found._replace(values=values)

    # -- blocks, signs and names ------------------------------------------------------------------

    def unended(self, found: Diagnostic) -> Diagnostic:
        """A block without its end: where its indentation, or its line, says that it ends."""
        k = self.source.position(found.span.start)[0] - 1
        header = self.lines[k]
        behind = without_note(self.source[Span(found.span.end, found.span.end + len(header))])[0]
        rest = [each.strip() for each in behind.split("\n")[0].split(";") if _WORD.search(each)]
        depth = len(header) - len(header.lstrip())
        below = [n for n in range(k + 1, len(self.lines)) if self.lines[n].strip()]
        values = dict(found.values)
        if rest and k + 1 == len(self.lines):
            values |= {"behind": rest[-1]}
        elif not below:
            values |= {"head": self.source[found.span]}
        else:
            top = min((n for n in self.at_top if n > k), default=0)  # which no block is around
            inside = [n for n in below if n < top]
            for n in [] if top else below:
                if len(self.lines[n]) - len(self.lines[n].lstrip()) <= depth:
                    break
                inside.append(n)
            if inside:
                last = without_note(self.lines[inside[-1]])[0].strip(" \t;")
                values |= {"line": str(inside[-1] + 1), "last": last}
        return found._replace(values=values)

    def break_outside(self, found: Diagnostic) -> Diagnostic | None:
        """A BREAK in an IF that no loop is around: what follows may be what is left out."""
        head = _IF_BEFORE.search(self.source.text, 0, found.span.start)
        end = _ENDIF_BEHIND.match(self.source.text, found.span.end)
        if head is None or end is None:
            return None
        lines_ = [without_note(each)[0] for each in self.source.text[end.end() :].split("\n")]
        rest = [each.strip() for line in lines_ for each in line.split(";") if each.strip()]
        if not 0 < len(rest) <= _MANY_BELOW or any(_IS_BLOCK.match(each) for each in rest):
            return None
        skipped = ";".join((head[1], "S", "ELSE", *rest, BLOCK_ENDS["IF"]))
        return found._replace(values={**found.values, "skipped": skipped})

    def unopened_part(self, found: Diagnostic) -> Diagnostic | None:
        """An ELSE in a WHEN."""
        before = self.source.text[: found.span.start]
        whens = re.findall(r"(?i)\b(?:END_?)?WHEN\b", before)
        if whens and not whens[-1].upper().startswith("END"):
            return found._replace(values={**found.values, "part": found.values["found"]})
        return None

    def sign(self, found: Diagnostic) -> Diagnostic | None:
        sign, piece = self.source[found.span], self.piece(found.span)
        tokens = self.tokens(piece)
        if sign in "\u00a1\u00bf" and sum(each.kind is WORD for each in tokens) > 1:
            return self.offered(codes.PROSE, piece, f"// {self.source[piece]}")
        if sign in ".\u2026" and (said := self.dots(found)) is not None:
            return said
        if sign == "!" and self.source.text[found.span.end :][:1] not in ("", "\n", " "):
            return Diagnostic(codes.OTHER_SIGN, found.span, {"found": "!", "right": "NOT"})
        around = self.source.text[found.span.start - 1 : found.span.end + 1]
        if re.fullmatch("[0-9]:[0-9]", around):
            return Diagnostic(codes.BAD_NUMBER, found.span, {"found": around})
        if sign in ("{", "}"):
            return found._replace(code=codes.BRACES, values={"found": sign})
        if sign in QUOTES:
            end = self.source.text.find(sign, found.span.end)
            line_end = self.source.text.find("\n", found.span.end)
            is_closed = end >= 0 and (line_end < 0 or end < line_end)
            span = Span(found.span.start, end + 1) if is_closed else found.span
            if self.command(tokens[0].text) == "SHOW":
                return Diagnostic(codes.WORDS_SHOWN, span)
            return Diagnostic(codes.QUOTE, span, {"found": sign})
        return None

    def dots(self, found: Diagnostic) -> Diagnostic | None:
        """Dots for what goes inside a block, as the poster has them."""
        text = self.source.text
        dots = _DOTS.match(text, found.span.start)
        head = _BEFORE_DOTS.search(text, 0, found.span.start)
        if dots is None or head is None:
            return None
        right = BLOCK_ENDS[(head[2] or head[3]).upper()]
        behind = _BEHIND_DOTS.match(text, dots.end())
        end = behind[1].upper() if behind and behind[1] else ""
        values = {"head": head[1], "right": right}
        if not end:
            values["out"] = dots[0].strip()
        elif end == right and behind:
            below = [without_note(each)[0].strip("; ") for each in text[behind.end() :].split("\n")]
            below = [each for each in below if each]
            calls = [each for each in below if each.upper() == (head[4] or "").upper()]
            inside = [each for each in below if each not in calls]
            if 0 < len(inside) <= _MANY_BELOW and not any(_IS_BLOCK.match(each) for each in inside):
                values["example"] = "; ".join((head[1], *inside, right, *calls))
        return Diagnostic(codes.DOTS, Span(dots.start(), dots.end()), values)

    def name(self, found: Diagnostic) -> Diagnostic:
        """A word of the language as a name: another one for it."""
        word = found.values["word"]
        text = self.source.text
        is_set = re.match(r"\s*=\s*([1-9]?)", text[found.span.end :])
        is_taught = re.search(
            r"(?i)\bDEF\s+$", text[max(0, found.span.start - 9) : found.span.start]
        )
        right = in_place_of(text, word) if is_set or is_taught else ""
        if is_set and (near := nearest(word, self.names.variables - {word})):
            right = near  # `ROUND = ROUNDS + 1`
        gap = "clock" if is_set and word == "TIME" and not is_set[1] else "right"
        values = {**found.values, gap: right}
        if is_set and word == "TIME":
            used = [str(self.source.position(each.start())[0])
                    for each in re.finditer(r"(?i)\bTIME\b", text)][1:]  # fmt: skip
            values |= {"line": used[0]} if len(used) == 1 else {"lines": ", ".join(used)}
        return found._replace(values=values)

    def no_order(self, found: Diagnostic) -> Diagnostic | None:
        is_note = self.source.text.startswith("/*", found.span.start)
        return Diagnostic(codes.OTHER_NOTE, found.span, {"found": "/*"}) if is_note else None

    def function(self, found: Diagnostic) -> Diagnostic | None:
        name = found.values["found"]
        if name in self.names.sensors:
            return Diagnostic(codes.NO_BRACKETS_HERE, found.span, {"word": name, "right": name})
        return Diagnostic(codes.NO_INPUT, found.span) if said_of(name, "input") else None

    def amount(self, found: Diagnostic) -> Diagnostic | None:
        """Words that say how much, in the place of a number."""
        piece = self.piece(found.span)
        text = self.source.text
        start = 1 + max(text.rfind(sign, piece.start, found.span.start) for sign in "(,")
        ends = (text.find(sign, found.span.start, piece.end) for sign in ",)")
        end = min((each for each in ends if each >= 0), default=0)
        value = Span(start + text[start:end].startswith(" "), end)
        values = with_number(text, value)
        return Diagnostic(codes.UNKNOWN_NAME, value, values) if values else None

    def behind(self, found: Diagnostic) -> Diagnostic | None:
        """What begins no instruction comes behind one: with a `;` between them it is as wrong."""
        span = Span(found.span.start, self.piece(found.span).end)
        right = lines.right(self.tokens(span), self.names)
        words = shortened(self.source[span])
        values = {"before": found.values["before"], "words": words, "order": words}
        is_none = isinstance(right, Failure) and right.at == 0
        return Diagnostic(codes.WORDS_BEHIND, span, values) if is_none else None

    def letters(self, found: Diagnostic) -> Diagnostic | None:
        """A name with letters that a name has not."""
        if (said := self.amount(found)) is not None:
            return said
        right = re.sub(r"^[^A-Za-z]+|\W", "", plain(self.source[found.span]))
        concept = self.command(right)
        if concept in WORDS:
            values = {"found": right, "right": concept, "usage": _usage(concept)}
            return Diagnostic(codes.OTHER_LANGUAGE, found.span, values)
        word = self.source[found.span].upper()
        if self.source.text[found.span.end :].lstrip(" ").startswith("("):
            return Diagnostic(codes.UNKNOWN_WORD, found.span, {"found": word, "near": ""})
        is_order = self.piece(found.span).start == found.span.start
        if is_order and (said_of(right, "filler") or self.is_button(right)):
            return self.unknown(Diagnostic(codes.UNKNOWN_WORD, found.span, {"found": right}))
        values = {"right": right if self.source[found.span].isupper() else right.capitalize()}
        return found._replace(values=values) if right else None


def _angle(word: str) -> str:
    """Return the degrees of a half turn, or of a whole one."""
    return "180" if said_of(word, "half") else "360" if said_of(word, "whole") else ""


def _usage(word: str) -> str:
    word = BLOCK_ENDS.get(ENDED.get(word, ""), word) if word in ENDED else word
    known = WORDS.get(word)
    is_asking = known is not None and [each.name for each in known.arguments] == [QUESTION.name]
    return (known.example if is_asking else known.usage) if known else word


_SAYS: dict[Code, Callable[[_Usage, Diagnostic], Diagnostic | None]] = {
    codes.UNKNOWN_WORD: _Usage.unknown,
    codes.MISSING_OPEN: _Usage.brackets,
    codes.MISSING_SEPARATOR: _Usage.behind,
    codes.MISSING_COMMA: _Usage.question,
    codes.MISSING_CLOSE: _Usage.question,
    codes.MISSING_VALUE: _Usage.question,
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
    codes.BAD_NAME: _Usage.letters,
}
