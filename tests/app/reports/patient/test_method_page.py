"""Tests of the last page of a walk: how it was measured. It covers this walk only, and nothing that nobody knows."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from syrupy.assertion import SnapshotAssertion

from app.reports.patient.document import facts_of
from app.reports.patient.how_measured import how_measured
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Side, Site
from core.findings import Finding, Severity
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.results import AxisSource, Calibration, Method
from core.samples import RateKind, SensorInfo
from core.verdicts.sigmas import using
from tests.app.cohort.repeatability.own_study import own_study

ROOT = Path(__file__).parents[4]
MTI = SensorInfo("0123", "MTi", "4.2", 100.0, RateKind.INSTANTANEOUS)


def stated(request: ReportRequest) -> dict[str, str]:
    """The words under each title, without marks of direction."""
    done, rest = how_measured(facts_of(request), "9.8.7")
    return {title: re.sub("[\u2066-\u2069]", "", words) for title, words in (*done, *rest)}


def changed(request: ReportRequest, usual: ReportRequest) -> dict[str, str]:
    """What is stated otherwise than usually."""
    return dict(stated(request).items() - stated(usual).items())


def of(request: ReportRequest, **analysis: Any) -> ReportRequest:
    visit = request.visit
    return replace(request, visit=AnalysedVisit(visit.session, replace(visit.analysis, **analysis)))


def with_session(request: ReportRequest, **session: Any) -> ReportRequest:
    visit = request.visit
    return replace(request, visit=AnalysedVisit(replace(visit.session, **session), visit.analysis))


def with_finding(request: ReportRequest, finding: Finding) -> ReportRequest:
    return of(request, findings=(*request.visit.analysis.findings, finding))


def test_the_page_of_the_method_states_how_it_was_measured(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    assert stated(with_session(demo, sensors=dict.fromkeys(Site, MTI))) == snapshot


def test_the_page_of_the_method_names_an_own_study_where_one_is_in_use(demo: ReportRequest) -> None:
    assert "Error figures" not in stated(demo)
    with using(own_study().figures):
        reported = stated(demo)
    assert reported["Error figures"] == "Error figures: own study, 20 people, 12 Nov 2026."


def test_what_no_sensor_reported_is_stated_to_be_unknown(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    usual = with_session(demo, sensors=dict.fromkeys(Site, MTI))
    sensors: dict[str, dict[Site, SensorInfo]] = {
        "nothing": {},
        "of six models": {site: replace(MTI, model=f"model {k}") for k, site in enumerate(Site)},
        "of two rates": {site: replace(MTI, rate_hz=60.0 if site.side is Side.LEFT else 120.0) for site in Site},
    }
    assert {name: changed(with_session(demo, sensors=one), usual) for name, one in sensors.items()} == snapshot


def test_what_a_sensor_states_of_itself_is_one_short_line(demo: ReportRequest) -> None:
    reported = stated(with_session(demo, sensors=dict.fromkeys(Site, replace(MTI, model="W\n" * 300, firmware=""))))
    words = reported["Sensors"].replace("\u200b", "")
    assert words.startswith("6 × W W W")
    assert 20 < words.index("…") < 45


def test_what_each_joint_of_a_prosthetic_side_is_taken_for_is_stated_with_its_prosthesis(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    assert "Prosthesis" not in stated(demo)
    worn = (
        Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH),
        Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.LOCKED),
        Prosthesis(foot=FootKind.MULTI_AXIAL),
    )
    assert [stated(of(demo, prostheses={Side.LEFT: one}))["Prosthesis"] for one in worn] == snapshot


def test_what_was_noticed_changes_what_is_stated(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    """The end of a range, averaged rates, feet without a sensor: each stated where it was noticed of this walk only."""
    usual = with_session(demo, sensors={})
    assert "no samples reach its limit" in stated(usual)["Sensors"]
    noticed = (
        Finding("clipped", Severity.WARNING, f"left_foot, {usual.shown}", {"percent": 1.0}),
        Finding("rate_kind_found", Severity.INFO, "session", {"kind": "averaged"}),
        Finding("events_from_shank", Severity.INFO, f"left_foot, {usual.shown}", {}),
        Finding("clipped", Severity.WARNING, "left_foot, another walk", {"percent": 1.0}),
    )
    assert {f"{one.key}, {one.where}": changed(with_finding(usual, one), usual) for one in noticed} == snapshot


def test_the_calibration_is_that_of_the_walk(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    def recalibrated(**changes: Any) -> ReportRequest:
        calibrations = tuple(
            Calibration(one.walks, {joint: replace(found, **changes) for joint, found in one.joints.items()})
            for one in demo.visit.analysis.calibrations
        )
        return of(demo, calibrations=calibrations)

    assert "Gyroscope offsets: from standing or other moments at rest." in stated(demo)["Calibration"]
    assert {
        "no free motion": changed(recalibrated(axis_source=AxisSource.WALKING), demo),
        "no moment at rest": changed(recalibrated(gyro_bias_distal_rad_s=None), demo),
        "the published method": changed(of(demo, method=Method.PUBLISHED), demo),
    } == snapshot


def test_only_what_was_worn_is_named(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    def worn(*sites: Site) -> str:
        recordings = tuple(
            replace(one, imu={site: block for site, block in one.imu.items() if site in sites})
            for one in demo.visit.session.recordings
        )
        return stated(with_session(demo, recordings=recordings))["Sensors"]

    assert {
        "left knee": worn(Site.LEFT_THIGH, Site.LEFT_SHANK),
        "right foot": worn(Site.RIGHT_FOOT),
        "one of each leg": worn(Site.RIGHT_FOOT, Site.LEFT_SHANK),
    } == snapshot


def test_the_accuracy_is_what_was_measured(demo: ReportRequest) -> None:
    """Each figure is on the manual's page Accuracy."""
    words = stated(demo)["Accuracy"]
    table = (ROOT / "resources" / "help" / "accuracy.md").read_text(encoding="utf-8")
    hinges = re.findall(r"\| hinge 1D_0\d \| angle [^|]*\| ([\d.]+)° ", table)
    assert "two mechanical hinges {}° and {}°".format(*hinges) in words
    late_ms, *sd_ms = (
        *re.findall(r"\| feet \| initial contact: [^|]*\| (?:[^|,]*, ){2}([\d.]+) ms", table),
        *re.findall(r"\| feet \| (?:initial contact|toe-off): [^|]*\| (?:[^|,]*, ){3}([\d.]+) ms", table),
    )
    assert f"SD {sd_ms[0]} and {sd_ms[1]} ms, contacts {float(late_ms):.0f} ms later than optical" in words
    ((bias, spread),) = re.findall(r"\| feet \| stride length [^|]*\| -([\d.]+) %, ([\d.]+) cm", table)
    assert f"stride length {bias} % too short, SD {spread} cm" in words
    knees = re.findall(r"on one person knees ([\d.]+)° and ([\d.]+)° and ankles ([\d.]+)° from optics", table)
    assert "{}° and {}° at the knees, {}° at the ankles".format(*knees[0]) in words
