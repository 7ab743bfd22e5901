#ifdef ARDUINO_ARCH_ESP32

#include "broker_line.h"

#include <lwip/netdb.h>

#include "sockets.h"

namespace tiniscript {

namespace {

const BrokerSettings* broker;
sockaddr_in server_address;
int connection = kNoSocket;
bool is_shaking;

// The address is that of the broker's name, or the one that a computer has found.
void look_up() {
  server_address = {};
  server_address.sin_family = AF_INET;
  server_address.sin_port = htons(broker->port);
  const hostent* const host = broker->name[0] == 0 ? nullptr : lwip_gethostbyname(broker->name);
  const bool is_known = host != nullptr && host->h_addrtype == AF_INET;
  __builtin_memcpy(&server_address.sin_addr.s_addr,
                   is_known ? host->h_addr_list[0] : reinterpret_cast<const char*>(broker->address),
                   sizeof broker->address);
}

}  // namespace

bool line_begin(const BrokerSettings& settings) {
  broker = &settings;
  look_up();
  connection = lwip_socket(AF_INET, SOCK_STREAM, 0);
  if (connection < 0) return false;
  is_shaking = false;
  const int yes = 1;
  lwip_setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return lwip_fcntl(connection, F_SETFL, O_NONBLOCK) >= 0;
}

// Called again until it is connected: lwIP and POSIX say so by EISCONN.
WifiState line_connect() {
  if (is_shaking) return tls_shake();
  const int result = lwip_connect(connection, reinterpret_cast<const sockaddr*>(&server_address),
                                  sizeof server_address);
  if (result != 0 && errno != EISCONN) {
    const bool is_under_way = errno == EINPROGRESS || errno == EALREADY;
    return is_under_way ? WifiState::kSearching : WifiState::kOff;
  }
  if (!broker->is_tls()) return WifiState::kReady;
  is_shaking = true;
  return tls_begin(connection, *broker);
}

int line_receive(uint8_t* bytes, size_t room) {
  if (is_shaking) return tls_receive(bytes, room);
  const ssize_t length = lwip_recv(connection, bytes, room, MSG_DONTWAIT);
  if (length > 0) return static_cast<int>(length);
  return length < 0 && may_come_later() ? kNothingYet : kEnded;
}

int line_send(const uint8_t* bytes, size_t length) {
  if (is_shaking) return tls_send(bytes, length);
  const ssize_t sent_length = lwip_send(connection, bytes, length, MSG_DONTWAIT);
  if (sent_length > 0) return static_cast<int>(sent_length);
  return sent_length == 0 || may_come_later() ? kNothingYet : kEnded;
}

void line_end() {
  tls_end();
  if (connection >= 0) lwip_close(connection);
  connection = kNoSocket;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
