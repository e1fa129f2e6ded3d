"""A visit whose patient wears a sensor on the pelvis, with anything about its hips changed."""

from dataclasses import replace
from datetime import UTC, datetime

from app.summary.facts import Facts
from app.summary.request import AnalysedVisit, ReportRequest
from core.results import Analysis
from core.session import Session
from tests.app.changed_analysis import visit_of
from tests.core.hip.hip_sessions import settings, walk_of
from tests.simulated import analysis_of, session_of

LATE_S = 0.04
MADE_AT = datetime(2026, 11, 24, 12, tzinfo=UTC)


def hip_analysis() -> Analysis:
    """A clock per leg, the right one late, found through the hips; all is read but the pelvis's tilt."""
    return analysis_of(session_of(settings(late_s=LATE_S)))


def hip_session() -> Session:
    """What it was made of."""
    session = session_of(settings(late_s=LATE_S))
    return replace(session, patient=replace(session.patient, code="P-001"))


def hip_visit(analysis: Analysis | None = None) -> AnalysedVisit:
    """The visit, as it is or with another analysis."""
    return visit_of(analysis if analysis is not None else hip_analysis(), hip_session())


def hip_facts(analysis: Analysis | None = None) -> Facts:
    """What the report knows of its walk."""
    visit = hip_visit(analysis)
    return Facts(visit, walk_of(visit.analysis))


def hip_request(analysis: Analysis | None = None) -> ReportRequest:
    """A report of its walk."""
    return ReportRequest(hip_visit(analysis), ("walk 1",), MADE_AT, "1.2.3")
