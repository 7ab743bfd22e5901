// The robot's non-volatile data: a program and three records.
//
// Writes through `nvm.h`, one byte per call of `tick`, while a program runs; nothing here blocks.
// After a power cut at any moment, the next start finds either the old or the new data, whole, and
// so does every later start. `docs/develop/store.md` explains how, and the order of steps.
//
// Knows checksums. The caller decides whether a robot may run a program (`refuse`).

#pragma once

#include <stdint.h>

#include "layout.h"

namespace tiniscript {

enum class StoreState : uint8_t {
  kSettling,  // after `boot`: finds the current data and repairs what a power cut left
  kIdle,
  kSaving,
  kSaved,
  kFailed,  // the memory does not keep what is written; the old data still counts
};

constexpr uint8_t kNoSlot = 0xff;

class Store {
 public:
  // Begins to look for saved data.
  void boot();

  // Does a little: writes at most one byte. Commit bytes wait for `may_commit`: motors off and
  // enough voltage. After `boot` a call may take as long as the checksum of a program.
  void tick(bool may_commit);

  StoreState state() const { return state_; }

  // Whether `tick` has work to do. Until it is done, no other operation may begin.
  bool is_busy() const { return is_busy_; }

  // Whether the next byte, if any, waits for `may_commit` and the memory is ready for it.
  bool is_ready_to_commit() const;

  // Whether a commit byte is being written.
  bool is_committing() const;

  // Gives up a save that waits for `may_commit`: the old data still counts, and the next save uses
  // the same slot. If the power fails before that, the given-up data counts if its first mark was
  // written.
  void give_up();

  // Begins to save an image that `unpack` has accepted; it must not change while `is_busy`. If it
  // is already stored, the save is done at once. False: busy, or too large.
  bool begin_save(const uint8_t* image);

  // Begins to save a record (of kRecordBytes, or kOwnerBytes) and puts the check into its first
  // bytes. Same conditions.
  bool begin_save_record(Area area, uint8_t* record);

  // The slot of the current data, or kNoSlot. Undefined while settling.
  uint8_t current_slot(Area area) const;

  // The current program does not suit this robot: the one before it, or none, is now current. This
  // writes nothing; after `boot` the program is offered again.
  void refuse();

  // Takes back that a slot, whose data has counted before, was refused.
  void readmit(uint8_t slot);

  // Puts a byte of the current image or record into `*byte`; `offset` must lie in it. False: there is
  // none, or the memory is writing (try again). The memory never writes while the store is idle.
  bool fetch(Area area, uint16_t offset, uint8_t* byte) const;

  // The same for its first `length` bytes. If it returns false, some may have been put.
  bool fetch_first(Area area, uint8_t* bytes, uint16_t length) const;

 private:
  void look();
  bool is_sound();
  void finish();
  static bool is_in(uint8_t slot, const uint8_t* bytes, uint16_t count);
  bool begin_write(Area area, const uint8_t* bytes, uint16_t length);
  void select_slot(uint8_t slot);
  void select_other_slot(Area area, uint8_t slot);
  uint8_t newest_slot(Area area, uint8_t end) const;

  StoreState state_;
  bool is_busy_;
  uint8_t slot_states_[kSlots];

  // The current work.
  uint8_t step_;
  uint8_t slot_;
  uint16_t place_;              // of the slot
  uint8_t generation_;          // of the slot
  uint8_t first_waiting_step_;  // steps from this one on wait for `may_commit`
  bool is_stable_;              // equal bytes of the body need not be written again
  const uint8_t* bytes_;
  uint16_t length_;
  uint16_t offset_;
};

}  // namespace tiniscript
