// Runs code many times on a computer and says how long the machine took.
//
// Arguments: how many times, the code in hexadecimal digits, and the readings in thousandths.

#include <stdio.h>
#include <stdlib.h>

#include <chrono>
#include <string>
#include <vector>

#include "../../src/vm/vm.h"
#include "quiet_robot.h"

using namespace tiniscript;

int main(int count, char** arguments) {
  if (count < 3 || count > 3 + kMostValues) return 2;
  const int times = atoi(arguments[1]);
  const std::string digits = arguments[2];
  std::vector<uint8_t> code;
  for (size_t at = 0; at < digits.size(); at += 2) {
    code.push_back(static_cast<uint8_t>(std::stoi(digits.substr(at, 2), nullptr, 16)));
  }
  const uint16_t length = static_cast<uint16_t>(code.size());
  code.resize(code.size() + kEndBytes);
  for (int k = 3; k < count; k++) readings[k - 3] = atoi(arguments[k]);

  static Machine machine;
  static int32_t kept[8];
  unsigned long steps = 0;
  const auto begun = std::chrono::steady_clock::now();
  for (int k = 0; k < times; k++) {
    taken = 0;
    shows = 0;
    steps = 0;
    machine.start(code.data(), length, kept, 8, 1, 0);
    do {
      machine.tick(0, 0xff);
      steps += static_cast<unsigned long>(0xff - machine.left());
    } while (machine.status() == Status::kRunning);
    if (machine.status() != Status::kDone) return 1;
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begun;
  printf("%.9f %lu", time.count() / times, steps);
  for (uint8_t k = 0; k < shows; k++) printf(" %ld", static_cast<long>(shown[k]));
  printf("\n");
}
