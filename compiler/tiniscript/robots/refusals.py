"""The sentences about a refused profile: a cause and a remedy, in English and Spanish.

Knows every code of ProfileRefused. Does not know when a code applies.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from tiniscript.robots.profile import LANGUAGES, ProfileRefused, Reason
from tiniscript.source import printable

SHOWN_CHARACTERS = 40
DEVICE = re.compile(r"board\.(?:sensors|actuators)\.[^.]*")  # the path of its table

# The sentence of a code with `/near` is used if `near` holds a similar name.
SENTENCES: dict[str, dict[str, str]] = {
    # finding the file
    "no_such_robot": {
        "en": "There is no robot {name}. Take one of these: {known}; or give a .toml file.",
        "es": "No hay un robot {name}. Elige uno de estos: {known}; o indica un archivo .toml.",
    },
    "no_such_robot/near": {
        "en": "There is no robot {name}. Did you mean {near}? The robots are: {known}.",
        "es": "No hay un robot {name}. ¿Quisiste decir {near}? Los robots son: {known}.",
    },
    "file_missing": {
        "en": "There is no file {file}. Look at its name and at its folder.",
        "es": "No existe el archivo {file}. Revisa el nombre y la carpeta.",
    },
    "file_is_directory": {
        "en": "{file} is a folder. Give the .toml file that is in it.",
        "es": "{file} es una carpeta. Indica el archivo .toml que está dentro.",
    },
    "file_unreadable": {
        "en": "The file {file} cannot be read. Look at its permissions.",
        "es": "No se puede leer el archivo {file}. Revisa sus permisos.",
    },
    "file_too_large": {
        "en": "{file} has more than {limit}. Check that it is a robot profile.",
        "es": "{file} pesa más de {limit}. Comprueba que sea el perfil de un robot.",
    },
    "file_not_utf8": {
        "en": "Line {line} of {file} is not UTF-8. Save the file again as UTF-8.",
        "es": "La línea {line} de {file} no está en UTF-8. Guarda de nuevo el archivo como UTF-8.",
    },
    # the file as a whole
    "not_toml": {
        "en": "Line {line} is not TOML. Look there for a missing quote, bracket or equals sign.",
        "es": "La línea {line} no es TOML. Busca ahí si faltan comillas, un corchete o un igual.",
    },
    "key_twice": {
        "en": "Line {line} writes a key or a table a second time. Leave only one of them.",
        "es": "La línea {line} repite una clave o una tabla. Deja solo una de ellas.",
    },
    "missing": {
        "en": "{path} is missing. Add it, for example: {example}",
        "es": "Falta {path}. Agrégalo, por ejemplo: {example}",
    },
    "unknown_key": {
        "en": "{path} means nothing in a profile. The keys there are: {known}.",
        "es": "{path} no significa nada en un perfil. Las claves ahí son: {known}.",
    },
    "unknown_key/near": {
        "en": "{path} means nothing in a profile. Did you mean {near}?",
        "es": "{path} no significa nada en un perfil. ¿Quisiste decir {near}?",
    },
    "wrong_type": {
        "en": "{path} is {found}. Write {wanted} there.",
        "es": "{path} es {found}. Escribe ahí {wanted}.",
    },
    "not_one_of": {
        "en": "{path} is {found}. Write one of these: {choices}.",
        "es": "{path} es {found}. Escribe uno de estos: {choices}.",
    },
    # numbers
    "out_of_range": {
        "en": "{path} is {found}. Write a number from {low} to {high}.",
        "es": "{path} es {found}. Escribe un número de {low} a {high}.",
    },
    "too_precise": {
        "en": "{path} is {found}, with more than three decimals. Write at most three.",
        "es": "{path} es {found}, con más de tres decimales. Escribe tres como máximo.",
    },
    "number_odd": {
        "en": "{path} is {found}. Write the number with digits and at most one point.",
        "es": "{path} es {found}. Escribe el número con cifras y un punto como máximo.",
    },
    "range_empty": {
        "en": "In {path} the first number is not the smaller one. Write [low, high].",
        "es": "En {path} el primer número no es el menor. Escribe [menor, mayor].",
    },
    "range_not_whole": {
        "en": "{path} of an actuator has decimals. Write whole numbers.",
        "es": "{path} de un actuador tiene decimales. Escribe números enteros.",
    },
    # the kit
    "name_bad": {
        "en": "{path} is {found}. Write a letter, then letters, digits or _, no accents or ñ.",
        "es": "{path} es {found}. Escribe una letra y luego letras, cifras y _, sin tildes ni ñ.",
    },
    "name_too_long": {
        "en": "{path} is {found}, which is too long. Write at most {most} characters.",
        "es": "{path} es {found}, demasiado largo. Escribe {most} caracteres como máximo.",
    },
    "name_is_word": {
        "en": "{path} is {found}, a word of TiniScript. Choose another name.",
        "es": "{path} es {found}, una palabra de TiniScript. Elige otro nombre.",
    },
    "name_twice": {
        "en": "{path} uses the name {found} a second time. Give each device its own name.",
        "es": "{path} usa el nombre {found} por segunda vez. Dale a cada uno su propio nombre.",
    },
    "unknown_kind": {
        "en": "{path} is {found}, which is no kind. Write one of these: {choices}.",
        "es": "{path} es {found}, que no es un tipo. Escribe uno de estos: {choices}.",
    },
    "not_for_yes_no": {
        "en": "{path} is only for numbers, and this device is yes/no. Take the line out.",
        "es": "{path} es solo para números y este dispositivo es yes/no. Quita esa línea.",
    },
    "unit_bad": {
        "en": "{path} is {found}. Write at most {most} characters without spaces, such as cm.",
        "es": "{path} es {found}. Escribe como máximo {most} caracteres sin espacios, como cm.",
    },
    "too_many": {
        "en": "{path} has {found} devices. Leave at most {most}.",
        "es": "{path} tiene {found} dispositivos. Deja {most} como máximo.",
    },
    "not_in_kit": {
        "en": "{path}: [kit] has no {name} for it. Add it to [kit] or take this out.",
        "es": "{path}: [kit] no tiene {name} para esto. Agrégalo a [kit] o quita esto.",
    },
    "not_in_kit/near": {
        "en": "{path}: [kit] has no {name} for it. Did you mean {near}?",
        "es": "{path}: [kit] no tiene {name} para esto. ¿Quisiste decir {near}?",
    },
    "label_bad": {
        "en": "{path} is empty or cannot be printed. Write 1 to {most} characters in one line.",
        "es": "{path} está vacío o no se puede mostrar. Escribe de 1 a {most} caracteres"
        " en una línea.",
    },
    "at_stop_of_no_servo": {
        "en": "{path}: a stop always turns this off, whatever the profile says. Take the line out;"
        " only a servo can hold on.",
        "es": "{path}: una parada siempre apaga esto, diga lo que diga el perfil. Quita esa línea;"
        " solo un servo puede mantenerse.",
    },
    # pins and timers
    "no_such_pin": {
        "en": "{path} is {found}, and the board {chip} has no such pin. Look at its pin map.",
        "es": "{path} es {found}, y la placa {chip} no tiene ese pin. Mira su mapa de pines.",
    },
    "pin_of_link": {
        "en": "{path} is pin {pin}, which carries the link to the computer. Choose another pin.",
        "es": "{path} es el pin {pin}, que usa la conexión con la computadora. Elige otro pin.",
    },
    "pin_twice": {
        "en": "{path} is pin {pin}, which {first} uses already. Choose another pin.",
        "es": "{path} es el pin {pin}, que {first} ya usa. Elige otro pin.",
    },
    "pin_cannot": {
        "en": "{path} is pin {pin}, which cannot be {need} on the board {chip}."
        " These can: {choices}.",
        "es": "{path} es el pin {pin}, que en la placa {chip} no sirve de {need}."
        " Sirven: {choices}.",
    },
    "pin_at_boot": {
        "en": "{path} is pin {pin}, which could start a motor of an {chip} when it is switched on,"
        " or keep it from starting. Choose one of these: {choices}.",
        "es": "{path} es el pin {pin}, que podría arrancar un motor de un {chip} al encenderlo,"
        " o no dejar que arranque. Elige uno de estos: {choices}.",
    },
    "pin_of_reset": {
        "en": "{path} is pin {pin}, which has the BOOT button of an {chip}. A computer that opens"
        " the port may pull it low, and the robot would drive off as if somebody had pressed it."
        " Connect a button of its own to one of these: {choices}.",
        "es": "{path} es el pin {pin}, el del botón BOOT de un {chip}. Una computadora que abre el"
        " puerto puede ponerlo a GND, y el robot arrancaría como si alguien lo pulsara."
        " Conecta otro botón a uno de estos: {choices}.",
    },
    "timer_twice": {
        "en": "{path} is pin {pin}: its PWM needs timer {timer}, which {first} uses."
        " Choose one of these: {choices}.",
        "es": "{path} es el pin {pin}: su PWM necesita el temporizador {timer}, que {first} usa."
        " Elige uno de estos: {choices}.",
    },
    "timers_used_up": {
        "en": "{path} is pin {pin}: its PWM needs one more timer, and {chip} has {timers}, each for"
        " two pins of one kind (motors, servos, buzzer). Leave one PWM pin out.",
        "es": "{path} es el pin {pin}: su PWM necesita un temporizador más, y {chip} tiene"
        " {timers}, cada uno para dos pines de un tipo (motores, servos, zumbador). Quita un pin"
        " PWM.",
    },
}

# The texts for the values of `wanted`, `found` and `need`.
WORDS_FOR: dict[str, dict[str, dict[str, str]]] = {
    "type": {
        "text": {"en": "a text in quotes", "es": "un texto entre comillas"},
        "number": {"en": "a number", "es": "un número"},
        "decimal": {"en": "a number with decimals", "es": "un número con decimales"},
        "whole": {"en": "a number without decimals", "es": "un número sin decimales"},
        "yes_no": {"en": "true or false", "es": "true o false"},
        "list": {"en": "a list", "es": "una lista"},
        "pair": {"en": "two numbers, [low, high]", "es": "dos números, [menor, mayor]"},
        "pairs": {
            "en": "a list of points, [[20, 50], [80, 50]]",
            "es": "una lista de puntos, [[20, 50], [80, 50]]",
        },
        "table": {"en": "a table, [name]", "es": "una tabla, [nombre]"},
        "tables": {"en": "a list of tables, [[name]]", "es": "una lista de tablas, [[nombre]]"},
        "date": {"en": "a date or a time", "es": "una fecha o una hora"},
        "pin": {"en": 'a pin, such as 5 or "A0"', "es": 'un pin, como 5 o "A0"'},
    },
    "need": {
        "input": {"en": "an input", "es": "entrada"},
        "output": {"en": "an output", "es": "salida"},
        "pull_up": {"en": "an input with pull-up", "es": "entrada con pull-up"},
        "analog": {"en": "an analog input", "es": "entrada analógica"},
        "pwm": {"en": "a PWM output", "es": "salida PWM"},
        "echo": {"en": "an echo input", "es": "entrada de eco"},
        "servo": {"en": "a servo output", "es": "salida de servo"},
        "tone": {"en": "a buzzer output", "es": "salida de zumbador"},
    },
}


def describe(
    refused: ProfileRefused, lang: str, own: Mapping[str, Mapping[str, str]] | None = None
) -> list[str]:
    """Return a sentence for each reason, in `lang` of LANGUAGES (English for any other).

    `own` are sentences that take precedence: files other than profiles have some of their own.
    """
    known_sentences = {**SENTENCES, **(own or {})}
    lang = lang if lang in LANGUAGES else LANGUAGES[0]
    sentences = []
    for code, values in _causes(refused.reasons):
        words = {key: printable(value) for key, value in values.items()}
        group = {"wrong_type": "type", "pin_cannot": "need"}.get(code)
        if group:
            known = WORDS_FOR[group]
            words = {
                key: known[word][lang] if word in known else word for key, word in words.items()
            }
        key = f"{code}/near" if words.get("near") else code
        sentences.append(known_sentences[key][lang].format_map(words))
    return sentences


def _causes(reasons: Sequence[Reason]) -> list[Reason]:
    """Return the reasons without those that go when another one is mended.

    Beside a misspelt key nothing is said of the key that it should be, nor, beside the refused
    name of a device, of the tables that have this name.
    """
    meant, is_name_refused = set(), False
    for code, values in reasons:
        parent, _, _ = values.get("path", "").rpartition(".")
        is_name_refused |= code.startswith("name_") and parent.startswith("kit.")
        if code in ("unknown_key", "not_in_kit") and values.get("near"):
            meant.add(f"{parent}.{values['near']}".lstrip("."))
    found = []
    for code, values in reasons:
        path = values.get("path", "")
        is_meant = any(path == each or path.startswith(f"{each}.") for each in meant)
        is_device = code == "missing" and DEVICE.fullmatch(path) is not None
        if code == "missing" and is_meant:
            continue
        if is_name_refused and (is_device or code == "not_in_kit"):
            continue
        found.append((code, values))
    return found


def shown(value: object) -> str:
    """Return a value from a file or a person in a form for a sentence: short and printable."""
    if isinstance(value, int) and value.bit_length() > 100:
        return "…"  # Python refuses to print very long integers
    return printable(str(value), SHOWN_CHARACTERS)
