"""However pages edit one program, in any network, all end with the same text: the one typed.

Pages write with blocks and with the keyboard, undo, cut, paste and give up; messages take up to
five seconds, are lost, come twice; pages are away for up to a minute and are loaded again; the
class's computer goes on from its journal. At every check, the program parses, agrees with its
blocks and its compiled form, has only typed values, no duplicates, and lacks only deleted parts.

`python -m tests.together.test_histories 10000` has 10,000 deeds; `--lessons` has pupils that work
near each other, at ordinary speed, and prints how many changes are refused.
"""

from __future__ import annotations

from collections import Counter

import pytest

from tests.support.campaign import make_options
from tests.together.world import World

EDIT_COUNT = 120  # of a history
EDITS_PER_COMPARISON = 40  # deeds between two looks at the whole program
LESSON_S = 300.0
MAX_REFUSED = 0.01


def history(seed: int, deeds: int, pages: int) -> World:
    """Play so many deeds; all that must be true is asserted."""
    world = World(pages, seed)
    rng, change_count = world.rng, 0

    def act(name: str) -> None:
        nonlocal change_count
        pupil = world.pupils[name]
        pupil.act()
        if not pupil.stages:
            change_count += 1
            if change_count % EDITS_PER_COMPARISON == 0:
                world.check()
        drafts = len(pupil.page.drafts)
        if drafts > 2 or (drafts and not pupil.stages and rng.random() < 0.1):
            pupil.drop()
        world.schedule(rng.uniform(0.5, 5), act, name)

    def make_trouble(name: str) -> None:
        if rng.random() < 0.6:
            world.off_until_s[name] = world.now_s + rng.uniform(5, 60)
            world.counts["breaks"] += 1
        else:
            world.reload(name)
            world.counts["reloads"] += 1
        world.schedule(rng.uniform(20, 200), make_trouble, name)

    def crash() -> None:
        world.crash()
        world.schedule(rng.uniform(100, 900), crash)

    for name in world.pupils:
        world.schedule(rng.uniform(0, 3), act, name)
        world.schedule(rng.uniform(20, 200), make_trouble, name)
        world.ask(name, 0)
    world.schedule(rng.uniform(30, 300), crash)
    world.run(lambda: change_count >= deeds)
    world.settle()
    world.check()
    world.check_pages()
    world.check_nothing_is_lost()
    assert not world.counts["astray"]
    return world


def lesson(seed: int, pages: int, lesson_s: float = LESSON_S) -> World:
    """Play pupils of a class who each make a change every three seconds, within a few lines."""
    world = World(pages, seed, lambda rng: rng.uniform(0.03, 0.12), 0.0, 0.05, spread=0.0)
    rng = world.rng

    def act(name: str) -> None:
        pupil = world.pupils[name]
        is_typing = bool(pupil.stages)
        if not is_typing:
            lines = max(1, len(pupil.page.lines))
            pupil.focus = max(0.0, min(lines - 1.0, rng.gauss(0.4 * lines, 3.0))) / lines
        if is_typing:
            while pupil.stages:
                pupil.type()
        elif rng.random() < 0.35:
            pupil.edit_blocks()
        else:
            pupil.type()
        if pupil.page.drafts and not pupil.stages:
            pupil.page.give_up()
        pause_s = rng.gauss(1.5, 0.5) if pupil.stages or is_typing else rng.gauss(3.0, 1.0)
        world.schedule(max(0.5, pause_s), act, name)

    for name in world.pupils:
        world.schedule(rng.uniform(0, 3), act, name)
        world.ask(name, 0)
    world.run(lambda: world.now_s > lesson_s)
    world.settle()
    world.check()
    world.check_pages()
    world.check_nothing_is_lost()
    return world


@pytest.mark.sampled("seed", keep=3)
@pytest.mark.parametrize("seed", range(30))
def test_all_pages_end_with_the_same_program(seed: int) -> None:
    history(seed, EDIT_COUNT, 2 + seed % 3)


@pytest.mark.long
def test_pupils_typing_at_normal_speed_are_seldom_refused() -> None:
    change_count, refused_count = _counts([lesson(seed, 3) for seed in range(3)])
    assert change_count > 300
    assert refused_count <= MAX_REFUSED * change_count, f"{refused_count} of {change_count}"


def _counts(worlds: list[World]) -> tuple[int, int]:
    change_count = sum(
        pupil.page.change_count for world in worlds for pupil in world.pupils.values()
    )
    return change_count, sum(sum(world.refusals_by_reason.values()) for world in worlds)


def _print_counts(worlds: list[World]) -> None:
    change_count, refused_count = _counts(worlds)
    unseen = sum(world.replaced_unseen for world in worlds)
    refusals = sum((world.refusals_by_reason for world in worlds), Counter[str]())
    action_counts = sum((world.counts for world in worlds), Counter[str]())
    percent = 100 * refused_count / change_count
    print(
        f"{change_count} changes, refused {refused_count} ({percent:.2f} %) {dict(refusals)}, "
        f"values replaced that their page had not seen: {unseen}"
    )
    print(dict(action_counts))


if __name__ == "__main__":
    options = make_options(10_000, 0, "lessons")
    if options.lessons:
        for pages in (2, 3, 4):
            _print_counts(
                [lesson(seed, pages, 600) for seed in range(options.seed, options.seed + 3)]
            )
    else:
        per_part = 1000
        _print_counts([history(options.seed + k, min(per_part, options.count - k * per_part), 4)
                       for k in range(-(-options.count // per_part))])  # fmt: skip
