"""The lexer of texts with something in them that it cannot read.

Knows the characters that people write in the place of others. What it cannot read it reports, and
goes on with the nearest token that makes sense. A checksum behind a line is no token. Right texts
never load it: see `lexer`, whose tokens are the same wherever that reads a text.
"""

from __future__ import annotations

import re
from unicodedata import category, normalize

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.source import Span
from tiniscript.syntax import pasted
from tiniscript.syntax.amounts import is_amount, with_number
from tiniscript.syntax.checksums import SPACES, without_checksums
from tiniscript.syntax.lexer import NEWLINE, NUMBER, ODD, QUOTES, WORD, Scan, Token, read
from tiniscript.syntax.pasted import PATTERN as PASTED
from tiniscript.syntax.pasted import SPEAKER
from tiniscript.syntax.units import converted
from tiniscript.words import UNITS

_PATTERN = re.compile(
    rf"(?P<space>[{SPACES}]+)"
    r"""
      | (?P<speaker>"""
    + SPEAKER
    + r""")
      | (?P<lettered>[OoIl]\.[0-9]+(?!\w))
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)(?!\w)
      | (?P<clock>[0-9]{1,2}:[0-5][0-9](?=[ ]*,)|(?<=[Ww]\()[0-9]{1,2}:[0-5][0-9](?=[ ]*\)))
      | (?P<percent>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)[ ]?%(?=[ ]*[,)]))
      | (?P<spaced>[0-9]{1,3}[ ]000(?=[ ]*[,;)])|[0-9]{1,3}\.[ ]{1,2}[0-9]{1,3}(?=[ ]*,))
      | (?P<shifted>(?:(?<=[<>])|(?<=[<>][ ]))[1-9]=(?=[ ]*\)))
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)
            (?![\w.\u00b0]|['\u00b4\u2019][0-9]|["\u201d\u2033][ ]*[,)]))
      | (?P<newline>\r\n|\n|\r)
      | (?P<comment>//[^\r\n]*)
      | (?P<othernote>\#[^\r\n]*|/\*[^*]*(?:\*(?!/)[^*]*)*(?:\*/)?)
      | (?P<pasted>"""
    + PASTED
    + r""")
      | (?P<othersign>\\n|==|!=|\u00a1=|![<>]=?|=>|=<|><|&&|\|\||!(?=[ \t]*[\w(])
            |(?<=[0-9])~(?=[ ]?[0-9]+(?:\.[0-9]+)?[ ]?[,)])
            |=[ ]+[<>=]|[<>][ ]+=|<[ ]+>|>[ ]+<|[\u2264\u2265\u2260\u00d7\u00f7\u221e])
      | (?P<sign><=|>=|<>|[-+*/%=<>(),;|])
      | (?P<dash>[\u2010-\u2015\u2212])
      | (?P<badnumber>[0-9]+(?:\.[0-9]+)?["\u201d\u2033](?=[ ]*[,)])
            |[0-9][0-9.]*['\u00b4\u2019][0-9][\w.]*|\.?[0-9][\w.\u00b0]*|[\u00bc-\u00be])
      | (?P<badword>\w+)
      | (?P<quote>["'`\u00b4\u2018-\u201f\u00ab\u00bb]+
            (?:[^"'`\u00b4\u2018-\u201f\u00ab\u00bb\r\n]*["'`\u00b4\u2018-\u201f\u00ab\u00bb]+)?)
      | (?P<wide>[\u3001\uff08\uff09\uff0c\uff1b\uff1d\uff1c\uff1e\uff5c\uff0b\uff0d])
      | (?P<bracket>[][])
      | (?P<brace>[{}])
      | (?P<tilde>~[0-9A-Fa-f]*)
      | (?P<point>(?<=[\w)])\.(?=[ \t]+[A-Za-z]))
      | (?P<odd>.)
    """,
    re.VERBOSE | re.DOTALL,
)

