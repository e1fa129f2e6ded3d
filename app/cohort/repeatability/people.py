"""Sessions of a study of repeatability, put together by person, and what keeps others out of it."""

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from app.summary.conditions import Part, parts_of
from app.summary.report_dates import date_of
from app.wording.translation import tr_n
from core.body import Side
from core.parameters import SPEED
from core.results import Analysis
from core.session import Patient, Recording, Session
from core.verdicts.own_figures import OwnFigures
from core.verdicts.repeatability import COLUMNS, Strapping, repeatability_of
from core.verdicts.sigmas import HEALTHY_BETWEEN_LEGS, ComparisonKind
from core.verdicts.stride_means import MeanOfStrides

CONDITION = "repeatability"  # in a library, walks of this condition are of the study
OF_LEGS = tuple(
    dict.fromkeys([*(name for of in COLUMNS.values() for name in of if name != SPEED), *HEALTHY_BETWEEN_LEGS])
)
SIDES = frozenset((*map(str, Side), "both"))


@dataclass(slots=True)
class StudyPeople:
    """People whose sensors were attached twice or more, in one session or in several.

    `condition`: only walks of this condition count, in small letters; empty: all walks.
    """

    condition: str = ""
    _people: dict[str, list[Strapping]] = field(default_factory=dict)
    _simulated: list[bool] = field(default_factory=list)
    _without_code: int = 0
    _affected: set[str] = field(default_factory=set)

    def add(self, session: Session, analysis: Analysis) -> None:
        """Take what one session has; of a person with an affected or prosthetic side nothing."""
        person = folded(session.patient.code)
        found = list(_strappings(session, analysis, [self._as_counted(one) for one in session.recordings]))
        if not found:
            return
        if not person:
            self._without_code += 1
        elif is_affected(session.patient):
            self._affected.add(person)
        else:
            self._people.setdefault(person, []).extend(found)
            self._simulated.append(session.is_simulated)

    def figures(self, made_by: str, software: str) -> OwnFigures:
        """Give the study's figures; raises TooFewPeopleError where too few people were measured twice."""
        people = [found for person, found in self._people.items() if person not in self._affected]
        return replace(repeatability_of(people), made_by=made_by, software=software, is_simulated=any(self._simulated))

    def notes(self) -> Iterator[str]:
        """What was left out, a sentence each."""
        if count := self._without_code:
            yield tr_n(
                "{count} session without a patient code is excluded.",
                "{count} sessions without a patient code are excluded.",
                count,
            ).format(count=count)
        if count := len(self._affected):
            yield tr_n(
                "{count} person with an affected or prosthetic side is excluded.",
                "{count} people with an affected or prosthetic side are excluded.",
                count,
            ).format(count=count)
        if count := sum(len(found) < 2 for found in self._people.values()):
            yield tr_n(
                "{count} person was measured only once and is excluded.",
                "{count} people were measured only once and are excluded.",
                count,
            ).format(count=count)

    def _as_counted(self, recording: Recording) -> Recording:
        """A recording under its condition as it is compared; those that hold other walks do not count as kept."""
        condition = folded(recording.condition)
        is_counted = not self.condition or condition == self.condition
        return replace(recording, condition=condition or CONDITION, is_kept=recording.is_kept and is_counted)


def folded(text: str) -> str:
    """The same for all ways of typing it."""
    return unicodedata.normalize("NFKC", text).strip().casefold()


def is_affected(patient: Patient) -> bool:
    return not SIDES.isdisjoint((patient.affected_side, patient.prosthetic_side))


def _strappings(session: Session, analysis: Analysis, recordings: Sequence[Recording]) -> Iterator[Strapping]:
    """What each attachment has under each condition; timed tests and walks towards targets are left out."""
    kept = {one.name for one in recordings if one.is_kept}
    day = date_of(session.started)
    for part in parts_of(analysis, recordings):
        if not part.is_apart and all(walk.name in kept for walk in part.walks):
            yield Strapping(
                {
                    (side, column): part.mean(side, column, ComparisonKind.VISITS)
                    for side in part.sides
                    for column in OF_LEGS
                    if part.is_measured(side, column)
                },
                _of_walk(part),
                part.speed_m_s,
                part.name,
                day.isoformat() if day is not None else "",
            )


def _of_walk(part: Part) -> dict[str, MeanOfStrides]:
    return {SPEED: part.of_walk(SPEED, ComparisonKind.VISITS)} if part.sides else {}
