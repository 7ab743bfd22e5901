"""The readers of a wrong program, and their rows."""

from __future__ import annotations

import pytest

from tiniscript.recovery.meanings import UNNAMED_END
from tiniscript.recovery.told import READERS
from tools import readers


def test_the_documented_readers_exist() -> None:
    assert {*readers.WHOLE_LINE_READERS} <= {reader.__name__ for reader in READERS}


def test_a_rewrite_names_its_row(capsys: pytest.CaptureFixture[str]) -> None:
    readers.main(["SI|REPEAT 4;F(1, 50);END"])
    shown_text = capsys.readouterr().out
    assert UNNAMED_END not in shown_text
    first, *rest = shown_text.splitlines()
    assert first == "SI|REPEAT 4;F(1, 50);END: sure_findings"
    assert any("->  LOOP ( 4 ) ; F ( 1 , 50 )" in line for line in rest)
    assert "    by the row of repite 4: ⏎ F(1, 60) => LOOP(4) ⏎ F(1, 60) ⏎ END_LOOP" in rest
    assert rest[-4:-1] == [
        "    by blocks.py, which gives each block its end",
        "  which slips.py and meant.py tell as TS102 REPEAT, TS023 END",
        "TS102 {'found': 'REPEAT', 'right': 'LOOP', 'usage': 'LOOP(n)', 'fix': 'LOOP(4)'} made",
    ]
    assert rest[-1] == "TS023 {'found': 'END', 'right': 'END_LOOP'} made"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("F(2, 80)", []),
        ("1. F(2, 80)", ["1. F(2, 80): labels", "TS054 {'found': '1.'} made"]),
        ("W(2×3)", ["W(2×3): sure_findings", "    by the row of W(2×3) => W(2*3)"]),
        ("avanza 2 segundos", ["    by no row (slots.py, or a sign: lines.py)"]),
        ("F(2, 80", ["F(2, 80: sure_findings"]),
        (
            "LOOP 3\nW(1)\nFIN",
            ["  FIN  ->  END_LOOP", "  which slips.py and meant.py tell as TS015"],
        ),
        ("W(1); XYZZY", ["W(1); XYZZY: no reader, so usage.py says what it knows of the mistake"]),
    ],
)
def test_the_trace_of_a_text_is_printed(text: str, expected: list[str]) -> None:
    lines = "\n".join(readers.trace(text)).splitlines()
    assert [line for line in lines if line in expected] == expected
    assert bool(lines) == bool(expected)
