"""Wording that asks for the motion that is missing, and what stopping now costs."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from app.theme.icons import Icon
from app.widgets.gauge import AXIS_FROM_DEG, CENTRE_FROM_MM, CLOSED, GaugeState, gauge_face, two_digits
from app.widgets.hint import Hint
from app.wording.body import name_of, spelled_out
from app.wording.translation import capitalised, tr, tr_n
from core.body import Joint, Segment, Side, Site, ankle_of, knee_of
from core.live.excitation import HUMAN, PROSTHESIS, ExcitationState, Missing, Movement, Required
from core.live.free_motion import FreeMotionState

LETTERS = 28  # what is read from two metres
HELD_S = 2.5  # nobody can follow a hint that changes sooner
ASKED_FOR_S = 5.0  # more movement, where little is wanting
RESTS_S = 6.0  # with nothing left to ask for, before what was given up is asked for once more
ONCE_MORE_S = 8.0


def required_of(joint: Joint, prosthetic: frozenset[Joint]) -> Required:
    """What closes this joint."""
    return PROSTHESIS if joint in prosthetic else HUMAN


def hint_for(missing: Missing, prosthetic: frozenset[Joint] = frozenset()) -> Hint:
    """Ask for one motion; where the prosthesis has the joint that moves it the therapist moves the limb."""
    is_circle = missing.movement is Movement.CIRCLE
    sentence = _circle(missing.site) if is_circle else _bend(missing.site)
    icon = Icon.REPEAT if is_circle else Icon.BEND
    phrase = f"{'circle' if is_circle else 'bend'}-{missing.site}"
    if _moved_by(missing.site) in prosthetic:
        how = (
            tr("The therapist moves the limb. Reverse direction from time to time.")
            if is_circle
            else tr("The therapist moves the limb.")
        )
        return Hint(sentence, how, tr("The therapist moves the limb."), icon, phrase)
    if is_circle:
        how = tr("Reverse direction from time to time. The patient may sit or stand; move the limb by hand if needed.")
        return Hint(sentence, how, tr("Reverse direction from time to time. The patient may sit."), icon, phrase)
    how = tr("Back and forth, as far as comfortable. Moving the leg by hand is fine.")
    return Hint(sentence, how, tr("Back and forth. You may move the limb by hand."), icon, phrase)


def _moved_by(site: Site) -> Joint:
    """The joint that a segment is moved in; of a thigh the knee, below which the limb is a load to be carried."""
    return ankle_of(site.leg_side) if site.segment is Segment.FOOT else knee_of(site.leg_side)


def first_hint() -> Hint:
    """Before anything moves, or while nobody knows who is where."""
    how = tr("One leg, then the other. The patient may sit, lie or stand; move the leg by hand if needed.")
    short = tr("One leg, then the other. The patient may sit.")
    return Hint(tr("Move either leg"), how, short, phrase="move-either-leg")


def unplaced_hint() -> Hint:
    """While the motion is to show which sensor is where: the leg that moves first is the left one."""
    how = tr("Then the right leg. The movement identifies the sensor positions.")
    return Hint(tr("Move the left leg first"), how, tr("Then the right leg."), phrase="move-left-leg-first")


def judged(motion: FreeMotionState, prosthetic: frozenset[Joint]) -> dict[Joint, GaugeState]:
    """Give the words for each joint, whichever is asked for now: the gauge's word is the rail's and the hint's."""
    return {
        joint: gauge_face(joint, state, required_of(joint, prosthetic), is_now=False).state
        for joint, state in motion.joints.items()
    }


def enough_for(motion: FreeMotionState, prosthetic: frozenset[Joint]) -> str:
    """State for which joints motion is enough: ankles count by their centre, non-hinges are named."""
    states = judged(motion, prosthetic)
    if states and all(state in CLOSED for state in states.values()):
        return tr("enough movement")
    knees = [state for joint, state in states.items() if joint.is_knee]
    ankles = [state for joint, state in states.items() if not joint.is_knee]
    of_knees = tr_n("{enough} of {count} knee", "{enough} of {count} knees", len(knees))
    of_ankles = tr_n("{enough} of {count} ankle centre", "{enough} of {count} ankle centres", len(ankles))
    counts = [
        words.format(enough=sum(state in CLOSED for state in of_kind), count=len(of_kind))
        for words, of_kind in ((of_knees, knees), (of_ankles, ankles))
        if of_kind
    ]
    stated = tr("enough movement for {counts}").format(counts=", ".join(counts))
    loose = tr("{joint}: not a hinge")
    named = [loose.format(joint=name_of(joint)) for joint, state in states.items() if state is GaugeState.LOOSE]
    return "; ".join([stated, *named])


