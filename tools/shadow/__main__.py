"""Runs the new recovery beside today's repairs, and keeps the scores, which may only rise.

`python -m tools.shadow` reads all of `tests/pupils`, the right programs and 400 with slips;
`5000` puts slips into so many. A quarter of the pupils' programs is put aside: its score is
printed, never a program of it. `--show worse` prints the others that have this mark, `--code
TS036` those of a code alone; `--keep` writes scores that rose.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.pupils.corpus import check, entries
from tests.pupils.test_damage import damaged
from tiniscript.recovery.explanation import explained
from tiniscript.repairs.fixing import fixed
from tools.shadow import marks
from tools.shadow.marks import EQUIVALENT, MARKS, QUESTION, SAME, WORSE, Answer

SCORES = Path(__file__).parent / "scores.json"
SAMPLE, SAMPLE_SIZE, SAMPLE_SEED = "sample as meant", 200, 28  # which a test reads again
Scores = dict[str, float]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Compare the new recovery with today's repairs.")
    parser.add_argument("slips", nargs="?", type=int, default=400, help="programs with slips")
    parser.add_argument("--seed", type=int, default=1, help="of the slips")
    parser.add_argument("--show", choices=MARKS, help="print the programs with this mark")
    parser.add_argument("--code", default="", help="print those with this code alone")
    parser.add_argument("--keep", action="store_true", help="write what rose")
    options = parser.parse_args(arguments)
    begun = time.monotonic()
    took: list[float] = []
    seen: list[Answer] = []
    aside: list[Answer] = []
    for entry in entries():
        start = time.process_time()
        answer = marks.answer(entry)
        took.append(time.process_time() - start)
        (aside if marks.is_aside(entry.program) else seen).append(answer)
    scores = {**of_pupils("seen", seen), **of_pupils("aside", aside)}
    scores |= of_sample(sample(seen))
    of_slips(options.slips, options.seed)
    by_code([*seen, *aside])
    if options.show:
        show(seen, options.show, options.code)
    took.sort()
    median, worst = (1000 * took[k] for k in (len(took) // 2, -1))
    print(f"median {median:.1f} ms, at worst {worst:.0f} ms; {time.monotonic() - begun:.0f} s")
    return kept(scores, options.keep)


def of_pupils(name: str, answers: Sequence[Answer]) -> Scores:
    """Print and return the scores of the programs of pupils: in percent, the higher the better."""
    repaired = [each for each in answers if each.entry.mended]
    others = [each for each in answers if not each.entry.mended]
    counts = Counter(each.mark for each in repaired)
    false = sum(each.mark == WORSE for each in others)
    told = ", ".join(f"{mark} {counts[mark]}" for mark in MARKS)
    meant = 100 * (counts[SAME] + counts[EQUIVALENT]) / len(repaired)
    read = meant + 100 * counts[QUESTION] / len(repaired)
    quiet = 100 * (1 - false / len(others))
    print(f"{name}: {len(repaired)} with a repair: {told}; as meant {meant:.1f} %, with questions")
    print(f"  {read:.1f} %; {len(others)} without one: false repairs {false}, {100 - quiet:.1f} %")
    return {f"{name} as meant": meant, f"{name} without a false repair": quiet}


def of_slips(count: int, seed: int) -> None:
    """Put slips into right programs; print how often each engine makes a right one of them."""
    chance = random.Random(seed)
    made: Counter[str] = Counter()
    tried = 0
    while tried < count:
        program = damaged(chance.randrange(1 << 40))
        if not program.strip() or marks.image(program):
            continue
        tried += 1
        found = marks.meant(program)
        new = marks.image(found.text) if found and found.is_applied else b""
        today = marks.image(fixed(program, check).text)
        made["new"] += bool(new)
        made["today"] += bool(today)
        made["other"] += bool(new and today and new != today)
    told = f"right {made['new']}, today's {made['today']}, both and not the same {made['other']}"
    print(f"{count} with slips: {told}")


def by_code(answers: Iterable[Answer]) -> None:
    """Print for each code of today's first message what became of its programs."""
    table: dict[str, Counter[str]] = {}
    for each in answers:
        counts = table.setdefault(each.code or "none", Counter())
        counts[each.mark if each.entry.mended else f"not repaired: {each.mark}"] += 1
    for code, counts in sorted(table.items(), key=lambda row: -row[1].total()):
        print(f"{code:6}", ", ".join(f"{mark} {count}" for mark, count in sorted(counts.items())))


def of_sample(answers: Sequence[Answer]) -> Scores:
    """Return the score of programs that a test reads again."""
    good = sum(each.mark in (SAME, EQUIVALENT) for each in answers)
    return {SAMPLE: 100 * good / len(answers)}


def sample(answers: Sequence[Answer]) -> list[Answer]:
    repaired = [each for each in answers if each.entry.mended]
    return random.Random(SAMPLE_SEED).sample(repaired, SAMPLE_SIZE)


def show(answers: Iterable[Answer], mark: str, code: str) -> None:
    for each in answers:
        if each.mark == mark and code in ("", each.code):
            print("-" * 80, each.entry.file, each.entry.said[:1])
            print(each.entry.program)
            print("today:", each.entry.mended)
            print("new:", each.found.text if each.found else None,
                  explained(each.found) if each.found else "")  # fmt: skip


def kept(scores: Scores, is_kept: bool) -> int:
    """Compare with the scores of before; return 1 where one fell."""
    before: Scores = json.loads(SCORES.read_text()) if SCORES.exists() else {}
    fallen = [name for name, score in scores.items() if round(score, 1) < before.get(name, 0)]
    for name in fallen:
        print(f"{name}: {scores[name]:.1f}, and was {before[name]:.1f}")
    if is_kept and not fallen:
        new = {name: round(score, 1) for name, score in scores.items()}
        SCORES.write_text(json.dumps({**before, **new}, indent=2) + "\n")
    return int(bool(fallen))


if __name__ == "__main__":
    sys.exit(main())
