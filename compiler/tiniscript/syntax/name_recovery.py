"""Recovery of instructions that begin with a name, or with a word of another language.

Knows what people write behind a name: values without brackets, other signs for `=`, a word that
is too much.
"""

from __future__ import annotations

from itertools import takewhile
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.assignment_recovery import AssignmentRecovery
from tiniscript.syntax.ast import Assign
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import Blocks
from tiniscript.syntax.bracket_recovery import BracketRecovery
from tiniscript.syntax.call_suggestions import (
    call_in,
    glued_call,
    written,
)
from tiniscript.syntax.clause_recovery import ClauseRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.devices import actuator_word
from tiniscript.syntax.foreign import Grammar, foreign_word
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import COMPARISONS, SIGNS
from tiniscript.syntax.phrases import (
    AFTER_HEADER,
    BEFORE_CALL,
    BEFORE_DEF,
    BEFORE_NAME,
    BEFORE_NOTE,
    BEFORE_SENTENCE,
    CHANGING,
    COUNTING,
    FRAME_WORDS,
    IMPORTING,
    NO_VARIABLES,
    SETTING,
    TIMES,
    TITLES,
)
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.sentence_recovery import SentenceRecovery
from tiniscript.syntax.suggestions import (
    body_begins,
    foreign_block,
    is_assignment,
    is_counting,
    shortened,
    spaced_name,
    update,
)
from tiniscript.syntax.talk_recovery import TalkRecovery
from tiniscript.words import (
    TURN_WORDS,
    WORDS,
    meant_by,
    usage_of,
)


