// Pins the signatures that the firmware relies on to those of the real cores.
//
// Compiled with the stand-ins in `core/` for versions 2 and 3, and with the real headers where they
// are: `pio run` with `build_src_filter = +<../extras/esp32/signatures.cpp>`.

#include <Arduino.h>
#include <BLE2902.h>
#include <BLEDevice.h>
#include <BLEServer.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <driver/gpio.h>
#ifdef CONFIG_IDF_TARGET_ESP32
#include <driver/pcnt.h>
#endif
#include <driver/uart.h>
#include <esp_log.h>
#include <esp_rom_gpio.h>
#include <esp_system.h>
#include <esp_task_wdt.h>
#include <esp_timer.h>
#include <freertos/task.h>
#include <lwip/netdb.h>
#include <lwip/sockets.h>
#include <mbedtls/ssl.h>
#include <mbedtls/version.h>
#include <mbedtls/x509_crt.h>
#include <nvs.h>
#include <soc/gpio_reg.h>
#include <soc/gpio_sig_map.h>
#include <soc/soc.h>
#include <soc/uart_reg.h>

#include <type_traits>
#include <utility>
#ifdef CONFIG_BT_SPP_ENABLED
#include <BluetoothSerial.h>
#endif

#define is_a(what, ...) static_assert(std::is_same<decltype(what), __VA_ARGS__>::value, #what)

#if ESP_ARDUINO_VERSION_MAJOR >= 3
// cores/esp32/esp32-hal-ledc.h of 3.0.4: the first argument is the pin
is_a(&ledcWrite, bool (*)(uint8_t, uint32_t));
is_a(&ledcWriteTone, uint32_t (*)(uint8_t, uint32_t));
is_a(&ledcChangeFrequency, uint32_t (*)(uint8_t, uint32_t, uint8_t));
is_a(ledcAttachChannel(uint8_t{}, uint32_t{}, uint8_t{}, 0), bool);
// cores/esp32/esp32-hal.h of 3.0.4
is_a(&set_arduino_panic_handler, void (*)(arduino_panic_handler_t, void*));
is_a(static_cast<arduino_panic_handler_t>(nullptr), void (*)(arduino_panic_info_t*, void*));
// components/esp_system/include/esp_task_wdt.h of ESP-IDF 5.1
is_a(&esp_task_wdt_init, esp_err_t (*)(const esp_task_wdt_config_t*));
is_a(&esp_task_wdt_reconfigure, esp_err_t (*)(const esp_task_wdt_config_t*));
#else
#undef ledcAttachPin
// cores/esp32/esp32-hal-ledc.h of 2.0.17: the first argument is the channel
is_a(&ledcSetup, uint32_t (*)(uint8_t, uint32_t, uint8_t));
is_a(&ledcAttachPin, void (*)(uint8_t, uint8_t));
is_a(&ledcWrite, void (*)(uint8_t, uint32_t));
is_a(&ledcWriteTone, uint32_t (*)(uint8_t, uint32_t));
// components/esp_system/include/esp_task_wdt.h of ESP-IDF 4.4
is_a(&esp_task_wdt_init, esp_err_t (*)(uint32_t, bool));
is_a(&esp_task_wdt_delete, esp_err_t (*)(TaskHandle_t));
is_a(xTaskGetIdleTaskHandleForCPU(0), TaskHandle_t);
#endif

// cores/esp32/esp32-hal-gpio.h and esp32-hal-adc.h, of both versions
#undef analogRead
is_a(&pinMode, void (*)(uint8_t, uint8_t));
is_a(&attachInterrupt, void (*)(uint8_t, void (*)(void), int));
is_a(&analogRead, uint16_t (*)(uint8_t));
is_a(&analogReadResolution, void (*)(uint8_t));
// cores/esp32/esp32-hal.h
is_a(&millis, unsigned long (*)());
is_a(&micros, unsigned long (*)());
// cores/esp32/Esp.h
is_a(ESP.getEfuseMac(), uint64_t);
// cores/esp32/HardwareSerial.h
is_a(&HardwareSerial::onReceiveError, void (HardwareSerial::*)(OnReceiveErrorCb));
is_a(&HardwareSerial::setRxBufferSize, size_t (HardwareSerial::*)(size_t));
is_a(&HardwareSerial::setTxBufferSize, size_t (HardwareSerial::*)(size_t));
is_a(Serial.available(), int);
is_a(Serial.availableForWrite(), int);
is_a(Serial.read(), int);
is_a(Serial.write(uint8_t{}), size_t);

