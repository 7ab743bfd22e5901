// A whole robot on a computer, for tests: the firmware with a board simulated by variables.
//
// One process is one robot from power-on to power-off. A request is four bytes of length and a
// letter with what it asks; an answer is four bytes of length and what was found.
// `tests/machines/host_firmware.py` is the other side. Ends with its input.

#include <math.h>
#include <stdio.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "../../src/firmware/firmware.h"
#include "../../src/firmware/persistence.h"
#include "../../src/firmware/program.h"
#include "../../src/firmware/readings.h"
#include "../../src/firmware/remote.h"
#include "../../src/firmware/trim.h"
#include "../../src/link/frames.h"
#include "../../src/robot.h"
#include "../../src/store/layout.h"
#include "../../src/store/nvm.h"
#include "../../src/text/kit_words.h"
#include "../../src/vm/image.h"
#include "../../src/vm/verify.h"
#include "../host/wire.h"

using namespace tiniscript;

namespace {

// What a motor turns, and whose disc has one channel: after `kLagMs` it has two thirds of its speed.
constexpr double kLagMs = 60;
constexpr double kEdgesPerMs = 0.09;  // at full power

struct Wheel {
  double speed = 0;        // in edges a millisecond
  double net_edges = 0;    // edges, less those that it went back
  double total_edges = 0;  // edges in all
  bool is_held = false;

