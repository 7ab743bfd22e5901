"""The page in WebKit's engine, which every browser of an iPad has: Debian's `webkit2gtk-driver`.

    python -m tools.webkit

Needs the packages `webkit2gtk-driver` and `xvfb`, the built page and the robot of the tests. It
acts as a pupil would; it has a mouse and keys, but no touch. It prints a row for each.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.support.command import FOREVER
from tests.support.pty_robot import PtyRobot
from tests.support.studio import serve_class, serve_page
from tiniscript import robots
from tiniscript.lessons import catalogue

Json = Any
DRIVER, X_SERVER = "WebKitWebDriver", "Xvfb"
PACKAGES = "webkit2gtk-driver xvfb"
TIMEOUT_S = 90.0
CONTROL, ENTER, DELETE = "\ue009", "\ue007", "\ue017"
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
EDITOR = "document.querySelector('#editor').shadowRoot.querySelector('.cm-content')"


class StepFailed(Exception):
    """A page has not reached the state that a step waits for."""


class Browser:
    """A session of WebKit's driver."""

    def __init__(self, port: int, binary: Path) -> None:
        self._base = f"http://127.0.0.1:{port}/session"
        options = {"binary": str(binary), "args": ["--automation"]}
        request = {"capabilities": {"alwaysMatch": {"webkitgtk:browserOptions": options}}}
        session = self._ask("POST", "", request)
        self.version = f"WebKitGTK {session['capabilities']['browserVersion']}"
        self._base += f"/{session['sessionId']}"

    def _ask(self, method: str, path: str, body: Json = None) -> Json:
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(self._base + path, data, method=method)
        with urllib.request.urlopen(request, timeout=TIMEOUT_S) as answer:
            return json.loads(answer.read())["value"]

    def open(self, address: str) -> None:
        self._ask("POST", "/url", {"url": address})

    def run(self, script: str, *values: Json) -> Json:
        return self._ask("POST", "/execute/sync", {"script": script, "args": list(values)})

    def wait_until(self, condition: str, what: str) -> None:
        end_s = time.monotonic() + TIMEOUT_S
        while not self.run(f"return Boolean({condition})"):
            if time.monotonic() > end_s:
                raise StepFailed(what)
            time.sleep(0.1)

    def wait_for_data(self, name: str, value: str) -> None:
        """Wait until the page says so of itself."""
        self.wait_until(
            f"document.documentElement.dataset['{name}'] === '{value}'", f"{name} {value}"
        )

    def click(self, selector: str) -> None:
        element = self._ask("POST", "/element", {"using": "css selector", "value": selector})
        self._ask("POST", f"/element/{element[ELEMENT]}/click", {})

    def type_keys(self, text: str, held_text: str = "") -> None:
        actions = [{"type": "keyDown", "value": held_text}] if held_text else []
        for sign in text:
            actions += [{"type": "keyDown", "value": sign}, {"type": "keyUp", "value": sign}]
        actions += [{"type": "keyUp", "value": held_text}] if held_text else []
        keys = [{"type": "key", "id": "keys", "actions": actions}]
        self._ask("POST", "/actions", {"actions": keys})

    def write(self, text: str) -> None:
        """Replace the program as a person does."""
        self.run(f"{EDITOR}.focus()")
        self.type_keys("a", CONTROL)
        self.type_keys(DELETE)
        self.type_keys(text.replace("\n", ENTER))
        self.wait_for_data("state", "checked")

    def fill(self, selector: str, which: int, text: str) -> None:
        self.run("document.querySelectorAll(arguments[0])[arguments[1]].focus()", selector, which)
        self.type_keys(text)

    def text(self, selector: str) -> str:
        return str(self.run("return document.querySelector(arguments[0]).innerText", selector))

    def close(self) -> None:
        self._ask("DELETE", "")


def open_page(page: Browser, address: str) -> None:
    page.open(address)
    page.wait_for_data("state", "checked")
    if page.run("return document.documentElement.dataset.screen") == "start":
        page.click("#start_write")
    page.click("#view_text")


def run_first_program(page: Browser) -> None:
    page.click("#run")
    page.wait_for_data("phase", "ended")


def make_mistake(page: Browser, language: str = "es") -> None:
    page.run(
        f"const it = document.querySelector('#language'); it.value = '{language}';"
        "it.dispatchEvent(new Event('change', {bubbles: true}))"
    )
    page.wait_until(f"document.documentElement.lang === '{language}'", language)
    page.write("F(2, 80)\nAVANZA\n")
    page.wait_until("/AVANZA/.test(document.querySelector('#messages').innerText)", "the message")


def solve_lesson(page: Browser) -> None:
    folder = catalogue.folders()[0]
    page.click("#side_lessons")
    page.wait_until("document.querySelector('#lesson:enabled')", "the lessons")
    page.run(
        "const it = document.querySelector('#lesson'); it.value = '1';"
        "it.dispatchEvent(new Event('change', {bubbles: true}))"
    )
    page.wait_until("document.querySelector('#lesson_page[data-lesson=\"1\"]')", "the first lesson")
    page.write(catalogue.answers(folder)[0][0].program)
    page.run("[...document.querySelectorAll('#lesson_steps button')].at(-1).click()")
    page.wait_until("document.querySelector('#lesson_check:enabled')", "its task")
    page.click("#lesson_check")
    page.wait_until("document.querySelector('#lesson_said[data-verdict]')", "its verdict")
    if page.run("return document.querySelector('#lesson_said').dataset.verdict") != "passed":
        raise StepFailed(page.text("#lesson_said"))


