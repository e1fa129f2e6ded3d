"""Body parts that carry sensors, and the joints between them."""

from enum import StrEnum


class Side(StrEnum):
    """The side of the patient."""

    LEFT = "left"
    RIGHT = "right"

    @property
    def other(self) -> "Side":
        return Side.RIGHT if self is Side.LEFT else Side.LEFT


class Segment(StrEnum):
    """A segment of the leg."""

    THIGH = "thigh"
    SHANK = "shank"
    FOOT = "foot"


class Site(StrEnum):
    """Where a sensor sits. The values are the names used in files."""

    LEFT_THIGH = "left_thigh"
    LEFT_SHANK = "left_shank"
    LEFT_FOOT = "left_foot"
    RIGHT_THIGH = "right_thigh"
    RIGHT_SHANK = "right_shank"
    RIGHT_FOOT = "right_foot"

    @property
    def side(self) -> Side:
        return Side(self.value.split("_")[0])

    @property
    def segment(self) -> Segment:
        return Segment(self.value.split("_")[1])


class Joint(StrEnum):
    """A joint between two neighbouring segments. Flexion (knee) and dorsiflexion (ankle) are positive on both legs."""

    LEFT_KNEE = "left_knee"
    LEFT_ANKLE = "left_ankle"
    RIGHT_KNEE = "right_knee"
    RIGHT_ANKLE = "right_ankle"

    @property
    def side(self) -> Side:
        return Side(self.value.split("_")[0])

    @property
    def is_knee(self) -> bool:
        return self.value.endswith("knee")

    @property
    def proximal(self) -> Site:
        return Site(f"{self.side}_{'thigh' if self.is_knee else 'shank'}")

    @property
    def distal(self) -> Site:
        return Site(f"{self.side}_{'shank' if self.is_knee else 'foot'}")


def knee_of(side: Side) -> Joint:
    """The knee of one side."""
    return Joint(f"{side}_knee")


def ankle_of(side: Side) -> Joint:
    """The ankle of one side."""
    return Joint(f"{side}_ankle")
