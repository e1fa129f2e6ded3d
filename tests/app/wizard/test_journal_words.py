"""What is stated about a journal comes when its counters say so, and not when they do not."""

from dataclasses import replace

import pytest

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
from app.wizard.losses import NOTHING

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


def test_a_late_disk_that_answers_again_states_what_it_cost() -> None:
    assert trouble_message(Trouble.DISK_SLOW, AGAIN) == (
        "The disk was slow and now responds again.",
        "No data were lost because of this.",
    )
    _, then = trouble_message(Trouble.DISK_SLOW, AGAIN, lost=90)
    assert then == "No data were discarded because of this."


@pytest.mark.parametrize("trouble", [Trouble.DISK_SLOW, Trouble.DROPPED])
def test_what_was_dropped_is_counted(trouble: Trouble) -> None:
    what, then = trouble_message(trouble, DROPPING)
    assert "The disk did not respond for too long, so samples were lost" in what
    assert then.startswith("7 data packets were lost so far and stay gaps. ")


@pytest.mark.parametrize("trouble", sorted(ENDS))
def test_a_disk_that_ended_the_recording_states_up_to_where_it_is_kept(trouble: Trouble) -> None:
    _, then = trouble_message(trouble, CLOSED)
    assert ("The first 1:02 min of the recording are written." in then) is (trouble is not Trouble.DISK_GONE)
    assert ("The first 1:01 min of the recording are confirmed on the disk." in then) is (trouble is Trouble.DISK_GONE)
    _, then = trouble_message(trouble, replace(CLOSED, dropped_records=2))
    assert ("are written; everything after that is lost" in then) is (trouble is not Trouble.DISK_GONE)


@pytest.mark.parametrize("is_tried_again", [True, False])
def test_only_a_journal_that_is_closed_whole_is_called_safe(is_tried_again: bool) -> None:
    def stated(status: JournalStatus) -> str:
        return unread_message(status, is_tried_again=is_tried_again)

    assert "safe on the disk" in stated(CLOSED)
    assert "still being written" in stated(FINE)
    for status in (replace(CLOSED, dropped_records=1), replace(CLOSED, state=State.BROKEN)):
        assert "safe" not in stated(status)
        assert stated(status).startswith("The first 1:01 min of the recording are on the disk")


def test_a_recording_without_a_row_is_called_written_only_while_all_of_it_is() -> None:
    assert "The recording is still written to the disk" in no_row_message(FINE)[1]
    assert "written" not in no_row_message(DROPPING)[1]


def test_what_comes_in_is_called_saved_only_while_the_journal_takes_all_of_it() -> None:
    assert is_written(FINE)
    for status in (LATE, replace(FINE, dropped_records=1), CLOSED, replace(FINE, state=State.BROKEN)):
        assert not is_written(status)


def standstill(
    lost: dict[str, int], now_s: float = 75.0, *, are_received: bool = True, are_counted: bool = True
) -> str:
    return " ".join(standstill_message(STOOD, 10.0, now_s, lost, are_received, are_counted)).strip()


def test_a_standstill_that_cost_samples_states_so() -> None:
    assert standstill({"a": 4005, "b": 2000}) == (
        "Gaitwright stalled for 20 s, 0:41 min into the recording. Samples were lost and leave gaps. Missing "
        "samples are counted when the recording is loaded."
    )
    assert "were lost" in standstill({"a": 5, "b": 1})
    assert "were lost" not in standstill({"a": 5, "b": 0})


def test_no_sample_is_missing_only_where_all_sensors_are_received_counted_and_whole() -> None:
    none = "No sample is missing"
    whole = {"a": 5, "b": 0}
    assert none in standstill(whole)
    assert none not in standstill({"a": 6, "b": 0})
    assert none not in standstill(whole, are_received=False)
    assert none not in standstill(whole, are_counted=False)
    assert none not in standstill(whole, now_s=71.5)  # what waited is still being read
    assert standstill(whole, are_received=False).endswith("Missing samples are being counted.")


def test_a_standstill_of_before_or_long_ago_is_not_reported_and_sleep_is_called_so() -> None:
    assert standstill_message(STOOD, 72.0, 75.0, {}, True, True) == NOTHING
    assert standstill_message(STOOD, 10.0, 72.0 + STANDSTILL_REPORTED_S, {}, True, True) == NOTHING
    asleep = replace(STOOD, asleep_s=19.0)
    assert standstill_message(asleep, 10.0, 75.0, {}, True, True)[0].startswith("The computer was asleep for 20 s")
