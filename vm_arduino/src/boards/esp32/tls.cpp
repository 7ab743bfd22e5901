// The robot has no clock. A computer sends the date when it sets the broker, so a certificate that
// has expired by then is refused; a later expiry is not noticed.

#ifdef ARDUINO_ARCH_ESP32

#include "tls.h"

#include <esp_random.h>
#include <mbedtls/ssl.h>
#include <mbedtls/version.h>
#include <mbedtls/x509_crt.h>

#include "sockets.h"

namespace tiniscript {

namespace {

mbedtls_ssl_context connection;
mbedtls_ssl_config config;
mbedtls_x509_crt trusted_certificate;
uint32_t today;
uint32_t flaws;  // of the certificates that came
int tls_socket;
bool has_begun;

int fill(void*, unsigned char* bytes, size_t length) {
  uint32_t random = 0;
  for (size_t k = 0; k < length; k++) {
    if (k % 4 == 0) random = esp_random();
    bytes[k] = static_cast<unsigned char>(random >> (8 * (k % 4)));
  }
  return 0;
}

int send(void*, const unsigned char* bytes, size_t length) {
  const ssize_t sent_length = lwip_send(tls_socket, bytes, length, MSG_DONTWAIT);
  if (sent_length >= 0) return static_cast<int>(sent_length);
  return may_come_later() ? MBEDTLS_ERR_SSL_WANT_WRITE : MBEDTLS_ERR_SSL_CONN_EOF;
}

int receive(void*, unsigned char* bytes, size_t room) {
  const ssize_t length = lwip_recv(tls_socket, bytes, room, MSG_DONTWAIT);
  if (length > 0) return static_cast<int>(length);
  return length < 0 && may_come_later() ? MBEDTLS_ERR_SSL_WANT_READ : MBEDTLS_ERR_SSL_CONN_EOF;
}

bool is_trusted_certificate(const mbedtls_x509_crt& certificate) {
  const mbedtls_x509_buf& raw = certificate.raw;
  return raw.len == trusted_certificate.raw.len &&
         __builtin_memcmp(raw.p, trusted_certificate.raw.p, raw.len) == 0;
}

// Each certificate of the way to the trusted one, the broker's own at last, with which all of them
// are judged. mbedTLS trusts a certificate by itself only if it has signed itself: who trusts the
// broker's own asks for its name and its date alone. The core's own look at dates needs a clock.
int judge_certificate(void*, mbedtls_x509_crt* certificate, int depth, uint32_t* flags) {
  const mbedtls_x509_time& end = certificate->valid_to;
  const uint32_t expiry_date = static_cast<uint32_t>((end.year * 100 + end.mon) * 100 + end.day);
  uint32_t certificate_flags = *flags;
  certificate_flags &=
      ~static_cast<uint32_t>(MBEDTLS_X509_BADCERT_EXPIRED | MBEDTLS_X509_BADCERT_FUTURE);
  if (expiry_date < today) certificate_flags |= MBEDTLS_X509_BADCERT_EXPIRED;
  *flags = 0;
  flaws |= certificate_flags;
  if (depth != 0) return 0;
  if (is_trusted_certificate(*certificate)) {
    flaws = certificate_flags & ~static_cast<uint32_t>(MBEDTLS_X509_BADCERT_NOT_TRUSTED);
  }
  *flags = flaws;
  return 0;
}

WifiState failure() {
  if (flaws == 0) return WifiState::kNoTls;
  if ((flaws & MBEDTLS_X509_BADCERT_NOT_TRUSTED) != 0) return WifiState::kUntrusted;
  if ((flaws & MBEDTLS_X509_BADCERT_CN_MISMATCH) != 0) return WifiState::kOtherName;
  if ((flaws & MBEDTLS_X509_BADCERT_EXPIRED) != 0) return WifiState::kExpired;
  return WifiState::kUntrusted;
}

bool may_retry(int result) {
  return result == MBEDTLS_ERR_SSL_WANT_READ || result == MBEDTLS_ERR_SSL_WANT_WRITE;
}

// mbedTLS 2 would speak TLS 1.0.
void refuse_old_versions() {
#if MBEDTLS_VERSION_NUMBER >= 0x03020000
  mbedtls_ssl_conf_min_tls_version(&config, MBEDTLS_SSL_VERSION_TLS1_2);
#else
  mbedtls_ssl_conf_min_version(&config, MBEDTLS_SSL_MAJOR_VERSION_3, MBEDTLS_SSL_MINOR_VERSION_3);
#endif
}

bool is_handshake_over() {
#if MBEDTLS_VERSION_NUMBER >= 0x03020000
  return mbedtls_ssl_is_handshake_over(&connection) != 0;
#else
  return connection.state == MBEDTLS_SSL_HANDSHAKE_OVER;
#endif
}

int byte_count(int result) {
  if (may_retry(result)) return kNothingYet;
  return result > 0 ? result : kEnded;
}

}  // namespace

WifiState tls_begin(int socket, const BrokerSettings& settings) {
  tls_socket = socket;
  today = settings.date;
  flaws = 0;
  has_begun = true;
  mbedtls_ssl_init(&connection);
  mbedtls_ssl_config_init(&config);
  mbedtls_x509_crt_init(&trusted_certificate);
  const int parse_status =
      mbedtls_x509_crt_parse_der(&trusted_certificate, settings.trust, settings.trust_bytes);
  if (parse_status != 0) {
    const bool is_memory = parse_status == MBEDTLS_ERR_X509_ALLOC_FAILED;
    return is_memory ? WifiState::kNoTls : WifiState::kUntrusted;
  }
  if (mbedtls_ssl_config_defaults(&config, MBEDTLS_SSL_IS_CLIENT, MBEDTLS_SSL_TRANSPORT_STREAM,
                                  MBEDTLS_SSL_PRESET_DEFAULT) != 0) {
    return WifiState::kNoTls;
  }
  refuse_old_versions();
  mbedtls_ssl_conf_authmode(&config, MBEDTLS_SSL_VERIFY_REQUIRED);
  mbedtls_ssl_conf_ca_chain(&config, &trusted_certificate, nullptr);
  mbedtls_ssl_conf_verify(&config, judge_certificate, nullptr);
  mbedtls_ssl_conf_rng(&config, fill, nullptr);
  if (mbedtls_ssl_setup(&connection, &config) != 0 ||
      mbedtls_ssl_set_hostname(&connection, settings.name) != 0) {
    return WifiState::kNoTls;
  }
  mbedtls_ssl_set_bio(&connection, nullptr, send, receive, nullptr);
  return WifiState::kSearching;
}

WifiState tls_shake() {
  const int result = mbedtls_ssl_handshake_step(&connection);
  if (result != 0) return may_retry(result) ? WifiState::kSearching : failure();
  return is_handshake_over() ? WifiState::kReady : WifiState::kSearching;
}

int tls_receive(uint8_t* bytes, size_t room) {
  return byte_count(mbedtls_ssl_read(&connection, bytes, room));
}

int tls_send(const uint8_t* bytes, size_t length) {
  return byte_count(mbedtls_ssl_write(&connection, bytes, length));
}

void tls_end() {
  if (!has_begun) return;
  has_begun = false;
  mbedtls_ssl_free(&connection);
  mbedtls_ssl_config_free(&config);
  mbedtls_x509_crt_free(&trusted_certificate);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
