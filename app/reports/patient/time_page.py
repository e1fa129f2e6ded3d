"""Time and distance, the phases of the stride with what the ankle does in each, and every single stride."""

import math
from dataclasses import replace

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.charts.drawing import MM, Picture
from app.charts.on_paper import draw
from app.charts.stride_chart import StrideChart
from app.reports.blocks import Block, Cell, Column, Row, figures, heading, note, table
from app.reports.patient.evidence import evidence
from app.reports.patient.peaks_table import difference_cells
from app.reports.patient.pelvis_table import pelvis_table
from app.reports.patient.phase_bars import phase_bars, phases_of
from app.reports.patient.stride_rails import reasons_in_words, stride_rail
from app.summary import panels
from app.summary.conditions import by_hand_in_words
from app.summary.facts import Facts, joint_of
from app.summary.numbers_in_words import (
    CARE,
    DAGGER,
    NOTHING,
    against_band,
    band_in_figures,
    dagger_note,
    fixed,
    marked,
    sides_against_band,
    spread,
)
from app.summary.plain_text import CONDITION_LENGTH, typed
from app.wording.translation import tr
from app.wording.verdicts import verdict_word
from core.body import JointKind, Side
from core.gait.spatiotemporal import MeanAndSd
from core.verdicts.model import Verdict

PLOT_WIDTH, ALONE_WIDTH = 31 * MM, 66 * MM  # of single strides, below the rails or where there are none
WITH_HIP_WIDTH = 21.5 * MM  # of three joints of each leg
DOUBLE_SUPPORT = "double_support_percent"
REPORTED = ("stride_time_s", "stride_length_m", "step_time_s")  # of these kinds is the table: timing, distance, between
ROCKERS = ("ankle_heel_rocker_deg", "ankle_rocker_deg", "ankle_push_off_deg")


def time_page(facts: Facts) -> list[Block]:
    return [
        heading(tr("Time, distance and strides")),
        *time_distance_table(facts),
        *pelvis_table(facts),
        *_phases(facts),
        *_every_stride(facts),
        *(evidence(facts) if is_evidence_beside_time(facts) else []),
    ]


def is_evidence_beside_time(facts: Facts) -> bool:
    """Whether no stride of any joint may be shown, so that this page has room and its reader asks why."""
    joints = [(side, kind) for side in facts.gait for kind in facts.kinds if facts.is_measured(joint_of(kind, side))]
    return bool(joints) and not any(_has_strides(facts, side, kind) for side, kind in joints)


def time_distance_table(facts: Facts) -> list[Block]:
    one, other = facts.first_and_second
    columns = [
        Column(tr("Measure"), "1fr", is_number=False),
        *(Column(facts.counted(side)) for side in Side),
        Column(f"{one.letter} − {other.letter}"),
        Column(tr("Error")),
        Column(tr("Ref. [2]")),
        Column(tr("Against reference"), "37mm", is_number=False),
    ]
    rows: list[Row] = [
        _both_row(facts, "speed_m_s", tr("Walking speed, m/s")),
        _both_row(facts, "cadence_steps_min", tr("Cadence, steps/min")),
        _side_row(facts, "stride_time_s", tr("Stride time, s"), 2),
        _side_row(facts, "stride_length_m", tr("Stride length, m"), 2),
        _side_row(facts, "stance_percent", tr("Stance (% gait cycle)"), 1),
        _single_support_row(facts),
        _both_row(facts, DOUBLE_SUPPORT, tr("Double support (% gait cycle)")),
        _side_row(facts, "step_time_s", tr("Step time, s"), 2),
        _lift_row(facts),
        _variation_row(facts),
    ]
    group = facts.values_group
    band = (
        tr("Mean ± SD of strides; reference: mean ± SD between people, speed class “{speed_class}”.").format(
            speed_class=speed_class_in_words(group.speed_class)
        )
        if group is not None
        else " ".join([tr("Mean ± SD of strides."), panels.why_no_band(facts, facts.bands.why_no_values)])
    )
    stated = [band]
    if group is not None or facts.curves_group is not None:
        stated.append(tr("Reference groups: see last page."))
    if facts.time_distance[DOUBLE_SUPPORT].unknown_both:
        stated.append(tr("Single and double support need reliable timing of both legs."))
    if len(facts.gait) == len(Side):
        stated.append(tr("Bold: difference between the legs beyond measurement error."))
        stated.append(
            tr("Step time needs synchronised left and right sensors; the distance between the feet is not known.")
        )
    stated.append(tr("Foot clearance is that of the sensor, not of the toes."))
    if any(DAGGER in cell for row in rows for cell in row if isinstance(cell, str)):
        stated.append(dagger_note())
    if any(facts.assessment(side, column).verdict is Verdict.CARE for side in facts.gait for column in REPORTED):
        stated.append(tr("{mark}: caution.").format(mark=CARE))
    return [table(columns, rows, is_dense=True), note(" ".join(stated))]


