"""Agreements with a patient by the day of a session.

The session's day counts for all its walks: none of them was made before it.
"""

from app.summary.report_dates import date_of
from core.goals import AgreedGoals, agreed_by
from core.session import Session


def agreed_with(session: Session) -> AgreedGoals:
    """Goals by the session's day; none where that is not known."""
    return agreed_by(session.patient.goals, date_of(session.started))
