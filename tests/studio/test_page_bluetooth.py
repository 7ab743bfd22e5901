"""The page and a robot by Web Bluetooth: the browser's own emulation is the radio.

The emulation has no notifications, so a page of these tests reads the robot's output; a reader in a
browser gets the event of a notification. The robot's clock advances while the page reads, and waits
for a page that is slow on a busy computer.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support import studio
from tests.support.command import FOREVER
from tests.support.page_link import wait_for_message
from tests.support.pty_robot import drives_now
from tests.support.studio import enter, write
from tiniscript import robots

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright

BLUETOOTH_OPTION = "--enable-features=WebBluetooth"  # Chromium for Linux has it off
ADDRESS = "09:09:09:09:09:09"
NORDIC = "6e400001-b5a3-f393-e0a9-e50e24dcca9e"
HM10 = "0000ffe0-0000-1000-8000-00805f9b34fb"
MAX_WRITE_BYTES = 20  # bytes that every module accepts
READ_MS = 30
SILENT_MS = 300  # a robot stops after a silence of 500
READ_SCRIPT = f"""
BluetoothRemoteGATTCharacteristic.prototype.startNotifications = async function () {{
  globalThis.isDeaf = false;
  const read = () => {{
    if (isDeaf) return;
    globalThis.reading = this.readValue().then(
      () => setTimeout(read, {READ_MS}), () => setTimeout(read, {2 * READ_MS}));
  }};
  read();
  return this;
}};
"""


class Radio:
    """A robot with a Bluetooth module: the browser asks it by CDP."""

    def __init__(self, browser: Browser, page: Page, service: str) -> None:
        self.write_sizes: list[int] = []  # lengths
        self.robot = HostFirmware(robots.load("tinibot").kit)
        self._service = service
        self._has_connected = self._has_chosen = False
        self._to_robot, self._to_page = b"", b""  # bytes under way in each direction
        self._silent_ms = 0
        self._emulated_page = page
        self._browser_session = browser.new_browser_cdp_session()
        self._page = page.context.new_cdp_session(page)
        self._ask("enable", state="powered-on", leSupported=True)
        self._page.send("DeviceAccess.enable")
        self._ask("simulatePreconnectedPeripheral", address=ADDRESS, name="<b>TINI</b>",
                  manufacturerData=[], knownServiceUuids=[service])  # fmt: skip
        self._page.on("DeviceAccess.deviceRequestPrompted", self._choose)
        self._browser_session.on(
            "BluetoothEmulation.gattOperationReceived", self._answer_gatt_operation
        )
        self._browser_session.on(
            "BluetoothEmulation.characteristicOperationReceived",
            self._answer_characteristic_operation,
        )

    def close(self) -> None:
        self._ask("disable")
        self.robot.close()

    @property
    def actions(self) -> list[str]:
        """The robot's actions without the times."""
        return [line.split(" ", 1)[1] for line in self.robot.did]

    def go_away(self) -> None:
        # The emulation never reports the loss of a device that has an unanswered read.
        self._emulated_page.evaluate("async () => { isDeaf = true; await reading; }")
        self._ask("simulateGATTDisconnection", address=ADDRESS)

    def _ask(self, command: str, **fields: Any) -> Any:
        return self._browser_session.send(f"BluetoothEmulation.{command}", fields)

    def _choose(self, prompt: Any) -> None:
        # The prompt comes twice; a second answer ends the browser.
        if prompt["devices"] and not self._has_chosen:
            self._has_chosen = True
            selection = {"id": prompt["id"], "deviceId": prompt["devices"][0]["id"]}
            self._page.send("DeviceAccess.selectPrompt", selection)

    def _answer_gatt_operation(self, request: Any) -> None:
        if request["type"] == "discovery" and not self._has_connected:
            self._has_connected = True
            service = self._ask("addService", address=ADDRESS, serviceUuid=self._service)
            for uuid, properties in self._characteristics():
                characteristic = self._ask("addCharacteristic", serviceId=service["serviceId"],
                                  characteristicUuid=uuid, properties=properties)  # fmt: skip
                if "notify" in properties:
                    self._ask("addDescriptor", characteristicId=characteristic["characteristicId"],
                              descriptorUuid="00002902-0000-1000-8000-00805f9b34fb")  # fmt: skip
        self._ask("simulateGATTOperationResponse", address=ADDRESS, type=request["type"], code=0)

    def _characteristics(self) -> list[tuple[str, dict[str, bool]]]:
        to_robot = {"write": True, "writeWithoutResponse": True}
        to_computer = {"notify": True, "read": True}
        if self._service == HM10:
            return [(HM10.replace("ffe0", "ffe1"), {**to_robot, **to_computer})]
        return [(NORDIC.replace("0001-b5", "0002-b5"), to_robot),
                (NORDIC.replace("0001-b5", "0003-b5"), to_computer)]  # fmt: skip

    def _answer_characteristic_operation(self, request: Any) -> None:
        answer: dict[str, Any] = {}
        if request["type"] == "write":
            data = base64.b64decode(request["data"])
            self.write_sizes.append(len(data))
            self._to_robot += data
            if request.get("writeType") == "write-without-response":
                return
        elif request["type"] == "read":
            data = self._read_robot()
            answer = {"data": base64.b64encode(data).decode()}
        self._ask("simulateCharacteristicOperationResponse",
                  characteristicId=request["characteristicId"], type=request["type"], code=0,
                  **answer)  # fmt: skip

    def _read_robot(self) -> bytes:
        """Advance the robot's time, and return its output in one read."""
        passes_ms = READ_MS if self._to_robot else min(READ_MS, SILENT_MS - self._silent_ms)
        self._silent_ms = 0 if self._to_robot else self._silent_ms + passes_ms
        if passes_ms:
            self._to_page += self.robot.wait(passes_ms, self._to_robot)
        self._to_robot = b""
        heard_bytes, self._to_page = (
            self._to_page[:MAX_WRITE_BYTES],
            self._to_page[MAX_WRITE_BYTES:],
        )
        return heard_bytes


