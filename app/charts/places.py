"""Free places in a chart: where a bracket, the value at a peak or the box of a hidden curve cover the curves least."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.charts.canvas import Canvas
from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks import BAND_SDS, CurveLabel, Deviation, HiddenCurve
from app.charts.stride_chart import StrideChart, toe_offs_in_order
from app.wording.verdicts import verdict_alone
from core.body import JointKind
from core.samples import FloatArray
from core.verdicts.model import Verdict

USUAL_EMPTY_PERCENT = {  # between the stance's curve and the swing's
    JointKind.HIP: 50.0,
    JointKind.KNEE: 50.0,
    JointKind.ANKLE: 43.0,
}
CANDIDATES_PERCENT = np.arange(2.0, 99.0)
WORDS_APART = 10.0  # between bar and words
CLEAR = 3.0  # around words
LEADER = 0.5  # half of a leader's width
POINT_APART = 12.0  # between the bar and one at least of the points it represents, that it may be seen
# What a length of covered curve costs, an upright line, a crossing; a mark over a mark cannot be read.
PER_CURVE, PER_SOFT_CURVE, PER_UPRIGHT, PER_CROSSING = 5.0, 0.25, 15.0, 8.0
UNREADABLE = 1000.0
MOST_COVERED = 100.0  # before the second line is left away
WORDS_AT_RIGHT, TOO_NEAR, PER_LENGTH_AWAY = 25.0, 60.0, 0.15
# Of a label: rows and columns tried about its point, how far from it, and what a length away from it costs.
LABEL_STEPS = np.linspace(0.0, 1.0, 9)
FARTHEST_LABEL, PER_LABEL_AWAY, PER_WRONG_WAY = 60.0, 1.0, 3.0
PEAK_WIDTH = 8  # percent of the stride
HIDDEN_STEPS = np.linspace(0.03, 0.97, 9)
PER_HIDDEN_AWAY = 0.15
Size = tuple[float, float]
"""Width and height."""


@dataclass(frozen=True, slots=True)
class Box:
    """A box in a painter's own unit, y downwards."""

    left: float
    top: float
    right: float
    bottom: float

    def grown(self, by: float) -> "Box":
        return Box(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def overlaps(self, other: "Box") -> bool:
        is_beside = self.right <= other.left or other.right <= self.left
        return not (is_beside or self.bottom <= other.top or other.bottom <= self.top)

    def contains(self, other: "Box") -> bool:
        is_across = self.left <= other.left and other.right <= self.right
        return is_across and self.top <= other.top and other.bottom <= self.bottom


@dataclass
class ChartGround:
    """What a chart has drawn already: curves (n, 2), pale ones such as a band's edges, upright lines, and boxes."""

    frame: Frame
    curves: Sequence[FloatArray]
    soft_curves: Sequence[FloatArray] = ()
    uprights: Sequence[float] = ()
    taken: list[Box] = field(default_factory=list)
    leaders: list[Box] = field(default_factory=list)
    _pieces: FloatArray = field(init=False)  # of all curves: middle x, middle y, what covering it costs

    def __post_init__(self) -> None:
        weighed = [*((curve, PER_CURVE) for curve in self.curves), *((c, PER_SOFT_CURVE) for c in self.soft_curves)]
        pieces = [
            np.column_stack([(curve[1:] + curve[:-1]) / 2, weight * np.hypot(*np.diff(curve, axis=0).T)])
            for curve, weight in weighed
        ]
        self._pieces = np.concatenate([np.empty((0, 3)), *pieces])

    def covered(self, box: Box) -> float:
        """What it costs to cover the curves in a box."""
        x, y, cost = self._pieces.T
        return float(cost[(box.left < x) & (x < box.right) & (box.top < y) & (y < box.bottom)].sum())


@dataclass(frozen=True, slots=True)
class MarkPlace:
    """A mark's bar, and the room of its words: None where there is none. `lines` are those that have room."""

    bar_x: float
    top: float
    bottom: float
    words: Box | None
    lines: int

    @property
    def are_words_at_right(self) -> bool:
        return self.words is not None and self.words.left > self.bar_x


@dataclass(frozen=True, slots=True)
class Layout:
    """Where all words of a chart are. A label without a box has no room that leaves the others free."""

    hidden: tuple[tuple[HiddenCurve, Box], ...]
    brackets: tuple[tuple[Deviation, MarkPlace], ...]
    labels: tuple[tuple[CurveLabel, Box | None], ...]


def layout_of(canvas: Canvas, frame: Frame, chart: StrideChart, taken: Sequence[Box] = ()) -> Layout:
    """Boxes of hidden curves first, then brackets, then labels: what is larger chooses first."""
    ground, size = ground_of(frame, chart, taken), canvas.lengths
    hidden = tuple((one, place_hidden(ground, _size_of_hidden(canvas, one))) for one in chart.hidden)
    brackets = []
    for deviation in chart.deviations:
        ends = [_at(frame, point.percent, point.angle_deg) for point in deviation.points]
        kind = USUAL_EMPTY_PERCENT[deviation.kind]
        brackets.append((deviation, place_mark(ground, ends, _sizes_of_bracket(canvas, deviation), kind)))
    labels = sorted(chart.shown_labels, key=lambda label: label.side, reverse=True)  # filled dots over outlined ones
    points = [_at(frame, one.point.percent, one.point.angle_deg) for one in labels]
    sizes = [(canvas.width_of(one.text, is_first=True) + size.halo, size.line) for one in labels]
    are_above = [_is_higher(chart, one) for one in labels]
    boxes = place_labels(ground, points, sizes, are_above, size.dot)
    return Layout(hidden, tuple(brackets), tuple(zip(labels, boxes, strict=True)))


def _sizes_of_bracket(canvas: Canvas, bracket: Deviation) -> list[Size]:
    """Of its words with one line, and with both."""
    first, line = canvas.width_of(bracket.words, is_first=True), canvas.lengths.line
    more = [(max(first, canvas.width_of(bracket.more, is_first=False)), 2 * line)] if bracket.more else []
    return [(first, line), *more]


def _size_of_hidden(canvas: Canvas, hidden: HiddenCurve) -> Size:
    words = max(canvas.width_of(line, is_first=row == 0) for row, line in enumerate(lines_of_hidden(hidden)))
    return canvas.lengths.hidden_margins + words, canvas.lengths.hidden_height


def lines_of_hidden(hidden: HiddenCurve) -> list[str]:
    return list(filter(None, [verdict_alone(Verdict.NOT_REPORTED), hidden.reason]))


def _is_higher(chart: StrideChart, label: CurveLabel) -> bool:
    """Whether a label's curve is the higher one at its point; of a curve alone, whether the point is a highest one."""
    at, angle_deg = int(label.point.percent), label.point.angle_deg
    others = [c.angle_deg for c in chart.curves if c.is_known and c.side is not label.side]
    if others:
        return angle_deg >= others[0][at]
    own = next(curve.angle_deg for curve in chart.curves if curve.side is label.side)
    return bool(angle_deg >= np.mean(own[[max(at - PEAK_WIDTH, 0), min(at + PEAK_WIDTH, 100)]]))


def ground_of(frame: Frame, chart: StrideChart, taken: Sequence[Box] = ()) -> ChartGround:
    """What a chart draws before its marks."""
    curves = [line_of(frame, PERCENT, curve.angle_deg) for curve in (*chart.beside, *chart.curves) if curve.is_known]
    edges = []
    if (band := chart.band) is not None:
        reach = BAND_SDS * band.sd_deg
        edges = [
            line_of(frame, PERCENT, edge) for edge in (band.mean_deg - reach, band.mean_deg, band.mean_deg + reach)
        ]
    uprights = [float(frame.x(curve.toe_off_percent)) for curve in toe_offs_in_order(chart.curves, 0)]
    return ChartGround(frame, curves, edges, uprights, list(taken))


def line_of(frame: Frame, percent: FloatArray, angle_deg: FloatArray) -> FloatArray:
    """A curve (4n, 2) as it lies in the frame, close enough for its steep parts to be met; what is unknown is left."""
    is_known = np.isfinite(angle_deg)
    if not is_known.any():
        return np.empty((0, 2))
    close = np.linspace(percent[is_known][0], percent[is_known][-1], 4 * len(percent))
    return np.column_stack([frame.x(close), frame.y(np.interp(close, percent[is_known], angle_deg[is_known]))])


def place_mark(
    ground: ChartGround, ends: Sequence[tuple[float, float]], sizes: Sequence[tuple[float, float]], usual_percent: float
) -> MarkPlace:
    """Place the bar between two `ends` (x, y) and its words where they cover least; the place is taken from then on.

    `sizes` are width and height of the words with one line, two and so on; as many are kept as have room.
    """
    top, bottom = sorted(y for _, y in ends)
    usual_x = float(ground.frame.x(usual_percent))
    all_x = map(float, ground.frame.x(CANDIDATES_PERCENT))
    bars = sorted((_cost_of_bar(ground, x, ends, usual_x), x) for x in all_x)
    place = MarkPlace(bars[0][1], top, bottom, None, 0)
    for lines in range(len(sizes), 0, -1):
        most = MOST_COVERED if lines > 1 else UNREADABLE
        for cost_of_bar, bar_x in bars:
            if cost_of_bar >= most:
                break
            for words in _rooms(ground.frame, bar_x, top, bottom, sizes[lines - 1]):
                cost = cost_of_bar + _cost_of_words(ground, words, bar_x, ends)
                if cost < most:
                    most, place = cost, MarkPlace(bar_x, top, bottom, words, lines)
        if place.words is not None:
            break
    ground.taken.append(Box(place.bar_x - CLEAR, top, place.bar_x + CLEAR, bottom))
    ground.taken += [place.words] if place.words is not None else []
    ground.leaders += [_leader(place.bar_x, x, y) for x, y in ends] + [Box(x, y, x, y).grown(CLEAR) for x, y in ends]
    return place


def place_labels(
    ground: ChartGround,
    points: Sequence[tuple[float, float]],
    sizes: Sequence[Size],
    are_above: Sequence[bool],
    dot: float,
) -> list[Box | None]:
    """Place each label by its point, inside the frame and where it covers least; None where there is no room.

    `are_above`: those that want to be over their points. Places are taken in order, from then on.
    """
    frame = ground.frame
    inside = Box(frame.left, frame.top, frame.right, frame.bottom)
    dots = [Box(x, y, x, y).grown(dot) for x, y in points]
    found: list[Box | None] = []
    for (x, y), (width, height), is_above in zip(points, sizes, are_above, strict=True):
        best, least = None, UNREADABLE
        for dx in (-1 + 2 * LABEL_STEPS) * (width / 2 + FARTHEST_LABEL):
            for dy in (-1 + 2 * LABEL_STEPS) * (height / 2 + FARTHEST_LABEL / 2):
                room = Box(x + dx - width / 2, y + dy - height / 2, x + dx + width / 2, y + dy + height / 2)
                if not inside.contains(room):
                    continue
                apart = np.hypot(max(abs(dx) - width / 2, 0.0), max(abs(dy) - height / 2, 0.0))
                cost = PER_LABEL_AWAY * float(apart) + PER_WRONG_WAY * max(dy if is_above else -dy, 0.0)
                cost += ground.covered(room.grown(1.0))
                cost += PER_UPRIGHT * sum(room.left < upright < room.right for upright in ground.uprights)
                cost += UNREADABLE * any(map(room.overlaps, (*ground.taken, *ground.leaders, *dots)))
                if cost < least:
                    best, least = room, cost
        found.append(best)
        ground.taken += [best] if best is not None else []
    return found


def place_hidden(ground: ChartGround, size: Size) -> Box:
    """The room for the box of a curve that is hidden; top left where all are alike."""
    frame, (width, height) = ground.frame, size
    best, least = Box(frame.left, frame.top, frame.left + width, frame.top + height), np.inf
    for left in frame.left + HIDDEN_STEPS * max(frame.width - width, 0.0):
        for top in frame.top + HIDDEN_STEPS * max(frame.height - height, 0.0):
            room = Box(float(left), float(top), float(left) + width, float(top) + height)
            cost = ground.covered(room) + PER_HIDDEN_AWAY * (left - frame.left + top - frame.top)
            cost += PER_UPRIGHT * sum(room.left < upright < room.right for upright in ground.uprights)
            cost += UNREADABLE * any(map(room.overlaps, ground.taken))
            if cost < least:
                best, least = room, cost
    ground.taken.append(best)
    return best


def _at(frame: Frame, percent: float, angle_deg: float) -> tuple[float, float]:
    return float(frame.x(percent)), float(frame.y(angle_deg))


def _rooms(frame: Frame, bar_x: float, top: float, bottom: float, size: tuple[float, float]) -> Iterator[Box]:
    """Rooms for words beside a bar, that lie inside the frame: at its middle, its ends, and above and below it."""
    width, height = size
    inside = Box(frame.left, frame.top, frame.right, frame.bottom)
    middle = (top + bottom) / 2
    for left in (bar_x - WORDS_APART - width, bar_x + WORDS_APART):
        beyond_ends = top - height / 2, bottom + height / 2, top + height / 2, bottom - height / 2
        for centre in (middle, top, bottom, *beyond_ends):
            words = Box(left, centre - height / 2, left + width, centre + height / 2)
            if inside.contains(words):
                yield words


def _cost_of_bar(ground: ChartGround, bar_x: float, ends: Sequence[tuple[float, float]], usual_x: float) -> float:
    top, bottom = sorted(y for _, y in ends)
    bar = Box(bar_x - CLEAR, top, bar_x + CLEAR, bottom)
    cost = PER_LENGTH_AWAY * abs(bar_x - usual_x) + UNREADABLE * any(map(bar.overlaps, ground.taken))
    cost += PER_CROSSING * sum(map(bar.overlaps, ground.leaders))
    cost += PER_UPRIGHT * any(abs(x - bar_x) < 2 * CLEAR for x in ground.uprights)
    for curve in ground.curves:
        y = curve[np.argmin(np.abs(curve[:, 0] - bar_x)), 1] if len(curve) else np.nan
        cost += PER_CROSSING * bool(top + CLEAR < y < bottom - CLEAR)
    cost += TOO_NEAR * all(abs(x - bar_x) < POINT_APART for x, _ in ends)
    for x, y in ends:
        leader = _leader(bar_x, x, y)
        cost += UNREADABLE * any(map(leader.overlaps, ground.taken))
        for curve in ground.curves:
            is_near_point = np.abs(curve[:, 0] - x) < POINT_APART
            is_under = (leader.left < curve[:, 0]) & (curve[:, 0] < leader.right) & ~is_near_point
            cost += PER_CROSSING * np.count_nonzero(np.diff(curve[is_under, 1] > y))
    return float(cost)


def _cost_of_words(ground: ChartGround, words: Box, bar_x: float, ends: Sequence[tuple[float, float]]) -> float:
    room = words.grown(CLEAR)
    cost = ground.covered(room) + PER_UPRIGHT * sum(room.left < x < room.right for x in ground.uprights)
    cost += WORDS_AT_RIGHT * (words.left > bar_x)
    points = [Box(x, y, x, y).grown(CLEAR) for x, y in ends]
    in_the_way = [*ground.taken, *ground.leaders, *points, *(_leader(bar_x, x, y) for x, y in ends)]
    return cost + UNREADABLE * any(map(room.overlaps, in_the_way))


def _leader(bar_x: float, x: float, y: float) -> Box:
    """The level line from a point to its bar."""
    return Box(min(x, bar_x), y - LEADER, max(x, bar_x), y + LEADER)
