"""The pictures of the studio show what its page says: checked without a browser."""

from __future__ import annotations

import json

import pytest
from PIL import Image

from tools.builds import screenshot


@pytest.mark.parametrize("scene", screenshot.SCENES)
@pytest.mark.parametrize("language", screenshot.LANGUAGES)
def test_a_screenshot_has_only_texts_of_the_page_and_is_shown(language: str, scene: str) -> None:
    assert screenshot.unusable_reason(language, scene) == ""
    with Image.open(screenshot.picture(language, scene)) as image:
        assert image.size == (screenshot.VIEWPORT["width"], screenshot.VIEWPORT["height"])
        assert len(json.loads(image.info[screenshot.WORDS_SCENE])) > 6
    assert screenshot.picture(language, scene).stat().st_size < 80_000
    name = screenshot.picture(language, scene).name
    assert f"](../pictures/{name})" in screenshot.GUIDES[language]
