"""Compares a program with its blocks: neither loses any part of the other."""

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
    text_before = compile_text(text, kit)
    for form in (read_blocks(text, kit), touched_form(read_blocks(text, kit))):
        check_form(form, text, kit, text_before.image)
    if "///" not in text and not text.startswith("PING"):
        assert format_blocks(read_blocks(text, kit)).text == format_source(Source(text)), text


def check_form(form: Form, text: str, kit: Kit, image: bytes) -> None:
    assert "grey" not in [block.kind for block in in_order(form.body)], text
    printed_form = format_blocks(from_data(json.loads(json.dumps(data_of(form)))))
    text_after = compile_text(printed_form.text, kit)
    assert text_after.is_right and text_after.image == image, printed_form.text
    assert format_source(Source(printed_form.text)) == printed_form.text
    assert comment_words(printed_form.text) == comment_words(text), printed_form.text
    round_tripped = read_blocks(printed_form.text, kit)
    assert format_blocks(round_tripped).text == printed_form.text
    pairs = zip(in_order(round_tripped.body), printed_form.places, strict=True)
    for block, place in pairs:
        if block.kind != "comment":
            assert block.place == place, (block, place, printed_form.text)


def touched_form(form: Form) -> Form:
    """Return blocks without knowledge of their former state."""

    def copy_blocks(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
        return tuple(
            Block(
                block.kind,
                block.word,
                block.values,
                tuple(map(copy_blocks, block.bodies)),
                block.note,
                block.is_apart,
            )
            for block in blocks
        )

    return form._replace(body=copy_blocks(form.body))
