"""The kinds of blocks: the page shows them and Python reads and writes them by this one table.

Knows what each kind says, in English and Spanish, and what goes into it; no page and no program.
`%1` and so on are where values go. A word of the text stands in braces: on a block it is seen where
somebody wants it, of `{IF} if %1` as `IF %1`. `python -m tools.builds.studio` gives the page the table.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tiniscript.words import UNIT_OF, WORDS

Both = tuple[str, str]  # in English and Spanish


class Kind(NamedTuple):
    """`colour` is a style of the page. A value is `number`, `truth` or `any`.

    `field` is what is written in it: `name`, `line`, `sensor` or `actuator`; `words` are the words
    to choose from instead. `gives` is what a block gives that is a value. `tip` says what it does.
    """

    name: str
    colour: str
    says: Both
    values: tuple[str, ...] = ()
    bodies: int = 0
    gives: str = ""
    field: str = ""
    words: tuple[str, ...] = ()
    tip: Both = ("", "")


# fmt: off
BARE, TRIPLE = ("%1", "%1"), ("%1 %2 %3", "%1 %2 %3")
MOVES = tuple(UNIT_OF)
WAYS = tuple(f"{word} {unit}" for word, unit in UNIT_OF.items())
_FIXED = {
    word.text: (f"{{{word.text}}} {word.says[0]}", f"{{{word.text}}} {word.says[1]}")
    for word in WORDS.values() if word.stands_for
}

KINDS = {kind.name: kind for kind in (
    Kind("move", "move", ("%1 %2 s at %3 %%", "%1 %2 s al %3 %%"), ("number", "number"), words=MOVES, tip=("The robot drives or turns: how long, in seconds, and with how much power, from 0 to 100 %.", "El robot avanza o gira: cuánto tiempo, en segundos, y con cuánta potencia, de 0 a 100 %.")),
    Kind("move_until", "move", ("%1 %2 s at %3 %%, or until %4", "%1 %2 s al %3 %%, o hasta que %4"), ("number", "number", "truth"), words=MOVES, tip=("The move ends when its time is over, or as soon as this is true.", "El movimiento termina cuando se acaba su tiempo, o en cuanto esto se cumple.")),
    Kind("go", "move", ("%1 %2 at %3 %%", "%1 %2 al %3 %%"), ("number", "number"), words=WAYS, tip=("The robot goes so many centimetres, or turns so many degrees, with so much power, from 0 to 100 %.", "El robot avanza esos centímetros, o gira esos grados, con esa potencia, de 0 a 100 %.")),
    Kind("go_until", "move", ("%1 %2 at %3 %%, or until %4", "%1 %2 al %3 %%, o hasta que %4"), ("number", "number", "truth"), words=WAYS, tip=("The move ends when the robot is there, or as soon as this is true.", "El movimiento termina cuando el robot llega, o en cuanto esto se cumple.")),
    Kind("wait", "time", ("{W} wait %1 s", "{W} espera %1 s"), ("number",), tip=("Nothing changes for so long.", "Nada cambia durante ese tiempo.")),
    Kind("wait_until", "time", ("{W} wait %1 s, or until %2", "{W} espera %1 s, o hasta que %2"), ("number", "truth"), tip=("Waits until this is true, and at most so long.", "Espera hasta que esto se cumpla, y como máximo ese tiempo.")),
    Kind("motors", "move", ("{M} motors: left %1 %%, right %2 %%", "{M} motores: izquierdo %1 %%, derecho %2 %%"), ("number", "number"), tip=("Sets both motors, from -100 to 100 %, and goes on at once.", "Pone los dos motores, de -100 a 100 %, y sigue enseguida.")),
    Kind("stop", "stop", ("{S} stop", "{S} detente"), tip=("The robot stops.", "El robot se detiene.")),
    Kind("start", "others", ("{START} beginning", "{START} inicio"), tip=("Does nothing: it names the beginning.", "No hace nada: solo marca el comienzo.")),
    Kind("beep", "time", ("{BEEP} beep %1 s at %2 Hz", "{BEEP} pita %1 s a %2 Hz"), ("number", "number"), tip=("The buzzer sounds; more hertz are higher.", "Suena el zumbador; con más hercios, más agudo.")),
    Kind("show", "time", ("{SHOW} show %1", "{SHOW} muestra %1"), ("any",), tip=("Sends a value to the computer or phone.", "Envía un valor a la computadora o al teléfono.")),
    Kind("fixed", "time", BARE, words=tuple(_FIXED)),
    Kind("read", "sensors", ("measure %1 now", "mide %1 ahora"), field="sensor", tip=("Takes a reading, which counts from now on.", "Toma una medida, que vale desde ahora.")),
    Kind("set", "sensors", ("set %1 to %2", "pon %1 en %2"), ("any",), field="actuator", tip=("Sets what the robot has: a gripper, a lamp.", "Mueve o enciende lo que tiene el robot: una pinza, una lámpara.")),
    Kind("call", "words", ("do %1", "haz %1"), field="name", tip=("Does what the word of your own says.", "Hace lo que dice tu palabra.")),
    Kind("assign", "names", ("%1 = %2", "%1 = %2"), ("any",), field="name", tip=("Keeps a value under a name.", "Guarda un valor con un nombre.")),
    Kind("if", "control", ("{IF} if %1", "{IF} si %1"), tip=("Does what is inside only if this is true.", "Hace lo que está adentro solo si esto se cumple.")),
    Kind("loop", "control", ("{LOOP} repeat %1 times", "{LOOP} repite %1 veces"), ("number",), bodies=1, tip=("Does what is inside so many times.", "Hace lo que está adentro ese número de veces.")),
    Kind("forever", "control", ("{LOOP} repeat forever", "{LOOP} repite para siempre"), bodies=1, tip=("Does what is inside again and again.", "Hace lo que está adentro una y otra vez.")),
    Kind("while", "control", ("{WHILE} repeat while %1", "{WHILE} repite mientras %1"), ("truth",), bodies=1, tip=("Does what is inside as long as this is true.", "Hace lo que está adentro mientras esto se cumpla.")),
    Kind("break", "control", ("{BREAK} leave the loop", "{BREAK} sal de la repetición"), tip=("Leaves the innermost loop.", "Sale de la repetición más cercana.")),
    Kind("def", "words", ("{DEF} new word %1", "{DEF} palabra nueva %1"), bodies=1, field="name", tip=("A word of your own: put in what it does, and use it below.", "Una palabra tuya: pon adentro lo que hace, y úsala más abajo.")),
    Kind("task", "control", ("{TASK} at the same time", "{TASK} al mismo tiempo"), bodies=1, tip=("Does what is inside at the same time as the rest of the program.", "Hace lo que está adentro al mismo tiempo que el resto del programa.")),
    Kind("when", "control", ("{WHEN} each time %1", "{WHEN} cada vez que %1"), ("truth",), bodies=1, tip=("Looks again and again while the rest of the program runs, and does what is inside each time this is true.", "Mira una y otra vez mientras el resto del programa sigue, y hace lo que está adentro cada vez que esto se cumple.")),
    Kind("comment", "others", ("{//} note: %1", "{//} nota: %1"), field="line", tip=("A note for people; the robot does not read it.", "Una nota para las personas; el robot no la lee.")),
    Kind("grey", "grey", BARE, field="line", tip=("The compiler does not understand this line. Change it here or in the text.", "El compilador no entiende esta línea. Cámbiala aquí o en el texto.")),
    Kind("number", "numbers", BARE, gives="number"),
    Kind("name", "names", BARE, gives="any", field="name"),
    Kind("sensor", "sensors", BARE, gives="any", field="sensor"),
    Kind("truth", "decide", BARE, gives="truth", words=("TRUE", "FALSE")),
    Kind("time", "time", ("{TIME} seconds so far", "{TIME} segundos transcurridos"), gives="number"),
    Kind("endless", "time", ("{FOREVER} without end", "{FOREVER} sin fin"), gives="number"),
    Kind("math", "numbers", TRIPLE, ("number", "number"), gives="number"),
    Kind("compare", "decide", TRIPLE, ("any", "any"), gives="truth"),
    Kind("logic", "decide", TRIPLE, ("truth", "truth"), gives="truth"),
    Kind("not", "decide", ("{NOT} not %1", "{NOT} no %1"), ("truth",), gives="truth"),
    Kind("negative", "numbers", ("− %1", "− %1"), ("number",), gives="number"),
    Kind("brackets", "numbers", ("( %1 )", "( %1 )"), ("any",), gives="any"),
    Kind("round", "numbers", ("{ROUND} round %1 to %2 decimals", "{ROUND} redondea %1 a %2 decimales"), ("number", "number"), gives="number"),
    Kind("abs", "numbers", ("{ABS} %1 without minus", "{ABS} %1 sin menos"), ("number",), gives="number"),
    Kind("extreme", "numbers", ("%1 of %2 and %3", "%1 de %2 y %3"), ("number", "number"), gives="number", words=("MIN", "MAX")),
    Kind("random", "numbers", ("{RANDOM} random from %1 to %2", "{RANDOM} al azar de %1 a %2"), ("number", "number"), gives="number"),
)}

# What stands on a word to choose, and on parts of blocks.
LABELS: dict[str, Both] = {
    **_FIXED,
    "program": BARE,
    "SI": ("{SI} when it starts", "{SI} al empezar"),
    "SB": ("{SB} when its button is pressed", "{SB} al pulsar su botón"),
    "PING": ("{PING} is the robot there?", "{PING} ¿está el robot?"),
    "F": ("{F} forward", "{F} avanza"),
    "B": ("{B} back", "{B} retrocede"),
    "L": ("{L} turn left", "{L} gira a la izquierda"),
    "R": ("{R} turn right", "{R} gira a la derecha"),
    "F CM": ("{F CM} forward, in cm:", "{F CM} avanza, en cm:"),
    "B CM": ("{B CM} back, in cm:", "{B CM} retrocede, en cm:"),
    "L DEG": ("{L DEG} turn left, in degrees:", "{L DEG} gira a la izquierda, en grados:"),
    "R DEG": ("{R DEG} turn right, in degrees:", "{R DEG} gira a la derecha, en grados:"),
    "elseif": ("{ELSEIF} else, if %1", "{ELSEIF} si no, si %1"),
    "else": ("{ELSE} else", "{ELSE} si no"),
    "TRUE": ("{TRUE} yes", "{TRUE} sí"),
    "FALSE": ("{FALSE} no", "{FALSE} no"),
    "AND": ("{AND} and", "{AND} y"),
    "OR": ("{OR} or", "{OR} o"),
    "MIN": ("{MIN} the smaller", "{MIN} el menor"),
    "MAX": ("{MAX} the larger", "{MAX} el mayor"),
}

TIPS: dict[str, Both] = {
    "program": ("When the program starts. Hang the blocks below it.", "Cuándo empieza el programa. Cuelga los bloques debajo."),
    "more": ("Add a case", "Agregar un caso"),
    "less": ("Take the last case away", "Quitar el último caso"),
    **{kind.name: kind.tip for kind in KINDS.values() if kind.tip[0]},
}
# fmt: on


def data() -> dict[str, Any]:
    """Return the table as data for JSON."""
    said = ("name", "says", "tip")  # as labels and tips
    return {
        "kinds": {
            name: {key: value for key, value in kind._asdict().items() if key not in said}
            for name, kind in KINDS.items()
        },
        "labels": {**LABELS, **{kind.name: kind.says for kind in KINDS.values()}},
        "tips": TIPS,
    }