  void advance_millisecond(int8_t percent) {
    speed += (percent * kEdgesPerMs / 100 - speed) / kLagMs;
    if (is_held) speed = 0;
    net_edges += speed;
    total_edges += fabs(speed);
  }
};

struct Tabletop {
  std::string memory;  // the EEPROM
  uint16_t kit = 0;
  uint8_t sensors = 0;
  uint8_t actuators = 0;
  uint32_t max_run_ms = 0;
  std::vector<int32_t> readings;
  std::vector<int32_t> firmware_readings;  // the firmware's
  std::vector<uint16_t> hashes;
  std::string words;
  uint16_t language = 0;  // the answers to text
  std::string log;
  int8_t left = 0;
  int8_t right = 0;
  Discs discs = {0, 0, false};
  Wheel wheels[2];
  bool is_latched = true;
  bool is_lit = false;
  bool has_stalled = false;  // since it was asked
  bool is_low = false;  // the supply
  bool writes_mark = false;
  uint8_t measurement_count = 0;      // of it, each fourth says something
  std::set<uint16_t> dead_addresses;  // addresses of the memory whose bytes never change
  bool has_set = false;               // an actuator, and no stop since
  bool has_hung = false;
  Place hang_place = {};
  uint8_t busy_ticks = 0;   // for which a byte is being written,
  uint8_t write_ticks = 0;  // as many as this
  uint8_t send_ticks = 0;   // that each byte takes which the robot sends; 0: none,
  uint8_t line_ticks = 0;   // and so many are left of the last one
  uint32_t now_ms = 0;
  bool has_tone = false;    // of a program
  uint32_t tone_end_ms = 0;
  bool differs_from_status = false;  // what it holds, than what STATUS says
  uint16_t wrong_light_ms = 0;       // for which the light has not told what a press would do
  std::string code;                  // that was started last
  std::vector<std::string> codes;    // all that nobody has asked for
};

Tabletop table;

void say(const char* event, int32_t first, int32_t second) {
  char line[60];
  snprintf(line, sizeof line, "%s %ld %ld\n", event, static_cast<long>(first),
           static_cast<long>(second));
  table.log += line;
}

int8_t percent_of(int16_t level) { return static_cast<int8_t>(lround(level / 2.55)); }

// Whether a byte is a commit byte: a mark of a slot other than 0.
bool is_mark(uint16_t place, uint8_t value) {
  for (uint8_t slot = 0; slot < kSlots; slot++) {
    const int offset = place - place_of(slot);
    if (offset > 0 && offset <= kMarks && value != 0 && value != 0xff) return true;
  }
  return false;
}

// The actual state of the motors, not the requested one.
void turn(int8_t left, int8_t right) {
  if ((left != 0 || right != 0) && table.busy_ticks != 0 && table.writes_mark) {
    table.log += "MARK and a motor starts\n";
  }
  if (left != table.left || right != table.right) say("MOTORS", left, right);
  table.left = left;
  table.right = right;
}

// The code that runs, or ran last.
std::string run_code() {
  const uint8_t* const image = port_run_image();
  const uint8_t* const code = image + image[kHeaderLengthAt];
  return std::string(code, code + get16(image + kCodeLengthAt));
}

// Says where other code runs than the one that began, which the verifier has accepted.
void check_code() {
  if (port_status().state == State::kRunning && run_code() != table.code) {
    table.log += "CHANGED code\n";
  }
}

// Says once what is wrong whatever the robot was told: a tone that goes on after its program, a
// light that does not tell whether a press would start one, and a program that is not the one of its
// STATUS. A robot that shows itself blinks faster.
void check_signs() {
  constexpr uint16_t kSteadyMs = 400;
  const RobotStatus& status = port_status();
  const bool is_running = status.state == State::kRunning;
  if (static_cast<int32_t>(table.now_ms - table.tone_end_ms) >= 0) table.has_tone = false;
  if (table.has_tone && !is_running) {
    table.log += "SOUND after the program\n";
    table.has_tone = false;
  }
  const bool is_same = status.program == get32(program + kChecksumAt) &&
                       status.length == get16(program + kCodeLengthAt);
  if (is_in_memory() && !is_same && !table.differs_from_status)
    table.log += "PROGRAM is another one\n";
  table.differs_from_status = is_in_memory() && !is_same;
  const bool has_program = has_booted() && status.saved != Saved::kNothing &&
                           status.saved != Saved::kOtherVersion;
  const bool is_right = table.is_lit == (!is_running && has_program);
  if (is_right || table.wrong_light_ms > kSteadyMs) {
    if (is_right) table.wrong_light_ms = 0;
  } else if (++table.wrong_light_ms > kSteadyMs) {
    table.log += "LIGHT is wrong\n";
  }
}

// B: power on, with what the memory holds.
void answer_begin(RequestReader* request, Writer*) {
  table.kit = request->u16();
  table.sensors = request->u8();
  table.actuators = request->u8();
  BootInfo boot_info;
  boot_info.reset = static_cast<Reset>(request->u8());
  boot_info.seed = request->u32();
  table.max_run_ms = request->u32();
  table.write_ticks = request->u8();
  table.hashes.resize(static_cast<size_t>(readings_of(table.sensors) + table.actuators));
  for (uint16_t& hash : table.hashes) hash = request->u16();
  table.readings.resize(table.sensors);
  table.firmware_readings.resize(readings_of(table.sensors));
  table.memory = request->text();
  table.words = request->text();
  table.language = request->u16();
  firmware_begin(boot_info);
}

// Lets so many ticks of a millisecond pass, and as many more as bytes arrive, one in each tick.
// Returns what the robot sends.
std::string pass(uint32_t now_ms, uint16_t ticks, const uint8_t* data, size_t length) {
  table.now_ms = now_ms;
  table.wheels[0].advance_millisecond(table.left);
  table.wheels[1].advance_millisecond(table.right);
  std::string sent_bytes;
  size_t index = 0;
  for (uint16_t k = 0; k < ticks || index < length; k++) {
    if (index < length) firmware_on_rx_byte(data[index++], static_cast<uint16_t>(now_ms));
    firmware_tick(now_ms);
    check_code();
    if (table.busy_ticks != 0) table.busy_ticks--;
    if (table.line_ticks != 0) table.line_ticks--;
    uint8_t byte = 0;
    while (table.line_ticks == 0 && firmware_next_tx_byte(&byte)) {
      sent_bytes += static_cast<char>(byte);
      table.line_ticks = table.send_ticks;
    }
  }
  check_signs();
  return sent_bytes;
}

// S: bytes arrive at a time, the button goes down (1) or up (2), the main loop stood still (4),
// nobody is connected (8), the bytes come before all that (16), the button has been down for a
// while (32); so many ticks follow. Says what the robot sends and what it does.
void answer_step(RequestReader* request, Writer* answer) {
  const uint32_t now_ms = request->u32();
  const uint8_t flags = request->u8();
  const uint16_t ticks = request->u16();
  const Bytes bytes = request->bytes();
  size_t index = 0;
  while ((flags & 16) != 0 && index < bytes.length) {
    firmware_on_rx_byte(bytes.data[index++], static_cast<uint16_t>(now_ms));
  }
  table.log.clear();
  if ((flags & 4) != 0) table.has_stalled = true;
  if ((flags & 1) != 0) firmware_on_pressed();
  if ((flags & 2) != 0) firmware_on_released();
  if ((flags & 8) != 0) firmware_on_disconnect();
  if ((flags & 32) != 0) firmware_on_down();
  answer->text(pass(now_ms, ticks, bytes.data.get() + index, bytes.length - index));
  answer->text(table.log);
  answer->u8(table.is_lit);
  answer->u8(table.is_latched);
}

// W: so many milliseconds from a time on, so many ticks each. Bytes arrive in the first, or one in
// each (1); it ends early once the robot has sent something (2). Says what the robot sends, what it
// does and when, its light, and after each of the milliseconds whether it is latched.
void answer_wait(RequestReader* request, Writer* answer) {
  const uint32_t first_ms = request->u32();
  const uint32_t count = request->u32();
  const uint16_t ticks = request->u16();
  const uint8_t mode = request->u8();
  const bool is_spread = mode == 1;
  const Bytes bytes = request->bytes();
  std::string sent_bytes;
  std::string whole_log;
  std::string latched_flags;
  for (uint32_t k = 0; k < count; k++) {
    const size_t start = is_spread || k == 0 ? std::min<size_t>(k, bytes.length) : bytes.length;
    const size_t bytes_left = bytes.length - start;
    const size_t length = is_spread ? std::min<size_t>(1, bytes_left) : bytes_left;
    table.log.clear();
    sent_bytes += pass(first_ms + k, ticks, bytes.data.get() + start, length);
    whole_log += with_times(first_ms + k, table.log);
    latched_flags += static_cast<char>(table.is_latched);
    if (mode == 2 && !sent_bytes.empty()) break;
  }
  answer->text(sent_bytes);
  answer->text(whole_log);
  answer->u8(table.is_lit);
  answer->text(latched_flags);
}

// E: the contents of the memory.
void answer_memory(RequestReader*, Writer* answer) { answer->text(table.memory); }

// L: whether the supply is too low.
void answer_supply(RequestReader* request, Writer*) { table.is_low = request->u8() != 0; }

// D: a byte of the memory never changes any more.
void answer_dead(RequestReader* request, Writer*) { table.dead_addresses.insert(request->u16()); }

// M: each byte of the memory changes again.
void answer_mended(RequestReader*, Writer*) { table.dead_addresses.clear(); }

// V: sets the readings of the sensors.
void answer_readings(RequestReader* request, Writer*) {
  for (int32_t& reading : table.readings) reading = request->i32();
}

// P: so many ticks pass until the robot has sent a byte.
void answer_pace(RequestReader* request, Writer*) { table.send_ticks = request->u8(); }

// C: the codes that were started since this was asked last.
void answer_codes(RequestReader*, Writer* answer) {
  for (const std::string& code : table.codes) answer->text(code);
  table.codes.clear();
}

// K: what a program would read of a remote control.
void answer_remote(RequestReader*, Writer* answer) {
  for (uint8_t k = 0; k < kRemoteReadings; k++) {
    answer->u32(static_cast<uint32_t>(remote_reading(k)));
  }
}

// G: puts discs on both wheels; they stand somewhere, in thousandths of the way between two edges.
void answer_discs(RequestReader* request, Writer*) {
  table.discs.cm = request->u32();
  table.discs.degrees = request->u32();
  for (Wheel& wheel : table.wheels) wheel.total_edges = request->u16() / 1000.0;
}

// H: holds the left wheel (1) and the right one (2), and lets go of the others.
void answer_held(RequestReader* request, Writer*) {
  const uint8_t held_wheels = request->u8();
  for (uint8_t k = 0; k < 2; k++) table.wheels[k].is_held = (held_wheels >> k & 1) != 0;
}

// O: how far both wheels have gone, in thousandths of the way between two edges.
void answer_wheels(RequestReader*, Writer* answer) {
  for (const Wheel& wheel : table.wheels) {
    answer->u32(static_cast<uint32_t>(static_cast<int32_t>(lround(wheel.net_edges * 1000))));
  }
}

// T: whether a trim is sound, and its levels for -128 to 127 percent, the left wheel's and that of
// the right one.
void answer_trim(RequestReader* request, Writer* answer) {
  const Trim trim = {request->u8(), static_cast<int8_t>(request->u8()), request->u8()};
  answer->u8(is_sound(trim));
  for (int power = -128; power < 128; power++) {
    const int8_t percent = static_cast<int8_t>(power);
    const Levels levels = trimmed_levels(trim, percent, percent);
    answer->u16(static_cast<uint16_t>(levels.left));
    answer->u16(static_cast<uint16_t>(levels.right));
  }
}

}  // namespace

