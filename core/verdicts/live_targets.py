"""Whether a measure may be a target while somebody walks: by what the calibration reports before the walk."""

from collections.abc import Collection, Mapping

from core.body import Joint, Segment, Side, Site, knee_of
from core.results import JointCalibration
from core.targets import TargetMeasure
from core.verdicts.gates import calibration_verdicts
from core.verdicts.model import NOT_MEASURED, READ, TOE_OFF_GATE, Assessment, GateReason, Verdict, assess


def assess_target(
    measure: TargetMeasure,
    side: Side | None,
    worn: Collection[Site],
    calibration: Mapping[Joint, JointCalibration],
    prosthetic_sides: Collection[Side],
) -> Assessment:
    """Give what may be stated about a leg's measure; a prosthetic foot's stance is compared with nothing."""
    feet = {one.leg_side for one in worn if one.segment is Segment.FOOT}
    if measure is TargetMeasure.CADENCE:
        return READ if feet else NOT_MEASURED
    if side not in feet:
        return NOT_MEASURED
    if measure is TargetMeasure.STANCE_RATIO:
        if feet != set(Side):
            return NOT_MEASURED
        return assess([GateReason(TOE_OFF_GATE, Verdict.NOT_REPORTED)]) if prosthetic_sides else READ
    if measure is TargetMeasure.FOOT_STRIKE:
        return READ
    knee = knee_of(side)
    if knee not in calibration or not {knee.proximal, knee.distal} <= set(worn):
        return NOT_MEASURED
    return calibration_verdicts(calibration[knee]).height
