"""The lessons in the page: their steps, their worlds, and what comes of a program.

Pupils hear there what `tsc lesson check` says, and see the run that it is said of. The page fetches
this when lessons are first looked at.
"""

from __future__ import annotations

from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

from tiniscript.base.words import WORDS
from tiniscript.bytecode.image import unpack
from tiniscript.lessons import catalogue
from tiniscript.lessons.forms import BLOCKS, TEXT
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.map import GOALS
from tiniscript.lessons.markdown import HINT, Block, blocks, studio_part
from tiniscript.lessons.marking import Marking, Outcome
from tiniscript.lessons.running import ASKS, STEP_MS, Trial
from tiniscript.lessons.sentences import sentence
from tiniscript.lessons.variation import is_mirrored, point_of, vary
from tiniscript.library.compiling import compile_source, fit_to_robot, image_maker
from tiniscript.library.named_robot import shipped_name_in
from tiniscript.link.session import Session
from tiniscript.studio.block_form import Form as BlockForm
from tiniscript.studio.block_form import kinds_in, pieces_in
from tiniscript.studio.block_kinds import KIND_OF, piece_of
from tiniscript.studio.block_reading import read_blocks
from tiniscript.studio.block_speech import WORD_PATTERN, blocks_of, codes_in
from tiniscript.studio.checking import profile_of
from tiniscript.studio.simulation import NONCE, Marks, Simulation
from tiniscript.studio.world_form import Form, form_of
from tiniscript.virtual.score import Score
from tiniscript.virtual.world import World

MISTAKES = "mistakes"
STEPS_HEADING, TASK_HEADING = 2, 3  # indexes of headings, after the list of materials


def titles(language: str) -> list[dict[str, Any]]:
    """Return the name, robot and look of each lesson; the first one is lesson 1."""
    return [
        {"name": lesson.name, "title": lesson.title(language),
         "block_title": lesson.title(language, BLOCKS), "robot": lesson.robot,
         "worlds": lesson.world_count, "world": world_form(number, 1)}
        for number, lesson in enumerate(map(_lesson, range(1, len(catalogue.folders()) + 1)), 1)
    ]  # fmt: skip


def steps(number: int, language: str, form: str = TEXT) -> list[dict[str, Any]]:
    """Return the steps with their blocks and hints. The last step is the task; what introduces the
    lesson is of the kind `intro`, at the first step.
    """
    page = catalogue.whole_page(_folder(number), catalogue.PUPIL, language, form)
    blocks_and_hints: list[tuple[list[Block], list[str]]] = []
    intro_blocks: list[Block] = []
    section = 0
    for block in blocks(studio_part(page)):
        if block.kind == "heading":
            section += 1
            if section == TASK_HEADING:
                blocks_and_hints.append(([], []))
        elif section == 0 and block.kind == "paragraph":
            intro_blocks.append(block._replace(kind="intro"))
        elif section == STEPS_HEADING and block.kind == "steps":
            blocks_and_hints += (([Block("paragraph", (row,))], []) for row in block.rows)
        elif section in (STEPS_HEADING, TASK_HEADING) and block.kind in ("paragraph", "program"):
            text = block.rows[0][0] if block.rows else ""
            if text.startswith(HINT):
                blocks_and_hints[-1][1].append(text.removeprefix(HINT))
            else:
                blocks_and_hints[-1][0].append(block)
    blocks_and_hints[0][0][:0] = intro_blocks
    return [
        {"blocks": [_without_blanks(part) for part in parts], "hint": " ".join(hints)}
        for parts, hints in blocks_and_hints
    ]


@cache
def taught_kinds(number: int, language: str) -> list[str]:
    """Return the kinds of blocks that a lesson speaks of, and those that its task asks for."""
    return sorted({*needed_kinds(number, language), *_kinds_of(_words(number, language))})


def offered_kinds(number: int, language: str) -> list[str]:
    """Return the kinds of blocks that lessons have spoken of, this one included."""
    return sorted(
        {kind for other in range(1, number + 1) for kind in taught_kinds(other, language)}
    )


@cache
def needed_kinds(number: int, language: str) -> list[str]:
    """Return the kinds of blocks of a lesson's programs, and those that its task asks for."""
    kinds = (kinds_in(form) for form in _forms(number, language))
    return sorted(_kinds_of(_task_words(number)).union(*kinds))


