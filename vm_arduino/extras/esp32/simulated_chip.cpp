#include "simulated_chip.h"

#include <driver/uart.h>
#include <esp_random.h>
#include <esp_rom_gpio.h>
#include <esp_task_wdt.h>
#include <esp_timer.h>
#include <nvs.h>
#include <soc/gpio_reg.h>
#include <soc/gpio_sig_map.h>
#include <soc/soc.h>
#include <soc/uart_reg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mutex>

#include "simulated_tasks.h"
#include "simulated_timer.h"

SimulatedChip chip;
#ifndef ARDUINO_USB_CDC_ON_BOOT
HardwareSerial Serial;
#endif
uint64_t (*next_task_us)();
void (*run_tasks)();

// Where the linker put them; nothing, if a program has none.
extern char __start_rtc_noinit[] __attribute__((weak));
extern char __stop_rtc_noinit[] __attribute__((weak));

namespace {

constexpr uint64_t kNever = ~uint64_t{0};
constexpr uint32_t kEchoBeginsUs = 450;
constexpr size_t kFifoBytes = 128;
constexpr size_t kRingBytes = 32;
constexpr uint32_t kNextPort = 0xc;  // from a register of pins 0 to 31 to that of the others
constexpr int kMaxHandles = 4;  // of NVS: the store's, and one that is just used

// Pins, as components/soc/CHIP/include/soc/soc_caps.h has them, and the data sheets: those of the
// flash are not for the firmware.
#ifdef CONFIG_IDF_TARGET_ESP32
constexpr uint64_t kPins = 0xff0effffff & ~uint64_t{0xfc0};
constexpr uint64_t kOutputs = kPins & 0x3ffffffff;
constexpr uint64_t kFirstAdc = 0xff00000000;    // 32 to 39
constexpr uint64_t kSecondAdc = 0x00000e00f015;  // 0, 2, 4, 12 to 15, 25 to 27
constexpr uint8_t kChannels = 16;
constexpr uint8_t kMaxBits = 20;
constexpr uint64_t kClocks[] = {80000000, 1000000};
constexpr uint8_t kReceivePin = 3;
constexpr bool kBreakIsError = true;  // nobody knows of which chip a break is a framing error, too
#else
constexpr uint64_t kPins = 0x3c07ff;
constexpr uint64_t kOutputs = kPins;
constexpr uint64_t kFirstAdc = 0x1f;
constexpr uint64_t kSecondAdc = 0x20;
constexpr uint8_t kChannels = 6;
constexpr uint8_t kMaxBits = 14;
constexpr uint64_t kClocks[] = {40000000};
constexpr uint8_t kReceivePin = 20;
constexpr bool kBreakIsError = false;
#endif

bool is_in(uint64_t pins, uint32_t pin) { return pin < 64 && (pins >> pin & 1) != 0; }

struct Timer {
  esp_timer_cb_t callback;
  void* argument;
  uint64_t period_us;
  uint64_t due_us;
  bool skips;  // what it has missed
};

Timer timer = {nullptr, nullptr, 0, kNever, false};
bool is_timer_taken;
OnReceiveErrorCb on_error;
std::recursive_mutex critical;
thread_local uint32_t in_critical;  // how many sections this core is in
uint8_t analog_bits = 12;
uint64_t echo_rises_us = kNever;
uint64_t echo_falls_us = kNever;

// Starts the echo of a trigger pulse that ends.
void on_write(uint8_t pin, bool was_high, bool is_high) {
  if (pin != chip.trigger_pin || !was_high || is_high || chip.echo_us == 0) return;
  echo_rises_us = chip.now_us + kEchoBeginsUs;
  echo_falls_us = echo_rises_us + chip.echo_us;
}

uint64_t next_event() {
  uint64_t next_us = timer.due_us;
  if (echo_rises_us < next_us) next_us = echo_rises_us;
  if (echo_falls_us < next_us) next_us = echo_falls_us;
  if (next_task_us != nullptr && next_task_us() < next_us) next_us = next_task_us();
  if (chip.restart_ms != 0) {
    const uint64_t restart_us = chip.last_feed_us + chip.restart_ms * uint64_t{1000};
    if (restart_us < next_us) next_us = restart_us;
  }
  return next_us;
}

void do_event() {
  if (echo_rises_us <= chip.now_us) {
    echo_rises_us = kNever;
    set_input(chip.echo_pin, true);
  } else if (echo_falls_us <= chip.now_us) {
    echo_falls_us = kNever;
    set_input(chip.echo_pin, false);
  } else if (timer.due_us <= chip.now_us) {
    timer.due_us += timer.period_us;
    timer.callback(timer.argument);
  } else if (next_task_us != nullptr && next_task_us() <= chip.now_us) {
    run_tasks();
  } else {
    chip.has_restarted = true;
    chip.restart_ms = 0;
  }
}

SimulatedChannel& channel_of(uint32_t signal) {
#ifdef LEDC_HS_SIG_OUT0_IDX
  return chip.channels[signal - LEDC_HS_SIG_OUT0_IDX];
#else
  return chip.channels[signal - LEDC_LS_SIG_OUT0_IDX];
#endif
}

uint32_t signal_of_channel(uint8_t channel) {
#ifdef LEDC_HS_SIG_OUT0_IDX
  return LEDC_HS_SIG_OUT0_IDX + static_cast<uint32_t>(channel);
#else
  return LEDC_LS_SIG_OUT0_IDX + static_cast<uint32_t>(channel);
#endif
}

// A clock is divided by 1 to 1023, with 8 binary places.
bool can_make(uint32_t hertz, uint8_t bits) {
  if (hertz == 0) return false;
  for (uint64_t clock : kClocks) {
    const uint64_t divider = (clock << 8) / hertz >> bits;
    if (divider >= 256 && divider <= 0x3ffff) return true;
  }
  return false;
}

// Two channels share a timer, so the neighbour of one gets its frequency too. False: no clock makes
// that, and all stays as it is.
bool set_frequency(uint8_t channel, uint32_t hertz, uint8_t bits) {
  expect(channel < kChannels, "a channel of LEDC that the chip does not have");
  expect(bits <= kMaxBits, "more bits of LEDC than the chip has");
  if (!can_make(hertz, bits)) return false;
  for (uint8_t shared_channel : {channel, static_cast<uint8_t>(channel ^ 1)}) {
    chip.channels[shared_channel].hertz = hertz;
    chip.channels[shared_channel].bits = bits;
  }
  return true;
}

void set_duty(uint8_t channel, uint32_t duty) {
  SimulatedChannel& simulated_channel = chip.channels[channel];
  expect(simulated_channel.bits != 0, "a duty of a channel that is not set up");
  if (chip.is_ledc_stuck) return;
  const uint32_t max_duty = (1U << simulated_channel.bits) - 1;
  simulated_channel.duty =
      duty == max_duty ? max_duty + 1 : duty;  // as both versions of the core do
}

uint32_t set_tone(uint8_t channel, uint32_t hertz) {
  if (hertz == 0) {
    set_duty(channel, 0);
    return 0;
  }
  if (!set_frequency(channel, hertz, 10)) return 0;
  chip.channels[channel].duty = 0x1ff;
  return hertz;
}

SimulatedPin& output_at(uint32_t pin) {
  expect(is_in(kPins, pin), "a pin that the chip does not have free");
  expect(is_in(kOutputs, pin), "an output on a pin that only reads");
  return chip.pins[pin];
}

// The entries of NVS that a value takes: a number has one; a blob has one for its index, one for
// each page that it reaches into, and those of its bytes.
size_t entries_of(const std::string& value) {
  if (value.size() == sizeof(uint32_t)) return 1;
  const size_t data = (value.size() + kEntryBytes - 1) / kEntryBytes;
  return 2 + data + data / (kPageEntries - 1);
}

}  // namespace

