"""Passphrases and the recovery key open the library, nothing else does, and a kill never locks anyone out."""

import json
import random
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from app.storage import keys
from app.storage.data_key import KEY_BYTES, Secret
from app.storage.files import held, replace_file
from app.storage.keys import (
    KeyRefusedError,
    KeySlots,
    is_end_of_recovery_key,
    new_recovery_key,
)
from app.storage.slots import Cost, Slot

OLD, NEW = "four short words here", "another four short words"
CHEAP = Cost(passes=1, memory_kib=64)
CHANGE = """
import sys
from pathlib import Path
from app.storage.keys import KeySlots
from app.storage.slots import Cost
slots = KeySlots(Path(sys.argv[1]), Cost(passes=1, memory_kib=64))
data_key = slots.open("hk", sys.argv[2])
print("ready", flush=True)
while True:
    slots.set_passphrase(data_key, "hk", sys.argv[3])
    slots.set_passphrase(data_key, "hk", sys.argv[2])
"""


@pytest.fixture
def slots(tmp_path: Path) -> KeySlots:
    return KeySlots(tmp_path / "keys.json", CHEAP)


def test_the_passphrase_and_the_recovery_key_give_the_same_key(slots: KeySlots) -> None:
    data_key, recovery = slots.create("HK", OLD)
    assert len(data_key) == 32
    assert slots.open("hk", OLD) == data_key
    assert slots.open_with_recovery_key(recovery.lower().replace("-", " ")) == data_key
    assert slots.codes == ("hk",)


def test_a_passphrase_that_somebody_else_chose_is_marked_until_its_operator_chooses_another(slots: KeySlots) -> None:
    data_key, _ = slots.create("hk", OLD)
    slots.add(data_key, "AB", NEW, is_given=True)
    assert slots.is_given("ab")
    assert not slots.is_given("hk")
    slots.set_keyring_slot(data_key, "ab", b"any other change of the file")
    slots.set_passphrase(data_key, "hk", "words that nobody else knows")
    assert slots.is_given("ab")
    changed = slots.sealed_again(data_key, bytes(32), ("hk", "ab"))
    assert changed.content["given_passphrases"] == ["ab"]
    with pytest.raises(KeyRefusedError, match="Another person chose this passphrase"):
        slots.set_passphrase(data_key, "ab", f" {NEW} ")
    slots.set_passphrase(data_key, "ab", OLD)
    assert not slots.is_given("ab")
    assert slots.open("ab", OLD) == data_key


def test_a_mark_that_is_taken_away_lets_nobody_in(slots: KeySlots, tmp_path: Path) -> None:
    data_key, _ = slots.create("hk", OLD)
    slots.add(data_key, "ab", NEW, is_given=True)
    content = json.loads((tmp_path / "keys.json").read_bytes())
    del content["given_passphrases"]
    (tmp_path / "keys.json").write_text(json.dumps(content))
    assert not slots.is_given("ab")
    assert slots.open("ab", NEW) == data_key
    with pytest.raises(KeyRefusedError, match="does not open"):
        slots.open("ab", OLD)


def test_a_guess_costs_three_passes_over_64_mib(tmp_path: Path) -> None:
    KeySlots(tmp_path / "keys.json").create("hk", OLD)
    slots = json.loads((tmp_path / "keys.json").read_bytes())["slots"]
    assert {(slot["code"], slot["passes"], slot["memory_kib"]) for slot in slots} == {
        ("hk", 3, 65536),
        ("recovery", 3, 65536),
    }


def test_no_other_passphrase_code_or_recovery_key_opens(slots: KeySlots, tmp_path: Path) -> None:
    _, recovery = slots.create("hk", OLD)
    for code, passphrase in (("hk", NEW), ("hk", ""), ("xx", OLD), ("recovery", recovery)):
        with pytest.raises(KeyRefusedError, match="does not open"):
            slots.open(code, passphrase)
    _, foreign = KeySlots(tmp_path / "other.json", CHEAP).create("hk", OLD)
    with pytest.raises(KeyRefusedError, match="another library"):
        slots.open_with_recovery_key(foreign)


def test_a_passphrase_means_its_letters_not_their_code_points(slots: KeySlots) -> None:
    data_key, _ = slots.create("hk", "Gr\u00fc\u00dfe aus Z\u00fcrich")
    assert slots.open("hk", " Gru\u0308\u00dfe aus Zu\u0308rich ") == data_key


