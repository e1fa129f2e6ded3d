"""What have all curves of the report in common? Axes, the colours of legs and conditions, swatches, words for them."""

import math
from collections.abc import Sequence

import numpy as np

from app.charts.cycles import Band, is_mean_enough, is_spread_enough
from app.charts.drawing import COLOURS, DASHES, Picture, box, line, marker, picture, text
from app.charts.on_paper import PLAIN, STRIDE
from app.charts.stride_chart import NO_STRIDES, Axis, PeakMark, Span, StrideCurve, usual_range_deg
from app.colours import PAPER
from app.reports.patient_report.facts import Facts, joint_of
from app.reports.patient_report.numbers_in_words import fixed
from app.wording import side_name, tr
from core.body import Side
from core.verdicts.model import Verdict
from core.verdicts.quantities import WINDOWS

SWATCH_WIDTH, SWATCH_HEIGHT = 30.0, 9.0
PEAK_COLUMNS = {
    "knee": ("knee_loading_peak_deg", "knee_swing_peak_deg"),
    "ankle": ("ankle_stance_dorsiflexion_deg", "ankle_push_off_plantarflexion_deg"),
}


def axis_of(facts: Facts, kind: str, *, is_about_mean: bool = False) -> Axis:
    """The same in every report; without a zero, about the mean of the stride."""
    is_knee, is_about_mean = kind == "knee", is_about_mean or facts.has_no_zero(kind)
    low, high = usual_range_deg(is_knee=is_knee, is_about_mean=is_about_mean)
    if is_knee:
        return Axis(low, high, 20, 10, tr("bent"), tr("straight"))
    return Axis(low, high, 10, 10, tr("toes up"), tr("toes down"))


def title_of(facts: Facts, kind: str) -> str:
    if facts.has_no_zero(kind):
        return (
            tr("Knee angle, degrees from the mean of the stride (flexion +)")
            if kind == "knee"
            else tr("Ankle angle, degrees from the mean of the stride (dorsiflexion +)")
        )
    return (
        tr("Knee angle, degrees (flexion +, extension −)")
        if kind == "knee"
        else tr("Ankle angle, degrees (dorsiflexion +, plantarflexion −)")
    )


def title_with_side(facts: Facts, kind: str, side: Side, *, is_about_mean: bool = False) -> str:
    said = tr("Left: {title}") if side is Side.LEFT else tr("Right: {title}")
    return said.format(title=small_title(facts, kind, is_about_mean=is_about_mean))


def small_title(facts: Facts, kind: str, *, is_about_mean: bool = False) -> str:
    """Of a panel half as wide as the page, as it goes on behind a side."""
    short = {
        "knee": tr("knee, degrees from the mean (flexion +)"),
        "ankle": tr("ankle, degrees from the mean (dorsiflexion +)"),
    }
    title = title_of(facts, kind)
    return short[kind] if is_about_mean or facts.has_no_zero(kind) else title[:1].lower() + title[1:]


def band_of(facts: Facts, kind: str, sides: Sequence[Side]) -> Band | None:
    """Mean and SD of band [1]; None where there is none for any of these legs, or nothing to compare."""
    group = facts.curves_group
    if group is None or facts.has_no_zero(kind) or facts.sides_with_band.isdisjoint(sides):
        return None
    if not any(np.isfinite(facts.mean_curve_deg(side, kind)).any() for side in sides if side in facts.sides_with_band):
        return None
    return Band(*group.mean_and_sd_deg(kind))


def curve_of(facts: Facts, side: Side, kind: str, *, peaks: Sequence[str] = (), is_fine: bool = False) -> StrideCurve:
    """One leg of one walk, with marks at the peaks of these columns of strides.csv."""
    letter = side[0].upper()
    off = facts.value(side, "stance_percent")
    is_known = is_mean_enough(off.n)
    label = tr("{side} toe\u2011off {percent} %").format(side=letter, percent=fixed(off.mean, 1))
    return StrideCurve(
        letter=letter,
        side=side,
        angle_deg=facts.mean_curve_deg(side, kind),
        toe_off_percent=off.mean if is_known else math.nan,
        toe_off_sd=off.sd if is_spread_enough(off.n) else math.nan,
        toe_off_label=label,
        peaks=_marks(facts, side, peaks) if not facts.has_no_zero(kind) else (),
        strides_deg=NO_STRIDES if is_known else facts.strides_deg(side, kind),
        is_fine=is_fine,
    )


