"""The last runs in the page: one is seen again, saved as a file, and a file is played."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.studio.runs_again import record_run
from tests.support.page_robot import running, value
from tests.support.page_runs import run_names
from tests.support.studio import wait_for_phase, write
from tiniscript import compile, robots
from tiniscript.studio.playing import play, prepare
from tiniscript.studio.recordings import REAL, Row, decode, encode, header_line

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="earlier runs", keep=2)

KEYS = (
    "SI|LOOP(FOREVER);\nM(PAD_Y, PAD_Y);\nIF(KEY_A);\nSHOW(RANDOM(1, 99));\nEND_IF;\n"
    "W(0.05);\nEND_LOOP"
)
SHOW_PROGRAM = "SI|LOOP(2);\nW(0.2);\nSHOW(DISTANCE);\nEND_LOOP;\nSHOW(5)"


@pytest.fixture
def page(page: Page) -> Page:
    page.select_option("#speed", "20")
    return page


def run_to_end(page: Page, text: str, shown_text: str) -> None:
    write(page, text)
    page.click("#run")
    page.locator("#trace", has_text=shown_text).wait_for(state="attached")
    wait_for_phase(page, "ended")


def save_run(page: Page, row: int) -> bytes:
    with page.expect_download() as download:
        page.locator("#runs_list li").nth(row).locator("button", has_text="Save run").click()
    assert download.value.suggested_filename == "run.tsr"
    return Path(download.value.path()).read_bytes()


def status_text(page: Page) -> str:
    return page.locator("#doing").text_content() or ""


def wait_for_status(page: Page, text: str) -> None:
    page.locator("#doing", has_text=text).wait_for()


def real_recording(*rows: tuple[int, str], text: str = SHOW_PROGRAM) -> str:
    header = header_line(REAL, text, robots.load("tinibot"), compile(text).checksum)
    return encode(header, [Row(*row) for row in rows], rows[-1][0])


def open_run(page: Page, data: bytes | str, file: Path) -> None:
    file.write_bytes(data.encode() if isinstance(data, str) else data)
    page.click("#runs_open")
    page.set_input_files("#run_file", file)


@sampled
def test_an_earlier_run_is_replayed_and_the_newest_restored(page: Page) -> None:
    run_to_end(page, "SI|X = 7;\nF(0.5, 60);\nSHOW(X)", "SHOW 7")
    pose = page.locator("#where").text_content()
    run_to_end(page, "SI|Y = 8;\nSHOW(Y)", "SHOW 8")
    assert len(run_names(page)) >= 2
    page.locator("#runs_list li").nth(1).locator("button").first.click()
    wait_for_status(page, "Looking back at ")  # the text of that run differs
    assert page.locator("#where").text_content() == pose
    assert value(page, "X") == "7"
    page.focus("#time_at")
    page.keyboard.press("Home")
    assert page.locator("#doing").inner_text().startswith("Looking back at 0.0 s.")
    page.click("#step")
    page.locator("#doing", has_not_text="Looking back").wait_for()
    wait_for_phase(page, "paused")


@sampled
def test_only_the_newest_ten_runs_are_kept(page: Page) -> None:
    for number in range(12):
        run_to_end(page, f"SI|SHOW({number})", f"SHOW {number}")
    rows = run_names(page)
    assert len(rows) == 10
    numbers = [int(row.split(":")[0].removeprefix("Run ")) for row in rows]
    assert numbers == list(range(numbers[0], numbers[0] - 10, -1))
    assert "SHOW(11)" in page.locator("#runs_list code").first.inner_text()
    page.click("#runs_close")


def test_a_saved_run_replays_alike_in_page_and_command_line(page: Page, tmp_path: Path) -> None:
    page.select_option("#speed", "1")
    write(
        page,
        KEYS,
    )
    page.click("#run")
    wait_for_phase(page, "running")
    page.focus("#arena")
    page.locator("#pad_letters button").first.hover()
    page.mouse.down()
    page.locator("#trace", has_text="SHOW").wait_for(state="attached")
    page.mouse.up()
    page.click("#stop")
    wait_for_phase(page, "ended")
    run_names(page)
    data = save_run(page, 0)
    recording = decode(data)
    assert any(row.remote_state is not None and row.remote_state.keys for row in recording.rows)
    divergence = play(prepare(recording)).divergence
    assert divergence is not None and (divergence.outcome, divergence.agreed) == (
        "again", sum(not row.is_input for row in recording.rows))  # fmt: skip
    page.click("#runs_close")
    write(page, "SI|S")
    open_run(page, data, tmp_path / "run.tsr")
    wait_for_status(
        page,
        f"The virtual robot did exactly the same again. Rows compared: {divergence.agreed}.",
    )
    run_names(page)
    assert decode(save_run(page, 0)).rows == recording.rows
    page.click("#runs_close")


@sampled
def test_the_run_of_another_robot_and_world_is_played(page: Page, tmp_path: Path) -> None:
    data, rows = next(run for run in map(record_run, range(99)) if b'"tinibot32"' in run[0])
    open_run(page, data, tmp_path / "run.tsr")
    wait_for_status(
        page, f"The virtual robot did exactly the same again. Rows compared: {len(rows)}."
    )
    header = json.loads(data.splitlines()[0])
    assert (page.input_value("#robot"), page.input_value("#world")) == (
        header["robot"], header["world"])  # fmt: skip


@sampled
def test_a_real_run_is_replayed_beside_the_virtual_one_with_divergences_marked(
    page: Page, tmp_path: Path
) -> None:
    rows = ((217, "SHOW 17.5"), (434, "SHOW 9"), (451, "SHOW 5"), (452, "DONE"))
    open_run(page, real_recording(*rows), tmp_path / "run.tsr")
    wait_for_status(page, "Both robots did the same. Values compared: 4.")
    changed_rows = (*rows[:2], (451, "SHOW 6"), (452, "DONE"))
    open_run(page, real_recording(*changed_rows), tmp_path / "run.tsr")
    wait_for_status(
        page, "Line 5: the robot reported 6 after 0.5 s, but the virtual robot reported 5 after"
    )
    names = run_names(page)
    assert names[0].startswith("Run ") and "real robot" in names[0]
    assert [row.event for row in decode(save_run(page, 0)).rows] == [
        event for _, event in changed_rows
    ]
    page.click("#runs_close")
    text = "SI|X = DISTANCE;\nSHOW(X)"
    open_run(page, real_recording((20, "SHOW 3"), text=text), tmp_path / "run.tsr")
    wait_for_status(page, "Line 1: the program reads DISTANCE, but the recording lacks")


@pytest.mark.sampled("data", "message")
@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"a letter", "The file is damaged, or is not a saved run (line 1)."),
        (
            real_recording((1, "DONE")).encode()[:-10],
            "The end of the file is missing (after line 2).",
        ),
        (b'{"tiniscript_recording": 1}', "The run was recorded by an older version"),
        (
            real_recording((1, "DONE")).replace('run":1', 'run":9').encode(),
            "The run was recorded by a newer version.",
        ),
        (b" " * 1_100_000, "The run is too long"),
    ],
    ids=["letter", "cut", "older", "newer", "huge"],
)
def test_a_file_that_is_not_a_run_is_refused_with_a_reason(
    page: Page, tmp_path: Path, data: bytes, message: str
) -> None:
    run_to_end(page, "SI|SHOW(77)", "SHOW 77")
    names_before = run_names(page)
    page.click("#runs_close")
    open_run(page, data, tmp_path / "run.tsr")
    page.locator("#runs_said", has_text=message).wait_for()
    page.click("#runs_close")
    assert run_names(page) == names_before
    page.click("#runs_close")
    assert status_text(page) == "It has ended."
    assert running(page) == ""


@sampled
def test_a_dropped_file_is_opened(page: Page) -> None:
    rows = ((217, "SHOW 17.5"), (434, "SHOW 9"), (451, "SHOW 5"), (452, "DONE"))
    drop = """([name, data]) => {
        const files = new DataTransfer();
        files.items.add(new File([data], name));
        const given = {dataTransfer: files, bubbles: true, cancelable: true};
        document.body.dispatchEvent(new DragEvent('drop', given));
    }"""
    page.evaluate(drop, ["x.png", "no"])
    page.locator(
        "#note", has_text="x.png was not opened. The file name of a saved run ends in .tsr."
    ).wait_for()
    page.evaluate(drop, ["mine.tsr", real_recording(*rows)])
    wait_for_status(page, "Both robots did the same. Values compared: 4.")
