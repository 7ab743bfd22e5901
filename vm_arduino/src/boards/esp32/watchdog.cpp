#ifdef ARDUINO_ARCH_ESP32

#include "watchdog.h"

#include <Arduino.h>
#include <esp_attr.h>
#include <esp_system.h>
#include <esp_task_wdt.h>
#include <esp_timer.h>
#include <freertos/task.h>
#if __has_include(<esp_random.h>)
#include <esp_random.h>
#endif

#include "../../firmware/firmware.h"
#include "../../link/port.h"
#include "../kit.h"

namespace tiniscript {

namespace {

constexpr uint32_t kRestartSeconds = 1;  // the core of version 2 counts whole seconds
constexpr uint8_t kLookMs = 10;
constexpr uint32_t kHung = 0x93c5e21b;  // value of `mark` while the record counts

// Survives a restart. After power-on its contents are random: `mark` says whether it counts.
struct Record {
  uint32_t mark;
  Place place;  // zeros if no program ran
};

RTC_NOINIT_ATTR Record hang_record;

constexpr uint32_t kRunMark = 0x5ad1c07f;

RTC_NOINIT_ATTR uint32_t run_mark;  // kRuns while a program runs

// The main loop writes these, and the timer's task on the other core reads them, or the other way
// round.
bool is_fed;  // since the timer's task has looked
bool is_hanging;
bool has_stalled;

uint8_t missed_looks;  // the timer's: how many times it has looked since

template <class Value>
Value read(const Value& source) {
  return __atomic_load_n(&source, __ATOMIC_ACQUIRE);
}

template <class Value>
void write_to(Value* to, Value value) {
  __atomic_store_n(to, value, __ATOMIC_RELEASE);
}

bool has_hung;  // before the last reset; not yet reported
Reset cause;

uint32_t hang_mark() { return kHung ^ hang_record.place.checksum ^ hang_record.place.offset; }

Reset cause_of(esp_reset_reason_t reason) {
  switch (reason) {
    case ESP_RST_POWERON:
      return Reset::kPower;
    case ESP_RST_EXT:
      return Reset::kButton;
    case ESP_RST_BROWNOUT:
      return Reset::kBrownOut;
    case ESP_RST_PANIC:
    case ESP_RST_INT_WDT:
    case ESP_RST_TASK_WDT:
    case ESP_RST_WDT:
      return Reset::kWatchdog;
    default:
      return Reset::kUnknown;
  }
}

// A supply that sags deeply comes back as power-on. The bytes of a chip that has been without power
// are lost; that they are there says that it was gone for a moment.
Reset current_cause() {
  const Reset reset = cause_of(esp_reset_reason());
  const bool has_sagged = reset == Reset::kPower && run_mark == kRunMark;
  run_mark = 0;
  return has_sagged ? Reset::kBrownOut : reset;
}

// The timer's task. It counts its looks, not the time: while a page of flash is erased, up to 400 ms
// by data sheets, it stands still like the main loop.
void look(void*) {
  if (read(is_fed)) {
    missed_looks = 0;
    return write_to(&is_fed, false);
  }
  if (read(is_hanging) || ++missed_looks < kStallMs / kLookMs) return;
  motors_stop();
  actuators_off(true);
  if (!firmware_runs(&hang_record.place)) hang_record.place = Place();
  hang_record.mark = hang_mark();
  write_to(&has_stalled, true);
  write_to(&is_hanging, true);
}

void begin_restart() {
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  esp_task_wdt_config_t settings = {};
  settings.timeout_ms = kRestartSeconds * 1000;
  settings.trigger_panic = true;
  // It runs already, unless the core was built without it.
  if (esp_task_wdt_reconfigure(&settings) != ESP_OK) esp_task_wdt_init(&settings);
#else
  // It runs already, and watches the idle task of core 0 too: TLS calculates there for longer.
  esp_task_wdt_init(kRestartSeconds, true);
  esp_task_wdt_delete(xTaskGetIdleTaskHandleForCPU(0));
#endif
  esp_task_wdt_add(nullptr);  // this task: setup() and loop() run in one
}

}  // namespace

void watchdog_begin() {
  panic_begin();
  cause = current_cause();
  has_hung = cause == Reset::kWatchdog && hang_record.mark == hang_mark();
  hang_record.mark = 0;
  write_to(&is_fed, true);
  esp_timer_create_args_t settings = {};
  settings.callback = look;
  settings.name = "tiniscript";
  settings.skip_unhandled_events = true;
  esp_timer_handle_t timer = nullptr;
  if (esp_timer_create(&settings, &timer) == ESP_OK) esp_timer_start_periodic(timer, kLookMs * 1000);
  begin_restart();
}

void watchdog_feed() {
  write_to(&is_fed, true);
  run_mark = port_status().state == State::kRunning ? kRunMark : 0;
  if (read(is_hanging)) {
    hang_record.mark = 0;
    write_to(&is_hanging, false);
  }
  esp_task_wdt_reset();
}

bool watchdog_take_stall() {
  if (!read(has_stalled)) return false;
  write_to(&has_stalled, false);
  return true;
}

bool watchdog_take_hang(Place* place) {
  if (!has_hung) return false;
  has_hung = false;
  *place = hang_record.place;
  return true;
}

Reset watchdog_reset_cause() { return cause; }

// Before a radio is on, `esp_random` may return the same values on two chips. The last bytes of
// their addresses are not, and the last digits of an id are in a robot's name.
uint32_t watchdog_seed() {
  const uint32_t address = static_cast<uint32_t>(ESP.getEfuseMac() >> 16);
  return esp_random() ^ __builtin_bswap32(address);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
