"""Zero and clinical sign of each identified joint, from standing, walking and the knee above.

Knees come first, since an ankle's sign follows its knee's; an ankle without one goes by the way its foot travels.
"""

import numpy as np

from core.angles.measure import Geometry, Twist
from core.body import Joint, knee_of
from core.calibration.clinical_sign import ClinicalSign, ankle_sign, ankle_sign_from_foot, knee_sign
from core.calibration.identified import Identified
from core.calibration.validity import Basis
from core.calibration.zero import standing_twist, within_half_a_turn
from core.gait.walking import prosthetic_sides
from core.results import JointCalibration, Method, ZeroKind
from core.samples import FloatArray, RecordingKind, Session
from core.signal.rotations import wrap
from core.signal.sensors import SensorTracks

Bases = dict[tuple[str, Joint], Basis]
"""What calibrates each joint in each recording, by the recording's name."""


FoundKnee = tuple[ClinicalSign, FloatArray]
"""A knee's sign as the motion gives it, since the user's word on a knee is none on its ankle; its distal axis
(3,)."""


def calibrate(
    tracks: SensorTracks,
    bases: Bases,
    identified: dict[Basis, Identified],
    measured: dict[tuple[str, Joint], Twist],
    method: Method,
) -> dict[Basis, JointCalibration]:
    """Give every identified joint its zero and its clinical sign; knees first, since ankles follow them."""
    calibrated: dict[Basis, JointCalibration] = {}
    knees: dict[Basis, FoundKnee] = {}
    for basis in sorted(identified, key=lambda b: not b.joint.is_knee):
        names = [name for (name, joint), other in bases.items() if other == basis and joint is basis.joint]
        twists, is_walking = _telling(tracks, names, basis.joint, measured)
        knee_basis = bases.get((names[0], knee_of(basis.joint.side)))
        knee = knees.get(knee_basis) if knee_basis else None
        found = identified[basis]
        calibrated[basis], sign = _calibration(tracks, found, twists, is_walking, knee, method)
        if basis.joint.is_knee:
            knees[basis] = sign, found.geometry.axis_2
    return {basis: calibrated[basis] for basis in identified}


def _telling(
    tracks: SensorTracks, names: list[str], joint: Joint, measured: dict[tuple[str, Joint], Twist]
) -> tuple[list[Twist], bool]:
    """The walks, which show the way a joint bends; without any, the free motion. And whether these are walks."""
    kinds = {recording.name: recording.kind for recording in tracks.span}
    walks = [name for name in names if kinds[name] is RecordingKind.WALKING]
    return [measured[name, joint] for name in walks or names if (name, joint) in measured], bool(walks)


