"""Keys that stay the same when the data key changes. Those of the audit's chain and of the pseudonyms.

Both come from the first data key of a library. When that is changed they are kept in the database, wrapped under the
new one: the chain goes on from its beginning, and a patient's exports keep their pseudonym.
"""

import base64
import secrets
from dataclasses import dataclass, field

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.kdf.hkdf import HKDF
from sqlalchemy.orm import Session as OrmSession

from app.storage.data_key import KEY_BYTES, KeyMaterial, checked
from app.storage.database.models import SettingRow
from app.storage.stored import LibraryFaultError

SETTING = "derived_keys"
NONCE_BYTES = 12


@dataclass(frozen=True, slots=True)
class DerivedKeys:
    """The keys of one library that outlive a change of its data key; a demonstration's are known to all."""

    audit: bytes = field(repr=False)
    pseudonyms: bytes = field(repr=False)


def derived_from(data_key: KeyMaterial | None) -> DerivedKeys:
    """Those of a library whose first data key this is."""
    return DerivedKeys(_derived(data_key, b"gaitwright audit 1"), _derived(data_key, b"gaitwright pseudonyms 1"))


def derived_keys(session: OrmSession, data_key: KeyMaterial | None) -> DerivedKeys:
    """Give the library's derived keys; raises LibraryFaultError if damaged."""
    row = session.get(SettingRow, SETTING) if data_key is not None else None
    if row is None:
        return derived_from(data_key)
    try:
        kept = base64.b64decode(row.value)
        content = _wrapping(data_key).decrypt(kept[:NONCE_BYTES], kept[NONCE_BYTES:], None)
    except (InvalidTag, ValueError, TypeError):
        raise LibraryFaultError(
            "The keys of the library's audit log are damaged", "Restore the library from a backup"
        ) from None
    return DerivedKeys(content[:KEY_BYTES], content[KEY_BYTES:])


def keep_derived_keys(session: OrmSession, kept: DerivedKeys, data_key: KeyMaterial) -> None:
    """Keep them under a new data key."""
    nonce = secrets.token_bytes(NONCE_BYTES)
    content = nonce + _wrapping(data_key).encrypt(nonce, kept.audit + kept.pseudonyms, None)
    SettingRow.put(session, SETTING, base64.b64encode(content).decode())


def _derived(data_key: KeyMaterial | None, info: bytes) -> bytes:
    return HKDF(SHA256(), KEY_BYTES, salt=None, info=info).derive(b"" if data_key is None else checked(data_key))


def _wrapping(data_key: KeyMaterial | None) -> AESGCM:
    return AESGCM(_derived(data_key, b"gaitwright derived keys 1"))
