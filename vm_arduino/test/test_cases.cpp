// The robot does what `tsc run` prints, and what breaks a rule is refused with the rule and the
// offset.

#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest.h>

#include <iostream>

#include "../extras/chip/runner.h"
#include "../extras/chip/traced_robot.h"
#include "../src/vm/machine.h"
#include "cases.h"

using namespace tiniscript;

namespace {

std::string asked;
std::vector<uint8_t> image;
std::string said;

void ask(const std::string& request) {
  asked.clear();
  said.clear();
  for (size_t k = 0; k < request.size(); k += 2) {
    asked += static_cast<char>(std::stoi(request.substr(k, 2), nullptr, 16));
  }
}

// Says how each test case has ended, for `test_custom_runner.py`.
struct Endings : doctest::IReporter {
  const char* name = "";

  explicit Endings(const doctest::ContextOptions&) {}
  void test_case_start(const doctest::TestCaseData& test_case_data) override { name = test_case_data.m_name; }
  void test_case_end(const doctest::CurrentTestCaseStats& current_test_case_stats) override {
    std::cout << (current_test_case_stats.testCaseSuccess ? "PASSED: " : "FAILED: ") << name << std::endl;
  }
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};

REGISTER_LISTENER("endings", 1, Endings);

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

void check(const std::string& request, const std::string& answer) {
  ask(request);
  answer_run(Request(0));
  CHECK(said.substr(0, said.rfind("RAN ")) == answer);  // without where it was at its end
}

TEST_CASE("a robot that is not ready is asked again") {
  ask(kRequest);
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
