"""The page that stands alone: who, how good the recording is, time and distance."""

import math

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.gates_in_words import verdict_word
from app.reports.comparison import Comparison
from app.reports.patient_report.blocks import Block, Cell, Column, Row, heading, note, table
from app.reports.patient_report.dates import moment
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.numbers_in_words import (
    CARE,
    NOTHING,
    Band,
    against_band,
    band_in_figures,
    fixed,
    marked,
    sides_against_band,
    signed,
    spread,
)
from app.reports.patient_report.plain_text import CONDITION_LENGTH, typed
from app.reports.patient_report.request import ReportRequest
from app.reports.reference_bands import WHY_NO_BAND
from app.wording import capitalised, joined, name_of, side_name, tr, tr_n
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.norms import NoBand
from core.verdicts.model import Verdict

NOT_STATED = ("", "none")
TOLD = ("stride_time_s", "stride_length_m")  # of these two kinds is the table, timing and distance


def fields(request: ReportRequest, facts: Facts) -> list[tuple[str, str]]:
    """What the clinic typed or the program knows, as label and value; what nobody stated is left out."""
    session, patient = request.visit.session, request.visit.session.patient
    is_prosthetic = patient.prosthetic_side not in NOT_STATED
    side = patient.prosthetic_side if is_prosthetic else patient.affected_side
    height = f"{fixed(patient.height_m, 2)} m" if patient.height_m is not None else ""
    mass = f"{fixed(patient.mass_kg, 0)} kg" if patient.mass_kg is not None else ""
    aids = tr("no aids") if patient.aids == "none" else patient.aids
    born = str(patient.birth_year) if patient.birth_year is not None else ""
    condition = request.visit.recording(facts.walk.name).condition or facts.walk.name
    known = [
        (tr("Patient code"), typed(patient.code)),
        (tr("Birth year, sex"), typed(", ".join(filter(None, [born, _sex(patient.sex)])))),
        (tr("Height, mass"), typed(", ".join(filter(None, [height, mass])))),
        (tr("Prosthetic side") if is_prosthetic else tr("Affected side"), _side_in_words(side)),
        (
            tr("Device, aids"),
            typed(", ".join(filter(None, [patient.device, aids]))),
        ),
        (tr("Surface"), typed(session.surface)),
        (tr("Condition shown"), typed(condition)),
        (tr("Recorded"), moment(request.visit.recording(facts.walk.name).started or session.started)),
        (tr("Operator"), typed(request.operator or session.operator)),
        (tr("Clinic"), typed(request.clinic)),
        (tr("Software"), typed(f"Gaitwright {request.software_version}")),
        (tr("Sensors"), _sensors(request, facts)),
    ]
    return [(label, value) for label, value in known if value != tr("not stated")]


def measured(facts: Facts, comparison: Comparison | None) -> str:
    """What this report is of, in a sentence: joints and legs, and what is compared with what."""
    worn = facts.visit.recording(facts.walk.name).imu
    joints = {side: [kind for kind in KINDS if facts.is_measured(joint_of(kind, side))] for side in facts.gait}
    names = {"knee": tr("knee"), "ankle": tr("ankle")}
    legs = (
        tr("both legs") if len(joints) > 1 else "".join(tr("the {side} leg").format(side=side_name(s)) for s in joints)
    )
    known = [name_of(joint_of(kind, side)) for side, kinds in joints.items() for kind in kinds]
    if not known:
        what = tr("steps")
    elif len({tuple(kinds) for kinds in joints.values()}) == 1:
        kinds = next(iter(joints.values()))
        what = tr("{joints} of {legs}").format(joints=joined([names[kind] for kind in kinds]), legs=legs)
    else:
        what = joined(known)
    sensors = tr_n("{count} motion sensor", "{count} motion sensors", len(worn)).format(count=len(worn))
    said = [tr("Measured in walking: {what}, with {sensors}.").format(what=what, sensors=sensors)]
    if comparison is not None:
        # a mark of direction ends each name: with a space behind it, no glyph that is used elsewhere carries it along
        parts = " · ".join(f"{part.letter}\u00a0{typed(part.name, CONDITION_LENGTH)}" for part in comparison.parts)
        compared = tr("Compared, {last} shown on this page: {parts}")
        said.append(compared.format(parts=parts, last=comparison.parts[-1].letter))
    return " ".join(said)


