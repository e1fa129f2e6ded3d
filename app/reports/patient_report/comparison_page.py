"""What changed between conditions, or since an earlier visit, and is that more than the measurement error?"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from app.reports import comparison as walks
from app.reports.patient_report import panels
from app.reports.patient_report.blocks import Block, Cell, Column, Row, figures, heading, legend, note, paragraph, table
from app.reports.patient_report.cycle_chart import Chart, draw
from app.reports.patient_report.drawing import MM, Picture
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.numbers_in_words import NOTHING, fixed, in_a_sentence, in_words, signed, spread
from app.reports.walk_figures import is_spread_enough
from app.wording import capitalised, joined, side_name, tr
from core.body import Side
from core.norms import Difference, Verdict
from core.samples import FloatArray

ROWS = tuple(measure.column for measure in walks.MEASURES)
PLOT_WIDTHS = {2: 75.5 * MM, 3: 67 * MM}


@dataclass(frozen=True)
class Compared:
    """One condition or visit: its letter, what it is called, and its walk."""

    letter: str
    name: str
    facts: Facts

    @cached_property
    def told(self) -> walks.Part:
        walk, recordings = self.facts.walk, self.facts.visit.session.recordings
        names = [recording.name for recording in recordings]
        attachment = sum(r.is_restrapped_before for r in recordings[: names.index(walk.name) + 1])
        return walks.Part(self.letter, self.name, (walk,), self.facts.calibrated, attachment)


@dataclass(frozen=True)
class Comparison:
    """Two visits, or two or three conditions; each is told against the first, the last is the one shown."""

    parts: Sequence[Compared]
    is_visits: bool

    @cached_property
    def told(self) -> walks.Comparison:
        """The same comparison as the window and the files have it."""
        kind = walks.Kind.VISITS if self.is_visits else walks.Kind.CONDITIONS
        return walks.Comparison(kind, tuple(part.told for part in self.parts))

    @property
    def is_same_attachment(self) -> bool:
        """Whether the sensors stayed on from the first walk to the last."""
        return all(self.told.is_same_attachment(part) for part in self.told.others)

    @cached_property
    def has_one_zero(self) -> bool:
        """Whether the heights of all joints can be compared."""
        return all(self.told.has_one_zero(joint) for part in self.told.parts for joint in part.joints)

    def compare(self, part: Compared, side: Side, column: str) -> walks.Compared:
        """One part less the first."""
        return self.told.compare(_measured(column), side, part.told)

    def difference(self, part: Compared, side: Side, column: str) -> Difference:
        """One part less the first, for any angle of strides.csv and for stance."""
        return self.compare(part, side, column).difference

    def is_comparable(self, column: str) -> bool:
        return self.has_one_zero or not _measured(column).needs_height

    def sentences(self) -> list[str]:
        """What the first page says: the knee's swing peak and range of the first side, last part against the first."""
        shown = self.parts[-1]
        side = shown.facts.first_and_second[0]
        said = []
        for column, name in (
            ("knee_swing_peak_deg", tr("{side} knee in swing")),
            ("knee_range_deg", tr("{side} knee range over the stride")),
        ):
            compared = self.compare(shown, side, column)
            if not compared.is_told:
                continue
            value, found = compared.value, compared.difference
            since = (
                tr("since the earlier visit {change}°") if self.is_visits else tr("{this} against {first} {change}°")
            )
            names = {"this": shown.name, "first": self.parts[0].name}
            change = since.format(change=signed(found.difference_deg, 1), **names)
            pattern = tr("{measure}: {value}°; {change}: {verdict}{error}.")
            error = f" ({fixed(found.error_deg, 1)}°)" if math.isfinite(found.error_deg) else ""
            said.append(
                pattern.format(
                    measure=name.format(side=capitalised(side_name(side))),
                    value=fixed(value.mean, 0),
                    change=change,
                    verdict=in_a_sentence(found.verdict),
                    error=error,
                )
            )
        return said


def _measured(column: str) -> walks.Measure:
    return walks.Measure(column, "", column.split("_")[0] if column.endswith("_deg") else "")


def comparison_page(comparison: Comparison) -> list[Block]:
    title = tr("Comparison of visits") if comparison.is_visits else tr("Comparison of conditions")
    shown = comparison.parts[-1].facts
    sides = [side for side in Side if any(side in part.facts.gait for part in comparison.parts)]
    items = [_legend_entry(comparison, k, sides) for k in range(len(comparison.parts))]
    kinds = [kind for kind in KINDS if any(part.facts.has_joint(kind) for part in comparison.parts)]
    pictures = [_panel(comparison, side, kind) for kind in kinds for side in sides]
    band = panels.band_swatches() if any(_band(comparison, kind) is not None for kind in kinds) else []
    return [
        heading(title),
        paragraph(_what_else_changed(comparison)),
        legend([*items, *band], columns=2 if len(items) == 2 else 3),
        figures(pictures, columns=2),
        _table(comparison, [side for side in shown.first_and_second if side in sides]),
        note(_how_judged(comparison)),
    ]


def _legend_entry(comparison: Comparison, k: int, sides: Sequence[Side]) -> tuple[Picture, str]:
    looks = [(side, *panels.condition_look(k, len(comparison.parts), side)) for side in sides]
    part = comparison.parts[k]
    return panels.pair_swatch(part.letter, looks), part.name


