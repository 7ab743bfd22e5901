// The robot's half of a conversation in text: feeds the reader, and decides the effect of a line
// and the answer to it.
//
// Knows how long a line may take, and which lines are ignored. The link carries out the requests of
// a line. `docs/develop/link.md` is the contract.

#pragma once

#include <stdint.h>

#include "../text/reader.h"
#include "../text/remarks.h"
#include "key_line.h"
#include "receiver.h"

namespace tiniscript {

class Console {
 public:
  // A line's request to the link: to stop the robot, to end the run, to start the program that was
  // read, to hold keys.
  enum class Act : uint8_t { kNone, kStop, kEnd, kStart, kHold };

  // Passes the time. `silence_left_ms`: until a second has passed without a byte of any kind, or 0.
  void pass(uint16_t passed_ms, uint16_t silence_left_ms);

  // Whether time has passed since the last turn: without that and without text, no turn is needed.
  bool is_due() const { return is_due_; }

  // Takes text that has arrived. `is_heard`: a client's frames arrive, so mistakes get no answer.
  // `may_say`: an answer would be said soon.
  Act turn(Receiver* receiver, bool is_heard, bool may_say);

  // The robot was stopped: bytes before a second of silence are ignored, and no answer is due any
  // more. If the stop was typed here, lines count again after a second, and a short silence.
  void discard();
  void discard_briefly() { is_brief_ = true; }

  // Whether a typed stop would belong to the program being read.
  bool is_in_block() const { return is_open_ && is_waiting_ && awaited_word_ != ')'; }

  // Whether a line or a program has begun, and whether it may take its time.
  bool is_open() const { return is_open_; }

  // The open line and its program are lost: another part uses the memory. Returns whether further
  // lines of that program may come; they are ignored.
  bool drop();

  // Whether the last sender to the robot was a person.
  bool is_talking() const { return is_talking_; }
  void pick_up() { is_talking_ = true; }
  void hang_up() { is_talking_ = false; }

  // The client has left: the next one begins anew.
  void forget_client() { *this = Console(); }

  // The program that was read: its image, without a header.
  const Reader& reader() const { return reader_; }
  uint8_t* image() const { return image_; }

  // The keys to hold. A person who presses some is told once that no program `reads` them.
  const RemoteKeys& keys() const { return keys_; }
  void note_keys(bool reads, bool is_heard);

  // Sets the answer that is due. Writes it as a line of at most kWireBytes and returns its length.
  void say(Remark remark) { remark_ = remark; }
  bool has_answer() const { return remark_ != Remark::kNone; }

  // The same, unless a client is heard: bytes without a program are reported only to people.
  void tell(Remark remark, bool is_heard);
  uint8_t write(uint8_t* out);

  // Writes a line with a value that a program shows.
  uint8_t write_value(int32_t value, bool is_yes_no, uint8_t* out);

 private:
  // For the rest of a line with a SETUP word or of a block.
  static constexpr uint16_t kPatienceMs = 60000;

  // Times that run down to 0: what is left of kPatienceMs since the last byte of text, until lines count
  // again after a stop, until nobody knows any more that lines end here.
  enum Time : uint8_t { kPatience, kWait, kLineEnds, kTimes };

  void end_tail(bool is_heard);
  bool is_chatter();
  void take(uint8_t byte, bool is_heard);
  void read(uint8_t byte);
  Act end_line(bool is_heard);
  void end_silence();
  void begin_silence();
  bool begin(uint8_t byte);
  bool find_room();
  void refuse();
  bool is_ignored() const;

  // keys: `console_keys.cpp`
  bool take_keys();

  // writing: `console_writing.cpp`
  bool put_words();

  uint8_t* image_;
  uint16_t left_ms_[kTimes];
  uint8_t previous_letter_;  // the last but one of the letters and signs, in capitals
  uint8_t last_letter_;
  uint8_t start_column_;  // the column where the line began, or went on after a second of silence
  uint8_t length_;        // of the code before this line
  uint8_t first_byte_;    // the first byte of the program
  uint8_t awaited_word_;  // the word that the last line has left open, or ')'
  Remark remark_;
  const uint8_t* next_help_word_;  // the word of the robot that is said next, or nullptr
  uint8_t mistakes_;               // answered since the last pause
  bool is_open_;                   // the reader has begun a line or a program
  bool has_moved_;                 // it lies where there is room for a whole program
  Remark refusal_;                 // there is none: the line is not read, for this reason
  bool has_lost_program_;          // the program that the robot held: it is told after the next answer
  bool is_waiting_;                // for the end of a block that an earlier line has opened
  bool is_talking_;
  bool is_discarding_;
  bool is_brief_;        // the wait: a stop was typed here
  bool has_told_pause_;  // that lines do not count yet
  Remark tail_;          // the report on bytes without a line end
  bool is_ignoring_;     // lines without a SETUP word: their program is lost
  bool is_silent_;       // a second has passed
  bool is_due_;
  bool has_mark_;      // a typed stop waits after them
  tini_with_keys KeyLine key_line_;
  tini_with_keys RemoteKeys keys_;
  tini_with_keys uint16_t line_patience_ms_;  // the patience that was left when this line began
  tini_with_keys bool has_told_keys_;
  Reader reader_;
};

}  // namespace tiniscript