def _calibration(
    tracks: SensorTracks,
    found: Identified,
    twists: list[Twist],
    is_walking: bool,
    knee: FoundKnee | None,
    method: Method,
) -> tuple[JointCalibration, ClinicalSign]:
    """One joint's calibration, and its sign as the motion gives it, whatever the user states."""
    session, basis = tracks.session, found.basis
    joint = basis.joint
    standing = standing_twist_of(tracks, basis, found.geometry)
    moving = within_half_a_turn(np.concatenate([t.moving_twist for t in twists])) if twists else np.empty(0)
    zero_rad = standing if standing is not None else (float(np.median(moving)) if moving.size else 0.0)
    bend_rad, has_standing = wrap(moving - zero_rad), standing is not None
    sign = _clinical_sign(found, twists, is_walking, bend_rad, has_standing, knee)
    if not joint.is_knee and not sign.is_certain and not (knee is not None and knee[0].is_contradicted):
        sign = _sign_of_foot(tracks, found) or sign
    turn = session.turned_sign.get(joint, 1)
    zero = (
        ZeroKind.NONE if standing is None else ZeroKind.GONIOMETER if joint in session.zero_rad else ZeroKind.STANDING
    )
    in_force = [recording for recording in tracks.span if recording.name in found.recordings]
    biases = [tracks.gyro_bias(in_force[0], site) for site in (joint.proximal, joint.distal)]
    robust = found.robust
    calibration = JointCalibration(
        joint=joint,
        method=method,
        axis_proximal=found.geometry.axis_1,
        axis_distal=found.geometry.axis_2,
        axis_source=found.source,
        axis_sd_rad=robust.axis_sd_rad if robust else None,
        centre_proximal_m=found.geometry.centre_1_m if found.is_centre_known else None,
        centre_distal_m=found.geometry.centre_2_m if found.is_centre_known else None,
        centre_sd_m=found.centre_sd_m,
        sign_margin=found.sign_margin,
        clinical_sign=sign.sign * turn,
        is_sign_certain=sign.is_certain or joint in session.turned_sign,
        clinical_sign_margin=sign.margin,
        lag_s=found.geometry.lag_s,
        lag_sd_s=found.lag.sd_s if found.lag else None,
        hinge_residual_rad_s=found.hinge_residual_rad_s,
        is_hinge=found.is_hinge,
        gyro_bias_proximal_rad_s=biases[0].rad_s if biases[0].source else None,
        gyro_bias_distal_rad_s=biases[1].rad_s if biases[1].source else None,
        zero=zero,
        zero_rad=zero_rad,
        offset_rad=session.zero_rad[joint] if zero is ZeroKind.GONIOMETER else 0.0,
        standing_from=basis.standing if standing is not None else None,
        free_motion_from=basis.free_motion if basis.free_motion in found.recordings else None,
        walks_from=tuple(name for name in found.recordings if name in basis.walks),
        acc_bias_proximal_m_s2=found.geometry.unknowns[6:9] if robust else None,
        acc_bias_distal_m_s2=found.geometry.unknowns[9:12] if robust else None,
        is_clock_shared=_is_clock_shared(session, joint),
        is_same_joint=robust.is_same_joint if robust else True,
        is_lag_at_border=robust.lag.is_at_border if robust else False,
        disagreement=robust.disagreement if robust else None,
        is_prosthetic=joint.side in prosthetic_sides(session.patient),
    )
    return calibration, sign


def _is_clock_shared(session: Session, joint: Joint) -> bool:
    clocks = {info.clock if (info := session.sensors.get(site)) else "" for site in (joint.proximal, joint.distal)}
    return len(clocks) == 1 and "" not in clocks


def standing_twist_of(tracks: SensorTracks, basis: Basis, geometry: Geometry) -> float | None:
    """What a joint reads in its standing, rad, bare twist; None without one."""
    joint = basis.joint
    for recording in tracks.span:
        if recording.name == basis.standing:
            rests = [tracks.rest(recording, site) for site in (joint.proximal, joint.distal)]
            if rests[0] is None or rests[1] is None:
                return None
            down_1, down_2 = rests[0].acc_m_s2, rests[1].acc_m_s2
            if geometry.is_hinge:  # its angle is free of the biases, so its zero has to be
                down_1, down_2 = down_1 - geometry.unknowns[6:9], down_2 - geometry.unknowns[9:12]
            return standing_twist(down_1, down_2, geometry.axis_1, geometry.axis_2)
    return None


def _clinical_sign(
    found: Identified,
    twists: list[Twist],
    is_walking: bool,
    bend_rad: FloatArray,
    has_standing: bool,
    knee: FoundKnee | None,
) -> ClinicalSign:
    if not bend_rad.size:
        return ClinicalSign(1, 0.0, False)
    if found.basis.joint.is_knee:
        shank_rate = -np.concatenate([t.moving_rate_2 for t in twists])
        return knee_sign(bend_rad, shank_rate, is_walking, has_standing)
    shank_rate = -np.concatenate([t.moving_rate_1 for t in twists])
    if knee is None:
        return ankle_sign(None, 0.0, shank_rate, is_walking)
    knee_found, knee_axis = knee
    return ankle_sign(knee_found, float(knee_axis @ found.geometry.axis_1), shank_rate, is_walking)


def _sign_of_foot(tracks: SensorTracks, found: Identified) -> ClinicalSign | None:
    """The ankle's sign as the foot's own travel shows it; None where it does not show it for sure."""
    joint = found.basis.joint
    for recording in tracks.span:
        if recording.name not in found.basis.walks or not tracks.is_usable(recording, joint.distal):
            continue
        for motion in tracks.foot_motions(recording, joint.distal, tracks.blocks(recording)[0]):
            sign = ankle_sign_from_foot(float(found.geometry.axis_2 @ motion.pitch_axis), len(motion.swings))
            if motion.is_direction_certain and sign.is_certain:
                return sign
    return None
