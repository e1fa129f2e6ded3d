"""Names of parts of the body, on their own and as used in speaking to the patient."""

from app.wording.translation import tr
from core.body import Joint, Segment


def segment_name(segment: Segment) -> str:
    """Name a segment beside the chip of its side: "Thigh"."""
    names = {Segment.THIGH: tr("Thigh"), Segment.SHANK: tr("Shank"), Segment.FOOT: tr("Foot")}
    return (names | {Segment.PELVIS: tr("Pelvis")})[segment]


def joint_name(joint: Joint) -> str:
    """Name a joint beside the chip of its side: "Knee"."""
    return tr("Hip") if joint.is_hip else tr("Knee") if joint.is_knee else tr("Ankle")
