"""The time to show a place on the studio's time line: `python -m tools.bench.time_line`.

A run of ten minutes, at twenty times the speed, in the system's Chromium; then random places on its
line. A place is shown once the page's main thread has finished the work for its next picture: the
time until then, times four, is that of a processor four times as slow. The cost of measuring is
left out, and other work on this computer changes nothing.
"""

from __future__ import annotations

import sys
from statistics import median, quantiles
from typing import TYPE_CHECKING

from tests.support import studio
from tests.support.studio import wait_for_phase, write
from tiniscript.studio import serving
from tools.bench import page as figures
from tools.bench.studio import CPU_THROTTLING

if TYPE_CHECKING:
    from playwright.sync_api import CDPSession, Page

RUN_S = 600
PLACE_COUNT = 200
MAX_MS = 16
ROWS = (f"median, 95 of 100, and the slowest of {PLACE_COUNT}",)
# Its inputs, outputs and decisions change all the time; it has three tasks and a sound.
PROGRAM = f"""SI|N = 0
TASK; LOOP(FOREVER); SHOW(DISTANCE); W(0.5); END_LOOP; END_TASK
TASK; LOOP(FOREVER); BEEP(0.1, 440); W(2); END_LOOP; END_TASK
WHEN(DISTANCE < 20); B(0.3, 60); R(0.4, 60); N = N + 1; END_WHEN
LOOP({RUN_S})
F(0.5, 70)
L(0.3, 40)
S; W(0.2)
END_LOOP
"""
LOOK_SCRIPT = """(place) => new Promise((resolve) => {
  if (place !== null) {
    const { min, max } = time_at;
    time_at.value = String(Number(min) + place * (Number(max) - Number(min)));
    time_at.dispatchEvent(new Event('input', { bubbles: true }));
  }
  requestAnimationFrame(() => setTimeout(resolve));
})"""
DURATION_SCRIPT = "() => (time_at.max - time_at.min) / 1000"
POLL_INTERVAL_MS = 500
GOLDEN_RATIO = 0.618034


def measure(page: Page, run_s: int, place_count: int) -> tuple[list[float], float]:
    """Return the milliseconds for each place, and the length of the run in seconds."""
    page.click("#view_text")
    write(page, PROGRAM.replace(f"LOOP({RUN_S})", f"LOOP({run_s})"))
    page.select_option("#speed", "20")
    page.click("#run")
    wait_for_phase(page, "running")
    while page.evaluate(DURATION_SCRIPT) < run_s:
        page.wait_for_timeout(POLL_INTERVAL_MS)
    page.click("#stop")
    wait_for_phase(page, "ended")
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def work_of_place_ms(place: float | None) -> float:
        before_s = _task_s(session)
        page.evaluate(LOOK_SCRIPT, place)
        return 1000 * (_task_s(session) - before_s)

    asking_ms = median(work_of_place_ms(None) for _ in range(place_count))
    work_of_place_ms(0)
    times_ms = [
        work_of_place_ms((GOLDEN_RATIO * k) % 1) - asking_ms for k in range(place_count)
    ]  # here and there
    return [CPU_THROTTLING * ms for ms in times_ms], page.evaluate(DURATION_SCRIPT)


def _task_s(session: CDPSession) -> float:
    """Return the working time of the page's main thread."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return next(float(metric["value"]) for metric in metrics if metric["name"] == "TaskDuration")


def main() -> int:
    with (
        studio.driver() as playwright,
        studio.browser(playwright, is_whole=True) as browser,
        studio.serve_page(serving.files()) as server,
    ):
        pages = studio.Pages(browser, server.address, patience_s=2 * RUN_S)
        times_ms, _ = measure(pages.open(), RUN_S, PLACE_COUNT)
        pages.close()
    slow_ms = quantiles(times_ms, n=20)[-1]
    times_text = f"{median(times_ms):.1f}, {slow_ms:.1f}, {max(times_ms):.1f} ms"
    figures.show("time_line", [[*ROWS, times_text, f"{MAX_MS} ms"]])
    return int(slow_ms > MAX_MS)


if __name__ == "__main__":
    sys.exit(main())
