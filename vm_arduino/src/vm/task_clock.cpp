#include "drive.h"

#ifndef tiniscript_in_assembly

namespace tiniscript {

uint32_t Drive::late_ms(const TaskRecord* task) const { return now_ms_ - task->clock_ms; }

}  // namespace tiniscript

#endif
