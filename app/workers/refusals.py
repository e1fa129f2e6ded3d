"""What happened, and what to do: whatever a call of the library raised, in two sentences that can be shown."""

from typing import NamedTuple

from app.wording.translation import tr


class Refusal(NamedTuple):
    what: str
    remedy: str


class NothingOpenError(Exception):
    """A call came while no library was open."""


def nothing_open() -> Refusal:
    return Refusal(tr("No library is open."), tr("Log in, then try again."))


def refusal_of(error: Exception) -> Refusal:
    """Put what was raised into two sentences; what nobody foresaw is logged."""
    from app.workers.raised import in_two_sentences  # the storage, which whoever opens no library does without

    return in_two_sentences(error)
