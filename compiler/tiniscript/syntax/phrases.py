"""Words of other languages, of Spanish and of talking, by what they do in a sentence.

Knows no place in a program: recovery and suggestions look them up.
"""

from __future__ import annotations

from tiniscript.words import TURN_WORDS

AFTER_HEADER = frozenset(("THEN", "DO", "BEGIN", "TIMES", "ENTONCES", "HACER", "HAZ", "VECES"))
TIMES = frozenset(("VECES", "VEZ", "TIMES", "TIME"))
# Small words that change nothing: `la distancia`, `a la derecha`, `until the distance`.
FILLERS = frozenset(
    ("LA", "EL", "LOS", "LAS", "THE", "QUE", "A", "AL", "HACIA", "DE", "CON", "UN", "UNA")
)
# What joins two instructions that are wanted at the same time: `F(2, 80) y BEEP(2, 440)`.
BESIDE = frozenset(("CON", "WITH", "MIENTRAS", "WHILE"))  # while the move goes on
AT_ONCE = frozenset(("+", "&", "AND", "Y", *BESIDE))
# What stands before how long something takes: `avanza por 3 segundos`.
BEFORE_POWER = frozenset(("POTENCIA", "POWER", "VELOCIDAD", "SPEED", "FUERZA"))
BEFORE_TIME = frozenset(("POR", "DURANTE", "FOR"))
# Who does it, or that something is done: the move is in the word behind.
BEFORE_MOVE = TURN_WORDS | frozenset(
    "HOLA HELLO CARRO CARRITO AUTO CAR".split()  # noqa: SIM905
    + "ROBOT EL THE IR VE VAMOS HAZ GO QUIERO QUE DEBE TIENE PUEDE VA POR FAVOR MI".split()  # noqa: SIM905
    + "I WANT TO MUST SHOULD WILL PLEASE MY GOES DRIVES MOVES".split()  # noqa: SIM905
)

# Names of ways, and no verbs: `2 segundos adelante`.
WAYS = frozenset(
    "AHEAD STRAIGHT FORWARD BACKWARD BACKWARDS BACK LEFT RIGHT".split()  # noqa: SIM905
    + "ADELANTE DERECHO RECTO FRENTE ATRAS IZQUIERDA DERECHA IZQ DER".split()  # noqa: SIM905
)
# Two words that say the same: `y al final`.
FINALLY = frozenset((
    ("AL", "FINAL"), ("AL", "FIN"), ("POR", "ULTIMO"), ("POR", "FIN"), ("AND", "FINALLY"),
    ("A", "CONTINUACION"), ("MAS", "TARDE"), ("AFTER", "THAT"), ("SEGUIDO", "DE"),
    ("FOLLOWED", "BY"),
))  # fmt: skip
BETWEEN = frozenset(("AND", "Y", "THEN", "ENTONCES", "LUEGO", "DESPUES", "NEXT"))
# What begins a sentence, and says only when: `Luego gira a la derecha`.
BEFORE_SENTENCE = (BETWEEN - {"NEXT"}) | frozenset(
    ("PRIMERO", "FIRST", "AHORA", "NOW", "FINALMENTE", "FINALLY", "ENSEGUIDA", "AFTER", "DESPUÉS")
)
BEFORE_NAME = frozenset(
    (
        "LET",
        "VAR",
        "SET",
        "PONER",
        "PON",
        "FIJAR",
        "ASIGNAR",
        "INT",
        "FLOAT",
        "CONST",
        "GLOBAL",
        "DIM",
        "BOOL",
    )
)
# What other languages do with a number behind it, and no variable is called.
NO_VARIABLES = frozenset(
    (
        "CASE",
        "GOTO",
        "GOSUB",
        "JUMP",
        "SALTA",
        "SALTAR",
        "PLAY",
        "PIN",
        "BAILA",
        "BAILAR",
        "SUBE",
        "BAJA",
    )
)
KEEPING = frozenset(("GUARDAR", "GUARDA", "STORE", "SAVE"))  # a value, and then its name
SETTING = frozenset(
    (
        *KEEPING,
        "SUBE",
        "BAJA",
        "SUBIR",
        "BAJAR",
        "SET",
        "PUT",
        "PONER",
        "PON",
        "FIJAR",
        "FIJA",
        "ASIGNAR",
        "ASIGNA",
        "CAMBIA_A",
    )
)
CHANGING = frozenset(
    ("CHANGE", "ADD", "CAMBIAR", "CAMBIA", "SUMAR", "SUMA", "AUMENTAR", "RESTAR", "RESTA")
)
# What begins a program of Scratch: `when green flag clicked`.
EVENTS = frozenset(
    (
        "FLAG",
        "CLICKED",
        "BANDERA",
        "EMPIECE",
        "EMPIEZA",
        "INICIE",
        "COMIENCE",
        "START",
        "CLIC",
        "INICIAR",
        "EMPEZAR",
        "COMENZAR",
    )
)
# What begins a file of another language: `import time`.
IMPORTING = frozenset("IMPORT FROM USING INCLUDE PACKAGE REQUIRE".split())  # noqa: SIM905
# What names a program, and what counts its lines: `Algoritmo cuadrado`, `Paso 1:`.
TITLES = frozenset("PROGRAMA PROGRAM ALGORITMO ALGORITHM PROYECTO".split())  # noqa: SIM905
STEPS = frozenset("PASO STEP LINEA LINE INSTRUCCION PARTE ETAPA MOVIMIENTO".split())  # noqa: SIM905
TERMINAL = frozenset(("TSC", "TINISCRIPT"))  # with these a line is for the terminal
BEFORE_CALL = frozenset(("CALL", "RUN", "GOSUB", "LLAMAR", "LLAMA", "EJECUTAR", "EJECUTA"))
BEFORE_DEF = frozenset("HACER HAZ HAGA DO USAR USA REALIZAR REALIZA".split())  # noqa: SIM905
READING = frozenset("LEE LEER READ MIDE MEDIR MEASURE SENSAR CHECK REVISA".split())  # noqa: SIM905
BEFORE_NOTE = frozenset(("REM", "NOTE", "NOTA"))

COUNTING = frozenset(
    ("FOR", "PARA_CADA", "PARA", "DESDE")
)  # a variable and its values come after these
ENDS_OF_ANY = frozenset(("END", "FIN", "DONE", "FINAL", "TERMINAR", "ACABAR"))
# What other languages put around a program: `int main() { … }`.
FRAME_WORDS = frozenset(("INT", "VOID", "PUBLIC", "STATIC", "FUNCTION", "FUNCION"))
FRAME_NAMES = frozenset(("MAIN", "PRINCIPAL", "SETUP"))
CASE_WORDS = frozenset(("SWITCH", "CASE", "CASO", "SEGUN", "SELECT", "MATCH"))
# An IF that asks for the opposite.
NEGATED = frozenset(("UNLESS", "A_MENOS_QUE", "SALVO", "EXCEPTO"))
# Two words that say to do it once more: `avanza otra vez`.
AGAIN = frozenset((("OTRA", "VEZ"), ("DE", "NUEVO"), ("ONCE", "MORE"), ("VEZ", "MAS")))
# Words that mean something elsewhere, and little in the middle of a sentence.
OFTEN_SAID = frozenset(("PARA", "FOR", "DO", "DI", "OTRO", "NEXT", "MOTOR", "MOTORES", "A", "E"))