// ESP-IDF 4.4 and 5.1: driver/gpio.h, esp_rom_gpio.h, esp_system.h, esp_timer.h, nvs.h
is_a(GPIO_OUT_W1TS_REG + GPIO_OUT_W1TC_REG + GPIO_FUNC0_OUT_SEL_CFG_REG > 0, bool);
is_a(&gpio_get_level, int (*)(gpio_num_t));
is_a(&uart_enable_intr_mask, esp_err_t (*)(uart_port_t, uint32_t));
static_assert(UART_NUM_0 == 0 && UART_FRM_ERR_INT_ENA == 1 << 3, "an interrupt of a UART");
#ifdef CONFIG_IDF_TARGET_ESP32
// driver/pcnt.h, in 5.1 below deprecated
is_a(&pcnt_unit_config, esp_err_t (*)(const pcnt_config_t*));
is_a(&pcnt_get_counter_value, esp_err_t (*)(pcnt_unit_t, int16_t*));
is_a(&pcnt_counter_clear, esp_err_t (*)(pcnt_unit_t));
is_a(&pcnt_counter_resume, esp_err_t (*)(pcnt_unit_t));
is_a(&pcnt_set_filter_value, esp_err_t (*)(pcnt_unit_t, uint16_t));
is_a(&pcnt_filter_enable, esp_err_t (*)(pcnt_unit_t));
is_a(pcnt_config_t{}.pulse_gpio_num, int);
is_a(pcnt_config_t{}.counter_h_lim, int16_t);
static_assert(PCNT_PIN_NOT_USED == -1 && PCNT_UNIT_1 == 1 && PCNT_CHANNEL_0 == 0, "numbers");
#endif
is_a(&gpio_intr_enable, esp_err_t (*)(gpio_num_t));
is_a(&gpio_intr_disable, esp_err_t (*)(gpio_num_t));
is_a(&esp_rom_gpio_connect_out_signal, void (*)(uint32_t, uint32_t, bool, bool));
is_a(&esp_log_level_set, void (*)(const char*, esp_log_level_t));
static_assert(ESP_LOG_NONE == 0, "numbers");
is_a(&esp_reset_reason, esp_reset_reason_t (*)());
is_a(&esp_task_wdt_reset, esp_err_t (*)());
is_a(&esp_timer_create, esp_err_t (*)(const esp_timer_create_args_t*, esp_timer_handle_t*));
is_a(&esp_timer_start_periodic, esp_err_t (*)(esp_timer_handle_t, uint64_t));
is_a(&nvs_get_u32, esp_err_t (*)(nvs_handle_t, const char*, uint32_t*));
is_a(&nvs_set_u32, esp_err_t (*)(nvs_handle_t, const char*, uint32_t));
is_a(&nvs_get_blob, esp_err_t (*)(nvs_handle_t, const char*, void*, size_t*));
is_a(&nvs_set_blob, esp_err_t (*)(nvs_handle_t, const char*, const void*, size_t));
is_a(&nvs_commit, esp_err_t (*)(nvs_handle_t));
is_a(&nvs_close, void (*)(nvs_handle_t));
is_a(&nvs_open, esp_err_t (*)(const char*, nvs_open_mode_t, nvs_handle_t*));

static_assert(SIG_GPIO_OUT_IDX == 256 || SIG_GPIO_OUT_IDX == 128, "an ESP32, or an ESP32-C3");

// libraries/BLE/src of 2.0.17 and 3.0.4, as called
is_a(&BLECharacteristic::getData, uint8_t* (BLECharacteristic::*)());
is_a(&BLECharacteristic::getLength, size_t (BLECharacteristic::*)());
is_a(&BLECharacteristic::getHandle, uint16_t (BLECharacteristic::*)());
is_a(&BLEDescriptor::getHandle, uint16_t (BLEDescriptor::*)());
is_a(std::declval<BLEServer&>().createService(""), BLEService*);
is_a(std::declval<BLEService&>().createCharacteristic("", uint32_t{}), BLECharacteristic*);
is_a(&BLEDevice::createServer, BLEServer* (*)());
is_a(&BLEDevice::getAdvertising, BLEAdvertising* (*)());
is_a(&BLEDevice::setMTU, esp_err_t (*)(uint16_t));
is_a(BLEDevice::init(""), void);
is_a(&BLEDevice::startAdvertising, void (*)());
is_a(&BLEDevice::setCustomGattsHandler, void (*)(gatts_event_handler));
is_a(static_cast<gatts_event_handler>(nullptr),
     void (*)(esp_gatts_cb_event_t, esp_gatt_if_t, esp_ble_gatts_cb_param_t*));
