"""The speed of the studio's page: `python -m tools.bench.studio`.

One table, of the system's Chromium on this computer. Each time is the least of several, since other
work makes a browser slower and never faster. All files come from this computer. npm fetches
Lighthouse the first time: desktop preset, median of five, of the page gzipped, as static hosts send
it.
"""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import sys
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

from tests.support import studio
from tiniscript.studio import serving
from tools.bench import page as page_of_figures
from tools.builds.studio import PAGE, find_tools, size_rows

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

VISIT_COUNT = 3
CPU_THROTTLING = 4  # times as slow a processor
START_COUNT = 5
WATCH_MS = 4000  # time in which frames are counted
PUPIL_COUNT, WRITER_COUNT = 30, 3
WRITE_INTERVAL_MS = 300  # between two changes of a writer
PRESS_COUNT = 60
MAX_STOP_MS = 50
LATE_FRAME_MS = 33.5  # two of 60 pictures a second take 33.3 ms, and a page's clock has tenths
SETTLE_MS = 1500  # wait after a start
TASK_EVENT = "ThreadControllerImpl::RunTask"  # event of a thread in Chromium's traces
RATING_COUNT = 5
TYPED_LETTER_COUNT = 60  # letters
PROGRAM_LINES = 100
LIGHTHOUSE = "lighthouse@13.5.0"
ROWS = {
    "usable": "until you can type in the page, best of three visits",
    "compiled": "processor time until the first program is compiled",
    "moving": "on a processor four times as slow: from a click on a picture to the moving robot, "
    "empty cache, median of five",
    "again": "the same at the next visit",
    "pictures": f"frames that took over {LATE_FRAME_MS} ms in a run at 20 times the speed, on that "
    "processor, starting 1.5 s into the run",
    "work": "the same, judged by the work of the page's main thread for each frame, times four: "
    f"over {LATE_FRAME_MS} ms",
    "letter": f"processor time to compile {PROGRAM_LINES} lines after a letter is typed",
    "button": "processor time to try out the effect of a repair button, after a pause in typing",
    "rated": "Lighthouse, desktop: performance, accessibility, best practices (median of five)",
    "files": "all files, gzipped",
}
RATED_CATEGORIES = ("performance", "accessibility", "best-practices")
# When one can type in the page: the editor and all buttons are there.
WATCH_SCRIPT = """() => {
  const look = () => {
    if (document.documentElement?.dataset.state) window.usable_ms ??= performance.now();
  };
  new MutationObserver(look).observe(document, {subtree: true, childList: true, attributes: true});
}"""
# The times of clicks, the advance of the robot's time, and the duration of each picture.
FOLLOW_SCRIPT = """() => {
  window.frames = [];
  addEventListener('click', () => { window.clicked_ms ??= performance.now(); }, {capture: true});
  let before = 0;
  const look = (now) => {
    const isRunning = document.documentElement?.dataset.phase === 'running';
    const moves = /[1-9]/.test(document.querySelector('#values dd')?.textContent ?? '');
    if (isRunning && moves) window.moving_ms ??= performance.now();
    if (isRunning && before) window.frames.push(now - before);
    before = isRunning ? now : 0;
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}"""
# When the button is pressed, as the browser has noted it, and when the request leaves.
PRESS_SCRIPT = """() => { window.waits = []; const own = window.fetch;
  const note = ({timeStamp}) => { window.pressed_ms = timeStamp; };
  addEventListener('pointerdown', note, {capture: true});
  window.fetch = (where, what) => {
    if (what?.body?.includes('"stop_all"')) waits.push(performance.now() - pressed_ms);
    return own(where, what);
  }; }"""
# A letter is typed in the middle of the program, and the compiler is asked like by the page; during
# a pause, also about a button.
TYPE_SCRIPT = """async ([text, count, isPausing]) => {
  const worker = new Worker('./worker.js', {type: 'module'});
  const said = () => new Promise((resolve) => { worker.onmessage = ({data}) => resolve(data); });
  await said();
  const lines = text.split('\\n');
  for (let k = 0; k < count; k += 1) {
    lines[50] = `  SHOW(${k}${'0'.repeat(k % 3)})`;
    const data = new TextEncoder().encode(lines.join('\\n'));
    const ask = async (request) => {
      worker.postMessage({id: 1, request: JSON.stringify({robot: 'tinibot', ...request}), data});
      const answer = await said();
      return JSON.parse(answer.answer);
    };
    const {image, findings} = await ask({do: 'check', language: 'en'});
    if (!image) throw new Error(JSON.stringify(findings));
    if (!isPausing) continue;
    const which = findings.findIndex((each) => each.may_repair);
    const {changes} = await ask({do: 'repair', which});
    if (!changes.length) throw new Error(JSON.stringify(findings[which]));
  }
  worker.terminate();
}"""


