"""Reads the TOML of a lesson and of its answers, or raises all complaints about it at once.

Opens no files.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import REMOTE
from tiniscript.base.languages import SOURCE_LANGUAGE, ByLanguage, languages
from tiniscript.base.languages import find_text as text_of
from tiniscript.base.languages import text as said_in
from tiniscript.base.spelling import nearest
from tiniscript.base.words import WORDS
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.lesson import (
    AREA_KEYS,
    DEVICE_KINDS,
    EVENTS,
    KINDS,
    REMOVABLE_BLOCKS,
    TIME,
    WITHIN_CM,
    WORLD_PARTS,
    Answer,
    Criterion,
    Lesson,
    LessonRefused,
    Number,
    Place,
    Press,
    Variation,
)
from tiniscript.lessons.sentences import sentence
from tiniscript.robots.profile import Robot
from tiniscript.robots.refusals import printable_value
from tiniscript.robots.toml_table import Table, root_of
from tiniscript.virtual.world import World

LABEL_CHARACTERS = 80
PROGRAM_CHARACTERS = 20_000
MAX_SECONDS, MAX_WORLDS, MAX_NOISE = 600, 20, 20
MAX_CM = 2000
MAX_ROWS = 100  # criteria, variations, answers, presses
GAP_NAME = re.compile(r"\{(\w+)\}")
PART = re.compile(r"(start)|(walls|boxes|lines|lamps)\[([1-9][0-9]{0,2})\]")
NO_LABELS = ByLanguage(
    {language: said_in("lessons", "place", language) for language in languages()}
)
SENTENCE_VALUES = (
    "word",
    "question",
    "what",
    "times",
)  # further values of the sentence


def read(text: str, world: World, name: str) -> Lesson:
    """Return the lesson that a text describes, with its world. Raises LessonRefused."""
    with root_of(text, LessonRefused) as root:
        title = root.table("title", "[title]")
        titles = _labels(title)
        title.finish()
        robot = root.choice("robot", robots.names())
        known_words = _known_words(robots.load(robot or robots.names()[0]))
        lesson = Lesson(
            printable_value(name),
            robot,
            titles,
            root.number("seconds", ONE, MAX_SECONDS * ONE, "seconds = 20", ONE) / ONE,
            root.whole_number("worlds", 1, MAX_WORLDS, default=1),
            root.number("noise_percent", 0, MAX_NOISE * ONE) / ONE / 100,
            root.yes_no("mirror", False),
            world,
            tuple(_variation(row, world) for row in _rows(root, "varies")),
            tuple(_criterion(row, world, known_words) for row in _rows(root, "criteria")),
            _presses(_rows(root, "presses")),
        )
        if not lesson.criteria and not root.reasons:
            root.complain("no_criteria", "criteria")
        if any(criterion.kind == "obeys" for criterion in lesson.criteria) and not lesson.presses:
            root.complain("missing", "presses", example="[[presses]]")
    return lesson


def read_answers(text: str) -> tuple[list[Answer], list[Answer]]:
    """Return the right answers of a lesson and the typical wrong ones. Raises LessonRefused."""
    with root_of(text, LessonRefused) as root:
        right_answers = [_answer(row, False) for row in _rows(root, "right")]
        wrong_answers = [_answer(row, True) for row in _rows(root, "wrong")]
    return right_answers, wrong_answers


def _rows(root: Table, key: str) -> list[Table]:
    tables = root.tables(key)
    if len(tables) > MAX_ROWS:
        root.complain("too_many_parts", key, found=str(len(tables)), most=str(MAX_ROWS))
    return tables[:MAX_ROWS]


def _answer(table: Table, is_wrong: bool) -> Answer:
    program = table.text("program", "program = 'SI|F(2, 80)'") or ""
    if len(program) > PROGRAM_CHARACTERS:
        table.complain("label_bad", "program", most=str(PROGRAM_CHARACTERS))
    labels = _labels(table)
    sentences = _sentences(table.table("says", 'says = { key = "still" }')) if is_wrong else {}
    table.finish()
    return Answer(program, labels, sentences)


def _sentences(table: Table) -> dict[str, str]:
    """Return the sentences of a finding by language: its key, values and place.

    A sentence is `place`, or a text in each language.
    """
    key = table.text("key", 'key = "still"') or "still"
    texts = (
        text_of("lessons", f"said/{key_part}", SOURCE_LANGUAGE)
        for key_part in (key, key.partition("/")[0])
    )
    gaps = GAP_NAME.findall(next(filter(None, texts), ""))
    names = dict.fromkeys([*gaps, "place", *languages(), *SENTENCE_VALUES])
    values = {name: table.text(name) or "" for name in names if table.check_for(name)}
    places = {language: values[language] for language in languages() if language in values}
    finding = Finding(
        "", key, values, ByLanguage({SOURCE_LANGUAGE: values.get("place", ""), **places})
    )
    table.finish()
    try:
        return {language: sentence(finding, language) for language in languages()}
    except KeyError as error:
        name = str(error.args[0])
        if name.startswith("said/"):
            table.complain("unknown_word", "key", found=printable_value(key), near="")
        else:
            table.complain("missing", name, example=f'{name} = "…"')
        return {}


def _labels(table: Table) -> dict[str, str]:
    """Return a text in each language that it is there in; one must be."""
    labels: ByLanguage[str] = ByLanguage()
    for language in [language for language in languages() if table.check_for(language)] or [
        SOURCE_LANGUAGE
    ]:
        labels[language] = table.label(language, LABEL_CHARACTERS, f'{language} = "…"') or ""
    return labels


def _variation(table: Table, world: World) -> Variation:
    text = table.text("part", 'part = "walls[1]"')
    place = Place("start", 0) if text is None else _part(table, "part", text, world)
    spans = [
        _span(table, *key_and_limit)
        for key_and_limit in (("x_cm", MAX_CM), ("y_cm", MAX_CM), ("heading", 360))
    ]
    if place.part == "lamps" and table.check_for("heading"):
        table.complain("lamp_has_no_heading", "heading")
    table.finish()
    return Variation(place, *spans)


def _presses(tables: list[Table]) -> tuple[Press, ...]:
    """Return the key presses in sequence: each begins when the previous one has ended."""
    keys = [device.name for device in REMOTE if device.is_yes_no]
    presses: list[Press] = []
    for table in tables:
        earliest = round(presses[-1].end_seconds * ONE) if presses else 0
        example = f"at_seconds = {earliest / ONE:g}"
        start = table.number("at_seconds", earliest, MAX_SECONDS * ONE, example)
        duration = table.number("seconds", ONE // 10, MAX_SECONDS * ONE, "seconds = 1")
        presses.append(Press(start / ONE, duration / ONE, table.choice("key", keys)))
        table.finish()
    return tuple(presses)


def _span(table: Table, key: str, most: int) -> tuple[float, float]:
    """Return the start and end of a range; both are 0 if omitted."""
    low, high = table.pair(key, "") if table.check_for(key) else (0, 0)
    if low > high:
        table.complain("range_empty", key)
    if max(abs(low), abs(high)) > most * ONE:
        table.complain("out_of_range", key, found=f"[{low / ONE:g}, {high / ONE:g}]",
                       low=str(-most), high=str(most))  # fmt: skip
    return low / ONE, high / ONE


def _known_words(robot: Robot) -> dict[str, tuple[str, ...]]:
    """Return the names that a criterion may use, by `Kind.words`."""
    sensors = tuple(device.name for device in robot.kit.sensors)
    return {
        "word": (*WORDS, *(device.name for device in robot.kit.readings)),
        "event": EVENTS,
        "block": REMOVABLE_BLOCKS,
        "value": (*sensors, TIME),
        "sensor": tuple(sensor for sensor in sensors if sensor in robot.body.places),
        "switch": tuple(device.name for device in robot.kit.actuators if device.is_yes_no),
    }


def _criterion(table: Table, world: World, known_words: Mapping[str, tuple[str, ...]]) -> Criterion:
    """Return a row. `known_words` has the words that it may name, by `Kind.words`."""
    name = table.text("kind", 'kind = "never_touches"')
    kind = KINDS.get(name or "")
    if name is None or kind is None:
        if name is not None:
            suggestion = nearest(name, list(KINDS)) or ""
            table.complain(
                "unknown_criterion",
                "kind",
                found=printable_value(name),
                near=suggestion,
                known=", ".join(KINDS),
            )
        return Criterion("", {}, (), (), NO_LABELS)
    has_places = bool(kind.places) and not (kind.may_be_anywhere and not table.check_for("at"))
    number_specs = [number for number in kind.numbers if has_places or number is not WITHIN_CM]
    numbers = {number.key: _number(table, number) for number in number_specs}
    numbers |= {flag: float(table.yes_no(flag, False)) for flag in kind.flags}
    for low, high in (("low_cm", "high_cm"), ("at_least_cm", "at_most_cm")):
        if low in numbers and numbers[low] > numbers.get(high, numbers[low]):
            table.complain("low_above_high", low, other=table.path_of(high))
    places = _places(table, world, kind.places) if has_places else ()
    area = None
    if kind.has_area and any(table.check_for(key) for key in AREA_KEYS):
        x_cm, y_cm = (_span(table, key, MAX_CM) for key in AREA_KEYS)
        area = x_cm, y_cm
    labels: dict[str, str] = NO_LABELS
    if has_places and any(map(table.check_for, languages())):
        labels = _labels(table)
    words: tuple[str, ...] = ()
    if kind.words in DEVICE_KINDS:
        if kind.words == "switch" or table.check_for("what"):
            words = _named_device(table, known_words[kind.words])
    elif kind.words:
        words = _words(table, known_words[kind.words])
    table.finish()
    return Criterion(name, numbers, words, places, labels, area)


def _number(table: Table, number: Number) -> float:
    if number.default is not None and not table.check_for(number.key):
        return number.default
    low, high = round(number.low * ONE), round(number.high * ONE)
    return table.number(number.key, low, high, f"{number.key} = {number.low:g}") / ONE


def _named_device(table: Table, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the device that a criterion asks for."""
    device_name = table.text("what", 'what = "LED"')
    if device_name is None or device_name in names:
        return () if device_name is None else (device_name,)
    table.complain(
        "not_one_of", "what", found=printable_value(device_name), choices=", ".join(names) or "-"
    )
    return ()


