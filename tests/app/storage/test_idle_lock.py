"""The screen is covered when nobody works, whatever the clock does, and not while somebody does."""

from collections.abc import Callable
from pathlib import Path

import pytest

from app.storage.idle_lock import IdleLock
from app.storage.journal.records import RecordKind
from app.storage.journal.writer import JournalWriter, State
from tests.safety.journal_material import ID, KEY, NO_ROOM_ASKED, read_all


class FakeController:
    """A clock to be set, and a lock that counts how often it fell."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.locks = 0
        self.while_locking: Callable[[], None] = lambda: None
        self.idle = IdleLock(lambda: self.now_s, self.lock)

    def lock(self) -> None:
        self.locks += 1
        self.while_locking()

    def wait(self, duration_s: float, step_s: float = 5.0) -> None:
        """Let time pass, polled as by the application's timer."""
        for _ in range(round(duration_s / step_s)):
            self.now_s += step_s
            self.idle.poll()


def test_it_locks_after_five_idle_minutes_and_once() -> None:
    controller = FakeController()
    controller.wait(295.0)
    assert (controller.locks, controller.idle.is_locked) == (0, False)
    controller.wait(5.0)
    assert (controller.locks, controller.idle.is_locked) == (1, True)
    controller.wait(3600.0)
    assert controller.locks == 1


def test_who_works_is_not_locked_out() -> None:
    controller = FakeController()
    for _ in range(20):
        controller.wait(290.0)
        controller.idle.note_activity()
    assert controller.locks == 0
    controller.wait(300.0)
    assert controller.locks == 1


def test_only_the_passphrase_unlocks_and_the_minutes_begin_again() -> None:
    controller = FakeController()
    controller.wait(300.0)
    controller.idle.note_activity()
    assert controller.idle.is_locked
    controller.now_s += 900.0
    controller.idle.unlock()
    controller.wait(295.0)
    assert (controller.locks, controller.idle.is_locked) == (1, False)
    controller.wait(5.0)
    assert controller.locks == 2


def test_after_a_long_sleep_the_first_poll_locks() -> None:
    controller = FakeController()
    controller.wait(10.0)
    controller.now_s += 3600.0
    controller.idle.poll()
    assert controller.locks == 1


def test_the_mouse_that_wakes_the_machine_does_not_keep_it_open() -> None:
    controller = FakeController()
    controller.now_s += 3600.0
    controller.idle.note_activity()
    assert (controller.locks, controller.idle.is_locked) == (1, True)


def test_a_short_sleep_counts_as_idle_time() -> None:
    controller = FakeController()
    controller.wait(200.0)
    controller.now_s += 95.0
    controller.idle.poll()
    assert controller.locks == 0
    controller.wait(5.0)
    assert controller.locks == 1


def test_a_clock_set_back_keeps_nothing_open_for_longer() -> None:
    controller = FakeController()
    controller.wait(200.0)
    controller.now_s -= 7200.0
    controller.idle.poll()
    controller.wait(95.0)
    assert controller.locks == 0
    controller.wait(5.0)
    assert controller.locks == 1


def test_a_poll_while_it_locks_does_not_lock_twice() -> None:
    controller = FakeController()
    controller.while_locking = lambda: controller.idle.poll()
    controller.wait(600.0)
    assert controller.locks == 1


def test_a_recording_goes_on_when_the_screen_locks_and_the_key_is_forgotten(tmp_path: Path) -> None:
    controller = FakeController()
    data_keys = [KEY]
    controller.while_locking = data_keys.clear  # the application forgets the key, the journal has its own
    with JournalWriter.create(tmp_path, ID, data_keys[0], room=NO_ROOM_ASKED) as journal:
        assert journal.mark("seen")
        controller.wait(300.0)
        assert (controller.idle.is_locked, data_keys) == (True, [])
        assert journal.mark("unseen")
        assert journal.status.state is State.RECORDING
        summary = journal.stop()
    records, damages, report = read_all(summary.path, KEY)
    assert [record.payload for record in records if record.kind is RecordKind.MARK] == [b'"seen"', b'"unseen"']
    assert (damages, report.is_whole) == ([], True)


def test_who_leaves_the_desk_locks_at_once_and_only_once() -> None:
    locked: list[None] = []
    idle = IdleLock(lambda: 0.0, lambda: locked.append(None))
    idle.lock_now()
    idle.lock_now()
    assert idle.is_locked
    assert len(locked) == 1
    idle.unlock()
    idle.lock_now()
    assert len(locked) == 2


@pytest.mark.parametrize("is_asked_for", [True, False])
def test_a_lock_knows_whether_somebody_asked_for_it(is_asked_for: bool) -> None:
    now_s = [0.0]
    idle = IdleLock(lambda: now_s[0], lambda: None)
    now_s[0] = 301.0
    (idle.lock_now if is_asked_for else idle.poll)()
    assert (idle.is_locked, idle.is_asked_for) == (True, is_asked_for)
    idle.unlock()
    assert idle.is_asked_for is False
