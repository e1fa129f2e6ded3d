"""A prosthesis fitted in the visit: what was set, what is measured, and one picture of the change."""

from dataclasses import replace

from app.charts.cycles import is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import NOT_KNOWN, StrideChart
from app.reports.blocks import Block, Cell, Column, Row, figures, heading, note, paragraph, table
from app.summary import panels
from app.summary.comparison import Compared
from app.summary.conditions import Part
from app.summary.facts import Facts, joint_of
from app.summary.measures import Measure
from app.summary.numbers_in_words import DAGGER, MARKS, NOTHING, care_note, dagger_note, fixed, marked, signed
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.summary.prosthesis_fitting import ProsthesisFitting, of_both, of_sound
from app.summary.set_angle import set_angle_in_words
from app.wording.alignment import NO_PROOF, change_in_words
from app.wording.measures import measure_name, name_with_unit
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from app.wording.verdicts import verdict_word
from core.body import JointKind, Side
from core.verdicts.model import Verdict

CHANGES_LENGTH = 300  # letters: three lines of the table
MOST_CHANGED = 4  # alignments beside the starting point for which the table has columns
MOST_DRAWN = 3  # lines of one picture
PLOT_WIDTH = 110 * MM


def fitting_page(found: ProsthesisFitting, shown: Facts) -> list[Block]:
    """`shown` is the walk that the other pages are of."""
    latest = found.others[-MOST_CHANGED:]
    rows = [row for part in latest for row in _compared(found, part)]
    is_unverified = any(row.difference.is_unverified for row in rows if row.is_reported)
    has_care = any(found.start.figure(row.measure, row.side)[1] is Verdict.CARE for row in rows)
    return [
        heading(tr("Prosthesis fitting")),
        paragraph(_opening(found)),
        _alignments(found),
        _differences(found, latest),
        note(" ".join([_marks(), *([dagger_note()] if is_unverified else []), *([care_note()] if has_care else [])])),
        figures([_picture(found, shown)], columns=1),
        note(tr(NO_PROOF)),
    ]


def _opening(found: ProsthesisFitting) -> str:
    """What lies between the walks, and whether what was undone came back."""
    straps = (
        tr("Sensors stayed attached throughout.")
        if found.comparison.is_one_attachment
        else tr("Sensors were reattached in between: differences are less certain.")
    )
    returned = [part for part in found.others if part.is_again(found.comparison.base_of(part))]
    return " ".join([straps, *(_returned(found, part) for part in returned)])


def _returned(found: ProsthesisFitting, part: Part) -> str:
    """Whether a repeat measures what the first walk of its setting did."""
    base = found.comparison.base_of(part)
    rows = [row for row in _compared(found, part) if row.is_reported and row.difference.is_judged]
    beyond = [row for row in rows if row.exceeds]
    pair = {"again": part.letter, "first": base.letter}
    if not rows:
        return tr("{again} repeats {first}; nothing of it can be compared.").format(**pair)
    if not beyond:
        return tr("{again} repeats {first}: all differences may be measurement error.").format(**pair)
    names = ", ".join(dict.fromkeys(measure_name(row.measure.column) for row in beyond))
    stated = tr("{again} repeats {first}, but differs beyond measurement error: {measures}. Not all returned.")
    return stated.format(**pair, measures=names)


def _compared(found: ProsthesisFitting, part: Part) -> list[Compared]:
    rows = [found.compared(measure, found.side, part) for measure in found.of_prosthetic()]
    if found.sound in found.comparison.sides:
        rows += [found.compared(measure, found.sound, part) for measure in of_sound()]
    return rows + [found.compared(measure, found.side, part) for measure in of_both()]


def _alignments(found: ProsthesisFitting) -> Block:
    columns = [
        Column("", is_number=False),
        Column(tr("Changed from"), is_number=False),
        Column(tr("Changes to the prosthesis"), "1fr", is_number=False),
        Column(tr("Foot angle, set and measured"), "48mm", is_number=False),
        Column(tr("Strides")),
        Column(tr("Speed, m/s")),
    ]
    rows: list[Row] = []
    for part, angle in zip(found.comparison.parts, (None, *found.set_angles), strict=True):
        since, words = tr("starting point"), NOTHING
        base = found.comparison.base_of(part)
        if part is not found.start and part.is_again(base):
            since = tr("repeats {letter}").format(letter=base.letter)
        elif part.alignment is not None:
            since = typed(name_in_words(part.alignment.since), CONDITION_LENGTH)
            words = typed(change_in_words(part.alignment), CHANGES_LENGTH)
        strides = ", ".join(f"{side.letter}\u00a0{part.strides(side)}" for side in part.sides)
        measured = set_angle_in_words(angle) if angle is not None else ""
        speed = fixed(part.of_both("speed_m_s"), 2)
        rows.append([Cell(part.letter, is_bold=True), since, words, measured or NOTHING, strides, speed])
    return table(columns, rows, is_dense=True)


