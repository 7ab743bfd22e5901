// The robot does what `tsc run` prints, and what breaks a rule is refused with the rule and the
// offset.

#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest.h>

#include "../extras/chip/runner.h"
#include "../extras/chip/traced_robot.h"
#include "../src/vm/vm.h"
#include "cases.h"

using namespace tiniscript;

namespace {

std::string asked;
std::vector<uint8_t> image;
std::string said;

void ask(const Case& one) {
  asked.clear();
  said.clear();
  for (size_t k = 0; k < one.request.size(); k += 2) {
    asked += static_cast<char>(std::stoi(one.request.substr(k, 2), nullptr, 16));
  }
}

}  // namespace

namespace tiniscript {

uint8_t request_byte(size_t place) {
  return place < asked.size() ? static_cast<uint8_t>(asked[place]) : 0;
}

const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  image.assign(length + zeros, 0);
  for (size_t k = 0; k < length; k++) image[k] = request_byte(place + k);
  return image.data();
}

void put(char letter) { said += letter; }

}  // namespace tiniscript

TEST_CASE("a robot does what tsc run prints, or refuses what breaks a rule") {
  for (const Case& each : cases()) {
    INFO(each.title);
    ask(each);
    answer_run(Request(0));
    const size_t last = said.rfind("RAN ");  // where it was at its end
    if (last != std::string::npos) said.erase(last);
    CHECK(said == each.answer);
  }
}

TEST_CASE("a robot that is not ready is asked again") {
  ask(cases().back());  // of tinibot
  Request request(4 * sizeof(uint32_t));
  REQUIRE(robot.read(&request));
  const uint8_t code[2 + kEndBytes] = {static_cast<uint8_t>(Op::kRead), 0};
  robot.not_ready = 1;  // never
  Machine machine;
  int32_t reading = 0;
  machine.start(code, 2, &reading, 1, 1, 0);
  CHECK(machine.tick(0, 250) == Status::kRunning);
  CHECK(said == "");
  robot.not_ready = 0;
  robot.must_wait = false;  // it has waited
  CHECK(machine.tick(7, 250) == Status::kDone);
  CHECK(said == "0 READ LIGHT_R 0\n");
}
