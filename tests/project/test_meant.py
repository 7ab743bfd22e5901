"""The two figures of a folder of wrong programs."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools import meant


def test_repairs_are_classified_as_right_or_harmful(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    texts = {
        "a.ts": "F(2 80)",
        "a.meant.ts": "F(2, 80)",
        "b.ts": "avanza 2 segundos 3 veces mas o menos",
        "b.meant.ts": "F(2, 80)",
        "more/c.ts": "F(2;80)",
        "more/c.meant.ts": "F(2, 8)",
        "d.ts": "// robot: liner\nLED(HIGH)",
        "e.ts": "F(2, 80)",
        "e.meant.ts": "B(2, 80)",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert meant.figures(tmp_path) == (5, 4, 4, ("e.ts", "more/c.ts"))
    assert meant.main([str(tmp_path)]) == 1
    assert capsys.readouterr().out == (
        "right after --fix: 4 of 5\nharmful: 2 of 4 whose meaning is known e.ts more/c.ts\n"
    )
    (tmp_path / "none").mkdir()
    with pytest.raises(SystemExit, match=r"no programs"):
        meant.main([str(tmp_path / "none")])
