"""Common parts of all curves of the report. Axes, the colours of legs and conditions, swatches, words for them."""

import math
from collections.abc import Sequence

import numpy as np

from app.charts.axes import title_in_words
from app.charts.cycles import Band, is_mean_enough, is_spread_enough
from app.charts.drawing import DASHES, Drawing, Picture
from app.charts.stride_chart import NO_STRIDES, Axis, StrideCurve, usual_range_deg
from app.summary import quality
from app.summary.conditions import Part
from app.summary.facts import KINDS, Facts, joint_of
from app.summary.numbers_in_words import fixed
from app.summary.reference_bands import OTHER_AGES, WHY_NO_BAND
from app.theme.colours import PAPER
from app.wording.body import name_of, side_name
from app.wording.translation import capitalised, joined, tr, within_sentence
from core.body import Joint, JointKind, Side
from core.verdicts.model import Verdict
from core.verdicts.norms import NoBand

HEIGHTS = {
    "knee": (
        "knee_at_initial_contact_deg",
        "knee_loading_peak_deg",
        "knee_stance_minimum_deg",
        "knee_swing_peak_deg",
    ),
    "hip": (
        "hip_flexion_peak_deg",
        "hip_extension_peak_deg",
        "hip_abduction_peak_deg",
        "hip_adduction_peak_deg",
    ),
    "ankle": (
        "ankle_at_initial_contact_deg",
        "ankle_loading_plantarflexion_deg",
        "ankle_stance_dorsiflexion_deg",
        "ankle_push_off_plantarflexion_deg",
        "ankle_swing_dorsiflexion_deg",
    ),
}
SWATCH_WIDTH, SWATCH_HEIGHT = 30.0, 9.0
DOT = 6.4
PEAK_COLUMNS = {
    "knee": ("knee_loading_peak_deg", "knee_swing_peak_deg"),
    "ankle": ("ankle_stance_dorsiflexion_deg", "ankle_push_off_plantarflexion_deg"),
    "hip": (),  # its peaks are those of the whole stride
}


def axis_of(facts: Facts, kind: str, *, is_about_mean: bool = False) -> Axis:
    """The same in every report; without a zero, about the mean of the stride."""
    low, high = usual_range_deg(JointKind(kind), is_about_mean=is_about_mean or facts.has_no_zero(kind))
    if kind == JointKind.ANKLE:
        return Axis(low, high, 10, 10, tr("toes up"), tr("toes down"))
    return Axis(low, high, 20, 10, tr("flexed"), tr("extended"))


def title_of(facts: Facts, kind: str) -> str:
    if facts.has_no_zero(kind):
        from_mean = {
            JointKind.HIP: tr("Hip angle minus its mean, degrees (flexion +)"),
            JointKind.KNEE: tr("Knee angle minus its mean, degrees (flexion +)"),
            JointKind.ANKLE: tr("Ankle angle minus its mean, degrees (dorsiflexion +)"),
        }
        return from_mean[JointKind(kind)]
    measured = {
        JointKind.HIP: tr("Hip angle, degrees (flexion +, extension −)"),
        JointKind.KNEE: tr("Knee angle, degrees (flexion +, extension −)"),
        JointKind.ANKLE: tr("Ankle angle, degrees (dorsiflexion +, plantarflexion −)"),
    }
    return measured[JointKind(kind)]


def title_with_side(facts: Facts, kind: str, side: Side, *, is_about_mean: bool = False) -> str:
    stated = tr("Left: {title}") if side is Side.LEFT else tr("Right: {title}")
    return stated.format(title=small_title(facts, kind, is_about_mean=is_about_mean))


def small_title(facts: Facts, kind: str, *, is_about_mean: bool = False) -> str:
    """Of a panel half as wide as the page, as it goes on behind a side."""
    short = {
        "knee": tr("knee angle minus its mean, degrees (flexion +)"),
        "ankle": tr("ankle angle minus its mean, degrees (dorsiflexion +)"),
        "hip": tr("hip angle minus its mean, degrees (flexion +)"),
    }
    title = title_of(facts, kind)
    return short[kind] if is_about_mean or facts.has_no_zero(kind) else within_sentence(title)


def band_of(facts: Facts, kind: str, sides: Sequence[Side]) -> Band | None:
    """Give mean and SD of the reference group; None for hips, or without a group or a curve to compare."""
    group = facts.curves_group
    if group is None or kind == JointKind.HIP or facts.has_no_zero(kind) or facts.sides_with_band.isdisjoint(sides):
        return None
    if not any(np.isfinite(facts.mean_curve_deg(side, kind)).any() for side in sides if side in facts.sides_with_band):
        return None
    return Band(*group.mean_and_sd_deg(kind))


