"""Mutants that no test noticed once, and the test that notices each now.

`test_mutation.py` tries every one at each run: such a gap does not open again in silence. A row
whose code is gone goes with it.
"""

from __future__ import annotations

from typing import NamedTuple


class Known(NamedTuple):
    """In a file the only place with `was` becomes something else; `test` then fails."""

    missing: str
    file: str
    was: str
    becomes: str
    test: str


# fmt: off
KNOWN: tuple[Known, ...] = (
    Known("a refused program", "vm_arduino/src/firmware/program.cpp",
          "or to none\n    store.refuse();", "or to none\n",
          "tests/firmware/test_undo.py::test_a_robot_begins_with_the_newest_program_that_it_can_run"),
    Known("a stored trim", "vm_arduino/src/firmware/identity.cpp",
          "if (is_sound(found)) change_trim(found);", "change_trim(found);",
          "tests/firmware/test_other_versions.py::test_a_trim_that_other_firmware_has_kept_is_none"),
    Known("a request of who has left", "compiler/tiniscript/link/sharing/server.py",
          "self._detached_requests += client.requests.values()", "pass",
          "tests/sharing/test_shared_port.py::test_a_run_that_begins_after_its_client_has_left_is_stopped"),
    Known("the page that asked last", "compiler/tiniscript/studio/serving.py",
          "found = self._connections.pop(client, None)", "found = self._connections.get(client)",
          "tests/studio/test_serving_robots.py::test_the_page_that_has_asked_last_is_kept"),
    Known("a lamp behind", "compiler/tiniscript/virtual/sensing.py",
          "max(0.0, math.cos(angle))", "math.cos(angle)",
          "tests/virtual/test_driving.py::test_a_lamp_is_brighter_near_and_ahead_and_not_through_a_wall"),
    Known("a broker that is heard", "vm_arduino/src/boards/esp32/broker.cpp",
          "\n  heard_ms = now_ms();", "",
          "tests/firmware/test_esp32_broker.py::test_who_has_the_robot_keeps_it_while_it_speaks"),
    Known("letters of S that end with their line", "vm_arduino/src/link/typed_stop.h",
          "place_ = byte == kEscapeByte ? kEscape : kBegin;",
          "if (byte == kEscapeByte) place_ = kEscape;",
          "tests/link/test_typed_stops.py::test_a_stop_is_seen_behind_any_prefix"),
    Known("mistakes that are forgotten", "vm_arduino/src/link/console.cpp",
          "if (quiet_ms_ >= kPauseMs) mistakes_ = 0;", "",
          "tests/firmware/test_text.py::test_who_makes_many_mistakes_is_told_that_once"),
    Known("what all arms of an IF have read", "compiler/tiniscript/text/memory.py",
          "self.blocks[-1].has_else = True", "self.blocks[-1].has_else = False",
          "tests/text/test_levels.py::test_what_each_arm_has_read_is_not_read_again"),
    Known("a comment as wide as a line", "compiler/tiniscript/sketch/statements.py",
          "WIDEST - 2 * self.depth - 3)", "WIDEST - 2 * self.depth - 4)",
          "tests/sketch/test_writing.py::test_a_long_comment_is_broken_where_the_line_ends"),
    Known("an end that is nobody's", "compiler/tiniscript/link/sharing/peers.py",
          "        raise OSError(number, os.strerror(number))", "        pass",
          "tests/sharing/test_peers.py::test_of_an_end_that_is_nobody_s_the_kernel_says_so"),
    Known("a file that is held", "compiler/tiniscript/flash/building.py",
          "ignore_cleanup_errors=True", "ignore_cleanup_errors=False",
          "tests/flash/test_building.py::test_a_file_that_cannot_be_removed_yet_fails_no_build"),
    Known("a second name of a port", "compiler/tiniscript/link/sharing/server.py",
          "port=address, is_alias=True", "port=address, is_alias=False",
          "tests/sharing/test_run_owners.py::test_a_port_with_two_names_is_listed_once"),
    Known("a turn of a task's loop", "compiler/tiniscript/semantics/duration.py",
          "if body.least == 0 and body.most is not None:", "if False:",
          "tests/semantics/test_duration.py::test_a_program_that_ends"),
    Known("a pipe that is written to", "compiler/tiniscript/files.py",
          "if found is not None and not stat.S_ISREG(found.st_mode):", "if False:",
          "tests/cli/test_files.py::test_another_hard_link_keeps_the_old_content_and_a_pipe_stays_one"),
    Known("a mistake right behind the first instruction", "vm_arduino/src/text/reader_code.cpp",
          "  if (problem_ != Problem::kNone) return false;\n  if (state_", "  if (state_",
          "tests/firmware/test_text_small.py::test_a_bad_line_ends_what_runs_only_behind_a_whole_instruction"),
    Known("what stands behind a loop", "compiler/tiniscript/lessons/text_judging.py",
          "inside = open_loops.pop()", "pass",
          "tests/lessons/test_judging.py::test_what_stands_behind_a_loop_is_not_in_it"),
    Known("a drawn wheel", "compiler/tiniscript/robots/wiring/finished.py",
          "min(WHEEL_CM[1], body", "min(WHEEL_CM[0], body",
          "tests/wiring/test_wiring.py::test_a_small_plate_is_drawn_with_small_wheels"),
    Known("a drawn servo's name", "compiler/tiniscript/robots/wiring/finished.py",
          "text_at(part.title, self.left - 10, row, BESIDE - 20, \"end\", style=BOLD)",
          "text_at(part.title, self.left - 10, row, BESIDE + 20, \"end\", style=BOLD)",
          "tests/wiring/test_wiring.py::test_the_longest_names_stay_in_the_finished_drawing"),
    Known("a least number of a criterion", "compiler/tiniscript/lessons/lesson.py",
          "(Number(\"within_cm\", 1, 500, 6), Number(\"at_least_cm\", 1, MOST))",
          "(Number(\"within_cm\", 1, 500, 6), Number(\"at_least_cm\", 0, MOST))",
          "tests/lessons/test_reader.py::test_a_refused_lesson_says_why"),
    Known("a reading of an UNTIL", "vm_arduino/src/text/reader_parser.cpp",
          "known_ = 0;", "known_ = 1;",
          "tests/text/test_reader.py::test_an_until_reads_in_each_of_its_turns"),
    Known("a range of more than 15 bits", "vm_arduino/src/boards/ranges.cpp",
          "range >>= 1;", "range >>= 2;",
          "tests/firmware/test_board_devices.py::test_a_fan_and_a_lamp_that_is_on_when_low"),
    Known("a connection that ends", "vm_arduino/src/boards/esp32/broker.cpp",
          "  line_end();\n  part();", "  part();",
          "tests/firmware/test_esp32_broker.py::test_a_robot_that_is_told_its_broker_often_has_one_connection"),
    Known("events that nobody takes", "compiler/tiniscript/virtual/robot.py",
          "        del self._traced.events[:-EVENTS]\n", "",
          "tests/virtual/test_virtual_robot.py::test_of_what_nobody_takes_the_newest_is_kept"),
    Known("a large whole number", "compiler/tiniscript/sketch/expressions.py",
          "if value % ONE == 0:", "if value % ONE == 1:",
          "tests/sketch/test_writing.py::test_a_large_whole_number_is_itself"),
    Known("files that are still to be compiled", "compiler/tiniscript/flash/building.py",
          "for name in made_from.files) + CORE_FILES", "for name in made_from.files) - CORE_FILES",
          "tests/flash/test_building.py::test_all_sources_are_not_yet_all_of_it"),
    Known("a seal that a robot has lost", "compiler/tiniscript/link/session.py",
          "self._sealing.seal = None\n        self._handshake.is_open = False",
          "self._sealing.seal = None\n        self._handshake.is_open = True",
          "tests/firmware/test_sealed_robot.py::test_a_sealed_session_opens_anew_with_a_robot_that_was_reset"),
    Known("a beep that begins while another sounds", "vm_arduino/src/boards/avr/sound.cpp",
          "  sound_off();\n  if (duration_ms == 0) return;", "  if (duration_ms == 0) return;",
          "tests/firmware/test_board_devices.py::test_a_beep_of_no_time_ends_the_one_before"),
    Known("the places of tasks", "compiler/tiniscript/virtual/module.py",
          "self._numbers[start + 1 : start + 1 + count]]\n\n    def variables",
          "self._numbers[start + 1 : start + 2 + count]]\n\n    def variables",
          "tests/virtual/test_virtual_robot.py::test_each_task_that_has_not_ended_has_a_place"),
    Known("checks of a program without end", "compiler/tiniscript/repairs/fixing.py",
          "self.left -= 1", "self.left += 1",
          "tests/pupils/test_choices.py::test_a_program_is_checked_so_often_and_no_more"),
    Known("a mistake in what a repair writes", "compiler/tiniscript/repairs/fixing.py",
          "end = start + len(new)", "end = start - len(new)",
          "tests/pupils/test_choices.py::test_a_repair_with_a_mistake_in_it_is_none"),
    Known("what a robot can do in a report", "compiler/tiniscript/doctor/examination.py",
          "\", \".join(features) or \"-\"", "\", \".join(features) and \"-\"",
          "tests/doctor/test_line.py::test_a_report_tells_what_a_robot_can_do"),
)
# fmt: on
