"""Names of parts of the body, on their own and as used in speaking to the patient."""

from app.wording.translation import tr
from core.body import Joint, Segment, Side, Site


def segment_name(segment: Segment) -> str:
    """Name a segment beside the chip of its side: "Thigh"."""
    names = {Segment.THIGH: tr("Thigh"), Segment.SHANK: tr("Shank"), Segment.FOOT: tr("Foot")}
    return (names | {Segment.PELVIS: tr("Pelvis")})[segment]


def joint_name(joint: Joint) -> str:
    """Name a joint beside the chip of its side: "Knee"."""
    return tr("Hip") if joint.is_hip else tr("Knee") if joint.is_knee else tr("Ankle")


def name_of(part: Site | Joint) -> str:
    """Name a site or joint as the screen does: "L thigh", "left knee"."""
    names = {
        Site.LEFT_THIGH: tr("L thigh"),
        Site.LEFT_SHANK: tr("L shank"),
        Site.LEFT_FOOT: tr("L foot"),
        Site.RIGHT_THIGH: tr("R thigh"),
        Site.RIGHT_SHANK: tr("R shank"),
        Site.RIGHT_FOOT: tr("R foot"),
        Site.PELVIS: tr("pelvis"),
        Joint.LEFT_KNEE: tr("left knee"),
        Joint.LEFT_ANKLE: tr("left ankle"),
        Joint.RIGHT_KNEE: tr("right knee"),
        Joint.RIGHT_ANKLE: tr("right ankle"),
        Joint.LEFT_HIP: tr("left hip"),
        Joint.RIGHT_HIP: tr("right hip"),
    }
    return names[part]


def spelled_out(site: Site) -> str:
    """Name a site where there is room: "left thigh"."""
    return {
        Site.LEFT_THIGH: tr("left thigh"),
        Site.LEFT_SHANK: tr("left shank"),
        Site.LEFT_FOOT: tr("left foot"),
        Site.RIGHT_THIGH: tr("right thigh"),
        Site.RIGHT_SHANK: tr("right shank"),
        Site.RIGHT_FOOT: tr("right foot"),
        Site.PELVIS: tr("pelvis"),
    }[site]


def side_name(side: Side) -> str:
    """Name a side inside a sentence: "left"."""
    return tr("left") if side is Side.LEFT else tr("right")


def part_of(name: str) -> Site | Joint | None:
    """The site or joint that a word of the files names; None where it names none."""
    if name in set(Site):
        return Site(name)
    return Joint(name) if name in set(Joint) else None
