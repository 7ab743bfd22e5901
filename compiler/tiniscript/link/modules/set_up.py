"""Sets a module's name, PIN and speed, and asks it afterwards: what is said done was seen.

The speed comes last, and is looked for at all speeds where it cannot be found at the new one: so
nobody is left with a module whose speed they do not know.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tiniscript.link.modules.dialects import RESTART_MS, Dialect, is_error, is_ok, value_of
from tiniscript.link.modules.talk import Module, ask, find_module, is_there
from tiniscript.link.wire import Wire

NAME, PIN, BAUD = "name", "pin", "baud"
# How a step ends. UNSEEN: the module says that it is done, and does not tell the value.
DONE, UNSEEN, REFUSED, SILENT, DIFFERS, ELSEWHERE, LOST = (
    "done", "unseen", "refused", "lost_midway", "differs", "elsewhere", "lost",
)  # fmt: skip
GOOD_OUTCOMES = (DONE, UNSEEN)
NAME_LETTERS = set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_ ")
NAME_START = "Tini-"  # how a name from a robot's id begins


class WantedSettings(NamedTuple):
    """What a module is to have; None leaves it as it is."""

    name: str | None = None
    pin: str | None = None
    baud: int | None = None


class Step(NamedTuple):
    """What is set, to which value, by which commands: the first that is taken counts."""

    what: str
    value: str
    commands: tuple[str, ...]


class Outcome(NamedTuple):
    """How a step has ended; `said` is what the module answered, or the speed at which it is."""

    step: Step
    how: str
    said: str = ""


def name_for(robot_id: int) -> str:
    """Return the name of the module of a robot: `Tini-7F3A`."""
    return f"{NAME_START}{robot_id & 0xFFFF:04X}"


def misfit(wanted: WantedSettings, dialect: Dialect) -> str:
    """Return what this kind of module cannot have: `name`, `pin`, `baud`, or an empty text."""
    name, pin, baud = wanted
    if name is not None and (
        not name.strip() or name != name.strip() or set(name) - NAME_LETTERS
        or len(name) > dialect.name_bytes
    ):  # fmt: skip
        return NAME
    is_number = pin is not None and pin.isascii() and pin.isdigit()
    if pin is not None and not (is_number and len(pin) == dialect.pin_digits):
        return PIN
    return BAUD if baud is not None and baud not in dialect.bauds else ""


def steps(wanted: WantedSettings, dialect: Dialect) -> list[Step]:
    """Return what is to be sent, in this order. Nothing is sent here."""
    name, pin, baud = wanted
    plan = (
        (NAME, name, dialect.names, name),
        (PIN, pin, dialect.pins, pin),
        (BAUD, baud, dialect.speeds, None if baud is None else dialect.bauds[baud]),
    )
    return [Step(what, str(value), tuple(form.format(written) for form in forms))
            for what, value, forms, written in plan if value is not None]  # fmt: skip


def apply_steps(
    wire: Wire, module: Module, plan: list[Step], on_outcome: Callable[[Outcome], None]
) -> list[Outcome]:
    """Do the steps, and stop at the first that goes wrong. `on_outcome` gets each at once."""
    outcomes: list[Outcome] = []
    for step in plan:
        outcome = _set(wire, module.dialect, step)
        if step.what == BAUD and outcome.how != REFUSED:
            outcome = _check_speed(wire, module, outcome)
        outcomes.append(outcome)
        on_outcome(outcome)
        if outcome.how not in GOOD_OUTCOMES:
            return outcomes
    return outcomes


def _set(wire: Wire, dialect: Dialect, step: Step) -> Outcome:
    """Send the forms of a command until one is taken and the module tells the value."""
    question = {NAME: dialect.ask_name, PIN: dialect.ask_pin, BAUD: dialect.ask_baud}[step.what]
    outcome = Outcome(step, SILENT)
    for command in step.commands:
        text = ask(wire, command, dialect.ending, dialect.wait_ms)
        if is_ok(text):
            if not question:
                return Outcome(step, UNSEEN, text)
            answer = ask(wire, question, dialect.ending, dialect.wait_ms)
            now = value_of(answer)
            if not answer and not is_there(wire, dialect):
                return Outcome(step, SILENT, text)
            if not now:
                return Outcome(step, UNSEEN, text)
            if _is_same(step, dialect, answer):
                return Outcome(step, DONE, now)
            outcome = Outcome(step, DIFFERS, now)
        elif text and outcome.how != DIFFERS:
            outcome = Outcome(step, REFUSED, text if is_error(text) else "")
    return outcome


def _is_same(step: Step, dialect: Dialect, answer: str) -> bool:
    """Whether an answer has the value.

    Firmware that wants a PIN in quotes tells `+PIN:"1234"`. Where an older one tells
    `+PSWD:"1234"`, it has kept the quotes.
    """
    now = value_of(answer)
    if step.what == BAUD:
        return now.split(",")[0] in (step.value, dialect.bauds[int(step.value)])
    if answer.startswith("+PIN:"):
        now = now.strip('"')
    return now == step.value


def _check_speed(wire: Wire, module: Module, outcome: Outcome) -> Outcome:
    """Return whether the module is at its new speed, else at which one it is."""
    dialect, step = module.dialect, outcome.step
    baud = int(step.value)
    if dialect.is_fixed:
        return outcome._replace(how=LOST) if outcome.how == SILENT else outcome
    if dialect.restart:
        ask(wire, dialect.restart, dialect.ending, dialect.wait_ms)
        wire.receive(RESTART_MS, RESTART_MS)
    wire.set_baud(baud)
    if is_there(wire, dialect):
        return Outcome(step, DONE, step.value)
    elsewhere = find_module(wire, wakes=False)
    if elsewhere is None:
        return Outcome(step, LOST, step.value)
    how = DONE if elsewhere.baud == baud else ELSEWHERE
    return Outcome(step, how, str(elsewhere.baud))
