"""The description of a chart: what of a walk is shown, and what is held back."""

from dataclasses import replace

import numpy as np
import pytest

from app.charts.axes import angle_in_words
from app.charts.cycles import PERCENT, SideCycle
from app.charts.marks import CurveLabel, Deviation, Point
from app.charts.stride_chart import (
    Axis,
    StrideChart,
    StrideCurve,
    curves_of_walk,
    toe_off_labels,
    toe_offs_in_order,
    usual_range_deg,
)
from core.body import Joint, JointKind, Side
from core.gait.cycles import mean_cycle

LEFT, RIGHT = Joint.LEFT_KNEE, Joint.RIGHT_KNEE


def cycle(n: int, toe_off_percent: float = 60.0) -> SideCycle:
    strides_deg = np.arange(n)[:, None] + 40 * np.sin(PERCENT / 20)
    return SideCycle(mean_cycle(strides_deg), strides_deg, toe_off_percent)


def only(n: int, *, is_not_reported: bool = False, has_strides: bool = False) -> StrideCurve:
    not_reported = frozenset({Side.LEFT} if is_not_reported else ())
    (curve,) = curves_of_walk({Side.LEFT: cycle(n)}, not_reported, has_strides=has_strides)
    return curve


def test_single_strides_are_described_on_demand() -> None:
    assert len(only(10).strides_deg) == 0
    assert len(only(10, has_strides=True).strides_deg) == 10


def test_a_label_at_the_end_of_a_bracket_gives_way_to_it() -> None:
    low, high, other = (Point(joint, 72.0, angle) for joint, angle in ((LEFT, 0.0), (LEFT, 58.0), (RIGHT, 58.0)))
    labels = CurveLabel(high, "L 58°"), CurveLabel(other, "R 58°")
    bare = StrideChart(Axis(-10, 80, 20, 20), (), None, is_simulated=False, labels=labels)
    assert bare.shown_labels == labels
    bracket = Deviation(low, high, "L 53°")
    assert replace(bare, deviations=(bracket,)).shown_labels == labels[1:]


def test_of_a_not_reported_curve_neither_mean_nor_toe_off_is_described() -> None:
    not_reported = only(12, is_not_reported=True)
    assert not not_reported.is_known
    assert np.isnan(not_reported.toe_off_percent)
    assert len(not_reported.strides_deg) == 0
    assert len(only(12, is_not_reported=True, has_strides=True).strides_deg) == 12
    assert len(only(2, is_not_reported=True).strides_deg) == 2  # too few for a mean: they are all there is
    assert only(12).is_known


def test_the_earlier_toe_off_is_first_as_far_as_it_is_written() -> None:
    curves = curves_of_walk({Side.LEFT: cycle(3, 60.4), Side.RIGHT: cycle(3, 60.2)}, frozenset(), has_strides=False)
    assert [curve.side for curve in toe_offs_in_order(curves, 0)] == [Side.LEFT, Side.RIGHT]
    assert [curve.side for curve in toe_offs_in_order(curves, 1)] == [Side.RIGHT, Side.LEFT]
    assert toe_off_labels(curves) == {Side.LEFT: "toe-off L 60 %", Side.RIGHT: "R 60 %"}
    nowhere = curves_of_walk({Side.LEFT: cycle(3, float("nan"))}, frozenset(), has_strides=False)
    assert toe_offs_in_order(nowhere, 0) == []


def test_axes_are_the_usual_ones_and_their_labels_never_minus_zero() -> None:
    assert usual_range_deg(JointKind.KNEE, is_about_mean=False) == (-10, 80)
    assert usual_range_deg(JointKind.KNEE, is_about_mean=True) == (-40, 50)
    assert usual_range_deg(JointKind.ANKLE, is_about_mean=True) == (-30, 30)
    assert [angle_in_words(value) for value in (-20.0, -0.0, 20.0)] == ["\N{MINUS SIGN}20", "0", "20"]


@pytest.mark.parametrize("order", [(0, 2), (1, 2)])
def test_a_curve_that_is_not_known_states_so(order: tuple[int, int]) -> None:
    assert not StrideCurve("A", Side.LEFT, np.full(101, np.nan), order=order).is_known
