"""The sentences about a refused world: a cause and a remedy, in English and Spanish.

`robots.refusals` has the sentences shared with profiles. Does not know when a code applies.
"""

from __future__ import annotations

from tiniscript.robots import refusals
from tiniscript.virtual.world import WorldRefused

SENTENCES: dict[str, dict[str, str]] = {
    "no_such_world": {
        "en": "There is no world {name}. Take one of these: {known}; or give a .toml file.",
        "es": "No hay un mundo {name}. Elige uno de estos: {known}; o indica un archivo .toml.",
    },
    "no_such_world/near": {
        "en": "There is no world {name}. Did you mean {near}? The worlds are: {known}.",
        "es": "No hay un mundo {name}. ¿Quisiste decir {near}? Los mundos son: {known}.",
    },
    "file_too_large": {
        "en": "{file} has more than {limit}. Check that it is a world.",
        "es": "{file} pesa más de {limit}. Comprueba que sea un mundo.",
    },
    "unknown_key": {
        "en": "{path} means nothing in a world. The keys there are: {known}.",
        "es": "{path} no significa nada en un mundo. Las claves ahí son: {known}.",
    },
    "unknown_key/near": {
        "en": "{path} means nothing in a world. Did you mean {near}?",
        "es": "{path} no significa nada en un mundo. ¿Quisiste decir {near}?",
    },
    "too_many_parts": {
        "en": "{path} has {found} parts. Leave at most {most}.",
        "es": "{path} tiene {found} partes. Deja {most} como máximo.",
    },
    "points_count": {
        "en": "Points of {path}: {found}. Write 2 to {most} of them, such as [[20, 50], [80, 50]].",
        "es": "Puntos de {path}: {found}. Escribe de 2 a {most}, como [[20, 50], [80, 50]].",
    },
    "start_outside": {
        "en": "Line {line}: the robot starts outside the floor. {path} is {found};"
        " write a number from 0 to {most}.",
        "es": "Línea {line}: el robot empieza fuera del piso. {path} es {found};"
        " escribe un número de 0 a {most}.",
    },
    "start_blocked": {
        "en": "The robot does not fit where it starts, at {place}. Move [start] off the walls.",
        "es": "El robot no cabe donde empieza, en {place}. Aleja [start] de las paredes.",
    },
}


def describe(refused: WorldRefused, language: str) -> list[str]:
    """Return a sentence for each reason."""
    return refusals.describe(refused, language, SENTENCES)
