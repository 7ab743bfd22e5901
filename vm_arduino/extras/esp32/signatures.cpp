// Pins the signatures that the firmware relies on to those of the real cores.
//
// Compiled with the stand-ins in `core/` for versions 2 and 3, and with the real headers where they
// are: `pio run` with `build_src_filter = +<../extras/esp32/signatures.cpp>`.

#include <Arduino.h>
#include <driver/gpio.h>
#include <esp_rom_gpio.h>
#include <esp_system.h>
#include <esp_task_wdt.h>
#include <esp_timer.h>
#include <nvs.h>
#include <soc/gpio_sig_map.h>

#include <type_traits>

#define is_a(what, ...) static_assert(std::is_same<decltype(what), __VA_ARGS__>::value, #what)

#if ESP_ARDUINO_VERSION_MAJOR >= 3
// cores/esp32/esp32-hal-ledc.h of 3.0.4: the first argument is the pin
is_a(&ledcWrite, bool (*)(uint8_t, uint32_t));
is_a(&ledcWriteTone, uint32_t (*)(uint8_t, uint32_t));
is_a(ledcAttachChannel(uint8_t{}, uint32_t{}, uint8_t{}, 0), bool);
// components/esp_system/include/esp_task_wdt.h of ESP-IDF 5.1
is_a(&esp_task_wdt_init, esp_err_t (*)(const esp_task_wdt_config_t*));
is_a(&esp_task_wdt_reconfigure, esp_err_t (*)(const esp_task_wdt_config_t*));
#else
#undef ledcAttachPin
// cores/esp32/esp32-hal-ledc.h of 2.0.17: the first argument is the channel
is_a(&ledcSetup, uint32_t (*)(uint8_t, uint32_t, uint8_t));
is_a(&ledcAttachPin, void (*)(uint8_t, uint8_t));
is_a(&ledcWrite, void (*)(uint8_t, uint32_t));
is_a(&ledcWriteTone, uint32_t (*)(uint8_t, uint32_t));
// components/esp_system/include/esp_task_wdt.h of ESP-IDF 4.4
is_a(&esp_task_wdt_init, esp_err_t (*)(uint32_t, bool));
#endif

// cores/esp32/esp32-hal-gpio.h and esp32-hal-adc.h, of both versions
#undef analogRead
is_a(&pinMode, void (*)(uint8_t, uint8_t));
is_a(&attachInterrupt, void (*)(uint8_t, void (*)(void), int));
is_a(&analogRead, uint16_t (*)(uint8_t));
is_a(&analogReadResolution, void (*)(uint8_t));
// cores/esp32/esp32-hal.h
is_a(&millis, unsigned long (*)());
is_a(&micros, unsigned long (*)());
// cores/esp32/HardwareSerial.h
is_a(&HardwareSerial::onReceiveError, void (HardwareSerial::*)(OnReceiveErrorCb));
is_a(&HardwareSerial::setRxBufferSize, size_t (HardwareSerial::*)(size_t));
is_a(&HardwareSerial::setTxBufferSize, size_t (HardwareSerial::*)(size_t));
is_a(Serial.available(), int);
is_a(Serial.availableForWrite(), int);
is_a(Serial.read(), int);
is_a(Serial.write(uint8_t{}), size_t);

// ESP-IDF 4.4 and 5.1: driver/gpio.h, esp_rom_gpio.h, esp_system.h, esp_timer.h, nvs.h
is_a(&gpio_set_level, esp_err_t (*)(gpio_num_t, uint32_t));
is_a(&gpio_get_level, int (*)(gpio_num_t));
is_a(&gpio_intr_enable, esp_err_t (*)(gpio_num_t));
is_a(&gpio_intr_disable, esp_err_t (*)(gpio_num_t));
is_a(&esp_rom_gpio_connect_out_signal, void (*)(uint32_t, uint32_t, bool, bool));
is_a(&esp_reset_reason, esp_reset_reason_t (*)());
is_a(&esp_task_wdt_reset, esp_err_t (*)());
is_a(&esp_timer_create, esp_err_t (*)(const esp_timer_create_args_t*, esp_timer_handle_t*));
is_a(&esp_timer_start_periodic, esp_err_t (*)(esp_timer_handle_t, uint64_t));
is_a(&nvs_get_u32, esp_err_t (*)(nvs_handle_t, const char*, uint32_t*));
is_a(&nvs_set_u32, esp_err_t (*)(nvs_handle_t, const char*, uint32_t));
is_a(&nvs_get_blob, esp_err_t (*)(nvs_handle_t, const char*, void*, size_t*));
is_a(&nvs_set_blob, esp_err_t (*)(nvs_handle_t, const char*, const void*, size_t));
is_a(&nvs_commit, esp_err_t (*)(nvs_handle_t));
is_a(&nvs_open, esp_err_t (*)(const char*, nvs_open_mode_t, nvs_handle_t*));

static_assert(SIG_GPIO_OUT_IDX == 256 || SIG_GPIO_OUT_IDX == 128, "an ESP32, or an ESP32-C3");
