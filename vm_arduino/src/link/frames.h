// Encodes and decodes frames in place: COBS and a checksum.
//
// It knows nothing of messages. Matches `frames.py`. In a buffer the frame follows its first byte,
// which exists only on the wire: type, sequence number, epoch, payload, checksum. A large frame has
// a 0 before its payload.

#pragma once

#include <stdint.h>

#include "sizes.h"

namespace tiniscript {

constexpr uint8_t kTypeAt = 1;
constexpr uint8_t kSeqAt = 2;
constexpr uint8_t kEpochAt = 3;
constexpr uint8_t kPayloadAt = 4;

constexpr uint8_t kWireBytes = kLargestFrame + 2;  // with the 0x00 at its end

// Whether a frame whose payload ends at `end` is large.
inline bool is_large(uint8_t end) {
  return kHasLargeFrames && end > kSmallFrame + kTypeAt - kCrcBytes;
}

// The beginning of the payload of an unsealed frame.
inline uint8_t payload_at(uint8_t end) { return is_large(end) ? kPayloadAt + 1 : kPayloadAt; }

// Numbers are little-endian on the wire and in the memory of every supported chip.
bool same_bytes(const uint32_t* number, const uint8_t* bytes);
uint16_t get16(const uint8_t* bytes);
uint32_t get32(const uint8_t* bytes);

// Encodes the frame whose payload ends at `end`. Returns the number of bytes to send, including the
// 0x00.
uint8_t encode_frame(uint8_t* bytes, uint8_t end);

// Checks a packet while it arrives, so that little work is left after its last byte.
class FrameCheck {
 public:
  // Starts over for another packet.
  void begin();

  uint8_t taken_count() const { return taken_count_; }

  // Takes the bytes that have arrived since the last call, up to `length` (at most kPacketBytes).
  // If `length` is less than before, another packet has begun meanwhile, and no zero is taken.
  void take(const uint8_t* bytes, uint8_t length);

  // The number of bytes up to the next zero or the end; more than any frame has if that position
  // has passed.
  uint8_t remaining() const { return static_cast<uint8_t>(zero_ - taken_count_); }

  // Whether the bytes taken so far are a whole frame.
  bool is_whole() const;

  // Decodes the bytes taken so far in place. Returns where the payload ends, assuming that the
  // frame ends at the next zero. More bytes may be taken afterwards.
  uint8_t decode(uint8_t* bytes);

 private:
  uint8_t taken_count_;  // bytes
  uint8_t zero_;         // position of the next zero
  uint8_t next_zero_;    // the first zero that is not restored yet
  uint32_t crc_;
};

// Decodes the `length` bytes of a packet (1 to kPacketBytes). Returns where its payload ends, or 0
// if it is damaged.
uint8_t decode_frame(uint8_t* bytes, uint8_t length);

}  // namespace tiniscript
