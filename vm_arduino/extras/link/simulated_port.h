// A robot that writes down what the link asks of it. Defines what `port.h` declares.

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "../../src/link/port.h"

struct SimulatedPort {
  tiniscript::Identity identity = {};
  tiniscript::DeviceInfo device_info = {};
  uint8_t sensors = 0;
  uint8_t actuators = 0;
  tiniscript::RobotStatus robot_status = {};
  tiniscript::Tuning tuning = {};
  uint8_t keys[2][tiniscript::kKeyBytes] = {};
  std::vector<uint16_t> hashes;  // of the kit's devices
  std::vector<uint8_t> words;    // its words, as `robot_words` says them
  uint16_t room = 0;
  bool is_busy = false;              // it saves, and cannot make way
  bool is_saving = false;            // it has not kept yet what it was given
  std::unique_ptr<uint8_t[]> image;  // of exactly its length: a sanitizer sees what is outside
  std::unique_ptr<uint8_t[]> live;
  std::unique_ptr<uint8_t[]> old_image;  // what they were until it makes way
  std::unique_ptr<uint8_t[]> old_live;
  std::unique_ptr<uint8_t[]> text;        // what is read as text
  std::unique_ptr<uint8_t[]> whole_text;  // where there is room for all of it
  std::string held_image;                 // the image that START starts
  std::string run_image;                  // that of the run
  uint16_t offset = 0;                    // where it is
  std::string stored_image;               // the saved one: held again where an upload breaks off
  std::string previous_image;             // the one that was saved before
  std::string log;
};

// The one robot of this program.
extern SimulatedPort port;
