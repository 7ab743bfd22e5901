"""A program of one word, as blocks are drawn from it."""

from __future__ import annotations

from tiniscript.base.words import WORDS

# A program for each role of words; the words of a role are put in.
ROLES = {
    "setup": {"PING": "PING|CHECK_CONNECTION", "CHECK_CONNECTION": "PING|CHECK_CONNECTION",
              "SI": "SI|S", "SB": "SB|S"},
    "until": {"UNTIL": "{}"}, "forever": {"FOREVER": "LOOP(FOREVER);W(1);END_LOOP"},
    "block": {"DEF": "DEF X;END_DEF", "IF": "IF(TRUE);ENDIF", "LOOP": "LOOP(1);END_LOOP",
              "WHILE": "WHILE(FALSE);END_WHILE", "TASK": "TASK;END_TASK",
              "WHEN": "WHEN(FALSE);END_WHEN"},
    "arm": {"ELSE": "IF(TRUE);ELSE;ENDIF", "ELSEIF": "IF(TRUE);ELSEIF(TRUE);ENDIF"},
    "end": {"ENDIF": "IF(TRUE);ENDIF", "END_LOOP": "LOOP(1);END_LOOP",
            "END_WHILE": "WHILE(FALSE);END_WHILE", "END_DEF": "DEF X;END_DEF",
            "END_TASK": "TASK;END_TASK", "END_WHEN": "WHEN(FALSE);END_WHEN"},
    "alias": {"END_IF": "IF(TRUE);END_IF", "ENDLOOP": "LOOP(1);ENDLOOP",
              "ENDWHILE": "WHILE(FALSE);ENDWHILE", "ENDDEF": "DEF X;ENDDEF",
              "ENDTASK": "TASK;ENDTASK", "ENDWHEN": "WHEN(FALSE);ENDWHEN"},
    "break": {"BREAK": "LOOP(1);BREAK;END_LOOP"},
    "unit": {"CM": "F(20 CM, 60)", "DEG": "L(90 DEG, 60)"},
    "operator": {"AND": "SHOW(TRUE AND FALSE)", "OR": "SHOW(TRUE OR FALSE)",
                 "NOT": "SHOW(NOT TRUE)"},
}  # fmt: skip


def program_with_word(word: str) -> str:
    role = WORDS[word].role.name
    if role == "until":
        return "W(1) UNTIL(DISTANCE < 10)"
    if role in ("value", "function"):
        return f"SHOW({WORDS[word].example})"
    return ROLES[role][word] if role in ROLES else WORDS[word].example
