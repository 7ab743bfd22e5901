"""Use of the page: programs, messages, files, and stored data."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.pupils import corpus
from tests.studio.programs import MISSING_PART_CODES, messages_of, programs
from tests.studio.programs import image as image_of
from tests.support.sampling import sample_of
from tests.support.studio import (
    Pages,
    ask_worker,
    image,
    speak,
    wait_for_note,
    wait_until_checked,
    write,
)
from tiniscript import check, compile, robots
from tiniscript.bytecode.image import unpack
from tiniscript.diagnostics.rendering import Message
from tiniscript.library.known_kits import lacks
from tiniscript.studio.checking import open_text

if TYPE_CHECKING:
    from playwright.sync_api import Page

# The compiler gets its requests at once, or only when released.
HOLDING_SCRIPT = """() => {
  const { postMessage } = Worker.prototype, held = [];
  Worker.prototype.postMessage = function (...said) { held.push([this, said]); };
  window.letGo = () => {
    Worker.prototype.postMessage = postMessage;
    for (const [worker, said] of held) worker.postMessage(...said);
  };
}"""


def checks(page: Page, requests: list[dict[str, str]]) -> list[dict[str, Any]]:
    """Return the messages of the page's compiler for programs."""
    return ask_worker(page, [{"do": "check", **request} for request in requests])


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(6))
def test_every_program_gives_the_same_image_as_the_command(page: Page, part: int) -> None:
    """Programs of the paper, of all documents and cases, and the examples."""
    sample = programs()[part::6]
    assert len(sample) > 50
    requests = [
        {"text": program.text, "robot": program.robot, "language": "en"} for program in sample
    ]
    answers = checks(page, requests)
    for program, answer in zip(sample, answers, strict=True):
        compiled_text = image_of(program)
        needs = unpack(bytes.fromhex(compiled_text)).needs if compiled_text else 0
        unsupported = lacks(needs, robots.load(program.robot))  # the page reports this
        assert answer["image"] == ("" if unsupported else compiled_text), program.name


@pytest.mark.sampled("first_index", "part")
@pytest.mark.parametrize("first_index", range(2))
@pytest.mark.parametrize("part", range(24))
def test_every_wrong_program_gives_the_same_messages_as_the_command(
    page: Page, first_index: int, part: int
) -> None:
    """Languages alternate. This also detects missing parts of the package."""
    requests = [
        {"text": entry.program, "robot": "tinibot", "language": ("en", "es")[(first_index + k) % 2]}
        for k, entry in enumerate(corpus.entries()[part::24])
    ]
    for request, answer in zip(requests, checks(page, requests), strict=True):
        text = request["text"]
        expected = [message._asdict() for message in messages_of(text, request["language"])]
        findings = [
            {key: finding[key] for key in Message._fields}
            for finding in answer["findings"]
            if finding["code"] not in MISSING_PART_CODES
        ]
        assert findings == expected, text


def test_an_internal_error_is_reported_with_its_name(page: Page) -> None:
    """The packed Python knows no lines of its sources; its tracebacks are made all the same."""
    with pytest.raises(Exception, match=r"in _request_handler\nKeyError: 'nonsense'"):
        ask_worker(page, [{"do": "nonsense", "text": ""}])


def test_typed_text_is_reported_as_correct_only_after_compilation(page: Page) -> None:
    write(page, "SI|F(3, 70);\nS")
    assert image(page) == compile("SI|F(3, 70);\nS").image
    assert page.inner_text("#status") == "Ready to run: 4 bytes."
    write(page, "")
    assert image(page) == compile("").image
    write(page, "F(1, 80)")
    status = page.locator("#status")
    assert status.get_attribute("class") == "right"
    page.evaluate(HOLDING_SCRIPT)
    page.keyboard.type("1, ")
    status.filter(has_text=re.compile("^…$")).wait_for()
    assert status.get_attribute("class") == ""
    page.evaluate("letGo()")
    wait_until_checked(page)
    assert (status.inner_text(), status.get_attribute("class")) == ("1 mistake", "wrong")


def test_a_mistake_is_marked_where_it_is_and_its_button_repairs_it(page: Page) -> None:
    speak(page, "es")
    write(page, "// ñandú 🤖\nSI|F(1, 80); // 🤖 F(\nF(-2, 80)")
    assert page.inner_text("#status") == "1 error"
    assert page.locator(".cm-lintRange-error").all_inner_texts() == ["-2"]
    row = page.locator("#messages li")
    assert row.inner_text().startswith("Línea 3")
    assert check("F(-2, 80)", language="es")[0].message in row.inner_text()
    row.get_by_role("button", name="Hacerlo").click()
    wait_until_checked(page)
    assert page.inner_text("#status").startswith("Listo para probar")
    assert page.locator(".cm-content").inner_text().endswith("B(2, 80)")
    page.keyboard.press("Control+z")
    wait_until_checked(page)
    assert page.inner_text("#status") == "1 error"


