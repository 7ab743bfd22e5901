"""Random programs in the page, from text and from its own blocks: the bytecode of `tsc compile`.

`python -m tests.studio.random_in_page 1000 --seed 0` takes so many.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from typing import TYPE_CHECKING, Any

from tests.oracle import interpreter as oracle
from tests.oracle import programs as oracle_programs
from tests.support import studio
from tests.support.studio import Pages
from tiniscript import ProgramError, compile
from tiniscript.studio.serving import files

if TYPE_CHECKING:
    from playwright.sync_api import Page

# The blocks of the page, made of forms and read again, without the page around them.
ROUND_TRIP_SCRIPT = """async ({name, forms}) => {
  const {Blocks} = await import(new URL(name, location.href).href);
  const place = document.createElement('div');
  place.hidden = true;  // nothing is measured
  document.body.append(place);
  const blocks = new Blocks(place, 'tinibot', 'all', {onChange() {}});
  const found = forms.map((form) => { blocks.show(form); return blocks.readForm().form; });
  place.remove();
  return found;
}"""


def compile_to_hex(text: str) -> str:
    try:
        return compile(text, "tinibot").image.hex()
    except ProgramError:
        return ""


def images(page: Page, texts: list[str]) -> list[str]:
    """Return the images of the page's compiler for texts; empty for wrong ones."""
    request = {"do": "check", "robot": "tinibot", "language": "en"}
    requests = [{**request, "text": text} for text in texts]
    return [answer["image"] for answer in studio.ask_worker(page, requests)]


def without_places(form: Any) -> Any:
    if isinstance(form, list):
        return [without_places(node) for node in form]
    if isinstance(form, dict):
        return {key: without_places(value) for key, value in form.items() if key != "place"}
    return form


def round_trip(page: Page, forms: list[Any]) -> list[Any]:
    """Return forms as the page's blocks have them, made of these."""
    (name,) = [name for name in files() if name.startswith("blocks-")]
    forms_back: list[Any] = page.evaluate(ROUND_TRIP_SCRIPT, {"name": name, "forms": forms})
    return forms_back


def texts_through_blocks(page: Page, texts: list[str]) -> list[str]:
    """Return the texts that the page makes of its blocks of texts."""
    requests = [{"do": "blocks", "robot": "tinibot", "text": text} for text in texts]
    forms = studio.ask_worker(page, requests)
    for form in forms:
        del form["size"]
    seen_forms = round_trip(page, without_places(forms))
    answers = studio.ask_worker(page, [{"do": "text", "form": form} for form in seen_forms])
    return [answer["text"] for answer in answers]


def compare(page: Page, count: int, seed: int) -> int:
    """Compare so many programs; return how many were right ones."""
    texts = [
        oracle_programs.program(random.Random(seed + k), oracle.PAPER_KIT) for k in range(count)
    ]
    expected_images = [compile_to_hex(text) for text in texts]
    from_blocks = images(page, texts_through_blocks(page, texts))
    rows = zip(texts, expected_images, images(page, texts), from_blocks, strict=True)
    for k, (text, image, from_text, from_block) in enumerate(rows):
        assert from_text == image, f"seed {seed + k}, from its text:\n{text}"
        assert from_block == image, f"seed {seed + k}, from its blocks:\n{text}"
    return sum(bool(image) for image in expected_images)


def main() -> int:
    parser = argparse.ArgumentParser(description="Compile random programs in the studio's page.")
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    start_s = time.monotonic()
    with (
        studio.driver() as driver,
        studio.browser(driver) as browser,
        studio.serve_page() as server,
    ):
        pages = Pages(browser, server.address, patience_s=300)
        page = pages.open()
        right_count = sum(
            compare(page, min(100, options.count - start), options.seed + start)
            for start in range(0, options.count, 100)
        )
        assert not pages.errors, pages.errors[:3]
        pages.close()
    seconds = time.monotonic() - start_s
    print(
        f"{options.count} programs, {right_count} right: from text and from blocks"
        f" the image of tsc compile: {seconds:.0f} s"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
