// The start button in all ways to be spiked, on this computer: prints what it tells.
//
// Each line of the input is a case: the time between two looks in us, when the first look is, and
// then the times in us at which the button goes down and up. It was up for a second before. Each
// line of the output is `TIME LETTER` for each thing that was told: P, H or R.

#include "../../vm_arduino/src/boards/button.h"

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

using namespace tiniscript;

int main() {
  uint64_t now_us = 1;  // goes on from case to case
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    uint64_t turn_us = 0, first_us = 0, edge_us = 0;
    words >> turn_us >> first_us;
    std::vector<uint64_t> edges;
    while (words >> edge_us) edges.push_back(edge_us);
    const uint64_t begun_us = now_us + 1000000;
    for (; now_us < begun_us; now_us += 1000) {
      button_read(false, static_cast<uint32_t>(now_us / 1000));
    }
    size_t next = 0;
    const uint64_t end_us = begun_us + edges.back() + 500000;
    for (now_us = begun_us + first_us; now_us < end_us; now_us += turn_us) {
      while (next < edges.size() && begun_us + edges[next] <= now_us) next++;
      const Press press = button_read(next % 2 == 1, static_cast<uint32_t>(now_us / 1000));
      if (press != Press::kNothing) {
        std::cout << now_us - begun_us << ' ' << " PHR"[static_cast<int>(press)] << ' ';
      }
    }
    std::cout << '\n';
  }
  return 0;
}
