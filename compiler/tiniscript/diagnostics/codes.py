"""The codes of diagnostics: everything we can tell a person about a program, as data.

Knows which diagnostics there are. Their words are in the catalogue `messages`, which `rendering`
reads when there is something to say.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.source import Edit, Span

# Diagnostics after which a text is read no further, because more would not help.
MAX_DIAGNOSTICS = 100


class Code(NamedTuple):
    number: str
    is_mistake: bool


class Repair(NamedTuple):
    """The changes that a thing to try asks for; `is_sure`: they may be made without asking."""

    edits: tuple[Edit, ...]
    is_sure: bool


class Diagnostic(NamedTuple):
    """A diagnostic with its place. `values` fill the gaps in its message.

    `place` is the text that the thing to try replaces, if that is not `span`. `repair` is the
    finder's description of the change, None if `fixing` looks for it in the values.
    """

    code: Code
    span: Span
    values: Mapping[str, str] = {}
    place: Span | None = None
    repair: Repair | None = None

    @property
    def is_mistake(self) -> bool:
        return self.code.is_mistake


CODES: dict[str, Code] = {}


def _mistake(number: str) -> Code:
    return CODES.setdefault(number, Code(number, True))


def _warning(number: str) -> Code:
    return CODES.setdefault(number, Code(number, False))


# the text as a whole
TOO_LARGE = _mistake("TS001")
BINARY = _mistake("TS002")
NOT_UTF8 = _mistake("TS003")
# characters, numbers and names
ODD_CHARACTER = _mistake("TS005")
QUOTE = _mistake("TS006")
OTHER_NOTE = _mistake("TS007")
BAD_NUMBER = _mistake("TS008")
BAD_NAME = _mistake("TS009")
OTHER_SIGN = _mistake("TS010")
NUMBER_TOO_BIG = _mistake("TS011")
# the shape of instructions
DECIMAL_COMMA = _mistake("TS012")
MISSING_SEPARATOR = _mistake("TS013")
HEADER_SEPARATOR = _mistake("TS014")
MISSING_OPEN = _mistake("TS015")
MISSING_CLOSE = _mistake("TS016")
MISSING_COMMA = _mistake("TS017")
MISSING_VALUE = _mistake("TS018")
SEMICOLON_INSIDE = _mistake("TS019")
ARGUMENT_COUNT = _mistake("TS020")
END_SPLIT = _mistake("TS022")
END_ALONE = _mistake("TS023")
NEVER_ENDS = _mistake("TS024")
NOT_OPEN = _mistake("TS025")
WRONG_END = _mistake("TS026")
AFTER_ELSE = _mistake("TS027")
EMPTY_BRACKETS = _mistake("TS028")
UNTIL_ALONE = _mistake("TS029")
UNTIL_NOT_HERE = _mistake("TS030")
FOREVER_NEEDS_UNTIL = _mistake("TS031")
FOREVER_NOT_HERE = _mistake("TS032")
SETUP_TWICE = _mistake("TS033")
SETUP_UNKNOWN = _mistake("TS034")
PING_ALONE = _mistake("TS035")
SETUP_NEEDS_BAR = _mistake("TS036")
CHAINED = _mistake("TS037")
NOT_NEEDS_BRACKETS = _mistake("TS038")
NO_BRACKETS_HERE = _mistake("TS039")
DEF_NEEDS_NAME = _mistake("TS040")
EXTRA_CLOSE = _mistake("TS041")
NOT_AN_INSTRUCTION = _mistake("TS042")
LATER_WORD = _mistake("TS043")
EXTRA_WORD = _mistake("TS044")
SPANISH_IF = _mistake("TS045")
NO_FUNCTION = _mistake("TS046")
BRACES = _mistake("TS047")
MISSING_SIGN = _mistake("TS048")
UNIT = _mistake("TS049")
OTHER_ASSIGNMENT = _mistake("TS050")
NO_VALUE = _mistake("TS051")
NAMED_ARGUMENT = _mistake("TS052")
OTHER_UNIT = _mistake("TS053")
LINE_NUMBER = _mistake("TS054")
NAME_WITH_SPACE = _mistake("TS056")
PLACEHOLDER = _mistake("TS060")
SIGN_BETWEEN = _mistake("TS061")
REPEATED = _mistake("TS062")
LOOP_COUNTS = _mistake("TS063")
ASKED_AFTER = _mistake("TS064")
NEEDLESS_FRAME = _mistake("TS065")
CASES = _mistake("TS066")
LISTS = _mistake("TS067")
NO_INPUT = _mistake("TS068")
CHOICE_IN_VALUE = _mistake("TS069")
WORDS_SHOWN = _mistake("TS070")
QUESTION_AFTER = _mistake("TS071")
PASTED = _mistake("TS072")
PROSE = _mistake("TS073")
SEVERAL_INSTRUCTIONS = _mistake("TS074")
OTHER_CALL = _mistake("TS076")
GROUPED = _mistake("TS080")
DOTS = _mistake("TS082")
WORDS_AFTER = _mistake("TS085")
TASK_NOT_TOP = _mistake("TS086")
TASK_HAS_NAME = _mistake("TS087")
UNIT_PLACE = _mistake("TS088")
UNIT_PAIR = _mistake("TS089")
UNIT_IN_CALL = _mistake("TS090")
PARAMETER_NEEDS_NAME = _mistake("TS091")
# the checksum of a line
CHECKSUM_WRONG = _mistake("TS058")
CHECKSUM_FORM = _mistake("TS059")
# names
UNKNOWN_WORD = _mistake("TS101")
OTHER_LANGUAGE = _mistake("TS102")
UNKNOWN_NAME = _mistake("TS103")
USED_BEFORE_SET = _mistake("TS104")
RESERVED = _mistake("TS105")
SENSOR_SET = _mistake("TS106")
ACTUATOR_SET = _mistake("TS107")
NAME_TAKEN = _mistake("TS110")
DEF_TWICE = _mistake("TS111")
CALL_BEFORE_DEF = _mistake("TS112")
CALLS_ITSELF = _mistake("TS113")
DEF_NOT_TOP = _mistake("TS114")
BREAK_OUTSIDE = _mistake("TS115")
VARIABLE_ALONE = _mistake("TS116")
NOT_CALLABLE = _mistake("TS118")
OTHER_ROBOT = _mistake("TS119")
NO_BUTTON = _mistake("TS120")
TURN_WITHOUT_DIRECTION = _mistake("TS121")
SWITCH_WHAT = _mistake("TS122")
UNTAUGHT = _mistake("TS129")
SAME_AGAIN = _mistake("TS130")
AND_SO_ON = _mistake("TS131")
IN_WORDS = _mistake("TS135")
BY_CHANCE = _mistake("TS136")
SET_TOGETHER = _mistake("TS137")
NO_SUCH_ROBOT = _mistake("TS138")
PARAMETER_TAKEN = _mistake("TS139")
PARAMETER_TWICE = _mistake("TS140")
CALL_VALUES = _mistake("TS141")
# values
WANTS_NUMBER = _mistake("TS201")
WANTS_CONDITION = _mistake("TS202")
MIXED_COMPARE = _mistake("TS203")
YES_NO_ORDER = _mistake("TS204")
TYPE_CHANGES = _mistake("TS205")
OUT_OF_RANGE = _mistake("TS206")
CALL_KIND = _mistake("TS207")
# limits
TOO_MANY_VARIABLES = _mistake("TS301")
BLOCKS_TOO_DEEP = _mistake("TS302")
VALUES_TOO_DEEP = _mistake("TS303")
TOO_MANY_DEFS = _mistake("TS304")
CALLS_TOO_DEEP = _mistake("TS305")
CODE_TOO_LONG = _mistake("TS306")
BOARD_TOO_SMALL = _mistake("TS307")
LEVEL_WORD = _mistake("TS308")
LEVEL_CODE = _mistake("TS309")
LEVEL_ROOM = _mistake("TS310")
LEVEL_BRACKETS = _mistake("TS311")
TOO_MANY_TASKS = _mistake("TS312")
NO_TASKS = _mistake("TS313")
NO_SPEED = _mistake("TS314")
NO_WAYS = _mistake("TS315")
TOO_MANY_PARAMETERS = _mistake("TS316")
TOO_MANY_COPIES = _mistake("TS317")
LEVEL_VALUES = _mistake("TS318")
NO_REMOTE = _mistake("TS319")
# Warnings that a teacher would give.
ROUNDED = _warning("TS801")
NEVER_REACHED = _warning("TS802")
ZERO_TIME_MOVE = _warning("TS803")
BUSY_LOOP = _warning("TS804")
LATE_CHECK = _warning("TS805")
UNUSED_VARIABLE = _warning("TS806")
UNUSED_DEF = _warning("TS807")
WILL_FAULT = _warning("TS808")
BOARD_MAY_BE_TOO_SMALL = _warning("TS809")
SWAPPED = _warning("TS810")
LONG_TIME = _warning("TS811")
NEVER_REPEATS = _warning("TS812")
IN_A_NOTE = _warning("TS816")
LITTLE_POWER = _warning("TS820")
IDLE_STOP = _warning("TS821")
FROZEN_UNTIL = _warning("TS822")
FROZEN_WHILE = _warning("TS823")
TURNED_ROUND = _warning("TS824")
EXACT = _warning("TS825")
UNSEEN_MOTORS = _warning("TS826")
KNOWN_ANSWER = _warning("TS827")
EMPTY_BLOCK = _warning("TS828")
ROUNDED_TIMES = _warning("TS829")
LATE_ARM = _warning("TS830")
ZERO_BEFORE = _warning("TS831")
NO_MOTORS = _warning("TS832")
TASK_DONE_ONCE = _warning("TS833")
WHEN_GOES_ON = _warning("TS834")
LONE_TASK = _warning("TS835")
ASKED_ONCE = _warning("TS836")
UNUSED_READING = _warning("TS840")
CUT_VALUE = _warning("TS841")
GIVES_WAY = _warning("TS842")
NEW_THROW = _warning("TS843")


def in_order(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """Return diagnostics by place, and of several mistakes in one place the first that was found.

    A mistake that begins where another one begins is usually its consequence.
    """
    kept_diagnostics = []
    mistake_starts = set()
    seen_keys = set()
    named_starts = {
        diagnostic.span.start for diagnostic in diagnostics if diagnostic.code is UNKNOWN_WORD or (
        diagnostic.code is UNKNOWN_NAME and diagnostic.values.get("near")
    )}  # fmt: skip
    for diagnostic in diagnostics:
        key = (diagnostic.code, diagnostic.span)
        start = diagnostic.span.start
        if diagnostic.code is BAD_NAME and start in named_starts:
            continue  # `Bebé(1, 440)`: the word is replaced, with its accent
        if key in seen_keys or (diagnostic.is_mistake and start in mistake_starts):
            continue
        seen_keys.add(key)
        kept_diagnostics.append(diagnostic)
        if diagnostic.is_mistake:
            mistake_starts.add(start)
    return sorted(
        kept_diagnostics, key=lambda diagnostic: (diagnostic.span, diagnostic.code.number)
    )
