"""This computer's own addresses in its networks, asked of the system; nobody else is asked."""

import socket
import struct
import sys

if sys.platform != "win32":
    import fcntl

THIS_COMPUTER = "127.0.0.1"
ADDRESS_OF = 0xC0206921 if sys.platform == "darwin" else 0x8915  # SIOCGIFADDR
REQUEST = struct.Struct("16s16s")  # an interface's name, then its address: family and port (4 bytes), IPv4 (4 bytes)


def own_addresses() -> tuple[str, ...]:
    """The IPv4 addresses under which others see this computer, one for each network."""
    if sys.platform == "win32":
        found = socket.gethostbyname_ex(socket.gethostname())[2]  # which Windows knows itself
    else:
        found = [address for _, name in socket.if_nameindex() if (address := _address_of(name))]
    return tuple(sorted(address for address in dict.fromkeys(found) if not address.startswith("127.")))


def _address_of(interface: str) -> str:
    """The interface's address; empty where it has none."""
    if sys.platform == "win32":
        return ""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        try:
            answer = fcntl.ioctl(asking, ADDRESS_OF, REQUEST.pack(interface.encode(), b""))
        except OSError:
            return ""
    return socket.inet_ntoa(answer[20:24])
