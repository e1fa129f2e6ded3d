"""Conditions that visits share; visits are compared condition by condition and never pooled.

What a patient walks with is set by hand: two alignments of one prosthesis are two conditions, and their mean is
nobody's gait.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from typing import NamedTuple

from app.summary.conditions import Part, conditions_of
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from core.goals import NO_GOALS, AgreedGoals
from core.results import Analysis
from core.session import Recording


class WalkedVisit(NamedTuple):
    """A visit's name, what came of it, its recordings in order of time, whose conditions count, its day and goals."""

    name: str
    analysis: Analysis
    recordings: Sequence[Recording]
    day: date | None = None
    agreed: AgreedGoals = NO_GOALS


@dataclass(frozen=True)
class ComparedVisits:
    """One condition of a patient's visits."""

    condition: str  # empty: none was stated
    parts: tuple[Part, ...]  # the visits that have it, two or more, in order of time
    without: tuple[str, ...]  # names of those that have not


def by_condition(
    analysis: Analysis, recordings: Sequence[Recording], prefix: str = "", agreed: AgreedGoals = NO_GOALS
) -> Mapping[str, Part]:
    """Each condition of a visit as it was walked last: of several strappings the last, and so of walks without one.

    An alignment that the prosthesis was put back to is the earlier one again.
    """
    stated = {recording.name: recording.returned_to for recording in recordings}
    return _latest(stated, analysis, recordings, prefix, agreed)


def by_stated_condition(
    analysis: Analysis, recordings: Sequence[Recording], prefix: str = "", agreed: AgreedGoals = NO_GOALS
) -> Mapping[str, Part]:
    """The same with what the prosthesis was put back to beside what it was at first."""
    stated = {recording.name: recording.condition for recording in recordings}
    return _latest(stated, analysis, recordings, prefix, agreed)


def _latest(
    stated: Mapping[str, str], analysis: Analysis, recordings: Sequence[Recording], prefix: str, agreed: AgreedGoals
) -> Mapping[str, Part]:
    found: dict[str, Part] = {}
    for part in conditions_of(analysis, recordings, prefix, agreed):
        condition = stated.get(part.walks[0].name, "")
        if not part.is_apart or found.get(condition, part).is_apart:
            found[condition] = part
    return found


def visits_by_condition(visits: Sequence[WalkedVisit]) -> tuple[ComparedVisits, ...]:
    """The conditions of the last visit that an earlier one has as well; visits are lettered 1, 2 and so on."""
    each = [
        (str(number), visit, by_condition(visit.analysis, visit.recordings, agreed=visit.agreed))
        for number, visit in enumerate(visits, start=1)
    ]
    found = []
    for condition in each[-1][2] if each else ():
        parts = [
            replace(walked[condition], letter=letter, name=visit.name, visit=int(letter), day=visit.day)
            for letter, visit, walked in each
            if condition in walked
        ]
        without = tuple(visit.name for _, visit, walked in each if condition not in walked)
        if len(parts) > 1:
            found.append(ComparedVisits(condition, tuple(parts), without))
    return tuple(found)


def parts_of_visits(visits: Sequence[WalkedVisit]) -> tuple[Part, ...]:
    """Every condition of every visit, in order of time, to be compared as somebody chooses: 1A, 1B, 2A and so on."""
    return tuple(
        replace(part, name=f"{visit.name}, {condition_in_words(condition)}", visit=number, day=visit.day)
        for number, visit in enumerate(visits, start=1)
        for condition, part in by_stated_condition(visit.analysis, visit.recordings, str(number), visit.agreed).items()
    )


def conditions_in_words(visits: Sequence[WalkedVisit]) -> str:
    """Say of each visit that has strides under which conditions it was walked."""
    pattern = tr("{visit}: {conditions}.")
    walked = [(visit.name, by_condition(visit.analysis, visit.recordings)) for visit in visits]
    return " ".join(
        pattern.format(visit=name, conditions=", ".join(map(condition_in_words, found)))
        for name, found in walked
        if found
    )


def condition_in_words(condition: str) -> str:
    return name_in_words(condition) or tr("no condition recorded")
