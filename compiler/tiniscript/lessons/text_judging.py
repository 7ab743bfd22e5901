"""Compares the text of a program with the criteria of a lesson: which words it has.

Knows tokens: a word in a comment does not count. It does not know what the program does.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from itertools import pairwise, takewhile

from tiniscript import robots
from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.lessons import kept
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.kept import MOVES
from tiniscript.lessons.lesson import Criterion, Lesson
from tiniscript.syntax.lexer import NUMBER, WORD, Token, scan

# Parts that a run lacked completely, by their sentence, with the word for them.
MISSING_KEYS = {
    "still": "move", "still/brief": "move", "order//moves": "move",
    "ends_in/turned": "move", "reaches/turned": "move",
    "shows/nothing": "SHOW", "order//shows": "SHOW", "beeps/none": "BEEP", "order//beeps": "BEEP",
}  # fmt: skip
TASKS = ("WHEN", "TASK")  # they are not nested, in other blocks or in each other
ACTING_WORDS = MOVES | {"S", "BEEP", "SHOW"}  # a wait alone is not worth repeating


def judge_text(text: str, lesson: Lesson) -> list[Finding]:
    """Return the findings about a program's text, independent of its run."""
    question = {"question": _question(lesson.robot)}
    tokens = scan(text).tokens
    findings = (
        JUDGES[criterion.kind](criterion, tokens)
        for criterion in lesson.criteria
        if criterion.kind in JUDGES
    )
    return [
        finding._replace(values={**finding.values, **question}) for finding in findings if finding
    ]


def explain(findings: Sequence[Finding], text: str, lesson: Lesson, ending: str) -> list[Finding]:
    """Return the findings about a run, with the reasons found in the text.

    If the robot did not do something that the text contains, that part was never reached.
    """
    tokens = scan(text).tokens
    words = [token.text for token in tokens if token.kind in (WORD, NUMBER)]
    is_endless = any(finding.key in ("ends", "long") for finding in findings)
    uncalled_findings: list[Finding] = []
    explained_findings = []
    for finding in findings:
        word = MISSING_KEYS.get(finding.key, "")
        name = _name_of_uncalled(word, tokens, words) if word else ""
        if name:
            uncalled_findings = [Finding("uses", "uses/uncalled", {"name": _call_of(name, tokens)})]
        elif word == "move":
            explained_findings.append(_with_condition(finding, tokens, words, lesson, ending))
        elif word not in words:
            explained_findings.append(finding)
        elif not is_endless:
            explained_findings.append(finding._replace(key="unreached", values={"word": word}))
    return uncalled_findings + explained_findings


def _name_of_uncalled(word: str, tokens: Sequence[Token], words: Sequence[str]) -> str:
    """Return a DEF's word that is never called, and contains the missing part."""
    for name in _uncalled_words(words):
        tokens_inside = [token for def_name, token in _tokens_with_def(tokens) if def_name == name]
        if (
            kept.find_moves(tokens_inside)
            if word == "move"
            else word in [token.text for token in tokens_inside]
        ):
            return name
    return ""


def _call_of(name: str, tokens: Sequence[Token]) -> str:
    """Return a call of a DEF with the names of its values: `SQUARE(SIZE)`."""
    texts = [token.text for token in tokens]
    index = next(k for k, pair in enumerate(pairwise(texts)) if pair == ("DEF", name)) + 2
    if texts[index : index + 1] != ["("]:
        return name
    return f"{name}{''.join(takewhile(lambda text: text != ')', texts[index:]))})".replace(
        ",", ", "
    )


def _tokens_with_def(tokens: Sequence[Token]) -> list[tuple[str, Token]]:
    """Return each token with the word of the DEF that it belongs to, or ""."""
    pairs, name = [], ""
    for k, token in enumerate(tokens):
        if token.text == "DEF":
            name = tokens[k + 1].text
        pairs.append((name, token))
        if ALIASES.get(token.text, token.text) == BLOCK_ENDS["DEF"]:
            name = ""
    return pairs


def _with_condition(
    finding: Finding, tokens: Sequence[Token], words: Sequence[str], lesson: Lesson, ending: str
) -> Finding:
    """Return a finding of a robot that stays where it is; with a question that kept it, that."""
    uncalled_words = _uncalled_words(words)
    called_tokens = [
        token for name, token in _tokens_with_def(tokens) if name not in uncalled_words
    ]
    is_turned = finding.key.endswith("/turned")
    if finding.key == "still/brief":  # it had power, so no IF kept it from moving
        called_words = {token.text for token in called_tokens}
        if "M" in called_words and "UNTIL" not in called_words:
            return finding
        finding = finding._replace(key="still")
    question = kept.question(called_tokens, is_turned, ending)
    if question is None:
        return finding
    kit = robots.load(lesson.robot).kit
    sensors = [device.name for device in kit.readings]
    named_sensors = [word for word in [*question.words, *words] if word in sensors]
    key = f"{'turned' if is_turned else 'still'}/{'ever' if question.is_ever else 'question'}"
    sensor = (*named_sensors, sensors[0])[0]
    return finding._replace(
        key=key, values={"word": question.word, "what": sensor, "truth": question.truth}
    )


def _question(robot: str) -> str:
    """Return a question that a robot can answer, for examples: a yes/no sensor, or a distance."""
    sensors = robots.load(robot).kit.sensors
    yes_no = [device.name for device in sensors if device.is_yes_no]
    return yes_no[0] if yes_no else "DISTANCE < 15"


