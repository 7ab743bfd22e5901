"""The kinds of blocks: the page shows them and Python reads and writes them by this one table.

Knows what goes into each kind; no page and no program. Its text is in the page's catalogue, as
`block/if` and `tip/if`: `%1` and so on are where values go. A word of the text stands in braces: on
a block it is seen if somebody wants it, of `{IF} if %1` as `IF %1`.
`python -m tools.builds.studio` gives the page the table.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from tiniscript.base.kit import REMOTE
from tiniscript.base.words import MOVES, UNIT_OF, WORDS, Word


class Kind(NamedTuple):
    """`colour` is a style of the page. A value is `number`, `truth` or `any`.

    `field` is what is written in it: `name`, `line`, `sensor` or `actuator`; `words` are the words
    to choose from instead, and `units` of those the units after the first value, instead of
    seconds. `is_hat`: it begins a stack, which is its body. `gives` is what a block gives that is a
    value, and `part` which part of an expression it is, where its words are none. `is_each_word`:
    whoever builds finds one for each word. `says` is what it says in all languages.
    """

    name: str
    colour: str
    values: tuple[str, ...] = ()
    bodies: int = 0
    is_hat: bool = False
    gives: str = ""
    part: str = ""
    is_each_word: bool = False
    field: str = ""
    words: tuple[str, ...] = ()
    units: Mapping[str, str] = {}
    says: str = ""


def plain_kind(count: int) -> str:
    """Return the kind of the instructions that have none of their own and take so many values."""
    return f"plain_{count}" if count else "plain"


def is_plain(word: Word) -> bool:
    """Return whether it is an instruction without a kind of its own."""
    return word.role.is_instruction and word.role.name not in KINDS


def kind_of(word: Word) -> str:
    """Return the kind of a word's block."""
    return plain_kind(len(word.arguments)) if is_plain(word) else word.role.name


# fmt: off
ARITHMETIC_SIGNS = {"ADD": "+", "SUB": "−", "MUL": "×", "DIV": "÷", "MOD": "%"}
COMPARISONS = {"EQ": "=", "NE": "≠", "LT": "<", "LE": "≤", "GT": ">", "GE": "≥"}
KINDS = {kind.name: kind for kind in (
    Kind("move", "move", ("number", "number"), words=MOVES, units=UNIT_OF, is_each_word=True),
    Kind("move_until", "move", ("number", "number", "truth"), words=MOVES, units=UNIT_OF),
    Kind("wait", "time", ("number",)),
    Kind("wait_until", "time", ("number", "truth")),
    Kind("motors", "move", ("number", "number")),
    Kind("stop", "stop"),
    Kind("start", "others"),
    Kind("beep", "time", ("number", "number")),
    Kind("show", "time", ("any",)),
    Kind("read", "sensors", field="sensor"),
    Kind("set", "sensors", ("any",), field="actuator", is_each_word=True),
    Kind("call", "words", field="name"),
    Kind("assign", "names", ("any",), field="name", says="%1 = %2"),
    Kind("if", "control"),
    Kind("loop", "control", ("number",), bodies=1),
    Kind("forever", "control", bodies=1),
    Kind("while", "control", ("truth",), bodies=1),
    Kind("break", "control"),
    Kind("def", "words", bodies=1, is_hat=True, field="name"),
    Kind("task", "tasks", bodies=1, is_hat=True),
    Kind("when", "events", ("truth",), bodies=1, is_hat=True),
    Kind("comment", "others", field="line"),
    Kind("grey", "grey", field="line", says="%1"),
    Kind("number", "numbers", gives="number", part="NUMBER", says="%1"),
    Kind("name", "names", gives="any", part="NAME", field="name", says="%1"),
    Kind("sensor", "sensors", gives="any", part="SENSOR", field="sensor", is_each_word=True, says="%1"),
    Kind("truth", "decide", gives="truth", words=("TRUE", "FALSE"), says="%1"),
    Kind("time", "time", gives="number", part="TIME"),
    Kind("endless", "time", gives="number", part="FOREVER"),
    Kind("math", "numbers", ("number", "number"), gives="number", words=tuple(ARITHMETIC_SIGNS), says="%2 %1 %3"),
    Kind("compare", "decide", ("any", "any"), gives="truth", words=tuple(COMPARISONS), says="%2 %1 %3"),
    Kind("logic", "decide", ("truth", "truth"), gives="truth", words=("AND", "OR"), says="%2 %1 %3"),
    Kind("not", "decide", ("truth",), gives="truth", part="NOT"),
    Kind("negative", "numbers", ("number",), gives="number", part="NEG", says="− %1"),
    Kind("brackets", "numbers", ("any",), gives="any", part="BRACKETS", says="( %1 )"),
    Kind("round", "numbers", ("number", "number"), gives="number", part="ROUND"),
    Kind("abs", "numbers", ("number",), gives="number", part="ABS"),
    Kind("extreme", "numbers", ("number", "number"), gives="number", words=("MIN", "MAX")),
    Kind("random", "numbers", ("number", "number"), gives="number", part="RANDOM"),
)}
# All other instructions: those with the same number of values are of one kind. Their text without a
# `block/HORN` in the catalogue: `HORN = BEEP(0.5, 440)`, or the name.
_PLAIN_WORDS = [word for word in WORDS.values() if is_plain(word)]
PLAIN_TEXTS = {
    word.text: f"{{{word.text}}} {word.usage.upper()} = {word.expansion}"
    if word.expansion else f"{{{word.text}}} {word.text}"
    for word in _PLAIN_WORDS
}
KINDS |= {kind.name: kind for kind in (
    Kind(
        plain_kind(count), "time", ("number",) * count, is_each_word=True,
        words=tuple(word.text for word in _PLAIN_WORDS if len(word.arguments) == count),
        says=" ".join(f"%{k + 1}" for k in range(count + 1)),
    )
    for count in sorted({0, *(len(word.arguments) for word in _PLAIN_WORDS)})
)}
# fmt: on

# The kind of each part of an expression, and of words: of F the first one, a move without UNTIL.
KIND_OF = {name.upper(): name for name in KINDS}
for _kind in reversed(KINDS.values()):
    KIND_OF.update((word, _kind.name) for word in (_kind.part, *_kind.words) if word)
_KEY_SETS = {device.name: device.name.partition("_")[0] for device in REMOTE}  # KEY, PAD


def piece_of(kind: str, word: str) -> str:
    """Return the searchable piece of a block: its kind, and its word if each has its own.

    A set of keys is one. `page/words.js` says the same.
    """
    if kind not in KINDS or not KINDS[kind].is_each_word:
        return kind
    name = word.partition(" ")[0]
    return f"{kind} {_KEY_SETS.get(name, name)}"


BLOCK_TEXTS = {
    **{kind.name: kind.says for kind in KINDS.values()},
    **ARITHMETIC_SIGNS,
    **COMPARISONS,
    **PLAIN_TEXTS,
}


def table_data() -> dict[str, Any]:
    """Return the table as data for JSON: the kinds, and their texts in all languages."""
    kinds = {name: kind._asdict() for name, kind in KINDS.items()}
    for kind in kinds.values():
        del kind["name"], kind["says"]
    return {"kinds": kinds, "says": {name: says for name, says in BLOCK_TEXTS.items() if says}}
