"""Values in brackets that a word does not have: questions move in front, values get names.

`STOP(DISTANCE < 10)` is `IF(DISTANCE < 10);STOP;ENDIF`, and `END_LOOP(4)` is END_LOOP without 4.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import Lexeme, Names, lexemes, texts
from tiniscript.recovery.rewrites import negate
from tiniscript.recovery.writing import split_note

_TEXT_AFTER_ELSE = re.compile(r"(?i)\bELSE(?!_?IF)(?![ \t]+IF)[ \t]*([^\W\d][^;\n]*|\([^;\n]*\))")
_ELSE_CODES = (codes.NO_BRACKETS_HERE, codes.MISSING_OPEN)
_BRACKETS = re.compile(r"[ \t]*\(((?:[^()\n;]|\([^()\n;]*\))+)\)")
_IF_HEADER = re.compile(
    r"(?i)(?<!\w)(IF|ELSEIF|END_?IF)\b[ \t]*(?:\(((?:[^()\n;]|\([^()\n;]*\))+)\))?"
)
_COMPARISON_SIGN = re.compile(r"[<>=]")
_QUESTION_FORMS = {
    **{word: f"IF({{what}});{word};ENDIF" for word in ("S", "STOP", "BREAK")},
    "TASK": "WHEN({what})",
}
_ADVICE_GAPS = ("fix", "head", "named", "lost")  # gaps with the new form of the content


def explain_brackets(diagnostic: Diagnostic, text: str, kit: Kit, is_offered: bool) -> Diagnostic:
    """Return a mistake of needless brackets, with the new form of their content.

    `is_offered`: a question is asked; otherwise it is named as lost.
    """
    values = diagnostic.values
    has_other_advice = diagnostic.repair or any(values.get(gap) for gap in _ADVICE_GAPS)
    if diagnostic.code not in (codes.NO_BRACKETS_HERE, codes.NOT_CALLABLE) or has_other_advice:
        return diagnostic
    bracket_offset = text.find("(", diagnostic.span.start)
    brackets = _BRACKETS.match(text, bracket_offset) if bracket_offset >= 0 else None
    if brackets is None or "\n" in text[diagnostic.span.start : bracket_offset]:
        return diagnostic
    content, word = brackets[1].strip(), values.get("word", "").upper()
    names = Names([lexemes(content)], kit)
    is_condition = bool(_COMPARISON_SIGN.search(content)) or any(
        map(names.is_yes_no, texts(lexemes(content)))
    )
    question_form = _QUESTION_FORMS.get(word, "") if is_condition else ""
    if question_form and is_offered:
        return diagnostic._replace(values={**values, "fix": question_form.format(what=content)})
    return diagnostic if is_offered else diagnostic._replace(values={**values, "lost": content})


def explain_else_question(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Return a mistake for a question after ELSE, with ELSE alone as the first choice if it means
    the same.

    This is the case if its answer is no whenever the question before it is yes: `IF(DISTANCE <
    20)`, and `ELSE(DISTANCE > 20)`. ELSEIF with the question comes second.
    """
    start = diagnostic.span.start
    match = next(
        (
            match_at
            for match_at in _TEXT_AFTER_ELSE.finditer(text)
            if match_at.start() <= start < match_at.end()
        ),
        None,
    )
    if match is None or diagnostic.code not in _ELSE_CODES:
        return diagnostic
    previous_question, question = (
        _innermost_question(text[: match.start()]),
        split_note(match[1])[0].strip(" ;:\t"),
    )
    if not previous_question or _rough_form(negate(lexemes(previous_question))) != _rough_form(
        lexemes(question)
    ):
        return diagnostic
    end = match.start(1) + match[1].index(question) + len(question)
    repair = Repair((Edit(Span(match.start(), end), "ELSE"),), False)
    condition = question[1:-1] if question.startswith("(") else question
    values = {"fix": "ELSE", "rival": f"ELSEIF({condition.strip()})", "lost": ""}
    return diagnostic._replace(values={**diagnostic.values, **values}, repair=repair)


def _innermost_question(text: str) -> str:
    """Return the last question of the innermost open IF."""
    questions: list[str] = []
    for line in text.split("\n"):
        body = split_note(line)[0]
        for match in _IF_HEADER.finditer(body):
            word = match[1].upper()
            if word == "IF":
                questions.append(match[2] or "")
            elif questions and word == "ELSEIF":
                questions[-1] = ""  # an ELSE only takes the other answers
            elif questions and word.startswith("END"):
                questions.pop()
    return questions[-1] if questions else ""


def _rough_form(tokens: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return a question in which the number itself may be on either side: `>` for `>=`."""
    signs = {">=": ">", "<=": "<", "=>": ">", "=<": "<"}
    return tuple(signs.get(text, text) for text in texts(tokens) if text not in ("(", ")"))
