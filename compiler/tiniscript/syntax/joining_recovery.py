"""Recovery of words between two instructions: `F(2, 80) y después B(2, 80)`."""

from __future__ import annotations

from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.lexer import WORD
from tiniscript.syntax.phrases import BETWEEN, FINALLY
from tiniscript.syntax.reporter import Reporter
from tiniscript.words import WORDS

_TOO = frozenset(("TAMBIEN", "ADEMAS", "ALSO"))


class JoiningRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    def _is_call(self, k: int) -> bool:
        return self.cursor.tokens[k].text in WORDS and self.cursor.tokens[k + 1].kind == "("

    def words(self) -> int:
        """Return how many words at the cursor only join two instructions: `y despues al final`."""
        tokens, start = self.cursor.tokens, self.cursor.i
        k = start
        while tokens[k].kind is WORD:
            if (tokens[k].text, tokens[k + 1].text) in FINALLY:
                k += 2
            elif tokens[k].text in _TOO and self._is_call(k + 1):
                self.reporter.answer(tokens[k])  # `también` has an accent
                k += 1
            elif tokens[k].text in BETWEEN and not self.in_block.is_name(tokens[k].text):
                self.reporter.answer(tokens[k])  # `después` has an accent
                k += 1
            else:
                break
        return k - start
