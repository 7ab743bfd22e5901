// A whole robot as a WebAssembly module: the virtual one of `tsc robot`.
//
// The firmware with a board that is made of numbers. Knows under which names it is called from
// outside, keeps the time of the UART and of the EEPROM, and notes what the robot does in its
// world. No heap and no library. One instance is one robot from power-on to power-off.
// `virtual/module.py` is the other side.

#include "../../src/robot.h"

#include "../../src/firmware/firmware.h"
#include "../../src/firmware/readings.h"
#include "../../src/firmware/remote.h"
#include "../../src/link/port.h"
#include "../../src/store/layout.h"
#include "../../src/store/nvm.h"
#include "../../src/text/kit_words.h"
#include "watched_run.h"

#define tini_exported(name) extern "C" __attribute__((export_name(name)))
#define tini_imported(name) extern "C" __attribute__((import_module("robot"), import_name(name)))

using namespace tiniscript;

// There are notes to be read. Where the last one is about a sensor or a disc, `reading` is to be
// filled.
tini_imported("look") void host_look();

namespace {

// The main loop comes around so often: 32 instructions each time are about what an Uno does.
constexpr uint32_t kTickUs = 125;
constexpr uint32_t kBoxBytes = 4096;
constexpr uint32_t kWordBytes = 65536;

uint8_t inbox[kBoxBytes];   // what is on its way to the robot
uint8_t outbox[kBoxBytes];  // what it has sent
uint32_t received;          // of the inbox,
uint32_t inbox_length;      // of so many bytes
uint32_t outbox_length;     // of the outbox
uint64_t now_us;
uint64_t next_receive_us;  // when the next byte has come in,
uint64_t next_send_us;     // and when the one that goes out is gone
uint64_t write_end_us;     // and when the EEPROM is ready again
uint32_t byte_us;          // how long a byte takes on the line, both ways; 0: no time
uint32_t write_us;         // and how long in the EEPROM
bool is_latched = true;
int32_t readings[256];
uint16_t hashes[512];
uint8_t words[kWordBytes];

// What `begin` says about the robot.
struct RobotSettings {
  uint16_t kit;
  uint8_t sensors;
  uint8_t actuators;
  uint32_t max_run_ms;
  uint32_t speed;
  uint32_t turn;
  Discs discs;
  uint16_t language;
};

RobotSettings settings;
uint8_t memory[kMemoryBytes];

// What the robot does, and when: milliseconds since power-on.
struct Note {
  uint32_t now_ms;
  uint32_t kind;
  int32_t first;
  int32_t second;
  int32_t third;
};

enum NoteKind : uint32_t {
  kMotors = 1,
  kRead,
  kBeep,
  kShow,
  kSet,
  kStop,
  kRelease,
  kLight,
  kFinished,
  kFaulted,
  kActuatorsOff,
  kSteer,
  kEdges,
};

constexpr uint32_t kNotes = 256;

Note notes[kNotes];
uint32_t note_count;
int32_t reading;

uint32_t now_ms() { return static_cast<uint32_t>(now_us / 1000); }

void note(NoteKind kind, int32_t first = 0, int32_t second = 0, int32_t third = 0) {
  if (note_count == kNotes) host_look();
  notes[note_count++] = {now_ms(), kind, first, second, third};
}

void receive() {
  while (received < inbox_length && next_receive_us <= now_us) {
    firmware_on_rx_byte(inbox[received++], static_cast<uint16_t>(now_ms()));
    firmware_tick(now_ms());
    if (byte_us == 0) return;  // the next one at the next tick
    next_receive_us += byte_us;
  }
}

void say() {
  while (outbox_length < kBoxBytes && next_send_us <= now_us) {
    if (!firmware_next_tx_byte(outbox + outbox_length)) {
      next_send_us = now_us;
      return;
    }
    outbox_length++;
    next_send_us += byte_us;
  }
}

}  // namespace

