"""Changes between conditions or since an earlier visit, and whether they are more than the measurement error."""

import math
from collections.abc import Sequence
from dataclasses import replace

from app.charts.cycles import Band, is_mean_enough, is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import compared_look, draw
from app.charts.stride_chart import NOT_KNOWN, StrideChart
from app.reports.blocks import Block, Cell, Column, Row, figures, heading, legend, note, paragraph, table
from app.summary import panels
from app.summary.comparison import Compared, Comparison, Contrast, Reservation
from app.summary.conditions import Part, left_out_of_parts
from app.summary.error_sources import sources_in_words
from app.summary.facts import Facts, joint_of, part_of, role
from app.summary.interval_words import interval_in_figures
from app.summary.measures import MEASURES, Measure
from app.summary.numbers_in_words import (
    CARE,
    NOTHING,
    dagger_note,
    fixed,
    judged_in_words,
    least_error_in_words,
    marked,
    signed,
    spread,
)
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.summary.report_dates import day
from app.summary.request import ReportRequest
from app.summary.visits import by_condition, condition_in_words
from app.wording.alignment import NO_PROOF, change_in_words
from app.wording.measures import measure_name, name_with_unit
from app.wording.recordings import name_in_words
from app.wording.translation import capitalised, joined, tr
from app.wording.verdicts import verdict_alone, verdict_word
from core.body import JointKind, Side
from core.parameters import KNEE_RANGE, STANCE
from core.verdicts.model import Verdict, worst
from core.verdicts.sigmas import ComparisonKind

CHANGES_LENGTH = 300  # letters: three lines of the table
PLOT_WIDTH = 53 * MM  # with the table of three parts, or a line more of words, this fills a Letter page
WITH_HIP_WIDTH = 44 * MM  # of three beside each other


def comparison_of(request: ReportRequest) -> Comparison | None:
    """Give what the report compares: an earlier visit that has the condition; without one, the chosen conditions.
    A walk represents its condition unless another of its walks was chosen; of a visit the last walk counts.
    """
    visit, is_simulated = request.visit, request.visit.analysis.is_simulated
    if request.earlier is not None:
        name = visit.recording(request.shown).returned_to
        same = by_condition(request.earlier.analysis, request.earlier.session.recordings).get(name)
        if same is None:
            return None
        pair = same, part_of(visit, request.shown)
        names = tr("Earlier visit, {day}"), tr("This visit, {day}")
        parts = [
            replace(part, letter=str(k + 1), name=names[k].format(day=_day_of(of.session.started)))
            for k, (part, of) in enumerate(zip(pair, (request.earlier, visit), strict=True))
        ]
        return Comparison(Contrast.VISITS, tuple(parts), is_simulated=is_simulated)
    if len(request.walks) < 2:
        return None
    conditions = [part_of(visit, name, request.walks) for name in request.walks]
    return Comparison(Contrast.CONDITIONS, tuple(conditions), is_simulated=is_simulated)


def not_compared_page(request: ReportRequest) -> list[Block]:
    """Say why an earlier visit that was chosen is not compared with; nothing where it is, or none was chosen."""
    earlier, visit = request.earlier, request.visit
    if earlier is None or comparison_of(request) is not None:
        return []
    before = list(by_condition(earlier.analysis, earlier.session.recordings))
    stated = tr("The visit on {day} has no walk that can be compared.")
    if before:
        stated = tr(
            "The visit on {day} has no walk in this condition ({condition}), so it is not compared. Its "
            "conditions: {others}."
        )
    words = stated.format(
        day=_day_of(earlier.session.started),
        condition=_condition_typed(visit.recording(request.shown).returned_to),
        others=", ".join(map(_condition_typed, before)),
    )
    return [heading(tr("Comparison of visits")), paragraph(words)]


def _condition_typed(condition: str) -> str:
    return typed(name_in_words(condition), CONDITION_LENGTH) if condition else condition_in_words("")


def _day_of(started: str) -> str:
    return day(started) if started else tr("date not recorded")


