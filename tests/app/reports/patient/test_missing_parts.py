"""Tests of the report where something is missing. Every case is stated in words, and no number is invented."""

import io
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pypdf
import pytest

from app.reports.patient.document import make_report, report_data
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import LEG_JOINTS, Joint, Side, Site
from core.findings import Finding, Severity
from core.gait.strides import Reason
from core.results import Analysis, SideGait, ZeroKind
from tests.app.changed_analysis import recalibrated, rewalked, with_few_strides
from tests.core.verdicts.built_walk import with_gaps

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


def pages_of(pdf: bytes) -> list[str]:
    """Give the text of every page, in lines of one space."""
    return [" ".join(page.extract_text().split()) for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]


def shown(request: ReportRequest) -> list[str]:
    return pages_of(make_report(request))


@pytest.fixture(scope="module")
def usual(demo_report: bytes) -> list[str]:
    return pages_of(demo_report)


def with_analysis(request: ReportRequest, analysis: Analysis) -> ReportRequest:
    return replace(request, visit=AnalysedVisit(request.visit.session, analysis))


def with_walk(request: ReportRequest, gait: Mapping[Side, SideGait]) -> ReportRequest:
    return with_analysis(request, rewalked(request.visit.analysis, gait=gait))


def gait_of(request: ReportRequest) -> Mapping[Side, SideGait]:
    return request.visit.walk(request.shown).gait


def with_joints(request: ReportRequest, *joints: Joint, **change: object) -> ReportRequest:
    """Change some joints' calibrations alike; none named: all."""
    return with_analysis(request, recalibrated(request.visit.analysis, joints or LEG_JOINTS, **change))


def with_strides(request: ReportRequest, count: int) -> ReportRequest:
    """Leave all but the first `count` strides of either side out, as turning."""
    return with_analysis(request, with_few_strides(request.visit.analysis, left=count, right=count))


def without_zero(request: ReportRequest) -> ReportRequest:
    return with_joints(request, zero=ZeroKind.NONE)


def readable(request: ReportRequest) -> dict[str, list[str]]:
    """What the table of data quality states: shape, height and timing of each joint, then of both legs, of distance."""
    pages = report_data(request)["pages"]
    (blocks,) = (page for page in pages if any(block.get("label") == "quality" for block in page))
    found = [row["cells"] for row in next(block["rows"] for block in blocks if block["kind"] == "table")]
    rows = {cells[0]["said"]: [cell["said"] for cell in cells[1:]] for cells in found}
    note = next(block["said"] for block in blocks if block["kind"] == "note")
    wide = {label: [word.capitalize()] for label, word in re.findall(r"(Left vs right|Distance): ([\w ]+)\.", note)}
    return rows | wide


READ, CARE, NOT_REPORTED = "Good", "Caution", "Not reported"


def test_without_a_zero_no_height_is_reported(demo: ReportRequest) -> None:
    request = without_zero(demo)
    pages = shown(request)
    assert readable(request)["Left knee"] == [READ, NOT_REPORTED, READ]
    assert "Absolute angle of all joints: not reported. There is no standing reference" in pages[0]
    assert "none: no absolute angles" in pages[3]
    assert "Knee flexion, stance to swing" in pages[0]
    assert "Knee minus its mean, °" in pages[0]
    assert not re.search(r"[LR] \d+°", pages[0].split("Knee minus its mean")[1].split("Largest")[0])  # no value
    assert "minus its mean, degrees" in pages[1]
    assert "No reference band: without a standing reference there are no absolute angles to compare" in pages[1]
    assert "At initial contact" not in pages[1]


def test_one_leg_alone_is_not_compared(demo: ReportRequest) -> None:
    gait = {Side.LEFT: gait_of(demo)[Side.LEFT]}
    request = with_walk(demo, gait)
    pages = shown(request)
    assert list(readable(request)) == ["Left knee", "Left ankle", "Distance"]
    assert "Right knee" not in pages[0]
    assert "Stride time, s 1.08 ± 0.01 not measured – – – –" in pages[2]
    assert "Range of motion 61.7 ± 0.8 not measured – – " in pages[1]
    assert not re.search(r"similar|\bvs\b|\bright\b", pages[0].split("Summary")[1])


def test_without_a_foot_sensor_a_line_is_in_place_of_the_ankle(demo: ReportRequest) -> None:
    def knees_only(gait: SideGait) -> SideGait:
        return replace(gait, cycles={joint: cycles for joint, cycles in gait.cycles.items() if joint.is_knee})

    gait = {side: knees_only(g) for side, g in gait_of(demo).items()}
    request = with_walk(demo, gait)
    session = request.visit.session
    recordings = tuple(
        replace(r, imu={site: block for site, block in r.imu.items() if "foot" not in site}) for r in session.recordings
    )
    pages = shown(
        replace(request, visit=AnalysedVisit(replace(session, recordings=recordings), request.visit.analysis))
    )
    assert "Ankle not measured: no sensor on the left and right foot." in pages[1]
    assert "Ankle: movement ranges" not in pages[1]
    assert "Ankle not measured: no sensor on the left and right foot." in pages[0]


