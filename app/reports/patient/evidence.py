"""What each joint's verdict rests on, beside what it needs; and how large a difference has to be."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeVar

import numpy as np

from app.reports.blocks import Block, Cell, Column, Row, heading, if_room, note, table
from app.summary.facts import Facts, joint_of
from app.summary.numbers_in_words import NOTHING, dagger_note, fixed, least_error_in_words, signed
from app.summary.quality import slipped_straps
from app.wording.body import name_of, side_name
from app.wording.translation import capitalised, tr
from app.wording.verdicts import verdict_alone
from core.body import Joint, JointKind, Side, hip_of
from core.calibration.clinical_sign import MIN_MARGIN
from core.calibration.same_joint import DOUBTFUL_DISAGREEMENT, MAX_DISAGREEMENT
from core.hip.results import ClockStatus, HipIdentification
from core.parameters import ANKLE_RANGE, KNEE_RANGE, STANCE
from core.results import JointCalibration, ZeroKind
from core.samples import FloatArray
from core.verdicts.gates import LIMITS, MIN_STRIDES_TO_SPLIT
from core.verdicts.measurement_error import SENTENCE_FACTORS
from core.verdicts.model import NOT_MEASURED, GateReason
from core.verdicts.quantities import assessment_of, raw_values
from core.verdicts.sigmas import ComparisonKind

JOINT_WIDTH = "23mm"  # takes a verdict; a joint's longer name, as German has them, breaks before its side
MARGIN_BEYOND = 100.0  # from here on, how many times better adds nothing
T = TypeVar("T")
Criterion = tuple[str, str, Callable[[Joint, T], str], str]
"""A gate, its name, what a joint has, what is required."""


def evidence(facts: Facts) -> list[Block]:
    """What each verdict rests on, and how large a difference must be: where strides are compared, with hips if room."""
    hips, errors = hips_table(facts), error_table() if facts.gait else []
    return [*evidence_table(facts), *hips, *([if_room(errors)] if hips and errors else errors)]


def evidence_table(facts: Facts) -> list[Block]:
    """A row for each gate, a column for each joint that was measured; what fails its limit is bold."""
    joints = [
        joint
        for kind in JointKind
        for side in Side
        if facts.is_measured(joint := joint_of(kind, side)) and joint in facts.calibrated
    ]
    if not joints:
        return []
    columns = [
        Column(tr("Criterion"), "1fr", is_number=False),
        *(Column(capitalised(name_of(joint)), JOINT_WIDTH) for joint in joints),
        Column(tr("Required for “{word}”").format(word=tr("good")), "46mm", is_number=False),
    ]
    care, most = LIMITS.axis_sd_deg
    knee, ankle = LIMITS.knee_range_deg, LIMITS.ankle_range_deg
    gates: list[Criterion[JointCalibration]] = [
        (
            "axis",
            tr("Joint axis, ± 1 SD"),
            _axis,
            tr("at most {care}°, caution up to {most}°").format(care=fixed(care, 1), most=fixed(most, 0)),
        ),
        *_axis_of_parts(facts),
        (
            "pairing",
            tr("Adjacent segments, clarity"),
            _pairing,
            tr("at least {limit}").format(limit=fixed(LIMITS.pairing_margin, 1)),
        ),
        (
            "disagreement",
            tr("Sensor disagreement at joint"),
            lambda _, found: NOTHING if found.disagreement is None else fixed(found.disagreement, 2),
            tr("under {limit} to {most}, by clarity").format(
                limit=fixed(DOUBTFUL_DISAGREEMENT, 2), most=fixed(MAX_DISAGREEMENT, 2)
            ),
        ),
        (
            "sign",
            tr("Flexion or extension, clarity"),
            _sign,
            tr("at least {limit}, or by hand").format(limit=fixed(MIN_MARGIN, 1)),
        ),
        (
            "lag",
            tr("Clock lag between sensors"),
            _lag,
            tr("SD at most {limit} ms").format(limit=fixed(LIMITS.lag_sd_ms[0], 0)),
        ),
        (
            "plausible",
            tr("ROM in walking, median"),
            lambda joint, _: _median(facts, joint),
            tr("knee {knee}°, ankle {ankle}°").format(
                knee=f"{knee[0]:.0f}–{knee[1]:.0f}", ankle=f"{ankle[0]:.0f}–{ankle[1]:.0f}"
            ),
        ),
        (
            "halves",
            tr("ROM, second half of walk minus first"),
            lambda joint, _: _farthest(2, facts, joint),
            tr("at most {limit}°").format(limit=fixed(LIMITS.halves_deg, 0)),
        ),
        (
            "drift",
            tr("ROM, last third minus first"),
            lambda joint, _: _farthest(3, facts, joint),
            tr("at most {limit}°").format(limit=fixed(LIMITS.thirds_deg, 0)),
        ),
        ("strap", tr("Strap"), lambda joint, _: _strap(facts, joint), tr("not moved")),
        ("zero", tr("Standing reference"), lambda _, found: _zero(found), tr("posture, or goniometer")),
    ]
    rows = _rows(facts, gates, {joint: facts.calibrated[joint] for joint in joints})
    return [heading(tr("Basis of each rating")), table(columns, rows, is_dense=True)]


def hips_table(facts: Facts) -> list[Block]:
    """The same of the hips, which have no axis, and what ties the clocks of both legs; nothing without a pelvis."""
    hips = {joint: facts.walk.hips[joint] for side in Side if (joint := hip_of(side)) in facts.walk.hips}
    if not hips:
        return []
    columns = [
        Column(tr("Criterion, hips"), "1fr", is_number=False),
        *(Column(capitalised(name_of(joint))) for joint in hips),
        Column(tr("Required for “{word}”").format(word=tr("good")), "58mm", is_number=False),
    ]
    centre, apart, of_range = LIMITS.hip_centre_m, LIMITS.hips_apart_m, LIMITS.hip_range_deg
    gates: list[Criterion[HipIdentification]] = [
        (
            "pairing",
            tr("Adjacent segments, clarity"),
            lambda _, found: _margin(found.margin),
            tr("at least {limit}").format(limit=fixed(LIMITS.pairing_margin, 1)),
        ),
        (
            "hip_disagreement",
            tr("Pelvis–thigh disagreement"),
            lambda _, found: fixed(found.disagreement, 2),
            tr("under {limit}").format(limit=fixed(LIMITS.hip_disagreement, 1)),
        ),
        (
            "hip_centre",
            tr("Hip centre to pelvis and thigh sensor"),
            lambda _, found: _cm(found.centre_proximal_m) + ", " + _cm(found.centre_distal_m),
            tr("{least} to {most} cm").format(least=fixed(100 * centre[0], 0), most=fixed(100 * centre[1], 0)),
        ),
        (
            "hips_apart",
            tr("Hip centres apart, left from right"),
            lambda _, found: (
                NOTHING if found.centres_apart_m is None else f"{fixed(100 * found.centres_apart_m, 0)} cm"
            ),
            tr("{least} to {most} cm").format(least=fixed(100 * apart[0], 0), most=fixed(100 * apart[1], 0)),
        ),
        (
            "hip_heading",
            tr("Pelvis–thigh heading, ± 1 SD"),
            lambda _, found: _degrees(math.degrees(found.heading_sd_rad)),
            tr("at most {limit}°, for abduction only").format(limit=fixed(LIMITS.hip_heading_sd_deg, 0)),
        ),
        (
            "plausible",
            tr("ROM in walking, median"),
            lambda joint, _: _median(facts, joint),
            f"{of_range[0]:.0f}–{of_range[1]:.0f}°",
        ),
        (
            "halves",
            tr("ROM, second half of walk minus first"),
            lambda joint, _: _farthest(2, facts, joint),
            tr("at most {limit}°").format(limit=fixed(LIMITS.halves_deg, 0)),
        ),
    ]
    rows = _rows(facts, gates, {joint: hip.identification for joint, hip in hips.items()})
    stated = facts.verdicts
    verdicts = [
        (tr("ROM, shape"), [stated.joint(joint).shape for joint in hips]),
        (tr("Absolute angle"), [stated.joint(joint).height for joint in hips]),
        (tr("Abduction"), [assessment_of(stated, joint.side, "hip_abduction_peak_deg") for joint in hips]),
    ]
    for label, found in verdicts:
        words = [Cell(verdict_alone(one.verdict), is_bold=True) for one in found]
        rows.append([Cell(label, is_bold=True), *words, ""])
    clocks = clocks_in_words(facts)
    return [table(columns, rows, is_dense=True), *([note(clocks)] if clocks else [])]


def clocks_in_words(facts: Facts) -> str:
    """How the clocks of both legs are tied, and by how much they are apart where the hips show it."""
    clock = facts.walk.leg_clock
    if clock is None:
        return ""
    if clock.status is ClockStatus.PROVEN:
        return tr("Left and right sensors: synchronisation confirmed.")
    if clock.status is ClockStatus.NOT_REPORTED:
        return tr("Left and right sensors: their time offset cannot be found from hip movement.")
    side = Side.RIGHT if clock.offset_s > 0 else Side.LEFT
    pattern = (
        tr(
            "Left and right sensors: time offset found from hip movement. The {side} leg was {late} ± "
            "{sd} ms late (1 SD). This was corrected."
        )
        if clock.applied_s
        else tr(
            "Left and right sensors: time offset found from hip movement. The {side} leg was {late} ± "
            "{sd} ms late (1 SD)."
        )
    )
    late, sd = fixed(1000 * abs(clock.offset_s), 0), fixed(1000 * clock.sd_s, 0)
    return pattern.format(side=side_name(side), late=late, sd=sd)


def error_table() -> list[Block]:
    """What has to be exceeded at least, by what lies between two means, and what each comparison contains."""
    columns = [
        Column(tr("Comparison"), "46mm", is_number=False),
        Column(tr("Sources of error"), "1fr", is_number=False),
        Column(tr("Knee ROM, °")),
        Column(tr("Ankle ROM, °")),
        Column(tr("Stance (% gait cycle)"), "31mm"),
    ]
    reported = (
        (
            ComparisonKind.ATTACHED,
            tr("Two walks, sensors left in place"),
            tr("strides, walks, drift, synchronisation"),
        ),
        (ComparisonKind.LEGS, tr("Left vs right"), tr("the same; attachment, event bias")),
        (ComparisonKind.STRAPPINGS, tr("Sensors reattached"), tr("the same; attachment")),
        (ComparisonKind.VISITS, tr("Two visits"), tr("the same; attachment, another day")),
    )
    rows: list[Row] = []
    for kind, name, contains in reported:
        least = (least_error_in_words(column, kind) for column in (KNEE_RANGE, ANKLE_RANGE, STANCE))
        rows.append([name, contains, *least])
    stated = tr(
        "Least values at usual means; variation between strides is added. Page 1: changes need {visits} times as much "
        "between visits, {reattached} after reattaching in a session, {left_on} with sensors left in place, with a "
        "goal as much; legs more than 95 of 100 healthy people differ by."
    ).format(
        visits=fixed(SENTENCE_FACTORS[ComparisonKind.VISITS], 2),
        reattached=fixed(SENTENCE_FACTORS[ComparisonKind.STRAPPINGS], 1),
        left_on=fixed(SENTENCE_FACTORS[ComparisonKind.ATTACHED], 2),
    )
    return [
        heading(tr("Measurement error by type of comparison")),
        table(columns, rows, is_dense=True),
        note(f"{stated} {dagger_note()}"),
    ]


def _parts_apart(values: FloatArray, parts: int) -> float:
    """The mean of the last of so many parts of some values (k,) less that of the first; NaN of too few."""
    if len(values) < MIN_STRIDES_TO_SPLIT:
        return math.nan
    each = len(values) // parts
    return float(values[-each:].mean() - values[:each].mean())


def _ranges_of_walks(facts: Facts, joint: Joint) -> list[FloatArray]:
    """For every stride used of each walk, as evidence, regardless of what may be reported about the joint."""
    gaits = [walk.gait[joint.side] for walk in facts.part.walks if joint.side in walk.gait]
    found = [raw_values(gait, f"{joint.kind}_range_deg")[gait.strides.is_used] for gait in gaits]
    return [one[np.isfinite(one)] for one in found]


def _median(facts: Facts, joint: Joint) -> str:
    found = np.concatenate([np.empty(0), *_ranges_of_walks(facts, joint)])
    return _degrees(float(np.median(found)) if len(found) else math.nan)


def _farthest(parts: int, facts: Facts, joint: Joint) -> str:
    """Of the walk in which the first and the last part lie farthest apart: each walk has to pass by itself."""
    found = [value for one in _ranges_of_walks(facts, joint) if math.isfinite(value := _parts_apart(one, parts))]
    return _degrees(max(found, key=abs, default=math.nan), is_signed=True)


def _degrees(value: float, *, is_signed: bool = False) -> str:
    stated = signed(value, 1) if is_signed else fixed(value, 1)
    return stated if stated == NOTHING else f"{stated}°"


def _axis(_: Joint, found: JointCalibration) -> str:
    return _degrees(math.nan if found.axis_sd_rad is None else math.degrees(found.axis_sd_rad))


def _axis_of_parts(facts: Facts) -> list[Criterion[JointCalibration]]:
    """How far the axes of two parts of the data are apart, a criterion for each way they were parted."""
    found = facts.walk.axis_halves
    ways = (
        ("axis_halves", tr("Joint axis, halves of the walk"), False, LIMITS.axis_halves_deg),
        ("axis_motions", tr("Joint axis, free motion and walk"), True, LIMITS.axis_motions_deg),
    )
    criteria: list[Criterion[JointCalibration]] = []
    for gate, label, is_free_motion, (care, most) in ways:
        apart = {joint: one.apart_rad for joint, one in found.items() if one.is_free_motion is is_free_motion}
        if apart:
            required = tr("at most {care}°, caution up to {most}°").format(care=fixed(care, 0), most=fixed(most, 0))
            criteria.append((gate, label, partial(_apart, apart), required))
    return criteria


def _apart(apart_rad: Mapping[Joint, float], joint: Joint, _: JointCalibration) -> str:
    return _degrees(math.degrees(apart_rad.get(joint, math.nan)))


def _pairing(_: Joint, found: JointCalibration) -> str:
    return NOTHING if found.sign_margin is None else _margin(found.sign_margin)


def _margin(margin: float) -> str:
    if margin > MARGIN_BEYOND:
        return tr("over {most}").format(most=fixed(MARGIN_BEYOND, 0))
    return fixed(margin, 2)


def _cm(centre_m: FloatArray) -> str:
    return f"{fixed(100 * float(np.linalg.norm(centre_m)), 0)} cm"


def _sign(_: Joint, found: JointCalibration) -> str:
    return NOTHING if found.clinical_sign_margin is None else fixed(found.clinical_sign_margin, 2)


def _lag(_: Joint, found: JointCalibration) -> str:
    if found.is_clock_shared:
        return tr("same clock")
    if found.lag_sd_s is None:
        return tr("not determinable")
    return f"{fixed(1000 * found.lag_s, 1)} ± {fixed(1000 * found.lag_sd_s, 1)} ms"


def _strap(facts: Facts, joint: Joint) -> str:
    slipped = {joint.proximal, joint.distal}.intersection(slipped_straps(facts))
    return tr("moved") if slipped else tr("not moved")


def _zero(found: JointCalibration) -> str:
    names = {ZeroKind.STANDING: tr("posture"), ZeroKind.GONIOMETER: tr("goniometer"), ZeroKind.NONE: tr("none")}
    return names[found.zero]


def _has_failed(facts: Facts, joint: Joint, gate: str) -> bool:
    """Also a hip's heading, which takes its abduction alone away."""
    is_heading = gate == "hip_heading" and not facts.verdicts.abduction.get(joint.side, NOT_MEASURED).is_reported
    found = facts.verdicts.joint(joint)
    reasons: tuple[GateReason, ...] = (*found.shape.reasons, *found.height.reasons, *found.sign.reasons)
    return is_heading or any(reason.gate == gate for reason in reasons)


def _rows(facts: Facts, gates: Sequence[Criterion[T]], found: Mapping[Joint, T]) -> list[Row]:
    """A row for each criterion; what fails it is bold."""
    rows: list[Row] = []
    for gate, label, stated, limit in gates:
        cells = [Cell(stated(joint, one), is_bold=_has_failed(facts, joint, gate)) for joint, one in found.items()]
        rows.append([label, *cells, limit])
    return rows
