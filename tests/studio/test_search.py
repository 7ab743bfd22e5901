"""A search for a block finds it by its label, by its word in the text, and by what children call
it, also those who know Scratch or MakeCode."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.node import in_node, page_data
from tools.builds.page_texts import page_texts

__all__ = ["page_data"]  # a fixture
SCRIPT = Path(__file__).with_name("search_in_node.mjs")
BLOCKS = (
    "when|if|loop|forever|while|wait|beep|show|stop|move F|move B|move L|move R|assign SPEED|"
    "math|compare LT|random|def|comment|logic AND"
)
# In the order of `BLOCKS`, what children call it, between two bars.
CALLED = {
    "en": "when whenever event|if else|repeat|forever always|while|wait pause|sound play note "
          "music|say print|stop halt|move forward go|back reverse|turn left|turn right|"
          "variable set change|add plus|less more|random|function|comment|and or",
    "es": "cuando evento|si|repetir bucle|siempre infinito|mientras|esperar pausa|sonido tocar "
          "nota música|mostrar decir|parar detener|mover adelante|atrás retroceder|girar "
          "izquierda|girar derecha|variable poner cambiar|sumar más|menor mayor|azar aleatorio|"
          "función|comentario|y o",
    "pt": "quando evento|se senão|repetir repita|sempre infinito|enquanto|esperar espere|som "
          "tocar nota música|mostrar diga|parar pare|mover frente|trás recuar|girar vire "
          "esquerda|girar vire direita|variável mudar mude|somar mais|menor maior|aleatório|"
          "função|comentário|e ou",
}  # fmt: skip


@pytest.mark.parametrize("language", CALLED)
def test_a_search_finds_a_block_by_whatever_it_is_called(
    page_data: Path, tmp_path: Path, language: str
) -> None:
    texts_file = tmp_path / "texts.json"
    texts_file.write_text(json.dumps(page_texts(language)), encoding="utf-8")
    expected = [
        (block, word)
        for block, called in zip(BLOCKS.split("|"), CALLED[language].split("|"), strict=True)
        for word in called.split()
    ]
    words = "".join(f"{json.dumps(word)}\n" for _, word in expected)
    rows = in_node(SCRIPT, str(page_data), str(texts_file), input_text=words)
    for (block, word), row in zip(expected, rows[: len(expected)], strict=True):
        assert any(f"{match} ".startswith(f"{block} ") for match in json.loads(row)), (
            word,
            row,
        )
    own_names = [json.loads(row) for row in rows[len(expected) :]]
    assert {"when", "move F", "task"} <= {block for block, _, _ in own_names}
    for block, name, match in own_names:
        assert block in match, (name, match)
