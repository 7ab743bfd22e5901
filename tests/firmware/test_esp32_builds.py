"""The ESP32 sources compile with cores 2 and 3, and for the chips' instruction sets.

No file here is Espressif's: our own headers replace theirs, and `signatures.cpp` pins these.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.machines.esp32 import HAS_TLS, STAND_INS_FOLDER, flags_of
from tests.machines.host import SOURCES, missing
from tests.support.cpp_sources import code_of
from tests.support.esp32_builds import BOARD, complaints
from tiniscript import robots
from tiniscript.robots import firmware
from tiniscript.robots.ports import ESP32S
from tools.builds.chips import CHIPS, Chip, compile_one
from tools.builds.chips import missing_reason as no_compiler

CODE = [
    *sorted(BOARD.glob("*.cpp")),
    *sorted((BOARD / "esp32").glob("*.cpp")),
    SOURCES / "src" / "main.cpp",
    STAND_INS_FOLDER / "signatures.cpp",
]
ISA = {"esp32dev": "lx6", "esp32c3": "rv32imc"}
needs_host = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")


@needs_host
@pytest.mark.sampled("chip")
@pytest.mark.parametrize("standard", ["gnu++11", "gnu++23"])
@pytest.mark.parametrize("major", [2, 3])
@pytest.mark.parametrize("chip", sorted(ESP32S))
def test_the_sketch_compiles_for_both_cores(chip: str, major: int, standard: str) -> None:
    """The board, file by file: the modules that know no board are compiled elsewhere."""
    for path in CODE:
        assert complaints(path, *flags_of(chip, major), standard=standard) == ""


@needs_host
@pytest.mark.skipif(not HAS_TLS, reason="needs libmbedtls-dev")
def test_the_used_tls_functions_exist_in_mbedtls() -> None:
    """Debian's headers: in version 12 those of 2.28, as in ESP-IDF 4.4."""
    flags, file = flags_of("esp32dev", 2), STAND_INS_FOLDER / "signatures.cpp"
    command = ["g++", "-std=gnu++11", *flags, "-dM", "-E", str(file)]
    macros = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "tiniscript_no_mbedtls" not in macros and "MBEDTLS_SSL_MAX_HOST_NAME_LEN" in macros
    assert complaints(file, *flags) == ""


@needs_host
@pytest.mark.parametrize("major", [2, 3])
def test_a_chip_with_its_own_usb_uses_it_as_the_port(major: int) -> None:
    """A board of an ESP32-C3 without a USB chip: `Serial` is a HWCDC there."""
    flags = (*flags_of("esp32c3", major), "-DARDUINO_USB_CDC_ON_BOOT=1", "-DARDUINO_USB_MODE=1")
    assert complaints(BOARD / "esp32" / "serial.cpp", *flags) == ""


@needs_host
@pytest.mark.parametrize("pin", [18, 19])
@pytest.mark.parametrize("part", ["Pwm kBuzzer = {{7", "Pin kStartButton = {8"])
def test_a_header_that_occupies_the_port_is_refused(part: str, pin: int, tmp_path: Path) -> None:
    """A header from before `tsc firmware --board` refused these pins."""
    header = firmware.header([robots.load("tinibotc3")], "a test.")
    assert part in header
    own_header = tmp_path / "own.h"
    own_header.write_text(header.replace(part, f"{part[:-1]}{pin}"), encoding="utf-8")
    flags = (*flags_of("esp32c3", 2), "-DARDUINO_USB_MODE=1", f'-Dtiniscript_own="{own_header}"')
    file = BOARD / "esp32" / "serial.cpp"
    errors = complaints(file, *flags, "-DARDUINO_USB_CDC_ON_BOOT=1")
    assert "error" in errors and "Pins 18 and 19 are the USB of an ESP32-C3" in errors
    assert complaints(file, *flags) == "", "a board with a USB chip has them free"


@needs_host
def test_a_core_with_different_bluetooth_is_refused() -> None:
    """Arduino's core 3.3 has NimBLE on an ESP32-C3, which delivers written data late."""
    flags = (*flags_of("esp32c3", 3), "-DCONFIG_NIMBLE_ENABLED")
    errors = complaints(BOARD / "esp32" / "low_energy.cpp", *flags)
    assert "error" in errors and "wants the core esp32 2.0.17 to 3.2" in errors.splitlines()[0]


