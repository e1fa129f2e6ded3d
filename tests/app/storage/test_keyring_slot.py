"""The system's keyring opens the library if it was asked to, and its troubles never keep anybody out."""

import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from app.storage.data_key import DataKey
from app.storage.keyring_slot import SERVICE, forget, is_there_a_keyring, open_remembered, remember
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.slots import Cost

OLD, NEW = "four short words here", "another four short words"
CHEAP = Cost(passes=1, memory_kib=64)


class Keyring:
    """A keyring as the package hands out, in memory. Locked, it fails as a system's own errors do."""

    def __init__(self, priority: float = 5) -> None:
        self.priority = priority
        self.is_locked = False
        self.held: dict[tuple[str, str], str] = {}

    def get_password(self, service: str, name: str) -> str | None:
        self._check()
        return self.held.get((service, name))

    def set_password(self, service: str, name: str, secret: str) -> None:
        self._check()
        self.held[service, name] = secret

    def delete_password(self, service: str, name: str) -> None:
        self._check()
        del self.held[service, name]

    def _check(self) -> None:
        if self.is_locked:
            raise ConnectionError("org.freedesktop.Secret.Error.IsLocked")


def use(monkeypatch: pytest.MonkeyPatch, keyring: Keyring) -> Keyring:
    """Put it in place of the package, whether or not that is installed."""
    package = ModuleType("keyring")
    monkeypatch.setattr(package, "get_keyring", lambda: keyring, raising=False)
    monkeypatch.setitem(sys.modules, "keyring", package)
    return keyring


@pytest.fixture
def keyring(monkeypatch: pytest.MonkeyPatch) -> Keyring:
    return use(monkeypatch, Keyring())


@pytest.fixture
def slots(tmp_path: Path) -> KeySlots:
    return KeySlots(tmp_path / "keys.json", CHEAP)


@pytest.fixture
def data_key(slots: KeySlots) -> DataKey:
    return slots.create("hk", OLD)[0]