size_t used_entries() {
  size_t count = 1;  // the name of the namespace
  for (const auto& entry : chip.entries) count += entries_of(entry.second);
  return count;
}

namespace {

// A page is erased: the chip stands still, and then the timer's task comes before the main loop, for
// each time that it has missed, or for one.
void erase() {
  chip.now_us += chip.erase_ms * uint64_t{1000};
  while (chip.erase_ms != 0 && timer.due_us <= chip.now_us) {
    timer.due_us += timer.period_us;
    if (timer.skips) timer.due_us = chip.now_us + timer.period_us;
    timer.callback(timer.argument);
  }
}

// One write of NVS: an entry is as it was, as it becomes, or gone. The old one goes when the new
// one is there, so for a moment there is room for both.
esp_err_t put(const char* key, const std::string& value) {
  expect_free("NVS in a critical section");
  expect(strlen(key) < 16, "a key of NVS that is too long");
  if (chip.is_off) return ESP_OK;
  const auto entry = chip.entries.find(key);
  if (entry != chip.entries.end() && entry->second == value) return ESP_OK;
  if (used_entries() + entries_of(value) > chip.nvs_room) return ESP_ERR_NVS_NOT_ENOUGH_SPACE;
  erase();
  chip.nvs_writes++;
  if (chip.nvs_writes == chip.cut_write) {
    chip.is_off = true;
    if (chip.torn_entry == TornEntry::kOld) return ESP_OK;
    if (chip.torn_entry == TornEntry::kLost) {
      chip.entries.erase(key);
      return ESP_OK;
    }
  }
  chip.entries[key] = value;
  return ESP_OK;
}

}  // namespace