def swatch(side: Side, colour: str | None = None, width: float = PLAIN) -> Picture:
    y = SWATCH_HEIGHT / 2
    return picture(
        [line(0, y, SWATCH_WIDTH, y, colour or COLOURS[side], width, DASHES[side])], SWATCH_WIDTH, SWATCH_HEIGHT
    )


def pair_swatch(letter: str, looks: Sequence[tuple[Side, str, float]]) -> Picture:
    """A letter, and the lines of both legs that it stands for."""
    y, parts = SWATCH_HEIGHT / 2, [text(0, 7, letter, 7.6, weight=600)]
    for k, (side, colour, width) in enumerate(looks):
        x = 10 + 22 * k
        parts.append(line(x, y, x + 19, y, colour, width, DASHES[side]))
    return picture(parts, 53, SWATCH_HEIGHT)


def stride_swatch() -> Picture:
    """Thin lines, as single strides are drawn."""
    parts = [line(0, y, SWATCH_WIDTH, y, COLOURS[Side.LEFT], STRIDE) for y in (2.5, 4.5, 6.5)]
    return picture(parts, SWATCH_WIDTH, SWATCH_HEIGHT)


def band_swatches() -> list[tuple[Picture, str]]:
    inner = [
        box(0.2, 1, SWATCH_WIDTH - 0.4, 7, PAPER.band_1sd, PAPER.band_1sd_edge, 0.35),
        line(0, 4.5, SWATCH_WIDTH, 4.5, PAPER.band_mean, 0.6),
    ]
    outer = [box(0.2, 1, SWATCH_WIDTH - 0.4, 7, PAPER.band_2sd, PAPER.band_2sd_edge, 0.35)]
    return [
        (picture(inner, SWATCH_WIDTH, SWATCH_HEIGHT), tr("Band mean, ±1 SD [1]")),
        (picture(outer, SWATCH_WIDTH, SWATCH_HEIGHT), tr("±2 SD [1]")),
    ]


def leg_swatches(facts: Facts) -> list[tuple[Picture, str]]:
    said = {Side.LEFT: tr("Left: solid line, circle"), Side.RIGHT: tr("Right: dashed line, square")}
    return [(swatch(side), said[side]) for side in Side if side in facts.gait]


def event_swatches(*, has_other_foot: bool, has_peaks: bool) -> list[tuple[Picture, str]]:
    x = SWATCH_WIDTH / 2
    left = COLOURS[Side.LEFT]
    toe_off = [line(x, 0, x, SWATCH_HEIGHT, left, 0.9), line(x - 5, 0.8, x + 5, 0.8, PAPER.ink, 1.4)]
    other = [line(x, 1, x, 8, left, 1.1)]
    found = [(picture(toe_off, SWATCH_WIDTH, SWATCH_HEIGHT), tr("Toe\u2011off, bar on top ±1 SD"))]
    if has_other_foot:
        found.append((picture(other, SWATCH_WIDTH, SWATCH_HEIGHT), tr("Other foot: toe\u2011off, contact")))
    return [*found, peak_swatch()] if has_peaks else found


def peak_swatch() -> tuple[Picture, str]:
    x = SWATCH_WIDTH / 2
    parts = [line(x, 0.5, x, 8.5, PAPER.ink, 0.8), marker(x, 4.5, Side.LEFT)]
    return picture(parts, SWATCH_WIDTH, SWATCH_HEIGHT), tr("Mean of single peaks, ±1 SD")


def cross_swatch() -> Picture:
    x = SWATCH_WIDTH / 2
    parts = [line(x - 1.8, 4.5 - 1.8 * way, x + 1.8, 4.5 + 1.8 * way, PAPER.ink, 0.9) for way in (1, -1)]
    return picture(parts, SWATCH_WIDTH, SWATCH_HEIGHT)


def other_foot(facts: Facts) -> tuple[tuple[float, Side], ...]:
    """When in a leg's stride the other foot leaves and meets the ground, percent; each half a stride away in time.

    Told by the step time, so that an uneven walk is drawn as it is.
    """
    ticks = []
    for side in facts.gait:
        other = Side.RIGHT if side is Side.LEFT else Side.LEFT
        step, stride = facts.value(side, "step_time_s"), facts.value(side, "stride_time_s")
        swing = facts.value(other, "swing_percent")
        if not all(is_mean_enough(value.n) for value in (step, stride, swing)):
            continue  # too few, or instants of both legs are not to be compared
        contact = 100 - 100 * step.mean / stride.mean  # the other foot's contact begins this foot's step
        ticks += [(contact, other), (contact - swing.mean, other)]
    return tuple((percent, side) for percent, side in ticks if 0 < percent < 100)