def _panel(comparison: Comparison, side: Side, kind: str) -> Picture:
    is_about_mean = not comparison.has_one_zero  # heights from different zeros are no comparison
    lines = []
    for k, part in enumerate(comparison.parts):
        if not part.facts.is_measured(joint_of(kind, side)):
            continue
        colour, width = panels.condition_look(k, len(comparison.parts), side)
        own = panels.line_of(part.facts, side, kind, width=width, has_peaks=False)
        lines.append(
            replace(
                own,
                letter=part.letter,
                colour=colour,
                casing=0.9,
                angle_deg=own.angle_deg - np.mean(own.angle_deg) if is_about_mean else own.angle_deg,
                toe_off_sd=math.nan,
                toe_off_label=part.letter,
                strides_deg=np.empty((0, len(own.angle_deg))),
            )
        )
    shown = comparison.parts[-1].facts
    alts = [f"{part.letter}: {panels.curve_alt(part.facts, kind, [side])}" for part in comparison.parts]
    chart = Chart(
        title=panels.title_with_side(shown, kind, side, is_about_mean=is_about_mean),
        axis=panels.axis_of(shown, kind, is_about_mean=is_about_mean),
        lines=tuple(lines),
        band=_band(comparison, kind),
        plot_width=PLOT_WIDTHS[len(comparison.parts)],
        is_simulated=shown.is_simulated,
        alt=" ".join(alts),
    )
    return draw(chart)


def _band(comparison: Comparison, kind: str) -> tuple[FloatArray, FloatArray] | None:
    return panels.band_of(comparison.parts[-1].facts, kind) if comparison.has_one_zero else None


def _table(comparison: Comparison, sides: Sequence[Side]) -> Block:
    from app.reports.patient_report.first_page import role

    first, *later = comparison.parts
    columns = [Column(tr("Measure, °"), "1fr", is_number=False), *(Column(part.letter) for part in comparison.parts)]
    for part in later:
        if comparison.is_visits:
            columns += [Column(tr("Change 2 − 1")), Column(tr("Error")), Column(tr("In words"), is_number=False)]
        else:
            against = tr("{this} against {first}").format(this=part.letter, first=first.letter)
            columns += [Column(f"{part.letter} − {first.letter}"), Column(against, is_number=False)]
    rows: list[Row] = []
    for side in sides:
        rows.append(role(comparison.parts[-1].facts, side))
        rows += [_row(comparison, side, column) for column in ROWS if _is_measured(comparison, side, column)]
    return table(columns, rows, is_dense=True)


def _is_measured(comparison: Comparison, side: Side, column: str) -> bool:
    if column == "stance_percent":
        return True
    joint = joint_of(column.split("_")[0], side)
    return any(part.facts.is_measured(joint) for part in comparison.parts)


def _row(comparison: Comparison, side: Side, column: str) -> list[Cell | str]:
    cells: list[Cell | str] = [_measure(column)]
    for part in comparison.parts:
        value = part.facts.value(side, column)
        shown = tr("no peak") if part.facts.is_no_peak(side, column) else spread(value, 1)
        cells.append(Cell(shown, is_grey=not is_spread_enough(value.n)))
    for part in comparison.parts[1:]:
        compared = comparison.compare(part, side, column)
        found, is_told = compared.difference, compared.is_told
        words = Cell(in_words(found.verdict), is_bold=found.verdict is Verdict.EXCEEDS_ERROR) if is_told else NOTHING
        error = [fixed(found.error_deg, 1) if is_told else NOTHING] if comparison.is_visits else []
        cells += [signed(found.difference_deg, 1) if is_told else NOTHING, *error, words]
    return cells


def _measure(column: str) -> str:
    if column == "stance_percent":
        return tr("Stance, % of stride")
    kind = tr("Knee") if column.startswith("knee") else tr("Ankle")
    name = tr("range over the stride") if column.endswith("_range_deg") else panels.peak_name(column)
    return f"{kind}: {name}"


def _what_else_changed(comparison: Comparison) -> str:
    """Open with what besides the condition may make a difference: the straps, the zero, the speed."""
    if comparison.is_visits:
        said = [tr("Two visits, sensors put on anew.")]
    elif comparison.is_same_attachment:
        said = [tr("One session, sensors not moved between walks.")]
    else:
        said = [tr("One session, sensors strapped on anew between walks.")]
    if comparison.has_one_zero:
        said.append(tr("The same kind of zero at each."))
    else:
        said.append(tr("Zero is missing or differs in kind: only range and timing are compared."))
    speeds = [
        f"{part.letter}: {fixed(part.facts.feet.speed_m_s, 2)}"
        for part in comparison.parts
        if math.isfinite(part.facts.feet.speed_m_s)
    ]
    if len(speeds) == len(comparison.parts):
        said.append(
            tr("Speed {speeds} m/s: part of a difference can come from speed.").format(speeds=", ".join(speeds))
        )
    else:
        said.append(tr("The speed of each is not known, and part of a difference can come from it."))
    return " ".join(said)


def _how_judged(comparison: Comparison) -> str:
    if comparison.is_same_attachment:
        said = tr(
            "Measurement error here: 1.96 × standard error of the difference, plus 1°; for stance the larger of "
            "that standard error's part and {stance} %, a placeholder until repeat trials exist."
        ).format(stance=fixed(walks.STANCE_SAME_ATTACHMENT_PERCENT, 1))
    else:
        said = tr(
            "Measurement error with sensors put on anew: 9.2° for the knee; not known, so not judged, for the rest."
        )
    lines = tr("Vertical lines: toe\u2011off of each. {letters} sit on the lines; the first is thin and pale.")
    return f"{said} {lines.format(letters=joined([part.letter for part in comparison.parts]))}"
