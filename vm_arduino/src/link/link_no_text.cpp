// The link of a robot that reads no text: only obeys typed stops.

#include "link.h"

#ifdef tiniscript_without_text

namespace tiniscript {

void Link::talk() {
  uint8_t byte;
  while (receiver_->take_text(&byte)) {
    if (byte != kLineStop) continue;
    receiver_->take_mark();
    return stop(Cause::kText);
  }
}

}  // namespace tiniscript

#endif