def _judge_words(criterion: Criterion, tokens: Sequence[Token]) -> Finding | None:
    words = _words(tokens)
    times, word_counts = int(criterion.number_by_key.get("times", 1)), Counter(words)
    if "UNTIL" in criterion.words and word_counts["UNTIL"] - kept.count_unasked(tokens) < times:
        if word_counts["UNTIL"] >= times:
            return Finding("uses", "uses/unasked")
    for word in criterion.words:
        if word_counts[word] < times:
            key = "uses/none" if not word_counts[word] else "uses/few"
            values = {"word": word, "times": str(times), "found": str(word_counts[word])}
            return Finding("uses", key, values)
    def_names = _def_names(words)
    uncalled_words = _uncalled_words(words)
    if "DEF" in criterion.words and len(def_names) - len(uncalled_words) < times and uncalled_words:
        return Finding("uses", "uses/uncalled", {"name": _call_of(uncalled_words[0], tokens)})
    if "LOOP" in criterion.words and not any(
        ACTING_WORDS.union(def_names).intersection(inside) for inside in _loop_bodies(words)
    ):
        return Finding("uses", "uses/idle")
    return None


def _words(tokens: Sequence[Token]) -> list[str]:
    return [token.text for token in tokens if token.kind in (WORD, NUMBER)]


def _def_names(words: Sequence[str]) -> list[str]:
    """Return the names that the program gives with DEF."""
    return [name for word, name in pairwise(words) if word == "DEF"]


def _uncalled_words(words: Sequence[str]) -> list[str]:
    """Return the DEFs that are called by none, or only by such a DEF."""
    words_by_def: dict[str, set[str]] = {name: set() for name in _def_names(words)}
    main_words, name = set[str](), ""
    for previous_word, word in pairwise(["", *words]):
        if previous_word == "DEF":
            name = word
        elif ALIASES.get(word, word) == BLOCK_ENDS["DEF"]:
            name = ""
        else:
            (words_by_def[name] if name else main_words).add(word)
    called_names: set[str] = set()
    newly_called = main_words & words_by_def.keys()
    while newly_called:
        called_names |= newly_called
        newly_called = (
            set().union(*(words_by_def[name_called] for name_called in newly_called))
            & words_by_def.keys() - called_names
        )
    return [body for body in words_by_def if body not in called_names]


def _loop_bodies(words: Sequence[str]) -> list[list[str]]:
    """Return the bodies of repeating LOOPs: LOOP(1) and LOOP(0) do not repeat."""
    bodies: list[list[str]] = []
    open_loops: list[list[str]] = []
    for word in words:
        if ALIASES.get(word, word) == BLOCK_ENDS["LOOP"] and open_loops:
            body = open_loops.pop()
            if body[:1] not in (["0"], ["1"]):
                bodies.append(body)
        for body in open_loops:
            body.append(word)
        if word == "LOOP":
            open_loops.append([])
    return bodies


def _judge_moves(criterion: Criterion, tokens: Sequence[Token]) -> Finding | None:
    most_moves, is_ahead = (
        int(criterion.number_by_key["at_most"]),
        bool(criterion.number_by_key["ahead"]),
    )
    move_count = (
        kept.count_ahead(tokens) if is_ahead else sum(word in MOVES for word in _words(tokens))
    )
    values = {"found": str(move_count), "most": str(most_moves)}
    return (
        Finding("moves", f"moves{'/ahead' * is_ahead}", values) if move_count > most_moves else None
    )


def replace_word(word: str, text: str) -> str:
    """Return a program whose loops are done once (LOOP), without its own words (DEF) or tasks."""
    tokens = scan(text).tokens
    def_names = _def_names(_words(tokens))
    parts, end = [], 0
    for k, token in enumerate(tokens):
        text_and_end = None
        if word == "LOOP" and token.text == "LOOP":
            text_and_end = "LOOP(1)", kept.end_of_values(tokens, k)
        elif word == "DEF" and token.text in def_names and tokens[k - 1].text != "DEF":
            text_and_end = "W(0)", token.end
        elif word in TASKS and token.text == word:
            text_and_end = "W(0)", _end_of_block(tokens, k)
        if text_and_end is not None and token.kind == WORD:
            parts += [text[end : token.start], text_and_end[0]]
            end = text_and_end[1]
    return "".join([*parts, text[end:]])


def without_times(text: str) -> str:
    """Return a program in which only its question ends each move or wait with UNTIL."""
    tokens = scan(text).tokens
    spans = kept.times_before_until(tokens)
    for start, end in reversed(spans):
        text = f"{text[:start]}FOREVER{text[end:]}"
    return text


def _end_of_block(tokens: Sequence[Token], index: int) -> int:
    ends = (token.end for token in tokens[index:]
            if ALIASES.get(token.text, token.text) == BLOCK_ENDS[tokens[index].text])  # fmt: skip
    return next(ends, tokens[-1].end)


def idle_finding(word: str, text: str) -> Finding:
    """Return the finding for a word of BLOCKS that the solution does not need."""
    def_names = _def_names(_words(scan(text).tokens))
    return Finding("needs", f"needs/{word}", {"name": def_names[0] if def_names else ""})


JUDGES: dict[str, Callable[[Criterion, Sequence[Token]], Finding | None]] = {
    "uses": _judge_words,
    "needs": _judge_words,
    "moves": _judge_moves,
}
