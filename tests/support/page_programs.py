"""Programs on the page: kept, shared, opened."""

from __future__ import annotations

import base64
import json
import zlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from playwright.sync_api import Page


def content(page: Page) -> str:
    return str(page.locator(".cm-content").inner_text())


def unfold(page: Page) -> None:
    """Show how a program is shared."""
    if not page.locator("#share[open]").count():
        page.click("#share summary")
    page.locator("#programs[data-shared]:not([data-shared=asked])").wait_for()


def share(page: Page, kind: str = "link") -> str:
    """Open the window if necessary, and return the shared link."""
    if not page.locator("#programs").is_visible():
        page.click("#my_programs")
    unfold(page)
    page.click(f"#share_{kind}")
    page.locator("#programs:not([data-shared=asked])").wait_for()
    return str(page.input_value("#shared"))


def list_programs(page: Page) -> list[str]:
    """Return the names of earlier programs."""
    return page.locator("#versions li:not(:has(#new)) strong").all_inner_texts()


def pack(content: bytes) -> str:
    compress = zlib.compressobj(9, zlib.DEFLATED, -15)
    compressed_data = compress.compress(content) + compress.flush()
    return base64.urlsafe_b64encode(compressed_data).decode().rstrip("=")


def as_json(content: Any) -> str:
    return pack(json.dumps(content).encode())


GOOD_WORK = as_json({"text": "SI|F(9, 90)", "robot": "tinibot"})
COLOURS_SCRIPT = """async (letters) => {
  const image = await createImageBitmap(new Blob([Uint8Array.from(atob(letters), (c) => c.charCodeAt(0))]));
  const sheet = document.createElement('canvas');
  Object.assign(sheet, { width: image.width, height: image.height });
  const pen = sheet.getContext('2d');
  pen.drawImage(image, 0, 0);
  const { data } = pen.getImageData(0, 0, image.width, image.height);
  const counts = {};
  for (let k = 0; k < data.length; k += 4) {
    const colour = data.slice(k, k + 3).join();
    counts[colour] = (counts[colour] ?? 0) + 1;
  }
  return [image.width, image.height, counts];
}"""


def colours(page: Page, data: bytes) -> tuple[int, int, dict[str, int]]:
    assert data.startswith(b"\x89PNG\r\n")
    width, height, counts = page.evaluate(COLOURS_SCRIPT, base64.b64encode(data).decode())
    return width, height, counts


MOVE_COLOUR = "11,79,158"  # the colour of blocks that move, as blocks/colours.js has it