is_a(&esp_ble_gatts_send_indicate,
     esp_err_t (*)(esp_gatt_if_t, uint16_t, uint16_t, uint16_t, uint8_t*, bool));
is_a(std::declval<BLECharacteristicCallbacks&>().onWrite(
         nullptr, static_cast<esp_ble_gatts_cb_param_t*>(nullptr)),
     void);
is_a(&BLEServer::disconnect, void (BLEServer::*)(uint16_t));
is_a(esp_ble_gatts_cb_param_t().write.conn_id, uint16_t);
is_a(esp_ble_gatts_cb_param_t().write.handle, uint16_t);
is_a(esp_ble_gatts_cb_param_t().write.len, uint16_t);
is_a(esp_ble_gatts_cb_param_t().write.value, uint8_t*);
is_a(esp_ble_gatts_cb_param_t().mtu.conn_id, uint16_t);
is_a(esp_ble_gatts_cb_param_t().mtu.mtu, uint16_t);
is_a(esp_ble_gatts_cb_param_t().connect.conn_id, uint16_t);
is_a(esp_ble_gatts_cb_param_t().disconnect.conn_id, uint16_t);
static_assert(ESP_GATTS_WRITE_EVT == 2 && ESP_GATTS_MTU_EVT == 4, "numbers");
static_assert(ESP_GATTS_CONNECT_EVT == 14 && ESP_GATTS_DISCONNECT_EVT == 15, "numbers");

#ifdef CONFIG_BT_SPP_ENABLED
// libraries/BluetoothSerial/src
is_a(std::declval<BluetoothSerial&>().begin(""), bool);
is_a(&BluetoothSerial::hasClient, bool (BluetoothSerial::*)());
is_a(std::declval<BluetoothSerial&>().register_callback(
         std::declval<void (&)(esp_spp_cb_event_t, esp_spp_cb_param_t*)>()),
     esp_err_t);
is_a(std::declval<BluetoothSerial&>().onData(std::declval<void (&)(const uint8_t*, size_t)>()),
     void);
is_a(esp_spp_cb_param_t().srv_open.status, esp_spp_status_t);
is_a(esp_spp_cb_param_t().srv_open.handle, uint32_t);
is_a(&esp_spp_disconnect, esp_err_t (*)(uint32_t));
is_a(std::declval<BluetoothSerial&>().write(std::declval<const uint8_t*>(), size_t{}), size_t);
#endif

// libraries/WiFi/src and libraries/ESPmDNS/src, as called
is_a(WiFi.begin("", ""), wl_status_t);
is_a(arduino_event_t().event_info.wifi_sta_disconnected.reason, uint8_t);
is_a(WiFi.localIP(), IPAddress);
is_a(WiFi.mode(WIFI_STA), bool);
is_a(WiFi.reconnect(), bool);
is_a(WiFi.setAutoReconnect(false), bool);
is_a(WiFi.setHostname(""), bool);
is_a(WiFi.softAP("", ""), bool);
is_a(WiFi.softAPIP(), IPAddress);
is_a(WiFi.status(), wl_status_t);
is_a(MDNS.begin(""), bool);
is_a(MDNS.addService("", "", uint16_t{}), bool);

// components/lwip/lwip/src/include/lwip/sockets.h, and FreeRTOS
is_a(&lwip_accept, int (*)(int, sockaddr*, socklen_t*));
is_a(&lwip_bind, int (*)(int, const sockaddr*, socklen_t));
is_a(&lwip_close, int (*)(int));
is_a(&lwip_connect, int (*)(int, const sockaddr*, socklen_t));
is_a(&lwip_fcntl, int (*)(int, int, int));
is_a(&lwip_listen, int (*)(int, int));
is_a(&lwip_recv, ssize_t (*)(int, void*, size_t, int));
is_a(&lwip_send, ssize_t (*)(int, const void*, size_t, int));
is_a(&lwip_setsockopt, int (*)(int, int, int, const void*, socklen_t));
is_a(&lwip_socket, int (*)(int, int, int));
is_a(&lwip_gethostbyname, hostent* (*)(const char*));
is_a(xTaskCreatePinnedToCore(nullptr, "", 0, nullptr, 0, nullptr, 0), BaseType_t);

