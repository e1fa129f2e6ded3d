"""What does the report say where something is missing? Every case is said in words, and no number is invented."""

import io
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pypdf
import pytest

from app.reports.patient_report.document import make_report, report_data
from app.reports.patient_report.request import ReportRequest, Visit
from core.body import Joint, Side
from core.findings import Finding, Severity
from core.gait.strides import Reason
from core.results import Analysis, JointCalibration, RecordingAnalysis, SideGait, ZeroKind

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


def shown(request: ReportRequest) -> list[str]:
    """Give the text of every page, in lines of one space."""
    pages = pypdf.PdfReader(io.BytesIO(make_report(request))).pages
    return [" ".join(page.extract_text().split()) for page in pages]


def with_analysis(request: ReportRequest, analysis: Analysis) -> ReportRequest:
    return replace(request, visit=Visit(request.visit.session, analysis))


def with_walk(request: ReportRequest, gait: Mapping[Side, SideGait]) -> ReportRequest:
    analysis = request.visit.analysis
    walks = tuple(replace(r, gait=gait) if r.name == request.shown else r for r in analysis.recordings)
    return with_analysis(request, replace(analysis, recordings=walks))


def walk_of(request: ReportRequest) -> RecordingAnalysis:
    return request.visit.walk(request.shown)


def with_joints(request: ReportRequest, change: dict[str, object]) -> ReportRequest:
    """Change every joint's calibration alike."""
    analysis = request.visit.analysis

    def changed(joints: Mapping[Joint, JointCalibration]) -> dict[Joint, JointCalibration]:
        return {joint: replace(found, **change) for joint, found in joints.items()}  # type: ignore[arg-type]  # whichever field it is

    spans = tuple(replace(span, joints=changed(span.joints)) for span in analysis.calibrations)
    return with_analysis(request, replace(analysis, calibrations=spans))


def with_strides(request: ReportRequest, count: int) -> ReportRequest:
    """Leave all but the first `count` strides of either side out, as turning."""

    def few(gait: SideGait) -> SideGait:
        reason = (Reason.USED,) * count + (Reason.TURN,) * (len(gait.strides) - count)
        return replace(gait, strides=replace(gait.strides, reason=reason))

    return with_walk(request, {side: few(gait) for side, gait in walk_of(request).gait.items()})


def without_zero(request: ReportRequest) -> ReportRequest:
    unset = with_joints(request, {"zero": ZeroKind.NONE})
    gait = {side: replace(g, without_zero=frozenset(g.cycles)) for side, g in walk_of(request).gait.items()}
    return with_walk(unset, gait)


def test_without_a_zero_no_height_is_told(request_of_demonstration: ReportRequest) -> None:
    pages = shown(without_zero(request_of_demonstration))
    assert "Quality of this recording: read with care" in pages[0]
    assert "none: heights are not shown" in pages[0]
    assert "Knee range over the stride" in pages[0]
    assert "Peak knee flexion in swing" not in pages[0]
    assert "degrees from the mean of the stride" in pages[1]
    assert "Band mean" not in pages[1]
    assert "At initial contact" not in pages[2]
    assert "Knee range, degrees, every stride" in pages[3]


def test_one_leg_alone_is_not_compared(request_of_demonstration: ReportRequest) -> None:
    gait = {Side.LEFT: walk_of(request_of_demonstration).gait[Side.LEFT]}
    pages = shown(with_walk(request_of_demonstration, gait))
    assert "not measured" in pages[0]
    assert "Stride time, s 1.08 ± 0.01 not measured – – –" in pages[0]
    assert "Range over the stride 61.7 ± 0.8 – not measured – – –" in pages[2]
    assert "symmetry" not in pages[0].split("What stands out")[1]


def test_without_a_foot_sensor_a_line_stands_in_place_of_the_ankle(request_of_demonstration: ReportRequest) -> None:
    def knees_only(gait: SideGait) -> SideGait:
        return replace(gait, cycles={joint: cycles for joint, cycles in gait.cycles.items() if joint.is_knee})

    gait = {side: knees_only(g) for side, g in walk_of(request_of_demonstration).gait.items()}
    request = with_walk(request_of_demonstration, gait)
    session = request.visit.session
    recordings = tuple(
        replace(r, imu={site: block for site, block in r.imu.items() if "foot" not in site}) for r in session.recordings
    )
    pages = shown(replace(request, visit=Visit(replace(session, recordings=recordings), request.visit.analysis)))
    assert "Ankle not measured: no sensor on the left and right foot." in pages[1]
    assert "Ankle (dorsiflexion +)" not in pages[2]


def test_two_strides_make_no_mean_and_no_verdict(request_of_demonstration: ReportRequest) -> None:
    pages = shown(with_strides(request_of_demonstration, 2))
    assert "Quality of this recording: do not read" in pages[0]
    assert "Left: 2 strides; 3 are needed." in pages[0]
    assert "±" not in pages[2].split("Range over the stride")[1].split("Distance")[0]
    assert "exceeds error" not in pages[2]


