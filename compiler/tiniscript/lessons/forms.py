"""Sentences for people who write programs as text, and for those who use blocks.

`[[a line|a block]]` in a sentence is read as its first part by the former, who are also those who
read on paper and in a terminal, and as its second part by the latter.
"""

from __future__ import annotations

import re

TEXT, BLOCKS = "text", "blocks"  # ways to show programs
_ALTERNATIVES = re.compile(r"\[\[([^|\]]*)\|([^|\]]*)\]\]")


def sentences_in_form(sentences: str, form: str) -> str:
    """Return the sentences as readers of this form see them."""
    return _ALTERNATIVES.sub(r"\1" if form == TEXT else r"\2", sentences)
