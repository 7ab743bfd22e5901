"""Notes of other languages: `# turn`, `-- turn`, `<!-- turn -->`, `REM turn`, `/* turn */`.

Text from such a sign to the end of its line is a comment and is not read. It is at the beginning or
the end of an instruction. A comment with an instruction in it, `# F(2, 80)`, may be meant as code:
rows read it, and conservation reports what is lost.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, lexicon_concept
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import plain
from tiniscript.recovery.writing import split_note

_NOTE_SIGN = re.compile(
    r"(?i)(?:^|(?<=[\s;{}|]))(?P<sign>#+|--+>?|<!--+|/\*+|REM\b)[ \t]*(?=[^\W\d]|[¡¿\"'])"
)
_NOTE_END = re.compile(r"[ \t]*(?:\*+/|--+>)\s*$")
_OPEN_VALUE = re.compile(r"[=<>*+\-,(][ \t]*$")  # a value has begun, and continues
_DEFINE = re.compile(r"(?i)define\b")
_CALL = re.compile(r"([^\W\d]\w*)\s*\(")


def note_diagnostics(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for notes that begin with another sign."""
    return [
        Diagnostic(codes.OTHER_NOTE, span, {"found": source[span], "right": corrected_line}, span,
                   Repair(edits, True))
        for span, corrected_line, edits in _notes(source.text)
    ]  # fmt: skip


def note_edits(text: str) -> list[Edit]:
    """Return the edits that make a text's notes of other languages those of TiniScript."""
    return [edit for _, _, edits in _notes(text) for edit in edits]


def _notes(text: str) -> Iterator[tuple[Span, str, tuple[Edit, ...]]]:
    """Yield the sign of each note, its corrected line, and the edits."""
    line_start = 0
    for line in text.split("\n"):
        body = split_note(line)[0]
        match = next((match for match in _NOTE_SIGN.finditer(body) if _is_note(body, match)), None)
        if match is not None:
            end_match = _NOTE_END.search(line, match.end())
            sign_edit = Edit(Span(line_start + match.start(), line_start + match.end()), "// ")
            edits = (
                (
                    sign_edit,
                    Edit(Span(line_start + end_match.start(), line_start + end_match.end()), ""),
                )
                if end_match
                else (sign_edit,)
            )
            corrected_line = (
                line[: match.start()]
                + "// "
                + line[match.end() : end_match.start() if end_match else None]
            )
            yield (
                Span(line_start + match.start(), line_start + match.end("sign")),
                corrected_line.strip(),
                tuple(edits),
            )
        line_start += len(line) + 1


def _is_note(body: str, match: re.Match[str]) -> bool:
    text_before, text_after = body[: match.start()], body[match.end() :]
    is_inside = (
        text_before.count("(") > text_before.count(")")
        or _OPEN_VALUE.search(text_before) is not None
    )
    if is_inside or (match["sign"] == "#" and _DEFINE.match(text_after)):
        return False
    return not any(_is_instruction(word) for word in _CALL.findall(text_after))


def _is_instruction(word: str) -> bool:
    """Return whether a word before a bracket is of the language; block words only if exact."""
    meant_word = WORDS.get(plain(word)) or WORDS.get(lexicon_concept(plain(word)) or "")
    return word in BLOCK_ENDS or (meant_word is not None and meant_word.is_call)
