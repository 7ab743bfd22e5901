"""An ESP32 gets its firmware from the page: its own code in node, onto the simulated ROM.

And the page itself, if there is such firmware; a page without any never offers it.
"""

from __future__ import annotations

import base64
import hashlib
import json
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from tests.support import studio
from tests.support.needs import need
from tests.support.node import in_node
from tests.support.studio import axe, enter
from tests.support.waiting import until
from tiniscript.flash import ready
from tiniscript.studio import serving
from tiniscript.studio.building import MODULES

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

TEST_FOLDER = Path(__file__).parent
ROM = TEST_FOLDER / "esp32_rom.js"
HEADS = {"esp32dev": (0x1000, 0), "esp32c3": (0, 5)}


def image(board: str, size: int = 70_001) -> bytes:
    """Return a whole firmware: compressible and random parts, with the headers in place."""
    head, chip = HEADS[board]
    data = bytearray(b"\xff" * head + Random(1).randbytes(9000) + bytes(size))[:size]
    data[head], data[head + 12] = 0xE9, chip
    data[head + 13 : head + 17] = b"\xc0\xdb\xdc\xdd"  # bytes that SLIP must escape
    return bytes(data)


def flash(board: str, firmware: bytes, **options: Any) -> dict[str, Any]:
    need("" if (MODULES / "esptool-js").is_dir() else "esptool-js is not fetched")
    case = {"board": board, "firmware": base64.b64encode(firmware).decode(), **options}
    lines = in_node(TEST_FOLDER / "flash_esp32_in_node.mjs", str(ROM), input_text=json.dumps(case))
    outcome: dict[str, Any] = json.loads(lines[-1])
    assert outcome["sums"]
    assert not outcome["is_open"]  # the next one can have the port
    return outcome


@pytest.mark.parametrize("board", ["esp32dev", "esp32c3"])
def test_a_new_board_gets_the_whole_firmware_and_starts_it(board: str) -> None:
    chip = {"esp32dev": "esp32", "esp32c3": "esp32c3"}[board]
    outcome = flash(board, image(board), chip=chip)
    assert (outcome["ended"], outcome["is_there"], outcome["starts"], outcome["seen"]) == (
        "done",
        True,
        1,
        1,
    )
    assert {op for op, _ in outcome["refused"]} <= {0}  # only unknown commands are refused


@pytest.mark.parametrize(
    ("options", "ended_text"),
    [
        ({"isDeaf": True}, "flash_nobody_esp"),
        ({"chip": "esp32c3"}, "flash_other_esp"),
        ({"chip": "esp8266"}, "flash_other_esp"),
        ({"cancelAt": -1}, "flash_not_begun"),
        ({"heldUntil": "end"}, "flash_held"),
        ({"heldUntil": "cancel"}, "flash_not_begun"),
    ],
)
def test_a_different_board_is_not_changed(options: dict[str, Any], ended_text: str) -> None:
    outcome = flash("esp32dev", image("esp32dev", 20_000), **options)
    assert (outcome["ended"], outcome["is_untouched"]) == (ended_text, True)


@pytest.mark.sampled("options", "ended_text")
@pytest.mark.parametrize(
    ("options", "ended_text"),
    [
        ({"breaksAt": 3}, "flash_broken_off"),
        ({"cancelAt": 0.3}, "flash_cancelled"),
        ({"spoils": True}, "flash_differs"),
    ],
)
def test_a_partial_firmware_is_never_reported_as_complete(
    options: dict[str, Any], ended_text: str
) -> None:
    assert flash("esp32dev", image("esp32dev", 20_000), **options)["ended"] == ended_text


def test_firmware_of_another_board_is_not_written() -> None:
    firmware = image("esp32dev", 20_000)
    for board, data in (
        ("esp32dev", firmware[0x1000:]),  # the image alone, without the part before it
        ("esp32dev", b":00000001FF\n"),
        ("esp32dev", firmware + bytes(0x400000)),
        ("esp32c3", firmware),
        ("esp32c3", b"\xe9" + bytes(11) + b"\0" + bytes(99)),  # firmware for another chip
    ):
        outcome = flash(board, data)
        assert (outcome["ended"], outcome["is_untouched"]) == ("flash_bad_image", True)


# A browser's ports, one of them with the ROM; Python decompresses and computes checksums for it.
PORT = """
window.rom = new globalThis.Esp32Rom({
  sum: (data) => window.summed([...data]),
  inflate: async (data) => Uint8Array.from(await window.unpacked([...data])),
});
Object.defineProperty(navigator, 'serial', {value: {
  getPorts: async () => [], requestPort: async () => window.rom,
}});
"""


@contextmanager
def teacher_page(browser: Browser, folder: Path) -> Iterator[Page]:
    """Return a page next to the firmware of a folder, opened where a teacher finds it."""
    need(studio.missing())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ready.files, "__defaults__", (folder,))
        patch.setattr(ready.images, "__defaults__", (folder,))
        page = serving.with_firmware(serving.files())
    context = browser.new_context(viewport={"width": 1366, "height": 768}, locale="en-US")
    context.expose_function("summed", lambda data: hashlib.md5(bytes(data)).hexdigest())
    context.expose_function("unpacked", lambda data: list(zlib.decompress(bytes(data))))
    context.add_init_script(ROM.read_text(encoding="utf-8") + PORT)
    try:
        with studio.serve_page(page) as server:
            opened_page = context.new_page()
            enter(opened_page, server.address)
            opened_page.click("#side_real")
            opened_page.click("#link_teacher summary")
            yield opened_page
    finally:
        context.close()


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_a_page_without_firmware_does_not_offer_it(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "tinibot32-esp32dev-digest.bin").write_bytes(b"nothing")
    with teacher_page(browser, tmp_path) as page:
        page.locator("#keys_import").wait_for()
        page.wait_for_load_state("networkidle")
        assert not page.locator("#flash").is_visible()
        assert axe(page) == []


def test_a_teacher_puts_the_firmware_on_an_esp32(browser: Browser, tmp_path: Path) -> None:
    firmware = image("esp32dev", 12_000)
    (tmp_path / "tinibot32-esp32dev-digest.bin").write_bytes(firmware)
    with teacher_page(browser, tmp_path) as page:
        page.locator("#flash_write").wait_for()
        assert page.locator("#flash_board option").all_inner_texts() == ["ESP32"]
        page.click("#flash_write")
        page.get_by_text("There is no firmware here for this robot on this board.").wait_for()
        page.select_option("#robot", "tinibot32")
        page.click("#flash_write")
        page.get_by_text("Connecting").first.wait_for()
        until(lambda: page.evaluate("window.rom.starts") == 1, "it starts")
        assert page.evaluate(f"[...window.rom.flash.subarray(0, {len(firmware)})]") == list(
            firmware
        )
        page.get_by_text("Nothing responds.").wait_for()  # the simulated chip is no robot
