// Implements `nvm.h` on an ESP32: each slot of the store is two entries of NVS.
//
// The head of a slot (generation and marks) is a number, written at once. Its body is a blob: the
// bytes that are written wait, and the first one that is read again has them all written. So what
// is read is in flash, and a program takes one write instead of one for each byte. NVS leaves an
// entry as it was when the power fails, or writes it, or loses it; the store stands all three.
//
// A write may stop the chip for 50 ms and more, as long as a page is erased: `kWritesStopTheChip`
// lets the store wait until the motors are off.

#ifdef ARDUINO_ARCH_ESP32

#include <nvs.h>

#include "../../store/layout.h"
#include "../../store/nvm.h"

namespace tiniscript {

namespace {

constexpr char kNamespace[] = "tiniscript";
constexpr uint8_t kEmpty = 0xff;

uint8_t memory[kMemoryBytes];
uint16_t used[kSlots];  // bytes of each body that its blob has
bool is_loaded;
bool is_open;
nvs_handle_t handle;
uint8_t waiting = kSlots;  // the slot whose body waits to be written
uint16_t first_waiting;    // the places of its bytes that wait
uint16_t last_waiting;

// A key: h0 is the head of slot 0, b0 its body.
struct Key {
  char text[3];
};

Key key_of(char what, uint8_t slot) { return {{what, static_cast<char>('0' + slot), '\0'}}; }

// Where the body of a slot ends at the latest.
uint16_t room_of(uint8_t slot) {
  if (slot >= kFirstOwnerSlot) return kOwnerBytes;
  return slot < 2 ? kProgramSlot - kBodyAt : kRecordBytes;
}

uint8_t* body_of(uint8_t slot) { return memory + place_of(slot) + kBodyAt; }

// The slot of a place. A program of version 1 could reach behind its slot, but none is on this
// chip.
uint8_t slot_of(uint16_t place) {
  for (uint8_t slot = 0; slot < kSlots; slot++) {
    const uint16_t begin = place_of(slot);
    if (place >= begin && place - begin < kBodyAt + room_of(slot)) return slot;
  }
  return kSlots;
}

void load_head(uint8_t slot) {
  uint32_t head = 0xffffffff;
  const Key key = key_of('h', slot);
  if (!is_open || nvs_get_u32(handle, key.text, &head) != ESP_OK) head = 0xffffffff;
  __builtin_memcpy(memory + place_of(slot), &head, kBodyAt);
}

void load_body(uint8_t slot) {
  const uint16_t room = room_of(slot);
  size_t length = room;
  __builtin_memset(body_of(slot), kEmpty, room);
  const Key key = key_of('b', slot);
  if (!is_open || nvs_get_blob(handle, key.text, body_of(slot), &length) != ESP_OK) {
    __builtin_memset(body_of(slot), kEmpty, room);
    length = 0;
  }
  used[slot] = static_cast<uint16_t>(length);
}

void load() {
  is_loaded = true;
  __builtin_memset(memory, kEmpty, sizeof memory);
  is_open = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK;
  for (uint8_t slot = 0; slot < kSlots; slot++) {
    load_head(slot);
    load_body(slot);
  }
}

void write_head(uint8_t slot) {
  uint32_t head;
  __builtin_memcpy(&head, memory + place_of(slot), kBodyAt);
  const Key key = key_of('h', slot);
  if (is_open && nvs_set_u32(handle, key.text, head) == ESP_OK) nvs_commit(handle);
  load_head(slot);
}

void write_body() {
  const uint8_t slot = waiting;
  if (slot == kSlots) return;
  waiting = kSlots;
  const Key key = key_of('b', slot);
  if (is_open && nvs_set_blob(handle, key.text, body_of(slot), used[slot]) == ESP_OK) {
    nvs_commit(handle);
  }
  load_body(slot);
}

bool waits(uint16_t place) { return place >= first_waiting && place <= last_waiting; }

}  // namespace

bool nvm_is_ready() {
  if (!is_loaded) load();
  return true;
}

uint8_t nvm_read(uint16_t place) {
  if (!is_loaded) load();
  if (waiting != kSlots && waits(place)) write_body();
  return memory[place];
}

void nvm_write(uint16_t place, uint8_t value) {
  if (!is_loaded) load();
  const uint8_t slot = slot_of(place);
  if (slot == kSlots) return;
  const uint16_t at = static_cast<uint16_t>(place - place_of(slot));
  if (slot != waiting || at < kBodyAt) write_body();
  memory[place] = value;
  if (at < kBodyAt) return write_head(slot);
  if (waiting == kSlots) first_waiting = last_waiting = place;
  waiting = slot;
  if (place < first_waiting) first_waiting = place;
  if (place > last_waiting) last_waiting = place;
  const uint16_t end = static_cast<uint16_t>(at - kBodyAt + 1);
  if (end > used[slot]) used[slot] = end;
}

void nvm_clear(uint16_t place) { nvm_write(place, 0); }

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
