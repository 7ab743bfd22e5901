// What the robot keeps without power: it is read after a reset, and kept when it may be.
//
// Knows which of program, fault and identity is next, and that motors off and enough voltage come
// before what makes it count. How bytes are written is for the store to know.

#ifndef TINISCRIPT_FIRMWARE_KEEPING_H_
#define TINISCRIPT_FIRMWARE_KEEPING_H_

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// Goes on with what is read or kept: at most one byte.
void tick_keeping();

// Whether everything has been read since the reset. Before that, nothing is to be changed.
bool has_booted();

// Has it kept, as soon as the store is free. The program must stay as it is until then.
void keep_program();
void keep_fault();
void keep_identity();

// Whether the identity is kept: kOk; kSaving and kLowSupply: it will be; kNotKept: the memory is
// worn out, and it is tried again.
Answer identity_kept();

// Makes way for another program in memory: kBusy while the one there is being kept. One that waits
// for more voltage is given up.
Answer give_up_program();

// Why something is not to be had now.
Answer not_now();

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_KEEPING_H_
