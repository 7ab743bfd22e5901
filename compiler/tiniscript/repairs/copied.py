"""A program without what came along when it was copied: tags, fences, prompts.

Knows the pieces that `pasted` finds. Where two instructions would touch, a `;` comes between them.
"""

from __future__ import annotations

from tiniscript.source import Edit, Span
from tiniscript.syntax.pasted import pieces


def without_pasted(text: str) -> list[Edit]:
    """Return the changes that take all pieces out."""
    edits: list[Edit] = []
    run: list[tuple[int, int, str]] = []  # with nothing but spaces between them
    for piece in pieces(text):
        if run and text[run[-1][1] : piece[0]].strip(" \t"):
            edits += _without(text, run)
            run = []
        run.append(piece)
    return edits + _without(text, run)


def _without(text: str, run: list[tuple[int, int, str]]) -> list[Edit]:
    if not run:
        return []
    before = _beside(text[max(0, run[0][0] - 100) : run[0][0]].rstrip(" \t")[-1:])
    after = _beside(text[run[-1][1] : run[-1][1] + 100].lstrip(" \t")[:1])
    is_line = any(new == "\n" for _, _, new in run) and not (before or after)
    edits = [Edit(Span(start, end), "" if new == "\n" else new) for start, end, new in run]
    first = edits[0]
    return [first._replace(text=";" + first.text), *edits[1:]] if is_line else edits


def _beside(sign: str) -> bool:
    """Whether an instruction begins or ends there anyway."""
    return not sign or sign in ";\r\n|"
