// The robot makes itself known: it blinks for 3 s and plays three notes that its id decides.
//
// The buzzer is the program's while one runs: then the light blinks alone.

#pragma once

namespace tiniscript {

// Continues; call it in every turn.
void tick_identify();

}  // namespace tiniscript