namespace tiniscript {

void board_motors(int16_t left, int16_t right) {
  if (!is_latched) note(kMotors, left, right);
}

void board_steer(int16_t left, int16_t right) {
  if (!is_latched) note(kSteer, left, right);
}

Discs board_discs() { return settings.discs; }

// Both are asked at once, and once in a millisecond.
uint16_t board_edges(bool is_right) {
  static uint32_t last_look_ms;
  static uint16_t edges[2];
  if (!is_right && last_look_ms != now_ms()) {
    last_look_ms = now_ms();
    note(kEdges);
    host_look();
    edges[0] = static_cast<uint16_t>(reading);
    edges[1] = static_cast<uint16_t>(reading >> 16);
  }
  return edges[is_right];
}

void robot_off() {}  // `board_stop` says it

bool robot_read(uint8_t sensor, int32_t* value) {
  const bool is_of_kit = sensor < settings.sensors;
  note(kRead, sensor,
       is_of_kit ? 0 : remote_reading(static_cast<uint8_t>(sensor - settings.sensors)));
  host_look();
  const int32_t previous_value = *value;
  *value = reading;
  return note_reading(sensor, previous_value, reading);
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  note(kBeep, hertz, static_cast<int32_t>(duration_ms));
}

void robot_set(uint8_t actuator, int32_t value) { note(kSet, actuator, value); }

uint16_t board_kit() { return settings.kit; }

uint8_t board_sensors() { return settings.sensors; }

uint8_t board_actuators() { return settings.actuators; }

int32_t* board_readings() { return readings; }

uint32_t board_max_run_ms() { return settings.max_run_ms; }

uint32_t board_speed(bool is_turn) { return is_turn ? settings.turn : settings.speed; }

uint16_t robot_device_hash(uint16_t device) { return hashes[device]; }

const uint8_t* robot_words() { return words; }

uint16_t robot_language() { return settings.language; }

void board_stop() {
  is_latched = true;
  note(kStop);
}

void board_release() {
  is_latched = false;
  note(kRelease);
}

void board_actuators_off() { note(kActuatorsOff); }

bool board_take_stall() { return false; }

LineErrors board_line_errors() { return {0, 0}; }  // its bytes come whole, or not at all

bool board_take_hang(Place*) { return false; }

void board_forget() {}

Supply board_supply() { return Supply::kEnough; }

void board_light(bool is_on) { note(kLight, is_on); }

void board_finished() { note(kFinished); }

void board_faulted() { note(kFaulted); }

bool nvm_is_ready() { return now_us >= write_end_us; }

uint8_t nvm_read(uint16_t place) { return memory[place]; }

void nvm_write(uint16_t place, uint8_t value) {
  memory[place] = value;
  write_end_us = now_us + write_us;
}

void nvm_clear(uint16_t place) { nvm_write(place, 0); }

}  // namespace tiniscript

// What `watched.cpp` asks in place of `robot_show`.
namespace tiniscript {

bool watched_show(int32_t value, bool is_yes_no) {
  const bool is_taken = robot_show(value, is_yes_no);
  if (is_taken) note(kShow, value, is_yes_no, port_shown_at());
  return is_taken;
}

}  // namespace tiniscript

// The EEPROM, to be filled before `begin`.
tini_exported("memory_at") uint8_t* module_memory() { return memory; }
tini_exported("memory_bytes") uint32_t module_memory_bytes() { return kMemoryBytes; }

// The hashes of the kit's devices, those of readings first, to be filled before `begin`.
tini_exported("hashes") uint16_t* module_hashes() { return hashes; }

// The words of the kit as `robot_words` says them, to be filled before `begin`, and how many bytes
// they may have.
tini_exported("words") uint8_t* module_words() { return words; }
tini_exported("word_bytes") uint32_t module_word_bytes() { return kWordBytes; }

tini_exported("inbox") uint8_t* module_inbox() { return inbox; }
tini_exported("outbox") uint8_t* module_outbox() { return outbox; }
tini_exported("box_bytes") uint32_t module_box_bytes() { return kBoxBytes; }