_TIMES = re.compile(r"[0-9]{1,3}[xX][0-9]{1,3}")
# What people write, and what the language writes.
_OTHER_SIGNS = {
    "==": "=", "!=": "<>", "¡=": "<>",
    "!<": ">=", "!>": "<=", "!<=": ">", "!>=": "<",
    "=>": ">=", "=<": "<=", "><": "<>", "&&": "AND", "||": "OR",
    "!": "NOT", "≤": "<=", "≥": ">=", "≠": "<>", "×": "*", "÷": "/", "∞": "FOREVER", "\\n": ";",
    "~": ",",
    "（": "(", "）": ")", "，": ",", "、": ",", "；": ";", "＝": "=", "＜": "<", "＞": ">",
    "｜": "|", "＋": "+", "－": "-", "[": "(", "]": ")",
}  # fmt: skip
_FARTHEST = 10_000  # characters in which a variable is looked for
_NEAR = 100  # tokens in which an open bracket is looked for


def scan_with_repairs(text: str) -> Scan:
    """Return the tokens of any `text`, its comments and what could not be read."""
    tokens: list[Token] = []
    comments: list[Token] = []
    repairs = _Repairs(text)
    if "~" in text:
        text, repairs.diagnostics = without_checksums(text)
    read(_PATTERN, text, tokens, comments, repairs.add)
    return Scan(tokens, comments, repairs.diagnostics)


def _calculates(sign: str) -> bool:
    """Whether a sign changes a value, as √ and ¬ do: without it the program does something else."""
    return sign == "^" or (category(sign) == "Sm" and not "\u2190" <= sign <= "\u21ff")


def _is_inside(tokens: list[Token]) -> bool:
    """Whether a bracket is open after the last of these tokens."""
    depth = 0
    for token in reversed(tokens[-_NEAR:]):
        if token.kind is NEWLINE or token.kind == ";":
            break
        depth += (token.kind == "(") - (token.kind == ")")
    return depth > 0


_PAIRS = {"?": "¿", "!": "¡"}  # the sign that opens what another one closes


