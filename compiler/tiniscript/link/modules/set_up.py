"""Sets a module's name, PIN and speed, and checks them afterwards.

The speed comes last, and is looked for at all speeds if it cannot be found at the new one: so no
user is left with a module of unknown speed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tiniscript.link.modules.dialects import RESTART_MS, Dialect, is_error, is_ok, value_of
from tiniscript.link.modules.talk import Module, ask, find_module, is_there
from tiniscript.link.wire import Wire

NAME, PIN, BAUD = "name", "pin", "baud"
# Results of a step. UNSEEN: the module confirms it, but does not report the value.
DONE, UNSEEN, REFUSED, SILENT, DIFFERS, ELSEWHERE, LOST = (
    "done", "unseen", "refused", "lost_midway", "differs", "elsewhere", "lost",
)  # fmt: skip
GOOD_OUTCOMES = (DONE, UNSEEN)
NAME_LETTERS = set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_ ")
NAME_START = "Tini-"  # start of a name made from a robot's id


class WantedSettings(NamedTuple):
    """The requested settings of a module; None leaves one unchanged."""

    name: str | None = None
    pin: str | None = None
    baud: int | None = None


class Step(NamedTuple):
    """A setting, its value, and the commands to try until one is accepted."""

    setting: str
    value: str
    commands: tuple[str, ...]


class Outcome(NamedTuple):
    """The result of a step; `answer` is the module's answer, or its speed."""

    step: Step
    status: str
    answer: str = ""


def name_for(robot_id: int) -> str:
    """Return the name of the module of a robot: `Tini-7F3A`."""
    return f"{NAME_START}{robot_id & 0xFFFF:04X}"


def unsupported_setting(settings: WantedSettings, dialect: Dialect) -> str:
    """Return the setting that this kind of module lacks: `name`, `pin`, `baud`, or ""."""
    name, pin, baud = settings
    if name is not None and (
        not name.strip() or name != name.strip() or set(name) - NAME_LETTERS
        or len(name) > dialect.name_bytes
    ):  # fmt: skip
        return NAME
    is_number = pin is not None and pin.isascii() and pin.isdigit()
    if pin is not None and not (is_number and len(pin) == dialect.pin_digits):
        return PIN
    return BAUD if baud is not None and baud not in dialect.baud_codes else ""


def plan_steps(settings: WantedSettings, dialect: Dialect) -> list[Step]:
    """Return the steps in the order in which to send them. It sends nothing."""
    name, pin, baud = settings
    plan = (
        (NAME, name, dialect.name_commands, name),
        (PIN, pin, dialect.pin_commands, pin),
        (BAUD, baud, dialect.baud_commands, None if baud is None else dialect.baud_codes[baud]),
    )
    return [Step(setting, str(value), tuple(form.format(code) for form in forms))
            for setting, value, forms, code in plan if value is not None]  # fmt: skip


def apply_steps(
    wire: Wire, module: Module, plan: list[Step], on_outcome: Callable[[Outcome], None]
) -> list[Outcome]:
    """Do the steps, and stop at the first that goes wrong. `on_outcome` gets each at once."""
    outcomes: list[Outcome] = []
    for step in plan:
        outcome = _apply_step(wire, module.dialect, step)
        if step.setting == BAUD and outcome.status != REFUSED:
            outcome = _check_speed(wire, module, outcome)
        outcomes.append(outcome)
        on_outcome(outcome)
        if outcome.status not in GOOD_OUTCOMES:
            return outcomes
    return outcomes


def _apply_step(wire: Wire, dialect: Dialect, step: Step) -> Outcome:
    """Send the forms of a command until the module accepts one and reports the value."""
    question = {
        NAME: dialect.name_question,
        PIN: dialect.pin_question,
        BAUD: dialect.baud_question,
    }[step.setting]
    outcome = Outcome(step, SILENT)
    for command in step.commands:
        answer = ask(wire, command, dialect.line_end, dialect.wait_ms)
        if is_ok(answer):
            if not question:
                return Outcome(step, UNSEEN, answer)
            value_answer = ask(wire, question, dialect.line_end, dialect.wait_ms)
            value = value_of(value_answer)
            if not value_answer and not is_there(wire, dialect):
                return Outcome(step, SILENT, answer)
            if not value:
                return Outcome(step, UNSEEN, answer)
            if _is_same(step, dialect, value_answer):
                return Outcome(step, DONE, value)
            outcome = Outcome(step, DIFFERS, value)
        elif answer and outcome.status != DIFFERS:
            outcome = Outcome(step, REFUSED, answer if is_error(answer) else "")
    return outcome


def _is_same(step: Step, dialect: Dialect, answer: str) -> bool:
    """Return whether an answer contains the value.

    Firmware that wants a PIN in quotes reports `+PIN:"1234"`. If an older one reports
    `+PSWD:"1234"`, it has stored the quotes.
    """
    value = value_of(answer)
    if step.setting == BAUD:
        return value.split(",")[0] in (step.value, dialect.baud_codes[int(step.value)])
    if answer.startswith("+PIN:"):
        value = value.strip('"')
    return value == step.value


def _check_speed(wire: Wire, module: Module, outcome: Outcome) -> Outcome:
    """Return whether the module is at its new speed, otherwise which speed it has."""
    dialect, step = module.dialect, outcome.step
    baud = int(step.value)
    if dialect.keeps_baud:
        return outcome._replace(status=LOST) if outcome.status == SILENT else outcome
    if dialect.restart_command:
        ask(wire, dialect.restart_command, dialect.line_end, dialect.wait_ms)
        wire.receive(RESTART_MS, RESTART_MS)
    wire.set_baud(baud)
    if is_there(wire, dialect):
        return Outcome(step, DONE, step.value)
    module_there = find_module(wire, wakes_module=False)
    if module_there is None:
        return Outcome(step, LOST, step.value)
    status = DONE if module_there.baud == baud else ELSEWHERE
    return Outcome(step, status, str(module_there.baud))