def curve_of(facts: Facts, side: Side, kind: str) -> StrideCurve:
    """One leg of one walk: its mean, or its single strides where they are too few for one."""
    off = facts.value(side, "stance_percent")
    is_known = is_mean_enough(off.n)
    label = tr("{side} toe\u2011off {percent} %").format(side=side.letter, percent=fixed(off.mean, 1))
    return StrideCurve(
        letter=side.letter,
        side=side,
        angle_deg=facts.mean_curve_deg(side, kind),
        toe_off_percent=off.mean if is_known else math.nan,
        toe_off_sd=off.sd if is_spread_enough(off.n) else math.nan,
        toe_off_label=label,
        strides_deg=NO_STRIDES if is_known else facts.strides_deg(side, kind),
    )


def joint_title(facts: Facts, side: Side, kind: str) -> str:
    """Of a narrow panel."""
    name = capitalised(name_of(joint_of(kind, side)))
    return tr("{joint} minus its mean, °").format(joint=name) if facts.has_no_zero(kind) else f"{name}, °"


def narrow_title(facts: Facts, kind: JointKind) -> str:
    """Of both legs in a panel a third as wide as the page."""
    name = title_in_words(kind)
    return tr("{joint} minus its mean, °").format(joint=name) if facts.has_no_zero(kind) else f"{name}, °"


def why_not_reported(facts: Facts, joint: Joint) -> str:
    """Why neither mean nor single strides of a joint may be drawn; empty where one of them may."""
    side, kind = joint.side, joint.kind
    if np.isfinite(facts.mean_curve_deg(side, kind)).any() or len(facts.strides_deg(side, kind)):
        return ""
    for cause in quality.causes(facts, (Verdict.NOT_REPORTED,), is_of_joints=True):
        if joint in cause.places and cause.gate not in quality.HEIGHT_GATES:
            return cause.words.why
    return tr("No usable stride for this joint.")


def why_no_joint(facts: Facts, kind: str) -> str:
    """Why neither leg has a kind of joint."""
    worn = facts.visit.recording(facts.walk.name).imu
    without = [side_name(side) for side in Side if joint_of(kind, side).distal not in worn]
    if kind == "ankle":
        if without:
            return tr("Ankle not measured: no sensor on the {sides} foot.").format(sides=joined(without))
        return tr("Ankle not measured.")
    return tr("Knee not measured.")


def why_no_band(facts: Facts, why: NoBand | None) -> str:
    """Why no band is shown beside this walk; empty where one is."""
    if facts.gait and not facts.sides_with_band:
        return tr("No reference: a prosthetic leg is not compared with other people.")
    return tr(WHY_NO_BAND[why]) if why is not None else ""


def band_in_words(facts: Facts, *, has_hips: bool = False) -> str:
    """Whose band is drawn, or why there is none; `has_hips`: hips are drawn as well, which have none."""
    group = facts.curves_group
    if group is None:
        return why_no_band(facts, facts.bands.why_no_curves)
    if all(facts.has_no_zero(kind) for kind in KINDS if facts.has_joint(kind)):
        return tr("No reference band: without a standing reference there are no absolute angles to compare.")
    stated = [
        tr("Grey: reference (mean, ±1 and ±2 SD of {n} young adults, barefoot, treadmill, {speed} m/s) [1].").format(
            n=group.n, speed=fixed(group.speed_m_s, 2)
        )
    ]
    if has_hips:
        stated.append(tr("At the hip, the reference has another zero and is not shown."))
    if facts.bands.are_curves_of_other_ages:
        stated.append(tr(OTHER_AGES))
    if not facts.sides_with_band.issuperset(facts.gait):
        sides = joined([side_name(side) for side in Side if side in facts.sides_with_band])
        stated.append(tr("The reference applies to the {side} leg only.").format(side=sides))
    return " ".join(stated)


def dot(verdict: Verdict) -> Picture:
    """Full where it can be read, half where with care, empty where not reported, a dash where not measured."""
    x = y = DOT / 2
    radius, draw = DOT / 2 - 0.6, Drawing()
    if verdict is Verdict.NOT_MEASURED:
        draw.line(1, y, DOT - 1, y, PAPER.note, 1.0)
    else:
        draw.circle(x, y, radius, PAPER.ink if verdict is Verdict.READ else PAPER.paper, PAPER.ink, 0.9)
    if verdict is Verdict.CARE:
        half = f"M{x} {y - radius}A{radius} {radius} 0 0 0 {x} {y + radius}Z"
        draw.parts.append(f'<path d="{half}" fill="{PAPER.ink}"/>')
    return draw.picture(DOT, DOT)