def _both_row(facts: Facts, column: str, label: str) -> list[Cell | str]:
    figure = facts.time_distance[column]
    value, band = math.nan if figure.both is None else figure.both, figure.band
    is_known = math.isfinite(value) and any(is_mean_enough(facts.strides(side)) for side in facts.gait)
    is_grey = not any(is_spread_enough(facts.strides(side)) for side in facts.gait)
    verdict = Verdict.CARE if figure.with_care else Verdict.READ
    unknown = tr(figure.unknown_both) if figure.unknown_both else tr("not measured")
    shown = marked(fixed(value, figure.decimals), verdict) if is_known else unknown
    words = against_band(value, figure.judged_band) if figure.judged_band is not None and is_known else NOTHING
    in_band = band_in_figures(band, figure.decimals) if band is not None else NOTHING
    return [label, Cell(shown, is_grey=is_grey, span=2, is_centred=True), NOTHING, NOTHING, in_band, words]


def _side_row(facts: Facts, column: str, label: str, decimals: int) -> list[Cell | str]:
    figure = facts.time_distance.get(column)
    band, judged_band = (figure.band, figure.judged_band) if figure is not None else (None, None)
    values = {side: facts.value(side, column) for side in Side}
    cells = [_mean_cell(facts, side, column, value, decimals) for side, value in values.items()]
    in_band = band_in_figures(band, decimals) if band is not None else NOTHING
    judged = {s: v for s, v in values.items() if is_mean_enough(v.n) and s in facts.sides_with_band}
    against = sides_against_band(judged, judged_band)
    return [label, *cells, *difference_cells(facts, column, decimals), in_band, against]


def _mean_cell(facts: Facts, side: Side, column: str, value: MeanAndSd, decimals: int) -> Cell | str:
    if side not in facts.gait:
        return tr("not measured")
    verdict = facts.assessment(side, column).verdict
    if verdict not in (Verdict.READ, Verdict.CARE):
        return verdict_word(verdict)
    return Cell(marked(spread(value, decimals), verdict), is_grey=not is_spread_enough(value.n))


def _single_support_row(facts: Facts) -> list[Cell | str]:
    """Give each leg's single support in % of the swinging leg's stride, if both legs' timing is beyond doubt."""
    is_not_reported = bool(facts.time_distance[DOUBLE_SUPPORT].unknown_both)
    cells: list[Cell | str] = []
    for other in (Side.RIGHT, Side.LEFT):
        value = facts.value(other, "swing_percent")
        is_known = is_mean_enough(value.n) and len(facts.gait) == len(Side) and not is_not_reported
        shown = verdict_word(Verdict.NOT_REPORTED) if is_not_reported else fixed(value.mean, 1) if is_known else NOTHING
        cells.append(Cell(shown, is_grey=not is_spread_enough(value.n)))
    return [tr("Single support (% gait cycle)"), *cells, NOTHING, NOTHING, NOTHING, NOTHING]


def _lift_row(facts: Facts) -> list[Cell | str]:
    cells: list[Cell | str] = []
    for side in Side:
        found = facts.value(side, "clearance_m")
        in_cm = MeanAndSd(100 * found.mean, 100 * found.sd, found.n)
        cells.append(_mean_cell(facts, side, "clearance_m", in_cm, 1))
    return [tr("Foot clearance in swing (sensor), cm"), *cells, NOTHING, NOTHING, NOTHING, NOTHING]


