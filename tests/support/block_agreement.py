"""How a program and its blocks are compared: neither loses anything of the other."""

from __future__ import annotations

import json

from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.studio.block_form import Block, Form, data_of, from_data, in_order
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks
from tiniscript.syntax.formatter import format_source
from tiniscript.syntax.lexer import scan


def comment_words(text: str) -> list[str]:
    """Return the words of all comments: joined and moved to the next line they are the same."""
    comments = " ".join(token.text[2:] for token in scan(text).comments)
    return [word for word in comments.split() if word != "//"]


def check_blocks(text: str, kit: Kit) -> None:
    """A right program keeps its image and its comments, has no grey block, and is laid out."""
    before = compile_text(text, kit)
    for form in (read_blocks(text, kit), touched_form(read_blocks(text, kit))):
        check_form(form, text, kit, before.image)
    if "///" not in text and not text.startswith("PING"):
        assert format_blocks(read_blocks(text, kit)).text == format_source(Source(text)), text


def check_form(form: Form, text: str, kit: Kit, image: bytes) -> None:
    assert "grey" not in [block.kind for block in in_order(form.body)], text
    printed = format_blocks(from_data(json.loads(json.dumps(data_of(form)))))
    after = compile_text(printed.text, kit)
    assert after.is_right and after.image == image, printed.text
    assert format_source(Source(printed.text)) == printed.text
    assert comment_words(printed.text) == comment_words(text), printed.text
    round_tripped = read_blocks(printed.text, kit)
    assert format_blocks(round_tripped).text == printed.text
    pairs = zip(in_order(round_tripped.body), printed.places, strict=True)
    for block, place in pairs:
        if block.kind != "comment":
            assert block.place == place, (block, place, printed.text)


def touched_form(form: Form) -> Form:
    """Return blocks of which nothing is known but what they are now."""

    def of(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
        return tuple(
            Block(block.kind, block.word, block.values, tuple(map(of, block.bodies)), block.note,
                  block.is_apart) for block in blocks
        )  # fmt: skip

    return form._replace(body=of(form.body))
