// Stands for components/lwip/lwip/src/include/lwip/netdb.h of ESP-IDF.

#ifndef TINISCRIPT_LWIP_NETDB_H_
#define TINISCRIPT_LWIP_NETDB_H_

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

#endif  // TINISCRIPT_LWIP_NETDB_H_
