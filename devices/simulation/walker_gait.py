"""Standing and walking of a simulated leg, whose foot never slides and whose knee bends as a human's does.

The order of things for one leg: when and where the foot is put (`StepPlan`); the forward path of the hips, shared by
both legs; the knee curve; the pitch of the foot while it rolls over heel, sole and toe. These give the ankle in stance.
In swing the ankle's curve and the hip's path are bridged from toe-off to the next initial contact; the foot follows.
Each hip has a path of its own: a pelvis would have to give by some centimetres, which no sensor on the legs can show.
"""

from dataclasses import replace

import numpy as np
from scipy.interpolate import BPoly, PchipInterpolator

from core.samples import FloatArray, IntArray
from devices.simulation.walker_body import HEEL_M, TOE_M, Leg
from devices.simulation.walker_manners import Gait
from devices.simulation.walker_motion import (
    Y_AXIS,
    Z_AXIS,
    JointAngles,
    LegMotion,
    TrueFootEvents,
    ankle_rotation,
    hang_from_hip,
    knee_rotation,
    rotation_about,
    smooth,
    smooth_step,
)
from devices.simulation.walker_plan import HIP_AHEAD_OF_ANKLE_M, Bend, StepPlan, WalkPlan
from devices.simulation.walker_prosthesis import AS_BUILT, LEAST_FLAT_S

MARGIN_S = 0.03  # the rolling goes on this long beyond both ends of stance, so that swing can join on smoothly
PITCH_WIDTH_S = 0.012  # an impact takes some 20 ms to turn a foot
# the foot is driven forward and up by so much at initial contact: about 40 m/s2 there, 27 at the shank, 14 at the thigh
STIFF_GIVE_RAD, STIFF_FLAT_RAD = np.deg2rad(2.0), np.deg2rad(0.3)
SHOCK_M, SHOCK_PITCH_RAD = 0.0015, np.deg2rad(0.25)

# Knee flexion, deg, over stance and swing (each 0-1) of a stride at comfortable speed: the two-peaked curve of every
# textbook (loading peak at 14 % of the stride, swing peak at 73 %), drawn by hand
KNEE_STANCE = (
    (0.0, 4.0),
    (0.08, 8.5),
    (0.23, 17.5),
    (0.41, 11.0),
    (0.57, 5.0),
    (0.69, 3.5),
    (0.82, 7.5),
    (0.90, 14.0),
    (1.0, 31.0),
)
KNEE_SWING = ((0.11, 46.5), (0.31, 62.5), (0.48, 56.0), (0.62, 40.0), (0.76, 19.0), (0.88, 4.5), (0.95, 1.5))
KNEE_TURNS = 0.31  # of swing, where its peak is
KNEE_PEAK_DEG = 59.0  # of the swing, over where the curves are scaled from
ANKLE_AT_TOE_OFF = 0.89  # of what is added to the ankle's range: swing goes on beyond toe-off
INVERSION_DEG = ((0.0, 2.0), (0.2, -3.5), (0.7, -1.0), (1.0, 4.0), (1.5, 2.5))  # over stance 0-1 and swing 1-2
BALL_M = 0.12  # of the foot, before the ankle
ROTATION_DEG = ((0.0, -1.0), (0.3, 3.0), (0.8, -2.0), (1.0, -3.0), (1.5, 1.0))


