"""How a simulated patient walks a course: bouts of steps with turns, one after the other, and how it sits and rises."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker_body import NO_CHANGE, ON_THE_PATH, FeetInTurns, GaitChange, Leg
from devices.simulation.walker_gait import walk_leg
from devices.simulation.walker_manners import Gait
from devices.simulation.walker_motion import (
    Z_AXIS,
    JointAngles,
    LegMotion,
    TrueFootEvents,
    ankle_rotation,
    knee_rotation,
    rotation_about,
    smooth_step,
)
from devices.simulation.walker_plan import HIP_AHEAD_OF_ANKLE_M, Bend, WalkPlan, plan_foot
from devices.simulation.walker_variation import FootChanges

SEATED_KNEE_RAD, SEATED_ANKLE_RAD = np.deg2rad(95.0), np.deg2rad(5.0)  # the thighs then lie level
LEAN_RAD = np.deg2rad(12.0)  # so much further the shanks lean forward on the way up and down
CLIMB_SHARE = 0.9  # of a swing, in which the foot comes to its new height: before it lands
OFF_SHARE, REST_SHARE = 0.3, 0.4  # of a stride: what a bout has before the first toe-off, and after the last step
NEITHER: Mapping[Side, GaitChange] = {}
FIDGET_RAD, FIDGET_HZ = np.deg2rad(0.6), 0.4  # of the thighs on the seat


@dataclass(frozen=True, slots=True)
class CourseStep:
    """One step: how far the body goes, how long the step takes, how much higher it leads."""

    length_m: float
    time_s: float
    rise_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Bout:
    """Steps from standing to standing, and where the way turns that they cover to the centimetre."""

    steps: Sequence[CourseStep]
    bends: Sequence[Bend]
    standing_before_s: float
    standing_after_s: float


@dataclass(frozen=True, slots=True)
class PlannedBout:
    """A bout on the course's clock: from `start_s` on, and its plan on a clock of its own."""

    start_s: float
    plan: WalkPlan


@dataclass(frozen=True, slots=True)
class SeatChange:
    """From standing to sitting or back: the instant it begins, how long it takes, and whether the patient then sits."""

    start_s: float
    duration_s: float
    is_down: bool

    @property
    def end_s(self) -> float:
        return self.start_s + self.duration_s


def plan_bout(
    bout: Bout,
    gaits: Mapping[Side, Gait],
    step_s: float,
    first: Side,
    rng: np.random.Generator,
    change_of_side: Mapping[Side, GaitChange] = NEITHER,
    feet: FeetInTurns = ON_THE_PATH,
) -> WalkPlan:
    """Plan where and when the feet stand in one bout, on a clock from 0 in steps of `step_s`."""
    gait = gaits[first]
    shares = np.tile([1.0 + 2.0 * gait.late, 1.0 + 2.0 * gaits[first.other].late], len(bout.steps))[: len(bout.steps)]
    durations = np.array([step.time_s for step in bout.steps]) * shares
    lengths = np.array([step.length_m for step in bout.steps])
    first_off = bout.standing_before_s + OFF_SHARE * gait.stride_s
    contact = first_off + (1.0 - gait.stance) * gait.stride_s + np.concatenate([[0.0], np.cumsum(durations[1:])])
    at_speed, slowing = contact[0] + 0.12 * gait.stride_s, contact[-2]
    stopped = slowing + 2.0 * gait.midstance * gait.stride_s
    duration_s = float(np.ceil((stopped + bout.standing_after_s + REST_SHARE * gait.stride_s) / step_s) * step_s)
    time_s = np.arange(round(duration_s / step_s) + 1) * step_s
    ramps = smooth_step((time_s - at_speed) / (0.65 * gait.stride_s) + 1.0) - smooth_step(
        (time_s - slowing) / (stopped - slowing)
    )
    hip_path = np.cumsum(np.interp(time_s, contact, lengths / durations) * ramps) * step_s
    if bout.bends:
        hip_path *= float(lengths.sum()) / hip_path[-1]
    ankle = np.interp(contact + gait.midstance * gait.stride_s, time_s, hip_path)
    ankle[-2:] = hip_path[-1]
    ankle[:-2] += rng.normal(0.0, 0.01 * gait.stride_m, len(ankle) - 2)
    plans = {
        side: plan_foot(
            gaits[side],
            None,
            contact[k::2],
            np.concatenate([hip_path[:1], ankle[k::2]]) - HIP_AHEAD_OF_ANKLE_M,
            np.ones(len(contact[k::2])),
            _alike(change_of_side.get(side, NO_CHANGE), len(contact[k::2])),
        )
        for k, side in enumerate((first, first.other))
    }
    stood_s = contact + gait.midstance * gait.stride_s
    turned = _heading_at(bout.bends, np.interp(stood_s - feet.late_s, time_s, hip_path))
    turned = turned - _heading_at(bout.bends, ankle - HIP_AHEAD_OF_ANKLE_M)  # a foot points as the body does, over it
    if feet.turned_sd_rad:
        turned += rng.normal(0.0, feet.turned_sd_rad, len(contact))
    plans = {
        side: replace(plans[side], turned_rad=np.concatenate([[0.0], turned[k::2]]))
        for k, side in enumerate((first, first.other))
    }
    return WalkPlan(gaits, duration_s, hip_path, plans, tuple(bout.bends), feet.pivot_share)


def _heading_at(bends: Sequence[Bend], path_m: FloatArray) -> FloatArray:
    return np.asarray(sum((bend.heading_at(path_m) for bend in bends), np.zeros_like(path_m)))


