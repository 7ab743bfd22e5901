"""The sentences of `tsc` itself, in English and Spanish; those on programs: `diagnostics`."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module

from tiniscript.source import printable

LONGEST = 2000  # characters of what is put into a sentence

# fmt: off
TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "did_you_mean": ("Did you mean {near}?", "¿Quisiste decir {near}?"),
    "stopped": ("Stopped.", "Detenido."),
    "bug": ("tsc met something it was not made for. That is our mistake, not yours.\n"
            "Please report it with your program and this line:  {what}\n"
            "(TINISCRIPT_DEBUG=1 shows more.)",
            "tsc encontró algo para lo que no está hecho. El error es nuestro, no tuyo.\n"
            "Por favor, repórtalo con tu programa y esta línea:  {what}\n"
            "(TINISCRIPT_DEBUG=1 muestra más.)"),
    "version_page": ("without the page of tsc studio, which a clone builds",
                     "sin la página de tsc studio, que se construye en un clon"),
    "version_firmware": ("without ready firmware: tsc firmware builds it when it is first written",
                         "sin firmware listo: tsc firmware lo compila la primera vez que se escribe"),
    "pager_keys": ("Space: more   q: end", "Espacio: sigue   q: salir"),
    # wrong use
    "plain": ("tsc: {said}", "tsc: {said}"),
    "no_verb": ("tsc: there is no command {found}. Try:  tsc --help",
                "tsc: no existe el comando {found}. Prueba:  tsc --help"),
    "none_does": ("tsc: found no command for “{found}”. Try other words, or:  tsc help all",
                  "tsc: no hay un comando para “{found}”. Prueba otras palabras, o:  tsc help todo"),
    "file_without_verb": ("tsc: what should tsc do with {found}? Try:  tsc upload {found} --virtual   or:  tsc run {found}   or, with a robot:  tsc upload {found}",
                          "tsc: ¿qué hago con {found}? Prueba:  tsc upload {found} --virtual   o:  tsc run {found}   o, con un robot:  tsc upload {found}"),
    "text_without_verb": ("tsc: what should tsc do with this program? Try:  tsc upload -e {found} --virtual   or, with a robot:  tsc live {found}",
                          "tsc: ¿qué hago con este programa? Prueba:  tsc upload -e {found} --virtual   o, con un robot:  tsc live {found}"),
    "file_really": ("tsc: there is no file {file}; tsc uses {real}, its full name.",
                    "tsc: no existe el archivo {file}; tsc usa {real}, su nombre completo."),
    "no_program": ("tsc: which program? Give a file, - for standard input, or -e \"SI|F(2, 80)\".",
                   "tsc: ¿qué programa? Indica un archivo, - para la entrada estándar, o -e \"SI|F(2, 80)\"."),
    "two_programs": ("tsc: one program at a time: a file, - or -e.",
                     "tsc: un programa a la vez: un archivo, - o -e."),
    "bad_option": ("tsc: {detail}. Try:  tsc {verb} --help", "tsc: {detail}. Prueba:  tsc {verb} --help"),
    "bad_choice": ("tsc: {option} takes {known}, not {found}.", "tsc: {option} acepta {known}, no {found}."),
    "or": ("or", "o"),
    "file_missing": ("tsc: there is no file {file}. Check its name and the folder you are in.",
                     "tsc: no existe el archivo {file}. Revisa su nombre y la carpeta en la que estás."),
    "file_directory": ("tsc: {file} is a folder. Give a file in it.",
                       "tsc: {file} es una carpeta. Indica un archivo de ella."),
    "file_forbidden": ("tsc: you have no permission to read {file}. Ask its owner, or copy it to a folder of yours.",
                       "tsc: no tienes permiso para leer {file}. Pídeselo a su dueño o cópialo a una carpeta tuya."),
    "file_unreadable": ("tsc: {file} cannot be read: {why}. Copy it to another folder and try again.",
                        "tsc: no se puede leer {file}: {why}. Cópialo a otra carpeta y prueba otra vez."),
    "unwritable": ("tsc: {file} cannot be written: {why}. Choose another place with -o; nothing was changed.",
                   "tsc: no se puede escribir {file}: {why}. Elige otro lugar con -o; no se cambió nada."),
    "no_windows_name": ("Windows has no file of this name", "Windows no tiene archivos con este nombre"),
    "unwritable_map": ("tsc: {file} cannot be written: {why}. Choose another place with --map.",
                       "tsc: no se puede escribir {file}: {why}. Elige otro lugar con --map."),
    "unwritable_source": ("tsc: {file} cannot be written: {why}. The file stays as it was.",
                          "tsc: no se puede escribir {file}: {why}. El archivo queda como estaba."),
    "needs_output": ("tsc: where to? Without a file there is no name for the image. Try:  -o prog.bin",
                     "tsc: ¿a dónde? Sin un archivo la imagen no tiene nombre. Prueba:  -o prog.bin"),
    "text_has_no_map": ("tsc: a line of text has no map. Leave out --map or --text.",
                        "tsc: una línea de texto no tiene mapa. Quita --map o --text."),
    "level_needs_text": ("tsc: --text-level goes with --text. Try:  tsc compile --text --text-level {level}",
                         "tsc: --text-level va con --text. Prueba:  tsc compile --text --text-level {level}"),
    "over_map": ("tsc: the map needs a file of its own, not {file}. Choose another name with --map.",
                 "tsc: el mapa necesita un archivo propio, no {file}. Elige otro nombre con --map."),
    "over_foreign": ("tsc: {file} is there already, and tsc has not made it. Choose another name with {option}, or delete it first; nothing was changed.",
                     "tsc: {file} ya existe, y no lo hizo tsc. Elige otro nombre con {option}, o bórralo antes; no se cambió nada."),
    "over_input": ("tsc: {option} would overwrite {file}, which is {what} of this command: {other}. Choose another name with {option}; nothing was changed.",
                   "tsc: {option} reemplazaría {file}, que es {what} de este comando: {other}. Elige otro nombre con {option}; no se cambió nada."),
    "same_outputs": ("tsc: {option} {file} and {second} {other} are the same file. Give each its own name; nothing was changed.",
                     "tsc: {option} {file} y {second} {other} son el mismo archivo. Ponle a cada uno su propio nombre; no se cambió nada."),
    "path_program": ("the program", "el programa"),
    "path_robot": ("the robot profile", "el perfil de robot"),
    "path_world": ("the world", "el mundo"),
    "path_memory": ("the memory", "la memoria"),
    "path_port": ("the port", "el puerto"),
    "path_stdin": ("the standard input", "la entrada estándar"),
    "full": ("tsc: the output cannot be written: {why}. Free some space, or send it elsewhere.",
             "tsc: no se puede escribir la salida: {why}. Libera espacio o envíala a otro lugar."),
    "two_texts": ("tsc: one -e at a time. Put the lines into one program, with ; between them.",
                  "tsc: un solo -e a la vez. Pon las líneas en un solo programa, separadas con ;."),
    "needs_text": ("tsc: {file} is a compiled program; tsc {verb} needs its text. Try:  tsc show {file}",
                   "tsc: {file} es un programa compilado; tsc {verb} necesita su texto. Prueba:  tsc show {file}"),
    "no_sensor": ("tsc: {robot} has no sensor {found}. It has: {known}.",
                  "tsc: {robot} no tiene el sensor {found}. Tiene: {known}."),
    "no_sensors": ("no sensors", "ningún sensor"),
    "sensor_form": ("tsc: --sensor needs a name and readings. Try:  --sensor {example}",
                    "tsc: --sensor necesita un nombre y lecturas. Prueba:  --sensor {example}"),
    "sensor_twice": ("tsc: {name} has two lists of readings. Put all of them into one:  --sensor {name}=1,2,3",
                     "tsc: {name} tiene dos listas de lecturas. Ponlas todas en una:  --sensor {name}=1,2,3"),
    "sensor_value": ("tsc: {found} is not a reading of {name}. {name} gives {range}.",
                     "tsc: {found} no es una lectura de {name}. {name} da {range}."),
    "range_number": ("a number from {low} to {high}", "un número de {low} a {high}"),
    "range_yes_no": ("TRUE or FALSE", "TRUE o FALSE"),
    "bad_number": ("tsc: {option} takes {range}, not {found}.", "tsc: {option} acepta {range}, no {found}."),
    "range_whole": ("a whole number from {low} to {high}", "un número entero de {low} a {high}"),
    "no_wasmtime": ("tsc: --machine cpp needs wasmtime, which cannot be used here: {why}.\n"
                    "Install it:  {how}   or try:  --machine python",
                    "tsc: --machine cpp necesita wasmtime, que aquí no se puede usar: {why}.\n"
                    "Instálalo:  {how}   o prueba:  --machine python"),
    "no_code": ("tsc: there is no code {found}. The list:  tsc explain",
                "tsc: no existe el código {found}. La lista:  tsc explain"),
    "profile_refused": ("tsc: the robot profile {file} cannot be used:\n{reasons}",
                        "tsc: el perfil de robot {file} no se puede usar:\n{reasons}"),
    "no_firmware": ("tsc: there is no firmware for the board {chip} yet. There is for: {known}.",
                    "tsc: todavía no hay firmware para la placa {chip}. Hay para: {known}."),
    "board": ("{file}: how {robot} is wired, for the board {chip}. {now}",
              "{file}: cómo está conectado {robot}, para la placa {chip}. {now}"),
    "board_here": ("Now:  {build}", "Ahora:  {build}"),
    "board_elsewhere": ("The build reads it only as src/boards/kits/own.h in the folder vm_arduino. Put it there:  tsc board {robot} -o {home}   Then:  {build}",
                        "La compilación solo lo lee como src/boards/kits/own.h en la carpeta vm_arduino. Ponlo ahí:  tsc board {robot} -o {home}   Después:  {build}"),
    "wiring": ("{file}: how {robot} is wired. Open it in a browser, or print it.",
               "{file}: cómo se conecta {robot}. Ábrelo en un navegador, o imprímelo."),
    "wiring_page": ("As a page with a drawing:  tsc wiring -o wiring.html",
                    "Como página con un dibujo:  tsc wiring -o conexiones.html"),
    "sketch": ("{file}: the program as an Arduino sketch for {robot}. Open it in the Arduino IDE, in a folder of the same name.",
               "{file}: el programa como sketch de Arduino para {robot}. Ábrelo en el Arduino IDE, en una carpeta con el mismo nombre."),
    "sketch_needs_text": ("tsc: {file} is a compiled program; a sketch is made from its text. Try:  tsc show --arduino prog.ts",
                          "tsc: {file} es un programa compilado; un sketch se hace a partir de su texto. Prueba:  tsc show --arduino prog.ts"),
    "sketch_or_json": ("tsc: --arduino prints a sketch, --json data: one of them at a time.",
                       "tsc: --arduino imprime un sketch; --json, datos. Usa uno a la vez."),
    "sketch_no_board": ("tsc: there are no sketches for the board {chip} yet. There are for: {known}. For the same program on an Uno:  tsc show --arduino --robot tinibot",
                        "tsc: todavía no hay sketches para la placa {chip}. Hay para: {known}. El mismo programa para un Uno:  tsc show --arduino --robot tinibot"),
    "sketch_no_ways": ("tsc: in a sketch CM and DEG take numbers, and so does the power beside them. Without a robot:  tsc run {file}",
                       "tsc: en un sketch, CM y DEG llevan números, y la potencia de al lado también. Sin robot:  tsc run {file}"),
    "sketch_no_tasks": ("tsc: a sketch does one thing after the other, so it has no TASK and no WHEN. Without a robot:  tsc run {file}",
                        "tsc: un sketch hace una cosa después de otra; por eso no tiene TASK ni WHEN. Sin robot:  tsc run {file}"),
    "output_needs_arduino": ("tsc: -o is where a sketch goes. Try:  tsc show --arduino prog.ts -o {file}",
                             "tsc: -o dice a dónde va un sketch. Prueba:  tsc show --arduino prog.ts -o {file}"),
    # images
    "image_NOT_AN_IMAGE": ("refused: {file} is not a compiled TiniScript program. Make one:  tsc compile prog.ts",
                           "rechazado: {file} no es un programa TiniScript compilado. Compila uno:  tsc compile prog.ts"),
    "image_BAD_HEADER": ("refused: {file} begins with a header that no program has. Compile the program again.",
                         "rechazado: {file} empieza con una cabecera que ningún programa tiene. Compila el programa otra vez."),
    "image_TRUNCATED": ("refused: the end of {file} is missing. Compile the program again.",
                        "rechazado: a {file} le falta el final. Compila el programa otra vez."),
    "image_TRAILING": ("refused: {file} is longer than the program in it. Compile the program again.",
                       "rechazado: {file} es más largo que el programa que contiene. Compila el programa otra vez."),
    "image_DAMAGED": ("refused: {file} is damaged, its checksum does not fit. Compile the program again.",
                      "rechazado: {file} está dañado, su suma de control no coincide. Compila el programa otra vez."),
    "image_OTHER_VERSION": ("refused: {file} is for version {theirs} of the machine, this is {ours}. Compile the program again.",
                            "rechazado: {file} es para la versión {theirs} de la máquina, esta es {ours}. Compila el programa otra vez."),
    "image_UNKNOWN_START": ("refused: {file} has a start mode that this tsc does not know. Compile the program again.",
                            "rechazado: {file} tiene un modo de inicio que este tsc no conoce. Compila el programa otra vez."),
    "image_UNKNOWN_NEEDS": ("refused: {file} needs something that this tsc does not have. Install a newer tsc.",
                            "rechazado: {file} necesita algo que este tsc no tiene. Instala un tsc más nuevo."),
    "no_ways": ("refused: {robot} cannot go by centimetres or degrees. Without a robot:  tsc run {file}",
                "rechazado: {robot} no puede avanzar por centímetros ni girar por grados. Sin robot:  tsc run {file}"),
    "no_tasks": ("refused: {robot} has no TASK and no WHEN. Without a robot:  tsc run {file}",
                 "rechazado: {robot} no tiene TASK ni WHEN. Sin robot:  tsc run {file}"),
    "image_OTHER_KIT": ("refused: {file} is for another robot, not for {robot}. Name it:  --robot {theirs}",
                        "rechazado: {file} es para otro robot, no para {robot}. Indícalo:  --robot {theirs}"),
    "image_PING_WITH_CODE": ("refused: {file} starts with PING, and yet has instructions. Compile the program again.",
                             "rechazado: {file} empieza con PING y sin embargo tiene instrucciones. Compila el programa otra vez."),
    "image_code": ("refused: the code in {file} breaks rule {number} ({name}) at offset {offset}. Compile the program again.",
                   "rechazado: el código de {file} rompe la regla {number} ({name}) en la posición {offset}. Compila el programa otra vez."),
    # sentences of the verbs
    "compiled": ("{source} -> {target}   {image} bytes ({code} of code)   stack {stack} of {stacks}{runs}",
                 "{source} -> {target}   {image} bytes ({code} de código)   pila {stack} de {stacks}{runs}"),
    "compiled_text": ("{source} -> {target}   {bytes} bytes of text   {code} bytes of code in a robot that reads it",
                      "{source} -> {target}   {bytes} bytes de texto   {code} bytes de código en un robot que lo lee"),
    "runs": ("   runs {how}", "   dura {how}"),
    "runs_exactly": ("{least} s", "{least} s"),
    "runs_between": ("{least} to {most} s", "de {least} a {most} s"),
    "runs_at_least": ("at least {least} s", "al menos {least} s"),
    "runs_forever": ("until it is stopped", "hasta que lo detengan"),
    "file_no_file": ("tsc: {file} is not a text file. Give the file that has the program.", "tsc: {file} no es un archivo de texto. Indica el archivo donde está el programa."),
    "no_mistakes": ("{file}: no mistakes.", "{file}: sin errores."),
    "count_mistake": ("1 mistake", "1 error"),
    "count_mistakes": ("{n} mistakes", "{n} errores"),
    "count_warning": ("1 warning", "1 aviso"),
    "count_warnings": ("{n} warnings", "{n} avisos"),
    "and_more": ("… and {n} more.", "… y {n} más."),
    "fault_at": ("fault {fault}: {what}\n{place}", "falla {fault}: {what}\n{place}"),
    "fault_line": ("line {line}{task}:  {shown}", "línea {line}{task}:  {shown}"),
    "fault_line_of": ("{name}, line {line}{task}:  {shown}", "{name}, línea {line}{task}:  {shown}"),
    "fault_in_task": (", in the {word} of line {line}", ", en el {word} de la línea {line}"),
    "fault_in_main": (", in the main task", ", en la tarea principal"),
    "fault_no_line": ("at offset {offset} of the code; its text is not known here.",
                      "en la posición {offset} del código; aquí no se conoce su texto."),
    "fault_OVERFLOW": ("a result does not fit into a number (-2147483.648 to 2147483.647). Use smaller numbers.",
                       "un resultado no cabe en un número (de -2147483.648 a 2147483.647). Usa números más pequeños."),
    "fault_DIVIDE_BY_ZERO": ("something is divided by 0. Check with IF that it is not 0 before you divide.",
                             "algo se divide entre 0. Comprueba con IF que no sea 0 antes de dividir."),
    "fault_NO_POWER": ("the robot never gets that far with this power. Use more power.",
                       "con esa potencia el robot nunca llega tan lejos. Usa más potencia."),
    # what --show draws
    "time": ("time", "tiempo"),
    "motor_left": ("left motor", "motor izq."),
    "motor_right": ("right motor", "motor der."),
    "motors": ("motors", "motores"),
    "before": ("before: {values}", "antes: {values}"),
    "ended_DONE": ("done", "listo"),
    "ended_FAULT": ("fault", "falla"),
    "ended_LIMIT": ("cut at the limit", "cortado en el límite"),
    "fault_BAD_CODE": ("the machine met code that it cannot have accepted. Compile the program again; if it happens again, report it.",
                       "la máquina encontró código que no debió aceptar. Compila el programa otra vez; si vuelve a pasar, repórtalo."),
    "formatted": ("{file}: laid out.", "{file}: ordenado."),
    "would_format": ("{file}: not in the usual layout. Try:  tsc fmt {file}",
                     "{file}: no está ordenado de la forma usual. Prueba:  tsc fmt {file}"),
    "is_formatted": ("{file}: is in the usual layout.", "{file}: ya está ordenado."),
    "fmt_too_large": ("tsc: laid out, {file} would be larger than 1 MB. Split the program; nothing was changed.",
                      "tsc: ordenado, {file} pasaría de 1 MB. Divide el programa; quedó como estaba."),
    "head": ("{file}: starts {start}, {robot}, {code} bytes of code, {image} bytes in all, checksum {checksum}",
             "{file}: inicia {start}, {robot}, {code} bytes de código, {image} bytes en total, suma {checksum}"),
    "any_robot": ("any robot", "cualquier robot"),
    "for_robot": ("for {robot}", "para {robot}"),
    "unknown_robot": ("for an unknown robot ({kit})", "para un robot desconocido ({kit})"),
}
# fmt: on


# What is counted, right behind its number, and how one of it is called; other words have a
# sentence of their own for one.
ONE = {"bytes": "byte", "checks": "check", "pruebas": "prueba"}


class Said(str):
    """A sentence, or several: `format` makes all values printable.

    A value may come from a file or a robot: it must not move the cursor or begin a line. A value
    that is a `Said` itself stays unchanged.
    """

    __slots__ = ()

    def format(self, *values: object, **named: object) -> Said:
        plain = {key: _plain(value) for key, value in named.items()}
        template = str(self)
        for key, value in plain.items():
            if value in (1, "1"):
                for several, one in ONE.items():
                    template = template.replace(f"{{{key}}} {several}", f"{{{key}}} {one}")
        return Said(template.format(*map(_plain, values), **plain))


def _plain(value: object) -> object:
    if isinstance(value, str) and not isinstance(value, Said):
        return printable(value, LONGEST)
    return value


# Sentences that few commands say: the files of this folder, and their tables. Each is imported where
# no sentence was found before it.
_LATER = (
    ("checking", "CHECK_TEXTS"),
    ("robot", "LINK_TEXTS"),
    ("simulator", "VIRTUAL_TEXTS"),
    ("firmware", "FLASH_TEXTS"),
    ("doctor", "DOCTOR_TEXTS"),
    ("selftest", "SELFTEST_TEXTS"),
    ("network", "NETWORK_TEXTS"),
)


def text(key: str, language: str) -> str:
    """Return a sentence as `Said`."""
    for each in tables():
        if key in each:
            english, spanish = each[key]
            return Said(spanish if language == "es" else english)
    raise KeyError(key)


def has_text(key: str) -> bool:
    return any(key in each for each in tables())


def tables() -> Iterator[Mapping[str, tuple[str, str]]]:
    """Return all sentences by key, English and Spanish, table by table."""
    yield TEXTS
    for file, name in _LATER:
        yield getattr(import_module(f"tiniscript.cli.texts.{file}"), name)


def language_of(arguments: Sequence[str], environ: Mapping[str, str] = os.environ) -> str:
    """Return en or es: from `--lang`, else from the locale, else en."""
    for k, word in enumerate(arguments):
        value = word[7:] if word.startswith("--lang=") else None
        if word == "--lang" and k + 1 < len(arguments):
            value = arguments[k + 1]
        if value in ("en", "es"):
            return value
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        if environ.get(name):
            return "es" if environ[name].lower().startswith("es") else "en"
    return "es" if _system_language().startswith("es") else "en"


def _system_language() -> str:
    """Return the language of Windows' own settings, which no variable names."""
    if sys.platform != "win32":
        return ""
    import locale

    name = (locale.getlocale()[0] or "").lower()
    return "es" if name.startswith(("es", "spanish")) else name
