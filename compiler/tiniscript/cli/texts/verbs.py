"""The verbs of `tsc`, in the order in which help has them: one table, in English and Spanish.

Parsers, help, completion and the documents are made from it and from the table in `options.py`.
What is typed stands between backticks: documents show it as code, and on a terminal no line ends
in it.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from typing import NamedTuple

Both = tuple[str, str]  # a text in English and in Spanish


class Verb(NamedTuple):
    """A verb, which is a module of `cli/commands/`.

    `example` is a command with it and `summary` what that does, under the heading `group`. Where
    its example stands beside that of another verb, `group` is that verb's name. `says` is what it
    does, `ends` what else there is to know. Where it is used in several ways, `usage` has a line
    for each.
    """

    group: Both | str
    example: Both
    summary: Both
    says: Both
    usage: Both = ("", "")
    ends: Both = ("", "")


# fmt: off
TITLE = ("tsc: TiniScript, a language of single lines for robots.",
         "tsc: TiniScript, un lenguaje de una sola línea para robots.")
PROGRAMS = ("Programs:", "Programas:")
ROBOTS = ("A robot on a port (`--port /dev/rfcomm0`, `COM5`, ...; later the last one) or a virtual one (`--virtual`):",
          "Un robot en un puerto (`--port /dev/rfcomm0`, `COM5`, ...; luego, el último) o uno virtual (`--virtual`):")
TROUBLE = ("Which robot is it, and what is wrong?", "¿Qué robot es, y qué le pasa?")
SETTINGS = ("Settings that a robot keeps:", "Ajustes que un robot conserva:")
BUILDING = ("Building a robot:", "Construir un robot:")
ITSELF = ("The command itself:", "El comando mismo:")
FIRST = ("studio", "lesson", "check", "run", "compile", "upload", "live", "stop", "firmware", "doctor")
MORE = ("`tsc help upload` says more about a command, `tsc help all` lists all of them, and `tsc help \"put firmware on\"` finds the one that does it.",
        "`tsc help upload` explica un comando, `tsc help todo` los lista todos, y `tsc help \"poner firmware\"` encuentra el que hace eso.")
NOTES = (
    ("A program is a file, - (standard input) or `-e \"SI|F(2, 80)\"`.",
     "Un programa es un archivo, - (entrada estándar) o `-e \"SI|F(2, 80)\"`."),
    ("Exit codes: 0 done, 1 the program is wrong, 2 wrong use of tsc, 3 the robot or the link; 141 the program that reads the output has ended, which stops the robot that the command drives.",
     "Códigos de salida: 0 listo, 1 el programa está mal, 2 mal uso de tsc, 3 el robot o la conexión; 141 si el programa que leía la salida terminó, y entonces se detiene el robot que maneja el comando."),
)

VERBS: dict[str, Verb] = {
    "studio": Verb(
        PROGRAMS, ("studio", "studio"),
        ("write programs in your browser", "abre una página del navegador para programar"),
        ("Opens TiniScript Studio in this computer's browser: an editor that marks mistakes while you write, with the same compiler as `tsc`, and a virtual robot that runs your program. The page also drives the robots of this computer: it connects, sends programs, runs lines, and shows values and faults beside their lines; meanwhile other commands share the port. The robot stops when the page hangs, is hidden or closes. The address with a code reaches the robots and opens once; then the terminal shows the next one. Without a code the page has the editor and the virtual robot. Nothing leaves this computer, and after the first visit the page works without `tsc`, too. The command runs until Ctrl-C. In a clone it builds the page the first time: it says how much it will download, and asks.\n\n`--class` is for a classroom: pupils open the address that it shows, type the class code and their name, and get the studio with the virtual robot in their own browser. Their programs go to the robots that this computer reaches; pupils who wait see their place in the queue. The address with a code, which opens once, is the teacher's page: it shows all pupils, their programs and robots, stops them all, and ends the class, deleting the pupils' work if you want. Nothing leaves the room.",
         "Abre TiniScript Studio, una página para el navegador de esta computadora: un editor que dice qué está mal en un programa mientras se escribe, con el mismo compilador que `tsc`, y el robot virtual, que lo ejecuta. La página también maneja los robots de esta computadora: se conecta, envía, ejecuta una línea, muestra valores y las fallas en su línea; mientras tanto otros comandos comparten el puerto. El robot se detiene si la página se cuelga, queda oculta o se cierra. La dirección con un código da acceso a los robots y se abre una sola vez; después la terminal muestra la siguiente. Sin código hay editor y robot virtual. Nada sale de esta computadora, y después de la primera visita la página también funciona sin `tsc`. Sigue en marcha hasta Ctrl-C. En un clon, la primera vez se construye la página: dice cuánto va a descargar y pide permiso.\n\n`--class` es para un aula: los alumnos abren la dirección que muestra, escriben el código de la clase y su nombre, y tienen el estudio con el robot virtual en su propio navegador. Sus programas van a los robots a los que llega esta computadora; quien espera ve su lugar en la cola. La dirección con un código, que se abre una sola vez, es la página del docente: muestra a todos los alumnos con sus programas y robots, detiene todos los robots y, al terminar, borra el trabajo de los alumnos si así lo indicas. Nada sale del aula."),
        ends=("Exit code: 0 when it has ended, 2 if there is no page and it was not built, 3 if its port cannot be used.",
              "Código de salida: 0 cuando terminó, 2 si la página no está y no se construyó, 3 si no se puede usar su puerto."),
    ),
    "lesson": Verb(
        PROGRAMS, ("lesson check 1 prog.ts", "lesson check 1 prog.ts"),
        ("gives lessons and checks their tasks", "da lecciones y revisa sus tareas"),
        ("Lessons of 45 minutes, from the first line to a robot that does several things at once. Without an action it lists them; `tsc lesson show 1` prints the pupils' page, `tsc lesson sheet 1 -o sheet.html` turns it into a page to print. `tsc lesson check 1 prog.ts` tries the program on the virtual robot, in the worlds of the task, and says what is missing; for a folder it checks every program and prints a table. The same program gets the same verdict on every computer.",
         "Lecciones de 45 minutos, desde la primera línea hasta un robot que hace varias cosas a la vez. Sin nada más, las lista; `tsc lesson show 1` imprime la página de los alumnos, y `tsc lesson sheet 1 -o hoja.html` la convierte en una hoja para imprimir. `tsc lesson check 1 prog.ts` prueba el programa en los mundos de la tarea, con el robot virtual, y dice qué falta; si le das una carpeta, revisa todos los programas e imprime una tabla. El mismo programa recibe el mismo resultado en cualquier computadora."),
        ("[ACTION [N [PROGRAM]]] [options]\nshow N [--teacher]\ncheck N PROGRAM [options]\nsheet N -o PAGE.html [--teacher]",
         "[ACCIÓN [N [PROGRAMA]]] [opciones]\nshow N [--teacher]\ncheck N PROGRAMA [opciones]\nsheet N -o PÁGINA.html [--teacher]"),
        ("With check, `--json` gives a list of `{file, verdict, seed, findings}`. Exit code of check: 0 when every program passes, 1 when one does not.",
         "Con check, `--json` da una lista de `{file, verdict, seed, findings}`. Código de salida de check: 0 si todos los programas cumplen la tarea, 1 si alguno no."),
    ),
    "check": Verb(
        PROGRAMS, ("check prog.ts", "check prog.ts"),
        ("show all mistakes and warnings; --fix repairs", "muestra errores y avisos; --fix corrige"),
        ("Shows all mistakes and warnings of a program. For several programs, or a folder, it shows one line each and a table. `--fix` makes the safe repairs: they drop no number, guess no name and leave fewer mistakes.",
         "Muestra todos los errores y avisos de un programa. Con varios programas, o una carpeta, muestra una línea por cada uno y una tabla. `--fix` hace las correcciones seguras: las que no quitan ningún número, no adivinan ningún nombre y dejan menos errores."),
        ends=("`--json` gives a list of `{code, severity, line, column, end_line, end_column, message, fix}`; lines and columns count from 1, columns in characters, the end is not included. For several programs it gives a list of `{file, mistakes, warnings, repaired, problem, messages}`. The exit code is 1 if a program has mistakes, 2 if one cannot be read.",
              "`--json` da una lista de `{code, severity, line, column, end_line, end_column, message, fix}`; líneas y columnas desde 1, columnas en caracteres, el final no se incluye. Con varios programas da una lista de `{file, mistakes, warnings, repaired, problem, messages}`. El código de salida es 1 si un programa tiene errores, y 2 si alguno no se puede leer."),
    ),
    "run": Verb(
        PROGRAMS, ("run prog.ts", "run prog.ts"),
        ("run it without a robot; print what it would do", "lo ejecuta sin robot e imprime lo que haría"),
        ("Runs a program (text or image) without a robot and prints what the robot would do, line by line, each with the milliseconds since the start. The clock is simulated, so this takes no time.",
         "Ejecuta un programa (texto o imagen) sin robot e imprime lo que hace el robot, línea por línea, cada una con los milisegundos desde el inicio. El reloj es simulado: no hay que esperar."),
        ends=("Exit code: 0 if the run is done or cut, 1 after a fault or mistakes.",
              "Código de salida: 0 si termina o se corta, 1 después de una falla o con errores."),
    ),
    "compile": Verb(
        PROGRAMS, ("compile prog.ts", "compile prog.ts"),
        ("compile a program into an image for the robot", "compila un programa en una imagen para el robot"),
        ("Compiles a program into an image for the robot. Says how many bytes it has, how deep its stack gets and, if that can be known, how long it runs. If the program has mistakes, the file stays as it was. With `--text` it writes the program as one line of text instead.",
         "Compila un programa en una imagen para el robot. Dice cuántos bytes tiene, cuánto usa de la pila y, si se puede saber, cuánto dura. Si el programa tiene errores, el archivo queda como estaba. Con `--text` escribe el mismo programa como una línea de texto."),
    ),
    "show": Verb(
        PROGRAMS, ("show prog.bin", "show prog.bin"),
        ("list its instructions; --arduino: as a sketch", "lista sus instrucciones; --arduino: como sketch"),
        ("Lists the instructions of a program (image or text): offsets, bytes, names, and source lines if they are known.",
         "Lista las instrucciones de un programa (imagen o texto): posiciones, bytes, nombres, y las líneas del texto si se conocen."),
        ends=("With `--arduino` it prints the program as a commented Arduino sketch, with the TiniScript beside each line: the step to the next language. The sketch builds in the Arduino IDE and does on the board what the program does; its first lines name the limits.",
              "Con `--arduino` imprime el texto como un sketch de Arduino comentado, cada línea con su TiniScript al lado: el paso al siguiente lenguaje. El sketch se compila en el Arduino IDE y hace en la placa lo que hace el programa; sus primeras líneas dicen los límites."),
    ),
    "fmt": Verb(
        PROGRAMS, ("fmt prog.ts", "fmt prog.ts"),
        ("lay the text out in the usual way", "ordena el texto de la forma usual"),
        ("Lays the text of a program out in the usual way, in place; it keeps comments and the meaning. From standard input or with -e it prints the result.",
         "Ordena el texto de un programa de la forma usual, en el mismo archivo; los comentarios se conservan y el programa significa lo mismo. Desde la entrada estándar o con -e imprime el resultado."),
    ),
    "explain": Verb(
        PROGRAMS, ("explain TS012", "explain TS012"),
        ("say more about a mistake", "explica un error con más detalle"),
        ("Says more about a mistake, with an example. Without a code it lists all mistakes.",
         "Explica un error con más detalle y un ejemplo. Sin código los lista todos."),
    ),
    "upload": Verb(
        ROBOTS, ("upload prog.ts", "upload prog.ts"),
        ("send a program to a robot and start it; --virtual", "envía un programa al robot y lo inicia; --virtual"),
        ("Compiles a program, sends it to the robot and, if it begins with `SI`, starts it. Stays until the program ends, and prints what it shows, or a fault with its line. Ctrl-C stops the robot. A program that begins with `SB` waits for the robot's button.",
         "Compila un programa, lo envía al robot y lo inicia ahí si empieza con `SI`. Espera hasta que termine: imprime lo que muestra el programa, y una falla con su línea. Ctrl-C detiene el robot. Un programa que empieza con `SB` espera el botón del robot."),
        ends=("Exit code: 0 when it is done, 1 after mistakes or a fault, 2 after Ctrl-C, 3 if the robot or the link ended it.",
              "Código de salida: 0 si termina, 1 con errores o una falla, 2 después de Ctrl-C, 3 si lo terminó el robot o la conexión."),
    ),
    "live": Verb(
        ROBOTS, ('live "F(2, 80)"', 'live "F(2, 80)"'),
        ("run one line now; without a line: a prompt", "ejecuta una línea ahora; sin ella, las pide"),
        ("Runs one line on the robot now: `tsc live \"F(2, 80)\"`. Without a line it opens a prompt, where a block may span several lines. Variables and DEFs last until you leave: DEFs as text, and a line's values once the line is done. The program in the robot does not change. Ctrl-C stops the robot, Ctrl-D leaves.",
         "Ejecuta una línea en el robot ahora: `tsc live \"F(2, 80)\"`. Sin una línea, tsc las pide una por una; un bloque sigue en varias líneas hasta su final. Las variables y los DEF se conservan hasta que sales: los DEF como texto, y los valores que una línea dejó al terminar. El programa que tiene el robot queda como está. Ctrl-C detiene el robot, Ctrl-D sale."),
    ),
    "stop": Verb(
        ROBOTS, ("stop", "stop"), ("stop the robot now", "detiene el robot ahora"),
        ("Stops the robot now, and says when the robot has confirmed it. Asks the robot nothing first, so it also stops one with another version or kit. The robot stays stopped until somebody starts it again or pushes its button. Without a port it stops every robot that a tsc is using on this computer, including virtual ones, and the last used one.",
         "Detiene el robot ahora, y avisa cuando lo ha confirmado. No pregunta nada antes, así que también detiene un robot de otra versión o de otro kit. Queda detenido hasta que lo inicies otra vez o pulses su botón. Si no se indica un puerto, detiene todos los robots que algún tsc está usando en esta computadora, también los virtuales, y el último usado."),
    ),
    "start": Verb(
        ROBOTS, ("start", "start"), ("start the program that the robot holds", "inicia el programa que tiene el robot"),
        ("Starts the program in the robot and stays until it ends, as `tsc upload` does. Ctrl-C stops the robot.",
         "Inicia el programa que tiene el robot y espera hasta que termine, como `tsc upload`. Ctrl-C detiene el robot."),
    ),
    "undo": Verb(
        "start", ("undo", "undo"), ("bring back the program before this one", "vuelve al programa anterior"),
        ("Brings back the program that the robot held before the last saved one, and keeps it over the next power-on. What runs ends, and nothing starts. A second undo brings the later program back. If the last program was sent with --no-save, the saved one comes back, and the other is gone.",
         "Vuelve al programa que el robot tenía antes del último que guardó; el robot lo conserva aunque se apague. Lo que está en marcha termina, y no se inicia nada. Otro undo vuelve al programa más nuevo. Si el último programa se envió con --no-save, vuelve el guardado, y el otro se pierde."),
    ),
    "monitor": Verb(
        ROBOTS, ("monitor", "monitor"), ("print what the robot shows", "imprime lo que el robot muestra"),
        ("Prints what the robot reports, each with the milliseconds since the first: values of SHOW, how a program ends, faults with their lines. Starts and stops nothing; Ctrl-C leaves. (Opening the port of an Arduino on a cable resets it: then nothing runs until its button is pressed.)",
         "Imprime lo que informa el robot, cada cosa con los milisegundos desde la primera: valores de SHOW, cómo termina un programa, fallas con sus líneas. No inicia ni detiene nada; Ctrl-C sale. (Abrir el puerto de un Arduino con cable lo reinicia: nada se mueve antes de pulsar su botón.)"),
    ),
    "fetch": Verb(
        ROBOTS, ("fetch", "fetch"), ("read the robot's program back", "lee el programa que tiene el robot"),
        ("Reads back the program in the robot and lists it, beside its source lines if they are known.",
         "Lee el programa que tiene el robot y lo lista, junto a sus líneas si se conocen."),
    ),
    "robot": Verb(
        ROBOTS, ("robot", "robot"),
        ("a virtual robot with a port, for other terminals", "un robot virtual, para otras terminales"),
        ("A virtual robot: the firmware of the real one, in a world of walls, lines and lamps. It has a port like any other robot, and another terminal finds it (`tsc upload prog.ts --virtual`). On a terminal you see it drive, and keys push its buttons; elsewhere a line says what it does.",
         "Un robot virtual: el mismo firmware que uno de verdad, en un mundo de paredes, líneas y lámparas. Tiene un puerto como cualquier robot, y otra terminal lo encuentra (`tsc upload prog.ts --virtual`). En una terminal se dibuja, y hay teclas para sus botones; si no hay terminal, una línea dice lo que hace."),
        ends=("Exit code: 0 when it has ended.", "Código de salida: 0 cuando terminó."),
    ),
    "link": Verb(
        ROBOTS, ("link", "link"),
        ("hold the port, so that other commands share it", "mantiene abierto el puerto, para compartirlo"),
        ("Holds the robot's port until Ctrl-C, so that other tsc commands share it: `tsc stop` works while another terminal drives the robot, and an upload does not reset the board. Prints what happens. If the robot is lost, it searches until the robot is back. (live, monitor, and an upload or start that stays share their port, too.)",
         "Mantiene abierto el puerto del robot hasta Ctrl-C, para que otros comandos de tsc lo compartan: `tsc stop` funciona mientras otra terminal maneja el robot, y un upload no reinicia la placa. Imprime lo que pasa. Si el robot se pierde, lo busca hasta que vuelve. (live, monitor, y un upload o start que espera también comparten su puerto.)"),
    ),
    "class": Verb(
        ROBOTS, ("class --broker HOST", "class --broker HOST"), ("drive a class of robots at an MQTT broker", "una clase de robots en un broker MQTT"),
        ("Reaches robots with an ESP32 that `tsc wifi --broker` has connected to a school's MQTT broker: it lists them, sends a program to all, stops all, or prints what they show. Each robot has an owner, and this computer needs its key (`tsc keys --import`). Messages are sealed: the broker, and anybody else connected to it, can only keep them from arriving. A stop reaches every robot of the class, whoever drives it.",
         "Llega a robots con ESP32 que `tsc wifi --broker` conectó al broker MQTT de una escuela: los lista, envía un programa a todos, los detiene a todos, o imprime lo que muestran. Cada uno tiene dueño, y esta computadora su llave (`tsc keys --import`): lo que dice va sellado, así que un broker, y cualquiera que esté en él, puede impedir que llegue, y nada más. Una parada llega a todos los robots de la clase, sin importar quién los maneje."),
        ("[ACTION] [PROGRAM] --broker HOST [options]",
         "[ACCIÓN] [PROGRAMA] --broker HOST [opciones]"),
        ends=("It needs `pip install \".[broker]\"`. Only one tsc at a time can have a robot; a second one says so.\nWith `--tls` this computer speaks TLS with the broker; a robot does so after `tsc wifi --tls`. Without it, the broker's passwords cross the school's network in the clear.",
              "Necesita `pip install \".[broker]\"`. Un robot lo usa un solo tsc a la vez; un segundo tsc lo avisa.\nCon `--tls` esta computadora habla TLS con el broker; un robot, si se lo pidió `tsc wifi --tls`. Sin eso, las contraseñas para el broker van por la red de la escuela tal cual."),
    ),
    "doctor": Verb(
        TROUBLE, ("doctor", "doctor"),
        ("find out what is wrong, and what to do", "averigua qué está mal, y qué hacer"),
        ("Finds out what is wrong with a port, a Bluetooth module or a robot: what it saw, how sure it is, and the next step. First it looks only at this computer and opens no port. Then it uses the port of a radio, or one that another tsc has: it sends HELLO, STATUS and 20 PING. Opening the port of a cable restarts most boards, so it asks first (`--yes` answers yes). If no robot answers there, it tries other speeds, then AT, which a module answers, and the greeting of bootloaders. It never drives a robot, starts or stops nothing, and writes to no memory.",
         "Averigua qué está mal en un puerto, un módulo Bluetooth o un robot: qué vio, qué tan seguro está y el siguiente paso. Primero mira solo esta computadora y no abre ningún puerto. Después usa el puerto de una radio, y el que usa otro tsc: envía HELLO, STATUS y 20 PING. Abrir el puerto de un cable reinicia la mayoría de las placas, así que antes pregunta (`--yes` responde que sí); si ahí no responde ningún robot, pregunta a otras velocidades, envía AT, que es lo que responde un módulo, y el saludo de los cargadores de arranque. Nunca mueve un robot, no inicia ni detiene nada, y no escribe en ninguna memoria."),
        ends=("Exit code: 0 if a robot answers and nothing is wrong, 3 if something is or nobody could be asked.\n"
              "`--watch 20` detects a robot that restarts when its motors start: let it drive meanwhile.\n"
              "While it watches it shares the port, so `tsc stop` works in another terminal. Before that, a stop waits some seconds.\n"
              "Its questions to Windows and macOS were tested with recorded answers, not on these systems.",
              "Código de salida: 0 si un robot responde y todo está bien, 3 si algo está mal o no respondió ningún robot.\n"
              "Con `--watch 20` ve un robot que se reinicia cuando arrancan sus motores: haz que se mueva mientras tanto.\n"
              "Mientras lo observa comparte el puerto: `tsc stop` funciona en otra terminal. Antes de eso, `tsc stop` tiene que esperar unos segundos.\n"
              "Lo que pregunta a Windows y macOS se probó con respuestas grabadas de esos sistemas, no en ellos."),
    ),
    "selftest": Verb(
        "doctor", ("selftest", "selftest"),
        ("is the robot ready for a lesson?", "¿está listo el robot para la lección?"),
        ("Checks whether a robot is ready, as far as a computer can: whether it answers, its kit, its firmware, the connection, its supply as far as the robot knows it, its memory, its trim, each sensor, each motor and the buzzer. Lift the robot so that its wheels turn in the air: the motors turn one after the other, and you say what you see. `--yes` asks nobody and turns no motor. The robot keeps its program.",
         "Revisa lo que una computadora puede revisar de un robot que debería estar listo: si responde, su kit, su firmware, la conexión, su alimentación hasta donde el robot la conoce, su memoria, su ajuste, cada sensor, cada motor y el zumbador. Levanta el robot, con las ruedas en el aire: los motores giran uno tras otro, y tú dices qué ves. `--yes` no pregunta a nadie y no hace girar ningún motor. El robot conserva su programa."),
        ends=("Exit code: 0 if nothing is wrong, 3 if something is. What it cannot see has a question mark.",
              "Código de salida: 0 si todo está bien, 3 si algo está mal. Lo que no puede ver lleva un signo de interrogación."),
    ),
    "ports": Verb(
        TROUBLE, ("ports", "ports"),
        ("list the ports; --ask: which robot answers where", "los puertos; --ask: qué robot responde en cuál"),
        ("Lists the serial ports of this computer, the robots that have answered there before, and the ports that another tsc has open. Opens none of them, since that resets most boards. A robot with Bluetooth LE (an HM-10, say) has no serial port: its port is `ble://NAME` or `ble://ADDRESS`. A robot that announces itself in the network has the port `tcp://NAME`.",
         "Lista los puertos serie de esta computadora, qué robots respondieron ahí antes, y cuál tiene abierto otro tsc. No abre ninguno: abrir un puerto reinicia la mayoría de las placas. Un robot con Bluetooth LE (un HM-10, por ejemplo) no es un puerto serie: su puerto es `ble://NOMBRE` o `ble://DIRECCIÓN`; el de un robot que se anuncia en la red es `tcp://NOMBRE`."),
    ),
    "info": Verb(
        TROUBLE, ("info", "info"), ("show what the robot says about itself", "lo que el robot dice de sí mismo"),
        ("Prints what the robot says about itself: name, kit, room, program, state, last fault.",
         "Imprime lo que el robot dice de sí mismo: nombre, kit, espacio, programa, estado, última falla."),
    ),
    "ping": Verb(
        "info", ("ping", "ping"),
        ("see who is there, and how long an answer takes", "quién está ahí, y cuánto tarda una respuesta"),
        ("Says who answers on the port, and how long a round trip takes: the shortest, the usual and the longest.",
         "Dice quién responde en el puerto, y cuánto tarda una ida y vuelta: la más corta, la normal y la más larga."),
    ),
    "identify": Verb(
        TROUBLE, ("identify", "identify"), ("which robot is it? It blinks and plays", "¿qué robot es? parpadea y toca"),
        ("The robot blinks for 3 s and plays its own three notes. Anybody may ask for that. While a program runs the robot only blinks, since the program owns the buzzer. `--all`: each robot that answers.",
         "El robot parpadea 3 s y toca sus tres notas. Cualquiera puede pedirlo. Mientras un programa está en marcha no toca nada, porque el zumbador es del programa; la luz parpadea igual. `--all`: todos los robots que respondan."),
    ),
    "claim": Verb(
        SETTINGS, ("claim", "claim"), ("make the robot yours: only you drive it", "hace tuyo el robot: solo tú lo manejas"),
        ("Makes the robot yours. Hold its start button down for 2 s while tsc waits. From then on only a computer with its key drives it; everybody else may look at it, make it blink and stop it. With `--teacher` the robot gets a second key, which may do the same; after a stop with it (`tsc stop --teacher`) the robot goes on only with that key, or with its button. Anybody may use a robot without an owner.",
         "Hace tuyo el robot. Mantén pulsado su botón de inicio 2 s mientras tsc espera. Desde entonces solo lo maneja una computadora que tiene su llave; los demás pueden consultarlo, hacerlo parpadear y detenerlo. Con `--teacher` el robot recibe una segunda llave, que permite lo mismo; un robot que se detuvo con ella (`tsc stop --teacher`) solo sigue con esa llave, o con su botón. Un robot sin dueño es libre para todos."),
        ends=("To make a robot forget its keys: hold its button down, switch it on, and hold it for 10 s more, until it beeps.",
              "Para que un robot olvide sus llaves: mantén pulsado su botón, enciéndelo y no lo sueltes durante 10 s más, hasta que suene."),
    ),
    "disown": Verb(
        "claim", ("disown", "disown"), ("give the robot up: anybody may drive it", "libera el robot: lo maneja cualquiera"),
        ("Takes the owner's key away from the robot, so that it is free. That needs the owner's key or the teacher's.",
         "Le quita al robot la llave del dueño: queda libre. Hace falta la llave del dueño o la del docente."),
    ),
    "keys": Verb(
        "claim", ("keys", "keys"), ("list the robots whose keys this computer has", "los robots cuya llave tiene esta computadora"),
        ("Lists the robots whose keys this computer has; no key is printed. `--export` writes them to a file that only you can read: a class list for another computer, which takes it with `--import`. Whoever has that file can drive those robots. `--forget` deletes the keys of one robot, after the robot itself has forgotten them. On Windows such a file has the permissions of its folder: keep it in your own.",
         "Lista los robots cuyas llaves tiene esta computadora; no se imprime ninguna llave. `--export` las escribe en un archivo que solo tú puedes leer: la lista de la clase para otra computadora, que la lee con `--import`. Quien tiene ese archivo maneja esos robots. `--forget` quita las llaves de un robot que ya las olvidó. En Windows un archivo así tiene los permisos de su carpeta: guárdalo en la tuya."),
        ("[--export FILE|--import FILE|--forget ROBOT] [--json]", "[--export ARCHIVO|--import ARCHIVO|--forget ROBOT] [--json]"),
    ),
    "name": Verb(
        SETTINGS, ("name TINI", "name TINI"), ("name the robot", "le pone nombre al robot"),
        ("Names the robot. It keeps its name when it is switched off.",
         "Le pone nombre al robot, que lo conserva cuando se apaga."),
        ("NEW [options]", "NUEVO [opciones]"),
    ),
    "trim": Verb(
        SETTINGS, ("trim", "trim"), ("make the robot drive straight, and as far as you say", "hace que el robot vaya derecho, y tanto como dices"),
        ("Makes a robot drive straight, and as far as a program says: turns its motors and asks what you see and, if you have a tape measure and a protractor, what you measure. The robot keeps the result in its own memory, for every program. You change no wire and flash nothing.",
         "Hace que un robot vaya en línea recta, y tanto como dice un programa: hace girar sus motores, pregunta qué ves y, si tienes cinta métrica y transportador, qué mides, y el robot guarda el resultado en su memoria, para cualquier programa. No se cambia ningún cable ni se escribe otro firmware."),
    ),
    "text": Verb(
        SETTINGS, ("text on", "text on"), ("let lines of text drive your robot, or not", "deja manejarlo con líneas de texto, o no"),
        ("Lets lines of text, which anybody may type on a phone, drive a robot with an owner, until it is switched off. So does its button, held down for 2 s. The line S always stops a robot.",
         "Deja que un robot con dueño se maneje con líneas de texto, que cualquiera puede escribir en un teléfono, hasta que se apague. Lo mismo hace su botón, pulsado 2 s. La línea S siempre detiene el robot."),
        ("on|off [options]", "on|off [opciones]"),
    ),
    "wifi": Verb(
        SETTINGS, ("wifi NETWORK", "wifi RED"), ("connect your robot to a WiFi network", "conecta tu robot a una red WiFi"),
        ("Makes a robot with an ESP32 join a network, now and whenever it is switched on; with `--access-point` the robot opens one itself. tsc asks for the password without showing it, or reads it from the first line of standard input if nobody is at a terminal. The password appears in no argument and in no file of this computer, listeners cannot read it, and no robot shows it. Only a robot with an owner takes a network, from a computer with its key. Without a network, tsc says which one the robot has. With `--broker` the robot also connects to an MQTT broker in that network, for `tsc class`: by the broker's name, or, if the network does not know that name, at the broker's present address.",
         "Conecta un robot con ESP32 a una red, ahora y cada vez que se encienda; con `--access-point` la abre él mismo. tsc pide la contraseña sin mostrarla; si nadie escribe, es la primera línea de la entrada estándar. No queda en ningún argumento ni archivo de esta computadora, quien escuche no puede leerla mientras va al robot, y ningún robot la muestra. Solo un robot con dueño acepta una red, desde una computadora con su llave. Sin una red, tsc dice cuál tiene el robot. Con `--broker` el robot se conecta además a un broker MQTT de esa red, para `tsc class`: por su nombre o, si la red no lo conoce, en la dirección que tiene ahora."),
        ("[NETWORK] [options]", "[RED] [opciones]"),
    ),
    "firmware": Verb(
        BUILDING, ("firmware --port COM3", "firmware --port COM3"),
        ("put a robot's firmware on its board", "pone el firmware de un robot en su placa"),
        ("Writes a robot's firmware to its board, over the USB cable, and reads it back. First unplug the HC-05, or whatever else is on pins 0 and 1. Firmware that is not ready yet is built first, with PlatformIO; the first time tsc says how much it will download for that, and asks.",
         "Escribe el firmware de un robot en su placa, por el cable USB, y comprueba que quedó bien. Mientras tanto, ten desconectado el HC-05, o lo que esté en los pines 0 y 1. Si el firmware todavía no está listo, primero se compila, con PlatformIO; la primera vez dice cuánto va a descargar para eso y pide permiso."),
        ("--port P [--robot NAME|FILE] [--board BOARD]\n--build [--robot NAME|FILE] [--board BOARD]\n--list",
         "--port P [--robot NOMBRE|ARCHIVO] [--board PLACA]\n--build [--robot NOMBRE|ARCHIVO] [--board PLACA]\n--list"),
        ("It needs avrdude; for an ESP32 it needs only PlatformIO.", "Necesita avrdude; para un ESP32, solo PlatformIO."),
    ),
    "wiring": Verb(
        BUILDING, ("wiring", "wiring"),
        ("show how a robot is wired, as a list or as a page", "cómo se conecta un robot, en lista o página"),
        ("Shows how a robot is wired: which wire goes from which pin to which part.",
         "Muestra cómo se conecta un robot: qué cable va de qué pin a qué pieza."),
    ),
    "board": Verb(
        BUILDING, ("board myrobot.toml", "board mirobot.toml"),
        ("tell the firmware how a robot is wired", "le dice al firmware cómo está conectado un robot"),
        ("Writes the header that tells the firmware how a robot is wired. Write it to src/boards/kits/own.h in vm_arduino, and the sketch there is for your robot.",
         "Escribe la cabecera que le dice al firmware cómo está conectado un robot. El sketch de vm_arduino es para tu robot cuando la cabecera es su archivo src/boards/kits/own.h."),
    ),
    "module": Verb(
        BUILDING, ("module --port P", "module --port P"),
        ("set name, PIN and speed of a Bluetooth module", "nombre, PIN y velocidad de un módulo Bluetooth"),
        ("Sets up an HC-05, HC-06 or HM-10, or one of their clones: finds it at any speed, says which one it is, sets its name, its PIN and its speed, and reads them back. Without such an option it only says what it has found. Connect the module to a USB adapter, or to a board held in reset (a wire from RESET to GND). An HC-05 takes these commands if its button was held down when it got power. If a set-up is interrupted, run the command again to finish it.",
         "Configura un HC-05, HC-06 o HM-10, o una de sus copias: lo encuentra a cualquier velocidad, dice cuál es, le pone su nombre, su PIN y su velocidad, y comprueba lo que informa el módulo. Sin esas opciones solo dice lo que encontró. El módulo está en un adaptador USB, o en una placa que está en reset (un cable de RESET a GND). Un HC-05 acepta estos comandos si su botón estaba pulsado cuando recibió energía. Si una configuración se interrumpe, la siguiente la termina."),
        ("--port P [options]", "--port P [opciones]"),
        ends=("A robot cannot set up its own module: both share the wires to the computer, and the module listens only to the robot's side.\n"
              "The modules' answers come from their data sheets and users; nobody has tried a physical module.",
              "Un robot no puede configurar su propio módulo: los dos comparten los cables hacia la computadora, y el módulo solo escucha el lado del robot.\n"
              "Las respuestas de los módulos son las de sus manuales y usuarios; no se probó ningún módulo físico."),
    ),
    "conform": Verb(
        BUILDING, ("conform --port P", "conform --port P"),
        ("test a robot or a machine that you have made", "prueba un robot o una máquina que hiciste"),
        ("Tests whether firmware or a machine that somebody has written, in any language, does what the specification says, and prints the differences. With `--port` it tests a robot: frames, programs, refusals, stops; no motor turns and nothing is saved, but afterwards the robot holds another program in memory. With `--machine` it asks a machine for several hundred runs and compares its output line by line; docs/conformance.md describes the questions.",
         "Prueba si un firmware o una máquina, escritos por cualquiera en cualquier lenguaje, hacen lo que dice la especificación, e imprime las diferencias. Con `--port` habla con un robot: mensajes, programas, rechazos, paradas; ningún motor gira, no se guarda nada, y el robot queda con otro programa en memoria. Con `--machine` le pide a una máquina varios cientos de ejecuciones y compara línea por línea lo que imprime. docs/conformance.md dice cómo se le pregunta."),
        ("--port P [--baud N] [options]\n--machine COMMAND [options]", "--port P [--baud N] [opciones]\n--machine COMANDO [opciones]"),
        ends=("Exit code: 0 if everything agrees, 1 if something differs, 2 if the command does not start, 3 if nothing answers on the port or the port vanishes.",
              "Código de salida: 0 si todo coincide, 1 si algo es distinto, 2 si el comando no arranca, 3 si nada responde en el puerto o el puerto desaparece."),
    ),
    "help": Verb(
        ITSELF, ("help upload", "help upload"), ("say more about a command", "explica un comando"),
        ("Says what a command does and which options it has, as `tsc COMMAND --help` does. Without a command it lists the ten that most people need, with `all` every one. Other words find the commands that do what you describe: `tsc help \"put firmware on\"`. `tsc ayuda` is the same.",
         "Dice qué hace un comando y qué opciones tiene, igual que `tsc COMANDO --help`. Sin comando lista los diez que más se usan; con `todo`, los lista todos. Si escribes otras palabras, busca los comandos que hacen eso: `tsc help \"poner firmware\"`. `tsc ayuda` es lo mismo."),
    ),
    "completion": Verb(
        ITSELF, ("completion bash", "completion bash"),
        ("let the Tab key complete commands", "hace que la tecla Tab complete los comandos"),
        ("Prints what a shell needs so that the Tab key completes commands, options and their values. To switch it on, add a line to a file that the shell reads when it starts.",
         "Imprime lo que una terminal necesita para que la tecla Tab complete comandos, opciones y sus valores. Se activa con una línea en un archivo que la terminal lee al empezar."),
        ends=("`~/.bashrc`, at its end: `eval \"$(tsc completion bash)\"`\n"
              "`~/.zshrc`, at its end: `autoload -Uz compinit && compinit; eval \"$(tsc completion zsh)\"`\n"
              "PowerShell, in the file `$PROFILE`: `tsc completion powershell | Out-String | Invoke-Expression`",
              "`~/.bashrc`, al final: `eval \"$(tsc completion bash)\"`\n"
              "`~/.zshrc`, al final: `autoload -Uz compinit && compinit; eval \"$(tsc completion zsh)\"`\n"
              "PowerShell, en el archivo `$PROFILE`: `tsc completion powershell | Out-String | Invoke-Expression`"),
    ),
}
# fmt: on
