"""What holds of images in C++: each check asks one process, and compares with Python."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

from tests.machines import Senses
from tests.machines.host import Process
from tests.support.random_codes import changed_kit, images_of_programs, random_images
from tiniscript.bytecode.image import (
    EVERYTHING,
    HEADER_BYTES,
    REFUSALS,
    ImageRefused,
    pack,
    sealed,
    unpack,
)
from tiniscript.bytecode.verify import Refused, loaded


def python_refusal(data: bytes, has: int = EVERYTHING) -> int:
    try:
        unpack(data, has)
    except ImageRefused as refused:
        return refused.number
    return 0


def short_headers() -> Iterator[bytes]:
    """Yield images whose headers are too short by each number of bytes, with all else in order."""
    whole = pack("SI", 0, b"")
    for length in range(HEADER_BYTES):
        yield sealed(whole[:5] + bytes([length]) + whole[6:])


def check_images(machine: Process, seed: int, count: int, has: int = EVERYTHING) -> None:
    """Headers are refused for the same reasons, and each for some image."""
    images = [*random_images(seed, count), b"", b"T", b"TS", b"S", b"TX", *short_headers()]
    theirs = machine.refusals(images)
    for image, reason in zip(images, theirs, strict=True):
        ours = python_refusal(image, has)
        assert ours == reason, f"{image.hex(' ')}: {ours}, not {reason}"
    headers = {number for name, (number, _) in REFUSALS.items() if name != "OTHER_KIT"}
    assert {*theirs} == {0, *headers}


def refusal_of(load: Callable[[], object]) -> str:
    """Return why an image is refused with its offset, or nothing."""
    try:
        load()
    except (ImageRefused, Refused) as refused:
        return f"{refused.number} {refused}"
    return ""


def check_whole_images(machine: Process, seed: int, count: int, has: int = EVERYTHING) -> None:
    """Programs with a change in them, for robots of which some have other devices."""
    rng = random.Random(seed)
    senses = Senses(max_ms=100, max_steps=20)
    seen = set()
    for image, kit in images_of_programs(seed, count):
        for robot in (kit, changed_kit(rng, kit)):
            ours = refusal_of(lambda data=image, kit=robot: loaded(data, kit, has))  # type: ignore[misc]
            theirs = refusal_of(lambda data=image, kit=robot: machine.run(data, kit, senses))  # type: ignore[misc]
            assert ours == theirs, f"{image.hex(' ')}: {ours!r}, not {theirs!r}"
            seen.add(ours.partition(" ")[2].partition(" ")[0])
    assert {"", "OTHER_KIT", "NO_SUCH_DEVICE", "OTHER_VERSION", "DAMAGED"} <= seen, seen
