"""T1: fifty interrupted recordings are listed within two seconds of the start of a program."""

from pathlib import Path

import pytest

from tests.safety.recovery_listing import list_in_new_process


@pytest.mark.endurance
def test_fifty_recordings_are_listed_within_two_seconds_of_the_start(tmp_path: Path) -> None:
    listing = list_in_new_process(tmp_path, 50, 20_000)
    assert (listing.recordings, listing.orphans, listing.problems) == (50, 10, 0)
    # a machine that is busy takes longer for whatever is started: then little longer than where there are none
    assert listing.after_s <= max(2.0, 1.5 * listing.empty_s)