class _Repairs:
    """Reports what is wrong with a piece of text and returns the token to go on with.

    A method for each group of the pattern. What comes in pairs, or again and again, is reported
    once.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self.diagnostics: list[Diagnostic] = []
        self.open_brackets = 0
        self.has_wide = False
        self.has_braces = False
        self.has_pasted = False
        self.has_points = False

    def add(self, match: re.Match[str], tokens: list[Token]) -> None:
        """Add the tokens of what only this pattern knows."""
        group, text, span = match.lastgroup, match.group(), Span(*match.span())
        if group == "dash":
            tokens.append(Token("-", "-", *span))
        elif group == "point":
            tokens.append(self.odd(".", span) if _is_inside(tokens) else self.point(span))
        elif group == "pasted" or group == "speaker":
            tokens += self.pasted(text, span)
        elif group == "othernote":
            self.note(text, span)
        else:
            assert group is not None
            tokens.append(getattr(self, group)(text, span))

    def report(self, code: Code, span: Span, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values))

    def othersign(self, text: str, span: Span) -> Token:
        sign = text.replace(" ", "")  # `= <`
        right = _OTHER_SIGNS.get(sign, sign)
        self.report(codes.OTHER_SIGN, span, found=text, right=right)
        return Token(WORD if right.isalpha() else right, right, *span)

    def wide(self, text: str, span: Span) -> Token:
        if not self.has_wide:
            self.has_wide = True
            return self.othersign(text, span)
        return Token(_OTHER_SIGNS[text], _OTHER_SIGNS[text], *span)

    def bracket(self, text: str, span: Span) -> Token:
        if text == "]" and self.open_brackets:
            self.open_brackets -= 1
            return Token(")", ")", *span)
        self.open_brackets += text == "["
        return self.othersign(text, span)

    def brace(self, text: str, span: Span) -> Token:
        if not self.has_braces:
            self.has_braces = True
            self.report(codes.BRACES, span, found=text)
        return Token(text, text, *span)

    def pasted(self, text: str, span: Span) -> list[Token]:
        if not self.has_pasted:
            self.has_pasted = True
            self.report(codes.PASTED, span, found=text.strip())
        sign = pasted.meant(text).strip(" ")
        if sign == "\n":
            return [Token(NEWLINE, sign, *span)]
        return [Token(WORD if sign.isalpha() else sign, sign, *span)] if sign else []

    def point(self, span: Span) -> Token:
        """The end of a sentence: `F(2, 80). R(1, 50).`"""
        if not self.has_points:
            self.has_points = True
            self.report(codes.OTHER_SIGN, span, found=".", right=";")
        return Token(";", ";", *span)

    def tilde(self, text: str, span: Span) -> Token:
        self.report(codes.CHECKSUM_FORM, span)
        return Token(ODD, text, *span)

    def badnumber(self, text: str, span: Span) -> Token:
        number = _number_in(text)
        unit = text[len(number) :].strip().upper() if text.startswith(number) else ""
        if unit in UNITS:
            before = self._text[max(0, span.start - 1) : span.start]
            is_part = before in ("/", "*") and UNITS[unit][1] != 1000
            right = "" if is_part else converted(number, unit)  # `1/2min`
            self.report(codes.UNIT, span, found=text, number=number, right=right, unit=unit)
            return Token(NUMBER, number, *span)
        meant = _digits_meant(text)
        if not meant and _TIMES.fullmatch(text) and not self._is_alone(span):  # `F(3x2, 80)`
            meant_by_x = " * ".join(re.split("[xX]", text))
            self.report(codes.BAD_NUMBER, span, found=text, right=meant_by_x)
            return Token(NUMBER, number, *span)
        pointed = text if re.fullmatch(r"[0-9]*\.[0-9]+\.[0-9.]+", text) else ""
        letter = next((each for each in text if each in "OoIl"), "") if meant else ""
        values = {"found": text, "right": meant, "pointed": pointed, "letter": letter}
        self.report(codes.BAD_NUMBER, span, **values)
        return Token(NUMBER, meant or number, *span)

    def _is_alone(self, span: Span) -> bool:
        """Whether it is all that its brackets hold: `F(2x80)` lacks a comma."""
        before = self._text[max(0, span.start - 9) : span.start].rstrip(SPACES)[-1:]
        return before == "(" and self._text[span.end : span.end + 9].lstrip(SPACES)[:1] == ")"

    def lettered(self, text: str, span: Span) -> Token:
        """`O.5`: a letter in the place of the first digit."""
        return self.badnumber(text, span)

    def percent(self, text: str, span: Span) -> Token:
        """`80%`, `80 %`, where nothing is left that might be divided by."""
        return self.badnumber(text, span)

    def clock(self, text: str, span: Span) -> Token:
        """`1:30` is a minute and a half, in seconds; `L(0:39, 60)` may have no point."""
        minutes, seconds = text.split(":")
        right = str(60 * int(minutes) + int(seconds))
        is_wait = self._text[span.end : span.end + 9].lstrip(SPACES)[:1] == ")"
        is_sure = minutes.strip("0") or is_wait
        self.report(codes.BAD_NUMBER, span, found=text, right=right if is_sure else "")
        return Token(NUMBER, right, *span)

    def shifted(self, text: str, span: Span) -> Token:
        """`DISTANCE < 3=`: the sign is on the key of the 0."""
        right = text[0] + "0"
        self.report(codes.BAD_NUMBER, span, found=text, right=right)
        return Token(NUMBER, right, *span)

    def spaced(self, text: str, span: Span) -> Token:
        """`1 000`, `0. 39`: a thousand, and what a phone writes behind a point."""
        right = text.replace(" ", "")
        self.report(codes.BAD_NUMBER, span, found=text, right=right)
        return Token(NUMBER, right, *span)

    def badword(self, text: str, span: Span) -> Token:
        if text.isdecimal():  # of another script, or as wide as a letter
            digits = "".join(str(int(digit)) for digit in text)
            self.report(codes.BAD_NUMBER, span, found=text, right=digits)
            return Token(NUMBER, digits, *span)
        before = self._text[max(0, span.start - 9) : span.start].rstrip(SPACES)
        if not text.strip("_") and before.endswith(("(", ",", "=")):  # a gap to fill: `F(____, 60)`
            self.report(codes.BAD_NUMBER, span, found=text, right="")
            return Token(NUMBER, "1", *span)
        plain = _plain(text)
        amount = with_number(self._text, span) if is_amount(plain) else {}
        if amount and not any(text + sign in self._text[:_FARTHEST] for sign in ("=", " =")):
            self.report(codes.UNKNOWN_NAME, span, found=plain.upper(), **amount)  # `W(más)`
        else:
            self.report(codes.BAD_NAME, span, found=text, right=plain)
        return Token(WORD, plain.upper() or "X", *span)

    def quote(self, text: str, span: Span) -> Token:
        inside = text.strip(QUOTES).strip()
        number = re.fullmatch(r"[0-9]+(?:\.[0-9]+)?", inside)
        is_program = number or "(" in inside or inside.isupper()
        self.report(codes.QUOTE, span, found=text[0], right=inside if is_program else "")
        if number:
            return Token(NUMBER, inside, *span)
        if inside.isupper() and re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", inside):
            return Token(WORD, inside.upper(), *span)
        return Token(ODD, text, *span)

    def note(self, text: str, span: Span) -> None:
        sign = "#" if text[0] == "#" else "/*"
        inside = text[len(sign) :].removesuffix("*/").strip()[:40]
        behind = self._text[span.end : span.end + 1000].splitlines()[:1]
        is_last = "\n" not in text.strip() and not "".join(behind).strip(" \t;")
        right = f"// {inside}" if is_last else ""  # what stands behind would be in the note
        self.report(codes.OTHER_NOTE, span, found=sign, right=right)

    def odd(self, text: str, span: Span) -> Token:
        last = self.diagnostics[-1] if self.diagnostics else None
        if last is not None and _PAIRS.get(text) == last.values.get("found"):
            inside = self._text[last.span.end : span.start]
            if "\n" not in inside and last.code is codes.ODD_CHARACTER:  # `¿DISTANCE < 20?`
                values = {**last.values, "pair": f"{last.values['found']} {text}", "fix": inside}
                place = Span(last.span.start, span.end)
                self.diagnostics[-1] = last._replace(values=values, place=place)
                return Token(ODD, text, *span)
        if last is None or last.code is not codes.ODD_CHARACTER or last.span.end != span.start:
            shown = text if text.isprintable() else f"U+{ord(text):04X}"
            between = shown if _calculates(text) else ""
            self.report(codes.ODD_CHARACTER, span, found=shown, between=between)
        else:  # one diagnostic for a run of them
            between = last.values["between"] or (text if _calculates(text) else "")
            self.diagnostics[-1] = last._replace(
                span=Span(last.span.start, span.end), values={**last.values, "between": between}
            )
        return Token(ODD, text, *span)


_PARTS = {"¼": "0.25", "½": "0.5", "¾": "0.75"}
_LETTERS_FOR_DIGITS = str.maketrans("OoIl", "0011")


def _digits_meant(text: str) -> str:
    """Return the number that was surely meant: `5` for `5.`, `80` for `8O`, `1.5` for `1'5`."""
    if text in _PARTS:
        return _PARTS[text]
    digits = re.sub("['´’]", ".", text.rstrip('"”″').translate(_LETTERS_FOR_DIGITS))
    match = re.fullmatch(r"([0-9]{1,40}(?:\.[0-9]{1,40})?)\.?", digits)
    is_cut = digits.endswith(".0") and digits != text  # `8'0`
    return match[1] if match and not is_cut else ""


def _number_in(text: str) -> str:
    """Return what reading goes on with: `1.2` for `1.2.3`, `2` for `2X`."""
    match = re.match(r"[0-9]*(?:\.[0-9]+)?", text)
    return match.group()[:40] if match and match.group() else "0"


def _plain(text: str) -> str:
    """Return the nearest name in plain letters: `ANIO` for `AÑO`, `PASOS` for `_PASOS`."""
    composed = normalize("NFC", text[:1000])
    composed = re.sub("ñ(?![ií])", "ni", composed).replace("ñ", "n")
    capitals = "NI" if composed[1:].isupper() or len(composed) == 1 else "Ni"
    composed = re.sub("Ñ(?![IÍií])", capitals, composed).replace("Ñ", "N")
    letters = normalize("NFD", composed).encode("ascii", "ignore").decode()
    plain = re.sub(r"^[^A-Za-z]+|\W", "", letters)
    return plain
