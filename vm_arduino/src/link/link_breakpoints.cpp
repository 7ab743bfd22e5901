// Breakpoints: where a program halts, how it continues, and reports on a running one.

#include "../vm/build.h"
#include "../vm/bytecode.h"
#include "link.h"
#include "port.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

constexpr uint16_t kHaltedAgainMs = 500;

}  // namespace

Answer Link::set_breakpoints(const uint8_t* places, uint8_t length) {
  if (length % 2 != 0) return Answer::kBadLength;
  if (port_status().state != State::kRunning) {
    const Answer answer = missing_program_answer();
    if (answer != Answer::kOk) return answer;
    image_ = nullptr;  // the program is loaded to where it is
  }
  const Answer answer = port_set_breakpoints(places, static_cast<uint8_t>(length / 2));
  if (answer == Answer::kOk) has_breakpoints_ = length != 0;
  return answer;
}

Answer Link::resume(uint8_t mode) {
  if (mode > static_cast<uint8_t>(ResumeHow::kStep)) return Answer::kBadValue;
  reply_.detail = port_is_halted();
  port_resume(static_cast<ResumeHow>(mode));
  return Answer::kOk;
}

// The session is over: a halt for it ends.
void Link::forget_breakpoints() {
  if (owns_halt()) port_end();
  if (has_breakpoints_) port_forget_breakpoints();
  has_breakpoints_ = owns_halt_ = false;
}

void Link::on_halted() {
  owns_halt_ = true;
  due_ |= kDueHalted;
  left_ms_[kHaltedAgain] = kHaltedAgainMs;
}

void Link::tell_halt() {
  begin_event(Message::kHalted);
  put(port_status().run);
  put16(port_run_at());
  put(port_halted_task());
}

void Link::tell_variables() {
  put(port_status().run);
  put(port_is_halted());
  if (port_status().state != State::kRunning || port_variables() == nullptr) return;
  const uint8_t seal = kHasSeals && (out_[kTypeAt] & kSealed) != 0 ? kTagBytes : 0;
  const uint8_t max_size = static_cast<uint8_t>(kSmallFrame - kCrcBytes - seal - sizeof(int32_t));
  for (uint8_t k = static_cast<uint8_t>(reply_.detail); k < kVariables && size_ <= max_size; k++) {
    put_all(port_variables() + k, sizeof(int32_t));
  }
}

void Link::tell_tasks() {
  put(port_status().run);
  const bool is_halted = port_is_halted();
  put(is_halted);
  put(is_halted ? port_halted_task() : 0);
  const bool is_running = port_status().state == State::kRunning;
  put16(is_running ? port_run_at() : 0);
  TaskReport report;
  for (uint8_t k = 0; is_running && port_report_task(k, &report); k++) {
    put_all(&report, sizeof report);
  }
}

}  // namespace tiniscript

#endif
