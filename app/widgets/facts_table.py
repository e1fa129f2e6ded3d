"""Table of how each joint was found and how sure that is: one column per joint, one row per question."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from app.theme.icons import Icon
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import RIGHT, TextCell
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD
from app.wording.body import joint_name, name_of
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, later, tr
from core.body import Joint
from core.hip.results import HipAngle, HipIdentification
from core.results import AxisSource, JointCalibration, ZeroKind
from core.verdicts.gates import LIMITS

MARGIN_REQUIRED = 1.3  # the same as in the findings: below it another answer fits almost as well
SHORTEST_LAG_S = 0.0005

AXIS_FROM = {
    AxisSource.FREE_MOTION: later("free motion"),
    AxisSource.WALKING: later("walking"),
    AxisSource.POOLED: later("free motion, walking"),
    AxisSource.HINGE: later("true hinge"),
    AxisSource.REFINED: later("rigid limb"),
}
JOINTS = (Joint.LEFT_KNEE, Joint.RIGHT_KNEE, Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE)
HIPS = (Joint.LEFT_HIP, Joint.RIGHT_HIP)


@dataclass(frozen=True, slots=True)
class Fact:
    """What is known in answer to one question; `needs_look` marks it by a triangle and bold letters."""

    text: str
    needs_look: bool = False


def fact_columns(found: Mapping[Joint, JointCalibration]) -> list[TableColumn]:
    """The questions, then chip and joint above each column, so that none can be mistaken for the other leg's."""
    return [TableColumn(), *(TableColumn(_joint_head(joint), share=1) for joint in JOINTS if joint in found)]


def fact_rows(found: Mapping[Joint, JointCalibration]) -> list[TableRow]:
    """Every question, and what is known of each joint."""
    if not found:
        return []
    return [
        TableRow(
            (
                TextCell(tr(question), tone="ink2"),
                *(_cell(show_message(found[joint]), tr(question), joint) for joint in JOINTS if joint in found),
            ),
            hint=tr(hint).format(required=MARGIN_REQUIRED),
        )
        for question, hint, show_message in QUESTIONS
    ]


def hip_columns(found: Mapping[Joint, HipAngle]) -> list[TableColumn]:
    """As `fact_columns`, of the hips."""
    return [TableColumn(), *(TableColumn(_joint_head(joint), share=1) for joint in HIPS if joint in found)]


def hip_rows(found: Mapping[Joint, HipAngle]) -> list[TableRow]:
    """As `fact_rows`, of the hips, which have no axis."""
    return [
        TableRow(
            (
                TextCell(tr(question), tone="ink2"),
                *(
                    _cell(show_message(found[joint].identification), tr(question), joint)
                    for joint in HIPS
                    if joint in found
                ),
            ),
            hint=tr(hint).format(required=LIMITS.pairing_margin),
        )
        for question, hint, show_message in HIP_QUESTIONS
        if found
    ]


def _joint_head(joint: Joint) -> TextCell:
    return TextCell(joint_name(joint), align=RIGHT, weight=MEDIUM, side=joint.side, spoken=name_of(joint))


def _cell(fact: Fact, question: str, joint: Joint) -> TextCell:
    """One line per comma."""
    stated = f"{name_of(joint)}, {question}: {fact.text}"
    return TextCell(
        fact.text.replace(", ", ",\n"),
        align=RIGHT,
        weight=SEMIBOLD if fact.needs_look else REGULAR,
        mark=Icon.WARNING if fact.needs_look else None,
        spoken=tr("{cell}, needs checking").format(cell=stated) if fact.needs_look else stated,
    )


def _axis_from(found: JointCalibration) -> Fact:
    return Fact(tr(AXIS_FROM[found.axis_source]), found.axis_source is AxisSource.WALKING)


def _axis_certainty(found: JointCalibration) -> Fact:
    if found.axis_sd_rad is None or not math.isfinite(found.axis_sd_rad):
        return Fact(tr("unknown"), needs_look=True)
    return Fact(f"± {figure_text(math.degrees(found.axis_sd_rad), '.1f')}°")