def last_hint(motion: FreeMotionState, prosthetic: frozenset[Joint] = frozenset()) -> Hint:
    """When nothing is left to do: enough motion, a joint that is no hinge, or some only as good as it gave."""
    states = judged(motion, prosthetic)
    then = tr("Walking follows automatically.")
    if all(state in CLOSED for state in states.values()):
        ankles = [joint for joint in states if not joint.is_knee]
        finds = tr_n("It determines the ankle axis.", "It determines the ankle axes.", len(ankles)) if ankles else ""
        if open_hip(motion) is not None:
            hips = tr("Walking with a turn also calibrates the hips.")
            with_axes = tr("Walking determines the ankle axes and, with a turn, calibrates the hips.")
            finds = with_axes if ankles else hips
        how = " ".join(filter(None, [then, finds]))
        return Hint(tr("Enough movement"), how, tr("Walking is next."), Icon.CHECK, "enough-movement")
    loose = [joint for joint, state in states.items() if state is GaugeState.LOOSE]
    if loose and all(state.is_closed for state in motion.joints.values()):
        sentence = tr("{joint}: not a hinge").format(joint=capitalised(name_of(loose[0])))
        phrase = f"loose-{loose[0]}"
        if len(loose) > 1:
            sentence = tr("{count} joints: not hinges").format(count=len(loose))
            phrase = "loose-several"
        angle = tr("The angle is the rotation about the main axis.")
        return Hint(sentence, f"{angle} {then}", tr("Walking is next."), Icon.WARNING, phrase)
    how = tr("Continue to walking, or repeat one leg.")
    return Hint(tr("Uncertainty no longer falls"), how, how, Icon.INFO, "no-longer-falls")


def open_hip(motion: FreeMotionState) -> Joint | None:
    """The hip that is known least of those that are not known well enough."""
    left = {joint: hip.sd_rad for joint, hip in motion.hips.items() if not hip.is_sure}
    return max(left, key=lambda joint: left[joint], default=None)


def hip_hint() -> Hint:
    """Ask for what shows the hips: they accelerate little while one leg circles."""
    how = tr("Or do lunges, left and right. Circling the legs does not calibrate the hips; walking does.")
    return Hint(tr("Walk 15 s, with a turn"), how, tr("Or do lunges, left and right."), Icon.NEXT, "walk-with-turn")


def played_hint(has_played: bool) -> Hint:
    """When a replayed patient moves no more, or never did."""
    if not has_played:
        how = tr("Joints are calibrated from the walks, with more uncertainty. Continue to walking.")
        return Hint(tr("Replay has no free motion"), how, tr("Continue to walking."), Icon.INFO, "replay-without")
    how = tr("Record again to replay from the start, or continue with the data so far.")
    return Hint(tr("The replay has ended"), how, tr("Record again, or continue."), Icon.INFO, "replay-ended")


def recorded_hint(motion: FreeMotionState, prosthetic: frozenset[Joint] = frozenset()) -> Hint:
    """Once it is recorded: what came of it, as far as that is known; of an earlier day it is not."""
    how = tr("Continue to walking, or repeat one leg.")
    if not motion.joints:
        return Hint(tr("Free motion recorded"), how, how, Icon.CHECK, "recorded")
    if motion.is_done:
        return replace(last_hint(motion, prosthetic), how=how, how_short=how)
    return Hint(tr("Stopped early"), how, how, Icon.INFO, "stopped-early")


