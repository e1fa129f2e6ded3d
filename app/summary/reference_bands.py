"""Cited groups that the program brings along, and which of them may be placed beside a walk."""

from functools import cache
from importlib.resources import files

from app.summary.conditions import Part
from app.wording.translation import later
from core.body import Side
from core.session import Session
from core.verdicts.norms import (
    AgeAndHeight,
    Bands,
    NoBand,
    ReferenceCurves,
    ReferenceValues,
    choose_bands,
    read_curves,
    read_time_distance,
)

FOLDER = files("resources") / "reference_bands"


NOBODY = AgeAndHeight()  # of whom nothing is known
WHY_NO_BAND = {
    NoBand.CHILD: later("No reference: all reference groups are adults."),
    NoBand.SPEED_UNKNOWN: later("No reference: walking speed is unknown."),
    NoBand.HEIGHT_MISSING: later("No reference: the patient's height is needed to classify the walking speed."),
    NoBand.OTHER_SPEED: later("No reference at this speed."),
}
OTHER_AGES = later("The reference is for other ages, so differences from it are not judged.")


@cache
def reference_curves() -> ReferenceCurves:
    """Hip, knee and ankle over the gait cycle, at one comfortable speed."""
    names = ("knee_ankle", "hip")
    return read_curves(*(_text(f"fukuchi2018_young_treadmill_comfortable_{name}.csv") for name in names))


@cache
def time_distance_classes() -> tuple[ReferenceValues, ...]:
    """Time and distance by class of speed, slow to fast."""
    return read_time_distance(_text("fukuchi2018_spatiotemporal_overground_by_froude_class.csv"))


def age_and_height(session: Session) -> AgeAndHeight:
    """What the clinic typed of who walked in a session; the age in the year of the visit."""
    born, year = session.patient.birth_year, session.started[:4]
    age_years = int(year) - born if born is not None and year.isdigit() else None
    return AgeAndHeight(age_years, session.patient.height_m)


def bands_of(part: Part, who: AgeAndHeight) -> Bands:
    """The bands that may stand beside a condition's walks, chosen by their speed."""
    return choose_bands(reference_curves(), time_distance_classes(), part.of_both("speed_m_s"), who)


def sides_with_band(part: Part) -> frozenset[Side]:
    """Legs that may be compared with other people's: none with a prosthesis, whose foot rolls on over its toe-off."""
    return frozenset(side for side in part.sides if not part.is_toe_off_biased(side))


def _text(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
