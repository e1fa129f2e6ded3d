"""Places of marks: they leave curves, lines and one another free, and lie inside the chart."""

from itertools import pairwise

import numpy as np
import pytest

from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.places import Box, ChartGround, MarkPlace, line_of, place_hidden, place_labels, place_mark
from core.samples import FloatArray

FRAME = Frame(40, 24, 428, 150, -10, 80)
KNEE: FloatArray = 10 * np.exp(-(((PERCENT - 14) / 8) ** 2)) + 55 * np.exp(-(((PERCENT - 73) / 12) ** 2))
ONE_LINE, TWO_LINES = (90.0, 16.0), (170.0, 32.0)


def ground_of(*curves: FloatArray, uprights: tuple[float, ...] = ()) -> ChartGround:
    return ChartGround(FRAME, [line_of(FRAME, PERCENT, curve) for curve in curves], (), uprights)


def ends(*points: tuple[float, float]) -> list[tuple[float, float]]:
    return [(float(FRAME.x(percent)), float(FRAME.y(angle))) for percent, angle in points]


def length_covered(ground: ChartGround, box: Box) -> float:
    """How much of the curves lies in a box, px, found point by point."""
    total = 0.0
    for curve in ground.curves:
        for (x, y), (next_x, next_y) in pairwise(curve):
            if box.left < x < box.right and box.top < y < box.bottom:
                total += float(np.hypot(next_x - x, next_y - y))
    return total


def is_inside(place: MarkPlace) -> bool:
    words = place.words
    return words is not None and (
        FRAME.left <= words.left < words.right <= FRAME.right and FRAME.top <= words.top < words.bottom <= FRAME.bottom
    )


def test_two_peaks_in_swing_are_reported_in_the_empty_middle_of_the_stride() -> None:
    ground = ground_of(KNEE, 0.8 * KNEE, uprights=(float(FRAME.x(60)), float(FRAME.x(62))))
    place = place_mark(ground, ends((73, 55), (73, 44)), [ONE_LINE, TWO_LINES], 50)
    assert place.bar_x == pytest.approx(float(FRAME.x(50)), abs=20)
    assert (place.top, place.bottom) == (float(FRAME.y(55)), float(FRAME.y(44)))
    assert place.lines == 2
    assert is_inside(place)
    assert place.words is not None
    assert place.words.right < place.bar_x
    assert length_covered(ground, place.words) == 0


@pytest.mark.parametrize("percent", [5, 30, 60, 97])
def test_wherever_two_points_lie_no_curve_is_covered(percent: float) -> None:
    curve: FloatArray = np.interp(percent, PERCENT, KNEE) + 30 * np.sin((PERCENT - percent) / 15)
    ground = ground_of(curve, curve + 8)
    at = float(np.interp(percent, PERCENT, curve))
    place = place_mark(ground, ends((percent, at), (percent, at + 8)), [ONE_LINE, TWO_LINES], 50)
    assert is_inside(place)
    assert place.words is not None
    assert length_covered(ground, place.words) == 0


def test_a_second_mark_leaves_the_first_free() -> None:
    ground = ground_of(KNEE, 0.8 * KNEE)
    points = ends((73, 55), (73, 44))
    first = place_mark(ground, points, [ONE_LINE, TWO_LINES], 50)
    second = place_mark(ground, points, [ONE_LINE, TWO_LINES], 50)
    assert first.words is not None
    assert second.words is not None
    assert not first.words.overlaps(second.words)
    assert abs(first.bar_x - second.bar_x) > 5


def test_a_bar_does_not_stand_in_the_words_of_another_mark() -> None:
    ground = ground_of(KNEE, 0.8 * KNEE)
    first = place_mark(ground, ends((73, 55), (73, 44)), [ONE_LINE, TWO_LINES], 50)
    second = place_mark(ground, ends((3, 75), (3, 25)), [ONE_LINE], 30)  # where the first's words are
    assert first.words is not None
    assert second.words is not None
    bar = Box(second.bar_x - 1, second.top, second.bar_x + 1, second.bottom)
    assert not first.words.overlaps(bar)
    assert not first.words.overlaps(second.words)


def test_in_a_narrow_chart_the_second_line_goes_first_and_words_before_the_bar() -> None:
    ground = ground_of(KNEE)
    points = ends((73, 55), (50, 0))
    assert place_mark(ground, points, [ONE_LINE, (500.0, 32.0)], 50).lines == 1
    place = place_mark(ground_of(KNEE), points, [(500.0, 16.0)], 50)
    assert (place.words, place.lines) == (None, 0)


def test_of_a_curve_that_is_nowhere_known_nothing_is_in_the_way() -> None:
    assert line_of(FRAME, PERCENT, np.full(101, np.nan)).shape == (0, 2)
    place = place_mark(ground_of(np.full(101, np.nan)), ends((73, 55), (73, 44)), [ONE_LINE], 50)
    assert place.bar_x == pytest.approx(float(FRAME.x(50)))


LABEL, DOT = (44.0, 16.0), 6.0


@pytest.mark.parametrize("apart_deg", [0.0, 1.0, 6.0, 20.0])
@pytest.mark.parametrize("percent", [2.0, 43.0, 73.0, 98.0])
def test_labels_of_two_peaks_overlap_neither_each_other_nor_dots_and_stay_in_the_plot(
    percent: float, apart_deg: float
) -> None:
    curve: FloatArray = 50 * np.exp(-(((PERCENT - percent) / 12) ** 2))
    ground = ground_of(curve, curve - apart_deg, uprights=(float(FRAME.x(60)), float(FRAME.x(62))))
    points = ends((percent, 50), (percent, 50 - apart_deg))
    one, other = place_labels(ground, points, [LABEL, LABEL], [True, False], DOT)
    assert one is not None
    assert other is not None
    assert not one.overlaps(other)
    inside = Box(FRAME.left, FRAME.top, FRAME.right, FRAME.bottom)
    for box in (one, other):
        assert inside.contains(box)
        assert not any(box.overlaps(Box(x, y, x, y).grown(DOT)) for x, y in points)
    assert one.top <= other.top


def test_a_label_leaves_a_bracket_and_the_box_of_a_hidden_curve_free() -> None:
    ground = ground_of(KNEE)
    hidden = place_hidden(ground, (152.0, 46.0))
    assert length_covered(ground, hidden) == 0
    bracket = place_mark(ground, ends((45, 0), (73, 55)), [ONE_LINE, TWO_LINES], 50)
    (label,) = place_labels(ground, ends((73, 55)), [LABEL], [True], DOT)
    assert label is not None
    assert bracket.words is not None
    assert not any(map(label.overlaps, (hidden, bracket.words)))


def test_where_a_plot_is_too_small_a_label_is_left_away() -> None:
    tiny = ChartGround(Frame(0, 0, 60, 20, -10, 80), [])
    assert place_labels(tiny, [(30.0, 10.0)], [(200.0, 16.0)], [True], DOT) == [None]
