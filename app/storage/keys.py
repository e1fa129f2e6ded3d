"""Keys of those who may open the library.

One random data key, sealed once for every operator and once for the recovery key.

An operator may have a second slot, which the system's keyring opens (`app.storage.keyring_slot`). A slot has a pair of
keys of its own (`app.storage.slots`), so the data key can be changed without anybody's passphrase. The slots' file
holds nothing that opens without one, and no names: operators have short codes. Nothing here limits what an operator may
do; roles are the application's, not cryptography's.
"""

import json
import os
import secrets
import time
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

from app.storage.data_key import KEY_BYTES, DataKey, KeyMaterial, Secret
from app.storage.files import held, replace_file
from app.storage.slots import COST, FIRST_FORMAT, FORMAT, Cost, Slot, whole
from app.system.passphrases import Strength, refusal_of_passphrase, strength_of
from app.wording.translation import tr

MIN_PASSPHRASE = 10
RECOVERY_BYTES = 20
GROUP = 4  # letters of the recovery key that stand together
ASKED = 2  # its last groups, which are typed from its sheet
LETTERS = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"  # Crockford's: no I, L, O, U to be misread
MISREAD = str.maketrans({"I": "1", "L": "1", "O": "0"})
BUSY_S = 5.0  # another program's change takes a tenth of it
RECOVERY = "recovery"
CONFIRMED = "is_recovery_key_confirmed"
GIVEN = "given_passphrases"  # codes of those whose passphrase somebody else chose; files without it name nobody
KEYRING = "keyring-"  # precedes an operator's code; no code that is typed has a dash


