"""Zero and clinical sign of each identified joint, from standing, walking and the knee above.

Knees come first, since an ankle's sign follows its knee's; an ankle without one goes by the way its foot travels.
"""

import numpy as np

from core.angles.measure import Geometry, Twist
from core.body import Joint
from core.calibration.clinical_sign import ClinicalSign, ankle_sign, ankle_sign_from_foot, knee_sign
from core.calibration.identified import Identified
from core.calibration.validity import Basis
from core.calibration.zero import standing_twist, within_half_a_turn
from core.results import JointCalibration, Method, ZeroKind
from core.samples import FloatArray
from core.session import Session
from core.signal.rotations import wrap
from core.signal.sensors import SensorTracks
from core.span import JointAnalysis, SpanAnalysis


def calibrate(span: SpanAnalysis, method: Method) -> None:
    """Give every joint of a span its zero and its clinical sign; knees come first, since ankles follow them."""
    walks = {walk.name for walk in span.walks}
    for joint in span.joints.values():
        # walks show the way a joint bends; without any, the free motion does
        walked = [twist for name, twist in joint.twists.items() if name in walks]
        twists = walked or list(joint.twists.values())
        joint.calibration, joint.motion_sign = _calibration(span.tracks, joint, twists, bool(walked), method)


def _calibration(
    tracks: SensorTracks, one: JointAnalysis, twists: list[Twist], is_walking: bool, method: Method
) -> tuple[JointCalibration, ClinicalSign]:
    """One joint's calibration, and its sign as the motion gives it, whatever the user states."""
    session, basis, found, knee = tracks.session, one.basis, one.identified, one.knee
    joint = basis.joint
    standing = standing_twist_of(tracks, basis, found.geometry)
    moving = within_half_a_turn(np.concatenate([t.moving_twist for t in twists])) if twists else np.empty(0)
    zero_rad = standing if standing is not None else (float(np.median(moving)) if moving.size else 0.0)
    bend_rad, has_standing = wrap(moving - zero_rad), standing is not None
    sign = _clinical_sign(one, twists, is_walking, bend_rad, has_standing)
    if not joint.is_knee and not sign.is_certain and not (knee is not None and knee.motion_sign.is_contradicted):
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
        nature=session.patient.nature_of(joint),
    )
    return calibration, sign


def _is_clock_shared(session: Session, joint: Joint) -> bool:
    clocks = {info.clock if (info := session.sensors.get(site)) else "" for site in (joint.proximal, joint.distal)}
    return len(clocks) == 1 and "" not in clocks


def standing_twist_of(tracks: SensorTracks, basis: Basis, geometry: Geometry) -> float | None:
    """Give a joint's uncalibrated twist in standing, rad; None without standing."""
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
    joint: JointAnalysis, twists: list[Twist], is_walking: bool, bend_rad: FloatArray, has_standing: bool
) -> ClinicalSign:
    if not bend_rad.size:
        return ClinicalSign(1, 0.0, False)
    if joint.basis.joint.is_knee:
        shank_rate = -np.concatenate([t.moving_rate_2 for t in twists])
        return knee_sign(bend_rad, shank_rate, is_walking, has_standing)
    shank_rate = -np.concatenate([t.moving_rate_1 for t in twists])
    if joint.knee is None:
        return ankle_sign(None, 0.0, shank_rate, is_walking)
    agreement = float(joint.knee.identified.geometry.axis_2 @ joint.identified.geometry.axis_1)
    return ankle_sign(joint.knee.motion_sign, agreement, shank_rate, is_walking)


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
