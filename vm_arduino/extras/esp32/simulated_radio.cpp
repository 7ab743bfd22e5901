#include "simulated_radio.h"

#include <BLE2902.h>
#include <BLEServer.h>
#include <BluetoothSerial.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <arpa/inet.h>
#include <freertos/task.h>
#include <lwip/netdb.h>
#include <lwip/sockets.h>
#include <string.h>
#include <unistd.h>

#include <deque>
#include <map>
#include <mutex>

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
size_t made;
BLEServerCallbacks* on_client;
BLECharacteristicCallbacks* on_write;
std::string written;
std::string value;
bool is_advertising;
bool is_connected;
bool has_subscribed;
std::vector<std::string> notified;

// the serial port
bool has_port_client;
std::deque<uint8_t> port_in;
std::string port_out;

// WiFi
wifi_mode_t wifi_mode = WIFI_OFF;
std::string near_name;
std::string near_password;
uint16_t bound_port;
std::map<std::string, std::string> addresses = {{"localhost", "127.0.0.1"}};
std::map<std::string, uint16_t> waits_ms;  // until a name is looked up

}  // namespace

// -- who is on the other side -------------------------------------------------------------------

void low_energy_connect() {
  BLEServerCallbacks* told;
  {
    const Lock lock(guard);
    if (!is_advertising) return;
    is_advertising = false;
    is_connected = true;
    has_subscribed = false;
    told = on_client;
  }
  told->onConnect(&server);
}

void low_energy_disconnect() {
  BLEServerCallbacks* told;
  {
    const Lock lock(guard);
    if (!is_connected) return;
    is_connected = false;
    told = on_client;
  }
  told->onDisconnect(&server);
}

void low_energy_agree(uint16_t mtu) {
  {
    const Lock lock(guard);
    if (!is_connected) return;
  }
  esp_ble_gatts_cb_param_t its = {};
  its.mtu.mtu = mtu;
  on_client->onMtuChanged(&server, &its);
}

void low_energy_subscribe(bool has) {
  const Lock lock(guard);
  has_subscribed = has;
}

void low_energy_write(const std::string& bytes) {
  {
    const Lock lock(guard);
    if (!is_connected) return;
  }
  written = bytes;  // of the core's task alone
  on_write->onWrite(&characteristics[1]);
}

std::vector<std::string> low_energy_notified() {
  const Lock lock(guard);
  std::vector<std::string> found;
  found.swap(notified);
  return found;
}

void serial_port_connect(bool is_there) {
  const Lock lock(guard);
  has_port_client = is_there;
}

void serial_port_write(const std::string& bytes) {
  const Lock lock(guard);
  port_in.insert(port_in.end(), bytes.begin(), bytes.end());
}

std::string serial_port_said() {
  const Lock lock(guard);
  std::string found;
  found.swap(port_out);
  return found;
}

void network_in_reach(const std::string& name, const std::string& password) {
  const Lock lock(guard);
  near_name = name;
  near_password = password;
}

void network_name(const std::string& name, const std::string& address, uint16_t wait_ms) {
  const Lock lock(guard);
  addresses[name] = address;
  waits_ms[name] = wait_ms;
}

uint16_t network_port() {
  const Lock lock(guard);
  return bound_port;
}

RadioSettings radio_settings() {
  const Lock lock(guard);
  return settings;
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
  const Lock lock(guard);
  settings.serial_port = localName.c_str();
  return true;
}

int BluetoothSerial::available() {
  const Lock lock(guard);
  return static_cast<int>(port_in.size());
}

bool BluetoothSerial::hasClient() {
  const Lock lock(guard);
  return has_port_client;
}

int BluetoothSerial::read() {
  const Lock lock(guard);
  if (port_in.empty()) return -1;
  const uint8_t byte = port_in.front();
  port_in.pop_front();
  return byte;
}

size_t BluetoothSerial::write(const uint8_t* buffer, size_t size) {
  const Lock lock(guard);
  port_out.append(reinterpret_cast<const char*>(buffer), size);
  return size;
}

void BLECharacteristicCallbacks::onWrite(BLECharacteristic*) {}
void BLEServerCallbacks::onConnect(BLEServer*) {}
void BLEServerCallbacks::onDisconnect(BLEServer*) {}
void BLEServerCallbacks::onMtuChanged(BLEServer*, esp_ble_gatts_cb_param_t*) {}

bool BLE2902::getNotifications() {
  const Lock lock(guard);
  return has_subscribed;
}

void BLECharacteristic::addDescriptor(BLEDescriptor*) {}
uint8_t* BLECharacteristic::getData() { return reinterpret_cast<uint8_t*>(&written[0]); }
size_t BLECharacteristic::getLength() { return written.size(); }
void BLECharacteristic::setCallbacks(BLECharacteristicCallbacks* pCallbacks) {
  const Lock lock(guard);
  on_write = pCallbacks;
}
void BLECharacteristic::setValue(uint8_t* data, size_t size) {
  value.assign(reinterpret_cast<const char*>(data), size);  // of the radio's task alone
}
void BLECharacteristic::notify(bool) {
  const Lock lock(guard);
  if (is_connected && has_subscribed) notified.push_back(value);
}

BLECharacteristic* BLEService::createCharacteristic(const char*, uint32_t) {
  return &characteristics[made++];
}
void BLEService::start() {}

