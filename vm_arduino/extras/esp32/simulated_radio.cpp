#include "simulated_radio.h"

#include <BLE2902.h>
#include <BLEServer.h>
#include <BluetoothSerial.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <esp_log.h>
#include <arpa/inet.h>
#include <freertos/task.h>
#include <lwip/netdb.h>
#include <lwip/sockets.h>
#include <string.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <mutex>

#include "simulated_chip.h"

WiFiClass WiFi;
MDNSResponder MDNS;

namespace {

std::mutex guard;
typedef std::lock_guard<std::mutex> Lock;

RadioSettings settings;

// Bluetooth LE; the objects are there once.
BLEServer server;
BLEService service;
BLEAdvertising advertising;
BLECharacteristic characteristics[2];
size_t characteristic_count;
bool has_le;
bool has_server;
bool has_started;  // its service
constexpr esp_gatt_if_t kInterface = 3;
constexpr uint16_t kFirstHandle = 42;  // of the characteristics, each with a descriptor after it
struct LowEnergyClient {
  uint16_t mtu = 23;
  bool has_subscribed = false;
  std::vector<std::string> notified;
};
constexpr size_t kMaxClients = 3;  // CONFIG_BTDM_CTRL_BLE_MAX_CONN of the core
std::map<uint16_t, LowEnergyClient> clients;
std::vector<uint16_t> dismissed_clients;  // and still there
gatts_event_handler on_gatts_event;
BLECharacteristicCallbacks* on_write;
bool is_congested;
std::string written_bytes;
bool is_advertising;

// the serial port
constexpr size_t kPortPacket = 990;  // bytes that RFCOMM hands over at once
constexpr uint16_t kPortWaitMs = 1000;
uint32_t port_handles;  // so far
uint32_t port_client;   // its handle; 0: nobody
bool is_second_attempt;
std::vector<uint32_t> closing_ports;
std::atomic<bool> is_port_stuck{false};
esp_spp_cb_t on_port;
BluetoothSerialDataCb on_port_data;
std::string port_output;

// Both kinds of Bluetooth, which begin the same controller.
constexpr uint16_t kBeginningMs = 20;
std::atomic<bool> bluetooth_begins{false};
std::atomic<bool> has_bluetooth{false};

// WiFi
constexpr uint8_t kNoNetwork = 201;
constexpr uint32_t kScanMs = 2500;  // all channels
uint8_t refusal = 15;
bool reconnects = true;  // STAClass::_autoReconnect
esp_log_level_t log_level = ESP_LOG_ERROR;  // CONFIG_LOG_DEFAULT_LEVEL of the core
uint32_t lease_ms;
uint32_t search_ms;  // until a network is found, or none
bool is_associated;
bool is_expired;  // of which the core does not notice: its status stays WL_CONNECTED
uint32_t associated_ms;
uint32_t scanned_ms;
WiFiEventSysCb on_disconnected;
WiFiEventSysCb on_connected;
constexpr uint8_t kAuthExpire = 2;
wifi_mode_t wifi_mode = WIFI_OFF;
bool has_modem_sleep = true;
std::atomic<bool> has_network_stack{false};
std::atomic<int> sockets{0};
constexpr int kMaxSockets = 16;
std::atomic<size_t> send_limit{
    90};  // of what is sent at once: the rest comes later, as over a poor radio
std::string reachable_name;
std::string reachable_password;
uint16_t bound_port;
int bound_socket = -1;
bool has_mdns;
std::map<std::string, std::string> addresses = {{"localhost", "127.0.0.1"}};
std::map<std::string, uint16_t> waits_ms;  // until a name is looked up

// The controller takes its time, in which other tasks go on.
void begin_bluetooth() {
  expect(!bluetooth_begins.exchange(true), "Bluetooth that begins in two tasks at once");
  if (!has_bluetooth) vTaskDelay(kBeginningMs);
  has_bluetooth = true;
  bluetooth_begins = false;
}

bool begin_mdns(const char* host) {
  expect(has_network_stack, "the network before WiFi has begun");
  const Lock lock(guard);
  if (chip.is_heap_full) return false;
  settings.host = host;
  has_mdns = true;
  return true;
}

// Of whoever holds the lock.
void look_at_sleep() {
  expect(has_modem_sleep || !has_bluetooth || (wifi_mode & WIFI_STA) == 0,
         "WiFi without modem sleep beside Bluetooth");
}

// Who was sent away leaves.
void drop_dismissed() {
  for (;;) {
    uint16_t client;
    {
      const Lock lock(guard);
      if (dismissed_clients.empty()) return;
      client = dismissed_clients.back();
      dismissed_clients.pop_back();
    }
    low_energy_disconnect(client);
  }
}

void send_port_event(esp_spp_cb_event_t event, esp_spp_cb_param_t param) {
  esp_spp_cb_t callback;
  {
    const Lock lock(guard);
    callback = on_port;
  }
  if (callback != nullptr) callback(event, &param);
}

void close_ports() {
  for (;;) {
    esp_spp_cb_param_t param = {};
    {
      const Lock lock(guard);
      if (closing_ports.empty()) return;
      param.close.handle = closing_ports.front();
      closing_ports.erase(closing_ports.begin());
      if (!is_second_attempt) port_client = 0;
      is_second_attempt = false;
    }
    send_port_event(ESP_SPP_CLOSE_EVT, param);
  }
}

// The stack's task tells; it has a handler as soon as anybody may be connected.
void send_event(esp_gatts_cb_event_t event, esp_ble_gatts_cb_param_t param) {
  gatts_event_handler handler;
  {
    const Lock lock(guard);
    handler = on_gatts_event;
  }
  if (handler != nullptr) handler(event, kInterface, &param);
  drop_dismissed();
}

}  // namespace

