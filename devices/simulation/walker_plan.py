"""When and where simulated feet stand, and how the hips go along the path."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Side
from core.samples import FloatArray
from devices.simulation.walker_body import Walk
from devices.simulation.walker_manners import Gait, gait_at, gaits_of
from devices.simulation.walker_motion import smooth_step
from devices.simulation.walker_prosthesis import ProstheticFoot
from devices.simulation.walker_variation import NO_CHANGES, FootChanges, StepChanges

HIP_AHEAD_OF_ANKLE_M = 0.03  # standing, over the middle of the foot


@dataclass(frozen=True, slots=True)
class StepPlan:
    """The stances of one foot: the first and the last are standing, so contact and toe-off are infinite at the ends.

    All (i,). `ankle_m` is where along the path the ankle is. `knee_deg` and `ankle_deg` are added to the peaks of
    the swing that follows and of the toe-off that ends the stance. `turned_rad` is how far the foot is turned from the
    path, to the left, beyond its toe-out.
    """

    contact_s: FloatArray
    full_contact_s: FloatArray
    heel_rise_s: FloatArray
    toe_off_s: FloatArray
    ankle_m: FloatArray
    knee_deg: FloatArray
    ankle_deg: FloatArray
    turned_rad: FloatArray


@dataclass(frozen=True, slots=True)
class Bend:
    """Where the path turns: its middle along the path, how far (positive to the left), and the length of its arc.

    `early`: above 0 it turns more in its first half, below 0 in its second; between -1 and 1.
    """

    middle_m: float
    turn_rad: float
    arc_m: float
    early: float = 0.0

    def heading_at(self, path_m: FloatArray) -> FloatArray:
        """How far the path has turned (n,), rad, at places along it (n,)."""
        u = np.clip((path_m - self.middle_m) / (1.3 * self.arc_m) + 0.5, 0.0, 1.0)
        return self.turn_rad * smooth_step(u + self.early * u * (1.0 - u))


@dataclass(frozen=True, slots=True)
class WalkPlan:
    """Both feet's steps, when the hips speed up and slow down along the path, and where the path turns."""

    gaits: Mapping[Side, Gait]
    duration_s: float
    hip_path_m: FloatArray
    steps: dict[Side, StepPlan]
    bends: tuple[Bend, ...] = ()
    pivot_share: float = 0.0


def plan_walk(
    walk: Walk,
    time_s: FloatArray,
    first: Side,
    feet: Mapping[Side, ProstheticFoot | None],
    rng: np.random.Generator,
    changes: StepChanges = NO_CHANGES,
) -> WalkPlan:
    """Plan footsteps on the fine clock (n,), from the start of the recording; `feet` are the prosthetic ones."""
    gaits = gaits_of(walk.speed_m_s, walk.manner_of_side, walk.manner)
    gait = gaits[first]
    stride_s, swing_s = gait.stride_s, (1.0 - gait.stance) * gait.stride_s
    first_off = walk.standing_before_s + 0.3 * stride_s
    time, length = changes.of_steps(2 * walk.strides)
    shares = np.tile([0.5 + gait.late, 0.5 + gaits[first.other].late], walk.strides)
    steps_s = shares * stride_s * rng.normal(1.0, 0.012, 2 * walk.strides) * time
    contact = first_off + swing_s + np.concatenate([[0.0], np.cumsum(steps_s[1:])])
    at_speed = contact[0] + 0.12 * stride_s
    slowing = contact[-2]
    stopped = slowing + 2.0 * gait.midstance * stride_s
    speed = (
        walk.speed_m_s
        * np.interp(time_s, contact, length / time)
        * (
            smooth_step((time_s - at_speed) / (0.65 * stride_s) + 1.0)
            - smooth_step((time_s - slowing) / (stopped - slowing))
        )
    )
    hip_path = np.cumsum(speed) * (time_s[1] - time_s[0])
    placed_s = contact + gait.midstance * stride_s
    ankle = np.interp(placed_s, time_s, hip_path)
    ankle[-2:] = hip_path[-1]
    ankle[:-2] += rng.normal(0.0, 0.01 * gait.stride_m, len(ankle) - 2)
    stride_time = 0.5 * (time + np.concatenate([time[:1], time[:-1]]))
    plans = {
        side: plan_foot(
            gaits[side],
            feet.get(side),
            contact[k::2],
            np.concatenate([[hip_path[0]], ankle[k::2]]) - HIP_AHEAD_OF_ANKLE_M,
            stride_time[k::2],
            changes.of_foot(side, walk.strides),
        )
        for k, side in enumerate((first, first.other))
    }
    bend = Bend(0.5 * float(hip_path.max()), walk.turn_rad, max(abs(walk.turn_rad) * walk.turn_radius_m, 0.1))
    duration_s = float(stopped + walk.standing_after_s + 0.4 * stride_s)
    return WalkPlan(gaits, duration_s, hip_path, plans, (bend,), walk.pivot_share)


def plan_foot(
    gait: Gait,
    foot: ProstheticFoot | None,
    contact_s: FloatArray,
    ankle_m: FloatArray,
    stride_time: FloatArray,
    changes: FootChanges,
) -> StepPlan:
    """Plan a foot's k + 1 stances from contacts (k,) and ankle places (k + 1,), standing first."""
    turned = gait if foot is None else foot
    swing_s = (1.0 - gait.stance - 0.01 * changes.stance_percent) * gait.stride_s * stride_time
    starts = np.concatenate([[-np.inf], contact_s])
    ends = np.concatenate([contact_s - swing_s, [np.inf]])
    return StepPlan(
        contact_s=starts,
        full_contact_s=starts + turned.full_contact * gait.stride_s,
        heel_rise_s=ends - (gait.stance - turned.heel_rise) * gait.stride_s,
        toe_off_s=ends,
        ankle_m=ankle_m,
        knee_deg=np.append(changes.knee_deg, 0.0),
        ankle_deg=np.append(changes.ankle_deg, 0.0),
        turned_rad=np.zeros_like(starts),
    )


def plan_standing(time_s: FloatArray, duration_s: float) -> WalkPlan:
    """Plan standing with both feet side by side, without a step."""
    gait = gait_at(1.19)
    place_m = np.array([-HIP_AHEAD_OF_ANKLE_M])
    foot = plan_foot(gait, None, np.empty(0), place_m, np.empty(0), NO_CHANGES.of_foot(Side.LEFT, 0))
    return WalkPlan(dict.fromkeys(Side, gait), duration_s, np.zeros_like(time_s), dict.fromkeys(Side, foot))