def main() -> None:
    if reason := studio.missing():
        sys.exit(reason)
    figure_rows: list[tuple[str, ...]] = []
    with (
        studio.driver() as driver,
        studio.serve_page() as server,
        studio.browser(driver, is_whole=True) as browser,
    ):
        for rows in (_measure, _time_to_move, _drawing_cost):
            figure_rows += [(ROWS[name], *cells) for name, *cells in rows(browser, server.address)]
        slowest_ms = _stopped_ms(browser)
    with studio.serve_page(_packed_files()) as server:
        scores = _lighthouse_scores(server.address).values()
        figure_rows.append((ROWS["rated"], ", ".join(f"{points:.0f}" for points in scores), "95"))
    packed_bytes = int(size_rows(PAGE)[-1].split()[1].replace(",", ""))
    figure_rows.append((ROWS["files"], f"{packed_bytes / 1e6:.2f} MB", "6 MB"))
    page_of_figures.show("studio", figure_rows)
    if slowest_ms > MAX_STOP_MS:
        sys.exit(f"STOP ALL left the page after {slowest_ms:.0f} ms")


def _measure(browser: Browser, address: str) -> Iterator[tuple[str, str, str]]:
    visits = []
    for _ in range(VISIT_COUNT):
        with _visit(browser, address) as page:
            visits.append((page.evaluate("usable_ms"), _processor_s(page)))
    usable_ms, used_s = map(min, zip(*visits, strict=True))
    yield "usable", f"{usable_ms / 1000:.2f} s", "1 s"
    yield "compiled", f"{used_s:.2f} s", "2.5 s"
    with _visit(browser, address) as page:
        letter_ms = _typed_ms(page, False)
        yield "letter", f"{letter_ms:.1f} ms", "16 ms"
        button_ms = _typed_ms(page, True) - letter_ms
        yield "button", f"{button_ms:.1f} ms", ""


def _typed_ms(page: Page, is_pausing: bool) -> float:
    """Return the processor time for a letter: of many less that of few, without the start."""
    before_s = _processor_s(page)
    page.evaluate(TYPE_SCRIPT, [_program(), TYPED_LETTER_COUNT, is_pausing])
    short_s = _processor_s(page) - before_s
    page.evaluate(TYPE_SCRIPT, [_program(), 3 * TYPED_LETTER_COUNT, is_pausing])
    return 1000 * (_processor_s(page) - before_s - 2 * short_s) / (2 * TYPED_LETTER_COUNT)


def _time_to_move(browser: Browser, address: str) -> Iterator[tuple[str, str, str]]:
    """A processor that is four times as slow, from a click on a picture to a robot that moves."""
    cold_s: list[float] = []
    warm_s: list[float] = []
    frames: list[float] = []
    for _ in range(START_COUNT):
        context = browser.new_context(viewport={"width": 1366, "height": 768})
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.add_init_script(f"({FOLLOW_SCRIPT})()")
        session = context.new_cdp_session(page)
        session.send("Emulation.setCPUThrottlingRate", {"rate": CPU_THROTTLING})
        for times_s in (cold_s, warm_s):
            page.goto(address, wait_until="commit")
            page.click("[data-begin=obstacle]")
            page.locator("html[data-phase=running]").wait_for(state="attached")
            page.wait_for_function("window.moving_ms")  # a robot that never moves ends it
            times_s.append(page.evaluate("moving_ms - clicked_ms") / 1000)
            page.evaluate("navigator.serviceWorker.ready.then(() => 1)")
        page.select_option("#speed", "20")
        page.wait_for_timeout(SETTLE_MS)
        page.evaluate("window.frames.length = 0")
        page.wait_for_timeout(WATCH_MS)
        frames += page.evaluate("window.frames")
        context.close()
    yield "moving", f"{median(cold_s):.2f} s", "2.5 s"
    yield "again", f"{median(warm_s):.2f} s", "2.5 s"
    late_count = sum(frame > LATE_FRAME_MS for frame in frames)
    yield "pictures", f"{late_count} of {len(frames):,}", "none"


def _drawing_cost(browser: Browser, address: str) -> Iterator[tuple[str, str, str]]:
    """Yield the main thread's work for each picture, which depends less on the load."""
    work_of_frames_ms: list[float] = []
    for _ in range(START_COUNT):
        context = browser.new_context(viewport={"width": 1366, "height": 768})
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.goto(address, wait_until="commit")
        page.click("[data-begin=obstacle]")
        page.locator("html[data-phase=running]").wait_for(state="attached")
        page.select_option("#speed", "20")
        page.wait_for_timeout(SETTLE_MS)
        browser.start_tracing(page=page, categories=["devtools.timeline", "toplevel"])
        page.wait_for_timeout(WATCH_MS)
        work_of_frames_ms += _frame_work_ms(json.loads(browser.stop_tracing())["traceEvents"])
        context.close()
    slowed_work_ms = [CPU_THROTTLING * work for work in work_of_frames_ms]
    late_count = sum(work_ms > LATE_FRAME_MS for work_ms in slowed_work_ms)
    yield (
        "work",
        f"{late_count} of {len(slowed_work_ms):,}, median {median(slowed_work_ms):.1f} ms",
        "none",
    )


