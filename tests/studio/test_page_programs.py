"""The window with a person's programs: links, lines, their QR codes, and earlier programs."""

from __future__ import annotations

import base64
import json
import random
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.studio.programs import programs
from tests.support.page_programs import (
    GOOD_WORK,
    MOVE_COLOUR,
    as_json,
    colours,
    content,
    list_programs,
    pack,
    share,
    unfold,
)
from tests.support.rows import each_row
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    ask_worker,
    axe,
    image,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import check, compile
from tiniscript.studio.building import MODULES
from tiniscript.studio.checking import line_for_robot
from tools.builds.studio import find_tools

if TYPE_CHECKING:
    from playwright.sync_api import Page

sampled = pytest.mark.sampled(of="details of programs", keep=2)

TEXT = "// ñandú 🤖 </script>\nSI|LOOP(2);\n  F(1, 80);\nEND_LOOP\n"


def test_a_link_opens_the_program_without_running_it(pages: Pages, page: Page) -> None:
    page.select_option("#robot", "grabber")
    write(page, TEXT)
    expected_bytes = image(page)
    link = share(page)
    assert link.startswith(pages.address + "#program=")
    assert "works only on this computer. To share with others" in page.inner_text("#shared_told")
    page.keyboard.press("Escape")
    page.select_option("#robot", "tinibot")
    write(page, "SI|F(9, 90)")
    page.goto(link)  # in an open tab, only the part after # changes
    wait_for_note(page, "This program came from a link.")
    wait_until_checked(page)
    assert content(page).rstrip() == TEXT.rstrip()
    assert (page.input_value("#robot"), image(page)) == ("grabber", expected_bytes)
    assert page.evaluate("document.documentElement.dataset.phase") == "off"
    assert page.evaluate("location.hash") == "#editor"
    page.click("#my_programs")
    assert "SI|F(9, 90)" in list_programs(page)
    page.keyboard.press("Escape")
    visitor = pages.visit(link)  # in a new tab
    wait_for_note(visitor, "This program came from a link.")
    wait_until_checked(visitor)
    assert image(visitor) == expected_bytes
    visitor.reload()  # the program is kept from here on
    wait_until_checked(visitor)
    assert image(visitor) == expected_bytes


ADDRESSES_BY_REACH = {
    "here": "http://127.0.0.1:7070/ http://localhost:7070/ http://[::1]:7070/ http://a.localhost/",
    "network": "http://192.168.1.7:7070/ http://10.0.0.2/ http://172.16.9.1/ http://172.31.0.1/"
    " http://169.254.3.4/ http://teacher.local:7070/ http://teacher/ http://[fe80::1]/",
    "anywhere": "https://studio.example/ https://192.0.2.7/ http://172.32.0.1/ http://[2001:db8::1]/"
    " https://localhost.example/ https://10.example/ https://127.example/",
}


@sampled
def test_a_program_can_be_named(page: Page) -> None:
    write(page, "SI|F(1, 33)")
    page.click("#my_programs")
    page.fill("#program_name", ' my/ <b>dance: "2" ')
    assert list_programs(page)[0] == "my bdance 2"
    page.click("#programs_close")
    with page.expect_download() as download:
        page.click("#save")
    assert download.value.suggested_filename == "my bdance 2.ts"
    page.click("#my_programs")
    assert page.input_value("#program_name") == "my bdance 2"
    page.fill("#program_name", "..ñandú 🤖.ts")
    assert list_programs(page)[0] == "ñandú 🤖"
    page.fill("#program_name", "  ")
    assert list_programs(page)[0] == "SI|F(1, 33)"
    page.click("#programs_close")
    write(page, "SI|S //" + 99 * "🤖")
    page.click("#my_programs")
    assert list_programs(page)[0] == "SI|S //" + 53 * "🤖" + "…"
    page.click("#programs_close")


@sampled
def test_a_link_has_the_public_address_of_the_page(page: Page) -> None:
    write(page, "SI|F(1, 34)")
    share(page)
    for address, note in (("https://school.example/studio/", "sees the program on the page at"),
                          ("http://192.168.1.9:8000/", "on this network")):  # fmt: skip
        page.fill("#public", address)
        page.locator("#public").blur()
        page.locator("#shared_told", has_text=note).wait_for()
        assert page.input_value("#shared").startswith(address + "#program=")
    page.fill("#public", "javascript:alert(1)")
    page.locator("#public").blur()
    page.locator("#programs[data-shared=wrong]").wait_for()
    assert "must begin with https://" in page.inner_text("#shared_told")
    page.fill("#public", "")
    page.locator("#public").blur()
    page.locator("#shared_told", has_text="only on this computer").wait_for()
    page.click("#programs_close")


