"""A new board becomes a robot from the page: the browser's own Web Serial, and a simulated Uno."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.machines.bootloaders import bootloader
from tests.machines.uno import skip_unless_available
from tests.support import studio, studio_serial
from tests.support.flashed_boards import new_board, to_hex
from tests.support.page_link import wait_for_message
from tests.support.platformio import firmware, shared_folder
from tests.support.studio import enter
from tests.support.waiting import until
from tiniscript.studio import serving

if TYPE_CHECKING:
    from playwright.sync_api import Playwright

pytestmark = pytest.mark.root


def test_a_new_board_becomes_a_robot(
    playwright: Playwright, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    reason = studio_serial.missing()
    # Skipped in CI too, without root or a serial port; tests/studio/test_flashing.py covers it.
    if reason:
        pytest.skip(reason)
    skip_unless_available()
    file = tmp_path / "tinibot-uno-digest.hex"
    to_hex(firmware("uno", tmp_path, shared_folder(tmp_path_factory)), file)
    rows = [{"title": "tinibot", "board": "uno", "file": file.name}]
    page = {
        **serving.files(),
        serving.FIRMWARE_FILE: serving.File(json.dumps(rows).encode(), "application/json"),
        file.name: serving.File(file.read_bytes(), "text/plain"),
    }
    with (
        studio.serve_page(page) as server,
        new_board(bootloader("uno")) as uno,
        studio_serial.context(playwright, tmp_path, uno.pty, server.address) as context,
    ):
        first_page = context.pages[0]
        first_page.set_default_timeout(120_000)
        enter(first_page, server.address)
        first_page.click("#side_real")
        first_page.locator("#link_port option").first.wait_for(state="attached")
        first_page.click("#link_teacher summary")
        # There is no firmware for other robots here, and no other file is written.
        first_page.select_option("#robot", "liner")
        first_page.click("#flash_write")
        wait_for_message(first_page, "There is no firmware here for this robot on this board.")
        first_page.select_option("#robot", "tinibot")
        first_page.set_input_files(
            "#flash_file", {"name": "<b>.hex", "mimeType": "", "buffer": b":00"}
        )
        wait_for_message(first_page, "<b>.hex is ready")
        first_page.click("#flash_write")
        wait_for_message(first_page, "That is not a complete HEX file")
        assert first_page.locator("#flash_board option").all_inner_texts() == ["Uno"]
        # If cancelled in the middle, it does nothing, and is whole once it has its firmware again.
        first_page.click("#flash_write")
        progress = "document.querySelector('#flash_progress').value"  # the page evaluates no text
        until(lambda: float(first_page.evaluate(progress)) >= 0.1, "a tenth is written")
        first_page.click("#flash_cancel")
        wait_for_message(first_page, "Cancelled halfway ")
        assert (
            first_page.locator("#flash_cancel, #flash_progress").filter(visible=True).count() == 0
        )
        first_page.click("#flash_write")
        wait_for_message(first_page, "Connected: ")