def test_what_is_remembered_opens_without_a_passphrase(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    assert is_there_a_keyring()
    assert open_remembered(slots, "hk") is None
    remember(slots, data_key, " HK ")
    assert open_remembered(slots, "Hk") == data_key
    assert slots.open("hk", OLD) == data_key


def test_neither_the_keyring_nor_the_file_alone_opens(
    slots: KeySlots, data_key: DataKey, keyring: Keyring, tmp_path: Path
) -> None:
    remember(slots, data_key, "hk")
    ((service, name), secret), *more = keyring.held.items()
    assert (service, more) == (SERVICE, [])
    assert len(bytes.fromhex(secret)) == 32
    assert data_key.hex() not in name + secret
    assert secret not in (tmp_path / "keys.json").read_text()
    keyring.held.clear()
    assert open_remembered(slots, "hk") is None


def test_a_keyrings_slot_is_no_operator(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    remember(slots, data_key, "hk")
    (secret,) = keyring.held.values()
    assert slots.codes == ("hk",)
    with pytest.raises(KeyRefusedError, match="does not open"):
        slots.open("keyring-hk", secret)
    with pytest.raises(KeyRefusedError, match="is not a valid user code"):
        slots.add(data_key, "keyring-ab", NEW)
    with pytest.raises(KeyRefusedError, match="is not a valid user code"):
        slots.set_passphrase(data_key, "keyring-hk", NEW)
    with pytest.raises(KeyRefusedError, match="The last user's key cannot be removed"):
        slots.remove("hk")
    assert open_remembered(slots, "hk") == data_key


def test_a_new_passphrase_or_recovery_key_leaves_it(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    remember(slots, data_key, "hk")
    slots.set_passphrase(data_key, "hk", NEW)
    recovery = slots.renew_recovery_key(data_key)
    assert open_remembered(slots, "hk") == data_key
    assert slots.open_with_recovery_key(recovery) == data_key


def test_it_goes_with_its_operator_and_with_no_other(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    slots.add(data_key, "ab", NEW)
    remember(slots, data_key, "ab")
    remember(slots, data_key, "hk")
    slots.remove("ab")
    assert open_remembered(slots, "ab") is None
    assert open_remembered(slots, "hk") == data_key
    slots.add(data_key, "ab", NEW)
    assert open_remembered(slots, "ab") is None


def test_only_who_has_a_passphrase_is_remembered(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    with pytest.raises(KeyRefusedError, match="Add the user first"):
        remember(slots, data_key, "ab")
    assert keyring.held == {}


def test_remembering_again_leaves_one_secret_and_forgetting_none(
    slots: KeySlots, data_key: DataKey, keyring: Keyring
) -> None:
    remember(slots, data_key, "hk")
    first = dict(keyring.held)
    remember(slots, data_key, "hk")
    assert len(keyring.held) == 1
    assert keyring.held != first
    assert open_remembered(slots, "hk") == data_key
    forget(slots, "hk")
    assert keyring.held == {}
    assert open_remembered(slots, "hk") is None
    forget(slots, "hk")
    assert slots.open("hk", OLD) == data_key


def test_two_libraries_of_one_operator_do_not_meet(
    slots: KeySlots, data_key: DataKey, keyring: Keyring, tmp_path: Path
) -> None:
    other = KeySlots(tmp_path / "other.json", CHEAP)
    other_key, _ = other.create("hk", OLD)
    remember(slots, data_key, "hk")
    remember(other, other_key, "hk")
    assert (open_remembered(slots, "hk"), open_remembered(other, "hk")) == (data_key, other_key)


@pytest.mark.parametrize("secret", ["00" * 32, "", "no secret of ours"])
def test_another_secret_asks_for_the_passphrase(
    slots: KeySlots, data_key: DataKey, keyring: Keyring, secret: str
) -> None:
    remember(slots, data_key, "hk")
    keyring.held = dict.fromkeys(keyring.held, secret)
    assert open_remembered(slots, "hk") is None


def test_a_slot_moved_to_another_operator_does_not_open(
    slots: KeySlots, data_key: DataKey, keyring: Keyring, tmp_path: Path
) -> None:
    remember(slots, data_key, "hk")
    content = json.loads((tmp_path / "keys.json").read_text())
    content["slots"][-1]["code"] = "keyring-ab"
    (tmp_path / "keys.json").write_text(json.dumps(content))
    assert open_remembered(slots, "ab") is None


def test_a_locked_keyring_asks_for_the_passphrase_and_forgets_all_the_same(
    slots: KeySlots, data_key: DataKey, keyring: Keyring
) -> None:
    remember(slots, data_key, "hk")
    keyring.is_locked = True
    assert open_remembered(slots, "hk") is None
    forget(slots, "hk")
    keyring.is_locked = False
    assert open_remembered(slots, "hk") is None


def test_a_keyring_that_takes_nothing_leaves_no_slot(slots: KeySlots, data_key: DataKey, keyring: Keyring) -> None:
    keyring.is_locked = True
    with pytest.raises(KeyRefusedError, match="The keyring does not accept the key"):
        remember(slots, data_key, "hk")
    assert slots.keyring_slot("hk") is None
    assert slots.open("hk", OLD) == data_key


def check_nothing_is_remembered(slots: KeySlots, data_key: DataKey) -> None:
    assert not is_there_a_keyring()
    with pytest.raises(KeyRefusedError, match="has no keyring"):
        remember(slots, data_key, "hk")
    slots.set_keyring_slot(data_key, "hk", b"remembered elsewhere")
    assert open_remembered(slots, "hk") is None
    forget(slots, "hk")
    assert slots.keyring_slot("hk") is None


def test_without_the_package_the_passphrase_opens(
    slots: KeySlots, data_key: DataKey, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "keyring", None)
    check_nothing_is_remembered(slots, data_key)


@pytest.mark.parametrize("priority", [0, 0.5, -1], ids=["none", "in the open", "forgets all"])
def test_a_keyring_that_keeps_nothing_safe_is_none(
    slots: KeySlots, data_key: DataKey, monkeypatch: pytest.MonkeyPatch, priority: float
) -> None:
    use(monkeypatch, Keyring(priority))
    check_nothing_is_remembered(slots, data_key)


def test_a_keyring_that_does_not_load_is_none(
    slots: KeySlots, data_key: DataKey, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = ModuleType("keyring")  # without a get_keyring: what a broken set-up raises is anything
    monkeypatch.setitem(sys.modules, "keyring", package)
    check_nothing_is_remembered(slots, data_key)
