"""The link on a bad line: bytes lost, changed, doubled, swapped, put in, and radios that drop out.

`python -m tests.link.test_link_channel 10000` plays more uploads than the tests. Everything is
drawn from a seed. `test_damaged_frames` tests only receivers, with many more frames.
"""

from __future__ import annotations

import random
from collections import Counter
from functools import partial

import pytest

from tests.machines.link import CppLink, cpp_link, link_library
from tests.support.campaign import each_seed, make_options
from tests.support.link_channel import World, program, run_upload_scenario
from tiniscript.bytecode.image import pack, unpack

UNDOS = 100

# -- damage ---------------------------------------------------------------------------------------


# -- a radio --------------------------------------------------------------------------------------


class SplitWorld(World):
    """Radios that send pieces."""

    is_split = True


@pytest.mark.sampled("is_large", "count", "min_share")
@pytest.mark.parametrize(("is_large", "count", "min_share"), [(False, 300, 0.9), (True, 100, 0.85)])
def test_uploads_survive_a_bad_radio(is_large: bool, count: int, min_share: float) -> None:
    """No upload falsely reports success, and none is done twice.

    Several large frames are under way; some arrive twice or out of order.
    """
    counts = Counter(run_upload_scenario(cpp_link(is_large), seed) for seed in range(count))
    assert counts["done"] > count * min_share, counts


@pytest.mark.sampled("is_large", "count", "min_share")
@pytest.mark.parametrize(("is_large", "count", "min_share"), [(False, 150, 0.85), (True, 50, 0.6)])
def test_uploads_in_pieces_survive_a_bad_radio(
    is_large: bool, count: int, min_share: float
) -> None:
    """After a second of silence the rest of a frame is text; the frame comes again."""
    counts = Counter(
        run_upload_scenario(cpp_link(is_large), seed, SplitWorld) for seed in range(count)
    )
    assert counts["done"] > count * min_share, counts


def undo_repeatedly(cpp: CppLink, seed: int) -> str:
    """Bring the program before back several times; return how many were confirmed."""
    rng = random.Random(seed)
    world = World(cpp, rng, 0, 0)
    images = [pack("SI", 0, program(rng)) for _ in range(2)]
    for image in images:
        request = world.session.upload(unpack(image), runs=False)
        world.run(request)
    if images[0] == images[1]:
        return "the same"
    world.to_robot.faults = world.to_computer.faults = rng.choice((0.001, 0.01, 0.03))
    world.drop_rate = rng.choice((0, 0.0002, 0.002))
    confirmed_count = 0
    for _ in range(4):
        old_undo_count = world.did.count(f"UNDO {unpack(images[0]).checksum:08x}")
        pending_request = world.session.undo()
        world.run(pending_request)
        assert pending_request.outcome, f"seed {seed}: an undo has no end"
        undo_count = world.did.count(f"UNDO {unpack(images[0]).checksum:08x}") - old_undo_count
        assert undo_count <= 1, f"seed {seed}: undone {undo_count} times"
        if pending_request.outcome.status == 0:
            assert undo_count == 1, (
                f"seed {seed}: the computer says undone, the robot has done nothing"
            )
            confirmed_count += 1
        if undo_count:
            images.reverse()
        assert cpp.fetch_image() == images[1], f"seed {seed}: the robot holds another program"
    return f"{confirmed_count} confirmed"


def test_undos_survive_a_bad_radio() -> None:
    """No undo is done twice, however often its answer is lost."""
    counts = Counter(undo_repeatedly(cpp_link(), seed) for seed in range(UNDOS))
    assert counts["4 confirmed"] > UNDOS * 0.8, counts


if __name__ == "__main__":
    options = make_options(10_000, 1_000_000, "large", "undos", "pieces")
    one = (
        undo_repeatedly
        if options.undos
        else partial(run_upload_scenario, world_of=SplitWorld if options.pieces else World)
    )
    each_seed(partial(one, link_library(options.large)), options)