@pytest.mark.parametrize(
    ("program", "expected_text"),
    [
        ("R(90, 60)", "R(90 DEG, 60)"),
        ("F(1, 800)", "F(1, 100)"),
        ("contador = contador + 1\nF(contador, 50)",
         "CONTADOR = 0\ncontador = contador + 1\nF(contador, 50)"),
    ],
)  # fmt: skip
def test_a_button_does_what_its_message_says(page: Page, program: str, expected_text: str) -> None:
    """Undo reverts it."""
    write(page, program)
    page.locator("#messages .repair").click()
    page.locator("#messages .repair").wait_for(state="detached")
    wait_until_checked(page)
    assert image(page) == compile(expected_text).image
    page.click("#undo")
    page.locator("#messages .repair").wait_for()


def test_a_repair_can_be_chosen_in_the_text(page: Page) -> None:
    write(page, "F(-2, 80)")
    page.locator("#messages .repair").wait_for()
    page.hover(".cm-lintRange-error")
    page.click(".cm-tooltip .cm-diagnosticAction")
    wait_until_checked(page)
    assert image(page) == compile("B(2, 80)").image


def test_the_words_are_those_of_the_robot(page: Page) -> None:
    write(page, "LINE_L")
    assert page.inner_text("#status").startswith("1 mistake")
    page.select_option("#robot", "liner")
    wait_until_checked(page)
    assert image(page) == compile("LINE_L", "liner").image
    write(page, "")
    page.keyboard.type("li")
    page.wait_for_selector(".cm-tooltip-autocomplete")
    offers = page.locator(".cm-tooltip-autocomplete .cm-completionLabel").all_inner_texts()
    assert {"LINE_L", "LINE_R"} <= set(offers) and "LIGHT_L" not in offers


def test_words_of_the_language_have_colors(page: Page) -> None:
    write(page, "SI|F(2, DISTANCE) // F")
    colors = page.evaluate(
        "() => Object.fromEntries([...document.querySelector('#editor').shadowRoot"
        ".querySelectorAll('.cm-line span')].map(s => [s.textContent, getComputedStyle(s).color]))"
    )
    assert len({colors[text] for text in ("SI", "F", "2", "DISTANCE", "// F")}) == 5


def test_changing_the_language_changes_all_texts(page: Page) -> None:
    write(page, "FF(2, 80)")
    english = page.inner_text("body")
    speak(page, "es")
    page.locator("#status").filter(has_text="1 error").wait_for()
    assert page.evaluate("document.documentElement.lang") == "es"
    spanish = page.inner_text("body")
    assert "Guardar" in spanish and "Save" in english and "Save" not in spanish
    assert check("FF(2, 80)", language="es")[0].message in spanish


def test_a_program_is_kept_across_visits(page: Page, only_page: tuple[Pages, Page]) -> None:
    page.select_option("#robot", "grabber")
    speak(page, "es")
    page.click("#words")
    write(page, "GRIPPER(90)")
    page.reload()
    wait_until_checked(page)
    assert page.locator("#words[aria-pressed=true]").count() == 1
    assert "DISTANCE sensor de distancia" in page.inner_text("#values")
    assert page.locator(".cm-content").inner_text() == "GRIPPER(90)"
    assert (page.input_value("#robot"), page.input_value("#language")) == ("grabber", "es")
    page.click("#words")
    other_page = only_page[0].another(page)  # a new tab begins with it
    assert other_page.locator(".cm-content").inner_text() == "GRIPPER(90)"
    write(other_page, "S")
    other_page.close()
    page.reload()  # each tab keeps its own program
    wait_until_checked(page)
    assert page.locator(".cm-content").inner_text() == "GRIPPER(90)"


# The tab's stored data is useless; that of the last tab is not, or is damaged, too.
DAMAGED_WORK = (
    ("no JSON", '{"text": 5}'),
    ("null", '{"text": "S", "robot": "../x", "language": "<b>"}'),
    ("[]", '{"text": "S", "robot": {"toString": 1}, "world": "__proto__", "name": 7}'),
    ("5", '{"text": "S", "language": {"toString": 1}}'),
)


def test_damaged_stored_programs_do_no_harm(page: Page, pytestconfig: pytest.Config) -> None:
    for stored_text in sample_of(pytestconfig, "damaged work", DAMAGED_WORK):
        page.evaluate(
            "kept => { for (const s of [sessionStorage, localStorage])"
            " s.setItem('tiniscript.work', kept.shift()); }",
            stored_text,
        )
        page.reload()
        wait_until_checked(page)
        assert page.input_value("#robot") == "tinibot"
        assert (image(page) == compile("S").image) == ('"S"' in stored_text[1])
    page.click("#view_text")


