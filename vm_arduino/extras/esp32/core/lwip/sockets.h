// Stands for components/lwip/lwip/src/include/lwip/sockets.h of ESP-IDF: its functions, with their
// own names, on the sockets of this computer.

#pragma once

#if __STDC_HOSTED__
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#else  // a compiler without its library
#include <stddef.h>
#include <stdint.h>
typedef int ssize_t;
typedef uint32_t socklen_t;
struct sockaddr;
struct in_addr {
  uint32_t s_addr;
};
struct sockaddr_in {
  uint8_t sin_len;
  uint8_t sin_family;
  uint16_t sin_port;
  in_addr sin_addr;
  char sin_zero[8];
};
#define AF_INET 2
#define SOCK_STREAM 1
#define SOL_SOCKET 0xfff
#define SO_REUSEADDR 0x0004
#define IPPROTO_TCP 6
#define TCP_NODELAY 0x01
#define MSG_DONTWAIT 0x08
#define F_SETFL 4
#define O_NONBLOCK 1
#define INADDR_ANY 0U
#define EAGAIN 11
#define EWOULDBLOCK EAGAIN
#define EINPROGRESS 119
#define EALREADY 120
#define EISCONN 127
extern "C" {
uint16_t lwip_htons(uint16_t x);
uint32_t lwip_htonl(uint32_t x);
int* __errno();
}
#define htons(x) lwip_htons(x)
#define htonl(x) lwip_htonl(x)
#define errno (*__errno())
#endif

extern "C" {
int lwip_accept(int s, struct sockaddr* addr, socklen_t* addrlen);
int lwip_bind(int s, const struct sockaddr* name, socklen_t namelen);
int lwip_close(int s);
int lwip_connect(int s, const struct sockaddr* name, socklen_t namelen);
int lwip_fcntl(int s, int cmd, int val);
int lwip_listen(int s, int backlog);
ssize_t lwip_recv(int s, void* mem, size_t len, int flags);
ssize_t lwip_send(int s, const void* dataptr, size_t size, int flags);
int lwip_setsockopt(int s, int level, int optname, const void* optval, socklen_t optlen);
int lwip_socket(int domain, int type, int protocol);
}