def comparison_page(comparison: Comparison, shown: Facts, *, has_fitting: bool) -> list[Block]:
    """`shown` is the walk that the other pages are of: it belongs to the last part.

    `has_fitting`: what was changed at the prosthesis has a page of its own.
    """
    title = tr("Comparison of visits") if comparison.kind is Contrast.VISITS else tr("Comparison of conditions")
    sides = [side for side in shown.first_and_second if side in comparison.sides]
    kinds = [kind for kind in JointKind if any(joint_of(kind, side) in comparison.joints for side in Side)]
    has_hips = JointKind.HIP in kinds  # three joints beside each other, a row for each leg
    places = [(side, kind) for side in sides for kind in kinds] if has_hips else [(s, k) for k in kinds for s in sides]
    pictures = [_panel(comparison, shown, side, kind) for side, kind in places]
    band = (
        panels.band_swatches()
        if any(_band(comparison, shown, kind, side) is not None for kind in kinds for side in comparison.sides)
        else []
    )
    return [
        heading(title),
        paragraph(_what_else_changed(comparison)),
        _parts_table(comparison),
        *([] if has_fitting else _changes(comparison)),
        *([legend(band, columns=3)] if band else []),
        figures(pictures, columns=3 if has_hips else 2),
        _table(comparison, shown, sides),
        note(" ".join(filter(None, [_how_judged(comparison), left_out_of_parts(comparison.parts)]))),
    ]


def _parts_table(comparison: Comparison) -> Block:
    """What is compared: the lines of each, its strides and speed, and what may be read of it."""
    is_visits = comparison.kind is Contrast.VISITS
    columns = [
        Column("", is_number=False),
        Column(tr("Visit") if is_visits else tr("Condition"), "1fr", is_number=False),
        Column(tr("Strides")),
        Column(tr("Speed, m/s")),
        *(Column(head, "25mm", is_number=False) for head in (tr("ROM, shape"), tr("Absolute angle"), tr("Timing"))),
    ]
    rows: list[Row] = []
    for k, part in enumerate(comparison.parts):
        looks = [(side, *compared_look(k, len(comparison.parts), side)) for side in comparison.sides]
        joints = [part.verdicts.joint(joint) for joint in part.joints]
        worst_of = (
            worst(found.shape.verdict for found in joints),
            worst(found.height.verdict for found in joints),
            worst(part.verdicts.leg(side).timing.verdict for side in part.sides),
        )
        strides = ", ".join(f"{side.letter}\u00a0{part.strides(side)}" for side in part.sides)
        rows.append(
            [
                Cell(part.letter, picture=panels.pair_swatch(part.letter, looks)),
                typed(name_in_words(part.name), CONDITION_LENGTH),
                strides,
                fixed(part.of_both("speed_m_s"), 2),
                *map(verdict_alone, worst_of),
            ]
        )
    return table(columns, rows, is_dense=True)


def _changes(comparison: Comparison) -> list[Block]:
    """Return what was turned before each condition, and that walks may not show it."""
    changed = [part for part in comparison.parts if part.alignment is not None]
    if not changed:
        return []
    columns = [
        Column("", is_number=False),
        Column(tr("Changed from"), "35mm", is_number=False),
        Column(tr("Changes to the prosthesis"), "1fr", is_number=False),
    ]
    rows: list[Row] = []
    for part in comparison.parts:
        since, words = tr("starting point"), NOTHING
        if part.alignment is not None:
            since = typed(part.alignment.since, CONDITION_LENGTH)
            words = typed(change_in_words(part.alignment), CHANGES_LENGTH)
        rows.append([part.letter, since, words])
    return [table(columns, rows, is_dense=True), note(tr(NO_PROOF))]


