"""The page and a robot by Web Bluetooth: the browser's own emulation is the radio.

The emulation has no notifications, so a page of these tests reads what the robot says; whoever
reads in a browser gets the event of a notification.
"""

from __future__ import annotations

import base64
import os
import select
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from tests.studio.test_page_link import said
from tests.support import studio
from tests.support.command import FOREVER
from tests.support.pty_robot import PtyRobot
from tests.support.studio import checked, write
from tiniscript import robots

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright

WITH_BLUETOOTH = "--enable-features=WebBluetooth"  # Chromium for Linux has it off
ADDRESS = "09:09:09:09:09:09"
NORDIC = "6e400001-b5a3-f393-e0a9-e50e24dcca9e"
HM10 = "0000ffe0-0000-1000-8000-00805f9b34fb"
READ_INSTEAD = """
BluetoothRemoteGATTCharacteristic.prototype.startNotifications = async function () {
  const read = () => this.readValue().then(() => setTimeout(read, 30), () => setTimeout(read, 60));
  read();
  return this;
};
"""


class Radio:
    """A robot with a Bluetooth module: the browser asks it by CDP."""

    def __init__(self, browser: Browser, page: Page, robot: PtyRobot, service: str) -> None:
        self.writes: list[int] = []  # lengths
        self._service = service
        self._made = False
        self._chosen = self._is_gone = False
        self._port = os.open(robot.port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self._whole = browser.new_browser_cdp_session()
        self._page = page.context.new_cdp_session(page)
        self._ask("enable", state="powered-on", leSupported=True)
        self._page.send("DeviceAccess.enable")
        self._ask("simulatePreconnectedPeripheral", address=ADDRESS, name="<b>TINI</b>",
                  manufacturerData=[], knownServiceUuids=[service])  # fmt: skip
        self._page.on("DeviceAccess.deviceRequestPrompted", self._choose)
        self._whole.on("BluetoothEmulation.gattOperationReceived", self._gatt)
        self._whole.on("BluetoothEmulation.characteristicOperationReceived", self._characteristic)

    def close(self) -> None:
        self._ask("disable")
        os.close(self._port)

    def go_away(self) -> None:
        self._is_gone = True
        self._ask("simulateGATTDisconnection", address=ADDRESS)

    def _ask(self, what: str, **fields: Any) -> Any:
        return self._whole.send(f"BluetoothEmulation.{what}", fields)

    def _choose(self, prompt: Any) -> None:
        # The prompt comes twice; to answer it twice ends the browser.
        if prompt["devices"] and not self._chosen:
            self._chosen = True
            chosen = {"id": prompt["id"], "deviceId": prompt["devices"][0]["id"]}
            self._page.send("DeviceAccess.selectPrompt", chosen)

    def _gatt(self, asked: Any) -> None:
        if asked["type"] == "discovery" and not self._made:
            self._made = True
            made = self._ask("addService", address=ADDRESS, serviceUuid=self._service)
            for uuid, properties in self._characteristics():
                found = self._ask("addCharacteristic", serviceId=made["serviceId"],
                                  characteristicUuid=uuid, properties=properties)  # fmt: skip
                if "notify" in properties:
                    self._ask("addDescriptor", characteristicId=found["characteristicId"],
                              descriptorUuid="00002902-0000-1000-8000-00805f9b34fb")  # fmt: skip
        self._ask("simulateGATTOperationResponse", address=ADDRESS, type=asked["type"], code=0)

    def _characteristics(self) -> list[tuple[str, dict[str, bool]]]:
        to, back = {"write": True, "writeWithoutResponse": True}, {"notify": True, "read": True}
        if self._service == HM10:
            return [(HM10.replace("ffe0", "ffe1"), {**to, **back})]
        return [(NORDIC.replace("0001-b5", "0002-b5"), to),
                (NORDIC.replace("0001-b5", "0003-b5"), back)]  # fmt: skip

    def _characteristic(self, asked: Any) -> None:
        answer: dict[str, Any] = {}
        if asked["type"] == "write":
            data = base64.b64decode(asked["data"])
            self.writes.append(len(data))
            os.write(self._port, data)
            if asked.get("writeType") == "write-without-response":
                return
        elif asked["type"] == "read":
            ready = select.select([self._port], [], [], 0)[0]
            data = os.read(self._port, 20) if ready else b""
            answer = {"data": base64.b64encode(data).decode()}
        if self._is_gone:
            return
        self._ask("simulateCharacteristicOperationResponse",
                  characteristicId=asked["characteristicId"], type=asked["type"], code=0,
                  **answer)  # fmt: skip


@pytest.fixture(params=[NORDIC, HM10], ids=["nordic", "hm10"])
def met(
    playwright: Playwright, request: pytest.FixtureRequest
) -> Iterator[tuple[Page, PtyRobot, Radio]]:
    """A page that has met its robot by Bluetooth."""
    with (
        studio.served() as server,
        studio.browser(playwright, WITH_BLUETOOTH) as browser,
        PtyRobot(robots.load("tinibot").kit) as robot,
    ):
        context = browser.new_context(locale="en-US", service_workers="block")
        context.add_init_script(READ_INSTEAD)
        page = context.new_page()
        page.goto(server.address)
        checked(page)
        radio = Radio(browser, page, robot, request.param)
        page.click("#side_real")
        page.click("#link_bluetooth")
        said(page, "Connected: ")
        yield page, robot, radio
        radio.close()
        context.close()


def test_a_robot_is_driven_by_bluetooth(met: tuple[Page, PtyRobot, Radio]) -> None:
    page, robot, radio = met
    write(page, "SHOW(2.5);\n" + "F(0.1, 80);\n" * 20)
    page.click("#link_upload")
    said(page, "Done.")
    assert page.locator("#link_shown").inner_text() == "2.5"
    assert robot.did.count("MOTORS 80 80") >= 1
    assert max(radio.writes) == 20  # what every module takes
    write(page, FOREVER)
    page.click("#link_upload")
    said(page, "The robot has it")
    while not robot.moves:  # the radio is heard while the page is waited for
        page.wait_for_timeout(20)
    page.keyboard.press("Escape")
    said(page, "Stopped: the robot has confirmed it.")
    radio.go_away()
    said(page, "The Bluetooth connection has ended.")
