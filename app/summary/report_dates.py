"""Format a day as people write it; what is no date stays as it was reported."""

import datetime

from app.summary.plain_text import typed
from app.wording.dates import date


def date_of(started: str) -> datetime.date | None:
    """The day of an ISO 8601 stamp; None where it is none."""
    try:
        return datetime.datetime.fromisoformat(started).date()
    except ValueError:
        return None


def day(started: str) -> str:
    """Give the day of an ISO 8601 stamp as people write it; as it is where it is none."""
    try:
        return date(datetime.datetime.fromisoformat(started))
    except ValueError:
        return typed(started)


def moment(started: str) -> str:
    try:
        return f"{day(started)}, {datetime.datetime.fromisoformat(started):%H:%M}"
    except ValueError:
        return typed(started)