def new_pieces(number: int, language: str) -> list[str]:
    """Return the blocks that a lesson speaks of and no lesson before it.

    If it has none, return those that the fewest earlier lessons mention: they are the newest.
    """
    earlier_counts = Counter(
        piece for earlier in range(1, number) for piece in _pieces_with_use(earlier, language)
    )
    own_pieces = _pieces_with_use(number, language)
    fewest_uses = min((earlier_counts[piece] for piece in own_pieces), default=0)
    return sorted({piece for piece, use in own_pieces if earlier_counts[piece, use] == fewest_uses})


@cache
def _pieces_with_use(number: int, language: str) -> frozenset[tuple[str, str]]:
    """Return the blocks that a lesson speaks of, and how each is used."""
    kit = profile_of(_lesson(number).robot).kit
    words = _task_words(number) | _words(number, language)
    pieces = {piece_of(KIND_OF[word], word) for word in words & WORDS.keys() & KIND_OF.keys()}
    pieces |= {piece_of("sensor", device.name) for device in kit.readings if device.name in words}
    pieces |= {piece_of("set", device.name) for device in kit.actuators if device.name in words}
    in_programs = set[tuple[str, str]]().union(*map(pieces_in, _forms(number, language)))
    return frozenset(in_programs.union((piece, "") for piece in pieces))


def spoken_blocks(number: int, language: str) -> dict[str, dict[str, Any]]:
    """Return the block that each code in a lesson's sentences is; of a value one without a kind."""
    return blocks_of(_codes(number, language, BLOCKS), profile_of(_lesson(number).robot).kit)


def _kinds_of(words: set[str]) -> set[str]:
    return {KIND_OF[word] for word in words & WORDS.keys() & KIND_OF.keys()}


def _task_words(number: int) -> set[str]:
    """Return the words that a lesson's task asks for."""
    return {word for criterion in _lesson(number).criteria for word in criterion.words}


def _words(number: int, language: str) -> set[str]:
    """Return the words of the code in a lesson's sentences and hints."""
    return {word for code in _codes(number, language) for word in WORD_PATTERN.findall(code)}


def _forms(number: int, language: str) -> list[BlockForm]:
    """Return the programs of a lesson's steps as blocks."""
    kit = profile_of(_lesson(number).robot).kit
    return [read_blocks(text, kit) for text in _programs(number, language)]


def _programs(number: int, language: str) -> list[str]:
    """Return the programs of a lesson's steps."""
    parts = [block for step in steps(number, language) for block in step["blocks"]]
    return [_text_of(block) for block in parts if block["kind"] == "program"]


def _codes(number: int, language: str, form: str = TEXT) -> list[str]:
    """Return the code in the sentences and the hints of a lesson's steps."""
    sentences = []
    for step in steps(number, language, form):
        parts = [block for block in step["blocks"] if block["kind"] != "program"]
        sentences += [*map(_text_of, parts), step["hint"]]
    return codes_in(sentences)


def _text_of(block: dict[str, Any]) -> str:
    return "\n".join(row[0] for row in block["rows"] if row)


def _without_blanks(block: Block) -> dict[str, Any]:
    """Return a block without the blanks that are filled in on paper."""
    rows = [[cell.removesuffix(" ____") for cell in row] for row in block.rows]
    return {"kind": block.kind, "rows": rows}


def varied_world(number: int, seed: int) -> World:
    """Return the world of a lesson where a program is tried."""
    return vary(_lesson(number), seed)._replace(flags=(), seconds=0)  # a lesson has its own task


def world_form(number: int, seed: int) -> Form:
    return form_of(varied_world(number, seed))


def goal_shapes(number: int, seed: int) -> list[dict[str, Any]]:
    """Return the goal of the task: a circle with a flag, the area around a place, or the part of
    the world before which the robot has to stand.
    """
    lesson, drawn_world = _lesson(number), varied_world(number, seed)
    shapes = []
    for criterion in lesson.criteria:
        is_before = criterion.kind == "stands_before"
        is_goal = criterion.kind in GOALS or criterion.area or is_before
        if not is_goal or criterion.words:
            continue
        for place in criterion.places:
            x_cm, y_cm = point_of(place, drawn_world, is_mirrored(lesson, seed))
            is_flag = criterion.kind in GOALS and place.part != "start"
            goal: dict[str, Any] = {"x_cm": x_cm, "y_cm": y_cm, "is_flag": is_flag}
            if criterion.area:
                (left, right), (low, high) = criterion.area
                corners = ((left, low), (right, low), (right, high), (left, high))
                goal["around"] = [[x_cm + x, y_cm + y] for x, y in corners]
            elif not is_before:
                goal["radius_cm"] = criterion.number_by_key["within_cm"]
            shapes.append(goal)
    return shapes


