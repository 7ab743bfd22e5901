// Arithmetic: the results and the faults of the machine in Python.

#include <doctest.h>

#include "../src/vm/number.h"
#include "../src/vm/vm.h"
#include "cases.h"

using namespace tiniscript;

namespace {

// What an operation makes of values: the result, or the name of the fault.
std::string calculated(Op op, const std::vector<int32_t>& values) {
  std::vector<uint8_t> code;
  for (const int32_t value : values) {
    code.push_back(static_cast<uint8_t>(Op::kPush32));
    for (int k = 0; k < 32; k += 8) {
      code.push_back(static_cast<uint8_t>(static_cast<uint32_t>(value) >> k & 0xff));
    }
  }
  code.push_back(static_cast<uint8_t>(op));
  const uint16_t length = static_cast<uint16_t>(code.size());
  code.resize(length + kEndBytes);
  Machine machine;
  machine.start(code.data(), length, nullptr, 0, 1, 0);
  machine.tick(0, static_cast<uint8_t>(values.size() + 1));
  if (machine.fault() == Fault::kOverflow) return "OVERFLOW";
  if (machine.fault() == Fault::kDivideByZero) return "DIVIDE_BY_ZERO";
  if (machine.fault() != Fault::kNone || machine.task().depth != 1) return "?";
  return std::to_string(machine.task().stack[0]);
}

}  // namespace

TEST_CASE("results and faults of arithmetic are those of Python") {
  for (const cases::NumberCase& each : cases::number_cases()) {
    std::string results;
    for (const int32_t edge : cases::edges()) {
      std::vector<int32_t> values = each.first;
      values.push_back(edge);
      results += calculated(each.op, values) + " ";
    }
    INFO(each.name);
    CHECK(results == each.results);
  }
}

TEST_CASE("whole numbers are rounded half away from zero") {
  CHECK(whole(499) == 0);
  CHECK(whole(500) == 1);
  CHECK(whole(-499) == 0);
  CHECK(whole(-500) == -1);
  CHECK(whole(INT32_MAX) == 2147484);
  CHECK(whole(INT32_MIN) == -2147484);
}

TEST_CASE("a number is compared to a whole one") {
  const int32_t values[] = {thousandths(-32768), -1, 0, 1, thousandths(32767)};
  for (const int32_t value : values) {
    for (const int16_t limit : {int16_t{-32768}, int16_t{0}, int16_t{32767}}) {
      CHECK(compare(&value, limit, 0) == (value == limit * 1000));
      CHECK(compare(&value, limit, 1) == (value != limit * 1000));
      CHECK(compare(&value, limit, 2) == (value < limit * 1000));
      CHECK(compare(&value, limit, 3) == (value <= limit * 1000));
      CHECK(compare(&value, limit, 4) == (value > limit * 1000));
      CHECK(compare(&value, limit, 5) == (value >= limit * 1000));
    }
  }
}