def _differences(found: ProsthesisFitting, latest: tuple[Part, ...]) -> Block:
    """Values of the starting point, then by how much each alignment differs from what it was changed from."""
    columns = [Column(tr("Measure"), "1fr", is_number=False), Column(found.start.letter)]
    columns += [Column(f"{part.letter} − {found.comparison.base_of(part).letter}") for part in latest]
    prosthetic, sound = (tr("left"), tr("right")) if found.side is Side.LEFT else (tr("right"), tr("left"))
    rows: list[Row] = [tr("Prosthetic side ({side})").format(side=prosthetic)]
    rows += [_row(found, measure, found.side, latest) for measure in found.of_prosthetic()]
    if found.sound in found.comparison.sides:
        rows.append(tr("Sound side ({side})").format(side=sound))
        rows += [_row(found, measure, found.sound, latest) for measure in of_sound()]
    rows.append(tr("Both legs"))
    rows += [_row(found, measure, found.side, latest) for measure in of_both()]
    return table(columns, rows, is_dense=True)


def _row(found: ProsthesisFitting, measure: Measure, side: Side, latest: tuple[Part, ...]) -> list[Cell | str]:
    value, verdict = found.start.figure(measure, side)
    first = marked(fixed(value.mean, measure.decimals), verdict)
    if verdict is Verdict.NOT_REPORTED:
        first = verdict_word(verdict)
    cells: list[Cell | str] = [name_with_unit(measure.column), Cell(first, is_grey=not is_spread_enough(value.n))]
    for part in latest:
        row = found.compared(measure, side, part)
        cells.append(Cell(_difference(row), is_bold=row.exceeds))
    return cells


def _difference(row: Compared) -> str:
    """As "○ +2.3 ± 0.9": the mark, the difference and half of its likely interval."""
    difference, decimals = row.difference, row.measure.decimals
    if not row.is_reported:
        return NOTHING
    stated = signed(difference.difference, decimals)
    if difference.is_judged:
        dagger = DAGGER if difference.is_unverified else ""
        stated = f"{stated}\u00a0±\u00a0{fixed(difference.error, decimals)}{dagger}"
    return f"{MARKS[difference.mark]} {stated}".strip()


def _marks() -> str:
    return tr(
        "± half of the likely interval (95 of 100). \N{WHITE CIRCLE} beyond measurement error; no mark: may be error. "
        "–: not compared."
    )


def _picture(found: ProsthesisFitting, shown: Facts) -> Picture:
    """The joint of the prosthetic side that changed by most errors: at the start, as changed, and after the return."""
    joints = [row for part in found.others for row in _compared(found, part) if row.side is found.side]
    judged = [row for row in joints if row.is_reported and row.difference.is_judged and row.measure.kind]
    most = max(judged, key=lambda row: row.difference.ratio, default=None)
    kind = JointKind(most.measure.kind) if most is not None else JointKind.KNEE
    changed = most.part if most is not None else found.others[-1]
    back = [part for part in found.others if part.is_again(found.start)]
    drawn = [part for part in found.comparison.parts if part in (found.start, changed, *back[-1:])][:MOST_DRAWN]
    joint, is_about_mean = joint_of(kind, found.side), not found.comparison.has_one_zero_throughout
    curves, stated = [], []
    for k, part in enumerate(drawn):
        if joint in part.joints:
            curve = part.curve(joint, is_about_mean=is_about_mean)
            angle_deg = NOT_KNOWN if curve.is_few else curve.angle_deg
            curves.append(replace(curve, order=(k, len(drawn)), angle_deg=angle_deg))
            stated.append(f"{part.letter}: {panels.leg_in_numbers(part, found.side, kind, [])}.")
    chart = StrideChart(
        title=panels.title_with_side(shown, kind, found.side, is_about_mean=is_about_mean),
        axis=panels.axis_of(shown, kind, is_about_mean=is_about_mean),
        curves=tuple(curves),
        band=None,
        is_simulated=found.comparison.is_simulated,
        alt=" ".join([tr("SIMULATED.")] * found.comparison.is_simulated + stated),
    )
    return draw(chart, PLOT_WIDTH)
