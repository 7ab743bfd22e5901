"""The types of a lesson: its robot, its world, how that varies, and the criteria of its task.

The table of criteria lists the parameters of each kind.

Knows no TOML (`reader`), no files (`catalogue`) and no sentences (`sentences`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.lessons.forms import TEXT, sentences_in_form
from tiniscript.robots.profile import ProfileRefused
from tiniscript.virtual.world import World

WORLD_PARTS = ("start", "walls", "boxes", "lines", "lamps")  # parts of a world


class LessonRefused(ProfileRefused):
    """A lesson that cannot be used; its reasons are like those of a profile."""

    kinds = ("lesson", "world")


class Place(NamedTuple):
    """A place in a world: a part of it, counted from 1, or a point where `part` is empty."""

    part: str
    number: int
    x_cm: float = 0.0
    y_cm: float = 0.0


class Criterion(NamedTuple):
    """A requirement for a run or a program. `kind` is a row of `criteria.KINDS`.

    `number_by_key` has the numbers of that row by their keys, `words` its words, `places` its
    places. `labels[language]` is the name of a place in sentences. `area` is around a place: from
    and to, along x and y, in centimetres.
    """

    kind: str
    number_by_key: Mapping[str, float]
    words: tuple[str, ...]
    places: tuple[Place, ...]
    labels: Mapping[str, str]
    area: tuple[tuple[float, float], tuple[float, float]] | None = None


class Variation(NamedTuple):
    """The random displacement of a part of the world: ranges in cm and degrees."""

    place: Place
    x_cm: tuple[float, float]
    y_cm: tuple[float, float]
    heading: tuple[float, float]


class Press(NamedTuple):
    """A key of a remote control that is held, by its word, from so many seconds of the run on."""

    at_seconds: float
    seconds: float
    key: str

    @property
    def end_seconds(self) -> float:
        return self.at_seconds + self.seconds


class Lesson(NamedTuple):
    """A lesson. `name` is that of its folder.

    A program has `seconds` of the robot's time in each world, and passes where it meets all
    criteria in the worlds of the seeds 1 to `world_count`. Sensors and motors are off by about
    `noise`, a fraction. `is_mirrored`: in half of the worlds left and right are exchanged.
    `presses` are played in each world, one after the other.
    """

    name: str
    robot: str
    title_by_language: Mapping[str, str]
    seconds: float
    world_count: int
    noise: float
    is_mirrored: bool
    world: World
    variations: tuple[Variation, ...]
    criteria: tuple[Criterion, ...]
    presses: tuple[Press, ...] = ()

    def title(self, language: str, form: str = TEXT) -> str:
        return sentences_in_form(self.title_by_language[language], form)


class Answer(NamedTuple):
    """A program for a task, and the remarks on it in each language.

    `said[language]` is the checker's first sentence about a wrong program; a right one has none.
    """

    program: str
    label_by_language: Mapping[str, str]
    sentence_by_language: Mapping[str, str]


LARGEST_NUMBER = 10_000.0  # the largest number allowed


class Number(NamedTuple):
    """A number of a criterion, from `low` to `high`. Without a default, the key is required."""

    key: str
    low: float
    high: float
    default: float | None = None


class CriterionKind(NamedTuple):
    """The fields of a kind of criterion besides `kind`, and its meaning.

    `places` is the minimum number of places; 0: it has none. `words` is the kind of its words: ""
    for none, "word" of the language or a sensor, "event" of EVENTS, "block" of REMOVABLE_BLOCKS;
    or, as its `what`, "value" of a sensor or TIME, "sensor" with a place in the robot's body,
    "switch": an actuator that is on or off. `may_be_anywhere`: its places may be left out. `flags`
    are true or false, and false if they are left out. `has_area`: it may have AREA.
    """

    meaning: str
    numbers: tuple[Number, ...] = ()
    places: int = 0
    words: str = ""
    may_be_anywhere: bool = False
    flags: tuple[str, ...] = ()
    has_area: bool = False


# Kinds in `CriterionKind.words` that use the key `what`.
DEVICE_KINDS = ("value", "sensor", "switch")
REMOVABLE_BLOCKS = ("LOOP", "DEF", "WHEN", "TASK")  # blocks that a lesson may remove from a program
EVENTS = ("moves", "stops", "beeps", "shows")
TIMES = Number("times", 1, 100, 1)
WITHIN_CM = Number("within_cm", 1, 500, 10)
AREA_KEYS = ("x_cm", "y_cm")  # ranges around a place

# fmt: off
KINDS: dict[str, CriterionKind] = {
    "ends_in": CriterionKind("at the end the robot is within `within_cm` of a place, or completely inside an area", (WITHIN_CM,), places=1, has_area=True),
    "reaches": CriterionKind("it comes within `within_cm` of each of these places, in order (`either_way`: or from the last to the first), in at most `by_seconds` and on a path of at most `by_cm`; with `what`, the distance is measured from that sensor",
                    (WITHIN_CM, Number("by_seconds", 0.1, LARGEST_NUMBER, LARGEST_NUMBER), Number("by_cm", 1, LARGEST_NUMBER, LARGEST_NUMBER)), places=1, words="sensor", flags=("either_way",)),
    "stays_in": CriterionKind("it is never more than `within_cm` from a place, or its wheels never leave an area", (Number("within_cm", 1, 500, 500),), places=1, has_area=True),
    "stands_before": CriterionKind("at the end it stands `low_cm` to `high_cm` from whatever is ahead of it; with `at`, in front of that place", (Number("low_cm", 0, 400), Number("high_cm", 0, 400)), places=1, may_be_anywhere=True),
    "faces": CriterionKind("at the end it faces `heading`", (Number("heading", -360, 360), Number("within_degrees", 1, 180, 15))),
    "never_touches": CriterionKind("it touches nothing; with `at`, until it has been within `within_cm` of this place", (WITHIN_CM,), places=1, may_be_anywhere=True),
    "follows": CriterionKind("its line sensors stay within `within_cm` of a black line, and follow at least `at_least_cm` of it", (Number("within_cm", 1, 500, 6), Number("at_least_cm", 1, LARGEST_NUMBER))),
    "drives": CriterionKind("it drives `at_least_cm` to `at_most_cm`", (Number("at_least_cm", 0, LARGEST_NUMBER, 0), Number("at_most_cm", 1, LARGEST_NUMBER, LARGEST_NUMBER))),
    "pauses": CriterionKind("it waits at least `at_least_seconds` between two moves, at least `times` times; with `at`, within `within_cm` of each of these places", (Number("at_least_seconds", 0.1, 600), TIMES, WITHIN_CM), places=1, may_be_anywhere=True),
    "shows": CriterionKind("it shows a value at least `times` times: any value, this `value`, or that of a sensor or of TIME at that moment",
                  (TIMES, Number("value", -LARGEST_NUMBER, LARGEST_NUMBER, LARGEST_NUMBER + 1), Number("tolerance", 0, LARGEST_NUMBER, 0)), words="value"),
    "beeps": CriterionKind("its buzzer sounds at least `times` times, with at least `pitches` different pitches; with `at`, within `within_cm` of each of these places", (TIMES, Number("pitches", 1, 100, 1), WITHIN_CM), places=1, may_be_anywhere=True),
    "blinks": CriterionKind("it switches `what` on at least `times` times while it moves", (TIMES,), words="switch"),
    "order": CriterionKind("these events happen in this order; an event is `moves`, `stops`, `beeps` or `shows`", words="event"),
    "obeys": CriterionKind("it obeys the keys: it goes forward for KEY_UP and back for KEY_DOWN, turns for KEY_LEFT and KEY_RIGHT, beeps for KEY_A and KEY_B, and stands still while nothing is held"),
    "ends": CriterionKind("the program ends by itself"),
    "uses": CriterionKind("the text has each of these words at least `times` times; a DEF counts if it is called, a LOOP if it repeats more than a wait, an UNTIL if it checks something", (TIMES,), words="word"),
    "needs": CriterionKind("the program needs these words, LOOP, DEF, WHEN or TASK: the robot fails one of the criteria above if each loop runs only once, or if the words defined by DEF or the other tasks are left out", words="block"),
    "moves": CriterionKind("the text has at most `at_most` moves; with `ahead`, turns do not count", (Number("at_most", 1, 1000),), flags=("ahead",)),
}
# fmt: on

TIME = "TIME"  # a value of `shows` that no sensor reads
ANY_VALUE = LARGEST_NUMBER + 1  # value of `shows` that accepts any value
