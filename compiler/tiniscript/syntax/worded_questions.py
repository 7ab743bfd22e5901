"""Reads a question that is written in words: `IF(luz mucha)`, `UNTIL(hay una pared)`.

Knows which sensor and which sign the words mean, as far as they say it. The number is not in them:
so what is shown is an example.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from tiniscript.diagnostics import codes
from tiniscript.fixed_point import ONE
from tiniscript.kit import Device, Kit
from tiniscript.source import Span
from tiniscript.syntax.call_suggestions import written
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import FILLERS
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import OPERATOR_WORDS, with_signs
from tiniscript.syntax.units import converted
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import NEAR_WORDS, NUMBER_WORDS, UNITS, WORDS, meant_by

_SAID = {
    "little": "POCA POCO POQUITA POQUITO CORTA CORTO PEQUENA PEQUENO CHICA CHICO BAJA BAJO MENOR"
    " MENOS LITTLE LOW SMALL SHORT LESS SMALLER CLOSE CERQUITA CERCANO CERCANA DEBIL OSCURO"
    " OSCURA DARK OSCURIDAD NEGRO NEGRA BLACK SOMBRA NOCHE LINEA LINE",
    "much": "MUCHA MUCHO LARGA LARGO GRANDE ALTA ALTO MAYOR MAS FUERTE LEJOS LEJANO LEJANA MUCH"
    " HIGH BIG LARGE LONG MORE BIGGER FAR STRONG FREE CLEAR BRIGHT LOT LIBRE CLARO CLARA"
    " BRILLANTE BLANCO BLANCA WHITE CAMINO PASO PATH WAY",
    "light": "LUZ LUCES LIGHT LIGHTS OSCURO OSCURA OSCURIDAD DARK CLARO CLARA BRILLANTE BRIGHT"
    " SOMBRA NOCHE LINEA LINE NEGRO NEGRA BLACK BLANCO BLANCA WHITE COLOR PISO FLOOR",
    "ahead": "DISTANCIA DISTANCE LEJOS CERQUITA CERCANO CERCANA CLOSE FAR ALGO ALGUIEN SOMETHING"
    " CAMINO PATH WAY PASO LIBRE FREE CLEAR TOCA TOCAS TOUCH TOUCHES MESA SILLA CAJA BOX MANO"
    " HAND",
}
_LITTLE, _MUCH, _LIGHT, _AHEAD = (frozenset(words.split()) for words in _SAID.values())
_AHEAD |= NEAR_WORDS
_NONE = frozenset(("NADA", "NADIE", "NOTHING", "NOBODY", "NINGUN", "NINGUNO", "NINGUNA"))
_NO = frozenset(("NO", "NOT", "SIN", "WITHOUT"))
_NOT = _NO | _NONE
_RIGHT = frozenset(("DERECHA", "DERECHO", "DER", "RIGHT"))
_LEFT = frozenset(("IZQUIERDA", "IZQUIERDO", "IZQ", "LEFT"))
_JOINED = {"Y": "AND", "E": "AND", "AND": "AND", "O": "OR", "U": "OR", "OR": "OR"}
_HALF = frozenset(("MEDIO", "MEDIA", "HALF"))
_LIGHT_ROOTS = ("LIGHT", "LINE")
_FAR = 10  # centimetres, as in every example
_MANY = 50  # of what a variable holds


def report_words(owner: str, row: Sequence[Token], reporter: Reporter, known: Vocabulary) -> None:
    """Report the tokens behind IF, WHILE or UNTIL, and raise Failed, if they ask in words."""
    if not row or known.kit is None or any(token.kind not in (WORD, NUMBER) for token in row):
        return
    span = Span(row[0].start, row[-1].end)
    joint = _joint([token.text for token in row], known)
    if joint:
        _answer(row, reporter)
        reporter.fail(codes.IN_WORDS, span, None, joint=joint)
    row, number = _measured(row, known)
    texts = [token.text for token in row]
    numbers = [token.text for token in row if token.kind is NUMBER]
    is_of_light = _asks_light(texts)
    if len(numbers) > 1 or not _is_wordy(texts, known):
        return
    if numbers and not set(texts) & (_AHEAD | _NONE) and not is_of_light and not _is_no_sign(texts):
        return
    if "BUTTON" in map(meant_by, texts):
        if not known.is_own("BUTTON"):
            reporter.fail(codes.NO_BUTTON, span)
        return
    _answer(row, reporter)
    own = [text for text in texts if known.is_own(text) and text != number]
    values = example_of(texts, known.kit, own)
    if number:
        also = values.get("another", "").rpartition(" ")[0]
        values = {"asked": f"{values['question'].rpartition(' ')[0]} {number}"}
        values |= {"also": f"{also} {number}"} if also else {}
    elif not own and not _is_asking(texts):
        values = {"example": values["question"]}
    reporter.fail(codes.IN_WORDS, span, None, word=owner, **values)


def _answer(row: Sequence[Token], reporter: Reporter) -> None:
    for token in row:
        reporter.answer(token)


def _joint(texts: Sequence[str], known: Vocabulary) -> str:
    """Return AND or OR, if two questions are joined and one of them is in words."""
    places = [k for k, text in enumerate(texts) if text in _JOINED and not known.is_own(text)]
    if not places or places[0] == 0 or places[-1] == len(texts) - 1:
        return ""
    pieces = [texts[a + 1 : b] for a, b in pairwise((-1, *places, len(texts)))]
    are_asking = all(set(piece) & (_AHEAD | _LIGHT | _NONE) for piece in pieces)
    is_done = any(_is_done(text) for text in texts if text not in _JOINED and text not in UNITS)
    are_clear = all(_is_understood(piece[0], known) and not _is_wordy(piece, known)
                    for piece in pieces if piece)  # fmt: skip
    return _JOINED[texts[places[0]]] if are_asking and not (is_done or are_clear) else ""


def _measured(row: Sequence[Token], known: Vocabulary) -> tuple[Sequence[Token], str]:
    """Return the row without units, and its number in centimetres or of light, "" where none."""
    texts = [token.text for token in row]
    for k, (token, after) in enumerate(zip(row, (*texts[1:], ""), strict=True)):
        unit = UNITS.get(after, ("", 0))
        is_near = bool(set(texts) & (_AHEAD | _NONE))
        if token.kind is NUMBER:
            rest = [*row[: k + 1], *row[k + 2 :]] if unit[0] else row
            is_whole = token.end - token.start == len(token.text)  # no `300mm`
            fits = unit[0] == "cm" if unit[0] else is_whole
            return rest, (converted(token.text, after) if unit[0] else token.text) if fits else ""
        is_length = unit[0] == "cm" and is_near
        if is_length and (token.text in _HALF or token.text in NUMBER_WORDS):
            number = "0.5" if token.text in _HALF else NUMBER_WORDS[token.text]
            return [*row[:k], *row[k + 2 :]], converted(number, after)
        is_limit = is_near and known.is_own(token.text) and not known.is_number(token.text)
        if is_limit and (is_length or (not after and k > 1 and texts[k - 1] in ("A", "DE", "QUE"))):
            rest = [*row[: k + 1], *row[k + 2 :]]
            return rest, token.text if unit[1] in (0, 1000) else ""
    return row, ""


def _asks_light(texts: Sequence[str]) -> bool:
    """Whether light is compared with a number: `la luz es mayor que 500`."""
    return bool(set(texts) & _LIGHT) and bool(set(texts) & (_LITTLE | _MUCH))


def _is_no_sign(texts: Sequence[str]) -> bool:
    """`distancia no menor 20`."""
    return any(a in _NO and OPERATOR_WORDS.get(b) in ("<", ">") for a, b in pairwise(texts))


def sensors_of(text: str, known: Vocabulary) -> list[str]:
    """Return the sensors of the kit that a word in capital letters may mean: `LUZ`, `PARED`."""
    devices = [each.name for each in known.kit.sensors if not each.is_yes_no] if known.kit else []
    if text in NEAR_WORDS:
        return [name for name in devices if name == "DISTANCE"]
    return _lights(devices) if text in _LIGHT else []


def _lights(names: Iterable[str]) -> list[str]:
    return sorted(name for name in names if name.partition("_")[0] in _LIGHT_ROOTS)


def either_sensor(values: Sequence[Token], known: Vocabulary) -> dict[str, str]:
    """`luz > 50`: return the headers that ask one sensor or the other, where two may be meant."""
    row = with_signs(values)
    meant = {
        each.text: sensors_of(each.text, known)
        for each in row
        if each.kind is WORD and not known.is_own(known.value(each.text))
    }
    places = [text for text, names in meant.items() if len(names) > 1]
    if len(places) != 1 or len(meant[places[0]]) != 2:
        return {}
    one, two = (
        written([each._replace(text=name) if each.text == places[0] else each for each in row])
        for name in meant[places[0]]
    )
    return {"one": f"IF({one})", "two": f"IF({two})"}


def is_asked_alone(text: str) -> bool:
    """Whether a word alone asks something of light: `IF(oscuro)`."""
    return text in _LIGHT and text not in ("LUZ", "LIGHT")


def example_of(texts: Sequence[str], kit: Kit, own: Sequence[str] = ()) -> dict[str, str]:
    """Return the `question` that words in capital letters mean, with an example for its number.

    `another` asks the sensor that may be meant as well. `own` are the program's names among them.
    """
    words = set(texts)
    is_little, is_much = bool(words & _LITTLE), bool(words & _MUCH)
    devices = {each.name: each for each in kit.sensors if not each.is_yes_no}
    pairs = ["_".join(pair) for pair in pairwise(texts)]  # `luz derecha`
    named = [meant_by(text) or text for text in (*own, *pairs, *texts)]
    named = [name for name in named if name in devices]
    subjects = named[:1]
    if not named and own:
        subjects = [own[0]]
    elif not named and words & _LIGHT and not words & _AHEAD:
        subjects = _lights(devices)[:2]
    turned = [f"LIGHT_{way}" for way, its in (("R", _RIGHT), ("L", _LEFT)) if words & its]
    if len(turned) == 1 and turned[0] in subjects:  # `mucha luz a la derecha`
        subjects = turned
    subjects = subjects or ["DISTANCE" if "DISTANCE" in devices else next(iter(devices), "X")]
    is_below = is_little or (subjects[0] == "DISTANCE" and not is_much)
    sign = "<" if is_below != bool(words & _NOT) else ">"
    sign += "=" * _is_no_sign(texts)
    asked = [f"{name} {sign} {_number(name, devices.get(name))}" for name in subjects]
    return dict(zip(("question", "another"), asked, strict=False))


def _is_asking(texts: Sequence[str]) -> bool:
    return bool(set(texts) & (_AHEAD | _LIGHT | _LITTLE | _MUCH | _NONE))


def _is_wordy(texts: Sequence[str], known: Vocabulary) -> bool:
    """Whether words are a question in words, rather than values and signs said in words."""
    if len(texts) < 2 or any(_is_done(text) for text in texts) or known.is_own("_".join(texts)):
        return False
    is_no = texts[0] in _NO and len(texts) == 2 and not _is_asking(texts[1:])  # `IF(NO READY)`
    if is_no or "AND" in texts or "OR" in texts:
        return False
    if _is_no_sign(texts):
        return True
    unknown = [text for text in texts if not _is_understood(text, known)]
    is_compared = any(OPERATOR_WORDS.get(text) in COMPARISONS for text in texts[1:-1])
    subject = next((text for text in texts if text not in FILLERS), "")
    if is_compared and _is_understood(subject, known):  # `DISTANCE menor que LIMITE`
        unknown = [text for text in unknown if text in _LITTLE | _MUCH | NEAR_WORDS]
    return bool(unknown) or (texts[-1] in OPERATOR_WORDS and not known.is_own(texts[-1]))


def _is_understood(text: str, known: Vocabulary) -> bool:
    meant = known.value(text)
    is_said = text in FILLERS or text in OPERATOR_WORDS or text in UNITS or text.isdecimal()
    return is_said or known.is_own(meant) or meant in WORDS


def _is_done(text: str) -> bool:
    word = WORDS.get(text)
    return word is not None and (word.is_instruction or word.role not in ("operator", "value"))


def _number(name: str, device: Device | None) -> int:
    if device is None:
        return _MANY
    middle = (device.low + device.high) // (2 * ONE)
    return _FAR if name == "DISTANCE" else round(middle, -2) if middle > 100 else middle
