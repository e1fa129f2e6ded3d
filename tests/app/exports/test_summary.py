"""Tests that summary.json holds what was found, as strict JSON that others can rely on."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.summary import FORMAT, summarise, write_summary
from app.system.tables import read_json
from core.body import Joint
from core.findings import Finding, Severity
from core.results import (
    Analysis,
    AxisSource,
    Calibration,
    JointAngle,
    JointCalibration,
    Method,
    RecordingAnalysis,
    ZeroKind,
)
from core.session import RecordingKind

GOLDEN = Path(__file__).parents[2] / "golden"


def knee() -> JointCalibration:
    return JointCalibration(
        joint=Joint.LEFT_KNEE,
        method=Method.ROBUST,
        axis_proximal=np.array([0.0, 0.6, 0.8]),
        axis_distal=np.array([1.0, 0.0, 0.0]),
        axis_source=AxisSource.FREE_MOTION,
        axis_sd_rad=np.pi / 45,
        centre_proximal_m=np.array([0.0, 0.125, 0.25]),
        centre_distal_m=np.array([0.0, -0.125, 0.0625]),
        centre_sd_m=0.0125,
        sign_margin=3.5,
        clinical_sign=-1,
        is_sign_certain=True,
        clinical_sign_margin=0.5,
        lag_s=-0.03125,
        lag_sd_s=0.0005,
        hinge_residual_rad_s=0.25,
        is_hinge=False,
        gyro_bias_proximal_rad_s=np.array([0.001, -0.002, 0.003]),
        gyro_bias_distal_rad_s=None,
        zero=ZeroKind.STANDING,
        zero_rad=0.1,
        offset_rad=0.0,
        standing_from="standing",
        free_motion_from="free motion",
        walks_from=("walk 1",),
    )


def analysis() -> Analysis:
    ankle = replace(
        knee(),
        joint=Joint.LEFT_ANKLE,
        axis_source=AxisSource.POOLED,
        axis_sd_rad=None,
        centre_proximal_m=None,
        centre_distal_m=np.array([0.1, np.nan, 0.1]),
        centre_sd_m=np.nan,
        sign_margin=np.inf,
        is_sign_certain=False,
        zero=ZeroKind.NONE,
        standing_from=None,
        free_motion_from=None,
        walks_from=("walk 1", "walk 2"),
    )
    spans = (
        Calibration(("walk 1",), {Joint.LEFT_KNEE: knee()}),
        Calibration(("walk 2",), {Joint.LEFT_ANKLE: ankle, Joint.LEFT_KNEE: replace(knee(), lag_s=0.0)}),
    )
    angle = JointAngle(np.zeros(3), np.zeros(3), np.zeros(3), None)
    recordings = tuple(
        RecordingAnalysis(name, name.replace(" ", "_"), kind, np.arange(3.0), {Joint.LEFT_KNEE: angle})
        for name, kind in (
            ("free motion", RecordingKind.FREE_MOTION),
            ("walk 1", RecordingKind.WALKING),
            ("walk 2", RecordingKind.WALKING),
        )
    )
    findings = (
        Finding("simulated", Severity.INFO, ""),
        Finding(
            "gaps",
            Severity.WARNING,
            "walk 1, left_thigh",
            {"count": 2, "missing_percent": np.float64(0.5), "longest_s": 0.25},
        ),
        Finding("clipped", Severity.GRAVE, "walk 2, left_foot", {"percent": np.nan}),
    )
    return Analysis(Method.ROBUST, True, spans, recordings, findings)


def test_the_summary_reads_as_agreed(tmp_path: Path) -> None:
    write_summary(analysis(), tmp_path / "summary.json")
    assert (tmp_path / "summary.json").read_bytes() == (GOLDEN / "summary.json").read_bytes()


def test_the_last_calibration_of_each_joint_is_alone_and_all_are_kept() -> None:
    summary = summarise(analysis())
    assert list(summary["joints"]) == ["left_knee", "left_ankle"]
    assert summary["joints"]["left_knee"]["lag_s"] == 0.0
    assert [span["walks"] for span in summary["calibrations"]] == [["walk 1"], ["walk 2"]]
    assert summary["calibrations"][0]["joints"]["left_knee"]["lag_s"] == -0.03125


def test_a_figure_that_could_not_be_found_is_null() -> None:
    ankle = summarise(analysis())["joints"]["left_ankle"]
    nulls = ("axis_sd_deg", "centre_proximal_m", "centre_distal_m", "centre_sd_mm", "sign_margin")
    assert [ankle[name] for name in nulls] == [None] * 5
    assert ankle["from"] == {"standing": None, "free_motion": None, "walks": ["walk 1", "walk 2"]}


def test_a_session_without_joints_is_a_summary_all_the_same(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    write_summary(Analysis(Method.PUBLISHED, False, (), ()), path)
    empty: dict[str, object] = {"joints": {}, "calibrations": [], "walks": {}, "findings": []}
    summary = read_json(path, FORMAT)
    assert summary is not None
    assert summary.pop("reference_group")["group"] == "young adults, barefoot, treadmill"
    assert summary.pop("error_figures") == {"source": "published"}
    assert summary == {"format": FORMAT, "simulated": False, **empty}


@pytest.mark.parametrize("content", [b"", b"[1]", b'{"format": "other/1"}', b"\xff\xfe\x00", b'{"format": '])
def test_a_file_of_another_program_is_no_summary(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "summary.json").write_bytes(content)
    assert read_json(tmp_path / "summary.json", FORMAT) is None
    assert read_json(tmp_path / "missing.json", FORMAT) is None


def test_names_in_any_script_survive(tmp_path: Path) -> None:
    finding = Finding("unknown_key", Severity.INFO, "", {"name": "gangbild_größe"})
    write_summary(Analysis(Method.ROBUST, False, (), (), (finding,)), tmp_path / "summary.json")
    assert "gangbild_größe" in (tmp_path / "summary.json").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "summary.json").read_bytes())["findings"][0]["severity"] == "info"


def test_a_name_that_is_no_text_is_still_json(tmp_path: Path) -> None:
    finding = Finding(
        "file_left_out", Severity.INFO, "walk 1", {"name": b"caf\xe9.csv".decode(errors="surrogateescape")}
    )
    write_summary(Analysis(Method.ROBUST, False, (), (), (finding,)), tmp_path / "summary.json")
    summary = read_json(tmp_path / "summary.json", FORMAT)
    assert summary is not None
    assert summary["findings"][0]["numbers"]["name"] == "caf\udce9.csv"
