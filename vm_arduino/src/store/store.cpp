#include "store.h"

#include "../vm/cpu.h"
#include "../vm/crc32.h"
#include "../vm/image.h"
#include "../vm/small.h"
#include "nvm.h"

namespace tiniscript {

namespace {

// Generation numbers wrap around. Each generation has a mark of its own, which differs from the
// marks of a slot that is being written (0) and of an empty slot.
constexpr uint8_t kGenerations = 0x40;
constexpr uint8_t kMarkMask = 0xa5;
constexpr uint8_t kEmptyByte = 0xff;

// The known state of a slot: its generation, or that it holds nothing.
constexpr uint8_t kRefusedBit = kGenerations;  // added to the generation: the slot does not count
constexpr uint8_t kNothing = 0xff;

// The write steps of a slot. `docs/develop/store.md` says why they come in this order.
enum class WriteStep : uint8_t {
  kLook,
  kClear,       // one of the first bytes of the slot: to 0, without an erase
  kGeneration,  // its own number
  kMark,        // the mark of its generation
  kEmpty,       // the value of empty memory
  kBody,
  kCheck,
  kEnd,
};

constexpr uint8_t step(WriteStep kind, uint8_t offset = 0) {
  return static_cast<uint8_t>(static_cast<uint8_t>(kind) * 16 + offset);
}

constexpr uint8_t kSteps[] tini_progmem = {
    // settling: determine what a slot holds
    step(WriteStep::kLook),
    // settling: its contents never count
    step(WriteStep::kEmpty, 0),
    step(WriteStep::kEmpty, kBodyAt),
    step(WriteStep::kEmpty, 1),
    step(WriteStep::kEnd),
    // saving
    step(WriteStep::kClear, 3),
    step(WriteStep::kClear, 2),
    step(WriteStep::kClear, 1),
    step(WriteStep::kGeneration),
    step(WriteStep::kBody),
    step(WriteStep::kCheck),
    step(WriteStep::kMark, 1),
    step(WriteStep::kMark, 2),
    step(WriteStep::kMark, 3),
    step(WriteStep::kEnd),
    // settling: its contents count for good
    step(WriteStep::kGeneration),
    step(WriteStep::kMark, 1),
    step(WriteStep::kMark, 2),
    step(WriteStep::kMark, 3),
    step(WriteStep::kEnd),
};

// Offsets in kSteps.
constexpr uint8_t kLooking = 0;
constexpr uint8_t kEmptying = 1;
constexpr uint8_t kEmptyingEnd = 4;
constexpr uint8_t kSaving = 5;
constexpr uint8_t kCommitting = 11;  // later steps wait for `may_commit`
constexpr uint8_t kKeeping = 15;
constexpr uint8_t kKeepingMarks = 17;
constexpr uint8_t kKeepingEnd = 19;

static_assert(kSteps[kEmptying] == step(WriteStep::kEmpty, 0), "emptying begins here");
static_assert(kSteps[kEmptyingEnd] == step(WriteStep::kEnd), "emptying ends here");
static_assert(kSteps[kSaving - 1] == step(WriteStep::kEnd), "saving begins here");
static_assert(kSteps[kCommitting] == step(WriteStep::kMark, 1),
              "what is saved counts from here on");
static_assert(kSteps[kKeeping] == step(WriteStep::kGeneration), "keeping begins here");
static_assert(kSteps[kKeepingMarks] == step(WriteStep::kMark, 2), "the first mark stays as it is");
static_assert(kSteps[kKeepingEnd] == step(WriteStep::kEnd), "keeping ends here");

// The beginning of each slot: the table is shorter than its calculation.
constexpr uint16_t kStarts[] tini_progmem = {place_of(0), place_of(1), place_of(2), place_of(3),
                                             place_of(4), place_of(5), place_of(6), place_of(7)};
static_assert(sizeof kStarts == kSlots * sizeof(uint16_t), "each slot begins somewhere");

// The mark without which what was saved does not count: where all of them are one write, the last.
constexpr uint8_t kLastNeeded = kWritesStopTheChip ? kMarks : 1;

uint16_t start_of(uint8_t slot) { return flash_word(kStarts + slot); }

uint16_t plus(uint16_t place, uint16_t count) { return static_cast<uint16_t>(place + count); }

// A byte of the body of the slot at `place`. The first byte is stored XOR the generation, so that
// the checksum is wrong under another generation.
uint8_t body_byte(uint16_t place, uint16_t offset) {
  const uint8_t byte = nvm_read(plus(place, plus(kBodyAt, offset)));
  return offset == 0 ? byte ^ nvm_read(place) : byte;
}

tini_noinline uint32_t checksum(uint32_t crc, uint16_t place, uint16_t offset, uint16_t end) {
  while (offset != end) {
    const uint8_t byte = body_byte(place, offset++);
    crc = crc32(crc, &byte, 1);
  }
  return crc;
}

// The length of an image, or 0 if it is none or does not fit. Images of version 1 are none: they
// state no length of a header.
uint16_t image_bytes(uint8_t header, uint8_t low, uint8_t high) {
  if (header < kHeaderBytes) return 0;
  const uint16_t code = static_cast<uint16_t>(low | high << 8);
  return code > kImageBytes - header ? 0 : plus(code, header);
}

bool is_program(uint8_t slot) { return slot < 2; }

uint8_t record_bytes(uint8_t slot) { return slot < kFirstOwnerSlot ? kRecordBytes : kOwnerBytes; }

}  // namespace

void Store::boot() {
  for (uint8_t& slot_state : slot_states_) slot_state = kNothing;
  state_ = StoreState::kSettling;
  is_busy_ = true;
  step_ = kLooking;
  first_waiting_step_ = kCommitting;
  select_slot(0);
}

tini_noinline void Store::tick(bool may_commit) {
  if (!is_busy_ || !nvm_is_ready()) return;
  const uint8_t step = flash_byte(kSteps + step_);
  if (step_ >= first_waiting_step_ && !may_commit && step != tiniscript::step(WriteStep::kEnd))
    return;
  const uint8_t offset = step % 16;
  uint8_t value = kEmptyByte;
  switch (static_cast<WriteStep>(step / 16)) {
    case WriteStep::kLook:
      return near(this)->look();
    case WriteStep::kEnd:
      return near(this)->finish();
    case WriteStep::kClear:
      slot_states_[slot_] = kNothing;
      nvm_clear(plus(place_, offset));
      step_++;
      return;
    case WriteStep::kBody:
    case WriteStep::kCheck: {
      value = bytes_[offset_];
      const bool is_equal = body_byte(place_, offset_) == value;
      if (step == tiniscript::step(WriteStep::kBody)) {
        if (offset_ == 0) value ^= generation_;
        if (!is_equal || !is_stable_) nvm_write(plus(place_, plus(kBodyAt, offset_)), value);
      } else if (!is_equal) {
        state_ = StoreState::kFailed;
        step_ = kEmptying;
        return;
      }
      if (++offset_ == length_) {
        offset_ = 0;
        step_++;
      }
      return;
    }
    case WriteStep::kGeneration:
      value = generation_;
      break;
    case WriteStep::kMark:
      value = generation_ ^ kMarkMask;
      break;
    case WriteStep::kEmpty:
      break;
  }
  nvm_write(plus(place_, offset), value);
  step_++;
}

bool Store::is_ready_to_commit() const {
  return is_busy_ && step_ >= first_waiting_step_ && nvm_is_ready();
}

// The write of a commit byte has begun and is not finished.
bool Store::is_committing() const {
  return is_busy_ && !nvm_is_ready() && step_ > first_waiting_step_;
}

void Store::give_up() {
  if (!is_ready_to_commit() || state_ != StoreState::kSaving) return;
  state_ = StoreState::kIdle;
  is_busy_ = false;
}

tini_noinline bool Store::begin_save(const uint8_t* image) {
  const uint16_t length =
      image_bytes(image[kHeaderLengthAt], image[kCodeLengthAt], image[kCodeLengthAt + 1]);
  return length != 0 && near(this)->begin_write(Area::kProgram, image, length);
}

bool Store::begin_save_record(Area area, uint8_t* record) {
  if (is_busy_) return false;
  const uint8_t length = record_bytes(static_cast<uint8_t>(2 * static_cast<uint8_t>(area)));
  const uint32_t check =
      crc32(0, record + kCheckBytes, static_cast<uint16_t>(length - kCheckBytes));
  __builtin_memcpy(record, &check, kCheckBytes);
  return near(this)->begin_write(area, record, length);
}

void Store::refuse() {
  const uint8_t slot = current_slot(Area::kProgram);
  if (slot != kNoSlot) slot_states_[slot] |= kRefusedBit;
}

void Store::readmit(uint8_t slot) { slot_states_[slot] &= static_cast<uint8_t>(~kRefusedBit); }

bool Store::fetch(Area area, uint16_t offset, uint8_t* byte) const {
  const uint8_t slot = current_slot(area);
  if (slot == kNoSlot || !nvm_is_ready()) return false;
  *byte = body_byte(start_of(slot), offset);
  return true;
}

bool Store::fetch_first(Area area, uint8_t* bytes, uint16_t length) const {
  for (uint16_t k = 0; k < length; k++) {
    if (!fetch(area, k, bytes + k)) return false;
  }
  return true;
}

uint8_t Store::current_slot(Area area) const { return newest_slot(area, kRefusedBit); }

tini_noinline void Store::select_slot(uint8_t slot) {
  slot_ = slot;
  place_ = start_of(slot);
}

// Selects the slot other than `slot` (or any, if that is none).
void Store::select_other_slot(Area area, uint8_t slot) {
  select_slot(slot == kNoSlot ? static_cast<uint8_t>(2 * static_cast<uint8_t>(area)) : slot ^ 1);
}

tini_noinline bool Store::begin_write(Area area, const uint8_t* bytes, uint16_t length) {
  if (is_busy_ || !nvm_is_ready()) return false;
  const uint8_t slot = current_slot(area);
  if (slot != kNoSlot && is_in(slot, bytes, is_program(slot) ? kHeaderBytes : kCheckBytes)) {
    state_ = StoreState::kSaved;
    return true;
  }
  const uint8_t newest = newest_slot(area, kNothing);
  generation_ = newest == kNoSlot ? 0 : (slot_states_[newest] + 1) & (kGenerations - 1);
  select_other_slot(area, slot);
  is_stable_ = slot_states_[slot_] != kNothing;
  bytes_ = bytes;
  length_ = length;
  first_waiting_step_ = kWritesStopTheChip ? kLooking : kCommitting;
  if (is_stable_ && is_in(slot_, bytes, length)) {
    // It may be the only copy: it gets another generation, and that waits from its first byte on.
    length_ = 1;
    first_waiting_step_ = kWritesStopTheChip ? kLooking : kSaving;
  }
  offset_ = 0;
  state_ = StoreState::kSaving;
  step_ = kSaving;
  is_busy_ = true;
  return true;
}

// Whether a slot that counts begins with these bytes.
tini_noinline bool Store::is_in(uint8_t slot, const uint8_t* bytes, uint16_t count) {
  const uint16_t place = start_of(slot);
  do {
    if (count-- == 0) return true;
  } while (body_byte(place, count) == bytes[count]);
  return false;
}

// Decides once what a slot holds: a byte whose write was cut may read differently later.
void Store::look() {
  const uint16_t place = place_;
  uint8_t& slot_state = slot_states_[slot_];
  const uint8_t generation = nvm_read(place);
  const uint8_t first = nvm_read(place + 1);
  const uint8_t mark = generation ^ kMarkMask;
  generation_ = generation;
  step_ = generation == kEmptyByte && first == kEmptyByte ? kEmptyingEnd : kEmptying;
  if (generation >= kGenerations || first != mark || !is_sound()) return;
  slot_state = generation;
  // The last mark present may be the one whose write was cut. If it is the only one, it and the
  // generation are rewritten, as the slot may have been about to be emptied. Otherwise both are
  // left as they are.
  if (!kCutBytesAreUnstable) {
    step_ = kKeepingEnd;
    return;
  }
  step_ = nvm_read(place + 2) != mark   ? kKeeping
          : nvm_read(place + 3) != mark ? kKeepingMarks
                                        : kKeepingEnd;
}

// Whether the checksum of a slot's body is right.
bool Store::is_sound() {
  uint16_t length = record_bytes(slot_);
  uint16_t check = 0;
  if (is_program(slot_)) {
    length = image_bytes(body_byte(place_, kHeaderLengthAt), body_byte(place_, kCodeLengthAt),
                         body_byte(place_, kCodeLengthAt + 1));
    if (length == 0) return false;
    check = kChecksumAt;
  }
  const uint16_t check_end = plus(check, kCheckBytes);
  uint32_t crc = checksum(0, place_, 0, check);
  crc = checksum(crc, place_, check_end, length);
  return checksum(crc, place_, check, check_end) == kCrcResidue;
}

// The slot of an area with the latest generation below `end`.
tini_noinline uint8_t Store::newest_slot(Area area, uint8_t end) const {
  const uint8_t slot = static_cast<uint8_t>(2 * static_cast<uint8_t>(area));
  const uint8_t first = slot_states_[slot];
  const uint8_t second = slot_states_[slot + 1];
  if (second >= end) return first >= end ? kNoSlot : slot;
  const uint8_t difference = static_cast<uint8_t>(second - first);
  const bool is_first = first < end && difference % kGenerations >= kGenerations / 2;
  return is_first ? slot : slot ^ 1;
}

// Finishes work on the slot.
void Store::finish() {
  uint8_t slot = slot_;
  const StoreState state = state_;
  if (state == StoreState::kSaving) {
    // Without generation and first mark, a slot does not count, however worn the memory is.
    if (nvm_read(place_) != generation_ ||
        nvm_read(plus(place_, kLastNeeded)) != (generation_ ^ kMarkMask)) {
      state_ = StoreState::kFailed;
    } else {
      slot_states_[slot] = generation_;
      state_ = StoreState::kSaved;
    }
  } else if (state == StoreState::kSettling) {
    step_ = kLooking;
    if (++slot != kSlots) return select_slot(slot);
    state_ = StoreState::kIdle;
  }
  is_busy_ = false;
}

}  // namespace tiniscript