def _variation_row(facts: Facts) -> list[Cell | str]:
    cells: list[Cell | str] = []
    for side in Side:
        value = facts.value(side, "stride_time_s")
        share = 100 * value.sd / value.mean if is_spread_enough(value.n) else math.nan
        cells.append(marked(fixed(share, 1), facts.assessment(side, "stride_time_s").verdict))
    return [tr("Stride time variability (CV), %"), *cells, NOTHING, NOTHING, NOTHING, NOTHING]


def speed_class_in_words(name: str) -> str:
    return {"slow": tr("slow"), "comfortable": tr("comfortable"), "fast": tr("fast")}[name]


def _phases(facts: Facts) -> list[Block]:
    """When the foot meets, lies on and leaves the floor, and how far the ankle turns meanwhile."""
    phases = {side: found for side in facts.gait if (found := phases_of(facts, side)) is not None}
    if not phases:
        return []
    columns = [
        Column(tr("Rocker"), "1fr", is_number=False),
        *(Column(tr("{letter}: duration, %").format(letter=side.letter)) for side in phases),
        *(Column(tr("{letter}: ankle motion, °").format(letter=side.letter)) for side in phases),
    ]
    names = (
        tr("Heel: contact to foot flat"),
        tr("Ankle: foot flat to heel rise"),
        tr("Forefoot: heel rise to toe\u2011off"),
    )
    rows: list[Row] = []
    for number, (name, column) in enumerate(zip(names, ROCKERS, strict=True)):
        lasts = [
            marked(fixed(p.lasts[number], 1), facts.assessment(s, "stance_percent").verdict) for s, p in phases.items()
        ]
        rows.append([name, *lasts, *(_turn(facts, side, column) for side in phases)])
    return [
        heading(tr("Phases and rockers"), level=2),
        figures([phase_bars(phases)]),
        table(columns, rows, is_dense=True),
    ]


def _turn(facts: Facts, side: Side, column: str) -> Cell | str:
    if not facts.is_worn(side, column):
        return NOTHING
    found, verdict = facts.value(side, column), facts.assessment(side, column).verdict
    if verdict is Verdict.NOT_REPORTED:
        return verdict_word(verdict)
    return Cell(marked(spread(found, 1), verdict), is_grey=not is_spread_enough(found.n))


def _every_stride(facts: Facts) -> list[Block]:
    kinds = [kind for kind in facts.kinds if facts.has_joint(kind)]
    reported = [kind for kind in kinds if any(facts.value(side, f"{kind}_range_deg").n for side in facts.gait)]
    rails = [figures([stride_rail(facts, kind)]) for kind in reported]
    if not kinds or is_evidence_beside_time(facts):
        return []
    walk = typed(str(facts.visit.shown_names.get(facts.walk.name, facts.walk.name)), CONDITION_LENGTH)
    stated = [
        tr("Strides of {walk}.").format(walk=walk) if rails and len(facts.part.walks) > 1 else "",
        tr("Strides are in order of time. Lines show the means of the first and second half of the walk."),
        reasons_in_words(facts),
        by_hand_in_words(*facts.part.walks),
    ]
    columns, width = (4, PLOT_WIDTH) if rails else (2, ALONE_WIDTH)
    if rails and JointKind.HIP in kinds:
        columns, width = 6, WITH_HIP_WIDTH
    small = [_strides(facts, side, kind, width) for kind in kinds for side in Side if _has_strides(facts, side, kind)]
    return [
        heading(tr("Every stride"), level=2),
        *([note(" ".join(filter(None, stated)))] if rails else []),
        *rails,
        *([figures(small, columns=columns)] if small else []),
    ]


def _has_strides(facts: Facts, side: Side, kind: str) -> bool:
    return bool(len(facts.strides_deg(side, kind)))


def _strides(facts: Facts, side: Side, kind: str, width: float) -> Picture:
    """Every stride that was used, over one another."""
    own = panels.curve_of(facts, side, kind)
    strides = replace(own, strides_deg=facts.strides_deg(side, kind), is_bare=True)
    chart = StrideChart(
        title=panels.joint_title(facts, side, kind),
        axis=panels.axis_of(facts, kind),
        curves=(strides,),
        band=None,
        is_simulated=facts.is_simulated,
        alt=tr("Single strides.") + " " + panels.curve_alt(facts, kind, [side]),
    )
    return draw(chart, width)
