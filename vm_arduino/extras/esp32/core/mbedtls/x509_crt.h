// Stands for components/mbedtls/mbedtls/include/mbedtls/x509_crt.h of ESP-IDF, and x509.h beside
// it.

#pragma once

#if __STDC_HOSTED__ && __has_include_next(<mbedtls/x509_crt.h>)
#include_next <mbedtls/x509_crt.h>
#else

#include <stddef.h>
#include <stdint.h>

#define MBEDTLS_ERR_X509_ALLOC_FAILED -0x2880
#define MBEDTLS_X509_BADCERT_EXPIRED 0x01
#define MBEDTLS_X509_BADCERT_CN_MISMATCH 0x04
#define MBEDTLS_X509_BADCERT_NOT_TRUSTED 0x08
#define MBEDTLS_X509_BADCERT_FUTURE 0x0200
#define tiniscript_no_mbedtls  // on this computer

typedef struct mbedtls_x509_time {
  int year, mon, day;
  int hour, min, sec;
} mbedtls_x509_time;

typedef struct mbedtls_asn1_buf {
  int tag;
  size_t len;
  unsigned char* p;
} mbedtls_asn1_buf;
typedef mbedtls_asn1_buf mbedtls_x509_buf;

typedef struct mbedtls_x509_crt {
  mbedtls_x509_buf raw;
  void* before[64];
  mbedtls_x509_time valid_from;
  mbedtls_x509_time valid_to;
  void* after[64];
} mbedtls_x509_crt;

extern "C" {
void mbedtls_x509_crt_init(mbedtls_x509_crt* crt);
void mbedtls_x509_crt_free(mbedtls_x509_crt* crt);
int mbedtls_x509_crt_parse_der(mbedtls_x509_crt* chain, const unsigned char* buf, size_t buflen);
}

#endif
