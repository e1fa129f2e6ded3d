"""How is a day written? As people write it; what is no date stays as it was told."""

from datetime import datetime

from app.reports.patient_report.plain_text import typed
from app.wording import tr


def day(started: str) -> str:
    """Give the day of an ISO 8601 stamp as people write it; as it is where it is none."""
    try:
        when = datetime.fromisoformat(started)
    except ValueError:
        return typed(started)
    months = (
        tr("Jan"), tr("Feb"), tr("Mar"), tr("Apr"), tr("May"), tr("Jun"),
        tr("Jul"), tr("Aug"), tr("Sep"), tr("Oct"), tr("Nov"), tr("Dec"),
    )  # fmt: skip
    return tr("{day} {month} {year}").format(day=when.day, month=months[when.month - 1], year=when.year)


def moment(started: str) -> str:
    try:
        return f"{day(started)}, {datetime.fromisoformat(started):%H:%M}"
    except ValueError:
        return typed(started)