def absent_note(joint: Joint, worn: Collection[Site], without_ankle: Collection[Side]) -> str:
    """Say why a joint has no gauge; empty where it has one."""
    is_ankle = not joint.is_knee and not joint.is_hip
    if is_ankle and joint.side in without_ankle and joint.proximal in worn and joint.distal in worn:
        return tr("Foot without ankle joint: nothing to calibrate. The angle is called “foot relative to shank”.")
    missing = [site for site in (joint.proximal, joint.distal) if site not in worn]
    if not missing:
        return ""
    reported = tr("No sensor on {sites}: no {joint} angle.")
    sites = [name_of(site) for site in missing]
    both = tr("{first} and {last}").format(first=sites[0], last=sites[-1]) if len(sites) == 2 else sites[0]
    return reported.format(sites=both, joint=name_of(joint))


def needed_note(joint: Joint, detected: Mapping[Site, Site]) -> str:
    """Say which sensor a joint lacks while places look swapped; empty where both of its ends are as stated."""
    swapped = [site for site in (joint.proximal, joint.distal) if site in detected]
    if len(swapped) > 1:
        return tr("Needs both sensors")
    return tr("Needs the {site} sensor").format(site=spelled_out(swapped[0])) if swapped else ""


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked for now. `joint` is the one whose card is bold, `site` the limb that is darkened."""

    hint: Hint
    joint: Joint | None = None
    site: Site | None = None


class HintHold:
    """Keeps a hint on the screen for HELD_S, unless its joint has enough before.

    A joint whose motion brought no more is asked for once more when nothing else is left: another was the weakest
    meanwhile, or the motion was not the one that was meant.
    """

    def __init__(self, prosthetic: frozenset[Joint] = frozenset()) -> None:
        self._prosthetic = prosthetic
        self._asked: Asked | None = None
        self._since_s = -math.inf
        self._settled_s: float | None = None  # since when nothing is left to ask for
        self._once_more: dict[Joint, float] = {}  # when each was asked for a second time

    def ask(self, motion: FreeMotionState, now_s: float) -> Asked:
        """Say what to ask for at `now_s`, of any clock that goes on evenly."""
        wish = self._wish(motion, now_s)
        if self._asked is None or (
            wish != self._asked and (now_s - self._since_s >= HELD_S or self._is_answered(self._asked, motion))
        ):
            self._asked, self._since_s = wish, now_s
        return self._asked

    def _wish(self, motion: FreeMotionState, now_s: float) -> Asked:
        weakest = motion.weakest
        if motion.is_done:
            weakest = self._given_up(motion, now_s)
        else:
            self._settled_s = None
        if weakest is None:
            return self._rest(motion)
        missing = motion.joints[weakest].missing
        if missing is None or not any(state.moved_s for state in motion.joints.values()):
            return Asked(first_hint())
        return Asked(hint_for(missing, self._prosthetic), weakest, missing.site)

    def _rest(self, motion: FreeMotionState) -> Asked:
        """With nothing left to ask of knees and ankles: hips may still be shown where some did not close."""
        hip = open_hip(motion)
        if not motion.is_done:
            return Asked(first_hint())
        if hip is None or all(state.is_closed for state in motion.joints.values()):
            return Asked(last_hint(motion, self._prosthetic))
        return Asked(hip_hint(), hip, Site.PELVIS)

    def _given_up(self, motion: FreeMotionState, now_s: float) -> Joint | None:
        """The worst joint that wants more motion and was not asked for a second time, or is just being."""
        left = {joint: state.wanting for joint, state in motion.joints.items() if not state.is_closed}
        for joint, since_s in self._once_more.items():
            if joint in left and now_s - since_s < ONCE_MORE_S:
                return joint
        if self._settled_s is None:
            self._settled_s = now_s
        new = [joint for joint in left if joint not in self._once_more]
        if not new or now_s - self._settled_s < RESTS_S:
            return None
        worst = max(new, key=lambda joint: left[joint])
        self._once_more[worst] = now_s
        return worst

    def _is_answered(self, asked: Asked, motion: FreeMotionState) -> bool:
        if asked.joint is None:
            return True  # "Move any leg" has been answered by moving
        if asked.joint.is_hip:
            return asked.joint in motion.hips and motion.hips[asked.joint].is_sure
        state = motion.joints.get(asked.joint)
        return state is None or state.is_closed or state.is_plateau


def price_of_stopping(
    motion: FreeMotionState, prosthetic: frozenset[Joint] = frozenset(), can_move: bool = True
) -> str:
    """Say what stopping now leaves undone; empty where nothing is."""
    if not motion.joints:
        return tr("No joint is calibrated yet.")
    is_open = [joint for joint, state in motion.joints.items() if not state.is_closed]
    unknown = [joint for joint in is_open if _is_unknown(joint, motion.joints[joint])]
    if unknown:
        names = _names(unknown)
        return tr("If you stop now, angles are unreliable for {joints}.").format(joints=names)
    if not is_open:
        return ""
    worst = max(is_open, key=lambda joint: motion.joints[joint].wanting)
    figure = _figure(worst, motion.joints[worst], required_of(worst, prosthetic))
    if motion.joints[worst].is_plateau or len(is_open) > 1 or not can_move:
        rest = tr("If you continue, the report states this uncertainty.")
    elif worst.side is Side.LEFT:
        rest = tr("Move the left leg for {seconds:.0f} more seconds, or continue: the report then states this.")
    else:
        rest = tr("Move the right leg for {seconds:.0f} more seconds, or continue: the report then states this.")
    return f"{figure} {rest.format(seconds=ASKED_FOR_S)}"


def _circle(site: Site) -> str:
    left = {
        Segment.THIGH: tr("Circle the left thigh"),
        Segment.SHANK: tr("Circle the left lower leg"),
        Segment.FOOT: tr("Circle the left foot"),
    }
    right = {
        Segment.THIGH: tr("Circle the right thigh"),
        Segment.SHANK: tr("Circle the right lower leg"),
        Segment.FOOT: tr("Circle the right foot"),
    }
    return (left if site.side is Side.LEFT else right)[site.segment]


def _bend(site: Site) -> str:
    """The joint at the segment's near end is what bends."""
    left = {
        Segment.THIGH: tr("Bend the left hip"),
        Segment.SHANK: tr("Bend the left knee"),
        Segment.FOOT: tr("Bend the left ankle"),
    }
    right = {
        Segment.THIGH: tr("Bend the right hip"),
        Segment.SHANK: tr("Bend the right knee"),
        Segment.FOOT: tr("Bend the right ankle"),
    }
    return (left if site.side is Side.LEFT else right)[site.segment]


