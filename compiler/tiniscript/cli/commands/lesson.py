"""`tsc lesson`: lists lessons, prints their pages, makes sheets, and checks programs."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.lesson_check import check
from tiniscript.cli.terminal import pager
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.cli.texts.options import LESSON_ACTIONS as ACTIONS
from tiniscript.cli.texts.options import options_of
from tiniscript.lessons import catalogue
from tiniscript.lessons.lesson import Lesson, LessonRefused
from tiniscript.lessons.markdown import as_text
from tiniscript.lessons.sheet import sheet

LIST = "list"


def run(options: Namespace, language: str) -> int:
    action = options.action or LIST
    if action != LIST and action not in ACTIONS:
        actions_text = f"{', '.join(list(ACTIONS)[:-1])} {text('or', language)} {list(ACTIONS)[-1]}"
        raise CommandError(
            2, "lesson_action", known=actions_text, found=inputs.printable_name(action) or "''"
        )
    _check_options(options, action)
    if action == LIST:
        return _list(language)
    if options.number is None:
        raise CommandError(2, "lesson_which", action=action)
    try:
        folder = catalogue.folder_of(options.number)
        lesson = catalogue.load(folder)
        if action == "check":
            return check(options, lesson, language)
        if action == "show":
            return _show(folder, options.teacher, language)
        return _sheet(folder, lesson, options, language)
    except LessonRefused as error:
        full_reasons, file = ("no_such_lesson", "no_page"), inputs.printable_name(options.number)
        raise inputs.refusal(error, language, "lesson_refused", full_reasons, file=file) from None


def _check_options(options: Namespace, action: str) -> None:
    """Refuse options that belong to another action."""
    for option in options_of("lesson"):
        belongs_to_action = any(option.name in names for names in ACTIONS.values())
        if belongs_to_action and option.name not in ACTIONS.get(action, ()):
            if getattr(options, option.name):
                label = option.flags if not option.is_argument else options.program
                raise CommandError(
                    2, "lesson_only", option=label, action="" if action == LIST else f" {action}"
                )


def _list(language: str) -> int:
    for number, folder in enumerate(catalogue.folders(), 1):
        lesson = catalogue.load(folder)
        title, robot = lesson.title(language), lesson.robot
        say("lesson_title", language, number=f"{number:2}", title=title, robot=robot)
    say_aside("lesson_hint", language)
    return 0


def _page(folder: Path, is_teachers: bool, language: str) -> str:
    """Return the Markdown of a page; that of a teacher has the answers after it."""
    page = catalogue.page(folder, catalogue.TEACHER if is_teachers else catalogue.PUPIL, language)
    if not is_teachers:
        return page
    right_answers, wrong_answers = catalogue.answers(folder)
    parts = [page.rstrip("\n"), f"## {text('lesson_answers', language)}"]
    for answer in right_answers:
        parts += [f"{answer.label_by_language[language]}:", _fence(answer.program)]
    parts.append(f"## {text('lesson_wrong', language)}")
    for answer in wrong_answers:
        parts += [
            f"{answer.label_by_language[language]}:",
            _fence(answer.program),
            answer.sentence_by_language[language],
        ]
    return "\n\n".join(parts) + "\n"


def _fence(program: str) -> str:
    return f"```tiniscript\n{program.strip()}\n```"


def _show(folder: Path, is_teachers: bool, language: str) -> int:
    pager.show(as_text(_page(folder, is_teachers, language)), language)
    return 0


def _sheet(folder: Path, lesson: Lesson, options: Namespace, language: str) -> int:
    if options.output is None:
        raise CommandError(2, "lesson_where", number=inputs.printable_name(options.number))
    page = sheet(_page(folder, options.teacher, language), lesson, options.teacher, language)
    if not outputs.write_output(options.output, page.encode()):
        return 0
    say(
        "lesson_sheet",
        language,
        file=inputs.printable_name(options.output),
        title=lesson.title(language),
    )
    return 0
