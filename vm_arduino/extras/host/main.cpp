// Runs the machine on a computer, for tests: many requests to one process.
//
// A request is four bytes of length and a letter with what it asks; an answer is four bytes of
// length and what was found. Requests are those of `../chip/answers.h`, and three more.
// `tests/machines/host.py` is the other side. Ends with its input.

#include <stdio.h>

#include <vector>

#include "../../src/vm/crc32.h"
#include "../../src/vm/image.h"
#include "../../src/vm/machine.h"
#include "../../src/vm/verify.h"
#include "../chip/answers.h"
#include "../chip/runner.h"
#include "../chip/traced_robot.h"
#include "wire.h"

using namespace tiniscript;

namespace {

// What `../chip` reads of the request that is answered, and where its answer goes.
std::string request_data;
std::unique_ptr<uint8_t[]> copied_bytes;
Writer answer;

constexpr uint8_t kSlice = 250;  // instructions of a tick

// L: runs the code of an image whose ticks after a wait come late, each by as much as is asked for:
// the lines before its ending.
void answer_late(Request request) {
  std::vector<uint32_t> delays_ms(request.u32());
  for (uint32_t& delay_ms : delays_ms) delay_ms = request.u32();
  request.skip(2 * sizeof(uint32_t));  // its limits
  const uint32_t seed = request.u32();
  request.skip(sizeof(uint32_t));  // its beginning
  robot.read(&request);
  const size_t length = request.u32();
  const uint8_t* const image = request_bytes(request.place(), length, kEndBytes);
  Machine machine;
  int32_t readings[kDevices] = {};
  machine.start(image + kHeaderBytes, static_cast<uint16_t>(length - kHeaderBytes), readings,
                robot.sensor_count, seed, 0);
  for (const uint32_t delay_ms : delays_ms) {
    const uint32_t now_ms = static_cast<uint32_t>(robot.now_ms);
    if (machine.tick(now_ms, kSlice) != Status::kWaiting) break;
    const uint32_t wait_ms = machine.wake_ms() - now_ms;
    if (wait_ms == 0x7fffffff) break;  // nothing happens by itself
    robot.now_ms += (wait_ms < 0x80000000 ? wait_ms : 0) + uint64_t{delay_ms};
  }
}

// X: all codes of three bytes that begin with one byte. How many are accepted, how many of these
// fail a run-time check, and the checksum of all verdicts.
void answer_all(Request request) {
  const uint8_t sensors = request.u8();
  const uint8_t actuators = request.u8();
  uint8_t code[3 + kEndBytes] = {request.u8()};
  uint32_t accepted_count = 0;
  uint32_t bad_code_count = 0;
  uint32_t checksum = 0;
  for (uint32_t low_bytes = 0; low_bytes < 0x10000; low_bytes++) {
    code[1] = static_cast<uint8_t>(low_bytes >> 8);
    code[2] = static_cast<uint8_t>(low_bytes & 0xff);
    const Verdict verdict = verify(code, 3, sensors, actuators);
    const bool is_accepted = verdict.rule == Rule::kNone;
    const uint16_t offset = is_accepted ? 0 : verdict.offset();
    const uint8_t verdict_bytes[] = {static_cast<uint8_t>(verdict.rule),
                                     static_cast<uint8_t>(offset), 0};
    checksum = crc32(checksum, verdict_bytes, sizeof verdict_bytes);
    if (!is_accepted) continue;
    accepted_count++;
    robot = TracedRobot();
    for (TracedRobot::Sensor& sensor : robot.sensors)
      sensor.name = request_data.size();  // it has none
    answer = Writer();                    // nobody wants the trace
    Machine machine;
    int32_t readings[kDevices] = {};
    machine.start(code, 3, readings, sensors, 1, 0);
    uint32_t now_ms = 0;
    for (uint8_t k = 0; k < 20; k++) {
      robot.must_wait = false;
      if (machine.tick(now_ms, 10) == Status::kWaiting) now_ms = machine.wake_ms();
    }
    bad_code_count += machine.fault() == Fault::kBadCode;
  }
  answer = Writer();
  answer.u32(accepted_count);
  answer.u32(bad_code_count);
  answer.u32(checksum);
}

}  // namespace

namespace tiniscript {

uint8_t request_byte(size_t place) {
  return place < request_data.size() ? static_cast<uint8_t>(request_data[place]) : 0;
}

// Bytes of exactly their length, so that a sanitizer detects a read past the end.
const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  copied_bytes.reset(new uint8_t[length + zeros]());
  for (size_t k = 0; k < length; k++) copied_bytes[k] = request_byte(place + k);
  return copied_bytes.get();
}

void put(char letter) { answer.u8(static_cast<uint8_t>(letter)); }

}  // namespace tiniscript

int main() {
  while (next_request(&request_data)) {
    Request request(0);
    answer = Writer();
    switch (request.u8()) {
      case 'U':
        answer_run(request, false);
        break;
      case 'L':
        answer_late(request);
        break;
      case 'X':
        answer_all(request);
        break;
      default:
        if (!answer_any(Request(0), request_data.size())) return 1;
    }
    send_answer(answer);
  }
  return 0;
}
