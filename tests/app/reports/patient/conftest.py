"""Simulated visits that the report's tests share: a short one, a prosthesis user's three alignments, one with hips."""

from dataclasses import replace
from datetime import datetime, timedelta, timezone

import pytest

from app.reports.patient.document import make_report
from app.summary.facts import Facts
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Side
from core.session import RecordingKind
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk
from tests.app.hip_visits import hip_facts
from tests.simulated import analysis_of, session_of

MADE_AT = datetime(2026, 11, 21, 22, 15, 30, tzinfo=timezone(timedelta(hours=1)))


@pytest.fixture(scope="session")
def demonstration() -> AnalysedVisit:
    session = session_of(DEMONSTRATION)
    return AnalysedVisit(session, analysis_of(session))


@pytest.fixture(scope="session")
def one_leg() -> AnalysedVisit:
    """The demonstration's left leg; the right one wears no sensor."""
    reported = session_of(DEMONSTRATION)
    recordings = tuple(
        replace(r, imu={site: block for site, block in r.imu.items() if site.side is Side.LEFT})
        for r in reported.recordings
    )
    session = replace(reported, recordings=recordings)
    return AnalysedVisit(session, analysis_of(session))


@pytest.fixture(scope="session")
def alignments() -> AnalysedVisit:
    walks = tuple(Walk(name=f"walk {k}", strides=13, speed_m_s=speed) for k, speed in ((1, 1.05), (2, 1.15), (3, 1.2)))
    settings = replace(DEMONSTRATION, seed=7, prosthetic_side=Side.RIGHT)
    reported = session_of(replace(settings, recordings=(Standing(), FreeMotion(), *walks)))
    letters = iter("ABC")
    recorded = tuple(
        replace(r, condition=f"alignment {next(letters)}") if r.kind is RecordingKind.WALKING else r
        for r in reported.recordings
    )
    session = replace(reported, recordings=recorded, started="2026-11-20T09:42:00+01:00")
    return AnalysedVisit(session, analysis_of(session))


@pytest.fixture(scope="session")
def hips() -> Facts:
    """Of a visit with a sensor on the pelvis."""
    return hip_facts()


@pytest.fixture(scope="session")
def demo(demonstration: AnalysedVisit) -> ReportRequest:
    return ReportRequest(demonstration, ("walk 1",), MADE_AT, "1.2.3")


@pytest.fixture(scope="session")
def demo_report(demo: ReportRequest) -> bytes:
    return make_report(demo)


@pytest.fixture(scope="session")
def request_of_one_leg(one_leg: AnalysedVisit) -> ReportRequest:
    return ReportRequest(one_leg, ("walk 1",), MADE_AT, "1.2.3")


@pytest.fixture(scope="session")
def aligned(alignments: AnalysedVisit) -> ReportRequest:
    return ReportRequest(alignments, ("walk 1", "walk 2", "walk 3"), MADE_AT, "1.2.3")