def time_distance_table(facts: Facts) -> list[Block]:
    one, other = facts.first_and_second
    columns = [
        Column(tr("Measure"), "1fr", is_number=False),
        *(Column(facts.counted(side)) for side in Side),
        Column(tr("Band [2]")),
        Column(tr("Against the band"), "37mm", is_number=False),
        Column(tr("Symmetry") + f"\n{one[0].upper()} − {other[0].upper()}"),
    ]
    rows: list[Row] = [
        _both_row(facts, tr("Walking speed"), tr("Walking speed, m/s")),
        _both_row(facts, tr("Cadence"), tr("Cadence, steps/min")),
        _side_row(facts, "stride_time_s", tr("Stride time, s"), 2, None),
        _side_row(facts, "stride_length_m", tr("Stride length, m"), 2, facts.time_distance[tr("Stride length")].band),
        _side_row(facts, "stance_percent", tr("Stance, % of stride"), 1, facts.time_distance[tr("Stance")].band),
        _side_row(facts, "swing_percent", tr("Swing, % of stride"), 1, _swing_band(facts)),
        _single_support_row(facts),
        _both_row(facts, tr("Double support"), tr("Double support, % of stride")),
        _variation_row(facts),
    ]
    symmetry = tr("Symmetry = ({one} − {other}) / mean of both × 100 %; 0 is symmetric.").format(
        one=one[0].upper(), other=other[0].upper()
    )
    group = facts.values_group
    band = (
        tr("Mean ± SD over strides; band: mean ± SD between people, class “{speed_class}” of speed.").format(
            speed_class=_speed_class(group.speed_class)
        )
        if group is not None
        else " ".join([tr("Mean ± SD over strides."), why_no_band(facts, facts.bands.why_no_values)])
    )
    swing = [tr("Swing band = 100 − stance band.")] if group is not None else []
    said = [band, symmetry, *swing] if len(facts.gait) == len(Side) else [band, *swing]
    if group is not None or facts.curves_group is not None:
        said.append(tr("Whose bands these are: last page."))
    if facts.time_distance[tr("Double support")].unknown_both:
        said.append(tr("Single and double support need both legs' timing beyond doubt."))
    if any(facts.assessment(side, column).verdict is Verdict.CARE for side in facts.gait for column in TOLD):
        said.append(tr("{mark}: read with care.").format(mark=CARE))
    return [heading(tr("Time and distance")), table(columns, rows), note(" ".join(said))]


def why_no_band(facts: Facts, why: NoBand | None) -> str:
    """Why no band stands beside this walk; empty where one does."""
    if facts.gait and not facts.sides_with_band:
        return tr("No band: a prosthetic leg is not compared with other people's.")
    return tr(WHY_NO_BAND[why]) if why is not None else ""


def _both_row(facts: Facts, name: str, label: str) -> list[Cell | str]:
    figure = facts.time_distance[name]
    value, band = math.nan if figure.both is None else figure.both, figure.band
    is_known = math.isfinite(value) and any(is_mean_enough(facts.strides(side)) for side in facts.gait)
    is_grey = not any(is_spread_enough(facts.strides(side)) for side in facts.gait)
    verdict = Verdict.CARE if figure.with_care else Verdict.READ
    unknown = tr(figure.unknown_both) if figure.unknown_both else tr("not measured")
    shown = marked(fixed(value, figure.decimals), verdict) if is_known else unknown
    words = against_band(value, band) if band is not None and is_known else NOTHING
    in_band = band_in_figures(band, figure.decimals) if band is not None else NOTHING
    return [label, Cell(shown, is_grey=is_grey, span=2, is_centred=True), in_band, words, NOTHING]