class LessonCheck:
    """A program's text on its way through the worlds of a lesson."""

    def __init__(self, number: int, data: bytes, language: str) -> None:
        lesson = _lesson(number)
        lesson = lesson._replace(robot=shipped_name_in(data) or lesson.robot)
        self._language = language
        self._world_count = lesson.world_count
        self._marking: Marking | None = None
        profile = profile_of(lesson.robot)
        self._kit = profile.kit
        compilation = fit_to_robot(compile_source(data, profile, "", is_strict=True), profile)
        if compilation.is_right:
            seeds = range(1, lesson.world_count + 1)
            text = compilation.source.text
            self._marking = Marking(text, image_maker(profile), profile, lesson, seeds)

    def advance(self, most_ms: int) -> dict[str, Any]:
        """Advance the robot's time by at most `most_ms`.

        `verdict` is empty until it ends. `seed` is that of the world where it is, or where the
        program failed: 0 for none. `run` is what to see of it then: in which world, and until when.
        """
        if self._marking is None:
            return self._verdict_json(MISTAKES, 0)
        outcome = self._marking.advance(most_ms)
        if outcome is None:
            return self._verdict_json("", self._marking.seed)
        return self._verdict_json(outcome.verdict, outcome.seed, outcome)

    def _verdict_json(
        self, verdict: str, seed: int, outcome: Outcome | None = None
    ) -> dict[str, Any]:
        findings = outcome.findings if outcome is not None else ()
        sentences, block_sentences = (
            [sentence(finding, self._language, form) for finding in findings]
            for form in (TEXT, BLOCKS)
        )
        code_blocks = blocks_of(codes_in(block_sentences), self._kit)
        run = None
        if outcome is not None and outcome.run.ending != ASKS:
            failure_ms = findings[0].ms if findings else None
            until_ms = outcome.run.end_ms if failure_ms is None else failure_ms
            run = {"seed": outcome.run.seed, "until_ms": until_ms}
        return {
            "verdict": verdict, "seed": seed, "worlds": self._world_count, "run": run,
            "said": sentences, "block_said": block_sentences, "spoken": code_blocks,
        }  # fmt: skip


class JudgedRun(Simulation):
    """The run that was judged, once more: the same as before, up to when it missed something."""

    def __init__(
        self, robot: str, number: int, seed: int, until_ms: int, image: bytes, marks: Marks
    ) -> None:
        lesson = _lesson(number)
        profile = profile_of(robot)
        self._trial = Trial(unpack(image), profile, lesson, seed)
        self.robot = self._trial.robot
        self.session = Session(NONCE, profile.board.baud, profile.kit.fingerprint)
        self.fault_at = None
        self._begin_rows()
        self.marks = marks._replace(breakpoints=())
        self._score = Score(varied_world(number, seed))
        self._owed_ms = 0  # time shorter than the judge's step, carried over
        assert self.robot.started_ms is not None, "the program does not begin"
        self._end_ms = self.robot.started_ms + min(until_ms, round(lesson.seconds * 1000))
        self.advance(0)

    def advance(self, duration_ms: int) -> None:
        """Advance time in the judge's steps, which check the robot's place."""
        robot = self.robot
        self._owed_ms += duration_ms
        while robot.is_running and self._owed_ms >= STEP_MS and robot.now_ms < self._end_ms:
            self._owed_ms -= STEP_MS
            self._trial.step(min(robot.now_ms + STEP_MS, self._end_ms))
            robot.driving.pose_at(robot.now_ms)
        if robot.now_ms >= self._end_ms:
            robot.rest()

    def step(self, limit_ms: int) -> None:
        self.advance(STEP_MS)

    def press(self, keys: int, x: int, y: int) -> None:
        """Ignore keys, which only the judge presses."""

    def stop(self) -> None:
        self.robot.rest()


def _folder(number: int) -> Path:
    return catalogue.folder_of(str(number))


@cache
def _lesson(number: int) -> Lesson:
    return catalogue.load(_folder(number))