// What there is to be seen, and how many notes; whoever looks makes that 0.
tini_exported("notes") Note* module_notes() { return notes; }
tini_exported("noted") uint32_t* module_noted() { return &note_count; }
tini_exported("reading") int32_t* module_reading() { return &reading; }

// Power on. `line_us` is how long a byte takes on the line, `eeprom_us` how long in the EEPROM.
// `language` is the number of that of its answers.
tini_exported("begin") void module_begin(uint32_t kit, uint32_t sensors, uint32_t actuators,
                                         uint32_t reset, uint32_t seed, uint32_t max_run_ms,
                                         uint32_t speed, uint32_t turn, uint32_t edge_cm,
                                         uint32_t edge_degrees, uint32_t has_two,
                                         uint32_t line_us, uint32_t eeprom_us,
                                         uint32_t language) {
  byte_us = line_us;
  write_us = eeprom_us;
  settings.kit = static_cast<uint16_t>(kit);
  settings.sensors = static_cast<uint8_t>(sensors);
  settings.actuators = static_cast<uint8_t>(actuators);
  settings.max_run_ms = max_run_ms;
  settings.speed = speed;
  settings.turn = turn;
  settings.discs = {edge_cm, edge_degrees, has_two != 0};
  settings.language = static_cast<uint16_t>(language);
  BootInfo boot_info;
  boot_info.reset = static_cast<Reset>(reset);
  boot_info.seed = seed;
  firmware_begin(boot_info);
}

// So many bytes are in the inbox now, after those that have been heard.
tini_exported("put") void module_put(uint32_t bytes) {
  received = 0;
  inbox_length = bytes;
  if (next_receive_us < now_us + byte_us) next_receive_us = now_us + byte_us;
}

// Goes on up to a time, or until the inbox is empty where `has_more`, or the outbox is full, or the
// program is held. Returns how many bytes are in the outbox: they are to be fetched now.
tini_exported("run") uint32_t module_run(uint64_t until_us, uint32_t has_more) {
  outbox_length = 0;
  watched_begin();
  while (now_us < until_us && outbox_length < kBoxBytes && !watched_has_held()) {
    if (has_more != 0 && received == inbox_length) break;
    now_us += kTickUs;
    receive();
    firmware_tick(now_ms());
    say();
  }
  return outbox_length;
}

tini_exported("now_us") uint64_t module_now_us() { return now_us; }

// How many bytes of the inbox have not been heard.
tini_exported("unheard") uint32_t module_unheard() { return inbox_length - received; }

tini_exported("press") void module_press() {
  firmware_on_pressed();
  firmware_on_down();  // it has no spikes
}
tini_exported("let_go") void module_let_go() { firmware_on_released(); }

// The robot as its own STATUS tells it.
tini_exported("state") uint32_t module_state() {
  return static_cast<uint32_t>(port_status().state);
}
tini_exported("saved") uint32_t module_saved() {
  return static_cast<uint32_t>(port_status().saved);
}
tini_exported("fault") uint32_t module_fault() { return port_status().fault; }

// Where the instruction that runs begins; all ones while no program runs.
tini_exported("at") uint32_t module_at() {
  Place place;
  return firmware_runs(&place) ? place.offset : 0xffffffff;
}

tini_exported("tasks") const int32_t* module_tasks() { return watched_tasks(); }
tini_exported("driver") uint32_t module_driver() { return watched_driver(); }

// Marks for each offset of a program's code: where it is held, before it runs what is there.
tini_exported("marks") uint8_t* module_marks() { return watched_marks(); }
tini_exported("marks_bytes") uint32_t module_marks_bytes() { return watched_marks_bytes(); }
tini_exported("want") void module_want(uint32_t bits) { watched_want(static_cast<uint8_t>(bits)); }
tini_exported("held_at") uint32_t module_held_at() { return watched_held_at(); }
tini_exported("go_on") void module_go_on() { watched_go_on(); }
tini_exported("variables") const int32_t* module_variables() { return watched_variables(); }
