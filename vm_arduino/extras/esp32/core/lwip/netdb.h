// Stands for components/lwip/lwip/src/include/lwip/netdb.h of ESP-IDF.

#pragma once

#if __STDC_HOSTED__
#include <netdb.h>
#else
struct hostent {
  char* h_name;
  char** h_aliases;
  int h_addrtype;
  int h_length;
  char** h_addr_list;
};
#endif

extern "C" struct hostent* lwip_gethostbyname(const char* name);
