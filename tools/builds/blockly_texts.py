"""The sentences of Blockly itself that the page can say, in both languages.

The English ones are the package's; Spanish is ours, since the package's is English where it speaks
to screen readers, and speaks to a stranger elsewhere. Only what Blockly's core names is taken: the
page uses none of its ready blocks.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

OURS = "blockly_es.json"  # among the sources of the page
_ROW = re.compile(r'^Blockly\.Msg\["(\w+)"\] = ("(?:[^"\\]|\\.)*");$', re.MULTILINE)
_NAME = re.compile(r"[A-Z][A-Z0-9_]+")


def english(package: Path) -> dict[str, str]:
    """Return the package's sentences that its core names."""
    core = (package / "blockly_compressed.js").read_text(encoding="utf-8")
    named = set(_NAME.findall(core))
    rows = _ROW.findall((package / "msg" / "en.js").read_text(encoding="utf-8"))
    return {name: json.loads(text) for name, text in rows if name in named}


def texts(package: Path, sources: Path) -> dict[str, dict[str, str]]:
    """Return the sentences by language. A sentence without Spanish is left out there."""
    found = json.loads((sources / OURS).read_text(encoding="utf-8"))
    return {"en": english(package), "es": found}
