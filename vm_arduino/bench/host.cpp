// Runs code many times on a computer and says how long the machine took.
//
// Arguments: how many times, the code in hexadecimal digits, and the readings in thousandths. The
// robot costs next to nothing, as in `cycles.cpp`.

#include <stdio.h>
#include <stdlib.h>

#include <chrono>
#include <string>
#include <vector>

#include "../src/robot.h"
#include "../src/vm/vm.h"

using namespace tiniscript;

namespace {

std::vector<int32_t> readings;
std::vector<int32_t> shown;
size_t taken = 0;

}  // namespace

namespace tiniscript {

void robot_motors(int8_t, int8_t) {}

void robot_off() {}

bool robot_read(uint8_t, int32_t* value) {
  *value = readings.at(taken++);
  return true;
}

void robot_beep(uint16_t, uint32_t) {}

bool robot_show(int32_t value, bool) {
  shown.push_back(value);
  return true;
}

void robot_set(uint8_t, int32_t) {}

}  // namespace tiniscript

int main(int count, char** arguments) {
  if (count < 3) return 2;
  const int times = atoi(arguments[1]);
  const std::string digits = arguments[2];
  std::vector<uint8_t> code;
  for (size_t at = 0; at < digits.size(); at += 2) {
    code.push_back(static_cast<uint8_t>(std::stoi(digits.substr(at, 2), nullptr, 16)));
  }
  const uint16_t length = static_cast<uint16_t>(code.size());
  code.push_back(static_cast<uint8_t>(Op::kEnd));
  for (int k = 3; k < count; k++) readings.push_back(atoi(arguments[k]));

  static Machine machine;
  unsigned long steps = 0;
  const auto begun = std::chrono::steady_clock::now();
  for (int k = 0; k < times; k++) {
    taken = 0;
    shown.clear();
    steps = 0;
    machine.start(code.data(), length, 8, 1, 0);
    do {
      machine.tick(0, 0xffff);
      steps += static_cast<unsigned long>(0xffff - machine.left());
    } while (machine.status() == Status::kRunning);
    if (machine.status() != Status::kDone) return 1;
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begun;
  printf("%.9f %lu", time.count() / times, steps);
  for (const int32_t value : shown) printf(" %ld", static_cast<long>(value));
  printf("\n");
}
