// Stands for components/mbedtls/mbedtls/include/mbedtls/ssl.h of ESP-IDF 4.4 (mbedTLS 2.28) and
// 5.1 (3.5). Where this computer has mbedTLS itself, that is what compiles and runs.

#pragma once

#if __STDC_HOSTED__ && __has_include_next(<mbedtls/ssl.h>)
#include_next <mbedtls/ssl.h>
#else

#include <mbedtls/version.h>
#include <mbedtls/x509_crt.h>

#define MBEDTLS_ERR_SSL_WANT_READ -0x6900
#define MBEDTLS_ERR_SSL_WANT_WRITE -0x6880
#define MBEDTLS_ERR_SSL_CONN_EOF -0x7280
#define MBEDTLS_SSL_IS_CLIENT 0
#if MBEDTLS_VERSION_NUMBER < 0x03020000
#define MBEDTLS_SSL_MAJOR_VERSION_3 3
#define MBEDTLS_SSL_MINOR_VERSION_3 3
#endif
#define MBEDTLS_SSL_TRANSPORT_STREAM 0
#define MBEDTLS_SSL_PRESET_DEFAULT 0
#define MBEDTLS_SSL_VERIFY_REQUIRED 2

typedef enum { MBEDTLS_SSL_HANDSHAKE_OVER = 16 } mbedtls_ssl_states;  // 27 in version 3

typedef struct mbedtls_ssl_context {
  int state;  // since version 3 after mbedtls_ssl_is_handshake_over
  void* inner[96];
} mbedtls_ssl_context;
typedef enum { MBEDTLS_SSL_VERSION_TLS1_2 = 0x0303 } mbedtls_ssl_protocol_version;
typedef struct mbedtls_ssl_config {
  mbedtls_ssl_protocol_version min_tls_version;
  void* inner[96];
} mbedtls_ssl_config;
typedef struct mbedtls_x509_crl mbedtls_x509_crl;
typedef int mbedtls_ssl_send_t(void* ctx, const unsigned char* buf, size_t len);
typedef int mbedtls_ssl_recv_t(void* ctx, unsigned char* buf, size_t len);
typedef int mbedtls_ssl_recv_timeout_t(void* ctx, unsigned char* buf, size_t len,
                                       uint32_t timeout);

extern "C" {
void mbedtls_ssl_init(mbedtls_ssl_context* ssl);
void mbedtls_ssl_free(mbedtls_ssl_context* ssl);
int mbedtls_ssl_setup(mbedtls_ssl_context* ssl, const mbedtls_ssl_config* conf);
int mbedtls_ssl_set_hostname(mbedtls_ssl_context* ssl, const char* hostname);
void mbedtls_ssl_set_bio(mbedtls_ssl_context* ssl, void* p_bio, mbedtls_ssl_send_t* f_send,
                         mbedtls_ssl_recv_t* f_recv, mbedtls_ssl_recv_timeout_t* f_recv_timeout);
int mbedtls_ssl_handshake_step(mbedtls_ssl_context* ssl);
int mbedtls_ssl_read(mbedtls_ssl_context* ssl, unsigned char* buf, size_t len);
int mbedtls_ssl_write(mbedtls_ssl_context* ssl, const unsigned char* buf, size_t len);
void mbedtls_ssl_config_init(mbedtls_ssl_config* conf);
void mbedtls_ssl_config_free(mbedtls_ssl_config* conf);
int mbedtls_ssl_config_defaults(mbedtls_ssl_config* conf, int endpoint, int transport, int preset);
void mbedtls_ssl_conf_authmode(mbedtls_ssl_config* conf, int authmode);
#if MBEDTLS_VERSION_NUMBER < 0x03020000
void mbedtls_ssl_conf_min_version(mbedtls_ssl_config* conf, int major, int minor);
#endif
void mbedtls_ssl_conf_ca_chain(mbedtls_ssl_config* conf, mbedtls_x509_crt* ca_chain,
                               mbedtls_x509_crl* ca_crl);
void mbedtls_ssl_conf_verify(mbedtls_ssl_config* conf,
                             int (*f_vrfy)(void*, mbedtls_x509_crt*, int, uint32_t*),
                             void* p_vrfy);
void mbedtls_ssl_conf_rng(mbedtls_ssl_config* conf, int (*f_rng)(void*, unsigned char*, size_t),
                          void* p_rng);
}

#if MBEDTLS_VERSION_NUMBER >= 0x03020000
static inline void mbedtls_ssl_conf_min_tls_version(mbedtls_ssl_config* conf,
                                                    mbedtls_ssl_protocol_version tls_version) {
  conf->min_tls_version = tls_version;
}

static inline int mbedtls_ssl_is_handshake_over(mbedtls_ssl_context* ssl) {
  return ssl->state >= MBEDTLS_SSL_HANDSHAKE_OVER;
}
#endif

#endif
