"""Tests that clocks that restart are read on where the recording will be split, and refused everywhere else."""

from pathlib import Path

import numpy as np
import pytest

from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, SensorInfo
from devices.files.answers import BrokenAnswerError, details_of, value_from
from devices.files.clock_repair import MOST_RESTARTS, FileClock, repaired, restarts_continued
from devices.files.file_format import FileFormat
from devices.files.formats import FORMATS, read_trial
from devices.files.imports import place_trial
from devices.files.limited_reader import LimitedReading
from devices.files.refusal import FileRefusedError
from devices.files.trial import ClockRestart, ImportedSensor, ImportedTrial
from tests.clock_files import ALL, TIME_S, pair, restarted, table

CLOCK = FileClock("a.csv", lambda row: f"line {row + 2}", "time_s")
REFUSED = r'left_thigh.csv, line 902: "time_s" goes back from 8.99 to 0.5'


def test_a_restart_is_refused_unless_the_recording_will_be_split(tmp_path: Path) -> None:
    path = table(tmp_path, "left_thigh", restarted(9.0))
    with pytest.raises(FileRefusedError, match=REFUSED):
        read_trial("", [path], None)
    (sensor,) = read_trial("", [path], None, splits=True).sensors
    np.testing.assert_allclose(sensor.block.time_s, TIME_S, atol=1e-6)
    (restart,) = sensor.restarts
    assert restart.at == 900
    assert restart.shift_s == pytest.approx(8.5)
    assert sensor.findings == read_trial("", [table(tmp_path, "right_thigh")], None).sensors[0].findings
    with pytest.raises(FileRefusedError, match=REFUSED):
        read_trial("", [path], None)  # nothing is left switched on


def test_a_restart_that_is_not_split_is_refused_when_it_is_placed(tmp_path: Path) -> None:
    trial = read_trial("", pair(tmp_path, thigh=(restarted(9.0), ALL)), None, splits=True)
    with pytest.raises(FileRefusedError, match=REFUSED) as refused:
        place_trial(trial, {Site.LEFT_THIGH: "left_thigh"}, "walk 1")
    assert "Split the recording there (--split-at 9.0)" in str(refused.value)
    assert place_trial(trial, {Site.LEFT_SHANK: "left_shank"}, "walk 1").imu  # whose clock is whole


def test_even_clocks_are_read_alike(tmp_path: Path) -> None:
    files = pair(tmp_path)
    for one, other in zip(
        read_trial("", files, None).sensors, read_trial("", files, None, splits=True).sensors, strict=True
    ):
        np.testing.assert_array_equal(one.block.time_s, other.block.time_s)
        assert (one.findings, one.restarts) == (other.findings, ())


def test_the_reading_process_delivers_the_restarts(tmp_path: Path, shared_reading: LimitedReading) -> None:
    path = table(tmp_path, "left_thigh", restarted(9.0))
    (sensor,) = shared_reading.read_trial("", [path], None, splits=True).sensors
    assert [one.at for one in sensor.restarts] == [900]
    with pytest.raises(FileRefusedError, match=REFUSED):
        shared_reading.read_trial("", [path], None)


def test_no_answer_may_have_a_restart_outside_of_its_samples() -> None:
    block = ImuBlock("a", np.arange(3.0), np.zeros((3, 3)), np.zeros((3, 3)))
    refusal = FileRefusedError("a", "b", "c")
    sensor = ImportedSensor("a", (), "a", block, SensorInfo(), (), (ClockRestart(1, 1.0, refusal),))
    arrays: list[np.ndarray] = []
    details = details_of(sensor, arrays)
    assert value_from(ImportedSensor, details, arrays).restarts[0].at == 1
    details["restarts"][0]["at"] = -7
    with pytest.raises(BrokenAnswerError):
        value_from(ImportedSensor, details, arrays)


def test_a_clock_that_restarts_all_the_time_is_refused() -> None:
    saw = np.tile(np.arange(0.0, 0.5, 0.01), MOST_RESTARTS + 2)
    with restarts_continued() as met, pytest.raises(FileRefusedError, match="goes back"):
        repaired(saw, CLOCK)
    assert len(met) == MOST_RESTARTS
    with restarts_continued():
        few = repaired(saw[: 50 * MOST_RESTARTS], CLOCK)
    np.testing.assert_allclose(few.stamps, np.arange(50 * MOST_RESTARTS) / 100.0, atol=1e-9)


@pytest.mark.parametrize("is_lost", [False, True])
def test_a_reader_that_loses_a_restart_lets_nothing_through(monkeypatch: pytest.MonkeyPatch, is_lost: bool) -> None:
    def trial(files: object, _rate_hz: float | None) -> ImportedTrial:
        clock = repaired(restarted(9.0), CLOCK)
        zeros = np.zeros((len(TIME_S), 3))
        other = (Finding("doubled_stamps", Severity.WARNING, ""),)
        block = ImuBlock("a", clock.stamps, zeros, zeros)
        return ImportedTrial(
            "csv", (ImportedSensor("a", (), "a", block, SensorInfo(), other if is_lost else clock.findings),)
        )

    monkeypatch.setattr("devices.files.formats.FORMATS", {**FORMATS, "csv": FileFormat(lambda *_: True, trial)})
    path = Path(__file__)
    if is_lost:
        with pytest.raises(FileRefusedError, match=r"goes back from 8\.99 to 0\.5"):
            read_trial("csv", [path], None, splits=True)
    else:
        assert read_trial("csv", [path], None, splits=True).sensors[0].restarts
