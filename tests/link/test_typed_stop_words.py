"""Lines that are typed stops, in any spelling; the robot's matcher has to agree."""

from __future__ import annotations

from tests.support.rows import each_row
from tiniscript.link.typed_stop import is_at_stop, is_typed_stop, stops_at_once


@each_row("line", [
    b"S", b"s", b"SS", b"s s", b"S.", b"S()", b"STOP", b"Stop.", b"stop!", b"stop();", b"STOP NOW",
    b"stopstop", b"STOP;STOP",
    b"STOPS", b"SSTOP", b"s stop now", b"alto", b"PARA", b"parar", b"Pare", b"DETENTE", b"!HALT!",
    b"\x1b[AS", b"S\x1b[1;5C", b"S // now", b"SX\b", b"\xc2\xa1ALTO!", b" \t;S;",
])  # fmt: skip
def test_stop_words_are_recognized(line: bytes) -> None:
    assert is_typed_stop(line) and is_at_stop(line) and is_at_stop(b"F(1,\n" + line)
    assert not is_at_stop(line + b"\n")


@each_row("line", [
    b"", b"// S", b" // STOP", b"/ \x1b[A/ S",
    b"ST", b"STO", b"STOPX", b"SNOW", b"PARAS", b"NOW", b"S1",
    b"F(20,60)", b"\x1b[S", b"S\b", b"STOP ALTO",
])  # fmt: skip
def test_other_lines_are_not_stops(line: bytes) -> None:
    assert not is_typed_stop(line) and not stops_at_once(line) and not is_at_stop(line)


def test_some_stops_need_no_line_end() -> None:
    for line in (b"SSS", b"FFFFSSSS", b"F(1,s S\ts", b"STOPSTOP", b"x stop Stop", b"STOP STOPPED"):
        assert stops_at_once(line) and is_at_stop(line), line
    for line in (b"SS", b"S;S;S", b"STOP;STOP", b"F // SSS", b"SUSS"):
        assert not stops_at_once(line), line


def test_ctrl_c_counts_alone() -> None:
    assert is_at_stop(b"\3") and is_at_stop(b"F(1,2)\r\n\3\3")
    assert not is_at_stop(b" \3") and not is_at_stop(b"\3x") and not is_at_stop(b"\3\n")