BLEService* BLEServer::createService(const char*) { return &service; }
void BLEServer::setCallbacks(BLEServerCallbacks* pCallbacks) {
  const Lock lock(guard);
  on_client = pCallbacks;
}

void BLEAdvertising::addServiceUUID(const char*) {}
void BLEAdvertising::setScanResponse(bool) {}

BLEServer* BLEDevice::createServer() { return &server; }
BLEAdvertising* BLEDevice::getAdvertising() { return &advertising; }
void BLEDevice::init(BleText deviceName) {
  const Lock lock(guard);
  settings.advertised = deviceName.c_str();
}
esp_err_t BLEDevice::setMTU(uint16_t) { return ESP_OK; }
void BLEDevice::startAdvertising() {
  const Lock lock(guard);
  is_advertising = true;
}

IPAddress::IPAddress(uint8_t first, uint8_t second, uint8_t third, uint8_t fourth)
    : bytes_{first, second, third, fourth} {}
uint8_t IPAddress::operator[](int index) const { return bytes_[index]; }

wl_status_t WiFiClass::begin(const char* ssid, const char* passphrase, int32_t, const uint8_t*,
                             bool) {
  const Lock lock(guard);
  settings.network = ssid;
  settings.password = passphrase;
  settings.is_access_point = false;
  settings.joins++;
  return WL_DISCONNECTED;
}

wl_status_t WiFiClass::status() {
  const Lock lock(guard);
  if (wifi_mode != WIFI_STA) return WL_NO_SHIELD;
  if (near_name.empty() || near_name != settings.network) return WL_NO_SSID_AVAIL;
  return near_password == settings.password ? WL_CONNECTED : WL_CONNECT_FAILED;
}

bool WiFiClass::softAP(const char* ssid, const char* passphrase, int, int, int, bool) {
  const Lock lock(guard);
  settings.network = ssid;
  settings.password = passphrase;
  settings.is_access_point = true;
  return true;
}

bool WiFiClass::mode(wifi_mode_t m) {
  const Lock lock(guard);
  wifi_mode = m;
  if (m == WIFI_OFF) settings.network = settings.password = "";
  return true;
}

bool WiFiClass::disconnect(bool, bool) { return true; }
bool WiFiClass::softAPdisconnect(bool) { return true; }
void WiFiClass::persistent(bool) {}
bool WiFiClass::setHostname(const char*) { return true; }
bool WiFiClass::setSleep(bool) { return true; }
IPAddress WiFiClass::localIP() { return IPAddress(127, 0, 0, 1); }
IPAddress WiFiClass::softAPIP() { return IPAddress(192, 168, 4, 1); }

#if ESP_ARDUINO_VERSION_MAJOR >= 3
bool MDNSResponder::begin(const String& hostName) {
  const Lock lock(guard);
  settings.host = hostName.c_str();
  return true;
}
void MDNSResponder::setInstanceName(const String& name) {
#else
bool MDNSResponder::begin(const char* hostName) {
  const Lock lock(guard);
  settings.host = hostName;
  return true;
}
void MDNSResponder::setInstanceName(String name) {
#endif
  const Lock lock(guard);
  settings.instance = name.c_str();
}

bool MDNSResponder::addService(const char* service_name, const char* proto, uint16_t port) {
  const Lock lock(guard);
  settings.service = "_" + std::string(service_name) + "._" + proto + " " + std::to_string(port);
  return true;
}

void MDNSResponder::end() {
  const Lock lock(guard);
  settings.service = "";
}

extern "C" {

int lwip_accept(int s, struct sockaddr* addr, socklen_t* addrlen) {
  return accept(s, addr, addrlen);
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
  return 0;
}

int lwip_close(int s) { return close(s); }
int lwip_connect(int s, const struct sockaddr* name, socklen_t namelen) {
  return connect(s, name, namelen);
}
int lwip_fcntl(int s, int cmd, int val) { return fcntl(s, cmd, val); }
struct hostent* lwip_gethostbyname(const char* name) {
  static in_addr address;  // of one task alone, as with lwIP
  static char* list[] = {reinterpret_cast<char*>(&address), nullptr};
  static hostent found = {nullptr, nullptr, AF_INET, sizeof address, list};
  uint16_t wait_ms;
  {
    const Lock lock(guard);
    const auto wait = waits_ms.find(name);
    wait_ms = wait == waits_ms.end() ? 0 : wait->second;
  }
  if (wait_ms != 0) vTaskDelay(wait_ms);
  const Lock lock(guard);
  const auto known = addresses.find(name);
  if (known == addresses.end() || inet_aton(known->second.c_str(), &address) == 0) return nullptr;
  return &found;
}
int lwip_listen(int s, int backlog) { return listen(s, backlog); }
ssize_t lwip_recv(int s, void* mem, size_t len, int flags) { return recv(s, mem, len, flags); }
ssize_t lwip_send(int s, const void* dataptr, size_t size, int flags) {
  return send(s, dataptr, size, flags | MSG_NOSIGNAL);
}
int lwip_setsockopt(int s, int level, int optname, const void* optval, socklen_t optlen) {
  return setsockopt(s, level, optname, optval, optlen);
}
int lwip_socket(int domain, int type, int protocol) { return socket(domain, type, protocol); }

}  // extern "C"
