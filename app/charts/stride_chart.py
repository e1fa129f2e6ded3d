"""What a chart of the stride shows, in data units; the screen's painter and paper's draw it each in its own way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.charts.axes import ABOUT_MEAN_DEG, USUAL_DEG
from app.charts.cycles import Band, SideCycle, is_mean_enough
from app.charts.marks import CurveLabel, Deviation, Gap, HiddenCurve
from app.wording.translation import tr
from core.body import JointKind, Side
from core.gait.cycles import POINTS
from core.samples import FloatArray

NOT_KNOWN = np.full(POINTS, np.nan)
NO_STRIDES = np.empty((0, POINTS))
SCREEN_TICK_DEG = 20


@dataclass(frozen=True, slots=True)
class Axis:
    """Degrees from bottom to top, a label every so many, and words for the two directions."""

    low: float
    high: float
    label_every: float
    tick_every: float
    up: str = ""
    down: str = ""


@dataclass(frozen=True, slots=True)
class StrideCurve:
    """One leg in one walk, condition or visit: its mean `angle_deg` (101,), NaN where it is not known or not shown.

    `order` is its place among how many are compared, the earliest first. `strides_deg` (k, 101) are single strides; of
    a curve that is not reported they are evidence, not to be read. `is_few`: of too few strides for a mean. `is_bare`:
    its single strides alone, without mean and letters.
    """

    letter: str
    side: Side
    angle_deg: FloatArray
    toe_off_percent: float = float("nan")
    toe_off_sd: float = float("nan")
    toe_off_label: str = ""
    order: tuple[int, int] | None = None
    strides_deg: FloatArray = field(default_factory=lambda: NO_STRIDES)
    is_not_reported: bool = False
    is_few: bool = False
    is_bare: bool = False

    @property
    def is_known(self) -> bool:
        return bool(np.isfinite(self.angle_deg).any())


@dataclass(frozen=True, slots=True)
class StrideChart:
    """One joint over 0 to 100 % of the stride.

    `sign` states what is positive. `chosen` is one stride (101,) over all others. `not_reported` states why nothing of
    it may be read, and is empty where something may. `alt` are the chart's words, for who cannot see it. `beside`:
    another walk's means, drawn thin, without toe-off. `labels` are the values at peaks, `deviations` the brackets: a
    bar between two points with its words. `hidden` are legs whose curve is not reported.
    """

    axis: Axis
    curves: tuple[StrideCurve, ...]
    band: Band | None
    is_simulated: bool
    beside: tuple[StrideCurve, ...] = ()
    title: str = ""
    sign: str = ""
    alt: str = ""
    chosen: tuple[Side, FloatArray] | None = None
    not_reported: str = ""
    deviations: tuple[Deviation, ...] = ()
    gaps: tuple[Gap, ...] = ()
    labels: tuple[CurveLabel, ...] = ()
    hidden: tuple[HiddenCurve, ...] = ()

    @property
    def shown_labels(self) -> tuple[CurveLabel, ...]:
        """Those that no bracket has at its end: one number at one place."""
        ends = {point for bracket in self.deviations for point in bracket.points}
        return tuple(label for label in self.labels if label.point not in ends)

    @property
    def is_comparison(self) -> bool:
        return any(curve.order is not None for curve in self.curves)


def usual_range_deg(kind: JointKind, *, is_about_mean: bool) -> tuple[float, float]:
    """What an axis reaches in every chart, so that two patients are compared at a glance."""
    return (ABOUT_MEAN_DEG if is_about_mean else USUAL_DEG)[kind]


def toe_offs_in_order(curves: Sequence[StrideCurve], decimals: int) -> list[StrideCurve]:
    """Those whose toe-off is known, the earlier first; in their own order where both read the same."""
    known = [curve for curve in curves if np.isfinite(curve.toe_off_percent)]
    return sorted(known, key=lambda curve: round(curve.toe_off_percent, decimals))


def curves_of_walk(
    cycles: Mapping[Side, SideCycle], not_reported: frozenset[Side], *, has_strides: bool
) -> tuple[StrideCurve, ...]:
    """Give each side's mean unless not reported; strides if asked for, or if few and the mean is not reported."""
    curves = []
    for side, cycle in cycles.items():
        is_not_reported, n = side in not_reported, cycle.mean.n
        is_shown = not is_not_reported and n > 0
        are_strides_shown = has_strides or (is_not_reported and not is_mean_enough(len(cycle.strides_deg)))
        curves.append(
            StrideCurve(
                letter=side.letter,
                side=side,
                angle_deg=cycle.mean.mean if is_shown else NOT_KNOWN,
                toe_off_percent=cycle.toe_off_percent if is_shown else float("nan"),
                strides_deg=cycle.strides_deg if are_strides_shown else NO_STRIDES,
                is_not_reported=is_not_reported,
            )
        )
    return tuple(curves)


def toe_off_labels(curves: Sequence[StrideCurve], *, has_word: bool = True) -> dict[Side, str]:
    """Name each toe-off: the word at the earlier line, which has the room at its left, if anywhere."""
    in_order = toe_offs_in_order(curves, 0)
    percents = [curve.toe_off_percent for curve in in_order]
    # where whole percents would part what hardly differs, both have a decimal
    is_close = len(percents) > 1 and round(percents[0]) != round(percents[1]) and abs(percents[0] - percents[1]) < 1
    bare = "{side} {percent:.1f} %" if is_close else "{side} {percent:.0f} %"
    worded = tr("toe-off {side} {percent:.1f} %") if is_close else tr("toe-off {side} {percent:.0f} %")
    labels = worded if has_word else bare, bare
    return {
        curve.side: label.format(side=curve.letter, percent=curve.toe_off_percent)
        for label, curve in zip(labels, in_order, strict=False)
    }
