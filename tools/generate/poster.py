"""The poster of the language: every word of `words.py` on one page, in English and Spanish.

Knows what is said of each word, and the layout. A word of the table that has no row here, or two,
is an error: the poster is whole or not made.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from tiniscript.robots.profile import LANGUAGES
from tiniscript.words import WORDS
from tools.generate import paper
from tools.generate.paper import BOLD, MONO, SANS, Box, Line, Page

LEFT, RIGHT = 36.0, 559.0
CODE_X, SAYS_X = 44.0, 252.0
HEAD_PT, ROW_PT = 20.5, 15.4
CODE_SIZE, SAYS_SIZE = 9.8, 10.0
CODE_SIGNS, SAYS_SIGNS = 34, 60  # that fit
NOT_SHOWN = ("alias", "later")  # roles: other spellings, and words that do nothing yet
BLACK, GREY, WHITE = (20, 20, 20), (90, 90, 90), (255, 255, 255)
BLUE, PALE = (18, 92, 160), (238, 243, 248)
TITLES = {"en": "TiniScript: all the words", "es": "TiniScript: todas las palabras"}
SUBTITLES = {
    "en": "One line makes a robot move. The first number is seconds, the second one power in percent.",
    "es": "Una línea mueve un robot. El primer número son segundos; el segundo, potencia en porcentaje.",
}
FEET = {
    "en": "A ; or a new line ends an instruction. // begins a note.  Help:  tsc explain · tsc help · tsc lesson",
    "es": "Un ; o una línea nueva termina una instrucción. // empieza una nota.  Ayuda:  tsc explain · tsc help · tsc lesson",
}


class Row(NamedTuple):
    """`code` shows a word; `{F}` in it is the example that the table has for F.

    `code_es` is what stands there in Spanish, where a pupil's own word is in it.
    """

    code: str
    en: str
    es: str
    code_es: str = ""


class Group(NamedTuple):
    en: str
    es: str
    rows: tuple[Row, ...]


# fmt: off
GROUPS = (
    Group("Begin", "Empezar", (
        Row("SI|{F}", "starts at once", "empieza enseguida"),
        Row("SB|{F}", "waits for the robot's button", "espera el botón del robot"),
        Row("PING|CHECK_CONNECTION", "asks: who is there?", "pregunta: ¿quién está ahí?"),
        Row("START", "marks the beginning; nothing moves", "marca el comienzo; nada se mueve"),
    )),
    Group("Move", "Moverse", (
        Row("{F}   {B}", "forward, back", "adelante, atrás"),
        Row("{L}   {R}", "turns left, turns right", "gira a la izquierda, a la derecha"),
        Row("F(20 CM, 60)   R(90 DEG, 60)", "20 centimetres; 90 degrees", "20 centímetros; 90 grados"),
        Row("{M}", "left and right motor, and goes on at once", "motor izquierdo y derecho, y sigue enseguida"),
        Row("{W}", "waits", "espera"),
        Row("S   STOP", "stops the motors", "detiene los motores"),
        Row("F(5, 60) UNTIL(DISTANCE < 10)", "ends earlier, when the answer is yes", "termina antes, cuando la respuesta es sí"),
        Row("F(FOREVER, 60) UNTIL(LIGHT_L > 9)", "no time limit: only the question ends it", "sin tiempo máximo: solo la pregunta lo termina"),
    )),
    Group("Tell", "Avisar", (
        Row("{BEEP}", "sounds: seconds, and pitch in hertz", "suena: segundos, y tono en hercios"),
        Row("{SHOW}", "shows a value on the computer", "muestra un valor en la computadora"),
    )),
    Group("Decide and repeat", "Decidir y repetir", (
        Row("{IF} ... ENDIF", "only if the answer is yes", "solo si la respuesta es sí"),
        Row("ELSEIF(DISTANCE < 30)   ELSE", "otherwise, another question; otherwise", "si no, otra pregunta; si no"),
        Row("{LOOP} ... END_LOOP", "three times; LOOP(FOREVER) without end", "tres veces; LOOP(FOREVER), sin fin"),
        Row("{WHILE} ... END_WHILE", "as long as the answer is yes", "mientras la respuesta sea sí"),
        Row("BREAK", "leaves the loop", "sale del bucle"),
    )),
    Group("Several things at once", "Varias cosas a la vez", (
        Row("{WHEN} ... END_WHEN", "each time the answer is yes, while the rest goes on", "cada vez que la respuesta es sí, mientras lo demás sigue"),
        Row("TASK ... END_TASK", "runs at the same time as the rest", "se hace al mismo tiempo que lo demás"),
    )),
    Group("Words of your own", "Palabras tuyas", (
        Row("DEF STEP ... END_DEF", "teaches a new word: STEP", "enseña una palabra nueva: PASO", "DEF PASO ... END_DEF"),
        Row("STEP", "does what STEP means", "hace lo que PASO significa", "PASO"),
        Row("SPEED = 50", "a variable keeps a value under a name", "una variable guarda un valor con un nombre", "VELOCIDAD = 50"),
    )),
    Group("Questions", "Preguntas", (
        Row("TRUE   FALSE", "yes, no", "sí, no"),
        Row("A AND B   A OR B   NOT A", "both; one is enough; the contrary", "las dos; basta una; lo contrario"),
        Row("=  <>  <  >  <=  >=", "equal, not equal, less, more, at most, at least", "igual, distinto, menor, mayor, como máximo, como mínimo"),
    )),
    Group("Calculate", "Calcular", (
        Row("+  -  *  /  %", "plus, minus, times, divided by, remainder", "más, menos, por, entre, resto"),
        Row("{RANDOM}", "a whole number by chance, from 1 to 6", "un número entero al azar, de 1 a 6"),
        Row("ROUND(A, 1)   ABS(A)", "to one decimal; without its minus", "con un decimal; sin su signo menos"),
        Row("MIN(A, B)   MAX(A, B)", "the smaller, the larger", "el menor, el mayor"),
        Row("TIME", "seconds since the program has started", "segundos desde que empezó el programa"),
    )),
    Group("What TiniBot sees", "Lo que ve TiniBot", (
        Row("DISTANCE", "centimetres to what is ahead", "centímetros hasta lo que está delante"),
        Row("LIGHT_L   LIGHT_R", "light on the left, on the right: 0 to 1023", "luz a la izquierda, a la derecha: de 0 a 1023"),
    )),
)
# fmt: on


def _with_fixed(rows: tuple[Row, ...]) -> list[Row]:
    """Return rows; below that of a word those of the words which stand for it with fixed values."""
    return [
        each
        for row in rows
        for each in (
            row,
            *(
                Row(word.text, *word.says)
                for word in WORDS.values()
                if word.stands_for and f"{{{word.stands_for.partition('(')[0]}}}" in row.code
            ),
        )
    ]


def posters(command: str) -> dict[str, Callable[[], str]]:
    """Return how the files of `docs/poster/` are made, by their names. `command` makes them."""
    return {
        f"poster.{language}.{form}": partial(poster, language, form, command)
        for language in LANGUAGES
        for form in ("svg", "pdf")
    }


def poster(language: str, form: str, command: str) -> str:
    """Return the poster in a language, as `svg` or `pdf`."""
    note = f"Generated by {command} from compiler/tiniscript/words.py. Do not edit."
    write = {"svg": paper.svg, "pdf": paper.pdf}[form]
    return write(page(language), TITLES[language], note)


def page(language: str) -> Page:
    k = language == "es"
    found: Page = [
        Box(0, 0, paper.WIDTH, 64, BLUE),
        Line(LEFT, 34, 24, BOLD, WHITE, TITLES[language]),
        Line(LEFT, 53, 10, SANS, WHITE, SUBTITLES[language]),
    ]
    y = 74.0
    shown: list[str] = []
    for group in GROUPS:
        found.append(Line(LEFT, y + 15, 12, BOLD, BLUE, group.es if k else group.en))
        y += HEAD_PT
        for number, row in enumerate(_with_fixed(group.rows)):
            wanted = row.code_es if k and row.code_es else row.code
            code = re.sub(r"\{(\w+)\}", lambda match: WORDS[match[1]].example, wanted)
            says = row.es if k else row.en
            assert len(code) <= CODE_SIGNS and len(says) <= SAYS_SIGNS, (code, says)
            shown += re.findall(r"[A-Z_]+", re.sub(r"\(.*?\)", "", code.replace(",", "")))
            shown += re.findall(r"\b(?:UNTIL|FOREVER|CM|DEG)\b", code)
            if number % 2 == 0:
                found.append(Box(LEFT, y, RIGHT - LEFT, ROW_PT, PALE))
            found.append(Line(CODE_X, y + 11.8, CODE_SIZE, MONO, BLACK, code))
            found.append(Line(SAYS_X, y + 11.8, SAYS_SIZE, SANS, BLACK, says))
            y += ROW_PT
        y += 2
    assert y <= paper.HEIGHT - 26, f"the page is too short by {y - paper.HEIGHT + 26} points"
    missing = {word.text for word in WORDS.values() if word.role not in NOT_SHOWN} - set(shown)
    assert not missing, f"the poster lacks {sorted(missing)}"
    found.append(Line(LEFT, paper.HEIGHT - 16, 9, SANS, GREY, FEET[language]))
    return found
