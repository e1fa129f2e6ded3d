"""Tests that everything going wrong at once loses nothing unreported. The script would notice if it did."""

from pathlib import Path

import pytest

from devices.dot.samples import FileFramer
from tests.safety.dot_faults import run_often


@pytest.mark.endurance
def test_no_sample_is_lost_not_reported_nothing_is_a_dead_end_and_nothing_is_erased_that_was_not_kept(
    tmp_path: Path,
) -> None:
    every = run_often(3, 7000, tmp_path)
    assert every.faults == []
    assert every.count["samples lost live, and told"] > 0
    assert every.count["memories erased"] > 0


@pytest.mark.endurance
def test_a_fetching_that_does_not_see_what_is_missing_is_found_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(FileFramer, "missing", lambda _self: ())
    every = run_often(3, 7000, tmp_path)
    assert any("called complete" in fault for fault in every.faults)
    assert any("lost untold" in fault for fault in every.faults)
