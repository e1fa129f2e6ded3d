"""What each joint's verdict rests on, beside what it needs; and how large a difference has to be."""

import math
from collections.abc import Callable

import numpy as np

from app.gates_in_words import verdict_word
from app.reports.patient_report.blocks import Block, Cell, Column, Row, heading, note, table
from app.reports.patient_report.facts import KINDS, Facts, joint_of
from app.reports.patient_report.numbers_in_words import DAGGER, NOTHING, dagger_note, fixed, signed, signed_error
from app.reports.patient_report.quality import slipped_straps
from app.wording import capitalised, name_of, tr
from core.body import Joint, Side
from core.calibration.clinical_sign import MIN_MARGIN
from core.results import JointCalibration, ZeroKind
from core.samples import FloatArray
from core.verdicts.gates import LIMITS, MIN_STRIDES_TO_SPLIT
from core.verdicts.measurement_error import ComparisonKind, sigma_of
from core.verdicts.model import GateReason, JointVerdicts
from core.verdicts.quantities import raw_values

MARGIN_BEYOND = 100.0  # how many times better says no more from here on


def evidence(facts: Facts) -> list[Block]:
    """What each verdict rests on, and how large a difference must be."""
    return [*evidence_table(facts), *error_table()]


def evidence_table(facts: Facts) -> list[Block]:
    """A row for each gate, a column for each joint that was measured; what fails its limit is bold."""
    joints = [
        joint
        for kind in KINDS
        for side in Side
        if facts.is_measured(joint := joint_of(kind, side)) and joint in facts.calibrated
    ]
    if not joints:
        return []
    columns = [
        Column(tr("Evidence"), "1fr", is_number=False),
        *(Column(capitalised(name_of(joint))) for joint in joints),
        Column(tr("Needed for “{word}”").format(word=tr("can be read")), "41mm", is_number=False),
    ]
    care, most = LIMITS.axis_sd_deg
    knee, ankle = LIMITS.knee_range_deg, LIMITS.ankle_range_deg
    gates: list[tuple[str, str, Callable[[Joint, JointCalibration], str], str]] = [
        (
            "axis",
            tr("Joint axis, 1 SD"),
            _axis,
            tr("at most {care}°, with care {most}°").format(care=fixed(care, 1), most=fixed(most, 0)),
        ),
        (
            "pairing",
            tr("Sensors are neighbours, margin"),
            _pairing,
            tr("at least {limit}").format(limit=fixed(LIMITS.pairing_margin, 1)),
        ),
        (
            "sign",
            tr("Bent or straight, margin"),
            _sign,
            tr("at least {limit}, or by hand").format(limit=fixed(MIN_MARGIN, 1)),
        ),
        (
            "lag",
            tr("Lag between the sensors"),
            _lag,
            tr("SD at most {limit} ms").format(limit=fixed(LIMITS.lag_sd_ms[0], 0)),
        ),
        (
            "plausible",
            tr("Range in walking, median"),
            lambda joint, _: _degrees(float(np.median(found)) if len(found := _ranges_deg(facts, joint)) else math.nan),
            tr("knee {knee}°, ankle {ankle}°").format(
                knee=f"{knee[0]:.0f}–{knee[1]:.0f}", ankle=f"{ankle[0]:.0f}–{ankle[1]:.0f}"
            ),
        ),
        (
            "halves",
            tr("Range, second half less first"),
            lambda joint, _: _degrees(halves_apart(_ranges_deg(facts, joint)), is_signed=True),
            tr("at most {limit}°").format(limit=fixed(LIMITS.halves_deg, 0)),
        ),
        (
            "drift",
            tr("Range, last third less first"),
            lambda joint, _: _degrees(thirds_apart(_ranges_deg(facts, joint)), is_signed=True),
            tr("at most {limit}°").format(limit=fixed(LIMITS.thirds_deg, 0)),
        ),
        ("strap", tr("Strap"), lambda joint, _: _strap(facts, joint), tr("no slip")),
        ("zero", tr("Zero"), lambda _, found: _zero(found), tr("standing, or goniometer")),
    ]
    rows: list[Row] = [
        [
            label,
            *(
                Cell(said(joint, facts.calibrated[joint]), is_bold=_has_failed(facts.verdicts.joint(joint), gate))
                for joint in joints
            ),
            limit,
        ]
        for gate, label, said, limit in gates
    ]
    for label, part in ((tr("Shape, range"), "shape"), (tr("Height"), "height")):
        words = [verdict_word(getattr(facts.verdicts.joint(joint), part).verdict) for joint in joints]
        rows.append([Cell(label, is_bold=True), *(Cell(word, is_bold=True) for word in words), ""])
    return [heading(tr("What each verdict rests on")), table(columns, rows, is_dense=True)]