void expect(bool condition, const char* message) {
  if (condition) return;
  fprintf(stderr, "MISUSE %s\n", message);
  abort();
}

void expect_free(const char* message) { expect(in_critical == 0, message); }

void advance_us(uint64_t us) {
  const uint64_t end_us = chip.now_us + us;
  for (uint64_t next_us = next_event(); next_us <= end_us; next_us = next_event()) {
    if (next_us > chip.now_us) chip.now_us = next_us;
    do_event();
  }
  chip.now_us = end_us;
}

uint8_t output_of(uint8_t pin) {
  const SimulatedPin& simulated_pin = chip.pins[pin];
  if (!simulated_pin.is_output) return 0;
  if (simulated_pin.signal == SIG_GPIO_OUT_IDX) return simulated_pin.level ? 255 : 0;
  const SimulatedChannel& channel = channel_of(simulated_pin.signal);
  if (channel.bits == 0) return 0;
  const uint64_t level = (uint64_t{channel.duty} * 255 + (1U << channel.bits) / 2) >> channel.bits;
  return static_cast<uint8_t>(level > 255 ? 255 : level);
}

void take_timer() { is_timer_taken = true; }

void run_timer() { timer.callback(timer.argument); }

void set_input(uint8_t pin, bool level) {
  SimulatedPin& simulated_pin = chip.pins[pin];
  if (simulated_pin.input == level) return;
  simulated_pin.input = level;
  if (chip.on_input != nullptr) chip.on_input(pin, level);
  if (simulated_pin.handler != nullptr && simulated_pin.has_interrupt) simulated_pin.handler();
}

std::string noinit() { return std::string(__start_rtc_noinit, __stop_rtc_noinit); }

void set_noinit(const std::string& bytes) {
  if (bytes.size() == noinit().size()) memcpy(__start_rtc_noinit, bytes.data(), bytes.size());
}

