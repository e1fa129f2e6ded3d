"""Places of a walk's curves that the answer refers to. What differs most, and where a curve leaves the band."""

import numpy as np

from app.charts.cycles import Band, is_mean_enough
from app.charts.marks import BAND_SDS, CurveLabel, Deviation, Gap, extreme_of, gaps_outside, laid_at_height_of
from app.summary.facts import KINDS, Facts, joint_of
from app.summary.headline import Headline, Rule
from app.summary.legs_in_words import rounded
from app.summary.measure_sentences import unit_and_decimals
from app.summary.numbers_in_words import fixed
from app.wording.dates import short_date
from app.wording.translation import tr
from core.body import Joint, JointKind, Side
from core.parameters import BY_COLUMN, QuantityClass
from core.samples import FloatArray
from core.verdicts.norms import KNEE_OVERREAD
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN, WINDOWS

LABELLED = {  # peaks whose values are on the curves
    JointKind.KNEE: ("knee_swing_peak_deg",),
    JointKind.ANKLE: ("ankle_stance_dorsiflexion_deg", "ankle_push_off_plantarflexion_deg"),
}
MARKED = (QuantityClass.SHAPE, QuantityClass.EXCURSION)
CONTACT, ALL = (0.0, 0.0), (0.0, 100.0)  # percent of the stride


def labels_of(facts: Facts, kind: JointKind) -> list[CurveLabel]:
    """Give the reported peaks of each leg's curve with the values of the tables, in degrees as measured."""
    found: list[CurveLabel] = []
    for column in LABELLED.get(kind, ()):
        window = WINDOWS[column]
        for side in Side:
            value, curve = facts.value(side, column), facts.measured_curve_deg(side, kind)
            if is_mean_enough(value.n) and np.isfinite(curve).all() and not facts.is_no_peak(side, column):
                at = extreme_of(kind.of(side), curve, window.first, window.last, is_maximum=window.is_maximum)
                found.append(CurveLabel(at, f"{side.letter} {fixed(value.mean, 0)}°"))
    return found


def bracket_of(facts: Facts, headline: Headline) -> Deviation | None:
    """Give the headline's movement as a bracket on its curve, degrees as measured; None without a movement."""
    column, side = headline.column, headline.side
    kind = next((kind for kind in facts.kinds if column.startswith(kind)), None)
    if kind is None or side is None or BY_COLUMN[column].rests_on not in MARKED:
        return None
    curve, value = facts.measured_curve_deg(side, kind), facts.value(side, column)
    if not is_mean_enough(value.n) or not np.isfinite(curve).all():
        return None
    now, more = _numbers_of(facts, headline, value.mean)
    high, low = windows_of(column)
    joint, unit = kind.of(side), unit_and_decimals(column)[0]
    return Deviation(
        extreme_of(joint, curve, *low, is_maximum=False),
        extreme_of(joint, curve, *high, is_maximum=True),
        words=f"{side.letter} {now}{unit}",
        more=more,
        is_larger_than_error=True,
    )


def _numbers_of(facts: Facts, headline: Headline, now: float) -> tuple[str, str]:
    """The headline's value and what it is compared with, rounded as the headline has them."""
    column, side, since = headline.column, headline.side, headline.since
    assert side is not None
    unit = unit_and_decimals(column)[0]
    if headline.rule in (Rule.LEGS, Rule.LEGS_BEYOND_ERROR):
        other = facts.value(side.other, column).mean
        _, value, size = rounded(column, (other, now, abs(now - other)), is_other_shown=False)
        pattern = tr("{size} less than {other}") if now < other else tr("{size} more than {other}")
        return value, pattern.format(size=size + unit, other=side.other.letter)
    walked = since.course.condition(facts.condition) if since is not None and since.course is not None else None
    figure = walked.figure(column, side) if walked is not None else None
    if since is None or figure is None or not figure.is_reported:
        return fixed(now, 0), ""
    then, value, _ = rounded(column, (figure.found.mean, now, abs(now - figure.found.mean)))
    return value, f"{short_date(since.day)}: {then}{unit}"


def windows_of(column: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where an excursion has its highest and its lowest angle; a range has them anywhere."""
    if column not in EXCURSIONS_BY_COLUMN:
        return ALL, ALL
    excursion = EXCURSIONS_BY_COLUMN[column]
    high, low = (
        (window.first, window.last) if window is not None else CONTACT for window in (excursion.high, excursion.low)
    )
    return high, low


def gaps_of(facts: Facts) -> list[Gap]:
    """Give where a curve leaves 2 SD of the band, as drawn and as laid at the curve's height; none without a height.

    A knee has to be outside as measured and divided by what knees over-read. Hips have no such band.
    """
    group = facts.curves_group
    if group is None or facts.bands.are_curves_of_other_ages:
        return []
    found: list[Gap] = []
    for side in Side:
        for kind in KINDS:
            joint = joint_of(kind, side)
            curve = facts.measured_curve_deg(side, kind)
            is_judged = side in facts.sides_with_band and facts.verdicts.joint(joint).height.is_reported
            if is_judged and np.isfinite(curve).all() and is_mean_enough(facts.strides(side)):
                found += _beyond(joint, curve, Band(*group.mean_and_sd_deg(kind)))
    return found


def _beyond(joint: Joint, curve: FloatArray, band: Band) -> tuple[Gap, ...]:
    limits = [_limits(band), _limits(laid_at_height_of(curve, band))]
    if joint.is_knee:
        low, high = _limits(laid_at_height_of(curve / KNEE_OVERREAD, band))
        limits.append((KNEE_OVERREAD * low, KNEE_OVERREAD * high))
    low = np.min([one for one, _ in limits], axis=0)
    high = np.max([one for _, one in limits], axis=0)
    return gaps_outside(joint, curve, low, high, tr("more than 2 SD from the reference"))


def _limits(band: Band) -> tuple[FloatArray, FloatArray]:
    reach = BAND_SDS * band.sd_deg
    return band.mean_deg - reach, band.mean_deg + reach