def test_a_link_states_where_it_can_be_opened() -> None:
    addresses = [word for row in ADDRESSES_BY_REACH.values() for word in row.split()]
    code = f"import {{ reachOf }} from './src/programs/reach.js';\n{json.dumps(addresses)}"
    completed = subprocess.run(
        [*find_tools().node, "--input-type=module", "-e",
         f"{code}.forEach((each) => console.log(reachOf(each)));"],
        cwd=MODULES.parent, capture_output=True, text=True, check=True,
    )  # fmt: skip
    expected_texts = [name for name, row in ADDRESSES_BY_REACH.items() for _ in row.split()]
    assert dict(zip(addresses, completed.stdout.split(), strict=True)) == dict(
        zip(addresses, expected_texts, strict=True)
    )


WRONG_LINKS = {
    "nothing": "",
    "no letters": "<img src=x onerror=alert(1)>",
    "cut": GOOD_WORK[:-8],
    "not deflated": base64.urlsafe_b64encode(b'{"text": "S"}').decode().rstrip("="),
    "no JSON": pack(b"SI|F(9, 90)"),
    "no UTF-8": pack(b'{"text": "\xff", "robot": "tinibot"}'),
    "null": as_json(None),
    "a list": as_json(["S", "tinibot"]),
    "no text": as_json({"robot": "tinibot"}),
    "a number": as_json({"text": 9, "robot": "tinibot"}),
    "another robot": as_json({"text": "S", "robot": "__proto__"}),
    "a bomb": as_json({"text": "S" * 20_000_000, "robot": "tinibot"}),
    "long": "A" * 50_000,
}


@sampled
@each_row("name", WRONG_LINKS)
def test_a_wrong_link_leaves_the_program_unchanged(page: Page, name: str) -> None:
    write(page, "SI|F(4, 80)")
    image_before = image(page)
    page.evaluate("document.querySelector('#note').textContent = ''")
    page.evaluate("packed => { location.hash = '#program=' + packed; }", WRONG_LINKS[name])
    wait_for_note(page, "The link is incomplete")
    wait_until_checked(page)
    assert (content(page), image(page)) == ("SI|F(4, 80)", image_before)
    assert page.evaluate("location.hash") == "#editor"
    assert page.locator("img").count() == 0


@sampled
def test_an_unshareable_program_gives_the_reason(page: Page) -> None:
    """A program that is too long for a link, one that the robot cannot read in a line, a wrong one,
    and one that is too long for a picture of a line."""
    rng = random.Random(1)
    # Text that cannot be compressed.
    noise = "".join(f"// {rng.randbytes(40).hex()}\n" for _ in range(200))
    write(page, noise)
    assert share(page) == ""
    assert "too long for a link" in page.inner_text("#shared_told")
    assert not page.locator("#shared_picture, #shared, #copy").filter(visible=True).count()
    page.keyboard.press("Escape")
    write(page, "DEF TURN\nR(1, 60)\nEND_DEF\nTURN")
    assert share(page, "line") == ""
    assert "uno" in page.inner_text("#shared_told") and "DEF" in page.inner_text("#shared_told")
    page.click("#programs_close")
    write(page, "F(2")
    assert share(page, "line") == ""
    assert check("F(2")[0].message in page.inner_text("#shared_told")
    page.keyboard.press("Escape")
    page.select_option("#robot", "tinibot32")  # its memory can hold such names
    write(page, "SI|" + "".join(f"{letter * 190}=1;" for letter in "BCDEG"))
    assert len(share(page, "line")) > 900
    assert page.locator("#shared_picture").is_hidden()
    assert "too long for a QR code" in page.inner_text("#shared_told")
    page.keyboard.press("Escape")


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(4))
def test_every_line_matches_the_command(page: Page, part: int) -> None:
    sample = programs()[part::4]
    requests = [
        {"text": program.text, "robot": program.robot, "language": "es"} for program in sample
    ]
    refused_count = 0
    for program, answer in zip(
        sample, ask_worker(page, [{"do": "line", **request} for request in requests]), strict=True
    ):
        expected = line_for_robot(program.text.encode(), program.robot, "es")
        if isinstance(expected, str):
            assert answer == {"text": expected}, program.name
        else:
            refused_count += 1
            reason = {name: getattr(expected, name) for name in ("message", "fix", "code")}
            assert answer == reason, program.name
    assert 0 < refused_count < len(sample)