def _alike(change: GaitChange, strides: int) -> FootChanges:
    """The same in every stride."""
    reported = (change.knee_deg, change.ankle_deg, change.stance_percent)
    return FootChanges(*(np.full(strides, value) for value in reported))


def walk_bouts(
    legs: Mapping[Side, Leg],
    bouts: Sequence[PlannedBout],
    time_s: FloatArray,
    sway_m: FloatArray,
    per_leg: Mapping[Side, np.random.Generator],
) -> dict[Side, LegMotion]:
    """Move both legs through all bouts, each where the last ended; earth axes, z up, metres."""
    step_s = float(time_s[1] - time_s[0])
    edges = [0, *(round((bout.start_s - time_s[0]) / step_s) for bout in bouts[1:]), len(time_s)]
    parts: dict[Side, list[LegMotion]] = {side: [] for side in Side}
    heading, place = 0.0, None
    for bout, begin, end in zip(bouts, edges[:-1], edges[1:], strict=True):
        clock = time_s[begin:end] - bout.start_s
        known = np.arange(len(bout.plan.hip_path_m)) * step_s
        plan = replace(bout.plan, hip_path_m=np.interp(clock, known, bout.plan.hip_path_m))
        motions = {side: walk_leg(legs[side], plan, clock, sway_m[begin:end], per_leg[side]) for side in Side}
        turned = rotation_about(Z_AXIS, np.array([heading]))[0]
        left = motions[Side.LEFT].footholds_m @ turned[:2, :2].T
        shift = np.zeros(3)
        shift[:2] = 0.0 if place is None else place - left[0]
        for side, motion in motions.items():
            parts[side].append(_moved(motion, turned, shift, bout.start_s))
        heading += sum(bend.turn_rad for bend in plan.bends)
        place = left[-1] + shift[:2]
    return {side: _joined(parts[side], time_s) for side in Side}


def climb(motion: LegMotion, heights_m: FloatArray) -> LegMotion:
    """Lead each swing to the height of its next of k + 1 footholds; only the path of the foot is modelled."""
    events, height = motion.events, np.full_like(motion.time_s, heights_m[0])
    pairs = zip(events.toe_off_s.tolist(), events.initial_contact_s.tolist(), strict=True)
    for number, (off_s, on_s) in enumerate(pairs):
        share = smooth_step((motion.time_s - off_s) / (CLIMB_SHARE * (on_s - off_s)))
        height += (heights_m[number + 1] - heights_m[number]) * share
    return replace(motion, origins_m=motion.origins_m + height[:, None] * np.array([0.0, 0.0, 1.0]))


def _moved(motion: LegMotion, turned: FloatArray, shift: FloatArray, by_s: float) -> LegMotion:
    """The same motion elsewhere (3,), in another direction (3, 3) and later."""
    events = motion.events
    return replace(
        motion,
        rotations=turned @ motion.rotations,
        origins_m=motion.origins_m @ turned.T + shift,
        footholds_m=motion.footholds_m @ turned[:2, :2].T + shift[:2],
        events=TrueFootEvents(
            events.initial_contact_s + by_s,
            events.full_contact_s + by_s,
            events.heel_rise_s + by_s,
            events.toe_off_s + by_s,
        ),
    )


def _joined(parts: Sequence[LegMotion], time_s: FloatArray) -> LegMotion:
    """One motion of several that follow each other; the foothold between two of them counts once."""
    angles = [part.angles for part in parts]
    events = [part.events for part in parts]
    return LegMotion(
        time_s,
        JointAngles(
            *(np.concatenate([getattr(a, name) for a in angles]) for name in ("knee", "ankle", "inversion", "rotation"))
        ),
        np.concatenate([part.rotations for part in parts], axis=1),
        np.concatenate([part.origins_m for part in parts], axis=1),
        TrueFootEvents(
            *(
                np.concatenate([getattr(e, f"{name}_s") for e in events])
                for name in ("initial_contact", "full_contact", "heel_rise", "toe_off")
            )
        ),
        np.concatenate([parts[0].footholds_m, *(part.footholds_m[1:] for part in parts[1:])]),
    )


def sit(leg: Leg, motion: LegMotion, changes: Sequence[SeatChange], phase_rad: float) -> LegMotion:
    """Seat the patient where `changes` state so, feet in place; before a first rise the patient sits."""
    if not changes:
        return motion
    t = motion.time_s
    seated = np.full_like(t, 0.0 if changes[0].is_down else 1.0)
    lean = np.zeros_like(t)
    for change in changes:
        u = np.clip((t - change.start_s) / change.duration_s, 0.0, 1.0)
        seated += (1.0 if change.is_down else -1.0) * smooth_step(u)
        lean += LEAN_RAD * (4.0 * u * (1.0 - u)) ** 3
    angles = motion.angles
    fidget = FIDGET_RAD * np.sin(2.0 * np.pi * FIDGET_HZ * t + phase_rad)
    angles = replace(
        angles,
        knee=(1.0 - seated) * angles.knee + seated * (SEATED_KNEE_RAD + fidget) + lean,
        ankle=(1.0 - seated) * angles.ankle + seated * SEATED_ANKLE_RAD + lean,
    )
    foot, ankle_m = motion.rotations[2], motion.origins_m[2]
    shank = foot @ np.swapaxes(ankle_rotation(leg, angles), 1, 2)
    thigh = shank @ np.swapaxes(knee_rotation(leg, angles), 1, 2)
    knee_m = ankle_m + leg.shank_m * shank[:, :, 2]
    hip_m = knee_m + leg.thigh_m * thigh[:, :, 2]
    return replace(
        motion, angles=angles, rotations=np.stack([thigh, shank, foot]), origins_m=np.stack([hip_m, knee_m, ankle_m])
    )
