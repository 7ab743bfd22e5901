// Calculates on a simulated ATmega328P what instructions make of many pairs of numbers.
//
// Each operation is a program of its own, `PUSH32 a; PUSH32 b; OP; SHOW`, so what is looked at is
// what a robot calculates. The pairs are made here and in `tests/vm/test_cpp_avr_arithmetic.py` in
// the same way; the answer to a block of operations is one checksum, or each result where it asks
// so.

#include "../../src/vm/crc32.h"
#include "../../src/vm/machine.h"
#include "../../src/vm/number.h"
#include "../avr/simulated.h"
#include "quiet_robot.h"

using namespace tiniscript;
using simulated::request;

namespace {

constexpr uint8_t kMaxOps = 32;
constexpr uint8_t kMaxEdges = 100;

Machine machine;
uint8_t ops[kMaxOps];
uint8_t op_count;
int32_t edges[kMaxEdges];
uint8_t edge_count;
uint32_t state;  // xorshift32, apart from that of the machine

uint32_t random_bits() {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

// A number of any size, as many small ones as large ones; one in 8 is an edge.
int32_t any_number() {
  const uint8_t choice = static_cast<uint8_t>(random_bits() >> 24);
  const uint32_t bits = random_bits();
  if (choice < 32) return edges[(bits >> 8) % edge_count];
  return static_cast<int32_t>(bits) >> (choice & 31);
}

// The second value of an operation: of ROUND, every other time from -8 to 8 decimals.
int32_t second_operand(uint8_t op, int32_t b) {
  const bool is_places = op == static_cast<uint8_t>(Op::kRound) && (b & 1) != 0;
  return is_places ? (b & 0x3fff) - 0x2000 : b;
}

uint8_t* put_push(uint8_t* code, int32_t value) {
  *code++ = static_cast<uint8_t>(Op::kPush32);
  for (uint8_t k = 0; k < 4; k++) {
    *code++ = static_cast<uint8_t>(value & 0xff);
    value >>= 8;
  }
  return code;
}

// Puts the result into `*result`, 0 where there is a fault, which it returns. END, which calculates
// nothing, stands for `whole`.
Fault run_operation(uint8_t op, int32_t a, int32_t b, int32_t* result) {
  if (op == static_cast<uint8_t>(Op::kEnd)) {
    *result = whole(a);
    return Fault::kNone;
  }
  const bool takes_two = op != static_cast<uint8_t>(Op::kNeg) &&
                         op != static_cast<uint8_t>(Op::kAbs) &&
                         op != static_cast<uint8_t>(Op::kNot);
  static uint8_t code[12 + kEndBytes];
  uint8_t* next = put_push(code, a);
  if (takes_two) next = put_push(next, b);
  *next++ = op;
  *next++ = static_cast<uint8_t>(Op::kShow);
  for (uint8_t k = 0; k < kEndBytes; k++) next[k] = static_cast<uint8_t>(Op::kEnd);
  // `b` is the seed of RANDOM too: as good as any
  machine.start(code, static_cast<uint16_t>(next - code), nullptr, 0, static_cast<uint32_t>(b) | 1,
                0);
  show_count = 0;
  shown_values[0] = 0;
  machine.tick(0, 10);
  *result = shown_values[0];
  return machine.fault();
}

void answer() {
  state = request.u32();
  const uint16_t blocks = request.u16();
  const uint16_t block = request.u16();           // operations of each
  const uint16_t detailed_block = request.u16();  // this one result by result, and none after it
  op_count = request.u8();
  for (uint8_t k = 0; k < op_count; k++) ops[k] = request.u8();
  edge_count = request.u8();
  for (uint8_t k = 0; k < edge_count; k++) edges[k] = static_cast<int32_t>(request.u32());
  uint8_t next_op = 0;
  for (uint16_t number = 0; number < blocks && number <= detailed_block; number++) {
    uint32_t checksum = 0;
    for (uint16_t k = 0; k < block; k++) {
      const int32_t a = any_number();
      const int32_t b = second_operand(ops[next_op], any_number());
      int32_t result;
      const uint8_t fault = static_cast<uint8_t>(run_operation(ops[next_op], a, b, &result));
      if (++next_op == op_count) next_op = 0;
      const uint32_t bits = static_cast<uint32_t>(result);
      const uint8_t result_bytes[] = {
          fault, static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8),
          static_cast<uint8_t>(bits >> 16), static_cast<uint8_t>(bits >> 24)};
      checksum = crc32(checksum, result_bytes, sizeof result_bytes);
      if (number == detailed_block) {
        put_number(fault);
        put(' ');
        put_number(result);
        put('\n');
      }
    }
    if (number != detailed_block) {
      put_size(checksum);
      put('\n');
    }
  }
}

}  // namespace

int main() {
  simulated::begin();
  answer();
  simulated::end();
}