# Static RAM of the sketch without Espressif's libraries: those and their radios take about 45 K of
# an ESP32-C3's RAM, and TLS 40.
MAX_RAM = 48 * 1024


def ram_of(isa: Chip, file: str) -> int:
    """Return the bytes of data and bss of a file."""
    output = subprocess.run([isa.measurer, file], capture_output=True, text=True, check=True).stdout
    _, data, bss = map(int, output.splitlines()[1].split()[:3])
    return data + bss


# The parts of the core and of the compiler's library that the sketch uses.
CORE = {
    "analogRead", "analogReadResolution", "attachInterrupt", "esp_reset_reason",
    "esp_rom_gpio_connect_out_signal", "esp_task_wdt_add", "esp_task_wdt_init",
    "esp_task_wdt_reset", "esp_timer_create", "esp_timer_start_periodic", "gpio_get_level",
    "calloc", "gpio_intr_disable", "gpio_intr_enable", "ledcWrite", "nvs_close",
    "simulated_register",
    "micros", "millis", "nvs_commit", "nvs_get_blob", "nvs_get_u32", "nvs_open", "nvs_set_blob",
    "nvs_set_u32", "pinMode", "Serial", "simulated_enter_critical", "simulated_exit_critical",
    "lwip_accept", "lwip_bind", "lwip_close", "lwip_connect", "lwip_fcntl", "lwip_htonl",
    "lwip_htons", "lwip_listen", "lwip_recv", "lwip_send", "lwip_setsockopt", "lwip_socket",
    "vTaskDelay", "xTaskCreatePinnedToCore", "WiFi", "MDNS", "__errno",
    "esp_ble_gatts_send_indicate", "uart_enable_intr_mask",
    "ESP", "esp_log_level_set",
    "esp_random", "lwip_gethostbyname", "mbedtls_ssl_conf_authmode", "mbedtls_ssl_conf_ca_chain",
    "mbedtls_ssl_conf_rng", "mbedtls_ssl_conf_verify", "mbedtls_ssl_config_defaults",
    "mbedtls_ssl_config_free", "mbedtls_ssl_config_init", "mbedtls_ssl_free",
    "mbedtls_ssl_handshake_step", "mbedtls_ssl_init", "mbedtls_ssl_read", "mbedtls_ssl_set_bio",
    "mbedtls_ssl_set_hostname", "mbedtls_ssl_setup", "mbedtls_ssl_write",
    "mbedtls_x509_crt_free", "mbedtls_x509_crt_init", "mbedtls_x509_crt_parse_der",
}  # fmt: skip
# Classes of the radios' libraries, and their counterparts in the compiler's library.
RADIO = re.compile(
    r"_Z(TV|TI|TS)?(NK?)?\d+(BLE\w+|BluetoothSerial|WiFiClass|MDNSResponder|String|IPAddress|EspClass)\w*"
)
OF_CLASSES = {"_ZdlPv", "_ZdlPvj", "__cxa_guard_acquire", "__cxa_guard_release", "__cxa_atexit",
              "__dso_handle", "atexit", "__cxa_pure_virtual"}  # fmt: skip
OF_VERSION = {2: {"ledcSetup", "ledcAttachPin", "esp_task_wdt_delete",
                  "xTaskGetIdleTaskHandleForCPU", "mbedtls_ssl_conf_min_version",
                  "__real_esp_panic_handler"},
              3: {"ledcAttachChannel", "ledcChangeFrequency", "esp_task_wdt_reconfigure",
                  "set_arduino_panic_handler"}}  # fmt: skip
SERIAL = {"begin", "onReceiveError", "setRxBufferSize", "setTxBufferSize", "available",
          "availableForWrite", "read", "write"}  # fmt: skip
LIBRARY = re.compile(r"__\w+(si|di|sf|df)[234]?\d*|mem(cpy|set|cmp|move)|__\w*div\w*|__\w*mod\w*")