namespace tiniscript {

void board_motors(int16_t left, int16_t right) {
  if (!table.is_latched) turn(percent_of(left), percent_of(right));
}

// What a measured move does meanwhile is not told.
void board_steer(int16_t left, int16_t right) {
  if (table.is_latched) return;
  table.left = percent_of(left);
  table.right = percent_of(right);
}

Discs board_discs() { return table.discs; }

uint16_t board_edges(bool is_right) {
  return static_cast<uint16_t>(static_cast<uint64_t>(table.wheels[is_right].total_edges));
}

void robot_off() {
  turn(0, 0);
  table.has_tone = false;
}

bool robot_read(uint8_t sensor, int32_t* value) {
  const int32_t previous_value = *value;
  *value = sensor < table.sensors
               ? table.readings[sensor]
               : remote_reading(static_cast<uint8_t>(sensor - table.sensors));
  return note_reading(sensor, previous_value, *value);
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  say("BEEP", hertz, static_cast<int32_t>(duration_ms));
  table.has_tone = port_status().state == State::kRunning;
  table.tone_end_ms = table.now_ms + duration_ms;
}

void robot_set(uint8_t actuator, int32_t value) {
  say("SET", actuator, value);
  table.has_set = true;
}

uint16_t board_kit() { return table.kit; }

uint8_t board_sensors() { return table.sensors; }

uint8_t board_actuators() { return table.actuators; }

int32_t* board_readings() { return table.firmware_readings.data(); }

uint32_t board_max_run_ms() { return table.max_run_ms; }

uint32_t board_speed(bool is_turn) { return is_turn ? 360000 : 45000; }

uint16_t robot_device_hash(uint16_t device) { return table.hashes.at(device); }

const uint8_t* robot_words() { return reinterpret_cast<const uint8_t*>(table.words.data()); }

uint16_t robot_language() { return table.language; }

void board_actuators_off() {
  if (table.has_set) table.log += "ACTUATORS OFF\n";
  table.has_set = false;
}

void board_stop() {
  table.is_latched = true;
  turn(0, 0);
}

void board_release() {
  table.is_latched = false;
  table.code = run_code();
  table.codes.push_back(table.code);
  uint16_t devices;
  const Verdict verdict = 
      verify(reinterpret_cast<const uint8_t*>(table.code.data()), table.code.size(),
             readings_of(table.sensors), table.actuators, &devices, kNeeds);
  if (verdict.rule != Rule::kNone) {
    say("UNVERIFIED", static_cast<int32_t>(verdict.rule), verdict.offset());
  }
}

bool board_take_hang(Place* place) {
  const bool has_hung = table.has_hung;
  table.has_hung = false;
  *place = table.hang_place;
  return has_hung;
}

bool board_take_stall() {
  const bool has_stalled = table.has_stalled;
  table.has_stalled = false;
  return has_stalled;
}

LineErrors board_line_errors() { return {0, 0}; }

void board_forget() {}

Supply board_supply() {
  if (table.left != 0 || table.right != 0) table.log += "MEASURED while a motor is on\n";
  if (table.measurement_count++ % 4 != 3) return Supply::kMeasuring;
  return table.is_low ? Supply::kLow : Supply::kEnough;
}

void board_light(bool is_on) {
  table.is_lit = is_on;
  table.wrong_light_ms = 0;
}

void board_finished() { table.log += "FINISHED\n"; }

void board_faulted() { table.log += "FAULTED\n"; }

bool nvm_is_ready() { return table.busy_ticks == 0; }

uint8_t nvm_read(uint16_t place) { return static_cast<uint8_t>(table.memory[place]); }

void nvm_write(uint16_t place, uint8_t value) {
  table.writes_mark = is_mark(place, value);
  if (table.writes_mark && (table.left != 0 || table.right != 0)) {
    table.log += "MARK while a motor is on\n";
  }
  if (table.writes_mark && table.is_low) table.log += "MARK while the supply is low\n";
  if (table.dead_addresses.count(place) == 0) table.memory[place] = static_cast<char>(value);
  table.busy_ticks = table.write_ticks;
}

void nvm_clear(uint16_t place) { nvm_write(place, 0); }

const Answers answers = {
    {'B', answer_begin},
    {'S', answer_step},
    {'W', answer_wait},
    {'E', answer_memory},
    {'L', answer_supply},
    {'D', answer_dead},
    {'M', answer_mended},
    {'V', answer_readings},
    {'C', answer_codes},
    {'T', answer_trim},
    {'G', answer_discs},
    {'K', answer_remote},
    {'O', answer_wheels},
    {'H', answer_held},
    {'P', answer_pace},
};

}  // namespace tiniscript

int main() { return answer_all_requests(answers) ? 0 : 1; }
