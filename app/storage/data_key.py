"""The library's data key, in memory that can be overwritten.

Whoever works with the key is given the one `DataKey` of the open library, never a copy of its bytes, and asks `checked`
at the moment of use: after a lock there is none, and nothing must be sealed with what is left.
"""

from app.storage.stored import LibraryError

KEY_BYTES = 32
KeyMaterial = bytes | bytearray


class LibraryLockedError(LibraryError):
    """The key was taken out of memory; the passphrase brings it back."""


class Secret(bytearray):
    """A key or what opens it, or nothing once it was wiped: when it is let go of at the latest."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"  # whatever prints this must not print the key

    __str__ = __repr__

    def __del__(self) -> None:
        self.wipe()

    def wipe(self) -> None:
        """Overwrite it in place."""
        self[:] = bytes(len(self))  # of the same length, so in place
        self.clear()


class DataKey(Secret):
    """The key, or nothing once it was wiped."""

    def refill(self, other: "DataKey") -> None:
        """Take the key out of `other`, which is wiped."""
        self[:] = other
        other.wipe()


def checked(data_key: KeyMaterial) -> KeyMaterial:
    """Give the key; raises LibraryLockedError if it was wiped."""
    if len(data_key) != KEY_BYTES:
        raise LibraryLockedError("The library is locked", "Type the passphrase, then try again")
    return data_key
