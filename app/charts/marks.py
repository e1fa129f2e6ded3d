"""What is notable on the curves of a stride: two points that differ, and where a curve lies outside a limit."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.charts.cycles import Band
from app.wording.body import name_of
from app.wording.translation import capitalised, tr
from core.body import Joint, JointKind, Side
from core.samples import FloatArray

MOST_MARKS = 2  # in one chart; more would hide the curves
LEAST_GAP_PERCENT = 4  # a shorter one is hardly seen, and means little
BAND_SDS = 2.0


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a joint's curve: percent of the stride, degrees as measured."""

    joint: Joint
    percent: float
    angle_deg: float

    def lowered(self, height_deg: float) -> "Point":
        return replace(self, angle_deg=self.angle_deg - height_deg)


@dataclass(frozen=True, slots=True)
class CurveLabel:
    """A named point of a curve with its value beside it: "R 58°", as the tables have it."""

    point: Point
    text: str

    @property
    def side(self) -> Side:
        return self.point.joint.side

    @property
    def kind(self) -> JointKind:
        return self.point.joint.kind

    def lowered(self, height_deg: float) -> "CurveLabel":
        return replace(self, point=self.point.lowered(height_deg))


@dataclass(frozen=True, slots=True)
class HiddenCurve:
    """A leg whose curve is not reported, in whose place a hatched box has the reason: "±9.8°, limit ±9°"."""

    side: Side
    reason: str


@dataclass(frozen=True, slots=True)
class Deviation:
    """A difference between two points: of two curves, or of the two extremes of an excursion on one.

    `words` name it ("L 53°"), `more` goes on in grey ("1 Jul: 35°").

    Raises
    ------
    ValueError
        The points are of joints of two kinds, which have no chart in common.
    """

    first: Point
    second: Point
    words: str
    more: str = ""
    is_larger_than_error: bool = False

    def __post_init__(self) -> None:
        if self.first.joint.kind is not self.second.joint.kind:
            msg = f"{self.first.joint} and {self.second.joint} are not drawn in one chart"
            raise ValueError(msg)

    @property
    def points(self) -> tuple[Point, Point]:
        return self.first, self.second

    @property
    def kind(self) -> JointKind:
        return self.first.joint.kind

    def in_words(self) -> str:
        """The same for who cannot see it, as sentences."""
        stated = tr("{difference}, beyond measurement error") if self.is_larger_than_error else "{difference}"
        return "; ".join(filter(None, [stated.format(difference=self.words), self.more])) + "."


@dataclass(frozen=True, slots=True)
class Gap:
    """A stretch of the stride, percent, in which a curve lies beyond `limit_deg` (101,), degrees; `words` name it."""

    joint: Joint
    first_percent: int
    last_percent: int
    limit_deg: FloatArray
    words: str

    def lowered(self, height_deg: float) -> "Gap":
        return replace(self, limit_deg=self.limit_deg - height_deg)

    def in_words(self) -> str:
        reported = tr("{joint}, {first} to {last} % of the gait cycle: {what}.")
        joint = capitalised(name_of(self.joint))
        return reported.format(joint=joint, first=self.first_percent, last=self.last_percent, what=self.words)


def extreme_of(joint: Joint, curve_deg: FloatArray, first: float, last: float, *, is_maximum: bool) -> Point:
    """The highest or lowest point of a curve (101,) between two percents of the stride, both included."""
    at = np.arange(int(np.ceil(first)), int(np.floor(last)) + 1)
    found = int(at[np.argmax(curve_deg[at]) if is_maximum else np.argmin(curve_deg[at])])
    return Point(joint, float(found), float(curve_deg[found]))


def laid_at_height_of(curve_deg: FloatArray, band: Band) -> Band:
    """The band moved by the median difference, so that the shape alone is compared."""
    return replace(band, mean_deg=band.mean_deg + float(np.median(curve_deg - band.mean_deg)))


def gaps_outside(
    joint: Joint, curve_deg: FloatArray, low_deg: FloatArray, high_deg: FloatArray, words: str
) -> tuple[Gap, ...]:
    """Where a curve (101,) lies below one limit (101,) or above the other."""
    found = []
    for is_out, limit_deg in ((curve_deg < low_deg, low_deg), (curve_deg > high_deg, high_deg)):
        for first, last in stretches(is_out):
            if last - first >= LEAST_GAP_PERCENT:
                found.append(Gap(joint, first, last, limit_deg, words))
    return tuple(sorted(found, key=lambda gap: gap.first_percent))


def stretches(is_in: Sequence[bool] | np.ndarray) -> list[tuple[int, int]]:
    """First and last index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(is_in).astype(int), [0]])))
    return [(int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True)]