def _stopped_ms(browser: Browser) -> float:
    """Return the slowest time from a teacher's STOP ALL until it leaves the page.

    Meanwhile pupils write as much as a page takes, as fast as it asks.
    """
    with studio.serve_class([]) as (server, classroom):
        classroom.teach({"do": "class_places", "places": PUPIL_COUNT})
        tokens = [
            classroom.answer(
                "", "192.0.2.7", {"do": "join", "code": classroom.code, "name": f"P{k}"}
            )["token"]
            for k in range(PUPIL_COUNT)
        ]

        def write_programs(pupils: list[str], change_number: int) -> None:
            for token in pupils:
                message = {
                    "do": "here",
                    "text": f"{_program(480)} // {change_number}",
                    "robot": "tinibot",
                }
                classroom.answer(token, "192.0.2.7", message)

        write_programs(tokens, 0)
        context = browser.new_context(viewport={"width": 1366, "height": 768})
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.goto(server.entrance())
        page.locator("#wall img[src^=blob]").nth(PUPIL_COUNT - 1).wait_for()
        page.evaluate(PRESS_SCRIPT)
        for k in range(PRESS_COUNT):
            write_programs(tokens[:WRITER_COUNT] if k % 2 else tokens, k)
            page.wait_for_timeout(WRITE_INTERVAL_MS)
            page.click("#stop", no_wait_after=True)
        waits: list[float] = page.evaluate("window.waits")
        context.close()
    return max(waits)


def _frame_work_ms(events: list[dict[str, Any]]) -> list[float]:
    """Return the processor time of the page's main thread from each picture to the next."""
    frame_events = [event for event in events if event["name"] == "FireAnimationFrame"]
    thread = Counter((draw["pid"], draw["tid"]) for draw in frame_events).most_common(1)[0][0]
    draw_times = sorted(draw["ts"] for draw in frame_events if (draw["pid"], draw["tid"]) == thread)
    work_of_frames_ms = [0.0] * len(draw_times)
    for task in events:
        if (
            task["name"] != TASK_EVENT
            or task.get("ph") != "X"
            or (task["pid"], task["tid"]) != thread
        ):
            continue
        frame_index = bisect_right(draw_times, task["ts"] + task["dur"]) - 1  # the newest
        if frame_index >= 0:
            work_of_frames_ms[frame_index] += task.get("tdur", 0) / 1000
    return work_of_frames_ms


def _processor_s(page: Page) -> float:
    """Return the processor time of the page's process, which other work does not change."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    metrics = session.send("Performance.getMetrics")["metrics"]
    session.detach()
    return next(float(metric["value"]) for metric in metrics if metric["name"] == "ProcessTime")


@contextmanager
def _visit(browser: Browser, address: str) -> Iterator[Page]:
    """Open a page as a new visitor, and wait for the compiled program."""
    context = browser.new_context(viewport={"width": 1366, "height": 768}, service_workers="block")
    page = context.new_page()
    page.set_default_timeout(120_000)
    page.add_init_script(f"({WATCH_SCRIPT})()")
    page.goto(address)
    studio.wait_until_checked(page)
    try:
        yield page
    finally:
        context.close()


def _program(line_count: int = PROGRAM_LINES) -> str:
    """Return a program of so many lines."""
    rows = ["SI|LOOP(3)"]
    for k in range((line_count - 4) // 4):
        rows += [f"  IF(DISTANCE < {k})", "    R(0.5, 60)", "  END_IF", "  F(1, 80)"]
    return ";\n".join([*rows, "  S", "  W(1)", "END_LOOP"])


def _packed_files() -> dict[str, serving.File]:
    return {
        name: file._replace(gzipped=gzip.compress(file.data, 6, mtime=0))
        for name, file in serving.files().items()
    }


def _lighthouse_scores(address: str) -> dict[str, float]:
    """Return the median points of each of Lighthouse's categories."""
    tools = find_tools()
    command = [*tools.npm, "exec", "--yes", "--ignore-scripts", LIGHTHOUSE, "--", address,
            "--preset=desktop", "--quiet", "--output=json",
            f"--only-categories={','.join(RATED_CATEGORIES)}",
            f"--chrome-flags=--headless=new {' '.join(studio.BROWSER_OPTIONS)}"]  # fmt: skip
    node = str(Path(tools.node[0]).parent)  # npm starts Lighthouse by the first node in PATH
    settings = {**os.environ, "CHROME_PATH": studio.chromium() or "",
                "PATH": os.pathsep.join((node, os.environ["PATH"]))}  # fmt: skip
    reports: list[dict[str, Any]] = []
    for _ in range(RATING_COUNT):
        result = subprocess.run(command, env=settings, capture_output=True, text=True, check=True)
        reports.append(json.loads(result.stdout)["categories"])
    return {
        name: 100 * median(report[name]["score"] for report in reports) for name in RATED_CATEGORIES
    }


if __name__ == "__main__":
    main()
