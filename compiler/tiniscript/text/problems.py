"""What a robot that reads text says: about a wrong line, and to a person.

Knows numbers, names and words in both languages. Generated into the firmware, which has room for
one language. A number is never used for something else. Texts are ASCII, for any terminal.
"""

from __future__ import annotations

from typing import NamedTuple

LONGEST = 40  # characters of a text


class Problem(NamedTuple):
    """`english` and `spanish` say what is wrong, or what to try.

    In front of them stands a column; of RANGE, the number and the least that goes there, and behind
    it the most.
    """

    name: str
    english: str
    spanish: str


# fmt: off
PROBLEMS = (  # by number, from 1
    Problem("CHECKSUM",       "Line damaged. Send it again",  "Linea danada. Enviala de nuevo"),
    Problem("CHARACTER",      "Unknown sign",                 "Signo desconocido"),
    Problem("NUMBER",         "Write it like 5 or 0.5",       "Escribelo como 5 o 0.5"),
    Problem("TOO_BIG",        "Max is 2147483.647",           "Lo maximo es 2147483.647"),
    Problem("SETUP",          "SI| or SB| goes first",        "SI| o SB| va al principio"),
    Problem("PING",           "PING|CHECK_CONNECTION alone",  "PING|CHECK_CONNECTION solo"),
    Problem("INSTRUCTION",    "Begin with a word like F",     "Empieza con algo como F"),
    Problem("UNKNOWN_WORD",   "Unknown word",                 "Palabra desconocida"),
    Problem("UNKNOWN_VALUE",  "No value yet. Write X = 0",    "Sin valor. Escribe X = 0"),
    Problem("RESERVED",       "This word cannot go here",     "Esta palabra no va aqui"),
    Problem("SEPARATOR",      "Put ; before this",            "Pon ; antes de esto"),
    Problem("OPEN",           "Put ( before this",            "Pon ( antes de esto"),
    Problem("CLOSE",          "Check the ( and )",            "Revisa los ( y )"),
    Problem("VALUE",          "A value is missing",           "Falta un valor"),
    Problem("COUNT",          "Too many or too few values",   "Sobran o faltan valores"),
    Problem("RANGE",          " to ",                         " a "),  # between the two ends
    Problem("WANTS_NUMBER",   "Needs a number",               "Debe ser un numero"),
    Problem("WANTS_YES_NO",   "Ask, like DISTANCE < 10",      "Pregunta: DISTANCE < 10"),
    Problem("COMPARE",        "Compare 2 values of one kind", "Compara 2 del mismo tipo"),
    Problem("NOT",            "Write (NOT X)",                "Escribe (NOT X)"),
    Problem("KIND",           "Keep it a number, or yes/no",  "Que siga numero, o si/no"),
    Problem("FOREVER_HERE",   "Only in LOOP, or with UNTIL",  "Solo en LOOP, o con UNTIL"),
    Problem("UNTIL",          "UNTIL goes after F B L R W",   "UNTIL va tras F B L R W"),
    Problem("BLOCK",          "First open a block",           "Antes abre un bloque"),
    Problem("BREAK",          "BREAK goes in a loop",         "BREAK va en un bucle"),
    Problem("DEF",            "DEF goes outside blocks",      "DEF va fuera de bloques"),
    Problem("TAKEN",          "This name is taken",           "Es nombre de otra cosa"),
    Problem("LIMIT",          "Too many, or too deep",        "Demasiado, o muy adentro"),
    Problem("FULL",           "Too long. Make it shorter",    "Muy largo. Hazlo mas corto"),
    Problem("LACKS",          "This robot cannot read it",    "Este robot no lo lee"),
    Problem("COMMA",          "Put , before this",            "Pon , antes de esto"),
)
# fmt: on

NAMES = {number: problem.name for number, problem in enumerate(PROBLEMS, 1)}


class Remark(NamedTuple):
    """`english` and `spanish` are the text. Where it is empty, the firmware makes it."""

    name: str
    english: str
    spanish: str


# fmt: off
REMARKS = (  # in the order of their numbers
    Remark("OK",        "OK",                               "OK"),
    Remark("OK_BUTTON", "OK. The button starts it.",        "OK. El boton lo inicia."),
    Remark("OK_LOST",   "OK. The old program is lost.",     "OK. El programa anterior se perdio."),
    Remark("WAITING",   "Waiting for ",                     "Espero "),
    Remark("GIVEN_UP",  "Too late. Begin again.",           "Muy tarde. Empieza otra vez."),
    Remark("STOPPED",   "STOPPED",                          "DETENIDO"),
    Remark("LATCHED",   "It was stopped. Begin with SI|",   "Esta detenido. Empieza con SI|"),
    Remark("SAVING",    "Still saving. Send it again.",     "Aun guardo. Envialo otra vez."),
    Remark("REFUSED",   "Not possible here.",               "Aqui no es posible."),
    Remark("NOT_OWNER", "Owned: tsc text on, or button 2 s.", "Con dueno: tsc text on, o boton 2s"),
    Remark("HELD_BACK", "The teacher stopped it.",          "Lo detuvo el docente."),
    Remark("DONE",      "DONE",                             "FIN"),
    Remark("FAULT",     "FAULT ",                           "FALLA "),
    Remark("MISTAKE",   "",                                 ""),  # the column and the problem
    Remark("HELLO",     ", kit ",                           ", kit "),  # between name and kit
    Remark("HELP",      "",                                 ""),  # the words of this robot
    Remark("CUT",       "Bytes were lost. Begin again.",    "Se perdio algo. Empieza otra vez."),
    Remark("LEVEL_UNO", ", text uno",                       ", text uno"),  # behind the kit
    Remark("LEVEL_MEGA", ", text mega",                     ", text mega"),
    Remark("LEVEL_ESP32", ", text esp32",                   ", text esp32"),
    Remark("FAILED",    "It had a fault. Begin with SI|",   "Hubo una falla. Empieza con SI|"),
    Remark("MUTE",      "Too many. Wait 5 s.",              "Son muchos. Espera 5 s."),  # mistakes
)
# fmt: on
