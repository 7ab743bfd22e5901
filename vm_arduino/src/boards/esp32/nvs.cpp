// Implements `nvm.h` on an ESP32: each slot of the store is some entries of NVS.
//
// The head of a slot (generation and marks) is a number, written at once. Its body is blobs of
// 1,024 bytes, of which one at a time is in RAM: the bytes that are written wait there, and the
// first one that is read again, or another blob, has them all written. So flash has everything that
// is read, and a program takes a few writes instead of one for each byte. NVS leaves an entry as it
// was when the power fails, or writes it, or loses it; the store stands all three.
//
// A write may stop the chip for 50 ms, and up to 400, as long as a page is erased: `kWritesStopTheChip`
// lets the store wait until the motors are off.

#ifdef ARDUINO_ARCH_ESP32

#include <nvs.h>

#include "../../store/layout.h"
#include "../../store/nvm.h"
#include "../ultrasonic.h"

namespace tiniscript {

namespace {

constexpr char kNamespace[] = "tiniscript";
constexpr uint8_t kEmpty = 0xff;
constexpr uint16_t kBlobBytes = 1024;

uint8_t heads[kSlots][kBodyAt];
bool is_loaded;
bool is_open;
bool has_refused;  // a read, for another reason than that there is no such entry
nvs_handle_t handle;

// The blob that was used last.
uint8_t blob[kBlobBytes];
uint8_t blob_slot = kSlots;  // none
uint8_t blob_number;
uint16_t blob_bytes;  // those that NVS has, or will have
bool is_dirty;        // to be written: the bytes from the first to the last place
uint16_t first_dirty;
uint16_t last_dirty;

// A key: h0 is the head of slot 0, b0a the first blob of its body.
struct Key {
  char text[4];
};

Key head_key(uint8_t slot) { return {{'h', static_cast<char>('0' + slot), 0, 0}}; }

Key blob_key() {
  return {{'b', static_cast<char>('0' + blob_slot), static_cast<char>('a' + blob_number), 0}};
}

// The last possible end of the body of a slot.
uint16_t room_of(uint8_t slot) {
  if (slot >= kFirstOwnerSlot) return kOwnerBytes;
  return slot < 2 ? kProgramSlot - kBodyAt : kRecordBytes;
}

// The slot of a place.
uint8_t slot_of(uint16_t place) {
  for (uint8_t slot = 0; slot < kSlots; slot++) {
    const uint16_t start = place_of(slot);
    if (place >= start && place - start < kBodyAt + room_of(slot)) return slot;
  }
  return kSlots;
}

bool is_there(esp_err_t error) {
  if (error != ESP_OK && error != ESP_ERR_NVS_NOT_FOUND) has_refused = true;
  return error == ESP_OK;
}

void load_head(uint8_t slot) {
  uint32_t head = 0xffffffff;
  if (!is_open || !is_there(nvs_get_u32(handle, head_key(slot).text, &head))) head = 0xffffffff;
  __builtin_memcpy(heads[slot], &head, kBodyAt);
}

void write_head(uint8_t slot) {
  uint32_t head;
  __builtin_memcpy(&head, heads[slot], kBodyAt);
  if (is_open && nvs_set_u32(handle, head_key(slot).text, head) == ESP_OK) nvs_commit(handle);
  ultrasonic_forget();  // its interrupt has stood still, too
  load_head(slot);
}

void load_blob() {
  size_t length = kBlobBytes;
  __builtin_memset(blob, kEmpty, kBlobBytes);
  if (!is_open || !is_there(nvs_get_blob(handle, blob_key().text, blob, &length))) {
    __builtin_memset(blob, kEmpty, kBlobBytes);
    length = 0;
  }
  blob_bytes = static_cast<uint16_t>(length);
}

void write_blob() {
  if (!is_dirty) return;
  is_dirty = false;
  if (is_open && nvs_set_blob(handle, blob_key().text, blob, blob_bytes) == ESP_OK) {
    nvs_commit(handle);
  }
  ultrasonic_forget();  // its interrupt has stood still, too
  load_blob();
}

// Has the blob of a place of a body in RAM; returns where the byte is there.
uint16_t select_blob(uint8_t slot, uint16_t offset) {
  const uint8_t number = static_cast<uint8_t>(offset / kBlobBytes);
  if (slot != blob_slot || number != blob_number) {
    write_blob();
    blob_slot = slot;
    blob_number = number;
    load_blob();
  }
  return offset % kBlobBytes;
}

void load() {
  is_loaded = true;
  is_open = is_there(nvs_open(kNamespace, NVS_READWRITE, &handle));
  for (uint8_t slot = 0; slot < kSlots; slot++) load_head(slot);
}

}  // namespace

bool nvm_is_ready() {
  if (!is_loaded) load();
  return true;
}

bool nvm_has_refused() { return has_refused; }

uint8_t nvm_read(uint16_t place) {
  if (!is_loaded) load();
  const uint8_t slot = slot_of(place);
  if (slot == kSlots) return kEmpty;
  const uint16_t offset = static_cast<uint16_t>(place - place_of(slot));
  if (offset < kBodyAt) return heads[slot][offset];
  const uint16_t blob_offset = select_blob(slot, static_cast<uint16_t>(offset - kBodyAt));
  if (is_dirty && blob_offset >= first_dirty && blob_offset <= last_dirty) write_blob();
  return blob[blob_offset];
}

void nvm_write(uint16_t place, uint8_t value) {
  if (!is_loaded) load();
  const uint8_t slot = slot_of(place);
  if (slot == kSlots) return;
  const uint16_t offset = static_cast<uint16_t>(place - place_of(slot));
  if (offset < kBodyAt) {
    write_blob();
    heads[slot][offset] = value;
    return write_head(slot);
  }
  const uint16_t blob_offset = select_blob(slot, static_cast<uint16_t>(offset - kBodyAt));
  blob[blob_offset] = value;
  if (!is_dirty || blob_offset < first_dirty) first_dirty = blob_offset;
  if (!is_dirty || blob_offset > last_dirty) last_dirty = blob_offset;
  if (blob_offset >= blob_bytes) blob_bytes = static_cast<uint16_t>(blob_offset + 1);
  is_dirty = true;
}

void nvm_clear(uint16_t place) { nvm_write(place, 0); }

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
