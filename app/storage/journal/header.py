"""Identity of a recording and the key it is sealed by. What is before a journal's first record.

    magic 8 | format 2 | flags 2 | recording 16 | segment 4 | opened, wall clock 8 | opened, monotonic 8
    | wrapped key 60 (nonce 12, key 32, tag 16) | CRC32C 4

Little-endian, times in nanoseconds. The wrapping is bound to everything before it. A segment that was begun because the
file before could not be gone on with (`JournalWriter`) has that one's two times, so that its records' times go on.
"""

import os
import secrets
import struct
from dataclasses import dataclass, replace
from pathlib import Path
from uuid import UUID

from crc32c import crc32c
from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.kdf.hkdf import HKDF

from app.storage.data_key import KeyMaterial, checked
from app.storage.files import sync_folder
from app.storage.layout import SUFFIX, segment_name
from app.wording.translation import later, tr

MAGIC = b"\x89GWJ\r\n\x1a\n"  # what takes a journal for text, and mends its line ends, shows here first
FORMAT = 1
SEALED = 1  # the flag
IDENTITY = struct.Struct("<8sHH16sIqq")
NONCE_BYTES, KEY_BYTES, TAG_BYTES = 12, 32, 16
WRAPPED_BYTES = NONCE_BYTES + KEY_BYTES + TAG_BYTES
NO_KEY = bytes(WRAPPED_BYTES)
HEADER_BYTES = IDENTITY.size + WRAPPED_BYTES + 4
RESTORE = later("Restore this recording from a backup")


class JournalRefusedError(Exception):
    """A journal that cannot be written or read: what is wrong, where, and what to do."""

    def __init__(self, where: str, what: str, remedy: str) -> None:
        super().__init__(f"{where}: {what}. {remedy}.")
        self.where, self.what, self.remedy = where, what, remedy


@dataclass(frozen=True, slots=True)
class JournalHeader:
    """`opened_wall_ns` since 1970 in UTC, `opened_ns` by `devices.clocks.host_clock`. No `wrapped_key`: not sealed."""

    recording_id: UUID
    segment: int
    opened_wall_ns: int
    opened_ns: int
    wrapped_key: bytes = b""

    @property
    def is_sealed(self) -> bool:
        return bool(self.wrapped_key)

    @property
    def is_key_destroyed(self) -> bool:
        return self.wrapped_key == NO_KEY

    @property
    def identity(self) -> bytes:
        """All but the key, which may be overwritten."""
        return IDENTITY.pack(
            MAGIC,
            FORMAT,
            SEALED if self.is_sealed else 0,
            self.recording_id.bytes,
            self.segment,
            self.opened_wall_ns,
            self.opened_ns,
        )

    def continues(self, before: "JournalHeader") -> bool:
        """Whether this segment is the one before gone on with in another file, on the same clock."""
        return (self.opened_wall_ns, self.opened_ns) == (before.opened_wall_ns, before.opened_ns)

    def packed(self) -> bytes:
        content = self.identity + (self.wrapped_key or NO_KEY)
        return content + struct.pack("<I", crc32c(content))

    @classmethod
    def parsed(cls, content: bytes, where: str, wrapped_key: bytes | None = None) -> "JournalHeader":
        """Read a header; `wrapped_key`, from the row, replaces a damaged one; raises JournalRefusedError."""
        if content[: len(MAGIC)] != MAGIC or len(content) < HEADER_BYTES:
            raise JournalRefusedError(where, "this is not a Gaitwright recording, or its beginning is missing", RESTORE)
        _, version, flags, recording, segment, wall_ns, opened_ns = IDENTITY.unpack_from(content)
        found = content[IDENTITY.size : IDENTITY.size + WRAPPED_BYTES]
        own = found if wrapped_key is None else wrapped_key
        header = cls(UUID(bytes=recording), segment, wall_ns, opened_ns, own if flags & SEALED else b"")
        is_whole = struct.unpack_from("<I", content, HEADER_BYTES - 4)[0] == crc32c(content[: HEADER_BYTES - 4])
        if version != FORMAT:
            what = tr(
                "this recording has format {found}, but this version reads {known}; or its beginning is damaged"
            ).format(found=version, known=FORMAT)
            raise JournalRefusedError(where, what, "Install the latest version, or restore the recording from a backup")
        # with the row's key only the rest has to be right, and the key's own tag proves it
        if header.identity != content[: IDENTITY.size] or not (is_whole or (wrapped_key and header.is_sealed)):
            raise JournalRefusedError(where, "the beginning of this recording is damaged", RESTORE)
        return header

    def with_new_key(self, data_key: KeyMaterial) -> tuple["JournalHeader", bytes]:
        """Draw this journal's own key; returns the header that holds it wrapped, and the key."""
        key = secrets.token_bytes(KEY_BYTES)
        return self.with_key(key, data_key), key

    def with_key(self, key: bytes, data_key: KeyMaterial) -> "JournalHeader":
        """The same header with this journal's key wrapped by `data_key`."""
        nonce = secrets.token_bytes(NONCE_BYTES)
        sealed = replace(self, wrapped_key=NO_KEY)  # being sealed is part of what the wrapping is bound to
        wrapped = nonce + AESGCM(_wrapping_key(data_key)).encrypt(nonce, key, sealed.identity)
        return replace(self, wrapped_key=wrapped)

    def key(self, data_key: KeyMaterial | None, where: str) -> bytes | None:
        """Give the journal's own key, None if unsealed; raises JournalRefusedError, also for a missing seal."""
        if not self.is_sealed and data_key is not None:
            raise JournalRefusedError(
                where, "this recording is not encrypted, so it does not belong to this library", RESTORE
            )
        if not self.is_sealed:
            return None
        if data_key is None:
            raise JournalRefusedError(where, "this recording is encrypted", "Log in to its library")
        if self.is_key_destroyed:
            raise JournalRefusedError(
                where, "this recording was permanently destroyed", "Only a backup may still contain it"
            )
        nonce, wrapped = self.wrapped_key[:NONCE_BYTES], self.wrapped_key[NONCE_BYTES:]
        try:
            return AESGCM(_wrapping_key(data_key)).decrypt(nonce, wrapped, self.identity)
        except (InvalidTag, ValueError):
            raise JournalRefusedError(
                where, "the key of this recording is damaged or belongs to another library", RESTORE
            ) from None


