#include "firmware.h"

#include "../link/link.h"
#include "../robot.h"
#include "../store/store.h"
#include "../vm/crc32.h"
#include "../vm/image.h"
#include "../vm/verify.h"
#include "../vm/vm.h"
#include "trim.h"

namespace tiniscript {

namespace {

constexpr uint8_t kBudget = 32;  // instructions in one tick
constexpr uint8_t kLiveBytes = kPayloadBytes - kLiveCodeAt;

constexpr uint16_t kLowMs = 500;  // between two looks at a supply that is too low

// What is read from the store after a reset, one after the other.
enum class Boot : uint8_t { kSettling, kIdentity, kFault, kProgram, kOver };

// What is to be kept, as soon as the store is free: one bit each.
constexpr uint8_t kKeepProgram = 1;
constexpr uint8_t kKeepFault = 2;
constexpr uint8_t kKeepIdentity = 4;

Board board;
Card card;
Equipment equipment;
Condition condition;
Trim trim;
Receiver receiver;
Link talk;
Store store;
Machine machine;

uint8_t program[kHeaderBytes + kStoredCodeBytes + kEndBytes];  // an image
uint8_t live[kHeaderBytes + kLiveBytes + kEndBytes];
uint8_t record[kRecordBytes];

Boot boot;
bool is_whole;     // `program` is the one that `condition` names
bool is_live_run;  // `live` runs
bool may_start;    // the button is down; nothing has run or was stopped since: going up, it starts
uint8_t to_keep;
uint8_t keeping;    // of them: what the store writes now
bool is_driving;    // a motor is on
bool is_low;        // what is to be kept waits for more voltage
uint16_t low_ms;    // since then
bool is_worn;       // the memory has not kept who the robot is
bool is_start_due;  // the button went up, and the program was not to be had at once
uint32_t now_ms;
uint32_t began_ms;  // the run

static_assert(sizeof(Trim) == kTrimBytes, "it is kept as it is sent");

uint16_t number16(const uint8_t* bytes) {
  return static_cast<uint16_t>(bytes[0] | static_cast<uint16_t>(bytes[1]) << 8);
}

uint32_t number32(const uint8_t* bytes) {
  return number16(bytes) | static_cast<uint32_t>(number16(bytes + 2)) << 16;
}

void put_number(uint8_t* bytes, uint32_t number, uint8_t size) {
  for (; size != 0; size--) {
    *bytes++ = static_cast<uint8_t>(number & 0xff);
    number >>= 8;
  }
}

void show_light() {
  board_light(condition.state != State::kRunning && condition.saved != Saved::kNothing);
}

// -- what is kept -------------------------------------------------------------------------------

// Reads bytes of what is stored; false where they are not to be had now.
bool fetch(Area area, uint16_t at, uint8_t* bytes, uint16_t length) {
  for (uint16_t k = 0; k < length; k++) {
    if (!store.fetch(area, static_cast<uint16_t>(at + k), bytes + k)) return false;
  }
  return true;
}

// The program that the robot holds is the stored one, if there is one.
void name_stored() {
  is_whole = false;
  condition.saved = Saved::kNothing;
  condition.slot = store.used(Area::kProgram);
  uint8_t header[kHeaderBytes];
  if (condition.slot == kNoSlot || !fetch(Area::kProgram, 0, header, kHeaderBytes)) return;
  condition.saved = Saved::kStored;
  condition.program = number32(header + kChecksumAt);
  condition.length = number16(header + kCodeLengthAt);
}

// Whether the robot may run the image in memory.
bool is_sound(uint16_t bytes) {
  Image image;
  return unpack(program, bytes, card.kit, &image) == Refusal::kNone &&
         verify(image.code, image.code_length, equipment.sensors, equipment.actuators).rule ==
             Rule::kNone;
}

// Brings the stored program into memory. False: it is not to be had now.
bool load() {
  if (is_whole || condition.saved == Saved::kNothing) return true;
  const uint16_t bytes = static_cast<uint16_t>(kHeaderBytes + condition.length);
  if (!fetch(Area::kProgram, 0, program, bytes)) return false;
  for (uint8_t k = 0; k < kEndBytes; k++) program[bytes + k] = static_cast<uint8_t>(Op::kEnd);
  is_whole = is_sound(bytes);
  if (!is_whole) {
    // the one before it, or none
    store.refuse();
    name_stored();
  }
  return is_whole || condition.saved == Saved::kNothing;
}

void load_identity() {
  if (!fetch(Area::kIdentity, 0, record, kRecordBytes)) {
    card.id = board.seed;
    to_keep |= kKeepIdentity;
    return;
  }
  card.id = number32(record + kIdAt);
  while (equipment.name_length < kNameBytes && record[kNameAt + equipment.name_length] != 0) {
    equipment.name[equipment.name_length] = record[kNameAt + equipment.name_length];
    equipment.name_length++;
  }
  copy_bytes(record + kTrimAt, reinterpret_cast<uint8_t*>(&trim), sizeof trim);
  if (!is_sound(trim)) trim = Trim();  // of other firmware
}

// A record of a fault: what, where, in which image. What the watchdog has ended is a newer one.
void load_fault() {
  Place hung;
  if (board_has_hung(&hung)) {
    condition.fault = static_cast<uint8_t>(LinkFault::kStall);
    condition.fault_at = hung.at;
    condition.fault_program = hung.program;
    to_keep |= kKeepFault;
    return;
  }
  if (!fetch(Area::kFault, 0, record, kRecordBytes)) return;
  condition.fault = record[kFaultAt];
  condition.fault_at = number16(record + kFaultAt + 1);
  condition.fault_program = number32(record + kFaultAt + 3);
}

// One thing after the other, when the store is free.
void load_next() {
  if (store.is_busy()) return;
  switch (boot) {
    case Boot::kSettling:
      boot = Boot::kIdentity;
      return;
    case Boot::kIdentity:
      load_identity();
      boot = Boot::kFault;
      return;
    case Boot::kFault:
      load_fault();
      name_stored();
      boot = Boot::kProgram;
      return;
    case Boot::kProgram:
      if (!load()) return;
      boot = Boot::kOver;
      show_light();
      return;
    case Boot::kOver:
      return;
  }
}

void write_record() {
  for (uint8_t& byte : record) byte = 0;
  if (keeping == kKeepIdentity) {
    put_number(record + kIdAt, card.id, 4);
    for (uint8_t k = 0; k < equipment.name_length; k++) record[kNameAt + k] = equipment.name[k];
    copy_bytes(&trim, record + kTrimAt, sizeof trim);
  } else {
    record[kFaultAt] = condition.fault;
    put_number(record + kFaultAt + 1, condition.fault_at, 2);
    put_number(record + kFaultAt + 3, condition.fault_program, 4);
    record[kFaultAt + 7] = static_cast<uint8_t>(card.reset);
  }
}

// Whether what makes something count may be written: motors off, and enough voltage.
bool may_commit() {
  if (is_driving || !store.is_ready_to_commit()) return false;
  if (is_low && static_cast<uint16_t>(now_ms - low_ms) < kLowMs) return false;
  const Supply supply = board_supply();
  if (supply == Supply::kMeasuring) return false;
  is_low = supply == Supply::kLow;
  low_ms = static_cast<uint16_t>(now_ms);
  return !is_low;
}

void tell_saving() { condition.saved = is_low ? Saved::kLowSupply : Saved::kSaving; }

// Begins to keep what is next; a program first.
void keep_next() {
  keeping = static_cast<uint8_t>(to_keep & -to_keep);
  bool has_begun;
  if (keeping == kKeepProgram) {
    has_begun = store.begin_save(program);
  } else {
    write_record();
    has_begun = store.begin_keep(keeping == kKeepFault ? Area::kFault : Area::kIdentity, record);
  }
  to_keep = static_cast<uint8_t>(to_keep & ~keeping);
  if (!has_begun) keeping = 0;  // it is too large; there is no such program
}

void tick_store() {
  store.tick(may_commit());
  const bool is_busy = store.is_busy();
  const bool is_kept = store.state() == StoreState::kSaved;
  if (boot != Boot::kOver) {
    if (is_low) tell_saving();
    return load_next();
  }
  if (!is_busy && keeping == kKeepProgram) {
    condition.saved = is_kept ? Saved::kStored : Saved::kMemory;
    if (is_kept) condition.slot = store.used(Area::kProgram);
  } else if (((to_keep | keeping) & kKeepProgram) != 0) {
    tell_saving();
  }
  if (is_busy) return;
  if (keeping == kKeepIdentity) is_worn = !is_kept;
  keeping = 0;
  if (to_keep != 0) keep_next();
}

// What is not to be had now: why.
Answer not_now() { return is_low ? Answer::kLowSupply : Answer::kBusy; }

// Takes over what a computer says of who the robot is.
void change(uint8_t* to, const uint8_t* from, uint8_t length) {
  for (uint8_t k = 0; k < length; k++) {
    if (to[k] != from[k]) to_keep |= kKeepIdentity;
    to[k] = from[k];
  }
}

// Whether that is kept. What a worn memory has not kept is tried again.
Answer identity_kept() {
  if (((to_keep | keeping) & kKeepIdentity) != 0) {
    return is_low ? Answer::kLowSupply : Answer::kSaving;
  }
  if (!is_worn) return Answer::kOk;
  to_keep |= kKeepIdentity;
  return Answer::kNotKept;
}

// -- a run --------------------------------------------------------------------------------------

// Motors off before anything else. Where a program has not come to its own end, actuators follow.
void end_run(State state, bool is_done = false) {
  board_stop();
  if (!is_done) board_actuators_off();
  robot_off();
  may_start = is_driving = is_start_due = false;
  condition.state = state;
  show_light();
}

void fault(uint8_t number, uint16_t at) {
  talk.seal();  // the record has the checksum of its image
  condition.fault = number;
  condition.fault_at = at;
  condition.fault_program = is_live_run ? number32(live + kChecksumAt) : condition.program;
  to_keep |= kKeepFault;
  board_faulted();
}

void begin_run(bool is_live) {
  const uint8_t* const image = is_live ? live : program;
  is_live_run = is_live;
  is_start_due = false;
  began_ms = now_ms;
  may_start = false;
  condition.state = State::kRunning;
  condition.run++;
  for (uint8_t k = 0; k < board.sensors; k++) board.readings[k] = 0;
  board_forget();
  board_release();
  if (talk.stop_is_due()) board_stop();  // it came before this; one that comes now does it itself
  machine.start(image + kHeaderBytes, number16(image + kCodeLengthAt), board.readings,
                equipment.sensors, (now_ms ^ board.seed) | 1, now_ms);
  show_light();
}

void run_on() {
  const Status status = machine.tick(now_ms, kBudget);
  if (status == Status::kDone) {
    end_run(State::kIdle, true);
    board_finished();
    talk.done();
  } else if (status == Status::kFault) {
    end_run(State::kFaulted);
    fault(static_cast<uint8_t>(machine.fault()), machine.at());
    talk.faulted();
  } else if (!talk.is_tethered() && now_ms - began_ms >= board.max_run_ms) {
    port_stop(static_cast<uint8_t>(LinkFault::kMaxRun));
    talk.faulted();
  }
}

}  // namespace

void firmware_begin(const Board& what) {
  board = what;
  card.kit = what.kit;
  equipment.sensors = what.sensors;
  equipment.actuators = what.actuators;
  card.reset = what.reset;
  card.nonce = what.seed;
  condition.slot = kNoSlot;
  store.boot();
  talk.begin(&receiver, static_cast<uint8_t>(what.seed & 0xff));
}

void firmware_tick(uint32_t time_ms) {
  now_ms = time_ms;
  talk.tick(static_cast<uint16_t>(time_ms));
  if (board_has_stalled() && condition.state == State::kRunning) {
    port_stop(static_cast<uint8_t>(LinkFault::kStall));
    talk.faulted();
  }
  if (is_start_due && load() && is_start_due) {
    is_start_due = false;
    if (is_whole) begin_run(false);
  }
  // No motor starts while a byte is written that makes something count.
  if (condition.state == State::kRunning && !store.is_committing()) run_on();
  talk.tell();
  tick_store();
}

void firmware_on_pressed() {
  may_start = condition.state != State::kRunning;
  if (may_start) return;
  end_run(State::kStopped);
  talk.stopped(Cause::kButton);
}

void firmware_on_held() {
  if (condition.state == State::kRunning) firmware_on_pressed();
}

void firmware_on_disconnect() {
  if (condition.state != State::kRunning || !talk.is_tethered()) return;
  end_run(State::kStopped);
  talk.stopped(Cause::kCable);
}

void firmware_on_released() {
  if (!may_start || boot != Boot::kOver) return;
  talk.drop();
  is_start_due = condition.saved != Saved::kNothing;
}

void firmware_on_rx_byte(uint8_t byte, uint16_t time_ms) {
  if (receiver.put(byte, time_ms)) board_stop();
}

// The checksum may not be in the image yet.
bool firmware_runs(Place* place) {
  if (condition.state != State::kRunning) return false;
  const uint8_t* const image = is_live_run ? live : program;
  const uint16_t most = is_live_run ? kLiveBytes : kStoredCodeBytes;
  const uint16_t length = number16(image + kCodeLengthAt);
  place->program =
      crc32(crc32(0, image, kChecksumAt), image + kHeaderBytes, length < most ? length : most);
  place->at = machine.at();
  return true;
}

bool firmware_next_tx_byte(uint8_t* byte) { return talk.next(byte); }

// -- what the link asks -------------------------------------------------------------------------

const Equipment& port_equipment() { return equipment; }

const Card& port_card() { return card; }

const Condition& port_condition() { return condition; }

const Trim& port_trim() { return trim; }

LineErrors port_line_errors() { return board_line_errors(); }

uint16_t port_room() { return kStoredCodeBytes; }

Answer port_make_way(bool is_live) {
  if (boot != Boot::kOver) return not_now();
  if (condition.state == State::kRunning) end_run(State::kIdle);
  is_start_due = false;
  if (is_live) return load() ? Answer::kOk : Answer::kBusy;
  if (is_low) {
    // a program that waits for other batteries may wait for ever: the next one is worth more
    if (keeping == kKeepProgram) {
      store.give_up();
      keeping = 0;
      is_low = false;
    }
    to_keep &= static_cast<uint8_t>(~kKeepProgram);
  } else if (store.is_busy() || (to_keep & kKeepProgram) != 0) {
    return Answer::kBusy;  // what is being written cannot be read either
  }
  return Answer::kOk;
}

void port_forget() {
  name_stored();
  show_light();
}

uint8_t* port_memory(uint16_t code_length, bool is_live) {
  if (is_live) return code_length <= kLiveBytes ? live : nullptr;
  return code_length <= kStoredCodeBytes ? program : nullptr;
}

void port_take(uint8_t mode, bool is_live) {
  if (is_live) return;
  is_whole = true;
  condition.length = number16(program + kCodeLengthAt);
  condition.slot = kNoSlot;
  condition.saved = Saved::kMemory;
  if ((mode & kSave) != 0) {
    tell_saving();
    to_keep |= kKeepProgram;
  }
  show_light();
}

void port_seal(const uint8_t* image) {
  if (image == program) condition.program = number32(image + kChecksumAt);
}

void port_start(bool is_live) {
  if (is_live || is_whole) begin_run(is_live);
}

void port_stop(uint8_t number) {
  const bool was_running = condition.state == State::kRunning;
  end_run(number != 0 ? State::kFaulted : State::kStopped);
  if (was_running && number != 0) fault(number, machine.at());
}

void port_release() {
  if (condition.state >= State::kStopped) condition.state = State::kIdle;
}

Answer port_image_byte(uint16_t offset, uint8_t* byte) {
  *byte = program[offset];
  const bool is_there =
      is_whole || (boot == Boot::kOver && store.fetch(Area::kProgram, offset, byte));
  return is_there ? Answer::kOk : not_now();
}

Answer port_rename(const uint8_t* name, uint8_t length) {
  if (boot != Boot::kOver) return not_now();
  change(&equipment.name_length, &length, 1);
  change(equipment.name, name, length);
  return identity_kept();
}

Answer port_set_trim(const Trim& found) {
  if (!is_sound(found)) return Answer::kBadValue;
  if (boot != Boot::kOver) return not_now();
  change(reinterpret_cast<uint8_t*>(&trim), reinterpret_cast<const uint8_t*>(&found), sizeof trim);
  return identity_kept();
}

void robot_motors(int8_t left, int8_t right) {
  const Levels levels = trimmed(trim, left, right);
  is_driving = (left | right) != 0;
  board_motors(levels.left, levels.right);
}

// What a program shows goes to whoever listens.
bool robot_show(int32_t value, bool is_yes_no) { return talk.show(value, is_yes_no); }

}  // namespace tiniscript
