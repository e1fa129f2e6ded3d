"""Open the data key with one secret, and let the data key be changed without that secret.

A slot has a pair of X25519 keys (RFC 7748). The private one is wrapped with AES-256-GCM under a key that comes from the
secret by Argon2id (RFC 9106); the data key is sealed to the public one. Who holds the data key can so seal another to
the same slot. The slot's mark, an HMAC under the data key, shows that the public key was put there by somebody who had
it: to a key that an outsider wrote into the file nothing is sealed.

Slots of the first format wrap the data key itself. They open, and become such as these when they do.
"""

import base64
import hmac
import secrets
from dataclasses import dataclass, replace

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey, X25519PublicKey
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.kdf.argon2 import Argon2id
from cryptography.hazmat.primitives.kdf.hkdf import HKDF

from app.storage.data_key import KEY_BYTES, DataKey, KeyMaterial, Secret, checked

FIRST_FORMAT, FORMAT = "gaitwright-keys/1", "gaitwright-keys/2"
SALT_BYTES, NONCE_BYTES, TAG_BYTES = 16, 12, 16
SIZES = [SALT_BYTES, NONCE_BYTES, KEY_BYTES + TAG_BYTES]  # of salt, nonce and wrapped key
PUBLIC_SIZES = [KEY_BYTES, KEY_BYTES + NONCE_BYTES + KEY_BYTES + TAG_BYTES, 32]  # of public key, sealed key and mark
MOST_PASSES, MOST_MEMORY_KIB = 12, 256 * 1024  # four times ours: a log in takes seconds at most


@dataclass(frozen=True, slots=True)
class Cost:
    """What one guess at a passphrase costs (Argon2id): passes over `memory_kib` of memory."""

    passes: int = 3
    memory_kib: int = 64 * 1024


COST = Cost()


@dataclass(frozen=True, slots=True)
class Slot:
    """The data key for an operator (`code`), an operator's keyring or the recovery key. Bytes are base64.

    `public`, `sealed` and `mark` are empty in the first format.
    """

    code: str
    salt: str
    nonce: str
    wrapped: str
    passes: int
    memory_kib: int
    public: str = ""
    sealed: str = ""
    mark: str = ""

    @property
    def is_first_format(self) -> bool:
        return not self.public

    def opened(self, secret: KeyMaterial) -> DataKey | None:
        """The data key; None when `secret` is not this slot's."""
        inner = DataKey(KEY_BYTES)
        try:
            wrapping = AESGCM(self._wrapping_key(secret))
            wrapping.decrypt_into(_bytes(self.nonce), _bytes(self.wrapped), self._bound(), inner)
            if self.is_first_format:
                return inner
            data_key = self._unsealed(inner)
            inner.wipe()
            return data_key
        except (InvalidTag, ValueError):  # ValueError: of a public key that is none
            return None

    def is_of(self, data_key: KeyMaterial) -> bool:
        """Whether somebody who had the data key made this slot, so that another may be sealed to it."""
        return not self.is_first_format and hmac.compare_digest(_bytes(self.mark), self._mark_under(data_key))

    def sealing(self, data_key: KeyMaterial) -> "Slot":
        """The same slot with this data key in place of the one it holds."""
        ephemeral, nonce = X25519PrivateKey.generate(), secrets.token_bytes(NONCE_BYTES)
        public = ephemeral.public_key().public_bytes_raw()
        shared = ephemeral.exchange(X25519PublicKey.from_public_bytes(_bytes(self.public)))
        sealed = AESGCM(self._sealing_key(shared, public)).encrypt(nonce, checked(data_key), self._bound())
        return replace(self, sealed=_text(public + nonce + sealed), mark=_text(self._mark_under(data_key)))

    @classmethod
    def wrapping(cls, data_key: KeyMaterial, code: str, secret: KeyMaterial, cost: Cost) -> "Slot":
        private = X25519PrivateKey.generate()
        salt, nonce = _text(secrets.token_bytes(SALT_BYTES)), _text(secrets.token_bytes(NONCE_BYTES))
        public = _text(private.public_key().public_bytes_raw())
        empty = cls(code, salt, nonce, "", cost.passes, cost.memory_kib, public)
        wrapping = AESGCM(empty._wrapping_key(secret))
        wrapped = wrapping.encrypt(_bytes(nonce), private.private_bytes_raw(), empty._bound())
        return replace(empty, wrapped=_text(wrapped)).sealing(data_key)

    def _unsealed(self, private_key: KeyMaterial) -> DataKey:
        sealed = _bytes(self.sealed)
        public, nonce, content = sealed[:KEY_BYTES], sealed[KEY_BYTES:][:NONCE_BYTES], sealed[KEY_BYTES + NONCE_BYTES :]
        shared = X25519PrivateKey.from_private_bytes(private_key).exchange(X25519PublicKey.from_public_bytes(public))
        data_key = DataKey(KEY_BYTES)
        AESGCM(self._sealing_key(shared, public)).decrypt_into(nonce, content, self._bound(), data_key)
        return data_key

    def _wrapping_key(self, secret: KeyMaterial) -> Secret:
        kdf = Argon2id(
            salt=_bytes(self.salt),
            length=KEY_BYTES,
            iterations=self.passes,
            lanes=1,
            memory_cost=self.memory_kib,
        )
        key = Secret(KEY_BYTES)
        kdf.derive_into(secret, key)  # type: ignore[arg-type]  # its types know bytes only
        return key

    def _sealing_key(self, shared: bytes, public: bytes) -> bytes:
        info = b"gaitwright slot 2" + public + _bytes(self.public)
        return HKDF(SHA256(), KEY_BYTES, salt=None, info=info).derive(shared)

    def _mark_under(self, data_key: KeyMaterial) -> bytes:
        key = HKDF(SHA256(), KEY_BYTES, salt=None, info=b"gaitwright slots 2").derive(checked(data_key))
        return hmac.digest(key, self._bound(), "sha256")

    def _bound(self) -> bytes:
        words = f"{FIRST_FORMAT if self.is_first_format else FORMAT} {self.code} {self.salt}"
        return f"{words} {self.passes} {self.memory_kib} {self.public}".rstrip().encode()


def whole(slot: Slot) -> Slot:
    """Give an untrusted slot if it is safe to open; raises ValueError or TypeError if damaged or too costly."""
    sizes = [len(base64.b64decode(text, validate=True)) for text in (slot.salt, slot.nonce, slot.wrapped)]
    public = [len(base64.b64decode(text, validate=True)) for text in (slot.public, slot.sealed, slot.mark)]
    if sizes != SIZES or public not in ([0, 0, 0], PUBLIC_SIZES):
        raise ValueError(slot.code)
    if not 1 <= slot.passes <= MOST_PASSES or not 8 <= slot.memory_kib <= MOST_MEMORY_KIB:
        raise ValueError(slot.code)
    return slot


def _bytes(text: str) -> bytes:
    return base64.b64decode(text)


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
