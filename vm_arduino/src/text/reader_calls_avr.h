// Calls of `reader_avr.S`, with the reader in Y: each takes less than one of the compiler's. `reader.h`
// includes this for an AVR.

#pragma once

namespace tiniscript {

inline void Reader::emit(uint8_t byte) {
  register uint8_t r24 asm("r24") = byte;
  asm volatile("%~call tiniscript_emit"
               : "+r"(r24)
               : "y"(this)
               : "r25", "r26", "r27", "r30", "r31", "memory");
}

inline void Reader::emit_numbered(uint8_t op, uint8_t first_short, uint8_t number) {
  register uint8_t r24 asm("r24") = op;
  register uint8_t r25 asm("r25") = first_short;
  register uint8_t r22 asm("r22") = number;
  asm volatile("%~call tiniscript_emit_numbered"
               : "+r"(r24), "+r"(r25)
               : "r"(r22), "y"(this)
               : "r26", "r27", "r30", "r31", "memory");
}

inline void Reader::emit_number(bool is_minus) {
  register uint8_t r22 asm("r22") = is_minus;
  asm volatile("%~call tiniscript_emit_number"
               :
               : "r"(r22), "y"(this)
               : "r18", "r19", "r20", "r21", "r23", "r24", "r25", "r26", "r27", "r30", "r31",
                 "memory");
}

inline void Reader::push(uint8_t byte) {
  register uint8_t r24 asm("r24") = byte;
  asm volatile("%~call tiniscript_push"
               : "+r"(r24)
               : "y"(this)
               : "r26", "r27", "r30", "r31", "memory");
}

inline uint8_t Reader::pop() {
  register uint8_t r24 asm("r24");
  asm volatile("%~call tiniscript_pop" : "=r"(r24) : "y"(this) : "r30", "r31", "memory");
  return r24;
}

inline bool Reader::has_room(uint16_t bytes) {
  register uint16_t r24 asm("r24") = bytes;
  asm volatile("%~call tiniscript_has_room"
               : "+r"(r24)
               : "y"(this)
               : "r26", "r27", "r30", "r31", "memory");
  return static_cast<uint8_t>(r24) != 0;
}

inline bool Reader::matches(const uint8_t** entry, bool in_flash) {
  register uint8_t r24 asm("r24") = in_flash;
  const uint8_t* cursor = *entry;
  asm volatile("%~call tiniscript_matches"
               : "+r"(r24), "+z"(cursor)
               : "y"(this)
               : "r18", "r25", "r26", "r27", "memory");
  *entry = cursor;
  return r24 != 0;
}

inline void Reader::resolve(uint8_t offset) {
  register uint8_t r24 asm("r24") = offset;
  asm volatile("%~call tiniscript_resolve"
               : "+r"(r24)
               : "y"(this)
               : "r25", "r26", "r30", "r31", "memory");
}

}  // namespace tiniscript
