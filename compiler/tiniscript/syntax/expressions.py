"""The grammar of expressions and arguments: operator-precedence parsing over the cursor.

Knows which operand belongs to which operator. Gives parts in postfix order, and has a stack of its
own (`operators`), so that no depth of brackets exhausts Python's. Knows no instructions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.base.fixed_point import HIGHEST, LOWEST, as_text, read_literal
from tiniscript.base.source import Edit, Span
from tiniscript.base.words import EXTENTS, FUNCTIONS, UNIT_OF, WORDS, Word, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.syntax.ast import Argument, Part
from tiniscript.syntax.cursor import INSTRUCTION_ENDS, VALUE_ENDS, Cursor
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, UNKNOWN_SIGN, WORD, Token
from tiniscript.syntax.operators import AND, BINARY, COMPARISON, MINUS, NOT, OPEN, SIGNS, Postfix
from tiniscript.syntax.reporter import Failed, Reporter

_SCAN_STOPS = (")", "(", ";", NEWLINE, END)


class ExpressionParser:
    def __init__(self, cursor: Cursor, reporter: Reporter) -> None:
        self.cursor = cursor
        self.reporter = reporter

    # -- arguments --------------------------------------------------------------------------

    def arguments(self) -> tuple[Argument, ...]:
        cursor = self.cursor
        bracket = cursor.i
        cursor.i += 1
        if cursor.take_inner(")"):
            return ()
        arguments = [self.argument()]
        while cursor.take_inner(","):
            arguments.append(self.argument())
        if not cursor.take_inner(")"):
            self.report_missing_close(bracket)
        return tuple(arguments)

    def argument(self) -> Argument:
        cursor = self.cursor
        cursor.skip_newlines()
        token = cursor.tokens[cursor.i]
        if token.kind is WORD and token.text == "FOREVER":
            cursor.i += 1
            return Argument((Part("FOREVER", 0, *token.span),), token.span, False)
        argument = self.expression(is_in_brackets=True)
        token = cursor.peek_inner()  # the CM or DEG after the whole expression
        if token.kind is not WORD or token.text not in EXTENTS:
            return argument
        cursor.take_inner(WORD)
        return argument._replace(unit=Part(token.text, 0, *token.span))

    # -- expressions, by precedence ---------------------------------------------------------

    def expression(self, is_in_brackets: bool) -> Argument:
        cursor = self.cursor
        start = cursor.i
        postfix = Postfix(bracket_count=1 if is_in_brackets else 0)
        while not self.operand(postfix) or self.operator(postfix):
            pass
        parts = tuple(postfix.parts)
        span = cursor.span_from(cursor.tokens[start])
        is_plain = len(parts) == 1 and parts[0] == ("NUMBER", parts[0].value, *span)
        return Argument(parts, span, is_plain)

    def operand(self, postfix: Postfix) -> bool:
        """Read an operand or what stands before one; return whether the operand is complete."""
        cursor = self.cursor
        token = cursor.tokens[cursor.i]
        if token.kind is NEWLINE and postfix.open_bracket_count:
            cursor.skip_newlines()
            token = cursor.current_token
        kind = token.kind
        if kind is NUMBER:
            postfix.parts.append(self.number(token, postfix))
            return True
        if kind is WORD:
            return self.word(token, postfix)
        if kind == "-":
            postfix.wait(MINUS, "NEG", token, cursor.i)
        elif kind == "(":
            postfix.wait(OPEN, "(", token, cursor.i)
            postfix.open_bracket_count += 1
        elif not self.report_needless_plus(token, postfix):
            self.report_missing_value(token)
        cursor.i += 1
        return False

    def number(self, token: Token, postfix: Postfix) -> Part:
        """A minus right before a number belongs to it."""
        cursor, pending = self.cursor, postfix.pending_operators
        first_token = token
        if pending and pending[-1].precedence == MINUS:
            if pending[-1].index == cursor.index_before(cursor.i):
                first_token = pending.pop().token
        cursor.i += 1
        value, is_exact = read_literal(token.text)
        value = value if first_token is token else -value
        span = Span(first_token.start, token.end)
        if not LOWEST <= value <= HIGHEST:
            limit = as_text(HIGHEST if value > 0 else LOWEST)
            self.reporter.report(codes.NUMBER_TOO_BIG, span, limit=limit)
            value = 0
        elif not is_exact:
            values = {"found": token.text[:20], "right": as_text(value)}
            self.reporter.report(codes.ROUNDED, span, **values)
        return Part("NUMBER", value, *span)

    def word(self, token: Token, postfix: Postfix) -> bool:
        cursor = self.cursor
        word_row = WORDS.get(token.text)
        if word_row is None or word_row.role.name == "value":
            cursor.i += 1
            if cursor.tokens[cursor.i].kind == "(":
                self.reporter.fail(codes.NO_FUNCTION, token.span, found=token.text)
            op, value = ("NAME", token.text) if word_row is None else (token.text, 0)
            postfix.parts.append(Part(op, value, token.start, token.end))
            return True
        if token.text == "NOT":
            if postfix.pending_operators and postfix.pending_operators[-1].precedence > NOT:
                self.reporter.fail(codes.NOT_NEEDS_BRACKETS, token.span)
            postfix.wait(NOT, "NOT", token, cursor.i)
            cursor.i += 1
        elif token.text in FUNCTIONS:
            self.begin_call(token, word_row, postfix)
        else:
            self.report_missing_value(token)
        return False

    def begin_call(self, name: Token, function: Word, postfix: Postfix) -> None:
        cursor = self.cursor
        cursor.i += 1
        if postfix.open_bracket_count:
            cursor.skip_newlines()
        if cursor.current_token.kind != "(":
            self.reporter.fail(codes.MISSING_OPEN, name.span, word=name.text, usage=function.usage)
        postfix.wait(OPEN, name.text, name, cursor.i)
        postfix.open_bracket_count += 1
        cursor.i += 1
        if cursor.take_inner(")"):
            self.report_wrong_count(function, 0, cursor.span_from(name))

    def operator(self, postfix: Postfix) -> bool:
        """Read what may follow an operand; return whether another operand is wanted then."""
        cursor = self.cursor
        tokens = cursor.tokens
        while True:
            token = cursor.peek_inner() if postfix.open_bracket_count else tokens[cursor.i]
            if token.kind not in VALUE_ENDS and token.kind is not UNKNOWN_SIGN:
                binary = BINARY.get(token.text)
                if binary is not None:
                    if postfix.open_bracket_count:
                        cursor.skip_newlines()
                    self.binary(token, *binary, postfix)
                    cursor.i += 1
                    return True
            bracket = postfix.reduce() if postfix.pending_operators else None
            if bracket is None:
                return False
            if token.kind == ")":
                cursor.take_inner(")")
                postfix.open_bracket_count -= 1
                postfix.pending_operators.pop()
                if bracket.name != "(":
                    function, count = WORDS[bracket.name], bracket.ended_arguments + 1
                    span = cursor.span_from(bracket.token)
                    if count != len(function.arguments):
                        self.report_wrong_count(function, count, span)
                    postfix.parts.append(Part(bracket.name, 0, *span))
                continue
            if token.kind == "," and bracket.name != "(":
                bracket.ended_arguments += 1
                cursor.take_inner(",")
                return True
            self.report_missing_close(bracket.index)

    def binary(self, token: Token, precedence: int, name: str, postfix: Postfix) -> None:
        pending = postfix.pending_operators
        while pending and pending[-1].precedence >= precedence:
            if precedence == COMPARISON == pending[-1].precedence:
                self.reporter.fail(codes.CHAINED, token.span)
            postfix.apply()
        if precedence <= AND:  # AND and OR: the left side may decide
            postfix.parts.append(Part(name + "_LEFT", 0, token.start, token.end))
        postfix.wait(precedence, name, token, self.cursor.i)

    # -- what is wrong ------------------------------------------------------------------------

    def report_wrong_count(self, word: Word, count: int, span: Span) -> NoReturn:
        example = "" if count else word.example
        self.reporter.fail(codes.ARGUMENT_COUNT, span, word=word.text, usage=word.usage,
                           example=example, wanted=str(len(word.arguments)),
                           found=str(count))  # fmt: skip

    def report_needless_plus(self, token: Token, postfix: Postfix) -> bool:
        """A plus before a value says nothing; return whether it is one.

        `X = +1` is not reported: `X += 1` may be meant.
        """
        tokens, i = self.cursor.tokens, self.cursor.i
        if tokens[i - 1].kind == "=" and not (postfix.parts or postfix.pending_operators):
            return False
        following_token = tokens[min(i + 1, len(tokens) - 1)]
        begins_value = (
            following_token.kind in (NUMBER, "(", "-")
            or _is_name(following_token)
            or following_token.text in FUNCTIONS
        )
        if token.kind != "+" or not begins_value:
            return False
        repair = Repair((Edit(token.span, ""),), True)
        values = {"plus": token.text}
        self.reporter.diagnostics.append(
            Diagnostic(codes.EXTRA_WORD, token.span, values, token.span, repair)
        )
        return True

    def report_missing_value(self, token: Token) -> NoReturn:
        """A value is expected, and this token begins none."""
        word_row = WORDS.get(token.text) if token.kind is WORD else None
        self.reject_unknown_character(token)
        if self.ends_above(token):
            last_token = self.cursor.last_token
            self.reporter.fail(codes.MISSING_VALUE, last_token.span, before=last_token.text)
        if word_row is not None:
            self.reject_unit(token)
            code_of_role = {"forever": codes.FOREVER_NOT_HERE, "until": codes.UNTIL_ALONE}
            other_code = codes.NO_VALUE if word_row.role.is_instruction else codes.RESERVED
            self.reporter.fail(
                code_of_role.get(word_row.role.name, other_code), token.span, word=token.text
            )
        previous_token = (
            self.cursor.tokens[self.cursor.index_before(self.cursor.i)] if self.cursor.i else token
        )
        hints = {} if previous_token.kind is UNKNOWN_SIGN else {"before": previous_token.text}
        self.reporter.fail(codes.MISSING_VALUE, token.span or previous_token.span, **hints)

    def ends_above(self, token: Token) -> bool:
        """Return whether this token begins an instruction below an unfinished line.

        Then it goes back there: what is below is read for itself.
        """
        cursor = self.cursor
        k = cursor.i if cursor.current_token is token else cursor.tokens.index(token, cursor.i)
        word_row = WORDS.get(token.text) if token.kind is WORD else None
        begins_instruction = word_row is not None and (
            word_row.role.is_instruction or word_row.role.belongs_to_blocks
        )
        is_assignment = (
            token.kind is WORD and cursor.tokens[min(k + 1, len(cursor.tokens) - 1)].kind == "="
        )
        if (
            not (begins_instruction or is_assignment)
            or k == 0
            or cursor.tokens[k - 1].kind is not NEWLINE
        ):
            return False
        cursor.i = cursor.index_before(k) + 1
        return True

    def reject_unknown_character(self, token: Token) -> None:
        """A token that the language does not have."""
        if token.kind is not UNKNOWN_SIGN:
            return
        first_character, is_gap = token.text[0], not token.text.strip("_")  # a gap to fill
        code = (
            codes.BAD_NAME
            if first_character.isalnum() or first_character == "_"
            else codes.ODD_CHARACTER
        )
        if first_character.isdigit() or is_gap or (first_character == "." and len(token.text) > 1):
            code = codes.BAD_NUMBER
        elif first_character == "~":
            code = codes.CHECKSUM_FORM
        self.reporter.fail(code, token.span, found=token.text)

    def reject_unit(self, token: Token) -> None:
        """CM or DEG anywhere but after the whole of a value."""
        if token.kind is WORD and token.text in EXTENTS:
            self.report_wrong_unit(token.text, token.span)
            raise Failed

    def report_wrong_unit(self, unit: str, span: Span) -> None:
        first_word, second_word = (word for word, unit_of in UNIT_OF.items() if unit_of == unit)
        text_parts = self.cursor.source[Span(0, span.start)].upper().rpartition(f"{second_word}(")
        word = second_word if text_parts[1] and not set("\n;") & set(text_parts[2]) else first_word
        example = f"{word}({EXTENTS[unit].sample}, 60)"
        self.reporter.report(
            codes.UNIT_PLACE,
            span,
            found=unit,
            first=first_word,
            second=second_word,
            example=example,
        )

    def reject_semicolon(self, bracket: int) -> None:
        """A `;` between two values, where brackets are closed after the second one."""
        cursor = self.cursor
        tokens, k = cursor.tokens, cursor.i
        if tokens[k].kind != ";":
            return
        value = tokens[k + 1 + (tokens[k + 1].kind == "-")]
        end_index = next(j for j in range(k + 1, len(tokens)) if tokens[j].kind in _SCAN_STOPS)
        if tokens[end_index].kind != ")" or not (value.kind is NUMBER or _is_name(value)):
            return
        cursor.i = end_index + 1
        call = Span(tokens[bracket - 1].start, tokens[end_index].end)
        fix = f"{cursor.source[Span(call.start, tokens[k].start)].rstrip()}, "
        fix += cursor.source[Span(tokens[k + 1].start, call.end)]
        repair = Repair((Edit(tokens[k].span, ","),), False)
        diagnostic = Diagnostic(codes.SEMICOLON_INSIDE, tokens[k].span, {"fix": fix}, call, repair)
        self.reporter.diagnostics.append(diagnostic)
        raise Failed

    def skip_after_name(self) -> Token | None:
        """Return the token after a name of a DEF, in the place of a comma or the end.

        A sign is passed, with all up to there: `= 5`; a name is the next one. None for a unit.
        """
        cursor = self.cursor
        first_token = cursor.current_token
        depth = 0
        while first_token.kind in SIGNS and (
            depth > 0 or cursor.current_token.kind not in VALUE_ENDS
        ):
            depth += (cursor.current_token.kind == "(") - (cursor.current_token.kind == ")")
            if cursor.current_token.kind in INSTRUCTION_ENDS:
                break
            cursor.i += 1
        is_unit = len(first_token.text) > 1 and bool(lexicon_meaning(first_token.text, "unit"))
        is_name = first_token.kind is WORD and not is_unit
        return first_token if first_token.kind in SIGNS or is_name else None

    def report_not_only_names(self, bracket: int, extra: Token, names: Sequence[str]) -> None:
        """`DEF SIDE(SIZE = 5)`, `DEF SIDE(SIZE SPEED)`: the whole header is shown."""
        tokens = self.cursor.tokens
        header = Span(tokens[bracket - 2].start, self.cursor.last_token.end)
        name = tokens[bracket - 1].text
        fix = f"DEF {name}({', '.join(names)})"
        repair = Repair((Edit(header, fix),), False)
        code = codes.MISSING_COMMA if extra.kind is WORD else codes.PARAMETER_NEEDS_NAME
        diagnostic = Diagnostic(code, extra.span, {"name": name, "fix": fix}, header, repair)
        self.reporter.diagnostics.append(diagnostic)

    def report_missing_close(self, bracket: int) -> NoReturn:
        """Report that a comma or a closing bracket is missing."""
        token, previous_token = self.cursor.peek_inner(), self.cursor.last_token
        self.reject_semicolon(bracket)
        self.reject_unit(token if previous_token.text not in EXTENTS else previous_token)
        self.reject_unknown_character(token)
        if token.kind in (NUMBER, WORD, "(") and not self.ends_above(token):
            word = self.cursor.tokens[bracket - 1].text
            usage = {"usage": WORDS[word].usage} if word in WORDS else {}
            self.reporter.fail(codes.MISSING_COMMA, token.span, **usage)
        span = self.cursor.tokens[bracket].span
        self.reporter.fail(codes.MISSING_CLOSE, span, before=previous_token.text)


def _is_name(token: Token) -> bool:
    """Return whether a token may be a named value."""
    word_row = WORDS.get(token.text) if token.kind is WORD else None
    return token.kind is WORD and (word_row is None or word_row.role.name == "value")