// components/mbedtls/mbedtls/include/mbedtls of 2.28 and 3.5, as called
typedef int Look(void*, mbedtls_x509_crt*, int, uint32_t*);
typedef int Fill(void*, unsigned char*, size_t);
is_a(&mbedtls_ssl_init, void (*)(mbedtls_ssl_context*));
is_a(&mbedtls_ssl_free, void (*)(mbedtls_ssl_context*));
is_a(&mbedtls_ssl_setup, int (*)(mbedtls_ssl_context*, const mbedtls_ssl_config*));
is_a(&mbedtls_ssl_set_hostname, int (*)(mbedtls_ssl_context*, const char*));
is_a(&mbedtls_ssl_set_bio, void (*)(mbedtls_ssl_context*, void*, mbedtls_ssl_send_t*,
                                    mbedtls_ssl_recv_t*, mbedtls_ssl_recv_timeout_t*));
is_a(static_cast<mbedtls_ssl_send_t*>(nullptr), int (*)(void*, const unsigned char*, size_t));
is_a(static_cast<mbedtls_ssl_recv_t*>(nullptr), int (*)(void*, unsigned char*, size_t));
is_a(&mbedtls_ssl_handshake_step, int (*)(mbedtls_ssl_context*));
#if MBEDTLS_VERSION_NUMBER >= 0x03020000
is_a(mbedtls_ssl_is_handshake_over(nullptr), int);
is_a(&mbedtls_ssl_conf_min_tls_version,
     void (*)(mbedtls_ssl_config*, mbedtls_ssl_protocol_version));
#else
is_a(mbedtls_ssl_context::state, int);
is_a(&mbedtls_ssl_conf_min_version, void (*)(mbedtls_ssl_config*, int, int));
static_assert(MBEDTLS_SSL_MAJOR_VERSION_3 == 3 && MBEDTLS_SSL_MINOR_VERSION_3 == 3, "TLS 1.2");
#endif
is_a(&mbedtls_ssl_read, int (*)(mbedtls_ssl_context*, unsigned char*, size_t));
is_a(&mbedtls_ssl_write, int (*)(mbedtls_ssl_context*, const unsigned char*, size_t));
is_a(&mbedtls_ssl_config_init, void (*)(mbedtls_ssl_config*));
is_a(&mbedtls_ssl_config_free, void (*)(mbedtls_ssl_config*));
is_a(&mbedtls_ssl_config_defaults, int (*)(mbedtls_ssl_config*, int, int, int));
is_a(&mbedtls_ssl_conf_authmode, void (*)(mbedtls_ssl_config*, int));
is_a(&mbedtls_ssl_conf_ca_chain,
     void (*)(mbedtls_ssl_config*, mbedtls_x509_crt*, mbedtls_x509_crl*));
is_a(&mbedtls_ssl_conf_verify, void (*)(mbedtls_ssl_config*, Look*, void*));
is_a(&mbedtls_ssl_conf_rng, void (*)(mbedtls_ssl_config*, Fill*, void*));
is_a(&mbedtls_x509_crt_init, void (*)(mbedtls_x509_crt*));
is_a(&mbedtls_x509_crt_free, void (*)(mbedtls_x509_crt*));
is_a(&mbedtls_x509_crt_parse_der, int (*)(mbedtls_x509_crt*, const unsigned char*, size_t));
is_a(mbedtls_x509_crt::valid_to, mbedtls_x509_time);
is_a(mbedtls_x509_time::year, int);
is_a(mbedtls_x509_crt::raw, mbedtls_x509_buf);
is_a(mbedtls_x509_buf::len, size_t);
is_a(mbedtls_x509_buf::p, unsigned char*);
static_assert(MBEDTLS_ERR_SSL_WANT_READ == -0x6900 && MBEDTLS_ERR_SSL_WANT_WRITE == -0x6880 &&
                  MBEDTLS_ERR_SSL_CONN_EOF == -0x7280 && MBEDTLS_X509_BADCERT_EXPIRED == 1 &&
                  MBEDTLS_X509_BADCERT_CN_MISMATCH == 4 && MBEDTLS_X509_BADCERT_NOT_TRUSTED == 8 &&
                  MBEDTLS_X509_BADCERT_FUTURE == 0x200 && MBEDTLS_ERR_X509_ALLOC_FAILED == -0x2880,
              "numbers of mbedTLS");