def _panel(comparison: Comparison, shown: Facts, side: Side, kind: str) -> Picture:
    is_about_mean = not comparison.has_one_zero_throughout  # heights from different zeros are no comparison
    curves, alts = [], []
    for k, part in enumerate(comparison.parts):
        if joint_of(kind, side) in part.joints:
            curve = part.curve(joint_of(kind, side), is_about_mean=is_about_mean)
            angle_deg = NOT_KNOWN if curve.is_few else curve.angle_deg
            curves.append(replace(curve, order=(k, len(comparison.parts)), angle_deg=angle_deg))
            alts.append(_alt(part, side, kind))
    chart = StrideChart(
        title=_title(shown, kind, side, is_about_mean=is_about_mean),
        axis=panels.axis_of(shown, kind, is_about_mean=is_about_mean),
        curves=tuple(curves),
        band=_band(comparison, shown, kind, side),
        is_simulated=comparison.is_simulated,
        alt=" ".join([tr("SIMULATED.")] * comparison.is_simulated + [panels.title_of(shown, kind) + ".", *alts]),
    )
    return draw(chart, WITH_HIP_WIDTH if any(joint.is_hip for joint in comparison.joints) else PLOT_WIDTH)


def _title(shown: Facts, kind: str, side: Side, *, is_about_mean: bool) -> str:
    """Short, as the panels are narrow: the table below them takes the page."""
    if is_about_mean or shown.has_no_zero(kind):
        return panels.title_with_side(shown, kind, side, is_about_mean=is_about_mean)
    stated = tr("Left: {title}") if side is Side.LEFT else tr("Right: {title}")
    titles = {
        JointKind.HIP: tr("hip, degrees (flexion +)"),
        JointKind.KNEE: tr("knee, degrees (flexion +)"),
        JointKind.ANKLE: tr("ankle, degrees (dorsiflexion +)"),
    }
    title = titles[JointKind(kind)]
    return stated.format(title=title)


def _alt(part: Part, side: Side, kind: str) -> str:
    """One line of a panel in words and numbers."""
    values = {column: part.value(side, column) for column in panels.PEAK_COLUMNS[kind]}
    peaks = [f"{panels.peak_name(of)} {fixed(one.mean, 0)}°" for of, one in values.items() if is_mean_enough(one.n)]
    return f"{part.letter}: {panels.leg_in_numbers(part, side, kind, peaks)}."


def _band(comparison: Comparison, shown: Facts, kind: str, side: Side) -> Band | None:
    return panels.band_of(shown, kind, [side]) if comparison.has_one_zero_throughout else None


def _table(comparison: Comparison, shown: Facts, sides: Sequence[Side]) -> Block:
    is_visits = comparison.kind is Contrast.VISITS
    columns = [Column(tr("Measure, °"), "1fr", is_number=False), *(Column(part.letter) for part in comparison.parts)]
    for part in comparison.others:
        if is_visits:
            columns += [Column(tr("Change 2 − 1")), Column(tr("likely between")), Column(tr("Result"), is_number=False)]
        else:
            base = comparison.base_of(part)
            against = tr("{this} vs {first}").format(this=part.letter, first=base.letter)
            columns += [Column(f"{part.letter} − {base.letter}"), Column(against, is_number=False)]
    rows: list[Row] = []
    for side in sides:
        count = tr("{count}\u00a0in\u00a0{part}")
        counts = ", ".join(count.format(count=part.strides(side), part=part.letter) for part in comparison.parts)
        rows.append(tr("{side}: strides {counts}").format(side=capitalised(role(shown, side)), counts=counts))
        for measure in MEASURES:
            if not measure.is_of_walk and any(part.is_measured(side, measure.column) for part in comparison.parts):
                rows.append(_row(comparison, side, measure))
    rows.append(tr("Both legs"))
    rows += [_row(comparison, sides[0], measure) for measure in MEASURES if measure.is_of_walk]
    return table(columns, rows, is_dense=True)


