// The sketch with its main loop on one thread, and on others what an ESP32 has on its second core:
// the tasks of the radios and of the broker, the core's own Bluetooth task, the timer's task. With ThreadSanitizer it
// finds what two of them touch at once.
//
// Run: two_cores SECONDS, or longer until enough has come through on each way, at most 60. Prints
// how much, and fails where it is not enough.

#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "../../src/firmware/board.h"
#include "simulated_chip.h"
#include "simulated_radio.h"
#include "simulated_timer.h"

namespace {

// A frame whose checksum is wrong, one that is too short, a line, and the stop sequence.
const std::string kFrame("\0\3\2\1\5\x7e\x34\xbe\x50\0", 10);
const std::string kDamaged("\4\3\1\1\1\0", 6);
const std::string kLine("PING|check_connection\n");
const std::string kStop(8, '\0');

constexpr double kLimitS = 60;
constexpr size_t kBrokerBytes = 200;

std::atomic<bool> is_over{false};
std::atomic<size_t> notification_count{0};
std::atomic<size_t> port_bytes{0};
std::atomic<size_t> network_bytes{0};
std::atomic<size_t> broker_bytes{0};
std::atomic<uint16_t> broker_port{0};

void pause(int us) { std::this_thread::sleep_for(std::chrono::microseconds(us)); }

// The core's Bluetooth task, and who is on the other side.
void run_low_energy() {
  std::minstd_rand generator(1);
  while (!is_over) {
    const uint16_t client = low_energy_connect();
    low_energy_agree(client, static_cast<uint16_t>(20 + generator() % 300));
    low_energy_subscribe(client, generator() % 8 != 0);
    for (unsigned rounds = generator() % 60; rounds > 0 && !is_over; rounds--) {
      const std::string* const messages[] = {&kFrame, &kDamaged, &kLine, &kStop};
      low_energy_write(client, *messages[generator() % 4]);
      notification_count += low_energy_notifications(client).size();
      pause(300);
    }
    if (generator() % 4 == 0) low_energy_disconnect(low_energy_connect());  // it is sent away
    low_energy_disconnect(client);
    pause(500);
  }
}

void run_serial_port() {
  while (!is_over) {
    serial_port_connect(true);
    for (int rounds = 40; rounds > 0 && !is_over; rounds--) {
      serial_port_write(kLine + kFrame);
      port_bytes += serial_port_output().size();
      pause(300);
    }
    serial_port_connect(false);
    pause(2000);
  }
}

void run_network() {
  while (!is_over) {
    pause(500);
    sockaddr_in place = {};
    place.sin_family = AF_INET;
    place.sin_port = htons(network_port());
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    if (place.sin_port != 0 &&
        connect(connection, reinterpret_cast<sockaddr*>(&place), sizeof place) == 0) {
      for (int rounds = 30; rounds > 0 && !is_over; rounds--) {
        const std::string message = kFrame + kStop;
        if (send(connection, message.data(), message.size(), MSG_NOSIGNAL) < 0) break;
        pollfd ready = {connection, POLLIN, 0};
        char bytes[256];
        if (poll(&ready, 1, 2) == 1) {
          const ssize_t length = recv(connection, bytes, sizeof bytes, 0);
          if (length <= 0) break;
          network_bytes += static_cast<size_t>(length);
        }
      }
    }
    close(connection);
  }
}

std::string mqtt(uint8_t type, const std::string& body) {
  return std::string({static_cast<char>(type), static_cast<char>(body.size())}) + body;
}

// What has come within 2 ms; empty if nothing has; `*is_there` says whether the robot still is.
std::string receive_from(int connection, bool* is_there) {
  pollfd ready = {connection, POLLIN, 0};
  char bytes[512];
  if (poll(&ready, 1, 2) != 1) return "";
  const ssize_t length = recv(connection, bytes, sizeof bytes, 0);
  *is_there = length > 0;
  return std::string(bytes, length > 0 ? static_cast<size_t>(length) : 0);
}

// A broker, and a client at it that comes and goes.
void serve(int connection) {
  bool is_there = true;
  std::string greeting;
  while (is_there && !is_over && greeting.empty()) greeting = receive_from(connection, &is_there);
  const size_t id = greeting.find("tini-");
  if (id == std::string::npos || id + 13 > greeting.size()) return;
  std::string topic = "tiniscript/aula/" + greeting.substr(id + 5, 8) + "/in/0badcafe";
  topic = std::string({0, static_cast<char>(topic.size())}) + topic;
  const std::string acks = mqtt(0x20, std::string(2, 0)) + mqtt(0x90, std::string("\0\1\0\0", 4));
  send(connection, acks.data(), acks.size(), MSG_NOSIGNAL);
  const std::string* const messages[] = {&kFrame, &kDamaged, &kLine, &kStop};
  for (unsigned turn = 0; turn < 200 && is_there && !is_over; turn++) {
    const bool leaves = turn % 50 == 49;
    const std::string message = mqtt(0x30, topic + (leaves ? "" : *messages[turn % 4]));
    if (send(connection, message.data(), message.size(), MSG_NOSIGNAL) < 0) return;
    broker_bytes += receive_from(connection, &is_there).size();
  }
}

void run_broker() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in place = {};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof place;
  bind(listener, reinterpret_cast<sockaddr*>(&place), length);
  getsockname(listener, reinterpret_cast<sockaddr*>(&place), &length);
  listen(listener, 4);
  broker_port = ntohs(place.sin_port);
  while (!is_over) {
    pollfd ready = {listener, POLLIN, 0};
    if (poll(&ready, 1, 20) != 1) continue;
    const int connection = accept(listener, nullptr, nullptr);
    serve(connection);
    close(connection);
  }
  close(listener);
}

