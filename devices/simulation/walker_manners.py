"""What do speed and manner decide of a walk: stride length and time, the shares of a stride, the size of the curves."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from core.body import Side
from devices.simulation.walker_body import Manner

LEAST_CLEARANCE_M = 0.012  # Winter 1992, doi 10.1093/ptj/72.1.45: 1.3 cm under the toe


@dataclass(frozen=True, slots=True)
class Gait:
    """What speed and manner decide: stride length and time, the shares of the stride, the size of the curves.

    `flat_pitch_rad` is the foot's pitch in the middle of stance; `toe_off_pitch_rad`, where not NaN, its pitch at
    toe-off, else the ankle's plantarflexion decides. Where `is_ankle_stiff` the foot turns with the shank. In the first
    `drag` (a share) of swing the toes stay on the floor. A leg lands `late`, as a share of the stride, against half a
    stride after the other, and its stance is so much shorter, so that both double supports stay as long.
    """

    speed_m_s: float
    stride_m: float
    stride_s: float
    stance: float
    full_contact: float
    heel_rise: float
    midstance: float
    contact_pitch_rad: float
    toe_off_ankle_rad: float
    knee_loading: float
    knee_swing: float
    shock: float
    clearance_m: float = LEAST_CLEARANCE_M
    lifted_rad: float = np.deg2rad(4.5)
    flat_pitch_rad: float = 0.0
    toe_off_pitch_rad: float = np.nan
    is_ankle_stiff: bool = False
    drag: float = 0.0
    late: float = 0.0


def gaits_of(
    speed_m_s: float, manner_of_side: Mapping[Side, Manner], manner: Manner = Manner.ORDINARY
) -> Mapping[Side, Gait]:
    """Either side's gait; both share the shorter stride and its time."""
    gaits = {side: gait_at(speed_m_s, manner_of_side.get(side, manner)) for side in Side}
    shorter = min(gaits.values(), key=lambda gait: gait.stride_m)
    shared = {}
    for side, gait in gaits.items():
        longer = gaits[side.other].late - gait.late
        shared[side] = replace(
            gait,
            stride_m=shorter.stride_m,
            stride_s=shorter.stride_s,
            midstance=shorter.midstance,
            stance=gait.stance + longer,
            heel_rise=gait.heel_rise + longer,
            late=-longer,
        )
    return shared


def gait_at(speed_m_s: float, manner: Manner = Manner.ORDINARY) -> Gait:
    """Give strides at 0.3-2 m/s, 1.28 m at 1.19; stance as Fukuchi et al. 2018 (doi 10.7717/peerj.4640)."""
    ordinary = _ordinary_gait(speed_m_s)
    if manner is Manner.SHUFFLING:
        return replace(
            ordinary,
            stride_m=0.55 * ordinary.stride_m,
            stride_s=0.55 * ordinary.stride_s,
            stance=ordinary.stance + 0.05,
            full_contact=0.06,
            heel_rise=ordinary.stance - 0.07,
            contact_pitch_rad=np.deg2rad(2.0),
            knee_swing=0.3,
            shock=0.3 * ordinary.shock,
            clearance_m=0.004,
            lifted_rad=np.deg2rad(2.0),
            toe_off_pitch_rad=np.deg2rad(-6.0),
        )
    if manner is Manner.TOES:
        return replace(
            ordinary,
            contact_pitch_rad=np.deg2rad(-6.0),
            lifted_rad=np.deg2rad(-15.0),
            flat_pitch_rad=np.deg2rad(-25.0),
        )
    if manner is Manner.FLAT:
        return replace(
            _shortened(ordinary, 0.65),
            full_contact=0.05,
            heel_rise=ordinary.stance - 0.09,
            contact_pitch_rad=np.deg2rad(2.0),
            knee_swing=0.65,
            shock=0.6 * ordinary.shock,
            lifted_rad=np.deg2rad(7.0),
            toe_off_pitch_rad=np.deg2rad(-4.0),
        )
    if manner is Manner.STIFF:
        return replace(_shortened(ordinary, 0.85), is_ankle_stiff=True)
    if manner is Manner.DRAGGING:
        return replace(
            _shortened(ordinary, 0.8),
            full_contact=0.07,
            contact_pitch_rad=np.deg2rad(-3.0),
            knee_swing=0.65,
            shock=0.5 * ordinary.shock,
            clearance_m=0.004,
            lifted_rad=np.deg2rad(-12.0),
            drag=0.3,
        )
    if manner is Manner.TOE_FIRST:
        return replace(
            _shortened(ordinary, 0.9),
            contact_pitch_rad=np.deg2rad(-8.0),
            lifted_rad=np.deg2rad(-8.0),
            full_contact=0.13,
        )
    if manner is Manner.HEMIPARETIC:
        return replace(
            _shortened(ordinary, 0.85),
            full_contact=0.05,
            heel_rise=ordinary.stance - 0.17,
            contact_pitch_rad=np.deg2rad(3.0),
            knee_swing=0.5,
            shock=0.6 * ordinary.shock,
            lifted_rad=np.deg2rad(4.0),
            toe_off_pitch_rad=np.deg2rad(-15.0),
            late=0.03,
        )
    return ordinary


def _shortened(gait: Gait, by: float) -> Gait:
    """Shorter and quicker strides at the same speed."""
    return replace(gait, stride_m=by * gait.stride_m, stride_s=by * gait.stride_s)


def _ordinary_gait(speed_m_s: float) -> Gait:
    relative = speed_m_s / 1.19
    stride_m = 1.28 * relative**0.55
    stance = 0.605 - 0.048 * (speed_m_s - 1.19) + 0.05 * max(0.0, 0.8 - speed_m_s)
    return Gait(
        speed_m_s=speed_m_s,
        stride_m=stride_m,
        stride_s=stride_m / speed_m_s,
        stance=stance,
        full_contact=0.105,
        heel_rise=0.375 + 0.06 * (1.0 - relative),
        midstance=0.29 + 0.6 * (stance - 0.605),
        contact_pitch_rad=np.deg2rad(19.0) * relative**0.5,
        toe_off_ankle_rad=np.deg2rad(-12.5) * min(relative, 1.0) ** 0.6,
        knee_loading=min(relative**0.7, 1.4),
        knee_swing=0.85 + 0.15 * min(relative, 1.3),
        shock=min(relative, 1.5),
    )