def error_table() -> list[Block]:
    """What has to be exceeded at least, by what lies between two means, and what each comparison contains."""
    columns = [
        Column(tr("Comparison"), "42mm", is_number=False),
        Column(tr("What makes it uncertain"), "1fr", is_number=False),
        Column(tr("Knee range, °")),
        Column(tr("Ankle range, °")),
        Column(tr("Stance, % of stride")),
    ]
    told = (
        (ComparisonKind.ATTACHED, tr("Two walks, sensors left on"), tr("strides, drift, clocks; walk to walk")),
        (ComparisonKind.LEGS, tr("Left against right"), tr("the same; each leg's straps, bias of the events")),
        (ComparisonKind.STRAPPINGS, tr("Sensors strapped on anew"), tr("the same; straps")),
        (ComparisonKind.VISITS, tr("Two visits"), tr("the same; straps, another day")),
    )
    rows: list[Row] = []
    for kind, name, contains in told:
        cells = []
        for column in ("knee_range_deg", "ankle_range_deg", "stance_percent"):
            sigma = sigma_of(column, kind)
            cells.append(signed_error(sigma) + (DAGGER if sigma is not None and not sigma.is_verified else ""))
        rows.append([name, contains, *cells])
    said = tr(
        "At least so much, before what chance between strides adds (1.96 standard deviations of the difference). A "
        "sentence on page 1 needs 1.5 times as much where the error is no published upper end."
    )
    return [
        heading(tr("How large a difference must be")),
        table(columns, rows, is_dense=True),
        note(f"{said} {dagger_note()}"),
    ]


def halves_apart(values: FloatArray) -> float:
    """The mean of the second half of some values (k,) less that of the first; NaN of too few."""
    if len(values) < MIN_STRIDES_TO_SPLIT:
        return math.nan
    half = len(values) // 2
    return float(values[-half:].mean() - values[:half].mean())


def thirds_apart(values: FloatArray) -> float:
    """The mean of the last third of some values (k,) less that of the first; NaN of too few."""
    if len(values) < MIN_STRIDES_TO_SPLIT:
        return math.nan
    third = len(values) // 3
    return float(values[-third:].mean() - values[:third].mean())


def _ranges_deg(facts: Facts, joint: Joint) -> FloatArray:
    """Of every stride used, as evidence: whatever may be said of the joint."""
    gait = facts.gait[joint.side]
    found = raw_values(gait, f"{'knee' if joint.is_knee else 'ankle'}_range_deg")[gait.strides.is_used]
    return found[np.isfinite(found)]


def _degrees(value: float, *, is_signed: bool = False) -> str:
    said = signed(value, 1) if is_signed else fixed(value, 1)
    return said if said == NOTHING else f"{said}°"


def _axis(_: Joint, found: JointCalibration) -> str:
    return _degrees(math.nan if found.axis_sd_rad is None else math.degrees(found.axis_sd_rad))


def _pairing(_: Joint, found: JointCalibration) -> str:
    if found.sign_margin is None:
        return NOTHING
    if found.sign_margin > MARGIN_BEYOND:
        return tr("over {most}").format(most=fixed(MARGIN_BEYOND, 0))
    return fixed(found.sign_margin, 2)


def _sign(_: Joint, found: JointCalibration) -> str:
    return NOTHING if found.clinical_sign_margin is None else fixed(found.clinical_sign_margin, 2)


def _lag(_: Joint, found: JointCalibration) -> str:
    if found.is_clock_shared:
        return tr("one clock")
    if found.lag_sd_s is None:
        return tr("not resolvable")
    return f"{fixed(1000 * found.lag_s, 1)} ± {fixed(1000 * found.lag_sd_s, 1)} ms"


def _strap(facts: Facts, joint: Joint) -> str:
    slipped = {joint.proximal, joint.distal}.intersection(slipped_straps(facts))
    return tr("slipped") if slipped else tr("no slip")


def _zero(found: JointCalibration) -> str:
    names = {ZeroKind.STANDING: tr("standing"), ZeroKind.GONIOMETER: tr("goniometer"), ZeroKind.NONE: tr("none")}
    return names[found.zero]


def _has_failed(verdicts: JointVerdicts, gate: str) -> bool:
    reasons: tuple[GateReason, ...] = (*verdicts.shape.reasons, *verdicts.height.reasons, *verdicts.sign.reasons)
    return any(reason.gate == gate for reason in reasons)