// What the main loop does when a computer gives the robot a broker.
void use_broker() {
  using namespace tiniscript;
  const uint16_t port = broker_port;
  std::string settings({127, 0, 0, 1, static_cast<char>(port), static_cast<char>(port >> 8)});
  settings += "aula";
  const uint8_t* const bytes = reinterpret_cast<const uint8_t*>(settings.data());
  board_set_wifi(WifiStep::kBroker, bytes, static_cast<uint8_t>(settings.size()));
  board_set_wifi(WifiStep::kUseBroker, bytes, 0);
  board_wifi(WifiStep::kTellBroker);
}

bool is_enough() {
  return notification_count != 0 && port_bytes != 0 && network_bytes != 0 &&
         broker_bytes > kBrokerBytes;
}

// Every 10 ms of the chip: on this computer the main loop may have to wait for longer.
void run_chip_timer() {
  for (uint64_t due_us = 0; !is_over; pause(200)) {
    if (chip.now_us < due_us) continue;
    run_timer();
    due_us = chip.now_us + 10000;
  }
}

// An access point, as NVS has it.
std::string network() {
  std::string entry(1 + 33 + 64, '\0');
  entry[0] = 2;
  entry.replace(1, 4, "Tini");
  entry.replace(34, 8, "12345678");
  return entry;
}

}  // namespace

int main(int, char** words) {
  chip.entries["wifi"] = network();
  take_timer();
  setup();
  std::thread threads[] = {std::thread(run_low_energy), std::thread(run_serial_port),
                           std::thread(run_network), std::thread(run_broker),
                           std::thread(run_chip_timer)};
  while (broker_port == 0) pause(100);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  // on a computer with much else to do it takes longer until enough has come through
  for (uint32_t turn = 0; seconds() < atoi(words[1]) || (!is_enough() && seconds() < kLimitS);
       turn++) {
    if (turn % 4000 == 0) chip.received += "SI|F(0.1, 50)\n";
    // many in a row: the broker's task takes one while the next one comes
    if (turn == 0 || (turn % 4000 >= 2000 && turn % 4000 < 2200)) use_broker();
    loop();
    advance_us(50);
    chip.unsent_bytes = 0;
    chip.sent_bytes.clear();
  }
  is_over = true;
  for (std::thread& thread : threads) thread.join();
  printf("notified %zu\nserial port %zu\nnetwork %zu\nbroker %zu\n", notification_count.load(),
         port_bytes.load(), network_bytes.load(), broker_bytes.load());
  fflush(nullptr);
  _Exit(is_enough() ? 0 : 1);  // tasks go on until then; the race checker has ended others already
}