extern "C" {

unsigned long millis() { return static_cast<unsigned long>(chip.now_us / 1000); }
unsigned long micros() { return static_cast<unsigned long>(chip.now_us); }

void pinMode(uint8_t pin, uint8_t mode) {
  expect_free("pinMode in a critical section");
  expect(is_in(kPins, pin), "a pin that the chip does not have free");
  expect(mode != OUTPUT || is_in(kOutputs, pin), "an output on a pin that only reads");
  expect(mode != INPUT_PULLUP || is_in(kOutputs, pin), "a pull-up on a pin that has none");
  SimulatedPin& simulated_pin = chip.pins[pin];
  simulated_pin.is_output = mode == OUTPUT;
  simulated_pin.signal = SIG_GPIO_OUT_IDX;
  if (mode == INPUT_PULLUP && !simulated_pin.has_pull_up) simulated_pin.input = true;
  simulated_pin.has_pull_up = mode == INPUT_PULLUP;
}

void attachInterrupt(uint8_t pin, void (*handler)(void), int mode) {
  expect_free("attachInterrupt in a critical section");
  expect(mode == CHANGE, "an interrupt of another kind");
  chip.pins[pin].handler = handler;
  chip.pins[pin].has_interrupt = true;
}

uint16_t analogRead(uint8_t pin) {
  expect_free("analogRead in a critical section");
  expect(is_in(kFirstAdc | kSecondAdc, pin), "analogRead of a pin without a converter");
  expect(!chip.has_wifi || is_in(kFirstAdc, pin), "analogRead of the second converter beside WiFi");
  return static_cast<uint16_t>(chip.analog[pin] >> (12 - analog_bits));
}

void analogReadResolution(uint8_t bits) { analog_bits = bits; }

#if ESP_ARDUINO_VERSION_MAJOR >= 3
static uint8_t pin_channels[40];  // the channel of each pin, as the core keeps it

bool ledcAttachChannel(uint8_t pin, uint32_t freq, uint8_t resolution, uint8_t channel) {
  expect_free("ledcAttachChannel in a critical section");
  SimulatedPin& simulated_pin = output_at(pin);
  if (!set_frequency(channel, freq, resolution)) return false;
  simulated_pin.is_output = true;
  simulated_pin.signal = signal_of_channel(channel);
  pin_channels[pin] = channel;
  return true;
}

bool ledcWrite(uint8_t pin, uint32_t duty) {
  set_duty(pin_channels[pin], duty);
  return true;
}

uint32_t ledcWriteTone(uint8_t pin, uint32_t freq) { return set_tone(pin_channels[pin], freq); }

uint32_t ledcChangeFrequency(uint8_t pin, uint32_t freq, uint8_t resolution) {
  expect_free("ledcChangeFrequency in a critical section");
  return set_frequency(pin_channels[pin], freq, resolution) ? freq : 0;
}
#else
uint32_t ledcSetup(uint8_t channel, uint32_t freq, uint8_t resolution_bits) {
  expect_free("ledcSetup in a critical section");
  return set_frequency(channel, freq, resolution_bits) ? freq : 0;
}

void ledcAttachPin(uint8_t pin, uint8_t channel) {
  expect_free("ledcAttachPin in a critical section");
  expect(channel < kChannels, "a channel of LEDC that the chip does not have");
  SimulatedPin& simulated_pin = output_at(pin);
  simulated_pin.is_output = true;
  simulated_pin.signal = signal_of_channel(channel);
}

void ledcWrite(uint8_t channel, uint32_t duty) { set_duty(channel, duty); }

uint32_t ledcWriteTone(uint8_t channel, uint32_t freq) { return set_tone(channel, freq); }
#endif

void simulated_register(uint32_t address, uint32_t value) {
  if (address >= GPIO_FUNC0_OUT_SEL_CFG_REG) {
    output_at((address - GPIO_FUNC0_OUT_SEL_CFG_REG) / 4).signal = value;
    return;
  }
  const bool is_high = address == GPIO_OUT_W1TS_REG || address == GPIO_OUT_W1TS_REG + kNextPort;
  const uint32_t first_pin = address == GPIO_OUT_W1TS_REG || address == GPIO_OUT_W1TC_REG ? 0 : 32;
  const uint32_t pin = first_pin + static_cast<uint32_t>(__builtin_ctz(value));
  SimulatedPin& simulated_pin = output_at(pin);
  const bool was_high = simulated_pin.level;
  simulated_pin.level = is_high;
  on_write(static_cast<uint8_t>(pin), was_high, is_high);
}

int gpio_get_level(gpio_num_t gpio_num) {
  const SimulatedPin& simulated_pin = chip.pins[gpio_num];
  return simulated_pin.is_output ? simulated_pin.level : simulated_pin.input;
}

esp_err_t gpio_intr_enable(gpio_num_t gpio_num) {
  chip.pins[gpio_num].has_interrupt = true;
  return ESP_OK;
}

esp_err_t gpio_intr_disable(gpio_num_t gpio_num) {
  chip.pins[gpio_num].has_interrupt = false;
  return ESP_OK;
}

void esp_rom_gpio_connect_out_signal(uint32_t gpio_num, uint32_t signal_idx, bool, bool) {
  chip.pins[gpio_num].signal = signal_idx;
}

void simulated_enter_critical(portMUX_TYPE*) {
  critical.lock();
  in_critical++;
}

void simulated_exit_critical(portMUX_TYPE*) {
  expect(in_critical != 0, "the end of no critical section");
  in_critical--;
  critical.unlock();
}

#if ESP_ARDUINO_VERSION_MAJOR >= 3
static arduino_panic_handler_t on_panic;

void set_arduino_panic_handler(arduino_panic_handler_t handler, void*) { on_panic = handler; }

void simulated_panic() {
  arduino_panic_info_t info = {};
  if (on_panic != nullptr) on_panic(&info, nullptr);
}
#else
void __attribute__((weak)) __wrap_esp_panic_handler(void* info);  // not all programs have a board
void __real_esp_panic_handler(void*) {}

void simulated_panic() { __wrap_esp_panic_handler(nullptr); }
#endif

esp_reset_reason_t esp_reset_reason(void) { return chip.reset; }

uint32_t esp_random(void) { return chip.random; }

esp_err_t esp_timer_create(const esp_timer_create_args_t* create_args,
                           esp_timer_handle_t* out_handle) {
  timer.callback = create_args->callback;
  timer.argument = create_args->arg;
  timer.skips = create_args->skip_unhandled_events;
  *out_handle = nullptr;
  return ESP_OK;
}

esp_err_t esp_timer_start_periodic(esp_timer_handle_t, uint64_t period_us) {
  expect(timer.period_us == 0, "a timer that runs already");
  timer.period_us = period_us;
  timer.due_us = is_timer_taken ? kNever : chip.now_us + period_us;
  return ESP_OK;
}

#if ESP_ARDUINO_VERSION_MAJOR >= 3
esp_err_t esp_task_wdt_init(const esp_task_wdt_config_t*) { return ESP_ERR_INVALID_STATE; }

esp_err_t esp_task_wdt_reconfigure(const esp_task_wdt_config_t* config) {
  if (config->trigger_panic) chip.restart_ms = config->timeout_ms;
  chip.watches_idle = (config->idle_core_mask & 1) != 0;
  return ESP_OK;
}
#else
esp_err_t esp_task_wdt_init(uint32_t timeout, bool panic) {
  if (panic) chip.restart_ms = timeout * 1000;
  return ESP_OK;
}

TaskHandle_t xTaskGetIdleTaskHandleForCPU(UBaseType_t cpuid) {
  static int idle[2];
  return &idle[cpuid];
}

esp_err_t esp_task_wdt_delete(TaskHandle_t handle) {
  if (handle == xTaskGetIdleTaskHandleForCPU(0)) chip.watches_idle = false;
  return ESP_OK;
}
#endif

esp_err_t esp_task_wdt_add(TaskHandle_t) {
  expect(chip.restart_ms != 0, "the task watchdog before it has begun");
  chip.is_watched = true;
  chip.last_feed_us = chip.now_us;
  return ESP_OK;
}

esp_err_t esp_task_wdt_reset(void) {
  expect(chip.is_watched, "the task watchdog fed by who is not watched");
  chip.last_feed_us = chip.now_us;
  return ESP_OK;
}

esp_err_t nvs_open(const char* name, nvs_open_mode_t, nvs_handle_t* out_handle) {
  expect(strlen(name) < 16, "a key of NVS that is too long");
  if (chip.nvs_fault == NvsFault::kClosed) return ESP_ERR_NVS_NOT_INITIALIZED;
  expect(++chip.nvs_handles <= kMaxHandles, "handles of NVS that are left open");
  *out_handle = 1;
  return ESP_OK;
}

void nvs_close(nvs_handle_t) { chip.nvs_handles--; }

esp_err_t nvs_get_u32(nvs_handle_t, const char* key, uint32_t* out_value) {
  if (chip.nvs_fault == NvsFault::kNumbers) return ESP_FAIL;
  const auto entry = chip.entries.find(key);
  if (entry == chip.entries.end()) return ESP_ERR_NVS_NOT_FOUND;
  memcpy(out_value, entry->second.data(), sizeof *out_value);
  return ESP_OK;
}

esp_err_t nvs_set_u32(nvs_handle_t, const char* key, uint32_t value) {
  return put(key, std::string(reinterpret_cast<const char*>(&value), sizeof value));
}

esp_err_t nvs_get_blob(nvs_handle_t, const char* key, void* out_value, size_t* length) {
  if (chip.nvs_fault == NvsFault::kBlobs) return ESP_FAIL;
  const auto entry = chip.entries.find(key);
  if (entry == chip.entries.end()) return ESP_ERR_NVS_NOT_FOUND;
  if (entry->second.size() > *length) return ESP_ERR_NVS_INVALID_LENGTH;
  *length = entry->second.size();
  memcpy(out_value, entry->second.data(), *length);
  return ESP_OK;
}

esp_err_t nvs_set_blob(nvs_handle_t, const char* key, const void* value, size_t length) {
  return put(key, std::string(static_cast<const char*>(value), length));
}

esp_err_t nvs_commit(nvs_handle_t) { return ESP_OK; }

}  // extern "C"