def not_drawn(facts: Facts, kind: str) -> list[str]:
    """Say of each leg whose curve is missing why it is."""
    said = []
    for side in Side:
        joint = f"{side_name(side)} " + (tr("knee") if kind == "knee" else tr("ankle"))
        if not np.isfinite(facts.mean_curve_deg(side, kind)).any() and not len(facts.strides_deg(side, kind)):
            found = facts.verdicts.joint(joint_of(kind, side))
            is_withheld = Verdict.WITHHELD in (found.shape.verdict, found.sign.verdict)
            pattern = tr("Not drawn: {joint}, withheld.") if is_withheld else tr("Not drawn: {joint}.")
            said.append(pattern.format(joint=joint))
    return said


def curve_alt(facts: Facts, kind: str, sides: Sequence[Side]) -> str:
    """The figure in words and numbers, for who does not see it."""
    said = [title_of(facts, kind) + "."]
    for side in sides:
        numbers = [tr("{count} strides").format(count=facts.strides(side))]
        for column in PEAK_COLUMNS[kind]:
            value, at = facts.value(side, column), facts.peak_percent(side, column)
            if is_mean_enough(value.n):
                peak = tr("{name} {value}° at {percent} %")
                name = peak_name(column)
                numbers.append(peak.format(name=name, value=fixed(value.mean, 0), percent=fixed(at.mean, 0)))
        found = facts.value(side, f"{kind}_range_deg")
        if is_mean_enough(found.n):
            numbers.append(tr("range {value}°").format(value=fixed(found.mean, 0)))
        off = facts.value(side, "stance_percent")
        if is_mean_enough(off.n):
            numbers.append(tr("toe\u2011off at {percent} %").format(percent=fixed(off.mean, 0)))
        said.append(f"{side_name(side).capitalize()}: {', '.join(numbers)}.")
    return " ".join([tr("SIMULATED.")] * facts.is_simulated + said)


def peak_name(column: str) -> str:
    return {
        "knee_loading_peak_deg": tr("most flexed, loading"),
        "knee_stance_minimum_deg": tr("least flexed, stance"),
        "knee_swing_peak_deg": tr("most flexed, swing"),
        "ankle_loading_plantarflexion_deg": tr("most plantarflexed, loading"),
        "ankle_stance_dorsiflexion_deg": tr("most dorsiflexed, stance"),
        "ankle_push_off_plantarflexion_deg": tr("most plantarflexed, push\u2011off"),
        "ankle_swing_dorsiflexion_deg": tr("most dorsiflexed, swing"),
    }[column]


def excursion_name(column: str) -> str:
    return {
        "knee_while_loading_deg": tr("bend while loading"),
        "knee_straightening_deg": tr("straightening in stance"),
        "knee_stance_to_swing_deg": tr("stance to swing"),
        "ankle_heel_rocker_deg": tr("heel rocker"),
        "ankle_rocker_deg": tr("ankle rocker"),
        "ankle_push_off_deg": tr("push\u2011off"),
        "ankle_toes_lifted_deg": tr("toes lifted"),
    }[column]


def spans_of(kind: str) -> dict[str, Span]:
    """Where each peak of a joint is looked for, by its column of strides.csv."""
    names = {
        "knee_loading_peak_deg": tr("loading"),
        "knee_stance_minimum_deg": tr("stance"),
        "knee_swing_peak_deg": tr("swing"),
        "ankle_loading_plantarflexion_deg": tr("loading"),
        "ankle_stance_dorsiflexion_deg": tr("stance"),
        "ankle_push_off_plantarflexion_deg": tr("push\u2011off"),
        "ankle_swing_dorsiflexion_deg": tr("swing"),
    }
    windows = {column: window for column, window in WINDOWS.items() if column.startswith(kind)}
    return {column: Span(names[column], one.first, one.last, one.is_maximum) for column, one in windows.items()}


def _marks(facts: Facts, side: Side, columns: Sequence[str]) -> tuple[PeakMark, ...]:
    marks = []
    for column in columns:
        value, at = facts.value(side, column), facts.peak_percent(side, column)
        if is_mean_enough(value.n) and math.isfinite(at.mean):
            marks.append(PeakMark(at.mean, value.mean, value.sd if is_spread_enough(value.n) else math.nan))
    return tuple(marks)