// -- who is on the other side -------------------------------------------------------------------

uint16_t low_energy_connect() {
  uint16_t client = 0;
  {
    const Lock lock(guard);
    if (!is_advertising || clients.size() == kMaxClients) return kNoClient;
    while (clients.count(client) != 0) client++;
    is_advertising = false;
    clients[client] = LowEnergyClient();
  }
  esp_ble_gatts_cb_param_t param = {};
  param.connect.conn_id = client;
  send_event(ESP_GATTS_CONNECT_EVT, param);
  return client;
}

void low_energy_disconnect(uint16_t client) {
  {
    const Lock lock(guard);
    if (clients.erase(client) == 0) return;
  }
  esp_ble_gatts_cb_param_t param = {};
  param.disconnect.conn_id = client;
  send_event(ESP_GATTS_DISCONNECT_EVT, param);
}

bool low_energy_is_there(uint16_t client) {
  const Lock lock(guard);
  return clients.count(client) != 0;
}

void low_energy_agree(uint16_t client, uint16_t mtu) {
  {
    const Lock lock(guard);
    if (clients.count(client) == 0) return;
    clients[client].mtu = mtu < 23 ? 23 : mtu > 247 ? 247 : mtu;
  }
  esp_ble_gatts_cb_param_t param = {};
  param.mtu.conn_id = client;
  param.mtu.mtu = mtu;
  send_event(ESP_GATTS_MTU_EVT, param);
}

void low_energy_subscribe(uint16_t client, bool subscribes) {
  {
    const Lock lock(guard);
    if (clients.count(client) == 0) return;
    clients[client].has_subscribed = subscribes;
  }
  uint8_t value[] = {subscribes, 0};
  esp_ble_gatts_cb_param_t param = {};
  param.write = {client, BLEDescriptor().getHandle(), sizeof value, value};
  send_event(ESP_GATTS_WRITE_EVT, param);
}

void low_energy_congest(bool is_on) {
  const Lock lock(guard);
  is_congested = is_on;
}

void low_energy_write(uint16_t client, const std::string& bytes) {
  {
    const Lock lock(guard);
    if (clients.count(client) == 0) return;
  }
  written_bytes = bytes;  // of the stack's task alone
  esp_ble_gatts_cb_param_t param = {};
  param.write = {client, characteristics[1].getHandle(),
                 static_cast<uint16_t>(written_bytes.size()), characteristics[1].getData()};
  on_write->onWrite(&characteristics[1], &param);
  send_event(ESP_GATTS_WRITE_EVT, param);
}

std::vector<std::string> low_energy_notifications(uint16_t client) {
  const Lock lock(guard);
  std::vector<std::string> notifications;
  if (clients.count(client) != 0) notifications.swap(clients[client].notified);
  return notifications;
}

