"""Body parts that carry sensors, and the joints between them.

What follows from a name is found out once for each: live work asks for it hundreds of times a second.
"""

from enum import StrEnum
from functools import cached_property


class Side(StrEnum):
    """The side of the patient."""

    LEFT = "left"
    RIGHT = "right"

    @property
    def other(self) -> "Side":
        return Side.RIGHT if self is Side.LEFT else Side.LEFT

    @property
    def letter(self) -> str:
        return "L" if self is Side.LEFT else "R"


class Segment(StrEnum):
    """A segment of the body: the pelvis, and those of the leg."""

    THIGH = "thigh"
    SHANK = "shank"
    FOOT = "foot"
    PELVIS = "pelvis"


class Site(StrEnum):
    """Where a sensor sits. The values are the names used in files. The pelvis is no part of a leg and has no side."""

    LEFT_THIGH = "left_thigh"
    LEFT_SHANK = "left_shank"
    LEFT_FOOT = "left_foot"
    RIGHT_THIGH = "right_thigh"
    RIGHT_SHANK = "right_shank"
    RIGHT_FOOT = "right_foot"
    PELVIS = "pelvis"

    @cached_property
    def side(self) -> Side | None:
        return None if self.value == "pelvis" else self.leg_side

    @cached_property
    def leg_side(self) -> Side:
        """The side of a site of the leg; ValueError of the pelvis."""
        return Side(self.value.split("_")[0])

    @cached_property
    def segment(self) -> Segment:
        return Segment(self.value.split("_")[-1])


class JointKind(StrEnum):
    """Which joint of a leg, from the trunk to the floor."""

    HIP = "hip"
    KNEE = "knee"
    ANKLE = "ankle"

    def of(self, side: Side) -> "Joint":
        return Joint(f"{side}_{self}")


class Joint(StrEnum):
    """A joint between two adjacent segments. Flexion (knee, hip) and dorsiflexion are positive on both legs."""

    LEFT_KNEE = "left_knee"
    LEFT_ANKLE = "left_ankle"
    RIGHT_KNEE = "right_knee"
    RIGHT_ANKLE = "right_ankle"
    LEFT_HIP = "left_hip"
    RIGHT_HIP = "right_hip"

    @cached_property
    def side(self) -> Side:
        return Side(self.value.split("_")[0])

    @cached_property
    def kind(self) -> JointKind:
        return JointKind(self.value.split("_")[1])

    @cached_property
    def is_knee(self) -> bool:
        return self.kind is JointKind.KNEE

    @cached_property
    def is_hip(self) -> bool:
        return self.kind is JointKind.HIP

    @cached_property
    def proximal(self) -> Site:
        return Site.PELVIS if self.is_hip else Site(f"{self.side}_{'thigh' if self.is_knee else 'shank'}")

    @cached_property
    def distal(self) -> Site:
        return Site(f"{self.side}_{'thigh' if self.is_hip else 'shank' if self.is_knee else 'foot'}")


LEG_SEGMENTS = (Segment.THIGH, Segment.SHANK, Segment.FOOT)
LEG_SITES: tuple[Site, ...] = tuple(
    site for site in Site if site is not Site.PELVIS
)  # the six that every session may have
LEG_JOINTS: tuple[Joint, ...] = tuple(joint for joint in Joint if not joint.is_hip)  # the four that have an axis


def knee_of(side: Side) -> Joint:
    """The knee of one side."""
    return Joint(f"{side}_knee")


def ankle_of(side: Side) -> Joint:
    """The ankle of one side."""
    return Joint(f"{side}_ankle")


def hip_of(side: Side) -> Joint:
    """The hip of one side."""
    return Joint(f"{side}_hip")