def walk_leg(leg: Leg, plan: WalkPlan, time_s: FloatArray, sway_m: FloatArray, rng: np.random.Generator) -> LegMotion:
    """Give one leg's poses on the fine clock, earth z up, m; `sway_m` (n, 2) is forward and left."""
    plan = _as_set(leg, plan, time_s)
    steps, gait = plan.steps[leg.side], plan.gaits[leg.side]
    step_s = time_s[1] - time_s[0]
    stance = _stance_at(steps, time_s)
    swings = [
        (int(np.searchsorted(time_s, off)), int(np.searchsorted(time_s, on)))
        for off, on in zip(steps.toe_off_s[:-1], steps.contact_s[1:], strict=True)
    ]
    shock = _shock(steps, time_s) * gait.shock
    knee = smooth(leg.prosthesis.stopped(_knee_curve(leg, steps, gait, time_s, rng)), step_s, 0.03)
    if gait.is_ankle_stiff:
        pitch, steps = _roll_as_one(leg, plan, knee, time_s)
    else:
        pitch = _stance_pitch(leg, plan, knee, time_s)
    pitch = smooth(pitch, step_s, PITCH_WIDTH_S) + SHOCK_PITCH_RAD * shock
    rolled_x, rolled_z = _roll(pitch)
    rolled_x = rolled_x + SHOCK_M * shock

    ahead = plan.hip_path_m + sway_m[:, 0] - (steps.ankle_m[stance] + rolled_x)
    for swing in swings:
        _bridge(ahead, swing, step_s)
    lean = _shank_lean(leg, ahead, knee)
    ankle = pitch + lean
    lifted = gait.lifted_rad if leg.foot is None else np.deg2rad(leg.foot.swing_deg) - leg.prosthesis.plantar_rad
    if gait.is_ankle_stiff:
        lifted = _standing_lean(leg)
    for swing in swings:
        _bridge(ankle, swing, step_s, lifted)

    sway = sway_m[:, 1] / (leg.thigh_m + leg.shank_m) * leg.outward
    angles = JointAngles(
        knee=knee,
        ankle=ankle,
        inversion=_curve(INVERSION_DEG, steps, time_s, step_s) - sway,
        rotation=_curve(ROTATION_DEG, steps, time_s, step_s),
    )
    path_m, heading = _path(plan.bends, plan.hip_path_m)
    place, yaw = _footholds(leg, steps, path_m, heading)
    pivoted = _pivoted(plan.pivot_share * np.diff(yaw), steps, time_s)
    foot = rotation_about(Z_AXIS, _yaw_at(yaw, steps, time_s) + pivoted) @ rotation_about(Y_AXIS, lean - ankle)
    thigh = foot @ np.swapaxes(knee_rotation(leg, angles) @ ankle_rotation(leg, angles), 1, 2)
    _, hanging = hang_from_hip(leg, thigh, np.zeros((len(time_s), 3)), angles)
    turned = yaw[stance] + pivoted
    stood = place[stance] + BALL_M * (_ahead(yaw[stance]) - _ahead(turned))
    hip = _stand(stood, turned, rolled_x, rolled_z) - hanging[2]
    for swing in swings:
        _bridge(hip, swing, step_s)
        _lift_hip(hip, foot, hanging[2], swing, gait.clearance_m)
        if gait.drag > 0.0:
            _drag_toes(hip, foot, hanging[2], swing, gait.drag)
    rotations, origins = hang_from_hip(leg, thigh, hip, angles)
    events = TrueFootEvents(steps.contact_s[1:], steps.full_contact_s[1:], steps.heel_rise_s[:-1], steps.toe_off_s[:-1])
    return LegMotion(time_s, angles, rotations, origins, events, place)


def _as_set(leg: Leg, plan: WalkPlan, time_s: FloatArray) -> WalkPlan:
    """The plan as the prosthesis is set: where the foot is, when it is flat and when its heel rises."""
    setting = leg.prosthesis
    if setting == AS_BUILT:
        return plan
    steps, gait = plan.steps[leg.side], plan.gaits[leg.side]
    ankle_m = steps.ankle_m - 1e-3 * setting.back_mm
    full_contact_s = steps.full_contact_s.copy()
    built = replace(leg, prosthesis=replace(setting, plantar_deg=0.0))
    for i in range(1, len(full_contact_s)):
        ahead_m = float(np.interp(steps.contact_s[i], time_s, plan.hip_path_m)) - ankle_m[i]
        less = _contact_pitch(leg, gait, ahead_m) / _contact_pitch(built, gait, ahead_m)
        full_contact_s[i] = steps.contact_s[i] + less * (full_contact_s[i] - steps.contact_s[i])
    sooner_s = setting.sooner_s(leg.thigh_m + leg.shank_m, gait.speed_m_s)
    later_s = 0.75 * (steps.toe_off_s[:-1] - steps.heel_rise_s[:-1])  # at most: something is left to rise in
    heel_rise_s = steps.heel_rise_s.copy()
    heel_rise_s[:-1] = np.maximum(heel_rise_s[:-1] + np.minimum(later_s, -sooner_s), full_contact_s[:-1] + LEAST_FLAT_S)
    mine = replace(
        steps,
        ankle_m=ankle_m,
        full_contact_s=full_contact_s,
        heel_rise_s=heel_rise_s,
        knee_deg=steps.knee_deg + setting.swing_flexion_deg,
    )
    return replace(plan, steps={**plan.steps, leg.side: mine})


