"""The system's keyring as a way to open the library in place of an operator's passphrase.

The keyring holds a random secret that opens a slot of its own kind. Whoever works under this account of the machine
then opens the library as that operator: it is for an account that one person uses, and not for the lock after five
minutes. A keyring can be lost with its account, so passphrase and recovery key open as before.

The package `keyring` is an extra. It may be absent, and be present without any keyring to speak to, as on a server.
Every call may wait for the user, whom the system asks to unlock the keyring.
"""

import secrets
from contextlib import suppress
from typing import Any

from app.storage.data_key import KEY_BYTES, DataKey, KeyMaterial
from app.storage.keys import KeyRefusedError, KeySlots

SERVICE = "Gaitwright"
SAFE_PRIORITY = 1  # those below are, by the package's own rule, not recommended: some keep secrets in the open


def is_there_a_keyring() -> bool:
    """Return whether this machine has a keyring that keeps a secret."""
    return _keyring() is not None


def remember(slots: KeySlots, data_key: KeyMaterial, code: str) -> None:
    """Let this machine's keyring open the library for an operator, replacing others; raises KeyRefusedError."""
    keyring = _keyring()
    if keyring is None:
        raise KeyRefusedError("This computer has no keyring", "Continue with the passphrase")
    forget(slots, code)
    secret = secrets.token_hex(KEY_BYTES)
    slot = slots.set_keyring_slot(data_key, code, secret.encode())
    try:
        keyring.set_password(SERVICE, slot.salt, secret)
    except Exception as problem:  # each system's keyring has errors of its own, which the package lets through
        slots.remove_keyring_slot(code)
        raise KeyRefusedError(
            "The keyring does not accept the key", "Unlock the keyring, or continue with the passphrase"
        ) from problem


def open_remembered(slots: KeySlots, code: str) -> DataKey | None:
    """Give the data key, None where the passphrase is needed; raises KeyRefusedError for damaged slots."""
    slot, keyring = slots.keyring_slot(code), _keyring()
    if slot is None or keyring is None:
        return None
    try:
        secret = keyring.get_password(SERVICE, slot.salt)
    except Exception:  # as above; the passphrase is asked for, which is notice enough
        return None
    return slot.opened(secret.encode()) if secret else None


def forget(slots: KeySlots, code: str) -> None:
    """Let only the passphrase open the library; an unreachable keyring's secret opens only old slot copies."""
    slot, keyring = slots.keyring_slot(code), _keyring()
    slots.remove_keyring_slot(code)
    if slot is not None and keyring is not None:
        with suppress(Exception):  # as above
            keyring.delete_password(SERVICE, slot.salt)


def _keyring() -> Any:
    """The system's keyring, None without a safe one."""
    try:
        import keyring  # an extra

        found = keyring.get_keyring()
        return found if found.priority >= SAFE_PRIORITY else None
    except Exception:  # not installed, or set up in a way that it cannot load
        return None