# Reads the modules of the code as a camera would see them: another package than the one that draws.
READ_CODE_SCRIPT = """
import decodeQR from 'qr/decode.js';
let whole = '';
for await (const part of process.stdin) whole += part;
const { width, height, data } = JSON.parse(whole);
process.stdout.write(decodeQR({ width, height, data: Uint8ClampedArray.from(data) }));
"""
PIXELS_SCRIPT = """() => {
  const code = document.querySelector('#shared_picture');
  const large = document.createElement('canvas');
  large.width = code.width * 4; large.height = code.height * 4;
  const pen = large.getContext('2d');
  pen.imageSmoothingEnabled = false;
  pen.drawImage(code, 0, 0, large.width, large.height);
  const { width, height, data } = pen.getImageData(0, 0, large.width, large.height);
  return JSON.stringify({ width, height, data: [...data] });
}"""


def read_picture(page: Page) -> str:
    completed = subprocess.run(
        [*find_tools().node, "--input-type=module", "-e", READ_CODE_SCRIPT],
        cwd=MODULES.parent,
        input=str(page.evaluate(PIXELS_SCRIPT)),
        capture_output=True,
        text=True,
        check=True,
    )
    return str(completed.stdout)


@sampled
def test_the_pictures_contain_the_shared_program(page: Page) -> None:
    """A phone cannot open an address that only this computer has, so such a link gets no
    picture."""
    write(page, TEXT)
    assert share(page, "link") and page.locator("#shared_picture").is_hidden()
    assert "QR" not in page.inner_text("#shared_told")
    page.fill("#public", "https://school.example/studio/")
    page.locator("#public").blur()
    page.locator("#shared_picture").wait_for()
    for share_kind in ("link", "line"):
        shared_text = share(page, share_kind)
        assert read_picture(page) == shared_text != ""
    page.fill("#public", "")
    page.locator("#public").blur()
    page.keyboard.press("Escape")


@sampled
def test_the_window_opens_on_programs(page: Page) -> None:
    """Each with a picture, a large plus before them, and how one is shared is folded away."""
    page.evaluate("localStorage.removeItem('tiniscript.versions')")
    for text in ("SI|F(1, 12)", "SI|LOOP(2); S; END_LOOP"):
        write(page, text)
        page.click("#my_programs")
        page.keyboard.press("Escape")
    page.click("#my_programs")
    tiles = page.locator("#versions button:not(.delete)")
    assert tiles.count() == 3 and tiles.first.get_attribute("id") == "new"
    pictures = [tile.locator("rect").count() for tile in tiles.all()[1:]]
    assert pictures == [2, 1]  # a bar for each instruction
    for tile in tiles.all():
        box = tile.bounding_box()
        assert box is not None and min(box["width"], box["height"]) >= 100
    hidden_element = page.locator("#share_link, #shared, #shared_picture, #public")
    assert hidden_element.count() == 4 and not hidden_element.filter(visible=True).count()
    assert axe(page, within="#programs") == []
    page.keyboard.press("Escape")


@pytest.mark.parametrize("button", ["#bar_new", "#new"])
def test_a_new_program_takes_one_press_and_keeps_the_previous_one(page: Page, button: str) -> None:
    write(page, "SI|F(7, 70)")
    if button == "#new":
        page.click("#my_programs")
    page.click(button)
    wait_until_checked(page)
    assert content(page).strip() == "" and not page.locator("#programs").is_visible()
    page.click("#my_programs")
    assert list_programs(page)[0] == "SI|F(7, 70)"
    page.keyboard.press("Escape")


def picture_of_blocks(page: Page) -> tuple[int, int, dict[str, int]]:
    """Save the picture of the blocks; return its size, and how many times it has each colour."""
    unfold(page)
    with page.expect_download() as download:
        page.click("#share_picture")
    assert download.value.suggested_filename.endswith(".png")
    return colours(page, Path(download.value.path()).read_bytes())