def _margin(found: JointCalibration) -> Fact:
    return Fact(tr("unknown"), needs_look=True) if found.sign_margin is None else _margin_of(found.sign_margin)


def _margin_of(margin: float, required: float = MARGIN_REQUIRED) -> Fact:
    if not math.isfinite(margin) or margin >= 100:
        return Fact(tr("over 100"))
    return Fact(figure_text(margin, ".1f"), margin < required)


def _direction(found: JointCalibration) -> Fact:
    return Fact(tr("certain")) if found.is_sign_certain else Fact(tr("uncertain"), needs_look=True)


def _lag(found: JointCalibration | HipIdentification) -> Fact:
    if abs(found.lag_s) < SHORTEST_LAG_S:
        return Fact(tr("none"))
    return Fact(f"{found.lag_s * 1000:+.0f} ms".replace("-", MINUS))


def _zero(found: JointCalibration) -> Fact:
    match found.zero:
        case ZeroKind.STANDING:
            return Fact(tr("posture"))
        case ZeroKind.GONIOMETER:
            return Fact(tr("goniometer, {angle}").format(angle=_degrees(found.offset_rad)))
        case _:
            return Fact(tr("none"), needs_look=True)


def _degrees(angle_rad: float) -> str:
    return f"{figure_text(math.degrees(angle_rad), '.1f')}°".replace("-", MINUS)


def _heading(found: HipIdentification) -> Fact:
    return Fact(f"± {figure_text(math.degrees(found.heading_sd_rad), '.1f')}°", not found.is_3d)


def _disagreement(found: HipIdentification) -> Fact:
    return Fact(figure_text(found.disagreement, ".2f"), found.disagreement >= LIMITS.hip_disagreement)


def _centre(found: HipIdentification) -> Fact:
    lengths = [float(np.linalg.norm(one)) for one in (found.centre_proximal_m, found.centre_distal_m)]
    least, most = LIMITS.hip_centre_m
    words = tr("pelvis {pelvis} cm, thigh {thigh} cm").format(
        pelvis=round(100 * lengths[0]), thigh=round(100 * lengths[1])
    )
    return Fact(words, any(not least <= length <= most for length in lengths))


def _apart(found: HipIdentification) -> Fact:
    if found.centres_apart_m is None:
        return Fact(tr("one hip only"))
    least, most = LIMITS.hips_apart_m
    return Fact(
        tr("{apart} cm").format(apart=round(100 * found.centres_apart_m)), not least <= found.centres_apart_m <= most
    )


HIP_QUESTIONS: tuple[tuple[str, str, Callable[[HipIdentification], Fact]], ...] = (
    (
        later("Heading uncertainty"),
        later("One standard deviation of the direction that the pelvis faces, relative to the thigh."),
        _heading,
    ),
    (
        later("Clarity"),
        later("How many times worse the next best solution fits. Below {required}, the result is uncertain."),
        lambda found: _margin_of(found.margin, LIMITS.pairing_margin),
    ),
    (later("Disagreement"), later("Share of the hip acceleration on which the two sensors disagree."), _disagreement),
    (later("Hip centre to sensors"), later("Distance from the hip centre to the pelvis and thigh sensors."), _centre),
    (later("Hip spacing"), later("How far the left hip centre lies to the left of the right one."), _apart),
    (later("Clock lag"), later("Time added to the clock of the distal sensor."), _lag),
    (later("Standing reference"), later("Posture taken as zero."), lambda _: Fact(tr("posture"))),
)
QUESTIONS: tuple[tuple[str, str, Callable[[JointCalibration], Fact]], ...] = (
    (later("Axis from"), later("Recording used to determine the joint axis."), _axis_from),
    (later("Calibration uncertainty"), later("One standard deviation of the joint axis direction."), _axis_certainty),
    (
        later("Clarity"),
        later("How many times worse the next best solution fits. Below {required}, the result is uncertain."),
        _margin,
    ),
    (later("Direction"), later("Whether flexion and extension can be distinguished."), _direction),
    (later("Clock lag"), later("Time added to the clock of the distal sensor."), _lag),
    (later("Standing reference"), later("Posture taken as zero, or the goniometer value in standing."), _zero),
)
