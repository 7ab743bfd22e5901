"""Code that is there in C++ and in Python has the same names.

A reader of one of the two knows the other: each method of one is a method of the other, or a table
here gives its other names, or the reason why it has none. Values that both keep of a program also
have the same name.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import NamedTuple

from tests.support.casefile import ROOT
from tests.support.cpp_sources import code_of
from tests.support.rows import each_row

CPP = ROOT / "vm_arduino" / "src"
PYTHON = ROOT / "compiler" / "tiniscript"
# A method in a class body: `bool Name(…)`, with its qualifiers.
METHOD = re.compile(r"^  (?:[\w:<>]+[ *&]+)+?(\w+)\([^()]*\)(?: const)?[ \w]*[;{]", re.M)


class Twins(NamedTuple):
    """Classes in both languages, and the members that only one of them has: where, or why."""

    cpp: tuple[tuple[str, str], ...]
    python: tuple[tuple[str, str], ...]
    in_cpp: dict[str, str]
    in_python: dict[str, str]
    has_attributes: bool = False  # a method of C++ may correspond to an attribute of Python


TASKS = Twins(
    cpp=(("vm/drive.h", "Drive"), ("vm/scheduler.h", "Scheduler")),
    python=(("vm/tasks.py", "TaskMachine"), ("vm/tasks.py", "TaskRecord"), ("vm/tasks.py", "")),
    in_cpp={
        "begin_others": "_end_turn",
        "comes_to_end": "_end_move",
        "end_round": "_finds_turn",
        "go_on": "_begin_move, _begin_watched, _drive_on",
        "has_had_turn": "_end_turn",
        "late_ms": "begin, until",
        "next_check_ms": "until",
        "sends": "_begin_turn, show",
        "set_clock": "begin",
        "set_motors_of_move": "(without tasks)",
        "forget_way": "(no discs measure a way there)",
        "go_way": "(no discs)",
        "continues_way": "(no discs)",
    },
    in_python={
        "begin_move": "go_on",
        "begin_watched": "go_on",
        "drive_on": "go_on",
        "end": "(in `actions.cpp`)",
        "forget_set": "(beside `drive.cpp`'s class)",
        "go_to": "begin_turn",
        "show": "sends",
        "tick": "(of the class Machine)",
        "wants_motors": "(kWantsMotors)",
        "machine_of": "(one class has tasks or none)",
    },
)
MACHINES = Twins(
    cpp=(("vm/machine.h", "Machine"), ("vm/drive.h", "Drive")),
    python=(("vm/machine.py", "Machine"), ("vm/state.py", "Drive")),
    in_cpp={
        **dict.fromkeys(("start", "prepare", "start_prepared"), "(the constructor)"),
        **dict.fromkeys(("comes_to_end", "end_in_fault", "execute", "is_due", "wake"), "tick"),
        "budget_left": "steps",
        **dict.fromkeys(("late_ms", "next_check_ms"), "until"),
        **dict.fromkeys(("go_on", "keep_move"), "drive, watch"),
        **dict.fromkeys(("end_move", "set_motors_of_move"), "tick, until"),
        "set_clock": "begin",
        "set_motors": "motors",
        **dict.fromkeys(("act", "go_ms", "sense"), "(in `actions.py`)"),
        "check_layout": "(of an AVR)",
        "has_tasks": "(a class has them or not)",
        **dict.fromkeys(
            ("is_trapped", "length", "place_of", "reach_instruction", "resume", "return_place",
             "set_motors_again", "turn"), "(breakpoints)"),
        **dict.fromkeys(("continues_way", "forget_way", "go_way", "is_stuck"), "(no discs)"),
        **dict.fromkeys(
            ("blocks", "is_below", "leave_move", "run_round", "run_turn", "stand_still",
             "take_motors"), "(tasks)"),
    },
    in_python={
        "end": "(in `actions.cpp`)",
        "go_back": "(of the class Scheduler)",
        "now_ms": "(of the class Execution)",
        "robot": "(`robot.h`)",
        "steps": "budget_left",
    },
    has_attributes=True,
)  # fmt: skip
RECEIVERS = Twins(
    cpp=(
        ("link/receiver.h", "Receiver"),
        ("link/key_sequence.h", "KeySequence"),
        ("link/stop_sequence.h", "StopSequence"),
    ),
    python=(
        ("link/receiver.py", "Receiver"),
        ("link/receiver.py", "KeySequence"),
        ("link/receiver.py", "StopSequence"),
    ),
    in_cpp={
        # bytes wait until the main loop looks at them, in the memory of the receiver
        **dict.fromkeys(
            ("bytes", "dropped", "has_frame", "has_room", "has_text",
             "is_first", "length", "put_frame", "release", "take_has_begun", "take_has_heard",
             "take_is_lost", "take_text"), "take"),
        "damaged": "(an attribute)",
        "begin_line": "_end_line",
        "count_damaged": "_cut_packet",
        "cut_line": "_cut_packet",
        "lose_line": "_put_text",
        "disconnect": "(a transport makes a new receiver)",
        "is_active": "put",
        # the halves of `put`, between which an interrupt turns motors off
        **dict.fromkeys(("count_zeros", "keep_and_find_stop", "keep_last_zero"), "put"),
        **dict.fromkeys(
            ("is_quiet", "keep_and_find_silence", "last_ms", "take_whole"), "put"),
        "zeros_at": "(of an AVR)",
        "last_ms_at": "(of an AVR)",
        "mode": "(an attribute)",
        "line": "(an attribute)",
        # typed stops, which are `link/typed_stop.py` in Python
        **dict.fromkeys(
            ("due_stop", "frame_may_stop", "has_mark", "has_open_line", "is_at_stop", "is_held",
             "let_frame", "put_mark", "stop", "stop_at_mark", "take_mark", "take_stop", "watch"),
            "(typed stops)"),
    },
    in_python={
        "cut_packet": "cut_line, count_damaged",
        "has_place": "begin_packet",
        "take": "has_frame, bytes, release, take_text",
    },
)  # fmt: skip


def methods_in_cpp(file: str, name: str) -> set[str]:
    text = code_of(CPP / file)
    body = text[text.index(f"class {name}") :]
    body = body[: body.index("\n};")]
    return set(METHOD.findall(body)) - {name}


def attributes_in_python(file: str, name: str) -> set[str]:
    """Return the names of public attributes that a class sets."""
    tree = ast.parse((PYTHON / file).read_text(encoding="utf-8"))
    body = next(
        statement
        for statement in tree.body
        if isinstance(statement, ast.ClassDef) and statement.name == name
    )
    return {
        node.attr
        for node in ast.walk(body)
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
        and not node.attr.startswith("_")
    }


def methods_in_python(file: str, name: str) -> Iterator[str]:
    """Yield names of methods, or with no class those of functions that no handler is."""
    tree = ast.parse((PYTHON / file).read_text(encoding="utf-8"))
    if name:
        (tree,) = (  # type: ignore[assignment]
            stmt for stmt in tree.body if isinstance(stmt, ast.ClassDef) and stmt.name == name
        )
    for stmt in tree.body:
        if isinstance(stmt, ast.FunctionDef) and not stmt.name.startswith("__"):
            if name or not stmt.decorator_list:
                yield stmt.name.removeprefix("_")


@each_row("twins", [TASKS, MACHINES, RECEIVERS])
def test_twins_have_the_same_names(twins: Twins) -> None:
    cpp = {name for row in twins.cpp for name in methods_in_cpp(*row)}
    python = {name for row in twins.python for name in methods_in_python(*row)}
    if twins.has_attributes:
        python = python.union(*(attributes_in_python(*row) for row in twins.python))
    assert len(cpp & python) > 5
    assert cpp - python == set(twins.in_cpp)
    assert python - cpp == set(twins.in_python)
    for reason_by_name, names in ((twins.in_cpp, python), (twins.in_python, cpp)):
        excused_names = {
            word.strip(" _")
            for names in reason_by_name.values()
            if names[0] != "("
            for word in names.split(",")
        }
        assert excused_names <= names


FIELD = re.compile(r"^  [\w<>]+[ *]+(\w+)(?:\[.*\])?;", re.M)


def fields_in_cpp(text: str, opening: str) -> set[str]:
    body = text[text.index(opening) :]
    return set(FIELD.findall(body[: body.index("\n};")]))


def test_state_kept_by_both_machines_has_one_name() -> None:
    """These are the fields of a program without tasks: a Task, and in C++ the record of the only
    task."""
    text = code_of(CPP / "vm" / "state.h")
    cpp = fields_in_cpp(text, "struct TaskOf<false>") | fields_in_cpp(text, "struct TaskRecord")
    only_cpp = {
        "check": "check_pc",
        "code": "powers, wait, is_watching",
        "power": "powers",
        "state": "wait, is_watching",
        "rest_ms": "move_ms",
        "depth": "stack",
        "frame_count": "counters, calls",
        "frames": "counters, calls",
        "is_late": "(numbers do not wrap around)",
        "current": "(the task itself)",
        "start": "(tasks)",
        "own_powers": "(tasks)",
    }
    python = attributes_in_python("vm/state.py", "Task")
    assert python - cpp == {
        "calls", "check_pc", "counters", "is_watching", "move_ms", "powers", "readings", "wait",
        "wake_ms",
    }  # fmt: skip
    assert cpp - python == only_cpp.keys()
    assert {"clock_ms", "pc", "random_state", "stack", "started_ms", "variables"} <= cpp & python
    for reason in only_cpp.values():
        assert reason.startswith("(") or {*reason.split(", ")} <= python
