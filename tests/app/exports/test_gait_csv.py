"""Tests that events, strides, cycles and averages match what the simulated patient did."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.gait_csv import STRIDE_STATUS, write_gait
from app.exports.summary import summarise
from app.summary.events import events_of
from app.summary.reference_bands import reference_curves
from core.analysis import analyse
from core.body import Joint, Side, Site
from core.calibration import clinical_sign
from core.results import Analysis
from core.verdicts.gates import judged
from core.verdicts.quantities import PARAMETERS, both_sides, mean_curve, values_of
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Walk, WalkerSettings
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, session_of, simulation_of


@pytest.fixture(scope="module")
def walked() -> SimulatedSession:
    return simulation_of(WalkerSettings(seed=4, recordings=(Standing(), Walk()), clock_late_s={Site.LEFT_FOOT: 0.03}))


@pytest.fixture(scope="module")
def found(walked: SimulatedSession) -> Analysis:
    return analysis_of(walked.session)


@pytest.fixture(scope="module")
def folder(found: Analysis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walk_1")
    write_gait(found.recordings[0], folder)
    return folder


def test_every_step_has_its_four_events_on_the_clock_of_the_walk(walked: SimulatedSession, folder: Path) -> None:
    events = csv_rows(folder / "events.csv")
    assert [float(row["time_s"]) for row in events] == sorted(float(row["time_s"]) for row in events)
    for side in Side:
        truth = walked.truth.recordings["walk 1"].feet[side].events
        for name in ("initial_contact", "full_contact", "heel_rise", "toe_off"):
            reported = [float(row["time_s"]) for row in events if row["side"] == side and row["event"] == name]
            true = getattr(truth, f"{name}_s")
            # the left foot's late clock is brought to the thigh's, as its truth is not
            late = 0.03 if side is Side.LEFT else 0.0
            assert len(reported) == len(true)
            error_s = np.abs(np.array(reported) - true)
            assert np.median(error_s) < 0.015 + late
            assert np.max(error_s) < 0.1 + late  # the last step, which stops


def test_strides_are_as_long_as_they_were_and_say_why_they_are_left_out(walked: SimulatedSession, folder: Path) -> None:
    strides = csv_rows(folder / "strides.csv")
    assert list(strides[0]) == [
        *("side", "start_s", "full_contact_s", "heel_rise_s", "toe_off_s", "end_s"),
        *PARAMETERS,
        *("used", "reason"),
        *STRIDE_STATUS,
    ]
    for side in Side:
        mine = [row for row in strides if row["side"] == side]
        used = [float(row["stride_length_m"]) for row in mine if row["used"] == "true"]
        true = walked.truth.recordings["walk 1"].feet[side].stride_lengths_m
        assert len(used) >= 5
        assert np.median(used) == pytest.approx(np.median(true), rel=0.02)
        assert all(bool(row["reason"]) == (row["used"] == "false") for row in mine)


def test_the_mean_cycle_is_the_mean_of_the_strides_used(found: Analysis, folder: Path) -> None:
    cycles = csv_rows(folder / "cycles.csv")
    assert [int(row["percent"]) for row in cycles] == list(range(101))
    gait = found.recordings[0].gait[Side.LEFT]
    curves = np.rad2deg(gait.cycles[Joint.LEFT_KNEE][gait.strides.is_used])
    assert [float(row["left_knee_mean_deg"]) for row in cycles] == pytest.approx(curves.mean(axis=0), abs=1e-5)
    assert [float(row["left_knee_stride_sd_deg"]) for row in cycles] == pytest.approx(
        curves.std(axis=0, ddof=1), abs=1e-5
    )
    assert {int(row["left_knee_n"]) for row in cycles} == {len(curves)}


def test_the_summary_has_the_averages_of_each_side_and_what_compares_them(
    walked: SimulatedSession, found: Analysis, folder: Path
) -> None:
    walk = summarise(found)["walks"]["walk 1"]
    strides = [row for row in csv_rows(folder / "strides.csv") if row["side"] == "left"]
    used = [row for row in strides if row["used"] == "true"]
    assert walk["left"]["strides_used"] == len(used)
    assert walk["left"]["strides_left_out"] == len(strides) - len(used)
    for name in PARAMETERS:
        mean = np.mean([float(row[name]) for row in used if row[name]]) if any(row[name] for row in used) else None
        assert walk["left"][f"{name}_mean"] == (None if mean is None else pytest.approx(mean, abs=1e-4))
    assert walk["both"]["speed_m_s"] == pytest.approx(walked.truth.recordings["walk 1"].speed_m_s, rel=0.1)
    assert walk["both"]["cadence_steps_min"] == pytest.approx(
        120 / np.mean([walk[side]["stride_time_s_mean"] for side in ("left", "right")]), rel=1e-6
    )
    assert abs(walk["both"]["symmetry_index_percent"]["stride_time_s"]) < 3.0
    assert 0 < walk["both"]["curve_difference_deg"]["knee"] < 10.0


def test_symmetry_compares_the_affected_side_with_the_sound_one(walked: SimulatedSession, found: Analysis) -> None:
    turned = replace(found, affected_side=Side.RIGHT)
    index = summarise(found)["walks"]["walk 1"]["both"]["symmetry_index_percent"]
    other = summarise(turned)["walks"]["walk 1"]["both"]["symmetry_index_percent"]
    assert other["stance_percent"] == pytest.approx(-index["stance_percent"])


def test_without_a_foot_sensor_steps_come_from_the_shank_and_say_so(tmp_path: Path) -> None:
    sites = (Site.LEFT_THIGH, Site.LEFT_SHANK)
    walked = simulation_of(WalkerSettings(seed=4, recordings=(Standing(), Walk()), sites=sites))
    found = analysis_of(walked.session)
    write_gait(found.recordings[0], tmp_path)
    names = {row["event"] for row in csv_rows(tmp_path / "events.csv")}
    assert names == {"initial_contact", "toe_off"}
    assert {row["stride_length_m"] for row in csv_rows(tmp_path / "strides.csv")} == {""}
    assert "events_from_shank" in {finding.key for finding in found.findings}


def test_what_one_side_shows_of_both_is_in_the_summary_as_on_the_screen(found: Analysis) -> None:
    walk = found.recordings[0]
    alone = judged(replace(found, recordings=(replace(walk, gait={Side.LEFT: walk.gait[Side.LEFT]}),)))
    both = summarise(alone)["walks"]["walk 1"]["both"]
    shown = both_sides(alone.recordings[0])
    assert both["speed_m_s"] > 0.5
    assert both["cadence_steps_min"] == shown.cadence_steps_min
    assert both["speed_m_s"] == shown.speed_m_s
    assert both["double_support_percent"] is both["symmetry_index_percent"] is None


def test_events_at_one_instant_stand_in_the_order_of_the_stride(found: Analysis) -> None:
    walk = found.recordings[0]
    (events,) = walk.gait[Side.LEFT].events
    flat = replace(events, heel_rise_s=events.toe_off_s, full_contact_s=events.initial_contact_s)
    reported = events_of(replace(walk, gait={Side.LEFT: replace(walk.gait[Side.LEFT], events=(flat,))}))
    stride = ["heel_rise", "toe_off", "initial_contact", "full_contact"]
    assert [event for _, _, event in reported] == stride * len(events)


def test_feet_alone_give_events_and_no_angles(tmp_path: Path) -> None:
    walked = simulation_of(
        WalkerSettings(seed=4, recordings=(Standing(), Walk()), sites=(Site.LEFT_FOOT, Site.RIGHT_FOOT))
    )
    found = analysis_of(walked.session)
    assert [one.joints for one in found.calibrations if one.joints] == []
    assert dict(found.recordings[0].joints) == {}
    write_gait(found.recordings[0], tmp_path)
    events = csv_rows(tmp_path / "events.csv")
    assert {row["side"] for row in events} == {"left", "right"}
    assert csv_rows(tmp_path / "cycles.csv") == []


def test_the_score_is_the_distance_of_the_mean_cycle_from_the_group(found: Analysis, folder: Path) -> None:
    summary = summarise(found)
    cycles, group = csv_rows(folder / "cycles.csv"), reference_curves()
    for side in Side:
        scores = summary["walks"]["walk 1"][side]["gait_variable_score_deg"]
        for kind, group_deg in (("knee", group.knee_mean_deg), ("ankle", group.ankle_mean_deg)):
            mean_deg = np.array([float(row[f"{side}_{kind}_mean_deg"]) for row in cycles])
            assert scores[kind] == pytest.approx(np.sqrt(np.mean((mean_deg - group_deg) ** 2)), abs=1e-4)
    assert summary["reference_group"]["n"] == 24
    assert summary["reference_group"]["speed_m_s"] == 1.245


def test_without_a_zero_or_without_strides_there_is_no_score(found: Analysis) -> None:
    walked = simulation_of(WalkerSettings(seed=4, recordings=(Walk(),)))
    summary = summarise(analysis_of(walked.session))
    assert summary["joints"]["left_knee"]["zero"] == "none"
    assert summary["walks"]["walk 1"]["left"]["gait_variable_score_deg"] == {"knee": None, "ankle": None}
    nobody = {side: replace(gait, cycles={}) for side, gait in found.recordings[0].gait.items()}
    empty = replace(found, recordings=(replace(found.recordings[0], gait=nobody),))
    assert summarise(empty)["walks"]["walk 1"]["right"]["gait_variable_score_deg"] == {"knee": None, "ankle": None}


def test_a_knee_whose_sign_is_uncertain_has_a_range_and_a_spread_and_no_angle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clinical_sign, "MIN_RANGE_RAD", np.deg2rad(20.0))  # the stiff knee moves by some 15
    stiff = simulation_of(WalkerSettings(seed=4, recordings=(Standing(), Walk()), stiff_knee_side=Side.LEFT))
    found = analyse(stiff.session)
    assert ("clinical_sign_uncertain", "left_knee") in {(finding.key, finding.where) for finding in found.findings}
    write_gait(found.recordings[0], tmp_path)
    strides = [row for row in csv_rows(tmp_path / "strides.csv") if row["side"] == "left"]
    reported = {name for name in PARAMETERS if name.startswith("knee_") and any(row[name] for row in strides)}
    assert reported == {"knee_range_deg"}
    cycles = csv_rows(tmp_path / "cycles.csv")
    assert {row["left_knee_mean_deg"] for row in cycles} == {""}
    assert all(row["left_knee_stride_sd_deg"] and row["right_knee_mean_deg"] for row in cycles)
    walk = summarise(found)["walks"]["walk 1"]
    assert walk["left"]["gait_variable_score_deg"]["knee"] is walk["both"]["curve_difference_deg"]["knee"] is None
    assert walk["right"]["gait_variable_score_deg"]["knee"] > 0
    assert walk["both"]["symmetry_index_percent"]["knee_range_deg"] < -100

    reported_by_hand = analyse(replace(stiff.session, turned_sign={Joint.LEFT_KNEE: 1}))
    write_gait(reported_by_hand.recordings[0], tmp_path)
    assert all(row["left_knee_mean_deg"] for row in csv_rows(tmp_path / "cycles.csv"))


@pytest.mark.endurance
def test_a_difference_between_the_sides_is_weighed_against_the_measurement_error(found: Analysis) -> None:
    few = summarise(found)["walks"]["walk 1"]["both"]["side_difference"]["knee_range_deg"]
    assert (few["verdict"], few["error_deg"]) == ("too_few_strides", None)  # under 10 of a side
    assert few["difference_deg"] is not None

    long = simulation_of(WalkerSettings(seed=4, recordings=(Standing(), Walk(strides=16))))
    walk = summarise(analysis_of(long.session))["walks"]["walk 1"]
    reported = walk["both"]["side_difference"]
    assert set(reported) == {name for name in PARAMETERS if name.endswith("_deg")}
    sides = [walk[side]["knee_swing_peak_deg_mean"] for side in ("left", "right")]
    assert reported["knee_swing_peak_deg"]["difference_deg"] == pytest.approx(sides[0] - sides[1])
    # a height carries both legs' zeros besides what its strides leave open; a range is surer
    assert reported["knee_swing_peak_deg"]["error_deg"] == pytest.approx(8.8, abs=0.5)
    assert reported["knee_swing_peak_deg"]["verdict"] == "inside_error"
    # 1.96 x hypot(hypot(1.2, 0.043 x 56.0), hypot(1.2, 0.043 x 58.8)) = 7.6, chance added
    assert 7.6 < reported["knee_range_deg"]["error_deg"] < 8.2
    # of the ankle no more than healthy legs' 6.2, chance added
    assert 6.2 < reported["ankle_range_deg"]["error_deg"] < 6.8

    stiff = simulation_of(WalkerSettings(seed=4, recordings=(Walk(strides=16),), stiff_knee_side=Side.LEFT))
    both = summarise(analysis_of(stiff.session))["walks"]["walk 1"]["both"]
    # without a zero a range is all that can be compared
    assert both["side_difference"]["knee_swing_peak_deg"] is both["curve_difference_deg"]["knee"] is None
    assert both["side_difference"]["knee_range_deg"]["verdict"] == "exceeds_error"


def test_without_standing_a_joint_has_ranges_and_no_angles() -> None:
    recordings = (FreeMotion(), Walk(strides=8))
    walk = analysis_of(session_of(WalkerSettings(seed=2, recordings=recordings))).recordings[-1]
    for side, gait in walk.gait.items():
        used = gait.strides.is_used
        for name in ("knee_range_deg", "ankle_range_deg", "knee_swing_peak_percent", "stride_length_m"):
            assert np.isfinite(values_of(walk, side, name)[used]).all(), name
        for name in ("knee_swing_peak_deg", "knee_at_initial_contact_deg", "ankle_stance_dorsiflexion_deg"):
            assert np.isnan(values_of(walk, side, name)).all(), name
        for joint in gait.cycles:
            assert np.isfinite(mean_curve(walk, joint).mean).all(), joint