@sampled
def test_the_blocks_are_saved_as_a_picture(page: Page) -> None:
    """This works from the text view, too, unless there are too many blocks."""
    for view in ("text", "blocks"):
        page.click("#view_text")
        write(page, "SI|F(2, 80)")
        page.click(f"#view_{view}")
        page.click("#my_programs")
        small_image = picture_of_blocks(page)
        page.click("#programs_close")
        assert page.locator("#blocks").is_visible() == (view == "blocks")
        page.click("#view_text")
        write(page, "SI|" + "F(2, 80);" * 5)
        page.click("#my_programs")
        large_image = picture_of_blocks(page)
        page.keyboard.press("Escape")
        assert large_image[1] > small_image[1] * 1.8, view  # rows
        # the blocks are filled
        assert large_image[2][MOVE_COLOUR] > 4 * small_image[2][MOVE_COLOUR] > 4000, view
        assert (
            small_image[2]["255,255,255"] > small_image[0] * small_image[1] / 10
        )  # letters and their surroundings
        assert "0,0,0" not in small_image[2], view  # every block has its colour
    write(page, "S;" * 1600)
    page.click("#my_programs")
    unfold(page)
    page.click("#share_picture")
    page.locator("#shared_told", has_text="No picture is available").wait_for()
    page.keyboard.press("Escape")


@sampled
def test_a_shared_program_can_be_copied(page: Page) -> None:
    write(page, "SI|F(1, 80)")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    shared_text = share(page, "line")
    page.click("#copy")
    page.locator("#shared_told", has_text="Copied").wait_for()
    assert page.evaluate("navigator.clipboard.readText()") == shared_text
    page.context.clear_permissions()
    page.evaluate(
        "() => { navigator.clipboard.writeText = () => Promise.reject(new Error('no')); }"
    )
    page.click("#copy")
    page.locator("#shared_told", has_text="Ctrl+C").wait_for()
    assert page.evaluate("String(getSelection())") == shared_text
    page.evaluate("delete navigator.clipboard.writeText")
    page.keyboard.press("Escape")


def test_earlier_programs_can_be_restored(page: Page) -> None:
    page.evaluate("localStorage.removeItem('tiniscript.versions')")
    write(page, "SI|F(1, 10)")
    page.click("#run")  # a program that has run is kept
    write(page, "SI|F(2, 20)")
    page.click("#my_programs")
    assert list_programs(page) == ["SI|F(2, 20)", "SI|F(1, 10)"]
    page.click("#new")
    wait_until_checked(page)
    assert content(page).strip() == ""
    write(page, "SI|F(3, 30)")
    page.select_option("#robot", "liner")
    page.reload()
    wait_until_checked(page)
    page.click("#my_programs")
    assert list_programs(page) == ["SI|F(3, 30)", "SI|F(2, 20)", "SI|F(1, 10)"]
    rows = page.locator("#versions li")
    assert rows.locator("svg").count() == 4
    rows.filter(has_text="SI|F(1, 10)").get_by_role("button").first.click()
    wait_for_note(page, "Opened: SI|F(1, 10)")  # its name in the list
    wait_until_checked(page)
    assert content(page) == "SI|F(1, 10)" and page.input_value("#robot") == "tinibot"
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")
    wait_until_checked(page)
    assert content(page) == "SI|F(3, 30)"


SAME_PROGRAMS = (
    "SI|F(1, 10);\nB(2, 20);",
    "SI|F(1, 10)\nB(2, 20)",
    "SI|F(1,10)\n\n  B( 2,20 ) ;\n",
)
OTHER_PROGRAMS = ("SI|F(1, 10)\nB(2, 2 0)", "SI|F(1, 10) // B(2, 20)", "SI|F(1, 10)\n// B(2, 20)")


def test_equal_programs_are_kept_once(page: Page) -> None:
    page.evaluate("localStorage.removeItem('tiniscript.versions')")
    for text in SAME_PROGRAMS:
        write(page, text)
        page.click("#my_programs")
        assert len(list_programs(page)) == 1
        page.keyboard.press("Escape")
    for count, text in enumerate(OTHER_PROGRAMS, 2):
        write(page, text)
        page.click("#my_programs")
        assert len(list_programs(page)) == count, text
        page.keyboard.press("Escape")


def test_programs_that_begin_alike_have_titles_of_their_own(page: Page) -> None:
    page.evaluate("localStorage.removeItem('tiniscript.versions')")
    page.click("#view_blocks")
    for seconds in (1, 2, 3):
        write(page, f"SI|F(1, 10)\nB({seconds}, 10)")
        page.click("#my_programs")
        assert len(set(list_programs(page))) == len(list_programs(page)) == seconds
        page.keyboard.press("Escape")
    page.click("#view_text")


