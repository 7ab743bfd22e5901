"""What stands in brackets that a word has not: a question is asked before, and a value is named.

`STOP(DISTANCE < 10)` is `IF(DISTANCE < 10);STOP;ENDIF`, and `END_LOOP(4)` is END_LOOP without 4.
"""

from __future__ import annotations

import re

from tiniscript.base.kit import Kit
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.recovery.meanings import Names, lexemes, texts

_INSIDE = re.compile(r"[ \t]*\(((?:[^()\n;]|\([^()\n;]*\))+)\)")
_ASKED = re.compile(r"[<>=]")
_ASKS = {
    **{word: f"IF({{what}});{word};ENDIF" for word in ("S", "STOP", "BREAK")},
    "TASK": "WHEN({what})",
}
_SAID = ("fix", "head", "named", "lost")  # gaps that say what becomes of it


def bracketed(diagnostic: Diagnostic, text: str, kit: Kit, is_offered: bool) -> Diagnostic:
    """Return a mistake of needless brackets with what becomes of what is in them.

    `is_offered`: where it is a question, that is asked; else it is named as lost.
    """
    values = diagnostic.values
    is_said = diagnostic.repair or any(values.get(gap) for gap in _SAID)
    if diagnostic.code not in (codes.NO_BRACKETS_HERE, codes.NOT_CALLABLE) or is_said:
        return diagnostic
    at = text.find("(", diagnostic.span.start)
    inside = _INSIDE.match(text, at) if at >= 0 else None
    if inside is None or "\n" in text[diagnostic.span.start : at]:
        return diagnostic
    what, word = inside[1].strip(), values.get("word", "").upper()
    names = Names([lexemes(what)], kit)
    is_asked = bool(_ASKED.search(what)) or any(map(names.is_yes_no, texts(lexemes(what))))
    asks = _ASKS.get(word, "") if is_asked else ""
    if asks and is_offered:
        return diagnostic._replace(values={**values, "fix": asks.format(what=what)})
    return diagnostic if is_offered else diagnostic._replace(values={**values, "lost": what})
