"""What a sensor on the pelvis adds to the tables and to summary.json."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.columns import column_of
from app.exports.result_folder import write_results
from app.storage.analysis_content import packed, unpacked
from app.wording.verdicts import WORDS, gate_sentence, gate_words
from core.body import LEG_SITES, Joint, Side, Site, hip_of
from core.verdicts.gates import judged
from core.verdicts.model import GateReason, Verdict
from devices.files.session_folder import read_session, write_session
from devices.simulation.walker import Tissue
from tests.app.exports.written_tables import csv_rows
from tests.core.hip.hip_sessions import analysed, with_hip

HIP_GATES = ("hip_disagreement", "hip_centre", "hips_apart")
OF_DEGREES = ("hip_heading", "hip_deep", "pelvis_tilt")


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pelvis")
    made, analysis = analysed(late_s=0.04)
    write_results(made.session, analysis, folder)
    return folder


def test_angles_hold_hips_and_pelvis(results: Path) -> None:
    walk = analysed(late_s=0.04)[1].recordings[-1]
    table = csv_rows(results / "walk_1" / "angles.csv")
    found = [float(row["right_hip_deg"] or "nan") for row in table]
    assert found == pytest.approx(np.rad2deg(walk.hips[Joint.RIGHT_HIP].angle_rad), abs=1e-5, nan_ok=True)
    assert {row["left_hip_status"] for row in table} == {"read"}
    assert walk.pelvis is not None
    tilt = [float(row["pelvis_tilt_deg"] or "nan") for row in table]
    assert tilt == pytest.approx(np.rad2deg(walk.pelvis.tilt_rad), abs=1e-5, nan_ok=True)


def test_strides_hold_figures_of_hips_and_pelvis(results: Path) -> None:
    used = [row for row in csv_rows(results / "walk_1" / "strides.csv") if row["used"] == "true"]
    assert {row["side"] for row in used} == set(Side)
    for row in used:
        range_deg = float(row["hip_range_deg"])
        assert range_deg == pytest.approx(float(row["hip_flexion_peak_deg"]) + float(row["hip_extension_peak_deg"]))
        assert 3.0 < float(row["pelvis_obliquity_range_deg"]) < 12.0


def test_every_column_is_explained(results: Path) -> None:
    explained = {(row["file"], row["column"]) for row in csv_rows(results / "columns.csv")}
    for file in ("angles.csv", "strides.csv", "cycles.csv"):
        with (results / "walk_1" / file).open(encoding="utf-8") as table:
            for name in table.readline().strip().split(","):
                assert (file, name) in explained
                assert column_of(file, name).definition
    with (results / "peaks.csv").open(encoding="utf-8") as table:
        of_hips = [name for name in table.readline().strip().split(",") if name.startswith("hip")]
    assert of_hips == ["hip_flexion_peak_percent", "hip_extension_peak_percent", "hip_status"]
    assert {("peaks.csv", name) for name in of_hips} <= explained


def test_mean_curves_of_hips_and_their_abduction_are_those_of_the_strides_used(results: Path) -> None:
    walk = analysed(late_s=0.04)[1].recordings[-1]
    table = csv_rows(results / "walk_1" / "cycles.csv")
    for side in Side:
        gait = walk.gait[side]
        mean = np.rad2deg(gait.cycles[hip_of(side)][gait.strides.is_used].mean(axis=0))
        assert [float(row[f"{side}_hip_mean_deg"]) for row in table] == pytest.approx(mean, abs=1e-4)
        abduction = [float(row[f"{side}_hip_abduction_mean_deg"]) for row in table]
        assert -12.0 < min(abduction) < -4.0 < 4.0 < max(abduction) < 15.0
        assert {row[f"{side}_hip_abduction_status"] for row in table} == {"read"}


def test_differences_of_hips_and_pelvis_have_no_published_figure(results: Path) -> None:
    reported = {row["parameter"]: row for row in csv_rows(results / "sides.csv")}
    of_hips = [row for name, row in reported.items() if name.startswith(("hip", "pelvis"))]
    assert len(of_hips) == 11
    for row in of_hips:
        is_tilt = row["parameter"] == "pelvis_tilt_range_deg"
        assert row["verdict"] == ("withheld" if is_tilt else "no_published_figure")
        assert (row["error"], row["difference"] == "") == ("", is_tilt)
    assert reported["knee_range_deg"]["verdict"] != "no_published_figure"


def test_what_is_not_reported_of_a_hip_is_empty_and_its_status_states_so(tmp_path: Path) -> None:
    made, analysis = analysed(late_s=0.04)
    write_results(made.session, with_hip(analysis, Joint.LEFT_HIP, margin=1.2), tmp_path)
    cycles, strides = csv_rows(tmp_path / "walk_1" / "cycles.csv"), csv_rows(tmp_path / "walk_1" / "strides.csv")
    for part in ("left_hip", "left_hip_abduction"):
        assert {row[f"{part}_mean_deg"] for row in cycles} == {""}
        assert {row[f"{part}_status"] for row in cycles} == {"withheld"}
        assert {row[f"{part.replace('left', 'right')}_status"] for row in cycles} == {"read"}
    left = [row for row in strides if row["side"] == "left"]
    for name in ("hip_range_deg", "hip_flexion_peak_deg", "hip_abduction_range_deg"):
        assert {row[name] for row in left} == {""}
        assert any(row[name] for row in strides if row["side"] == "right")
    assert any(row["pelvis_drop_deg"] for row in left)  # the other hip gives the pelvis its frame
    verdicts = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["walks"]["walk 1"]["verdicts"]
    assert "Sensor positions could not be confirmed" in json.dumps(verdicts)


def test_the_summary_shows_the_clock_and_the_hips(results: Path) -> None:
    walk = json.loads((results / "summary.json").read_text(encoding="utf-8"))["walks"]["walk 1"]
    assert walk["leg_clock_status"] == "found"
    assert walk["leg_clock_offset_s"] == pytest.approx(0.04, abs=0.001)
    assert walk["leg_clock_sd_s"] == 0.005
    assert walk["hips"]["left_hip"]["is_3d"] is True
    assert 0.0 < walk["hips"]["left_hip"]["heading_sd_deg"] < 6.0
    assert walk["verdicts"]["between"]["verdict"] == "read"
    assert walk["left"]["hip_range_deg_mean"] == pytest.approx(50.0, abs=4.0)


def test_a_kept_analysis_is_read_back_with_its_hips() -> None:
    content = packed(analysed(late_s=0.04)[1])
    again = unpacked(content)
    assert packed(again) == content
    assert again.recordings[-1].leg_clock == analysed(late_s=0.04)[1].recordings[-1].leg_clock


@pytest.mark.endurance
def test_a_session_folder_keeps_the_pelvis(tmp_path: Path) -> None:
    made, _ = analysed()
    write_session(made.session, tmp_path / "session")
    assert (tmp_path / "session" / "walk_1" / "pelvis.csv").is_file()
    again = read_session(tmp_path / "session")
    assert set(again.recordings[-1].imu) == {*LEG_SITES, Site.PELVIS}
    assert again.findings == ()
    block = again.recordings[-1].imu[Site.PELVIS]
    assert np.array_equal(block.acc_m_s2, made.session.recordings[-1].imu[Site.PELVIS].acc_m_s2)


@pytest.mark.endurance
def test_real_tissue_that_parts_the_hips_is_not_reported_in_words() -> None:
    walk = analysed(seed=1, tissue=Tissue.REAL)[1].recordings[-1]
    gates = {reason.gate: reason for reason in walk.verdicts.joint(Joint.LEFT_HIP).shape.reasons}
    assert "0.29" in gate_sentence(gates["hips_apart"])


@pytest.mark.parametrize(
    ("wrong", "gate", "reported"),
    [
        ({"margin": 1.4}, "pairing", "1.40"),
        ({"disagreement": 0.31}, "hip_disagreement", "(difference 31 %"),
        ({"centre_proximal_m": np.array([0.0, 0.0, 0.44])}, "hip_centre", "0.44 m"),
        ({"centre_distal_m": np.array([0.03, 0.0, 0.0])}, "hip_centre", "0.03 m"),
        ({"centres_apart_m": 0.31}, "hips_apart", "0.31 m"),
        ({"centres_apart_m": -0.17}, "hips_apart", "-0.17 m"),  # the legs' sensors are swapped
    ],
)
def test_a_hip_of_which_one_thing_is_wrong_is_not_reported_in_words_and_the_other_hip_is_not(
    wrong: dict[str, object], gate: str, reported: str
) -> None:
    left, analysis = Joint.LEFT_HIP, analysed(late_s=0.04)[1]
    walk = analysis.recordings[-1]
    changed = replace(walk.hips[left], identification=replace(walk.hips[left].identification, **wrong))  # type: ignore[arg-type]  # fields by name
    found = judged(replace(analysis, recordings=(replace(walk, hips={**walk.hips, left: changed}),))).recordings[-1]
    shape = found.verdicts.joint(left).shape
    assert shape.verdict is Verdict.NOT_REPORTED
    (reason,) = shape.reasons
    assert reason.gate == gate
    assert reported in gate_sentence(reason).replace("\u00a0", " ")
    assert found.verdicts.joint(Joint.RIGHT_HIP) == walk.verdicts.joint(Joint.RIGHT_HIP)
    assert walk.verdicts.joint(left).shape.verdict is Verdict.READ
    assert found.verdicts.pelvis == walk.verdicts.pelvis  # one sound hip is enough for it


def test_where_no_hip_can_be_read_there_is_no_pelvis() -> None:
    analysis = analysed(late_s=0.04)[1]
    walk = analysis.recordings[-1]
    hips = {
        joint: replace(hip, identification=replace(hip.identification, margin=1.4)) for joint, hip in walk.hips.items()
    }
    found = judged(replace(analysis, recordings=(replace(walk, hips=hips),))).recordings[-1]
    assert found.verdicts.pelvis.verdict is Verdict.NOT_REPORTED
    assert {reason.gate for reason in found.verdicts.pelvis.reasons} == {"pairing"}


@pytest.mark.parametrize("gate", OF_DEGREES)
def test_each_gate_with_a_limit_in_degrees_states_both_figures(gate: str) -> None:
    stated = gate_sentence(GateReason(gate, Verdict.NOT_REPORTED, 7.25, 6.0, "deg"))
    assert "7.2" in stated
    assert "6" in stated


@pytest.mark.parametrize("gate", ["hip_found", "leg_clock"])
def test_what_was_not_found_states_what_it_takes(gate: str) -> None:
    words = gate_words(GateReason(gate, Verdict.NOT_REPORTED))
    assert words.why
    assert words.to_do


def test_every_gate_of_a_hip_has_its_words() -> None:
    assert set(HIP_GATES) <= set(WORDS)
