"""The table of words: what each word of the language is, and which arguments it takes.

Knows names, argument counts, ranges and units. Does not know how they are compiled. Ranges
are thousandths. The words of a kit (its sensors and actuators) come from `kit`, not from here.
`Speller` finds the word that a misspelt one was meant to be; it knows how Spanish sounds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache, lru_cache
from typing import NamedTuple

from tiniscript.fixed_point import HIGHEST, LOWEST

# Roles of instructions: these have values in brackets, and STOP does something, too. A new role of a
# word that does something is a name here.
CALLS = frozenset(("move", "wait", "motors", "beep", "show"))
INSTRUCTIONS = CALLS | {"stop", "fixed"}


class Argument(NamedTuple):
    """What an argument means, and what a plain number there may be."""

    name: str
    unit: str
    low: int = LOWEST
    high: int = HIGHEST
    sample: str = "1"


class Word(NamedTuple):
    """A word with the role `fixed` stands for an instruction with its values, `BEEP(0.5, 440)`.

    `says` is what the poster and its block say that it does, in English and Spanish.
    """

    text: str
    role: str
    arguments: tuple[Argument, ...] = ()
    stands_for: str = ""
    says: tuple[str, str] = ("", "")

    @property
    def is_call(self) -> bool:
        """Whether it is an instruction with values in brackets."""
        return self.role in CALLS

    @property
    def is_instruction(self) -> bool:
        """Whether a robot does something at it."""
        return self.role in INSTRUCTIONS

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
QUESTION = Argument("c", "", sample="DISTANCE < 10")
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
    Word("UNTIL", "until", (QUESTION,)), Word("FOREVER", "forever"),
    Word("IF", "block", (QUESTION,)), Word("ELSEIF", "arm", (QUESTION,)), Word("ELSE", "arm"),
    Word("ENDIF", "end"),
    Word("LOOP", "block", (Argument("n", "", sample="3"),)), Word("END_LOOP", "end"),
    Word("WHILE", "block", (Argument("c", "", sample="DISTANCE > 10"),)), Word("END_WHILE", "end"),
    Word("BREAK", "break"),
    Word("DEF", "block"), Word("END_DEF", "end"),
    Word("TASK", "block"), Word("END_TASK", "end"),
    Word("WHEN", "block", (Argument("c", "", sample="DISTANCE < 15"),)), Word("END_WHEN", "end"),
    Word("TRUE", "value"), Word("FALSE", "value"), Word("TIME", "value"),
    Word("AND", "operator"), Word("OR", "operator"), Word("NOT", "operator"),
    Word("ROUND", "function", (VALUE, Argument("decimals", ""))),
    Word("ABS", "function", (A,)), Word("MIN", "function", (A, B)), Word("MAX", "function", (A, B)),
    Word("RANDOM", "function", (LOW, HIGH)),
    Word("END_IF", "alias"), Word("ENDLOOP", "alias"), Word("ENDWHILE", "alias"), Word("ENDDEF", "alias"),
    Word("ENDTASK", "alias"), Word("ENDWHEN", "alias"),
    Word("SEND", "later"),
)}

FUNCTIONS = tuple(word.text for word in WORDS.values() if word.role == "function")
ALIASES = {
    "END_IF": "ENDIF", "ENDLOOP": "END_LOOP", "ENDWHILE": "END_WHILE", "ENDDEF": "END_DEF",
    "ENDTASK": "END_TASK", "ENDWHEN": "END_WHEN",
}
BLOCK_ENDS = {
    "IF": "ENDIF", "LOOP": "END_LOOP", "WHILE": "END_WHILE", "DEF": "END_DEF",
    "TASK": "END_TASK", "WHEN": "END_WHEN",
}
TASKS = ("TASK", "WHEN")  # blocks that run beside the rest of the program

# How other languages, and Spanish, say it. Used for messages alone: none of them is read.
OTHER_WORDS = {
    "F": "ADE ADEL FORWARD FWD FD AHEAD GO MOVE WALK ADELANTE AVANZAR AVANZA AVANCE ADELANTA CAMINAR CAMINA ANDAR ANDA CORRER CORRE"
         " MOVER MUEVE MUEVETE DERECHO RECTO STRAIGHT FRENTE SIGUE SIGA SEGUIR KEEP DRIVE",
    "B": "ATR BACKWARD BACKWARDS BACK BK REVERSE ATRAS RETROCEDER RETROCEDE REVERSA REGRESA REGRESAR BACK_UP",
    "L": "LEFT LT TURN_LEFT IZQUIERDA IZQ GIRAR_IZQUIERDA",
    "R": "RIGHT RT TURN_RIGHT DERECHA DER GIRAR_DERECHA",
    "S": "HALT FREEZE BRAKE PARAR PARA PARE ALTO DETENER DETENTE FRENAR FRENA DETEN PARATE QUIETO",
    "W": "WAIT DELAY SLEEP PAUSE ESPERAR ESPERA PAUSA PAUSAR DORMIR DUERME",
    "M": "MOTOR MOTORS MOTORES",
    "BEEP": "BIP PIP BOCINA ZUMBADOR ALARMA CLAXON TONE BUZZ BUZZER SOUND PITAR PITA PITO PITIDO SONAR SUENA TOCAR TOCA SONIDO TONO",
    "SHOW": "ENSENA ENSENIA PRINT PRINTLN PRINTF WRITE SAY DISPLAY ECHO LOG MOSTRAR MUESTRA IMPRIMIR IMPRIME DECIR DI ESCRIBIR ESCRIBE",
    "START": "INICIO BEGIN COMENZAR COMIENZO EMPEZAR EMPIEZA INICIAR VOID_SETUP",
    "IF": "SI_ES CUANDO UNLESS A_MENOS_QUE SALVO EXCEPTO",
    "ELSEIF": "ELIF ELSIF SINO_SI",
    "ELSE": "SINO SI_NO OTHERWISE OTRO DE_LO_CONTRARIO",
    "ENDIF": "FI FIN_SI FINSI FIN_IF FINIF IF_END",
    "END_WHEN": "FIN_CUANDO FINCUANDO",
    "LOOP": "REPEAT FOR DO TIMES REPETIR REPITE BUCLE CICLO PARA_CADA VECES",
    "END_LOOP": "FIN_BUCLE FIN_LOOP FINLOOP FIN_REPETIR FINREPETIR FIN_REPITE FIN_CICLO FIN_PARA FINPARA"
                " END_REPEAT ENDREPEAT END_FOR ENDFOR LOOP_END NEXT SIGUIENTE END_FOREVER ENDFOREVER FIN_FOREVER FIN_SIEMPRE"
                " FINSIEMPRE",
    "WHILE": "MIENTRAS",
    "END_WHILE": "FIN_MIENTRAS FINMIENTRAS FIN_WHILE FINWHILE WHILE_END WEND",
    "FOREVER": "SIEMPRE INFINITO PARA_SIEMPRE POR_SIEMPRE VOID_LOOP",
    "BREAK": "EXIT LEAVE SALIR ROMPER",
    "DEF": "DEFINE DEFINIR FUNCTION PROCEDURE SUB FUNCION PROCEDIMIENTO",
    "END_DEF": "END_FUNCTION FIN_FUNCION FINFUNCION FIN_DEF FINDEF DEF_END END_SUB",
    "UNTIL": "HASTA HASTA_QUE",
    "TRUE": "YES VERDADERO CIERTO",
    "FALSE": "NO FALSO",
    "RANDOM": "RAND RANDINT AZAR ALEATORIO DADO",
    "ROUND": "REDONDEAR",
    "TIME": "MILLIS TIMER TIEMPO",
    "BUTTON": "BOTON PULSADOR",
    "DISTANCE": "DISTANCIA ULTRASONIDO ULTRASONICO ULTRASONIC",
    "LIGHT_R": "LUZ_D LUZ_DERECHA LIGHT_RIGHT",
    "LIGHT_L": "LUZ_I LUZ_IZQUIERDA LIGHT_LEFT",
}

# How who has Spanish in the ear spells a word of the language: LOOP, SHOW, WHILE, FOREVER.
HEARD_WORDS = {
    "LOOP": "LUP LUUP LUB",
    "END_LOOP": "END_LUP ENDLUP EN_LUP ENLUP EN_LOOP ENLOOP FIN_LUP",
    "SHOW": "SHOU CHOU CHOW CHO XOU SOU",
    "WHILE": "UAIL GUAIL GUAIEL WAIL HUAIL JUAIL UAIEL WUAIL",
    "END_WHILE": "END_WAIL END_GUAIL END_UAIL ENDWAIL ENDGUAIL ENDUAIL",
    "ELSE": "EL_SE ELS_E",
    "ENDIF": "EN_IF ENIF",
    "END_DEF": "ENDEF EN_DEF",
    "BREAK": "BREC BREIC BREK",
    "START": "ESTAR ESTARD",
    "BEEP": "VIIP BIIP BIPP",
    "FOREVER": "FOREBER FOREVE FOREBE FOR_EVER FOR_EBER FOREVERR FORREVER FOREVA",
    "TIME": "TAIM TAIN TAIME",
    "TRUE": "TRU TRUU",
    "FALSE": "FALS FOLS FALCE",
    "RANDOM": "RANDON RAMDOM RAMDON RANDUM RANDOMM",
    "ROUND": "RAUND RAUN ROUN",
    "LIGHT_R": "LAIT_R LIGTH_R LIGH_R",
    "LIGHT_L": "LAIT_L LIGTH_L LIGH_L",
}

# The sensor of which a robot has a left and a right one.
SENSOR_STEMS = {"LUZ": "LIGHT", "LINEA": "LINE"}

# What no single word says here: which way to turn, and what to switch on or off.
TURN_WORDS = frozenset(["TURN", "ROTATE", "SPIN", "GIRAR", "GIRA", "GIRO", "ROTAR", "ROTA", "VOLTEAR", "VOLTEA", "VOLTEAS", "VOLTEE", "GIRE", "GIRAS", "DOBLAR", "DOBLA", "DOBLAS"])
SWITCH_WORDS = {
    **dict.fromkeys(["TURN_ON", "SWITCH_ON", "PRENDER", "PRENDE", "ENCENDER", "ENCIENDE"], "TRUE"),
    **dict.fromkeys(["TURN_OFF", "SWITCH_OFF", "APAGAR", "APAGA"], "FALSE"),
}

# What a pupil asks for, where a robot measures how far something is.
OTHER_WAY = {"F": "B", "B": "F", "L": "R", "R": "L"}  # the moves, and those that undo them
NEAR_WORDS = frozenset(
    "OBSTACULO OBSTACLE PARED WALL MURO OBJETO OBJECT CERCA NEAR CHOCA CHOQUE COLISION CERRADO BLOCKED".split()  # noqa: SIM905
)
# What a robot may have, and what nobody calls a variable.
DEVICE_WORDS = frozenset(["LED", "LUZ", "FOCO", "LIGHT", "LAMP", "LAMPARA", "SERVO", "BUZZER", "ZUMBADOR", "BOCINA", "ALARMA", "MOTOR", "MOTORES", "GRIPPER", "GARRA", "PINZA", "PANTALLA", "LCD", "SCREEN"])

# Commands of other languages whose time is in milliseconds.
IN_MILLISECONDS = frozenset(["DELAY"])
# What other languages do, and this one does not: pins, jumps, clocks. What the robot knows instead.
NOT_DONE = {
    **dict.fromkeys(("DIGITALWRITE", "ANALOGWRITE", "PINMODE", "DIGITALREAD", "ANALOGREAD", "PIN"), "pins"),
    **dict.fromkeys(("CADA", "EVERY"), "every"),
    **dict.fromkeys(("GOTO", "GOSUB", "JUMP", "SALTA", "SALTAR", "IRA", "IR_A"), "jump"),
}
_INSTEAD = {"pins": "F(2, 80)", "jump": "LOOP(FOREVER)", "every": "LOOP(FOREVER)", "motors": "M(50, 50)"}


def said_instead(word: str) -> dict[str, str]:
    """Return what a message says of a word of another language that has no like here."""
    kind = "motors" if word.startswith("MOTOR") else NOT_DONE.get(word, "")
    return {kind: _INSTEAD[kind]} if kind else {}


# What documents write for a value, and pupils copy.
PLACEHOLDERS = {
    "time": ("TIME", "TIEMPO", "T"), "seconds": ("SECONDS", "SEGUNDOS", "TIME", "TIEMPO"),
    "power": ("POWER", "POTENCIA", "P"), "left": ("LEFT", "IZQUIERDA"), "right": ("RIGHT", "DERECHA"),
    "hertz": ("HERTZ", "HERCIOS", "HZ"),
}
# How pupils name a value, beside its placeholders: `F(t=2, vel=80)`.
_OTHER_NAMES = {
    "time": ("SECONDS", "SEGUNDOS", "SEG", "DURACION", "DURATION"),
    "seconds": ("T", "SEG", "DURACION", "DURATION"),
    "hertz": ("FRECUENCIA", "FREQUENCY", "FREQ", "TONO", "TONE", "NOTA", "NOTE"),
    "power": ("VEL", "VELOCIDAD", "SPEED", "V", "FUERZA", "POT"),
}

# Words that have a meaning elsewhere in this table, and are no misspelt ones.
_KNOWN_OTHERWISE = frozenset(("CONTINUE", "CONTINUA", "CONTINUAR", *TURN_WORDS, *SWITCH_WORDS, *SENSOR_STEMS, *NOT_DONE))

# Numbers in words, of what programs often say.
NUMBER_WORDS = {name: str(value) for value, names in (
    (1, "ONE UNO UN UNA"), (2, "TWO DOS"), (3, "THREE TRES"), (4, "FOUR CUATRO"), (5, "FIVE CINCO"),
    (6, "SIX SEIS"), (7, "SEVEN SIETE"), (8, "EIGHT OCHO"), (9, "NINE NUEVE"), (10, "TEN DIEZ"),
    (20, "TWENTY VEINTE"), (30, "THIRTY TREINTA"), (40, "FORTY CUARENTA"), (50, "FIFTY CINCUENTA"),
    (60, "SIXTY SESENTA"), (70, "SEVENTY SETENTA"), (80, "EIGHTY OCHENTA"), (90, "NINETY NOVENTA"),
    (100, "HUNDRED CIEN"),
) for name in names.split()}

# How much power a word says, where a power is wanted, and how high the notes of a song sound.
POWER_WORDS = {name: str(value) for value, names in (
    (100, "ALTA MAX MAXIMO MAXIMA FULL HIGH FAST RAPIDO RAPIDA RAPIDAMENTE FUERTE TODO TODA"),
    (80, "NORMAL"), (50, "MEDIO MEDIA HALF MEDIUM MITAD"), (40, "SLOW LENTO LENTA DESPACIO DESPACITO LENTAMENTE"),
) for name in names.split()}
# How much, in words that are no number.
AMOUNT_WORDS = frozenset((
    "MAS", "MENOS", "POCO", "POCA", "POQUITO", "POQUITITO", "MUCHO", "MUCHA", "MUCHOS", "MUCHAS",
    "VARIOS", "VARIAS", "RATO", "RATITO", "MOMENTO", "MOMENTITO", "ALGO", "BASTANTE", "TANTO",
    "TANTAS", "UNOS", "UNAS", "MUY", "DEMASIADO", "AGUDO", "GRAVE", "MORE", "LESS", "LITTLE",
    "MUCH", "MANY", "SOME", "BIT", "MOMENT", "VERY", "SEVERAL",
))
NOTE_WORDS = {"DO": "262", "RE": "294", "MI": "330", "FA": "349", "SOL": "392", "LA": "440",
              "C4": "262", "D4": "294", "E4": "330", "F4": "349", "G4": "392", "A4": "440", "B4": "494", "C5": "523"}

# What people write behind a number, which has none here: the unit that is meant, and how many
# thousandths of it one is.
UNITS = {name: (unit, thousandths) for unit, thousandths, names in (
    ("s", 1000, "S SEC SECS SECOND SECONDS SEG SEGS SEGUNDO SEGUNDOS"),
    ("s", 1, "MS MILISEGUNDO MILISEGUNDOS MILLISECOND MILLISECONDS"),
    ("s", 60_000, "MIN MINS MINUTO MINUTOS MINUTE MINUTES"), ("s", 3_600_000, "H HORA HORAS HOUR HOURS"),
    ("cm", 1000, "CM CMS CENTIMETRO CENTIMETROS CENTIMETER CENTIMETERS"),
    ("cm", 30_480, "FT FEET FOOT PIE PIES"), ("cm", 2540, "INCH INCHES PULGADA PULGADAS"),
    ("cm", 100, "MM MILIMETRO MILIMETROS"), ("cm", 100_000, "M MT MTS METRO METROS METER METERS"),
    ("Hz", 1000, "HZ HERTZ HERCIO HERCIOS"), ("°", 1000, "DEG DEGREE DEGREES GRADO GRADOS ° º"),
    ("%", 1000, "PERCENT PORCIENTO POTENCIA POWER %"), ("steps", 1000, "STEP STEPS PASO PASOS"),
    ("times", 1000, "VEZ VECES TIMES"), ("V", 1000, "V"), ("°C", 1000, "°C"),
) for name in names.split()}
# fmt: on


def usage_of(word: str) -> str:
    """Return how a word is used, as messages print it: `F(time, power)`; else the word."""
    return WORDS[word].usage if word in WORDS else word


def names_of(argument: str) -> tuple[str, ...]:
    """Return how pupils name a value of a call, `power`: POWER, POTENCIA, VEL."""
    return (*PLACEHOLDERS.get(argument, ()), *_OTHER_NAMES.get(argument, ()))


def meant_by(word: str) -> str | None:
    """Return the word of the language that `word` says in another one, or None.

    `word` may be misspelt: `ABANZA`, `FOWARD`.
    """
    return _meanings().get(word) or _misspelt(word)[0] or _meant_in_two(word)


def is_guessed(word: str) -> bool:
    """Whether `meant_by` takes a letter for another one: `DERECJA` for DERECHA."""
    return word not in _meanings() and _misspelt(word)[1]


@lru_cache(1000)
def _misspelt(word: str) -> tuple[str | None, bool]:
    """Return what a misspelt word of another language means, and whether that is a guess.

    A word that is rather a misspelt one of this language is left to `nearest`.
    """
    if word in WORDS or word in _KNOWN_OTHERWISE:
        return None, False
    found = _speller().alike(word)
    if found is not None:
        return _meanings().get(found), False
    guessed = _meanings().get(_speller().near(word) or "")
    return guessed, guessed is not None


# Who moves, in a name of two words, and what is done by one.
_WHO = frozenset("ROBOT CAR CARRO AUTO MOTOR MOTORS MOTORES IR".split())  # noqa: SIM905
_DOING = frozenset(("F", "B", "L", "R", "S", "BEEP"))


@lru_cache(1000)
def _meant_in_two(word: str) -> str | None:
    """Return what `moverAdelante` or `stopMotors` means: two words that say one command."""
    if word in WORDS or word in _KNOWN_OTHERWISE or len(word) > 24:
        return None
    for k in range(2, len(word) - 1):
        halves = word[:k].rstrip("_"), word[k:].lstrip("_")
        meant = {"S" if half == "STOP" else _meanings().get(half, "") for half in halves}
        said = meant - {"", "M", "F"} or meant - {"", "M"}
        is_framed = "F" in meant or any(half in _WHO for half in halves)
        is_turn = halves[0] in TURN_WORDS and said <= {"L", "R"}
        unknown = [half for half in halves if half not in _WHO and half not in TURN_WORDS]
        is_known = all(half == "STOP" or half in _meanings() for half in unknown)
        if is_known and (is_framed or is_turn) and len(said) == 1 and said <= _DOING:
            return said.pop()
    return None


@cache
def _speller() -> Speller:

    return Speller([*WORDS, *_KNOWN_OTHERWISE, *_meanings()])


@cache
def _meanings() -> dict[str, str]:
    tables = (OTHER_WORDS, HEARD_WORDS)
    rows = (row for table in tables for row in table.items())
    return {other: ours for ours, others in rows for other in others.split()}


def other_name(word: str) -> str:
    """Return a name that a variable or a DEF may have in place of a word of the language."""
    return word + "_1" if len(word) == 1 else "MY_" + word


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the word among `known` that a slip of the finger away is `word`, or None.

    A slip is a letter that is wrong, missing, doubled or exchanged with the next: one in short
    words, two in longer ones. A wrong suggestion is worse than none, so in a word of three
    letters no letter is taken for another.
    """
    if not 2 < len(word) <= 40:
        return None
    allowed = 1 if len(word) <= 5 else 2
    best, its_edits = None, allowed + 1
    for other in known:
        if len(other) > 1 and abs(len(other) - len(word)) <= allowed:
            edits = _edits(word, other)
            if edits == 1 and len(word) <= 3 and len(other) == len(word):
                edits += sorted(word) != sorted(other)
            if edits < its_edits:
                best, its_edits = other, edits
    return best


