// Whether this robot reads programs as text, and at which level: not where its flash has no room for
// the reader.

#ifndef TINISCRIPT_LINK_READS_TEXT_H_
#define TINISCRIPT_LINK_READS_TEXT_H_

#if !defined(__AVR__) || defined(__AVR_ATmega2560__)
#define tiniscript_reads_text
#endif

#include "messages.h"

namespace tiniscript {

#ifdef tiniscript_reads_text
constexpr bool kReadsText = true;
#else
constexpr bool kReadsText = false;
#endif

// As `text/levels.py` numbers them: `kTextRoom` is its room.
#ifdef __AVR_ATmega2560__
constexpr TextLevel kRobotTextLevel = TextLevel::kMega;
#else
constexpr TextLevel kRobotTextLevel = kReadsText ? TextLevel::kUno : TextLevel::kNone;
#endif

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_READS_TEXT_H_
