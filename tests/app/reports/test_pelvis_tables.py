"""What a sensor on the pelvis adds to the tables and to summary.json."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.gates_in_words import WORDS, gate_sentence
from app.reports.columns import column_of
from app.reports.result_folder import write_results
from app.storage.analysis_content import packed, unpacked
from core.body import LEG_SITES, Joint, Side, Site
from core.verdicts.gates import judged
from core.verdicts.model import Verdict
from devices.files.session_folder import read_session, write_session
from devices.walker import Tissue
from tests.core.hip.hip_sessions import analysed

HIP_GATES = ("hip_disagreement", "hip_centre", "hips_apart")


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pelvis")
    made, analysis = analysed(late_s=0.04)
    write_results(made.session, analysis, folder)
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_angles_hold_hips_and_pelvis(results: Path) -> None:
    walk = analysed(late_s=0.04)[1].recordings[-1]
    table = rows(results / "walk_1" / "angles.csv")
    found = [float(row["right_hip_deg"] or "nan") for row in table]
    assert found == pytest.approx(np.rad2deg(walk.hips[Joint.RIGHT_HIP].angle_rad), abs=1e-5, nan_ok=True)
    assert {row["left_hip_status"] for row in table} == {"read"}
    assert walk.pelvis is not None
    tilt = [float(row["pelvis_tilt_deg"] or "nan") for row in table]
    assert tilt == pytest.approx(np.rad2deg(walk.pelvis.tilt_rad), abs=1e-5, nan_ok=True)


def test_strides_hold_figures_of_hips_and_pelvis(results: Path) -> None:
    used = [row for row in rows(results / "walk_1" / "strides.csv") if row["used"] == "true"]
    assert {row["side"] for row in used} == set(Side)
    for row in used:
        range_deg = float(row["hip_range_deg"])
        assert range_deg == pytest.approx(float(row["hip_flexion_peak_deg"]) + float(row["hip_extension_peak_deg"]))
        assert 3.0 < float(row["pelvis_obliquity_range_deg"]) < 12.0


def test_every_column_is_explained(results: Path) -> None:
    explained = {(row["file"], row["column"]) for row in rows(results / "columns.csv")}
    for file in ("angles.csv", "strides.csv"):
        with (results / "walk_1" / file).open(encoding="utf-8") as table:
            for name in table.readline().strip().split(","):
                assert (file, name) in explained
                assert column_of(file, name).definition


def test_the_summary_tells_the_clock_and_the_hips(results: Path) -> None:
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
def test_real_tissue_that_parts_the_hips_is_withheld_in_words() -> None:
    walk = analysed(seed=1, tissue=Tissue.REAL)[1].recordings[-1]
    gates = {reason.gate: reason for reason in walk.verdicts.joint(Joint.LEFT_HIP).shape.reasons}
    assert "0.29" in gate_sentence(gates["hips_apart"])


@pytest.mark.parametrize(
    ("wrong", "gate", "told"),
    [
        ({"margin": 1.4}, "pairing", "1.40"),
        ({"disagreement": 0.31}, "hip_disagreement", "0.31"),
        ({"centre_proximal_m": np.array([0.0, 0.0, 0.44])}, "hip_centre", "0.44 m"),
        ({"centre_distal_m": np.array([0.03, 0.0, 0.0])}, "hip_centre", "0.03 m"),
        ({"centres_apart_m": 0.31}, "hips_apart", "0.31 m"),
        ({"centres_apart_m": -0.17}, "hips_apart", "-0.17 m"),  # the legs' sensors are swapped
    ],
)
def test_a_hip_of_which_one_thing_is_wrong_is_withheld_in_words_and_the_other_hip_is_not(
    wrong: dict[str, object], gate: str, told: str
) -> None:
    left, analysis = Joint.LEFT_HIP, analysed(late_s=0.04)[1]
    walk = analysis.recordings[-1]
    changed = replace(walk.hips[left], identification=replace(walk.hips[left].identification, **wrong))  # type: ignore[arg-type]  # fields by name
    found = judged(replace(analysis, recordings=(replace(walk, hips={**walk.hips, left: changed}),))).recordings[-1]
    shape = found.verdicts.joint(left).shape
    assert shape.verdict is Verdict.WITHHELD
    (reason,) = shape.reasons
    assert reason.gate == gate
    assert told in gate_sentence(reason).replace("\u00a0", " ")
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
    assert found.verdicts.pelvis.verdict is Verdict.WITHHELD
    assert {reason.gate for reason in found.verdicts.pelvis.reasons} == {"pairing"}


def test_every_gate_of_a_hip_has_its_words() -> None:
    assert set(HIP_GATES) <= set(WORDS)