@pytest.fixture(scope="module")
def radio_page(playwright: Playwright) -> Iterator[tuple[Browser, Page]]:
    with studio.serve_page() as server, studio.browser(playwright, BLUETOOTH_OPTION) as browser:
        context = browser.new_context(locale="en-US", service_workers="block")
        context.add_init_script(READ_SCRIPT)
        page = context.new_page()
        enter(page, server.address)
        page.click("#side_real")
        yield browser, page
        context.close()


@pytest.mark.sampled("service")
@pytest.mark.parametrize("service", [NORDIC, HM10], ids=["nordic", "hm10"])
def test_a_robot_is_driven_by_bluetooth(radio_page: tuple[Browser, Page], service: str) -> None:
    browser, page = radio_page
    with closing(Radio(browser, page, service)) as radio:
        page.click("#link_bluetooth")
        wait_for_message(page, "Connected: ")
        write(page, "SHOW(2.5);\n" + "F(0.1, 80);\n" * 20)
        page.click("#link_upload")
        wait_for_message(page, "Done.")
        assert page.locator("#link_shown").inner_text() == "2.5"
        assert radio.actions.count("MOTORS 80 80") >= 1
        assert max(radio.write_sizes) == MAX_WRITE_BYTES
        write(page, FOREVER)
        page.click("#link_upload")
        wait_for_message(page, "The robot has the program")
        while not drives_now(radio.actions):  # the radio is heard while the page is waited for
            page.wait_for_timeout(20)
        page.keyboard.press("Escape")
        wait_for_message(page, "Stopped: the robot has confirmed the stop.")
        assert not drives_now(radio.actions)
        radio.go_away()
        wait_for_message(page, "The Bluetooth connection was lost. The")
