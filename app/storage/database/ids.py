"""Keys that need no server to hand them out, and that sort by the time of their making: UUID version 7."""

import secrets
import time
from uuid import UUID


def uuid7(now_ns: int | None = None) -> UUID:
    """Draw a UUIDv7 (RFC 9562, 5.7; fraction of ms in 12 bits: 6.2, method 3); Python has one from 3.14 on."""
    now_ns = time.time_ns() if now_ns is None else now_ns
    milliseconds, rest_ns = divmod(now_ns, 1_000_000)
    fraction = rest_ns * 4096 // 1_000_000
    bits = (milliseconds & (1 << 48) - 1) << 80 | 0x7 << 76 | fraction << 64 | 0b10 << 62 | secrets.randbits(62)
    return UUID(int=bits)
