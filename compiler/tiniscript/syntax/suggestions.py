"""Suggests what a beginner probably meant, and where reading goes on.

Knows habits from other languages, from Spanish and from talking. Looks at tokens and gives texts to
suggest. Reports nothing: the caller already knows that the text is wrong.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.syntax.call_suggestions import LONGEST, ends_value, starts_value, written
from tiniscript.syntax.cursor import AT_END
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import BINARY, COMPARISONS, OPPOSITES, SIGN_OF, SIGNS
from tiniscript.syntax.phrases import (
    AFTER_HEADER,
    BEFORE_MOVE,
    CASE_WORDS,
    ENDS_OF_ANY,
    FILLERS,
    FRAME_NAMES,
)
from tiniscript.words import POWER_WORDS, TURN_WORDS, UNITS, WORDS, Word, meant_by

# Words in the place of an operator, and those that go with them.
OPERATOR_WORDS = {
    "Y": "AND", "E": "AND", "O": "OR", "U": "OR",
    "SEA": "=", "ESTA": "=", "ARE": "=", "BE": "=",
    "IS": "=", "ES": "=", "EQUALS": "=", "EQUAL": "=", "IGUAL": "=",
    "LESS": "<", "MENOR": "<", "GREATER": ">", "MORE": ">", "MAYOR": ">", "BIGGER": ">",
    "SMALLER": "<", "LOWER": "<", "CLOSER": "<", "HIGHER": ">", "LARGER": ">", "FARTHER": ">",
    **dict.fromkeys(("DISTINTO", "DISTINTA", "DIFERENTE", "DIFFERENT"), SIGN_OF["NE"]),
    "MOD": "%", "X": "*", "POR": "*", "MAS": "+", "MENOS": "-",
}  # fmt: skip
_OPERATOR_TAILS = frozenset(("THAN", "QUE", "TO", "A", "DE", "FROM"))
_EQUALS = frozenset(("SEA", "ESTA", "ARE", "BE", "IS", "ES", "EQUALS", "EQUAL", "IGUAL"))


def foreign_block(word: str) -> str | None:
    """Return the word of a block (IF, ELSE, END_LOOP, DEF …) that `word` says elsewhere.

    END ends any block; FRAME is around a program, CASES chooses among several values.
    """
    if word in FRAME_NAMES or word in CASE_WORDS:
        return "FRAME" if word in FRAME_NAMES else "CASES"
    meant = meant_by(word)
    if meant is None or WORDS.get(meant) is None:
        return "END" if word in ENDS_OF_ANY else None
    return meant if WORDS[meant].role in ("block", "arm", "end", "forever") else None


def is_counting(tokens: Sequence[Token], k: int) -> bool:
    """Whether `I = 1 TO 4` or `I IN` stands at `k`, after a word such as `PARA`."""
    name, sign = tokens[k], tokens[min(k + 1, len(tokens) - 1)]
    return name.kind is WORD and (
        sign.kind == "=" or sign.text in ("IN", "EN", "DESDE", "DE", "FROM")
    )


def counted(tokens: Sequence[Token], start: int) -> int | None:
    """Return how often `I = 1 TO 4`, `I IN RANGE(4)` or `(I = 0; I < 4; I++)` goes round.

    None where that is not sure: a value that is no whole number, a step that is not 1.
    """
    row = []
    is_framed = start < len(tokens) and tokens[start].kind == "("
    end = (after_bracket(tokens, start) if is_framed else None) or start + 20
    for token in tokens[start : min(start + 20, end)]:
        if token.kind in (NEWLINE, END, "{") or token.text == ":":
            break
        row.append(token)
    words = {token.text for token in row if token.kind is WORD}
    numbers = [int(token.text) for token in row if token.kind is NUMBER and token.text.isdecimal()]
    has_other = any(
        token.kind is NUMBER
        and (not token.text.isdecimal() or token.end - token.start != len(token.text))
        for token in row
    )  # `1.5`, and `1..4` of which only the 1 is read
    steps = [k for k, token in enumerate(row[:-1]) if token.text in ("STEP", "PASO")]
    has_step = any(row[k + 1].kind is NUMBER for k in steps)
    if has_other or has_step or "DOWNTO" in words or any(t.kind == "-" for t in row):
        return None
    times = None
    if "RANGE" in words and len(numbers) in (1, 2):
        times = numbers[-1] - (numbers[0] if len(numbers) == 2 else 0)
    elif len(numbers) == 1 and words & {"IN", "EN"}:
        times = numbers[0]
    elif words & {"TO", "HASTA", "A"} and len(numbers) == 2:
        times = numbers[1] - numbers[0] + 1
    elif len(numbers) == 2 and any(token.kind in COMPARISONS - {"="} for token in row):
        includes_last = any(token.kind in COMPARISONS and len(token.kind) > 1 for token in row)
        times = numbers[1] - numbers[0] + includes_last
    return times if times is not None and 0 < times <= 255 else None


def head_in(word: Word, tokens: Sequence[Token]) -> str:
    """Return the header that `word` and the tokens after it were meant to be."""
    inside = written(with_signs(tokens[:LONGEST]))
    return f"{word.text}({inside})" if inside and len(tokens) <= LONGEST else word.example


def asked_again(row: Sequence[Token], token: Token) -> Sequence[Token]:
    """Return the name that `DISTANCE > 10 AND < 30` leaves out before its second sign."""
    is_left_out = len(row) > 3 and row[-1].text in ("AND", "OR") and row[-3].kind in COMPARISONS
    return row[-4:-3] if is_left_out and token.kind in COMPARISONS else ()


def with_signs(tokens: Sequence[Token]) -> list[Token]:
    """Return tokens with the signs of the language in place of words such as LESS THAN."""
    row: list[Token] = []
    k = 0
    ended = [*tokens, Token(END, "", 0, 0)]
    while k < len(tokens):
        said = operator_words(ended, k) if row and ends_value(row[-1]) else None
        row += asked_again(row, tokens[k])
        if said is None:
            row.append(tokens[k])
            k += 1
        else:
            end, sign = said
            row.append(Token(WORD if sign.isalpha() else sign, sign, *tokens[k].span))
            k = end
    return row


def body_begins(tokens: Sequence[Token], start: int, names_end: bool = True) -> int:
    """Return where the values end that follow a word without brackets, on the same line.

    They end where an instruction or a block's end begins, or at a word or a sign that other
    languages put before a body. `names_end`: whether a name right after a value does too.
    """
    k = start
    while True:
        token = tokens[k]
        kind = token.kind
        if kind in ("{", "}", "|", *AT_END):
            return k
        if kind is ODD and (token.text == ":" or _ends_sentence(tokens, k)):
            return k
        if kind == "," and k > start and _is_instruction(tokens[k + 1]):
            return k
        if kind is WORD and _begins_body(tokens, k, start, names_end):
            return k
        k += 1


def _ends_sentence(tokens: Sequence[Token], k: int) -> bool:
    """Whether the point at `k` ends a sentence: `avanza 2 segundos. Luego gira`."""
    after = tokens[k + 1]
    return tokens[k].text == "." and (after.kind in AT_END or after.start > tokens[k].end)


def _is_instruction(token: Token) -> bool:
    """Whether a word behind a comma begins the next instruction: `si X < 5, retrocede`."""
    said = WORDS.get(token.text) or WORDS.get(meant_by(token.text) or "")
    is_doing = said is not None and said.role in ("move", "wait", "stop", "beep", "show")
    return token.kind is WORD and is_doing and token.text not in POWER_WORDS


def _begins_body(tokens: Sequence[Token], k: int, start: int, names_end: bool) -> bool:
    token, following = tokens[k], tokens[k + 1]
    if following.kind in SIGNS and following.kind not in ("=", "-"):
        return False
    word = WORDS.get(token.text)
    after_value = k > start and ends_value(tokens[k - 1])
    if word is None:
        if token.text in AFTER_HEADER:
            return k > start
        if token.text in UNITS and tokens[k - 1].kind is NUMBER and following.kind != "(":
            return following.kind == "="
        if not after_value or token.text in _OPERATOR_TAILS:
            return False
        if token.text in OPERATOR_WORDS:
            return following.kind == "="
        if tokens[k - 1].kind is WORD and tokens[k - 1].text == "NO":
            return False
        return names_end or following.kind in ("=", "(")
    if word.role in ("value", "function", "operator", "forever"):
        return False
    if following.kind == "=":
        return after_value
    if word.is_call:
        return following.kind in ("(", NUMBER, "-")
    return True


def after_bracket(tokens: Sequence[Token], start: int) -> int | None:
    """Return the place after the `)` of the `(` at `start`, None where none is near on its line."""
    depth = 0
    for k in range(start, min(start + 1000, len(tokens))):
        kind = tokens[k].kind
        depth += (kind == "(") - (kind == ")")
        if not depth:
            return k + 1
        if kind in (NEWLINE, END):
            break
    return None


def inside(tokens: Sequence[Token], start: int) -> Sequence[Token]:
    """Return the tokens of the values that begin at `start`, in brackets or not."""
    if tokens[start].kind == "(":
        end = after_bracket(tokens, start)
        if end is not None:
            return tokens[start + 1 : end - 1]
        start += 1
    while is_filler(tokens, start):
        start += 1
    return tokens[start : body_begins(tokens, start)]


def end_of_values(tokens: Sequence[Token], start: int, values: Sequence[Token]) -> int:
    """Return where the values end in the text that `inside` has found at `start`."""
    end = after_bracket(tokens, start) if tokens[start].kind == "(" else None
    if end is not None:
        return tokens[end - 1].end
    return values[-1].end if values else tokens[start - 1].end


def is_question(tokens: Sequence[Token], start: int) -> bool:
    """Whether a comparison follows and no instruction: `DISTANCE < 10` after SI."""
    while is_filler(tokens, start):
        start += 1
    end = body_begins(tokens, start)
    said = [OPERATOR_WORDS.get(token.text, token.kind) for token in tokens[start + 1 : end]]
    signs = [sign for sign in said if sign in COMPARISONS]
    return bool(signs) and starts_value(tokens[start]) and (
        any(sign != "=" for sign in signs) or tokens[end].text in AFTER_HEADER
    )  # fmt: skip


def operator_words(tokens: Sequence[Token], k: int) -> tuple[int, str] | None:
    """Return where words such as `Y` or `IS LESS THAN` end, and the operator that they say."""
    end, said, is_not = k, "", False
    if tokens[k].text in ("NO", "NOT") and len(tokens) > k + 2:  # `DISTANCE no < 10`
        contrary = OPPOSITES.get(tokens[k + 1].kind)
        if contrary and (starts_value(tokens[k + 2]) or tokens[k + 2].kind == "-"):
            return k + 2, contrary
    while tokens[end].kind is WORD:
        text, after = tokens[end].text, tokens[min(end + 1, len(tokens) - 1)].text
        if text in ("NO", "NOT") and (said == "=" or (not said and after in _EQUALS)):
            said, is_not = SIGN_OF["NE"], True
        elif said in ("<", ">") and text in ("O", "OR") and after in _EQUALS:
            said += "="
        elif said in COMPARISONS - {"="} and text in _EQUALS:
            said += "=" if said in ("<", ">") else ""
        elif text in ("ENTRE", "DIVIDIDO") and tokens[min(end + 2, len(tokens) - 1)].text != "Y":
            said = "/"  # `10 entre 2`
        elif text in ("MENOS", "MAS") and after in ("DE", "QUE"):  # `menos de 15`
            said = "<" if text == "MENOS" else ">"
        elif text in OPERATOR_WORDS:
            if said in ("AND", "OR"):
                break
            said = OPERATOR_WORDS[text]
        elif not (said and text in _OPERATOR_TAILS):
            break
        end += 1
    if is_not and said[:1] in ("<", ">") and said != SIGN_OF["NE"]:  # `no es menor que`
        said = OPPOSITES[said]
    operand = tokens[end].kind == "-" or starts_value(tokens[end]) or tokens[end].text == "NOT"
    return (end, said) if said and operand else None


def tells(tokens: Sequence[Token], k: int, sign: str) -> bool:
    """Whether words that say `sign` before `k` begin a note: `X = 5 es la velocidad`."""
    is_named = tokens[k].text in (*FILLERS, "MI", "MY") and tokens[k + 1].kind is WORD
    return sign == "=" and is_named


def between(tokens: Sequence[Token], name: str) -> tuple[str, int] | None:
    """Return what `ENTRE 5 Y 10` asks of `name`, and where that ends in the text."""
    if len(tokens) < 4 or tokens[0].text not in ("ENTRE", "BETWEEN"):
        return None
    low, also, high = tokens[1:4]
    if not (low.kind is high.kind is NUMBER and also.text in ("Y", "AND", "E")):
        return None
    return f"{name} > {low.text} AND {name} < {high.text}", high.end


def opposite(tokens: Sequence[Token]) -> str:
    """Return the question that is TRUE where `DISTANCE < 10` is not, "" where it is no question."""
    signs = [k for k, token in enumerate(tokens) if token.kind in OPPOSITES]
    if any(token.text in ("AND", "OR", "NOT", "Y", "O") for token in tokens):
        return f"NOT ({written(tokens)})"
    if len(signs) != 1:
        return ""
    (k,) = signs
    return f"{written(tokens[:k])} {OPPOSITES[tokens[k].kind]} {written(tokens[k + 1 :])}"


def spaced_name(tokens: Sequence[Token], k: int) -> tuple[str, int] | None:
    """Return the name that `MY SPEED = 5` at `k` was meant to set, and where the `=` stands.

    A name may not have a word of the language in it, which rather is an instruction.
    """
    end = k
    while tokens[end].kind is WORD and tokens[end].text not in WORDS and end < k + 5:
        end += 1
    if end < k + 2 or tokens[end].kind != "=":
        return None
    return "_".join(token.text for token in tokens[k:end]), end


def is_filler(tokens: Sequence[Token], k: int) -> bool:
    """Whether the word at `k` changes nothing: another word follows, and no operator."""
    after = tokens[min(k + 1, len(tokens) - 1)]
    is_sign = after.text in OPERATOR_WORDS or after.text in BINARY
    return tokens[k].text in FILLERS and after.kind in (WORD, NUMBER) and not is_sign


def move_said(tokens: Sequence[Token], k: int) -> tuple[Word, int] | None:
    """Return the move that `girar a la derecha` or `el robot avanza` at `k` says, and its end."""
    first, candidate = k, None
    while tokens[k].kind is WORD:
        text = tokens[k].text
        meant = WORDS.get(meant_by(text) or "")
        is_more = k > first and (text in FILLERS or meant_by(text) == "F")
        is_verb = text in BEFORE_MOVE or meant_by(text) == "F"
        leads = is_verb and tokens[k + 1].kind is WORD and tokens[k + 1].text not in WORDS
        if meant is not None and meant.text == "F" and tokens[first].text in TURN_WORDS:
            return None  # `girar recto`
        if meant is not None and meant.role == "move" and not leads:
            return (meant, k + 1) if k > first else None
        if meant is not None and meant.text == "F" and k > first and text not in BEFORE_MOVE:
            candidate = (meant, k + 1)
        if not (is_verb or is_more):
            return candidate
        k += 1
    return candidate


def is_assignment(tokens: Sequence[Token], k: int) -> bool:
    """Whether `NAME =` stands at `k`."""
    return tokens[k].kind is WORD and tokens[k + 1].kind == "="


def update(name: str, tokens: Sequence[Token], k: int) -> tuple[str, str] | None:
    """Return how `X += 1`, `X++`, `X := 5` or `X <- 5` is written here, and the sign used.

    `k` is the place after the name.
    """
    sign, second = tokens[k], tokens[min(k + 1, len(tokens) - 1)]
    says_is = sign.kind is WORD and OPERATOR_WORDS.get(sign.text) == "="
    if (says_is or sign.text == ":") and starts_value(second) and tokens[k + 2].kind in AT_END:
        return f"{name} = {second.text}", sign.text.lower()
    if sign.end != second.start:
        return None
    found = sign.text + second.text
    if found in ("++", "--") and tokens[k + 2].kind in (")", *AT_END):
        return f"{name} = {name} {sign.text} 1", found
    if found not in ("+=", "-=", "*=", "/=", "%=", ":=", "<-"):
        return None
    end = k + 2
    while tokens[end].kind not in ("{", "}", *AT_END):
        end += 1
    value = written(tokens[k + 2 : min(end, k + 2 + LONGEST)])
    if not value:
        return None
    if found in (":=", "<-"):
        return f"{name} = {value}", found
    single = end == k + 3 or (sign.text in ("+", "-") and not {"+", "-"} & {
        token.kind for token in tokens[k + 2 : end]
    })  # fmt: skip
    return f"{name} = {name} {sign.text} {value if single else f'({value})'}", found


def shortened(text: str) -> str:
    """Return text that fits into a message."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:37] + "..."