def _side_row(facts: Facts, column: str, label: str, decimals: int, band: Band | None) -> list[Cell | str]:
    values = {side: facts.value(side, column) for side in Side}
    cells = [_mean_cell(facts, side, column, value, decimals) for side, value in values.items()]
    in_band = band_in_figures(band, decimals) if band is not None else NOTHING
    judged = {s: v for s, v in values.items() if is_mean_enough(v.n) and s in facts.sides_with_band}
    return [label, *cells, in_band, sides_against_band(judged, band), symmetry_in_words(facts, column)]


def _mean_cell(facts: Facts, side: Side, column: str, value: MeanAndSd, decimals: int) -> Cell | str:
    if side not in facts.gait:
        return tr("not measured")
    verdict = facts.assessment(side, column).verdict
    if verdict not in (Verdict.READ, Verdict.CARE):
        return verdict_word(verdict)
    return Cell(marked(spread(value, decimals), verdict), is_grey=not is_spread_enough(value.n))


def symmetry_in_words(facts: Facts, column: str) -> str:
    """Give the symmetry of both legs as summary.json has it; a dash where there is none, or a toe-off is biased."""
    if column in ("stance_percent", "swing_percent") and any(map(facts.alone.is_toe_off_biased, facts.gait)):
        return NOTHING
    index = (facts.summary["both"].get("symmetry_index_percent") or {}).get(column)
    if index is None or not all(is_mean_enough(facts.strides(side)) for side in Side):
        return NOTHING
    return f"{signed(index, 1)} %"


def _swing_band(facts: Facts) -> Band | None:
    band = facts.time_distance[tr("Stance")].band
    return None if band is None else (100 - band[1], 100 - band[0])


def _single_support_row(facts: Facts) -> list[Cell | str]:
    """A leg stands alone while the other swings; each in % of the swinging leg's stride.

    As with double support, both legs' timing has to be beyond doubt.
    """
    is_withheld = bool(facts.time_distance[tr("Double support")].unknown_both)
    cells: list[Cell | str] = []
    for other in (Side.RIGHT, Side.LEFT):
        value = facts.value(other, "swing_percent")
        is_known = is_mean_enough(value.n) and len(facts.gait) == len(Side) and not is_withheld
        shown = verdict_word(Verdict.WITHHELD) if is_withheld else fixed(value.mean, 1) if is_known else NOTHING
        cells.append(Cell(shown, is_grey=not is_spread_enough(value.n)))
    return [tr("Single support, % of stride"), *cells, NOTHING, NOTHING, NOTHING]


def _variation_row(facts: Facts) -> list[Cell | str]:
    cells: list[Cell | str] = []
    for side in Side:
        value = facts.value(side, "stride_time_s")
        share = 100 * value.sd / value.mean if is_spread_enough(value.n) else math.nan
        cells.append(marked(fixed(share, 1), facts.assessment(side, "stride_time_s").verdict))
    return [tr("Variation of stride time (CV), %"), *cells, NOTHING, NOTHING, NOTHING]


def _sensors(request: ReportRequest, facts: Facts) -> str:
    worn = request.visit.recording(facts.walk.name).imu
    rates = {info.rate_hz for site, info in request.visit.session.sensors.items() if site in worn and info.rate_hz}
    models = {info.model for site, info in request.visit.session.sensors.items() if site in worn and info.model}
    count = tr_n("{count} sensor", "{count} sensors", len(worn)).format(count=len(worn))
    rate = [f"{rates.pop():g}\u00a0Hz"] if len(rates) == 1 else []
    return ", ".join([count, *rate, *sorted(typed(model, 40) for model in models)])


def _side_in_words(side: str) -> str:
    known = {
        Side.LEFT.value: capitalised(side_name(Side.LEFT)),
        Side.RIGHT.value: capitalised(side_name(Side.RIGHT)),
        "both": tr("Both"),
        "none": tr("None"),
    }
    return known.get(side, tr("not stated"))


def _sex(sex: str) -> str:
    return {"male": tr("male"), "female": tr("female")}.get(sex, sex)


def _speed_class(name: str) -> str:
    return {"slow": tr("slow"), "comfortable": tr("comfortable"), "fast": tr("fast")}[name]