def test_two_strides_make_no_mean_and_no_number(demo: ReportRequest) -> None:
    request = with_strides(demo, 2)
    pages = shown(request)
    assert readable(request)["Right knee"] == [NOT_REPORTED] * 3
    assert "Both legs: not reported. Few strides (2 used, 3 required)." in pages[0]
    assert "Both legs: Few strides (2 used, 3 required). Let the patient walk longer." in pages[3]
    assert "±" not in pages[1].split("Range of motion")[1].split("Windows in brackets")[0]
    assert "Range of motion not reported not reported – – " in pages[1]
    assert "beyond" not in pages[1].split("Windows in brackets")[0]
    assert "Largest differences" not in pages[0]


def test_single_strides_that_make_no_mean_are_drawn_each_with_its_letter(demo: ReportRequest) -> None:
    pages = report_data(with_strides(demo, 2))["pages"]
    drawn = [picture["svg"] for block in pages[0] if block["kind"] == "figures" for picture in block["pictures"]][:2]
    assert [(svg.count(">L<"), svg.count(">R<")) for svg in drawn] == [(2, 2), (2, 2)]
    assert not any("Not reported" in svg for svg in drawn)


def test_five_strides_make_a_mean_without_a_spread(demo: ReportRequest) -> None:
    request = with_strides(demo, 5)
    page = report_data(request)["pages"][0]
    (table,) = (block for block in page if block["kind"] == "table")
    swing = next(row["cells"] for row in table["rows"] if "cells" in row and "swing (55" in row["cells"][0]["said"])
    assert swing[1]["grey"] is swing[2]["grey"] is True
    assert "±" not in swing[1]["said"]
    assert swing[1]["said"].endswith("*")
    assert "Both legs: caution. Few strides (5 used, 10 required)." in shown(request)[0]


def test_one_short_leg_does_not_hide_the_other(demo: ReportRequest) -> None:
    request = with_analysis(demo, with_few_strides(demo.visit.analysis, left=2))
    pages = shown(request)
    assert readable(request)["Left knee"] == [NOT_REPORTED] * 3
    assert readable(request)["Right knee"] == [READ] * 3
    assert "Left leg: not reported. Few strides (2 used, 3 required)." in pages[0]
    assert re.search(r"Range of motion not reported \d+\.\d ± \d\.\d – –", pages[1])


def test_no_stride_at_all_still_makes_a_report_of_one_page(demo: ReportRequest) -> None:
    pages = shown(with_walk(demo, {}))
    assert len(pages) == 1
    assert "No results for this walk: no foot or shank sensor showed a stride." in pages[0]
    assert "Signature" in pages[0]


def test_an_axis_beyond_its_limit_is_marked_and_a_worse_one_not_reported(demo: ReportRequest) -> None:
    request = with_joints(demo, axis_sd_rad=np.deg2rad(8.0))
    pages = shown(request)
    assert readable(request)["Left knee"] == readable(request)["Right ankle"] == [CARE, CARE, READ]
    assert "All joints: caution. The calibration has an uncertainty of ±8.0° (limit ±6.5°)." in pages[0]
    assert "All joints: The calibration has an uncertainty of ±8.0° (limit ±6.5°). Record free motion" in pages[3]
    assert "0.9 *" in pages[1]
    assert "*: caution; reason under data quality." in pages[1]
    request = with_joints(demo, Joint.LEFT_ANKLE, axis_sd_rad=np.deg2rad(9.5))
    pages = shown(request)
    assert readable(request)["Left ankle"] == [NOT_REPORTED, NOT_REPORTED, READ]
    assert readable(request)["Left knee"] == [READ] * 3
    assert "Left ankle: not reported. The calibration has an uncertainty of ±9.5° (limit ±9.0°)." in pages[0]
    assert "Not reported ±9.5°, limit ±9.0°" in pages[0]
    assert "*" not in pages[1]


def test_an_uncertain_sign_leaves_the_range_alone(demo: ReportRequest) -> None:
    pages = shown(with_joints(demo, Joint.LEFT_KNEE, is_sign_certain=False))
    stated = "All values of left knee except range of motion: not reported. Flexion and extension could not be"
    assert stated in pages[0]
    assert "Not drawn: left knee (not reported)." in pages[1]
    assert "loading (5–30 %) not reported 14.0" in pages[1]
    assert re.search(r"Range of motion 61\.7 ± 0\.8 63\.0", pages[1])


