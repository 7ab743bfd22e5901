// Definitions shared by the files of the reader: tokens, states, and the contents of its buffer.

#pragma once

#include "../vm/bytecode.h"
#include "../vm/small.h"
#include "kit_words.h"
#include "reader.h"
#include "words.h"

namespace tiniscript {

// Tokens. The other signs are their own letters, words their numbers of `words.h`.
constexpr uint8_t kNewline = '\n';
constexpr uint8_t kNumberToken = '0';
constexpr uint8_t kNameToken = 'z';
constexpr uint8_t kBinary = 0x80;  // with the opcode below

inline bool ends(uint8_t token) { return token == ';'; }

constexpr uint8_t byte_of(Op op) { return static_cast<uint8_t>(op); }
constexpr uint8_t token_of(Op op) { return static_cast<uint8_t>(kBinary | byte_of(op)); }

// The addresses of its bytes. The signs that may be the first half of another stand for themselves.
enum Place : uint8_t { kNoToken, kWord, kComment, kWhole, kPoint, kPlaces };

// What the parser expects next.
enum ParseState : uint8_t {
  kBegin,
  kBar,              // after SI, SB or PING
  kCheckConnection,  // after PING|
  kNothingMore,      // after PING|CHECK_CONNECTION
  kInstruction,
  kAfterName,  // =, ( or the end of the instruction
  kArguments,  // the ( of a command
  kDefName,
  kSeparator,
  kAfterMove,  // UNTIL or the end of the instruction
  kFunction,   // the ( of a function
  kArgument,   // an operand, or FOREVER
  kOperand,
  kAfterMinus,  // an operand, to whose number the minus belongs
  kOperator,
  kAfterForever,  // or after CM or DEG
  kAfterDefName,  // the ( of a DEF or its end
  kFirstOfDef,    // the name of its first value, or )
  kNextOfDef,     // that of another one
  kAfterOfDef,    // , or )
  kNoValues,      // the ) of a call without values
};

// Whether an argument is just a number.
enum Shape : uint8_t { kNotPlain, kFresh, kMinusFirst, kPlain };

// The kind of a name that is no device.
constexpr uint8_t kIsVariable = 16;
constexpr uint8_t kIsDef = 32;
constexpr uint8_t kIsOfOtherDef = 64;  // a value of another DEF

// Among the waiting operators: open brackets, with the opcode of their function. The second
// argument of a function has kSecond, and kBase is after all.
constexpr uint8_t kBracket = 0x80;
constexpr uint8_t kSecond = 0x40;
constexpr uint8_t kBase = 0xff;

// Types of blocks, in the order of the words that end them; from kDefBlock on at the top level.
enum BlockType : uint8_t { kIfBlock, kLoopBlock, kWhileBlock, kDefBlock, kTaskBlock, kWhenBlock };
constexpr uint8_t kBlockType = 7;
constexpr uint8_t kForeverBlock = 8 | kLoopBlock;  // one that does not count

// A block whose end has not come yet. In a DEF or a task, `read_after` and `known_before` are
// depths, blocks in the low byte and calls in the high one: of the main task, and of the others.
struct __attribute__((packed)) Reader::Block {
  uint8_t type;
  uint8_t ends;             // the last of the operands that want its end; each holds the one before
  uint8_t code_start;       // of an IF: after the jump to its next arm, or 0; of a loop: its first code
  SensorBits read_before;   // surely read before it
  SensorBits read_after;    // by all arms of an IF so far
  SensorBits known_before;  // the readings of its conditions, and those before
};

// In front of the letters of each name stands the number of its variable, with kNameYesNo or
// kNameOfDef, or kNameDef and then this.
struct __attribute__((packed)) Reader::Def {
  uint8_t offset;
  uint8_t blocks;
  uint8_t calls;
  uint8_t values;    // the variable of the first one, and kOneValue for each
  uint16_t reaches;  // DEFs with values: a bit for each that this one is or calls
  SensorBits read;
};
constexpr uint8_t kOneValue = kVariables;
constexpr uint8_t kMaxValues = 4;
constexpr uint8_t kNameDef = 0x80;
constexpr uint8_t kNameYesNo = 0x40;
constexpr uint8_t kNameOfDef = 0x20;  // a value of a DEF: known while that is open

}  // namespace tiniscript
