"""The mean cycle: what is painted for how many strides, where toe-off is, and the same axes for everyone."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtGui import QColor
from pytestqt.qtbot import QtBot

from app.charts.axes import ANKLE_DEG, KNEE_DEG
from app.charts.cycles import SideCycle
from app.charts.marks import Deviation, Gap, Point
from app.charts.stride_chart import toe_off_labels
from app.plots.cycle_chart import CycleChart
from app.plots.cycle_charts import CycleCharts
from app.summary.reference_bands import reference_curves
from app.theme.current import current_theme
from core.body import Joint, Side
from core.gait.cycles import mean_cycle
from core.samples import FloatArray
from core.verdicts.model import READ, Assessment, GateReason, JointVerdicts, Verdict, assess

PERCENT = np.arange(101.0)


def cycle(n: int, height_deg: float = 60.0, toe_off_percent: float = 60.0, shift_deg: float = 0.0) -> SideCycle:
    """Strides about one swing at 72 %, spread by `height_deg` / 20 from stride to stride."""
    swing = np.exp(-(((PERCENT - 72) / 12) ** 2))
    spread = np.linspace(-1, 1, n) if n > 1 else np.zeros(n)
    strides_deg: FloatArray = shift_deg + height_deg * (1 + spread[:, None] / 10) * swing
    return SideCycle(mean_cycle(strides_deg), strides_deg, toe_off_percent)


@pytest.fixture
def charts(qtbot: QtBot) -> CycleCharts:
    charts = CycleCharts(reference_curves())
    qtbot.addWidget(charts)
    charts.resize(420, 640)
    charts.show()
    return charts


def show(charts: CycleCharts, **sides: SideCycle) -> CycleChart:
    charts.show_cycles({Joint(f"{side}_knee"): found for side, found in sides.items()}, {}, is_simulated=False)
    return charts.knee.chart


def colour_at(chart: CycleChart, percent: float, angle_deg: float) -> QColor:
    place = chart.at(percent, angle_deg)
    return chart.grab().toImage().pixelColor(round(place.x()), round(place.y()))


def is_like(colour: QColor, other: QColor | str) -> bool:
    other = QColor(other)
    apart = (colour.red() - other.red(), colour.green() - other.green(), colour.blue() - other.blue())
    return sum(abs(one) for one in apart) < 90


def test_axes_are_the_same_for_everyone_unless_a_mean_leaves_them(charts: CycleCharts) -> None:
    assert (charts.knee.chart.range_deg, charts.ankle.chart.range_deg) == (KNEE_DEG, ANKLE_DEG)
    show(charts, left=cycle(12))
    assert charts.knee.chart.range_deg == KNEE_DEG
    assert charts.knee.note == ""
    show(charts, left=cycle(12, shift_deg=-22.0))
    assert charts.knee.chart.range_deg == (-30.0, 80.0)
    assert "Axis widened: \N{MINUS SIGN}30° to 80°." in charts.knee.note
    show(charts, left=cycle(12))
    assert charts.knee.chart.range_deg == KNEE_DEG


def test_each_mean_is_drawn_where_it_is_in_its_colour(charts: CycleCharts) -> None:
    chart = show(charts, left=cycle(12, 60), right=cycle(12, 40))
    assert is_like(colour_at(chart, 72, 60), current_theme().curve(Side.LEFT))
    right = [
        is_like(colour_at(chart, percent, 40), current_theme().curve(Side.RIGHT)) for percent in np.arange(70, 75, 0.5)
    ]
    assert any(right)


def test_right_is_dashed_and_left_is_whole(charts: CycleCharts) -> None:
    for side, is_whole in ((Side.LEFT, True), (Side.RIGHT, False)):
        chart = show(charts, **{str(side): cycle(12, 60)})
        picture, mean = chart.grab().toImage(), chart.cycles[side].mean.mean
        seen = []
        for percent in np.arange(5, 42, 0.25):
            place = chart.at(percent, float(np.interp(percent, PERCENT, mean)))
            seen.append(is_like(picture.pixelColor(round(place.x()), round(place.y())), current_theme().curve(side)))
        assert all(seen) is is_whole
        assert any(seen)


def test_the_band_is_there_in_two_greys_and_can_be_taken_away(charts: CycleCharts) -> None:
    chart = show(charts)
    group, c = reference_curves(), current_theme().colours
    at = 30
    mean, sd = group.knee_mean_deg[at], group.knee_sd_deg[at]
    for sds, colour in ((0.6, c.band_1sd), (1.6, c.band_2sd), (2.6, c.surface)):
        assert colour_at(chart, at, mean + sds * sd).name() == colour.lower()
    charts.set_band_shown(False)
    assert colour_at(chart, at, mean + 0.6 * sd).name() == c.surface.lower()


def judged_as(shape: Assessment = READ, height: Assessment = READ, sign: Assessment = READ) -> JointVerdicts:
    return JointVerdicts(shape, height, sign)


PAIRING = assess([GateReason("pairing", Verdict.NOT_REPORTED, 1.05, 1.3)])
FEW = assess([GateReason("strides", Verdict.NOT_REPORTED, 2, 3)])
ZERO = assess([GateReason("zero", Verdict.NOT_REPORTED)])
SIGN = assess([GateReason("sign", Verdict.NOT_REPORTED, 0.1, 0.25)])
SLANTED = assess([GateReason("axis", Verdict.CARE, 8.0, 6.5, "deg")])


def test_of_a_not_reported_joint_no_mean_is_drawn_but_why(charts: CycleCharts) -> None:
    cycles = {Joint.LEFT_KNEE: cycle(12, 60), Joint.RIGHT_KNEE: cycle(12, 40)}
    charts.set_band_shown(False)
    charts.show_cycles(cycles, {Joint.LEFT_KNEE: judged_as(PAIRING, PAIRING)}, is_simulated=False)
    chart = charts.knee.chart
    assert colour_at(chart, 72, 60).name() == current_theme().colours.surface.lower()
    ((hidden, box),) = chart.layout_of_words.hidden
    assert (hidden.side, hidden.reason) == (Side.LEFT, "1.05, required 1.30")
    middle = QColor(chart.grab().toImage().pixelColor(round(box.left + 3), round(box.top + 3)))
    assert middle.name() != ""
    assert list(charts.knee.key.words.legs) == [Side.RIGHT]
    stated = charts.knee.not_reported[Side.LEFT]
    assert stated == "Sensor positions could not be confirmed (clarity 1.05, required 1.30)."
    assert f"Left knee: Not reported. {stated}" in charts.knee.in_words()
    assert list(toe_off_labels(chart.described.curves)) == [Side.RIGHT]
    charts.show_cycles(cycles, {}, is_simulated=False)
    assert not chart.layout_of_words.hidden
    assert is_like(colour_at(chart, 72, 60), current_theme().curve(Side.LEFT))


def test_with_both_legs_not_reported_each_has_its_box(charts: CycleCharts) -> None:
    nothing = judged_as(PAIRING, PAIRING)
    cycles = {Joint.LEFT_KNEE: cycle(12), Joint.RIGHT_KNEE: cycle(12)}
    charts.show_cycles(cycles, dict.fromkeys(cycles, nothing), is_simulated=False)
    (left, one), (right, other) = charts.knee.chart.layout_of_words.hidden
    assert (left.side, right.side) == (Side.LEFT, Side.RIGHT)
    assert not one.overlaps(other)
    charts.show_cycles(cycles, {Joint.LEFT_KNEE: nothing}, is_simulated=False)
    assert [hidden.side for hidden, _ in charts.knee.chart.layout_of_words.hidden] == [Side.LEFT]


def test_of_fewer_than_three_strides_each_is_drawn_in_grey_and_no_mean(charts: CycleCharts) -> None:
    charts.set_band_shown(False)
    charts.show_cycles({Joint.LEFT_KNEE: cycle(2)}, {Joint.LEFT_KNEE: judged_as(FEW, FEW)}, is_simulated=False)
    chart = charts.knee.chart
    assert "Few strides (2 used, 3 required)" in charts.knee.not_reported[Side.LEFT]
    highest = float(chart.cycles[Side.LEFT].strides_deg.max())
    assert colour_at(chart, 72, highest).name() != current_theme().colours.surface.lower()
    assert colour_at(chart, 72, 60).name() == current_theme().colours.surface.lower()


def test_care_is_in_the_key_of_its_leg(charts: CycleCharts) -> None:
    cycles = {Joint.LEFT_KNEE: cycle(12), Joint.RIGHT_KNEE: cycle(12)}
    slanted, key = judged_as(SLANTED, SLANTED), charts.knee.key
    charts.show_cycles(cycles, dict.fromkeys(cycles, slanted), is_simulated=False)
    assert key.words.legs == dict.fromkeys(Side, Verdict.CARE)
    charts.show_cycles(cycles, {Joint.RIGHT_KNEE: slanted}, is_simulated=False)
    assert key.words.legs == {Side.LEFT: Verdict.READ, Side.RIGHT: Verdict.CARE}
    assert key.accessibleName() == "left leg: good, right leg: caution and Reference"
    assert "Right leg: caution." in charts.knee.in_words()
    charts.show_cycles(cycles, {}, is_simulated=False)
    assert key.words.legs == dict.fromkeys(Side, Verdict.READ)
    assert "caution" not in charts.knee.in_words()


def test_without_a_height_curves_are_drawn_about_their_mean_and_without_the_band(charts: CycleCharts) -> None:
    found = cycle(12, shift_deg=25.0)
    charts.show_cycles({Joint.LEFT_KNEE: found}, {Joint.LEFT_KNEE: judged_as(height=ZERO)}, is_simulated=False)
    chart = charts.knee.chart
    assert np.mean(chart.cycles[Side.LEFT].mean.mean) == pytest.approx(0.0, abs=1e-9)
    assert chart.range_deg == (-40.0, 50.0)
    assert "Axis widened" not in charts.knee.note
    group = reference_curves()
    assert colour_at(chart, 30, float(group.knee_mean_deg[30])).name() == current_theme().colours.surface.lower()
    assert charts.heights_deg == {Joint.LEFT_KNEE: pytest.approx(found.height_deg)}
    charts.show_stride({Joint.LEFT_KNEE: found.strides_deg[0]})
    assert chart.stride is not None
    np.testing.assert_allclose(chart.stride[1], found.strides_deg[0] - found.height_deg)
    charts.show_cycles({Joint.LEFT_KNEE: found}, {}, is_simulated=False)
    assert charts.heights_deg == {}
    assert chart.range_deg[0] == KNEE_DEG[0]


def test_where_no_band_may_stand_none_is_drawn(charts: CycleCharts) -> None:
    chart, mean_deg = show(charts), float(reference_curves().knee_mean_deg[30])
    charts.set_band(None)
    assert colour_at(chart, 30, mean_deg).name() == current_theme().colours.surface.lower()
    charts.set_band(reference_curves())
    assert colour_at(chart, 30, mean_deg).name() != current_theme().colours.surface.lower()


def test_single_strides_are_drawn_on_demand(charts: CycleCharts) -> None:
    charts.set_band_shown(False)
    chart = show(charts, left=cycle(5))
    highest = float(chart.cycles[Side.LEFT].strides_deg.max())
    assert colour_at(chart, 72, highest).name() == current_theme().colours.surface.lower()
    charts.set_strides_shown(True)
    assert colour_at(chart, 72, highest).name() != current_theme().colours.surface.lower()
    charts.set_strides_shown(False)
    assert colour_at(chart, 72, highest).name() == current_theme().colours.surface.lower()


def test_toe_off_is_named_at_its_line_the_earlier_one_in_full(charts: CycleCharts) -> None:
    chart = show(charts, left=cycle(12, toe_off_percent=58.7), right=cycle(12, toe_off_percent=63.2))
    assert toe_off_labels(chart.described.curves) == {Side.LEFT: "toe-off L 59 %", Side.RIGHT: "R 63 %"}
    assert any(
        is_like(colour_at(chart, percent, 75), current_theme().curve(Side.LEFT)) for percent in (58.6, 58.7, 58.8)
    )
    chart = show(charts, left=cycle(12, toe_off_percent=66), right=cycle(12, toe_off_percent=61))
    assert toe_off_labels(chart.described.curves) == {Side.RIGHT: "toe-off R 61 %", Side.LEFT: "L 66 %"}
    assert list(
        toe_off_labels(show(charts, left=cycle(12, toe_off_percent=60.4), right=cycle(12)).described.curves)
    ) == [*Side]


def test_what_the_height_of_a_curve_cannot_say_is_stated(charts: CycleCharts) -> None:
    cycles = {Joint.LEFT_KNEE: cycle(12), Joint.RIGHT_KNEE: cycle(12), Joint.LEFT_ANKLE: cycle(12, 20)}
    unset = judged_as(height=ZERO)
    charts.show_cycles(cycles, {Joint.LEFT_KNEE: unset, Joint.RIGHT_KNEE: unset}, is_simulated=False)
    reported = (
        "L and R: no standing reference. Range of motion and curve shape are valid; absolute angles are not. 0° "
        "is the mean angle over the gait cycle."
    )
    assert charts.knee.note == reported
    assert charts.ankle.note == ""
    charts.show_cycles(cycles, {Joint.LEFT_ANKLE: judged_as(height=SIGN, sign=SIGN)}, is_simulated=False)
    assert charts.ankle.note.startswith("L: it is unclear which direction is flexion. The curve may be inverted.")


def test_a_side_without_a_whole_stride_is_no_trouble(charts: CycleCharts) -> None:
    chart = show(charts, left=cycle(0, toe_off_percent=np.nan), right=cycle(4))
    charts.set_strides_shown(True)
    chart.grab()
    assert charts.knee.note == "L: no usable stride."
    assert "Left knee has no usable stride." in charts.knee.in_words()
    assert charts.ankle.note == "No ankle angles."


def test_the_mean_curves_are_reported_in_words(charts: CycleCharts) -> None:
    charts.show_cycles({Joint.LEFT_KNEE: cycle(12)}, {}, is_simulated=True)
    reported = charts.knee.chart.accessibleDescription()
    assert reported == (
        "Simulated. Left knee, mean of 12 strides: from 0.0° at 0 % to 60.0° at 72 % of the gait "
        "cycle, toe-off at 60 %."
    )
    assert charts.knee.chart.accessibleName() == "Knee over one gait cycle"


def test_simulated_is_on_both_charts_and_only_then(charts: CycleCharts) -> None:
    inked = []
    for is_simulated in (False, True):
        charts.show_cycles({Joint.LEFT_KNEE: cycle(12), Joint.LEFT_ANKLE: cycle(12)}, {}, is_simulated)
        for frame in charts.frames:
            picture, chart = frame.chart.grab().toImage(), frame.chart
            right = chart.width() - 1
            edge = [picture.pixelColor(right - x, y).lightness() for x in range(14) for y in range(40, 100)]
            inked.append(min(edge) < 100)
    assert inked == [False, False, True, True]


def peak(side: Side, angle_deg: float) -> Point:
    return Point(Joint(f"{side}_knee"), 72.0, angle_deg)


LEFT_UNDER_RIGHT = Deviation(
    peak(Side.LEFT, 40.0), peak(Side.RIGHT, 60.0), "L 20° under R", "loading too", is_larger_than_error=True
)


def test_a_difference_has_dots_at_its_ends_and_a_bar_in_free_space(charts: CycleCharts) -> None:
    charts.set_band_shown(False)
    chart = show(charts, left=cycle(12, 40), right=cycle(12, 60))
    assert not chart.layout_of_words.brackets
    charts.show_marks([LEFT_UNDER_RIGHT])
    ((_, place),) = chart.layout_of_words.brackets
    assert place.lines == 2
    assert (place.top, place.bottom) == (chart.at(72, 60).y(), chart.at(72, 40).y())
    middle = (place.top + place.bottom) / 2
    picture = chart.grab().toImage()
    assert is_like(picture.pixelColor(round(place.bar_x - 0.5), round(middle)), current_theme().colours.ink)
    at = chart.at(72, 60)
    assert (
        picture.pixelColor(round(at.x()), round(at.y())).name() == current_theme().colours.surface.lower()
    )  # right: outlined
    assert is_like(colour_at(chart, 72, 40), current_theme().curve(Side.LEFT))
    assert "L 20° under R, beyond measurement error; loading too." in charts.knee.in_words()
    assert "L 20° under R" not in charts.ankle.in_words()


def test_a_difference_inside_the_error_is_grey(charts: CycleCharts) -> None:
    chart = show(charts, left=cycle(12, 40), right=cycle(12, 60))
    charts.show_marks([replace(LEFT_UNDER_RIGHT, is_larger_than_error=False)])
    ((_, place),) = chart.layout_of_words.brackets
    found = chart.grab().toImage().pixelColor(round(place.bar_x - 0.5), round((place.top + place.bottom) / 2))
    assert is_like(found, current_theme().colours.control)
    assert "beyond measurement error" not in charts.knee.in_words()


def test_marks_stand_on_curves_that_are_drawn_alone_two_at_most_and_for_one_walk(charts: CycleCharts) -> None:
    cycles = {Joint.LEFT_KNEE: cycle(12, 40), Joint.RIGHT_KNEE: cycle(12, 60)}
    charts.show_cycles(cycles, {}, is_simulated=False)
    charts.show_marks([LEFT_UNDER_RIGHT, LEFT_UNDER_RIGHT, LEFT_UNDER_RIGHT])
    assert list(charts.knee.chart.deviations) == [LEFT_UNDER_RIGHT] * 2
    charts.show_cycles(cycles, {Joint.LEFT_KNEE: judged_as(PAIRING, PAIRING)}, is_simulated=False)
    assert list(charts.knee.chart.deviations) == []
    beside = np.zeros(101)
    outside = [Gap(joint, 60, 80, beside, "outside") for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE)]
    charts.show_marks([LEFT_UNDER_RIGHT], outside)
    assert list(charts.knee.chart.deviations) == []
    assert [gap.joint for gap in charts.knee.chart.gaps] == [Joint.RIGHT_KNEE]


def test_a_gap_is_filled_up_to_its_limit_and_marked_on_the_axis(charts: CycleCharts) -> None:
    charts.set_band_shown(False)
    chart = show(charts, left=cycle(9, 40))
    surface = current_theme().colours.surface.lower()
    limit_deg = chart.cycles[Side.LEFT].mean.mean + 12.0
    on_axis = chart.frame.low_deg + 2.5 / chart.frame.height * (chart.frame.high_deg - chart.frame.low_deg)
    assert colour_at(chart, 76, 42).name() == surface
    charts.show_marks([], [Gap(Joint.LEFT_KNEE, 66, 84, limit_deg, "outside 2 SD of the band")])
    assert colour_at(chart, 72, 47).name() == current_theme().soft(Side.LEFT).name()
    assert is_like(colour_at(chart, 75, on_axis), current_theme().curve(Side.LEFT))
    for percent in (55, 95):
        assert colour_at(chart, percent, on_axis).name() == surface
    assert colour_at(chart, 72, 56).name() == surface  # beyond the limit
    assert "Left knee, 66 to 84 % of the gait cycle: outside 2 SD of the band." in charts.knee.in_words()


def test_marks_are_lowered_with_the_curves_that_have_no_height(charts: CycleCharts) -> None:
    cycles = {Joint.LEFT_KNEE: cycle(12, 40, shift_deg=25.0), Joint.RIGHT_KNEE: cycle(12, 60)}
    charts.show_cycles(cycles, {Joint.LEFT_KNEE: judged_as(height=ZERO)}, is_simulated=False)
    highest = {side: charts.knee.chart.cycles[side].mean.mean.max() for side in Side}
    charts.show_marks([replace(LEFT_UNDER_RIGHT, first=peak(Side.LEFT, 65.0))])
    (mark,) = charts.knee.chart.deviations
    assert [point.angle_deg for point in mark.points] == pytest.approx([highest[Side.LEFT], highest[Side.RIGHT]])