def _words(table: Table, known_words: tuple[str, ...]) -> tuple[str, ...]:
    words = table.get("words", f'words = ["{known_words[0]}"]')
    if words is None:
        return ()
    if not isinstance(words, list) or not all(type(word) is str for word in words) or not words:
        table.complain("words_form", "words", example=f'["{known_words[0]}"]')
        return ()
    for word in words:
        if word not in known_words:
            suggestion = nearest(word, known_words) or ""
            table.complain("unknown_word", "words", found=printable_value(word), near=suggestion)
    return tuple(words)


def _places(table: Table, world: World, least_count: int) -> tuple[Place, ...]:
    """Return the places of `at`: a part of the world, a point, or a list of them."""
    value = table.get("at", 'at = "start"')
    if value is None:
        return ()
    is_point = isinstance(value, list) and len(value) == 2 and not isinstance(value[0], list | str)
    texts_or_points = value if isinstance(value, list) and not is_point else [value]
    places = []
    for item in texts_or_points:
        if isinstance(item, str):
            places.append(_part(table, "at", item, world))
        elif isinstance(item, list) and len(item) == 2:
            pairs = Table({"at": [item]}, table.path, table.reasons)
            points = pairs.pairs("at", -MAX_CM * ONE, MAX_CM * ONE, "")
            for x_cm, y_cm in points or ():
                places.append(Place("", 0, x_cm / ONE, y_cm / ONE))
        else:
            table.complain("place_form", "at")
    if len(places) < least_count and not table.reasons:
        table.complain("place_form", "at")
    return tuple(places)


def _part(table: Table, key: str, text: str, world: World) -> Place:
    """Return the part of a world that a text names, such as `boxes[2]`."""
    match = PART.fullmatch(text)
    if match is None:
        table.complain(
            "unknown_part", key, found=printable_value(text), parts=", ".join(WORLD_PARTS[1:])
        )
        return Place("start", 0)
    if match[1]:
        return Place("start", 0)
    number, part_count = int(match[3]), len(getattr(world, match[2]))
    if number > part_count:
        table.complain("no_such_part", key, found=printable_value(text), there=str(part_count))
        return Place("start", 0)
    return Place(match[2], number)