def _wrapping_key(data_key: KeyMaterial) -> bytes:
    # the data key also opens the database: no key serves two ciphers
    return HKDF(SHA256(), KEY_BYTES, salt=None, info=b"gaitwright journal keys 1").derive(checked(data_key))


def read_header(path: Path, wrapped_key: bytes | None = None) -> JournalHeader:
    """Read a journal's header; raises JournalRefusedError or OSError."""
    with path.open("rb") as file:
        return JournalHeader.parsed(file.read(HEADER_BYTES), path.name, wrapped_key)


def segment_path(folder: Path, recording_id: UUID, segment: int) -> Path:
    return folder / segment_name(recording_id, segment)


def find_segments(folder: Path) -> dict[UUID, dict[int, Path]]:
    """Every recording in `folder`, its journals by segment, ascending. Names only; no file is opened."""
    found: dict[UUID, dict[int, Path]] = {}
    for path in folder.glob(f"*{SUFFIX}"):
        name, _, segment = path.name.removesuffix(SUFFIX).partition(".")
        try:
            found.setdefault(UUID(name), {})[int(segment)] = path
        except ValueError:
            continue  # somebody else's
    return {recording_id: dict(sorted(paths.items())) for recording_id, paths in found.items() if paths}


def destroy_key(path: Path) -> None:
    """Overwrite a sealed journal's wrapped key, not the row's copy; raises JournalRefusedError.
    A disk that writes elsewhere (flash, snapshots), and backups, may keep the old one.
    """
    with path.open("r+b", buffering=0) as file:
        header = JournalHeader.parsed(file.read(HEADER_BYTES), path.name, NO_KEY)
        if not header.is_sealed:
            raise JournalRefusedError(path.name, "this recording is not encrypted, so it has no key", "Delete the file")
        file.seek(0)
        file.write(header.packed())
        os.fsync(file.fileno())
    sync_folder(path.parent)