def test_five_strides_make_a_mean_without_a_spread(request_of_demonstration: ReportRequest) -> None:
    request = with_strides(request_of_demonstration, 5)
    page = report_data(request)["pages"][1]
    (table,) = (block for block in page if block["kind"] == "table")
    swing = next(row["cells"] for row in table["rows"] if "cells" in row and "swing (55" in row["cells"][0]["said"])
    assert swing[1]["grey"] is swing[3]["grey"] is True
    assert "±" not in swing[1]["said"]
    assert "Left 5 and right 5 strides only" in shown(request)[0]


def test_no_stride_at_all_still_makes_a_report(request_of_demonstration: ReportRequest) -> None:
    pages = shown(with_walk(request_of_demonstration, {}))
    assert "No foot or shank sensor told a stride of this walk." in pages[0]
    assert "do not read" in pages[0]


def test_a_weak_axis_is_named_and_marks_its_values(request_of_demonstration: ReportRequest) -> None:
    pages = shown(with_joints(request_of_demonstration, {"axis_sd_rad": np.deg2rad(9.0)}))
    assert "read with care" in pages[0]
    assert (
        "The axis of the left knee is known to 9.0° only: read it for timing and shape, not for its height." in pages[0]
    )
    assert "±" in pages[2]
    assert "0.9†" in pages[2]


def test_an_uncertain_sign_leaves_the_range_alone(request_of_demonstration: ReportRequest) -> None:
    gait = walk_of(request_of_demonstration).gait
    left = replace(gait[Side.LEFT], sign_in_doubt=frozenset({Joint.LEFT_KNEE}))
    pages = shown(with_walk(request_of_demonstration, {**gait, Side.LEFT: left}))
    assert "does not tell flexion from extension of the left knee" in pages[0]
    assert "Not drawn: left knee." in pages[1]
    assert "loading (5–30 %) – – 14.0" in pages[2]


def test_a_child_and_a_crawl_stand_beside_no_band(request_of_demonstration: ReportRequest) -> None:
    session = request_of_demonstration.visit.session
    child = replace(session, started="2026-11-20T09:42:00+01:00", patient=replace(session.patient, birth_year=2016))
    visit = Visit(child, request_of_demonstration.visit.analysis)
    pages = shown(replace(request_of_demonstration, visit=visit))
    assert "no band" in pages[0]
    assert "No band: nobody of this age is in the group." in pages[1]
    assert "No band was used" in pages[4]


def test_visits_with_different_zeros_are_compared_in_shape_and_range_only(
    request_of_demonstration: ReportRequest,
) -> None:
    visit = request_of_demonstration.visit
    unset = without_zero(request_of_demonstration).visit
    pages = shown(replace(request_of_demonstration, earlier=unset))
    page = pages[3]
    assert "Zero is missing or differs in kind: only range and timing are compared." in page
    assert "Left: knee, degrees from the mean (flexion +)" in page
    assert "Band mean" not in page
    assert "Knee: most flexed, swing – 58.8 ± 0.9 – – –" in page
    assert "Knee: range over the stride 61.7 ± 0.8 61.7 ± 0.8 0.0 9.2 inside error" in page
    assert "degrees (flexion +" in shown(replace(request_of_demonstration, earlier=visit))[3]


def test_gaps_and_slips_are_said(request_of_demonstration: ReportRequest) -> None:
    analysis = request_of_demonstration.visit.analysis
    gaps = {"missing_percent": 4.2, "count": 3, "longest_s": 0.31}
    slip = {"from_s": 2.0, "turn_deg": 9}
    findings = (
        Finding("gaps", Severity.WARNING, "walk 1, left_foot", gaps),
        Finding("strap_slipped", Severity.WARNING, "walk 1, right_shank", slip),
    )
    changed = replace(analysis, findings=(*analysis.findings, *findings))
    pages = shown(with_analysis(request_of_demonstration, changed))
    assert "4.2 % (L foot)" in pages[0]
    assert "slipped: R shank" in pages[0]
    assert "read with care" in pages[0]
    assert "Remarks on this recording" in pages[4]


def test_clocks_that_cannot_be_compared_and_sensors_that_are_no_neighbours_are_said(
    request_of_demonstration: ReportRequest,
) -> None:
    untold = with_joints(request_of_demonstration, {"lag_sd_s": None})
    analysis = untold.visit.analysis
    stranger = Finding("not_the_same_joint", Severity.WARNING, str(Joint.LEFT_KNEE), {"margin": 1.1})
    pages = shown(with_analysis(untold, replace(analysis, findings=(*analysis.findings, stranger))))
    first, usual = pages[0], shown(request_of_demonstration)
    assert len(pages) == len(usual)
    assert "read with care" in first
    assert "The two sensors of the left knee do not move as neighbours" in first
    assert "how far the clocks at the left ankle, right knee and right ankle are apart" in first
    assert "not resolvable" in first
    assert "not resolvable" not in usual[0]


@pytest.mark.parametrize("simulated", [True, False])
def test_simulated_data_say_so_everywhere_and_real_data_nowhere(
    request_of_demonstration: ReportRequest, simulated: bool
) -> None:
    analysis = replace(request_of_demonstration.visit.analysis, is_simulated=simulated, findings=())
    session = replace(request_of_demonstration.visit.session, sensors={})
    request = replace(request_of_demonstration, visit=Visit(session, analysis))
    assert all(("SIMULATED" in page) is simulated for page in shown(request))
