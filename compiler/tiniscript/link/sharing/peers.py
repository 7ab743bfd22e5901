"""Finds whose connection it is: the user at the other end of a connection within this computer.

A port of 127.0.0.1 is there for all users. Linux reports who has the other end; where this is
unknown, everyone is admitted.
"""

from __future__ import annotations

import errno
import os
import socket
import struct
import sys
from typing import NamedTuple

_SOCK_DIAG = 4  # netlink protocol, with its request and answer below
_BY_FAMILY, _REQUEST, _ERROR = 20, 1, 2
_ALL_STATES, _NO_COOKIE = 0xFFFFFFFF, b"\xff" * 8
_HEAD = struct.Struct("=IHHII")  # length, type, flags, number, sender
_REQUEST_BODY = struct.Struct("=BBBBI")  # family, protocol, extensions, padding, states
_SOCKET_ENDPOINTS = struct.Struct(">HH16s16sI8s")  # ports, addresses, interface, cookie
_ANSWER = struct.Struct("=BBBB48sIIIII")  # family, state, .., expires, queues, user, inode
ROOT_USER = 0
HOST = "127.0.0.1"
# The other end is closed, or this process has too many files open to ask.
_NO_SOCKET_ERRORS = (errno.ENOENT, errno.EMFILE, errno.ENFILE)


class SocketOwner(NamedTuple):
    """The other end of a connection.

    A connection that its process has closed has no inode. The kernel then reports its user as 0, as
    for root; Linux 6.17 and later report the real user for a moment.
    """

    user: int
    inode: int

    @property
    def is_open(self) -> bool:
        return self.inode != 0


def is_of_this_user(peer: socket.socket) -> bool:
    """Return whether the other end of an accepted connection belongs to this user or root.

    False if the other end is closed: it could have been any user.
    """
    if sys.platform != "linux":
        return True
    try:
        peer_address, own_address = peer.getpeername(), peer.getsockname()
    except OSError:  # the process has ended
        return False
    try:
        owner = _socket_owner(peer_address, own_address)
    except OSError as error:  # a system that has no answer to that lets everybody in
        return error.errno not in _NO_SOCKET_ERRORS
    return owner.is_open and owner.user in (os.geteuid(), ROOT_USER)


def is_of_another_user(number: int) -> bool:
    """Return whether another user, except root, listens at a port of 127.0.0.1.

    False if no server listens there, or if this is unknown.
    """
    if sys.platform == "win32":
        return False
    try:
        owner = _socket_owner((HOST, number), ("0.0.0.0", 0))
    except OSError:
        return False
    return owner.user not in (os.geteuid(), ROOT_USER)


def tells_users() -> bool:
    """Return whether this system reports the users of connections."""
    return sys.platform == "linux"


def is_on_this_computer(peer: socket.socket) -> bool:
    """Return whether the other end of an accepted connection is on this computer."""
    try:
        with socket.socket() as probe:
            probe.bind((peer.getpeername()[0], 0))
    except OSError:  # no address of this computer
        return False
    return True


def _socket_owner(peer_address: tuple[str, int], own_address: tuple[str, int]) -> SocketOwner:
    """Return the kernel's information about the socket at `peer_address`. Raises OSError."""
    if sys.platform != "linux":
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
    addresses = socket.inet_aton(peer_address[0]), socket.inet_aton(own_address[0])
    endpoints = _SOCKET_ENDPOINTS.pack(peer_address[1], own_address[1], *addresses, 0, _NO_COOKIE)
    request = _REQUEST_BODY.pack(socket.AF_INET, socket.IPPROTO_TCP, 0, 0, _ALL_STATES) + endpoints
    head = _HEAD.pack(_HEAD.size + len(request), _BY_FAMILY, _REQUEST, 1, 0)
    with socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _SOCK_DIAG) as kernel:
        kernel.send(head + request)
        data = kernel.recv(8192)
    if _HEAD.unpack_from(data)[1] == _ERROR:
        number = -struct.unpack_from("=i", data, _HEAD.size)[0]
        raise OSError(number, os.strerror(number))
    *_, user, inode = _ANSWER.unpack_from(data, _HEAD.size)
    return SocketOwner(user, inode)
