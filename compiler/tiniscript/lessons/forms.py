"""What is said to those who write programs as text, and to those who build them of blocks.

`[[a line|a block]]` in a sentence is read as its first part by the former, who are also those who
read on paper and in a terminal, and as its second part by the latter.
"""

from __future__ import annotations

import re

TEXT, BLOCKS = "text", "blocks"  # how a reader sees programs
_ALTERNATIVES = re.compile(r"\[\[([^|\]]*)\|([^|\]]*)\]\]")


def in_form(sentences: str, form: str) -> str:
    """Return what is read of sentences by those who see programs in a form."""
    return _ALTERNATIVES.sub(r"\1" if form == TEXT else r"\2", sentences)
