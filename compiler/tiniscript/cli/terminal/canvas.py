"""Dots on a terminal: braille has 2 x 4 of them in a character.

Knows dots, straight lines and layers; a dot is given from the left and from the top. Anything
outside is not drawn. It does not know what is drawn, nor where on the terminal.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from rich.text import Text

DOTS_PER_COLUMN, DOTS_PER_ROW = 2, 4  # dots of a character
_BLANK = 0x2800  # the braille character without dots
# Bits of the dots, by row and column.
_DOT_BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_MAX_STEPS = 10_000  # steps of a line: one that is longer has its dots further apart

Dot = tuple[int, int]


class Canvas:
    """Dots on `columns` x `rows` characters."""

    def __init__(self, columns: int, rows: int) -> None:
        self.columns, self.rows = columns, rows
        self._cells = bytearray(columns * rows)

    def copy(self) -> Canvas:
        canvas = Canvas(self.columns, self.rows)
        canvas._cells[:] = self._cells
        return canvas

    def clear(self) -> None:
        self._cells = bytearray(len(self._cells))

    def draw_lines(self, dots: Iterable[Dot]) -> None:
        """Draw straight lines from dot to dot."""
        for (ax, ay), (bx, by) in pairwise(dots):
            steps = min(max(abs(bx - ax), abs(by - ay), 1), _MAX_STEPS)
            for k in range(steps + 1):
                x = ax + ((bx - ax) * k * 2 + steps) // (2 * steps)
                y = ay + ((by - ay) * k * 2 + steps) // (2 * steps)
                if 0 <= x < DOTS_PER_COLUMN * self.columns and 0 <= y < DOTS_PER_ROW * self.rows:
                    self._cells[y // DOTS_PER_ROW * self.columns + x // DOTS_PER_COLUMN] |= (
                        _DOT_BITS[y % DOTS_PER_ROW][x % DOTS_PER_COLUMN]
                    )

    def row_bits(self, number: int) -> bytes:
        """Return the dots of each character in a row, as bits of U+2800."""
        return bytes(self._cells[number * self.columns : (number + 1) * self.columns])


def merge_layers(layers: Sequence[tuple[Canvas, str]]) -> list[Text]:
    """Return the rows of canvases of one size that lie on each other, the topmost one first.

    A character has the dots of all of them and the style of the topmost one that has any there.
    """
    texts = []
    for row in range(layers[0][0].rows):
        rows = [canvas.row_bits(row) for canvas, _ in layers]
        line = Text()
        for column, bits in enumerate(zip(*rows, strict=True)):
            dots = 0
            for bit in bits:
                dots |= bit
            line.append(chr(_BLANK + dots) if dots else " ")
            style = next((layers[k][1] for k, bit_set in enumerate(bits) if bit_set), "")
            if style:
                line.stylize(style, column, column + 1)
        texts.append(line)
    return texts


def put_letter(lines: Sequence[Text], dot: Dot, letter: str, style: str = "") -> None:
    """Put a letter of one column in place of the character that a dot lies in."""
    column, row = dot[0] // DOTS_PER_COLUMN, dot[1] // DOTS_PER_ROW
    if not (0 <= row < len(lines) and 0 <= column < len(lines[row].plain)):
        return
    line = lines[row]
    line.plain = line.plain[:column] + letter + line.plain[column + 1 :]
    if style:
        line.stylize(style, column, column + 1)