def _edits(one: str, other: str) -> int:
    """Return how many slips lead from one word to the other; an exchange of neighbours is one."""
    before_last: list[int] = []
    last = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        row = [i]
        for k, its in enumerate(other, 1):
            least = min(last[k] + 1, row[k - 1] + 1, last[k - 1] + (letter != its))
            if i > 1 and k > 1 and letter == other[k - 2] and its == one[i - 2]:
                least = min(least, before_last[k - 2] + 1)
            row.append(least)
        before_last, last = last, row
    return last[-1]


_ALIKE = 4  # letters that a word needs where only its sound is the same
_SWAPPED = 5  # … where two neighbours are exchanged
_SLIPPED = 6  # … where a letter is wrong, missing or too much
_LONGEST = 24


@cache
def _sounds() -> tuple[tuple[re.Pattern[str], str], ...]:
    """What sounds the same in Lima: the sign on the right stands for all that is on the left."""
    return tuple(
        (re.compile(pattern), sound)
        for pattern, sound in (
            ("CH", "9"), ("SH", "9"), ("X", "9"), ("H", ""), ("QU(?=[EI])", "K"),
            ("C(?=[EI])", "S"), ("[CQ]", "K"), ("Z", "S"), ("V", "B"), ("LL", "Y"),
            ("G(?=[EI])", "J"), (r"(.)\1", r"\1"),
        )
    )  # fmt: skip


