"""A walk written by hand, of which every figure is known: what the gates look at can be set, one at a time."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from core.body import LEG_JOINTS, Joint, Side, ankle_of, knee_of
from core.gait.clocks import ClockTie, LegClocks
from core.gait.spatiotemporal import parameters_of
from core.gait.strides import Reason, Strides
from core.results import AxisSource, JointCalibration, Method, RecordingAnalysis, SideGait, ZeroKind
from core.results import JointAngle as Angle
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.reception import Reception
from core.verdicts.gates import verdicts_of
from core.verdicts.model import Assessment, Verdict, Verdicts

KNEE_RANGE_DEG, ANKLE_RANGE_DEG = 60.0, 25.0
SURE_CLOCKS = LegClocks(ClockTie.ONE_CLOCK, 0.0, 0.0, 50.0, 0.0)
Reported = Mapping[Joint, JointCalibration]


def calibration(joint: Joint, **changes: Any) -> JointCalibration:
    """A joint of which everything is sure, with some of it changed."""
    sure = JointCalibration(
        joint=joint,
        method=Method.ROBUST,
        axis_proximal=np.array([0.0, 1.0, 0.0]),
        axis_distal=np.array([0.0, 1.0, 0.0]),
        axis_source=AxisSource.FREE_MOTION,
        axis_sd_rad=np.deg2rad(2.0),
        centre_proximal_m=None,
        centre_distal_m=None,
        centre_sd_m=None,
        sign_margin=3.0,
        clinical_sign=1,
        is_sign_certain=True,
        clinical_sign_margin=0.8,
        lag_s=0.0,
        lag_sd_s=0.001,
        hinge_residual_rad_s=None,
        is_hinge=False,
        gyro_bias_proximal_rad_s=None,
        gyro_bias_distal_rad_s=None,
        zero=ZeroKind.STANDING,
        zero_rad=0.0,
        offset_rad=0.0,
        standing_from="standing",
        free_motion_from=None,
    )
    return replace(sure, **changes)


def calibrations(changed: Joint | None = None, **changes: Any) -> dict[Joint, JointCalibration]:
    """All four joints; one of them changed."""
    return {joint: calibration(joint, **(changes if joint is changed else {})) for joint in LEG_JOINTS}


def each(value: float | FloatArray, n: int) -> FloatArray:
    """One value per stride."""
    return np.broadcast_to(np.asarray(value, dtype=float), (n,)).copy()


def bump_deg(ranges_deg: FloatArray, least_deg: float | FloatArray) -> FloatArray:
    """Per stride a curve (k, 101) from its least at 0 % to its range above it at 50 %."""
    share = 0.5 * (1.0 - np.cos(2 * np.pi * np.linspace(0.0, 1.0, 101)))
    return np.asarray(least_deg, dtype=float).reshape(-1, 1) + ranges_deg[:, None] * share


def leg(
    side: Side,
    n: int = 12,
    *,
    stance_percent: float | FloatArray = 60.0,
    time_s: float | FloatArray = 1.1,
    length_m: float | FloatArray = 1.3,
    knee_range_deg: float | FloatArray = KNEE_RANGE_DEG,
    knee_least_deg: float | FloatArray = 0.0,
    ankle_range_deg: float | FloatArray = ANKLE_RANGE_DEG,
    ankle_least_deg: float | FloatArray = -10.0,
    left_out: int = 0,
    is_toe_off_biased: bool = False,
) -> SideGait:
    """One side's `n` strides one after the other, of which the last `left_out` are not used."""
    times = each(time_s, n)
    ends = 10.0 + np.cumsum(times)
    starts = ends - times
    strides = Strides(
        start_s=starts,
        full_contact_s=starts + 0.05,
        heel_rise_s=starts + 0.4 * times,
        toe_off_s=starts + 0.01 * each(stance_percent, n) * times,
        end_s=ends,
        length_m=each(length_m, n),
        clearance_m=each(0.1, n),
        climb_m=np.zeros(n),
        turn_rad=np.zeros(n),
        bout=np.zeros(n, dtype=np.int64),
        reason=(Reason.USED,) * (n - left_out) + (Reason.TURN,) * left_out,
    )
    cycles = {
        knee_of(side): np.deg2rad(bump_deg(each(knee_range_deg, n), knee_least_deg)),
        ankle_of(side): np.deg2rad(bump_deg(each(ankle_range_deg, n), ankle_least_deg)),
    }
    parameters = parameters_of(strides, None)
    parameters |= {"step_time_s": 0.5 * times}
    for joint, of_joint in cycles.items():
        kind = "knee" if joint.is_knee else "ankle"
        parameters[f"{kind}_range_rad"] = np.ptp(of_joint, axis=1)
        parameters[f"{kind}_at_initial_contact_rad"] = of_joint[:, 0]
    parameters["knee_swing_peak_rad"] = cycles[knee_of(side)].max(axis=1)
    parameters["knee_swing_peak_percent"] = each(72.0, n)
    return SideGait((), strides, parameters, cycles, np.zeros(1, dtype=np.int64), is_toe_off_biased)


def walk(*, left: SideGait | None = None, right: SideGait | None = None, **changes: Any) -> RecordingAnalysis:
    """A walk of both legs with clocks that are sure, without verdicts."""
    angle = Angle(np.zeros(1), np.zeros(1), np.zeros(1), None)
    gait = {Side.LEFT: left or leg(Side.LEFT), Side.RIGHT: right or leg(Side.RIGHT)}
    sure = RecordingAnalysis(
        "walk 1",
        "walk_1",
        RecordingKind.WALKING,
        np.zeros(1),
        dict.fromkeys(LEG_JOINTS, angle),
        gait,
        clocks=SURE_CLOCKS,
    )
    return replace(sure, **changes)


def with_gaps(percent: float, of: SideGait | None = None, each_s: float = 0.1) -> Reception:
    """A sensor with gaps that take so much of a leg's strides used: in its middle, `each_s` long but the last."""
    strides = (of or leg(Side.LEFT)).strides
    used = strides.is_used
    left_s = 0.01 * percent * float(np.sum(strides.time_s[used]))
    gaps = []
    for start_s, end_s in zip(strides.start_s[used], strides.end_s[used], strict=True):
        for first_s in np.arange(start_s, end_s - each_s, 2.0 * each_s):
            length_s = min(each_s, left_s)
            gaps.append((first_s, first_s + length_s))
            left_s -= length_s
            if left_s <= 1e-9:
                return Reception(lost_percent=percent, gaps_s=np.array(gaps))
    raise ValueError("these strides are too few for such gaps")


def judged_walk(recording: RecordingAnalysis | None = None, reported: Reported | None = None) -> RecordingAnalysis:
    """The walk with its verdicts."""
    recording = recording or walk()
    return replace(recording, verdicts=verdicts_of(recording, reported or calibrations(), ()))


def not_read(found: Verdicts) -> dict[str, tuple[str, tuple[str, ...]]]:
    """What of a walk cannot simply be read: the verdict and the gates of each quantity that has one."""
    reported: dict[str, Assessment] = {}
    for joint, of_joint in found.joints.items():
        reported |= {f"{joint} {name}": getattr(of_joint, name) for name in ("shape", "height", "sign")}
    for side, of_leg in found.legs.items():
        reported |= {f"{side} {name}": getattr(of_leg, name) for name in ("timing", "distance")}
    reported["between"] = found.between
    return {
        name: (str(one.verdict), tuple(reason.gate for reason in one.reasons))
        for name, one in reported.items()
        if one.verdict is not Verdict.READ
    }
