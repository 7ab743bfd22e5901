"""A DEF that gives a value back, as a function of other languages does, which no DEF can.

`DEF DOUBLE(N);RETURN N * 2;END_DEF;X = DOUBLE(4)` is one mistake, reported at the RETURN, or else
where the call is a value: the result goes into a variable, and the call is an instruction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.syntax.free_names import names_in, numbered_names
from tiniscript.syntax.lexer import NEWLINE, NUMBER, WORD, Token, scan

# Tokens at which an instruction ends, or after which one begins.
_INSTRUCTION_ENDS = (";", NEWLINE, "|", "end")
_DEF_ENDS = ("END_DEF", "ENDDEF")
_RESULT_NAME = "RESULT"
_MAX_CHARACTERS = 4_000  # characters of a text that is looked at
_SUM_SIGNS = {*"+-*/%"}
_KINDS_IN_SUMS = {WORD, NUMBER, "(", ")", *_SUM_SIGNS}
_YES_NO_WORDS = ("AND", "OR", "NOT")


def find_returned_values(source: Source) -> tuple[list[Diagnostic], list[Edit]]:
    """Return the diagnostics for DEFs that return a value, and edits for further reading."""
    text = source.text
    if "DEF" not in text.upper() or len(text) > _MAX_CHARACTERS:
        return [], []
    tokens = scan(text).tokens
    names = {
        following_token.text for token, following_token in pairwise(tokens) if token.text == "DEF"
    }
    call_spans_by_name: dict[str, list[Span]] = {}
    for name, k in _value_calls(tokens, names):
        call_spans_by_name.setdefault(name, []).append(_call_span(tokens, k))
    diagnostics: list[Diagnostic] = []
    edits: list[Edit] = []
    diagnosed_names: set[str] = set()
    result_name = (
        _RESULT_NAME
        if _RESULT_NAME not in names_in(text)
        else next(numbered_names(text, _RESULT_NAME))
    )
    for name, word_token, value_span in _returns(tokens, {*call_spans_by_name}):
        calls_of_name = call_spans_by_name.get(name, [])
        values = {"word": name, "back": text[slice(*value_span)]}
        values |= {"call": text[slice(*calls_of_name[0])]} if calls_of_name else {}
        edits.append(Edit(Span(word_token.start, value_span.start), f"{result_name} = "))
        if name not in diagnosed_names:
            diagnostics.append(Diagnostic(codes.NO_VALUE, word_token.span, values))
        diagnosed_names.add(name)
    for name, spans in call_spans_by_name.items():
        if name not in diagnosed_names:
            name_span = Span(spans[0].start, spans[0].start + len(name))
            values = {"word": name, "called": name, "call": text[slice(*spans[0])]}
            diagnostics.append(Diagnostic(codes.NO_VALUE, name_span, values))
        edits += [
            Edit(span, result_name if name in diagnosed_names else _placeholder(text, span))
            for span in spans
        ]
    return diagnostics, edits


def _value_calls(tokens: Sequence[Token], names: set[str]) -> Iterator[tuple[str, int]]:
    """Yield each call of a DEF, with brackets, in the place of a value."""
    for k, token in enumerate(tokens[:-1]):
        if token.kind is not WORD or token.text not in names or tokens[k + 1].kind != "(":
            continue
        previous_token = tokens[k - 1] if k else None
        if previous_token is None or previous_token.kind in (*_INSTRUCTION_ENDS, WORD, NUMBER, ")"):
            if previous_token is None or previous_token.text not in _YES_NO_WORDS:
                continue
        if any(following_token.kind == ")" for following_token in _until_end(tokens, k)):
            yield token.text, k


def _call_span(tokens: Sequence[Token], k: int) -> Span:
    """Return the span of a call, with the brackets that its line contains."""
    depth, last_token = 0, tokens[k]
    for token in _until_end(tokens, k + 1):
        depth += (token.kind == "(") - (token.kind == ")")
        last_token = token
        if not depth:
            break
    return Span(tokens[k].start, last_token.end)


def _until_end(tokens: Sequence[Token], k: int) -> Iterator[Token]:
    """Yield the tokens of an instruction from one on."""
    for token in tokens[k:]:
        if token.kind in _INSTRUCTION_ENDS:
            return
        yield token


def _returns(tokens: Sequence[Token], called_names: set[str]) -> Iterator[tuple[str, Token, Span]]:
    """Yield each RETURN with a value in a DEF: the name of that, the word, and the value.

    So is a bare sum, `N * 2`, in a DEF whose name in `called_names` is used as a value.
    """
    name, begins_instruction = "", True
    for k, token in enumerate(tokens):
        if token.text == "DEF":
            name = tokens[min(k + 1, len(tokens) - 1)].text
        elif token.text in _DEF_ENDS:
            name = ""
        elif (
            begins_instruction
            and name
            and token.kind is WORD
            and lexicon_meaning(token.text, "leaves")
        ):
            value_tokens = [*_until_end(tokens, k + 1)]
            if value_tokens:
                yield name, token, Span(value_tokens[0].start, value_tokens[-1].end)
        elif begins_instruction and name in called_names and token.kind in (WORD, NUMBER, "("):
            value_tokens = [*_until_end(tokens, k)]
            kinds = {value_token.kind for value_token in value_tokens}
            if (
                len(value_tokens) > 2
                and value_tokens[1].kind != "("
                and kinds <= _KINDS_IN_SUMS
                and kinds & _SUM_SIGNS
            ):
                yield name, token, Span(value_tokens[0].start, value_tokens[-1].end)
        begins_instruction = token.kind in _INSTRUCTION_ENDS


def _placeholder(text: str, span: Span) -> str:
    """Return a placeholder for a call: a yes if the call is a whole question."""
    text_before, text_after = text[: span.start].rstrip(), text[span.end :].lstrip()
    word = text_before.removesuffix("(").rstrip()[-6:].upper()
    is_condition = text_before.endswith("(") and word.endswith(("IF", "WHILE", "UNTIL", "WHEN"))
    is_joined = text_before.upper().endswith(_YES_NO_WORDS) or text_after[:3].upper() in (
        "AND",
        "OR ",
    )
    return "TRUE" if (is_condition and text_after.startswith(")")) or is_joined else "1"
