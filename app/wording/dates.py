"""Wording of a day: in the operator's language, never with a month as a number."""

import datetime
from collections.abc import Callable, Collection

from app.wording.translation import later, tr

MONTHS = (
    *(later("January"), later("February"), later("March"), later("April"), later("May"), later("June")),
    *(later("July"), later("August"), later("September"), later("October"), later("November"), later("December")),
)


def date(day: datetime.date) -> str:
    """As "24 Oct 2026"."""
    return tr("{day} {month} {year}").format(day=day.day, month=_month(day), year=day.year)


def short_date(day: datetime.date) -> str:
    """Without its year, as on an axis."""
    return tr("{day} {month}").format(day=day.day, month=_month(day))


def long_date(day: datetime.date, say: Callable[[str], str]) -> str:
    """As "24 October 2026", in the language of `say`."""
    return say("{day} {month} {year}").format(day=day.day, month=say(MONTHS[day.month - 1]), year=day.year)


def day_and_month(day: datetime.date, say: Callable[[str], str]) -> str:
    """As "24 October"."""
    return say("{day} {month}").format(day=day.day, month=say(MONTHS[day.month - 1]))


def day_in_words(day: datetime.date, days: Collection[datetime.date]) -> str:
    """One of some days, with its year where they are of several."""
    return date(day) if len({one.year for one in days}) > 1 else short_date(day)


def _month(day: datetime.date) -> str:
    months = (
        *(tr("Jan"), tr("Feb"), tr("Mar"), tr("Apr"), tr("May"), tr("Jun")),
        *(tr("Jul"), tr("Aug"), tr("Sep"), tr("Oct"), tr("Nov"), tr("Dec")),
    )
    return months[day.month - 1]
