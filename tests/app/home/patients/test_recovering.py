"""What is stated about recordings that nobody stopped is what their journals hold."""

from dataclasses import replace
from pathlib import Path
from typing import cast
from uuid import uuid4

import pytest

from app.home.patients.recovering import _received_messages
from app.storage.journal.payloads import Footer
from app.storage.journal.reader import ReadReport
from app.storage.recovery import Recovered
from app.storage.stored import StoredRecording
from app.wizard.walk_messages import recovery_costs
from core.session import Recording, RecordingKind

CUT = ReadReport(records=90)
WHOLE = replace(CUT, footer=Footer("stopped", 0, 0))


class Row:
    """A recording's row, as far as it is stated."""

    id = uuid4()
    details = Recording("walk 3", RecordingKind.WALKING, str(Path("walk_3")), {})


def stated(*reports: ReadReport) -> str:
    received = [Recovered(cast(StoredRecording, Row()), 74.2, (report,)) for report in reports]
    ((what, then, _),) = _received_messages(received)
    return f"{what} {then}"


def test_a_recording_that_was_cut_short_shows_its_length_and_what_its_end_may_have_cost() -> None:
    assert stated(CUT) == (
        "The program closed during recording. 01:14 of walk 3 was recovered. The recording is complete up to the "
        f"last data record on disk. Review the recording, then include or exclude it. {recovery_costs()}"
    )
    assert (
        "In 99 of 100 cases, ending the program loses at most 0.1 s of recording. A power cut loses up to 0.5 s and"
        in recovery_costs()
    )


def test_it_is_called_as_in_its_session_and_by_its_own_name_where_that_cannot_be_read() -> None:
    received = [Recovered(cast(StoredRecording, Row()), 74.2, (CUT,))]
    for names, name in (({Row.id: "A2 Barefoot"}, "A2 Barefoot"), ({uuid4(): "A2 Barefoot"}, "walk 3")):
        ((what, _, _),) = _received_messages(received, names)
        assert what == f"The program closed during recording. 01:14 of {name} was recovered."


def test_one_of_which_only_the_row_was_left_open_is_whole() -> None:
    assert "The recording is complete. Review the recording" in stated(WHOLE)
    assert recovery_costs() not in stated(WHOLE)
    assert "complete." not in stated(WHOLE, CUT)
    assert "They are complete" in stated(WHOLE, WHOLE)


@pytest.mark.parametrize(("missing", "is_stated"), [(0, False), (1, True), (4, True)])
def test_records_that_are_missing_before_the_end_are_counted(missing: int, is_stated: bool) -> None:
    words = stated(CUT, replace(CUT, missing_records=missing))
    assert ("missing" in words) is is_stated
    assert ("4 records before it are missing and leave gaps." in words) is (missing == 4)
    assert "2 recordings, 02:28 in total, were recovered." in words