def join_class(page: Browser, address: str, code: str) -> None:
    open_page(page, address)
    page.click("#side_real")
    page.fill("#class_pupil input", 0, code)
    page.fill("#class_pupil input", 1, "Ana")
    page.click("[data-text=class_join]")
    page.wait_for_data("pupil", "class_in")


def join_group(page: Browser, add_line: Callable[[], None], has_row: Callable[[str], bool]) -> None:
    page.write("F(1, 80)\nS\n")
    page.click("#side_class")
    page.fill("#class_group input", 0, "Red")
    page.click("[data-text=group_join]")
    page.wait_for_data("group", "in")
    page.run(f"{EDITOR}.focus()")
    page.type_keys("\ue010", CONTROL)  # the end of the text
    page.type_keys(f"W(2){ENTER}")
    end_s = time.monotonic() + TIMEOUT_S
    while not has_row("W(2);"):
        if time.monotonic() > end_s:
            raise StepFailed("the class has the line")
        time.sleep(0.1)
    add_line()
    page.wait_until(f"{EDITOR}.innerText.includes('BEEP(1, 440)')", "the line of another pupil")


def stop_robot(page: Browser, robot: PtyRobot) -> None:
    page.click("#side_real")
    page.click("[data-text=class_ask]")
    page.wait_for_data("robot", "connected")
    page.write(FOREVER + "\n")
    page.click("#link_upload")
    robot.until(lambda: robot.moves, "it drives")
    page.click("#stop")
    robot.until(lambda: not robot.moves, "it stands")


@contextmanager
def browsers() -> Iterator[Callable[[], Browser]]:
    """Yield a function that opens a browser on a virtual screen."""
    binary = next(Path("/usr/lib").glob("*/webkit2gtk-4.*/MiniBrowser"), None)
    if binary is None or not shutil.which(DRIVER) or not shutil.which(X_SERVER):
        sys.exit(f"webkit: apt-get install {PACKAGES}")
    with tempfile.TemporaryDirectory() as home, socket.socket() as free_socket:
        free_socket.bind(("127.0.0.1", 0))
        port = free_socket.getsockname()[1]
        free_socket.close()
        screen = subprocess.Popen(
            [X_SERVER, "-displayfd", "1", "-screen", "0", "1400x900x24"], stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert screen.stdout is not None
        number = screen.stdout.readline().strip()
        env = {**os.environ, "DISPLAY": f":{number}", "HOME": home, "XDG_RUNTIME_DIR": home,
               "LIBGL_ALWAYS_SOFTWARE": "1"}  # fmt: skip
        driver = subprocess.Popen([DRIVER, f"--port={port}"], env=env)
        try:
            time.sleep(1)
            yield lambda: Browser(port, binary)
        finally:
            driver.terminate()
            screen.terminate()
            driver.wait()
            screen.wait()


def main() -> int:
    failed_count = 0

    def step(name: str, run_step: Callable[[], None]) -> None:
        nonlocal failed_count
        began_s = time.monotonic()
        try:
            run_step()
            outcome = "works"
        except (StepFailed, OSError, AssertionError) as error:
            outcome, failed_count = f"FAILS: {error}", failed_count + 1
        print(f"{name:32} {outcome}  ({time.monotonic() - began_s:.1f} s)", flush=True)

    with browsers() as open_browser:
        page = open_browser()
        print(page.version)
        with serve_page() as server:
            step("opens and compiles", lambda: open_page(page, server.address))
            step("the first minute", lambda: run_first_program(page))
            step("a mistake, in Spanish", lambda: make_mistake(page))
            step("a lesson", lambda: solve_lesson(page))
            interfaces = "['serial', 'bluetooth']"
            missing_interfaces = page.run(
                f"return {interfaces}.filter((each) => !(each in navigator))"
            )
            print(f"{'lacks':32} {', '.join(missing_interfaces)}")
        with (
            PtyRobot(robots.load("tinibot").kit) as robot,
            serve_class([robot.port]) as served_class,
        ):
            classroom = served_class.room

            def add_line() -> None:
                member_answer = classroom.answer(
                    "", "luz", {"do": "join", "code": classroom.code, "name": "Luz"}
                )
                token = member_answer["token"]
                group_answer = classroom.answer(
                    token, "luz", {"do": "group_join", "name": "Red", "text": ""}
                )
                nodes = [{"id": f"{group_answer['page']}.1", "text": "BEEP(1, 440)"}]
                ops = [{"do": "insert", "at": ["root", ""], "nodes": nodes}]
                change = {"uid": f"{group_answer['page']}:1", "ops": ops}
                fields = {"page": group_answer["page"], "since": -1, "epoch": ""}
                classroom.answer(token, "luz", {"do": "group", **fields, "changes": [change]})

            def has_row(row: str) -> bool:
                groups = classroom.teach({"do": "class"})["groups"]
                text = classroom.teach({"do": "class_text", "group": groups[0]["key"]})["text"]
                return row in text

            step("a class", lambda: join_class(page, served_class.server.address, classroom.code))
            step("a group", lambda: join_group(page, add_line, has_row))
            step("STOP", lambda: stop_robot(page, robot))
        page.close()
    return failed_count > 0


if __name__ == "__main__":
    sys.exit(main())