def test_operators_come_and_go_but_the_last_one_stays(slots: KeySlots) -> None:
    data_key, _ = slots.create("hk", OLD)
    slots.add(data_key, "ab", NEW)
    assert slots.open("ab", NEW) == data_key
    with pytest.raises(KeyRefusedError, match="already in use"):
        slots.add(data_key, "AB", NEW)
    slots.remove("hk")
    with pytest.raises(KeyRefusedError, match="does not open"):
        slots.open("hk", OLD)
    with pytest.raises(KeyRefusedError, match="The last user's key cannot be removed"):
        slots.remove("ab")


def test_a_new_recovery_key_ends_the_old_one(slots: KeySlots) -> None:
    data_key, old = slots.create("hk", OLD)
    new = slots.renew_recovery_key(data_key)
    assert slots.open_with_recovery_key(new) == data_key
    with pytest.raises(KeyRefusedError):
        slots.open_with_recovery_key(old)


@pytest.mark.parametrize("passphrase", ["short", "          ", ""])
def test_short_passphrases_are_refused(slots: KeySlots, passphrase: str) -> None:
    with pytest.raises(KeyRefusedError, match="characters are needed"):
        slots.create("hk", passphrase)
    assert not slots.exists


@pytest.mark.parametrize("passphrase", ["aaaaaaaaaa", "1234567890", "Passwort2024", "keller-wollishofen"])
def test_weak_passphrases_are_refused_with_the_reason(slots: KeySlots, passphrase: str) -> None:
    with pytest.raises(KeyRefusedError, match=r"could guess it within .*Use four or five unrelated words"):
        slots.create("hk", passphrase, ("H. Keller", "Wollishofen"))
    assert not slots.exists
    data_key, _ = slots.create("hk", OLD)
    for change in (slots.set_passphrase, slots.add):
        with pytest.raises(KeyRefusedError, match="could guess it"):
            change(data_key, "hk" if change == slots.set_passphrase else "ab", passphrase, ("Keller", "Wollishofen"))
    assert slots.open("hk", OLD) == data_key


@pytest.mark.parametrize("code", ["", "recovery", "a name", "x" * 13])
def test_codes_that_could_be_names_or_nothing_are_refused(slots: KeySlots, code: str) -> None:
    with pytest.raises(KeyRefusedError, match=r"is not a valid user code|needs a code"):
        slots.create(code, OLD)


def test_the_file_holds_neither_key_nor_passphrase(slots: KeySlots, tmp_path: Path) -> None:
    data_key, recovery = slots.create("hk", OLD)
    content = (tmp_path / "keys.json").read_bytes()
    assert bytes(data_key) not in content
    assert OLD.encode() not in content
    assert recovery.encode() not in content
    assert (tmp_path / "keys.json").stat().st_mode & 0o077 == 0