def pair_swatch(letter: str, looks: Sequence[tuple[Side, str, float]]) -> Picture:
    """A letter, and the lines of both legs that it represents."""
    y, draw = SWATCH_HEIGHT / 2, Drawing()
    draw.text(0, 7, letter, 7.6, weight=600)
    for k, (side, colour, width) in enumerate(looks):
        x = 10 + 22 * k
        draw.line(x, y, x + 19, y, colour, width, DASHES[side])
    return draw.picture(53, SWATCH_HEIGHT)


def band_swatches() -> list[tuple[Picture, str]]:
    inner, outer = Drawing(), Drawing()
    inner.box(0.2, 1, SWATCH_WIDTH - 0.4, 7, PAPER.band_1sd, PAPER.band_1sd_edge, 0.35)
    inner.line(0, 4.5, SWATCH_WIDTH, 4.5, PAPER.band_mean, 0.6)
    outer.box(0.2, 1, SWATCH_WIDTH - 0.4, 7, PAPER.band_2sd, PAPER.band_2sd_edge, 0.35)
    return [
        (inner.picture(SWATCH_WIDTH, SWATCH_HEIGHT), tr("Reference mean, ±1 SD [1]")),
        (outer.picture(SWATCH_WIDTH, SWATCH_HEIGHT), tr("±2 SD [1]")),
    ]


def not_drawn(facts: Facts, kind: str) -> list[str]:
    """Say of each leg whose curve is missing why it is."""
    stated = []
    for side in Side:
        joint = name_of(joint_of(kind, side))
        if not np.isfinite(facts.mean_curve_deg(side, kind)).any() and not len(facts.strides_deg(side, kind)):
            found = facts.verdicts.joint(joint_of(kind, side))
            is_not_reported = Verdict.NOT_REPORTED in (found.shape.verdict, found.sign.verdict)
            pattern = tr("Not drawn: {joint} (not reported).") if is_not_reported else tr("Not drawn: {joint}.")
            stated.append(pattern.format(joint=joint))
    return stated


def curve_alt(facts: Facts, kind: str, sides: Sequence[Side]) -> str:
    """The figure in words and numbers, for who does not see it."""
    stated = [title_of(facts, kind) + "."]
    for side in sides:
        peaks = []
        for column in PEAK_COLUMNS[kind]:
            value, at = facts.value(side, column), facts.peak_percent(side, column)
            if is_mean_enough(value.n):
                peak = tr("{name} {value}° at {percent} % of the gait cycle")
                name = peak_name(column)
                peaks.append(peak.format(name=name, value=fixed(value.mean, 0), percent=fixed(at.mean, 0)))
        stated.append(f"{capitalised(side_name(side))}: {leg_in_numbers(facts.part, side, kind, peaks)}.")
    return " ".join([tr("SIMULATED.")] * facts.is_simulated + stated)


def leg_in_numbers(part: Part, side: Side, kind: str, peaks: Sequence[str]) -> str:
    """Strides, what is stated of the peaks, range and toe-off, as far as they are known."""
    numbers = [tr("{count} strides").format(count=part.strides(side)), *peaks]
    found, off = part.value(side, f"{kind}_range_deg"), part.value(side, "stance_percent")
    if is_mean_enough(found.n):
        numbers.append(tr("range of motion {value}°").format(value=fixed(found.mean, 0)))
    if is_mean_enough(off.n):
        numbers.append(tr("toe\u2011off at {percent} %").format(percent=fixed(off.mean, 0)))
    return ", ".join(numbers)


def peak_name(column: str) -> str:
    return {
        "knee_loading_peak_deg": tr("peak flexion, loading"),
        "knee_stance_minimum_deg": tr("least flexion, stance"),
        "knee_swing_peak_deg": tr("peak flexion, swing"),
        "ankle_loading_plantarflexion_deg": tr("peak plantarflexion, loading"),
        "ankle_stance_dorsiflexion_deg": tr("peak dorsiflexion, stance"),
        "ankle_push_off_plantarflexion_deg": tr("peak plantarflexion, push-off"),
        "ankle_swing_dorsiflexion_deg": tr("peak dorsiflexion, swing"),
        "hip_flexion_peak_deg": tr("peak flexion"),
        "hip_extension_peak_deg": tr("peak extension"),
        "hip_abduction_peak_deg": tr("peak abduction"),
        "hip_adduction_peak_deg": tr("peak adduction"),
    }[column]


def excursion_name(column: str) -> str:
    return {
        "knee_while_loading_deg": tr("flexion, loading response"),
        "knee_straightening_deg": tr("extension, mid-stance"),
        "knee_stance_to_swing_deg": tr("flexion, stance to swing"),
        "ankle_heel_rocker_deg": tr("plantarflexion, loading response"),
        "ankle_rocker_deg": tr("dorsiflexion, stance"),
        "ankle_push_off_deg": tr("plantarflexion, push-off"),
        "ankle_toes_lifted_deg": tr("dorsiflexion, swing"),
    }[column]
