"""The table of words: what each word of the language is, and which arguments it takes.

Knows names, argument counts, ranges and units. Does not know how they are compiled. Ranges
are thousandths. The words of a kit (its sensors and actuators) come from `kit`, not from here.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.thousandths import HIGHEST, LOWEST


class Argument(NamedTuple):
    """What an argument means, and what a plain number there may be."""

    name: str
    unit: str
    low: int = LOWEST
    high: int = HIGHEST
    sample: str = "1"


class Word(NamedTuple):
    text: str
    role: str
    arguments: tuple[Argument, ...] = ()

    @property
    def usage(self) -> str:
        """`F(time, power)`, as messages print it."""
        names = ", ".join(argument.name for argument in self.arguments)
        return f"{self.text}({names})" if names else self.text

    @property
    def example(self) -> str:
        """`F(2, 80)`, as messages suggest it."""
        samples = ", ".join(argument.sample for argument in self.arguments)
        return f"{self.text}({samples})" if samples else self.text


# fmt: off
SECONDS = Argument("seconds", "s", 0)
TIME = Argument("time", "s", 0, sample="2")
POWER = Argument("power", "%", 0, 100_000, "80")
LEFT = Argument("left", "%", -100_000, 100_000, "50")
RIGHT = Argument("right", "%", -100_000, 100_000, "80")
HERTZ = Argument("hertz", "Hz", 31_000, 20_000_000, "440")
VALUE = Argument("value", "", sample="DISTANCE")
A, B = Argument("a", "", sample="5"), Argument("b", "", sample="DISTANCE")
LOW, HIGH = Argument("low", "", sample="1"), Argument("high", "", sample="6")

WORDS = {word.text: word for word in (
    Word("PING", "setup"), Word("SI", "setup"), Word("SB", "setup"), Word("CHECK_CONNECTION", "setup"),
    Word("F", "move", (TIME, POWER)), Word("B", "move", (TIME, POWER)),
    Word("L", "move", (TIME, POWER)), Word("R", "move", (TIME, POWER)),
    Word("W", "wait", (SECONDS,)),
    Word("M", "motors", (LEFT, RIGHT)),
    Word("S", "stop"), Word("STOP", "stop"), Word("START", "start"),
    Word("BEEP", "beep", (SECONDS, HERTZ)),
    Word("SHOW", "show", (VALUE,)),
    Word("UNTIL", "until"), Word("FOREVER", "forever"),
    Word("IF", "block"), Word("ELSEIF", "arm"), Word("ELSE", "arm"), Word("ENDIF", "end"),
    Word("LOOP", "block"), Word("END_LOOP", "end"),
    Word("WHILE", "block"), Word("END_WHILE", "end"), Word("BREAK", "break"),
    Word("DEF", "block"), Word("END_DEF", "end"),
    Word("TRUE", "value"), Word("FALSE", "value"), Word("TIME", "value"),
    Word("AND", "operator"), Word("OR", "operator"), Word("NOT", "operator"),
    Word("ROUND", "function", (VALUE, Argument("decimals", ""))),
    Word("ABS", "function", (A,)), Word("MIN", "function", (A, B)), Word("MAX", "function", (A, B)),
    Word("RANDOM", "function", (LOW, HIGH)),
    Word("END_IF", "alias"), Word("ENDLOOP", "alias"), Word("ENDWHILE", "alias"), Word("ENDDEF", "alias"),
    Word("TASK", "later"), Word("END_TASK", "later"), Word("WHEN", "later"), Word("END_WHEN", "later"),
    Word("SEND", "later"),
)}

ALIASES = {"END_IF": "ENDIF", "ENDLOOP": "END_LOOP", "ENDWHILE": "END_WHILE", "ENDDEF": "END_DEF"}
BLOCK_ENDS = {"IF": "ENDIF", "LOOP": "END_LOOP", "WHILE": "END_WHILE", "DEF": "END_DEF"}

# How other languages, and Spanish, say it. Used for messages alone: none of them is read.
OTHER_WORDS = {
    "F": "FORWARD FWD FD AHEAD ADELANTE AVANZAR AVANZA AVANCE",
    "B": "BACKWARD BACKWARDS BACK BK REVERSE ATRAS RETROCEDER RETROCEDE",
    "L": "LEFT LT TURN_LEFT IZQUIERDA IZQ GIRAR_IZQUIERDA",
    "R": "RIGHT RT TURN_RIGHT DERECHA DER GIRAR_DERECHA",
    "S": "HALT PARAR PARA PARE ALTO DETENER DETENTE FRENAR",
    "W": "WAIT DELAY SLEEP PAUSE ESPERAR ESPERA PAUSA",
    "M": "MOTOR MOTORS MOTORES",
    "BEEP": "TONE BUZZ BUZZER SOUND PITAR PITO PITIDO SONAR SONIDO TONO",
    "SHOW": "PRINT SAY DISPLAY ECHO MOSTRAR MUESTRA IMPRIMIR IMPRIME DECIR",
    "IF": "SI_ES CUANDO",
    "ELSEIF": "ELIF ELSIF SINO_SI",
    "ELSE": "SINO SI_NO OTHERWISE",
    "ENDIF": "FI FIN_SI FINSI",
    "LOOP": "REPEAT FOR DO TIMES REPETIR REPITE BUCLE CICLO PARA_CADA VECES",
    "END_LOOP": "FIN_BUCLE FIN_REPETIR NEXT",
    "WHILE": "MIENTRAS",
    "FOREVER": "SIEMPRE INFINITO PARA_SIEMPRE",
    "BREAK": "EXIT LEAVE SALIR ROMPER",
    "DEF": "FUNCTION PROCEDURE SUB FUNCION PROCEDIMIENTO",
    "UNTIL": "HASTA HASTA_QUE",
    "TRUE": "YES VERDADERO CIERTO",
    "FALSE": "NO FALSO",
    "RANDOM": "RAND AZAR ALEATORIO",
    "ROUND": "REDONDEAR",
    "TIME": "MILLIS TIMER TIEMPO",
    "DISTANCE": "DISTANCIA",
    "LIGHT_R": "LUZ_D LUZ_DERECHA LIGHT_RIGHT",
    "LIGHT_L": "LUZ_I LUZ_IZQUIERDA LIGHT_LEFT",
}
# fmt: on


def meant_by(word: str) -> str | None:
    """Return the word of the language that `word` says in another one, or None."""
    for ours, others in OTHER_WORDS.items():
        if word in others.split():
            return ours
    return None


def nearest(word: str, known: list[str]) -> str | None:
    """Return the word among `known` that a typing slip away is `word`, or None."""
    from difflib import get_close_matches

    close = get_close_matches(word[:40], known, n=1, cutoff=0.6)
    return close[0] if close else None