def test_what_is_made_of_a_passphrase_is_overwritten_once_it_was_used(
    slots: KeySlots, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = "v\u00f6ier s\u00e4tz do f\u00fcr \u00fcs"
    slots.create("hk", own)
    wipe, wiped = Secret.wipe, list[bytes]()

    def noted(secret: Secret) -> None:
        wiped.append(bytes(secret))
        wipe(secret)

    monkeypatch.setattr(Secret, "wipe", noted)
    data_key = slots.open("hk", own)
    assert own.encode() in wiped
    assert len([one for one in wiped if len(one) == KEY_BYTES and any(one)]) >= 2  # Argon2id's, and the slot's own
    assert bytes(data_key) not in wiped
    with memoryview(data_key) as where_it_stood:
        with pytest.raises(BufferError):  # it is not cleared while it is seen
            data_key.wipe()
        assert not any(where_it_stood)


def test_a_slot_whose_words_were_changed_does_not_open(slots: KeySlots, tmp_path: Path) -> None:
    slots.create("hk", OLD)
    path = tmp_path / "keys.json"
    content = json.loads(path.read_bytes())
    content["slots"][0]["code"] = "ab"
    path.write_text(json.dumps(content))
    with pytest.raises(KeyRefusedError):
        slots.open("ab", OLD)


@pytest.mark.parametrize("content", [b"", b"{}", b"[1]", b'{"format": "gaitwright-keys/9", "slots": []}'])
def test_a_damaged_file_is_stated_to_be_damaged(slots: KeySlots, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "keys.json").write_bytes(content)
    with pytest.raises(KeyRefusedError, match="damaged"):
        slots.open("hk", OLD)


def test_a_missing_file_states_where_to_find_it(slots: KeySlots) -> None:
    with pytest.raises(KeyRefusedError, match="backup"):
        slots.open("hk", OLD)


def test_a_mistyped_letter_of_the_recovery_key_is_noticed() -> None:
    key = new_recovery_key()
    slots = KeySlots(Path("nowhere"))  # what is mistyped is noticed before the file is read
    for k, letter in enumerate(key):
        if letter != "-":
            wrong = key[:k] + ("2" if letter != "2" else "3") + key[k + 1 :]
            with pytest.raises(KeyRefusedError, match="A character of the recovery key is wrong"):
                slots.open_with_recovery_key(wrong)


def test_nothing_but_the_last_two_groups_confirms_a_key() -> None:
    key = "0123-4567-89AB-CDEF-GHJK-MNPQ-RSTV-W10Z-Y"
    for typed in ("W10Z-Y", "w1oz y", " WLOZY "):
        assert is_end_of_recovery_key(typed, key)
    for typed in ("", "Y", "W10Z", "W10ZZ", "Y-W10Z", "RSTV-W10Z-Y", key, key[:-1]):
        assert not is_end_of_recovery_key(typed, key)


def test_wrapping_the_same_key_twice_shows_no_likeness() -> None:
    one, other = (Slot.wrapping(b"k" * 32, "hk", b"same secret", CHEAP) for _ in range(2))
    assert one.salt != other.salt
    assert one.wrapped != other.wrapped


def test_a_file_that_cannot_be_replaced_stays(tmp_path: Path) -> None:
    path = tmp_path / "keys.json"
    replace_file(path, b"old")
    (tmp_path / "keys.json.new").mkdir()
    with pytest.raises(OSError, match="keys"):
        replace_file(path, b"new")
    assert path.read_bytes() == b"old"


def kill_while_changing(path: Path, rng: random.Random) -> None:
    child = subprocess.Popen([sys.executable, "-c", CHANGE, str(path), OLD, NEW], stdout=subprocess.PIPE)
    assert child.stdout is not None
    child.stdout.readline()
    time.sleep(rng.uniform(0.0, 0.6))
    child.kill()
    child.wait()
    child.stdout.close()


def check_kills(folder: Path, count: int) -> None:
    slots = KeySlots(folder / "keys.json")
    data_key, recovery = slots.create("hk", OLD)
    rng = random.Random(7)
    for _ in range(count):
        kill_while_changing(folder / "keys.json", rng)
        opened = []
        for passphrase in (OLD, NEW):
            try:
                opened.append(slots.open("hk", passphrase))
            except KeyRefusedError:
                continue
        assert opened == [data_key]
        assert slots.open_with_recovery_key(recovery) == data_key
        slots.set_passphrase(data_key, "hk", OLD)


@pytest.mark.endurance
def test_a_kill_during_a_change_leaves_the_old_or_the_new_passphrase(tmp_path: Path) -> None:
    check_kills(tmp_path, 2)


@pytest.mark.endurance
def test_forty_kills_during_changes(tmp_path: Path) -> None:
    """T11 of the reliability targets asks for a hundred; of the data key: `tests.safety.key_change_kills`."""
    check_kills(tmp_path, 40)


def test_the_recovery_keys_slot_is_not_removed(slots: KeySlots) -> None:
    data_key, text = slots.create("hk", OLD)
    for code in ("recovery", " Recovery "):
        with pytest.raises(KeyRefusedError, match=r"is not a valid user code|needs a code"):
            slots.remove(code)
    assert slots.open_with_recovery_key(text) == data_key


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("salt", "!"),
        ("salt", 5),
        ("nonce", ""),
        ("wrapped", "AAAA"),
        ("passes", 0),
        ("passes", 10**9),
        ("memory_kib", 2**40),
        ("memory_kib", "64"),
    ],
)
def test_a_damaged_slot_is_stated_to_be_damaged(slots: KeySlots, tmp_path: Path, field: str, value: object) -> None:
    slots.create("hk", OLD)
    content = json.loads((tmp_path / "keys.json").read_text())
    content["slots"][0][field] = value
    (tmp_path / "keys.json").write_text(json.dumps(content))
    with pytest.raises(KeyRefusedError, match="is damaged"):
        slots.open("hk", OLD)


def test_of_two_changes_at_once_neither_is_lost(slots: KeySlots, tmp_path: Path) -> None:
    data_key, _ = slots.create("hk", OLD)
    codes = [f"op{k}" for k in range(12)]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda code: KeySlots(tmp_path / "keys.json", CHEAP).add(data_key, code, NEW), codes))
    assert set(slots.codes) == {"hk", *codes}


def test_a_change_that_another_program_holds_up_for_long_is_refused(
    slots: KeySlots, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data_key, _ = slots.create("hk", OLD)
    monkeypatch.setattr(keys, "BUSY_S", 0.1)
    with held(tmp_path / "keys.json.lock"), pytest.raises(KeyRefusedError, match="Someone else is changing the keys"):
        slots.add(data_key, "ab", NEW)
    slots.add(data_key, "ab", NEW)
