// The answers of a robot without discs, breakpoints or readings, unless it defines these itself.

#include "port.h"

namespace tiniscript {

__attribute__((weak)) bool port_noise(uint16_t*) { return false; }

__attribute__((weak)) Answer port_set_breakpoints(const uint8_t*, uint8_t) {
  return Answer::kUnknownMessage;
}
__attribute__((weak)) void port_forget_breakpoints() {}
__attribute__((weak)) bool port_is_halted() { return false; }
__attribute__((weak)) uint8_t port_halted_task() { return 0; }
__attribute__((weak)) void port_resume(ResumeHow) {}
__attribute__((weak)) const int32_t* port_variables() { return nullptr; }
__attribute__((weak)) bool port_report_task(uint8_t, TaskReport*) { return false; }


__attribute__((weak)) void port_tell_readings(bool) {}
__attribute__((weak)) bool port_has_reading() { return false; }
__attribute__((weak)) ReadingReport port_next_reading() { return {0, 0, 0, 0}; }

}  // namespace tiniscript
