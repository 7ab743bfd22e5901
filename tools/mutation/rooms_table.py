"""The rooms of the house that are broken on purpose: their files, and the tests about them.

The table of `rooms.py`; knows nothing of changes.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple


class Room(NamedTuple):
    """`files` are patterns below the repository; `tests` are given to pytest, quick ones first.

    Of a file whose name is in `about`, only those run that have one of its words. No test runs
    whose name has a word of `without`: it takes long, and others ask the same. Of `is_page` the
    studio's page is built before its tests run.
    """

    name: str
    files: tuple[str, ...]
    tests: tuple[str, ...]
    about: Mapping[str, str] = MappingProxyType({})
    without: tuple[str, ...] = ()
    is_page: bool = False

    def tests_of(self, file: str) -> tuple[str, ...]:
        words = self.about.get(Path(file).name, "").split()
        fit = [test for word in words for test in self.tests if word in test]
        return tuple(dict.fromkeys(fit)) or self.tests


_CPP, _PY, _JS = "vm_arduino/src", "compiler/tiniscript", "tools/studio/src"
ROOMS = (
    Room(
        "link",
        (f"{_CPP}/link/[!m]*.cpp",),  # `messages.cpp` is a table
        (
            "tests/link/test_link_cases.py",
            "tests/link/test_siphash.py",
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_owners.py",
            "tests/firmware/test_authority.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_text_limits.py",
            "tests/link/test_robot_times.py",
            "tests/firmware/test_terminal_programs.py",
            "tests/firmware/test_text.py",
            "tests/link/test_damaged_frames.py",
        ),
        {
            "siphash.cpp": "siphash",
            "link_owners.cpp": "link_cases owners authority",
            "console.cpp": "link_cases text_limits terminal",
            "console_writing.cpp": "link_cases text_limits terminal",
            "link_text.cpp": "link_cases text_limits terminal",
            "frames.cpp": "link_cases robot_times damaged",
            "receiver.cpp": "link_cases robot_times text_limits",
            "link.cpp": "link_cases robot_times host owners keeping",
            "link_programs.cpp": "link_cases host text_limits",
            "link_writing.cpp": "link_cases host owners",
        },
    ),
    Room(
        "store",
        (f"{_CPP}/store/store.cpp",),
        (
            "tests/firmware/test_store.py::test_with_the_plug_in",
            "tests/firmware/test_store.py::test_old_or_new",
            "tests/firmware/test_store.py::test_what_breaks_are_noticed_by_finds_nothing",
            "tests/firmware/test_undo.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_other_versions.py",
            "tests/firmware/test_owners.py",
        ),
    ),
    Room(
        "firmware",
        (f"{_CPP}/firmware/*.cpp",),
        (
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_undo.py",
            "tests/firmware/test_stops.py",
            "tests/firmware/test_other_versions.py",
            "tests/firmware/test_button.py",
            "tests/firmware/test_owners.py",
            "tests/firmware/test_actuator_stops.py",
            "tests/firmware/test_trim.py",
            "tests/firmware/test_text.py",
            "tests/firmware/test_random_numbers.py",
            "tests/firmware/test_replaced_runs.py",
            "tests/firmware/test_stop_states.py",
            "tests/firmware/test_uno_robot.py::test_a_stop_silences_the_buzzer",
        ),
        {
            "owners.cpp": "owners",
            "identify.cpp": "owners",
            "trim.cpp": "trim",
            "identity.cpp": "keeping owners host",
            "program.cpp": "host keeping undo other_versions",
            "holding.cpp": "host keeping undo other_versions",
            "keeping.cpp": "keeping undo host owners",
            "run.cpp": "random replaced host stops button keeping stop_states silences",
            "firmware.cpp": "host button keeping owners",
        },
    ),
    Room(
        "boards",
        (f"{_CPP}/boards/*.cpp", f"{_CPP}/boards/avr/*.cpp"),
        (
            "tests/firmware/test_boards.py",
            "tests/firmware/test_board_devices.py",
            "tests/firmware/test_board_sonar.py",
            "tests/firmware/test_board_stops.py",
            "tests/firmware/test_uno_robot.py",
            "tests/firmware/test_uno_line.py",
            "tests/firmware/test_uno_watchdog.py",
            "tests/firmware/test_uno_supply.py",
            "tests/firmware/test_uno_stops.py",
        ),
        {
            "analog.cpp": "devices supply",
            "board.cpp": "boards devices",
            "button.cpp": "boards uno_robot",
            "clock.cpp": "boards uno_robot uno_stops",
            "eeprom.cpp": "uno_robot",
            "interrupts.cpp": "uno_line uno_stops",
            "motors.cpp": "boards board_stops",
            "servo.cpp": "boards devices",
            "sound.cpp": "devices",
            "uart.cpp": "uno_line uno_robot uno_stops",
            "ultrasonic.cpp": "sonar devices",
            "watchdog.cpp": "watchdog uno_robot",
        },
        ("nano", "(mega and (12_us or hangs))"),  # what an Uno tells, too
    ),
    Room(
        "verifier",
        (f"{_PY}/bytecode/verify.py", f"{_PY}/bytecode/image.py"),
        ("tests/bytecode/test_image.py", "tests/vm/test_cases.py", "tests/bytecode"),
    ),
    Room(
        "session",
        (
            f"{_PY}/link/session.py",
            f"{_PY}/link/requests.py",
            f"{_PY}/link/robot_state.py",
            f"{_PY}/link/receiver.py",
        ),
        (
            "tests/link/test_link_cases.py",
            "tests/link/test_session.py",
            "tests/link/test_session_resets.py",
            "tests/link/test_session_waits.py",
            "tests/link/test_robot_times.py",
        ),
    ),
    Room(
        "sharing",
        (f"{_PY}/sharing/*.py",),
        (
            "tests/sharing/test_requests.py",
            "tests/sharing/test_peers.py",
            "tests/sharing/test_run_owners.py",
            "tests/sharing/test_shared_port.py",
            "tests/sharing/test_shared_port_visitors.py",
            "tests/sharing/test_strangers.py",
        ),
        {
            "peers.py": "peers",
            "registry.py": "peers shared_port",
            "protocol.py": "shared_port strangers",
            "client.py": "shared_port run_owners",
            "requests.py": "test_requests shared_port.py",
            "server.py": "run_owners shared_port strangers",
        },
        (
            "another_user_moves",
            "token_is_in_one",
            "begun_once",
            "thousand_connections",
            "works_while_another",
        ),
    ),
    Room(
        "optimizer",
        (f"{_PY}/semantics/optimizer.py",),
        ("tests/semantics", "tests/vm/test_cases.py"),
    ),
    Room("lowering", (f"{_PY}/codegen/*.py",), ("tests/codegen", "tests/vm/test_cases.py")),
    Room(
        "checker",
        tuple(f"{_PY}/semantics/{name}.py" for name in ("checker", "types", "wrong_*")),
        (
            "tests/semantics",
            "tests/vm/test_cases.py",
            "tests/pupils/test_pupils.py",
            "tests/diagnostics/test_rendering.py",
        ),
    ),
    Room("recordings", (f"{_PY}/studio/recordings.py",), ("tests/studio/test_recordings.py",)),
    Room(
        "page-flash",
        (f"{_JS}/stk500.js", f"{_JS}/intel_hex.js"),
        ("tests/studio/test_flashing.py",),
        without=("new_board", "sketch"),  # simulated boards, which node meets more slowly
    ),
    Room(
        "page-work",
        tuple(f"{_JS}/{name}.js" for name in ("work", "versions", "links", "own_worlds")),
        (
            "tests/studio/test_page_two_tabs.py",
            "tests/studio/test_page_programs.py",
            "tests/studio/test_page_worlds_kept.py",
            "tests/studio/test_page.py",
        ),
        {
            "work.js": "test_page.py two_tabs worlds_kept",
            "versions.js": "programs two_tabs",
            "links.js": "programs",
            "own_worlds.js": "worlds_kept two_tabs",
        },
        ("every_line", "pictures", "saved_as_a_picture", "seen", "every_program", "long_program"),
        is_page=True,
    ),
    Room(
        "page-worlds",
        (f"{_JS}/world_parts.js", f"{_JS}/world_drawing.js", f"{_JS}/world_numbers.js"),
        ("tests/studio/test_page_worlds.py", "tests/studio/test_page_worlds_kept.py"),
        without=("seen",),
        is_page=True,
    ),
)
BY_NAME = {room.name: room for room in ROOMS}
