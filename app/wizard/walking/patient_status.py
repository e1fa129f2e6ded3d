"""What the clinician reads beside the controls of the patient's screen: what can be a target, and what hinders one.

Every state has its words, so that the reason for a screen without a value is always on the page.
"""

import math
from collections.abc import Collection, Mapping

import numpy as np

from app.patient_screen.controls import choice_words, choices
from app.patient_screen.patient_view import PatientView, figure, reached_words, steps_words
from app.wizard.losses import NOTHING, Message
from app.wizard.walk_messages import implausible_message
from app.wizard.walking.readout import WalkingReadout
from app.wording.body import name_of
from app.wording.translation import tr
from app.wording.verdicts import gate_sentence
from core.body import LEG_SEGMENTS, Joint, Segment, Side, Site, knee_of
from core.results import JointCalibration
from core.targets import Target, TargetMeasure
from core.verdicts.live_targets import assess_target

# Nothing changed for so long: the patient is standing. Somebody whose strides take 3 s, the longest that are counted,
# has a foot flat for 1.8 s of each, and the knee is far from still meanwhile.
STANDING_AFTER_S = 2.5
STILL_KNEE_DEG = 8.0  # within that time: a knee that swings, even a stiff one, moves more; one that sways less


def reasons_against(
    worn: tuple[Site, ...],
    rested: Collection[Site],
    calibration: Mapping[Joint, JointCalibration],
    prosthetic_sides: frozenset[Side],
) -> dict[tuple[TargetMeasure, Side | None], str]:
    """Give the reason why each measure cannot be a target; `rested`: sites whose sensor's bias is known."""
    reasons = {}
    for measure, side in choices():
        found = assess_target(measure, side, worn, calibration, prosthetic_sides)
        if not found.is_reported:
            sentences = [gate_sentence(reason) for reason in found.reasons[:1]]
            reasons[measure, side] = sentences[0] if sentences else _not_measured(measure, side, worn)
        elif measure is TargetMeasure.KNEE_SWING_PEAK and side is not None:
            knee = knee_of(side)
            if not {knee.proximal, knee.distal} <= set(rested):
                reasons[measure, side] = tr(
                    "The sensors of this knee have not been still yet. Let the patient stand still first."
                )
    return reasons


def _not_measured(measure: TargetMeasure, side: Side | None, worn: tuple[Site, ...]) -> str:
    feet = {site.side for site in worn if site.segment is Segment.FOOT}
    if measure in (TargetMeasure.CADENCE, TargetMeasure.STANCE_RATIO) and not feet:
        return tr("There is no foot sensor.")
    if measure is TargetMeasure.STANCE_RATIO:
        return tr("Both feet need a sensor.")
    if side not in feet:
        return tr("This foot has no sensor.")
    return tr("The knee angle is not known yet. It needs sensors on thigh and shank, and a free motion.")


def hindrance(target: Target, view: WalkingReadout, worn: Collection[Site]) -> Message:
    """Say why the target cannot be measured at this moment; NOTHING where it can.

    A slipped strap, a silent sensor, a foot whose events its knee contradicts, an implausible angle.
    """
    feet = {Site(f"{side}_{Segment.FOOT}") for side in Side}
    required = feet & set(worn)
    if target.measure is TargetMeasure.KNEE_SWING_PEAK:
        required = {Site(f"{target.side}_{segment}") for segment in LEG_SEGMENTS}
    elif target.measure is TargetMeasure.FOOT_STRIKE:
        required = {Site(f"{target.side}_{Segment.FOOT}")}
    elif target.measure is TargetMeasure.STANCE_RATIO:
        required = feet
    slipped = {slip.site for slip in view.slips}
    lost = [site for site in Site if site in required and site in slipped | set(view.missing) | set(view.doubtful)]
    is_one_enough = target.side is None
    if lost and (not is_one_enough or len(lost) == len(required)):
        return _of_site(lost[0], lost[0] in view.missing, lost[0] in slipped)
    if is_one_enough and not required:
        return tr("There is no foot sensor."), ""
    if target.measure is TargetMeasure.KNEE_SWING_PEAK and target.side is not None:
        knee = knee_of(target.side)
        if knee in view.implausible:
            return implausible_message([knee])
    return NOTHING


def _of_site(site: Site, is_missing: bool, has_slipped: bool) -> Message:
    if is_missing:
        what, then = tr("{site}: no signal."), tr("The patient sees no value until the signal is back.")
    elif has_slipped:
        what, then = tr("{site}: strap moved."), tr("The patient sees no value. Tighten the strap, repeat free motion.")
    else:
        what = tr("{site}: steps do not match the knee.")
        then = tr("Usual before the walk. If it stays while the patient walks, check the sensor positions.")
    return what.format(site=name_of(site)), then


def is_standing(view: WalkingReadout) -> bool:
    """Whether no foot changed its phase and no knee moved for a while, as far as they send.

    Never before each foot was seen in a phase, nor where no foot sends anything.
    """
    lanes = [lane for side, lane in view.lanes.items() if Site(f"{side}_{Segment.FOOT}") not in view.missing]
    from_s = view.now_s - STANDING_AFTER_S
    if not lanes or any(not lane.spans or lane.spans[-1].start_s > from_s for lane in lanes):
        return False
    for trace in view.knees.values():
        angles_rad = trace.angle_rad[trace.time_s >= from_s]
        known_rad = angles_rad[np.isfinite(angles_rad)]
        if len(known_rad) and math.degrees(float(known_rad.max() - known_rad.min())) > STILL_KNEE_DEG:
            return False
    return True


def status_of(view: PatientView, hindered: Message, *, is_recording: bool) -> Message:
    """Say what the patient sees, while live data comes in."""
    if view.target is None:
        then = tr("Type one and press Enter. Until then the patient sees the number of steps.")
        return tr("No target yet."), then
    if hindered != NOTHING:
        return hindered
    target = view.target
    aimed = figure(target.value, target.measure)
    what = tr("{movement}: target {value}.").format(movement=choice_words((target.measure, target.side)), value=aimed)
    parts = []
    if view.is_standing:
        parts.append(tr("The patient is standing."))
    elif view.value is not None:
        parts.append(tr("Now {value}.").format(value=figure(view.value, target.measure)))
    if view.last:
        parts.append(f"{steps_words(len(view.last))}: {reached_words(view)}.")
    if not is_recording:
        parts.append(tr("No walk is being recorded. Space starts one."))
    return what, " ".join(parts)
