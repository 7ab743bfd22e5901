// An ESP32 on a computer, for tests: what `core/` declares, done by variables.
//
// Knows time, pins, the GPIO matrix, LEDC, timers, UART 0, NVS and the watchdog; no instructions.
// `simulated_radio` has the radios, `simulated_counter` the pulse counter. What the real parts refuse ends the run.

#pragma once

#include <Arduino.h>

#include <stddef.h>

#include <atomic>
#include <map>
#include <string>

struct SimulatedPin {
  bool is_output;
  bool has_pull_up;
  bool level;       // of its GPIO register
  bool input;       // what comes from outside
  uint32_t signal;  // of the GPIO matrix
  void (*handler)();
  bool has_interrupt;
};

struct SimulatedChannel {
  uint32_t hertz;
  uint8_t bits;
  uint32_t duty;
};

// What becomes of the entry of NVS that is written when the power fails.
enum class TornEntry : uint8_t { kOld, kNew, kLost };

// NVS keeps everything in entries of 32 bytes, in pages of 4 KB.
constexpr size_t kEntryBytes = 32;
constexpr size_t kPageEntries = 126;

// What NVS refuses: to be opened, numbers, or blobs.
enum class NvsFault : uint8_t { kNone, kClosed, kNumbers, kBlobs };

struct SimulatedChip {
  std::atomic<uint64_t> now_us{0};
  SimulatedPin pins[40] = {};
  SimulatedChannel channels[16] = {};
  uint16_t analog[40] = {};  // 12 bits
  esp_reset_reason_t reset = ESP_RST_POWERON;
  uint32_t random = 0x12345678;
  uint64_t mac = 0;  // its first byte is the lowest

  std::string received;  // waits for the firmware
  std::string sent_bytes;
  size_t receive_room = 256;
  size_t send_room = 0;     // behind the UART's own 128 bytes
  size_t unsent_bytes = 0;  // bytes that the UART has still to send
  bool has_uart = false;
  bool tells_framing = false;
  bool is_line_held = false;  // low

  std::map<std::string, std::string> entries;  // of NVS
  uint32_t nvs_writes = 0;
  int nvs_handles = 0;  // that are open
  uint32_t erase_ms = 0;  // how long a write stops the chip
  NvsFault nvs_fault = NvsFault::kNone;
  size_t nvs_room = 15 * kPageEntries;  // of 16 pages: one stays free
  uint32_t cut_write = 0;               // the power fails at this write; 0: it does not
  TornEntry torn_entry = TornEntry::kOld;
  bool is_off = false;  // since then nothing is written

  uint32_t restart_ms = 0;  // of the task watchdog; 0: it does not run
  uint64_t last_feed_us = 0;
  bool is_watched = false;   // the main loop, by it
  bool watches_idle = true;  // the task watchdog, that of core 0, which nobody feeds meanwhile
  bool has_restarted = false;
  uint32_t slept_us = 0;     // by the main loop, and not yet counted as turns of it
  uint32_t sleep_count = 0;  // how many times it slept

  bool is_heap_full = false;  // no stack finds room
  std::atomic<bool> has_wifi{false};

  bool is_ledc_stuck = false;  // no duty changes any more
  void (*on_input)(uint8_t pin, bool level) = nullptr;  // of the pulse counter, where it is used

  uint8_t echo_pin = 0xff;
  uint8_t trigger_pin = 0xff;
  uint32_t echo_us = 0;  // 0: there is nothing to hear
};

extern SimulatedChip chip;

// Ends the program with "MISUSE" and what it was, unless it is so.
void expect(bool condition, const char* message);
void expect_free(const char* message);  // of a critical section

// Lets time pass; what is due meanwhile happens at its microsecond.
void advance_us(uint64_t us);

// What the pin has: 0 to 255, PWM as its share.
uint8_t output_of(uint8_t pin);

void set_input(uint8_t pin, bool level);

size_t used_entries();  // of NVS

// The line of the cable goes low for longer than a byte, or high again: of a break, however long, the
// UART makes one byte 0, and its driver tells it once.
void hold_line(bool is_low);

// The next byte that arrives has a framing error: the driver tells it before it hands the byte over,
// and not which it is.
void spoil_byte();

// What the sketch does in a panic, before anything is printed.
extern "C" void simulated_panic();

// The bytes that a reset leaves alone.
std::string noinit();
void set_noinit(const std::string& bytes);
