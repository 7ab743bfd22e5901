#include "persistence.h"

#include "../store/nvm.h"
#include "../vm/flags.h"
#include "../vm/small.h"
#include "identity.h"
#include "program.h"
#include "run.h"
#include "state.h"

namespace tiniscript {

namespace {

constexpr uint16_t kLowMs = 500;  // between two checks of a supply that is too low

// The data read from the store after a reset, in this order.
enum class Boot : uint8_t { kSettling, kIdentity, kFault, kProgram, kOver };

// The data to save when the store is free: one bit each.
constexpr uint8_t kProgramBit = 1;
constexpr uint8_t kFaultBit = 2;
constexpr uint8_t kIdentityBit = 4;
constexpr uint8_t kOwnerBit = 8;

Boot boot;
uint8_t record[kOwnerBytes];
QuickByte<kDueSavesAt> due_saves;
QuickByte<kCurrentSaveAt> current_save;  // the bits that the store is writing
Flag<Bit::kLow> is_low;                  // saving waits for more voltage
uint16_t low_ms;                         // when that wait began
uint8_t failed_saves;                    // data that it has failed to save since the request: bits

// -- after a reset ------------------------------------------------------------------------------

void load_identity() {
  if (store.fetch_first(Area::kIdentity, record, kRecordBytes)) return read_identity(record);
  make_identity();
  keep_identity();
}

// The record of a fault: its kind, its place, its image. A hang that the watchdog ended is newer.
void load_fault() {
  const bool is_stored = store.fetch_first(Area::kFault, record, kRecordBytes);
  if (is_stored) read_pace(record);
  Place place;
  if (board_take_hang(&place)) {
    robot_status.fault = static_cast<uint8_t>(LinkFault::kStall);
    robot_status.fault_at = place.offset;
    robot_status.fault_program = place.checksum;
    return keep_fault();
  }
  if (is_stored) copy_bytes(record + kFaultAt, &robot_status.fault, kFaultBytes);
}

// Reads the next item when the store is free.
void load_next() {
  if (store.is_busy()) return;
  switch (boot) {
    case Boot::kSettling:
      boot = Boot::kIdentity;
      return;
    case Boot::kIdentity:
      load_identity();
      read_owner();
      boot = Boot::kFault;
      return;
    case Boot::kFault:
      load_fault();
      hold_stored();
      boot = Boot::kProgram;
      return;
    case Boot::kProgram:
      if (!load_program()) return;
      boot = Boot::kOver;
      show_light();
      return;
    case Boot::kOver:
      return;
  }
}

// -- keeping ------------------------------------------------------------------------------------

void write_record() {
  for (uint8_t& byte : record) byte = 0;
  if (current_save == kIdentityBit) {
    write_identity(record);
  } else {
    copy_bytes(&robot_status.fault, record + kFaultAt, kFaultBytes);
    copy_bytes(&port_tuning().pace, record + kPaceAt, sizeof(Pace));
  }
}

// Whether a commit byte may be written: motors off and enough voltage.
bool may_commit() {
  if (is_driving() || !store.is_ready_to_commit()) return false;
  if (is_low && static_cast<uint16_t>(now_ms - low_ms) < kLowMs) return false;
  const Supply supply = board_supply();
  if (supply == Supply::kMeasuring) return false;
  is_low = supply == Supply::kLow;
  low_ms = static_cast<uint16_t>(now_ms);
  return !is_low;
}

void tell_saving() { robot_status.saved = is_low ? Saved::kLowSupply : Saved::kSaving; }

// Begins the next save, a program first.
void keep_next() {
  current_save = static_cast<uint8_t>(due_saves & -due_saves);
  bool has_begun;
  if (current_save == kProgramBit) {
    has_begun = store.begin_save(program);
  } else {
    write_record();
    has_begun =
        store.begin_save_record(current_save == kFaultBit ? Area::kFault : Area::kIdentity, record);
  }
  due_saves = static_cast<uint8_t>(due_saves & ~current_save);
  if (!has_begun) current_save = 0;  // too large: no such program exists
}

// The record stays in memory until it is saved, so no other record may wait to be saved.
bool may_keep_keys() { return has_booted() && !store.is_busy() && (due_saves | current_save) == 0; }

void keep_keys() {
  store.begin_save_record(Area::kOwner, record);
  current_save = kOwnerBit;
  failed_saves &= static_cast<uint8_t>(~kOwnerBit);
}

}  // namespace

void tick_persistence() {
  if (boot == Boot::kOver && (due_saves | current_save) == 0) return;  // no data to save
  if (link.has_due_live()) return;
  store.tick(may_commit());
  const bool is_busy = store.is_busy();
  const bool is_saved = store.state() == StoreState::kSaved;
  if (boot != Boot::kOver) {
    if (is_low) tell_saving();
    return load_next();
  }
  if (!is_busy && current_save == kProgramBit) {
    robot_status.saved = is_saved ? Saved::kStored : Saved::kMemory;
    if (is_saved) robot_status.slot = store.current_slot(Area::kProgram);
  } else if (((due_saves | current_save) & kProgramBit) != 0) {
    tell_saving();
  }
  if (is_busy) return;
  if (!is_saved) failed_saves |= current_save;
  if (current_save == kOwnerBit) read_owner();
  current_save = 0;
  if (due_saves != 0) keep_next();
}

bool has_booted() { return boot == Boot::kOver; }

void keep_program() {
  tell_saving();
  due_saves = due_saves | kProgramBit;
}

void keep_fault() { due_saves = due_saves | kFaultBit; }

void keep_identity() {
  due_saves = due_saves | kIdentityBit;
  failed_saves &= kOwnerBit;
}

Answer identity_save_answer() {
  if (((due_saves | current_save) & (kIdentityBit | kFaultBit)) != 0) {
    return is_low ? Answer::kLowSupply : Answer::kSaving;
  }
  if ((failed_saves & (kIdentityBit | kFaultBit)) == 0) return Answer::kOk;
  keep_identity();
  keep_fault();
  return Answer::kNotKept;
}

bool fetch_key(uint8_t kind, uint8_t* key) {
  if (!has_booted() && boot <= Boot::kSettling) return false;
  const bool is_stored = store.current_slot(Area::kOwner) != kNoSlot;
  for (uint8_t k = 0; k < kKeyRoom; k++) {
    key[k] = 0;
    const uint16_t offset = static_cast<uint16_t>(kKeysAt + kind * kKeyRoom + k);
    if (is_stored && !store.fetch(Area::kOwner, offset, key + k)) return false;
  }
  return true;
}

Answer port_keep_key(uint8_t kind, const uint8_t* key) {
  if (!may_keep_keys()) return busy_answer();
  for (uint8_t k = 0; k < kOwnerKeys; k++) {
    if (!fetch_key(k, record + kKeysAt + k * kKeyRoom)) return busy_answer();
  }
  copy_bytes(key, record + kKeysAt + kind * kKeyRoom, kKeyRoom);
  const bool has_failed = (failed_saves & kOwnerBit) != 0;
  keep_keys();
  link.expire_others();
  return has_failed ? Answer::kNotKept : Answer::kSaving;
}

bool forget_keys() {
  if (!may_keep_keys()) return false;
  for (uint8_t& byte : record) byte = 0;
  keep_keys();
  return true;
}

Answer owner_save_answer() {
  if (current_save != kOwnerBit) return Answer::kOk;
  return is_low ? Answer::kLowSupply : Answer::kSaving;
}

Answer give_up_program() {
  if (is_low) {
    // The wait for enough voltage may never end, so the next program takes precedence.
    if (current_save == kProgramBit) {
      store.give_up();
      current_save = 0;
      is_low = false;
    }
    due_saves = static_cast<uint8_t>(due_saves & ~kProgramBit);
  } else if (store.is_busy() || (due_saves & kProgramBit) != 0) {
    return Answer::kBusy;  // a program that is being written cannot be read
  }
  return nvm_is_ready() ? Answer::kOk : Answer::kBusy;
}

Answer busy_answer() { return is_low ? Answer::kLowSupply : Answer::kBusy; }

}  // namespace tiniscript