EspClass ESP;
uint64_t EspClass::getEfuseMac() { return chip.mac; }

void HardwareSerial::begin(unsigned long, uint32_t, int8_t, int8_t, bool, unsigned long, uint8_t) {
  chip.has_uart = true;
  chip.pins[kReceivePin].has_pull_up = true;
  if (!chip.is_line_held) chip.pins[kReceivePin].input = true;
}

// Of errors the driver tells breaks alone, until it is asked for others.
esp_err_t uart_enable_intr_mask(uart_port_t, uint32_t enable_mask) {
  expect(chip.has_uart, "an interrupt of a driver that is not installed");
  if ((enable_mask & UART_FRM_ERR_INT_ENA) != 0) chip.tells_framing = true;
  return ESP_OK;
}

void spoil_byte() {
  if (on_error && chip.tells_framing) on_error(UART_FRAME_ERROR);
}

void hold_line(bool is_low) {
  chip.is_line_held = is_low;
  chip.pins[kReceivePin].input = !is_low;
  if (!is_low || !chip.has_uart) return;
  chip.received += '\0';
  if (kBreakIsError) spoil_byte();
  if (on_error) on_error(UART_BREAK_ERROR);
}

void HardwareSerial::onReceiveError(OnReceiveErrorCb function) { on_error = function; }