// As `esp_spp_cb` of BluetoothSerial.cpp has it: after a second attempt the first one that closes is
// taken for that.
void serial_port_connect(bool is_there) {
  esp_spp_cb_param_t param = {};
  {
    const Lock lock(guard);
    if (is_there) {
      param.srv_open.handle = ++port_handles;
      if (port_client == 0) {
        port_client = port_handles;
      } else {
        is_second_attempt = true;
        closing_ports.push_back(port_handles);
      }
    } else if (port_client != 0) {
      closing_ports.push_back(port_client);
    }
  }
  if (is_there) send_port_event(ESP_SPP_SRV_OPEN_EVT, param);
  close_ports();
}

bool serial_port_has_client() {
  const Lock lock(guard);
  return port_client != 0;
}

void serial_port_write(const std::string& bytes) {
  BluetoothSerialDataCb callback;
  {
    const Lock lock(guard);
    if (port_client == 0) return;
    callback = on_port_data;
  }
  for (size_t offset = 0; offset < bytes.size(); offset += kPortPacket) {
    const std::string packet = bytes.substr(offset, kPortPacket);
    if (callback) callback(reinterpret_cast<const uint8_t*>(packet.data()), packet.size());
  }
}

void serial_port_stick(bool is_stuck) { is_port_stuck = is_stuck; }

std::string serial_port_output() {
  const Lock lock(guard);
  std::string output;
  output.swap(port_output);
  return output;
}

void network_in_reach(const std::string& name, const std::string& password) {
  const Lock lock(guard);
  reachable_name = name;
  reachable_password = password;
}

void network_name(const std::string& name, const std::string& address, uint16_t wait_ms) {
  const Lock lock(guard);
  addresses[name] = address;
  waits_ms[name] = wait_ms;
}

void network_refuses(uint8_t reason) { refusal = reason; }

void network_takes(uint16_t byte_limit) { send_limit = byte_limit; }

void network_expires() {
  arduino_event_t event = {ARDUINO_EVENT_WIFI_STA_DISCONNECTED, {{kAuthExpire}}};
  {
    const Lock lock(guard);
    if (!is_associated) return;
    is_associated = false;
    is_expired = !reconnects;
  }
  if (on_disconnected != nullptr) on_disconnected(&event);
}

void network_leases_after(uint32_t new_lease_ms) {
  const Lock lock(guard);
  lease_ms = new_lease_ms;
}

void network_searches(uint32_t new_search_ms) {
  const Lock lock(guard);
  search_ms = new_search_ms;
}

void radio_logs() {
  if (log_level >= ESP_LOG_ERROR) {
    chip.sent_bytes += "E (15234) wifi:sta is connecting, cannot set config\r\n";
  }
}

uint16_t network_port() {
  const Lock lock(guard);
  return bound_port;
}

RadioSettings radio_settings() {
  const Lock lock(guard);
  RadioSettings current = settings;
  current.sockets = static_cast<uint32_t>(sockets);
  return current;
}

// -- what the core has --------------------------------------------------------------------------

String::String(const char* cstr) : text_(strdup(cstr)) {}
String::String(const String& str) : text_(strdup(str.text_)) {}
String::~String() { free(text_); }
const char* String::c_str() const { return text_; }

