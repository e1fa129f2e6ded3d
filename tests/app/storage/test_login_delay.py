"""Wrong passphrases make the next try wait, after a restart too, and nobody is locked out for ever."""

import json
import os
from pathlib import Path

import pytest

from app.storage import login_delay
from app.storage.keys import KeyRefusedError
from app.storage.login_delay import FILE, LONGEST_DELAY_S, UNKEPT_DELAY_S, LoginDelay


class Clock:
    """A monotonic clock that begins again with every program."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


def started(folder: Path, clock: Clock) -> LoginDelay:
    delay = LoginDelay(folder, clock)
    delay.read()
    return delay


def try_wrong(delay: LoginDelay, code: str, count: int = 1) -> None:
    for _ in range(count):
        with pytest.raises(KeyRefusedError), delay.trying(code):
            raise KeyRefusedError(
                "This passphrase does not open the library", "Enter the passphrase again, or use the recovery key"
            )


def test_wrong_passphrases_make_the_next_try_wait(tmp_path: Path, clock: Clock) -> None:
    delay = started(tmp_path, clock)
    try_wrong(delay, "hk", 2)
    assert delay.left_s("HK") == 0.0
    try_wrong(delay, "hk")
    assert delay.left_s("hk") == 2.0
    clock.now_s = 2.0
    assert delay.left_s("hk") == 0.0
    try_wrong(delay, "hk")
    assert delay.left_s("hk") == 4.0
    try_wrong(delay, "hk", 50)
    assert delay.left_s("hk") == LONGEST_DELAY_S
    assert delay.left_s("ab") == 0.0
    with delay.trying("hk"):
        pass
    assert delay.left_s("hk") == 0.0
    assert started(tmp_path, clock).left_s("hk") == 0.0


def test_a_restart_begins_the_wait_again_whatever_the_clock_states(tmp_path: Path, clock: Clock) -> None:
    try_wrong(started(tmp_path, clock), "hk", 5)
    for now_s in (0.0, 1e9, -1e9):
        later = Clock()
        later.now_s = now_s
        again = started(tmp_path, later)
        assert again.left_s("hk") == 8.0
        assert again.left_s("ab") == 0.0
    os.utime(tmp_path / FILE, (0, 0))
    assert started(tmp_path, clock).left_s("hk") == 8.0


def test_a_kill_while_a_passphrase_is_tried_counts_as_a_wrong_one(tmp_path: Path, clock: Clock) -> None:
    delay = started(tmp_path, clock)
    try_wrong(delay, "hk", 2)
    with delay.trying("hk"):
        assert started(tmp_path, clock).left_s("hk") == 2.0  # what a program would find after a kill at this point


def test_trouble_that_is_no_wrong_passphrase_is_not_counted(tmp_path: Path, clock: Clock) -> None:
    delay = started(tmp_path, clock)
    for _ in range(9):
        with pytest.raises(OSError, match="slow"), delay.trying("hk"):
            raise OSError("slow")
    assert delay.left_s("hk") == started(tmp_path, clock).left_s("hk") == 0.0


def test_where_nothing_can_be_kept_every_try_waits_and_none_for_ever(
    tmp_path: Path, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_path: Path, _content: bytes) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(login_delay, "replace_file", refuse)
    delay = started(tmp_path, clock)
    assert delay.left_s("hk") == UNKEPT_DELAY_S  # no open door: a restart gives no free tries
    clock.now_s = UNKEPT_DELAY_S
    assert delay.left_s("hk") == 0.0
    try_wrong(delay, "hk")
    assert delay.left_s("hk") == UNKEPT_DELAY_S
    try_wrong(delay, "hk", 99)
    assert delay.left_s("hk") == LONGEST_DELAY_S  # and no lock-out
    clock.now_s += LONGEST_DELAY_S
    with delay.trying("hk"):
        pass
    assert delay.left_s("hk") == 0.0


@pytest.mark.parametrize(
    "content",
    [b"", b"{", b"[]", b'{"format": "gaitwright-tries/9"}', b'{"format": "gaitwright-tries/1", "wrong": {"hk": null}}'],
)
def test_a_damaged_count_is_neither_a_free_try_nor_a_lock_out(tmp_path: Path, clock: Clock, content: bytes) -> None:
    (tmp_path / FILE).write_bytes(content)
    assert started(tmp_path, clock).left_s("hk") == UNKEPT_DELAY_S
    assert started(tmp_path, clock).left_s("hk") == 0.0  # it was made whole


def test_a_count_beyond_all_measure_waits_the_longest_delay(tmp_path: Path, clock: Clock) -> None:
    (tmp_path / FILE).write_text(json.dumps({"format": login_delay.FORMAT, "wrong": {"hk": 10**30}}))
    assert started(tmp_path, clock).left_s("hk") == LONGEST_DELAY_S
