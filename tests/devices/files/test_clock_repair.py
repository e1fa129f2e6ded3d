"""Clocks of files: wrong stamps harm only themselves, steps back are refused where they are, in every format."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.samples import FloatArray, IntArray
from devices.files.clock_repair import FileClock, RepairedClock, repaired, without_turns
from devices.files.csv_tables import csv_trial
from devices.files.formats import read_trial, recognised
from devices.files.gathering import gather
from devices.files.refusal import FileRefusedError
from devices.files.ximu3_files import ximu3_trial

COUNT, STEP_S = 400, 0.01
EVEN_S = 5.0 + STEP_S * np.arange(COUNT)
CLOCK = FileClock("a.csv", lambda row: f"line {row + 2}", "time_s")


def mended(change: Callable[[FloatArray], None], stamps_s: FloatArray = EVEN_S) -> RepairedClock:
    changed = stamps_s.copy()
    change(changed)
    return repaired(changed, CLOCK)


def at(rows: slice | list[int], value: float | FloatArray) -> Callable[[FloatArray], None]:
    def change(stamps_s: FloatArray) -> None:
        stamps_s[rows] = value

    return change


@pytest.mark.parametrize(
    ("change", "count"),
    [
        (at([100], 0.0), 1),
        (at([100], 1e9), 1),
        (at([100], EVEN_S[100] - 0.03), 1),
        (at([100], EVEN_S[100] + 0.5), 1),
        (at([100, 101], EVEN_S[[101, 100]]), 2),
        (at([100, 250], 0.0), 2),
        (at(slice(100, 200), EVEN_S[100:200] + 200_000.0), 100),
        (at(slice(100, 200), EVEN_S[100:200] - 3.0), 100),
    ],
)
def test_wrong_stamps_are_put_where_their_samples_were_taken(change: Callable[[FloatArray], None], count: int) -> None:
    clock = mended(change)
    np.testing.assert_allclose(clock.stamps, EVEN_S, atol=1e-9)
    assert clock.is_new.all()
    (found,) = clock.findings
    assert (found.key, found.numbers["count"], found.numbers["left_out"]) == ("stamps_mended", count, 0)
    assert found.numbers["first"] == 101


@pytest.mark.parametrize(
    "rows", [[0], [0, 1], [COUNT - 1], [COUNT - 2, COUNT - 1]], ids=["first", "first two", "last", "last two"]
)
@pytest.mark.parametrize("value", [-1e6, 1e6])
def test_wrong_stamps_at_an_end_leave_their_samples_out(rows: list[int], value: float) -> None:
    clock = mended(at(rows, value + np.arange(len(rows))))
    is_right = ~np.isin(np.arange(COUNT), rows)
    np.testing.assert_array_equal(clock.is_new, is_right)
    np.testing.assert_array_equal(clock.stamps[is_right], EVEN_S[is_right])
    assert clock.findings[0].numbers["left_out"] == len(rows)


def test_a_wrong_stamp_beside_a_loss_is_left_out() -> None:
    clock = mended(at([100], 0.0), np.delete(EVEN_S, slice(101, 120)))
    assert clock.findings[0].numbers == {"count": 1, "left_out": 1, "first": 101, "off_s": pytest.approx(6.0)}
    assert np.flatnonzero(~clock.is_new).tolist() == [100]


def test_stamps_without_faults_stay_to_the_last_bit() -> None:
    chance = np.random.default_rng(1)
    for stamps_s in (
        EVEN_S,
        np.delete(EVEN_S, slice(100, 300)),  # a loss, or a pause
        np.delete(EVEN_S, chance.integers(0, COUNT, 100)),
        EVEN_S + chance.uniform(0, 0.004, COUNT),
        1.7e9 + EVEN_S,
        np.concatenate([EVEN_S, EVEN_S + 10_800.0]),
    ):
        clock = repaired(stamps_s, CLOCK)
        np.testing.assert_array_equal(clock.stamps, stamps_s)
        assert clock.is_new.all()
        assert clock.findings == ()


def test_repeated_stamps_are_new_once_and_reported() -> None:
    clock = mended(at([100, 101], EVEN_S[99]))
    assert clock.doubled == 2
    assert [(one.key, one.numbers) for one in clock.findings] == [("doubled_stamps", {"count": 2})]


@pytest.mark.parametrize("by_s", [0.02, 0.2, 2.0, 3.9, 1000.0])
@pytest.mark.parametrize("row", [100, 200, 300])
def test_a_clock_that_steps_back_for_good_is_refused_where_it_does(by_s: float, row: int) -> None:
    if row * STEP_S <= by_s < 10.0:
        by_s = 0.5 * row * STEP_S
    with pytest.raises(FileRefusedError, match=f"a.csv, line {row + 2}: time_s goes back from") as refused:
        mended(at(slice(row, None), EVEN_S[row:] - by_s))
    assert refused.value.remedy.startswith("Split the recording there")


@pytest.mark.parametrize("wrong", [0, 5, 1 << 23, (1 << 24) - 1])
@pytest.mark.parametrize("row", [1, 100, 298])
def test_a_wrong_count_adds_no_turn_to_those_after_it(wrong: int, row: int) -> None:
    true = 12_345 + 320 * np.arange(300, dtype=np.int64) + (1 << 24) - 50_000
    counts = true % (1 << 24)
    counts[row] = wrong
    ticks = without_turns(counts, 1 << 24)
    shift = np.delete(ticks - true, row)
    assert set(shift % (1 << 24)) == {0}
    assert len(set(shift)) == 1


def table(path: Path, stamps_us: IntArray) -> Path:
    rows = [f"{us},0.1,0.2,{0.3 * (k % 7)},0.0,0.0,1.0" for k, us in enumerate(stamps_us)]
    head = (
        "Timestamp (us),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),"
        "Accelerometer X (g),Accelerometer Y (g),Accelerometer Z (g)"
    )
    path.mkdir()
    (path / "Inertial.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def test_a_restart_drops_no_half_as_repeated(tmp_path: Path) -> None:
    stamps_us = 10_000 * np.arange(COUNT)
    restarted = table(tmp_path / "ls", np.concatenate([stamps_us[:200], stamps_us[50:250]]))
    with pytest.raises(FileRefusedError, match=r"ls/Inertial.csv, line 202: Timestamp \(us\) goes back from 1990000"):
        ximu3_trial([restarted])
    (whole,) = ximu3_trial([table(tmp_path / "lt", stamps_us)]).sensors
    assert (len(whole.block), whole.findings) == (COUNT, ())


def test_a_wrong_stamp_in_a_csv_harms_nothing_after_it(tmp_path: Path) -> None:
    stamps_s = EVEN_S.copy()
    stamps_s[100] = 0.0
    rows = [f"{time_s:.4f},0.1,0.2,9.8,0.01,0.02,0.03" for time_s in stamps_s]
    head = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s,gyr_y_rad_s,gyr_z_rad_s"
    (tmp_path / "a.csv").write_text("\n".join([head, *rows, ""]))
    (sensor,) = csv_trial([tmp_path / "a.csv"]).sensors
    np.testing.assert_allclose(sensor.block.time_s, EVEN_S, atol=1e-6)
    assert "stamps_mended" in {one.key for one in sensor.findings}


def about(path: Path) -> list[str]:
    """The findings about a file, or why it is refused."""
    try:
        trial = read_trial(recognised([path]), [path], 100.0)
    except FileRefusedError as refused:
        return [refused.what]
    return [one.key for sensor in trial.sensors for one in sensor.findings]


@pytest.mark.parametrize(
    "folder", ["vendor_exports/apdm", "vendor_exports/xsens_mtmanager", "vendor_streams/xsens_mti"]
)
def test_no_real_recording_is_refused_or_mended_for_its_clock(test_data: Callable[[str], Path], folder: str) -> None:
    trials = [[Path(file) for file in trial.files] for trial in gather([test_data(folder)]).trials]
    assert trials
    for files in trials:
        for path in files:
            stated = about(path)
            assert not [one for one in stated if "goes back" in one or one == "stamps_mended"], path


@given(
    st.lists(st.tuples(st.integers(0, COUNT - 1), st.floats(-1e9, 1e9) | st.just(np.nan)), max_size=30),
    st.sampled_from([5, 40, COUNT]),
    st.sampled_from([0.0, 1.0]),
)
def test_whatever_stamps_hold_they_ascend_or_the_file_is_refused(
    wrong: list[tuple[int, float]], count: int, slack: float
) -> None:
    stamps_s = EVEN_S[:count].copy()
    for row, value in wrong:
        stamps_s[row % count] = value
    try:
        clock = repaired(stamps_s, CLOCK, slack=slack)
    except FileRefusedError:
        return
    kept_s = clock.stamps[clock.is_new]
    assert np.isfinite(kept_s).all()
    assert (np.diff(kept_s) > 0).all()
    assert not clock.is_new[np.isnan(stamps_s)].any()
    if count == COUNT and len(wrong) == 1:
        right = np.flatnonzero(stamps_s == EVEN_S)
        np.testing.assert_array_equal(clock.stamps[right], EVEN_S[right])
        assert clock.is_new[right].all()
