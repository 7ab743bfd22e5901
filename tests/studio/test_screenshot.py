"""The pictures of the studio show what its page says: seen without a browser."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from tools.builds import screenshot


@pytest.mark.parametrize("scene", screenshot.SCENES)
@pytest.mark.parametrize("language", screenshot.LANGUAGES)
def test_a_picture_has_words_of_the_page_alone(language: str, scene: str) -> None:
    assert screenshot.stale(language, scene) == ""
    with Image.open(screenshot.picture(language, scene)) as image:
        assert image.size == (screenshot.SIZE["width"], screenshot.SIZE["height"])
        assert len(json.loads(image.info[screenshot.KEPT])) > 12
    assert screenshot.picture(language, scene).stat().st_size < 80_000


def test_a_word_that_the_page_says_no_more_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(screenshot, "picture", lambda language, _: tmp_path / f"{language}.png")
    assert screenshot.main(["--check"]) == 1
    assert "there is no en.png" in capsys.readouterr().err
    for language, words in (("en", ["Run", "Halt at once"]), ("es", [])):
        kept = PngInfo()
        kept.add_text(screenshot.KEPT, json.dumps(words))
        Image.new("RGB", (1, 1)).save(tmp_path / f"{language}.png", pnginfo=kept)
    assert screenshot.main(["--check"]) == 1
    said = capsys.readouterr().err.splitlines()
    assert "shows “Halt at once”" in said[0]
    assert "does not say what can be read" in said[-1]


@pytest.mark.parametrize("scene", screenshot.SCENES)
@pytest.mark.parametrize("language", screenshot.LANGUAGES)
def test_each_page_shows_it(language: str, scene: str) -> None:
    shown = screenshot.picture(language, scene).name
    assert f"]({shown})" in screenshot.GUIDES[language]