class KeyRefusedError(Exception):
    """The library does not open, or the slots cannot be changed as asked. States what is wrong and what to do."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what}. {remedy}.")
        self.what, self.remedy = what, remedy


@dataclass(frozen=True, slots=True)
class SealedAgain:
    """What the slots' file is to hold once the data key is changed.

    `recovery_key`: the text of a new recovery key, where the old one could not be kept; else empty.
    `left_out`: operators who need a new passphrase: their slots are of the first format, or marked by nobody who had
    the key.
    """

    content: dict[str, object] = field(repr=False)  # the file
    recovery_key: str = field(repr=False)
    left_out: tuple[str, ...]


class KeySlots:
    """The slots' file of one library. Every change replaces the file as a whole.

    Where the file is, and how one program at a time changes it, is `_load`, `_save` and `_alone`; see
    `app.storage.clinic.key_slots` for a file that stations share.
    """

    def __init__(self, path: Path, cost: Cost = COST) -> None:
        self._path, self._cost = path, cost

    @property
    def exists(self) -> bool:
        return self._path.exists()

    @property
    def codes(self) -> tuple[str, ...]:
        """The operators that can log in."""
        return tuple(code for code in self._read() if _is_operators(code))

    def create(self, code: str, passphrase: str, known: Iterable[str] = ()) -> tuple[DataKey, str]:
        """Make the first operator's and the recovery key's slots; give key and text; raises KeyRefusedError."""
        if self.exists:
            raise KeyRefusedError("This library already has its keys", "Log in, or use the recovery key")
        data_key, text = DataKey(os.urandom(KEY_BYTES)), new_recovery_key()
        own = Slot.wrapping(data_key, _checked_code(code), _checked(passphrase, (code, *known)), self._cost)
        recovery = Slot.wrapping(data_key, RECOVERY, _recovery_bytes(text), self._cost)
        self._write({own.code: own, RECOVERY: recovery}, is_confirmed=False)
        return data_key, text

    def open(self, code: str, passphrase: str) -> DataKey:
        """Give the data key; raises KeyRefusedError, the same for a wrong operator as for a wrong passphrase."""
        slot = self._read().get(_normal(code))
        data_key = self._opened(slot, _secret(passphrase)) if slot is not None and _is_operators(slot.code) else None
        if data_key is None:
            raise KeyRefusedError(
                "This passphrase does not open the library", "Enter the passphrase again, or use the recovery key"
            )
        return data_key

    def open_with_recovery_key(self, text: str) -> DataKey:
        """Give the data key; raises KeyRefusedError where the text is mistyped or another library's."""
        secret = _recovery_bytes(text)
        slot = self._read().get(RECOVERY)
        data_key = self._opened(slot, secret) if slot is not None else None
        if data_key is None:
            raise KeyRefusedError(
                "This recovery key belongs to another library", "Find the recovery sheet of this library"
            )
        return data_key

    def add(
        self, data_key: KeyMaterial, code: str, passphrase: str, known: Iterable[str] = (), *, is_given: bool = False
    ) -> None:
        """Give an operator a slot; `is_given`: to be changed, since another chose it; raises KeyRefusedError."""
        with self._changing() as slots:
            if _checked_code(code) in slots:
                raise KeyRefusedError(
                    tr("The user code {code} is already in use").format(code=_normal(code)), "Choose another code"
                )
            own = Slot.wrapping(data_key, _normal(code), _checked(passphrase, (code, *known)), self._cost)
            given = self._given()
            self._write({**slots, own.code: own}, given=given | {own.code} if is_given else given - {own.code})

    def is_given(self, code: str) -> bool:
        """Whether somebody else chose this operator's passphrase, and so knows it."""
        return _normal(code) in self._given()

    def set_passphrase(self, data_key: KeyMaterial, code: str, passphrase: str, known: Iterable[str] = ()) -> None:
        """Give an operator a new passphrase, not like `known` or the one given; raises KeyRefusedError."""
        with self._changing() as slots:
            if _checked_code(code) not in slots:
                raise KeyRefusedError(
                    tr("User {code} has no key to this library").format(code=_normal(code)), "Add the user first"
                )
            secret = _checked(passphrase, (code, *known))
            if self.is_given(code) and slots[_normal(code)].opened(secret) is not None:
                raise KeyRefusedError("Another person chose this passphrase", "Choose another passphrase")
            own = Slot.wrapping(data_key, _normal(code), secret, self._cost)
            self._write({**slots, own.code: own}, given=self._given() - {own.code})

    def remove(self, code: str) -> None:
        """Remove an operator's slots; raises KeyRefusedError for the last one or the recovery key's."""
        with self._changing() as slots:
            slots.pop(_checked_code(code), None)
            slots.pop(KEYRING + _normal(code), None)
            if not any(_is_operators(left) for left in slots):
                raise KeyRefusedError("The last user's key cannot be removed", "Add another user first")
            self._write(slots)

    def renew_recovery_key(self, data_key: KeyMaterial) -> str:
        """Make a new recovery key and end the old one; returns its text."""
        text = new_recovery_key()
        with self._changing() as slots:
            recovery = Slot.wrapping(data_key, RECOVERY, _recovery_bytes(text), self._cost)
            self._write({**slots, RECOVERY: recovery}, is_confirmed=False)
        return text

    @property
    def is_recovery_key_confirmed(self) -> bool:
        """Whether somebody typed the recovery key back from its sheet since it was made."""
        return bool(self._content().get(CONFIRMED, True))

    def confirm_recovery_key(self, text: str) -> None:
        """Confirm the recovery key as typed back from its sheet; raises KeyRefusedError for another one."""
        self.open_with_recovery_key(text).wipe()
        with self._changing() as slots:
            self._write(slots, is_confirmed=True)

    def sealed_again(self, old: KeyMaterial, new: KeyMaterial, staying: Iterable[str]) -> SealedAgain:
        """Give the file for data key `new` of `staying` only; their passphrases and recovery key still open."""
        slots, codes = self._read(), {_normal(code) for code in staying}
        kept = {code: slot.sealing(new) for code, slot in slots.items() if slot.is_of(old) and _person(code) in codes}
        is_confirmed, text = self.is_recovery_key_confirmed, ""
        if slots[RECOVERY].is_of(old):
            kept[RECOVERY] = slots[RECOVERY].sealing(new)
        else:
            text, is_confirmed = new_recovery_key(), False
            kept[RECOVERY] = Slot.wrapping(new, RECOVERY, _recovery_bytes(text), self._cost)
        if not any(_is_operators(code) for code in kept):
            raise KeyRefusedError("Nobody would then have a key to the library", "Log in with the passphrase once")
        left_out = sorted(code for code in codes if code in slots and code not in kept)
        return SealedAgain(_file(kept, is_confirmed, self._given()), text, tuple(left_out))

    def keyring_slot(self, code: str) -> Slot | None:
        """The slot that an operator's keyring opens; None when it was not asked to."""
        return self._read().get(KEYRING + _normal(code))

    def set_keyring_slot(self, data_key: KeyMaterial, code: str, secret: bytes) -> Slot:
        """Let the secret in an operator's keyring open the library, replacing any; raises KeyRefusedError."""
        with self._changing() as slots:
            if _checked_code(code) not in slots:
                raise KeyRefusedError(
                    tr("User {code} has no key to this library").format(code=_normal(code)), "Add the user first"
                )
            own = Slot.wrapping(data_key, KEYRING + _normal(code), secret, self._cost)
            self._write({**slots, own.code: own})
            return own

    def remove_keyring_slot(self, code: str) -> None:
        """From now on only the passphrase opens the library for this operator."""
        with self._changing() as slots:
            if slots.pop(KEYRING + _normal(code), None) is not None:
                self._write(slots)

    def _opened(self, slot: Slot, secret: KeyMaterial) -> DataKey | None:
        data_key = slot.opened(secret)
        if data_key is not None and slot.is_first_format:
            with suppress(KeyRefusedError, OSError), self._changing() as slots:  # else the next time
                if slots.get(slot.code) == slot:
                    cost = Cost(slot.passes, slot.memory_kib)
                    self._write({**slots, slot.code: Slot.wrapping(data_key, slot.code, secret, cost)})
        return data_key

    @contextmanager
    def held(self) -> Iterator[None]:
        """Hold the slots against changes by others; raises KeyRefusedError where another is changing them."""
        with self._changing():
            yield

    @contextmanager
    def _changing(self) -> Iterator[dict[str, Slot]]:
        """The slots, held until what was done with them is written: of two changes at once neither is lost."""
        with self._alone():
            yield self._read()

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Be the one who changes the file."""
        deadline = time.monotonic() + BUSY_S
        while True:
            try:
                with held(self._path.with_name(self._path.name + ".lock")):
                    yield
                    return
            except BlockingIOError:
                if time.monotonic() >= deadline:
                    raise KeyRefusedError("Someone else is changing the keys", "Try again in a moment") from None
                time.sleep(0.05)

    def _load(self) -> bytes:
        """The file; FileNotFoundError where there is none."""
        return self._path.read_bytes()

    def _save(self, content: bytes) -> None:
        """Replace the file, by whoever is the one who changes it, or where there is none yet."""
        replace_file(self._path, content)

    def _read(self) -> dict[str, Slot]:
        try:
            slots = [whole(Slot(**slot)) for slot in self._content()["slots"]]
        except (ValueError, KeyError, TypeError):
            raise self._damaged() from None
        return {slot.code: slot for slot in slots}

    def _content(self) -> dict[str, Any]:
        try:
            content = json.loads(self._load())
            if content["format"] not in (FIRST_FORMAT, FORMAT):
                raise ValueError(content["format"])
        except FileNotFoundError:
            raise KeyRefusedError(
                tr("{file} is missing").format(file=self._path.name), "Restore the library from a backup"
            ) from None
        except (ValueError, KeyError, TypeError):
            raise self._damaged() from None
        made: dict[str, Any] = content
        return made

    def _damaged(self) -> KeyRefusedError:
        what = tr("{file} is damaged").format(file=self._path.name)
        return KeyRefusedError(what, "Restore the file from a backup of this library")

    def _given(self) -> frozenset[str]:
        return frozenset(map(str, self._content().get(GIVEN, ())))

    def _write(
        self, slots: dict[str, Slot], *, is_confirmed: bool | None = None, given: frozenset[str] | None = None
    ) -> None:
        """Keep the slots and what is recorded beside them; None: as it is."""
        if is_confirmed is None:
            is_confirmed = self.is_recovery_key_confirmed
        if given is None:
            given = self._given() if self.exists else frozenset()
        self._save(json.dumps(_file(slots, is_confirmed, given), indent=1).encode())


def _file(slots: dict[str, Slot], is_confirmed: bool, given: frozenset[str]) -> dict[str, object]:
    content: dict[str, object] = {"format": FORMAT, CONFIRMED: is_confirmed}
    if left := sorted(given & slots.keys()):
        content[GIVEN] = left
    return content | {"slots": [asdict(slot) for slot in slots.values()]}


def new_recovery_key() -> str:
    """160 random bits and a check letter, in groups to be copied by hand."""
    number = int.from_bytes(os.urandom(RECOVERY_BYTES), "big")
    letters = "".join(LETTERS[number >> (5 * k) & 31] for k in reversed(range(RECOVERY_BYTES * 8 // 5)))
    letters += LETTERS[number % 31]
    return "-".join(letters[k : k + GROUP] for k in range(0, len(letters), GROUP))


def is_end_of_recovery_key(typed: str, printed: str) -> bool:
    """Whether the last groups of what was printed were typed; spaces, dashes and misread letters do not count."""
    end = "".join(printed.split("-")[-ASKED:])
    return secrets.compare_digest(_letters(typed), _letters(end))


def _letters(text: str) -> str:
    return "".join(c for c in text.upper().translate(MISREAD) if c.isalnum() and c.isascii())


def _recovery_bytes(text: str) -> bytes:
    letters = _letters(text)
    count = RECOVERY_BYTES * 8 // 5
    if len(letters) != count + 1 or any(c not in LETTERS for c in letters):
        raise KeyRefusedError(
            tr("A recovery key has {required} characters; this one has {count}").format(
                required=count + 1, count=len(letters)
            ),
            "Compare the key with the recovery sheet",
        )
    number = 0
    for c in letters[:-1]:
        number = number << 5 | LETTERS.index(c)
    if LETTERS[number % 31] != letters[-1]:
        raise KeyRefusedError("A character of the recovery key is wrong", "Compare the key with the recovery sheet")
    return number.to_bytes(RECOVERY_BYTES, "big")


def _normal(code: str) -> str:
    return code.strip().casefold()


def _person(code: str) -> str:
    return code.removeprefix(KEYRING)


def _is_operators(code: str) -> bool:
    return code != RECOVERY and not code.startswith(KEYRING)


def _checked_code(code: str) -> str:
    code = _normal(code)
    if not (code.isalnum() and len(code) <= 12) or code == RECOVERY:
        what = tr("{code} is not a valid user code").format(code=code) if code else tr("A user needs a code")
        raise KeyRefusedError(what, "Use up to 12 letters and digits")
    return code


def _checked(passphrase: str, known: Iterable[str]) -> Secret:
    known = tuple(known)
    if strength_of(passphrase or "-", MIN_PASSPHRASE, known) not in (Strength.FAIR, Strength.STRONG):
        raise KeyRefusedError(*refusal_of_passphrase(passphrase, MIN_PASSPHRASE, known))
    return _secret(passphrase)


def _secret(passphrase: str) -> Secret:
    # the same letters from another keyboard may come as other code points
    letters = [letter.encode() for letter in unicodedata.normalize("NFKC", passphrase.strip())]
    secret = Secret(sum(map(len, letters)))
    for place, byte in enumerate(chain.from_iterable(letters)):  # at once, it would be copied on the way
        secret[place] = byte
    return secret
