// Bytes of an item to a frame and back, in place: COBS and a checksum.
//
// Knows nothing of what a message means. The same as `frames.py`. In a buffer the frame lies behind
// its first byte, which is only there on the wire: type, sequence number, epoch, payload, checksum.

#ifndef TINISCRIPT_LINK_FRAMES_H_
#define TINISCRIPT_LINK_FRAMES_H_

#include <stdint.h>

#include "messages.h"

namespace tiniscript {

constexpr uint8_t kTypeAt = 1;
constexpr uint8_t kSeqAt = 2;
constexpr uint8_t kEpochAt = 3;
constexpr uint8_t kPayloadAt = 4;

constexpr uint8_t kWireBytes = kLargestFrame + 2;  // with the 0x00 behind it

// Numbers are little-endian on the wire, and in the memory of every chip that this is for.
void copy_bytes(const void* from, uint8_t* to, uint8_t length);
bool same_bytes(const uint32_t* number, const uint8_t* bytes);
uint16_t get16(const uint8_t* bytes);
uint32_t get32(const uint8_t* bytes);

// Encodes the frame whose payload ends at `end`. Returns how many bytes to send, the 0x00 included.
uint8_t encode_frame(uint8_t* bytes, uint8_t end);

// Decodes the `length` bytes of an item (1 to kItemBytes). Returns where its payload ends, or 0
// where it is damaged.
uint8_t decode_frame(uint8_t* bytes, uint8_t length);

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_FRAMES_H_