def test_a_program_is_deleted_and_restored(page: Page) -> None:
    """All but the one in the editor, which would come again by itself."""
    page.evaluate("localStorage.removeItem('tiniscript.versions')")
    texts = [f"SI|F({seconds}, 10)" for seconds in range(1, 5)]
    for text in texts:
        write(page, text)
        page.click("#my_programs")
        page.keyboard.press("Escape")
    page.click("#my_programs")
    rows = page.locator("#versions li:not(:has(#new))")
    for index in (0, 2, 3, 1):
        title = texts[::-1][index]
        assert list_programs(page) == texts[::-1]
        delete = rows.nth(index).get_by_role("button", name=f"Delete {title}")
        assert delete.count() == (index > 0)
        if not index:
            continue
        delete.click()
        assert list_programs(page) == [text for text in texts[::-1] if text != title]
        assert axe(page, within="#programs") == []
        page.keyboard.press("Enter")  # the button in the program's place has the focus
    rows.nth(2).locator(".delete").click()
    page.keyboard.press("Escape")
    page.reload()
    wait_until_checked(page)
    page.click("#my_programs")
    assert list_programs(page) == [texts[3], texts[2], texts[0]]
    page.keyboard.press("Escape")


def test_kept_programs_are_limited_by_storage(page: Page) -> None:
    write(page, "SI|F(4, 44)")  # saved when someone opens the list of programs
    kept_state = page.evaluate(
        """() => {
          const at = 'tiniscript.versions';
          const long = Array.from({length: 60}, (_, k) =>
            ({text: 'S;'.repeat(20000) + k, robot: 'tinibot', name: '', at_ms: k}));
          localStorage.setItem(at, JSON.stringify(long));
          document.querySelector('#my_programs').click();
          return JSON.parse(localStorage.getItem(at)).map(each => each.text.length);
        }"""
    )
    assert sum(kept_state) <= 400_000 and 5 < len(kept_state) <= 40
    page.keyboard.press("Escape")
    page.evaluate("localStorage.removeItem('tiniscript.versions')")


DAMAGED_TEXTS = ("no JSON", "null", "7", '{"length": 3}', '[null, 1, {"text": 5}]',
                 '[{"text": "S", "robot": "__proto__", "name": "", "at_ms": 1}]',
                 '[{"text": "S", "robot": "tinibot", "name": {}, "at_ms": 1}]',
                 '[{"text": "S", "robot": "tinibot", "name": "", "at_ms": 1e300}]')  # fmt: skip


@each_row("kept_text", DAMAGED_TEXTS)
def test_damaged_programs_do_no_harm(page: Page, kept_text: str) -> None:
    write(page, "SI|F(6, 60)")
    page.evaluate("kept => localStorage.setItem('tiniscript.versions', kept)", kept_text)
    page.click("#my_programs")
    assert list_programs(page) == ["SI|F(6, 60)"]
    page.keyboard.press("Escape")
    page.evaluate("localStorage.removeItem('tiniscript.versions')")


def test_a_browser_without_storage_is_reported(page: Page) -> None:
    write(page, "SI|F(1, 11)")
    page.evaluate(
        "() => { window.kept = Storage.prototype.setItem;"
        " Storage.prototype.setItem = () => { throw new DOMException('full'); }; }"
    )
    page.click("#run")
    wait_for_note(page, "This browser does not save anything")
    page.evaluate("() => { Storage.prototype.setItem = window.kept; }")
    page.click("#stop")


def test_the_stop_button_is_in_reach(page: Page) -> None:
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    page.click("#run")
    wait_for_phase(page, "running")
    page.click("#my_programs")
    page.click("#programs_stop")
    wait_for_phase(page, "ended")
    page.click("#programs_close")


def test_escape_closes_a_window_and_only_then_stops(page: Page) -> None:
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    page.click("#run")
    wait_for_phase(page, "running")
    for button, window in (("#my_programs", "#programs"), ("#runs_open", "#runs")):
        page.click(button)
        page.keyboard.press("Escape")
        page.locator(window).wait_for(state="hidden")
        page.evaluate(SETTLED_SCRIPT)
        wait_for_phase(page, "running")
    page.keyboard.press("Escape")
    wait_for_phase(page, "ended")


def test_the_keyboard_alone_is_enough(page: Page) -> None:
    write(page, "SI|F(5, 50)")
    page.locator("#my_programs").focus()
    page.keyboard.press("Enter")
    page.locator("#share summary").focus()
    page.keyboard.press("Enter")
    page.locator("#programs[data-shared=done]").wait_for()
    for _ in range(4):
        if page.evaluate("document.activeElement.id") == "share_line":
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.locator("#programs[data-shared=done]").wait_for()
    assert page.input_value("#shared") == line_for_robot(b"SI|F(5, 50)", "tinibot", "en")
    page.keyboard.press("Escape")
    assert page.evaluate("document.activeElement.id") == "my_programs"
    assert image(page) == compile("SI|F(5, 50)").image