#if ESP_ARDUINO_VERSION_MAJOR >= 3
bool BluetoothSerial::begin(String localName, bool, bool) {
#else
bool BluetoothSerial::begin(String localName, bool) {
#endif
  begin_bluetooth();
  const Lock lock(guard);
  look_at_sleep();
  settings.serial_port = localName.c_str();
  return true;
}

esp_err_t BluetoothSerial::register_callback(esp_spp_cb_t callback) {
  const Lock lock(guard);
  on_port = callback;
  return ESP_OK;
}

bool BluetoothSerial::hasClient() {
  const Lock lock(guard);
  return port_client != 0;
}

extern "C" esp_err_t esp_spp_disconnect(uint32_t handle) {
  const Lock lock(guard);
  expect(handle != 0, "a serial port of nobody");
  closing_ports.push_back(handle);
  return ESP_OK;
}

void BluetoothSerial::onData(BluetoothSerialDataCb cb) {
  expect(!has_bluetooth, "a callback of a serial port that may have clients");
  const Lock lock(guard);
  on_port_data = cb;
}

size_t BluetoothSerial::write(const uint8_t* buffer, size_t size) {
  for (uint16_t ms = 0; is_port_stuck; ms++) {
    if (ms == kPortWaitMs) return 0;
    vTaskDelay(1);
  }
  const Lock lock(guard);
  port_output.append(reinterpret_cast<const char*>(buffer), size);
  return size;
}

void BLECharacteristicCallbacks::onWrite(BLECharacteristic*, esp_ble_gatts_cb_param_t*) {}

void BLECharacteristic::addDescriptor(BLEDescriptor*) {
  expect(!has_started, "a part of a service that has started");
}
uint8_t* BLECharacteristic::getData() { return reinterpret_cast<uint8_t*>(&written_bytes[0]); }
size_t BLECharacteristic::getLength() { return written_bytes.size(); }
void BLECharacteristic::setCallbacks(BLECharacteristicCallbacks* pCallbacks) {
  const Lock lock(guard);
  on_write = pCallbacks;
}
uint16_t BLECharacteristic::getHandle() {
  expect(has_started, "the handle of a service that has not started");
  return static_cast<uint16_t>(kFirstHandle + 2 * (this - characteristics));
}
uint16_t BLEDescriptor::getHandle() { return kFirstHandle + 1; }  // there is one

extern "C" esp_err_t esp_ble_gatts_send_indicate(esp_gatt_if_t gatts_if, uint16_t conn_id,
                                                 uint16_t attr_handle, uint16_t value_len,
                                                 uint8_t* value, bool) {
  const Lock lock(guard);
  expect(gatts_if == kInterface && attr_handle == kFirstHandle, "a notification of nothing");
  const auto position = clients.find(conn_id);
  if (position == clients.end()) return ESP_ERR_INVALID_STATE;
  if (is_congested) return ESP_FAIL;
  LowEnergyClient& client = position->second;
  if (!client.has_subscribed) return ESP_OK;  // it is sent, and the client throws it away
  const size_t byte_limit = client.mtu - 3U;  // the stack cuts the rest off
  client.notified.emplace_back(reinterpret_cast<char*>(value),
                               value_len < byte_limit ? value_len : byte_limit);
  return ESP_OK;
}

BLECharacteristic* BLEService::createCharacteristic(const char*, uint32_t) {
  expect(!has_started, "a part of a service that has started");
  return &characteristics[characteristic_count++];
}
void BLEService::start() { has_started = true; }

BLEService* BLEServer::createService(const char*) { return &service; }
void BLEServer::disconnect(uint16_t connId) {
  const Lock lock(guard);
  expect(clients.count(connId) != 0, "a client that is sent away and not there");
  dismissed_clients.push_back(connId);
}

void BLEAdvertising::addServiceUUID(const char*) {}
void BLEAdvertising::setScanResponse(bool) {}

BLEServer* BLEDevice::createServer() {
  expect(has_le, "Bluetooth LE before BLEDevice::init");
  has_server = true;
  return &server;
}
BLEAdvertising* BLEDevice::getAdvertising() { return &advertising; }
void BLEDevice::init(BleText deviceName) {
  begin_bluetooth();
  const Lock lock(guard);
  look_at_sleep();
  has_le = true;
  settings.advertised = deviceName.c_str();
}
void BLEDevice::setCustomGattsHandler(gatts_event_handler handler) {
  expect(!has_started, "a handler that misses events of a service that has started");
  const Lock lock(guard);
  on_gatts_event = handler;
}
esp_err_t BLEDevice::setMTU(uint16_t mtu) {
  expect(has_le, "Bluetooth LE before BLEDevice::init");
  expect(mtu >= 23 && mtu <= 517, "an MTU that Bluetooth LE does not have");
  return ESP_OK;
}
void BLEDevice::startAdvertising() {
  expect(has_server && has_started, "advertising before the service has started");
  const Lock lock(guard);
  is_advertising = true;
}

IPAddress::IPAddress(uint8_t first, uint8_t second, uint8_t third, uint8_t fourth)
    : bytes_{first, second, third, fourth} {}
uint8_t IPAddress::operator[](int index) const { return bytes_[index]; }

wl_status_t WiFiClass::begin(const char* ssid, const char* passphrase, int32_t, const uint8_t*,
                             bool) {
  const Lock lock(guard);
  if (ssid[0] == 0 || strlen(ssid) > 32 || strlen(passphrase) > 64) return WL_CONNECT_FAILED;
  const bool is_same = settings.network == ssid && settings.password == passphrase;
  if (is_expired && is_same) return WL_CONNECTED;  // and does nothing
  settings.network = ssid;
  settings.password = passphrase;
  settings.is_access_point = false;
  settings.joins++;
  is_expired = false;
  is_associated = false;  // it joins anew
  scanned_ms = static_cast<uint32_t>(millis());
  return WL_DISCONNECTED;
}

// What the core's task tells, which this one does in its place: a wrong password is "disconnected",
// as `WiFiGenericClass::_eventCallback` has it.
wl_status_t WiFiClass::status() {
  arduino_event_t event = {ARDUINO_EVENT_WIFI_STA_DISCONNECTED, {{refusal}}};
  wl_status_t status = WL_DISCONNECTED;
  {
    const Lock lock(guard);
    if (wifi_mode != WIFI_STA) return WL_NO_SHIELD;
    if (is_expired) return WL_CONNECTED;
    const uint32_t now_ms = static_cast<uint32_t>(millis());
    if (!is_associated && now_ms - scanned_ms < search_ms) return WL_DISCONNECTED;
    const bool is_near = !reachable_name.empty() && reachable_name == settings.network;
    if (is_near && reachable_password == settings.password) {
      // once out of reach, it is joined again by whoever tries
      if (!is_associated && now_ms - scanned_ms >= kScanMs && !reconnects) return WL_DISCONNECTED;
      if (!is_associated) {
        associated_ms = now_ms;
        is_associated = true;
        arduino_event_t joined_event = {ARDUINO_EVENT_WIFI_STA_CONNECTED, {{0}}};
        if (on_connected != nullptr) on_connected(&joined_event);
      }
      return now_ms - associated_ms < lease_ms ? WL_IDLE_STATUS : WL_CONNECTED;
    }
    is_associated = false;
    if (reconnects && now_ms - scanned_ms >= kScanMs) {
      scanned_ms = now_ms;
      settings.joins++;
    }
    if (!is_near) {
      status = WL_NO_SSID_AVAIL;
      event.event_info.wifi_sta_disconnected.reason = kNoNetwork;
    }
  }
  if (on_disconnected != nullptr) on_disconnected(&event);
  return status;
}

int WiFiClass::onEvent(WiFiEventSysCb cbEvent, arduino_event_id_t event) {
  (event == ARDUINO_EVENT_WIFI_STA_CONNECTED ? on_connected : on_disconnected) = cbEvent;
  return 0;
}

bool WiFiClass::softAP(const char* ssid, const char* passphrase, int, int, int, bool) {
  const Lock lock(guard);
  if (ssid[0] == 0 || strlen(passphrase) < 8) return false;
  if (chip.is_heap_full) return false;  // as where esp_wifi_init has no memory beside Bluetooth
  settings.network = ssid;
  settings.password = passphrase;
  settings.is_access_point = true;
  return true;
}

bool WiFiClass::mode(wifi_mode_t m) {
  const Lock lock(guard);
  wifi_mode = m;
  is_associated = is_expired = false;
  chip.has_wifi = m != WIFI_OFF;
  if (chip.has_wifi) has_network_stack = true;
  look_at_sleep();
  if (m == WIFI_OFF) {
    settings.network = settings.password = "";
    settings.is_access_point = false;
  }
  return true;
}

bool WiFiClass::reconnect() {
  const Lock lock(guard);
  settings.joins++;
  is_associated = is_expired = false;
  scanned_ms = static_cast<uint32_t>(millis());
  return true;
}

bool WiFiClass::setAutoReconnect(bool autoReconnect) {
  reconnects = autoReconnect;
  return true;
}

bool WiFiClass::disconnect(bool, bool) { return true; }
bool WiFiClass::softAPdisconnect(bool) {
  expect((wifi_mode & WIFI_AP) != 0, "softAPdisconnect where there is no access point");
  return true;
}
void WiFiClass::persistent(bool) {
  expect(!has_network_stack, "WiFi that learns too late to keep no password");
}
bool WiFiClass::setHostname(const char*) {
  expect(wifi_mode == WIFI_OFF, "a host name after WiFi has begun");
  return true;
}

bool WiFiClass::setSleep(bool enabled) {
  const Lock lock(guard);
  has_modem_sleep = enabled;
  look_at_sleep();
  return true;
}

IPAddress WiFiClass::localIP() { return IPAddress(127, 0, 0, 1); }
IPAddress WiFiClass::softAPIP() { return IPAddress(192, 168, 4, 1); }

#if ESP_ARDUINO_VERSION_MAJOR >= 3
bool MDNSResponder::begin(const String& hostName) { return begin_mdns(hostName.c_str()); }
void MDNSResponder::setInstanceName(const String& name) {
#else
bool MDNSResponder::begin(const char* hostName) { return begin_mdns(hostName); }
void MDNSResponder::setInstanceName(String name) {
#endif
  const Lock lock(guard);
  settings.instance = name.c_str();
}

bool MDNSResponder::addService(const char* service_name, const char* proto, uint16_t port) {
  const Lock lock(guard);
  if (!has_mdns) return false;
  settings.service = "_" + std::string(service_name) + "._" + proto + " " + std::to_string(port);
  return true;
}

void MDNSResponder::end() {
  const Lock lock(guard);
  has_mdns = false;
  settings.host = settings.instance = settings.service = "";
}

extern "C" {

void esp_log_level_set(const char* tag, esp_log_level_t level) {
  expect(strcmp(tag, "*") == 0, "the log of one library alone");
  log_level = level;
}

int lwip_accept(int s, struct sockaddr* addr, socklen_t* addrlen) {
  const int connection = accept(s, addr, addrlen);
  if (connection < 0) return connection;
  if (sockets == kMaxSockets) {  // it is taken from those that wait, and gone
    close(connection);
    errno = ENFILE;
    return -1;
  }
  sockets++;
  return connection;
}

// On 127.0.0.1, at a port that is free: many robots are on one computer.
int lwip_bind(int s, const struct sockaddr*, socklen_t) {
  sockaddr_in place = {};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof place;
  if (bind(s, reinterpret_cast<sockaddr*>(&place), length) != 0) return -1;
  if (getsockname(s, reinterpret_cast<sockaddr*>(&place), &length) != 0) return -1;
  const Lock lock(guard);
  bound_port = ntohs(place.sin_port);
  bound_socket = s;
  return 0;
}

int lwip_close(int s) {
  const Lock lock(guard);
  sockets--;
  if (s == bound_socket) {
    bound_port = 0;
    bound_socket = -1;
  }
  expect(close(s) == 0, "a socket that is closed twice");
  return 0;
}
int lwip_connect(int s, const struct sockaddr* name, socklen_t namelen) {
  return connect(s, name, namelen);
}
int lwip_fcntl(int s, int cmd, int val) { return fcntl(s, cmd, val); }
struct hostent* lwip_gethostbyname(const char* name) {
  static in_addr address;  // of one task alone, as with lwIP
  static char* list[] = {reinterpret_cast<char*>(&address), nullptr};
  static hostent host = {nullptr, nullptr, AF_INET, sizeof address, list};
  uint16_t wait_ms;
  {
    const Lock lock(guard);
    const auto wait = waits_ms.find(name);
    wait_ms = wait == waits_ms.end() ? 0 : wait->second;
  }
  if (wait_ms != 0) vTaskDelay(wait_ms);
  const Lock lock(guard);
  const auto entry = addresses.find(name);
  if (entry == addresses.end() || inet_aton(entry->second.c_str(), &address) == 0) return nullptr;
  return &host;
}
int lwip_listen(int s, int backlog) { return listen(s, backlog); }
ssize_t lwip_recv(int s, void* mem, size_t len, int flags) { return recv(s, mem, len, flags); }
ssize_t lwip_send(int s, const void* dataptr, size_t size, int flags) {
  const size_t byte_limit = send_limit;
  if (byte_limit == 0) {
    errno = EWOULDBLOCK;
    return -1;
  }
  return send(s, dataptr, size < byte_limit ? size : byte_limit, flags | MSG_NOSIGNAL);
}
int lwip_setsockopt(int s, int level, int optname, const void* optval, socklen_t optlen) {
  return setsockopt(s, level, optname, optval, optlen);
}
int lwip_socket(int domain, int type, int protocol) {
  expect(has_network_stack, "the network before WiFi has begun");
  if (sockets == kMaxSockets) {
    errno = ENFILE;
    return -1;
  }
  sockets++;
  return socket(domain, type, protocol);
}

}  // extern "C"
