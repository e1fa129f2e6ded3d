"""Texts of other programs as UTF-8: Excel and older programs of Windows write UTF-16 and cp1252."""

import codecs
import io
from pathlib import Path
from typing import BinaryIO

UTF_8, UTF_16, WINDOWS = "utf-8", "utf-16", "cp1252"
ENCODINGS = (UTF_8, UTF_16, WINDOWS)
HEAD_BYTES = 65_536
SEEN = 400  # bytes by which UTF-16 without a mark is found
MOSTLY = 0.8  # of these, of which every other one is zero
CONTROLS = bytes(set(range(32)) - set(b"\t\n\r\f\v"))  # no text of a program holds them


def encoding_of(head: bytes) -> str:
    """Give how a text that begins so is encoded; UTF-8 for what is no text."""
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return UTF_16
    if b"\0" in head:
        seen = head[:SEEN]
        shares = [seen[start::2].count(0) / max(len(seen) // 2, 1) for start in (0, 1)]
        if max(shares) > MOSTLY and min(shares) < 1.0 - MOSTLY:
            return f"{UTF_16}-be" if shares[0] > shares[1] else f"{UTF_16}-le"
        return UTF_8
    try:
        codecs.getincrementaldecoder(UTF_8)().decode(head)  # the last letter may be cut
    except UnicodeDecodeError:
        return UTF_8 if set(head) & set(CONTROLS) else WINDOWS
    return UTF_8


def as_utf8(head: bytes) -> bytes:
    """The first bytes of a file in UTF-8 where it is a text of another encoding; else as they are."""
    encoding = encoding_of(head)
    if encoding == UTF_8:
        return head
    text = codecs.getincrementaldecoder(encoding)("replace").decode(head)
    return head if set(text.encode()) & set(CONTROLS) else text.encode()


def open_text(path: Path, encoding: str = "") -> BinaryIO:
    """Open a text as UTF-8; `encoding` empty: as its first bytes show. What it cannot decode becomes a mark."""
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    found = encoding_of(head)
    known = encoding or found
    if known == UTF_16 and not head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        known = found if found.startswith(UTF_16) else f"{UTF_16}-le"  # as Windows writes it
    if known == UTF_8:
        return path.open("rb")
    with path.open(encoding=known, errors="replace", newline="") as text:
        return io.BytesIO(text.read().encode())
