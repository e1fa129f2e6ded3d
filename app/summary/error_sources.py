"""Sources of the error of a difference, in words."""

from collections.abc import Iterable

from app.wording.translation import joined, later, tr
from core.verdicts.measurement_error import Difference, ErrorSource

ERROR_SOURCES = {
    ErrorSource.CHANCE: later("variation between strides"),
    ErrorSource.DRIFT: later("drift within a walk"),
    ErrorSource.CLOCK: later("sensor synchronisation"),
    ErrorSource.AXIS: later("the joint axis"),
    ErrorSource.WALKS: later("variation between walks"),
    ErrorSource.STRAPS: later("sensor attachment"),
    ErrorSource.DAYS: later("variation between days"),
    ErrorSource.EVENTS: later("timing of gait events"),
    ErrorSource.ZERO: later("the standing reference"),
}


def sources_in_words(differences: Iterable[Difference]) -> str:
    """What the errors of some differences contain, each once."""
    found = {source for one in differences for source in one.sources}
    return joined([tr(words) for source, words in ERROR_SOURCES.items() if source in found])
