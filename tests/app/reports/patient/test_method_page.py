"""Tests of the last page of a walk: how it was measured. It covers this walk only, and nothing that nobody knows."""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

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


def with_sensors(request: ReportRequest, sensors: Mapping[Site, SensorInfo]) -> ReportRequest:
    visit = request.visit
    return replace(request, visit=AnalysedVisit(replace(visit.session, sensors=sensors), visit.analysis))


def with_finding(request: ReportRequest, finding: Finding) -> ReportRequest:
    visit = request.visit
    findings = (*visit.analysis.findings, finding)
    return replace(request, visit=AnalysedVisit(visit.session, replace(visit.analysis, findings=findings)))


def test_the_page_of_the_method_states_how_it_was_measured(demo: ReportRequest) -> None:
    reported = stated(with_sensors(demo, dict.fromkeys(Site, MTI)))
    for title, words in {
        "Sensors": "6 × MTi, firmware 4.2, set to 100 Hz, 100.0 Hz by time stamps, on thigh, shank and foot of both",
        "Calibration": "from the patient's own free motion, for the ankle also from the walks. No set posture",
        "Angles": (
            "VQF (Laidig, Seel 2023), forward and backward, without magnetometer, time constant 3 s, from "
            "instantaneous angular rates. A joint angle is the rotation of the lower segment relative to the upper one "
            "about the joint's own axis. It is one of three"
        ),
        "Events and strides": "Initial contact and toe\u2011off: from the tilt of the foot; for feet that hardly roll",
        "Accuracy": "Not tested on patients, after knee replacement or on real prostheses",
        "Software": "Gaitwright 9.8.7, the robust method",
    }.items():
        assert words in reported[title], title
    assert (
        "Standing reference: this patient's posture on this day, or the goniometer value entered."
        in reported["Calibration"]
    )
    assert "gaps up to 0.05 s are bridged" in reported["Angles"]


def test_the_page_of_the_method_names_an_own_study_where_one_is_in_use(demo: ReportRequest) -> None:
    assert "Error figures" not in stated(demo)
    with using(own_study().figures):
        reported = stated(demo)
    assert reported["Error figures"] == "Error figures: own study, 20 people, 12 Nov 2026."


def test_what_no_sensor_reported_is_stated_to_be_unknown(demo: ReportRequest) -> None:
    reported = stated(with_sensors(demo, {}))
    assert reported["Sensors"].startswith("6 × sensor of unknown model, 100.0 Hz by time stamps, on ")
    assert "The measuring range is not in the recording" in reported["Sensors"]
    assert "from angular rates of unknown kind" in reported["Angles"]
    differing = {site: replace(MTI, model=f"model {k}") for k, site in enumerate(Site)}
    assert stated(with_sensors(demo, differing))["Sensors"].startswith("6 sensors of 6 models, ")
    unlike = {site: replace(MTI, rate_hz=60.0 if site.side is Side.LEFT else 120.0) for site in Site}
    assert "set to 60–120 Hz" in stated(with_sensors(demo, unlike))["Sensors"]


def test_what_a_sensor_states_of_itself_is_one_short_line(demo: ReportRequest) -> None:
    reported = stated(with_sensors(demo, dict.fromkeys(Site, replace(MTI, model="W\n" * 300, firmware=""))))
    words = reported["Sensors"].replace("\u200b", "")
    assert words.startswith("6 × W W W")
    assert 20 < words.index("…") < 45


def test_what_each_joint_of_a_prosthetic_side_is_taken_for_is_stated_with_its_prosthesis(demo: ReportRequest) -> None:
    assert "Prosthesis" not in stated(demo)
    for worn, words in (
        (
            Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH),
            "Transtibial prosthesis left, SACH foot. Left knee: the patient's own, so its uncertainty is that of a "
            "living joint. Left ankle: a foot without ankle joint; the angle is the foot relative to the shank.",
        ),
        (
            Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.LOCKED),
            "Transfemoral prosthesis left, manual-lock knee. Left knee: a joint of the prosthesis. "
            "Left ankle: a joint of the prosthesis.",
        ),
        (Prosthesis(foot=FootKind.MULTI_AXIAL), "Prosthesis left, multi-axial foot."),
    ):
        analysis = replace(demo.visit.analysis, prostheses={Side.LEFT: worn})
        request = replace(demo, visit=AnalysedVisit(demo.visit.session, analysis))
        assert stated(request)["Prosthesis"] == words


def test_what_was_noticed_changes_what_is_stated(demo: ReportRequest) -> None:
    """The end of a range, averaged rates, feet without a sensor: each stated where it was noticed of this walk only."""
    request = with_sensors(demo, {})
    walk = request.shown
    plain = stated(request)
    assert "no samples reach its limit" in plain["Sensors"]
    cases = [
        (
            Finding("clipped", Severity.WARNING, f"left_foot, {walk}", {"percent": 1.0}),
            "Sensors",
            "some samples reach its limit",
        ),
        (
            Finding("rate_kind_found", Severity.INFO, "session", {"kind": "averaged"}),
            "Angles",
            "angular rates averaged by the sensors",
        ),
        (
            Finding("events_from_shank", Severity.INFO, f"left_foot, {walk}", {}),
            "Events and strides",
            "where a foot has no sensor",
        ),
    ]
    for finding, title, words in cases:
        assert words in stated(with_finding(request, finding))[title]
        assert words not in plain[title]
    elsewhere = Finding("clipped", Severity.WARNING, "left_foot, another walk", {"percent": 1.0})
    assert stated(with_finding(request, elsewhere)) == plain


def test_the_calibration_is_that_of_the_walk(demo: ReportRequest) -> None:
    visit = demo.visit

    def changed(**changes: Any) -> dict[str, str]:
        calibrations = tuple(
            Calibration(one.walks, {joint: replace(found, **changes) for joint, found in one.joints.items()})
            for one in visit.analysis.calibrations
        )
        analysis = replace(visit.analysis, calibrations=calibrations)
        return stated(replace(demo, visit=AnalysedVisit(visit.session, analysis)))

    assert "Gyroscope offsets: from standing or other moments at rest." in stated(demo)["Calibration"]
    assert (
        "come from the walks, as no free motion was recorded" in changed(axis_source=AxisSource.WALKING)["Calibration"]
    )
    assert "Gyroscope offsets: unknown" in changed(gyro_bias_distal_rad_s=None)["Calibration"]
    published = replace(visit.analysis, method=Method.PUBLISHED)
    reported = stated(replace(demo, visit=AnalysedVisit(visit.session, published)))
    assert "equation 15 of the published method" in reported["Angles"]
    assert "the published method (after Seel" in reported["Software"]


def test_only_what_was_worn_is_named(demo: ReportRequest) -> None:
    visit = demo.visit

    def worn(*sites: Site) -> str:
        recordings = tuple(
            replace(one, imu={site: block for site, block in one.imu.items() if site in sites})
            for one in visit.session.recordings
        )
        session = replace(visit.session, recordings=recordings)
        return stated(replace(demo, visit=AnalysedVisit(session, visit.analysis)))["Sensors"]

    assert "2 × simulated, " in worn(Site.LEFT_THIGH, Site.LEFT_SHANK)
    assert ", on thigh and shank of the left leg, strapped" in worn(Site.LEFT_THIGH, Site.LEFT_SHANK)
    assert ", on foot of the right leg, strapped" in worn(Site.RIGHT_FOOT)
    assert ", on shank and foot of both legs, strapped" in worn(Site.RIGHT_FOOT, Site.LEFT_SHANK)


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