class Speller:
    """The words that are looked for. A lookup takes the same time however many they are."""

    def __init__(self, words: Iterable[str]) -> None:
        self._by_sound: dict[str, str] = {}
        self._by_rest: dict[str, list[str]] = {}
        for word in words:
            if len(word) >= _ALIKE:
                self._by_sound.setdefault(_sound(word), word)
            if len(word) >= _SWAPPED:
                for rest in _rests(word):
                    self._by_rest.setdefault(rest, []).append(word)

    def alike(self, word: str) -> str | None:
        """Return the word that sounds like `word`, or None."""
        if not _ALIKE <= len(word) <= _LONGEST:
            return None
        return self._by_sound.get(_sound(word))

    def near(self, word: str) -> str | None:
        """Return a word that is one slip of the finger away from `word`, or None."""
        if not _SWAPPED <= len(word) <= _LONGEST or not word.isalpha():
            return None
        for rest in _rests(word):
            for other in self._by_rest.get(rest, ()):
                if _is_slip(word, other):
                    return other
        return None


def _sound(word: str) -> str:
    for pattern, sound in _sounds():
        word = pattern.sub(sound, word)
    return word


def _rests(word: str) -> Iterator[str]:
    """Give the word, and what is left of it without one of its letters."""
    yield word
    for k in range(len(word)):
        yield word[:k] + word[k + 1 :]


def _is_slip(one: str, other: str) -> bool:
    """Whether one letter is wrong, missing or too much, or two neighbours are exchanged."""
    k = 0
    while k < min(len(one), len(other)) and one[k] == other[k]:
        k += 1
    one, other = one[k:], other[k:]
    if len(one) == len(other) and one[:2] == other[1::-1] and one[2:] == other[2:]:
        return True
    if min(len(one), len(other)) + k < _SLIPPED:  # `AVNZA`: a vowel that nobody texts
        return len(other) + k >= _SLIPPED and other[:1] in tuple("AEIOU") and one == other[1:]
    return one[1:] in (other, other[1:]) or one == other[1:]
