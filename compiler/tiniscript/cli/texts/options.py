"""The options of all verbs: one table, in English and Spanish.

Parsers, help, completion, `cli/paths.py` and the documents are made from it and from the table in
`verbs.py`, which says how texts are written.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from typing import NamedTuple

from tiniscript.cli.texts.verbs import Both
from tiniscript.languages import languages
from tiniscript.text.levels import LEVELS


class Kind(NamedTuple):
    """The kind of a value, for completion and for `cli/paths.py`.

    `reads` is the sentence that describes an input file, `writes` the sentence for an output file
    that cannot be written. A value that is not among `choices` is refused.
    """

    name: str
    reads: str = ""
    writes: str = ""
    choices: tuple[str, ...] = ()


class Option(NamedTuple):
    """An option, or, where its name has no dash, an argument. All but `is_needed` may be left out.

    `kind` and `value` (its name in help) describe the option's value; a switch has none. `dest` is
    its name in the code, if it is not the last of its flags. `repeats`: each use adds one value.
    `virtual`: only for the virtual robot. `silent`: verbs that take it without a row in help.
    """

    flags: str
    verbs: str  # "*" is each, and tsc itself; "tsc" is tsc itself
    help: Both
    kind: Kind | None = None
    value: Both = ("", "")
    dest: str = ""
    repeats: bool = False
    virtual: bool = False
    is_needed: bool = False
    silent: str = ""

    @property
    def is_argument(self) -> bool:
        return not self.flags.startswith("-")

    @property
    def name(self) -> str:
        """Its name in the code."""
        return self.dest or self.flags.split()[-1].lstrip("-").replace("-", "_")

    def taken_by(self, verb: str) -> bool:
        return self.verbs == "*" or verb in self.verbs.split()


PROGRAM = Kind("program", reads="path_program")
ROBOT = Kind("robot", reads="path_robot")
WORLD = Kind("world", reads="path_world")
PORT = Kind("port", reads="path_port")
IMAGE = Kind("file", writes="unwritable")
MAP = Kind("file", writes="unwritable_map")
PICTURE = Kind("file", writes="unwritable_picture")
REPORT = Kind("file", writes="unwritable_report")
ROWS = Kind("file", writes="unwritable_rows")
RECORDING = Kind("file", writes="unwritable_recording")
OLD_RECORDING = Kind("file", reads="path_recording")
KEYS = Kind("file", reads="path_keys")
NEW_KEYS = Kind("file", writes="unwritable_keys")
MEMORY = Kind("file", reads="path_memory", writes="unwritable_memory")
TEXT = Kind("text")
NUMBER = Kind("number")
CODE = Kind("code")  # of a mistake
BOARD = Kind("board")
SENSOR = Kind("sensor")
VERB = Kind("verb")
HURRY = Kind("hurry")
ACTION = Kind("action")  # of tsc lesson
LANGUAGE = Kind("choice", choices=languages())
MACHINE = Kind("choice", choices=("python", "cpp"))
YES_NO = Kind("choice", choices=("yes", "no"))
ON_OFF = Kind("choice", choices=("on", "off"))
IN_CLASS = Kind("choice", choices=("list", "upload", "stop", "show"))
TRUST = Kind("file", reads="path_trust")
SHELL = Kind("choice", choices=("bash", "zsh", "powershell"))
LEVEL = Kind("choice", choices=tuple(LEVELS))

# What each action of `tsc lesson` takes besides the lesson and the language.
LESSON_ACTIONS = {
    "show": ("teacher",),
    "check": ("program", "texts", "seed", "csv", "plot", "json"),
    "sheet": ("teacher", "output"),
}

A_FILE = ("FILE", "ARCHIVO")
A_ROBOT = ("NAME|FILE", "NOMBRE|ARCHIVO")
A_TEXT = ("TEXT", "TEXTO")
P, N, S, X = ("P", "P"), ("N", "N"), ("S", "S"), ("X", "X")
READINGS = ("NAME=1,2,3", "NOMBRE=1,2,3")
YES = ("yes|no", "yes|no")
A_LEVEL = ("|".join(LEVELS),) * 2

TO_MANY = "ping upload stop info undo identify"  # may work on many robots at once
TO_ONE = "live link start monitor fetch name trim claim disown text wifi selftest"
OWN = "upload live robot"  # may bring a virtual robot along
# Verbs that take an option which hardly anybody combines with them.
NO_BAUD = f"check {TO_MANY} live start monitor fetch name trim claim disown text wifi selftest"
NO_ROBOT = "ports ping stop link start monitor fetch name trim undo claim disown text wifi identify"

# fmt: off
OPTIONS: tuple[Option, ...] = (
    # arguments
    Option("action", "lesson", ("show, check or sheet; without it tsc lists the lessons", "show, check o sheet; sin esto se listan las lecciones"), ACTION, ("ACTION", "ACCIÓN")),
    Option("number", "lesson", ("the lesson's number, or the folder of a lesson of your own", "el número de la lección, o la carpeta de una lección tuya"), TEXT, ("N", "N")),
    Option("program", "lesson", ("with check: a file, a folder of programs, or - for standard input", "con check: un archivo, una carpeta de programas, o - para la entrada estándar"), PROGRAM, ("PROGRAM", "PROGRAMA")),
    Option("action", "class", ("list, upload, stop or show; without it tsc lists the robots", "list, upload, stop o show; sin esto se listan los robots"), IN_CLASS, ("ACTION", "ACCIÓN")),
    Option("program", "class", ("with upload: a file, or - for standard input", "con upload: un archivo, o - para la entrada estándar"), PROGRAM, ("PROGRAM", "PROGRAMA")),
    Option("program", "compile run show fmt upload",
           ("a file, or - for standard input", "un archivo, o - para la entrada estándar"), PROGRAM, ("PROGRAM", "PROGRAMA")),
    Option("programs", "check",
           ("files, folders with programs, or - for standard input", "archivos, carpetas con programas, o - para la entrada estándar"), PROGRAM, ("PROGRAM", "PROGRAMA"), repeats=True),
    Option("code", "explain", ("the mistake's code, such as TS012", "el código del error, como TS012"), CODE, ("CODE", "CÓDIGO")),
    Option("robot", "board", ("a robot's name (tinibot, ...) or a profile file", "un nombre (tinibot, ...) o el archivo de un perfil"), ROBOT, ("ROBOT", "ROBOT"), is_needed=True),
    Option("line", "live", ("what to do; with - lines come from standard input", "qué hacer; con - las líneas vienen de la entrada estándar"), TEXT, ("LINE", "LÍNEA")),
    Option("name", "name", ("the new name: 1 to 16 bytes of UTF-8", "el nombre del robot: de 1 a 16 bytes de UTF-8"), TEXT, ("NEW", "NUEVO")),
    Option("whether", "text", ("on or off", "on u off"), ON_OFF, ("on|off", "on|off")),
    Option("network", "wifi", ("the network that the robot joins; without it tsc says which one it has", "la red a la que se conecta el robot; sin esto tsc dice cuál tiene"), TEXT, ("NETWORK", "RED")),
    Option("about", "help", ("the command to say more about, `all` for a list of all, or what you want to do", "el comando del que quieres saber más, `todo` para listarlos todos, o lo que quieres hacer"), VERB, ("COMMAND", "COMANDO"), repeats=True),
    Option("shell", "completion", ("bash, zsh or powershell", "bash, zsh o powershell"), SHELL, ("SHELL", "TERMINAL"), is_needed=True),
    Option("words", "completion", ("what is typed so far: a shell asks what fits", "lo escrito hasta ahora: la terminal pregunta qué sigue"), TEXT, A_TEXT, repeats=True, silent="completion"),
    # the program
    Option("-e", "compile check run show fmt upload lesson class", ("the program itself, instead of a file: `-e \"SI|F(2, 80)\"`", "el programa mismo, en vez de un archivo: `-e \"SI|F(2, 80)\"`"), TEXT, A_TEXT, "texts", repeats=True),
    Option("-e", "live", ("the line, too", "también la línea"), TEXT, A_TEXT, "text"),
    # files
    Option("-o", "compile", ("where the image goes; - is standard output. Without this option it goes beside the program, or with --text to standard output",
                             "a dónde va la imagen; - es la salida estándar. Sin esta opción va junto al programa o, con --text, a la salida estándar"), IMAGE, A_FILE, "output"),
    Option("--text", "compile", ("writes the program as one line of text with a checksum instead, for a robot that reads text",
                                 "no escribe una imagen sino el programa como una línea de texto, con suma de control, para un robot que lee texto")),
    Option("--text-level", "check", ("also says why a robot of this level cannot read the program as text (a Nano's is uno)",
                                     "también lo que le falta a un robot de este nivel para leer el programa como texto (el de un Nano es uno)"), LEVEL, A_LEVEL),
    Option("--text-level", "compile", ("with --text: only if a robot of this level reads it (a Nano's is uno)",
                                       "con --text: solo si lo lee un robot de este nivel (el de un Nano es uno)"), LEVEL, A_LEVEL),
    Option("-o", "wiring", ("writes a page with a drawing, all tables and a check list, for a browser or a printer; without it tsc lists the wires here",
                            "escribe una página con un dibujo, todas las tablas y una lista de control, para leerla en un navegador e imprimirla; sin esto se listan aquí los cables"), IMAGE, ("PAGE.html", "PÁGINA.html"), "output"),
    Option("-o", "board", ("where the header goes; without this option to standard output", "a dónde va la cabecera; sin esta opción, a la salida estándar"), IMAGE, A_FILE, "output"),
    Option("-o", "fetch", ("writes the program's image to a file instead", "escribe su imagen en vez de eso"), IMAGE, A_FILE, "output"),
    Option("-o", "lesson", ("with sheet: where the page goes; - is standard output", "con sheet: a dónde va la hoja; - es la salida estándar"), IMAGE, ("PAGE.html", "PÁGINA.html"), "output"),
    Option("--arduino", "show", ("prints the program as a commented Arduino sketch for the robot's pins", "imprime el programa como un sketch de Arduino comentado, para los pines del robot")),
    Option("-o", "show", ("with --arduino: where the sketch goes; - is standard output", "con --arduino: a dónde va el sketch; - es la salida estándar"), IMAGE, ("SKETCH.ino", "SKETCH.ino"), "output"),
    Option("--map", "compile", ("writes which instruction comes from which line, as JSON", "escribe qué instrucción viene de qué línea, como JSON"), MAP, A_FILE),
    Option("--check", "fmt", ("changes nothing; exit code 1 if something would change", "no cambia nada; código de salida 1 si algo cambiaría")),
    Option("--fix", "check", ("makes the safe repairs, shows what it changed, and writes the file", "hace las correcciones seguras, muestra qué cambió y escribe el archivo")),
    Option("--diff --dry-run", "check", ("shows what --fix would change, and writes nothing", "muestra qué cambiaría --fix y no escribe nada"), dest="diff"),
    Option("--csv", "check", ("also writes the table of several programs to a file", "escribe además en un archivo la tabla de varios programas"), ROWS, A_FILE),
    # a run
    Option("--sensor", "run", ("the sensor's readings, one after the other; the last one repeats. Without this option 0 or FALSE. Repeat it for each sensor",
                               "lo que lee el sensor: cada vez el siguiente valor, el último se repite; 0 o FALSE sin esta opción. Repítela para cada sensor"), SENSOR, READINGS, repeats=True),
    Option("--max-time", "run", ("cuts the run after so many simulated seconds (60)", "después de cuántos segundos simulados se corta (60)"), NUMBER, S),
    Option("--max-steps", "run", ("cuts a loop that takes no time after so many instructions (10000000)", "después de cuántas instrucciones se corta un bucle que no dura nada (10000000)"), NUMBER, N),
    Option("--seed", "run", ("the seed of RANDOM, 1 to 4294967295 (1)", "la semilla de RANDOM, de 1 a 4294967295 (1)"), NUMBER, N),
    Option("--show", "run", ("on a terminal: draws the path and the values as they come", "en una terminal: dibuja el camino y los valores según llegan")),
    Option("--pace", "run", ("with --show: N times as fast as the robot (1); 0 is as fast as possible", "con --show: N veces más rápido que el robot (1); 0 es lo más rápido posible"), NUMBER, N),
    Option("--machine", "run", ("which machine runs it: the one in Python, or the robot's own, in C++", "qué máquina lo ejecuta: la de Python, o la del propio robot, en C++"), MACHINE, ("python|cpp", "python|cpp")),
    Option("--replay", "run", ("runs it on the virtual robot, compares that with a robot's recorded run, and says where the two differ", "lo compara con la grabación de una ejecución de un robot, en el robot virtual, y dice en qué se diferencian"), OLD_RECORDING, A_FILE),
    Option("--world", "run", ("with --replay: the world of the virtual robot, by name, or a file (obstacles)", "con --replay: el mundo del robot virtual, por nombre, o un archivo (obstacles)"), WORLD, A_ROBOT),
    # another machine or robot
    Option("--machine", "conform", ("a machine of your own: the command that starts it", "una máquina tuya: el comando que la inicia"), TEXT, ("COMMAND", "COMANDO")),
    Option("--only", "conform", ("only cases with this in their name", "solo los casos que tienen esto en su nombre"), TEXT, A_TEXT),
    Option("--timeout", "conform", ("with --machine: the most seconds for an answer (10)", "con --machine: segundos que puede tardar una respuesta (10)"), NUMBER, S),
    # a lesson
    Option("--teacher", "lesson", ("with show or sheet: the teacher's notes, with answers", "con show o sheet: las notas para el docente, con respuestas")),
    Option("--seed", "lesson", ("with check: only the world of this number, 1 to 4294967295", "con check: solo el mundo de este número, de 1 a 4294967295"), NUMBER, N),
    Option("--csv", "lesson", ("with check: also writes the table to a file, for a spreadsheet", "con check: escribe además la tabla en un archivo, para una hoja de cálculo"), ROWS, A_FILE),
    Option("--plot", "lesson", ("with check: draws the path in the world where it failed, or in the last one", "con check: dibuja el camino en el mundo donde falló, o en el último"), PICTURE, ("F.png", "F.png")),
    # the firmware
    Option("--port", "firmware", ("the port of the board's USB cable: `tsc ports` lists them", "el puerto del cable USB de la placa: `tsc ports` los lista"), PORT, P),
    Option("--board", "firmware", ("uno, nano, nano-old (with a bootloader from before 2018) or mega; without it, the robot's own board",
                                   "uno, nano, nano-old (con el cargador de arranque de antes de 2018) o mega; si no se indica ninguna, la que tiene el robot"), BOARD, ("BOARD", "PLACA")),
    Option("--build", "firmware", ("builds the firmware and writes nothing: for later, without internet", "deja listo el firmware y no escribe nada: para después, sin internet")),
    Option("--list", "firmware", ("lists which firmware is ready", "lista qué firmware está listo")),
    # what a verb does
    Option("--broker", "class", ("the computer on which the broker runs, with its port if that is not 1883 (8883 with --tls)", "la computadora donde está el broker; su puerto, si no es 1883 (8883 con --tls)"), TEXT, ("HOST[:PORT]", "HOST[:PUERTO]")),
    Option("--broker", "wifi", ("the robot also connects to this MQTT broker; add its port if that is not 1883 (8883 with --tls)", "el robot se conecta también a este broker MQTT; su puerto, si no es 1883 (8883 con --tls)"), TEXT, ("HOST[:PORT]", "HOST[:PUERTO]")),
    Option("--class", "class wifi", ("the name of the class: up to 16 letters from a to z, digits and - (class)", "el nombre de la clase: hasta 16 letras de la a a la z, cifras y - (class)"), TEXT, ("NAME", "NOMBRE"), "group"),
    Option("--user", "class wifi", ("signs in at the broker with this name; tsc asks for the password", "entra en el broker con este nombre; tsc pide la contraseña"), TEXT, ("NAME", "NOMBRE")),
    Option("--no-broker", "wifi", ("the robot uses no broker any more", "el robot ya no usa ningún broker")),
    Option("--tls", "wifi", ("with --broker: the robot speaks TLS with it, and trusts only the certificate of --trust", "con --broker: el robot habla con él por TLS, y solo confía en el certificado de --trust")),
    Option("--trust", "wifi", ("with --tls: a file with the only certificate that the robot trusts", "con --tls: un archivo con el único certificado en el que confía el robot"), TRUST, A_FILE),
    Option("--tls", "class", ("this computer speaks TLS with the broker", "esta computadora habla con el broker por TLS")),
    Option("--trust", "class", ("with --tls: a file with the certificate to trust", "con --tls: un archivo con el certificado en el que confiar"), TRUST, A_FILE),
    Option("--no-run", "upload class", ("sends the program without starting it", "envía el programa y no lo inicia")),
    Option("--no-save", "upload class", ("the robot forgets it when it is switched off", "el robot lo olvida cuando se apaga")),
    Option("--detach", "upload start class", ("starts the program and leaves: it goes on without tsc", "lo inicia y termina: el programa sigue sin tsc")),
    Option("--record", "upload", ("records what the robot reports during its run, and when, for `tsc run` and the studio", "escribe lo que dice el robot de su ejecución, y cuándo: para `tsc run` y para el estudio"), RECORDING, A_FILE),
    Option("--ask", "ports", ("opens each port and says which robot answers there; also searches over Bluetooth LE and in the network", "abre cada uno y dice qué robot responde ahí; busca también por Bluetooth LE y en la red")),
    Option("--count", "ping", ("how many round trips (10)", "cuántas idas y vueltas (10)"), NUMBER, N),
    Option("--plot", "monitor", ("on a terminal: draws the values of the last 30 seconds as a curve", "en una terminal: dibuja los valores de los últimos 30 segundos como una curva")),
    Option("--csv", "monitor", ("also writes rows of ms,event,value", "escribe además filas de ms,event,value"), ROWS, A_FILE),
    Option("--csv", "class", ("with show: also writes rows of robot,id,ms,event,value", "con show: escribe además filas de robot,id,ms,event,value"), ROWS, A_FILE),
    Option("--max-time", "monitor class", ("leaves after S seconds", "sale después de S segundos"), NUMBER, S),
    Option("--show", "trim", ("only prints what the robot keeps", "solo imprime lo que guarda el robot")),
    Option("--reset", "trim", ("resets the trim: motors as wired, both equally strong, not measured", "los motores tal como están conectados, los dos con igual fuerza, sin medir")),
    Option("--exchange", "trim", ("yes: the left and right motors are swapped", "yes: el motor izquierdo y el derecho están al revés"), YES_NO, YES),
    Option("--reverse-left", "trim", ("yes: the left wheel turns backward", "yes: la rueda izquierda gira hacia atrás"), YES_NO, YES),
    Option("--reverse-right", "trim", ("yes: the right wheel turns backward", "yes: la rueda derecha gira hacia atrás"), YES_NO, YES),
    Option("--balance", "trim", ("the left wheel gets N % less; with -N the right one does (up to 40)", "la rueda izquierda recibe N % menos; con -N, la derecha (hasta 40)"), NUMBER, N),
    Option("--least", "trim", ("the percentage of power at which the wheels begin to move (0 to 40)", "el porcentaje de potencia desde el que se mueven las ruedas (de 0 a 40)"), NUMBER, N),
    Option("--speed-40", "trim", ("how many centimetres it goes in a second at 40 % of power", "cuántos centímetros avanza en un segundo con 40 % de potencia"), NUMBER, N),
    Option("--speed-80", "trim", ("the same at 80 %", "lo mismo con 80 %"), NUMBER, N),
    Option("--turn-40", "trim", ("how many degrees it turns in a second at 40 % of power", "cuántos grados gira en un segundo con 40 % de potencia"), NUMBER, N),
    Option("--turn-80", "trim", ("the same at 80 %", "lo mismo con 80 %"), NUMBER, N),
    Option("--teacher", "claim", ("gives the robot the teacher's key, its second one", "pone en el robot la llave de docente, la segunda de las dos que guarda")),
    Option("--access-point", "wifi", ("the robot opens this network itself", "el robot mismo abre esta red")),
    Option("--forget", "wifi", ("the robot uses no WiFi any more", "el robot ya no usa WiFi")),
    Option("--teacher", "disown", ("takes the teacher's key away", "quita la llave de docente")),
    Option("--teacher", "stop class", ("with the teacher's key: only this computer, or the robot's button, lets it go on", "con la llave de docente: solo esta computadora, o el botón del robot, lo deja seguir")),
    Option("--export", "keys", ("writes the keys to a file, for another computer", "escribe las llaves en un archivo, para otra computadora"), NEW_KEYS, A_FILE),
    Option("--import", "keys", ("adds the keys from such a file", "agrega las llaves de un archivo así"), KEYS, A_FILE, "bring"),
    Option("--forget", "keys", ("forgets the keys of this robot, by its id or its name", "olvida las llaves de este robot, por su id o su nombre"), TEXT, ("ROBOT", "ROBOT")),
    Option("--name", "robot", ("the name of the robot", "cómo se llama"), TEXT, ("NAME", "NOMBRE")),
    Option("--listen", "robot", ("its TCP port, on this computer alone (any free one)", "su puerto TCP, solo en esta computadora (uno libre)"), NUMBER, P),
    Option("--listen", "studio", ("its TCP port (7070), without --class on this computer alone; 0: any free one", "su puerto TCP (7070), sin --class solo en esta computadora; 0: uno libre"), NUMBER, P),
    Option("--class", "studio", ("for a class: pupils in the room's network open the address and share this computer's robots", "para una clase: los alumnos de la red del aula abren la dirección y comparten los robots de esta computadora"), dest="is_class"),
    Option("--address", "studio", ("with --class: which of this computer's addresses pupils open, if it has several", "con --class: la dirección de esta computadora que abren los alumnos, si tiene varias"), TEXT, ("IP", "IP")),
    Option("--port", "studio", ("with --class: a robot for the class from the start; repeat it for several robots", "con --class: un robot que la clase tiene desde el principio; repítelo para varios robots"), PORT, P, "ports", repeats=True),
    Option("--turn", "studio", ("with --class: minutes that a pupil may keep a robot while others wait (3)", "con --class: los minutos que un alumno tiene un robot mientras otros esperan (3)"), NUMBER, N),
    Option("--no-browser", "studio", ("only prints the address", "solo dice la dirección")),
    Option("--announce", "robot", ("lets programs on this computer find it as tcp://NAME, with the name from --name", "deja que los programas de esta computadora lo encuentren como tcp://NOMBRE, el nombre de --name")),
    Option("--pty", "robot", ("also opens a pseudo-terminal (not on Windows)", "también una pseudoterminal (no en Windows)")),
    Option("--memory", "robot", ("keeps in this file what the robot saves; without it, that is forgotten", "conserva en un archivo lo que guarda; sin esto, se olvida"), MEMORY, A_FILE),
    Option("--button-at", "robot", ("pushes the start button after S seconds; 2,10: twice", "pulsa el botón de inicio después de S segundos; 2,10: dos veces"), NUMBER, S),
    Option("--hold-at", "robot", ("holds the start button down for 2 s after S seconds", "mantiene pulsado el botón de inicio 2 s, después de S segundos"), NUMBER, S),
    Option("--yes", "doctor", ("may open the port of a cable, which restarts the board and ends what it runs, and may try other speeds", "le permite abrir el puerto de un cable, lo que reinicia la placa y termina lo que hace, y preguntar a otras velocidades")),
    Option("--yes", "selftest", ("asks nobody and turns no motor: checks only what needs no person", "no pregunta a nadie y no hace girar ningún motor: lo que se puede revisar sin una persona")),
    Option("--yes", "studio firmware", ("downloads and builds what is missing without asking", "descarga y construye lo que falta sin preguntar")),
    Option("--watch", "doctor", ("watches the robot for S more seconds, while you let it drive with its button or from another terminal", "escucha al robot S segundos más, mientras lo haces moverse con su botón o desde otra terminal"), NUMBER, S),
    Option("--report", "doctor", ("writes the findings to a file for a teacher, with the form of a bring-up (docs/bring-up.md) at its end; it names no people, computers or networks", "escribe lo que encontró en un archivo para enviar a un docente, con el formulario de una puesta en marcha (docs/puesta-en-marcha.es.md) al final; no lleva nombres de personas, computadoras ni redes"), REPORT, A_FILE),
    Option("--port", "module", ("the port of the module's USB adapter, or of the board held in reset", "el puerto del adaptador USB donde está el módulo, o de la placa que está en reset"), PORT, P),
    Option("--name", "module", ("its new name: up to 20 letters, an HM-10's up to 12", "su nuevo nombre: hasta 20 letras, el de un HM-10 hasta 12"), TEXT, ("NAME", "NOMBRE")),
    Option("--id", "module", ("names it after its robot: Tini- and the last four digits of this id, which `tsc info` shows", "le pone el nombre de su robot: Tini- y las cuatro últimas cifras de este id, que muestra `tsc info`"), TEXT, ("ID", "ID")),
    Option("--pin", "module", ("its new PIN: 4 digits, an HM-10's 6", "su nuevo PIN: 4 cifras, el de un HM-10 6"), TEXT, ("PIN", "PIN")),
    Option("--baud", "module", ("its new speed, as in the robot's profile: 9600, 19200, 38400, 57600 or 115200", "su nueva velocidad, la del perfil del robot: 9600, 19200, 38400, 57600 o 115200"), NUMBER, N),
    Option("--dry-run", "module", ("finds the module, shows what it would send, and changes nothing", "encuentra el módulo, muestra lo que se enviaría y no cambia nada")),
    # the robot, and the way to it
    Option("--report", "selftest", ("writes the findings to a file for a teacher; it names no people, computers, networks or robots", "escribe lo que encontró en un archivo para enviar a un docente; no lleva nombres de personas, computadoras, redes ni robots"), REPORT, A_FILE),
    Option("--port", "conform", ("the port of a robot whose firmware is your own", "el puerto de un robot cuyo firmware es tuyo"), PORT, P),
    Option("--port", "doctor", ("the port to look at; without it the last used one, or the only one", "el puerto que se examina; el último usado, o el único, si no se indica otro"), PORT, P),
    Option("--port", "check", ("for the robot on this port, which tsc asks", "para el robot en este puerto, al que se pregunta"), PORT, P),
    Option("--port", "ports", ("with --ask: only this one", "con --ask: solo este"), PORT, P),
    Option("--port", TO_ONE, ("the robot's port; without this option the one used last", "el puerto del robot; el último usado, si no se indica otro"), PORT, P),
    Option("--port", "ping info undo identify", ("the robot's port; without this option the one used last; repeat it for several robots", "el puerto del robot; el último usado, si no se indica otro; repítelo para varios robots"), PORT, P, "ports", repeats=True),
    Option("--port", "upload", ("the robot's port (/dev/ttyUSB0, /dev/rfcomm0, COM5, ble://name, tcp://name, socket://host:port, ...); without this option the one used last; repeat it for several robots",
                                "el puerto del robot (/dev/ttyUSB0, /dev/rfcomm0, COM5, ble://nombre, tcp://nombre, socket://host:puerto, ...); el último usado, si no se indica otro; repítelo para varios robots"), PORT, P, "ports", repeats=True),
    Option("--port", "stop", ("the robot's port; repeat it for several robots", "el puerto del robot; repítelo para varios robots"), PORT, P, "ports", repeats=True),
    Option("--all", "ping info identify", ("every robot that answers, a line each", "todos los robots que responden, una línea por cada uno")),
    Option("--all", "upload undo", ("every robot that answers, all at once", "todos los robots que responden, todos a la vez")),
    Option("--all", "stop", ("stops every robot in reach, all at once", "detiene todos los robots que hay, todos a la vez")),
    Option("--baud", "doctor", ("the speed that its port should have (as in the robot's profile)", "la velocidad que su puerto debería tener (la del perfil del robot)"), NUMBER, N),
    Option("--baud", f"check {TO_ONE} {TO_MANY}", ("the speed of its port (as in the robot's profile)", "la velocidad de su puerto (la del perfil del robot)"), NUMBER, N, silent=NO_BAUD),
    Option("--baud", "conform", ("with --port: its speed (9600)", "con --port: su velocidad (9600)"), NUMBER, N),
    Option("--baud", "ports", ("with --ask: their speed (as in the robot's profile)", "con --ask: su velocidad (la del perfil del robot)"), NUMBER, N, silent="ports"),
    Option("--baud", "robot", ("how fast its line is (as in its profile); 0 is as fast as possible", "la velocidad de su línea (la de su perfil); 0 es lo más rápido posible"), NUMBER, N),
    Option("--robot", "compile check run show fmt upload live class", ("for which robot: a name (tinibot, ...) or a profile file", "para qué robot: un nombre (tinibot, ...) o el archivo de un perfil"), ROBOT, A_ROBOT),
    Option("--robot", "wiring ports ping stop link start info monitor fetch name trim undo claim disown text wifi identify robot", ("which robot: a name (tinibot, ...) or a profile file", "qué robot: un nombre (tinibot, ...) o el archivo de un perfil"), ROBOT, A_ROBOT, silent=NO_ROBOT),
    Option("--robot", "selftest", ("which robot it should be: a name (tinibot, ...) or a profile file", "qué robot debería ser: un nombre (tinibot, ...) o el archivo de un perfil"), ROBOT, A_ROBOT),
    Option("--robot", "doctor", ("which robot it should be: a name (tinibot, ...) or a profile file", "qué robot debería ser: un nombre (tinibot, ...) o el archivo de un perfil"), ROBOT, A_ROBOT),
    Option("--robot", "firmware", ("tinibot (the default), liner, grabber, tinibot2, or a profile of your own", "tinibot (si no se indica ninguno), liner, grabber, tinibot2, o un perfil propio"), ROBOT, A_ROBOT),
    Option("--virtual", "check", ("for the virtual robot of `tsc robot`, which runs in another terminal", "para el robot virtual de `tsc robot`, que está en marcha en otra terminal")),
    Option("--virtual", "ping link start info monitor fetch name trim undo claim disown text wifi identify selftest doctor", ("the virtual robot of `tsc robot`, which runs in another terminal", "el robot virtual de `tsc robot`, que está en marcha en otra terminal"), silent="link disown text identify"),
    Option("--virtual", "stop", ("only virtual robots: those of `tsc robot`, and of commands with --virtual", "solo robots virtuales: los de `tsc robot`, y los de comandos con --virtual")),
    Option("--virtual", "upload", ("uses a virtual robot: the one of `tsc robot`, if that runs in another terminal, or one that drives here until the program ends or Ctrl-C. Its button is the key b; if nobody is at a terminal, it is pushed at once",
                                   "sin robot: uno virtual se mueve aquí, hasta que el programa termina o Ctrl-C; el de `tsc robot`, si está en marcha en otra terminal. La tecla b es el botón del de aquí; si no hay nadie en una terminal, se pulsa enseguida")),
    Option("--virtual", "live", ("uses a virtual robot here", "sin robot: lo hace aquí uno virtual")),
    # how it is said
    Option("--json", "check show lesson ping info ports keys doctor selftest conform", ("the same as data", "lo mismo como datos"), silent="keys"),
    Option("--json", "upload class", ("prints the receipt and everything after it as lines of JSON", "imprime lo que se envió y lo que viene después como líneas de JSON")),
    Option("--json", "undo", ("prints the receipt, and that it is saved, as lines of JSON", "imprime a qué programa volvió, y que está guardado, como líneas de JSON"), silent="undo"),
    Option("--json", "stop identify", ("prints a line of JSON for each robot", "imprime una línea de JSON por cada robot"), silent="identify"),
    Option("--json", "link start monitor", ("prints lines of JSON", "imprime líneas de JSON"), silent="link"),
    Option("--json", "trim", ("prints what the robot keeps as data", "imprime lo que guarda el robot como datos"), silent="trim"),
    # a virtual robot of one's own
    Option("--world", OWN, ("its world: obstacles, line, light, maze, gaps, ring, parking, delivery, dance, free, or a file (obstacles)", "su mundo: obstacles, line, light, maze, gaps, ring, parking, delivery, dance, free, o un archivo (obstacles)"), WORLD, A_ROBOT, virtual=True),
    Option("--plot", OWN, ("draws the world and the path when it ends", "dibuja el mundo y el camino cuando termina"), PICTURE, ("F.png", "F.png"), virtual=True, silent="live"),
    Option("--for", OWN, ("ends after S seconds of the robot's time", "termina a los S segundos del reloj del robot"), NUMBER, S, virtual=True, silent="live"),
    Option("--hurry", OWN, ("runs N times as fast; max: as fast as this computer can", "un programa va N veces más rápido; max: lo más rápido que esta computadora pueda"), HURRY, ("N|max", "N|max"), virtual=True),
    Option("--sensor", OWN, ("a sensor's readings, instead of what it senses in the world", "lo que lee un sensor, en vez de lo que percibe en el mundo"), SENSOR, READINGS, repeats=True, virtual=True, silent="live"),
    Option("--noise", OWN, ("sensors and motors are off by about X percent (0)", "los sensores y motores se desvían más o menos X % (0)"), NUMBER, X, virtual=True, silent="live"),
    Option("--motors", OWN, ("how strong each motor is, left and right, in percent (100,100)", "la fuerza de cada motor, izquierdo y derecho, en porcentaje (100,100)"), NUMBER, ("L,R", "I,D"), virtual=True, silent="live"),
    Option("--faults", OWN, ("of 1000 bytes on its line, X are lost, changed or late (0)", "de 1000 bytes en su línea, X se pierden, cambian o llegan tarde (0)"), NUMBER, X, virtual=True, silent="live"),
    Option("--seed", OWN, ("the random seed: the same number gives the same run (1)", "la semilla del azar: con el mismo número, el mismo recorrido (1)"), NUMBER, N, virtual=True, silent="live"),
    # every verb
    Option("--lang", "*", ("the language in which tsc says everything", "el idioma en que tsc dice todo"), LANGUAGE, ("|".join(LANGUAGE.choices),) * 2),
    Option("-h --help", "*", ("prints this help", "imprime esta ayuda")),
    Option("-V --version", "tsc", ("prints the version of tsc", "imprime qué tsc es este")),
)
# fmt: on

WITH_VIRTUAL = ("With --virtual:", "Con --virtual:")  # above options that are `virtual`
USAGE = ("[options]", "[opciones]")


def of_verb(verb: str) -> list[Option]:
    """Return the options of a verb, or of `tsc` itself, in the order of help."""
    return [option for option in OPTIONS if option.taken_by(verb)]


def shown_of(verb: str) -> list[Option]:
    """Return the options of a verb, or of `tsc` itself, that help and documents show."""
    return [option for option in of_verb(verb) if verb not in option.silent.split()]


def virtual_names() -> list[str]:
    """Return the names in the code of the options for a virtual robot of the command."""
    return [option.name for option in OPTIONS if option.virtual]
