// What stands for mbedTLS where this computer has none: no connection with TLS comes about.

#include <mbedtls/ssl.h>
#include <mbedtls/x509_crt.h>

#ifdef tiniscript_no_mbedtls

extern "C" {

void mbedtls_ssl_init(mbedtls_ssl_context*) {}
void mbedtls_ssl_free(mbedtls_ssl_context*) {}
int mbedtls_ssl_setup(mbedtls_ssl_context*, const mbedtls_ssl_config*) { return -1; }
int mbedtls_ssl_set_hostname(mbedtls_ssl_context*, const char*) { return -1; }
void mbedtls_ssl_set_bio(mbedtls_ssl_context*, void*, mbedtls_ssl_send_t*, mbedtls_ssl_recv_t*,
                         mbedtls_ssl_recv_timeout_t*) {}
int mbedtls_ssl_handshake_step(mbedtls_ssl_context*) { return -1; }
int mbedtls_ssl_read(mbedtls_ssl_context*, unsigned char*, size_t) { return -1; }
int mbedtls_ssl_write(mbedtls_ssl_context*, const unsigned char*, size_t) { return -1; }
void mbedtls_ssl_config_init(mbedtls_ssl_config*) {}
void mbedtls_ssl_config_free(mbedtls_ssl_config*) {}
int mbedtls_ssl_config_defaults(mbedtls_ssl_config*, int, int, int) { return -1; }
#if MBEDTLS_VERSION_NUMBER < 0x03020000
void mbedtls_ssl_conf_min_version(mbedtls_ssl_config*, int, int) {}
#endif
void mbedtls_ssl_conf_authmode(mbedtls_ssl_config*, int) {}
void mbedtls_ssl_conf_ca_chain(mbedtls_ssl_config*, mbedtls_x509_crt*, mbedtls_x509_crl*) {}
void mbedtls_ssl_conf_verify(mbedtls_ssl_config*, int (*)(void*, mbedtls_x509_crt*, int, uint32_t*),
                             void*) {}
void mbedtls_ssl_conf_rng(mbedtls_ssl_config*, int (*)(void*, unsigned char*, size_t), void*) {}
void mbedtls_x509_crt_init(mbedtls_x509_crt*) {}
void mbedtls_x509_crt_free(mbedtls_x509_crt*) {}
int mbedtls_x509_crt_parse_der(mbedtls_x509_crt*, const unsigned char*, size_t) { return -1; }

}  // extern "C"

#endif  // tiniscript_no_mbedtls