def _stance_at(steps: StepPlan, time_s: FloatArray) -> IntArray:
    """Which foothold counts at each instant: the next one from the middle of each swing on."""
    return np.searchsorted(0.5 * (steps.toe_off_s[:-1] + steps.contact_s[1:]), time_s)


def _knots(time_s: FloatArray, rows: list[tuple[float, float]], rest: float) -> FloatArray:
    """A curve (n,) through knots (s, value) that is `rest` long before and after them."""
    knots = np.array(
        [(time_s[0] - 2.0, rest), (time_s[0] - 1.0, rest), *rows, (time_s[-1] + 1.0, rest), (time_s[-1] + 2.0, rest)]
    )
    return np.asarray(PchipInterpolator(knots[:, 0], knots[:, 1])(time_s))


def _knee_curve(leg: Leg, steps: StepPlan, gait: Gait, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Knee flexion (n,) over all strides, of slightly different size each."""
    stance_s = gait.stance * gait.stride_s
    rest = float(np.rad2deg(leg.standing_knee_rad))
    if leg.prosthesis.is_locked:
        return np.full_like(time_s, leg.standing_knee_rad)
    rows: list[tuple[float, float]] = []
    last = len(steps.contact_s) - 1
    for i in range(last + 1):
        loading = gait.knee_loading * leg.prosthesis.stance_flexion * leg.knee_gain * rng.normal(1.0, 0.05)
        swing = gait.knee_swing * leg.knee_gain * rng.normal(1.0, 0.015) + steps.knee_deg[i] / KNEE_PEAK_DEG
        on, off = steps.contact_s[i], steps.toe_off_s[i]
        if i == 0:
            on = off - stance_s
            rows.append((steps.heel_rise_s[i], rest))
        for p, deg in KNEE_STANCE:
            is_required = (i > 0 or on + p * stance_s > steps.heel_rise_s[i] + 0.02) and (i < last or p < 0.3)
            if i < last and is_required:
                size = loading if p < 0.6 else swing
                rows.append((on + p * (off - on), 3.5 + (deg - 3.5) * size))
            elif is_required:
                rows.append((on + p * stance_s, 3.5 + (deg - 3.5) * loading))
        if i == last:
            rows.append((on + 0.6 * stance_s, rest))
        else:
            rows += [
                (
                    off + leg.prosthesis.extending(u, KNEE_TURNS) * (steps.contact_s[i + 1] - off),
                    max(3.5 + (deg - 3.5) * swing, 0.5),
                )
                for u, deg in KNEE_SWING
            ]
    return np.deg2rad(_knots(time_s, rows if last else [], rest))


def _stance_pitch(leg: Leg, plan: WalkPlan, knee: FloatArray, time_s: FloatArray) -> FloatArray:
    """Pitch of the foot (n,), toes up positive, zero when the sole is flat; in swing it means nothing."""
    steps, gait, w = plan.steps[leg.side], plan.gaits[leg.side], PITCH_WIDTH_S
    beyond_s = MARGIN_S + 2.5 * w  # what smoothing spoils is further away than what swing looks at
    rest = gait.flat_pitch_rad
    pitch = np.full_like(time_s, rest)
    for i in range(1, len(steps.contact_s)):
        on, flat = steps.contact_s[i], steps.full_contact_s[i] - w
        here = slice(*np.searchsorted(time_s, [on - beyond_s, flat]))
        contact = _contact_pitch(leg, gait, float(np.interp(on, time_s, plan.hip_path_m)) - steps.ankle_m[i])
        u = (flat - time_s[here]) / (flat - on)
        pitch[here] = rest + contact * u**2 * (2.0 - u)
    for i in range(len(steps.contact_s) - 1):
        rise, end = steps.heel_rise_s[i] + w, steps.toe_off_s[i]
        here = slice(*np.searchsorted(time_s, [rise, end + beyond_s]))
        if leg.foot is not None and leg.foot.springs_back:
            ahead_m = plan.hip_path_m[here] - steps.ankle_m[i]
            pitch[here] = _sprung_back_pitch(leg, ahead_m, knee[here], (time_s[here] - rise) / (end - rise))
            continue
        hip_ahead_m = float(np.interp(end, time_s, plan.hip_path_m)) - steps.ankle_m[i]
        off = _toe_off_pitch(leg, gait, hip_ahead_m, steps.knee_deg[i], steps.ankle_deg[i]) - rest
        u = (time_s[here] - rise) / (end - rise)
        # a stiff ankle turns the foot with the shank, a human one holds it down for longer
        pitch[here] = rest + off * (0.6 * u**2 + 1.4 * u**3 - u**4 if leg.foot is None else 0.3 * u + 0.7 * u**2)
    return pitch


def _sprung_back_pitch(leg: Leg, ahead_m: FloatArray, knee: FloatArray, u: FloatArray) -> FloatArray:
    """The pitch (n,) under which a foot without a joint is as built again, and at rest, when it leaves the floor."""
    flat = _shank_lean(leg, ahead_m, knee)
    begun = (flat[1] - flat[0]) / (u[1] - u[0])
    left = np.clip(1.0 - u, 0.0, 1.0)
    ankle = left**2 * (flat[0] * (1.0 + 2.0 * u) + begun * u) - leg.prosthesis.plantar_rad * (1.0 - left)
    pitch = np.zeros_like(u)
    for _ in range(8):  # a contraction, as at toe-off
        pitch = ankle - _shank_lean(leg, ahead_m - _roll(pitch)[0], knee)
    return pitch


def _contact_pitch(leg: Leg, gait: Gait, hip_ahead_m: float) -> float:
    """The pitch over that of mid-stance that lands the heel with the ankle at about zero; the last step nearly flat."""
    if gait.contact_pitch_rad < 0.0:  # on the toes
        return gait.contact_pitch_rad
    required = np.deg2rad(1.0 if leg.foot is None else leg.foot.contact_deg) - leg.prosthesis.plantar_rad
    lean = _shank_lean(leg, np.array([hip_ahead_m]), np.deg2rad(np.array([4.0])))
    most = gait.contact_pitch_rad + max(0.0, -leg.prosthesis.plantar_rad)
    return float(np.clip(required - lean[0], np.deg2rad(2.0), most))


def _toe_off_pitch(leg: Leg, gait: Gait, hip_ahead_m: float, knee_deg: float, ankle_deg: float) -> float:
    """The pitch that gives the ankle its plantarflexion at toe-off, when the hip is `hip_ahead_m` of the foothold."""
    more_rad = ANKLE_AT_TOE_OFF * np.deg2rad(ankle_deg)
    if np.isfinite(gait.toe_off_pitch_rad):
        return gait.toe_off_pitch_rad - more_rad
    knee = np.deg2rad(np.array([3.5 + 27.5 * leg.knee_gain * gait.knee_swing + 27.5 * knee_deg / KNEE_PEAK_DEG]))
    if leg.prosthesis.is_locked:
        knee = np.array([leg.standing_knee_rad])
    required = gait.toe_off_ankle_rad * leg.ankle_gain - more_rad
    if leg.foot is not None:
        required = np.deg2rad(leg.foot.toe_off_deg) - leg.prosthesis.plantar_rad
    pitch = np.array([-0.5])
    for _ in range(8):  # the rolling foot carries the ankle forward: a contraction by a fifth each time
        pitch = required - _shank_lean(leg, hip_ahead_m - _roll(pitch)[0], knee)
    return float(pitch[0])


def _roll_as_one(leg: Leg, plan: WalkPlan, knee: FloatArray, time_s: FloatArray) -> tuple[FloatArray, StepPlan]:
    """Pitch (n,) of a foot that turns with its shank, flat while that leans as in standing, and when it is flat."""
    steps = plan.steps[leg.side]
    ahead = np.clip(plan.hip_path_m - steps.ankle_m[_stance_at(steps, time_s)], -0.6, 0.6)
    pitch = np.zeros_like(time_s)
    for _ in range(8):  # a contraction, as at toe-off
        lean = _standing_lean(leg) - _shank_lean(leg, ahead - _roll(pitch)[0], knee)
        beyond = np.maximum(np.abs(lean) - STIFF_GIVE_RAD, 0.0)
        pitch = np.sign(lean) * beyond**2 / (beyond + STIFF_GIVE_RAD)
    full_contact_s, heel_rise_s = steps.full_contact_s.copy(), steps.heel_rise_s.copy()
    flat = np.abs(pitch) < STIFF_FLAT_RAD
    for i, (on, off) in enumerate(zip(steps.contact_s, steps.toe_off_s, strict=True)):
        here = time_s[flat & (time_s > on) & (time_s < off)]
        if i > 0:
            full_contact_s[i] = here[0]
        if i + 1 < len(heel_rise_s):
            heel_rise_s[i] = here[-1]
    return pitch, replace(steps, full_contact_s=full_contact_s, heel_rise_s=heel_rise_s)


def _standing_lean(leg: Leg) -> float:
    return float(_shank_lean(leg, np.array([HIP_AHEAD_OF_ANKLE_M]), np.array([leg.standing_knee_rad]))[0])


def _shock(steps: StepPlan, time_s: FloatArray) -> FloatArray:
    """A decaying 25 Hz oscillation (n,) of some 0.6 after each initial contact, over before full contact."""
    total = np.zeros_like(time_s)
    for on, full in zip(steps.contact_s[1:], steps.full_contact_s[1:], strict=True):
        here = slice(*np.searchsorted(time_s, [on, 2.0 * full - on + 0.01]))
        t = np.maximum(time_s[here] - on - 0.005, 0.0)  # swing is bridged to a contact without it
        fade = np.maximum(1.0 - t / (full - on), 0.0) ** 3
        total[here] += 4.7 * (1.0 - np.exp(-t / 0.008)) ** 4 * np.exp(-t / 0.02) * np.sin(2.0 * np.pi * 25.0 * t) * fade
    return total


def _roll(pitch: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ankle over the floor (n,), forward of its place in foot flat and height, of a foot rolling over heel or toe."""
    pivot_x = np.where(pitch > 0.0, HEEL_M[0], TOE_M[0])
    pivot_z = np.where(pitch > 0.0, HEEL_M[2], TOE_M[2])
    c, s = np.cos(pitch), np.sin(pitch)
    return pivot_x - (c * pivot_x - s * pivot_z), -(s * pivot_x + c * pivot_z)


def _shank_lean(leg: Leg, ahead_m: FloatArray, knee: FloatArray) -> FloatArray:
    """How far the shank leans forward, rad (n,), with the hip `ahead_m` ahead of the ankle and the knee bent."""
    along = leg.shank_m + leg.thigh_m * np.cos(knee)
    across = leg.thigh_m * np.sin(knee)
    return np.arcsin(ahead_m / np.hypot(along, across)) + np.arctan2(across, along)


def _bridge(signal: FloatArray, swing: tuple[int, int], step_s: float, middle: float | None = None) -> None:
    """Replace `signal` between two indices by a smooth curve, in place; `middle` is passed level, at 65 %."""
    ends = []
    for i in swing:
        a, b, c, d, e = signal[i - 2 : i + 3]
        ends.append(
            np.stack(
                [c, (a - 8 * b + 8 * d - e) / (12 * step_s), (-a + 16 * b - 30 * c + 16 * d - e) / (12 * step_s**2)]
            )
        )
    x, knots = np.array([0.0, (swing[1] - swing[0]) * step_s]), ends
    if middle is not None:
        x = np.array([x[0], 0.65 * x[1], x[1]])
        knots = [ends[0], np.array([middle, 0.0, -0.5 / x[2] ** 2]), ends[1]]
    curve = BPoly.from_derivatives(x, knots)
    signal[swing[0] : swing[1] + 1] = curve(np.arange(swing[1] - swing[0] + 1) * step_s)


def _curve(rows_deg: tuple[tuple[float, float], ...], steps: StepPlan, time_s: FloatArray, step_s: float) -> FloatArray:
    """A curve (n,), rad, given over stance (0-1) and swing (1-2), zero while standing."""
    rows: list[tuple[float, float]] = []
    for i in range(1, len(steps.contact_s)):
        on, off = steps.contact_s[i], steps.toe_off_s[i]
        if i == 1:
            rows.append((steps.heel_rise_s[0], 0.0))
            rows += [
                (steps.toe_off_s[0] + (p - 1.0) * (on - steps.toe_off_s[0]), deg) for p, deg in rows_deg if p >= 1.0
            ]
        if i + 1 < len(steps.contact_s):
            following = steps.contact_s[i + 1]
            rows += [
                (on + p * (off - on) if p <= 1.0 else off + (p - 1.0) * (following - off), deg) for p, deg in rows_deg
            ]
        else:
            rows += [(on, rows_deg[0][1]), (on + 0.4, 0.0)]
    return smooth(np.deg2rad(_knots(time_s, rows, 0.0)), step_s, 0.05)


def _path(bends: tuple[Bend, ...], hip_path_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where the path lies, (3, m): its length, x, y on a grid of its own; and its heading (m,)."""
    length = np.arange(hip_path_m.min() - 0.5, hip_path_m.max() + 0.5, 0.01)
    heading = np.zeros_like(length)
    for bend in bends:
        heading += bend.heading_at(length)
    xy = np.cumsum(np.stack([np.cos(heading), np.sin(heading)]), axis=1) * 0.01
    return np.vstack([length, xy]), heading


def _footholds(leg: Leg, steps: StepPlan, path_m: FloatArray, heading: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ankle over the floor (i, 2) and direction of the foot (i,) of each stance."""
    yaw = np.interp(steps.ankle_m, path_m[0], heading)
    beside = 0.08 * leg.outward * np.stack([-np.sin(yaw), np.cos(yaw)], axis=-1)
    place = np.stack([np.interp(steps.ankle_m, path_m[0], axis) for axis in path_m[1:]], axis=-1) + beside
    return place, yaw + leg.toe_out_rad + steps.turned_rad


def _yaw_at(yaw: FloatArray, steps: StepPlan, time_s: FloatArray) -> FloatArray:
    """Direction of the foot (n,) but for its pivots: it turns in swing only, with a little sway of its own."""
    total = np.full_like(time_s, yaw[0])
    for i, (off, on) in enumerate(zip(steps.toe_off_s[:-1], steps.contact_s[1:], strict=True)):
        begin, end = np.searchsorted(time_s, [off, on])
        u = (time_s[begin:end] - off) / (on - off)
        total[begin:end] += (yaw[i + 1] - yaw[i]) * smooth_step(u) + np.deg2rad(4.0) * (4.0 * u * (1.0 - u)) ** 3
        total[end:] += yaw[i + 1] - yaw[i]
    return total


def _pivoted(by_rad: FloatArray, steps: StepPlan, time_s: FloatArray) -> FloatArray:
    """How far (n,) the foot is ahead in its turn: by so much at each toe-off, since it has pivoted on its ball."""
    total = np.zeros_like(time_s)
    if not by_rad.any():
        return total
    moments = zip(by_rad, steps.heel_rise_s[:-1], steps.toe_off_s[:-1], steps.contact_s[1:], strict=True)
    for ahead, rise, off, on in moments:
        total += ahead * (smooth_step((time_s - rise) / (off - rise)) - smooth_step((time_s - off) / (on - off)))
    return total


def _ahead(yaw: FloatArray) -> FloatArray:
    """Unit vectors over the floor (n, 2) of directions (n,)."""
    return np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)


def _stand(place: FloatArray, yaw: FloatArray, rolled_x: FloatArray, rolled_z: FloatArray) -> FloatArray:
    """Ankle (n, 3) of a foot that rolls along its own direction over a foothold."""
    x = place[:, 0] + np.cos(yaw) * rolled_x
    return np.stack([x, place[:, 1] + np.sin(yaw) * rolled_x, rolled_z], axis=-1)


def _lift_hip(
    hip: FloatArray, foot: FloatArray, ankle_below_hip: FloatArray, swing: tuple[int, int], clearance_m: float
) -> None:
    """Raise the hip in mid-swing by what heel or toe would lack over the floor, in place."""
    span = slice(swing[0], swing[1] + 1)
    u = np.linspace(0.0, 1.0, swing[1] - swing[0] + 1)
    bump = (4.0 * u * (1.0 - u)) ** 3
    ankle_z = hip[span, 2] + ankle_below_hip[span, 2]
    lowest = ankle_z + np.minimum(foot[span] @ HEEL_M, foot[span] @ TOE_M)[:, 2]
    inner = slice(len(u) // 5, len(u) - len(u) // 5)
    lack = (clearance_m - lowest[inner]) / bump[inner]
    hip[span, 2] += max(0.0, float(lack.max())) * bump


def _drag_toes(
    hip: FloatArray, foot: FloatArray, ankle_below_hip: FloatArray, swing: tuple[int, int], share: float
) -> None:
    """Lower the hip by what the toes have over the floor in the first `share` of swing, in place."""
    span = slice(swing[0], swing[1] + 1)
    u = np.linspace(0.0, 1.0, swing[1] - swing[0] + 1)
    lowest = hip[span, 2] + ankle_below_hip[span, 2] + np.minimum(foot[span] @ HEEL_M, foot[span] @ TOE_M)[:, 2]
    hip[span, 2] -= lowest * smooth_step(1.0 + (share - u) / 0.4)