def _is_unknown(joint: Joint, state: ExcitationState) -> bool:
    is_axis_unknown = joint.is_knee and math.degrees(state.axis_sd_rad) >= AXIS_FROM_DEG
    return is_axis_unknown or 1000 * state.centre_sd_m >= CENTRE_FROM_MM


def _figure(joint: Joint, state: ExcitationState, required: Required) -> str:
    """ "Left knee: 3.8°, 1.5° required." """
    name = name_of(joint)
    name = name[0].upper() + name[1:]
    axis, centre = math.degrees(state.axis_sd_rad), 1000 * state.centre_sd_m
    axis_required, centre_required = math.degrees(required.axis_rad), 1000 * required.centre_m
    if joint.is_knee and axis / axis_required >= centre / centre_required:
        stated = tr("{joint}: axis uncertainty {figure}°, limit {required:g}°.")
        return stated.format(joint=name, figure=two_digits(axis, axis_required), required=axis_required)
    stated = tr("{joint}: centre uncertainty {figure} mm, limit {required:g} mm.")
    return stated.format(joint=name, figure=two_digits(centre, centre_required), required=centre_required)


def _names(joints: list[Joint]) -> str:
    if len(joints) == 1:
        return _the(joints[0])
    if len(joints) == 2:
        return tr("{first} and {last}").format(first=_the(joints[0]), last=_the(joints[1]))
    return tr("{count} joints").format(count=len(joints))


def _the(joint: Joint) -> str:
    return {
        Joint.LEFT_KNEE: tr("the left knee"),
        Joint.LEFT_ANKLE: tr("the left ankle"),
        Joint.RIGHT_KNEE: tr("the right knee"),
        Joint.RIGHT_ANKLE: tr("the right ankle"),
    }[joint]
