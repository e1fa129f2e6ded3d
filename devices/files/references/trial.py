"""What a reference file holds, in the terms of this program."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from core.body import Joint, Side
from core.samples import FloatArray

EVENTS = ("initial_contact", "full_contact", "heel_rise", "toe_off")
SIDES = {"l": Side.LEFT, "left": Side.LEFT, "r": Side.RIGHT, "right": Side.RIGHT}
JOINTS = {"hip": "hip", "kne": "knee", "knee": "knee", "ank": "ankle", "ankle": "ankle"}


@dataclass(frozen=True, slots=True)
class ReferenceTrial:
    """One trial of a reference, on its own clock; any part may be empty.

    `angles`: joint -> (time_s (n,), angle_rad (n,)): NaN in gaps; either sign, any zero.
    `events`: side -> event of EVENTS -> (k,): seconds, ascending.
    `strides`: side -> (k, 3): first and last instant in seconds, and length in metres.
    """

    name: str = ""  # A recording's, where the file gives one
    angles: Mapping[Joint, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    events: Mapping[Side, Mapping[str, FloatArray]] = field(default_factory=dict)
    strides: Mapping[Side, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ReferenceFile:
    """`format`: one of `reading.READERS`. `source`: how its angles came about, a word of `reading.SOURCES`.
    `is_simulated`: the file, one of our own exports, states that nobody was measured.
    """

    format: str
    source: str
    trials: tuple[ReferenceTrial, ...]
    is_simulated: bool = False


def joint_of_name(name: str) -> Joint | None:
    """The joint whose angle a signal of this name is: LKneeAngles, r_ank_angle, knee_angle_l, Left Knee Angle."""
    plain = re.sub(r"([a-z])([A-Z])", r"\1 \2", name.split(":")[-1])
    plain = re.sub(r"\b([LR])(?=[A-Z][a-z])", r"\1 ", plain)
    words = re.split(r"[\W_]+", plain.lower())
    words = [part for word in words for part in _parted(word)]
    sides = {SIDES[word] for word in words if word in SIDES}
    kinds = {JOINTS[word] for word in words if word in JOINTS}
    rest = [word for word in words if word not in SIDES and word not in JOINTS]
    has_angle = {"angle", "angles"} & set(rest)  # LKNE alone is a marker
    if not has_angle or len(sides) != 1 or len(kinds) != 1 or set(rest) - {"angle", "angles", "shape", ""}:
        return None
    return Joint(f"{sides.pop()}_{kinds.pop()}")


def _parted(word: str) -> list[str]:
    """`rknee` as `r` and `knee`."""
    found = re.fullmatch(r"([lr])(hip|kne|knee|ank|ankle)(angles?)?", word)
    return [part for part in found.groups() if part] if found else [word]
