"""What is stated about a journal comes when its counters say so, and not when they do not."""

from dataclasses import replace

import pytest
from syrupy.assertion import SnapshotAssertion

from app.acquisition.heartbeat import ProcessStall
from app.storage.journal.disk import Trouble
from app.storage.journal.writer import JournalStatus, State
from app.wizard.journal_words import (
    ENDS,
    STANDSTILL_REPORTED_S,
    is_written,
    no_row_message,
    standstill_message,
    trouble_message,
    unread_message,
)

FINE = JournalStatus(
    state=State.RECORDING,
    records=100,
    bytes=10_000,
    stuck_s=0.0,
    left_s=1000.0,
    written_s=62.0,
    synced_s=61.0,
    dropped_records=0,
    dropped_bytes=0,
    troubles=frozenset(),
)
LATE, AGAIN = replace(FINE, stuck_s=3.0), FINE
DROPPING = replace(LATE, dropped_records=7)
CLOSED = replace(FINE, state=State.CLOSED)
STOOD = ProcessStall(began_s=51.0, ended_s=71.0, lasted_s=20.0, asleep_s=0.0, lost_before={"a": 5, "b": 0})


@pytest.mark.parametrize(
    ("status", "lost", "is_stated"), [(LATE, 0, True), (LATE, 1, False), (DROPPING, 0, False), (AGAIN, 0, False)]
)
def test_nothing_is_lost_yet_only_while_the_disk_is_late_and_every_counter_is_nought(
    status: JournalStatus, lost: int, is_stated: bool
) -> None:
    stated = " ".join(trouble_message(Trouble.DISK_SLOW, status, lost))
    assert ("No data lost so far" in stated) is is_stated
    assert ("responds slowly" in stated) is (status is LATE)


@pytest.mark.parametrize("trouble", [Trouble.DISK_SLOW, Trouble.DROPPED])
def test_what_was_dropped_is_counted(trouble: Trouble) -> None:
    what, then = trouble_message(trouble, DROPPING)
    assert "The disk did not respond for too long, so samples were lost" in what
    assert then.startswith("7 data packets were lost so far and stay gaps. ")


@pytest.mark.parametrize("is_tried_again", [True, False])
def test_only_a_journal_that_is_closed_whole_is_called_safe(is_tried_again: bool) -> None:
    def stated(status: JournalStatus) -> str:
        return unread_message(status, is_tried_again=is_tried_again)

    assert "safe on the disk" in stated(CLOSED)
    assert "still being written" in stated(FINE)
    for status in (replace(CLOSED, dropped_records=1), replace(CLOSED, state=State.BROKEN)):
        assert "safe" not in stated(status)
        assert stated(status).startswith("The first 1:01 min of the recording are on the disk")


def test_what_comes_in_is_called_saved_only_while_the_journal_takes_all_of_it() -> None:
    assert is_written(FINE)
    for status in (LATE, replace(FINE, dropped_records=1), CLOSED, replace(FINE, state=State.BROKEN)):
        assert not is_written(status)


def test_what_a_disk_cost_and_up_to_where_a_recording_is_kept_is_stated(snapshot: SnapshotAssertion) -> None:
    dropped = replace(CLOSED, dropped_records=2)
    assert {
        "late, and answers again": trouble_message(Trouble.DISK_SLOW, AGAIN),
        "late, and answers again, but samples were lost otherwise": trouble_message(Trouble.DISK_SLOW, AGAIN, lost=90),
        **{f"{one.name} ended it": trouble_message(one, CLOSED) for one in sorted(ENDS)},
        **{f"{one.name} after a loss": trouble_message(one, dropped) for one in sorted(ENDS)},
        "without a row, all is still written": no_row_message(FINE),
        "without a row, and something was dropped": no_row_message(DROPPING),
    } == snapshot


def test_a_standstill_states_what_it_cost_as_soon_as_that_is_known(snapshot: SnapshotAssertion) -> None:
    """No sample is missing only where all sensors are received, counted and whole."""
    whole, long_ago_s = {"a": 5, "b": 0}, 72.0 + STANDSTILL_REPORTED_S
    assert {
        "samples of both": standstill_message(STOOD, 10.0, 75.0, {"a": 4005, "b": 2000}, True, True),
        "one sample of one": standstill_message(STOOD, 10.0, 75.0, {"a": 5, "b": 1}, True, True),
        "one more than was lost before": standstill_message(STOOD, 10.0, 75.0, {"a": 6, "b": 0}, True, True),
        "whole": standstill_message(STOOD, 10.0, 75.0, whole, True, True),
        "not all are received": standstill_message(STOOD, 10.0, 75.0, whole, False, True),
        "not all are counted": standstill_message(STOOD, 10.0, 75.0, whole, True, False),
        "what waited is still being read": standstill_message(STOOD, 10.0, 71.5, whole, True, True),
        "asleep": standstill_message(replace(STOOD, asleep_s=19.0), 10.0, 75.0, {}, True, True),
        "before the recording": standstill_message(STOOD, 72.0, 75.0, {}, True, True),
        "long ago": standstill_message(STOOD, 10.0, long_ago_s, {}, True, True),
    } == snapshot
