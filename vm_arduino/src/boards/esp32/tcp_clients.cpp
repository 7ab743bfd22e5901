// TCP over WiFi, by sockets that never wait.
//
// No byte of a connection reaches the robot before its first bytes are those of a robot's client: a
// web page can make a browser connect to any address.

#ifdef ARDUINO_ARCH_ESP32

#include "tcp_clients.h"

#include <Arduino.h>

#include "protocol_sniffer.h"
#include "radio.h"
#include "sockets.h"
#include "wifi_settings.h"

namespace tiniscript {

namespace {

constexpr uint8_t kClients = 2;
constexpr uint32_t kBeginMs = 10000;   // since it was accepted, until its first bytes are clear
constexpr size_t kChunk = 256;

struct Client {
  int socket;
  Transport transport;
  bool is_admitted;
  uint32_t accepted_ms;
  uint32_t heard_ms;

  bool has_key() const { return is_admitted && radio_pipe(transport).has_key(); }
  size_t first_length;
  StopFinder finder;   // in them
  bool was_silent;     // for a second after one of them, of which the main loop does not know
  uint8_t first_bytes[kFirstBytes];
  size_t out_length;
  size_t out_sent;
  uint8_t out[kChunk];
};

int listener = kNoSocket;
Client clients[kClients];

uint32_t now_ms() { return static_cast<uint32_t>(millis()); }

void close_client(Client* client) {
  if (client->socket == kNoSocket) return;
  lwip_close(client->socket);
  client->socket = kNoSocket;
  if (client->is_admitted) radio_pipe(client->transport).end_client();
}

void close_all() {
  for (Client& client : clients) close_client(&client);
  if (listener != kNoSocket) lwip_close(listener);
  listener = kNoSocket;
}

void listen() {
  const int socket = lwip_socket(AF_INET, SOCK_STREAM, 0);
  if (socket < 0) return;
  sockaddr_in place = {};
  place.sin_family = AF_INET;
  place.sin_port = htons(kNetworkPort);
  place.sin_addr.s_addr = htonl(INADDR_ANY);
  const int yes = 1;
  lwip_setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool is_there =
      lwip_bind(socket, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0 &&
      lwip_listen(socket, kClients) == 0 && lwip_fcntl(socket, F_SETFL, O_NONBLOCK) >= 0;
  if (is_there) {
    listener = socket;
  } else {
    lwip_close(socket);
  }
}

// A place for a new client: a free one, or that of a client without a key, preferably one that has
// not identified itself yet; so an owner's stop is never kept out. Owners keep theirs while they
// speak.
Client* free_place() {
  Client* evicted_client = nullptr;
  uint32_t highest_rank = 0;
  for (Client& client : clients) {
    if (client.socket == kNoSocket) return &client;
    uint32_t silent_ms = now_ms() - client.heard_ms;
    if (client.has_key() && silent_ms < kPlaceMs) continue;
    if (silent_ms > kPlaceMs) silent_ms = kPlaceMs;
    const uint32_t eviction_rank = client.has_key()     ? 1
                                   : client.is_admitted ? 2 + silent_ms
                                                        : UINT32_MAX;
    if (eviction_rank > highest_rank) {
      highest_rank = eviction_rank;
      evicted_client = &client;
    }
  }
  if (evicted_client != nullptr) close_client(evicted_client);
  return evicted_client;
}

void accept_next() {
  const int socket = lwip_accept(listener, nullptr, nullptr);
  if (socket < 0) return;
  Client* const client = free_place();
  if (client == nullptr || lwip_fcntl(socket, F_SETFL, O_NONBLOCK) < 0) {
    lwip_close(socket);
    return;
  }
  const int yes = 1;
  lwip_setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  client->socket = socket;
  client->is_admitted = false;
  client->accepted_ms = client->heard_ms = now_ms();
  client->first_length = client->out_length = client->out_sent = 0;
  client->finder = StopFinder();
  client->was_silent = false;
}

void pass_on(Client* client, const uint8_t* bytes, size_t length) {
  Pipe& pipe = radio_pipe(client->transport);
  for (size_t k = 0; k < length; k++) pipe.put(bytes[k], static_cast<uint16_t>(now_ms()));
}

// Looks at the first bytes, and lets the client in or hangs up. A stop among them that the main
// loop does not see, or not yet, admits no client.
void look(Client* client, const uint8_t* bytes, size_t length) {
  StopKind strongest = StopKind::kNothing;
  for (size_t k = 0; k < length; k++) {
    const StopKind stop = client->finder.put(bytes[k], static_cast<uint16_t>(now_ms()));
    if (stop > strongest) strongest = stop;
  }
  const size_t room = kFirstBytes - client->first_length;
  const size_t copied_bytes = length < room ? length : room;
  __builtin_memcpy(client->first_bytes + client->first_length, bytes, copied_bytes);
  client->first_length += copied_bytes;
  const Protocol protocol = sniff_protocol(client->first_bytes, client->first_length);
  const bool is_full = client->first_length == kFirstBytes;
  if (protocol == Protocol::kOther || (protocol == Protocol::kUnknownYet && is_full)) {
    return close_client(client);
  }
  const bool is_passed_on = protocol == Protocol::kForRobot && !client->was_silent;
  if (strongest > StopKind::kInFrame && !is_passed_on) {
    radio_pipe(client->transport).stop(strongest == StopKind::kOfRun);
  }
  if (protocol == Protocol::kUnknownYet) return;
  if (!radio_pipe(client->transport).begin()) return close_client(client);
  client->is_admitted = true;
  pass_on(client, client->first_bytes, client->first_length);
  pass_on(client, bytes + copied_bytes, length - copied_bytes);
}

// A second of silence ends a typed stop while something runs, and a line begins after it. It admits
// no client.
void end_silence(Client* client) {
  if (client->finder.is_at_stop()) radio_pipe(client->transport).stop(true);
  client->finder.begin();
  client->was_silent = client->first_length != 0;
}

void receive(Client* client) {
  if (!client->is_admitted && now_ms() - client->accepted_ms >= kBeginMs) {
    return close_client(client);
  }
  uint8_t bytes[kChunk];
  const ssize_t length = lwip_recv(client->socket, bytes, sizeof bytes, MSG_DONTWAIT);
  if (length > 0) {
    client->heard_ms = now_ms();
    if (!client->is_admitted) return look(client, bytes, static_cast<size_t>(length));
    return pass_on(client, bytes, static_cast<size_t>(length));
  }
  if (length == 0 || !may_come_later()) return close_client(client);
  if (!client->is_admitted && now_ms() - client->heard_ms >= kSilenceMs) end_silence(client);
}

void send_output(Client* client) {
  if (client->socket == kNoSocket || !client->is_admitted) return;
  if (client->out_sent == client->out_length) {
    client->out_sent = client->out_length = 0;
    Pipe& pipe = radio_pipe(client->transport);
    while (client->out_length < kChunk && pipe.take(client->out + client->out_length)) {
      client->out_length++;
    }
  }
  const size_t bytes_left = client->out_length - client->out_sent;
  if (bytes_left == 0) return;
  const ssize_t sent_length =
      lwip_send(client->socket, client->out + client->out_sent, bytes_left, MSG_DONTWAIT);
  if (sent_length > 0) client->out_sent += static_cast<size_t>(sent_length);
  if (sent_length < 0 && !may_come_later()) close_client(client);
}

}  // namespace

void network_begin() {
  for (uint8_t k = 0; k < kClients; k++) {
    clients[k].socket = kNoSocket;
    clients[k].transport = k == 0 ? Transport::kNetwork : Transport::kSecondNetwork;
  }
}

void network_turn() {
  const bool has_network = wifi_turn();
  if (!has_network) return close_all();
  if (listener == kNoSocket) listen();
  if (listener == kNoSocket) return;
  accept_next();
  for (Client& client : clients) {
    if (client.socket != kNoSocket) receive(&client);
    send_output(&client);
  }
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
