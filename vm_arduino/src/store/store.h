// What a robot keeps without power: a program, and two small records.
//
// Writes into `nvm.h`, one byte in a call of `tick`, while a program runs; nothing here waits. Pull
// the plug at any moment: at the next start there is what was kept before, or what was to be kept,
// whole, and the same at every later start. `docs/store.md` says how, and why in this order.
//
// Knows checksums. Whether a robot may run a program is for the caller to say (`refuse`).

#ifndef TINISCRIPT_STORE_STORE_H_
#define TINISCRIPT_STORE_STORE_H_

#include <stdint.h>

#include "layout.h"

namespace tiniscript {

enum class StoreState : uint8_t {
  kSettling,  // after `boot`: nothing is known yet, and what a cut has left is put in order
  kIdle,
  kSaving,
  kSaved,
  kFailed,  // the memory does not keep what is written; what counted before still does
};

constexpr uint8_t kNoSlot = 0xff;

class Store {
 public:
  // Begins to look at what is there.
  void boot();

  // Does a little: writes at most one byte. What makes something count waits for `may_commit`, that
  // is, motors off and enough voltage. After `boot` a call may take as long as the checksum of a
  // program.
  void tick(bool may_commit);

  StoreState state() const { return state_; }

  // Whether `tick` has something to do. Nothing else begins until it has not.
  bool is_busy() const { return is_busy_; }

  // Whether the next byte waits for `may_commit`, if there is one, and the memory is ready for it.
  bool is_ready_to_commit() const;

  // Whether such a byte is being written.
  bool is_committing() const;

  // Gives up a save that waits so: what counted before still does, and the next save goes into the
  // same slot. After a start before that, what was given up counts if its first mark was written.
  void give_up();

  // Begins to save an image that `unpack` has accepted; it must stay as it is while `is_busy`. What
  // is stored already is saved at once. False: busy, or too large.
  bool begin_save(const uint8_t* image);

  // Begins to keep a record of kRecordBytes, and puts the check into its first bytes. On the same
  // conditions.
  bool begin_keep(Area area, uint8_t* record);

  // The slot of what counts, or kNoSlot. Means nothing while settling.
  uint8_t used(Area area) const;

  // The program that counts is none for this robot: now the one before it counts, or none. This
  // writes nothing; after `boot` it is offered again.
  void refuse();

  // Puts a byte of the image or record that counts into `*byte`; `at` lies in it. False: there is
  // none, or the memory is writing (ask again); while nothing is busy, it is not.
  bool fetch(Area area, uint16_t at, uint8_t* byte) const;

  // The same with its first `length` bytes. Where it returns false, some may have been put.
  bool fetch_first(Area area, uint8_t* bytes, uint16_t length) const;

 private:
  void look();
  bool is_sound() const;
  void finish();
  bool begin_write(Area area, const uint8_t* bytes, uint16_t length);
  void go_to(uint8_t slot);
  void go_beside(Area area, uint8_t slot);
  uint8_t newest(Area area, uint8_t end) const;

  StoreState state_;
  bool is_busy_;
  uint8_t held_[kSlots];

  // what is being done
  uint8_t step_;
  uint8_t slot_;
  uint16_t place_;      // of the slot
  uint8_t generation_;  // of the slot
  bool is_stable_;      // equal bytes of the body need not be written
  const uint8_t* bytes_;
  uint16_t length_;
  uint16_t at_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_STORE_STORE_H_
