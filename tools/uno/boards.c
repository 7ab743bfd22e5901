// What distinguishes an Uno and a Mega: the chip, where its interrupts are, what its pins are
// called and what drives them.

#include <string.h>

#include "uno.h"

// clang-format off
static const struct Output uno_outputs[] = {
    {5, 0, 1}, {6, 0, 0}, {9, 1, 0}, {10, 1, 1}, {11, 2, 0}, {3, 2, 1},
};

static const struct Output mega_outputs[] = {
    {13, 0, 0}, {4, 0, 1}, {11, 1, 0}, {12, 1, 1}, {10, 2, 0}, {9, 2, 1}, {5, 3, 0}, {2, 3, 1},
    {3, 3, 2}, {6, 4, 0}, {7, 4, 1}, {8, 4, 2}, {46, 5, 0}, {45, 5, 1}, {44, 5, 2},
};

static const struct Board boards[] = {
    {
        "uno", "atmega328p", 1024, {6, 18, 19, 20, 22}, 14, 6, 3, 2,
        "D0D1D2D3D4D5D6D7B0B1B2B3B4B5" "C0C1C2C3C4C5",
        uno_outputs, sizeof uno_outputs / sizeof *uno_outputs,
    },
    {
        "mega", "atmega2560", 4096, {12, 25, 26, 27, 30}, 54, 16, 6, 8,
        "E0E1E4E5G5E3H3H4H5H6B4B5B6B7J1J0H1H0D3D2D1D0A0A1A2A3A4A5A6A7C7C6C5C4C3C2C1C0"
        "D7G2G1G0L7L6L5L4L3L2L1L0B3B2B1B0" "F0F1F2F3F4F5F6F7K0K1K2K3K4K5K6K7",
        mega_outputs, sizeof mega_outputs / sizeof *mega_outputs,
    },
};
// clang-format on

const struct Board* board = &boards[0];

bool board_choose(const char* name) {
  for (unsigned k = 0; k < sizeof boards / sizeof *boards; k++) {
    if (strcmp(boards[k].name, name) != 0) continue;
    board = &boards[k];
    return true;
  }
  return false;
}