size_t HardwareSerial::setRxBufferSize(size_t new_size) {
  expect(!chip.has_uart, "room of a serial port that has begun");
  return chip.receive_room = new_size;
}

size_t HardwareSerial::setTxBufferSize(size_t new_size) {
  expect(!chip.has_uart, "room of a serial port that has begun");
  return chip.send_room = new_size;
}

int HardwareSerial::available() {
  expect_free("Serial in a critical section");
  if (chip.received.size() > chip.receive_room) {
    chip.received.resize(chip.receive_room);
    if (on_error) on_error(UART_BUFFER_FULL_ERROR);
  }
  return static_cast<int>(chip.received.size());
}

// Behind the UART's FIFO the driver may have a ring. Then the core adds all of that ring, full or not;
// a byte takes 32 of it, with its length and two heads, and waits where there is no room.
int HardwareSerial::availableForWrite() {
  const size_t waiting = chip.unsent_bytes < kFifoBytes ? chip.unsent_bytes : kFifoBytes;
  return static_cast<int>(kFifoBytes - waiting + chip.send_room);
}

int HardwareSerial::read() {
  if (chip.received.empty()) return -1;
  const uint8_t byte = static_cast<uint8_t>(chip.received[0]);
  chip.received.erase(0, 1);
  return byte;
}

size_t HardwareSerial::write(uint8_t byte) {
  const size_t room = kFifoBytes + chip.send_room / kRingBytes;
  expect(chip.unsent_bytes < room, "a byte that a serial port without room makes wait");
  chip.sent_bytes += static_cast<char>(byte);
  chip.unsent_bytes++;
  return 1;
}
