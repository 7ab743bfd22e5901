#include "state.h"

namespace tiniscript {

bool Execution::goes_on(Fault fault) {
  fault_ = fault;
  return fault == Fault::kNone;
}

bool Execution::fail() { return goes_on(Fault::kBadCode); }

bool Execution::pause() {
  status_ = Status::kWaiting;
  return false;
}

bool Execution::stay() {
  task_.pc = offset_;
  return false;
}

}  // namespace tiniscript
