#include "shape.h"

namespace tiniscript {

__attribute__((noinline)) Shape shape_of(uint8_t code) {
  if (code >= kFirstTwin) code = static_cast<uint8_t>(kFirstTwin / 2 + code / 2);
  const uint8_t* const row = kShapes[flash_byte(kShapeOf + code)];
  const uint8_t bytes = flash_byte(row + 1);
  return {flash_byte(row), bytes, flash_byte(kOperands + bytes / 32),
          static_cast<Family>(flash_byte(row + 2))};
}

}  // namespace tiniscript