class NameRecovery:
    def __init__(
        self,
        cursor: Cursor,
        reporter: Reporter,
        blocks: Blocks,
        kit: Kit | None,
        in_block: BlockRecovery,
    ) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks
        self.kit = kit
        self.in_block = in_block
        self.sentence = SentenceRecovery(cursor, reporter, in_block)
        self.of_value = AssignmentRecovery(cursor, reporter, in_block.known, self.unread_assignment)
        self.talk = TalkRecovery(cursor, reporter, in_block)
        self.clauses = ClauseRecovery(cursor, reporter, in_block)
        self.brackets = BracketRecovery(cursor, reporter, in_block, self.sentence, self.clauses)

    def reserved_name(self, name: Token) -> None:
        """`S = 5`; but `F = 2, 80` is F without brackets."""
        cursor = self.cursor
        word, start = WORDS[name.text], cursor.i + 2
        end = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start:end]
        if len(word.arguments) > 1 and any(token.kind == "," for token in rest):
            span = Span(name.start, rest[-1].end)
            cursor.i = end
            fix = call_in(word, rest)
            self.reporter.fail(codes.MISSING_OPEN, span, word=name.text, fix=fix, usage=word.usage)
        if name.text == "LOOP" and len(rest) == 1 and rest[0].kind is NUMBER:
            cursor.i = end
            place = cursor.span_from(name)
            fix = f"LOOP({rest[0].text})"
            self.reporter.report(codes.MISSING_OPEN, place, word="LOOP", fix=fix, usage=word.usage)
            self.in_block.begin_reported("LOOP", place)
            self.in_block.go_on()
        self.reporter.reserved_words.add(name.text)
        everywhere = self.in_block.known.lines_of(name.text, self.cursor.source)
        right = "@MY_TIME" if name.text == "TIME" else cursor.free_name(name.text)
        self.reporter.report(
            codes.RESERVED, name.span, word=name.text, right=right, everywhere=everywhere
        )

    def unread_assignment(self, name: Token) -> None:
        """Remember that a variable is set here, to a value that cannot be read."""
        if name.text not in WORDS:
            self.blocks.here.append(Assign(name.text, name.span, None, name.span))

    def unknown_word(self, parser: Grammar, word: Token, following: Token) -> None:
        """Report what no name of a program can be; a name alone may be one of its DEFs."""
        kind = following.kind
        is_alone = kind in AT_END
        if kind == "|":
            self.reporter.fail(codes.SETUP_TWICE, word.span, found=word.text)
        parser.recovery.of_end.with_a_sign(word, following)
        if is_alone:
            parser.recovery.of_end.with_its_name(word)
        after = self.cursor.tokens[min(self.cursor.i + 2, len(self.cursor.tokens) - 1)]
        is_title = word.text in TITLES and after.kind in AT_END
        if (is_title or word.text in IMPORTING) and (
            kind is WORD and not self.in_block.known.is_own(word.text)
        ):
            self.cursor.skip_line()
            span = Span(word.start, self.cursor.last.end)
            shown = shortened(self.cursor.source[span])
            self.reporter.fail(codes.EXTRA_WORD, span, found=word.text, label=shown)
        self.talk.label(word, following, after)
        if self.kit is not None:
            self.clauses.several(self.cursor.i)
        if word.text in AFTER_HEADER:
            self.in_block.other.around(word)  # `hacer F(1, 50) 3 veces`
        is_own = self.in_block.is_name(word.text)
        if kind is NUMBER and after.text in TIMES and meant_by(word.text) is None and not is_own:
            foreign_word(parser, word, "LOOP")  # `hacer 4 veces`
        if word.text == "SIEMPRE" and following.text == "QUE":  # no loop without end
            whenever = Token(WORD, "SIEMPRE QUE", word.start, following.end)
            self.cursor.tokens[self.cursor.i : self.cursor.i + 2] = [whenever]
            foreign_word(parser, whenever, "IF")
        if word.text == "PARA" and following.text == "CADA":
            foreign_word(parser, word, "LOOP")
        if word.text in FRAME_WORDS:
            parser.recovery.construct.frame(word)
            if (
                kind is WORD
                and after.kind == "("
                and meant_by(f"{word.text}_{following.text}") is None
            ):
                foreign_word(parser, word, "DEF")  # `void turn() {`
        if word.text in COUNTING and is_counting(self.cursor.tokens, self.cursor.i + 1):
            foreign_word(parser, word, "LOOP")
        if kind is WORD and word.text in ("WHEN", "CUANDO", "AL"):
            self.sentence.event(word)
        if word.text in SETTING or word.text in CHANGING:
            self.sentence.assigned(word)
        if word.text == "DE" and self._is_contrary(word):
            foreign_word(parser, self.cursor.token, "ELSE")
        said = WORDS.get(meant_by(word.text) or "")
        if following.text == "UNTIL" and said is not None and said.role in ("move", "wait"):
            self.sentence.until_question(word, said)
        if self.kit is not None and not self.in_block.known.is_own(word.text):
            self.sentence.turn_by_angle(word, following)
            if kind is WORD:
                if word.text in ("NO", "NUNCA", "PARA", "DEJA", "TERMINA"):
                    self.talk.not_to_move(word)
                self.talk.one_motor(word)
            self._before_sentence(word, following)
            self.talk.prose(self.cursor.i)
        if not is_alone and kind != "(":
            self._what_follows_a_name(word, following)
        if self.kit is not None and not self.in_block.is_name(word.text):
            self.sentence.move_in_a_sentence(word)
        if self.kit is not None or (word.text == "END" and is_alone):
            meant = foreign_block(word.text)
            if meant is not None and not self.in_block.is_name(word.text):
                foreign_word(parser, word, meant)
        if self.kit is not None:
            if kind is NUMBER or kind is WORD:
                self._actuator_without_brackets(word, self.kit)
            if kind is WORD and following.text != "UNTIL":
                if not self.in_block.is_name(word.text):
                    self.sentence.two_words(word, following)

    def _before_sentence(self, word: Token, following: Token) -> None:
        """`Luego gira a la derecha`, `Primero, avanza`: a word that says only when."""
        cursor = self.cursor
        if word.text not in BEFORE_SENTENCE or following.kind not in (WORD, ","):
            return
        cursor.i += 1 + (following.kind == ",")
        while cursor.token.text in BEFORE_SENTENCE and cursor.following.kind is WORD:
            self.reporter.answer(cursor.token)  # `después`
            cursor.i += 1
        span = cursor.span_from(word)
        words = cursor.source[span].strip(" ,").upper()
        self.reporter.report(codes.EXTRA_WORD, span, found=words, label=words)
        raise Resumed

    def _is_contrary(self, word: Token) -> bool:
        """`DE LO CONTRARIO`: then go to its last word."""
        cursor = self.cursor
        texts = [each.text for each in cursor.tokens[cursor.i + 1 : cursor.i + 3]]
        if texts != ["LO", "CONTRARIO"]:
            return False
        cursor.i += 2
        cursor.tokens[cursor.i] = Token(WORD, "DE_LO_CONTRARIO", word.start, cursor.token.end)
        return True

    def _what_follows_a_name(self, word: Token, following: Token) -> None:
        cursor, kind = self.cursor, following.kind
        self.sentence.word_and_sign(word, following)
        own = cursor.free_name(word.text) if word.text in WORDS else word.text
        changed = update(own, cursor.tokens, cursor.i + 1)
        if changed is not None:
            fix, found = changed
            self.reporter.answer(following)
            self.unread_assignment(word)
            cursor.skip_instruction()
            place = cursor.span_from(word)
            self.reporter.fail(codes.OTHER_ASSIGNMENT, word.span, place, found=found, fix=fix)
        if kind is WORD:
            self._word_before(word, following)
        if word.text in BEFORE_NOTE and (kind is WORD or kind is ODD):
            self.other_note(word.start, word.text, word.end)
        if kind == "-":
            self._arrow(word)
            self._call_with_hyphen(word)
            self.of_value.hyphened(word)
        if kind in SIGNS and not (kind == "*" and self.in_block.known.is_def(word.text)):
            self.not_an_instruction(word)
        if kind == ",":
            self.of_value.several_at_once(word)
        if kind is NUMBER or kind == ",":
            self._values_without_brackets(word, following)

    def _word_before(self, word: Token, following: Token) -> None:
        """`LET X = 5`, `CALL DANCE`, `MY SPEED = 5`: go on with what is right."""
        cursor, start = self.cursor, self.cursor.i
        fix, names = "", (word.text in BEFORE_NAME) + (following.text in BEFORE_NAME)
        if names > 1 and cursor.tokens[start + 2].kind is WORD:  # `const int X = 5`
            start = cursor.i = start + 1
            word, following = Token(WORD, word.text, word.start, following.end), cursor.following
        name = spaced_name(cursor.tokens, start)
        if name is not None and word.text not in BEFORE_NAME:
            text, end = name
            span = Span(word.start, cursor.tokens[end - 1].end)
            self.reporter.report(codes.NAME_WITH_SPACE, span, found=cursor.source[span], right=text)
            self.unread_assignment(Token(WORD, text, *span))
            raise Failed
        if word.text in BEFORE_NAME and is_assignment(cursor.tokens, start + 1):
            end = body_begins(cursor.tokens, start + 3, names_end=False)
            value = written(cursor.tokens[start + 3 : min(end, start + 40)])
            fix = f"{following.text} = {value}"
        elif word.text in BEFORE_NAME and cursor.tokens[start + 2].kind in AT_END:
            cursor.i += 2
            fix = f"{following.text} = 0"  # `VAR X`: the first value makes a variable
            place = cursor.span_from(word)
            self.unread_assignment(following)
            self.reporter.fail(codes.EXTRA_WORD, word.span, place, found=word.text, fix=fix)
        elif word.text in BEFORE_CALL or (
            word.text in BEFORE_DEF and self.in_block.known.is_def(following.text)
        ):
            fix = following.text
        if fix:
            self.reporter.report(codes.EXTRA_WORD, word.span, found=word.text, fix=fix)
            cursor.i += 1
            raise Resumed

    def _arrow(self, word: Token) -> None:
        """`robot->avanzar(2)` is `robot.avanzar(2)`."""
        tokens, k = self.cursor.tokens, self.cursor.i
        if tokens[k + 2].kind == ">" and tokens[k + 3].kind is WORD:
            point = Token(ODD, ".", tokens[k + 1].start, tokens[k + 2].end)
            tokens[k + 1 : k + 3] = [point]
            self.sentence.word_and_sign(word, point)

    def _call_with_hyphen(self, word: Token) -> None:
        """`PASO-UNO`, where there is a `DEF PASO-UNO`."""
        cursor = self.cursor
        second = cursor.tokens[cursor.i + 2]
        whole = f"{word.text}_{second.text}"
        if self.in_block.is_name(whole):
            span = Span(word.start, second.end)
            found = cursor.source[span]
            self.reporter.fail(codes.NAME_WITH_SPACE, span, found=found, right=whole)

    def _values_without_brackets(self, word: Token, following: Token) -> None:
        """`F2, 80`, `FORWARD 2 80`, `SPEED 50`."""
        cursor, start = self.cursor, self.cursor.i + 1
        if following.kind == "," and cursor.tokens[start + 1].kind is NUMBER:
            start += 1  # `atras, 2, 50`
            following = cursor.tokens[start]
        end = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start:end]
        if not rest:
            return
        is_new = (
            word.text not in NO_VARIABLES
            and meant_by(word.text) in (None, "TIME")
            and not self.in_block.is_name(word.text)
        )
        if is_new and len(rest) == 1 and glued_call(word.text) is None:
            span = Span(word.start, following.end)
            fix = f"{word.text} = {following.text}"
            self.reporter.report(codes.MISSING_EQUALS, span, fix=fix)
            self.unread_assignment(word)
            raise Failed
        span = Span(word.start, rest[-1].end)
        is_taught = self.in_block.is_name(word.text)  # `DEF B1`
        glued = None if is_taught else glued_call(word.text, rest)
        if glued is not None:
            cursor.i = end
            name = word.text.rstrip("0123456789")
            self.reporter.fail(codes.MISSING_OPEN, span, word=name, fix=glued, usage=usage_of(name))
        meant = WORDS.get(meant_by(word.text) or "")
        if meant is not None and following.kind is NUMBER and meant.is_instruction:
            cursor.i = end
            self.sentence.say_in_other_words(word.span, word.text, meant, rest)

    def _actuator_without_brackets(self, word: Token, kit: Kit) -> None:
        """`LED ON`, `GRIPPER 90`."""
        device = next((each for each in kit.actuators if each.name == word.text), None)
        if device is not None:
            self.cursor.i += 1
            self.brackets.no_bracket(word, actuator_word(device))

    def is_said_elsewhere(self, word: Token) -> bool:
        """Whether `word` is a command of another language, as in `PARAR()`."""
        meant = self.in_block.known.command(word.text)
        return meant is not None and not self.in_block.is_name(word.text)

    # -- what is no instruction ---------------------------------------------------------------

    def not_an_instruction(self, first: Token) -> NoReturn:
        """`DISTANCE < 10` alone: suggest the question."""
        tokens, start = self.cursor.tokens, self.cursor.i
        tokens = tokens[start : body_begins(tokens, start, names_end=False)]
        is_variable = self.in_block.known.is_own(first.text) or meant_by(first.text) is None
        if is_variable and first.text not in WORDS and not self.in_block.is_name(first.text):
            self.of_value.changed(first, tokens)
        asks = any(token.kind in COMPARISONS or token.text == "NOT" for token in tokens)
        if asks:
            self.in_block.other.choice(first)
        if first.text == "TIME" and [token.kind for token in tokens[1:]] == ["(", NUMBER, ")"]:
            whole, fix = Span(first.start, tokens[-1].end), f"W({tokens[2].text})"
            self.reporter.fail(codes.NOT_AN_INSTRUCTION, first.span, whole, found="TIME", fix=fix)
        self.reporter.fail(codes.NOT_AN_INSTRUCTION, first.span, found=first.text, fix="")

    def note_behind(self, first: Token, token: Token, after: Token) -> None:
        """`F(2, 80) -- go`, `F(2, 80) - avanza`, `F(2, 80) / go`, `F(2, 80) (avanza)`.

        What says another command than the instruction's is an order: `F(2, 80) - retrocede 2`.
        """
        if token.kind == after.kind == "-" and after.start == token.end:
            self.other_note(token.start, "--", after.end)
        behind = self.cursor.tokens[min(self.cursor.i + 2, len(self.cursor.tokens) - 1)]
        is_talk = after.kind is WORD and after.text not in WORDS and behind.kind not in ("(", ",")
        if token.kind in ("(", "-", "/") and is_talk and not self._orders_behind(first):
            self.other_note(token.start, token.kind, after.start)

    def _orders_behind(self, first: Token) -> bool:
        """Whether the rest of the line says a command that is not `first`, or a name of ours."""
        known, tokens = self.in_block.known, self.cursor.tokens
        own = known.command(first.text)
        turns = own is not None and own.text in ("L", "R")
        for each in takewhile(
            lambda token: token.kind not in (NEWLINE, END), tokens[self.cursor.i + 1 :]
        ):
            meant = known.command(each.text) if each.kind is WORD else None
            if meant is not None and meant.is_instruction and meant is not own:
                return True
            if known.is_own(each.text) or (each.text in TURN_WORDS and not turns):
                return True
        return False

    def other_note(self, start: int, sign: str, text_start: int) -> NoReturn:
        """`-- go` or `REM go`: the rest of the line is a note."""
        cursor = self.cursor
        cursor.skip_line()
        span = Span(start, cursor.token.start)
        note = "// " + cursor.source[Span(text_start, span.end)].strip()[:40]
        self.reporter.fail(codes.OTHER_NOTE, span, found=sign, right=note)
