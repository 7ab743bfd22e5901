// The reader of text: lines become code, or a problem with its column.

#include <doctest.h>

#include <string>
#include <vector>

#include "../src/text/reader.h"
#include "../src/text/unpacked.h"
#include "../src/vm/bytecode.h"

using namespace tiniscript;

namespace {

struct Reading {
  Text put(const std::string& text) {
    Text found = Text::kGoesOn;
    for (const char letter : text) found = reader.put(static_cast<uint8_t>(letter));
    return found;
  }
  std::vector<uint8_t> code() const {
    return std::vector<uint8_t>(buffer, buffer + reader.length());
  }

  uint8_t buffer[200];
  Reader reader = Reader();
};

// The code of a line that is a program.
std::vector<uint8_t> code_of(const std::string& line) {
  Reading reading;
  reading.reader.begin(reading.buffer, sizeof reading.buffer);
  INFO(line);
  REQUIRE(reading.put(line + "\n") == Text::kProgram);
  return reading.code();
}

std::vector<uint8_t> codes(const std::vector<Op>& ops) {
  std::vector<uint8_t> bytes;
  for (const Op op : ops) bytes.push_back(static_cast<uint8_t>(op));
  return bytes;
}

std::string said;

void say(uint8_t letter) { said.push_back(static_cast<char>(letter)); }

// What a text says.
std::string unpacked(uint8_t number) {
  said.clear();
  put_text<say>(number);
  return said;
}

}  // namespace

TEST_CASE("a line of text becomes code") {
  CHECK(code_of("SI|F(2, 80)") == codes({Op::kPushNum2, Op::kPushNum80, Op::kMoveF}));
  CHECK(code_of("arm(90)") == codes({Op::kPushNum90, Op::kSet0}));
  CHECK(code_of("touch") == codes({Op::kRead1}));
}

TEST_CASE("a reading stands before its instruction") {
  CHECK(code_of("F(1, DISTANCE)") ==
        codes({Op::kRead0, Op::kPushNum1, Op::kPushSensor0, Op::kMoveF}));
}

TEST_CASE("a program goes on until its blocks are closed") {
  Reading reading;
  reading.reader.begin(reading.buffer, sizeof reading.buffer);
  CHECK(reading.put("\r\n") == Text::kGoesOn);  // LF behind CR is no line of its own
  CHECK(reading.put("\r") == Text::kNothing);
  CHECK(reading.put("SB|LOOP(FOREVER)\n") == Text::kMore);
  CHECK(reading.put("W(1\n") == Text::kMore);
  CHECK(reading.put(")\n") == Text::kMore);
  CHECK(reading.put("END_LOOP\n") == Text::kProgram);
  CHECK(reading.reader.start() == 1);
  CHECK(reading.code() == std::vector<uint8_t>({0x68, 0xb1, 0x50, 0x6b, 4}));
}

TEST_CASE("a problem has a column and a text") {
  Reading reading;
  reading.reader.begin(reading.buffer, sizeof reading.buffer);
  CHECK(reading.put("F(2, 800); S\n") == Text::kProblem);
  CHECK(reading.reader.problem() == Problem::kRange);
  CHECK(reading.reader.column() == 6);
  CHECK(reading.reader.value() == 800000);
  CHECK(reading.reader.limit(0) == 0);
  CHECK(reading.reader.limit(4) == 100000);
  CHECK(unpacked(text_of(Problem::kRange)) == " to ");
  CHECK(unpacked(text_of(Problem::kChecksum)) == "Line damaged. Send it again");
  CHECK(unpacked(text_of(Remark::kOk)) == "OK");
  CHECK(unpacked(text_of(Remark::kHelp)) == "");
  CHECK(unpacked(name_of_fault(1)) == "OVERFLOW");
  CHECK(unpacked(name_of_fault(64)) == "LINK_LOST");
  CHECK(unpacked(name_of_fault(255)) == "BAD_CODE");
}

TEST_CASE("a line runs only with the checksum that it has") {
  Reading reading;
  reading.reader.begin(reading.buffer, sizeof reading.buffer);
  CHECK(reading.put("S~08D60B65\n") == Text::kProblem);
  CHECK(reading.reader.problem() == Problem::kChecksum);
  reading.reader.begin(reading.buffer, sizeof reading.buffer);
  CHECK(reading.put("S~2060EFC3\n") == Text::kProgram);
}