def test_files_are_opened_and_saved(page: Page, tmp_path: Path) -> None:
    text_before = page.locator(".cm-content").inner_text()
    path = tmp_path / "baile <b>.ts"
    path.write_bytes("\ufeffSI|BEEP(1, 440); // á\r\nS\r\n".encode())
    page.set_input_files("#file", path)
    wait_for_note(page, "Opened")
    wait_until_checked(page)
    assert page.inner_text("#note") == "Opened: baile <b>.ts"
    assert image(page) == compile("SI|BEEP(1, 440);S").image
    with page.expect_download() as download_info:
        page.click("#save")
    saved_path = tmp_path / "saved.ts"
    download_info.value.save_as(saved_path)
    assert saved_path.read_bytes() == "SI|BEEP(1, 440); // á\nS\n".encode()
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")  # the previous program can be restored
    wait_until_checked(page)
    assert page.locator(".cm-content").inner_text() == text_before


def test_a_file_that_is_not_a_program_leaves_the_program(page: Page, tmp_path: Path) -> None:
    write(page, "SI|F(4, 80)")
    image_before = image(page)
    for name, data in (("nul", b"\x7fELF\0\0\0"), ("bytes", b"\xff\xfe\xfa"),
                       ("large", b"F(1, 80);" * 150_000)):  # fmt: skip
        path = tmp_path / f"{name}.ts"
        path.write_bytes(data)
        page.set_input_files("#file", path)
        wait_for_note(page, path.name)
        expected = open_text(data, "tinibot", "en")
        assert isinstance(expected, Message) and expected.message in page.inner_text("#note"), name
        assert image(page) == image_before, name


HOSTILE = """<img src=x onerror="document.title='taken'"><script>document.title='taken'</script>
F(javascript:alert(1), "</script>");${1}{{1}}\u202e\u0007 %s%n ../../ \U0001f4a9"""


def test_a_hostile_program_is_shown_as_text(page: Page, tmp_path: Path) -> None:
    path = tmp_path / "<img src=x onerror=alert(1)>.ts"
    path.write_text(HOSTILE, encoding="utf-8")
    page.set_input_files("#file", path)
    wait_for_note(page, "Opened")
    wait_until_checked(page)
    assert page.title() == "TiniScript Studio"
    assert page.locator("img, main script").count() == 0
    expected_messages = check(HOSTILE)
    assert len(expected_messages) >= 1
    assert expected_messages[0].message in page.inner_text("#messages")


def test_the_address_injects_nothing_into_the_page(page: Page, address: str) -> None:
    write(page, "SI|F(1, 80)")
    page.goto(address + "?code=SI|F(9,9)#<img src=x onerror=alert(1)>")
    wait_until_checked(page)
    assert page.locator(".cm-content").text_content() == "SI|F(1, 80)"
    page.click("#start_write")
    page.click("#view_text")


def test_a_long_program_is_compiled_while_it_is_typed(page: Page) -> None:
    text = "SI|" + "F(1, 80);\n" * 50 + "// a long program\n" * 450
    write(page, text)
    assert image(page) == compile(text).image
    for _ in range(2):
        page.keyboard.type("S;")
    wait_until_checked(page)
    assert image(page) == compile(text + "S;" * 2).image


def test_numbers_in_json_stay_exact(page: Page) -> None:
    """Places of instructions come as lists of whole numbers."""
    (answer,) = checks(page, [{"text": "SI|F(2, 80)", "robot": "tinibot", "language": "en"}])
    assert json.dumps(answer["places"]) == "[[0, 1, 4, 1, 12]]"


def test_a_program_that_names_its_robot_chooses_it(page: Page) -> None:
    """Choosing another robot changes the name."""
    page.select_option("#robot", "tinibot")
    write(page, "// robot: liner\nSI|SHOW(LINE_L)\n")
    wait_until_checked(page)
    assert page.input_value("#robot") == "liner"
    assert image(page) == compile("// robot: liner\nSI|SHOW(LINE_L)\n").image
    page.select_option("#robot", "grabber")
    page.wait_for_selector("#editor :text('robot: grabber')")
    wait_until_checked(page)
    assert page.input_value("#robot") == "grabber"
    page.select_option("#robot", "tinibot")
    page.wait_for_selector("#editor :text('robot: tinibot')")
    write(page, "SI|S")
    wait_until_checked(page)
    assert page.input_value("#robot") == "tinibot"
