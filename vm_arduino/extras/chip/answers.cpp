#include "answers.h"

#include "../../src/vm/image.h"
#include "../../src/vm/number.h"
#include "../../src/vm/verify.h"
#include "runner.h"

namespace tiniscript {

namespace {

void put_bytes(uint32_t value, uint8_t size) {
  for (; size != 0; size--) {
    put(static_cast<char>(value & 0xff));
    value >>= 8;
  }
}

struct Bytes {
  const uint8_t* data;
  size_t length;
};

// Where the chip has no room for them, `data` is nullptr.
Bytes next_bytes(Request* request) {
  const size_t length = static_cast<size_t>(request->u32());
  const Bytes bytes = {request_bytes(request->place(), length, 0), length};
  request->skip(length);
  return bytes;
}

Fault result_of(Op op, int32_t a, int32_t b, int32_t* result) {
  // `b` is the state as well: as good as any
  if (op == Op::kEnd) {
    *result = whole(a);
    return Fault::kNone;
  }
  int32_t pair[] = {a, b};
  const Fault fault =
      op == Op::kRandom ? random_between(pair, static_cast<uint32_t>(b)) : calculate(op, pair);
  *result = pair[0];
  return fault;
}

// Verdicts of the codes that the request ends with: the rule (1 byte) and the offset (2).
void answer_verdicts(Request request, size_t end) {
  const uint8_t sensors = request.u8();
  const uint8_t actuators = request.u8();
  const uint8_t needs = request.u8();
  while (request.place() < end) {
    const Bytes code = next_bytes(&request);
    if (code.data == nullptr) return;
    const Verdict verdict = verify(code.data, code.length, sensors, actuators, needs);
    put_bytes(static_cast<uint8_t>(verdict.rule), 1);
    put_bytes(verdict.offset_or_needs, 2);
  }
}

// What is wrong with the headers of images: the refusal (1 byte).
void answer_images(Request request, size_t end) {
  while (request.place() < end) {
    const Bytes data = next_bytes(&request);
    if (data.data == nullptr) return;
    Image image;
    put_bytes(static_cast<uint8_t>(unpack(data.data, data.length, &image)), 1);
  }
}

// Results of operations: the fault (1 byte) and the result (4), which is 0 where there is a fault.
// Op::kEnd stands for `whole`.
void answer_arithmetic(Request request, size_t end) {
  while (request.place() < end) {
    const Op op = static_cast<Op>(request.u8());
    const int32_t a = request.i32();
    const int32_t b = request.i32();
    int32_t result = 0;
    const Fault fault = result_of(op, a, b, &result);
    put_bytes(static_cast<uint8_t>(fault), 1);
    put_bytes(fault == Fault::kNone ? static_cast<uint32_t>(result) : 0, 4);
  }
}

}  // namespace

bool answer_any(Request request, size_t end) {
  switch (request.u8()) {
    case 'R':
      answer_run(request);
      return true;
    case 'P':
      answer_run_at_pace(request);
      return true;
    case 'V':
      answer_verdicts(request, end);
      return true;
    case 'I':
      answer_images(request, end);
      return true;
    case 'A':
      answer_arithmetic(request, end);
      return true;
    default:
      return false;
  }
}

}  // namespace tiniscript
