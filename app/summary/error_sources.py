"""What does the error of a difference contain? Its sources, in words."""

from collections.abc import Iterable

from app.wording.translation import joined, later, tr
from core.verdicts.measurement_error import Difference, ErrorSource

ERROR_SOURCES = {
    ErrorSource.CHANCE: later("chance between strides"),
    ErrorSource.DRIFT: later("drift within a walk"),
    ErrorSource.CLOCK: later("the sensors' clocks"),
    ErrorSource.SPEED: later("another walking speed"),
    ErrorSource.WALKS: later("what walks differ by"),
    ErrorSource.STRAPS: later("strapping the sensors on"),
    ErrorSource.DAYS: later("what days differ by"),
    ErrorSource.EVENTS: later("events that come early or late"),
    ErrorSource.ZERO: later("the zero"),
}


def sources_in_words(differences: Iterable[Difference]) -> str:
    """What the errors of some differences contain, each once."""
    found = {source for one in differences for source in one.sources}
    return joined([tr(words) for source, words in ERROR_SOURCES.items() if source in found])
