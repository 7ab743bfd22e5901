"""The sentences about a refused lesson: a cause and a remedy, in English and Spanish.

`robots.refusals` has the sentences shared with profiles, `virtual.world` those of the
world of a lesson. Does not know when a code applies.
"""

from __future__ import annotations

from tiniscript.lessons.lesson import LessonRefused
from tiniscript.robots import refusals
from tiniscript.virtual import world

SENTENCES: dict[str, dict[str, str]] = {
    "no_such_lesson": {
        "en": "There is no lesson {name}. Give a number from 1 to {most}, or a lesson's folder.",
        "es": "No hay una lección {name}. Indica un número de 1 a {most}, o la carpeta de una.",
    },
    "no_page": {
        "en": "{file} is missing. Write it, or choose another language with --lang.",
        "es": "Falta {file}. Escríbelo, o elige otro idioma con --lang.",
    },
    "no_such_number": {
        "en": "{file} has {found}, which is no number of this lesson. There are: {known}.",
        "es": "{file} tiene {found}, que no es un número de esta lección. Hay: {known}.",
    },
    "file_too_large": {
        "en": "{file} has more than {limit}. Check that it belongs to a lesson.",
        "es": "{file} pesa más de {limit}. Comprueba que sea de una lección.",
    },
    "unknown_key": {
        "en": "{path} means nothing in a lesson. The keys there are: {known}.",
        "es": "{path} no significa nada en una lección. Las claves ahí son: {known}.",
    },
    "unknown_key/near": {
        "en": "{path} means nothing in a lesson. Did you mean {near}?",
        "es": "{path} no significa nada en una lección. ¿Quisiste decir {near}?",
    },
    "no_criteria": {
        "en": 'The lesson has no criteria. Add one: [[criteria]] with kind = "never_touches".',
        "es": 'La lección no tiene criterios. Agrega uno: [[criteria]] con kind = "never_touches".',
    },
    "unknown_criterion": {
        "en": "{path} is {found}, which is no criterion. Write one of these: {known}.",
        "es": "{path} es {found}, que no es un criterio. Escribe uno de estos: {known}.",
    },
    "unknown_criterion/near": {
        "en": "{path} is {found}, which is no criterion. Did you mean {near}?",
        "es": "{path} es {found}, que no es un criterio. ¿Quisiste decir {near}?",
    },
    "low_above_high": {
        "en": "{path} is larger than {other}. Exchange the two numbers.",
        "es": "{path} es mayor que {other}. Intercambia los dos números.",
    },
    "words_form": {
        "en": "{path} is no list of words. Write it like this: {example}",
        "es": "{path} no es una lista de palabras. Escríbela así: {example}",
    },
    "unknown_word": {
        "en": "{path} has {found}, which is not a known word. Check how it is written.",
        "es": "{path} tiene {found}, que no es una palabra conocida. Revisa cómo se escribe.",
    },
    "unknown_word/near": {
        "en": "{path} has {found}, which is not a known word. Did you mean {near}?",
        "es": "{path} tiene {found}, que no es una palabra conocida. ¿Quisiste decir {near}?",
    },
    "place_form": {
        "en": '{path} is no place. Write a point such as [50, 80], or a part such as "boxes[1]".',
        "es": '{path} no es un lugar. Escribe un punto como [50, 80] o una parte como "boxes[1]".',
    },
    "unknown_part": {
        "en": "{path} is {found}. Write start, or one of {parts} with its number: boxes[1].",
        "es": "{path} es {found}. Escribe start, o una de {parts} con su número: boxes[1].",
    },
    "no_such_part": {
        "en": "{path} is {found}, but world.toml has {there} of them. Count from 1.",
        "es": "{path} es {found}, pero en world.toml hay {there}. Cuenta desde 1.",
    },
    "lamp_has_no_heading": {
        "en": "{path}: a lamp shines to all sides. Take the line out.",
        "es": "{path}: una lámpara alumbra hacia todos lados. Quita esa línea.",
    },
}


def describe(refused: LessonRefused, language: str) -> list[str]:
    """Return a sentence for each reason."""
    return refusals.describe(refused, language, {**world.SENTENCES, **SENTENCES})
