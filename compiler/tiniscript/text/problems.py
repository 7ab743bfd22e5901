"""What a robot that reads text says about a wrong line: the one table of its answers.

Knows numbers, names and words in both languages. Generated into the firmware, which has room for
one language. A number is never used for something else. Texts are ASCII, for any terminal.
"""

from __future__ import annotations

from typing import NamedTuple

LONGEST = 40  # characters of a text


class Problem(NamedTuple):
    """`english` and `spanish` say what is wrong, or what to try."""

    name: str
    english: str
    spanish: str


# fmt: off
PROBLEMS = (  # by number, from 1
    Problem("CHECKSUM",      "Line damaged. Send it again.",         "Linea danada. Enviala otra vez."),
    Problem("CHARACTER",     "This sign has no meaning here.",       "Este signo no significa nada."),
    Problem("NUMBER",        "Write numbers like 5 or 0.5",          "Escribe numeros como 5 o 0.5"),
    Problem("TOO_BIG",       "Numbers go to 2147483.647",            "Los numeros llegan a 2147483.647"),
    Problem("SETUP",         "SI| or SB| goes first, once.",         "SI| o SB| va primero, una vez."),
    Problem("PING",          "Write PING|CHECK_CONNECTION alone.",   "Escribe PING|CHECK_CONNECTION solo."),
    Problem("INSTRUCTION",   "Start with a word such as F.",         "Empieza con una palabra como F."),
    Problem("UNKNOWN_WORD",  "I do not know this word.",             "No conozco esta palabra."),
    Problem("UNKNOWN_VALUE", "It has no value yet. Write X = 0",     "Aun no tiene valor. Escribe X = 0"),
    Problem("RESERVED",      "This word cannot stand here.",         "Esta palabra no puede ir aqui."),
    Problem("SEPARATOR",     "Put a ; before this.",                 "Pon un ; antes de esto."),
    Problem("OPEN",          "Put a ( before this.",                 "Pon un ( antes de esto."),
    Problem("CLOSE",         "A ) is missing or too many.",          "Falta o sobra un )."),
    Problem("VALUE",         "A value is missing here.",             "Aqui falta un valor."),
    Problem("COUNT",         "Wrong count of values.",               "No es el numero de valores."),
    Problem("RANGE",         "Number too small or too large.",       "Numero muy chico o muy grande."),
    Problem("WANTS_NUMBER",  "Use a number, not a yes/no.",          "Usa un numero, no un si/no."),
    Problem("WANTS_YES_NO",  "Ask a question: DISTANCE < 10",        "Pregunta algo: DISTANCE < 10"),
    Problem("COMPARE",       "Compare two values of one kind.",      "Compara dos valores del mismo tipo."),
    Problem("NOT",           "Put NOT and its value in ( ).",        "Pon NOT y su valor entre ( )."),
    Problem("KIND",          "Number or yes/no: do not change it.",  "Numero o si/no: no lo cambies."),
    Problem("FOREVER",       "FOREVER: in LOOP, or with UNTIL.",     "FOREVER: en LOOP, o con UNTIL."),
    Problem("UNTIL",         "UNTIL goes behind F B L R or W.",      "UNTIL va tras F B L R o W."),
    Problem("BLOCK",         "This ends no open block.",             "Esto no cierra nada abierto."),
    Problem("BREAK",         "BREAK goes inside a loop.",            "BREAK va dentro de un bucle."),
    Problem("DEF",           "DEF goes outside of blocks.",          "DEF va fuera de los bloques."),
    Problem("TAKEN",         "This name is used for another thing.", "Este nombre ya es otra cosa."),
    Problem("LIMIT",         "Too many or too deep.",                "Son demasiados, o muy adentro."),
    Problem("FULL",          "Program too long. Make it shorter.",   "Programa muy largo. Hazlo corto."),
)
# fmt: on

NAMES = {number: problem.name for number, problem in enumerate(PROBLEMS, 1)}