@pytest.mark.long
@pytest.mark.sampled("chip", "major")
@pytest.mark.parametrize("major", [2, 3])
@pytest.mark.parametrize("chip", sorted(ESP32S))
def test_the_whole_sketch_links_with_only_the_core(chip: str, major: int, tmp_path: Path) -> None:
    """With compilers for both instruction sets, only names of the core stay unresolved."""
    isa = CHIPS[ISA[chip]]
    if no_compiler(isa):
        pytest.skip(no_compiler(isa))
    cpp_paths = [
        path for path in sorted((SOURCES / "src").rglob("*.cpp")) if "avr" not in path.parts
    ]
    flags = ("-Wall", "-Wextra", "-Werror", "-ffreestanding", *flags_of(chip, major))
    objects: list[str] = []
    for path in cpp_paths:
        objects.append(str(tmp_path / f"{len(objects)}.o"))
        compile_one(isa, path, objects[-1], flags)
    object_path = str(tmp_path / "whole.o")
    subprocess.run([*isa.linker, "-r", *objects, "-o", object_path], check=True)
    assert ram_of(isa, object_path) <= MAX_RAM, "the radios need the rest"
    nm = isa.measurer.replace("-size", "-nm")
    output = subprocess.run(
        [nm, "-u", object_path], capture_output=True, text=True, check=True
    ).stdout
    symbols = {line.split()[-1] for line in output.splitlines()}
    serial = {name for name in symbols if "HardwareSerial" in name}
    assert all(any(word in name for word in SERIAL) for name in serial)
    radio = {name for name in symbols if RADIO.fullmatch(name)} | OF_CLASSES
    unknown = {name for name in symbols - serial - radio if not LIBRARY.fullmatch(name)}
    assert unknown == CORE | OF_VERSION[major] | {"setup", "loop", "esp_spp_disconnect"} & unknown


def test_every_file_states_its_chip() -> None:
    """The Arduino IDE compiles all files for any board: those of other families are empty."""
    for folder, condition in (("avr", "__AVR__"), ("esp32", "ARDUINO_ARCH_ESP32")):
        for path in (BOARD / folder).glob("*.cpp"):
            code = code_of(path).split("\n")
            lines = [line for line in code if line.strip()]
            assert lines[0].strip() == f"#ifdef {condition}", path.name
            assert lines[-1].strip() == "#endif", path.name


def test_our_macros_come_after_the_headers_of_the_core() -> None:
    """Each has our prefix, so none collides with the core's."""
    for path in sorted((BOARD / "esp32").glob("*.*")):
        text = path.read_text(encoding="utf-8")
        defined_names = re.findall(r"^ *#define ([a-z]\w*)", text, flags=re.M)
        assert all(name.startswith("tini") for name in defined_names), path.name
        for name in defined_names:
            assert text.index(f"#define {name}") > text.rindex("#include <"), path.name


def test_the_firmware_never_blocks() -> None:
    """The tasks of radios are the exception: they wait for their radio, and delay no one else."""
    waiting = {"delay", "delayMicroseconds", "pulseIn", "vTaskDelay", "new", "malloc", "flush"}
    waiting_calls = {}
    for path in sorted((BOARD / "esp32").glob("*.*")):
        waiting_calls[path.name] = waiting & set(re.findall(r"\w+", code_of(path)))
    assert waiting_calls.pop("radio.cpp") == {"vTaskDelay"}
    assert not any(waiting_calls.values()), waiting_calls


def test_the_settings_need_no_registry_of_libraries() -> None:
    text = (SOURCES / "platformio.ini").read_text(encoding="utf-8")
    for row in ("[env:esp32dev]", "[env:esp32c3]", "board = esp32-c3-devkitm-1",
                "platform = espressif32 @ 6.13.0",
                "board_build.partitions = partitions.csv"):  # fmt: skip
        assert row in text
    assert "lib_deps" not in text


def test_the_required_partition_menu_of_the_arduino_ide_is_named() -> None:
    """The IDE takes our partitions, and compares with the size of its menu's."""
    rows = [
        [field.strip() for field in line.split(",")]
        for line in (SOURCES / "partitions.csv").read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    ]
    sizes = {int(size, 0) for _, kind, _, _, size in rows if kind == "app"}
    assert sizes == {1_966_080}
    page = (SOURCES.parent / "docs" / "develop" / "esp32.md").read_text(encoding="utf-8")
    assert "*Minimal SPIFFS*" in page and "1,966,080" in page and "1,310,720" in page
    settings = (SOURCES / "platformio.ini").read_text(encoding="utf-8")
    assert "whatever its menu says" not in settings and "Minimal SPIFFS" in settings