def _row(comparison: Comparison, side: Side, measure: Measure) -> list[Cell | str]:
    cells: list[Cell | str] = [_measure(measure.column)]
    for part in comparison.parts:
        value, verdict = part.figure(measure, side)
        figures = marked(spread(value, measure.decimals), verdict)
        is_no_peak = not measure.is_of_walk and part.is_no_peak(side, measure.column)
        shown = tr("no peak") if is_no_peak else figures
        if verdict is Verdict.NOT_REPORTED:
            shown = verdict_word(verdict)
        cells.append(Cell(shown, is_grey=not is_spread_enough(value.n)))
    for part in comparison.others:
        compared = _compared(comparison, measure, side, part)
        found, is_reported = compared.difference, compared.is_reported
        words = Cell(judged_in_words(found), is_bold=found.exceeds) if is_reported else _why_not(compared)
        decimals = measure.decimals
        is_visits = comparison.kind is Contrast.VISITS
        error = [interval_in_figures(measure.column, found) if is_reported else NOTHING] if is_visits else []
        cells += [signed(found.difference, decimals) if is_reported else NOTHING, *error, words]
    return cells


def _compared(comparison: Comparison, measure: Measure, side: Side, part: Part) -> Compared:
    """A measure of a part and of the one that it is compared with."""
    base = comparison.base_of(part)
    if measure.is_of_walk:
        return comparison.compare_walks(measure, part, base)
    return comparison.compare(measure, side, part, base)


def _measure(column: str) -> str:
    return measure_name(column) if column.endswith("_deg") else name_with_unit(column)


def _what_else_changed(comparison: Comparison) -> str:
    """Open with what besides the condition may make a difference: the straps, the zero, the speed."""
    if comparison.kind is Contrast.VISITS:
        stated = [tr("Two visits, sensors reattached.")]
    elif comparison.is_one_attachment:
        stated = [tr("One session, sensors left in place between walks.")]
    else:
        stated = [tr("One session, sensors reattached between walks.")]
    if comparison.has_one_zero_throughout:
        stated.append(tr("The standing reference is of the same kind throughout."))
    else:
        stated.append(
            tr("The standing reference is missing or of another kind: only range of motion and timing are compared.")
        )
    speeds = {part.letter: part.of_both("speed_m_s") for part in comparison.parts}
    if all(map(math.isfinite, speeds.values())):
        each = ", ".join(f"{letter}: {fixed(speed, 2)}" for letter, speed in speeds.items())
        stated.append(tr("Speed {speeds} m/s: part of a difference may be due to speed.").format(speeds=each))
    else:
        stated.append(tr("Not all walking speeds are known: part of a difference may be due to speed."))
    return " ".join(stated)


def _why_not(compared: Compared) -> Cell | str:
    return tr("not reported") if compared.reservation in (Reservation.NOT_REPORTED, Reservation.OTHER_ZERO) else NOTHING


def _how_judged(comparison: Comparison) -> str:
    """What the error contains, with what was added for what lies between the walks."""
    kinds = {comparison.error_kind(part, comparison.base_of(part)) for part in comparison.others}
    kind = max(kinds, key=list(ComparisonKind).index)
    knee, stance = (least_error_in_words(name, kind) for name in (KNEE_RANGE, STANCE))
    rows = [_compared(comparison, row.measure, row.side, row.part) for row in comparison.rows]
    reported = [row.difference for row in rows if row.is_reported and row.difference.is_judged]
    stated = tr(
        "Measurement error: 1.96 times the standard deviation of the difference. It includes "
        "{sources}. Differences between walks alone account for {knee}° of knee range of motion and "
        "{stance} percentage points of stance."
    )
    lines = tr(
        "Vertical lines: toe\u2011off of each curve. {letters} name the curves; the first curve is thin and pale."
    )
    parts = [
        *([stated.format(sources=sources_in_words(reported), knee=knee, stance=stance)] if reported else []),
        *([dagger_note()] if any(found.is_unverified for found in reported) else []),
        *([tr("{mark}: caution.").format(mark=CARE)] if _has_care(comparison) else []),
        lines.format(letters=joined([p.letter for p in comparison.parts])),
    ]
    return " ".join(parts)


def _has_care(comparison: Comparison) -> bool:
    columns = [measure.column for measure in MEASURES]
    return any(
        part.assessment(side, column).verdict is Verdict.CARE
        for part in comparison.parts
        for side in part.sides
        for column in columns
    )