def test_sensors_that_are_no_adjacent_leave_no_number_of_their_joint(demo: ReportRequest, usual: list[str]) -> None:
    request = with_joints(demo, Joint.RIGHT_ANKLE, is_same_joint=False, sign_margin=1.05)
    pages = shown(request)
    assert len(pages) == len(usual)
    reported = readable(request)
    assert reported["Right knee"] == [READ, READ, CARE]  # its foot's sensor may not be on this foot
    assert reported["Right ankle"] == [NOT_REPORTED, NOT_REPORTED, CARE]
    assert reported["Left knee"] == reported["Left ankle"] == [READ] * 3
    assert (reported["Left vs right"], reported["Distance"]) == ([READ], [CARE])
    stated = "Sensor positions could not be confirmed (clarity 1.05, required 1.50)."
    assert f"Right ankle: not reported. {stated}" in pages[0]
    assert stated in pages[1]
    assert re.search(r"Ankle [\w ,-]+ \d+\.\d° – R not reported –", pages[0])
    ankle = pages[1].split("Ankle: movement ranges")[1].split("Windows in brackets")[0]
    assert ankle.count("not reported") == 10  # four movements, the range, five angles
    assert "Not drawn: right ankle (not reported)." in pages[1]
    assert "Double support (% gait cycle) not reported" in pages[2]
    assert "not reported" not in "".join(usual[:3]).casefold()


def test_a_child_and_a_crawl_stand_beside_no_band(demo: ReportRequest) -> None:
    session = demo.visit.session
    child = replace(session, started="2026-11-20T09:42:00+01:00", patient=replace(session.patient, birth_year=2016))
    visit = AnalysedVisit(child, demo.visit.analysis)
    pages = shown(replace(demo, visit=visit))
    for page in pages:
        assert "No reference: all reference groups are adults." in page


def test_visits_with_different_zeros_are_compared_in_shape_and_range_only(demo: ReportRequest) -> None:
    visit = demo.visit
    unset = without_zero(demo).visit
    pages = shown(replace(demo, earlier=unset))
    page = pages[4]
    assert (
        "The standing reference is missing or of another kind: only range of motion and timing are compared."
    ) in page
    assert "Left: knee angle minus its mean, degrees (flexion +)" in page
    assert "Reference mean, ±1 SD" not in page
    assert "Peak knee flexion, swing not reported 58.8 ± 0.9 – – not reported" in page
    assert re.search(r"Knee range of motion 61\.7 ± 0\.8 61\.7 ± 0\.8 0\.0 −\d+ to \+\d+ may be error", page)
    assert "degrees (flexion +" in shown(replace(demo, earlier=visit))[4]


def test_gaps_and_slips_are_stated(demo: ReportRequest) -> None:
    analysis = demo.visit.analysis
    slip = Finding("strap_slipped", Severity.WARNING, "walk 1, right_shank", {"from_s": 2.0, "turn_deg": 9})
    changed = rewalked(
        replace(analysis, findings=(*analysis.findings, slip)),
        received={Site.LEFT_FOOT: with_gaps(4.2, gait_of(demo)[Side.LEFT])},
        slipped_from_s={Side.RIGHT: 2.0},
    )
    request = with_analysis(demo, changed)
    pages = shown(request)
    assert "4.2 % (L foot)" in pages[3]
    assert "moved: R shank" in pages[3]
    assert readable(request)["Left ankle"][:2] == [CARE, CARE]
    remarks = pages[3].split("Data quality findings")[1]
    assert "Signal gaps over 50 ms take up 4.2 % of the strides used (1.0 % at most)." in remarks
    assert "Right leg: Strap moved; strides from 2.0 s on are excluded." in remarks
    assert re.search(r"\d+ more on page 4\.", pages[0])


def test_clocks_that_cannot_be_compared_are_stated(demo: ReportRequest, usual: list[str]) -> None:
    request = with_joints(demo, lag_sd_s=None, is_clock_shared=False)
    pages = shown(request)
    assert len(pages) == len(usual)
    assert readable(request)["Left knee"][:2] == [NOT_REPORTED, NOT_REPORTED]
    assert "All joints: not reported. The two sensors could not be synchronised from the movement." in pages[0]
    assert "not determinable" in pages[3]
    assert "not determinable" not in usual[3]


def test_strides_left_out_are_counted_by_their_reasons(demo: ReportRequest) -> None:
    gait = gait_of(demo)
    strides = gait[Side.LEFT].strides
    reason = (Reason.TURN,) * 2 + (Reason.STOP,) + (Reason.USED,) * (len(strides) - 3)
    left = replace(gait[Side.LEFT], strides=replace(strides, reason=reason))
    page = shown(with_walk(demo, {**gait, Side.LEFT: left}))[3]
    assert "L 2 turning, 1 stopping" in page
    assert "mostly" not in page


@pytest.mark.parametrize("simulated", [True, False])
def test_simulated_data_say_so_everywhere_and_real_data_nowhere(demo: ReportRequest, simulated: bool) -> None:
    analysis = replace(demo.visit.analysis, is_simulated=simulated, findings=())
    session = replace(demo.visit.session, sensors={})
    request = replace(demo, visit=AnalysedVisit(session, analysis))
    assert all(("SIMULATED" in page) is simulated for page in shown(request))
